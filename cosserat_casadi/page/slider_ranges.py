"""Sliders, one for each stacked input, over the range of the choice of modes."""

from __future__ import annotations

from dataclasses import dataclass

from cosserat_casadi.accuracy.fixing import with_accuracy
from cosserat_casadi.accuracy.ranges import Given, input_ranges
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.system_functions import SystemFunctions
from cosserat_casadi.scene.input_fields import column_suffixes


@dataclass(frozen=True)
class Slider:
    """Slider of one stacked input.

    Attributes:
        input: name of the input, ``owner.field``.
        label: text beside the slider, e.g. the axis of a vector or the degree of a polynomial; may be empty.
        unit: SI unit.
        index: entry of the stacked inputs.
        value: value in the scene.
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


def sliders(model: Model, asked: Given | None = None) -> list[Slider]:
    """A slider for each entry of the stacked inputs, in their order.

    Its range is that of the choice of modes. An entry that is constant there has the default range of a scene without
    chosen modes.

    Args:
        model: model for the inputs.
        asked: requested ranges, as for :func:`cosserat_casadi.choose`.
    """
    scene = model.scene
    ranges = input_ranges(scene, asked)
    if scene.accuracy.chosen_for:
        open_scene = with_accuracy(scene, chosen_for=None)
        ranges = ranges.where_still(input_ranges(open_scene, asked))
    made = []
    for entry, span in model.inputs:
        for k, suffix in zip(range(span.start, span.stop), column_suffixes(*entry.shape), strict=True):
            value = float(ranges.layout.default[k])
            # The range includes the value of the scene.
            least = min(float(ranges.lower[k]), value)
            most = max(float(ranges.upper[k]), value)
            label = suffix.removeprefix(".")
            made.append(Slider(entry.name, label, entry.unit, k, value, least, most))
    return made


def movable(model: SystemFunctions) -> list[str]:
    """Inputs for dragging the tip: inputs with bounds, else inputs of actuators and of tubes, else all."""
    bounded = {bound.input for bound in model.scene.bounds}
    drives = {owner.name for owner in (*model.scene.actuators, *model.scene.tubes)}
    of_drives = {entry.name for entry, _ in model.inputs if entry.owner in drives and not entry.of_rod}
    chosen = bounded or of_drives or set(model.inputs.names)
    return [name for name in model.inputs.names if name in chosen]
