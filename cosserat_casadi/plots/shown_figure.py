"""The class of all figures: a matplotlib figure that notebooks display without pyplot."""

from __future__ import annotations

import io

from matplotlib.figure import Figure

RESOLUTION = 72
"""Resolution of a figure in a notebook, dots per inch."""


class ShownFigure(Figure):  # type: ignore[misc]  # matplotlib is not checked
    """Figure that a notebook displays as the value of a cell; with matplotlib's class this needs pyplot."""

    def _repr_png_(self) -> bytes:
        content = io.BytesIO()
        self.savefig(content, format="png", dpi=RESOLUTION)
        return content.getvalue()
