"""The named functions of a model in motion: see model/model_functions.py and docs/theory.md, section 11.

Coordinates x are as in statics, v and a their first and second time derivatives. Multipliers and tensions have
neither: their entries of v and a are not read.
"""

from __future__ import annotations

from functools import cached_property

import casadi as ca

from cosserat_casadi.maths.calls import chooses
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.model.function_table import SHARED, Expressions, Output, Owner, owned_functions, scene_function
from cosserat_casadi.model.load_memory import rubbing_at_nodes
from cosserat_casadi.model.motion_energy import MotionEnergy
from cosserat_casadi.model.scene_motion_equations import SceneMotionEquations

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
        """Inverse dynamics as instructions on scalars, which a virtual machine runs in half to nine tenths of the time.

        Derivatives are not to be taken of it. A function that leaves computations out by a value stays as it is.
        """
        kept: MotionFunctions | None = self.__dict__.get(SHARED)
        if kept is not None:
            return kept.inverse_dynamics_in_scalars
        function: ca.Function = self.inverse_dynamics
        return function if chooses(function) else function.expand()

    @scene_function(Output("slips"), arguments=VELOCITY)
    def slips(self, written: Expressions) -> list[Matrix] | None:
        """(x, v, inputs, inputs_rate) ↦ speed of nodes over the slip speed, −1 where nothing presses.

        Of each load that rubs, side by side, 1×…; None without friction.
        """
        loads = rubbing_at_nodes(written.system)
        return [ca.horzcat(*[load.slip for load in loads])] if loads else None

    @scene_function(Output("stiffness"), Output("damping"), Output("mass"), Output("residual"), arguments=MOTION)
    def dynamics_jacobian(self, written: Expressions) -> list[Matrix]:
        """(x, v, a, inputs, …) ↦ derivatives of the residual with x, v and a, size×size each, and the residual."""
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
        """(x, v, inputs, inputs_rate) ↦ kinetic and elastic energy, energy of each load, and whether it has one."""
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
        """(x, v, a, inputs, …) ↦ power that is dissipated, and powers of loads, actuators, moving bases and lengths."""
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
