"""Parameters of a model: numbers of the scene that are arguments of its functions, as records.

A model with parameters is written in a scene whose numbers are expressions: where the scene names a number, its record
holds an entry of the symbol p. Code that computes with these numbers does not know of parameters. Scales of the
equations, such as EI/ℓ, follow from the scene's own numbers: unknowns have the same units for every p.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.errors import Problem, refuse
from cosserat_casadi.maths.numbers import any_symbolic
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.element_ends import MovingEnds, moving_ends, places_on, unmovable
from cosserat_casadi.model.stacked import StackedLayout
from cosserat_casadi.scene.writing import scene_tables


@dataclass(frozen=True)
class ParameterLayout(StackedLayout[scenes.NamedNumbers]):
    """The parameters of a model, stacked into one vector p.

    Attributes:
        moving: element ends that some parameters move.
    """

    moving: tuple[MovingEnds, ...] = ()

    what = "a parameter"
    several = "parameters"

    def pack(self, values: Mapping[str, npt.ArrayLike] | None = None) -> FloatArray:
        """The stacked vector: values by name, and the scene's values for other names.

        Raises:
            SceneError: a name is unknown, a value has another shape or is not finite, or places change their order.
        """
        p = super().pack(values)
        refuse([problem for ends in self.moving for problem in ends.faults(p)])
        return p

    @cached_property
    def symbol(self) -> ca.MX:
        """p, size×1: one symbol for all functions of a model."""
        return ca.MX.sym("p", self.size)

    @property
    def quaternions(self) -> list[int]:
        """Indices of the first entries of quaternions that may have either sign."""
        # The sign of a support's quaternion tells in which direction its tip is turned.
        return [span.start for entry, span in self._turns if entry.holder.table != "supports"]

    @property
    def _turns(self) -> list[tuple[scenes.NamedNumbers, slice]]:
        """Whole quaternions."""
        return [(entry, span) for entry, span in self if entry.keys[-1] == "quaternion" and entry.size == 4]

    def between(self, first: FloatArray, last: FloatArray, share: float) -> FloatArray:
        """Parameters at a share of the straight line between two stacks, with quaternions scaled to norm 1."""
        p = (1.0 - share) * first + share * last
        for _, span in self._turns:
            p[span] /= max(float(np.linalg.norm(p[span])), float(np.finfo(float).tiny))
        return p

    def rate_between(self, first: FloatArray, last: FloatArray, share: float) -> FloatArray:
        """Derivative of the parameters on the line between two stacks by the share."""
        rate = last - first
        p = (1.0 - share) * first + share * last
        for _, span in self._turns:
            norm = max(float(np.linalg.norm(p[span])), float(np.finfo(float).tiny))
            unit = p[span] / norm
            rate[span] = (rate[span] - unit * (unit @ rate[span])) / norm
        return rate

    @property
    def turning_axes(self) -> list[tuple[str, int]]:
        """Names of the parameters that turn the axis of a joint, with the joint's index in the scene's list."""
        turning = []
        for entry in self.entries:
            for numbers in entry.all_numbers:
                holder = numbers.holder
                turns = numbers.keys[-1] in ("axis", "quaternion") and hasattr(holder.record, "axis")
                if holder.table == "joints" and turns:
                    turning.append((entry.name, holder.index))
        return turning

    def written(self, scene: scenes.Scene, p: Matrix | FloatArray) -> scenes.Scene:
        """The scene with entries of p as its numbers: expressions, or numbers, which are not checked."""
        for entry, span in self:
            values = [p[i] for i in range(span.start, span.stop)]
            scene = scene.with_numbers(entry, values)
        return scene

    def set_in(self, scene: scenes.Scene, values: Mapping[str, npt.ArrayLike] | None = None) -> scenes.Scene:
        """The scene with values for its parameters, which are then constants of it.

        Args:
            scene: the scene that names the parameters.
            values: values by name; other parameters keep the scene's values.

        Raises:
            SceneError: a name is unknown, or a scene with these values is refused.
        """
        p = self.pack(values).tolist()
        changed = self.written(scene, p).in_proportion().baked()
        # The scene checks ranges of numbers and relations between them.
        return scenes.scene_from_dict(scene_tables(changed))


def parameter_layout(scene: scenes.Scene) -> ParameterLayout:
    """The parameters that a scene names.

    Raises:
        SceneError: a parameter would move a place that elements cannot follow.
    """
    layout = ParameterLayout(tuple(scene.named_parameters()))
    problems: list[Problem] = []
    movers: dict[str, tuple[str, ...]] = {}
    for entry, span in layout:
        values = [layout.symbol[i] for i in range(span.start, span.stop)]
        written = scene.with_numbers(entry, values)
        problems += unmovable(entry.name, scene, written)
        for rod in scene.rods:
            if any_symbolic(places_on(written, rod.name)):
                movers[rod.name] = (*movers.get(rod.name, ()), entry.name)
    refuse(problems)
    moving = moving_ends(scene, layout.written(scene, layout.symbol), layout.symbol, movers)
    return replace(layout, moving=moving)


class WithParameters(ABC):
    """A model whose functions may take the parameters as their argument after the inputs."""

    @property
    @abstractmethod
    def parameters(self) -> ParameterLayout:
        """Names, order and default values of the parameters, the third argument of the functions; often none."""

    @abstractmethod
    def _bound(self, values: Mapping[str, npt.ArrayLike] | None) -> Self:
        """The model with constants for its parameters.

        Raises:
            SceneError: the scene refuses a value, or a load cannot act for these values.
        """

    def at(self, values: Mapping[str, npt.ArrayLike] | npt.ArrayLike | None = None) -> Self:
        """The model with fixed parameters: its functions take unknowns and inputs alone.

        Unknowns keep their meaning: they are counted in units of the scene's numbers.

        Args:
            values: parameters by name, others keep the scene's values; or all parameters stacked, shape
                (parameters.size,).

        Raises:
            SceneError: a name is unknown, the scene refuses a value, or a load cannot act for these values.
        """
        layout = self.parameters
        if values is not None and not isinstance(values, Mapping):
            values = layout.split(values)
        p = layout.pack(values).tobytes()
        if not layout.size:
            return self
        known = self.__dict__.setdefault("_models", {})
        if p not in known:
            # The last one is kept: a loop solves a model with one set of parameters again and again.
            known.clear()
            known[p] = self._bound(values)
        bound: Self = known[p]
        return bound


NO_PARAMETERS = ParameterLayout(())
"""Parameters of a model whose numbers are all constants."""
