"""Colours and markers of figures."""

from __future__ import annotations

AXES = ("#cc3311", "#228833", "#0055bb")
"""Axes x, y, z, and components along them."""

RODS = ("#4477aa", "#ee6677", "#228833", "#ccbb44", "#66ccee", "#aa3377")
ACTUATORS = ("#cc6677", "#117733", "#332288", "#999933")
BODIES = "#777777"
FORCES = "#b2560d"
LINE_FORCES = "#c98b4b"
MOMENTS = "#7a3e9d"
TARGETS = "#aa3377"

PLAIN_TEXT = "0.3"
FAILURE = "#cc3311"
"""Text of a figure whose solve did not end as it should."""

CATEGORIES = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#d55e00", "#56b4e9", "#000000")
"""Colours that stay apart for colour-blind readers.

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


def actuator_colour(index: int) -> str:
    """Colour of the actuator of this index; they come again after the last."""
    return ACTUATORS[index % len(ACTUATORS)]
