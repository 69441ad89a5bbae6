"""Batches for a GPU: their source compiled for a processor beside the C of the same folder, and by nvcc."""

from __future__ import annotations

import gc
import shlex
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from cosserat_casadi import (
    Compiled,
    CosseratError,
    ExportError,
    build,
    discretise,
    export,
    load,
    read_scene,
    sweep,
)
from cosserat_casadi.codegen.compiled_motion import StepState
from cosserat_casadi.codegen.device_batch import HOST, DeviceBatch, check_gpu, find_nvcc, load_batch
from cosserat_casadi.codegen.export import folder_files
from cosserat_casadi.codegen.rows import row_library
from cosserat_casadi.codegen.status import MOTION_STATUSES
from cosserat_casadi.scene import Scene
from cosserat_casadi.sweeps.device_rows import device_rows
from tests.codegen.libraries import HAND, LEGS, LOAD, WRISTS, run
from tests.conftest import quickest_compiler
from tests.contact.test_verbs_in_contact import touching
from tests.families import mostly_slow
from tests.scenes import push, scene

EXAMPLES = Path(__file__).parents[2] / "examples"
QUICKLY = f"{quickest_compiler()} -O0"
THREADS = 3
"""Fewer than rows: some threads solve two."""


def example(name: str) -> Scene:
    return read_scene(EXAMPLES / f"{name}.toml")


SCENES: dict[str, tuple[Callable[[], Scene], int, int, bool]] = {
    "wire": (lambda: example("nitinol_wire"), 2, 4, True),
    "robot": (lambda: example("two_section_robot"), 1, 3, False),
    "platform": (lambda: scene(LOAD, rods=LEGS, bodies=[HAND], joints=WRISTS), 1, 3, False),
    "adjustable": (lambda: scene(push(), strain="planar", parameters=["rod.stiffness.bending_y"]), 2, 4, True),
    "crossing": (lambda: touching("these with friction"), 2, 4, True),
}
"""Scenes with few modes and nodes, and whether they move."""


@cache
def exported(name: str, folder: Path) -> Path:
    made, modes, nodes, moving = SCENES[name]
    model = build(made(), discretise(made(), modes, nodes), moving=moving)
    return export(model, folder, name, cuda=True, dynamics=moving)


@pytest.fixture(scope="session")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("device")


def both(name: str, root: Path) -> tuple[DeviceBatch, Compiled]:
    folder = exported(name, root / name)
    compiled = load(folder, QUICKLY)
    assert isinstance(compiled, Compiled)
    return load_batch(folder, HOST, compiler=QUICKLY, threads=THREADS), compiled


def cases(compiled: Compiled) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """Rows of inputs and parameters: usual ones, one that is no number, one that no equilibrium bears."""
    rng = np.random.default_rng(5)
    rows = compiled.defaults * rng.uniform(0.3, 1.2, (7, compiled.inputs.size))
    rows[2] = np.nan
    rows[4] *= 1e9
    return rows, np.tile(compiled.parameters.rows(None), (7, 1)) * rng.uniform(0.8, 1.2, (7, 1))


