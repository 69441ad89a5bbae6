"""The words of a scene: frozen records with units and ranges, and the rules that hold between them.

A record either holds what its fields promise or does not exist. The rules between keys and between tables
(`conflicts`) look at what the file says, not at validated records, so they are told together with the faults of
single values and all faults of a file come at once.

The local z axis of a section is the rod's tangent; strains are ordered K_x, K_y, K_z, Γ_x, Γ_y, Γ_z.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Annotated, Any, ClassVar, Literal, TypeVar

from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, StrictBool, Tag, ValidationError

from cosserat_casadi.scene.assembly import assembly_faults
from cosserat_casadi.scene.faults import Fault, Path, shown
from cosserat_casadi.scene.faults import listing as _listing
from cosserat_casadi.scene.faults import named as _named
from cosserat_casadi.scene.faults import tables as _tables
from cosserat_casadi.scene.records import (
    Component,
    Direction,
    Name,
    NotEmpty,
    Number,
    Polynomials,
    Positive,
    Quadruple,
    Quaternion,
    Record,
    Size,
    SizeOrZero,
    Vector,
    Whole,
    by,
    kind_word,
    listed,
    one_or_list,
    refusal,
    without_repetition,
)
from cosserat_casadi.scene.targets import Bound, Target, target_faults

STRAINS = ("bending_x", "bending_y", "torsion", "shear_x", "shear_y", "extension")
"""Names of the six strains, in the order K_x, K_y, K_z, Γ_x, Γ_y, Γ_z."""

PRESETS: dict[str, tuple[int, ...]] = {"planar": (1,), "kirchhoff": (0, 1, 2), "reissner": (0, 1, 2, 3, 4, 5)}
"""Indices of the strains that the named rod theories admit."""

RecordType = TypeVar("RecordType", bound="Record")
Chosen = TypeVar("Chosen")


def _exactly_one(value: Any) -> Any:
    if type(value) is not int or value != 1:
        raise refusal([Fault((), f"must be 1, got {shown(value)}", "this version reads schema = 1")])
    return value


def _loaded_section(value: float) -> float:
    if not 0.0 < value <= 1.0:
        remedy = "a wrench on the base goes straight into the clamp: leave it out" if value == 0.0 else ""
        raise refusal([Fault((), f"must be > 0 and <= 1, got {shown(value)}", remedy)])
    return value


StrainName = Literal["bending_x", "bending_y", "torsion", "shear_x", "shear_y", "extension"]
StrainChoice = Annotated[
    Annotated[Literal["planar", "kirchhoff", "reissner"], Tag("⟨one⟩")]
    | Annotated[tuple[StrainName, ...], NotEmpty(), AfterValidator(without_repetition), Tag("⟨list⟩")],
    Discriminator(one_or_list),
]
Modes = Annotated[Whole, Field(ge=1, le=200)]
ModesChoice = Annotated[
    Annotated[Modes, Tag("⟨one⟩")] | Annotated[tuple[Modes, ...], NotEmpty(), Tag("⟨list⟩")],
    Discriminator(one_or_list),
]


# Accuracy


class Accuracy(Record):
    """How exact the result is to be, or with what it is computed."""

    tolerance: Annotated[Number, Field(ge=1e-12, le=1e-1)] = Field(
        1e-6, description="wanted pose error relative to the rod length, without unit"
    )
    shape: StrictBool = Field(False, description="whether the tolerance binds all sections, not the tip alone")
    modes: ModesChoice | None = Field(
        None, description="polynomial modes per strain component, a whole number or a list of one per admitted strain"
    )
    nodes: Annotated[Whole, Field(ge=2, le=1000)] | None = Field(
        None, description="intervals of the Chebyshev grid, a whole number"
    )
    rotation: Literal["magnus4", "magnus6", "magnus8", "permuted"] | None = Field(
        None,
        description="how the rotation is integrated: products of exponentials of order 4, 6 or 8, or the literal "
        "'permuted' linear system",
    )

    @property
    def fixed(self) -> bool:
        """Whether the scene itself chooses what it is computed with, or part of that."""
        return any(choice is not None for choice in (self.modes, self.nodes, self.rotation))


# Rods


class Material(Record):
    """An isotropic linear elastic material."""

    youngs_modulus: Positive = Field(description="Young's modulus E, Pa")
    poisson_ratio: Annotated[Number, Field(gt=-1, le=0.5)] | None = Field(
        None, description="Poisson's ratio, without unit; instead of shear_modulus"
    )
    shear_modulus: Positive | None = Field(None, description="shear modulus G, Pa; instead of poisson_ratio")
    density: Positive | None = Field(None, description="density, kg/m³; needed where gravity acts")

    @classmethod
    def conflicts(cls, given: Mapping[str, Any]) -> Iterator[Fault]:
        """Poisson's ratio and the shear modulus say the same."""
        if "poisson_ratio" in given and "shear_modulus" in given:
            yield Fault(("shear_modulus",), "stands beside poisson_ratio", "give one of the two")
        if "poisson_ratio" not in given and "shear_modulus" not in given:
            yield Fault(("poisson_ratio",), "missing", "give poisson_ratio or shear_modulus, Pa")


