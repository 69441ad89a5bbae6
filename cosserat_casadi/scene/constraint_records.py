"""Bodies and constraints: supports hold tips of rods in the world, joints hold sections of rods at bodies.

A kind of support or joint is a record here and a class in `constraints/` that says which directions it holds.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import AfterValidator, Discriminator, Field

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.scene.families import Family
from cosserat_casadi.scene.faults import (
    Fault,
    SceneTables,
    Table,
    below,
    listing,
    numbers_of,
    refused_keys,
    shown,
    table_of,
)
from cosserat_casadi.scene.input_fields import InputField
from cosserat_casadi.scene.joint_ends import PLACE, end_faults
from cosserat_casadi.scene.orientations import Oriented
from cosserat_casadi.scene.reach_rules import named_rod, out_of_reach
from cosserat_casadi.scene.records import Entry, refusal, sound
from cosserat_casadi.scene.values import (
    SEVERAL,
    SINGLE,
    BodyName,
    Direction,
    Name,
    NotNegative,
    Number,
    Positive,
    Quadruple,
    Quaternion,
    Share,
    Triple,
    Vector,
    listed,
)

# Supports


class SupportRecord(Entry):
    """A support, which holds the tip of a rod in the world.

    Attributes:
        turns_freely: whether the tip may turn about every axis through it.
    """

    turns_freely: ClassVar[bool] = False
    references: ClassVar[Mapping[str, str]] = {"rod": "rods"}

    name: Name | None = Field(None, description="name of the support, a letter, then letters, digits and underscores")
    rod: str = Field(description="name of the rod whose tip it holds")
    position: Vector = Field(description="prescribed position of the tip in world axes, m")
    if TYPE_CHECKING:
        kind: str  # each member declares its own word, where it stands among its keys

    @classmethod
    def scene_conflicts(cls, given: Table, scene: SceneTables) -> Iterator[Fault]:
        """The rod reaches its support; tested if both are without faults and the rod starts in the world."""
        rod = named_rod(given.get("rod"), scene)
        support = sound(cls, given)
        if rod is None or support is None:
            return
        # The base of a carried or free rod is an unknown: the model checks the reach of its tip.
        if rod.base.rod is not None or rod.base.free:
            return
        for fault in out_of_reach(rod, support.position, support.orientation):
            yield Fault(fault.path, f"unreachable combination: {fault.problem}", fault.remedy)

    @property
    def orientation(self) -> Quadruple | None:
        """The prescribed orientation of the tip, w, x, y, z; None if the tip may turn."""
        return None


SUPPORTS: Family[SupportRecord] = Family("supports")
"""Kinds of supports."""


@SUPPORTS.register
class ClampedSupport(Oriented, SupportRecord):
    """Position and orientation of a tip are prescribed."""

    example: ClassVar[str] = """\
[[supports]]
rod = "finger"
kind = "clamped"
position = [0.1, 0, 0.1]
quaternion = [1, 0, 0, 0]
"""

    kind: Literal["clamped"] = Field(description="pose of the tip prescribed")
    quaternion: Quaternion = Field(description="prescribed orientation of the tip w, x, y, z, of norm 1, without unit")


@SUPPORTS.register
class PinnedSupport(SupportRecord):
    """The position of a tip is prescribed, its moment is free."""

    example: ClassVar[str] = """\
