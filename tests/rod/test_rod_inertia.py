"""Kinetic energy, momentum and inertia forces of a rod: against the continuous rod, and against each other."""

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from rods import (
    KIRCHHOFF,
    PLANAR,
    REISSNER,
    coordinates,
    drawn_motion,
    massive,
    reference_motion,
    rod,
    strain_basis,
)

from cosserat_casadi.rod.inertia import RodInertia, second_moments, section_masses
from cosserat_casadi.rod.kinematics import shape
from cosserat_casadi.rod.rod_motion import FrameMotion, RodMotion, StrainRates

RODS = {"planar": PLANAR, "kirchhoff": KIRCHHOFF, "reissner": REISSNER, "stretched": (5,)}
ROTARY = pytest.mark.parametrize("rotary", [False, True], ids=["point", "rotary"])
RATIOS = pytest.mark.parametrize("ratio", [None, 1.3], ids=["fixed", "drawn-out"])


def inertia_of(basis, q, rates, base, ratio=None):
    motion = RodMotion(shape(basis, ca.DM(q), None if ratio is None else ca.DM(ratio)), rates, base)
    return RodInertia(motion, section_masses(basis))


def test_second_moments_vs_those_of_a_box():
    """A box of sides a, b, c and mass m: m a²/12 along its axis, m (b² + c²)/12 about it."""
    a, b, c = 0.3, 0.2, 0.5
    about = np.array([[b**2 + c**2, a**2 + c**2, a**2 + b**2]]) / 12
    assert_allclose(second_moments(about), np.array([[a**2, b**2, c**2]]) / 12, rtol=1e-14, atol=0)


def test_plane_section_has_no_second_moment_along_the_tangent():
    thick = massive(rod())
    plane = replace(thick, rotary_inertia=lambda X: np.tile([0.1, 0.2, 0.1 + 0.2], (len(X), 1)))
    assert sorted(section_masses(strain_basis(thick)).second_moments) == [0, 1, 2]
    assert sorted(section_masses(strain_basis(plane)).second_moments) == [0, 1]


@RATIOS
@ROTARY
@pytest.mark.parametrize("name", RODS)
def test_kinetic_energy_vs_the_continuous_rod(name, rotary, ratio):
    basis = strain_basis(massive(rod(RODS[name]), rotary=rotary), modes=3, nodes=30, breaks=(0.0, 0.35, 1.0))
    q = coordinates(basis, 1)
    rates, base = drawn_motion(basis, 2, ratio=ratio is not None)
    _, expected = reference_motion(basis, q, rates, base, ratio or 1.0)
    found = float(inertia_of(basis, q, rates, base, ratio).kinetic_energy)
    assert_allclose(found, expected, rtol=1e-12, atol=0)


def test_kinetic_energy_converges_spectrally():
    """The error falls by a factor with every two nodes, not by a power of their number."""
    errors = []
    for nodes in (6, 8, 10, 12, 14):
        basis = strain_basis(massive(rod(REISSNER)), modes=3, nodes=nodes)
        q = coordinates(basis, 1, 1.5)
        rates, base = drawn_motion(basis, 2, 1.5)
        _, expected = reference_motion(basis, q, rates, base)
        errors.append(abs(float(inertia_of(basis, q, rates, base).kinetic_energy) / expected - 1))
    digits = np.diff(-np.log10(errors))
    assert digits.mean() > 1.3
    assert errors[-1] < 1e-11


@RATIOS
@ROTARY
@pytest.mark.parametrize("name", RODS)
def test_momenta_are_derivatives_of_the_kinetic_energy(name, rotary, ratio):
    """∂T/∂ of the velocity of the base is the momentum, ∂T/∂ of its angular velocity the angular momentum about it."""
    basis = strain_basis(massive(rod(RODS[name]), rotary=rotary), modes=2, nodes=6, breaks=(0.0, 0.35, 1.0))
    q = coordinates(basis, 1)
    rates, base = drawn_motion(basis, 2, ratio=ratio is not None)
    velocity, omega = ca.MX.sym("velocity", 3), ca.MX.sym("omega", 3)
    moving = FrameMotion(velocity, omega, base.acceleration, base.angular_acceleration)
    inertia = inertia_of(basis, q, rates, moving, ratio)
    by_ad = [ca.gradient(inertia.kinetic_energy, symbol) for symbol in (velocity, omega)]
    own = [inertia.linear_momentum, inertia.angular_momentum]
    compare = ca.Function("compare", [velocity, omega], [*own, *by_ad])
    linear, angular, by_velocity, by_omega = (m.full() for m in compare(base.velocity, base.angular_velocity))
    assert_allclose(linear, by_velocity, rtol=0, atol=1e-14)
    assert_allclose(angular, by_omega, rtol=0, atol=1e-14)


@ROTARY
def test_resultant_of_the_inertia_is_minus_the_rate_of_the_momentum(rotary):
    """Force and moment about a point of the world, of a rod of fixed length whose base passes through it."""
    basis = strain_basis(massive(rod(REISSNER), rotary=rotary), modes=2, nodes=6, breaks=(0.0, 0.35, 1.0))
    q = coordinates(basis, 1)
    rates, base = drawn_motion(basis, 2)
    inertia = inertia_of(basis, q, rates, base)
    lengths = ca.DM(basis.node_lengths)
    force = (inertia.wrench.force @ lengths).full().ravel()
    lever = ca.cross(inertia.motion.shape.position, inertia.wrench.force, 1)
    moment = lever @ lengths
    if rotary:
        moment = moment + inertia.wrench.moment @ lengths

    t = ca.MX.sym("t")
    # Momenta in the axes of the base, which turn: their rates in the world are ḣ + ω × h, and so on.
    path = ca.DM(q) + t * rates.velocity + t**2 / 2 * rates.acceleration
    omega = base.angular_velocity + t * base.angular_acceleration
    turning_rate = ca.cross(base.angular_velocity, base.velocity)
    speed = base.velocity + t * (base.acceleration - turning_rate)
    later = FrameMotion(speed, omega, base.acceleration, base.angular_acceleration)
    moved = StrainRates(rates.velocity + t * rates.acceleration, rates.acceleration)
    moving = RodInertia(RodMotion(shape(basis, path), moved, later), inertia.masses)
    momenta = [moving.linear_momentum, moving.angular_momentum]
    derivatives = [ca.jacobian(momentum, t) for momentum in momenta]
    results = ca.Function("momenta", [t], [*momenta, *derivatives])(0.0)
    linear, angular, linear_rate, angular_rate = (result.full().ravel() for result in results)
    spin, velocity = base.angular_velocity.full().ravel(), base.velocity.full().ravel()
    assert_allclose(force, -(linear_rate + np.cross(spin, linear)), rtol=0, atol=1e-13)
    # About a point that stays where the base passes: the base carries the momentum along.
    expected = angular_rate + np.cross(spin, angular) + np.cross(velocity, linear)
    assert_allclose(moment.full().ravel(), -expected, rtol=0, atol=1e-13)


def test_a_rod_without_mass_has_no_inertia():
    assert section_masses(strain_basis(rod())) is None
