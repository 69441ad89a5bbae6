"""Motions in two parts have the digits of one motion; their error is that of the whole; other scenes are refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from cosserat_casadi import SceneError, scene_from_dict, simulate
from cosserat_casadi.accuracy.refine import FINER_MODES
from cosserat_casadi.motion import simulate as motion_simulate
from cosserat_casadi.motion.checkpoint import Checkpoint, EnergyAccount, Resume, Strand
from cosserat_casadi.motion.fall_of_errors import HALVED
from cosserat_casadi.motion.felt_modes import SAFETY, UNKNOWN_ORDER, told_by_modes
from cosserat_casadi.motion.history import History
from cosserat_casadi.motion.motion_start import resumed_start
from cosserat_casadi.motion.simulate import Simulator, started
from cosserat_casadi.motion.trajectory import Motion, MotionOutcome, MotionProgress
from cosserat_casadi.numerics.integration import StepOutcome
from tests.families import mostly_slow
from tests.motion.stepping import moving_model
from tests.motion.test_exact_contact_in_motion import BALL, moving, rod

STEP = 1.0 / 64.0

BLOCK = {"name": "block", "kind": "sphere", "centre": [0.4, 0, -0.08], "radius": 0.04}


def swing(duration: float, *, step: float | None = STEP, free: bool = False, **more: Any) -> dict[str, Any]:
    """A soft rod under its weight and a push that has a kink at 0.125 s."""
    arm = {
        "name": "arm",
        "length": 0.5,
        "strain": "planar",
        "stiffness": {"bending_y": 0.016},
        "linear_density": 0.2,
        "rotary_inertia": [1e-7, 1e-7, 2e-7],
        "base": {"tangent": [1, 0, 0], "free": free},
        "damping": {"retardation_time": 5e-3},
    }
    simulation: dict[str, Any] = {"duration": duration, "frames": round(64 * duration) + 1, "start": "unloaded"}
    if step is not None:
        simulation["step"] = step
    push = {"name": "push", "kind": "tip_wrench", "rod": "arm", "force": [0, 0, 0]}
    kinked = {"input": "push.force", "times": [0.0, 0.125, 0.5], "values": [[0, 0, 0], [0, 0, 0.2], [0, 0, 0]]}
    weight = {"name": "weight", "kind": "gravity", "acceleration": [0, 0, -9.81]}
    tables = {"schema": 1, "rods": [arm], "loads": [weight, push], "motions": [kinked], "simulation": simulation}
    return {**tables, "accuracy": {"modes": 2, "nodes": 6, "tolerance": 1e-2}, **more}


def moved(tables: dict[str, Any], start: Any = None) -> Motion:
    return simulate(scene_from_dict(tables), start=start, compiled=False)


@pytest.mark.parametrize(
    ("split", "suffix"),
    mostly_slow([(0.0625, ".json"), (0.125, ".npz")], quick=[(0.125, ".npz")]),
    ids=["step", "kink"],
)
def test_two_parts_have_the_digits_of_one_motion(split: float, suffix: str, tmp_path: Path) -> None:
    file = tmp_path / f"first{suffix}"
    moved(swing(split)).write(file)
    second = moved(swing(0.1875), file)
    whole = moved(swing(0.1875))
    rows = whole.times >= split
    assert_array_equal(second.times, whole.times[rows])
    for name in ("x", "v", "a", "inputs"):
        assert_array_equal(getattr(second, name)[1:], getattr(whole, name)[rows][1:])
    for name in ("kinetic", "elastic", "potential", "dissipated", "work"):
        assert_array_equal(getattr(second.energy, name), getattr(whole.energy, name)[rows])
    # The weight comes suddenly at t = 0, not where the motion goes on.
    assert whole.warnings and not second.warnings
    # A motion of half the step and one on more modes go on beside it, and tell the error of the whole.
    assert second.end is not None and len(second.end.strands) == 3
    assert 0.8 * whole.error_estimate < second.error_estimate < 1.25 * whole.error_estimate


@pytest.mark.parametrize("split", [0.07, 0.1])
def test_a_motion_goes_on_from_within_a_given_step(split: float) -> None:
    """The steps that follow are counted from there: its times were shifted by up to half a step."""
    second = moved(swing(0.1875), moved(swing(split)))
    whole = moved(swing(0.1875))
    assert second.converged, second.message
    ends = [motion.tip().position[-1] for motion in (second, whole)]
    assert np.linalg.norm(ends[0] - ends[1]) / 0.5 < whole.error_estimate
    assert 0.3 * whole.error_estimate < second.error_estimate < 3.0 * whole.error_estimate


@pytest.mark.parametrize("subject", mostly_slow(["held", "free", "touches"], quick=["held"]))
def test_what_was_interrupted_takes_the_steps_of_one_motion(subject: str) -> None:
    """Controlled steps: the Jacobian in use, the error and the polynomial of the last step are taken over.

    To the last bit; in contact to rounding, since a contact's Jacobian is computed anew.
    Where nothing is taken over they differ by 1e-8.
    """
    rounding = 1e-14 if subject == "touches" else 0.0
    if subject == "touches":
        model = moving(rod(BALL, duration=0.4, damping=0.03))
    else:
        model = moving_model(swing(0.25, step=None, free=subject == "free"))
    assert model.scene.simulation is not None
    simulator = Simulator(model, model.scene.simulation, started(model, model.scene.simulation, None))
    whole = simulator.controlled(1e-2)
    assert whole.completed
    for steps in (1, len(whole.steps) // 2):
        first = replace(simulator, tell=Interruption(steps)).controlled(1e-2)
        assert first.outcome is StepOutcome.INTERRUPTED
        second = replace(simulator, start=resumed_start(model, through_data(first))).resumed(strand(first))
        assert len(second.steps) == len(whole.steps) - len(first.steps)
        assert_allclose(second.end.x, whole.end.x, rtol=0, atol=rounding)
        assert_allclose(second.end.v, whole.end.v, rtol=0, atol=100 * rounding)
    assert bool(whole.events) == (subject == "touches")


class Interruption:
    """Stops a motion as Ctrl-C does, after so many steps and one more."""

    def __init__(self, steps: int) -> None:
        self.left = steps

    def __call__(self, _: MotionProgress) -> None:
        if self.left == 0:
            raise KeyboardInterrupt
        self.left -= 1


def strand(history: History) -> Strand:
    return Strand(history.model.discretisation, history.settings, False, 0.0, 0.0, False, history.resume)


def through_data(history: History) -> Resume:
    kept = Checkpoint(0.1, (strand(history),), 0.0, EnergyAccount(0.0), {})
    return Checkpoint.from_data(kept.to_data()).strands[0].resume


def test_what_does_not_fit_is_refused(tmp_path: Path) -> None:
    first = moved(swing(0.0625))
    with pytest.raises(SceneError, match="is not beyond"):
        moved(swing(0.0625), first)
    longer = swing(0.25)
    longer["rods"][0]["length"] = 0.6
    with pytest.raises(SceneError, match="another scene"):
        moved(longer, first)
    file = tmp_path / "none.json"
    file.write_text("{}")
    with pytest.raises(SceneError, match="no file of a motion"):
        moved(swing(0.1875), file)


@pytest.mark.parametrize("number", [0, -1])
def test_a_motion_does_not_go_on_from_other_modes_than_its_states_have(number: int) -> None:
    first = moved(swing(0.0625))
    assert first.end is not None and len(first.end.strands) > 1
    data = first.end.to_data()
    (own,) = data["strands"][number]["discretisation"].values()
    own["modes"] = [count + 1 for count in own["modes"]]
    with pytest.raises(SceneError, match="another scene"):
        moved(swing(0.1875), Checkpoint.from_data(data))


def test_modes_that_were_enough_for_a_rod_at_rest_are_judged_anew_where_it_is_knocked() -> None:
    knock = {
        "input": "push.force",
        "times": [0.0, 0.2, 0.21, 0.22],
        "values": [[0, 0, 0], [0, 0, 0], [0, 0, 8], [0, 0, 0]],
    }
    tables = swing(0.1, step=None, accuracy={}, motions=[knock])
    del tables["loads"][0]
    tables["simulation"] |= {"tolerance": 5e-2, "frames": 11, "start": "equilibrium"}
    first = moved(tables)
    assert first.converged
    tables["simulation"] |= {"duration": 0.3, "frames": 31}
    second = moved(tables, first)
    assert second.outcome is MotionOutcome.UNRESOLVED
    exact = moved({**tables, "simulation": tables["simulation"] | {"tolerance": 5e-3}}).tip().position
    error = np.linalg.norm(second.tip().position - exact[-len(second.times) :], axis=1).max() / 0.5
    assert 1e-3 < error < second.error_estimate


@pytest.mark.parametrize(("alike", "larger"), [(False, 4.0), (True, 2.5)])
def test_blows_count_in_the_error_of_a_motion_that_goes_on_to_them(
    alike: bool, larger: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before them two motions tell an error with smaller factors: that of its steps was a fifth of what it is.

    Of motions with the same blows it was two fifths.
    """
    if not alike:
        monkeypatch.setattr(motion_simulate, "are_struck_alike", lambda *_: False)
    tables = {**swing(0.125, step=None), "motions": [], "obstacles": [BLOCK]}
    tables["accuracy"]["tolerance"] = 1e-3
    first = moved({**tables, "simulation": {**tables["simulation"], "duration": 0.0625}})
    second = moved(tables, first)
    assert not first.events
    assert any(event.kind == "impact" for event in second.events)
    assert first.end is not None and second.end is not None
    assert [strand.by_modes for strand in second.end.strands] == [False, False, True]
    (steps, modes), factors = ([strand.factor for strand in motion.end.strands[1:]] for motion in (first, second))
    assert larger * steps < factors[0]
    assert_allclose(modes, SAFETY, rtol=1e-12, atol=0)
    assert_allclose(factors[1], told_by_modes(2, 2 + FINER_MODES, UNKNOWN_ORDER), rtol=1e-12, atol=0)
    assert first.error_estimate < second.error_estimate
    # A motion without a break has the same factor for the error of its modes.
    whole = moved(tables)
    assert whole.end is not None
    assert_allclose(whole.end.strands[-1].factor, factors[1], rtol=1e-12, atol=0)


