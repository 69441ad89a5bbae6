"""The exported solver as WebAssembly, by clang with the C library of WASI, fully linked, without imports."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Mapping
from functools import cache
from importlib import resources
from pathlib import Path

from cosserat_casadi.codegen.export import folder_files
from cosserat_casadi.compiling.compiler import LONGEST, Processes
from cosserat_casadi.compiling.texts import fill
from cosserat_casadi.errors import ExportError, Problem
from cosserat_casadi.page.drawn_model import DrawnModel

VARIABLE = "COSSERAT_CASADI_WASM_CC"
"""Environment variable for the path of the compiler, such as the clang of the WASI SDK."""

REMEDY = (
    "a page needs clang, lld and wasi-libc (Debian and Ubuntu: apt install clang lld wasi-libc "
    f"libclang-rt-dev-wasm32; elsewhere the WASI SDK, with its clang in the environment variable {VARIABLE})"
)

STACK = 1 << 20
"""Size of the stack, bytes: far above the need of the solver."""

FLAGS = (
    "--target=wasm32-wasi",
    "-O2",
    "-std=c99",
    # Products and sums are rounded separately, the default of other compilers.
    "-ffp-contract=off",
    "-nostartfiles",
    "-Wl,--no-entry",
    "-Wl,--strip-all",
    "-Wl,--stack-first",
    f"-Wl,-z,stack-size={STACK}",
)

PROBE = """#include <math.h>
#include <string.h>
__attribute__((export_name("probe"))) double probe(double x, char *text) { return sin(x) * (double)strlen(text); }
"""
"""Test program for the compiler, with the needs of every page: mathematics and strings."""

NAME = "robot"
"""Prefix of the symbols of the library inside a page."""


def find_wasm_compiler() -> str:
    """Path of a compiler that links WebAssembly.

    Raises:
        ExportError: there is none, or it lacks the linker or the library.
    """
    asked = os.environ.get(VARIABLE)
    path = shutil.which(asked or "clang")
    if path is None:
        problem = f"{asked} is not a program" if asked else "there is no clang on the path"
        raise ExportError(Problem("--page", problem, REMEDY))
    fault = _fault_of(path)
    if fault:
        raise ExportError(Problem("--page", f"{path} cannot make WebAssembly: {fault}", REMEDY))
    return path


@cache
def _fault_of(compiler: str) -> str:
    """Error message of a compiler for the test program; empty if it compiles to WebAssembly."""
    try:
        _compiled(compiler, {"probe.c": PROBE}, ["probe.c"])
    except ExportError as error:
        return error.problems[0].problem
    return ""


def wasm_of(model: DrawnModel, compiler: str) -> bytes:
    """The library of a model as a WebAssembly module without imports.

    Args:
        model: the model with its drawing function.
        compiler: path of a clang for WebAssembly.

    Raises:
        ExportError: the compiler fails.
    """
    files = folder_files(model, NAME)
    template = (resources.files("cosserat_casadi.page") / "assets" / "page.c.in").read_text(encoding="utf-8")
    words = {"name": NAME, "MACRO": NAME.upper(), "drawn": model.drawn.size1_out(0)}
    files["page.c"] = fill(template, words)
    return linked(files, compiler)


def linked(files: Mapping[str, str], compiler: str) -> bytes:
    """A library, with the functions for the page in page.c, as a WebAssembly module without imports.

    Args:
        files: texts of sources and headers, by name.
        compiler: path of a clang for WebAssembly.

    Raises:
        ExportError: the compiler fails.
    """
    sources = ("page.c", f"{NAME}.c", f"{NAME}_kernels.c", f"{NAME}_drawn.c")
    return _compiled(compiler, files, [file for file in sources if file in files])


def _compiled(compiler: str, files: Mapping[str, str], sources: list[str]) -> bytes:
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        for name, text in files.items():
            (folder / name).write_text(text, encoding="utf-8")
        module = folder / "module.wasm"
        command = [compiler, *FLAGS, *sources, "-lm", "-o", module.name]
        try:
            with Processes(LONGEST) as processes:
                code, told = processes.run(command, folder)
        except TimeoutError:
            problem = f"{compiler} was stopped: it had not compiled the page after {LONGEST:g} s"
            raise ExportError(Problem("--page", problem, REMEDY)) from None
        except OSError as error:
            raise ExportError(Problem("--page", f"{compiler} cannot be run: {error.strerror}", REMEDY)) from None
        if code:
            raise ExportError(Problem("--page", told.strip()[-400:]))
        if not module.exists():
            raise ExportError(
                Problem("--page", f"{compiler} says that it has compiled the page, and wrote nothing", REMEDY)
            )
        return module.read_bytes()
