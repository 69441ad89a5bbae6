"""Tendons and chambers against closed forms, against an integration from the clamp, and against their own energy."""

from __future__ import annotations

import json
import tomllib
from itertools import pairwise
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Solution, build, parse_scene, read_scene, scene_from_dict
from cosserat_casadi.plots.scenery import actuator_routing
from cosserat_casadi.plots.solved_shapes import SAMPLES
from tests.conftest import case_files
from tests.derivatives import central_differences
from tests.equilibria import solve
from tests.families import mostly_slow
from tests.reference.routed_scenes import miss

ROD = """
schema = 1
[accuracy]
tolerance = 1e-9
[[rods]]
name = "finger"
length = 0.2
strain = {strain}
stiffness = {{ bending_x = 0.02, bending_y = 0.03, torsion = 0.025, shear_x = 500, shear_y = 400, extension = 900 }}
linear_density = 0.03
"""
PRECURVED = "intrinsic = { curvature = [0.3, -1.0, 0.4] }\n"
LOADED = """
[[loads]]
name = "weight"
kind = "gravity"
acceleration = [1, 2, -9.81]
[[loads]]
name = "push"
kind = "tip_wrench"
rod = "finger"
force = [0.3, -0.15, 0.06]
moment = [0.001, 0.0, 0.002]
"""
COURSES = {
    "straight": "offset = [0.006, 0.001]",
    "converging": "offset = [[0.006, -0.003], [0.001, 0.002, -0.001]]",
    "helical": "helix = { radius = 0.005, turns = 0.7, phase = 1.0 }",
    "partial": "offset = [0.006, [0.0, 0.002]]\nspan = [0.0, 0.6]",
    "inner": "offset = [0.004, -0.003]\nspan = [0.2, 0.7]",
}


def tendon(course: str, acts: str = "tension = 4.0", name: str = "cable") -> str:
    return f'\n[[actuators]]\nname = "{name}"\nkind = "tendon"\nrod = "finger"\n{acts}\n{course}\n'


def rod(strain: str = '"reissner"') -> str:
    return ROD.format(strain=strain)


def chamber(more: str = "") -> str:
    return f'\n[[actuators]]\nname = "cell"\nkind = "chamber"\nrod = "finger"\npressure = 2e4\narea = 2e-5\n{more}\n'


def solved(text: str, modes: int = 10) -> Solution:
    """On a discretisation whose error is far below what is asked here."""
    return solve(build(parse_scene(text, (f"accuracy.modes={modes}", f"accuracy.nodes={2 * modes}"))))


MANY = tendon(COURSES["converging"]) + tendon(COURSES["partial"], "tension = 2.5", "second")
MANY += tendon(COURSES["helical"], "tension = 1.5", "third")


@pytest.mark.parametrize("course", mostly_slow([*COURSES, "several"], quick=["partial", "several"]))
def test_tendons_vs_integration(course: str) -> None:
    """The tip and the lengths of the cables are those of the equilibrium that is integrated from the clamp."""
    cables = MANY if course == "several" else tendon(COURSES[course])
    solution = solved(rod() + PRECURVED + LOADED + cables, 14)
    error = miss(solution.model.scene, solution)
    assert error.tip <= 1e-9
    assert error.cable <= 1e-9


TENDON_ROBOTS = [path for path in case_files("robots") if path.stem.startswith("tendon")]


@pytest.mark.parametrize("path", mostly_slow(TENDON_ROBOTS, quick=TENDON_ROBOTS[::2]), ids=lambda path: path.stem)
def test_reference_cases_of_tendon_robots(path: Path) -> None:
    case = json.loads(path.with_suffix(".json").read_text())
    scene = read_scene(path)
    solution = solve(scene)
    wanted = case["expected"]
    tolerance = case.get("position_tolerance_relative_to_length", scene.accuracy.tolerance)
    length = scene.rods[0].length
    assert solution.converged
    assert_allclose(solution.tip().position, wanted["tip"]["position"], rtol=0, atol=tolerance * length)
    assert_allclose(solution.tip().rotation, wanted["tip"]["rotation"], rtol=0, atol=tolerance)
    if "base_wrench" in wanted:
        assert_allclose(solution.base_wrench().force, wanted["base_wrench"]["force"], rtol=0, atol=tolerance)


