"""Equilibria along one input as data: points, events, stability, and functions of a path."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any, Generic, Protocol, Self, TypeVar

import numpy as np
import numpy.typing as npt

from cosserat_casadi.equilibrium.load_path import column, input_path
from cosserat_casadi.equilibrium.rubbing import RubbingStretch
from cosserat_casadi.equilibrium.smooth_contact import with_smooth_contacts
from cosserat_casadi.equilibrium.solution import ModelType, SectionForce, Solution, SolvedPoses
from cosserat_casadi.equilibrium.stability import stability_of
from cosserat_casadi.maths.calls import evaluated
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.numerics.arclength import ArcPoint, ArcSettings, Curve
from cosserat_casadi.numerics.events import DETERMINANT
from cosserat_casadi.numerics.newton import relative_norm
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.numerics.trace import PathOutcome, Trace
from cosserat_casadi.result import Result


class AlongPath(Protocol):
    """An event, or another object, between two points of a path."""

    @property
    def position(self) -> int:
        """Index of the first point beyond it."""


EventType = TypeVar("EventType", bound=AlongPath)
PathType = TypeVar("PathType")


@dataclass(frozen=True)
class PathContact:
    """A contact along a path.

    Attributes:
        obstacle: name of the obstacle.
        owner: name of the rod, or of the body, that touches.
        start: abscissa X at which it begins; 0 for a body.
        end: abscissa at which it ends; ``start`` for a point.
        kind: "point" or "line".
        ends: force at the point, or at both ends of a line, along the normals there, N; empty at an event.
        of_body: whether it is a body that touches.
        inside: forces at sections inside a line.
        on_rods: X of either of two rods that touch; None of contact with an obstacle.
        friction: force of friction on the rod, world axes, N; None without friction.
        slips: whether the rod slides on the obstacle; None without friction.
    """

    obstacle: str
    owner: str
    start: float
    end: float
    kind: str
    ends: tuple[float, ...]
    of_body: bool = False
    inside: tuple[SectionForce, ...] = ()
    on_rods: tuple[float, float] | None = None
    friction: tuple[float, float, float] | None = None
    slips: bool | None = None


@dataclass(frozen=True)
class PathEvent:
    """A limit point, a bifurcation, or a change of the contacts of a path.

    Attributes:
        kind: "limit" or "bifurcation"; or "touch", "lift_off", "point_to_line", "line_to_point", "slide_to_tip" or
            "slide_from_tip" for a contact; "slip" or "stick" with friction.
        factor: share of the input at the event.
        x: unknowns at the event, shape (model.size,).
        multiplicity: number of independent neutral directions at the event.
        position: index of the first point of the path that lies beyond it.
        arrangement: index of the arrangement of contacts of its unknowns.
        contact: the contact that changes, at the event; None if none does.
    """

    kind: str
    factor: float
    x: FloatArray
    multiplicity: int
    position: int
    arrangement: int = 0
    contact: PathContact | None = None


CONTACT_WORDS = {
    "touch": "touch",
    "lift_off": "lift-off",
    "point_to_line": "point to line",
    "line_to_point": "line to point",
    "slide_to_tip": "slide to the tip",
    "slide_from_tip": "slide from the tip",
    "slide_over_joint": "slide over a joint",
    "slip": "slip",
    "stick": "stick",
}
"""Kinds of events that are changes of contact, in words."""


@dataclass(frozen=True)
class InputChange(Generic[ModelType]):
    """The change of one input of a model; for rods in exact contact also of several inputs, and of parameters.

    Attributes:
        model: the model.
        name: name of the followed input, or of the first one of several.
        base: stacked inputs at factor 0, shape (model.inputs.size,), followed by parameters if these move.
        change: values at factor 1 less ``base``, in the shape of ``base``.
    """

    model: ModelType
    name: str
    base: FloatArray
    change: FloatArray

    def inputs(self, factor: float) -> FloatArray:
        """Stacked inputs at a factor."""
        change = factor * self.change
        return self.base + change


def loads_have_potential(way: InputChange[Model]) -> bool:
    """Whether all loads have a potential along the change of an input."""
    count = way.model.inputs.size
    return all(way.model.has_potential(way.inputs(factor)[:count]) for factor in (0.0, 1.0))


def path_along(way: InputChange[Any], kind: Callable[..., PathType], outcome: PathOutcome, **fields: Any) -> PathType:
    """A path of a kind along the change of an input, by default with the sentence of its outcome."""
    of_way = {"model": way.model, "name": way.name, "base": way.base, "change": way.change}
    return kind(**{**of_way, "outcome": outcome, "message": outcome.value, **fields})


@dataclass(frozen=True, repr=False, kw_only=True)
class InputPath(Result, InputChange[ModelType], Generic[ModelType, EventType]):
    """Equilibria of a model, of rods or of concentric tubes, while one of its inputs moves.

    Attributes:
        outcome: how the path ended.
        message: a sentence for the user.
        factor: share of the change at each of k points in the order of travel, shape (k,).
        x: unknowns, shape (k, model.size).
        events: limit points and bifurcations in the order of travel.
        error_estimate: estimated error of the factors of events, relative, and of poses and lengths of cables at
            events, at both ends and between, as for an equilibrium; None if not estimated.
    """

    outcome: PathOutcome
    message: str
    factor: FloatArray
    x: FloatArray
    events: tuple[EventType, ...]
    error_estimate: float | None = None

    @property
    def converged(self) -> bool:
        """Whether factor 1 was reached."""
        return self.outcome is PathOutcome.CONVERGED

    @property
    def all_inputs(self) -> FloatArray:
        """Stacked inputs at all points, shape (k, model.inputs.size)."""
        return self.base + self.factor[:, None] * self.change

    @property
    def stretches(self) -> list[range]:
        """Indices of the points before the first event, between successive events, and beyond the last one."""
        bounds = [0, *(event.position for event in self.events), len(self.factor)]
        return [range(first, behind) for first, behind in itertools.pairwise(bounds)]

    def between_events(self, finer: Self) -> Iterator[tuple[int, int, FloatArray | None]]:
        """Equilibria of a finer path with equal events at quarters of each stretch between events of this path.

        Yields:
            index of a point of this path away from events; index of a nearby point of the finer path; unknowns of the
            finer path at the factor of the first point, None if Newton's method does not converge.
        """
        for stretch, finer_stretch in zip(self.stretches, finer.stretches, strict=True):
            quarters = np.linspace(stretch.start, stretch.stop - 1, 5)[1:-1].astype(int)
            for index in np.unique(quarters).tolist():
                if index in stretch[1:-1] and len(finer_stretch) > 1:
                    yield index, *finer._unknowns_at(float(self.factor[index]), finer_stretch)

    def _unknowns_at(self, factor: float, stretch: range) -> tuple[int, FloatArray | None]:
        """Unknowns at a factor, solved for from the chord between the neighbouring points of a stretch.

        Returns:
            index of the second of these points; unknowns, None if Newton's method does not converge.
        """
        factors = self.factor[stretch.start : stretch.stop]
        lower = np.minimum(factors[:-1], factors[1:])
        upper = np.maximum(factors[:-1], factors[1:])
        missed = np.maximum(np.maximum(lower - factor, factor - upper), 0.0)
        after = stretch[int(np.argmin(missed)) + 1]
        way = self.factor[after] - self.factor[after - 1]
        share = 0.0
        if way != 0.0:
            share = float(np.clip((factor - self.factor[after - 1]) / way, 0.0, 1.0))
        start = self.x[after - 1] + share * (self.x[after] - self.x[after - 1])
        return after, self._corrected(after, start, factor)

    def _corrected(self, index: int, start: FloatArray, factor: float) -> FloatArray | None:
        """Unknowns that solve the equations of a point at another factor; None if Newton's method fails."""
        # Inputs of this point alone, such as a history of friction, are kept.
        before = self.all_inputs[index] - self.factor[index] * self.change
        curve = Curve(input_path(self.model, start, before, before + self.change), DETERMINANT, ArcSettings())
        return curve.at(start, factor)


