"""Colours and markers of figures; colours of one set stay apart for colour-blind readers too."""

from __future__ import annotations

from typing import Any

AXES = ("#cc3311", "#33aa66", "#0044aa")
"""Axes x, y, z, and components along them: the green is lighter than the red, which is all that some readers see."""

RODS = ("#0072b2", "#ee6677", "#ccbb44", "#332288", "#33bbee", "#882255")
ROD_MARKERS = ("", "o", "^", "s", "D", "v")
"""Marks along the rods of each round of colours."""

ACTUATORS = ("#cc8800", "#884488", "#aa4444", "#aa66ee", "#aaaacc", "#0000ee")
"""Colours of actuators, apart from colours of the rods in which they run."""

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
"""Text of a figure whose solve did not end as it should."""

CATEGORIES = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#d55e00", "#56b4e9", "#000000")
"""Colours of curves and of outcomes.

M. Okabe, K. Ito, *Color Universal Design* (2008), without its yellow, which a small dot on white does not show.
"""

CATEGORY_MARKERS = ("o", "^", "s", "D", "v", "P")
"""Six, and seven colours: the two counts have no common factor, so 42 categories differ before a pair comes again."""


def category_style(index: int) -> dict[str, str]:
    """Colour and marker of the category of this index; neighbours differ in both."""
    colour = CATEGORIES[index % len(CATEGORIES)]
    marker = CATEGORY_MARKERS[index % len(CATEGORY_MARKERS)]
    return {"color": colour, "marker": marker}


def rod_colour(index: int) -> str:
    """Colour of the rod of this index; they come again after the last."""
    return RODS[index % len(RODS)]


def rod_style(index: int) -> dict[str, Any]:
    """Colour of the rod of this index, and marks along it that tell it from the rods of the same colour."""
    marker = ROD_MARKERS[index // len(RODS) % len(ROD_MARKERS)]
    # A mark in every tenth of the picture: points along a rod may be many or few.
    return {"color": rod_colour(index), "marker": marker, "markersize": 7, "markevery": 0.1}


def disk_colour(index: int) -> str:
    """Colour of the row of disks of this index; they come again after the last."""
    return DISKS[index % len(DISKS)]


def actuator_colour(index: int) -> str:
    """Colour of the actuator of this index; they come again after the last."""
    return ACTUATORS[index % len(ACTUATORS)]
