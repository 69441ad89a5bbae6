"""Inertia and damping of a rod of the scene, against integrals over its section."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss
from numpy.testing import assert_allclose, assert_array_equal

from cosserat_casadi.model.scene_rods import rod_properties
from cosserat_casadi.rod.properties import RodProperties
from tests.scenes import rod, scene

X = np.array([0.0, 0.3, 1.0])
DENSITY = 1100.0


def properties(**changes: Any) -> RodProperties:
    tables = {key: value for key, value in rod("reissner", **changes).items() if value is not None}
    return rod_properties(scene(rods=[tables]).rods[0])


def of_section(section: dict[str, Any], **changes: Any) -> RodProperties:
    material = {"youngs_modulus": 2e6, "poisson_ratio": 0.4, "density": DENSITY}
    return properties(stiffness=None, linear_density=None, material=material, section=section, **changes)


def by_quadrature(half_width: float, half_height: float, radius: float | None) -> np.ndarray:
    """ρ ∫ (y², x², x² + y²) dA over a rectangle, or over a disc of the radius in polar coordinates."""
    points, weights = leggauss(12)
    if radius is None:
        x, y = np.meshgrid(half_width * points, half_height * points)
        area = half_width * half_height * np.outer(weights, weights)
    else:
        r = radius * (points + 1) / 2
        angle = 2 * np.pi * np.arange(12) / 12
        x = np.outer(np.cos(angle), r)
        y = np.outer(np.sin(angle), r)
        area = np.outer(np.full(12, 2 * np.pi / 12), radius / 2 * weights * r)
    return DENSITY * np.array([(area * y**2).sum(), (area * x**2).sum(), (area * (x**2 + y**2)).sum()])


def test_rotary_inertia_of_a_tapered_rectangle() -> None:
    """About x it is y that counts; the polar moment is not the torsion constant."""
    given = of_section({"shape": "rectangle", "width": [0.03, 0.02], "height": 0.01})
    assert given.rotary_inertia is not None
    expected = [by_quadrature((0.03 - 0.01 * at) / 2, 0.005, None) for at in X]
    assert_allclose(given.rotary_inertia(X), expected, rtol=1e-13, atol=0.0)


def test_rotary_inertia_of_a_tapered_tube() -> None:
    given = of_section({"shape": "annulus", "outer_radius": [0.02, 0.01], "inner_radius": 0.005})
    assert given.rotary_inertia is not None
    bore = by_quadrature(0.0, 0.0, 0.005)
    expected = [by_quadrature(0.0, 0.0, 0.02 - 0.01 * at) - bore for at in X]
    assert_allclose(given.rotary_inertia(X), expected, rtol=1e-12, atol=0.0)


def test_rotary_inertia_as_given() -> None:
    given = properties(rotary_inertia=[1e-7, 2e-7, 4e-7])
    assert given.rotary_inertia is not None
    assert_array_equal(given.rotary_inertia(X), [[1e-7, 2e-7, 4e-7]] * 3)


def test_what_a_rod_does_not_have() -> None:
    plain = properties()
    assert plain.rotary_inertia is None
    assert plain.damping is None
    material = {"youngs_modulus": 2e6, "poisson_ratio": 0.4}
    section = {"shape": "circle", "radius": 0.01}
    massless = properties(stiffness=None, linear_density=None, material=material, section=section)
    assert massless.linear_density is None
    assert massless.rotary_inertia is None


def test_retardation_times_the_stiffness() -> None:
    given = of_section({"shape": "circle", "radius": [0.02, 0.01]}, damping={"retardation_time": 0.03})
    assert given.damping is not None
    assert_allclose(given.damping(X), 0.03 * given.hooke(X), rtol=1e-15, atol=0.0)
    # EI = E π r⁴ / 4 in the middle of the taper.
    middle = given.damping(np.array([0.5]))[0, 0]
    assert_allclose(middle, 0.03 * 2e6 * np.pi * 0.015**4 / 4, rtol=1e-14, atol=0.0)


def test_coefficients_of_damping_are_those_given() -> None:
    given = properties(damping={"bending_x": 1e-4, "extension": [0.2, 0.1]})
    assert given.damping is not None
    expected = np.zeros((3, 6))
    expected[:, 0] = 1e-4
    expected[:, 5] = [0.2, 0.17, 0.1]
    assert_allclose(given.damping(X), expected, rtol=1e-15, atol=0.0)


@pytest.mark.parametrize("count", [1, 7])
def test_shapes(count: int) -> None:
    given = of_section({"shape": "circle", "radius": 0.02}, damping={"retardation_time": 0.03})
    assert given.rotary_inertia is not None
    assert given.damping is not None
    abscissae = np.linspace(0, 1, count)
    assert given.rotary_inertia(abscissae).shape == (count, 3)
    assert given.damping(abscissae).shape == (count, 6)
