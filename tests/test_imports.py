"""The river flows one way: import contracts, and what a plain import may load."""

from __future__ import annotations

import ast
import subprocess
import sys

import pytest

import cosserat_casadi
from tests.conftest import ROOT


def test_import_contracts_hold() -> None:
    command = [sys.executable, "-c", "from importlinter.cli import lint_imports_command; lint_imports_command()"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_loads_and_actuators_do_not_know_each_other() -> None:
    """A member of a family is a file that no other member imports."""
    from cosserat_casadi.model.registry import EFFECTS

    files = {type(member).__module__ for member in EFFECTS.values()}
    assert len(files) == len(EFFECTS)
    for module in files:
        source = (ROOT / module.replace(".", "/")).with_suffix(".py").read_text()
        known = [name for name in files - {module} if f"from {name} " in source or f"import {name}" in source]
        assert not known, module


def test_public_names_exist() -> None:
    for name in cosserat_casadi.__all__:
        assert getattr(cosserat_casadi, name) is not None


def test_names_that_load_late_are_those_that_type_checkers_see() -> None:
    """``__init__`` says twice where a public name is defined: to the interpreter, and to type checkers and editors."""
    tree = ast.parse((ROOT / "cosserat_casadi" / "__init__.py").read_text())
    late = [f"cosserat_casadi.{module}.{name}" for module, names in cosserat_casadi._NAMES.items() for name in names]
    seen = []
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("cosserat_casadi"):
            for name in node.names:
                # Without the second name a type checker takes it as private.
                assert name.asname == name.name
                seen.append(f"{node.module}.{name.name}")
    assert late == seen
    assert len(cosserat_casadi.__all__) == len(seen)
    assert set(dir(cosserat_casadi)) >= set(cosserat_casadi.__all__)


def test_unknown_names_are_no_attributes() -> None:
    with pytest.raises(AttributeError, match="'cosserat_casadi' has no attribute 'sovle'"):
        cosserat_casadi.sovle  # noqa: B018
    assert not hasattr(cosserat_casadi, "Tubes")


@pytest.mark.slow
def test_every_name_loads_by_itself() -> None:
    """No module counts on another one that happened to be loaded before."""
    loads_alone = """
import os, sys
import casadi, numpy, pydantic, cosserat_casadi
for module in cosserat_casadi._NAMES:
    child = os.fork()
    if child == 0:
        for name in cosserat_casadi._NAMES[module]:
            getattr(cosserat_casadi, name)
        os._exit(0)
    if os.waitpid(child, 0)[1] != 0:
        print(module)
"""
    done = subprocess.run([sys.executable, "-c", loads_alone], capture_output=True, text=True, timeout=600, check=True)
    assert done.stdout == ""


EXTRAS = ("dask", "distributed", "matplotlib", "pyarrow", "scipy")
"""Packages that no program needs which solves a scene."""

BEYOND_A_SOLVE = "codegen compiling control environments estimation identification motion page plots sweeps tubes view"
"""Rooms that an equilibrium of rods needs nothing of."""

UNUSED_BY_A_SOLVE = (*EXTRAS, *(f"cosserat_casadi.{room}" for room in BEYOND_A_SOLVE.split()))


def loaded_by(program: str) -> list[str]:
    """Modules that a program has loaded in a process of its own."""
    code = f"{program}\nimport sys\nprint(*sys.modules)"
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=60, check=True)
    return done.stdout.splitlines()[-1].split()


@pytest.mark.parametrize(
    ("program", "unwanted"),
    [
        ("import cosserat_casadi", ("casadi", "numpy", "pydantic", "cosserat_casadi.")),
        ("import cosserat_casadi.cli.main", ("casadi", "numpy", "pydantic", "cosserat_casadi.scene")),
        ("import cosserat_casadi.cli.commands.solve", UNUSED_BY_A_SOLVE),
    ],
)
def test_program_loads_no_more_than_it_needs(program: str, unwanted: tuple[str, ...]) -> None:
    loaded = loaded_by(program)
    assert "cosserat_casadi" in loaded
    assert [module for module in loaded if module.startswith(unwanted)] == []


def test_solve_loads_no_more_than_it_needs() -> None:
    program = """
from cosserat_casadi import read_scene, solve
from cosserat_casadi.scene.load_records import TipWrench
from cosserat_casadi.scene.measurements import MeasuredPosition
assert solve(read_scene('examples/nitinol_wire.toml')).to_dict()['converged']
assert TipWrench.__pydantic_complete__
# The schema of a record is made when the first of its kind is read.
assert not MeasuredPosition.__pydantic_complete__
"""
    loaded = loaded_by(program)
    unwanted = (*UNUSED_BY_A_SOLVE, "typer", "rich", "cosserat_casadi.cli")
    assert [module for module in loaded if module.startswith(unwanted)] == []
