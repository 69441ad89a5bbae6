"""One point of the work–precision plane, measured: its error, its size, and its times."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite, nan
from typing import Any

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.cost import foreseen_operations
from cosserat_casadi.accuracy.refine import solve_rods
from cosserat_casadi.codegen.timed_program import Program, Times, best_time
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.equilibrium.solve import solve
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.scene_rods import base_pose
from cosserat_casadi.rod.discretisation import Discretisation
from tests.fine_reference import Errors, Reference, with_tolerance
from work_precision.grid import Candidate

LARGEST = 400_000
"""Scalar operations of residual and Jacobian beyond which they are not counted and the compiler is not asked."""

LARGEST_LITERAL = 8
"""Intervals beyond which the literal system, whose operations cannot be counted, is not compiled: it takes minutes."""


@dataclass(frozen=True)
class Measurement:
    """A row of the table; a number that was not measured is NaN.

    Attributes:
        name: of the candidate.
        method: one of the grid's methods.
        strain: strain model where it differs from the scene's.
        tolerance: what the dial was set to.
        modes: of every rod and strain, such as "6 6 4".
        intervals: of every rod and element.
        transport: rotation integrator of every rod.
        position_error: at the tip over length.
        rotation_error: rad.
        wrench_error: of the clamp, relative.
        unknowns: of the model.
        igm_operations: scalar operations of the first rod's Inverse Geometric Model.
        jacobian_operations: of residual and Jacobian.
        build_s: time to build the functions.
        vm_igm_us: Inverse Geometric Model of the first rod in CasADi's virtual machine.
        vm_jacobian_us: residual and Jacobian there.
        vm_cold_us: the solve in Python from the unloaded rod.
        igm_us: Inverse Geometric Model of the first rod, compiled.
        jacobian_us: residual and Jacobian, compiled.
        warm_us: solve in C from one per cent away.
        cold_us: solve in C from the unloaded rod.
        note: why something was not measured; empty where all was.
    """

    name: str
    method: str
    strain: str = ""
    tolerance: float = nan
    modes: str = ""
    intervals: str = ""
    transport: str = ""
    position_error: float = nan
    rotation_error: float = nan
    wrench_error: float = nan
    unknowns: int = 0
    igm_operations: float = nan
    jacobian_operations: float = nan
    build_s: float = nan
    vm_igm_us: float = nan
    vm_jacobian_us: float = nan
    vm_cold_us: float = nan
    igm_us: float = nan
    jacobian_us: float = nan
    warm_us: float = nan
    cold_us: float = nan
    note: str = ""

    @property
    def pose_error(self) -> float:
        """The larger of position error and rotation error."""
        return max(self.position_error, self.rotation_error)

    @property
    def in_plane(self) -> bool:
        """Whether it is a point in the plane of error and compiled cold solve: both were measured."""
        coordinates = (self.pose_error, self.cold_us)
        return all(map(isfinite, coordinates))


class Trial:
    """A candidate between its preparation and its timing: the compiler works in between.

    Args:
        candidate: what to measure.
        scene: the scene, of the candidate's strain model.
        reference: of that scene.
        compiler: command of a C compiler.
    """

    def __init__(self, candidate: Candidate, scene: scenes.Scene, reference: Reference, compiler: str) -> None:
        self.candidate = candidate
        self.reference = reference
        self.solution = _solved(candidate, scene)
        # Built once more, to be timed from nothing.
        self.model, self.build_s = _built(scene, self.solution.model.discretisation)
        self.note = ""
        if not self.solution.converged:
            self.note = self.solution.message
        if not self.note:
            self.note = _too_large(self.model)
        self.igm_operations = nan
        self.jacobian_operations = nan
        self.program: Program | None = None
        if not self.note:
            self.igm_operations, self.jacobian_operations = _operations(self.model)
            self.program = Program(self.model, compiler)

    def finish(self) -> Measurement:
        """The row, with all that takes a quiet machine to measure."""
        times, note = self._times()
        errors = Errors(nan, nan, nan)
        if self.solution.converged:
            errors = self.reference.errors(self.solution)
        tolerance = self.candidate.tolerance
        return Measurement(
            name=self.candidate.name,
            method=self.candidate.method,
            strain=self.candidate.strain,
            tolerance=nan if tolerance is None else tolerance,
            **_described(self.model.discretisation),
            position_error=errors.position,
            rotation_error=errors.rotation,
            wrench_error=errors.wrench,
            unknowns=self.model.size,
            igm_operations=self.igm_operations,
            jacobian_operations=self.jacobian_operations,
            build_s=self.build_s,
            **self._virtual_times(),
            igm_us=times.igm,
            jacobian_us=times.jacobian,
            warm_us=times.warm,
            cold_us=times.cold,
            note=note,
        )

    def wait(self) -> None:
        """Until the compiler is done."""
        if self.program is not None:
            self.program.wait()

    def close(self) -> None:
        """Stop the compiler and remove its files."""
        if self.program is not None:
            self.program.close()

    def _times(self) -> tuple[Times, str]:
        """Times of the program, and why there are none."""
        untimed = Times(nan, nan, nan, nan)
        if self.program is None:
            return untimed, self.note
        times = self.program.times()
        if isinstance(times, Times):
            return times, ""
        return untimed, times

    def _virtual_times(self) -> dict[str, Any]:
        """Times in CasADi's virtual machine, as attributes of the measurement."""
        x = self.solution.x
        inputs = self.solution.inputs
        rod = self.model.scene.rods[0]
        q = x[self.model.discrete.unknowns.strain(rod.name)]
        igm = self.model.igm[rod.name]
        arguments = (q, *base_pose(rod), inputs)
        times = {
            "vm_igm_us": best_time(lambda: igm(*arguments)),
            "vm_jacobian_us": best_time(lambda: self.model.jacobian(x, inputs)),
            "vm_cold_us": nan,
        }
        if self.solution.converged:
            times["vm_cold_us"] = best_time(lambda: solve(self.solution.model, estimate_error=False))
        return times


