"""Materials of rods: their moduli and density, and the law by which stress follows from strain.

A law is a record here and a class in model/materials.py that gives its energy. See docs/theory.md, section 6.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field

from cosserat_casadi.scene.families import Family
from cosserat_casadi.scene.faults import Fault, Table, list_of, numbers_of, one_of, refused_keys, shown
from cosserat_casadi.scene.records import Record
from cosserat_casadi.scene.values import NotEmpty, NotNegative, Number, PoissonRatio, Positive, Whole, listed

INCOMPRESSIBLE = 0.5
"""Poisson's ratio of a material that keeps its volume."""

MODULUS_SLACK = 0.01
"""Share by which the modulus of coefficients, which are often rounded, may differ from Young's modulus."""


class Material(Record):
    """An isotropic material: moduli at small strains, and density."""

    example: ClassVar[str] = """\
material = { youngs_modulus = 2.0e9, poisson_ratio = 0.4, density = 1100.0 }
"""

    fibres: ClassVar[int] = 0
    """Least points across half of a section at which the law is summed; 0 for a law that is not summed."""

    youngs_modulus: Positive = Field(description="Young's modulus E, Pa")
    poisson_ratio: PoissonRatio | None = Field(
        None, description="Poisson's ratio, without unit; instead of shear_modulus"
    )
    shear_modulus: Positive | None = Field(None, description="shear modulus G, Pa; instead of poisson_ratio")
    density: Positive | None = Field(None, description="density, kg/m³; needed where gravity acts")

    def in_proportion(self) -> Self:
        """The material with coefficients scaled to its Young's modulus, for a law whose shape they give."""
        return self

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """Require one of Poisson's ratio and the shear modulus."""
        yield from one_of("poisson_ratio", "shear_modulus", given, "give poisson_ratio or shear_modulus, Pa")


MATERIALS: Family[Material] = Family("material", key="law", default="linear")
"""Laws of materials of rods."""


@MATERIALS.register
class LinearMaterial(Material):
    """A linear elastic material."""

    law: Literal["linear"] = Field("linear", description="stress in proportion to strain")


# Measured curves


Point = Annotated[tuple[Number, NotNegative | Number], listed(2, "2 numbers, strain and stress")]
Curve = Annotated[tuple[Point, ...], NotEmpty()]


class StressTable(Record):
    """Measured curves of a section, stress against strain, by strain; both are zero in the unloaded rod."""

    example: ClassVar[str] = """\
material.law = "table"
material.youngs_modulus = 2.0e9
material.poisson_ratio = 0.4
material.table = { bending_y = [[5, 0.12], [10, 0.2]], torsion = [[10, 0.05], [20, 0.08]] }
"""

    bending: Curve | None = Field(
        None, description="pairs of curvature, in 1/m, and moment in any direction, N m; of round sections"
    )
    bending_x: Curve | None = Field(None, description="pairs of curvature, in 1/m, and moment about local x, N m")
    bending_y: Curve | None = Field(None, description="pairs of curvature, in 1/m, and moment about local y, N m")
    torsion: Curve | None = Field(None, description="pairs of twist, in 1/m, and moment about the tangent, N m")
    shear_x: Curve | None = Field(None, description="pairs of shear and force along local x, N")
    shear_y: Curve | None = Field(None, description="pairs of shear and force along local y, N")
    extension: Curve | None = Field(None, description="pairs of stretch less 1 and axial force, N")

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """Require curves that rise through zero; refuse a bending curve of one axis beside that of all directions."""
        if not given:
            yield Fault((), "has no curve", "give stress against strain, as in bending_y = [[5, 0.12], [10, 0.2]]")
        for name, curve in given.items():
            yield from _curve_faults(name, curve)
        if "bending" in given:
            remedy = "give bending of round sections, or the two axes"
            yield from refused_keys(given, ("bending_x", "bending_y"), "stands beside bending", remedy)


