"""What the bench measures errors against, beside shooting."""

from __future__ import annotations

from pathlib import Path

import pytest

from cosserat_casadi import Scene, read_scene, solve
from tests.conftest import ROOT
from tests.families import mostly_slow
from tests.fine_reference import Errors, distance, find_reference
from tests.scenes import HOOK, WEIGHT, WIND, push, scene
from tests.shooting_near import shoot

FOLLOWER_WIND = {**WIND, "name": "jet", "frame": "body", "moment": [0.0, [0.02, 0.01], 0.03]}
HELD = {"rod": "rod", "position": [0.2, 0.15, 0.6]}

UNKNOWN = (
    "[[actuators]]",
    "[[bodies]]",
    "base = { rod",
    "free = true",
    'kind = "magnet"',
    'kind = "foundation"',
    'kind = "flow"',
    "[[obstacles]]",
    "[[tubes]]",
    "[[disks]]",
    'law = "',
)
"""Words of scenes that shooting does not know."""


def is_plain(text: str) -> bool:
    """Whether shooting knows a scene: one rod, without what it has no equations for."""
    return text.count("[[rods]]") == 1 and not any(word in text for word in UNKNOWN)


PLAIN = [path for path in sorted((ROOT / "examples").glob("*.toml")) if is_plain(path.read_text())]

QUICK = [path for path in PLAIN if path.stem in ("nitinol_wire", "follower_reissner")]


def distance_to_shooting(wanted: Scene) -> Errors:
    """Of the reference."""
    truth = shoot(solve(wanted))
    reference = find_reference(wanted)
    assert reference.method.startswith("a far finer discretisation")
    return distance(dict.fromkeys(reference.rods, truth), reference.rods)


@pytest.mark.parametrize("path", mostly_slow(PLAIN, quick=QUICK), ids=lambda path: path.stem)
def test_reference_vs_shooting(path: Path) -> None:
    found = distance_to_shooting(read_scene(path))
    assert found.pose < 1e-11
    assert found.wrench < 1e-11


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["clamped", "pinned"])
def test_reference_of_a_held_rod_with_every_load_vs_shooting(kind: str) -> None:
    pose = {"quaternion": [1.0, 0.0, 0.0, 0.0]} if kind == "clamped" else {}
    supports = [{**HELD, "kind": kind, **pose}]
    found = distance_to_shooting(scene(WEIGHT, HOOK, FOLLOWER_WIND, strain="reissner", supports=supports))
    assert found.pose < 1e-10


@pytest.mark.slow
def test_reference_of_a_bent_rod_vs_shooting() -> None:
    pushed = push(frame="body", moment=[0.1, -0.2, 0.1])
    found = distance_to_shooting(scene(pushed, WEIGHT, FOLLOWER_WIND, HOOK, strain="reissner"))
    assert found.pose < 1e-11
    assert found.wrench < 1e-10
