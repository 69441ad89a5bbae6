"""What the summary of a sweep says: the verdict on its discretisation and on the rows that were solved again."""

from __future__ import annotations

from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.console import Console

from cosserat_casadi.cli.reports.sweep import print_sweep
from cosserat_casadi.sweeps.outcome_table import Sweep

CHOSEN = {"discretisation": {"modes": [3, 4], "nodes": 9, "rotation": "magnus4"}, "rows": [0, 1, 2], "converged": 3}
FINE = {"row": 1, "error_estimate": 2e-5, "difference": 1e-12, "stable": True}


def summary(chosen: dict[str, Any], *checked: dict[str, Any]) -> str:
    record = {"title": "Made up", "tolerance": 1e-4, "chosen": CHOSEN | chosen, "checked": [*checked]}
    sweep = Sweep(("a.b",), ("iterations",), np.zeros((3, 2)), np.zeros(3, dtype=np.int64), record)
    out = Console(file=StringIO(), width=200)
    print_sweep(out, sweep, Path("a.csv"), None, finished=False)
    assert isinstance(out.file, StringIO)
    return out.file.getvalue()


@pytest.mark.parametrize(
    ("chosen", "checked", "said"),
    [
        ({"error_estimate": 3e-5}, [FINE], "[3, 4], 9 intervals, chosen on 3 rows: estimated error 3.0e-05, within"),
        ({"error_estimate": 3e-3, "converged": 2}, [], "2 of which have an equilibrium: estimated error 3.0e-03, more"),
        ({"error_estimate": None, "converged": 0}, [], "but none has an equilibrium"),
        ({"discretisation": None, "error_estimate": None}, [], "The scene fixes modes, nodes or rotation"),
        ({"error_estimate": 3e-5}, [FINE], "1 row solved again in Python: estimated error at most 2.0e-05, within"),
        ({"error_estimate": 3e-5}, [FINE], "poses differ by at most 1.0e-12."),
        ({"error_estimate": 3e-5}, [FINE | {"difference": 1.4e-63}], "poses differ by rounding alone."),
        ({"error_estimate": 3e-5}, [FINE, FINE | {"error_estimate": 2e-3}], "2 rows solved again in Python"),
        ({"error_estimate": 3e-5}, [FINE | {"error_estimate": 2e-3}], "2.0e-03, more than 0.0001"),
        ({"error_estimate": 3e-5}, [FINE | {"difference": 0.1}], "another equilibrium for row 2."),
        ({"error_estimate": 3e-5}, [FINE | {"difference": None}], "no equilibrium for row 2."),
        ({"error_estimate": 3e-5}, [FINE | {"stable": False}, FINE | {"stable": False, "row": 2}], "these: rows 2, 3."),
    ],
)
def test_sentences_of_the_summary(chosen: dict[str, Any], checked: list[dict[str, Any]], said: str) -> None:
    assert said in summary(chosen, *checked)
