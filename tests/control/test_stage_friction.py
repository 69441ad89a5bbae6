"""Friction of exact contact in stages of motions: virtual work by differences, blocks on slopes, the simulator."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, build, scene_from_dict, simulate
from cosserat_casadi.control import MotionStage, motion_stage
from cosserat_casadi.equilibrium.contact.obstacle_surfaces import surface
from cosserat_casadi.loads.disk_reach import disk_reach
from cosserat_casadi.maths.rotation import quaternion_to_matrix
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.pose_series import section_poses
from cosserat_casadi.motion.section_pairs import TouchingSections
from tests.control.test_motion_stage_in_contact import LENGTH, falling, pairs_of, rod

SMOOTHINGS = np.geomspace(1e-2, 1e-6, 9)
"""Smoothings that each stage is solved with, one after the other."""

COEFFICIENTS = {"along": 0.2, "back": 0.7, "across": 0.4}
GRAVITY = 9.81
BASE_RADIUS, TIP_RADIUS = 5e-3, 4e-3


def carried(friction: Any) -> Model:
    """A ball, a disk and the tips of rods that may touch a floor, and a tip that may touch a ball which moves."""
    tables = {
        "schema": 1,
        "accuracy": {"modes": 2, "nodes": 4},
        "rods": [
            rod("a", "kirchhoff"),
            rod("b", "kirchhoff", 3.0, position=[0.03, 0, 0]),
            rod("c", "kirchhoff", position=[0, 0.05, 0.1]),
        ],
        "bodies": [
            {"name": "head", "mass": 0.01, "radius": 0.01, "inertia": [1e-6, 1e-6, 1e-6]},
            {"name": "wheel", "mass": 0.01, "radius": 0.01, "thickness": 4e-3, "inertia": [1e-6, 1e-6, 1e-6]},
        ],
        "joints": [
            {"body": "head", "rod": "a", "kind": "fixed"},
            {"body": "wheel", "rod": "b", "kind": "fixed"},
        ],
        "obstacles": [
            {
                "name": "ball",
                "kind": "sphere",
                "centre": [0.01, 0.0, 0.005],
                "radius": 0.02,
                "body": "head",
                "rods": ["c"],
                "friction": friction,
            },
            {
                "name": "floor",
                "kind": "plane",
                "point": [0, 0, -0.02],
                "normal": [0.1, 0, 1],
                "rods": ["c"],
                "bodies": ["head", "wheel"],
                "friction": friction,
            },
        ],
    }
    return build(scene_from_dict(tables), moving=True)


def seen_pose(model: Model, touching: TouchingSections, X: float, x: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Centre and axes of a section of a rod, or of a body, in the axes of the obstacle."""
    inputs = model.pack()
    if touching.of_body:
        centre, _, axes = (part.full() for part in model.body[touching.owner](x, inputs))
    else:
        poses = section_poses(model, touching.owner, X, x[None], inputs[None])
        centre = poses.position.T
        axes = quaternion_to_matrix(ca.DM(poses.quaternion[0])).full()
    carrier = touching.obstacle.body
    if carrier is None:
        return centre[:, 0], axes
    origin, _, turned = (part.full() for part in model.body[carrier](x, inputs))
    return turned.T @ (centre - origin)[:, 0], turned.T @ axes


def arm_of(model: Model, touching: TouchingSections, X: float, normal: FloatArray, axes: FloatArray) -> FloatArray:
    """Vector from the centre to the touching point, m."""
    if not touching.of_body:
        return -(BASE_RADIUS + X * (TIP_RADIUS - BASE_RADIUS)) * normal
    (body,) = [body for body in model.scene.bodies if body.name == touching.owner]
    if body.thickness is None:
        return -body.radius * normal
    return np.asarray(disk_reach(ca.DM(normal), ca.DM(axes[:, 2]), body.radius, body.thickness)[1].full()[:, 0])