def _curve_faults(name: str, curve: Any) -> Iterator[Fault]:
    """Faults of a curve: strains that do not rise, stresses that fall, a stress in the unloaded rod."""
    if not isinstance(curve, list | tuple):
        return
    points = [numbers_of(point) for point in curve]
    if any(len(point) != 2 for point in points):
        return
    for i, (before, point) in enumerate(itertools.pairwise(points), 1):
        if not point[0] > before[0]:
            problem = f"must be > {shown(before[0])}, the strain before it, got {shown(point[0])}"
            yield Fault((name, i, 0), problem)
            return
        if point[1] < before[1]:
            problem = f"must be >= {shown(before[1])}, the stress before it, got {shown(point[1])}"
            yield Fault((name, i, 1), problem, "a rod whose stress falls with strain buckles by itself")
            return
    if name == "bending" and points and points[0][0] < 0.0:
        yield Fault((name, 0, 0), f"must be >= 0, got {shown(points[0][0])}", "all directions of bending are alike")
        return
    if not points or points[-1][0] <= 0.0:
        yield Fault((name,), "has no point of a strain above 0", "give strain and stress, as in [[5, 0.12], [10, 0.2]]")
        return
    through_zero = [0.0, 0.0] in points
    if points[0][0] < 0.0 and not through_zero:
        yield Fault((name,), "must have the point [0, 0]", "stress and strain count from the unloaded rod")
    if points[0][0] >= 0.0 and not through_zero and not points[0][1] > 0.0:
        yield Fault((name, 0, 1), f"must be > 0, got {shown(points[0][1])}", "the curve begins at [0, 0]")
    if points[0][0] == 0.0 and points[0][1] != 0.0:
        yield Fault((name, 0, 1), f"must be 0 at strain 0, got {shown(points[0][1])}")


@MATERIALS.register
class TabulatedMaterial(Material):
    """A material with measured sections: stress rises smoothly between the points of a curve.

    A curve without negative strains holds for both signs. Strains without a curve are linear. Beyond its ends a curve
    goes on straight, and results there are reported.
    """

    example: ClassVar[str] = """\
material.law = "table"
material.youngs_modulus = 2.0e9
material.poisson_ratio = 0.4
material.table = { bending_y = [[0, 0], [5, 0.12], [10, 0.2]] }
"""

    law: Literal["table"] = Field(description="measured moments and forces of the section")
    table: StressTable = Field(description="stress against strain, by strain")

    def parameter_refusal(self, key: str) -> tuple[str, str] | None:
        """Refuse a measured curve as a parameter, since no single number of it could vary."""
        if key == "table":
            return "is a measured curve", "a curve that depends on few numbers is law = 'polynomial'"
        return super().parameter_refusal(key)


class EnergyTerm(Record):
    """A term of a section's energy per length: a coefficient times powers of changes of strains."""

    example: ClassVar[str] = """\
material.law = "polynomial"
material.youngs_modulus = 2.0e9
material.poisson_ratio = 0.4
material.terms = [{ bending_y = 4, coefficient = 1.0e-6 }]
"""

    coefficient: Number = Field(description="factor, J/m over the unit of the product of powers")
    bending_x: Whole | None = Field(None, ge=1, le=12, description="power of the change of K_x")
    bending_y: Whole | None = Field(None, ge=1, le=12, description="power of the change of K_y")
    torsion: Whole | None = Field(None, ge=1, le=12, description="power of the change of K_z")
    shear_x: Whole | None = Field(None, ge=1, le=12, description="power of the change of Γ_x")
    shear_y: Whole | None = Field(None, ge=1, le=12, description="power of the change of Γ_y")
    extension: Whole | None = Field(None, ge=1, le=12, description="power of the change of Γ_z")

    @property
    def powers(self) -> tuple[int, ...]:
        """Powers of the six strains, in their order."""
        names = ("bending_x", "bending_y", "torsion", "shear_x", "shear_y", "extension")
        return tuple(getattr(self, name) or 0 for name in names)

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """The stress of a term is zero in the unloaded rod: its powers add up to at least two."""
        powers = [value for key, value in given.items() if key != "coefficient"]
        if all(isinstance(power, int) for power in powers) and sum(powers) < 2:
            problem = "must have powers that add up to at least 2"
            yield Fault((), problem, "as in { bending_y = 4, coefficient = 1e-6 }, or strains that are coupled")


@MATERIALS.register
class PolynomialMaterial(Material):
    """A material whose sections store polynomials of their strains in addition to the linear elastic energy."""

    example: ClassVar[str] = """\
material.law = "polynomial"
material.youngs_modulus = 2.0e9
material.poisson_ratio = 0.4
material.terms = [{ bending_y = 4, coefficient = 1.0e-6 }, { torsion = 1, extension = 1, coefficient = 0.02 }]
"""

    law: Literal["polynomial"] = Field(description="polynomial energy beside the linear one, coupled strains too")
    terms: Annotated[tuple[EnergyTerm, ...], NotEmpty()] = Field(description="terms of the energy per length")


