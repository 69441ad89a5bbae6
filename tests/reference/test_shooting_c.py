"""The hand-written C solvers of the benchmarks against the reference cases and against the oracle."""

from __future__ import annotations

import json
import math
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from benchmarks.shooting_reference import CASES, PROGRAMS, Case, Program, compiled, race, steps_for

from .shooting import solve_by_shooting

RODS = Path(__file__).resolve().parents[2].parent / "shared" / "cases" / "rods"
FILES = {name: RODS / f"steel_{name.lower().replace(' ', '_')}.json" for name in CASES}
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not installed"),
]


def table_of(case: Case) -> dict[str, Any]:
    """The scene of a case."""
    bending = {"bending_x": case.bending, "bending_y": case.bending_y or case.bending}
    stiffness = bending | {"torsion": case.torsion}
    if case.kind == "reissner":
        stiffness |= {"shear_x": case.shear, "shear_y": case.shear_y or case.shear}
        stiffness["extension"] = case.extension
    rod = {"name": "rod", "length": case.length, "strain": case.kind, "stiffness": stiffness}
    rod["base"] = {"quaternion": [1.0, 0.0, 0.0, 0.0]}
    tip = {"name": "tip", "kind": "tip_wrench", "rod": "rod", "force": case.force, "moment": case.moment}
    weight = {"name": "weight", "kind": "distributed_wrench", "rod": "rod", "force": case.weight, "frame": "world"}
    return {"schema": 1, "rods": [rod], "loads": [tip, weight]}


def random_case(kind: str, seed: int) -> Case:
    """Tip force, moment and weight in all directions, up to three times EI/L² and EI/L; soft in shear."""
    rng = np.random.default_rng(seed)
    length, bending = 0.7, 0.3
    force, weight = 3 * bending / length**2 * rng.uniform(-1, 1, (2, 3))
    moment = bending / length * rng.uniform(-1, 1, 3)
    vectors = (tuple(map(float, v)) for v in (force, moment, weight / length))
    return Case(kind, length, bending, 0.6 * bending, 90 * bending, 200 * bending, *vectors)


@pytest.mark.parametrize("name", [name for name, path in FILES.items() if path.exists()])
@pytest.mark.parametrize(("program", "unknowns"), [("plain", 6), ("tuned", 6), ("tuned", 3)])
def test_tips_of_the_reference_cases(name: str, program: Program, unknowns: int) -> None:
    found = race(CASES[name], 1000, repeat=1, program=program, unknowns=unknowns)
    assert found["status"] == "converged"
    wanted = json.loads(FILES[name].read_text())["expected"]["tip"]["position"]
    # The plain program's last iterate may leave nearly the whole tolerance of 1e-11, the tuned one's leaves far less.
    assert_allclose(found["tip"], wanted, rtol=0, atol=5e-12 if program == "plain" else 1e-12)


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize(("program", "nested"), [("plain", False), ("tuned", False), ("tuned", True)])
def test_tip_error_falls_with_the_fourth_power_of_the_steps(name: str, program: Program, nested: bool) -> None:
    case = CASES[name]
    steps = np.array([40, 80, 160])
    errors = [case.tip_error(race(case, int(n), repeat=1, program=program, nested=nested)["tip"]) for n in steps]
    slopes = -np.diff(np.log(errors)) / np.diff(np.log(steps))
    assert np.all((slopes > 3.7) & (slopes < 4.3)), slopes


@pytest.mark.parametrize("kind", ["kirchhoff", "reissner"])
@pytest.mark.parametrize("seed", range(3))
def test_random_load_vs_the_oracle(kind: str, seed: int) -> None:
    case = random_case(kind, seed)
    wanted = solve_by_shooting(table_of(case), samples=2)
    options = [{"program": "plain"}, {"program": "tuned"}, {"program": "tuned", "unknowns": 3, "nested": True}]
    for option in options:
        found = race(case, 1000, repeat=1, **option)
        assert found["status"] == "converged"
        assert_allclose(found["tip"], wanted.tip_position, rtol=0, atol=1e-10 * case.length)
        assert_allclose(found["rotation"], wanted.tip_rotation, rtol=0, atol=1e-10)


