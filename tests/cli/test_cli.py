"""The command line as a user meets it: real processes, exit codes, files."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import SceneError, Solution, build, read_scene, solve
from cosserat_casadi.cli.options import asked_cases
from cosserat_casadi.codegen.motion_sources import MOTION_FILES
from cosserat_casadi.files import write_atomically
from cosserat_casadi.model.load_cases import case_layout
from cosserat_casadi.results.json_text import json_text
from examples.demo import EXPORTED, HANDFUL, MOTIONS, SCENES, command_lines
from tests.commands import WIRE, cosserat
from tests.conftest import ROOT
from tests.families import mostly_slow
from tests.mjcf.moved_chains import LOOPS

SCENE = (
    """
schema = 1
title = "A wire"
"""
    + WIRE
)


@pytest.fixture
def wire(tmp_path: Path) -> Path:
    (tmp_path / "wire.toml").write_text(SCENE)
    return tmp_path


def test_solve_writes_result_and_figure(wire: Path) -> None:
    done = cosserat("solve", "wire.toml", "--output", "r.json", "--plot", "f.png", cwd=wire)
    assert done.returncode == 0, done.stderr
    assert "Equilibrium found" in done.stdout
    assert "tip position" in done.stdout
    assert (wire / "f.png").read_bytes().startswith(b"\x89PNG")
    result = json.loads((wire / "r.json").read_text())
    assert result["converged"] is True
    assert result["outcome"] == "converged"
    assert sorted(p.name for p in wire.iterdir()) == ["f.png", "r.json", "wire.toml"]


def test_result_file_vs_solution(wire: Path) -> None:
    cosserat("solve", "wire.toml", "--output", "r.json", cwd=wire)
    result = json.loads((wire / "r.json").read_text())
    rod = result["rods"]["wire"]
    discretisation = result["discretisation"]["wire"]
    chosen = {
        "modes": discretisation["modes"],
        "nodes": discretisation["nodes"],
        "rotation": json.dumps(discretisation["transport"]),
    }
    scene = read_scene(wire / "wire.toml", [f"accuracy.{key}={value}" for key, value in chosen.items()])
    solution = solve(build(scene))
    X = np.array(rod["X"])
    assert X[0] == 0.0
    assert X[-1] == 1.0
    pose = solution.pose(X)
    assert_allclose(rod["position"], pose.position, rtol=0, atol=1e-12)
    assert_allclose(rod["quaternion"], pose.quaternion, rtol=0, atol=1e-12)
    assert_allclose(rod["strain"], solution.strain(X), rtol=0, atol=1e-9)
    assert_allclose(rod["internal_wrench"], solution.internal_wrench(X), rtol=0, atol=1e-9)
    assert_allclose(rod["tip"]["position"], rod["position"][-1], rtol=0, atol=1e-15)
    assert_allclose(rod["base_wrench"]["force"], [-0.2, 0, 0], rtol=0, atol=1e-12)
    w, x, y, z = rod["quaternion"][-1]
    tangent = [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)]
    assert_allclose(np.array(rod["tip"]["rotation"])[:, 2], tangent, rtol=0, atol=1e-12)


def test_json_on_standard_output_is_pure(wire: Path) -> None:
    done = cosserat("solve", "wire.toml", "--json", cwd=wire)
    assert done.returncode == 0
    assert json.loads(done.stdout)["rods"]["wire"]["tip"]["position"][0] > 0


def test_set_changes_a_load(wire: Path) -> None:
    done = cosserat("solve", "wire.toml", "--set", "push.force=[0,0.2,0]", "--json", cwd=wire)
    tip = json.loads(done.stdout)["rods"]["wire"]["tip"]["position"]
    assert tip[1] > 0.01
    assert_allclose(tip[0], 0.0, rtol=0, atol=1e-12)


def test_check_prices_the_scene(wire: Path) -> None:
    done = cosserat("check", "wire.toml", cwd=wire)
    assert done.returncode == 0
    for word in ("valid", "wire", "tip_wrench", "operations", "Jacobian"):
        assert word in done.stdout
    assert sorted(p.name for p in wire.iterdir()) == ["wire.toml"]


def test_check_lists_exact_contacts_alike(wire: Path) -> None:
    other = '[[rods]]\nname = "other"\nlength = 0.1\nstrain = "kirchhoff"\nbase = { position = [0.5, 0, 0] }\n'
    other += "material = { youngs_modulus = 6e10, poisson_ratio = 0.33 }\n"
    other += 'section = { shape = "circle", radius = 1e-3 }\n'
    table = '[[obstacles]]\nname = "table"\nkind = "plane"\npoint = [0, 0, -1]\nnormal = [0, 0, 1]\n'
    pair = '[[rod_contacts]]\nrods = ["wire", "other"]\nexact = true\n'
    (wire / "wire.toml").write_text(SCENE + other + table + pair)
    done = cosserat("check", "wire.toml", cwd=wire)
    assert done.returncode == 0, done.stderr
    rows = [line for line in done.stdout.splitlines() if "in contact only" in line]
    assert len(rows) == 2
    assert "exact plane" in rows[0]
    assert "exact contact of" in rows[1]


@pytest.mark.slow
def test_check_lists_parameters_and_solve_takes_their_values(wire: Path) -> None:
    names = '["wire.material.youngs_modulus", "wire.section.radius"]'
    done = cosserat("check", "wire.toml", "--set", f"parameters={names}", cwd=wire)
    assert done.returncode == 0, done.stderr
    row = next(line for line in done.stdout.splitlines() if "wire.material.youngs_modulus" in line)
    assert "6e+10 Pa" in row
    solved = cosserat("solve", "wire.toml", "--set", f"parameters={names}", cwd=wire)
    assert solved.stdout == cosserat("solve", "wire.toml", cwd=wire).stdout
    coarse = ("--set", f"parameters={names}", "--set", "accuracy={modes=2, nodes=4}")
    written = cosserat("export", "wire.toml", *coarse, "--output", "c", cwd=wire)
    assert written.returncode == 0, written.stderr
    described = json.loads((wire / "c" / "manifest.json").read_text())
    assert [entry["name"] for entry in described["parameters"]] == json.loads(names)
    wrong = cosserat("check", "wire.toml", "--set", 'parameters=["wire.material.youngs_modulu"]', cwd=wire)
    assert wrong.returncode == 2
    assert "did you mean 'youngs_modulus'?" in " ".join(wrong.stderr.split())


def test_check_says_how_lists_were_read(wire: Path) -> None:
    """The offset widens where the user may have meant that it converges: the note shows it."""
    cable = '[[actuators]]\nname = "cable"\nkind = "tendon"\nrod = "wire"\ntension = 1.0\noffset = [[8e-3, 4e-3], 0]\n'
    (wire / "wire.toml").write_text(SCENE + cable)
    taper = "wire.section.radius={ base = 1e-3, tip = 0.5e-3 }"
    done = cosserat("check", "wire.toml", "--set", taper, cwd=wire)
    assert done.returncode == 0
    said = " ".join(done.stdout.split())
    read_as = "Note: the list of cable.offset[0] was read as powers of X; "
    assert read_as + "{ base = 0.008, tip = 0.012 } says the same." in said
    assert "│ cable.offset[0] │ powers of X │ 0.008 m │ 0.012 m │" in said
    assert "│ wire.section.radius │ base and tip │ 0.001 m │ 0.0005 m │" in said
    assert said.count("Note:") == 1


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["solve", "missing.toml"], "missing.toml"),
        (["solve", "."], "."),
        (["solve", "wire.toml", "--set", "shove.force=[0,0,1]"], "--set shove.force"),
        (["solve", "wire.toml", "--set", "push.force=[0,0,"], "--set push.force"),
        (["solve", "wire.toml", "--output", "no/such/r.json"], "does not exist"),
        (["solve", "wire.toml", "--output", "."], "is a folder"),
        (["solve", "wire.toml", "--output", "r.json", "--plot", "f.doc"], "one of .png, .pdf, .svg, .glb, .usda"),
        (["solve", "wire.toml", "--output", "r.json", "--set", "wire.length=-1"], "must be > 0, got -1"),
        (
            ["solve", "wire.toml", "--set", "wire.length=1e-60", "--set", "wire.material.youngs_modulus=1e120"],
            "wire: its length of 1e-60 m",
        ),
        (
            ["check", "wire.toml", "--set", "wire.length=1e60", "--set", "wire.material.youngs_modulus=1e-120"],
            "too large or too small to compute with",
        ),
        (["solve", "wire.toml", "--set", "wire.section.radius=1e-60"], "too large or too small to compute with"),
        (["solve", "wire.toml", "--colour"], "colour"),
        (["path", "wire.toml"], "--input: is missing"),
        (["path", "wire.toml", "--input", "push.force"], "--to: is missing: the value that push.force goes to"),
        (["path", "wire.toml", "--range", "push.force=0:1:5"], "no number of an input"),
        (["path", "wire.toml", "--range", "push.force.x=0:1:1"], "asks for 1 point ("),
        (["path", "wire.toml", "--range", "push.force.x=2:2"], "ends where it begins"),
        (["path", "wire.toml", "--range", "push.force.x=0:1", "--to", "[0,0,1]"], "beside --input or --to"),
        (["path", "wire.toml", "--range", "push.force.x=0:1", "--range", "push.force.y=0:1"], "follows one input"),
        (["path", "wire.toml", "--input", "shove.force", "--to", "[0,0,1]"], "--input: 'shove.force' is no input of"),
        (["path", "wire.toml", "--input", "push.force", "--to", "1.0"], "must have 3 numbers, got 1"),
        (["path", "wire.toml", "--input", "push.force", "--to", "[0,0]"], "must have 3 numbers, got 2"),
        (["path", "wire.toml", "--input", "push.force", "--to", "[0,0,nan]"], "--to: must be finite"),
        (["path", "wire.toml", "--input", "push.force", "--to", "[0,0,"], "--to: must be a number or a list"),
        (["path", "wire.toml", "--input", "push.force", "--to", '["a",0,1]'], "--to: must be a number or a list"),
        (["path", "wire.toml", "--input", "push.force", "--to", "1], b = [2"], "--to: must be a number or a list"),
        (["path", "wire.toml", "--input", "push.force", "--to", "0,0,1"], "write it as in TOML: [0, 0, -5.0]"),
        (["path", "wire.toml", "--input", "push.force", "--to", "[0,0,1]", "--csv", "no/p.csv"], "--csv"),
        (["path", "wire.toml", "--input", "push.force", "--to", "[0,0,1]", "--plot", "f.doc"], "--plot"),
        (["inverse", "wire.toml", "--output", "r.json"], "targets: missing"),
        (["inverse", "wire.toml", "--table", "none.csv"], "--table: none.csv does not exist"),
        (["inverse", "wire.toml", "--plot", "f.doc"], "one of .png, .pdf, .svg)"),
        (["sing"], "sing"),
    ],
)
def test_refusals(wire: Path, arguments: list[str], words: str) -> None:
    done = cosserat(*arguments, cwd=wire)
    assert done.returncode == 2
    assert words in done.stderr
    assert "Traceback" not in done.stderr + done.stdout
    assert sorted(p.name for p in wire.iterdir()) == ["wire.toml"]


@pytest.mark.slow
def test_no_equilibrium_is_exit_code_three_and_still_written(wire: Path) -> None:
    """A rod that must reach a pose with its length exactly spent sideways: the support cannot be met."""
    text = SCENE + '[[supports]]\nrod = "wire"\nkind = "clamped"\nposition = [0.2, 0, 0]\nquaternion = [1, 0, 0, 0]\n'
    (wire / "hard.toml").write_text(text)
    done = cosserat("solve", "hard.toml", "--output", "r.json", cwd=wire)
    assert done.returncode == 3, done.stdout + done.stderr
    result = json.loads((wire / "r.json").read_text())
    assert result["converged"] is False
    assert result["outcome"] != "converged"
    assert "Traceback" not in done.stderr


COLUMN = """
schema = 1
title = "A column"
accuracy = { modes = 8, nodes = 20 }
[[rods]]
name = "column"
length = 2.0
strain = "planar"
stiffness = { bending_y = 4.0 }
[[loads]]
name = "push"
kind = "tip_wrench"
rod = "column"
force = [0, 0, -1.0]
"""


def test_path_writes_json_csv_and_figure(tmp_path: Path) -> None:
    (tmp_path / "column.toml").write_text(COLUMN)
    options = ["--input", "push.force", "--to", "[0, 0, -5.0]", "--branch"]
    files = ["--output", "p.json", "--csv", "p.csv", "--plot", "p.png"]
    done = cosserat("path", "column.toml", *options, *files, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "bifurcation" in done.stdout
    assert (tmp_path / "p.png").read_bytes().startswith(b"\x89PNG")
    path = json.loads((tmp_path / "p.json").read_text())
    assert (path["schema"], path["outcome"]) == (1, "converged")
    first, last = path["path"][0], path["path"][-1]
    assert (first["factor"], first["stable"], last["factor"], last["stable"]) == (0.0, True, 1.0, True)
    (event,) = path["events"]
    assert event["kind"] == "bifurcation"
    assert_allclose(5 * event["factor"], np.pi**2 / 4, rtol=1e-8, atol=0)
    assert len(last["rods"]["column"]["tip"]["position"]) == 3
    assert len(last["rods"]["column"]["tip"]["quaternion"]) == 4
    assert abs(last["rods"]["column"]["tip"]["position"][0]) > 0.5
    head, *rows = (tmp_path / "p.csv").read_text().splitlines()
    assert head.startswith("factor,stable,smallest_eigenvalue,column.x,")
    assert len(rows) == len(path["path"])
    assert_allclose(float(rows[-1].split(",")[3]), last["rods"]["column"]["tip"]["position"][0], rtol=1e-15, atol=0)


def test_a_range_leads_from_a_value_to_another(tmp_path: Path) -> None:
    (tmp_path / "column.toml").write_text(COLUMN)
    options = ["--set", "push.force=[0.3,0,-1]", "--output", "p.json"]
    done = cosserat("path", "column.toml", "--range", "push.force.z=1:-0.5:25", *options, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    path = json.loads((tmp_path / "p.json").read_text())
    assert (path["input"], path["start"], path["value"]) == ("push.force", [0.3, 0.0, 1.0], [0.3, 0.0, -0.5])
    assert len(path["path"]) >= 25
    assert "0.3, 0, 1" in done.stdout
    # Both ends are the equilibria that a solve gives.
    for force, entry in (([0.3, 0, 1], path["path"][0]), ([0.3, 0, -0.5], path["path"][-1])):
        end = solve(read_scene(tmp_path / "column.toml", [f"push.force={force}"]))
        tip = entry["rods"]["column"]["tip"]["position"]
        assert_allclose(tip, end.tip().position, rtol=0, atol=1e-5)


def test_path_that_has_no_branch_is_exit_code_three_and_still_written(tmp_path: Path) -> None:
    (tmp_path / "column.toml").write_text(COLUMN)
    options = ["--input", "push.force", "--to", "[0, 0, -1.0]", "--branch", "--output", "p.json"]
    done = cosserat("path", "column.toml", *options, cwd=tmp_path)
    assert done.returncode == 3, done.stdout + done.stderr
    path = json.loads((tmp_path / "p.json").read_text())
    assert path["outcome"] == "no_bifurcation"
    assert "before the chosen bifurcation" in done.stdout


def test_every_fault_of_a_path_comes_at_once(wire: Path) -> None:
    options = ["--input", "shove.force", "--to", "up", "--output", "no/p.json", "--plot", "f.doc", "--bifurcation", "0"]
    done = cosserat("path", "wire.toml", *options, cwd=wire)
    assert done.returncode == 2
    assert "5 problems" in done.stderr
    assert "--bifurcation" in done.stderr


def test_not_finite_numbers_become_null(wire: Path) -> None:
    found = solve(build(read_scene(wire / "wire.toml")))
    broken = Solution(
        found.model, found.inputs, np.full_like(found.x, np.nan), found.outcome, "broken", float("nan"), 0
    )
    text = json_text(broken.to_dict())
    assert "NaN" not in text
    assert json.loads(text)["residual_norm"] is None


def test_files_are_written_whole_or_not_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    target = tmp_path / "r.json"
    target.write_text("old")

    def interrupted(self: Path, other: Path) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Path, "replace", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_atomically(target, b"new")
    assert target.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["r.json"]


# What nothing holds has no equilibrium.
HELD = [path for path in sorted((ROOT / "examples").glob("*.toml")) if "free = true" not in path.read_text()]
# The search for contacts takes seconds, and so does the largest platform; both have tests of their own. So have the
# robot of two sections and its tendons, on the pages, the arch, among the paths, and rods of several materials and in
# contact with each other.
ELSEWHERE = {
    "six_rod_platform",
    "two_section_robot",
    "tendon_robot_move",
    "fishing_rod_cast",
    "deep_arch",
    "disk_robot",
    "three_materials",
    "crossing_fingers",
}
LONG = [path for path in HELD if "[[obstacles]]" in path.read_text() or path.stem in ELSEWHERE]
# A third of the others are solved every time.
LONG += [path for place, path in enumerate(path for path in HELD if path not in LONG) if place % 3]
LONG += [path for path in HELD if path.stem in ("pendulum_chain", "branching_rod", "needle_in_tissue", "loaded_tubes")]


@pytest.mark.parametrize(
    "path",
    [pytest.param(path, marks=pytest.mark.slow) if path in LONG else path for path in HELD],
    ids=lambda path: path.stem,
)
def test_examples_solve(path: Path, tmp_path: Path) -> None:
    done = cosserat("solve", str(path), "--output", "r.json", cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    result = json.loads((tmp_path / "r.json").read_text())
    assert result["converged"]
    accuracy = read_scene(path).accuracy
    # Of modes that a scene fixes the error is told, and not chosen.
    if not accuracy.fixed:
        assert result["error_estimate"] <= accuracy.tolerance


@pytest.mark.slow
def test_inverse_writes_what_was_found(wire: Path) -> None:
    """A wire of 0.2 m that keeps its length reaches one point, and not one that lies beyond it."""
    target = 'inputs = ["push.force"]\n{}\n[[targets]]\nkind = "position"\nrod = "wire"\nposition = [{}, 0, 0.1]\n'
    for name, x, code in (("near", 0.16, 0), ("far", 0.3, 3)):
        (wire / f"{name}.toml").write_text(target.format("", x).replace("\n\n", SCENE, 1))
        done = cosserat("inverse", f"{name}.toml", "--output", f"{name}.json", "--plot", "f.svg", cwd=wire)
        assert done.returncode == code, done.stdout + done.stderr
        found = json.loads((wire / f"{name}.json").read_text())
        assert found["targets_met"] is (code == 0)
        assert found["converged"] is True
        assert found["targets"][0]["angle_gap"] is None
        assert (wire / "f.svg").stat().st_size > 1000
        assert ("The targets are met." in found["message"]) is (code == 0)
        # What was asked for is what the first line tells.
        assert done.stdout.splitlines()[1].startswith("The targets are met." if code == 0 else "Not all targets are")
    assert found["targets"][0]["position_gap"] == pytest.approx(np.hypot(0.3, 0.1) - 0.2, abs=1e-3)
    assert "misses tip of wire" in found["message"]


def test_demo_and_gallery_run_every_example_once(tmp_path: Path) -> None:
    lines = [*command_lines(tmp_path, rest=False), *command_lines(tmp_path, rest=True)]
    scenes = [Path(line[1]) for line in lines if "--plot" in line]
    assert sorted(scenes) == sorted((ROOT / "examples").glob("*.toml"))
    assert set(HANDFUL) <= {*SCENES, *MOTIONS}
    (exported,) = (line for line in lines if line[0] == "export" and "--page" not in line)
    assert exported == ["export", str(ROOT / "examples" / f"{EXPORTED}.toml"), "--output", str(tmp_path / EXPORTED)]


@pytest.mark.slow
def test_tune_fixes_a_discretisation_for_a_set_of_loads(wire: Path) -> None:
    (wire / "loads.csv").write_text("push.force.x,push.force.y\n0.1,0\n0,0.3\n")
    done = cosserat(
        "tune", "wire.toml", "--output", "tuned.toml", "--tolerance", "1e-4", "--over", "loads.csv", cwd=wire
    )
    assert done.returncode == 0, done.stderr
    assert "All 2 load cases are within 0.0001" in done.stdout
    tuned = read_scene(wire / "tuned.toml")
    assert tuned.accuracy.modes is not None
    assert tuned.accuracy.nodes is not None
    assert solve(build(tuned)).converged


def test_tune_fixes_a_discretisation_for_ranges(wire: Path) -> None:
    """Those that are asked for, and for the rest a scale of its own; the file says which."""
    options = ("--tolerance", "1e-3", "--range", "push.force.x=-0.1:0.2")
    done = cosserat("tune", "wire.toml", "--output", "tuned.toml", *options, cwd=wire)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "load cases are within 0.001" in done.stdout
    tuned = read_scene(wire / "tuned.toml")
    assert tuned.accuracy.chosen_for is not None
    assert "push.force.x=-0.1:0.2" in tuned.accuracy.chosen_for
    assert {text.partition("=")[0] for text in tuned.accuracy.chosen_for} >= {"push.force.y", "push.force.z"}


def test_tune_refuses_columns_that_are_no_inputs(wire: Path) -> None:
    done = cosserat("tune", "wire.toml", "--output", "tuned.toml", "--range", "pull.x=0:1", cwd=wire)
    assert done.returncode == 2
    assert "'pull.x' is not an input or a parameter of this scene" in done.stderr
    (wire / "loads.csv").write_text("push.force.x\n0.1\n")
    options = ("--over", "loads.csv", "--range", "push.force.x=0:1")
    both = cosserat("tune", "wire.toml", "--output", "tuned.toml", *options, cwd=wire)
    assert both.returncode == 2
    assert "does not say how many values (write push.force.x=0:1:21" in " ".join(both.stderr.split())
    twice = cosserat("tune", "wire.toml", "--output", "tuned.toml", *options[:3], "push.force.x=0:1:2", cwd=wire)
    assert twice.returncode == 2
    assert "'push.force.x' is a column of loads.csv too" in " ".join(twice.stderr.split())
    assert not (wire / "tuned.toml").exists()


def test_counts_of_ranges_are_a_grid_of_load_cases_beside_files(wire: Path) -> None:
    scene = read_scene(wire / "wire.toml")
    layout = case_layout(scene)
    assert asked_cases(None, ["push.force.x=0:1"], scene) is None
    (wire / "loads.csv").write_text("push.force.z\n0.1\n0.2\n")
    cases = asked_cases(wire / "loads.csv", ["push.force.x=-1:1:3", "push.force.y=0:1:2"], scene)
    assert cases is not None
    columns = [layout.columns[f"push.force.{axis}"] for axis in "zxy"]
    expected = [[z, x, y] for z in (0.1, 0.2) for x in (-1.0, 0.0, 1.0) for y in (0.0, 1.0)]
    np.testing.assert_allclose(cases[:, columns], expected, rtol=0, atol=1e-15)
    others = np.delete(np.arange(cases.shape[1]), columns)
    np.testing.assert_array_equal(cases[:, others], np.tile(layout.default[others], (12, 1)))
    with pytest.raises(SceneError, match=r"'pull\.force\.x' is not an input or a parameter"):
        asked_cases(None, ["pull.force.x=0:1:3"], scene)
    (wire / "loads.csv").write_text("push.force.z\nmuch\n")
    with pytest.raises(SceneError) as refused:
        asked_cases(wire / "loads.csv", ["push.force.x=-1:1"], scene)
    in_file, in_range = refused.value.problems
    assert in_file.where.startswith(str(wire / "loads.csv"))
    assert in_range.where == "--range"


def test_load_cases_of_a_file_are_its_rows_or_its_grid(wire: Path) -> None:
    scene = read_scene(wire / "wire.toml")
    layout = case_layout(scene)
    (wire / "loads.csv").write_text("push.force.z, push.force.x\n-1.5, 2\n\n0,1e-3\n")
    (wire / "grid.toml").write_text(
        '"push.force.z" = [-1.5, 0.0]\n"push.force.x" = { from = 0.0, to = 1.0, count = 2 }'
    )
    columns = [layout.columns["push.force.z"], layout.columns["push.force.x"]]
    expected = {
        "loads.csv": [[-1.5, 2.0], [0.0, 1e-3]],
        "grid.toml": [[-1.5, 0.0], [-1.5, 1.0], [0.0, 0.0], [0.0, 1.0]],
    }
    for file, values in expected.items():
        cases = asked_cases(wire / file, None, scene)
        assert cases is not None
        np.testing.assert_allclose(cases[:, columns], values, rtol=0, atol=0)
        others = np.delete(np.arange(cases.shape[1]), columns)
        np.testing.assert_array_equal(cases[:, others], np.tile(layout.default[others], (len(values), 1)))
    (wire / "wrong.csv").write_text("pull.force.x\n1\n")
    with pytest.raises(SceneError, match=r"wrong\.csv: 'pull\.force\.x' is not an input or a parameter"):
        asked_cases(wire / "wrong.csv", None, scene)


def test_tune_takes_the_grid_that_a_sweep_takes(wire: Path) -> None:
    options = ("--tolerance", "1e-3", "--range", "push.force.x=-0.1:0.2:3", "--range", "push.force.y=-0.1:0.1:2")
    done = cosserat("tune", "wire.toml", "--output", "tuned.toml", *options, cwd=wire)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "6 load cases" in done.stdout


# Export


def test_export_writes_a_folder_and_says_how_to_go_on(wire: Path) -> None:
    done = cosserat("export", "wire.toml", "--output", "c", "--set", "accuracy.tolerance=1e-3", cwd=wire)
    assert done.returncode == 0, done.stdout + done.stderr
    told = " ".join(done.stdout.split())
    for words in ("A wire", "unknowns, 3 inputs", "estimated error", "wrote c;", "README.md says how to compile"):
        assert words in told
    assert "Traceback" not in done.stderr
    manifest = json.loads((wire / "c" / "manifest.json").read_text())
    assert manifest["files"] == sorted(path.name for path in (wire / "c").iterdir())
    assert manifest["name"] == "wire"
    assert manifest["tolerance"] == 1e-3
    assert 0 < manifest["error_estimate"] <= 1e-3
    assert (wire / "c" / "wire.h").exists()
    assert sorted(p.name for p in wire.iterdir()) == ["c", "wire.toml"]


CONTACT = """
schema = 1

