"""The environment of Gymnasium over the step in C."""

import dataclasses
import itertools

import gymnasium
import numpy as np
import pytest
from gymnasium.envs.registration import load_env_creator
from gymnasium.utils.env_checker import check_env
from numpy.testing import assert_allclose, assert_array_equal

from cosserat_casadi import build, parse_scene, solve
from cosserat_casadi.environments import REACH, ReachEnvironment
from cosserat_casadi.environments.reach import _chosen
from cosserat_casadi.errors import SceneError
from cosserat_casadi.numerics.collocation import radau
from cosserat_casadi.numerics.integration import StepOutcome, StepSettings
from cosserat_casadi.numerics.motion_equations import Instant
from cosserat_casadi.numerics.time_steps import integrate
from tests.codegen.motions import equations

SCENE = """
schema = 1
[accuracy]
modes = 1
nodes = 4
[[rods]]
name = "finger"
length = 0.1
strain = "kirchhoff"
material = { youngs_modulus = 1.2e6, poisson_ratio = 0.48, density = 1070.0 }
section = { shape = "circle", radius = 7e-3 }
damping = { retardation_time = 0.01 }
base = { tangent = [1, 0, 0] }
[[loads]]
name = "weight"
kind = "gravity"
acceleration = [0, 0, -9.81]
[[actuators]]
name = "flexor"
kind = "tendon"
rod = "finger"
tension = 0.1
offset = [-5e-3, 0.0]
[[actuators]]
name = "abductor"
kind = "tendon"
rod = "finger"
tension = 0.1
offset = [0.0, 5e-3]
"""
BOUNDS = """
[[bounds]]
input = "flexor.tension"
lower = 0.0
upper = 1.0
[[bounds]]
input = "abductor.tension"
lower = 0.0
upper = 0.5
"""
FORWARD = np.array([1.0, -1.0])


@pytest.fixture(scope="module")
def environment():
    return ReachEnvironment(parse_scene(SCENE + BOUNDS), duration=0.5)


def test_gymnasium_finds_no_fault(environment):
    check_env(environment, skip_render_check=True)


def test_its_name_is_registered():
    assert load_env_creator(gymnasium.spec(REACH).entry_point) is ReachEnvironment


@pytest.mark.slow
def test_it_is_made_by_name():
    made = gymnasium.make(REACH, scene=parse_scene(SCENE + BOUNDS), duration=0.1)
    observation, _ = made.reset(seed=1)
    assert made.observation_space.contains(observation)
    assert made.action_space.shape == (2,)


@pytest.mark.slow
def test_modes_are_chosen_for_where_the_actions_go():
    """The abductor, which rests at the scene's own inputs, bends the finger out of its plane."""
    text = SCENE.replace("modes = 1\nnodes = 4\n", "tolerance = 1e-5\n").replace("tension = 0.1", "tension = 0.0")
    scene = parse_scene(text + BOUNDS)
    pulled = {"abductor.tension": 0.5, "flexor.tension": 1.0}
    own = solve(scene).model.discretisation
    assert solve(build(scene, own), pulled).error_estimate > 1e-5
    discretisation, error = _chosen(scene)
    assert error <= 1e-5
    assert solve(build(scene, discretisation), pulled).error_estimate <= 1e-5
    assert _chosen(parse_scene(SCENE + BOUNDS))[1] is None


def test_start_is_the_equilibrium(environment):
    observation, _ = environment.reset(seed=0)
    found = environment.library.solve(environment.model.pack())
    tip = environment.model.tip["finger"](found.x, environment.model.pack())[0].full().ravel()
    assert_allclose(observation[:3], tip, rtol=0.0, atol=1e-12)
    assert_array_equal(observation[3:6], 0.0)
    # Tensions of 0.1 N in ranges up to 1 N and 0.5 N.
    assert_allclose(observation[6:8], [-0.8, -0.6], rtol=0.0, atol=1e-12)


