"""Obstacles, which rods may not enter, and lumens, which they may not leave.

A kind is a record here and a class in `obstacles/` with the distance of a point from its surface.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from math import inf
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import Discriminator, Field, Tag

from cosserat_casadi.scene.disk_record import Disks
from cosserat_casadi.scene.families import Family
from cosserat_casadi.scene.faults import Fault, SceneTables, Table, list_of, numbers_of, refused_keys
from cosserat_casadi.scene.records import Entry, Record, sound
from cosserat_casadi.scene.rod_records import admitted_strains, is_round
from cosserat_casadi.scene.values import (
    SINGLE,
    Direction,
    Name,
    Names,
    NotEmpty,
    NotNegative,
    Positive,
    PositiveComponent,
    Share,
    Vector,
)

SHEARS = {3, 4}
"""Indices of the shears among the strains."""

SMOOTH_KEYS = ("width", "stiffness", "damping", "slip_speed")
"""Keys of obstacles with smooth contact."""

SMOOTH_NUMBERS = ("width", "stiffness")
"""Keys of obstacles with smooth contact that may be parameters."""

SMOOTH_FORM = "give the obstacle a width, m, for a contact that is smooth, as in width = 1e-3"
"""Remedy for exact contact that is not supported."""

FEWEST_POINTS = 2
"""Least number of points of a lumen."""


class Friction(Record):
    """Coulomb's coefficients in the directions of a rod that slides."""

    example: ClassVar[str] = """\
friction = { along = 0.1, back = 0.4, across = 0.2 }
"""

    along: NotNegative = Field(description="coefficient where a section slides along its tangent, without unit")
    back: NotNegative | None = Field(
        None, description="coefficient against its tangent, without unit; along when left out"
    )
    across: NotNegative | None = Field(
        None, description="coefficient across the rod, without unit; along when left out"
    )


TABLE = Tag("⟨table⟩")


def _number_or_table(value: Any) -> str:
    return TABLE.tag if isinstance(value, Mapping | Friction) else SINGLE.tag


Coefficients = Annotated[
    Annotated[NotNegative, SINGLE] | Annotated[Friction, TABLE],
    Discriminator(_number_or_table),
]
"""A coefficient of friction in all directions, or coefficients along the rod's own directions."""


