"""The results of a sweep: a row for each solve with its inputs, outcome and results."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from cosserat_casadi.codegen.rows import ERRORS
from cosserat_casadi.codegen.status import OUTCOMES
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.result import Result
from cosserat_casadi.sweeps.scratch import MEMORY, Scratch

ENDINGS = (*OUTCOMES, Outcome.CONTACT_UNSETTLED)
"""Outcomes of rows: of the solver in C, and of rows in contact that Python solves."""

ERROR, WITHIN = ERRORS
"""Columns of the estimated error, and of whether it is within the tolerance."""

LABELS = tuple(outcome.label for outcome in ENDINGS)
"""Words of the column ``outcome``."""


@dataclass(frozen=True, repr=False)
class Sweep(Result):
    """Every row of a table, solved.

    Attributes:
        swept: columns of the table.
        found: columns of the results: iterations, residual, poses of tips and bodies, efforts of actuators, errors.
        values: numbers of both, shape (rows, len(swept) + len(found)); results of failed rows are NaN.
        outcomes: outcome of each row as an index in LABELS, shape (rows,).
        record: scene, discretisation and accuracy as plain data, from the file of the record; empty without one.
        scratch: storage of values and outcomes.
    """

    swept: tuple[str, ...]
    found: tuple[str, ...]
    values: FloatArray
    outcomes: npt.NDArray[np.int64]
    record: dict[str, Any]
    scratch: Scratch = MEMORY

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of all columns of numbers."""
        return (*self.swept, *self.found)

    @property
    def converged(self) -> npt.NDArray[np.bool_]:
        """Whether each row has an equilibrium, shape (rows,)."""
        return np.asarray(self.outcomes == 0)

    @property
    def outcome(self) -> list[str]:
        """Outcome of each row in words."""
        return [LABELS[number] for number in self.outcomes]

    @property
    def counts(self) -> dict[str, int]:
        """Number of rows with each outcome."""
        counted = np.bincount(self.outcomes).tolist()
        return {LABELS[number]: count for number, count in enumerate(counted) if count}

    @property
    def holds(self) -> bool:
        """Whether some row converged, and no error estimate is above the scene's tolerance.

        It is false without a record.
        """
        if not self.record:
            return False
        tolerance = self.record["tolerance"]
        errors = [row["difference"] for row in self.record["checked"]]
        # A default tolerance does not apply to modes that the scene fixes.
        if self.tolerance_binds:
            # With a discretisation that the scene fixes there is no estimate beforehand; the rows decide.
            errors.append(self.record["chosen"]["error_estimate"] or 0.0)
            errors += [row["error_estimate"] for row in self.record["checked"]]
        # A row without an equilibrium in Python has no error, and so cannot be within the tolerance.
        errors = [np.inf if error is None else error for error in errors]
        within_tolerance = all(error <= tolerance for error in errors)
        return within_tolerance and not self.missed_count and LABELS[0] in self.counts

    @property
    def tolerance_binds(self) -> bool:
        """Whether the tolerance of the record applies; it does for older records, which do not say."""
        return bool(self.record.get("tolerance_binds", True))

    @property
    def missed(self) -> npt.NDArray[np.bool_]:
        """Whether each row has an equilibrium above the tolerance, shape (rows,); none without estimates."""
        if WITHIN not in self.found:
            return np.zeros(len(self.values), dtype=bool)
        return np.asarray(self.converged & (self[WITHIN] == 0.0))

    @property
    def missed_count(self) -> int:
        """Number of rows above the tolerance."""
        return sum(int(part.missed.sum()) for _, part in self.parts())

    @property
    def worst(self) -> tuple[int, float, int]:
        """Number of converged rows with error estimates, the largest estimate, and its row; NaN without any."""
        if ERROR not in self.found:
            return 0, np.nan, 0
        known, largest, row = 0, np.nan, 0
        for first, part in self.parts():
            errors = np.where(part.converged & np.isfinite(part[ERROR]), part[ERROR], -np.inf)
            known += int(np.isfinite(errors).sum())
            at = int(errors.argmax())
            if np.isfinite(errors[at]) and not errors[at] <= largest:
                largest, row = float(errors[at]), first + at
        return known, largest, row

    def parts(self) -> Iterator[tuple[int, Sweep]]:
        """The rows in blocks, each with the index of its first row, to save memory."""
        for rows in self.scratch.blocks(len(self.values)):
            yield rows.start, replace(self, values=self.values[rows], outcomes=self.outcomes[rows])

    def __getitem__(self, column: str) -> FloatArray:
        """A column, shape (rows,).

        Raises:
            KeyError: there is no such column.
        """
        if column not in self.columns:
            raise KeyError(f"{column!r} is no column; there are {', '.join(self.columns)}")
        index = self.columns.index(column)
        return self.values[:, index]

    @property
    def posed(self) -> list[str]:
        """Rods and bodies whose poses are among the results."""
        # Only poses have quaternions among the results.
        scalar_parts = [name for name in self.found if name.endswith(".qw")]
        return [name.removesuffix(".qw") for name in scalar_parts]

    def positions(self, name: str | None = None) -> FloatArray:
        """Positions of a tip or a body, shape (rows, 3), m; of the first by default."""
        chosen = self.posed[0] if name is None else name
        columns = [self[f"{chosen}.{axis}"] for axis in "xyz"]
        return np.column_stack(columns)
