"""Shapes of cross-sections: areas and second moments of a section from the sizes that its record gives.

A member is one class: it gives :meth:`CrossSection.shape`. Stiffness, mass and inertia of a rod follow from it.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar, Generic, TypeVar, final

from cosserat_casadi import scene as scenes
from cosserat_casadi.maths.numbers import Numbers
from cosserat_casadi.rod import section
from cosserat_casadi.rod.section import SectionShape
from cosserat_casadi.scene.families import Kind, Kinds, register
from cosserat_casadi.scene.rod_records import SECTIONS, SectionRecord

RecordType = TypeVar("RecordType", bound=SectionRecord)

Sizes = Mapping[str, Numbers]
"""Sizes of k sections by the keys of their record, shape (k,) each, m; expressions where parameters set them."""


class CrossSection(Kind, ABC, Generic[RecordType]):
    """One shape of cross-sections, about its centroid, whose axes x and y are principal ones."""

    record: ClassVar[type[SectionRecord]]
    family = SECTIONS
    kinds = Kinds(SECTIONS)

    @abstractmethod
    def shape(self, sizes: Sizes) -> SectionShape:
        """Area, second moments and torsion constant of sections of these sizes."""

    def half_widths(self, sizes: Sizes) -> tuple[Numbers, Numbers] | None:
        """Half of the widths along x and y as a page draws them, m; of a round section its radius.

        None for a section that is drawn by its centre line alone.
        """
        key = self.record.radius_key
        return None if key is None else (sizes[key], sizes[key])


SHAPES = CrossSection.kinds
"""Shapes of cross-sections by the words of the scene format."""


def sizes_of(record: SectionRecord) -> dict[str, Any]:
    """The sizes of a section, each constant or of base and tip, by their keys."""
    return {key: getattr(record, key) for key in type(record).model_fields if key not in ("shape", "shear_correction")}


@final
@register
class CircleSection(CrossSection[scenes.Circle]):
    """A solid circle."""

    record = scenes.Circle

    def shape(self, sizes: Sizes) -> SectionShape:
        """From its radius."""
        return section.circle(sizes["radius"])


@final
@register
class AnnulusSection(CrossSection[scenes.Annulus]):
    """A circular tube."""

    record = scenes.Annulus

    def shape(self, sizes: Sizes) -> SectionShape:
        """From its radii."""
        return section.annulus(sizes["outer_radius"], sizes["inner_radius"])


@final
@register
class RectangleSection(CrossSection[scenes.Rectangle]):
    """A solid rectangle."""

    record = scenes.Rectangle

    def shape(self, sizes: Sizes) -> SectionShape:
        """From its width along x and its height along y."""
        return section.rectangle(sizes["width"], sizes["height"])

    def half_widths(self, sizes: Sizes) -> tuple[Numbers, Numbers]:
        """Half of its width and height."""
        return sizes["width"] / 2, sizes["height"] / 2
