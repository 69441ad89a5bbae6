"""What a tolerance binds beside the places of tips: how sections turn about their tangents, and how bodies turn."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from cosserat_casadi import Motion, parse_scene, scene_from_dict, simulate
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import build
from cosserat_casadi.motion.displacement import LEVER
from cosserat_casadi.motion.simulate import Simulator, started
from cosserat_casadi.motion.tip_paths import Paths, path_distance, paths, watched_arms
from cosserat_casadi.scene.constraint_records import Body
from tests.families import mostly_slow
from tests.motion.transients import Table, gravity, table

# A rod that is twisted at its tip by A (1 − cos Ω t)

TORSION = 2.0  # N m²
TURNING_MASS = 0.02  # kg m
TWIST = 0.1  # N m
FREQUENCY = 1.5  # Hz


def twisted(tolerance: float) -> Table:
    rod = {
        "strain": "kirchhoff",
        "stiffness": {"bending_x": 1.0, "bending_y": 1.0, "torsion": TORSION},
        "rotary_inertia": [0.01, 0.01, TURNING_MASS],
        "base": {},
    }
    twist = {"name": "twist", "kind": "tip_wrench", "rod": "rod", "moment": [0, 0, 0]}
    wave = {"wave": "one_minus_cosine", "frequency": FREQUENCY, "amplitude": [0, 0, TWIST], "input": "twist.moment"}
    simulation = {"duration": 1.0, "frames": 41, "tolerance": tolerance}
    return table(rod, twist, motions=[wave], simulation=simulation)


def twist_of_the_tip(times: FloatArray) -> FloatArray:
    """Turn of the tip, shape (T,), rad: the static one, and what the modes of the wave equation lag behind it.

    Mode n is sin((2n − 1) π X / 2) and swings at ω = (2n − 1) π/2 √(GJ / ρI); the length is 1.
    """
    swings = (np.arange(1, 2001) - 0.5) * np.pi * np.sqrt(TORSION / TURNING_MASS)
    driven = 2 * np.pi * FREQUENCY
    shares = 2 * TWIST / TURNING_MASS * driven**2 / (swings**2 * (swings**2 - driven**2))
    lags = (np.cos(driven * times)[:, None] - np.cos(np.outer(times, swings))) @ shares
    return np.asarray(TWIST / TORSION * (1 - np.cos(driven * times)) - lags)


@pytest.mark.parametrize("tolerance", mostly_slow([1e-3, 1e-5], quick=[1e-3]))
def test_a_rod_that_only_twists_is_as_exact_as_it_says(tolerance: float) -> None:
    """Its tip stays where it is: what it is turned by counts on an arm of LEVER lengths."""
    motion = simulate(scene_from_dict(twisted(tolerance)))
    assert motion.converged, motion.message
    quaternion = motion.tip().quaternion
    assert_allclose(motion.tip().position, np.tile([0.0, 0.0, 1.0], (41, 1)), rtol=0, atol=1e-12)
    turn = 2 * np.arctan2(quaternion[:, 3], quaternion[:, 0])
    error = LEVER * np.abs(turn - twist_of_the_tip(motion.times)).max()
    # Not below what the reference itself is off by.
    assert 1e-10 < error <= motion.error_estimate <= tolerance


# A body that hangs by a corner

MASS = 0.5
CENTRE = np.array([0.2, 0.05, -0.03])
INERTIA = np.array([[2e-3, 3e-4, -4e-4], [3e-4, 4e-3, 5e-4], [-4e-4, 5e-4, 3e-3]])


def hung(tolerance: float) -> Motion:
    """The body on a ball joint at the tip of a rod that does not move, let go."""
    rod = {"strain": ["torsion"], "stiffness": {"torsion": 1.0}, "base": {}}
    body = {"name": "bob", "mass": MASS, "centre_of_mass": CENTRE.tolist(), "inertia": INERTIA.tolist()}
    joint = {"body": "bob", "rod": "rod", "kind": "spherical"}
    simulation = {"duration": 1.0, "frames": 21, "tolerance": tolerance, "start": "unloaded"}
    scene = table(rod, gravity(9.81), bodies=[body], joints=[joint], simulation=simulation)
    motion = simulate(scene_from_dict(scene))
    assert motion.converged, motion.message
    return motion


def centre_of_the_pendulum(times: FloatArray) -> FloatArray:
    """Centre of mass from the joint, shape (T, 3), m: Euler's equations in the axes of the body, by DOP853."""
    about_joint = INERTIA + MASS * (CENTRE @ CENTRE * np.eye(3) - np.outer(CENTRE, CENTRE))

    def rate(_: float, state: FloatArray) -> FloatArray:
        world_R_body, spin = state[:9].reshape(3, 3), state[9:]
        weight = np.cross(CENTRE, world_R_body.T @ [0.0, 0.0, -9.81 * MASS])
        spin_rate = np.linalg.solve(about_joint, weight - np.cross(spin, about_joint @ spin))
        turning = np.cross(world_R_body, spin)
        return np.concatenate([turning.ravel(), spin_rate])

    start = np.concatenate([np.eye(3).ravel(), np.zeros(3)])
    found = solve_ivp(rate, (0.0, 1.0), start, method="DOP853", rtol=1e-11, atol=1e-12, t_eval=times)
    return np.asarray(found.y[:9].T.reshape(-1, 3, 3) @ CENTRE)


