"""The radius by which sections keep from obstacles."""

from __future__ import annotations

import numpy as np

from cosserat_casadi.maths.numbers import Numbers, repeated
from cosserat_casadi.rod.properties import RodProperties


def section_radii(rod: RodProperties, X: Numbers) -> Numbers:
    """Radius of the sections of a rod at abscissae X, shape (k,), m; zero where it is given by its stiffness."""
    if rod.diameter is None:
        return np.zeros(X.shape[0])
    return repeated(rod.diameter(X) / 2, X.shape[0])
