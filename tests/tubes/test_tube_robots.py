"""Robots of several tubes: shape, energy, derivatives, order of ends, against integration and differences."""

from __future__ import annotations

import json
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from cosserat_casadi import Scene, SceneError, TubeSolution, all_equilibria, build, follow, parse_scene, solve
from cosserat_casadi.model.input_bounds import ranges_of_inputs
from cosserat_casadi.tubes import tube_equilibria
from cosserat_casadi.tubes.robot import robot_of
from cosserat_casadi.tubes.tube_solution import tip_error
from cosserat_casadi.tubes.tube_solve import solution_near
from tests.commands import cosserat
from tests.tubes.functions_in_c import check_functions_in_c
from tests.tubes.shooting import shot

TWO = """
schema = 1
title = "Two tubes"
accuracy = { tolerance = 1e-8 }
[[tubes]]
name = "outer"
stiffness = { bending = 0.06, torsion = 0.045 }
straight = 0.05
curved = 0.15
curvature = 10.0
rotation = 0.3
translation = 0.18
[[tubes]]
name = "inner"
stiffness = { bending = 0.03, torsion = 0.022 }
straight = 0.1
curved = 0.2
curvature = 14.0
rotation = 2.0
translation = 0.24
"""

THREE = (
    TWO
    + """
[[tubes]]
name = "innermost"
stiffness = { bending = 0.012, torsion = 0.01 }
straight = 0.2
curved = 0.15
curvature = -20.0
rotation = -1.0
translation = 0.3
"""
)

DIFFERENCE = 1e-6


def test_ranges_of_inputs() -> None:
    """A translation goes from zero to the length of its tube; rotations and loads have no range."""
    scene = parse_scene(TWO + '[[loads]]\nname = "push"\nkind = "tip_wrench"\nrod = "inner"\nforce = [0, 1, 0]\n')
    lower, upper = ranges_of_inputs(scene, robot_of(scene).layout)
    assert_array_equal(lower, [-np.inf, 0, -np.inf, 0, *[-np.inf] * 3])
    assert_array_equal(upper, [np.inf, 0.05 + 0.15, np.inf, 0.1 + 0.2, *[np.inf] * 3])


@pytest.mark.parametrize(
    "inputs",
    [
        pytest.param({}, marks=pytest.mark.slow),
        pytest.param({"innermost.translation": 0.1}, marks=pytest.mark.slow),
        {"outer.translation": 0.05, "inner.translation": 0.29, "innermost.translation": 0.12},
        pytest.param({"outer.translation": 0.0, "inner.rotation": 4.0}, marks=pytest.mark.slow),
    ],
)
def test_three_tubes_whatever_the_order_of_their_ends(inputs: dict[str, float]) -> None:
    found = solve(parse_scene(THREE), inputs)
    assert found.converged
    assert found.error_estimate is not None
    assert found.error_estimate <= 1e-8
    truth = shot(found)
    assert_allclose(found.shape.torques[0], truth.torques, rtol=0, atol=1e-8)
    assert_allclose(found.x, truth.angles, rtol=0, atol=1e-7)
    assert_allclose(found.tip().position, truth.position, rtol=0, atol=1e-8)
    assert_allclose(found.energy, truth.energy, rtol=1e-8, atol=0)
    # At the drives.
    inside = robot_of(parse_scene(THREE)).length - found.inputs[1::2]
    at_drives = found.shape.angles[0] - inside / found.robot.torsion * found.shape.torques[0]
    assert_allclose(at_drives, found.inputs[::2], rtol=0, atol=1e-10)
    # No moment leaves the robot.
    assert_allclose(found.shape.torques.sum(axis=1), 0.0, rtol=0, atol=1e-14)


