"""Projection of positions between the ends of steps onto the constraints: supports, joints and cables stay closed.

The polynomial of a step violates the constraints by its own error. The smallest displacement that closes them is far
below the tolerance of the motion.
"""

from __future__ import annotations

from collections.abc import Sequence
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

CLOSED = 1e-12
"""Largest dimensionless constraint residual that counts as closed."""

MOST_CORRECTIONS = 12
"""Largest number of corrections of a state."""

INDEPENDENT = 1e-8
"""Least eigenvalue of the normal equations, over the largest, at which constraints count as independent."""

CONTRACTED = 0.2
"""Largest ratio of constraint residuals after and before a correction at which the Jacobian is kept."""


GAPS = "motion_gaps"
"""Name of the function of constraint residuals in C."""


@dataclass(frozen=True)
class Closing:
    """Projection of the unknowns of a model on its constraints.

    Attributes:
        model: the model.
        library: shared object that contains :func:`functions_of_closing`; None without one.
    """

    model: Model
    library: str | None = None

    @cached_property
    def rows(self) -> npt.NDArray[np.int64]:
        """Rows of the residual that are constraints on positions alone."""
        return constraint_rows(self.model)

    def closed(
        self,
        times: FloatArray,
        states: Sequence[FloatArray],
        inputs: FloatArray,
        equations: MotionEquations,
        steps: npt.NDArray[np.intp],
    ) -> FloatArray:
        """Return the unknowns at T times after the smallest displacements that close the constraints, shape (T, size).

        Args:
            times: times of the motion, shape (T,), s.
            states: x, v and a at these times, in the unknowns of the model, shape (T, size) each.
            inputs: inputs at these times, shape (T, model.inputs.size).
            equations: equations of motion, of which some rows are the constraints.
            steps: index of the step that contains each time, shape (T,); at first, a step has one Jacobian.
        """
        x = np.array(states[0])
        best = x.copy()
        before = np.full(len(x), np.inf)
        is_here = np.zeros(len(x), dtype=bool)
        answers: FloatArray | None = None
        left = np.arange(len(x))

        def answer_at(row: int) -> FloatArray:
            instant = Instant(float(times[row]), best[row], states[1][row], states[2][row])
            return self._answer(equations.linearised(instant).stiffness)

        for _ in range(MOST_CORRECTIONS):
            gaps = self._gaps(x[left], inputs[left])
            largest = np.abs(gaps).max(axis=1)
            leads_away = ~(largest < before[left])
            # Where constraints are about to depend on each other corrections may lead away.
            is_given_up = (largest > CLOSED) & leads_away & is_here[left]
            x[left[is_given_up]] = best[left[is_given_up]]
            goes_on = (largest > CLOSED) & ~is_given_up
            left, gaps, largest, leads_away = (each[goes_on] for each in (left, gaps, largest, leads_away))
            if not len(left):
                break
            if np.any(leads_away):
                gaps[leads_away] = self._gaps(best[left[leads_away]], inputs[left[leads_away]])
            best[left[~leads_away]] = x[left[~leads_away]]
            if answers is None:
                _, firsts, of_step = np.unique(steps, return_index=True, return_inverse=True)
                answers = np.array([answer_at(row) for row in firsts.tolist()])[of_step]
            else:
                for row in left[leads_away | (largest > CONTRACTED * before[left])].tolist():
                    answers[row] = answer_at(row)
                    is_here[row] = True
            before[left] = np.abs(gaps).max(axis=1)
            x[left] = best[left] - np.einsum("tnm,tm->tn", answers[left], gaps)
        return x

    def _gaps(self, x: FloatArray, inputs: FloatArray) -> FloatArray:
        """Constraint residuals at T states, shape (T, rows), without the other rows of the equations."""
        if self.library is None:
            function = kept_with(self.model, "_gaps", lambda: functions_of_closing(self.model)[0])
        else:
            function = external(GAPS, self.library)
        (gaps,) = evaluated(function, x, inputs)
        return gaps[:, :, 0].copy()

    def _answer(self, stiffness: FloatArray) -> FloatArray:
        """Changes of the coordinates, of smallest displacement, for constraint residuals of one, shape (size, rows)."""
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
    """The function (x, inputs) ↦ constraint residuals, as a list; it is empty for a scene without constraints."""
    rows = constraint_rows(model)
    if not len(rows):
        return []
    dynamics = model.inverse_dynamics_in_scalars
    # As scalars only the constraints are left of it.
    symbols = dynamics.mx_in() if chooses(dynamics) else dynamics.sx_in()
    at_rest = {"x": symbols[0], "inputs": symbols[3]}
    residual = dynamics.call({**dict.fromkeys(dynamics.name_in(), 0), **at_rest})["residual"]
    return [ca.Function(GAPS, list(at_rest.values()), [ca.densify(residual[rows.tolist()])], list(at_rest), ["gaps"])]
