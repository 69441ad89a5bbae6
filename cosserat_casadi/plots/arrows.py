"""Arrows of loads on the picture of a scene."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cosserat_casadi.loads.load import Arrow
from cosserat_casadi.plots.canvas import FLAT, Canvas
from cosserat_casadi.plots.colours import FORCES, LINE_FORCES, MOMENTS


@dataclass(frozen=True)
class ArrowStyle:
    """Style of the arrows of one sort.

    Attributes:
        share: length of the largest arrow over the size of the scene.
        colour: colour of all arrows.
        width: width of the shaft, points.
    """

    share: float
    colour: str
    width: float


STYLES = {
    "point": ArrowStyle(0.22, FORCES, 2.2),
    "moment": ArrowStyle(0.18, MOMENTS, 2.2),
    "line": ArrowStyle(0.09, LINE_FORCES, 1.0),
}
"""Forces at a point, moments, forces per length. Arrows are scaled within their own sort."""

MOST_LINE_ARROWS = 24
"""Largest number of arrows of forces per length; beyond it arrows are thinned evenly."""


def lies_in_plane(arrow: Arrow, normal: int) -> bool:
    """Whether an arrow shows in the plane normal to a world axis: a force in the plane, a moment normal to it."""
    outside = np.delete(arrow.vector, normal) if arrow.sort == "moment" else arrow.vector[[normal]]
    largest_outside = np.abs(outside).max()
    largest = np.abs(arrow.vector).max()
    return bool(largest_outside <= FLAT * largest)


def draw_arrows(canvas: Canvas, arrows: Sequence[Arrow]) -> None:
    """Draw the arrows of all loads; a moment normal to the plane is drawn as a rotation sign."""
    for sort, style in STYLES.items():
        of_sort = [arrow for arrow in arrows if arrow.sort == sort]
        every = -(-len(of_sort) // MOST_LINE_ARROWS) if sort == "line" else 1
        # The length of the largest arrow of a sort is set by its style, whatever its unit.
        largest = max((float(np.linalg.norm(arrow.vector)) for arrow in of_sort), default=0.0)
        for index, arrow in enumerate(of_sort):
            # Every k-th arrow is drawn, and each arrow with a legend entry.
            if index % every and not arrow.label:
                continue
            if sort == "moment" and canvas.plane is not None:
                # Drawn as a turning sign; the legend still gives its value.
                canvas.legend_entry(arrow.label or None, color=style.colour, linewidth=style.width)
                continue
            scaled = arrow.vector * style.share * canvas.size / largest
            canvas.arrow(arrow.start, scaled, colour=style.colour, width=style.width, label=arrow.label or None)
    if canvas.plane is None:
        return
    for arrow in arrows:
        if arrow.sort == "moment":
            canvas.turning_sign(arrow.start, arrow.vector, MOMENTS)