[accuracy]
modes = 2

[[rods]]
name = "rod"
length = 1.0
strain = "planar"
stiffness = { bending_y = 1.0 }
base = { position = [0, 0, 0], tangent = [1, 0, 0] }

[[loads]]
name = "push"
kind = "tip_wrench"
rod = "rod"
force = [0, 0, -1.0]

[[obstacles]]
name = "floor"
kind = "plane"
point = [0, 0, -0.1]
normal = [0, 0, 1]
"""


@pytest.mark.slow
def test_export_in_exact_contact(tmp_path: Path) -> None:
    """The contacts of the load cases are in the folder; other scenes refuse load cases."""
    (tmp_path / "table.toml").write_text(CONTACT)
    (tmp_path / "cases.csv").write_text("push.force.z\n-0.1\n")
    done = cosserat("export", "table.toml", "--output", "c", "--over", "cases.csv", cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "3 inputs" in " ".join(done.stdout.split())
    manifest = json.loads((tmp_path / "c" / "manifest.json").read_text())
    assert [[touch["kind"] for touch in entry["contacts"]] for entry in manifest["arrangements"]] == [["point"], []]
    free = CONTACT[: CONTACT.index("[[obstacles]]")]
    (tmp_path / "free.toml").write_text(free)
    refused = cosserat("export", "free.toml", "--output", "d", "--over", "cases.csv", cwd=tmp_path)
    assert refused.returncode == 2
    assert "no rod of this scene touches an obstacle exactly" in " ".join(refused.stderr.split())
    assert not (tmp_path / "d").exists()


@pytest.mark.slow
def test_export_with_derivatives(wire: Path) -> None:
    fixed = ("--set", 'wire.strain="planar"', "--set", "accuracy.modes=2", "--set", "accuracy.nodes=5")
    plain = cosserat("export", "wire.toml", "--output", "plain", *fixed, cwd=wire)
    with_derivatives = cosserat("export", "wire.toml", "--output", "whole", "--derivatives", *fixed, cwd=wire)
    assert plain.returncode == with_derivatives.returncode == 0
    extra = {path.name for path in (wire / "whole").iterdir()} - {path.name for path in (wire / "plain").iterdir()}
    assert extra == {"wire_derivatives.c", "wire_derivatives_in_fours.h"}


@pytest.mark.slow
def test_export_with_motions(wire: Path) -> None:
    # In a plane the equations of motion are short.
    few = ("accuracy.modes=2", "accuracy.nodes=5", 'rods[0].strain="planar"')
    fixed = [word for setting in few for word in ("--set", setting)]
    plain = cosserat("export", "wire.toml", "--output", "plain", *fixed, cwd=wire)
    with_motions = cosserat("export", "wire.toml", "--output", "whole", "--dynamics", *fixed, cwd=wire)
    assert plain.returncode == with_motions.returncode == 0, with_motions.stderr
    extra = {path.name for path in (wire / "whole").iterdir()} - {path.name for path in (wire / "plain").iterdir()}
    assert extra == {*MOTION_FILES, "wire_motion_demo.c"}
    assert "wire_step(" in (wire / "whole" / "wire.h").read_text()
    assert "wire_step" not in (wire / "plain" / "wire.h").read_text()


def test_export_with_motions_of_a_scene_without_mass(wire: Path) -> None:
    """Refused before it is solved; nothing is written."""
    (wire / "wire.toml").write_text(SCENE.replace(", density = 6450.0", ""))
    refused = cosserat("export", "wire.toml", "--output", "c", "--dynamics", cwd=wire)
    assert refused.returncode == 2
    assert "has no mass" in refused.stderr
    assert not (wire / "c").exists()


@pytest.mark.slow
def test_export_with_changes_and_a_name_over_an_earlier_export(wire: Path) -> None:
    """The folder holds the scene as it was changed; a fixed discretisation is used as it is."""
    changes = ('wire.strain="planar"', "accuracy.modes=2", "accuracy.nodes=5")
    fixed = ("--output", "c", *(word for change in changes for word in ("--set", change)))
    first = cosserat("export", "wire.toml", *fixed, cwd=wire)
    assert first.returncode == 0, first.stderr
    second = cosserat(
        "export",
        "wire.toml",
        *fixed,
        "--name",
        "arm",
        "--set",
        "push.force=[0.1,0,0]",
        "--set",
        "wire.length=0.3",
        cwd=wire,
    )
    assert second.returncode == 0, second.stderr
    names = {path.name for path in (wire / "c").iterdir()}
    assert "arm.h" in names
    assert not [name for name in names if name.startswith("wire")]
    manifest = json.loads((wire / "c" / "manifest.json").read_text())
    assert manifest["discretisation"]["wire"]["modes"] == [2]
    assert manifest["discretisation"]["wire"]["nodes"] == 5
    assert manifest["inputs"][0]["value"] == [0.1, 0, 0]
    kept = read_scene(wire / "c" / "scene.toml")
    assert kept.rods[0].length == 0.3
    written = (*changes, 'accuracy.rotation="magnus6"', "push.force=[0.1,0,0]", "wire.length=0.3")
    assert kept == read_scene(wire / "wire.toml", written)


def test_export_refuses_every_fault_at_once(wire: Path) -> None:
    (wire / "thesis").mkdir()
    (wire / "thesis" / "chapter.tex").write_text("mine")
    ranges = [f"--range=push.force.{text}" for text in ("x=1", "y=3:1", "z=0:1:0")]
    options = ["--mjcf", "no/wire.xml", "--period", "-1", "--over", "no.csv", *ranges]
    done = cosserat("export", "wire.toml", "--output", "thesis", "--name", "2fast", *options, cwd=wire)
    assert done.returncode == 2
    assert "Refused: 8 problems." in done.stderr
    for words in (
        "--name: '2fast' is no name for a C library",
        "--output: ",
        "chapter.tex",
        "a new or an empty folder",
        "--mjcf: the folder no does not exist",
        "--period: must be a positive number of seconds, got -1",
        "--range: 'push.force.x=1' has no two finite numbers",
        "--range: the range of push.force.y must have the lower end first, got 3:1",
        "--range: 'push.force.z=0:1:0' has no whole number of values above 0",
        "--over: load cases say which contacts to export",
    ):
        assert words in done.stderr
    assert "Traceback" not in done.stderr + done.stdout
    assert [p.name for p in (wire / "thesis").iterdir()] == ["chapter.tex"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["wire.toml"], "output"),
        (["missing.toml", "--output", "c"], "missing.toml"),
        (["wire.toml", "--output", "wire.toml"], "--output"),
        (["wire.toml", "--output", "no/such"], "make it first"),
        (["wire.toml", "--output", "c", "--name", "double"], "is a word of C or C++"),
        (["wire.toml", "--output", "c", "--set", "push.force=[0,0"], "--set push.force"),
        (["twins.toml", "--output", "c"], "differ in case alone"),
    ],
)
def test_export_refusals(wire: Path, arguments: list[str], words: str) -> None:
    twin = '[[loads]]\nname = "Push"\nkind = "tip_wrench"\nrod = "wire"\nforce = [0, 0, 1]\n'
    (wire / "twins.toml").write_text(SCENE + twin)
    done = cosserat("export", *arguments, cwd=wire)
    assert done.returncode == 2
    assert words in done.stderr
    assert "Traceback" not in done.stderr + done.stdout
    assert sorted(p.name for p in wire.iterdir()) == ["twins.toml", "wire.toml"]


@pytest.mark.slow
def test_export_of_what_cannot_be_solved_writes_nothing(wire: Path) -> None:
    text = SCENE + '[[supports]]\nrod = "wire"\nkind = "clamped"\nposition = [0.2, 0, 0]\nquaternion = [1, 0, 0, 0]\n'
    (wire / "hard.toml").write_text(text)
    done = cosserat("export", "hard.toml", "--output", "c", "--set", "accuracy.modes=3", cwd=wire)
    assert done.returncode == 3, done.stdout + done.stderr
    assert "Nothing was written." in done.stderr
    assert "Traceback" not in done.stderr
    assert sorted(p.name for p in wire.iterdir()) == ["hard.toml", "wire.toml"]


def test_tune_refuses_a_tolerance_out_of_range(wire: Path) -> None:
    options = ("--output", "tuned.toml", "--tolerance", "5", "--range", "push.force.x=0:1")
    done = cosserat("tune", "wire.toml", *options, cwd=wire)
    assert done.returncode == 2
    assert "accuracy.tolerance: must be <= 0.1, got 5.0" in done.stderr
    assert not (wire / "tuned.toml").exists()


COLUMN = """
schema = 1
[[rods]]
name = "column"
length = 1.0
strain = "planar"
stiffness = { bending_y = 1.0 }
[[loads]]
name = "push"
kind = "tip_wrench"
rod = "column"
force = [0, 0, -5.0]
"""


@pytest.mark.parametrize(
    ("accuracy", "warned"),
    [
        ({"modes": 3, "nodes": 6, "tolerance": 1e-6}, True),
        ({"modes": 9, "nodes": 20, "tolerance": 1e-6}, False),
        # Nobody has asked for the tolerance that a scene has by default.
        ({"modes": 3, "nodes": 6}, False),
    ],
)
def test_fixed_modes_that_miss_the_tolerance_are_told(wire: Path, accuracy: dict[str, float], warned: bool) -> None:
    changes = [f"accuracy.{key}={value}" for key, value in accuracy.items()]
    options = [word for change in changes for word in ("--set", change)]
    done = cosserat("solve", "wire.toml", *options, cwd=wire)
    assert done.returncode == (3 if warned else 0), done.stderr
    assert ("is above the tolerance of 1e-06" in done.stdout) is warned


def test_unstable_equilibrium_is_warned_of_and_stable_one_found(tmp_path: Path) -> None:
    (tmp_path / "column.toml").write_text(COLUMN)
    straight = cosserat("solve", "column.toml", "--output", "straight.json", cwd=tmp_path)
    assert straight.returncode == 0
    assert "--stable" in straight.stderr
    bent = cosserat("solve", "column.toml", "--stable", "--output", "bent.json", cwd=tmp_path)
    assert bent.returncode == 0, bent.stderr
    assert "Warning" not in bent.stderr
    results = [json.loads((tmp_path / f"{name}.json").read_text()) for name in ("straight", "bent")]
    assert [result["stable"] for result in results] == [False, True]
    assert results[0]["smallest_eigenvalue"] < 0.0 < results[1]["smallest_eigenvalue"]
    assert "unstable" in results[0]["message"]


def test_stable_is_refused_where_loads_have_no_potential(tmp_path: Path) -> None:
    (tmp_path / "column.toml").write_text(COLUMN + 'frame = "body"\n')
    done = cosserat("solve", "column.toml", "--stable", "--output", "r.json", cwd=tmp_path)
    assert done.returncode == 2
    assert "no potential" in done.stderr
    assert not (tmp_path / "r.json").exists()


def test_inverse_ends_with_three_at_an_unstable_equilibrium_unless_asked(tmp_path: Path) -> None:
    """Beyond its critical load a column meets its target straight: that counts only where it is asked for."""
    target = """
