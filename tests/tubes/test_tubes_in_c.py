"""Concentric tubes in C against those in Python: equilibria, derivatives, turns of a control loop, snaps, refusals."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import (
    ExportError,
    Outcome,
    Scene,
    SceneError,
    TubeSolution,
    export,
    follow,
    load,
    parse_scene,
    read_scene,
    solve,
)
from cosserat_casadi.codegen.compiled_results import CompiledSolution
from cosserat_casadi.codegen.plain import pointer
from cosserat_casadi.codegen.tubes.compiled import CompiledTubes
from cosserat_casadi.codegen.tubes.sources import TubeKernels
from cosserat_casadi.compiling.compiler import find_compiler
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.input_bounds import ranges_of_inputs
from cosserat_casadi.tubes.tube_functions import RESOLVED
from cosserat_casadi.tubes.tube_solution import tip_error
from cosserat_casadi.tubes.tube_solve import model_of, solution_near, solve_at
from tests.codegen.libraries import attempt
from tests.commands import cosserat
from tests.derivatives import central_differences
from tests.families import mostly_slow

EXAMPLES = Path(__file__).parents[2] / "examples"

DIFFERENCE = 1e-6

LIMITS = """
[ranges]
"push.force" = [[-1, 1], [-2, 2], [-3, 0]]
"inner.translation" = [0.1, 9.0]
[[bounds]]
input = "inner.rotation"
lower = -1.5
[[bounds]]
input = "push.force"
upper = [1, 0.5, 0]
"""


class Robot:
    """A robot in Python and in C, with the same steps."""

    def __init__(self, scene: Scene, folder: Path) -> None:
        self.scene = scene
        self.solution = solve(scene)
        error = self.solution.error_estimate
        self.folder = export(self.solution.model, folder, "robot", error_estimate=error, batches=True)
        compiled = load(folder)
        assert isinstance(compiled, CompiledTubes)
        self.compiled = compiled

    def in_python(self, found: CompiledSolution) -> TubeSolution:
        """The equilibrium in Python that one in C is near to."""
        robot = self.solution.robot
        x = found.x.copy()
        x[: robot.size] += robot.rotations(found.inputs)
        if x.size > robot.size:
            x[robot.size] += 1.0
        return solution_near(self.solution.model, found.inputs, x)

    def inputs(self, seed: int) -> np.ndarray:
        """Random rotations and translations, and loads like those of the scene."""
        random = np.random.default_rng(seed)
        robot = self.solution.robot
        inputs = robot.inputs.copy()
        inputs[: 2 * robot.size : 2] = random.uniform(-np.pi, np.pi, robot.size)
        inputs[1 : 2 * robot.size : 2] = random.uniform(0.0, 1.0, robot.size) * robot.length
        inputs[2 * robot.size :] *= random.uniform(0.0, 1.0, robot.inputs.size - 2 * robot.size)
        return inputs


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Robot:
    """Two tubes without loads."""
    return Robot(read_scene(EXAMPLES / "concentric_tubes.toml"), tmp_path_factory.mktemp("c") / "robot")


@pytest.fixture(scope="module")
def loaded_robot(tmp_path_factory: pytest.TempPathFactory) -> Robot:
    """Two tubes with a force at the tip and their weight, with ranges of their inputs."""
    text = (EXAMPLES / "loaded_tubes.toml").read_text() + LIMITS
    return Robot(parse_scene(text), tmp_path_factory.mktemp("c") / "robot")


def agrees(robot: Robot, found: CompiledSolution) -> None:
    """An equilibrium in C and its derivatives are those of Python."""
    assert found.converged, found.message
    expected = robot.in_python(found)
    assert expected.converged
    assert_allclose(found.determinant, expected.stability.determinant, rtol=1e-6, atol=0)
    sensitivity = robot.compiled.sensitivity(found.inputs, found.x)
    assert sensitivity is not None
    derivatives = sensitivity[1]
    tips = robot.compiled.poses(found.inputs, found.x)
    for index, (tube, tip) in enumerate(expected.tips.items()):
        assert_allclose(tips[tube][:3], tip.position, rtol=0, atol=1e-9)
        assert_allclose(abs(tips[tube][3:] @ tip.quaternion), 1.0, rtol=0, atol=1e-9)
        largest = np.abs(expected.tip_jacobian).max()
        assert_allclose(derivatives[tube][:3], expected.tip_jacobian[index, 3:], rtol=0, atol=1e-9 * largest)


@pytest.mark.parametrize("seed", mostly_slow(range(12), quick=range(4)))
def test_equilibria_are_those_of_python(robot: Robot, seed: int) -> None:
    found = robot.compiled.solve(robot.inputs(seed))
    agrees(robot, found)
    # Without loads both come from straight tubes in the same way.
    expected = solve(robot.scene, found.inputs)
    tips = robot.compiled.poses(found.inputs, found.x)
    assert_allclose(tips["inner"][:3], expected.tip("inner").position, rtol=0, atol=1e-6)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("which", ["robot", "loaded_robot"])
def test_the_error_is_told_by_half_of_the_steps(which: str, seed: int, request: pytest.FixtureRequest) -> None:
    """As Python tells it with a solve of both, at any inputs; steps of order eight leave far less than that."""
    made: Robot = request.getfixturevalue(which)
    found = made.compiled.solve(made.inputs(seed))
    assert found.converged
    exact = made.in_python(found)
    robot, steps = exact.robot, made.solution.model.steps
    half, double = (solution_near(model_of(robot, count), exact.inputs, exact.x) for count in (steps // 2, 2 * steps))
    assert found.error_estimate is not None
    # A step of Newton's method in place of a solve; what is found is right to 1e-11.
    assert_allclose(found.error_estimate, tip_error(half, exact), rtol=0.02, atol=1e-10)
    assert tip_error(exact, double) <= found.error_estimate + 1e-10
    assert found.within_tolerance is (found.error_estimate <= robot.tolerance)


def test_a_turn_leaves_the_error_to_a_call_of_its_own(loaded_robot: Robot) -> None:
    compiled = loaded_robot.compiled
    found = compiled.solve()
    turn = compiled.track(found.inputs + 0.01, found)
    assert turn.converged
    assert turn.error_estimate is None
    assert turn.within_tolerance is None
    again = compiled.solve(turn.inputs, turn.x)
    assert_allclose(compiled.error_estimate(turn.inputs, turn.x), again.error_estimate, rtol=1e-4, atol=1e-12)
    assert compiled.follow(found.inputs, turn.inputs, found.x).error_estimate is not None
    assert compiled.error_estimate(found.inputs + 0.3, found.x) is None


def test_batch_vs_single_solves(robot: Robot) -> None:
    """To the last digit, and a set of inputs out of its range is refused by itself."""
    compiled = robot.compiled
    rows = np.array([robot.inputs(seed) for seed in range(6)])
    rows[2, 1] = 10.0
    singles = [compiled.solve(inputs) for inputs in rows]
    batch = compiled.solve_batch(rows)
    assert sum(one.converged for one in batch) == 5
    assert batch[2].outcome is Outcome.OUT_OF_RANGE
    assert compiled.manifest["batches"] in (robot.folder / "robot.h").read_text()
    for one, single in zip(batch, singles, strict=True):
        assert one.outcome is single.outcome
        assert one.determinant == single.determinant
        if single.converged:
            assert_allclose(one.x, single.x, rtol=0, atol=0)


@pytest.mark.parametrize("reach", [(0.15, 0.15), (0.22, 0.0), (0.0, 0.3), (0.12, 0.26), (0.22, 0.32), (0.1, 0.14)])
def test_ends_that_coincide_or_lie_in_the_plate(robot: Robot, reach: tuple[float, float]) -> None:
    agrees(robot, robot.compiled.solve([0.4, reach[0], 1.9, reach[1]]))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(8))
def test_loaded_equilibria_are_those_of_python(loaded_robot: Robot, seed: int) -> None:
    agrees(loaded_robot, loaded_robot.compiled.solve(loaded_robot.inputs(seed)))


@pytest.mark.slow
def test_a_loaded_robot_in_c_snaps_where_it_does_in_python(loaded_robot: Robot) -> None:
    snap = follow(loaded_robot.scene, "inner.rotation", 9.0).events[0].value
    last, lost = turned(loaded_robot, 0.01)
    assert lost.outcome is Outcome.LOST_TRACK
    assert last.inputs[2] < snap < lost.inputs[2]
    assert lost.inputs[2] - last.inputs[2] < 0.011


def test_derivatives_vs_differences(robot: Robot) -> None:
    found = robot.compiled.solve()
    sensitivity = robot.compiled.sensitivity(found.inputs, found.x)
    assert sensitivity is not None

    def poses(inputs: FloatArray) -> FloatArray:
        of_tubes = robot.compiled.poses(inputs, robot.compiled.solve(inputs, found.x).x)
        return np.concatenate([of_tubes[tube] for tube in robot.compiled.tubes])

    exact = np.vstack([sensitivity[1][tube] for tube in robot.compiled.tubes])
    assert_allclose(exact, central_differences(poses, found.inputs, DIFFERENCE), rtol=0, atol=1e-7)


def turned(robot: Robot, step: float) -> tuple[CompiledSolution, CompiledSolution]:
    """The last solution while the inner tube is turned by steps, and what the turn after it says."""
    last = robot.compiled.solve()
    while last.inputs[2] < 9.0:
        inputs = last.inputs.copy()
        inputs[2] += step
        turn = robot.compiled.track(inputs, last, derivatives=last.inputs[2] > 5.0)
        if not turn.converged:
            return last, turn
        last = turn
    return last, last


@pytest.mark.slow
@pytest.mark.parametrize("step", [0.003, 0.05, 0.4])
def test_a_snap_is_not_followed(robot: Robot, step: float) -> None:
    snap = follow(robot.scene, "inner.rotation", 9.0).events[0].value
    last, lost = turned(robot, step)
    assert lost.outcome is Outcome.LOST_TRACK
    assert last.inputs[2] < snap < lost.inputs[2]
    assert lost.inputs[2] - last.inputs[2] < 1.001 * step
    assert last.determinant > 0.0
    assert_allclose(lost.x, last.x, rtol=0, atol=0)
    # Memory and unknowns are as they were: the robot turns back from there.
    back = last.inputs.copy()
    back[2] -= step
    agrees(robot, robot.compiled.track(back, last))
    beyond = robot.compiled.follow(last.inputs, lost.inputs, last.x)
    assert beyond.outcome is Outcome.LOAD_STALLED
    assert beyond.load_factor < 1.0
    # From straight tubes there is another equilibrium at the same inputs.
    agrees(robot, robot.compiled.solve(lost.inputs))


def test_turns_go_where_the_order_of_ends_changes(robot: Robot) -> None:
    """The inner tube is drawn into the outer one and pushed out again: its tip and its bend pass those of the other."""
    last = robot.compiled.solve([0.0, 0.13, 1.0, 0.26])
    agrees(robot, last)
    way = np.concatenate([np.linspace(0.26, 0.05, 41), np.linspace(0.05, 0.26, 41)])
    for translation in way:
        turn = robot.compiled.track([0.0, 0.13, 1.0, translation], last)
        assert turn.converged
        assert turn.derivatives is not None
        last = turn
    agrees(robot, last)
    assert_allclose(last.x, robot.compiled.solve(last.inputs).x, rtol=0, atol=1e-9)


def test_a_turn_of_all_drives_takes_no_step(robot: Robot) -> None:
    found = robot.compiled.solve()
    turn = robot.compiled.track(found.inputs + np.array([0.7, 0.0, 0.7, 0.0]), found)
    assert turn.converged
    assert turn.iterations == 0
    assert_allclose(turn.x, found.x, rtol=0, atol=0)


def test_the_work_of_a_turn_is_bounded(robot: Robot) -> None:
    found = robot.compiled.solve()
    far = found.inputs + np.array([0.0, 0.05, 1.5, -0.1])
    short = robot.compiled.track(far, found, max_iterations=2, max_continuation_steps=1)
    assert short.outcome is Outcome.LOST_TRACK
    assert short.iterations <= 4
    assert_allclose(short.x, found.x, rtol=0, atol=0)


@pytest.mark.parametrize("translation", [-0.01, 0.33])
def test_translations_out_of_range_are_refused(robot: Robot, translation: float) -> None:
    found = robot.compiled.solve()
    inputs = found.inputs.copy()
    inputs[3] = translation
    assert robot.compiled.solve(inputs).outcome is Outcome.OUT_OF_RANGE
    assert robot.compiled.follow(found.inputs, inputs, found.x).outcome is Outcome.OUT_OF_RANGE
    turn = robot.compiled.track(inputs, found)
    assert turn.outcome is Outcome.OUT_OF_RANGE
    assert_allclose(turn.x, found.x, rtol=0, atol=0)


@pytest.mark.parametrize(
    ("inputs", "clamped"),
    [
        ([9.0, 0.13, -9.0, 0.2], [9.0, 0.13, -9.0, 0.2]),
        ([0.0, 0.0, 0.0, 0.32], [0.0, 0.0, 0.0, 0.32]),
        ([0.0, 0.23, 0.0, -1e-9], [0.0, 0.22, 0.0, 0.0]),
        ([0.0, 1e300, 1e300, 0.4], [0.0, 0.22, 1e300, 0.32]),
    ],
)
def test_translations_have_ranges_in_c_and_in_python(robot: Robot, inputs: list[float], clamped: list[float]) -> None:
    """From zero to the length of the tube, 0.22 and 0.32 m, at both of which the solver still solves."""
    moved = np.array(inputs)
    inside = bool(robot.compiled._function("in_range")(pointer(moved)))
    count = robot.compiled._function("clamp")(pointer(moved))
    assert inside == robot.compiled.in_range(inputs) == (inputs == clamped)
    assert count == np.count_nonzero(moved != inputs)
    assert_allclose(moved, clamped, rtol=1e-15, atol=0)
    assert_allclose(robot.compiled.clamp(inputs), moved, rtol=0, atol=0)
    assert robot.compiled.solve(moved).outcome is not Outcome.OUT_OF_RANGE


def test_bounds_and_ranges_of_the_scene_are_those_of_the_inputs(loaded_robot: Robot) -> None:
    """In Python and in C, of drives and loads; no range leads a tube beyond its length."""
    layout = loaded_robot.solution.robot.layout
    lower, upper = ranges_of_inputs(loaded_robot.scene, layout)
    inner = loaded_robot.solution.robot.names.index("inner")
    length = loaded_robot.solution.robot.length[inner]
    for name, low, high in (
        ("inner.rotation", [-1.5], [np.inf]),
        ("inner.translation", [0.1], [length]),
        ("outer.rotation", [-np.inf], [np.inf]),
        ("push.force", [-1, -2, -3], [1, 0.5, 0]),
    ):
        assert_allclose(lower[layout.slices[name]], low, rtol=1e-15, atol=0)
        assert_allclose(upper[layout.slices[name]], high, rtol=1e-15, atol=0)
    compiled = loaded_robot.compiled
    beyond = {"inner.rotation": -2.0, "inner.translation": 0.05, "push.force": [0.0, 3.0, -4.0]}
    moved = layout.pack(beyond)
    clamped = layout.pack({"inner.rotation": -1.5, "inner.translation": 0.1, "push.force": [0.0, 0.5, -3.0]})
    assert not compiled.in_range(moved)
    assert not compiled._function("in_range")(pointer(moved))
    assert_allclose(compiled.clamp(beyond), clamped, rtol=1e-15, atol=0)
    assert compiled._function("clamp")(pointer(moved)) == 4
    assert_allclose(moved, clamped, rtol=1e-15, atol=0)
    assert compiled.in_range(moved)
    kept = parse_scene((loaded_robot.folder / "scene.toml").read_text())
    assert kept.bounds == loaded_robot.scene.bounds
    assert kept.ranges == loaded_robot.scene.ranges


@pytest.mark.parametrize(
    ("table", "sentence"),
    [
        ('[ranges]\n"outer.push" = [0, 1]', "is not free at run time"),
        ('[ranges]\n"outer.rotation" = [[0, 1], [0, 1]]', "must have 1 pair"),
        ('[ranges]\n"outer.rotation" = [1, 1]', "two different ends"),
        ('[[bounds]]\ninput = "outer.rotation"\nlower = [0, 1]', "must have 1 number"),
        ('[[bounds]]\ninput = "middle.rotation"\nlower = 0', "is not free at run time"),
        ("inputs = []", "beside tubes may stand title, accuracy, parameters, loads, ranges, bounds"),
    ],
)
def test_limits_of_no_input_of_tubes_are_refused(table: str, sentence: str) -> None:
    text = (EXAMPLES / "loaded_tubes.toml").read_text()
    first, _, rest = text.partition("\n")
    with pytest.raises(SceneError, match=sentence):
        parse_scene(f"{first}\n{table}\n{rest}" if table.startswith("inputs") else f"{text}\n{table}\n")


def test_other_inputs_without_an_equilibrium(robot: Robot) -> None:
    assert robot.compiled.solve([0.0, 0.0, 0.0, 0.0]).outcome is Outcome.OUT_OF_RANGE
    assert robot.compiled.solve([np.nan, 0.1, 0.0, 0.2]).outcome is Outcome.NOT_FINITE
    assert robot.compiled.solve([0.1, np.nan, 0.0, 0.2]).outcome is not Outcome.CONVERGED
    found = robot.compiled.solve()
    assert robot.compiled.sensitivity(found.inputs + np.array([0.0, 0.0, 0.3, 0.0]), found.x) is None


def test_an_unstable_equilibrium_has_a_negative_determinant(robot: Robot) -> None:
    opposed = robot.compiled.solve([0.0, 0.13, np.pi, 0.2])
    assert opposed.converged
    assert opposed.determinant < 0.0
    assert not robot.in_python(opposed).stable


@pytest.mark.parametrize("turn", mostly_slow([3.0, 3.1, 3.14], quick=[3.14]))
@pytest.mark.parametrize("reach", mostly_slow([0.14, 0.16, 0.24], quick=[0.16]))
def test_nearly_opposed_tubes_bend_to_the_side_they_are_turned_to(robot: Robot, turn: float, reach: float) -> None:
    """The branch from straight tubes is the one that a robot is on which was turned there from aligned ones."""
    inputs = {"inner.rotation": turn, "inner.translation": reach}
    turned_there = robot.compiled.solve([0.0, 0.13, 0.0, reach])
    for rotation in np.linspace(0.0, turn, 60)[1:]:
        turned_there = robot.compiled.track([0.0, 0.13, rotation, reach], turned_there, derivatives=False)
        assert turned_there.converged
    found = robot.compiled.solve([0.0, 0.13, turn, reach])
    assert_allclose(found.x, turned_there.x, rtol=0, atol=1e-8)
    assert found.determinant > 0.0
    in_python = solve(robot.scene, inputs)
    assert in_python.stable
    assert_allclose(in_python.x - in_python.robot.rotations(in_python.inputs), found.x, rtol=0, atol=1e-5)


def test_too_few_steps_are_told(robot: Robot) -> None:
    """Two steps a piece are enough for some inputs only: those within tolerance of many steps, and not all of them."""
    tubes = robot.solution.robot
    halved_residual = TubeKernels(model_of(tubes, 2), "k").all()[3]
    assert halved_residual.name() == "k_halved_residual"
    enough = []
    for seed in range(16):
        inputs = robot.inputs(seed)
        inputs[1::2] = (0.5 + seed / 32) * tubes.length
        few = solve_at(model_of(tubes, 2), inputs)
        twist = few.x - tubes.rotations(inputs)
        missed = np.abs(halved_residual(twist, inputs).full()).max()
        enough.append(missed <= RESOLVED * tubes.tolerance)
        many = solution_near(model_of(tubes, 16), inputs, few.x)
        if enough[-1]:
            assert tip_error(few, many) <= tubes.tolerance
    assert 3 < sum(enough) < 13


def test_the_demo_prints_what_python_finds(robot: Robot, tmp_path: Path) -> None:
    sources = ["robot_demo.c", "robot.c", "robot_kernels.c"]
    demo = tmp_path / "demo"
    command = [find_compiler(), "-O0", "-std=c99", "-Wall", "-Werror", *sources, "-lm", "-o", str(demo)]
    subprocess.run(command, cwd=robot.folder, check=True)
    said = json.loads(subprocess.run([demo], check=True, capture_output=True, text=True).stdout)
    assert said["status"] == "converged"
    assert_allclose(said["tips"][1], robot.solution.tip("inner").position, rtol=0, atol=1e-9)
    refused = subprocess.run([demo, "0", "0.1", "x", "0"], check=False, capture_output=True, text=True)
    assert refused.returncode == 2
    far = subprocess.run([demo, "0", "0.1", "0", "0.4"], check=False, capture_output=True, text=True)
    assert far.returncode == 3
    assert json.loads(far.stdout)["status"] == "out_of_range"


def test_refusals(robot: Robot, tmp_path: Path) -> None:
    with pytest.raises(ExportError, match="no name for a C library"):
        export(robot.solution.model, tmp_path / "folder", "a b")
    with pytest.raises(
        ExportError, match=r"--derivatives: needs a scene of rods(?s:.*)--period: needs a scene of rods"
    ):
        export(robot.solution.model, tmp_path / "folder", derivatives=True, batches=True, period=1e-3)
    (tmp_path / "manifest.json").write_text('{"name": "robot", "inputs": [], "files": [], "tubes": [3], "unknowns": 2}')
    with pytest.raises(ExportError, match="is not the manifest of an exported folder"):
        load(tmp_path)
    with pytest.raises(ValueError, match="both max_iterations"):
        robot.compiled.track(robot.compiled.defaults, robot.compiled.solve(), max_iterations=3)


@pytest.mark.slow
def test_on_the_command_line(tmp_path: Path) -> None:
    scene = tmp_path / "robot.toml"
    scene.write_text((EXAMPLES / "concentric_tubes.toml").read_text(encoding="utf-8"), encoding="utf-8")
    folder = tmp_path / "robot"
    refused = cosserat("export", "robot.toml", "--output", "robot", "--dynamics", "--stability", cwd=tmp_path)
    assert refused.returncode == 2
    assert "--dynamics: needs a scene of rods" in refused.stderr
    assert "--stability: needs a scene of rods" in refused.stderr
    assert not folder.exists()
    written = cosserat("export", "robot.toml", "--output", "robot", "--batches", cwd=tmp_path)
    assert written.returncode == 0, written.stderr
    assert "4 steps a piece" in written.stdout
    described = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))
    assert described["tubes"] == ["outer", "inner"]
    assert sorted(path.name for path in folder.iterdir()) == described["files"]
    assert parse_scene((folder / "scene.toml").read_text(encoding="utf-8")).tubes


def test_float_is_refused(robot: Robot) -> None:
    """Kernels in float beside tables in double made a converged status of garbage."""
    done = attempt("gcc", "-fsyntax-only", "-DROBOT_SINGLE", robot.folder / "robot.c")
    assert done.returncode != 0
    assert "in double alone" in done.stderr
