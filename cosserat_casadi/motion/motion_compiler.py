"""The equations of motion in machine code, if compiling saves time.

A motion calls inverse dynamics and its derivatives thousands of times. In C they take a twentieth to a fifth of the
time of CasADi's virtual machine. To write and compile them takes seconds, once: a later motion of equal rods on equal
modes takes them from the cache, for any inputs and any tolerance. The results of both differ by rounding.
"""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import casadi as ca

from cosserat_casadi.compiling.cache import cache_folder, tallied, tally
from cosserat_casadi.compiling.compiler import compiled_from, compiled_texts, find_compiler, flags_of_machine
from cosserat_casadi.compiling.description import key_of
from cosserat_casadi.compiling.matrix_program import matrix_program
from cosserat_casadi.compiling.printed_kernels import Kernel
from cosserat_casadi.compiling.scalar_program import ScalarProgram, scalar_program
from cosserat_casadi.compiling.straight_program import straight_kernels
from cosserat_casadi.errors import ExportError
from cosserat_casadi.files import sources_hash
from cosserat_casadi.maths.calls import with_dense_results
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.model.function_table import kept_with
from cosserat_casadi.motion.centred_coordinates import can_be_centred
from cosserat_casadi.motion.compiled_steps import CompiledSteps
from cosserat_casadi.motion.constraint_projection import functions_of_closing
from cosserat_casadi.motion.displacement import function_of_displacements
from cosserat_casadi.motion.facings import points_of, touching_points
from cosserat_casadi.motion.history import derivatives_of_flight, functions_of_flight
from cosserat_casadi.motion.moving_points import MovingPoints
from cosserat_casadi.motion.repeated_call import RepeatedCall, external, has_function
from cosserat_casadi.motion.step_kernels import (
    JACOBIANS,
    MATRICES,
    StepKernels,
    dense_jacobians,
    fastest_derivatives,
    interpreted_jacobians,
    interpreted_residual,
)
from cosserat_casadi.motion.steps_library import stem_of_steps, steps_are_at_hand, steps_are_loaded, steps_library
from cosserat_casadi.motion.stops_facing import struck_beside_friction
from cosserat_casadi.motion.surface_sliding import functions_of_sliding
from cosserat_casadi.motion.tip_paths import function_of_paths
from cosserat_casadi.motion.trajectory import StepStatistics
from cosserat_casadi.numerics.collocation import STAGES
from cosserat_casadi.numerics.time_steps import Stepper

RESIDUAL = "motion_residual"
"""Name of inverse dynamics in C, and of its files in the cache."""

AT_STAGES = "motion_residual_at_stages"
"""Name of inverse dynamics at three stages in C."""

MOST_STRAIGHT = 20_000
"""Most instructions of inverse dynamics that is written without loops: more take compilers seconds."""

MOST_LINES = 1.5
"""Most lines for an instruction then: calls for intervals of rods make more, and loops are shorter to compile."""

MARGINS = "motion_margins"
RESOLUTION = "motion_resolution"
"""Names in C of the margins of strains, and of the index that tells whether the nodes resolve the rods."""

PROGRAM = "motion_program"
"""Name of inverse dynamics as a scalar program, for three stages at once."""

INSTRUCTION = 7e-9
"""Time of an instruction of inverse dynamics in CasADi's virtual machine, s: from 5e-9 for few to 11e-9 for many."""

AS_MANY_RESIDUALS = 10.0
"""Time of its derivatives there over that of inverse dynamics, before they are timed: 6 to 15 for one element a rod."""

SAVED = {PROGRAM: 0.9, RESIDUAL: 0.2, JACOBIANS: 0.9}
"""Share of the virtual machine's time saved by a program, by machine code beyond a program, and by machine code."""

TO_COMPILE = {PROGRAM: (0.01, 1.2e-6), RESIDUAL: (0.3, 7e-5), JACOBIANS: (0.3, 3.3e-4)}
"""Processor time for writing and compiling a function, s, and the further time for each instruction, s."""

ITERATION = 2e-4
"""Extra time of a Newton iteration in Python over one in C, without the equations, s: 1.7e-4 to 6.5e-4."""

TO_COMPILE_STEPS = 0.3
"""Processor time for compiling the steps, s; once for all models."""

MOTIONS_TO_COME = 2.0
"""Expected motions with as many steps as the last one: the next, and one that tells the error of its steps."""

