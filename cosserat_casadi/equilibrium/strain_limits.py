"""Refusal of states that no rod can be in; :mod:`cosserat_casadi.model.strain_margins` has their margins."""

from __future__ import annotations

from typing import NamedTuple

import casadi as ca
import numpy as np

from cosserat_casadi.maths.calls import evaluated
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.strain_margins import APART, VANISHED, StrainMargin, margins_of
from cosserat_casadi.numerics.outcome import Outcome

JUDGED = (Outcome.CONVERGED, Outcome.LOAD_STALLED)
"""Outcomes that a limit of the strains explains, or invalidates."""


class BeyondLimit(NamedTuple):
    """The first of several states with strains beyond a limit.

    Attributes:
        state: index of the state.
        margin: the margin that is exceeded.
    """

    state: int
    margin: StrainMargin

    @property
    def word(self) -> str:
        """Name of the outcome, common to solves, paths and motions."""
        words = {"path": "PATH_VANISHED", "plane": "OUT_OF_PLANE", APART: "UNRESOLVED"}
        return words.get(self.margin.kind, "BEYOND_MATERIAL")

    @property
    def whose(self) -> str:
        """The owner of the limit, as the beginning of a sentence."""
        kind, name = self.margin
        if kind == "plane":
            return f"It is {name}"
        if kind == APART:
            return "Its sections at which contact is summed lie too far apart"
        return f"It is the {kind} of '{name}'" if kind in ("path", "material") else f"It is the {kind} '{name}'"


def first_beyond(
    model: Model, x: FloatArray, inputs: FloatArray, margins_in_c: ca.Function | None = None, zero: float = VANISHED
) -> BeyondLimit | None:
    """The first state with strains beyond a limit; None if every state is within all limits.

    Args:
        model: the discrete scene.
        x: unknowns, shape (k, model.size).
        inputs: stacked inputs, shape (k, model.inputs.size).
        margins_in_c: the model's margins as compiled code, or None.
        zero: margin that counts as zero.
    """
    if model.strain_margins is None or not len(x):
        return None
    margins = evaluated(margins_in_c or model.strain_margins, x, inputs)[0][:, :, 0]
    beyond = np.argwhere(margins <= zero)
    if not len(beyond):
        return None
    state, first = beyond[0].tolist()
    return BeyondLimit(state, margins_of(model.discrete)[first])


def within_limits(model: Model, x: FloatArray, inputs: FloatArray, outcome: Outcome) -> tuple[Outcome, str]:
    """Outcome of a solve and its sentence, after a test of the limits of its strains.

    Args:
        model: the solved model.
        x: where the method stopped, shape (model.size,).
        inputs: stacked inputs, shape (model.inputs.size,).
        outcome: outcome of the solve without the limits.
    """
    # A load that stalls at the end of a law stops short of it, by a last step.
    zero = 2 * VANISHED if outcome is Outcome.LOAD_STALLED else VANISHED
    beyond = first_beyond(model, x[None, :], inputs[None, :], zero=zero) if outcome in JUDGED else None
    if beyond is None or beyond.margin.kind == APART:
        # Sections that lie apart are not a limit here: the error estimate says that the error is unknown.
        return outcome, outcome.value
    told = Outcome[beyond.word]
    return told, f"{told.value} {beyond.whose}."