@pytest.mark.parametrize("tolerance", mostly_slow([1e-3, 1e-5], quick=[1e-3]))
def test_a_body_about_its_origin_is_as_exact_as_it_says(tolerance: float) -> None:
    """The origin of the body is its joint, and stays: its centre of mass is what swings. Products of inertia count."""
    motion = hung(tolerance)
    poses = motion.body("bob")
    assert_allclose(poses.position, np.tile([0.0, 0.0, 1.0], (21, 1)), rtol=0, atol=1e-10)
    centre = Rotation.from_quat(poses.quaternion[:, [1, 2, 3, 0]]).apply(CENTRE)
    error = np.linalg.norm(centre - centre_of_the_pendulum(motion.times), axis=1).max()
    # Not below what the reference itself is off by.
    assert 1e-10 < error <= motion.error_estimate <= tolerance


# A rod in a loop

LOOP = """
schema = 1
inputs = ["crank.angle"]

[[rods]]
name = "coupler"
length = 0.3
strain = "planar"
stiffness = { bending_y = 0.0126 }
linear_density = 0.0145
base = { tangent = [1, 0, 0] }

[[bodies]]
name = "arm"
mass = 0.02
inertia = [1e-6, 1e-6, 1e-6]

[[bodies]]
name = "slider"
mass = 0.02
inertia = [1e-6, 1e-6, 1e-6]

[[joints]]
name = "crank"
kind = "revolute"
axis = [0, 1, 0]
angle = 0.0
between = [{ world = true, position = [0, 0, 0] }, { body = "arm" }]

[[joints]]
kind = "revolute"
axis = [0, 1, 0]
between = [{ body = "arm", position = [0.1, 0, 0] }, { rod = "coupler", at = 0.0 }]

[[joints]]
kind = "revolute"
axis = [0, 1, 0]
between = [{ rod = "coupler" }, { body = "slider" }]

[[joints]]
kind = "prismatic"
axis = [1, 0, 0]
between = [{ world = true, position = [0.4, 0, 0] }, { body = "slider" }]

[[motions]]
input = "crank.angle"
times = [0.0, 0.5]
values = [0.0, -6.283]
interpolation = "cubic"
"""


def coupler(tolerance: float) -> tuple[FloatArray, Motion]:
    """The middle of a rod between a crank and a slider over its length, shape (T, 3), and its motion."""
    motion = simulate(parse_scene(LOOP + f"\n[simulation]\nduration = 0.5\nframes = 101\ntolerance = {tolerance}\n"))
    assert motion.converged, motion.message
    return motion.section("coupler", 0.5).position / 0.3, motion


@pytest.mark.parametrize("tolerance", mostly_slow([1e-2, 1e-4], quick=[1e-2]))
def test_a_rod_that_joints_hold_at_both_ends_is_watched_between_them(tolerance: float) -> None:
    """Its ends go where crank and slider go: told of them alone, the error at 1e-4 was a tenth of its middle's."""
    found, motion = coupler(tolerance)
    expected, _ = coupler(tolerance / 100)
    error = np.linalg.norm(found - expected, axis=1).max()
    assert 1e-6 < error <= motion.error_estimate <= tolerance


# Distances


