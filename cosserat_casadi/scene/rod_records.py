"""Rods: their section, the strains that they admit, the pose of their base.

The local z axis of a section is the rod's tangent; strains are ordered K_x, K_y, K_z, Γ_x, Γ_y, Γ_z.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import AfterValidator, Field, StrictBool

from cosserat_casadi.scene.families import Family
from cosserat_casadi.scene.faults import (
    Fault,
    Path,
    SceneTables,
    Table,
    below,
    list_of,
    numbers_of,
    refused_keys,
    shown,
    table_of,
)
from cosserat_casadi.scene.input_fields import InputField
from cosserat_casadi.scene.material_records import ElasticMaterial
from cosserat_casadi.scene.orientations import Oriented
from cosserat_casadi.scene.profiles import ends_of
from cosserat_casadi.scene.records import Entry, Record
from cosserat_casadi.scene.values import (
    ABOVE_BASE,
    BY_LENGTH,
    SEVERAL,
    SINGLE,
    Name,
    NotEmpty,
    NotNegative,
    Number,
    Polynomials,
    Positive,
    Quaternion,
    Size,
    SizeOrZero,
    Vector,
    above_base,
    listed,
    without_repetition,
)

STRAINS = ("bending_x", "bending_y", "torsion", "shear_x", "shear_y", "extension")
"""Names of the six strains, in the order K_x, K_y, K_z, Γ_x, Γ_y, Γ_z."""

PRESETS: dict[str, tuple[int, ...]] = {"planar": (1,), "kirchhoff": (0, 1, 2), "reissner": (0, 1, 2, 3, 4, 5)}
"""Indices of the strains that the named rod theories admit."""

IN_PLANE = {1, 3, 5}
"""Indices of the strains that keep a rod in the local x–z plane: bending_y, shear_x, extension."""

SHEAR_AND_EXTENSION = {3, 4, 5}
"""Indices of the strains Γ; a rod that admits no such strain keeps its length."""

NO_STRAIN = "name the strains that may change, such as bending_x; a body of [[bodies]] is rigid"
"""Remedy for a rod that admits no strain."""

StrainName = Literal["bending_x", "bending_y", "torsion", "shear_x", "shear_y", "extension"]
StrainChoice = Annotated[
    Annotated[Literal["planar", "kirchhoff", "reissner"], SINGLE]
    | Annotated[tuple[StrainName, ...], NotEmpty(NO_STRAIN), AfterValidator(without_repetition), SEVERAL],
    BY_LENGTH,
]


# Section


class SectionRecord(Record):
    """A cross-section of a rod.

    A shape is a record here and a class in model/sections.py with its area and second moments.

    Attributes:
        radius_key: key of the outer radius of a round section, for contact and flow; None for other shapes.
    """

    radius_key: ClassVar[str | None] = None

    shear_correction: Positive = Field(
        1.0, description="k in the shear stiffness k G A, without unit; 1 as in report (1.21)"
    )


SECTIONS: Family[SectionRecord] = Family("section", key="shape")
"""Shapes of cross-sections."""


@SECTIONS.register
class Circle(SectionRecord):
    """A solid circular cross-section."""

    example: ClassVar[str] = """\
section = { shape = "circle", radius = { base = 2.0e-3, tip = 1.0e-3 } }     # tapered
"""

    radius_key: ClassVar[str] = "radius"

    shape: Literal["circle"] = Field(description="solid circle")
    radius: Size = Field(description="radius, m; a list of two goes linearly from base to tip")


@SECTIONS.register
class Annulus(SectionRecord):
    """A circular tube."""

    example: ClassVar[str] = """\
section = { shape = "annulus", outer_radius = 2.0e-3, inner_radius = 1.5e-3 }
"""

    radius_key: ClassVar[str] = "outer_radius"

    shape: Literal["annulus"] = Field(description="circular tube")
    outer_radius: Size = Field(description="outer radius, m; a list of two goes linearly from base to tip")
    inner_radius: SizeOrZero = Field(description="inner radius, m; a list of two goes linearly from base to tip")

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """The bore fits into the tube at both ends."""
        outer = ends_of(given.get("outer_radius"))
        inner = ends_of(given.get("inner_radius"))
        # Both are linear in X, so that the test at both ends suffices.
        for bore, wall in zip(inner, outer, strict=False):
            if bore >= wall:
                problem = f"must be < outer_radius at both ends, got {shown(bore)} in {shown(wall)}"
                yield Fault(("inner_radius",), problem)
                return


@SECTIONS.register
class Rectangle(SectionRecord):
    """A solid rectangular cross-section."""

    example: ClassVar[str] = """\
