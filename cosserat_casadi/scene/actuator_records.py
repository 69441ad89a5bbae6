"""Actuators: tendons, pressure chambers and muscles along a rod.

A kind is a record here and a class in `actuators/` that gives the quantity on which its effort does work.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, BeforeValidator, Field, StrictBool, WithJsonSchema

from cosserat_casadi.scene.families import Family
from cosserat_casadi.scene.faults import (
    Fault,
    SceneTables,
    Table,
    not_ascending,
    numbers_of,
    one_of,
    refused_keys,
    shown,
    table_of,
)
from cosserat_casadi.scene.input_fields import InputField
from cosserat_casadi.scene.load_records import force_or_moment
from cosserat_casadi.scene.records import Entry, Record, refusal
from cosserat_casadi.scene.values import (
    LegendreComponent,
    Name,
    NotEmpty,
    NotNegative,
    Number,
    PoissonRatio,
    Positive,
    PowerComponent,
    Share,
    Vector,
    listed,
)


class ActuatorRecord(Entry):
    """An actuator inside a rod, which acts between its sections."""

    references: ClassVar[Mapping[str, str]] = {"rod": "rods"}

    name: Name = Field(description="name of the actuator, a letter, then letters, digits and underscores")
    if TYPE_CHECKING:
        kind: str  # each member declares these two itself, where they stand among its keys
        rod: str

    @property
    def has_kinks(self) -> bool:
        """Whether its pull may have a kink along the rod."""
        return False


ACTUATORS: Family[ActuatorRecord] = Family("actuators")
"""Kinds of actuators."""


def _base_side_first(value: tuple[float, float]) -> tuple[float, float]:
    if not value[0] < value[1]:
        problem = f"must begin before it ends, got {list(value)}"
        fault = Fault((), problem, "two abscissae X, base side first")
        raise refusal([fault])
    return value


Offset = Annotated[tuple[PowerComponent, PowerComponent], listed(2, "2 components, x and y")]
Span = Annotated[tuple[Share, Share], listed(2, "2 abscissae"), AfterValidator(_base_side_first)]

PULLS = {"in": 1.0, "out": -1.0}
"""Directions of the last pull, with the sign of the friction in it."""


def _faults_of_holes(given: Table) -> Iterator[Fault]:
    """Holes ascend within the span; reading has turned a routing through disks into holes, if there are disks."""
    if given.get("routing") == "disks":
        problem = "stands beside holes" if "holes" in given else "no disk of its rod is in its span"
        yield Fault(("routing",), problem, "give [[disks]] with its rod, or holes")
    places = numbers_of(given.get("holes"))
    ends = numbers_of(given.get("span", [0.0, 1.0]))
    yield from not_ascending(places, ("holes",), "hole")
    if len(ends) == 2:
        for i, at in enumerate(places):
            if not ends[0] <= at <= ends[1]:
                yield Fault(("holes", i), f"must be within its span, {ends[0]:g} to {ends[1]:g}, got {shown(at)}")


def _direction_of_pull(value: Any) -> Any:
    if isinstance(value, str) and value in PULLS:
        return PULLS[value]
    # Truth values are integers in Python.
    number = isinstance(value, int | float) and not isinstance(value, bool)
    if not number or not -1.0 <= value <= 1.0:
        raise refusal([Fault((), f"must be 'in' or 'out', or from -1 to 1, got {shown(value)}")])
    return float(value)


Pull = Annotated[
    float,
    BeforeValidator(_direction_of_pull),
    WithJsonSchema(
        {"anyOf": [{"enum": list(PULLS), "type": "string"}, {"type": "number", "minimum": -1, "maximum": 1}]}
    ),
]


class Helix(Record):
    """A tendon that winds round the rod: offset = radius (cos, sin)(2π turns X + phase)."""

    example: ClassVar[str] = """\