class _Section(Record):
    shear_correction: Positive = Field(
        1.0, description="k in the shear stiffness k G A, without unit; 1 as in report (1.21)"
    )


class Circle(_Section):
    """A solid circular cross-section."""

    shape: Literal["circle"] = Field(description="solid circle")
    radius: Size = Field(description="radius, m; a list of two goes linearly from base to tip")


class Annulus(_Section):
    """A circular tube."""

    shape: Literal["annulus"] = Field(description="circular tube")
    outer_radius: Size = Field(description="outer radius, m; a list of two goes linearly from base to tip")
    inner_radius: SizeOrZero = Field(description="inner radius, m; a list of two goes linearly from base to tip")

    @classmethod
    def conflicts(cls, given: Mapping[str, Any]) -> Iterator[Fault]:
        """The bore fits into the tube at both ends."""
        outer, inner = _ends(given.get("outer_radius")), _ends(given.get("inner_radius"))
        for bore, wall in zip(inner, outer, strict=False):
            if bore >= wall:
                problem = f"must be < outer_radius at both ends, got {shown(bore)} in {shown(wall)}"
                yield Fault(("inner_radius",), problem)
                return


class Rectangle(_Section):
    """A solid rectangular cross-section."""

    shape: Literal["rectangle"] = Field(description="solid rectangle")
    width: Size = Field(description="width along local x, m; a list of two goes linearly from base to tip")
    height: Size = Field(description="height along local y, m; a list of two goes linearly from base to tip")


Section = Annotated[
    Annotated[Circle, Tag("⟨circle⟩")]
    | Annotated[Annulus, Tag("⟨annulus⟩")]
    | Annotated[Rectangle, Tag("⟨rectangle⟩")],
    Discriminator(by("shape")),
    kind_word("shape", ("circle", "annulus", "rectangle")),
]


class Stiffness(Record):
    """Diagonal of the Hooke tensor, each constant or linear from base to tip."""

    bending_x: Size | None = Field(None, description="bending stiffness about local x, N m²")
    bending_y: Size | None = Field(None, description="bending stiffness about local y, N m²")
    torsion: Size | None = Field(None, description="torsional stiffness, N m²")
    shear_x: Size | None = Field(None, description="shear stiffness along local x, N")
    shear_y: Size | None = Field(None, description="shear stiffness along local y, N")
    extension: Size | None = Field(None, description="axial stiffness, N")


class Intrinsic(Record):
    """Strains of the unloaded rod, ξ⁰."""

    curvature: Polynomials = Field(
        (0.0, 0.0, 0.0), description="K_x, K_y, K_z, 1/m; a component may list Legendre coefficients in 2X − 1"
    )
    tangent: Polynomials = Field(
        (0.0, 0.0, 1.0),
        description="Γ_x, Γ_y, Γ_z, without unit; a component may list Legendre coefficients in 2X − 1",
    )


def _carrying_section(value: float) -> float:
    if not 0.0 < value <= 1.0:
        remedy = "at its base the other rod does not move: give a pose in the world" if value == 0.0 else ""
        raise refusal([Fault((), f"must be > 0 and <= 1, got {shown(value)}", remedy)])
    return value


class Base(Record):
    """Pose of the section X = 0, in the world or in a section of another rod."""

    rod: str | None = Field(
        None, description="name of the rod that carries this one: the pose of the base is then that in its section"
    )
    at: Annotated[
        Number,
        AfterValidator(_carrying_section),
        Field(json_schema_extra={"exclusiveMinimum": 0, "maximum": 1}),
    ] = Field(1.0, description="abscissa X of the carrying section, without unit, above 0 and at most 1; with rod")
    position: Vector = Field((0.0, 0.0, 0.0), description="position of the base, m")
    quaternion: Quaternion = Field(
        (1.0, 0.0, 0.0, 0.0), description="orientation of the base w, x, y, z, of norm 1, without unit"
    )
    tangent: Direction | None = Field(
        None,
        description="direction of the base's z axis, without unit; the shortest rotation of z, instead of quaternion",
    )

    @classmethod
    def conflicts(cls, given: Mapping[str, Any]) -> Iterator[Fault]:
        """A tangent says the orientation already."""
        if "tangent" in given and "quaternion" in given:
            yield Fault(("tangent",), "stands beside quaternion", "give one of the two")
        if "at" in given and "rod" not in given:
            yield Fault(("at",), "stands without rod", "name the rod that carries this one, or leave it out")


