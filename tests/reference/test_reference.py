"""The oracle against the reference cases, against closed forms, and against itself."""

from __future__ import annotations

import copy
import json
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from . import closed_forms
from .random_scenes import random_scene
from .rods import rod_of, rotation_from_quaternion, rotation_from_tangent, torsion_constant
from .shooting import NoEquilibriumError, ReferenceSolution, solve_by_shooting

CASES = Path(__file__).resolve().parents[2].parent / "shared" / "cases"
RODS = sorted((CASES / "rods").glob("*.toml"))
HELD = sorted((CASES / "supports").glob("*.toml"))
needs_cases = pytest.mark.skipif(not RODS, reason="the reference cases are not beside this checkout")

pytestmark = pytest.mark.slow
"""The oracle stays as it is; were it wrong, whatever is compared with it every time would fail."""

UNIT = dict.fromkeys(("bending_x", "bending_y", "torsion"), 1.0)
EXACT = {"rtol": 1e-11, "atol": 1e-12}


def scene_of(*loads: dict[str, Any], strain: Any = "kirchhoff", **rod: Any) -> dict[str, Any]:
    """A rod along world z with unit length and stiffness unless told otherwise."""
    elastic = {} if "material" in rod else {"stiffness": UNIT}
    table = {"name": "rod", "length": 1.0, "strain": strain, **elastic, **rod}
    return {"schema": 1, "rods": [table], "loads": [{"rod": "rod", **load} for load in loads]}


def tip_wrench(**wrench: Any) -> dict[str, Any]:
    return {"name": "tip", "kind": "tip_wrench", **wrench}


# The reference cases


@needs_cases
@pytest.mark.parametrize("path", RODS + HELD, ids=lambda path: path.stem)
def test_reference_cases(path: Path) -> None:
    case = json.loads(path.with_suffix(".json").read_text())
    solution = solve_by_shooting(tomllib.loads(path.read_text()), samples=2)
    expected, tolerance = case["expected"], case["position_tolerance_relative_to_length"]
    tip = expected["tip"]
    assert_allclose(solution.tip_position, tip["position"], rtol=0, atol=tolerance * case["length"])
    if "rotation" in tip:
        assert_allclose(solution.tip_rotation, tip["rotation"], rtol=0, atol=tolerance)
    if "base_wrench" in expected:
        wanted = np.array([expected["base_wrench"][key] for key in ("force", "moment")], dtype=float)
        found = np.array([solution.base_force, solution.base_moment])
        assert_allclose(found, wanted, rtol=0, atol=tolerance * np.abs(wanted).max())


# Closed forms of the whole rod


@pytest.mark.parametrize("turns", [0.25, -0.5, 1.0, 2.0])
def test_roll_up(turns: float) -> None:
    scene = scene_of(tip_wrench(moment=[0, 2 * np.pi * turns, 0]))
    assert_pose(solve_by_shooting(scene, samples=2), *closed_forms.roll_up(turns))


@pytest.mark.parametrize("frame", ["world", "body"])
def test_torsion_and_bending_by_a_tip_moment(frame: str) -> None:
    """A dead moment gives the closed-form helix; a follower moment, here of equal stiffnesses, a constant strain."""
    moment, quaternion = [2.0, 3.0, 5.0], [0.5, -0.5, 0.1, 0.7]
    torsion = 0.7 if frame == "world" else 1.0
    stiffness = {**UNIT, "torsion": torsion}
    base = {"position": [1, 2, 3], "quaternion": quaternion}
    scene = scene_of(tip_wrench(moment=moment, frame=frame), stiffness=stiffness, base=base)
    solution, R0 = solve_by_shooting(scene), rotation_from_quaternion(quaternion)
    if frame == "world":
        position, rotation = closed_forms.dead_moment(moment, 1.0, torsion, 1.0, R0)
    else:
        position, rotation = closed_forms.constant_strain([*moment, 0, 0, 1], 1.0)
        position, rotation = R0 @ position, R0 @ rotation
    assert_pose(solution, np.array([1, 2, 3]) + position, rotation)


def test_unloaded_rod_keeps_its_intrinsic_strain() -> None:
    strain = [0.7, -1.1, 1.5, 0.1, -0.2, 1.05]
    intrinsic = {"curvature": strain[:3], "tangent": strain[3:]}
    solution = solve_by_shooting(scene_of(strain=["bending_y"], length=2.0, intrinsic=intrinsic))
    assert_pose(solution, *closed_forms.constant_strain(strain, 2.0))
    assert_allclose(solution.sections.strain, np.tile(strain, (21, 1)), **EXACT)


