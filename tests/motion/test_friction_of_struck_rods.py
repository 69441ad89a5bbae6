"""Friction of rods that touch rods without a width, in motion: closed forms, momentum, energy, told errors."""

from __future__ import annotations

import ctypes
from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.polynomial import legendre
from numpy.testing import assert_allclose
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from cosserat_casadi import build, scene_from_dict, simulate
from cosserat_casadi.compiling.compiler import compiled_texts, find_compiler
from cosserat_casadi.compiling.texts import render, resource
from cosserat_casadi.maths.calls import functions_within
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion import contact_law
from cosserat_casadi.motion.contact_forces import Follower, MovingContact
from cosserat_casadi.motion.facings import facings
from cosserat_casadi.motion.momentum import MomentumKeeper
from cosserat_casadi.motion.pose_series import section_poses
from cosserat_casadi.motion.rods_facing import RodGap, RodsFacing
from cosserat_casadi.motion.rubbing_library import ToldStretch
from cosserat_casadi.motion.rubbing_motion import _Told
from cosserat_casadi.motion.surface_sliding import SurfaceSliding
from cosserat_casadi.motion.trajectory import Motion
from tests.derivatives import central_differences
from tests.motion.test_rods_that_strike_rods import (
    DENSITY,
    LENGTHS,
    RADIUS,
    any_rods,
    free_rods,
    momentum,
    moving,
    rod,
    scene,
)

G = 9.81
FRICTION = 0.3
AREA = np.pi * RADIUS**2

Table = dict[str, Any]


def with_friction(tables: Table, friction: float = FRICTION) -> Table:
    tables["rod_contacts"][0]["friction"] = friction
    return tables


def straight(name: str, base: Table) -> Table:
    """A rod that can only twist: beside that it is a rigid body."""
    return rod(name, base) | {"strain": ["torsion"]}


def moved(tables: Table) -> Motion:
    motion = simulate(moving(tables))
    assert motion.converged, motion.message
    return motion


def slope(angle: float, speed: float = 0.0, duration: float = 0.05) -> Motion:
    """A straight rod that lies along another one, which is held and goes down along x."""
    upper = straight("upper", {"free": True, "position": [0.05, 0, 2 * RADIUS], "tangent": [1, 0, 0]})
    lower = straight("lower", {"position": [0, 0, 0], "tangent": [1, 0, 0]})
    weight = {"kind": "gravity", "acceleration": [G * np.sin(angle), 0, -G * np.cos(angle)], "name": "weight"}
    more: Table = {"velocities": [{"rod": "upper", "linear": [speed, 0, 0]}]} if speed else {}
    return moved(with_friction(scene([upper, lower], duration, loads=[weight], **more)))


def way(motion: Motion) -> FloatArray:
    """Way of the upper rod along the lower one, m."""
    path: FloatArray = motion.tip("upper").position[:, 0]
    return path - path[0]


def test_a_rod_sticks_on_another_one_below_the_angle_of_friction_and_slides_above_it() -> None:
    below, above = np.arctan(FRICTION) * np.array([0.999, 1.5])
    mass = DENSITY * AREA * LENGTHS["upper"]
    rests = slope(below)
    assert np.abs(way(rests)).max() < 1e-12
    assert [event.kind for event in rests.events] == ["lie_down", "stick"]
    held = sum(contact.friction for contact in rests.contacts[-1])
    assert_allclose(held, [-mass * G * np.sin(below), 0.0, 0.0], rtol=1e-9, atol=1e-12)
    slides = slope(above)
    down = G * (np.sin(above) - FRICTION * np.cos(above))
    assert_allclose(way(slides), down * slides.times**2 / 2.0, rtol=0, atol=2e-6 * way(slides)[-1])
    assert all(contact.slips and contact.lies for contact in slides.contacts[-1])
    taken = FRICTION * mass * G * np.cos(above) * way(slides)
    assert_allclose(slides.energy.dissipated, taken, rtol=0, atol=2e-6 * taken[-1])
    assert np.abs(slides.energy.imbalance).max() < 1e-6


def test_a_rod_that_slides_on_another_one_is_stopped_by_friction() -> None:
    speed = 0.1
    motion = slope(0.0, speed)
    slowing = FRICTION * G
    end = speed / slowing
    expected = np.where(motion.times < end, speed * motion.times - slowing * motion.times**2 / 2, end * speed / 2)
    assert_allclose(way(motion), expected, rtol=0, atol=1e-6 * expected[-1])
    assert [event.kind for event in motion.events] == ["lie_down", "slip", "stick"]
    # An event is located to the length of a step.
    assert_allclose(motion.events[-1].time, end, rtol=0, atol=1.1e-3)


