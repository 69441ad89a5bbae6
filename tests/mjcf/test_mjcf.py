"""Models of MuJoCo as files: controls, the order of hinges, and sentences on what they do not have."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import parse_scene, scene_from_dict
from cosserat_casadi.errors import SceneError
from cosserat_casadi.mjcf.export import mjcf_of
from tests.commands import cosserat_line
from tests.mjcf.moved_chains import FINGER, SCENES, WEIGHT
from tests.model.test_joints_of_bodies import pendulum


def test_all_that_is_left_out_is_named() -> None:
    text = (
        FINGER
        + WEIGHT
        + """
[[loads]]
name = "wind"
kind = "distributed_wrench"
rod = "finger"
force = [1, 0, 0]
[[actuators]]
name = "bender"
kind = "muscle"
rod = "finger"
moment = [0, 1e-3, 0]
[[actuators]]
name = "cable"
kind = "tendon"
rod = "finger"
length = 0.3
friction = 0.2
offset = [5e-3, 0]
[[obstacles]]
name = "vessel"
kind = "lumen"
points = [[0, 0, -0.1], [0, 0, 0.4]]
radius = 0.02
width = 1e-3
[[motions]]
input = "cable.length"
times = [0, 1]
values = [0.3, 0.29]
"""
    )
    text = text.replace("[[loads]]", "damping = { retardation_time = 0.01, mass_proportional = 1.0 }\n[[loads]]", 1)
    model = mjcf_of(parse_scene(text), 4)
    told = [sentence.split(":")[0] for sentence in model.left_out]
    assert told == [
        "vessel",
        "wind",
        "bender",
        "cable",
        "cable",
        "finger",
        "cable.length",
        "obstacles",
    ]
    comment = ET.fromstring(model.text, parser=ET.XMLParser(target=ET.TreeBuilder(insert_comments=True)))[0].text
    assert comment is not None
    assert all(sentence in comment for sentence in model.left_out)
    damping = [float(joint.get("damping", "0")) for joint in ET.fromstring(model.text).iter("joint")]
    stiffness = [float(joint.get("stiffness", "0")) for joint in ET.fromstring(model.text).iter("joint")]
    assert_allclose(damping, 0.01 * np.array(stiffness), rtol=1e-9, atol=0)


@pytest.mark.parametrize(("strain", "told"), [("reissner", True), ("kirchhoff", True), ("planar", False)])
def test_a_channel_that_may_twist_or_shear_is_told(strain: str, told: bool) -> None:
    """MuJoCo's tendon is as long as the channel; the volume counts along the normals of the sections alone."""
    chamber = """
[[actuators]]
name = "channel"
kind = "chamber"
rod = "finger"
pressure = 1e4
area = 1e-5
offset = [5e-3, 0]
"""
    model = mjcf_of(parse_scene(FINGER.replace("kirchhoff", strain) + chamber), 4)
    assert [sentence.split(":")[0] for sentence in model.left_out] == ["channel"] * told


def test_a_stiffness_that_couples_strains_is_told() -> None:
    coupled = "[[2.0, 0.5, 0, 0, 0, 0], [0.5, 3.0, 0, 0, 0, 0], " + ", ".join(
        str([0] * k + [1e4] + [0] * (5 - k)) for k in range(2, 6)
    )
    text = f"""
schema = 1
[[rods]]
name = "finger"
length = 0.3
strain = "kirchhoff"
linear_density = 0.1
stiffness_matrix = {coupled}]
"""
    told = mjcf_of(parse_scene(text), 4).left_out
    assert any("the rest of the law, and its coupling, is missing" in sentence for sentence in told), told


def test_inputs_are_controls_with_the_values_of_the_scene() -> None:
    root = ET.fromstring(mjcf_of(parse_scene(SCENES["jointed"]), 4).text)
    actuators = root.find("actuator")
    key = root.find("keyframe/key")
    assert actuators is not None
    assert key is not None
    values = dict(zip([a.get("name") for a in actuators], key.get("ctrl", "").split(), strict=True))
    assert values == {
        "elbow.force": "0.3",
        "wrist.moment": "0.01",
        "grip.force.x": "0.1",
        "grip.force.y": "0",
        "grip.force.z": "0.1",
    }


