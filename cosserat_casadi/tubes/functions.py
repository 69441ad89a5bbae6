"""Functions that models of concentric tubes share: what follows from the state along the robot.

A model says what is unknown at the tip and how the state is integrated from there to the base plate; see `tubes.model`
and `tubes.loaded_model`.
"""

from __future__ import annotations

import itertools
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import casadi as ca

from cosserat_casadi.maths.pose import Pose
from cosserat_casadi.maths.rotation import quaternion_conjugate, quaternion_product
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.tubes.robot import Robot
from cosserat_casadi.tubes.variations import Variations

NEWTON_TOLERANCE = 1e-12
"""Angle missed, rad, at which the steps of `equilibrium` end."""

NEWTON_STEPS = 30
"""Most steps of `equilibrium`."""


class AnyState(Protocol):
    """What every state along a robot has: angles and torques of the tubes, pose of the frame, energy."""

    @property
    def angles(self) -> Matrix:
        """Of the tubes against the frame, n×1, rad."""

    @property
    def torques(self) -> Matrix:
        """In the tubes, n×1, N m."""

    @property
    def pose(self) -> Pose:
        """Of the frame."""

    @property
    def energy(self) -> Matrix:
        """From the tip on, 1×1, J."""


@dataclass(frozen=True)
class March:
    """A robot, integrated from its tip to the base plate.

    Attributes:
        ends: stacked states at the ends of the pieces.
        stations: stacked states at all ends of steps from the tip to the plate, a column each.
    """

    ends: list[Matrix]
    stations: Matrix