def test_target_is_reached_by_the_inputs_that_hold_it(environment):
    inputs = environment.model.pack({"flexor.tension": 0.8, "abductor.tension": 0.3})
    held = environment.library.solve(inputs)
    target = environment.model.tip["finger"](held.x, inputs)[0].full().ravel()
    environment.reset(seed=0, options={"target": target})
    rewards = []
    for _ in range(25):
        _, reward, terminated, truncated, info = environment.step(np.array([0.6, 0.2]))
        rewards.append(reward)
        assert not terminated
    assert truncated
    assert rewards[0] < -0.01
    assert_allclose(rewards[-1], 0.0, rtol=0.0, atol=1e-3)
    assert_allclose(info["distance"], -0.1 * rewards[-1], rtol=1e-12, atol=0.0)


def test_velocity_is_the_change_of_position(environment):
    environment.reset(seed=0)
    positions = []
    velocities = []
    for _ in range(4):
        observation = environment.step(FORWARD)[0]
        positions.append(observation[:3])
        velocities.append(observation[3:6])
    # Simpson's rule over two control periods.
    moved = positions[2] - positions[0]
    period = environment.dt * 10
    integral = period / 3 * (velocities[0] + 4 * velocities[1] + velocities[2])
    assert np.linalg.norm(moved) > 1e-4
    assert_allclose(moved, integral, rtol=0.0, atol=0.03 * np.linalg.norm(moved))


def test_same_seed_gives_the_same_episode(environment):
    episodes = []
    for _ in range(2):
        observation, _ = environment.reset(seed=7)
        environment.action_space.seed(7)
        rows = [observation]
        rows += [environment.step(environment.action_space.sample())[0] for _ in range(5)]
        episodes.append(np.array(rows))
    assert_array_equal(episodes[0], episodes[1])


def test_a_period_evaluates_the_tip_once_and_takes_its_arguments_apart_once(environment, monkeypatch):
    """Ten steps in C are ten calls of one function: their arguments take longer in Python than the steps in C."""
    environment.reset(seed=1)
    counted = {"tip": 0, "arguments": 0}
    tip = environment._seen
    packed = environment.library._packed

    def seen(*arguments):
        counted["tip"] += 1
        return tip(*arguments)

    def pack(state):
        counted["arguments"] += 1
        return packed(state)

    monkeypatch.setattr(environment, "_seen", seen)
    monkeypatch.setattr(type(environment.library), "_packed", lambda self, state: pack(state))
    environment.step(FORWARD)
    assert environment._steps == 10
    assert counted == {"tip": 1, "arguments": 1}


def test_random_targets_differ_and_are_in_reach(environment):
    targets = []
    for seed in range(5):
        observation, _ = environment.reset(seed=seed)
        targets.append(observation[8:])
    assert np.ptp(targets, axis=0).max() > 1e-3
    assert np.all(np.linalg.norm(targets, axis=1) <= 0.1 + 1e-12)


def test_episode_ends_with_a_sentence_where_a_step_cannot_be_computed(environment):
    environment.reset(seed=0)
    state = environment._episode.state
    environment._episode.state = dataclasses.replace(state, v=np.full_like(state.v, np.inf))
    _, _, terminated, truncated, info = environment.step(FORWARD)
    assert terminated
    assert not truncated
    assert info["status"]


@pytest.mark.parametrize(
    ("scene", "rod", "words"),
    [
        (SCENE, None, "flexor.tension has no range"),
        (SCENE + BOUNDS, "arm", "no rod 'arm'"),
        (SCENE + BOUNDS.replace("upper = 1.0", ""), None, "flexor.tension has no range"),
    ],
)
def test_what_cannot_be_is_refused(scene, rod, words):
    with pytest.raises(SceneError, match=words):
        ReachEnvironment(parse_scene(scene), rod)


@pytest.mark.parametrize("action", [[0.5], [0.5, np.nan]])
def test_an_action_that_is_none_is_refused(environment, action):
    environment.reset(seed=0)
    with pytest.raises(ValueError, match="action must have"):
        environment.step(np.array(action))


