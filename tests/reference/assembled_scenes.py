"""Seeded assemblies without supports: rods in series, trees, platforms and loops, with tendons or without.

Rods are about 1 long and of bending stiffness about 1, so that forces count in EI/L²: up to 10 of them act.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from .random_scenes import Table, between, directed, vector

KINDS = ("series", "platform", "tree", "loop")

STRAINS = ("kirchhoff", "reissner")

LARGEST_FORCE, LARGEST_MOMENT = 10.0, 3.0
"""Of what acts on tips and bodies."""


def assembled_scene(seed: int, *, tendons: bool = False) -> Table:
    """A legal scene as `tomllib` would read it; the same seed gives the same scene."""
    rng = np.random.default_rng([seed, 23, int(tendons)])
    kind = KINDS[seed % len(KINDS)]
    makers = {"series": _series, "platform": _platform, "tree": _tree, "loop": _loop}
    tables = makers[kind](rng)
    tables = {"schema": 1, "title": f"assembled scene {seed}, {kind}", **tables}
    tables["loads"].append({"name": "weight", "kind": "gravity", "acceleration": directed(rng, between(rng, 0.1, 5.0))})
    if tendons:
        tables["actuators"] = _tendons(rng, [rod["name"] for rod in tables["rods"]])
    return tables


def _series(rng: np.random.Generator) -> Table:
    """Two or three rods, each on the tip of the one before, and a wrench at the end."""
    count = int(rng.integers(2, 4))
    bases: list[Table] = [{}]
    bases += [{"rod": f"rod_{i - 1}", "tangent": _leaning(rng)} for i in range(1, count)]
    rods = [_rod(rng, f"rod_{i}", 1.0 / count, base) for i, base in enumerate(bases)]
    return {"rods": rods, "loads": [_tip_wrench(rng, rods[-1]["name"], LARGEST_FORCE)]}


def _tree(rng: np.random.Generator) -> Table:
    """A stem that carries two branches, a wrench at the tip of each."""
    stem = _rod(rng, "stem", 0.5, {})
    names = ("left", "right")
    branches = [_rod(rng, name, 0.6, {"rod": "stem", "tangent": _leaning(rng)}) for name in names]
    return {"rods": [stem, *branches], "loads": [_tip_wrench(rng, name, 0.4 * LARGEST_FORCE) for name in names]}


def _platform(rng: np.random.Generator) -> Table:
    """Two to four legs under one plate."""
    count = int(rng.integers(2, 5))
    angles = 2 * np.pi * np.arange(count) / count
    rods, joints = [], []
    for i, angle in enumerate(angles):
        place = np.array([np.cos(angle), np.sin(angle), 0.0])
        rods.append(_rod(rng, f"rod_{i}", float(rng.uniform(0.9, 1.1)), {"position": [float(v) for v in 0.2 * place]}))
        held = place * float(rng.uniform(0.1, 0.25))
        joints.append(_joint(rng, f"rod_{i}", held))
    return _with_plate(rng, rods, joints)


def _loop(rng: np.random.Generator) -> Table:
    """A rod and two others in series, closed by a plate."""
    rods = [
        _rod(rng, "whole", 1.0, {"position": [-0.15, 0.0, 0.0]}),
        _rod(rng, "lower", 0.5, {"position": [0.15, 0.0, 0.0]}),
        _rod(rng, "upper", float(rng.uniform(0.45, 0.6)), {"rod": "lower", "tangent": _leaning(rng)}),
    ]
    joints = [_joint(rng, "whole", np.array([-0.1, 0.0, 0.0])), _joint(rng, "upper", np.array([0.1, 0.0, 0.0]))]
    return _with_plate(rng, rods, joints)


def _with_plate(rng: np.random.Generator, rods: list[Table], joints: list[Table]) -> Table:
    # One joint that keeps the orientation, so that the plate never turns freely.
    joints[0]["kind"] = "fixed"
    plate = {"name": "plate", "mass": float(rng.uniform(0.0, 0.5))}
    push = {
        "name": "push",
        "kind": "body_wrench",
        "body": "plate",
        "force": directed(rng, between(rng, 0.1, LARGEST_FORCE)),
        "moment": directed(rng, between(rng, 0.1, LARGEST_MOMENT)),
    }
    return {"rods": rods, "bodies": [plate], "joints": joints, "loads": [push]}


def _rod(rng: np.random.Generator, name: str, length: float, base: Table) -> Table:
    strain = str(rng.choice(STRAINS))
    axial = between(rng, 100.0, 3000.0)
    stiffness: dict[str, Any] = {
        "bending_x": float(rng.uniform(0.7, 1.5)),
        "bending_y": float(rng.uniform(0.7, 1.5)),
        "torsion": float(rng.uniform(0.5, 1.2)),
    }
    if strain == "reissner":
        stiffness |= {"shear_x": 0.4 * axial, "shear_y": 0.4 * axial, "extension": axial}
    rod: Table = {"name": name, "length": length, "strain": strain, "stiffness": stiffness, "linear_density": 0.5}
    if rng.random() < 0.3:
        rod["intrinsic"] = {"curvature": vector(rng, 0.7)}
    return {**rod, "base": base}


def _leaning(rng: np.random.Generator) -> list[float]:
    """A direction within a radian or so of the axis of the carrying rod."""
    return [float(v) for v in np.array([0.0, 0.0, 1.0]) + 0.4 * rng.normal(size=3)]


def _joint(rng: np.random.Generator, rod: str, place: Any) -> Table:
    kind = str(rng.choice(["fixed", "spherical"]))
    return {"body": "plate", "rod": rod, "kind": kind, "position": [float(v) for v in place]}


def _tip_wrench(rng: np.random.Generator, rod: str, largest: float) -> Table:
    return {
        "name": f"push_{rod}",
        "kind": "tip_wrench",
        "rod": rod,
        "frame": str(rng.choice(["world", "body"])),
        "force": directed(rng, between(rng, 0.1, largest)),
        "moment": directed(rng, between(rng, 0.1, LARGEST_MOMENT)),
    }


def _tendons(rng: np.random.Generator, rods: list[str]) -> list[Table]:
    """One or two tendons on each rod: parallel, converging or in up to two turns."""
    tendons = []
    for rod in rods:
        for i in range(int(rng.integers(1, 3))):
            radius = between(rng, 0.01, 0.1)
            tension = between(rng, 0.1, min(10.0, 1.0 / radius))
            course: Table
            if rng.random() < 0.4:
                course = {
                    "helix": {"radius": radius, "turns": float(rng.uniform(-2, 2)), "phase": float(rng.uniform(0, 6))}
                }
            else:
                degree = int(rng.integers(0, 4))
                course = {"offset": [[float(v) for v in radius * rng.normal(size=degree + 1)] for _ in range(2)]}
            tendons.append({"name": f"cable_{rod}_{i}", "kind": "tendon", "rod": rod, "tension": tension, **course})
    return tendons
