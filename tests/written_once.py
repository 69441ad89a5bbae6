"""Functions of models that are written once: tests of one process that ask for the same equations share them.

To write them takes most of the time of a small solve, and many tests are of the same rods under other loads.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Hashable
from typing import Any

import casadi as ca

from cosserat_casadi.model.build import Model
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.model.function_table import FunctionSpec

MOST_KEPT = 400
"""Functions that are kept, those of a file of tests and of some before it: small ones have some hundred kilobytes."""

CHANGES_CODE = {"monkeypatch", "usual_garbage"}
"""Fixtures of tests in which the package may write other functions than in others, or whose memory is measured."""

WRENCHES = ("tip_wrench", "point_wrench")
"""Kinds of loads whose values enter no equation where they are inputs."""


class WrittenOnce:
    """The functions that were written last, by all that they depend on.

    Attributes:
        active: whether functions are shared at the moment.
    """

    def __init__(self) -> None:
        self.active = True
        self._write = FunctionSpec.build
        self._kept: OrderedDict[Hashable, ca.Function | None] = OrderedDict()

    def build(self, spec: FunctionSpec, model: Any, owner: str = "") -> ca.Function | None:
        """The function of one owner, as :meth:`FunctionSpec.build` gives it."""
        equations = equations_of(model.discrete) if self.active and type(model) is Model else None
        if equations is None:
            return self._write(spec, model, owner)
        place = (equations, spec.name, owner)
        if place not in self._kept:
            self._kept[place] = self._write(spec, model, owner)
            if len(self._kept) > MOST_KEPT:
                self._kept.popitem(last=False)
        self._kept.move_to_end(place)
        return self._kept[place]


def equations_of(discrete: DiscreteScene) -> Hashable | None:
    """All that the functions of a scene depend on; None where parameters or a memory are in them."""
    if discrete.parameters.size or discrete.memory:
        return None
    name = "_equations_of"
    if name not in vars(discrete):
        scaling = equations_of(discrete.scaling) if discrete.scaling is not None else ()
        if scaling is None:
            return None
        grids = tuple((rod, constants.discretisation) for rod, constants in discrete.rods.items())
        inputs = tuple(discrete.layout.slices)
        vars(discrete)[name] = (_without_values(discrete), grids, inputs, discrete.moving, discrete.layers, scaling)
    key: Hashable = vars(discrete)[name]
    return key


def _without_values(discrete: DiscreteScene) -> Hashable:
    """The scene without the values of wrenches that are inputs."""
    scene = discrete.scene.of_equations()
    free = discrete.layout.slices
    loads = []
    for load in scene.loads:
        values = [field for field in ("force", "moment") if f"{load.name}.{field}" in free]
        changed = load.kind in WRENCHES and values
        loads.append(load.model_copy(update=dict.fromkeys(values)) if changed else load)
    return scene.model_copy(update={"loads": tuple(loads)})
