"""Motions of frames from quaternions of any norm, and the inertia of a rigid body: against AD, Lagrange and Euler."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from cosserat_casadi import build, scene_from_dict
from cosserat_casadi.maths.rotation import quaternion_to_matrix
from cosserat_casadi.model.floating_frames import turn_matrix
from cosserat_casadi.model.frame_motion import NORM_ROWS, BodyInertia, QuaternionMotion
from cosserat_casadi.rod.motion_tangent import Jet
from cosserat_casadi.rod.rod_motion import FrameMotion
from tests.moving_scenes import drawn_state, joint, rod, scene
from tests.reference.rods import hat

IDENTITY = np.array([1.0, 0.0, 0.0, 0.0])
HALF_TURN = np.array([0.0, 0.6, 0.0, 0.8])
QUATERNIONS = pytest.mark.parametrize(
    "quaternion",
    [IDENTITY, 2 * IDENTITY, HALF_TURN, -0.7 * HALF_TURN, np.array([0.3, -0.8, 0.5, 1.1])],
    ids=["identity", "identity of norm two", "half turn", "half turn the other way", "any"],
)
INERTIA = np.array([[3e-2, 4e-3, -2e-3], [4e-3, 5e-2, 6e-3], [-2e-3, 6e-3, 4e-2]])
CENTRE = np.array([0.1, 0.02, 0.03])
MASS = 0.3


def rates(seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Q̇ and Q̈: the norm changes too."""
    first, second = np.random.default_rng(seed).standard_normal((2, 4))
    return first, second


def in_time(quaternion: np.ndarray, first: np.ndarray, second: np.ndarray) -> tuple[ca.MX, ca.MX]:
    """Time, and a quaternion with these rates at zero."""
    t = ca.MX.sym("t")
    return t, ca.DM(quaternion) + t * ca.DM(first) + t**2 / 2 * ca.DM(second)


@QUATERNIONS
def test_angular_velocity_vs_the_rotation_matrix(quaternion: np.ndarray) -> None:
    """ω^ = Ṙ Rᵀ and (ω̇^ + ω^ ω^) = R̈ Rᵀ of the rotation of Q / |Q|."""
    first, second = rates()
    t, Q = in_time(quaternion, first, second)
    R = quaternion_to_matrix(Q / ca.norm_2(Q))
    rate = ca.jacobian(ca.vec(R), t)
    outputs = [R, ca.reshape(rate, 3, 3), ca.reshape(ca.jacobian(rate, t), 3, 3)]
    here, R_rate, R_acceleration = (m.full() for m in ca.Function("R", [t], outputs)(0.0))
    motion = QuaternionMotion(ca.DM(quaternion), ca.DM(first), ca.DM(second))
    omega, alpha = motion.angular_velocity.full().ravel(), motion.angular_acceleration.full().ravel()
    assert_allclose(hat(omega), R_rate @ here.T, rtol=0, atol=1e-13)
    assert_allclose(hat(alpha) + hat(omega) @ hat(omega), R_acceleration @ here.T, rtol=0, atol=1e-12)


@QUATERNIONS
def test_jet_of_the_turn_vs_ad(quaternion: np.ndarray) -> None:
    first, second = rates(1)
    t, Q = in_time(quaternion, first, second)
    T = turn_matrix(Q)
    rate = ca.jacobian(ca.vec(T), t)
    outputs = [T, ca.reshape(rate, 3, 4), ca.reshape(ca.jacobian(rate, t), 3, 4)]
    expected = ca.Function("T", [t], outputs)(0.0)
    jet = QuaternionMotion(ca.DM(quaternion), ca.DM(first), ca.DM(second)).turn
    for own, by_ad in zip(jet.orders, expected, strict=True):
        assert_allclose(own.full(), by_ad.full(), rtol=0, atol=1e-12)


@QUATERNIONS
def test_a_change_of_the_norm_turns_nothing(quaternion: np.ndarray) -> None:
    motion = QuaternionMotion(ca.DM(quaternion), ca.DM(0.7 * quaternion), ca.DM(-0.3 * quaternion))
    assert_allclose(motion.angular_velocity.full(), 0.0, rtol=0, atol=1e-15)
    assert_allclose(motion.angular_acceleration.full(), 0.0, rtol=0, atol=1e-15)


@QUATERNIONS
def test_rows_of_the_norm_vs_its_second_rate(quaternion: np.ndarray) -> None:
    first, second = rates(2)
    t, Q = in_time(quaternion, first, second)
    square = ca.sumsqr(Q)
    rate = ca.Function("norm", [t], [ca.jacobian(ca.jacobian(square, t), t)])(0.0)
    rows = NORM_ROWS(quaternion, first, second)[0].full().ravel()
    assert_allclose(rows, quaternion * float(rate) / 2, rtol=0, atol=1e-13)


