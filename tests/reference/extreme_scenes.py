"""Seeded scenes of one rod at the ends of what is legal: every size is drawn over up to twelve decades.

What matters for an equilibrium is without unit, and drawn so: forces F L²/EI from 1e-9 to 1e3, axial stiffness
EA L²/EI from 1e-2 to 1e10, torsion over bending from 1e-3 to 1e3, unloaded curvature κL from 1e-6 to 30. Lengths and
stiffnesses in SI units go from 1e-6 to 1e6. Any subset of strains, either basis, any support, any discretisation.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from tests.reference.random_scenes import directed, vector

from .rods import STRAINS

Table = dict[str, Any]


def extreme_scene(seed: int) -> Table:
    """A legal scene as `tomllib` would read it; the same seed gives the same scene."""
    rng = np.random.default_rng([seed, 7])
    length, bending = _decades(rng, -6, 6), _decades(rng, -6, 6)
    strain = _strain(rng)
    rod: Table = {
        "name": "rod",
        "length": length,
        "strain": strain,
        "stiffness": _stiffness(rng, strain, bending, length),
        "linear_density": _decades(rng, -6, 6),
        "basis": str(rng.choice(["legendre", "chebyshev"])),
        "base": {"position": vector(rng, length), "quaternion": _quaternion(rng)},
    }
    if rng.random() < 0.4:
        rod["intrinsic"] = _intrinsic(rng, length)
    tables: Table = {"schema": 1, "title": f"extreme scene {seed}", "accuracy": _accuracy(rng, strain), "rods": [rod]}
    tables["loads"] = _loads(rng, length, bending, rod["linear_density"])
    if rng.random() < 0.25:
        tables["supports"] = [_support(rng, length, rod["base"]["position"])]
    return tables


def _strain(rng: np.random.Generator) -> str | list[str]:
    if rng.random() < 0.5:
        return str(rng.choice(["planar", "kirchhoff", "reissner"]))
    chosen = rng.random(6) < 0.5
    chosen[rng.integers(6)] = True
    return [name for name, taken in zip(STRAINS, chosen, strict=True) if taken]


def _stiffness(rng: np.random.Generator, strain: str | list[str], bending: float, length: float) -> Table:
    sizes = {
        "bending_x": bending,
        "bending_y": bending * _decades(rng, -1, 1),
        "torsion": bending * _decades(rng, -3, 3),
    }
    for name in STRAINS[3:]:
        sizes[name] = bending / length**2 * _decades(rng, -2, 10)
    named = {"planar": STRAINS[1:2], "kirchhoff": STRAINS[:3], "reissner": STRAINS}
    admitted = named[strain] if isinstance(strain, str) else strain
    return {name: _tapered(rng, sizes[name]) for name in admitted}


def _tapered(rng: np.random.Generator, size: float) -> float | list[float]:
    return [size, size * float(rng.uniform(0.1, 1.0))] if rng.random() < 0.2 else size


def _intrinsic(rng: np.random.Generator, length: float) -> Table:
    curvature = np.array(directed(rng, _decades(rng, -6, np.log10(30)) / length))
    if rng.random() < 0.3:
        return {"curvature": [[float(c), float(c * rng.normal())] for c in curvature]}
    return {"curvature": curvature.tolist()}


def _accuracy(rng: np.random.Generator, strain: str | list[str]) -> Table:
    if rng.random() < 0.4:
        return {"tolerance": _decades(rng, -9, -2)}
    accuracy: Table = {"modes": int(rng.integers(1, 13)), "nodes": int(rng.integers(2, 41))}
    if rng.random() < 0.5:
        accuracy["rotation"] = str(rng.choice(["magnus4", "magnus6", "magnus8"]))
    return accuracy


def _loads(rng: np.random.Generator, length: float, bending: float, density: float) -> list[Table]:
    force, moment = bending / length**2, bending / length

    def wrench(kind: str, divisor: float) -> Table:
        sizes = {
            "force": directed(rng, force / divisor * _decades(rng, -9, 3)),
            "moment": directed(rng, moment / divisor * _decades(rng, -9, 1.5)) if rng.random() < 0.4 else [0.0] * 3,
        }
        return {"name": kind, "kind": kind, "rod": "rod", "frame": str(rng.choice(["world", "body"])), **sizes}

    loads = [wrench("tip_wrench", 1.0)] if rng.random() < 0.8 else []
    if rng.random() < 0.25:
        loads.append({**wrench("point_wrench", 1.0), "at": float(rng.uniform(0.01, 0.99))})
    if rng.random() < 0.25:
        loads.append(wrench("distributed_wrench", length))
    if rng.random() < 0.3:
        weight = force / (density * length) * _decades(rng, -9, 2.5)
        loads.append({"name": "weight", "kind": "gravity", "acceleration": directed(rng, weight)})
    return loads


def _support(rng: np.random.Generator, length: float, base: list[float]) -> Table:
    """Within reach more often than not."""
    place = np.array(base) + directed(rng, length * float(rng.uniform(0.0, 1.1)))
    support: Table = {"rod": "rod", "kind": str(rng.choice(["clamped", "pinned"])), "position": place.tolist()}
    return {**support, "quaternion": _quaternion(rng)} if support["kind"] == "clamped" else support


def _decades(rng: np.random.Generator, low: float, high: float) -> float:
    """A number whose decimal logarithm is spread evenly."""
    return float(10 ** rng.uniform(low, high))


def _quaternion(rng: np.random.Generator) -> list[float]:
    return _directed_unit(rng, 4)


def _directed_unit(rng: np.random.Generator, size: int) -> list[float]:
    vector = rng.normal(size=size)
    return [float(v) for v in vector / np.linalg.norm(vector)]


def quick_scene(seed: int) -> dict[str, Any]:
    """An extreme scene on a coarse discretisation, so that some dozen take seconds."""
    tables = extreme_scene(seed)
    rng = np.random.default_rng(seed)
    accuracy = {"modes": int(rng.integers(1, 4)), "nodes": int(rng.integers(2, 13))}
    if len(tables["loads"]) > 1:
        tables["loads"] = tables["loads"][:1]
    return {**tables, "accuracy": accuracy}


def fuzz_scene(seed: int) -> dict[str, Any]:
    """One in ten extreme scenes to a tolerance, the others on a coarse discretisation: the former take seconds."""
    return quick_scene(seed) if seed % 10 else extreme_scene(seed)
