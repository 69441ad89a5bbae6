"""The paths that a tolerance of a motion binds: those of tips, of bases that move and of bodies, and how they turn.

A tip that a support or a joint holds is where it is held: such a rod is watched between its ends too, at the sections
of :func:`watched_sections`, as at rest.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache, reduce
from typing import NamedTuple

import casadi as ca
import numpy as np

from cosserat_casadi.equilibrium.solution import rotations
from cosserat_casadi.maths.calls import evaluated
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.function_table import kept_with
from cosserat_casadi.model.section_poses import SectionPoses, section_weights
from cosserat_casadi.model.system import Arguments, System
from cosserat_casadi.model.watched import watched_sections
from cosserat_casadi.motion.displacement import LEVER
from cosserat_casadi.motion.history import History
from cosserat_casadi.motion.pose_series import Frames, frames_of
from cosserat_casadi.motion.repeated_call import external, renamed
from cosserat_casadi.scene.constraint_records import Body

TIP = "motion_tip_"
"""Name of the pose of a tip in C, before the number of its rod."""

BETWEEN = "motion_between_"
"""Name of the poses of the sections between the ends of a rod in C, before its number."""

BODY = "motion_body_"
"""Name of the pose of a body in C, before its number."""

WATCHED = 401
"""Times at which paths are compared, evenly spaced."""


@dataclass(frozen=True)
class Paths:
    """Paths of watched sections, moving bases and bodies at T times, by which two motions are compared.

    A rod that only twists moves neither its tip nor any point of its axis: its tip's turn about the tangent counts too.

    Attributes:
        points: positions of sections, of bases that have unknowns and of points of bodies over the length,
            shape (T, points, 3), without unit.
        section_axes: x and y axes of the sections in world axes, shape (T, sections, 3, 2), an axis a column.
    """

    points: FloatArray
    section_axes: FloatArray


class WatchedStates(NamedTuple):
    """States of a motion at the T times at which paths are compared, as far as it reaches them.

    Attributes:
        times: shape (T,), s.
        x: unknowns, shape (T, model.size).
        inputs: stacked inputs, shape (T, model.inputs.size).
    """

    times: FloatArray
    x: FloatArray
    inputs: FloatArray


class PathFunctions(NamedTuple):
    """Functions (x, inputs) ↦ what moves along the watched paths.

    Attributes:
        tips: frames of the tips, by their rods.
        between: positions and quaternions of the sections between ends, by their rods.
        bodies: frames of the bodies, by their names.
    """

    tips: Mapping[str, ca.Function]
    between: Mapping[str, ca.Function]
    bodies: Mapping[str, ca.Function]


def watched_states(history: History, duration: float) -> WatchedStates:
    """The states of a motion at the times at which it is compared with another one of a duration, s."""
    if duration not in history.watched_until:
        times = np.linspace(history.begin, duration, WATCHED)
        times = times[times <= history.end.time]
        history.watched_until[duration] = WatchedStates(times, *history.rough_positions(times))
    known: WatchedStates = history.watched_until[duration]
    return known


def functions_of_paths(model: Model) -> list[ca.Function]:
    """The poses of tips and bodies, as :attr:`Model.tip` and its like have them, and of the sections between ends."""
    tips = [renamed(tip, f"{TIP}{number}") for number, tip in enumerate(model.tip.values())]
    bodies = [renamed(body, f"{BODY}{number}") for number, body in enumerate(model.body.values())]
    return [*tips, *_between(model).values(), *bodies]


def paths(model: Model, x: FloatArray, inputs: FloatArray, library: str | None = None) -> Paths:
    """The paths of all watched sections, moving bases and bodies at T times.

    Args:
        model: the model.
        x: unknowns, shape (T, model.size).
        inputs: stacked inputs, shape (T, model.inputs.size).
        library: shared object that has :func:`functions_of_paths`; None without one.
    """
    tips, between, bodies = _interpreted(model) if library is None else _external(model, library)
    points = []
    section_axes = []
    lengths = _lengths(model, inputs)
    for name in model.discrete.rods:
        length = lengths[name]
        tip = frames_of(tips[name], x, inputs)
        points.append(tip.position / length)
        section_axes.append(tip.rotation[:, :, :2])
        if name in between:
            positions, quaternions = evaluated(between[name], x, inputs)
            points += list(np.moveaxis(positions / length[..., None], 2, 0))
            of_sections = rotations(np.moveaxis(quaternions, 2, 0).reshape(-1, 4))
            section_axes += list(of_sections[:, :, :2].reshape(-1, len(x), 3, 2))
        base = model.discrete.unloaded.floating_base(name)
        if base is not None:
            frame = model.discrete.frames[base]
            start = np.asarray(frame.start.position, dtype=float).ravel()
            moved = frame.length * x[:, model.discrete.deviation(base)][:, :3]
            points.append((moved + start) / length)
    longest = reduce(np.maximum, lengths.values())
    for body in model.scene.bodies:
        frames = frames_of(bodies[body.name], x, inputs)
        points += list(_moved_with(frames, watched_arms(body, longest.max())) / longest)
    return Paths(np.stack(points, axis=1), np.stack(section_axes, axis=1))


def _lengths(model: Model, inputs: FloatArray) -> dict[str, FloatArray]:
    """Length of each rod, m: at every time where it is an input, shape (T, 1), else shape (1, 1)."""
    in_scene: dict[str, float] = kept_with(
        model, "_lengths_in_scene", lambda: {name: model.length(name, model.pack()) for name in model.discrete.rods}
    )
    lengths = {}
    for name, length in in_scene.items():
        entries = model.inputs.of_rod(name, "length")
        lengths[name] = inputs[:, entries] if entries is not None else np.array([[length]])
    return lengths


def _interpreted(model: Model) -> PathFunctions:
    # As scalars those of bodies take less than half of the time.
    bodies = kept_with(model, "_bodies_in_scalars", lambda: {name: body.expand() for name, body in model.body.items()})
    return PathFunctions(model.tip, _between(model), bodies)


def _external(model: Model, library: str) -> PathFunctions:
    """The functions of a shared object, without a function being written for them; every motion asks."""
    loaded: dict[str, PathFunctions] = kept_with(model, "_paths_in_c", dict)
    if library not in loaded:
        loaded[library] = _loaded(model, library)
    return loaded[library]


def _loaded(model: Model, library: str) -> PathFunctions:
    rods = list(enumerate(model.discrete.rods))
    tips = {name: external(f"{TIP}{number}", library) for number, name in rods}
    between = {name: external(f"{BETWEEN}{number}", library) for number, name in rods if _places_between(model, name)}
    bodies = {body.name: external(f"{BODY}{number}", library) for number, body in enumerate(model.scene.bodies)}
    return PathFunctions(tips, between, bodies)


def _places_between(model: Model, rod: str) -> list[float]:
    """Abscissae of the watched sections of a rod before its tip."""
    places: list[float] = watched_sections(model.scene, rod)[:-1].tolist()
    return places


def _between(model: Model) -> dict[str, ca.Function]:
    """(x, inputs) ↦ positions, 3×k, and quaternions, 4×k, of the k watched sections before its tip, by their rod."""
    return kept_with(model, "_between_ends", lambda: _written_between(model))


def _written_between(model: Model) -> dict[str, ca.Function]:
    discrete = model.discrete
    arguments = Arguments(ca.MX.sym("x", model.size), ca.MX.sym("inputs", model.inputs.size))
    system = System(discrete, arguments)
    functions = {}
    for number, name in enumerate(discrete.rods):
        places = _places_between(model, name)
        if places:
            poses = SectionPoses(system, name, section_weights(discrete, name, places))
            outputs = [poses.positions, poses.quaternions]
            functions[name] = ca.Function(f"{BETWEEN}{number}", [arguments.x, arguments.inputs], outputs)
    return functions


def path_distance(first: Paths, second: Paths) -> float:
    """Largest distance of two sets of paths at the times that both reach, over the length, without unit.

    What a section is turned about its tangent counts on an arm of LEVER lengths.
    """
    rows = min(len(first.points), len(second.points))
    distances = np.linalg.norm(first.points[:rows] - second.points[:rows], axis=2)
    rolls = _rolls(first.section_axes[:rows], second.section_axes[:rows])
    return float(np.maximum(distances.max(initial=0.0), LEVER * np.abs(rolls).max(initial=0.0)))


@lru_cache(maxsize=64)
def watched_arms(body: Body, longest: float) -> FloatArray:
    """Points of a body that are watched, in its axes, shape (k, 3), m: its origin, and what its inertia would move.

    These are its centre of mass, and on each axis through it a point at the radius of gyration. For a body with moments
    of inertia and no mass the radius is LEVER lengths of the longest rod.
    """
    arms = [np.zeros(3)]
    centre = np.asarray(body.centre_of_mass, dtype=float)
    spread = float(np.trace(body.inertia_matrix))
    if body.mass > 0.0 and np.any(centre):
        arms.append(centre)
    if spread > 0.0:
        radius = LEVER * longest
        if body.mass > 0.0:
            radius = float(np.sqrt(spread / (2.0 * body.mass)))
        arms += [centre + radius * axis for axis in np.eye(3)]
    points = np.array(arms)
    # Several motions have them.
    points.setflags(write=False)
    return points


def _moved_with(frames: Frames, arms: FloatArray) -> FloatArray:
    """Positions of k points of a body, shape (k, T, 3), m."""
    # One product of flat matrices takes a tenth of the time of T small ones.
    turned = frames.rotation.reshape(-1, 3) @ arms.T
    return np.asarray(frames.position + turned.T.reshape(len(arms), -1, 3))


def _rolls(first: FloatArray, second: FloatArray) -> FloatArray:
    """Turns about the tangent from one set of sections to another that lies close, shape (T, sections), rad.

    Args:
        first: x and y axes of sections, shape (T, sections, 3, 2).
        second: those of the others.
    """
    # cos and sin of the turn, twice: what the tangents are apart enters by its square alone.
    aligned = np.einsum("trja,trja->tr", first, second)
    turned = np.einsum("trj,trj->tr", first[..., 1], second[..., 0])
    turned -= np.einsum("trj,trj->tr", first[..., 0], second[..., 1])
    return np.asarray(np.arctan2(turned, aligned))