def test_a_driven_rod_takes_another_one_along() -> None:
    """Friction brings the upper rod to the speed of the lower one; the drive puts in what both get and what is lost."""
    upper = straight("upper", {"free": True, "position": [0.05, 0, 2 * RADIUS], "tangent": [1, 0, 0]})
    lower = straight("lower", {"position": [0, 0, 0], "tangent": [1, 0, 0]})
    weight = {"kind": "gravity", "acceleration": [0, 0, -G], "name": "weight"}
    speed, duration = 0.1, 0.06
    values = [[0, 0, 0], [speed * duration, 0, 0]]
    drive = {"input": "lower.base.position", "times": [0.0, duration], "values": values}
    motion = moved(with_friction(scene([upper, lower], duration, loads=[weight], motions=[drive])))
    end = speed / (FRICTION * G)
    times = motion.times
    expected = np.where(times < end, FRICTION * G * times**2 / 2, speed * (times - end / 2))
    assert_allclose(way(motion), expected, rtol=0, atol=1e-6 * expected[-1])
    gained = DENSITY * AREA * LENGTHS["upper"] * speed**2 / 2
    assert_allclose(motion.energy.dissipated[-1], gained, rtol=1e-6, atol=0)
    assert_allclose(motion.energy.work[-1], 2 * gained, rtol=1e-6, atol=0)


def answer(name: str, X: float, side: float) -> FloatArray:
    """Velocity, at a point on the surface of a free rigid rod, that a unit impulse there makes, shape (3, 3), 1/kg.

    Args:
        name: of the rod.
        X: abscissa of the section.
        side: 1 for the point above the centre line, -1 for the one below.
    """
    axis = np.array([1.0, 0, 0]) if name == "upper" else np.array([0, 1.0, 0])
    length, mass = LENGTHS[name], DENSITY * AREA * LENGTHS[name]
    beside = np.array([0.0, 0.0, side * RADIUS])
    arm = (X - 0.5) * length * axis + beside
    across = np.eye(3) - np.outer(axis, axis)
    turns = np.cross(np.eye(3), arm)
    of_turning = turns.T @ across @ turns / (mass * (length**2 / 12 + RADIUS**2 / 4))
    # Two modes twist it as polynomials of the second degree.
    twisting = np.cross(axis, beside)
    twists = sum((2 * k + 1) * legendre.legval(2 * X - 1, [0] * k + [1]) ** 2 for k in range(3))
    of_twisting = np.outer(twisting, twisting) * twists / (mass * RADIUS**2 / 2)
    return np.eye(3) / mass + of_turning + of_twisting


def blow(compliance: FloatArray, before: FloatArray, share: float, friction: float) -> FloatArray:
    """Impulse on the upper rod by Newton's law along z and Coulomb's across it, shape (3,), N s."""
    wanted = np.array([0.0, 0.0, -share * before[2]]) - before
    sticking = np.linalg.solve(compliance, wanted)
    if np.hypot(*sticking[:2]) <= friction * sticking[2]:
        return sticking

    def impulse(angle: float) -> FloatArray:
        """The impulse that takes the approach, against sliding in a direction."""
        way = np.array([-friction * np.cos(angle), -friction * np.sin(angle), 1.0])
        return way * wanted[2] / (compliance[2] @ way)

    def aside(angle: float) -> float:
        after = before + compliance @ impulse(angle)
        return float(np.sin(angle) * after[0] - np.cos(angle) * after[1])

    start = np.arctan2(before[1], before[0])
    return impulse(brentq(aside, start - 1.0, start + 1.0, xtol=1e-14))


