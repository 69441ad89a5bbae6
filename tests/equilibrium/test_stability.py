"""Stable, unstable, neutral and critical equilibria: told apart, and stable ones found by settling."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from cosserat_casadi import Outcome, Scene, SceneError, Solution, build, discretise, follow, scene_from_dict
from cosserat_casadi.equilibrium.relax import energy_at
from cosserat_casadi.equilibrium.stability import stability_of
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.numerics.broyden import newton_step
from cosserat_casadi.numerics.descent import DescentSettings, Energy, ball_minimum, descend
from cosserat_casadi.numerics.newton import Equations, NewtonSettings, newton
from tests.catalogue.cases import column_tip
from tests.equilibria import solve
from tests.families import mostly_slow
from tests.reference.held_scenes import held_scene
from tests.scenes import WEIGHT, push, rod, scene
from tests.shooting_near import integrate

CRITICAL = np.pi**2 / 4
"""Euler's load of a clamped-free column, in EI/L²."""

ROUND = {"bending_x": 1.0, "bending_y": 1.0, "torsion": 0.7}
STIFFNESS = {"planar": {"bending_y": 1.0}, "kirchhoff": ROUND}


def column(strain: str, *loads: dict[str, Any], **changes: Any) -> Scene:
    """A rod of length 1 along z with unit bending stiffness, round where it is not planar."""
    upright = {"name": "rod", "length": 1.0, "strain": strain, "stiffness": STIFFNESS[strain], "linear_density": 1.0}
    return scene(*loads, rods=[upright], **changes)


def standing(strain: str, weight: float, **changes: Any) -> Scene:
    return column(strain, {"name": "weight", "kind": "gravity", "acceleration": [0, 0, -weight]}, **changes)


def held(kind: str, strain: str = "kirchhoff", **changes: Any) -> Scene:
    """The round rod with its tip pushed 10 % towards its base, perfectly straight."""
    pose = {"quaternion": [1, 0, 0, 0]} if kind == "clamped" else {}
    support = {"rod": "rod", "kind": kind, "position": [0, 0, 0.9], **pose}
    return column(strain, supports=[support], **changes)


def assert_integrates(solution: Solution, atol: float) -> None:
    """An initial-value integration from the base wrench ends at the tip, and at the tip's load where it is free."""
    base = solution.base_wrench()
    tip = integrate(solution.model.scene, base.force, base.moment)
    assert_allclose(tip.position, solution.tip().position, rtol=0, atol=atol)
    if not solution.model.scene.supports:
        assert_allclose([tip.force_left, tip.moment_left], np.zeros((2, 3)), rtol=0, atol=10 * atol)


# What a solution says of itself


@pytest.mark.parametrize("ratio", [1.02, pytest.param(2.0, marks=pytest.mark.slow)])
@pytest.mark.parametrize("strain", mostly_slow(["planar", "kirchhoff"], quick=["kirchhoff"]))
def test_column_beyond_its_load_is_unstable_by_default_and_buckled_if_stable_is_wanted(
    strain: str, ratio: float
) -> None:
    wanted = column(strain, push(force=[0, 0, -ratio * CRITICAL]))
    straight, bent = solve(wanted), solve(wanted, stable=True)
    assert (straight.converged, straight.stable) == (True, False)
    assert "It is unstable" in straight.message
    assert straight.smallest_eigenvalue is not None
    assert straight.smallest_eigenvalue < 0.0
    assert (bent.converged, bent.stable) == (True, True)
    x, y, z = bent.tip().position
    assert_allclose([np.hypot(x, y), z], column_tip(ratio), rtol=0, atol=1e-6)
    assert ("neutral" in bent.message) is (strain == "kirchhoff")
    assert "settling" in bent.message


@pytest.mark.parametrize(("weight", "stable"), [(7.837, True), (7.838, False)])
def test_standing_column_about_its_critical_weight(weight: float, stable: bool) -> None:
    """7.8373 EI/L³, Greenhill 1881. One mode would meet the straight tip and be too stiff to buckle."""
    solution = solve(standing("kirchhoff", weight))
    assert solution.converged
    assert solution.stable is stable