# Soft matter


class IncompressibleMaterial(Material):
    """An incompressible material of rubber elasticity: fibres stretch by its uniaxial law.

    Attributes:
        moduli: keys of the coefficients in Pa, which Young's modulus scales.
    """

    moduli: ClassVar[tuple[str, ...]] = ()

    fibres: ClassVar[int] = 3

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """The shear modulus is E/3 by default; the coefficients agree with Young's modulus."""
        if "poisson_ratio" in given and "shear_modulus" in given:
            yield Fault(("shear_modulus",), "stands beside poisson_ratio", "give one of the two, or none")
        modulus = numbers_of(given.get("youngs_modulus"))
        small = cls.small_strain_modulus(given)
        if small is None or len(modulus) != 1:
            return
        if abs(small - modulus[0]) > MODULUS_SLACK * abs(modulus[0]):
            problem = f"must be the small-strain modulus of the coefficients, {small:.6g} Pa, got {shown(modulus[0])}"
            yield Fault(("youngs_modulus",), problem)

    @classmethod
    def small_strain_modulus(cls, given: Table) -> float | None:
        """Young's modulus of the coefficients of a table, Pa; None for faulty or missing coefficients."""
        return None

    def in_proportion(self) -> Self:
        """The material with its coefficients scaled to its Young's modulus; unchanged if they have no modulus."""
        given = self.model_dump(exclude_unset=True)
        small = self.small_strain_modulus(given)
        if small is None or not small > 0.0:
            return self
        scale = self.youngs_modulus / small
        return self.model_copy(update={key: _scaled(given[key], scale) for key in self.moduli if key in given})


def _scaled(modulus: Any, scale: float) -> Any:
    """A coefficient times a scale; pairs have their first numbers scaled."""
    if isinstance(modulus, tuple):
        return tuple((first * scale, exponent) for first, exponent in modulus)
    return modulus * scale


@MATERIALS.register
class NeoHookean(IncompressibleMaterial):
    """Rubber by one modulus, W = μ/2 (λ² + 2/λ − 3) with μ = E/3."""

    example: ClassVar[str] = """\
material = { law = "neo_hookean", youngs_modulus = 1.2e6, density = 1080.0 }
"""

    law: Literal["neo_hookean"] = Field(description="rubber by one modulus")


@MATERIALS.register
class MooneyRivlin(IncompressibleMaterial):
    """Rubber by two coefficients, W = c10 (I₁ − 3) + c01 (I₂ − 3)."""

    example: ClassVar[str] = """\
material = { law = "mooney_rivlin", youngs_modulus = 1.2e6, c10 = 0.15e6, c01 = 0.05e6 }
"""

    moduli: ClassVar[tuple[str, ...]] = ("c10", "c01")

    law: Literal["mooney_rivlin"] = Field(description="rubber by two coefficients")
    c10: Number = Field(description="coefficient of I₁ − 3, Pa")
    c01: Number = Field(description="coefficient of I₂ − 3, Pa; E = 6 (c10 + c01)")

    @classmethod
    def small_strain_modulus(cls, given: Table) -> float | None:
        """6 (c10 + c01), Pa."""
        coefficients = numbers_of([given.get("c10"), given.get("c01")])
        return 6 * sum(coefficients) if coefficients else None


@MATERIALS.register
class Yeoh(IncompressibleMaterial):
    """Rubber that stiffens, W = c1 (I₁ − 3) + c2 (I₁ − 3)² + c3 (I₁ − 3)³."""

    example: ClassVar[str] = """\
material = { law = "yeoh", youngs_modulus = 0.66e6, c1 = 0.11e6, c2 = 0.02e6 }
"""

    moduli: ClassVar[tuple[str, ...]] = ("c1", "c2", "c3")

    law: Literal["yeoh"] = Field(description="rubber that stiffens")
    c1: Positive = Field(description="coefficient of I₁ − 3, Pa; E = 6 c1")
    c2: Number = Field(0.0, description="coefficient of (I₁ − 3)², Pa")
    c3: Number = Field(0.0, description="coefficient of (I₁ − 3)³, Pa")

    @classmethod
    def small_strain_modulus(cls, given: Table) -> float | None:
        """6 c1, Pa."""
        coefficients = numbers_of([given.get("c1")])
        return 6 * coefficients[0] if coefficients else None


