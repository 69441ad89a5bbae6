"""Constant arrays of a kernel: numbers, and places of numbers that are brought together."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cosserat_casadi.compiling.numbered import Numbers
from cosserat_casadi.compiling.printed_kernels import ConstantTable

WIDEST_TURN = 120
"""Entries of a turn up to which places are looked through for turns that move on by equal steps."""

LEAST_SAVED = 4
"""Numbers that a table must be shorter by where entries become another group."""


class ConstantTables:
    """Constant arrays of a kernel, each there once."""

    def __init__(self) -> None:
        self.by_name: dict[str, ConstantTable] = {}
        self._names: dict[ConstantTable, str] = {}

    def of_integers(self, numbers: Numbers) -> str:
        """The name of a table of whole numbers in C."""
        return self._named(ConstantTable("int", tuple(map(str, numbers.tolist()))))

    def of_places(self, places: Numbers) -> str:
        """The name of a table of places in groups (program.h), and their count, from an array with an entry a row."""
        groups = _groups(places)
        return f"{self.of_integers(np.concatenate(groups))}, {len(groups)}"

    def of_numbers(self, values: Sequence[float]) -> str:
        """The name of a table of numbers in C."""
        return self._named(ConstantTable("casadi_real", tuple("0" if value == 0 else repr(value) for value in values)))

    def _named(self, table: ConstantTable) -> str:
        name = self._names.setdefault(table, f"t{len(self._names)}")
        self.by_name[name] = table
        return f"TABLE({name})"


def _groups(places: Numbers) -> list[Numbers]:
    """Places in groups whose turns move on by equal steps, as routines of program.h read them.

    Each group is the number of entries of a turn, the number of turns, the places of the first turn and, where there
    are more, the step of each from turn to turn.

    Args:
        places: one entry or product a row, shape (count, places of each).
    """
    saved, width, turns = _longest_turns(places)
    groups = []
    alone = first = 0
    while first <= len(places):
        ends = first == len(places)
        if (ends or saved[first]) and alone < first:
            groups.append(np.concatenate([[first - alone, 1], places[alone:first].ravel()]))
        if ends:
            return groups
        if not saved[first]:
            first += 1
            continue
        one, count = width[first], turns[first]
        begin = places[first : first + one]
        steps = places[first + one : first + 2 * one] - begin
        groups.append(np.concatenate([[one, count], begin.ravel(), steps.ravel()]))
        first += one * count
        alone = first
    return groups


def _longest_turns(places: Numbers) -> tuple[Numbers, Numbers, Numbers]:
    """The turns that begin at each entry and save most: numbers that they save, 0 for none, their width and count."""
    entries, of_each = places.shape
    saved = np.zeros(entries, dtype=np.int64)
    width = np.zeros_like(saved)
    turns = np.zeros_like(saved)
    # Two turns are as many numbers as places and steps.
    for one in range(1, min(WIDEST_TURN, entries // 3) + 1):
        bends = places[2 * one :] - 2 * places[one:-one] + places[: -2 * one]
        here = np.arange(len(bends))
        end = np.where(np.any(bends, axis=1), here, len(bends))
        straight = np.minimum.accumulate(end[::-1])[::-1] - here
        count = (straight + 2 * one) // one
        less = of_each * one * (count - 2) - 2
        better = np.flatnonzero((less >= LEAST_SAVED) & (less > saved[: len(bends)]))
        saved[better] = less[better]
        width[better] = one
        turns[better] = count[better]
    return saved, width, turns
