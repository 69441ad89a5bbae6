"""A cantilever that is let go, as a scene with a measured path: for tests and benchmarks."""

from __future__ import annotations

from typing import Any

import numpy as np

from cosserat_casadi import Model
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.simulate import simulate

NAMES = ("rod.material.youngs_modulus", "rod.material.density", "rod.damping.retardation_time")

TRUTH = dict(zip(NAMES, (1.3e6, 1000.0, 0.014), strict=True))

NOISE = 1e-3
"""Standard deviation of one coordinate, m."""

TIMES = np.linspace(0.0, 0.5, 26)

CANTILEVER: dict[str, Any] = {
    "schema": 1,
    "accuracy": {"modes": 3, "nodes": 8},
    "rods": [
        {
            "name": "rod",
            "length": 0.3,
            "strain": "planar",
            "material": {"youngs_modulus": 1e6, "poisson_ratio": 0.4, "density": 1100.0},
            "section": {"shape": "circle", "radius": 5e-3},
            "damping": {"retardation_time": 0.01},
            "base": {"position": [0.0, 0.0, 0.0], "tangent": [1.0, 0.0, 0.0]},
        }
    ],
    "loads": [
        {"name": "weight", "kind": "gravity", "acceleration": [0.0, 0.0, -9.81]},
        {"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0.0, 0.0, 0.0]},
    ],
    "simulation": {"duration": 0.5},
    "motions": [
        {
            "input": "push.force",
            "times": [0.0, 0.02],
            "values": [[0.0, 0.0, 0.3], [0.0, 0.0, 0.0]],
            "interpolation": "step",
        }
    ],
    "measurements": [
        {
            "quantity": "position",
            "file": "path.csv",
            "time": "t",
            "rod": "rod",
            "at": 1.0,
            "columns": ["x", "", "z"],
            "sigma": NOISE,
        }
    ],
    "unknowns": [{"parameter": name} for name in NAMES],
}
"""A known force holds the tip up, and lets go."""


def path_of(model: Model, truth: dict[str, float] = TRUTH, times: FloatArray = TIMES) -> dict[str, FloatArray]:
    """The path of the tip by the adaptive steps of the simulator, by column."""
    bound = model.at(truth)
    asked = model.scene.simulation
    assert asked is not None
    simulation = asked.model_copy(update={"times": tuple(times.tolist()), "tolerance": 1e-6})
    motion = simulate(bound, simulation=simulation)
    assert motion.converged, motion.message
    positions, _ = motion.tip()
    x, _, z = positions.T
    return {"t": times, "x": x, "z": z}


def with_noise(path: dict[str, FloatArray], rng: np.random.Generator) -> dict[str, dict[str, FloatArray]]:
    """The same path with normal noise on its positions."""
    noisy = {name: path[name] + NOISE * rng.standard_normal(len(TIMES)) for name in "xz"}
    return {"path.csv": {"t": path["t"], **noisy}}