@pytest.mark.parametrize("name", mostly_slow([*SCENES], quick=["adjustable"]))
def test_solve_vs_c(name: str, root: Path) -> None:
    batch, compiled = both(name, root)
    rows, p = cases(compiled)
    n, m = compiled.size, compiled.inputs.size
    poses = len(compiled.manifest.get("bodies", [])) + len({entry["rod"] for entry in compiled.manifest["unknowns"]})
    arrays: dict[str, Any] = {name: np.empty(7) for name in ("residual_norm", "load_factor", "error_estimate")}
    arrays |= {name: np.empty(7, np.int32) for name in ("status", "iterations", "jacobians")}
    arrays |= {"x": np.empty((n, 7)), "d_x_d_inputs": np.empty((7, m, n))}
    arrays["d_poses_d_inputs"] = np.empty((7, poses, m, 7))
    arrays["inputs"] = np.ascontiguousarray(rows.T)
    passed = {"parameters": p} if p.size else {}
    batch.solve(**arrays, **{name: np.ascontiguousarray(own.T) for name, own in passed.items()})
    expected = compiled.solve_batch(rows, **passed)
    outcomes = [answer.outcome.name for answer in expected]
    assert [compiled.outcomes[status].name for status in arrays["status"]] == outcomes
    assert {"CONVERGED", "NOT_FINITE", "LOAD_STALLED"} <= set(outcomes)
    assert_allclose(arrays["x"].T, [answer.x for answer in expected], rtol=1e-12, atol=1e-12)
    for word in ("iterations", "jacobians", "load_factor", "residual_norm"):
        assert_allclose(arrays[word], [getattr(answer, word) for answer in expected], rtol=1e-12, atol=1e-16)
    estimates = [-1.0 if answer.error_estimate is None else answer.error_estimate for answer in expected]
    assert_allclose(arrays["error_estimate"], estimates, rtol=1e-12, atol=0)
    for i, answer in enumerate(expected):
        found = compiled.sensitivity(rows[i], answer.x, parameters=p[i] if p.size else None)
        if found is None or not answer.converged:
            assert np.isnan(arrays["d_x_d_inputs"][i]).all()
            continue
        assert_allclose(arrays["d_x_d_inputs"][i].T, found[0], rtol=1e-12, atol=1e-12)
        tips = np.array([tip.T for tip in found[1].values()])
        assert_allclose(arrays["d_poses_d_inputs"][i][: len(tips)], tips, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("name", mostly_slow(["wire", "adjustable", "crossing"], quick=["adjustable"]))
def test_steps_vs_c(name: str, root: Path) -> None:
    """Two steps, the second with derivatives; one row is given what is no number."""
    batch, compiled = both(name, root)
    n, m, count = compiled.size, compiled.inputs.size, 4
    rows = compiled.defaults * np.linspace(0.5, 1.1, count)[:, None]
    rows[2] = np.nan
    rate, acceleration = np.full((m, 1), 0.3), np.full((m, 1), 2.0)
    given: dict[str, Any] = {"inputs": np.ascontiguousarray(rows.T), "state": np.zeros((3 * n, count))}
    given["memory"] = np.zeros((count, batch.memory_size), np.uint8)
    given |= {
        "inputs_rate": np.tile(rate, count),
        "inputs_acceleration": np.tile(acceleration, count),
    }
    if compiled.parameters.size:
        given["parameters"] = np.tile(compiled.parameters.rows(None).T, (1, count))
    status, parts = np.empty(count, np.int32), np.empty(count, np.int32)
    rate, acceleration = rate.ravel(), acceleration.ravel()
    by = {"d_end_d_start": np.empty((count, 2 * n, 2 * n)), "d_end_d_inputs": np.empty((count, m, 2 * n))}
    by |= {word: np.empty((count, m, 2 * n)) for word in ("d_end_d_inputs_rate", "d_end_d_inputs_acceleration")}
    batch.step(1e-3, **given, status=status)
    batch.step(1e-3, **given, status=status, parts=parts, **by)
    for i in range(count):
        memory = compiled.step_memory()
        start = StepState(*np.zeros((3, n)))
        first = compiled.step(start, 1e-3, rows[i], rate, acceleration, memory=memory)
        second, derivatives = compiled.step_sensitivity(first.state, 1e-3, rows[i], rate, acceleration, memory=memory)
        assert MOTION_STATUSES[status[i]] is second.status
        assert parts[i] == second.parts
        ends = np.concatenate([second.state.x, second.state.v, second.state.a])
        assert_allclose(given["state"][:, i], ends, rtol=1e-12, atol=1e-12)
        if derivatives is None:
            assert i == 2
            assert all(np.isnan(own[i]).all() for own in by.values())
            continue
        assert np.abs(ends).max() > 1e-6
        expected = (derivatives.by_start, derivatives.by_inputs, derivatives.by_inputs_rate)
        for own, wanted in zip(by.values(), (*expected, derivatives.by_inputs_acceleration), strict=True):
            assert_allclose(own[i].T, wanted, rtol=1e-12, atol=1e-12 * np.abs(wanted).max())


def test_rows_depend_on_no_thread(root: Path) -> None:
    batch, compiled = both("adjustable", root)
    given = cases(compiled)
    one = DeviceBatch(batch.library, batch.manifest, HOST, threads=1).rows(*given)
    for name, answers in batch.rows(*given).items():
        assert_array_equal(answers, one[name])


def test_workspaces_go_with_their_batch(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    released = []
    function = DeviceBatch._function

    def watched(batch: DeviceBatch, word: str) -> Any:
        called = function(batch, word)
        if word != "device_release":
            return called
        return lambda address: (released.append(address), called(address))

    monkeypatch.setattr(DeviceBatch, "_function", watched)
    batch, compiled = both("adjustable", root)
    batch.rows(*cases(compiled))
    workspaces = batch._workspaces
    assert workspaces not in released
    del batch
    gc.collect()
    assert released.count(workspaces) == 1


@pytest.mark.slow
def test_single_precision_vs_double(root: Path) -> None:
    batch, compiled = both("adjustable", root)
    rows, p = (own[:4] for own in cases(compiled))
    single = load_batch(root / "adjustable", HOST, compiler=QUICKLY, single=True, threads=THREADS).rows(rows, p)
    double = batch.rows(rows, p)
    assert single["x"].dtype == np.float32
    assert_array_equal(single["status"], double["status"])
    assert_allclose(single["x"], double["x"], rtol=1e-3, atol=1e-4)


@pytest.mark.slow
def test_rows_of_a_sweep_vs_rows_in_c(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", QUICKLY)
    made, modes, nodes, _ = SCENES["adjustable"]
    model = build(made(), discretise(made(), modes, nodes))
    inputs = np.outer(np.linspace(0.3, 1.2, 5), model.inputs.pack())
    inputs[3] = np.nan
    p = np.linspace(0.8, 1.2, 5)[:, None]
    given = np.hstack([inputs, p])
    expected = row_library(model, estimate_errors=True).solve(given)
    rows = device_rows(model, HOST, estimate_errors=True).solve(given)
    assert_allclose(rows, expected, rtol=1e-12, atol=1e-14)
    assert np.isnan(rows[3, 3:]).all()


@pytest.mark.slow
def test_sweep_on_the_host_vs_cores() -> None:
    table = {"push.force.x": np.linspace(-0.5, 0.5, 9)}
    swept = scene(push(), strain="planar", accuracy={"modes": 2, "nodes": 4})
    on_cores = sweep(swept, table)
    on_host = sweep(swept, table, device=HOST)
    assert on_host.columns == on_cores.columns
    assert_allclose(on_host.values, on_cores.values, rtol=1e-12, atol=1e-12)
    assert on_host.record["sweep"] != on_cores.record["sweep"]


def test_arrays_that_are_refused(root: Path) -> None:
    batch, compiled = both("adjustable", root)
    m, n = compiled.inputs.size, compiled.size
    good: dict[str, Any] = {"inputs": np.zeros((m, 2)), "x": np.zeros((n, 2)), "status": np.zeros(2, np.int32)}
    good["parameters"] = np.ones((compiled.parameters.size, 2))
    frozen = np.zeros((m, 2))
    frozen.flags.writeable = False
    wrong = {
        "x must be float64 of shape": {"x": np.zeros((n + 1, 2))},
        "status must be int32": {"status": np.zeros(2)},
        "x must be contiguous": {"x": np.zeros((2, n)).T.copy("F")},
        "missing: ..status": {"status": None},
        "unknown: ..forces": {"forces": np.zeros(2)},
        "__dlpack__": {"x": [0.0]},
        "inputs gives no memory": {"inputs": frozen},
    }
    for sentence, changed in wrong.items():
        with pytest.raises(ValueError, match=sentence):
            batch.solve(**{**good, **changed})
    batch.solve(**good)
    batch.solve(**{name: array[..., :0] for name, array in good.items()})
    with pytest.raises(ValueError, match=r"inputs must be of shape \(2, 3\), got \(2, 2\)"):
        batch.rows(np.zeros((2, 2)), np.ones((2, 1)))
    with pytest.raises(ValueError, match=r"parameters must be of shape \(2, 1\), got \(2, 0\)"):
        batch.rows(np.zeros((2, 3)))
    with pytest.raises(ValueError, match="give max_parts"):
        batch.step(1e-3, tolerance=1e-6)


def test_what_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    tubes = read_scene(EXAMPLES / "concentric_tubes.toml")
    touching = read_scene(EXAMPLES / "rod_over_bar.toml")
    for described in (tubes, touching):
        with pytest.raises(CosseratError, match="--cuda"):
            export(described, tmp_path / "refused", cuda=True)
        with pytest.raises(CosseratError, match="--device"):
            sweep(described, {"unused": [0.0]}, device=HOST)
    with pytest.raises(CosseratError, match="must be cuda or host"):
        sweep(scene(push()), {"push.force.x": [0.1]}, device="gpu")
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr("sysconfig.get_path", lambda word: str(tmp_path))
    with pytest.raises(ExportError, match=r"no nvcc on the path.*install the extra cuda"):
        find_nvcc()


def test_without_a_gpu() -> None:
    try:
        check_gpu()
    except ExportError as error:
        assert "there is no GPU" in str(error)
    else:
        pytest.skip("this machine has a GPU")


def test_ordinary_exports_have_no_word_of_it() -> None:
    described = scene(push(), strain="planar")
    model = build(described, discretise(described, 2, 4))
    ordinary = folder_files(model, "planar")
    assert not [name for name, text in ordinary.items() if "DEVICE" in text or "CUDA" in text]
    assert set(folder_files(model, "planar", cuda=True)) - set(ordinary) == {"planar_batch.cu", "planar_batch.h"}


@pytest.mark.slow
@pytest.mark.parametrize("name", ["robot", "adjustable", "crossing"])
@pytest.mark.parametrize("single", [False, True])
def test_nvcc_takes_it_without_a_warning(name: str, single: bool, root: Path, tmp_path: Path) -> None:
    try:
        command = shlex.split(find_nvcc())
    except ExportError as error:
        pytest.skip(str(error))
    # Warnings come before code is optimised and assembled, which takes minutes where rods touch.
    command += ["-std=c++20", "-Werror", "all-warnings", "-ptx", "-Xcicc", "-O0"]
    command += [f"-D{name.upper()}_SINGLE"] if single else []
    target = tmp_path / "batch.ptx"
    run(*command, exported(name, root / name) / f"{name}_batch.cu", "-o", target, timeout=120)
    entries = target.read_text().count(".entry")
    assert entries == (2 if SCENES[name][3] else 1)
