"""Numbers that look as if they were in another unit than the format's: they are taken as they are, with a note."""

from __future__ import annotations

import logging
import math
from collections.abc import Collection, Iterator

from cosserat_casadi.scene.faults import SIZES
from cosserat_casadi.scene.records import Record
from cosserat_casadi.scene.scene import Scene

LOG = logging.getLogger(__name__)

SOFTEST = 1e3
"""Young's modulus, Pa, below that of any rod: soft gels have some thousands, 60 GPa written as 60 has less."""

LIGHTEST = 10.0
"""Density, kg/m³, below that of foams: 6450 kg/m³ written as 6.45 g/cm³ is lighter."""

NEAR_ONE = 100.0
"""Largest number, and inverse of the smallest one, of a rod that is computed without units."""


def note_unlikely_units(scene: Scene) -> None:
    """Warn of every number that is likely in another unit; of none of a rod whose numbers are all near one."""
    for note in _notes(scene):
        LOG.warning("%s", note)


def _notes(scene: Scene) -> Iterator[str]:
    for index, rod in enumerate(scene.rods):
        where = f"rods[{index}]"
        length = _numbers(rod, {"length"})
        sizes = _numbers(rod.section, SIZES)
        material = _numbers(rod.material, {"youngs_modulus", "density"})
        numbers = (length | sizes | material).values()
        if all(1 / NEAR_ONE <= number <= NEAR_ONE for number in numbers):
            continue
        modulus = material.get("youngs_modulus", math.inf)
        if modulus < SOFTEST:
            yield f"{where}.material.youngs_modulus: {modulus:g} Pa is softer than any rod (60 GPa are 60e9)"
        density = material.get("density", math.inf)
        if density < LIGHTEST:
            yield f"{where}.material.density: {density:g} kg/m³ is lighter than foam (is it in kg/m³?)"
        longest = length.get("length", math.inf)
        for key, size in sizes.items():
            if size > longest:
                yield f"{where}.section.{key}: {size:g} m is more than the length of {longest:g} m (are both in m?)"


def _numbers(record: Record | None, keys: Collection[str]) -> dict[str, float]:
    """Values of some keys of a record that are one number each: no lists, and no expressions of parameters."""
    return {key: value for key, value in record or () if key in keys and isinstance(value, float | int)}
