"""Axes of a scene in space, or in the coordinate plane of a planar scene."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from cosserat_casadi.maths.typing import FloatArray

Plane = tuple[int, int]
"""World axes to the right and upwards."""

SPACE = (0, 1, 2)
WORLD: FloatArray = np.eye(3)
"""World axes, one per row, shape (3, 3)."""

AXIS_NAMES = "xyz"

TICKS = 5
"""Most intervals between the ticks of the longest axis in space; shorter axes have fewer."""

LABEL_HEIGHT = 0.05
"""Height of the label of the vertical axis above its end, over the longest side."""

LABEL_DISTANCE = 9.0
"""Distance between tick labels and axis label in space, points; with less they overlap."""

SMALL = 8
"""Size of letters in a small panel, points."""

FEW_TICKS = 3
"""Most intervals between the ticks of a small panel."""

THINNEST_BOX = 0.4
"""Least side of the box of a scene in space, relative to the longest."""

ELEVATION, AZIMUTH = np.radians(22.0), np.radians(-58.0)
"""View direction of plots in space."""

BOX = 1.906
"""Diagonal of a box of zoom 1, in the units in which matplotlib's panel is PANEL high."""

PANEL = 1.86

MARGIN, SMALL_MARGIN = 0.25, 0.2
"""Room for labels on each side of a panel in space, and of a small one, inches."""

FLAT = 1e-9
"""Threshold of zero extent, relative to the largest extent."""

NUMBER_DISTANCE, SMALL_NUMBER_DISTANCE = 12.0, 8.0
"""Distance of the vertical axis from its numbers, points, and in a small panel; matplotlib adds 8 points to its pad."""

CORNER = 0.12
"""Distance from the front corner of the box, over its longest side, within which only one axis has tick labels."""