[[supports]]
rod = "finger"
kind = "pinned"
position = [0.1, 0, 0.1]
"""

    turns_freely: ClassVar[bool] = True
    kind: Literal["pinned"] = Field(description="position of the tip prescribed, moment free")


# The type checker knows the kinds that ship; a scene may hold any that is registered.
Support = Annotated[ClampedSupport | PinnedSupport, SUPPORTS]


# Bodies and joints

INERTIA_SLACK = 1e-9
"""Share of the largest entry of an inertia that may be rounding."""


def _moments_or_matrix(value: Any) -> str:
    if isinstance(value, list | tuple) and any(isinstance(row, list | tuple) for row in value):
        return SEVERAL.tag
    return SINGLE.tag


def _of_a_body(value: Triple | tuple[Triple, Triple, Triple]) -> Triple | tuple[Triple, Triple, Triple]:
    """Refuse an inertia that no distribution of mass can have."""
    inertia = _matrix(value)
    scale = np.abs(inertia).max()
    if scale == 0.0:
        return value
    # Relative to the largest entry, so that sums and differences do not overflow.
    relative = inertia / scale
    if np.abs(relative - relative.T).max() > INERTIA_SLACK:
        raise refusal([Fault((), "must be symmetric", "the inertia about the centre of mass, in the body's axes")])
    # In ascending order.
    smallest, middle, largest = np.linalg.eigvalsh(relative)
    if smallest < -INERTIA_SLACK:
        raise refusal([Fault((), f"must have no negative principal moment, got {smallest * scale:.6g}")])
    # Each moment is the integral of two squared coordinates: the sum of two moments is at least the third.
    if largest > smallest + middle + INERTIA_SLACK:
        listed_moments = ", ".join(f"{moment * scale:.6g}" for moment in (smallest, middle, largest))
        problem = f"no body has the principal moments {listed_moments}"
        raise refusal([Fault((), problem, "the largest is at most the sum of the other two")])
    return value


def _matrix(inertia: Triple | tuple[Triple, Triple, Triple]) -> FloatArray:
    """An inertia as a matrix (3, 3), from its diagonal or its rows."""
    given = np.asarray(inertia, dtype=float)
    if given.ndim == 1:
        return np.diag(given)
    return given


Inertia = Annotated[
    Annotated[Vector, SINGLE] | Annotated[tuple[Vector, Vector, Vector], listed(3, "3 rows of 3 numbers"), SEVERAL],
    Discriminator(_moments_or_matrix),
    AfterValidator(_of_a_body),
]


class Body(Entry):
    """A rigid body that rods carry."""

    example: ClassVar[str] = """\
[[bodies]]
name = "platform"
mass = 0.1
"""

    name: BodyName = Field(description="name of the body, a letter, then letters, digits and underscores")
    mass: NotNegative = Field(0.0, description="mass, kg")
    centre_of_mass: Vector = Field((0.0, 0.0, 0.0), description="centre of mass in the axes of the body, m")
    inertia: Inertia = Field(
        (0.0, 0.0, 0.0),
        description="moments of inertia about the centre of mass in the axes of the body, kg m²; three, or the rows of "
        "a symmetric matrix",
    )

    radius: Positive | None = Field(
        None, description="radius of the ball about its origin, which may not enter obstacles that name the body, m"
    )
    thickness: NotNegative | None = Field(
        None,
        description="with radius: thickness of a disk in place of the ball, square to its z axis, for contact at "
        "rest with obstacles without a width, m",
    )
    listed: bool = Field(
        True, description="false keeps the body out of results, as for disks and joints that are written as bodies"
    )

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """Require a radius of a disk; refuse names as ``spacers[0]``, which disks of rows and joints have."""
        if given.get("listed", True) and "[" in str(given.get("name", "")):
            problem = f"{shown(given['name'])} is the name of a disk of a row, or of a joint"
            yield Fault(("name",), problem, "use letters, digits and underscores")
        if "thickness" in given and "radius" not in given:
            yield Fault(("radius",), "missing", "thickness makes the ball of that radius a disk")

    @property
    def stands_for_entry(self) -> bool:
        """Whether reading wrote the body for a disk of a row or for a joint without a name, as ``spacers[0]``."""
        return "[" in self.name

    @property
    def ball_radius(self) -> float:
        """Radius of a body that an obstacle names, m."""
        assert self.radius is not None, "the rules of the scene ask for one"
        return self.radius

    @property
    def inertia_matrix(self) -> FloatArray:
        """Inertia about the centre of mass in the axes of the body, shape (3, 3), kg m²."""
        return _matrix(self.inertia)


class JointEnd(Oriented):
    """One end of a joint: a section of a rod, a place of a body, or a place in the world."""

    example: ClassVar[str] = """\
