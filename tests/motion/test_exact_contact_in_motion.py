"""Exact contact in motion: impacts, contacts that last and slide, lift-off, rest; against references of other kinds."""

from __future__ import annotations

import json
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.polynomial import legendre
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from cosserat_casadi import Scene, build, discretise, parse_scene, read_scene, simulate, solve
from cosserat_casadi.accuracy.refine import FINER_MODES
from cosserat_casadi.errors import SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.motion import motion_start as starts
from cosserat_casadi.motion.contact_forces import Follower, MovingContact
from cosserat_casadi.motion.exact_contact import ExactContacts
from cosserat_casadi.motion.facings import facings
from cosserat_casadi.motion.motion_start import given_start
from cosserat_casadi.motion.trajectory import Motion, MotionOutcome
from tests.moving_scenes import gaps_along

ROD = """
schema = 1
accuracy = {{ modes = {modes}, nodes = 12, tolerance = 1e-4 }}
loads = [{{ name = "weight", kind = "gravity", acceleration = [0, 0, -9.81] }}]
obstacles = [{{ name = "bar", {obstacle} }}]
simulation = {{ duration = {duration}, start = "unloaded", frames = 41 }}
[[rods]]
name = "rod"
length = 0.4
strain = "planar"
stiffness = {{ bending_y = {stiffness} }}
linear_density = 0.2
rotary_inertia = [1e-7, 1e-7, 2e-7]
base = {{ position = [0, 0, 0], tangent = [1, 0, 0] }}
damping = {{ retardation_time = {damping} }}
"""

BALL = 'kind = "sphere", centre = [0.25, 0, -0.09], radius = 0.03'
FLOOR = 'kind = "plane", point = [0, 0, {height}], normal = [0, 0, 1]'


def rod(obstacle: str, modes: int = 3, duration: float = 0.5, stiffness: float = 0.016, damping: float = 0.005) -> str:
    return ROD.format(obstacle=obstacle, modes=modes, duration=duration, stiffness=stiffness, damping=damping)


def moving(text: str) -> Model:
    return build(parse_scene(text).with_motion_inputs(), moving=True)


@pytest.fixture(scope="module")
def on_ball() -> Motion:
    return simulate(moving(rod(BALL, duration=1.0, damping=0.03)))


@pytest.mark.parametrize("slides", [True, False])
def test_derivatives_of_the_least_gap_are_those_of_differences(slides: bool) -> None:
    model = moving(rod(BALL))
    (facing,) = facings(model)
    rng = np.random.default_rng(3)
    x = np.array([0.6, 0.3, -0.1])
    v = rng.normal(size=3)
    still = [np.zeros(model.inputs.size)] * 2
    inputs = model.pack()
    follower = Follower([facing], (MovingContact(0, 0.6 if slides else 1.0, slides),))

    def gap(at: FloatArray) -> float:
        return follower.gaps(at, inputs)[1][0].value

    (here,) = follower.gaps(x, inputs)[1]
    gradient = facing.gradient(x, inputs, here)
    turning = facing.turning(facing.points.jacobian(x, inputs), here, slides=slides)
    hessian = facing.points.hessian(x, inputs, facing.weights(here)) + turning
    step = 1e-4
    for direction in (v, *np.eye(3)):
        ahead, behind = gap(x + step * direction), gap(x - step * direction)
        assert_allclose(gradient @ direction, (ahead - behind) / (2 * step), rtol=1e-6, atol=1e-7)
        bend = (ahead - 2 * here.value + behind) / step**2
        assert_allclose(direction @ hessian @ direction, bend, rtol=1e-4, atol=1e-6)
    (rate,), (turning,) = follower.rates(x, v, [inputs, *still])
    assert_allclose(rate, gradient @ v, rtol=1e-12, atol=1e-14)
    assert_allclose(turning, v @ hessian @ v, rtol=1e-10, atol=1e-12)


