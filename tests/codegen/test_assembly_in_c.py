"""The exported C of an assembly against Python."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Compiled, Discretisation, Model, build, export, load, parse_scene, scene_from_dict, solve
from cosserat_casadi.codegen.assembled import assembled
from cosserat_casadi.codegen.blocks import INTERFACE
from cosserat_casadi.codegen.names import scene_names
from cosserat_casadi.compiling.printed_kernels import PrintedKernel
from tests.codegen.libraries import QUICK, Recipe, compile_quickly
from tests.conftest import ROOT
from tests.scenes import push, rod, scene

LOAD = {"name": "p", "kind": "tip_wrench", "rod": "b", "force": [0.2, 0.0, 0.1]}


def compiled(model: Model, folder: Path, name: str, library: Path) -> Compiled:
    """The solver of an exported folder without the derivatives."""
    compile_quickly("-shared", *QUICK, folder / f"{name}.c", folder / f"{name}_kernels.c", "-lm", "-o", library)
    described = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))
    return Compiled(library, described)


@pytest.mark.slow
def test_two_rods_and_a_body_vs_python(tmp_path: Path) -> None:
    rods = [rod("planar", name="a"), rod("planar", name="b", base={"rod": "a"})]
    tables = {
        "schema": 1,
        "accuracy": {"modes": 3, "nodes": 6},
        "rods": rods,
        "bodies": [{"name": "cap", "mass": 0.1}],
        "joints": [{"body": "cap", "rod": "b", "kind": "fixed"}],
        "loads": [LOAD],
    }
    model = build(scene_from_dict(tables))
    export(model, tmp_path / "two", derivatives=True)
    library = load(tmp_path / "two")
    found = library.solve()
    assert_allclose(found.x, solve(model).x, rtol=0, atol=1e-9)
    ours = library.body["cap"](found.x, library.defaults)
    for one, other in zip(ours, model.body["cap"](found.x, library.defaults)[:2], strict=True):
        assert_allclose(one.full(), other.full(), rtol=0, atol=1e-12)


def test_block_without_a_pivot_of_its_own(tmp_path: Path) -> None:
    """A tie has six multipliers, the planar rod that it holds two strains: only with the frame do they have pivots."""
    rods = [rod("planar", name="a"), rod("planar", name="b", base={"rod": "a"})]
    model = Recipe(scene(LOAD, rods=rods), 2, 4).model()
    found = assembled(model, scene_names("lib", model.scene))
    assert found is not None
    own = np.flatnonzero(np.array(found.blocks.owners) == 0)
    jacobian = model.jacobian(np.zeros(model.size), model.pack())[0].full()
    assert np.linalg.matrix_rank(jacobian[np.ix_(own, own)]) < len(own)
    export(model, tmp_path / "lib")
    library = compiled(model, tmp_path / "lib", "lib", tmp_path / "lib.so")
    solution = library.solve()
    assert solution.converged
    assert_allclose(solution.x, solve(model).x, rtol=0, atol=1e-9)


def test_rods_that_differ_in_numbers_alone_share_their_code() -> None:
    rods = [rod("planar", name=name, length=length) for name, length in (("a", 0.71), ("b", 0.77), ("c", 0.83))]
    joints = [{"body": "hand", "rod": name, "kind": "fixed", "position": [0.1, 0.0, 0.0]} for name in "abc"]
    model = Recipe(scene({**LOAD, "rod": "a"}, rods=rods, bodies=[{"name": "hand"}], joints=joints), 2, 4).model()
    found = assembled(model, scene_names("lib", model.scene))
    assert found is not None
    rng, inputs = np.random.default_rng(3), model.pack()
    x, entries = rng.standard_normal(model.size), np.full(model.path_jacobian.nnz_out(0), np.nan)
    for part in found.jacobian.parts:
        kernel = found.jacobian.kernels[part.kernel]
        function = kernel.signature if isinstance(kernel, PrintedKernel) else kernel
        entries[part.entries] = function(x[part.x], inputs[part.inputs], 0.7, part.constants).full()[:, 0]
    assert_allclose(entries, model.path_jacobian(x, inputs, 0.7).nonzeros(), rtol=1e-12, atol=1e-12)
    assert len(found.jacobian.kernels) < len(found.jacobian.parts)


@pytest.mark.slow
def test_blocks_of_a_chain() -> None:
    """A rod touches the frames at its ends; the last one, under dead loads, feels but the turn of its base."""
    bases: dict[str, dict[str, str]] = {"a": {}, "b": {"rod": "a"}, "c": {"rod": "b"}}
    rods = [rod("planar", name=name, base=base) for name, base in bases.items()]
    model = Recipe(scene({**push(), "rod": "c"}, rods=rods), 2, 4).model()
    found = assembled(model, scene_names("lib", model.scene))
    assert found is not None
    assert [len(front.interface) for front in found.blocks.fronts] == [7, 14, 4]
    assert found.blocks.owners.count(INTERFACE) == 14


@pytest.mark.slow
def test_platform_vs_python(tmp_path: Path) -> None:
    """The platform of generated/, its legs drawn to other lengths: solution, pose, sensitivities by differences."""
    name = "six_rod_platform"
    folder = ROOT / "generated" / name
    described = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))
    chosen = {
        leg: Discretisation(**{**kept, "modes": tuple(kept["modes"]), "breaks": tuple(kept["breaks"])})
        for leg, kept in described["discretisation"].items()
    }
    model = build(parse_scene((folder / "scene.toml").read_text(encoding="utf-8")), chosen)
    library = compiled(model, export(model, tmp_path / name), name, tmp_path / f"{name}.so")
    drawn = {f"leg_{i}.length": [0.43 + 0.01 * (-1) ** i] for i in range(1, 7)}
    inputs, step = model.pack(drawn), 1e-5
    solution, theirs = library.solve(inputs), solve(model, drawn)
    assert solution.converged
    assert theirs.converged
    assert_allclose(solution.x, theirs.x, rtol=0, atol=1e-8)
    found = library.body_sensitivity(inputs, solution.x)
    assert found is not None
    for k in (0, 5, 6, 11):
        moved = step * np.eye(len(inputs))[k]
        ends = [(library.solve(inputs + s * moved, solution.x).x, inputs + s * moved) for s in (1, -1)]
        poses = [np.concatenate([p.full()[:, 0] for p in model.body["platform"](*end)[:2]]) for end in ends]
        assert_allclose(found["platform"][:, k], (poses[0] - poses[1]) / (2 * step), rtol=1e-5, atol=3e-6)
