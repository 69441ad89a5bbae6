"""Rods that touch rods without a width, in motion: blows, contacts that last, and what is refused."""

from __future__ import annotations

from itertools import pairwise
from typing import Any, ClassVar

import numpy as np
import pytest
from numpy.polynomial import Polynomial, legendre
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from cosserat_casadi import SceneError, build, simulate, solve
from cosserat_casadi.codegen.export import export
from cosserat_casadi.errors import ExportError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.collocated_stage import motion_stage
from cosserat_casadi.motion.contact_forces import Follower, MovingContact
from cosserat_casadi.motion.contact_gap import SectionGap
from cosserat_casadi.motion.exact_contact import ExactContacts
from cosserat_casadi.motion.facings import facings
from cosserat_casadi.motion.momentum import MomentumKeeper
from cosserat_casadi.motion.pose_series import section_poses
from cosserat_casadi.motion.rods_facing import RodGap, RodsFacing
from cosserat_casadi.motion.trajectory import Motion
from cosserat_casadi.scene import scene_from_dict

DENSITY = 1100.0
RADIUS = 5e-3
LENGTHS = {"upper": 0.3, "lower": 0.4}
MODULI = {"upper": 2e7, "lower": 4e7}

Table = dict[str, Any]


def rod(name: str, base: Table, radius: float | list[float] = RADIUS) -> Table:
    material = {"youngs_modulus": MODULI[name], "poisson_ratio": 0.45, "density": DENSITY}
    section = {"shape": "circle", "radius": radius}
    shared = {"name": name, "length": LENGTHS[name], "strain": "kirchhoff", "material": material}
    return shared | {"section": section, "base": base}


def scene(rods: list[Table], duration: float, share: float = 0.0, **more: Any) -> Table:
    contact = {"rods": ["upper", "lower"], "exact": True, "restitution": share}
    simulation = {"duration": duration, "frames": 26, "tolerance": 1e-5}
    own = {"schema": 1, "accuracy": {"modes": 2}, "simulation": simulation, "rods": rods, "rod_contacts": [contact]}
    return own | more


def free_rods(share: float = 0.0, duration: float = 0.03, **more: Any) -> Table:
    """A rod that falls with 0.5 m/s on another one, which it crosses at right angles; both fly free."""
    upper = rod("upper", {"free": True, "position": [-0.15, 0, 0.02], "tangent": [1, 0, 0]})
    lower = rod("lower", {"free": True, "position": [0.05, -0.2, 0], "tangent": [0, 1, 0]})
    falls = [{"rod": "upper", "linear": [0, 0, -0.5]}]
    return scene([upper, lower], duration, share, velocities=falls, **more)


def moving(tables: Table) -> Model:
    return build(scene_from_dict(tables).with_motion_inputs(), moving=True)


def gap_at(facing: RodsFacing, x: FloatArray, inputs: FloatArray, touch: MovingContact) -> SectionGap:
    _, (gap,) = Follower([facing], (touch,)).gaps(x, inputs)
    return gap


@pytest.mark.parametrize("ends", [False, True], ids=["along both rods", "end of the other rod"])
@pytest.mark.parametrize("slides", [False, True], ids=["given place", "place that slides"])
def test_derivatives_of_the_gap(slides: bool, ends: bool) -> None:
    tables = free_rods()
    tables["rods"][0]["section"]["radius"] = [3e-3, 6e-3]
    tables["rods"][1]["section"]["radius"] = [6e-3, 3e-3]
    if ends:
        tables["rods"][1]["base"]["position"] = [0.05, 0.02, -0.02]
    model = moving(tables)
    (facing,) = facings(model)
    assert isinstance(facing, RodsFacing)
    random = np.random.default_rng(3)
    x, direction = 0.05 * random.normal(size=model.size), random.normal(size=model.size)
    inputs = model.pack()
    nodes = facing.nodes(x, inputs)
    touch = MovingContact(0, facing.deepest(nodes).place + (0.0 if slides else 0.05), slides)
    gap = gap_at(facing, x, inputs, touch)
    assert isinstance(gap, RodGap)
    assert gap.other_slides is not ends
    values = [gap_at(facing, x + h * direction, inputs, touch).value for h in (-1e-4, 0.0, 1e-4)]
    slope = facing.gradient(x, inputs, gap) @ direction
    by_nodes = facing.points.jacobian(x, inputs)
    second = facing.turning(by_nodes, gap, slides=slides) + facing.points.hessian(x, inputs, facing.weights(gap))
    assert_allclose((values[2] - values[0]) / 2e-4, slope, rtol=1e-5, atol=1e-6)
    assert_allclose((values[2] - 2 * values[1] + values[0]) / 1e-8, direction @ second @ direction, rtol=1e-4, atol=0)
    still = np.zeros_like(inputs)
    rates = facing.rates(x, direction, (inputs, still, still), gap, slides=slides)
    assert_allclose(rates, (slope, direction @ second @ direction), rtol=1e-9, atol=0)


