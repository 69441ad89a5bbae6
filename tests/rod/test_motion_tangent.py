"""Derivatives of the equations of motion of one rod with q, q̇ and q̈ against AD and against central differences."""

from functools import cache

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from rods import (
    REISSNER,
    RODS,
    STRAIGHT,
    coordinates,
    drawn_motion,
    massive,
    mixed_loads,
    model,
    rod,
    strain_basis,
)

from cosserat_casadi.rod.igm import InverseGeometricModel
from cosserat_casadi.rod.inertia import RodInertia, section_masses
from cosserat_casadi.rod.kinematics import shape
from cosserat_casadi.rod.motion_tangent import Jet, MotionMatrices, MotionTangent
from cosserat_casadi.rod.rod_motion import AT_REST, FrameMotion, RodMotion, StrainRates
from cosserat_casadi.rod.statics import Statics
from cosserat_casadi.rod.tangent import Tangent
from tests.derivatives import central_differences
from tests.families import mostly_slow

BREAKS = {"one": (0.0, 1.0), "two": (0.0, 0.3, 1.0)}
ARGUMENTS = ["q", "v", "a"]


def system(basis, q, v, a, *, moving, ratio=None):
    """Residual of a loaded rod in motion, and its derivatives as written."""
    _, base = drawn_motion(basis, 9, moving=moving)
    changing = [None, None, None] if ratio is None else [ca.DM(ratio), ca.DM(0.6), ca.DM(-0.3)]
    rod_shape = shape(basis, q, changing[0])
    motion = RodMotion(rod_shape, StrainRates(v, a, *changing[1:]), base)
    inertia = RodInertia(motion, section_masses(basis))
    loads = [*mixed_loads(basis, follower=False), *mixed_loads(basis, follower=True, seed=1), inertia.wrench]
    igm = InverseGeometricModel(Statics(rod_shape, loads))
    tangent = Tangent(igm)
    matrices = MotionTangent(tangent, inertia, floating=False).matrices
    unit = basis.energy_unit
    written = [tangent.jacobian + matrices.stiffness / unit, matrices.damping / unit, matrices.mass / unit]
    return igm.residual, written, inertia


@cache
def case(name, breaks="one", *, rotary=True, moving=True, ratio=None, transport="magnus8", straight=False):
    properties = rod(RODS[name], STRAIGHT) if straight else rod(RODS[name])
    basis = strain_basis(
        massive(properties, rotary=rotary), modes=2, nodes=4, breaks=BREAKS[breaks], transport=transport
    )
    symbols = [ca.MX.sym(name, basis.size) for name in ARGUMENTS]
    residual, written, inertia = system(basis, *symbols, moving=moving, ratio=ratio)
    automatic = [ca.jacobian(residual, symbol) for symbol in symbols]
    energy = inertia.kinetic_energy
    hessian, _ = ca.hessian(energy, symbols[1])
    outputs = [ca.densify(value) for value in (residual, *written, *automatic, hessian / basis.energy_unit)]
    return basis, ca.Function("compared", symbols, outputs)


def state(basis, seed=1):
    q, v, a = (coordinates(basis, seed + k) for k in range(3))
    return q, v, a


def check(compared, *at):
    values = [value.full() for value in compared(*at)]
    for own, by_ad in zip(values[1:4], values[4:7], strict=True):
        assert np.all(np.isfinite(own))
        assert_allclose(own, by_ad, rtol=1e-11, atol=1e-12)
    return values


@pytest.mark.parametrize("rotary", mostly_slow([False, True], quick=[True]), ids=["point", "rotary"])
@pytest.mark.parametrize("breaks", BREAKS)
@pytest.mark.parametrize("name", mostly_slow(RODS, quick=[*RODS][1::2]))
def test_derivatives_vs_ad(name, breaks, rotary):
    basis, compared = case(name, breaks, rotary=rotary)
    check(compared, *state(basis))


@pytest.mark.parametrize("name", ["planar", "kirchhoff", "reissner"])
def test_derivatives_vs_ad_of_a_rod_that_is_drawn_out(name):
    basis, compared = case(name, ratio=1.3)
    check(compared, *state(basis))


@pytest.mark.parametrize("transport", mostly_slow(["magnus4", "magnus6"], quick=["magnus6"]))
@pytest.mark.parametrize("name", mostly_slow(["kirchhoff", "reissner"], quick=["reissner"]))
def test_derivatives_vs_ad_for_each_transport(name, transport):
    basis, compared = case(name, "two", transport=transport)
    check(compared, *state(basis, 4))


@pytest.mark.parametrize("straight", [True, False], ids=["straight", "curved"])
@pytest.mark.parametrize("name", mostly_slow(RODS, quick=[*RODS][1::2]))
def test_derivatives_vs_ad_without_strain(name, straight):
    """No angle is divided by: also without any rate, where all matrices but M and the stiffness vanish."""
    basis, compared = case(name, straight=straight)
    zero = np.zeros(basis.size)
    check(compared, zero, *state(basis)[1:])
    check(compared, zero, zero, zero)


@pytest.mark.parametrize("name", mostly_slow(["planar", "kirchhoff", "reissner", "odd"], quick=["reissner", "odd"]))
def test_derivatives_vs_central_differences(name):
    basis, compared = case(name, "two")
    residual = compared.factory("residual_alone", compared.name_in(), [compared.name_out(0)])
    at = list(state(basis))
    own = [value.full() for value in compared(*at)[1:4]]
    for number, matrix in enumerate(own):
        differences = central_differences(
            lambda moved, k=number: residual(*at[:k], moved, *at[k + 1 :]), np.ravel(at[number]), 1e-5
        )
        assert_allclose(matrix, differences, rtol=1e-7, atol=1e-8)


