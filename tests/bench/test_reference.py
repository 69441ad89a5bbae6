"""The bench's own shooting against the finest discretisation, and what is done where it cannot shoot."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import read_scene
from cosserat_casadi.bench import reference as module
from cosserat_casadi.bench.reference import find_reference
from cosserat_casadi.bench.shooting import RodState, ShootingError
from cosserat_casadi.errors import NoReferenceError
from tests.conftest import ROOT
from tests.families import mostly_slow
from tests.scenes import HOOK, WEIGHT, WIND, push, rod, scene

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
)
"""Words of scenes that the bench cannot shoot."""

PLAIN = [
    path for path in sorted((ROOT / "examples").glob("*.toml")) if not any(word in path.read_text() for word in UNKNOWN)
]

QUICK = [path for path in PLAIN if path.stem in ("nitinol_wire", "follower_reissner")]


@pytest.mark.parametrize("path", mostly_slow(PLAIN, quick=QUICK), ids=lambda path: path.stem)
def test_shooting_vs_finest_discretisation(path: Path) -> None:
    found = find_reference(read_scene(path))
    assert found.method.startswith("shooting")
    assert found.distance is not None
    assert found.distance < 1e-11
    assert found.errors(found.start).wrench < 1e-11


@pytest.mark.parametrize("kind", mostly_slow(["clamped", "pinned"], quick=["pinned"]))
def test_shooting_of_a_held_rod_with_every_load(kind: str) -> None:
    pose = {"quaternion": [1.0, 0.0, 0.0, 0.0]} if kind == "clamped" else {}
    found = find_reference(
        scene(WEIGHT, HOOK, FOLLOWER_WIND, strain="reissner", supports=[{**HELD, "kind": kind, **pose}])
    )
    assert found.method.startswith("shooting")
    assert found.distance is not None
    assert found.distance < 1e-10


def test_shooting_of_a_bent_rod_vs_the_oracle_of_the_tests() -> None:
    from tests.reference.shooting import solve_by_shooting

    wanted = scene(push(frame="body", moment=[0.1, -0.2, 0.1]), WEIGHT, FOLLOWER_WIND, HOOK, strain="reissner")
    tables = wanted.model_dump(mode="json", by_alias=True, exclude_unset=True)
    oracle = solve_by_shooting(tables)
    found = find_reference(wanted).rods["rod"]
    assert_allclose(found.position[-1], oracle.tip_position, rtol=0, atol=1e-11)
    assert_allclose(found.rotation[-1], oracle.tip_rotation, rtol=0, atol=1e-11)
    assert_allclose(found.base_wrench[:3], oracle.base_force, rtol=0, atol=1e-10)
    assert_allclose(found.base_wrench[3:], oracle.base_moment, rtol=0, atol=1e-10)


def test_where_shooting_fails_the_finest_discretisation_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> RodState:
        raise ShootingError("shooting does not know tendons")

    monkeypatch.setattr(module, "shoot", refuse)
    found = find_reference(scene(push(), strain="planar", rods=[rod("planar")]))
    assert found.method.startswith("the finest discretisation")
    assert "tendons" in found.method
    assert found.distance is None


def test_two_references_that_disagree_are_not_believed(monkeypatch: pytest.MonkeyPatch) -> None:
    def elsewhere(*_: object) -> RodState:
        return RodState(0.8, np.zeros((1, 3)), np.eye(3)[None], np.ones(6))

    monkeypatch.setattr(module, "shoot", elsewhere)
    with pytest.raises(NoReferenceError, match="apart"):
        find_reference(scene(push(), rods=[rod("planar")]))
