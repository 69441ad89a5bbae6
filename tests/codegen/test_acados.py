"""What acados is given: expressions its own model and generator take, and C functions with its signature."""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import ExportError, Model, build, discretise
from cosserat_casadi.codegen.acados import acados_expressions, acados_functions, write_acados
from tests.conftest import ROOT
from tests.control.swing import arm
from tests.scenes import WEIGHT, push, scene

COMPILER = next((found for word in ("cc", "gcc", "clang") if (found := shutil.which(word))), None)

ENDINGS = ["fun", "fun_jac_x_xdot_z", "fun_jac_x_xdot_u_z", "fun_jac_x_xdot_u", "jac_x_xdot_u_z"]


def wire(inputs: tuple[str, ...] = ("push.force",), transport: str | None = None) -> Model:
    wanted = scene(push(), WEIGHT, strain="planar", inputs=list(inputs))
    return build(wanted, discretise(wanted, 3, 6, transport))


def point(model: Model) -> dict[str, np.ndarray]:
    """Values of all arguments of the DAE, away from equilibrium."""
    random = np.random.default_rng(5)
    count = model.inputs.size
    sizes = {"x": count, "xdot": count, "u": count, "z": model.size}
    return {word: 0.3 * random.standard_normal(size) for word, size in sizes.items()}