def test_tips_of_shorter_tubes_lie_on_the_centre_line() -> None:
    found = solve(parse_scene(THREE))
    shape = found.shape
    assert_allclose(shape.distance[0], 0.0, rtol=0, atol=0)
    assert_allclose(shape.distance[-1], 0.3, rtol=0, atol=1e-15)
    for name, reach in zip(found.robot.names, found.inputs[1::2], strict=True):
        station = int(np.argmin(np.abs(shape.distance - reach)))
        assert_allclose(found.tip(name).position, shape.position[station], rtol=0, atol=1e-12)


def test_aligned_tubes_are_arcs() -> None:
    found = solve(parse_scene(TWO), {"outer.rotation": 0.7, "inner.rotation": 0.7})
    assert found.stable
    assert_allclose(found.x, 0.7, rtol=0, atol=1e-14)
    robot = found.robot
    # Curved: the outer tube from 0.03 m to its end, the inner one from 0.04 m on.
    both = float(robot.bending @ robot.curvature / robot.bending.sum())
    one = float(robot.bending[0] * robot.curvature[0] / robot.bending.sum())
    x, z, angle = 0.0, 0.0, 0.0
    for curvature, length in ((0.0, 0.03), (one, 0.01), (both, 0.14), (14.0, 0.06)):
        end = angle + curvature * length
        if curvature == 0.0:
            z += length
        else:
            x += (np.cos(angle) - np.cos(end)) / curvature
            z += (np.sin(end) - np.sin(angle)) / curvature
        angle = end
    expected = [x * np.cos(0.7), x * np.sin(0.7), z]
    assert_allclose(found.tip("inner").position, expected, rtol=0, atol=1e-12)
    tangent = found.tip("inner").rotation[:, 2]
    assert_allclose(tangent, [np.sin(angle) * np.cos(0.7), np.sin(angle) * np.sin(0.7), np.cos(angle)], atol=1e-12)


def moved(found: TubeSolution, index: int, by: float) -> TubeSolution:
    inputs = found.inputs.copy()
    inputs[index] += by
    return solution_near(found.model, inputs, found.x)


def check_tips(found: TubeSolution, index: int, ahead: TubeSolution, behind: TubeSolution, turns: float) -> None:
    """Hold derivatives of tips by an input to differences of two solutions, those of rotations to ``turns``."""
    for tube, name in enumerate(found.robot.names):
        column = found.tip_jacobian[tube, :, index]
        position = (ahead.tip(name).position - behind.tip(name).position) / (2 * DIFFERENCE)
        turn = (ahead.tip(name).rotation - behind.tip(name).rotation) / (2 * DIFFERENCE)
        spin = turn @ found.tip(name).rotation.T
        assert_allclose(column[3:], position, rtol=0, atol=1e-7)
        assert_allclose(column[:3], [spin[2, 1], spin[0, 2], spin[1, 0]], rtol=0, atol=turns)


@pytest.mark.parametrize("inputs", [{}, {"innermost.translation": 0.1}])
def test_tip_jacobian_vs_differences(inputs: dict[str, float]) -> None:
    found = solve(parse_scene(THREE), inputs)
    for index in range(found.inputs.size):
        ahead, behind = (moved(found, index, by) for by in (DIFFERENCE, -DIFFERENCE))
        check_tips(found, index, ahead, behind, 1e-6)


@pytest.mark.parametrize(
    "loads", ["", "[[loads]]\nname='push'\nkind='tip_wrench'\nrod='inner'\nforce=[0.1, 0.2, 0.0]\n"]
)
def test_tip_jacobian_where_two_tubes_end_at_one_place(loads: str) -> None:
    """There the derivative is that of one order of the ends: the tube that is named first reaches farther."""
    found = solve(parse_scene(TWO + loads), {"outer.translation": 0.19, "inner.translation": 0.19})
    for index, by in ((1, DIFFERENCE), (3, -DIFFERENCE)):
        shifted = moved(found, index, by)
        for tube, name in enumerate(found.robot.names):
            position = (shifted.tip(name).position - found.tip(name).position) / by
            assert_allclose(found.tip_jacobian[tube, 3:, index], position, rtol=0, atol=2e-5)


