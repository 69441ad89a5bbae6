"""Functions of tubes as CasADi writes them in C."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path
from typing import Any

import casadi as ca
from numpy.testing import assert_allclose


def check_functions_in_c(found: Any, folder: Path, away: float) -> None:
    """Compare equilibrium and Jacobian of the tips in C, from a start that is away, with those of a solution."""
    generator = ca.CodeGenerator("tubes.c")
    generator.add(found.model.equilibrium)
    generator.add(found.model.tip_jacobian)
    (folder / "tubes.c").write_text(generator.dump())
    command = [os.environ["CC"], "-shared", "-fPIC", "-o", "tubes.so", "tubes.c", "-lm"]
    subprocess.run(command, cwd=folder, check=True)
    library = str(folder / "tubes.so")
    x, missed = ca.external("equilibrium", library)(found.x + away, found.inputs)
    assert float(missed) < 1e-11
    assert_allclose(x.full()[:, 0], found.x, rtol=0, atol=1e-11)
    jacobian = ca.external("tip_jacobian", library)(x, found.inputs)
    assert_allclose(jacobian.full().reshape(found.tip_jacobian.shape), found.tip_jacobian, rtol=0, atol=1e-10)