@pytest.mark.parametrize("tangential", [[1.2, 0.3], [0.05, 0.08]])
def test_an_askew_blow_of_two_rigid_rods(tangential: list[float]) -> None:
    """Two rods that can only twist strike as rigid bodies do: at first they slide in the blow, then they stick."""
    upper = straight("upper", {"free": True, "position": [-0.12, 0, 0.011], "tangent": [1, 0, 0]})
    lower = straight("lower", {"free": True, "position": [0.05, -0.17, 0], "tangent": [0, 1, 0]})
    falls = [{"rod": "upper", "linear": [*tangential, -0.4]}, {"rod": "lower", "linear": [0.0, 0.0, 0.1]}]
    share = 0.4
    motion = moved(with_friction(scene([upper, lower], 0.004, share, velocities=falls)))
    first = motion.events[0]
    assert (first.kind, first.owner, first.obstacle) == ("impact", "upper", "lower")
    before = np.array([*tangential, -0.5])
    time = (0.011 - 2 * RADIUS) / 0.5
    X, Y = (0.17 - tangential[0] * time) / 0.3, (0.17 + tangential[1] * time) / 0.4
    impulse = blow(answer("upper", X, -1) + answer("lower", Y, 1), before, share, FRICTION)
    slides = np.hypot(*impulse[:2]) > 0.999999 * FRICTION * impulse[2]
    assert slides == (tangential[0] > 0.1)
    assert_allclose((first.time, first.place), (time, X), rtol=0, atol=1e-6)
    assert_allclose(first.impulse, impulse[2], rtol=1e-4, atol=0)
    # What flew on is where these velocities lead.
    later = motion.times[-1] - time
    starts = {own["rod"]: np.array(own["linear"]) for own in falls}
    for name, sign in (("upper", 1.0), ("lower", -1.0)):
        middle = motion.section(name, 0.5).position
        mass = DENSITY * AREA * LENGTHS[name]
        expected = middle[0] + starts[name] * motion.times[-1] + sign * impulse / mass * later
        assert_allclose(middle[-1], expected, rtol=0, atol=1e-4 * np.linalg.norm(impulse) / mass * later)


def section_at(facing: RodsFacing, x: FloatArray, inputs: FloatArray, near: float) -> tuple[float, RodGap, FloatArray]:
    """Place where the gap is least, that gap, and the section there as functions of sliding have it."""
    (place,), (gap,) = Follower([facing], (MovingContact(0, near, True),)).gaps(x, inputs)
    assert isinstance(gap, RodGap)
    section = np.concatenate([gap.own_rows.value + gap.other.rows.value, [place, gap.other_place]])
    return place, gap, section


def tangents_of(gap: RodGap, axis: FloatArray) -> FloatArray:
    """Both tangents of a gap, row after row, shape (2, 3)."""
    first = axis - (axis @ gap.normal) * gap.normal
    first /= np.linalg.norm(first)
    return np.array([first, np.cross(gap.normal, first)])


def test_sliding_is_the_velocity_of_one_point_of_two_rods() -> None:
    """Differences of poses over time give the sliding; its gradients are forces without resultant and moment."""
    tables = with_friction(free_rods())
    tables["rods"][0] = rod("upper", tables["rods"][0]["base"], [8e-3, 4e-3])
    model = moving(tables)
    (facing,) = facings(model)
    assert isinstance(facing, RodsFacing)
    x, inputs = 0.05 * np.random.default_rng(7).normal(size=model.size), model.pack()
    _, gap, section = section_at(facing, x, inputs, facing.deepest(facing.nodes(x, inputs)).place)
    v = 0.3 * np.random.default_rng(8).normal(size=model.size)
    axis = np.array([0.0, 1.0, 0.0])
    sliding, by_v, _ = SurfaceSliding(facing).function(x, inputs, v, 0 * inputs, section, axis)
    places = dict(zip(LENGTHS, section[-2:], strict=True))
    step = 1e-5
    states = np.stack([x - step * v, x, x + step * v])
    at = np.stack([inputs] * 3)
    poses = {name: section_poses(model, name, np.array([X]), states, at) for name, X in places.items()}
    centres = [poses[name].position[1, 0] for name in LENGTHS]
    radii = [8e-3 - 4e-3 * places["upper"], RADIUS]
    point = centres[1] + radii[1] / sum(radii) * (centres[0] - centres[1])
    speeds = []
    for name in LENGTHS:
        pose = poses[name]
        turns = Rotation.from_quat(pose.quaternion[:, 0, [1, 2, 3, 0]]).as_matrix()
        track = pose.position[:, 0] + turns @ turns[1].T @ (point - pose.position[1, 0])
        speeds.append((track[2] - track[0]) / (2 * step))
    expected = tangents_of(gap, axis) @ (speeds[0] - speeds[1]) / LENGTHS["upper"]
    assert_allclose(ca.DM(sliding).full()[:, 0], expected, rtol=1e-7, atol=1e-8)
    forces = by_v.full().T @ MomentumKeeper(model).rigid_motions(x)
    assert_allclose(forces, 0.0, rtol=0, atol=1e-12)


