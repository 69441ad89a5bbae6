"""Paths that a model offers to a continuation: all loads growing from zero, or inputs changing to others.

See docs/theory.md, section 9; section 8 for how constraints yield on the way.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import casadi as ca
import numpy as np

from cosserat_casadi.maths.numbers import without_rounding
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.contact_layers import inexact_beside, longest_step
from cosserat_casadi.model.system_functions import SystemFunctions
from cosserat_casadi.model.unloaded_response import NOISE
from cosserat_casadi.numerics.broyden import Jacobian, solved
from cosserat_casadi.numerics.continuation import ContinuationSettings, Path, PathPoint
from cosserat_casadi.scene.rod_records import STRAINS

FIRST_STEP = 0.25
"""Longest first step of an assembly with floating frames: the compliance falls to (3/4)³ in it."""

NEARLY_LOADED = 0.99
"""Load factor beyond which a stalled path may be one that pulls a rod taut; see nearly_loaded for assemblies."""

PACE = 3
"""Power p of t = 1 − (1 − s)^p on a path whose steps the shape alone bounds."""


def continuation_limits(model: SystemFunctions) -> ContinuationSettings:
    """Limits of a continuation: beside smooth obstacles steps are so short that sections move nearly straight.

    Beside thin obstacles its points are exact to a share of the layers' widths.
    """
    limits = ContinuationSettings()
    scene = model.scene
    longest = min(limits.longest, longest_step(scene))
    return replace(limits, longest=longest, inexact=min(limits.inexact, inexact_beside(scene)))


def load_path(model: Model, inputs: FloatArray, p: FloatArray | None = None) -> Path:
    """The path from the unloaded scene to the scene, along which all loads grow together.

    Args:
        model: what to solve.
        inputs: stacked inputs at t = 1, shape (model.inputs.size,).
        p: parameters of a model that has them, shape (model.parameters.size,).
    """
    no_change = np.zeros(model.inputs.size)
    given = (inputs,) if p is None else (inputs, p)
    path_rate = model.path_rate

    def rate(x: FloatArray, load_factor: float) -> FloatArray:
        load_factor_rate = 1.0
        dg_dt = path_rate(x, *given, load_factor, no_change, load_factor_rate)
        return column(dg_dt)

    # Model.path_tangent, the tangent as a function of the inputs, takes as long to write as many a solve. If the
    # unloaded stiffness is singular, the path starts with Newton's steps.
    unloaded = model.unloaded()
    stiffness = model.path_jacobian(unloaded, *given, 0.0).full()
    tangent = solved(stiffness, -rate(unloaded, 0.0))
    if tangent is not None:
        tangent = without_rounding(tangent, NOISE)
    # The load factor is t itself.
    path = _path(model, model.path_residual, model.path_jacobian, lambda t: (*given, t), rate, unloaded)
    return replace(path, tangent=tangent, first_step=first_step(model))


def backwards(path: Path, end: FloatArray) -> Path:
    """The reverse of a path, from an equilibrium at its end, t = 1, to its start."""
    return replace(
        path,
        residual=lambda x, t: path.residual(x, 1.0 - t),
        jacobian=lambda x, t: path.jacobian(x, 1.0 - t),
        rate=lambda x, t: -path.rate(x, 1.0 - t),
        start=end,
        tangent=None,
    )


def may_stretch(model: Model) -> bool:
    """Whether all rods extend, and constraints or cables of given length may stretch them."""
    extend = all(STRAINS.index("extension") in rod.admitted for rod in model.scene.rods)
    return extend and not all(model.discrete.unknowns.differential)


def paced_by_shape(path: Path, model: Model) -> Path:
    """A path with steps that the change of shape alone bounds, ever shorter in t towards its end: t = 1 − (1 − s)³.

    The tension of a rod that a support stretches grows as 1/(1 − t), to many times EI/ℓ² in a taut wire or a cable with
    little sag. Steps that this tension bounds too do not reach t = 1.
    """
    shape = model.discrete.unknowns.differential

    def load_factor(s: float) -> float:
        return 1.0 - (1.0 - s) ** PACE

    def growth(s: float) -> float:
        return PACE * (1.0 - s) ** (PACE - 1)

    def admits(before: PathPoint, after: PathPoint) -> bool:
        (first, start), (last, end) = before, after
        return path.admitted((first, load_factor(start)), (last, load_factor(end)))

    return replace(
        path,
        residual=lambda x, s: path.residual(x, load_factor(s)),
        jacobian=lambda x, s: path.jacobian(x, load_factor(s)),
        rate=lambda x, s: growth(s) * path.rate(x, load_factor(s)),
        tangent=None if path.tangent is None else PACE * path.tangent,
        step_weights=model.step_weights * shape,
        first_step=path.first_step / PACE,
        exact_tangents=True,
        admits=admits,
    )


def input_path(
    model: SystemFunctions,
    start: FloatArray,
    before: FloatArray,
    after: FloatArray,
    parameters: tuple[FloatArray, FloatArray] | None = None,
) -> Path:
    """The path from an equilibrium of the scene to other inputs and parameters, on the straight line between them.

    Args:
        model: what to solve.
        start: unknowns at or near the equilibrium at t = 0, shape (model.size,).
        before: stacked inputs at t = 0, shape (model.inputs.size,).
        after: stacked inputs at t = 1, shape (model.inputs.size,).
        parameters: parameters at t = 0 and 1, shape (model.parameters.size,) each; None without parameters.
    """
    change = after - before
    parameter_change = None if parameters is None else parameters[1] - parameters[0]
    load_factor = 1.0

    def arguments_at(t: float) -> list[FloatArray]:
        inputs = between(before, after, t)
        return [inputs] if parameters is None else [inputs, between(*parameters, t)]

    def rate(x: FloatArray, t: float) -> FloatArray:
        load_factor_rate = 0.0
        arguments = arguments_at(t)
        dg_dt = column(model.path_rate(x, *arguments, load_factor, change, load_factor_rate))
        if parameter_change is not None and np.any(parameter_change):
            dg_dt = dg_dt + column(model.parameter_jacobian(x, *arguments) @ parameter_change)
        return dg_dt

    functions = (model.path_residual, model.path_jacobian)
    return _path(model, *functions, lambda t: (*arguments_at(t), load_factor), rate, start)


def _path(
    model: SystemFunctions,
    path_residual: ca.Function,
    path_jacobian: ca.Function,
    arguments_at: Callable[[float], tuple[FloatArray | float, ...]],
    rate: Callable[[FloatArray, float], FloatArray],
    start: FloatArray,
) -> Path:
    """The path on which the arguments of residual and Jacobian, functions of a model, follow t."""
    # Callers read both functions from the model: the stack of calls that build them stays one shorter.

    def residual(x: FloatArray, t: float) -> FloatArray:
        return column(path_residual(x, *arguments_at(t)))

    def jacobian(x: FloatArray, t: float) -> Jacobian:
        """Derivative of the residual by x: sparse for an assembly, dense for single rods."""
        sparse = path_jacobian(x, *arguments_at(t))
        return sparse if model.is_assembly else np.asarray(sparse.full())

    return Path(residual, jacobian, rate, start, step_weights=model.step_weights)


def between(before: FloatArray, after: FloatArray, t: float) -> FloatArray:
    """Values on the straight line between two values, exact at both ends, however far apart these are."""
    left = (1.0 - t) * before
    return left + t * after


def first_step(model: Model) -> float:
    """Longest first step of the load path: the compliance (1 − t)³ of assemblies is far from linear."""
    return FIRST_STEP if model.discrete.frames and not model.discrete.closed_unloaded else 1.0


def nearly_loaded(model: Model) -> float:
    """Load factor beyond which a stalled path is paced: the compliance is as small in assemblies, as (1 − t)³."""
    return NEARLY_LOADED if first_step(model) == 1.0 else 1.0 - (1.0 - NEARLY_LOADED) ** (1.0 / 3.0)


def column(vector: ca.DM) -> FloatArray:
    """Convert a CasADi vector to an array, shape (n,)."""
    if not vector.shape[0]:
        # CasADi may give an empty vector zero columns too.
        return np.zeros(0)
    array = vector.full()
    return np.asarray(array[:, 0])
