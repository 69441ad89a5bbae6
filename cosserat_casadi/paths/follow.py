"""Equilibrium paths of a model: one input grows from zero, and the equilibrium is followed through folds and branches.

See docs/theory.md, section 12.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from cosserat_casadi.equilibrium.answer_error import left_out_on_paths
from cosserat_casadi.equilibrium.load_path import input_path
from cosserat_casadi.equilibrium.smooth_contact import depths_along
from cosserat_casadi.equilibrium.smooth_passage import SmoothBarriers
from cosserat_casadi.equilibrium.solve import solve
from cosserat_casadi.equilibrium.stability import admissible_eigenvalues, variations
from cosserat_casadi.equilibrium.strain_limits import first_beyond
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.obstacle_checks import refuse_held_by_contact
from cosserat_casadi.numerics.arclength import ArcPoint, ArcSettings, Curve, Monitor
from cosserat_casadi.numerics.broyden import dense
from cosserat_casadi.numerics.continuation import Path
from cosserat_casadi.numerics.events import DETERMINANT, Arc
from cosserat_casadi.numerics.progress import Progress
from cosserat_casadi.numerics.trace import Guard, PathOutcome, Trace, trace
from cosserat_casadi.paths.contact_path import ContactPath, follow_contact_path
from cosserat_casadi.paths.equilibrium_path import (
    EquilibriumPath,
    InputChange,
    loads_have_potential,
    path_along,
    path_events,
    tested_stability,
)
from cosserat_casadi.paths.friction_path import FrictionPath, follow_friction_path
from cosserat_casadi.paths.rubbing_path import RubbingPath, follow_rubbing_path

FROM_NOWHERE = (
    " Friction is counted from factor 0, where nothing rubs yet; no limit points and branches are looked for."
)
"""A sentence on the beginning of a path with friction."""


@dataclass(frozen=True)
class _Followed(InputChange[Model]):
    """One input of a model that grows from zero."""

    @property
    def monitor(self) -> Monitor:
        """Eigenvalues of the second variation if there is a potential, else the determinant."""
        if not loads_have_potential(self):
            return DETERMINANT
        # Eigenvalues also show a double bifurcation, at which the determinant keeps its sign.
        allowed = variations(self.model)

        def eigenvalues(_y: FloatArray, jacobian: FloatArray, _bordered: FloatArray) -> FloatArray:
            return admissible_eigenvalues(jacobian, allowed)

        return Monitor(eigenvalues, feels_limits=True)

    @cached_property
    def scale(self) -> FloatArray:
        """Units of the unknowns along the curve, shape (n,): multipliers grow with the load and count relative to it.

        Otherwise a strong load on a held rod would need many small steps.
        """
        model = self.model
        unloaded = np.zeros(model.size)
        load_factor = 1.0
        load_factor_rate = 0.0
        rate = model.path_rate(unloaded, self.base, load_factor, self.change, load_factor_rate)
        load = float(np.linalg.norm(rate.full()))
        multipliers = variations(model).held
        scale = np.ones(model.size)
        scale[multipliers] = max(1.0, load)
        return scale

    def curve(self, start: FloatArray, settings: ArcSettings) -> Curve:
        """The path's equations in scaled unknowns."""
        scale = self.scale
        unscaled = input_path(self.model, start, self.base, self.base + self.change)

        def jacobian(x: FloatArray, t: float) -> FloatArray:
            # Chain rule: one column for each unknown.
            unscaled_jacobian = dense(unscaled.jacobian(scale * x, t))
            return unscaled_jacobian * scale

        scaled = Path(
            residual=lambda x, t: unscaled.residual(scale * x, t),
            jacobian=jacobian,
            rate=lambda x, t: unscaled.rate(scale * x, t),
            start=start / scale,
        )
        return Curve(scaled, self.monitor, settings, pairs=tuple(self.model.discrete.pair_rows))

    def record(self, traced: Trace, message: str = "") -> EquilibriumPath:
        """A trace as arrays.

        Args:
            traced: the computed part of the curve.
            message: a sentence for the user; by default the sentence of the outcome.
        """
        outcome = traced.outcome or PathOutcome.MAX_STEPS
        # Without points the array has no rows, but still its columns.
        y = np.array([point.y for point in traced.points]).reshape(-1, self.model.size + 1)
        load_factors = y[:, -1]
        smallest_eigenvalue = None
        neutral = None
        if loads_have_potential(self):
            smallest_eigenvalue, neutral = tested_stability(traced.points)
        return path_along(
            self,
            EquilibriumPath,
            outcome,
            message=message or _sentence(outcome, load_factors),
            factor=load_factors,
            x=y[:, :-1] * self.scale,
            smallest_eigenvalue=smallest_eigenvalue,
            neutral=neutral,
            events=path_events(traced, self.scale),
            branch=traced.branch,
        )