MOTIONS_AFTER_FIRST = 4.0
"""Work of a search after its first motion, over the work of that motion: 2.3 to 5.2 in searches for modes."""

TELLING_SHARE = 0.1
"""Share of a piece of the inputs after which the work so far foretells the work of the motion."""

TO_BEGIN = 40
"""Extra iterations of the first, short steps, which are left out of the forecast."""


@dataclass
class MotionCompiler:
    """Selector of kernels for the motions of one simulation: machine code if it is cached or saves time.

    Attributes:
        always: whether to compile even if that takes longer than it saves.
        last: work of the previous motion; None before the first.
        asked: for each function, the model of the last search and the machine code that was found, else None.
        saved_by_steps: time that steps in C would have saved in the first motion, s.
        steps_fail: whether the compiler has failed on the steps; every step in Python may ask.
    """

    always: bool = False
    last: StepStatistics | None = None
    asked: dict[str, tuple[Model, RepeatedCall | None]] = field(default_factory=dict)
    saved_by_steps: float = 0.0
    steps_fail: bool = False

    @cached_property
    def _compiler(self) -> str:
        """Command of the C compiler; without a compiler it raises ExportError."""
        return find_compiler()

    def learn(self, statistics: StepStatistics) -> None:
        """Record the work of the motion for which kernels were requested last."""
        saved_by_steps = self._saved_by_steps(statistics)
        for name, (model, found) in self.asked.items():
            if found is None:
                spent = _interpreted_time(model, name, statistics)
                _spent(model)[name] += spent
                tally(_stem(model, name), spent)
        if self.last is None:
            self.saved_by_steps = saved_by_steps
        self.last = statistics
        if not steps_are_loaded():
            tally(stem_of_steps(), saved_by_steps)

    def _saved_by_steps(self, work: StepStatistics) -> float:
        """Time that steps in C save in the motion for which kernels were requested last, s."""
        saved = ITERATION * work.iterations
        model, found = self.asked.get(RESIDUAL, (None, None))
        if model is not None and found is None and not can_be_centred(model):
            # Programs are run by steps in C alone.
            saved += SAVED[PROGRAM] * _interpreted_time(model, RESIDUAL, work)
        return saved

    def kernels(self, model: Model) -> StepKernels:
        """Choose the kernels for the next motion of a model.

        Raises:
            ExportError: machine code is required, but there is no compiler, or it fails.
        """
        residual = self._compiled(model, RESIDUAL)
        jacobians = self._compiled(model, JACOBIANS)
        stepper = self._stepper(MOTIONS_AFTER_FIRST * self.saved_by_steps)
        if residual is None:
            residual = interpreted_residual(model)
            # In centred coordinates steps have a residual of their own.
            if not can_be_centred(model):
                # Steps in C alone run it.
                residual.program = _program_of(model, write=stepper is not None and self._pays(model, PROGRAM))
                residual.program_after = partial(_program_after, model)
        of_jacobians = interpreted_jacobians(model) if jacobians is None else jacobians.matrices
        return StepKernels(residual, of_jacobians, stepper, jacobians, self._stepper_after)

    def library(self, model: Model) -> str | None:
        """The shared object with the residual and all that is written beside it; None where it is not at hand."""
        of_model, residual = self.asked.get(RESIDUAL, (None, None))
        if of_model is not model:
            residual = self._compiled(model, RESIDUAL)
        return None if residual is None else residual.library

    def _stepper_after(self, iterations: int, share: float) -> Stepper | None:
        """The steps in machine code for the rest of a motion and of the search, where they are foreseen to pay.

        Args:
            iterations: iterations that Python has taken in a piece of the inputs.
            share: share of the piece that is done.
        """
        if share < TELLING_SHARE:
            return None
        of_piece = self._saved_by_steps(_iterations(iterations - TO_BEGIN)) / share
        motions = MOTIONS_TO_COME if self.last else 1.0 + MOTIONS_AFTER_FIRST
        foreseen = (motions - share) * of_piece
        return self._stepper(foreseen) if foreseen > TO_COMPILE_STEPS else None

    def _stepper(self, foreseen: float) -> Stepper | None:
        """Return the steps in machine code; None if they are not cached and do not pay, or without a working compiler.

        Args:
            foreseen: time that they would save in the rest of the search, s.
        """
        if self.steps_fail:
            return None
        try:
            # What steps in Python have taken on this machine so far counts as what the rest of the search foresees.
            pays = self.always or steps_are_at_hand() or max(foreseen, tallied(stem_of_steps())) > TO_COMPILE_STEPS
            if not pays:
                return None
            steps_library()
        except ExportError:
            if self.always:
                raise
            self.steps_fail = True
            return None
        return CompiledSteps

    def _compiled(self, model: Model, name: str) -> RepeatedCall | None:
        """Return a function in machine code; None if it is not cached and does not pay."""
        of_model, found = self.asked.get(name, (None, None))
        try:
            if of_model is not model:
                found = _in_machine_code(model, name, self._compiler, write=self.always)
            if found is None and self._pays(model, name):
                found = _in_machine_code(model, name, self._compiler, write=True)
        except ExportError:
            if self.always:
                raise
            # The virtual machine needs no compiler.
            found = None
        self.asked[name] = (model, found)
        return found

    def _pays(self, model: Model, name: str) -> bool:
        """Whether machine code saves more time than its compilation takes.

        That is foreseen where the next motions would take as long as the last one, or where earlier motions of this
        model have taken so long, of any process where it is kept for others: more motions are likely.
        """
        if self.last is None:
            return False
        spent = _spent(model)[RESIDUAL if name == PROGRAM else name]
        if name != PROGRAM:
            spent = max(spent, tallied(_stem(model, name)))
        return _saves(model, name, max(MOTIONS_TO_COME * _interpreted_time(model, name, self.last), spent))


