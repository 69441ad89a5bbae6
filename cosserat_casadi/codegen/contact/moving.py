"""Words in the templates of steps in exact contact: pairs that may touch, functions of points and surfaces."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.codegen.block_sources import Words
from cosserat_casadi.codegen.names import Names
from cosserat_casadi.compiling.c_tables import numbers, reals, record, record_table
from cosserat_casadi.compiling.texts import render
from cosserat_casadi.equilibrium.contact.obstacle_surfaces import distance_from, surface
from cosserat_casadi.errors import ExportError, Problem
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.contact_gap import Facing
from cosserat_casadi.motion.contact_law import AT_END, LOOKS, MOST_TOUCHES, NEXT_TO_NOTHING
from cosserat_casadi.motion.contact_sections import RodFacing
from cosserat_casadi.motion.facings import facings, points_of
from cosserat_casadi.motion.motion_start import equilibrium_start, unloaded_start
from cosserat_casadi.motion.rods_facing import RodsFacing
from cosserat_casadi.motion.stops_facing import StopFacing, stop_facings, struck_in_steps
from cosserat_casadi.motion.surface_sliding import SurfaceSliding

CONTACT_FILES = (
    "contact_gaps.c",
    "contact_ways.c",
    "square_systems.c",
    "least_pushes.c",
    "contact_steps.c",
    "contact_sensitivity.c",
)
"""Files of the folder ``c`` that a library with steps in exact contact includes."""

FRICTION_FILES = ("contact_friction.c", "friction_sensitivity.c")
"""Files of the folder ``c`` that such a library includes with friction."""

ROD_FILES = ("struck_rods.h", "struck_rods.c")
"""Files of the folder ``c`` that such a library includes where rods may touch rods."""

MEMBERS = (
    *("points", "is_body", "elements", "nodes", "ends", "to_coefficients", "looks", "watches_base", "watches_tip"),
    *("laid", "laid_count", "length", "force_unit", "radius_at_base", "radius_at_tip", "restitution", "stride"),
    *("surface", "distance"),
)
"""Members of the record of a pair in C, in the order of ``gaps_in_motion.c.in``."""

FEWEST_TOUCHES = 8
"""Least number of contacts of a rod with an obstacle for which arrays have room."""


def contact_functions(model: Model, names: Names) -> dict[str, ca.Function]:
    """Functions of the points that may touch, then of the surfaces of obstacles, by their names in C."""
    found: dict[str, ca.Function] = {}
    for number, points in enumerate(points_of(struck_in_steps(model))):
        found |= {f"{_stem(names, number)}_{word}": function for word, function in points.in_steps.items()}
    for number, obstacle in enumerate(_obstacles(model)):
        name = names.kernel(f"surface_{number}")
        found[name] = _surface_function(obstacle, name)
        found[names.kernel(f"surface_distance_{number}")] = distance_from(obstacle)
    for number, facing in enumerate(struck_in_steps(model)):
        if facing.against.rubs:
            rubbing = SurfaceSliding(facing)
            found[names.kernel(f"rubbing_{number}")] = rubbing.function
            found[names.kernel(f"rubbing_derivatives_{number}")] = rubbing.derivatives
    return found


def contact_words(model: Model, names: Names) -> Words:
    """Words of a library about pairs that its steps keep apart, and sizes of its arrays.

    Args:
        model: the exported model, with its motion.
        names: of the library.
    """
    faces = struck_in_steps(model)
    if not faces:
        return {"steps_in_contact": False, "contact_rubs": False}
    points = points_of(struck_in_steps(model))
    stops = stop_facings(model)
    others = [own.other for own in faces if isinstance(own, RodsFacing)]
    rods = _rods(faces)
    nodes = [own.nodes_of_element for own in rods]
    carried = any(own.carrier is not None for own in faces)
    words: Words = {
        "steps_in_contact": True,
        "contact_rubs": model.scene.rubs_exactly,
        "friction_words": "with Coulomb's friction" if model.scene.rubs_exactly else "without friction",
        "friction_axes": "axes of the body that carries the obstacle, or of the world" if carried else "world axes",
        "rods_face_rods": bool(others),
        "what_is_met": "an obstacle or another rod" if others else "an obstacle",
        "met_on_other": ", own->other_end_place" if others else "",
        "facings": len(faces),
        "has_stops": bool(stops),
        "points_share": any(own.shares is not None for own in points),
        "barring": len(faces) - len(stops),
        "most_touches": _most_touches(faces),
        "numbers_moved": 5 if others else 4,
        "most_nodes": max([*nodes, 2]),
        "most_points": max(count.count for count in points),
        "looks": LOOKS,
        "most_looks": max([LOOKS * (len(own.ends) - 1) + 1 for own in rods] + [1]),
        "most_elements": max([len(own.ends) - 1 for own in others], default=0),
        "at_end": AT_END,
        "next_to_nothing": NEXT_TO_NOTHING,
        "deepest": repr(float(model.scene.accuracy.tolerance)),
        "pair_words": "; ".join(f"{k} {_words_of(own)}" for k, own in enumerate(faces)),
        "start_shape": numbers(start_shape(model).tolist()),
    }
    return words | {
        "contact_functions": "".join(_functions(model, names)),
        "contact_tables": "\n".join(_tables(model, faces)),
    }


def contact_pattern(model: Model) -> ca.Sparsity:
    """Sparsity of the second derivatives of gaps by the unknowns."""
    together = np.zeros((model.size, model.size), dtype=bool)
    for points in points_of(struck_in_steps(model)):
        positions = points.in_steps["positions"]
        moving = sorted(set(positions.jac_sparsity(0, 0).get_col()))
        together[np.ix_(moving, moving)] = True
    for facing in facings(model) if model.scene.rubs_exactly else ():
        moving = SurfaceSliding(facing).moving
        together[np.ix_(moving, moving)] = True
    rows, columns = np.nonzero(together)
    return ca.Sparsity.triplet(model.size, model.size, rows.tolist(), columns.tolist())


def _described(facing: Facing) -> dict[str, str]:
    """Describe a pair for the manifest."""
    if isinstance(facing, StopFacing):
        return {"joint": facing.owner, "stop": facing.touched}
    if isinstance(facing, RodsFacing):
        return {"rod": facing.owner, "other_rod": facing.touched}
    return {"body" if facing.of_body else "rod": facing.owner, "obstacle": facing.touched}


def _words_of(facing: Facing) -> str:
    """A pair for a comment in C, which its names can not end."""
    return f"{facing.owner} and {facing.touched}".replace("*/", "* /").replace("/*", "/ *")


def contact_reals(size: int, inputs: int, words: Words) -> int:
    """Size of the contact part of the workspace, in numbers of 8 bytes.

    Args:
        size: number of unknowns.
        inputs: number of inputs.
        words: words of the library.
    """
    if not words["steps_in_contact"]:
        return 0
    touches = words["most_touches"]
    of_touch = 14 if words["rods_face_rods"] else 11
    friction = 0
    if words["contact_rubs"]:
        # Places of touches have forces of friction, and each three rows in place of one.
        of_touch += 15
        rows = 6 * touches
        friction = touches * (26 * size + 20 * inputs + 42) + 3 * rows**2 + 22 * rows
        friction += (6 + size) * (1 + size + inputs) + 3 * words["most_points"]
    records = of_touch * touches * (3 + words["most_step_parts"])
    if words["rods_face_rods"]:
        friction += 3 * words["most_points"] + 3 * words["most_looks"] + 4 * words["most_elements"] + size + 10
    vectors = touches * (9 * size + 2 * inputs) + size * (4 + inputs + size) + 12 * words["most_points"]
    return int(friction + records + vectors + 9 * touches**2 + 22 * touches + words["most_looks"] + 8 * inputs)


def described_contact(model: Model) -> dict[str, Any]:
    """Entries of the manifest: pairs that may touch, in the order of their indices in C, and most touching sections."""
    faces = struck_in_steps(model)
    if not faces:
        return {}
    pairs = [_described(own) for own in faces]
    described: dict[str, Any] = {"contacts": pairs, "most_contacts": _most_touches(faces)}
    return described | ({"contacts_rub": True} if model.scene.rubs_exactly else {})


def _most_touches(faces: Sequence[Facing]) -> int:
    """Most contacts at once: for each rod its holding sections while it lies, or FEWEST_TOUCHES if that is more."""
    return min(MOST_TOUCHES, sum(1 if own.of_body else max(FEWEST_TOUCHES, len(own.laid_at)) for own in faces))


def starts_unloaded(model: Model) -> bool:
    """Whether the motion begins in the unloaded shape, as it does with free bases, which have no equilibrium."""
    return any(rod.base.free for rod in model.scene.rods) or model.scene.starts_unloaded


def start_shape(model: Model) -> FloatArray:
    """Solve for the unknowns at the start of the scene's motion, at rest, with the scene's parameters, shape (size,).

    Raises:
        ExportError: the scene begins in an equilibrium, and none is found.
    """
    if starts_unloaded(model):
        return unloaded_start(model.at(), model.pack()).x
    start = equilibrium_start(model.at(), model.pack())
    if not start.found:
        raise ExportError(Problem("simulation.start", start.sentence, 'give start = "unloaded"'))
    return start.x


def _functions(model: Model, names: Names) -> Iterator[str]:
    """Write the calls of the kernels."""
    for number, points in enumerate(points_of(struck_in_steps(model))):
        words = {"number": number, "stem": _stem(names, number), "moved_by_inputs": "by_inputs" in points.in_steps}
        yield render("points_in_motion.c.in", words)
    for number in range(len(_obstacles(model))):
        kernels = {word: names.kernel(f"{word}_{number}") for word in ("surface", "surface_distance")}
        yield render("surface_in_motion.c.in", {"number": number, **kernels})
    for number, facing in enumerate(struck_in_steps(model)):
        if facing.against.rubs:
            kernels = {word: names.kernel(f"{word}_{number}") for word in ("rubbing", "rubbing_derivatives")}
            yield render("rubbing_in_motion.c.in", {"number": number, **kernels})


def _tables(model: Model, faces: list[Facing]) -> Iterator[str]:
    """Write the tables of points, and of pairs of a rod or body and an obstacle."""
    points = points_of(struck_in_steps(model))
    words = ("positions", "velocities", "gradient", "hessian")
    records = []
    for number, own in enumerate(points):
        fields: dict[str, object] = {"count": own.count, **{word: f"{word}_of_{number}" for word in words}}
        fields["by_inputs"] = f"input_gradient_of_{number}" if "by_inputs" in own.in_steps else "0"
        if own.shares is not None:
            yield reals(f"SHARES_OF_{number}", own.shares)
        if any(each.shares is not None for each in points):
            fields["shares"] = "0" if own.shares is None else f"SHARES_OF_{number}"
        records.append(record(fields))
    yield record_table("moving_points", "POINTS", "", records)
    # Tables of a rod serve all pairs that it is in.
    rods = {own.owner: own for own in _rods(faces)}
    for number, rod in enumerate(rods.values()):
        yield from _rod_tables(rod, number)
    numbers_of = {name: number for number, name in enumerate(rods)}
    obstacles = _obstacles(model)
    records = []
    for number, facing in enumerate(faces):
        fields = {"points": points.index(facing.points), "is_body": int(facing.of_body)}
        if isinstance(facing, RodFacing):
            fields |= _rod_fields(facing, numbers_of[facing.owner])
            yield reals(f"LAID_{number}", facing.laid_at)
            fields |= {"laid": f"LAID_{number}", "laid_count": len(facing.laid_at)}
        else:
            fields |= {"elements": 1, "nodes": 1}
        fields |= {"length": _real(facing.length), "force_unit": _real(facing.force_unit)}
        fields |= _radii(facing)
        fields |= {"restitution": _real(facing.against.restitution), "stride": _real(facing.stride)}
        if not isinstance(facing, RodsFacing):
            own = obstacles.index(facing.obstacle)
            fields |= {"surface": f"surface_of_{own}", "distance": f"surface_distance_of_{own}"}
        if facing.against.rubs:
            fields["coefficients"] = f"{{{numbers(list(facing.against.coefficients))}}}"
            fields |= {f"{word}": f"{word}_of_{number}" for word in ("rubbing", "rubbing_derivatives")}
        if isinstance(facing, RodsFacing):
            other = _rod_fields(facing.other, numbers_of[facing.other.owner]) | {"length": _real(facing.other.length)}
            yield f"static const facing OTHER_{number} = {record(_whole(model, other | _radii(facing.other)))};"
            fields["other"] = f"&OTHER_{number}"
        records.append(record(_whole(model, fields)))
    yield record_table("facing", "FACING", "FACINGS", records)


def _whole(model: Model, fields: Mapping[str, object]) -> dict[str, object]:
    """Put the members of a pair in the order of their declaration, for which C++ asks, with zeros for missing ones."""
    friction = {"coefficients": "{0, 0, 0}", "rubbing": "0", "rubbing_derivatives": "0"}
    members = dict.fromkeys(MEMBERS, "0") | (friction if model.scene.rubs_exactly else {})
    members |= {"other": "0"} if any(isinstance(own, RodsFacing) for own in struck_in_steps(model)) else {}
    assert set(fields) <= set(members), "members are declared in gaps_in_motion.c.in"
    return {name: fields.get(name, zero) for name, zero in members.items()}


def _rods(faces: Sequence[Facing]) -> list[RodFacing]:
    """Rods in pairs, then the other rods of pairs of two."""
    rods = [own for own in faces if isinstance(own, RodFacing)]
    return [*rods, *(own.other for own in rods if isinstance(own, RodsFacing))]


def _rod_tables(rod: RodFacing, number: int) -> Iterator[str]:
    yield reals(f"FACING_ENDS_{number}", np.array(rod.ends))
    yield reals(f"TO_COEFFICIENTS_{number}", rod.to_coefficients.ravel())
    yield reals(f"LOOKS_{number}", rod.looks.ravel())


def _rod_fields(rod: RodFacing, number: int) -> dict[str, object]:
    return {
        "elements": len(rod.ends) - 1,
        "nodes": rod.nodes_of_element,
        "ends": f"FACING_ENDS_{number}",
        "to_coefficients": f"TO_COEFFICIENTS_{number}",
        "looks": f"LOOKS_{number}",
        "watches_base": int(rod.watched_ends[0]),
        "watches_tip": int(rod.watched_ends[1]),
    }


def _radii(facing: Facing) -> dict[str, str]:
    base, tip = facing.radii
    return {"radius_at_base": _real(base), "radius_at_tip": _real(tip)}


def _real(value: float) -> str:
    return numbers([float(value)])


def _surface_function(obstacle: scenes.ObstacleRecord, name: str) -> ca.Function:
    """Point ↦ distance from an obstacle, its gradient and its second derivative."""
    point = ca.SX.sym("point", 3)
    parts = surface(obstacle).expand().call([point])
    return ca.Function(name, [point], ca.cse([ca.densify(part) for part in parts]))


def _obstacles(model: Model) -> list[scenes.ObstacleRecord]:
    """Obstacles that something may touch."""
    found: list[scenes.ObstacleRecord] = []
    for facing in struck_in_steps(model):
        if not isinstance(facing, RodsFacing) and facing.obstacle not in found:
            found.append(facing.obstacle)
    return found


def _stem(names: Names, number: int) -> str:
    """Prefix of the names of the kernels of some points."""
    return names.kernel(f"points_{number}")
