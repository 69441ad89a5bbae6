"""Motions in machine code: the same equations, where they are compiled, and what the cache is asked by."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import cosserat_casadi
from cosserat_casadi import ExportError, Model, build, read_scene, scene_from_dict, simulate
from cosserat_casadi.compiling import description, printed_files
from cosserat_casadi.compiling.cache import tallied
from cosserat_casadi.compiling.scalar_program import ScalarProgram
from cosserat_casadi.maths.calls import evaluated
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion import contact_law
from cosserat_casadi.motion.compiled_steps import FEW_TRIES, CompiledSteps
from cosserat_casadi.motion.constraint_projection import functions_of_closing
from cosserat_casadi.motion.contact_forces import Follower, MovingContact
from cosserat_casadi.motion.contact_guards import ContactPhase
from cosserat_casadi.motion.displacement import displacements
from cosserat_casadi.motion.exact_contact import ExactContacts
from cosserat_casadi.motion.facings import touching_points
from cosserat_casadi.motion.history import equations_of, free_flight, functions_of_flight, integrated
from cosserat_casadi.motion.kernel_residual import KernelResidual
from cosserat_casadi.motion.motion_compiler import (
    JACOBIANS,
    RESIDUAL,
    TO_COMPILE_STEPS,
    MotionCompiler,
    functions_of_limits,
)
from cosserat_casadi.motion.repeated_call import RepeatedCall
from cosserat_casadi.motion.simulate import moving_inputs, started
from cosserat_casadi.motion.step_kernels import StepKernels, interpreted, interpreted_jacobians, interpreted_residual
from cosserat_casadi.motion.steps_library import stem_of_steps, steps_are_loaded, steps_library
from cosserat_casadi.motion.tip_paths import function_of_paths, paths
from cosserat_casadi.motion.trajectory import StepStatistics
from cosserat_casadi.numerics import time_steps
from cosserat_casadi.numerics.collocation import radau
from cosserat_casadi.numerics.integration import StepOutcome, StepSettings
from cosserat_casadi.numerics.motion_equations import Instant, MotionEquations
from cosserat_casadi.numerics.step_control import StepControl
from cosserat_casadi.numerics.step_run import StepRun
from tests.codegen.test_load import needs_compiler
from tests.families import mostly_slow
from tests.moving_scenes import FAMILIES, model_of
from tests.scenes import WEIGHT, push, rod

pytestmark = needs_compiler


@pytest.fixture(autouse=True)
def kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty cache, and sources that no one edits while the tests run."""
    monkeypatch.setenv("COSSERAT_CASADI_CACHE", str(tmp_path / "kept"))
    monkeypatch.setattr(cosserat_casadi, "IMPORTED", time.time() + 3600)
    description.hash_at_first_use.cache_clear()
    return tmp_path / "kept"


def arm(stiffness: float = 1.0, **simulation: Any) -> dict[str, Any]:
    """A planar rod that a tendon moves."""
    return {
        "schema": 1,
        "rods": [rod("planar", stiffness={"bending_y": stiffness})],
        "loads": [WEIGHT, push()],
        "actuators": [{"name": "flexor", "kind": "tendon", "rod": "rod", "offset": [0.02, 0.0], "tension": 2.0}],
        "accuracy": {"modes": 3, "nodes": 6},
        "motions": [{"input": "flexor.tension", "times": [0.0, 0.1], "values": [2.0, 6.0], "interpolation": "cubic"}],
        "simulation": {"duration": 0.2, "tolerance": 1e-4, **simulation},
    }


def moving(tables: dict[str, Any]) -> Model:
    return build(scene_from_dict(tables).with_motion_inputs(), moving=True)


def somewhere(model: Model) -> list[FloatArray]:
    """Arguments of inverse dynamics, away from any motion."""
    random = np.random.default_rng(3)
    moved = [scale * random.standard_normal(model.size) for scale in (0.3, 2.0, 20.0)]
    rates = [random.standard_normal(model.inputs.size) for _ in range(2)]
    parameters = [model.parameters.pack()] if model.parameters.size else []
    return [*moved, model.pack(), *parameters, *rates]