def expected(model: Model, at: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Value and Jacobians of the DAE by hand from those of the model."""
    count, size = model.inputs.size, model.size
    by_z, value = (block.full() for block in model.jacobian(at["z"], at["x"]))
    by_x = model.input_jacobian(at["z"], at["x"]).full()
    one, none = np.eye(count), np.zeros((size, count))
    return {
        "fun": np.concatenate([at["xdot"] - at["u"], value[:, 0]])[:, None],
        "jac_x": np.vstack([0 * one, by_x]),
        "jac_xdot": np.vstack([one, none]),
        "jac_u": np.vstack([-one, none]),
        "jac_z": np.vstack([np.zeros((count, size)), by_z]),
    }


def test_expressions_vs_model() -> None:
    model = wire()
    dae = acados_expressions(model, "wire")
    assert [dae.x.numel(), dae.u.numel(), dae.z.numel()] == [3, 3, model.size]
    assert dae.f_impl_expr.numel() == 3 + model.size
    value = ca.Function("value", [dae.x, dae.xdot, dae.u, dae.z], [dae.f_impl_expr])
    at = point(model)
    assert_allclose(value(*at.values()).full(), expected(model, at)["fun"], rtol=1e-12, atol=1e-13)


class CasadiFunction:
    """A compiled function, called as acados calls it: integers are C ints, outputs are compressed by columns."""

    def __init__(self, library: ctypes.CDLL, name: str) -> None:
        self._symbol = lambda ending: getattr(library, f"{name}{ending}")
        self._sizes = [ctypes.c_int() for _ in range(4)]
        assert self._symbol("_work")(*map(ctypes.byref, self._sizes)) == 0
        self.inputs, self.outputs = self._symbol("_n_in")(), self._symbol("_n_out")()

    def _pattern(self, kind: str, i: int) -> tuple[int, int, list[int], list[int]]:
        get = self._symbol(f"_sparsity_{kind}")
        get.restype = ctypes.POINTER(ctypes.c_int)
        found = get(i)
        rows, columns = found[0], found[1]
        if found[2] == 1:  # dense
            starts, places = [rows * k for k in range(columns + 1)], list(range(rows)) * columns
        else:
            starts = [found[2 + k] for k in range(columns + 1)]
            places = [found[3 + columns + k] for k in range(starts[-1])]
        return rows, columns, starts, places

    def __call__(self, arguments: list[np.ndarray]) -> list[np.ndarray]:
        double = ctypes.POINTER(ctypes.c_double)
        n_arg, n_res, n_iw, n_w = (size.value for size in self._sizes)
        patterns = [self._pattern("out", i) for i in range(self.outputs)]
        held = [np.zeros(max(1, len(places))) for *_, places in patterns]
        given = [np.ascontiguousarray(argument, dtype=float) for argument in arguments]
        arg, res = (double * n_arg)(), (double * n_res)()
        for pointers, arrays in ((arg, given), (res, held)):
            for i, array in enumerate(arrays):
                pointers[i] = array.ctypes.data_as(double)
        assert self._symbol("")(arg, res, (ctypes.c_int * max(1, n_iw))(), (ctypes.c_double * max(1, n_w))(), None) == 0
        results = []
        for (rows, columns, starts, places), values in zip(patterns, held, strict=True):
            full = np.zeros((rows, columns))
            for column in range(columns):
                for k in range(starts[column], starts[column + 1]):
                    full[places[k], column] = values[k]
            results.append(full)
        return results


@pytest.mark.skipif(COMPILER is None, reason="there is no C compiler")
def test_functions_in_c_vs_model(tmp_path: Path) -> None:
    model = wire()
    folder = write_acados(model, tmp_path / "wire", "wire")
    write_acados(model, folder, "wire")  # over itself
    library = tmp_path / "wire.so"
    flags = ("-std=c99", "-Wall", "-O0", "-fPIC", "-shared")
    command = [os.environ["CC"], *flags, *folder.glob("*.c"), "-o", library, "-lm"]
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    handle = ctypes.CDLL(str(library))
    at = point(model)
    by_hand = expected(model, at)
    for function in acados_functions(model, "wire"):
        compiled = CasadiFunction(handle, function.name())
        assert (compiled.inputs, compiled.outputs) == (6, function.n_out())
        results = compiled([*at.values(), np.zeros(1), np.zeros(1)])
        for word, found in zip(function.name_out(), results, strict=True):
            assert_allclose(found, by_hand[word], rtol=1e-12, atol=1e-13, err_msg=f"{function.name()} {word}")


BUNDLED = find_spec("rockit") and Path(find_spec("rockit").submodule_search_locations[0]) / "external" / "acados"
"""Rockit ships acados' Python interface in source, without the compiled library that would solve."""

GENERATE = """
import sys, warnings
warnings.simplefilter("ignore")
sys.path.insert(0, sys.argv[1])
from acados_template import AcadosModel, AcadosSim
from acados_template.casadi_function_generation import GenerateContext, generate_c_code_implicit_ode
from cosserat_casadi.codegen.acados import acados_expressions
from tests.codegen.test_acados import wire
from tests.control.swing import arm
sim = AcadosSim(acados_path="/nowhere")
moving = sys.argv[2] == "moving"
acados_expressions(arm() if moving else wire(), "wire", moving=moving).assign(sim.model)
sim.model.make_consistent(sim.dims)
assert (sim.dims.nx, sim.dims.nu, sim.dims.nz) == ((8, 2, 0) if moving else (3, 3, wire().size))
options = {"generate_hess": False, "ext_fun_expand": False, "code_export_directory": "."}
context = GenerateContext(sim.model.p_global, "wire", options)
generate_c_code_implicit_ode(context, sim.model, "theirs")
context.finalize()
"""


@pytest.mark.slow
@pytest.mark.parametrize("moving", [False, True], ids=["at rest", "in motion"])
@pytest.mark.skipif(not BUNDLED or COMPILER is None, reason="acados' generator comes with rockit")
def test_functions_vs_those_acados_generates(tmp_path: Path, moving: bool) -> None:
    """Its generator takes the expressions; what it makes of them has the names, arguments and values of ours."""
    model = arm() if moving else wire()
    template = BUNDLED / "external" / "interfaces" / "acados_template"
    code = f"import sys; sys.path.insert(0, {str(ROOT)!r})\n{GENERATE}"
    done = subprocess.run(
        [sys.executable, "-c", code, str(template), "moving" if moving else "at rest"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    files = sorted((tmp_path / "theirs").glob("*.c"))
    assert [file.stem for file in files] == sorted(f"wire_impl_dae_{ending}" for ending in ENDINGS)
    library = tmp_path / "theirs.so"
    command = [os.environ["CC"], "-O0", "-fPIC", "-shared", *files, "-o", library, "-lm"]
    subprocess.run([str(word) for word in command], check=True)
    handle = ctypes.CDLL(str(library))
    functions = acados_functions(model, "wire", moving=moving)
    random = np.random.default_rng(5)
    at = [0.3 * random.standard_normal(functions[0].size1_in(i)) for i in range(4)]
    arguments = [*at, np.zeros(1), np.zeros(1)]
    for ours in functions:
        theirs = CasadiFunction(handle, ours.name())
        assert (theirs.inputs, theirs.outputs) == (ours.n_in(), ours.n_out())
        for found, value in zip(theirs(arguments), ours.call([*map(ca.DM, at), ca.DM(0), ca.DM(0, 1)]), strict=True):
            assert_allclose(found, value.full(), rtol=1e-11, atol=1e-12, err_msg=ours.name())


def test_what_cannot_be_emitted_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ExportError, match="nothing to control"):
        acados_expressions(wire(inputs=()), "wire")
    with pytest.raises(ExportError, match="no name for a C library"):
        acados_expressions(wire(), "my wire")
    literal = wire(transport="permuted")
    with pytest.raises(ExportError, match=r"no scalar form.*accuracy\.rotation"):
        write_acados(literal, tmp_path / "wire", "wire")
    assert not (tmp_path / "wire").exists()
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "notes.txt").write_text("mine")
    with pytest.raises(ExportError, match="no export wrote"):
        write_acados(wire(), tmp_path / "mine", "wire")
