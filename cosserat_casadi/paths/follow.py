"""Equilibrium paths of a model: one input grows from zero, the equilibrium is followed through folds and branches.

See docs/theory.md, section 12.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from cosserat_casadi.equilibrium.load_path import column, input_path
from cosserat_casadi.equilibrium.smooth_contact import depths_along
from cosserat_casadi.equilibrium.solution import Pose, Solution
from cosserat_casadi.equilibrium.solve import solve
from cosserat_casadi.equilibrium.stability import admissible_eigenvalues, stability_of, variations
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.obstacle_checks import refuse_obstacles
from cosserat_casadi.numerics.arclength import ArcSettings, Curve, Monitor
from cosserat_casadi.numerics.broyden import dense
from cosserat_casadi.numerics.continuation import Path
from cosserat_casadi.numerics.events import DETERMINANT, Event
from cosserat_casadi.numerics.newton import relative_norm
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.numerics.progress import Progress
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
        every_variation_costs = self.smallest_eigenvalue > 0.0
        return every_variation_costs | self.neutral

    @property
    def all_inputs(self) -> FloatArray:
        """Stacked inputs at all points, shape (k, model.inputs.size)."""
        return self.base + self.factor[:, None] * self.change

    def inputs(self, factor: float) -> FloatArray:
        """Stacked inputs at a factor."""
        change = factor * self.change
        return self.base + change

    def tip(self, rod: str | None = None) -> Pose:
        """Poses of a rod's tip at the k points of the path; the name may be left out where there is one rod."""
        name = self.model.rod_name(rod)
        return self._tips(name, self.factor, self.x)

    def event_tip(self, event: PathEvent, rod: str | None = None) -> Pose:
        """Pose of a rod's tip at an event, shapes (1, …)."""
        name = self.model.rod_name(rod)
        return self._tips(name, [event.factor], [event.x])

    def section(self, rod: str | None = None) -> float:
        """Abscissa of the section whose way tells most of the path.

        The tip of a free rod; of a rod held at its tip where the followed load acts, or its middle.
        """
        name = self.model.rod_name(rod)
        scene = self.model.scene
        tip_is_free = all(holder.rod != name for holder in (*scene.supports, *scene.joints))
        if tip_is_free:
            return 1.0
        # The tip of a held rod does not move, so that its way tells nothing.
        load_name = next(entry.owner for entry, _ in self.model.inputs if entry.name == self.name)
        load = next(load for load in scene.causes if load.name == load_name)
        if getattr(load, "rod", name) != name:
            return 0.5
        return float(getattr(load, "at", 0.5))

    def position(self, X: float, rod: str | None = None) -> FloatArray:
        """Positions of a section at the k points of the path, shape (k, 3), m."""
        name = self.model.rod_name(rod)
        return self._positions(name, X, self.factor, self.x)

    def event_position(self, event: PathEvent, X: float, rod: str | None = None) -> FloatArray:
        """Position of a section at an event, shape (3,), m."""
        name = self.model.rod_name(rod)
        positions = self._positions(name, X, [event.factor], [event.x])
        return np.asarray(positions[0])

    def solution(self, index: int) -> Solution:
        """A point of the path as a solution, whose shape, strain and wrenches may be asked for."""
        x = self.x[index]
        inputs = self.inputs(float(self.factor[index]))
        residual = column(self.model.residual(x, inputs))
        solution = Solution(
            self.model,
            inputs,
            x,
            Outcome.CONVERGED,
            Outcome.CONVERGED.value,
            residual_norm=relative_norm(residual, x),
            iterations=0,
        )
        stable = self.stable
        if stable is None or self.smallest_eigenvalue is None:
            return solution
        return replace(
            solution,
            smallest_eigenvalue=float(self.smallest_eigenvalue[index]),
            stable=bool(stable[index]),
        )

    def _tips(self, rod: str, factors: Iterable[float], unknowns: Iterable[FloatArray]) -> Pose:
        """Poses of a rod's tip at k equilibria.

        Args:
            rod: name of the rod.
            factors: factor of each equilibrium.
            unknowns: unknowns of each, shape (model.size,).
        """
        tip = self.model.tip[rod]
        positions = []
        quaternions = []
        rotations = []
        for factor, x in zip(factors, unknowns, strict=True):
            # The length and the base of a rod may be inputs.
            inputs = self.inputs(factor)
            position, quaternion, rotation = tip(x, inputs)
            positions.append(position.full()[:, 0])
            quaternions.append(quaternion.full()[:, 0])
            rotations.append(rotation.full())
        return Pose(
            position=np.array(positions).reshape(-1, 3),
            rotation=np.array(rotations).reshape(-1, 3, 3),
            quaternion=np.array(quaternions).reshape(-1, 4),
        )

    def _positions(self, rod: str, X: float, factors: Iterable[float], unknowns: Iterable[FloatArray]) -> FloatArray:
        """Positions of a section at k equilibria, shape (k, 3), m; arguments as in :meth:`_tips`."""
        section_pose = self.model.shape[rod]
        positions = []
        for factor, x in zip(factors, unknowns, strict=True):
            inputs = self.inputs(factor)
            position, _ = section_pose(x, inputs, X)
            positions.append(position.full()[:, 0])
        return np.array(positions).reshape(-1, 3)