def test_a_target_that_is_none_is_refused(environment):
    with pytest.raises(ValueError, match="target must have 3 numbers, got 2"):
        environment.reset(options={"target": [0.1, 0.0]})
    with pytest.raises(ValueError, match="target must have finite numbers"):
        environment.reset(options={"target": [0.1, 0.0, np.inf]})


def test_times_must_be_positive():
    with pytest.raises(ValueError, match="must be > 0"):
        ReachEnvironment(parse_scene(SCENE + BOUNDS), period=0.0)


MOVING = (
    SCENE
    + """
[[bounds]]
input = "finger.base.position"
lower = [-0.02, 0.0, 0.0]
upper = [0.02, 0.0, 0.0]
[[bounds]]
input = "flexor.tension"
lower = 0.0
upper = 1.0
"""
)


@pytest.fixture(scope="module")
def on_slide():
    """A finger whose base slides."""
    scene = 'inputs = ["finger.base.position", "flexor.tension"]\n' + MOVING
    return ReachEnvironment(parse_scene(scene), duration=0.5)


@pytest.mark.slow
def test_gymnasium_finds_no_fault_in_a_base_that_slides(on_slide):
    assert on_slide.observation_space.shape == (12,)
    check_env(on_slide, skip_render_check=True)


@pytest.mark.slow
def test_a_base_moves_with_a_rate_that_does_not_jump(on_slide):
    """Half way between the last two actions at the end of a period, with the rate that leads from one to the other."""
    on_slide.reset(seed=0)
    base = on_slide.model.inputs.slices["finger.base.position"].start
    aims = [0.0, 0.5, -1.0, 1.0, 1.0]
    for before, aim in itertools.pairwise(aims):
        observation, *_ = on_slide.step(np.array([aim, 0.0]))
        episode = on_slide._episode
        assert_allclose(episode.inputs[base], 0.02 * (before + aim) / 2, rtol=0, atol=1e-14)
        assert_allclose(episode.inputs_rate[base], 0.02 * (aim - before) / on_slide.period, rtol=0, atol=1e-12)
        assert_allclose(observation[6:9], [(before + aim) / 2, 0.0, aim], rtol=0, atol=1e-12)


@pytest.mark.slow
def test_a_base_that_slides_vs_simulator(on_slide):
    """The rod lags behind the base by its inertia: the same motion as by the method of order five in Python."""
    on_slide.reset(seed=0)
    model = on_slide.model
    base = model.inputs.slices["finger.base.position"].start
    period = on_slide.period
    state = on_slide._episode.state
    now = Instant(0.0, state.x, state.v, state.a)
    aims = [0.0, 0.5, 1.0, 0.2]
    inputs = model.pack()
    rate = np.zeros_like(inputs)
    actions = [np.array([aim, -0.8]) for aim in aims[1:]]
    for (before, aim), action in zip(itertools.pairwise(aims), actions, strict=True):
        on_slide.step(action)
        acceleration = np.zeros_like(inputs)
        acceleration[base] = (0.02 * (aim - before) / period - rate[base]) / period
        system = equations(model, inputs, rate, acceleration)
        settings = StepSettings(np.full(model.size, 1e-9), first=period / 50, longest=period / 10)
        moved = integrate(system, now, period, radau(3), settings)
        assert moved.outcome is StepOutcome.COMPLETED
        now = dataclasses.replace(moved.end, time=0.0)
        inputs = inputs + period * rate + period**2 / 2 * acceleration
        rate = rate + period * acceleration
    found = on_slide._episode
    assert np.abs(now.x - state.x).max() > 1e-2
    assert_allclose(found.state.x, now.x, rtol=0, atol=2e-3 * np.abs(now.x).max())
    assert_allclose(found.state.v, now.v, rtol=0, atol=5e-3 * np.abs(now.v).max())
