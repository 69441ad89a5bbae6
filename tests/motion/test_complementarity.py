"""Which one-sided constraints push: against all choices, and where constraints depend on each other."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.contact_law import least_pushes


def by_all_choices(compliance: FloatArray, rates: FloatArray) -> FloatArray:
    """The one choice of active constraints that neither pull nor let another close."""
    count = len(rates)
    for size in range(count + 1):
        for chosen in combinations(range(count), size):
            own = list(chosen)
            forces = np.zeros(count)
            forces[own] = np.linalg.solve(compliance[np.ix_(own, own)], -rates[own])
            opening = rates + compliance @ forces
            if forces.min() >= 0.0 and np.delete(opening, own).min(initial=0.0) >= 0.0:
                return forces
    raise AssertionError("a positive definite problem has a solution")


def test_pushes_are_those_of_the_one_choice_that_holds() -> None:
    rng = np.random.default_rng(5)
    sizes = []
    for _ in range(100):
        factor = rng.normal(size=(5, 5)) * 10.0 ** rng.uniform(-2, 2, size=(5, 1))
        compliance = factor @ factor.T
        rates = rng.normal(size=5)
        forces = least_pushes(compliance, rates, 0.0)
        assert forces is not None
        assert_allclose(forces, by_all_choices(compliance, rates), rtol=1e-6, atol=0)
        sizes.append(int(np.sum(forces > 0.0)))
    assert {1, 2, 3} <= set(sizes)


def test_units_of_forces_change_none_of_them() -> None:
    """Contacts on rods of other stiffness have forces in other units: W keeps no symmetry, its columns are scaled."""
    rng = np.random.default_rng(6)
    sizes = []
    for _ in range(100):
        factor = rng.normal(size=(5, 5))
        compliance = factor @ factor.T
        units = 10.0 ** rng.uniform(-3, 3, size=5)
        rates = rng.normal(size=5)
        forces = least_pushes(compliance * units, rates, 0.0)
        assert forces is not None
        assert_allclose(forces * units, by_all_choices(compliance, rates), rtol=1e-6, atol=0)
        sizes.append(int(np.sum(forces > 0.0)))
    assert {1, 2, 3} <= set(sizes)


@pytest.mark.parametrize("count", [12, 40])
def test_more_constraints_than_there_are_motions_to_stop_settle_without_pulling(count: int) -> None:
    rng = np.random.default_rng(count)
    for _ in range(20):
        directions = rng.normal(size=(count, 6))
        compliance = directions @ directions.T
        rates = directions @ rng.normal(size=6)
        forces = least_pushes(compliance, rates, 1e-10)
        assert forces is not None
        opening = rates + compliance @ forces
        assert forces.min() >= 0.0
        assert np.sum(forces > 0.0) <= 6
        assert opening.min() >= -1e-7
        assert_allclose(opening * forces, 0.0, rtol=0, atol=1e-7)


@pytest.mark.parametrize("count", [12, 40])
def test_of_constraints_that_depend_on_each_other_those_push_that_keep_all_from_closing(count: int) -> None:
    """Their rates are not those of any motion: one that is added may have to take the place of another."""
    rng = np.random.default_rng(count)
    for _ in range(20):
        directions = rng.normal(size=(count, 6))
        compliance = directions @ directions.T
        room = rng.uniform(0.0, 3.0, size=count)
        rates = room + directions @ rng.normal(size=6) * 2.0
        forces = least_pushes(compliance, rates, 1e-10)
        assert forces is not None
        opening = rates + compliance @ forces
        assert forces.min() >= 0.0
        assert opening.min() >= -1e-9
        assert_allclose(opening * forces, 0.0, rtol=0, atol=1e-8)


def test_where_nothing_keeps_a_constraint_from_closing_the_others_are_kept() -> None:
    compliance = np.array([[1.0, -1.0], [-1.0, 1.0]])
    forces = least_pushes(compliance, np.array([-1.0, 0.5]), 1e-12)
    assert forces is not None
    # What the one opens by the other closes by: together they close, whatever the forces.
    assert_allclose(forces, [1.0, 0.0], rtol=1e-15, atol=0)


def test_a_constraint_twice_and_one_that_nothing_moves_take_no_force_of_their_own() -> None:
    compliance = np.array([[2.0, 2.0, 0.0], [2.0, 2.0, 0.0], [0.0, 0.0, 0.0]])
    forces = least_pushes(compliance, np.array([-1.0, -1.0, -1.0]), 1e-12)
    assert forces is not None
    assert_allclose(forces.sum(), 0.5, rtol=1e-14, atol=0)
    assert forces[2] == 0.0


def test_constraints_that_differ_by_rounding_do_not_take_each_others_places() -> None:
    """What a nearly equal constraint answers to by rounding is no force that falls."""
    directions = np.array([
        [-1.0, 1.0],
        [1.0, 0.0],
        [0.0, -1.0],
        [1.0, 0.0],
        [-5.0000000040621939e-01, -9.3725812687249615e-10],
        [-2.5000000023719965e-01, -3.8105814752539382e-10],
        [-1.0, 0.0],
        [-5.0000000048193893e-01, -7.7999399763739520e-10],
    ])  # fmt: skip
    rates = np.array([
        1.6105465589928505, 0.02672043887700397, -1.299502360381462, 0.6181423145315648,
        -0.01336022070332409, 0.150094674025179, -0.02672043887700397, -0.01336022049494197,
    ])  # fmt: skip
    compliance = directions @ directions.T
    forces = least_pushes(compliance, rates, 1e-13)
    assert forces is not None
    assert forces.min() >= 0.0
    assert (rates + compliance @ forces).min() >= -1e-9


def test_forces_that_do_not_settle_are_none() -> None:
    """Of a compliance that rounding, or whoever gives it, has made indefinite: constraints come and go in circles."""
    compliance = np.array([[5.0, 1.0, -4.0], [1.0, 1.0, 0.0], [-4.0, 0.0, 1.0]])
    assert least_pushes(compliance, np.array([2.0, -3.0, -2.0]), 1e-12) is None
