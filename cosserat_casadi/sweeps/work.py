"""The work of a sweep in chunks: rows that are solved together, kept together, and never solved again."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from cosserat_casadi.codegen.rows import RowLibrary
from cosserat_casadi.codegen.status import OUTCOMES
from cosserat_casadi.equilibrium.smooth_passage import has_barriers
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.sweeps.arguments import COMPILED_FROM, IN_CONTACT_FROM, touches_in_c
from cosserat_casadi.sweeps.device_rows import DeviceRows
from cosserat_casadi.sweeps.row_model import RowModel
from cosserat_casadi.sweeps.sampling import from_neighbour_to_neighbour
from cosserat_casadi.sweeps.variants import Variants

COMPILED_ROWS = 512
"""Rows of a chunk that a compiled library solves: milliseconds, so that little is lost by a kill."""

MODELLED_ROWS = 16
"""Rows of a chunk that is solved in Python."""


@dataclass(frozen=True)
class InContact:
    """A library of rods in exact contact, which knows some arrangements of contacts; Python for rows that it leaves.

    Attributes:
        library: solves a row from the one before it.
        model: the same scene in Python.
    """

    library: RowLibrary
    model: RowModel

    def solve(self, inputs: FloatArray) -> FloatArray:
        """Rows of results for rows of inputs and parameters, which are solved from neighbour to neighbour."""
        order = from_neighbour_to_neighbour(inputs)
        results = np.empty((len(inputs), self.library.results))
        results[order] = self.library.solve(inputs[order])
        left = order[results[order, 0] != 0]
        if left.size:
            results[left] = self.model.solve(inputs[left])
        return results


@dataclass(frozen=True)
class WatchedRows:
    """A library none of whose steps leads through an obstacle or a rod; Python for rows that stall, which may settle.

    Attributes:
        library: solves rows.
        model: the same scene in Python.
    """

    library: RowLibrary | DeviceRows
    model: RowModel

    def solve(self, inputs: FloatArray) -> FloatArray:
        """Rows of results for rows of inputs and parameters."""
        results = self.library.solve(inputs)
        stalled = np.flatnonzero(results[:, 0] == OUTCOMES.index(Outcome.LOAD_STALLED))
        if stalled.size:
            results[stalled] = self.model.solve(inputs[stalled])
        return results


Answer: TypeAlias = RowLibrary | DeviceRows | RowModel | InContact | WatchedRows
"""Solves rows."""

Part = tuple[Answer, FloatArray]
"""Rows of inputs, and what solves them."""


@dataclass(frozen=True)
class Chunk:
    """Rows that are solved in one go.

    Attributes:
        number: counted from 0.
        pieces: for each scene the chunk has rows of, its index among the variants and its rows in the table.
        compiled: whether threads of this process solve the rows, by a compiled library.
        in_contact: whether one compiled library solves most rows, and Python the rest.
    """

    number: int
    pieces: tuple[tuple[int, npt.NDArray[np.int64]], ...]
    compiled: bool
    in_contact: bool = False

    @property
    def rows(self) -> npt.NDArray[np.int64]:
        """Rows in the table, in the order in which they are solved."""
        pieces = [rows for _, rows in self.pieces]
        return np.concatenate(pieces)


def chunks(
    variants: Variants,
    compiled_from: int = COMPILED_FROM,
    *,
    compiled_rows: int | None = None,
) -> list[Chunk]:
    """All work of a table; the same table gives the same chunks.

    Args:
        variants: the scenes of the table.
        compiled_from: rows of one scene from which it is compiled.
        compiled_rows: rows of a chunk that a device solves; of one that a compiled library does by default.
    """
    listed: list[Chunk] = []
    modelled = []
    for index, entry in enumerate(variants.entries):
        few = len(entry.rows) < compiled_from and variants.parameters and not variants.arguments
        in_contact = len(entry.rows) >= IN_CONTACT_FROM and touches_in_c(entry.scene)
        # Tubes choose their steps row by row.
        if few or entry.scene.tubes or (entry.scene.touches_exactly and not in_contact):
            modelled += [(index, int(row)) for row in entry.rows]
            continue
        in_contact = in_contact or has_barriers(entry.scene)
        size = compiled_rows or COMPILED_ROWS
        # A device is used by this process alone.
        in_threads = not in_contact or compiled_rows is not None
        for first in range(0, len(entry.rows), size):
            rows = entry.rows[first : first + size]
            listed.append(Chunk(len(listed), ((index, rows),), in_threads, in_contact))
    # Variants of few rows share chunks, so that none is too small to be worth its transport.
    for first in range(0, len(modelled), MODELLED_ROWS):
        pieces = _pieces(modelled[first : first + MODELLED_ROWS])
        listed.append(Chunk(len(listed), tuple(pieces), compiled=False))
    return listed


def solve_parts(parts: Sequence[Part]) -> FloatArray:
    """Results of all rows of a chunk; they depend on these arguments alone."""
    results = [answer.solve(inputs) for answer, inputs in parts]
    return np.vstack(results)


def _pieces(rows: Sequence[tuple[int, int]]) -> Iterator[tuple[int, npt.NDArray[np.int64]]]:
    """Pairs of variant and row, as one array of rows for each variant."""
    rows_of: dict[int, list[int]] = {}
    for variant, row in rows:
        rows_of.setdefault(variant, []).append(row)
    for variant, own_rows in rows_of.items():
        yield variant, np.array(own_rows)