def test_curvature_by_legendre_coefficients() -> None:
    """θ = ∫ (a + b P₁ + c P₂) ds leaves a L at the tip and a/2 − b/4 at the middle."""
    intrinsic = {"curvature": [0, [0.8, 0.6, 0.5], 0]}
    solution = solve_by_shooting(scene_of(intrinsic=intrinsic), samples=[1.0, 0.5])
    angles = [np.arctan2(R[0, 2], R[2, 2]) for R in solution.sections.rotation]
    assert_allclose(angles, [0.8, 0.4 - 0.15], **EXACT)


@pytest.mark.parametrize("alpha", [0.3, 1, 2, 5, 10])
@pytest.mark.parametrize("strain", ["planar", "kirchhoff"])
def test_elastica(alpha: float, strain: str) -> None:
    solution = solve_by_shooting(scene_of(tip_wrench(force=[alpha, 0, 0]), strain=strain), samples=2)
    drawn, aside, angle = closed_forms.elastica(alpha)
    rotation = closed_forms.constant_strain([0, angle, 0, 0, 0, 1], 1.0)[1]
    assert_pose(solution, np.array([aside, 0, 1 - drawn]), rotation)
    assert_allclose(solution.base_force, [-alpha, 0, 0], **EXACT)
    assert_allclose(solution.base_moment, [0, -alpha * (1 - drawn), 0], **EXACT)


@pytest.mark.parametrize("alpha", closed_forms.MATTIASSON_1981)
def test_elastica_vs_the_published_table(alpha: int) -> None:
    assert_allclose(closed_forms.elastica(alpha), closed_forms.MATTIASSON_1981[alpha], rtol=0, atol=5.1e-6)


def test_small_deflection() -> None:
    force, bending, length = 1e-7, 2.5, 2.0
    scene = scene_of(tip_wrench(force=[0, force, 0]), stiffness={**UNIT, "bending_x": bending}, length=length)
    tip = solve_by_shooting(scene, samples=2).tip_position
    assert_allclose(tip[1], closed_forms.small_deflection(force, bending, length), rtol=1e-6, atol=0)


# Closed forms of sections, tapers and loads


def test_stretch_under_own_weight_and_tip_force() -> None:
    material = {"youngs_modulus": 1e6, "poisson_ratio": 0.3, "density": 900.0}
    section = {"shape": "annulus", "outer_radius": 0.02, "inner_radius": 0.01}
    weight = {"name": "weight", "kind": "gravity", "acceleration": [0, 0, 9.81]}
    rod = {"strain": "reissner", "material": material, "section": section, "length": 2.0}
    solution = solve_by_shooting(scene_of(weight, tip_wrench(force=[0, 0, 3.0]), **rod))
    area = np.pi * (0.02**2 - 0.01**2)
    total = 900.0 * area * 9.81 * 2.0
    assert_allclose(solution.tip_position[2] - 2.0, closed_forms.stretch(3.0 + total / 2, 1e6 * area, 2.0), **EXACT)
    assert_allclose(solution.base_force, [0, 0, -3.0 - total], **EXACT)
    assert_allclose(solution.sections.internal_wrench[0], [0, 0, 0, 0, 0, 3.0 + total], **EXACT)


def test_tapered_stretch() -> None:
    stiffness = {"extension": [50.0, 20.0]}
    scene = scene_of(tip_wrench(force=[0, 0, 4.0]), strain=["extension"], stiffness=stiffness)
    longer = solve_by_shooting(scene, samples=2).tip_position[2] - 1.0
    assert_allclose(longer, closed_forms.tapered_stretch(4.0, (50.0, 20.0), 1.0), **EXACT)


@pytest.mark.parametrize("radius", [0.01, [0.012, 0.008]])
def test_twist_of_cylinder_and_cone(radius: Any) -> None:
    material = {"youngs_modulus": 1e6, "shear_modulus": 4e5}
    section = {"shape": "circle", "radius": radius}
    scene = scene_of(tip_wrench(moment=[0, 0, 0.004]), material=material, section=section)
    R = solve_by_shooting(scene, samples=2).tip_rotation
    if isinstance(radius, list):
        angle = closed_forms.cone_twist(0.004, 4e5, (radius[0], radius[1]), 1.0)
    else:
        angle = closed_forms.twist(0.004, 4e5 * np.pi / 2 * radius**4, 1.0)
    assert_allclose(R, closed_forms.constant_strain([0, 0, angle, 0, 0, 1], 1.0)[1], **EXACT)


