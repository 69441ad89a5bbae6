"""Rods that touch rods without a width in optimal control: stages of motions, and relaxed contact at rest."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import SceneError, build, scene_from_dict, simulate, solve
from cosserat_casadi.control import MotionStage, embedded, lifted, motion_stage, relaxed_contact, tightened
from cosserat_casadi.equilibrium.metrics import pose_distance
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.momentum import MomentumKeeper
from cosserat_casadi.motion.pose_series import section_poses
from cosserat_casadi.motion.section_pairs import TouchingPairs
from tests.contact.test_rods_that_rest_on_rods import BELOW, pressed
from tests.derivatives import central_differences
from tests.motion.test_rods_that_strike_rods import LENGTHS, free_rods, moving

RADII = {"upper": (3e-3, 6e-3), "lower": (6e-3, 4e-3)}

Table = dict[str, Any]


def tapered(share: float = 0.0, friction: float = 0.0) -> Table:
    """Two free rods, askew, with radii that change along them."""
    tables = free_rods(share)
    for rod in tables["rods"]:
        rod["section"]["radius"] = list(RADII[rod["name"]])
    tables["rods"][1]["base"]["tangent"] = [0.3, 1, 0.1]
    tables["rod_contacts"][0]["friction"] = friction
    return tables


def pairs_of(model: Model, sections: int) -> TouchingPairs:
    pairs = motion_stage(model, 1e-3, sections=sections).pairs
    assert pairs is not None
    return pairs


def test_gaps_are_the_least_over_both_rods() -> None:
    """Of bent rods against all pairs of many sections, stretch by stretch."""
    model = moving(tapered())
    pairs, inputs = pairs_of(model, 5), model.pack()
    bends = np.zeros(model.size, dtype=bool)
    for name in LENGTHS:
        bends[model.discrete.unknowns.strain(name)] = True
    X = np.linspace(0.0, 1.0, 401)
    radii = [start + (end - start) * X for start, end in RADII.values()]
    for seed in range(5):
        # Rods bend far, and stay near each other.
        x = np.random.default_rng(seed).normal(size=model.size) * np.where(bends, 2.0, 0.1)
        lines = [section_poses(model, name, X, x[None], inputs[None]).position[0] for name in LENGTHS]
        gaps = np.linalg.norm(lines[0][:, None] - lines[1], axis=2) - radii[0][:, None] - radii[1]
        expected = [gaps[80 * k : 80 * k + 81].min() / LENGTHS["upper"] for k in range(5)]
        found = pairs.gaps(x, inputs).full()[:, 0]
        assert np.all(found <= np.array(expected) + 1e-12)
        assert_allclose(found, expected, rtol=0, atol=1e-4)


def test_parallel_rods_have_a_gap_with_finite_derivatives() -> None:
    """Every section of one is as near to the other, and the gap has no bend along them."""
    tables = free_rods()
    tables["rods"][1]["base"] = {"free": True, "position": [-0.2, 0, 0], "tangent": [1, 0, 0]}
    model = moving(tables)
    pairs, inputs = pairs_of(model, 2), model.pack()
    radii = sum(rod["section"]["radius"] for rod in tables["rods"])
    still = np.zeros(model.size)
    assert_allclose(pairs.gaps(still, inputs).full(), (0.02 - radii) / LENGTHS["upper"], rtol=1e-12, atol=0)
    at = [np.append(still, np.full(pairs.count, value)) for value in (1.0, 0.0, 0.0)]
    matrices = pairs.dynamics_jacobian(*at, inputs, [1e-2], 0 * inputs, 0 * inputs)
    # Without a bend that straight rods have, places would move by 1e18.
    assert max(np.abs(matrix.full()).max() for matrix in matrices) < 1e10


@pytest.mark.parametrize("share", [0.0, 0.4])
def test_forces_on_both_rods_are_opposite_and_derivatives_are_those_of_differences(share: float) -> None:
    """Of contact and friction; what is at the beginning of a stage, with restitution, turns otherwise than its end."""
    model = moving(tapered(share, 0.3))
    pairs, inputs = pairs_of(model, 2), model.pack()
    random = np.random.default_rng(3)
    size, still = model.size, np.zeros(len(inputs))
    states = [0.05 * random.normal(size=size), random.normal(size=size), np.zeros(size)]
    forces = random.uniform(0.1, 1.0, pairs.count)
    at = [np.append(state, forces if k == 0 else 0 * forces) for k, state in enumerate(states)]
    matrices = pairs.dynamics_jacobian(*at, inputs, [1e-2], still, still)[:3]

    def residual(k: int, step: float, direction: FloatArray) -> FloatArray:
        moved = [state + step * direction * (number == k) for number, state in enumerate(at)]
        return np.array(pairs.inverse_dynamics(*moved, inputs, [1e-2], still, still).full()[:, 0])

    for k, slope in enumerate(matrices):
        direction = random.normal(size=size + pairs.count)
        exact = slope.full() @ direction
        # Accelerations move the end of a stage by little.
        step = (1e-5, 1e-5, 1e-2)[k]
        differences = (residual(k, step, direction) - residual(k, -step, direction)) / (2 * step)
        assert_allclose(exact, differences, rtol=0, atol=1e-6 * max(np.abs(exact).max(), 1.0))
    if share == 0.0:
        rigid = MomentumKeeper(model).rigid_motions(states[0])

        def pushes(v: FloatArray) -> FloatArray:
            plain = model.inverse_dynamics(states[0], v, states[2], inputs, still, still).full()[:, 0]
            touched = pairs.inverse_dynamics(at[0], np.append(v, 0 * forces), at[2], inputs, [1e-2], still, still)
            return np.asarray((touched.full()[:size, 0] - plain) * model.discrete.unknowns.units)

        own = pushes(states[1])
        assert_allclose(own @ rigid, 0.0, rtol=0, atol=1e-12 * abs(own).max())
        # Rods that move together as one rigid body slide no more on each other.
        together = pushes(states[1] + rigid @ random.normal(size=rigid.shape[1]))
        assert_allclose(together, own, rtol=0, atol=1e-9 * abs(own).max())


def stages(stage: MotionStage, x: FloatArray, v: FloatArray, count: int) -> FloatArray:
    """The unknowns after so many stages, each of which Newton's method solves from the one before."""
    inputs = stage.model.pack()
    state, unknowns, _, smoothing, _ = stage.symbols
    residual = stage.equations.function(state, unknowns, inputs, smoothing, 0 * inputs)
    newton = ca.rootfinder(
        "newton",
        "newton",
        {"x": unknowns, "p": ca.vertcat(state, smoothing), "g": residual},
        {"line_search": False, "abstol": 1e-10, "max_iter": 60},
    )
    now, guess = stage.state(x, v), stage.still(x)
    for _ in range(count):
        for value in (1e-3, 1e-5):
            guess = newton(x0=guess, p=np.append(now, value))["x"]
        now = stage.next_state(now, guess).full()[:, 0]
    return np.array(stage.x(now).full()[:, 0])


