"""What an effect is: a word of the scene format turned into wrenches on a rod."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import casadi as ca
import numpy as np

from cosserat_casadi.maths.grid import Grid
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.rod.properties import RodProperties
from cosserat_casadi.rod.wrenches import Action, PointWrench


@dataclass(frozen=True)
class Site:
    """The rod that an effect meets.

    Attributes:
        rod: what it is made of.
        grid: its nodes.
        base_R_world: 3×3, turns world coordinates into those of the rod's base frame.
    """

    rod: RodProperties
    grid: Grid
    base_R_world: Matrix

    def placed(self, vector: Matrix | None, *, follower: bool) -> Matrix | None:
        """Coordinates in which the mechanics want a vector: base frame if dead, section frame if follower."""
        return vector if vector is None or follower else self.base_R_world @ vector

    def wrench_at(self, X: float, values: Mapping[str, Matrix | None], *, follower: bool) -> PointWrench:
        """Force and moment on the section at X."""
        force = self.placed(values["force"], follower=follower)
        moment = self.placed(values["moment"], follower=follower)
        return PointWrench(X, force, moment, follower)


@dataclass(frozen=True)
class BodyAction:
    """Force and moment on a rigid body.

    Attributes:
        position: the point that the force acts on, in the axes of the body, m.
        force: 3×1, N, or None.
        moment: 3×1, N m, or None.
        follower: whether force and moment turn with the body; their axes are then those of the body.
    """

    position: tuple[float, float, float]
    force: Matrix | None
    moment: Matrix | None
    follower: bool

    def scaled(self, factor: Matrix | None) -> BodyAction:
        """The load times a factor; itself where there is none."""
        if factor is None:
            return self
        force = None if self.force is None else factor * self.force
        moment = None if self.moment is None else factor * self.moment
        return replace(self, force=force, moment=moment)


class Effect(ABC):
    """One kind of load. A member is one file and one line of the registry.

    Attributes:
        kind: the word of the scene format.
        magnitudes: fields that may stay free at run time, the model's inputs, each with its unit.
    """

    kind: ClassVar[str]
    magnitudes: ClassVar[Mapping[str, str]]

    @abstractmethod
    def actions(self, load: Any, site: Site, values: Mapping[str, Matrix | None]) -> list[Action]:
        """What the load does to one rod.

        Args:
            load: the load as the scene has it.
            site: the rod it acts on.
            values: each magnitude as a 3×k matrix, symbolic or numeric; None where it is zero for good.
        """

    def acts_on(self, load: Any, rod: str) -> bool:
        """Whether the load acts on the rod of this name."""
        return bool(load.rod == rod)

    def on_body(self, load: Any, body: Any, values: Mapping[str, Matrix | None]) -> BodyAction | None:
        """What the load does to a rigid body; most loads act on rods alone.

        Args:
            load: the load as the scene has it.
            body: the body as the scene has it.
            values: as in :meth:`actions`.
        """
        return None

    def has_potential_on_bodies(self, load: Any, values: Mapping[str, FloatArray], *, flat: bool) -> bool:
        """Whether what these values do to bodies derives from a potential; ``flat``: all turn about one axis."""
        return True

    def breaks(self, load: Any) -> tuple[float, ...]:
        """Abscissae at which the rod's fields jump, so that its elements must end there."""
        return ()

    def has_potential(self, load: Any, values: Mapping[str, FloatArray], rod: RodProperties) -> bool:
        """Whether these values derive from a potential, so that stability is the sign of an eigenvalue.

        A force of fixed direction does. A moment of fixed direction does only where the rod turns about one axis.
        """
        forces = not np.any(values.get("force", 0.0))
        moments = not np.any(values.get("moment", 0.0))
        dead = getattr(load, "frame", "world") == "world"
        return (dead or forces) and (moments or (dead and len(rod.turning_axes) < 2))


def coefficients(vector: tuple[float | tuple[float, ...], ...]) -> FloatArray:
    """Three components, each a number or a list of Legendre coefficients, as one (3, k) array."""
    rows = [np.atleast_1d(np.asarray(component, dtype=float)) for component in vector]
    matrix = np.zeros((len(rows), max(len(row) for row in rows)))
    for i, row in enumerate(rows):
        matrix[i, : len(row)] = row
    return matrix


def constant(values: FloatArray) -> Matrix | None:
    """A baked-in magnitude: None where it is zero, so that it adds no instruction."""
    return ca.sparsify(ca.DM(values)) if np.any(values) else None