section = { shape = "rectangle", width = 1.0e-2, height = 1.0e-3 }
"""

    shape: Literal["rectangle"] = Field(description="solid rectangle")
    width: Size = Field(description="width along local x, m; a list of two goes linearly from base to tip")
    height: Size = Field(description="height along local y, m; a list of two goes linearly from base to tip")


Section = Annotated[Circle | Annulus | Rectangle, SECTIONS]


class Stiffness(Record):
    """Diagonal of the Hooke tensor, each constant or linear from base to tip."""

    example: ClassVar[str] = """\
stiffness = { bending_x = 1.0, bending_y = 1.0, torsion = 0.8 }
linear_density = 0.01
"""

    bending_x: Size | None = Field(None, description="bending stiffness about local x, N m²")
    bending_y: Size | None = Field(None, description="bending stiffness about local y, N m²")
    torsion: Size | None = Field(None, description="torsional stiffness, N m²")
    shear_x: Size | None = Field(None, description="shear stiffness along local x, N")
    shear_y: Size | None = Field(None, description="shear stiffness along local y, N")
    extension: Size | None = Field(None, description="axial stiffness, N")


Row6 = Annotated[tuple[Number, Number, Number, Number, Number, Number], listed(6, "6 numbers")]
StiffnessMatrix = Annotated[tuple[Row6, Row6, Row6, Row6, Row6, Row6], listed(6, "6 rows of 6 numbers")]

ShareOfStiffness = Annotated[Number, Field(gt=0, lt=1)]


class PronyTerm(Record):
    """A spring and a dashpot in series, in parallel with the rod's own elasticity: its stress relaxes."""

    example: ClassVar[str] = """\
damping = { prony = [{ share = 0.2, time = 0.03 }, { share = 0.1, torsion = 0.05, time = 0.5 }] }
"""

    share: ShareOfStiffness = Field(
        description="stiffness of the spring over the instantaneous stiffness of the rod, below 1, without unit"
    )
    bending_x: ShareOfStiffness | None = Field(None, description="share of bending about local x, if it differs")
    bending_y: ShareOfStiffness | None = Field(None, description="share of bending about local y, if it differs")
    torsion: ShareOfStiffness | None = Field(None, description="share of torsion, if it differs")
    shear_x: ShareOfStiffness | None = Field(None, description="share of shear along local x, if it differs")
    shear_y: ShareOfStiffness | None = Field(None, description="share of shear along local y, if it differs")
    extension: ShareOfStiffness | None = Field(None, description="share of extension, if it differs")
    time: Positive = Field(description="relaxation time τ of its stress at constant strain, s")