class Rod(Record):
    """An elastic rod, held at its base."""

    name: Name = Field(description="name of the rod, a letter, then letters, digits and underscores")
    length: Positive = Field(description="undeformed length, m")
    strain: StrainChoice = Field(
        description="admitted strains: 'planar' (bending in the local x–z plane), 'kirchhoff' (bending and torsion), "
        "'reissner' (all six), or a list out of bending_x, bending_y, torsion, shear_x, shear_y, extension"
    )
    basis: Literal["legendre", "chebyshev"] = Field("legendre", description="polynomials that the strains are made of")
    material: Material | None = Field(None, description="what the rod is made of; with section")
    section: Section | None = Field(None, description="its cross-section; with material")
    stiffness: Stiffness | None = Field(None, description="stiffnesses, N m² and N; instead of material and section")
    linear_density: Size | None = Field(
        None, description="mass per length, kg/m, with stiffness; a list of two goes linearly from base to tip"
    )
    intrinsic: Intrinsic = Field(Intrinsic(), description="strains of the unloaded rod, 1/m and without unit")
    base: Base = Field(Base(), description="pose of the base, in the world or in a section of another rod, m")

    @property
    def admitted(self) -> tuple[int, ...]:
        """Indices of the admitted strains, ascending, in the order K_x, K_y, K_z, Γ_x, Γ_y, Γ_z."""
        return _admitted(self.strain)

    @classmethod
    def conflicts(cls, given: Mapping[str, Any]) -> Iterator[Fault]:
        """The elasticity is said once, and for every admitted strain."""
        yield from _elasticity_said_once(given)
        stiffness = given.get("stiffness")
        if isinstance(stiffness, Mapping):
            for name in (STRAINS[index] for index in _admitted(given.get("strain"))):
                if name not in stiffness:
                    yield Fault(("stiffness", name), "missing", f"the rod admits {name}")


def _elasticity_said_once(rod: Mapping[str, Any]) -> Iterator[Fault]:
    made = [key for key in ("material", "section") if key in rod]
    direct = [key for key in ("stiffness", "linear_density") if key in rod]
    if made and direct:
        remedy = "give material and section, or stiffness and linear_density"
        yield Fault((direct[0],), f"stands beside {' and '.join(made)}", remedy)
    elif made == ["material"]:
        yield Fault(("section",), "missing", "a material needs a section")
    elif made == ["section"]:
        yield Fault(("material",), "missing", "a section needs a material")
    elif not made and "stiffness" not in rod:
        yield Fault(("material",), "missing", "give material and section, or stiffness")


def _admitted(strain: Any) -> tuple[int, ...]:
    """Indices of the strains that a strain entry admits; none where it is faulty."""
    if isinstance(strain, str):
        return PRESETS.get(strain, ())
    names = strain if isinstance(strain, list | tuple) else ()
    return tuple(index for index, name in enumerate(STRAINS) if name in names)


def _ends(value: Any) -> tuple[float, ...]:
    """Values of a size at base and tip; none where it is faulty."""
    ends = value if isinstance(value, list | tuple) else (value, value)
    sound = all(isinstance(end, int | float) and not isinstance(end, bool) for end in ends)
    return tuple(ends) if sound and len(ends) == 2 else ()


# Loads


class Gravity(Record):
    """A uniform field of acceleration."""

    magnitudes: ClassVar[tuple[str, ...]] = ("acceleration",)

    name: Name = Field(description="name of the load, a letter, then letters, digits and underscores")
    kind: Literal["gravity"] = Field(description="weight of the rods and bodies")
    acceleration: Vector = Field(description="acceleration in world axes, m/s²")
    rods: Annotated[tuple[str, ...], NotEmpty(), AfterValidator(without_repetition)] | None = Field(
        None, description="names of the rods that it acts on; all rods when neither rods nor bodies are named"
    )
    bodies: Annotated[tuple[str, ...], NotEmpty(), AfterValidator(without_repetition)] | None = Field(
        None, description="names of the bodies that it acts on; all bodies when neither rods nor bodies are named"
    )

    def acts_on_rod(self, rod: str) -> bool:
        """Whether it weighs the rod of this name."""
        return (self.rods is None and self.bodies is None) or rod in (self.rods or ())

    def acts_on_body(self, body: str) -> bool:
        """Whether it weighs the body of this name."""
        return (self.rods is None and self.bodies is None) or body in (self.bodies or ())


class _Wrench(Record):
    magnitudes: ClassVar[tuple[str, ...]] = ("force", "moment")

    name: Name = Field(description="name of the load, a letter, then letters, digits and underscores")
    rod: str = Field(description="name of the rod that it acts on")
    frame: Literal["world", "body"] = Field(
        "world", description="axes of force and moment: 'world' is a dead load, 'body' follows the section"
    )

    @classmethod
    def conflicts(cls, given: Mapping[str, Any]) -> Iterator[Fault]:
        """A wrench has a force or a moment."""
        if "force" not in given and "moment" not in given:
            yield Fault(("force",), "missing", "give force, moment or both")


