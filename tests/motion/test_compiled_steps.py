"""Steps that C takes are those of Python: where they lead, what they cost, how they end."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from cosserat_casadi import MotionOutcome, build, read_scene, scene_from_dict, simulate
from cosserat_casadi.compiling.scalar_program import scalar_program
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.centred_coordinates import can_be_centred
from cosserat_casadi.motion.compiled_steps import MOST_TRIES, CompiledSteps
from cosserat_casadi.motion.motion_compiler import MotionCompiler
from cosserat_casadi.motion.repeated_call import RepeatedCall
from cosserat_casadi.motion.simulate import Simulator, started
from cosserat_casadi.motion.step_kernels import StepKernels, interpreted
from cosserat_casadi.motion.steps_library import positions_at, steps_are_loaded
from cosserat_casadi.motion.trajectory import StepStatistics
from cosserat_casadi.numerics.collocation import radau
from cosserat_casadi.numerics.consistent_start import consistent_start
from cosserat_casadi.numerics.integration import Integration, StepOutcome, StepSettings
from cosserat_casadi.numerics.motion_equations import Instant, MotionEquations
from cosserat_casadi.numerics.step import HeldTimes, StepRows
from cosserat_casadi.numerics.time_steps import Stepper, integrate
from tests.codegen.test_load import needs_compiler
from tests.motion.test_motion_compiler import arm, moving
from tests.numerics.moving import DUFFING, PENDULUM, Top, TurningPair, duffing_force, explicit, pendulum_state

pytestmark = needs_compiler

SAME = 1e-10

Run = Callable[[Stepper | None], Integration]


def run_of(equations: MotionEquations, x: Any, v: Any, end: float, tolerance: float = 1e-5, **options: Any) -> Run:
    """The motion as a function of what takes its steps."""
    start = Instant(0.0, np.asarray(x, dtype=float), np.asarray(v, dtype=float), np.zeros(equations.size))
    if equations.linearised(start).finite and options.pop("consistent", True):
        start = consistent_start(equations, 0.0, start.x, start.v, interval=0.02).instant
    settings = StepSettings(np.full(equations.size, tolerance), **options.pop("settings", {}))

    def run(stepper: Stepper | None) -> Integration:
        return integrate(equations, start, end, radau(3), settings, **options, stepper=stepper)

    return run


def assert_same(run: Run, outcome: StepOutcome = StepOutcome.COMPLETED, atol: float = SAME) -> Integration:
    """Both ways of a motion, compared step by step; the one in C is returned.

    Rounding of an error makes another size of the next step: states are compared at one time.
    """
    plain, in_c = run(None), run(CompiledSteps)
    assert plain.outcome is in_c.outcome is outcome
    # An interrupt leaves out the work on the step that it fell into.
    if outcome is not StepOutcome.INTERRUPTED:
        assert work_of(in_c) == work_of(plain)
    for mine, other in zip(in_c.steps, plain.steps, strict=True):
        expected = other.at(mine.end.time)
        assert mine.iterations == other.iterations
        assert_allclose(mine.size, other.size, rtol=1e-6, atol=0)
        assert_allclose(mine.end.x, expected.x, rtol=SAME, atol=atol)
        assert_allclose(mine.end.v, expected.v, rtol=SAME, atol=atol)
        assert_allclose(mine.error, other.error, rtol=1e-5, atol=1e-7)
    assert_allclose(in_c.next_size, plain.next_size, rtol=1e-6, atol=0)
    return in_c


def work_of(integration: Integration) -> tuple[int, ...]:
    """Factorisations apart: whether two halves of what is left of a piece are equal is rounding."""
    cost = integration.statistics
    return cost.steps, cost.rejected, cost.iterations, cost.jacobians


def test_steps_are_the_same_over_many_calls() -> None:
    taken = assert_same(run_of(DUFFING, [1.0], [0.3], 30.0, 1e-6), atol=1e-8)
    assert len(taken.steps) > 2 * MOST_TRIES


def test_steps_that_python_began_are_gone_on_with_in_c() -> None:
    """The rest has the sizes, the guesses and the Jacobian of a motion that Python takes alone."""
    asked = list[tuple[int, float]]()

    def later(iterations: int, share: float) -> Stepper | None:
        asked.append((iterations, share))
        return CompiledSteps if share > 0.4 else None

    for equations, x, v, end in ((DUFFING, [1.0], [0.3], 30.0), (PENDULUM, *pendulum_state(1.0, 0.5), 3.0)):
        asked.clear()
        both = run_of(equations, x, v, end, stepper_after=later)
        alone = run_of(equations, x, v, end)(None)
        joined = both(None)
        assert joined.outcome is StepOutcome.COMPLETED
        assert work_of(joined) == work_of(alone)
        assert 1 < len(asked) < len(joined.steps)
        assert asked[-2][1] <= 0.4 < asked[-1][1]
        assert_allclose(joined.end.x, alone.end.x, rtol=0, atol=1e-8)
        # What C has taken over leaves no trace: the first step of its own is as long as that of Python.
        sizes = [[step.size for step in list(taken.steps)[: len(asked) + 1]] for taken in (joined, alone)]
        assert_allclose(*sizes, rtol=1e-6, atol=0)


def test_multipliers_and_directions_without_mass() -> None:
    assert_same(run_of(PENDULUM, *pendulum_state(1.0, 0.5), 3.0))
    top = Top(np.array([1.0, 2.0, 2.5]))
    turning = np.array([0.0, 0.2, 1.0, 0.3])
    assert_same(run_of(top.equations, [1.0, 0.0, 0.0, 0.0], turning, 2.0))
    light = TurningPair(light=1e-4).equations
    assert_same(run_of(light, [0.0, 0.0, 0.0, 0.02, 0.01], [0.0, 0.0, 4.0, 0.0, 0.0], 0.3, 1e-4), atol=1e-7)


def test_positions_over_time_are_read_by_c() -> None:
    """At ends of steps they are the ends, which may have been put right."""
    taken = StepRows.of(run_of(PENDULUM, *pendulum_state(1.0, 0.5), 3.0)(CompiledSteps).steps)
    moved = replace(taken, ends=taken.ends + 1.0)
    times = np.concatenate([np.linspace(0.0, 2.99, 50), taken.end_times])
    held = HeldTimes(moved, np.searchsorted(taken.end_times, times), times)
    assert steps_are_loaded()
    assert_allclose(positions_at(held), held.positions(), rtol=1e-13, atol=1e-13)
    assert_array_equal(positions_at(held)[50:], moved.ends[:, 0])


def test_a_step_whose_complex_matrix_alone_is_singular_is_tried_shorter() -> None:
    """Of one of two oscillators p is a root of K + p C + p² M at the first size; rotated, no row is zero."""
    first = 0.1
    rate = complex(radau(3).eigenvalues[1]) ** -1 / first
    turned = np.array([[0.8, -0.6], [0.6, 0.8]])
    stiffness = turned @ np.diag([abs(rate) ** 2, 1.0]) @ turned.T
    damping = turned @ np.diag([-2.0 * rate.real, 0.1]) @ turned.T
    grows = explicit(
        lambda t, x, v: -stiffness @ x - damping @ v, lambda t, x, v: -stiffness, lambda t, x, v: -damping, size=2
    )
    taken = assert_same(run_of(grows, [1e-3, 1e-3], [0.0, 0.0], 0.3, 1e-2, settings={"first": first}), atol=1e-7)
    assert taken.statistics.rejected > 0
    assert taken.steps[0].size < 0.2 * first


def test_kinks_are_seen() -> None:
    pulsed = explicit(
        lambda t, x, v: -x + np.interp(t, [0.499, 0.5, 0.501], [0.0, 100.0, 0.0]),
        lambda t, x, v: -np.eye(1),
        lambda t, x, v: np.zeros((1, 1)),
    )
    seen = assert_same(run_of(replace(pulsed, kinks=(0.499, 0.5, 0.501)), [0.0], [0.0], 1.0))
    assert_allclose(seen.end.x, 0.1 * np.sin(0.5), rtol=0, atol=1e-4)


def test_errors_of_short_steps_act_for_a_while() -> None:
    """In a blow of microseconds; without that time the steps through it are fewer, in C as in Python."""

    def blow(t: float, x: FloatArray, v: FloatArray) -> FloatArray:
        return np.array([1e6 * np.exp(-((t * 1e6 - 3.0) ** 2))])

    equations = explicit(blow, lambda t, x, v: np.zeros((1, 1)), lambda t, x, v: np.zeros((1, 1)))
    steps = []
    for lasting in (0.0, 1e-3):
        settings = {"first": 1e-7, "lasting": lasting}
        run = run_of(equations, [0.0], [0.0], 1.0, 1e-6, settings=settings)
        steps.append(len(assert_same(run, atol=1e-8).steps))
    assert steps[1] > steps[0]


def test_short_steps_are_solved_more_exactly() -> None:
    iterations = []
    for drifting in (0.0, 10.0):
        taken = assert_same(run_of(DUFFING, [1.0], [0.3], 3.0, 1e-6, settings={"drifting": drifting}), atol=1e-8)
        iterations.append(taken.statistics.iterations)
    assert iterations[1] > iterations[0]


def test_what_is_looked_at_after_each_step() -> None:
    times: list[float] = []

    def settled(step: Any) -> Instant:
        return replace(step.end, a=1.01 * step.end.a)

    guarded = run_of(DUFFING, [1.0], [0.3], 6.0, guards=lambda instant: instant.x + 0.5)
    stopped = assert_same(guarded, StepOutcome.GUARDED)
    assert_allclose(stopped.end.x, -0.5, rtol=0, atol=1e-12)
    assert_same(run_of(DUFFING, [1.0], [0.3], 2.0, settled=settled, after_step=lambda time, _: times.append(time)))
    assert times[: len(times) // 2] == pytest.approx(times[len(times) // 2 :], rel=SAME)


def test_motion_goes_on_with_the_same_steps() -> None:
    first = assert_same(run_of(DUFFING, [1.0], [0.3], 1.0))
    assert first.memory is not None

    def rest(stepper: Stepper | None) -> Integration:
        settings = StepSettings(np.full(1, 1e-5))
        return integrate(DUFFING, first.end, 2.0, radau(3), settings, memory=first.memory, stepper=stepper)

    assert_same(rest)


def test_failures_are_told_the_same() -> None:
    zero = lambda *_: np.zeros((1, 1))  # noqa: E731
    endless = explicit(lambda t, x, v: 6 * x**2, lambda t, x, v: np.diag(12 * x), zero)
    short = {"settings": {"shortest": 1e-4}}
    assert_same(run_of(endless, [1.0], [2.0], 2.0, 1e-4, **short), StepOutcome.STEP_TOO_SMALL, atol=1e-6)
    rooted = explicit(lambda t, x, v: 0.0 * np.sqrt(1 - x), zero, zero)
    assert_same(run_of(rooted, [0.0], [1.0], 2.0), StepOutcome.NOT_FINITE)
    stiffness = np.array([[0.0, 1.0, 1.0], [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    twice = MotionEquations(
        np.array([True, False, False]),
        lambda t, x, v, a: np.array([a[0] + x[1] + x[2], x[0], x[0]]),
        lambda *_: (stiffness, np.zeros((3, 3)), np.diag([1.0, 0.0, 0.0])),
    )
    assert_same(run_of(twice, np.zeros(3), np.zeros(3), 1.0, consistent=False), StepOutcome.SINGULAR)
    broken = explicit(lambda t, x, v: -x, lambda t, x, v: np.full((1, 1), np.nan), zero)
    assert_same(run_of(broken, [1.0], [0.0], 1.0), StepOutcome.STEP_TOO_SMALL)


def test_motion_that_crawls_is_given_up() -> None:
    stiff = (2e6 * np.pi) ** 2
    spring = explicit(lambda t, x, v: -stiff * x, lambda t, x, v: -stiff * np.eye(1), lambda *_: np.zeros((1, 1)))
    crawling = run_of(spring, [1.0], [0.0], 1.0, 1e-8)(CompiledSteps)
    assert crawling.outcome is StepOutcome.TOO_MANY_STEPS
    assert crawling.statistics.steps < 1200


@pytest.mark.parametrize("raised", [KeyboardInterrupt, ZeroDivisionError])
def test_what_the_equations_raise_is_raised(raised: type[BaseException]) -> None:
    def force(t: float, x: FloatArray, v: FloatArray) -> FloatArray:
        if t > 1.0:
            raise raised
        return duffing_force(t, x, v)

    run = run_of(
        explicit(force, lambda t, x, v: np.diag(-1 - 3 * x**2), lambda *_: -0.1 * np.eye(1)), [1.0], [0.3], 2.0
    )
    if raised is ZeroDivisionError:
        with pytest.raises(ZeroDivisionError):
            run(CompiledSteps)
        return
    assert_same(run, StepOutcome.INTERRUPTED)


class Kernels:
    """Kernels of a model as a source has them."""

    def __init__(self, kernels: StepKernels) -> None:
        self.chosen = kernels

    def kernels(self, model: Any) -> StepKernels:
        return self.chosen

    def library(self, model: Any) -> str | None:
        return self.chosen.library

    def learn(self, statistics: StepStatistics) -> None:
        pass


@pytest.mark.parametrize("always", [False, True], ids=["virtual machine", "machine code"])
def test_rod_that_a_tendon_moves(always: bool, tmp_path: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Inputs change, arguments are written in place, and machine code is called without Python."""
    monkeypatch.setenv("COSSERAT_CASADI_CACHE", str(tmp_path))
    model = moving(arm())
    kernels = MotionCompiler(always=always).kernels(model)
    assert kernels.stepper is CompiledSteps
    simulation = model.scene.simulation
    assert simulation is not None
    ends = []
    for chosen in (kernels, replace(kernels, stepper=None)):
        history = Simulator(model, simulation, started(model, simulation, None), source=Kernels(chosen)).controlled(
            1e-5
        )
        assert history.completed
        ends.append((history.statistics, history.end))
    (in_c, at), (plain, expected) = ends
    assert (in_c.steps, in_c.rejected, in_c.jacobians) == (plain.steps, plain.rejected, plain.jacobians)
    assert_allclose(at.x, expected.x, rtol=0, atol=1e-8)
    assert_allclose(at.v, expected.v, rtol=0, atol=1e-6)


