"""The class of all figures: one of matplotlib's that a notebook shows, whether pyplot was imported or not."""

from __future__ import annotations

import io

from matplotlib.figure import Figure

RESOLUTION = 72
"""Resolution of a figure in a notebook, dots per inch."""


class ShownFigure(Figure):  # type: ignore[misc]  # matplotlib is not checked
    """A figure whose picture a notebook shows as the value of a cell; matplotlib registers that with pyplot alone."""

    def _repr_png_(self) -> bytes:
        content = io.BytesIO()
        self.savefig(content, format="png", dpi=RESOLUTION)
        return content.getvalue()
