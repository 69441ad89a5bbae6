"""Numbers of results as text."""

from __future__ import annotations

import numpy as np

from cosserat_casadi.maths.typing import FloatArray

ROUNDING = 1e-14
"""What is smaller beside the largest entry of a vector is shown as zero."""

SMALLEST = 1e-300
"""Keeps the scale of a vector of zeros away from zero."""


def digits(vector: FloatArray) -> list[str]:
    """Entries with six digits; what is zero beside the largest one is shown as zero."""
    magnitudes = np.abs(vector)
    largest = max(float(magnitudes.max()), SMALLEST)
    # What is left of a cancellation would look like a result.
    rounded = np.where(magnitudes <= ROUNDING * largest, 0.0, vector)
    return [f"{entry:.6g}" for entry in rounded]
