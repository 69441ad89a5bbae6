"""Modes and intervals of the rods of a model."""

from __future__ import annotations

from rich.markup import escape
from rich.table import Table

from cosserat_casadi.cli.reports.format import table_of
from cosserat_casadi.model.build import Model
from cosserat_casadi.rod.properties import STRAINS


def discretisation_sentences(model: Model) -> list[str]:
    """Modes, intervals and elements of every rod."""
    sentences = []
    for name, d in model.discretisation.items():
        sentence = f"{name}: modes {list(d.modes)}, {d.nodes} intervals"
        if d.elements > 1:
            sentence += f" in {d.elements} elements"
        sentences.append(sentence)
    return sentences


def discretisation_table(model: Model) -> Table:
    """Strains, modes, intervals, elements and integrator of every rod."""
    table = table_of("rod", "strains", "modes", "intervals", "elements", "rotation by")
    for name, d in model.discretisation.items():
        properties = model.discrete.rods[name].properties
        strains = ", ".join(STRAINS[index] for index in properties.admitted)
        modes = ", ".join(str(count) for count in d.modes)
        table.add_row(escape(name), strains, modes, str(d.nodes), str(d.elements), d.transport)
    return table