def test_stops_are_ranges() -> None:
    model = mjcf_of(parse_scene(SCENES["jointed"].replace("rest = 0.3\n", "rest = 0.3\nupper_stop = 0.8\n")), 4)
    (joint,) = [joint for joint in ET.fromstring(model.text).iter("joint") if joint.get("name") == "shoulder"]
    assert [float(end) for end in joint.get("range", "").split()] == [-1e6, 0.8]
    assert [sentence for sentence in model.left_out if sentence.startswith("shoulder: its stops")]


def test_bodies_hang_on_bodies_and_on_the_world() -> None:
    root = ET.fromstring(mjcf_of(scene_from_dict(pendulum()), 2).text)
    upper = root.find("worldbody/body[@name='upper']")
    assert upper is not None
    lower = upper.find("body[@name='lower']")
    assert lower is not None
    assert upper.get("pos") == "0 0 1"
    assert lower.get("pos") == "0 0 -0.5"
    hinge = lower.find("joint")
    assert hinge is not None
    assert [hinge.get(key) for key in ("name", "type", "axis", "stiffness")] == ["elbow", "hinge", "0 1 0", "0.3"]


def test_refusals() -> None:
    with pytest.raises(SceneError, match="finger: has no mass"):
        mjcf_of(parse_scene(FINGER.replace(", density = 1100.0", "")))


def test_command(tmp_path: Path) -> None:
    scene = tmp_path / "finger.toml"
    scene.write_text(SCENES["pulled"].replace("tension = 4.0", "length = 0.29"))
    ended = cosserat_line("cosserat export finger.toml --mjcf finger.xml --links 6", tmp_path)
    assert ended.returncode == 0, ended.stderr
    assert "east: the cable of given length is one of" in ended.stderr
    assert "finger.xml; MuJoCo opens it" in ended.stdout
    assert ET.parse(tmp_path / "finger.xml").getroot().tag == "mujoco"
    refused = cosserat_line("cosserat export finger.toml --mjcf finger.txt", tmp_path)
    assert refused.returncode == 2
    assert "does not end in .xml or .mjcf" in refused.stderr


def test_neighbours_have_hinges_in_opposite_order() -> None:
    """Rotations do not commute: what an order adds to a strain, the reverse takes away."""
    scene = parse_scene(FINGER)
    bodies = [body for body in ET.fromstring(mjcf_of(scene, 4).text).iter("body") if body.find("joint") is not None]
    orders = [[str(joint.get("name")).split("/")[-1] for joint in body.findall("joint")] for body in bodies]
    for first, second in pairwise(orders):
        assert first == second[::-1]


def test_balls_and_bars_are_geoms_of_their_own_size() -> None:
    ball = '[[obstacles]]\nname = "ball"\nkind = "sphere"\ncentre = [1, 2, 3]\nradius = 0.25\n'
    bar = '[[obstacles]]\nname = "bar"\nkind = "capsule"\nfrom = [1, 0, 0]\nto = [1, 0, 2]\nradius = 0.5\n'
    root = ET.fromstring(mjcf_of(parse_scene(FINGER + ball + bar), 4).text)
    geoms = {geom.get("name"): geom for geom in root.iter("geom")}
    assert [geoms["ball"].get(key) for key in ("type", "size", "pos")] == ["sphere", "0.25", "1 2 3"]
    assert [geoms["bar"].get(key) for key in ("type", "size", "fromto")] == ["capsule", "0.5", "1 0 0 1 0 2"]


def test_disks_touch_the_obstacles_that_name_them() -> None:
    """Bit by bit: the second obstacle keeps off the disks alone, the first one the rod alone."""
    text = (
        FINGER
        + """
[[disks]]
name = "spacers"
rod = "finger"
count = 2
radius = 0.01
[[obstacles]]
name = "floor"
kind = "plane"
point = [0, 0, -1]
normal = [0, 0, 1]
width = 1e-3
[[obstacles]]
name = "wall"
kind = "plane"
point = [1, 0, 0]
normal = [-1, 0, 0]
width = 1e-3
disks = ["spacers"]
"""
    )
    geoms = list(ET.fromstring(mjcf_of(parse_scene(text), 4).text).iter("geom"))
    assert {geom.get("contype") for geom in geoms if geom.get("type") == "cylinder"} == {"2"}
    assert {geom.get("contype") for geom in geoms if geom.get("type") in ("capsule", "box")} == {"1"}
