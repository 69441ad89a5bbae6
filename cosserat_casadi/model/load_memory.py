"""What loads remember of the sections of rods from one point of a path to the next."""

from __future__ import annotations

import casadi as ca

from cosserat_casadi import scene as scenes
from cosserat_casadi.loads.load import Load, Section
from cosserat_casadi.maths.numbers import as_matrix
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.registry import EFFECTS
from cosserat_casadi.model.system import System


def remembering(loads: tuple[scenes.LoadRecord, ...]) -> list[scenes.LoadRecord]:
    """Loads that remember the sections of their rod."""
    return [load for load in loads if EFFECTS[load.kind].remembers(load)]


def remembered(system: System) -> tuple[list[Matrix], list[Matrix]]:
    """What each load that remembers keeps for the next point, h×M, and where its sections slip: above 1, 1×M."""
    kept = []
    slips = []
    for load in remembering(system.discrete.loads):
        member = EFFECTS[load.kind]
        assert load.rod is not None, "what remembers acts on a rod"
        positions, rotations = _poses(system, load.rod)
        data = as_matrix(member.data(load, system.rod_loads(load.rod).site(load)))
        kernel = _kernel(member, load, data.shape[0])
        history, slip = kernel.map(positions.shape[1])(positions, rotations, data)
        kept.append(history)
        slips.append(slip)
    return kept, slips


def _kernel(member: Load, load: scenes.LoadRecord, data_size: int) -> ca.Function:
    """(position, rotation, data) of a section ↦ what is kept, and whether it slips."""
    position, rotation, data = ca.SX.sym("position", 3), ca.SX.sym("rotation", 9), ca.SX.sym("data", data_size)
    section = Section(position, ca.reshape(rotation, 3, 3), data)
    return ca.Function("memory", [position, rotation, data], list(member.remembered(load, section)))


def _poses(system: System, rod: str) -> tuple[Matrix, Matrix]:
    """World positions, 3×M in m, and rotation matrices column after column, 9×M, at the nodes of a rod."""
    base = system.base(rod)
    shape = system.shapes[rod]
    rotation = base.rotation
    origin = ca.repmat(ca.MX(base.position), 1, shape.rod.grid.size)
    return origin + rotation @ shape.position, ca.vertcat(*[rotation @ director for director in shape.directors])