@pytest.mark.parametrize("rotary", [False, True], ids=["point", "rotary"])
@pytest.mark.parametrize("name", mostly_slow(RODS, quick=[*RODS][1::2]))
def test_mass_is_the_hessian_of_the_kinetic_energy(name, rotary):
    basis, compared = case(name, "two", rotary=rotary)
    values = [value.full() for value in compared(*state(basis))]
    mass, hessian = values[3], values[7]
    assert_allclose(mass, hessian, rtol=0, atol=1e-13)
    assert_allclose(mass, mass.T, rtol=0, atol=1e-14)
    assert np.linalg.eigvalsh(hessian).min() > -1e-14


def test_straight_kirchhoff_rod_without_rotary_inertia_has_no_mass_in_torsion():
    basis, compared = case("kirchhoff", rotary=False, moving=False, straight=True)
    zero = np.zeros(basis.size)
    mass = compared(zero, zero, zero)[3].full()
    torsion = basis.columns[2]
    assert_allclose(mass[torsion], 0.0, rtol=0, atol=1e-16)
    assert np.linalg.matrix_rank(mass) == basis.size - basis.size_of(2)


@pytest.mark.parametrize("rotary", [False, True], ids=["point", "rotary"])
def test_mass_of_a_floating_rod_vs_ad(rotary):
    """Rows of the strains and of the base wrench, columns of the accelerations of strains and base.

    The other derivatives of a rod that floats are tested in the unknowns of its base: test_inverse_dynamics.py.
    """
    basis = strain_basis(massive(rod(REISSNER), rotary=rotary), modes=2, nodes=4, breaks=BREAKS["two"])
    q, v, a = state(basis)
    _, base = drawn_motion(basis, 9)
    motion = RodMotion(shape(basis, ca.DM(q)), StrainRates(ca.DM(v), ca.DM(a)), base)
    inertia = RodInertia(motion, section_masses(basis))
    igm = InverseGeometricModel(Statics(motion.shape, [inertia.wrench]))
    written = MotionTangent(Tangent(igm), inertia, floating=True).matrices

    shift, turn, strain = ca.MX.sym("shift", 3), ca.MX.sym("turn", 3), ca.MX.sym("strain", basis.size)
    pushed = FrameMotion(
        base.velocity, base.angular_velocity, base.acceleration + shift, base.angular_acceleration + turn
    )
    moved = RodMotion(motion.shape, StrainRates(ca.DM(v), a + strain), pushed)
    statics = Statics(motion.shape, [RodInertia(moved, inertia.masses).wrench])
    forces = ca.vertcat(
        basis.energy_unit * InverseGeometricModel(statics).residual, statics.base_moment, statics.base_force
    )
    symbols = [strain, turn, shift]
    blocks = [ca.jacobian(forces, symbol) for symbol in symbols]
    by_ad = ca.Function("mass", symbols, [ca.horzcat(*blocks)])(0, 0, 0).full()
    assert_allclose(written.mass.full(), by_ad, rtol=0, atol=1e-13)
    assert_allclose(by_ad, by_ad.T, rtol=0, atol=1e-13)


def test_jet_of_new_coordinates_vs_ad():
    """Forces of z(u): with z̈ = P ü + Ṗ u̇, the derivatives with u, u̇ and ü at fixed pull-back."""
    draw = np.random.default_rng(3).standard_normal
    of_z = MotionMatrices(*(ca.DM(draw((3, 3))) for _ in range(3)))
    u, du, ddu = (ca.MX.sym(name, 2) for name in ("u", "du", "ddu"))
    z = ca.vertcat(u[0] ** 2 + u[1], ca.sin(u[0] * u[1]), ca.exp(u[1]))
    P = ca.jacobian(z, u)
    state_of, direction = ca.vertcat(u, du), ca.vertcat(du, ddu)
    rate = ca.reshape(ca.jtimes(ca.vec(P), state_of, direction), 3, 2)
    whole, whole_direction = ca.vertcat(u, du, ddu), ca.vertcat(du, ddu, ca.DM(2, 1))
    # The third derivative of u enters the second rate of P nowhere.
    acceleration = ca.reshape(ca.jtimes(ca.vec(rate), whole, whole_direction), 3, 2)
    dz = P @ du
    ddz = P @ ddu + rate @ du
    force = of_z.stiffness @ z + of_z.damping @ dz + of_z.mass @ ddz
    frozen = ca.MX.sym("P", 3, 2)
    pulled = frozen.T @ force
    expected = [ca.substitute(ca.jacobian(pulled, symbol), frozen, P) for symbol in (u, du, ddu)]
    written = of_z.along(Jet(P, rate, acceleration))
    found = [written.stiffness, written.damping, written.mass]
    compare = ca.Function("compare", [u, du, ddu], [*found, *expected])
    values = [value.full() for value in compare(*draw((3, 2)))]
    for own, by_ad in zip(values[:3], values[3:], strict=True):
        assert_allclose(own, by_ad, rtol=0, atol=1e-12)


def test_at_rest_inertia_adds_nothing_to_the_stiffness():
    basis = strain_basis(massive(rod()), modes=2, nodes=4)
    q, zero = ca.DM(coordinates(basis)), ca.DM.zeros(basis.size, 1)
    motion = RodMotion(shape(basis, q), StrainRates(zero, zero), AT_REST)
    inertia = RodInertia(motion, section_masses(basis))
    igm = model(basis, q, [inertia.wrench])
    matrices = MotionTangent(Tangent(igm), inertia, floating=False).matrices
    assert_allclose(ca.densify(matrices.stiffness).full(), 0.0, rtol=0, atol=0)
    assert_allclose(ca.densify(matrices.damping).full(), 0.0, rtol=0, atol=0)