class TipWrench(_Wrench):
    """A force and a moment on the tip section."""

    kind: Literal["tip_wrench"] = Field(description="force and moment on the tip")
    force: Vector = Field((0.0, 0.0, 0.0), description="force, N")
    moment: Vector = Field((0.0, 0.0, 0.0), description="moment, N m")


class PointWrench(_Wrench):
    """A force and a moment on one section."""

    kind: Literal["point_wrench"] = Field(description="force and moment on one section")
    at: Annotated[
        Number,
        AfterValidator(_loaded_section),
        Field(json_schema_extra={"exclusiveMinimum": 0, "maximum": 1}),
    ] = Field(description="abscissa X of the section relative to the length, without unit, above 0 and at most 1")
    force: Vector = Field((0.0, 0.0, 0.0), description="force, N")
    moment: Vector = Field((0.0, 0.0, 0.0), description="moment, N m")


class DistributedWrench(_Wrench):
    """A force and a moment per length."""

    kind: Literal["distributed_wrench"] = Field(description="force and moment per length")
    force: Polynomials = Field(
        (0.0, 0.0, 0.0),
        description="force per length, N/m; a component may list Legendre coefficients in 2X − 1",
    )
    moment: Polynomials = Field(
        (0.0, 0.0, 0.0),
        description="moment per length, N m/m; a component may list Legendre coefficients in 2X − 1",
    )


class BodyWrench(Record):
    """A force and a moment on a rigid body."""

    magnitudes: ClassVar[tuple[str, ...]] = ("force", "moment")

    name: Name = Field(description="name of the load, a letter, then letters, digits and underscores")
    kind: Literal["body_wrench"] = Field(description="force and moment on a body")
    body: str = Field(description="name of the body that it acts on")
    force: Vector = Field((0.0, 0.0, 0.0), description="force, N")
    moment: Vector = Field((0.0, 0.0, 0.0), description="moment, N m")
    position: Vector = Field((0.0, 0.0, 0.0), description="point of the body that the force acts on, in its axes, m")
    frame: Literal["world", "body"] = Field(
        "world", description="axes of force and moment: 'world' is a dead load, 'body' turns with the body"
    )

    @classmethod
    def conflicts(cls, given: Mapping[str, Any]) -> Iterator[Fault]:
        """A wrench has a force or a moment."""
        yield from _Wrench.conflicts(given)


Load = Annotated[
    Annotated[Gravity, Tag("⟨gravity⟩")]
    | Annotated[TipWrench, Tag("⟨tip_wrench⟩")]
    | Annotated[PointWrench, Tag("⟨point_wrench⟩")]
    | Annotated[DistributedWrench, Tag("⟨distributed_wrench⟩")]
    | Annotated[BodyWrench, Tag("⟨body_wrench⟩")],
    Discriminator(by("kind")),
    kind_word("kind", ("gravity", "tip_wrench", "point_wrench", "distributed_wrench", "body_wrench")),
]

# Supports


class _Support(Record):
    name: Name | None = Field(None, description="name of the support, a letter, then letters, digits and underscores")
    rod: str = Field(description="name of the rod whose tip it holds")
    position: Vector = Field(description="prescribed position of the tip in world axes, m")


class ClampedSupport(_Support):
    """Position and orientation of a tip are prescribed."""

    kind: Literal["clamped"] = Field(description="pose of the tip prescribed")
    quaternion: Quaternion = Field(description="prescribed orientation of the tip w, x, y, z, of norm 1, without unit")


class PinnedSupport(_Support):
    """The position of a tip is prescribed, its moment is free."""

    kind: Literal["pinned"] = Field(description="position of the tip prescribed, moment free")


Support = Annotated[
    Annotated[ClampedSupport, Tag("⟨clamped⟩")] | Annotated[PinnedSupport, Tag("⟨pinned⟩")],
    Discriminator(by("kind")),
    kind_word("kind", ("clamped", "pinned")),
]
SUPPORTS: dict[str, type[ClampedSupport] | type[PinnedSupport]] = {"clamped": ClampedSupport, "pinned": PinnedSupport}
"""The record of each kind of support."""


# Actuators


Offset = Annotated[tuple[Component, Component], listed(2, "2 components, x and y")]
Share = Annotated[Number, Field(ge=0, le=1)]


def _ascending(value: tuple[float, float]) -> tuple[float, float]:
    if not value[0] < value[1]:
        raise refusal([Fault((), f"must begin before it ends, got {list(value)}", "two abscissae X, base side first")])
    return value


Span = Annotated[tuple[Share, Share], listed(2, "2 abscissae"), AfterValidator(_ascending)]