class Damping(Record):
    """Damping in motion alone: Kelvin–Voigt, stress H (ξ − ξ⁰) + Υ ξ̇; branches whose stress relaxes; and by mass.

    Damping proportional to mass is a force −α ρA ṙ per length.
    """

    example: ClassVar[str] = """\
damping = { retardation_time = 0.01 }
"""

    retardation_time: NotNegative | None = Field(
        None, description="τ in Υ = τ H with the Hooke tensor H, s; instead of coefficients"
    )
    mass_proportional: NotNegative | None = Field(
        None,
        description="α of a force −α ρA ṙ per length, and of the corresponding couples, on the rod and "
        "on disks fixed to it, 1/s; it adds α/(2ω) to the damping ratio of a mode",
    )
    bending_x: SizeOrZero | None = Field(None, description="damping of bending about local x, N m² s; 0 when left out")
    bending_y: SizeOrZero | None = Field(None, description="damping of bending about local y, N m² s; 0 when left out")
    torsion: SizeOrZero | None = Field(None, description="damping of torsion, N m² s; 0 when left out")
    shear_x: SizeOrZero | None = Field(None, description="damping of shear along local x, N s; 0 when left out")
    shear_y: SizeOrZero | None = Field(None, description="damping of shear along local y, N s; 0 when left out")
    extension: SizeOrZero | None = Field(None, description="damping of extension, N s; 0 when left out")
    prony: tuple[PronyTerm, ...] = Field(
        (), description="branches whose stress relaxes, each a spring and a dashpot in series"
    )

    @property
    def by_viscosity(self) -> bool:
        """Whether there is Kelvin–Voigt damping."""
        return any(getattr(self, name) is not None for name in ("retardation_time", *STRAINS))

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """Damping has a retardation time or coefficients, not both, or branches, or a part by mass; it is not empty."""
        coefficients = [name for name in STRAINS if name in given]
        if "retardation_time" in given and coefficients:
            yield Fault((coefficients[0],), "stands beside retardation_time", "give one of the two")
        others = coefficients or given.get("prony") or "mass_proportional" in given
        if "retardation_time" not in given and not others:
            remedy = "give retardation_time, s, coefficients by strain such as bending_x, prony, or mass_proportional"
            yield Fault(("retardation_time",), "missing", remedy)
        tables = [table_of(branch) for branch in list_of(given.get("prony"))]
        shares = [[numbers_of(table.get(name, table.get("share"))) for table in tables] for name in STRAINS]
        total = max(sum(map(sum, of_strain)) for of_strain in shares)
        if total >= 1.0:
            problem = f"must have shares that add up to less than 1, got {shown(total)}"
            yield Fault(("prony",), problem, "the rest of the instantaneous stiffness carries loads at rest")


# Shape and pose


class Intrinsic(Record):
    """Strains of the unloaded rod, ξ⁰."""

    example: ClassVar[str] = """\
intrinsic = { curvature = [0, { base = 4.0, tip = 6.0 }, 0] }     # bent about y, more so towards the tip
"""

    curvature: Polynomials = Field(
        (0.0, 0.0, 0.0), description="K_x, K_y, K_z, 1/m; a component may list Legendre coefficients in 2X − 1"
    )
    tangent: Polynomials = Field(
        (0.0, 0.0, 1.0),
        description="Γ_x, Γ_y, Γ_z, without unit; a component may list Legendre coefficients in 2X − 1",
    )


class Base(Oriented):
    """Pose of the section X = 0, in the world or in a section of another rod."""

    example: ClassVar[str] = """\
base = { rod = "arm", at = 0.5, tangent = [1, 0, 0] }     # branches off sideways
"""

    rod: str | None = Field(
        None, description="name of the rod that carries this one: the pose of the base is then that in its section"
    )
    at: Annotated[
        Number,
        above_base("at its base the other rod does not move: give a pose in the world"),
        ABOVE_BASE,
    ] = Field(1.0, description="abscissa X of the carrying section, without unit, above 0 and at most 1; with rod")
    position: Vector = Field((0.0, 0.0, 0.0), description="position of the base, m")
    quaternion: Quaternion = Field(
        (1.0, 0.0, 0.0, 0.0), description="orientation of the base w, x, y, z, of norm 1, without unit"
    )
    free: StrictBool = Field(
        False, description="whether nothing holds the base in motion: the rod starts at this pose, free in space"
    )

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """A tangent excludes a quaternion, a section needs its rod, and a carried base is not free."""
        yield from super().conflicts(given)
        if "at" in given and "rod" not in given:
            yield Fault(("at",), "stands without rod", "name the rod that carries this one, or leave it out")
        if given.get("free") is True and "rod" in given:
            yield Fault(("free",), "stands beside rod", "a base that a rod carries is not free: leave one of them out")

    @classmethod
    def settled(cls, given: Table) -> Table:
        """A tangent without a twist stays a tangent."""
        return given if given.get("tangent") is not None and "twist" not in given else super().settled(given)

    def parameter_refusal(self, key: str) -> tuple[str, str] | None:
        """Refuse an orientation as a parameter other than as a quaternion."""
        if key == "tangent" or (key == "quaternion" and self.tangent is not None):
            return "is given by a direction", "give the quaternion instead, and name that"
        return super().parameter_refusal(key)

    def held(self) -> Base:
        """This base, clamped at its initial pose."""
        return self.model_copy(update={"free": False}) if self.free else self


