"""Random scenes of one rod that the dial is judged on."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from cosserat_casadi import Scene, scene_from_dict
from tests.reference.random_scenes import random_scene

ROD = "rod"


def tables(seed: int) -> dict[str, Any]:
    """A random scene; every second one with twice the tip force, up to 20 EI/L²."""
    scene = random_scene(seed)
    for load in scene["loads"]:
        if seed % 2 and load["kind"] == "tip_wrench":
            load["force"] = [2 * v for v in load["force"]]
    return scene


def scene_at(seed: int, tolerance: float) -> Scene:
    return scene_from_dict({**tables(seed), "accuracy": {"tolerance": tolerance}})
