"""Seeded scenes of one rod that is held at both ends, most of them with several equilibria.

The tip is put anywhere within reach and turned in any way, so that the rod is pushed together, bent over or twisted.
In one scene of five it stays on the axis of the straight rod, in one of five in a plane of symmetry: there the way
from the straight rod leads through bifurcations. Loads are drawn relative to the softest bending stiffness EI: forces
up to 30 EI/L².
"""

from __future__ import annotations

import numpy as np

from .random_scenes import Table, between, directed

STRAINS: tuple[str | list[str], ...] = (
    "planar",
    "kirchhoff",
    "reissner",
    ["bending_x", "bending_y", "torsion", "extension"],
)
"""Strains of the rods that are drawn; kirchhoff twice as often as each of the others."""

SHARES = (0.2, 0.4, 0.2, 0.2)
"""Shares of these."""


def held_scene(seed: int) -> Table:
    """A legal scene as `tomllib` would read it; the same seed gives the same scene."""
    rng = np.random.default_rng([seed, 13])
    length = between(rng, 0.1, 10.0)
    strain = STRAINS[rng.choice(len(STRAINS), p=SHARES)]
    bending = between(rng, 1e-3, 1e3)
    sizes = {
        "bending_x": bending * float(rng.choice([1.0, rng.uniform(1.0, 4.0)])),
        "bending_y": bending,
        "torsion": bending * between(rng, 0.2, 3.0),
        "shear_x": bending / length**2 * between(rng, 100.0, 1e5),
        "shear_y": bending / length**2 * between(rng, 100.0, 1e5),
        "extension": bending / length**2 * between(rng, 100.0, 1e5),
    }
    named = {"planar": ["bending_y"], "kirchhoff": list(sizes)[:3], "reissner": list(sizes)}
    admitted = named[strain] if isinstance(strain, str) else strain
    stiffness = {name: sizes[name] for name in admitted}
    rod: Table = {"name": "rod", "length": length, "strain": strain, "stiffness": stiffness}
    symmetry = str(rng.choice(["none", "plane", "axis"], p=[0.6, 0.2, 0.2]))
    if strain == "planar" and symmetry == "none":
        symmetry = "plane"
    if symmetry != "axis" and rng.random() < 0.4:
        turned = _in_plane(directed(rng, between(rng, 0.5, 6.0) / length), symmetry)
        # In a plane of symmetry a rod bends about its normal alone.
        rod["intrinsic"] = {"curvature": [0.0, float(np.linalg.norm(turned)), 0.0] if symmetry == "plane" else turned}
    support = _support(rng, length, symmetry)
    loads = _loads(rng, bending / length**2, symmetry)
    return {"schema": 1, "title": f"held rod {seed}", "rods": [rod], "supports": [support], "loads": loads}


def _in_plane(vector: list[float], symmetry: str) -> list[float]:
    """A vector as the symmetry wants it: in the plane x–z, along z, or as it is."""
    norm = float(np.linalg.norm(vector))
    kept = np.array(vector)
    if symmetry != "none":
        kept[1] = 0.0
    if symmetry == "axis":
        kept[0] = 0.0
    return [float(part) for part in norm * kept / np.linalg.norm(kept)]


def _support(rng: np.random.Generator, length: float, symmetry: str) -> Table:
    """A clamp more often than a pin, within reach of the rod, which leaves the origin along z."""
    kind = "clamped" if rng.random() < 0.75 else "pinned"
    place = _in_plane(directed(rng, length * float(rng.uniform(0.1, 0.95))), symmetry)
    support: Table = {"rod": "rod", "kind": kind, "position": place}
    if symmetry == "axis":
        # Pushed together, not turned over.
        support["position"] = [0.0, 0.0, abs(place[2])]
    if kind == "clamped":
        angle = float(rng.uniform(-np.pi, np.pi))
        axis = {"none": directed(rng, 1.0), "plane": [0.0, 1.0, 0.0], "axis": [0.0, 0.0, 0.0]}[symmetry]
        if symmetry == "axis":
            angle = 0.0
        turned = np.sin(angle / 2) * np.array(axis)
        support["quaternion"] = [float(np.cos(angle / 2)), *(float(part) for part in turned)]
    return support


def _loads(rng: np.random.Generator, force: float, symmetry: str) -> list[Table]:
    """A dead force at an inner section with some luck."""
    if rng.random() < 0.6:
        return []
    components = _in_plane(directed(rng, force * between(rng, 0.1, 30.0)), symmetry)
    at = float(rng.uniform(0.2, 0.8))
    push = {"name": "push", "kind": "point_wrench", "rod": "rod", "frame": "world", "at": at}
    return [{**push, "force": components}]
