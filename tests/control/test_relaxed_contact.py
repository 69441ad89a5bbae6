"""Relaxed contact: derivatives, the exact law in the limit, and what is refused. An optimum is in docs/control.md."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import casadi as ca
import numpy as np
import pytest

from cosserat_casadi import Model, Solution, build, scene_from_dict, solve
from cosserat_casadi.codegen.acados import acados_functions
from cosserat_casadi.codegen.stage import compiled_stage, stage_functions
from cosserat_casadi.control import RelaxedContact, embedded, relaxed_contact, tightened
from cosserat_casadi.equilibrium.contact.gaps import gap_along
from cosserat_casadi.equilibrium.metrics import pose_distance
from cosserat_casadi.errors import ExportError, SceneError
from cosserat_casadi.maths.typing import FloatArray

LENGTH = 0.25
BENDING = 1.2e9 * np.pi / 4 * 1.5e-3**4
OFFSET = 1.2e-3

ROBOT = {
    "schema": 1,
    "inputs": ["flexor.tension", "robot.base.position"],
    "accuracy": {"modes": 3, "nodes": 5},
    "rods": [
        {
            "name": "robot",
            "length": LENGTH,
            "strain": "planar",
            "material": {"youngs_modulus": 1.2e9, "poisson_ratio": 0.35},
            "section": {"shape": "circle", "radius": 1.5e-3},
            "base": {"position": [0, 0, -0.12]},
        }
    ],
    "actuators": [{"name": "flexor", "kind": "tendon", "rod": "robot", "tension": 0.5, "offset": [OFFSET, 0]}],
    "obstacles": [
        {"name": "edge", "kind": "capsule", "from": [-0.02, -0.05, 0.17], "to": [-0.02, 0.05, 0.17], "radius": 0.04}
    ],
}
"""A robot that bends a little by its tendon, and is fed past the rounded edge of a wall."""

AT_EDGE = np.array([0.5, 0.0, 0.0, -0.02])
"""Tension, N, and place of the base, m, at which it leans on the edge."""


@cache
def robot() -> tuple[Model, Solution, RelaxedContact]:
    """The robot, its equilibrium in exact contact, and its relaxed contact at three sections."""
    model = build(scene_from_dict(ROBOT))
    return model, solve(model, AT_EDGE, estimate_error=False), relaxed_contact(model, 3)


def shaken(contact: RelaxedContact, z: FloatArray) -> list[FloatArray]:
    """Arguments of the functions a little off an equilibrium and off evenly spread sections."""
    rng = np.random.default_rng(7)
    p = contact.defaults + np.array([0.02, 0.01, -0.02])
    return [z + 0.05 * rng.standard_normal(len(z)), AT_EDGE, p]


def numbers(*parts: ca.DM) -> FloatArray:
    """Columns of CasADi, stacked."""
    return np.concatenate([part.full() for part in parts])


def test_derivatives_are_those_of_differences() -> None:
    """Of the residual and of poses with unknowns and forces, inputs, and smoothing and places."""
    _, equilibrium, contact = robot()
    at = shaken(contact, contact.near(equilibrium))
    slopes = [contact.jacobian(*at)[0], contact.input_jacobian(*at), contact.parameter_jacobian(*at)]
    for number, (slope, of_tip) in enumerate(zip(slopes, contact.tip_jacobian["robot"].call(at), strict=True)):
        direction = np.random.default_rng(number).standard_normal(len(at[number]))
        step = 1e-6
        ends = [[*at[:number], at[number] + way * direction, *at[number + 1 :]] for way in (step, -step)]
        before, after = (numbers(contact.residual(*end), *contact.tip["robot"](*end)[:2]) for end in ends)
        exact = numbers(slope, of_tip) @ direction
        np.testing.assert_allclose(exact, (before - after)[:, 0] / (2 * step), rtol=0, atol=1e-7)


def test_exact_law_is_the_limit() -> None:
    """Gap times force goes with the square of the smoothing; with a section at the contact so does the difference."""
    model, equilibrium, _ = robot()
    (touch,) = equilibrium.contacts
    fine = relaxed_contact(model, 3, modes=3, nodes=5)
    p = fine.moved_to(equilibrium, fine.defaults)
    assert touch.start in p
    differences = []
    for smoothing in (1e-2, 1e-3, 1e-5):
        p[0] = smoothing
        z = fine.near(equilibrium, p)
        np.testing.assert_allclose(numbers(fine.residual(z, AT_EDGE, p)), 0.0, rtol=0, atol=1e-10)
        relaxed = fine.solution(z, AT_EDGE, p)
        differences.append(pose_distance(relaxed, equilibrium))
        gaps = gap_along(relaxed, "robot", model.scene.obstacles[0], np.array([*p[1:], 1.0]))
        np.testing.assert_allclose(z[-3:] * gaps, smoothing**2 / 2, rtol=1e-3, atol=1e-12)
    assert 50 < differences[0] / differences[1] < 200
    assert differences[2] < 1e-7
    # Its force is that of the exact law.
    unit = BENDING / LENGTH**2
    np.testing.assert_allclose(z[-3:].max() * unit, touch.ends[0], rtol=1e-5, atol=0)
    exact = fine.exact(z, AT_EDGE, p)
    np.testing.assert_allclose(exact.contacts[0].start, touch.start, rtol=0, atol=1e-9)
    # Between evenly spread sections the rod is inside the edge.
    z = fine.near(equilibrium, fine.defaults)
    assert pose_distance(fine.solution(z, AT_EDGE, fine.defaults), equilibrium) > 100 * differences[2]


def test_embedded_relaxed_contact_is_an_equilibrium_with_derivatives() -> None:
    _, near, contact = robot()
    p = contact.moved_to(near, contact.defaults)
    function = embedded(contact, near)
    z, excess = function(AT_EDGE, p)
    assert excess <= 1.0
    inputs = ca.MX.sym("inputs", 4)
    slope = ca.Function("slope", [inputs], [ca.jacobian(function(inputs, p)[0], inputs)])(AT_EDGE)
    by_z, by_inputs = contact.jacobian(z, AT_EDGE, p)[0], contact.input_jacobian(z, AT_EDGE, p)
    by_implicit = -np.linalg.solve(by_z.full(), by_inputs.full())
    np.testing.assert_allclose(slope.full(), by_implicit, rtol=0, atol=1e-9 * np.abs(by_implicit).max())


def test_stages_and_acados_take_relaxed_contact() -> None:
    """The functions that are written in C are those of the model."""
    _, near, contact = robot()
    at = shaken(contact, contact.near(near))
    stage = next(stage_functions(contact, "stage", curvature=True))
    residual, pose = stage(*at)
    wanted = numbers(contact.residual(*at))
    np.testing.assert_allclose(residual.full(), wanted, rtol=0, atol=1e-12)
    np.testing.assert_allclose(pose.full(), numbers(*contact.tip["robot"](*at)[:2]), rtol=0, atol=1e-12)
    z, inputs, p = at
    (whole,) = [function for function in acados_functions(contact, "robot") if function.name().endswith("dae_fun")]
    value = whole(inputs, np.zeros(4), np.zeros(4), z, 0.0, p)
    np.testing.assert_allclose(value.full()[4:], wanted, rtol=0, atol=1e-12)


def test_bodies_and_several_obstacles() -> None:
    """A ball at the tip on a floor, and a rod between two planes: forces of both obey the exact law."""
    planes = [
        {
            "name": "floor",
            "kind": "plane",
            "point": [0, 0, -0.03],
            "normal": [0, 0, 1],
            "bodies": ["head"],
            "rods": ["rod"],
        },
        {"name": "roof", "kind": "plane", "point": [0, 0, 0.0], "normal": [0.3, 0, -1], "rods": ["rod"]},
    ]
    tables = {
        "schema": 1,
        "rods": [
            {
                "name": "rod",
                "length": 0.1,
                "strain": "planar",
                "stiffness": {"bending_y": 1e-3},
                "base": {"tangent": [1, 0, 0], "position": [0, 0, -0.02]},
            }
        ],
        "loads": [
            {"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0, 0, -0.3]},
            # Where the floor has a section, which makes way.
            {"name": "side", "kind": "point_wrench", "rod": "rod", "at": 0.5, "force": [0, 0, 0.05]},
        ],
        "inputs": ["push.force"],
        "accuracy": {"modes": 2, "nodes": 4},
        "obstacles": planes,
        "bodies": [{"name": "head", "mass": 1e-3, "radius": 5e-3}],
        "joints": [{"body": "head", "rod": "rod", "kind": "fixed"}],
    }
    model = build(scene_from_dict(tables))
    contact = relaxed_contact(model, 2)
    assert len({*contact.defaults, 0.5}) == len(contact.defaults) + 1
    exact = solve(model, estimate_error=False)
    (touch,) = exact.contacts
    assert touch.of_body
    # No section passes a load.
    for place, moved in ((0.45, 0.501), (0.55, 0.55)):
        on_floor = replace(touch, owner="rod", of_body=False, start=place, end=place)
        assert moved in contact.moved_to(replace(exact, contacts=(on_floor,)), contact.defaults)
    p = contact.defaults
    p[0] = 1e-4
    z = contact.near(exact, p)
    assert pose_distance(contact.solution(z, exact.inputs[:3], p), exact) < 1e-5
    assert contact.exact(z, exact.inputs[:3], p).contacts[0].of_body


def test_sections_move_to_contacts_in_order() -> None:
    """Each contact has a section of its own."""
    _, near, contact = robot()
    (touch,) = near.contacts
    two = replace(near, contacts=tuple(replace(touch, start=X, end=X) for X in (0.6, 0.65)))
    np.testing.assert_array_equal(contact.moved_to(two, contact.defaults)[1:], [0.6, 0.65])


def test_what_has_no_relaxed_contact_is_refused() -> None:
    model, near, contact = robot()
    free = build(scene_from_dict({**ROBOT, "obstacles": []}))
    with pytest.raises(SceneError, match="no rod touches exactly"):
        relaxed_contact(free)
    with pytest.raises(SceneError, match="must be 1 or more"):
        relaxed_contact(model, 0)
    # Rods of a stage would pass through the wall.
    with pytest.raises(SceneError, match="take relaxed_contact"):
        compiled_stage(model)
    with pytest.raises(SceneError, match="take relaxed_contact"):
        embedded(model, near)
    with pytest.raises(ExportError, match="poses of tips and bodies alone"):
        compiled_stage(contact, sections={"robot": [0.5]})
    with pytest.raises(SceneError, match="an acados model"):
        acados_functions(contact, "robot", moving=True)


def test_what_a_problem_returns_is_checked() -> None:
    """Numbers that are not finite, and rows for columns."""
    _, _, contact = robot()
    with pytest.raises(SceneError, match="unknowns that are not finite"):
        tightened(contact, lambda _: (np.full(contact.size, np.nan), AT_EDGE))
    with pytest.raises(SceneError, match="transpose"):
        tightened(contact, lambda _: (np.zeros((contact.size, 2)), np.tile(AT_EDGE, (2, 1))), 2)


def test_relaxed_contact_becomes_tight() -> None:
    """At inputs that are held, so that the equilibrium is known: sections move to the contact until both agree."""
    _, near, contact = robot()
    smoothings = []

    def held(values: FloatArray) -> tuple[Any, Any]:
        smoothings.append(values[0, 0])
        return contact.near(near, values[0]), AT_EDGE

    tight = tightened(contact, held, tolerance=1e-4)
    assert tight.converged, tight.message
    assert smoothings == [1e-2, 1e-3, 1e-4]
    # Sections are moved as often as they do not agree: what is left is rounding.
    assert np.abs(tight.p[0] - near.contacts[0].start).min() < 1e-14
    assert pose_distance(tight.equilibria[0], near) < 1e-9
    last = contact.solution(tight.z[0], AT_EDGE, tight.p[0])
    np.testing.assert_allclose(tight.difference, pose_distance(last, near), rtol=1e-3, atol=0)


@pytest.mark.slow
def test_an_optimum_that_is_not_tight_says_so() -> None:
    """One section alone lets the robot into the edge, and nothing keeps it on one side: what the exact law says."""
    model, near, _ = robot()
    contact = relaxed_contact(model, 1)
    behind = AT_EDGE - np.array([0.0, 0.08, 0.0, 0.0])
    stages = [near, solve(model, behind)]

    def held(values: FloatArray) -> tuple[Any, Any]:
        return np.array(list(map(contact.near, stages, values))), [AT_EDGE, behind]

    tight = tightened(contact, held, 2, tolerance=1e-6)
    assert not tight.converged
    assert "take more sections" in tight.message
    assert all(solution.converged for solution in tight.equilibria) and tight.difference > 1e-3
    assert tight.passing == (1,)
    assert "to stages 1 a rod goes through" in tight.message


@pytest.mark.slow
def test_a_contact_that_just_opens_is_tight_with_less_smoothing() -> None:
    """Force and gap are of the order of ε there, not of its square: ε is what has to become smaller."""
    tables: dict[str, Any] = {
        "schema": 1,
        "accuracy": {"modes": 3, "nodes": 6},
        "rods": [
            {
                "name": "rod",
                "length": 1.0,
                "strain": "planar",
                "stiffness": {"bending_y": 0.5},
                "base": {"tangent": [1, 0, 0]},
            }
        ],
        "loads": [{"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0, 0, -0.3]}],
        "inputs": ["push.force"],
    }
    height = solve(build(scene_from_dict(tables)), estimate_error=False).pose(1.0).position[2]
    floor = {"name": "floor", "kind": "plane", "point": [0, 0, float(height) + 1e-5], "normal": [0, 0, 1]}
    model = build(scene_from_dict({**tables, "obstacles": [floor]}))
    near = solve(model)
    assert near.contacts
    contact = relaxed_contact(model, 2)
    push = np.array([0.0, 0.0, -0.3])
    tight = tightened(contact, lambda p: (contact.near(near, p[0]), push), tolerance=1e-5)
    assert tight.converged, tight.message
    np.testing.assert_allclose(tight.p[0, 0], 1e-5, rtol=1e-9, atol=0)