def test_torsion_constant_of_a_rectangle() -> None:
    assert_allclose(torsion_constant(1.0, 1.0), 0.1405770149551537, rtol=1e-14, atol=0)
    assert_allclose(torsion_constant(2.0, 1.0), torsion_constant(1.0, 2.0), rtol=0, atol=0)
    published = {1.2: 0.166, 1.5: 0.196, 2: 0.229, 3: 0.263, 4: 0.281, 5: 0.291, 10: 0.312}  # Timoshenko
    for ratio, factor in published.items():
        assert_allclose(torsion_constant(ratio, 1.0) / ratio, factor, rtol=0, atol=6e-4)
    assert_allclose(torsion_constant(1e6, 1.0) / 1e6, 1 / 3, rtol=1e-6, atol=0)


def test_hooke_of_a_rectangle() -> None:
    """Width lies along x, so bending about y takes the cube of the width."""
    material = {"youngs_modulus": 12.0, "poisson_ratio": 0.25}
    section = {"shape": "rectangle", "width": [2.0, 4.0], "height": 1.0, "shear_correction": 5 / 6}
    rod = rod_of(scene_of(strain="reissner", material=material, section=section))
    wanted = [2.0, 8.0, 4.8 * torsion_constant(2, 1), 8.0, 8.0, 24.0]
    assert_allclose(1 / rod.compliance(0.0), wanted, rtol=1e-14, atol=0)
    assert_allclose(1 / rod.compliance(0.5)[:2], [3.0, 27.0], rtol=1e-14, atol=0)


@pytest.mark.parametrize("frame", ["world", "body"])
def test_moments_along_the_rod(frame: str) -> None:
    """A moment 2 at X = 1/4 and 1 + (2X − 1) per metre about y: in the plane dead and follower are the same."""
    hook = {"name": "hook", "kind": "point_wrench", "at": 0.25, "moment": [0, 2.0, 0], "frame": frame}
    wind = {"name": "wind", "kind": "distributed_wrench", "moment": [0, [1.0, 1.0], 0], "frame": frame}
    solution = solve_by_shooting(scene_of(hook, wind), samples=[1.0, 0.0, 0.25, 0.3])
    angle = np.arctan2(solution.tip_rotation[0, 2], solution.tip_rotation[2, 2])
    assert_allclose(angle, 2.0 / 4 + 2 / 3, **EXACT)
    X = solution.sections.X
    assert_allclose(solution.sections.internal_wrench[:, 1], 1 - X**2 + 2.0 * (X <= 0.25), **EXACT)


def test_follower_load_along_the_rod_against_the_clamp() -> None:
    """What the clamp exerts balances a pressure normal to the rod, summed over its shape."""
    wind = {"name": "wind", "kind": "distributed_wrench", "force": [3.0, 0, 0], "frame": "body"}
    solution = solve_by_shooting(scene_of(wind))
    nodes, weights = np.polynomial.legendre.leggauss(30)
    sections = solution.at((nodes + 1) / 2)
    forces = 3.0 * sections.rotation[:, :, 0]
    moments = np.cross(sections.position, forces)
    assert_allclose(solution.base_force, -weights @ forces / 2, **EXACT)
    assert_allclose(solution.base_moment, -weights @ moments / 2, **EXACT)


# Held tips


def test_tip_pinned_where_a_dead_force_brings_it() -> None:
    drawn, aside, _ = closed_forms.elastica(5.0)
    scene = scene_of(strain="planar")
    scene["supports"] = [{"rod": "rod", "kind": "pinned", "position": [aside, 0, 1 - drawn]}]
    solution = solve_by_shooting(scene)
    assert_allclose(solution.tip_position, [aside, 0, 1 - drawn], **EXACT)
    assert_allclose(solution.base_force, [-5.0, 0, 0], rtol=1e-10, atol=1e-10)


def test_tip_clamped_where_a_wrench_brings_it() -> None:
    """Prescribing the pose that a wrench causes gives the wrench back."""
    free = scene_of(tip_wrench(force=[0.3, 0.8, -0.4], moment=[-0.7, 0.9, 0.4]))
    wanted = solve_by_shooting(free)
    held = scene_of()
    pose = {"position": wanted.tip_position, "quaternion": quaternion_of(wanted.tip_rotation)}
    held["supports"] = [{"rod": "rod", "kind": "clamped", **pose}]
    solution = solve_by_shooting(held)
    assert_allclose(solution.base_force, wanted.base_force, rtol=1e-9, atol=1e-9)
    assert_allclose(solution.sections.position, wanted.sections.position, rtol=1e-9, atol=1e-9)


# Conventions and honesty


