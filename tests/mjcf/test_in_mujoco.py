"""Chains in MuJoCo beside rods: equilibria, frequencies, constraints and contacts."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import build, modes_of, parse_scene, solve
from tests.mjcf.moved_chains import FINGER, LOOPS, ROD, SCENES, WEIGHT

pytest.importorskip("mujoco", reason="MuJoCo is not installed: pip install 'cosserat-casadi[mujoco]'")

import mujoco

from cosserat_casadi.mjcf.export import mjcf_of
from tests.families import mostly_slow
from tests.mjcf.chains import Chain, error_in_loop, settled


@pytest.mark.parametrize("case", mostly_slow(SCENES, quick=["in space", "jointed"]))
def test_shape_and_frequencies_have_the_second_order(case: str) -> None:
    scene = parse_scene(SCENES[case])
    model = build(scene)
    solution = solve(model)
    assert solution.converged
    expected = np.array([mode.frequency for mode in modes_of(model, count=2).modes])
    of_tip = []
    of_frequency = []
    for links in (8, 16):
        chain = Chain(scene, links)
        gaps = [np.linalg.norm(chain.tip(rod.name) - solution.tip(rod.name).position) for rod in scene.rods]
        of_tip.append(max(gaps) / 0.3)
        of_frequency.append(np.abs(chain.frequencies(2) / expected - 1.0).max())
    assert of_tip[1] < 1e-2, of_tip
    assert of_frequency[1] < 1e-2, of_frequency
    for errors in (of_tip, of_frequency):
        assert 3.3 < errors[0] / errors[1] < 8.0, (of_tip, of_frequency)


def test_a_point_mass_on_a_hinge_swings_with_its_period() -> None:
    """MuJoCo moves nothing without inertia: what it gets for that, the least of what is told, changes no period."""
    text = (
        FINGER
        + WEIGHT.replace("[1.0, 2.0, -9.81]", "[0.0, 0.0, -9.81]")
        + """
[[bodies]]
name = "bob"
mass = 0.5
centre_of_mass = [0.0, 0.0, -0.4]
[[joints]]
name = "pivot"
kind = "revolute"
between = [{ world = true, position = [1.0, 0.0, 0.0] }, { body = "bob" }]
axis = [0, 1, 0]
"""
    )
    scene = parse_scene(text)
    rate = np.sqrt(9.81 / 0.4)
    chain = Chain(scene, 2)
    assert_allclose(chain.frequencies(1), rate / (2 * np.pi), rtol=1e-8, atol=0)
    chain.data.joint("pivot").qpos[0] = 1e-3
    duration = 0.5
    chain.model.opt.timestep = 1e-4
    for _ in range(5000):
        mujoco.mj_step(chain.model, chain.data)
    assert_allclose(chain.data.joint("pivot").qpos[0], 1e-3 * np.cos(rate * duration), rtol=0, atol=2e-6)
    assert [told for told in mjcf_of(scene, 2).left_out if told.startswith("bob: has moments of inertia")]


def test_held_tips_and_cables_of_given_length_are_led_there() -> None:
    text = (
        FINGER.replace("kirchhoff", "planar")
        + """
[[supports]]
rod = "finger"
kind = "clamped"
position = [0.12, 0.0, 0.26]
quaternion = [1, 0, 0, 0]
"""
    )
    scene = parse_scene(text)
    _, data = settled(scene, 16, 1.0)
    assert_allclose(data.site("finger/tip").xpos, [0.12, 0.0, 0.26], rtol=0, atol=2e-4)
    middle = solve(build(scene)).pose(0.5).position
    assert_allclose(data.body("finger/8").xpos, middle, rtol=0, atol=1e-3)

    text = (
        FINGER
        + """
[[actuators]]
name = "east"
kind = "tendon"
rod = "finger"
length = 0.29
slack = true
offset = [8e-3, 0.0]
[[actuators]]
name = "west"
kind = "tendon"
rod = "finger"
length = 0.312
slack = true
offset = [-8e-3, 0.0]
"""
    )
    scene = parse_scene(text)
    _, data = settled(scene, 16, 1.0)
    solution = solve(build(scene))
    # The second is slack, and does not push.
    assert_allclose(data.ten_length[1], solution.actuator("west")["length"], rtol=0, atol=4e-4)
    assert data.ten_length[1] < 0.3115 and data.actuator_force[1] == 0.0
    assert_allclose(data.site("finger/tip").xpos, solution.tip().position, rtol=0, atol=3e-3)


@pytest.mark.parametrize("case", LOOPS)
def test_loops_begin_closed_and_stay_at_the_equilibrium(case: str) -> None:
    scene = parse_scene(LOOPS[case])
    solution = solve(build(scene))
    assert solution.converged
    errors = [error_in_loop(solution, links) for links in (10, 20)]
    assert errors[1] < 1e-3, errors
    assert errors[0] / errors[1] > 3.8, errors


def test_drives_of_loops_keep_their_turns() -> None:
    text = LOOPS["slider-crank"].replace("angle = 0.3", "angle = 6.5831853")
    key = ET.fromstring(mjcf_of(parse_scene(text), 4).text).find("keyframe/key")
    assert key is not None
    assert_allclose(float(key.get("qpos", "").split()[0]), 6.5831853, rtol=0, atol=1e-9)


def test_rods_stay_out_of_the_obstacles_that_name_them() -> None:
    table = '[[obstacles]]\nname = "table"\nkind = "plane"\npoint = [0, 0, -0.02]\nnormal = [0, 0, 1]\nrods = ["{}"]\n'
    rods = FINGER.replace("2e9", "2e6") + "base = { tangent = [1, 0, 0] }\n"
    rods += ROD.format(name="other", strain="planar") + "base = { position = [0, 1, 0], tangent = [1, 0, 0] }\n"
    heights = {}
    for name in ("finger", "other"):
        scene = parse_scene(rods + WEIGHT + table.format(name))
        _, data = settled(scene, 16, 0.5, damping=0.05)
        heights[name] = min(data.body(f"finger/{number}").xpos[2] for number in range(1, 17))
    assert heights["finger"] == pytest.approx(-0.02 + 3e-3, abs=1e-3)
    assert heights["other"] < -0.05
