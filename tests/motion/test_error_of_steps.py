"""The error that the steps of a motion leave, as a coarser motion tells it, beside that of a far more exact one."""

from __future__ import annotations

from typing import Any

import pytest

from cosserat_casadi import Scene, build, read_scene, scene_from_dict, simulate
from cosserat_casadi.motion import motion_refinement
from cosserat_casadi.motion import simulate as motion_simulate
from cosserat_casadi.motion.motion_refinement import COARSER, ResolvedMotion, exact_in_time, told_by_coarser
from cosserat_casadi.motion.simulate import TIGHTER, Simulator, started
from cosserat_casadi.motion.tip_paths import path_distance
from tests.families import mostly_slow
from tests.motion import transients

STEP_TOLERANCE = 1e-3


def simulator_of(asked: dict[str, Any]) -> Simulator:
    """The motion of a scene on five modes."""
    return simulator_on(scene_from_dict({**asked, "accuracy": {"modes": 5, "nodes": 10}}))


def simulator_on(scene: Scene) -> Simulator:
    """The motion of a scene on the modes that it fixes."""
    model = build(scene.with_motion_inputs(), moving=True)
    simulation = scene.simulation
    assert simulation is not None
    return Simulator(model, simulation, started(model, simulation, None))


def free_rod() -> Simulator:
    """A rod that is kicked in space."""
    return simulator_of(transients.flying_in_space(duration=4.0, frames=2))


def cantilever() -> Simulator:
    """A cantilever on which a weight acts at once."""
    return simulator_of(transients.sudden_weight(duration=1.0))


@pytest.fixture(
    scope="module", params=mostly_slow([free_rod, cantilever], quick=[cantilever]), ids=["free rod", "cantilever"]
)
def level(request: pytest.FixtureRequest) -> ResolvedMotion:
    """A motion and the steps that it was computed with."""
    simulator: Simulator = request.param()
    history = simulator.controlled(STEP_TOLERANCE)
    return ResolvedMotion(simulator, history, simulator.paths(history))


def true_error(simulator: Simulator, found: Any) -> float:
    """Distance from a motion with far more exact steps, over the length."""
    exact = simulator.controlled(1e-2 * STEP_TOLERANCE)
    return path_distance(simulator.paths(found), simulator.paths(exact))


def test_error_of_steps_that_no_coarser_motion_makes_longer() -> None:
    """A rod that is spun up slowly takes six steps at both tolerances: half of them tell the error."""
    simulator = simulator_of(transients.spin_up(0.1, duration=1.0, times=[0.5, 1.0]))
    history = simulator.controlled(STEP_TOLERANCE)
    assert simulator.controlled(COARSER * STEP_TOLERANCE).statistics.steps == history.statistics.steps
    told = told_by_coarser(ResolvedMotion(simulator, history, simulator.paths(history)), STEP_TOLERANCE)
    true = true_error(simulator, history)
    assert true > 1e-6
    assert 0.8 * true <= told.error <= 4.0 * true


def test_error_told_by_a_coarser_motion_is_not_too_small(level: ResolvedMotion) -> None:
    told = told_by_coarser(level, STEP_TOLERANCE)
    error = true_error(level.simulator, level.history)
    assert told.history is level.history
    assert error <= told.error
    # Nor is it without use.
    assert told.error <= 100.0 * error


def test_coarser_motion_that_does_not_end_tells_nothing(level: ResolvedMotion, monkeypatch: pytest.MonkeyPatch) -> None:
    broken = level.history
    monkeypatch.setattr(type(broken), "completed", False)
    assert told_by_coarser(level, STEP_TOLERANCE).error == float("inf")


def test_steps_are_made_more_exact_until_their_error_is_allowed(level: ResolvedMotion) -> None:
    told = told_by_coarser(level, STEP_TOLERANCE)
    allowed = told.error / 2.0
    found = exact_in_time(level, STEP_TOLERANCE, allowed)
    assert found.tolerance <= STEP_TOLERANCE / COARSER
    assert found.error <= allowed
    assert true_error(level.simulator, found.history) <= found.error


