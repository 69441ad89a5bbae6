"""Laws of materials: the energy of a section beyond its Hooke tensor's, from the record of the material.

A member is one class: it gives :meth:`Law.beyond_hooke`. Residual, Jacobian, stability, motion and C follow from the
energy. The Hooke tensor stays that of Young's modulus; it scales the equations. See docs/theory.md, section 6.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, ClassVar, Generic, TypeVar, final

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.numbers import Numbers, Scalar, any_symbolic, column, is_symbolic, repeated, side_by_side
from cosserat_casadi.maths.splines import HermiteCurve, monotone_curve
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.sections import SHAPES, sizes_along, sizes_of
from cosserat_casadi.rod.properties import STRAINS, EnergyBeyondHooke, Field
from cosserat_casadi.scene import material_records as records
from cosserat_casadi.scene.families import Kind, Kinds, register

RecordType = TypeVar("RecordType", bound=records.Material)

BENDING = (0, 1)
"""Indices of the two curvatures."""

FIBRE_STRAINS = (0, 1, 5)
"""Indices of the strains that stretch fibres along the rod: the two curvatures and extension."""

ROUNDED = 0.1
"""Half of the width of a rounded corner, relative to the plateau or, where that is shorter, the strain before it."""

SMALLEST_BENDING = 1e-9
"""Curvature, relative to the last point of a curve, below which its direction does not matter."""


@dataclass(frozen=True)
class LawOfRod:
    """The rod of a material law.

    Attributes:
        rod: the record of the rod, whose numbers may be expressions of parameters.
        hooke: abscissae (k,) ↦ diagonal of the Hooke tensor (k, 6).
        fibres: points across half of a section at which a law is summed; 0 for the fewest of the law.
    """

    rod: scenes.Rod
    hooke: Field
    fibres: int = 0

    @property
    def admitted(self) -> tuple[int, ...]:
        """Indices of the strains that the rod admits."""
        return self.rod.admitted

    def columns(self, numbers: Sequence[Scalar], fields: Sequence[Callable[[Numbers], Numbers]] = ()) -> Field:
        """Data of an energy density: numbers that are constant along the rod, then fields, shape (k, d)."""

        def data(X: Numbers) -> Numbers:
            count = X.shape[0]
            constant = [
                ca.repmat(number, count, 1) if is_symbolic(number) else np.full(count, float(number))
                for number in numbers
            ]
            return side_by_side([*constant, *(field(X) for field in fields)])

        return data

    def hooke_of(self, component: int) -> Callable[[Numbers], Numbers]:
        """Stiffness of one strain along the rod."""

        def stiffness(X: Numbers) -> Numbers:
            # A field may have one row for all abscissae.
            return repeated(column(self.hooke(X), component), X.shape[0])

        return stiffness

    def size_of(self, key: str) -> Callable[[Numbers], Numbers]:
        """One size of the section along the rod."""
        section = self.rod.section
        assert section is not None, "a material stands beside a section"
        return lambda X: sizes_along(section, X)[key]


class Law(Kind, ABC, Generic[RecordType]):
    """One law of materials."""

    record: ClassVar[type[records.Material]]
    family = records.MATERIALS
    kinds = Kinds(records.MATERIALS)

    @abstractmethod
    def beyond_hooke(self, material: RecordType, of_rod: LawOfRod) -> EnergyBeyondHooke | None:
        """Energy of a section beyond the Hooke tensor's; None for a linear rod.

        Raises:
            SceneError: the law does not fit the section of the rod.
        """


LAWS = Law.kinds
"""Laws by the words of the scene format."""


@final
@register
class LinearLaw(Law[records.LinearMaterial]):
    """Stress in proportion to strain."""

    record = records.LinearMaterial

    def beyond_hooke(self, material: records.LinearMaterial, of_rod: LawOfRod) -> None:
        """Return None: a linear material has no energy beyond the Hooke tensor's."""
        return


@final
@register
class PolynomialLaw(Law[records.PolynomialMaterial]):
    """Polynomials of the strains."""

    record = records.PolynomialMaterial

    def beyond_hooke(self, material: records.PolynomialMaterial, of_rod: LawOfRod) -> EnergyBeyondHooke | None:
        """Σ c Π Δξ^p; a term with a strain that the rod does not admit is zero."""
        admitted = set(of_rod.admitted)
        terms = [term for term in material.terms if {c for c, power in enumerate(term.powers) if power} <= admitted]
        if not terms:
            return None

        def density(change: Matrix, data: Matrix) -> Matrix:
            products = []
            for i, term in enumerate(terms):
                product = data[i]
                for c, power in enumerate(term.powers):
                    if power:
                        product = product * _power(change[c], power)
                products.append(product)
            return _sum(products)

        return EnergyBeyondHooke(density, of_rod.columns([term.coefficient for term in terms]))