class ObstacleRecord(Entry):
    """An obstacle: centre lines of rods keep away from it by the radius of their sections, bodies by their radius.

    Contact without a width is exact and is found at rest; contact with a width is smooth, a load like any other.

    Attributes:
        is_flat: whether its surface is a plane.
    """

    is_flat: ClassVar[bool] = False

    references: ClassVar[Mapping[str, str]] = {"rods": "rods", "bodies": "bodies", "disks": "disks", "body": "bodies"}

    name: Name = Field(description="name of the obstacle, a letter, then letters, digits and underscores")
    body: str | None = Field(
        None,
        description="name of the body that it is fixed to and moves with, in whose axes it is given; it stands still "
        "in the world when left out",
    )
    rods: Names | None = Field(
        None,
        description="names of the rods that may not enter it; all rods when neither rods, bodies nor disks are named; "
        "with body they must be named",
    )
    bodies: Names | None = Field(
        None,
        description="names of the bodies that may not enter it, as balls of their radius about their origin; none when "
        "left out",
    )
    disks: Names | None = Field(
        None,
        description="with width, or of a plane: names of the rows of disks that may not enter it, as far as each "
        "reaches along the normal; none when left out",
    )
    width: Positive | None = Field(
        None,
        description="gap from which on it pushes, smoothly, m; when left out rods touch it exactly, which is found at "
        "rest and in motion",
    )
    stiffness: Positive | None = Field(
        None,
        description="with width: slope of the force per length against the gap, where the gap is zero, N/m²; "
        "30 EI/(L² width²) of each rod when left out",
    )
    damping: NotNegative = Field(
        0.0, description="with width: relative increase of its push in motion, per speed of approach, s/m"
    )
    friction: Coefficients = Field(
        0.0,
        description="coefficient μ of Coulomb's friction, without unit, or a table of coefficients along "
        "a rod, back and across it: in motion, and along paths; without a width a table acts in motion alone",
    )
    slip_speed: Positive = Field(
        1e-3,
        description="with width and friction: speed, m/s, below which a contact that sticks creeps in "
        "motion, under a force that grows with the speed",
    )
    restitution: Share = Field(
        0.0,
        description="without width: speed after an impact in motion over the speed of approach, without unit",
    )
    if TYPE_CHECKING:
        kind: str  # each member declares its own word, where it stands among its keys

    @property
    def thickness(self) -> float:
        """Distance through the obstacle to its other side, m; infinite for an obstacle without another side."""
        return inf

    @property
    def is_smooth(self) -> bool:
        """Whether the obstacle has a width, and so smooth contact."""
        return self.width is not None

    @property
    def coefficients(self) -> tuple[float, float, float]:
        """Coefficients of friction along a rod, back, and across it."""
        friction = self.friction
        if not isinstance(friction, Friction):
            return friction, friction, friction
        back = friction.along if friction.back is None else friction.back
        across = friction.along if friction.across is None else friction.across
        return friction.along, back, across

    @property
    def rubs(self) -> bool:
        """Whether there is friction."""
        return max(self.coefficients) > 0.0

    @property
    def rubs_on_paths(self) -> bool:
        """Whether there is friction on rods along paths: without a width by one coefficient, not a table."""
        return self.rubs and self.presses_rods and (self.is_smooth or len(set(self.coefficients)) == 1)

    @property
    def presses_rods(self) -> bool:
        """Whether it acts on rods: it names some, or neither bodies nor disks."""
        return self.rods is not None or (self.bodies is None and self.disks is None)

    def concerns(self, rod: str) -> bool:
        """Whether the rod of this name may not enter it."""
        return self.presses_rods if self.rods is None else rod in self.rods

    def concerns_body(self, body: str) -> bool:
        """Whether the body of this name may not enter it."""
        return self.bodies is not None and body in self.bodies

    def concerns_disks(self, row: str | None) -> bool:
        """Whether the disks of the row of this name may not enter it."""
        return self.disks is not None and row in self.disks

    def parameter_refusal(self, key: str) -> tuple[str, str] | None:
        """Refuse parameters other than the push of smooth contact: the rest decides where contacts are searched."""
        if key in SMOOTH_NUMBERS:
            return super().parameter_refusal(key)
        problem = f"{key} of an obstacle decides where contacts are looked for, or how, and is no parameter"
        return problem, f"take one of {', '.join(SMOOTH_NUMBERS)} of a contact that is smooth, or move what touches it"

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """Faults of keys of smooth contact without a width, and of obstacles on bodies."""
        yield from _misplaced_on_body(given)
        if "width" in given:
            if "restitution" in given:
                problem = "describes impacts, which a smooth contact does not have"
                yield Fault(("restitution",), problem, "give damping, s/m, or leave out the width")
            return
        problem = "describes a smooth contact, and contact without a width is exact"
        yield from refused_keys(given, SMOOTH_KEYS[1:], problem, "give width, m, or leave it out")

    @classmethod
    def scene_conflicts(cls, given: Table, scene: SceneTables) -> Iterator[Fault]:
        """Faults of rods that are not round, bodies without radius, and, for exact contact, rods that shear."""
        named = given.get("rods", [] if "bodies" in given or "disks" in given else None)
        exact = "width" not in given
        if exact and any("width" in other for _, other in scene.tables("obstacles")):
            problem = (
                "missing: other obstacles have a width, and contact is exact with all obstacles of a scene or with none"
            )
            yield Fault(("width",), problem, "give it here as well, m, or leave it out everywhere")
        yield from _unfit_bodies(given, scene)
        if exact:
            yield from _disks_without_contact(given, scene, flat=cls.is_flat)
        for name, (_, rod) in scene.named("rods").items():
            if isinstance(named, list | tuple) and name not in named:
                continue
            yield from _not_round(name, rod)
            if exact:
                yield from without_exact_contact(name, rod, SMOOTH_FORM)


