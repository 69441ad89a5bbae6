"""Friction of rods on obstacles at their nodes: in motion, and from one point of a path to the next."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from cosserat_casadi.loads.load import Rubbing, Section
from cosserat_casadi.maths.numbers import as_matrix
from cosserat_casadi.model.drag_terms import seen_motion
from cosserat_casadi.model.registry import EFFECTS, remembering
from cosserat_casadi.model.system import System
from cosserat_casadi.scene.load_records import LoadRecord


def rubbing_at_nodes(system: System) -> list[Rubbing]:
    """Memory h×M, slip 1×M and friction 3×M, world axes, at the nodes of the rod of each load with memory."""
    found = []
    for load in remembering(system.discrete.loads):
        body = EFFECTS[load.kind].seen_from(load)
        base, shape = system.rod_loads(load.rod).base_of(load), system.shapes[load.rod]
        rotation = base.base_R_world.T
        origin = ca.repmat(ca.MX(base.position), 1, shape.rod.grid.size)
        positions = origin + rotation @ shape.position
        rotations = ca.vertcat(*[rotation @ director for director in shape.directors])
        data = as_matrix(EFFECTS[load.kind].data(load, system.rod_loads(load.rod).site(load)))
        arguments = [positions, rotations, data]
        if system.motions:
            motion = seen_motion(system, load.rod, body)
            arguments += [rotation @ motion.velocity, rotation @ motion.angular_velocity]
        kernel = _kernel(load, [field.shape[0] for field in arguments])
        history, slip, friction = kernel.map(positions.shape[1])(*arguments)
        found.append(Rubbing(history, slip, friction if body is None else system.body(body).rotation @ friction))
    return found


def _kernel(load: LoadRecord, sizes: Sequence[int]) -> ca.Function:
    """(position, rotation, data, in motion velocity and angular velocity) of a section ↦ memory, slip, friction."""
    names = ("position", "rotation", "data", "velocity", "angular_velocity")
    position, rotation, data, *rates = (ca.SX.sym(name, size) for name, size in zip(names, sizes, strict=False))
    section = Section(position, ca.reshape(rotation, 3, 3), data, *rates)
    rubbing = EFFECTS[load.kind].rubbing(load, section)
    results = [ca.densify(ca.SX(field)) for field in (rubbing.history, rubbing.slip, rubbing.friction)]
    return ca.Function("rubbing", [position, rotation, data, *rates], results)
