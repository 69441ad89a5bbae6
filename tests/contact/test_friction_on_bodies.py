"""Friction with bodies: a ball between jaws on paths and in motion, a ball that rolls down an incline, derivatives."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, build, discretise, export, follow, load, read_scene, scene_from_dict, simulate, solve
from cosserat_casadi.accuracy.fixing import unfixed
from cosserat_casadi.codegen.compiled_motion import CompiledMotion, StepState
from cosserat_casadi.equilibrium.rubbing import friction_between
from cosserat_casadi.equilibrium.smooth_contact import smooth_layers
from cosserat_casadi.model.floating_frames import FrameName
from cosserat_casadi.paths.friction_path import FrictionPath
from cosserat_casadi.plots.path_plot import _subtitle
from tests.conftest import ROOT
from tests.families import mostly_slow

PINCH = 2.0
"""Force on each jaw, N."""
FRICTION = 0.4
LIMIT = 2 * FRICTION * PINCH
SPRING = 1000.0
"""Between the ball and the world, along its rail, N/m."""
MASS = 0.05
BALL, JAW, WIDTH, STIFFNESS = 0.03, 5e-3, 2e-3, 2e5
DURATION = 0.02
SLIP = 1e-3


@cache
def vice(spring: float = SPRING, moving: bool = False, **obstacle: Any) -> Model:
    """A ball on an upright rail between two stiff rods that are pressed on it from left and right."""
    stiff = {
        "strain": "planar",
        "section": {"shape": "circle", "radius": JAW},
        "material": {"youngs_modulus": 1e12, "poisson_ratio": 0.3, "density": 1000.0},
    }
    rods, joints, loads = [], [], []
    for side, name in ((-1, "left"), (1, "right")):
        base = {"position": [side * (BALL + JAW + WIDTH / 2), 0, -0.05], "tangent": [0, 0, 1]}
        rods.append({"name": name, "length": 0.1, "base": base, **stiff})
        joints.append({"kind": "prismatic", "rod": name, "at": 0.0, "axis": [1, 0, 0], "stiffness": 1e-2})
        push = {"name": f"push_{name}", "kind": "point_wrench", "rod": name, "at": 0.5}
        loads.append(push | {"force": [-side * PINCH, 0, 0]})
    stem = {"name": "stem", "length": 0.1, "base": {"position": [0, 0, 0.1], "tangent": [0, 0, -1]}, **stiff}
    rods.append(stem | {"section": {"shape": "circle", "radius": 1e-4}})
    joints.append({"kind": "prismatic", "rod": "stem", "at": 0.0, "axis": [0, 0, 1], "stiffness": spring})
    joints.append({"kind": "fixed", "rod": "stem", "body": "ball"})
    sphere = {"name": "skin", "kind": "sphere", "centre": [0, 0, 0], "radius": BALL, "body": "ball"}
    sphere |= {"rods": ["left", "right"], "width": WIDTH, "stiffness": STIFFNESS, "friction": FRICTION} | obstacle
    scene = scene_from_dict(
        {
            "schema": 1,
            "rods": rods,
            "bodies": [{"name": "ball", "mass": MASS}],
            "joints": joints,
            "loads": [*loads, {"name": "pull", "kind": "body_wrench", "body": "ball", "force": [0, 0, 0]}],
            "obstacles": [sphere],
            "simulation": {"duration": DURATION, "start": "equilibrium", "tolerance": 1e-3},
            "motions": [{"input": "pull.force", "times": [0, 1e-3], "values": [[0, 0, 0], [0, 0, -2 * LIMIT]]}],
        }
    )
    return build(scene.with_motion_inputs() if moving else scene, discretise(scene, 1, 6), moving=moving)


def pulled(force: float, first: FrictionPath | None = None) -> FrictionPath:
    path = follow(vice(), "pull.force", [0, 0, -force], first=first)
    assert isinstance(path, FrictionPath)
    assert path.converged, path.message
    return path


@pytest.mark.slow
def test_a_ball_between_jaws_is_held_up_to_twice_the_pinch_times_the_coefficient() -> None:
    """Below the jaws bear the pull; above the spring bears what is beyond, and the jaws rub with their limit."""
    stuck, slid = pulled(0.8 * LIMIT), pulled(1.5 * LIMIT)
    assert abs(stuck.position(1.0, "stem")[-1, 2]) < 0.3 * LIMIT / SPRING
    # Where it presses least it slips already.
    assert not all(stretch.slips for stretch in stuck.rubbing(-1))
    assert_allclose(slid.position(1.0, "stem")[-1, 2], -0.5 * LIMIT / SPRING, rtol=1e-3, atol=0)
    assert {(stretch.rod, stretch.slips) for stretch in slid.rubbing(-1)} == {("left", True), ("right", True)}
    for contact, side in zip(slid.solution(-1).contacts, (-1, 1), strict=True):
        assert_allclose(contact.force[[0, 2]], [side * PINCH, -FRICTION * PINCH], rtol=2e-2, atol=0)


def test_a_ball_that_is_let_go_sticks_where_it_is() -> None:
    """The spring pulls it back less than the jaws hold."""
    slid = pulled(1.5 * LIMIT)
    back = pulled(0.0, first=slid)
    assert -0.5 * LIMIT / SPRING < back.position(1.0, "stem")[-1, 2] < -0.2 * LIMIT / SPRING
    assert not all(stretch.slips for stretch in back.rubbing(-1))


@pytest.mark.slow
def test_a_ball_is_pulled_from_between_jaws_as_a_point_mass() -> None:
    """With the pull less what the jaws rub with; that takes force times way, and nothing is missing."""
    motion = simulate(vice(1e-6, True))
    assert motion.converged, motion.message
    heights = motion.tip("stem").position[:, 2]
    late = motion.times > 0.004
    acceleration = np.polyfit(motion.times[late], heights[late], 2)[0] * 2
    # The stem is one thousandth of the ball.
    assert_allclose(acceleration, -LIMIT / MASS, rtol=5e-3, atol=0)
    # So soft a spring leaves the height of the equilibrium at the start to rounding.
    assert_allclose(motion.energy.dissipated[-1], LIMIT * (heights[0] - heights[-1]), rtol=2e-2, atol=0)
    assert np.abs(motion.energy.imbalance).max() < 1e-3
    assert all(stretch.slips for stretch in motion.rubbing(len(motion.times) - 1))


def test_derivatives_are_those_of_differences() -> None:
    model = vice.__wrapped__(1e-6, True, damping=0.3, friction={"along": 0.2, "back": 0.3, "across": 0.5})
    rng = np.random.default_rng(2)
    x, v, a = (size * rng.standard_normal(model.size) for size in (1e-5, 1e-1, 0.0))
    symbols = [ca.MX.sym(name, model.size) for name in "xv"]
    rest = np.zeros(model.inputs.size)
    residual = model.inverse_dynamics(*symbols, a, model.pack(), rest, rest)
    directions = [ca.DM(rng.standard_normal(model.size)) for _ in range(2)]
    changes = [ca.jtimes(residual, symbol, way) for symbol, way in zip(symbols, directions, strict=True)]
    automatic = ca.Function("automatic", symbols, changes)(x, v)
    written = model.dynamics_jacobian(x, v, a, model.pack(), rest, rest)[:2]
    for matrix, way, change in zip(written, directions, automatic, strict=True):
        wanted = np.asarray(change)
        assert_allclose(np.asarray(matrix @ way), wanted, rtol=0, atol=1e-11 * np.abs(wanted).max())
    taken = model.powers(x, v, a, model.pack(), rest, rest)[0]
    assert float(taken) > 0


def rolling(friction: float) -> Model:
    """A ball that lies on a plane whose gravity leans by 0.4 rad, with a free stem that weighs next to nothing."""
    radius, width, stiffness, mass = 0.05, 1e-3, 1e5, 0.1
    weight = mass * 9.81 * np.cos(0.4)
    gap = width - np.cbrt(3 * weight * width**2 / (stiffness * 2 * radius))
    stem = {
        "name": "stem",
        "length": 0.02,
        "strain": "planar",
        "section": {"shape": "circle", "radius": 1e-3},
        "material": {"youngs_modulus": 1e9, "poisson_ratio": 0.3, "density": 1.0},
        "base": {"position": [0, 0, radius + gap], "tangent": [0, 1, 0]},
    }
    plane = {"name": "plane", "kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1], "bodies": ["ball"]}
    plane |= {"width": width, "stiffness": stiffness, "friction": friction, "slip_speed": SLIP}
    gravity = [9.81 * np.sin(0.4), 0, -9.81 * np.cos(0.4)]
    scene = scene_from_dict(
        {
            "schema": 1,
            "rods": [stem],
            "bodies": [{"name": "ball", "mass": mass, "radius": radius, "inertia": [0.4 * mass * radius**2] * 3}],
            "joints": [{"kind": "fixed", "rod": "stem", "at": 0.0, "body": "ball"}],
            "obstacles": [plane],
            "loads": [{"name": "weight", "kind": "gravity", "acceleration": gravity}],
            "simulation": {"duration": 0.1, "start": "unloaded", "tolerance": 1e-4},
        }
    )
    return build(scene, discretise(scene, 1, 2), moving=True)


@pytest.mark.parametrize("friction", mostly_slow([0.1, 0.5], quick=[0.1]))
def test_a_ball_slides_or_rolls_down_an_incline(friction: float) -> None:
    """At g (sin − μ cos), or at 5/7 g sin where friction holds the point that touches."""
    motion = simulate(rolling(friction))
    assert motion.converged, motion.message
    way = motion.body("ball").position[-1, 0] - motion.body("ball").position[0, 0]
    slides, rolls = 9.81 * (np.sin(0.4) - friction * np.cos(0.4)), 5 / 7 * 9.81 * np.sin(0.4)
    assert_allclose(way, max(slides, rolls) * 0.1**2 / 2, rtol=1.5e-2, atol=0)
    assert np.abs(motion.energy.imbalance).max() < 1e-3


@pytest.mark.slow  # three paths
def test_a_gripper_holds_a_ball_by_the_friction_of_its_fingers() -> None:
    """Where all fingers slip each rubs with the coefficient times its push, and the pin bears what all three hold.

    More tension holds more. What the machine reads falls as the ball leaves the fingers.
    """
    model = build(read_scene(ROOT / "examples" / "gripper.toml"))
    held = []
    for tension in (4.0, 5.0, 6.0):
        start = {f"flexor_{number}.tension": tension for number in (1, 2, 3)} | {"pin.base.position": [0, 0, -0.15]}
        path = follow(model, "pin.base.position", [0, 0, -0.154], start)
        assert path.converged, path.message
        assert path.section("pin") == 1.0  # nothing else holds the ball at its tip
        solutions = [path.solution(row) for row in range(len(path.factor))]
        pulls = np.array([-found.base_wrench("pin").force[2] for found in solutions])
        peak = int(pulls.argmax())
        assert 0 < peak < len(pulls) - 1 and pulls[-1] < pulls[peak]
        end = solutions[-1]
        assert all(stretch.slips for stretch in path.rubbing(-1)) and len(end.contacts) == 3
        assert_allclose(sum(contact.force[2] for contact in end.contacts), -pulls[-1], rtol=1e-2, atol=0)
        for layer, contact in zip(smooth_layers(end), end.contacts, strict=True):
            rubbing = friction_between(end.model, layer, end.x, end.inputs, (contact.start, contact.end))
            pushing = contact.force - rubbing
            assert_allclose(np.linalg.norm(rubbing) / np.linalg.norm(pushing), 0.5, rtol=2e-2, atol=0)
        held.append(pulls[peak])
    assert np.all(np.diff(held) > 0.1)


@pytest.mark.slow  # a compilation
def test_dynamics_in_c_are_those_of_python(tmp_path: Path) -> None:
    """Balance of a ball that slides on a plane and turns; steps roll it down the incline."""
    model = rolling(0.5)
    library = load(export(model, tmp_path / "ball", dynamics=True))
    assert isinstance(library, CompiledMotion)
    rng = np.random.default_rng(4)
    x, v, a = (size * rng.standard_normal(model.size) for size in (1e-5, 1e-1, 1.0))
    inputs = model.pack()
    still = np.zeros_like(inputs)
    wanted = np.asarray(model.inverse_dynamics(x, v, a, inputs, still, still)).ravel()
    found = library.inverse_dynamics(StepState(x, v, a), inputs)
    assert_allclose(found, wanted, rtol=1e-9, atol=1e-11 * np.abs(wanted).max())
    start = library.rest()
    assert start is not None
    taken, _, _ = library.steps(start, 2e-3, 50, inputs)
    assert taken.done
    frame = FrameName("body", "ball")
    way = (taken.state.x - start.x)[model.discrete.deviation(frame)][0] * model.discrete.frames[frame].length
    assert_allclose(way, 5 / 7 * 9.81 * np.sin(0.4) * 0.1**2 / 2, rtol=1.5e-2, atol=0)


def test_a_path_of_a_body_that_rubs_has_no_friction_and_says_so() -> None:
    """Bodies rub in motion alone: the path is that of the scene without friction."""
    rod = {
        "name": "rod",
        "length": 0.1,
        "strain": "planar",
        "base": {"tangent": [1, 0, 0]},
        "material": {"youngs_modulus": 2e6, "poisson_ratio": 0.45, "density": 1100.0},
        "section": {"shape": "circle", "radius": 5e-3},
    }
    floor = {"name": "floor", "kind": "plane", "point": [0, 0, -0.02], "normal": [0, 0, 1], "bodies": ["head"]}
    tables = {
        "schema": 1,
        "rods": [rod],
        "bodies": [{"name": "head", "mass": 0.01, "radius": 0.01}],
        "joints": [{"body": "head", "rod": "rod", "kind": "fixed"}],
        "loads": [{"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0, 0, 0]}],
        "inputs": ["push.force"],
        "accuracy": {"modes": 3, "nodes": 6},
    }
    smooth = floor | {"width": 4e-3}
    paths = [
        follow(build(scene_from_dict(tables | {"obstacles": [obstacle]})), "push.force", [0.0, 0.0, -0.1])
        for obstacle in (smooth | {"friction": 0.3}, smooth)
    ]
    assert all(path.converged for path in paths)
    assert_allclose(paths[0].tip("rod").position[-1], paths[1].tip("rod").position[-1], rtol=0, atol=1e-9)
    assert "Friction of bodies and disks acts in motion alone" in paths[0].message
    assert "riction" not in paths[1].message
    assert [_subtitle(path) for path in paths] == ["no limit, no bifurcation"] * 2
    # Refined, its points lie as far apart as without friction: no increment has an error to show.
    bare = {key: value for key, value in tables.items() if key != "accuracy"} | {"accuracy": {"tolerance": 1e-2}}
    refined = [
        follow(scene_from_dict(bare | {"obstacles": [obstacle]}), "push.force", [0.0, 0.0, -0.1])
        for obstacle in (smooth | {"friction": 0.3}, smooth)
    ]
    assert_allclose(refined[0].factor, refined[1].factor, rtol=0, atol=1e-9)
    pushed = tables | {"loads": [{**tables["loads"][0], "force": [0, 0, -0.1]}]}
    scene = scene_from_dict(pushed | {"obstacles": [smooth | {"friction": 0.3}]})
    for solution in (solve(build(scene)), solve(scene), solve(unfixed(scene, 1e-2))):
        assert solution.contacts and "Friction of bodies and disks acts in motion alone" in solution.message