RotaryInertia = Annotated[tuple[NotNegative, NotNegative, NotNegative], listed(3, "3 numbers")]


class Rod(Entry):
    """An elastic rod, held at its base."""

    example: ClassVar[str] = """\
[[rods]]
name = "finger"
length = 0.2
strain = "kirchhoff"
material = { youngs_modulus = 2.0e9, poisson_ratio = 0.4, density = 1100.0 }
section = { shape = "circle", radius = 2.0e-3 }
base = { position = [0, 0, 0.1], tangent = [1, 0, 0] }
"""

    inputs: ClassVar[Mapping[str, InputField]] = {
        "length": InputField("m", 1, positive=True, geometry=True),
        "base.position": InputField("m", 3, axes="world", geometry=True),
        "base.quaternion": InputField("1", 4, nonzero=True, geometry=True),
    }

    name: Name = Field(description="name of the rod, a letter, then letters, digits and underscores")
    length: Positive = Field(description="undeformed length, m")
    strain: StrainChoice = Field(
        description="admitted strains: 'planar' (bending in the local x–z plane), 'kirchhoff' (bending and torsion), "
        "'reissner' (all six), or a list out of bending_x, bending_y, torsion, shear_x, shear_y, extension"
    )
    basis: Literal["legendre", "chebyshev"] = Field("legendre", description="polynomials of the strains")
    material: ElasticMaterial | None = Field(None, description="material of the rod; with section")
    section: Section | None = Field(None, description="its cross-section; with material")
    stiffness: Stiffness | None = Field(None, description="stiffnesses, N m² and N; instead of material and section")
    stiffness_matrix: StiffnessMatrix | None = Field(
        None,
        description="full symmetric 6 × 6 matrix of the strains in their order, coupled ones too, N m², N m and N; "
        "instead of material and section, or of stiffness",
    )
    linear_density: Size | None = Field(
        None,
        description="mass per length, kg/m, with stiffness or stiffness_matrix; a list of two goes linearly from "
        "base to tip",
    )
    rotary_inertia: RotaryInertia | None = Field(
        None,
        description="moments of inertia per length about section x, y and tangent, kg m; with linear_density, 0 when "
        "left out; with material and section they follow from the density",
    )
    damping: Damping | None = Field(None, description="internal damping, in motion alone")
    intrinsic: Intrinsic = Field(Intrinsic(), description="strains of the unloaded rod, 1/m and without unit")
    base: Base = Field(Base(), description="pose of the base, in the world or in a section of another rod, m")

    @property
    def admitted(self) -> tuple[int, ...]:
        """Indices of the admitted strains, ascending, in the order K_x, K_y, K_z, Γ_x, Γ_y, Γ_z."""
        return admitted_strains(self.strain)

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """The elasticity is given once, for every admitted strain; damping only for these; inertia only with mass."""
        yield from _elasticity_given_once(given)
        yield from _inertia_without_mass(given)
        admitted = [STRAINS[index] for index in admitted_strains(given.get("strain"))]
        yield from _not_positive(given.get("stiffness_matrix"), admitted_strains(given.get("strain")))
        stiffness = given.get("stiffness")
        if isinstance(stiffness, Mapping):
            for name in admitted:
                if name not in stiffness:
                    yield Fault(("stiffness", name), "missing", f"the rod admits {name}")
        # Without a valid choice of strains none is known to lack a stiffness.
        if not admitted:
            return
        damping = table_of(given.get("damping"))
        others = [name for name in STRAINS if name not in admitted]
        remedy = f"its strains: {', '.join(admitted)}"
        tables: list[tuple[Path, Any]] = [(("damping",), damping)]
        tables += [(("damping", "prony", i), branch) for i, branch in enumerate(list_of(damping.get("prony")))]
        for place, table in tables:
            problem = "belongs to a strain that the rod does not admit"
            yield from below(place, refused_keys(table_of(table), others, problem, remedy))

    @classmethod
    def input_conflicts(cls, field: str, given: Table, scene: SceneTables) -> Iterator[Fault]:
        """The pose of a base can be free only in the world, and without leaving the plane in which its tip is held."""
        if not field.startswith("base."):
            return
        name = given.get("name")
        base = table_of(given.get("base"))
        # The base of a carried rod, and a free base, is an unknown, not an input.
        if "rod" in base:
            yield Fault((), f"{shown(name)} starts on another rod", "move the base of that one")
        elif base.get("free") is True:
            yield Fault((), f"the base of {shown(name)} is free", "nothing holds it, only loads act on it")
        holding = (*scene.tables("supports"), *scene.tables("joints"))
        # A joint at the base moves with it.
        held = any(table.get("rod") == name and table.get("at") != 0 for _, table in holding)
        admitted = set(admitted_strains(given.get("strain")))
        # A rod in a plane has constraints in its plane alone: out of the plane they would be too few.
        if held and admitted <= IN_PLANE:
            problem = f"{shown(name)} bends in a plane and its tip is held"
            yield Fault((), problem, "admit torsion, or its base could leave the plane")