OgdenPair = Annotated[tuple[Number, Number], listed(2, "2 numbers, μ and α")]


@MATERIALS.register
class Ogden(IncompressibleMaterial):
    """Rubber by powers of stretches, W = Σ μ/α (λ₁^α + λ₂^α + λ₃^α − 3)."""

    example: ClassVar[str] = """\
material = { law = "ogden", youngs_modulus = 1.2e6, ogden = [[0.4e6, 2.0]] }
"""

    moduli: ClassVar[tuple[str, ...]] = ("ogden",)

    law: Literal["ogden"] = Field(description="rubber by powers of stretches")
    ogden: Annotated[tuple[OgdenPair, ...], NotEmpty()] = Field(description="pairs of μ, in Pa, and α; E = 3/2 Σ μ α")

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """Require that every pair is stable by itself."""
        yield from super().conflicts(given)
        for i, pair in enumerate(list_of(given.get("ogden"))):
            numbers = numbers_of(pair)
            if len(numbers) == 2 and not numbers[0] * numbers[1] > 0.0:
                problem = f"must have μ α > 0, got {shown(numbers[0])} and {shown(numbers[1])}"
                yield Fault(("ogden", i), problem, "a pair with μ α <= 0 is unstable at small strains")

    @classmethod
    def small_strain_modulus(cls, given: Table) -> float | None:
        """3/2 Σ μ α, Pa."""
        pairs = given.get("ogden")
        if not isinstance(pairs, list | tuple):
            return None
        products = []
        for pair in pairs:
            numbers = numbers_of(pair)
            if len(numbers) != 2:
                return None
            products.append(numbers[0] * numbers[1])
        return 1.5 * sum(products)


# Shape-memory alloys


@MATERIALS.register
class Superelastic(Material):
    """A superelastic wire: moment against curvature in three straight pieces with rounded corners.

    It applies to bending of round sections in every direction; other strains are linear. The record gives strains
    of the outermost fibre. One branch is computed at a time: there is no hysteresis.
    """

    example: ClassVar[str] = """\
material.law = "superelastic"
material.youngs_modulus = 6.0e10
material.poisson_ratio = 0.33
material.plateau_start = 0.01
material.plateau_end = 0.06
material.plateau_modulus = 4.0e9
material.end_modulus = 2.5e10
"""

    law: Literal["superelastic"] = Field(description="loading or unloading plateau of a shape-memory alloy, in bending")
    plateau_start: Positive = Field(
        description="strain of the outermost fibre at which the plateau begins, without unit"
    )
    plateau_end: Positive = Field(description="strain of the outermost fibre where the plateau ends, without unit")
    plateau_modulus: Positive = Field(description="slope of the plateau as a modulus, Pa")
    end_modulus: Positive | None = Field(None, description="slope beyond the plateau, Pa; Young's modulus if left out")
    branch: Literal["loading", "unloading"] = Field("loading", description="the branch that is computed")
    unloading_start: Positive | None = Field(
        None,
        description="strain at which the lower plateau begins, without unit; with branch = 'unloading'",
    )

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """Require a plateau with a length, and a beginning of the unloading branch below that of the loading branch."""
        yield from super().conflicts(given)
        start = numbers_of(given.get("plateau_start"))
        end = numbers_of(given.get("plateau_end"))
        unloading = numbers_of(given.get("unloading_start"))
        if start and end and not end[0] > start[0]:
            yield Fault(("plateau_end",), f"must be > plateau_start, {shown(start[0])}, got {shown(end[0])}")
        if given.get("branch") == "unloading" and "unloading_start" not in given:
            yield Fault(("unloading_start",), "missing", "give the strain at which the lower plateau begins")
        if given.get("branch") != "unloading" and "unloading_start" in given:
            yield Fault(("unloading_start",), "stands without branch = 'unloading'", "leave it out")
        if unloading and start and not unloading[0] < start[0]:
            problem = f"must be < plateau_start, {shown(start[0])}, got {shown(unloading[0])}"
            yield Fault(("unloading_start",), problem)


ElasticMaterial = Annotated[
    LinearMaterial | TabulatedMaterial | PolynomialMaterial | NeoHookean | MooneyRivlin | Yeoh | Ogden | Superelastic,
    MATERIALS,
]
"""A material of a rod with any law."""
