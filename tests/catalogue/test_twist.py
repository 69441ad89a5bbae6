"""Catalogue (g): twisted rods and rings buckle where linear theory says; a writhing rod is an equilibrium.

Twist is not an input of a scene; a rod held without the twist that it has unloaded is twisted all the same. Critical
values are zeros of the smallest eigenvalue of the second variation over scenes.
"""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import brentq

from tests.catalogue import cases
from tests.catalogue.checks import column_eigenvalue, initial_value_error, ring_eigenvalue, solved, zero_near


def test_torque_alone_vs_greenhill() -> None:
    wave = brentq(lambda z: np.tan(z) - z, 4.4, 4.6, xtol=1e-15)
    assert_allclose(cases.critical_torque(0.0), 2 * wave, rtol=1e-12, atol=0)
    found = zero_near(lambda M: column_eigenvalue(M / 2.0, 0.0, 2.0), 2 * wave)
    assert_allclose(found, 2 * wave, rtol=1e-6, atol=0)


@pytest.mark.parametrize("stretch", [-0.1, 0.2])
def test_torque_with_tension_or_compression_vs_linear_theory(stretch: float) -> None:
    """EA = 100 EI/L²: a stretch of 0.2 is a tension of 20 EI/L²."""
    torsion, axial = 2.0, 100.0
    reference = cases.critical_torque(axial * stretch, stretch)
    found = zero_near(lambda M: column_eigenvalue(M / torsion, stretch, torsion), reference)
    assert_allclose(found, reference, rtol=1e-6, atol=0)


@pytest.mark.parametrize("torsion", [2 / 3, pytest.param(2.0, marks=pytest.mark.slow)])
def test_twisted_ring_flips_at_root_three_turns(torsion: float) -> None:
    """J. H. Michell 1889, E. E. Zajac, J. Appl. Mech. 29 (1962) 136: a twist of √3 · 2π EI/GJ."""
    critical = np.sqrt(3) * 2 * np.pi / torsion
    found = zero_near(lambda twist: ring_eigenvalue(twist, torsion), critical)
    assert_allclose(found, critical, rtol=1e-6, atol=0)


@pytest.mark.parametrize("twist", [4.0, *(pytest.param(t, marks=pytest.mark.slow) for t in (2.0, 6.0))])
def test_writhing_rod_vs_initial_value(twist: float) -> None:
    assert initial_value_error(solved(cases.writhing_rod(twist))) < 1e-8
