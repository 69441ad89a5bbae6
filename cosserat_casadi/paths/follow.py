"""Equilibrium paths of a model: one input grows from zero, the equilibrium is followed through folds and branches."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from cosserat_casadi.equilibrium.load_path import input_path
from cosserat_casadi.equilibrium.solution import Pose, Solution
from cosserat_casadi.equilibrium.solve import solve
from cosserat_casadi.equilibrium.stability import admissible_eigenvalues, judged, variations
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.numerics.arclength import ArcSettings, Curve, Monitor
from cosserat_casadi.numerics.broyden import dense
from cosserat_casadi.numerics.continuation import Path, Progress
from cosserat_casadi.numerics.events import DETERMINANT
from cosserat_casadi.numerics.newton import relative_norm
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.paths.trace import PathOutcome, Trace, trace


@dataclass(frozen=True)
class PathEvent:
    """A limit point or a bifurcation of a path.

    Attributes:
        kind: "limit" or "bifurcation".
        factor: share of the input at which it lies.
        x: unknowns there, shape (model.size,).
        multiplicity: independent directions in which the equilibrium is neutral there.
        position: index of the first point of the path that lies beyond it.
    """

    kind: str
    factor: float
    x: FloatArray
    multiplicity: int
    position: int


@dataclass(frozen=True)
class EquilibriumPath:
    """Equilibria of a model along one of its inputs.

    Attributes:
        model: the model.
        name: the input that is followed.
        value: its value at factor 1, shaped as the input.
        base: stacked inputs at factor 0, shape (model.inputs.size,).
        change: stacked inputs at factor 1 less those at factor 0, shape (model.inputs.size,).
        outcome: how the path ended.
        message: a sentence for the user.
        factor: share of the value at each of k points in the order of travel, shape (k,).
        x: unknowns, shape (k, model.size).
        smallest_eigenvalue: of the second variation in units of EI/ℓ, shape (k,); None where loads have no potential.
        neutral: whether a variation costs no energy while none releases any, shape (k,); None likewise.
        events: limit points and bifurcations in the order of travel.
        branch: index of the first point on the branch that was switched to; None on the first path.
        error_estimate: estimated error of the events' factors, relative, and of the tips there and at the end,
            relative to the lengths; None if not estimated.
    """

    model: Model
    name: str
    value: FloatArray
    base: FloatArray
    change: FloatArray
    outcome: PathOutcome
    message: str
    factor: FloatArray
    x: FloatArray
    smallest_eigenvalue: FloatArray | None
    neutral: npt.NDArray[np.bool_] | None
    events: tuple[PathEvent, ...]
    branch: int | None = None
    error_estimate: float | None = None

    @property
    def converged(self) -> bool:
        """Whether factor 1 was reached as asked."""
        return self.outcome is PathOutcome.CONVERGED

    @property
    def stable(self) -> npt.NDArray[np.bool_] | None:
        """Whether every variation of a point that is not neutral costs energy, shape (k,); None where meaningless."""
        if self.smallest_eigenvalue is None or self.neutral is None:
            return None
        return (self.smallest_eigenvalue > 0.0) | self.neutral

    def inputs(self, factor: float) -> FloatArray:
        """Stacked inputs at a factor."""
        return self.base + factor * self.change

    def tip(self, rod: str | None = None) -> Pose:
        """Poses of a rod's tip at the k points of the path; the name may be left out where there is one rod."""
        return _tips(self.model, self.x, self.model.rod_name(rod))

    def event_tip(self, event: PathEvent, rod: str | None = None) -> Pose:
        """Pose of a rod's tip at an event, shapes (1, …)."""
        return _tips(self.model, event.x[None, :], self.model.rod_name(rod))

    def section(self, rod: str | None = None) -> float:
        """Abscissa of the section whose way tells most: the tip, of a held rod where the followed load acts, or 1/2."""
        name, scene = self.model.rod_name(rod), self.model.scene
        if all(holder.rod != name for holder in (*scene.supports, *scene.joints)):
            return 1.0
        load = next(load for load in scene.causes if load.name == self.name.split(".")[0])
        return float(getattr(load, "at", 0.5)) if getattr(load, "rod", name) == name else 0.5

    def position(self, X: float, rod: str | None = None) -> FloatArray:
        """Positions of a section at the k points of the path, shape (k, 3), m."""
        return _positions(self.model, self.x, self.model.rod_name(rod), X)

    def event_position(self, event: PathEvent, X: float, rod: str | None = None) -> FloatArray:
        """Position of a section at an event, shape (3,), m."""
        return np.asarray(_positions(self.model, event.x[None, :], self.model.rod_name(rod), X)[0])

    def solution(self, index: int) -> Solution:
        """A point of the path as a solution, whose shape, strain and wrenches may be asked for."""
        factor, x = float(self.factor[index]), self.x[index]
        stable, least = self.stable, self.smallest_eigenvalue
        return Solution(
            self.model,
            self.inputs(factor),
            x,
            Outcome.CONVERGED,
            Outcome.CONVERGED.value,
            residual_norm=relative_norm(self.model.residual(x, self.inputs(factor)).full()[:, 0], x),
            iterations=0,
            smallest_eigenvalue=None if least is None else float(least[index]),
            stable=None if stable is None else bool(stable[index]),
        )


