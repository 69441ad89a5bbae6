"""Functions shared by the models of concentric tubes, which follow from the state along the robot.

A model (`tubes.tube_model`, `tubes.loaded_model`) defines the unknowns at the tip, and integrates the state from there
to the base plate.
"""

from __future__ import annotations

import itertools
from abc import abstractmethod
from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Self, TypeAlias

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.numbers import as_matrix
from cosserat_casadi.maths.pose import POSE_SIZE, Pose
from cosserat_casadi.maths.rotation import quaternion_conjugate, quaternion_product, quaternion_to_matrix
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.function_table import PARAMETERS
from cosserat_casadi.model.inputs import InputLayout
from cosserat_casadi.model.parameters import ParameterLayout, WithParameters
from cosserat_casadi.result import Shown
from cosserat_casadi.scene import Scene
from cosserat_casadi.tubes.changes import Directions, changing_step, with_changes
from cosserat_casadi.tubes.robot import Robot, Values, robot_of
from cosserat_casadi.tubes.stages import March, Staged
from cosserat_casadi.tubes.tube_flow import FlowState
from cosserat_casadi.tubes.variations import TipVariations

Entered = Callable[[int, Matrix, Matrix], tuple[Matrix, Matrix]]
"""(piece, state, sections) at the start of a piece ↦ state and sections after the loads that act there."""

NEWTON_TOLERANCE = 1e-12
"""Angle by which drives are missed, rad, at which the steps of `equilibrium` end."""

NEWTON_STEPS = 30
"""Most steps of `equilibrium`."""

RESOLVED = 64.0
"""Largest residual of half of the steps, over the tolerance, at which all steps count as enough.

Steps are of order eight: steps of half the length leave 1/256 of it, and the tips err by up to a few times that."""


