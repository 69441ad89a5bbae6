"""Free rods that fall on obstacles: flight, impulses by hand, momentum and energy across impacts."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import brentq

from cosserat_casadi import build, parse_scene, read_scene, simulate
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.motion import exact_contact
from cosserat_casadi.motion.contact_forces import Follower, MovingContact
from cosserat_casadi.motion.contact_guards import SAME_PLACE, ContactPhase, GuardKind
from cosserat_casadi.motion.contact_law import LOOKS
from cosserat_casadi.motion.contact_sections import RodFacing
from cosserat_casadi.motion.event_restart import ContactEvent
from cosserat_casadi.motion.exact_contact import TOUCHING, ExactContacts
from cosserat_casadi.motion.facings import facings
from cosserat_casadi.motion.history import equations_of
from cosserat_casadi.motion.simulate import Simulator, motion_of, moving_inputs, started
from cosserat_casadi.motion.trajectory import Motion, MotionOutcome
from cosserat_casadi.numerics.motion_equations import Instant
from tests.families import mostly_slow
from tests.moving_scenes import gaps_along

LENGTH = 0.4
DENSITY = 0.2
MASS = LENGTH * DENSITY
GRAVITY = 9.81
BALL = [0.12, 0.02, -0.1]

THIN = """
stiffness = { bending_y = 5.0 }
linear_density = 0.2
rotary_inertia = [1e-12, 1e-12, 2e-12]
"""

RUBBER = """
material = { youngs_modulus = 2e7, poisson_ratio = 0.48, density = 1100.0 }
section = { shape = "circle", radius = 8e-3 }
"""

FREE = """
schema = 1
accuracy = {{ modes = {modes}, nodes = 10, tolerance = 1e-4 }}
loads = [{{ name = "weight", kind = "gravity", acceleration = [{along}, 0, -9.81] }}]
simulation = {{ duration = {duration}, start = "unloaded", frames = 41 }}
[[rods]]
name = "rod"
length = 0.4
strain = "{strain}"
{stuff}
base = {{ position = [0, 0, 0], tangent = [{tangent}], free = true }}
damping = {{ retardation_time = 1e-3 }}
"""

FLOOR = """
[[obstacles]]
name = "floor"
kind = "plane"
point = [0, 0, -0.05]
normal = [0, 0, 1]
"""


def free_rod(
    obstacles: str = FLOOR,
    modes: int = 2,
    duration: float = 0.1015,
    tangent: str = "1, 0, 0",
    along: float = 0.0,
    strain: str = "planar",
) -> Model:
    given = {"modes": modes, "duration": duration, "tangent": tangent, "along": along, "strain": strain}
    text = FREE.format(stuff=THIN if strain == "planar" else RUBBER, **given) + obstacles
    return build(parse_scene(text).with_motion_inputs(), moving=True)


def momenta(motion: Motion, time: float) -> FloatArray:
    """Momentum and angular momentum about the origin, shape (6,)."""
    state = motion.at(time)
    linear, angular = motion.model.momentum(state.x, state.v, state.inputs, 0.0 * state.inputs)
    return np.concatenate([linear.full()[:, 0], angular.full()[:, 0]])


def impacts(motion: Motion) -> list[ContactEvent]:
    return [event for event in motion.events if event.kind == "impact"]


@pytest.mark.parametrize("modes", mostly_slow([1, 3], quick=[3]))
@pytest.mark.parametrize("slope", mostly_slow([0.0, 0.6], quick=[0.6]))
def test_the_first_impulse_is_that_of_a_straight_rod_by_hand(modes: int, slope: float) -> None:
    """A straight rod with k polynomials of curvature has those up to the degree k + 1 as its deflections.

    The sum of their squares at an end over their norms, (k + 2)²/m, is what a unit impulse across the rod gives its
    end; one along the rod moves it by 1/m.
    """
    post = '[[obstacles]]\nname = "post"\nkind = "sphere"\ncentre = [0, 0, -0.08]\nradius = 0.03\n'
    motion = simulate(free_rod(FLOOR if slope else post, modes=modes, tangent=f"1, 0, {slope}"))
    first = motion.events[0]
    assert first.kind == "impact"
    assert_allclose(first.place, 0.0, rtol=0, atol=1e-15)
    assert_allclose(first.time, np.sqrt(2 * 0.05 / GRAVITY), rtol=1e-9, atol=0)
    sine = slope / np.hypot(1.0, slope)
    inverse_mass = ((1 - sine**2) * (modes + 2) ** 2 + sine**2) / MASS
    speed = GRAVITY * first.time
    assert_allclose(first.impulse, speed / inverse_mass, rtol=1e-6, atol=0)
    assert_allclose(first.energy, 0.5 * speed**2 / inverse_mass, rtol=1e-6, atol=0)


@pytest.mark.slow
def test_both_ends_on_posts_are_struck_together_and_by_hand() -> None:
    """Of the deflections the even ones move, with 1 + 5 = 6 for two polynomials of curvature."""
    posts = "".join(
        f'[[obstacles]]\nname = "{name}"\nkind = "sphere"\ncentre = [{x}, 0, -0.08]\nradius = 0.03\n'
        for name, x in (("left", 0.0), ("right", LENGTH))
    )
    motion = simulate(free_rod(posts, modes=2))
    left, right = impacts(motion)[:2]
    assert (left.obstacle, right.obstacle) == ("left", "right")
    assert_allclose([left.place, right.place], [0.0, 1.0], rtol=0, atol=1e-15)
    speed = GRAVITY * left.time
    assert right.time == left.time
    for struck in (left, right):
        assert_allclose(struck.impulse, speed * MASS / 12, rtol=1e-6, atol=0)


@pytest.mark.slow
@pytest.mark.parametrize(("modes", "strain"), [(2, "planar"), (4, "kirchhoff")])
def test_a_rod_that_falls_flat_strikes_along_its_length_at_once_and_rests(modes: int, strain: str) -> None:
    motion = simulate(free_rod(modes=modes, strain=strain, duration=0.12))
    assert motion.converged, motion.message
    struck = impacts(motion)
    time = struck[0].time
    assert {event.time for event in motion.events} == {time}
    assert [event.kind for event in motion.events].count("lie_down") == 1
    weight = DENSITY * GRAVITY * LENGTH if strain == "planar" else 1100.0 * np.pi * 8e-3**2 * LENGTH * GRAVITY
    assert_allclose(sum(event.impulse for event in struck), weight * time, rtol=1e-9, atol=0)
    lost = 0.5 * weight * GRAVITY * time**2
    assert_allclose(motion.energy.impacts[-1], lost, rtol=1e-9, atol=0)
    assert_allclose(motion.energy.kinetic[-1], 0.0, rtol=0, atol=1e-15)
    pressing = motion.contacts[-1]
    assert len(pressing) >= 3
    assert all(contact.lies for contact in pressing)
    assert_allclose(sum(contact.force[2] for contact in pressing), weight, rtol=1e-6, atol=0)


@pytest.fixture(scope="module")
def thrown() -> Motion:
    """A soft rod in space that falls on an edge of a ball, off its middle, so that all of it turns and bends."""
    ball = f'[[obstacles]]\nname = "ball"\nkind = "sphere"\ncentre = {BALL}\nradius = 0.05\n'
    return simulate(free_rod(ball, modes=1, duration=0.14, tangent="1, 0.2, 0.1", along=1.5, strain="kirchhoff"))


@pytest.mark.slow
def test_it_flies_as_a_stone_until_it_strikes(thrown: Motion) -> None:
    first = thrown.events[0]
    before = thrown.times < first.time
    fallen = (
        thrown.section("rod", [0.0, 0.5, 1.0]).position[before] - thrown.section("rod", [0.0, 0.5, 1.0]).position[0]
    )
    parabola = 0.5 * thrown.times[before][:, None] ** 2 * np.array([1.5, 0.0, -GRAVITY])
    assert_allclose(fallen, np.repeat(parabola[:, None], 3, axis=1), rtol=0, atol=1e-9)


def test_momentum_changes_by_the_impulse_at_the_section_that_is_struck(thrown: Motion) -> None:
    for event in impacts(thrown):
        state = thrown.at(event.time)
        place = thrown.model.fields["rod"](state.x, state.inputs)[0].full()
        grid = thrown.model.discrete.rods["rod"].grid
        section = grid.interpolation_matrix(np.array([event.place]))[0] @ place.T
        normal = (section - BALL) / np.linalg.norm(section - BALL)
        brief = 1e-9
        change = momenta(thrown, event.time + brief) - momenta(thrown, event.time)
        wanted = event.impulse * np.concatenate([normal, np.cross(section, normal)])
        # Weight and the force of the contact act for the brief time too.
        assert_allclose(change, wanted, rtol=0, atol=1e-8)


def test_energies_balance_and_no_section_is_inside(thrown: Motion) -> None:
    assert thrown.converged, thrown.message
    assert len(impacts(thrown)) >= 1
    assert sum(event.energy for event in impacts(thrown)) > 1e-3
    assert abs(thrown.energy.imbalance).max() < 3e-4
    positions = thrown.section("rod", np.linspace(0.0, 1.0, 401)).position
    distances = np.linalg.norm(positions - BALL, axis=-1) - 0.05
    assert distances.min() > 8e-3 - 1e-5 * LENGTH


@pytest.mark.slow
def test_a_floor_takes_no_momentum_along_it() -> None:
    motion = simulate(free_rod(tangent="1, 0, 0.6", along=2.0, duration=0.11, modes=2))
    assert motion.converged, motion.message
    assert impacts(motion)
    for time in motion.times:
        along = momenta(motion, float(time))[0]
        assert_allclose(along, 2.0 * MASS * time, rtol=0, atol=5e-7)


@pytest.mark.slow
def test_events_and_tips_converge_with_the_tolerance() -> None:
    # By tolerances that are close together, a coarse motion that is exact by chance would hide the fall.
    found = []
    for tolerance in (1e-3, 1e-7, 1e-10):
        text = FREE.format(modes=2, along=2.0, duration=0.14, strain="planar", stuff=THIN, tangent="1, 0, 0.6")
        scene = parse_scene(text.replace("tolerance = 1e-4", f"tolerance = {tolerance}") + FLOOR)
        found.append(simulate(build(scene.with_motion_inputs(), moving=True)))
        # A finer motion has fewer steps here: that it is more exact must not be taken for an error.
        assert found[-1].converged, found[-1].message
        assert found[-1].error_estimate < tolerance
    exact = found.pop()
    errors = [abs(one.tip().position - exact.tip().position).max() / LENGTH for one in found]
    for error, motion in zip(errors, found, strict=True):
        assert error < motion.error_estimate
    assert errors[1] < 1e-3 * errors[0]
    times = [abs(one.events[-1].time - exact.events[-1].time) for one in found]
    assert times[0] < 1e-4
    assert times[1] < 1e-2 * times[0]


@pytest.mark.slow
def test_a_contact_that_leaves_an_end_goes_on_inside_the_rod() -> None:
    """Steps leave the rate of its gap a little off zero, which is no lift-off."""
    stuff = """