def _misplaced_on_body(given: Table) -> Iterator[Fault]:
    """Faults of keys that an obstacle on a body must not have."""
    if "body" not in given:
        return
    if "rods" not in given:
        # The rods that hold the body end at it, or in it: the obstacle acts only on rods that it names.
        problem = "missing: an obstacle on a body names the rods that may not enter it, since other rods may carry it"
        yield Fault(("rods",), problem, "name them, as in rods = ['finger']")
    for key in ("bodies", "disks"):
        if key in given:
            problem = "an obstacle on a body keeps off only rods: contact of two bodies is not found"
            yield Fault((key,), problem, f"leave {key} out, or leave body out")


def _disks_without_contact(given: Table, scene: SceneTables, *, flat: bool) -> Iterator[Fault]:
    """Faults of rows of disks that reading could not convert to bodies for exact contact, and of such bodies."""
    if not flat:
        for key in ("disks", "bodies"):
            for i, name in enumerate(list_of(given.get(key))):
                table = scene.table_named(key, name)
                if "thickness" in table or (key == "disks" and table):
                    problem = f"{name!r} has a rim, and no closed form says where a rim meets a curved obstacle"
                    yield Fault((key, i), problem, "give width, m, or bodies with a radius alone, which are balls")
        return
    for i, name in enumerate(list_of(given.get("disks"))):
        # A faulty row has its own faults.
        if sound(Disks, scene.table_named("disks", name)) is not None:
            problem = f"disks of {name!r} touch exactly, and their numbers cannot be parameters"
            yield Fault(("disks", i), problem, "give width, m, or leave those parameters out")


def _unfit_bodies(given: Table, scene: SceneTables) -> Iterator[Fault]:
    """Faults of bodies without a radius."""
    for i, name in enumerate(list_of(given.get("bodies"))):
        body = scene.table_named("bodies", name)
        # An unknown name is refused with the other references.
        if body and "radius" not in body:
            yield Fault(("bodies", i), f"the body {name!r} has no radius to keep", "give the body a radius, m")
        if "width" in given and "thickness" in body:
            problem = f"the body {name!r} is a disk, and bodies that touch an obstacle with a width are balls"
            yield Fault(("bodies", i), problem, "leave out its thickness, or put [[disks]] on the rod")


def _not_round(name: str, rod: Table) -> Iterator[Fault]:
    """Faults of a section that is not round."""
    section = rod.get("section")
    if isinstance(section, Mapping) and not is_round(section):
        problem = f"the section of the rod {name!r} is not round: it has no radius to keep"
        yield Fault((), problem, "take a round section, or stiffness, whose centre line touches")


def without_exact_contact(name: str, rod: Table, smooth_form: str) -> Iterator[Fault]:
    """Faults of properties with which exact contact of a rod cannot be computed; smooth contact admits them.

    Args:
        name: name of the rod.
        rod: table of the rod.
        smooth_form: advice how to write smooth contact.
    """
    if SHEARS & set(admitted_strains(rod.get("strain"))):
        # The centre line of a rod that shears would have a corner at a point of contact, pointing into the obstacle:
        # contact spreads over a stretch as short as the height of the section, which is not resolved.
        problem = f"the rod {name!r} admits shear: its contact has a boundary layer as long as its section is high"
        remedy = f'{smooth_form}; or take strain = "kirchhoff", or leave the rod out of rods'
        yield Fault((), problem, remedy)


OBSTACLES: Family[ObstacleRecord] = Family("obstacles")
"""Kinds of obstacles."""


@OBSTACLES.register
class Plane(ObstacleRecord):
    """The half-space behind a plane."""

    example: ClassVar[str] = """\
[[obstacles]]
name = "table"
kind = "plane"
point = [0, 0, -0.1]
normal = [0, 0, 1]
rods = ["finger"]
"""

    is_flat: ClassVar[bool] = True

    kind: Literal["plane"] = Field(description="half of space")
    point: Vector = Field(description="a point of the plane in world axes, or those of its body, m")
    normal: Direction = Field(
        description="direction out of the obstacle in world axes, or those of its body, without unit; its length does "
        "not matter"
    )