class TubeFunctions(WithParameters, Shown):
    """A robot of concentric tubes with a number of steps.

    Functions take the unknowns x, of which the first n are the angles at the tips of the tubes, and the inputs, which
    are the rotation and translation of each tube, then the loads; the parameters follow, if the scene names some.
    Functions of a path have the names and arguments of :class:`cosserat_casadi.Model`; the load factor multiplies all
    curvatures, so that tubes are straight at 0.

    Attributes:
        robot: the tubes.
        steps: number of steps of each piece. Pieces are divided at the 2 n places where a tube begins to bend or ends,
            and where forces act beside the tips.
    """

    def __init__(self, robot: Robot, steps: int) -> None:
        self.robot = robot
        self.steps = steps

    def __reduce__(self) -> tuple[type[Self], tuple[Robot, int]]:
        """Rebuild the model in pickled copies, whose functions are written again on demand."""
        return type(self), (self.robot, self.steps)

    @property
    def tube_count(self) -> int:
        """Number of tubes."""
        return self.robot.size

    @property
    def scene(self) -> Scene:
        """Scene of the model."""
        return self.robot.scene

    @property
    def inputs(self) -> InputLayout:
        """Names, order and default values of the inputs."""
        return self.robot.layout

    @property
    def lengths(self) -> dict[str, float]:
        """Length by which the pose error of each tube is divided, m: the length of the longest tube."""
        return dict.fromkeys(self.robot.names, float(self.robot.length.max()))

    @property
    def resolution(self) -> dict[str, int]:
        """Number of steps of each piece, by its name."""
        return {"steps": self.steps}

    @property
    def resolution_words(self) -> list[str]:
        """Steps of each piece, in words."""
        return [f"{self.steps} steps a piece"]

    @property
    def parameters(self) -> ParameterLayout:
        """Names, order and default values of the parameters."""
        return self.robot.parameters

    def _bound(self, values: Mapping[str, npt.ArrayLike] | None) -> Self:
        return type(self)(robot_of(self.parameters.set_in(self.scene, values)), self.steps)

    def pack(self, values: Values = None) -> FloatArray:
        """The stacked inputs, as :meth:`Robot.packed`."""
        return self.robot.packed(values)

    def unloaded(self) -> FloatArray:
        """Unknowns of straight tubes, shape (size,)."""
        frame = [1.0, 0.0, 0.0, 0.0][: self.size - self.tube_count]
        return np.concatenate([self.robot.rotations(self.robot.inputs), frame])

    def has_potential(self, inputs: FloatArray) -> bool:
        """Whether an energy determines which equilibria are stable, for any inputs."""
        return self.robot.has_energy

    # What a model says

    @property
    @abstractmethod
    def size(self) -> int:
        """Number of unknowns."""

    @abstractmethod
    def varied(self, x: FloatArray, inputs: FloatArray) -> TipVariations:
        """Variations of the configuration along the robot, for loads that have an energy."""

    @property
    @abstractmethod
    def _residual(self) -> Matrix:
        """Residual, zero in equilibrium, with as many entries as there are unknowns."""

    @property
    def _jacobian(self) -> Matrix:
        """Derivative of the residual by x, square."""
        x, _, _ = self._arguments
        return ca.jacobian(self._residual, x)

    @property
    @abstractmethod
    def _whole(self) -> March:
        """States with the frame of the centre line and the energy."""

    @abstractmethod
    def _state(self, stacked: Matrix) -> FlowState:
        """Make a state from stacked entries of `_whole`."""

    @property
    @abstractmethod
    def _step(self) -> ca.Function:
        """(state, length, section) ↦ state: a step of such states."""

    @property
    @abstractmethod
    def _staged(self) -> Staged:
        """A step of such states, in its stages."""

    @property
    @abstractmethod
    def _begun(self) -> Matrix:
        """The stacked state at the tip of the robot, followed by the carried numbers, of which there are none yet."""

    @abstractmethod
    def _passing(self, piece: int, stacked: Matrix) -> Matrix:
        """The stacked state and the carried numbers after the start of a piece, where tubes may end."""

    @abstractmethod
    def _missed(self, plate: Matrix) -> Matrix:
        """The residual, from the stacked state at the plate."""

    # What is asked of the model

    @cached_property
    def parametric_scene(self) -> Scene:
        """The scene, in which parameters are entries of their symbol."""
        return self.parameters.written(self.scene, self.parameters.symbol)

    @property
    def shape_unknowns(self) -> npt.NDArray[np.bool_]:
        """Mask of the unknowns that belong to a shape, shape (size,): all."""
        return np.ones(self.size, dtype=bool)

    @property
    def typical_sizes(self) -> tuple[float, float]:
        """Length, m, and energy, N m, of the longest and stiffest tube, bent by about a radian."""
        length = float(self.robot.length.max())
        return length, float(self.robot.bending.max()) / length

    @cached_property
    def halved(self) -> Self:
        """The robot with half of the steps."""
        return type(self)(self.robot, max(self.steps // 2, 1))

    @cached_property
    def resolution_index(self) -> ca.Function:
        """(x, inputs) ↦ residual of half of the steps, over the largest one that is enough; above 1 unresolved."""
        missed = ca.norm_inf(self.halved.residual(*self._symbols.values()))
        return self._function("resolution_index", {"index": missed / (RESOLVED * self.robot.tolerance)})

    @cached_property
    def residual(self) -> ca.Function:
        """(x, inputs) ↦ residual of the model, zero in equilibrium, with angles in rad."""
        return self._function("residual", {"residual": self._residual})

    @cached_property
    def jacobian(self) -> ca.Function:
        """(x, inputs) ↦ derivative of the residual by x, square, and the residual."""
        return self._function("jacobian", {"jacobian": self._jacobian, "residual": self._residual})

    @cached_property
    def input_jacobian(self) -> ca.Function:
        """(x, inputs) ↦ derivative of the residual by the inputs, a column for each."""
        _, inputs, _ = self._arguments
        return self._function("input_jacobian", {"input_jacobian": ca.jacobian(self._residual, inputs)})

    @cached_property
    def parameter_jacobian(self) -> ca.Function:
        """(x, inputs, p) ↦ derivative of the residual by the parameters, a column for each."""
        by_parameters = ca.jacobian(self._residual, self.parameters.symbol)
        return self._function("parameter_jacobian", {"parameter_jacobian": by_parameters})

    @cached_property
    def path_residual(self) -> ca.Function:
        """(x, inputs, load_factor) ↦ residual of tubes with the curvatures of the scene times the factor."""
        return self._on_path("path_residual", {"residual": self._residual})

    @cached_property
    def path_jacobian(self) -> ca.Function:
        """(x, inputs, load_factor) ↦ derivative of that residual by x."""
        return self._on_path("path_jacobian", {"jacobian": self._jacobian})

    @cached_property
    def path_rate(self) -> ca.Function:
        """(x, inputs, load_factor, inputs_rate, load_factor_rate) ↦ rate of that residual at fixed x."""
        _, inputs, load_factor = self._arguments
        rates = {"inputs_rate": ca.MX.sym("inputs_rate", inputs.size1()), "load_factor_rate": ca.MX.sym("rate")}
        rate = ca.jtimes(self._residual, ca.vertcat(inputs, load_factor), ca.vertcat(*rates.values()))
        return self._on_path("path_rate", {"residual_rate": rate}, rates)

    @property
    def step_weights(self) -> FloatArray:
        """Weight of each unknown in the length of a step, equal for angles and numbers of a quaternion."""
        return np.ones(self.size)

    @property
    def is_assembly(self) -> bool:
        """Whether the Jacobian is sparse: it never is."""
        return False

    @property
    def hessian_is_cheap(self) -> bool:
        """Whether an optimiser is faster with exact second derivatives: no, as each integrates all steps."""
        return False

    @cached_property
    def equilibrium(self) -> ca.Function:
        """(start, inputs) ↦ unknowns by Newton's method, and the sum of the angles that drives are missed by, 1×1, rad.

        It is an expression like any other: CasADi differentiates it exactly, by the implicit function theorem, and
        writes it in C. It takes full steps from the start, at most NEWTON_STEPS. If the missed angle is not small, or
        is NaN, no equilibrium was found: the caller has to check it.
        """
        x, *given = self._symbols.values()
        missed = ca.Function("missed", [x, *given], [self.residual(x, *given)])
        options = {"abstol": NEWTON_TOLERANCE, "max_iter": NEWTON_STEPS}
        found = ca.rootfinder("newton", "fast_newton", missed, options)(x, *given)
        return ca.Function(
            "equilibrium",
            [x, *given],
            [found, ca.sum1(ca.fabs(missed(found, *given)))],
            ["start", *list(self._symbols)[1:]],
            ["x", "missed"],
        )

    @cached_property
    def energy(self) -> ca.Function:
        """(x, inputs) ↦ elastic energy of the protruding robot, and of torsion in the housing, J.

        The work of the loads is subtracted if all loads have an energy: see :attr:`Robot.has_energy`.
        """
        last = self._state(self._whole.ends[-1])
        twisting = ca.sum1(last.torques**2 * self._compliance) / 2
        # Integrated towards the base, lengths are negative.
        return self._function("energy", {"energy": twisting - last.energy})

    @cached_property
    def tips(self) -> ca.Function:
        """(x, inputs) ↦ positions, 3×n, m, and quaternions, 4×n, of the tubes' tips, in base axes."""
        position = ca.horzcat(*[tip.position for tip in self._tips])
        quaternion = ca.horzcat(*[tip.quaternion for tip in self._tips])
        return self._function("tips", {"position": position, "quaternion": quaternion})

    @cached_property
    def tip(self) -> dict[str, ca.Function]:
        """(x, inputs) ↦ position, m, quaternion and rotation of the tip of a tube, in base axes, by name."""
        functions = {}
        for name, pose in zip(self.robot.names, self._tips, strict=True):
            rotation = quaternion_to_matrix(pose.quaternion)
            outputs = {"position": pose.position, "quaternion": pose.quaternion, "rotation": rotation}
            functions[name] = self._function("tip", outputs)
        return functions

    @cached_property
    def section(self) -> dict[str, ca.Function]:
        """(x, inputs, at) ↦ position, m, and quaternion of a section of a tube in base axes, by name.

        The abscissa ``at`` is 0 at the drive's end of the tube and 1 at its tip. In the housing tubes are straight.
        """
        at = ca.MX.sym("at")
        functions = {}
        for index, name in enumerate(self.robot.names):
            pose = self._section_pose(index, at)
            outputs = {"position": pose.position, "quaternion": pose.quaternion}
            functions[name] = self._function("section", outputs, {"at": at})
        return functions

    @cached_property
    def tip_jacobian(self) -> ca.Function:
        """(x, inputs) ↦ derivatives of the poses of all tips by the inputs in equilibrium, 6 n rows.

        Each tube has six rows [δθ; δr] in base axes, in rad and m, per unit of the input. Unknowns follow the inputs,
        δx = −(∂g/∂x)⁻¹ ∂g/∂inputs δinputs; the result is not finite where the robot snaps.
        """
        jacobian, by_inputs, poses, poses_by_x, poses_by_inputs, *_ = self.sensitivity(*self._symbols.values())
        following = -ca.solve(jacobian, by_inputs)
        changes = poses_by_inputs + poses_by_x @ following
        rows: list[Matrix] = []
        for pose, change in zip(ca.horzsplit(poses), ca.vertsplit(changes, POSE_SIZE), strict=True):
            back = quaternion_conjugate(pose[3:])
            # δQ = ½ (0, δθ) ⊗ Q.
            turns = [2 * quaternion_product(column, back)[1:] for column in ca.horzsplit(change[3:, :])]
            rows += [ca.horzcat(*turns), change[:3, :]]
        return self._function("tip_jacobian", {"tip_jacobian": ca.vertcat(*rows)})

    @cached_property
    def sensitivity(self) -> ca.Function:
        """(x, inputs) ↦ derivatives of residual and tips, from one integration with all changes.

        The results are derivatives of the residual by x, square, and by the inputs; positions and quaternions of the
        tips in base axes, 7×n, and their derivatives by x and by the inputs at fixed x, 7 n rows, tube by tube; if the
        scene names parameters, also derivatives of both by these.
        """
        x, *given = self._symbols.values()
        directions = Directions(self.robot, self.size)
        ends = self._changing(directions)
        plate, plate_changes = ends[-1]
        fixed = dict(enumerate([directions.of_x, *directions.of_given], start=1))
        state = ca.MX.sym("plate", self._staged.width)
        of_plate = ca.Function("of_plate", [state, x, *given], [self._missed(state)])
        _, missed = with_changes(of_plate, directions, fixed)(plate, x, *given, plate_changes)
        # A rotation turns its drive, and changes nothing else.
        by_rotations = ca.vertcat(-ca.DM.eye(self.tube_count), ca.DM(self.size - self.tube_count, self.tube_count))
        poses: list[Matrix] = []
        changes: list[Matrix] = []
        for index, rank in enumerate(self._ranks):
            reached = _selected(rank, [state for state, _ in ends[:-1]])
            reached_changes = _selected(rank, [change for _, change in ends[:-1]])
            of_tip = with_changes(self._of_tip(index), directions, {2: directions.of_x})
            pose, moved = of_tip(plate, reached, x, plate_changes, reached_changes)
            poses.append(pose)
            changes.append(moved)
        moved = ca.vertcat(*changes)
        outputs = {
            "jacobian": missed[:, : self.size],
            "by_inputs": directions.by_inputs(missed, by_rotations),
            "poses": ca.horzcat(*poses),
            "poses_by_x": moved[:, : self.size],
            "poses_by_inputs": directions.by_inputs(moved, ca.DM(moved.size1(), self.tube_count)),
        }
        if self.parameters.size:
            outputs["by_parameters"] = missed[:, directions.parameters]
            outputs["poses_by_parameters"] = moved[:, directions.parameters]
        return self._function("sensitivity", outputs)

    def _changing(self, directions: Directions) -> list[tuple[Matrix, Matrix]]:
        """States at the ends of the pieces from the tip on, and their changes, a column for each direction."""
        x, *given = self._symbols.values()
        fixed = directions.of_given
        staged = self._staged
        width = staged.width_with_carried
        begun = ca.Function("begun", [x, *given], [self._begun])
        state, changes = with_changes(begun, directions, dict(enumerate([directions.of_x, *fixed])))(x, *given)
        ends = [(state, changes)]
        of_pieces = ca.Function("lengths", given, [ca.vertcat(*self._piece_lengths) / self.steps])
        lengths, length_changes = with_changes(of_pieces, directions, dict(enumerate(fixed)))(*given)
        length_changes = length_changes[:, directions.stretching]
        steps = changing_step(staged, directions).mapaccum("changing_steps", self.steps)
        for piece, sections in enumerate(ca.horzsplit(self._sections, self.steps)):
            section = sections[:, 0]
            if self.parameters.size:
                section = ca.vertcat(section, ca.vec(ca.densify(ca.jacobian(section, self.parameters.symbol))))
            if staged.carried:
                begin = ca.MX.sym("begin", width)
                passing = ca.Function("passing", [begin, *given], [self._passing(piece, begin)])
                passed = with_changes(passing, directions, dict(enumerate(fixed, start=1)))
                state, changes = passed(state, *given, changes)
            along = ca.vertcat(lengths[piece], length_changes[piece, :].T)
            repeated = [ca.repmat(constants, 1, self.steps) for constants in (along, section)]
            stacked = steps(ca.vertcat(state, ca.vec(changes)), *repeated)[:, -1]
            state, changes = stacked[:width], ca.reshape(stacked[width:], width, -1)
            ends.append((state, changes))
        return [(state[: staged.width], changes[: staged.width, :]) for state, changes in ends]

    def _of_tip(self, index: int) -> ca.Function:
        """(state at the plate, state at the tip of a tube, x) ↦ its pose in base axes, position and quaternion."""
        x, _, _ = self._arguments
        plate, reached = (ca.MX.sym(name, self._staged.width) for name in ("plate", "reached"))
        pose = self._tip_pose(index, plate, reached)
        return ca.Function("of_tip", [plate, reached, x], [ca.vertcat(pose.position, pose.quaternion)])

    @cached_property
    def stations(self) -> ca.Function:
        """(x, inputs) ↦ the robot at all ends of steps from the plate to its tip, as columns.

        The results are distances from the plate along the centre line, 1×k, m; positions, 3×k, m, and quaternions, 4×k,
        of the frame that does not turn about the centre line, in base axes; angles of the tubes against it, n×k, rad;
        torques in the tubes, n×k, N m.
        """
        columns = [self._state(column) for column in reversed(ca.horzsplit(self._whole.stations))]
        poses = [self._in_base(column.pose) for column in columns]
        outputs = {
            "distance": ca.horzcat(0, ca.cumsum(-ca.horzcat(*reversed(ca.horzsplit(self._lengths))), 1)),
            "position": ca.horzcat(*[pose.position for pose in poses]),
            "quaternion": ca.horzcat(*[pose.quaternion for pose in poses]),
            "angles": ca.horzcat(*[column.angles for column in columns]),
            "torques": ca.horzcat(*[column.torques for column in columns]),
        }
        return self._function("stations", outputs)

    # Where it has which section

    @cached_property
    def _arguments(self) -> tuple[ca.MX, ca.MX, ca.MX]:
        """Symbols of unknowns, inputs and load factor, the arguments of all functions."""
        return ca.MX.sym("x", self.size), ca.MX.sym("inputs", self.robot.inputs.size), ca.MX.sym("load_factor")

    @property
    def _symbols(self) -> dict[str, ca.MX]:
        """Arguments of all functions by name: unknowns, inputs, and parameters if the scene names some."""
        x, inputs, _ = self._arguments
        symbols = {"x": x, "inputs": inputs}
        if self.parameters.size:
            symbols[PARAMETERS] = self.parameters.symbol
        return symbols

    @cached_property
    def _lengths(self) -> ca.MX:
        """Lengths of all steps from the tip on, 1×(2 n steps), negative, m."""
        return ca.horzcat(*[ca.repmat(length / self.steps, 1, self.steps) for length in self._piece_lengths])

    @property
    def _piece_lengths(self) -> list[ca.MX]:
        """Lengths of the pieces from the tip on, negative, m."""
        return [end - start for start, end in itertools.pairwise(self._places)]

    @cached_property
    def _sections(self) -> Matrix:
        """Stacked section of every step, (2 n + 2)×(2 n steps)."""
        sections = []
        for start, end in itertools.pairwise(self._places):
            sections.append(ca.repmat(self._section((start + end) / 2), 1, self.steps))
        return ca.horzcat(*sections)

    def _marched(self, step: ca.Function, begun: Matrix, sections: Matrix, entered: Entered) -> March:
        """Take the steps of all pieces from the tip on.

        Args:
            step: (state, length, section) ↦ state.
            begun: stacked state at the tip.
            sections: stacked sections of the steps, a column each.
            entered: (piece, state at its start, sections of its steps) ↦ state and sections beyond its start.
        """
        steps = step.mapaccum("steps", self.steps)
        ends, stations, starts, taken = [begun], [begun], [], []
        pieces = zip(ca.horzsplit(self._lengths, self.steps), ca.horzsplit(sections, self.steps), strict=True)
        for piece, (length, of_piece) in enumerate(pieces):
            start, section = entered(piece, ends[-1], of_piece)
            passed = steps(start, length, section)
            ends.append(passed[:, -1])
            stations.append(passed)
            starts += [start, passed[:, :-1]]
            taken.append(section)
        return March(ends, *(ca.horzcat(*columns) for columns in (stations, starts, taken)))

    @cached_property
    def _places(self) -> list[ca.MX]:
        """Distances from the plate where tubes end or begin to bend, sorted from the tip of the robot, then zero.

        The order is determined at evaluation, because inputs may change it; pieces between places that coincide, or are
        in the housing, have zero length.
        """
        places = list(self._unsorted)
        # Exchanging neighbours sorts whatever the values are, without a branch.
        for passed in range(len(places)):
            for index in range(len(places) - 1 - passed):
                first, second = places[index], places[index + 1]
                # Of places that coincide the first stays so, in derivatives too: those of fmax and fmin are of one.
                exchanged = first < second
                places[index] = ca.if_else(exchanged, second, first)
                places[index + 1] = ca.if_else(exchanged, first, second)
        return [*places, ca.MX(0.0)]

    @property
    def _unsorted(self) -> list[ca.MX]:
        """Places where tubes end and begin to bend, tube by tube, then other places that divide the robot."""
        return [*[place for ends in self._ends for place in ends], *self._loaded_places]

    @property
    def _loaded_places(self) -> list[ca.MX]:
        """Places where forces act beside the tips."""
        return []

    @cached_property
    def _ends(self) -> list[tuple[ca.MX, ca.MX]]:
        """Distances from the plate of the tip of every tube, and of the beginning of its curved part, m."""
        _, inputs, _ = self._arguments
        ends = []
        for index in range(self.tube_count):
            tip = inputs[2 * index + 1]
            straight = tip - self.robot.numbers.curved[index]
            # Where all of the straight part is inside, derivatives are those of drawing the tube in: it may have none.
            bend = ca.if_else(straight > 0.0, straight, 0.0)
            ends.append((tip, bend))
        return ends

    @cached_property
    def _ranks(self) -> list[ca.MX]:
        """Index of the tip of every tube among the sorted places, 1×1 each."""
        return [self._rank(2 * index) for index in range(self.tube_count)]

    def _rank(self, own: int) -> ca.MX:
        """Index among the sorted places of an entry of `_unsorted`, 1×1; coinciding places have different indices."""
        rank = ca.MX(0.0)
        for number, place in enumerate(self._unsorted):
            if number < own:
                rank = rank + (place >= self._unsorted[own])
            elif number > own:
                rank = rank + (place > self._unsorted[own])
        return rank

    def _section(self, place: ca.MX) -> Matrix:
        """Stacked section at a place: torsion, moments, bending and own energy of the tubes there, (2 n + 2)×1."""
        tubes = self.robot.numbers
        _, _, load_factor = self._arguments
        moments = []
        bending: Matrix = ca.MX(0.0)
        own: Matrix = ca.MX(0.0)
        for index, (tip, bend) in enumerate(self._ends):
            stiffness = tubes.bending[index]
            curvature = load_factor * tubes.curvature[index]
            is_here = ca.if_else(place < tip, 1.0, 0.0)
            is_curved = is_here * ca.if_else(place > bend, 1.0, 0.0)
            moments.append(is_curved * stiffness * curvature)
            bending = bending + is_here * stiffness
            own = own + is_curved * stiffness * curvature**2 / 2
        # A piece without length may have no tube; dividing by its stiffness must do no harm.
        stiffness_or_one = bending + ca.if_else(bending > 0.0, 0.0, 1.0)
        return ca.vertcat(as_matrix(tubes.torsion), *moments, stiffness_or_one, own)

    # What follows from it

    @property
    def _compliance(self) -> ca.MX:
        """Torsional compliance of every tube in the housing, between drive and plate, n×1, rad/(N m)."""
        _, inputs, _ = self._arguments
        inside = as_matrix(self.robot.numbers.length) - self.robot.translations(inputs)
        return inside / as_matrix(self.robot.numbers.torsion)

    def _in_base(self, pose: Pose) -> Pose:
        """Transform a pose from the axes of the tip's frame to base axes."""
        return self._state(self._whole.ends[-1]).pose.seen(pose)

    def _tip_pose(self, index: int, plate: Matrix, reached: Matrix) -> Pose:
        """Pose of a tube's tip in base axes; its x axis is the direction in which the tube would bend.

        Args:
            index: index of the tube.
            plate: stacked state at the plate.
            reached: stacked state at the tip of the tube.
        """
        x, _, _ = self._arguments
        half = x[index] / 2
        turn = Pose(ca.DM.zeros(3), ca.vertcat(ca.cos(half), 0, 0, ca.sin(half)))
        return self._state(plate).pose.seen(self._state(reached).pose).then(turn)

    def _section_pose(self, index: int, at: ca.MX) -> Pose:
        """Pose of a section of a tube in base axes, by part of the step that contains it."""
        _, inputs, _ = self._arguments
        length = self.robot.numbers.length[index]
        distance = self.robot.translations(inputs)[index] - (1 - at) * length
        outside = ca.fmax(distance, 0)
        # The first step from the tip on that ends nearer to the plate, or there.
        ends = self._places[0] + ca.cumsum(self._lengths, 1)
        begins = ca.horzcat(self._places[0], ends[:-1])
        # Sums of lengths are off by rounding: the last step has no other behind it.
        first = ca.fmin(ca.sum2(ends > outside), ends.size2() - 1)
        chosen = ca.DM(range(ends.size2())) == first
        whole = self._whole
        start = whole.starts @ chosen
        state = self._state(self._step(start, outside - begins @ chosen, whole.sections @ chosen))
        # Behind the plate the torque of the plate twists the tube.
        inside = distance - outside
        half = (state.angles[index] + inside * state.torques[index] / self.robot.numbers.torsion[index]) / 2
        turned = ca.vertcat(ca.cos(half), 0, 0, ca.sin(half))
        return self._in_base(state.pose).then(Pose(ca.vertcat(0, 0, inside), turned))

    @cached_property
    def _tips(self) -> list[Pose]:
        """Pose of every tube's tip in base axes."""
        ends = self._whole.ends
        return [self._tip_pose(index, ends[-1], _selected(rank, ends[:-1])) for index, rank in enumerate(self._ranks)]

    def _function(
        self, name: str, outputs: Mapping[str, Matrix], further: Mapping[str, ca.MX] | None = None
    ) -> ca.Function:
        """Make a function of unknowns, inputs and further arguments, for tubes with the curvatures of the scene."""
        _, _, load_factor = self._arguments
        results = ca.substitute(list(outputs.values()), [load_factor], [ca.MX(1.0)])
        return self._named(name, dict(zip(outputs, results, strict=True)), further or {})

    def _on_path(
        self, name: str, outputs: Mapping[str, Matrix], further: Mapping[str, ca.MX] | None = None
    ) -> ca.Function:
        """Make a function of unknowns, inputs, load factor and further arguments."""
        _, _, load_factor = self._arguments
        return self._named(name, outputs, {"load_factor": load_factor, **(further or {})})

    def _named(self, name: str, outputs: Mapping[str, Matrix], further: Mapping[str, ca.MX]) -> ca.Function:
        """Make a function of unknowns, inputs and further arguments, by their symbols."""
        arguments = {**self._symbols, **further}
        return ca.Function(name, list(arguments.values()), list(outputs.values()), list(arguments), list(outputs))


def _selected(rank: ca.MX, columns: list[Matrix]) -> Matrix:
    """Select the column with an index that is known only at evaluation."""
    chosen: Matrix = ca.DM(0.0)
    for number, column in enumerate(columns):
        chosen = chosen + ca.if_else(rank == ca.MX(number), column, 0.0)
    return chosen


AnyModel: TypeAlias = Model | TubeFunctions
"""A model of rods or of concentric tubes."""
