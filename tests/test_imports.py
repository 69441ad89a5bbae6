"""The river flows one way: import contracts, and what a plain import may load."""

from __future__ import annotations

import subprocess
import sys

from tests.conftest import ROOT


def test_import_contracts_hold() -> None:
    command = [sys.executable, "-c", "from importlinter.cli import lint_imports_command; lint_imports_command()"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_plain_import_loads_neither_matplotlib_nor_the_command_line() -> None:
    unwanted = ("matplotlib", "typer", "rich", "scipy", "distributed", "dask", "pyarrow")
    code = f"import sys, cosserat_casadi; print([m for m in {unwanted} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout.strip() == "[]"


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
    import cosserat_casadi

    for name in cosserat_casadi.__all__:
        assert getattr(cosserat_casadi, name) is not None
