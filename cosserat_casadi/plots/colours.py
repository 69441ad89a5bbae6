"""Colours and markers of figures; colours of one set can be told apart by colour-blind readers too."""

from __future__ import annotations

from typing import Any

AXES = ("#cc3311", "#33aa66", "#0044aa")
"""Axes x, y, z, and components along them. The green is lighter than the red, for red–green blind readers."""

RODS = ("#0072b2", "#ee6677", "#ccbb44", "#332288", "#33bbee", "#882255")
ROD_MARKERS = ("", "o", "^", "s", "D", "v")
"""Markers along the rods, one for each cycle of colours."""

ACTUATORS = ("#cc8800", "#884488", "#aa4444", "#aa66ee", "#aaaacc", "#0000ee")
"""Colours of actuators, distinct from those of rods."""

BODIES = "#777777"
DISKS = ("#777777", "#44aa99", "#aa4499", "#bb8844")
"""Colours of rows of disks."""

OBSTACLES = "#a08c5b"
FORCES = "#b2560d"
LINE_FORCES = "#c98b4b"
MOMENTS = "#7a3e9d"
TARGETS = "#aa3377"

PLAIN_TEXT = "0.3"
FAILURE = "#cc3311"
"""Colour of the text about a failed solve."""

CATEGORIES = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#d55e00", "#56b4e9", "#000000")
"""Colours of curves and of outcomes.

M. Okabe, K. Ito, *Color Universal Design* (2008), without its yellow, which a small dot on white does not show.
"""

CATEGORY_MARKERS = ("o", "^", "s", "D", "v", "P")
"""Six markers and seven colours: 6 and 7 are coprime, so the pairs repeat after 42 categories."""


def category_style(index: int) -> dict[str, str]:
    """Colour and marker of a category by its index; neighbours differ in both."""
    colour = CATEGORIES[index % len(CATEGORIES)]
    marker = CATEGORY_MARKERS[index % len(CATEGORY_MARKERS)]
    return {"color": colour, "marker": marker}


def rod_colour(index: int) -> str:
    """Colour of a rod by its index; colours repeat cyclically."""
    return RODS[index % len(RODS)]


def rod_style(index: int) -> dict[str, Any]:
    """Colour of a rod by its index, and markers that tell it from rods of the same colour."""
    marker = ROD_MARKERS[index // len(RODS) % len(ROD_MARKERS)]
    # One marker per tenth of the picture's width, for any number of points.
    return {"color": rod_colour(index), "marker": marker, "markersize": 7, "markevery": 0.1}


def disk_colour(index: int) -> str:
    """Colour of a row of disks by its index; colours repeat cyclically."""
    return DISKS[index % len(DISKS)]


def actuator_colour(index: int) -> str:
    """Colour of an actuator by its index; colours repeat cyclically."""
    return ACTUATORS[index % len(ACTUATORS)]