def is_round(section: Any) -> bool:
    """Whether the table of a section has the shape of a round one."""
    record = SECTIONS.record_of(section) if isinstance(section, Mapping) else None
    return record is not None and record.radius_key is not None


def _elasticity_given_once(rod: Table) -> Iterator[Fault]:
    made_of = [key for key in ("material", "section") if key in rod]
    direct = [key for key in ("stiffness", "stiffness_matrix", "linear_density") if key in rod]
    if "stiffness" in rod and "stiffness_matrix" in rod:
        yield Fault(("stiffness_matrix",), "stands beside stiffness", "give one of the two")
    if made_of and direct:
        remedy = "give material and section, or stiffness and linear_density"
        yield Fault((direct[0],), f"stands beside {' and '.join(made_of)}", remedy)
    elif made_of == ["material"]:
        yield Fault(("section",), "missing", "a material needs a section")
    elif made_of == ["section"]:
        yield Fault(("material",), "missing", "a section needs a material")
    elif not made_of and "stiffness" not in rod and "stiffness_matrix" not in rod:
        yield Fault(("material",), "missing", "give material and section, or stiffness")


def _not_positive(matrix: Any, admitted: Sequence[int]) -> Iterator[Fault]:
    """Faults of a stiffness matrix that is not symmetric or not positive definite."""
    rows = [numbers_of(row) for row in list_of(matrix)]
    if len(rows) != len(STRAINS) or any(len(row) != len(STRAINS) for row in rows):
        return
    for i, j in itertools.combinations(range(len(STRAINS)), 2):
        if rows[i][j] != rows[j][i]:
            problem = f"must be {shown(rows[i][j])}, as [{i}][{j}], got {shown(rows[j][i])}"
            yield Fault(("stiffness_matrix", j, i), problem, "the matrix is symmetric")
            return
    entries = np.array(rows)
    block = entries[np.ix_(admitted, admitted)]
    diagonal = np.diag(block)
    # In units of the diagonal: entries have different units.
    if not np.all(diagonal > 0.0):
        index = admitted[int(np.argmin(diagonal > 0.0))]
        yield Fault(("stiffness_matrix", index, index), f"must be > 0, got {shown(entries[index, index])}")
    elif len(block) and np.linalg.eigvalsh(block / np.sqrt(np.outer(diagonal, diagonal)))[0] <= 0.0:
        problem = "must be positive definite in the admitted strains: some strain would set energy free"
        yield Fault(("stiffness_matrix",), problem)


def _inertia_without_mass(rod: Table) -> Iterator[Fault]:
    """Faults of a rotary inertia with a material or a section, from which it follows, or without a mass per length."""
    if "rotary_inertia" not in rod:
        return
    made_of = [key for key in ("material", "section") if key in rod]
    if made_of:
        remedy = "it follows from the density: leave it out, or give stiffness and linear_density"
        yield Fault(("rotary_inertia",), f"stands beside {' and '.join(made_of)}", remedy)
    elif "linear_density" not in rod:
        yield Fault(("linear_density",), "missing", "a rotary inertia belongs to a mass per length, kg/m")


def admitted_strains(strain: Any) -> tuple[int, ...]:
    """Ascending indices of the strains that the key ``strain`` of a rod admits; empty if it is faulty."""
    if isinstance(strain, str):
        return PRESETS.get(strain, ())
    # In the order of the strains, not of the list.
    return tuple(index for index, name in enumerate(STRAINS) if name in list_of(strain))
