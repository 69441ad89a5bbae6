"""Actuators, lengths and slack cables in motion: slow ones follow equilibria, fast ones balance their energy."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Motion, MotionOutcome, SceneError, build, scene_from_dict, simulate
from cosserat_casadi.motion.history import History
from cosserat_casadi.motion.simulate import Simulator, started
from cosserat_casadi.motion.tip_paths import path_distance
from tests import moving_scenes
from tests.equilibria import solve
from tests.families import mostly_slow
from tests.motion.stepping import moving_model

TENDON = {"name": "cable", "kind": "tendon", "rod": "a", "offset": [0.03, 0.0]}
CHAMBER = {"name": "cell", "kind": "chamber", "rod": "a", "pressure": 0.0, "area": 4e-5, "offset": [0.02, 0.01]}
HEAVILY_DAMPED = {"retardation_time": 0.5}


def actuated(*actuators: dict[str, Any], motion: dict[str, Any], rod: dict[str, Any], **more: Any) -> dict[str, Any]:
    loads = [moving_scenes.WEIGHT]
    return {**moving_scenes.scene(rod, loads=loads), "actuators": list(actuators), "motions": [motion], **more}


def attempted(scene: dict[str, Any], duration: float, **simulation: Any) -> Motion:
    scene = {**scene, "accuracy": {"modes": 3, "nodes": 9}}
    scene["simulation"] = {"duration": duration, "tolerance": 1e-4, **simulation}
    return simulate(moving_model(scene))


def simulated(scene: dict[str, Any], duration: float, **simulation: Any) -> Motion:
    motion = attempted(scene, duration, **simulation)
    assert motion.converged, motion.message
    return motion


def ramp(name: str, before: Any, after: Any, time: float) -> dict[str, Any]:
    """An input that goes from one value to another, smoothly, and stays there."""
    return {"input": name, "times": [0.0, time], "values": [before, after], "interpolation": "cubic"}


DRIVES: dict[str, dict[str, Any]] = {
    "tension": actuated(
        {**TENDON, "tension": 0.0},
        motion=ramp("cable.tension", 0.0, 4.0, 0.3),
        rod=moving_scenes.rod(damping=HEAVILY_DAMPED),
    ),
    "winch": actuated(
        {**TENDON, "length": 0.8},
        motion=ramp("cable.length", 0.8, 0.78, 0.3),
        rod=moving_scenes.rod(strain="reissner", damping=HEAVILY_DAMPED),
    ),
    "pressure": actuated(
        CHAMBER, motion=ramp("cell.pressure", 0.0, 8e4, 0.3), rod=moving_scenes.rod(damping=HEAVILY_DAMPED)
    ),
    "length": actuated(motion=ramp("a.length", 0.8, 1.0, 0.3), rod=moving_scenes.rod(damping=HEAVILY_DAMPED)),
    "base": actuated(
        motion=ramp("a.base.position", [0, 0, 0], [0.1, 0.2, 0.0], 0.3), rod=moving_scenes.rod(damping=HEAVILY_DAMPED)
    ),
    "pinned": actuated(
        motion=ramp("a.base.position", [0, 0, 0], [0.1, 0.05, 0.0], 0.3),
        rod=moving_scenes.rod(damping=HEAVILY_DAMPED),
        supports=[{"rod": "a", "kind": "pinned", "position": [0.2, 0.1, 0.7]}],
    ),
}


@pytest.mark.parametrize("drive", mostly_slow(DRIVES, quick=["length"]))
def test_damped_motion_comes_to_rest_in_the_equilibrium(drive: str) -> None:
    """The equilibrium is that of the last inputs; on the way, energy is balanced."""
    motion = simulated(DRIVES[drive], 12.0)
    held = build(motion.model.scene.held(), motion.model.discretisation)
    equilibrium = solve(held, motion.model.inputs.unpack(motion.inputs[-1]))
    assert equilibrium.converged, equilibrium.message
    assert_allclose(motion.tip().position[-1], equilibrium.tip().position, rtol=0, atol=2e-5)
    assert_allclose(motion.tip().position[0], solve(held).tip().position, rtol=0, atol=1e-9)
    assert np.ptp(motion.tip().position, axis=0).max() > 0.005 or drive == "pinned"
    # That of a length that changes is as exact as the few steps that such damping needs.
    assert np.abs(motion.energy.imbalance).max() < (2e-2 if drive == "length" else 1e-3)
    assert motion.energy.dissipated[-1] > 0.0


def test_tendon_of_given_tension_swings() -> None:
    """A tension that comes within 10 ms, without damping: work of the tendon is all that goes in."""
    rod = moving_scenes.rod()
    del rod["damping"]
    scene = actuated({**TENDON, "tension": 0.0}, motion=ramp("cable.tension", 0.0, 4.0, 0.01), rod=rod)
    motion = simulated(scene, 0.6)
    effort, length = motion.actuator("cable")
    assert_allclose(effort[motion.times >= 0.01], 4.0, rtol=1e-12, atol=0)
    # At constant tension its work is the tension times what is drawn in.
    late = motion.times >= 0.05
    drawn = 4.0 * (length[late][0] - length[late])
    done = motion.energy.work[late] - motion.energy.work[late][0]
    assert_allclose(done, drawn, rtol=0, atol=2e-4 * np.abs(drawn).max())
    assert np.abs(motion.energy.imbalance).max() < 1e-3


def test_winch_holds_the_length_of_its_cable() -> None:
    motion = simulated(DRIVES["winch"], 1.0)
    times = np.minimum(motion.times / 0.3, 1.0)
    wanted = 0.8 - 0.02 * (3 * times**2 - 2 * times**3)
    effort, length = motion.actuator("cable")
    assert_allclose(length, wanted, rtol=0, atol=1e-10)
    assert effort[-1] > 0.1


def pushed_cable(strain: str, tau: float, amplitude: float, frequency: float) -> dict[str, Any]:
    """A rod with a cable that may go slack on its inner side, pushed to and fro."""
    scene = actuated(
        {**TENDON, "length": 0.8, "slack": True},
        motion={"input": "push.force", "amplitude": [amplitude, 0.0, 0.0], "frequency": frequency},
        rod=moving_scenes.rod(strain=strain, damping={"retardation_time": tau}),
    )
    scene["loads"] = [{"name": "push", "kind": "tip_wrench", "rod": "a", "force": [0, 0, 0]}]
    return scene


def check_complementarity(motion: Motion) -> None:
    """The cable is never longer than it is, pulls only where it is taut, and balances its energy."""
    effort, length = motion.actuator("cable")
    assert effort.min() >= 0.0
    assert length.max() < 0.8 + 1e-6
    slack = length < 0.8 - 1e-5
    assert slack.any()
    assert_allclose(effort[slack], 0.0, rtol=0, atol=1e-12)
    assert np.abs(motion.energy.imbalance).max() < 2e-3


def test_cable_goes_slack_in_motion() -> None:
    motion = simulated(pushed_cable("kirchhoff", 0.02, 3.0, 1.0), 0.4)
    check_complementarity(motion)
    assert motion.actuator("cable").effort[-1] < 1e-6


def test_slack_cable_of_a_free_rod_takes_no_momentum_from_it() -> None:
    """Its tension and its impacts act within the rod: momentum is the impulse of the push, in closed form."""
    scene = pushed_cable("kirchhoff", 0.02, 1.0, 2.0)
    scene["rods"][0]["base"] = {"free": True}
    motion = simulated(scene, 0.3, start="unloaded", tolerance=1e-3)
    effort, _ = motion.actuator("cable")
    assert effort.max() > 0.0
    assert effort.min() == 0.0
    still = np.zeros(motion.model.inputs.size)
    states = [motion.at(float(time)) for time in motion.times]
    momentum = [float(motion.model.momentum(state.x, state.v, state.inputs, still)[0][0]) for state in states]
    impulse = (1.0 - np.cos(4.0 * np.pi * motion.times)) / (4.0 * np.pi)
    assert_allclose(momentum[-1], impulse[-1], rtol=0, atol=1e-5)  # 0.144 N s


@pytest.mark.parametrize(
    ("strain", "amplitude", "frequency"),
    [("kirchhoff", 3.0, 1.0), pytest.param("reissner", 0.5, 0.3, marks=pytest.mark.slow)],
    ids=["stiff", "slow"],
)
def test_cable_that_snaps_taut_takes_energy_and_holds(strain: str, amplitude: float, frequency: float) -> None:
    motion = attempted(pushed_cable(strain, 0.02, amplitude, frequency), 1 / frequency, tolerance=1e-3)
    assert motion.converged, motion.message
    check_complementarity(motion)
    assert motion.actuator("cable").effort.max() > 0.1
    lost = motion.energy.impacts
    assert lost[0] == 0.0
    assert lost[-1] > 0.0
    assert np.all(np.diff(lost) >= 0.0)
    assert_allclose(lost[-1], sum(event.energy for event in motion.events), rtol=1e-12, atol=0)
    # At each event the cable has its length, and between them it is in turn taut and slack.
    assert {event.kind for event in motion.events} == {"taut", "slack"}
    assert {event.owner for event in motion.events} == {"cable"}


def test_a_cable_that_is_too_short_where_a_motion_starts_is_told() -> None:
    scene = pushed_cable("kirchhoff", 0.02, 3.0, 1.0)
    scene["actuators"][0]["length"] = 0.72
    with pytest.raises(SceneError, match=r"cables are too short where the motion starts: 'cable' by 0\.1 \("):
        simulated(scene, 0.4, start="unloaded")


def test_elastic_cable_that_becomes_taut_stretches() -> None:
    """No impact: what it is longer by than it is given is tension times length over stiffness."""
    stiffness = 400.0
    scene = pushed_cable("kirchhoff", 0.02, 3.0, 1.0)
    scene["actuators"][0]["axial_stiffness"] = stiffness
    motion = attempted(scene, 1.0, tolerance=1e-3)
    assert motion.converged, motion.message
    effort, length = motion.actuator("cable")
    slack = length < 0.8
    assert slack.any()
    assert effort.max() > 0.1
    assert_allclose(effort[slack], 0.0, rtol=0, atol=1e-9)
    # Between the stages of a step tensions are interpolated.
    assert_allclose(length[~slack] - 0.8, 0.8 / stiffness * effort[~slack], rtol=0, atol=3e-5)
    assert_allclose(motion.energy.impacts, 0.0, rtol=0, atol=1e-12)
    assert np.abs(motion.energy.imbalance).max() < 2e-3


def snapping() -> History:
    """A rod whose cable snaps taut once."""
    scene = {**pushed_cable("kirchhoff", 0.02, 3.0, 1.0), "accuracy": {"modes": 3, "nodes": 9}}
    scene["simulation"] = {"duration": 1.0, "tolerance": 1e-3}
    model = moving_model(scene)
    simulation = model.scene.simulation
    assert simulation is not None
    return Simulator(model, simulation, started(model, simulation, None)).controlled(1e-6)


def test_impact_is_the_blow_that_closes_the_cable() -> None:
    """Velocity and energy by the textbook: one constraint, ΔT = (G v)² / (2 G M⁻¹ Gᵀ)."""
    history = snapping()
    number = next(k for k, leg in enumerate(history.legs) if leg.lost > 0.0)
    before = history.legs[number - 1].integration.end
    after = history.legs[number].start.instant
    model = history.model
    inputs, rate, _ = history.legs[number].piece.at(before.time)
    moves = model.discrete.unknowns.differential
    # The rows of F are over the rod's unit of energy, and so is this mass.
    unit = model.discrete.rods["a"].energy_unit
    mass = unit * model.mass_matrix(before.x, inputs).full()[np.ix_(moves, moves)]
    gradient = model.actuator["cable"](before.x, inputs)[2].full().ravel()[moves]
    mobility = np.linalg.solve(mass, gradient)
    closing_speed = gradient @ before.v[moves]
    assert closing_speed > 0.0
    impulse = closing_speed / (gradient @ mobility)
    assert_allclose(after.v[moves], before.v[moves] - impulse * mobility, rtol=0, atol=1e-9)
    assert_allclose(history.legs[number].lost, closing_speed**2 / (2.0 * gradient @ mobility), rtol=1e-9, atol=0)
    kinetic = [float(model.energies(before.x, v, inputs, rate)[0]) for v in (before.v, after.v)]
    assert_allclose(history.legs[number].lost, kinetic[0] - kinetic[1], rtol=1e-9, atol=0)
    length = float(model.actuator["cable"](before.x, inputs)[1])
    assert_allclose(length, 0.8, rtol=0, atol=1e-12)


@pytest.mark.slow
def test_motion_through_an_impact_converges_with_the_steps() -> None:
    """Times of impact and paths after it follow the tolerance of a step."""
    scene = {**pushed_cable("kirchhoff", 0.02, 3.0, 1.0), "accuracy": {"modes": 3, "nodes": 9}}
    scene["simulation"] = {"duration": 1.0, "tolerance": 1e-3}
    model = moving_model(scene)
    simulation = model.scene.simulation
    assert simulation is not None
    simulator = Simulator(model, simulation, started(model, simulation, None))
    histories = [simulator.controlled(tolerance) for tolerance in (1e-4, 1e-6, 1e-8)]
    impacts = [[leg.start.instant.time for leg in history.legs if leg.lost > 0.0] for history in histories]
    assert [len(times) for times in impacts] == [1, 1, 1]
    errors = [path_distance(simulator.paths(history), simulator.paths(histories[-1])) for history in histories[:2]]
    assert errors[0] < 3e-4
    assert errors[1] < 3e-6
    assert_allclose(impacts[1], impacts[2], rtol=0, atol=1e-5)


@pytest.mark.slow
def test_given_steps_end_at_impacts_too() -> None:
    """What they take is told from the first row after them."""
    scene = pushed_cable("kirchhoff", 0.02, 3.0, 1.0)
    motion = attempted(scene, 1.0, step=0.02)
    assert motion.converged, motion.message
    check_complementarity(motion)
    times = motion.times[np.flatnonzero(np.diff(motion.energy.impacts))]
    assert len(times) == 1
    assert 0.4 < times[0] < 1.0


def test_cable_that_never_stays_slack_or_taut_ends_the_motion(monkeypatch: pytest.MonkeyPatch) -> None:
    """Changes in next to no time are counted; here two in the whole motion are too many."""
    monkeypatch.setattr("cosserat_casadi.motion.history.MOST_AT_ONCE", 1)
    monkeypatch.setattr("cosserat_casadi.motion.history.AT_ONCE", 2.0)
    motion = attempted(pushed_cable("kirchhoff", 0.02, 3.0, 1.0), 1.0, tolerance=1e-3)
    assert motion.outcome is MotionOutcome.SNAPPED
    assert "the cable or joint is cable" in motion.message


def test_a_cable_on_the_stretched_side_of_a_rod_that_falls_lets_it_fall() -> None:
    """Stiff modes answer to its blows: a step that does not see them would have it taut and slack without end."""
    rod = {
        "name": "arm",
        "length": 0.3,
        "strain": "planar",
        "material": {"youngs_modulus": 2e6, "poisson_ratio": 0.48, "density": 1100},
        "section": {"shape": "circle", "radius": 0.005},
        "base": {"tangent": [1, 0, 0]},
        "damping": {"retardation_time": 0.002},
    }
    cable = {"name": "cable", "kind": "tendon", "rod": "arm", "length": 0.3, "slack": True, "offset": [-8e-3, 0.0]}
    weight = {"name": "weight", "kind": "gravity", "acceleration": [0, 0, -9.81]}
    scene = {"schema": 1, "rods": [rod], "loads": [weight], "actuators": [cable]}
    scene["simulation"] = {"duration": 0.05, "start": "unloaded", "tolerance": 1e-3}
    motion = simulate(scene_from_dict(scene), compiled=False)
    assert motion.converged, motion.message
    effort, length = motion.actuator("cable")
    assert effort.min() >= 0.0
    assert length.max() < 0.3 + 1e-9
    assert np.abs(motion.energy.imbalance).max() < 1e-3
