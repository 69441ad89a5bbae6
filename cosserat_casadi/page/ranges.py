"""Ranges of the sliders: the scene's bounds, or what is of the size of an input."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cosserat_casadi.model.build import Model
from cosserat_casadi.model.input_ranges import ranges_of_inputs
from cosserat_casadi.model.inputs import Input
from cosserat_casadi.scene.inputs import column_suffixes

GRAVITY = 9.81
"""Acceleration where the scene has none to go by, m/s²."""

SHARE = 2.0
"""An input reaches this many times its own value."""

MOVE = 0.25
"""How far a base moves to either side, relative to the longest rod."""


@dataclass(frozen=True)
class Slider:
    """One number of the inputs that a reader may move.

    Attributes:
        input: name of the input, ``owner.field``.
        label: what it is called beside the slider: the axis of a vector, the degree of a polynomial; may be empty.
        unit: SI unit.
        index: entry of the stacked inputs.
        value: the scene's own.
        least: left end.
        most: right end.
    """

    input: str
    label: str
    unit: str
    index: int
    value: float
    least: float
    most: float


def sliders(model: Model) -> list[Slider]:
    """A slider for each entry of the stacked inputs, in their order."""
    defaults = model.pack()
    lower, upper = ranges_of_inputs(model.scene, model.inputs)
    made = []
    for entry, span in model.inputs:
        given = np.isfinite(lower[span]) & np.isfinite(upper[span])
        size = _size(model, entry)
        for k, suffix in enumerate(column_suffixes(*entry.shape)):
            index = span.start + k
            value = float(defaults[index])
            least, most = float(lower[index]), float(upper[index])
            if not given[k]:
                least, most = _around(model, entry, value, size, least, most)
            # The scene's own value lies on the slider, wherever the bounds are.
            ends = min(least, value), max(most, value)
            made.append(Slider(entry.name, suffix.removeprefix("."), entry.unit, index, value, *ends))
    return made


def _around(model: Model, entry: Input, value: float, size: float, lower: float, upper: float) -> tuple[float, float]:
    """Ends of a slider where the scene gives one bound or none."""
    if entry.field == "base.position":
        reach = MOVE * max(rod.length for rod in model.scene.rods)
        ends = value - reach, value + reach
    elif entry.field == "base.quaternion":
        ends = -1.0, 1.0
    elif entry.declared.positive or entry.field == "length":
        # A length: a rod of a tenth of its length is another robot.
        ends = value / SHARE, value * (1 + SHARE) / SHARE
    else:
        ends = -SHARE * size, SHARE * size
    return max(ends[0], lower), min(ends[1], upper)


def _size(model: Model, entry: Input) -> float:
    """How large an input is: its own value, or what bends the softest rod by about its length."""
    own = float(np.abs(entry.default).max(initial=0.0))
    if own > 0.0:
        return own
    # The force EI/ℓ² of every rod; lengths make moments and loads per length of it.
    properties = [rod.properties for rod in model.discrete.rods.values()]
    softest = min(properties, key=lambda rod: rod.bending_stiffness / rod.length**2)
    force = softest.bending_stiffness / softest.length**2
    sizes = {"N": force, "N m": force * softest.length, "N/m": force / softest.length, "m/s²": GRAVITY}
    return sizes.get(entry.unit, 1.0)


def movable(model: Model) -> list[str]:
    """Names of the inputs that a hand on the tip moves: those with bounds, else the actuators', else all."""
    bounded = {bound.input for bound in model.scene.bounds}
    actuators = {actuator.name for actuator in model.scene.actuators}
    of_actuators = {entry.name for entry, _ in model.inputs if entry.owner in actuators and not entry.of_rod}
    chosen = bounded or of_actuators or set(model.inputs.names)
    return [name for name in model.inputs.names if name in chosen]