@pytest.mark.slow
@pytest.mark.parametrize(("share", "friction"), [(0.0, 0.0), (0.5, 0.0), (0.0, 0.3)])
def test_a_blow_tends_to_that_of_the_simulator(share: float, friction: float) -> None:
    """With the first power of the length of a stage."""
    tables = free_rods(share, duration=0.03)
    if friction:
        tables["rod_contacts"][0]["friction"] = friction
        tables["velocities"] = [{"rod": "upper", "linear": [0.3, 0.1, -0.5]}]
        tables["simulation"] |= {"step": 2.5e-4, "tolerance": 1e-3}
    model = moving(tables)
    motion = simulate(model)
    assert motion.converged and motion.events[0].kind == "impact"
    errors = []
    for count in (15, 60):
        x = stages(motion_stage(model, 0.03 / count, sections=4), motion.x[0], motion.v[0], count)
        tips = [model.tip[name](x, model.pack())[0].full()[:, 0] for name in LENGTHS]
        errors.append(
            max(abs(tip - motion.tip(name).position[-1]).max() for tip, name in zip(tips, LENGTHS, strict=True))
        )
    assert errors[1] < 0.5 * errors[0] < 3e-4


@pytest.mark.slow
def test_relaxed_contact_of_rods_tends_to_the_exact_law() -> None:
    model = build(scene_from_dict(pressed([0, 0, -1e-3], BELOW, accuracy={"modes": 3, "nodes": 8})))
    exact = solve(model)
    contact, inputs = relaxed_contact(model), model.pack()
    p = contact.defaults
    differences = []
    for p[0] in (1e-2, 1e-4):
        z = contact.near(exact, p)
        assert np.abs(contact.residual(z, inputs, p).full()).max() < 1e-10
        differences.append(pose_distance(contact.solution(z, inputs, p), exact))
    assert differences[0] < 2e-4 and differences[1] < 1e-5
    assert_allclose(contact.exact(z, inputs, p).contacts[0].on_rods, exact.contacts[0].on_rods, rtol=0, atol=1e-9)
    z = z + 0.01 * np.random.default_rng(1).normal(size=len(z))
    p[0] = 1e-2
    differences_of = central_differences(lambda moved: contact.residual(moved, inputs, p).full()[:, 0], z, 1e-6)
    assert_allclose(contact.jacobian(z, inputs, p)[0].full(), differences_of, rtol=0, atol=1e-6)
    x, excess = embedded(contact, exact)(inputs, contact.defaults)
    assert excess <= 1.0 and x.shape[0] == contact.size