def test_a_turn_about_the_tangent_is_all_that_axes_are_compared_by() -> None:
    """What tips lean is left to their places: a roll of 0.3 rad beside it counts as such."""
    axes = Rotation.from_rotvec([0.2, -0.5, 0.9])
    rolled = axes * Rotation.from_rotvec([0.0, 0.0, -0.3])
    leaning = axes * Rotation.from_rotvec([1e-4, -2e-4, 0.0])
    assert_allclose(path_distance(_still(axes), _still(rolled)), 0.3 * LEVER, rtol=1e-12, atol=0)
    assert path_distance(_still(axes), _still(leaning)) < 1e-7
    assert path_distance(_still(axes), _still(axes)) < 1e-16


def _still(rotation: Rotation) -> Paths:
    """The tip of one rod at one time, at the origin."""
    return Paths(np.zeros((1, 1, 3)), rotation.as_matrix().T[None, None, :2])


def test_points_of_bodies_that_are_followed() -> None:
    """Centre of mass, and around it the radius of gyration; of moments of inertia alone a tenth of the longest rod."""
    heavy = Body(name="heavy", mass=MASS, centre_of_mass=tuple(CENTRE), inertia=INERTIA.tolist())
    weightless = Body(name="weightless", mass=0.0, inertia=INERTIA.tolist())
    radius = np.sqrt(np.trace(INERTIA) / (2 * MASS))
    origin = np.zeros(3)
    assert_allclose(watched_arms(heavy, 2.0), [origin, CENTRE, *(CENTRE + radius * np.eye(3))], rtol=1e-15, atol=0)
    assert_allclose(watched_arms(weightless, 2.0), [origin, *(2.0 * LEVER * np.eye(3))], rtol=1e-15, atol=0)
    assert_allclose(watched_arms(Body(name="light"), 2.0), [origin], rtol=0, atol=0)


def test_a_base_that_is_free_is_watched_too() -> None:
    """A rod that slaps on a table by its base moves its tip little: the base falls as a stone does until then."""
    start = np.array([0.1, 0.2, 0.3])
    rod = {
        "strain": "planar",
        "base": {"position": start.tolist(), "tangent": [1, 0, 0], "free": True},
        "rotary_inertia": [1e-3, 1e-3, 1e-3],
    }
    simulation = {"duration": 0.1, "frames": 2, "tolerance": 1e-3, "start": "unloaded"}
    scene = scene_from_dict(table(rod, gravity(9.81), accuracy={"modes": 1, "nodes": 6}, simulation=simulation))
    assert scene.simulation is not None
    model = build(scene.with_motion_inputs(), moving=True)
    history = Simulator(model, scene.simulation, started(model, scene.simulation, None)).controlled(1e-3)
    times = np.linspace(0.0, 0.1, 5)
    tip, base = np.moveaxis(paths(history.model, *history.rough_positions(times)).points, 1, 0)
    fallen = np.outer(-0.5 * 9.81 * times**2, [0.0, 0.0, 1.0])
    assert_allclose(base, start + fallen, rtol=0, atol=1e-9)
    assert_allclose(tip, base + np.array([1.0, 0.0, 0.0]), rtol=0, atol=1e-9)


# Rods whose lengths are inputs, beside others


def test_paths_are_over_the_length_that_an_input_gives_a_rod() -> None:
    """Two straight rods in series with a body at the end, the first one drawn out: places over the length of each."""
    rod = {"strain": "kirchhoff", "stiffness": {"bending_x": 1.0, "bending_y": 1.0, "torsion": 1.0}}
    tables = {
        "schema": 1,
        "inputs": ["first.length"],
        "accuracy": {"modes": 2, "nodes": 6},
        "rods": [
            {"name": "first", "length": 0.5, "linear_density": 1.0, **rod},
            {"name": "second", "length": 0.2, "linear_density": 1.0, "base": {"rod": "first", "at": 1.0}, **rod},
        ],
        "bodies": [{"name": "ball", "mass": 0.1}],
        "joints": [{"kind": "fixed", "body": "ball", "rod": "second"}],
    }
    model = build(scene_from_dict(tables))
    lengths = np.array([[0.5], [0.6], [0.8]])
    points = paths(model, np.zeros((3, model.size)), lengths).points
    first_tip = points[:, 0]
    assert_allclose(first_tip, np.tile([0.0, 0.0, 1.0], (3, 1)), rtol=0, atol=1e-12)
    # The body, whose frame stays where it is, over the longest rod.
    assert_allclose(points[:, -1, 2], 0.7 / lengths[:, 0], rtol=1e-12, atol=0)