def _sum(terms: Sequence[Matrix]) -> Matrix:
    """Sum of terms, of which there is at least one."""
    return sum(terms[1:], terms[0])


def _power(value: Matrix, exponent: int) -> Matrix:
    """A power by products, whose derivatives at zero are numbers."""
    result = value
    for _ in range(exponent - 1):
        result = result * value
    return result


@final
@register
class TabulatedLaw(Law[records.TabulatedMaterial]):
    """Measured curves, monotone cubics between their points: docs/theory.md, section 6."""

    record = records.TabulatedMaterial

    def beyond_hooke(self, material: records.TabulatedMaterial, of_rod: LawOfRod) -> EnergyBeyondHooke | None:
        """Energy of every curve less the Hooke tensor's."""
        if material.table.bending is not None:
            _refuse_unless_round(of_rod.rod, "table.bending")
        curves = {}
        for component, name in enumerate(STRAINS):
            points = getattr(material.table, name)
            if points is not None and component in of_rod.admitted:
                curves[component] = _curve(points)
        radial = None if material.table.bending is None else _curve(material.table.bending)
        bent = [c for c in BENDING if c in of_rod.admitted and radial is not None]
        stiff = [*curves, *bent[:1]]
        if not stiff:
            return None

        def density(change: Matrix, data: Matrix) -> Matrix:
            energies = []
            for i, (component, curve) in enumerate(curves.items()):
                linear = data[i] / 2 * change[component] ** 2
                energies.append(curve.integral(change[component]) - linear)
            if bent:
                assert radial is not None
                size = _size_of_bending(change, bent, SMALLEST_BENDING * radial.ends[1])
                energies.append(radial.integral(size) - data[len(curves)] / 2 * size**2)
            return _sum(energies)

        def margin(change: Matrix, data: Matrix) -> Matrix:
            shares = [curve.share_left(change[component]) for component, curve in curves.items()]
            if bent:
                assert radial is not None
                shares.append(radial.share_left(_size_of_bending(change, bent, 0.0)))
            return ca.mmin(ca.vertcat(*shares))

        return EnergyBeyondHooke(density, of_rod.columns([], [of_rod.hooke_of(c) for c in stiff]), margin)


def _curve(points: Sequence[Sequence[float]]) -> HermiteCurve:
    """The curve through measured points; one without negative strains is odd, and begins at zero."""
    table = np.array(points, dtype=float)
    if table[0, 0] < 0.0:
        return monotone_curve(table[:, 0], table[:, 1])
    positive = table[table[:, 0] > 0.0]
    strains = np.concatenate([-positive[::-1, 0], [0.0], positive[:, 0]])
    stresses = np.concatenate([-positive[::-1, 1], [0.0], positive[:, 1]])
    return monotone_curve(strains, stresses)


def _size_of_bending(change: Matrix, bent: Sequence[int], smallest: float) -> Matrix:
    """Norm of the change of curvature; ``smallest`` keeps its derivatives finite at zero."""
    squares = _sum([change[component] ** 2 for component in bent])
    return ca.sqrt(squares + smallest**2)


@final
@register
class SuperelasticLaw(Law[records.Superelastic]):
    """Moment against curvature in three straight pieces with rounded corners."""

    record = records.Superelastic

    def beyond_hooke(self, material: records.Superelastic, of_rod: LawOfRod) -> EnergyBeyondHooke | None:
        """Energy of the changes of slope at the two corners of the curve."""
        radius_key = _refuse_unless_round(of_rod.rod, "law")
        bent = [c for c in BENDING if c in of_rod.admitted]
        if not bent:
            return None
        start: Scalar = material.plateau_start
        if material.unloading_start is not None:
            start = material.unloading_start
        end_modulus = material.youngs_modulus if material.end_modulus is None else material.end_modulus
        slopes = [modulus / material.youngs_modulus for modulus in (material.plateau_modulus, end_modulus)]
        numbers = [start, material.plateau_end, *slopes]
        data = of_rod.columns(numbers, [of_rod.size_of(radius_key), of_rod.hooke_of(bent[0])])

        def density(change: Matrix, data: Matrix) -> Matrix:
            begin, end, plateau, beyond, radius, stiffness = ca.vertsplit(data)
            # The corners are away from zero curvature: the root is not needed near it.
            first_rounded = ROUNDED * ca.fmin(begin, end - begin)
            second_rounded = ROUNDED * (end - begin)
            # Strain of the outermost fibre; never below the first corner, so that its root has derivatives.
            squared = _sum([(radius * change[component]) ** 2 for component in bent])
            least = (begin - first_rounded) ** 2
            strain = ca.sqrt(ca.if_else(squared > least, squared, least))
            first = _corner_energy(strain - begin, first_rounded)
            second = _corner_energy(strain - end, second_rounded)
            per_strain = stiffness / radius**2
            return per_strain * ((plateau - 1) * first + (beyond - plateau) * second)

        return EnergyBeyondHooke(density, data)


