"""Stops of joints and slack cables beside obstacles without a width, in one motion: blows that meet."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from cosserat_casadi import MotionOutcome, build, scene_from_dict, simulate
from cosserat_casadi.maths import chebyshev
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.contact_sections import RodFacing
from cosserat_casadi.motion.facings import facings
from cosserat_casadi.motion.simulate import Simulator, started
from cosserat_casadi.numerics.integration import StepOutcome
from cosserat_casadi.scene import Scene
from tests.families import mostly_slow
from tests.model.test_base_joints import GRAVITY, link, scene
from tests.model.test_joints_of_bodies import ARMS, FIRST, INERTIAS, MASSES, body, hinge

WIDE = 1.2
"""Angle of the upper link from the vertical at which it leans on its stop, rad."""

RADIUS = 0.02
"""Of the ball of the lower link, m."""

FLOORS = {0.2: 0.66, 0.4: 0.54}
"""Height of a floor, m, by the distance of the ball from its hinge, m: above the centre of percussion, and below it."""


def leaning(reach: float) -> dict[str, Any]:
    """Two links in the world: the upper one on its stop, the lower one let go, so that its ball strikes a floor."""
    shoulder = hinge(
        {"world": True, "position": [0, 0, 1], "rotation_vector": [0, -WIDE, 0]},
        {"body": "upper"},
        name="shoulder",
        upper_stop=0.0,
    )
    elbow = hinge({"body": "upper", "position": [0, 0, -FIRST]}, {"body": "lower", "position": [0, 0, reach]})
    lower = body(1, centre_of_mass=[0, 0, reach - ARMS[1]], radius=RADIUS)
    plane = {
        "name": "floor",
        "kind": "plane",
        "point": [0, 0, FLOORS[reach]],
        "normal": [0, 0, 1],
        "bodies": ["lower"],
        "restitution": 1.0,
    }
    settings = {"duration": 0.2, "frames": 21, "start": "unloaded", "tolerance": 1e-6}
    beside = [link("a", base={"position": [1, 0, 0]})]
    return scene(
        beside,
        [shoulder, elbow],
        accuracy={"modes": 1, "nodes": 4},
        bodies=[body(0), lower],
        obstacles=[plane],
        simulation=settings,
    )


def mass(q: FloatArray) -> FloatArray:
    coupling = MASSES[1] * FIRST * ARMS[1] * np.cos(q[0] - q[1])
    first, second = INERTIAS + MASSES * ARMS**2
    return np.array([[first + MASSES[1] * FIRST**2, coupling], [coupling, second]])


def efforts(q: FloatArray, v: FloatArray) -> FloatArray:
    swirl = MASSES[1] * FIRST * ARMS[1] * np.sin(q[0] - q[1]) * np.array([-(v[1] ** 2), v[0] ** 2])
    arms = np.array([MASSES[0] * ARMS[0] + MASSES[1] * FIRST, MASSES[1] * ARMS[1]])
    return np.asarray(swirl - GRAVITY * arms * np.sin(q))


def gap(q: FloatArray, reach: float) -> float:
    """Of the ball from the floor, m."""
    return float(1 - FIRST * np.cos(q[0]) - reach * np.cos(q[1])) - FLOORS[reach] - RADIUS


def rates(_: float, y: FloatArray, held: bool) -> FloatArray:
    """Of angles and their rates; the upper link rests while it is held."""
    q, v = y[:2], y[2:]
    a = np.array([0.0, efforts(q, v)[1] / mass(q)[1, 1]]) if held else np.linalg.solve(mass(q), efforts(q, v))
    return np.concatenate([v, a])


def swung(reach: float, times: FloatArray) -> tuple[FloatArray, float, bool]:
    """Angles of the links, time of the blow, and whether it takes the upper link off its stop."""

    def strikes(_: float, y: FloatArray, held: bool) -> float:
        return gap(y[:2], reach)

    strikes.terminal = True  # type: ignore[attr-defined]
    exact = {"rtol": 1e-11, "atol": 1e-12, "dense_output": True}
    first = solve_ivp(rates, (0, times[-1]), [-WIDE, -WIDE, 0, 0], args=(True,), events=strikes, **exact)
    q, v, blow = first.y[:2, -1], first.y[2:, -1], float(first.t[-1])
    slope = np.array([FIRST, reach]) * np.sin(q)
    answer = np.linalg.solve(mass(q), slope)
    # The plane gives all of the speed back, the stop none.
    freed = v - 2.0 * (slope @ v) / (slope @ answer) * answer
    leaves = bool(freed[0] < 0.0)
    onward = freed if leaves else np.array([0.0, -v[1]])
    second = solve_ivp(rates, (blow, times[-1]), [*q, *onward], args=(not leaves,), **exact)
    angles = [first.sol(time)[:2] if time < blow else second.sol(time)[:2] for time in times]
    return np.array(angles), blow, leaves


@pytest.mark.parametrize("reach", mostly_slow(FLOORS, [0.2]))
def test_a_blow_of_a_floor_takes_a_joint_off_its_stop_or_presses_it_on(reach: float) -> None:
    motion = simulate(scene_from_dict(leaning(reach)))
    assert motion.converged
    angles, blow, leaves = swung(reach, motion.times)
    assert leaves == (reach < 0.25)
    kinds = [event.kind for event in motion.events]
    assert kinds == (["stop_left", "impact"] if leaves else ["impact"])
    assert_allclose([event.time for event in motion.events], blow, rtol=0, atol=1e-6)
    elbow = np.column_stack([-FIRST * np.sin(angles[:, 0]), 0 * angles[:, 0], 1 - FIRST * np.cos(angles[:, 0])])
    ball = elbow - reach * np.column_stack([np.sin(angles[:, 1]), 0 * angles[:, 1], np.cos(angles[:, 1])])
    assert_allclose(motion.body("lower").position, ball, rtol=0, atol=2e-6)
    assert np.abs(motion.energy.imbalance).max() < 1e-5


STOP = 0.3
"""Way of the upper link to its stop, rad."""


def sliding(reach: float) -> dict[str, Any]:
    """Two links in one line, whose ball rests on a floor; let go, it slides until the upper link meets its stop."""
    tables = leaning(reach)
    tables["joints"][0]["upper_stop"] = STOP
    height = 1.0 - (FIRST + reach) * np.cos(WIDE) - RADIUS
    tables["obstacles"][0] |= {"point": [0, 0, height], "restitution": 0.5}
    tables["simulation"] |= {"duration": 0.23, "frames": 24}
    return tables


def slid(reach: float, times: FloatArray) -> tuple[FloatArray, float, bool]:
    """Angles of the links, time at which the stop is met, and whether that jerks the ball off the floor."""

    def lever(q: FloatArray) -> FloatArray:
        return np.array([FIRST, reach]) * np.sin(q)

    def on_floor(_: float, y: FloatArray) -> FloatArray:
        q, v = y[:2], y[2:]
        turning = np.array([FIRST, reach]) @ (np.cos(q) * v**2)
        bordered = np.block([[mass(q), -lever(q)[:, None]], [lever(q)[None], np.zeros((1, 1))]])
        return np.concatenate([v, np.linalg.solve(bordered, np.append(efforts(q, v), -turning))[:2]])

    def meets(_: float, y: FloatArray) -> float:
        return float(y[0] + WIDE - STOP)

    meets.terminal = True  # type: ignore[attr-defined]
    exact = {"rtol": 1e-11, "atol": 1e-12, "dense_output": True}
    first = solve_ivp(on_floor, (0, times[-1]), [-WIDE, -WIDE, 0, 0], events=meets, **exact)
    q, v, blow = first.y[:2, -1], first.y[2:, -1], float(first.t[-1])
    # The stop alone takes the upper link's speed; where the lower one then presses on the floor both stand still.
    swings = v[1] + mass(q)[0, 1] / mass(q)[1, 1] * v[0]
    leaves = bool(lever(q)[1] * swings > 0.0)
    second = solve_ivp(rates, (blow, times[-1]), [*q, 0.0, swings], args=(True,), **exact)
    angles = [first.sol(t)[:2] if t < blow else second.sol(t)[:2] if leaves else q for t in times]
    return np.array(angles), blow, leaves


@pytest.mark.parametrize("reach", mostly_slow(FLOORS, [0.2]))
def test_a_stop_jerks_what_slides_off_a_floor_or_presses_it_on(reach: float) -> None:
    """The floor held the ball that the stop jerked off: both links stood still at once, told to be right to 1e-7."""
    motion = simulate(scene_from_dict(sliding(reach)))
    assert motion.converged
    angles, blow, leaves = slid(reach, motion.times)
    assert leaves == (reach < 0.25)
    assert {event.kind for event in motion.events} == ({"stop_hit", "lift_off"} if leaves else {"stop_hit"})
    assert_allclose([event.time for event in motion.events], blow, rtol=0, atol=1e-6)
    across = -FIRST * np.sin(angles[:, 0]) - reach * np.sin(angles[:, 1])
    height = 1.0 - FIRST * np.cos(angles[:, 0]) - reach * np.cos(angles[:, 1])
    assert_allclose(motion.body("lower").position, np.column_stack([across, 0 * across, height]), rtol=0, atol=2e-6)
    assert np.abs(motion.energy.imbalance).max() < 1e-5


@pytest.mark.parametrize("reach", mostly_slow(FLOORS, [0.2]))
def test_a_stop_beside_hardly_any_friction_acts_as_without(reach: float) -> None:
    """Steps with friction have stops among what touches; they told none before."""
    tables = sliding(reach)
    tables["obstacles"][0]["friction"] = 1e-8
    motion = simulate(scene_from_dict(tables))
    assert motion.converged
    angles, blow, _ = slid(reach, motion.times)
    (hit,) = [event for event in motion.events if event.owner == "shoulder"]
    assert (hit.kind, hit.obstacle, hit.of_body) == ("stop_hit", "upper_stop", False)
    assert_allclose(hit.time, blow, rtol=0, atol=1e-6)
    across = -FIRST * np.sin(angles[:, 0]) - reach * np.sin(angles[:, 1])
    assert_allclose(motion.body("lower").position[:, 0], across, rtol=0, atol=2e-6)
    assert np.abs(motion.energy.imbalance).max() < 1e-5
    # Nothing but its stop acts along the joint.
    states = np.array([motion.model.joint["shoulder"](*at) for at in zip(motion.x, motion.inputs, strict=True)])
    effort, _, push = states.reshape(-1, 3).T
    held = motion.times > blow
    assert_allclose(push, effort, rtol=1e-6, atol=1e-9)
    assert np.all(push[~held] == 0.0) and np.all(push[held] < 0.0)


def arm_with_cable(**floor: Any) -> Scene:
    """An arm over a floor, whose cable spans its inner half: the bend of the gap jumps at the cable's holes."""
    rod = {
        "name": "arm",
        "length": 0.3,
        "strain": "planar",
        "material": {"youngs_modulus": 2e6, "poisson_ratio": 0.48, "density": 1100},
        "section": {"shape": "circle", "radius": 0.005},
        "base": {"tangent": [1, 0, 0]},
        "damping": {"retardation_time": 0.002},
    }
    cable = {"name": "cable", "kind": "tendon", "rod": "arm", "length": 0.15, "slack": True, "offset": [-8e-3, 0.0]}
    plane = {"name": "floor", "kind": "plane", "point": [0, 0, -0.02], "normal": [0, 0, 1], **floor}
    return scene_from_dict(
        {
            "schema": 1,
            "accuracy": {"modes": 5, "nodes": 12},
            "rods": [rod],
            "loads": [{"name": "weight", "kind": "gravity", "acceleration": [0, 0, -9.81]}],
            "actuators": [cable | {"span": [0, 0.5], "holes": [0.25, 0.5]}],
            "obstacles": [plane],
            "simulation": {"duration": 0.113, "frames": 3, "start": "unloaded"},
        }
    )


