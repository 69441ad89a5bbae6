"""Compilation of a model to a program that times itself: the exported sources with the exported demo."""

from __future__ import annotations

import json
import shlex
import subprocess
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from math import inf
from pathlib import Path

from cosserat_casadi.codegen.assembled import assembled
from cosserat_casadi.codegen.kernel_files import kernel_sources
from cosserat_casadi.codegen.kernels import kernels
from cosserat_casadi.codegen.library import FolderContents, library_sources
from cosserat_casadi.codegen.names import Names, scene_names
from cosserat_casadi.compiling.compiler import compiler_words
from cosserat_casadi.model.build import Model

NAME = "timed"
"""Prefix of the symbols of the program."""

FLAGS = ("-O2", "-std=c99")

REPEAT = 500
"""Number of runs of each task, of which the fastest counts."""


PATIENCE = 0.05
"""Time, s, for repeated runs in CasADi's virtual machine, of which the fastest counts."""


@dataclass(frozen=True)
class Times:
    """Times that the program measured, µs.

    Attributes:
        cold: time of a solve from the unloaded rod.
        warm: time of a solve from the equilibrium at inputs one per cent away.
        igm: time of the inverse geometric model of the first rod.
        jacobian: time of residual and Jacobian.
    """

    cold: float
    warm: float
    igm: float
    jacobian: float


class Program:
    """A model under compilation, in the background.

    Args:
        model: model to compile.
        compiler: command of a C compiler.
    """

    def __init__(self, model: Model, compiler: str) -> None:
        self._told = ""
        self._folder = tempfile.TemporaryDirectory()
        folder = Path(self._folder.name)
        names = scene_names(NAME, model.scene)
        for file, text in _sources(model, names).items():
            (folder / file).write_text(text, encoding="utf-8")
        # Half of the compiler's work is code that the demo does not time: it is not optimised.
        wanted = ["timed_demo.c", "timed.c", "timed_kernels.c", "untimed.o", "-lm", "-o", "demo"]
        beside = shlex.join([*compiler_words(compiler, ("-O0", "-std=c99")), "-c", "untimed.c"])
        program = shlex.join([*compiler_words(compiler, FLAGS), *wanted])
        command = ["/bin/sh", "-c", f"{beside} && {program}"]
        self._compilation = subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)

    def wait(self) -> None:
        """Wait until the compiler is done."""
        _, told = self._compilation.communicate()
        self._told = told.decode(errors="replace").strip()

    def times(self) -> Times | str:
        """Run the compiled program; return its times, or a sentence if compiler or program fails."""
        if self._compilation.returncode:
            return f"the compiler fails: {' '.join(self._told[-200:].split())}"
        command = ["./demo", "--repeat", str(REPEAT)]
        done = subprocess.run(command, cwd=self._folder.name, capture_output=True, text=True, check=False)
        if done.returncode not in (0, 3):
            return f"the program ends with {done.returncode}"
        found = json.loads(done.stdout)
        if found["status"] != "converged":
            return f"the solver in C: {found['status']}"
        return Times(found["cold_us"], found["warm_us"], found["igm_us"], found["jacobian_us"])

    def close(self) -> None:
        """Stop the compiler if it still works, and remove the files."""
        if self._compilation.poll() is None:
            self._compilation.kill()
            self._compilation.communicate()
        self._folder.cleanup()


def _sources(model: Model, names: Names) -> dict[str, str]:
    parts = assembled(model, names)
    every = kernels(model, names, parts)
    untimed = {names.kernel(word, rod) for rod in names.rods for word in ("tip_jacobian", "shape")}
    # The header declares all kernels; those that are not timed have a separate source.
    generated = kernel_sources(every, names)
    timed = kernel_sources([f for f in every if f.name() not in untimed], names)
    beside = kernel_sources([f for f in every if f.name() in untimed], names, "untimed")
    header = "timed_kernels.h"
    files = {
        **library_sources(model, names, FolderContents(generated, parts)),
        **beside,
        **timed,
        header: generated[header],
    }
    return {name: text for name, text in files.items() if name.endswith((".c", ".h"))}


def best_time(task: Callable[[], object]) -> float:
    """Measure the fastest of several runs, µs."""
    # The first run builds functions.
    task()
    best = inf
    end = time.perf_counter() + PATIENCE
    while time.perf_counter() < end or best == inf:
        start = time.perf_counter()
        task()
        seconds = time.perf_counter() - start
        best = min(best, seconds)
    return 1e6 * best
