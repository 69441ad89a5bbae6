"""Warnings of measurements that look like a wrong unit: told, not refused."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from cosserat_casadi.identification.fit_unknowns import UnknownLayout
from cosserat_casadi.identification.identification_result import Row
from cosserat_casadi.identification.measured_quantities import QUANTITIES
from cosserat_casadi.model.sections import sizes_of
from cosserat_casadi.tubes.tube_functions import AnyModel

FAR = 3.0
"""Lengths of all rods, or tubes, beyond which a measured position, from the base on, is hardly one of the scene."""


def plausibility(model: AnyModel, layout: UnknownLayout, rows: Sequence[Row]) -> list[str]:
    """Sentences on numbers that can hardly be in SI units."""
    return [*_thick_rods(model), *_wide_bounds(model, layout), *_far_positions(model, rows)]


def _thick_rods(model: AnyModel) -> Iterator[str]:
    for rod in model.scene.rods:
        sizes = {} if rod.section is None else sizes_of(rod.section)
        for key, size in sizes.items():
            largest = float(np.max(size))
            if largest >= rod.length:
                yield f"{rod.name}.section.{key} is {largest:g} m in a rod of {rod.length:g} m: is it in metres?"


def _wide_bounds(model: AnyModel, layout: UnknownLayout) -> Iterator[str]:
    """Sizes of a section whose range begins above the length of the rod."""
    rods = {rod.name: rod for rod in model.scene.rods}
    for entry in layout.shared:
        owner, _, key = entry.record.name.partition(".")
        lower = entry.limits()[0]
        rod = rods.get(owner)
        if rod is None or rod.section is None:
            continue
        is_size = any(part in sizes_of(rod.section) for part in key.split("."))
        if is_size and np.any(lower >= rod.length):
            yield f"{entry.record.name} is sought from {lower.max():g} m on in a rod of {rod.length:g} m: metres?"


def _far_positions(model: AnyModel, rows: Sequence[Row]) -> Iterator[str]:
    length = sum(rod.length for rod in model.scene.rods) + sum(tube.length for tube in model.scene.tubes)
    bases = [np.abs(rod.base.position).max() for rod in model.scene.rods]
    reach = FAR * (length + max(bases, default=0.0))
    for number, measurement in enumerate(model.scene.measurements):
        coordinates = QUANTITIES[measurement.quantity].coordinates
        distances = [abs(row.measured) for row in rows if row.measurement == number and row.entry < coordinates]
        if distances and max(distances) > reach:
            farthest = max(distances)
            yield (
                f"{measurement.title}: a position of {farthest:g} m is measured, where rods and tubes together are "
                f"{length:g} m long: are the columns in mm? Then scale = 1e-3."
            )
