"""Projection of positions between the ends of steps onto the constraints: supports, joints and cables stay closed.

The polynomial of a step violates the constraints by its own error. The smallest displacement that closes them is far
below the tolerance of the motion.
"""

from __future__ import annotations

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
from cosserat_casadi.motion.repeated_call import INTERPRETED, Libraries, external
from cosserat_casadi.motion.step_kernels import JACOBIANS, interpreted_derivatives
from cosserat_casadi.numerics.consistent_start import regular_inverse

CLOSED = 1e-12
"""Largest dimensionless constraint residual that counts as closed."""

MOST_CORRECTIONS = 12
"""Largest number of corrections of a state."""

INDEPENDENT = 1e-8
"""Least eigenvalue of the normal equations, over the largest, at which constraints count as independent."""

LINEARISED_AT_ONCE = 32
"""States whose derivatives are computed together: each has three matrices in memory."""

CONTRACTED = 0.2
"""Largest ratio of constraint residuals after and before a correction at which the Jacobian is kept."""


GAPS = "motion_gaps"
"""Name of the function of constraint residuals in C."""


@dataclass(frozen=True)
class Closing:
    """Projection of the unknowns of a model on its constraints.

    Attributes:
        model: the model.
        libraries: shared objects that have :func:`functions_of_closing`, and the derivatives of inverse dynamics.
    """

    model: Model
    libraries: Libraries = INTERPRETED

    @cached_property
    def rows(self) -> npt.NDArray[np.int64]:
        """Rows of the residual that are constraints on positions alone."""
        return constraint_rows(self.model)

    def closed(self, x: FloatArray, inputs: FloatArray, steps: npt.NDArray[np.intp]) -> FloatArray:
        """Unknowns at T times, moved by the smallest displacements that close the constraints, shape (T, size).

        Args:
            x: unknowns of the model at these times, shape (T, size).
            inputs: inputs at these times, shape (T, model.inputs.size).
            steps: number of the step that holds each time, shape (T,); one Jacobian serves a step at first.
        """
        x = np.array(x)
        best = x.copy()
        before = np.full(len(x), np.inf)
        is_here = np.zeros(len(x), dtype=bool)
        answers: FloatArray | None = None
        left = np.arange(len(x))
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
                answers = self._answers(best[firsts], inputs[firsts])[of_step]
            else:
                here = left[leads_away | (largest > CONTRACTED * before[left])]
                if len(here):
                    answers[here] = self._answers(best[here], inputs[here])
                    is_here[here] = True
            before[left] = np.abs(gaps).max(axis=1)
            x[left] = best[left] - np.einsum("tnm,tm->tn", answers[left], gaps)
        return x

    def _gaps(self, x: FloatArray, inputs: FloatArray) -> FloatArray:
        """The rows of the constraints at T states, shape (T, rows): the rest of the equations is not computed."""
        if self.libraries.residual is None:
            function = kept_with(self.model, "_gaps", lambda: functions_of_closing(self.model)[0])
        else:
            function = external(GAPS, self.libraries.residual)
        (gaps,) = evaluated(function, x, inputs)
        return gaps[:, :, 0].copy()

    def _answers(self, x: FloatArray, inputs: FloatArray) -> FloatArray:
        """Changes of the coordinates that move, smallest by displacements, for gaps of one, shape (T, size, rows)."""
        answers = np.empty((*x.shape, len(self.rows)))
        moves = self.model.discrete.unknowns.differential
        library = self.libraries.jacobians
        function = interpreted_derivatives(self.model) if library is None else external(JACOBIANS, library)
        for first in range(0, len(x), LINEARISED_AT_ONCE):
            part = slice(first, first + LINEARISED_AT_ONCE)
            # The constraints depend on positions alone.
            still, held = np.zeros_like(x[part]), np.zeros_like(inputs[part])
            (stiffness,) = evaluated(function, x[part], still, still, inputs[part], held, held, results=1)
            answers[part] = self._answered(np.where(moves, stiffness[:, self.rows] / self._sizes, 0.0))
        return answers

    def _answered(self, weighted: FloatArray) -> FloatArray:
        """The changes by gradients of the gaps over displacements, shape (T, rows, size)."""
        # Constraints that are clearly independent: by the normal equations, which a correction solves well enough.
        regular = regular_inverse(weighted @ weighted.swapaxes(1, 2), INDEPENDENT)
        if regular is not None:
            return np.asarray(weighted.swapaxes(1, 2) @ regular / self._sizes[:, None])
        # Constraints that repeat each other have singular values of that size, over the largest.
        rounding = float(np.finfo(np.float64).eps) * max(weighted.shape[1:])
        return np.asarray(np.linalg.pinv(weighted, rcond=rounding) / self._sizes[:, None])

    @cached_property
    def _sizes(self) -> FloatArray:
        return displacements(self.model, self.libraries.residual)


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
