"""Displacements of sections by the unknowns: they turn a tolerance on paths into a tolerance on unknowns."""

from __future__ import annotations

import casadi as ca
import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.function_table import kept_with
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.motion.repeated_call import external
from cosserat_casadi.rod.igm import InverseGeometricModel
from cosserat_casadi.rod.kinematics import shape
from cosserat_casadi.rod.statics import Statics
from cosserat_casadi.rod.strain import DiscreteRod
from cosserat_casadi.rod.tangent import Tangent

LEVER = 0.1
"""Lever arm, over the length, with which a rotation of a section counts: torsion makes a bent rod swing."""

QUATERNION = 2.0
"""Rotation of a frame by a unit of its quaternion, rad; its lever arm is one length."""


FUNCTION = "motion_displacements"
"""Name of the function of displacements in C."""


def displacements(model: Model, library: str | None = None) -> FloatArray:
    """Largest displacement of a section by a unit of each unknown, over the length, shape (size,); 1 if algebraic.

    Displacements by strain coordinates are taken at the unloaded rod, a shape as representative of a motion as any.

    Args:
        model: the model.
        library: shared object that contains :func:`function_of_displacements`; None without one.
    """
    return kept_with(model, "_displacements", lambda: _displacements(model, library))


def function_of_displacements(model: Model) -> ca.Function:
    """The displacements as a CasADi function without arguments, for a shared object: Python takes long for them."""
    return ca.Function(FUNCTION, [], [ca.DM(displacements(model))], [], ["displacements"])


def _displacements(model: Model, library: str | None) -> FloatArray:
    sizes = _computed(model) if library is None else external(FUNCTION, library)()["displacements"].full()[:, 0]
    # Several motions have it.
    sizes.setflags(write=False)
    return sizes


def _computed(model: Model) -> FloatArray:
    sizes = np.ones(model.size)
    unknowns = model.discrete.unknowns
    for name, rod in model.discrete.rods.items():
        of_strains = _of_strains(rod)
        sizes[unknowns.strain(name)] = of_strains
        # A flow moves no section by itself: an error of it makes one of the strain.
        for block, entries in unknowns.of_kind(BlockKind.FLOW):
            if block.rod == name:
                sizes[entries] = np.tile(of_strains, len(rod.properties.branches))
    for _, entries in unknowns.of_kind(BlockKind.POSE):
        sizes[entries][3:] = QUATERNION
    return sizes


def _of_strains(rod: DiscreteRod) -> FloatArray:
    """Largest displacement by a unit of each strain coordinate, over the length, shape (n,)."""
    # Numbers throughout: to write expressions first takes several times as long.
    unloaded = shape(rod, ca.DM.zeros(rod.size))
    tangent = Tangent(InverseGeometricModel(Statics(unloaded, [])))
    variation = ca.DM(tangent.tangent).full()
    turns = ca.DM(tangent.rotation).full()
    points = rod.grid.size
    # Stacked component by component: the first axis is that of the components.
    of_tangents = variation.reshape(3, points, rod.size)
    of_positions = np.einsum("ij,cjn->cin", rod.grid.integration_matrix, of_tangents)
    moved = np.linalg.norm(of_positions, axis=0).max(axis=0) / rod.length
    turned = np.zeros(rod.size)
    turned[: turns.shape[1]] = np.linalg.norm(turns.reshape(3, points, -1), axis=0).max(axis=0, initial=0.0)
    return np.asarray(np.maximum(moved, LEVER * turned))