def test_equilibrium_is_an_expression() -> None:
    found = solve(parse_scene(TWO))
    model = found.model
    start, inputs = ca.MX.sym("start", 2), ca.MX.sym("inputs", 4)
    x, _ = model.equilibrium(start, inputs)
    position, _ = model.tips(x, inputs)
    derivative = ca.Function("derivative", [start, inputs], [ca.jacobian(ca.vec(position), inputs)])
    by_casadi = derivative(found.x + 0.05, found.inputs).full().reshape(2, 3, 4)
    assert_allclose(by_casadi, found.tip_jacobian[:, 3:], rtol=0, atol=1e-11)
    x, missed = model.equilibrium(found.x + 0.05, found.inputs)
    assert_allclose(x.full()[:, 0], found.x, rtol=0, atol=1e-11)
    assert float(missed) < 1e-11
    # What was not found says so.
    _, missed = model.equilibrium(found.x, [np.nan, 0.1, 0.0, 0.2])
    assert np.isnan(float(missed))


def test_functions_in_c(tmp_path: Path) -> None:
    found = solve(parse_scene(TWO))
    check_functions_in_c(found, tmp_path, 0.05)


def test_torque_of_a_drive_is_the_rate_of_the_energy() -> None:
    found = solve(parse_scene(THREE))
    for tube in range(found.robot.size):
        ahead = moved(found, 2 * tube, DIFFERENCE)
        behind = moved(found, 2 * tube, -DIFFERENCE)
        rate = (ahead.energy - behind.energy) / (2 * DIFFERENCE)
        assert_allclose(rate, -found.shape.torques[0, tube], rtol=0, atol=1e-7)


@pytest.mark.slow
def test_a_straight_third_tube_only_stiffens() -> None:
    scene = parse_scene(THREE, ["innermost.curvature=0.0", "innermost.translation=0.2", "accuracy.tolerance=1e-6"])
    inputs = {"inner.rotation": 3.4}
    found = all_equilibria(scene, inputs)
    assert found.complete
    # It turns freely: the other two have as many equilibria as without it, a little stiffer.
    alone = all_equilibria(parse_scene(TWO, ["accuracy.tolerance=1e-6"]), inputs)
    assert alone.complete
    assert len(found.solutions) == len(alone.solutions) == 3
    assert [solution.stable for solution in found.solutions] == [True, True, False]
    for solution in found.solutions:
        assert_allclose(solution.x[2], -1.0, rtol=0, atol=1e-12)


@pytest.mark.slow
def test_a_search_that_ran_out_of_work_is_not_complete(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = parse_scene(TWO, ["accuracy.tolerance=1e-6"])
    monkeypatch.setattr(tube_equilibria, "MOST_STEPS", 16)
    assert all_equilibria(scene).complete
    monkeypatch.setattr(tube_equilibria, "MOST_EVALUATIONS", tube_equilibria.FIRST_INTERVALS + 1)
    found = all_equilibria(scene)
    # Nothing is missing, and the signs add up: but nobody has looked closely enough to know.
    assert sum(np.sign(solution.stability.determinant) for solution in found.solutions) == 1
    assert not found.complete
    assert "may be missing" in found.message
    # One grid alone has not shown that a finer one finds nothing else.
    monkeypatch.setattr(tube_equilibria, "GRIDS", {3: (2,)})
    found = all_equilibria(parse_scene(THREE, ["accuracy.tolerance=1e-6"]))
    assert found.solutions
    assert not found.complete


def test_a_search_that_found_nothing_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tube_equilibria, "MOST_STEPS", 8)
    monkeypatch.setattr(tube_equilibria, "GRIDS", {3: ()})
    (tmp_path / "tubes.toml").write_text(THREE)
    ended = cosserat("solve", "tubes.toml", "--all", "--output", "o.json", "--plot", "o.png", cwd=tmp_path)
    assert ended.returncode == 3, ended.stderr
    assert "No equilibrium was found" in " ".join(ended.stdout.split())
    data = json.loads((tmp_path / "o.json").read_text())
    assert data["equilibria"] == []
    assert data["complete"] is False
    assert not (tmp_path / "o.png").exists()


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_no_start_leads_to_an_equilibrium_that_was_not_found(seed: int) -> None:
    generator = np.random.default_rng(seed)
    scene = parse_scene(THREE, ["accuracy.tolerance=1e-6"])
    rotations = generator.uniform(-np.pi, np.pi, 3)
    inputs = robot_of(scene).inputs.copy()
    inputs[::2] = rotations
    found = all_equilibria(scene, inputs)
    assert found.complete
    assert len(found.solutions) % 2 == 1
    model = found.solutions[0].model
    known = np.array([solution.x for solution in found.solutions])
    reached = 0
    for _ in range(300):
        end = solution_near(model, inputs, rotations + generator.uniform(-4.0, 4.0, 3))
        if end.converged:
            reached += 1
            assert np.abs(known - end.x).max(axis=1).min() < 1e-6
    assert reached > 60


