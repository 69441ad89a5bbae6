"""Motions of a model at values of its parameters begin where those of the scene with these values begin."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import build, scene_from_dict, simulate
from tests.motion.stepping import moving_model
from tests.moving_scenes import PLATE, WEIGHT, rod, scene

Y = [0, 1, 0]


def turned(half_angle: float) -> list[float]:
    """Quaternion of a turn about y."""
    return [np.cos(half_angle), 0.0, np.sin(half_angle), 0.0]


def with_base(orientation: list[float], **base: Any) -> dict[str, Any]:
    return scene(rod(base={"quaternion": orientation, **base}), loads=[WEIGHT])


def hinged(between: dict[str, Any]) -> dict[str, Any]:
    return {"kind": "revolute", "axis": Y, "name": "hinge", "between": [between, {"rod": "a", "at": 0.0}]}


def free(orientation: list[float]) -> dict[str, Any]:
    return with_base(orientation, free=True)


def hinged_in_world(orientation: list[float]) -> dict[str, Any]:
    return with_base(orientation) | {"joints": [hinged({"world": True})]}


def hinged_on_body(orientation: list[float]) -> dict[str, Any]:
    clamp = {"kind": "fixed", "name": "clamp", "between": [{"world": True, "position": [0.1, 0, 0]}, {"body": "plate"}]}
    return with_base(orientation) | {"joints": [clamp, hinged({"body": "plate"})], "bodies": [PLATE]}


def alone(length: float) -> dict[str, Any]:
    return scene(rod(strain="planar", length=length), loads=[WEIGHT])


def carried(length: float) -> dict[str, Any]:
    return scene(rod(length=length), rod("b", base={"rod": "a", "tangent": [1, 0, 0]}), loads=[WEIGHT])


def carried_by_free(length: float) -> dict[str, Any]:
    tables = carried(length)
    tables["rods"][0]["base"] = {"free": True, "position": [0, 0, 1]}
    return tables


@pytest.mark.parametrize(
    ("tables", "name", "values", "start"),
    [
        (free, "a.base.quaternion", (turned(0.0), turned(0.5)), "unloaded"),
        (free, "a.base.quaternion", (turned(0.0), turned(0.5)), "equilibrium"),
        (hinged_in_world, "a.base.quaternion", (turned(0.0), turned(0.5)), "unloaded"),
        (hinged_on_body, "a.base.quaternion", (turned(0.1), turned(0.5)), "unloaded"),
        (hinged_on_body, "a.base.quaternion", (turned(0.1), turned(2.5)), "unloaded"),
        (carried, "a.length", (0.8, 0.9), "unloaded"),
        (carried_by_free, "a.length", (0.8, 0.9), "unloaded"),
        (carried_by_free, "a.length", (0.8, 0.9), "equilibrium"),
    ],
)
def test_a_motion_begins_where_values_of_parameters_put_its_rods(
    tables: Any, name: str, values: tuple[Any, Any], start: str
) -> None:
    file, new = values
    simulation = {"duration": 0.02, "frames": 3, "start": start, "step": 0.01}
    model = moving_model(tables(file) | {"parameters": [name], "simulation": simulation})
    motion = simulate(model.at(np.ravel(new)))
    expected = simulate(build(scene_from_dict(tables(new) | {"simulation": simulation}), moving=True))
    assert motion.start == expected.start
    for own in model.discrete.rods:
        assert_allclose(motion.tip(own).position, expected.tip(own).position, rtol=0, atol=1e-8)


@pytest.mark.parametrize("kind", ["parameters", "inputs"])
def test_errors_of_motions_are_over_the_length_that_a_rod_has(kind: str) -> None:
    simulation = {"duration": 0.05, "frames": 3, "tolerance": 1e-3, "start": "unloaded"}
    motions = [{"input": "a.length", "times": [0.0], "values": [0.1]}] if kind == "inputs" else []
    moved = alone(0.8) | {kind: ["a.length"], "motions": motions, "simulation": simulation}
    model = build(scene_from_dict(moved), moving=True)
    motion = simulate(model if kind == "inputs" else model.at([0.1]))
    expected = simulate(build(scene_from_dict(alone(0.1) | {"simulation": simulation}), moving=True))
    assert motion.error_estimate == pytest.approx(expected.error_estimate, rel=0.1)
