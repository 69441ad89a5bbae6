"""Disks that touch obstacles: their reach, a cantilever vs shooting, sliding as a point mass, parameters, C."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import fsolve

from cosserat_casadi import Scene, SceneError, build, discretise, export, follow, load, scene_from_dict, simulate, solve
from cosserat_casadi.codegen.names import model_names
from cosserat_casadi.equilibrium.solution import rotations
from cosserat_casadi.errors import ExportError
from cosserat_casadi.loads.contact_layer import ContactLayer, push_on_disk
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.contact_checks import untouchable
from cosserat_casadi.scene import Simulation, Sphere
from tests.contact.test_friction import DURATION, GRAVITY, SLIP, slid
from tests.reference.planar import elastica_end

LENGTH = 0.3
BENDING = 0.02
WIDTH = 2e-3
STIFFNESS = 5e4
RADIUS = 8e-3
THICKNESS = 2e-3
NORMAL = np.array([-0.4, 0.0, 1.0]) / np.hypot(0.4, 1.0)
POINT = np.array([0.3, 0.0, -0.03])
PUSH = np.array([0.2, 0.0, -1.0])


def finger(radius: float = RADIUS, parameters: tuple[str, ...] = (), **obstacle: Any) -> Scene:
    """A planar cantilever with a disk in its middle and one at its tip, which a force presses on a leaning floor."""
    floor = {"name": "floor", "kind": "plane", "point": POINT.tolist(), "normal": NORMAL.tolist(), "disks": ["d"]}
    rod = {"name": "a", "length": LENGTH, "strain": "planar", "stiffness": {"bending_y": BENDING}}
    given = {**floor, "width": WIDTH, "stiffness": STIFFNESS, **obstacle}
    row = {"name": "d", "rod": "a", "count": 2, "radius": radius, "thickness": THICKNESS}
    return scene_from_dict(
        {
            "schema": 1,
            "accuracy": {"modes": 8, "nodes": 16},
            "rods": [{**rod, "base": {"tangent": [1, 0, 0]}}],
            "disks": [row],
            "loads": [{"name": "push", "kind": "tip_wrench", "rod": "a", "force": PUSH.tolist()}],
            "obstacles": [{key: value for key, value in given.items() if value is not None}],
            "parameters": list(parameters),
        }
    )


def shot(radius: float = RADIUS, *, hard: bool = False) -> tuple[FloatArray, float]:
    """Tip and pressing force of it by shooting: the lowest point of a cylinder, pressed by 2 R k (w − g)³/(3 w²).

    A hard floor presses with what leaves no gap.
    """
    unit = 2 * radius * STIFFNESS * WIDTH / 3

    def tip(unknown: FloatArray) -> FloatArray:
        force = PUSH + unknown[1] * unit * NORMAL
        return elastica_end(LENGTH, [0.0, 0.0, 0.0, -unknown[0] / BENDING], force[[0, 2]], BENDING)

    def residual(unknown: FloatArray) -> list[float]:
        x, z, angle, curvature = tip(unknown)
        moment = -BENDING * curvature
        tangent = np.array([np.cos(angle), 0.0, np.sin(angle)])
        slant = NORMAL @ tangent
        edge = (NORMAL - slant * tangent) / np.sqrt(1 - slant**2)
        touching = -radius * edge - THICKNESS / 2 * np.sign(slant) * tangent
        gap = (np.array([x, 0.0, z]) + touching - POINT) @ NORMAL
        pressed = (max(WIDTH - gap, 0.0) / WIDTH) ** 3
        left = gap / WIDTH if hard else pressed - unknown[1]
        return [moment - unknown[1] * unit * np.cross(touching, NORMAL)[1], left]

    found = fsolve(residual, [0.0128, 1.06 / unit], xtol=1e-11)
    return tip(found)[:2], float(found[1] * unit)


def test_a_tip_pressed_on_a_leaning_floor_vs_shooting() -> None:
    """The reach of a rounded disk is off by 1e-4 of its radius at most, and 1e-2 of the thickness."""
    solution = solve(build(finger()))
    place, force = shot()
    (contact,) = solution.contacts
    assert solution.stable
    assert_allclose(solution.tip().position[[0, 2]], place, rtol=0, atol=1e-4 * RADIUS + 1e-2 * THICKNESS)
    assert_allclose(contact.force, force * NORMAL, rtol=0, atol=5e-3 * force)
    assert (contact.owner, contact.start, contact.end) == ("a", 1.0, 1.0)
    assert_allclose(solution.base_wrench().force, -PUSH - contact.force, rtol=0, atol=1e-12)


HARD = {"width": None, "stiffness": None}


def test_exact_contact_of_a_tip_vs_shooting() -> None:
    """At rest and along a path; the corners of the disk are as rounded as in smooth contact."""
    model = build(finger(**HARD))
    solution = solve(model)
    place, force = shot(hard=True)
    (contact,) = solution.contacts
    assert solution.stable
    assert_allclose(solution.tip().position[[0, 2]], place, rtol=0, atol=1e-4 * RADIUS + 1e-2 * THICKNESS)
    assert_allclose(contact.force, force * NORMAL, rtol=0, atol=1e-4 * force)
    assert_allclose(solution.base_wrench().force, -PUSH - contact.force, rtol=0, atol=1e-12)
    assert (contact.owner, contact.of_body) == ("d[1]", True)
    path = follow(model, "push.force", PUSH.tolist())
    assert path.converged
    assert_allclose(path.tip().position[-1], solution.tip().position, rtol=0, atol=1e-8)


@pytest.mark.slow
def test_a_disk_that_touches_exactly_where_a_joint_is() -> None:
    """A body without weight at the section of a disk changes nothing."""
    tables = finger(**HARD).model_dump(exclude_unset=True, by_alias=True)
    alone = solve(build(scene_from_dict(tables)))
    # Reading has made bodies of the disks.
    bodies = [{"name": "hand", "mass": 0.0}, *tables["bodies"]]
    joint = {"rod": "a", "body": "hand", "kind": "fixed", "position": [0.0, 0.0, -0.02]}
    held = solve(build(scene_from_dict({**tables, "bodies": bodies, "joints": [joint, *tables["joints"]]})))
    for solution in (alone, held):
        assert solution.converged, solution.message
        (contact,) = solution.contacts
        assert contact.owner == "d[1]"
    assert_allclose(held.tip().position, alone.tip().position, rtol=0, atol=1e-9)


def test_bodies_that_stand_for_disks_are_none_of_the_users() -> None:
    """Results list bodies of the scene alone."""
    bodies = [{"name": "d_1", "mass": 0.01}]
    joints = [{"kind": "fixed", "body": "d_1", "rod": "a", "at": 0.7}]
    tables = finger().model_dump(exclude_unset=True, by_alias=True)
    del tables["obstacles"][0]["width"], tables["obstacles"][0]["stiffness"]
    scene = scene_from_dict({**tables, "bodies": bodies, "joints": joints, "loads": []})
    assert [body.name for body in scene.bodies] == ["d_1", "d[0]", "d[1]"]
    assert list(solve(build(scene)).to_dict()["bodies"]) == ["d_1"]


def test_bodies_that_stand_for_disks_change_with_their_row() -> None:
    """A sweep of a scene that was read changes numbers of its row: its bodies have them too."""
    tables = finger(**HARD).model_dump(exclude_unset=True, by_alias=True)
    assert scene_from_dict(tables) == finger(**HARD)
    changed = scene_from_dict(tables, ["disks.d.radius=0.004"])
    assert changed == finger(0.004, **HARD)
    assert [body.radius for body in changed.bodies] == [0.004, 0.004]
    wall = {"name": "wall", "kind": "plane", "point": [1, 0, 0], "normal": [-1, 0, 0], "bodies": ["d[1]"]}
    beside = scene_from_dict({**tables, "obstacles": [*tables["obstacles"], wall]}, ["disks.d.radius=0.004"])
    assert [body.radius for body in beside.bodies] == [0.004, 0.004]
    assert [obstacle.bodies for obstacle in beside.obstacles] == [("d[0]", "d[1]"), ("d[1]",)]
    (plane,) = tables["obstacles"]
    single = {**tables, "obstacles": [plane | {"bodies": ["d[1]"]}]}
    of_one = scene_from_dict(single, ["disks.d.radius=0.004"])
    assert [body.radius for body in of_one.bodies] == [0.004, 0.004]
    assert [obstacle.bodies for obstacle in of_one.obstacles] == [("d[1]",)]
    with pytest.raises(SceneError, match="no body is named 'd\\[1\\]'"):
        scene_from_dict(single, ["disks.d.count=1"])
    with pytest.raises(SceneError):
        scene_from_dict({**single, "parameters": ["d.radius"]})
    three = scene_from_dict(tables, ["disks.d.count=3"])
    assert [(joint.body, joint.at) for joint in three.joints] == [("d[0]", 1 / 3), ("d[1]", 2 / 3), ("d[2]", 1.0)]
    with pytest.raises(SceneError):
        scene_from_dict({**tables, "parameters": ["d.radius"]})


def test_a_disk_that_stands_on_its_face_in_exact_contact() -> None:
    """A rod that is bent to the floor presses on it within the face, not by the rim: its arm is shorter."""
    tables = finger(**HARD).model_dump(exclude_unset=True, by_alias=True)
    tables["rods"][0]["intrinsic"] = {"curvature": [0, np.pi / 2 / LENGTH, 0]}
    tip = 2 * LENGTH / np.pi
    floor = {"name": "floor", "kind": "plane", "point": [0, 0, -tip - THICKNESS / 2 + 2e-4], "normal": [0, 0, 1]}
    solution = solve(build(scene_from_dict({**tables, "obstacles": [{**floor, "bodies": ["d[1]"]}], "loads": []})))
    (contact,) = solution.contacts
    arm = abs(solution.base_wrench().moment[1]) / contact.force[2]
    assert solution.converged
    assert abs(arm - solution.tip().position[0]) < 0.5 * RADIUS


def test_the_radius_of_disks_that_touch_as_a_parameter() -> None:
    radius = 1.1 * RADIUS
    bound = solve(build(finger(parameters=("d.radius",))), parameters={"d.radius": radius})
    there = solve(build(finger(radius)))
    assert_allclose(bound.x, there.x, rtol=0, atol=1e-9)
    assert_allclose(bound.contacts[0].force, there.contacts[0].force, rtol=0, atol=1e-7)
    assert_allclose(there.contacts[0].force, shot(radius)[1] * NORMAL, rtol=0, atol=5e-3)


@pytest.mark.slow
def test_disks_touch_in_c(tmp_path: Path) -> None:
    model = build(finger(), discretise(finger(), 2, 5))
    compiled = load(export(model, tmp_path / "finger", "finger"))
    assert_allclose(compiled.solve().x, solve(model).x, rtol=0, atol=1e-10)


def test_the_gap_of_a_disk_vs_all_points_of_its_rim() -> None:
    """To a ball it is less than the true one, by R² (n·t)²/2D at most."""
    away, ball, thickness = 0.05, 0.03, 2e-3
    obstacle = Sphere(name="ball", kind="sphere", centre=(0, 0, 0), radius=ball, width=1e-3)
    layer = ContactLayer.model_construct(name="", obstacle=obstacle, stiffness=1.0, at=1.0)
    push = push_on_disk(layer)
    around = np.linspace(0, 2 * np.pi, 2001)
    rim = np.stack([RADIUS * np.cos(around), RADIUS * np.sin(around), 0 * around], axis=1)
    for quaternion in np.random.default_rng(3).normal(size=(20, 4)):
        rotation = rotations(quaternion[None] / np.linalg.norm(quaternion))[0]
        centre = away * np.array([0.6, 0.0, 0.8])
        slant = abs(rotation[:, 2] @ centre) / away
        corners = [centre + (rim + np.array([0, 0, side])) @ rotation.T for side in (-thickness / 2, thickness / 2)]
        nearest = np.linalg.norm(np.concatenate(corners), axis=1).min() - ball
        gap = float(push(centre, rotation, [RADIUS, thickness])[0])
        rounded = 1e-2 * (RADIUS + thickness)
        less = (RADIUS * slant + thickness / 2) ** 2 / (2 * (away - RADIUS))
        assert nearest - less - rounded < gap < nearest + rounded


@pytest.mark.slow
def test_a_rod_on_disks_slides_as_a_point_mass() -> None:
    """Down an incline: its weight rests on the rims, whose friction tips it, and its energies balance."""
    slope, friction, radius, density, length = 0.5, 0.3, 0.02, 0.3, 0.2
    weight = density * length * GRAVITY * np.cos(slope)
    gap = WIDTH - np.cbrt(weight / 2 * 3 * WIDTH**2 / (2 * radius * STIFFNESS))
    rod = {
        "name": "rod",
        "length": length,
        "strain": "planar",
        "stiffness": {"bending_y": 50.0},
        "linear_density": density,
        "rotary_inertia": [1e-5, 1e-5, 1e-5],
        "base": {"position": [0, 0, radius + gap], "tangent": [1, 0, 0], "free": True},
    }
    plane = {"name": "plane", "kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1], "disks": ["feet"]}
    soft = {"width": WIDTH, "stiffness": STIFFNESS, "damping": 5.0, "friction": friction, "slip_speed": SLIP}
    gravity = [GRAVITY * np.sin(slope), 0, -GRAVITY * np.cos(slope)]
    scene = scene_from_dict(
        {
            "schema": 1,
            "rods": [rod],
            "disks": [{"name": "feet", "rod": "rod", "at": [0.2, 0.8], "radius": radius, "thickness": 0.0}],
            "obstacles": [{**plane, **soft}],
            "loads": [{"name": "weight", "kind": "gravity", "acceleration": gravity}],
            "simulation": {"duration": DURATION, "start": "unloaded", "tolerance": 1e-4},
        }
    )
    motion = simulate(build(scene, discretise(scene, 1, 4)))
    assert motion.converged, motion.message
    middle = motion.section("rod", [0.5]).position[:, 0, 0]
    assert_allclose(middle[-1] - middle[0], slid(slope, friction), rtol=5e-3, atol=0)
    # Friction acts a radius below the rod: what it tips by the front foot bears beyond its half, and the rear less.
    tipped = friction * weight * radius / (0.6 * length)
    borne = np.array([weight / 2 - tipped, weight / 2 + tipped])
    depths = np.cbrt(3 * borne * WIDTH**2 / (2 * radius * STIFFNESS))
    heights = motion.section("rod", [0.2, 0.8]).position[-1, :, 2]
    assert_allclose(heights, radius + WIDTH - depths, rtol=0, atol=1e-5)
    taken = friction * weight * (middle[-1] - middle[0])
    assert_allclose(motion.energy.dissipated[-1], taken, rtol=2e-2, atol=0)
    assert np.abs(motion.energy.imbalance).max() < 1e-3
    assert np.all(np.diff(motion.energy.dissipated) >= 0)


@pytest.mark.parametrize(
    ("changes", "where", "problem"),
    [
        (
            {**HARD, "kind": "sphere", "centre": [0.3, 0, -1], "radius": 0.5, "point": None, "normal": None},
            "obstacles[0].disks[0]",
            "'d' has a rim, and no closed form says where a rim meets a curved obstacle",
        ),
        (
            {**HARD, "parameters": ("d.radius",)},
            "obstacles[0].disks[0]",
            "disks of 'd' touch exactly, and their numbers cannot be parameters",
        ),
        ({"disks": ["e"]}, "obstacles[0].disks[0]", "no row of disks is named 'e'"),
    ],
)
def test_refusals(changes: dict[str, Any], where: str, problem: str) -> None:
    with pytest.raises(SceneError) as refused:
        finger(**changes)
    assert (where, problem) in [(one.where, one.problem) for one in refused.value.problems]


@pytest.mark.parametrize("of_row", [False, True])
def test_a_motion_of_disks_in_exact_contact_names_a_remedy(of_row: bool) -> None:
    """A row becomes smooth with a width; a body that is a disk would be refused beside one, listed or not."""
    tables = finger(**HARD).model_dump(exclude_unset=True, by_alias=True)
    if not of_row:
        tables = json.loads(json.dumps(tables).replace("d[0]", "foot").replace("d[1]", "hand"))
    (problem,) = untouchable(build(scene_from_dict(tables)), Simulation(duration=1.0))
    assert problem.problem.endswith("these are disks: d[0], d[1]" if of_row else "these are disks: foot, hand")
    assert ("width" if of_row else "balls") in problem.remedy.split(";")[0]


def test_a_name_of_a_disk_is_no_name_for_a_listed_body() -> None:
    with pytest.raises(SceneError) as refused:
        finger_with_body("e[0]")
    (problem,) = refused.value.problems
    assert problem.where == "bodies[0].name"
    assert problem.problem == "'e[0]' is the name of a disk of a row, or of a joint"
    assert model_names("robot", build(finger(**HARD))).function("body", "d[0]") == "robot_body_d_0"
    with pytest.raises(ExportError, match="'d\\[0\\]' gives a function the name that body 'd_0' gives another"):
        model_names("robot", build(finger_with_body("d_0")))


def finger_with_body(name: str) -> Scene:
    """The cantilever with disks on a hard floor and a body inside it."""
    tables = finger(**HARD).model_dump(exclude_unset=True, by_alias=True)
    joint = {"kind": "fixed", "body": name, "rod": "a", "at": 0.25}
    others = {"bodies": [{"name": name}, *tables["bodies"]], "joints": [joint, *tables["joints"]]}
    return scene_from_dict({**tables, **others})