@pytest.mark.parametrize("kind", ["kirchhoff", "reissner"])
def test_plain_program_on_a_section_with_unequal_stiffnesses(kind: str) -> None:
    equal = random_case(kind, 3)
    case = replace(equal, bending_y=0.4 * equal.bending, shear_y=0.3 * equal.shear)
    found = race(case, 1000, repeat=1, program="plain")
    wanted = solve_by_shooting(table_of(case), samples=2)
    assert_allclose(found["tip"], wanted.tip_position, rtol=0, atol=1e-10 * case.length)
    assert_allclose(found["rotation"], wanted.tip_rotation, rtol=0, atol=1e-10)
    with pytest.raises(RuntimeError, match="usage"):
        race(case, 1000, repeat=1, program="tuned")


@pytest.mark.parametrize("name", CASES)
def test_the_programs_agree(name: str) -> None:
    plain, tuned = (race(CASES[name], 1000, repeat=1, program=program) for program in PROGRAMS)
    assert_allclose(plain["tip"], tuned["tip"], rtol=0, atol=1e-9)
    assert_allclose(plain["rotation"], tuned["rotation"], rtol=0, atol=1e-9)


def test_shortcuts_are_the_tuned_programs() -> None:
    with pytest.raises(ValueError, match="six unknowns"):
        race(CASES["B1"], 10, program="plain", unknowns=3)
    with pytest.raises(RuntimeError, match="usage"):
        race(CASES["B1"], 10, program="plain", nested=True)


@pytest.mark.parametrize("program", PROGRAMS)
def test_steps_for_an_accuracy_are_the_fewest(program: Program) -> None:
    case, bound = CASES["B2"], 1e-7
    steps = steps_for(case, bound, program)
    assert case.tip_error(race(case, steps, repeat=1, program=program)["tip"]) <= bound
    assert case.tip_error(race(case, steps - 1, repeat=1, program=program)["tip"]) > bound
    with pytest.raises(ValueError, match="no number of steps"):
        steps_for(replace(case, tip=(1.0, 0.0, 0.0)), bound, program)


@pytest.mark.parametrize("program", PROGRAMS)
def test_full_circle(program: Program) -> None:
    wire = CASES["B1 Kirchhoff"]
    circle = replace(wire, force=(0.0, 0.0, 0.0), moment=(0.0, 2 * math.pi * wire.bending / wire.length, 0.0))
    assert_allclose(race(circle, 400, repeat=1, program=program)["tip"], 0, atol=1e-8)


@pytest.mark.parametrize("program", PROGRAMS)
def test_load_that_plain_newton_does_not_reach(program: Program) -> None:
    wire = CASES["B1 Kirchhoff"]
    unit = wire.bending / wire.length
    force, moment = (7 * unit / wire.length, 4 * unit / wire.length, unit / wire.length), (-unit, -unit, 2 * unit)
    hard = replace(wire, force=force, moment=moment)
    found = race(hard, 1000, repeat=1, program=program)
    assert found["iterations"] > 10
    assert_allclose(found["tip"], solve_by_shooting(table_of(hard), samples=2).tip_position, rtol=0, atol=1e-10)


@pytest.mark.parametrize("program", PROGRAMS)
def test_failure_is_told(program: Program) -> None:
    """A single step cannot follow the rod under so large a load."""
    found = race(replace(CASES["B1"], force=(1e5, 1e4, -1e6)), 1, repeat=1, program=program)
    assert found["status"] == "failed"
    assert found["tip"] is None


@pytest.mark.parametrize("program", PROGRAMS)
@pytest.mark.parametrize(
    "arguments",
    [
        [],
        ["reissner", "0.5"],
        ["planar", *["1"] * 12],
        ["reissner", *["1"] * 5, "1.5", *["0"] * 6],
        ["reissner", *["1"] * 6, *["0"] * 5, "x"],
        ["reissner", *["1"] * 6, *["0"] * 6, "--repeat"],
        ["reissner", *["1"] * 6, *["0"] * 6, "--y", "1", "0"],
        ["reissner", *["1"] * 6, *["0"] * 6, "extra"],
    ],
)
def test_wrong_arguments_give_the_usage(program: Program, arguments: list[str]) -> None:
    done = subprocess.run([compiled(program), *arguments], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.startswith("usage:")
    assert not done.stdout