[[targets]]
kind = "position"
rod = "column"
position = [0, 0, 1.0]
[[bounds]]
input = "push.force"
lower = [0, 0, -5.0]
upper = [0, 0, -4.0]
"""
    (tmp_path / "column.toml").write_text(COLUMN + target)
    refused = cosserat("inverse", "column.toml", "--output", "r.json", cwd=tmp_path)
    assert refused.returncode == 3, refused.stderr
    expected = "Not stable: a real rod leaves this equilibrium. The targets are met. Equilibrium found"
    words = " ".join(refused.stdout.split())
    assert expected in words
    assert refused.stdout.splitlines()[1].startswith("Not stable")
    # The solve that judges what the optimiser has found takes no step, and is not what was done.
    assert "of the optimiser from 1 start" in words
    assert "iteration" not in words
    assert "--unstable" in refused.stderr
    result = json.loads((tmp_path / "r.json").read_text())
    assert (result["targets_met"], result["stable"]) == (True, False)
    accepted = cosserat("inverse", "column.toml", "--unstable", cwd=tmp_path)
    assert accepted.returncode == 0, accepted.stderr
    assert "Not stable" in accepted.stdout
    both = cosserat("inverse", "column.toml", "--unstable", "--stable", cwd=tmp_path)
    assert both.returncode == 2


def test_iterations_are_those_of_the_whole_search(wire: Path) -> None:
    """A wire that is bent from rest takes Newton steps, although the last correction may take none."""
    done = cosserat("solve", "wire.toml", "--output", "r.json", cwd=wire)
    iterations = json.loads((wire / "r.json").read_text())["iterations"]
    assert iterations > 5
    assert f"{iterations} iterations" in " ".join(done.stdout.split())


@pytest.mark.parametrize(
    ("line", "sentence", "helps"),
    [
        ("solve", "Missing argument 'SCENE'.", " solve --help"),
        ("solve scene.toml --nothing 3", "No such option: --nothing", " solve --help"),
        ("slove scene.toml", "No such command 'slove'.", " --help"),
        ("new scene.toml --template arm", "Error: Invalid value for '--template': 'arm' is not one of", " new --help"),
    ],
)
def test_command_that_is_written_wrongly_is_told_where_to_look(
    line: str, sentence: str, helps: str, tmp_path: Path
) -> None:
    done = cosserat(*line.split(), cwd=tmp_path)
    assert done.returncode == 2
    assert sentence in " ".join(done.stderr.split())
    last = done.stderr.splitlines()[-1]
    assert last.startswith("Help: ")
    assert last.endswith(helps)


@pytest.mark.slow
def test_an_export_says_for_which_ranges_its_modes_were_chosen(wire: Path) -> None:
    """Those that are asked for, in the README, the manifest and the scene of the folder."""
    asked = [f"push.force.{axis}=-0.1:0.1" for axis in "xyz"]
    options = [word for text in asked for word in ("--range", text)]
    done = cosserat("export", "wire.toml", "--output", "c", "--set", "accuracy.tolerance=1e-3", *options, cwd=wire)
    assert done.returncode == 0, done.stdout + done.stderr
    verified = json.loads((wire / "c" / "manifest.json").read_text())["verified"]
    assert set(asked) <= set(verified["ranges"])
    assert verified["error_estimate"] <= 1e-3
    assert verified["without_equilibrium"] == 0
    assert verified["within_tolerance"] is True
    readme = (wire / "c" / "README.md").read_text()
    assert f"was verified by {verified['solves']} solves over" in readme
    header = " ".join((wire / "c" / "wire.h").read_text().split())
    assert f"was verified by {verified['solves']} solves over" in header
    assert "judged at the scene's own inputs" not in readme
    kept = read_scene(wire / "c" / "scene.toml")
    assert kept.accuracy.chosen_for is not None
    assert list(kept.accuracy.chosen_for) == verified["ranges"]


@pytest.mark.slow
def test_an_export_that_misses_the_tolerance_is_written_and_says_so(wire: Path) -> None:
    """Of modes that the scene fixes: exit code 3 as of ``solve``, a sentence, and words in header, README, manifest."""
    fixed = ("--set", "accuracy.modes=2", "--set", "accuracy.nodes=6")
    few = ("--no-error-estimate", "--range", "push.force.x=-2:2")
    done = cosserat("export", "wire.toml", "--output", "c", *fixed, "--set", "accuracy.tolerance=1e-6", *few, cwd=wire)
    assert done.returncode == 3, done.stdout + done.stderr
    said = " ".join(done.stderr.split())
    assert "does not keep the tolerance everywhere in the ranges: leave modes, nodes and rotation out" in said
    verified = json.loads((wire / "c" / "manifest.json").read_text())["verified"]
    assert verified["within_tolerance"] is False
    assert verified["error_estimate"] > 1e-6
    for file in ("README.md", "wire.h"):
        assert "The discretisation does not keep the tolerance there." in " ".join(
            (wire / "c" / file).read_text().split()
        )
    assert read_scene(wire / "c" / "scene.toml").accuracy.chosen_for is None


RANGED = {
    "export": ["export", "wire.toml", "--output", "out"],
    "view": ["view", "wire.toml", "--no-browser"],
    "check": ["check", "wire.toml"],
    "tune": ["tune", "wire.toml", "--output", "out"],
}
"""Commands that take ranges."""


@pytest.mark.parametrize("command", mostly_slow(RANGED, quick=["export", "view", "tune"]))
def test_ranges_are_refused_and_nothing_is_written(command: str, wire: Path) -> None:
    for text, sentence in (
        ("push.force.x=1:1", "two different ends"),
        ("push.force.x=1:-1", "the lower end first"),
        ("push.force.x=0:inf", "no two finite numbers"),
        ("pull.force.x=0:1", "is not an input or a parameter"),
        ("push.force.x=0:1:a", "no whole number of values"),
    ):
        refused = cosserat(*RANGED[command], "--range", text, cwd=wire)
        assert refused.returncode == 2, refused.stdout + refused.stderr
        assert sentence in " ".join(refused.stderr.split())
        assert "Refused: 1 problem." in refused.stderr
        assert not refused.stdout
        assert not (wire / "out").exists()
    twice = cosserat(*RANGED[command], "--range", "push.force.x=0:1", "--range", "push.force.x=0:2", cwd=wire)
    assert "'push.force.x' has two ranges" in " ".join(twice.stderr.split())


def test_check_says_which_ranges_are_asked_for(wire: Path) -> None:
    done = cosserat("check", "wire.toml", "--range", "push.force.x=-0.25:0.5", cwd=wire)
    assert done.returncode == 0, done.stderr
    (line,) = [line for line in done.stdout.splitlines() if "push.force.x=-0.25:0.5" in line]
    assert "asked for" in line


def test_a_solve_prints_what_acts_along_joints(tmp_path: Path) -> None:
    hinge = '[[joints]]\nname = "hinge"\nkind = "revolute"\nrod = "wire"\nat = 0\naxis = [0, 1, 0]\nstiffness = 0.5\n'
    (tmp_path / "wire.toml").write_text("schema = 1\n[accuracy]\nmodes = 4\nnodes = 8\n" + WIRE + hinge)
    done = cosserat("solve", "wire.toml", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    ((moment, angle),) = re.findall(r"hinge │ moment (\S+) N m │ angle (\S+) rad", done.stdout)
    assert float(moment) == pytest.approx(-0.5 * float(angle), rel=1e-4)
    assert float(angle) > 0.01


def test_check_and_solve_name_joints_that_hold_a_loop_in_its_plane_alone(tmp_path: Path) -> None:
    (tmp_path / "crank.toml").write_text(LOOPS["slider-crank"])
    (tmp_path / "slide.toml").write_text(LOOPS["slide at the tip"])
    flat, spatial = (cosserat("check", name, cwd=tmp_path) for name in ("crank.toml", "slide.toml"))
    assert flat.returncode == spatial.returncode == 0, flat.stderr + spatial.stderr
    note = "Note: end closes a loop in a plane and holds nothing across the plane"
    assert note in " ".join(flat.stdout.split())
    # The table of the solution has the loads that the note is about.
    assert note in " ".join(cosserat("solve", "crank.toml", cwd=tmp_path).stdout.split())
    assert "holds nothing across the plane" not in " ".join(spatial.stdout.split())