def test_unknowns_gone_astray_leave_no_number_and_raise_nothing() -> None:
    """Newton's method may try anything; its step is not taken then."""
    model = moving(free_rods())
    (facing,) = facings(model)
    x, inputs = np.full(model.size, 1e60), model.pack()
    touch = MovingContact(0, 0.67, True)
    _, (gap,) = Follower([facing], (touch,)).gaps(x, inputs)
    assert not np.isfinite(facing.turning(facing.points.jacobian(x, inputs), gap, slides=True)).all()


def test_the_gap_is_the_least_distance_of_both_rods() -> None:
    model = moving(free_rods())
    (facing,) = facings(model)
    x = 0.05 * np.random.default_rng(5).normal(size=model.size)
    nodes = facing.nodes(x, model.pack())
    found = facing.deepest(nodes)
    X = np.linspace(0.0, 1.0, 501)
    lines = [section_poses(model, name, X, x[None], model.pack()[None]).position[0] for name in LENGTHS]
    apart = np.linalg.norm(lines[0][:, None] - lines[1][None], axis=2)
    assert_allclose(found.gap, (apart.min() - 2 * RADIUS) / LENGTHS["upper"], rtol=0, atol=2e-5)


def answer_to_a_blow(name: str, X: float) -> float:
    """Speed of a section across a free rod that a unit impulse there makes, 1/kg: two modes bend it as cubics."""
    mass = DENSITY * np.pi * RADIUS**2 * LENGTHS[name]
    values = [legendre.legval(2 * X - 1, [0] * degree + [1]) for degree in range(4)]
    return sum((2 * degree + 1) * value**2 for degree, value in enumerate(values)) / mass


def momentum(model: Model, x: FloatArray, v: FloatArray) -> FloatArray:
    """Momentum and angular momentum about the origin, shape (6,)."""
    inputs = model.pack()
    return np.concatenate([part.full()[:, 0] for part in model.momentum(x, v, inputs, 0 * inputs)])


