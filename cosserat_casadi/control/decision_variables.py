"""The inputs that an inverse problem may change: their choice, their ranges, and scales of their changes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from cosserat_casadi.equilibrium.contact.contact_state import given_entries, given_names
from cosserat_casadi.equilibrium.solution import Equilibrium
from cosserat_casadi.errors import Problem, SceneError, refuse
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.input_bounds import narrowed
from cosserat_casadi.model.system_functions import SystemFunctions
from cosserat_casadi.scene.load_records import Gravity

UNFELT = 1e-9
"""Derivative of the residual by an input, over the largest one, below which it does not set the scale."""


@dataclass(frozen=True)
class DecisionVariables:
    """Inputs that may change, n entries of the stacked inputs.

    Attributes:
        indices: indices of the entries in the stacked inputs, shape (n,).
        lower: least values, shape (n,), -inf without a bound.
        upper: largest values, shape (n,), inf without a bound.
    """

    indices: npt.NDArray[np.int64]
    lower: FloatArray
    upper: FloatArray

    def clipped(self, inputs: FloatArray) -> FloatArray:
        """Clip the decision variables among stacked inputs to their ranges."""
        inside = inputs.copy()
        current = inputs[self.indices]
        inside[self.indices] = np.clip(current, self.lower, self.upper)
        return inside


def decision_variables(model: SystemFunctions) -> DecisionVariables:
    """Choose the decision variables of a scene: the inputs that it bounds, or else the inputs that it lists.

    If a scene bounds some inputs, a listed input without bounds keeps the scene's value: it is listed for a controller,
    such as a payload. If it neither bounds nor lists inputs, all magnitudes of loads and actuators may change, but
    gravity. For any bounds, tensions are at least zero, and lengths at least a thousandth of the scene's.

    Raises:
        SceneError: the scene lists no inputs and bounds none, and has no load or actuator but gravity.
    """
    layout = model.inputs
    chosen = _chosen_names(model)
    if not chosen:
        remedy = "add a load or an actuator, list inputs, such as a rod's base.position, or give them [[bounds]]"
        raise SceneError(Problem("inputs", "no input is left to find", remedy))
    lower, upper = narrowed(layout, model.scene.bounds)
    least = [(i, bound, lower[layout.slices[bound.input]]) for i, bound in enumerate(model.scene.bounds)]
    refuse(
        [
            Problem(f"bounds[{i}].upper", f"is below {own.max():g}, the least that {bound.input} can be")
            for i, bound, own in least
            if np.any(own > upper[layout.slices[bound.input]])
        ]
    )
    all_indices = np.arange(layout.size)
    indices = np.concatenate([all_indices[layout.slices[name]] for name in chosen])
    return DecisionVariables(indices, lower[indices], upper[indices])


def scales(model: SystemFunctions, variables: DecisionVariables, start: Equilibrium[Any]) -> FloatArray:
    """Scale of each decision variable, a change that matters, in its unit, shape (n,).

    It is half the range, if there is one; else the change that alters the dimensionless balance by one unit; else the
    value itself, or the length of the rod whose base moves.
    """
    given = given_entries(start.model)
    # In exact contact the model of the start has elements that end at the contacts.
    solved_model = start.model if model.scene.touches_exactly else model
    jacobian = solved_model.input_jacobian(start.x, start.inputs).full()[:, given]
    sensitivity = np.linalg.norm(jacobian, axis=0)[variables.indices]
    largest = sensitivity.max(initial=0.0)
    own_size = _own_sizes(model, start.inputs[given])[variables.indices]
    # Ones where a division would fail: these entries are not taken.
    divisor = np.where(sensitivity > 0.0, sensitivity, 1.0)
    unbounded_scale = np.where(sensitivity > UNFELT * largest, 1.0 / divisor, own_size)
    half_range = (variables.upper - variables.lower) / 2
    bounded = np.isfinite(half_range) & (half_range > 0.0)
    return np.where(bounded, half_range, unbounded_scale)


def _chosen_names(model: SystemFunctions) -> list[str]:
    """Names of the decision variables, in the order of the stacked inputs."""
    scene = model.scene
    changeable = tuple(bound.input for bound in scene.bounds) or scene.inputs
    if changeable is not None:
        return [name for name in model.inputs.names if name in changeable]
    weights = {load.name for load in scene.loads if isinstance(load, Gravity)}
    free = given_names(model)
    return [entry.name for entry, _ in model.inputs if entry.name in free and entry.owner not in weights]


def _own_sizes(model: SystemFunctions, inputs: FloatArray) -> FloatArray:
    """Scales of the inputs by their own values, if nothing else determines them, shape (inputs,)."""
    sizes = np.where(inputs != 0.0, np.abs(inputs), 1.0)
    # The base of a rod may well be at the origin, so its value tells nothing.
    lengths = {f"{rod.name}.base.position": rod.length for rod in model.scene.rods}
    for name, entries in model.inputs.slices.items():
        sizes[entries] = lengths.get(name, sizes[entries])
    return sizes
