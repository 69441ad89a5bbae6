"""Numbers that look as if they were in another unit than the format's: they are taken as they are, with a note."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from typing import Any, TypeGuard

from cosserat_casadi.scene.scene import Scene

LOG = logging.getLogger(__name__)

SOFTEST = 1e3
"""Young's modulus, Pa, below that of any rod: soft gels have some thousands, 60 GPa written as 60 has less."""

LIGHTEST = 10.0
"""Density, kg/m³, below that of foams: 6450 kg/m³ written as 6.45 g/cm³ is lighter."""


def note_unlikely_units(scene: Scene) -> None:
    """Warn of every number that is likely in another unit."""
    for note in _notes(scene):
        LOG.warning("%s", note)


def _notes(scene: Scene) -> Iterator[str]:
    for index, rod in enumerate(scene.rods):
        where = f"rods[{index}]"
        modulus = getattr(rod.material, "youngs_modulus", None)
        if _is_number(modulus) and modulus < SOFTEST:
            yield f"{where}.material.youngs_modulus: {modulus:g} Pa is softer than any rod (60 GPa are 60e9)"
        density = getattr(rod.material, "density", None)
        if _is_number(density) and 0.0 < density < LIGHTEST:
            yield f"{where}.material.density: {density:g} kg/m³ is lighter than foam (is it in kg/m³?)"
        for key in ("radius", "outer_radius", "width", "height"):
            size = getattr(rod.section, key, None)
            if _is_number(size) and _is_number(rod.length) and size > rod.length:
                yield f"{where}.section.{key}: {size:g} m is more than the length of {rod.length:g} m (are both in m?)"


def _is_number(value: Any) -> TypeGuard[float]:
    """Whether a value is one number: no list, expression or nothing."""
    return isinstance(value, float | int)
