"""Answers of a compiled library: solutions, their derivatives, their stability."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.outcome import Outcome

SOLVED = (Outcome.CONVERGED, Outcome.UNRESOLVED)
"""Outcomes with a solution for the inputs, at least of the discrete equations."""

Fields = Sequence[tuple[str, type[Any]]]
"""Names and types of the members of a struct."""


class AnswerInfo(ctypes.Structure):
    """The struct in C with the outcome of a solve, and the error of the answer if it is estimated."""

    _fields_: ClassVar[Fields] = (
        ("status", ctypes.c_int),
        ("iterations", ctypes.c_int),
        ("jacobians", ctypes.c_int),
        ("residual_norm", ctypes.c_double),
        ("load_factor", ctypes.c_double),
        ("error_estimate", ctypes.c_double),
    )


def judged_words(info: AnswerInfo, outcomes: Sequence[Outcome]) -> dict[str, Any]:
    """Arguments of :class:`CompiledSolution` from the struct.

    Args:
        info: the struct.
        outcomes: outcomes of the solver, in the order of their numbers.
    """
    words = {
        "outcome": outcomes[info.status],
        "iterations": info.iterations,
        "jacobians": info.jacobians,
        "residual_norm": info.residual_norm,
        "load_factor": info.load_factor,
        "error_estimate": None if info.error_estimate < 0 else info.error_estimate,
    }
    if isinstance(info, TubeInfo):
        words["determinant"] = info.determinant
    return words


class TubeInfo(AnswerInfo):
    """The struct in C with the outcome of a call for concentric tubes, and the determinant."""

    _fields_ = (("determinant", ctypes.c_double),)


VERDICTS = ("stable", "neutral", "critical", "unstable")
"""Verdicts on stability in C, in the order of their numbers."""


@dataclass(frozen=True)
class CompiledStability:
    """Verdict of the library on the stability of an equilibrium.

    Attributes:
        smallest_eigenvalue: smallest eigenvalue of the second variation over the admissible variations, in units of
            EI/ℓ of the scene's own numbers, for any parameters.
        negative: number of eigenvalues below zero.
        zero: number of eigenvalues that are zero to rounding.
        verdict: ``stable``; ``neutral`` if variations of zero energy lead through equivalent equilibria; ``critical``
            if they do not; ``unstable``.
    """

    smallest_eigenvalue: float
    negative: int
    zero: int
    verdict: str

    @property
    def stable(self) -> bool:
        """Whether a real rod stays in the equilibrium."""
        return self.verdict in ("stable", "neutral")


class StabilityInfo(ctypes.Structure):
    """The struct in C with the eigenvalues and the verdict."""

    _fields_ = (
        ("smallest_eigenvalue", ctypes.c_double),
        ("negative", ctypes.c_int),
        ("zero", ctypes.c_int),
        ("verdict", ctypes.c_int),
    )

    @property
    def judged(self) -> CompiledStability:
        """The stability as a record."""
        return CompiledStability(self.smallest_eigenvalue, self.negative, self.zero, VERDICTS[self.verdict])


@dataclass(frozen=True, kw_only=True)
class CompiledAnswer:
    """Outcome of a call of a solver in C.

    Attributes:
        outcome: the outcome.
        iterations: number of Newton steps tried.
        jacobians: number of factorised Jacobians.
        residual_norm: relative norm of the residual at x and the requested inputs, reached or not.
        load_factor: share of the load at x, or of the path of the inputs that was covered; 1 if the call converged.
        error_estimate: estimated error of the poses of tips and bodies, as distance over the length and as angle, rad,
            and of the lengths of cables over the length; 1 if unknown, None if it was not estimated.
        tolerance: wanted error of the scene; None if no tolerance has a meaning.
    """

    outcome: Outcome
    iterations: int
    jacobians: int
    residual_norm: float
    load_factor: float
    error_estimate: float | None = None
    tolerance: float | None = None

    @property
    def converged(self) -> bool:
        """Whether the answer is an equilibrium for the inputs at the full load."""
        return self.outcome is Outcome.CONVERGED

    @property
    def message(self) -> str:
        """Sentence on the outcome."""
        return self.outcome.value

    @property
    def within_tolerance(self) -> bool | None:
        """Whether the estimated error is within the tolerance; None without an estimate or a tolerance."""
        if self.tolerance is None:
            return None
        if not self.converged:
            return False
        if self.error_estimate is None:
            return None
        return self.error_estimate <= self.tolerance


@dataclass(frozen=True, kw_only=True)
class CompiledSolution(CompiledAnswer):
    """A solution of the solver in C.

    Attributes:
        inputs: inputs of the solution, shape (m,).
        x: unknowns; the last equilibrium on the way if the call did not converge.
        determinant: determinant of concentric tubes: 1 without twist, 0 where they snap, negative if unstable.
    """

    inputs: FloatArray
    x: FloatArray
    determinant: float | None = None


@dataclass(frozen=True, kw_only=True)
class CompiledTurn(CompiledSolution):
    """A turn of a control loop.

    Attributes:
        derivatives: derivatives of position and quaternion of each tip by the inputs, shape (7, m), if requested.
        memory: data with which the next turn begins.
    """

    derivatives: Mapping[str, FloatArray] | None = None
    memory: bytes = field(default=b"", repr=False)


@dataclass(frozen=True)
class Sensitivity:
    """Derivatives of an equilibrium by some numbers, a column for each.

    Attributes:
        x: derivatives of the unknowns, shape (size, columns).
        tips: derivatives of position and quaternion of the tip of each rod, shape (7, columns).
        bodies: derivatives of position and quaternion of each rigid body, shape (7, columns).
    """

    x: FloatArray
    tips: dict[str, FloatArray]
    bodies: dict[str, FloatArray]
