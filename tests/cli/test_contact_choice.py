"""Modes of scenes in exact contact are chosen for ranges of inputs, as those of all others."""

from __future__ import annotations

import json
from dataclasses import replace
from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console
from typer.testing import CliRunner

from cosserat_casadi import Model, Outcome, Scene, Solution, discretise, read_scene, scene_from_dict, solve
from cosserat_casadi.accuracy.choose import Choice, choose
from cosserat_casadi.accuracy.common_modes import Answers, CommonModes, LoadCase
from cosserat_casadi.accuracy.fixing import with_accuracy
from cosserat_casadi.cli.commands import export as export_command
from cosserat_casadi.cli.main import app
from cosserat_casadi.cli.reports.model import print_choice
from cosserat_casadi.equilibrium.answer_error import UNKNOWN
from cosserat_casadi.scene.writing import scene_tables, scene_text
from tests.codegen.contact_libraries import over_bar
from tests.commands import cosserat
from tests.contact.test_rods_that_rest_on_rods import BELOW, pressed
from tests.motion.test_rods_that_strike_rods import free_rods
from tests.scenes import push, scene

RANGES = [word for text in ("x=-0.5:0.5", "y=-0.1:0.1", "z=-4:-2") for word in ("--range", f"push.force.{text}")]


@pytest.fixture
def bar(tmp_path: Path) -> Path:
    """A folder with a planar rod over a bar, to a tolerance that few modes keep."""
    (tmp_path / "bar.toml").write_text(scene_text(with_accuracy(over_bar(), tolerance=1e-3)))
    return tmp_path


def test_modes_in_contact_are_verified_where_the_inputs_go() -> None:
    """At the ends of a range, and not at the scene's own inputs alone."""
    few = with_accuracy(over_bar(), tolerance=1e-6, modes=2, nodes=6)
    choice = choose(few, cases=[{}, {"push.force": [0.0, 0.0, -4.0]}])
    solution = solve(choice.model)
    assert solution.contacts
    assert choice.solves == 2
    assert choice.within_tolerance is False
    assert choice.error_estimate is not None
    assert solution.error_estimate is not None
    assert choice.error_estimate > 1.5 * solution.error_estimate
    assert "push.force.z=-4:-3" in choice.verified.sentence


@pytest.mark.slow
def test_in_contact_no_point_is_solved_for_each_range_alone() -> None:
    few = with_accuracy(over_bar(), tolerance=1e-3, modes=2, nodes=6)
    choice = choose(few, {"push.force.x": (-0.5, 0.5), "push.force.z": (-4.0, -3.0)}, samples=1)
    # The scene's own inputs, a corner, both ends of all ranges together, a random point.
    assert choice.solves == 5


def crossing() -> Scene:
    """Two rods in planes on few modes: a force presses the upper one on the lower one."""
    tables = pressed([0, 0, -3e-4], BELOW, accuracy={"modes": 2, "nodes": 4})
    for own in tables["rods"]:
        own["strain"] = ["bending_x", "bending_y"]
    return scene_from_dict(tables | {"simulation": {"duration": 0.01, "start": "unloaded"}})


def test_rods_that_touch_rods_start_unloaded_where_no_answer_is_near() -> None:
    """A start by unknowns, as beside cushions, would name no contacts: it is refused."""
    scene = crossing()
    case = LoadCase(scene, {})
    search = CommonModes([case, case], settles=False)
    model = Answers(discretise(scene)).model_of(case)
    assert search._unloaded(1, model) is None


def test_a_held_scene_has_no_velocities_of_rods() -> None:
    """It is a scene that can be read: modes of motions are chosen for it."""
    held = scene_from_dict(free_rods()).held()
    assert not held.velocities
    assert scene_from_dict(scene_tables(held)) == held


