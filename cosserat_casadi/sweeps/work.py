"""The work of a sweep in chunks: rows that are solved together, kept together, and never solved again.

Shards are parts of this work that machines do for themselves, and that are merged into one file of results. A shard
keeps its finished rows in its file beside the results, as an unfinished sweep does. So a shard that was killed goes on,
and shards on one file system need no word between them.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from cosserat_casadi.codegen.rows import RowLibrary
from cosserat_casadi.codegen.status import OUTCOMES
from cosserat_casadi.equilibrium.smooth_passage import has_barriers
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.sweeps.arguments import COMPILED_FROM, IN_CONTACT_FROM, touches_in_c
from cosserat_casadi.sweeps.device_rows import DeviceRows
from cosserat_casadi.sweeps.row_model import RowModel
from cosserat_casadi.sweeps.sampling import from_neighbour_to_neighbour
from cosserat_casadi.sweeps.variants import Variants

MOST = 100_000
"""Shards into which a sweep may be cut."""

TOLD = 5
"""Shards that a sentence names."""

COMPILED_ROWS = 512
"""Rows of a chunk that a compiled library solves: milliseconds, so that little is lost by a kill."""

MODELLED_ROWS = 16
"""Rows of a chunk that is solved in Python."""

STALLED = OUTCOMES.index(Outcome.LOAD_STALLED)
"""Outcome of rows that stop before an obstacle or a rod."""


@dataclass(frozen=True)
class LibraryWithPython:
    """A library, and Python for the rows that it leaves.

    In exact contact it knows some arrangements of contacts, solves each row from its neighbour, and leaves all rows
    without an equilibrium. Elsewhere none of its steps leads through an obstacle or a rod: it leaves rows that stall,
    which may settle.

    Attributes:
        library: solves rows.
        model: the same scene in Python.
        in_contact: whether rods touch obstacles exactly.
    """

    library: RowLibrary | DeviceRows
    model: RowModel
    in_contact: bool

    def solve(self, inputs: FloatArray) -> FloatArray:
        """Rows of results for rows of inputs and parameters."""
        order = from_neighbour_to_neighbour(inputs) if self.in_contact else np.arange(len(inputs))
        results = np.empty((len(inputs), self.library.results))
        results[order] = self.library.solve(inputs[order])
        outcomes = results[order, 0]
        left = order[outcomes != 0 if self.in_contact else outcomes == STALLED]
        if left.size:
            results[left] = self.model.solve(inputs[left])
        return results


Answer: TypeAlias = RowLibrary | DeviceRows | RowModel | LibraryWithPython
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
    modelled: list[tuple[int, int]] = []
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
        by_variant = groupby(modelled[first : first + MODELLED_ROWS], key=itemgetter(0))
        pieces = tuple((index, np.array([row for _, row in rows])) for index, rows in by_variant)
        listed.append(Chunk(len(listed), pieces, compiled=False))
    return listed


def solve_parts(parts: Sequence[Part]) -> FloatArray:
    """Results of all rows of a chunk; they depend on these arguments alone."""
    results = [answer.solve(inputs) for answer, inputs in parts]
    return np.vstack(results)


@dataclass(frozen=True)
class Shard:
    """A part of a sweep that is cut into several.

    Attributes:
        number: from 1 to count.
        count: parts that the sweep is cut into.
    """

    number: int
    count: int

    @classmethod
    def read(cls, text: str) -> Shard:
        """The shard that a word such as ``3/64`` means.

        Raises:
            SceneError: it means none.
        """
        match = re.fullmatch(r"0*([0-9]{1,6})/0*([0-9]{1,6})", text.strip())
        number, count = (int(word) for word in match.groups()) if match else (0, 0)
        if not 1 <= number <= count <= MOST:
            problem = f"{text!r} is no shard"
            raise SceneError(Problem("--shard", problem, f"such as 3/64, the third of 64; at most {MOST} shards"))
        return cls(number, count)

    def __str__(self) -> str:
        return f"{self.number}/{self.count}"

    def has(self, chunk: Chunk) -> bool:
        """Whether a chunk of the sweep is of this shard: chunks are dealt out one by one, so that all take as long."""
        return chunk.number % self.count == self.number - 1

    def file(self, output: Path) -> Path:
        """File in which a shard keeps its finished rows, beside the file of the results."""
        width = len(str(self.count))
        return output.with_name(f"{output.name}.shard-{self.number:0{width}}-of-{self.count}")


def shard_files(output: Path) -> dict[Shard, Path]:
    """The files of all shards that have begun, in their order."""
    pattern = re.compile(re.escape(output.name) + r"\.shard-([0-9]{1,6})-of-([0-9]{1,6})")
    found: dict[Shard, Path] = {}
    for path in sorted(output.parent.iterdir()):
        match = pattern.fullmatch(path.name)
        if match is not None:
            found[Shard(int(match.group(1)), int(match.group(2)))] = path
    return found
