"""What the type checker sees of CasADi: its names exist, and mistakes with matrices are errors."""

import ast
import os
import subprocess
import sys
from pathlib import Path

import casadi as ca
import pytest

ROOT = Path(__file__).resolve().parents[2]
STUB = ROOT / "tests" / "stubs" / "casadi" / "__init__.pyi"
KINDS = {"SX": [ca.SX], "MX": [ca.MX], "DM": [ca.DM], "Matrix": [ca.SX, ca.MX, ca.DM], "Sparsity": [ca.Sparsity]}

# Each line with the code of the error that it must raise, or None where it is right.
SNIPPETS = {
    "hat(ca.DM([1.0, 2.0, 3.0]))": None,
    "hat(ca.MX.sym('v', 3)) @ ca.DM.ones(3, 1) + 1.0": None,
    "ca.vertcat(ca.DM(0), any_matrix, 1.0).T.nnz()": None,
    "quaternion_product(np.ones(4), np.ones(4)).tolist()": None,
    "ca.DM([1.0]).full() + np.ones(1)": None,
    "hat(np.ones(3))": "type-var",
    "hat(1.0)": "type-var",
    "stiffness(np.ones(3))": "arg-type",
    "stiffness(None)": "arg-type",
    "any_matrix.full()": "attr-defined",
    "ca.MX.sym('x').full()": "attr-defined",
    "any_matrix.nonexistent": "attr-defined",
    "any_matrix + 'text'": "operator",
    "any_matrix @ None": "operator",
    "ca.vertcat(any_matrix, None)": "call-overload",
    "quaternion_product(np.ones(4), ca.DM.ones(4))": "type-var",
}


def declared(body):
    """Names that a stub's body declares, without private ones."""
    names = {node.name for node in body if isinstance(node, ast.FunctionDef | ast.ClassDef)}
    return {name for name in names if name.startswith("__") or not name.startswith("_")}


def test_every_name_of_the_stub_vs_casadi():
    tree = ast.parse(STUB.read_text())
    assert declared(tree.body) - {"__getattr__", "Matrix"} <= set(dir(ca))
    for node in tree.body:
        if isinstance(node, ast.ClassDef):
            for kind in KINDS[node.name]:
                assert declared(node.body) <= set(dir(kind)), kind


@pytest.fixture(scope="module")
def complaints(tmp_path_factory):
    """Codes of the checker's errors in each snippet."""
    head = [
        "import casadi as ca",
        "import numpy as np",
        "from cosserat_casadi.maths.magnus import increment",
        "from cosserat_casadi.maths.rotation import hat, quaternion_product",
        "from cosserat_casadi.maths.typing import Matrix",
        "any_matrix: Matrix = ca.DM(3, 1)",
        "stiffness = increment(any_matrix).stiffness",
    ]
    folder = tmp_path_factory.mktemp("snippets")
    file = folder / "snippets.py"
    file.write_text("\n".join([*head, *SNIPPETS]) + "\n")
    options = ["--config-file", str(ROOT / "pyproject.toml"), "--cache-dir", str(ROOT / ".mypy_cache"), str(file)]
    command = [sys.executable, "-m", "mypy", "--no-error-summary", "--hide-error-context", *options]
    environment = {**os.environ, "MYPYPATH": str(ROOT)}
    output = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False, env=environment).stdout
    errors = {snippet: set() for snippet in SNIPPETS}
    for line in output.splitlines():
        if f"{file.name}:" in line and ": error:" in line:
            number = int(line.split(f"{file.name}:")[1].split(":")[0])
            errors[list(SNIPPETS)[number - len(head) - 1]].add(line.rsplit("[", 1)[1].rstrip("]"))
    return errors


@pytest.mark.parametrize("snippet", SNIPPETS)
def test_mistakes_are_errors(snippet, complaints):
    expected = SNIPPETS[snippet]
    assert complaints[snippet] == ({expected} if expected else set())