def work(iterations: int, jacobians: int) -> StepStatistics:
    return StepStatistics(100, 0, iterations, jacobians, 1e-3, 1e-3)


LITTLE, MUCH, MOST = work(10, 1), work(10**6, 1), work(10**6, 10**6)


def is_compiled(compiler: MotionCompiler, name: str) -> bool:
    return compiler.asked[name][1] is not None


@pytest.mark.parametrize("family", mostly_slow(list(FAMILIES), quick=["driven and held"]))
def test_machine_code_gives_the_same_numbers(family: str) -> None:
    model = model_of(family)
    at = somewhere(model)
    plain, compiled = interpreted(model), MotionCompiler(always=True).kernels(model)
    assert isinstance(compiled.residual, RepeatedCall)
    expected = plain.residual(*at)
    assert_allclose(compiled.residual(*at), expected, rtol=0, atol=1e-14 * np.abs(expected).max())
    for found, matrix in zip(compiled.jacobians(*at), plain.jacobians(*at), strict=True):
        assert found.shape == (model.size, model.size)
        assert_allclose(found, matrix, rtol=0, atol=1e-13 * np.abs(matrix).max())
    assert compiled.library is not None
    for gaps in [] if model.parameters.size else functions_of_closing(model):
        x, inputs = at[0], at[3]
        assert_allclose(ca.external(gaps.name(), compiled.library)(x, inputs), gaps(x, inputs), rtol=0, atol=1e-14)


def test_what_flies_free_takes_its_steps_in_machine_code() -> None:
    """The residual in centred coordinates, the state of the base and momenta: every step calls them."""
    flown = arm()
    base = {"position": [0, 0, 0], "tangent": [1, 0, 0], "free": True}
    flown["rods"][0].update(base=base, rotary_inertia=[1e-4, 1e-4, 2e-4])
    model = moving(flown)
    libraries = MotionCompiler(always=True).kernels(model).libraries
    library = libraries.residual
    plain, compiled = free_flight(model), free_flight(model, libraries=libraries)
    assert library is not None
    for function in functions_of_flight(model):
        random = np.random.default_rng(5)
        at = [0.3 * random.standard_normal(function.numel_in(i)) for i in range(function.n_in())]
        found = ca.external(function.name(), library)
        expected = function.call(at)[0].full()
        assert_allclose(found.call(at)[0].full(), expected, rtol=0, atol=1e-13 * np.abs(expected).max())
    equations = equations_of(model, moving_inputs(model).pieces(0.2)[0])
    for flight, machine_code in ((plain, False), (compiled, True)):
        residual = flight.in_steps(equations, None)[0].residual
        assert isinstance(residual, KernelResidual)
        assert (residual.call.code is not None) == machine_code


def test_no_program_is_written_where_steps_are_in_centred_coordinates() -> None:
    """Their residual is another function: no step would run the program."""
    flown = arm()
    base = {"position": [0, 0, 0], "tangent": [1, 0, 0], "free": True}
    flown["rods"][0].update(base=base, rotary_inertia=[1e-4, 1e-4, 2e-4])
    for scene, written in ((arm(), True), (flown, False)):
        compiler = MotionCompiler()
        # The work of a motion for which a program pays, and nothing else.
        compiler.learn(work(1500, 1))
        residual = compiler.kernels(moving(scene)).residual
        assert isinstance(residual, RepeatedCall)
        assert residual.library is None
        assert (residual.program is not None) == written
        assert (residual.program_after is not None) == written


def test_machine_code_pays_sooner_where_no_program_runs_in_its_place() -> None:
    flown = arm()
    base = {"position": [0, 0, 0], "tangent": [1, 0, 0], "free": True}
    flown["rods"][0].update(base=base, rotary_inertia=[1e-4, 1e-4, 2e-4])
    for scene, expected in ((arm(), False), (flown, True)):
        compiler = MotionCompiler()
        # Of this work of a motion a program saves four fifths.
        compiler.learn(work(20_000, 1))
        compiler.kernels(moving(scene))
        assert is_compiled(compiler, RESIDUAL) == expected