def test_error_of_the_tips_is_relative_to_the_length_outside() -> None:
    scene = parse_scene(TWO.partition('[[tubes]]\nname = "inner"')[0], ["outer.curvature=0.0"])
    exact = solve(scene, {"outer.translation": 0.2})
    found = solve(scene, {"outer.translation": 0.18})
    assert_allclose(tip_error(found, exact), 0.02 / 0.2, rtol=1e-12, atol=0)
    turned = solve(scene, {"outer.translation": 0.2, "outer.rotation": 0.35})
    assert_allclose(tip_error(turned, exact), 0.05, rtol=1e-12, atol=0)


def test_a_common_turn_turns_the_robot() -> None:
    scene = parse_scene(TWO)
    found = solve(scene)
    turned = solve(scene, found.inputs + np.array([0.5, 0, 0.5, 0]))
    c, s = np.cos(0.5), np.sin(0.5)
    about_z = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    assert_allclose(turned.tip().position, about_z @ found.tip().position, rtol=0, atol=1e-12)
    assert_allclose(turned.energy, found.energy, rtol=1e-12, atol=0)


def test_path_over_a_translation_passes_where_the_order_changes() -> None:
    scene = parse_scene(TWO, ["accuracy.tolerance=1e-6"])
    path = follow(scene, "inner.translation", 0.05)
    assert path.converged
    assert path.stable.all()
    assert not path.events
    end = solve(scene, {"inner.translation": 0.05})
    assert_allclose(path.tip("inner").position[-1], end.tip("inner").position, rtol=0, atol=1e-8)


def test_one_tube() -> None:
    scene = parse_scene(TWO.partition('[[tubes]]\nname = "inner"')[0])
    found = all_equilibria(scene)
    assert found.complete
    assert len(found.solutions) == 1
    assert found.solutions[0].stable
    assert_allclose(found.solutions[0].x, 0.3, rtol=0, atol=0)


MATERIAL = "material = { youngs_modulus = 6e10, poisson_ratio = 0.33 }"


def with_sections(outer: str, inner: str) -> str:
    text = TWO.replace("stiffness = { bending = 0.06, torsion = 0.045 }", f"{MATERIAL}\nsection = {{ {outer} }}")
    return text.replace("stiffness = { bending = 0.03, torsion = 0.022 }", f"{MATERIAL}\nsection = {{ {inner} }}")


def test_stiffness_of_a_section() -> None:
    text = with_sections("outer_radius = 1.2e-3, inner_radius = 1e-3", "outer_radius = 1e-3, inner_radius = 0.0")
    robot = robot_of(parse_scene(text))
    moment = np.pi / 4 * np.array([1.2e-3**4 - 1e-3**4, 1e-3**4])
    assert_allclose(robot.bending, 6e10 * moment, rtol=1e-14, atol=0)
    assert_allclose(robot.torsion, 6e10 / 2.66 * 2 * moment, rtol=1e-14, atol=0)


ROD = """
[[rods]]
name = "rod"
length = 1.0
strain = "planar"
stiffness = { bending_y = 1.0 }
"""