def test_a_carried_column_vs_eulers_load() -> None:
    """Two rods in series under a dead load on a body: straight, stable below Euler's critical load, unstable above."""
    critical = np.pi**2 * 1.4 / (4 * 0.8**2)
    rods = [rod("planar", name="a", length=0.5), rod("planar", name="b", length=0.3, base={"rod": "a"})]
    cap = {"bodies": [{"name": "cap"}], "joints": [{"body": "cap", "rod": "b", "kind": "fixed"}]}
    load = {"name": "push", "kind": "body_wrench", "body": "cap", "force": [0, 0, 0]}
    model = build(scene(load, rods=rods, inputs=["push.force"], accuracy={"modes": 3, "nodes": 6}, **cap))
    for share, stable in ((0.98, True), (1.02, False)):
        solution = solve(model, {"push.force": [0, 0, -share * critical]})
        assert solution.converged, solution.message
        assert solution.stable is stable


def test_standing_column_beyond_its_weight_settles() -> None:
    solution = solve(standing("planar", 9.0), stable=True)
    assert (solution.converged, solution.stable) == (True, True)
    assert abs(solution.tip().position[0]) > 0.3
    assert_integrates(solution, 1e-5)


@pytest.mark.parametrize("kind", [pytest.param("clamped", marks=pytest.mark.slow), "pinned"])
def test_straight_round_rod_pushed_together_from_a_cold_start(kind: str) -> None:
    solution = solve(held(kind))
    assert (solution.converged, solution.stable) == (True, True), solution.message
    assert "neutral" in solution.message
    assert_integrates(solution, 1e-5)


def test_load_without_a_potential_is_refused_if_stable_is_wanted() -> None:
    follower = scene(push(frame="body"), WEIGHT)
    with pytest.raises(SceneError, match="no potential"):
        solve(follower, stable=True)
    with pytest.raises(SceneError, match="no potential"):
        solve(build(follower), stable=True)


def test_solve_of_a_model_settles_only_if_asked() -> None:
    wanted = column("planar", push(force=[0, 0, -2 * CRITICAL]))
    model = build(wanted, discretise(wanted, 10, 20, "magnus6"))
    assert solve(model).stable is False
    bent = solve(model, stable=True)
    assert bent.stable is True
    assert_allclose(np.abs(bent.tip().position[[0, 2]]), column_tip(2.0), rtol=0, atol=1e-7)
    assert solve(model, {"push.force": [0.1, 0, 0]}, stable=True).message == Outcome.CONVERGED.value


def buckled_tip(push: float, tangent: Callable[[float], float]) -> FloatArray:
    """Place x, z of the tip of a column of length 1 with a tangent stiffness by curvature, by shooting from its tip."""

    def from_tip(angle: float) -> FloatArray:
        """Angle at the base, and the way from base to tip."""
        places = solve_ivp(
            lambda _, y: [-y[1], push * np.sin(y[0]) / tangent(y[1]), np.sin(y[0]), np.cos(y[0])],
            (0.0, 1.0),
            [angle, 0.0, 0.0, 0.0],
            rtol=1e-10,
            atol=1e-12,
        )
        return np.asarray(places.y[[0, 2, 3], -1])

    return from_tip(brentq(lambda angle: float(from_tip(angle)[0]), 0.1, 2.5, xtol=1e-12))[1:]


