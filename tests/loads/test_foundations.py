"""Rods in elastic foundations: Hetényi's closed form, the sum of the energies of springs at the nodes, refusals."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import SceneError, build, scene_from_dict, solve
from tests.derivatives import check_jacobian
from tests.families import mostly_slow
from tests.reference.rods import rotation_from_quaternion
from tests.scenes import rod, scene

FEW = {"modes": 3, "nodes": 8}
FINE = {"modes": 10, "nodes": 24}
BENT = {"position": [0.1, -0.2, 0.3], "quaternion": [0.5, 0.5, -0.5, 0.5]}


def foundation(**changes: Any) -> dict[str, Any]:
    return {"name": "tissue", "kind": "foundation", "rod": "rod", "stiffness": [300.0, 0.0, 0.0], **changes}


def test_cantilever_in_a_foundation_vs_hetenyi() -> None:
    """EI w'''' + k w = 0 with w = w' = 0 at the base, w'' = 0 and EI w''' = −F at the tip, for small deflections."""
    force, stiffness, bending, length = 1e-5, 300.0, 1.4, 0.8
    push = {"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [force, 0.0, 0.0]}
    solution = solve(build(scene(foundation(), push, accuracy=FINE)))
    beta = (stiffness / (4 * bending)) ** 0.25
    end = beta * length
    # Of both solutions sinh·sin and cosh·sin − sinh·cos, which have w = w' = 0, the second and third derivatives.
    bent = np.array([2 * np.cosh(end) * np.cos(end), 2 * (np.cosh(end) * np.sin(end) + np.sinh(end) * np.cos(end))])
    sheared = np.array([2 * (np.sinh(end) * np.cos(end) - np.cosh(end) * np.sin(end)), 4 * np.cosh(end) * np.cos(end)])
    first, second = np.linalg.solve([bent, sheared], [0.0, -force / (bending * beta**3)])
    X = np.linspace(0.1, 1.0, 7)
    x = beta * length * X
    expected = first * np.sinh(x) * np.sin(x) + second * (np.cosh(x) * np.sin(x) - np.sinh(x) * np.cos(x))
    found = solution.pose(X).position[:, 0]
    assert np.abs(expected).max() < 1e-6
    assert_allclose(found, expected, rtol=0, atol=1e-8 * np.abs(expected).max())


CASES: dict[str, dict[str, Any]] = {
    "world": {"stiffness": [300.0, 100.0, 30.0]},
    "body": {"stiffness": [300.0, 100.0, 30.0], "frame": "body"},
    "part": {"stiffness": [300.0, 0.0, 30.0], "span": [0.4, 0.7]},
    "part, body": {"stiffness": [0.0, 20.0, 30.0], "span": [0.0, 0.7], "frame": "body"},
    "curve": {"stiffness": [300.0, 100.0, 30.0], "curve": [[0.1, 0.2], -0.3, {"powers": [0.0, 0.1, 0.2]}]},
}


def tied_to(name: str, nodes: np.ndarray, unloaded: np.ndarray) -> np.ndarray:
    if name != "curve":
        return unloaded
    return np.array([0.1 + 0.2 * (2 * nodes - 1), -0.3 + 0 * nodes, 0.1 * nodes + 0.2 * nodes**2])


def test_loads_on_the_same_sections_share_their_motion() -> None:
    """A second load on them costs no product that is a matrix of many rows and columns."""
    soil = foundation(name="soil", stiffness=[20.0, 90.0, 30.0], frame="body")
    base = {"free": True, "position": [0.1, -0.2, 0.3]}
    products = []
    for loads in ([foundation()], [foundation(), soil]):
        tables = {"schema": 1, "rods": [rod("reissner", base=base)], "loads": loads, "accuracy": FEW}
        model = build(scene_from_dict(tables))
        check_jacobian(model, atol=1e-11)
        function = model.path_jacobian
        codes = [function.instruction_id(k) for k in range(function.n_instructions())]
        results = [function.instruction_MX(k) for k, code in enumerate(codes) if code == ca.OP_MTIMES]
        products.append(sum(min(result.shape) > 3 for result in results))
    assert products[0] == products[1]


def test_loads_on_as_many_other_sections_move_with_their_own() -> None:
    parts = [foundation(name="below", span=[0.0, 0.5]), foundation(name="above", span=[0.5, 1.0])]
    magnets = [
        {
            "kind": "magnet",
            "name": f"magnet_{at}",
            "rod": "rod",
            "at": at / 2,
            "moment": [1.0, 2.0, 0.3],
            "field": [0.3, 0.2, -0.1],
        }
        for at in (1, 2)
    ]
    rods = [rod(base={"free": True, "position": [0.1, -0.2, 0.3]})]
    tables = {"schema": 1, "rods": rods, "loads": [*parts, *magnets], "accuracy": FEW}
    check_jacobian(build(scene_from_dict(tables)), atol=1e-11)


@pytest.mark.parametrize("strain", mostly_slow(["kirchhoff", "reissner"], quick=["reissner"]))
@pytest.mark.parametrize("name", CASES)
def test_residual_vs_gradient_of_the_energy(name: str, strain: str) -> None:
    """½ Σ k_i d_i² over the nodes of the span, and a symmetric Jacobian that is its second derivative."""
    given = CASES[name]
    bent = rod(strain, base=BENT, intrinsic={"curvature": [0.5, [-0.4, 0.2], 0.3]})
    tables: dict[str, Any] = {"schema": 1, "accuracy": FEW, "rods": [bent], "loads": [foundation(**given)]}
    model = build(scene_from_dict(tables))
    discrete = model.discrete.rods["rod"]
    nodes, lengths = discrete.grid.nodes, discrete.node_lengths
    start, end = given.get("span", (0.0, 1.0))
    middles = np.repeat(nodes.reshape(discrete.grid.elements, -1).mean(axis=1), discrete.grid.intervals + 1)
    x, inputs = ca.MX.sym("x", model.size), model.pack()
    moved, *_ = model.fields["rod"](x, inputs)
    unloaded, quaternion, *_ = (field.full() for field in model.fields["rod"](np.zeros(model.size), inputs))
    anchors = tied_to(name, nodes, unloaded)
    energy = ca.MX(0.0)
    for k in np.flatnonzero((middles > start) & (middles < end)):
        apart = moved[:, k] - anchors[:, k]
        if given.get("frame") == "body":
            apart = ca.DM(rotation_from_quaternion(quaternion[:, k])).T @ apart
        energy += lengths[k] / 2 * ca.dot(ca.DM(given["stiffness"]), apart**2)
    derivatives = ca.Function("d", [x], [ca.gradient(energy, x), ca.hessian(energy, x)[0]])
    elastic = discrete.stiffness
    point = 0.3 * np.random.default_rng(0).standard_normal(model.size)
    gradient, hessian = (value.full() for value in derivatives(point))
    residual = model.residual(point, inputs).full()[:, 0] - elastic @ point
    unit = discrete.energy_unit
    assert_allclose(residual, gradient[:, 0] / unit, rtol=0, atol=1e-12 * np.abs(gradient).max() / unit)
    jacobian = model.jacobian(point, inputs)[0].full() - elastic
    assert_allclose(jacobian, hessian / unit, rtol=0, atol=1e-12 * np.abs(hessian).max() / unit)
    assert model.has_potential(inputs)


REFUSED: list[tuple[dict[str, Any], str]] = [
    ({"stiffness": [0, 0, 0]}, "stiffness: must not be zero"),
    ({"stiffness": [1, -2, 0]}, r"stiffness\[1\]: must be >= 0, got -2"),
    ({"stiffness": [1, 2]}, "stiffness: must be a list of 3 numbers"),
    ({"span": [0.6, 0.4]}, "span: must begin before it ends"),
    ({"span": [0.6, 1.4]}, r"span\[1\]: must be <= 1"),
    ({"frame": "section"}, "frame: must be one of"),
    ({"curve": [0, 0]}, "curve: must be a list of 3 components"),
]


@pytest.mark.parametrize(("changes", "told"), REFUSED)
def test_refusals(changes: dict[str, Any], told: str) -> None:
    with pytest.raises(SceneError, match=told):
        scene(foundation(**changes))
