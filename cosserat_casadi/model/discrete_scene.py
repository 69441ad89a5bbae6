"""A scene with all its constants: everything that does not depend on the unknowns.

The order of x follows from these: strains of the rods, multipliers of the constraints, deviations of the floating
frames, coordinates of joints, tensions of the cables of given length, as in docs/theory.md, section 8; in motion also
flows of rods with relaxing stress.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf, isfinite
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.constraints.held_directions import CLAMPED
from cosserat_casadi.constraints.section_constraint import SectionConstraint
from cosserat_casadi.loads.contact_layer import ContactLayer
from cosserat_casadi.loads.obstacle_load import section_radii
from cosserat_casadi.loads.rods_point import RodsPoint
from cosserat_casadi.maths.grid import Grid
from cosserat_casadi.maths.numbers import Scalar, any_symbolic, as_matrix, as_vector, is_symbolic, known
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.contact_layers import (
    closer_sections,
    contact_layers,
    half_of_stretch,
    points_for,
    share_of_more_modes,
)
from cosserat_casadi.model.contact_pairs import ContactPair, contact_pairs, history_size
from cosserat_casadi.model.discretise import enriched, fewest_fibres, nodes_above_modes
from cosserat_casadi.model.element_ends import moved_ends
from cosserat_casadi.model.floating_frames import FloatingFrame, FrameName, UnloadedScene
from cosserat_casadi.model.homotopy import Compliance
from cosserat_casadi.model.inputs import HISTORY, Input, InputLayout
from cosserat_casadi.model.parameters import NO_PARAMETERS, ParameterLayout, parameter_layout
from cosserat_casadi.model.registry import EFFECTS, remembering
from cosserat_casadi.model.required_modes import seeing_modes
from cosserat_casadi.model.scene_constraints import (
    FORCE_WEIGHT,
    PlacedConstraint,
    placed_constraints,
    written_constraints,
)
from cosserat_casadi.model.scene_rods import fixed_masses, rod_properties
from cosserat_casadi.model.unknowns import BlockKind, UnknownBlock, Unknowns
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.rod.kinematics import Shape, shape
from cosserat_casadi.rod.placed_sections import SummedSections
from cosserat_casadi.rod.strain import DiscreteRod
from cosserat_casadi.rod.strain_density import StiffnessBeyondHooke, stiffness_beyond_hooke
from cosserat_casadi.scene.constraint_records import STOP_KEYS, AxisJoint
from cosserat_casadi.scene.input_fields import InputField

UNEVEN = 1e4
"""Largest unit EI/ℓ over the least EI/ℓ of a scene: in a stiffer unit the forces of soft rods would be rounding."""

NO_SOFTNESS = 1e-9
"""Softness below which a rod yields to a cable by rounding alone."""


FINER_PAIRS = 2
"""Sections of a richer scene for each section by which a scene sums the push of rods that parameters may stretch."""

FINER_SECTIONS = 3
"""Sections of a richer scene for each section, or interval, by which a scene sums a layer: its error shows."""

FINER_ON_PLANES = 2
"""Sections of a richer scene for each interval where an obstacle is a plane, which presses longer stretches."""

STEPS_OF_LAWS = 3
"""Steps of conjugate gradients of an elastic step whose material laws couple strains, or vary along a rod."""

NO_ENERGY = 1e-30
"""Energy of a step, in units of EI/ℓ, that counts as zero."""

SOFTEST = 0.01
"""Least ratio of a mode's tangent stiffness to Hooke's law: a mode that is softer is held by something else."""


@dataclass(frozen=True)
class CableOfLength:
    """A tendon of given length, whose tension is an unknown.

    Attributes:
        tendon: record of the tendon in the scene.
        softness: shortening of the cable by a unit of tension in the unloaded rod, relative to the rod's length.
    """

    tendon: scenes.Actuator
    softness: float

    @property
    def may_go_slack(self) -> bool:
        """Whether the cable goes slack instead of pushing."""
        return bool(EFFECTS[self.tendon.kind].may_go_slack(self.tendon))

    @property
    def compliance(self) -> Compliance:
        """Compliance of a spring between its length and the given one, as soft as the rod."""
        # The row of a cable that may go slack grows with its tension; the row of another cable, −s, falls with it.
        if self.may_go_slack:
            return Compliance(power=1, scale=self.softness)
        return Compliance(power=1, scale=-self.softness)


@dataclass(frozen=True)
class JointStop:
    """A stop of a joint, which pushes with an unknown moment or force.

    Attributes:
        placed: the joint.
        bound: coordinate of the joint at the stop, rad or m.
        side: direction of the push: 1 for the stop at the least coordinate, −1 for the largest.
        stiffness: of an elastic stop, N m/rad or N/m; None of a rigid one.
    """

    placed: PlacedConstraint
    bound: Scalar
    side: int
    stiffness: Scalar | None

    @property
    def softness(self) -> Matrix:
        """Deflection of an elastic stop under a unit of its push, in the unit of the coordinate as an unknown, 1×1."""
        assert self.stiffness is not None, "asked for of an elastic stop"
        return self.placed.constraint.unit / self.placed.coordinate_scale**2 / as_matrix(as_vector([self.stiffness]))

    @property
    def owner(self) -> str:
        """Path of the stop in the scene."""
        return f"{self.placed.where}.{self.key}"

    @property
    def key(self) -> str:
        """Key of the stop in the table of its joint."""
        return STOP_KEYS[0] if self.side > 0 else STOP_KEYS[1]


STOP_COMPLIANCE = Compliance(power=1)
"""Compliance of a stop on the load path: one unit of its coordinate for a unit of its push."""


@dataclass(frozen=True)
class DiscreteScene:
    """A scene with its constant matrices.

    Attributes:
        scene: the scene of the equations; its numbers may be expressions of parameters.
        layout: its inputs.
        rods: the constant matrices of each rod.
        parameters: the parameters in its expressions.
        scaling: the scene with the numbers that scale the equations; None where this scene holds them itself.
        moving: whether it is for a motion, in which relaxing stress has flows as unknowns.
        memory: grids of the rods at whose nodes loads remember sections along a path; None for the scene's own grids.
        layers: factor on the widths of smooth contact of the scene.
        given_sections: sections at which layers are summed, by the name of the load; None for the sections that the
            scene asks for.
    """

    scene: scenes.Scene
    layout: InputLayout
    rods: dict[str, DiscreteRod]
    parameters: ParameterLayout = NO_PARAMETERS
    scaling: DiscreteScene | None = None
    moving: bool = False
    memory: Mapping[str, Grid] | None = None
    layers: float = 1.0
    given_sections: Mapping[str | None, SummedSections] | None = None

    def __reduce__(self) -> tuple[Callable[..., DiscreteScene], tuple[Any, ...]]:
        """Pickle and copy rebuild the scene from its description, since CasADi's symbols cannot be stored."""
        if self.layers != 1.0:
            return DiscreteScene.with_layers, (self.with_layers(1.0), self.layers)
        if self.scaling is None:
            discretisation = {name: rod.discretisation for name, rod in self.rods.items()}
            return discrete_scene, (self.scene, self.layout, discretisation, self.moving)
        if self.parameters.size:
            return with_parameters, (self.scaling,)
        return with_numbers, (self.scaling, self.scene)

    @property
    def nominal(self) -> DiscreteScene:
        """The scene with the numbers that scale the equations: the values of its file."""
        return self if self.scaling is None else self.scaling

    @property
    def in_motion(self) -> DiscreteScene:
        """This scene for a motion."""
        scaling = None if self.scaling is None else self.scaling.in_motion
        return replace(self, scaling=scaling, moving=True)

    def told_as(self, scene: scenes.Scene) -> DiscreteScene:
        """These constants for a scene that differs only in keys that :meth:`Scene.of_equations` leaves out."""
        told = replace(self, scene=scene)
        # The unknowns follow from the unloaded poses of frames, which take time to compute: they are kept.
        assert self.unknowns, "a scene has unknowns"
        vars(told).update({name: value for name, value in vars(self).items() if name != "scene"})
        return told

    @cached_property
    def unloaded(self) -> UnloadedScene:
        """Unloaded poses of rods and bodies for the scaling scene's numbers, from which deviations are counted."""
        if self.scaling is not None:
            return self.scaling.unloaded
        return UnloadedScene(self.scene, self.rods)

    @cached_property
    def own_unloaded(self) -> UnloadedScene:
        """Unloaded poses of rods and bodies for this scene's own numbers."""
        return UnloadedScene(self.scene, self.rods)

    def carrier_moves(self, rod: str) -> bool:
        """Whether an expression of parameters moves the carrier of an unloaded rod: a section of a rod, or a body."""
        base = self.records[rod].base
        if rod in self.scene.jointed_bases and rod not in self.scene.base_joints:
            # The pose of a body follows from its joints, these from the poses of rods, which may hold further bodies.
            places = [entry for joint in self.scene.joints for entry in (joint.position, joint.quaternion)]
            return any_symbolic(places) or any(self._moves_itself(other) for other in self.records)
        if base.rod is None:
            return False
        return any_symbolic([base.at]) or self._moves_itself(base.rod) or self.carrier_moves(base.rod)

    def _moves_itself(self, rod: str) -> bool:
        """Whether an expression of parameters shapes an unloaded rod, or places it on its carrier."""
        record = self.records[rod]
        shaping = [record.length, record.intrinsic.curvature, record.intrinsic.tangent]
        return any_symbolic([*shaping, record.base.position, record.base.quaternion])

    @cached_property
    def loads(self) -> tuple[scenes.LoadRecord, ...]:
        """The loads of the scene, then the contact layers of its obstacles with a width."""
        layers = contact_layers(self.scene, self.nominal.rods)
        return (*self.scene.loads, *(layer.widened(self.layers) for layer in layers))

    @cached_property
    def closer_sections(self) -> dict[str | None, SummedSections]:
        """Sections at which layers too thin for the nodes of a rod are summed, by the name of the load."""
        if self.given_sections is not None:
            return {
                name: replace(own, rod=self.rods[own.rod.properties.name]) for name, own in self.given_sections.items()
            }
        # By the scaling scene's numbers: parameters and other widths do not change the number of sections.
        found: dict[str | None, SummedSections] = {}
        for layer in contact_layers(self.nominal.scene, self.nominal.rods):
            if layer.rod is None or layer.at is not None:
                continue
            sections = closer_sections(
                layer.obstacle,
                self.nominal.rods[layer.rod],
                moved=self._named.rods[layer.rod].grid.ends is not None,
                stretched=layer.name in self.stretched_layers,
            )
            if sections is not None:
                found[layer.name] = replace(sections, rod=self.rods[layer.rod])
        return found

    @cached_property
    def stretched_layers(self) -> list[str | None]:
        """Names of layers for which inputs or parameters change the width, or the length or a radius of the rod."""
        return [
            layer.name
            for layer in contact_layers(self._named.scene, self.nominal.rods)
            if layer.rod is not None and (any_symbolic([layer.obstacle.width]) or self.is_stretched(layer.rod))
        ]

    def is_stretched(self, rod: str) -> bool:
        """Whether inputs or parameters change the length or a radius of a rod."""
        properties = self._named.rods[rod].properties
        is_longer = properties.ratio is not None or self.layout.of_rod(rod, "length") is not None
        return is_longer or any_symbolic([section_radii(properties, np.zeros(1))])

    @property
    def may_lie_apart(self) -> bool:
        """Whether sections at which contact is summed may lie too far apart, in motion, to show its error."""
        rubs = any(obstacle.is_smooth and obstacle.rubs for obstacle in self.scene.obstacles)
        touching = {name for pair in self.pairs for name in pair.rods}
        drawn = any(map(self.draws_apart, {*touching, *self.pressed_rods}))
        return rubs or drawn or bool(self.stretched_layers)

    def draws_apart(self, rod: str) -> bool:
        """Whether inputs or parameters may draw sections of a rod apart, or shorten its pressed stretch."""
        return self.is_stretched(rod) or self._named.rods[rod].grid.ends is not None

    @cached_property
    def _named(self) -> DiscreteScene:
        """The scene with symbols for the parameters that its file names, even where they are fixed."""
        if self.parameters.size:
            return self
        if self.scaling is not None:
            return self.scaling._named
        return with_parameters(self) if self.scene.parameters else self

    @property
    def remembered(self) -> Mapping[str, Grid]:
        """Grids of the rods at whose nodes loads remember sections along a path."""
        return self.memory or {name: rod.grid for name, rod in self.rods.items()}

    @cached_property
    def with_memory(self) -> DiscreteScene:
        """This scene with an input of memory for every load and pair of rods that remembers sections."""
        loads = remembering(self.loads)
        shapes = [(load.name, EFFECTS[load.kind].remembers(load), self.rods[load.rod].grid.size) for load in loads]
        rubbing = [pair for pair in self.pairs if pair.friction > 0.0]
        shapes += [(pair.name, history_size(pair, self.remembered), 1) for pair in rubbing]
        entries = list(self.layout.entries)
        for name, numbers, count in shapes:
            declared = InputField("1", numbers, nonlinear=True, nodal=True)
            entries.append(Input(name, HISTORY, declared, np.zeros((numbers, count)), "none", False, np.inf))
        return replace(self, layout=InputLayout(tuple(entries)))

    @cached_property
    def pairs(self) -> tuple[ContactPair, ...]:
        """Pairs of rods that push each other."""
        if not self.scene.rod_contacts:
            return ()
        pairs = [pair.widened(self.layers) for pair in contact_pairs(self.scene, self.nominal.rods, self.rods)]
        # A scene with given sections shows the errors of another scene.
        if self.given_sections is None:
            return tuple(pairs)
        return tuple(pair.finer(FINER_PAIRS) if any(map(self.draws_apart, pair.rods)) else pair for pair in pairs)

    @cached_property
    def rods_points(self) -> list[RodsPoint]:
        """Forces between rods that touch at a section of either."""
        loads: Sequence[scenes.LoadRecord] = self.scene.loads
        return [load for load in loads if isinstance(load, RodsPoint)]

    @property
    def has_layers(self) -> bool:
        """Whether the scene has smooth contact, of obstacles or of rods."""
        return bool(self.pairs) or any(isinstance(load, ContactLayer) for load in self.loads)

    @property
    def pressed_rods(self) -> dict[str, float]:
        """Half of the shortest stretch that a layer presses, m, by rod; rods that no layer presses are left out."""
        halves: dict[str, float] = {}
        for layer in contact_layers(self.nominal.scene, self.nominal.rods):
            if layer.rod is not None and layer.at is None:
                half = half_of_stretch(layer.obstacle, self.nominal.rods[layer.rod].properties)
                halves[layer.rod] = min(half, halves.get(layer.rod, inf))
        return halves

    def share_of_more_modes(self, added: int) -> float:
        """Change of an answer by modes beyond added ones, over the change by these; 0 if no layer presses a rod."""
        shares = [0.0]
        for name, half in self.pressed_rods.items():
            rod = self.nominal.rods[name]
            element = float(rod.length * np.diff(rod.grid.breaks).max())
            shares.append(share_of_more_modes(max(rod.discretisation.modes), added, element, half))
        return max(shares)

    def with_layers(self, ratio: float) -> DiscreteScene:
        """This scene with the widths of smooth contact times a ratio; the force at zero gap stays the same."""
        return replace(self, layers=ratio)

    @cached_property
    def records(self) -> dict[str, scenes.Rod]:
        """Rods of the scene by name."""
        return {rod.name: rod for rod in self.scene.rods}

    @cached_property
    def bodies(self) -> dict[str, scenes.Body]:
        """Bodies of the scene by name."""
        return {body.name: body for body in self.scene.bodies}

    @cached_property
    def frames(self) -> dict[FrameName, FloatingFrame]:
        """Floating frames by name, with the bodies of this scene."""
        frames = dict(self.unloaded.frames)
        for name, frame in frames.items():
            if frame.body is not None:
                frames[name] = replace(frame, body=self.bodies[name.name])
        return frames

    @cached_property
    def constraints(self) -> list[PlacedConstraint]:
        """Supports, bases of carried rods and joints, in the order of their multipliers."""
        if self.scaling is not None:
            return written_constraints(self.scaling.constraints, self.scaling.scene, self.scene)
        return placed_constraints(self.unloaded)

    @cached_property
    def cables(self) -> list[CableOfLength]:
        """Tendons of given length."""
        return [
            CableOfLength(actuator, self._softness(actuator))
            for actuator in self.scene.actuators
            if EFFECTS[actuator.kind].prescribes_conjugate(actuator)
        ]

    def _softness(self, actuator: scenes.Actuator) -> float:
        """Shortening of a cable by a unit of tension, over the rod's length: gᵀ K⁻¹ g with g = ∂L/∂q / ℓ at q = 0.

        It is computed with the numbers that scale the equations. It is 1 if the unloaded rod does not yield, as to a
        cable along the axis of an inextensible rod.
        """
        nominal = self.nominal
        rod = nominal.rods[actuator.rod]
        (tendon,) = [other for other in nominal.scene.actuators if other.name == actuator.name]
        unloaded = shape(rod, ca.MX.zeros(rod.size))
        gradient = EFFECTS[tendon.kind].quantity(tendon, rod.grid).on(unloaded).gradient
        pull = ca.evalf(ca.MX(gradient)).full()[:, 0] / rod.properties.length
        softness = float(pull @ np.linalg.solve(known(rod.stiffness), pull))
        return softness if softness > NO_SOFTNESS else 1.0

    def constraint(self, where: str) -> SectionConstraint:
        """The constraint that a table of the scene describes, by the path of the table.

        Raises:
            KeyError: there is no such table.
        """
        for placed in self.constraints:
            if placed.where == where:
                return placed.constraint
        raise KeyError(where)

    @property
    def is_assembly(self) -> bool:
        """Whether constraints tie rods to each other, or a carried rod to the world."""
        return any(placed.closes_assembly for placed in self.constraints)

    @cached_property
    def closed_unloaded(self) -> bool:
        """Whether all constraints of the assembly are closed in the unloaded scene and along the load path.

        This holds if each floating frame is fixed to one section, no constraint closes a loop, and neither parameters
        nor inputs move rods: no spring then has to draw anything together.
        """
        ties = [placed for placed in self.constraints if placed.closes_assembly]
        held = [placed.frame for placed in ties if placed.constraint.held is CLAMPED]
        is_tree = None not in held and len(held) == len(ties) == len(set(held)) == len(self.frames)
        return is_tree and not self.parameters.size and not self.layout.geometry

    def constraints_on(self, rod: str) -> list[PlacedConstraint]:
        """Constraints that hold sections of a rod."""
        return [placed for placed in self.constraints if placed.rod == rod]

    @cached_property
    def unknowns(self) -> Unknowns:
        """The unknowns x in their order: strains, multipliers, poses, coordinates, tensions, stops, flows."""
        return Unknowns(tuple(self._blocks()))

    def _blocks(self) -> Iterator[UnknownBlock]:
        """The blocks of unknowns in their order."""
        for name, rod in self.rods.items():
            yield UnknownBlock(BlockKind.STRAIN, name, name, rod.size, rod.energy_unit)
        for placed in self.constraints:
            unit = placed.constraint.unit
            yield UnknownBlock(
                BlockKind.MULTIPLIER, placed.where, placed.rod, placed.size, unit, step_weight=placed.step_weight
            )
        # Several rods may meet in a frame, so that its block belongs to none of them.
        for frame_name, frame in self.frames.items():
            yield UnknownBlock(BlockKind.POSE, str(frame_name), None, FloatingFrame.SIZE, frame.unit)
        for placed in self.free_coordinates:
            yield UnknownBlock(BlockKind.COORDINATE, placed.where, None, 1, placed.constraint.unit)
        for cable in self.cables:
            tendon = cable.tendon
            unit = self.rods[tendon.rod].energy_unit
            yield UnknownBlock(BlockKind.TENSION, tendon.name, tendon.rod, 1, unit, step_weight=FORCE_WEIGHT)
        for stop in self.stops:
            unit = stop.placed.constraint.unit
            yield UnknownBlock(BlockKind.STOP, stop.owner, None, 1, unit, step_weight=FORCE_WEIGHT)
        for name, rod in self.rods.items():
            branches = len(rod.properties.branches)
            if branches and self.moving:
                yield UnknownBlock(BlockKind.FLOW, name, name, branches * rod.size, rod.energy_unit)

    @cached_property
    def free_coordinates(self) -> list[PlacedConstraint]:
        """Joints with an unknown coordinate: a spring, damper, motor or stop acts along it, no drive prescribes it."""
        return [
            placed
            for placed in self.constraints
            if placed.constraint.coordinate is not None and not self.joint_record(placed).prescribed
        ]

    def joint_record(self, placed: PlacedConstraint) -> AxisJoint:
        """The record of a joint with a coordinate."""
        assert placed.joint is not None, "asked for of a joint"
        record = self.scene.joints[placed.joint]
        assert isinstance(record, AxisJoint), "joints with a coordinate have an axis"
        return record

    @cached_property
    def stops(self) -> list[JointStop]:
        """Stops of joints."""
        stops = []
        for placed in self.free_coordinates:
            record = self.joint_record(placed)
            for bound, side in ((record.lower_stop, 1), (record.upper_stop, -1)):
                if bound is not None:
                    stops.append(JointStop(placed, bound, side, record.stop_stiffness))
        return stops

    def stop(self, stop: JointStop) -> slice:
        """Slice of the push of a stop in x."""
        return self.unknowns.slice_of(BlockKind.STOP, stop.owner)

    @property
    def pair_rows(self) -> list[int]:
        """Rows of complementary pairs, one of which is zero: of cables that may go slack, then of stops."""
        of_cables = [self.tension(cable).start for cable in self.cables if cable.may_go_slack]
        return [*of_cables, *(self.stop(stop).start for stop in self.stops)]

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return self.unknowns.size

    def existing(self, modes: Mapping[str, Sequence[int]]) -> npt.NDArray[np.bool_]:
        """Whether each unknown exists with these numbers of modes of the strains of each rod too, shape (size,)."""
        kept = np.ones(self.size, dtype=bool)
        # Flows have the modes of strains, once for each branch.
        for block, entries in self.unknowns.of_kind(BlockKind.STRAIN, BlockKind.FLOW):
            rod = self.rods[block.owner]
            of_strains = [rod.degrees(c) < count for c, count in zip(rod.columns, modes[block.owner], strict=True)]
            kept[entries] = np.tile(np.concatenate(of_strains), block.size // rod.size)
        return kept

    def multipliers(self, placed: PlacedConstraint) -> slice:
        """Slice of the multipliers of a constraint in x."""
        return self.unknowns.slice_of(BlockKind.MULTIPLIER, placed.where)

    def deviation(self, frame: FrameName) -> slice:
        """Slice of the deviation of a floating frame in x."""
        return self.unknowns.slice_of(BlockKind.POSE, str(frame))

    def coordinate(self, placed: PlacedConstraint) -> slice:
        """Slice of the coordinate of a joint in x."""
        return self.unknowns.slice_of(BlockKind.COORDINATE, placed.where)

    def tension(self, cable: CableOfLength) -> slice:
        """Slice of the tension of a cable of given length in x."""
        return self.unknowns.slice_of(BlockKind.TENSION, cable.tendon.name)

    def tension_unit(self, rod: str) -> float:
        """EI/ℓ² of a rod, N."""
        discrete_rod = self.rods[rod]
        return discrete_rod.energy_unit / discrete_rod.properties.length

    def body_frame(self, body: str) -> FloatingFrame:
        """The frame of a body, in units of the stiffest and the longest rod that holds it."""
        return self.unloaded.body_frame(body)

    @cached_property
    def richer(self) -> Richer:
        """This scene with modes and intervals added, on which the error of an answer is estimated."""
        nominal = self.nominal
        discretisation = {
            name: enriched(
                rod.discretisation,
                seeing_modes(nominal.scene, name),
                nodes_above_modes(nominal.scene, name, touches=bool(nominal.scene.obstacles or self.pairs)),
                in_layers=name in self.pressed_rods,
            )
            for name, rod in self.rods.items()
        }
        discrete = discrete_scene(nominal.scene, self.layout, discretisation, self.moving)
        if self.scaling is not None:
            discrete = with_numbers(discrete, self.scene, self.parameters)
        return Richer(self, replace(discrete, memory=self.remembered, given_sections=self.finer_sections))

    @cached_property
    def finer_sections(self) -> dict[str | None, SummedSections]:
        """Sections at which the richer scene sums layers, by the name of the load; they show the scene's error."""
        finer: dict[str | None, SummedSections] = {}
        for layer in contact_layers(self.nominal.scene, self.nominal.rods):
            # Friction depends on rotations, and on the memory of the nodes: it is summed at nodes.
            rubs = layer.obstacle.rubs and (self.moving or self.layout.memory is not None)
            if layer.rod is None or layer.at is not None or rubs:
                continue
            sections = self.closer_sections.get(layer.name)
            if sections is None:
                points = points_for(layer.obstacle, self.nominal.rods[layer.rod])
                sections = replace(points, rod=self.rods[layer.rod])
            by_nodes = layer.name not in self.closer_sections
            on_plane = by_nodes and not isfinite(layer.obstacle.thickness)
            finer[layer.name] = sections.finer(FINER_ON_PLANES if on_plane else FINER_SECTIONS)
        return finer

    def contact_unit(self, name: str, *, of_body: bool) -> float:
        """Unit of contact forces on a rod, or on a body, N."""
        if not of_body:
            return self.tension_unit(name)
        frame = self.body_frame(name)
        return frame.unit / frame.length


@dataclass(frozen=True)
class Richer:
    """A scene with more modes and intervals than another, and how the unknowns of both correspond.

    Attributes:
        coarse: the scene whose answers are judged.
        discrete: the coarse scene with modes and intervals added.
    """

    coarse: DiscreteScene
    discrete: DiscreteScene

    @cached_property
    def known(self) -> npt.NDArray[np.bool_]:
        """Whether each unknown is one of the coarse scene too, not a strain of higher degree; shape (richer size,)."""
        return self.discrete.existing({name: rod.discretisation.modes for name, rod in self.coarse.rods.items()})

    @cached_property
    def missing_rods(self) -> list[str]:
        """Name of the rod of each coordinate that the coarse scene lacks."""
        blocks = self.discrete.unknowns.blocks
        rods = np.repeat([block.rod or "" for block in blocks], [block.size for block in blocks])
        return [str(rod) for rod in rods[~self.known]]

    @property
    def missing_size(self) -> int:
        """Number of strain coordinates that the coarse scene lacks."""
        return self.discrete.size - self.coarse.size

    @property
    def strain_count(self) -> int:
        """Number of the strains of all rods."""
        return sum(len(rod.columns) for rod in self.discrete.rods.values())

    @cached_property
    def degree_pairs(self) -> npt.NDArray[np.int64]:
        """Number of the pair of degrees that each coordinate of the richer scene is of, shape (richer size,).

        The two highest degrees of strain k, counted over all rods, have number 2k, and the two below these 2k + 1. All
        other coordinates have one number more than twice the strains.
        """
        pairs = np.full(self.discrete.size, 2 * self.strain_count + 1)
        strain = 0
        for name, rich_rod in self.discrete.rods.items():
            for component, columns in rich_rod.columns.items():
                degrees = rich_rod.degrees(component)
                own = pairs[self.discrete.unknowns.strain(name)][columns]
                own[degrees > degrees.max() - 4] = 2 * strain + 1
                own[degrees > degrees.max() - 2] = 2 * strain
                strain += 1
        return pairs

    @cached_property
    def is_among_last(self) -> npt.NDArray[np.bool_]:
        """Whether each missing coordinate is of one of the two highest degrees of its strain, shape (missing,)."""
        return np.asarray(self.degree_pairs[~self.known] % 2 == 0)

    def joined(self, x: Matrix, missing: Matrix) -> Matrix:
        """Unknowns of the richer scene from the unknowns of the coarse one and the missing ones."""
        places = np.empty(self.discrete.size, dtype=int)
        places[self.known] = np.arange(self.coarse.size)
        places[~self.known] = self.coarse.size + np.arange(self.missing_size)
        return ca.vertcat(x, missing)[places.tolist()]

    def split(self, richer: Matrix) -> tuple[Matrix, Matrix]:
        """Split a vector of the richer scene into entries of the coarse scene's unknowns and of the missing ones."""
        known = np.flatnonzero(self.known).tolist()
        missing = np.flatnonzero(~self.known).tolist()
        return richer[known], richer[missing]

    def elastic_step(self, residual: Matrix, shapes: Mapping[str, Shape]) -> Matrix:
        """Step by which elasticity alone would cancel the residual in the missing coordinates.

        The step is −K⁻¹ r for all strains, with the stiffness K of the richer rods. With parameters K is scaled by its
        diagonal. With nonlinear materials K is the tangent stiffness, and conjugate gradients compute the step.

        Args:
            residual: residual of the richer scene in the missing coordinates, missing×1.
            shapes: shapes of the richer rods.

        Returns:
            step of all unknowns of the richer scene, size×1, zero for unknowns that are not strains.
        """
        further = {name: stiffness_beyond_hooke(shape) for name, shape in shapes.items()}
        lacking = self.joined(ca.DM(self.coarse.size, 1), residual)
        units = [self._stiffness_unit(name, further[name]) for name in self.discrete.rods]
        rest = self.discrete.size - sum(rod.size for rod in self.discrete.rods.values())
        unit = ca.vertcat(*units, ca.DM.ones(rest, 1))
        flexibility = ca.DM(ca.sparsify(self._nominal_flexibility))

        def scaled_step(left: Matrix) -> Matrix:
            return -(flexibility @ (left / unit)) / unit

        if not any(further.values()):
            return scaled_step(lacking)
        step, left = ca.MX(self.discrete.size, 1), lacking
        direction = scaled_step(left)
        descent = -ca.dot(left, direction)
        for number in range(STEPS_OF_LAWS):
            against = self._stiffness_times(direction, further)
            length = descent / ca.fmax(ca.dot(direction, against), NO_ENERGY)
            step = step + length * direction
            if number + 1 < STEPS_OF_LAWS:
                left = left + length * against
                further_step = scaled_step(left)
                before, descent = descent, -ca.dot(left, further_step)
                direction = further_step + descent / ca.fmax(before, NO_ENERGY) * direction
        return step

    def _stiffness_times(self, step: Matrix, further: Mapping[str, StiffnessBeyondHooke | None]) -> Matrix:
        """Product of the stiffness of all rods with a step of the unknowns, n×1; zero but for strains."""
        product = ca.MX(self.discrete.size, 1)
        for name, stiffness in further.items():
            strains = self.discrete.unknowns.strain(name)
            of_rod = self.discrete.rods[name].stiffness_matrix @ step[strains]
            product[strains] = of_rod if stiffness is None else of_rod + stiffness.times(step[strains])
        return product

    @cached_property
    def _nominal_flexibility(self) -> ca.DM:
        """K⁻¹ of all rods by the numbers that scale the equations, size×size, zero for other unknowns than strains."""
        nominal = self.discrete.nominal
        flexibility = np.zeros((nominal.size, nominal.size))
        for name, rod in nominal.rods.items():
            strains = nominal.unknowns.strain(name)
            flexibility[strains, strains] = np.linalg.inv(known(rod.stiffness))
        return ca.DM(flexibility)

    def _stiffness_unit(self, rod: str, further: StiffnessBeyondHooke | None) -> Matrix:
        """Square root of the ratio of each diagonal entry of K to the entry of the nominal scene, n×1."""
        stiffness = self.discrete.rods[rod].stiffness
        nominal = np.diag(known(self.discrete.nominal.rods[rod].stiffness))
        if further is not None:
            ratio = (ca.diag(as_matrix(stiffness)) + further.diagonal) / ca.DM(nominal)
            return ca.sqrt(ca.fmax(ratio, SOFTEST))
        if is_symbolic(stiffness):
            return ca.sqrt(ca.diag(as_matrix(stiffness)) / ca.DM(nominal))
        return ca.DM(np.sqrt(np.diag(known(stiffness)) / nominal))


def discrete_scene(
    scene: scenes.Scene, layout: InputLayout, discretisation: Mapping[str, Discretisation], moving: bool = False
) -> DiscreteScene:
    """The discrete scene of a scene at rest or, with ``moving``, in motion."""
    rods = {}
    discretisation = {
        rod.name: replace(own, fibres=own.fibres or fewest_fibres(rod))
        for rod in scene.rods
        for own in [discretisation[rod.name]]
    }
    every = [
        replace(rod_properties(rod, fibres=discretisation[rod.name].fibres), fixed_masses=fixed_masses(scene, rod.name))
        for rod in scene.rods
    ]
    softest = min(properties.bending_stiffness / properties.length for properties in every)
    for properties in every:
        largest = UNEVEN * softest * properties.length
        if properties.bending_stiffness > largest:
            properties = replace(properties, largest_unit=largest)
        rods[properties.name] = DiscreteRod(properties, discretisation[properties.name])
    return DiscreteScene(scene, layout, rods, moving=moving)


def with_numbers(
    nominal: DiscreteScene, scene: scenes.Scene, parameters: ParameterLayout = NO_PARAMETERS
) -> DiscreteScene:
    """A scene with other numbers, or expressions, under the scaling and the grids of a nominal scene.

    Args:
        nominal: the scene that scales the equations.
        scene: the scene with other numbers.
        parameters: the parameters in its expressions.
    """
    rods = {}
    for rod in scene.rods:
        scaling = nominal.rods[rod.name]
        own = rod_properties(rod, scaling.properties, scaling.discretisation.fibres)
        properties = replace(own, fixed_masses=fixed_masses(scene, rod.name))
        ends = moved_ends(nominal.scene, scene, rod.name, scaling.discretisation.breaks)
        rods[rod.name] = DiscreteRod(properties, scaling.discretisation, ends)
    return DiscreteScene(scene, nominal.layout, rods, parameters, nominal, nominal.moving)


def with_parameters(nominal: DiscreteScene) -> DiscreteScene:
    """The scene with parameters as entries of one symbol; the values of its file set the scaling and the grids.

    Raises:
        SceneError: a parameter would move a place that elements cannot follow.
    """
    parameters = parameter_layout(nominal.scene)
    written = parameters.written(nominal.scene, parameters.symbol)
    return with_numbers(nominal, written, parameters)
