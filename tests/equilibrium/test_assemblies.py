"""Assemblies from a cold start, against independent solutions."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.optimize import root

from cosserat_casadi import Scene, Solution, read_scene, scene_from_dict, solve
from tests.conftest import case_files
from tests.reference.rods import hat, rotation_from_quaternion

pytestmark = pytest.mark.slow

ROUND = {"bending_x": 1.0, "bending_y": 1.4, "torsion": 0.7, "shear_x": 400.0, "shear_y": 600.0, "extension": 900.0}
HOOKE = np.array(list(ROUND.values()))


def rod(name: str, length: float, strain: str = "reissner", **changes: Any) -> dict[str, Any]:
    return {"name": name, "length": length, "strain": strain, "stiffness": ROUND, "linear_density": 0.5, **changes}


def scene(*rods: dict[str, Any], tolerance: float = 1e-9, **changes: Any) -> Scene:
    return scene_from_dict({"schema": 1, "rods": list(rods), "accuracy": {"tolerance": tolerance}, **changes})


def solved(wanted: Scene) -> Solution:
    solution = solve(wanted)
    assert solution.converged, solution.message
    return solution


# Integration of a rod as an initial-value problem in rotation matrices: nothing of the library's is used


def march(
    pose: tuple[np.ndarray, np.ndarray], force: np.ndarray, moment: np.ndarray, length: float, weight: np.ndarray
) -> tuple[tuple[np.ndarray, np.ndarray], np.ndarray, np.ndarray]:
    """From pose and world internal wrench at the base of a stretch to those at its tip."""

    def slope(_: float, y: np.ndarray) -> np.ndarray:
        R, n, m = y[3:12].reshape(3, 3), y[12:15], y[15:18]
        K, G = R.T @ m / HOOKE[:3], R.T @ n / HOOKE[3:] + [0, 0, 1]
        return np.concatenate([R @ G, (R @ hat(K)).ravel(), -weight, -np.cross(R @ G, n)])

    start = np.concatenate([pose[0], pose[1].ravel(), force, moment])
    end = solve_ivp(slope, (0, length), start, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    return (end[:3], end[3:12].reshape(3, 3)), end[12:15], end[15:18]


def solution_of(defect: Any, start: np.ndarray) -> np.ndarray:
    balanced = root(defect, start, tol=1e-13)
    assert np.abs(balanced.fun).max() < 1e-9
    return np.asarray(balanced.x)


WEIGHT = {"name": "weight", "kind": "gravity", "acceleration": [0.0, 1.0, -3.0]}
G = np.array([0.0, 0.5, -1.5])  # weight per length


@pytest.mark.parametrize("strain", ["planar", "kirchhoff", "reissner"])
def test_two_rods_in_series_vs_one(strain: str) -> None:
    base = {"position": [0.1, 0, 0], "tangent": [1, 0, 1]}
    push = {"name": "push", "kind": "tip_wrench", "force": [0.9, 0.0, -0.4], "moment": [0, 0.2, 0]}
    weight = {**WEIGHT, "acceleration": [0.5, 0.0, -3.0]}
    single = solved(scene(rod("a", 0.8, strain, base=base), loads=[{**push, "rod": "a"}, weight]))
    parts = (rod("a", 0.5, strain, base=base), rod("b", 0.3, strain, base={"rod": "a"}))
    series = solved(scene(*parts, loads=[{**push, "rod": "b"}, weight]))
    assert_allclose(series.tip("b").position, single.tip().position, rtol=0, atol=2e-9)
    assert_allclose(series.tip("b").rotation, single.tip().rotation, rtol=0, atol=2e-9)
    assert_allclose(series.base_wrench("a").moment, single.base_wrench().moment, rtol=0, atol=2e-8)
    passed = series.pose(1.0, "a").rotation @ series.internal_wrench([1.0], "a")[0, :3]
    assert_allclose(series.base_wrench("b").moment, -passed, rtol=0, atol=1e-7)
    assert series.stable is single.stable
    # A dead moment has a potential only where all turns share an axis.
    assert (single.stable is not None) == (strain == "planar")


def test_rod_carried_between_the_ends_vs_shooting() -> None:
    offset, turn = np.array([0.05, 0.02, 0.0]), [0.6, 0, 0.8, 0]
    push = np.array([0.9, 0.5, -0.4])
    wanted = scene(
        rod("a", 0.8),
        rod("b", 0.5, base={"rod": "a", "at": 0.5, "position": offset.tolist(), "quaternion": turn}),
        loads=[WEIGHT, {"name": "push", "kind": "tip_wrench", "rod": "b", "force": push.tolist()}],
    )
    own = solved(wanted)

    def poses(moments: np.ndarray) -> tuple[Any, ...]:
        root_force = -(push + G * 1.3)
        middle, n, m = march((np.zeros(3), np.eye(3)), -root_force, moments[:3], 0.4, G)
        child = (middle[0] + middle[1] @ offset, middle[1] @ rotation_from_quaternion(turn))
        child_force = push + G * 0.5
        end_b, _, left_b = march(child, child_force, moments[3:], 0.5, G)
        passed = moments[3:] + np.cross(child[0] - middle[0], child_force)
        end_a, _, left_a = march(middle, n - child_force, m - passed, 0.4, G)
        return end_a, end_b, np.concatenate([left_a, left_b])

    moments = solution_of(lambda unknown: poses(unknown)[2], np.zeros(6))
    end_a, end_b, _ = poses(moments)
    for name, end in (("a", end_a), ("b", end_b)):
        assert_allclose(own.tip(name).position, end[0], rtol=0, atol=2e-9)
        assert_allclose(own.tip(name).rotation, end[1], rtol=0, atol=3e-9)
    assert_allclose(own.base_wrench("a").moment, -moments[:3], rtol=0, atol=2e-8)
    assert_allclose(own.base_wrench("b").moment, -moments[3:], rtol=0, atol=2e-8)
    assert own.stable


FEET = np.array([[0.0, 0, 0], [0.3, 0, 0], [0.1, 0.25, 0]])
ARMS = np.array([[-0.1, -0.08, 0], [0.12, -0.05, 0], [0.0, 0.1, 0.02]])
LENGTHS = (0.6, 0.63, 0.58)
CENTRE = np.array([0.02, 0.01, 0.05])
SIDE = np.array([0.4, -0.3, 0.2])


@pytest.mark.parametrize("kind", ["fixed", "spherical"])
def test_tripod_with_mass_vs_shooting(kind: str) -> None:
    """Three rods that do not fit a body unloaded: all root wrenches and the body's pose found at once."""
    mass = 0.3
    wanted = scene(
        *[rod(n, length, base={"position": list(p)}) for n, length, p in zip("abc", LENGTHS, FEET, strict=True)],
        tolerance=1e-8,
        bodies=[{"name": "plate", "mass": mass, "centre_of_mass": CENTRE.tolist()}],
        joints=[
            {"body": "plate", "rod": n, "kind": kind, "position": list(a)} for n, a in zip("abc", ARMS, strict=True)
        ],
        loads=[WEIGHT, {"name": "side", "kind": "body_wrench", "body": "plate", "force": SIDE.tolist()}],
    )
    own = solved(wanted)
    pose = own.body("plate")
    total = mass * np.array(WEIGHT["acceleration"])

    def defect(unknown: np.ndarray) -> np.ndarray:
        position, R = unknown[:3], rotation_from_quaternion(unknown[3:7])
        force, moment = total + SIDE, np.cross(R @ CENTRE, total)
        parts = [np.array([unknown[3:7] @ unknown[3:7] - 1])]
        for i, (foot, arm, length) in enumerate(zip(FEET, ARMS, LENGTHS, strict=True)):
            wrench = unknown[7 + 6 * i : 13 + 6 * i]
            end, n, m = march((foot, np.eye(3)), wrench[:3], wrench[3:], length, G)
            parts.append(end[0] - position - R @ arm)
            spun = R.T @ end[1]
            parts.append(m if kind == "spherical" else np.array([spun[2, 1], spun[0, 2], spun[1, 0]]))
            force, moment = force - n, moment - np.cross(R @ arm, n) - (0 if kind == "spherical" else m)
        return np.concatenate([*parts, force, moment])

    # The shooting starts near the library's answer; that it stays there to its own tolerance is the test.
    roots = [np.concatenate([-own.base_wrench(n).force, -own.base_wrench(n).moment]) for n in "abc"]
    near = np.concatenate([pose.position, pose.quaternion, *roots])
    shot = solution_of(defect, near + 1e-3 * np.random.default_rng(3).standard_normal(len(near)))
    assert_allclose(pose.position, shot[:3], rtol=0, atol=1e-8)
    assert_allclose(pose.rotation, rotation_from_quaternion(shot[3:7]), rtol=0, atol=2e-8)
    assert_allclose(np.concatenate(roots), shot[7:], rtol=0, atol=1e-6)
    assert own.stable


