"""The equations of a scene, zero in equilibrium, and their exact Jacobian.

The equations of docs/theory.md, sections 2 to 8, in the order of the unknowns:

    rods          K q + Q_ad = 0, the report's (2.20), under loads and multipliers
    constraints   their residual = 0
    frames        balance of every floating frame = 0
    joints        balance along every coordinate that is an unknown = 0
    cables        length, or slack = 0
    stops         way to it, or nothing pushed with = 0
    flows at rest w = 0
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.assembly_equations import Assembly
from cosserat_casadi.model.system import System
from cosserat_casadi.model.unknowns import BlockKind


@dataclass(frozen=True)
class SceneEquations:
    """The equations of a scene in given arguments."""

    system: System

    @cached_property
    def assembly(self) -> Assembly:
        """Equations of floating frames, constraints and cables of given length."""
        return Assembly(self.system)

    @cached_property
    def residual(self) -> Matrix:
        """Residuals of rods, constraints, floating frames and cables of given length, without unit, size×1."""
        rod_rows = [igm.residual for igm in self.system.rods.values()]
        assembly = self.assembly
        of_frames = [*assembly.balance_rows, *assembly.coordinate_rows]
        assembly_rows = [*assembly.constraint_rows, *of_frames, *assembly.cable_rows, *assembly.stop_rows]
        return ca.vertcat(*rod_rows, *assembly_rows, *self._flow_rows)

    @property
    def _flow_rows(self) -> list[Matrix]:
        """Rows of the flows: w, which counts from rest; in motion statics has no rows for them."""
        flows = [self.system.arguments.x[own] for _, own in self.system.discrete.unknowns.of_kind(BlockKind.FLOW)]
        return flows if self.system.arguments.motion is None else [ca.DM(*flow.shape) for flow in flows]

    @cached_property
    def jacobian(self) -> Matrix:
        """∂ residual / ∂x from its structure, exact for the discrete model; sparse by rods."""
        discrete = self.system.discrete
        # The literal linear system of the report has no variations (docs/theory.md, section 4): it is differentiated.
        if any(rod.discretisation.transport == "permuted" for rod in discrete.rods.values()):
            return ca.jacobian(self.residual, self.system.arguments.x)
        flows = discrete.unknowns.count(BlockKind.FLOW)
        if discrete.constraints or discrete.cables or discrete.frames or self.system.coupled_rods:
            jacobian = self.assembly.jacobian
        else:
            # Rods that nothing couples have no row in common.
            tangents = [tangent.jacobian for tangent in self.system.tangents.values()]
            jacobian = ca.diagcat(*tangents, ca.DM(flows, flows))
        if self.system.arguments.motion is None and self.system.rubbing:
            jacobian += by_friction(self.system, [self.system.arguments.x])[0]
        if flows and self.system.arguments.motion is None:
            jacobian += ca.diagcat(ca.DM(discrete.size - flows, discrete.size - flows), ca.DM.eye(flows))
        return jacobian


def by_friction(system: System, arguments: Sequence[Matrix]) -> list[Matrix]:
    """Derivatives of the residual by arguments through the friction between rods and the drag on bodies.

    The equations are linear in friction and drag; derivatives at fixed friction are those of any dead load.
    """
    frictions = [friction for terms in system.rubbing for friction in terms.frictions]
    loads = ca.vertcat(*map(ca.vec, frictions))
    symbol = ca.MX.sym("friction", loads.shape[0])
    ends = np.cumsum([0, *(friction.numel() for friction in frictions)]).tolist()
    parts = iter(ca.reshape(part, 6, part.numel() // 6) for part in ca.vertsplit(symbol, ends))
    given = {terms.name: [next(parts) for _ in terms.frictions] for terms in system.rubbing}
    rows = SceneEquations(replace(system, friction=given)).residual
    loads_by = [ca.vertcat(*[terms.friction_jacobian(argument) for terms in system.rubbing]) for argument in arguments]
    changes = [ca.jtimes(rows, symbol, ca.densify(derivative)) for derivative in loads_by]
    return ca.substitute(changes, [symbol], [loads])
