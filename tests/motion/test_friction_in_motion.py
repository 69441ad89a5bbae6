"""Motions with friction of exact contact: closed forms, the reference from event to event, energy, refusals."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from benchmarks.thrown_rods import random_scene
from cosserat_casadi import Model, SceneError, build, read_scene, scene_from_dict, simulate
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.checkpoint import Checkpoint
from cosserat_casadi.motion.fall_of_errors import UNBALANCED
from cosserat_casadi.motion.motion_event import MotionEvent
from cosserat_casadi.motion.rubbing_library import RubbingSteps
from cosserat_casadi.motion.simulate import Simulator, started
from cosserat_casadi.motion.tip_paths import path_distance
from cosserat_casadi.motion.trajectory import Motion, MotionOutcome, MotionProgress
from cosserat_casadi.numerics.integration import StepOutcome
from cosserat_casadi.numerics.motion_equations import Instant
from tests.codegen.test_friction_in_steps import ball_on_a_floor, thrown_at_a_ball
from tests.codegen.test_steps_in_contact import LENGTH, floor, rod, scene
from tests.conftest import ROOT
from tests.model.test_base_joints import ends
from tests.reference.falling_rods import FallingRod

G = 9.81
MASS = 0.2 * LENGTH
FRICTION = 0.3
FREE = {"position": [0, 0, 0], "tangent": [1, 0, 0], "free": True}
SMALL = {"modes": 1, "nodes": 4, "tolerance": 1e-3}


def weight(angle: float) -> dict[str, Any]:
    """Weight on an incline that goes down along x."""
    acceleration = (G * np.array([np.sin(angle), 0.0, -np.cos(angle)])).tolist()
    return {"name": "weight", "kind": "gravity", "acceleration": acceleration}


def block(angle: float, duration: float, frames: int = 11, **more: Any) -> dict[str, Any]:
    """A straight rod on an incline, as stiff as a block."""
    record = rod(base=FREE, stiffness={"bending_y": 0.5})
    simulation = {"duration": duration, "frames": frames, "start": "unloaded", "tolerance": 1e-5}
    tables = scene(floor(0.0, friction=FRICTION), record, accuracy=SMALL, loads=[weight(angle)], simulation=simulation)
    return {**tables, **more}


def moved(tables: dict[str, Any], **more: Any) -> Motion:
    """The motion on the scene's own modes, with the error of its steps alone."""
    motion = simulate(build(scene_from_dict(tables).with_motion_inputs(), moving=True), **more)
    assert motion.converged, motion.message
    return motion


def along(motion: Motion) -> FloatArray:
    """Way of the tip along the floor, m."""
    ways: FloatArray = motion.tip().position[:, 0] - LENGTH
    return ways


def test_a_block_sticks_below_the_angle_of_friction_and_slides_above_it() -> None:
    below, above = np.arctan(FRICTION) * np.array([0.999, 1.5])
    rests = moved(block(below, 0.1))
    assert np.abs(along(rests)).max() < 1e-12
    assert [event.kind for event in rests.events] == ["lie_down", "stick"]
    assert not any(contact.slips for contact in rests.contacts[-1])
    held = sum(contact.friction for contact in rests.contacts[-1])
    assert_allclose(held, [-MASS * G * np.sin(below), 0.0, 0.0], rtol=1e-9, atol=1e-12)
    slides = moved(block(above, 0.1))
    down = G * (np.sin(above) - FRICTION * np.cos(above))
    assert_allclose(along(slides), down * slides.times**2 / 2.0, rtol=0, atol=1e-12)
    assert all(contact.slips and contact.lies for contact in slides.contacts[-1])
    # Friction takes the weight across the incline times its coefficient and the way.
    taken = FRICTION * MASS * G * np.cos(above) * along(slides)
    assert_allclose(slides.energy.dissipated, taken, rtol=1e-9, atol=1e-15)
    assert np.abs(slides.energy.imbalance).max() < 1e-10


