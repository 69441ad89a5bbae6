"""Numbers of results, and modes and intervals of rods, as text."""

from __future__ import annotations

from rich.markup import escape
from rich.table import Table

from cosserat_casadi.cli.reports.format import table_of
from cosserat_casadi.equilibrium.answer_error import UNKNOWN
from cosserat_casadi.model.build import Model
from cosserat_casadi.rod.properties import STRAINS


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
