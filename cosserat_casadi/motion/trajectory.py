"""The result of a simulation: the motion of a scene, with its poses, energies and figures of merit."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from cosserat_casadi.equilibrium.rubbing import RubbingStretch, rubbing_stretches
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.checkpoint import Checkpoint
from cosserat_casadi.motion.contact_record import MotionContact
from cosserat_casadi.motion.event_restart import ContactEvent
from cosserat_casadi.motion.pose_series import ActuatorStates, Poses, poses_of, section_poses, states_of
from cosserat_casadi.numerics.outcome import LabelledOutcome
from cosserat_casadi.result import Result


class MotionOutcome(LabelledOutcome):
    """Every way a simulation can end; the value is the sentence that a user reads. Only COMPLETED is the whole motion.

    New members come last.
    """

    COMPLETED = "Motion computed to its end."
    STEP_TOO_SMALL = (
        "The motion ended early: no step was small enough to go on. A load may jump, or the equations may have no "
        "solution beyond this time."
    )
    UNRESOLVED = (
        "A motion of the discrete model was computed, but the rod is not resolved by its modes and nodes: allow more "
        "of them, or a larger tolerance."
    )
    SINGULAR_CONSTRAINT = (
        "The motion ended early: the constraints became dependent on each other, as in a loop that is stretched out."
    )
    NOT_FINITE = "The motion ended early: the equations gave a value that is not a finite number."
    INTERRUPTED = "The motion ended early: it was interrupted."
    NO_START = "No motion was computed: no state to start from was found."
    NOT_SOLVED = "The motion ended early: a step of the given size could not be solved; give a smaller one, or none."
    SNAPPED = (
        "The motion ended early: a cable became taut and slack, or a joint hit a stop, over and over, or no motion "
        "was possible: damp the rod, or move more slowly."
    )
    TOO_MANY_STEPS = (
        "The motion ended early: the rest would take hundreds of thousands of steps. A load may be far too large for "
        "the rod, or the tolerance too tight for its vibrations; damp the rod."
    )
    CONTACT_UNSETTLED = "The motion ended early: contact did not settle."
    PATH_VANISHED = (
        "A motion of the discrete model was computed, but the rod bends so far that the path of a tendon has no "
        "length left in it: lessen the loads, or move the path nearer to the axis."
    )
    BEYOND_MATERIAL = (
        "A motion of the discrete model was computed, but on its way a strain, or the pressure in a chamber, is beyond "
        "where its law holds: lessen the loads, or give the law for larger ones."
    )
    OUT_OF_PLANE = (
        "A motion of the discrete model was computed, but on its way a joint or a support is out of the plane that its "
        "rods bend in: keep it in the plane, or admit the other bending and torsion of the rods."
    )


@dataclass(frozen=True)
class MotionProgress:
    """Progress of a simulation.

    Attributes:
        stage: the work under way, such as "simulating".
        time: time reached, s.
        duration: time to be reached, s.
        step: size of the present time step, s.
    """

    stage: str
    time: float
    duration: float
    step: float

    @property
    def share(self) -> float:
        """Share of the duration that is reached, 0 to 1."""
        return self.time / self.duration


@dataclass(frozen=True)
class MotionState:
    """The state of a scene at one time.

    Attributes:
        x: unknowns, shape (model.size,).
        v: rates of the unknowns, shape (model.size,), 1/s.
        a: second time derivatives of the unknowns, shape (model.size,), 1/s².
        inputs: stacked inputs, shape (model.inputs.size,).
    """

    x: FloatArray
    v: FloatArray
    a: FloatArray
    inputs: FloatArray


@dataclass(frozen=True)
class Energies:
    """Energies of a scene at T times, each of shape (T,), J.

    Attributes:
        kinetic: kinetic energy of rods and bodies.
        elastic: elastic energy of the rods.
        potential: potential energy of dead forces, gravity and smooth contact.
        dissipated: energy dissipated since the start by damping of rods and of smooth contact, and by friction.
        work: work since the start of all other loads, of actuators, and of moving bases and lengths.
        impacts: energy lost since the start as cables snapped taut, joints met stops, or rods met rigid obstacles.
        imbalance: error of the balance of the other six, over the largest energy, dimensionless.
    """

    kinetic: FloatArray
    elastic: FloatArray
    potential: FloatArray
    dissipated: FloatArray
    work: FloatArray
    impacts: FloatArray
    imbalance: FloatArray


Account = tuple[Energies, Checkpoint | None]
"""Energies at the times of a motion, and its end, from which another continues; None if it was not started."""


@dataclass(frozen=True)
class StepStatistics:
    """Numbers and sizes of the time steps of a motion.

    Attributes:
        steps: number of accepted steps.
        rejected: number of steps that were tried again with a smaller size.
        iterations: Newton iterations of all steps together.
        jacobians: evaluations of the Jacobian.
        smallest_step: size of the smallest accepted step, s; nan without steps.
        largest_step: size of the largest accepted step, s; nan without steps.
    """

    steps: int
    rejected: int
    iterations: int
    jacobians: int
    smallest_step: float
    largest_step: float


@dataclass(frozen=True, repr=False)
class Motion(Result):
    """The result of a simulation; it is the whole motion only if ``converged`` is true.

    Attributes:
        model: the model that was simulated.
        outcome: how the simulation ended.
        message: a sentence for the user.
        times: times of the rows, shape (T,), s.
        x: unknowns, shape (T, model.size).
        v: rates of the unknowns, shape (T, model.size), 1/s; without meaning for multipliers and tensions.
        a: second derivatives of the unknowns, shape (T, model.size), 1/s².
        inputs: stacked inputs, shape (T, model.inputs.size).
        error_estimate: estimated error of the paths of tips, bases that move and bodies, and of sections between held
            ends, relative to the rods' lengths, by space and time together; nan if it was not estimated.
        statistics: numbers and sizes of the time steps.
        start: a sentence on the start of the motion.
        interpolant: function of a time within the motion ↦ state, by the dense output of the steps.
        warnings: sentences on what limits the accuracy, such as a load that jumps.
        contacts: the sections that touch obstacles without a width at each of the times; empty without any.
        events: impacts and other changes of contact, and changes of cables that go slack, in order of time.
        account: function that computes the energies and the end on demand, as that takes time.
        impacts_spread: difference of the energy lost in impacts since the start from that on the other modes and with
            the other steps by which the error was estimated, J; nan without others.
        tolerance: requested error of the paths, relative to the rods' lengths; None if no tolerance was requested, and
            if the error is that of the time steps alone.
    """

    model: Model
    outcome: MotionOutcome
    message: str
    times: FloatArray
    x: FloatArray
    v: FloatArray
    a: FloatArray
    inputs: FloatArray
    error_estimate: float
    statistics: StepStatistics
    start: str
    interpolant: Callable[[float], MotionState]
    account: Callable[[], Account]
    warnings: tuple[str, ...] = ()
    contacts: tuple[tuple[MotionContact, ...], ...] = ()
    events: tuple[ContactEvent, ...] = ()
    impacts_spread: float = float("nan")
    tolerance: float | None = None

    @property
    def energy(self) -> Energies:
        """Energies at the times, and the balance between them."""
        return self._account[0]

    @property
    def end(self) -> Checkpoint | None:
        """Checkpoint at the end of the motion, from which another can continue; None if it was not started."""
        return self._account[1]

    @cached_property
    def _account(self) -> Account:
        return self.account()

    @property
    def converged(self) -> bool:
        """Whether the motion was computed to its end, as requested."""
        return self.outcome is MotionOutcome.COMPLETED

    @property
    def within_tolerance(self) -> bool | None:
        """Whether the estimated error is within the tolerance; None if there is no meaningful tolerance.

        A motion that did not converge is not within any tolerance.
        """
        if self.tolerance is None:
            return None
        # Written so that an estimate which is not a number counts as too large.
        return self.converged and self.error_estimate <= self.tolerance

    def tip(self, rod: str | None = None) -> Poses:
        """Poses of a rod's tip, shapes (T, 3) and (T, 4); the name may be left out if there is one rod.

        Raises:
            KeyError: there is no such rod, or there are several to choose from.
        """
        return poses_of(self.model.tip[self.model.rod_name(rod)], self.x, self.inputs)

    def section(self, rod: str | None, X: npt.ArrayLike) -> Poses:
        """Poses of a rod's sections at abscissae X in [0, 1], shapes (T, k, 3) and (T, k, 4), or (T, 3) and (T, 4).

        Args:
            rod: name of the rod; None stands for the only one.
            X: one abscissa, or an array of shape (k,).

        Raises:
            KeyError: there is no such rod, or there are several to choose from.
        """
        name = self.model.rod_name(rod)
        return section_poses(self.model, name, X, self.x, self.inputs)

    def body(self, name: str) -> Poses:
        """Poses of a rigid body, shapes (T, 3) and (T, 4).

        Raises:
            KeyError: there is no such body.
        """
        if name not in self.model.body:
            raise KeyError(_unknown(name, "a body", "bodies", list(self.model.body)))
        return poses_of(self.model.body[name], self.x, self.inputs)

    def actuator(self, name: str) -> ActuatorStates:
        """Tension (N) and length (m) of a tendon, or pressure (Pa) and volume (m³) of a chamber, each of shape (T,).

        Raises:
            KeyError: there is no such actuator.
        """
        if name not in self.model.actuator:
            raise KeyError(_unknown(name, "an actuator", "actuators", list(self.model.actuator)))
        return states_of(self.model.actuator[name], self.x, self.inputs)

    def joint(self, name: str) -> ActuatorStates:
        """Moment (N m) or force (N) along a joint on its section, and its angle (rad) or displacement (m), each (T,).

        Raises:
            KeyError: no joint of that name has a spring, a damper, a motor or a drive.
        """
        if name not in self.model.joint:
            raise KeyError(_unknown(name, "a joint with a coordinate", "joints", list(self.model.joint)))
        return states_of(self.model.joint[name], self.x, self.inputs)

    def rubbing(self, index: int) -> tuple[RubbingStretch, ...]:
        """Stretches of rods that stick or slip on obstacles at a row; empty in a scene without friction.

        A section that creeps slower than the slip speed sticks.
        """
        if self.model.slips is None:
            return ()
        # A motion keeps inputs without their rates.
        rates = np.gradient(self.inputs, self.times, axis=0) if len(self.times) > 1 else np.zeros_like(self.inputs)
        slip = self.model.slips(self.x[index], self.v[index], self.inputs[index], rates[index])
        return rubbing_stretches(self.model, slip.full()[0])

    def at(self, time: float) -> MotionState:
        """The state at any time of the motion, by the dense output of the steps.

        Raises:
            ValueError: the motion does not reach this time.
        """
        if len(self.times) == 0:
            raise ValueError("the motion has no state: it did not start")
        first = float(self.times[0])
        last = float(self.times[-1])
        # A nan compares as false with both ends, and is refused too.
        if not first <= time <= last:
            raise ValueError(f"the motion goes from {first:g} s to {last:g} s, which does not hold {time:g} s")
        return self.interpolant(time)


def _unknown(name: str, kind: str, plural: str, names: list[str]) -> str:
    return f"{name!r} is not {kind} of this scene; its {plural} are {', '.join(names) or 'none'}"
