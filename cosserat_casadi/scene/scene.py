"""The scene: rods, their loads and constraints, and settings for the commands."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, BeforeValidator, Field

from cosserat_casadi.result import Shown
from cosserat_casadi.scene.accuracy import Accuracy
from cosserat_casadi.scene.actuator_records import Actuator
from cosserat_casadi.scene.constraint_records import Body, Joint, Support
from cosserat_casadi.scene.disk_record import Disks
from cosserat_casadi.scene.faults import Fault, Table, shown
from cosserat_casadi.scene.input_fields import InputField
from cosserat_casadi.scene.input_range_records import InputRanges
from cosserat_casadi.scene.load_kinds import Load
from cosserat_casadi.scene.measurements import Measurement
from cosserat_casadi.scene.motion_records import InputMotion
from cosserat_casadi.scene.obstacle_records import Obstacle
from cosserat_casadi.scene.parameter_records import PARAMETER_LISTS, Holder, NamedNumbers, holders_of, tied_numbers
from cosserat_casadi.scene.records import HashedTable, Record, refusal
from cosserat_casadi.scene.rod_contact_record import RodContact
from cosserat_casadi.scene.rod_records import Rod
from cosserat_casadi.scene.rules import scene_faults
from cosserat_casadi.scene.simulation import TOLERANCE, Simulation
from cosserat_casadi.scene.target_records import Bound, Target
from cosserat_casadi.scene.tube_records import Tube
from cosserat_casadi.scene.unknown_records import Estimation, IdentificationSettings, Unknown
from cosserat_casadi.scene.values import NotEmpty, TiedNames, names_in, without_repetition
from cosserat_casadi.scene.velocity_record import InitialVelocity


def _exactly_one(value: Any) -> Any:
    # `true` and 1.0 equal 1 in Python.
    if type(value) is not int or value != 1:
        raise refusal([Fault((), f"must be 1, got {shown(value)}", "this version reads schema = 1")])
    return value


@dataclass(frozen=True)
class FreeInput:
    """A field of one of the scene's tables that stays free at run time.

    Attributes:
        record: the rod, tube, load, actuator or joint that it belongs to.
        field: its name in that record, with dots for a field in an inner table.
        declared: declaration by the record: unit, components, axes.
    """

    record: Rod | Tube | Load | Actuator | Joint
    field: str
    declared: InputField

    @property
    def owner(self) -> str:
        """Name of the rod, tube, load, actuator or joint."""
        return self.record.name or ""

    @property
    def name(self) -> str:
        """Name of the input, ``owner.field``."""
        return f"{self.owner}.{self.field}"


class Scene(Shown, Record):
    """Rods with their loads and constraints. SI units, right-handed world axes."""

    example: ClassVar[str] = """\
schema = 1
title = "Soft finger, own weight and a tip push"
inputs = ["push.force", "cable.tension"]

