"""The error of an answer in exported C: that of Python, at any inputs, and never in the loop of a controller."""

from __future__ import annotations

import ctypes
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import build, discretise, export, load, read_scene, solve
from cosserat_casadi.codegen import error_sources
from cosserat_casadi.codegen.compiled import Compiled
from cosserat_casadi.codegen.compiled_results import AnswerInfo
from cosserat_casadi.codegen.plain import pointer
from cosserat_casadi.codegen.status import OUTCOMES
from cosserat_casadi.equilibrium import answer_error
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.discretise import summed_at
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.scene.accuracy import Accuracy
from tests.conftest import AWAY, ROOT
from tests.scenes import push, scene

ROOM = 1 << 20
"""Bytes of memory for a turn, more than it needs."""

FRESH = 1e-6
"""Relative difference of two estimates whose equilibria differ by the tolerance of the solver."""

AGE = 0.02
"""The same where one of them is with the Jacobian that the solver has left: 3e-4 for these loads, 5 % for others."""


@pytest.fixture(scope="module")
def robot() -> Model:
    read = read_scene(AWAY / "tendon_robot.toml")
    return build(read, discretise(read, (1, 3, 1), 4, "magnus4"))


@pytest.fixture(scope="module")
def folder(robot: Model, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return export(robot, tmp_path_factory.mktemp("robot") / "robot", batches=True)


@pytest.fixture(scope="module")
def in_c(folder: Path) -> Compiled:
    return load(folder)


@pytest.fixture(scope="module")
def pushed(tmp_path_factory: pytest.TempPathFactory) -> Compiled:
    """A rod on fixed modes whose tolerance nobody wrote."""
    fixed = scene(push(), accuracy={"modes": 2, "nodes": 6})
    return load(export(build(fixed), tmp_path_factory.mktemp("pushed") / "pushed"))


@pytest.mark.parametrize("tension", [2.0, 9.0])
def test_estimate_is_that_of_python(robot: Model, in_c: Compiled, tension: float) -> None:
    values = {"north.tension": tension}
    wanted = solve(robot, values)
    solved = in_c.solve(values)
    assert solved.error_estimate is not None
    assert wanted.error_estimate is not None
    assert_allclose(solved.error_estimate, wanted.error_estimate, rtol=AGE, atol=0)
    assert solved.within_tolerance is wanted.within_tolerance
    apart = in_c.error_estimate(values, solved.x)
    assert apart is not None
    assert_allclose(apart, wanted.error_estimate, rtol=FRESH, atol=0)


def test_an_old_jacobian_that_tells_nothing_is_made_anew(
    robot: Model, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(error_sources, "FOLLOWED", 0.0)
    compiled = load(export(robot, tmp_path / "robot"))
    values = {"north.tension": 9.0}
    wanted = solve(robot, values)
    solved = compiled.solve(values)
    assert wanted.error_estimate is not None
    assert_allclose(solved.error_estimate, wanted.error_estimate, rtol=FRESH, atol=0)


@pytest.mark.slow
def test_an_answer_that_lacks_nothing_is_exact(pushed: Compiled) -> None:
    # A straight rod: no missing mode moves, and the unknowns of the answer have nothing to follow.
    solved = pushed.solve({"push.force": [0.0, 0.0, 0.0]})
    assert solved.error_estimate is not None
    assert solved.error_estimate <= 1e-12


def test_an_answer_beyond_the_tolerance_is_told(in_c: Compiled) -> None:
    away = in_c.solve({"payload.force": [0.0, 0.5, 0.0]})
    assert away.converged
    assert away.within_tolerance is False


def test_rows_of_a_batch_know_their_errors(in_c: Compiled) -> None:
    given = np.tile(in_c.defaults, (9, 1))
    given[:, 2] = np.linspace(1.0, 9.0, 9)
    for row, solved in zip(given, in_c.solve_batch(given), strict=True):
        alone = in_c.solve(row)
        assert solved.error_estimate is not None
        assert alone.error_estimate is not None
        assert_allclose(solved.error_estimate, alone.error_estimate, rtol=AGE, atol=0)


def test_unknowns_that_are_no_equilibrium_have_no_error(in_c: Compiled) -> None:
    assert in_c.error_estimate(None, np.full(in_c.size, 0.3)) is None


def test_a_turn_of_a_control_loop_estimates_nothing(in_c: Compiled) -> None:
    start = in_c.solve()
    x = start.x.copy()
    info = AnswerInfo(error_estimate=0.5)
    library = ctypes.CDLL(str(in_c.library))
    # More than the workspace, and more than the memory of a turn needs.
    workspace, memory = (ctypes.create_string_buffer(ROOM) for _ in range(2))
    status = library.robot_track(
        pointer(in_c.defaults), pointer(x), memory, None, None, None, workspace, ctypes.byref(info)
    )
    assert OUTCOMES[status] is Outcome.CONVERGED
    assert info.error_estimate < 0


@pytest.mark.slow
def test_missing_modes_that_bounce_off_a_wall_are_told(tmp_path: Path) -> None:
    """The second of two sweeps alone settles at the second inputs, at half of the error."""
    read = read_scene(ROOT / "examples" / "reach_past_bar.toml", ["accuracy.tolerance=1e-3"])
    model = build(read, summed_at(discretise(read, 1, 2, "magnus6"), 31))
    compiled = load(export(model, tmp_path / "robot"))
    for tension, height in ((11.3, -0.0703), (5.7, -0.034)):
        pressed = compiled.solve({"flexor.tension": tension, "robot.base.position": [0.0, 0.0, height]})
        assert pressed.converged
        assert pressed.error_estimate == answer_error.UNKNOWN
        assert pressed.within_tolerance is False


def test_modes_that_are_blind_to_what_loads_roll_up_do_not_know_their_error(tmp_path: Path) -> None:
    """Four modes of three turns miss the waves that a force puts along them; a circle has none."""
    straight = {"name": "rod", "length": 1.0, "strain": "planar", "stiffness": {"bending_y": 1.0}}
    rolling = push(force=[1.0, 0, 0], moment=[0, 6 * np.pi, 0])
    rolled = scene(rolling, rods=[straight], inputs=["push.force"])
    compiled = load(export(build(rolled, discretise(rolled, 4, 24)), tmp_path / "rolled"))
    assert compiled.solve().error_estimate == answer_error.UNKNOWN
    circle = compiled.solve({"push.force": [0.0, 0.0, 0.0]}).error_estimate
    assert circle is not None and circle < 1e-10


def test_parameters_move_the_estimate(tmp_path: Path) -> None:
    rod = {
        "name": "rod",
        "length": 0.4,
        "strain": "planar",
        "material": {"youngs_modulus": 2e9, "poisson_ratio": 0.4, "density": 1000.0},
        "section": {"shape": "circle", "radius": [3e-3, 2e-3]},
    }
    bent = scene(push(force=[0.9, 0.0, -0.4]), rods=[rod], parameters=["rod.material.youngs_modulus"])
    model = build(bent, discretise(bent, 3, 10))
    compiled = load(export(model, tmp_path / "bent"))
    softer = {"rod.material.youngs_modulus": 0.7e9}
    solved = compiled.solve(parameters=softer)
    wanted = solve(model, parameters=softer)
    assert solved.error_estimate is not None
    assert_allclose(solved.error_estimate, wanted.error_estimate, rtol=AGE, atol=0)


def test_estimate_is_left_out_where_bytes_count(robot: Model, folder: Path, tmp_path: Path) -> None:
    small = export(robot, tmp_path / "small", estimate_errors=False)
    assert "richer" not in (small / "small_kernels.c").read_text()
    assert "error_estimate(" not in (small / "small.h").read_text()
    assert not (small / "solver_error.c").exists()
    assert (folder / "solver_error.c").exists()
    solved = load(small).solve()
    assert solved.converged
    assert solved.error_estimate is None


def test_tolerance_that_nobody_wrote_binds_no_folder(pushed: Compiled) -> None:
    solved = pushed.solve()
    assert solved.error_estimate is not None
    assert solved.error_estimate > Accuracy().tolerance
    assert solved.within_tolerance is None


def test_estimate_that_does_not_settle_is_the_whole_length(
    robot: Model, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(answer_error, "MOST_SWEEPS", 1)
    compiled = load(export(robot, tmp_path / "one"))
    away = compiled.solve({"payload.force": [0.0, 2.0, 0.0]})
    assert away.error_estimate == answer_error.UNKNOWN


def test_an_answer_that_needs_no_step_is_not_in_doubt(tmp_path: Path) -> None:
    """Under so small a load the start is in balance to the tolerance: its rest says nothing of the Jacobian."""
    small = scene(
        push(force=[0.0, 0.0, 0.0]), strain="planar", accuracy={"modes": 4, "nodes": 10}, inputs=["push.force"]
    )
    export(build(small), tmp_path / "small")
    compiled = load(tmp_path / "small")
    force = np.array([2e-4, 0.0, 0.0])
    solution = compiled.solve(force)
    assert solution.iterations == 0
    assert solution.error_estimate is not None
    assert solution.error_estimate < 1e-9
    assert compiled.error_estimate(force, solution.x) < 1e-9
