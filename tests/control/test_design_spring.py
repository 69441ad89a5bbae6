"""The example that designs a spring: exact gradients, one branch, an optimum that solves of their own confirm."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from examples.design_spring import (
    FORCE,
    LEANING,
    START,
    TOP,
    UNITS,
    Stroke,
    by_name,
    compiled_spring,
    designed,
    equilibria_of,
    forces_of,
    largest_strain,
    spring,
    stacked,
    unloaded_shape,
)
from tests.derivatives import central_differences


@pytest.fixture(scope="module")
def stroke() -> Stroke:
    model = spring()
    return Stroke(model, compiled_spring(model))


@pytest.mark.slow
def test_gradients_vs_differences(stroke: Stroke) -> None:
    """Of forces that are followed to equilibrium at each of the designs."""
    design = stacked(START)
    exact = stroke.curve(design, 3)
    differences = central_differences(lambda moved: stroke.curve(moved, 3).force, design, 1e-4)
    assert_allclose(exact.by_design, differences, rtol=1e-6, atol=1e-6)


def test_forces_are_the_rate_of_the_energy(stroke: Stroke) -> None:
    """The pin's work is the growth of the strip's energy: the integral of the force by Gauss's rule."""
    model = stroke.model
    nodes, weights = np.polynomial.legendre.leggauss(4)
    way = 0.01
    places = TOP - way * (nodes + 1) / 2
    forces = []
    for height in places:
        p = np.append(UNITS * stacked(START), height)
        x = stroke.compiled.solve(parameters=p).x
        forces.append(float(model.fields["strip"].call({"x": x, "p": p})["base_force"][2]))
    energies = []
    for height in (TOP, TOP - way):
        p = np.append(UNITS * stacked(START), height)
        energies.append(float(model.energy(stroke.compiled.solve(parameters=p).x, [], p)))
    assert_allclose(way / 2 * weights @ forces, energies[1] - energies[0], rtol=1e-7, atol=0)


def test_the_unloaded_arc_vs_closed_form() -> None:
    radius, angle = 0.1, 2.0
    end = radius * np.array([np.cos(LEANING) - np.cos(angle - LEANING), np.sin(angle - LEANING) + np.sin(LEANING)])
    assert_allclose(unloaded_shape(START)[-1], end, rtol=0, atol=1e-6)


@pytest.mark.slow
def test_the_optimum_is_confirmed_by_solves(stroke: Stroke) -> None:
    design = designed(stroke)
    equilibria = equilibria_of(design, 5)
    assert all(solution.stable is True for solution in equilibria)
    forces = forces_of(equilibria)
    assert_allclose(forces, FORCE, rtol=0.015, atol=0)
    assert_allclose(stroke.curve(stacked(design), 5).force, forces, rtol=2e-3, atol=0)
    assert 0.003 < largest_strain(design, equilibria) < 0.007


def test_followed_forces_stay_on_the_branch_of_the_start(stroke: Stroke) -> None:
    """A strip that is bent far and back again: the load path from the unloaded one ends on another branch."""
    design = np.array([-15.0, -11.0, 20.0, -14.0, 0.37e-3, 0.25]) / UNITS
    for share in np.linspace(0.0, 1.0, 11):
        followed = stroke.curve((1 - share) * stacked(START) + share * design, 2).force[0]
    alone = equilibria_of(by_name(design), 1)[0]
    assert alone.stable
    assert abs(forces_of([alone])[0]) > 2 * abs(followed)