class TubeFunctions(ABC):
    """A robot of concentric tubes with a number of steps.

    Functions take the unknowns x, of which the first n are the angles at the tips of the tubes, the inputs (rotation
    and translation of each tube, then those of the loads), and the load factor, on all curvatures, which is 1 but on
    the way from straight tubes.

    Attributes:
        robot: the tubes.
        steps: steps of each of the 2 n pieces that the robot has between places where a tube begins to bend, or ends.
    """

    def __init__(self, robot: Robot, steps: int) -> None:
        self.robot = robot
        self.steps = steps

    @property
    def size(self) -> int:
        """Number of tubes."""
        return self.robot.size

    # What a model says

    @property
    @abstractmethod
    def unknowns(self) -> int:
        """Number of unknowns."""

    @abstractmethod
    def varied(self, x: FloatArray, inputs: FloatArray) -> Variations:
        """How the configuration changes along the robot; where loads act, all of them have an energy."""

    @property
    @abstractmethod
    def _residual(self) -> Matrix:
        """What is zero in equilibrium, as many as the unknowns."""

    @property
    def _jacobian(self) -> Matrix:
        """Derivative of the residual with x, square."""
        x, _, _ = self._arguments
        return ca.jacobian(self._residual, x)

    @property
    @abstractmethod
    def _whole(self) -> March:
        """States with the frame of the centre line and the energy."""

    @abstractmethod
    def _state(self, stacked: Matrix) -> AnyState:
        """The state of stacked entries of `_whole`."""

    # What is asked of the model

    @cached_property
    def residual(self) -> ca.Function:
        """(x, inputs, load_factor) ↦ what is zero in equilibrium: see the model; angles in rad."""
        return self._function("residual", {"residual": self._residual})

    @cached_property
    def jacobian(self) -> ca.Function:
        """(x, inputs, load_factor) ↦ derivative of the residual with x, square, and the residual."""
        return self._function("jacobian", {"jacobian": self._jacobian, "residual": self._residual})

    @cached_property
    def input_jacobian(self) -> ca.Function:
        """(x, inputs, load_factor) ↦ derivative of the residual with the inputs, a column each."""
        _, inputs, _ = self._arguments
        return self._function("input_jacobian", {"input_jacobian": ca.jacobian(self._residual, inputs)})

    @cached_property
    def input_rate(self) -> ca.Function:
        """(x, inputs, load_factor, change) ↦ change of the residual with a change of the inputs, a column."""
        _, inputs, _ = self._arguments
        change = ca.MX.sym("change", inputs.size1())
        rate = ca.jtimes(self._residual, inputs, change)
        names = ["x", "inputs", "load_factor", "change"]
        return ca.Function("input_rate", [*self._arguments, change], [rate], names, ["input_rate"])

    @cached_property
    def load_rate(self) -> ca.Function:
        """(x, inputs, load_factor) ↦ derivative of the residual with the load factor, a column."""
        _, _, load_factor = self._arguments
        return self._function("load_rate", {"load_rate": ca.jacobian(self._residual, load_factor)})

    @cached_property
    def equilibrium(self) -> ca.Function:
        """(start, inputs) ↦ unknowns, by Newton's method, and the sum of angles missed, 1×1, rad.

        It is an expression like any other: CasADi differentiates it exactly, by the implicit function theorem, and
        writes it in C. Full steps from the start, at most NEWTON_STEPS. Where the angle missed is not small, or no
        number, nothing was found: whoever calls it has to look.
        """
        x, inputs, _ = self._arguments
        missed = ca.Function("missed", [x, inputs], [self.residual(x, inputs, 1.0)])
        options = {"abstol": NEWTON_TOLERANCE, "max_iter": NEWTON_STEPS}
        found = ca.rootfinder("newton", "fast_newton", missed, options)(x, inputs)
        return ca.Function(
            "equilibrium",
            [x, inputs],
            [found, ca.sum1(ca.fabs(missed(found, inputs)))],
            ["start", "inputs"],
            ["x", "missed"],
        )

    @cached_property
    def energy(self) -> ca.Function:
        """(x, inputs, load_factor) ↦ elastic energy of what stands out, and of torsion in the housing, J.

        Less the work of the loads, where all of them have an energy: see :attr:`Robot.has_energy`.
        """
        last = self._state(self._whole.ends[-1])
        twisting = ca.sum1(last.torques**2 * self._compliance) / 2
        # Integrated towards the base, lengths are negative.
        return self._function("energy", {"energy": twisting - last.energy})

    @cached_property
    def tips(self) -> ca.Function:
        """(x, inputs, load_factor) ↦ positions, 3×n, m, and quaternions, 4×n, of the tubes' tips, in base axes."""
        position = ca.horzcat(*[tip.position for tip in self._tips])
        quaternion = ca.horzcat(*[tip.quaternion for tip in self._tips])
        return self._function("tips", {"position": position, "quaternion": quaternion})

    @cached_property
    def tip_jacobian(self) -> ca.Function:
        """(x, inputs, load_factor) ↦ derivatives of the poses of all tips with the inputs in equilibrium, 6 n rows.

        Six rows a tube, angular first: its turn [δθ; δr] in base axes, in rad and m, per unit of the input. Unknowns
        follow the inputs, δx = −(∂g/∂x)⁻¹ ∂g/∂inputs δinputs; it is not finite where the robot snaps.
        """
        x, inputs, _ = self._arguments
        following = -ca.solve(ca.jacobian(self._residual, x), ca.jacobian(self._residual, inputs))
        tips = ca.vertcat(*[ca.vertcat(tip.position, tip.quaternion) for tip in self._tips])
        changes = ca.jacobian(tips, inputs) + ca.jacobian(tips, x) @ following
        rows: list[Matrix] = []
        for tip, change in zip(self._tips, ca.vertsplit(changes, 7), strict=True):
            back = quaternion_conjugate(tip.quaternion)
            # δQ = ½ (0, δθ) ⊗ Q.
            turns = [2 * quaternion_product(column, back)[1:] for column in ca.horzsplit(change[3:, :])]
            rows += [ca.horzcat(*turns), change[:3, :]]
        return self._function("tip_jacobian", {"tip_jacobian": ca.vertcat(*rows)})

    @cached_property
    def stations(self) -> ca.Function:
        """(x, inputs, load_factor) ↦ the robot at all ends of steps from the plate to its tip, a column each.

        Distances from the plate along the centre line, 1×k, m; positions, 3×k, m, and quaternions, 4×k, of the frame
        that does not turn about the centre line, in base axes; angles of the tubes against it, n×k, rad; torques in
        the tubes, n×k, N m.
        """
        columns = [self._state(column) for column in reversed(ca.horzsplit(self._whole.stations))]
        poses = [self._in_base(column.pose) for column in columns]
        outputs = {
            "distance": ca.horzcat(0, ca.cumsum(-_reversed(self._lengths), 1)),
            "position": ca.horzcat(*[pose.position for pose in poses]),
            "quaternion": ca.horzcat(*[pose.quaternion for pose in poses]),
            "angles": ca.horzcat(*[column.angles for column in columns]),
            "torques": ca.horzcat(*[column.torques for column in columns]),
        }
        return self._function("stations", outputs)

    # Where it has which section

    @cached_property
    def _arguments(self) -> tuple[ca.MX, ca.MX, ca.MX]:
        """Unknowns, inputs and load factor, of which all functions are."""
        return ca.MX.sym("x", self.unknowns), ca.MX.sym("inputs", self.robot.inputs.size), ca.MX.sym("load_factor")

    @cached_property
    def _lengths(self) -> ca.MX:
        """Lengths of all steps from the tip on, 1×(2 n steps), negative, m."""
        lengths = []
        for start, end in itertools.pairwise(self._places):
            lengths.append(ca.repmat((end - start) / self.steps, 1, self.steps))
        return ca.horzcat(*lengths)

    @cached_property
    def _sections(self) -> Matrix:
        """Stacked section of every step, (2 n + 2)×(2 n steps)."""
        sections = []
        for start, end in itertools.pairwise(self._places):
            sections.append(ca.repmat(self._section((start + end) / 2), 1, self.steps))
        return ca.horzcat(*sections)

    @cached_property
    def _places(self) -> list[ca.MX]:
        """Where tubes end and where they begin to bend, from the tip of the robot to the plate, then the plate.

        The order is found as the function is evaluated: inputs may change it, and pieces between places that coincide,
        or lie in the housing, have no length.
        """
        places: list[ca.MX] = []
        for tip, bend in self._ends:
            places += [tip, bend]
        # Exchanging neighbours sorts whatever the values are, without a branch.
        for passed in range(len(places)):
            for index in range(len(places) - 1 - passed):
                first, second = places[index], places[index + 1]
                places[index] = ca.fmax(first, second)
                places[index + 1] = ca.fmin(first, second)
        return [*places, ca.MX(0.0)]

    @cached_property
    def _ends(self) -> list[tuple[ca.MX, ca.MX]]:
        """Of every tube how far its tip, and the beginning of its curved part, stand out of the plate, m."""
        _, inputs, _ = self._arguments
        ends = []
        for index in range(self.size):
            tip = inputs[2 * index + 1]
            bend = ca.fmax(tip - self.robot.curved[index], 0.0)
            ends.append((tip, bend))
        return ends

    def _section(self, place: ca.MX) -> Matrix:
        """Stacked section at a place: torsion, moments, bending and own energy of the tubes there, (2 n + 2)×1."""
        robot = self.robot
        _, _, load_factor = self._arguments
        moments = []
        bending: Matrix = ca.MX(0.0)
        own: Matrix = ca.MX(0.0)
        for index, (tip, bend) in enumerate(self._ends):
            stiffness = float(robot.bending[index])
            curvature = load_factor * float(robot.curvature[index])
            is_here = ca.if_else(place < tip, 1.0, 0.0)
            is_curved = is_here * ca.if_else(place > bend, 1.0, 0.0)
            moments.append(is_curved * stiffness * curvature)
            bending = bending + is_here * stiffness
            own = own + is_curved * stiffness * curvature**2 / 2
        # A piece without length may have no tube; dividing by its stiffness must do no harm.
        stiffness_or_one = bending + ca.if_else(bending > 0.0, 0.0, 1.0)
        return ca.vertcat(robot.torsion, *moments, stiffness_or_one, own)

    # What follows from it

    @property
    def _compliance(self) -> ca.MX:
        """Angle that a torque of one turns the drive end of every tube against the plate, n×1, rad/(N m)."""
        _, inputs, _ = self._arguments
        inside = ca.DM(self.robot.length) - self.robot.translations(inputs)
        return inside / ca.DM(self.robot.torsion)

    def _in_base(self, pose: Pose) -> Pose:
        """A pose in base axes, where it is given in those of the tip's frame."""
        return self._state(self._whole.ends[-1]).pose.seen(pose)

    @cached_property
    def _tips(self) -> list[Pose]:
        """Pose of every tube's tip in base axes; its x axis is the direction that the tube would bend towards."""
        x, _, _ = self._arguments
        ends = self._whole.ends
        tips = []
        for index, (tip, _) in enumerate(self._ends):
            state = ends[-1]
            # From the plate outwards, the place of the tip is the last that is not beyond it.
            for place, there in zip(self._places[-2::-1], ends[-2::-1], strict=True):
                state = ca.if_else(place <= tip, there, state)
            reached = self._state(state)
            half = x[index] / 2
            turn = Pose(ca.DM.zeros(3), ca.vertcat(ca.cos(half), 0, 0, ca.sin(half)))
            tips.append(self._in_base(reached.pose).then(turn))
        return tips

    def _function(self, name: str, outputs: Mapping[str, Matrix]) -> ca.Function:
        """A function of unknowns, inputs and load factor."""
        return ca.Function(
            name,
            [*self._arguments],
            list(outputs.values()),
            ["x", "inputs", "load_factor"],
            list(outputs),
        )


def _reversed(row: ca.MX) -> ca.MX:
    """A row from its end to its start."""
    return ca.horzcat(*reversed(ca.horzsplit(row)))