def test_steps_of_given_size_keep_their_factor_after_blows() -> None:
    """The second motion has half of the steps, whatever tolerance both were computed with."""
    tables = {**swing(0.125), "motions": [], "obstacles": [BLOCK]}
    first = moved({**tables, "simulation": {**tables["simulation"], "duration": 0.0625}})
    second = moved(tables, first)
    assert any(event.kind == "impact" for event in second.events)
    assert first.end is not None and second.end is not None
    assert second.end.strands[1].factor == first.end.strands[1].factor == HALVED


def test_the_motion_of_more_modes_keeps_its_steps_where_equal_steps_are_halved() -> None:
    """Steps of a tolerance tell the error of fixed modes of a motion by Gauss's method."""

    def pushed(duration: float, tolerance: float) -> dict[str, Any]:
        tables = swing(duration, step=None)
        tables["motions"][0] |= {"times": [0.0, 0.2, 0.21], "values": [[0, 0, 0], [0, 0, 1e-3], [0, 0, 0.02]]}
        tables["loads"] = tables["loads"][1:]
        tables["simulation"] |= {"integrator": "gauss", "tolerance": tolerance}
        return tables | {"accuracy": {"modes": 5, "nodes": 12}}

    slow = moved(pushed(0.2, 1e-3))
    later = moved(pushed(0.3, 1e-2), start=slow)
    assert later.error_estimate is not None
    # What the modes leave of this tolerance is a little less than what the steps are off by.
    finer = moved(pushed(0.3, later.error_estimate * (1.0 - 1e-6)), start=slow)
    assert finer.statistics.largest_step == later.statistics.largest_step / 2.0
    assert finer.end is not None and slow.end is not None
    before, after = ([strand.settings for strand in motion.end.strands if strand.by_modes] for motion in (slow, finer))
    assert before == after and before[0].size is None

    def stopped_in_shorter_steps(news: MotionProgress) -> None:
        if news.stage == "going on" and news.step < 0.75 * later.statistics.largest_step:
            raise KeyboardInterrupt

    asked = scene_from_dict(pushed(0.3, later.error_estimate * (1.0 - 1e-6)))
    stopped = simulate(asked, start=slow, compiled=False, progress=stopped_in_shorter_steps)
    assert stopped.outcome is MotionOutcome.INTERRUPTED and "The motion is whole" in stopped.message
    assert stopped.end is not None and stopped.end.time == 0.3
    assert stopped.error_estimate == pytest.approx(later.error_estimate)
