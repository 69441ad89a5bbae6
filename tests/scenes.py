"""Scenes written for the tests."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from cosserat_casadi import Scene, scene_from_dict
from cosserat_casadi.maths.typing import FloatArray

STIFFNESS = {"bending_x": 1.0, "bending_y": 1.4, "torsion": 0.7, "shear_x": 40.0, "shear_y": 60.0, "extension": 90.0}


def rod(strain: str | list[str] = "kirchhoff", **changes: Any) -> dict[str, Any]:
    """A rod of length 0.8 m with unequal stiffnesses."""
    names = {"planar": ["bending_y"], "kirchhoff": ["bending_x", "bending_y", "torsion"], "reissner": list(STIFFNESS)}
    admitted = names[strain] if isinstance(strain, str) else strain
    plain = {
        "name": "rod",
        "length": 0.8,
        "strain": strain,
        "stiffness": {name: STIFFNESS[name] for name in admitted},
        "linear_density": 0.9,
    }
    return {**plain, **changes}


def push(**changes: Any) -> dict[str, Any]:
    """A dead force at the tip."""
    return {"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0.9, 0.5, -0.4], **changes}


WEIGHT = {"name": "weight", "kind": "gravity", "acceleration": [0.3, -0.2, -2.0]}
WIND = {"name": "wind", "kind": "distributed_wrench", "rod": "rod", "force": [[0.4, 0.3], 0.2, 0.0]}
HOOK = {"name": "hook", "kind": "point_wrench", "rod": "rod", "at": 0.4, "force": [0.3, -0.6, 0.2]}


def scene(*loads: dict[str, Any], strain: str | list[str] = "kirchhoff", **changes: Any) -> Scene:
    """A scene of one rod with these loads; ``rods``, ``accuracy``, ``supports`` and ``inputs`` may be given."""
    return scene_from_dict({"schema": 1, "rods": [rod(strain)], "loads": list(loads), **changes})


def markers(sections: Sequence[float], sigma: float) -> list[dict[str, Any]]:
    """Measured positions of sections of a rod, from the columns x0, y0, z0, x1, ... of the file "shapes"."""
    return [
        {
            "quantity": "position",
            "name": f"marker {k}",
            "file": "shapes",
            "rod": "rod",
            "at": at,
            "columns": [f"{axis}{k}" for axis in "xyz"],
            "sigma": sigma,
        }
        for k, at in enumerate(sections)
    ]


CABLE_OFFSET = 0.006
"""Distance of the three cables from the axis, m."""


def three_cables() -> Scene:
    """A rod that three cables of given lengths bend: 0.2 mm move its strains by 0.047, its tensions by 1.8 units."""
    angles = [2 * np.pi * k / 3 for k in range(3)]
    cables = [
        {
            "name": f"cable_{k}",
            "kind": "tendon",
            "rod": "rod",
            "length": 0.8,
            "offset": [CABLE_OFFSET * np.cos(angle), CABLE_OFFSET * np.sin(angle)],
        }
        for k, angle in enumerate(angles)
    ]
    load = push(force=[0.05, 0.02, 0.0])
    lengths = [f"cable_{k}.length" for k in range(3)]
    return scene(load, strain="reissner", actuators=cables, inputs=lengths)


def cable_lengths(step: float, turns: int) -> FloatArray:
    """Lengths that go round a circle, no cable by more than a step in a turn, shape (turns, 3)."""
    amplitude = 0.003
    phase = np.arange(turns)[:, None] * step / amplitude + 2 * np.pi * np.arange(3) / 3
    return 0.8 - 0.001 + amplitude * np.cos(phase)
