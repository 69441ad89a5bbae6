"""Eigenvalues of M z̈ + C ż + K z = 0 against closed forms and scipy."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
from numpy.testing import assert_allclose

from cosserat_casadi.motion.eigenproblem import eigenpairs
from cosserat_casadi.motion.small_motions import SmallMotions


def chain(size):
    """Masses 1 between springs 1, both ends free: ω = 2 sin(jπ / 2n), j = 0 … n − 1."""
    stiffness = 2.0 * np.eye(size) - np.eye(size, k=1) - np.eye(size, k=-1)
    stiffness[0, 0] = stiffness[-1, -1] = 1.0
    frequencies = 2.0 * np.sin(np.pi * np.arange(size) / (2 * size))
    return stiffness, frequencies


def random_orthogonal(size, seed=0):
    generator = np.random.default_rng(seed)
    orthogonal, _ = np.linalg.qr(generator.normal(size=(size, size)))
    return orthogonal


def residuals(pairs, stiffness, damping, mass):
    worst = 0.0
    for value, vector in zip(pairs.values, pairs.vectors.T, strict=True):
        row = (value**2 * mass + value * damping + stiffness) @ vector
        scale = np.linalg.norm(value**2 * mass @ vector) + np.linalg.norm(stiffness @ vector) + np.linalg.norm(vector)
        worst = max(worst, np.linalg.norm(row) / scale)
    return worst


@pytest.mark.parametrize("damped", [False, True])
def test_chain_without_a_clamp_has_one_rigid_motion(damped):
    stiffness, frequencies = chain(7)
    # Damping proportional to the stiffness: ζ = β ω / 2.
    damping = 0.1 * damped * stiffness
    pairs = eigenpairs(stiffness, damping, np.eye(7), conservative=True)
    assert pairs.values[0] == 0.0
    assert np.count_nonzero(pairs.values) == 6
    assert_allclose(np.abs(pairs.values), frequencies, rtol=1e-12, atol=0)
    assert_allclose(-pairs.values.real, 0.05 * damped * frequencies**2, rtol=1e-12, atol=1e-14)
    assert residuals(pairs, stiffness, damping, np.eye(7)) < 1e-12


@pytest.mark.parametrize("damped", [False, True])
def test_directions_without_mass_drop_out(damped):
    # Massless coordinates are mixed with the others by a rotation: M has the rank 5 of 9.
    stiffness, _ = chain(9)
    stiffness += np.eye(9)
    turn = random_orthogonal(9)
    masses = np.diag([1.0, 2.0, 3.0, 4.0, 5.0, 0.0, 0.0, 0.0, 0.0])
    mass = turn @ masses @ turn.T
    damping = np.zeros((9, 9))
    if damped:
        # Only where there is mass: 10 eigenvalues are finite.
        damping = turn @ (0.1 * masses) @ turn.T
    pairs = eigenpairs(stiffness, damping, mass, conservative=True)
    assert len(pairs.values) == 5
    inverse = scipy.linalg.eigh(mass, stiffness, eigvals_only=True)[::-1][:5]
    assert_allclose(np.abs(pairs.values), 1 / np.sqrt(inverse), rtol=1e-10, atol=0)


def test_massless_damped_direction_has_one_real_eigenvalue():
    # c ż + k z = 0 beside an oscillator: λ = −k/c.
    mass = np.diag([1.0, 0.0])
    damping = np.diag([0.2, 0.5])
    stiffness = np.diag([4.0, 3.0])
    pairs = eigenpairs(stiffness, damping, mass, conservative=True)
    expected = [complex(-0.1, np.sqrt(4 - 0.01)), -6.0]
    assert_allclose(pairs.values, expected, rtol=1e-13, atol=1e-13)


def test_overdamped_oscillator_has_two_entries():
    pairs = eigenpairs(np.array([[1.0]]), np.array([[2.5]]), np.array([[1.0]]), conservative=True)
    assert_allclose(pairs.values, [-0.5, -2.0], rtol=1e-14, atol=0)


def test_multiplicities_are_repeated_with_independent_vectors():
    orthogonal = random_orthogonal(8)
    stiffness = orthogonal @ np.diag([1.0, 1.0, 4.0, 4.0, 4.0, 9.0, 16.0, 16.0]) @ orthogonal.T
    for damping in (np.zeros((8, 8)), 0.02 * stiffness):
        pairs = eigenpairs(stiffness, damping, np.eye(8), conservative=True)
        assert_allclose(np.abs(pairs.values), [1, 1, 2, 2, 2, 3, 4, 4], rtol=1e-12, atol=0)
        assert np.linalg.matrix_rank(pairs.vectors, tol=1e-6 * np.linalg.norm(pairs.vectors)) == 8


@pytest.mark.parametrize("damped", [False, True])
def test_indefinite_stiffness_gives_a_real_pair(damped):
    stiffness = np.diag([-4.0, 1.0, 9.0])
    damping = 0.1 * damped * np.diag([1.0, 0.0, 0.0])
    pairs = eigenpairs(stiffness, damping, np.eye(3), conservative=True)
    growing = -0.05 * damped + np.sqrt(4 + 0.0025 * damped)
    decaying = -0.05 * damped - np.sqrt(4 + 0.0025 * damped)
    found = sorted(pairs.values[np.abs(pairs.values.imag) < 1e-12].real)
    assert_allclose(found, [decaying, growing], rtol=1e-13, atol=0)
    assert len(pairs.values) == 4


def ziegler(thrust, retardation=0.0):
    """Ziegler's double pendulum, masses 2m and m: flutter from P = (7/2 − √2) c/l on; H. Ziegler 1952."""
    mass = np.array([[3.0, 1.0], [1.0, 1.0]])
    stiffness = np.array([[2.0 - thrust, thrust - 1.0], [-1.0, 1.0]])
    damping = retardation * np.array([[2.0, -1.0], [-1.0, 1.0]])
    return stiffness, damping, mass


