"""How loads are drawn: arrows, as data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from cosserat_casadi.maths.typing import FloatArray

Sort = Literal["point", "moment", "line"]

UNITS: dict[Sort, str] = {"point": "N", "moment": "N m", "line": "N/m"}
"""Unit of an arrow of each sort."""


@dataclass(frozen=True)
class Arrow:
    """An arrow of a picture.

    Attributes:
        start: where it begins, world axes, shape (3,), m.
        vector: force, moment or force per length, world axes, shape (3,), in the unit of its sort.
        sort: kind of vector that the arrow stands for.
        label: its entry in the legend; empty for one that another arrow speaks for.
    """

    start: FloatArray
    vector: FloatArray
    sort: Sort
    label: str
