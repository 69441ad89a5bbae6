"""Positions between the ends of steps put back on the constraints: supports, joints and cables are closed all along.

The polynomial of a step leaves the constraints by as much as it is inexact. The smallest displacement that closes them
is far below the tolerance of the motion.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.calls import chooses
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.function_table import kept_with
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.motion.displacement import displacements
from cosserat_casadi.motion.repeated_call import RepeatedCall, external
from cosserat_casadi.numerics.consistent_start import regular_inverse
from cosserat_casadi.numerics.motion_equations import Instant, MotionEquations

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

    def closed(self, instant: Instant, inputs: FloatArray, equations: MotionEquations, near: Instant) -> FloatArray:
        """Unknowns at an instant, moved by the smallest displacement that closes the constraints, shape (size,).

        Args:
            instant: of the motion, in the unknowns of the model.
            inputs: inputs at that instant, shape (model.inputs.size,).
            equations: of motion, of which some rows are the constraints.
            near: where the first Jacobian is evaluated: an end of the step that the instant is in, for many instants.
        """
        x = instant.x
        if not len(self.rows):
            return x
        best = x
        before = np.inf
        answer = None
        is_here = False
        for _ in range(MOST_CORRECTIONS):
            gaps = self._gaps(x, inputs)
            largest = np.abs(gaps).max()
            if largest <= CLOSED:
                break
            leads_away = not largest < before
            # Where constraints are about to depend on each other corrections may lead away.
            if leads_away and is_here:
                return best
            if leads_away:
                gaps = self._gaps(best, inputs)
            else:
                best = x
            if answer is None:
                answer = self._answer_near(near, equations)
            elif leads_away or largest > CONTRACTED * before:
                answer = self._answer(equations.linearised(replace(instant, x=best)).stiffness)
                is_here = True
            before = np.abs(gaps).max()
            x = best - answer @ gaps
        return x

    @cached_property
    def _gaps(self) -> RepeatedCall:
        """(x, inputs) ↦ the rows of the constraints: the rest of the equations takes several times as long."""
        if self.library is not None:
            return RepeatedCall(external(GAPS, self.library))
        return RepeatedCall(kept_with(self.model, "_gaps", lambda: functions_of_closing(self.model)[0]))

    def _answer_near(self, near: Instant, equations: MotionEquations) -> FloatArray:
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