@pytest.mark.slow
@pytest.mark.parametrize("found", [True, False], ids=["contact", "none found"])
def test_modes_of_motions_are_chosen_for_rods_that_touch(
    found: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In the equilibrium of the scene; where none is found they are chosen for rods apart, and a sentence says so."""
    touching = crossing()
    (tmp_path / "rods.toml").write_text(scene_text(touching))
    solved: list[Scene] = []

    def known(model: Model) -> Solution:
        solved.append(model.scene)
        end = solve(model)
        return end if found or not model.scene.rod_contacts else replace(end, outcome=Outcome.CONTACT_UNSETTLED)

    monkeypatch.setattr(export_command, "solve", known)
    # The scene's own inputs are enough.
    monkeypatch.setattr(export_command, "choose_with_progress", lambda scene, *_: choose(scene, cases=[{}]))
    folder = tmp_path / "c"
    words = ["--output", str(folder), "--dynamics"]
    done = CliRunner().invoke(app, ["export", str(tmp_path / "rods.toml"), *words])
    assert done.exit_code == 0, done.output
    assert [bool(scene.rod_contacts) for scene in solved] == ([True] if found else [True, False])
    assert (export_command.APART in " ".join(done.output.split())) is not found
    assert read_scene(folder / "scene.toml").rod_contacts == touching.rod_contacts


@pytest.mark.slow
def test_an_export_in_contact_says_for_which_ranges_its_modes_were_chosen(bar: Path) -> None:
    done = cosserat("export", "bar.toml", "--output", "c", *RANGES, "--samples", "2", cwd=bar)
    assert done.returncode == 0, done.stdout + done.stderr
    verified = json.loads((bar / "c" / "manifest.json").read_text())["verified"]
    assert verified["within_tolerance"] is True
    assert verified["ranges"] == [text for text in RANGES if text != "--range"]
    for file in ("README.md", "bar.h"):
        text = " ".join((bar / "c" / file).read_text().split())
        assert f"was verified by {verified['solves']} solves over push.force.x=-0.5:0.5" in text
    assert read_scene(bar / "c" / "scene.toml").accuracy.chosen_for == tuple(verified["ranges"])


@pytest.mark.slow
def test_an_export_in_contact_that_misses_the_tolerance_says_so(bar: Path) -> None:
    fixed = ("--set", "accuracy.modes=2", "--set", "accuracy.nodes=6", "--set", "accuracy.tolerance=1e-6")
    (bar / "cases.csv").write_text("push.force.z\n-4\n-2\n")
    done = cosserat("export", "bar.toml", "--output", "c", *fixed, "--over", "cases.csv", cwd=bar)
    assert done.returncode == 3, done.stdout + done.stderr
    assert "does not keep the tolerance everywhere in the ranges" in " ".join(done.stderr.split())
    verified = json.loads((bar / "c" / "manifest.json").read_text())["verified"]
    assert verified["within_tolerance"] is False
    assert verified["solves"] == 3
    assert verified["ranges"] == ["push.force.z=-4:-2"]
    assert "The discretisation does not keep the tolerance there." in " ".join(
        (bar / "c" / "bar.h").read_text().split()
    )


# What is printed of a choice of modes where an equilibrium is missing, or an error is not known.


@pytest.fixture(scope="module")
def choice() -> Choice:
    bent = scene(push(), strain="planar", accuracy={"tolerance": 1e-2})
    return choose(bent, cases=[{"push.force": [force, 0.0, 0.0]} for force in (0.1, 0.2)])


def printed(choice: Choice) -> str:
    """The report in one line."""
    text = StringIO()
    print_choice(Console(file=text, width=200), choice)
    return " ".join(text.getvalue().split())


def test_cases_without_an_equilibrium_are_not_within_the_tolerance(choice: Choice) -> None:
    assert "All 2 load cases are within 0.01." in printed(choice)
    said = printed(replace(choice, without_equilibrium=(choice.worst,)))
    assert "All 1 load cases that have an equilibrium are within 0.01." in said
    assert "No equilibrium was found at 1 load case," in said


def test_the_one_case_of_a_scene_without_inputs_has_no_name(choice: Choice) -> None:
    assert "Worst case: push.force = [" in printed(choice)
    said = printed(replace(choice, worst={}))
    assert "Estimated error" in said
    assert "Worst case" not in said


def test_an_error_that_is_not_known_is_no_number(choice: Choice) -> None:
    unknown = replace(choice, error_estimate=UNKNOWN, met=False)
    assert "estimated error not known" in printed(unknown)
    assert (
        "their error is not known. The discretisation does not keep the tolerance there." in unknown.verified.sentence
    )
