"""Random scenes of one rod that the dial is judged on: rods, rods of matter, and robots."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import numpy as np

from cosserat_casadi import Scene, scene_from_dict
from tests.reference.material_scenes import make_of_matter
from tests.reference.random_scenes import random_scene
from tests.reference.robot_scenes import on_a_hub, robot_scene
from tests.reference.rods import rod_of

ROD = "rod"


def tables(seed: int) -> dict[str, Any]:
    """A random scene; every second one with twice the tip force, up to 20 EI/L²."""
    scene = random_scene(seed)
    for load in scene["loads"]:
        if seed % 2 and load["kind"] == "tip_wrench":
            load["force"] = [2 * v for v in load["force"]]
    return scene


def tables_of_matter(seed: int) -> dict[str, Any]:
    """The same scene with a law of its material, a chamber and a muscle, each with some luck."""
    scene = tables(seed)
    compliance = rod_of(scene).compliance(0.0)[:3]
    make_of_matter(np.random.default_rng([seed, 17]), scene, 1 / float(compliance.max()) if compliance.any() else 1.0)
    return scene


def robots(seed: int) -> dict[str, Any]:
    """Robots, of which every third has its joint between the world and a body."""
    scene = robot_scene(seed)
    return on_a_hub(scene) if seed % 3 == 0 and "joints" in scene else scene


DRAWN = {"rods": tables, "matter": tables_of_matter, "robots": robots}
"""What is drawn; robots have disks, straight tendons, joints, stops and drives."""


def scene_at(seed: int, tolerance: float, what: str = "rods") -> Scene:
    return scene_from_dict({**DRAWN[what](seed), "accuracy": {"tolerance": tolerance}})