[[joints]]
kind = "spherical"
between = [{ rod = "finger", at = 0.5 }, { body = "platform", position = [0, 0, 0.1] }]     # or world = true
"""

    rod: str | None = Field(None, description="name of a rod, whose section at X = at is jointed")
    at: Share = Field(1.0, description="abscissa X of the section, without unit; 1 is the tip, 0 the base; with rod")
    body: str | None = Field(None, description="name of a body, instead of a rod")
    world: Literal[True] | None = Field(None, description="true for a place in the world, instead of a rod")
    position: Vector = Field((0.0, 0.0, 0.0), description="position of the joint in the body or in the world, m")
    quaternion: Quaternion = Field(
        (1.0, 0.0, 0.0, 0.0), description="orientation of the other end in the body or in the world, of norm 1"
    )


class CarriedBody(Oriented):
    """The body that another body, or the world, carries by a joint, with its place in that body."""

    example: ClassVar[str] = """\
[[joints]]
name = "pivot"
kind = "revolute"
position = [0, 0, 0.5]                                      # in the world; with body in another body
axis = [0, 1, 0]
carries = { body = "platform", position = [0, 0, 0.1] }     # instead of rod
"""

    body: str = Field(description="name of the body that is carried")
    position: Vector = Field((0.0, 0.0, 0.0), description="position of the joint in that body, m")
    quaternion: Quaternion = Field(
        (1.0, 0.0, 0.0, 0.0), description="orientation of the joint in that body, of norm 1, without unit"
    )


class JointRecord(Oriented, Entry):
    """A joint of a rod's section with a body or the world, or of a rod's base with what the base's table names.

    Instead of a section it may hold a body, at another body or in the world.

    Attributes:
        turns_freely: whether the section may turn about every axis through it.
    """

    turns_freely: ClassVar[bool] = False
    references: ClassVar[Mapping[str, str]] = {"body": "bodies", "rod": "rods"}

    name: Name | None = Field(None, description="name of the joint, a letter, then letters, digits and underscores")
    between: tuple[JointEnd, JointEnd] | None = Field(
        None,
        description='the two ends that are jointed, such as [{ rod = "upper" }, { rod = "lower", at = 0 }], in place '
        "of rod, at and body; a quaternion beside it is the orientation of the second in the first",
    )
    body: str | None = Field(
        None,
        description="name of the body; when left out, the joint is in the world or, with at = 0, where "
        "the base of the rod is, in the world or on another rod",
    )
    rod: str = Field("", description="name of the jointed rod; none where the joint carries a body")
    carries: CarriedBody | None = Field(
        None, description="body that is jointed instead of a rod: another body, or the world, carries it"
    )
    at: Share = Field(1.0, description="abscissa X of the jointed section, without unit; 1 is the tip, 0 the base")
    position: Vector = Field((0.0, 0.0, 0.0), description="position of the joint in the body or in the world, m")
    quaternion: Quaternion = Field(
        (1.0, 0.0, 0.0, 0.0), description="orientation of the section in the body or in the world, of norm 1"
    )
    if TYPE_CHECKING:
        kind: str  # each member declares its own word, where it stands among its keys

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """Require two ends of the joint, and a place in the world; refuse a place or an orientation of a base."""
        yield from super().conflicts(given)
        if "between" in given:
            yield from below(("between",), end_faults(given["between"]))
            return
        if "carries" in given:
            remedy = "a joint holds a section of a rod, or a body"
            yield from refused_keys(given, ("rod", "at"), "stands beside carries", remedy)
        elif "rod" not in given:
            yield Fault(("rod",), "missing", "name the rod, the two ends as between = …, or the body that it carries")
        if "body" in given:
            return
        if given.get("at") == 0:
            remedy = "give it to the base of the rod, which says where the joint is"
            yield from refused_keys(given, PLACE, "stands in a joint at X = 0 without body", remedy)
        elif "position" not in given and ("carries" not in given or sound(CarriedBody, given["carries"]) is not None):
            yield Fault(("position",), "missing", "name a body, or say where in the world the joint is, m")

    @classmethod
    def scene_conflicts(cls, given: Table, scene: SceneTables) -> Iterator[Fault]:
        """A base that a joint holds is not free, and starts at the section that carries it; bodies are there."""
        carried = table_of(given.get("carries")).get("body")
        bodies = scene.named("bodies")
        if isinstance(carried, str) and carried not in bodies:
            problem = f"no body is named {shown(carried)}"
            yield Fault(("carries", "body"), problem, listing(bodies, "bodies"))
        elif isinstance(carried, str) and carried == given.get("body"):
            yield Fault(("carries", "body"), "a body cannot carry itself", "name another body, or leave body out")
        base = table_of(scene.table_named("rods", given.get("rod")).get("base"))
        if given.get("at") != 0:
            return
        if base.get("free") is True:
            yield Fault(("at",), "holds a base that is free", "leave base.free out: the joint says what is free")
        if "rod" in base and "body" in given:
            yield Fault(("body",), f"the base of {shown(given['rod'])} is on another rod", "leave one of them out")
        elif "rod" in base and any(numbers_of(base.get("position"))):
            problem = f"the base of {shown(given['rod'])} is beside the section that carries it"
            yield Fault(("at",), problem, "leave base.position out, or hold a body there by a fixed joint")

    def parameter_refusal(self, key: str) -> tuple[str, str] | None:
        """Parameters cannot change whether the joint is at the base of a rod."""
        if key == "at" and self.holds_base:
            return "is the base of its rod", "only the place of a joint inside a rod can be a parameter"
        return super().parameter_refusal(key)

    @property
    def holds_base(self) -> bool:
        """Whether the jointed section is the base of its rod, which then floats."""
        # An abscissa that is an expression of parameters belongs to a section inside the rod.
        return isinstance(self.at, float) and self.at == 0.0

    @property
    def at_base(self) -> bool:
        """Whether the joint holds the base of its rod to the world or another rod, as the base's table says."""
        return self.body is None and self.holds_base

    @property
    def places(self) -> tuple[JointRecord | CarriedBody, ...]:
        """The records with its places in the bodies at its ends: itself, and the carried body."""
        ends = (None if self.body is None else self, self.carries)
        return tuple(end for end in ends if end is not None)

    @property
    def has_coordinate(self) -> bool:
        """Whether something acts along a coordinate that the joint leaves free."""
        return False

    @property
    def rubs(self) -> bool:
        """Whether friction acts along a coordinate that the joint leaves free."""
        return False

    @property
    def keeps_place(self) -> bool:
        """Whether the joint leaves no motion free, or a spring or a drive holds the free coordinate."""
        return False