def _saves(model: Model, name: str, foreseen: float) -> bool:
    """Whether compiling a function takes less time than it saves of the expected time of the virtual machine, s."""
    at_least, each = TO_COMPILE[name]
    saved = SAVED[name]
    if name == RESIDUAL and can_be_centred(model):
        # No program runs in its place: the steps have a residual of their own.
        saved += (1.0 - saved) * SAVED[PROGRAM]
    return saved * foreseen > at_least + each * _instructions(model)


def _program_of(model: Model, *, write: bool) -> ScalarProgram | None:
    """Return inverse dynamics as a program; None if it is not written and ``write`` is false, or if it has none."""
    written: dict[str, ScalarProgram | None] = kept_with(model, "_programs", dict)
    if PROGRAM not in written and write:
        written[PROGRAM] = matrix_program(model.inverse_dynamics)
    return written.get(PROGRAM)


def _program_after(model: Model, iterations: int) -> ScalarProgram | None:
    """Return the program for a motion after so many iterations without one; None as long as it does not pay."""
    foreseen = MOTIONS_TO_COME * _interpreted_time(model, PROGRAM, _iterations(iterations))
    return _program_of(model, write=_saves(model, PROGRAM, foreseen))


def _iterations(iterations: int) -> StepStatistics:
    """Work of a motion that is known by its number of iterations alone."""
    return StepStatistics(0, 0, iterations, 0, float("nan"), float("nan"))


def _spent(model: Model) -> dict[str, float]:
    """Processor time of the virtual machine so far for each function of a model, or of models that share it, s."""
    return kept_with(model, "_interpreted_time", lambda: dict.fromkeys(TO_COMPILE, 0.0))


def _interpreted_time(model: Model, name: str, work: StepStatistics) -> float:
    """Processor time of the virtual machine for a function in a motion, s."""
    residual = _instructions(model) * INSTRUCTION
    if name != JACOBIANS:
        return STAGES * work.iterations * residual
    return work.jacobians * next(iter(fastest_derivatives(model)), AS_MANY_RESIDUALS * residual)


def _instructions(model: Model) -> int:
    """Number of scalar instructions of inverse dynamics; it is kept, because steps in Python ask repeatedly."""
    count: int = kept_with(model, "_instructions", lambda: model.inverse_dynamics_in_scalars.n_instructions())
    return count


def _in_machine_code(model: Model, name: str, compiler: str, *, write: bool) -> RepeatedCall | None:
    """Load a function of a model in machine code, from the cache or after writing and compiling it.

    Args:
        model: the model.
        name: RESIDUAL or JACOBIANS.
        compiler: command of the compiler.
        write: whether to write and compile it if the cache does not have it; if false, the answer is None then.

    Raises:
        ExportError: the compiler fails.
    """
    results, _ = WRITTEN[name]
    # Every motion of a model asks for them: the files of the cache are looked at once.
    loaded: dict[tuple[str, str, str], str] = kept_with(model, "_machine_code", dict)
    place = (name, compiler, os.fspath(cache_folder()))
    if place not in loaded:
        library = _library(model, name, compiler, write=write)
        if library is None:
            return None
        loaded[place] = os.fspath(library)
    call = RepeatedCall(external(name, loaded[place]), results, loaded[place])
    if name == RESIDUAL and has_function(AT_STAGES, loaded[place]):
        call.at_stages = RepeatedCall(external(AT_STAGES, loaded[place]), results, loaded[place])
    return call


