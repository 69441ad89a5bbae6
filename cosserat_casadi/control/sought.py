"""The inputs that an inverse problem looks for: which they are, their ranges, and how large a change of each is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model

SHORTEST = 1e-3
"""Least length of a rod or a cable that is tried, relative to the scene's."""

UNFELT = 1e-9
"""Derivative of the residual with an input, relative to the largest, below which it says nothing of its scale."""


@dataclass(frozen=True)
class Sought:
    """Inputs to be found, n entries of the stacked inputs.

    Attributes:
        places: where they stand in the stacked inputs, shape (n,).
        lower: least values, shape (n,), -inf where there is none.
        upper: largest values, shape (n,).
    """

    places: npt.NDArray[np.int64]
    lower: FloatArray
    upper: FloatArray

    def clipped(self, inputs: FloatArray) -> FloatArray:
        """Stacked inputs with those sought brought into their ranges."""
        inside = inputs.copy()
        inside[self.places] = np.clip(inputs[self.places], self.lower, self.upper)
        return inside


def sought(model: Model) -> Sought:
    """The inputs that a scene asks for: those it lists, or else those it bounds.

    A tension is not below zero and a length not below a thousandth of the scene's, whatever the bounds.

    Raises:
        SceneError: the scene lists no inputs and bounds none.
    """
    scene, layout = model.scene, model.inputs
    names = scene.inputs if scene.inputs is not None else tuple(bound.input for bound in scene.bounds)
    chosen = [name for name in layout.names if name in names]
    if not chosen:
        remedy = "list them in inputs, or give each its range in [[bounds]]"
        raise SceneError(Problem("inputs", "no input is named that could be found", remedy))
    lower, upper = _natural(model), np.full(layout.size, np.inf)
    for bound in scene.bounds:
        place = layout.slices[bound.input]
        if bound.lower is not None:
            lower[place] = np.maximum(lower[place], bound.lower)
        if bound.upper is not None:
            upper[place] = bound.upper
    _refuse_empty(model, lower, upper)
    places = np.concatenate([np.arange(layout.size)[layout.slices[name]] for name in chosen])
    return Sought(places, lower[places], upper[places])


def _natural(model: Model) -> FloatArray:
    """Least values that an input can have by what it is."""
    layout = model.inputs
    lower = np.full(layout.size, -np.inf)
    for name, default in zip(layout.names, layout.defaults, strict=True):
        if name.endswith(".tension"):
            lower[layout.slices[name]] = 0.0
        elif name.endswith(".length"):
            lower[layout.slices[name]] = SHORTEST * default.item()
    return lower


def _refuse_empty(model: Model, lower: FloatArray, upper: FloatArray) -> None:
    problems = []
    for i, bound in enumerate(model.scene.bounds):
        place = model.inputs.slices[bound.input]
        if np.any(lower[place] > upper[place]):
            least = float(lower[place].max())
            problems.append(Problem(f"bounds[{i}].upper", f"is below {least:g}, the least that {bound.input} can be"))
    if problems:
        raise SceneError(*problems)


def scales(model: Model, wanted: Sought, start: Solution) -> FloatArray:
    """A change of each sought input that matters, shape (n,), in its unit.

    Half the range where there is one; else what changes the dimensionless balance by one unit; else the value itself,
    or the length of the rod whose base moves.
    """
    half = (wanted.upper - wanted.lower) / 2
    felt = np.linalg.norm(model.input_jacobian(start.x, start.inputs).full(), axis=0)[wanted.places]
    own = _own_sizes(model, start.inputs)[wanted.places]
    natural = np.where(felt > UNFELT * felt.max(initial=0.0), 1.0 / np.where(felt > 0.0, felt, 1.0), own)
    bounded = np.isfinite(half) & (half > 0.0)
    return np.where(bounded, np.where(bounded, half, 1.0), natural)


def _own_sizes(model: Model, inputs: FloatArray) -> FloatArray:
    """How large an input is by itself, where nothing else tells."""
    sizes = np.where(inputs != 0.0, np.abs(inputs), 1.0)
    lengths = {f"{rod.name}.base.position": rod.length for rod in model.scene.rods}
    for name, place in model.inputs.slices.items():
        sizes[place] = lengths.get(name, sizes[place])
    return sizes