@pytest.mark.parametrize("friction", [0.4, COEFFICIENTS])
def test_virtual_work_of_friction_vs_differences(friction: Any) -> None:
    """Any state and forces: rods, a ball and a disk on a floor, a rod on an obstacle that a body carries."""
    model = carried(friction)
    smooth = carried(0.0)
    pairs = pairs_of(motion_stage(model, 0.01, sections=1))
    random = np.random.default_rng(4)
    x = 0.05 * random.standard_normal(model.size)
    v, change = random.standard_normal((2, model.size))
    forces = random.uniform(0.5, 2.0, pairs.count)
    still = np.zeros(model.size + pairs.count)
    steady = np.zeros(model.inputs.size)
    arguments = (np.append(x, forces), np.append(v, 0.0 * forces), still, model.pack(), 1e-9, steady, steady)
    without = pairs_of(motion_stage(smooth, 0.01, sections=1))
    residual = (pairs.inverse_dynamics(*arguments) - without.inverse_dynamics(*arguments)).full()[:, 0]
    assert_allclose(residual[model.size :], 0.0, rtol=0, atol=1e-15)
    work = -(residual[: model.size] * model.discrete.unknowns.units) @ change

    def slope(touching: TouchingSections, X: float, offset: FloatArray, along: FloatArray) -> FloatArray:
        ends = [seen_pose(model, touching, X, x + sign * 1e-6 * along) for sign in (1, -1)]
        points = [centre + axes @ offset for centre, axes in ends]
        return (points[0] - points[1]) / 2e-6

    expected = 0.0
    touched = [(touching, X) for touching in pairs.touching for X in touching.places]
    # The base that is held may be struck by the ball, which moves.
    assert [(touching.owner, X) for touching, X in touched[:3]] == [("c", 0.0), ("c", 1.0), ("c", 1.0)]
    assert [touching.owner for touching, _ in touched[3:]] == ["head", "wheel"]
    for (touching, X), newtons in zip(touched, forces * pairs.force_units, strict=True):
        centre, axes = seen_pose(model, touching, X, x)
        normal = surface(touching.obstacle)(centre)[1].full()[:, 0]
        offset = axes.T @ arm_of(model, touching, X, normal, axes)
        velocity = slope(touching, X, offset, v)
        sliding = velocity - (normal @ velocity) * normal
        weighted = 0.4 * sliding
        if friction != 0.4:
            tangent = axes[:, 2] - (normal @ axes[:, 2]) * normal
            tangent /= np.linalg.norm(tangent)
            forward = tangent @ sliding
            coefficient = COEFFICIENTS["along" if forward > 0 else "back"]
            weighted += (coefficient - 0.4) * forward * tangent
        held = -newtons * weighted / np.linalg.norm(sliding)
        expected += held @ slope(touching, X, offset, change)
    assert_allclose(work, expected, rtol=1e-6, atol=0)


def in_turn(
    model: Model, duration: float, count: int, sections: int, *, line_search: bool
) -> tuple[MotionStage, FloatArray]:
    """A stage, and states at the ends of stages from rest, each solved by Newton's method from the one before."""
    stage = motion_stage(model, duration, sections=sections)
    inputs = model.pack()
    state, unknowns, _, smoothing, _ = stage.symbols
    residual = stage.equations.function(state, unknowns, inputs, smoothing, np.zeros(len(inputs)))
    problem = {"x": unknowns, "p": ca.vertcat(state, smoothing), "g": residual}
    newton = ca.rootfinder("newton", "newton", problem, {"line_search": line_search, "abstol": 1e-11, "max_iter": 100})
    states = [stage.state(model.unloaded())]
    guess: Any = stage.still(model.unloaded())
    for _ in range(count):
        for value in SMOOTHINGS:
            guess = newton(x0=guess, p=np.append(states[-1], value))["x"]
        states.append(stage.next_state(states[-1], guess).full()[:, 0])
    return stage, np.array(states)


@pytest.mark.parametrize("friction", [0.3, {"along": 0.3, "back": 0.9, "across": 0.6}])
@pytest.mark.parametrize("steepness", [0.9, 1.5])
def test_a_block_on_a_slope_vs_its_closed_form(steepness: float, friction: Any) -> None:
    """It stays below atan μ, and is accelerated by g (sin α − μ cos α) above."""
    slope = np.arctan(0.3 * steepness)
    downwards = [GRAVITY * np.sin(slope), 0.0, -GRAVITY * np.cos(slope)]
    block = rod("rod", times=1e3, free=True, position=[0, 0, 5e-3]) | {"section": {"shape": "circle", "radius": 5e-3}}
    tables = {
        "schema": 1,
        "accuracy": {"modes": 1, "nodes": 4},
        "rods": [block],
        "loads": [{"name": "weight", "kind": "gravity", "acceleration": downwards}],
        "obstacles": [
            {"name": "floor", "kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1], "friction": friction}
        ],
    }
    model = build(scene_from_dict(tables), moving=True)
    duration, count = 5e-3, 10
    stage, states = in_turn(model, duration, count, sections=2, line_search=True)
    ends = [model.tip["rod"](stage.x(state), model.pack())[0].full()[:, 0] for state in states[[0, -1]]]
    acceleration = max(0.0, GRAVITY * (np.sin(slope) - 0.3 * np.cos(slope)))
    # Euler's implicit method: the k-th stage goes k h² a.
    way = acceleration * duration**2 * count * (count + 1) / 2
    assert_allclose(ends[1] - ends[0], [way, 0.0, 0.0], rtol=1e-4, atol=1e-4 * LENGTH)


@pytest.mark.slow
def test_a_rod_that_rubs_vs_the_simulator() -> None:
    """At a time when friction has moved the tip by many times the error of the stages."""
    row = 17
    tips = {}
    found = {}
    for friction in (0.0, 0.5):
        model = falling(point=[0, 0, -0.006], normal=[0.2, 0, 1], friction=friction)
        motion = simulate(model)
        assert motion.converged, motion.message
        tips[friction] = motion.tip("rod").position[row]
        stage, states = in_turn(model, 1e-3 / 4, 4 * 2 * row, sections=16, line_search=False)
        found[friction] = model.tip["rod"](stage.x(states[-1]), model.pack())[0].full()[:, 0]
    moved = np.linalg.norm(tips[0.5] - tips[0.0])
    assert moved > 2e-3 * LENGTH
    assert np.linalg.norm(found[0.5] - tips[0.5]) < moved / 5
