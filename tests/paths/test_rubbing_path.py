"""Paths with friction of exact contact: against shooting, rolling, motions, and what friction leaves open."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from cosserat_casadi import build, follow, parse_scene, read_scene, scene_from_dict, simulate, solve
from cosserat_casadi.errors import SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.numerics.arclength import ArcSettings
from cosserat_casadi.numerics.trace import PathOutcome
from cosserat_casadi.paths.rubbing_path import RubbingArrangement, RubbingPath
from tests.conftest import ROOT
from tests.families import mostly_slow
from tests.paths.test_contact_path import TABLE, root

BENDING, FRICTION = 0.5, 0.3


def tables(radius: float = 0.0, friction: Any = FRICTION, floor: float = -0.05, slope: float = 0.0) -> dict[str, Any]:
    """A clamped rod of 1 m above a floor, with a push at its tip and a base that may move."""
    rod: dict[str, Any] = {"name": "rod", "length": 1.0, "strain": "planar", "base": {"tangent": [1, 0, -slope]}}
    if radius:
        modulus = 4 * BENDING / (np.pi * radius**4)
        rod["section"] = {"shape": "circle", "radius": radius}
        rod["material"] = {"youngs_modulus": modulus, "poisson_ratio": 0.3, "density": 1e-9}
    else:
        rod["stiffness"] = {"bending_y": BENDING}
    obstacle = {"name": "floor", "kind": "plane", "point": [0, 0, floor], "normal": [0, 0, 1], "friction": friction}
    return {
        "schema": 1,
        "rods": [rod],
        "loads": [{"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0, 0, 0]}],
        "inputs": ["rod.base.position", "push.force"],
        "obstacles": [obstacle],
        "accuracy": {"modes": 8},
    }


def followed(
    model: Model, name: str, value: list[float] | float, first: RubbingPath | None = None, **options: Any
) -> RubbingPath:
    path = follow(model, name, value, first=first, **options)
    assert isinstance(path, RubbingPath)
    return path


def kinds(path: RubbingPath) -> list[str]:
    return [event.kind for event in path.events]


def bent(curvature: float, force: FloatArray, angle: float = 0.0) -> FloatArray:
    """x, z, θ and κ at the tip of a clamped elastica, whose tip is pulled by a force."""

    def rate(_s: float, state: FloatArray) -> list[float]:
        _, _, angle, curvature = state
        shear = force[0] * np.sin(angle) - force[1] * np.cos(angle)
        return [np.cos(angle), np.sin(angle), curvature, shear / BENDING]

    return np.asarray(
        solve_ivp(rate, (0.0, 1.0), [0.0, 0.0, angle, curvature], "DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    )


def test_a_tip_sticks_to_the_angle_of_friction_and_slides_beyond_it() -> None:
    """While it sticks the rod keeps its shape, and friction balances the pull."""
    model = build(scene_from_dict(tables()))
    pressed = followed(model, "push.force", [0, 0, -1.0])
    assert pressed.converged and kinds(pressed) == ["touch"]
    (before,) = pressed.contacts(-1)
    assert before.friction is not None and not before.slips
    assert_allclose(before.friction, 0.0, rtol=0, atol=1e-9)
    path = followed(model, "push.force", [0.6, 0, -1.0], pressed)
    assert path.converged and kinds(path) == ["slip"]
    assert_allclose(path.events[0].factor, FRICTION * before.ends[0] / 0.6, rtol=1e-6, atol=0)
    check_slipping_tip(path, 0.0, np.array([0.6, -1.0]), -1.0)


@pytest.mark.parametrize("radius", mostly_slow([0.0, 0.02], quick=[0.02]))
def test_a_tip_that_is_dragged_bears_the_moment_of_friction(radius: float) -> None:
    path = dragged(radius)
    assert path.converged and kinds(path) == ["slip"]
    check_slipping_tip(path, radius, np.array([0.0, -1.0]), 1.0)


def check_slipping_tip(path: RubbingPath, radius: float, push: FloatArray, sign: float) -> None:
    """Hold the end of a path, with a tip that slips on the floor, against shooting with friction of this sign."""

    def end(guess: FloatArray) -> FloatArray:
        curvature, normal = guess
        return bent(curvature, push + np.array([sign * FRICTION * normal, normal]))

    def missed(guess: FloatArray) -> FloatArray:
        _, z, _, curvature = end(guess)
        # Friction t acts the radius below the centre of the tip: the moment about −y is radius times t.
        return np.array([z + 0.05 - radius, curvature - radius * sign * FRICTION * guess[1] / BENDING])

    found = root(missed, [-0.2, 0.9])
    force = np.array([sign * FRICTION * found[1], 0.0, found[1]])
    (contact,) = path.contacts(-1)
    assert contact.slips and contact.friction is not None
    assert_allclose([contact.friction[0], 0.0, contact.ends[0]], force, rtol=1e-7, atol=0)
    assert_allclose(contact.friction[1:], 0.0, rtol=0, atol=1e-12)
    base = path.position(0.0)[-1]
    assert_allclose(path.tip().position[-1] - base, [end(found)[0], 0, radius - 0.05], rtol=0, atol=1e-7)
    solution = path.solution(-1)
    assert solution.converged
    assert_allclose(solution.contacts[0].force, force, rtol=1e-7, atol=1e-12)
    assert_allclose(solution.base_wrench().force, -force - [push[0], 0, push[1]], rtol=0, atol=1e-9)


def test_files_tell_friction_and_the_event_of_the_slip() -> None:
    path = dragged(0.02)
    (event,) = path.to_dict()["events"]
    assert event["kind"] == "slip" and event["contact"]["rod"] == "rod"
    last = path.to_dict()["path"][-1]["contacts"]
    assert [(contact["slips"], contact["obstacle"]) for contact in last] == [(True, "floor")]
    assert_allclose(np.linalg.norm(last[0]["friction"]), FRICTION * last[0]["point_forces"][0], rtol=1e-9, atol=0)


@cache
def dragged(radius: float = 0.0) -> RubbingPath:
    """The tip is pressed down, and then the base is pulled back until the tip slides."""
    model = build(scene_from_dict(tables(radius)))
    pressed = followed(model, "push.force", [0, 0, -1.0])
    return followed(model, "rod.base.position", [-0.05, 0, 0], pressed)


@pytest.mark.slow
def test_a_load_that_goes_back_leaves_a_contact_that_sticks() -> None:
    """It slides back only when friction has turned; each increment takes energy."""
    out = dragged()
    back = followed(out.model, "rod.base.position", [0.05, 0, 0], out)
    assert back.converged and kinds(back) == ["stick", "slip"]
    frictions = [path.contacts(-1)[0].friction for path in (out, back)]
    assert frictions[0] is not None and frictions[1] is not None
    assert frictions[0][0] > 0.0 > frictions[1][0]
    # With one shape slid to and fro, but for the direction of friction: dragged on, it stays as it is.
    on = followed(out.model, "rod.base.position", [0.1, 0, 0], back)
    assert kinds(on) == []
    assert_allclose(on.tip().position[-1] - back.tip().position[-1], [0.05, 0, 0], rtol=0, atol=1e-9)


@pytest.mark.slow
def test_a_tip_that_sticks_rolls() -> None:
    """Lowered on a rough floor its centre advances by the radius times the angle, whatever turns it."""
    radius = 0.02
    model = build(scene_from_dict(tables(radius, 4.0, -0.75, 1.0)))
    errors = []
    for change in (0.1, 0.05):
        settings = ArcSettings(load_factor_change=change, longest=2.5 * change)
        path = followed(model, "rod.base.position", [0, 0, -0.2], settings=settings)
        assert path.converged and kinds(path) == ["touch"]
        first = int(np.flatnonzero(path.factor == path.events[0].factor)[-1])
        tips = path.tip()
        angle = np.arctan2(tips.rotation[:, 2, 2], tips.rotation[:, 0, 2])
        rolled = tips.position[first:, 0] - tips.position[first, 0] + radius * (angle[first:] - angle[first])
        errors.append(np.abs(rolled).max())
        assert angle[-1] - angle[first] < -0.5
    # Implicit Euler turns the arm by chords.
    assert errors[0] < 2e-3 * radius and errors[1] < 0.6 * errors[0]


@pytest.mark.slow
def test_a_rod_on_a_rough_bar_rolls_along_it() -> None:
    """Once it sticks, the place of contact goes along the rod as far as round the bar: what rolls does not slide."""
    radius = 0.1
    bar = {"name": "bar", "kind": "capsule", "from": [0.5, -1, -0.15], "to": [0.5, 1, -0.15], "radius": radius}
    model = build(scene_from_dict(tables() | {"obstacles": [bar | {"friction": 5.0}]}))
    path = followed(model, "push.force", [0, 0, -2.0])
    assert path.converged and kinds(path) == ["touch", "stick"]
    ways = []
    for index in range(path.events[1].position, len(path.factor)):
        (contact,) = path.contacts(index)
        assert not contact.slips
        centre = path.position(contact.start)[index]
        ways.append((contact.start, radius * np.arctan2(centre[0] - 0.5, centre[2] + 0.15)))
    along, round_bar = (np.array(ways)[1:] - ways[0]).T
    assert along[-1] > 3e-3
    assert_allclose(round_bar, along, rtol=0, atol=1e-7)


def test_the_jacobian_is_that_of_differences() -> None:
    """With a place that moves along a round rod, which sticks or slips after a point at another place."""
    bar = {"name": "bar", "kind": "capsule", "from": [0.4, -0.5, -0.14], "to": [0.5, 0.5, -0.14], "radius": 0.1}
    scene = tables(0.02) | {"obstacles": [bar | {"friction": FRICTION}], "accuracy": {"modes": 4}}
    scene["rods"][0]["strain"] = "kirchhoff"
    path = followed(build(scene_from_dict(scene)), "push.force", [0, 0, -0.5])
    arrangement = path.arrangements[-1]
    assert isinstance(arrangement, RubbingArrangement)
    before = arrangement.before(path.x[-2], float(path.factor[-2]))
    here = arrangement.changed(before=before, stiffness=10.0).at(1.0)
    rng = np.random.default_rng(3)
    for push, sticks in ((1.0, False), (3.0, True)):
        z = path.x[-1].copy()
        z[here.nominal.model.size] *= push
        assert (here.excess(z)[0] < 0.0) == sticks
        way = rng.normal(size=len(z))
        step = 1e-6
        ahead, behind = (here.residual(z + change * way, here.given) for change in (step, -step))
        difference = (ahead - behind) / (2 * step)
        derivative = here.jacobian(z, here.given) @ way
        assert_allclose(derivative, difference, rtol=0, atol=1e-6 * np.abs(difference).max())


@pytest.mark.slow
def test_an_obstacle_on_a_body_hands_friction_on() -> None:
    """The finger that carries the disk bears the reaction to the force and the friction on the other one."""
    changes = ["accuracy.modes=4", "rim.friction=0.3"]
    path = followed(build(read_scene(ROOT / "examples" / "finger_on_finger.toml", changes)), "flexor.tension", 2.5)
    assert path.converged
    end = path.solution(-1)
    (contact,) = end.contacts
    (own,) = path.contacts(-1)
    assert own.slips and own.friction is not None
    assert_allclose(np.linalg.norm(own.friction), 0.3 * own.ends[0], rtol=1e-9, atol=0)
    assert_allclose(np.linalg.norm(contact.force), np.hypot(1.0, 0.3) * own.ends[0], rtol=1e-9, atol=0)
    assert_allclose(end.base_wrench("upper").force, contact.force, rtol=0, atol=1e-9)
    assert_allclose(end.base_wrench("lower").force, -contact.force, rtol=0, atol=1e-9)


@pytest.mark.slow
def test_slides_are_seen_from_the_body_of_an_obstacle() -> None:
    """A floor on a turned body that a stiff rod holds is the floor in the world."""
    radius = 0.02
    scene = tables(radius)
    post = {"name": "post", "length": 0.1, "strain": "planar", "stiffness": {"bending_y": 1e9}}
    scene["rods"].append(post | {"base": {"position": [0.5, 0, -0.5], "tangent": [1, 0, 0]}})
    scene["bodies"] = [{"name": "plate", "mass": 0.0, "inertia": [0, 0, 0]}]
    scene["joints"] = [{"name": "held", "kind": "fixed", "body": "plate", "rod": "post"}]
    rotation = solve(build(scene_from_dict(scene | {"obstacles": []}))).body("plate").rotation
    assert abs(np.trace(rotation) - 3.0) > 1.0
    (floor,) = scene["obstacles"]
    turned = {"point": (rotation.T @ [-0.6, 0, 0.45]).tolist(), "normal": rotation[2].tolist()}
    scene["obstacles"] = [floor | turned | {"body": "plate", "rods": ["rod"]}]
    model = build(scene_from_dict(scene))
    pressed = followed(model, "push.force", [0, 0, -1.0])
    path = followed(model, "rod.base.position", [-0.05, 0, 0], pressed)
    still = dragged(radius)
    assert kinds(path) == kinds(still)
    assert_allclose(path.events[0].factor, still.events[0].factor, rtol=1e-5, atol=0)
    assert_allclose(path.contacts(-1)[0].friction, still.contacts(-1)[0].friction, rtol=0, atol=1e-7)
    assert_allclose(path.tip("rod").position[-1], still.tip().position[-1], rtol=0, atol=1e-7)


def test_what_is_not_followed_is_said() -> None:
    """A rod that lies down, and coefficients by direction, for which the path is that without friction."""
    lying = parse_scene(TABLE, ["table.friction=0.3", "accuracy.modes=6"])
    path = follow(build(lying), "lift.force", [0, 0, 0.8])
    assert path.outcome is PathOutcome.NO_START
    assert "'rod' lies down on 'table': friction along a line of contact is not followed" in path.message
    paths = []
    for friction in ({"along": 0.3, "across": 0.1}, 0.0):
        model = build(scene_from_dict(tables(friction=friction)))
        paths.append(follow(model, "push.force", [0.3, 0, -1.0]))
    assert "by a table of coefficients, acts in motion alone" in paths[0].message and "table" not in paths[1].message
    assert_allclose(paths[0].tip().position[-1], paths[1].tip().position[-1], rtol=0, atol=1e-12)
    with pytest.raises(SceneError, match="branch"):
        follow(dragged(0.02).model, "push.force", [0, 0, -1.0], branch=1)
    with pytest.raises(SceneError, match="does not depend on the way"):
        follow(paths[1].model, "push.force", [0, 0, -1.0], first=dragged(0.02))


@pytest.mark.slow
def test_what_friction_leaves_open_is_told() -> None:
    """Above the friction of which a slope of 45° wedges, a tip that is pulled outwards jumps off."""
    steep = tables(friction=1.5, floor=-0.6, slope=1.0)
    model = build(scene_from_dict(steep))
    path = followed(model, "push.force", [3.0, 0, 0])
    assert path.outcome is PathOutcome.LOAD_STALLED
    assert "friction does not determine how the path goes on: 'rod' may stick on 'floor'" in path.message
    inwards = followed(model, "push.force", [-3.0, 0, 0])
    assert inwards.converged and kinds(inwards) == ["slip"] and "determine" not in inwards.message
    wedged = followed(
        build(scene_from_dict(tables(friction=1.5, floor=-0.75, slope=1.0))), "rod.base.position", [0, 0, -0.1]
    )
    assert wedged.outcome is PathOutcome.CONTACT_UNSETTLED and "Friction may wedge 'rod'" in wedged.message


def test_friction_that_nothing_determines_is_told_and_stays_as_it_was() -> None:
    """A nearly straight rod, clamped and inextensible, sticks on a peg: clamp and peg share the pull along it."""
    peg = {"name": "peg", "kind": "capsule", "from": [0.8, -1, -0.05], "to": [0.8, 1, -0.05], "radius": 0.05 - 1e-7}
    scene = tables() | {"obstacles": [peg | {"friction": FRICTION}]}
    scene["rods"][0]["stiffness"] = {"bending_y": 5e5}
    pressed = {"push.force": [0, 0, -10.0]}
    path = followed(build(scene_from_dict(scene)), "push.force", [2.0, 0, -10.0], values=pressed)
    (contact,) = path.contacts(-1)
    assert path.converged and contact.friction is not None and not contact.slips
    assert_allclose(contact.friction, 0.0, rtol=0, atol=5e-3 * contact.ends[0])
    assert "it is not determined, and stays as it was" in path.message
    assert "not determined" not in dragged(0.02).message


@pytest.mark.slow
def test_increments_are_refined_with_the_modes() -> None:
    changes = ["bar.friction=0.3", "accuracy.tolerance=1e-3"]
    path = follow(read_scene(ROOT / "examples" / "rod_over_bar.toml", changes), "push.force", [0, 0, -2.0])
    assert path.converged and path.error_estimate is not None and path.error_estimate < 1e-5
    finer = ArcSettings(first=0.02 / 16, load_factor_change=0.1 / 16)
    closer = follow(path.model, "push.force", [0, 0, -2.0], settings=finer)
    assert_allclose(path.tip().position[-1], closer.tip().position[-1], rtol=0, atol=2e-6)


@pytest.mark.slow
def test_a_slow_damped_motion_ends_on_the_path() -> None:
    """A rod is pressed over an oblique bar on which it slides; the motion has the friction of steps in C."""
    radius, duration, push = 0.02, 20.0, [0, 0, -1.0]
    modulus = 4 * BENDING / (np.pi * radius**4)
    rod = {
        "name": "rod",
        "length": 1.0,
        "strain": "kirchhoff",
        "section": {"shape": "circle", "radius": radius},
        "material": {"youngs_modulus": modulus, "poisson_ratio": 0.3, "density": 100.0},
        "base": {"tangent": [1, 0, 0]},
        "damping": {"retardation_time": 0.2},
    }
    bar = {"name": "bar", "kind": "capsule", "from": [0.4, -0.5, -0.14], "to": [0.5, 0.5, -0.14], "radius": 0.1}
    scene = tables() | {"rods": [rod], "obstacles": [bar | {"friction": FRICTION}]}
    del scene["inputs"]
    path = followed(build(scene_from_dict(scene)), "push.force", push)
    values = [[0, 0, 0], push, push]
    scene["motions"] = [{"input": "push.force", "times": [0, duration - 5, duration], "values": values}]
    scene["simulation"] = {"duration": duration, "step": 0.05, "frames": 21}
    motion = simulate(build(scene_from_dict(scene).with_motion_inputs(), moving=True))
    assert motion.converged, motion.message
    (moved,) = motion.contacts[-1]
    (resting,) = path.contacts(-1)
    assert moved.friction is not None and resting.friction is not None
    assert_allclose(np.linalg.norm(moved.force), resting.ends[0], rtol=3e-3, atol=0)
    assert_allclose(moved.friction, resting.friction, rtol=0, atol=3e-3 * np.linalg.norm(resting.friction))
    assert_allclose(moved.at, resting.start, rtol=0, atol=2e-4)


@pytest.mark.slow
def test_smooth_friction_tends_to_it() -> None:
    """A tip on a floor is dragged along by its base: the thinner the layer, the nearer."""
    errors = []
    exact = None
    for width in (None, 4e-3, 1e-3):
        scene = tables()
        if width is not None:
            scene["obstacles"][0] |= {"width": width, "stiffness": 1000 / width}
            scene["accuracy"] = {"modes": 10, "nodes": 40}
        model = build(scene_from_dict(scene))
        pressed = follow(model, "push.force", [0, 0, -2.0])
        lifted = follow(pressed.model, "rod.base.position", [0, 0, 0.1], first=pressed)
        assert lifted.converged
        (contact,) = lifted.solution(-1).contacts
        if exact is None:
            exact = contact.force
            assert kinds(lifted) == ["slip"]
        else:
            errors.append(np.linalg.norm(contact.force - exact) / np.linalg.norm(exact))
    assert errors[0] < 1e-2 and errors[1] < errors[0] / 3
