"""Stops of joints: closed forms at rest and on paths, SciPy's events in motion, restitution, elastic stops, C."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from cosserat_casadi import (
    Motion,
    SceneError,
    build,
    export,
    follow,
    load,
    modes_of,
    scene_from_dict,
    simulate,
)
from cosserat_casadi.equilibrium.stability import admissible_eigenvalues, variations
from tests.derivatives import check_jacobian
from tests.equilibria import solve
from tests.families import mostly_slow
from tests.model.test_base_joints import GRAVITY, link, scene
from tests.model.test_joint_coordinates import ALONG, CARRIED, HINGE, OBLIQUE, SLIDE, TURN, built

MASS, ARM, INERTIA = 0.2, 0.1, 2e-4 + 0.2 * 0.1**2
"""A rigid lever: mass, kg, distance of its centre from the hinge, m, and moment of inertia about that, kg m²."""

BOUND = 0.5
"""Angle below the horizontal at which the lever stops, rad."""

WEIGHT = MASS * GRAVITY * ARM
"""Moment of its weight about the hinge where it is horizontal, N m."""


def lever(duration: float = 0.4, motions: Any = (), tolerance: float = 1e-5, **joint: Any) -> dict[str, Any]:
    """A body that falls from the horizontal on a hinge at a post that twists and does not bend."""
    post = link("post", strain=["torsion"], damping={"retardation_time": 1e-3})
    hinge = {"name": "hinge", "kind": "revolute", "rod": "post", "body": "lever", "axis": [0, 1, 0], **joint}
    body = {"name": "lever", "mass": MASS, "centre_of_mass": [ARM, 0, 0], "inertia": [1e-4, 2e-4, 1e-4]}
    tables = scene(
        [post],
        # The angle is that of the post in the body.
        [{"lower_stop": -BOUND, **hinge}],
        bodies=[body],
        simulation={"duration": duration, "frames": 41, "start": "unloaded", "tolerance": tolerance},
        motions=list(motions),
    )
    tables["accuracy"] = {"modes": 1, "nodes": 4}
    return tables


def angles(motion: Motion) -> np.ndarray:
    return -motion.joint("hinge").conjugate


@pytest.mark.parametrize(
    "joint",
    [
        {**HINGE, **OBLIQUE, "stiffness": 0.3, "lower_stop": -0.2, "upper_stop": 0.1},
        {**SLIDE, **OBLIQUE, "upper_stop": 0.01, "stop_stiffness": 40.0},
    ],
)
def test_jacobian_vs_ad(joint: dict[str, Any]) -> None:
    model = built([joint], CARRIED)
    check_jacobian(model)


@pytest.mark.parametrize("stiffness", mostly_slow([None, 2.0], quick=[None]))
def test_lever_rests_on_its_stop(stiffness: float | None) -> None:
    elastic = {} if stiffness is None else {"stop_stiffness": stiffness}
    rests = solve(build(scene_from_dict(lever(**elastic))))
    assert rests.converged and rests.stable
    state = rests.joint("hinge")
    beyond = 0.0 if stiffness is None else state["stop"] / stiffness
    assert_allclose(state["angle"], -BOUND - beyond, rtol=0, atol=1e-9)
    assert_allclose(state["stop"], WEIGHT * np.cos(state["angle"]), rtol=1e-9, atol=0)


@pytest.mark.slow
def test_frequency_on_an_elastic_stop() -> None:
    modes = modes_of(scene_from_dict(lever(stop_stiffness=20.0)))
    angle = modes.solution.joint("hinge")["angle"]
    wanted = np.sqrt((20.0 - WEIGHT * np.sin(angle)) / INERTIA)
    # The post twists more slowly than that.
    assert_allclose(2 * np.pi * modes.modes[1].frequency, wanted, rtol=1e-9, atol=0)


@pytest.mark.parametrize("stiffness", mostly_slow([0.3, 2.0], quick=[0.3]))
def test_second_variation_of_a_lever_that_leans_on_an_elastic_stop(stiffness: float) -> None:
    """Its centre of mass is above the hinge: W cos θ of the moment of the stop is lost."""
    tables = lever(stop_stiffness=stiffness, upper_stop=0.05, moment=0.02)
    tables["joints"][0]["lower_stop"] = -0.05
    tables["bodies"][0]["centre_of_mass"] = [0, 0, ARM]
    leans = solve(build(scene_from_dict(tables)))
    angle = leans.joint("hinge")["angle"]
    eigenvalues = admissible_eigenvalues(
        leans.model.jacobian(leans.x, leans.inputs)[0].full(), variations(leans.model)
    ) * max(leans.model.discrete.unknowns.units)
    # The unit variation moves angle and quaternion together, by 1 and ½.
    wanted = 0.8 * (stiffness - WEIGHT * np.cos(angle))
    assert np.abs(eigenvalues - wanted).min() < 1e-9


@pytest.mark.parametrize(("force", "wanted"), [(0.3, 0.0), (0.6, 0.2), (-0.9, -0.6)])
def test_slide_between_two_stops(force: float, wanted: float) -> None:
    """A spring of 40 N/m with stops 10 mm and 7.5 mm from its rest: what is beyond is borne by a stop."""
    slide = {**SLIDE, "stiffness": 40.0, "lower_stop": -0.0075, "upper_stop": 0.01}
    pushed = solve(built([slide], loads=[{**TURN, "moment": [0, 0, 0], "force": [force, 0, 0]}]))
    assert pushed.converged, pushed.message
    state = pushed.joint("slide")
    assert_allclose(state["displacement"], (force - wanted) / 40.0, rtol=0, atol=1e-9)
    assert_allclose(state["stop"], -wanted, rtol=0, atol=1e-9)


def test_path_meets_a_stop_and_leaves_another() -> None:
    """A motor against a spring: off the lower stop at 0.2 of its moment, at the upper one from 0.6 on."""
    hinge = {**HINGE, "stiffness": 0.5, "rest": -0.5, "lower_stop": -0.3, "upper_stop": 0.1, "moment": 0.0}
    model = built([hinge], loads=[])
    path = follow(model, "hinge.moment", 0.5)
    assert path.converged, path.message
    states = np.array([model.joint["hinge"](x, inputs) for x, inputs in zip(path.x, path.all_inputs, strict=True)])
    _, angle, stop = states.T.reshape(3, -1)
    moment = 0.5 * path.factor
    wanted = np.clip(moment / 0.5 - 0.5, -0.3, 0.1)
    assert_allclose(angle, wanted, rtol=0, atol=1e-9)
    assert_allclose(stop, 0.5 * (wanted + 0.5) - moment, rtol=0, atol=1e-9)
    assert np.all(path.stable)


def test_bounces_vs_scipy() -> None:
    """A lever that gives back half of its speed: times, energies and impulses of its blows."""
    share = 0.5
    motion = simulate(scene_from_dict(lever(restitution=share)))
    assert motion.converged, motion.message
    hits = [event for event in motion.events if event.kind == "stop_hit"]
    time, state = 0.0, np.zeros(2)
    for hit in hits[:6]:

        def at_stop(_t: float, y: np.ndarray) -> float:
            return float(y[0] - BOUND)

        at_stop.terminal = True  # type: ignore[attr-defined]
        at_stop.direction = 1  # type: ignore[attr-defined]
        rates = lambda _t, y: [y[1], WEIGHT * np.cos(y[0]) / INERTIA]  # noqa: E731
        fall = solve_ivp(rates, (time, 1.0), state, rtol=1e-11, atol=1e-12, events=at_stop)
        time, speed = fall.t[-1], fall.y[1, -1]
        assert_allclose(hit.time, time, rtol=0, atol=1e-7)
        assert_allclose(hit.impulse, INERTIA * speed * (1 + share), rtol=1e-5, atol=0)
        assert_allclose(hit.energy, INERTIA * speed**2 / 2 * (1 - share**2), rtol=1e-5, atol=0)
        state = np.array([BOUND, -share * speed])
    # Bounces that are too low to see end at rest; what the blows took is all that is lost.
    assert len(hits) < 15
    assert_allclose(angles(motion)[-1], BOUND, rtol=0, atol=1e-9)
    assert_allclose(motion.energy.impacts[-1], sum(hit.energy for hit in hits), rtol=1e-12, atol=0)
    assert_allclose(motion.energy.imbalance, 0.0, rtol=0, atol=1e-5)


@pytest.mark.slow
def test_two_links_bounce_until_both_rest_on_their_stops() -> None:
    """Blows of one joint throw the other off its stop again: all of the energy is lost in the end."""
    stiff = {"strain": ["torsion"], "damping": {"retardation_time": 1e-3}}
    hinge = {**HINGE, "upper_stop": 0.5, "restitution": 0.4}
    elbow = {**hinge, "name": "elbow", "rod": "b", "upper_stop": 0.3}
    tables = scene(
        [link("a", base=ALONG, **stiff), link("b", base={"rod": "a"}, **stiff)],
        [hinge, elbow],
        simulation={"duration": 0.4, "frames": 3, "start": "unloaded", "tolerance": 1e-3},
    )
    tables["accuracy"] = {"modes": 1, "nodes": 4}
    motion = simulate(scene_from_dict(tables))
    assert motion.converged, motion.message
    assert_allclose(motion.joint("hinge").conjugate[-1], 0.5, rtol=0, atol=1e-9)
    assert_allclose(motion.joint("elbow").conjugate[-1], 0.3, rtol=0, atol=1e-9)
    fallen = motion.energy.potential[0] - motion.energy.potential[-1]
    assert_allclose(motion.energy.impacts[-1], fallen, rtol=1e-4, atol=0)


def test_motor_lifts_a_lever_off_its_stop() -> None:
    pull = {"input": "hinge.moment", "times": [0.0, 0.2, 0.4], "values": [0.0, 0.0, 0.4]}
    motion = simulate(scene_from_dict(lever(motions=[pull], moment=0.0)))
    hit, left = motion.events
    assert (hit.kind, hit.owner, hit.obstacle) == ("stop_hit", "hinge", "lower_stop")
    assert left.kind == "stop_left"
    assert_allclose(left.time, 0.2 + WEIGHT * np.cos(BOUND) / 2.0, rtol=0, atol=1e-9)
    assert angles(motion)[-1] < BOUND - 0.1


def elastic_reference(times: np.ndarray) -> np.ndarray:
    """Angles of a lever that falls on a stop of 20 N m/rad, with a damper of 0.002 N m s/rad."""

    def rates(_t: float, y: np.ndarray) -> list[float]:
        push = 20.0 * max(y[0] - BOUND, 0.0) + 2e-3 * y[1]
        return [y[1], (WEIGHT * np.cos(y[0]) - push) / INERTIA]

    fall = solve_ivp(rates, (0, times[-1]), [0, 0], rtol=1e-9, atol=1e-10, t_eval=times, max_step=1e-3)
    return np.asarray(fall.y[0])


ELASTIC = {"stop_stiffness": 20.0, "damping": 2e-3}


@pytest.mark.slow
def test_elastic_stop_vs_scipy() -> None:
    motion = simulate(scene_from_dict(lever(**ELASTIC)))
    assert motion.converged, motion.message
    assert_allclose(angles(motion), elastic_reference(motion.times), rtol=0, atol=1e-5)
    assert_allclose(motion.energy.imbalance, 0.0, rtol=0, atol=3e-4)


@pytest.mark.slow  # A compiler runs, twice.
def test_in_c(tmp_path: Path) -> None:
    model = build(scene_from_dict(lever(moment=0.0)))
    library = load(export(model, tmp_path / "rigid"))
    here = solve(model, {"hinge.moment": 0.1})
    assert_allclose(library.solve({"hinge.moment": 0.1}).x, here.x, rtol=0, atol=1e-10)
    _, _, stop = library.joint["hinge"](here.x, here.inputs)
    assert_allclose(float(stop), here.joint("hinge")["stop"], rtol=1e-12, atol=0)

    library = load(export(build(scene_from_dict(lever(**ELASTIC))), tmp_path / "elastic", dynamics=True))
    state, memory = library.rest(), library.step_memory()
    assert state is not None
    moved = [0.0]
    for _ in range(400):
        step = library.step(state, 1e-3, {}, memory=memory)
        state = step.state
        moved.append(-float(library.joint["hinge"](state.x, library.defaults)[1]))
    assert_allclose(moved, elastic_reference(np.linspace(0, 0.4, 401)), rtol=0, atol=2e-3)


@pytest.mark.parametrize(
    ("joint", "where", "problem"),
    [
        ({"angle": 0.1, "upper_stop": 1.0}, "upper_stop", "stands beside angle"),
        ({"lower_stop": 0.2, "upper_stop": 0.2}, "upper_stop", "must be > lower_stop = 0.2, got 0.2"),
        ({"restitution": 0.2}, "restitution", "belongs to a stop, and the joint has none"),
        (
            {"upper_stop": 0.2, "restitution": 0.2, "stop_stiffness": 3.0},
            "restitution",
            "stands beside stop_stiffness, and an elastic stop returns all energy",
        ),
    ],
)
def test_refusals(joint: dict[str, Any], where: str, problem: str) -> None:
    with pytest.raises(SceneError) as refused:
        scene_from_dict(scene([link("a", base=ALONG)], [{**HINGE, **joint}]))
    assert (f"joints[0].{where}", problem) in [(one.where, one.problem) for one in refused.value.problems]


@pytest.mark.slow
def test_stop_as_a_parameter() -> None:
    """A stop as a parameter: the angle follows it."""
    hinge = {**HINGE, "stiffness": 0.5, "upper_stop": 0.3}
    tables = scene([link("a", base=ALONG)], [hinge], parameters=["hinge.upper_stop"])
    model = build(scene_from_dict(tables))
    for bound in (0.1, 0.2):
        assert_allclose(solve(model.at({"hinge.upper_stop": bound})).joint("hinge")["angle"], bound, rtol=0, atol=1e-9)
