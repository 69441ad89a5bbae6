"""Motions in equal steps of any method, from any state: for orders and invariants."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from cosserat_casadi import Discretisation, Model, build, discretise, scene_from_dict
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.history import History, integrated
from cosserat_casadi.motion.simulate import moving_inputs
from cosserat_casadi.numerics.collocation import Collocation
from cosserat_casadi.numerics.integration import StepSettings

EXACT = 1e-13
"""Error that Newton's method may leave in each unknown."""


def moving_model(scene: dict[str, Any], modes: int | None = None, nodes: int | None = None) -> Model:
    """A model of a scene in motion, on so many modes and nodes, or on those of the scene."""
    moving = scene_from_dict(scene).with_motion_inputs()
    chosen: dict[str, Discretisation] = discretise(moving)
    if modes is not None:
        chosen = discretise(moving, modes, nodes or 2 * modes + 6)
    return build(moving, chosen, moving=True)


def stepped(
    model: Model, method: Collocation, size: float, duration: float, x: FloatArray, v: FloatArray | None = None
) -> History:
    """A motion in equal steps whose equations are solved to rounding.

    Args:
        model: the model.
        method: the collocation method.
        size: of the steps, s.
        duration: s.
        x: unknowns at the start, shape (size,).
        v: their rates, 1/s; none for a motion that begins at rest.
    """
    rates = np.zeros(model.size) if v is None else v
    settings = StepSettings(np.full(model.size, EXACT), size=size, newton=1.0)
    history = integrated(model, moving_inputs(model).pieces(duration), x, rates, method, settings)
    assert history.completed, history.outcome.value
    return history


def orders(errors: Sequence[npt.ArrayLike]) -> FloatArray:
    """Orders from errors at halved steps, a row for each halving."""
    values = np.asarray(errors, dtype=float)
    return np.asarray(np.log2(values[:-1] / values[1:]))