JOINTS: Family[JointRecord] = Family("joints")
"""Kinds of joints."""


@JOINTS.register
class FixedJoint(JointRecord):
    """A section of a rod is clamped in a body."""

    example: ClassVar[str] = """\
[[joints]]
rod = "finger"
body = "platform"
kind = "fixed"
position = [0.02, 0, 0]
"""

    kind: Literal["fixed"] = Field(description="the section is clamped in the body")

    @property
    def keeps_place(self) -> bool:
        """True, since a fixed joint leaves no motion free."""
        return True


@JOINTS.register
class SphericalJoint(JointRecord):
    """A section of a rod stays at a point of a body and turns freely."""

    example: ClassVar[str] = """\
[[joints]]
rod = "finger"
body = "platform"
kind = "spherical"
position = [0.02, 0, 0]
"""

    turns_freely: ClassVar[bool] = True
    kind: Literal["spherical"] = Field(description="the section stays at a point of the body and turns freely")


STOP_KEYS = ("lower_stop", "upper_stop")
"""Keys of the least and the largest value of a coordinate."""


class AxisJoint(JointRecord):
    """A joint that leaves one coordinate free, along which springs, dampers, stops, motors or drives may act.

    Attributes:
        coordinate_key: key that prescribes the coordinate.
        effort_key: key of the motor that does work on it.
    """

    coordinate_key: ClassVar[str]
    effort_key: ClassVar[str]

    axis: Direction = Field(
        description="axis through the joint's position in the axes of the body, the world or the carrying section, "
        "without unit; any length but zero"
    )
    if TYPE_CHECKING:
        stiffness: float  # in the units of the kind, as those that follow
        rest: float
        damping: float
        friction: float
        slip_rate: float
        lower_stop: float | None
        upper_stop: float | None
        stop_stiffness: float | None
    restitution: Share = Field(
        0.0, description="share of the speed that is left after the joint has hit a stop, in motion, without unit"
    )

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """A drive prescribes the coordinate: nothing else acts on it. Inputs have a name. Stops leave a range."""
        yield from super().conflicts(given)
        if cls.coordinate_key in given:
            acting = (cls.effort_key, "stiffness", "rest", "damping", "friction", *STOP_KEYS)
            remedy = "a drive prescribes it: leave one of them out"
            yield from refused_keys(given, acting, f"stands beside {cls.coordinate_key}", remedy)
        if "rest" in given and "stiffness" not in given:
            yield Fault(("stiffness",), "missing", "rest is where a spring is unloaded")
        if "slip_rate" in given and "friction" not in given:
            yield Fault(("slip_rate",), "belongs to friction, and the joint has none", "give it friction")
        if not any(stop in given for stop in STOP_KEYS):
            remedy = "give lower_stop, upper_stop or both"
            of_stops = ("restitution", "stop_stiffness")
            yield from refused_keys(given, of_stops, "belongs to a stop, and the joint has none", remedy)
        if "restitution" in given and "stop_stiffness" in given:
            problem = "stands beside stop_stiffness, and an elastic stop returns all energy"
            yield Fault(("restitution",), problem, "leave one of them out")
        lower, upper = (given.get(key) for key in STOP_KEYS)
        if isinstance(lower, int | float) and isinstance(upper, int | float) and not lower < upper:
            problem = f"must be > lower_stop = {shown(lower)}, got {shown(upper)}"
            yield Fault(("upper_stop",), problem, "a joint that cannot move is fixed, or has a drive")
        if "name" not in given and (cls.coordinate_key in given or cls.effort_key in given):
            yield Fault(("name",), "missing", "a drive or a motor is an input, which the joint names")

    def parameter_refusal(self, key: str) -> tuple[str, str] | None:
        """A default may be a parameter only if something acts along the coordinate and no drive prescribes it."""
        acts = self.has_coordinate and not self.prescribed
        if key in ("stiffness", "rest", "damping", "friction", "slip_rate") and not acts:
            return "is not given in the scene", "give it a value: the parameter's default"
        return super().parameter_refusal(key)

    @classmethod
    def input_conflicts(cls, field: str, given: Table, scene: SceneTables) -> Iterator[Fault]:
        """A joint has the drive that its table gives it."""
        if field not in given:
            name = shown(given["name"])
            yield Fault((), f"{name} has no {field}", f"give it one, such as {field} = 0.0")

    @property
    def prescribed(self) -> bool:
        """Whether a drive prescribes the coordinate."""
        return getattr(self, self.coordinate_key) is not None

    @property
    def keeps_place(self) -> bool:
        """Whether a spring or a drive holds the coordinate."""
        # A stiffness that is an expression of parameters counts as a spring.
        return self.prescribed or not (isinstance(self.stiffness, float) and self.stiffness == 0.0)

    @property
    def rubs(self) -> bool:
        """Whether friction acts along the coordinate."""
        return not (isinstance(self.friction, float) and self.friction == 0.0)

    @property
    def has_stops(self) -> bool:
        """Whether a stop holds the coordinate at one end or both."""
        return self.lower_stop is not None or self.upper_stop is not None

    @property
    def has_coordinate(self) -> bool:
        """Whether something acts along the coordinate."""
        acting = (self.coordinate_key, self.effort_key, "stiffness", "damping", "friction", *STOP_KEYS)
        return any(getattr(self, key) is not None and key in self.model_fields_set for key in acting)


