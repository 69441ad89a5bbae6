"""Catalogue (l): zero strain, tip turns of exactly π and 2π, zero load: first and second derivatives.

Against the exponential of SE(3), differentiated by complex steps: a rod of constant strain is a screw.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import expm

from cosserat_casadi import Model
from tests.catalogue import cases
from tests.catalogue.checks import fine_model

TURNS = {
    "straight": [0.0, 0.0, 0.0],
    "half turn about x": [np.pi, 0.0, 0.0],
    "half turn about y": [0.0, np.pi, 0.0],
    "half turn about z": [0.0, 0.0, np.pi],
    "half turn about a diagonal": np.pi * np.array([2.0, 1.0, 2.0]) / 3,
    "full turn about y": [0.0, 2 * np.pi, 0.0],
    "full turn about a diagonal": 2 * np.pi * np.array([2.0, 1.0, 2.0]) / 3,
}
STEP, SHIFT = 1e-30, 2e-3
"""Of complex steps, and of the central differences of fourth order that go on from them."""

SIZES = {"shear_x": 1.0, "shear_y": 1.0, "extension": 1.0}


@cache
def rod() -> Model:
    """A rod of constant strain whose coordinates are its strains."""
    return fine_model(cases.table(cases.round_rod(1.0, **SIZES), cases.tip()), 1, 36)


@cache
def derivatives(name: str) -> ca.Function:
    """(x, inputs) ↦ the tip or the residual with two derivatives."""
    model = rod()
    x, p = ca.MX.sym("x", model.size), ca.MX.sym("p", model.inputs.size)
    position, _, rotation = model.tip["rod"](x, p)
    value = ca.vertcat(position, ca.vec(rotation)) if name == "tip" else model.residual(x, p)
    first = ca.jacobian(value, x)
    return ca.Function("derivatives", [x, p], [value, first, ca.jacobian(ca.vec(first), x)])


def screw(strain: Any) -> Any:
    """Tip of the rod by the exponential, 12 numbers; complex strains welcome."""
    (a, b, c), tangent = strain[:3], strain[3:] + np.array([0, 0, 1])
    generator = np.zeros((4, 4), complex)
    generator[:3] = [[0, -c, b, tangent[0]], [c, 0, -a, tangent[1]], [-b, a, 0, tangent[2]]]
    pose = expm(generator)
    return np.concatenate([pose[:3, 3], pose[:3, :3].ravel(order="F")])


def screw_derivative(strain: Any) -> Any:
    """First derivatives of the screw, 12×6."""
    steps = 1j * STEP * np.eye(6)
    return np.array([screw(strain + step).imag / STEP for step in steps]).T


def differences(function: Any, at: Any) -> Any:
    """Derivative by central differences of fourth order, columns by direction."""
    columns = []
    for step in SHIFT * np.eye(len(at)):
        near = function(at + step) - function(at - step)
        far = function(at + 2 * step) - function(at - 2 * step)
        columns.append((8 * near - far).ravel(order="F") / (12 * SHIFT))
    return np.array(columns).T


@pytest.mark.parametrize("name", TURNS)
def test_tip_and_its_derivatives_vs_exponential(name: str) -> None:
    strain = np.array([*TURNS[name], 0.0, 0.0, 0.0])
    value, first, second = (part.full() for part in derivatives("tip")(strain, np.zeros(6)))
    assert_allclose(value[:, 0], screw(strain).real, rtol=0, atol=1e-12)
    assert_allclose(first, screw_derivative(strain), rtol=0, atol=1e-11)
    assert_allclose(second, differences(screw_derivative, strain), rtol=0, atol=1e-8)


@pytest.mark.parametrize("name", TURNS)
@pytest.mark.parametrize("load", [0.0, 1.0])
def test_residual_and_its_derivatives_vs_differences(name: str, load: float) -> None:
    """The Jacobian of the model, which is not made by AD, and its derivative too."""
    model = rod()
    strain, wrench = np.array([*TURNS[name], 0.0, 0.0, 0.0]), load * np.array([1.0, -2.0, 0.5, 0.3, 0.7, -0.4])
    value, first, second = (part.full() for part in derivatives("residual")(strain, wrench))
    assert np.all(np.isfinite(value))
    assert_allclose(model.jacobian(strain, wrench)[0].full(), first, rtol=0, atol=1e-12)
    assert_allclose(first, differences(lambda q: model.residual(q, wrench).full(), strain), rtol=0, atol=1e-8)
    assert_allclose(second, differences(lambda q: model.jacobian(q, wrench)[0].full(), strain), rtol=0, atol=1e-7)


def test_unloaded_straight_rod_has_no_residual() -> None:
    assert_allclose(rod().residual(np.zeros(6), np.zeros(6)).full(), 0.0, rtol=0, atol=1e-15)