def follow_path(
    model: Model,
    name: str,
    value: npt.ArrayLike,
    values: Mapping[str, npt.ArrayLike] | None = None,
    *,
    branch: int = 0,
    settings: ArcSettings | None = None,
    first: EquilibriumPath | None = None,
    progress: Progress | None = None,
) -> EquilibriumPath:
    """Follow the equilibrium of a model while one input moves from zero to a value; see the public ``follow``.

    The path starts at the equilibrium with that input at zero, or at its value in ``values``, and all other inputs at
    their values. It passes straight through bifurcations, and ends when the factor first reaches 1.

    Raises:
        SceneError: the input is unknown, a value is refused, a branch of a path with friction is requested, or contact
            alone would have to hold a free rod.
    """
    model = model.at()
    continued = RubbingPath if model.scene.touches_exactly else FrictionPath
    if first is not None and not (model.rubs_on_paths and isinstance(first, continued)):
        problem = "is a path with friction from whose end another one goes on"
        raise SceneError(Problem("first", problem, "leave it out: a path without friction does not depend on the way"))
    followed = _followed(model, name, value, values)
    if model.scene.touches_exactly:
        refuse_held_by_contact(model.scene)
        touching: ContactPath
        if model.rubs_on_paths:
            _refuse_branch(branch)
            assert first is None or isinstance(first, RubbingPath)
            followed = _followed(model, name, value, values, first)
            touching = follow_rubbing_path(followed, settings or ArcSettings(), first=first, progress=progress)
        else:
            touching = follow_contact_path(followed, branch=branch, settings=settings, progress=progress)
        message = _sentence(touching.outcome, touching.factor) + touching.stopped_at
        if model.rubs_on_paths and first is None:
            message += FROM_NOWHERE
        return _resolved(replace(touching, message=message + left_out_on_paths(model.scene)))
    left_out = left_out_on_paths(model.scene)
    if model.rubs_on_paths:
        _refuse_branch(branch)
        followed = _followed(model.with_memory, name, value, values, first)
        rubbing = follow_friction_path(followed, settings or ArcSettings(), first=first, progress=progress)
        message = _sentence(rubbing.outcome, rubbing.factor) + (FROM_NOWHERE if first is None else "") + left_out
        return _within_limits(_resolved(replace(rubbing, message=message)))
    values_at_zero = model.inputs.unpack(followed.base)
    start = solve(model, values_at_zero, estimate_error=False)
    if not start.converged:
        outcome = PathOutcome.NO_START
        empty = Trace([], outcome=outcome)
        return followed.record(empty, f"{outcome.value} {start.message}")
    curve = followed.curve(start.x, settings or ArcSettings())
    traced = trace(curve, branch=branch, progress=progress, guard=_smooth_guard(followed))
    path = _within_limits(_resolved(followed.record(traced)))
    return replace(path, message=path.message + left_out)


def _refuse_branch(branch: int) -> None:
    """A path with friction has no branches.

    Raises:
        SceneError: a branch is requested.
    """
    if branch:
        problem = "is of a path without friction: one that rubs goes on in increments"
        raise SceneError(Problem("--branch", problem, "leave it out, or leave friction out"))


def _smooth_guard(followed: _Followed) -> Guard | None:
    """Guard that refuses steps through a smooth bar or ball; None in a scene without these."""
    barriers = SmoothBarriers(followed.model)
    if not barriers.any:
        return None

    def guard(arc: Arc, end: ArcPoint) -> ArcPoint | None:
        before, after = (point.x * followed.scale for point in (arc.start, end))
        first, last = (followed.inputs(point.load_factor) for point in (arc.start, end))
        if barriers.are_between(before, after, (first, last)):
            return None
        return end

    return guard


def _resolved(path: EquilibriumPath) -> EquilibriumPath:
    """The path, UNRESOLVED if one of its points is not resolved: too few nodes, or too deep in smooth contact.

    A path that has not reached its end keeps its outcome, with a note on the resolution, which may be the cause.
    """
    unresolved = np.flatnonzero(path.resolution_indices > 1.0)
    if not len(unresolved):
        return path
    told = f"From factor {path.factor[unresolved[0]]:.6g} on the modes and nodes are too few for the shape."
    # With exact contacts the number of unknowns changes along the path.
    if path.model.contact_depth is not None and not path.model.scene.touches_exactly:
        depths = depths_along(path.model, path.x, path.all_inputs)
        too_deep = np.flatnonzero(depths > 1.0)
        if len(too_deep):
            told = (
                f"From factor {path.factor[too_deep[0]]:.6g} on a rod is up to {depths.max():.3g} widths deep inside "
                "an obstacle or a rod, too deep to be contact: give the contact more width or stiffness."
            )
    if not path.converged:
        return replace(path, message=f"{path.message} {told}")
    return replace(path, outcome=PathOutcome.UNRESOLVED, message=f"{PathOutcome.UNRESOLVED.value} {told}")


def _within_limits(path: EquilibriumPath) -> EquilibriumPath:
    """The path, with an outcome or note if strains exceed their limits along it."""
    if path.outcome not in (PathOutcome.CONVERGED, PathOutcome.LOAD_STALLED):
        return path
    beyond = first_beyond(path.model, path.x, path.all_inputs)
    if beyond is None:
        return path
    outcome = PathOutcome[beyond.word]
    message = f"{outcome.value} {beyond.whose}, from factor {path.factor[beyond.state]:.6g} on."
    return replace(path, outcome=outcome, message=message)


def _followed(
    model: Model,
    name: str,
    value: npt.ArrayLike,
    values: Mapping[str, npt.ArrayLike] | None,
    first: EquilibriumPath | None = None,
) -> _Followed:
    """The input to follow, its value checked together with the values of other inputs.

    Raises:
        SceneError: the input is unknown, or a value is refused.
    """
    given = dict(values or {})
    given[name] = value
    if first is not None:
        base = first.inputs(float(first.factor[-1]))
        full = model.pack(model.inputs.unpack(base) | given)
        return _Followed(model, name, base, full - base)
    full = model.pack(given)
    if values is not None and name in values:
        base = model.pack(values)
    else:
        base = full.copy()
        # The followed input grows from zero, not from the scene's value; all others keep their values.
        base[model.inputs.slices[name]] = 0.0
    change = full - base
    return _Followed(model, name, base, change)


def _sentence(outcome: PathOutcome, load_factors: FloatArray) -> str:
    if outcome is PathOutcome.CONVERGED or not len(load_factors):
        return outcome.value
    largest = load_factors.max()
    last = load_factors[-1]
    return f"{outcome.value} Largest factor reached: {largest:.6g}; last: {last:.6g}."
