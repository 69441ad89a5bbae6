"""The error that the steps of a motion leave, as two motions tell it, beside that of a far more exact one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Scene, build, read_scene, scene_from_dict, simulate
from cosserat_casadi.motion import motion_refinement
from cosserat_casadi.motion import simulate as motion_simulate
from cosserat_casadi.motion.event_restart import LAID_DOWN, ContactEvent
from cosserat_casadi.motion.history import History
from cosserat_casadi.motion.motion_refinement import ResolvedMotion
from cosserat_casadi.motion.pose_series import poses_of
from cosserat_casadi.motion.simulate import (
    LEAST_SLOPE,
    LEAST_SLOPE_AFTER_IMPACTS,
    LEAST_SLOPE_OF_ALIKE,
    LEAST_TIGHTENING,
    SLOPE_OF_THREE_ALIKE,
    TIGHTER,
    Companion,
    Simulator,
    TimedHistory,
    are_struck_alike,
    left_by,
    started,
)
from cosserat_casadi.motion.tip_paths import Paths, path_distance
from cosserat_casadi.numerics.integration import StepOutcome
from tests.families import mostly_slow
from tests.motion import transients

STEP_TOLERANCE = 1e-3


def simulator_of(asked: dict[str, Any]) -> Simulator:
    """The motion of a scene on five modes."""
    return simulator_on(scene_from_dict({**asked, "accuracy": {"modes": 5, "nodes": 10}}))


def pushed(times: Sequence[float], forces: Sequence[float], duration: float, **changes: Any) -> dict[str, Any]:
    """A cantilever whose tip is pushed along z."""
    values = [[0.0, 0.0, float(force)] for force in forces]
    push = {"input": "push.force", "times": list(times), "values": values, "interpolation": "cubic"}
    rod = changes.pop("rod", {})
    asked = {"duration": duration, "frames": 2, "start": "unloaded"}
    return transients.table(rod, transients.at_tip(), motions=[push], simulation=asked, **changes)


def body_at_tip() -> dict[str, Any]:
    """A rod with a heavy body at its tip, which a push of half a second swings."""
    stiffness = {"bending_x": 1.0, "bending_y": 1.0, "torsion": 0.8}
    rod = {"strain": "kirchhoff", "stiffness": stiffness, "rotary_inertia": [2e-5, 2e-5, 4e-5]}
    lump = {"name": "lump", "mass": 0.5, "centre_of_mass": [0, 0, 0.05], "inertia": [1e-3, 1e-3, 2e-3]}
    joint = {"rod": "rod", "body": "lump", "kind": "fixed"}
    return pushed([0.0, 0.25, 0.5], [0.0, 1.0, 0.0], 4.0, rod=rod, bodies=[lump], joints=[joint])


def wave_train(frequency: float) -> dict[str, Any]:
    """Five cycles of a force at an angular frequency, in a rod without damping."""
    times = np.linspace(0.0, 10.0 * np.pi / frequency, 81)
    forces = np.sin(np.pi * times / times[-1]) * np.sin(frequency * times)
    return pushed(times.tolist(), forces.tolist(), 2.0)


def column() -> dict[str, Any]:
    """A column above its critical weight whose stiffness falls towards its tip: it leans, and falls over."""
    rod = {"base": {"tangent": [0.02, 0, 1]}, "stiffness": {"bending_y": [1.0, 0.03]}}
    asked = {"duration": 3.0, "frames": 2, "start": "unloaded"}
    return transients.table(rod, transients.gravity(6.0), simulation=asked)


def let_go() -> dict[str, Any]:
    """A soft cantilever, pushed and bent in two planes, whose moment is taken away at once."""
    material = {"youngs_modulus": 1e6, "poisson_ratio": 0.5, "density": 1000.0}
    rod = {
        "name": "rod",
        "length": 0.3,
        "strain": "kirchhoff",
        "material": material,
        "section": {"shape": "circle", "radius": 8e-3},
        "base": {"tangent": [1, 0, 0]},
        "damping": {"retardation_time": 1e-3},
    }
    held = [0.0, 0.0, 0.01]
    loads = [
        {"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0, 0, 0.05]},
        {"name": "bent", "kind": "tip_wrench", "rod": "rod", "moment": held},
    ]
    release = {"input": "bent.moment", "times": [0.0, 0.02], "values": [held, [0, 0, 0]], "interpolation": "step"}
    return {
        "schema": 1,
        "rods": [rod],
        "loads": loads,
        "motions": [release],
        "simulation": {"duration": 0.2, "frames": 2},
        "accuracy": {"modes": 8, "nodes": 22},
    }


MOTIONS: dict[str, Callable[[], dict[str, Any]]] = {
    "body at the tip": body_at_tip,
    "third mode": partial(wave_train, 61.7),
    "fourth mode": partial(wave_train, 120.9),
    "late pulse": partial(pushed, [0.0, 9.0, 9.05, 9.1], [0.0, 0.0, 0.02, 0.0], 10.0),
    "column": column,
}
"""Scenes by name."""


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
def simulator(request: pytest.FixtureRequest) -> Simulator:
    """A motion on fixed modes."""
    chosen: Simulator = request.param()
    return chosen


@pytest.fixture(scope="module")
def coarse(simulator: Simulator) -> History:
    """The motion by steps to STEP_TOLERANCE."""
    return simulator.controlled(STEP_TOLERANCE)


def true_error(simulator: Simulator, found: Any) -> float:
    """Distance from a motion with far more exact steps, over the length."""
    exact = simulator.controlled(3e-3 * STEP_TOLERANCE)
    return path_distance(simulator.paths(found), simulator.paths(exact))


def test_error_of_steps_that_no_tolerance_makes_shorter() -> None:
    """A rod that is spun up slowly takes six steps at both tolerances: half of them tell the error."""
    simulator = simulator_of(transients.spin_up(0.1, duration=1.0, times=[0.5, 1.0]))
    history = simulator.controlled(TIGHTER * STEP_TOLERANCE)
    assert simulator.controlled(STEP_TOLERANCE).statistics.steps == history.statistics.steps
    told = simulator.finer(TimedHistory(history, float("nan"), TIGHTER * STEP_TOLERANCE), TIGHTER)
    true = true_error(simulator, told.history)
    assert true > 1e-6
    assert 0.8 * true <= told.error <= 4.0 * true


def test_error_of_steps_that_are_the_same_about_an_event() -> None:
    """A weight on a spring falls 1 − cos ωt until a cable holds it: a tenfold tolerance has the same seven steps.

    Their distance told 9e-14 of the length where 3e-6 was true.
    """
    length, mass, stiffness, gravity, held = 0.3, 0.2, 40.0, 9.81, 0.5
    sag = mass * gravity / stiffness
    rod = {"name": "spring", "length": length, "strain": ["extension"], "linear_density": 1e-9}
    rod |= {"stiffness": {"extension": stiffness * length}, "base": {"tangent": [0, 0, -1]}}
    cable = {"name": "cable", "kind": "tendon", "rod": "spring", "slack": True, "offset": [0, 0]}
    tables = {
        "schema": 1,
        "accuracy": {"modes": 1, "nodes": 4},
        "rods": [rod],
        "bodies": [{"name": "weight", "mass": mass, "inertia": [1e-4, 1e-4, 1e-4]}],
        "joints": [{"kind": "fixed", "rod": "spring", "body": "weight"}],
        "loads": [{"name": "gravity", "kind": "gravity", "acceleration": [0, 0, -gravity]}],
        "actuators": [cable | {"length": length + held * sag}],
        "simulation": {"duration": 1.0, "frames": 3, "start": "unloaded"},
    }
    simulator = simulator_on(scene_from_dict(tables))
    history = simulator.controlled(1e-2)
    assert simulator.controlled(1e-3).statistics.steps == history.statistics.steps
    told = simulator.finer(TimedHistory(history, float("nan"), 1e-2), TIGHTER)
    times = np.linspace(0.0, 1.0, 201)
    x, inputs = told.history.rough_positions(times)
    found = -poses_of(simulator.model.body["weight"], x, inputs).position[:, 2] - length
    rate = np.sqrt(stiffness / mass)
    fallen = np.where(times < np.arccos(1.0 - held) / rate, 1.0 - np.cos(rate * times), held)
    assert np.abs(found - sag * fallen).max() / length < told.error < 1e-4


def test_error_told_by_two_motions_is_not_too_small(simulator: Simulator, coarse: History) -> None:
    told = simulator.tightened(coarse, STEP_TOLERANCE, lambda _: np.inf)
    error = true_error(simulator, told.history)
    assert told.tolerance == STEP_TOLERANCE / TIGHTER
    assert error <= told.error
    # Nor is it without use.
    assert told.error <= 30.0 * error


def test_a_motion_that_does_not_end_ends_the_search(
    simulator: Simulator, coarse: History, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(type(coarse), "completed", False)
    assert np.isnan(simulator.tightened(coarse, STEP_TOLERANCE, lambda _: 1.0).error)


def event(place: float, kind: str = "impact", obstacle: str = "floor") -> ContactEvent:
    return ContactEvent(kind, 0.1, "rod", obstacle, place)


@pytest.mark.parametrize(
    ("slope", "of_finer", "of_coarser"),
    [
        (LEAST_SLOPE, [], []),
        (LEAST_SLOPE, [event(0.5, "lift_off")], []),
        (LEAST_SLOPE_AFTER_IMPACTS, [event(0.5)], []),
        (LEAST_SLOPE_AFTER_IMPACTS, [], [event(0.5)]),
        (LEAST_SLOPE_OF_ALIKE, [event(0.5), event(0.2)], [event(0.51), event(0.2), event(0.2, "lift_off")]),
        (LEAST_SLOPE_AFTER_IMPACTS, [event(0.5), event(0.2)], [event(0.2), event(0.5)]),
        (LEAST_SLOPE_AFTER_IMPACTS, [event(0.5)], [event(0.5, obstacle="bar")]),
        (LEAST_SLOPE_AFTER_IMPACTS, [event(0.5)], [event(0.5), event(0.5, "lie_down")]),
        (LEAST_SLOPE_AFTER_IMPACTS, [event(0.5), event(0.5, LAID_DOWN)], [event(0.5)]),
    ],
)
def test_two_motions_tell_the_error_of_the_finer_one(
    slope: float, of_finer: list[ContactEvent], of_coarser: list[ContactEvent]
) -> None:
    """Of errors that go as a power of the tolerance, whichever motion has impacts, and whether they are alike."""
    statistics = SimpleNamespace(steps=10**9)
    finer, coarser = (
        cast(History, SimpleNamespace(events=events, statistics=statistics)) for events in (of_finer, of_coarser)
    )
    errors = np.array([1e-4, 1e-3]) ** slope
    assert_allclose(left_by(10.0, finer, coarser) * (errors[1] - errors[0]), errors[0], rtol=1e-6, atol=0)


@pytest.mark.parametrize(
    ("fallen", "power"), [(0.04, LEAST_SLOPE), (0.16, SLOPE_OF_THREE_ALIKE), (0.3, LEAST_SLOPE), (1.0, LEAST_SLOPE)]
)
def test_three_motions_that_are_struck_alike_tell_errors_closer(fallen: float, power: float) -> None:
    """Where their distances fall as errors of steps do, the error is told by more than the least power."""
    struck = cast(History, SimpleNamespace(events=[event(0.5)], statistics=SimpleNamespace(steps=10**8)))
    errors = (1e-3, 1e-3 * 10.0**power)
    assert_allclose(left_by(10.0, struck, struck, fallen) * (errors[1] - errors[0]), errors[0], rtol=1e-6, atol=0)


@pytest.mark.parametrize(
    ("first_steps", "first_place", "power"),
    [(10, 0.5, SLOPE_OF_THREE_ALIKE), (400, 0.5, LEAST_SLOPE_OF_ALIKE), (10, 0.2, LEAST_SLOPE_OF_ALIKE)],
    ids=["three", "the third has half the steps", "the third is struck elsewhere"],
)
def test_a_third_motion_is_one_of_less_exact_steps_that_is_struck_alike(
    first_steps: int, first_place: float, power: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    def struck(steps: int, place: float) -> History:
        statistics = SimpleNamespace(steps=steps)
        return cast(History, SimpleNamespace(events=[event(place)], statistics=statistics, completed=True))

    third, coarse, fine = struck(first_steps, first_place), struck(200, 0.5), struck(10**8, 0.5)
    monkeypatch.setattr(motion_simulate, "path_distance", lambda *_: 1.6e-3)
    monkeypatch.setattr(motion_simulate, "has_shorter_steps_at_events", lambda _: False)
    timed = TimedHistory(coarse, 1.0, 1e-3, Companion(third, 1.0), distance=1e-2)
    simulator = SimpleNamespace(paths=lambda _: None)
    told = Simulator.finer(cast(Simulator, simulator), timed, TIGHTER, fine)
    expected = 1.6e-3 / (TIGHTER**power - 1)
    if first_place != 0.5:
        # Two motions may agree that both err as the third does.
        expected = max(expected, 1e-2)
    assert_allclose(told.error, expected, rtol=1e-6, atol=0)


@pytest.mark.parametrize(("steps", "power"), [(10**8, LEAST_SLOPE), (100, 0.0)])
def test_the_last_level_is_told_by_the_level_before(steps: int, power: float) -> None:
    """Where its steps are no shorter ones nothing is told."""

    def level(steps: int, tolerance: float, place: float) -> ResolvedMotion:
        history = SimpleNamespace(events=[], statistics=SimpleNamespace(steps=steps))
        found = Paths(np.full((3, 1, 3), [place, 0.0, 0.0]), np.tile(np.eye(3)[:2], (3, 1, 1, 1)))
        return ResolvedMotion(cast(Simulator, None), cast(History, history), found, step_tolerance=tolerance)

    levels = [level(100, 1e-3, 0.0), level(steps, 1e-3 / TIGHTER, 2e-3)]
    search = cast(motion_refinement._Search, SimpleNamespace(levels=levels))
    told = motion_refinement._told_by_level_before(search)
    expected = 2e-3 / (TIGHTER**power - 1) if power else np.inf
    assert_allclose(told.error, expected, rtol=1e-6, atol=0)
    assert told.history is levels[1].history and told.tolerance == 1e-3 / TIGHTER


def test_where_more_exact_steps_end_early_the_last_whole_motion_and_its_error_are_kept(
    simulator: Simulator, coarse: History, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A steel rod that bounced with half of its speed took ever shorter steps in the third motion."""
    told = simulator.tightened(coarse, STEP_TOLERANCE, lambda _: np.inf)
    plain = Simulator.controlled

    def ends_early(of: Simulator, tolerance: float) -> History:
        history = plain(of, tolerance)
        if tolerance >= told.tolerance:
            return history
        last = history.legs[-1]
        integration = replace(last.integration, outcome=StepOutcome.STEP_TOO_SMALL)
        return replace(history, legs=(*history.legs[:-1], replace(last, integration=integration)))

    monkeypatch.setattr(Simulator, "controlled", ends_early)
    found = simulator.tightened(coarse, STEP_TOLERANCE, lambda _: told.error / 2.0)
    assert found.history.completed
    assert found.tolerance == told.tolerance
    assert_allclose(found.error, told.error, rtol=1e-12, atol=0)


