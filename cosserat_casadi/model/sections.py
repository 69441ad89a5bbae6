"""Shapes of cross-sections: areas and second moments of a section from the sizes that its record gives.

A member is one class: it gives :meth:`CrossSection.shape`. Stiffness, mass and inertia of a rod follow from it.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Generic, TypeVar, final

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.maths.grid import gauss_legendre
from cosserat_casadi.maths.numbers import Numbers, Scalar, is_symbolic, known, repeated
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.rod import section
from cosserat_casadi.rod.properties import Field
from cosserat_casadi.rod.section import SectionShape
from cosserat_casadi.scene.families import Kind, Kinds, register
from cosserat_casadi.scene.rod_records import SECTIONS, SectionRecord

RecordType = TypeVar("RecordType", bound=SectionRecord)

Sizes = Mapping[str, Numbers]
"""Sizes of k sections by the keys of their record, shape (k,) each, m; expressions if parameters set them."""


Fibre = tuple[Matrix, Matrix, Matrix]
"""Position x, y of a fibre in the section, m, and its area, m²."""


class CrossSection(Kind, ABC, Generic[RecordType]):
    """One shape of cross-sections, about its centroid, whose axes x and y are principal ones."""

    record: ClassVar[type[SectionRecord]]
    family = SECTIONS
    kinds = Kinds(SECTIONS)

    @abstractmethod
    def shape(self, sizes: Sizes) -> SectionShape:
        """Area, second moments and torsion constant of sections of these sizes."""

    def fibres(self, sizes: Mapping[str, Matrix], count: int) -> list[Fibre] | None:
        """Points of a quadrature over the section, x, y and area of each, m and m², symmetric about both axes.

        None for a shape that only linear materials may have.

        Args:
            sizes: sizes of the section by their keys, m.
            count: points across half of the section: exact for products of powers of x and y below 4 ``count``.
        """
        return None

    def half_widths(self, sizes: Sizes) -> tuple[Numbers, Numbers] | None:
        """Half of the widths along x and y for drawings, m; for a round section its radius, twice.

        None for a shape that is drawn by its centre line alone.
        """
        key = self.record.radius_key
        return None if key is None else (sizes[key], sizes[key])


SHAPES = CrossSection.kinds
"""Shapes of cross-sections by the words of the scene format."""


def sizes_of(record: SectionRecord) -> dict[str, Any]:
    """The sizes of a section by their keys, each constant or a pair for base and tip."""
    return {key: getattr(record, key) for key in type(record).model_fields if key not in ("shape", "shear_correction")}


def linear(value: Scalar | Sequence[Scalar]) -> Field:
    """A size along the rod: constant, or linear from base to tip."""
    if isinstance(value, int | float):
        return lambda X: np.full(X.shape[0], float(value))
    if is_symbolic(value):
        # One row stands for all abscissae.
        expression: Numbers = value
        return lambda X: expression
    assert isinstance(value, tuple)
    base, tip = value
    return lambda X: base + (tip - base) * X


def sizes_along(record: scenes.Section, X: Numbers) -> dict[str, Numbers]:
    """Sizes of a section at abscissae, shape (k,) each, m, by their keys."""
    return {key: along(linear(size), X) for key, size in sizes_of(record).items()}


def half_widths_along(record: scenes.Section | None, X: FloatArray) -> tuple[FloatArray, FloatArray] | None:
    """Half of the widths along x and y at abscissae, shape (k,) each, m; of a round section its radius.

    None without a section, or for a section that is drawn by its centre line alone.
    """
    if record is None:
        return None
    widths = SHAPES[record.shape].half_widths(sizes_along(record, X))
    if widths is None:
        return None
    x, y = widths
    return known(x), known(y)


def along(field: Field, X: Numbers) -> Numbers:
    """Values of a field at every abscissa."""
    return repeated(field(X), X.shape[0])


@final
@register
class CircleSection(CrossSection[scenes.Circle]):
    """A solid circle."""

    record = scenes.Circle

    def shape(self, sizes: Sizes) -> SectionShape:
        """The shape of a circle of this radius."""
        return section.circle(sizes["radius"])

    def fibres(self, sizes: Mapping[str, Matrix], count: int) -> list[Fibre]:
        """Quadrature points over the circle, as over a tube without bore."""
        return _round_fibres(sizes["radius"], 0.0 * sizes["radius"], count)


@final
@register
class AnnulusSection(CrossSection[scenes.Annulus]):
    """A circular tube."""

    record = scenes.Annulus

    def shape(self, sizes: Sizes) -> SectionShape:
        """The shape of an annulus of these radii."""
        return section.annulus(sizes["outer_radius"], sizes["inner_radius"])

    def fibres(self, sizes: Mapping[str, Matrix], count: int) -> list[Fibre]:
        """Quadrature points between the two radii."""
        return _round_fibres(sizes["outer_radius"], sizes["inner_radius"], count)


@final
@register
class RectangleSection(CrossSection[scenes.Rectangle]):
    """A solid rectangle."""

    record = scenes.Rectangle

    def shape(self, sizes: Sizes) -> SectionShape:
        """The shape of a rectangle of this width along x and this height along y."""
        return section.rectangle(sizes["width"], sizes["height"])

    def fibres(self, sizes: Mapping[str, Matrix], count: int) -> list[Fibre]:
        """Product of Gauss points across the width and across the height."""
        points, weights = gauss_legendre(2 * count)
        width, height = sizes["width"], sizes["height"]
        return [
            (x / 2 * width, y / 2 * height, along_x * along_y / 4 * width * height)
            for x, along_x in zip(points.tolist(), weights.tolist(), strict=True)
            for y, along_y in zip(points.tolist(), weights.tolist(), strict=True)
        ]

    def half_widths(self, sizes: Sizes) -> tuple[Numbers, Numbers]:
        """Half of its width and height."""
        return sizes["width"] / 2, sizes["height"] / 2


def _round_fibres(outer: Matrix, inner: Matrix, rings: int) -> list[Fibre]:
    """Points on rings between two radii, m: Gauss points in the square of the radius, equal areas in one ring."""
    points, weights = gauss_legendre(rings)
    directions = 4 * rings
    squares = outer**2 - inner**2
    fibres = []
    for point, weight in zip((points + 1) / 2, weights / 2, strict=True):
        radius = (inner**2 + float(point) * squares) ** 0.5
        area = np.pi * float(weight) / directions * squares
        for direction in range(directions):
            # Half a step off the axes, so that the points of the four quadrants are mirror images.
            angle = 2 * np.pi * (direction + 0.5) / directions
            fibres.append((float(np.cos(angle)) * radius, float(np.sin(angle)) * radius, area))
    return fibres