def test_parallel_tendon_bends_to_a_circle() -> None:
    """K_y = −τ D_x/EI of an inextensible rod: the cable shortens on the side where it runs."""
    solution = solved(rod('"kirchhoff"') + tendon("offset = [0.006, 0.0]"))
    curvature = -4.0 * 0.006 / 0.03 * -1.0
    radius = 1 / curvature
    angle = 0.2 * curvature
    expected = [radius * (1 - np.cos(angle)), 0.0, radius * np.sin(angle)]
    assert_allclose(solution.tip().position, expected, rtol=0, atol=1e-12)
    assert_allclose(solution.actuator("cable")["length"], 0.2 * (1 - 0.006 * curvature), rtol=1e-13, atol=0)


def test_chamber_bends_and_stretches() -> None:
    """K_x = p A D_y/EI and stretch p A/EA; the rod bends away from the chamber."""
    solution = solved(rod() + chamber("offset = [0.0, 0.003]"))
    push = 2e4 * 2e-5
    strain = solution.strain([0.0, 0.4, 1.0])
    assert_allclose(strain[:, 0], push * 0.003 / 0.02, rtol=1e-12, atol=0)
    assert_allclose(strain[:, 5], 1 + push / 900, rtol=1e-13, atol=0)
    volume = 2e-5 * 0.2 * (1 + push / 900 + push * 0.003**2 / 0.02)
    assert_allclose(solution.actuator("cell")["volume"], volume, rtol=1e-12, atol=0)


def test_chamber_along_a_part_bends_a_part() -> None:
    """Straight, a circle of K_y = −p A D_x/EI, straight again."""
    solution = solved(rod('"kirchhoff"') + chamber("offset = [-0.002, 0.0]\nspan = [0.25, 0.75]"))
    curvature = 2e4 * 2e-5 * 0.002 / 0.03
    angle = 0.1 * curvature
    x, z = (1 - np.cos(angle)) / curvature, np.sin(angle) / curvature
    expected = [x + 0.05 * np.sin(angle), 0.0, 0.05 + z + 0.05 * np.cos(angle)]
    assert_allclose(solution.tip().position, expected, rtol=0, atol=1e-12)


def test_loaded_chamber_vs_intrinsic_strain() -> None:
    """A stress that no strain changes is an unloaded shape of another kind: ξ⁰ − Λ_ad/H."""
    push, (x, y) = 2e4 * 2e-5, (0.002, 0.003)
    curved = [push * y / 0.02, -push * x / 0.03, 0.0]
    shaped = f"intrinsic = {{ curvature = {curved}, tangent = [0, 0, {1 + push / 900!r}] }}\n"
    found = solved(rod() + LOADED + chamber(f"offset = [{x}, {y}]"))
    assert_allclose(found.tip().position, solved(rod() + shaped + LOADED).tip().position, rtol=0, atol=1e-13)


@pytest.mark.parametrize("course", mostly_slow(COURSES, quick=["converging", "partial"]))
def test_length_is_the_length_of_the_course(course: str) -> None:
    """Chords through many points of r + R D, extrapolated."""
    solution = solved(rod() + LOADED + tendon(COURSES[course]))
    points = actuator_routing(solution, solution.model.scene.actuators[0])
    assert len(points) == len(SAMPLES)
    fine, coarse = (np.linalg.norm(np.diff(points[::k], axis=0), axis=1).sum() for k in (1, 2))
    assert_allclose(solution.actuator("cable")["length"], fine + (fine - coarse) / 3, rtol=1e-8, atol=0)


