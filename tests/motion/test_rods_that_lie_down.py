"""Rods that lie down in motion, and motions that start in contact: against contact at rest, and by their energy."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from typer.testing import CliRunner

from cosserat_casadi import Motion, Solution, build, parse_scene, read_scene, simulate, solve
from cosserat_casadi.cli.main import app
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.contact_forces import Follower, MovingContact
from cosserat_casadi.motion.contact_guards import ContactPhase
from cosserat_casadi.motion.contact_sections import lobatto
from cosserat_casadi.motion.exact_contact import ExactContacts
from cosserat_casadi.motion.facings import facings
from cosserat_casadi.motion.history import equations_of
from cosserat_casadi.motion.simulate import moving_inputs
from cosserat_casadi.motion.trajectory import MotionOutcome
from cosserat_casadi.numerics.consistent_start import response, saddle_at, shortly_after
from cosserat_casadi.numerics.motion_equations import Instant, MotionEquations
from cosserat_casadi.numerics.step_run import ON_GUARD
from tests.moving_scenes import gaps_along

LIES = "examples/rod_lies_down.toml"
LENGTH = 0.4
HEAVY = "examples/rod_on_table.toml"


def moved(*changes: str) -> Motion:
    scene = read_scene(LIES, ["simulation.tolerance=2e-3", *changes])
    return simulate(build(scene.with_motion_inputs(), moving=True))


def at_rest(*changes: str) -> Solution:
    """The rod on the table as statics has it, to 1e-6."""
    text = Path(LIES).read_text().replace("modes = 6\nnodes = 16\n", "")
    return solve(build(parse_scene(text, ["accuracy.modes=12", *changes])))


def deepest(motion: Motion, times: FloatArray) -> float:
    """Depth of the deepest section at any of some times, over the length."""
    (facing,) = facings(motion.model)
    states = [motion.at(float(time)) for time in times]
    return -min(float(gaps_along(facing, facing.nodes(state.x, state.inputs)).min()) for state in states)


@pytest.fixture(scope="module")
def fallen() -> Motion:
    return moved()


@pytest.fixture(scope="module")
def falling() -> Motion:
    """The first part of it: the rod strikes, lies down and strikes again."""
    return moved("simulation.duration=0.2")


@pytest.fixture(scope="module")
def resting() -> Motion:
    eight = ["accuracy.modes=8", "accuracy.nodes=18"]
    return moved(*eight, 'simulation.start="equilibrium"', "simulation.duration=0.1", "simulation.frames=11")


@pytest.mark.slow
def test_a_rod_that_has_fallen_on_a_table_lies_as_statics_has_it(fallen: Motion) -> None:
    assert fallen.converged, fallen.message
    wanted = at_rest()
    (line,) = wanted.contacts
    assert line.kind == "line"
    last = fallen.contacts[-1]
    assert len(last) >= 2
    # On so few modes it may rest on two sections that roll, between which it is off the table by next to nothing.
    (facing,) = facings(fallen.model)
    at_end = fallen.at(0.5)
    gaps = gaps_along(facing, facing.nodes(at_end.x, at_end.inputs))
    assert gaps[np.linspace(0.0, 1.0, len(gaps)) >= min(contact.at for contact in last)].max() < 2e-3
    # Six modes of one element stand for a rod whose shear force jumps where it lifts off.
    resultant = np.sum([contact.force for contact in last], axis=0)
    assert_allclose(resultant, line.force, rtol=0, atol=0.02 * np.linalg.norm(line.force))
    assert_allclose(min(contact.at for contact in last), line.start, rtol=0, atol=0.06)
    assert_allclose(fallen.tip().position[-1], wanted.tip().position, rtol=0, atol=2e-3 * LENGTH)
    assert fallen.energy.kinetic[-1] < 1e-4 * fallen.energy.kinetic.max()


@pytest.mark.slow
@pytest.mark.parametrize("part", ["falling", "fallen"])
def test_a_rod_that_lies_down_is_never_deep_nor_pulled_and_its_energy_only_falls(
    part: str, request: pytest.FixtureRequest
) -> None:
    motion: Motion = request.getfixturevalue(part)
    assert motion.converged, motion.message
    kinds = [event.kind for event in motion.events]
    assert {"impact", "slide_from_end"} <= set(kinds)
    assert deepest(motion, np.linspace(0.0, float(motion.times[-1]), 251)) < 2e-3
    forces = [contact.force[2] for contacts in motion.contacts for contact in contacts]
    assert min(forces) > 0.0
    energy = motion.energy
    assert abs(energy.imbalance).max() < 1e-3
    total = energy.kinetic + energy.elastic + energy.potential
    assert np.diff(total).max() < 1e-4 * np.ptp(total)
    assert np.diff(energy.impacts).min() >= 0.0


@pytest.mark.slow
def test_a_motion_that_starts_in_contact_stays_at_rest(resting: Motion) -> None:
    assert resting.converged, resting.message
    assert not resting.events
    assert not resting.warnings
    assert_allclose(resting.tip().position[-1], resting.tip().position[0], rtol=0, atol=1e-12)
    assert np.abs(resting.v).max() < 1e-7
    wanted = at_rest()
    resultant = np.sum([contact.force for contact in resting.contacts[0]], axis=0)
    assert_allclose(resultant, wanted.contacts[0].force, rtol=0, atol=5e-3 * np.linalg.norm(resultant))
    assert_allclose(resting.tip().position[0], wanted.tip().position, rtol=0, atol=3e-4 * LENGTH)
    assert deepest(resting, np.array([0.0])) < 1e-4


@pytest.mark.slow
def test_the_start_in_contact_converges_to_statics_with_the_modes() -> None:
    wanted = at_rest().tip().position
    short = ['simulation.start="equilibrium"', "simulation.duration=0.01", "simulation.frames=2"]
    apart = []
    for modes in (4, 8, 16):
        motion = moved(*short, f"accuracy.modes={modes}", f"accuracy.nodes={2 * modes + 4}")
        apart.append(float(np.linalg.norm(motion.tip().position[0] - wanted)) / LENGTH)
    assert apart[1] < 0.5 * apart[0]
    assert apart[2] < 0.5 * apart[1]


@pytest.fixture(scope="module")
def heavy_at_rest() -> Solution:
    """A rod ten times as long as what its weight bends, on a table as statics has it."""
    return solve(build(read_scene(HEAVY)))


@pytest.mark.slow
@pytest.mark.parametrize("modes", [2, 3, 4, 5, 6, 7, 10, 12, 16, 24])
def test_a_heavy_rod_starts_in_contact_on_any_number_of_modes(modes: int, heavy_at_rest: Solution) -> None:
    """Few modes stand on as many sections as they have; without the table under it the rod would be unstable."""
    simulation = "simulation={duration=0.05,tolerance=5e-3,frames=3}"
    scene = read_scene(HEAVY, [simulation, f"accuracy={{modes={modes},nodes={2 * modes + 4}}}"])
    motion = simulate(build(scene.with_motion_inputs(), moving=True), start=heavy_at_rest)
    assert motion.converged, motion.message
    assert not motion.events
    assert np.abs(motion.v).max() < 1e-6
    assert_allclose(motion.tip().position[-1], motion.tip().position[0], rtol=0, atol=1e-9)
    forces = np.array([contact.force for contact in motion.contacts[0]])
    assert forces[:, 2].min() > 0.0
    assert deepest(motion, np.array([0.0])) < 0.05 / modes**2
    if modes >= 10:
        (line,) = heavy_at_rest.contacts
        wanted = heavy_at_rest.tip().position
        assert_allclose(forces.sum(axis=0), line.force, rtol=0, atol=1e-2 * line.force[2])
        assert_allclose(motion.tip().position[0], wanted, rtol=0, atol=1e-2 * 1.5)


@pytest.mark.slow
def test_a_short_motion_has_the_contacts_of_a_long_one(heavy_at_rest: Solution) -> None:
    """What counts as no acceleration is judged at its instant: gravity is one, however soon the motion ends."""
    found = []
    for duration in (0.05, 1e-3):
        simulation = f"simulation={{duration={duration},tolerance=5e-3,frames=3}}"
        scene = read_scene(HEAVY, [simulation, "accuracy={modes=8,nodes=20}"])
        found.append(simulate(build(scene.with_motion_inputs(), moving=True), start=heavy_at_rest))
    long, short = found
    for motion in found:
        assert motion.converged, motion.message
        assert not motion.events
    assert short.statistics.steps == long.statistics.steps
    for row in (0, -1):
        places = [[contact.at for contact in motion.contacts[row]] for motion in found]
        assert len(places[0]) > 3
        assert_allclose(places[1], places[0], rtol=0, atol=1e-9)
        forces = [np.array([contact.force for contact in motion.contacts[row]]) for motion in found]
        assert_allclose(forces[1], forces[0], rtol=1e-6, atol=1e-9)


@pytest.mark.slow
def test_a_motion_goes_on_from_a_result_in_contact(tmp_path: Path) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text(Path(LIES).read_text().replace("duration = 0.5", "duration = 0.02"))
    result = tmp_path / "result.json"
    run = CliRunner().invoke(app, ["solve", str(scene), "--output", str(result)])
    assert run.exit_code == 0, run.output
    assert json.loads(result.read_text())["contacts"][0]["kind"] == "line"
    motion = tmp_path / "motion.json"
    figure = tmp_path / "motion.png"
    files = ["--output", str(motion), "--plot", str(figure)]
    run = CliRunner().invoke(app, ["simulate", str(scene), "--from", str(result), *files])
    assert run.exit_code == 0, run.output
    assert figure.stat().st_size > 0
    data = json.loads(motion.read_text())
    assert data["contact"]["row"][0] == 0
    assert all(data["contact"]["lies"])
    assert not data["contact"]["events"]["kind"]


def test_a_rod_on_a_ball_starts_at_the_section_that_touches() -> None:
    ball = '{name="table",kind="sphere",centre=[0.25,0,-0.09],radius=0.03}'
    motion = moved('simulation.start="equilibrium"', "simulation.duration=0.05", f"obstacles=[{ball}]")
    assert motion.converged, motion.message
    (contact,) = motion.contacts[-1]
    assert not contact.lies
    assert_allclose(motion.contacts[0][0].at, contact.at, rtol=0, atol=1e-9)
    # Without friction the force stands on the rod.
    before, after = motion.section("rod", [contact.at - 1e-5, contact.at + 1e-5]).position[-1]
    tangent = (after - before) / (2e-5 * LENGTH)
    assert_allclose(contact.force @ tangent, 0.0, rtol=0, atol=1e-5 * np.linalg.norm(contact.force))


@pytest.mark.slow
def test_a_rod_that_is_laid_down_slowly_follows_statics_and_comes_off_again() -> None:
    lowered = "motions=[{input='rod.base.position',amplitude=[0,0,-0.175],frequency=0.5,wave='one_minus_cosine'}]"
    changes = ["table.point=[0,0,-0.09]", "rod.damping.retardation_time=0.05", "accuracy.modes=6", "accuracy.nodes=16"]
    apart = moved(lowered, *changes, "rod.base.position=[0,0,0.35]", 'simulation.start="equilibrium"',
                  "simulation.duration=2.0", "simulation.frames=41")  # fmt: skip
    assert apart.converged, apart.message
    assert not apart.contacts[0]
    assert not apart.contacts[-1]
    assert [event.kind for event in apart.events].count("lift_off") >= 1
    lowest = int(np.argmin(apart.section("rod", [0.0]).position[:, 0, 2]))
    base = apart.section("rod", [0.0]).position[lowest, 0]
    wanted = at_rest(*changes[:1], f"rod.base.position=[0,0,{base[2]}]")
    assert_allclose(apart.tip().position[lowest], wanted.tip().position, rtol=0, atol=0.01 * LENGTH)
    resultant = np.sum([contact.force for contact in apart.contacts[lowest]], axis=0)
    assert_allclose(resultant, wanted.contacts[0].force, rtol=0, atol=0.05 * np.linalg.norm(resultant))


@pytest.mark.slow
def test_a_base_that_is_driven_into_the_table_is_told() -> None:
    lowered = "motions=[{input='rod.base.position',amplitude=[0,0,-0.06],frequency=1.0,wave='one_minus_cosine'}]"
    motion = moved(lowered, "accuracy.modes=4", "accuracy.nodes=12", "simulation.duration=0.5")
    assert motion.outcome is MotionOutcome.CONTACT_UNSETTLED
    assert "inside 'table'" in motion.message


def test_files_tell_which_sections_lie(resting: Motion, tmp_path: Path) -> None:
    resting.write(tmp_path / "motion.npz")
    with np.load(tmp_path / "motion.npz") as arrays:
        assert arrays["contact.lies"].all()
        assert len(arrays["contact.lies"]) == len(arrays["contact.at"])


def test_nodes_of_lobatto_are_those_of_closed_form() -> None:
    assert_allclose(lobatto(1), [0.0, 1.0], rtol=0, atol=0)
    assert_allclose(lobatto(3), [0.0, (1 - 5**-0.5) / 2, (1 + 5**-0.5) / 2, 1.0], rtol=0, atol=1e-15)
    assert_allclose(lobatto(4), [0.0, (1 - (3 / 7) ** 0.5) / 2, 0.5, (1 + (3 / 7) ** 0.5) / 2, 1.0], rtol=0, atol=1e-15)


def test_what_happens_shortly_after_is_a_step_of_the_implicit_method() -> None:
    mass, damping, stiffness, load = 2.0, 50.0, 3e4, 7.0

    def residual(_: float, x: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
        return np.asarray(mass * a + damping * v + stiffness * x - load)

    def jacobians(*_: object) -> tuple[FloatArray, FloatArray, FloatArray]:
        return np.array([[stiffness]]), np.array([[damping]]), np.array([[mass]])

    equations = MotionEquations(np.array([True]), residual, jacobians)
    x, v, h = 1e-3, 0.4, 0.01
    a = (load - damping * v - stiffness * x) / mass
    instant = Instant(0.0, np.array([x]), np.array([v]), np.array([a]))
    mean, answer = shortly_after(equations, instant, h, np.ones((1, 1)))
    # M a + D (v + h a) + K (x + h v + h² a) = f
    effective = mass + h * damping + h**2 * stiffness
    assert_allclose(mean, (load - damping * v - stiffness * (x + h * v)) / effective, rtol=1e-12, atol=0)
    assert_allclose(answer, 1.0 / effective, rtol=1e-12, atol=0)
    assert_allclose(response(saddle_at(equations, instant), np.ones((1, 1))), 1.0 / mass, rtol=1e-12, atol=0)


def guarded(height: float, arrangement: ContactPhase, force: FloatArray, time: float) -> FloatArray:
    """Guards of the straight rod above the table by a part of its length, with forces of contact at a time."""
    (radius, bottom) = (8e-3, -height * LENGTH)
    changes = [f"table.point=[0,0,{bottom - radius}]", "rod.base.position=[0,0,0]"]
    model = build(read_scene(LIES, changes).with_motion_inputs(), moving=True)
    contacts = ExactContacts(model)
    (piece,) = moving_inputs(model).pieces(0.1)
    touches = tuple(touch._replace(height=height) for touch in arrangement.touches)
    follower = Follower(contacts.facings, touches)
    floors = tuple(np.zeros(max(1, len(facing.laid_at))) for facing in contacts.facings)
    whole = ContactPhase(touches, arrangement.laid, follower, floors, arrangement.forces_from)
    _, guards = contacts.arranged(equations_of(model, piece), piece, whole)
    none = np.zeros(model.size + len(touches))
    return guards(Instant(time, np.concatenate([model.unloaded(), force]), none, none))


def test_a_force_that_may_pull_for_a_while_is_no_event_until_then() -> None:
    """A guard that is zero would be one at once, and the contact would be taken up and given up without end."""
    tip = ContactPhase((MovingContact(0, 1.0, False),), forces_from=0.01)
    assert guarded(0.0, tip, np.array([-0.3]), 0.005)[0] > 1e3 * ON_GUARD
    assert guarded(0.0, tip, np.array([-0.3]), 0.02)[0] == -0.3


def test_a_rod_has_got_up_where_none_of_its_sections_would_touch() -> None:
    """Less high it would lie down again in the same moment: its sections count as touching up to there."""
    lying = ContactPhase(laid=frozenset({0}))
    assert guarded(5e-8, lying, np.zeros(0), 0.0)[-1] > 0.0
    assert guarded(2e-7, lying, np.zeros(0), 0.0)[-1] < 0.0
