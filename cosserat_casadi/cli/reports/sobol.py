"""The report of ``sweep --sobol``."""

from __future__ import annotations

import numpy as np
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from cosserat_casadi.cli.reports.format import print_plain
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.spelling import counted
from cosserat_casadi.sweeps.sobol import SobolIndices


def print_sobol(console: Console, indices: SobolIndices) -> None:
    """Print the indices of every result, and the draws that they leave out."""
    table = Table()
    for heading in ("result", "input"):
        table.add_column(heading, no_wrap=True)
    for heading in ("first (95 %)", "total (95 %)"):
        table.add_column(heading)
    constant = []
    for name, found in indices.results.items():
        if not np.all(np.isfinite(found.first)):
            constant.append(name)
            continue
        for k, factor in enumerate(indices.factors):
            shown = escape(name) if k == 0 else ""
            first = _with_interval(found.first[k], found.first_interval[k])
            total = _with_interval(found.total[k], found.total_interval[k])
            table.add_row(shown, escape(factor), first, total)
    console.print(table)
    if constant:
        print_plain(console, f"Does not vary: {escape(', '.join(constant))}.", soft_wrap=True)
    if indices.left_out:
        sentence = (
            f"[bold yellow]Left out: {counted(indices.left_out, 'draw')} of {indices.samples + indices.left_out}, "
            "of which some row has no equilibrium.[/] The indices are those of the others."
        )
        print_plain(console, sentence, soft_wrap=True)


def _with_interval(value: float, bounds: FloatArray) -> str:
    return f"{value:.3f} ({bounds[0]:.3f} … {bounds[1]:.3f})"
