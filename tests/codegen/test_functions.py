"""Every function of a library, called as C calls it, against the model's own."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import solve
from cosserat_casadi.codegen.status import OUTCOMES
from cosserat_casadi.maths.typing import FloatArray
from tests.codegen.libraries import Exported

Library = Callable[[str], Exported]

ROBOTS = ("tendons", "robot")

EACH = pytest.mark.parametrize(
    "name", ["planar", "spatial", "thick", "pinned", "pair", "fixed", "loops", "tendons", "robot"]
)

CONVERGED, NOT_FINITE, NOT_IN_EQUILIBRIUM = 0, 2, 6


def workspace(made: Exported) -> FloatArray:
    """Memory that the solver works in."""
    return np.zeros(-(-getattr(made.handle, f"{made.name}_workspace_size")() // 8))


def call(made: Exported, symbol: str, *arguments: FloatArray | float | None) -> Any:
    """Call a function of the library with arrays and numbers."""
    pointer = ctypes.POINTER(ctypes.c_double)
    given = []
    for argument in arguments:
        if isinstance(argument, float):
            given.append(ctypes.c_double(argument))
        else:
            given.append(None if argument is None else argument.ctypes.data_as(pointer))
    return getattr(made.handle, symbol)(*given)


def results(
    made: Exported,
    symbol: str,
    arguments: list[FloatArray | float],
    shapes: list[tuple[int, ...]],
    *last: FloatArray,
) -> list[Any]:
    """What a function writes; matrices are stored column after column."""
    rooms = [np.full(shape, np.nan, order="F") for shape in shapes]
    call(made, symbol, *arguments, *rooms, *last)
    return rooms


def assert_as(found: list[FloatArray], wanted: list[ca.DM]) -> None:
    """Equal to 1e-12 of the largest entry: sums of large terms may cancel in single entries."""
    assert len(found) == len(wanted)
    for ours, theirs in zip(found, wanted, strict=True):
        theirs = theirs.full().reshape(ours.shape, order="F")
        if ours.size:
            assert_allclose(ours, theirs, rtol=1e-12, atol=1e-12 * max(1.0, np.abs(theirs).max()))


def points(made: Exported) -> list[tuple[FloatArray, FloatArray]]:
    """Unknowns and inputs, the zero of both included."""
    rng, n, m = np.random.default_rng(11), made.model.size, made.model.inputs.size
    random = [(rng.uniform(-1.5, 1.5, n), rng.uniform(-2, 2, m)) for _ in range(4)]
    return [(np.zeros(n), np.zeros(m)), *random]


@EACH
def test_residual_and_its_jacobians_vs_model(library: Library, name: str) -> None:
    made = library(name)
    model, n, m = made.model, made.model.size, made.model.inputs.size
    work = workspace(made)
    for q, inputs in points(made):
        assert_as(results(made, f"{name}_residual", [q, inputs], [(n,)], work), [model.residual(q, inputs)])
        found = results(made, f"{name}_residual_jacobian", [q, inputs], [(n, n), (n,)], work)
        assert_as(found, list(model.jacobian(q, inputs)))
        found = results(made, f"{name}_input_jacobian", [q, inputs], [(n, m)], work)
        assert_as(found, [model.input_jacobian(q, inputs)])


@EACH
def test_functions_of_each_rod_vs_model(library: Library, name: str) -> None:
    made = library(name)
    model, n, m = made.model, made.model.size, made.model.inputs.size
    rng = np.random.default_rng(12)
    for rod, basis in model.discrete.rods.items():
        symbol = {word: made.names.function(word, rod) for word in ("igm", "tip", "tip_jacobian", "shape")}
        for q, inputs in points(made):
            found = results(made, symbol["tip"], [q, inputs], [(3,), (4,)])
            assert_as(found, list(model.tip[rod](q, inputs))[:2])
            found = results(made, symbol["tip_jacobian"], [q, inputs], [(7, n), (7, m)])
            assert_as(found, list(model.tip_jacobian[rod](q, inputs)))
            for X in (0.0, 1.0, 0.5, *basis.grid.nodes[1:3], *rng.uniform(0, 1, 3)):
                found = results(made, symbol["shape"], [q, inputs, float(X)], [(3,), (4,)])
                assert_as(found, list(model.shape[rod](q, inputs, X)))
            own, position, quaternion = rng.uniform(-1, 1, basis.size), rng.uniform(-1, 1, 3), rng.standard_normal(4)
            quaternion /= np.linalg.norm(quaternion)
            arguments = [own, position, quaternion, inputs]
            found = results(made, symbol["igm"], arguments, [(basis.size,), (3,), (3,)])
            assert_as(found, list(model.igm[rod](*arguments)))


def test_actuators_vs_model(library: Library) -> None:
    made = library("tendons")
    for name, function in made.model.actuator.items():
        for q, inputs in points(made):
            shapes = [(1,), (1,), (1, made.model.size)]
            found = results(made, f"tendons_actuator_{name}", [q, inputs], shapes)
            assert_as(found, list(function(q, inputs)))


def test_bodies_vs_model(library: Library) -> None:
    made = library("robot")
    n, m = made.model.size, made.model.inputs.size
    for q, inputs in points(made):
        found = results(made, "robot_body_hand", [q, inputs], [(3,), (4,)])
        assert_as(found, list(made.model.body["hand"](q, inputs))[:2])
        found = results(made, "robot_body_jacobian_hand", [q, inputs], [(7, n), (7, m)])
        assert_as(found, list(made.model.body_jacobian["hand"](q, inputs)))


@pytest.mark.parametrize("name", ROBOTS)
def test_robots_vs_solver_in_python(library: Library, name: str) -> None:
    made = library(name)
    found, wanted = made.compiled.solve(), solve(made.model)
    assert found.converged
    assert wanted.converged
    # Both stop where the residual is small beside 1 + |x|, which tensions make large.
    size = 1 + float(np.linalg.norm(wanted.x))
    assert_allclose(found.x, wanted.x, rtol=0, atol=1e-10 * size)


def test_sensitivities_of_poses_vs_differences(library: Library) -> None:
    """Tips of all rods and the pose of the body, by central differences over whole solves."""
    made, step = library("robot"), 1e-4
    compiled, inputs = made.compiled, made.model.pack()
    q = compiled.solve(inputs).x
    found = compiled.sensitivity(inputs, q)
    bodies = compiled.body_sensitivity(inputs, q)
    assert found is not None
    assert bodies is not None
    for k in range(len(inputs)):
        moved = step * np.eye(len(inputs))[k]
        ends = [compiled.solve(inputs + sign * moved, q).x for sign in (1, -1)]
        functions = {**made.model.tip, **made.model.body}
        for name, function in functions.items():
            poses = [np.concatenate([part.full()[:, 0] for part in function(end, inputs)[:2]]) for end in ends]
            columns = {**found[1], **bodies}[name][:, k]
            assert_allclose(columns, (poses[0] - poses[1]) / (2 * step), rtol=1e-6, atol=1e-7)


@pytest.mark.parametrize("name", ["planar", "pair", "fixed"])
def test_sensitivity_at_what_is_no_equilibrium_writes_nothing(library: Library, name: str) -> None:
    made = library(name)
    n, m, rods = made.model.size, made.model.inputs.size, len(made.model.discrete.rods)
    inputs = made.model.pack()
    solved = made.compiled.solve(inputs).x
    for q, status in ((solved + 1e-3, NOT_IN_EQUILIBRIUM), (np.full(n, np.nan), NOT_FINITE)):
        rooms = [np.full(n * m + 1, 7.0), np.full(7 * m * rods + 1, 7.0)]
        assert call(made, f"{name}_solve_sensitivity", inputs, q, *rooms, workspace(made)) == status
        assert all(np.all(room == 7.0) for room in rooms)
    rooms = [np.full(n * m + 1, 7.0), np.full(7 * m * rods + 1, 7.0)]
    assert call(made, f"{name}_solve_sensitivity", inputs, solved, *rooms, workspace(made)) == CONVERGED
    for room in rooms:
        assert not np.any(room[:-1] == 7.0)
        assert room[-1] == 7.0


def test_results_that_may_be_null(library: Library) -> None:
    made = library("planar")
    inputs, q, work = made.model.pack(), np.zeros(3), workspace(made)
    assert call(made, "planar_solve", inputs, q, work, None) == CONVERGED
    assert_allclose(q, made.compiled.solve(inputs).x, rtol=0, atol=0)
    assert call(made, "planar_solve_sensitivity", inputs, q, None, None, work) == CONVERGED
    assert call(made, "planar_follow", inputs, 2 * inputs, q, work, None) == CONVERGED
    assert_allclose(q, made.compiled.solve(2 * inputs).x, rtol=0, atol=1e-10)


def test_scene_without_inputs_needs_no_pointer_to_them(library: Library) -> None:
    made = library("fixed")
    q = np.zeros(made.model.size)
    assert call(made, "fixed_solve", None, q, workspace(made), None) == CONVERGED
    assert_allclose(q, made.compiled.solve().x, rtol=0, atol=0)
    again = q.copy()
    assert call(made, "fixed_follow", None, None, again, workspace(made), None) == CONVERGED
    assert_allclose(again, q, rtol=0, atol=1e-12)


def test_every_status_has_its_own_sentence(library: Library) -> None:
    made = library("planar")
    text = made.handle.planar_status_text
    text.restype = ctypes.c_char_p
    sentences = [text(status).decode() for status in range(len(OUTCOMES))]
    assert len(set(sentences)) == len(OUTCOMES)
    assert sentences == [outcome.value for outcome in OUTCOMES]
    assert text(len(OUTCOMES)) == text(-1) == b"No such status."
