"""Start of a motion: at rest, in an equilibrium or in the unloaded shape."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from cosserat_casadi.equilibrium.contact.shape_projection import projected
from cosserat_casadi.equilibrium.metrics import prolong
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.equilibrium.solve import NOTHING, solve
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.checkpoint import Resume
from cosserat_casadi.motion.contact_guards import CLOSE, ContactPhase
from cosserat_casadi.motion.exact_contact import ExactContacts
from cosserat_casadi.motion.facings import facings
from cosserat_casadi.motion.moving_model import model_at_rest
from cosserat_casadi.motion.rods_facing import RodsFacing
from cosserat_casadi.motion.start_in_contact import resting
from cosserat_casadi.numerics.newton import relative_norm

Residual = Callable[..., FloatArray]
"""(x, v, a, inputs, their rates, their accelerations) ↦ residual of the equations of motion, shape (size,)."""

UNLOADED = "At rest in the unloaded shape."
SWINGS = (
    "At rest in the unloaded shape, since a base is free or swings. To begin in an equilibrium, give "
    'start = "equilibrium" in [simulation].'
)
EQUILIBRIUM = "At rest in the static equilibrium of the inputs at t = 0."
HELD = "At rest in the static equilibrium of the inputs at t = 0 with free bases held; the motion releases them."
RESUMED = "From the end of the given motion, at t = {time:.6g} s."
GIVEN = "At rest in the given equilibrium."
ALONG = " A base or a length has a speed at t = 0: rods move along with it from the start on, without a jerk."
TOUCHES = (
    "The rods touch obstacles in the equilibrium of the inputs at t = 0, and on at most {modes} modes of a strain the "
    "search for such an equilibrium, with forces at sections, did not settle. Give "
    'another number of accuracy.modes, mostly a larger one, start = "unloaded", or other inputs at t = 0.'
)
GIVEN_TOUCHES = (
    "The rods touch obstacles in the given equilibrium, and on at most {modes} modes of a strain the search for such "
    "an equilibrium, with forces at sections, did not settle. Give another number of accuracy.modes, mostly a larger "
    "one; the given equilibrium may stay."
)
RODS_INSIDE = "Rods that touch each other exactly are inside each other in the unloaded shape: move them apart."
FREE_TOUCHES = (
    "The rods touch obstacles in the equilibrium of the inputs at t = 0 with free bases held, and no motion can "
    'begin by the release of a base in contact: give start = "unloaded", or other inputs at t = 0.'
)


@dataclass(frozen=True)
class Start:
    """The state in which a motion begins.

    Attributes:
        x: unknowns, shape (size,); multipliers and tensions are a guess.
        sentence: sentence for the user; for a start that failed, the reason.
        v: rates of the unknowns, shape (size,), 1/s; None at rest.
        found: whether there is a state to start from.
        phases: the contacts; None if they have to be searched for.
        asks_for_modes: whether no start was found on these modes, but other modes may have one.
        resume: state from which a motion continues; None for a motion that begins.
        equilibrium: guess for a start on other modes; None if such a start is solved for anew.
    """

    x: FloatArray
    sentence: str
    v: FloatArray | None = None
    found: bool = True
    phases: ContactPhase | None = None
    asks_for_modes: bool = False
    resume: Resume | None = None
    equilibrium: Solution | None = None


def resumed_start(model: Model, resume: Resume) -> Start:
    """Make the start of a motion that continues."""
    return Start(model.unloaded(), RESUMED.format(time=resume.at.time), resume=resume)


def unloaded_start(model: Model, inputs: FloatArray) -> Start:
    """Make a start at rest in the unloaded shape.

    Args:
        model: model of the scene in motion.
        inputs: inputs at the start, shape (model.inputs.size,).
    """
    asked = model.scene.simulation is not None and model.scene.simulation.start is not None
    x = _own_unloaded(model)
    if least_gap_of_rods(model, x, inputs) < -CLOSE:
        return Start(x, RODS_INSIDE, found=False)
    return Start(x, UNLOADED if asked else SWINGS)


def equilibrium_start(
    model: Model, inputs: FloatArray, near: Solution | None = None, residual: Residual | None = None
) -> Start:
    """Make a start at rest in the equilibrium at the inputs, with free bases held at their poses in the scene.

    Args:
        model: model of the scene in motion.
        inputs: inputs at the start, shape (model.inputs.size,).
        near: the equilibrium on other modes; None if unknown.
        residual: compiled residual of the equations of motion, without parameters, of :class:`StepKernels`; None if
            there is none.
    """
    unloaded = _own_unloaded(model)
    if near is None and residual is not None and _rests(model, unloaded, inputs, residual):
        return Start(unloaded, EQUILIBRIUM)
    held = model_at_rest(model)
    sentence = HELD if _frees_bases(held, model) else EQUILIBRIUM
    guess = None if near is None else prolong(near, held)
    solution = solve(held, held.pack(model.inputs.unpack(inputs)), start=guess, estimate_error=False)
    return _started(model, solution, sentence)


def _own_unloaded(model: Model) -> FloatArray:
    """Unknowns of the unloaded scene, shape (size,), with frames at the poses that the parameters give them."""
    x = model.unloaded()
    if model.discrete.scaling is None:
        return x
    for name, frame in model.discrete.frames.items():
        own = model.discrete.own_unloaded.frames[name].start
        # Of the two quaternions of an orientation the one that is nearer.
        sign = 1.0 if own.quaternion @ frame.start.quaternion >= 0.0 else -1.0
        moved = (own.position - frame.start.position) / frame.length
        x[model.discrete.deviation(name)] = [*moved, *(sign * own.quaternion - frame.start.quaternion)]
    return x


def _rests(model: Model, unloaded: FloatArray, inputs: FloatArray, residual: Residual) -> bool:
    """Whether the unloaded scene is an equilibrium, so that the functions of statics need not be written."""
    if model.scene.held() is not model.scene or model.scene.touches_exactly:
        return False
    no_rates = np.zeros_like(inputs)
    at_rest = np.zeros_like(unloaded)
    norm = relative_norm(residual(unloaded, at_rest, at_rest, inputs, no_rates, no_rates), unloaded)
    return bool(norm <= NOTHING)


def given_start(model: Model, solution: Solution) -> Start:
    """Make a start at rest in a given equilibrium of the scene, at its inputs.

    Args:
        model: model of the scene in motion.
        solution: the equilibrium, on any discretisation with the same elements, with free bases held.
    """
    held = model_at_rest(model)
    names = set(held.inputs.names)
    given = solution.model.inputs.unpack(solution.inputs)
    values = {name: value for name, value in given.items() if name in names}
    # Unknowns would name no contacts: a solution does, and they are tried first.
    guess = solution if model.scene.touches_exactly else prolong(solution, held)
    return _started(model, solve(held, values, start=guess, estimate_error=False), GIVEN)


def _frees_bases(held: Model, model: Model) -> bool:
    """Whether bases that statics holds are unknowns of the model in motion."""
    return held.in_motion.size != model.size


def _started(model: Model, solution: Solution, sentence: str) -> Start:
    """Make the start in an equilibrium of the held scene."""
    x = _own_unloaded(model)
    if not solution.converged:
        return Start(x, solution.message, found=False)
    if model.scene.touches_exactly and solution.contacts:
        if _frees_bases(model_at_rest(model), model):
            return Start(x, FREE_TOUCHES, found=False)
        return _touching(model, solution, sentence)
    # Bases that are free begin where the scene puts them.
    unknowns = solution.model.discrete.unknowns
    for key, entries in unknowns.slices.items():
        x[model.discrete.unknowns.slices[key]] = solution.x[entries]
    near = None if model.scene.touches_exactly else solution
    return Start(np.asarray(x), sentence, equilibrium=near)


def least_gap_of_rods(model: Model, x: FloatArray, inputs: FloatArray) -> float:
    """Least gap between rods that may touch each other exactly, over the length; infinite without such rods.

    Args:
        model: model of the scene in motion.
        x: unknowns, shape (size,).
        inputs: stacked inputs, shape (model.inputs.size,).
    """
    if not model.scene.rods_touch_exactly:
        return float("inf")
    pairs = [facing for facing in facings(model) if isinstance(facing, RodsFacing)]
    return min((pair.deepest(pair.nodes(x, inputs)).gap for pair in pairs), default=float("inf"))


def _inputs(model: Model, solution: Solution) -> FloatArray:
    """Inputs of a motion with the values of a solution, shape (model.inputs.size,)."""
    names = set(model.inputs.names)
    # The forces of contacts are inputs of the solution's model.
    given = solution.model.inputs.unpack(solution.inputs)
    return model.pack({name: value for name, value in given.items() if name in names})


def _touching(model: Model, solution: Solution, sentence: str) -> Start:
    """Make a start in an equilibrium in contact on the modes of the motion, next to a solution."""
    inputs = _inputs(model, solution)
    held = model_at_rest(model)
    guess = held.with_flows(projected(solution, model)[: held.size])
    found = resting(ExactContacts(model), guess, inputs, solution.contacts)
    if found is None:
        modes = max(max(own.modes) for own in model.discretisation.values())
        refused = GIVEN_TOUCHES if sentence == GIVEN else TOUCHES
        return Start(model.unloaded(), refused.format(modes=modes), found=False, asks_for_modes=True)
    x, arrangement = found
    return Start(x, sentence, phases=arrangement)