class Helix(Record):
    """A tendon that winds round the rod: offset = radius (cos, sin)(2π turns X + phase)."""

    radius: Positive = Field(description="distance from the centreline, m")
    turns: Number = Field(description="turns over the whole rod, negative for a left-handed helix, without unit")
    phase: Number = Field(0.0, description="angle at X = 0 from local x, rad")


class Tendon(Record):
    """A cable without friction, led through the sections and anchored at the end of its span."""

    magnitudes: ClassVar[tuple[str, ...]] = ("tension", "length")

    name: Name = Field(description="name of the actuator, a letter, then letters, digits and underscores")
    kind: Literal["tendon"] = Field(description="cable led along the rod")
    rod: str = Field(description="name of the rod that it pulls")
    tension: Annotated[Number, Field(ge=0)] | None = Field(None, description="tension, N; or length")
    length: Positive | None = Field(
        None, description="length of the cable along its span, m; its tension is then an unknown"
    )
    slack: bool = Field(
        False, strict=True, description="whether a cable of given length may go slack, so that it never pushes"
    )
    offset: Offset | None = Field(
        None, description="place in the section, x and y, m; a component may list polynomial coefficients in X"
    )
    helix: Helix | None = Field(None, description="helical course round the centreline, instead of offset")
    span: Span = Field((0.0, 1.0), description="abscissae X where it enters the rod and where it is anchored")

    @classmethod
    def conflicts(cls, given: Mapping[str, Any]) -> Iterator[Fault]:
        """One of tension and length, one of offset and helix."""
        for first, second in (("tension", "length"), ("offset", "helix")):
            if first in given and second in given:
                yield Fault((second,), f"stands beside {first}", "give one of the two")
            elif first not in given and second not in given:
                yield Fault((first,), "missing", f"give {first} or {second}")
        if given.get("slack") is True and "length" not in given:
            yield Fault(("slack",), "is for a tendon of given length", "leave it out: a given tension is what it is")


class Chamber(Record):
    """A pressurised channel of constant cross-section along the rod."""

    magnitudes: ClassVar[tuple[str, ...]] = ("pressure",)

    name: Name = Field(description="name of the actuator, a letter, then letters, digits and underscores")
    kind: Literal["chamber"] = Field(description="pressurised channel along the rod")
    rod: str = Field(description="name of the rod that it pushes")
    pressure: Number = Field(description="pressure above that outside, Pa")
    area: Positive = Field(description="cross-section of the channel, m²")
    offset: Offset = Field(
        (0.0, 0.0), description="place in the section, x and y, m; a component may list polynomial coefficients in X"
    )
    span: Span = Field((0.0, 1.0), description="abscissae X between which the channel runs")


Actuator = Annotated[
    Annotated[Tendon, Tag("⟨tendon⟩")] | Annotated[Chamber, Tag("⟨chamber⟩")],
    Discriminator(by("kind")),
    kind_word("kind", ("tendon", "chamber")),
]


MAGNITUDES: dict[str, tuple[str, ...]] = {
    "gravity": Gravity.magnitudes,
    "tip_wrench": TipWrench.magnitudes,
    "point_wrench": PointWrench.magnitudes,
    "distributed_wrench": DistributedWrench.magnitudes,
    "body_wrench": BodyWrench.magnitudes,
    "tendon": Tendon.magnitudes,
    "chamber": Chamber.magnitudes,
}
"""Fields of each kind of load and actuator that may stay free at run time."""


ROD_INPUTS = ("length", "base.position", "base.quaternion")
"""What of a rod itself may stay free at run time."""

_SIZES = {"tension": 1, "length": 1, "pressure": 1, "base.position": 3, "base.quaternion": 4}
"""Numbers of entries of the inputs that are not vectors of loads."""


# Bodies and joints


class Body(Record):
    """A rigid body that rods carry."""

    name: Name = Field(description="name of the body, a letter, then letters, digits and underscores")
    mass: Annotated[Number, Field(ge=0)] = Field(0.0, description="mass, kg")
    centre_of_mass: Vector = Field((0.0, 0.0, 0.0), description="centre of mass in the axes of the body, m")


class _Joint(Record):
    name: Name | None = Field(None, description="name of the joint, a letter, then letters, digits and underscores")
    body: str = Field(description="name of the body")
    rod: str = Field(description="name of the rod whose tip is jointed to it")
    position: Vector = Field((0.0, 0.0, 0.0), description="position of the joint in the axes of the body, m")
    quaternion: Quaternion = Field(
        (1.0, 0.0, 0.0, 0.0), description="orientation of the tip section in the axes of the body, of norm 1"
    )


class FixedJoint(_Joint):
    """The tip of a rod is clamped in a body."""

    kind: Literal["fixed"] = Field(description="the tip is clamped in the body")


class SphericalJoint(_Joint):
    """The tip of a rod meets a point of a body and turns freely."""

    kind: Literal["spherical"] = Field(description="the tip stays at a point of the body and turns freely")


