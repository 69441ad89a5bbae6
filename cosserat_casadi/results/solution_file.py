"""The result file: a solution as JSON."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

from cosserat_casadi.equilibrium.contact.contact_state import without_contacts
from cosserat_casadi.equilibrium.solution import Contact, Solution
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.inputs import input_layout
from cosserat_casadi.results.contact_entry import place_entry, point_forces

if TYPE_CHECKING:
    from cosserat_casadi.control.inverse_result import Inverse

SAMPLES = 41
"""Evenly spaced abscissae of the fields of a rod in the file, which adds element ends."""


def solution_result(solution: Solution) -> dict[str, Any]:
    """A solution as the data of the result file."""
    model = solution.model
    scene = model.scene
    inputs = model.inputs.unpack(solution.inputs)
    # Contact forces are unknowns, not inputs.
    given = input_layout(without_contacts(scene)).names
    data: dict[str, Any] = {
        "title": scene.title,
        "converged": solution.converged,
        "outcome": solution.outcome.label,
        "message": solution.message,
        "residual_norm": solution.residual_norm,
        "error_estimate": solution.error_estimate,
        "shape_error_estimate": solution.shape_error_estimate,
        "wrench_error_estimate": solution.wrench_error_estimate,
        "within_tolerance": solution.within_tolerance,
        "stable": solution.stable,
        "smallest_eigenvalue": solution.smallest_eigenvalue,
        "iterations": solution.iterations,
        "load_factor": solution.load_factor,
        # Columns of Legendre coefficients become rows; an array with one entry becomes a number.
        "inputs": {name: value.T.squeeze() for name, value in inputs.items() if name in given},
        "discretisation": model.resolution,
        "rods": {name: _rod_entry(solution, name) for name in model.discrete.rods},
    }
    # Tables of absent kinds of objects are left out.
    if scene.listed_bodies:
        data["bodies"] = {body.name: asdict(solution.body(body.name)) for body in scene.listed_bodies}
    if scene.actuators:
        data["actuators"] = {actuator.name: solution.actuator(actuator.name) for actuator in scene.actuators}
    if solution.model.joint:
        data["joints"] = {name: solution.joint(name) for name in solution.model.joint}
    if scene.has_contact:
        data["contacts"] = [_contact_entry(contact) for contact in solution.contacts]
    if solution.model.discrete.has_layers:
        data["layer_error_estimate"] = solution.layer_error_estimate
    return data


def _rod_entry(solution: Solution, name: str) -> dict[str, Any]:
    """Fields of a rod at its abscissae, its tip, and the reaction of its clamp."""
    breaks = solution.model.element_ends(name)
    X = listed_abscissae(breaks)
    pose = solution.pose(X, name)
    tip = solution.tip(name)
    base_wrench = solution.base_wrench(name)
    return {
        "X": X,
        "position": pose.position,
        "quaternion": pose.quaternion,
        "strain": solution.strain(X, name),
        "internal_wrench": solution.internal_wrench(X, name),
        "tip": asdict(tip),
        "base_wrench": {"force": base_wrench.force, "moment": base_wrench.moment},
    }


def _contact_entry(contact: Contact) -> dict[str, Any]:
    """Place of a contact, and forces on the rod: the resultant, and forces at the point or at both ends of a line.

    For a smooth contact, which has no such ends: the width of the obstacle and the smallest gap. For a contact between
    rods: the nearest sections, and the resultant on the first rod.
    """
    entry = {**place_entry(contact), "force": contact.force, "kind": contact.kind}
    if contact.width is None:
        entry |= point_forces(contact)
    else:
        entry |= {"width": contact.width, "gap": contact.gap}
    return entry


def listed_abscissae(breaks: tuple[float, ...]) -> FloatArray:
    """Abscissae of the fields in the file of a rod with element ends at these breaks."""
    # Strains and internal forces may jump at breaks, which are therefore among the abscissae.
    evenly = np.linspace(0.0, 1.0, SAMPLES)
    return np.unique(np.concatenate([evenly, breaks]))


def inverse_result(inverse: Inverse) -> dict[str, Any]:
    """The result of an inverse problem as the data of its file."""
    targets = []
    for target, gap in zip(inverse.targets, inverse.gaps, strict=True):
        entry = {
            "kind": target.kind,
            "what": gap.what,
            "position_gap": gap.position,
            "angle_gap": gap.angle,
            "position_error_estimate": gap.position_error,
            "angle_error_estimate": gap.angle_error,
        }
        targets.append(entry)
    return {**inverse.solution.to_dict(), "targets_met": inverse.met, "targets": targets}