def _solved(candidate: Candidate, scene: scenes.Scene) -> Solution:
    if candidate.tolerance is not None:
        return solve_rods(with_tolerance(scene, candidate.tolerance))
    return solve(build(scene, candidate.discretisation(scene)), estimate_error=False)


def _built(scene: scenes.Scene, discretisation: dict[str, Discretisation]) -> tuple[Model, float]:
    """A model and the time that its functions took, s."""
    start = time.perf_counter()
    model = build(scene, discretisation)
    # Functions are built when they are first asked for.
    for function in (model.residual, model.jacobian, *model.igm.values()):
        assert function.n_in() > 1
    seconds = time.perf_counter() - start
    return model, seconds


def _described(discretisation: dict[str, Discretisation]) -> dict[str, Any]:
    """Modes, intervals and integrators, rods parted by a bar."""
    rods = discretisation.values()
    modes = [" ".join(map(str, d.modes)) for d in rods]
    intervals = [str(d.nodes) for d in rods]
    transports = [d.transport for d in rods]
    return {
        "modes": " | ".join(modes),
        "intervals": " | ".join(intervals),
        "transport": " | ".join(transports),
    }


def _is_literal(model: Model) -> bool:
    transports = {d.transport for d in model.discretisation.values()}
    return "permuted" in transports


def _operations(model: Model) -> tuple[float, float]:
    """Operations of the first rod's Inverse Geometric Model and of residual and Jacobian.

    The literal system is solved with pivoting, which has no scalar form: not a number.
    """
    if _is_literal(model):
        return nan, nan
    igm = next(iter(model.igm.values()))
    return model.operations(igm), model.operations(model.jacobian)


def _too_large(model: Model) -> str:
    """Why neither operations are counted nor the compiler is asked; empty where they are."""
    intervals = max(d.nodes for d in model.discretisation.values())
    if _is_literal(model):
        if intervals <= LARGEST_LITERAL:
            return ""
        return f"not compiled: literal system of {intervals} intervals"
    operations = 0.0
    for discrete_rod in model.discrete.rods.values():
        foreseen = foreseen_operations(discrete_rod.properties, discrete_rod.discretisation)
        operations += foreseen.all
    if operations <= LARGEST:
        return ""
    return f"not compiled: about {operations:,.0f} operations"


def front(rows: Sequence[Measurement]) -> list[Measurement]:
    """Rows that none beats in pose error and compiled cold solve, the cheapest first.

    Rows without a place in that plane, and those of other strain models, which solve another problem, do not count.
    Of equals the first stays.
    """
    unbeaten: list[Measurement] = []
    comparable = [row for row in rows if row.in_plane and not row.strain]
    comparable.sort(key=lambda row: (row.cold_us, row.pose_error))
    for row in comparable:
        # Dearer than all before: it must be more exact than the most exact of them, which is the last.
        if not unbeaten or row.pose_error < unbeaten[-1].pose_error:
            unbeaten.append(row)
    return unbeaten
