"""Numbers that look as if they were in another unit than the format's: they are taken as they are, with a note."""

from __future__ import annotations

import logging
import math
from collections.abc import Collection, Iterator

from cosserat_casadi.scene.faults import SIZES
from cosserat_casadi.scene.records import Record
from cosserat_casadi.scene.rod_records import Rod
from cosserat_casadi.scene.scene import Scene
from cosserat_casadi.scene.tube_records import Tube

LOG = logging.getLogger(__name__)

SOFTEST = 1e3
"""Young's modulus, Pa, below the modulus of any rod: soft gels have some thousands, 60 GPa written as 60 has less."""

LIGHTEST = 10.0
"""Density, kg/m³, below the density of foams: 6450 kg/m³ written as 6.45 g/cm³ is lighter."""

ANGLES = frozenset({"angle", "rest", "lower_stop", "upper_stop", "rotation"})
"""Keys of angles of hinges and of drives of tubes."""

FURTHEST = 4 * math.pi
"""Angle, rad, beyond the angle of most hinges and drives: 15° written as 15 is more."""

NEAR_ONE = 100.0
"""Largest number, and inverse of the smallest one, of a rod or tube that is computed without units."""


def note_unlikely_units(scene: Scene) -> None:
    """Warn of every number that is likely in another unit; of no size of a rod whose numbers are all near one."""
    for note in _notes(scene):
        LOG.warning("%s", note)


def _notes(scene: Scene) -> Iterator[str]:
    tubes = [(f"tubes[{i}]", tube) for i, tube in enumerate(scene.tubes)]
    elastic: list[tuple[str, Rod | Tube]] = [(f"rods[{i}]", rod) for i, rod in enumerate(scene.rods)]
    for where, record in [*elastic, *tubes]:
        lengths = _numbers(record, {"length", "straight", "curved"})
        sizes = _sizes(record.section)
        material = _numbers(record.material, {"youngs_modulus", "density"})
        numbers = (lengths | sizes | material).values()
        if all(1 / NEAR_ONE <= number <= NEAR_ONE for number in numbers):
            continue
        modulus = material.get("youngs_modulus", math.inf)
        if modulus < SOFTEST:
            yield f"{where}.material.youngs_modulus: {modulus:g} Pa is softer than any rod (60 GPa are 60e9)"
        density = material.get("density", math.inf)
        if density < LIGHTEST:
            yield f"{where}.material.density: {density:g} kg/m³ is lighter than foam (is it in kg/m³?)"
        # A length that is a parameter is not known.
        longest = sum(lengths.values()) or math.inf
        for key, size in sizes.items():
            if size > longest:
                yield f"{where}.section.{key}: {size:g} m is more than the length of {longest:g} m (are both in m?)"
    hinges = [(f"joints[{i}]", joint) for i, joint in enumerate(scene.joints) if joint.kind == "revolute"]
    for where, turned in (*hinges, *tubes):
        for key, angle in _numbers(turned, ANGLES).items():
            if abs(angle) > FURTHEST:
                yield f"{where}.{key}: {angle:g} rad is more than two turns (is it in rad?)"


def _numbers(record: Record | None, keys: Collection[str]) -> dict[str, float]:
    """Values of some keys of a record that are one number each: no lists, and no expressions of parameters."""
    return {key: value for key, value in record or () if key in keys and isinstance(value, float | int)}


def _sizes(section: Record | None) -> dict[str, float]:
    """Sizes of a section by key; of one from base to tip the larger."""
    tapered = {key: value for key, value in section or () if key in SIZES and isinstance(value, tuple)}
    ends = {key: max(value) for key, value in tapered.items() if all(isinstance(end, float | int) for end in value)}
    return _numbers(section, SIZES) | ends
