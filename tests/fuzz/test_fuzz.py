"""A small part of the fuzz: every scene ends in a true outcome. `make fuzz` runs the rest."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from cosserat_casadi import Scene, SceneError, parse_scene, scene_from_dict, solve
from cosserat_casadi.numerics.outcome import Outcome
from tests.catalogue.cases import torsion_ratio
from tests.catalogue.checks import solved
from tests.conftest import ROOT
from tests.families import mostly_slow
from tests.fuzz.verdict import evaluate, robot_verdict, verdict
from tests.reference.extreme_scenes import extreme_scene, quick_scene
from tests.reference.robot_scenes import joint_faults, robot_scene

TEXT = (ROOT / "examples" / "planar_strip.toml").read_text()
WORDS = sorted({word for word in TEXT.replace("=", " ").replace(",", " ").split() if not word.startswith("#")})
JOINTED = 2
"""Seed of a robot on a joint without stops."""
INFLATED = 14
"""Seed of a robot of rubber with a chamber."""

SPOILT = [
    "0",
    "-1",
    "1e308",
    "-1e-320",
    "nan",
    "inf",
    "true",
    '"x"',
    "[]",
    "{}",
    "1e-12",
    "[1, 2, 3]",
    "zzz",
    "\n",
    "é",
]


@pytest.mark.parametrize("first", [10, *[pytest.param(first, marks=pytest.mark.slow) for first in (0, 20, 30)]])
def test_extreme_scenes_end_truly(first: int) -> None:
    found = {seed: verdict(quick_scene(seed)) for seed in range(first, first + 10)}
    assert {seed: v.faults for seed, v in found.items() if v.faults} == {}
    assert sum(v.outcome == "converged" for v in found.values()) >= 4


@pytest.mark.parametrize("seed", mostly_slow(range(20), quick=[INFLATED]))
def test_robots_end_truly(seed: int) -> None:
    """Joints, disks, tendons, laws of materials, chambers and muscles, as the clamped rods that they come to."""
    assert robot_verdict(seed).faults == ()


def test_a_joint_out_of_balance_is_seen() -> None:
    tables = robot_scene(JOINTED)
    solution = solve(scene_from_dict(tables))
    assert joint_faults(tables, solution, 1e-8) == []
    (joint,) = tables["joints"]
    softer = {**tables, "joints": [{**joint, "stiffness": 0.999 * joint["stiffness"]}]}
    assert joint_faults(softer, solution, 1e-8) != []


def test_another_law_and_another_pressure_are_seen() -> None:
    tables = robot_scene(INFLATED)
    solution = solve(scene_from_dict(tables))
    assert evaluate(tables, solution).weak < 1e-8
    (rod,) = tables["rods"]
    stiffer = {**rod, "material": {**rod["material"], "c10": 1.1 * rod["material"]["c10"]}}
    assert evaluate({**tables, "rods": [stiffer]}, solution).weak > 1e-4
    (chamber,) = tables["actuators"]
    wider = {**chamber, "pressure": 1.1 * chamber["pressure"]}
    assert evaluate({**tables, "actuators": [wider]}, solution).weak > 1e-4


@pytest.mark.slow
def test_reference_whose_coarser_models_overflow_is_refined() -> None:
    """Dropping two of its five modes leads nowhere: that is no small error, and there is a finer rung."""
    found = verdict(extreme_scene(73))
    assert found.faults == ()
    assert found.outcome == "converged"


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, 30, 10))
def test_extreme_scenes_to_a_tolerance_end_truly(first: int) -> None:
    found = {seed: verdict(extreme_scene(seed)) for seed in range(first, first + 10)}
    assert {seed: v.faults for seed, v in found.items() if v.faults} == {}


def test_weak_form_sees_a_wrong_answer() -> None:
    """The check can fail: a strain coordinate a thousandth off, a load a thousandth larger."""
    tables = torsion_ratio(1.0)
    solution = solved(tables)
    assert evaluate(tables, solution).weak < 1e-6
    moved = replace(solution, x=solution.x + 1e-3)
    assert evaluate(tables, moved).weak > 1e-4
    load = tables["loads"][0]
    heavier = {**tables, "loads": [{**load, "force": [1.001 * f for f in load["force"]]}]}
    assert evaluate(heavier, solution).tip > 1e-5


@settings(max_examples=150, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(st.lists(st.tuples(st.sampled_from(WORDS), st.sampled_from(WORDS + SPOILT)), min_size=1, max_size=3))
def test_text_of_a_scene_is_read_or_refused(swaps: list[tuple[str, str]]) -> None:
    """Words and numbers exchanged: a scene or a refusal that says where, nothing else."""
    text = TEXT
    for old, new in swaps:
        text = text.replace(old, new, 1)
    try:
        scene = parse_scene(text)
    except SceneError as refused:
        assert refused.problems
        assert all(problem.problem for problem in refused.problems)
        return
    assert isinstance(scene, Scene)


@pytest.mark.slow
@settings(max_examples=6, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(
    st.floats(1e-6, 1e6),
    st.floats(1e-6, 1e6),
    st.floats(-1e3, 1e3),
    st.floats(-1e3, 1e3),
    st.booleans(),
    st.integers(1, 8),
)
def test_planar_rods_of_any_size_end_truly(
    length: float, bending: float, across: float, along: float, follows: bool, modes: int
) -> None:
    unit = bending / length**2
    load = {"name": "tip", "kind": "tip_wrench", "rod": "rod", "frame": "body" if follows else "world"}
    rod = {"name": "rod", "length": length, "strain": "planar", "stiffness": {"bending_y": bending}}
    tables: dict[str, Any] = {
        "schema": 1,
        "accuracy": {"modes": modes, "nodes": 2 * modes + 2},
        "rods": [rod],
        "loads": [{**load, "force": [across * unit, 0.0, along * unit]}],
    }
    found = verdict(tables)
    assert found.faults == ()
    assert found.outcome in {outcome.label for outcome in Outcome}