helix = { radius = 1.5e-3, turns = 1.0 }
"""

    radius: Positive = Field(description="distance from the centreline, m")
    turns: Number = Field(description="turns over the whole rod, negative for a left-handed helix, without unit")
    phase: Number = Field(0.0, description="angle at X = 0 from local x, rad")


@ACTUATORS.register
class Tendon(ActuatorRecord):
    """A cable led through the sections and anchored at the end of its span."""

    example: ClassVar[str] = """\
[[actuators]]
name = "cable"
kind = "tendon"
rod = "finger"
tension = 3.0
offset = [1.5e-3, 0.0]
"""

    inputs: ClassVar[Mapping[str, InputField]] = {
        "tension": InputField("N", 1, lower=0.0),
        "length": InputField("m", 1, positive=True, continuous=True, nonlinear=True),
        "pull": InputField("1", 1, lower=-1.0, upper=1.0, on_request=True, nonlinear=True),
    }

    kind: Literal["tendon"] = Field(description="cable led along the rod")
    rod: str = Field(description="name of the rod that it pulls")
    tension: NotNegative | None = Field(None, description="tension, N; or length")
    length: Positive | None = Field(
        None, description="length of the cable along its span, m; its tension is then an unknown"
    )
    slack: StrictBool = Field(
        False, description="whether a cable of given length may go slack, so that it never pushes"
    )
    friction: NotNegative = Field(
        0.0,
        description="coefficient μ of friction along the course, without unit; T(X) = T₀ exp(−μ φ), φ the angle turned",
    )
    pull: Pull = Field(
        1.0,
        description="direction of the last pull at the base: 'in' (or 1) loses tension along the course, "
        "'out' (or −1) gains it, without unit; values between stand for a reversal",
    )
    axial_stiffness: Positive | None = Field(
        None, description="stiffness EA of the cable, N; one of given length does not stretch where it is left out"
    )
    winch_stiffness: Positive | None = Field(
        None, description="stiffness of what holds a cable of given length at its base, N/m; rigid where it is left out"
    )
    pretension: NotNegative = Field(
        0.0, description="tension at which an elastic cable has the given length, N; length is that at rest without it"
    )
    offset: Offset | None = Field(
        None, description="place in the section, x and y, m; a component may list polynomial coefficients in X"
    )
    helix: Helix | None = Field(None, description="helical course round the centreline, instead of offset")
    span: Span = Field((0.0, 1.0), description="abscissae X where it enters the rod and where it is anchored")
    routing: Literal["continuous", "disks"] = Field(
        "continuous",
        description="'disks': straight between holes in the disks of its rod within its span, read as holes",
    )
    holes: Annotated[tuple[Share, ...], NotEmpty()] | None = Field(
        None,
        description="abscissae X of holes within its span, ascending, without unit, between which it is straight; a "
        "continuous course when left out",
    )

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """Require one of tension and length, and one of offset and helix."""
        yield from _faults_of_holes(given)
        yield from one_of("tension", "length", given)
        yield from one_of("offset", "helix", given)
        # Only an unknown tension can have zero as its lower bound.
        if given.get("slack") is True and "length" not in given:
            yield Fault(("slack",), "is for a tendon of given length", "leave it out: the tension is given")
        if "length" not in given:
            of_length = ("axial_stiffness", "winch_stiffness", "pretension")
            remedy = "leave it out: the tension is given"
            yield from refused_keys(given, of_length, "is for a tendon of given length", remedy)
        elastic = "axial_stiffness" in given or "winch_stiffness" in given
        if "pretension" in given and not elastic:
            remedy = "give axial_stiffness or winch_stiffness: the tension of a rigid cable follows from its length"
            yield Fault(("pretension",), "is for an elastic cable", remedy)
        if "pull" in given and not given.get("friction"):
            yield Fault(("pull",), "stands without friction", "the direction of the last pull is that of friction")

    @classmethod
    def scene_conflicts(cls, given: Table, scene: SceneTables) -> Iterator[Fault]:
        """A straight course between holes needs the rotations of their sections."""
        if "holes" in given and table_of(scene.get("accuracy")).get("rotation") == "permuted":
            problem = "does not go with accuracy.rotation = 'permuted'"
            yield Fault(("holes",), problem, "use a product of exponentials, or a continuous course")

    @property
    def has_kinks(self) -> bool:
        """A continuous cable with friction has a kink where it is straight."""
        return self.friction > 0.0 and self.holes is None

    @classmethod
    def free_fields(cls, given: Table) -> tuple[str, ...]:
        """Fields that may be free: tension or length, by the keys of the table; the direction of friction."""
        fields = [field for field in ("tension", "length") if field in given]
        if given.get("friction"):
            fields.append("pull")
        # A table with neither has a fault already; both are known names.
        if not fields:
            return tuple(cls.inputs)
        return tuple(fields)


class ChamberWall(Record):
    """The round wall of a chamber, which widens under pressure."""

    example: ClassVar[str] = """\