def beam_on_a_stop(depth: float, stiffness: float, times: FloatArray) -> tuple[FloatArray, list[float], float]:
    """Linear beam of three Legendre modes of its curvature that falls on a stop under its tip: solve_ivp with events.

    Returns:
        deflections of the tip, times of the impacts, and the energy that they take.
    """
    length, density, damping, modes = 0.4, 0.2, 1e-4, 3
    nodes, weights = legendre.leggauss(20)
    mass = np.zeros((modes, modes))
    load = np.zeros(modes)
    elastic = np.diag([stiffness * length / (2 * k + 1) for k in range(modes)])
    deflections = []
    for k in range(modes):
        # κ = P_k(2X − 1), the slope and the deflection are its integrals from the clamp.
        twice = legendre.legint(np.eye(modes)[k], 2, lbnd=-1) * (length / 2) ** 2
        deflections.append(twice)
    values = np.array([legendre.legval(nodes, one) for one in deflections])
    slopes = np.array(
        [legendre.legval(nodes, legendre.legint(np.eye(modes)[k], 1, lbnd=-1)) * length / 2 for k in range(modes)]
    )
    mass = length / 2 * (density * (values * weights) @ values.T + 1e-7 * (slopes * weights) @ slopes.T)
    load = length / 2 * density * -9.81 * values @ weights
    tip = np.array([legendre.legval(1.0, one) for one in deflections])
    inverse = np.linalg.inv(mass)
    compliance = tip @ inverse @ tip

    def free(y: FloatArray) -> FloatArray:
        return inverse @ (load - elastic @ (y[:modes] + damping * y[modes:]))

    def push(y: FloatArray) -> float:
        return float(-(tip @ free(y)) / compliance)

    y = np.zeros(2 * modes)
    time, pressed, lost = 0.0, False, 0.0
    impacts: list[float] = []
    found = np.zeros(len(times))
    while time < times[-1]:

        def rates(_: float, y: FloatArray, pressed: bool = pressed) -> FloatArray:
            acceleration = free(y) + (inverse @ tip * push(y) if pressed else 0.0)
            return np.concatenate([y[modes:], acceleration])

        def event(t: float, y: FloatArray, pressed: bool = pressed, began: float = time) -> float:
            if t < began + 1e-9:
                return 1.0
            return push(y) if pressed else float(tip @ y[:modes]) + depth

        event.terminal = True  # type: ignore[attr-defined]
        event.direction = -1  # type: ignore[attr-defined]
        run = solve_ivp(rates, (time, times[-1]), y, "DOP853", events=event, dense_output=True, rtol=1e-10, atol=1e-13)
        asked = (times >= time) & (times <= run.t[-1])
        if asked.any():
            found[asked] = tip @ run.sol(times[asked])[:modes]
        y, time = run.y[:, -1].copy(), float(run.t[-1])
        if run.status == 1 and not pressed:
            speed = tip @ y[modes:]
            y[modes:] -= inverse @ tip * speed / compliance
            lost += 0.5 * speed**2 / compliance
            impacts.append(time)
        if run.status == 1:
            pressed = not pressed
    return found, impacts, lost


@pytest.mark.slow
def test_a_beam_falls_on_a_stop_as_a_linear_beam_does() -> None:
    depth, stiffness = 4e-4, 20.0
    text = rod(FLOOR.format(height=-depth), duration=0.08, stiffness=stiffness, damping=1e-4)
    # The tolerance is relative to the length, of which the deflections are a thousandth.
    motion = simulate(moving(text.replace("frames = 41", "frames = 41, tolerance = 2e-7")))
    assert motion.converged, motion.message
    deflections, impacts, lost = beam_on_a_stop(depth, stiffness, motion.times)
    assert len(impacts) >= 1
    found = [event for event in motion.events if event.kind == "impact"]
    assert all(event.place == 1.0 for event in found)
    # A beam that is not linear differs by the square of its slopes, about 2e-6 of a deflection.
    assert_allclose([event.time for event in found], impacts, rtol=0, atol=2e-5)
    assert_allclose(sum(event.energy for event in found), lost, rtol=1e-3, atol=0)
    assert_allclose(motion.tip().position[:, 2], deflections, rtol=0, atol=2e-3 * depth)
    assert motion.tip().position[:, 2].min() > -depth - 1e-6
    assert_allclose(motion.energy.impacts[-1], lost, rtol=1e-3, atol=0)
    assert abs(motion.energy.imbalance).max() < 1e-3