def test_a_block_that_is_thrown_stops_and_stays() -> None:
    speed = 0.3
    thrown = {"velocities": [{"rod": "rod", "linear": [speed, 0, 0]}]}
    motion = moved(block(0.0, 0.2, 41, **thrown))
    stops = speed / (FRICTION * G)
    times = np.minimum(motion.times, stops)
    assert_allclose(along(motion), speed * times - FRICTION * G * times**2 / 2.0, rtol=0, atol=1e-9)
    (stick,) = [event for event in motion.events if event.kind == "stick"]
    assert_allclose(stick.time, stops, rtol=1e-5, atol=0)
    assert np.abs(motion.v[-1]).max() < 1e-12
    assert_allclose(motion.energy.dissipated[-1], MASS * speed**2 / 2.0, rtol=1e-6, atol=0)
    # A motion that the user stops ends on the way.
    goal = MotionEvent("there", lambda model, x, inputs: model.tip["rod"](x, inputs)[0][0] - LENGTH - 0.01, stop=True)
    ends = moved(block(0.0, 0.2, 41, **thrown), events=[goal])
    assert_allclose(along(ends)[-1], 0.01, rtol=0, atol=1e-9)
    assert "An event stopped it" in ends.message


def test_what_touches_an_obstacle_without_friction_beside_one_with_it_has_none() -> None:
    angle = 0.2
    post = {"name": "post", "kind": "sphere", "centre": [0, 0, 1.0], "radius": 0.1, "friction": FRICTION}
    motion = moved(block(angle, 0.05, 6, obstacles=[floor(0.0), post]))
    assert_allclose(along(motion), G * np.sin(angle) * motion.times**2 / 2.0, rtol=0, atol=1e-12)
    contacts = [contact for contacts in motion.contacts for contact in contacts]
    assert contacts and all(contact.friction is None and contact.slips for contact in contacts)
    assert {event.kind for event in motion.events} == {"lie_down"}
    assert not np.any(motion.to_dict()["contact"]["friction"])


def test_what_steps_lose_where_a_rod_slaps_down_falls_with_them_and_tells_the_error() -> None:
    """Steps end where places run out onto ends of the rod: beyond, they lost 2.9e-3 of the length in any number."""
    wall = {"name": "wall", "kind": "plane", "point": [0.45, 0, 0], "normal": [-1, 0, 0]}
    tables = scene(
        floor(0.0, friction=0.4),
        rod(base=FREE | {"position": [0, 0, 0.01], "tangent": [1, 0, 0.1]}),
        accuracy={"modes": 2, "nodes": 8, "tolerance": 1e-3},
        loads=[{"name": "weight", "kind": "gravity", "acceleration": [4, 0, -9]}],
        simulation={"duration": 0.2, "frames": 101, "start": "unloaded", "step": 2e-3},
    )
    tables["obstacles"].append(wall | {"friction": 0.2, "restitution": 0.4})
    motion = moved(tables)
    lost = np.abs(motion.energy.imbalance).max()
    assert motion.error_estimate >= UNBALANCED * lost
    own = simulator(tables)
    fine = own.stepped(2.5e-4)
    history = own.stepped(2e-3)
    assert path_distance(own.paths(history), own.paths(fine)) < 0.5 * motion.error_estimate < 1e-3
    # With the 1.5th power of the step.
    assert own.fall.least(fine, own.paths(fine)) < UNBALANCED * lost / 15.0


def test_an_end_that_slides_along_a_ball_moves_as_without_friction_where_there_is_hardly_any() -> None:
    """Beside the end the ball was lost, and no step after that was solved; other motions go from event to event."""
    from_event_to_event = simulator(thrown_at_a_ball(0.0))
    wanted = from_event_to_event.paths(from_event_to_event.controlled(1e-6))
    equal = simulator(thrown_at_a_ball(1e-9))
    history = equal.stepped(1.25e-4)
    assert history.completed
    assert path_distance(equal.paths(history), wanted) < 1e-6
    # More than a friction of none: what slides there does so with one.
    rubbed = equal.paths(simulator(thrown_at_a_ball(0.3)).stepped(2.5e-4))
    assert path_distance(rubbed, wanted) > 1e-4


@pytest.mark.slow
def test_missing_energy_tells_the_error_of_a_thrown_rod_whose_waves_steps_damp() -> None:
    """Motions with steps twice and half as long are ten times nearer than the true one: all damp the same waves."""
    own = simulator(random_scene(30))
    duration = own.simulation.duration
    history, half, fine = (own.stepped(duration / count) for count in (200, 400, 1600))
    paths = own.paths(history)
    apart, true = (path_distance(paths, own.paths(other)) for other in (half, fine))
    assert true > 10.0 * apart
    assert true < own.fall.error(history, paths, own.fall.factor(history, half) * apart, 0.0)


def simulator(tables: dict[str, Any]) -> Simulator:
    model = build(scene_from_dict(tables).with_motion_inputs(), moving=True).at().in_motion
    assert model.scene.simulation is not None
    return Simulator(model, model.scene.simulation, started(model, model.scene.simulation, None))


