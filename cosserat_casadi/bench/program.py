"""A model compiled to a program that times itself: the exported sources with the exported demo."""

from __future__ import annotations

import json
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

from cosserat_casadi.codegen.assembled import assembled
from cosserat_casadi.codegen.kernels import kernels, sources
from cosserat_casadi.codegen.library import library_sources
from cosserat_casadi.codegen.names import Names, scene_names
from cosserat_casadi.model.build import Model

NAME = "timed"
"""What the symbols of the program begin with."""

FLAGS = ("-O2", "-std=c99")

REPEAT = 500
"""Runs of each task, of which the best counts."""


@dataclass(frozen=True)
class Times:
    """What the program measured of itself, µs.

    Attributes:
        cold: solve from the unloaded rod.
        warm: solve from the equilibrium of inputs one per cent away.
        igm: Inverse Geometric Model of the first rod.
        jacobian: residual and Jacobian.
    """

    cold: float
    warm: float
    igm: float
    jacobian: float


class Program:
    """A model on its way through the compiler, which works while other things are done.

    Args:
        model: what to compile.
        compiler: path of a C compiler.
    """

    def __init__(self, model: Model, compiler: str) -> None:
        self._compiler_errors = ""
        self._folder = tempfile.TemporaryDirectory()
        folder = Path(self._folder.name)
        names = scene_names(NAME, model.scene)
        for file, text in _sources(model, names).items():
            (folder / file).write_text(text, encoding="utf-8")
        # What the demo does not time is half of the work for the compiler: it is not optimised.
        files = ("timed_demo.c", "timed.c", "timed_kernels.c", "untimed.o")
        arguments = " ".join((*FLAGS, *files, "-lm", "-o", "demo"))
        script = f'"$0" -O0 -std=c99 -c untimed.c && "$0" {arguments}'
        self._compilation = subprocess.Popen(
            ["/bin/sh", "-c", script, compiler],
            cwd=folder,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
        )

    def wait(self) -> None:
        """Until the compiler is done."""
        _, errors = self._compilation.communicate()
        self._compiler_errors = errors.decode(errors="replace").strip()

    def times(self) -> Times | str:
        """Run it, compiled; a sentence where compiler or program fails."""
        if self._compilation.returncode:
            last_words = " ".join(self._compiler_errors[-200:].split())
            return f"the compiler fails: {last_words}"
        run = subprocess.run(
            ["./demo", "--repeat", str(REPEAT)],
            cwd=self._folder.name,
            capture_output=True,
            text=True,
            check=False,
        )
        # 3 is the demo's code for a solve that did not converge, which its output tells too.
        if run.returncode not in (0, 3):
            return f"the program ends with {run.returncode}"
        measured = json.loads(run.stdout)
        if measured["status"] != "converged":
            return f"the solver in C: {measured['status']}"
        return Times(
            cold=measured["cold_us"],
            warm=measured["warm_us"],
            igm=measured["igm_us"],
            jacobian=measured["jacobian_us"],
        )

    def close(self) -> None:
        """Stop the compiler if it still works, and remove the files."""
        if self._compilation.poll() is None:
            self._compilation.kill()
            self._compilation.communicate()
        self._folder.cleanup()


def _sources(model: Model, names: Names) -> dict[str, str]:
    """Text of every file that the compiler reads."""
    parts = assembled(model, names)
    functions = kernels(model, names, parts)
    untimed_names = {names.kernel(word, rod) for rod in names.rods for word in ("tip_jacobian", "shape")}
    timed = [function for function in functions if function.name() not in untimed_names]
    untimed = [function for function in functions if function.name() in untimed_names]
    files = {
        **library_sources(model, names, parts, None),
        **sources(timed, "timed_kernels", "int"),
        "untimed.c": sources(untimed, "untimed", "int")["untimed.c"],
    }
    # One header declares the functions of both.
    files["timed_kernels.h"] = sources(functions, "timed_kernels", "int")["timed_kernels.h"]
    return {name: text for name, text in files.items() if name.endswith((".c", ".h"))}