def tested_stability(points: Iterable[ArcPoint]) -> tuple[FloatArray, npt.NDArray[np.bool_]]:
    """Smallest eigenvalue of the second variation at points of a curve, and whether each point is neutral."""
    tests = [stability_of(point.spectrum) for point in points]
    eigenvalues = np.array([test.smallest_eigenvalue for test in tests])
    return eigenvalues, np.array([test.neutral for test in tests], dtype=np.bool_)


def path_events(traced: Trace, scale: FloatArray, begun: int = 0, arrangement: int = 0) -> tuple[PathEvent, ...]:
    """The events of a trace as events of a path.

    Args:
        traced: the computed part of the curve.
        scale: units of the unknowns along the curve, shape (size,).
        begun: number of points of the path before this part.
        arrangement: index of the arrangement of contacts of this part.
    """
    lengths = [point.length for point in traced.points]
    events = []
    for event in traced.events:
        # An event that is a point of the path, at which a branch begins, lies before the points that follow.
        position = begun + int(np.searchsorted(lengths, event.point.length, side="right"))
        x = event.point.x * scale
        events.append(PathEvent(event.kind, event.point.load_factor, x, event.multiplicity, position, arrangement))
    return tuple(events)


@dataclass(frozen=True, repr=False, kw_only=True)
class EquilibriumPath(InputPath[Model, PathEvent]):
    """Equilibria of rods along one of their inputs, which grows from zero, or from a given value.

    Attributes:
        smallest_eigenvalue: smallest eigenvalue of the second variation in units of EI/ℓ, see :class:`Solution`, shape
            (k,); None if loads have no potential.
        neutral: whether a variation costs no energy while none releases any, shape (k,); None if loads have no
            potential.
        branch: index of the first point on the other branch after a switch; None without a switch.
    """

    smallest_eigenvalue: FloatArray | None
    neutral: npt.NDArray[np.bool_] | None
    branch: int | None = None

    @property
    def value(self) -> FloatArray:
        """Value of the input at factor 1, in the shape of the input."""
        return self.value_at(1.0)

    def value_at(self, factor: float) -> FloatArray:
        """Value of the input at a factor, in the shape of the input."""
        return self.model.inputs.unpack(self.inputs(factor))[self.name]

    @property
    def stable(self) -> npt.NDArray[np.bool_] | None:
        """Whether every variation that is not neutral costs energy at each point, shape (k,); None if not defined."""
        if self.smallest_eigenvalue is None or self.neutral is None:
            return None
        every_variation_costs = self.smallest_eigenvalue > 0.0
        return every_variation_costs | self.neutral

    @property
    def resolution_indices(self) -> FloatArray:
        """Resolution index at all points, shape (k,): one above 1 is not resolved, as a solve would not be."""
        return evaluated(self.model.resolution_index, self.x, self.all_inputs)[0][:, 0, 0]

    def contacts(self, index: int) -> tuple[PathContact, ...]:
        """The contacts at a point of the path; empty in a scene without obstacles."""
        return ()

    def rubbing(self, index: int) -> tuple[RubbingStretch, ...]:
        """The stretches that stick or slip at a point of the path; empty in a scene without friction."""
        return ()

    def tip(self, rod: str | None = None) -> SolvedPoses:
        """Poses of a rod's tip at the k points of the path; the name may be left out in a scene with one rod."""
        name = self.model.rod_name(rod)
        poses = [self._tip(name, *point) for point in self._points]
        return SolvedPoses(
            position=np.array([pose.position for pose in poses]).reshape(-1, 3),
            rotation=np.array([pose.rotation for pose in poses]).reshape(-1, 3, 3),
            quaternion=np.array([pose.quaternion for pose in poses]).reshape(-1, 4),
        )

    def event_tip(self, event: PathEvent, rod: str | None = None) -> SolvedPoses:
        """Pose of a rod's tip at an event."""
        return self._tip(self.model.rod_name(rod), event.x, event.factor, event.arrangement)

    def section(self, rod: str | None = None) -> float:
        """Abscissa of the section whose displacement represents the path.

        It is the tip of a free rod; for a rod held at its tip the section of the followed load, or the middle.
        """
        name = self.model.rod_name(rod)
        scene = self.model.scene
        if name not in scene.rods_held_at_tips:
            return 1.0
        # The tip of a held rod does not move.
        load_name = next(entry.owner for entry, _ in self.model.inputs if entry.name == self.name)
        # An input may belong to a rod and not to a load.
        load = next((load for load in scene.causes if load.name == load_name), None)
        if getattr(load, "rod", name) != name:
            return 0.5
        return float(getattr(load, "at", 0.5))

    def position(self, X: float, rod: str | None = None) -> FloatArray:
        """Positions of a section at the k points of the path, shape (k, 3), m."""
        name = self.model.rod_name(rod)
        return np.array([self._position(name, X, *point) for point in self._points]).reshape(-1, 3)

    def event_position(self, event: PathEvent, X: float, rod: str | None = None) -> FloatArray:
        """Position of a section at an event, shape (3,), m."""
        return self._position(self.model.rod_name(rod), X, event.x, event.factor, event.arrangement)

    def solution(self, index: int) -> Solution:
        """A point of the path as a solution, with shape, strain and wrenches.

        It is UNRESOLVED, as after a solve, if the nodes are too few, or rods are deeper in each other, or in smooth
        obstacles, than the width.
        """
        solution = self._solution(self.x[index], self.all_inputs[index])
        stable = self.stable
        if not solution.converged or stable is None or self.smallest_eigenvalue is None:
            return solution
        return replace(
            solution,
            smallest_eigenvalue=float(self.smallest_eigenvalue[index]),
            stable=bool(stable[index]),
        )

    def shape(self, index: int, x: FloatArray, factor: float) -> Solution:
        """The equilibrium, without stability, with unknowns of a point, or near them at another factor."""
        return self._solution(x, self.all_inputs[index] + (factor - self.factor[index]) * self.change)

    def event_shape(self, event: PathEvent) -> Solution:
        """The equilibrium, without stability, at an event."""
        return self._solution(event.x, self.inputs(event.factor))

    def _solution(self, x: FloatArray, inputs: FloatArray) -> Solution:
        """The equilibrium with unknowns x at some inputs."""
        residual = column(self.model.residual(x, inputs))
        is_resolved = float(self.model.resolution_index(x, inputs)) <= 1.0
        outcome = Outcome.CONVERGED if is_resolved else Outcome.UNRESOLVED
        solution = Solution(
            self.model,
            inputs,
            x,
            outcome,
            outcome.value,
            residual_norm=relative_norm(residual, x),
            iterations=0,
        )
        return with_smooth_contacts(solution)

    @property
    def _points(self) -> Iterable[tuple[FloatArray, float, int]]:
        """Unknowns, factor and index of the arrangement of contacts of each point."""
        return zip(self.x, self.factor.tolist(), itertools.repeat(0))

    def _tip(self, rod: str, x: FloatArray, factor: float, arrangement: int) -> SolvedPoses:
        """Pose of a rod's tip."""
        # The length and the base of a rod may be inputs.
        position, quaternion, rotation = self.model.tip[rod](x, self.inputs(factor))
        return SolvedPoses(position.full()[:, 0], rotation.full(), quaternion.full()[:, 0])

    def _position(self, rod: str, X: float, x: FloatArray, factor: float, arrangement: int) -> FloatArray:
        """Position of a section of a rod, shape (3,), m."""
        position, _ = self.model.shape[rod](x, self.inputs(factor), X)
        return np.asarray(position.full()[:, 0])
