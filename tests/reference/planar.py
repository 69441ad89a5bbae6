"""The planar elastica as an initial-value problem."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import solve_ivp

from tests.reference.rods import Array


def elastica_end(length: float, start: ArrayLike, force: ArrayLike, bending: float, weight: float = 0.0) -> Array:
    """State x, z, θ and κ at the end of a piece of an inextensible rod in the plane x–z.

    x′ = cos θ, z′ = sin θ, θ′ = κ and EI κ′ = F_x sin θ − (F_z + w s) cos θ: what is beyond a section pulls it with the
    force F at the start, and with F plus the weight passed on the way further on.

    Args:
        length: of the piece, m.
        start: x, z, θ and κ at its start.
        force: F_x and F_z, N.
        bending: stiffness EI, N m².
        weight: w along −z, N/m.
    """
    along_x, along_z = np.asarray(force, dtype=float)

    def rate(s: float, state: Array) -> list[float]:
        _, _, angle, curvature = state
        cosine, sine = np.cos(angle), np.sin(angle)
        shear = along_x * sine - (along_z + weight * s) * cosine
        return [cosine, sine, curvature, shear / bending]

    begun = np.asarray(start, dtype=float)
    return np.asarray(solve_ivp(rate, (0.0, length), begun, "DOP853", rtol=1e-13, atol=1e-14).y[:, -1])
