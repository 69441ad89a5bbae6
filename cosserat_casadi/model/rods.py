"""A rod of the scene as the record the mechanics reads."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.rotation import quaternion_from_tangent
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.rod import section
from cosserat_casadi.rod.properties import STRAINS, RodProperties

Field = Callable[[FloatArray], FloatArray]

SMALLEST_FORCE = 1e-150
"""Least EI/ℓ² that can be computed with, N: its square is still a number."""

LARGEST_FORCE = 1e150
"""Largest EI/ℓ² that can be computed with, N."""


def rod_properties(rod: scenes.Rod) -> RodProperties:
    """Stiffness, damping, inertia and unloaded strain of a rod of the scene.

    Raises:
        SceneError: the rod is so long or short, so stiff or soft, that its equations cannot be computed with.
    """
    hooke = _hooke(rod)
    properties = RodProperties(
        name=rod.name,
        length=rod.length,
        admitted=rod.admitted,
        basis=rod.basis,
        hooke=hooke,
        intrinsic=tuple(map(_coefficients, (*rod.intrinsic.curvature, *rod.intrinsic.tangent))),
        linear_density=_linear_density(rod),
        rotary_inertia=_rotary_inertia(rod),
        damping=_damping(rod, hooke),
        area=_area(rod),
        diameter=_diameter(rod),
    )
    _refuse_out_of_range(properties)
    return properties


def _refuse_out_of_range(properties: RodProperties) -> None:
    """Refuse a rod whose EI/ℓ² overflows or vanishes: forces are measured by it."""
    # Division by the length twice: its square alone may underflow.
    with np.errstate(all="ignore"):
        force = np.float64(properties.bending_stiffness) / properties.length / properties.length
    if SMALLEST_FORCE <= force <= LARGEST_FORCE:
        return
    problem = (
        f"its length of {properties.length:g} m and its stiffness EI give EI/ℓ² = {force:g} N, "
        "which is too large or too small to compute with"
    )
    raise SceneError(Problem(properties.name, problem, "give lengths in m, moduli in Pa, stiffnesses in N m² and N"))


def base_pose(rod: scenes.Rod) -> tuple[FloatArray, FloatArray]:
    """World position (3,) and quaternion (4,) of the rod's base."""
    position = np.asarray(rod.base.position, dtype=float)
    if rod.base.tangent is not None:
        return position, quaternion_from_tangent(rod.base.tangent)
    return position, np.asarray(rod.base.quaternion, dtype=float)


def _coefficients(component: float | Sequence[float]) -> tuple[float, ...]:
    values = np.atleast_1d(np.asarray(component, dtype=float))
    return tuple(float(v) for v in values)


def _linear(value: float | Sequence[float]) -> Field:
    """A size along the rod: constant, or linear from base to tip."""
    if isinstance(value, int | float):
        return lambda X: value + 0.0 * X
    base, tip = value
    return lambda X: base + (tip - base) * X


def _hooke(rod: scenes.Rod) -> Field:
    if rod.stiffness is not None:
        # One that is not given is not admitted, and not read.
        return _direct(rod.stiffness, np.nan)
    assert rod.material is not None
    assert rod.section is not None
    youngs_modulus = rod.material.youngs_modulus
    shear_modulus = _shear_modulus(rod.material)
    correction = rod.section.shear_correction
    shape = _section_shape(rod.section)
    return lambda X: section.hooke(shape(X), youngs_modulus, shear_modulus, correction)


def _shear_modulus(material: scenes.Material) -> float:
    """G of an isotropic material, E / (2 (1 + ν)) where Poisson's ratio is given."""
    if material.shear_modulus is not None:
        return material.shear_modulus
    assert material.poisson_ratio is not None
    return material.youngs_modulus / (2 * (1 + material.poisson_ratio))


def _direct(given: scenes.Stiffness | scenes.Damping, left_out: float) -> Field:
    """Coefficients of the six strains as given, each constant or linear from base to tip, shape (k, 6).

    Args:
        given: coefficients by strain.
        left_out: value of those that are not given.
    """
    fields = [getattr(given, name) for name in STRAINS]
    linear = [_linear(left_out if field is None else field) for field in fields]
    return lambda X: np.stack([np.broadcast_to(f(X), X.shape) for f in linear], axis=-1)


def _section_shape(
    shape: scenes.Circle | scenes.Annulus | scenes.Rectangle,
) -> Callable[[FloatArray], section.SectionShape]:
    if isinstance(shape, scenes.Circle):
        radius = _linear(shape.radius)
        return lambda X: section.circle(_array(radius, X))
    if isinstance(shape, scenes.Annulus):
        outer = _linear(shape.outer_radius)
        inner = _linear(shape.inner_radius)
        return lambda X: section.annulus(_array(outer, X), _array(inner, X))
    width = _linear(shape.width)
    height = _linear(shape.height)
    return lambda X: section.rectangle(_array(width, X), _array(height, X))


def _array(field: Field, X: FloatArray) -> FloatArray:
    return np.broadcast_to(field(X), X.shape)


def _linear_density(rod: scenes.Rod) -> Field | None:
    if rod.linear_density is not None:
        given = _linear(rod.linear_density)
        return lambda X: _array(given, X)
    if rod.material is None or rod.section is None or rod.material.density is None:
        return None
    density = rod.material.density
    shape = _section_shape(rod.section)
    return lambda X: density * shape(X).area


def _rotary_inertia(rod: scenes.Rod) -> Field | None:
    """Moments of inertia per length (k, 3): as given, or ρ I_xx, ρ I_yy and ρ (I_xx + I_yy) of the section."""
    if rod.rotary_inertia is not None:
        given = np.asarray(rod.rotary_inertia, dtype=float)
        return lambda X: np.tile(given, (len(X), 1))
    if rod.material is None or rod.section is None or rod.material.density is None:
        return None
    density = rod.material.density
    shape = _section_shape(rod.section)
    return lambda X: density * shape(X).second_moments


def _area(rod: scenes.Rod) -> Field | None:
    """Area of the sections (k,); None of a rod that is given by its stiffness."""
    if rod.section is None:
        return None
    shape = _section_shape(rod.section)
    return lambda X: shape(X).area


def _diameter(rod: scenes.Rod) -> Field | None:
    """Outer diameter of round sections (k,); None of others."""
    if isinstance(rod.section, scenes.Circle):
        radius = _linear(rod.section.radius)
    elif isinstance(rod.section, scenes.Annulus):
        radius = _linear(rod.section.outer_radius)
    else:
        return None
    return lambda X: 2 * _array(radius, X)


def _damping(rod: scenes.Rod, hooke: Field) -> Field | None:
    """Diagonal of the Kelvin–Voigt tensor (k, 6): τ H, or coefficients as given."""
    if rod.damping is None:
        return None
    time = rod.damping.retardation_time
    if time is not None:
        return lambda X: time * hooke(X)
    return _direct(rod.damping, 0.0)