Joint = Annotated[
    Annotated[FixedJoint, Tag("⟨fixed⟩")] | Annotated[SphericalJoint, Tag("⟨spherical⟩")],
    Discriminator(by("kind")),
    kind_word("kind", ("fixed", "spherical")),
]


# The scene


class Scene(Record):
    """Rods, and what acts on them. SI units, right-handed world axes."""

    schema_version: Annotated[Literal[1], BeforeValidator(_exactly_one)] = Field(
        alias="schema", description="version of the scene format: 1"
    )
    title: str = Field("", description="one line about the scene")
    inputs: Annotated[tuple[str, ...], AfterValidator(without_repetition)] | None = Field(
        None,
        description="'load.field' of what stays free at run time; every magnitude of loads and actuators when left out",
    )
    accuracy: Accuracy = Field(Accuracy(), description="wanted accuracy, or a fixed discretisation")
    rods: Annotated[tuple[Rod, ...], NotEmpty()] = Field(description="the rods, at least one")
    loads: tuple[Load, ...] = Field((), description="what acts on the rods")
    supports: tuple[Support, ...] = Field((), description="tips that are held; a tip without support is free")
    actuators: tuple[Actuator, ...] = Field((), description="tendons and pressurised chambers")
    bodies: tuple[Body, ...] = Field((), description="rigid bodies that rods carry")
    joints: tuple[Joint, ...] = Field((), description="joints between tips of rods and bodies")
    targets: tuple[Target, ...] = Field((), description="where sections and bodies are to be, for the inverse problem")
    bounds: tuple[Bound, ...] = Field((), description="ranges of inputs that the inverse problem looks for")

    @property
    def causes(self) -> tuple[Load | Actuator, ...]:
        """Loads, then actuators: all that may have an input."""
        return (*self.loads, *self.actuators)

    def input_names(self) -> tuple[str, ...]:
        """Names ``load.field`` of what stays free at run time.

        Returns:
            the names that the scene lists, or else every magnitude that it gives, in the order of the file.
        """
        if self.inputs is not None:
            return self.inputs
        return tuple(
            f"{cause.name}.{field}"
            for cause in self.causes
            for field in cause.magnitudes
            if field in cause.model_fields_set
        )

    @classmethod
    def conflicts(cls, given: Mapping[str, Any]) -> Iterator[Fault]:
        """Tables that contradict each other, or name what is not there."""
        for key in ("rods", "loads", "supports", "actuators", "bodies", "joints"):
            yield from _repeated_names(given, key)
        yield from _shared_names(given)
        yield from _dangling_names(given)
        yield from assembly_faults(given)
        yield from _weightless_rods(given)
        yield from _overlapping_supports(given)
        yield from _unreachable_supports(given)
        yield from _miscounted_modes(given)
        yield from _inputs_that_are_not(given)
        yield from target_faults(given, _input_sizes(given))


def _repeated_names(given: Mapping[str, Any], key: str) -> Iterator[Fault]:
    tables = _tables(given, key)
    named = _named(tables)
    for i, table in tables:
        name = table.get("name")
        if isinstance(name, str) and named[name][0] != i:
            yield Fault((key, i, "name"), f"{shown(name)} is already the name of {key}[{named[name][0]}]")


def _shared_names(given: Mapping[str, Any]) -> Iterator[Fault]:
    """A load and an actuator of one name: its inputs could not be told apart."""
    loads = _named(_tables(given, "loads"))
    for i, table in _tables(given, "actuators"):
        name = table.get("name")
        if isinstance(name, str) and name in loads:
            yield Fault(("actuators", i, "name"), f"{shown(name)} is already the name of loads[{loads[name][0]}]")


def _references(given: Mapping[str, Any]) -> Iterator[tuple[Path, Any]]:
    """Every place that names a rod, with the name."""
    for i, load in _tables(given, "loads"):
        kind = load.get("kind")
        if kind == "gravity" and isinstance(load.get("rods"), list):
            yield from ((("loads", i, "rods", j), name) for j, name in enumerate(load["rods"]))
        elif kind in ("tip_wrench", "point_wrench", "distributed_wrench"):
            yield ("loads", i, "rod"), load.get("rod")
    for key in ("supports", "joints", "actuators"):
        yield from (((key, i, "rod"), table.get("rod")) for i, table in _tables(given, key))


def _dangling_names(given: Mapping[str, Any]) -> Iterator[Fault]:
    rods = _named(_tables(given, "rods"))
    if not rods:  # there is a fault in the rods already; every reference would dangle
        return
    for path, name in _references(given):
        if isinstance(name, str) and name not in rods:
            yield Fault(path, f"no rod is named {shown(name)}", _listing(rods, "rods"))


