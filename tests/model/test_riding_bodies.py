"""Bodies that ride on a section, against the same bodies as frames of their own, held by a constraint."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, build, modes_of, scene_from_dict, solve
from cosserat_casadi.model.floating_frames import FrameName, UnloadedScene
from tests.families import mostly_slow

TURNED = [0.6, 0.0, 0.8, 0.0]

BODY = {
    "name": "tool",
    "mass": 0.02,
    "centre_of_mass": [0.004, -0.003, 0.01],
    "inertia": [[4e-6, 1e-7, 0.0], [1e-7, 5e-6, -2e-7], [0.0, -2e-7, 3e-6]],
    "radius": 0.01,
}

JOINT = {"rod": "rod", "body": "tool", "kind": "fixed", "position": [0.01, 0.002, -0.005], "quaternion": TURNED}

LOADS = [
    {"name": "weight", "kind": "gravity", "acceleration": [0.0, 0.0, -9.81]},
    {"name": "push", "kind": "body_wrench", "body": "tool", "position": [0.0, 0.01, 0.02], "force": [0.02, 0.01, 0.03]},
    {
        "name": "thrust",
        "kind": "body_wrench",
        "body": "tool",
        "frame": "body",
        "position": [0.003, 0.0, -0.01],
        "force": [0.01, -0.02, 0.01],
        "moment": [1e-4, 2e-4, -1e-4],
    },
]


def tables(strain: str = "reissner", at: float = 1.0, **changes: Any) -> dict[str, Any]:
    """A rod with a body that is mounted off its centre and turned, under dead loads and loads that follow."""
    rod = {
        "name": "rod",
        "length": 0.3,
        "strain": strain,
        "base": {"position": [0.1, 0.0, 0.2], "tangent": [1.0, 0.2, 0.1]},
        "material": {"youngs_modulus": 3e9, "poisson_ratio": 0.4, "density": 1200.0},
        "section": {"shape": "circle", "radius": 2e-3},
        "damping": {"mass_proportional": 0.7},
    }
    scene = {
        "schema": 1,
        "accuracy": {"modes": 4, "nodes": 14},
        "rods": [rod],
        "bodies": [BODY],
        "joints": [{**JOINT, "at": at}],
        "loads": LOADS,
    }
    return {**scene, **changes}


CARRIED = {
    "name": "rod",
    "length": 0.2,
    "strain": "kirchhoff",
    "base": {"rod": "arm", "at": 0.6, "quaternion": TURNED},
    "material": {"youngs_modulus": 3e9, "poisson_ratio": 0.4, "density": 1200.0},
    "section": {"shape": "circle", "radius": 2e-3},
}

SCENES: dict[str, dict[str, Any]] = {
    "tip": tables(),
    "inside": tables("kirchhoff", at=0.4),
    "planar": tables("planar"),
    "on a carried rod": tables(rods=[{**tables()["rods"][0], "name": "arm"}, CARRIED]),
    "pulled by magnets": tables(
        loads=[
            LOADS[0],
            {
                "name": "magnet",
                "kind": "magnet",
                "body": "tool",
                "moment": [0.0, 0.01, 0.02],
                "position": [0.0, 0.004, 0.01],
                "dipole": {"position": [0.5, 0.1, 0.1], "moment": [5.0, 0.0, 1.0]},
            },
        ]
    ),
    "pressed": tables(
        obstacles=[
            {
                "name": "floor",
                "kind": "plane",
                "point": [0.0, 0.0, 0.2],
                "normal": [0.0, 0.0, 1.0],
                "bodies": ["tool"],
                "width": 0.1,
                "stiffness": 50.0,
                "friction": 0.3,
                "damping": 2.0,
            }
        ],
    ),
}

EVERY = pytest.mark.parametrize("name", mostly_slow(SCENES, quick=("inside", "pressed")))
FEW = pytest.mark.parametrize("name", mostly_slow(SCENES, quick=("planar",)))


@pytest.fixture
def floating(monkeypatch: pytest.MonkeyPatch) -> Callable[..., Model]:
    """Builds the model in which each body is a frame of its own, with a pose and multipliers among the unknowns.

    From then on no body rides, in whichever model.
    """

    def built(scene: dict[str, Any], **options: Any) -> Model:
        monkeypatch.setattr(UnloadedScene, "riding", {})
        return build(scene_from_dict(scene), **options)

    return built


State = tuple[np.ndarray, ...]
"""Unknowns with their first and second rates."""


def told(model: Model, state: State) -> list[np.ndarray]:
    """Residual in motion, energies, powers and momenta."""
    still = np.zeros(model.inputs.size)
    given = (model.pack(), still, still)
    results = [model.inverse_dynamics(*state, *given), *model.powers(*state, *given)]
    results += [*model.energies(*state[:2], *given[:2]), *model.momentum(*state[:2], *given[:2])]
    return [np.asarray(result.full()[:, 0]) for result in results if result.numel()]


def moving_pose(model: Model, state: State) -> State:
    """Pose of the body with its first and second rate along a motion, shape (7,) each."""
    x, v, a = (ca.MX.sym(symbol, model.size) for symbol in "xva")
    value = ca.vertcat(*model.body["tool"](x, model.pack())[:2])
    rate = ca.jtimes(value, x, v)
    second = ca.jtimes(rate, ca.vertcat(x, v), ca.vertcat(v, a))
    results = ca.Function("pose", [x, v, a], [value, rate, second])(*state)
    return tuple(np.asarray(result.full()[:, 0]) for result in results)


def entries_of(model: Model) -> tuple[list[int], list[int], list[int]]:
    """Unknowns of the pose of the body, of the multipliers of its joint, and all others."""
    every = list(range(model.size))
    body = every[model.discrete.deviation(FrameName("body", "tool"))]
    joint = next(placed for placed in model.discrete.constraints if placed.where == "joints[0]")
    multipliers = every[model.discrete.multipliers(joint)]
    return body, multipliers, [entry for entry in every if entry not in (*body, *multipliers)]


def in_floating_unknowns(model: Model, state: State, moved: State) -> State:
    """The unknowns of a model with a frame for the body, and their rates, without the multipliers of its joint."""
    body, _, others = entries_of(model)
    frame = model.discrete.body_frame("tool")
    sign = np.sign(moved[0][3:] @ frame.start.quaternion)
    whole = []
    for own, pose in zip(state, moved, strict=True):
        full = np.zeros(model.size)
        full[others] = own
        full[body] = np.concatenate([pose[:3] / frame.length, sign * pose[3:]])
        whole.append(full)
    whole[0][body] -= np.concatenate([frame.start.position / frame.length, frame.start.quaternion])
    return tuple(whole)


@EVERY
def test_equations_of_motion_are_those_of_a_frame_whose_joint_bears_what_it_has_to(
    name: str, floating: Callable[..., Model]
) -> None:
    """With multipliers that balance the body, the rows of the rods agree at any shape, speed and acceleration."""
    riding = build(scene_from_dict(SCENES[name]), moving=True)
    random = np.random.default_rng(7)
    state = tuple(scale * random.standard_normal(riding.size) for scale in (0.1, 2.0, 30.0))
    still = np.zeros(riding.inputs.size)
    own = told(riding, state)
    moved = moving_pose(riding, state)

    model = floating(SCENES[name], moving=True)
    assert riding.size == model.size - 13
    body, multipliers, others = entries_of(model)
    x, v, a = in_floating_unknowns(model, state, moved)

    def residual(at: np.ndarray) -> np.ndarray:
        return np.asarray(model.inverse_dynamics(at, v, a, model.pack(), still, still).full()[:, 0])

    before = residual(x)
    columns = []
    for k in multipliers:
        pushed = x.copy()
        pushed[k] = 1.0
        columns.append((residual(pushed) - before)[body])
    x[multipliers] = np.linalg.lstsq(np.column_stack(columns), -before[body], rcond=None)[0]
    after = residual(x)
    assert_allclose(after[[*body, *multipliers]], 0.0, rtol=0, atol=1e-10)
    theirs = told(model, (x, v, a))
    theirs[0] = after[others]
    for one, other in zip(own, theirs, strict=True):
        assert_allclose(one, other, rtol=1e-9, atol=1e-10)


@EVERY
def test_derivatives_are_those_of_automatic_differentiation(name: str) -> None:
    model = build(scene_from_dict(SCENES[name]), moving=True)
    symbols = [ca.MX.sym(symbol, model.size) for symbol in "xva"]
    given = (model.pack(), np.zeros(model.inputs.size), np.zeros(model.inputs.size))
    residual = model.inverse_dynamics(*symbols, *given)
    written = model.dynamics_jacobian(*symbols, *given)[:3]
    automatic = [ca.jacobian(residual, symbol) for symbol in symbols]
    pose = ca.vertcat(*model.body["tool"](symbols[0], given[0])[:2])
    by_x = [model.body_jacobian["tool"](symbols[0], given[0])[0], ca.jacobian(pose, symbols[0])]
    both = ca.Function("both", symbols, [*map(ca.densify, written), by_x[0], *map(ca.densify, automatic), by_x[1]])
    random = np.random.default_rng(3)
    results = both(*(scale * random.standard_normal(model.size) for scale in (0.1, 2.0, 30.0)))
    for one, other in zip(results[:4], results[4:], strict=True):
        assert_allclose(one.full(), other.full(), rtol=1e-9, atol=1e-9 * float(np.abs(other.full()).max()))


@FEW
def test_equilibria_and_frequencies_are_those_of_a_frame(name: str, floating: Callable[..., Model]) -> None:
    riding = equilibrium_of(build(scene_from_dict(SCENES[name])))
    frame = equilibrium_of(floating(SCENES[name]))
    for one, other in zip(riding, frame, strict=True):
        assert_allclose(one, other, rtol=1e-8, atol=1e-10)


def equilibrium_of(model: Model) -> list[np.ndarray]:
    """Pose of the body, wrench at the clamp, stability, and the lowest frequencies."""
    solution = solve(model)
    assert solution.converged, solution.message
    body = solution.body("tool")
    base = solution.base_wrench(model.scene.rods[0].name)
    facts = [body.position, body.rotation, base.force, base.moment, np.array(float(bool(solution.stable)))]
    if not model.scene.obstacles:
        facts.append(np.array([mode.eigenvalue for mode in modes_of(solution, count=3).modes]))
    return facts


@pytest.mark.parametrize("strain", mostly_slow(["kirchhoff", "planar", "reissner"], quick=["planar"]))
def test_a_body_costs_no_step_more_than_its_weight(strain: str) -> None:
    """At a tendon that is pulled until the tip has turned more than three times."""
    rod = {
        "name": "rod",
        "length": 0.2,
        "strain": strain,
        "material": {"youngs_modulus": 2e9, "poisson_ratio": 0.4, "density": 1100.0},
        "section": {"shape": "circle", "radius": 1e-3},
    }
    scene = {
        "schema": 1,
        "accuracy": {"modes": 8, "nodes": 30},
        "rods": [rod],
        "loads": [LOADS[0], {"name": "load", "kind": "tip_wrench", "rod": "rod", "force": [0.0, 0.0, -0.02 * 9.81]}],
        "actuators": [{"name": "cable", "kind": "tendon", "rod": "rod", "tension": 2.0, "offset": [4e-3, 0.0]}],
        "inputs": ["cable.tension"],
    }
    weighed = build(scene_from_dict(scene))
    body = {"name": "tool", "mass": 0.02}
    joint = {"rod": "rod", "body": "tool", "kind": "fixed"}
    ridden = build(scene_from_dict({**scene, "loads": LOADS[:1], "bodies": [body], "joints": [joint]}))
    for tension in (2.0, 10.0, 20.0, 40.0):
        wanted, solution = (solve(model, {"cable.tension": tension}) for model in (weighed, ridden))
        assert solution.converged, solution.message
        assert solution.iterations == wanted.iterations
        assert_allclose(solution.x, wanted.x, rtol=0, atol=1e-10)
        assert_allclose(solution.error_estimate, wanted.error_estimate, rtol=1e-3, atol=0)
