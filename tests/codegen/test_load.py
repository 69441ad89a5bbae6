"""An exported folder, compiled and loaded, gives the functions of the model it was made from."""

from __future__ import annotations

import json
import os
import shutil
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Compiled, ExportError, Model, Scene, SceneError, build, discretise, export, load, solve
from cosserat_casadi.codegen.manifest import MANIFEST
from cosserat_casadi.compiling import compiler
from cosserat_casadi.compiling.cache import cache_folder, file_name
from cosserat_casadi.compiling.compiler import FLAGS, find_compiler
from tests.scenes import WEIGHT, push, scene

COMPILER = next((found for word in ("cc", "gcc", "clang") if (found := shutil.which(word))), None)

needs_compiler = pytest.mark.skipif(COMPILER is None, reason="there is no C compiler")

SCENES: dict[str, tuple[Scene, int]] = {
    "planar": (scene(push(), WEIGHT, strain="planar", inputs=["push.force"]), 3),
    "kirchhoff": (scene(push(frame="body", moment=[0.1, 0.2, -0.1])), 2),
}


@dataclass(frozen=True)
class Pair:
    """A model, the folder it was exported to, where that was compiled, and what was loaded."""

    name: str
    model: Model
    folder: Path
    cache: Path
    loaded: Compiled


