"""Stretches of rods in friction with obstacles, or with each other along paths, and whether they stick or slip."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from cosserat_casadi.equilibrium.contact.gaps import runs
from cosserat_casadi.loads.contact_layer import ContactLayer
from cosserat_casadi.maths.numbers import known
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.contact_pairs import section_places
from cosserat_casadi.model.registry import EFFECTS, remembering

SLIPS = 1.0 - 1e-6
"""Drag over its largest value, or speed over slip speed, above which a section slips."""


@dataclass(frozen=True)
class RubbingStretch:
    """A stretch of a rod, pressed by an obstacle or a rod with friction, that sticks or slips as a whole.

    Attributes:
        obstacle: name of the obstacle, or of the other rod.
        rod: name of the rod.
        start: abscissa X at which the stretch begins.
        end: abscissa at which it ends.
        slips: whether it slips; else it sticks.
    """

    obstacle: str
    rod: str
    start: float
    end: float
    slips: bool


def rubbing_stretches(model: Model, slip: FloatArray) -> tuple[RubbingStretch, ...]:
    """The stretches that stick or slip, at the resolution of the nodes.

    Args:
        model: the model.
        slip: slip of the nodes, load after load, then of sections, pair after pair, from ``model.memory`` or
            ``model.slips``.
    """
    return tuple(_stretches(model, slip))


def friction_between(
    model: Model, layer: ContactLayer, x: FloatArray, inputs: FloatArray, ends: tuple[float, float]
) -> FloatArray:
    """Resultant of friction on a stretch of a rod, world axes, shape (3,), N; zero in a model without memory.

    Args:
        model: the model.
        layer: the push of the obstacle on the rod.
        x: unknowns, shape (model.size,).
        inputs: stacked inputs, shape (model.inputs.size,).
        ends: abscissae between which the stretch lies.
    """
    if model.memory is None or not EFFECTS[layer.kind].remembers(layer):
        return np.zeros(3)
    _, _, friction = model.memory(x, inputs)
    for load, nodes in _nodes(model):
        if load.name == layer.name:
            rod = model.discrete.rods[load.rod]
            X = known(rod.grid.nodes)
            lengths = model.length_ratio(load.rod, inputs) * known(rod.node_lengths) * ((ends[0] <= X) & (ends[1] >= X))
            return np.asarray(friction.full()[:, nodes] @ lengths)
    raise KeyError(layer.name)


def _nodes(model: Model) -> Iterator[tuple[Any, slice]]:
    """Loads with memory, and the slice of their nodes among all of them."""
    begin = 0
    for load in remembering(model.discrete.loads):
        end = begin + model.discrete.rods[load.rod].grid.size
        yield load, slice(begin, end)
        begin = end


def _stretches(model: Model, slip: FloatArray) -> Iterator[RubbingStretch]:
    end = 0
    for load, span in _nodes(model):
        nodes = known(model.at().discrete.rods[load.rod].grid.nodes)
        yield from _alike(load.obstacle.name, load.rod, nodes, slip[span])
        end = span.stop
    for pair in model.discrete.pairs if end < len(slip) else ():
        if pair.friction > 0.0:
            sections, _ = section_places(model.at().discrete.rods[pair.rods[0]], pair.sections[0])
            yield from _alike(pair.rods[1], pair.rods[0], sections, slip[end : end + len(sections)])
            end += len(sections)


def _alike(obstacle: str, rod: str, places: FloatArray, slip: FloatArray) -> Iterator[RubbingStretch]:
    """Stretches of neighbouring sections that stick, then stretches that slip.

    Args:
        obstacle: name of the obstacle or rod that presses.
        rod: name of the rod.
        places: abscissae of the neighbours, shape (k,).
        slip: slip of each, shape (k,).
    """
    # Each represents the rod up to the middle between it and its neighbour.
    ends = np.concatenate([[0.0], (places[1:] + places[:-1]) / 2, [1.0]])
    for slips in (False, True):
        for part in runs((slip >= 0.0) & ((slip >= SLIPS) == slips)):
            yield RubbingStretch(obstacle, rod, float(ends[part.start]), float(ends[part.stop]), slips)
