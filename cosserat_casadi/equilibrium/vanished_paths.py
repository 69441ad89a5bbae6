"""Tendons whose paths have no length left along the rods that they run through."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.path_stretch import VANISHED, changing_paths
from cosserat_casadi.numerics.outcome import Outcome

JUDGED = (Outcome.CONVERGED, Outcome.LOAD_STALLED)
"""Ends that a vanished path explains, or makes worthless."""


class VanishedPath(NamedTuple):
    """The first of several states in which a path has no length left.

    Attributes:
        state: its number.
        tendon: name of the tendon.
    """

    state: int
    tendon: str


def first_vanished(model: Model, x: FloatArray, inputs: FloatArray) -> VanishedPath | None:
    """The first state in which the path of a tendon has no length left; None where all have some in every state.

    Args:
        model: the discrete scene.
        x: unknowns, shape (k, model.size).
        inputs: stacked inputs, shape (k, model.inputs.size).
    """
    if model.path_stretch is None or not len(x):
        return None
    stretches = model.path_stretch.map(len(x))(x.T, inputs.T).full()
    vanished = np.flatnonzero(np.min(stretches, axis=0) <= VANISHED)
    if not len(vanished):
        return None
    state = int(vanished[0])
    tendon = changing_paths(model.discrete)[int(np.argmin(stretches[:, state]))]
    return VanishedPath(state, tendon)


def with_paths(model: Model, x: FloatArray, inputs: FloatArray, outcome: Outcome) -> tuple[Outcome, str]:
    """Outcome of a solve and its sentence, after a look at the paths of its tendons.

    Args:
        model: the solved model.
        x: where the method stopped, shape (model.size,).
        inputs: stacked inputs, shape (model.inputs.size,).
        outcome: how it has ended but for the paths.
    """
    if outcome not in JUDGED:
        return outcome, outcome.value
    vanished = first_vanished(model, x[None, :], inputs[None, :])
    if vanished is None:
        return outcome, outcome.value
    return Outcome.PATH_VANISHED, f"{Outcome.PATH_VANISHED.value} It is the path of '{vanished.tendon}'."
