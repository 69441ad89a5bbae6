"""Areas and second moments of cross-sections, and their Hooke tensor: report (1.20), (1.21).

The section lies in the local x–y plane; z is the tangent. Every argument may be an array over abscissae, or an
expression of parameters.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from cosserat_casadi.maths.numbers import Numbers, Scalar, any_symbolic, as_matrix, is_symbolic, known, side_by_side
from cosserat_casadi.maths.typing import Matrix


@dataclass(frozen=True)
class SectionShape:
    """Geometry of a section.

    Attributes:
        area: A, m².
        second_moment_x: I_xx = ∫ y² dA, m⁴: resists bending about local x.
        second_moment_y: I_yy = ∫ x² dA, m⁴: resists bending about local y.
        torsion_constant: J, m⁴, of Saint-Venant's problem; I_xx + I_yy only for circles and annuli.
    """

    area: Numbers
    second_moment_x: Numbers
    second_moment_y: Numbers
    torsion_constant: Numbers

    @property
    def second_moments(self) -> Numbers:
        """I_xx, I_yy and the polar moment I_xx + I_yy, shape (len, 3), m⁴: times the density they are rotary inertia.

        The polar moment is not the torsion constant J, which warping makes smaller.
        """
        polar = self.second_moment_x + self.second_moment_y
        return side_by_side([self.second_moment_x, self.second_moment_y, polar])


def circle(radius: Numbers) -> SectionShape:
    """Solid circle of the given radius (m)."""
    return annulus(radius, 0.0 * radius)


def annulus(outer_radius: Numbers, inner_radius: Numbers) -> SectionShape:
    """Circular tube between two radii (m)."""
    second_moment = np.pi / 4 * (outer_radius**4 - inner_radius**4)
    return SectionShape(
        area=np.pi * (outer_radius**2 - inner_radius**2),
        second_moment_x=second_moment,
        second_moment_y=second_moment,
        torsion_constant=2 * second_moment,
    )


def rectangle(width: Numbers, height: Numbers) -> SectionShape:
    """Solid rectangle, ``width`` along local x and ``height`` along local y (m)."""
    return SectionShape(
        area=width * height,
        second_moment_x=width * height**3 / 12,
        second_moment_y=height * width**3 / 12,
        torsion_constant=_rectangle_torsion_constant(width, height),
    )


def _rectangle_torsion_constant(width: Numbers, height: Numbers) -> Numbers:
    """Saint-Venant's series J = a b³ [1/3 − (64/π⁵)(b/a) Σ tanh(nπa/2b)/n⁵] over odd n, with a ≥ b.

    tanh is 1 to rounding from n = 13 on for every a ≥ b, so the rest of the series is a constant: 31 ζ(5)/32 is
    the sum of 1/n⁵, and only the deficits 1 − tanh are summed.
    """
    a: Numbers
    b: Numbers
    if any_symbolic([width, height]):
        a = ca.fmax(as_matrix(width), as_matrix(height))
        b = ca.fmin(as_matrix(width), as_matrix(height))
    else:
        a = np.maximum(known(width), known(height))
        b = np.minimum(known(width), known(height))
    # Σ 1/n⁵ over all odd n, 31/32 of ζ(5).
    all_odd = 31 / 32 * 1.0369277551433699
    series = 64 / np.pi**5 * (b / a) * (all_odd - _tanh_deficit(a / b))
    return a * b**3 * (1 / 3 - series)


def _tanh_deficit(slenderness: Numbers) -> Numbers:
    """Σ (1 − tanh(nπ/2 a/b))/n⁵ over odd n below 27, for every a/b."""
    n = np.arange(1, 27, 2)
    if is_symbolic(slenderness):
        # One row for each section, one column for each term.
        deficits = 1 - ca.tanh(slenderness @ ca.DM(n * np.pi / 2).T)
        total: Matrix = deficits @ ca.DM(1 / n**5)
        return total
    terms = (1 - np.tanh(n * np.pi / 2 * known(slenderness)[..., None])) / n**5
    return np.asarray(terms.sum(axis=-1))


def hooke(shape: SectionShape, youngs_modulus: Scalar, shear_modulus: Scalar, shear_correction: Scalar) -> Numbers:
    """Diagonal of the Hooke tensor (EI_xx, EI_yy, GJ, kGA, kGA, EA), report (1.21).

    Args:
        shape: the sections.
        youngs_modulus: E, Pa.
        shear_modulus: G, Pa.
        shear_correction: k, factor on the shear stiffnesses.

    Returns:
        shape (len, 6): N m² for the first three columns, N for the last three.
    """
    bending_x = youngs_modulus * shape.second_moment_x
    bending_y = youngs_modulus * shape.second_moment_y
    torsion = shear_modulus * shape.torsion_constant
    shear = shear_correction * shear_modulus * shape.area
    extension = youngs_modulus * shape.area
    diagonal = [bending_x, bending_y, torsion, shear, shear, extension]
    return side_by_side(diagonal)