def test_steps_are_made_more_exact_until_their_error_is_allowed(simulator: Simulator, coarse: History) -> None:
    told = simulator.tightened(coarse, STEP_TOLERANCE, lambda _: np.inf)
    allowed = told.error / 2.0
    found = simulator.tightened(coarse, STEP_TOLERANCE, lambda _: allowed)
    assert found.tolerance <= told.tolerance / LEAST_TIGHTENING
    assert true_error(simulator, found.history) <= found.error <= allowed


@pytest.mark.parametrize("scene", mostly_slow(MOTIONS, quick=["body at the tip"]))
def test_estimates_are_above_the_error(scene: str) -> None:
    """Motions whose error by a motion three times as coarse was half of the true one, and like ones."""
    tables = MOTIONS[scene]()
    exact = simulator_on(scene_from_dict({**tables, "accuracy": {"modes": 16, "nodes": 38}}))
    reference = exact.paths(exact.controlled(1e-6))
    for tolerance in (3e-2, 1e-2, 3e-3, 1e-3):
        tables["simulation"]["tolerance"] = tolerance
        motion = simulate(scene_from_dict(tables))
        assert motion.converged, motion.message
        history: Any = motion.interpolant
        found = exact.paths(history.__self__)
        assert path_distance(found, reference) <= motion.error_estimate