@pytest.mark.slow
def test_energy_of_an_impact_is_what_the_kinetic_energy_falls_by(on_ball: Motion) -> None:
    impact = next(event for event in on_ball.events if event.kind == "impact")
    kinetic = []
    for time in (impact.time, impact.time + 1e-9):
        state = on_ball.at(time)
        kinetic.append(float(on_ball.model.energies(state.x, state.v, state.inputs, 0 * state.inputs)[0]))
    assert impact.energy > 0.05 * kinetic[0]
    assert_allclose(kinetic[0] - kinetic[1], impact.energy, rtol=1e-5, atol=0)


def test_a_damped_rod_comes_to_rest_on_a_ball_as_statics_has_it(on_ball: Motion) -> None:
    assert on_ball.converged, on_ball.message
    assert abs(on_ball.energy.imbalance).max() < 1e-3
    (contact,) = on_ball.contacts[-1]
    at_rest = solve(build(parse_scene(rod(BALL, modes=10).replace("nodes = 12", "nodes = 24"))))
    (wanted,) = at_rest.contacts
    # Three modes on one element stand for a rod whose shear force jumps at the contact.
    assert_allclose(contact.at, wanted.start, rtol=0, atol=0.01)
    assert_allclose(contact.force, wanted.force, rtol=0, atol=0.03 * np.linalg.norm(wanted.force))
    assert_allclose(on_ball.tip().position[-1], at_rest.tip().position, rtol=0, atol=0.01 * 0.4)


def test_no_section_is_inside_and_no_force_pulls_between_steps(on_ball: Motion) -> None:
    (facing,) = facings(on_ball.model)
    for time in np.linspace(0.0, 1.0, 201):
        state = on_ball.at(float(time))
        assert gaps_along(facing, facing.nodes(state.x, state.inputs)).min() > -1e-5
    normals = [contact.force @ (on_ball.section("rod", [contact.at]).position[row, 0] - [0.25, 0, -0.09])
               for row, contacts in enumerate(on_ball.contacts) for contact in contacts]  # fmt: skip
    assert len(normals) > 5
    assert min(normals) > 0.0


@pytest.mark.slow
@pytest.mark.parametrize(
    "changes",
    [
        ["motions=[{input='rod.base.position',amplitude=[0,0,0.02],frequency=3.0,wave='one_minus_cosine'}]"],
        ["rod.strain='kirchhoff'", "accuracy.modes=3", "bar.from=[0.22,-0.1,-0.09]", "bar.to=[0.28,0.1,-0.09]"],
    ],
)
def test_energies_balance_with_a_base_that_moves_and_off_the_plane(changes: list[str]) -> None:
    scene = read_scene("examples/bouncing_rod.toml", [*changes, "simulation.duration=0.4"])
    motion = simulate(build(scene.with_motion_inputs(), moving=True))
    assert motion.converged, motion.message
    assert motion.events[0].kind == "impact"
    assert motion.energy.impacts[-1] > 0.005
    assert abs(motion.energy.imbalance).max() < 3e-4


@pytest.mark.slow
def test_a_start_that_does_not_touch_is_an_equilibrium() -> None:
    text = rod(BALL).replace('start = "unloaded"', 'start = "equilibrium"')
    apart = simulate(moving(text.replace("-9.81", "-2.0").replace("duration = 0.5", "duration = 0.05")))
    assert apart.converged, apart.message
    assert not apart.events
    assert_allclose(apart.tip().position[-1], apart.tip().position[0], rtol=0, atol=1e-6)


def test_what_exact_contact_in_motion_does_not_go_with_is_refused() -> None:
    text = rod(BALL).replace('start = "unloaded"', 'start = "unloaded", integrator = "gauss", step = 1e-3')
    with pytest.raises(SceneError, match="does not converge for exact contact"):
        simulate(parse_scene(text))


def test_starts_inside_and_bars_too_thin_are_refused_by_what_they_are() -> None:
    inside = 'kind = "sphere", centre = [0.25, 0, -0.02], radius = 0.03'
    with pytest.raises(SceneError, match=r"a rod is inside an obstacle by 0\.025.*: 'rod' in 'bar'"):
        simulate(moving(rod(inside)))
    thin = 'kind = "capsule", from = [0.2, -0.1, -0.03], to = [0.2, 0.1, -0.03], radius = 1e-4'
    with pytest.raises(SceneError, match=r"obstacles\.bar: its radius.*below 0\.0004 m"):
        simulate(moving(rod(thin)))


