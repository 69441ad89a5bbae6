"""Conversion of a rod of the scene to the properties that the mechanics reads."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.numbers import (
    Numbers,
    Scalar,
    any_symbolic,
    as_vector,
    is_symbolic,
    is_zero,
    known,
    side_by_side,
)
from cosserat_casadi.maths.rotation import quaternion_from_tangent
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.materials import LAWS, LawOfRod, coupled_stiffness
from cosserat_casadi.model.sections import SHAPES, along, linear, sizes_along, sizes_of
from cosserat_casadi.rod.properties import STRAINS, EnergyBeyondHooke, Field, FixedMass, MaxwellBranch, RodProperties
from cosserat_casadi.rod.section import SectionShape
from cosserat_casadi.rod.section import hooke as hooke_tensor
from cosserat_casadi.scene.material_records import INCOMPRESSIBLE

SMALLEST_FORCE = 1e-150
"""Least EI/ℓ² that is computed with, N: its square does not underflow."""

LARGEST_FORCE = 1e150
"""Largest EI/ℓ² that is computed with, N."""


def rod_properties(rod: scenes.Rod, nominal: RodProperties | None = None, fibres: int = 0) -> RodProperties:
    """Stiffness, damping, inertia and unloaded strain of a rod of the scene.

    Args:
        rod: the rod, whose numbers may be expressions of parameters.
        nominal: the rod with the scene's own numbers, which scales the equations; None if it is ``rod``.
        fibres: points across half of a section at which its law is summed; 0 for the fewest of the law.

    Raises:
        SceneError: the rod is so long or short, so stiff or soft, that its equations cannot be computed with.
    """
    hooke = _hooke(rod)
    ratio = None
    if nominal is not None and (is_symbolic(rod.length) or rod.length != nominal.length):
        ratio = ca.MX(rod.length) / nominal.length
    properties = RodProperties(
        name=rod.name,
        length=rod.length if nominal is None else nominal.length,
        admitted=rod.admitted,
        basis=rod.basis,
        hooke=hooke,
        beyond_hooke=_beyond_hooke(rod, hooke, fibres),
        intrinsic=tuple(map(_coefficients, (*rod.intrinsic.curvature, *rod.intrinsic.tangent))),
        linear_density=_linear_density(rod),
        rotary_inertia=_rotary_inertia(rod),
        damping=_damping(rod, hooke),
        branches=_branches(rod),
        mass_damping=None if rod.damping is None else rod.damping.mass_proportional,
        area=_area(rod),
        diameter=_diameter(rod),
        plane_sections=rod.rotary_inertia is None,
        ratio=ratio,
        nominal=nominal,
    )
    if nominal is None:
        _refuse_out_of_range(properties)
    return properties


def fixed_masses(scene: scenes.Scene, rod: str) -> tuple[FixedMass, ...]:
    """Masses and inertias of the disks on a rod, taken as solid cylinders."""
    masses = []
    for row in scene.disks:
        if row.rod != rod or is_zero(row.mass):
            continue
        across = row.mass * row.radius**2 / 4
        along = row.mass * row.thickness**2 / 12
        masses += [FixedMass(at, row.mass, across, along) for at in row.places]
    return tuple(masses)


def _refuse_out_of_range(properties: RodProperties) -> None:
    """Refuse a rod with an EI/ℓ² that overflows or underflows: it is the unit of forces."""
    # Two divisions by the length: the square of the length alone may underflow.
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
    position, quaternion = written_base_pose(rod)
    return known(position), known(quaternion)


def written_base_pose(rod: scenes.Rod) -> tuple[Numbers, Numbers]:
    """World position (3,) and quaternion (4,) of the rod's base; entries may be expressions of parameters."""
    position = as_vector(rod.base.position)
    if rod.base.tangent is not None:
        return position, quaternion_from_tangent(rod.base.tangent)
    return position, unit_quaternion(rod.base.quaternion)


def unit_quaternion(entries: Sequence[Scalar]) -> Numbers:
    """A quaternion of the scene, shape (4,), which has norm 1; expressions are scaled to norm 1."""
    quaternion = as_vector(entries)
    if is_symbolic(quaternion):
        return quaternion / ca.sqrt(ca.sumsqr(quaternion))
    return quaternion


def _coefficients(component: Scalar | Sequence[Scalar]) -> tuple[Scalar, ...]:
    if isinstance(component, tuple) and any_symbolic(component):
        return component
    if is_symbolic(component):
        return (component,)
    values = np.atleast_1d(np.asarray(component, dtype=float))
    return tuple(float(v) for v in values)


def _shared(field: Field, *sizes: Any) -> Field:
    """A field of sections; if no size varies along the rod and it is an expression, one row for all sections."""
    if any(isinstance(size, tuple) for size in sizes):
        return field

    def at(X: Numbers) -> Numbers:
        anywhere = field(X[:1])
        return anywhere if is_symbolic(anywhere) else field(X)

    return at


def _alike(numbers: Sequence[Scalar]) -> Field:
    """A field of numbers that are the same for all sections; one row for all sections if one is an expression."""
    row = as_vector(numbers)
    if is_symbolic(row):
        return lambda X: row.T
    return lambda X: np.tile(known(row), (X.shape[0], 1))


