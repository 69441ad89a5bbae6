"""Contacts in result files."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from cosserat_casadi.equilibrium.smooth_contact import depths_along
from cosserat_casadi.equilibrium.solution import Contact
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.paths.equilibrium_path import PathContact

if TYPE_CHECKING:
    from cosserat_casadi.motion.trajectory import Motion
    from cosserat_casadi.paths.equilibrium_path import EquilibriumPath


def contact_entry(model: Model, x: FloatArray, inputs: FloatArray) -> dict[str, Any]:
    """Smooth contact as plain data: kind, widths of obstacles and of contacts between rods, m, and depths in widths.

    Args:
        model: model of a scene with smooth obstacles.
        x: unknowns, shape (k, model.size).
        inputs: stacked inputs, shape (k, model.inputs.size).
    """
    return {
        "kind": "smooth",
        "widths": {obstacle.name: obstacle.width for obstacle in model.scene.obstacles}
        | {pair.name: pair.width for pair in model.discrete.pairs},
        "depth": depths_along(model, x, inputs),
    }


def rubbing_entries(result: EquilibriumPath | Motion, rows: int) -> dict[str, Any]:
    """Entry of the intervals of rods that stick or slip on obstacles, row by row; empty in a scene without friction."""
    if not result.model.scene.rubs:
        return {}
    rubbing = [
        {
            "row": row,
            "obstacle": found.obstacle,
            "rod": found.rod,
            "from": found.start,
            "to": found.end,
            "slips": found.slips,
        }
        for row in range(rows)
        for found in result.rubbing(row)
    ]
    return {"rubbing": rubbing}


def place_entry(contact: Contact | PathContact) -> dict[str, Any]:
    """Place of a contact: interval of a rod, or body, or both rods with the abscissae at which they are nearest."""
    entry: dict[str, Any] = {"obstacle": contact.obstacle}
    if contact.of_body:
        return {**entry, "body": contact.owner}
    if contact.on_rods is not None:
        entry = {"rods": [contact.owner, contact.obstacle], "at": contact.on_rods}
    else:
        entry |= {"rod": contact.owner}
    return {**entry, "from": contact.start, "to": contact.end}


def point_forces(contact: Contact | PathContact) -> dict[str, Any]:
    """Forces at the point or at both ends of a line, and at sections inside it if there are any."""
    entry: dict[str, Any] = {"point_forces": contact.ends}
    if contact.inside:
        entry["inside_forces"] = [{"at": section.at, "force": section.force} for section in contact.inside]
    return entry
