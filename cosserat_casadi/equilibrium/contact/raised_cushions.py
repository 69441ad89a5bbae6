"""Where contact is, more sharply: the cushions are raised under each node until rods lie on the obstacles.

A cushion gives way, and where it does a line of contact and a point close by look the same. Raised by what pressed it
in, again and again, it holds the nodes at the surface itself, with the same pressure: the augmented Lagrangian method
(M. R. Hestenes, J. Optim. Theory Appl. 4 (1969) 303) on the nodes of coarse elements.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from cosserat_casadi.equilibrium.contact.contact_state import ContactState, Touch
from cosserat_casadi.equilibrium.contact.cushions import Pressure, pressed_balls
from cosserat_casadi.equilibrium.contact.gaps import gap_along, runs
from cosserat_casadi.equilibrium.load_path import column
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.loads.penetration import Penetration
from cosserat_casadi.maths.numbers import known
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.numerics.newton import Equations, NewtonResult, NewtonSettings, newton
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.scene.load_records import LoadRecord
from cosserat_casadi.scene.obstacle_records import ObstacleRecord

ROUNDS = 12
"""Times that cushions are raised."""

STIFFENINGS = 4
"""Rounds from the first one in which cushions are made stiffer as well."""

STIFFER = 4.0
"""Factor on the stiffness of cushions in such a round."""

LINE = 0.06
"""Stretch of nodes that are held from which a line of contact is tried before a point."""

APART = 0.1
"""Distance of two stretches of held nodes on one obstacle below which they may be one."""


@dataclass(frozen=True)
class Sharpened:
    """Rods and bodies on cushions that hold them at the surface of the obstacles.

    Attributes:
        shape: the equilibrium.
        pressures: stretches of nodes that are held, rod by rod.
        balls: contacts of bodies that are held.
    """

    shape: Solution
    pressures: list[Pressure]
    balls: list[Touch]


def sharpened(cushioned: Solution) -> Sharpened | None:
    """Rods on cushions that hold their nodes at the surface of the obstacles, and what presses on them.

    Args:
        cushioned: an equilibrium on cushions that give way.

    Returns:
        shape and pressure; None where Newton's method does not end on the way.
    """
    model = cushioned.model
    cushions = _cushions(model)
    values = {name: np.asarray(value) for name, value in model.inputs.unpack(cushioned.inputs).items()}
    raised = {cushion.name: np.zeros(len(cushion.raised[0])) for cushion in cushions if cushion.rod is not None}
    solution = cushioned
    for number in range(ROUNDS):
        factor = STIFFER if number < STIFFENINGS else 1.0
        for cushion in cushions:
            values[f"{cushion.name}.stiffness"] = factor * values[f"{cushion.name}.stiffness"]
            if cushion.rod is None:
                # A body touches at one point: there is no line that it could be mistaken for.
                continue
            gaps = _nodal_gaps(solution, cushion.rod, cushion.obstacle)
            # Pressure grows with the square of the depth: on a stiffer one the same pressure is less deep.
            raised[cushion.name] = np.maximum(raised[cushion.name] - gaps, 0.0) / np.sqrt(factor)
            values[f"{cushion.name}.raised"] = raised[cushion.name]
        inputs = model.pack(values)
        result = _balanced(model, inputs, solution.x)
        if result.outcome is not Outcome.CONVERGED:
            return None
        solution = replace(solution, inputs=inputs, x=result.x, iterations=solution.iterations + result.iterations)
    pressures: list[Pressure] = []
    for cushion in cushions:
        if cushion.rod is None:
            continue
        held = raised[cushion.name]
        X = _nodes(model, cushion.rod)
        parts = runs(held > 0.0)
        pressures += [Pressure(cushion.rod, cushion.obstacle.name, X[part], held[part] ** 2) for part in parts]
    return Sharpened(solution, pressures, list(pressed_balls(solution)))


def _cushions(model: Model) -> list[Penetration]:
    loads: Sequence[LoadRecord] = model.scene.loads
    return [load for load in loads if isinstance(load, Penetration)]


def _nodes(model: Model, rod: str) -> FloatArray:
    return known(model.discrete.rods[rod].grid.nodes)


def _nodal_gaps(solution: Solution, rod: str, obstacle: ObstacleRecord) -> FloatArray:
    """Gaps at the nodes of a rod, shape (M,), m."""
    length = solution.model.discrete.rods[rod].length
    X = _nodes(solution.model, rod)
    return length * gap_along(solution, rod, obstacle, X)


def _balanced(model: Model, inputs: FloatArray, x: FloatArray) -> NewtonResult:
    equations = Equations(
        lambda x: column(model.path_residual(x, inputs, 1.0)),
        lambda x: np.asarray(model.path_jacobian(x, inputs, 1.0).full()),
    )
    return newton(equations, x, NewtonSettings())


def likely_states(held: Sharpened) -> list[ContactState]:
    """The contacts that the pressure at the nodes looks like: stretch by stretch, and with those close by joined."""
    pressures = held.pressures
    joined: list[Pressure] = []
    for pressure in pressures:
        if joined:
            before = joined[-1]
            same = (before.rod, before.obstacle) == (pressure.rod, pressure.obstacle)
            if same and pressure.X[0] - before.X[-1] < APART:
                X = np.concatenate([before.X, pressure.X])
                joined[-1] = replace(before, X=X, values=np.concatenate([before.values, pressure.values]))
                continue
        joined.append(pressure)
    states = [
        ContactState.of([*(_touch(pressure) for pressure in stretches), *held.balls])
        for stretches in (pressures, joined)
    ]
    return states if len(joined) < len(pressures) else states[:1]


def _touch(pressure: Pressure) -> Touch:
    """The contact that a stretch of nodes looks like which are held."""
    start, end = float(pressure.X[0]), float(pressure.X[-1])
    if end - start > LINE:
        return Touch.line(pressure.obstacle, pressure.rod, start, end)
    if end == 1.0:
        return Touch.point(pressure.obstacle, pressure.rod, end)
    return Touch.point(pressure.obstacle, pressure.rod, float(pressure.X @ pressure.values / pressure.values.sum()))
