"""Friction between rods: sliding against a point mass, crossed beams on a path, action and reaction, derivatives."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from cosserat_casadi import Model, build, discretise, follow, scene_from_dict, simulate, solve
from cosserat_casadi.loads.rod_contact import PANEL, SectionPairs, SectionsInContact, friction_kernel
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.arclength import ArcSettings
from cosserat_casadi.paths.friction_path import FrictionPath

RADIUS = 5e-3
DENSITY = 1000.0
LENGTH = 0.03
FRICTION = 0.3
SLIP = 1e-3
DURATION = 0.002


@cache
def sliding(push: float = 0.0, friction: float = FRICTION, moving: bool = True) -> Model:
    """A stiff rod on a rail, along a longer one into whose layer it is pressed."""
    common = {
        "strain": "planar",
        "section": {"shape": "circle", "radius": RADIUS},
        "material": {"youngs_modulus": 1e12, "poisson_ratio": 0.3, "density": DENSITY},
    }
    lower = {"name": "lower", "length": 2 * LENGTH, "base": {"position": [0, 0, 0], "tangent": [1, 0, 0]}, **common}
    base = {"position": [LENGTH / 3, 0, 2 * RADIUS + 1e-3], "tangent": [1, 0, 0]}
    rail = {"name": "rail", "kind": "prismatic", "rod": "upper", "at": 0.0, "axis": [1, 0, 0]}
    touch = {"rods": ["lower", "upper"], "width": 2e-3, "stiffness": 1e5, "friction": friction, "slip_speed": SLIP}
    scene = scene_from_dict(
        {
            "schema": 1,
            "rods": [lower, {"name": "upper", "length": LENGTH, "base": base, **common}],
            "joints": [rail | {"stiffness": 1e-6}],
            "rod_contacts": [touch],
            "loads": [{"name": "push", "kind": "point_wrench", "rod": "upper", "at": 1.0, "force": [push, 0, 0]}],
            "simulation": {"duration": DURATION, "start": "unloaded", "tolerance": 1e-3},
        }
    )
    return build(scene, discretise(scene, 1, 4), moving=moving)


@cache
def pressing() -> float:
    """Force between the rods, N."""
    (contact,) = solve(sliding(moving=False)).contacts
    return float(np.linalg.norm(contact.force))


def slid(push: float) -> float:
    """Way of a point mass by SciPy, with the friction of the scene, m."""
    mass = DENSITY * np.pi * RADIUS**2 * LENGTH

    def rates(_: float, state: FloatArray) -> FloatArray:
        rubbing = FRICTION * pressed * state[1] / np.hypot(state[1], SLIP)
        return np.array([state[1], (push - rubbing) / mass])

    pressed = pressing()
    return float(solve_ivp(rates, (0, DURATION), [0, 0], "Radau", rtol=1e-10, atol=1e-13).y[0, -1])


@pytest.mark.slow
def test_a_rod_slides_on_a_rod_as_a_point_mass() -> None:
    """With the push less μ N over its mass; friction takes the energy of the way."""
    push = 2 * FRICTION * pressing()
    motion = simulate(sliding(push))
    assert motion.converged, motion.message
    positions = motion.tip("upper").position[:, 0]
    way = positions[-1] - positions[0]
    assert_allclose(way, slid(push), rtol=2e-3, atol=0)
    assert_allclose(motion.energy.dissipated[-1], FRICTION * pressing() * way, rtol=2e-2, atol=0)
    assert np.abs(motion.energy.imbalance).max() < 1e-3


def test_friction_between_sections_has_neither_a_sum_nor_a_moment() -> None:
    """And is opposite to the relative velocity of the points that touch: a rod that rolls on a rod has none."""
    rng = np.random.default_rng(1)
    along = (np.arange(2 * PANEL) + 0.5) / (2 * PANEL)
    data = ca.DM(np.vstack([np.full(len(along), 0.2 / len(along)), np.full(len(along), RADIUS), along]))
    none = 0 * along
    lines = [np.array([0.2 * along, none, none]), np.array([0.2 * along, 0.1 * along, none + 2 * RADIUS + 2e-4])]

    def loads(*motions: FloatArray) -> list[FloatArray]:
        first, second = [
            SectionsInContact(ca.MX(ca.DM(line)), data, ca.DM(motion))
            for line, motion in zip(lines, motions, strict=True)
        ]
        pairs = SectionPairs(first, second, ca.DM([1e-3, 1e5, -1e100, FRICTION, SLIP]))
        return [ca.evalf(load).full() for load in pairs.friction]

    first, second = loads(rng.standard_normal((6, len(along))), rng.standard_normal((6, len(along))))
    size = np.abs(first[:3]).sum()
    assert size > 1e-3
    assert_allclose(first[:3].sum(axis=1) + second[:3].sum(axis=1), 0, rtol=0, atol=1e-13 * size)
    moments = [
        np.cross(line.T, load[:3].T).sum(axis=0) + load[3:].sum(axis=1)
        for line, load in zip(lines, (first, second), strict=True)
    ]
    assert_allclose(moments[0] + moments[1], 0, rtol=0, atol=1e-13 * size)


@pytest.mark.parametrize("along_path", [False, True])
def test_a_section_does_not_rub_on_itself(along_path: bool) -> None:
    """A rod that touches itself pairs each section with itself too: no force, and no derivative that is none."""
    kernel = friction_kernel(along_path)
    section = [[0.1, 0.2, 0.3], [1e-3, RADIUS, 0.1, *np.ones(6)]]
    arguments = [*section, *section, [2e-3, 1e5, 0.05, FRICTION, SLIP]]
    assert_allclose(kernel(*arguments), 0, rtol=0, atol=0)
    for derivative in kernel.jacobian().call([*arguments, ca.DM(12, 1)]):
        assert_allclose(derivative, 0, rtol=0, atol=0)


def test_friction_turns_with_sections_that_move_together() -> None:
    """Along a path: two sections that a rotation by 2 rad moves as one body rub as they did, turned."""
    rotation = Rotation.from_rotvec([1.2, 1.6 * 0.6, -1.6 * 0.8])
    half = rotation.as_rotvec() / 2.0 * np.tan(1.0)
    drag = np.array([2e-4, -1e-4, 3e-4])
    places = np.array([[0.1, 0.2, 0.3], [0.1 + RADIUS, 0.2 + RADIUS, 0.3 + RADIUS]])
    turned = rotation.apply(places)
    law = [2e-3, 1e5, 0.0, FRICTION, SLIP]
    loads = []
    for now, turn in ((places, np.zeros(3)), (turned, half)):
        moved = now - places
        moved[0] += drag
        sections = [[place, [1e-3, RADIUS, 0.1, *way, *turn]] for place, way in zip(now, moved, strict=True)]
        loads.append(friction_kernel(True)(*sections[0], *sections[1], law).full().reshape(4, 3))
    assert np.abs(loads[0][0]).max() > 0.0
    assert_allclose(loads[1], rotation.apply(loads[0]), rtol=0, atol=1e-13 * np.abs(loads[0]).max())


def test_derivatives_are_those_of_differences() -> None:
    model = sliding()
    rng = np.random.default_rng(2)
    x = 1e-4 * rng.standard_normal(model.size)
    v = 1e-2 * rng.standard_normal(model.size)
    a = np.zeros(model.size)
    inputs = model.pack()
    still = np.zeros_like(inputs)

    def balance(x: FloatArray, v: FloatArray) -> FloatArray:
        return np.asarray(model.inverse_dynamics(x, v, a, inputs, still, still)).ravel()

    stiffness, damping, _, residual = model.dynamics_jacobian(x, v, a, inputs, still, still)
    assert_allclose(residual.full()[:, 0], balance(x, v), rtol=0, atol=1e-12)
    steps = 1e-7 * np.eye(model.size)
    by_x = np.array([(balance(x + step, v) - balance(x - step, v)) / 2e-7 for step in steps]).T
    by_v = np.array([(balance(x, v + step) - balance(x, v - step)) / 2e-7 for step in steps]).T
    assert_allclose(stiffness.full(), by_x, rtol=1e-5, atol=1e-6 * np.abs(by_x).max())
    assert_allclose(damping.full(), by_v, rtol=1e-5, atol=1e-6 * np.abs(by_v).max())
    assert np.abs(by_v).max() > 0


@pytest.mark.slow
def test_at_rest_rods_do_not_rub() -> None:
    """Statics have not one instruction more, and say so."""
    rubbing, plain = sliding(moving=False), sliding(friction=0.0, moving=False)
    assert rubbing.residual.n_instructions() == plain.residual.n_instructions()
    assert "Friction acts in motion and on paths" in solve(rubbing).message
    assert "Friction" not in solve(plain).message


BENDING, POISSON, THICK, WIDE, REACH = 2.0, 0.3, 0.02, 4e-3, 0.2
"""EI, N m², ν, radius, width, and way from either base to where two rods cross, m."""

STEPS = ArcSettings(first=0.5, load_factor_change=0.5)


@cache
def crossed() -> Model:
    """Two clamped rods at a right angle, of which the upper one can be pressed and pulled where they cross."""
    rod = {
        "length": 1.1 * REACH,
        "strain": "kirchhoff",
        "section": {"shape": "circle", "radius": THICK},
        "material": {"youngs_modulus": BENDING * 4 / np.pi / THICK**4, "poisson_ratio": POISSON},
    }
    lower = {"name": "lower", "base": {"position": [0, 0, 0], "tangent": [1, 0, 0]}, **rod}
    over = [REACH, -REACH, 2 * THICK + WIDE / 2]
    upper = {"name": "upper", "base": {"position": over, "tangent": [0, 1, 0]}, **rod}
    load = {"kind": "point_wrench", "rod": "upper", "at": 1 / 1.1, "force": [0, 0, 0]}
    touch = {"rods": ["lower", "upper"], "width": WIDE, "stiffness": 1e6, "friction": FRICTION}
    loads = [{"name": name, **load} for name in ("press", "pull")]
    scene = scene_from_dict({"schema": 1, "rods": [lower, upper], "rod_contacts": [touch], "loads": loads})
    return build(scene, discretise(scene, 3, 4))


@cache
def pulled(force: float) -> FrictionPath:
    """The path on which the upper rod, pressed by 6 N, is pulled across itself."""
    first = follow(crossed(), "press.force", [0, 0, -6], settings=STEPS)
    if not force:
        assert isinstance(first, FrictionPath)
        return first
    path = follow(crossed(), "pull.force", [force, 0, 0], first=first, settings=STEPS)
    assert isinstance(path, FrictionPath) and path.converged
    return path


def friction_on_lower(path: FrictionPath) -> float:
    """Friction along the pull at the end of a path, N."""
    _, _, friction = path.model.memory(path.x[-1], path.all_inputs[-1])
    return float(friction.full()[0].sum())


def test_crossed_rods_stick_and_slip() -> None:
    """As beams on springs: the pulled one bends and twists, the other one turns where friction bends it.

    What sticks is held by the layer: dragged by μ w/3 it slips. Deflections are of some hundredths of the length.
    """
    spring = 3 * BENDING / REACH**3
    pressed = pulled(0.0)
    before = pressed.solution(-1).pose(1 / 1.1, "upper").position[0]
    for force, slips in ((0.5, False), (4.0, True)):
        path = pulled(force)
        end = path.solution(-1)
        assert {stretch.slips for stretch in path.rubbing(-1)} == {slips}
        (contact,) = end.contacts
        limit = FRICTION * np.linalg.norm(contact.force)
        found = friction_on_lower(path)
        more = found - friction_on_lower(pressed)
        twist = THICK**2 * REACH * (2 + POISSON) / BENDING
        stuck = force / (1 + spring * (twist + FRICTION * WIDE / 3 / limit))
        assert_allclose([more, found][slips], [stuck, limit][slips], rtol=1e-2, atol=0)
        moved = end.pose(1 / 1.1, "upper").position[0] - before
        assert_allclose(moved, (force - more) / spring, rtol=2e-2, atol=0)
        # Contact gives no sum and no moment to both together.
        bases = [(end.pose(0.0, rod).position, end.base_wrench(rod)) for rod in ("lower", "upper")]
        load, at = np.array([force, 0, -6.0]), end.pose(1 / 1.1, "upper").position
        assert_allclose(sum(base.force for _, base in bases), -load, rtol=0, atol=1e-11)
        moments = [base.moment + np.cross(place, base.force) for place, base in bases]
        assert_allclose(sum(moments), -np.cross(at, load), rtol=0, atol=1e-11)


def test_what_sticks_stays_however_many_points_a_path_has() -> None:
    """Across a rod too, where pairs of sections press in directions that differ; the load hardly changes."""
    held = []
    for step in (1.0, 0.1):
        settings = ArcSettings(first=step, load_factor_change=step)
        path = follow(crossed(), "press.force", [0, 0, -6.0001], first=pulled(0.5), settings=settings)
        assert isinstance(path, FrictionPath) and path.converged
        held.append(path.model.memory(path.x[-1], path.all_inputs[-1])[2].full().sum(axis=1))
    assert np.abs(held[0][:2]).min() > 0.1
    assert_allclose(held[1], held[0], rtol=0, atol=1e-5)


@pytest.mark.slow
def test_rods_that_turn_together_rub_as_before() -> None:
    """Two rods that press each other stand on a robot, whose joint turns by most of half a turn in two steps."""
    section = {"strain": "kirchhoff", "section": {"shape": "circle", "radius": THICK}}
    moduli = {"post": 1e11, "arm": 1e11, "lower": 1.6e7, "upper": 1.6e7}
    above = [REACH, -REACH, 2 * THICK + WIDE / 2 - 0.1]
    bases = {
        "post": {"tangent": [0, 0, 1]},
        "arm": {"rod": "post", "at": 1.0, "tangent": [0, 0, 1]},
        "lower": {"rod": "post", "at": 1.0, "tangent": [1, 0, 0]},
        "upper": {"rod": "arm", "at": 1.0, "position": above, "tangent": [0, 1, 0]},
    }
    rods = [
        {
            "name": name,
            "length": 0.1 if name in ("post", "arm") else 1.1 * REACH,
            "base": bases[name],
            "material": {"youngs_modulus": modulus, "poisson_ratio": POISSON},
            **section,
        }
        for name, modulus in moduli.items()
    ]
    press = {"kind": "point_wrench", "name": "press", "rod": "upper", "at": 1 / 1.1, "frame": "body"}
    touch = {"rods": ["lower", "upper"], "width": WIDE, "stiffness": 1e6, "friction": FRICTION}
    joint = {"kind": "revolute", "name": "turn", "rod": "post", "at": 0, "axis": [0.48, 0.6, 0.64], "angle": 0.0}
    loads = [{**press, "force": [0, 0, 0]}]
    scene = scene_from_dict({"schema": 1, "rods": rods, "rod_contacts": [touch], "joints": [joint], "loads": loads})
    model = build(scene, discretise(scene, 2, 3))
    upright = solve(model).pose(0, "upper").rotation
    first = follow(model, "press.force", upright.T @ [0.5, 0.3, -6.0], settings=STEPS)
    frictions = []
    for angle in (1e-9, 0.9 * np.pi):
        path = follow(model, "turn.angle", angle, first=first, settings=replace(STEPS, longest=np.inf))
        assert isinstance(path, FrictionPath) and len(path.factor) == 3
        friction = path.model.memory(path.x[-1], path.all_inputs[-1])[2].full().sum(axis=1)
        frictions.append(path.solution(-1).pose(0, "upper").rotation.T @ friction)
    assert np.linalg.norm(frictions[0]) > 0.1
    assert_allclose(frictions[1], frictions[0], rtol=0, atol=1e-7)


@pytest.mark.parametrize("force", [0.5, 4.0])
def test_derivatives_along_a_path_are_those_of_differences(force: float) -> None:
    """Where sections stick, and where they slip."""
    path = pulled(force)
    x, inputs = path.x[-1], path.all_inputs[-1]
    change = np.random.default_rng(0).normal(size=x.size) * 1e-7
    ends = [path.model.residual(x + sign * change, inputs).full()[:, 0] for sign in (1.0, -1.0)]
    slope = path.model.path_jacobian(x, inputs, 1.0).full() @ change
    assert_allclose(slope, (ends[0] - ends[1]) / 2, rtol=0, atol=1e-5 * np.abs(slope).max())


TURN, PITCH, SECTION, TOUCHING = 0.1, 0.055, 0.02, 8e-3
"""Radius and pitch of a coil, radius of its rod, and width of its contact with itself, m."""


@cache
def coil() -> Model:
    """A rod of rather more than one turn, whose tip can be pressed on its first part and pulled over it."""
    rise = PITCH / (2 * np.pi)
    square = TURN**2 + rise**2
    rod = {
        "name": "coil",
        "length": 1.15 * 2 * np.pi * np.sqrt(square),
        "strain": "kirchhoff",
        "section": {"shape": "circle", "radius": SECTION},
        "material": {"youngs_modulus": BENDING * 4 / np.pi / SECTION**4, "poisson_ratio": POISSON},
        "intrinsic": {"curvature": [0.0, TURN / square, rise / square]},
        "base": {"position": [0, 0, 0], "tangent": [1, 0, 0]},
    }
    load = {"kind": "point_wrench", "rod": "coil", "at": 1.0, "force": [0, 0, 0]}
    touch = {"rods": ["coil"], "width": TOUCHING, "stiffness": 1e6, "friction": FRICTION}
    loads = [{"name": name, **load} for name in ("press", "pull")]
    scene = scene_from_dict({"schema": 1, "rods": [rod], "rod_contacts": [touch], "loads": loads})
    return build(scene, discretise(scene, 3, 5))


@pytest.mark.parametrize(("dragged", "slipping"), [(1e-3, False), (5e-2, True)])
def test_derivatives_of_a_rod_that_rubs_on_itself_are_those_of_differences(dragged: float, slipping: bool) -> None:
    """Where sections stick and slip, dragged from another shape."""
    pressed = solve(coil(), {"press.force": [0, -8, 0]}, estimate_error=False)
    model = coil().with_memory
    inputs = model.pack({"press.force": [0, -8, 0]})
    shift, change = np.random.default_rng(3).normal(size=(2, model.size))
    history, _, _ = model.memory(pressed.x + dragged * shift, inputs)
    inputs[model.inputs.memory] = history.full().ravel(order="F")
    _, slips, _ = model.memory(pressed.x, inputs)
    assert slips.full().max() > 0.0
    assert (slips.full().max() > 1.0) == slipping
    steps = 1e-7 * np.array([change, -change])
    ends = [model.residual(pressed.x + step, inputs).full()[:, 0] for step in steps]
    slope = model.path_jacobian(pressed.x, inputs, 1.0).full() @ steps[0]
    assert_allclose(slope, (ends[0] - ends[1]) / 2, rtol=0, atol=1e-5 * np.abs(slope).max())


@pytest.mark.slow
def test_a_rod_rubs_on_itself() -> None:
    """As a block under Coulomb's law: force and moment of the base are those of the loads alone, and energy leaves."""
    press = follow(coil(), "press.force", [0, -8, 0], settings=STEPS)
    paths = [press]
    for force in (2.0, -2.0, 2.0):
        paths.append(follow(coil(), "pull.force", [force, 0, 0], first=paths[-1], settings=STEPS))
    work = 0.0
    for path in paths[1:]:
        assert isinstance(path, FrictionPath) and path.converged
        end = path.solution(-1)
        load = path.all_inputs[-1][path.model.inputs.slices["pull.force"]] + [0, -8, 0]
        base = end.base_wrench("coil")
        assert_allclose(base.force, -load, rtol=0, atol=1e-11)
        assert_allclose(base.moment, -np.cross(end.tip().position, load), rtol=0, atol=1e-11)
        friction = path.model.memory(path.x[-1], path.all_inputs[-1])[2].full()
        assert_allclose(friction.sum(axis=1), 0, rtol=0, atol=1e-12)
        on_tip = friction[:, friction.shape[1] // 2 :].sum(axis=1)
        (contact,) = end.contacts
        limit = FRICTION * np.linalg.norm(contact.force)
        assert np.linalg.norm(on_tip) <= limit
        assert on_tip[0] * load[0] < 0.0
        if all(stretch.slips for stretch in path.rubbing(-1)):
            assert_allclose(np.linalg.norm(on_tip), limit, rtol=2e-2, atol=0)
        pulls = path.all_inputs[:, path.model.inputs.slices["pull.force"]]
        tips = path.position(1.0)
        if path is not paths[1]:
            work += float(np.sum((pulls[1:] + pulls[:-1]) / 2 * np.diff(tips, axis=0)))
    assert {stretch.slips for stretch in paths[1].rubbing(-1)} == {True}
    assert work > 0.0
