"""Energies, powers and momenta of a scene in motion, the terms of its balance of energy.

Along a motion the rate of kinetic and elastic energy is the power of loads, actuators, moving bases and changing
lengths, less the power that viscous stress dissipates. A growing length adds material at the speed of its section.
Docs/theory.md, section 11.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.constraints.joint_coordinate import JointEffort
from cosserat_casadi.loads.contact_layer import ContactLayer
from cosserat_casadi.maths.numbers import as_matrix, is_zero
from cosserat_casadi.maths.pose import Pose
from cosserat_casadi.maths.rotation import dot
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.body_loads import BodyLoad, BodyLoads
from cosserat_casadi.model.body_obstacle_loads import BorneLoad
from cosserat_casadi.model.load_potential import is_dead_force
from cosserat_casadi.model.registry import EFFECTS
from cosserat_casadi.model.system import MotionArguments, System
from cosserat_casadi.rod.inertia import RodInertia, masses_along
from cosserat_casadi.rod.pose_load import LoadedSections
from cosserat_casadi.rod.rod_motion import AT_REST, FrameMotion, RodMotion, StrainRates
from cosserat_casadi.rod.statics import Statics
from cosserat_casadi.rod.wrenches import LineWrench, PoseWrench, Wrench


@dataclass(frozen=True)
class MotionEnergy:
    """Energies and powers of a scene in given arguments.

    Attributes:
        system: rods, frames and constraints in arguments that have a motion.
    """

    system: System

    @cached_property
    def kinetic(self) -> Matrix:
        """Kinetic energy of rods and bodies, 1×1, J."""
        of_rods = [inertia.kinetic_energy for inertia in self.system.inertias.values()]
        of_bodies = [inertia.kinetic_energy for inertia in self.system.body_inertias.values()]
        return _sum([*of_rods, *of_bodies])

    @cached_property
    def elastic(self) -> Matrix:
        """Elastic energy of rods and their branches, of springs and stops of joints, and of rod contact, 1×1, J."""
        branches = [relaxation.energy for relaxation in self.system.relaxations.values()]
        springs = [
            effort.spring_energy(value) for effort, value, _ in self._free_joints if not is_zero(effort.stiffness)
        ]
        stops = [self.system.stop_energy(stop) for stop in self.system.discrete.stops if stop.stiffness is not None]
        between = [terms.energy for terms in self.system.pairs]
        return _sum([self.system.energy(), *branches, *springs, *stops, *between])

    @cached_property
    def load_is_dead(self) -> FloatArray:
        """1 for each load with a known energy, a dead force or smooth contact, else 0; shape (loads,)."""
        discrete = self.system.discrete
        flags = [isinstance(load, ContactLayer) or is_dead_force(discrete, load) for load in self._loads]
        return np.asarray(flags, dtype=float)

    @cached_property
    def of_loads(self) -> Matrix:
        """Energy of each load, (loads)×1, J: −Σ f·r of a dead force, stored energy of smooth contact, else zero."""
        energies = []
        for load, dead in zip(self._loads, self.load_is_dead, strict=True):
            energy = ca.DM(1, 1)
            if isinstance(load, ContactLayer):
                energy = self._contact_energy(load)
            elif dead:
                energy = self._energy_of(load)
            energies.append(energy)
        return ca.vertcat(*energies)

    @cached_property
    def dissipated_power(self) -> Matrix:
        """Power that damping of rods, dampers and friction of joints and of contact turn into heat, 1×1, W."""
        of_rods = [viscosity.dissipated_power for viscosity in self.system.viscosities.values()]
        of_branches = [relaxation.dissipated_power for relaxation in self.system.relaxations.values()]
        for inertia in self.system.inertias.values():
            damping = inertia.motion.rod.properties.mass_damping
            if damping is not None:
                of_rods.append(2 * damping * inertia.kinetic_energy)
        # The push of contact at rest stores energy; the rest of its power is lost.
        of_contact = [
            self._power_of(load, resting=True) - self._power_of(load) for load in self._loads if _is_damped(load)
        ]
        of_contact += [terms.dissipated_power for terms in self.system.rubbing]
        of_joints = [effort.resistance(rate) * rate for effort, _, rate in self._free_joints if effort.resists]
        return _sum([*of_rods, *of_branches, *of_joints, *of_contact])

    @cached_property
    def load_powers(self) -> Matrix:
        """Power of each load, (loads)×1, W; for contact the power that it stores, without its damping."""
        return ca.vertcat(*[self._power_of(load, resting=_is_damped(load)) for load in self._loads])

    @cached_property
    def actuator_powers(self) -> Matrix:
        """Power of each actuator on its rod, (actuators)×1, W: minus its effort times the rate of its conjugate.

        Losses by friction along a cable are subtracted.
        """
        powers = []
        for actuator in self.system.discrete.scene.actuators:
            effort, _, _ = self.system.actuators.state(actuator.name)
            _, conjugate = self.system.actuators.conjugate(actuator.name)
            rate = self.system.actuators.pull(actuator.name).T @ self._motion.v + conjugate.rate(self._by_inputs)
            sign = EFFECTS[actuator.kind].energy_sign
            powers.append(-sign * effort * rate)
        stacked: Matrix = ca.vertcat(*powers)
        return stacked

    @cached_property
    def base_power(self) -> Matrix:
        """Power of clamps of moving bases, of drives and motors of joints, and of changing lengths, 1×1, W."""
        powers = [*self._drive_powers, *(effort.motor * rate for effort, _, rate in self._free_joints)]
        for rod, igm in self.system.rods.items():
            if self.system.discrete.unloaded.floating_base(rod) is None:
                base = self.system.base_motion(rod)
                by_force = ca.dot(igm.statics.base_force, base.velocity)
                by_moment = ca.dot(igm.statics.base_moment, base.angular_velocity)
                powers.append(by_force + by_moment)
            if self.system.discrete.layout.of_rod(rod, "length") is not None:
                powers.append(self._length_power(rod))
        return _sum(powers)

    @cached_property
    def momentum(self) -> tuple[Matrix, Matrix]:
        """Momentum, N s, and angular momentum about the origin of the world, N m s, 3×1 each."""
        linear: Matrix = ca.DM.zeros(3, 1)
        angular: Matrix = ca.DM.zeros(3, 1)
        for rod, inertia in self.system.inertias.items():
            base = self.system.base(rod)
            of_rod = base.rotation @ inertia.linear_momentum
            about_base = base.rotation @ inertia.angular_momentum
            linear = linear + of_rod
            angular = angular + about_base + ca.cross(base.position, of_rod)
        for name, body in self.system.body_inertias.items():
            of_body = body.mass * body.velocity
            centre = self.system.body(name).position + body.arm
            spin = body.world_inertia @ body.motion.angular_velocity
            linear = linear + of_body
            angular = angular + spin + ca.cross(centre, of_body)
        return linear, angular

    @property
    def _loads(self) -> tuple[scenes.LoadRecord, ...]:
        return self.system.discrete.loads

    @cached_property
    def _free_joints(self) -> list[tuple[JointEffort, Matrix, Matrix]]:
        """Springs, dampers and motors along coordinates that are unknowns, with the values and rates of these."""
        joints = []
        for placed in self.system.discrete.free_coordinates:
            value, _ = self.system.joint_state(placed)
            rate = placed.coordinate_scale * self._motion.v[self.system.discrete.coordinate(placed)]
            joints.append((self.system.joint_effort(placed), value, rate))
        return joints

    @property
    def _drive_powers(self) -> Iterator[Matrix]:
        """Power of each drive that an input moves, 1×1, W: it pushes the section with the effort along its axis."""
        discrete = self.system.discrete
        for placed in discrete.constraints:
            if placed.constraint.coordinate is None or placed in discrete.free_coordinates:
                continue
            record = discrete.joint_record(placed)
            entries = discrete.layout.of_load(record.name or "", record.coordinate_key)
            if entries is not None:
                yield self.system.joint_state(placed)[1] * self._motion.inputs_rate[entries]

    @property
    def _motion(self) -> MotionArguments:
        motion = self.system.arguments.motion
        assert motion is not None, "asked for in motion"
        return motion

    def _by_inputs(self, value: Matrix) -> Matrix:
        """Rate of a value by the inputs that move rods, at fixed unknowns, efforts and profiles."""
        geometry = self.system.discrete.layout.geometry
        if not geometry:
            return ca.DM(*value.shape)
        moving = ca.DM(self.system.arguments.inputs.shape[0], 1)
        moving[geometry] = 1.0
        return ca.jtimes(value, self.system.arguments.inputs, moving * self._motion.inputs_rate)

    # Loads

    def _on_rods(self, load: scenes.LoadRecord, *, resting: bool = False) -> Iterator[tuple[str, Wrench]]:
        """Rods that a load acts on, with its wrenches at this instant, base axes, or with its wrenches at rest."""
        of_load = self.system.resting_loads_of if resting else self.system.loads_of
        for rod in self.system.discrete.rods:
            for wrench in of_load(load, rod):
                if isinstance(wrench, PoseWrench):
                    yield rod, LoadedSections(wrench, self.system.shapes[rod]).frozen
                else:
                    yield rod, wrench

    def _on_bodies(self, load: scenes.LoadRecord) -> Iterator[tuple[Pose, FrameMotion, BodyLoad]]:
        """Poses and motions of the bodies that a load acts on, with the load on each, world axes."""
        for name, body in self.system.discrete.bodies.items():
            pose = self.system.body(name)
            loads = BodyLoads(self.system.discrete, body, pose.position, pose.rotation, self.system.arguments.inputs)
            body_load = loads.of(load)
            if body_load is not None:
                yield pose, self.system.body_motions[name], body_load

    def _power_of(self, load: scenes.LoadRecord, *, resting: bool = False) -> Matrix:
        powers = []
        for rod, wrench in self._on_rods(load, resting=resting):
            powers.append(self._wrench_power(self.system.motions[rod], wrench))
        for _, motion, body_load in self._on_bodies(load):
            twist = ca.vertcat(motion.angular_velocity, motion.velocity)
            powers.append(ca.dot(body_load.wrench, twist))
        for borne in self._borne(load):
            body_motion = self.system.body_motions[borne.body.name]
            powers.append(ca.dot(borne.wrench, ca.vertcat(body_motion.angular_velocity, body_motion.velocity)))
        return _sum(powers)

    def _borne(self, load: scenes.LoadRecord) -> Iterator[BorneLoad]:
        """Reactions of a load on rods on the bodies that bear them."""
        for rod in self.system.discrete.rods:
            for wrench in self.system.loads_of(load, rod):
                if isinstance(wrench, PoseWrench) and wrench.borne_by is not None:
                    sections = LoadedSections(wrench, self.system.shapes[rod])
                    yield BorneLoad(self.system, rod, sections)

    def _contact_energy(self, load: scenes.LoadRecord) -> Matrix:
        """Energy stored in the contact with an obstacle with a width, 1×1, J."""
        energies = []
        for rod in self.system.discrete.rods:
            for wrench in self.system.resting_loads_of(load, rod):
                assert isinstance(wrench, PoseWrench), "the force of contact hangs on the place of its section"
                energy = LoadedSections(wrench, self.system.shapes[rod]).energy
                assert energy is not None, "contact is given by its energy"
                energies.append(energy)
        for _, _, body_load in self._on_bodies(load):
            assert body_load.energy is not None, "contact is given by its energy"
            energies.append(body_load.energy)
        return _sum(energies)

    def _energy_of(self, load: scenes.LoadRecord) -> Matrix:
        """Minus the work of dead forces on a displacement from the origin of the world, 1×1, J."""
        energies = []
        for rod, wrench in self._on_rods(load):
            if wrench.force is not None:
                base = self.system.base(rod)
                position = base.rotation.T @ base.position + self.system.shapes[rod].position
                work = self._work(rod, wrench, wrench.force, position)
                energies.append(-work)
        for pose, _, body_load in self._on_bodies(load):
            point = pose.position + body_load.arm
            energies.append(-ca.dot(body_load.force, point))
        return _sum(energies)

    def _wrench_power(self, motion: RodMotion, wrench: Wrench) -> Matrix:
        """Power of a wrench on the sections of a rod in a motion, 1×1, W."""
        rod = motion.rod.properties.name
        powers = []
        if wrench.force is not None:
            powers.append(self._work(rod, wrench, wrench.force, motion.velocity))
        if wrench.moment is not None:
            powers.append(self._work(rod, wrench, wrench.moment, motion.angular_velocity))
        return _sum(powers)

    def _work(self, rod: str, wrench: Wrench, vector: Matrix, moved: Matrix) -> Matrix:
        """Sum over the loaded sections of a force or a moment times a field at the nodes, 3×M; 1×1."""
        rod_shape = self.system.shapes[rod]
        if isinstance(wrench, LineWrench):
            per_length = Statics(rod_shape, [wrench]).line(wrench, vector)
            return dot(per_length, moved) @ as_matrix(rod_shape.rod.node_lengths)
        node = rod_shape.rod.grid.node_at(wrench.at)
        if wrench.follower:
            vector = rod_shape.rotation_at(node) @ vector
        return ca.dot(vector, moved[:, node])

    # Lengths

    def _length_power(self, rod: str) -> Matrix:
        """Power, 1×1, W, of the drive that changes a rod's length, on the motion by the change of length alone."""
        igm = self.system.rods[rod]
        rates = self.system.strain_rates(rod)
        assert rates.ratio_rate is not None, "asked for where the length is free"
        still = ca.DM(igm.rod.size, 1)
        alone = StrainRates(still, still, rates.ratio_rate, ca.DM(1, 1))
        motion = RodMotion(self.system.shapes[rod], alone, AT_REST)
        powers = [self._by_inputs(igm.energy)]
        powers += [-self._wrench_power(motion, wrench) for wrench in igm.statics.wrenches]
        for effort, conjugate in igm.efforts:
            powers.append(effort * conjugate.rate(self._by_inputs))
        viscosity = self.system.viscosities.get(rod)
        if viscosity is not None:
            powers.append(viscosity.shrinking_power)
        relaxation = self.system.relaxations.get(rod)
        if relaxation is not None:
            powers.append(relaxation.lengthening_power)
        masses = masses_along(igm.rod)
        if masses is not None:
            # The material that joins has the speed of its section already; masses fixed to the rod do not grow.
            inertia = RodInertia(self.system.motions[rod], masses)
            powers.append(inertia.kinetic_energy / inertia.ratio * rates.ratio_rate)
        return _sum(powers)


def _is_damped(load: scenes.LoadRecord) -> bool:
    """Whether a load dissipates energy in motion."""
    return isinstance(load, ContactLayer) and load.takes_energy


def _sum(terms: list[Matrix]) -> Matrix:
    """Sum of 1×1 terms; zero without any."""
    total: Matrix = ca.DM(0.0)
    for term in terms:
        total = total + term
    return total