def test_a_rod_that_touches_has_its_contacts_in_machine_code() -> None:
    """Residual and derivatives with forces of contacts, in centred coordinates."""
    scene = read_scene("examples/rod_hits_floor.toml", ["accuracy.modes=2", "accuracy.nodes=3"])
    model = build(scene.with_motion_inputs(), moving=True)
    kernels = MotionCompiler(always=True).kernels(model)
    assert kernels.library is not None
    assert kernels.derivatives is not None
    piece = moving_inputs(model).pieces(0.2)[0]
    touches = (MovingContact(0, 0.0, slides=False), MovingContact(0, 0.7, slides=False))
    x, v, a = np.random.default_rng(5).standard_normal((3, model.size + len(touches)))
    at = Instant(0.1, 0.3 * x, v, a)

    def with_contacts(kernels: StepKernels) -> MotionEquations:
        contacts = ExactContacts(model, kernels.libraries)
        phase = ContactPhase(touches, follower=Follower(contacts.facings, touches))
        equations, _ = contacts.arranged(equations_of(model, piece, kernels=kernels), piece, phase)
        in_c = [points.gradient.code is not None for points in touching_points(model, kernels.libraries)]
        assert in_c == [kernels.library is not None]
        return free_flight(model, libraries=kernels.libraries).in_steps(equations, None)[0]

    plain, compiled = with_contacts(interpreted(model)), with_contacts(kernels)
    expected = plain.residual_at(at)
    assert_allclose(compiled.residual_at(at), expected, rtol=0, atol=1e-13 * np.abs(expected).max())
    found, known = compiled.linearised(at), plain.linearised(at)
    for name in ("stiffness", "damping", "mass"):
        matrix = getattr(known, name)
        assert_allclose(getattr(found, name), matrix, rtol=0, atol=1e-13 * np.abs(matrix).max())


def test_results_of_a_call_are_kept_by_the_next_one() -> None:
    model = moving(arm())
    kernels = MotionCompiler(always=True).kernels(model)
    at = somewhere(model)
    first, matrices = kernels.residual(*at), kernels.jacobians(*at)
    copies = first.copy(), [matrix.copy() for matrix in matrices]
    kernels.residual(*[2 * array for array in at])
    kernels.jacobians(*[2 * array for array in at])
    assert_array_equal(first, copies[0])
    assert_array_equal(matrices, copies[1])


def test_bodies_and_limits_of_strains_stand_beside_the_residual() -> None:
    hinge = {"kind": "revolute", "axis": [0, 1, 0]}
    joints = [
        {**hinge, "name": "crank", "angle": 0.0, "between": [{"world": True}, {"body": "arm"}]},
        {**hinge, "between": [{"body": "arm", "position": [0.3, 0, 0]}, {"rod": "rod", "at": 0.0}]},
    ]
    model = moving(
        {
            "schema": 1,
            "rods": [rod("planar", base={"tangent": [1, 0, 0]})],
            "bodies": [{"name": "arm", "mass": 0.1, "inertia": [1e-3, 1e-3, 1e-3]}],
            "joints": joints,
            "actuators": [{"name": "flexor", "kind": "tendon", "rod": "rod", "offset": [0.02, 0.0], "tension": 2.0}],
            "accuracy": {"modes": 2, "nodes": 4},
            "motions": [{"input": "crank.angle", "times": [0.0, 0.1], "values": [0.0, 0.2]}],
            "simulation": {"duration": 0.1, "start": "unloaded"},
        }
    )
    library = MotionCompiler(always=True).library(model)
    assert library is not None
    rng = np.random.default_rng(5)
    states = 0.1 * rng.standard_normal((4, model.size))
    inputs = model.pack() + 0.1 * rng.standard_normal((4, model.inputs.size))
    found, expected = paths(model, states, inputs, library), paths(model, states, inputs)
    assert_allclose(found.points, expected.points, rtol=1e-12, atol=1e-13)
    assert_allclose(found.section_axes, expected.section_axes, rtol=1e-12, atol=1e-13)
    position, _, rotation = evaluated(model.body["arm"], states, inputs)
    radius = np.sqrt(3e-3 / (2 * 0.1))
    at_gyration = np.moveaxis(position + radius * rotation, 2, 1) / 0.8
    assert_allclose(found.points[:, -3:], at_gyration, rtol=1e-12, atol=1e-13)
    in_vm = (model.resolution_index, model.strain_margins)
    for in_c, function in zip(functions_of_limits(model), in_vm, strict=True):
        (found_limits,) = evaluated(ca.external(in_c.name(), library), states, inputs)
        (limits,) = evaluated(function, states, inputs)
        assert np.ptp(limits) > 1e-3
        assert_allclose(found_limits, limits, rtol=1e-12, atol=1e-12)