def test_column_of_a_law_that_stiffens_settles_where_shooting_ends() -> None:
    """It buckles at Euler's load, as its tangent at rest is that of a linear one, and yields less beyond."""
    matter = {"law": "polynomial", "terms": [{"bending_y": 4, "coefficient": 0.05}], "youngs_modulus": 4 / np.pi}
    upright = {"name": "rod", "length": 1.0, "strain": "planar", "section": {"shape": "circle", "radius": 1.0}}
    rods = [{**upright, "material": {**matter, "poisson_ratio": 0.5}}]
    wanted = scene(push(force=[0, 0, -1.2 * CRITICAL]), rods=rods)
    straight, bent = solve(wanted), solve(wanted, stable=True)
    assert (straight.converged, straight.stable) == (True, False)
    assert (bent.converged, bent.stable) == (True, True)
    x, z = buckled_tip(1.2 * CRITICAL, lambda curvature: 1.0 + 0.6 * curvature**2)
    assert_allclose(np.abs(bent.tip().position[[0, 2]]), [x, z], rtol=0, atol=1e-5)
    assert x < 0.8 * column_tip(1.2)[0]


def test_dead_moment_in_the_plane_settles_without_a_written_energy() -> None:
    """A column beyond its load with a small dead moment at its tip: it falls to the side of the moment, or stays."""
    load = push(force=[0, 0, -2 * CRITICAL], moment=[0, 1e-3, 0])
    wanted = column("planar", load)
    solution = solve(build(wanted, discretise(wanted, 10, 20, "magnus6")), stable=True)
    assert solution.stable is True
    assert_integrates(solution, 1e-5)


def test_critical_equilibrium_is_neither_called_stable_nor_neutral() -> None:
    wanted = column("planar", push(force=[0, 0, -2 * CRITICAL]))
    model = build(wanted, discretise(wanted, 8, 16, "magnus6"))
    (event, *_) = follow(model, "push.force", [0, 0, -2 * CRITICAL]).events
    critical = solve(model, {"push.force": [0, 0, -2 * CRITICAL * event.factor]})
    assert critical.converged
    assert critical.stable is False
    assert "critical" in critical.message


