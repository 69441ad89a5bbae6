"""Rigid stops of joints, and rigid cables that may go slack, as exact contacts of steps in C.

The distance of a joint from its stop, or the sag of a cable, is treated as the distance of a point on a line from a
plane across it; the push of the stop, or the tension, is the force along the normal. Steps in C have points, surfaces
and the law between gaps and forces, so that these pairs need no other law.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from cosserat_casadi import scene as scenes
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.discrete_scene import CableOfLength, JointStop
from cosserat_casadi.model.function_table import kept_with
from cosserat_casadi.model.system import System
from cosserat_casadi.motion.contact_gap import Facing
from cosserat_casadi.motion.contact_sections import BodyFacing
from cosserat_casadi.motion.facings import facings
from cosserat_casadi.motion.moving_points import MovingPoints
from cosserat_casadi.motion.one_sided import OneSided


@dataclass(frozen=True)
class PairFacing(BodyFacing):
    """A joint with a rigid stop, or a rigid cable that may go slack.

    Attributes:
        number: index of the pair among those of :class:`~cosserat_casadi.motion.one_sided.OneSided`.
        push_entry: entry of the push or the tension in the unknowns, whose row is the equation of the pair.
        scale: unit of the coordinate of the joint, rad or m; for a cable the length of its rod, m.
        energy: energy unit of the work of the push, J.
    """

    number: int
    push_entry: int
    scale: float
    energy: float

    @cached_property
    def length(self) -> float:
        """Unit of the distance, rad or m, by which gaps are divided."""
        return self.scale

    @cached_property
    def force_unit(self) -> float:
        """Unit of the push, N m or N."""
        return self.energy / self.scale


@dataclass(frozen=True)
class StopFacing(PairFacing):
    """A joint with a rigid stop.

    Attributes:
        stop: the stop.
    """

    stop: JointStop

    @property
    def coordinate_entry(self) -> int:
        """Entry of the coordinate of the joint in the unknowns, whose row is the balance along the joint."""
        return int(self.model.discrete.coordinate(self.stop.placed).start)


def stop_facings(model: Model) -> list[StopFacing]:
    """All rigid stops of a model, built for a motion."""
    return [own for own in pair_facings(model) if isinstance(own, StopFacing)]


def pair_facings(model: Model) -> list[PairFacing]:
    """All rigid pairs of a model, built for a motion: cables that may go slack, then stops."""
    return kept_with(model, "_pair_facings", lambda: _pair_facings(model))


def struck_in_steps(model: Model) -> list[Facing]:
    """All pairs that exported steps keep apart: rods and bodies with obstacles, then joints with rigid stops."""
    return [*facings(model), *stop_facings(model)]


def struck_beside_friction(model: Model) -> list[Facing]:
    """All pairs that simulated steps with friction keep apart: contacts with obstacles, rigid cables and stops."""
    return [*facings(model), *pair_facings(model)]


def _pair_facings(model: Model) -> list[PairFacing]:
    sided = OneSided(model)
    owners: list[CableOfLength | JointStop] = [*sided.cables, *model.discrete.stops]
    return [_facing(model, sided, number, own) for number, own in enumerate(owners) if sided.pairs[number].rigid]


def _facing(model: Model, sided: OneSided, number: int, own: CableOfLength | JointStop) -> PairFacing:
    pair = sided.pairs[number]
    plane = scenes.Plane(
        name=pair.side or "length",
        kind="plane",
        point=(0.0, 0.0, 0.0),
        normal=(1.0, 0.0, 0.0),
        restitution=pair.restitution,
    )

    def points(way: Callable[[System], Matrix], scale: float) -> MovingPoints:
        return MovingPoints(model, lambda system: ca.vertcat(scale * way(system), 0.0, 0.0), f"pair_{number}")

    if isinstance(own, JointStop):
        scale, energy = float(own.placed.coordinate_scale), float(own.placed.constraint.unit)
        placed = points(lambda system: system.way_to_stop(own), scale)
        return StopFacing(model, pair.name, plane, placed, True, 0.0, number, pair.row, scale, energy, own)
    rod = model.discrete.rods[own.tendon.rod]
    scale, energy = float(rod.properties.length), float(rod.energy_unit)
    placed = points(lambda system: system.actuators.cable_lengths[own.tendon.name].sag, scale)
    return PairFacing(model, pair.name, plane, placed, True, 0.0, number, pair.row, scale, energy)