@pytest.mark.parametrize("course", mostly_slow(COURSES, quick=["converging", "partial"]))
def test_work_of_the_tendon_is_the_change_of_energy(course: str) -> None:
    """E(τ) = −∫ τ dL = ∫ L dτ − τ L, by Gauss points in the tension."""
    model = build(scene_from_dict(tomllib.loads(rod() + tendon(COURSES[course])), ("accuracy.modes=8",)))
    x, weights = np.polynomial.legendre.leggauss(10)
    tensions = 2.0 * (x + 1)
    lengths = [solve(model, {"cable.tension": t}).actuator("cable")["length"] for t in tensions]
    end = solve(model, {"cable.tension": 4.0})
    work = 2.0 * weights @ lengths - 4.0 * end.actuator("cable")["length"]
    assert work > 1e-3
    assert_allclose(float(model.energy(end.x, end.inputs)), work, rtol=1e-10, atol=0)


@pytest.mark.parametrize("slack", ["", "\nslack = true"])
def test_given_length_vs_given_tension(slack: str) -> None:
    by_tension = solved(rod() + PRECURVED + LOADED + tendon(COURSES["helical"]))
    length = by_tension.actuator("cable")["length"]
    text = rod() + PRECURVED + LOADED + tendon(COURSES["helical"], f"length = {length!r}{slack}")
    by_length = solved(text)
    assert by_length.converged
    assert_allclose(by_length.actuator("cable")["tension"], 4.0, rtol=1e-6, atol=0)
    assert_allclose(by_length.tip().position, by_tension.tip().position, rtol=0, atol=1e-9)


@pytest.mark.slow
def test_slack_cable_never_pushes() -> None:
    """Longer than the free rod asks for, a cable that may go slack leaves the rod alone; one that may not pushes it."""
    free = solved(rod() + LOADED)
    slack = solved(rod() + LOADED + tendon(COURSES["straight"], "length = 0.25\nslack = true"))
    stiff = solved(rod() + LOADED + tendon(COURSES["straight"], "length = 0.21"))
    assert slack.converged
    assert 0.0 <= slack.actuator("cable")["tension"] < 1e-12
    assert_allclose(slack.tip().position, free.tip().position, rtol=0, atol=1e-9)
    assert stiff.actuator("cable")["tension"] < -1.0
    assert_allclose(stiff.actuator("cable")["length"], 0.21, rtol=1e-10, atol=0)


def test_slack_cable_holds_nothing() -> None:
    """The second variation of a rod with a slack cable is that of the rod alone."""
    cables = [tendon(COURSES["straight"], f"length = {length}\nslack = true") for length in (0.25, 0.19)]
    weight = LOADED.split('[[loads]]\nname = "push"')[0]
    free, slack, taut = (solved(rod() + weight + cable) for cable in ("", *cables))
    assert free.smallest_eigenvalue is not None
    assert slack.smallest_eigenvalue is not None
    assert_allclose(slack.smallest_eigenvalue, free.smallest_eigenvalue, rtol=1e-9, atol=0)
    assert taut.stable


def test_cable_goes_slack_where_its_length_is_that_of_the_free_rod() -> None:
    """Across the corner the tension falls to nothing and stays there."""
    model = build(parse_scene(rod() + LOADED + tendon(COURSES["straight"], "length = 0.2\nslack = true")))
    free = solve(model, {"cable.length": 0.3}).actuator("cable")["length"]
    lengths = free + np.array([-2e-3, -1e-3, -1e-4, 0.0, 1e-4, 1e-3])
    found = [solve(model, {"cable.length": length}) for length in lengths]
    assert all(one.converged for one in found)
    tensions = [one.actuator("cable")["tension"] for one in found]
    assert_allclose(tensions[3:], 0.0, rtol=0, atol=1e-7)
    assert np.all(np.diff(tensions[:4]) < 0)


ALL = tendon(COURSES["converging"]) + tendon(COURSES["partial"], "length = 0.12", "second") + chamber("span = [0.2, 1]")