wall = { inner_radius = 3.0e-3, outer_radius = 5.0e-3, youngs_modulus = 2.6e5 }
"""

    inner_radius: Positive = Field(description="radius of the chamber without pressure, m")
    outer_radius: Positive = Field(description="outer radius of the wall, m")
    youngs_modulus: Positive = Field(description="Young's modulus of the wall, Pa")
    poisson_ratio: PoissonRatio = Field(0.5, description="Poisson's ratio of the wall, without unit")
    reinforced: StrictBool = Field(False, description="whether fibres round the wall keep it from widening")

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """The wall lies outside of the chamber."""
        radii = [*numbers_of(given.get("inner_radius")), *numbers_of(given.get("outer_radius"))]
        if len(radii) == 2 and not radii[0] < radii[1]:
            problem = f"must be larger than inner_radius, got {radii[1]:g} and {radii[0]:g}"
            yield Fault(("outer_radius",), problem, "a wall has a thickness")


@ACTUATORS.register
class Chamber(ActuatorRecord):
    """A pressurised channel along the rod, whose cross-section may widen with the pressure."""

    example: ClassVar[str] = """\
[[actuators]]
name = "bellows"
kind = "chamber"
rod = "finger"
pressure = 1.0e4
area = 2.0e-6
offset = [0.0, 1.0e-3]
area_growth = [0.3, 0.1]
reference_pressure = 2.0e4
"""

    inputs: ClassVar[Mapping[str, InputField]] = {"pressure": InputField("Pa", 1)}

    kind: Literal["chamber"] = Field(description="pressurised channel along the rod")
    rod: str = Field(description="name of the rod that it pushes")
    pressure: Number = Field(description="pressure above that outside, Pa")
    area: Positive | None = Field(None, description="cross-section of the channel without pressure, m²; or wall")
    wall: ChamberWall | None = Field(
        None, description="round wall from which area and area_growth follow: thick-walled cylinder"
    )
    area_growth: tuple[Number, ...] = Field(
        (),
        description="coefficients c of area(p) = area (1 + c₁ (p/p₀) + c₂ (p/p₀)² + …), p₀ the reference pressure, "
        "without unit",
    )
    offset_growth: tuple[Number, ...] = Field(
        (),
        description="coefficients c of offset(p) = offset (1 + c₁ (p/p₀) + …), as the wall moves "
        "outwards, without unit",
    )
    reference_pressure: Positive | None = Field(None, description="pressure p₀ of the growths, Pa")
    offset: Offset = Field(
        (0.0, 0.0), description="place in the section, x and y, m; a component may list polynomial coefficients in X"
    )
    span: Span = Field((0.0, 1.0), description="abscissae X between which the channel runs")

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """Require one of area and wall, and growths with their reference pressure."""
        yield from one_of("area", "wall", given)
        if "wall" in given and "area_growth" in given:
            yield Fault(("area_growth",), "stands beside wall", "it follows from the wall: leave one of them out")
        grows = "area_growth" in given or "offset_growth" in given
        if grows and "reference_pressure" not in given:
            yield Fault(("reference_pressure",), "missing", "the growths are polynomials of the pressure over it, Pa")
        if "reference_pressure" in given and not grows:
            yield Fault(("reference_pressure",), "stands without area_growth and offset_growth", "leave it out")


def _faults_of_knots(given: Table) -> Iterator[Fault]:
    """Knots ascend from the beginning of the span to its end, and each has a value."""
    knots = numbers_of(given.get("knots"))
    span = numbers_of(given.get("span", [0.0, 1.0]))
    profile = given.get("profile")
    if len(knots) < 2:
        yield Fault(("knots",), f"must be at least 2 abscissae, got {len(knots)}", "leave them out for one value")
        return
    yield from not_ascending(knots, ("knots",), "knot")
    if len(span) == 2 and not (knots[0] <= span[0] and span[1] <= knots[-1]):
        problem = f"must reach over its span, {span[0]:g} to {span[1]:g}, got {knots[0]:g} to {knots[-1]:g}"
        yield Fault(("knots",), problem)
    if not isinstance(profile, list | tuple) or len(profile) != len(knots):
        got = len(profile) if isinstance(profile, list | tuple) else shown(profile)
        yield Fault(("profile",), f"must be a list of {len(knots)} values, one for each knot, got {got}")


@ACTUATORS.register
class Muscle(ActuatorRecord):
    """An active moment and force, or an unloaded curvature: activation × profile(X) × its value at activation 1."""

    example: ClassVar[str] = """\