def _library(model: Model, name: str, compiler: str, *, write: bool) -> Path | None:
    """Path of the shared object with a function; arguments as for :func:`_in_machine_code`."""
    key = _key(model, name)
    kept = None if key is None else compiled_from(name, key, compiler, flags_of_machine())
    if kept is not None or not write:
        return kept
    # The printer of C is needed here alone, and takes its time to be loaded.
    from cosserat_casadi.compiling.printed_files import external_sources

    _, functions = WRITTEN[name]
    texts = external_sources(functions(model), name, "long long int")
    # Sources that changed meanwhile may have written parts of it.
    origin = None if sources_hash() is None else key
    return compiled_texts(name, texts, compiler, flags=flags_of_machine(), origin=origin)


def _key(model: Model, name: str) -> str | None:
    """Key of the origin of a function of a model; None if it has no key."""
    keys: dict[str, str | None] = kept_with(model, "_keys_of_equations", dict)
    if name not in keys:
        keys[name] = key_of(name, *_equations(model))
    return keys[name]


def _stem(model: Model, name: str) -> str | None:
    """Name of the record of time spent without machine code for a function of a model; None without a key."""
    key = _key(model, name)
    return None if key is None else f"{name}-{key}"


def _equations(model: Model) -> list[Any]:
    """All data on which the equations of motion depend, without the paths of inputs and the tolerance."""
    if type(model) is not Model or model.parameters.size:
        return [model]
    levels: list[Any] = []
    discrete: DiscreteScene | None = model.discrete
    while discrete is not None:
        discretisation = {name: rod.discretisation for name, rod in discrete.rods.items()}
        levels.append((discrete.scene.of_equations(), discrete.layout, discretisation))
        discrete = discrete.scaling
    return levels


def functions_of_limits(model: Model) -> list[ca.Function]:
    """Functions that judge states of a model: its resolution index, and its margins from impossible states."""
    margins = [] if model.strain_margins is None else [with_dense_results(model.strain_margins, MARGINS)]
    return [with_dense_results(model.resolution_index, RESOLUTION), *margins]


def _points(model: Model) -> list[MovingPoints]:
    """Points of rods and bodies in exact contact; with friction also those of rigid stops and cables."""
    return points_of(struck_beside_friction(model)) if model.scene.rubs_exactly else touching_points(model)


def _residual(model: Model) -> list[Kernel]:
    function = model.inverse_dynamics
    arguments = function.mx_in()
    residual = ca.Function(RESIDUAL, arguments, [ca.densify(function(*arguments))], function.name_in(), ["residual"])
    # Every motion asks for the watched paths, for how far unknowns move them, and for rows on limits and constraints.
    beside = [function_of_paths(model), function_of_displacements(model), *functions_of_flight(model)]
    for points in _points(model):
        beside += points.in_iterations
    if model.scene.rubs_exactly:
        beside += [points.velocities for points in _points(model)]
        beside += functions_of_sliding(model)
    # With parameters no motion is computed, and rows have no parameters.
    rows = [] if model.parameters.size else [*functions_of_limits(model), *functions_of_closing(model)]
    return [*_straight(model, residual), *beside, *rows]


def _straight(model: Model, residual: ca.Function) -> list[Kernel]:
    """Inverse dynamics without loops, and for the stages of a step at once; with loops where that is too long."""
    if can_be_centred(model) or _instructions(model) > MOST_STRAIGHT:
        return [residual]
    program = scalar_program(model.inverse_dynamics_in_scalars)
    if program is None or len(program.lines) > MOST_LINES * _instructions(model):
        return [residual]
    return straight_kernels(program, residual, AT_STAGES)


def _jacobians(model: Model) -> list[Kernel]:
    beside = derivatives_of_flight(model)
    for points in _points(model):
        beside += points.in_derivatives
    return [dense_jacobians(model, JACOBIANS), *beside]


WRITTEN = {RESIDUAL: (1, _residual), JACOBIANS: (MATRICES, _jacobians)}
"""Number of results of each function, and the functions in its shared object, with itself first."""
