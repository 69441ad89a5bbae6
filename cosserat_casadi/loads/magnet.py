"""Magnetised rods and dipoles in a field: energy −m·B, of which moment m × B and force ∇(m·B) are the derivatives.

The field is a sum of three: a uniform field, a field that is linear in the position, and the field of a dipole. J. D.
Jackson, *Classical Electrodynamics*, 3rd ed., (5.56), (5.72). Interactions of the magnets of a scene are left out.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import final

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.errors import Problem
from cosserat_casadi.loads.load import Load, Section, Site, coefficients, legendre_series
from cosserat_casadi.maths.numbers import Numbers, Scalar, columns_times, is_zero, known
from cosserat_casadi.maths.typing import Matrix

MU_0_OVER_4_PI = 1e-7
"""μ₀/4π, T m/A: exact to nine digits in today's SI."""


@final
class MagnetLoad(Load[scenes.Magnet]):
    """A moment per length (A m) all along a rod, or a moment (A m²) at a section or in a body."""

    record = scenes.Magnet
    uniform = True

    def abscissa(self, load: scenes.Magnet) -> Scalar | None:
        """Abscissa of the section with a dipole; None for a magnetised rod."""
        return None if load.moment is None else load.at

    def energy(self, load: scenes.Magnet, section: Section, values: Mapping[str, Matrix]) -> Matrix:
        """−m·B, J or J/m."""
        field = values["field"]
        if load.gradient is not None:
            field = field + values["gradient"] @ section.position
        if load.dipole is not None:
            field = field + _dipole_field(section.position, values["dipole.position"], values["dipole.moment"])
        return -ca.dot(self._moment(load, section, values), field)

    def data(self, load: scenes.Magnet, site: Site) -> Numbers:
        """Moment per length in section axes at the sections of a magnetised rod, A m, without zero components."""
        if load.magnetisation is None:
            return np.zeros((0, site.X.shape[0]))
        series = coefficients(load.magnetisation)[_components(load), :]
        magnetisation = legendre_series(series, site.X)
        # The magnetisation of a rod without a section is given as its moment per length.
        if site.rod.area is None:
            return magnetisation
        return columns_times(magnetisation, site.rod.area(site.X))

    def faults(self, load: scenes.Magnet, site: Site) -> Iterator[Problem]:
        """The source of the field is inside the rod, where a dipole has no field."""
        if load.dipole is None:
            return
        source = np.asarray(load.dipole.position)[:, None]
        distances = np.linalg.norm(known(site.unloaded_position) - source, axis=0)
        reach = np.full(site.X.shape[0], ON_THE_AXIS * site.rod.length)
        if site.rod.diameter is not None:
            reach = known(site.rod.diameter(site.X)) / 2
        if np.any(distances <= reach):
            problem = f"lies inside the unloaded rod {site.rod.name!r}"
            yield Problem(f"{load.name}.dipole.position", problem, "move the source away from the rod")

    def _moment(self, load: scenes.Magnet, section: Section, values: Mapping[str, Matrix]) -> Matrix:
        """Moment, A m², or moment per length, A m, in world axes."""
        if load.magnetisation is None:
            return section.rotation @ values["moment"]
        return section.rotation[:, _components(load)] @ section.data


ON_THE_AXIS = 1e-9
"""Distance, relative to the length, within which a source counts as inside a rod that is given by its stiffness."""


def _components(load: scenes.Magnet) -> list[int]:
    """Axes of the section along which the rod is magnetised."""
    assert load.magnetisation is not None
    rows = coefficients(load.magnetisation)
    return [axis for axis in range(3) if not is_zero(rows[axis, :])]


def _dipole_field(position: Matrix, source: Matrix, moment: Matrix) -> Matrix:
    """Field of a dipole, T, 3×1."""
    apart = position - source
    square = ca.sumsqr(apart)
    distance = ca.sqrt(square)
    along = 3 * ca.dot(apart, moment) / square * apart
    return MU_0_OVER_4_PI * (along - moment) / (square * distance)