@JOINTS.register
class RevoluteJoint(AxisJoint):
    """A section of a rod stays at a point of a body, the world or another rod and turns about one axis.

    Its angle is counted from the orientation that the joint gives the section.
    """

    example: ClassVar[str] = """\
[[joints]]
name = "hinge"
rod = "finger"
body = "platform"
kind = "revolute"
position = [0.02, 0, 0]
axis = [0, 1, 0]
stiffness = 0.3            # or angle = 0.0: a drive, as an input
damping = 0.001
moment = 0.0               # of a motor, an input
upper_stop = 0.8           # rad; and lower_stop, stop_stiffness or restitution
"""

    coordinate_key: ClassVar[str] = "angle"
    effort_key: ClassVar[str] = "moment"
    namesakes: ClassVar[Mapping[str, str]] = {"displacement": "angle", "force": "moment"}
    inputs: ClassVar[Mapping[str, InputField]] = {
        "angle": InputField("rad", 1, continuous=True, nonlinear=True),
        "moment": InputField("N m", 1),
    }

    kind: Literal["revolute"] = Field(description="the section stays at a point and turns about one axis")
    stiffness: NotNegative = Field(0.0, description="moment of a spring by its angle, N m/rad")
    rest: Number = Field(0.0, description="angle at which the spring is unloaded, rad")
    damping: NotNegative = Field(0.0, description="moment by the rate of the angle, in motion, N m s/rad")
    friction: NotNegative = Field(0.0, description="moment of Coulomb's friction against the rate, in motion, N m")
    slip_rate: Positive = Field(
        1e-2, description="with friction: rate, rad/s, below which a hinge that sticks creeps, in motion"
    )
    lower_stop: Number | None = Field(None, description="least angle, where a stop holds the joint, rad")
    upper_stop: Number | None = Field(None, description="largest angle, where a stop holds the joint, rad")
    stop_stiffness: Positive | None = Field(
        None, description="moment of an elastic stop by the angle beyond it, N m/rad; left out, stops are rigid"
    )
    angle: Number | None = Field(None, description="angle of a drive, which prescribes it, rad; any number of turns")
    moment: Number | None = Field(None, description="moment of a motor on the section about the axis, N m")