class RoundRecord(ObstacleRecord):
    """A ball or a bar, which a rod could pass through to the other side."""

    radius: Positive = Field(description="its radius, m")

    @property
    def thickness(self) -> float:
        """Diameter of the obstacle, m: the distance through it to its other side."""
        return 2 * self.radius

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """Refuse a width that is not less than the radius: a rod in the middle would not count as too deep."""
        yield from super().conflicts(given)
        width, radius = given.get("width"), given.get("radius")
        if isinstance(width, int | float) and isinstance(radius, int | float) and 0 < radius <= width:
            problem = f"must be < radius, {radius:g} m, got {width:g}"
            yield Fault(("width",), problem, "take a small part of the radius")


@OBSTACLES.register
class Sphere(RoundRecord):
    """A ball."""

    example: ClassVar[str] = """\
[[obstacles]]
name = "ball"
kind = "sphere"
centre = [0.05, 0, 0.1]
radius = 0.02
rods = ["finger"]
"""

    kind: Literal["sphere"] = Field(description="ball")
    centre: Vector = Field(description="its centre in world axes, or those of its body, m")


@OBSTACLES.register
class Capsule(RoundRecord):
    """A round bar with half a ball at either end."""

    example: ClassVar[str] = """\
[[obstacles]]
name = "bar"
kind = "capsule"
from = [0.03, -0.1, 0.1]
to = [0.03, 0.1, 0.1]
radius = 0.01
rods = ["finger"]
"""

    kind: Literal["capsule"] = Field(description="round bar")
    start: Vector = Field(alias="from", description="start of its axis in world axes, or those of its body, m")
    end: Vector = Field(alias="to", description="end of its axis in world axes, or those of its body, m")

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """An axis has a length."""
        yield from super().conflicts(given)
        start = numbers_of(given.get("from"))
        if start and start == numbers_of(given.get("to")):
            yield Fault(("to",), "must differ from from", 'a bar without length is a ball: kind = "sphere"')


CLOSEST_POINTS = 1e-12
"""Least distance of neighbours on a line relative to the largest: below it the line's equations lose digits."""


@OBSTACLES.register
class Lumen(ObstacleRecord):
    """The inside of a tube, which rods may not leave: the balls about a smooth line through points.

    Beyond its first and last point it continues straight with the radius there: it is open at both ends.
    """

    example: ClassVar[str] = """\
[[obstacles]]
name = "vessel"
kind = "lumen"
points = [[0, 0, -0.02], [0, 0, 0.05], [0.01, 0, 0.12], [0.05, 0, 0.22]]
radius = [6e-3, 6e-3, 5e-3, 5e-3]
rods = ["finger"]
"""

    kind: Literal["lumen"] = Field(description="inside of a tube")
    points: Annotated[tuple[Vector, ...], NotEmpty()] = Field(
        description="points that its line passes in world axes, or those of its body, a natural cubic spline over the "
        "distance between them, m"
    )
    radius: PositiveComponent = Field(description="its radius, one or one for each point, m")

    @property
    def radii(self) -> tuple[float, ...]:
        """The radius at each point, m."""
        if isinstance(self.radius, tuple):
            return self.radius
        return (self.radius,) * len(self.points)

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """A lumen has two points at least, neighbours that are apart, and as many radii as points."""
        yield from super().conflicts(given)
        points = list_of(given.get("points"))
        if not points:
            return
        if len(points) < FEWEST_POINTS:
            yield Fault(("points",), f"must have {FEWEST_POINTS} points at least, got {len(points)}")
        for i, (before, point) in enumerate(itertools.pairwise(points), 1):
            if numbers_of(point) and numbers_of(point) == numbers_of(before):
                yield Fault(("points", i), "must differ from the point before it")
        if all(len(numbers_of(point)) == 3 for point in points):
            distances = [math.dist(before, point) for before, point in itertools.pairwise(points)]
            if distances and 0.0 < min(distances) < CLOSEST_POINTS * max(distances):
                problem = f"are {min(distances):g} m apart at the least and {max(distances):g} m at the most"
                yield Fault(("points",), problem, "no smooth line through them can be computed: space them evenly")
        radius = list_of(given.get("radius"))
        if radius and len(radius) != len(points):
            yield Fault(("radius",), f"must have one radius for each of {len(points)} points, got {len(radius)}")


Obstacle = Annotated[Plane | Sphere | Capsule | Lumen, OBSTACLES]