def test_steps_of_a_model_are_made_more_exact_until_they_agree() -> None:
    simulator = cantilever()
    wanted = 0.5 * true_error(simulator, simulator.controlled(STEP_TOLERANCE))
    timed = simulator.to_tolerance(wanted, first=STEP_TOLERANCE)
    assert timed.tolerance <= STEP_TOLERANCE / TIGHTER * (1.0 + 1e-12)
    assert true_error(simulator, timed.history) <= timed.error <= wanted


def test_a_search_takes_a_motion_on_each_set_of_modes_and_one_for_its_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    sizes = []
    plain = Simulator.controlled

    def counted(simulator: Simulator, tolerance: float) -> Any:
        sizes.append(simulator.model.size)
        return plain(simulator, tolerance)

    monkeypatch.setattr(Simulator, "controlled", counted)
    motion = simulate(scene_from_dict(transients.sudden_weight(tolerance=1e-2)))
    assert motion.converged, motion.message
    assert len(sizes) == len(set(sizes)) + 1
    assert sizes[-1] == sizes[-2] == motion.model.size


def test_a_steel_wire_is_not_buckled_by_what_newtons_method_leaves_of_its_stretch() -> None:
    """A thousandth of the tolerance is a stretch by 1600 times EI/ℓ²; with it 23 of 67 steps were refused."""
    wire = {
        "name": "wire",
        "length": 1.0,
        "strain": "reissner",
        "material": {"youngs_modulus": 2e11, "poisson_ratio": 0.3, "density": 7850.0},
        "section": {"shape": "circle", "radius": 5e-5},
        "base": {"position": [0, 0, 0], "tangent": [0, 0, -1]},
        "damping": {"retardation_time": 1e-3},
    }
    sway = {"input": "wire.base.position", "amplitude": [0.05, 0, 0], "frequency": 1.5, "wave": "one_minus_cosine"}
    scene = scene_from_dict(
        {
            "schema": 1,
            "accuracy": {"modes": 4, "nodes": 12},
            "rods": [wire],
            "loads": [{"name": "weight", "kind": "gravity", "acceleration": [0, 0, -9.81]}],
            "motions": [sway],
            "simulation": {"duration": 0.4, "frames": 2, "start": "equilibrium"},
        }
    )
    history = simulator_on(scene).controlled(STEP_TOLERANCE)
    assert history.completed
    assert history.statistics.rejected <= 10


@pytest.mark.parametrize(("distances", "erratic"), [([0.1, 0.09], True), ([0.1, 0.03, 1e-6], False)])
def test_motions_that_more_exact_steps_bring_no_nearer_end_a_search(
    monkeypatch: pytest.MonkeyPatch, distances: list[float], erratic: bool
) -> None:
    """Errors that go with the root of the tolerance leave a third of a distance; those of rounding leave all of it."""
    given = ["accuracy.modes=2", "accuracy.nodes=10", "simulation.duration=0.2"]
    simulator = simulator_on(read_scene("examples/bouncing_rod.toml", given))
    coarse = simulator.controlled(1e-2)
    assert any(event.kind == "impact" for event in coarse.events)
    told = iter(distances)
    monkeypatch.setattr(motion_simulate, "path_distance", lambda *_: next(told))
    timed = simulator.tightened(coarse, 1e-2, 1e-3)
    assert list(told) == []
    assert (timed.error > 1e-3) is erratic
    # In a search, from the more exact steps to the coarser ones; the first two of those that converge are as above.
    backwards = iter(distances[1::-1])
    monkeypatch.setattr(motion_refinement, "path_distance", lambda *_: next(backwards))
    level = ResolvedMotion(simulator, coarse, simulator.paths(coarse))
    search = motion_refinement._Search(
        simulator.model.scene, simulator.simulation, None, None, None, (), 1e-3, (), [level], step_tolerance=1e-3
    )
    assert motion_refinement._is_erratic(search) is erratic
    assert list(backwards) == []