@dataclass(frozen=True)
class _Followed:
    """One input of a model that grows from zero.

    Attributes:
        model: the model.
        name: the input.
        base: stacked inputs with this one at zero.
        change: what is added to them at factor 1.
    """

    model: Model
    name: str
    base: FloatArray
    change: FloatArray

    @cached_property
    def potential(self) -> bool:
        """Whether all loads have a potential along the path."""
        return self.model.has_potential(self.base) and self.model.has_potential(self.base + self.change)

    @property
    def monitor(self) -> Monitor:
        """Eigenvalues of the second variation where that has a meaning, else the determinant."""
        if not self.potential:
            return DETERMINANT
        allowed = variations(self.model)
        return Monitor(lambda jacobian, _: admissible_eigenvalues(jacobian, allowed), feels_limits=True)

    @cached_property
    def scale(self) -> FloatArray:
        """Units of the unknowns along the curve, shape (n,): multipliers grow with the load and count relative to it.

        Otherwise a strong load on a held rod would make a long way of small steps.
        """
        rate = self.model.path_rate(np.zeros(self.model.size), self.base, 1.0, self.change, 0.0).full()
        scale = np.ones(self.model.size)
        scale[variations(self.model).held] = max(1.0, float(np.linalg.norm(rate)))
        return scale

    def curve(self, start: FloatArray, settings: ArcSettings) -> Curve:
        """The path's equations in scaled unknowns."""
        plain, scale = input_path(self.model, start, self.base, self.base + self.change), self.scale
        scaled = Path(
            residual=lambda x, t: plain.residual(scale * x, t),
            jacobian=lambda x, t: dense(plain.jacobian(scale * x, t)) * scale,
            rate=lambda x, t: plain.rate(scale * x, t),
            start=start / scale,
        )
        return Curve(scaled, self.monitor, settings)

    def record(self, found: Trace, message: str = "") -> EquilibriumPath:
        """What was found, as arrays."""
        outcome = found.outcome or PathOutcome.MAX_STEPS
        y = np.array([p.y for p in found.points]).reshape(-1, self.model.size + 1)
        tests = [judged(p.spectrum) for p in found.points] if self.potential else None
        place = self.model.inputs.slices[self.name]
        shape = self.model.inputs.defaults[self.model.inputs.names.index(self.name)].shape
        return EquilibriumPath(
            model=self.model,
            name=self.name,
            value=self.change[place].reshape(shape, order="F"),
            base=self.base,
            change=self.change,
            outcome=outcome,
            message=message or _sentence(outcome, y[:, -1]),
            factor=y[:, -1],
            x=y[:, :-1] * self.scale,
            smallest_eigenvalue=None if tests is None else np.array([t.smallest_eigenvalue for t in tests]),
            neutral=None if tests is None else np.array([t.neutral for t in tests], dtype=np.bool_),
            events=_events(found, self.scale),
            branch=found.branch,
        )


def follow_path(
    model: Model,
    name: str,
    value: npt.ArrayLike,
    values: Mapping[str, npt.ArrayLike] | None = None,
    *,
    branch: int = 0,
    settings: ArcSettings | None = None,
    progress: Progress | None = None,
) -> EquilibriumPath:
    """Follow the equilibrium of a model while one input grows from zero to a value, through folds and back.

    The path starts at the equilibrium with that input at zero and all other inputs at their values, goes straight on
    through bifurcations, and ends where the factor first reaches 1.

    Args:
        model: what to follow, on the discretisation it has.
        name: the input, such as "push.force".
        value: its value at factor 1, shaped as the input, SI units.
        values: other inputs by name; those not named keep the scene's values.
        branch: number of the bifurcation, counted from 1, to leave at along the branch that crosses there; negative
            for the other half of that branch, 0 goes straight on.
        settings: limits.
        progress: told the largest factor reached.

    Raises:
        SceneError: the input is unknown, or a value is refused.
    """
    followed = _followed(model, name, value, values)
    start = solve(model, model.inputs.unpack(followed.base))
    if not start.converged:
        none = Trace([], outcome=PathOutcome.NO_START)
        return followed.record(none, f"{PathOutcome.NO_START.value} {start.message}")
    curve = followed.curve(start.x, settings or ArcSettings())
    return followed.record(trace(curve, branch=branch, progress=progress))


def _followed(model: Model, name: str, value: npt.ArrayLike, values: Mapping[str, npt.ArrayLike] | None) -> _Followed:
    full = model.pack({**(values or {}), name: value})
    base = full.copy()
    base[model.inputs.slices[name]] = 0.0
    return _Followed(model, name, base, full - base)


def _sentence(outcome: PathOutcome, factors: FloatArray) -> str:
    if outcome is PathOutcome.CONVERGED or not len(factors):
        return outcome.value
    return f"{outcome.value} Largest factor reached: {factors.max():.6g}; last: {factors[-1]:.6g}."


def _events(found: Trace, scale: FloatArray) -> tuple[PathEvent, ...]:
    lengths = np.array([point.length for point in found.points])
    return tuple(
        PathEvent(
            event.kind,
            event.point.factor,
            event.point.x * scale,
            event.multiplicity,
            int(np.searchsorted(lengths, event.point.length, side="right")),
        )
        for event in found.events
    )


def _tips(model: Model, x: FloatArray, rod: str) -> Pose:
    """Poses of a tip for unknowns of shape (k, n)."""
    none = np.zeros(model.inputs.size)
    found = [[part.full() for part in model.tip[rod](row, none)] for row in x]
    position = np.array([p[:, 0] for p, _, _ in found]).reshape(-1, 3)
    quaternion = np.array([q[:, 0] for _, q, _ in found]).reshape(-1, 4)
    rotation = np.array([r for _, _, r in found]).reshape(-1, 3, 3)
    return Pose(position, rotation, quaternion)


def _positions(model: Model, x: FloatArray, rod: str, X: float) -> FloatArray:
    """Positions of a section for unknowns of shape (k, n), shape (k, 3)."""
    none = np.zeros(model.inputs.size)
    return np.array([model.shape[rod](row, none, X)[0].full()[:, 0] for row in x]).reshape(-1, 3)
