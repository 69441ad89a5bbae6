"""A rubber rod that hangs over a floor, touches it or lies on it, and places of its markers by discrete rods."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np

from cosserat_casadi import Solution, build, scene_from_dict, solve
from cosserat_casadi.maths.typing import FloatArray
from tests.reference.discrete_rods import discrete_equilibrium

MODULUS = 2e6
SIGMA = 2e-4
FLOOR = {"name": "floor", "kind": "plane", "point": [0, 0, -0.1], "normal": [0, 0, 1]}
WEIGHTS = (-0.006, -0.014, -0.2)
"""Forces per length, N/m: the rod hangs free, its tip is on the floor, and it lies there."""

AT = (0.4, 0.7, 1.0)
SEGMENTS = 80


MARKERS = {
    "name": "markers",
    "quantity": "position",
    "file": "markers.csv",
    "rod": "rod",
    "at": "X",
    "case": "case",
    "columns": ["x", "y", "z"],
    "sigma": SIGMA,
}
"""Their measurement."""


def tables(modulus: float, weight: float = 0.0) -> dict[str, Any]:
    """A rubber rod that hangs over a floor."""
    rod = {
        "name": "rod",
        "length": 1.0,
        "strain": "planar",
        "base": {"position": [0, 0, 0], "tangent": [1, 0, 0]},
        "material": {"youngs_modulus": modulus, "poisson_ratio": 0.45, "density": 1100.0},
        "section": {"shape": "circle", "radius": 0.01},
    }
    load = {"name": "weight", "kind": "distributed_wrench", "rod": "rod", "force": [0, 0, weight]}
    return {
        "schema": 1,
        "rods": [rod],
        "loads": [load],
        "obstacles": [FLOOR],
        "inputs": ["weight.force"],
        "accuracy": {"modes": 4, "nodes": 8},
    }


@cache
def truth(weight: float) -> Solution:
    return solve(build(scene_from_dict(tables(MODULUS, weight))))


@cache
def markers() -> dict[str, Any]:
    """Places of the markers of discrete rods, with noise."""
    places = []
    for weight in WEIGHTS:
        solution = truth(weight)
        sections = np.linspace(0.0, 1.0, SEGMENTS + 1)
        between = (sections[1:] + sections[:-1]) / 2
        start = {"rod": (solution.pose(sections).position, solution.pose(between).rotation)}
        minimum = discrete_equilibrium(tables(MODULUS, weight), start)
        assert minimum.solved
        places.append([minimum.ends["rod"][round(X * SEGMENTS) - 1] for X in AT])
    noise = np.random.default_rng(5).normal(size=(len(WEIGHTS), len(AT), 3))
    return table(WEIGHTS, np.array(places) + SIGMA * noise)


def table(weights: Sequence[float], places: FloatArray) -> dict[str, Any]:
    """Places of the markers of each case, shape (cases, markers, 3), as a file has them."""
    return {
        "markers.csv": {
            "X": np.tile(AT, len(weights)),
            "case": np.repeat(np.arange(len(weights)), len(AT)),
            "weight": np.repeat(weights, len(AT)),
            **dict(zip("xyz", places.reshape(-1, 3).T, strict=True)),
        }
    }
