"""Equilibrium of a scene with obstacles, on given modes and nodes.

Cushions show where contact is, and more sharply once they are raised under each node until rods lie on the obstacles. A
cushion gives way, so that a line of contact and a point nearby look alike. Raised again and again by its own
depression, it holds the nodes at the surface itself, with the same pressure: the augmented Lagrangian method (M. R.
Hestenes, J. Optim. Theory Appl. 4 (1969) 303) on the nodes of coarse elements.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, product
from math import inf

import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.contact.contact_alternatives import NEAR
from cosserat_casadi.equilibrium.contact.contact_equations import Grids, richer
from cosserat_casadi.equilibrium.contact.contact_judgement import judged
from cosserat_casadi.equilibrium.contact.contact_search import ContactEquilibrium, Settling
from cosserat_casadi.equilibrium.contact.contact_state import (
    TIP,
    ContactState,
    Touch,
    continuations,
    state_in,
    without_contacts,
)
from cosserat_casadi.equilibrium.contact.cushions import (
    Pressure,
    approach,
    first_state,
    has_thin_obstacles,
    pressed_alone,
)
from cosserat_casadi.equilibrium.contact.gaps import gap_along, runs
from cosserat_casadi.equilibrium.contact.passing_through import passes_through
from cosserat_casadi.equilibrium.load_path import column
from cosserat_casadi.equilibrium.relax import PATH_OF_ENERGY
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.loads.penetration import Penetration
from cosserat_casadi.maths.numbers import known
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.inputs import input_layout
from cosserat_casadi.numerics.newton import Equations, NewtonResult, NewtonSettings, newton
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.numerics.progress import Progress
from cosserat_casadi.numerics.trace import GROWTH
from cosserat_casadi.scene.load_records import LoadRecord
from cosserat_casadi.scene.obstacle_records import ObstacleRecord

ROUNDS = 12
"""Number of rounds in which cushions are raised."""

STIFFENINGS = 4
"""Rounds from the first one in which cushions are made stiffer as well."""

STIFFER = 4.0
"""Factor on the stiffness of cushions in such a round."""

LINE = 0.06
"""Length of a stretch of held nodes above which a line of contact is tried before a point."""

APART = 0.1
"""Distance of two stretches of held nodes on one obstacle below which they may belong to one line."""

LEAST_TOLERANCE = 1e-9
"""Relative depth and pull that may be rounding."""

STAYING = 0.9
"""Ratio to the error that contacts left on coarser modes above which more modes do not mend the error."""

FIRST_SHARE = 0.5
"""First share of the loads at which rods that touch rods are looked for, over the share at which cushions give out."""

LONGEST_SHARE = 0.2
"""Largest growth of that share in a step."""

SHORTEST_SHARE = 1e-3
"""Growth of that share below which the loads grow no further."""

BESIDE_JOINT = 0.15
"""Distance from the joint of two rods within which a stretch on soft cushions may lie on both rods."""


def solve_contact(
    scene: scenes.Scene,
    grids: Grids,
    values: Mapping[str, npt.ArrayLike] | None = None,
    *,
    start: Solution | None = None,
    contacts: ContactState | None = None,
    newton: NewtonSettings | None = None,
    progress: Progress | None = None,
    unmet_before: float = 0.0,
) -> Solution:
    """Find the contacts of a scene and its equilibrium.

    Args:
        scene: scene with obstacles, with values for its parameters.
        grids: modes and nodes of every element.
        values: inputs by name.
        start: a solution of the same rods and obstacles. Its contacts are tried first, unless that takes a rod through
            an obstacle; otherwise, and by default, contacts of the unloaded rods under growing loads.
        contacts: contacts that are tried first from the start; by default the contacts of the start.
        newton: limits of the solve of each state.
        progress: receives the share of the load path that is done.
        unmet_before: error that contacts left on coarser modes; if more modes mend it, contacts that hold to the
            tolerance are enough.
    """
    bare = without_contacts(scene)
    given = input_layout(bare).pack(values)
    settings = newton or NewtonSettings()
    tolerance = max(bare.accuracy.tolerance, LEAST_TOLERANCE)
    settling = Settling(bare, given, grids, settings, tolerance)
    if start is not None:
        near = settled_near(settling, start, contacts, unmet_before)
        if near is not None:
            return judged(near, holds=True, iterations=settling.iterations, tolerance=settings.tolerance)
    cushioned = approach(bare, values, progress)
    settling.iterations += cushioned.iterations
    first = first_state(cushioned)
    # If thin bars cut through their cushions before the full load, the contacts there may still hold.
    guesses = _guesses(cushioned, first) if cushioned.converged else [(first, cushioned)]
    found, holds = _held(
        settling,
        guesses,
        admits=lambda shape: not passes_through(cushioned, shape, deepest=inf),
        unmet_before=unmet_before,
    )
    # From cushions crossed rods may slide off each other, and Newton's method may lead to the other side of a thin bar.
    if not holds and (bare.rods_touch_exactly or has_thin_obstacles(bare)):
        grown = _loads_grown_in_contact(settling, cushioned)
        if grown is not None:
            found, holds = grown, True
    if not cushioned.converged and not holds:
        return replace(cushioned, iterations=settling.iterations)
    if found is None:
        unsettled = Outcome.CONTACT_UNSETTLED
        message = unsettled.value + why_unsettled(bare, (state for state, _ in guesses))
        return replace(cushioned, iterations=settling.iterations, outcome=unsettled, message=message)
    solution = judged(found, holds=holds, iterations=settling.iterations, tolerance=settings.tolerance)
    if solution.converged and PATH_OF_ENERGY in cushioned.message:
        return replace(solution, message=solution.message + PATH_OF_ENERGY)
    if not holds:
        return replace(solution, message=solution.message + why_unsettled(bare, (state for state, _ in guesses)))
    return solution


def settled_near(
    settling: Settling, start: Solution, contacts: ContactState | None = None, unmet_before: float = 0.0
) -> ContactEquilibrium | None:
    """The equilibrium with contacts that hold, from the shape and the contacts of a solution, or other contacts.

    None if no contacts hold, or rods would pass through an obstacle. See :func:`solve_contact`.
    """
    state = state_in(start.model.scene) if contacts is None else contacts
    found, holds = _held(
        settling,
        [(state, start)],
        admits=lambda shape: not passes_through(start, shape),
        unmet_before=unmet_before,
    )
    return found if holds else None


def _held(
    settling: Settling,
    guesses: Sequence[tuple[ContactState, Solution]],
    admits: Callable[[Solution], bool],
    unmet_before: float,
) -> tuple[ContactEquilibrium | None, bool]:
    """Contacts that hold to the tolerance, and whether they hold; see :meth:`Settling.run`.

    If points approximate a line and the rod enters the obstacle by less than the tolerance, places have a larger error:
    the depth is in proportion to its square, or to its fourth power where the weight of a rod presses it down. Then
    contacts whose places hold to the tolerance are sought from there. Few modes leave a depth beside contacts too,
    which more modes reduce: a solve on richer modes tells.
    """
    found, holds = settling.run(guesses, admits)
    if found is None or not holds:
        return found, holds
    lies = any(touch.is_line for touch in found.state.touches)
    if not stays_unmet(found, unmet_before if lies else 0.0, settling.tolerance):
        return found, holds
    if not (lies and unmet_before) and _more_modes_mend(settling, found, admits):
        return found, holds
    closer = replace(settling, error=settling.tolerance)
    closest, holds_closer = closer.run([(found.state, found.solution)], admits)
    settling.iterations = closer.iterations
    return (closest if holds_closer else found), True


def _more_modes_mend(settling: Settling, found: ContactEquilibrium, admits: Callable[[Solution], bool]) -> bool:
    """Whether the same contacts hold on richer modes with a smaller error :meth:`ContactEquilibrium.unmet`."""
    finer = replace(settling, grids=richer(settling.grids, settling.scene))
    more, holds = finer.run([(found.state, found.solution)], admits)
    settling.iterations = finer.iterations
    if more is None or not holds or more.state.signature != found.state.signature:
        return False
    return not stays_unmet(more, found.unmet(), settling.tolerance)


def stays_unmet(found: ContactEquilibrium, before: float, tolerance: float) -> bool:
    """Whether contacts have an error above a tolerance that is not below the error on coarser modes either."""
    return found.unmet() > max(tolerance, STAYING * before)


def _loads_grown_in_contact(settling: Settling, cushioned: Solution) -> ContactEquilibrium | None:
    """The equilibrium with contacts that hold, at the end of steps in which the loads of the scene grow.

    On cushions rods that cross slide over each other in jerks, from one section to the next, and off each other's ends;
    in exact contact they do not. None if the steps do not lead to the whole loads.

    Args:
        settling: the search at the whole loads.
        cushioned: rods on cushions, at the share of the loads that was reached.
    """
    scene = settling.scene
    layout = input_layout(scene)
    owners = {record.name for record in (*scene.loads, *scene.actuators)}
    is_load = np.zeros(layout.size, dtype=bool)
    for entry, span in layout:
        # A rod and a load may share a name.
        is_load[span] = entry.owner in owners and not entry.of_rod

    def at(share: float) -> Settling:
        scaled = np.where(is_load, share * settling.given, settling.given)
        return replace(settling, given=scaled, iterations=0)

    share = FIRST_SHARE * cushioned.load_factor
    start = approach(scene, layout.unpack(at(share).given))
    if not start.converged:
        return None
    last = settled_near(at(share), start, first_state(start))
    step = LONGEST_SHARE / 4
    while last is not None and share < 1.0 and step > SHORTEST_SHARE:
        target = min(share + step, 1.0)
        search = at(target)
        reached = settled_near(search, last.solution)
        settling.iterations += search.iterations
        if reached is None:
            step /= 2
        else:
            last, share = reached, target
            step = min(GROWTH * step, LONGEST_SHARE)
    return last if share == 1.0 else None


def _guesses(cushioned: Solution, first: ContactState) -> list[tuple[ContactState, Solution]]:
    """Guesses of contacts from the cushions, each with a shape; contacts of rods held at the surface come first."""
    rough = (first, cushioned)
    sharp = sharpened(cushioned)
    if sharp is None:
        return [rough]
    return [*((state, sharp.shape) for state in likely_states(sharp)), rough]


def why_unsettled(scene: scenes.Scene, states: Iterable[ContactState]) -> str:
    """A sentence on contact of a kind that the search does not handle; empty without such contact."""
    for state in states:
        sentence = _over_joints(scene, state) or _on_two_obstacles(state)
        if sentence:
            return sentence
    return ""


def _on_two_obstacles(state: ContactState) -> str:
    """A sentence on a rod that touches two obstacles at one place; empty if none does."""
    of_rods = [touch for touch in state.touches if not touch.of_body]
    for first, second in combinations(of_rods, 2):
        same_rod = first.owner == second.owner
        together = second.start - first.end < NEAR
        if same_rod and together and first.obstacle != second.obstacle:
            return (
                f" {first.owner!r} touches {first.obstacle!r} and {second.obstacle!r} together near X = "
                f"{second.start:.2g}: the search finds no exact contact with two obstacles at one section. Give the "
                "obstacles a width, m."
            )
    return ""


def _over_joints(scene: scenes.Scene, state: ContactState) -> str:
    """A sentence on a stretch that lies on an obstacle on both sides of a joint; empty if there is none."""
    for first, second in continuations(scene).items():
        for before, after in product(state.along(first), state.along(second)):
            meets = before.end > TIP - BESIDE_JOINT and after.start < BESIDE_JOINT
            if meets and before.obstacle == after.obstacle and (before.is_line or after.is_line):
                return (
                    f" {first!r} and {second!r} lie on {before.obstacle!r} on both sides of their joint: the search "
                    "finds no line of contact over a joint. Give the obstacles a width, m, or make one rod of the "
                    "two."
                )
    return ""


@dataclass(frozen=True)
class Sharpened:
    """Rods and bodies on cushions that hold them at the surface of the obstacles.

    Attributes:
        shape: the equilibrium.
        pressures: stretches of held nodes, rod by rod.
        balls: contacts of held bodies, and of rods that press each other.
    """

    shape: Solution
    pressures: list[Pressure]
    balls: list[Touch]


def sharpened(cushioned: Solution) -> Sharpened | None:
    """Rods with nodes held by cushions at the surface of the obstacles, and the pressure on them.

    Args:
        cushioned: an equilibrium on cushions that give way.

    Returns:
        shape and pressure; None if Newton's method fails in a round.
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
                # A body touches at one point, which cannot be mistaken for a line.
                continue
            gaps = _nodal_gaps(solution, cushion.rod, cushion.obstacle)
            # Pressure grows with the square of the depth: a stiffer cushion needs less depth for the same pressure.
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
    return Sharpened(solution, pressures, list(pressed_alone(solution)))


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
    """States that the pressure at the nodes suggests: a contact for each stretch, and with nearby stretches joined."""
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
    """The contact that a stretch of held nodes suggests."""
    start, end = float(pressure.X[0]), float(pressure.X[-1])
    if end - start > LINE:
        return Touch.line(pressure.obstacle, pressure.rod, start, end)
    if end == 1.0:
        return Touch.point(pressure.obstacle, pressure.rod, end)
    return Touch.point(pressure.obstacle, pressure.rod, float(pressure.X @ pressure.values / pressure.values.sum()))
