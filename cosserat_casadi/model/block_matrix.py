"""A square matrix that is put together from blocks."""

from __future__ import annotations

from dataclasses import dataclass, field

import casadi as ca

from cosserat_casadi.maths.typing import Matrix


@dataclass
class BlockMatrix:
    """A square matrix made of blocks; blocks in the same rows and columns are added.

    Attributes:
        ends: last row of each block row, plus one; the same for columns.
        entries: blocks by the first of their rows and the first of their columns.
    """

    ends: list[int]
    entries: dict[tuple[int, int], Matrix] = field(default_factory=dict)

    def add(self, rows: slice, columns: slice, block: Matrix) -> None:
        """Add a block."""
        corner = (rows.start, columns.start)
        if corner in self.entries:
            block = self.entries[corner] + block
        self.entries[corner] = block

    def matrix(self) -> Matrix:
        """The whole, sparse."""
        starts = [0, *self.ends[:-1]]
        ranges = list(zip(starts, self.ends, strict=True))
        rows = []
        for top, bottom in ranges:
            row = []
            for left, right in ranges:
                # Unknowns that do not meet have a block without a stored entry.
                nothing = ca.DM(bottom - top, right - left)
                row.append(self.entries.get((top, left), nothing))
            rows.append(ca.horzcat(*row))
        return ca.vertcat(*rows)
