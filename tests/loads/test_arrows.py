"""How loads are drawn: what the arrows of a solved scene show."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Solution, build, solve
from cosserat_casadi.loads.load import Arrow, Poses
from cosserat_casadi.model.arrow_records import DRAWN_SECTIONS, LoadArrows
from tests.loads.kinds import BedRecord, DipoleRecord, ElasticSpringRecord, registered, with_loads
from tests.scenes import HOOK, STIFFNESS, WEIGHT, WIND, push, rod, scene

FEW = {"modes": 3, "nodes": 8}


@pytest.fixture(autouse=True, scope="module")
def kinds() -> Iterator[None]:
    with registered():
        yield


def arrows(solution: Solution) -> list[Arrow]:
    def rod_poses(name: str, X: np.ndarray) -> Poses:
        pose = solution.pose(X, name)
        return pose.position.T, pose.rotation

    def body_pose(name: str) -> Poses:
        pose = solution.body(name)
        return pose.position[:, None], pose.rotation[None]

    return LoadArrows(solution.model.discrete, ca.DM(solution.inputs), rod_poses, body_pose).all()


def test_point_loads_are_drawn_at_their_sections() -> None:
    solution = solve(build(scene(push(moment=[0.1, 0.0, 0.2], frame="body"), HOOK, accuracy=FEW)))
    force, moment, hook = arrows(solution)
    tip, middle = solution.tip(), solution.pose(0.4)
    assert [force.sort, moment.sort, hook.sort] == ["point", "moment", "point"]
    assert [force.label, moment.label, hook.label] == ["push: 1.1 N", "push: 0.224 N m", "hook: 0.7 N"]
    assert_allclose(force.start, tip.position, rtol=0, atol=1e-12)
    assert_allclose(force.vector, tip.rotation @ [0.9, 0.5, -0.4], rtol=0, atol=1e-12)
    assert_allclose(moment.vector, tip.rotation @ [0.1, 0.0, 0.2], rtol=0, atol=1e-12)
    assert_allclose(hook.start, middle.position, rtol=0, atol=1e-12)
    assert_allclose(hook.vector, [0.3, -0.6, 0.2], rtol=0, atol=0)


def test_loads_per_length_are_drawn_along_the_rod() -> None:
    solution = solve(build(scene({**WIND, "frame": "body"}, WEIGHT, accuracy=FEW)))
    found, pose = arrows(solution), solution.pose(DRAWN_SECTIONS)
    wind, weight = found[:8], found[8:]
    assert [arrow.label for arrow in wind] == ["wind: up to 0.699 N/m", *[""] * 7]
    assert {arrow.sort for arrow in found} == {"line"}
    assert_allclose([arrow.start for arrow in wind], pose.position, rtol=0, atol=1e-12)
    x = 0.4 + 0.3 * (2 * DRAWN_SECTIONS - 1)
    local = np.stack([x, np.full(8, 0.2), np.zeros(8)], axis=1)
    expected = np.einsum("kij,kj->ki", pose.rotation, local)
    assert_allclose([arrow.vector for arrow in wind], expected, rtol=0, atol=1e-12)
    assert_allclose([arrow.vector for arrow in weight], np.tile([0.27, -0.18, -1.8], (8, 1)), rtol=0, atol=1e-15)


def plate(**changes: Any) -> dict[str, Any]:
    legs = [rod(name=name, stiffness=STIFFNESS, base={"position": [x, 0, 0]}) for name, x in (("a", 0.0), ("b", 0.3))]
    joints = [
        {"body": "plate", "rod": name, "kind": "fixed", "position": [x, 0, 0]} for name, x in (("a", 0.0), ("b", 0.3))
    ]
    return {
        "schema": 1,
        "accuracy": FEW,
        "rods": legs,
        "bodies": [{"name": "plate", "mass": 0.5, "centre_of_mass": [0.15, 0, 0.02]}],
        "joints": joints,
        **changes,
    }


def test_weight_of_rods_and_bodies() -> None:
    pull = {"name": "pull", "kind": "body_wrench", "body": "plate", "force": [1.0, 0, 0], "position": [0, 0, 0.1]}
    solution = solve(build(with_loads(plate(loads=[WEIGHT, pull]))))
    found, body = arrows(solution), solution.body("plate")
    assert [arrow.label for arrow in found if arrow.label] == [
        "weight: up to 1.83 N/m",
        "weight of plate: 1.02 N",
        "pull: 1 N",
    ]
    assert len(found) == 18
    assert_allclose(found[16].start, body.position + body.rotation @ [0.15, 0, 0.02], rtol=0, atol=1e-12)
    assert_allclose(found[16].vector, [0.15, -0.1, -1.0], rtol=0, atol=1e-15)
    assert_allclose(found[17].start, body.position + body.rotation @ [0, 0, 0.1], rtol=0, atol=1e-12)


def test_loads_that_depend_on_poses_are_drawn_as_they_are_where_the_rod_is() -> None:
    spring = ElasticSpringRecord(name="spring", kind="elastic_spring", rod="rod", stiffness=2.0, anchor=(0.5, 0.1, 0.6))
    dipole = DipoleRecord(name="magnet", kind="dipole", rod="rod", dipole=(0.0, 0.1, 0.2), field=(1.0, 0.0, 0.5))
    bed = BedRecord(name="bed", kind="bed", rod="rod", strength=0.5)
    solution = solve(build(with_loads({"schema": 1, "accuracy": FEW, "rods": [rod()]}, spring, dipole, bed)))
    assert solution.converged
    tip = solution.tip()
    force, moment, *along = arrows(solution)
    assert_allclose(force.vector, 2.0 * (np.array([0.5, 0.1, 0.6]) - tip.position), rtol=0, atol=1e-12)
    assert_allclose(moment.vector, np.cross(tip.rotation @ [0.0, 0.1, 0.2], [1.0, 0.0, 0.5]), rtol=0, atol=1e-12)
    moved = solution.pose(DRAWN_SECTIONS).position - np.outer(DRAWN_SECTIONS, [0, 0, 0.8])
    assert_allclose([arrow.vector for arrow in along], -0.5 * moved, rtol=0, atol=1e-12)