@pytest.mark.parametrize(
    ("text", "where"),
    [
        (TWO.replace("translation = 0.18", "translation = 0.21"), ["tubes[0].translation"]),
        (TWO.replace("translation = 0.18", "translation = -0.1"), ["tubes[0].translation"]),
        (TWO.replace("curved = 0.15", "curved = -1.0"), ["tubes[0].curved"]),
        (TWO.replace("0.18", "0.0").replace("0.24", "0.0"), ["tubes[0].translation"]),
        (TWO.replace("straight = 0.05\ncurved = 0.15", "straight = 0.0\ncurved = 0.0"), ["tubes[0].curved"]),
        (TWO.replace('"inner"', '"outer"'), ["tubes[1].name"]),
        (TWO.replace("stiffness = { bending = 0.03, torsion = 0.022 }", ""), ["tubes[1].material", "tubes[1].section"]),
        (TWO.replace("0.03,", "0.0,"), ["tubes[1].stiffness.bending"]),
        (TWO + ROD, ["rods"]),
        ('inputs = ["inner.rotation"]\n' + TWO, ["inputs"]),
        (TWO.replace("accuracy = {", "accuracy = { modes = 4,"), ["accuracy.modes"]),
        ("schema = 1", ["rods"]),
        (
            with_sections("outer_radius = 1.2e-3, inner_radius = 0.8e-3", "outer_radius = 1e-3, inner_radius = 0.0"),
            ["tubes[1].section.outer_radius"],
        ),
        (
            with_sections("outer_radius = 1.2e-3, inner_radius = 1.3e-3", "outer_radius = 1e-3, inner_radius = 0.0"),
            ["tubes[0].section.inner_radius"],
        ),
    ],
)
def test_refused_scenes(text: str, where: list[str]) -> None:
    with pytest.raises(SceneError) as refused:
        parse_scene(text)
    assert [problem.where for problem in refused.value.problems] == where


@pytest.mark.parametrize(
    ("inputs", "problem"),
    [
        ({"inner.rotation": np.nan}, "inner.rotation: must be finite"),
        ({"inner.translation": 0.31}, "inner.translation: must be from 0 to the length"),
        ({"inner.turn": 1.0}, "inner.turn: is no input"),
        ({"inner.rotation": [1.0, 2.0]}, "inner.rotation: must be a number"),
        ([0.0, 0.1, 0.0], "inputs: must be 4 numbers"),
        ({"inner.translation": 0.0, "outer.translation": 0.0}, "no tube stands out"),
    ],
)
def test_refused_inputs(inputs: dict[str, float], problem: str) -> None:
    with pytest.raises(SceneError, match=problem):
        solve(parse_scene(TWO), inputs)


def test_what_works_on_rods_refuses_tubes() -> None:
    scene: Scene = parse_scene(TWO)
    with pytest.raises(SceneError, match="works on rods"):
        build(scene)
    with pytest.raises(SceneError, match="the scene has none"):
        all_equilibria(parse_scene("schema = 1" + ROD))


@pytest.mark.slow
def test_files_hold_what_python_says(tmp_path: Path) -> None:
    scene = tmp_path / "tubes.toml"
    scene.write_text(TWO.replace("1e-8", "1e-3"))
    read = parse_scene(scene.read_text())
    ended = cosserat("solve", "tubes.toml", "--json", cwd=tmp_path)
    assert ended.returncode == 0
    assert json.loads(ended.stdout) == solve(read).to_dict()
    ended = cosserat("solve", "tubes.toml", "--all", "--output", "all.json", "--plot", "all.png", cwd=tmp_path)
    assert ended.returncode == 0
    assert "2 of them stable" in ended.stdout
    data = json.loads((tmp_path / "all.json").read_text())
    assert data == all_equilibria(read).to_dict()
    assert data["complete"]
    assert (tmp_path / "all.png").stat().st_size > 10_000
    line = ("path", "tubes.toml", "--input", "inner.rotation", "--to", "6", "--csv", "p.csv", "--plot", "p.svg")
    ended = cosserat(*line, "--output", "p.json", "--animation", "p.gif", cwd=tmp_path)
    assert ended.returncode == 0
    assert "limit" in ended.stdout
    assert "p.gif" in ended.stdout and (tmp_path / "p.gif").read_bytes()[:3] == b"GIF"
    path = follow(read, "inner.rotation", 6.0)
    assert json.loads((tmp_path / "p.json").read_text()) == path.to_dict()
    rows = np.genfromtxt(tmp_path / "p.csv", delimiter=",", names=True, dtype=None, encoding=None)
    assert_allclose(rows["innerrotation"], path.values, rtol=0, atol=0)
    assert_allclose(rows["innertipz"], path.tip("inner").position[:, 2], rtol=0, atol=0)
    assert cosserat("check", "tubes.toml", cwd=tmp_path).returncode == 0


