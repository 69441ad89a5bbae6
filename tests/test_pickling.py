"""What the package returns can be pickled and copied, for processes and caches; copies give the same numbers."""

from __future__ import annotations

import copy
import ctypes
import multiprocessing
import pickle
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import cloudpickle
import numpy as np
import pytest

from cosserat_casadi import (
    Compiled,
    ExportError,
    Model,
    Problem,
    Scene,
    SceneError,
    build,
    discretise,
    export,
    follow,
    linearise,
    load,
    modes_of,
    simulate,
    solve,
)
from cosserat_casadi.codegen.compiled_motion import StepMemory
from cosserat_casadi.codegen.loaded_library import room
from cosserat_casadi.errors import WriteError
from cosserat_casadi.tubes.tube_solve import solve_tubes
from tests.scenes import push, scene
from tests.tubes.pendulum import Pendulum

STIFFNESS = "rod.stiffness.bending_y"


def by_pickle(value: Any) -> Any:
    return pickle.loads(pickle.dumps(value))


def by_cloudpickle(value: Any) -> Any:
    # As joblib and dask do.
    return pickle.loads(cloudpickle.dumps(value))


WAYS = [by_pickle, by_cloudpickle, copy.deepcopy, copy.copy]
ways = pytest.mark.parametrize("way", WAYS)

Way = Callable[[Any], Any]


def of_stiffness() -> Scene:
    """A rod whose stiffness is a parameter, under a push at its tip."""
    return scene(push(), strain="planar", parameters=[STIFFNESS])


@pytest.fixture(scope="module")
def model() -> Model:
    plain = scene(push(), strain="planar")
    return build(plain, discretise(plain, modes=3))


@pytest.fixture(scope="module")
def parametric() -> Model:
    return build(of_stiffness(), discretise(of_stiffness(), modes=3))


@ways
def test_scene(way: Way) -> None:
    assert way(of_stiffness()) == of_stiffness()


@ways
def test_model_and_solution(way: Way, model: Model) -> None:
    solution = solve(model)
    copied = way(solution)
    assert np.array_equal(copied.x, solution.x)
    assert np.array_equal(copied.tip().position, solution.tip().position)
    again = solve(way(model))
    assert np.array_equal(again.x, solution.x)
    assert again.smallest_eigenvalue == solution.smallest_eigenvalue


@pytest.mark.parametrize("way", [by_pickle, copy.deepcopy])
def test_model_with_parameters(way: Way, parametric: Model) -> None:
    copied = way(parametric)
    values = (np.full(parametric.size, 0.1), parametric.inputs.pack(), [1.7])
    assert np.array_equal(copied.residual(*values).full(), parametric.residual(*values).full())
    # With numbers that are bound unknowns are still counted in units of the scene's own.
    bound = parametric.at({STIFFNESS: 1.5})
    softened = bound.residual(*values[:2]).full()
    assert np.array_equal(way(bound).residual(*values[:2]).full(), softened)
    assert np.array_equal(copied.at({STIFFNESS: 1.5}).residual(*values[:2]).full(), softened)


@ways
def test_layouts(way: Way, parametric: Model) -> None:
    parametric.residual.n_in()
    layout = way(parametric.parameters)
    assert layout.names == parametric.parameters.names
    assert np.array_equal(layout.pack({STIFFNESS: 2.0}), [2.0])


def test_motion_with_its_dense_output() -> None:
    drawn = {"input": "push.force", "times": [0.0, 0.05], "values": [[0, 0, 0], [1, 0, 0]]}
    swinging = scene(push(), strain="planar", simulation={"duration": 0.05}, motions=[drawn])
    moving = swinging.with_motion_inputs()
    motion = simulate(build(moving, discretise(moving, modes=2), moving=True))
    copied = by_pickle(motion)
    assert np.array_equal(copied.x, motion.x)
    assert np.array_equal(copied.at(0.0123).x, motion.at(0.0123).x)


def test_contact() -> None:
    wall = {"name": "wall", "kind": "plane", "point": [0.1, 0, 0], "normal": [-1, 0, 0]}
    solution = solve(scene(push(force=[1.5, 0, 0]), strain="planar", obstacles=[wall]))
    assert solution.contacts
    copied = by_pickle(solution)
    assert np.array_equal(copied.tip().position, solution.tip().position)
    assert copied.contacts[0].ends == solution.contacts[0].ends


def test_path_modes_and_linear_model(model: Model) -> None:
    path = follow(model, "push.force", [0.2, 0.0, -0.1])
    assert np.array_equal(by_pickle(path).x, path.x)
    modes = modes_of(solve(model))
    assert np.array_equal(by_pickle(modes).spectrum, modes.spectrum)
    linear = linearise(solve(model))
    assert np.array_equal(by_pickle(linear).A, linear.A)


@ways
def test_tubes(way: Way) -> None:
    solution = solve_tubes(Pendulum(1.2).scene(0.7, tolerance=1e-4))
    copied = way(solution)
    values = (solution.x, solution.inputs, 1.0)
    assert np.array_equal(copied.model.path_residual(*values).full(), solution.model.path_residual(*values).full())


@pytest.fixture(scope="module")
def compiled(model: Model, tmp_path_factory: pytest.TempPathFactory) -> Compiled:
    return load(export(model, tmp_path_factory.mktemp("folder") / "rod", estimate_errors=False))


@ways
def test_loaded_folder(way: Way, compiled: Compiled) -> None:
    # An opened library cannot be stored: what is taken along is where it lies.
    solution = compiled.solve()
    assert compiled.residual.n_in() == 2
    copied = way(compiled)
    assert np.array_equal(copied.solve().x, solution.x)
    assert np.array_equal(way(solution).x, solution.x)


@ways
def test_memory_of_steps(way: Way) -> None:
    memory = StepMemory(room(16), room(24))
    memory.kept[:] = [1.5, -2.5]
    copied = way(memory)
    assert copied.kept is not memory.kept
    assert bytes(copied.kept) == bytes(memory.kept)
    assert ctypes.sizeof(copied.workspace) == 24


def test_library_that_is_gone(compiled: Compiled, tmp_path: Path) -> None:
    elsewhere = replace(compiled, library=tmp_path / "gone.so")
    with pytest.raises(ExportError, match=r"gone\.so: is not here.*load the folder again"):
        by_pickle(elsewhere)


@ways
@pytest.mark.parametrize(
    "error",
    [
        SceneError(Problem("rods", "are none", "give one"), Problem("--tolerance", "is negative")),
        SceneError(Problem("--tolerance", "is negative")),
        ExportError(Problem("folder", "is none")),
        WriteError("results.csv", OSError(28, "No space left on device")),
    ],
)
def test_errors_cross_processes(way: Way, error: Exception) -> None:
    copied = way(error)
    assert type(copied) is type(error)
    assert str(copied) == str(error)
    assert vars(copied) == vars(error)


@pytest.mark.slow
def test_a_process_that_is_spawned_solves_and_answers(model: Model, parametric: Model) -> None:
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        solutions = pool.map(solve, [model, parametric])
    for solution, own in zip(solutions, [model, parametric], strict=True):
        assert np.array_equal(solution.x, solve(own).x)
