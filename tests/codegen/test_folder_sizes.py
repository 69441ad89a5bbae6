"""Budgets on the bytes of C of exported examples: what compilers take grows with them (benchmarks/folder_cost.py)."""

from __future__ import annotations

import pytest

from cosserat_casadi import read_scene, solve_scene
from cosserat_casadi.codegen.export import folder_files
from tests.conftest import ROOT
from tests.families import mostly_slow

BUDGETS = {
    "planar_strip": 200_000,
    "nitinol_wire": 545_000,
    "follower_reissner": 555_000,
    "two_section_robot": 980_000,
    "six_rod_platform": 1_500_000,
}
"""Bytes of the sources and headers of the library at the tolerance of the example."""


@pytest.mark.parametrize("name", mostly_slow(BUDGETS, quick=["planar_strip"]))
def test_bytes_of_c_of_examples(name: str) -> None:
    solution = solve_scene(read_scene(ROOT / "examples" / f"{name}.toml"))
    assert solution.converged
    files = folder_files(solution.model, "sized")
    wanted = {file: text for file, text in files.items() if file.endswith((".c", ".h")) and "_demo" not in file}
    assert sum(map(len, wanted.values())) <= BUDGETS[name]
