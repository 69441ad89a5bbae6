"""Numbers of results as text."""

from __future__ import annotations

import numpy as np

from cosserat_casadi.equilibrium.answer_error import UNKNOWN
from cosserat_casadi.maths.typing import FloatArray

ROUNDING = 1e-14
"""Share of the largest entry of a vector below which an entry is shown as zero."""

SMALLEST = 1e-300
"""Keeps the scale of a vector of zeros away from zero."""


def digits(vector: FloatArray) -> list[str]:
    """Entries with six digits; an entry that is negligible beside the largest one is shown as zero."""
    magnitudes = np.abs(vector)
    largest = max(float(magnitudes.max()), SMALLEST)
    # What is left of a cancellation would look like a result.
    rounded = np.where(magnitudes <= ROUNDING * largest, 0.0, vector)
    return [f"{entry:.6g}" for entry in rounded]


def error_words(error: float, within: bool | None, tolerance: float) -> str:
    """An estimated error with markup: beside the tolerance, told apart above it; alone where none has a meaning."""
    words = f"{error:.1e} of the length"
    if error == UNKNOWN:
        words = "not known"
    if within is None:
        return words
    if within:
        return f"{words}, within the tolerance of {tolerance:g}"
    return f"[bold yellow]{words}, above the tolerance of {tolerance:g}[/]"
