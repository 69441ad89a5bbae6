"""Columns in fours of scenes with parameters and of assemblies: the same Jacobians, the same digits at any width."""

from __future__ import annotations

import json
import re
from collections import Counter
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Discretisation, Model, build, export, scene_from_dict
from cosserat_casadi.accuracy.cost import MOST_IN_COLUMNS
from cosserat_casadi.codegen.assembled import Assembled, assembled
from cosserat_casadi.codegen.blocks import INTERFACE
from cosserat_casadi.codegen.columns import in_columns, on_path
from cosserat_casadi.codegen.export import folder_files
from cosserat_casadi.codegen.names import scene_names
from cosserat_casadi.codegen.parameters import with_parameters_behind_inputs
from cosserat_casadi.codegen.parts import parted
from cosserat_casadi.compiling.listing import LANES
from cosserat_casadi.compiling.printed_kernels import PrintedKernel, in_groups
from cosserat_casadi.maths.typing import FloatArray
from tests.codegen.libraries import gcc, run
from tests.scenes import push, rod, scene

PARAMETERS = ["rod.length", "rod.stiffness.bending_x", "push.at"]


def with_parameters() -> Model:
    """A rod of two elements, whose common end, length and stiffness are parameters."""
    tables = {
        "schema": 1,
        "parameters": PARAMETERS,
        "rods": [rod("kirchhoff")],
        "loads": [push(kind="point_wrench", at=0.6)],
    }
    return build(scene_from_dict(tables), {"rod": Discretisation((3, 2, 2), 5, (0.0, 0.6, 1.0))})


def legs(*lengths: float, modes: tuple[int, ...] = (2, 2, 1), nodes: int = 4) -> Model:
    """Rods of these lengths that carry a body."""
    names = [f"leg_{i}" for i in range(len(lengths))]
    rods = [
        rod("kirchhoff", name=name, length=length, base={"position": [0.1 * i, 0.02 * i, 0.0]})
        for i, (name, length) in enumerate(zip(names, lengths, strict=True))
    ]
    joints = [
        {"body": "hand", "rod": name, "kind": "fixed", "position": [0.1 * i, 0.02 * i, 0.0]}
        for i, name in enumerate(names)
    ]
    tables = {
        "schema": 1,
        "rods": rods,
        "bodies": [{"name": "hand", "mass": 0.05}],
        "joints": joints,
        "loads": [{"name": "pull", "kind": "tip_wrench", "rod": names[0], "force": [0.2, -0.1, 0.0]}],
    }
    return build(scene_from_dict(tables), dict.fromkeys(names, Discretisation(modes, nodes)))


def in_parts(model: Model) -> Assembled:
    found = assembled(model, scene_names("lib", model.scene))
    assert found is not None
    return found


def test_columns_with_parameters_make_the_jacobian() -> None:
    """Parameters that are not the scene's own numbers: the turns of columns are those of any of them."""
    model = with_parameters()
    form = in_columns(on_path(model), "jacobian")
    assert form is not None
    rng = np.random.default_rng(5)
    x = rng.normal(scale=0.4, size=model.size)
    p = model.parameters.pack() * (1 + 0.1 * rng.random(model.parameters.size))
    inputs = np.concatenate([model.pack(), p])
    columns = np.zeros((form.rows, form.stride))
    for j in range(form.stride):
        columns[:, j] = form.function(x, inputs, 0.7, columns.ravel(), form.turns[:, j])[1].full().ravel()
    found = form.function(x, inputs, 0.7, columns.ravel(), form.turns[:, 0])[0].full()
    expected = model.path_jacobian(x, model.pack(), p, 0.7).full()
    assert_allclose(found, expected, rtol=0, atol=1e-13 * abs(expected).max())


def entries_by_parts(model: Model, parts: Assembled, x: FloatArray, load_factor: float) -> FloatArray:
    """Entries of the Jacobian of an assembly from its kernels."""
    inputs = model.pack()
    entries = np.full(model.path_jacobian.nnz_out(0), np.nan)
    for part in parts.jacobian.parts:
        kernel = parts.jacobian.kernels[part.kernel]
        function = kernel.signature if isinstance(kernel, PrintedKernel) else kernel
        result = function(x[part.x], inputs[part.inputs], load_factor, part.constants)
        entries[part.entries] = result.full()[:, 0]
    return entries


@pytest.mark.parametrize(
    "lengths",
    [(0.7, 0.7, 0.7), pytest.param((0.7, 0.75, 0.8), marks=pytest.mark.slow)],
    ids=["alike", "of different lengths"],
)
def test_parts_by_columns_make_the_jacobian(lengths: tuple[float, ...]) -> None:
    model = legs(*lengths)
    parts = in_parts(model)
    x = np.random.default_rng(2).normal(scale=0.3, size=model.size)
    expected = np.array(model.path_jacobian(x, model.pack(), 0.7).nonzeros())
    found = entries_by_parts(model, parts, x, 0.7)
    assert_allclose(found, expected, rtol=0, atol=1e-13 * abs(expected).max())
    # Rods that differ in numbers share their code, and what a rod reads of columns is its own.
    of_rods = [part for part in parts.jacobian.parts if parts.blocks.entry_owners[part.entries[0]] != INTERFACE]
    assert len({part.kernel for part in of_rods[1:]}) == 1
    assert all(isinstance(parts.jacobian.kernels[part.kernel], PrintedKernel) for part in of_rods)