@pytest.mark.parametrize("share", [0.0, 0.6])
def test_a_blow_of_two_rods(share: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its impulse and energy are those of the closed form, and it leaves the momentum of both as it was.

    The rods differ in stiffness, by which the balances of each are divided.
    """
    blows = []
    plain = ExactContacts.restarted

    def recorded(own: ExactContacts, *arguments: Any, **options: Any) -> Any:
        restart = plain(own, *arguments, **options)
        before = arguments[2]
        blows.append((before, restart.start.instant))
        return restart

    monkeypatch.setattr(ExactContacts, "restarted", recorded)
    model = moving(free_rods(share, duration=0.0205))
    motion = simulate(model)
    assert motion.converged, motion.message
    first = motion.events[0]
    assert (first.kind, first.owner, first.obstacle) == ("impact", "upper", "lower")
    compliance = answer_to_a_blow("upper", 2 / 3) + answer_to_a_blow("lower", 0.5)
    # The rods have rotary inertia, which the closed form leaves out.
    assert_allclose(first.impulse, (1 + share) * 0.5 / compliance, rtol=5e-3, atol=0)
    assert_allclose(first.energy, (1 - share) / 2 * first.impulse * 0.5, rtol=1e-9, atol=0)
    assert_allclose(first.place, 2 / 3, rtol=0, atol=1e-9)
    size = model.size
    changes = [momentum(model, a.x[:size], b.v[:size]) - momentum(model, a.x[:size], a.v[:size]) for a, b in blows]
    assert any(np.any(b.v[:size] != a.v[:size]) for a, b in blows)
    assert_allclose(changes, 0.0, rtol=0, atol=1e-15)


def test_forces_on_both_rods_are_opposite_and_on_one_line() -> None:
    """Forces of a contact do no work as all rods move and turn alike, whatever the rods' stiffness."""
    model = moving(free_rods())
    (facing,) = facings(model)
    assert isinstance(facing, RodsFacing)
    x = 0.05 * np.random.default_rng(7).normal(size=model.size)
    inputs = model.pack()
    touch = MovingContact(0, facing.deepest(facing.nodes(x, inputs)).place, True)
    gradient = facing.gradient(x, inputs, gap_at(facing, x, inputs, touch))
    assert_allclose(gradient @ MomentumKeeper(model).rigid_motions(x), 0.0, rtol=0, atol=1e-12)
    # The balances of each rod are in units of its own energy.
    units = model.discrete.unknowns.units
    assert_allclose(facing.points.in_balances(gradient) * units, gradient * facing.energy_unit, rtol=1e-12, atol=0)


class HeldBeams:
    """Two clamped beams in small bending that touch where they cross, from event to event: an independent model.

    Curvatures are polynomials, as many as the rods have.
    """

    TIMES = (0.0, 0.05, 0.2, 0.25)
    FORCES = (0.0, -4e-3, -4e-3, 2e-3)
    PLACES: ClassVar[dict[str, float]] = {"upper": 2 / 3, "lower": 0.75}
    GAP = 2e-4
    MODES = 2

    def __init__(self, share: float) -> None:
        self.share = share
        beams = [self.beam(name) for name in LENGTHS]
        none = np.zeros((self.MODES, self.MODES))
        self.inverse = np.linalg.inv(np.block([[beams[0][0], none], [none, beams[1][0]]]))
        self.stiffness = np.block([[beams[0][1], none], [none, beams[1][1]]])
        self.opens = np.concatenate([beams[0][2], -beams[1][2]])
        self.tips = [np.append(beams[0][3], np.zeros(self.MODES)), np.append(np.zeros(self.MODES), beams[1][3])]
        self.events: list[tuple[str, float]] = []

    def beam(self, name: str) -> tuple[FloatArray, ...]:
        """Mass, stiffness, and deflections of the crossing and the tip."""
        length = LENGTHS[name]
        x, weights = (np.polynomial.legendre.leggauss(12)[0] + 1) / 2, np.polynomial.legendre.leggauss(12)[1] / 2
        bends = [Polynomial(legendre.leg2poly([0] * k + [1]))(Polynomial([-1, 2])) for k in range(self.MODES)]
        slopes = [bend.integ(lbnd=0) for bend in bends]
        lines = [slope.integ(lbnd=0) for slope in slopes]
        line, slope, bend = (np.array([one(x) for one in some]) for some in (lines, slopes, bends))
        area, second = np.pi * RADIUS**2, np.pi * RADIUS**4 / 4
        mass = DENSITY * length * (length**4 * area * (line * weights) @ line.T)
        mass += DENSITY * length * (length**2 * second * (slope * weights) @ slope.T)
        stiffness = MODULI[name] * second * length * (bend * weights) @ bend.T
        ends = [length**2 * np.array([one(X) for one in lines]) for X in (self.PLACES[name], 1.0)]
        return mass, stiffness, *ends

    def acceleration(self, t: float, q: FloatArray) -> FloatArray:
        force = np.interp(t, self.TIMES, self.FORCES)
        return self.inverse @ (self.tips[0] * force - self.stiffness @ q)

    def push(self, t: float, q: FloatArray) -> float:
        return float(-self.opens @ self.acceleration(t, q) / (self.opens @ self.inverse @ self.opens))

    def tip_paths(self, times: FloatArray) -> FloatArray:
        """Deflections of both tips at these times, shape (2, T), m."""
        size = 2 * self.MODES
        state, touches = np.zeros(2 * size), False
        found = np.zeros((2, len(times)))
        for begin, end in pairwise([*(time for time in self.TIMES if time < times[-1]), times[-1]]):
            t = begin
            while t < end:

                def rate(t: float, y: FloatArray, touches: bool = touches) -> FloatArray:
                    push = self.push(t, y[:size]) if touches else 0.0
                    return np.append(y[size:], self.acceleration(t, y[:size]) + self.inverse @ self.opens * push)

                def guard(t: float, y: FloatArray, touches: bool = touches) -> float:
                    return self.push(t, y[:size]) if touches else float(self.opens @ y[:size]) + self.GAP

                guard.terminal, guard.direction = True, -1.0  # type: ignore[attr-defined]
                part = solve_ivp(
                    rate, (t, end), state, "DOP853", rtol=1e-10, atol=1e-14, events=guard, dense_output=True
                )
                within = (times >= t) & (times <= part.t[-1])
                for row in np.flatnonzero(within):
                    found[:, row] = [tip @ part.sol(times[row])[:size] for tip in self.tips]
                t, state = part.t[-1], part.y[:, -1].copy()
                if part.status != 1:
                    break
                self.events.append(("lift_off" if touches else "impact", t))
                if not touches:
                    speed = self.opens @ state[size:]
                    impulse = -(1 + self.share) * speed / (self.opens @ self.inverse @ self.opens)
                    state[size:] += self.inverse @ self.opens * impulse
                touches = not touches and self.share == 0.0
        return found


def held_rods(share: float, duration: float) -> Motion:
    """Two clamped rods that cross: a force draws the upper one down on the lower one, and lifts it off."""
    beams = HeldBeams
    upper = rod("upper", {"position": [0, 0, 2 * RADIUS + beams.GAP], "tangent": [1, 0, 0]})
    lower = rod("lower", {"position": [0.2, -0.3, 0], "tangent": [0, 1, 0]})
    push = {"name": "push", "kind": "tip_wrench", "rod": "upper", "force": [0, 0, 0]}
    values = [[0, 0, force] for force in beams.FORCES]
    pulled = {"input": "push.force", "times": list(beams.TIMES), "values": values}
    motion = simulate(moving(scene([upper, lower], duration, share, loads=[push], motions=[pulled])))
    assert motion.converged, motion.message
    return motion


@pytest.mark.parametrize(("share", "duration"), [(0.0, 0.25), (0.6, 0.12)])
def test_rods_strike_touch_and_lift_off_as_beams_do(share: float, duration: float) -> None:
    motion = held_rods(share, duration)
    beams = HeldBeams(share)
    expected = beams.tip_paths(motion.times)
    assert [event.kind for event in motion.events] == [kind for kind, _ in beams.events]
    assert len(motion.events) == 4
    assert_allclose([event.time for event in motion.events], [time for _, time in beams.events], rtol=1e-3, atol=0)
    largest = np.abs(expected).max()
    for name, path in zip(LENGTHS, expected, strict=True):
        moved = motion.tip(name).position[:, 2] - motion.tip(name).position[0, 2]
        # The rods turn by a hundredth.
        assert_allclose(moved, path, rtol=0, atol=3e-3 * largest)
    touching = [contact for contacts in motion.contacts for contact in contacts]
    assert all(contact.force[2] > 0.0 for contact in touching)
    assert (len(touching) > 0) is (share == 0.0)
    for contact in touching:
        assert contact.at_other is not None
        assert_allclose((contact.at, contact.at_other), (2 / 3, 0.75), rtol=0, atol=1e-3)
    assert np.abs(motion.energy.imbalance).max() < 1e-4


@pytest.mark.slow
def test_smooth_contact_tends_to_elastic_blows() -> None:
    """On one discrete model: with a stiffness that keeps the rods within the layer, it gives all energy back."""
    exact = moving(free_rods(share=1.0, duration=0.05))
    tables = free_rods(duration=0.05)
    struck = simulate(exact)
    offs = []
    for width in (2e-3, 1e-3, 5e-4):
        tables["rod_contacts"] = [{"rods": ["upper", "lower"], "width": width, "stiffness": 2e6 * (2e-3 / width) ** 2}]
        smooth = simulate(build(scene_from_dict(tables).with_motion_inputs(), exact.discretisation, moving=True))
        assert smooth.converged, smooth.message
        offs.append(max(np.abs(smooth.tip(name).position - struck.tip(name).position).max() for name in LENGTHS))
    assert offs[0] > 1.2 * offs[1] > 1.2**2 * offs[2]
    assert offs[2] < 1e-3


def any_rods(seed: int) -> Table:
    """Free rods that cross, lie along each other or meet with their ends, stiff or soft, with and without rebound."""
    random = np.random.default_rng(seed)
    tables = free_rods(float(random.choice([0.0, 0.5, 1.0])), duration=0.12)
    tables["simulation"]["tolerance"] = 1e-3
    for own, height in zip(tables["rods"], (0.06, 0.0), strict=True):
        tangent = random.normal(size=3) * (1.0, 1.0 if seed % 3 else 0.02, 0.2)
        tangent /= np.linalg.norm(tangent)
        middle = np.array([*random.uniform(-0.05, 0.05, 2), height])
        own["base"] = {"free": True, "tangent": tangent.tolist()}
        own["base"]["position"] = (middle - own["length"] * random.uniform(0.1, 0.9) * tangent).tolist()
        own["material"]["youngs_modulus"] = 10 ** random.uniform(6.5, 9)
    velocity = (0.1 * random.normal(size=3) - (0, 0, 1)).tolist()
    tables["velocities"] = [{"rod": "upper", "linear": velocity, "angular": (3 * random.normal(size=3)).tolist()}]
    return tables


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(12))
def test_rods_that_meet_anyhow_keep_apart_and_gain_no_energy(seed: int) -> None:
    tables = any_rods(seed)
    model = moving(tables)
    motion = simulate(model)
    if not motion.converged:
        assert motion.outcome.label == "unresolved"
        return
    X = np.linspace(0.0, 1.0, 401)
    for upper, lower in zip(*(motion.section(name, X).position for name in LENGTHS), strict=True):
        gap = np.linalg.norm(upper[:, None] - lower[None], axis=2).min() - 2 * RADIUS
        assert gap > -1e-3 * LENGTHS["upper"]
    assert motion.energy.imbalance.max() < 1e-3
    first, last = (momentum(model, motion.x[row], motion.v[row])[:3] for row in (0, -1))
    assert_allclose(last, first, rtol=0, atol=1e-3 * np.abs(first).max())


