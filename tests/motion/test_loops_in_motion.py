"""Supports, joints, carried rods and cables of given length in motion: closed all along, energy balanced, orders."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, Motion, MotionOutcome, build, simulate
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.history import History, integrated
from cosserat_casadi.motion.motion_ending import independence_of
from cosserat_casadi.motion.simulate import NEWTON_OF_CLOSED, Simulator, moving_inputs, started
from cosserat_casadi.numerics.collocation import Collocation, radau
from cosserat_casadi.numerics.integration import Integration, StepOutcome, StepSettings
from cosserat_casadi.numerics.motion_equations import Instant, MotionEquations
from cosserat_casadi.numerics.time_steps import integrate
from tests import moving_scenes
from tests.equilibria import solve
from tests.families import mostly_slow
from tests.motion.stepping import moving_model, orders, stepped
from tests.moving_scenes import constrained_rows

CLOSED = 1e-10
"""What constraints may be open by: of the length, or of a rotation."""

HELD = ["clamped tip", "pinned tip", "carried", "given length", "free with body", "driven and held"]
JOINTS = [f"{kind} joint" for kind in ("fixed", "spherical", "revolute", "prismatic")]
QUICK = ["given length", "revolute joint"]

SWAY = {"amplitude": [0.3, 2.0, 1.0], "frequency": 1.5, "wave": "one_minus_cosine"}
SHAKE = {"amplitude": [0.03, 0.02, -0.02], "frequency": 1.5, "wave": "one_minus_cosine"}


def swayed(family: str) -> dict[str, Any]:
    """A scene whose weight changes its direction, or whose base moves, from an equilibrium at rest."""
    scene = moving_scenes.FAMILIES[family]()
    scene.pop("inputs", None)
    moved = {"input": "weight.acceleration", **SWAY}
    if family == "driven and held":
        moved = {"input": "a.base.position", **SHAKE}
    scene["motions"] = [moved]
    scene["simulation"] = {"duration": 0.4, "tolerance": 1e-3}
    scene["accuracy"] = {"modes": 3, "nodes": 8}
    return scene


@cache
def simulated(family: str) -> Motion:
    motion = simulate(moving_model(swayed(family)))
    assert motion.converged, motion.message
    return motion


def gaps(motion: Motion, rows: FloatArray) -> FloatArray:
    """Rows of the constraints at all rows of the motion, shape (T, rows), without unit."""
    model = motion.model
    residuals = [model.residual(x, inputs).full()[rows, 0] for x, inputs in zip(motion.x, motion.inputs, strict=True)]
    return np.array(residuals)


def rows_of(model: Model) -> FloatArray:
    """Equations of supports, joints, carried bases and cables of given length."""
    rows = constrained_rows(model)
    for cable in model.discrete.cables:
        rows[model.discrete.tension(cable)] = True
    return np.flatnonzero(rows)


@pytest.mark.parametrize("family", mostly_slow([*HELD, *JOINTS], quick=QUICK))
def test_constraints_stay_closed(family: str) -> None:
    """At every time, not only at the ends of steps."""
    motion = simulated(family)
    rows = rows_of(motion.model)
    assert len(rows) > 0
    assert_allclose(gaps(motion, rows), 0.0, rtol=0, atol=CLOSED)
    between = [motion.at(float(time)) for time in np.linspace(0.0, 0.4, 23)]
    opened = [motion.model.residual(state.x, state.inputs).full()[rows, 0] for state in between]
    assert_allclose(opened, 0.0, rtol=0, atol=CLOSED)
    middle = motion.section("a", [0.5]).position
    assert np.ptp(middle, axis=0).max() > 1e-4


def opened_at_ends(scene: dict[str, Any], tolerance: float) -> float:
    """Largest row of a constraint at the end of a step of this tolerance, without unit."""
    model = moving_model(scene).at().in_motion
    simulation = model.scene.simulation
    assert simulation is not None
    history = Simulator(model, simulation, started(model, simulation, None)).controlled(tolerance)
    assert history.completed
    rows = rows_of(model)
    ends = [(step.end.x, leg.piece.at(step.end.time).value) for leg, step in history.steps]
    return float(max(np.abs(model.residual(x, inputs).full()[rows, 0]).max() for x, inputs in ends))


@pytest.mark.parametrize("family", QUICK)
@pytest.mark.parametrize("tolerance", [1e-2, 1e-4])
def test_ends_of_steps_are_open_by_a_share_of_their_tolerance(family: str, tolerance: float) -> None:
    """So two motions that tell an error tell what Newton's method leaves too."""
    assert opened_at_ends(swayed(family), tolerance) < NEWTON_OF_CLOSED * tolerance