def body_in(position: ca.MX, Q: ca.MX, rates_of: tuple[ca.MX, ...], inertia: np.ndarray = INERTIA) -> BodyInertia:
    """The body with its origin at a position, and with a quaternion, in motion: (ṗ, Q̇, p̈, Q̈)."""
    velocity, rate, acceleration, second = rates_of
    turning = QuaternionMotion(Q, rate, second)
    motion = FrameMotion(velocity, turning.angular_velocity, acceleration, turning.angular_acceleration)
    rotation = quaternion_to_matrix(Q / ca.norm_2(Q))
    return BodyInertia(MASS, CENTRE, inertia, rotation, motion)


@QUATERNIONS
def test_wrench_of_a_body_vs_lagrange(quaternion: np.ndarray) -> None:
    """d/dt ∂T/∂u̇ − ∂T/∂u in position and quaternion, of an energy that is written here from moving points of mass.

    Six points at R (c ± s_k e_k) stand for the body: their second moments are those of its inertia.
    """
    p, Q = ca.MX.sym("p", 3), ca.MX.sym("Q", 4)
    dp, dQ, ddp, ddQ = ca.MX.sym("dp", 3), ca.MX.sym("dQ", 4), ca.MX.sym("ddp", 3), ca.MX.sym("ddQ", 4)
    body = body_in(p, Q, (dp, dQ, ddp, ddQ))
    u, du, ddu = ca.vertcat(p, Q), ca.vertcat(dp, dQ), ca.vertcat(ddp, ddQ)
    spread = np.trace(INERTIA) / 2 * np.eye(3) - INERTIA
    sizes, axes = np.linalg.eigh(spread)
    R = quaternion_to_matrix(Q / ca.norm_2(Q))
    energy = ca.MX(0.0)
    for size, axis in zip(sizes, axes.T, strict=True):
        for sign in (-1, 1):
            point = p + R @ ca.DM(CENTRE + sign * np.sqrt(3 * size / MASS) * axis)
            energy += MASS / 12 * ca.sumsqr(ca.jtimes(point, u, du))
    momentum = ca.gradient(energy, du)
    wanted = ca.jtimes(momentum, ca.vertcat(u, du), ca.vertcat(du, ddu)) - ca.gradient(energy, u)
    moment = body.moment + ca.cross(body.arm, body.force)
    found = -ca.vertcat(body.force, turn_matrix(Q).T @ moment)
    symbols = [p, Q, dp, dQ, ddp, ddQ]
    compare = ca.Function("compare", symbols, [found, wanted, body.kinetic_energy, energy])
    draw = np.random.default_rng(3).standard_normal
    values = [v.full() for v in compare(draw(3), quaternion, draw(3), draw(4), draw(3), draw(4))]
    assert_allclose(values[0], values[1], rtol=0, atol=1e-12)
    assert_allclose(values[2], values[3], rtol=1e-13, atol=0)


@QUATERNIONS
def test_derivatives_of_a_body_vs_ad(quaternion: np.ndarray) -> None:
    """Of minus the generalised forces with rotation and position, their rates and their accelerations.

    What a dead force at the centre of mass and a dead moment would have as derivative is not of the inertia.
    """
    u, du, ddu = (ca.MX.sym(name, 7) for name in ("u", "du", "ddu"))
    body = body_in(u[4:], u[:4], (du[4:], du[:4], ddu[4:], ddu[:4]))
    T = turn_matrix(u[:4])

    def pulled(force: ca.MX, moment: ca.MX) -> ca.MX:
        return -ca.vertcat(T.T @ (moment + ca.cross(body.arm, force)), force)

    force, moment = ca.MX.sym("force", 3), ca.MX.sym("moment", 3)
    dead = ca.substitute([ca.jacobian(pulled(force, moment), u)], [force, moment], [body.force, body.moment])[0]
    forces = pulled(body.force, body.moment)
    shifts = [ca.MX.eye(3), ca.MX(3, 3), ca.MX(3, 3)]
    orders = QuaternionMotion(u[:4], du[:4], ddu[:4]).turn.orders
    written = body.matrices.along(Jet(*map(ca.diagcat, orders, shifts)))
    found = [written.stiffness + dead, written.damping, written.mass]
    expected = [ca.jacobian(forces, symbol) for symbol in (u, du, ddu)]
    draw = np.random.default_rng(3).standard_normal
    at = [np.concatenate([quaternion, draw(3)]), draw(7), draw(7)]
    values = [v.full() for v in ca.Function("compare", [u, du, ddu], [*found, *expected])(*at)]
    for own, by_ad in zip(values[:3], values[3:], strict=True):
        assert_allclose(own, by_ad, rtol=0, atol=1e-12)
    assert_allclose(values[2], values[2].T, rtol=0, atol=1e-14)


# Spinning bodies


def body_turning_at(inertia: np.ndarray, mass: float, centre: np.ndarray) -> ca.Function:
    """(R, ω, ω̇) ↦ force and moment about the origin, which stands still, of the inertia of a body, world axes."""
    R, omega, alpha = ca.MX.sym("R", 3, 3), ca.MX.sym("omega", 3), ca.MX.sym("alpha", 3)
    motion = FrameMotion(ca.DM(3, 1), omega, ca.DM(3, 1), alpha)
    body = BodyInertia(mass, centre, inertia, R, motion)
    return ca.Function("body", [R, omega, alpha], [body.force, body.moment + ca.cross(body.arm, body.force)])