def carried_rods(count: int) -> Model:
    """A chain of planar rods, each on the middle of the one before it, in springs."""
    names = [f"rod_{i}" for i in range(count)]
    rods = [rod("planar", name=names[0])]
    rods += [rod("planar", name=own, base={"rod": carrier, "at": 0.5}) for carrier, own in pairwise(names)]
    bed = {"kind": "foundation", "stiffness": [3.0, 2.0, 1.0]}
    tables = {"schema": 1, "rods": rods, "loads": [bed | {"name": f"bed_{name}", "rod": name} for name in names]}
    return build(scene_from_dict(tables), dict.fromkeys(names, Discretisation((2,), 3, (0.0, 0.5, 1.0))))


@pytest.mark.parametrize(
    "most",
    [pytest.param(MOST_IN_COLUMNS, marks=pytest.mark.slow), 100],
    ids=["by columns", "in loops"],
)
def test_a_chain_costs_the_sum_of_its_links(monkeypatch: pytest.MonkeyPatch, most: int) -> None:
    """A moving base is computed with its rod: links of a chain share code, in loops too where they are long."""
    monkeypatch.setattr("cosserat_casadi.codegen.assembled.MOST_IN_COLUMNS", most)
    model = carried_rods(5)
    parts = in_parts(model)
    x = np.random.default_rng(3).normal(scale=0.3, size=model.size)
    expected = np.array(model.path_jacobian(x, model.pack(), 0.7).nonzeros())
    assert_allclose(entries_by_parts(model, parts, x, 0.7), expected, rtol=0, atol=1e-13 * abs(expected).max())
    # The world holds the first rod; the second is on a rod whose base stays; the last one carries none.
    assert [part.kernel for part in parts.jacobian.parts] == [0, 1, 2, 2, 3]
    of_middle = parts.jacobian.kernels[2]
    assert isinstance(of_middle, PrintedKernel) == (most == MOST_IN_COLUMNS)


def test_turns_of_columns_in_groups() -> None:
    turns = np.arange(2.0 * 2 * LANES).reshape(2, 2 * LANES)
    expected = [0, 1, 2, 3, 8, 9, 10, 11, 4, 5, 6, 7, 12, 13, 14, 15]
    assert in_groups(turns).tolist() == expected


@pytest.mark.slow
def test_columns_of_an_assembly_take_less_code() -> None:
    """One piece of code for all groups of four columns, against straight-line code of them all."""
    model = legs(0.7, 0.7, modes=(6, 6, 3), nodes=7)
    parts = in_parts(model)
    path_jacobian = with_parameters_behind_inputs(model.path_jacobian)
    straight = parted(path_jacobian, parts.blocks.entry_owners, "straight")
    # Instructions of the functions that the kernels call count too.
    longest = max(kernel.expand().n_instructions() for kernel in straight.kernels)
    in_fours = max(k.n_instructions() for k in parts.jacobian.kernels if isinstance(k, PrintedKernel))
    assert in_fours < 0.6 * longest


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["with parameters", "assembly"])
def test_the_same_digits_at_any_width(kind: str, tmp_path: Path) -> None:
    """In the widest vectors that there are, in those of any processor of the kind, and without vectors."""
    model = with_parameters() if kind == "with parameters" else legs(0.7, 0.75)
    folder = export(model, tmp_path / "lib", "lib")
    assert (folder / "lib_kernels_in_fours.h").exists()
    printed = []
    for macro in ("WIDEST", "FOURS_ONCE", "FOURS_ONE_BY_ONE"):
        target = tmp_path / macro
        sources = [folder / f"lib{part}.c" for part in ("_demo", "", "_kernels")]
        gcc("-std=c99", "-O0", "-Wall", "-Wpedantic", "-Werror", f"-D{macro}", *sources, "-lm", "-o", target)
        found = json.loads(run(target, "--repeat", "1"))
        printed.append({word: value for word, value in found.items() if not word.endswith("_us")})
    assert printed[0]["status"] == "converged"
    assert printed[1:] == printed[:1] * 2


def test_every_table_of_kernels_is_read() -> None:
    files = folder_files(with_parameters(), "lib")
    kernels = files["lib_kernels.c"]
    tables = re.findall(r"static const \w+ (lib_kernels_\w+)\[", kernels)
    words = Counter(re.findall(r"\w+", kernels + files["lib_kernels_in_fours.h"]))
    assert len(tables) > 5
    assert [name for name in tables if words[name] < 2] == []


def test_unloaded_tangent_with_a_cable_of_given_length() -> None:
    """A cable that may go slack answers to its length nonlinearly: the tangent is exact at the scene's own length."""
    cable = {"name": "cable", "kind": "tendon", "rod": "rod", "length": 0.79, "slack": True, "offset": [0.02, 0.0]}
    model = build(scene(actuators=[cable]), {"rod": Discretisation((3, 3, 1), 5)})
    inputs = model.pack()
    unloaded = model.unloaded()
    jacobian = model.path_jacobian(unloaded, inputs, 0.0).full()
    rate = model.path_rate(unloaded, inputs, 0.0, np.zeros(inputs.size), 1.0).full()
    expected = -np.linalg.solve(jacobian, rate)
    assert_allclose(model.path_tangent(inputs).full(), expected, rtol=1e-9, atol=1e-12)