def _weightless_rods(given: Mapping[str, Any]) -> Iterator[Fault]:
    everywhere, named = _gravity(given)
    for i, rod in _tables(given, "rods"):
        name = rod.get("name")
        gravity = everywhere or (named.get(name) if isinstance(name, str) else None)
        if gravity is None:
            continue
        made = rod.get("material")
        if "stiffness" in rod and "linear_density" not in rod:
            remedy = f"{gravity} acts on this rod: give its mass per length, kg/m"
            yield Fault(("rods", i, "linear_density"), "missing", remedy)
        elif "stiffness" not in rod and isinstance(made, Mapping) and "density" not in made:
            remedy = f"{gravity} acts on this rod: give its density, kg/m³"
            yield Fault(("rods", i, "material", "density"), "missing", remedy)


def _gravity(given: Mapping[str, Any]) -> tuple[str | None, dict[str, str]]:
    """The load that weighs every rod, if any, and those that weigh the rods they name."""
    everywhere: str | None = None
    named: dict[str, str] = {}
    for i, load in _tables(given, "loads"):
        if load.get("kind") == "gravity" and "rods" not in load and "bodies" not in load:
            everywhere = everywhere or f"loads[{i}]"
        elif load.get("kind") == "gravity" and isinstance(load.get("rods"), list):
            named.update({name: f"loads[{i}]" for name in load["rods"] if isinstance(name, str)})
    return everywhere, named


def _overlapping_supports(given: Mapping[str, Any]) -> Iterator[Fault]:
    first: dict[str, int] = {}
    for i, support in _tables(given, "supports"):
        name = support.get("rod")
        if isinstance(name, str) and first.setdefault(name, i) != i:
            problem = f"overlapping supports: supports[{first[name]}] holds the tip of {shown(name)} already"
            yield Fault(("supports", i, "rod"), problem, "one support for each tip")


def _miscounted_modes(given: Mapping[str, Any]) -> Iterator[Fault]:
    accuracy = given.get("accuracy")
    modes = accuracy.get("modes") if isinstance(accuracy, Mapping) else None
    if not isinstance(modes, list):
        return
    for i, rod in _tables(given, "rods"):
        admitted = len(_admitted(rod.get("strain")))
        if admitted and modes and admitted != len(modes):
            problem = f"must have one entry per strain of every rod, got {len(modes)} where rods[{i}] admits {admitted}"
            yield Fault(("accuracy", "modes"), problem, "give one number for all")
            return


def _inputs_that_are_not(given: Mapping[str, Any]) -> Iterator[Fault]:
    causes = {**_named(_tables(given, "actuators")), **_named(_tables(given, "loads"))}
    rods = _named(_tables(given, "rods"))
    entries = given.get("inputs")
    for i, entry in enumerate(entries if isinstance(entries, list) else []):
        if not isinstance(entry, str):
            continue
        name, _, field = entry.partition(".")
        if not field:
            yield Fault(("inputs", i), f"must read 'load.field', got {shown(entry)}")
        elif name in causes:
            yield from (Fault(("inputs", i), *told) for told in _no_magnitude(name, causes[name][1], field))
        elif name in rods:
            yield from (Fault(("inputs", i), *told) for told in _not_free(given, name, rods[name][1], field))
        else:
            known = _listing([*causes, *rods], "names")
            yield Fault(("inputs", i), f"no load, actuator or rod is named {shown(name)}", known)


def _not_free(given: Mapping[str, Any], name: str, rod: Mapping[str, Any], field: str) -> Iterator[tuple[str, str]]:
    """Why something of a rod cannot be left free at run time."""
    if field not in ROD_INPUTS:
        yield f"{shown(name)} has no {shown(field)} to leave free", _listing(ROD_INPUTS, "fields")
    if field not in ROD_INPUTS[1:]:
        return
    base = rod.get("base")
    if isinstance(base, Mapping) and "rod" in base:
        yield f"{shown(name)} starts on another rod", "move the base of that one"
    held = any(table.get("rod") == name for key in ("supports", "joints") for _, table in _tables(given, key))
    if held and set(_admitted(rod.get("strain"))) <= {1, 3, 5}:
        yield f"{shown(name)} bends in a plane and its tip is held", "admit torsion, or its base could leave the plane"


def _input_sizes(given: Mapping[str, Any]) -> dict[str, int]:
    """Numbers of entries of what the tables leave free at run time, by name."""
    causes = {**_named(_tables(given, "actuators")), **_named(_tables(given, "loads"))}
    every = [
        f"{name}.{field}"
        for name, (_, cause) in causes.items()
        for field in _choice(MAGNITUDES, cause.get("kind")) or ()
        if field in cause
    ]
    entries = given.get("inputs")
    names = [name for name in entries if isinstance(name, str)] if isinstance(entries, list) else every
    sizes = {}
    for name in names:
        owner, _, field = name.partition(".")
        sizes[name] = _SIZES.get(field) or _entry_count(causes[owner][1].get(field) if owner in causes else None)
    return sizes