def test_rods_that_are_inside_each_other_are_no_start() -> None:
    tables = free_rods()
    tables["rods"][0]["base"]["position"][2] = 1.5 * RADIUS
    inside = simulate(moving(tables))
    assert not inside.converged
    assert "inside each other" in inside.message


def test_a_motion_from_the_equilibrium_of_rods_that_press_each_other_stays_there() -> None:
    tables = scene([rod("upper", {"position": [0, 0, 0.011], "tangent": [1, 0, 0]})], 0.1)
    tables["rods"].append(rod("lower", {"position": [0.2, -0.3, 0], "tangent": [0, 1, 0]}))
    push = {"name": "push", "kind": "tip_wrench", "rod": "upper", "force": [0, 0, -0.02]}
    tables |= {"loads": [push], "accuracy": {"modes": 4}}
    pressed = simulate(moving(tables))
    assert pressed.converged, pressed.message
    first, last = (pressed.tip("upper").position[row] for row in (0, -1))
    assert_allclose(last, first, rtol=0, atol=1e-8 * LENGTHS["upper"])
    rest = solve(build(scene_from_dict(tables)))
    assert_allclose(first, rest.pose(1.0, "upper").position, rtol=0, atol=1e-4 * LENGTHS["upper"])
    ((touch,), (contact,)) = pressed.contacts[0], rest.contacts
    assert_allclose(touch.force, contact.force, rtol=0, atol=0.02 * contact.ends[0])