def test_portal_vs_its_half() -> None:
    """Two equal planar legs under a heavy beam: by symmetry each carries half.

    The tip of a leg, held upright by the beam, slides sideways not at all: a leg alone under half of the weight, its
    tip clamped to where it goes by symmetry, has the same moment.
    """
    legs = [
        rod(
            n,
            0.5,
            ["bending_y", "shear_x", "extension"],
            base={"position": [x, 0, 0], "quaternion": q},
            intrinsic={"curvature": [0, 0.6, 0]},
        )
        for n, x, q in (("l", 0.0, [1, 0, 0, 0]), ("r", 0.4, [0, 0, 0, 1]))
    ]
    joints = [
        {"body": "beam", "rod": n, "kind": "fixed", "position": [x, 0, 0], "quaternion": q}
        for n, x, q in (("l", -0.2, [1, 0, 0, 0]), ("r", 0.2, [0, 0, 0, 1]))
    ]
    whole = solved(
        scene(
            *legs,
            bodies=[{"name": "beam", "mass": 0.4}],
            joints=joints,
            loads=[{**WEIGHT, "acceleration": [0, 0, -3.0]}],
        )
    )
    pose = whole.body("beam")
    assert_allclose(pose.position[:2], [0.2, 0.0], rtol=0, atol=1e-9)
    assert_allclose(pose.rotation, np.eye(3), rtol=0, atol=1e-9)
    left, right = whole.base_wrench("l"), whole.base_wrench("r")
    assert_allclose(left.force + right.force, [0, 0, 3.0 * (0.4 + 0.5)], rtol=0, atol=1e-9)
    assert_allclose(left.force * [-1, 1, 1], right.force, rtol=0, atol=1e-9)
    support = {
        "rod": "l",
        "kind": "clamped",
        "position": [0, 0, float(pose.position[2])],
        "quaternion": [1, 0, 0, 0],
    }
    half = solved(scene(legs[0], supports=[support], loads=[{**WEIGHT, "acceleration": [0, 0, -3.0]}]))
    assert_allclose(half.base_wrench("l").force, left.force, rtol=0, atol=1e-6)
    assert_allclose(half.base_wrench("l").moment, left.moment, rtol=0, atol=1e-7)
    assert whole.stable


