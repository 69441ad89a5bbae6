"""A new function is one entry of the table: the model, the folder, its header and what is loaded of it have it."""

from __future__ import annotations

import json
import re
import shutil
from dataclasses import dataclass
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Compiled, ExportError, Model, build, discretise, export, load
from cosserat_casadi.codegen.names import library_names
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.function_table import Expressions, Output, Owner, owned_functions, scene_function, table
from tests.scenes import WEIGHT, push, rod, scene

COMPILER = next((found for word in ("cc", "gcc", "clang") if (found := shutil.which(word))), None)

RODS = {
    "one rod": [rod("planar", name="left")],
    "two rods": [rod("planar", name="left"), rod("kirchhoff", name="right", base={"position": [0.1, 0.0, 0.0]})],
}


class WithMidpoint(Model):
    """A model with two functions of its own."""

    @owned_functions(
        Owner.ROD,
        (Output("middle", "cm"), Output("d_middle_d_x", "cm", derivative_by="x")),
        kernel="midpoint",
        header="Middle of rod {owner}, world frame.",
        differentiable=True,
    )
    def midpoint(self, written: Expressions) -> list[Matrix]:
        """(x, inputs) ↦ position of the section X = 0.5, and its derivative with x."""
        position, _ = self.shape[written.owner](written["x"], written["inputs"], 0.5)
        middle = 100 * position
        return [middle, ca.densify(ca.jacobian(middle, written["x"]))]

    @scene_function(
        Output("stored", "J"),
        arguments=("x", "inputs", "load_factor"),
        kernel="stored",
        header="Elastic energy of all rods, times the load factor.",
    )
    def stored(self, written: Expressions) -> list[Matrix]:
        """(x, inputs, load_factor) ↦ elastic energy of all rods, J, times the load factor."""
        return [written["load_factor"] * self.energy(written["x"], written["inputs"])]


@dataclass(frozen=True)
class Made:
    """A model with its own functions, and its folder."""

    model: WithMidpoint
    folder: Path


