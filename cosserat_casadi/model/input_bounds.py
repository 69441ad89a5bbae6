"""Ranges of the inputs: by the physics of an input, and by the scene."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.inputs import InputLayout


def limits_of(scene: scenes.Scene) -> Iterator[scenes.Bound]:
    """Ranges of inputs in the scene: its bounds and its table of ranges."""
    yield from scene.bounds
    free = scene.input_names()
    for name, pairs in scene.ranges.items():
        # Parameters have ranges too.
        if name in free:
            lower, upper = ends_of(pairs)
            yield scenes.Bound(input=name, lower=lower, upper=upper)


def ends_of(pairs: scenes.Pairs) -> tuple[float | tuple[float, ...], float | tuple[float, ...]]:
    """Lower and upper ends of a range in the scene's table: one number for all entries, or one for each entry."""
    if isinstance(pairs[0], tuple):
        lower, upper = zip(*pairs, strict=True)
        return lower, upper
    return pairs


def physical_range(layout: InputLayout) -> tuple[FloatArray, FloatArray]:
    """Least and largest values of inputs by their physics, shape (layout.size,) each; infinite where there are none."""
    lower, upper = np.empty((2, layout.size))
    for entry, indices in layout:
        lower[indices] = entry.lower
        upper[indices] = entry.upper
    return lower, upper


def narrowed(layout: InputLayout, bounds: Iterable[scenes.Bound]) -> tuple[FloatArray, FloatArray]:
    """Least and largest values of the stacked inputs, in their units, shape (layout.size,) each; infinite without any.

    Args:
        layout: the inputs.
        bounds: ranges that narrow the physical ones.
    """
    lower, upper = physical_range(layout)
    for bound in bounds:
        # A bound holds for all entries of a vector alike.
        entries = layout.slices[bound.input]
        if bound.lower is not None:
            lower[entries] = np.maximum(lower[entries], bound.lower)
        if bound.upper is not None:
            upper[entries] = np.minimum(upper[entries], bound.upper)
    return lower, upper


def ranges_of_inputs(scene: scenes.Scene, layout: InputLayout) -> tuple[FloatArray, FloatArray]:
    """Least and largest values of the stacked inputs by their physics and by the scene.

    Args:
        scene: the scene of the inputs.
        layout: its inputs.
    """
    return narrowed(layout, limits_of(scene))