@dataclass(frozen=True)
class _Followed:
    """One input of a model that grows from zero.

    Attributes:
        model: the model.
        name: the input.
        base: stacked inputs with this one at zero.
        change: what is added to them at the load factor 1.
    """

    model: Model
    name: str
    base: FloatArray
    change: FloatArray

    @cached_property
    def potential(self) -> bool:
        """Whether all loads have a potential along the path."""
        has_potential = self.model.has_potential
        end = self.base + self.change
        return has_potential(self.base) and has_potential(end)

    @property
    def monitor(self) -> Monitor:
        """Eigenvalues of the second variation where that has a meaning, else the determinant."""
        if not self.potential:
            return DETERMINANT
        # Eigenvalues see a double bifurcation too, where the determinant keeps its sign.
        allowed = variations(self.model)

        def eigenvalues(jacobian: FloatArray, _bordered: FloatArray) -> FloatArray:
            return admissible_eigenvalues(jacobian, allowed)

        return Monitor(eigenvalues, feels_limits=True)

    @cached_property
    def scale(self) -> FloatArray:
        """Units of the unknowns along the curve, shape (n,): multipliers grow with the load and count relative to it.

        Otherwise a strong load on a held rod would make a long way of small steps.
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
            # The chain rule: one column an unknown.
            unscaled_jacobian = dense(unscaled.jacobian(scale * x, t))
            return unscaled_jacobian * scale

        scaled = Path(
            residual=lambda x, t: unscaled.residual(scale * x, t),
            jacobian=jacobian,
            rate=lambda x, t: unscaled.rate(scale * x, t),
            start=start / scale,
        )
        return Curve(scaled, self.monitor, settings)

    def record(self, traced: Trace, message: str = "") -> EquilibriumPath:
        """A trace as arrays.

        Args:
            traced: what has been computed of the curve.
            message: a sentence for the user; by default that of the outcome.
        """
        outcome = traced.outcome or PathOutcome.MAX_STEPS
        # Without a point there are no rows, but columns all the same.
        y = np.array([point.y for point in traced.points]).reshape(-1, self.model.size + 1)
        load_factors = y[:, -1]
        smallest_eigenvalue = None
        neutral = None
        if self.potential:
            tests = [stability_of(point.spectrum) for point in traced.points]
            smallest_eigenvalue = np.array([test.smallest_eigenvalue for test in tests])
            neutral = np.array([test.neutral for test in tests], dtype=np.bool_)
        return EquilibriumPath(
            model=self.model,
            name=self.name,
            value=self._value(),
            base=self.base,
            change=self.change,
            outcome=outcome,
            message=message or _sentence(outcome, load_factors),
            factor=load_factors,
            x=y[:, :-1] * self.scale,
            smallest_eigenvalue=smallest_eigenvalue,
            neutral=neutral,
            events=self._events(traced),
            branch=traced.branch,
        )

    def _value(self) -> FloatArray:
        """The followed input at the load factor 1, shaped as the input."""
        layout = self.model.inputs
        index = layout.names.index(self.name)
        shape = layout.defaults[index].shape
        stacked = self.change[layout.slices[self.name]]
        return stacked.reshape(shape, order="F")

    def _events(self, traced: Trace) -> tuple[PathEvent, ...]:
        """The events of a trace as those of the path."""
        lengths = np.array([point.length for point in traced.points])
        events = [self._event(event, lengths) for event in traced.events]
        return tuple(events)

    def _event(self, event: Event, lengths: FloatArray) -> PathEvent:
        """An event of the curve as one of the path.

        Args:
            event: of the curve in scaled unknowns.
            lengths: arclengths of the points of the path, ascending.
        """
        point = event.point
        # An event that is a point of the path, where a branch leaves, lies before what follows it.
        position = np.searchsorted(lengths, point.length, side="right")
        return PathEvent(
            kind=event.kind,
            factor=point.load_factor,
            x=point.x * self.scale,
            multiplicity=event.multiplicity,
            position=int(position),
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
        progress: receives the largest factor reached.

    Raises:
        SceneError: the input is unknown, or a value is refused.
    """
    refuse_obstacles(model.scene, "a path")
    model = model.at()
    followed = _followed(model, name, value, values)
    values_at_zero = model.inputs.unpack(followed.base)
    start = solve(model, values_at_zero)
    if not start.converged:
        outcome = PathOutcome.NO_START
        empty = Trace([], outcome=outcome)
        return followed.record(empty, f"{outcome.value} {start.message}")
    curve = followed.curve(start.x, settings or ArcSettings())
    traced = trace(curve, branch=branch, progress=progress)
    return _unless_too_deep(followed.record(traced))


def _unless_too_deep(path: EquilibriumPath) -> EquilibriumPath:
    """The path; not resolved where rods are deeper inside smooth obstacles than their width on the way."""
    if not path.converged or not path.model.scene.obstacles:
        return path
    depths = depths_along(path.model, path.x, path.all_inputs)
    too_deep = np.flatnonzero(depths > 1.0)
    if not len(too_deep):
        return path
    message = (
        f"{PathOutcome.UNRESOLVED.value} From factor {path.factor[too_deep[0]]:.6g} on a rod is up to "
        f"{depths.max():.3g} widths deep inside an obstacle, too deep to be contact: give the obstacle more width or "
        "stiffness."
    )
    return replace(path, outcome=PathOutcome.UNRESOLVED, message=message)


def _followed(model: Model, name: str, value: npt.ArrayLike, values: Mapping[str, npt.ArrayLike] | None) -> _Followed:
    """The input to follow, its value checked with the others.

    Raises:
        SceneError: the input is unknown, or a value is refused.
    """
    given = dict(values or {})
    given[name] = value
    full = model.pack(given)
    base = full.copy()
    # The followed input grows from zero, whatever the scene gives it; all others keep their values.
    base[model.inputs.slices[name]] = 0.0
    change = full - base
    return _Followed(model, name, base, change)


def _sentence(outcome: PathOutcome, load_factors: FloatArray) -> str:
    if outcome is PathOutcome.CONVERGED or not len(load_factors):
        return outcome.value
    largest = load_factors.max()
    last = load_factors[-1]
    return f"{outcome.value} Largest factor reached: {largest:.6g}; last: {last:.6g}."