@JOINTS.register
class PrismaticJoint(AxisJoint):
    """A section of a rod slides along one axis of a body, the world or another rod and does not turn.

    Its displacement is counted from the position that the joint gives the section.
    """

    example: ClassVar[str] = """\
[[joints]]
name = "slide"
rod = "finger"
body = "platform"
kind = "prismatic"
position = [0.02, 0, 0]
axis = [1, 0, 0]
displacement = 0.0         # of a drive, an input; or stiffness, rest, damping and force
"""

    coordinate_key: ClassVar[str] = "displacement"
    effort_key: ClassVar[str] = "force"
    namesakes: ClassVar[Mapping[str, str]] = {"angle": "displacement", "moment": "force"}
    inputs: ClassVar[Mapping[str, InputField]] = {
        "displacement": InputField("m", 1, continuous=True, nonlinear=True),
        "force": InputField("N", 1),
    }

    kind: Literal["prismatic"] = Field(description="the section slides along one axis and does not turn")
    stiffness: NotNegative = Field(0.0, description="force of a spring by its displacement, N/m")
    rest: Number = Field(0.0, description="displacement at which the spring is unloaded, m")
    damping: NotNegative = Field(0.0, description="force by the speed of the slide, in motion, N s/m")
    friction: NotNegative = Field(0.0, description="force of Coulomb's friction against the speed, in motion, N")
    slip_rate: Positive = Field(
        1e-3, description="with friction: speed, m/s, below which a slide that sticks creeps, in motion"
    )
    lower_stop: Number | None = Field(None, description="least displacement, where a stop holds the joint, m")
    upper_stop: Number | None = Field(None, description="largest displacement, where a stop holds the joint, m")
    stop_stiffness: Positive | None = Field(
        None, description="force of an elastic stop by the displacement beyond it, N/m; left out, stops are rigid"
    )
    displacement: Number | None = Field(None, description="displacement of a drive, which prescribes it, m")
    force: Number | None = Field(None, description="force of a motor on the section along the axis, N")


# The type checker knows the kinds that ship; a scene may hold any that is registered.
Joint = Annotated[FixedJoint | SphericalJoint | RevoluteJoint | PrismaticJoint, JOINTS]
