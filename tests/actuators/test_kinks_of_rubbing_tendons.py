"""A rubbing tendon whose kink lies inside an element: its turn is exact there, and the estimate is above the error.

The reference is the same rod with elements that end at the kink, on which everything is smooth: to 1e-12.
"""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad

from cosserat_casadi import Solution, build, discretise, read_scene, solve
from cosserat_casadi.equilibrium.metrics import pose_distance, prolong
from cosserat_casadi.maths.pose_change import rotation_angles
from cosserat_casadi.rod.rubbing_cable import BETWEEN, STRAIGHT, _missed_by_gauss
from cosserat_casadi.scene import scene_from_dict
from tests.conftest import ROOT
from tests.families import mostly_slow

KINK = 0.2839052656
"""Abscissa at which the rod is straight: solved for, with elements that end there."""

TABLES = {
    "schema": 1,
    "rods": [
        {
            "name": "rod",
            "length": 30.0,
            "strain": "planar",
            "base": {"tangent": [1, 0, 0]},
            "material": {"youngs_modulus": 1e9, "poisson_ratio": 0.4, "density": 1000.0},
            "section": {"shape": "circle", "radius": 0.191689},
            "intrinsic": {"curvature": [0.0, 0.0221969, 0.0]},
        }
    ],
    "loads": [{"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [916.714, 0.0, -5061.9]}],
    "obstacles": [{"name": "wall", "kind": "plane", "point": [0, 0, -6.72554], "normal": [-0.165769, 0, 1]}],
    "actuators": [
        {"name": "c", "kind": "tendon", "rod": "rod", "offset": [0.3, 0.0], "tension": 130398.0, "friction": 0.3}
    ],
}
"""A scene of a thousand random ones: the estimate of the rule before was less than half of the error of its tip."""


def solved(*loads: dict[str, object], **accuracy: object) -> Solution:
    found = solve(scene_from_dict({**TABLES, "loads": [*TABLES["loads"], *loads], "accuracy": accuracy}))
    assert isinstance(found, Solution)
    assert found.converged
    return found


@pytest.fixture(scope="module")
def reference() -> Solution:
    """With an element that ends at the kink, where a load of nothing acts."""
    at_kink = {"name": "kink", "kind": "point_wrench", "rod": "rod", "at": KINK, "force": [0, 0, 0]}
    return solved(at_kink, modes=14, nodes=24)


def error(solution: Solution, reference: Solution) -> float:
    """Displacement of the tip over the length, or its angle."""
    tip = solution.tip()
    wanted = reference.tip()
    moved = np.linalg.norm(tip.position - wanted.position) / 30.0
    return max(float(moved), float(rotation_angles(tip.quaternion, wanted.quaternion)))


def test_the_reference_is_straight_at_the_kink(reference: Solution) -> None:
    assert_allclose(reference.strain(np.array([KINK]))[0, 1], 0.0, rtol=0, atol=1e-9)
    assert reference.error_estimate is not None
    assert reference.error_estimate < 1e-11


def test_the_estimate_is_above_the_error(reference: Solution) -> None:
    found = solved(tolerance=1e-5)
    assert found.error_estimate is not None
    assert 0.0 < error(found, reference) <= found.error_estimate <= 1e-5


@pytest.mark.parametrize("nodes", mostly_slow([25, 26, 29, 40], quick=[25, 40]))
def test_the_error_is_that_of_the_modes_wherever_the_kink_lies(reference: Solution, nodes: int) -> None:
    """2e-6 with 11 modes; it was 4e-6 to 8e-6, as the kink lay between nodes."""
    found = solved(modes=11, nodes=nodes)
    true = error(found, reference)
    assert_allclose(true, 1.95e-6, rtol=0.1, atol=0)
    assert found.error_estimate is not None
    assert true <= found.error_estimate <= 2 * true


@pytest.mark.parametrize("inputs", [[1.111, -0.2175, 0.1202], [1.43, 0.3969, 0.1179]])
def test_the_estimate_of_few_intervals_is_above_their_error(inputs: list[float]) -> None:
    """Ten intervals beside six took out half of the error: 1.7e-6 was told for 2.9e-6."""
    finger = read_scene(ROOT / "examples" / "rubbing_tendon.toml")
    found = solve(build(finger, discretise(finger, (1, 4, 1), 6)), inputs)
    finer = build(finger, discretise(finger, 14, 80, "magnus8"))
    wanted = solve(finer, inputs, start=prolong(found, finer), estimate_error=False)
    true = pose_distance(found, wanted)
    assert found.error_estimate is not None
    assert true <= found.error_estimate <= 1.5 * true


@pytest.mark.parametrize(
    ("left", "right"),
    [
        ([1.0], [-0.5]),
        ([1e-3], [-2e-3]),
        ([0.0], [1.0]),
        ([0.5, 0.1], [-0.7, 0.05]),
        ([0.5, 0.1, -0.3], [-0.7, 0.05, 0.42]),
        ([2e3], [-1e3]),
    ],
)
def test_what_gauss_misses_vs_quadrature(left: list[float], right: list[float]) -> None:
    """All of it on a line through zero, nearly all beside it; and its derivatives against differences."""
    u0 = np.array(left)
    u1 = np.array(right)

    def root(s: float) -> float:
        return float(np.sqrt(np.sum((u0 + s * (u1 - u0)) ** 2) + STRAIGHT**2))

    points, weights = np.polynomial.legendre.leggauss(BETWEEN)
    gauss = sum(weight / 2 * root((point + 1) / 2) for point, weight in zip(points, weights, strict=True))
    nearest = float(np.clip(u0 @ (u0 - u1) / ((u1 - u0) @ (u1 - u0)), 0.0, 1.0))
    exact = quad(root, 0, 1, points=[nearest], epsabs=1e-14, epsrel=1e-13, limit=500)[0]
    kernel = _missed_by_gauss(len(left))
    missed, by_left, by_right = kernel(left, right)
    size = float(np.abs([*left, *right]).max())
    # The change from end to end is rounded by as much as the roots: by ε²/6 over the size of u.
    rounding = STRAIGHT**2 * (1 + 8 / size) + 1e-14 * size
    share = 0.0 if len(left) == 1 else 0.02
    assert_allclose(float(missed), exact - gauss, rtol=share, atol=rounding)
    step = 1e-6 * size
    for k in range(len(left)):
        moved = np.zeros(len(left))
        moved[k] = step
        for result, at_left, at_right in ((by_left, moved, 0 * moved), (by_right, 0 * moved, moved)):
            change = kernel(u0 + at_left, u1 + at_right)[0] - kernel(u0 - at_left, u1 - at_right)[0]
            assert_allclose(float(result[k]), float(change) / (2 * step), rtol=0, atol=2e-5)


@pytest.mark.parametrize("right", [[0.32, 0.21, 0.08], [-0.2, 0.35, 0.0], [0.3, 0.2, 0.1], [0.0, 0.0, 0.0]])
def test_nothing_is_missed_where_nothing_passes_zero(right: list[float]) -> None:
    """The turn of a cable that is curved everywhere stays spectral; derivatives are finite where nothing changes."""
    results = _missed_by_gauss(3)(ca.DM([0.3, 0.2, 0.1]), ca.DM(right))
    for result in results:
        assert_allclose(result.full(), 0.0, rtol=0, atol=1e-15)
