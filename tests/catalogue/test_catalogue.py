"""The catalogue of hard cases (a) – (k): (l) is in test_exact_derivatives.py.

Of (d), (e) this is the deep arch; critical loads, branches and their elliptic integrals are in
tests/paths/test_path.py, the column under its weight in tests/equilibrium/test_stability.py.
"""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import brentq

from cosserat_casadi import build, discretise, follow, read_scene, solve
from tests.catalogue import cases
from tests.catalogue.checks import (
    column_eigenvalue,
    fine_model,
    initial_value_error,
    ring_eigenvalue,
    solved,
    zero_near,
)
from tests.conftest import ROOT
from tests.families import mostly_slow
from tests.reference.closed_forms import elastica, roll_up
from tests.reference.shooting import solve_by_shooting
from tests.shooting_near import integrate


@pytest.mark.slow
def test_arch_beyond_its_limit_load_is_in_equilibrium() -> None:
    """A point between the limits and the end, integrated from the clamp: the hinge is met, no moment is left."""
    file = ROOT / "examples" / "deep_arch.toml"
    scene = read_scene(file)
    path = follow(build(scene, discretise(scene, 18, 44, "magnus8")), "crown.force", [0, 0, -1000.0])
    assert path.converged
    first, second = (event.position for event in path.events)
    for index in ((first + second) // 2, -1):
        solution = path.solution(index)
        base = solution.base_wrench()
        pushed = read_scene(file, (f"crown.force=[0, 0, {float(-1000.0 * path.factor[index])!r}]",))
        reached = integrate(pushed, base.force, base.moment)
        assert_allclose(reached.position, scene.supports[0].position, rtol=0, atol=1e-8 * scene.rods[0].length)
        assert_allclose(reached.moment_left, 0.0, rtol=0, atol=1e-8 * np.abs(base.moment).max())


# Catalogue (a) – (c): elastica, follower load, roll-up, the helical form, from cold starts.


@pytest.mark.parametrize("load", mostly_slow([0.5, 1.0, 2.0, 5.0, 10.0, 30.0, 50.0, 100.0], quick=[30.0, 100.0]))
def test_elastica_vs_elliptic_integrals(load: float) -> None:
    """Loads up to 30 EI/L² in space, stronger ones in a plane."""
    strong = load > 30.0
    rod = {} if strong else cases.round_rod(1.0)
    tip = solved(cases.table(rod, cases.tip([load, 0, 0])), 1e-9 if strong else 1e-10).tip()
    shortening, across, angle = elastica(load)
    assert_allclose(tip.position, [across, 0, 1 - shortening], rtol=0, atol=1e-8 if strong else 1e-10)
    slope = [np.sin(angle), 0, np.cos(angle)]
    assert_allclose(tip.rotation[:, 2], slope, rtol=0, atol=1e-8 if strong else 1e-9)


@pytest.mark.parametrize("load", mostly_slow([20.0, 40.0], quick=[40.0]))
def test_follower_force_vs_pendulum(load: float) -> None:
    tip = solved(cases.table({}, cases.tip([load, 0, 0], frame="body"))).tip()
    across, along = cases.follower_cantilever(load)
    assert_allclose(tip.position, [across, 0, along], rtol=0, atol=1e-8)


@pytest.mark.parametrize(
    ("turns", "atol"),
    mostly_slow(
        [(0.25, 1e-10), (0.5, 1e-10), (1, 1e-10), (2, 1e-10), (5, 1e-8), (12, 1e-8)],
        quick=[(0.25, 1e-10), (2, 1e-10), (12, 1e-8)],
    ),
)
def test_roll_up_into_circles(turns: float, atol: float) -> None:
    rolled = cases.table(cases.round_rod(1.0), cases.tip(moment=[0, 2 * np.pi * turns, 0]))
    tip = solved(rolled, min(atol, 1e-9)).tip()
    position, rotation = roll_up(turns)
    assert_allclose(tip.position, position, rtol=0, atol=atol)
    assert_allclose(tip.rotation, rotation, rtol=0, atol=atol)


@pytest.mark.slow
def test_two_turns_of_the_helical_form_vs_initial_value() -> None:
    assert initial_value_error(solved(cases.helical_form(0.2), 1e-8)) < 1e-7


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.3, 0.5, 1.0])
def test_helical_form_vs_initial_value(share: float) -> None:
    """Ten turns at share 1."""
    assert initial_value_error(solved(cases.helical_form(share), 1e-9)) < 1e-8


