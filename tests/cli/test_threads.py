"""A command computes with one thread of BLAS, or with as many as its environment says."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

PROGRAM = """
import os, sys
from cosserat_casadi.cli.main import main
sys.argv[1:] = ["--version"]
# NumPy reads the number when it is imported.
assert "numpy" not in sys.modules
try:
    main()
finally:
    assert "numpy" in sys.modules
    print("threads", os.environ["OPENBLAS_NUM_THREADS"])
"""


@pytest.mark.parametrize("asked", [None, "3"])
def test_threads_of_blas(asked: str | None) -> None:
    environment = {name: value for name, value in os.environ.items() if name != "OPENBLAS_NUM_THREADS"}
    if asked is not None:
        environment["OPENBLAS_NUM_THREADS"] = asked
    done = subprocess.run([sys.executable, "-c", PROGRAM], env=environment, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == f"threads {asked or 1}"