@pytest.mark.slow
def test_a_rod_does_not_fall_through_a_bar_thinner_than_its_sections_are_apart() -> None:
    thin = 'kind = "capsule", from = [0.2, -0.1, -0.03], to = [0.2, 0.1, -0.03], radius = 5e-4'
    motion = simulate(moving(rod(thin, duration=0.15)))
    assert motion.converged, motion.message
    assert [event.kind for event in motion.events] == ["impact"]
    positions = motion.section("rod", np.linspace(0.0, 1.0, 4001)).position
    distances = np.linalg.norm((positions - [0.2, 0.0, -0.03])[..., [0, 2]], axis=-1)
    assert distances.min() > 5e-4 - 2e-8
    # Sections that are looked at here are up to 0.05 mm beside the one that touches.
    touching = motion.times > motion.events[0].time
    assert_allclose(distances[touching].min(axis=1), 5e-4, rtol=0, atol=3e-6)


@pytest.mark.slow
def test_a_base_that_is_moved_into_a_ball_is_told_with_time_and_place() -> None:
    ball = 'kind = "sphere", centre = [-0.02, 0, -0.06], radius = 0.03'
    drive = '\n[[motions]]\ninput = "rod.base.position"\namplitude = [0, 0, -0.06]\nfrequency = 2.0\n'
    motion = simulate(moving(rod(ball, duration=0.2) + drive + 'wave = "one_minus_cosine"\n'))
    assert motion.outcome is MotionOutcome.CONTACT_UNSETTLED
    assert "At t = 0.1" in motion.message
    assert "the section X = 0 of 'rod'" in motion.message


def test_files_tell_contacts_and_events(on_ball: Motion, tmp_path: Path) -> None:
    on_ball.write(tmp_path / "motion.json")
    entry = json.loads((tmp_path / "motion.json").read_text())["contact"]
    assert entry["kind"] == "exact"
    assert entry["row"][-1] == 40
    assert_allclose(entry["force"][-1], on_ball.contacts[-1][0].force, rtol=1e-15, atol=0)
    assert entry["events"]["kind"][0] == "impact"
    on_ball.write(tmp_path / "motion.npz")
    with np.load(tmp_path / "motion.npz") as arrays:
        assert_allclose(arrays["contact.at"], entry["at"], rtol=1e-15, atol=0)


def test_a_motion_in_contact_is_pickled(on_ball: Motion) -> None:
    """States between steps, forces and what goes on are those of the motion: functions are made anew."""
    again = pickle.loads(pickle.dumps(on_ball))
    time = float(on_ball.events[-1].time)
    assert_allclose(again.at(time).x, on_ball.at(time).x, rtol=0, atol=0)
    assert again.interpolant.__self__.touching(time) == on_ball.interpolant.__self__.touching(time)
    assert again.events == on_ball.events


@pytest.mark.slow
def test_a_start_that_is_not_found_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    """A soft rod that lies on a table from a quarter of its length on takes more turns than one to lie on few modes."""
    heavy = read_scene("examples/rod_on_table.toml", ["simulation={duration=0.1}"])
    at_rest = solve(build(heavy, discretise(heavy, 4)))
    assert at_rest.converged
    model = build(heavy, discretise(heavy, 4), moving=True)
    begun = given_start(model, at_rest)
    assert begun.found, begun.sentence
    assert begun.phases is not None
    assert all(touch.place > 0.25 for touch in begun.phases.touches)
    monkeypatch.setattr("cosserat_casadi.motion.start_in_contact.MOST_TURNS", 1)
    refused = given_start(model, at_rest)
    assert not refused.found
    assert "on at most 4 modes of a strain" in refused.sentence
    assert "Give another number of accuracy.modes" in refused.sentence


