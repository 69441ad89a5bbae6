"""Numbers of results, and modes and intervals of rods, as text."""

from __future__ import annotations

import numpy as np
from rich.markup import escape
from rich.table import Table

from cosserat_casadi.cli.reports.format import table_of
from cosserat_casadi.equilibrium.answer_error import UNKNOWN
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.rod.properties import STRAINS

ROUNDING = 1e-14
"""Share of the largest entry of a vector below which an entry is shown as zero."""

SMALLEST = 1e-300
"""Keeps the scale of a vector of zeros away from zero."""


def digits(vector: FloatArray) -> list[str]:
    """Entries with six digits; an entry that is negligible beside the largest one is shown as zero."""
    magnitudes = np.abs(vector)
    largest = max(float(magnitudes.max()), SMALLEST)
    # What is left of a cancellation would look like a result.
    rounded = np.where(magnitudes <= ROUNDING * largest, 0.0, vector)
    return [f"{entry:.6g}" for entry in rounded]


def error_words(error: float, within: bool | None, tolerance: float) -> str:
    """An estimated error with markup: beside the tolerance, told apart above it; alone where none has a meaning."""
    words = f"{error:.1e} of the length"
    if error == UNKNOWN:
        words = "not known"
    if within is None:
        return words
    if within:
        return f"{words}, within the tolerance of {tolerance:g}"
    return f"[bold yellow]{words}, above the tolerance of {tolerance:g}[/]"


def discretisation_table(model: Model) -> Table:
    """Strains, modes, intervals, elements and integrator of every rod."""
    table = table_of("rod", "strains", "modes", "intervals", "elements", "rotation by")
    for name, d in model.discretisation.items():
        properties = model.discrete.rods[name].properties
        strains = ", ".join(STRAINS[index] for index in properties.admitted)
        modes = ", ".join(str(count) for count in d.modes)
        table.add_row(escape(name), strains, modes, str(d.nodes), str(d.elements), d.transport)
    return table
