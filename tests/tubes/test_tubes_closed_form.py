"""Two tubes against Jacobi's elliptic functions: angles, stability, all equilibria, where they snap."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import brentq, minimize_scalar

from cosserat_casadi import all_equilibria, follow, solve
from cosserat_casadi.tubes.robot import robot_of
from cosserat_casadi.tubes.stages import SHARES
from cosserat_casadi.tubes.tube_model import TubeModel
from cosserat_casadi.tubes.tube_stability import stability_of
from tests.tubes.pendulum import Pendulum

SHORT = Pendulum(1.2)
LONG = Pendulum(4.0)
HOUSED = Pendulum(2.0, housing=(0.1, 0.25))


def between_drives(model: TubeModel, between_tips: float) -> float:
    inputs = model.robot.inputs
    missed = model.residual([0.0, between_tips], inputs).full()[:, 0] + inputs[::2]
    return float(missed[1] - missed[0])


@pytest.mark.parametrize("tubes", [SHORT, LONG, HOUSED], ids=["short", "long", "housed"])
def test_angles_are_those_of_a_pendulum(tubes: Pendulum) -> None:
    model = TubeModel(robot_of(tubes.scene(0.0)), 16)
    for between_tips in np.linspace(-7.0, 7.0, 12):
        found = between_drives(model, between_tips)
        assert_allclose(found, tubes.between_drives(np.array(between_tips)), rtol=0, atol=2e-10)


def test_order_eight() -> None:
    errors = []
    for steps in (12, 24):
        model = TubeModel(robot_of(LONG.scene(0.0)), steps)
        errors.append(abs(between_drives(model, 2.5) - LONG.between_drives(np.array(2.5))))
    rate = np.log2(errors[0] / errors[1])
    assert 7.5 < rate < 9.5
    assert_allclose(sum(SHARES), 1.0, rtol=0, atol=1e-15)


@pytest.mark.parametrize("housing", [(0.0, 0.0), (0.1, 0.25)])
@pytest.mark.parametrize(("reach", "falling"), [(0.6, 0), (2.0, 1), (4.0, 1), (5.5, 2), (8.0, 3)])
def test_stability_of_opposed_tubes(reach: float, falling: int, housing: tuple[float, float]) -> None:
    tubes = Pendulum(reach, housing)
    scene = tubes.scene(np.pi)
    model = TubeModel(robot_of(scene), 32)
    # The half turn is kept all along: both curvatures are opposed, and twist would release energy.
    x = model.robot.inputs[::2]
    assert_allclose(model.residual(x, model.robot.inputs).full(), 0.0, rtol=0, atol=1e-14)
    stability = stability_of(model, x, model.robot.inputs)
    assert_allclose(stability.determinant, tubes.opposed_determinant(), rtol=0, atol=1e-8)
    if housing == (0.0, 0.0):
        # cos √c (L − s) has as many zeros: conjugate points.
        assert stability.falling == falling == int(reach / np.pi + 0.5)
    assert stability.stable == (stability.falling == 0)
    assert (-1) ** stability.falling == np.sign(stability.determinant)


def test_opposed_tubes_lose_stability_at_a_quarter_of_the_pendulums_period() -> None:
    for reach, stable in ((np.pi / 2 - 1e-4, True), (np.pi / 2 + 1e-4, False)):
        assert solve(Pendulum(reach).scene(np.pi)).stable is stable
    # Torsion in the housing takes it earlier: √c λ tan(√c L) = 1 with its compliance λ.
    critical = brentq(lambda reach: Pendulum(reach, (0.1, 0.25)).opposed_determinant(), 0.1, 1.5)
    assert critical < 1.3
    for reach, stable in ((critical - 1e-4, True), (critical + 1e-4, False)):
        assert solve(Pendulum(reach, (0.1, 0.25)).scene(np.pi)).stable is stable


def closed_form_tips(tubes: Pendulum, rotation: float) -> list[float]:
    """Every angle between the tips whose drives are at a rotation."""
    tips = np.linspace(-30.0, 30.0, 240_001)
    missed = tubes.between_drives(tips) - rotation
    crossings = np.flatnonzero(missed[:-1] * missed[1:] < 0.0)
    return [
        brentq(lambda angle: float(tubes.between_drives(np.array(angle)) - rotation), *tips[i : i + 2], xtol=1e-14)
        for i in crossings
    ]


@pytest.mark.parametrize(
    ("tubes", "rotation", "count"),
    [
        (SHORT, 2.0, 1),
        (HOUSED, 2.5, 3),
        pytest.param(LONG, 3.0, 3, marks=pytest.mark.slow),
        pytest.param(Pendulum(5.0), 3.13, 5, marks=pytest.mark.slow),
        pytest.param(Pendulum(3.0, (0.3, 0.6)), 0.7, 9, marks=pytest.mark.slow),
    ],
)
def test_all_equilibria(tubes: Pendulum, rotation: float, count: int) -> None:
    found = all_equilibria(tubes.scene(rotation))
    assert found.complete
    exact = closed_form_tips(tubes, rotation)
    between = sorted(solution.x[1] - solution.x[0] for solution in found.solutions)
    assert len(exact) == count
    assert_allclose(between, exact, rtol=0, atol=1e-7)
    # Between two minima of the energy lies a saddle.
    assert len(found.stable) >= 1
    energies = [solution.energy for solution in found.solutions]
    assert energies == sorted(energies)
    assert found.solutions[0].stable


def test_snap_where_the_closed_form_turns() -> None:
    tubes = Pendulum(2.4)
    turning = minimize_scalar(
        lambda tips: -float(tubes.between_drives(np.array(tips))),
        bounds=(0.3, 3.0),
        method="bounded",
        options={"xatol": 1e-12},
    )
    assert -turning.fun > np.pi
    start = tubes.scene(1.0, tolerance=1e-6)
    path = follow(start, "inner.rotation", 0.4 - turning.fun + 0.5)
    assert path.converged
    assert path.error_estimate is not None
    assert path.error_estimate < 1e-6
    snap = path.events[0]
    assert_allclose(snap.value, 0.4 - turning.fun, rtol=0, atol=1e-7)
    assert snap.kind == "limit"
    assert snap.solution.stability.neutral
    # It comes to rest at another stable equilibrium of the same inputs.
    assert snap.snaps_to is not None
    assert snap.snaps_to.stable
    assert_allclose(snap.snaps_to.inputs, snap.solution.inputs, rtol=0, atol=0)
    exact = closed_form_tips(tubes, -turning.fun - 1e-9)
    between = snap.snaps_to.x[1] - snap.snaps_to.x[0]
    assert min(abs(between - angle) for angle in exact) < 1e-6
    assert snap.released_energy is not None
    assert snap.released_energy > 0.0


def test_a_path_that_turns_once_round_is_known_on_its_way() -> None:
    """Tubes that do not snap are in line at both ends, which says nothing of where they are opposed."""
    tubes = Pendulum(1.5)
    scene = tubes.scene(0.0)
    path = follow(scene, "inner.rotation", 0.4 + 2 * np.pi)
    assert path.converged
    assert not path.events
    assert path.error_estimate is not None
    assert path.error_estimate <= scene.accuracy.tolerance

    def missed(between_tips: float, rotation: float) -> float:
        return float(tubes.between_drives(np.array(between_tips)) - rotation)

    errors = []
    for index in (len(path.factor) * np.array([0.3, 0.4, 0.45, 0.6])).astype(int):
        rotation = path.values[index] - 0.4
        exact = brentq(missed, 0.1, 6.2, args=(rotation,), xtol=1e-14)
        errors.append(abs(path.x[index, 1] - path.x[index, 0] - exact))
    # One of both angles is off by half of that at least.
    assert max(errors) / 2 <= path.error_estimate


@pytest.mark.slow
def test_a_soft_robot_snaps_to_the_next_of_many() -> None:
    tubes = Pendulum(3.0, (0.3, 0.6))
    scene = tubes.scene(0.7, tolerance=1e-5)
    path = follow(scene, "inner.rotation", 18.0)
    assert path.converged
    snap = path.events[0]
    assert snap.snaps_to is not None
    landing = snap.snaps_to.x[1] - snap.snaps_to.x[0]
    found = all_equilibria(scene, {"inner.rotation": snap.value + 1e-4})
    assert found.complete
    stable = sorted(solution.x[1] - solution.x[0] for solution in found.stable)
    # The tips go on turning as the drive does: to the first of five.
    assert len(stable) == 5
    assert_allclose(landing, stable[0], rtol=0, atol=1e-4)
    assert landing > snap.solution.x[1] - snap.solution.x[0]
