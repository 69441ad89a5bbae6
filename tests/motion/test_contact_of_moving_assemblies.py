"""Exact contact of carried rods, closed loops and bodies in motion: by hand, by projections, by one rod for two."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import null_space

from cosserat_casadi import build, parse_scene, simulate
from cosserat_casadi.errors import SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.motion.coincident_ends import MeetingEnds, RodEnd, meetings, watched_ends
from cosserat_casadi.motion.contact_forces import Follower, MovingContact
from cosserat_casadi.motion.exact_contact import LEEWAY, ExactContacts
from cosserat_casadi.motion.facings import facings
from cosserat_casadi.motion.history import equations_of
from cosserat_casadi.motion.simulate import moving_inputs
from cosserat_casadi.motion.trajectory import Motion
from cosserat_casadi.numerics.motion_equations import Instant
from tests.derivatives import central_differences

HEAD = """
schema = 1
accuracy = {{ modes = {modes}, nodes = 10, tolerance = {tolerance} }}
simulation = {{ duration = {duration}, start = "unloaded", frames = 41 }}
"""

WEIGHT = """
[[loads]]
name = "weight"
kind = "gravity"
acceleration = [0, 0, -9.81]
"""

ROD = """
[[rods]]
name = "{name}"
length = {length}
strain = "planar"
stiffness = {{ bending_y = {stiffness} }}
linear_density = {density}
rotary_inertia = [1e-7, 1e-7, 2e-7]
base = {base}
damping = {{ retardation_time = {damping} }}
"""

BALL = """
[[bodies]]
name = "ball"
mass = 0.1
radius = 0.03
[[joints]]
body = "ball"
rod = "{rod}"
kind = "fixed"
"""

FLOOR = """
[[obstacles]]
name = "floor"
kind = "plane"
point = [0, 0, {height}]
normal = [0, 0, 1]
{who}
"""

WORLD = "{ position = [0, 0, 0], tangent = [1, 0, 0] }"


def head(modes: int = 2, duration: float = 0.2, tolerance: float = 1e-4) -> str:
    return HEAD.format(modes=modes, duration=duration, tolerance=tolerance)


def rod(
    name: str = "rod",
    length: float = 0.4,
    base: str = WORLD,
    stiffness: float = 0.016,
    density: float = 0.2,
    damping: float = 0.01,
) -> str:
    given = {"name": name, "length": length, "base": base, "stiffness": stiffness}
    return ROD.format(density=density, damping=damping, **given)


def moving(text: str) -> Model:
    return build(parse_scene(text).with_motion_inputs(), moving=True)


FRAME = (
    rod("left", 0.3)
    + rod("right", 0.3, "{ position = [0, 0, 0.1], tangent = [1, 0, 0] }")
    + """
[[bodies]]
name = "deck"
mass = 0.05
inertia = [1e-5, 2e-5, 1e-5]
radius = 0.02
[[joints]]
body = "deck"
rod = "left"
kind = "fixed"
position = [0.05, 0, 0]
[[joints]]
body = "deck"
rod = "right"
kind = "revolute"
axis = [0, 1, 0]
position = [-0.05, 0, 0]
"""
)

TWIGS = (
    rod("trunk", 0.3)
    + rod("twig", 0.2, '{ rod = "trunk", at = 1.0, quaternion = [0.9, 0, 0.43588989, 0] }')
    + BALL.format(rod="twig")
    + """