def _corner_energy(beyond: Matrix, rounded: Matrix) -> Matrix:
    """Second integral of a slope that rises from 0 to 1, linearly from −rounded to rounded."""
    inside = (beyond + rounded) ** 3 / (12 * rounded)
    straight = beyond**2 / 2 + rounded**2 / 6
    return ca.if_else(beyond < -rounded, 0, ca.if_else(beyond < rounded, inside, straight))


class RubberLaw(Law[RecordType], ABC):
    """Fibres along the rod that stretch by the uniaxial law of an incompressible material.

    The energy is summed over points of the section; torsion and shear are linear.
    """

    @abstractmethod
    def coefficients(self, material: RecordType) -> list[Scalar]:
        """Coefficients of the law, and last the small-strain Young's modulus that follows from them."""

    @abstractmethod
    def energy(self, stretch: Matrix, coefficients: Matrix) -> Matrix:
        """Energy density W of a fibre, J/m³, at its stretch λ: its volume is constant, its lateral stress zero."""

    def beyond_hooke(self, material: RecordType, of_rod: LawOfRod) -> EnergyBeyondHooke | None:
        """Energy ∫ (W(λ) − E ε²/2) dA of the section, J/m, with the strain ε = λ − 1 of each fibre."""
        stretched = [c for c in FIBRE_STRAINS if c in of_rod.admitted]
        if not stretched:
            return None
        section = of_rod.rod.section
        assert section is not None
        shape = SHAPES[section.shape]
        keys = list(sizes_of(section))
        count = of_rod.fibres or material.fibres
        if shape.fibres(dict.fromkeys(keys, ca.SX(1.0)), 1) is None:
            problem = f"law = {self.kind!r} sums over fibres, and a section of shape {section.shape!r} has none"
            raise SceneError(Problem(f"{of_rod.rod.name}.section", problem, "give its class a method fibres"))
        coefficients = self.coefficients(material)
        numbers = [material.youngs_modulus, *coefficients]
        data = of_rod.columns(numbers, [of_rod.size_of(key) for key in keys])
        summed = _fibre_sum(self, section.shape, tuple(keys), len(numbers), tuple(stretched), count)
        return EnergyBeyondHooke(summed.density, data, summed.margin)


@dataclass(frozen=True)
class _FibreSum:
    """Energy of a section of rubber, summed over its fibres.

    Attributes:
        law: the law of a fibre.
        shape: shape of the section.
        keys: keys of its sizes, which are the last data.
        numbers: number of the data before these: Young's modulus and the coefficients of the law.
        stretched: indices of the admitted strains that stretch fibres.
        count: points across half of the section.
    """

    law: RubberLaw[Any]
    shape: str
    keys: tuple[str, ...]
    numbers: int
    stretched: tuple[int, ...]
    count: int

    def density(self, change: Matrix, data: Matrix) -> Matrix:
        """Energy beyond the Hooke tensor's per length of the rod, 1×1, J/m."""
        modulus = data[0]
        coefficients = data[1 : self.numbers]
        # Young's modulus scales the law, and the coefficients give its shape.
        scale = modulus / coefficients[-1]
        energies = []
        for strain, area in self._fibres(change, data):
            beyond = scale * self.law.energy(1 + strain, coefficients) - modulus / 2 * strain**2
            energies.append(area * beyond)
        return _sum(energies)

    def margin(self, change: Matrix, data: Matrix) -> Matrix:
        """Least stretch of a fibre, 1×1."""
        least: Matrix = ca.mmin(ca.vertcat(*[strain for strain, _ in self._fibres(change, data)]))
        return 1 + least

    def _fibres(self, change: Matrix, data: Matrix) -> list[tuple[Matrix, Matrix]]:
        """Strain and area of each fibre, m²."""
        sizes = dict(zip(self.keys, ca.vertsplit(data[self.numbers :]), strict=True))
        fibres = []
        for x, y, area in SHAPES[self.shape].fibres(sizes, self.count):
            levers = dict(zip(FIBRE_STRAINS, (y, -x, 1.0), strict=True))
            fibres.append((_sum([levers[component] * change[component] for component in self.stretched]), area))
        return fibres


_fibre_sum = lru_cache(_FibreSum)
"""One object for all equal sums, so that one kernel serves many models."""