@dataclass(frozen=True)
class Canvas:
    """Matplotlib axes for drawing in world coordinates.

    Attributes:
        axes: matplotlib axes, 3D if the plane is None.
        plane: the coordinate plane of the picture; None for space.
        size: largest extent of the scene, m, the scale of arrows and section axes.
        view_axes: the axes of the plane's coordinates, one per row, shape (3, 3).
        small: whether it is a small panel, with small letters and few ticks.
        named: labels in the legend.
    """

    axes: Any
    plane: Plane | None
    size: float
    view_axes: FloatArray = field(default_factory=lambda: WORLD)
    small: bool = False
    named: set[str | None] = field(default_factory=set)

    @property
    def columns(self) -> tuple[int, ...]:
        """Indices of the displayed axes."""
        return self.plane or SPACE

    def line(self, points: FloatArray, **style: Any) -> Any:
        """Draw a line through points, shape (k, 3), m, and return it, for :meth:`move`.

        The legend shows each ``label`` once.
        """
        label = style.pop("label", None)
        coordinates = self.projected(points)
        (drawn,) = self.axes.plot(*coordinates.T, label=None if label in self.named else label, **style)
        self.named.add(label)
        return drawn

    def move(self, line: Any, points: FloatArray) -> None:
        """Move an existing line to new points, shape (k, 3), m."""
        coordinates = self.projected(points).T
        if self.plane is None:
            line.set_data_3d(*coordinates)
        else:
            line.set_data(*coordinates)

    def shaded_line(self, points: FloatArray, values: FloatArray, **style: Any) -> Any:
        """Draw a line coloured by values, and return it, for a colour bar.

        Args:
            points: points of the line, shape (k, 3), m.
            values: values at the points, shape (k,).
            style: arguments of the line collection, such as colour map and limits.
        """
        coordinates = self.projected(points)
        pieces = np.stack([coordinates[:-1], coordinates[1:]], axis=1)
        middles = (values[:-1] + values[1:]) / 2
        if self.plane is None:
            from mpl_toolkits.mplot3d.art3d import Line3DCollection

            return self.axes.add_collection3d(Line3DCollection(pieces, array=middles, **style))
        from matplotlib.collections import LineCollection

        return self.axes.add_collection(LineCollection(pieces, array=middles, **style))

    def markers(self, points: FloatArray, **style: Any) -> Any:
        """Draw markers at points, shape (k, 3), m, and return them as one line."""
        return self.line(points, linestyle="none", **style)

    def legend_entry(self, label: str | None, **style: Any) -> None:
        """Add a legend entry for an object drawn without a line."""
        no_points = np.zeros((0, 3))
        self.line(no_points, label=label, **style)

    def polygon(self, corners: FloatArray, colour: str) -> None:
        """Draw a filled polygon, corners (k, 3), m."""
        if self.plane is not None:
            self.axes.fill(*self.projected(corners).T, color=colour, alpha=0.25)
            return
        from mpl_toolkits.mplot3d.art3d import Poly3DCollection

        self.axes.add_collection3d(Poly3DCollection([corners], facecolors=colour, alpha=0.25))

    def arrow(self, start: FloatArray, vector: FloatArray, *, colour: str, width: float, label: str | None) -> None:
        """Draw an arrow from a point, shapes (3,), m."""
        if self.plane is None:
            # The box holds the rods: the head of an arrow may lie outside.
            style = {"color": colour, "linewidth": width, "label": label, "clip_on": False}
            self.axes.quiver(*start, *vector, arrow_length_ratio=0.25, **style)
            return
        tail = self.projected(start)
        head = self.projected(start + vector)
        shape = {"arrowstyle": "-|>", "color": colour, "linewidth": width, "mutation_scale": 14}
        self.axes.annotate("", xy=head, xytext=tail, arrowprops=shape)
        # Matplotlib neither adds annotations to the legend nor widens the axes for them.
        self.legend_entry(label, color=colour, linewidth=width)
        self.axes.update_datalim([tail, head])
        self.axes.autoscale_view()

    def turning_sign(self, point: FloatArray, moment: FloatArray, colour: str) -> None:
        """Draw the rotation sign of a moment normal to the plane at its section; in space draw nothing.

        Args:
            point: position of the section, shape (3,), m.
            moment: moment, shape (3,); its component along the normal gives the sense.
            colour: colour of the sign.
        """
        if self.plane is None:
            return
        (across,) = set(SPACE) - set(self.plane)
        counter_clockwise = bool(self.view_axes[across] @ moment > 0)
        if self.plane == (0, 2):
            # The second axis points away from the reader of such a plane, so the turn is seen reversed.
            counter_clockwise = not counter_clockwise
        sign = {True: "↺", False: "↻"}[counter_clockwise]
        # Text of a fixed size: a moment has no length that the scale of the axes could give it.
        style = {"fontsize": 20, "color": colour, "ha": "center", "va": "center"}
        self.axes.annotate(sign, self.projected(point), **style)

    def projected(self, points: FloatArray) -> FloatArray:
        """Coordinates of points, shape (…, 3), in the displayed axes, shape (…, 2) or (…, 3)."""
        return np.asarray(points @ self.view_axes[list(self.columns)].T)

    def label_axes(self) -> None:
        """Label the displayed axes, with unit; the vertical axis in space only if its end is known."""
        right, up = self.columns[:2]
        style: dict[str, Any] = {}
        if self.plane is None:
            style["labelpad"] = LABEL_DISTANCE
        if self.small:
            style = {"labelpad": 0.0, "fontsize": SMALL}
            self.axes.tick_params(labelsize=SMALL, pad=0.0)
        self.axes.set_xlabel(f"{self._axis_name(right)}, m", **style)
        self.axes.set_ylabel(f"{self._axis_name(up)}, m", **style)

    def _axis_name(self, index: int) -> str:
        """Label of a displayed axis: the name of a world axis, or its direction in the world."""
        direction = self.view_axes[index]
        if np.allclose(direction, WORLD[index], rtol=0, atol=1e-9):
            return AXIS_NAMES[index]
        # Adding zero turns −0 into 0.
        components = ", ".join(f"{component:.3g}" for component in np.round(direction, 6) + 0.0)
        return f"along ({components})"

    def equalise(self, points: FloatArray) -> None:
        """Give all axes equal scales, with limits around the points, shape (k, 3), m."""
        if self.plane is not None:
            self.axes.set_aspect("equal", adjustable="datalim")
            self.axes.grid(alpha=0.3)
            return
        # Instead of an equal aspect in space, the sides of the box are proportional to the ranges of the points.
        highest = points.max(axis=0)
        lowest = points.min(axis=0)
        centre = (highest + lowest) / 2
        extents = highest - lowest
        widths = 1.1 * np.maximum(extents, THINNEST_BOX * max(extents.max(), 0.2 * self.size))
        limits = np.stack([centre - widths / 2, centre + widths / 2], axis=1)
        self.axes.set(xlim=limits[0], ylim=limits[1], zlim=limits[2])
        # As a tuple: matplotlib would scale the array itself.
        self.axes.set_box_aspect(tuple(widths), zoom=self._zoom(widths))
        for name, width in zip(AXIS_NAMES, widths, strict=True):
            # Short axes get few ticks.
            most = FEW_TICKS if self.small else TICKS
            self.axes.locator_params(axis=name, nbins=max(1 if self.small else 2, round(most * width / widths.max())))
        self._clear_corner(limits, CORNER * widths.max())
        # Matplotlib scales this distance with the horizontal sides: beside a tall box tick labels would touch its edge.
        distance = SMALL_NUMBER_DISTANCE if self.small else NUMBER_DISTANCE
        self.axes.tick_params(axis="z", pad=distance * widths.max() / widths[:2].mean() - 8.0)
        self.axes.view_init(elev=np.degrees(ELEVATION), azim=np.degrees(AZIMUTH))
        # A label beside the axis would overlap the ticks of a tall box, or lie outside a small panel.
        right, back, top = limits[:, 1]
        self.axes.text(
            right, back, top + LABEL_HEIGHT * widths.max(), "z, m", ha="center", fontsize=SMALL if self.small else None
        )

    def _clear_corner(self, limits: FloatArray, room: float) -> None:
        """Remove the first ticks of y that would overlap the last ticks of x at the front corner of the box.

        Args:
            limits: limits of the axes, one axis per row, shape (3, 2), m.
            room: distance from the corner within which tick labels of both axes overlap, m.
        """
        ticks = [axis.get_majorticklocs() for axis in (self.axes.xaxis, self.axes.yaxis)]
        right, (front, back) = limits[0, 1], limits[1]
        if np.any((ticks[0] > right - room) & (ticks[0] <= right)):
            # A tick beyond the limits would move the limits.
            self.axes.set_yticks(ticks[1][(ticks[1] > front + room) & (ticks[1] <= back)])

    def _zoom(self, widths: FloatArray) -> float:
        """Zoom at which a box with these sides fills its panel up to the labels."""
        x, y, z = BOX * widths / np.linalg.norm(widths)
        sine, cosine = abs(np.sin(AZIMUTH)), abs(np.cos(AZIMUTH))
        seen_width = x * sine + y * cosine
        seen_height = z * np.cos(ELEVATION) + (x * cosine + y * sine) * np.sin(ELEVATION)
        sides = self.axes.get_position().size * self.axes.figure.get_size_inches()
        room = PANEL * (sides - 2 * (SMALL_MARGIN if self.small else MARGIN)) / sides.min()
        return float((room / (seen_width, seen_height)).min())


def add_canvas(
    figure: Any, cell: tuple[Any, ...], view: tuple[Plane | None, FloatArray], size: float, *, small: bool = False
) -> Canvas:
    """New axes in a cell (argument of ``add_subplot``) of a figure; a view is a plane, or None, and its axes."""
    plane, view_axes = view
    axes = figure.add_subplot(*cell, projection="3d" if plane is None else None)
    return Canvas(axes, plane, size, view_axes, small)