def test_kinks_of_a_record_are_evaluated_by_a_program() -> None:
    """Programs compute four kinks at once, the virtual machine one after the other, to the same digits."""
    times = np.linspace(0.0, 0.2, 200)
    tensions = 2.0 + 4.0 * np.sin(8.0 * times) ** 2 + 0.1 * np.sin(900.0 * times)
    recorded = {"input": "flexor.tension", "times": times.tolist(), "values": tensions.tolist()}
    model = moving({**arm(), "motions": [recorded]})
    simulation = model.scene.simulation
    assert simulation is not None
    found = []
    for program in (None, scalar_program(model.inverse_dynamics_in_scalars)):
        kernels = replace(interpreted(model), stepper=CompiledSteps)
        assert isinstance(kernels.residual, RepeatedCall)
        kernels.residual.program = program
        simulator = Simulator(model, simulation, started(model, simulation, None), source=Kernels(kernels))
        found.append(simulator.controlled(1e-4))
    one_by_one, at_once = found
    assert at_once.completed
    assert at_once.statistics.steps < 150
    for mine, expected in zip(at_once.rows, one_by_one.rows, strict=True):
        assert_allclose(mine.facts[:, :4], expected.facts[:, :4], rtol=1e-9, atol=0)
        assert_allclose(mine.ends[:, 0], expected.ends[:, 0], rtol=0, atol=1e-12)


