"""Which points of the work–precision plane are measured: methods, modes, intervals, and what the dial picks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.errors import Problem
from cosserat_casadi.model.discretise import discretise
from cosserat_casadi.model.scene_rods import rod_properties
from cosserat_casadi.rod.discretisation import TRANSPORTS, Discretisation

Item = TypeVar("Item")

DIAL = "dial"
"""The method that picks modes, intervals and integrator for a tolerance."""

METHODS = (*TRANSPORTS, DIAL)
"""Quantities that can be measured."""

MODES = (2, 3, 4, 5, 6, 8, 10, 13, 17)
"""Modes of every admitted strain."""

RATIOS = (1.2, 1.8)
"""Intervals for each mode."""

TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10)
"""Tolerances that the dial is set to."""

QUICK = 4
"""Points for each method of a quick look."""


@dataclass(frozen=True)
class Candidate:
    """One point to be measured.

    Attributes:
        method: one of METHODS.
        modes: polynomials of every strain; None where the dial picks them.
        nodes: Chebyshev intervals; None where the dial picks them.
        tolerance: what the dial is set to; None for the others.
        strain: strain model where it is not that of the scene, else empty.
    """

    method: str
    modes: int | None = None
    nodes: int | None = None
    tolerance: float | None = None
    strain: str = ""

    @property
    def name(self) -> str:
        """Its name, unlike that of any other point."""
        setting = f"{self.modes}/{self.nodes}"
        if self.tolerance is not None:
            setting = f"{self.tolerance:g}"
        words = (self.strain, self.method, setting)
        return " ".join(word for word in words if word)

    def discretisation(self, scene: scenes.Scene) -> dict[str, Discretisation]:
        """Modes and intervals of every rod; not for a point of the dial."""
        return discretise(scene, self.modes, self.nodes, self.method)


def candidates(methods: Sequence[str], points: int | None = None) -> list[Candidate]:
    """The points of some methods, cheap ones first and methods in turns, so that every beginning is a whole picture.

    Args:
        methods: out of METHODS.
        points: most points for each method, spread over the grid; all by default.
    """
    columns = []
    for method in methods:
        if method == DIAL:
            tolerances = _spread(TOLERANCES, points)
            columns.append([Candidate(DIAL, tolerance=tolerance) for tolerance in tolerances])
        else:
            sizes = _spread(_sizes(), points)
            columns.append([Candidate(method, modes, nodes) for modes, nodes in sizes])
    longest = max(map(len, columns), default=0)
    in_turns = []
    for i in range(longest):
        in_turns += [column[i] for column in columns if i < len(column)]
    return in_turns


def _sizes() -> list[tuple[int, int]]:
    """Pairs of modes and intervals, the cheapest first."""
    sizes = set()
    for modes in MODES:
        for ratio in RATIOS:
            nodes = max(2, round(modes * ratio))
            sizes.add((modes, nodes))
    # The cost grows about like their product.
    return sorted(sizes, key=lambda size: (size[0] * size[1], size))


def _spread(items: Sequence[Item], count: int | None) -> list[Item]:
    if count is None or count >= len(items):
        return list(items)
    indices = np.linspace(0, len(items) - 1, count)
    return [items[round(index)] for index in indices]


def method_problems(names: Sequence[str], points: int | None) -> list[Problem]:
    """Faults of the wanted methods and of the number of points."""
    known = ", ".join(METHODS)
    unknown = [name for name in names if name not in METHODS]
    problems = [Problem("--methods", f"{name!r} is no method", f"out of {known}") for name in unknown]
    if not names:
        problems.append(Problem("--methods", "must name at least one method", f"out of {known}"))
    if points is not None and points < 1:
        problems.append(Problem("--points", f"must be at least 1, got {points}"))
    return problems


def distinct_methods(scene: scenes.Scene, methods: Sequence[str]) -> list[str]:
    """Methods without repetition; one Magnus method where every rod turns about one axis, as all are one there."""
    chosen = list(dict.fromkeys(methods))
    axes = [len(rod_properties(rod).turning_axes) for rod in scene.rods]
    if max(axes) > 1:
        return chosen
    # Rotations about one axis commute, so that no method needs a commutator (docs/theory.md, section 4).
    magnus = [method for method in chosen if method.startswith("magnus")]
    repeated = magnus[1:]
    return [method for method in chosen if method not in repeated]