def test_follower_force_makes_flutter():
    critical = 3.5 - np.sqrt(2.0)
    below = eigenpairs(*ziegler(critical - 1e-3), conservative=False)
    assert_allclose(below.values.real, 0.0, rtol=0, atol=0)
    assert len(below.values) == 2
    above = eigenpairs(*ziegler(critical + 1e-3), conservative=False)
    assert len(above.values) == 2
    assert above.values[0].real > 1e-3
    assert_allclose(above.values[1], -above.values[0].conj(), rtol=1e-10, atol=0)
    # λ⁴ · 2 + (7 − 2P) λ² + 1 = 0.
    thrust = critical + 1e-3
    squares = np.roots([2.0, 7.0 - 2.0 * thrust, 1.0])
    assert_allclose(sorted(above.values**2, key=np.imag), sorted(squares, key=np.imag), rtol=1e-10, atol=0)


def test_damping_lowers_the_flutter_load():
    # Herrmann and Jong 1965: with equal small damping in both hinges the load is 41/28 c/l.
    critical = 41.0 / 28.0
    assert eigenpairs(*ziegler(critical - 1e-2, 1e-3), conservative=False).values.real.max() < 0.0
    assert eigenpairs(*ziegler(critical + 1e-2, 1e-3), conservative=False).values.real.max() > 0.0


def test_damped_eigenvalues_are_those_of_the_companion_pencil():
    generator = np.random.default_rng(1)
    root = generator.normal(size=(6, 6))
    stiffness = root @ root.T + generator.normal(size=(6, 6))
    damping = 0.3 * generator.normal(size=(6, 6))
    mass = np.diag(generator.uniform(0.5, 2.0, 6))
    pairs = eigenpairs(stiffness, damping, mass, conservative=False)
    zero = np.zeros((6, 6))
    first = np.block([[zero, np.eye(6)], [-stiffness, -damping]])
    second = np.block([[np.eye(6), zero], [zero, mass]])
    expected = scipy.linalg.eigvals(first, second)
    expected = expected[expected.imag >= 0.0]
    expected = expected[np.argsort(np.abs(expected))]
    assert_allclose(np.abs(pairs.values), np.abs(expected), rtol=1e-10, atol=0)
    assert residuals(pairs, stiffness, damping, mass) < 1e-11


