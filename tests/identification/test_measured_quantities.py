"""Measured quantities: zero where the data are those of a solution, and exact derivatives with all unknowns."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, Solution, build, identify, solve
from cosserat_casadi.identification.case_equilibria import Equilibria
from cosserat_casadi.identification.fit_unknowns import unknown_layout
from cosserat_casadi.identification.measured_cases import read_cases
from cosserat_casadi.identification.misfit import Misfit, MisfitState
from cosserat_casadi.maths.rotation import quaternion_product, quaternion_to_matrix, rotation_vector
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.scene import scene_from_dict
from tests.derivatives import central_differences

OFFSET = np.array([3e-3, -2e-3, 1e-3])
FIBRE = (2e-3, 1e-3)

SCENE: dict[str, Any] = {
    "schema": 1,
    "accuracy": {"modes": 3, "nodes": 8},
    "rods": [
        {
            "name": "rod",
            "length": 0.2,
            "strain": "reissner",
            "material": {"youngs_modulus": 2e7, "poisson_ratio": 0.4},
            "section": {"shape": "circle", "radius": 4e-3},
            "intrinsic": {"curvature": [1.0, 0.0, 0.0]},
        }
    ],
    "loads": [{"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0.05, 0.03, -0.1]}],
    "actuators": [
        {"name": "pulled", "kind": "tendon", "rod": "rod", "tension": 1.0, "offset": [3e-3, 0.0]},
        {"name": "wound", "kind": "tendon", "rod": "rod", "length": 0.199, "offset": [0.0, 3e-3]},
    ],
    "measurements": [
        {"quantity": "position", "at": "X", "rod": "rod", "columns": ["x", "y", "z"], "offset": OFFSET.tolist()},
        {"quantity": "pose", "at": 0.6, "rod": "rod", "columns": ["px", "py", "pz", "qw", "qx", "qy", "qz"]},
        {"quantity": "tension", "actuator": "wound", "columns": ["t"]},
        {"quantity": "length", "actuator": "pulled", "columns": ["l"]},
        {"quantity": "base_wrench", "rod": "rod", "columns": ["Fx", "Fy", "Fz", "Mx", "My", "Mz"]},
        {"quantity": "strain", "rod": "rod", "at": 0.3, "fibre": list(FIBRE), "columns": ["e"]},
    ],
    "unknowns": [
        {"parameter": "rod.material.youngs_modulus"},
        {"parameter": "rod.intrinsic.curvature.x"},
        {"parameter": "rod.base.quaternion"},
        {"parameter": "rod.length"},
        {"input": "push.force.y"},
        {"input": "pulled.tension", "per_row": True},
    ],
}

TRUTH = {
    "rod.material.youngs_modulus": 2.2e7,
    "rod.intrinsic.curvature.x": 1.3,
    "rod.length": 0.203,
}

STEPS = np.array([1e2, 1e-5, 1e-6, 1e-6, 1e-6, 1e-7, 1e-6])
"""Differences of the shared unknowns: E, curvature, three of the rotation, length, force."""


def complete() -> dict[str, Any]:
    """The scene, its measurements with what all of them have; pulls of the two cables set the inputs."""
    tables = {**SCENE, "measurements": [dict(entry) for entry in SCENE["measurements"]]}
    tables["rods"] = [{**SCENE["rods"][0], "base": {"quaternion": [1.0, 0.0, 0.0, 0.0]}}]
    for entry in tables["measurements"]:
        entry |= {"file": "all.csv", "sigma": 1e-3, "inputs": {"wound.length": "wound"}}
    return tables


def measured(model: Model) -> tuple[dict[str, FloatArray], list[Solution]]:
    """What two solutions say of every quantity."""
    rows = []
    solutions = []
    turned = ca.DM([np.cos(0.05), 0.0, np.sin(0.05), 0.0]).full()[:, 0]
    for case, (length, tension) in enumerate(((0.199, 1.0), (0.196, 2.0))):
        values = {"push.force": [0.05, 0.04, -0.1], "wound.length": length, "pulled.tension": tension}
        solution = solve(model, values, parameters={**TRUTH, "rod.base.quaternion": turned}, raise_on_failure=True)
        solutions.append(solution)
        X = 0.45 + 0.1 * case
        section = solution.pose(X)
        pose = solution.pose(0.6)
        wrench = solution.base_wrench()
        # Rotated by hand, with another norm and sign of its quaternion.
        strain = solution.strain(0.3)
        fibre = strain[3:] + np.cross(strain[:3], [*FIBRE, 0.0])
        unloaded = np.array([0.0, 0.0, 1.0]) + np.cross([TRUTH["rod.intrinsic.curvature.x"], 0.0, 0.0], [*FIBRE, 0.0])
        row = [
            length,
            X,
            *(section.position + section.rotation @ OFFSET),
            *pose.position,
            *(-3.0 * pose.quaternion),
            solution.actuator("wound")["tension"],
            solution.actuator("pulled")["length"],
            *wrench.force,
            *wrench.moment,
            np.linalg.norm(fibre) / np.linalg.norm(unloaded) - 1.0,
        ]
        rows.append(row)
    names = ["wound", "X", "x", "y", "z", "px", "py", "pz", "qw", "qx", "qy", "qz", "t", "l"]
    names += ["Fx", "Fy", "Fz", "Mx", "My", "Mz", "e"]
    return dict(zip(names, np.array(rows).T, strict=True)), solutions


@pytest.fixture(scope="module")
def model() -> Model:
    return build(scene_from_dict(complete()).with_unknowns())


@pytest.fixture(scope="module")
def columns(model: Model) -> dict[str, FloatArray]:
    return measured(model)[0]


def state_at(misfit: Misfit, shared: FloatArray, own: FloatArray) -> MisfitState:
    """The state by the load path alone."""
    inputs = misfit.layout.inputs(shared, own, misfit.measured_inputs)
    point, _ = misfit.equilibria.loaded(inputs, misfit.layout.parameters(shared))
    return misfit.first(point, shared, own)


def test_all_unknowns_are_found_from_all_quantities(model: Model, columns: dict[str, FloatArray]) -> None:
    found = identify(model, {"all.csv": columns})
    assert found.converged, found.message
    rms = found.rms()
    assert rms is not None
    assert rms < 1e-6
    for name, value in TRUTH.items():
        assert_allclose(found.value(name), value, rtol=1e-6, atol=0)
    assert_allclose(found.value("rod.base.quaternion"), [np.cos(0.05), 0, np.sin(0.05), 0], rtol=0, atol=1e-7)
    assert_allclose(found.value("push.force.y"), 0.04, rtol=1e-6, atol=0)
    assert_allclose(found.own[:, 0], [1.0, 2.0], rtol=1e-6, atol=0)


def test_derivatives_are_those_of_differences(model: Model, columns: dict[str, FloatArray]) -> None:
    """Away from the optimum, so that rotations differ."""
    layout = unknown_layout(model)
    cases = read_cases(model.scene, model.inputs, {"all.csv": columns})
    misfit = Misfit(model, layout, cases, Equilibria(model, len(cases)))
    shared, own = layout.start(len(cases))
    shared = shared + np.array([1e6, 0.2, 0.1, -0.2, 0.3, 1e-3, 0.01])
    own = own + np.array([[0.1], [0.3]])
    state = state_at(misfit, shared, own)
    by_shared, by_own = np.hsplit(misfit.jacobian(state), [len(shared)])
    differences = central_differences(lambda shared: state_at(misfit, shared, own).residual, shared, STEPS)
    for column, expected in zip(by_shared.T, differences.T, strict=True):
        assert_allclose(column, expected, rtol=0, atol=2e-6 * np.abs(expected).max())
    for case in range(2):
        change = np.zeros_like(own)
        change[case] = 1e-5
        ahead = state_at(misfit, shared, own + change).residual
        behind = state_at(misfit, shared, own - change).residual
        expected = (ahead - behind) / 2e-5
        rows = misfit.row_cases == case
        assert_allclose(by_own[rows, 0], expected[rows], rtol=0, atol=2e-6 * np.abs(expected).max())
        assert_allclose(expected[~rows], 0.0, rtol=0, atol=0)


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-3, 0.0631, 0.0633, 1.0, 3.0, np.pi])
def test_rotation_vectors_turn_by_their_angle(angle: float) -> None:
    axis = np.array([2.0, -1.0, 2.0]) / 3
    quaternion = np.array([np.cos(angle / 2), *(np.sin(angle / 2) * axis)])
    q = ca.MX.sym("q", 4)
    vector = ca.Function("vector", [q], [rotation_vector(q), ca.jacobian(rotation_vector(q), q)])
    value, derivative = (output.full() for output in vector(quaternion))
    assert_allclose(value[:, 0], angle * axis, rtol=1e-14, atol=1e-300)
    assert np.all(np.isfinite(derivative))
    if angle == np.pi:
        return
    other, _ = (output.full() for output in vector(-quaternion))
    assert_allclose(other, value, rtol=0, atol=1e-15)
    # A further turn about the same axis adds its angle.
    further = 1e-6 * np.array([0.0, *(axis / 2)])
    rate = quaternion_product(further, quaternion)
    assert_allclose(derivative @ rate, 1e-6 * axis, rtol=1e-9, atol=0)
    matrix = quaternion_to_matrix(quaternion)
    assert_allclose(matrix @ axis, axis, rtol=0, atol=1e-15)
