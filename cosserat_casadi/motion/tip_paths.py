"""The paths that a tolerance of a motion bounds: positions and rotations of tips, moving bases and bodies.

The tip of a rod that a support or a joint holds says little: such a rod is also watched between its ends, at the
sections of :func:`watched_sections`, as at rest.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache, reduce
from typing import NamedTuple

import casadi as ca
import numpy as np

from cosserat_casadi.maths.calls import chooses, evaluated
from cosserat_casadi.maths.rotation import directors
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.function_table import kept_with
from cosserat_casadi.model.section_poses import SectionPoses, section_weights
from cosserat_casadi.model.system import Arguments, System
from cosserat_casadi.model.watched import watched_sections
from cosserat_casadi.motion.displacement import LEVER
from cosserat_casadi.motion.history import History
from cosserat_casadi.motion.repeated_call import external
from cosserat_casadi.scene.constraint_records import Body

PATHS = "motion_paths"
"""Name in C of the function of watched paths."""

WATCHED = 401
"""Number of evenly spaced times at which paths are compared."""


@dataclass(frozen=True)
class Paths:
    """Paths of watched sections, moving bases and bodies at T times, by which two motions are compared.

    A rod that only twists moves no point of its axis, so that the rotation of its tip about the tangent counts too.

    Attributes:
        points: positions of sections, of bases that have unknowns and of points of bodies over the length,
            shape (T, points, 3), without unit.
        section_axes: x and y axes of the sections in world axes, shape (T, sections, 2, 3).
    """

    points: FloatArray
    section_axes: FloatArray


class WatchedStates(NamedTuple):
    """States of a motion at those T times of comparison that it reaches.

    Attributes:
        times: times, shape (T,), s.
        x: unknowns, shape (T, model.size).
        inputs: stacked inputs, shape (T, model.inputs.size).
    """

    times: FloatArray
    x: FloatArray
    inputs: FloatArray


def watched_states(history: History, duration: float) -> WatchedStates:
    """Evaluate the states of a motion at the times of comparison in a duration, s."""

    def states() -> WatchedStates:
        times = np.linspace(history.begin, duration, WATCHED)
        times = times[times <= history.end.time]
        return WatchedStates(times, *history.rough_positions(times))

    return history.once("watched states", duration, states)


def function_of_paths(model: Model) -> ca.Function:
    """The function (x, inputs) ↦ points over the length, 3×points, and axes of sections, 3×(2 sections), as Paths."""
    return kept_with(model, "_paths", lambda: _written(model))


def _written(model: Model) -> ca.Function:
    arguments = Arguments(ca.MX.sym("x", model.size), ca.MX.sym("inputs", model.inputs.size))
    system = System(model.discrete, arguments)
    points: list[Matrix] = []
    section_axes: list[Matrix] = []
    lengths = _lengths(model, arguments.inputs)
    for name, tip in model.tip.items():
        position, rotation = _frame(tip, arguments)
        points.append(position / lengths[name])
        section_axes.append(rotation[:, :2])
        places = _places_between(model, name)
        if places:
            poses = SectionPoses(system, name, section_weights(model.discrete, name, places))
            points.append(poses.positions / lengths[name])
            x_axes, y_axes, _ = map(ca.horzsplit, directors(poses.quaternions))
            section_axes += [axis for both in zip(x_axes, y_axes, strict=True) for axis in both]
        base = model.discrete.unloaded.floating_base(name)
        if base is not None:
            frame = model.discrete.frames[base]
            moved = frame.length * arguments.x[model.discrete.deviation(base)][:3]
            points.append((moved + frame.start.position) / lengths[name])
    longest = reduce(ca.fmax, lengths.values())
    in_scene = max(model.length(name, model.pack()) for name in model.discrete.rods)
    for body in model.scene.bodies:
        position, rotation = _frame(model.body[body.name], arguments)
        arms = watched_arms(body, in_scene).T
        points.append((ca.repmat(position, 1, arms.shape[1]) + rotation @ arms) / longest)
    results = [ca.densify(ca.horzcat(*columns)) for columns in (points, section_axes)]
    return ca.Function(PATHS, [arguments.x, arguments.inputs], ca.cse(results))


def _frame(function: ca.Function, arguments: Arguments) -> list[Matrix]:
    """Inline the position and rotation of a tip or a body, so that terms in common with others are shared."""
    position, _, rotation = function.call([arguments.x, arguments.inputs], True, False)
    return [position, rotation]


def paths(model: Model, x: FloatArray, inputs: FloatArray, library: str | None = None) -> Paths:
    """Evaluate the paths of all watched sections, moving bases and bodies at T times.

    Args:
        model: the model.
        x: unknowns, shape (T, model.size).
        inputs: stacked inputs, shape (T, model.inputs.size).
        library: shared object that contains :func:`function_of_paths`; None without one.
    """
    function = _in_scalars(model) if library is None else external(PATHS, library)
    points, axes = evaluated(function, x, inputs)
    return Paths(points.swapaxes(1, 2), axes.swapaxes(1, 2).reshape(len(x), -1, 2, 3))


def _lengths(model: Model, inputs: Matrix) -> dict[str, Matrix]:
    """Length of each rod, m: an entry of the inputs, or a number."""
    in_scene = model.pack()
    entries = {name: model.inputs.of_rod(name, "length") for name in model.discrete.rods}
    return {
        name: ca.DM(model.length(name, in_scene)) if span is None else inputs[span] for name, span in entries.items()
    }


def _in_scalars(model: Model) -> ca.Function:
    """The function for CasADi's virtual machine, in scalars if possible, which take a quarter of the time."""
    function = function_of_paths(model)
    return kept_with(model, "_paths_in_scalars", lambda: function if chooses(function) else function.expand())


def _places_between(model: Model, rod: str) -> list[float]:
    """Abscissae of the watched sections of a rod before its tip."""
    places: list[float] = watched_sections(model.scene, rod)[:-1].tolist()
    return places


def path_distance(first: Paths, second: Paths) -> float:
    """Largest distance of two sets of paths, over the length, at the times that both reach.

    The rotation of a section about its tangent counts with a lever arm of LEVER lengths.
    """
    rows = min(len(first.points), len(second.points))
    distances = np.linalg.norm(first.points[:rows] - second.points[:rows], axis=2)
    rolls = _rolls(first.section_axes[:rows], second.section_axes[:rows])
    return float(np.maximum(distances.max(initial=0.0), LEVER * np.abs(rolls).max(initial=0.0)))


@lru_cache(maxsize=64)
def watched_arms(body: Body, longest: float) -> FloatArray:
    """Watched points of a body in its axes, shape (k, 3), m: its origin, and points that represent its inertia.

    These are the centre of mass, and on each axis through it a point at the radius of gyration. For a body with moments
    of inertia but no mass, the radius is LEVER lengths of the longest rod.
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


def _rolls(first: FloatArray, second: FloatArray) -> FloatArray:
    """Rotation angles about the tangent from one set of sections to another nearby one, shape (T, sections), rad.

    Args:
        first: x and y axes of sections, shape (T, sections, 2, 3).
        second: x and y axes of the other sections, shape (T, sections, 2, 3).
    """
    # cos and sin of the turn, twice: what the tangents are apart enters by its square alone.
    aligned = np.einsum("traj,traj->tr", first, second)
    turned = np.einsum("trj,trj->tr", first[:, :, 1], second[:, :, 0])
    turned -= np.einsum("trj,trj->tr", first[:, :, 0], second[:, :, 1])
    return np.asarray(np.arctan2(turned, aligned))
