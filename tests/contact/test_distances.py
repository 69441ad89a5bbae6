"""Distances from obstacles: their gradients and second derivatives, on the axis too, and what a lumen is."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi.obstacles.lumen import CentreLine
from cosserat_casadi.obstacles.registry import SURFACES
from cosserat_casadi.scene import Capsule, Lumen, ObstacleRecord, Plane, Sphere
from tests.derivatives import central_differences

STRAIGHT = {"points": ((0.0, 0.0, 0.0), (0.0, 0.0, 0.05), (0.0, 0.0, 0.2))}
BENT = {"points": ((0.0, 0.0, -0.02), (0.0, 0.0, 0.05), (0.01, 0.005, 0.12), (0.05, 0.0, 0.22))}

RECORDS = {
    "plane": Plane(name="table", kind="plane", point=(0.0, 0.0, -1.0), normal=(1.0, 2.0, 2.0)),
    "sphere": Sphere(name="ball", kind="sphere", centre=(0.0, 0.0, 0.1), radius=0.1),
    "capsule": Capsule.model_validate(
        {"name": "bar", "kind": "capsule", "from": (0.0, 0.0, 0.0), "to": (0.0, 0.0, 0.1), "radius": 0.02}
    ),
    "lumen": Lumen(name="vessel", kind="lumen", radius=(6e-3, 7e-3, 5e-3, 5e-3), **BENT),
}

POINTS = np.random.default_rng(3).normal([0.0, 0.0, 0.1], 0.03, (6, 3))


@pytest.mark.parametrize("kind", RECORDS)
def test_derivatives(kind: str) -> None:
    distance = SURFACES[kind].function(RECORDS[kind])
    for point in POINTS:
        value, gradient, second = (part.full() for part in distance(point))
        slopes, bends = (central_differences(lambda at, k=k: distance(at)[k], point, 1e-6) for k in (0, 1))
        assert_allclose(gradient.T, slopes, rtol=0, atol=1e-7)
        assert_allclose(second, bends, rtol=1e-6, atol=1e-6 * max(1.0, np.abs(second).max()))
        # A signed distance: it grows by as much as the point moves away.
        assert_allclose(np.linalg.norm(gradient), 1.0, rtol=0, atol=1e-12)
        assert_allclose(float(distance(point + 1e-3 * gradient[:, 0])[0]) - value, 1e-3, rtol=0, atol=1e-12)


@pytest.mark.parametrize("kind", RECORDS)
def test_derivatives_are_finite_on_the_axis(kind: str) -> None:
    on_axis = {"plane": (0.0, 0.0, -1.0), "sphere": (0.0, 0.0, 0.1), "capsule": (0.0, 0.0, 0.05)}
    point = np.asarray(on_axis.get(kind, BENT["points"][2]))
    for part in SURFACES[kind].function(RECORDS[kind])(point):
        assert np.all(np.isfinite(part.full()))


def test_closed_forms() -> None:
    at = np.array([0.03, -0.04, 0.3])
    distances = {kind: float(SURFACES[kind].function(record)(at)[0]) for kind, record in RECORDS.items()}
    assert_allclose(distances["plane"], (0.03 - 0.08 + 2 * 1.3) / 3, rtol=0, atol=1e-15)
    assert_allclose(distances["sphere"], np.sqrt(0.05**2 + 0.2**2) - 0.1, rtol=0, atol=1e-15)
    # Beyond the end of the axis, where half a ball ends the bar.
    assert_allclose(distances["capsule"], np.sqrt(0.05**2 + 0.2**2) - 0.02, rtol=0, atol=1e-15)


def test_a_lumen_is_the_union_of_balls() -> None:
    line = CentreLine(RECORDS["lumen"])
    s = np.linspace(-0.05, 0.4, 40001)
    centres, radii = line.at(s)
    distance = SURFACES["lumen"].function(RECORDS["lumen"])
    for point in POINTS:
        farthest = (radii - np.linalg.norm(point - centres, axis=1)).max()
        # Ten micrometres between the balls that are tried: their envelope is nearer by the square of that.
        assert_allclose(float(distance(point)[0]), farthest, rtol=0, atol=1e-8)


def test_the_line_of_a_lumen() -> None:
    """It passes its points, is straight without curvature beyond them, and has two continuous derivatives."""
    lumen = RECORDS["lumen"]
    line = CentreLine(lumen)
    points, radii = line.at(line.knots)
    assert_allclose(points, BENT["points"], rtol=0, atol=1e-15)
    assert_allclose(radii, lumen.radii, rtol=0, atol=1e-15)
    step = 1e-4
    for knot in line.knots:
        around, radius = line.at(knot + step * np.arange(-2.0, 3.0))
        before = around[0] - 2 * around[1] + around[2]
        after = around[2] - 2 * around[3] + around[4]
        assert_allclose(after - before, 0.0, rtol=0, atol=1e-9)
        # Beyond the ends the radius is constant: its second derivative alone jumps there.
        assert_allclose(radius[3] - radius[1], (radius[4] - radius[0]) / 2, rtol=0, atol=1e-8)
    beyond, _ = line.at(line.knots[-1] + np.array([0.0, 0.1, 0.2]))
    assert_allclose(beyond[0] - 2 * beyond[1] + beyond[2], 0.0, rtol=0, atol=1e-15)


def test_a_straight_lumen_is_a_tube() -> None:
    tube = Lumen(name="tube", kind="lumen", radius=0.01, **STRAIGHT)
    distance = SURFACES["lumen"].function(tube)
    for point in ([0.003, 0.004, 0.1], [0.0, 0.02, -1.0], [0.006, 0.008, 0.37]):
        assert_allclose(float(distance(point)[0]), 0.01 - np.hypot(*point[:2]), rtol=0, atol=1e-15)


@pytest.mark.parametrize("kind", RECORDS)
def test_nets_lie_on_their_surfaces(kind: str) -> None:
    record: ObstacleRecord = RECORDS[kind]
    mesh = SURFACES[kind].mesh(record, np.array([0.1, 0.0, 0.1]), 0.3)
    distance = SURFACES[kind].function(record)
    sizes = [float(distance(point)[0]) for point in mesh.reshape(-1, 3)]
    # Where the radius of a lumen changes its surface leans, and its rings do not.
    assert_allclose(sizes, 0.0, rtol=0, atol=1e-4 if kind == "lumen" else 1e-12)


def test_lumens_that_do_not_fit() -> None:
    narrow = list(SURFACES["lumen"].faults(RECORDS["lumen"], 5.5e-3))
    assert [problem.where for problem in narrow] == ["obstacles.vessel.radius"]
    sharp = Lumen(name="bend", kind="lumen", points=((0, 0, 0), (0, 0, 0.1), (0.1, 0, 0.1)), radius=0.09)
    assert [problem.where for problem in SURFACES["lumen"].faults(sharp, 1e-3)] == ["obstacles.bend.points"]
