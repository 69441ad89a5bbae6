"""Friction of exact contact in steps of motions in C: closed forms, smooth friction in Python, differences, energy."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import build, follow, modes_of, scene_from_dict, simulate, solve
from cosserat_casadi.codegen.compiled_motion import StepMemory, StepState
from cosserat_casadi.codegen.status import MotionStatus
from cosserat_casadi.errors import SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.motion.facings import facings
from tests.codegen.libraries import C99, gcc
from tests.codegen.test_steps_in_contact import BALL, LENGTH, Moving, compare_with_differences, floor, rod, scene
from tests.reference.falling_rods import FallingRod

G = 9.81
MASS = 0.2 * LENGTH
FREE = {"position": [0, 0, 0], "tangent": [1, 0, 0], "free": True}
SMALL = {"modes": 1, "nodes": 4, "tolerance": 1e-3}
IN_SPACE = {"bending_y": 0.016, "bending_x": 0.016, "torsion": 0.012}


def block(friction: Any, **more: Any) -> dict[str, Any]:
    """A straight rod on a floor, as stiff as a block."""
    record = rod(base=FREE, stiffness={"bending_y": 0.5})
    return scene(floor(0.0, friction=friction, **more), record, accuracy=SMALL, inputs=["weight.acceleration"])


def run(
    made: Moving, start: StepState, memory: StepMemory, dt: float, inputs: FloatArray, rates: FloatArray | None = None
) -> list[StepState]:
    """States at the ends of steps, with the inputs at their starts, one row for each."""
    states = [start]
    for k, own in enumerate(inputs):
        step = made.compiled.step(states[-1], dt, own, None if rates is None else rates[k], memory=memory)
        assert step.done, (k, step.status.value)
        states.append(step.state)
    return states


def weights(angle: float, count: int) -> FloatArray:
    """Weight on an incline, which goes down along the rod, for so many steps."""
    return np.tile(G * np.array([np.sin(angle), 0.0, -np.cos(angle)]), (count, 1))


def way(made: Moving, states: list[StepState]) -> FloatArray:
    """How far the tip has come along the floor, m."""
    return (made.tips(states)[:, 0] - 1.0) * LENGTH


def test_a_block_sticks_below_the_angle_of_friction_slides_above_it_and_stops(tmp_path: Path) -> None:
    friction = 0.3
    made = Moving(block(friction), tmp_path)
    below, above = np.arctan(friction) * np.array([0.999, 1.5])
    dt, memory, start = 1e-3, made.compiled.step_memory(), made.compiled.contact_start()
    gcc(*C99, "-Werror", "-fsyntax-only", made.folder / "robot" / "robot.c")
    stays = run(made, start, memory, dt, weights(below, 100))
    assert np.abs(way(made, stays)).max() < 1e-13
    contacts = made.compiled.step_contacts(memory)
    assert not any(contact.slips for contact in contacts)
    assert_allclose(sum(contact.friction[0] for contact in contacts), -MASS * G * np.sin(below), rtol=1e-9, atol=0)
    slides = run(made, stays[-1], memory, dt, weights(above, 100))
    assert all(contact.slips for contact in made.compiled.step_contacts(memory))
    down = G * (np.sin(above) - friction * np.cos(above))
    times = dt * np.arange(101)
    assert_allclose(way(made, slides), down * times**2 / 2, rtol=0, atol=1e-12)
    # On the level it is held back by μ g until it stops, and stays.
    speed = down * 0.1
    stops = speed / (friction * G)
    ends = run(made, slides[-1], memory, dt, weights(0.0, 200))
    later = np.minimum(dt * np.arange(201), stops)
    wanted = down * 0.1**2 / 2 + speed * later - friction * G * later**2 / 2
    # Within the step in which it stops the law holds at its stages.
    assert_allclose(way(made, ends), wanted, rtol=0, atol=friction * G * dt**2)
    assert np.ptp(way(made, ends[-100:])) < 1e-13
    # Motions in Python have these steps.
    path = {"times": [0, 0.1], "values": weights(0.0, 2).tolist()}
    moving = block(friction) | {
        "motions": [{"input": "weight.acceleration", **path}],
        "simulation": {"duration": 0.1, "frames": 101, "start": "unloaded", "step": dt},
        "velocities": [{"rod": "rod", "linear": [speed, 0, 0]}],
    }
    motion = simulate(build(scene_from_dict(moving).with_motion_inputs(), moving=True))
    states = run(made, StepState(start.x, motion.v[0], start.a), made.compiled.step_memory(), dt, weights(0.0, 100))
    assert_allclose([state.x for state in states], motion.x, rtol=0, atol=1e-11)
    # How several sections share it is not determined where a rod does not stretch; their sum is.
    assert abs(sum(contact.friction[0] for contact in made.compiled.step_contacts(memory))) < 1e-9


def test_what_touches_keeps_its_gap_in_the_shortest_step(tmp_path: Path) -> None:
    """To close 5e-8 within a step of 1e-5 s would be a blow at 1e-2 lengths per second."""
    made = Moving(block(0.3), tmp_path)
    start = made.compiled.contact_start()

    def begun(gap: float) -> StepState:
        x = start.x.copy()
        x[3] += gap
        return StepState(x, start.v, start.a)

    for gap in (5e-8, -5e-8, -0.9 * SMALL["tolerance"]):
        states = run(made, begun(gap), made.compiled.step_memory(), 1e-5, weights(0.0, 3))
        assert np.diff(made.energies(states)).max() <= 1e-15
        assert np.abs(states[-1].v).max() < 1e-9
        assert_allclose(made.least_gap(states[-1:]), gap, rtol=1e-6, atol=0)
    # A state that is deeper than the tolerance is none of this motion.
    refused = made.compiled.step(begun(-1.1 * SMALL["tolerance"]), 1e-5, weights(0.0, 1)[0])
    assert refused.status is MotionStatus.NOT_SOLVED


@pytest.mark.slow
def test_a_step_in_whose_last_instant_a_block_stops_ends_with_the_step(tmp_path: Path) -> None:
    """A rod that falls beside the block tells how long the step was."""
    friction, dt, speed = 0.3, 1e-3, 1.0
    tables = block(friction)
    (slides,) = tables["rods"]
    tables["obstacles"][0]["rods"] = ["rod"]
    tables["rods"] = [slides, {**slides, "name": "falls", "base": {**FREE, "position": [0, 0, 1]}}]
    made = Moving(tables, tmp_path)
    start, unknowns = made.compiled.contact_start(), made.model.discrete.unknowns
    v = start.v.copy()
    v[unknowns.slice_of(BlockKind.POSE, "rod rod")][0] = friction * G * dt * (1 - 1e-7) / LENGTH
    v[unknowns.slice_of(BlockKind.POSE, "rod falls")][2] = -speed / LENGTH
    step = made.compiled.step(StepState(start.x, v, start.a), dt, weights(0.0, 1)[0])
    assert step.done
    tip, _, _ = made.model.tip["falls"](step.state.x, made.model.pack())
    assert_allclose(float(tip[2]), 1 - speed * dt - G * dt**2 / 2, rtol=0, atol=1e-11)


@pytest.mark.slow
def test_a_block_that_is_shaken_sticks_and_slips_as_its_closed_form(tmp_path: Path) -> None:
    friction, largest, rate = 0.3, 6.0, 20.0
    made = Moving(block(friction), tmp_path)
    errors = []
    for count in (100, 1600):
        dt = 0.6 / count
        times = dt * np.arange(count + 1)
        start = made.compiled.contact_start()
        inputs = np.zeros((count, 3))
        inputs[:, 2] = -G
        inputs[:, 0] = largest * np.sin(rate * times[:-1])
        rates = np.zeros((count, 3))
        rates[:, 0] = np.diff(largest * np.sin(rate * times)) / dt
        found = way(made, run(made, start, made.compiled.step_memory(), dt, inputs, rates))
        errors.append(np.abs(found - shaken(friction * G, largest, rate, times)).max())
    # Steps are cut where it stops and turns back. Where it breaks loose they leave the second power of their length.
    assert errors[0] < 1e-4
    assert errors[1] < errors[0] / 100.0


def shaken(holds: float, largest: float, rate: float, times: FloatArray) -> FloatArray:
    """Way of a block under the acceleration of a sine that is held by friction, by the phases of a fine time."""
    fine = np.linspace(0.0, times[-1], 600_001)
    step = fine[1]
    pulls = largest * np.sin(rate * (fine + step / 2))
    x, v, ways = 0.0, 0.0, [0.0]
    for pull in pulls[:-1]:
        if v == 0.0 and abs(pull) <= holds:
            ways.append(x)
            continue
        against = np.sign(v) if v != 0.0 else np.sign(pull)
        after = v + step * (pull - against * holds)
        # It stops within the step, and goes on only where the pull is stronger.
        after = 0.0 if v * after < 0.0 else after
        x += step * (v + after) / 2
        v = after
        ways.append(x)
    return np.interp(times, fine, ways)


@pytest.mark.slow
@pytest.mark.parametrize("friction", [0.1, 0.6])
def test_a_block_that_strikes_askew_loses_what_friction_takes(friction: float, tmp_path: Path) -> None:
    drop, speed, restitution = 0.05, 0.8, 0.5
    made = Moving(block(friction, restitution=restitution), tmp_path)
    start = made.compiled.contact_start()
    x, v = start.x.copy(), np.zeros(made.model.size)
    x[3], v[1] = drop / LENGTH, speed / LENGTH
    state = StepState(x, v, start.a)
    count = round(1.6 * np.sqrt(2 * drop / G) / 1e-3)
    states = run(made, state, made.compiled.step_memory(), 1e-3, weights(0.0, count))
    hit = np.sqrt(2 * drop / G)
    after = max(0.0, speed - friction * (1 + restitution) * G * hit)
    flown = 1e-3 * count - hit
    assert_allclose(way(made, states)[-1], speed * hit + after * flown, rtol=0, atol=1e-6)


def ball_on_a_floor(friction: float, **more: Any) -> dict[str, Any]:
    """A ball of even density that touches a floor, carried by a rod that weighs next to nothing."""
    radius, mass = 0.02, 0.5
    ball = {"name": "ball", "mass": mass, "radius": radius, "inertia": [0.4 * mass * radius**2] * 3}
    carrier = rod(length=0.05, base=FREE | {"position": [-0.05, 0, 0]}, linear_density=1e-3, rotary_inertia=[1e-12] * 3)
    joints = [{"body": "ball", "rod": "rod", "kind": "fixed"}]
    surface = floor(-radius, friction=friction, bodies=["ball"])
    return scene(surface, carrier, bodies=[ball], joints=joints, accuracy=SMALL, **more)


@pytest.mark.slow
@pytest.mark.parametrize("friction", [0.5, 0.05])
def test_a_ball_rolls_down_an_incline_or_slides(friction: float, tmp_path: Path) -> None:
    angle = np.radians(20)
    tables = ball_on_a_floor(friction, inputs=["weight.acceleration"])
    made = Moving(tables, tmp_path)
    memory = made.compiled.step_memory()
    states = run(made, made.compiled.contact_start(), memory, 1e-3, weights(angle, 100))
    gone = (made.tips(states)[-1, 0] - made.tips(states)[0, 0]) * LENGTH
    rolls = 5 / 7 * np.sin(angle)
    slides = np.sin(angle) - friction * np.cos(angle)
    (contact,) = made.compiled.step_contacts(memory)
    assert contact.slips == (slides > rolls)
    # To the share of the rod in the mass.
    assert_allclose(gone, G * max(rolls, slides) * 0.1**2 / 2, rtol=1e-3, atol=0)


@pytest.mark.slow
@pytest.mark.parametrize(("friction", "restitution"), [(0.0, 0.0), (0.3, 0.0), (0.3, 0.3)])
def test_a_rod_falls_as_from_event_to_event(friction: float, restitution: float, tmp_path: Path) -> None:
    """Its end strikes and slides, it rolls over its length, sticks and breaks loose there, and its tip slaps down."""
    height, slope, dt = 0.05, 0.3, 5e-4
    base = {"position": [0, 0, height], "tangent": [1, 0, slope], "free": True}
    floors = floor(0.0, restitution=restitution, **({"friction": friction} if friction else {}))
    record = rod(base=base, damping={"retardation_time": 5e-3})
    made = Moving(scene(floors, record, accuracy={"modes": 3, "nodes": 12, "tolerance": 1e-4}), tmp_path)
    falling = FallingRod(LENGTH, 0.016, 0.2, 1e-7, 5e-3, modes=3, friction=friction, restitution=restitution)
    start = np.array([0.0, height, np.arctan(slope), 0.0, 0.0, 0.0])
    times = dt * np.arange(401)
    wanted = falling.motion(start, times)
    ends = np.array([falling.positions(q, np.array([1.0]))[0] for q in wanted]) / LENGTH
    memory = made.compiled.step_memory()
    states = [made.compiled.contact_start()]
    for _ in range(400):
        states.append(run(made, states[-1], memory, dt, made.model.pack()[None])[-1])
        for contact in made.compiled.step_contacts(memory) if 0.105 < dt * len(states) < 0.13 else ():
            # Its end slides: force and friction are of the same time.
            assert contact.slips and contact.place == 0.0
            assert_allclose(contact.friction, [friction * contact.force, 0.0, 0.0], rtol=1e-9, atol=1e-12)
    found = made.tips(states)[:, [0, 2]]
    errors = np.abs(found - ends).max(axis=1)
    assert errors[times < 0.132].max() < 3e-6
    assert errors[times < 0.166].max() < 2e-5
    # The slap falls on a rod that rolls as fast as a section of it can: its time tells.
    assert errors.max() < 1e-3


ACROSS = {"along": 0.2, "back": 0.5, "across": 0.35}


@pytest.mark.slow
def test_a_round_rod_slides_askew_or_rolls(tmp_path: Path) -> None:
    radius = 0.002
    record = {
        "name": "rod",
        "length": LENGTH,
        "strain": "kirchhoff",
        "material": {"youngs_modulus": 2e15, "poisson_ratio": 0.3, "density": 8e3},
        "section": {"shape": "circle", "radius": radius},
        "base": FREE,
    }
    floors = floor(-radius, friction=ACROSS)
    made = Moving(scene(floors, record, accuracy=SMALL, inputs=["weight.acceleration"]), tmp_path)
    dt, count = 1e-3, 20
    # A force across the rod moves the point that touches by the turn of the rod, too.
    yields = np.array([1.0, 3.0])
    for pull, along in (([8.0, 8.0], "along"), ([-8.0, 6.0], "back"), ([0.0, 3.0], "along")):
        coefficients = np.array([ACROSS[along], ACROSS["across"]])
        memory = made.compiled.step_memory()
        states = run(made, made.compiled.contact_start(), memory, dt, np.tile([*pull, -G], (count, 1)))
        # The middle: friction below it presses on the front more, which turns the rod.
        (facing,) = facings(made.model)
        began, ended = (facing.nodes(states[k].x, made.model.pack()).mean(axis=0) for k in (0, -1))
        gone = (ended - began)[:2]
        rubs = np.array(pull) - 2.0 * gone / (dt * count) ** 2
        slides = np.array(pull) - yields * rubs
        slip = [contact.slips for contact in made.compiled.step_contacts(memory)]
        if pull[0] != 0.0:
            assert all(slip)
            assert np.sign(slides[0]) == (1.0 if along == "along" else -1.0)
            assert_allclose(rubs, G * coefficients * slides / np.linalg.norm(slides), rtol=1e-4, atol=0)
        else:
            # How sections of a stiff rod share what holds it is not determined: one of them may be at its bound.
            assert not all(slip)
            assert_allclose(slides, 0.0, rtol=0, atol=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("friction", [0.4, ACROSS])
def test_derivatives_of_a_step_with_friction_are_those_of_differences(friction: Any, tmp_path: Path) -> None:
    record = rod(strain="kirchhoff", stiffness=IN_SPACE)
    tables = scene(
        BALL | {"centre": [0.25, 0.01, -0.09], "friction": friction},
        record,
        accuracy={"modes": 2, "nodes": 8, "tolerance": 1e-4},
        inputs=["weight.acceleration", "rod.base.position"],
    )
    made = Moving(tables, tmp_path)
    memory = made.compiled.step_memory()
    start = made.steps(1e-3, 160, memory)[-1]
    (contact,) = made.compiled.step_contacts(memory)
    assert contact.slips
    compare_with_differences(made, start, memory, 1e-3, of_load=(1e-3, 1e-1, 1e1), by_start=2e-6, least=1e-7)


@pytest.mark.slow
def test_derivatives_of_a_step_that_sticks_are_those_of_differences(tmp_path: Path) -> None:
    push = {"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0, 0, -0.02]}
    tables = scene(floor(-0.02, friction=0.8), rod(), loads=[push], inputs=["push.force"])
    tables["simulation"]["start"] = "equilibrium"
    made = Moving(tables, tmp_path)
    memory = made.compiled.step_memory()
    start = made.steps(1e-2, 20, memory)[-1]
    (contact,) = made.compiled.step_contacts(memory)
    assert not contact.slips and contact.force > 1e-3
    # What opens the gap at the start asks for large forces, which soon leave what sticks.
    # A push on what sticks moves nothing, to the share by which it yields in the matrix.
    sizes = {"of_load": (1e-3, 1e-1, 1e1), "small": 1e-9}
    compare_with_differences(made, start, memory, 1e-2, **sizes, by_start=2e-6, least=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize(("friction", "restitution", "free"), [(0.3, 0.9, True), (ACROSS, 0.0, False)])
def test_friction_and_blows_give_no_energy(friction: Any, restitution: float, free: bool, tmp_path: Path) -> None:
    base = {"position": [0, 0, 0], "tangent": [1, 0, 0.1], **({"free": True} if free else {})}
    leaning = floor(-0.1, normal=[-0.26, 0, 1], friction=friction, restitution=restitution)
    # A stiff rod whose tip is pressed askew: forces along and across the floor are hardly independent.
    made = Moving(scene(leaning, rod(base=base, stiffness={"bending_y": 0.02 if free else 0.5})), tmp_path)
    states = made.steps(1e-3, 400)
    assert np.diff(made.energies(states)).max() <= 1e-11
    assert made.least_gap(states) >= -2e-7


def blow_of_a_leaning_rod(friction: float, folder: Path) -> tuple[Moving, FloatArray, list[StepState]]:
    """States at the start, just before and just after a leaning rod strikes with its end, with full restitution."""
    record = rod(
        base={"position": [0, 0, 0], "tangent": [1, 0, 1], "free": True},
        stiffness={"bending_y": 0.5},
        damping={"retardation_time": 1e-12},
    )
    floors = floor(-0.02, friction=friction, restitution=1.0)
    made = Moving(scene(floors, record, accuracy=SMALL, inputs=["weight.acceleration"]), folder)
    inputs = np.array([8.0, 0.0, -G])
    memory, states = made.compiled.step_memory(), [made.compiled.contact_start()]
    for dt in (np.sqrt(2 * 0.02 / G) - 1e-6, 2e-6):
        step = made.compiled.step(states[-1], dt, inputs, memory=memory)
        assert step.done
        states.append(step.state)
    return made, inputs, states


@pytest.mark.slow
def test_a_blow_gives_back_as_much_as_gives_no_energy(tmp_path: Path) -> None:
    # Friction turns the slide back: with full restitution Newton's law gives 27 per cent to the energy of this rod.
    made, inputs, states = blow_of_a_leaning_rod(1.5, tmp_path)
    energies = [sum(map(float, made.model.energies(own.x, own.v, inputs, 0.0 * inputs)[:3])) for own in states]
    assert_allclose(energies[1], energies[0], rtol=1e-9, atol=0)
    assert_allclose(energies[2], energies[1], rtol=1e-5, atol=0)
    assert energies[2] < energies[1] * (1 + 1e-12)


@pytest.mark.slow
def test_blows_without_loss_tend_to_the_blow_without_friction(tmp_path: Path) -> None:
    changes = []
    for number, friction in enumerate((0.0, 1e-3, 1e-2)):
        folder = tmp_path / str(number)
        folder.mkdir()
        _, _, states = blow_of_a_leaning_rod(friction, folder)
        changes.append(states[2].v - states[1].v)
    size = np.linalg.norm(changes[0])
    assert np.linalg.norm(changes[1] - changes[0]) < 5e-3 * size
    assert np.linalg.norm(changes[2] - changes[0]) < 5e-2 * size


def test_a_slip_speed_is_refused_without_a_width() -> None:
    with pytest.raises(SceneError, match="describes a smooth contact"):
        scene_from_dict(block(0.3, slip_speed=1e-3))


@pytest.mark.parametrize("fixed", [{"modes": 3, "nodes": 12}, pytest.param({}, marks=pytest.mark.slow)])
def test_equilibria_and_modes_say_that_they_have_no_friction(fixed: dict[str, Any]) -> None:
    none = "With friction, many shapes could be in equilibrium; this answer is without."
    for friction, says in ((0.3, True), (0.0, False)):
        wanted = scene_from_dict(scene(floor(-0.02, friction=friction), accuracy={"tolerance": 1e-3, **fixed}))
        resting = solve(wanted)
        assert resting.contacts
        path = follow(wanted, "weight.acceleration", [0.0, 0.0, -9.0])
        for message in (resting.message, solve(build(wanted)).message, modes_of(wanted, count=1).message):
            assert (none in message) == says
        assert ("Friction is counted from factor 0" in path.message) == says


@pytest.mark.slow
def test_what_presses_without_friction_slips(tmp_path: Path) -> None:
    """A rod on a floor that does not rub, beside a ball that does."""
    tables = scene(floor(-0.02), obstacles=[floor(-0.02), BALL | {"centre": [0.2, 0, -0.5], "friction": 0.3}])
    made = Moving(tables, tmp_path)
    memory = made.compiled.step_memory()
    made.steps(1e-3, 200, memory)
    contacts = made.compiled.step_contacts(memory)
    assert contacts and all(contact.slips and not contact.friction.any() for contact in contacts)


def thrown_at_a_ball(friction: float) -> dict[str, Any]:
    """A free rod whose end flies against a ball, and slides along it."""
    ball = {"name": "ball", "kind": "sphere", "centre": [0.3, 0, 0.03], "radius": 0.02, "restitution": 0.3}
    record = {
        "name": "rod",
        "length": 0.3,
        "strain": "kirchhoff",
        "material": {"youngs_modulus": 3e6, "poisson_ratio": 0.45, "density": 1100.0},
        "section": {"shape": "circle", "radius": 5e-3},
        "damping": {"retardation_time": 5e-3},
        "base": FREE,
    }
    return {
        "schema": 1,
        "accuracy": {"modes": 4, "nodes": 8},
        "rods": [record],
        "obstacles": [ball | ({"friction": friction} if friction else {})],
        "velocities": [{"rod": "rod", "linear": [0, 0, 1]}],
        "simulation": {"duration": 0.012, "frames": 13},
    }


@pytest.mark.slow
@pytest.mark.parametrize(("friction", "nearby"), [(0.0, 1e-5), (0.3, 1e-9)])
def test_an_end_slides_along_a_ball_as_in_the_simulator(friction: float, nearby: float, tmp_path: Path) -> None:
    """Beside the end the ball was lost, and no step from there was solved, however short.

    With friction the simulator takes the same steps.
    """
    tables = thrown_at_a_ball(friction)
    if friction:
        tables["simulation"]["step"] = 2.5e-4
    motion = simulate(build(scene_from_dict(tables), moving=True))
    tables["simulation"]["start"] = "unloaded"
    made = Moving(tables, tmp_path)
    still = np.zeros(made.model.size)
    memory = made.compiled.step_memory()
    states = run(made, StepState(motion.x[0], motion.v[0], still), memory, 2.5e-4, np.zeros((48, 0)))
    assert_allclose(made.tips(states[-1:]) * LENGTH, motion.tip().position[-1:], rtol=0, atol=0.3 * nearby)
    (pressing,) = made.compiled.step_contacts(memory)
    (expected,) = motion.contacts[-1]
    assert_allclose(pressing.place, expected.at, rtol=0, atol=10.0 * nearby)
