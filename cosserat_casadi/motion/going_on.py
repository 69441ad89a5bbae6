"""Continuation of a motion from the end of another, digit for digit equal to one motion over the whole time.

The motions that told the error of the first part go on beside it, so that they tell the error of the whole. Modes stay
as they were, and so do steps; equal steps that do not meet the tolerance further on are halved from there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.tube_checks import refuse_tubes
from cosserat_casadi.motion.centred_coordinates import CentredCoordinates, can_be_centred
from cosserat_casadi.motion.checkpoint import Checkpoint, Strand, of_another_scene, read_checkpoint
from cosserat_casadi.motion.fall_of_errors import FAR_APART, is_struck
from cosserat_casadi.motion.felt_modes import (
    ORDER_OF_WAVES,
    UNKNOWN_ORDER,
    lacking,
    lacking_at_fronts,
    most_modes,
    told_by_modes,
)
from cosserat_casadi.motion.history import History
from cosserat_casadi.motion.motion_checks import check_simulation
from cosserat_casadi.motion.motion_compiler import MotionCompiler
from cosserat_casadi.motion.motion_event import MotionEvent
from cosserat_casadi.motion.motion_start import resumed_start
from cosserat_casadi.motion.moving_model import moving_model
from cosserat_casadi.motion.simulate import (
    MOST_APART,
    MOST_HALVINGS,
    Companion,
    Simulator,
    Tell,
    bound_of,
    ended_early,
    judged,
    left_by,
    motion_of,
    moving_inputs,
    tolerance_of,
)
from cosserat_casadi.motion.tip_paths import path_distance
from cosserat_casadi.motion.trajectory import Motion, MotionOutcome
from cosserat_casadi.numerics.integration import StepOutcome
from cosserat_casadi.scene import Scene
from cosserat_casadi.scene.simulation import Simulation

StartOfMotion = Solution | Motion | Checkpoint | str | Path | None
"""The start of a motion: an equilibrium, or a motion that is continued, as a result, a checkpoint or a file."""

AGREEMENT = 1e-6
"""Largest distance of tips, over the length, at which a checkpoint counts as a state of a scene."""


def checkpoint_of(start: StartOfMotion) -> Checkpoint | None:
    """Return the checkpoint from which a motion continues; None if it begins at rest.

    Raises:
        SceneError: the motion or the file contains no state from which it can continue.
    """
    if isinstance(start, str | Path):
        found = read_checkpoint(start)
        if found is None:
            problem = f"{start} is no file of a motion, JSON or NPZ"
            raise SceneError(Problem("start", problem, "write one with motion.write, or pass an equilibrium"))
        return found
    if isinstance(start, Motion):
        if start.end is None:
            raise SceneError(Problem("start", "the motion did not start: no motion can go on from it", ""))
        return start.end
    return start if isinstance(start, Checkpoint) else None


def go_on(
    subject: Scene | Model,
    checkpoint: Checkpoint,
    simulation: Simulation | None,
    tell: Tell | None,
    source: MotionCompiler | None,
    events: Sequence[MotionEvent] = (),
) -> Motion:
    """Continue the motion of a scene from a checkpoint to its duration.

    Args:
        subject: the scene, or a model of it on the modes of the checkpoint.
        checkpoint: state from which the motion continues.
        simulation: duration, frames, tolerance; None for the settings of the scene.
        tell: callback after every step.
        source: selector of the kernels.
        events: events of the user.

    Raises:
        SceneError: the scene does not have the state of the checkpoint, or its duration does not reach beyond it.
    """
    given = subject.at() if isinstance(subject, Model) else None
    scene = given.scene if given is not None else _moving(subject, simulation)
    asked = simulation or scene.simulation
    model = _model_of(scene, given, checkpoint.strands[0], checkpoint)
    check_simulation(model, asked)
    assert asked is not None, "checked"
    if not asked.duration > checkpoint.time:
        problem = f"{asked.duration:g} s is not beyond t = {checkpoint.time:g} s, where the motion goes on"
        raise SceneError(Problem("simulation.duration", problem, "the time goes on: give the end of the whole motion"))
    start = resumed_start(model, checkpoint.strands[0].resume)
    simulator = Simulator(model, asked, start, "going on", tell, source, checkpoint, events)
    strands, before, apart = checkpoint.strands, np.inf, 0
    whole: Motion | None = None
    for _ in range(MOST_HALVINGS):
        motion, excess = _along(simulator, strands, of_model=given is not None)
        if motion.outcome is MotionOutcome.INTERRUPTED and whole is not None and np.isfinite(before):
            motion = replace(whole, outcome=motion.outcome, message=f"{motion.outcome.value} The motion is whole.")
        apart = apart + 1 if excess > max(before, FAR_APART) else 0
        if not excess > 1.0 or apart == MOST_APART:
            break
        whole, before, strands = motion, excess, tuple(one.halved() for one in strands)
    return motion if given is None else replace(motion, tolerance=None)


def _along(simulator: Simulator, strands: Sequence[Strand], *, of_model: bool) -> tuple[Motion, float]:
    """The motion from a checkpoint along its strands, and the error of equal steps over the error allowed.

    Modes leave a part of the tolerance to steps. The ratio is infinite where the motion ends early, and zero where
    shorter steps are of no use. An error of the parts before stays as it is.

    Args:
        simulator: the simulator of the first strand.
        strands: the motion, then the motions that tell its error.
        of_model: whether a model was given, and its modes with it.
    """
    scene, asked, checkpoint = simulator.model.scene, simulator.simulation, simulator.begun
    assert checkpoint is not None, "it goes on from one"
    may_be_shorter = simulator.has_equal_steps and asked.step is None
    history = simulator.resumed(strands[0])
    if not history.completed:
        is_early = history.outcome is not StepOutcome.INTERRUPTED
        return ended_early(simulator, history), np.inf if may_be_shorter and is_early else 0.0
    paths = simulator.paths(history)
    by_steps = 0.0 if len(strands) > 1 else float("nan")
    is_damped = all(rod.damping is not None for rod in scene.rods)
    # The factors of a first part tell of waves that it had: jumps that were to come were not known then.
    has_jumps = not is_damped and bool(simulator.moving.jumps(asked.duration))
    # Fronts of earlier loads are still on their way.
    by_modes = 0.0 if is_damped or of_model else lacking_at_fronts(history, asked.duration)
    companions = []
    for strand in strands[1:]:
        is_same = strand.discretisation == strands[0].discretisation
        other = simulator.model if is_same else _model_of_strand(scene, None, strand)
        start = resumed_start(other, strand.resume)
        beside = replace(simulator, model=other, start=start, stage="going on, for the error", begun=None)
        told = beside.resumed(strand)
        if told.outcome is StepOutcome.INTERRUPTED:
            message = f"{MotionOutcome.INTERRUPTED.value} The motion is whole, but its error is not known."
            return motion_of(simulator, history, MotionOutcome.INTERRUPTED, float("nan"), message), 0.0
        factor = max(strand.factor, _later_factor(simulator, strand, history, told, has_jumps=has_jumps))
        left = factor * path_distance(paths, beside.paths(told)) if told.completed else float("inf")
        if strand.by_modes:
            by_modes = max(by_modes, left)
        else:
            by_steps = max(by_steps, left)
        companions.append(Companion(told, factor, strand.impacts, strand.by_modes))
    by_steps = float(np.maximum(by_steps, simulator.fall.least(history, paths)))
    if not of_model and not scene.accuracy.fixed and not any(strand.by_modes for strand in strands):
        # The modes were enough so far, as their last coefficients told.
        by_modes += lacking(history, asked.duration)
    tolerance = tolerance_of(scene, asked)
    # An error that is not known makes that of the whole unknown.
    total = float(np.maximum(by_steps + by_modes, checkpoint.error))
    motion = judged(simulator, history, total, bound_of(scene, asked, tolerance), companions)
    left_by_modes = max(tolerance, checkpoint.error) - by_modes
    return motion, by_steps / left_by_modes if may_be_shorter and left_by_modes > 0.0 else 0.0


def _later_factor(simulator: Simulator, strand: Strand, history: History, told: History, *, has_jumps: bool) -> float:
    """Upper bound of the error of a motion over its distance from another one, revised by the continuation.

    Args:
        simulator: the simulator of the motion.
        strand: the strand of the other motion.
        history: the motion.
        told: the other motion.
        has_jumps: whether inputs jumped in an undamped scene.
    """
    modes = most_modes(history.model.discretisation)
    others = most_modes(strand.discretisation)
    if not is_struck(history) and not is_struck(told):
        return told_by_modes(modes, others, ORDER_OF_WAVES) if has_jumps and strand.by_modes else strand.factor
    if modes != others:
        return told_by_modes(modes, others, UNKNOWN_ORDER)
    if strand.discretisation != history.model.discretisation:
        return strand.factor
    if strand.settings.size is not None:
        return simulator.fall.factor(history, told) if simulator.rubs else strand.factor
    return left_by(float(np.max(strand.settings.tolerance / history.settings.tolerance)), history, told)


def _moving(subject: Scene | Model, simulation: Simulation | None) -> Scene:
    assert isinstance(subject, Scene), "a model has its scene"
    refuse_tubes(subject)
    scene = subject if simulation is None else subject.model_copy(update={"simulation": simulation})
    return scene.baked().with_motion_inputs()


def _model_of(scene: Scene, given: Model | None, strand: Strand, checkpoint: Checkpoint) -> Model:
    """Make the model of the first strand, and check that its tips are where they are in the checkpoint.

    Raises:
        SceneError: the scene does not have the state of the checkpoint.
    """
    model = _model_of_strand(scene, given, strand)
    at = strand.resume.at
    inputs = moving_inputs(model).at(at.time).value
    if can_be_centred(model):
        at = CentredCoordinates(model).to_model(at)
    for name, rod in model.discrete.rods.items():
        position = np.asarray(model.tip[name](at.x[: model.size], inputs)[0]).ravel()
        if not np.abs(position - checkpoint.tips[name]).max() <= AGREEMENT * rod.properties.length:
            raise of_another_scene()
    return model


def _model_of_strand(scene: Scene, given: Model | None, strand: Strand) -> Model:
    """Make the model of a strand, and check that its state has as many unknowns.

    Raises:
        SceneError: the scene does not have its state.
    """
    try:
        model = moving_model(scene, strand.discretisation) if given is None else given
    except (SceneError, ValueError) as error:
        raise of_another_scene() from error
    rubs = strand.resume.contacts is not None
    sizes = {len(strand.settings.tolerance), len(strand.resume.at.x[: model.size]), model.size}
    if len(sizes) > 1 or model.discretisation != strand.discretisation or rubs != scene.rubs_exactly:
        raise of_another_scene()
    return model