def test_poses_of_tips_and_displacements_stand_beside_the_residual() -> None:
    model = moving(arm())
    compiler = MotionCompiler()
    compiler.kernels(model)
    assert compiler.library(model) is None
    compiler = MotionCompiler(always=True)
    compiler.kernels(model)
    x, _, _, inputs, *_ = somewhere(model)
    library = compiler.library(model)
    assert library is not None
    position, _, rotation = model.tip["rod"](x, inputs)
    in_c = ca.external(function_of_paths(model).name(), library)
    watched = position / model.length("rod", inputs), rotation[:, :2]
    for found, expected in zip(in_c(x, inputs), watched, strict=True):
        assert_allclose(found.full(), expected.full(), rtol=1e-12, atol=1e-14)
    assert_array_equal(displacements(moving(arm()), library), displacements(model))


def test_steps_are_compiled_where_motions_tell_that_it_pays() -> None:
    steps_library.cache_clear()
    model = moving(arm())
    compiler = MotionCompiler()
    assert compiler.kernels(model).stepper is None
    compiler.learn(work(50, 1))
    assert compiler.kernels(model).stepper is None
    # Many short motions, each of which may be a process of its own, are as good a reason as a long one.
    while tallied(stem_of_steps()) < TO_COMPILE_STEPS:
        assert MotionCompiler().kernels(model).stepper is None
        compiler.learn(work(50, 1))
    assert MotionCompiler().kernels(model).stepper is CompiledSteps
    steps_library.cache_clear()
    assert MotionCompiler().kernels(model).stepper is CompiledSteps, "they are in the cache"


def test_steps_of_a_long_motion_are_compiled_for_the_next() -> None:
    steps_library.cache_clear()
    model = moving(arm())
    compiler = MotionCompiler()
    compiler.kernels(model)
    compiler.learn(work(500, 1))
    assert tallied(stem_of_steps()) < TO_COMPILE_STEPS
    assert compiler.kernels(model).stepper is CompiledSteps


def test_steps_are_compiled_within_a_motion_that_takes_long(monkeypatch: pytest.MonkeyPatch) -> None:
    steps_library.cache_clear()
    compiler = MotionCompiler()
    kernels = compiler.kernels(moving(arm()))
    assert kernels.stepper is None
    assert kernels.stepper_after is not None
    # Few iterations, and few at the beginning, tell of no long motion.
    assert kernels.stepper_after(20, 0.5) is None
    assert kernels.stepper_after(500, 0.05) is None
    assert not steps_are_loaded()
    in_python = list[float]()
    plain = time_steps._try_step

    def counted(run: StepRun, control: StepControl, end: float) -> StepOutcome | None:
        in_python.append(end)
        return plain(run, control, end)

    monkeypatch.setattr(time_steps, "_try_step", counted)
    motion = simulate(moving(arm(duration=2.0, tolerance=1e-6)))
    assert motion.converged
    assert steps_are_loaded()
    # The first part of the first motion, whose inputs move for 0.1 s, and a tenth of the second one.
    assert 0.1 < max(in_python) < 0.4
    assert 5 < len(in_python) < 0.3 * motion.statistics.steps


def test_functions_are_compiled_where_the_last_motion_tells_that_it_pays() -> None:
    model = moving(arm())
    compiler = MotionCompiler()
    for last, expected in (
        (None, (False, False)),
        (LITTLE, (False, False)),
        (MUCH, (True, False)),
        (MOST, (True, True)),
    ):
        if last is not None:
            compiler.learn(last)
        compiler.kernels(model)
        assert (is_compiled(compiler, RESIDUAL), is_compiled(compiler, JACOBIANS)) == expected


