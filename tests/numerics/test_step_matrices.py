"""The linear systems of a step against those of all stages at once, and of the equations as a system of first order."""

from __future__ import annotations

import numpy as np
import pytest
from moving import PENDULUM, pendulum_state
from numpy.testing import assert_allclose

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.collocation import Collocation, gauss, radau
from cosserat_casadi.numerics.motion_equations import Instant, Linearisation
from cosserat_casadi.numerics.step_matrices import Deviation, step_matrices

METHODS = [radau(1), radau(2), radau(3), gauss(1), gauss(2), gauss(3)]
STEP = 0.3
ALL_MOVE = np.ones(3, dtype=bool)


def damped() -> Linearisation:
    """Full matrices without symmetry."""
    random = np.random.default_rng(3)
    stiffness, damping, mass = random.normal(size=(3, 3, 3))
    return Linearisation(stiffness, damping, mass + 3 * np.eye(3))


def constrained() -> Linearisation:
    """The pendulum with its multiplier."""
    x, v = pendulum_state(1.2, 0.4)
    return PENDULUM.linearised(Instant(0.0, x, v, np.zeros(3)))


@pytest.mark.parametrize("method", METHODS, ids=lambda method: method.name)
@pytest.mark.parametrize("linearisation", [damped(), constrained()], ids=["damped", "constrained"])
def test_corrections_solve_the_system_of_all_stages(linearisation: Linearisation, method: Collocation) -> None:
    differential = np.any(linearisation.mass, axis=0)
    matrices = step_matrices(method, STEP, linearisation, differential)
    assert matrices is not None
    residuals = np.cos(np.arange(3.0 * method.stages)).reshape(method.stages, 3)
    corrections = matrices.corrections(residuals)

    accelerations = np.where(differential, corrections / STEP**2, 0.0)
    velocities = STEP * method.matrix @ accelerations
    positions = np.where(differential, STEP**2 * method.matrix @ method.matrix @ accelerations, corrections)
    change = positions @ linearisation.stiffness.T
    change = change + velocities @ linearisation.damping.T + accelerations @ linearisation.mass.T
    assert_allclose(change, -residuals, rtol=0, atol=1e-12)


def test_eliminated_entries_leave_the_inverses_what_they_are() -> None:
    whole = step_matrices(radau(3), STEP, damped(), ALL_MOVE)
    condensed = step_matrices(radau(3), STEP, damped(), ALL_MOVE, [1])
    assert whole is not None
    assert condensed is not None
    for inverse, expected in zip(condensed.inverses, whole.inverses, strict=True):
        assert_allclose(inverse, expected, rtol=0, atol=1e-13)


@pytest.mark.parametrize("method", METHODS, ids=lambda method: method.name)
def test_filter_is_that_of_the_system_of_first_order(method: Collocation) -> None:
    linearisation = damped()
    matrices = step_matrices(method, STEP, linearisation, ALL_MOVE)
    assert matrices is not None
    deviation = Deviation(np.array([0.3, -0.2, 0.5]), np.array([1.0, 0.4, -0.7]))
    filtered = matrices.filtered(deviation)

    inverse_mass = np.linalg.inv(linearisation.mass)
    lower = np.hstack([-inverse_mass @ linearisation.stiffness, -inverse_mass @ linearisation.damping])
    jacobian = np.vstack([np.hstack([np.zeros((3, 3)), np.eye(3)]), lower])
    shifted = np.eye(6) - STEP * method.eigenvalues[0] * jacobian
    exact = np.linalg.solve(shifted, np.concatenate([deviation.position, deviation.velocity])).real
    assert_allclose(np.concatenate([filtered.position, filtered.velocity]), exact, rtol=0, atol=1e-13)


def test_filter_keeps_to_the_constraint() -> None:
    linearisation = constrained()
    matrices = step_matrices(radau(3), STEP, linearisation, np.array([True, True, False]))
    assert matrices is not None
    filtered = matrices.filtered(Deviation(np.array([0.3, -0.2, 0.0]), np.array([1.0, 0.4, 0.0])))
    assert_allclose(linearisation.stiffness[2] @ filtered.position, 0.0, rtol=0, atol=1e-15)


@pytest.mark.parametrize("step", [1e-2, 1e-5, 1e-8])
def test_short_steps_do_not_spoil_the_condition(step: float) -> None:
    # Without scaling the condition goes like h⁻⁴: at 1e-5 nothing would be left.
    linearisation = constrained()
    matrices = step_matrices(radau(3), step, linearisation, np.array([True, True, False]))
    assert matrices is not None
    residual = np.array([0.4, -0.2, 0.0])
    corrections = matrices.corrections(np.tile(residual, (3, 1)))

    def at_rest(matrix: FloatArray) -> FloatArray:
        return np.asarray(np.linalg.solve(matrix, -residual))

    # A constant force: for h → 0 the acceleration and the multiplier of M a + Gᵀ λ = −r, G a = 0.
    limit = at_rest(linearisation.mass + np.where([[0, 0, 1], [0, 0, 1], [1, 1, 0]], linearisation.stiffness, 0.0))
    scaled = corrections / np.array([step**2, step**2, 1.0])
    assert_allclose(scaled, np.tile(limit, (3, 1)), rtol=0, atol=1e-11 + step**2)


def test_constraint_given_twice_is_singular() -> None:
    stiffness = np.array([[0.0, 1.0, 1.0], [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    linearisation = Linearisation(stiffness, np.zeros((3, 3)), np.diag([1.0, 0.0, 0.0]))
    assert step_matrices(radau(3), 0.1, linearisation, np.array([True, False, False])) is None
    nowhere = Linearisation(np.zeros((3, 3)), np.zeros((3, 3)), np.diag([1.0, 1.0, 0.0]))
    assert step_matrices(radau(3), 0.1, nowhere, ALL_MOVE) is None