# Catalogue (f): rods clamped at both ends, from the straight rod, with default settings.


PLANAR = list(cases.HELD)


@pytest.mark.parametrize(
    ("name", "strain"),
    [
        (PLANAR[1], "planar"),
        *(pytest.param(name, "planar", marks=pytest.mark.slow) for name in (PLANAR[0], PLANAR[2])),
        *(pytest.param(name, "kirchhoff", marks=pytest.mark.slow) for name in PLANAR),
    ],
)
def test_held_rod_vs_initial_value(name: str, strain: str) -> None:
    """From the wrench that the clamp is said to exert, the rod arrives where its tip is held."""
    solution = solved(cases.held(name, strain))
    (position, _) = cases.HELD[name]
    assert_allclose(solution.tip().position, position, rtol=0, atol=1e-10)
    assert initial_value_error(solution) < 1e-8
    assert solution.stable is not None
    assert solution.stable or "unstable" in solution.message


@pytest.mark.slow
@pytest.mark.parametrize("name", PLANAR[1:])
def test_held_rod_vs_shooting(name: str) -> None:
    """The same equilibrium, not only some one."""
    solution, oracle = solved(cases.held(name)), solve_by_shooting(cases.held(name))
    X = [0.25, 0.5, 0.75]
    assert_allclose(solution.pose(X).position, oracle.at(X).position, rtol=0, atol=1e-8)
    assert solution.stable


# Catalogue (g): twisted rods and rings buckle where linear theory says; a writhing rod is an equilibrium. Twist is not
# an input of a scene; a rod held without the twist that it has unloaded is twisted all the same. Critical values are
# zeros of the smallest eigenvalue of the second variation over scenes.


def test_torque_alone_vs_greenhill() -> None:
    wave = brentq(lambda z: np.tan(z) - z, 4.4, 4.6, xtol=1e-15)
    assert_allclose(cases.critical_torque(0.0), 2 * wave, rtol=1e-12, atol=0)
    found = zero_near(lambda M: column_eigenvalue(M / 2.0, 0.0, 2.0), 2 * wave)
    assert_allclose(found, 2 * wave, rtol=1e-6, atol=0)


@pytest.mark.parametrize("stretch", mostly_slow([-0.1, 0.2], quick=[-0.1]))
def test_torque_with_tension_or_compression_vs_linear_theory(stretch: float) -> None:
    """EA = 100 EI/L²: a stretch of 0.2 is a tension of 20 EI/L²."""
    torsion, axial = 2.0, 100.0
    reference = cases.critical_torque(axial * stretch, stretch)
    found = zero_near(lambda M: column_eigenvalue(M / torsion, stretch, torsion), reference)
    assert_allclose(found, reference, rtol=1e-6, atol=0)


@pytest.mark.parametrize("torsion", [2 / 3, pytest.param(2.0, marks=pytest.mark.slow)])
def test_twisted_ring_flips_at_root_three_turns(torsion: float) -> None:
    """J. H. Michell 1889, E. E. Zajac, J. Appl. Mech. 29 (1962) 136: a twist of √3 · 2π EI/GJ."""
    critical = np.sqrt(3) * 2 * np.pi / torsion
    found = zero_near(lambda twist: ring_eigenvalue(twist, torsion), critical)
    assert_allclose(found, critical, rtol=1e-6, atol=0)


@pytest.mark.slow
@pytest.mark.parametrize("twist", [2.0, 4.0, 6.0])
def test_writhing_rod_vs_initial_value(twist: float) -> None:
    assert initial_value_error(solved(cases.writhing_rod(twist))) < 1e-8


# Catalogue (h): a helical spring of ten turns.


FREE = cases.TURNS * cases.PITCH
"""Height of the unloaded spring."""


def test_soft_pull_vs_love() -> None:
    """A millionth of EI/R²: linear theory to four digits."""
    found = solve(fine_model(cases.spring(1e-6), 40, 100))
    assert found.converged, found.message
    assert_allclose(found.tip().position[2] - FREE, 1e-6 * cases.love_compliance(), rtol=1e-4, atol=0)