@pytest.fixture(scope="module", params=["one rod", pytest.param("two rods", marks=pytest.mark.slow)])
def made(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Made:
    wanted = scene({**push(), "rod": "left"}, WEIGHT, rods=RODS[request.param])
    model = WithMidpoint(build(wanted, discretise(wanted, 2, 4)).discrete)
    return Made(model, export(model, tmp_path_factory.mktemp("new") / "lib", derivatives=True))


def symbols(model: Model) -> dict[str, str]:
    """Of the function of each rod."""
    several = len(model.discrete.rods) > 1
    return {name: f"lib_midpoint_{name}" if several else "lib_midpoint" for name in model.discrete.rods}


def test_in_the_model(made: Made) -> None:
    x, inputs = made.model.unloaded(), made.model.pack()
    assert list(made.model.midpoint) == list(made.model.discrete.rods)
    position, _ = made.model.midpoint["left"](x, inputs)
    assert_allclose(position.full()[:, 0], [0.0, 0.0, 40.0], rtol=0, atol=1e-12)


def test_in_the_manifest(made: Made) -> None:
    entries = json.loads((made.folder / "manifest.json").read_text())["functions"]
    found = {entry["owner"]: entry for entry in entries if entry.get("function") == "midpoint"}
    assert {owner: entry["symbol"] for owner, entry in found.items()} == symbols(made.model)
    for entry in found.values():
        assert entry["name"] == entry["symbol"].replace("lib_", "lib_k_")
        assert entry["external"] == entry["symbol"].replace("lib_", "lib_f_")
        assert [argument["name"] for argument in entry["arguments"]] == ["x", "inputs"]
        assert entry["results"] == [
            {"name": "middle", "shape": [3, 1], "unit": "cm"},
            {"name": "d_middle_d_x", "shape": [3, made.model.size], "unit": "cm"},
        ]
    (stored,) = (entry for entry in entries if entry.get("function") == "stored")
    assert stored["symbol"] == "lib_stored"
    assert "owner" not in stored
    assert "external" not in stored


def test_in_the_header_and_the_readme(made: Made) -> None:
    header = " ".join((made.folder / "lib.h").read_text().split())
    readme = (made.folder / "README.md").read_text()
    for owner, symbol in symbols(made.model).items():
        text = f"Middle of rod {owner}, world frame. Gives middle (3, cm), d_middle_d_x (3 x UNKNOWNS, cm)."
        parameters = "const lib_real *x, const lib_real *inputs, lib_real *middle, lib_real *d_middle_d_x"
        assert f"/* {text} */ void {symbol}({parameters});" in header
        assert f"| `{symbol}` | {text} |" in readme
    parameters = "const lib_real *x, const lib_real *inputs, lib_real load_factor, lib_real *stored"
    text = "Elastic energy of all rods, times the load factor. Takes load_factor; gives stored (J)."
    assert f"/* {text} */ void lib_stored({parameters});" in header


@pytest.mark.skipif(COMPILER is None, reason="there is no C compiler")
def test_in_what_is_loaded(made: Made) -> None:
    """As CasADi functions with derivatives, and the wrappers in C themselves: the same numbers."""
    loaded = load(made.folder)
    entries = {entry["owner"]: entry for entry in loaded.manifest["functions"] if entry.get("function") == "midpoint"}
    rng = np.random.default_rng(3)
    x = rng.uniform(-1, 1, made.model.size)
    inputs = made.model.pack() + rng.uniform(-1, 1, made.model.inputs.size)
    assert set(loaded.midpoint) == set(made.model.midpoint)
    for name, own in made.model.midpoint.items():
        plain = loaded._casadi_function({**entries[name], "external": None})
        for function in (loaded.midpoint[name], plain):
            assert function.name_out() == own.name_out()
            for ours, theirs in zip(function(x, inputs), own(x, inputs), strict=True):
                assert_allclose(ours.full(), theirs.full(), rtol=1e-12, atol=1e-12)
        assert_allclose(slope(loaded.midpoint[name], x, inputs), own(x, inputs)[1].full(), rtol=1e-10, atol=1e-10)
        with pytest.raises((RuntimeError, NotImplementedError), match="without derivatives: differentiate the model's"):
            slope(plain, x, inputs)
    energy = loaded.stored(x, inputs, 0.25)
    assert_allclose(float(energy), 0.25 * float(made.model.energy(x, inputs)), rtol=1e-12, atol=0)
    assert float(energy) > 0


def slope(function: ca.Function, x: np.ndarray, inputs: np.ndarray) -> np.ndarray:
    """Derivative of the first result with x."""
    symbol = ca.MX.sym("x", len(x))
    derivative = ca.jacobian(function(symbol, inputs)[0], symbol)
    return np.asarray(ca.Function("slope", [symbol], [derivative])(x).full())


@pytest.mark.skipif(COMPILER is None, reason="there is no C compiler")
def test_every_function_of_the_header_is_loaded(made: Made) -> None:
    loaded = load(made.folder)
    header = (made.folder / "lib.h").read_text()
    functions = {entry["function"]: entry for entry in loaded.manifest["functions"] if "function" in entry}
    assert set(functions) == {"igm", "tip", "tip_jacobian", "shape", "midpoint", "stored"}
    for name, entry in functions.items():
        assert re.search(rf"\bvoid {entry['symbol']}\(", header)
        assert getattr(loaded, name)
    assert loaded.body == {}
    with pytest.raises(AttributeError, match="the library has no function 'nonsense'"):
        loaded.nonsense  # noqa: B018


def test_members_are_not_asked_for_in_what_is_not_made_yet() -> None:
    with pytest.raises(AttributeError, match="no function '_names'"):
        Compiled.__new__(Compiled)._names  # noqa: B018


class WithTipFar(Model):
    """A model with a function whose name begins like another's."""

    @owned_functions(Owner.ROD, (Output("position", "m"),), kernel="tip_far", header="Twice as far as the tip.")
    def tip_far(self, written: Expressions) -> list[Matrix]:
        """(x, inputs) ↦ twice the position of the tip."""
        return [2 * self.tip[written.owner](written["x"], written["inputs"])[0]]


def test_names_that_the_new_function_takes() -> None:
    rods = ("a", "far_a")
    assert library_names("lib", rods)
    with pytest.raises(ExportError, match=r"rods\[1\].name: 'far_a' gives a function the name that rod 'a' gives"):
        library_names("lib", rods, functions=tuple(table(WithTipFar)))


class WithUnknownOperation(Model):
    """A model with a function of an operation that CasADi alone prints."""

    @owned_functions(Owner.ROD, (Output("remainder", "m"),), kernel="remainder", header="Of the tip of rod {owner}.")
    def remainder(self, written: Expressions) -> list[Matrix]:
        """(x, inputs) ↦ position of the tip less the nearest multiple of a tenth, m."""
        position, *_ = self.tip[written.owner](written["x"], written["inputs"])
        return [ca.remainder(position, 0.1)]


def test_an_operation_that_is_printed_by_casadi_beside_derivatives_by_columns(tmp_path: Path) -> None:
    wanted = scene(push(), WEIGHT, strain="planar")
    model = WithUnknownOperation(build(wanted, discretise(wanted, 4, 8)).discrete)
    compiled = load(export(model, tmp_path / "lib"))
    given = [0.3 + model.unloaded(), model.pack()]
    for name in ("remainder", "tip", "tip_jacobian"):
        expected = getattr(model, name)["rod"].call(given)
        for one, other in zip(getattr(compiled, name)["rod"].call(given), expected, strict=False):
            assert_allclose(np.array(one), np.array(other), rtol=1e-12, atol=1e-14)