def test_joints_with_stops_are_closed_at_any_tolerance() -> None:
    """What Newton's method leaves does not decide when a stop is met."""
    scene = swayed("revolute joint")
    assert opened_at_ends(scene, 1e-2) > CLOSED
    scene["joints"][1]["upper_stop"] = 0.5
    assert opened_at_ends(scene, 1e-2) <= CLOSED


@pytest.mark.parametrize("family", mostly_slow([*HELD, *JOINTS], quick=QUICK))
def test_energy_is_balanced_in_closed_loops(family: str) -> None:
    """Constraints do no work, but at bases that move."""
    motion = simulated(family)
    assert np.abs(motion.energy.imbalance).max() < 2e-3


@pytest.mark.slow
def test_poses_meet_at_joints() -> None:
    """The tips as results have them, in world axes, and the body."""
    motion = simulated("spherical joint")
    body = motion.body("plate")
    for name, arm in (("a", [-0.2, 0.0, 0.0]), ("b", [0.02, -0.03, 0.01])):
        found = body.position + turned(body.quaternion, np.array(arm))
        assert_allclose(motion.tip(name).position, found, rtol=0, atol=CLOSED)


@pytest.mark.slow
def test_pinned_tip_stays_and_clamped_tip_does_not_turn() -> None:
    pinned = simulated("pinned tip")
    assert_allclose(pinned.tip().position, np.tile([0.2, 0.1, 0.7], (101, 1)), rtol=0, atol=CLOSED)
    assert np.ptp(pinned.tip().quaternion, axis=0).max() > 1e-3
    clamped = simulated("clamped tip")
    assert_allclose(clamped.tip().position, np.tile([0.2, 0.1, 0.7], (101, 1)), rtol=0, atol=CLOSED)
    sign = np.sign(clamped.tip().quaternion[:, :1])
    assert_allclose(sign * clamped.tip().quaternion, np.tile([0.96, 0, 0.28, 0], (101, 1)), rtol=0, atol=CLOSED)


def turned(quaternions: FloatArray, arm: FloatArray) -> FloatArray:
    """An arm of a body in world axes, shape (T, 3)."""
    w, x, y, z = quaternions.T
    vector = np.stack([x, y, z], axis=1)
    cross = np.cross(vector, arm)
    return np.asarray(arm + 2 * w[:, None] * cross + 2 * np.cross(vector, cross))


@pytest.mark.parametrize(
    ("method", "order"),
    [(radau(2), (3, 2, 1)), pytest.param(radau(3), (5, 3, 2), marks=pytest.mark.slow)],
    ids=["Radau-2", "Radau-3"],
)
def test_orders_of_positions_velocities_and_multipliers(method: Collocation, order: tuple[int, int, int]) -> None:
    """Of Radau IIA with s stages at index 3: 2 s − 1, s and s − 1 (Hairer, Lubich, Roche)."""
    scene = swayed("pinned tip")
    scene["accuracy"] = {"modes": 2, "nodes": 6}
    model = moving_model(scene)
    held = build(model.scene.held(), model.discretisation)
    start = solve(held).x

    def at_end(chosen: Collocation, size: float) -> list[FloatArray]:
        end = stepped(model, chosen, size, 0.3, start).at(0.3)
        moves = np.asarray(model.discrete.unknowns.differential)
        return [end.x[moves], end.v[moves], end.x[~moves]]

    exact = at_end(radau(3), 0.3 / 480)
    errors = []
    for size in (0.3 / 20, 0.3 / 40, 0.3 / 80):
        found = at_end(method, size)
        errors.append([np.abs(part - true).max() for part, true in zip(found, exact, strict=True)])
    measured = orders(errors)[-1]
    for rate, least in zip(measured, order, strict=True):
        assert rate > least - 0.5