def dropped(
    material: tuple[float, float, float], damping: float, rise: float, below: float, duration: float, **obstacle: Any
) -> dict[str, Any]:
    """A rod on few modes that falls on an obstacle of no width.

    Args:
        material: Young's modulus, Pa, density, kg/m³, and radius, m.
        damping: retardation time, s.
        rise: of the rod, by its way along x.
        below: depth of the floor under its base, m.
        duration: of the motion, s.
        obstacle: changes of the floor.
    """
    modulus, density, radius = material
    rod = {
        "name": "rod",
        "length": 0.4,
        "strain": "planar",
        "material": {"youngs_modulus": modulus, "poisson_ratio": 0.3, "density": density},
        "section": {"shape": "circle", "radius": radius},
        "base": {"position": [0, 0, 0], "tangent": [1, 0, rise], "free": True},
    }
    if damping > 0.0:
        rod["damping"] = {"retardation_time": damping}
    floor = {"name": "floor", "kind": "plane", "point": [0, 0, -below], "normal": [0, 0, 1], **obstacle}
    return {
        "schema": 1,
        "accuracy": {"modes": 4, "nodes": 10},
        "rods": [rod],
        "loads": [{"name": "weight", "kind": "gravity", "acceleration": [0, 0, -9.81]}],
        "obstacles": [floor],
        "simulation": {"duration": duration, "frames": 2, "start": "unloaded"},
    }