def test_no_mass_is_refused():
    with pytest.raises(ValueError, match="mass"):
        eigenpairs(np.eye(2), np.zeros((2, 2)), np.zeros((2, 2)), conservative=True)


def constrained(gradients, own):
    """A chain of 5 on springs to the ground whose coordinates obey G q + A μ = 0, in rods of other energy units."""
    stiffness, _ = chain(5)
    stiffness += np.eye(5)
    held = len(own)
    units = np.array([1.0, 1.0, 1e-4, 1e-4, 1e-4])
    full = np.zeros((5 + held, 5 + held))
    # The rows of a scene are without unit: times their unit they are energies, and symmetric.
    full[:5, :5] = stiffness / units[:, None]
    full[:5, 5:] = -gradients.T / units[:, None]
    full[5:, :5] = gradients
    full[5:, 5:] = np.diag(own)
    mass = np.zeros_like(full)
    mass[:5, :5] = np.eye(5) / units[:, None]
    differential = np.arange(5 + held) < 5
    norms = np.zeros((0, 5 + held))
    all_units = np.concatenate([units, np.ones(held)])
    return stiffness, SmallMotions(full, np.zeros_like(full), mass, all_units, differential, norms)


def frequencies_of(motions):
    damping = np.zeros_like(motions.free_mass)
    pairs = eigenpairs(motions.free_stiffness, damping, motions.free_mass, conservative=True)
    return np.abs(pairs.values)


def test_constraints_are_kept_repeated_ones_once():
    gradients = np.array([[1.0, -1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0, -1.0], [1.0, -1.0, 0.0, 0.0, 0.0]])
    stiffness, motions = constrained(gradients, np.zeros(3))
    basis = scipy.linalg.null_space(gradients)
    expected = scipy.linalg.eigvalsh(basis.T @ stiffness @ basis)
    assert_allclose(frequencies_of(motions), np.sqrt(expected), rtol=1e-12, atol=0)


@pytest.mark.parametrize("compliance", [0.3, 1e-30])
def test_a_cable_that_yields_is_a_spring_and_one_that_does_not_a_constraint(compliance):
    gradient = np.array([[1.0, 0.5, -2.0, 0.0, 1.0]])
    stiffness, motions = constrained(gradient, np.array([compliance]))
    if compliance > 1e-10:
        expected = scipy.linalg.eigvalsh(stiffness + gradient.T @ gradient / compliance)
    else:
        basis = scipy.linalg.null_space(gradient)
        expected = scipy.linalg.eigvalsh(basis.T @ stiffness @ basis)
    assert_allclose(frequencies_of(motions), np.sqrt(expected), rtol=1e-10, atol=0)


def test_displacements_obey_the_constraints():
    gradients = np.array([[1.0, -1.0, 2.0, 0.0, 0.0]])
    _, motions = constrained(gradients, np.zeros(1))
    unknowns = motions.displacement(np.eye(4))
    assert unknowns.shape == (6, 4)
    assert_allclose(gradients @ unknowns[:5], np.zeros((1, 4)), rtol=0, atol=1e-12)
    assert_allclose(unknowns[5], np.zeros(4), rtol=0, atol=0)


def test_what_moves_nothing_is_left_out():
    stiffness, motions = constrained(np.zeros((0, 5)), np.zeros(0))
    direction = np.array([[1.0, 2.0, 0.0, -1.0, 0.5]])
    basis = scipy.linalg.null_space(direction)
    expected = scipy.linalg.eigvalsh(basis.T @ stiffness @ basis)
    assert_allclose(frequencies_of(replace(motions, held=direction)), np.sqrt(expected), rtol=1e-12, atol=0)
