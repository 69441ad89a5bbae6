"""Simulations as a whole: their rows, their two front doors, and every way in which they refuse or end early."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Motion, MotionOutcome, SceneError, scene_from_dict, simulate, solve
from cosserat_casadi.motion import motion_start
from cosserat_casadi.motion.motion_start import EQUILIBRIUM
from cosserat_casadi.motion.trajectory import MotionProgress
from tests.motion import transients
from tests.motion.stepping import moving_model
from tests.motion.transients import at_tip, gravity, table

IN_SPACE = {
    "strain": "kirchhoff",
    "stiffness": {"bending_x": 1.0, "bending_y": 1.0, "torsion": 0.8},
    "rotary_inertia": [1e-3, 1e-3, 2e-3],
}
PIN = {"rod": "rod", "kind": "pinned", "position": [0.8, 0.0, 0.1]}
FEW = {"modes": 3, "nodes": 8}


def asked(**simulation: Any) -> dict[str, Any]:
    return {"duration": 0.4, "tolerance": 1e-3, **simulation}


def falling(**changes: Any) -> dict[str, Any]:
    """A straight cantilever that is let go."""
    return table({}, gravity(10.0), **{"accuracy": FEW, "simulation": asked(start="unloaded"), **changes})


def held(**changes: Any) -> dict[str, Any]:
    """A rod whose tip is pinned."""
    return table(IN_SPACE, gravity(1.0), **{"accuracy": FEW, "supports": [PIN], "simulation": asked(), **changes})


def simulated(scene: dict[str, Any]) -> Motion:
    return simulate(moving_model(scene))


# Rows


def test_rows_are_at_the_frames_or_the_times() -> None:
    even = simulated(falling(simulation=asked(start="unloaded", frames=5)))
    assert_allclose(even.times, [0.0, 0.1, 0.2, 0.3, 0.4], rtol=0, atol=1e-15)
    given = simulated(falling(simulation=asked(start="unloaded", times=[0.1, 0.15, 0.4])))
    assert_allclose(given.times, [0.1, 0.15, 0.4], rtol=0, atol=1e-15)
    assert_allclose(given.tip().position[[0, 2]], even.tip().position[[1, 4]], rtol=0, atol=1e-14)
    assert len(given.energy.kinetic) == len(given.x) == 3


def test_a_row_at_a_jump_has_what_held_before_it() -> None:
    """Inputs and accelerations jump there, positions and velocities do not; at t = 0 the jump is over."""
    for jump, wanted in ((0.2, [0.0, 0.0, 0.0, 0.5, 0.5]), (0.0, [0.5, 0.5, 0.5, 0.5, 0.5])):
        values = [[0.0, 0.0, 0.0], [0.0, 0.0, 0.5]]
        step = {"input": "push.force", "times": [jump - 1.0, jump], "values": values, "interpolation": "step"}
        scene = table({}, at_tip(), accuracy=FEW, motions=[step])
        motion = simulated({**scene, "simulation": asked(start="unloaded", frames=5)})
        assert_allclose(motion.inputs[:, motion.model.inputs.slices["push.force"]][:, 2], wanted, rtol=0, atol=0)
        assert_allclose(motion.at(0.2).inputs, motion.inputs[2], rtol=0, atol=0)
        if jump > 0.0:
            assert_allclose(motion.a[2], 0.0, rtol=0, atol=1e-9)
            assert np.abs(motion.at(0.2 + 1e-6).a).max() > 0.1


def test_dense_output_is_what_the_rows_hold() -> None:
    motion = simulated(falling())
    for row in (0, 17, 60, 100):
        state = motion.at(float(motion.times[row]))
        assert_allclose(state.x, motion.x[row], rtol=0, atol=0)
        assert_allclose(state.v, motion.v[row], rtol=0, atol=0)
        assert_allclose(state.a, motion.a[row], rtol=0, atol=0)


def test_dense_output_is_smooth_and_satisfies_the_equations() -> None:
    """Rates are derivatives of positions, and the equations hold at any time as nearly as the tolerance says."""
    scene = transients.line_load(duration=1.0, tolerance=1e-6, times=[0.0, 1.0])
    scene["accuracy"] = FEW
    motion = simulated(scene)
    step = 1e-5
    for time in (0.21, 0.5, 0.83):
        before, state, after = (motion.at(time + shift) for shift in (-step, 0.0, step))
        assert_allclose((after.x - before.x) / (2 * step), state.v, rtol=0, atol=1e-6)
        # The load's own rates do not enter: it is dead.
        still = np.zeros(motion.model.inputs.size)
        residual = motion.model.inverse_dynamics(state.x, state.v, state.a, state.inputs, still, still).full()
        assert_allclose(residual, 0.0, rtol=0, atol=2e-3)


@pytest.mark.parametrize(
    ("accuracy", "tolerance", "within"),
    [
        ({"modes": 1, "nodes": 4}, 1e-5, False),
        ({"modes": 1, "nodes": 4}, 0.1, True),
        ({"modes": 1, "nodes": 4}, None, None),
        ({"modes": 1, "nodes": 4, "tolerance": 1e-5}, None, False),
    ],
)
def test_an_error_is_set_beside_a_tolerance_that_is_written(
    accuracy: dict[str, Any], tolerance: float | None, within: bool | None
) -> None:
    simulation = {"duration": 0.02, "start": "unloaded"}
    if tolerance is not None:
        simulation["tolerance"] = tolerance
    tables = falling(accuracy=accuracy, simulation=simulation)
    motion = simulate(scene_from_dict(tables))
    assert motion.converged, motion.message
    assert 1e-5 < motion.error_estimate < 0.1
    assert motion.within_tolerance is within
    # A model has its modes, whose error no motion tells.
    assert simulated(tables).within_tolerance is None


def test_a_model_moves_as_its_scene_does() -> None:
    """On fixed modes both front doors give one motion, to the tolerance of the steps."""
    scene = falling()
    of_model = simulated(scene)
    of_scene = simulate(scene_from_dict(scene))
    assert of_scene.model.discretisation == of_model.model.discretisation
    assert_allclose(of_scene.tip().position, of_model.tip().position, rtol=0, atol=1e-3)
    # What is missing for want of modes is in the estimate of the scene alone.
    assert of_scene.error_estimate > of_model.error_estimate


def test_given_equilibrium_is_where_the_motion_starts() -> None:
    """A bent rod is let go: the force is gone in motion, where it goes from its value to zero at once."""
    scene = table({}, at_tip(force=[0, 0, 0.5]), accuracy=FEW, simulation=asked())
    bent = solve(scene_from_dict(scene))
    motion = simulate(moving_model(scene), start=bent)
    assert_allclose(motion.tip().position, np.tile(bent.tip().position, (101, 1)), rtol=0, atol=1e-9)
    assert motion.energy.kinetic.max() < 1e-15


def test_a_scene_on_which_nothing_acts_starts_without_statics(monkeypatch: pytest.MonkeyPatch) -> None:
    def asked_for(*_: Any, **__: Any) -> None:
        raise AssertionError("an equilibrium was solved for")

    grown = {"input": "push.force", "times": [0.0, 0.3], "values": [[0.0, 0.0, 0.0], [0.0, 0.0, 0.5]]}
    scene = table({}, at_tip(force=[0, 0, 0]), accuracy=FEW, simulation=asked(), motions=[grown])
    solved = simulated({**scene, "loads": [*scene["loads"], gravity(1e-9)]})
    monkeypatch.setattr(motion_start, "solve", asked_for)
    motion = simulated(scene)
    assert motion.start == EQUILIBRIUM == solved.start
    assert_allclose(motion.x[0], 0.0, rtol=0, atol=0)
    assert_allclose(motion.tip().position, solved.tip().position, rtol=0, atol=1e-6)
    with pytest.raises(AssertionError, match="was solved for"):
        simulated({**scene, "loads": [*scene["loads"], gravity(1e-9)]})


# Refused


def refused(scene: Callable[[], dict[str, Any]] | dict[str, Any]) -> str:
    given = scene() if callable(scene) else scene
    with pytest.raises(SceneError) as caught:
        simulate(scene_from_dict(given))
    return str(caught.value)


def test_scene_without_simulation_is_refused() -> None:
    scene = falling()
    del scene["simulation"]
    assert refused(scene).startswith("simulation: missing")


def test_rod_without_mass_is_refused_where_its_mass_would_stand() -> None:
    scene = table({}, at_tip(), simulation=asked())
    del scene["rods"][0]["linear_density"]
    assert refused(scene).startswith("rods[0].linear_density: missing: 'rod' has no mass")
    rod = scene["rods"][0]
    del rod["stiffness"]
    rod["material"] = {"youngs_modulus": 1e6, "poisson_ratio": 0.3}
    rod["section"] = {"shape": "circle", "radius": 0.01}
    assert refused(scene).startswith("rods[0].material.density: missing: 'rod' has no mass")


def test_gauss_is_refused_for_supports() -> None:
    assert "simulation.integrator: 'gauss' does not converge" in refused(held(simulation=asked(integrator="gauss")))


def test_start_off_a_support_is_refused() -> None:
    """Nothing is moved there in silence."""
    message = refused(held(simulation=asked(start="unloaded")))
    assert "simulation.start: supports or joints are open by 0.2 (of the length, or rad)" in message


def test_base_that_starts_with_a_speed_is_refused_in_a_loop() -> None:
    moved = {"input": "rod.base.position", "amplitude": [0.05, 0, 0], "frequency": 1.0}
    message = refused(held(motions=[moved]))
    assert "motions: 'rod.base.position', which moves supports, joints or cables, has a speed at t = 0" in message
    # Without a support the rod goes along with its base.
    assert simulated(table(IN_SPACE, gravity(1.0), accuracy=FEW, motions=[moved], simulation=asked())).converged


# Ended early


def test_scene_without_equilibrium_has_no_start() -> None:
    """Three coordinates cannot meet six equations of a clamped tip."""
    clamp = {**PIN, "kind": "clamped", "quaternion": [1, 0, 0, 0]}
    tables = held(supports=[clamp], accuracy={"modes": 1, "nodes": 4})
    assert simulate(scene_from_dict(tables)).within_tolerance is False
    motion = simulated(tables)
    assert motion.outcome is MotionOutcome.NO_START
    assert motion.message.startswith(MotionOutcome.NO_START.value)
    assert motion.times.shape == (0,)
    assert motion.tip().position.shape == (0, 3)
    with pytest.raises(ValueError, match="did not start"):
        motion.at(0.0)


def test_load_beyond_all_numbers_ends_the_motion() -> None:
    """What was computed until then stands."""
    blown = {"input": "push.force", "times": [0.0, 0.2, 0.4], "values": [[0, 0, 0], [0, 0, 1], [0, 0, 1e300]]}
    motion = simulated(table({}, at_tip(), accuracy=FEW, motions=[blown], simulation=asked(start="unloaded")))
    assert motion.outcome in (MotionOutcome.NOT_FINITE, MotionOutcome.STEP_TOO_SMALL)
    assert_allclose(motion.times[-1], 0.2, rtol=0, atol=0.0041)
    assert "Reached: t = 0.2 s" in motion.message
    assert np.all(np.isfinite(motion.x))


def test_motion_that_ends_before_its_first_row_has_none() -> None:
    """It is a motion all the same: it can be asked for poses, and be written."""
    blown = {"input": "push.force", "times": [0.0, 0.1], "values": [[0, 0, 0], [0, 0, 1e300]]}
    scene = table({}, at_tip(), accuracy=FEW, motions=[blown], simulation=asked(start="unloaded", times=[0.3, 0.4]))
    motion = simulated(scene)
    assert not motion.converged
    assert motion.x.shape == (0, motion.model.size)
    assert motion.tip().position.shape == (0, 3)
    assert motion.to_dict()["converged"] is False


def test_few_modes_do_not_resolve_a_rod() -> None:
    motion = simulate(scene_from_dict(falling(accuracy={"modes": 1, "nodes": 3})))
    assert motion.outcome is MotionOutcome.UNRESOLVED
    assert motion.error_estimate > 0.1
    assert f"{motion.error_estimate:.2g}" in motion.message
    assert len(motion.times) == 101


def test_step_that_is_too_long_is_not_solved() -> None:
    simulation = asked(start="unloaded", duration=1e3, step=1e3)
    motion = simulated(falling(accuracy={"modes": 6, "nodes": 12}, simulation=simulation))
    assert motion.outcome is MotionOutcome.NOT_SOLVED
    assert len(motion.times) == 1


def interrupt_after(time: float) -> Callable[[MotionProgress], None]:
    """Stands for Ctrl-C at a time of the motion."""

    def tell(progress: MotionProgress) -> None:
        if progress.time > time:
            raise KeyboardInterrupt

    return tell


def test_interrupted_motion_keeps_its_rows() -> None:
    motion = simulate(moving_model(falling()), progress=interrupt_after(0.2))
    assert motion.outcome is MotionOutcome.INTERRUPTED
    assert 0.2 < motion.times[-1] < 0.4
    assert_allclose(motion.tip().position, simulated(falling()).tip().position[: len(motion.times)], rtol=0, atol=5e-3)


@pytest.mark.parametrize("changes", [{}, {"integrator": "gauss"}, {"step": 0.02}])
@pytest.mark.parametrize("kind", ["model", "scene", "scene without modes"])
def test_interrupted_in_a_more_exact_motion_keeps_the_whole_one(changes: dict[str, Any], kind: str) -> None:
    """The second motion tells the error of the first: what it had computed is shorter, and is not returned."""
    begun = 0
    latest = 0.0
    interrupted = False

    def tell(progress: MotionProgress) -> None:
        nonlocal begun, latest, interrupted
        begun += progress.time <= latest or not begun
        latest = progress.time
        if begun == 2 and not interrupted:
            interrupted = True
            raise KeyboardInterrupt

    table = falling(simulation=asked(start="unloaded", **changes))
    if kind == "scene without modes":
        table["accuracy"] = {}
    motion = simulate(moving_model(table) if kind == "model" else scene_from_dict(table), progress=tell)
    assert interrupted and begun == 2
    assert motion.outcome is MotionOutcome.INTERRUPTED
    assert motion.times[-1] == 0.4
    assert "The motion is whole" in motion.message and "its error is not known" in motion.message
    assert np.isnan(motion.error_estimate)


def test_interrupted_search_keeps_the_best_whole_motion() -> None:
    """Whoever stops the choice of modes gets the last motion computed to its end, and what is known of its error."""
    scene = falling(accuracy={}, simulation=asked(start="unloaded", tolerance=1e-4))
    stages: list[str] = []

    def tell(progress: MotionProgress) -> None:
        if progress.stage not in stages:
            stages.append(progress.stage)
        if len(stages) == 3:
            raise KeyboardInterrupt

    motion = simulate(scene_from_dict(scene), progress=tell)
    assert motion.outcome is MotionOutcome.INTERRUPTED
    assert len(motion.times) == 101
    assert "whole, but not as exact as was asked: the modes leave an error of about" in motion.message
    whole = simulate(scene_from_dict(scene))
    apart = np.linalg.norm(motion.tip().position - whole.tip().position, axis=1).max()
    assert apart < motion.error_estimate < 0.1


def test_interrupted_search_foresees_no_error_of_given_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    """Steps of given size are not chosen by the tolerance: where nothing tells their error, none is named."""
    monkeypatch.setattr("cosserat_casadi.motion.simulate.MOST_HALVINGS", 0)
    stages: set[str] = set()

    def tell(progress: MotionProgress) -> None:
        stages.add(progress.stage)
        if len(stages) == 3:
            raise KeyboardInterrupt

    scene = falling(accuracy={}, simulation=asked(start="unloaded", integrator="gauss", tolerance=1e-4))
    motion = simulate(scene_from_dict(scene), progress=tell)
    assert motion.outcome is MotionOutcome.INTERRUPTED
    assert np.isnan(motion.error_estimate)
    assert "its error is not known" in motion.message


def test_steps_whose_error_is_not_known_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """A motion is whole, and yet not the one that was asked for, where nothing says how exact it is."""
    monkeypatch.setattr("cosserat_casadi.motion.simulate.MOST_TIGHTENINGS", 0)
    scene = {**transients.line_load(tolerance=1e-3, times=[0.0, 0.5]), "accuracy": {"modes": 4, "nodes": 12}}
    motion = simulate(moving_model(scene))
    assert motion.outcome is MotionOutcome.UNRESOLVED
    assert "could not be estimated" in motion.message
    assert len(motion.times) == 2


def test_a_start_that_is_refused_takes_no_step() -> None:
    """Before anything is integrated: the support of this rod is not where its unloaded tip is."""
    support = {"rod": "rod", "kind": "pinned", "position": [0.5, 0.0, 0.5]}
    scene = {**transients.line_load(start="unloaded"), "supports": [support]}
    scene["accuracy"] = {"modes": 4, "nodes": 12}
    steps: list[MotionProgress] = []
    with pytest.raises(SceneError, match="open by"):
        simulate(moving_model(scene), progress=steps.append)
    assert steps == []


@pytest.mark.slow
def test_a_rod_that_merely_falls_is_not_warned_of_waves() -> None:
    free = {**IN_SPACE, "base": {"position": [0, 0, 0], "free": True}}
    simulation = asked(start="unloaded", duration=0.1)
    falls = simulated(table(free, gravity(9.81), accuracy=FEW, simulation=simulation))
    assert falls.warnings == ()
    pushed = simulated(table(free, at_tip(force=[1.0, 0.0, 0.0]), accuracy=FEW, simulation=simulation))
    assert len(pushed.warnings) == 1
    assert "out of balance" in pushed.warnings[0]


def test_modes_that_are_never_tried_count_by_the_last_coefficients_there_are() -> None:
    """A rod that is hardly bent has the same modes on the second level: their distance is rounding, not an error."""
    lifted = {
        "input": "rod.base.position",
        "amplitude": [0.0, 0.0, 0.01],
        "frequency": 0.02,
        "wave": "one_minus_cosine",
    }
    damped = {"damping": {"retardation_time": 0.01}}
    motion = simulate(scene_from_dict(table(damped, motions=[lifted], simulation=asked(duration=1.0))))
    assert motion.converged, motion.message
    assert 1e-12 < motion.error_estimate < 1e-4


@pytest.mark.parametrize(("disks", "first"), [(3, 6), (4, 4)])
def test_rods_in_short_elements_begin_on_fewer_modes(disks: int, first: int, caplog: pytest.LogCaptureFixture) -> None:
    rows = [{"rod": "rod", "count": disks, "radius": 0.01}]
    scene = table({"damping": {"retardation_time": 0.01}}, gravity(1e-3), disks=rows, simulation=asked(duration=0.01))
    with caplog.at_level("INFO", "cosserat_casadi.motion"):
        assert simulate(scene_from_dict(scene)).converged
    assert caplog.messages[0].startswith(f"up to {first} modes")


def test_a_free_pair_in_line_that_nothing_keeps_from_spinning_is_told() -> None:
    """Neither rod has rotary inertia: a spin about their common axis has no kinetic energy."""
    rod = {"length": 0.5, "strain": "planar", "stiffness": {"bending_y": 0.05}, "linear_density": 0.1}
    first = {"name": "first", **rod, "base": {"position": [0, 0, 0], "free": True}}
    second = {"name": "second", **rod, "base": {"rod": "first", "at": 1.0}}
    thrown = [{"rod": "first", "linear": [0.1, 0.0, 0.2]}]
    scene = {"schema": 1, "rods": [first, second], "velocities": thrown, "accuracy": FEW}
    motion = simulated({**scene, "simulation": asked(start="unloaded")})
    assert motion.outcome is MotionOutcome.STEP_TOO_SMALL
    assert motion.message.endswith(
        "'first', 'second' can spin about the tangent without resistance: give rotary_inertia, kg m."
    )
    for one in (first, second):
        one["rotary_inertia"] = [1e-6, 1e-6, 2e-6]
    assert simulated({**scene, "simulation": asked(start="unloaded")}).converged