material = { youngs_modulus = 1e9, poisson_ratio = 0.4, density = 1200.0 }
section = { shape = "circle", radius = 5e-3 }
"""
    text = FREE.format(modes=3, along=0.0, duration=0.2, strain="planar", stuff=stuff, tangent="1, 0, 0.3")
    scene = parse_scene(text + FLOOR.replace("-0.05", "-0.1"))
    motion = simulate(build(scene.with_motion_inputs(), moving=True))
    assert motion.converged, motion.message
    kinds = [event.kind for event in motion.events]
    assert kinds[:5] == ["impact", "lift_off", "impact", "slide_from_end", "lift_off"]
    assert motion.events[3].place == 1.0
    assert 0.6 < motion.events[4].place < 0.7


@pytest.mark.slow
def test_a_place_that_slides_fast_along_the_rod_is_not_taken_for_one_that_jumps() -> None:
    """Taken for a jump, the rod would be held at a section that moves: that took 4e-3 of the energy unseen."""
    motion = simulate(build(read_scene("examples/rod_hits_floor.toml").with_motion_inputs(), moving=True))
    assert motion.converged, motion.message
    assert [event.kind for event in motion.events] == ["impact", "lift_off", "impact", "slide_from_end"]
    assert motion.contacts[-1][0].at < 0.65
    assert abs(motion.energy.imbalance).max() < 5e-4


def test_a_place_that_slides_over_an_end_of_an_element_goes_on_in_the_next_one() -> None:
    """The bend of the gap jumps there by a factor of four: steps over it came to a halt, or it struck once more."""
    scene = read_scene("examples/rod_hits_floor.toml", ["simulation.duration=0.401"])
    model = build(scene.with_motion_inputs(), moving=True)
    assert scene.simulation is not None
    simulator = Simulator(model, scene.simulation, started(model, scene.simulation, None))
    (facing,) = ExactContacts(model).facings
    times = []
    for tolerance in (1e-4, 3e-6):
        history = simulator.controlled(tolerance)
        assert history.completed
        kinds = [event.kind for event in history.events]
        assert kinds == ["impact", "lift_off", "impact", "slide_from_end", "lift_off"]
        crossed = next(leg.start.instant.time for leg in history.legs if leg.start.instant.time > 0.399)
        times.append([crossed, history.events[-1].time])
        # Sections by the polynomials of their own elements: one touches to the error between steps, none is inside.
        for time in np.linspace(crossed, history.events[-1].time, 5):
            state = history.at(float(time))
            nodes = facing.nodes(state.x, state.inputs)
            deepest = facing.deepest(nodes)
            assert_allclose(deepest.gap, 0.0, rtol=0, atol=0.1 * tolerance)
            assert 0.594 < deepest.place < 0.6 + 1e-6
    assert_allclose(times[0], times[1], rtol=0, atol=3e-5)


def test_ends_of_steps_in_contact_close_gaps_and_leave_them_no_rates() -> None:
    """Stages leave rates of 1e-2 a second, of which a shorter step made forces that pull; cut steps left gaps open."""
    scene = read_scene("examples/rod_hits_floor.toml", ["simulation.duration=0.401"])
    model = build(scene.with_motion_inputs(), moving=True)
    assert scene.simulation is not None
    history = Simulator(model, scene.simulation, started(model, scene.simulation, None)).controlled(3e-3)
    contacts = ExactContacts(model)
    seen = 0
    for leg in history.legs:
        phases = leg.restart.phases
        assert isinstance(phases, ContactPhase)
        if not phases.touches:
            continue
        follower = Follower(contacts.facings, phases.touches)
        for step in leg.integration.steps:
            end = history.of_model(step.end)
            inputs = leg.piece.at(end.time)
            gaps = follower.follow(end.x, inputs.value).gaps
            rates, _ = follower.rates(end.x, end.v, inputs)
            assert_allclose(follower.open_by(gaps), 0.0, rtol=0, atol=1e-12)
            assert_allclose(rates, 0.0, rtol=0, atol=1e-8)
            seen += 1
    assert seen > 15


def test_a_step_in_contact_is_put_right_by_the_smallest_change_in_the_metric_of_the_mass() -> None:
    model = free_rod(tangent="1, 0, -0.1")
    contacts = ExactContacts(model)
    (piece,) = moving_inputs(model).pieces(0.1)
    inputs = piece.at(0.0).value
    ((_, pose),) = model.discrete.unknowns.of_kind(BlockKind.POSE)
    quaternion = slice(pose.start + 3, pose.stop)
    x = model.unloaded()
    x[model.discrete.unknowns.strain("rod")] = [-0.2, 0.1]
    (frame,) = model.discrete.frames.values()
    (facing,) = contacts.facings
    (lowest,) = facing.minima(facing.nodes(x, inputs), 1.0)[:1]
    touches = (MovingContact(0, lowest.place, lowest.inside, lowest.gap - 1e-7),)
    phases = ContactPhase(touches, follower=Follower(contacts.facings, touches))
    v = np.random.default_rng(1).normal(size=model.size)
    norm = np.zeros(model.size)
    norm[quaternion] = np.asarray(frame.start.quaternion) + x[quaternion]
    v -= norm * (norm @ v) / (norm @ norm)
    follower = phases.follower
    (rate,), _ = follower.rates(x, v, piece.at(0.0))
    (gradient,) = follower.gradients(x, inputs, follower.gaps(x, inputs)[1])

    def kinetic(speeds: FloatArray) -> float:
        return float(model.energies(x, speeds, inputs, 0.0 * inputs)[0])

    at = Instant(0.0, np.append(x, 0.3), np.append(v, 0.0), np.zeros(model.size + 1))
    settled = contacts.settled(equations_of(model, piece), piece, phases, at)
    # The mass by the kinetic energy, which is quadratic; the change by the conditions of a least energy.
    axes = np.eye(model.size)
    mass = np.array([[kinetic(p + q) - kinetic(p) - kinetic(q) for p in axes] for q in axes])
    rows = np.vstack([gradient, norm])
    conditions = np.block([[mass / mass.max(), rows.T], [rows, np.zeros((2, 2))]])
    for change, wanted in ((settled.x[:-1] - x, -1e-7), (settled.v[:-1] - v, -rate)):
        least, *_ = np.linalg.lstsq(conditions, np.concatenate([np.zeros(model.size), [wanted, 0.0]]), rcond=1e-13)
        assert_allclose(change, least[: model.size], rtol=1e-5, atol=1e-9 * float(np.abs(change).max()))
    assert abs(rate) > 0.1
    assert kinetic(settled.v[:-1]) < kinetic(v)
    assert settled.x[-1] == 0.3


def test_a_free_rod_that_would_be_held_in_contact_has_no_start() -> None:
    text = FREE.format(modes=2, along=0.0, duration=0.1, strain="planar", stuff=THIN, tangent="1, 0, 0")
    floor = FLOOR.replace("-0.05", "-0.001")
    scene = parse_scene(text.replace('"unloaded"', '"equilibrium"') + floor)
    motion = simulate(build(scene.with_motion_inputs(), moving=True))
    assert motion.outcome is MotionOutcome.NO_START
    assert "free bases held" in motion.message


@pytest.mark.slow
def test_a_thrown_rod_tumbles_and_comes_to_rest() -> None:
    """It strikes a hundred times, ever more softly, at sections that take turns; nothing stops it along the floor."""
    scene = read_scene("examples/rod_hits_floor.toml", ["simulation.duration=1.0"])
    motion = simulate(build(scene.with_motion_inputs(), moving=True))
    assert motion.converged, motion.message
    energy = motion.energy
    assert np.ptp(energy.kinetic[-10:]) < 1e-4 * energy.kinetic.max()
    assert abs(energy.imbalance[-1]) < 5e-3 * energy.kinetic.max()
    weight = 1100.0 * np.pi * 8e-3**2 * 0.4 * 9.81
    resultant = sum(contact.force[2] for contact in motion.contacts[-1])
    assert_allclose(resultant, weight, rtol=0.05, atol=0)


@pytest.mark.slow
def test_a_leaning_rod_rolls_onto_its_end_and_loses_nothing_on_its_way() -> None:
    """A section that a rod rolls onto has no speed there: blows would be those of a polygon of sections."""
    leaning = RUBBER.replace("8e-3", "5e-3").replace("0.48", "0.4")
    text = FREE.format(modes=16, along=0.0, duration=0.14, strain="planar", stuff=leaning, tangent="1, 0, -0.2")
    text = text.replace("nodes = 10", "nodes = 36").replace("time = 1e-3", "time = 5e-3").replace("0.4\n", "0.3\n")
    scene = parse_scene(text.replace("frames = 41", "tolerance = 1e-3, frames = 151") + FLOOR.replace("-0.05", "-0.1"))
    motion = simulate(build(scene.with_motion_inputs(), moving=True))
    assert motion.converged, motion.message
    struck = [event for event in motion.events if event.kind == "impact"]
    fall = 1100.0 * np.pi * 5e-3**2 * 0.3 * GRAVITY * 0.1
    # Held at its sections as a polygon of 48 sides it lost 0.055 of it.
    assert sum(event.energy for event in struck[1:]) < 0.015 * fall
    rolling = [contacts[0] for contacts in motion.contacts if len(contacts) == 1 and 0.1 < contacts[0].at < 0.95]
    assert len(rolling) > 10
    assert not any(contact.lies for contact in rolling)
    assert np.all(np.diff([contact.at for contact in rolling]) < 0.0)
    assert min(contact.force[2] for contact in rolling) > 0.0
    energy = motion.energy
    total = energy.kinetic + energy.elastic + energy.potential
    assert np.diff(total).max() < 1e-4 * np.ptp(total)
    assert np.diff(energy.impacts).min() >= 0.0


def test_a_rod_on_its_end_strikes_close_beside_it_whatever_the_tolerance() -> None:
    """The end is bent up from the floor, and a section 0.0194 of the length from it comes down while the end presses.

    That section strikes before the rod is level at its end: it takes over, and the end goes up.
    """
    table = FLOOR.replace("-0.05", "0.0")
    rubber = RUBBER.replace("2e7", "5e6")
    text = FREE.format(modes=6, along=0.0, duration=0.113, strain="planar", stuff=rubber, tangent="1, 0, 0.15")
    text = text.replace("position = [0, 0, 0]", "position = [0, 0, 0.06]").replace("nodes = 10", "nodes = 16")
    scene = parse_scene(text.replace("time = 1e-3", "time = 2e-3") + table)
    assert scene.simulation is not None
    model = build(scene.with_motion_inputs(), moving=True).at().in_motion
    simulator = Simulator(model, scene.simulation, started(model, scene.simulation, None))
    ends = []
    for tolerance in (1e-3, 1e-5, 1e-6):
        history = simulator.controlled(tolerance)
        first, second = history.events
        assert (first.kind, second.kind) == ("impact", "impact")
        assert_allclose([first.place, second.place], [0.0, 0.0194], rtol=0, atol=3e-4)
        # No restart without a change: the end, then the section beside it.
        _, on_end, beside = history.legs
        for leg, slides in ((on_end, False), (beside, True)):
            phases = leg.restart.phases
            assert isinstance(phases, ContactPhase)
            assert [touch.slides for touch in phases.touches] == [slides]
            assert not phases.laid
        # The energy that the blow takes is the difference of those before and after it.
        kinetic = []
        for state in (on_end.integration.steps[-1].end, beside.start.instant):
            instant = history.flight.to_model(state)
            inputs = beside.piece.at(instant.time)
            x, v = instant.x[: model.size], instant.v[: model.size]
            kinetic.append(float(model.energies(x, v, inputs.value, inputs.rate)[0]))
        assert_allclose(kinetic[0] - kinetic[1], second.energy, rtol=1e-6, atol=0)
        ends.append(simulator.paths(history).points[-1])
    assert_allclose(ends[0], ends[2], rtol=0, atol=1e-4)
    assert_allclose(ends[1], ends[2], rtol=0, atol=1e-6)


def test_a_rod_lies_down_where_two_of_its_sections_have_slid_to_one_place() -> None:
    """They would be one constraint twice, and steps came to a halt. A bowl touches with its middle alone."""
    model = free_rod(tangent="1, 0, -0.1")
    contacts = ExactContacts(model)
    (piece,) = moving_inputs(model).pieces(0.1)
    inputs = piece.at(0.0).value
    ((_, pose),) = model.discrete.unknowns.of_kind(BlockKind.POSE)
    x = model.unloaded()
    x[model.discrete.unknowns.strain("rod")] = [-0.2, 0.0]
    (facing,) = contacts.facings
    x[pose][2] -= facing.minima(facing.nodes(x, inputs), 1.0)[0].gap
    (middle,) = facing.minima(facing.nodes(x, inputs), TOUCHING)
    assert 0.4 < middle.place < 0.6
    plain = equations_of(model, piece)
    still = np.zeros(model.size)
    for distance in (1.1 * SAME_PLACE, SAME_PLACE):
        # The second one is held at its place: what slides alone is followed.
        touches = (MovingContact(0, middle.place, True), MovingContact(0, middle.place + distance, False))
        phases = ContactPhase(touches, follower=Follower(contacts.facings, touches), floors=(np.zeros(1),))
        _, guards = contacts.arranged(plain, piece, phases)
        state = np.concatenate([x, np.ones(2)])
        end = guards(Instant(0.0, state, 0.0 * state, 0.0 * state))[GuardKind.END * len(touches)]
        assert_allclose(end, distance - SAME_PLACE, rtol=0, atol=1e-9)
    restart = contacts.restarted(
        plain, piece, Instant(0.0, x, still, still), phases, GuardKind.END * len(touches), 1e-3
    )
    assert restart.stalled is None
    assert "lie_down" in [event.kind for event in restart.events]
    assert restart.phases.laid == {0}
    assert not any(touch.slides for touch in restart.phases.touches)


def test_the_lowest_valley_between_sections_that_are_looked_at_is_not_missed_beside_a_lower_end() -> None:
    """The gap of an end is that of its section, a valley is lower than the sections about it.

    A rod entered the floor in a valley by 2e-7 of its length while its end was thought lowest, and came to a halt.
    """
    model = free_rod(tangent="1, 0, -0.1")
    (facing,) = facings(model)
    assert isinstance(facing, RodFacing)
    (piece,) = moving_inputs(model).pieces(0.1)
    inputs = piece.at(0.0).value
    ((_, pose),) = model.discrete.unknowns.of_kind(BlockKind.POSE)

    def nodes(tilt: float, sunk: float = 0.0) -> FloatArray:
        x = model.unloaded()
        x[model.discrete.unknowns.strain("rod")] = [-0.205, 1.5]
        x[pose][2] = -sunk
        x[pose][4] = tilt
        return facing.nodes(x, inputs)

    def rise(tilt: float) -> float:
        valley, tip = facing.minima(nodes(tilt), 1.0)
        return tip.gap - valley.gap

    for wanted in (1e-7, -1e-7, 1e-6):
        tilt = brentq(lambda at, wanted=wanted: rise(at) - wanted, -0.6, -0.55, xtol=1e-14)
        valley, _ = facing.minima(nodes(tilt), 1.0)
        sunk = nodes(tilt, valley.gap)
        valley, tip = facing.minima(sunk, 1e-5)
        # Of the sections that are looked at, the tip is the lowest.
        assert gaps_along(facing, sunk, LOOKS).argmin() == LOOKS
        assert_allclose(tip.gap - valley.gap, wanted, rtol=0, atol=1e-10)
        lowest = facing.lowest(sunk, ())
        assert_allclose(lowest, min(valley.gap, tip.gap), rtol=0, atol=1e-12)
        assert_allclose(facing.deepest(sunk).gap, lowest, rtol=0, atol=1e-12)


@pytest.mark.parametrize("from_end", [0.3, 0.45, 0.4999, 0.5001])
@pytest.mark.parametrize("is_tip", [False, True])
def test_a_valley_halfway_from_an_end_to_the_section_beside_it_is_found(from_end: float, is_tip: bool) -> None:
    """Both sections are as low there: a ball that pressed was lost, and the rod next struck it from inside."""
    radius, depth, beside = 0.02, 1e-8, from_end / LOOKS
    place = 1.0 - beside if is_tip else beside
    ball = f"""
        [[obstacles]]
        name = "ball"
        kind = "sphere"
        centre = [{LENGTH * place}, 0, {-radius + depth * LENGTH}]
        radius = {radius}
    """
    model = free_rod(ball)
    (facing,) = facings(model)
    nodes = facing.nodes(model.unloaded(), moving_inputs(model).pieces(0.1)[0].at(0.0).value)
    (valley,) = facing.minima(nodes, TOUCHING)
    assert_allclose([valley.place, valley.gap], [place, -depth], rtol=0, atol=1e-12)
    assert_allclose(facing.lowest(nodes, ()), -depth, rtol=0, atol=1e-12)


def test_a_rod_that_is_laid_down_because_its_contacts_change_too_often_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """With no change in a moment allowed, a rod that touches lies down where its contacts change."""
    scene = read_scene("examples/rod_hits_floor.toml", ["simulation.duration=0.36", "accuracy.modes=2"])
    model = build(scene.with_motion_inputs(), moving=True)
    assert scene.simulation is not None
    simulator = Simulator(model, scene.simulation, started(model, scene.simulation, None))
    motions = []
    for most in (exact_contact.MOST_IN_A_MOMENT, -1):
        monkeypatch.setattr(exact_contact, "MOST_IN_A_MOMENT", most)
        motions.append(motion_of(simulator, simulator.controlled(1e-2), MotionOutcome.COMPLETED, 0.0, ""))
    rolled, forced = motions
    assert "lift_off" in [event.kind for event in rolled.events]
    assert "laid_down" not in [event.kind for event in rolled.events]
    assert rolled.warnings == ()
    times = [event.time for event in forced.events if event.kind == "laid_down"]
    assert times
    (warning,) = forced.warnings
    assert "'rod' with 'floor' changed over and over within almost no time" in warning
    assert f"({len(times)} times, first at t = {times[0]:.6g} s)" in warning


@pytest.mark.slow
def test_a_rod_dropped_on_a_soft_table_is_as_exact_as_it_says() -> None:
    """At the default tolerance, on few modes of each of its four elements, vs a motion ten times as exact."""
    soft = RUBBER.replace("2e7", "5e6")
    text = FREE.replace("accuracy = {{ modes = {modes}, nodes = 10, tolerance = 1e-4 }}\n", "")
    text = text.format(stuff=soft, duration=0.15, tangent="1, 0, 0.15", along=0.0, strain="planar")
    text += FLOOR + "width = 4e-3\nstiffness = 1e5\ndamping = 0.3\n"
    dropped = simulate(parse_scene(text))
    exact = simulate(parse_scene(text, ["simulation.tolerance=1e-4"]))
    assert dropped.converged
    assert exact.converged
    assert dropped.model.discretisation["rod"].modes == (6,)
    distance = np.linalg.norm(dropped.tip().position - exact.tip().position, axis=1).max() / LENGTH
    assert distance < dropped.error_estimate + exact.error_estimate
    assert 1e-6 < dropped.error_estimate < 1e-3


@pytest.mark.slow
def test_a_stiff_rod_without_damping_that_lands_on_its_end_is_given_up_early_with_its_reason() -> None:
    """Its waves have all lengths: it is given up on no more than 21 modes, where 48 were tried."""
    stiff = RUBBER.replace("2e7", "5e8").replace("0.48", "0.3")
    text = FREE.replace("accuracy = {{ modes = {modes}, nodes = 10, tolerance = 1e-4 }}\n", "")
    text = text.replace("damping = {{ retardation_time = 1e-3 }}\n", "")
    text = text.format(stuff=stiff, duration=0.4, tangent="0.2, 0, -1", along=0.0, strain="planar")
    text += FLOOR.replace("-0.05", "-0.5")
    dropped = simulate(parse_scene(text))
    assert dropped.outcome is MotionOutcome.UNRESOLVED
    assert "waves of all lengths along a rod without damping" in dropped.message
    assert max(dropped.model.discretisation["rod"].modes) <= 21
    assert 1e-3 < dropped.error_estimate < 1.0