def free_rod_on_a_table(tangent: list[float]) -> Scene:
    """A soft rod that lies or stands on a stiff table, and may slide and turn on it."""
    base = {"position": [0, 0, 8e-3], "tangent": tangent, "free": True}
    material = {"youngs_modulus": 5e6, "poisson_ratio": 0.48, "density": 1100.0}
    soft = {"name": "rod", "length": 0.4, "strain": "planar", "material": material, "base": base}
    table = {"name": "table", "kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1], "width": 4e-3, "stiffness": 1e5}
    rods = [{**soft, "section": {"shape": "circle", "radius": 8e-3}}]
    weight = {"name": "weight", "kind": "gravity", "acceleration": [0, 0, -9.81]}
    return scene(weight, rods=rods, obstacles=[table], accuracy={"modes": 3, "nodes": 8})


def test_rod_that_lies_on_a_table_is_neutral() -> None:
    """It slides and turns on it without energy; Newton's method takes 15 steps beside a table as stiff as that."""
    lying = solve(build(free_rod_on_a_table([1, 0, 0.15])), stable=True)
    assert lying.stable is True
    assert "neutral" in lying.message


def test_free_rod_is_not_let_settle() -> None:
    standing = solve(build(free_rod_on_a_table([0, 0, 1])), stable=True)
    assert standing.converged
    assert standing.stable is False
    assert "free rods" in standing.message


def test_verdict_of_eigenvalues() -> None:
    assert stability_of(np.zeros(0)).stable
    assert stability_of(np.array([0.1, 2.0])).stable
    neutral = stability_of(np.array([-1e-12, 0.1, 5.0]))
    assert (neutral.stable, neutral.neutral, neutral.zero) == (True, True, 1)
    unstable = stability_of(np.array([-0.1, 1e-13, 1.0]))
    assert (unstable.stable, unstable.neutral, unstable.negative) == (False, False, 1)


# Steps where the tangent is singular


def test_newton_step_of_a_nearly_singular_matrix_is_the_shortest() -> None:
    rng = np.random.default_rng(3)
    left, right = (np.linalg.qr(rng.standard_normal((6, 6)))[0] for _ in range(2))
    matrix = left @ np.diag([3.0, 2.0, 1.0, 0.5, 0.3, 1e-15]) @ right.T
    residual = rng.standard_normal(6)
    step = newton_step(matrix, residual)
    assert step is not None
    assert_allclose(step, -np.linalg.pinv(matrix, rcond=1e-10) @ residual, rtol=0, atol=1e-12)
    regular = left @ np.diag([3.0, 2.0, 1.0, 0.5, 0.3, 1e-9]) @ right.T
    step = newton_step(regular, regular @ np.ones(6))
    assert step is not None
    assert_allclose(step, -np.ones(6), rtol=0, atol=1e-5)


def test_newton_on_a_circle_of_equilibria_does_not_turn() -> None:
    """Gradient of (|x|² − 1)²: every point of the circle is one, and turning about it costs nothing."""
    equations = Equations(
        lambda x: (x @ x - 1) * x, lambda x: (x @ x - 1) * np.eye(3) + 2 * np.outer(x, x) + np.diag([0, 0, 1e-18])
    )
    start = np.array([0.9, 0.5, 0.0])
    result = newton(equations, start, NewtonSettings())
    assert result.outcome is Outcome.CONVERGED
    assert_allclose(result.x, start / np.linalg.norm(start), rtol=0, atol=1e-9)


# The descent


def test_step_in_the_ball_vs_brute_force() -> None:
    rng = np.random.default_rng(4)
    for k in range(20):
        values = np.sort(rng.normal(scale=2.0, size=2))
        slopes = np.array([0.0 if k % 4 == 0 else rng.normal(), rng.normal()])
        step = ball_minimum(values, slopes, 0.7, 1.0)
        assert np.linalg.norm(step) <= 0.7 * (1 + 1e-5)
        radius, angle = np.meshgrid(np.linspace(0, 0.7, 200), np.linspace(0, 2 * np.pi, 721))
        z = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)
        least = (z @ slopes + z**2 @ values / 2).min()
        assert step @ slopes + step**2 @ values / 2 <= least + 1e-4 * (1 + abs(least))


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_descent_leaves_a_saddle_to_either_side(side: float) -> None:
    """Double well (x² − 1)²/4 + y²: a saddle at zero, minima at x = ±1."""
    energy = Energy(lambda x: np.array([x[0] ** 3 - x[0], 2 * x[1]]), lambda x: np.diag([3 * x[0] ** 2 - 1, 2.0]))
    minimum = descend(energy, np.zeros(2), side, DescentSettings())
    assert minimum is not None
    assert_allclose(np.abs(minimum), [1.0, 0.0], rtol=0, atol=1e-7)
    mirrored = descend(energy, np.zeros(2), -side, DescentSettings())
    assert mirrored is not None
    assert_allclose(mirrored, -minimum, rtol=0, atol=1e-7)
    assert_allclose(energy.change(np.zeros(2), minimum), -0.25, rtol=1e-12, atol=0)


def round_top(noise: FloatArray) -> Energy:
    """(x² + y² − 1)²/4 + 2 z² − ½ x · noise x: from the top at zero down to a circle of minima."""
    plane = np.diag([1.0, 1.0, 0.0])
    stiff = np.diag([0.0, 0.0, 4.0]) - noise

    def gradient(x: FloatArray) -> FloatArray:
        across = plane @ x
        return (across @ across - 1.0) * across + stiff @ x

    def hessian(x: FloatArray) -> FloatArray:
        across = plane @ x
        return (across @ across - 1.0) * plane + 2 * np.outer(across, across) + stiff

    return Energy(gradient, hessian)