def faults(change: dict[str, Any], of_scene: dict[str, Any] | None = None) -> str:
    tables = free_rods(**(of_scene or {}))
    tables["rod_contacts"][0] |= change
    with pytest.raises(SceneError) as refused:
        scene_from_dict(tables)
    return str(refused.value)


def test_what_exact_contact_of_rods_refuses() -> None:
    plane = {"name": "floor", "kind": "plane", "point": [0, 0, -1], "normal": [0, 0, 1]}
    assert "describes a smooth contact" in faults({"width": 1e-3})
    assert "describes a smooth contact" in faults({"friction": 0.3, "slip_speed": 1e-3})
    assert "two rods, not one rod with itself" in faults({"rods": ["upper"]})
    assert "describes impacts" in faults({"exact": False})
    assert "has a width" in faults({}, {"obstacles": [plane | {"width": 1e-3}]})
    tables = free_rods()
    with pytest.raises(SceneError, match="'upper' is free: at rest only contact could hold it"):
        solve(scene_from_dict(tables))
    model = moving(tables)
    with pytest.raises(ExportError, match="'upper' is free: at rest only contact could hold it"):
        export(model, "nowhere")
    chained = free_rods()
    chained["rods"].append(rod("lower", {"rod": "lower", "at": 1.0}) | {"name": "behind"})
    with pytest.raises(SceneError, match="only if their ends meet no end of another rod"):
        simulate(moving(chained))
    with pytest.raises(SceneError, match="only if their ends meet no end of another rod"):
        motion_stage(moving(chained), 0.1)
