"""A stage in motion against the simulator: the same equations, and an optimum that replays to Newton's tolerance."""

from __future__ import annotations

from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import SceneError, build, scene_from_dict, solve
from cosserat_casadi.codegen.motion_stage import compiled_motion_stage
from cosserat_casadi.control import Collocation, gauss, motion_stage, radau
from cosserat_casadi.numerics.motion_equations import Instant
from cosserat_casadi.numerics.step import StepPolynomial
from tests.codegen.test_load import cached, needs_compiler
from tests.control.swing import IPOPT, LARGEST, RATE, STAGES, STEP, TENDONS, optimum, replayed, task
from tests.families import mostly_slow
from tests.moving_scenes import FAMILIES, PULL, drawn_state, joint, model_of, rod, scene

METHODS = [radau(1), radau(2), radau(3), gauss(1), gauss(2)]


def name_of(method: Collocation) -> str:
    return method.name


@pytest.mark.parametrize("method", METHODS, ids=name_of)
@pytest.mark.parametrize("family", ["kirchhoff", "moving base", "relaxing"])
def test_equations_vs_those_of_the_simulator(family: str, method: Collocation) -> None:
    compare_with_the_simulator(family, method)


@pytest.mark.parametrize("method", METHODS[:3], ids=name_of)
@pytest.mark.parametrize("family", ["clamped tip", "given length"])
def test_equations_with_algebraic_entries_vs_those_of_the_simulator(family: str, method: Collocation) -> None:
    compare_with_the_simulator(family, method)


def compare_with_the_simulator(family: str, method: Collocation) -> None:
    """Any values of state and unknowns: residuals at the instants, and the end of the step."""
    model = model_of(family)
    differential = model.discrete.unknowns.differential
    duration = 0.02
    stage = motion_stage(model, duration, method)
    drawn = drawn_state(model)
    start = Instant(0.0, drawn.x, np.where(differential, drawn.v, 0.0), 0.0 * drawn.x)
    unknowns = np.random.default_rng(1).standard_normal((method.stages, model.size))
    stages = StepPolynomial(method, differential, start, duration, unknowns).stages
    steady = np.zeros(model.inputs.size)
    rows = []
    for i in range(method.stages):
        inputs = drawn.inputs + stages.times[i] * drawn.inputs_rate
        at = stages.x[i], stages.v[i], stages.a[i], inputs, drawn.inputs_rate, steady
        rows.append(model.inverse_dynamics(*at).full()[:, 0])
    scaled = np.where(differential, duration**2 * unknowns, unknowns).ravel()
    state = stage.state(start.x, start.v)
    found = stage.equations(state, scaled, drawn.inputs, inputs_rate=drawn.inputs_rate).full()[:, 0]
    assert_allclose(found, np.concatenate(rows), rtol=1e-10, atol=1e-11)
    end = StepPolynomial(method, differential, start, duration, unknowns).arrival(duration)
    following = stage.next_state(state, scaled).full()[:, 0]
    assert_allclose(following, stage.state(end.x, end.v), rtol=1e-13, atol=1e-14)
    assert_allclose(stage.transition @ state + stage.drive @ scaled, following[:, None], rtol=1e-13, atol=1e-14)
    assert_allclose(stage.x(ca.DM(following)).full()[differential, 0], end.x[differential], rtol=1e-13, atol=1e-14)
    assert_allclose(stage.v(ca.DM(following)).full()[:, 0], end.v, rtol=1e-12, atol=1e-13)


METHODS = [radau(1), radau(2), gauss(2)]