def test_a_block_does_not_hop_in_steps_of_microseconds() -> None:
    """Its weight closes less of a gap in such a step than is no gap in longer ones."""
    sliding = block(0.0, 2e-3, velocities=[{"rod": "rod", "linear": [0.03, 0, 0]}])
    own = simulator(sliding)
    history = own.stepped(4e-6)
    assert history.completed and [event.kind for event in history.events] == ["lie_down", "slip"]
    gone = 0.03 * 2e-3 - FRICTION * G * 2e-3**2 / 2.0
    tip = own.paths(history).points[-1, 0, 0] * LENGTH
    assert_allclose(tip - LENGTH, gone, rtol=1e-9, atol=0)


def test_a_divided_step_has_no_last_part_of_rounding(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its forces would be rounding over the square of its size: a rod was thrown off so."""
    step, taken = 2e-3, RubbingSteps.take

    def take(self: RubbingSteps, at: Instant, inputs: Sequence[FloatArray], size: float) -> Any:
        return (StepOutcome.NOT_SOLVED, [], (0, 0)) if size > step / 10 else taken(self, at, inputs, size)

    monkeypatch.setattr(RubbingSteps, "take", take)
    history = simulator(block(0.0, 0.2)).stepped(step)
    assert history.completed
    monkeypatch.setattr(RubbingSteps, "take", lambda *_: (StepOutcome.NOT_SOLVED, [], (0, 0)))
    (stalled,) = simulator(block(0.0, 0.2)).stepped(step).legs
    assert "although nothing touches before it" in str(stalled.restart.stalled)
    assert_allclose(history.statistics.smallest_step, step / 16, rtol=1e-6, atol=0)


def chain(stiffness: float, friction: float) -> dict[str, Any]:
    """Two rods that fall on a floor, with a hinge between them that has elastic stops."""
    stops = {"lower_stop": -0.1, "upper_stop": 0.1, "stop_stiffness": stiffness}
    first = rod(name="a", base=FREE | {"position": [0, 0, 0.05], "tangent": [1, 0, 0.2]}, stiffness={"bending_y": 0.05})
    second = {name: value for name, value in first.items() if name != "base"} | {"name": "b"}
    return scene(
        floor(-0.05, **({"friction": friction} if friction else {})),
        rods=[first, second],
        joints=[ends({"rod": "a"}, {"rod": "b", "at": 0.0}, name="knee", **stops)],
        accuracy={"modes": 2, "nodes": 8, "tolerance": 1e-3},
        simulation={"duration": 0.2, "start": "unloaded"},
    )


@pytest.mark.slow
@pytest.mark.parametrize("stiffness", [2.0, 50.0])
def test_elastic_stops_push_as_in_motions_from_event_to_event(stiffness: float) -> None:
    """Friction is next to nothing: the other motions have none, and end steps where stops are hit and left."""
    from_event_to_event = simulator(chain(stiffness, 0.0))
    wanted = from_event_to_event.paths(from_event_to_event.controlled(1e-6))
    equal = simulator(chain(stiffness, 1e-9))
    errors = []
    for size in (4e-3, 6.25e-5):
        history = equal.stepped(size)
        assert history.completed
        errors.append(path_distance(wanted, equal.paths(history)))
    assert errors[0] < 2e-3
    assert errors[1] < 5e-5


def test_a_motion_that_rubs_does_not_start_inside() -> None:
    inside = block(0.0, 0.02, rods=[rod(base=FREE | {"tangent": [4, 0, -3]})])
    with pytest.raises(SceneError, match=r"inside an obstacle by 0.*: 'rod' in 'floor'"):
        simulate(scene_from_dict(inside))


PART = 0.0625


def thrown_block(parts: int) -> dict[str, Any]:
    """A block that slides for 0.102 s; a part of the time has 16 steps."""
    settings = {"duration": parts * PART, "frames": 8 * parts + 1, "start": "unloaded", "step": PART / 16}
    return block(0.0, 0.0, velocities=[{"rod": "rod", "linear": [0.3, 0, 0]}], simulation=settings)


def compare_as_one(later: Motion, whole: Motion, events: int) -> None:
    """Compare a motion that went on with the one over all of the time, bit for bit.

    Args:
        later: the motion that went on.
        whole: the motion over all of the time.
        events: number of the last events of the whole that are to be those of the later motion.
    """
    rows = whole.times > later.times[0]
    for name in ("times", "x", "v", "a"):
        assert_array_equal(getattr(later, name)[1:], getattr(whole, name)[rows])
    for name in ("kinetic", "dissipated", "impacts", "work"):
        assert_array_equal(getattr(later.energy, name)[1:], getattr(whole.energy, name)[rows])
    assert later.events == whole.events[len(whole.events) - events :]
    ends = [motion.contacts[-1] for motion in (later, whole)]
    assert [own.slips for own in ends[0]] == [own.slips for own in ends[1]]
    assert_array_equal([own.friction for own in ends[0]], [own.friction for own in ends[1]])


def test_a_block_that_goes_on_slides_and_rests_as_in_one_motion(tmp_path: Path) -> None:
    whole, *firsts = (simulate(scene_from_dict(thrown_block(parts)), compiled=False) for parts in (3, 1, 2))
    assert [event.kind for event in whole.events] == ["lie_down", "slip", "stick"]
    for first, events in zip(firsts, (1, 0), strict=True):
        file = tmp_path / "first.npz"
        first.write(file)
        later = simulate(scene_from_dict(thrown_block(3)), start=file, compiled=False)
        compare_as_one(later, whole, events)
        # The motions that tell the error go on too.
        assert later.end is not None and len(later.end.strands) == 3
    smooth = thrown_block(3)
    del smooth["obstacles"][0]["friction"]
    with pytest.raises(SceneError, match="another scene"):
        simulate(scene_from_dict(smooth), start=file, compiled=False)


def test_a_motion_that_rubs_goes_on_from_no_contacts_of_another_scene() -> None:
    first = simulate(scene_from_dict(thrown_block(1)), compiled=False)
    assert first.end is not None
    data = first.end.to_data()
    strand = data["strands"][0]
    contacts = strand["resume"]["contacts"]
    # A contact with an obstacle that is none, or part of one; a pair that is none; part of a memory.
    for other in ({"touches": [[1.0, 0.0, 0.5, 0.0]]}, {"touches": [[0.0]]}, {"stuck": [1]}, {"memory": [0.0]}):
        strand["resume"]["contacts"] = contacts | other
        with pytest.raises(SceneError, match="another scene"):
            simulate(scene_from_dict(thrown_block(2)), start=Checkpoint.from_data(data), compiled=False)
    for size in (None, 0.0):
        strand["settings"]["size"] = size
        with pytest.raises(ValueError, match="no size"):
            Checkpoint.from_data(data)


def test_a_motion_that_rubs_is_written_in_parts_that_an_interrupt_leaves(tmp_path: Path) -> None:
    def interrupt(progress: MotionProgress) -> None:
        if progress.time > 1.4 * PART:
            raise KeyboardInterrupt

    scene, path = scene_from_dict(thrown_block(2)), tmp_path / "out.json"
    stopped = simulate(scene, output=path, part=PART, progress=interrupt, compiled=False)
    assert stopped.outcome is MotionOutcome.INTERRUPTED
    files = [tmp_path / f"out-000{number}.json" for number in (1, 2)]
    assert sorted(tmp_path.iterdir()) == files
    whole = simulate(scene, compiled=False)
    compare_as_one(simulate(scene, start=files[1], compiled=False), whole, events=1)


@pytest.mark.slow
@pytest.mark.parametrize("split", [0.0625, 0.078125, 0.125])
def test_a_rod_that_bounces_and_rolls_goes_on_as_in_one_motion(split: float) -> None:
    def falling(duration: float) -> dict[str, Any]:
        return scene(
            floor(0.0, restitution=0.3, friction=0.4),
            rod(base=FREE | {"position": [0, 0, 0.02], "tangent": [1, 0, 0.3]}, stiffness={"bending_y": 0.5}),
            accuracy={"modes": 3, "nodes": 10},
            simulation={
                "duration": duration,
                "frames": round(256 * duration) + 1,
                "start": "unloaded",
                "step": 2.0**-11,
            },
        )

    first, whole = (simulate(scene_from_dict(falling(duration)), compiled=False) for duration in (split, 0.1875))
    later = simulate(scene_from_dict(falling(0.1875)), start=first, compiled=False)
    compare_as_one(later, whole, events=len(whole.events) - len(first.events))
    assert later.error_estimate == whole.error_estimate


def test_a_third_motion_goes_on_where_impacts_ask_for_one() -> None:
    """Two motions may happen to be struck alike; steps are halved until motions agree."""
    drop = block(0.0, 0.1, obstacles=[floor(-0.02, friction=FRICTION, restitution=0.5)])
    first = moved(drop)
    assert first.end is not None and len(first.end.strands) == 3
    later = simulate(scene_from_dict({**drop, "simulation": drop["simulation"] | {"duration": 0.15}}), start=first)
    assert later.converged and later.end is not None and len(later.end.strands) == 3
    assert later.error_estimate >= first.error_estimate


@pytest.mark.slow
def test_a_part_with_impacts_after_a_flight_has_shorter_steps_where_its_tolerance_asks_for_them() -> None:
    def thrown(end: float, **more: Any) -> Model:
        record = rod(base=FREE | {"tangent": [1, 0, 0.3]}, stiffness={"bending_y": 0.5})
        simulation = {"duration": end, "frames": 11, "start": "unloaded", "tolerance": 3e-5, **more}
        velocities = [{"rod": "rod", "linear": [0.5, 0, 0]}]
        tables = scene(floor(-0.03, friction=0.4), record, accuracy=SMALL, simulation=simulation, velocities=velocities)
        return build(scene_from_dict(tables).with_motion_inputs(), moving=True)

    flight = simulate(thrown(0.07))
    assert not flight.events
    later = simulate(thrown(0.1), start=flight)
    assert later.converged and later.events
    assert later.error_estimate <= 3e-5
    shortest = later.statistics.largest_step
    assert shortest < 0.6 * flight.statistics.largest_step
    whole = simulate(thrown(0.1, step=shortest / 4.0))
    assert np.abs(later.tip().position[-1] - whole.tip().position[-1]).max() < 3e-5 * LENGTH
    # The next part goes on with these steps; where a size is given, it stays.
    assert simulate(thrown(0.105), start=later).statistics.largest_step <= shortest * (1.0 + 1e-9)
    given = simulate(thrown(0.1, step=0.07 / 50), start=flight)
    assert given.statistics.largest_step > 0.9 * flight.statistics.largest_step


@pytest.mark.slow
def test_a_rod_in_space_is_held_back_against_its_way() -> None:
    speed, way = 0.4, np.array([0.6, 0.8, 0.0])
    tables = block(0.0, 0.05, velocities=[{"rod": "rod", "linear": (speed * way).tolist()}])
    stiff = {"bending_y": 5.0, "bending_x": 5.0, "torsion": 5.0}
    tables["rods"] = [rod(base=FREE, strain="kirchhoff", stiffness=stiff)]
    motion = moved(tables)
    gone = motion.tip().position - motion.tip().position[0]
    times = motion.times
    assert_allclose(gone, np.outer(speed * times - FRICTION * G * times**2 / 2.0, way), rtol=0, atol=1e-8)
    held = sum(contact.friction for contact in motion.contacts[-1])
    assert_allclose(held, -FRICTION * MASS * G * way, rtol=1e-6, atol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("friction", [0.1, 0.6])
def test_a_block_that_strikes_askew_loses_what_friction_takes(friction: float) -> None:
    drop, speed, restitution = 0.05, 0.8, 0.5
    tables = block(0.0, 0.16, velocities=[{"rod": "rod", "linear": [speed, 0, 0]}])
    tables["obstacles"] = [floor(-drop, friction=friction, restitution=restitution)]
    motion = moved(tables)
    hit = np.sqrt(2.0 * drop / G)
    after = max(0.0, speed - friction * (1.0 + restitution) * G * hit)
    assert_allclose(along(motion)[-1], speed * hit + after * (0.16 - hit), rtol=0, atol=1e-6)
    across = (1.0 - restitution**2) * G * drop
    lost = MASS * ((speed**2 - after**2) / 2.0 + across)
    assert_allclose(motion.energy.impacts[-1], lost, rtol=1e-6, atol=0)
    blows = [event for event in motion.events if event.kind == "impact"]
    assert_allclose(sum(event.impulse for event in blows), MASS * (1.0 + restitution) * G * hit, rtol=1e-6, atol=0)
    assert_allclose(sum(event.energy for event in blows), lost, rtol=1e-6, atol=0)


@pytest.mark.slow
@pytest.mark.parametrize("friction", [0.5, 0.05])
def test_a_ball_rolls_down_an_incline_or_slides(friction: float) -> None:
    angle = np.radians(20)
    simulation = {"duration": 0.1, "frames": 11, "start": "unloaded", "tolerance": 1e-4}
    motion = moved(ball_on_a_floor(friction, loads=[weight(angle)], simulation=simulation))
    rolls = 5 / 7 * np.sin(angle)
    slides = np.sin(angle) - friction * np.cos(angle)
    (contact,) = motion.contacts[-1]
    assert contact.of_body and contact.slips == (slides > rolls)
    gone = np.diff(motion.body("ball").position[[0, -1], 0])
    # To the share of the rod in the mass.
    assert_allclose(gone, G * max(rolls, slides) * 0.1**2 / 2, rtol=1e-3, atol=0)
    assert np.abs(motion.energy.imbalance).max() < 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("restitution", [0.0, 0.3])
def test_a_rod_falls_as_from_event_to_event_within_the_error_that_is_told(restitution: float) -> None:
    """Its end strikes and slides, it rolls over its length, sticks and breaks loose there, and its tip slaps down."""
    height, slope = 0.05, 0.3
    base = {"position": [0, 0, height], "tangent": [1, 0, slope], "free": True}
    tables = scene(
        floor(0.0, restitution=restitution, friction=FRICTION),
        rod(base=base, damping={"retardation_time": 5e-3}),
        accuracy={"modes": 3, "nodes": 12, "tolerance": 1e-4},
        simulation={"duration": 0.2, "frames": 401, "start": "unloaded", "tolerance": 1e-3},
    )
    motion = moved(tables)
    falling = FallingRod(LENGTH, 0.016, 0.2, 1e-7, 5e-3, modes=3, friction=FRICTION, restitution=restitution)
    wanted = falling.motion(np.array([0.0, height, np.arctan(slope), 0.0, 0.0, 0.0]), motion.times)
    ends = np.array([falling.positions(q, np.array([1.0]))[0] for q in wanted])
    off = np.abs(motion.tip().position[:, [0, 2]] - ends).max() / LENGTH
    assert off < motion.error_estimate < 1e-3
    energy = motion.energy
    assert np.abs(energy.imbalance).max() < 2e-3
    total = energy.kinetic + energy.elastic + energy.potential
    assert np.diff(total).max() < 1e-9 * np.abs(total).max()


@pytest.mark.slow
def test_a_rod_that_is_thrown_comes_to_rest() -> None:
    changes = ["floor.friction=0.3", "simulation.duration=1", "simulation.step=2.5e-3"]
    thrown = read_scene(ROOT / "examples" / "rod_hits_floor.toml", changes)
    motion = simulate(build(thrown.with_motion_inputs(), moving=True))
    # Which end strikes next hangs on little: the error is told, and large.
    assert motion.error_estimate > 1e-4
    assert motion.energy.kinetic[-1] < 1e-12
    assert motion.contacts[-1] and not any(contact.slips for contact in motion.contacts[-1])
    # Of what the hand gave and the fall, all is lost.
    assert np.abs(motion.energy.imbalance).max() < 5e-2


@pytest.mark.slow
def test_a_base_that_drags_its_rod_along_does_the_work_that_friction_takes() -> None:
    path = {"times": [0, 0.1, 0.3], "values": [[0, 0, 0], [0, 0, 0], [0.03, 0, 0]], "interpolation": "cubic"}
    tables = scene(
        floor(-0.1, friction=0.4),
        rod(base={"position": [0, 0, 0], "tangent": [1, 0, -0.2]}),
        accuracy={"modes": 3, "nodes": 12, "tolerance": 1e-3},
        simulation={"duration": 0.3, "frames": 31, "start": "unloaded", "step": 5e-4},
        inputs=["rod.base.position"],
        motions=[{"input": "rod.base.position", **path}],
    )
    motion = moved(tables)
    assert any(contact.slips for contacts in motion.contacts for contact in contacts)
    assert motion.energy.work[-1] > 3e-3
    assert np.abs(motion.energy.imbalance).max() < 2e-4


@pytest.mark.slow
def test_a_rod_that_lies_in_equilibrium_stays() -> None:
    changes = ["table.friction=0.3", 'simulation.start="equilibrium"', "simulation.duration=0.02"]
    lies = read_scene(ROOT / "examples" / "rod_lies_down.toml", [*changes, "simulation.step=1e-3"])
    motion = simulate(build(lies.with_motion_inputs(), moving=True))
    assert motion.converged, motion.message
    assert np.abs(motion.v).max() < 1e-7
    assert all(contact.lies and not contact.slips for contacts in motion.contacts for contact in contacts)