[ranges]
"cable.tension" = [0, 9]
"push.force" = [[-0.5, 0.5], [-0.5, 0.5], [-0.5, 0.2]]
"""

    schema_version: Annotated[Literal[1], BeforeValidator(_exactly_one)] = Field(
        alias="schema", description="version of the scene format: 1"
    )
    title: str = Field("", description="one line about the scene")
    inputs: Annotated[tuple[str, ...], AfterValidator(without_repetition)] | None = Field(
        None,
        description="inputs that stay free at run time, each as 'load.field'; when left out, every "
        "magnitude of loads and actuators",
    )
    parameters: Annotated[tuple[TiedNames, ...], AfterValidator(without_repetition)] = Field(
        (),
        description="numbers of the scene that become arguments of every function, by their keys, such as "
        "'finger.material.youngs_modulus'; a list of keys is one parameter, named as its first: their numbers keep "
        "their ratios",
    )
    ranges: InputRanges = Field(
        default_factory=HashedTable,
        description="ranges of inputs and parameters by name, in their units: [low, high] for all "
        "entries, or a list with one pair for each; modes and nodes are chosen for the whole of "
        "these ranges",
    )
    accuracy: Accuracy = Field(Accuracy(), description="wanted accuracy, or a fixed discretisation")
    rods: Annotated[tuple[Rod, ...], NotEmpty()] = Field((), description="the rods, at least one, unless it has tubes")
    loads: tuple[Load, ...] = Field((), description="loads on the rods")
    supports: tuple[Support, ...] = Field((), description="tips that are held; a tip without support is free")
    actuators: tuple[Actuator, ...] = Field((), description="tendons, pressurised chambers and muscles")
    bodies: tuple[Body, ...] = Field((), description="rigid bodies that rods carry")
    joints: tuple[Joint, ...] = Field((), description="joints between sections of rods and bodies")
    disks: tuple[Disks, ...] = Field((), description="rows of disks on rods")
    obstacles: tuple[Obstacle, ...] = Field((), description="obstacles, which rods may not enter, or leave")
    rod_contacts: tuple[RodContact, ...] = Field((), description="rods that may not enter each other, or themselves")
    tubes: Annotated[tuple[Tube, ...], NotEmpty()] = Field(
        (), description="concentric tubes, instead of rods; only loads act on them"
    )
    targets: tuple[Target, ...] = Field((), description="wanted places of sections and bodies, for the inverse problem")
    bounds: tuple[Bound, ...] = Field((), description="ranges of inputs that the inverse problem looks for")
    measurements: tuple[Measurement, ...] = Field((), description="measurements; for `cosserat identify` alone")
    unknowns: tuple[Unknown, ...] = Field((), description="numbers to find; for `cosserat identify` alone")
    identification: IdentificationSettings = Field(
        IdentificationSettings(), description="how the unknowns are looked for; for `cosserat identify` alone"
    )
    estimation: Estimation = Field(
        Estimation(), description="how the unknowns of each row are looked for; for `cosserat estimate` alone"
    )
    simulation: Simulation | None = Field(None, description="how a motion is computed; for `cosserat simulate` alone")
    motions: tuple[InputMotion, ...] = Field((), description="inputs over time; for `cosserat simulate` alone")
    velocities: tuple[InitialVelocity, ...] = Field(
        (), description="velocities at t = 0 of parts that do not begin at rest; for `cosserat simulate` alone"
    )

    @property
    def causes(self) -> tuple[Load | Actuator, ...]:
        """Loads, then actuators."""
        return (*self.loads, *self.actuators)

    @property
    def input_owners(self) -> tuple[Load | Actuator | Joint, ...]:
        """Owners of inputs other than rods and tubes: loads, actuators, then joints with a name."""
        return (*self.causes, *(joint for joint in self.joints if joint.name is not None))

    def free_inputs(self) -> tuple[FreeInput, ...]:
        """Inputs that stay free at run time: the listed ones, or else every magnitude of the scene.

        Returns:
            listed inputs in their order; rotations and translations of tubes, then magnitudes of loads, then of
            actuators, in the order of the file.
        """
        # An empty list means that nothing stays free.
        if self.inputs is not None:
            return tuple(self._named_input(name) for name in self.inputs)
        of_tubes = [FreeInput(tube, *entry) for tube in self.tubes for entry in tube.inputs.items()]
        magnitudes = [
            FreeInput(record, field, declared)
            for record in self.input_owners
            for field, declared in record.inputs.items()
            if field in record.model_fields_set and not declared.on_request
        ]
        return (*of_tubes, *magnitudes)

    def input_names(self) -> tuple[str, ...]:
        """Names ``load.field`` of the free inputs, in the order of `free_inputs`."""
        inputs = self.free_inputs()
        return tuple(entry.name for entry in inputs)

    def named_parameters(self) -> tuple[NamedNumbers, ...]:
        """The numbers that the scene names as parameters, in the order of its list."""
        holders = holders_of(
            Holder(key, index, record, getattr(record, "name", None))
            for key in PARAMETER_LISTS
            for index, record in enumerate(getattr(self, key))
        )
        named = [tied_numbers(names_in(entry), holders) for entry in self.parameters]
        return tuple(numbers for numbers in named if numbers is not None)

    def parameter_names(self) -> tuple[str, ...]:
        """Names of the parameters, in the order of its list."""
        return tuple(names_in(entry)[0] for entry in self.parameters)

    def with_numbers(self, numbers: NamedNumbers, values: Sequence[Any]) -> Scene:
        """The scene with other numbers for one parameter, and for the numbers that follow it.

        Args:
            numbers: the numbers to change.
            values: one for each of its cells: numbers, which are not checked, or expressions.
        """
        scene = self._with_cells(numbers, values)
        for tied, ratios in numbers.tied:
            following = [value if ratio == 1.0 else ratio * value for ratio, value in zip(ratios, values, strict=True)]
            scene = scene._with_cells(tied, following)
        return scene

    def _with_cells(self, numbers: NamedNumbers, values: Sequence[Any]) -> Scene:
        holder = numbers.holder
        records = list(getattr(self, holder.table))
        records[holder.index] = numbers.written(records[holder.index], values)
        return self.model_copy(update={holder.table: tuple(records)})

    @property
    def rods_held_at_tips(self) -> set[str]:
        """Names of the rods with tips that a support or a joint holds; a body with one joint does not hold a tip."""
        bodies = [place.body for joint in self.joints for place in joint.places if place.body is not None]
        holding = [joint for joint in self.joints if joint.body is None or bodies.count(joint.body) > 1]
        tips = [joint for joint in holding if joint.at == 1.0]
        return {holder.rod for holder in (*self.supports, *tips) if holder.rod}

    @property
    def joints_with_coordinate(self) -> tuple[Joint, ...]:
        """Named joints with a coordinate: a spring, a damper, a motor, a stop or a drive acts along it."""
        return tuple(joint for joint in self.joints if joint.has_coordinate and joint.name is not None)

    @property
    def base_joints(self) -> dict[str, int]:
        """Index of the joint, without a body, that holds the base of each rod with such a joint, by rod."""
        return {joint.rod: index for index, joint in enumerate(self.joints) if joint.rod and joint.at_base}

    @property
    def listed_bodies(self) -> list[Body]:
        """Bodies that results list, without bodies that stand for a disk or a joint."""
        return [body for body in self.bodies if body.listed]

    @property
    def jointed_bases(self) -> set[str]:
        """Names of the rods with bases that joints hold, to bodies too: these bases float."""
        return {joint.rod for joint in self.joints if joint.rod and joint.holds_base}

    @property
    def has_contact(self) -> bool:
        """Whether the scene has contact, with obstacles or between rods."""
        return bool(self.obstacles or self.rod_contacts)

    @property
    def touches_exactly(self) -> bool:
        """Whether the scene has exact contact, with obstacles or between rods."""
        return any(not obstacle.is_smooth for obstacle in self.obstacles) or self.rods_touch_exactly

    @property
    def rods_touch_exactly(self) -> bool:
        """Whether the scene has exact contact between rods."""
        return any(pair.exact for pair in self.rod_contacts)

    def without_exact_rods(self) -> Scene:
        """The scene without exact contact between rods, which then pass through each other."""
        return self.model_copy(update={"rod_contacts": ()}) if self.rods_touch_exactly else self

    @property
    def rubs(self) -> bool:
        """Whether there is friction in smooth contact."""
        smooth = any(obstacle.rubs and obstacle.is_smooth for obstacle in self.obstacles)
        return smooth or any(pair.rubs and not pair.exact for pair in self.rod_contacts)

    @property
    def rubs_exactly(self) -> bool:
        """Whether there is friction in exact contact, of rods with obstacles on paths too."""
        obstacles = any(obstacle.rubs and not obstacle.is_smooth for obstacle in self.obstacles)
        return obstacles or any(pair.rubs and pair.exact for pair in self.rod_contacts)

    @property
    def rubs_along_exact_paths(self) -> bool:
        """Whether there is friction in exact contact along paths: of rods with obstacles, by one coefficient."""
        return any(obstacle.rubs_on_paths and not obstacle.is_smooth for obstacle in self.obstacles)

    def in_proportion(self) -> Scene:
        """The scene with coefficients of materials scaled to Young's moduli, which as parameters scale whole laws."""
        rods = []
        for rod in self.rods:
            material = None if rod.material is None else rod.material.in_proportion()
            rods.append(rod if material is rod.material else rod.model_copy(update={"material": material}))
        # A scene of tubes must not have the key of rods.
        if all(changed is rod for changed, rod in zip(rods, self.rods, strict=True)):
            return self
        return self.model_copy(update={"rods": tuple(rods)})

    def baked(self) -> Scene:
        """The scene without parameters: every number is a constant of its model."""
        return self.model_copy(update={"parameters": ()}) if self.parameters else self

    @property
    def motion_tolerance(self) -> float:
        """Wanted error of the paths of tips relative to the rod length: the simulation's, or else the scene's."""
        if self.simulation is not None and self.simulation.tolerance is not None:
            return self.simulation.tolerance
        return self.accuracy.tolerance if "tolerance" in self.accuracy.model_fields_set else TOLERANCE

    @property
    def starts_unloaded(self) -> bool:
        """Whether its motion begins in the unloaded shape: by its key, or, by default, if something in it swings."""
        if self.simulation is None or self.simulation.start is None:
            return any(rod.base.free for rod in self.rods) or any(self._swings(joint) for joint in self.joints)
        return self.simulation.start == "unloaded"

    def _swings(self, joint: Joint) -> bool:
        """Whether a joint lets a rod at its base, or a body, with all that it carries, move without straining a rod."""
        if joint.keeps_place:
            return False
        if joint.carries is None:
            return joint.holds_base and self._dangles(joint, {joint.rod}, set())
        return any(self._dangles(joint, set(), {place.body}) for place in joint.places)

    def _dangles(self, joint: Joint, rods: set[str], bodies: set[str | None]) -> bool:
        """Whether this joint alone holds the rods and bodies at one of its ends, with all that they carry."""
        others = [other for other in self.joints if other is not joint]
        among_bodies = [{other.body, other.carries.body} for other in others if other.carries is not None]
        more = True
        while more:
            before = len(rods) + len(bodies)
            rods |= {rod.name for rod in self.rods if rod.base.rod in rods}
            bodies |= {other.body for other in others if other.body is not None and other.rod in rods}
            rods |= {other.rod for other in others if other.holds_base and other.body in bodies}
            bodies |= {body for link in among_bodies if link & bodies for body in link}
            more = len(rods) + len(bodies) > before
        # None stands for the world; a chain to the other end of the joint is held there.
        ends = {joint.body, joint.carries.body} if joint.carries is not None else {None}
        looped = None in bodies or ends <= bodies
        supported = any(support.rod in rods for support in self.supports)
        tied = [other for other in others if other.carries is None and not other.holds_base]
        in_world = any(other.rod in rods for other in tied if other.body is None)
        by_other_rods = any(other.rod not in rods for other in tied if other.body in bodies)
        return not (looped or supported or in_world or by_other_rods)

    def with_motion_inputs(self) -> Scene:
        """The scene in which the inputs of its motions are free too, after its free inputs."""
        # Several motions of one input add up.
        moving = dict.fromkeys(motion.input for motion in self.motions)
        return self._with_inputs(moving)

    def with_unknowns(self) -> Scene:
        """The scene in which inputs that measurements set are free, and unknowns are inputs or parameters.

        With measurements over time the inputs of its motions are free too.
        """
        names = [name for measurement in self.measurements for name in measurement.set_inputs]
        names += [unknown.input for unknown in self.unknowns if unknown.input is not None]
        # The same owners as in the rules: inputs of a load or an actuator hide those of a rod of the same name.
        owners = {record.name: record for record in (*self.rods, *self.tubes, *self.input_owners)}
        fields = []
        for name in names:
            owner, _, rest = name.partition(".")
            known = [field for field in owners[owner].inputs if rest == field or rest.startswith(f"{field}.")]
            fields.append(f"{owner}.{max(known, key=len)}")
        parameters: list[str | tuple[str, ...]] = [unknown.parameter for unknown in self.unknowns if unknown.parameter]
        further = [name for name in parameters if name not in self.parameters]
        if self.measured_over_time:
            fields += [motion.input for motion in self.motions]
        scene = self._with_inputs(dict.fromkeys(fields))
        if not further:
            return scene
        return scene.model_copy(update={"parameters": (*self.parameters, *further)})

    @property
    def measured_over_time(self) -> bool:
        """Whether there are measurements over time, in the motion of the scene."""
        return any(getattr(measurement, "time", None) is not None for measurement in self.measurements)

    def _with_inputs(self, names: Iterable[str]) -> Scene:
        """The scene in which these inputs are free too, after its free inputs."""
        free = self.input_names()
        further = [name for name in names if name not in free]
        if not further:
            return self
        return self.model_copy(update={"inputs": (*free, *further)})

    def held(self) -> Scene:
        """The scene with free bases clamped at their initial poses, where a motion begins, without velocities."""
        if not any(rod.base.free for rod in self.rods):
            return self
        rods = tuple(rod.model_copy(update={"base": rod.base.held()}) for rod in self.rods)
        velocities = tuple(velocity for velocity in self.velocities if velocity.rod is None)
        return self.model_copy(update={"rods": rods, "velocities": velocities})

    def of_equations(self) -> Scene:
        """The scene without the keys that do not enter the equations: title, motions, rates of rods, times.

        A body with a given velocity has its pose among the unknowns, for every value of the velocity.
        """
        of_bodies = tuple(InitialVelocity(body=velocity.body) for velocity in self.velocities if velocity.rod is None)
        without = {"title": "", "motions": (), "velocities": of_bodies, "simulation": None}
        return self.model_copy(update=without)

    def _named_input(self, name: str) -> FreeInput:
        owner, _, field = name.partition(".")
        # The rules have checked that every listed input has its owner and is one of its fields.
        records: dict[str | None, Rod | Load | Actuator | Joint] = {rod.name: rod for rod in self.rods}
        # Inputs of a load, an actuator or a joint hide those of a rod of the same name.
        for cause in self.input_owners:
            records[cause.name] = cause
        record = records[owner]
        return FreeInput(record, field, record.inputs[field])

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """Faults of tables that contradict each other, or that name something unknown."""
        yield from scene_faults(given)