[[actuators]]
name = "bender"
kind = "muscle"
rod = "finger"
activation = 0.5
moment = [0, 2.0e-3, 0]
profile = { base = 1.0, tip = 0.2 }
"""

    inputs: ClassVar[Mapping[str, InputField]] = {
        "activation": InputField("1", 1),
        "profile": InputField("1", 1, polynomial=True, on_request=True),
    }

    kind: Literal["muscle"] = Field(description="active moment and force in the sections of a rod")
    rod: str = Field(description="name of the rod that it bends, twists, shears or stretches")
    activation: Number = Field(1.0, description="factor on moment, force and curvature, without unit")
    moment: Vector = Field(
        (0.0, 0.0, 0.0), description="moment in section axes that bends and twists the rod at activation 1, N m"
    )
    force: Vector = Field(
        (0.0, 0.0, 0.0), description="force in section axes that shears and stretches the rod at activation 1, N"
    )
    curvature: Vector = Field(
        (0.0, 0.0, 0.0),
        description="unloaded curvature about the section axes that is added to the rod's at activation 1, 1/m",
    )
    profile: LegendreComponent = Field(
        1.0,
        description="factor on these along the rod, without unit; a list is of Legendre coefficients in 2X − 1, or of "
        "values at knots",
    )
    knots: tuple[Share, ...] | None = Field(
        None,
        description="abscissae X, ascending over its span, without unit, at which profile lists its values: a cubic "
        "spline between them, whose slope is zero at both ends",
    )
    offset: Offset = Field(
        (0.0, 0.0),
        description="place in the section that the force acts at, x and y, m; a component may list polynomial "
        "coefficients in X",
    )
    span: Span = Field((0.0, 1.0), description="abscissae X between which it acts")

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """A muscle has a force, a moment or a curvature, and as many values as knots."""
        if "curvature" not in given:
            yield from force_or_moment(given)
        if "knots" in given:
            yield from _faults_of_knots(given)

    @classmethod
    def scene_conflicts(cls, given: Table, scene: SceneTables) -> Iterator[Fault]:
        """An unloaded curvature needs a stiffness with one number for each strain, which turns it into a moment."""
        rod = scene.table_named("rods", given.get("rod"))
        law = table_of(rod.get("material")).get("law", "linear")
        if "curvature" in given and (law != "linear" or "stiffness_matrix" in rod):
            yield Fault(("curvature",), "is for a rod with one stiffness for each strain", "give its moment")

    def parameter_refusal(self, key: str) -> tuple[str, str] | None:
        """Knots cannot be parameters."""
        if key == "knots":
            return "is where the values of profile stand", "let the values be parameters: profile"
        return super().parameter_refusal(key)


# The type checker knows the kinds that ship; a scene may have any registered kind.
Actuator = Annotated[Tendon | Chamber | Muscle, ACTUATORS]