def _hooke(rod: scenes.Rod) -> Field:
    if rod.stiffness_matrix is not None:
        return _alike([row[i] for i, row in enumerate(rod.stiffness_matrix)])
    if rod.stiffness is not None:
        # A stiffness that is left out belongs to a strain that the rod does not admit.
        return _direct(rod.stiffness)
    assert rod.material is not None
    assert rod.section is not None
    youngs_modulus = rod.material.youngs_modulus
    shear = shear_modulus(rod.material)
    correction = rod.section.shear_correction
    return _of_sections(rod.section, lambda shape: hooke_tensor(shape, youngs_modulus, shear, correction))


def _beyond_hooke(rod: scenes.Rod, hooke: Field, fibres: int) -> EnergyBeyondHooke | None:
    """Elastic energy beyond the energy of the Hooke tensor; None for a linear rod.

    Raises:
        SceneError: the law of its material does not fit its section.
    """
    if rod.stiffness_matrix is not None:
        return coupled_stiffness(rod.stiffness_matrix, LawOfRod(rod, hooke))
    if rod.material is None or rod.section is None:
        return None
    of_rod = LawOfRod(rod, hooke, fibres)
    energy: EnergyBeyondHooke | None = LAWS[rod.material.law].beyond_hooke(rod.material, of_rod)
    return energy


def shear_modulus(material: scenes.Material) -> Scalar:
    """G of an isotropic material: its shear modulus, or E / (2 (1 + ν)) from Poisson's ratio.

    A material with neither is incompressible: G = E/3.
    """
    if material.shear_modulus is not None:
        return material.shear_modulus
    poisson_ratio = INCOMPRESSIBLE if material.poisson_ratio is None else material.poisson_ratio
    return material.youngs_modulus / (2 * (1 + poisson_ratio))


def _direct(given: scenes.Stiffness | scenes.Damping) -> Field:
    """Coefficients of the six strains, each constant or linear from base to tip, shape (k, 6); 0 for others."""
    fields = [getattr(given, name) for name in STRAINS]
    coefficients = [linear(0.0 if field is None else field) for field in fields]
    return _shared(lambda X: side_by_side([along(coefficient, X) for coefficient in coefficients]), *fields)


def _of_sections(record: scenes.Section, quantity: Callable[[SectionShape], Numbers]) -> Field:
    """A field that is a function of the areas and second moments of the sections."""
    shape = SHAPES[record.shape]
    return _shared(lambda X: quantity(shape.shape(sizes_along(record, X))), *sizes_of(record).values())


def _linear_density(rod: scenes.Rod) -> Field | None:
    if rod.linear_density is not None:
        given = linear(rod.linear_density)
        return _shared(lambda X: along(given, X), rod.linear_density)
    if rod.material is None or rod.section is None or rod.material.density is None:
        return None
    density = rod.material.density
    return _of_sections(rod.section, lambda shape: density * shape.area)


def _rotary_inertia(rod: scenes.Rod) -> Field | None:
    """Moments of inertia per length (k, 3): the scene's, or ρ I_xx, ρ I_yy and ρ (I_xx + I_yy) of the section."""
    if rod.rotary_inertia is not None:
        return _alike(rod.rotary_inertia)
    if rod.material is None or rod.section is None or rod.material.density is None:
        return None
    density = rod.material.density
    return _of_sections(rod.section, lambda shape: density * shape.second_moments)


def _area(rod: scenes.Rod) -> Field | None:
    """Area of the sections, shape (k,), m²; None for a rod that is given by its stiffness."""
    if rod.section is None:
        return None
    section = rod.section
    return lambda X: SHAPES[section.shape].shape(sizes_along(section, X)).area


def _diameter(rod: scenes.Rod) -> Field | None:
    """Outer diameter of round sections, shape (k,), m; None for other shapes."""
    if rod.section is None or rod.section.radius_key is None:
        return None
    radius = linear(getattr(rod.section, rod.section.radius_key))
    return lambda X: 2 * along(radius, X)


def _damping(rod: scenes.Rod, hooke: Field) -> Field | None:
    """Diagonal of the Kelvin–Voigt tensor (k, 6): τ H, or the coefficients of the scene."""
    if rod.damping is None or not rod.damping.by_viscosity:
        return None
    time = rod.damping.retardation_time
    if time is not None:
        sizes = [] if rod.section is None else list(sizes_of(rod.section).values())
        if rod.stiffness is not None:
            sizes = [getattr(rod.stiffness, name) for name in STRAINS]
        return _shared(lambda X: time * hooke(X), *sizes)
    if all(getattr(rod.damping, name) is None for name in STRAINS):
        return None
    return _direct(rod.damping)


def _branches(rod: scenes.Rod) -> tuple[MaxwellBranch, ...]:
    """Maxwell branches in parallel with the elasticity of a rod."""
    if rod.damping is None:
        return ()
    branches = []
    for branch in rod.damping.prony:
        named = [getattr(branch, name) for name in STRAINS]
        shares = tuple(branch.share if share is None else share for share in named)
        branches.append(MaxwellBranch(shares, branch.time))
    return tuple(branches)