@pytest.mark.parametrize("turn", [0.4, 2.0, -1.3])
def test_way_out_of_a_round_saddle_does_not_hang_on_rounding(turn: float) -> None:
    """Noise turns the eigenvectors of the Hessian, and gives the gradient a direction, but not the descent."""
    direction = np.array([np.cos(turn), np.sin(turn), 0.0])
    noise = 1e-13 * np.outer(direction, direction)
    minimum = descend(round_top(noise), 1e-12 * direction, 1.0, DescentSettings())
    expected = descend(round_top(np.zeros((3, 3))), np.zeros(3), 1.0, DescentSettings())
    assert minimum is not None
    assert expected is not None
    assert_allclose(minimum, expected, rtol=0, atol=1e-6)
    assert_allclose(expected[:2] @ expected[:2], 1.0, rtol=0, atol=1e-6)
    assert expected[0] > 0.99


def test_descent_without_a_minimum_ends() -> None:
    assert descend(Energy(lambda x: -x, lambda x: -np.eye(2)), np.ones(2), 1.0, DescentSettings(steps=20)) is None
    nan = Energy(lambda x: np.full(2, np.nan), lambda x: np.eye(2))
    assert descend(nan, np.ones(2), 1.0, DescentSettings()) is None


@pytest.mark.parametrize("kind", ["clamped", "pinned"])
def test_energy_with_springs_for_supports_has_this_gradient_and_hessian(kind: str) -> None:
    """Its Hessian is symmetric and the derivative of its gradient: an energy exists."""
    pose = {"position": [0.1, 0.2, 0.5], "quaternion": [0.9, 0.1, 0.3, -0.3]}
    support = {"rod": "rod", "kind": kind, **({"position": pose["position"]} if kind == "pinned" else pose)}
    wanted = scene(WEIGHT, rods=[rod("kirchhoff")], supports=[support])
    model = build(wanted, discretise(wanted, 3, 6, "magnus4"))
    energy = energy_at(model, model.pack(), 0.9)
    q = 0.4 * np.random.default_rng(5).standard_normal(model.discrete.unknowns.count(BlockKind.STRAIN))
    hessian = energy.hessian(q)
    assert_allclose(hessian, hessian.T, rtol=0, atol=1e-10)
    for direction in np.eye(len(q)):
        slope = (energy.gradient(q + 1e-5 * direction) - energy.gradient(q - 1e-5 * direction)) / 2e-5
        assert_allclose(hessian @ direction, slope, rtol=0, atol=1e-6)


MIDDLE = {"name": "push", "kind": "point_wrench", "rod": "rod", "at": 0.5, "force": [0.0, 0.0, 0.56]}


@pytest.mark.parametrize(
    ("torsion", "height", "loads"),
    [(1.4, 0.105, []), pytest.param(2.0, 0.3, [MIDDLE], marks=pytest.mark.slow)],
    ids=["pin", "force and pin"],
)
def test_a_round_rod_that_is_pressed_together_is_neutral(torsion: float, height: float, loads: list[Any]) -> None:
    """It lies in a plane, which turns about the axis.

    The large force of the pin turns along and tells nothing of how far it was turned; one that stays behind would
    turn it too far.
    """
    stiffness = {"bending_x": 1.0, "bending_y": 1.0, "torsion": torsion}
    pressed = {
        "schema": 1,
        "rods": [{"name": "rod", "length": 1.0, "strain": "kirchhoff", "stiffness": stiffness}],
        "supports": [{"rod": "rod", "kind": "pinned", "position": [0.0, 0.0, height]}],
        "loads": loads,
    }
    wanted = scene_from_dict(pressed)
    solution = solve(build(wanted, discretise(wanted, 7, 16)), stable=True)
    assert solution.converged
    assert "neutral" in solution.message
    assert solution.stable


@pytest.mark.slow
def test_a_bent_rod_that_is_drawn_nearly_straight_relaxes() -> None:
    """Springs that close most gaps leave it far from its clamp, whose force is some hundred times EI/L²."""
    drawn = held_scene(28)
    wanted = scene_from_dict(drawn)
    solution = solve(build(wanted, discretise(wanted, 7, 18)), stable=True)
    assert solution.converged
    assert solution.stable
    distance = np.linalg.norm(solution.tip().position - drawn["supports"][0]["position"])
    assert_allclose(distance, 0.0, rtol=0, atol=1e-10)
