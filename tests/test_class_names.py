"""A class is found by its name: no two modules define classes of the same name."""

from __future__ import annotations

import ast
from collections import defaultdict

from tests.conftest import ROOT

PACKAGE = ROOT / "cosserat_casadi"

TWO_HOMES = {"Choice", "Estimates", "Plan", "Program"}
"""Names that have two homes still; the set only shrinks."""


def homes() -> dict[str, list[str]]:
    """Modules that define a public class, by its name."""
    modules = defaultdict(list)
    for path in sorted(PACKAGE.rglob("*.py")):
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                modules[node.name].append(str(path.relative_to(PACKAGE)))
    return modules


def test_a_class_name_has_one_home() -> None:
    shared = {name: places for name, places in homes().items() if len(places) > 1}
    assert set(shared) <= TWO_HOMES, shared