def test_unstable_robots_are_told(tmp_path: Path) -> None:
    scene = tmp_path / "tubes.toml"
    scene.write_text(TWO.replace("1e-8", "1e-5"))
    opposed = ("solve", "tubes.toml", "--set", f"inner.rotation={0.3 + np.pi}")
    ended = cosserat(*opposed, cwd=tmp_path)
    assert ended.returncode == 0
    assert "not stable" in ended.stderr
    ended = cosserat(*opposed, "--stable", "--json", cwd=tmp_path)
    assert ended.returncode == 0
    assert json.loads(ended.stdout)["stable"] is True


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("simulate tubes.toml --output out.csv", "works on rods"),
        ("modes tubes.toml --output out.json", "works on rods"),
        ("inverse tubes.toml --output out.json", "targets: missing"),
        ("identify tubes.toml --output out.json", "name what is to be found"),
        ("estimate tubes.toml --output out.csv", "works on rods"),
        ("sweep tubes.toml --output out.csv --over t.csv --set tubes[1].translation=9", "must be at most the length"),
        ("export tubes.toml --output out --dynamics", "needs a scene of rods"),
        ("export tubes.toml --page out.html", "needs a scene of rods"),
        ("tune tubes.toml --output out.toml --range inner.rotation=0:1", "works on rods"),
        ("view tubes.toml --range inner.rotation=0:1", "works on rods"),
        ("path tubes.toml --input inner.rotation --to 3 --branch --output out.json", "needs a scene of rods"),
        ("path tubes.toml --input inner.turn --to 3 --output out.json", "--input: 'inner.turn' is no input"),
        ("path tubes.toml --input inner.rotation --to [3,4] --output out.json", "must be one number"),
        ("path tubes.toml --input inner.rotation --to 2.0 --output out.json", "where the path begins"),
        ("path tubes.toml --input inner.translation --to 1.0 --output out.json", "to the length of the tube"),
        ("check tubes.toml --time", "times the effects of rods"),
        ("solve tubes.toml --all --stable --output out.json", "cannot go with --all"),
        ("solve tubes.toml --exact-contact --output out.json", "needs a scene of rods"),
    ],
)
def test_commands_that_refuse(line: str, words: str, tmp_path: Path) -> None:
    (tmp_path / "tubes.toml").write_text(TWO)
    (tmp_path / "t.csv").write_text("inner.rotation\n1.0\n")
    ended = cosserat(*line.split(), cwd=tmp_path)
    assert ended.returncode == 2, ended.stdout + ended.stderr
    assert words in " ".join(ended.stderr.split())
    assert sorted(file.name for file in tmp_path.iterdir()) == ["t.csv", "tubes.toml"]


def test_all_is_for_tubes(tmp_path: Path) -> None:
    (tmp_path / "rod.toml").write_text("schema = 1" + ROD)
    ended = cosserat("solve", "rod.toml", "--all", "--output", "out", cwd=tmp_path)
    assert ended.returncode == 2
    assert "--all: needs a scene of concentric tubes" in ended.stderr
    assert not (tmp_path / "out").exists()