def test_a_cable_that_a_blow_of_a_floor_slackens_is_not_taut_again_without_end() -> None:
    """The tip strikes, the cable answers in 1e-6 s: a step that does not see it would have it change again at once."""
    scene = arm_with_cable()
    assert scene.simulation is not None
    model = build(scene, moving=True)
    history = Simulator(model, scene.simulation, started(model, scene.simulation, None)).controlled(1e-2)
    assert history.outcome is StepOutcome.COMPLETED
    # Where the tip leaves, it may be back for 1e-11 J: rounding decides that at this tolerance.
    blows = [event for event in history.events if event.kind == "impact" and event.place == 1.0 and event.energy > 1e-9]
    assert len(history.events) < 40
    # Blows of the tip: 0.0563 s and 0.1114 s at each tolerance of a step from 1e-3 to 1e-6.
    assert_allclose([blow.time for blow in blows[:2]], [0.0563, 0.1114], rtol=0, atol=5e-4)


@pytest.mark.slow
def test_a_cable_beside_hardly_any_friction_acts_as_without() -> None:
    """It goes slack, and is taut again, as a floor strikes the arm; both kinds of steps agree to the tolerance."""
    motions = [simulate(build(arm_with_cable(**given), moving=True)) for given in ({}, {"friction": 1e-8})]
    assert all(motion.outcome in (MotionOutcome.COMPLETED, MotionOutcome.UNRESOLVED) for motion in motions)
    allowed = sum(motion.error_estimate for motion in motions)
    assert allowed < 5e-3
    tips = [motion.tip("arm").position for motion in motions]
    assert np.abs(tips[1] - tips[0]).max() < 0.3 * allowed
    # Rounding decides whether a cable that is taut at the start becomes so in an event; from 0.11 s on a blow is near.
    late = [[event for event in motion.events if 0.01 < event.time < 0.1] for motion in motions]
    for found in late:
        kinds = [event.kind for event in found if event.kind in ("taut", "slack")]
        assert kinds == ["taut", "slack", "taut"]
    first, second = (next(event for event in found if event.kind == "taut") for found in late)
    assert (first.owner, first.obstacle) == (second.owner, second.obstacle) == ("cable", "")
    assert_allclose(second.time, first.time, rtol=0, atol=1e-4)
    assert_allclose(second.energy, first.energy, rtol=0.02, atol=0)
    (tension,) = [motions[0].model.discrete.tension(cable).start for cable in motions[0].model.discrete.cables]
    assert_allclose(
        motions[1].x[:, tension], motions[0].x[:, tension], rtol=0, atol=0.01 * motions[0].x[:, tension].max()
    )


@pytest.mark.parametrize("valley", [0.51, 0.6, 0.9])
def test_a_contact_that_has_left_its_element_is_beyond_its_end(valley: float) -> None:
    """Where the polynomials of its element have no valley near it, its place is not the end itself.

    There it would count as within its element: a rod slid on and sank into a floor by 8e-4 of its length.
    """
    model = build(arm_with_cable(), moving=True)
    (facing,) = facings(model)
    assert isinstance(facing, RodFacing)
    shares = np.asarray(chebyshev.nodes(model.discrete.rods["arm"].grid.intervals))
    places = np.concatenate([start + (end - start) * shares for start, end in pairwise(facing.ends)])
    inner = np.arange(len(places)) < 2 * len(shares)
    # Up to 0.5 the gap falls and bends towards the obstacle, as far as its polynomial goes; the valley is beyond.
    for bend in (-0.1, 1e-3):
        falls = 0.05 * (0.5 - places) + bend * (places - 0.5) ** 2
        heights = np.where(inner, falls, (places - valley) ** 2 - (0.5 - valley) ** 2)
        nodes = 0.3 * np.column_stack([places, 0.0 * places, heights])
        place = facing.place(nodes, 0.47, 1)
        assert 0.5 < place <= 0.55