def lying() -> Scene:
    """A rod that lies on a table at the beginning, for a short time, on modes that are chosen for it."""
    text = Path("examples/rod_lies_down.toml").read_text().replace("modes = 6\nnodes = 16\n", "")
    return parse_scene(text, ["simulation.start='equilibrium'", "simulation.duration=0.02", "simulation.frames=3"])


def without_starts_below(least: int, monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """No start in contact is found on fewer modes than these; returns the modes that are tried, as they are."""
    tried: list[int] = []
    found = starts.resting

    def resting(contacts: ExactContacts, *given: Any) -> Any:
        modes = max(max(own.modes) for own in contacts.model.discretisation.values())
        tried.append(modes)
        return found(contacts, *given) if modes >= least else None

    monkeypatch.setattr(starts, "resting", resting)
    return tried


@pytest.mark.slow
def test_a_level_without_a_start_in_contact_is_passed_over(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = simulate(lying())
    tried = without_starts_below(9, monkeypatch)
    motion = simulate(lying())
    assert tried[:2] == [6, 9]
    assert motion.converged, motion.message
    assert not motion.events
    wanted = whole.tip().position
    assert_allclose(motion.tip().position, wanted, rtol=0, atol=2e-3 * 0.4)


@pytest.mark.slow
def test_where_no_level_has_a_start_in_contact_the_last_one_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    tried = without_starts_below(100, monkeypatch)
    motion = simulate(lying())
    assert tried == [6, 9, 12, 16]
    assert motion.outcome is MotionOutcome.NO_START
    assert "on at most 16 modes of a strain" in motion.message


@pytest.mark.slow
def test_what_fewer_modes_have_moved_is_kept_where_more_have_no_start(monkeypatch: pytest.MonkeyPatch) -> None:
    found = starts.resting

    def resting(contacts: ExactContacts, *given: Any) -> Any:
        modes = max(max(own.modes) for own in contacts.model.discretisation.values())
        return found(contacts, *given) if modes <= 6 else None

    monkeypatch.setattr(starts, "resting", resting)
    motion = simulate(lying())
    assert motion.outcome is MotionOutcome.UNRESOLVED
    assert not motion.converged
    assert len(motion.times) == 3


def test_energy_of_impacts_is_told_with_its_change_by_modes() -> None:
    """With fixed modes the error is told by a motion on a few modes more, whose blow takes less."""
    high = BALL.replace("-0.09", "-0.05")
    coarse, fine = (rod(high, modes, duration=0.08).replace("1e-4", "1e-2") for modes in (1, 1 + FINER_MODES))
    few = simulate(parse_scene(coarse))
    more = simulate(moving(fine))
    assert [event.kind for event in few.events] == [event.kind for event in more.events] == ["impact"]
    change = few.energy.impacts[-1] - more.energy.impacts[-1]
    assert change > 0.1 * few.energy.impacts[-1]
    # The motion on more modes has steps of another tolerance here.
    assert_allclose(few.impacts_spread, change, rtol=0.05, atol=0)
    assert few.to_dict()["energy"]["impacts_spread"] == few.impacts_spread
    longer = simulate(parse_scene(coarse.replace("duration = 0.08", "duration = 0.081")), start=few)
    assert not longer.events
    assert longer.impacts_spread == few.impacts_spread


def test_a_blow_on_a_rod_that_turns_about_itself_without_inertia_is_told() -> None:
    """A rod in space whose tip strikes the floor: behind its push it is nearly straight."""
    push = '{ name = "push", kind = "point_wrench", rod = "rod", at = 0.8, force = [0, 0.02, -0.1] }'
    text = rod(FLOOR.format(height=-0.05), modes=2, duration=0.085).replace('"planar"', '"kirchhoff"')
    text = text.replace("{ bending_y = 0.016 }", "{ bending_x = 0.016, bending_y = 0.016, torsion = 0.016 }")
    text = text.replace("-9.81] }]", f"-9.81] }}, {push}]")
    (inertia,) = [line for line in text.splitlines() if line.startswith("rotary_inertia")]
    light = simulate(moving(text.replace(inertia, "")))
    assert light.outcome is MotionOutcome.STEP_TOO_SMALL
    assert light.message.endswith("A blow spins 'rod' about the tangent without resistance: give rotary_inertia, kg m.")
