"""Seeded random scenes of one rod: strain model, section, taper, pre-curvature, loads up to F ℓ²/EI of about ten."""

from __future__ import annotations

from typing import Any

import numpy as np

from cosserat_casadi import Scene, scene_from_dict

STRAINS: tuple[Any, ...] = ("planar", "kirchhoff", "reissner", ["bending_x", "torsion"], ["bending_y", "extension"])


def random_scene(seed: int, tolerance: float = 1e-6) -> Scene:
    """A legal scene; the same seed gives the same scene."""
    rng = np.random.default_rng(seed)
    length, radius = float(10 ** rng.uniform(-1, 1)), float(10 ** rng.uniform(-2.5, -1.3))
    stiffness = 1e9 * np.pi / 4 * (radius * length) ** 4
    force = stiffness / length**2
    rod = {
        "name": "rod",
        "length": length,
        "strain": STRAINS[rng.integers(len(STRAINS))],
        "basis": str(rng.choice(["legendre", "chebyshev"])),
        "material": {"youngs_modulus": 1e9, "poisson_ratio": 0.35, "density": 1000.0},
        "section": _section(rng, radius * length),
        "base": {"position": rng.normal(size=3).tolist(), "tangent": rng.normal(size=3).tolist()},
    }
    if rng.random() < 0.4:
        rod["intrinsic"] = {"curvature": [(rng.normal(size=2) * 1.5 / length).tolist() for _ in range(3)]}
    loads = [load for load in _loads(rng, force, length) if rng.random() < 0.6]
    if rng.random() < 0.5:
        weight = stiffness / (1000.0 * np.pi * (radius * length) ** 2 * length**3)
        loads.append({"name": "weight", "kind": "gravity", "acceleration": (weight * rng.normal(size=3)).tolist()})
    return scene_from_dict({"schema": 1, "accuracy": {"tolerance": tolerance}, "rods": [rod], "loads": loads})


def _section(rng: np.random.Generator, radius: float) -> dict[str, Any]:
    taper = [radius, radius * float(rng.uniform(0.5, 1.0))]
    sections: list[dict[str, Any]] = [
        {"shape": "circle", "radius": taper if rng.random() < 0.5 else radius},
        {"shape": "annulus", "outer_radius": taper, "inner_radius": [0.5 * t for t in taper]},
        {"shape": "rectangle", "width": 2 * radius, "height": [float(rng.uniform(0.5, 1.5)) * t for t in taper]},
    ]
    return sections[rng.integers(3)]


def _loads(rng: np.random.Generator, force: float, length: float) -> list[dict[str, Any]]:
    def vector(size: float) -> list[float]:
        return [float(v) for v in size * rng.normal(size=3)]

    frame = str(rng.choice(["world", "body"]))
    tip = float(rng.uniform(0, 4))
    return [
        {"name": "tip", "kind": "tip_wrench", "rod": "rod", "force": vector(tip * force), "frame": frame},
        {"name": "twist", "kind": "tip_wrench", "rod": "rod", "moment": vector(force * length)},
        {
            "name": "hook",
            "kind": "point_wrench",
            "rod": "rod",
            "at": float(rng.uniform(0.1, 0.9)),
            "force": vector(2 * force),
        },
        {
            "name": "wind",
            "kind": "distributed_wrench",
            "rod": "rod",
            "force": [vector(force / length) for _ in range(3)],
            "frame": frame,
        },
    ]
