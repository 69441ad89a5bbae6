"""Made-up measurements of a wire, for tests and benchmarks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from cosserat_casadi import Model, solve
from cosserat_casadi.maths.typing import FloatArray

NAMES = (
    "wire.material.youngs_modulus",
    "wire.material.shear_modulus",
    "wire.intrinsic.curvature.x[0]",
    "wire.intrinsic.curvature.x[1]",
)

TRUTH = dict(zip(NAMES, (52e9, 20e9, 1.0, -2.0), strict=True))

SECTIONS = np.linspace(0.1, 1.0, 10)

WIRE: dict[str, Any] = {
    "schema": 1,
    "accuracy": {"modes": 4, "nodes": 10},
    "rods": [
        {
            "name": "wire",
            "length": 0.2,
            "strain": "kirchhoff",
            "material": {"youngs_modulus": 60e9, "shear_modulus": 23e9},
            "section": {"shape": "circle", "radius": 0.5e-3},
            "intrinsic": {"curvature": [[0.0, 0.0], 0.0, 0.0]},
        }
    ],
    "loads": [{"name": "push", "kind": "tip_wrench", "rod": "wire", "force": [0, 0, 0], "moment": [0, 0, 0]}],
    "measurements": [
        {
            "quantity": "position",
            "file": "shapes.csv",
            "inputs": {
                **{f"push.force.{axis}": f"F{axis}" for axis in "xyz"},
                **{f"push.moment.{axis}": f"M{axis}" for axis in "xyz"},
            },
            "rod": "wire",
            "at": "X",
            "columns": ["x", "y", "z"],
            "sigma": 2e-4,
        }
    ],
    "unknowns": [
        {"parameter": NAMES[0], "lower": 1e9, "upper": 1e12},
        {"parameter": NAMES[1], "lower": 1e8, "upper": 1e12},
        {"parameter": NAMES[2]},
        {"parameter": NAMES[3]},
    ],
}
"""The tables of the scene; its columns are those of `measured_shapes`."""


@dataclass(frozen=True)
class MadeUp:
    """Measurements that were made up.

    Attributes:
        columns: as `identify` takes them, by column.
        truth: parameters that they were made with.
    """

    columns: dict[str, FloatArray]
    truth: dict[str, float]

    @property
    def data(self) -> dict[str, dict[str, FloatArray]]:
        """By measurement."""
        return {"shapes.csv": self.columns}


def loads(rng: np.random.Generator, cases: int) -> FloatArray:
    """Forces at the tip, N, and moments, N m, that bend the wire by about half a radian and twist it."""
    forces = rng.uniform(-0.03, 0.03, (cases, 3))
    moments = rng.uniform(-0.005, 0.005, (cases, 3))
    return np.hstack([forces, moments])


def measured_shapes(
    model: Model, rng: np.random.Generator, *, cases: int, noise: float, truth: dict[str, float] = TRUTH
) -> MadeUp:
    """Positions of ten sections under random loads, with normal noise, m."""
    true_model = model.at(truth)
    rows = []
    for load in loads(rng, cases):
        solution = solve(true_model, {"push.force": load[:3], "push.moment": load[3:]})
        positions = solution.pose(SECTIONS).position
        positions += noise * rng.standard_normal(positions.shape)
        rows += [[*load, X, *position] for X, position in zip(SECTIONS, positions, strict=True)]
    names = [*(f"F{axis}" for axis in "xyz"), *(f"M{axis}" for axis in "xyz"), "X", "x", "y", "z"]
    return MadeUp(dict(zip(names, np.array(rows).T, strict=True)), truth)
