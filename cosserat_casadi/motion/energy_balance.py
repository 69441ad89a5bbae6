"""The balance of energy along a motion: stored energy, work put in, dissipation, and the imbalance between them.

Powers are integrated with the quadrature of the steps themselves, so that the balance is as exact as the motion.
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.checkpoint import EnergyAccount
from cosserat_casadi.motion.history import History, Leg
from cosserat_casadi.motion.rubbing_step import RubbingStep
from cosserat_casadi.motion.trajectory import Energies
from cosserat_casadi.numerics.motion_equations import Instant
from cosserat_casadi.numerics.step import TimeStep

Place = tuple[Leg, Instant]
"""An instant of a motion, with the leg that contains it."""


def energies_of(
    history: History, rows: FloatArray, moving: frozenset[str], before: EnergyAccount | None = None
) -> tuple[Energies, EnergyAccount]:
    """Energies of a motion at given times, and its account at the end, with which a continuation begins.

    Args:
        history: the motion.
        rows: times of the result within the motion, ascending, shape (T,), s.
        moving: names of the inputs that move. A changing dead force does work; a constant one has potential energy.
        before: account at the start of the motion if it continues another one, else None.
    """
    model = history.model
    times = np.append(rows, history.end.time)
    # Work counts from the start of the motion, which need not be among the times.
    places = [history.locate(float(time)) for time in (history.begin, *times)]
    kinetic, elastic, of_loads, dead = _called(model.energies, places, accelerations=False)
    conserved = dead[:, :1] * _still(model, moving)[:, None]
    potential = (conserved.T @ of_loads)[0]
    stored = kinetic[0] + elastic[0] + potential
    before = before or EnergyAccount(float(stored[0]))
    dissipated, work = _integrals(history, times, 1.0 - conserved[:, 0], before)
    gained = stored[1:] - before.stored
    impacts, pushed = _in_impacts(history, times, before.impacts)
    work = work + pushed
    left_over = gained + dissipated + impacts - work
    parts = np.stack([kinetic[0, 1:], elastic[0, 1:], potential[1:] - potential[0], dissipated, work, impacts])
    largest = float(np.abs(parts[:, :-1]).max(initial=0.0))
    # Nothing moves and nothing is stored: nothing is missing either.
    if largest > 0.0:
        left_over = left_over / largest
    told = (kinetic[0, 1:], elastic[0, 1:], potential[1:], dissipated, work, impacts, left_over)
    at_end = EnergyAccount(before.stored, float(dissipated[-1]), float(work[-1]), float(impacts[-1]))
    return Energies(*(energy[:-1] for energy in told)), at_end


def _in_impacts(history: History, times: FloatArray, before: float) -> tuple[FloatArray, FloatArray]:
    """Energy lost in impacts, and work done in them, before each time, shape (T,) each, J.

    Args:
        history: the motion.
        times: shape (T,), s.
        before: energy lost in impacts up to the start of the motion, J.
    """
    lost = np.full(len(times), before)
    work = np.zeros(len(times))
    for leg in history.legs:
        later = times > leg.start.instant.time
        lost += np.where(later, leg.lost, 0.0)
        work += np.where(later, leg.restart.work, 0.0)
    return lost, work


def _still(model: Model, moving: frozenset[str]) -> FloatArray:
    """Mask of the loads that no moving input changes: 1 or 0, shape (loads,)."""
    lengths = {entry.name for entry, _ in model.inputs if entry.of_rod and entry.field == "length"}
    # A rod that grows is weighed by more and more of it.
    if lengths & moving:
        return np.zeros(len(model.discrete.loads))
    owners = {entry.owner for entry, _ in model.inputs if entry.name in moving and not entry.of_rod}
    return np.array([float(load.name not in owners) for load in model.discrete.loads])


def _integrals(
    history: History, times: FloatArray, working: FloatArray, account: EnergyAccount
) -> tuple[FloatArray, FloatArray]:
    """Dissipated energy, and work done, up to each time, shape (T,) each, J.

    Args:
        history: the motion.
        times: shape (T,), s.
        working: 1 for each load whose work counts, else 0, shape (loads,).
        account: account of the energies at the start of the motion.
    """
    if not history.steps:
        return np.full(len(times), account.dissipated), np.full(len(times), account.work)
    stages = history.steps[0][1].method.stages
    count = stages * len(history.steps)
    # Those of a rod on a fixed clamp without damping, say, are the same at all times.
    of_places = history.steps[:1] if _powers_are_constant(history.model, working) else history.steps
    places = [place for leg, step in of_places for place in _stage_places(leg, step)]
    of_model = [(leg, history.of_model(instant)) for leg, instant in places]
    dissipated, of_loads, of_actuators, of_bases = _called(history.model.powers, of_model, accelerations=True)
    put_in = working @ of_loads + of_actuators.sum(axis=0) + of_bases[0]
    if history.contacts is not None:
        put_in = put_in + history.contacts.powers([instant for _, instant in places])
    powers = np.tile(np.stack([dissipated[0], put_in]), (1, count // len(places)))
    by_step = powers.reshape(2, len(history.steps), stages)
    for number, (_, step) in enumerate(history.steps):
        if isinstance(step, RubbingStep):
            by_step[:, number] += step.power, step.put_in
    return _up_to(history, times, by_step, np.array([account.dissipated, account.work]))


def _powers_are_constant(model: Model, working: FloatArray) -> bool:
    """Whether the powers that count are constant in time, so that one instant is enough.

    Args:
        model: the model.
        working: 1 for each load whose work counts, else 0, shape (loads,).
    """
    function = model.powers
    if model.scene.touches_exactly or np.any(working):
        return False
    counted = [function.index_out(name) for name in ("dissipated", "of_actuators", "of_bases")]
    return all(function.jac_sparsity(i, j).nnz() == 0 for i in counted for j in range(function.n_in()))


def _up_to(history: History, times: FloatArray, powers: FloatArray, begin: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Integrals of two powers up to each time.

    Args:
        history: the motion.
        times: shape (T,), s.
        powers: at the stages of the steps, shape (2, steps, stages), W.
        begin: values of the integrals at the start of the motion, shape (2,), J.
    """
    method = history.steps[0][1].method
    sizes = np.array([step.size for _, step in history.steps])
    of_steps = (powers @ method.weights) * sizes
    before = np.cumsum(np.column_stack([begin, of_steps]), axis=1)[:, :-1]
    results = np.zeros((2, len(times)))
    for row, time in enumerate(times):
        number = history.number_at(float(time))
        _, step = history.steps[number]
        share = (time - step.start.time) / step.size
        within = step.size * (powers[:, number] @ method.integrals_at(share))
        results[:, row] = before[:, number] + within
    return results[0], results[1]


def _stage_places(leg: Leg, step: TimeStep) -> list[Place]:
    stages = step.stages
    rows = zip(stages.times, stages.x, stages.v, stages.a, strict=True)
    return [(leg, Instant(float(time), x, v, a)) for time, x, v, a in rows]


def _called(function: ca.Function, places: Sequence[Place], *, accelerations: bool) -> list[FloatArray]:
    """Evaluate a function of the motion at all places; each result has shape (entries, places)."""
    columns: list[list[FloatArray]] = []
    for leg, instant in places:
        inputs = leg.piece.at(instant.time)
        given = [instant.x, instant.v, inputs.value, inputs.rate]
        if accelerations:
            given = [instant.x, instant.v, instant.a, *inputs]
        columns.append(given)
    arguments = [np.stack(argument, axis=1) for argument in zip(*columns, strict=True)]
    results = function.map(len(places)).call(arguments)
    return [np.asarray(result.full()) for result in results]
