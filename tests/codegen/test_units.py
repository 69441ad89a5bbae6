"""The static functions of the solver in C, stepped through one by one."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.codegen.libraries import C99, HARNESS, Exported, gcc, run
from tests.conftest import ROOT
from tests.families import mostly_slow

Library = Callable[[str], Exported]

SANITIZED = ("-O1", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover", "-Wno-unused-function")


@pytest.mark.parametrize(
    ("name", "harness"),
    mostly_slow(
        [
            ("planar", "units_dense.c"),
            ("spatial", "units_dense.c"),
            ("pinned", "units_dense.c"),
            ("gripper", "units_blocks.c"),
        ],
        quick=[("planar", "units_dense.c")],
    ),
)
def test_parts_of_the_solver(library: Library, name: str, harness: str) -> None:
    made = library(name)
    defaults = f"-DSOLVER_DEFAULTS={made.names.macro}_DEFAULTS"
    run(made.whole_program(harness, *SANITIZED, defaults, f"-I{HARNESS}"))


@pytest.mark.parametrize("harness", ["units_misfit.c", "units_second_variation.c"])
def test_algorithm_with_equations_of_the_test(harness: str, tmp_path: Path) -> None:
    include = f"-I{ROOT / 'cosserat_casadi' / 'compiling' / 'c'}"
    gcc(*C99, *SANITIZED, include, HARNESS / harness, "-lm", "-o", tmp_path / "units")
    run(tmp_path / "units")