@final
@register
class NeoHookeanLaw(RubberLaw[records.NeoHookean]):
    """W = μ/2 (λ² + 2/λ − 3)."""

    record = records.NeoHookean

    def coefficients(self, material: records.NeoHookean) -> list[Scalar]:
        """Coefficient of the law, Young's modulus E, which is the modulus at small strain too."""
        return [material.youngs_modulus]

    def energy(self, stretch: Matrix, coefficients: Matrix) -> Matrix:
        """Energy of a fibre per volume, with μ = E/3, 1×1, J/m³."""
        return coefficients[0] / 6 * _first_invariant(stretch)


@final
@register
class MooneyRivlinLaw(RubberLaw[records.MooneyRivlin]):
    """W = c10 (λ² + 2/λ − 3) + c01 (2 λ + 1/λ² − 3)."""

    record = records.MooneyRivlin

    def coefficients(self, material: records.MooneyRivlin) -> list[Scalar]:
        """Coefficients c10 and c01, and the small-strain modulus 6 (c10 + c01)."""
        return [material.c10, material.c01, 6 * (material.c10 + material.c01)]

    def energy(self, stretch: Matrix, coefficients: Matrix) -> Matrix:
        """Energy of a fibre per volume, a sum over both invariants, 1×1, J/m³."""
        second = 2 * stretch + 1 / stretch**2 - 3
        return coefficients[0] * _first_invariant(stretch) + coefficients[1] * second


@final
@register
class YeohLaw(RubberLaw[records.Yeoh]):
    """W = c1 (I₁ − 3) + c2 (I₁ − 3)² + c3 (I₁ − 3)³."""

    record = records.Yeoh

    def coefficients(self, material: records.Yeoh) -> list[Scalar]:
        """Coefficients c1, c2, c3, and the small-strain modulus 6 c1."""
        return [material.c1, material.c2, material.c3, 6 * material.c1]

    def energy(self, stretch: Matrix, coefficients: Matrix) -> Matrix:
        """Energy of a fibre per volume, a polynomial of the first invariant, 1×1, J/m³."""
        invariant = _first_invariant(stretch)
        return invariant * (coefficients[0] + invariant * (coefficients[1] + invariant * coefficients[2]))


@final
@register
class OgdenLaw(RubberLaw[records.Ogden]):
    """W = Σ μ/α (λ^α + 2 λ^(−α/2) − 3)."""

    record = records.Ogden

    def coefficients(self, material: records.Ogden) -> list[Scalar]:
        """Coefficients μ and α of each pair, and the small-strain modulus 3/2 Σ μ α."""
        pairs = [number for pair in material.ogden for number in pair]
        return [*pairs, 1.5 * sum(modulus * exponent for modulus, exponent in material.ogden)]

    def energy(self, stretch: Matrix, coefficients: Matrix) -> Matrix:
        """Energy of a fibre per volume, a sum over the pairs, 1×1, J/m³."""
        energies = []
        for pair in range((coefficients.shape[0] - 1) // 2):
            modulus = coefficients[2 * pair]
            exponent = coefficients[2 * pair + 1]
            powers = stretch**exponent + 2 * stretch ** (-exponent / 2) - 3
            energies.append(modulus / exponent * powers)
        return _sum(energies)


def _first_invariant(stretch: Matrix) -> Matrix:
    """Invariant I₁ − 3 of a fibre of constant volume."""
    return stretch**2 + 2 / stretch - 3


def _refuse_unless_round(rod: scenes.Rod, key: str) -> str:
    """Return the key of the radius of a round section.

    Raises:
        SceneError: the section is not round.
    """
    section = rod.section
    if section is None or section.radius_key is None:
        problem = f"its bending is the same in every direction, and the section of {rod.name!r} is not round"
        raise SceneError(Problem(f"{rod.name}.material.{key}", problem, "give a curve for bending_x and bending_y"))
    return section.radius_key


def coupled_stiffness(matrix: Sequence[Sequence[Scalar]], of_rod: LawOfRod) -> EnergyBeyondHooke | None:
    """Energy of the entries of a stiffness matrix off its diagonal: its diagonal is the Hooke tensor."""
    pairs = [(i, j) for i in of_rod.admitted for j in of_rod.admitted if i < j]
    coupled = [(i, j) for i, j in pairs if any_symbolic([matrix[i][j]]) or matrix[i][j] != 0.0]
    if not coupled:
        return None

    def density(change: Matrix, data: Matrix) -> Matrix:
        return _sum([data[number] * change[i] * change[j] for number, (i, j) in enumerate(coupled)])

    return EnergyBeyondHooke(density, of_rod.columns([matrix[i][j] for i, j in coupled]))
