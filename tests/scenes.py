"""Scenes written for the tests."""

from __future__ import annotations

from typing import Any

from cosserat_casadi import Scene, scene_from_dict

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