def _entry_count(vector: Any) -> int:
    """Entries of a vector whose components may list coefficients; 3 where it is left out or faulty."""
    components = vector if isinstance(vector, list | tuple) else ()
    return 3 * max((len(entry) for entry in components if isinstance(entry, list | tuple)), default=1)


def _no_magnitude(name: str, cause: Mapping[str, Any], field: str) -> Iterator[tuple[str, str]]:
    fields = _choice(MAGNITUDES, cause.get("kind"))
    if cause.get("kind") == "tendon":
        fields = tuple(one for one in Tendon.magnitudes if one in cause) or Tendon.magnitudes
    if fields is not None and field not in fields:
        yield f"{shown(name)} has no magnitude {shown(field)}", _listing(fields, "magnitudes")


def _choice(choices: Mapping[str, Chosen], word: Any) -> Chosen | None:
    return choices.get(word) if isinstance(word, str) else None


def _unreachable_supports(given: Mapping[str, Any]) -> Iterator[Fault]:
    rods = _named(_tables(given, "rods"))
    for i, table in _tables(given, "supports"):
        model = _choice(SUPPORTS, table.get("kind"))
        name = table.get("rod")
        if model is None or not isinstance(name, str) or name not in rods:
            continue
        rod, support = _sound(Rod, rods[name][1]), _sound(model, table)
        if rod is not None and rod.base.rod is None and support is not None:
            for path, problem, remedy in _out_of_reach(rod, support):
                yield Fault(("supports", i, *path), f"unreachable combination: {problem}", remedy)


def _sound(model: type[RecordType], table: Mapping[str, Any]) -> RecordType | None:
    try:
        return model.model_validate(table)
    except ValidationError:
        return None


def _out_of_reach(rod: Rod, support: ClampedSupport | PinnedSupport) -> Iterator[Fault]:
    distance = math.dist(support.position, rod.base.position)
    keeps_its_length = not set(rod.admitted) & {3, 4, 5} and _is_constant(rod.intrinsic.tangent, (0.0, 0.0, 1.0))
    if keeps_its_length and distance > rod.length * (1 + 1e-9):
        problem = f"{distance:.9g} m from the base of a rod of {rod.length:.9g} m"
        yield Fault(("position",), problem, "admit extension, or move the support")
    if _stays_in_its_plane(rod):
        yield from _out_of_plane(rod, support)


def _is_constant(vector: Sequence[float | tuple[float, ...]], wanted: Sequence[float]) -> bool:
    rows = [entry if isinstance(entry, tuple) else (entry,) for entry in vector]
    return all(row[0] == value and not any(row[1:]) for row, value in zip(rows, wanted, strict=True))


def _stays_in_its_plane(rod: Rod) -> bool:
    """Whether nothing turns or shears the rod out of the local x–z plane of its base."""
    (bent_x, _, bent_z), (_, sheared_y, _) = rod.intrinsic.curvature, rod.intrinsic.tangent
    return set(rod.admitted) <= {1, 3, 5} and _is_constant((bent_x, bent_z, sheared_y), (0.0, 0.0, 0.0))


def _out_of_plane(rod: Rod, support: ClampedSupport | PinnedSupport) -> Iterator[Fault]:
    base_Q_world = _conjugate(_base_orientation(rod.base))
    x, y, z = (a - b for a, b in zip(support.position, rod.base.position, strict=True))
    offset = _product(_product(base_Q_world, (0.0, x, y, z)), _conjugate(base_Q_world))[2]
    remedy = "a planar rod stays in the local x–z plane of its base"
    if not abs(offset) <= 1e-9 * rod.length:
        yield Fault(("position",), f"{abs(offset):.3g} m outside the plane of the rod", remedy)
    if isinstance(support, ClampedSupport):
        _, turn_x, _, turn_z = _product(base_Q_world, support.quaternion)
        if not math.hypot(turn_x, turn_z) <= 1e-6:  # the slack that the norm of a quaternion has
            yield Fault(("quaternion",), "turned out of the plane of the rod", remedy)


def _base_orientation(base: Base) -> Quadruple:
    """World orientation of the base: its quaternion, or the shortest rotation of z to its tangent."""
    if base.tangent is None:
        return base.quaternion
    x, y, z = base.tangent
    across = math.hypot(x, y)
    if across == 0.0:  # no shortest rotation leads from z to −z: by convention the half turn about x
        return (1.0, 0.0, 0.0, 0.0) if z > 0 else (0.0, 1.0, 0.0, 0.0)
    half = math.atan2(across, z) / 2
    return (math.cos(half), -y / across * math.sin(half), x / across * math.sin(half), 0.0)


def _conjugate(q: Quadruple) -> Quadruple:
    return (q[0], -q[1], -q[2], -q[3])


def _product(a: Quadruple, b: Quadruple) -> Quadruple:
    return (
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    )