def test_rods_that_would_pass_other_contacts_are_refused() -> None:
    loaded = pressed([0, 0, -1e-3], BELOW)
    loaded["loads"].append({"name": "stone", "kind": "point_wrench", "rod": "a", "at": 0.5, "force": [0, 0, -1e-4]})
    with pytest.raises(SceneError, match="'a' touches a rod would have to pass others: it has a load"):
        relaxed_contact(build(scene_from_dict(loaded)))
    floor = {"name": "floor", "kind": "plane", "point": [0, 0, -0.5], "normal": [0, 0, 1], "rods": ["b"]}
    with pytest.raises(SceneError, match="'b' touches a rod would have to pass others: it has an obstacle"):
        relaxed_contact(build(scene_from_dict(pressed([0, 0, -1e-3], BELOW, obstacles=[floor]))))


@pytest.mark.slow
def test_an_optimum_that_presses_one_rod_with_another_becomes_tight() -> None:
    """The push by which the upper rod bends the lower one as a push of 0.7 mN does, from a push of 0.4 mN."""
    model = build(scene_from_dict(pressed([0, 0, -4e-4], BELOW)))
    near = solve(model)
    wanted = solve(model, {"push.force": [0, 0, -7e-4]}, start=near).pose(1.0, "b").position[2]
    contact = relaxed_contact(model)
    opti = ca.Opti()
    p, z, push = opti.parameter(1), opti.variable(contact.size), opti.variable()
    force = ca.vertcat(0, 0, -1e-3 * push)
    rod = lifted(contact, z, force, near, p)
    opti.subject_to(rod.residual == 0)
    opti.subject_to(opti.bounded(0, push, 5))
    opti.set_initial(rod.x, rod.start)
    opti.set_initial(push, 0.4)
    opti.minimize(1e-6 * push**2 + 1e4 * ((contact.tip["b"](rod.x, force, p)[0][2] - wanted) / 0.1) ** 2)
    opti.solver("ipopt", {"print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes"})

    def optimum(parameters: FloatArray) -> tuple[FloatArray, FloatArray]:
        opti.set_value(p, parameters[0])
        found = opti.solve()
        opti.set_initial(found.value_variables())
        return found.value(rod.x)[None], found.value(force)[None]

    tight = tightened(contact, optimum, near=near, tolerance=1e-4)
    assert tight.converged, tight.message
    assert_allclose(tight.inputs[0][2], -7e-4, rtol=1e-3, atol=0)
    assert tight.equilibria[0].contacts[0].on_rods is not None