@pytest.mark.parametrize("force", [3e-3, *(pytest.param(f, marks=pytest.mark.slow) for f in (-3e-3, 0.02, -0.01))])
def test_spring_vs_initial_value(force: float) -> None:
    """The wire is 63 radii long; its tip is met to 1e-8 of that."""
    found = solve(fine_model(cases.spring(force), 56, 140))
    assert found.converged, found.message
    assert initial_value_error(found) < 1e-8
    assert (found.tip().position[2] - FREE) * force > 0


@pytest.mark.slow
@pytest.mark.parametrize("force", [3e-3, -3e-3])
def test_spring_to_a_tolerance(force: float) -> None:
    """Sixty-three radians in one element, found by the ladder itself."""
    found = solved(cases.spring(force), 1e-6)
    fine = solve(fine_model(cases.spring(force), 56, 140))
    assert_allclose(found.tip().position, fine.tip().position, rtol=0, atol=1e-6 * cases.spring_length())


# Catalogue (i), (j): slender wires, torsion far softer or stiffer than bending, shear that dominates.


QUICK = {
    "EA L²/EI = 1e10": cases.slender(1e10),
    "GA L²/EI = 1e-3": cases.shear_beam(1e-3),
}
SLOW = {
    "L/d = 1e4": cases.wire(1e4),
    "GJ/EI = 1e-3": cases.torsion_ratio(1e-3),
    "EA L²/EI = 1e2": cases.slender(1e2),
    "EA L²/EI = 1e6": cases.slender(1e6),
    "L/d = 10": cases.wire(10),
    "GJ/EI = 1e-2": cases.torsion_ratio(1e-2),
    "GJ/EI = 1e3": cases.torsion_ratio(1e3),
    "GA L²/EI = 0.1": cases.shear_beam(0.1),
    "GA L²/EI = 1": cases.shear_beam(1.0),
}


@pytest.mark.parametrize("name", [*QUICK, *(pytest.param(name, marks=pytest.mark.slow) for name in SLOW)])
def test_extreme_stiffness_vs_shooting(name: str) -> None:
    tables = {**QUICK, **SLOW}[name]
    solution, oracle = solved(tables), solve_by_shooting(tables)
    assert_allclose(solution.tip().position, oracle.tip_position, rtol=0, atol=1e-8)
    assert_allclose(solution.tip().rotation, oracle.tip_rotation, rtol=0, atol=1e-8)
    base, size = solution.base_wrench(), np.abs(oracle.base_force).max()
    assert_allclose(base.force, oracle.base_force, rtol=0, atol=1e-8 * size)
    assert_allclose(base.moment, oracle.base_moment, rtol=0, atol=1e-8 * max(size, np.abs(oracle.base_moment).max()))


# Catalogue (k): high order stays at rounding, and why.


SIZES = [16, 32, 64, 128]


@pytest.mark.parametrize(
    ("modes", "nodes"), [(24, 60), (40, 128), (64, 256), pytest.param(64, 512, marks=pytest.mark.slow)]
)
def test_error_stays_at_rounding_as_the_order_grows(modes: int, nodes: int) -> None:
    """F L²/EI = 10: resolved to rounding with 24 modes; no digit is lost with 64 modes and 256 intervals."""
    found = solve(fine_model(cases.table({}, cases.tip([10.0, 0, 0])), modes, nodes))
    assert found.converged, found.message
    shortening, across, _ = elastica(10.0)
    assert_allclose(found.tip().position, [across, 0, 1 - shortening], rtol=0, atol=2e-13)


@pytest.mark.slow
def test_high_order_in_space_stays_at_rounding() -> None:
    coarse, fine = (solve(fine_model(cases.slender(1e4), *size)) for size in ((24, 60), (64, 256)))
    assert_allclose(fine.tip().position, coarse.tip().position, rtol=0, atol=1e-12)
    assert_allclose(fine.tip().rotation, coarse.tip().rotation, rtol=0, atol=1e-12)


def test_condition_of_the_differentiation_form_grows_and_of_the_volterra_form_does_not() -> None:
    """The square of the points, against a constant: why the rotation is integrated, not differentiated."""
    conditions = np.array(
        [[np.linalg.cond(matrix) for matrix in cases.quaternion_matrices(2 * np.pi, N)] for N in SIZES]
    )
    differentiation, volterra = conditions.T
    assert cases.growth_exponent(SIZES, list(differentiation)) > 1.7
    assert differentiation[-1] > 1e3
    assert abs(cases.growth_exponent(SIZES, list(volterra))) < 0.1
    assert volterra.max() < 50