def test_base_orientation() -> None:
    assert_allclose(rotation_from_quaternion([2, 0, 0, 2]) @ [1, 0, 0], [0, 1, 0], rtol=0, atol=1e-15)
    tangent = np.array([0.6, 0.0, 0.8])
    assert_allclose(rotation_from_tangent(3 * tangent), [[0.8, 0, 0.6], [0, 1, 0], [-0.6, 0, 0.8]], atol=1e-15)
    assert_allclose(rotation_from_tangent([0, 0, -2]), np.diag([1, -1, -1]), rtol=0, atol=0)


def test_shape_in_the_world_vs_shape_in_the_base() -> None:
    """Moving the base and turning the dead loads with it moves the rod rigidly."""
    scene = random_scene(6)
    still, moved = rod_of(scene), copy.deepcopy(scene)
    turn = rotation_from_quaternion([0.1, 0.8, -0.5, 0.3])
    moved["rods"][0]["base"] = {
        "position": [1.0, -2.0, 0.5],
        "quaternion": quaternion_of(turn @ still.base_rotation),
    }
    for load in moved["loads"]:
        turn_dead(load, turn)
    before, after = solve_by_shooting(scene, samples=4), solve_by_shooting(moved, samples=4)
    wanted = turn @ (before.tip_position - still.base_position) + [1.0, -2.0, 0.5]
    assert_allclose(after.tip_position, wanted, rtol=1e-10, atol=1e-10 * still.length)
    wrench = before.sections.internal_wrench
    assert_allclose(after.sections.internal_wrench, wrench, rtol=1e-10, atol=1e-10 * np.abs(wrench).max())


def test_the_end_of_a_path_is_told() -> None:
    """A tip pulled beyond the length of an inextensible rod has no equilibrium."""
    scene = scene_of()
    scene["supports"] = [{"rod": "rod", "kind": "pinned", "position": [0.9, 0, 0.9]}]
    with pytest.raises(NoEquilibriumError, match="the path ends"):
        solve_by_shooting(scene)


def test_start_at_the_wrench_of_the_clamp() -> None:
    scene = scene_of(tip_wrench(force=[0.3, 0.8, -0.4], moment=[-0.7, 0.9, 0.4]))
    wanted = solve_by_shooting(scene)
    clamp = np.concatenate([wanted.base_force, wanted.base_moment])
    solution = solve_by_shooting(scene, base_wrench=clamp + 1e-4)
    assert solution.steps == 0
    assert_allclose(solution.tip_position, wanted.tip_position, **EXACT)
    assert_allclose(solution.base_moment, wanted.base_moment, **EXACT)
    with pytest.raises(NoEquilibriumError, match="near the base wrench"):
        solve_by_shooting(scene, base_wrench=clamp + 0.1)


def test_kinds_that_shooting_does_not_know_are_refused() -> None:
    scene = scene_of(tip_wrench(force=[0.3, 0.8, -0.4]), {"kind": "magnet"})
    with pytest.raises(ValueError, match="magnet, tendon"):
        solve_by_shooting(scene | {"actuators": [{"kind": "tendon"}]})


@pytest.mark.parametrize("seeds", [range(10), range(10, 60)])
def test_random_scenes(seeds: range) -> None:
    """Each is solved to the last digits; sections stay orthogonal, strains that are not admitted intrinsic."""
    for seed in seeds:
        scene = random_scene(seed)
        solution, rod = solve_by_shooting(scene, samples=4), rod_of(scene)
        assert solution.residual < 1e-11
        sections = solution.sections
        identity = np.tile(np.eye(3), (len(sections.X), 1, 1))
        assert_allclose(np.swapaxes(sections.rotation, 1, 2) @ sections.rotation, identity, rtol=0, atol=1e-11)
        fixed = np.array([rod.intrinsic(X) for X in sections.X])[:, ~rod.admitted]
        assert_allclose(sections.strain[:, ~rod.admitted], fixed, **EXACT)


def test_random_scenes_repeat() -> None:
    assert random_scene(7) == random_scene(7)
    assert random_scene(7) != random_scene(8)


# Helpers


def assert_pose(solution: ReferenceSolution, position: np.ndarray, rotation: np.ndarray) -> None:
    assert_allclose(solution.tip_position, position, **EXACT)
    assert_allclose(solution.tip_rotation, rotation, **EXACT)


def quaternion_of(rotation: np.ndarray) -> list[float]:
    x, y, z, w = Rotation.from_matrix(rotation).as_quat()
    return [w, x, y, z]


def turn_dead(load: dict[str, Any], turn: np.ndarray) -> None:
    """Turn a load in world axes."""
    if load.get("frame") == "body":
        return
    for key in {"force", "moment", "acceleration"} & set(load):
        load[key] = (turn @ np.array(load[key], dtype=float)).tolist()