@pytest.mark.parametrize(
    "strain",
    mostly_slow(
        ['"planar"', '"kirchhoff"', '"reissner"', '["bending_x", "torsion", "extension"]'],
        quick=['["bending_x", "torsion", "extension"]'],
    ),
)
@pytest.mark.parametrize("slack", mostly_slow(["", "\nslack = true"], quick=["\nslack = true"]))
def test_jacobian_vs_automatic_and_finite_differences(strain: str, slack: str) -> None:
    text = rod(strain) + LOADED + ALL.replace("length = 0.12", f"length = 0.12{slack}")
    model = build(parse_scene(text))
    x, u = np.random.default_rng(3).standard_normal(model.size) / 3, model.pack()
    jacobian = model.jacobian(x, u)[0].full()
    symbols = [ca.MX.sym("x", model.size), ca.MX.sym("u", len(u)), ca.MX.sym("f")]
    by_ad = ca.Function("by_ad", symbols, [ca.jacobian(model.path_residual(*symbols), symbols[0])])
    assert np.abs(jacobian).max() > 0.01
    assert_allclose(jacobian, by_ad(x, u, 1.0).full(), rtol=0, atol=1e-13)
    assert_allclose(model.path_jacobian(x, u, 0.3).full(), by_ad(x, u, 0.3).full(), rtol=0, atol=1e-13)
    assert_allclose(jacobian, central_differences(lambda x: model.residual(x, u), x, 1e-6), rtol=0, atol=1e-8)


@pytest.mark.parametrize("strain", ['"planar"', '"kirchhoff"', '"reissner"'])
def test_residual_vs_gradient_of_the_potential(strain: str) -> None:
    """Exact derivatives of an energy: first and second are finite at zero strain, and agree."""
    actuators = tendon(COURSES["straight"]) + tendon(COURSES["helical"], "tension = 0", "second") + chamber()
    loads = LOADED.replace("moment = [0.001, 0.0, 0.002]", "")
    model = build(parse_scene(rod(strain) + loads + actuators))
    assert model.potential is not None
    q = ca.MX.sym("q", model.size)
    hessian, gradient = ca.hessian(model.potential(q, model.pack()), q)
    derivatives = ca.Function("derivatives", [q], [gradient, hessian])
    unit = model.discrete.rods["finger"].energy_unit
    for x in (np.zeros(model.size), np.random.default_rng(5).standard_normal(model.size) / 4):
        found = [part.full() / unit for part in derivatives(x)]
        assert np.all(np.isfinite(found[1]))
        assert_allclose(model.residual(x, model.pack()).full(), found[0], rtol=0, atol=1e-13)
        assert_allclose(model.jacobian(x, model.pack())[0].full(), found[1], rtol=0, atol=1e-12)


def test_derivative_of_length_vs_automatic() -> None:
    model = build(parse_scene(rod() + LOADED + ALL))
    x, u = ca.MX.sym("x", model.size), model.pack()
    at = np.random.default_rng(4).standard_normal(model.size) / 3
    for name in ("cable", "second", "cell"):
        _, conjugate, gradient = model.actuator[name](x, u)
        values = ca.Function("both", [x], [gradient, ca.jacobian(conjugate, x)])(at)
        assert np.abs(values[0].full()).max() > 0
        assert_allclose(values[0].full(), values[1].full(), rtol=0, atol=1e-15)


@pytest.mark.parametrize("course", mostly_slow(["converging", "helical", "partial", "inner"], quick=["inner"]))
def test_convergence_is_geometric_even_across_anchors(course: str) -> None:
    text = rod('["bending_x", "bending_y", "torsion", "extension"]') + LOADED + tendon(COURSES[course])
    tips = [
        solve(build(parse_scene(text, (f"accuracy.modes={m}", "accuracy.nodes=16")))).tip().position
        for m in (2, 4, 6, 9)
    ]
    errors = [np.abs(tip - tips[-1]).max() for tip in tips[:-1]]
    assert errors[0] > 1e-8
    for coarse, fine in pairwise(errors):
        assert fine < max(coarse / 8, 1e-13)


def test_tendon_without_tension_is_no_tendon() -> None:
    """A cable of zero tension baked in adds no instruction."""
    bare = build(parse_scene(rod() + LOADED))
    fixed = "inputs = ['push.force', 'push.moment', 'weight.acceleration']"
    slack = build(parse_scene(f"{fixed}\n" + rod() + LOADED + tendon(COURSES["straight"], "tension = 0.0")))
    assert slack.operations(slack.residual) == bare.operations(bare.residual)
