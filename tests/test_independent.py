"""Whole scenes against independent routes: an initial-value integration, closed forms, elliptic integrals."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Scene, Solution, build, discretise, solve
from cosserat_casadi.rod.actuation import Actuation, StrainSum
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.rod.igm import InverseGeometricModel
from cosserat_casadi.rod.kinematics import shape
from cosserat_casadi.rod.properties import RodProperties
from cosserat_casadi.rod.statics import Statics
from cosserat_casadi.rod.strain import DiscreteRod
from tests.derivatives import central_differences
from tests.families import mostly_slow
from tests.pose_errors import distance_between, pose_error
from tests.reference.closed_forms import constant_strain
from tests.scenes import HOOK, WEIGHT, WIND, push, rod, scene
from tests.shooting_near import integrate

BASE = {"position": [0.1, -0.2, 0.3], "quaternion": [0.5, 0.5, -0.5, 0.5]}
TUBE = {
    "name": "rod",
    "length": 0.8,
    "strain": "reissner",
    "material": {"youngs_modulus": 2.0e6, "poisson_ratio": 0.4, "density": 1100.0},
    "section": {"shape": "annulus", "outer_radius": [0.04, 0.025], "inner_radius": [0.02, 0.01]},
}
BAR = {**TUBE, "section": {"shape": "rectangle", "width": 0.05, "height": [0.04, 0.03], "shear_correction": 0.85}}
HEAVY = {**WEIGHT, "acceleration": [1.0, -2.0, -9.81]}

SCENES: dict[str, Scene] = {
    "weight": scene(WEIGHT, rods=[rod(base=BASE)]),
    "weight, planar": scene(WEIGHT, strain="planar"),
    "push and twist, Reissner": scene(push(moment=[0.2, -0.3, 0.4]), strain="reissner"),
    "follower push": scene(push(force=[2.0, -1.0, 0.5], frame="body")),
    "follower moment": scene(push(force=[0, 0, 0], moment=[0.5, -0.8, 0.6], frame="body")),
    "hook": scene(HOOK, rods=[rod(base=BASE)]),
    "two hooks, one follower": scene(
        HOOK, {**HOOK, "name": "second", "at": 0.75, "moment": [0.1, 0.2, 0], "frame": "body"}, strain="reissner"
    ),
    "wind": scene(WIND, strain="reissner"),
    "follower wind with couples": scene({**WIND, "frame": "body", "moment": [[0.2, 0.1], 0.1, [0.0, 0.0, 0.3]]}),
    "intrinsic curvature": scene(
        push(),
        WEIGHT,
        rods=[rod(intrinsic={"curvature": [[1.0, 0.5], -2.0, [0.5, 0.0, 1.0]], "tangent": [0, 0.05, 1]})],
    ),
    "some strains only": scene(push(), WEIGHT, strain=["bending_x", "torsion", "extension"]),
    "tapered tube": scene(HEAVY, push(force=[6.0, 3.0, -2.0]), rods=[TUBE]),
    "rectangular bar": scene(HEAVY, HOOK, rods=[BAR]),
    "everything": scene(
        push(moment=[0.1, 0, 0.2]), HEAVY, HOOK, WIND, {**WIND, "name": "jet", "frame": "body"},
        rods=[rod("reissner", base=BASE, intrinsic={"curvature": [0.4, -0.6, [0.3, 0.2]]})],
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", mostly_slow(SCENES, quick=list(SCENES)[::4]))
def test_solution_vs_initial_value_integration(name: str) -> None:
    wanted = SCENES[name]
    solution = solve(build(wanted, discretise(wanted, 13, 34, "magnus8")))
    assert solution.converged
    base = solution.base_wrench()
    reached = integrate(wanted, base.force, base.moment)
    tip = solution.tip()
    assert_allclose(reached.position, tip.position, rtol=0, atol=1e-9)
    assert_allclose(reached.rotation, tip.rotation, rtol=0, atol=1e-9)
    size = 1.0 + np.abs(base.force).max() + np.abs(base.moment).max()
    assert_allclose(reached.force_left, 0.0, rtol=0, atol=1e-10 * size)
    assert_allclose(reached.moment_left, 0.0, rtol=0, atol=1e-9 * size)


@pytest.mark.parametrize("name", mostly_slow(SCENES, quick=["everything"]))
def test_error_estimate_vs_initial_value_integration(name: str) -> None:
    """Honest: at most ten times too small."""
    wanted = SCENES[name].model_copy(update={"accuracy": SCENES[name].accuracy.model_copy(update={"tolerance": 1e-5})})
    solution = solve(wanted)
    fine = solve(build(wanted, discretise(wanted, 13, 34, "magnus8")))
    tip, true = solution.tip(), fine.tip()
    length = wanted.rods[0].length
    error = pose_error((tip.position, tip.rotation), (true.position, true.rotation), length)
    assert solution.converged
    assert solution.error_estimate is not None
    assert error <= 10 * solution.error_estimate
    assert error <= 1e-5


# Closed forms; the elastica and circles are in tests/catalogue/test_catalogue.py.


def unit_rod(**changes: Any) -> dict[str, Any]:
    plain = {"name": "rod", "length": 1.0, "strain": "kirchhoff", "base": {"quaternion": [0.5, 0.5, 0.5, 0.5]}}
    return {**plain, "stiffness": {"bending_x": 1.0, "bending_y": 1.0, "torsion": 1.0}, **changes}


def solved(*loads: dict[str, Any], **changes: Any) -> Solution:
    found = solve(scene(*loads, rods=[unit_rod(**changes)], accuracy={"tolerance": 1e-10}))
    assert found.converged, found.message
    return found


def test_constant_intrinsic_strain_is_a_screw() -> None:
    """The unloaded rod of constant curvature and torsion: the exponential of SE(3)."""
    curvature = [1.2, -0.7, 2.0]
    solution = solved(intrinsic={"curvature": curvature}, base={"quaternion": [1, 0, 0, 0]})
    position, rotation = constant_strain([*curvature, 0.0, 0.0, 1.0], length=1.0)
    assert_allclose(solution.tip().position, position, rtol=0, atol=1e-10)
    assert_allclose(solution.tip().rotation, rotation, rtol=0, atol=1e-10)


def test_pull_stretches_by_force_over_axial_stiffness() -> None:
    stiffness = {
        "bending_x": 1.0,
        "bending_y": 1.0,
        "torsion": 1.0,
        "shear_x": 30.0,
        "shear_y": 30.0,
        "extension": 50.0,
    }
    solution = solved(push(force=[5.0, 0, 0]), strain="reissner", stiffness=stiffness)
    assert_allclose(solution.tip().position, [1.1, 0, 0], rtol=0, atol=1e-13)


def test_moment_along_the_axis_twists_by_moment_over_torsion_stiffness() -> None:
    solution = solved(push(force=[0, 0, 0], moment=[0.9, 0, 0]))
    assert_allclose(solution.tip().position, [1, 0, 0], rtol=0, atol=1e-12)
    # Local x starts along world y and turns about world x.
    assert_allclose(solution.tip().rotation[:, 0], [0, np.cos(0.9), np.sin(0.9)], rtol=0, atol=1e-12)


def test_small_push_vs_beam_theory() -> None:
    """F ℓ³/(3 EI) for bending, plus F ℓ/GA with shear."""
    force = 1e-5
    stiffness = {"bending_x": 1.0, "bending_y": 2.0, "torsion": 1.0, "shear_x": 7.0, "shear_y": 5.0, "extension": 50.0}
    solution = solved(push(force=[0, force, 0]), strain="reissner", stiffness=stiffness)
    # World y is local x: bending about local y, shear along local x.
    assert_allclose(solution.tip().position[1], force * (1 / 6 + 1 / 7), rtol=1e-8, atol=0)


@pytest.mark.parametrize("direction", [0, 1])
def test_cantilever_pushed_to_plus_x_bends_to_plus_x(direction: int) -> None:
    force = [0.0, 0.0, 0.0]
    force[direction] = 0.3
    tip = solve(build(scene(push(force=force)))).tip().position
    assert tip[direction] > 0.01


def test_reciprocity_of_the_tip() -> None:
    """Maxwell–Betti on the loaded rod: the flexibility d(tip)/d(force) is symmetric where forces are dead."""
    model = build(scene(push(), WEIGHT, strain="reissner", inputs=["push.force"]))
    solution = solve(model)
    jacobian = model.jacobian(solution.x, solution.inputs)[0].full()
    sensitivity = -np.linalg.solve(jacobian, model.input_jacobian(solution.x, solution.inputs).full())
    tip = model.tip["rod"]
    of_tip = lambda force: tip(solution.x + sensitivity @ force, solution.inputs)[0]  # noqa: E731
    flexibility = central_differences(of_tip, np.zeros(3), 1e-6)
    assert_allclose(flexibility, flexibility.T, rtol=0, atol=1e-8)


@pytest.mark.parametrize("transport", mostly_slow(["magnus6", "magnus8", "permuted"], quick=["magnus6"]))
def test_tip_error_falls_geometrically_to_rounding(transport: str) -> None:
    """Modes and nodes grow together: a factor of twenty a rung at least, down to 1e-11 of the length."""
    wanted = scene(push(force=[1.5, 0.8, -0.5]), WEIGHT)
    truth = solve(build(wanted, discretise(wanted, 16, 60, "magnus8"))).tip().position
    errors = []
    for modes in (2, 4, 6, 8, 10):
        nodes = 2 * modes + (40 if transport == "magnus6" else 14)
        tip = solve(build(wanted, discretise(wanted, modes, nodes, transport))).tip().position
        errors.append(distance_between(tip, truth) / 0.8)
    for coarse, fine in pairwise(errors):
        assert fine < max(coarse / 20, 1e-11)
    assert errors[-1] < 1e-11


def test_actuation_stress_bends_to_the_curvature_it_balances() -> None:
    """Λ_ad + H Δξ = 0 without loads: a constant stress −(M, N) gives the strain H⁻¹ (M, N), report (2.15)."""
    hooke = np.array([1.0, 2.0, 0.5, 30.0, 40.0, 50.0])
    plain = RodProperties(
        "r", 0.5, tuple(range(6)), "legendre", lambda X: np.tile(hooke, (len(X), 1)), ((0.0,),) * 5 + ((1.0,),)
    )
    basis = DiscreteRod(plain, Discretisation((3,) * 6, 8))
    wrench = np.array([0.3, -0.4, 0.2, 1.0, -2.0, 3.0])
    q = np.linalg.solve(basis.stiffness, -_actuation(basis, np.zeros(basis.size), -wrench))
    assert_allclose(_actuation(basis, q, -wrench) + basis.stiffness @ q, 0.0, rtol=0, atol=1e-14)
    strain = basis.at(q, np.array([0.0, 0.3, 1.0])).full().T
    assert_allclose(strain, np.tile([0, 0, 0, 0, 0, 1] + wrench / hooke, (3, 1)), rtol=0, atol=1e-12)


def _actuation(basis: DiscreteRod, q: np.ndarray, stress: np.ndarray) -> np.ndarray:
    import casadi as ca

    densities = np.outer(stress, np.ones(basis.grid.size))
    action = Actuation(StrainSum(range(6), densities), ca.DM(1.0))
    model = InverseGeometricModel(Statics(shape(basis, ca.DM(q)), []), (action,))
    assert model.further_force is not None
    assert_allclose(
        model.residual.full()[:, 0], basis.stiffness @ q + model.further_force.full()[:, 0], rtol=0, atol=1e-14
    )
    return np.asarray(model.further_force.full()[:, 0])