def test_planar_loop_of_carried_rods_vs_one_held_rod() -> None:
    """A rod on a rod whose tip is held: the same as one rod held there."""
    base, at = {"tangent": [0, 0, 1]}, [0.25, 0.0, 0.45]
    support = {"kind": "clamped", "position": at, "quaternion": [np.cos(0.6), 0, np.sin(0.6), 0]}
    weight = {**WEIGHT, "acceleration": [0.0, 0.0, -3.0]}
    single = solved(scene(rod("a", 0.8, "planar", base=base), supports=[{**support, "rod": "a"}], loads=[weight]))
    parts = (rod("a", 0.5, "planar", base=base), rod("b", 0.3, "planar", base={"rod": "a"}))
    series = solved(scene(*parts, supports=[{**support, "rod": "b"}], loads=[weight]))
    assert_allclose(series.tip("a").position, single.pose(0.625).position, rtol=0, atol=3e-9)
    assert_allclose(series.base_wrench("a").force, single.base_wrench().force, rtol=0, atol=1e-7)
    assert series.stable is True
    assert single.stable is True


def test_assembly_that_cannot_close_says_what_is_left() -> None:
    """A body wider than rods that keep their length can reach."""
    rods = [rod(n, 0.3, "kirchhoff", base={"position": [x, 0, 0]}) for n, x in (("a", 0.0), ("b", 1.5))]
    joints = [
        {"body": "plate", "rod": n, "kind": kind, "position": [x, 0, 0]}
        for n, x, kind in (("a", -0.1, "spherical"), ("b", 0.1, "fixed"))
    ]
    few = {"modes": 3, "nodes": 8}
    solution = solve(scene(*rods, accuracy=few, bodies=[{"name": "plate"}], joints=joints))
    assert not solution.converged
    assert "The assembly is not closed: the tip of " in solution.message
    # 1.5 m between the feet, 0.3 m of each rod and 0.2 m of the body: 0.7 m are lacking, shared by two joints.
    metres = float(solution.message.split(" m, from")[0].split()[-1]) if " m, from" in solution.message else 0.0
    assert metres > 0.3


CASES = [path for path in case_files("robots") if "platform" in path.stem]


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_reference_platform(path: Any) -> None:
    """The six-rod robot, whose rods do not fit each other unloaded, from a cold start with default settings."""
    case, own = json.loads(path.with_suffix(".json").read_text()), solved(read_scene(path)).to_dict()
    tolerance, wanted = case["position_tolerance_relative_to_length"], case["expected"]
    for name, body in wanted["bodies"].items():
        assert_allclose(own["bodies"][name]["position"], body["position"], rtol=0, atol=tolerance * case["length"])
        assert_allclose(own["bodies"][name]["rotation"], body["rotation"], rtol=0, atol=tolerance)
    for name, leg in wanted["rods"].items():
        pair = [(own["rods"][name]["base_wrench"][k], leg["base_wrench"][k]) for k in ("force", "moment")]
        largest = max(np.abs(reference).max() for _, reference in pair)
        for value, reference in pair:
            assert_allclose(value, reference, rtol=0, atol=tolerance * largest)