def clamped(tables: dict[str, Any]) -> dict[str, Any]:
    """A scene of one rod, whose base is clamped at the origin along x."""
    (rod,) = tables["rods"]
    return {**tables, "rods": [{**rod, "base": {"position": [0, 0, 0], "tangent": [1, 0, 0]}}]}


STEEL = (2e11, 7800.0, 4e-3)
SOFT = (5e6, 1100.0, 8e-3)

STRUCK: dict[str, tuple[dict[str, Any], float, float]] = {
    "stiff rubber": (dropped((5e8, 1100.0, 8e-3), 0.0, 0.3, 0.02, 0.12), 1e-2, 1e-4),
    "soft rubber": (dropped(SOFT, 1e-3, 0.2, 0.04, 0.2), 1e-2, 1e-5),
    "aluminium": (dropped((7e10, 2700.0, 3e-3), 1e-5, -0.4, 0.18, 0.2), 10.0**-3.5, 1e-6),
    "bouncing": (dropped(STEEL, 1e-4, 0.2, 0.05, 0.3, restitution=0.5), 10.0**-2.25, 1e-5),
}
"""Scenes by name, with the step tolerances of the first of two motions and of a far more exact one."""


REGULAR = ("soft rubber", "bouncing")
"""Scenes whose errors fall as those of motions without impacts do: contacts come and go alike at all tolerances."""


