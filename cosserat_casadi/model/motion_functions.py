"""The named functions of a model in motion: see model/model_functions.py and docs/theory.md, section 11.

Coordinates x are as in statics, v and a their first and second time derivatives. Multipliers and tensions have neither:
their entries of v and a are ignored.

The equations of motion F(x, v, a) = 0 are those of the scene at rest under one more load, the inertia of rods and
bodies, and the viscous stress of the rods. So the derivative by x at fixed inertia is the Jacobian of statics, and this
module adds little.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from cosserat_casadi.maths.calls import chooses
from cosserat_casadi.maths.numbers import as_matrix, is_symbolic
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.assembly_equations import BlockMatrix
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.model.floating_frames import FrameName
from cosserat_casadi.model.function_table import SHARED, Expressions, Output, Owner, owned_functions, scene_function
from cosserat_casadi.model.load_memory import rubbing_at_nodes
from cosserat_casadi.model.motion_energy import MotionEnergy
from cosserat_casadi.model.scene_constraints import PlacedConstraint
from cosserat_casadi.model.scene_equations import SceneEquations, by_friction
from cosserat_casadi.model.system import System
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.rod.motion_load import motion_matrices
from cosserat_casadi.rod.motion_matrices import Jet, MotionMatrices
from cosserat_casadi.rod.motion_tangent import MotionTangent

MOTION = ("x", "v", "a", "inputs", "inputs_rate", "inputs_acceleration")
"""Arguments of the functions of a scene in motion."""

VELOCITY = ("x", "v", "inputs", "inputs_rate")
"""Arguments of the functions that no acceleration enters."""


class MotionFunctions:
    """The named functions of a model in motion.

    Attributes:
        discrete: the scene with its constant matrices.
    """

    discrete: DiscreteScene

    @scene_function(Output("residual"), arguments=MOTION)
    def inverse_dynamics(self, written: Expressions) -> list[Matrix]:
        """(x, v, a, inputs, inputs_rate, inputs_acceleration) ↦ residual of the equations of motion, without unit.

        Zero along a motion. At rest it is the residual of statics to the last bit.
        """
        return [ca.densify(written.equations(SceneMotionEquations).residual)]

    @cached_property
    def inverse_dynamics_in_scalars(self) -> ca.Function:
        """Inverse dynamics expanded to scalar instructions, which CasADi evaluates in half to nine tenths of the time.

        It is not for differentiation. A function with branches that skip computations is not expanded.
        """
        kept: MotionFunctions | None = self.__dict__.get(SHARED)
        if kept is not None:
            return kept.inverse_dynamics_in_scalars
        function: ca.Function = self.inverse_dynamics
        return function if chooses(function) else function.expand()

    @scene_function(Output("slips"), arguments=VELOCITY)
    def slips(self, written: Expressions) -> list[Matrix] | None:
        """(x, v, inputs, inputs_rate) ↦ sliding speed of nodes over the slip speed, −1 for nodes without contact.

        Nodes of all loads with friction stand side by side, 1×…; None without friction.
        """
        loads = rubbing_at_nodes(written.system)
        return [ca.horzcat(*[load.slip for load in loads])] if loads else None

    @scene_function(Output("stiffness"), Output("damping"), Output("mass"), Output("residual"), arguments=MOTION)
    def dynamics_jacobian(self, written: Expressions) -> list[Matrix]:
        """(x, v, a, inputs, …) ↦ derivatives of the residual by x, v and a, size×size each, and the residual."""
        equations = written.equations(SceneMotionEquations)
        matrices = equations.matrices
        return [matrices.stiffness, matrices.damping, matrices.mass, equations.residual]

    @scene_function(Output("mass"))
    def mass_matrix(self, written: Expressions) -> list[Matrix]:
        """(x, inputs) ↦ mass matrix, size×size, symmetric but for the units of its rows, s²."""
        return [SceneMotionEquations(written.at_rest).matrices.mass]

    @owned_functions(Owner.ROD, (Output("base_force", "N"), Output("base_moment", "N m")), arguments=MOTION)
    def base_wrench(self, written: Expressions) -> list[Matrix]:
        """(x, v, a, inputs, …) ↦ force and moment about the base of the clamp on the rod in motion, world axes."""
        statics = written.system.rods[written.owner].statics
        rotation = written.system.base(written.owner).rotation
        return [rotation @ statics.held_force, rotation @ statics.held_moment]

    @scene_function(
        Output("kinetic", "J"),
        Output("elastic", "J"),
        Output("of_loads", "J"),
        Output("load_is_dead"),
        arguments=VELOCITY,
        kernel="energies",
        header="Kinetic and elastic energy, energy of each load, and whether it has one.",
    )
    def energies(self, written: Expressions) -> list[Matrix]:
        """(x, v, inputs, inputs_rate) ↦ kinetic and elastic energy, energy of each load, and whether it is known."""
        energy = written.equations(MotionEnergy)
        return [energy.kinetic, energy.elastic, energy.of_loads, ca.DM(energy.load_is_dead)]

    @scene_function(
        Output("dissipated", "W"),
        Output("of_loads", "W"),
        Output("of_actuators", "W"),
        Output("of_bases", "W"),
        arguments=MOTION,
    )
    def powers(self, written: Expressions) -> list[Matrix]:
        """(x, v, a, inputs, …) ↦ dissipated power, and powers of loads, actuators, moving bases and lengths."""
        energy = written.equations(MotionEnergy)
        return [energy.dissipated_power, energy.load_powers, energy.actuator_powers, energy.base_power]

    @scene_function(
        Output("linear", "N s"),
        Output("angular", "N m s"),
        arguments=VELOCITY,
        kernel="momentum",
        header="Momentum, and angular momentum about the origin of the world, world axes.",
    )
    def momentum(self, written: Expressions) -> list[Matrix]:
        """(x, v, inputs, inputs_rate) ↦ momentum, and angular momentum about the origin of the world, 3×1 each."""
        return list(written.equations(MotionEnergy).momentum)


@dataclass(frozen=True)
class SceneMotionEquations:
    """The equations of motion of a scene in given arguments.

    Attributes:
        system: rods, frames and constraints in arguments that have a motion.
    """

    system: System

    @cached_property
    def _at_rest(self) -> SceneEquations:
        """The equations of statics, with the inertia forces of the motion as loads."""
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
        for placed, resistance, _ in self._resisted_coordinates:
            number = list(unknowns.slices).index((BlockKind.COORDINATE, placed.where))
            added[number] = resistance
        return self._at_rest.residual + ca.vertcat(*added)

    @cached_property
    def matrices(self) -> MotionMatrices:
        """∂F/∂x, ∂F/∂v and ∂F/∂a, size×size each, sparse by blocks."""
        system, unknowns = self.system, self.system.discrete.unknowns
        stiffness, damping, mass = (BlockMatrix(unknowns.ends) for _ in range(3))

        def add(rows: slice, columns: slice, orders: Iterable[Matrix]) -> None:
            for matrix, block in zip((stiffness, damping, mass), orders, strict=True):
                matrix.add(rows, columns, block)

        for rod in system.motions:
            # The equations of a rod depend on the rates of its fields only through its mass or a load.
            loads = system.rods[rod].statics.pose_loads
            if rod in system.inertias or any(load.load.kernel.rates for load in loads):
                for rows, columns, orders in self._rod_blocks(rod):
                    add(rows, columns, orders)
        for name, frame_motion in system.frame_motions.items():
            frame = system.discrete.frames[name]
            entries = system.discrete.deviation(name)
            inertia = system.body_inertias.get(name.name)
            if frame.body is not None and inertia is not None:
                of_body = inertia.matrices.along(frame_motion.motion_jet())
                add(entries, entries, [matrix / frame.unit for matrix in of_body.orders])
            add(entries, entries, frame_motion.norm_matrices.orders)
        for rod, viscosity in system.viscosities.items():
            entries = unknowns.strain(rod)
            stiffness.add(entries, entries, viscosity.stiffness)
            damping.add(entries, entries, viscosity.damping)
        for rod, relaxation in system.relaxations.items():
            strains = unknowns.strain(rod)
            flows = unknowns.slice_of(BlockKind.FLOW, rod)
            damping.add(strains, flows, relaxation.matrices.force_by_rate)
            stiffness.add(flows, strains, relaxation.matrices.by_strain)
            damping.add(flows, strains, relaxation.matrices.by_strain_rate)
            damping.add(flows, flows, relaxation.matrices.by_rate)
            mass.add(flows, flows, relaxation.matrices.by_acceleration)
        for placed, _, by_rate in self._resisted_coordinates:
            entries = system.discrete.coordinate(placed)
            damping.add(entries, entries, by_rate)
        # Friction between rods, and drag on bodies, change with x and v both.
        by_x: Matrix = ca.DM(unknowns.size, unknowns.size)
        by_v: Matrix = ca.DM(unknowns.size, unknowns.size)
        if system.rubbing and is_symbolic(self._velocity):
            by_x, by_v = by_friction(system, [system.arguments.x, self._velocity])
        return MotionMatrices(
            stiffness=self._at_rest.jacobian + stiffness.matrix() + by_x,
            damping=damping.matrix() + by_v,
            mass=mass.matrix(),
        )

    @property
    def _velocity(self) -> Matrix:
        motion = self.system.arguments.motion
        assert motion is not None, "asked for in motion"
        return motion.v

    @property
    def _resisted_coordinates(self) -> Iterator[tuple[PlacedConstraint, Matrix, Matrix]]:
        """Joints with a damper or friction, with its term in their equation and the term's rate derivative, s."""
        discrete = self.system.discrete
        for placed in discrete.free_coordinates:
            effort = self.system.joint_effort(placed)
            if not effort.resists:
                continue
            scale = placed.coordinate_scale
            rate = scale * self._velocity[discrete.coordinate(placed)]
            rows = scale / placed.constraint.unit * effort.resistance(rate)
            by_rate = scale**2 / placed.constraint.unit * effort.resistance_slope(rate)
            yield placed, as_matrix(rows), as_matrix(by_rate)

    def _rod_blocks(self, rod: str) -> list[tuple[slice, slice, Sequence[Matrix]]]:
        """Blocks of a rod's inertia and motion-dependent loads in the rows of its strains and of its floating base."""
        discrete = self.system.discrete
        base = discrete.unloaded.floating_base(rod)
        unit = discrete.rods[rod].energy_unit
        floating = base is not None
        tangent = MotionTangent(self.system.tangents[rod], self.system.inertia_of(rod), floating=floating, unit=unit)
        matrices = motion_matrices(tangent, self.system.rods[rod].statics.pose_loads)
        strains = discrete.unknowns.strain(rod)
        if base is None:
            return [(strains, strains, matrices.orders)]
        whole = matrices.along(self._to_unknowns(rod, base))
        deviation = discrete.deviation(base)
        count = discrete.rods[rod].size
        ranges = {"strain": slice(0, count), "base": slice(count, None)}
        places = {"strain": strains, "base": deviation}
        # Rows of a frame have a unit of their own.
        factors = {"strain": 1.0, "base": unit / discrete.frames[base].unit}
        return [
            (rows, columns, [factors[row] * matrix[ranges[row], ranges[column]] for matrix in whole.orders])
            for row, rows in places.items()
            for column, columns in places.items()
        ]

    def _to_unknowns(self, rod: str, base: FrameName) -> Jet:
        """Jet of the matrix from the unknowns of a rod and its base to strains and the base's motion in base axes."""
        base_R_world = self.system.frame(base).rotation.T
        moved = self.system.frame_motions[base].motion_jet(base_R_world)
        count = self.system.discrete.rods[rod].size
        still = ca.DM(count, count)
        return Jet(
            value=ca.diagcat(ca.DM.eye(count), moved.value),
            rate=ca.diagcat(still, moved.rate),
            acceleration=ca.diagcat(still, moved.acceleration),
        )