[[obstacles]]
name = "globe"
kind = "sphere"
centre = [0.23, 0, -0.14]
radius = 0.1
rods = ["trunk", "twig"]
bodies = ["ball"]
"""
)


@pytest.mark.parametrize(("name", "slides"), [("twig", True), ("twig", False), ("ball", False)])
def test_derivatives_of_gaps_of_assemblies_are_those_of_differences(name: str, slides: bool) -> None:
    lift = "[[motions]]\ninput = 'trunk.base.position'\namplitude = [0, 0, 0.1]\nfrequency = 1.0\n"
    model = moving(head() + TWIGS + lift)
    number = [facing.owner for facing in facings(model)].index(name)
    follower = Follower(facings(model), (MovingContact(number, 0.5 if slides else 1.0, slides),))
    (facing,) = follower.facings
    rng = np.random.default_rng(3)
    x = 0.1 * rng.normal(size=model.size)
    v = rng.normal(size=model.size)
    inputs = model.pack()
    rate, acceleration = rng.normal(size=(2, len(inputs)))

    def gap(at: FloatArray, given: FloatArray = inputs) -> float:
        return follower.gaps(at, given)[1][0].value

    (here,) = follower.gaps(x, inputs)[1]
    gradient = facing.gradient(x, inputs, here)
    turning = facing.turning(facing.points.jacobian(x, inputs), here, slides=slides)
    hessian = facing.points.hessian(x, inputs, facing.weights(here)) + turning
    step = 1e-4
    for direction in (v, rng.normal(size=model.size)):
        ahead, behind = gap(x + step * direction), gap(x - step * direction)
        assert_allclose(gradient @ direction, (ahead - behind) / (2 * step), rtol=1e-5, atol=1e-7)
        bend = (ahead - 2 * here.value + behind) / step**2
        assert_allclose(direction @ hessian @ direction, bend, rtol=1e-3, atol=1e-5)
    (first,), (second,) = follower.rates(x, v, [inputs, rate, acceleration])

    def along(time: float) -> float:
        return gap(x + time * v, inputs + time * rate + 0.5 * time**2 * acceleration)

    ahead, behind = along(step), along(-step)
    assert_allclose(first, (ahead - behind) / (2 * step), rtol=1e-5, atol=1e-7)
    assert_allclose(second, (ahead - 2 * here.value + behind) / step**2, rtol=1e-3, atol=1e-5)


def test_a_ball_on_a_light_rod_strikes_as_an_oscillator_does() -> None:
    """One polynomial of curvature κ, w = κℓ²/2 at the tip, energy ½ EI ℓ κ²: the spring is 4 EI/ℓ³."""
    length, stiffness, mass = 0.4, 5.0, 0.1
    light = rod(length=length, stiffness=stiffness, density=1e-9, damping=0.0)
    depth = 2e-4
    text = head(1, 0.02, 1e-7) + light.replace("[1e-7, 1e-7, 2e-7]", "[1e-15, 1e-15, 2e-15]") + BALL.format(rod="rod")
    scene = text + WEIGHT + FLOOR.format(height=-0.03 - depth, who='bodies = ["ball"]')
    motion = simulate(moving(scene.replace("mass = 0.1", "mass = 0.1\ninertia = [1e-12, 1e-12, 1e-12]")))
    spring = 4 * stiffness / length**3
    sag = mass * 9.81 / spring
    frequency = np.sqrt(spring / mass)
    time = np.arccos(1 - depth / sag) / frequency
    speed = sag * frequency * np.sin(frequency * time)
    struck = motion.events[0]
    assert (struck.kind, struck.owner, struck.of_body) == ("impact", "ball", True)
    # Slopes of a thousandth are left out by hand.
    assert_allclose(struck.time, time, rtol=1e-5, atol=0)
    assert_allclose(struck.impulse, mass * speed, rtol=1e-5, atol=0)
    assert_allclose(struck.energy, 0.5 * mass * speed**2, rtol=1e-5, atol=0)
    # Nothing else moves: it stays on the floor, which bears what the spring does not.
    (contact,) = motion.contacts[-1]
    assert contact.of_body
    assert_allclose(contact.force, [0, 0, mass * 9.81 - spring * depth], rtol=0, atol=1e-4)


def impulse_by_projection(model: Model, motion: Motion, time: float, body: str) -> tuple[float, float]:
    """Impulse of a floor on a ball, N s, and the speed of approach, from the mass matrix on what joints leave free."""
    state = motion.at(time)
    zeros = np.zeros(model.size)
    still = 0.0 * state.inputs
    moves = np.flatnonzero(model.discrete.unknowns.differential)

    def forces(a: FloatArray) -> FloatArray:
        rows = model.inverse_dynamics(state.x, zeros, a, state.inputs, still, still).full()[:, 0]
        return np.asarray(rows * model.discrete.unknowns.units)

    at_rest = forces(zeros)
    mass = np.stack([forces(np.eye(model.size)[k]) - at_rest for k in moves], axis=1)[moves]
    assert_allclose(mass, mass.T, rtol=0, atol=1e-12)
    joints = [np.arange(span.start, span.stop) for _, span in model.discrete.unknowns.of_kind(BlockKind.MULTIPLIER)]
    jacobian = model.jacobian(state.x, state.inputs)[0].full()
    admitted = null_space(jacobian[np.ix_(np.concatenate(joints), moves)])

    def height(x: FloatArray) -> float:
        return float(model.body[body](x, state.inputs)[0].full()[2, 0])

    (rises,) = central_differences(height, state.x, 1e-6)
    own = rises[moves] @ admitted
    approach = float(rises @ state.v)
    inverse_mass = own @ np.linalg.solve(admitted.T @ mass @ admitted, own)
    return -approach / inverse_mass, -approach


@pytest.mark.slow
@pytest.mark.parametrize("rods", [FRAME, TWIGS.split("[[obstacles]]")[0]], ids=["closed", "open"])
def test_impulses_act_together_with_those_of_joints(rods: str, tmp_path: Path) -> None:
    body = "deck" if "deck" in rods else "ball"
    height = -0.02 if body == "deck" else -0.19
    text = head(duration=0.12) + rods + WEIGHT + FLOOR.format(height=height, who=f'bodies = ["{body}"]')
    model = moving(text)
    motion = simulate(model)
    assert motion.converged, motion.message
    struck = motion.events[0]
    assert (struck.kind, struck.owner) == ("impact", body)
    impulse, speed = impulse_by_projection(model, motion, struck.time, body)
    assert_allclose(struck.impulse, impulse, rtol=1e-5, atol=0)
    assert_allclose(struck.energy, 0.5 * impulse * speed, rtol=1e-5, atol=0)
    assert abs(motion.energy.imbalance).max() < 1e-3
    motion.write(tmp_path / "motion.json")
    entry = json.loads((tmp_path / "motion.json").read_text())["contact"]
    assert entry["rod"][-1] == body
    assert entry["of_body"][-1] is True
    assert entry["events"]["of_body"][0] is True
    motion.write(tmp_path / "motion.png")


@pytest.mark.slow
def test_two_rods_in_series_touch_as_one_across_their_joint() -> None:
    ball = '[[obstacles]]\nname = "ball"\nkind = "sphere"\ncentre = [0.17, 0, -0.09]\nradius = 0.03\n'
    # A load that is zero divides the one rod where the two are joined.
    nothing = '[[loads]]\nname = "no"\nkind = "point_wrench"\nrod = "rod"\nat = 0.5\nforce = [0, 0, 0]\n'
    start = head(duration=0.2)
    one = simulate(moving(start + rod() + WEIGHT + nothing + ball))
    series = rod("first", 0.2) + rod("second", 0.2, '{ rod = "first", at = 1.0 }')
    two = simulate(moving(start + series + WEIGHT + ball))
    assert one.converged, one.message
    assert two.converged, two.message
    assert [event.kind for event in one.events] == ["impact"]
    struck, slid = two.events
    assert (struck.kind, struck.owner) == ("impact", "first")
    assert (slid.kind, slid.owner, slid.place) == ("slide_over_joint", "second", 0.0)
    assert_allclose(struck.time, one.events[0].time, rtol=0, atol=1e-6)
    assert_allclose(struck.place / 2, one.events[0].place, rtol=0, atol=1e-5)
    assert_allclose(struck.impulse, one.events[0].impulse, rtol=1e-4, atol=0)
    assert_allclose(two.tip("second").position, one.tip().position, rtol=0, atol=1e-5 * 0.4)
    (whole,) = one.contacts[-1]
    (part,) = two.contacts[-1]
    assert part.owner == "second"
    assert_allclose(0.5 + part.at / 2, whole.at, rtol=0, atol=1e-4)
    assert_allclose(part.force, whole.force, rtol=0, atol=1e-2 * np.linalg.norm(whole.force))


@pytest.mark.slow
def test_a_free_rod_with_a_ball_takes_the_impulse_at_the_centre_of_the_ball() -> None:
    club = rod(base="{ position = [0, 0, 0], tangent = [1, 0, -0.5], free = true }", stiffness=0.5)
    text = head(duration=0.11) + club + BALL.format(rod="rod") + WEIGHT
    motion = simulate(moving(text + FLOOR.format(height=-0.25, who='bodies = ["ball"]')))
    struck = motion.events[0]
    assert (struck.kind, struck.owner) == ("impact", "ball")

    def momenta(time: float) -> FloatArray:
        state = motion.at(time)
        linear, angular = motion.model.momentum(state.x, state.v, state.inputs, 0.0 * state.inputs)
        return np.concatenate([linear.full()[:, 0], angular.full()[:, 0]])

    state = motion.at(struck.time)
    centre = motion.model.body["ball"](state.x, state.inputs)[0].full()[:, 0]
    change = momenta(struck.time + 1e-9) - momenta(struck.time)
    upward = np.array([0.0, 0.0, struck.impulse])
    assert_allclose(change, [*upward, *np.cross(centre, upward)], rtol=0, atol=1e-7)
    assert struck.impulse > 0.01


def test_ends_that_are_one_point_are_watched_once() -> None:
    model = moving(head() + TWIGS)
    assert meetings(model.scene) == [{RodEnd("trunk", 1.0), RodEnd("twig", 0.0)}]
    (globe,) = model.scene.obstacles
    assert watched_ends(model, "trunk", globe) == (False, True)
    assert watched_ends(model, "twig", globe) == (False, True)
    fork = moving(head() + FRAME.replace("[-0.05", "[0.05") + FLOOR.format(height=-1.0, who=""))
    assert meetings(fork.scene) == [{RodEnd("left", 1.0), RodEnd("right", 1.0)}]
    (floor,) = fork.scene.obstacles
    assert watched_ends(fork, "left", floor) == (False, True)
    assert watched_ends(fork, "right", floor) == (False, False)


def test_a_place_stays_at_a_corner_and_goes_on_where_there_is_none() -> None:
    series = rod("first", 0.2) + rod("second", 0.2, '{ rod = "first", at = 1.0, quaternion = [COS, 0, SIN, 0] }')
    ball = '[[obstacles]]\nname = "ball"\nkind = "sphere"\ncentre = [0.2, 0, -0.05]\nradius = 0.03\n'
    arriving = MovingContact(0, 1.0, True)
    went: dict[float, MovingContact] = {}
    # Over a ball a rod that goes on upwards leaves a corner that points down.
    for turn in (0.0, -0.3):
        turned = series.replace("COS", str(np.cos(turn / 2))).replace("SIN", str(np.sin(turn / 2)))
        model = moving(head() + turned + ball)
        x = model.unloaded()
        went[turn] = MeetingEnds(facings(model)).gone_on(arriving, x, model.pack())
    assert went[0.0] == MovingContact(1, 0.0, True)
    assert went[-0.3] == MovingContact(0, 1.0, False)
    ends = MeetingEnds(facings(model))
    assert ends.rise(MovingContact(0, 1.0, False), x, model.pack()) == pytest.approx(0.0, abs=1e-12)
    assert ends.beside(MovingContact(0, 0.99, True), 0.02) == [(1, 0.0)]
    known = (MovingContact(0, 0.995, True),)
    assert ends.distinct(known, (MovingContact(1, 0.004, True),), 0.02) == known
    assert len(ends.distinct(known, (MovingContact(1, 0.5, True),), 0.02)) == 2


def test_a_ball_on_a_bar_that_is_too_thin_is_refused() -> None:
    text = head() + rod() + BALL.format(rod="rod").replace("0.03", "1e-4") + WEIGHT
    bar = '[[obstacles]]\nname = "bar"\nkind = "capsule"\nfrom = [0.4, -1, -0.2]\nto = [0.4, 1, -0.2]\nradius = 1e-4\n'
    with pytest.raises(SceneError, match=r"obstacles\.bar: its radius with the ball of 'ball' is 0\.0002 m"):
        simulate(moving(text + bar + 'bodies = ["ball"]\n'))


CLUB = """
schema = 1
accuracy = { modes = 3, nodes = 12, tolerance = 1e-3 }
simulation = { duration = 0.49, frames = 81, start = "unloaded" }
loads = [
    { name = "weight", kind = "gravity", acceleration = [0, 0, -9.81] },
    { name = "hand", kind = "point_wrench", rod = "handle", at = 0.3, force = [0, 0, 0] },
]
[[motions]]
input = "hand.force"
times = [0.0, 0.05, 0.1]
values = [[0, 0, 0], [4.0, 0.0, 3.0], [0, 0, 0]]
interpolation = "cubic"
[[rods]]
name = "handle"
length = 0.4
strain = "planar"
material = { youngs_modulus = 2e8, poisson_ratio = 0.48, density = 1100.0 }
section = { shape = "circle", radius = 7e-3 }
base = { position = [0, 0, 0.25], tangent = [1, 0, 0.5], free = true }
damping = { retardation_time = 4e-3 }
[[bodies]]
name = "head"
mass = 0.08
inertia = [3e-5, 3e-5, 3e-5]
radius = 0.03
[[joints]]
body = "head"
rod = "handle"
kind = "fixed"
[[obstacles]]
name = "floor"
kind = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]
rods = ["handle"]
bodies = ["head"]
"""


@pytest.mark.slow
def test_a_head_that_is_shaken_off_the_floor_by_its_handle_does_not_leave_and_touch_without_end() -> None:
    """The handle strikes while the head is on the floor: flights of nanoseconds, and dips of less than the error."""
    motion = simulate(moving(CLUB))
    assert motion.converged, motion.message
    assert [event.owner for event in motion.events[:2]] == ["head", "handle"]
    rolls = [event.kind for event in motion.events].index("slide_from_end")
    assert motion.events[rolls].owner == "handle"
    # The handle goes on without a further blow.
    assert motion.events[1].energy > 100 * sum(event.energy for event in motion.events[2:])
    heights = motion.body("head").position[:, 2] - 0.03
    assert heights.min() > -1e-4 * 0.4
    assert abs(motion.energy.imbalance).max() < 2e-3


def test_what_a_stretch_begins_inside_may_leave_and_comes_no_deeper() -> None:
    """A ball a little inside that is on its way out: the guard of its gap is LEEWAY there, over the length."""
    floor = FLOOR.format(height=-0.03 + 1e-10 * 0.4, who='bodies = ["ball"]')
    model = moving(head() + rod() + BALL.format(rod="rod") + floor)
    (piece,) = moving_inputs(model).pieces(0.1)
    contacts = ExactContacts(model)
    plain = equations_of(model, piece)
    x, still = model.unloaded(), np.zeros(model.size)
    upwards = contacts.facings[0].gradient(x, np.zeros(0), contacts.facings[0].at(np.zeros((1, 3)), 0.0))
    begin = Instant(0.0, x, upwards, still)
    restart = contacts.restarted(plain, piece, begin, contacts.first_phases(x, np.zeros(0)), None, 1e-3)
    assert not restart.phases.touches
    _, guards = contacts.arranged(plain, piece, restart.phases)
    assert_allclose(guards(begin)[0], LEEWAY, rtol=1e-6, atol=0)
