"""Seeded scenes of one rod, legal in the scene format: every strain model, section, taper, pre-curvature and load.

Loads are drawn relative to the softest bending stiffness EI: forces up to 10 EI/L², moments up to 5 EI/L.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from .rods import STRAINS, THEORIES

Table = dict[str, Any]

SUBSETS: tuple[list[str], ...] = (
    ["bending_x", "torsion"],
    ["bending_y", "extension"],
    ["bending_x", "bending_y"],
    ["bending_x", "bending_y", "extension"],
    ["bending_x", "bending_y", "torsion", "extension"],
    ["bending_y", "shear_x"],
)


def random_scene(seed: int) -> Table:
    """A legal scene as `tomllib` would read it; the same seed gives the same scene."""
    rng = np.random.default_rng(seed)
    length = between(rng, 0.1, 10.0)
    rod: Table = {"name": "rod", "length": length, "strain": _strain(rng)}
    stiffness, density = _direct(rng, rod) if rng.random() < 0.4 else _material(rng, rod)
    if rng.random() < 0.4:
        rod["intrinsic"] = {"curvature": _curvature(rng, length)}
    rod["base"] = _base(rng, length)
    loads = _loads(rng, length, stiffness, density)
    return {"schema": 1, "title": f"random scene {seed}", "rods": [rod], "loads": loads}


# The rod


def _strain(rng: np.random.Generator) -> str | list[str]:
    if rng.random() < 0.3:
        return SUBSETS[rng.integers(len(SUBSETS))]
    return str(rng.choice(list(THEORIES)))


def _material(rng: np.random.Generator, rod: Table) -> tuple[float, float]:
    """Material and section; returns the softest bending stiffness at the base and the mass per length there."""
    young, density = between(rng, 1e6, 2e11), between(rng, 500.0, 8000.0)
    rod["material"] = {"youngs_modulus": young, "density": density}
    if rng.random() < 0.5:
        rod["material"]["poisson_ratio"] = float(rng.uniform(0.0, 0.5))
    else:
        rod["material"]["shear_modulus"] = young * float(rng.uniform(0.3, 0.5))
    radius = rod["length"] * between(rng, 3e-3, 5e-2)
    rod["section"], second, area = _section(rng, radius)
    return young * second, density * area


def _section(rng: np.random.Generator, radius: float) -> tuple[Table, float, float]:
    """A section with its smaller second moment of area and its area at the base."""
    shape = str(rng.choice(["circle", "annulus", "rectangle"]))
    if shape == "circle":
        section: Table = {"radius": _size(rng, radius)}
        second, area = np.pi / 4 * radius**4, np.pi * radius**2
    elif shape == "annulus":
        bore = float(rng.uniform(0.2, 0.6)) * radius
        section = {"outer_radius": _size(rng, radius), "inner_radius": [bore, 0.6 * bore]}
        second, area = np.pi / 4 * (radius**4 - bore**4), np.pi * (radius**2 - bore**2)
    else:
        height = 2 * radius * float(rng.uniform(0.5, 2.0))
        section = {"width": _size(rng, 2 * radius), "height": _size(rng, height)}
        second, area = 2 * radius * height * min(2 * radius, height) ** 2 / 12, 2 * radius * height
    if rng.random() < 0.3:
        section["shear_correction"] = float(rng.uniform(0.8, 1.0))
    return {"shape": shape, **section}, float(second), float(area)


def _direct(rng: np.random.Generator, rod: Table) -> tuple[float, float]:
    """Stiffnesses and a mass per length; returns the softer bending stiffness and the mass per length at the base."""
    length, scale, density = rod["length"], between(rng, 1e-3, 1e4), between(rng, 1e-3, 10.0)
    bending = [scale, scale * float(rng.uniform(0.7, 3.0))]
    torsion = scale * float(rng.uniform(0.6, 1.5))
    axial = [scale / length**2 * between(rng, 20.0, 1e4) for _ in range(3)]
    sizes = [*bending, torsion, *axial]
    rod["stiffness"] = {name: _size(rng, size) for name, size in zip(STRAINS, sizes, strict=True)}
    rod["linear_density"] = _size(rng, density)
    return min(bending), density


def _size(rng: np.random.Generator, size: float) -> float | list[float]:
    """The size, or with some luck a taper from it."""
    return [size, size * float(rng.uniform(0.7, 1.0))] if rng.random() < 0.3 else size


def _curvature(rng: np.random.Generator, length: float) -> list[Any]:
    """Constant or linear, turning by up to about two radians."""
    if rng.random() < 0.5:
        return vector(rng, 1.0 / length)
    return [[float(v) for v in rng.normal(size=2) / length] for _ in range(3)]


def _base(rng: np.random.Generator, length: float) -> Table:
    position = vector(rng, length)
    if rng.random() < 0.5:
        return {"position": position, "tangent": vector(rng, 1.0)}
    quaternion = rng.normal(size=4)
    return {"position": position, "quaternion": [float(v) for v in quaternion / np.linalg.norm(quaternion)]}


# The loads


def _loads(rng: np.random.Generator, length: float, stiffness: float, density: float) -> list[Table]:
    """A tip wrench always, the others with some luck."""
    force, moment = stiffness / length**2, stiffness / length
    tip = {
        "name": "tip",
        "kind": "tip_wrench",
        "force": directed(rng, force * between(rng, 0.1, 10.0)),
        "moment": directed(rng, moment * between(rng, 0.1, 5.0)) if rng.random() < 0.3 else [0.0, 0.0, 0.0],
    }
    hook = {
        "name": "hook",
        "kind": "point_wrench",
        "at": float(rng.uniform(0.1, 0.9)),
        "force": directed(rng, 2 * force),
        "moment": directed(rng, moment),
    }
    wind = {
        "name": "wind",
        "kind": "distributed_wrench",
        "force": [vector(rng, force / length) for _ in range(3)],
        "moment": vector(rng, 0.3 * moment / length),
    }
    wrenches = [load for load, chance in ((tip, 1.0), (hook, 0.3), (wind, 0.4)) if rng.random() < chance]
    loads = [{**load, "rod": "rod", "frame": str(rng.choice(["world", "body"]))} for load in wrenches]
    if rng.random() < 0.5:
        weight = force / (density * length) * between(rng, 0.1, 5.0)
        loads.append({"name": "weight", "kind": "gravity", "acceleration": directed(rng, weight)})
    return loads


def between(rng: np.random.Generator, low: float, high: float) -> float:
    """A number whose logarithm is spread evenly."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def vector(rng: np.random.Generator, size: float) -> list[float]:
    return [float(v) for v in size * rng.normal(size=3)]


def directed(rng: np.random.Generator, norm: float) -> list[float]:
    """A vector of this norm in a random direction."""
    vector = rng.normal(size=3)
    return [float(v) for v in norm * vector / np.linalg.norm(vector)]
