"""Films: the meshes that glTF and USD hold, read by readers of our own, lie where sections and bodies are."""

from __future__ import annotations

import json
import re
import struct
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import build, parse_scene, solve
from cosserat_casadi.equilibrium.solution import rotations
from cosserat_casadi.errors import SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.plots.film import SIDES, film_of, write_film
from cosserat_casadi.plots.gltf import glb
from cosserat_casadi.plots.usd import usda
from tests.commands import cosserat_line
from tests.motions import planar_swing

SCENE = """
schema = 1
accuracy = { modes = 4, nodes = 8 }
[[rods]]
name = "finger"
length = 0.2
material = { youngs_modulus = 2e9, poisson_ratio = 0.4, density = 1100.0 }
section = { shape = "circle", radius = 2e-3 }
strain = "kirchhoff"
[[disks]]
rod = "finger"
count = 3
radius = 8e-3
thickness = 2e-3
[[actuators]]
name = "cable"
kind = "tendon"
rod = "finger"
tension = 3.0
offset = [1.5e-3, 0.0]
[[bodies]]
name = "tip"
mass = 0.01
radius = 5e-3
[[joints]]
body = "tip"
rod = "finger"
kind = "fixed"
[[obstacles]]
name = "floor"
kind = "plane"
point = [0, 0, -0.1]
normal = [0, 0, 1]
width = 1e-3
"""

SAMPLES = {5126: ("<f4", 4), 5123: ("<u2", 2), 5125: ("<u4", 4)}
WIDTHS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}


@cache
def swing() -> Any:
    return planar_swing()


class Read:
    """A ``.glb`` file as a viewer reads it."""

    def __init__(self, content: bytes) -> None:
        magic, version, length = struct.unpack("<4sII", content[:12])
        assert (magic, version, length) == (b"glTF", 2, len(content))
        size, kind = struct.unpack("<I4s", content[12:20])
        assert kind == b"JSON"
        self.json = json.loads(content[20 : 20 + size])
        self.data = content[28 + size :]
        assert self.json["buffers"][0]["byteLength"] == len(self.data)

    def accessor(self, index: int) -> FloatArray:
        entry = self.json["accessors"][index]
        view = self.json["bufferViews"][entry["bufferView"]]
        kind, size = SAMPLES[entry["componentType"]]
        assert view["byteLength"] == entry["count"] * WIDTHS[entry["type"]] * size
        values = np.frombuffer(self.data[view["byteOffset"] : view["byteOffset"] + view["byteLength"]], kind)
        return values.reshape(entry["count"], WIDTHS[entry["type"]]).astype(float)

    def points(self, name: str, time: int) -> FloatArray:
        """Points of a mesh in the axes of the scene at a row of its animation, as skins say them."""
        (node,) = [node for node in self.json["nodes"] if node["name"] == name]
        attributes = self.json["meshes"][node["mesh"]]["primitives"][0]["attributes"]
        points = self.accessor(attributes["POSITION"])
        if "skin" not in node:
            return points
        skin = self.json["skins"][node["skin"]]
        inverses = self.accessor(skin["inverseBindMatrices"]).reshape(-1, 4, 4).swapaxes(1, 2)
        channels = self.json["animations"][0]["channels"]
        samplers = self.json["animations"][0]["samplers"]
        paths = {(c["target"]["node"], c["target"]["path"]): samplers[c["sampler"]]["output"] for c in channels}
        matrices = []
        for joint, inverse in zip(skin["joints"], inverses, strict=True):
            x, y, z, w = self.accessor(paths[joint, "rotation"])[time]
            matrix = np.eye(4)
            matrix[:3, :3] = rotations(np.array([[w, x, y, z]]))[0]
            matrix[:3, 3] = self.accessor(paths[joint, "translation"])[time]
            matrices.append(matrix @ inverse)
        of_point = np.array(matrices)[self.accessor(attributes["JOINTS_0"])[:, 0].astype(int)]
        return np.einsum("nij,nj->ni", of_point[:, :3, :3], points) + of_point[:, :3, 3]