def test_free_body_obeys_eulers_equations() -> None:
    """J Ω̇ = J Ω × Ω in the axes of the body, and L = R J Ω stays."""
    principal = np.diag([3e-2, 5e-2, 4e-2])
    inertia = body_turning_at(principal, MASS, np.zeros(3))
    R = Rotation.from_rotvec([0.3, -1.2, 0.7]).as_matrix()
    omega = np.array([0.8, -2.0, 1.1])
    own = R.T @ omega
    alpha = R @ np.linalg.solve(principal, np.cross(principal @ own, own))
    _, moment = (m.full().ravel() for m in inertia(R, omega, alpha))
    assert_allclose(moment, 0.0, rtol=0, atol=1e-14)


def test_steady_precession_of_a_heavy_top() -> None:
    """A symmetric top at 60°: the spin that makes its precession steady, m g h = (C s − (A − C) p cos θ) p, Goldstein.

    A about the pivot across the axis, C along it, p the precession, s the spin along the axis.
    """
    across, along, mass, height, gravity, angle, precession = 3e-2, 5e-2, 0.3, 0.2, 9.81, np.pi / 3, 4.0
    about_pivot = across + mass * height**2
    spin = (mass * gravity * height / precession + (about_pivot - along) * precession * np.cos(angle)) / along
    axis = np.array([np.sin(angle), 0.0, np.cos(angle)])
    up = np.array([0.0, 0.0, 1.0])
    omega = precession * up + spin * axis
    alpha = np.cross(precession * up, spin * axis)
    inertia = body_turning_at(np.diag([across, across, along]), mass, np.array([0.0, 0.0, height]))
    R = Rotation.from_euler("y", angle).as_matrix()
    _, moment = (m.full().ravel() for m in inertia(R, omega, alpha))
    weight = np.cross(height * axis, [0.0, 0.0, -mass * gravity])
    assert_allclose(moment + weight, 0.0, rtol=0, atol=1e-13)


@pytest.mark.slow
def test_heavy_top_of_the_literature() -> None:
    """Brüls, Cardona and Arnold 2012: a fast top on a spherical joint, its centre of mass after 2 s and some 48 turns.

    Its inertia is about the centre of mass. The other route integrates Euler's equations in the axes of the body.
    """
    mass, gravity, centre = 15.0, 9.81, np.array([0.0, 1.0, 0.0])
    J = np.diag([0.234375, 0.46875, 0.234375])
    inertia = body_turning_at(J, mass, centre)
    alpha = ca.MX.sym("alpha", 3)
    R, omega = ca.MX.sym("R", 3, 3), ca.MX.sym("omega", 3)
    _, moment = inertia(R, omega, alpha)
    weight = ca.cross(R @ ca.DM(centre), ca.DM([0.0, 0.0, -mass * gravity]))
    by_alpha, rest = ca.substitute([ca.jacobian(moment, alpha), moment], [alpha], [ca.MX.zeros(3, 1)])
    balance = rest + weight
    turning = ca.Function("turning", [R, omega], [-ca.solve(by_alpha, balance)])

    def rate(_: float, y: np.ndarray) -> np.ndarray:
        world_R_body, spin = y[:9].reshape(3, 3), y[9:]
        return np.concatenate([(hat(spin) @ world_R_body).ravel(), turning(world_R_body, spin).full().ravel()])

    def euler(_: float, y: np.ndarray) -> np.ndarray:
        world_R_body, spin = y[:9].reshape(3, 3), y[9:]
        about_pivot = J + mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
        torque = np.cross(centre, world_R_body.T @ [0.0, 0.0, -mass * gravity])
        spin_rate = np.linalg.solve(about_pivot, torque - np.cross(spin, about_pivot @ spin))
        return np.concatenate([(world_R_body @ hat(spin)).ravel(), spin_rate])

    start = np.concatenate([np.eye(3).ravel(), [0.0, 150.0, -4.61538]])
    settings = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-12}
    ends = []
    for route in (rate, euler):
        solution = solve_ivp(route, (0.0, 2.0), start, **settings)
        ends.append(solution.y[:9, -1].reshape(3, 3) @ centre)
    assert_allclose(ends[0], ends[1], rtol=0, atol=1e-7)
    assert_allclose(ends[0], [-0.15041682, -0.72416559, -0.67302227], rtol=0, atol=1e-7)


def test_a_body_without_mass_keeps_its_inertia() -> None:
    massless = {"name": "plate", "inertia": [1e-3, 2e-3, 2e-3]}
    tables = scene(rod(linear_density=1e-9, rotary_inertia=None), loads=[], bodies=[massless], joints=[joint("a")])
    del tables["rods"][0]["rotary_inertia"]
    model = build(scene_from_dict(tables))
    state = drawn_state(model)
    spinning = float(model.energies(*state.velocities)[0])
    assert spinning > 1e-5