@pytest.mark.parametrize("as_program", [False, True], ids=["virtual machine", "program"])
@pytest.mark.parametrize("example", ["bouncing_rod", "rod_hits_floor"])
def test_steps_in_exact_contact(example: str, as_program: bool) -> None:
    """C takes the forces of contacts itself; of a rod that nothing holds in coordinates that no program has."""
    scene = read_scene(f"examples/{example}.toml", ["accuracy.modes=2", "accuracy.nodes=8"])
    assert scene.simulation is not None
    simulation = scene.simulation.model_copy(update={"duration": 0.33})
    model = build(scene.with_motion_inputs(), moving=True)
    found = []
    for stepper in (None, CompiledSteps):
        kernels = replace(interpreted(model), stepper=stepper)
        assert isinstance(kernels.residual, RepeatedCall)
        if as_program and not can_be_centred(model):
            kernels.residual.program = scalar_program(model.inverse_dynamics_in_scalars)
        simulator = Simulator(model, simulation, started(model, simulation, None), source=Kernels(kernels))
        # At 1e-5 rounding decides whether the step to the lift-off of rod_hits_floor ends on it or by its first guess.
        history = simulator.controlled(1e-6)
        assert history.completed
        found.append(history)
    plain, in_c = found
    assert [event.kind for event in plain.events][:2] in (["impact", "lift_off"], ["impact", "impact"])
    for mine, expected in zip(in_c.events, plain.events, strict=True):
        assert (mine.kind, mine.owner) == (expected.kind, expected.owner)
        assert_allclose([mine.time, mine.place], [expected.time, expected.place], rtol=0, atol=1e-7)
    assert_allclose(in_c.end.x, plain.end.x, rtol=0, atol=1e-7)


def test_without_a_compiler_python_takes_the_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = scene_from_dict(arm())
    in_c = simulate(scene)
    monkeypatch.setenv("CC", "no-compiler-of-this-name")
    plain = simulate(scene)
    assert plain.outcome is in_c.outcome is MotionOutcome.COMPLETED
    assert_allclose(plain.x, in_c.x, rtol=0, atol=1e-4)
