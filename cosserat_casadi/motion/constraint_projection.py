"""Positions between the ends of steps put back on the constraints: supports, joints and cables are closed all along.

The polynomial of a step leaves the constraints by as much as it is inexact. The smallest displacement that closes them
is far below the tolerance of the motion.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.calls import chooses, evaluated
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.function_table import kept_with
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.motion.displacement import displacements
from cosserat_casadi.motion.repeated_call import external
from cosserat_casadi.numerics.consistent_start import regular_inverse
from cosserat_casadi.numerics.motion_equations import Instant, MotionEquations
from cosserat_casadi.numerics.step import Instants

CLOSED = 1e-12
"""Largest row of a constraint, without unit, that counts as closed."""

MOST_CORRECTIONS = 12
"""Most corrections of a state."""

INDEPENDENT = 1e-8
"""Eigenvalue of the normal equations of constraints, over the largest, from which they are clearly independent."""

CONTRACTED = 0.2
"""Share of the gaps that a correction may leave before the next one has a new Jacobian."""


GAPS = "motion_gaps"
"""Name of the rows of the constraints in C."""


Near = Callable[[int], tuple[MotionEquations, Instant]]
"""Number of an instant ↦ the equations of motion there, and an instant nearby."""


@dataclass(frozen=True)
class Closing:
    """Projection of the unknowns of a model on its constraints.

    Attributes:
        model: the model.
        library: shared object that has :func:`functions_of_closing`; None without one.
    """

    model: Model
    library: str | None = None

    @cached_property
    def rows(self) -> npt.NDArray[np.int64]:
        """Rows of the residual that are constraints on positions alone."""
        return constraint_rows(self.model)

    def closed(self, at: Instants, inputs: FloatArray, near: Near) -> FloatArray:
        """Unknowns at T instants, each moved by the smallest displacement that closes the constraints, shape (T, size).

        Args:
            at: instants of the motion, in the unknowns of the model.
            inputs: inputs at these instants, shape (T, model.inputs.size).
            near: gives, for the number of an instant, the equations and where the first Jacobian is evaluated: an end
                of the step that the instant is in, for many instants.
        """
        x = at.x.copy()
        if not len(self.rows):
            return x
        best = x.copy()
        gaps = np.zeros((len(x), len(self.rows)))
        before = np.full(len(x), np.inf)
        answers: dict[int, FloatArray] = {}
        evaluated_here: set[int] = set()
        left = np.ones(len(x), dtype=bool)
        for _ in range(MOST_CORRECTIONS):
            (found,) = evaluated(self._gaps, x, inputs)
            largest = np.abs(found[:, :, 0]).max(axis=1)
            left &= ~(largest <= CLOSED)
            nearer = largest < before
            best[left & nearer] = x[left & nearer]
            gaps[left & nearer] = found[left & nearer, :, 0]
            for row in np.flatnonzero(left).tolist():
                # Where constraints are about to depend on each other corrections may lead away.
                if not nearer[row] and row in evaluated_here:
                    x[row] = best[row]
                    left[row] = False
                    continue
                if row not in answers:
                    answers[row] = self._answer_near(*near(row))
                elif not nearer[row] or largest[row] > CONTRACTED * before[row]:
                    here = Instant(float(at.times[row]), best[row], at.v[row], at.a[row])
                    answers[row] = self._answer(near(row)[0].linearised(here).stiffness)
                    evaluated_here.add(row)
                x[row] = best[row] - answers[row] @ gaps[row]
            if not left.any():
                break
            before = np.abs(gaps).max(axis=1)
        return x

    @cached_property
    def _gaps(self) -> ca.Function:
        """(x, inputs) ↦ the rows of the constraints: the rest of the equations takes several times as long."""
        if self.library is not None:
            return external(GAPS, self.library)
        return kept_with(self.model, "_gaps", lambda: functions_of_closing(self.model)[0])

    def _answer_near(self, equations: MotionEquations, near: Instant) -> FloatArray:
        """Displacements that answer to gaps, as :meth:`_answer`, at an end of a step; the last answer is remembered."""
        time, answer = self._remembered.get("last", (None, None))
        if answer is None or time != near.time:
            answer = self._answer(equations.linearised(near).stiffness)
            self._remembered["last"] = near.time, answer
        return answer

    @cached_property
    def _remembered(self) -> dict[str, tuple[float, FloatArray]]:
        return {}

    def _answer(self, stiffness: FloatArray) -> FloatArray:
        """Changes of the coordinates that move, smallest by displacements, for gaps of one, shape (size, rows)."""
        moves = self.model.discrete.unknowns.differential
        weighted = np.where(moves, stiffness[self.rows] / self._sizes, 0.0)
        # Constraints that are clearly independent: by the normal equations, which a correction solves well enough.
        regular = regular_inverse(weighted @ weighted.T, INDEPENDENT)
        if regular is not None:
            return np.asarray(weighted.T @ regular / self._sizes[:, None])
        # Constraints that repeat each other have singular values of that size, over the largest.
        rounding = float(np.finfo(np.float64).eps) * max(weighted.shape)
        return np.asarray(np.linalg.pinv(weighted, rcond=rounding) / self._sizes[:, None])

    @cached_property
    def _sizes(self) -> FloatArray:
        return displacements(self.model, self.library)


def constraint_rows(model: Model) -> npt.NDArray[np.int64]:
    """Rows of the residual that are constraints on positions alone."""
    discrete = model.discrete
    entries = [span for _, span in discrete.unknowns.of_kind(BlockKind.MULTIPLIER)]
    # The row of a cable that may go slack holds its tension too.
    entries += [discrete.tension(cable) for cable in discrete.cables if not cable.may_go_slack]
    numbers = [np.arange(span.start, span.stop) for span in entries]
    return np.concatenate([np.zeros(0, dtype=np.int64), *numbers])


def functions_of_closing(model: Model) -> list[ca.Function]:
    """The function (x, inputs) ↦ the rows of the constraints; none where nothing is held."""
    rows = constraint_rows(model)
    if not len(rows):
        return []
    dynamics = model.inverse_dynamics_in_scalars
    # As scalars only the constraints are left of it.
    symbols = dynamics.mx_in() if chooses(dynamics) else dynamics.sx_in()
    at_rest = {"x": symbols[0], "inputs": symbols[3]}
    residual = dynamics.call({**dict.fromkeys(dynamics.name_in(), 0), **at_rest})["residual"]
    return [ca.Function(GAPS, list(at_rest.values()), [ca.densify(residual[rows.tolist()])], list(at_rest), ["gaps"])]
