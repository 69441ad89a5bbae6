"""Pieces that several reports share."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from cosserat_casadi.equilibrium.answer_error import UNKNOWN
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.rod.properties import STRAINS

ROUNDING = 1e-14
"""What is smaller beside the largest entry of a vector is shown as zero."""

SMALLEST = 1e-300
"""Keeps the scale of a vector of zeros away from zero."""


def print_plain(console: Console, sentence: str, *, soft_wrap: bool = False) -> None:
    """Print a sentence with its markup, without rich's colours for numbers and paths."""
    console.print(sentence, highlight=False, soft_wrap=soft_wrap)


def title_line(title: str | None) -> str:
    """The title of a scene, bold."""
    return f"[bold]{escape(title or 'Untitled scene')}[/]"


def print_written(console: Console, files: Iterable[Path], *, soft_wrap: bool = False) -> None:
    """Name the files that were written."""
    for file in files:
        print_plain(console, f"wrote {escape(str(file))}", soft_wrap=soft_wrap)


def table_of(*headings: str) -> Table:
    """An empty table."""
    table = Table()
    for heading in headings:
        table.add_column(heading)
    return table


def digits(vector: FloatArray) -> list[str]:
    """Entries with six digits; what is zero beside the largest one is shown as zero."""
    magnitudes = np.abs(vector)
    largest = max(float(magnitudes.max()), SMALLEST)
    # What is left of a cancellation would look like a result.
    rounded = np.where(magnitudes <= ROUNDING * largest, 0.0, vector)
    return [f"{entry:.6g}" for entry in rounded]


def listed(numbers: Sequence[int], noun: str) -> str:
    """Numbers behind their noun, such as "row 3" or "rows 3, 7"."""
    numbers_text = ", ".join(str(number) for number in numbers)
    if len(numbers) > 1:
        noun = f"{noun}s"
    return f"{noun} {numbers_text}"


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
