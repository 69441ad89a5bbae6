"""How fast errors fall, and where they stop, on three rods that bend out of every plane; against shooting.

In the intervals the Magnus methods have the order of their name in tip position, tip rotation and clamp wrench alike,
once the spectral integration of the position is resolved; the permuted system is faster than any power. In the modes
the error falls geometrically. Each band fails where an order is lost: orders come in twos.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from cosserat_casadi import Scene, build, discretise, read_scene, solve
from cosserat_casadi.maths.typing import FloatArray
from tests.conftest import ROOT
from tests.families import mostly_slow
from tests.fine_reference import RodState, distance, states
from tests.scenes import WEIGHT, push, rod, scene
from tests.shooting_near import shoot

CURLED = {"curvature": [[1.0, 2.0], [2.0, -1.5], [1.5, 0.5]]}
QUANTITIES = ("position", "rotation", "wrench")
MODES = 14
"""Enough for 1e-13 in every scene."""

FLOOR = 1e-12
"""What every method gets below."""


def twisted() -> Scene:
    return scene(push(force=[2.0, 1.5, -0.6], moment=[0.3, -0.4, 0.5]), rods=[rod(intrinsic=CURLED)])


def tube() -> Scene:
    return read_scene(ROOT / "examples" / "precurved_tube.toml")


def follower() -> Scene:
    return scene(push(force=[1.5, -2.0, 1.0], frame="body"), WEIGHT, rods=[rod("reissner", intrinsic=CURLED)])


SCENES = {"twisted": twisted, "tube": tube, "follower": follower}


@cache
def truth(name: str) -> dict[str, RodState]:
    wanted = SCENES[name]()
    return {"rod": shoot(solve(build(wanted, discretise(wanted, MODES, 44, "magnus8"))))}


def errors(name: str, modes: int, nodes: int, transport: str) -> list[float]:
    wanted = SCENES[name]()
    solution = solve(build(wanted, discretise(wanted, modes, nodes, transport)))
    assert solution.converged
    found = distance(truth(name), dict(zip(["rod"], states(solution).values(), strict=True)))
    return [getattr(found, quantity) for quantity in QUANTITIES]


def swept(name: str, nodes: tuple[int, ...], transport: str) -> FloatArray:
    return np.array([errors(name, MODES, n, transport) for n in nodes])


@pytest.mark.parametrize("name", mostly_slow(SCENES, quick=["twisted"]))
@pytest.mark.parametrize(
    ("transport", "order"), mostly_slow([("magnus4", 4), ("magnus6", 6), ("magnus8", 8)], quick=[("magnus6", 6)])
)
def test_slope_in_the_intervals_vs_order(name: str, transport: str, order: int) -> None:
    nodes = (17, 21, 26)
    found = swept(name, nodes, transport)
    slopes = -np.polyfit(np.log(nodes), np.log(found), 1)[0]
    assert np.all(np.abs(slopes - order) < 0.07 * order), dict(zip(QUANTITIES, slopes, strict=True))


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_permuted_system_is_faster_than_any_power(name: str) -> None:
    found = swept(name, (8, 12, 16), "permuted")
    assert np.all(found[1:] < found[:-1] * [[0.03], [1e-3]]), found


@pytest.mark.parametrize("name", mostly_slow(SCENES, quick=["twisted"]))
@pytest.mark.parametrize(("transport", "nodes"), [("magnus8", 44), ("permuted", 26)])
def test_floor(name: str, transport: str, nodes: int) -> None:
    assert max(errors(name, MODES, nodes, transport)) < FLOOR


@pytest.mark.parametrize(
    ("name", "factor"), mostly_slow([("twisted", 8.0), ("tube", 20.0), ("follower", 10.0)], quick=[("tube", 20.0)])
)
def test_error_in_the_modes_vs_geometric_decay(name: str, factor: float) -> None:
    """Every mode more divides the error by this factor, on average."""
    modes = (3, 5, 7, 9)
    found = np.array([errors(name, m, 40, "magnus8") for m in modes])
    factors = np.exp(-np.polyfit(modes, np.log(found), 1)[0])
    assert np.all(factors > factor), dict(zip(QUANTITIES, factors, strict=True))
    assert np.all(np.diff(found, axis=0) < 0)
