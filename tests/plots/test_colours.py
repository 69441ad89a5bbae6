"""Colours of one set stay apart, for readers of every kind of colour vision."""

from __future__ import annotations

from itertools import combinations, product

import numpy as np
import pytest

from cosserat_casadi.plots.colours import (
    ACTUATORS,
    AXES,
    CATEGORIES,
    FORCES,
    MOMENTS,
    ROD_MARKERS,
    RODS,
    rod_style,
)

READERS = {
    "all cones": np.eye(3),
    "no red cones": np.array(
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]]
    ),
    "no green cones": np.array(
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]]
    ),
    "no blue cones": np.array(
        [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]]
    ),
}
"""Linear RGB as they see it: G. M. Machado, M. M. Oliveira, L. A. F. Fernandes, *A physiologically-based model for
simulation of color vision deficiency*, IEEE TVCG 15 (2009), table of severity 1."""

XYZ_OF_RGB = np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
)
"""sRGB, IEC 61966-2-1."""

WHITE = XYZ_OF_RGB.sum(axis=1)


def linear_rgb(colour: str) -> np.ndarray:
    values = np.array([int(colour[start : start + 2], 16) for start in (1, 3, 5)]) / 255
    return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)


def lab(rgb: np.ndarray) -> np.ndarray:
    """CIELAB 1976."""
    relative = XYZ_OF_RGB @ np.clip(rgb, 0, 1) / WHITE
    x, y, z = np.where(relative > (6 / 29) ** 3, np.cbrt(relative), relative * (29 / 6) ** 2 / 3 + 4 / 29)
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


def distance(one: str, other: str, reader: str) -> float:
    seen = [lab(READERS[reader] @ linear_rgb(colour)) for colour in (one, other)]
    return float(np.linalg.norm(seen[0] - seen[1]))


def test_distances_are_those_of_cielab() -> None:
    # White on black is 100 for everybody; pure red and pure green are the pair that readers without red cones confuse.
    for reader in READERS:
        assert distance("#ffffff", "#000000", reader) == pytest.approx(100.0, abs=0.1)
    assert distance("#cc3311", "#228833", "all cones") > 100.0
    assert distance("#cc3311", "#228833", "no red cones") < 15.0


@pytest.mark.parametrize("reader", READERS)
@pytest.mark.parametrize(
    ("colours", "least"), [(AXES, 25.0), (RODS, 20.0), (ACTUATORS, 20.0), (CATEGORIES, 15.0), ((FORCES, MOMENTS), 25.0)]
)
def test_colours_stay_apart(colours: tuple[str, ...], least: float, reader: str) -> None:
    for one, other in combinations(colours, 2):
        assert distance(one, other, reader) > least, (one, other)


@pytest.mark.parametrize("reader", READERS)
def test_no_actuator_has_the_colour_of_a_rod(reader: str) -> None:
    for one, other in product(RODS, ACTUATORS):
        assert distance(one, other, reader) > 13.0, (one, other)


def test_many_rods_are_told_apart() -> None:
    count = len(RODS) * len(ROD_MARKERS)
    styles = {(style["color"], style["marker"]) for style in map(rod_style, range(count))}
    assert len(styles) == count
    assert rod_style(0)["marker"] == ""