def cached(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Compiled libraries go to a folder of this test."""
    monkeypatch.delenv("COSSERAT_CASADI_CACHE", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv("LOCALAPPDATA", str(tmp_path))
    monkeypatch.setattr(Path, "home", lambda: tmp_path)


@pytest.fixture(scope="session", params=SCENES)
def pair(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Pair:
    wanted, modes = SCENES[request.param]
    model = build(wanted, discretise(wanted, modes, 4))
    place = tmp_path_factory.mktemp(request.param)
    with pytest.MonkeyPatch.context() as patch:
        cached(place / "cache", patch)
        folder = export(model, place / "arm", derivatives=True)
        return Pair(request.param, model, folder, cache_folder(), load(folder))


def flat(function: ca.Function, outputs: int) -> ca.Function:
    """One vector of all arguments ↦ one vector of the first results."""
    sizes = [function.numel_in(i) for i in range(function.n_in())]
    joined = ca.MX.sym("p", sum(sizes))
    arguments = ca.vertsplit(joined, np.cumsum([0, *sizes]).tolist())
    results = function.call(arguments)[:outputs]
    return ca.Function("flat", [joined], [ca.vertcat(*map(ca.densify, results))])


def orders(function: ca.Function, outputs: int) -> ca.Function:
    """(arguments, weights) ↦ value, Jacobian, and Hessian of the combination of the results with these weights."""
    whole = flat(function, outputs)
    p, weights = ca.MX.sym("p", whole.size1_in(0)), ca.MX.sym("weights", whole.size1_out(0))
    value = whole(p)
    hessian, _ = ca.hessian(ca.dot(weights, value), p)
    return ca.Function("orders", [p, weights], [value, ca.jacobian(value, p), hessian])


def points(model: Model, extra: tuple[float, ...] = ()) -> Iterator[np.ndarray]:
    """Arguments: strain and load each random and zero."""
    x = 0.7 * np.random.default_rng(5).standard_normal(model.size)
    inputs = model.pack() + 0.1 * np.random.default_rng(6).standard_normal(model.inputs.size)
    for strain in (x, 0 * x):
        for loads in (inputs, 0 * inputs):
            yield np.concatenate([strain, loads, extra])


def assert_same(loaded: ca.Function, own: ca.Function, arguments: Iterator[np.ndarray], outputs: int) -> None:
    found, expected = orders(loaded, outputs), orders(own, outputs)
    weights = np.random.default_rng(7).standard_normal(found.size1_in(1))
    for point in arguments:
        for one, other in zip(found(point, weights), expected(point, weights), strict=True):
            assert one.shape == other.shape
            assert np.all(np.isfinite(one.full()))
            assert_allclose(one.full(), other.full(), rtol=1e-10, atol=1e-11 * (1 + np.abs(other.full()).max()))


@needs_compiler
def test_residual(pair: Pair) -> None:
    loaded, own = pair.loaded.residual, pair.model.residual
    assert (loaded.name_in(), loaded.name_out()) == (own.name_in(), own.name_out())
    assert_same(loaded, own, points(pair.model), 1)


@needs_compiler
def test_tip(pair: Pair) -> None:
    loaded, own = pair.loaded.tip["rod"], pair.model.tip["rod"]
    assert (loaded.name_in(), loaded.name_out()) == (own.name_in(), own.name_out()[:2])
    assert_same(loaded, own, points(pair.model), 2)


@needs_compiler
@pytest.mark.parametrize("X", [0.0, 0.37, 1.0])
def test_shape(pair: Pair, X: float) -> None:
    loaded, own = pair.loaded.shape["rod"], pair.model.shape["rod"]
    assert (loaded.name_in(), loaded.name_out()) == (own.name_in(), own.name_out())
    assert_same(loaded, own, points(pair.model, (X,)), 2)


@needs_compiler
def test_shape_at_the_tip_is_the_tip(pair: Pair) -> None:
    for point in points(pair.model):
        x, inputs = point[: pair.model.size], point[pair.model.size :]
        at_tip = pair.loaded.shape["rod"](x, inputs, 1.0)
        for one, other in zip(at_tip, pair.loaded.tip["rod"](x, inputs), strict=True):
            assert_allclose(one.full(), other.full(), rtol=0, atol=1e-12)


@needs_compiler
def test_what_the_folder_says_of_itself(pair: Pair) -> None:
    assert pair.loaded.size == pair.model.size
    assert_allclose(pair.loaded.defaults, pair.model.pack(), rtol=0, atol=0)
    assert pair.loaded.library.parent == pair.cache
    assert pair.loaded.manifest == json.loads((pair.folder / MANIFEST).read_text())
    assert set(pair.loaded.tip) == set(pair.loaded.shape) == {"rod"}


def reach(model: Model, residual: ca.Function, tip: ca.Function, wanted: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Smallest inputs that bring the tip to a place, with the equilibrium as a constraint."""
    x, inputs = ca.MX.sym("x", model.size), ca.MX.sym("inputs", model.inputs.size)
    miss = (tip(x, inputs)[0] - wanted)[[0, 2]]  # a rod that keeps its length and plane reaches no more than these
    problem = {
        "x": ca.vertcat(x, inputs),
        "f": ca.sumsqr(inputs) / 2,
        "g": ca.vertcat(residual(x, inputs), miss),
    }
    quiet = {"print_time": False, "ipopt": {"print_level": 0, "sb": "yes", "tol": 1e-10}}
    solver = ca.nlpsol("reach", "ipopt", problem, quiet)
    found = solver(x0=np.zeros(model.size + model.inputs.size), lbg=0, ubg=0)
    assert solver.stats()["success"]
    return found["x"].full()[:, 0], found["lam_g"].full()[:, 0]


@needs_compiler
def test_optimum_with_the_residual_as_a_constraint(pair: Pair) -> None:
    """The force that brings the tip to a place: exact second derivatives reach ipopt through the compiled functions."""
    force = {"planar": [0.7, 0.0, -0.3], "kirchhoff": [0.2, 0.3, -0.1]}[pair.name]
    model, wanted = pair.model, solve(pair.model, {"push.force": force}).tip().position
    found, multipliers = reach(model, pair.loaded.residual, pair.loaded.tip["rod"], wanted)
    expected, expected_multipliers = reach(model, model.residual, model.tip["rod"], wanted)
    assert_allclose(found, expected, rtol=0, atol=1e-8)
    assert_allclose(multipliers, expected_multipliers, rtol=0, atol=1e-7)
    if pair.name == "planar":
        assert_allclose(model.inputs.unpack(found[model.size :])["push.force"][:, 0], force, rtol=0, atol=1e-7)


# The compiled object


@pytest.fixture(scope="module")
def strip_once(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An exported folder that no test changes."""
    given = scene(push(), strain="planar")
    return export(build(given, discretise(given, 2, 4)), tmp_path_factory.mktemp("once") / "strip", derivatives=True)


@pytest.fixture
def strip(strip_once: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An exported folder of a test's own beside an empty cache."""
    cached(tmp_path / "cache", monkeypatch)
    return Path(shutil.copytree(strip_once, tmp_path / "strip"))


def pretended(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Names of the objects that would have been compiled."""
    made: list[str] = []

    def pretend(compiler: str, flags: object, sources: list[Path], folder: Path, stem: str, progress: object) -> Path:
        library = folder / file_name(stem, b"")
        made.append(library.name)
        library.write_bytes(b"")
        return library

    monkeypatch.setattr(compiler, "_compile", pretend)
    return made


@needs_compiler
def test_the_object_is_compiled_once(strip: Path, tmp_path: Path) -> None:
    before = {path.name: path.read_bytes() for path in strip.iterdir()}
    first = load(strip).library
    written = first.stat().st_mtime_ns
    assert [path.name for path in cache_folder().iterdir()] == [first.name]
    assert load(str(strip)).library == first
    copied = shutil.copytree(strip, tmp_path / "elsewhere")
    assert load(copied).library == first
    assert first.stat().st_mtime_ns == written
    assert {path.name: path.read_bytes() for path in strip.iterdir()} == before


@needs_compiler
@pytest.mark.parametrize("ending", [".c", ".h", "_config.h", "_kernels.c", "_kernels.h", "_derivatives.c"])
def test_a_changed_source_gives_another_object(strip: Path, ending: str, monkeypatch: pytest.MonkeyPatch) -> None:
    made = pretended(monkeypatch)
    first = load(strip).library
    with (strip / f"strip{ending}").open("a") as stream:
        stream.write("\n")
    second = load(strip).library
    assert second != first
    assert first.exists()
    assert made == [first.name, second.name]


@needs_compiler
def test_a_demo_is_no_part_of_the_object(strip: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pretended(monkeypatch)
    first = load(strip).library
    (strip / "strip_demo.c").write_text("not C")
    assert load(strip).library == first


@needs_compiler
def test_the_compiler_may_be_named(strip: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert COMPILER is not None
    monkeypatch.delenv("CC")
    made = pretended(monkeypatch)
    default = load(strip).library
    assert load(strip, COMPILER).library == default
    monkeypatch.setenv("CC", COMPILER)
    assert load(strip).library == default
    assert made == [default.name]


@needs_compiler
def test_other_flags_give_another_object(strip: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pretended(monkeypatch)
    first = load(strip).library
    monkeypatch.setattr(compiler, "FLAGS", (*FLAGS, "-DNDEBUG"))
    assert load(strip).library != first


# Refusals


def refusal(folder: Path, compiler: str | None = None) -> tuple[str, str, str]:
    """Where, problem and remedy of the only fault."""
    with pytest.raises(ExportError) as caught:
        load(folder, compiler)
    (problem,) = caught.value.problems
    return problem.where, problem.problem, problem.remedy


def test_no_compiler(strip: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CC")
    remedy = "install gcc or clang, or pip install ziglang, or name one in the environment variable CC"
    assert refusal(strip) == ("compiler", "there is no C compiler on the path", remedy)
    assert refusal(strip, "mycc") == ("compiler", "mycc is not a program", remedy)
    monkeypatch.setenv("CC", "theircc")
    assert refusal(strip) == ("compiler", "theircc is not a program", remedy)
    assert not cache_folder().exists()


def program(path: Path, text: str) -> str:
    path.write_text(text)
    path.chmod(0o755)
    return str(path)


@pytest.mark.skipif(sys.platform == "win32", reason="a shell script stands for the compiler")
def test_a_compiler_that_pip_installs_is_found_beside_the_interpreter(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "path").mkdir()
    monkeypatch.setenv("PATH", str(tmp_path / "path"))
    monkeypatch.delenv("CC")
    monkeypatch.setattr(sys, "executable", str(tmp_path / "python"))
    zig = program(tmp_path / "python-zig", "#!/bin/sh\n")
    assert find_compiler() == f"{zig} cc"
    # One on the path comes first.
    clang = program(tmp_path / "path" / "clang", "#!/bin/sh\n")
    monkeypatch.setenv("PATH", f"{tmp_path / 'path'}{os.pathsep}")
    assert find_compiler() == clang


@pytest.mark.skipif(sys.platform == "win32", reason="a shell script stands for the compiler")
def test_a_compiler_that_fails(strip: Path, tmp_path: Path) -> None:
    compiler = program(tmp_path / "mycc", "#!/bin/sh\nprintf 'no licence \\377 today' >&2\nexit 3\n")
    where, problem, _ = refusal(strip, compiler)
    assert where == str(strip)
    assert problem == f"{compiler} could not compile it: no licence \ufffd today"
    assert list(cache_folder().iterdir()) == []


@pytest.mark.skipif(sys.platform == "win32", reason="a shell script stands for the compiler")
def test_a_compiler_that_cannot_be_run(strip: Path, tmp_path: Path) -> None:
    where, problem, remedy = refusal(strip, program(tmp_path / "mycc", "neither script nor program"))
    assert (where, problem) == ("compiler", f"{tmp_path / 'mycc'} cannot be run: Exec format error")
    assert remedy


@needs_compiler
def test_sources_that_are_not_c(strip: Path) -> None:
    (strip / "strip.c").write_text("this is no C\n")
    where, problem, _ = refusal(strip)
    assert where == str(strip)
    assert "could not compile it" in problem
    assert "strip.c" in problem
    assert list(cache_folder().iterdir()) == []


@needs_compiler
@pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="the cache folder goes by another variable")
def test_a_cache_that_cannot_be_written(strip: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    where, problem, remedy = refusal(strip)
    assert where == str(tmp_path / "file" / "cosserat_casadi")
    assert problem.startswith("cannot be written to: ")
    assert "COSSERAT_CASADI_CACHE" in remedy


ANEW = "write one with cosserat export"


def test_not_a_folder_and_no_manifest(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    for folder in (tmp_path, tmp_path / "missing", tmp_path / "file"):
        assert refusal(folder) == (str(folder), "holds no manifest.json that can be read", ANEW)


@pytest.mark.parametrize("content", [b"", b"{", b"schema = 1", b"\xff\xfe", b"[" * 100_000])
def test_manifest_that_is_not_json(tmp_path: Path, content: bytes) -> None:
    (tmp_path / MANIFEST).write_bytes(content)
    assert refusal(tmp_path) == (str(tmp_path / MANIFEST), "is not JSON", ANEW)


SOUND: dict[str, object] = {"schema": 1, "name": "strip", "unknowns": [], "inputs": [], "files": [], "functions": []}
ONE_RADIUS = {"name": "rod.radius", "unit": "m", "value": [1.0], "shape": [1, 1]}
FOREIGN = {
    "a number": 1,
    "a list": [{"name": "strip"}],
    "another table": {"name": "site", "start_url": "."},
    "a name that is none": {**SOUND, "name": 3},
    "a name that leads elsewhere": {**SOUND, "name": "../strip"},
    "unknowns are a number": {**SOUND, "unknowns": 9},
    "unknowns are numbers": {**SOUND, "unknowns": [9]},
    "unknowns without a count": {**SOUND, "unknowns": [{"rod": "rod"}]},
    "a count that is none": {**SOUND, "unknowns": [{"rod": "rod", "count": "2"}]},
    "inputs are a number": {**SOUND, "inputs": 3},
    "inputs without values": {**SOUND, "inputs": [{"name": "push.force"}]},
    "values that are no numbers": {**SOUND, "inputs": [{**ONE_RADIUS, "value": ["a"]}]},
    "values of two shapes": {**SOUND, "inputs": [{**ONE_RADIUS, "value": [[1], 2]}]},
    "values beyond all range": {**SOUND, "inputs": [{**ONE_RADIUS, "value": [10**400]}]},
    "inputs of another shape": {**SOUND, "inputs": [{**ONE_RADIUS, "shape": [2, 1]}]},
    "a shape that is none": {**SOUND, "inputs": [{**ONE_RADIUS, "shape": 1.5}]},
    "inputs without a shape": {**SOUND, "inputs": [{"name": "rod.radius", "unit": "m", "value": [1.0]}]},
    "inputs without a name": {**SOUND, "inputs": [{**ONE_RADIUS, "name": None}]},
    "actuators are null": {**SOUND, "actuators": None},
    "actuators without a name": {**SOUND, "actuators": [{}]},
    "bodies that are numbers": {**SOUND, "bodies": [1]},
    "no list of files": {word: entry for word, entry in SOUND.items() if word != "files"},
    "files that are numbers": {**SOUND, "files": [1]},
    "functions that are numbers": {**SOUND, "functions": [1]},
    "parameters are a number": {**SOUND, "parameters": 3},
    "parameters without a shape": {**SOUND, "parameters": [{"name": "rod.radius", "unit": "m", "value": [1.0]}]},
    "parameters of another shape": {**SOUND, "parameters": [{**ONE_RADIUS, "shape": [2, 1]}]},
}


def test_manifest_with_nothing_wrong_is_one(tmp_path: Path) -> None:
    """What the manifests below are made from is refused for its missing sources alone."""
    (tmp_path / MANIFEST).write_text(json.dumps({**SOUND, "parameters": [ONE_RADIUS]}))
    assert refusal(tmp_path)[1] == "is missing"


@pytest.mark.parametrize("content", FOREIGN.values(), ids=FOREIGN)
def test_manifest_of_something_else(tmp_path: Path, content: object) -> None:
    (tmp_path / MANIFEST).write_text(json.dumps(content))
    assert refusal(tmp_path) == (str(tmp_path / MANIFEST), "is not the manifest of an exported folder", ANEW)


def test_manifest_of_another_version(tmp_path: Path) -> None:
    (tmp_path / MANIFEST).write_text(json.dumps({**SOUND, "schema": 2}))
    expected = "has the schema 2, where this version reads 1"
    assert refusal(tmp_path) == (str(tmp_path / MANIFEST), expected, "export the folder anew")


def test_files_of_two_exports(strip: Path, tmp_path: Path) -> None:
    """Arrays of two modes under a library for three would be written beyond their end."""
    given = scene(push(), strain="planar")
    other = export(build(given, discretise(given, 3, 4)), tmp_path / "other", "strip", derivatives=True)
    shutil.copy(strip / MANIFEST, other)
    expected = "says STRIP_UNKNOWNS 3, where manifest.json has 2"
    assert refusal(other) == (str(other / "strip.h"), expected, "export the folder anew")


def test_other_inputs_than_the_header_has(strip: Path) -> None:
    described = json.loads((strip / MANIFEST).read_text())
    described["inputs"] = described["inputs"][:-1]
    (strip / MANIFEST).write_text(json.dumps(described))
    assert refusal(strip)[1].startswith("says STRIP_INPUTS ")


@needs_compiler
@pytest.mark.parametrize("ending", [".c", ".h", "_config.h", "_kernels.c", "_kernels.h", "_derivatives.c"])
def test_missing_source(strip: Path, ending: str) -> None:
    (strip / f"strip{ending}").unlink()
    assert refusal(strip) == (str(strip / f"strip{ending}"), "is missing", "export the folder anew")


# Folders without derivatives


@pytest.fixture(scope="module")
def bare(tmp_path_factory: pytest.TempPathFactory) -> tuple[Model, Compiled]:
    """A model, and what is loaded of its folder without derivatives."""
    tendon = {"name": "pull", "kind": "tendon", "rod": "rod", "tension": 0.6, "offset": [0.02, 0.0]}
    given = scene(push(), strain="planar", actuators=[tendon])
    model = build(given, discretise(given, 2, 4))
    folder = export(model, tmp_path_factory.mktemp("bare") / "bare")
    assert not (folder / "bare_derivatives.c").exists()
    assert "bare_derivatives" not in (folder / "README.md").read_text().split("## Build")[0]
    return model, load(folder)


@needs_compiler
def test_folder_without_derivatives_gives_solver_and_values(bare: tuple[Model, Compiled]) -> None:
    model, loaded = bare
    assert not loaded.differentiable
    found = loaded.solve()
    assert_allclose(found.x, solve(model).x, rtol=0, atol=1e-10)
    x, inputs = np.array([0.3, -0.2]), model.pack() + 0.1
    pairs = [
        (loaded.residual(x, inputs), model.residual(x, inputs)),
        *zip(loaded.tip["rod"](x, inputs), model.tip["rod"](x, inputs), strict=False),
        *zip(loaded.shape["rod"](x, inputs, 0.4), model.shape["rod"](x, inputs, 0.4), strict=False),
        *zip(loaded.actuator["pull"](x, inputs), model.actuator["pull"](x, inputs), strict=False),
    ]
    assert len(pairs) == 8
    for ours, theirs in pairs:
        assert_allclose(ours.full().ravel(), theirs.full().ravel(), rtol=1e-12, atol=1e-12)
    for own, theirs in ((loaded.residual, model.residual), (loaded.shape["rod"], model.shape["rod"])):
        assert own.name_in() == theirs.name_in()
        assert own.name_out() == theirs.name_out()


@needs_compiler
def test_inputs_by_name_are_those_that_are_stacked(pair: Pair) -> None:
    loaded = pair.loaded
    force = 1.2 * pair.model.inputs.unpack(pair.model.pack())["push.force"]
    named = {"push.force": force}
    stacked = pair.model.pack(named)
    found = loaded.solve(named)
    assert found.converged
    assert_allclose(loaded.inputs.stacked(named), stacked, rtol=0, atol=0)
    assert_allclose(found.x, loaded.solve(stacked).x, rtol=0, atol=0)
    assert not np.allclose(found.x, loaded.solve().x, rtol=1e-3, atol=0)
    by_name, by_vector = loaded.sensitivity(named, found.x), loaded.sensitivity(stacked, found.x)
    assert by_name is not None
    assert by_vector is not None
    assert_allclose(by_name[0], by_vector[0], rtol=0, atol=0)
    followed = loaded.follow({}, named, loaded.solve().x)
    assert_allclose(followed.x, loaded.follow(loaded.defaults, stacked, loaded.solve().x).x, rtol=0, atol=0)


def test_inputs_that_are_none_of_the_folder_are_refused_by_name(pair: Pair) -> None:
    with pytest.raises(SceneError, match=r"pull\.force.*is not an input.*push\.force") as refused:
        pair.loaded.solve({"pull.force": [0.1, 0, 0], "push.force": [0.1, 0]})
    assert "push.force: must have 3 numbers, got 2" in str(refused.value)
    with pytest.raises(ValueError, match="inputs must have"):
        pair.loaded.solve([0.1, 0.2])


def test_derivatives_that_the_folder_lacks_are_refused_with_a_remedy(bare: tuple[Model, Compiled]) -> None:
    model, loaded = bare
    x = ca.MX.sym("x", model.size)
    refused = pytest.raises((RuntimeError, NotImplementedError), match=r"without derivatives: export .*derivatives")
    for value in (loaded.residual(x, model.pack()), loaded.tip["rod"](x, model.pack())[0]):
        with refused:
            ca.Function("slope", [x], [ca.jacobian(value, x)])