def test_derivatives_of_sliding_are_those_of_differences() -> None:
    """Both bases move; the upper rod tapers, so that the arm changes with its abscissa."""
    tables = held_rods(1e-3)
    tables["rods"][0] |= {"section": {"shape": "circle", "radius": [8e-3, 4e-3]}}
    tables |= {"accuracy": {"modes": 1, "nodes": 4}, "motions": []}
    tables["inputs"] = ["upper.base.position", "lower.base.position", "lower.base.quaternion"]
    model = moving(tables)
    (facing,) = facings(model)
    sliding = SurfaceSliding(facing)
    random = np.random.default_rng(9)
    x, v = 0.3 * random.normal(size=(2, model.size))
    inputs, rate = model.pack(), 0.3 * random.normal(size=model.inputs.size)
    section = random.normal(size=sliding.function.size1_in(4))
    change, axis, force = (random.normal(size=shape) for shape in ((len(section), 2), 3, 2))

    def rows(x: FloatArray, shift: FloatArray, inputs: FloatArray, rate: FloatArray) -> FloatArray:
        slide, by_v, along = sliding.function(x, inputs, v, rate, section + change @ shift, axis)
        return np.concatenate([part.full()[:, 0] for part in (slide, along, by_v @ force)])

    at = [x, np.zeros(2), inputs, rate]
    found = sliding.derivatives(x, inputs, v, rate, section, axis, change, force)
    for number, derivative in enumerate(found):

        def moved(value: FloatArray, number: int = number) -> FloatArray:
            return rows(*at[:number], value, *at[number + 1 :])

        differences = central_differences(moved, at[number], 1e-6)[: derivative.shape[0]]
        assert_allclose(derivative.full(), differences, rtol=0, atol=1e-7 * np.abs(differences).max())
    # Derivatives of the generalised force as a whole take 51 000, of which compilers make minutes.
    kinds = "SXFunction", "MXFunction"
    within = [each for each in functions_within(sliding.derivatives) if each.class_name() in kinds]
    assert sum(each.n_instructions() for each in within) < 25_000


SECOND = """
#include "moving_contacts.c"

/* Second derivative of a gap at a section by two motions of all points, without that of the points. */
double second_of_gap(const facing *own, const double *nodes, double place, int slides, const double *one,
                     const double *two) {
  const double *motions[2] = {one, two};
  double moved[2][MOVED] = {{0}};
  section_gap gap;
  fit_nodes(own, nodes, 0);
  look_at(own, place, &gap, 0);
  weigh_nodes(own, &gap);
  for (int m = 0; m < 2; m++) {
    for (int row = 0; row < MOVED; row++) {
      double weights[3 * MOST_NODES * 8] = {0};
      row_weights(own, &gap, row, weights);
      for (int i = 0; i < 3 * own->points->count; i++) moved[m][row] += weights[i] * motions[m][i];
    }
    turn_slopes(own, &gap, 1, moved[m]);
  }
  return turning(own, &gap, slides, moved[0], moved[1]);
}
"""


def test_steps_have_the_second_derivative_of_the_gap_of_two_rods() -> None:
    """Events have it too, where it is checked by differences."""
    files = ("moving_contacts.c", *contact_law.INCLUDED)
    texts = {file: resource("c", file) for file in files} | {"second_of_gap.c": SECOND}
    texts["moving_contacts.h"] = render("moving_contacts.h.in", contact_law._words())
    library = ctypes.CDLL(str(compiled_texts("second_of_gap", texts, find_compiler(), files)))
    second = library.second_of_gap
    second.restype, pointer = ctypes.c_double, ctypes.c_void_p
    second.argtypes = [pointer, pointer, ctypes.c_double, ctypes.c_int, pointer, pointer]
    model = moving(free_rods())
    (facing,) = facings(model)
    assert isinstance(facing, RodsFacing)
    random = np.random.default_rng(7)
    x, inputs = 0.05 * random.normal(size=model.size), model.pack()
    nodes = facing.nodes(x, inputs)
    place, gap, _ = section_at(facing, x, inputs, facing.deepest(nodes).place)
    motions = np.ascontiguousarray(random.normal(size=(2, *nodes.shape)))
    for slides in (True, False):
        addresses = [motion.ctypes.data for motion in motions]
        found = second(facing.in_law.address, nodes.ctypes.data, place, slides, *addresses)
        expected = facing.turning(motions.transpose(1, 2, 0), gap, slides=slides)[0, 1]
        assert_allclose(found, expected, rtol=1e-9, atol=0)