@pytest.mark.parametrize("scene", mostly_slow(STRUCK, quick=["stiff rubber"]))
def test_estimates_of_rods_that_are_struck_are_above_the_error(scene: str) -> None:
    """Told as of motions without impacts it was too small by factors of 2 to 4.6."""
    tables, first, exact = STRUCK[scene]
    simulator = simulator_on(scene_from_dict(tables))
    told = simulator.finer(TimedHistory(simulator.controlled(first), float("nan"), first), TIGHTER)
    error = path_distance(simulator.paths(told.history), simulator.paths(simulator.controlled(exact)))
    plainly = told.distance / (TIGHTER**LEAST_SLOPE - 1.0)
    assert error < told.error
    if scene not in REGULAR:
        assert 1.2 * plainly < error


def test_no_error_below_that_of_a_step_is_told_of_motions_that_are_struck_elsewhere(
    simulator: Simulator, coarse: History, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a rod that lay down on a floor 1.5e-5 were told by two motions that both erred by 2.3e-5."""
    monkeypatch.setattr(motion_simulate, "are_struck_alike", lambda *_: False)
    monkeypatch.setattr(motion_simulate, "path_distance", lambda *_: 0.0)
    told = simulator.finer(TimedHistory(coarse, float("nan"), STEP_TOLERANCE), TIGHTER)
    assert told.distance == 0.0
    assert told.error == told.tolerance


@pytest.mark.slow
@pytest.mark.parametrize("place", [0.12, 0.25, 0.39])
def test_errors_of_rods_whose_impacts_are_alike_are_told_closely(place: float) -> None:
    """Told as of rods that strike elsewhere each time they were 50 to 80 times the error."""
    height = -0.02 - 0.2 * place
    bar = {"name": "bar", "kind": "capsule", "from": [place, -0.1, height], "to": [place, 0.1, height], "radius": 0.02}
    tables = clamped(dropped((2e6, 1100.0, 8e-3), 2e-3, 0.0, 0.1, 0.25))
    simulator = simulator_on(scene_from_dict({**tables, "obstacles": [bar]}))
    first = 3e-3
    timed = TimedHistory(simulator.controlled(first), float("nan"), first)
    for _ in range(2):
        timed = simulator.finer(timed, TIGHTER)
    assert timed.companion is not None
    assert are_struck_alike(timed.history, timed.companion.history)
    exact = simulator.paths(simulator.controlled(1e-7))
    error = path_distance(simulator.paths(timed.history), exact)
    assert error < timed.error < 40.0 * error


def test_a_rod_that_is_let_go_keeps_no_speed_of_its_first_steps() -> None:
    """What Newton's method leaves in a step of 1e-5 s is a speed, with which the tip drifted more than was told."""
    simulator = simulator_on(scene_from_dict(let_go()))
    timed = simulator.tightened(simulator.controlled(1e-4), 1e-4, lambda _: np.inf)
    exact = simulator.paths(simulator.controlled(1e-6))
    error = path_distance(simulator.paths(timed.history), exact)
    assert error < 1e-6
    assert error < timed.error < 40.0 * error


def test_steps_of_a_model_are_made_more_exact_until_they_agree() -> None:
    simulator = cantilever()
    wanted = 0.5 * true_error(simulator, simulator.controlled(STEP_TOLERANCE))
    timed = simulator.to_tolerance(wanted, first=STEP_TOLERANCE)
    assert timed.tolerance <= STEP_TOLERANCE / TIGHTER * (1.0 + 1e-12)
    assert true_error(simulator, timed.history) <= timed.error <= wanted


def sizes_of_motions(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Number of unknowns of each motion with controlled steps that is computed from now on."""
    sizes = []
    plain = Simulator.controlled

    def counted(simulator: Simulator, tolerance: float) -> Any:
        sizes.append(simulator.model.size)
        return plain(simulator, tolerance)

    monkeypatch.setattr(Simulator, "controlled", counted)
    return sizes


def test_a_search_takes_a_motion_on_each_set_of_modes_and_one_for_its_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    sizes = sizes_of_motions(monkeypatch)
    motion = simulate(scene_from_dict(transients.sudden_weight(tolerance=3e-3)))
    assert motion.converged, motion.message
    assert len(sizes) == len(set(sizes)) + 1
    assert sizes[-1] == sizes[-2] == motion.model.size


def test_modes_that_are_foreseen_to_be_enough_take_exact_steps_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """The motion on fewer modes tells their error together with that of its own modes: from above."""
    sizes = sizes_of_motions(monkeypatch)
    motion = simulate(scene_from_dict(transients.sudden_weight(tolerance=5e-3)))
    assert motion.converged, motion.message
    assert len(sizes) == len(set(sizes)) == 2
    error = np.abs(motion.tip().position[:, [0, 2]] - transients.SUDDEN_WEIGHT_TIP).max()
    assert 3e-5 < error < motion.error_estimate
    assert motion.end is not None
    assert [strand.by_modes for strand in motion.end.strands] == [False, False, True]


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


@pytest.mark.parametrize(("distances", "erratic"), [([0.1, 0.09], True), ([0.1, 0.03, 1e-6, 1e-8], False)])
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
    monkeypatch.setattr(motion_simulate, "are_struck_alike", lambda *_: False)
    timed = simulator.tightened(coarse, 1e-2, lambda _: 1e-3)
    assert list(told) == []
    assert (timed.error > 1e-3) is erratic
    if not erratic:
        # Two motions that agree may err as much as those before: a fourth motion is asked for.
        assert_allclose(timed.error, distances[-2], rtol=1e-12, atol=0)
        assert_allclose(timed.distance, distances[-1], rtol=1e-12, atol=0)
    # In a search, from the more exact steps to the coarser ones; the first two of those that converge are as above.
    backwards = iter(distances[1::-1])
    monkeypatch.setattr(motion_refinement, "path_distance", lambda *_: next(backwards))
    level = ResolvedMotion(simulator, coarse, simulator.paths(coarse))
    search = motion_refinement._Search(
        simulator.model.scene, simulator.simulation, None, None, None, (), 1e-3, (), [level], step_tolerance=1e-3
    )
    assert motion_refinement._is_erratic(search) is erratic
    assert list(backwards) == []


def test_motions_of_one_start_begin_alike() -> None:
    asked = body_at_tip()
    simulator = simulator_of(asked)
    coarse, fine = (simulator.controlled(tolerance) for tolerance in (STEP_TOLERANCE, STEP_TOLERANCE / TIGHTER))
    alone = simulator_of(asked).controlled(STEP_TOLERANCE / TIGHTER)
    assert fine.legs[0].restart is coarse.legs[0].restart
    assert fine.statistics == alone.statistics
    assert_allclose(fine.end.x, alone.end.x, rtol=0.0, atol=0.0)
