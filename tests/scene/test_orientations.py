"""Orientations of a scene, in every way that they are written, against SciPy."""

from __future__ import annotations

import logging
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from cosserat_casadi import Scene, SceneError, parse_scene, scene_from_dict
from cosserat_casadi.scene.writing import scene_text

STIFFNESS = {"bending_x": 1.0, "bending_y": 1.0, "torsion": 1.0}
ROD = {"name": "a", "length": 1.0, "strain": "kirchhoff", "stiffness": STIFFNESS}
ANGLES = [0.1, 0.7, -1.2]


def based(**base: Any) -> Scene:
    return scene_from_dict({"schema": 1, "rods": [{**ROD, "base": base}]})


def rotation(quaternion: tuple[float, ...]) -> Rotation:
    return Rotation.from_quat(np.roll(quaternion, -1))


@pytest.mark.parametrize("sequence", ["xyz", "zyx", "XYZ", "ZXZ"])
def test_euler_vs_scipy(sequence: str) -> None:
    base = based(euler={"sequence": sequence, "angles": ANGLES}).rods[0].base
    wanted = Rotation.from_euler(sequence, ANGLES)
    assert_allclose(rotation(base.quaternion).as_matrix(), wanted.as_matrix(), rtol=0, atol=1e-15)


def test_rotation_vector_vs_scipy() -> None:
    base = based(rotation_vector=ANGLES).rods[0].base
    assert_allclose(rotation(base.quaternion).as_matrix(), Rotation.from_rotvec(ANGLES).as_matrix(), rtol=0, atol=1e-15)


def test_twist_is_about_the_tangent() -> None:
    plain = rotation(based(tangent=[1, 2, 2], twist=0.0).rods[0].base.quaternion)
    twisted = rotation(based(tangent=[1, 2, 2], twist=0.3).rods[0].base.quaternion)
    turn = (twisted * plain.inv()).as_rotvec()
    assert_allclose(turn, 0.3 * np.array([1, 2, 2]) / 3, rtol=0, atol=1e-14)


@pytest.mark.parametrize("table", ["supports", "joints", "targets", "between"])
def test_every_table_with_an_orientation_reads_them(table: str) -> None:
    turned = {"position": [0.1, 0, 0.9], "rotation_vector": ANGLES}
    entries: dict[str, Any] = {
        "supports": {"rod": "a", "kind": "clamped", **turned},
        "joints": {"rod": "a", "kind": "fixed", **turned},
        "targets": {"rod": "a", "kind": "pose", **turned},
        "between": {"kind": "fixed", "between": [{"rod": "a"}, {"world": True, **turned}]},
    }
    key = "joints" if table == "between" else table
    (record,) = getattr(scene_from_dict({"schema": 1, "rods": [ROD], key: [entries[table]]}), key)
    assert_allclose(rotation(record.quaternion).as_rotvec(), ANGLES, rtol=0, atol=1e-14)


def test_a_written_scene_is_read_again() -> None:
    scene = based(euler={"sequence": "xyz", "angles": ANGLES})
    again = parse_scene(scene_text(scene))
    assert again.rods[0].base.quaternion == scene.rods[0].base.quaternion


def test_a_quaternion_with_few_digits_is_divided_by_its_norm_and_told(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.WARNING, logger="cosserat_casadi"):
        base = based(quaternion=[0.707, 0.707, 0, 0]).rods[0].base
    assert_allclose(base.quaternion, np.sqrt([0.5, 0.5, 0, 0]), rtol=0, atol=1e-15)
    assert "has norm 0.999849" in caplog.text


@pytest.mark.parametrize(
    ("base", "where", "problem"),
    [
        ({"euler": {"sequence": "xq", "angles": ANGLES}}, "euler.sequence", "must name three axes, got 'xq'"),
        ({"twist": 0.1}, "twist", "stands without tangent"),
        ({"quaternion": [1, 0, 0, 0], "rotation_vector": ANGLES}, "rotation_vector", "stands beside quaternion"),
        ({"quaternion": [1.002, 0, 0, 0]}, "quaternion", "must have norm 1, got norm 1.002"),
    ],
)
def test_refusals(base: dict[str, Any], where: str, problem: str) -> None:
    with pytest.raises(SceneError) as refused:
        based(**base)
    assert [(one.where, one.problem) for one in refused.value.problems] == [(f"rods[0].base.{where}", problem)]