def test_friction_is_against_the_sliding_of_both_rods_and_leaves_momentum(monkeypatch: pytest.MonkeyPatch) -> None:
    """The rods differ in stiffness, by which the balances of each are divided; they bend and twist in the blow."""
    blows = []
    plain = _Told.add

    def recorded(own: _Told, stretch: ToldStretch, before: Any, end: float) -> Any:
        if any(touch.is_struck for touch in stretch.touches):
            blows.append((before.x, before.v, stretch.v))
        return plain(own, stretch, before, end)

    monkeypatch.setattr(_Told, "add", recorded)
    tables = with_friction(free_rods(duration=0.024))
    tables["rods"][1] = rod("lower", tables["rods"][1]["base"], [6e-3, 4e-3])
    tables["velocities"] = [{"rod": "upper", "linear": [0.3, 0.1, -0.5]}]
    tables["simulation"] |= {"tolerance": 1e-3, "step": 5e-4}
    model = moving(tables)
    motion = simulate(model)
    assert motion.converged, motion.message
    inputs = model.pack()
    x, before, after = blows[-1]
    assert_allclose(momentum(model, x, after), momentum(model, x, before), rtol=0, atol=1e-15)
    kinetic = [float(model.energies(x, v, inputs, 0 * inputs)[0]) for v in (before, after)]
    assert kinetic[1] < kinetic[0]
    assert_allclose(motion.events[0].energy, kinetic[0] - kinetic[1], rtol=1e-6, atol=0)
    (contact,) = motion.contacts[-1]
    assert contact.friction is not None
    assert contact.slips
    assert_allclose(np.linalg.norm(contact.friction), FRICTION * np.linalg.norm(contact.force), rtol=1e-9, atol=0)
    (facing,) = facings(model)
    assert isinstance(facing, RodsFacing)
    x, v = motion.x[-1], motion.v[-1]
    _, gap, section = section_at(facing, x, inputs, contact.at)
    axis = np.array([1.0, 0.0, 0.0])
    slide = SurfaceSliding(facing).function(x, inputs, v, 0 * inputs, section, axis)[0].full()[:, 0]
    way = slide @ tangents_of(gap, axis)
    assert_allclose(contact.friction / np.linalg.norm(contact.friction), -way / np.linalg.norm(way), rtol=0, atol=1e-9)
    whole = [momentum(model, motion.x[row], motion.v[row]) for row in (0, -1)]
    # Between blows momentum is kept as exactly as steps are.
    assert_allclose(whole[1], whole[0], rtol=0, atol=1e-4 * np.abs(whole[0]).max())


def held_rods(step: float) -> Table:
    """Two clamped rods that cross: a force presses the upper one down, and then drags it over the lower one."""
    upper = rod("upper", {"position": [0, 0, 2 * RADIUS + 1e-4], "tangent": [1, 0, 0]})
    lower = rod("lower", {"position": [0.2, -0.3, 0], "tangent": [0, 1, 0]})
    damped = [own | {"damping": {"retardation_time": 0.01}} for own in (upper, lower)]
    push = {"name": "push", "kind": "tip_wrench", "rod": "upper", "force": [0, 0, 0]}
    values = [[0, 0, 0], [0, 0, -0.1], [0, -0.15, -0.1]]
    pulled = {"input": "push.force", "times": [0.0, 0.1, 0.3], "values": values}
    tables = with_friction(scene(damped, 0.3, loads=[push], motions=[pulled]))
    # The frames are ends of steps of a hundredth.
    tables["simulation"] |= {"tolerance": 1e-3, "step": step, "frames": 31}
    return tables


def test_a_rod_that_is_dragged_over_another_one_sticks_until_friction_is_overcome() -> None:
    motion = moved(held_rods(1e-2))
    assert [event.kind for event in motion.events] == ["impact", "stick", "slip"]
    slip = motion.events[-1].time
    for time, contacts in zip(motion.times, motion.contacts, strict=True):
        for contact in contacts:
            share = np.linalg.norm(contact.friction) / np.linalg.norm(contact.force)
            assert contact.slips == (time > slip + 1e-9)
            assert abs(share - FRICTION) < 1e-4 if contact.slips else share < 0.5 * FRICTION
    assert sum(map(len, motion.contacts)) > 20
    assert motion.energy.imbalance.max() < 1e-3
    # With the curvature of the gap in the Jacobian; 408 iterations without it.
    assert motion.statistics.iterations < 340