@pytest.mark.parametrize("method", mostly_slow(METHODS, quick=METHODS[1:2]), ids=name_of)
def test_an_optimum_replays_in_the_simulator(method: Collocation) -> None:
    wanted = task(method)
    found = optimum(wanted)
    rates = np.diff(found.tensions, axis=0) / STEP
    assert found.tensions.min() >= -1e-7
    assert found.tensions.max() <= LARGEST + 1e-7
    # Both bounds are active somewhere: the tip is asked to move fast.
    assert_allclose(np.abs(rates).max(), RATE, rtol=1e-6, atol=0)
    assert_allclose(found.tensions.max(), LARGEST, rtol=1e-6, atol=0)
    assert_allclose(replayed(wanted, found.tensions, method), found.states, rtol=0, atol=1e-9)
    tip = wanted.stage.model.tip["arm"](wanted.stage.x(found.states[-1]), found.tensions[-1])[0].full()[:, 0]
    assert tip[0] > 0.1
    half = wanted.stage.state_size // 2
    assert np.abs(found.states[-1, half:]).max() < 0.5 * np.abs(found.states[STAGES // 2, half:]).max()


@pytest.mark.slow
@needs_compiler
def test_fatrop_vs_ipopt(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Variables and constraints stage by stage: the next state is linear, the equations of motion follow its gap."""
    cached(tmp_path, monkeypatch)
    wanted = task()
    stage = wanted.stage
    compiled = compiled_motion_stage(stage, "arm_stage")
    count = len(TENDONS)
    states = [ca.MX.sym(f"state_{k}", stage.state_size) for k in range(STAGES + 1)]
    tensions = [ca.MX.sym(f"tensions_{k}", count) for k in range(STAGES + 1)]
    free = np.inf * np.ones(stage.unknowns_size)
    variables: list[ca.MX] = []
    lower: list[float] = []
    upper: list[float] = []
    start: list[float] = []
    constraints: list[ca.MX] = []
    cost = ca.MX(0)
    for k in range(STAGES):
        unknowns = ca.MX.sym(f"unknowns_{k}", stage.unknowns_size)
        rates = ca.MX.sym(f"rates_{k}", count)
        variables += [states[k], tensions[k], unknowns, rates]
        held = [-np.inf, np.inf] if k == 0 else [0.0, LARGEST]
        lower += [*[-np.inf] * stage.state_size, *[held[0]] * count, *-free, *[-RATE] * count]
        upper += [*[np.inf] * stage.state_size, *[held[1]] * count, *free, *[RATE] * count]
        start += [*wanted.start, *wanted.near.inputs, *stage.still(wanted.near.x), *[0.0] * count]
        constraints.append(states[k + 1] - stage.next_state(states[k], unknowns))
        constraints.append(tensions[k + 1] - tensions[k] - STEP * rates)
        if k == 0:
            constraints += [states[k] - wanted.start, tensions[k] - wanted.near.inputs]
        constraints.append(compiled.equations(states[k], unknowns, tensions[k], inputs_rate=rates))
        cost += wanted.effort(rates)
    variables += [states[-1], tensions[-1]]
    lower += [*[-np.inf] * stage.state_size, *[0.0] * count]
    upper += [*[np.inf] * stage.state_size, *[LARGEST] * count]
    start += [*wanted.start, *wanted.near.inputs]

    def tip(state: ca.MX, pulled: ca.MX) -> ca.MX:
        return compiled.poses(state, pulled)[:3]

    cost += wanted.arrival(states[-1], tensions[-1], tip)
    problem = {"x": ca.vertcat(*variables), "f": cost, "g": ca.vertcat(*constraints)}
    first = stage.state_size + count
    stages = {
        "N": STAGES,
        "nx": [first] * (STAGES + 1),
        "nu": [stage.unknowns_size + count] * STAGES + [0],
        "ng": [stage.unknowns_size + first] + [stage.unknowns_size] * (STAGES - 1) + [0],
    }
    options = {"structure_detection": "manual", **stages, "equality": [True] * problem["g"].numel()}
    settings = {"fatrop.print_level": 0, "fatrop.tol": 1e-9, "print_time": False}
    solver = ca.nlpsol("solver", "fatrop", problem, {**options, **settings})
    found = solver(x0=start, lbx=lower, ubx=upper, lbg=0, ubg=0)["x"]
    assert solver.stats()["success"]
    pulled = ca.Function("pulled", [problem["x"]], [ca.horzcat(*tensions).T])(found).full()
    moved = ca.Function("moved", [problem["x"]], [ca.horzcat(*states).T])(found).full()
    assert_allclose(pulled, optimum(wanted).tensions, rtol=0, atol=1e-5)
    assert_allclose(replayed(wanted, pulled, stage.method), moved, rtol=0, atol=1e-7)


def test_stages_of_a_rod_at_rest_stay_at_rest() -> None:
    wanted = task()
    stage = wanted.stage
    unknowns = stage.still(wanted.near.x)
    still = np.zeros(stage.model.inputs.size)
    assert_allclose(stage.next_state(wanted.start, unknowns).full()[:, 0], wanted.start, rtol=0, atol=0)
    residual = stage.equations(wanted.start, unknowns, wanted.near.inputs, inputs_rate=still)
    assert_allclose(residual, 0.0, rtol=0, atol=1e-11)


def test_what_cannot_move_is_refused() -> None:
    held = model_of("clamped tip")
    with pytest.raises(SceneError, match=r"duration: 0\.0 s is no positive time") as refused:
        motion_stage(held, 0.0, gauss(2))
    assert "Gauss, stages 2 does not converge" in str(refused.value)
    tables = FAMILIES["planar"]()
    del tables["rods"][0]["linear_density"]
    del tables["rods"][0]["rotary_inertia"]
    del tables["rods"][0]["damping"]
    with pytest.raises(SceneError, match="'a' has no mass"):
        motion_stage(build(scene_from_dict(tables), moving=True), 0.1)


@pytest.mark.parametrize(
    ("family", "count"),
    # Strains and the six ways of a body, without what joints and cables hold.
    [("planar", 2), ("relaxing joints", 18 + 6 - 11), ("given length", 12 - 1), ("free with body", 6 + 12 - 3)],
)
def test_rates_that_constraints_leave_free(family: str, count: int) -> None:
    model = model_of(family)
    at = drawn_state(model)
    stage = motion_stage(model, STEP)
    state = stage.state(at.x, at.v)
    assert stage.independent_rates(state, at.x, at.inputs).shape == (count, 1)
    if model.discrete.frames:
        # What only changes norms of quaternions is no motion.
        swollen = np.zeros(model.size)
        for name, frame in model.discrete.frames.items():
            entries = model.discrete.deviation(name)
            swollen[entries][3:] = frame.start.quaternion + at.x[entries][3:]
        assert_allclose(stage.independent_rates(stage.state(at.x, swollen), at.x, at.inputs), 0.0, rtol=0, atol=1e-12)


def test_rates_that_constraints_leave_free_follow_the_parameters() -> None:
    """The cable of given length runs elsewhere: as of the stage of a model with those numbers."""
    model = model_of("given length")
    scene = model.scene.model_copy(update={"parameters": ("cable.offset",)})
    of_parameters = build(scene, model.discretisation, moving=True)
    at = drawn_state(model)
    p = np.array([2.0, -1.0, 3.0, 1.0]) * of_parameters.parameters.pack()
    stage = motion_stage(of_parameters, STEP, parameters=True)
    state = stage.state(at.x, at.v)
    with pytest.raises(ValueError, match="give them as p"):
        stage.independent_rates(state, at.x, at.inputs)
    found = stage.independent_rates(state, at.x, at.inputs, p)
    written = motion_stage(of_parameters.at(p), STEP)
    assert_allclose(found, written.independent_rates(state, at.x, at.inputs), rtol=1e-9, atol=1e-9)
    in_file = motion_stage(model, STEP).independent_rates(state, at.x, at.inputs)
    assert float(ca.norm_2(found - in_file)) > 1e-3 * float(ca.norm_2(found))


@pytest.mark.slow
def test_a_body_on_two_rods_is_brought_to_rest() -> None:
    push = {**PULL, "position": [0, 0, 0], "force": [0, 0, 0], "moment": [0, 0, 0]}
    plate = {"name": "plate", "mass": 0.3, "inertia": np.diag([0.03, 0.03, 0.03]).tolist()}
    joints = [joint("a", position=[0, 0, 0]), joint("b", "spherical", position=[0.2, 0, 0])]
    rods = [rod("a", "planar"), rod("b", "planar", base={"position": [0.2, 0, 0]})]
    tables = scene(*rods, loads=[push], bodies=[plate], joints=joints, inputs=["pull.force"])
    model = build(scene_from_dict(tables), moving=True)
    rest = solve(model, raise_on_failure=True)
    stage = motion_stage(model, 0.05, radau(2))
    opti = ca.Opti()
    states = [ca.MX(ca.DM(stage.state(rest.x)))]
    force = ca.MX(ca.DM(rest.inputs))
    cost = ca.MX(0)
    for _ in range(4):
        unknowns = opti.variable(stage.unknowns_size)
        rate = opti.variable(3)
        opti.set_initial(unknowns, stage.still(rest.x))
        opti.subject_to(stage.equations(states[-1], unknowns, force, inputs_rate=rate) == 0)
        following = opti.variable(stage.state_size)
        opti.set_initial(following, stage.state(rest.x))
        opti.subject_to(following == stage.next_state(states[-1], unknowns))
        states.append(following)
        force += stage.duration * rate
        cost += ca.sumsqr(rate)
    # A short way: on a long one IPOPT wanders before it settles, and counts of its iterations tell nothing.
    goal = float(np.ravel(rest.body("plate").position)[0]) + 0.01
    opti.subject_to(model.body["plate"](stage.x(states[-1]), force)[0][0] == goal)
    # Were all rates asked to vanish, those of the rods would follow from those of the body: too many equations.
    opti.subject_to(stage.independent_rates(states[-1], rest.x, rest.inputs) == 0)
    opti.minimize(cost)
    opti.solver("ipopt", {**IPOPT, "ipopt.tol": 1e-8, "ipopt.max_iter": 20})
    found = opti.solve()
    speeds = [np.abs(found.value(stage.v(state))).max() for state in states]
    # Constraints are kept in positions: rates of a step leave them by its error.
    assert speeds[-1] < 2e-3 * max(speeds)


def test_parameters_have_the_values_of_the_scene() -> None:
    plain = task()
    scene = plain.stage.model.scene.model_copy(update={"parameters": ("arm.material.youngs_modulus",)})
    stage = motion_stage(build(scene, plain.stage.model.discretisation, moving=True), STEP)
    rng = np.random.default_rng(1)
    arguments = [rng.normal(scale=0.1, size=symbol.shape) for symbol in plain.stage.symbols]
    found, expected = (own.equations.function(*arguments) for own in (stage, plain.stage))
    assert_allclose(found, expected, rtol=1e-10, atol=1e-10)


def test_what_is_like_in_size_is_given_by_name() -> None:
    """Rates beyond the third argument have a name, so have parameters, which not every stage takes."""
    plain = task()
    at = plain.start, plain.stage.still(plain.near.x), plain.near.inputs
    still = np.zeros(plain.stage.model.inputs.size)
    with pytest.raises(TypeError, match="positional argument"):
        plain.stage.equations(*at, still)  # type: ignore[misc]
    with pytest.raises(ValueError, match="takes no parameters: leave p out"):
        plain.stage.equations(*at, inputs_rate=still, p=[1.0])
    scene = plain.stage.model.scene.model_copy(update={"parameters": ("arm.material.youngs_modulus",)})
    of_parameters = build(scene, plain.stage.model.discretisation, moving=True)
    stage = motion_stage(of_parameters, STEP, parameters=True)
    with pytest.raises(ValueError, match="give them as p"):
        stage.equations(*at, inputs_rate=still)
    found = stage.equations(*at, inputs_rate=still, p=of_parameters.parameters.pack())
    assert_allclose(found, plain.stage.equations(*at, inputs_rate=still), rtol=1e-10, atol=1e-10)
