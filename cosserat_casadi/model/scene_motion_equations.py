"""The equations of motion of a scene, F(x, v, a) = 0, and their exact derivatives: docs/theory.md, section 11.

They are the equations of the scene at rest under one more load, the inertia of rods and bodies, and the viscous stress
of the rods. So the derivative with x at fixed inertia is the Jacobian of statics, and this module adds little.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import casadi as ca

from cosserat_casadi.maths.numbers import as_matrix, is_symbolic
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.assembly_equations import BlockMatrix
from cosserat_casadi.model.floating_frames import FrameName
from cosserat_casadi.model.scene_constraints import PlacedConstraint
from cosserat_casadi.model.scene_equations import SceneEquations, by_friction
from cosserat_casadi.model.system import System
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.rod.motion_load import motion_matrices
from cosserat_casadi.rod.motion_matrices import Jet, MotionMatrices
from cosserat_casadi.rod.motion_tangent import MotionTangent


class _Resisted(NamedTuple):
    """A joint with a damper or friction.

    Attributes:
        placed: the joint.
        entries: of its coordinate.
        rows: what the resistance adds to the equation of the coordinate, without unit, 1×1.
        damping: derivative of that with the rate of the entry, s, 1×1.
    """

    placed: PlacedConstraint
    entries: slice
    rows: Matrix
    damping: Matrix


@dataclass(frozen=True)
class SceneMotionEquations:
    """The equations of motion of a scene in given arguments.

    Attributes:
        system: rods, frames and constraints in arguments that have a motion.
    """

    system: System

    @cached_property
    def _at_rest(self) -> SceneEquations:
        """The equations that hold at rest, with the inertia forces of the motion."""
        return SceneEquations(self.system)

    @cached_property
    def residual(self) -> Matrix:
        """Residuals of rods, constraints, floating frames and cables in motion, without unit, size×1."""
        unknowns = self.system.discrete.unknowns
        added: list[Matrix] = []
        for block in unknowns.blocks:
            rows: Matrix = ca.DM(block.size, 1)
            if block.kind is BlockKind.STRAIN and block.owner in self.system.viscosities:
                rows = self.system.viscosities[block.owner].force
            if block.kind is BlockKind.STRAIN and block.owner in self.system.relaxations:
                rows = rows + self.system.relaxations[block.owner].force
            if block.kind is BlockKind.FLOW:
                rows = self.system.relaxations[block.owner].equations
            added.append(rows)
        for name, frame_motion in self.system.frame_motions.items():
            number = list(unknowns.slices).index((BlockKind.POSE, str(name)))
            added[number] = frame_motion.norm_rows
        for resisted in self._resisted_coordinates:
            number = list(unknowns.slices).index((BlockKind.COORDINATE, resisted.placed.where))
            added[number] = resisted.rows
        return self._at_rest.residual + ca.vertcat(*added)

    @cached_property
    def matrices(self) -> MotionMatrices:
        """∂F/∂x, ∂F/∂v and ∂F/∂a, size×size each, sparse by blocks."""
        stiffness = self._blocks()
        damping = self._blocks()
        mass = self._blocks()
        for rod in self._rods_with_rates:
            for rows, columns, part in self._rod_blocks(rod):
                stiffness.add(rows, columns, part.stiffness)
                damping.add(rows, columns, part.damping)
                mass.add(rows, columns, part.mass)
        for name, frame_motion in self.system.frame_motions.items():
            frame = self.system.discrete.frames[name]
            entries = self.system.discrete.deviation(name)
            inertia = self.system.body_inertias.get(name.name)
            if frame.body is not None and inertia is not None:
                part = inertia.matrices.along(frame_motion.motion_jet())
                stiffness.add(entries, entries, part.stiffness / frame.unit)
                damping.add(entries, entries, part.damping / frame.unit)
                mass.add(entries, entries, part.mass / frame.unit)
            stiffness.add(entries, entries, frame_motion.norm_matrices.stiffness)
            damping.add(entries, entries, frame_motion.norm_matrices.damping)
            mass.add(entries, entries, frame_motion.norm_matrices.mass)
        for rod, viscosity in self.system.viscosities.items():
            entries = self.system.discrete.unknowns.strain(rod)
            stiffness.add(entries, entries, viscosity.stiffness)
            damping.add(entries, entries, viscosity.damping)
        for rod, relaxation in self.system.relaxations.items():
            strains = self.system.discrete.unknowns.strain(rod)
            flows = self.system.discrete.unknowns.slice_of(BlockKind.FLOW, rod)
            damping.add(strains, flows, relaxation.matrices.force_by_rate)
            stiffness.add(flows, strains, relaxation.matrices.by_strain)
            damping.add(flows, strains, relaxation.matrices.by_strain_rate)
            damping.add(flows, flows, relaxation.matrices.by_rate)
            mass.add(flows, flows, relaxation.matrices.by_acceleration)
        for resisted in self._resisted_coordinates:
            damping.add(resisted.entries, resisted.entries, resisted.damping)
        by_friction = self._by_friction
        return MotionMatrices(
            stiffness=self._at_rest.jacobian + stiffness.matrix() + by_friction[0],
            damping=damping.matrix() + by_friction[1],
            mass=mass.matrix(),
        )

    @property
    def _by_friction(self) -> tuple[Matrix, Matrix]:
        """Derivatives with x and v by the change of friction between rods, and of drag on bodies, with both."""
        size = self.system.discrete.size
        if not self.system.rubbing or not is_symbolic(self._velocity):
            return ca.DM(size, size), ca.DM(size, size)
        by_x, by_v = by_friction(self.system, [self.system.arguments.x, self._velocity])
        return by_x, by_v

    @property
    def _velocity(self) -> Matrix:
        motion = self.system.arguments.motion
        assert motion is not None, "asked for in motion"
        return motion.v

    @property
    def _resisted_coordinates(self) -> list[_Resisted]:
        """Joints with a damper or friction."""
        discrete = self.system.discrete
        found = []
        for placed in discrete.free_coordinates:
            effort = self.system.joint_effort(placed)
            if not effort.resists:
                continue
            entries = discrete.coordinate(placed)
            scale = placed.coordinate_scale
            rate = scale * self._velocity[entries]
            rows = scale / placed.constraint.unit * effort.resistance(rate)
            damping = scale**2 / placed.constraint.unit * effort.resistance_slope(rate)
            found.append(_Resisted(placed, entries, as_matrix(rows), as_matrix(damping)))
        return found

    @property
    def _rods_with_rates(self) -> list[str]:
        """Rods whose equations depend on the rates of their fields: by their mass, or by a load."""
        rods = []
        for name in self.system.motions:
            loads = self.system.rods[name].statics.pose_loads
            if name in self.system.inertias or any(load.load.kernel.rates for load in loads):
                rods.append(name)
        return rods

    def _blocks(self) -> BlockMatrix:
        ends = [entries.stop for entries in self.system.discrete.unknowns.slices.values()]
        return BlockMatrix(ends)

    def _rod_blocks(self, rod: str) -> list[tuple[slice, slice, MotionMatrices]]:
        """Blocks of a rod's inertia and of loads of its motion in the rows of its strains, and of a floating base."""
        discrete = self.system.discrete
        base = discrete.unloaded.floating_base(rod)
        unit = discrete.rods[rod].energy_unit
        floating = base is not None
        tangent = MotionTangent(self.system.tangents[rod], self.system.inertia_of(rod), floating=floating, unit=unit)
        matrices = motion_matrices(tangent, self.system.rods[rod].statics.pose_loads)
        strains = discrete.unknowns.strain(rod)
        if base is None:
            return [(strains, strains, matrices)]
        whole = matrices.along(self._to_unknowns(rod, base))
        deviation = discrete.deviation(base)
        count = discrete.rods[rod].size
        ranges = {"strain": slice(0, count), "base": slice(count, None)}
        places = {"strain": strains, "base": deviation}
        # Rows of a frame have a unit of their own.
        factors = {"strain": 1.0, "base": unit / discrete.frames[base].unit}
        blocks = []
        for row, rows in places.items():
            for column, columns in places.items():
                factor = factors[row]
                part = MotionMatrices(
                    stiffness=factor * whole.stiffness[ranges[row], ranges[column]],
                    damping=factor * whole.damping[ranges[row], ranges[column]],
                    mass=factor * whole.mass[ranges[row], ranges[column]],
                )
                blocks.append((rows, columns, part))
        return blocks

    def _to_unknowns(self, rod: str, base: FrameName) -> Jet:
        """From the unknowns of a rod and of its base to strains and the motion of the base in its axes, with rates."""
        base_R_world = self.system.frame(base).rotation.T
        moved = self.system.frame_motions[base].motion_jet(base_R_world)
        count = self.system.discrete.rods[rod].size
        still = ca.DM(count, count)
        return Jet(
            value=ca.diagcat(ca.DM.eye(count), moved.value),
            rate=ca.diagcat(still, moved.rate),
            acceleration=ca.diagcat(still, moved.acceleration),
        )