def test_a_compiler_that_fails_is_run_once(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Every step of Python asks for steps in C: a compiler that fails would be run in each of them."""
    compiler, runs = tmp_path / "compiler", tmp_path / "runs"
    compiler.write_text(f"#!/bin/sh\necho run >> {runs}\nexit 1\n")
    compiler.chmod(0o755)
    monkeypatch.setenv("CC", str(compiler))
    steps_library.cache_clear()
    kernels = MotionCompiler().kernels(moving(arm()))
    assert kernels.stepper_after is not None
    assert [kernels.stepper_after(50000, share) for share in (0.2, 0.3, 0.4)] == [None, None, None]
    assert runs.read_text().split() == ["run"]


@pytest.mark.parametrize("in_one_process", [True, False])
def test_functions_are_compiled_where_motions_of_a_model_have_taken_long(in_one_process: bool) -> None:
    model = moving(arm())
    motions = 0
    while motions < 100:
        motions += 1
        if not in_one_process:
            # A model that shares nothing with the last one knows its time by the cache alone.
            model = moving(arm())
        compiler = MotionCompiler()
        compiler.kernels(model)
        # A search of its own each time, which begins with no motion to foresee the next ones by.
        compiler.learn(work(2500, 1))
        compiler.kernels(model)
        if is_compiled(compiler, RESIDUAL):
            break
    assert 3 < motions < 60
    assert not is_compiled(compiler, JACOBIANS)


def test_a_program_is_written_within_a_motion_that_takes_long_and_changes_no_digit() -> None:
    model = moving(arm())
    residual = MotionCompiler().kernels(model).residual
    assert isinstance(residual, RepeatedCall)
    assert residual.program is None
    assert residual.program_after is not None
    assert residual.program_after(10) is None
    program = residual.program_after(10**6)
    assert program is not None
    size = 0.5 * model.scene.rods[0].length
    assert model.scene.simulation is not None
    start = started(model, model.scene.simulation, None)
    taken = list[int]()

    def later(iterations: int) -> ScalarProgram | None:
        taken.append(iterations)
        return program

    ends = []
    for asked in (None, lambda _: None, later):
        residual = interpreted_residual(model)
        residual.program_after = asked
        kernels = StepKernels(residual, interpreted_jacobians(model), CompiledSteps)
        history = integrated(
            model,
            moving_inputs(model).pieces(0.2),
            start.x,
            np.zeros(model.size),
            radau(3),
            StepSettings(tolerance=1e-7 * size / displacements(model)),
            kernels=kernels,
        )
        assert history.completed
        assert history.statistics.steps > FEW_TRIES
        ends.append(history.end.x)
    assert len(taken) == 1
    assert_array_equal(ends[1], ends[0])
    assert_allclose(ends[2], ends[0], rtol=1e-12, atol=1e-14)


def test_steps_in_c_ask_python_for_neither_inputs_nor_derivatives(monkeypatch: pytest.MonkeyPatch) -> None:
    """Inputs that are cubics and derivatives in machine code; a wave is no cubic, and Python tells it."""

    def not_asked(steps: CompiledSteps, time: float) -> None:
        raise AssertionError("Python is asked for derivatives that machine code has")

    monkeypatch.setattr(CompiledSteps, "_linearise", not_asked)
    waving = arm()
    wave = {"input": "flexor.tension", "amplitude": 2.0, "frequency": 5.0, "wave": "one_minus_cosine"}
    waving["motions"] = [wave]
    for tables, told_by_python in ((arm(), False), (waving, True)):
        model = moving(tables)
        kernels = MotionCompiler(always=True).kernels(model)
        assert model.scene.simulation is not None
        start = started(model, model.scene.simulation, None)
        settings = StepSettings(tolerance=1e-5 / displacements(model))
        ends = []
        for stepper in (None, kernels.stepper):
            pieces = moving_inputs(model).pieces(0.2)
            asked = replace(kernels, stepper=stepper, stepper_after=None)
            at_rest = np.zeros(model.size)
            history = integrated(model, pieces, start.x, at_rest, radau(3), settings, kernels=asked)
            assert history.completed
            steps = sum(step.start.time < 0.1 for _, step in history.steps)
            times_told = pieces[0].remembered.cache_info().misses  # type: ignore[attr-defined]
            # Of both ends at least, of the start of a leg and of nothing else.
            assert (times_told > steps) == (stepper is None or told_by_python)
            ends.append(history.end)
        assert_allclose(ends[1].x, ends[0].x, rtol=0, atol=1e-10)
        assert_allclose(ends[1].v, ends[0].v, rtol=0, atol=1e-8)


def nothing_written(*arguments: Any) -> dict[str, str]:
    raise AssertionError("equations are written that the cache holds")


def test_a_later_motion_of_the_same_rods_takes_them_from_the_cache(monkeypatch: pytest.MonkeyPatch) -> None:
    MotionCompiler(always=True).kernels(moving(arm()))
    monkeypatch.setattr(printed_files, "external_sources", nothing_written)
    other = arm(duration=0.5, tolerance=1e-2)
    other["title"] = "another motion"
    other["motions"][0]["values"] = [1.0, 3.0]
    compiler = MotionCompiler()
    compiler.kernels(moving(other))
    assert is_compiled(compiler, RESIDUAL)
    assert is_compiled(compiler, JACOBIANS)
    for tables in (arm(stiffness=1.1), {**arm(), "accuracy": {"modes": 4, "nodes": 6}}, {**arm(), "loads": [push()]}):
        compiler.kernels(moving(tables))
        assert not is_compiled(compiler, RESIDUAL)
    with pytest.raises(AssertionError, match="cache holds"):
        MotionCompiler(always=True).kernels(moving(arm(stiffness=1.1)))


@pytest.mark.slow
def test_parameters_that_are_bound_have_equations_of_their_own() -> None:
    model = moving({**arm(), "parameters": ["rod.length"]})
    short, long = model.at({"rod.length": 0.5}), model.at({"rod.length": 0.9})
    for bound in (short, long):
        MotionCompiler(always=True).kernels(bound)
        compiled = MotionCompiler().kernels(bound)
        assert isinstance(compiled.residual, RepeatedCall)
        at = somewhere(bound)
        assert_allclose(compiled.residual(*at), interpreted(bound).residual(*at), rtol=1e-12, atol=1e-12)


def test_without_a_compiler_the_virtual_machine_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "no-such-compiler")
    compiler = MotionCompiler(last=MOST)
    compiler.kernels(moving(arm()))
    assert not is_compiled(compiler, RESIDUAL)
    with pytest.raises(ExportError, match="no-such-compiler is not a program"):
        simulate(scene_from_dict(arm()), compiled=True)


def test_without_a_compiler_a_motion_in_exact_contact_says_what_it_needs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "no-such-compiler")
    monkeypatch.setattr(contact_law, "compiled_law", contact_law.compiled_law.__wrapped__)
    floor = {"name": "floor", "kind": "plane", "point": [0, 0, -5], "normal": [0, 0, 1]}
    scene = scene_from_dict({**arm(start="unloaded"), "obstacles": [floor]})
    with pytest.raises(ExportError, match=r"by C code, and no-such-compiler .*; or give each obstacle a width"):
        simulate(scene, compiled=False)


@pytest.mark.slow
def test_compiled_motions_are_the_same_to_the_tolerance() -> None:
    tables = arm()
    plain = simulate(scene_from_dict(tables), compiled=False)
    compiled = simulate(scene_from_dict(tables), compiled=True)
    assert plain.converged
    assert compiled.converged
    assert compiled.statistics.steps == pytest.approx(plain.statistics.steps, rel=0.1)
    length = plain.model.scene.rods[0].length
    bound = (plain.error_estimate + compiled.error_estimate) * length
    assert_allclose(compiled.tip().position, plain.tip().position, rtol=0, atol=bound)
