"""The model of concentric tubes: named CasADi functions of the angles at their tips and of the joints.

Every tube's tip bears no torque. So the angles there, the unknowns x, determine the whole robot: it is integrated from
the tips to the base plate, and through the housing to the drives, where the angles must be the rotations of the joints.
That is one small equation a tube. See docs/tubes.md.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from cosserat_casadi.maths.pose import Pose
from cosserat_casadi.maths.rotation import quaternion_conjugate, quaternion_product
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.tubes.flow import Section, State
from cosserat_casadi.tubes.robot import Robot


@dataclass(frozen=True)
class _March:
    """A robot, integrated from its tip to the base plate.

    Attributes:
        x: angles at the tips, n×1, rad.
        joints: rotation and translation of each tube, (2 n)×1, rad and m.
        load_factor: factor on all curvatures, 1×1.
        places: ends of the pieces from the tip to the plate, m.
        states: stacked states at the ends of the pieces.
        stations: stacked states at all ends of steps from the tip to the plate, a column each.
        lengths: of the steps, 1×steps, negative, m.
        sections: arguments of every step: moments, bending and own energy, a column each.
    """

    x: ca.MX
    joints: ca.MX
    load_factor: ca.MX
    places: list[ca.MX]
    states: list[ca.MX]
    stations: ca.MX
    lengths: ca.MX
    sections: Matrix


class TubeModel:
    """A robot of concentric tubes with a number of steps.

    Functions take the angles x at the tips of the tubes (n), the joints (2 n: rotation and translation of each tube),
    and the load factor, on all curvatures, which is 1 but on the way from straight tubes.

    Attributes:
        robot: the tubes.
        steps: steps of each of the 2 n pieces that the robot has between places where a tube begins to bend, or ends.
    """

    def __init__(self, robot: Robot, steps: int) -> None:
        self.robot = robot
        self.steps = steps

    @property
    def size(self) -> int:
        """Number of unknowns: one a tube."""
        return self.robot.size

    # What is asked of the model

    @cached_property
    def residual(self) -> ca.Function:
        """(x, joints, load_factor) ↦ angles at the drives less the rotations of the joints, n×1, rad."""
        return self._function("residual", {"residual": self._residual})

    @cached_property
    def jacobian(self) -> ca.Function:
        """(x, joints, load_factor) ↦ derivative of the residual with x, n×n, and the residual."""
        jacobian = ca.jacobian(self._residual, self._march.x)
        return self._function("jacobian", {"jacobian": jacobian, "residual": self._residual})

    @cached_property
    def rates(self) -> ca.Function:
        """(x, joints, load_factor) ↦ derivatives of the residual with the joints, n×2n, and the load factor, n×1."""
        march = self._march
        outputs = {
            "joint_jacobian": ca.jacobian(self._residual, march.joints),
            "load_rate": ca.jacobian(self._residual, march.load_factor),
        }
        return self._function("rates", outputs)

    @cached_property
    def energy(self) -> ca.Function:
        """(x, joints, load_factor) ↦ elastic energy of what stands out, and of torsion in the housing, J."""
        march = self._march
        last = State.of(march.states[-1])
        twisting = ca.sum1(last.torques**2 * self._compliance) / 2
        # Integrated towards the base, lengths are negative.
        return self._function("energy", {"energy": twisting - last.energy})

    @cached_property
    def tips(self) -> ca.Function:
        """(x, joints, load_factor) ↦ positions, 3×n, m, and quaternions, 4×n, of the tubes' tips, in base axes."""
        tips = self._tips
        position = ca.horzcat(*[tip.position for tip in tips])
        quaternion = ca.horzcat(*[tip.quaternion for tip in tips])
        return self._function("tips", {"position": position, "quaternion": quaternion})

    @cached_property
    def tip_jacobian(self) -> ca.Function:
        """(x, joints, load_factor) ↦ derivatives of the poses of all tips with the joints in equilibrium, (6 n)×(2 n).

        Six rows a tube, angular first: its turn [δθ; δr] in base axes, in rad and m, per rad and per m. The unknowns
        follow the joints, δx = −(∂g/∂x)⁻¹ ∂g/∂joints δjoints; it is not finite where the robot snaps.
        """
        march = self._march
        jacobian = ca.jacobian(self._residual, march.x)
        following = -ca.solve(jacobian, ca.jacobian(self._residual, march.joints))
        rows = [self._motion(tip, following) for tip in self._tips]
        return self._function("tip_jacobian", {"tip_jacobian": ca.vertcat(*rows)})

    @cached_property
    def stations(self) -> ca.Function:
        """(x, joints, load_factor) ↦ the robot at all ends of steps from the plate to its tip, a column each.

        Distances from the plate along the centre line, 1×k, m; positions, 3×k, m, and quaternions, 4×k, of the frame
        that does not turn about the centre line, in base axes; angles of the tubes against it, n×k, rad; torques in
        the tubes, n×k, N m.
        """
        march = self._march
        columns = [State.of(column) for column in reversed(ca.horzsplit(march.stations))]
        poses = [self._in_base(column.pose) for column in columns]
        outputs = {
            "distance": ca.horzcat(0, ca.cumsum(-_reversed(march.lengths), 1)),
            "position": ca.horzcat(*[pose.position for pose in poses]),
            "quaternion": ca.horzcat(*[pose.quaternion for pose in poses]),
            "angles": ca.horzcat(*[column.angles for column in columns]),
            "torques": ca.horzcat(*[column.torques for column in columns]),
        }
        return self._function("stations", outputs)

    @cached_property
    def variations(self) -> ca.Function:
        """(x, joints, load_factor) ↦ how the angles and torques at all ends of steps change.

        With the angles at the tips, (2 n k)×n, column after column of the stations from the tip to the plate; and, for
        each step, the angles at its end with the torques at its start, n×(n (k − 1)).
        """
        march = self._march
        size = self.size
        angles_and_torques = march.stations[: 2 * size, :]
        state = ca.MX.sym("state", 2 * size + 8)
        length = ca.MX.sym("length")
        section = ca.MX.sym("section", size + 2)
        after = self._step(state, length, section)
        from_torques = ca.jacobian(after[:size], state)[:, size : 2 * size]
        each = ca.Function("each", [state, length, section], [from_torques]).map(march.lengths.size2())
        outputs = {
            "along": ca.jacobian(ca.vec(angles_and_torques), march.x),
            "of_steps": each(march.stations[:, :-1], march.lengths, march.sections),
        }
        return self._function("variations", outputs)

    # How it is integrated

    @cached_property
    def _step(self) -> ca.Function:
        """(state, length, section) ↦ state: one step, of scalar operations."""
        size = self.size
        state = ca.SX.sym("state", 2 * size + 8)
        length = ca.SX.sym("length")
        arguments = ca.SX.sym("section", size + 2)
        section = Section(
            torsion=self.robot.torsion,
            moments=arguments[:size],
            bending=arguments[size],
            own=arguments[size + 1],
        )
        after = section.step(State.of(state), length)
        return ca.Function("step", [state, length, arguments], [after.stacked])

    @cached_property
    def _march(self) -> _March:
        size = self.size
        x = ca.MX.sym("x", size)
        joints = ca.MX.sym("joints", 2 * size)
        load_factor = ca.MX.sym("load_factor")
        places = self._places(joints)
        state = ca.vertcat(x, ca.DM.zeros(size + 3), 1, ca.DM.zeros(4))
        steps = self._step.mapaccum("steps", self.steps)
        states = [state]
        stations = [state]
        lengths = []
        sections = []
        for start, end in itertools.pairwise(places):
            length = ca.repmat((end - start) / self.steps, 1, self.steps)
            section = ca.repmat(self._section((start + end) / 2, joints, load_factor), 1, self.steps)
            passed = steps(states[-1], length, section)
            states.append(passed[:, -1])
            stations.append(passed)
            lengths.append(length)
            sections.append(section)
        return _March(
            x=x,
            joints=joints,
            load_factor=load_factor,
            places=places,
            states=states,
            stations=ca.horzcat(*stations),
            lengths=ca.horzcat(*lengths),
            sections=ca.horzcat(*sections),
        )

    def _places(self, joints: ca.MX) -> list[ca.MX]:
        """Where tubes end and where they begin to bend, from the tip of the robot to the plate, then the plate.

        The order is found as the function is evaluated: joints may change it, and pieces between places that coincide,
        or lie in the housing, have no length.
        """
        places: list[ca.MX] = []
        for tip, bend in self._ends(joints):
            places += [tip, bend]
        # Exchanging neighbours sorts whatever the values are, without a branch.
        for passed in range(len(places)):
            for index in range(len(places) - 1 - passed):
                first, second = places[index], places[index + 1]
                places[index] = ca.fmax(first, second)
                places[index + 1] = ca.fmin(first, second)
        return [*places, ca.MX(0.0)]

    def _ends(self, joints: ca.MX) -> list[tuple[ca.MX, ca.MX]]:
        """Of every tube how far its tip, and the beginning of its curved part, stand out of the plate, m."""
        ends = []
        for index in range(self.size):
            tip = joints[2 * index + 1]
            bend = ca.fmax(tip - self.robot.curved[index], 0.0)
            ends.append((tip, bend))
        return ends

    def _section(self, place: ca.MX, joints: ca.MX, load_factor: ca.MX) -> Matrix:
        """Moments, bending stiffness and own energy of the tubes that are at a place, (n + 2)×1."""
        robot = self.robot
        moments = []
        bending: Matrix = ca.MX(0.0)
        own: Matrix = ca.MX(0.0)
        for index, (tip, bend) in enumerate(self._ends(joints)):
            stiffness = float(robot.bending[index])
            curvature = load_factor * float(robot.curvature[index])
            is_here = ca.if_else(place < tip, 1.0, 0.0)
            is_curved = is_here * ca.if_else(place > bend, 1.0, 0.0)
            moments.append(is_curved * stiffness * curvature)
            bending = bending + is_here * stiffness
            own = own + is_curved * stiffness * curvature**2 / 2
        # A piece without length may have no tube; dividing by its stiffness must do no harm.
        stiffness_or_one = bending + ca.if_else(bending > 0.0, 0.0, 1.0)
        return ca.vertcat(*moments, stiffness_or_one, own)

    # What follows from it

    @property
    def _compliance(self) -> ca.MX:
        """Angle that a torque of one turns the drive end of every tube against the plate, n×1, rad/(N m)."""
        inside = ca.DM(self.robot.length) - self._march.joints[1::2]
        return inside / ca.DM(self.robot.torsion)

    @cached_property
    def _residual(self) -> ca.MX:
        """Angles at the drives less the rotations of the joints, n×1."""
        last = State.of(self._march.states[-1])
        at_drives = last.angles - self._compliance * last.torques
        return at_drives - self._march.joints[::2]

    def _in_base(self, pose: Pose) -> Pose:
        """A pose in base axes, where it is given in those of the tip's frame."""
        return State.of(self._march.states[-1]).pose.seen(pose)

    @cached_property
    def _tips(self) -> list[Pose]:
        """Pose of every tube's tip in base axes; its x axis is the direction that the tube would bend towards."""
        march = self._march
        tips = []
        for index, (tip, _) in enumerate(self._ends(march.joints)):
            state = march.states[-1]
            # From the plate outwards, the place of the tip is the last that is not beyond it.
            for place, there in zip(march.places[-2::-1], march.states[-2::-1], strict=True):
                state = ca.if_else(place <= tip, there, state)
            reached = State.of(state)
            half = march.x[index] / 2
            turn = Pose(ca.DM.zeros(3), ca.vertcat(ca.cos(half), 0, 0, ca.sin(half)))
            tips.append(self._in_base(reached.pose).then(turn))
        return tips

    def _motion(self, tip: Pose, following: ca.MX) -> Matrix:
        """How a tip moves with the joints, angular first, 6×2n.

        Args:
            tip: its pose.
            following: how the unknowns change with the joints, n×2n.
        """
        march = self._march
        position = ca.jacobian(tip.position, march.joints) + ca.jacobian(tip.position, march.x) @ following
        quaternion = ca.jacobian(tip.quaternion, march.joints) + ca.jacobian(tip.quaternion, march.x) @ following
        back = quaternion_conjugate(tip.quaternion)
        # δQ = ½ (0, δθ) ⊗ Q.
        turns = [2 * quaternion_product(column, back)[1:] for column in ca.horzsplit(quaternion)]
        return ca.vertcat(ca.horzcat(*turns), position)

    def _function(self, name: str, outputs: Mapping[str, Matrix]) -> ca.Function:
        """A function of unknowns, joints and load factor."""
        march = self._march
        return ca.Function(
            name,
            [march.x, march.joints, march.load_factor],
            list(outputs.values()),
            ["x", "joints", "load_factor"],
            list(outputs),
        )


def _reversed(row: ca.MX) -> ca.MX:
    """A row from its end to its start."""
    return ca.horzcat(*reversed(ca.horzsplit(row)))