def test_a_film_in_gltf_moves_with_the_sections() -> None:
    motion = swing()
    read = Read(glb(film_of(motion, speed=0.5)))
    (name,) = motion.model.discrete.rods
    times = read.accessor(read.json["animations"][0]["samplers"][0]["input"])[:, 0]
    assert_allclose(times, 2 * motion.times, rtol=1e-6, atol=0)
    for time in (0, len(times) // 2, len(times) - 1):
        rings = read.points(name, time).reshape(41, -1, 3)
        sections = motion.section(name, np.linspace(0, 1, 41)).position[time]
        assert_allclose(rings.mean(axis=1), sections, rtol=0, atol=1e-6)


def test_a_shape_has_the_sizes_of_the_scene() -> None:
    solution = solve(build(parse_scene(SCENE)))
    read = Read(glb(film_of(solution)))
    assert {node["name"] for node in read.json["nodes"]} == {"scene", "finger", "disks", "cable", "tip", "floor"}
    rings = read.points("finger", 0).reshape(41, SIDES, 3)
    pose = solution.pose(np.linspace(0, 1, 41))
    assert_allclose(np.linalg.norm(rings - pose.position[:, None], axis=2), 2e-3, rtol=0, atol=1e-7)
    assert_allclose(
        np.einsum("kni,ki->kn", rings - pose.position[:, None], pose.rotation[:, :, 2]), 0, rtol=0, atol=1e-7
    )
    disk = read.points("disks", 0)[-2 * SIDES :]
    tip = solution.tip()
    along = (disk - tip.position) @ tip.rotation
    assert_allclose(np.linalg.norm(along[:, :2], axis=1), 8e-3, rtol=0, atol=1e-7)
    assert_allclose(np.abs(along[:, 2]), 1e-3, rtol=0, atol=1e-7)
    cable = read.points("cable", 0).reshape(-1, SIDES, 3).mean(axis=1)
    assert_allclose(cable[-1], tip.position + 1.5e-3 * tip.rotation[:, 0], rtol=0, atol=1e-7)
    ball = read.points("tip", 0) - solution.body("tip").position
    assert_allclose(np.linalg.norm(ball, axis=1), 5e-3, rtol=0, atol=1e-7)
    assert_allclose(read.points("floor", 0)[:, 2], -0.1, rtol=0, atol=1e-7)


def test_a_body_with_a_thickness_is_a_disk() -> None:
    solution = solve(build(parse_scene(SCENE.replace("radius = 5e-3", "radius = 5e-3\nthickness = 3e-3"))))
    pose = solution.body("tip")
    along = (Read(glb(film_of(solution))).points("tip", 0) - pose.position) @ pose.rotation
    assert_allclose(np.linalg.norm(along[:, :2], axis=1), 5e-3, rtol=0, atol=1e-7)
    assert_allclose(np.abs(along[:, 2]), 1.5e-3, rtol=0, atol=1e-7)


def test_triangles_look_outwards() -> None:
    """A closed mesh has its volume with the right sign: that of the cylinder, less what the flat sides leave out."""
    (finger, disks, *_) = film_of(solve(build(parse_scene(SCENE.replace("tension = 3.0", "tension = 0.0"))))).parts
    flat = SIDES / 2 * np.sin(2 * np.pi / SIDES)
    for part, volume in ((finger, flat * 4e-6 * 0.2), (disks, 3 * flat * 64e-6 * 2e-3)):
        a, b, c = (part.at(0)[part.faces[:, corner]] for corner in range(3))
        assert_allclose(np.einsum("ni,ni->", a, np.cross(b, c)) / 6, volume, rtol=1e-6, atol=0)


def test_usd_has_the_points_of_the_film() -> None:
    film = film_of(swing())
    text = usda(film)
    samples = re.findall(r"^ +([\d.]+): \[(.*)\],$", text, flags=re.MULTILINE)
    assert len(samples) == len(film.times)
    for (code, _), time in zip(samples, film.times, strict=True):
        assert float(code) == pytest.approx(100 * time, rel=1e-5)
    numbers = np.array([float(number) for number in re.findall(r"[-\d.e]+", samples[-1][1])]).reshape(-1, 3)
    assert_allclose(numbers, film.parts[0].at(-1), rtol=1e-6, atol=1e-9)
    assert text.count("def Mesh") == len(film.parts)


def test_results_and_commands_write_films(tmp_path: Path) -> None:
    (tmp_path / "finger.toml").write_text(SCENE)
    ended = cosserat_line("cosserat solve finger.toml --plot x.glb", tmp_path)
    assert ended.returncode == 0, ended.stderr
    assert "wrote x.glb" in ended.stdout
    assert (tmp_path / "x.glb").read_bytes()[:4] == b"glTF"
    swing().write(tmp_path / "x.usda")
    assert (tmp_path / "x.usda").read_text().startswith("#usda 1.0")
    with pytest.raises(SceneError, match="no suffix of a film"):
        write_film(swing(), tmp_path / "x.obj")