def stopped_first(monkeypatch: pytest.MonkeyPatch, before_end: float) -> History:
    """A base that is shaken for 0.1 s, over a pinned tip; the motion is stopped once, as by a guard, and goes on."""
    model = moving_model(swayed("driven and held"))
    calls = list[float]()

    def integrate_in_two(equations: MotionEquations, begin: Instant, end: float, *more: Any) -> Integration:
        calls.append(begin.time)
        if len(calls) > 1:
            return integrate(equations, begin, end, *more)
        first = integrate(equations, begin, end - before_end, *more)
        return replace(first, outcome=StepOutcome.GUARDED)

    monkeypatch.setattr("cosserat_casadi.motion.history.integrate", integrate_in_two)
    assert model.scene.simulation is not None
    x = started(model, model.scene.simulation, None).x
    settings = StepSettings(np.full(model.size, 1e-10), size=5e-3, newton=1.0)
    return integrated(model, moving_inputs(model).pieces(0.1), x, np.zeros(model.size), radau(3), settings)


def test_a_restart_next_to_the_end_has_its_accelerations(monkeypatch: pytest.MonkeyPatch) -> None:
    """By the path of the inputs, not by what rounding makes of the little that is left of it."""
    history = stopped_first(monkeypatch, 1e-11)
    first, second = history.legs
    wanted = first.integration.end.a
    assert_allclose(second.start.instant.a, wanted, rtol=0, atol=1e-3 * np.abs(wanted).max())


def test_a_guard_that_vanishes_in_the_very_end_ends_nothing_early(monkeypatch: pytest.MonkeyPatch) -> None:
    history = stopped_first(monkeypatch, 0.0)
    assert len(history.legs) == 1
    assert history.completed


@pytest.mark.parametrize(
    ("derivatives", "expected"),
    [
        (np.eye(2, 3), 1.0),
        (np.array([[2.0, 0.0, 0.0], [3.0, 3.0, 0.0]]), np.tan(np.pi / 8)),
        (np.array([[1.0, 2.0], [2.0, 4.0]]), 0.0),
        (np.array([[1.0], [0.5], [2.0]]), 0.0),
        (np.array([[1.0, 0.0], [0.0, 0.0]]), 0.0),
        (np.zeros((0, 4)), np.inf),
    ],
    ids=["orthogonal", "half a right angle", "parallel", "more than coordinates", "of nothing", "none"],
)
def test_independence_of_constraints(derivatives: FloatArray, expected: float) -> None:
    assert_allclose(independence_of(derivatives), expected, rtol=1e-12, atol=1e-15)


@pytest.mark.filterwarnings("ignore:invalid value encountered:RuntimeWarning")
def test_motion_ends_where_it_would_stretch_a_support() -> None:
    """The base is drawn away from the pinned tip until the rod is straight: it cannot go on, and says so."""
    rod = moving_scenes.rod(length=1.0)
    pin = {"rod": "a", "kind": "pinned", "position": [0.1, 0.0, 0.8]}
    drawn = {
        "input": "a.base.position",
        "times": [0.0, 0.5],
        "values": [[0, 0, 0], [0, 0, -0.5]],
        "interpolation": "cubic",
    }
    scene = moving_scenes.scene(rod, loads=[moving_scenes.WEIGHT], supports=[pin], motions=[drawn])
    scene["simulation"] = {"duration": 0.5, "tolerance": 1e-3}
    motion = simulate(moving_model(scene, 3, 8))
    # The ends are one length apart where the base has gone √0.99 − 0.8 of its 0.5, which is 3 s² − 2 s³ of the way.
    share = (np.sqrt(0.99) - 0.8) / 0.5
    roots = np.roots([-2.0, 3.0, 0.0, -share])
    (way,) = [root.real for root in roots if 0.0 < root.real < 1.0]
    assert motion.outcome is MotionOutcome.SINGULAR_CONSTRAINT
    assert "dependent" in motion.message
    # A frame every 5 ms.
    assert 0.5 * way - 0.01 < motion.times[-1] <= 0.5 * way + 1e-9
