"""The quick numerical tests once more under the arithmetic of other machines: `python -m tests.arithmetic`.

OpenBLAS, NumPy and glibc choose their code by the processor, and round differently in each; compilers contract what
they optimise. Bounds that hold on one machine alone, and decisions by the last digit, fail under one of these.
"""

from __future__ import annotations

import argparse
import os
import platform
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from tests.conftest import C_FLAGS, ROOT

NUMERICAL = (
    "tests/maths",
    "tests/rod",
    "tests/numerics",
    "tests/scene",
    "tests/equilibrium",
    "tests/motion/test_transients.py",
)
"""Tests whose figures come from linear algebra and functions of NumPy and CasADi."""

COMPILED = ("tests/codegen/test_generated.py", "tests/codegen/test_functions.py", "tests/codegen/test_solver.py")
"""Tests whose figures come from generated C, compiled by the flags of the environment."""

CORES = {"Prescott": "pni", "Haswell": "avx2", "Zen": "avx2", "SkylakeX": "avx512f"}
"""Processors that OpenBLAS has code for, and the flag in /proc/cpuinfo of one that runs it."""

OPTIMISED = ("-O0", "-O2", "-O3 -march=native")
"""Flags for the C compiler."""

GLIBC = ",".join(f"-{name}" for name in ("AVX2", "FMA", "AVX2_Usable", "FMA_Usable"))
"""What glibc is to do without; before 2.33 the names ended in `_Usable`, and unknown names are ignored."""


@dataclass(frozen=True)
class Variant:
    """One arithmetic.

    Attributes:
        name: one line of the summary.
        environment: variables that choose it.
        tests: folders and files that are run under it.
        needs: flag of the processor without which it cannot be run; none where it is empty.
    """

    name: str
    environment: dict[str, str] = field(default_factory=dict)
    tests: tuple[str, ...] = (*NUMERICAL, *COMPILED)
    needs: str = ""

    def command(self, options: Sequence[str] = ()) -> list[str]:
        """Command line of the tests, with further options of pytest."""
        return [sys.executable, "-m", "pytest", "-q", "-m", "not slow", *options, *self.tests]

    def runs_on(self, flags: frozenset[str]) -> bool:
        """Whether a processor with these flags runs it."""
        return not self.needs or self.needs in flags


def numpy_features() -> str:
    """Features of processors that NumPy has code for beyond its baseline and finds on this one, space between."""
    from numpy._core import _multiarray_umath as core

    return " ".join(name for name in core.__cpu_dispatch__ if core.__cpu_features__[name])


def variants() -> list[Variant]:
    """All of them, those that need another processor included."""
    cores = [Variant(f"OpenBLAS for {core}", {"OPENBLAS_CORETYPE": core}, needs=flag) for core, flag in CORES.items()]
    functions = [
        Variant("NumPy's baseline", {"NPY_DISABLE_CPU_FEATURES": numpy_features()}),
        Variant("glibc without FMA", {"GLIBC_TUNABLES": f"glibc.cpu.hwcaps={GLIBC}"}, needs="fma"),
    ]
    threads = [Variant(f"{count} threads of BLAS", {"OPENBLAS_NUM_THREADS": str(count)}, NUMERICAL) for count in (1, 2)]
    compilers = [Variant(f"C by {flags}", {C_FLAGS: flags}, COMPILED) for flags in OPTIMISED]
    return [*cores, *functions, *threads, *compilers]


def processor_flags() -> frozenset[str]:
    """What this processor can, as Linux names it; nothing on other systems and processors."""
    file = Path("/proc/cpuinfo")
    if platform.machine() != "x86_64" or not file.is_file():
        return frozenset()
    lines = file.read_text().splitlines()
    return frozenset(next((line for line in lines if line.startswith("flags")), "").split())


def run(variant: Variant, options: Sequence[str]) -> bool:
    """Run the tests under one arithmetic; whether they passed."""
    settings = " ".join(f"{name}='{value}'" for name, value in variant.environment.items())
    print(f"\n{variant.name}: {settings}", flush=True)
    environment = {"OPENBLAS_NUM_THREADS": "1", **os.environ, **variant.environment}
    return subprocess.run(variant.command(options), cwd=ROOT, env=environment, check=False).returncode == 0


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", metavar="WORD", help="run what has this word in its name")
    parser.add_argument("options", nargs="*", help="options for pytest, after --")
    asked = parser.parse_args(arguments)
    flags = processor_flags()
    verdicts = {}
    for variant in variants():
        if asked.only not in variant.name:
            continue
        if variant.runs_on(flags):
            verdicts[variant.name] = "passed" if run(variant, asked.options) else "FAILED"
        else:
            verdicts[variant.name] = f"skipped: this processor has no {variant.needs}"
    print("\n" + "\n".join(f"{name:<24} {verdict}" for name, verdict in verdicts.items()))
    return int("FAILED" in verdicts.values())


if __name__ == "__main__":
    sys.exit(main())
