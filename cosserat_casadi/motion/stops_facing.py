"""Rigid stops of joints among what touches exactly in steps in C.

A stop is a plane, and the coordinate of its joint is a point on the line across it: the way of the joint to its stop is
the distance of the point from the plane, and the push of the stop is the force along the normal. Steps in C know
points, surfaces and the law between gaps and forces, so that stops need no other law.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from cosserat_casadi import scene as scenes
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.discrete_scene import JointStop
from cosserat_casadi.model.function_table import kept_with
from cosserat_casadi.model.system import System
from cosserat_casadi.motion.contact_gap import Facing
from cosserat_casadi.motion.contact_sections import BodyFacing
from cosserat_casadi.motion.facings import facings
from cosserat_casadi.motion.moving_points import MovingPoints


@dataclass(frozen=True)
class StopFacing(BodyFacing):
    """A joint and a rigid stop of it.

    Attributes:
        stop: the stop.
    """

    stop: JointStop

    @cached_property
    def length(self) -> float:
        """Unit of the coordinate, rad or m: gaps are ways over it."""
        return float(self.stop.placed.coordinate_scale)

    @cached_property
    def force_unit(self) -> float:
        """Unit of the push, N m or N."""
        return float(self.stop.placed.constraint.unit) / self.length

    @property
    def push_entry(self) -> int:
        """Entry of the push in the unknowns, whose row is the pair of the stop."""
        return int(self.model.discrete.stop(self.stop).start)

    @property
    def coordinate_entry(self) -> int:
        """Entry of the coordinate of the joint in the unknowns, whose row is the balance along it."""
        return int(self.model.discrete.coordinate(self.stop.placed).start)


def stop_facings(model: Model) -> list[StopFacing]:
    """All rigid stops of a model, built for a motion."""
    rigid = [stop for stop in model.discrete.stops if stop.stiffness is None]
    found: list[StopFacing] = kept_with(
        model, "_stop_facings", lambda: [_facing(model, stop, number) for number, stop in enumerate(rigid)]
    )
    return found


def struck_in_steps(model: Model) -> list[Facing]:
    """All pairs that steps in C keep apart: rods and bodies with obstacles, then joints with rigid stops."""
    return [*facings(model), *stop_facings(model)]


def points_in_steps(model: Model) -> list[MovingPoints]:
    """Points of these pairs, each once."""
    return list(dict.fromkeys(facing.points for facing in struck_in_steps(model)))


def _facing(model: Model, stop: JointStop, number: int) -> StopFacing:
    record = model.discrete.joint_record(stop.placed)
    plane = scenes.Plane(
        name=stop.key,
        kind="plane",
        point=(0.0, 0.0, 0.0),
        normal=(1.0, 0.0, 0.0),
        restitution=float(record.restitution),
    )

    def placed(system: System) -> Matrix:
        return ca.vertcat(stop.placed.coordinate_scale * system.way_to_stop(stop), 0.0, 0.0)

    points = MovingPoints(model, placed, f"stop_{number}")
    return StopFacing(model, record.name or stop.placed.where, plane, points, True, 0.0, stop)