def test_a_step_ends_where_the_place_comes_to_the_end_of_the_second_rod() -> None:
    """A rod slides along the second one off its tip; steps that go on beyond it are off by 5e-6."""
    tips = []
    for step in (1e-3, 2.5e-4):
        tables = with_friction(free_rods())
        tables["rods"][1]["base"]["position"] = [0.05, -0.374, 0.0]
        tables["velocities"] = [{"rod": "upper", "linear": [0.05, 1.0, -0.5]}]
        tables["simulation"] |= {"tolerance": 1e-3, "step": step, "frames": 31}
        motion = moved(tables)
        assert motion.events[-1].kind == "lift_off"
        tips.append(motion.tip("upper").position[-1])
    assert_allclose(tips[0], tips[1], rtol=0, atol=3e-7)


@pytest.mark.slow
def test_a_rod_that_accelerates_below_another_one_lets_it_go_as_without_friction() -> None:
    """Inputs of a step end as those of the next one begin; else the rods are inside each other as one lifts off."""
    upper = rod("upper", {"position": [-0.15, 0, 0.015], "tangent": [1, 0, 0]}) | {"strain": "planar"}
    lower = rod("lower", {"position": [0, 0, 0], "tangent": [0, 1, 0]})
    duration = 0.02
    drive = {"input": "lower.base.position", "times": [0.0, duration], "values": [[0, 0, 0], [0.006, 0, 0]]}
    weight = {"kind": "gravity", "acceleration": [0, 0, -G], "name": "weight"}
    damped = [one | {"damping": {"retardation_time": 2e-3}} for one in (upper, lower)]
    tables = scene(damped, duration, loads=[weight], motions=[drive | {"interpolation": "cubic"}])
    tables["accuracy"] = {"modes": 1}
    from_event_to_event = moved(tables)
    tables["simulation"] |= {"step": 1e-3}
    in_steps = moved(with_friction(tables, 1e-9))
    for motion in (from_event_to_event, in_steps):
        assert motion.events[-1].kind == "lift_off"
    for name in LENGTHS:
        paths = [motion.tip(name).position for motion in (from_event_to_event, in_steps)]
        assert_allclose(paths[1], paths[0], rtol=0, atol=2e-6)
    assert np.abs(in_steps.energy.imbalance).max() < 3e-4


def test_smooth_friction_tends_to_exact_friction() -> None:
    """On one discrete model, as the width falls, and the speed below which smooth contact creeps with it."""
    exact = moving(held_rods(1e-3))
    struck = simulate(exact)
    tables = held_rods(1e-3)
    del tables["simulation"]["step"]
    offs = []
    for width in (1e-3, 5e-4, 2.5e-4):
        contact = {"rods": ["upper", "lower"], "width": width, "friction": FRICTION, "slip_speed": 2 * width}
        tables["rod_contacts"] = [contact]
        smooth = simulate(build(scene_from_dict(tables).with_motion_inputs(), exact.discretisation, moving=True))
        assert smooth.converged, smooth.message
        offs.append(max(np.abs(smooth.tip(name).position - struck.tip(name).position).max() for name in LENGTHS))
    assert offs[0] > 1.7 * offs[1] > 1.7**2 * offs[2]
    assert offs[2] < 3e-3 * np.abs(struck.tip("upper").position[-1] - struck.tip("upper").position[0]).max()


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2, 3, 4, 5, 7, 11, 12, 14, 19, 20])
def test_rods_that_meet_anyhow_tell_their_error_and_gain_no_energy(seed: int) -> None:
    """They cross, lie along each other, meet with their ends; steps of a quarter are the truth."""
    tables = any_rods(seed)
    tables["simulation"]["tolerance"] = 5e-3
    tables["rod_contacts"][0]["friction"] = (0.1, 0.3, 0.8)[seed % 3]
    motion = moved(tables)
    assert motion.events
    tables["simulation"]["step"] = motion.statistics.largest_step / 4
    finer = moved(tables)
    paths = zip(*([own.tip(name).position for name in LENGTHS] for own in (motion, finer)), strict=True)
    error = max(np.abs(path - true).max() for path, true in paths) / LENGTHS["upper"]
    assert error <= motion.error_estimate
    assert motion.energy.imbalance.max() < 1e-6
