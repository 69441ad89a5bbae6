"""A motion with friction of exact contact: equal steps, divided where a contact strikes, sticks or slips back.

A rod that lies on many sections would change between sticking and slipping without end, one event after the other.
Steps with friction therefore decide for all sections at once. C code has this law, and cuts a step into stretches, see
:mod:`~cosserat_casadi.motion.rubbing_library`. This module makes legs of a history from stretches, and events.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import astuple, dataclass, field
from itertools import pairwise

import numpy as np

from cosserat_casadi.errors import refuse
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.checkpoint import CarriedContacts, Resume, of_another_scene
from cosserat_casadi.motion.contact_forces import Follower, MovingContact, Touches
from cosserat_casadi.motion.contact_guards import SAME_PLACE, ContactPhase, start_inside
from cosserat_casadi.motion.event_restart import ContactEvent, Restart
from cosserat_casadi.motion.history import DIFFERENTIATED, FreeFlight, History, Leg, Stops, check_start, equations_of
from cosserat_casadi.motion.moving_inputs import Piece
from cosserat_casadi.motion.one_sided import OneSided, sags_by_cable
from cosserat_casadi.motion.rubbing_library import KNOWN, RubbingSteps, RubbingTouch, ToldStretch
from cosserat_casadi.motion.rubbing_step import RubbingStep
from cosserat_casadi.motion.step_kernels import StepKernels
from cosserat_casadi.motion.step_words import STAGES
from cosserat_casadi.motion.stops_facing import PairFacing
from cosserat_casadi.numerics.collocation import radau
from cosserat_casadi.numerics.consistent_start import ConsistentStart, consistent_start
from cosserat_casadi.numerics.guards import crossing
from cosserat_casadi.numerics.integration import AfterStep, Integration, IntegrationCost, StepOutcome, StepSettings
from cosserat_casadi.numerics.motion_equations import Instant, MotionEquations

SHORTEST = 2.0**-12
"""Shortest step tried, over the step of the motion; if its equations are not solved, the motion ends."""

LAST = 1.5
"""Largest last part of a divided step, over the other parts, that is not divided once more."""

ROUNDED = 1e-12
"""Share of a step that counts as rounding."""

UNSETTLED = "At t = {time:.6g} s a step of {size:.3g} s was not solved, {where}: damp the rods, or allow more modes."


@dataclass
class _Told:
    """A motion in the course of its computation.

    Attributes:
        steps: the steps in C.
        piece: the present piece of the inputs.
        plain: equations of motion in this piece, without contact forces.
        restart: begin of the present leg.
        legs: the finished legs; the contacts do not change within a leg.
        taken: steps of the present leg.
        touches: contacts that press in the last stretch, with their places at its end.
        stuck: indices of the pairs with a contact, but no contact that slips.
        cost: counts of steps, iterations and Jacobians in the present leg.
        carried: data that a next step takes over.
    """

    steps: RubbingSteps
    piece: Piece
    plain: MotionEquations
    restart: Restart
    legs: list[Leg] = field(default_factory=list)
    taken: list[RubbingStep] = field(default_factory=list)
    touches: tuple[RubbingTouch, ...] = ()
    stuck: frozenset[int] = frozenset()
    cost: IntegrationCost = field(default_factory=IntegrationCost)
    carried: CarriedContacts | None = None

    @property
    def model(self) -> Model:
        """The model."""
        return self.steps.model

    def add(self, stretch: ToldStretch, before: Instant, end: float) -> RubbingStep:
        """Append a stretch, from the state before a blow at its begin up to the time ``end``, s, as a step."""
        pressing = tuple(touch for touch in stretch.touches if touch.presses)
        step = self._step(stretch, pressing, before.time, end)
        events = tuple(self._events(stretch, pressing, before.time))
        lost, work = self._lost(stretch, before)
        if not self.taken or lost or events or not _go_on(self.touches, pressing):
            self.close()
            start = ConsistentStart(step.start, 0.0, 0.0, 0.0, 0)
            self.restart = Restart(start, self._phase(pressing), lost, work, events)
        self.taken.append(step)
        self.touches = pressing
        return step

    def keep(self) -> None:
        """Keep what a next step takes over, after a step: an interrupt may come within one."""
        touches = [[own.facing, own.slides, own.end_place, own.height] for own in self.touches]
        known = np.array(touches, dtype=float).reshape(-1, KNOWN)
        self.carried = CarriedContacts(self.steps.carried(), known, self.stuck)

    def recall(self, resume: Resume) -> None:
        """Take over contacts and memory from the state from which a motion continues.

        Raises:
            SceneError: the contacts and memory belong to another model.
        """
        carried = resume.contacts
        if carried is None or not self._knows(carried) or not self.steps.go_on(carried.memory):
            raise of_another_scene()
        forces = np.zeros(STAGES), np.zeros(3), np.zeros((STAGES, 2)), 0.0
        self.stuck = carried.stuck
        self.touches = tuple(
            RubbingTouch(
                int(facing), bool(slides), True, int(facing) not in self.stuck, False, place, place, height, *forces
            )
            for facing, slides, place, height in carried.touches.reshape(-1, KNOWN).tolist()
        )
        self.restart = Restart(self.restart.start, self._phase(self.touches))

    def _knows(self, carried: CarriedContacts) -> bool:
        """Whether carried contacts belong to pairs of the model."""
        pairs = range(len(self.steps.facings))
        rows = carried.touches.tolist()
        known = all(isinstance(row, list) and len(row) == KNOWN and row[0] in pairs for row in rows)
        return known and carried.stuck.issubset(pairs)

    def close(self, outcome: StepOutcome = StepOutcome.GUARDED, size: float = np.nan) -> None:
        """End the present leg, with the size of the next step, s. A leg without steps is kept if it ends the motion."""
        if self.taken or outcome is not StepOutcome.GUARDED:
            integration = Integration(self.restart.start.instant, tuple(self.taken), outcome, size, self.cost)
            self.legs.append(Leg(self.piece, self.restart, integration, self.plain))
            self.taken, self.cost = [], IntegrationCost()

    def stall(self, at: Instant, size: float) -> None:
        """End the motion at an instant from which a step of the size, s, could not be solved."""
        self.close()
        facings = [self.steps.facings[own.facing] for own in self.touches]
        pairs = sorted({f"{facing.owner!r} on {facing.touched!r}" for facing in facings})
        where = f"with contact and friction of {', '.join(pairs)}" if pairs else "although nothing touches before it"
        sentence = UNSETTLED.format(time=at.time, size=size, where=where)
        start = ConsistentStart(at, 0.0, 0.0, 0.0, 0)
        self.restart = Restart(start, self.restart.phases, stalled=sentence)
        self.close(StepOutcome.STALLED)

    def count(self, taken: int, outcome: StepOutcome | None, iterations: int, jacobians: int) -> None:
        """Count a tried step: its stretches, its failure, its iterations and its Jacobians."""
        more = (taken, outcome is not None, iterations, jacobians, jacobians)
        self.cost = IntegrationCost(*(int(a + b) for a, b in zip(astuple(self.cost), more, strict=True)))

    def _step(
        self, stretch: ToldStretch, pressing: Sequence[RubbingTouch], time: float, end_time: float
    ) -> RubbingStep:
        """The stretch as a step; behind the n unknowns stand m forces along normals, then 2 m along the tangents.

        Pushes of rigid stops and tensions are among the n unknowns.
        """
        method = radau(STAGES)
        differential = self.model.discrete.unknowns.differential
        of_stages, last = stretch.unknowns.copy(), stretch.end.copy()
        for touch in pressing:
            facing = self.steps.facings[touch.facing]
            if isinstance(facing, PairFacing):
                of_stages[:, facing.push_entry] = touch.forces
                last[0, facing.push_entry] = touch.forces[-1]
        pressing = self._on_obstacles(pressing)
        normal = np.array([touch.forces for touch in pressing]).reshape(-1, STAGES).T
        along = np.array([touch.friction.T for touch in pressing]).reshape(-1, STAGES).T
        forces = np.concatenate([normal, along], axis=1)
        none = np.zeros(forces.shape[1])
        unknowns = np.concatenate([of_stages, forces], axis=1)
        first = method.values_at(0.0) @ unknowns
        x = np.where(differential, stretch.x, first[: len(differential)])
        a = np.where(differential, first[: len(differential)], 0.0)
        start = Instant(time, np.append(x, first[len(x) :]), np.append(stretch.v, none), np.append(a, none))
        end = Instant(end_time, np.append(last[0], forces[-1]), np.append(last[1], none), np.append(last[2], none))
        return RubbingStep(
            method=method,
            differential=np.append(differential, np.zeros(len(none), dtype=bool)),
            start=start,
            size=stretch.size,
            unknowns=unknowns,
            end=end,
            error=float("nan"),
            iterations=0,
            residual=0.0,
            contraction=0.0,
            axes=np.array([touch.axis for touch in pressing]).reshape(-1, 3),
            slips=tuple(touch.slips for touch in pressing),
            power=stretch.power,
            put_in=stretch.put_in,
        )

    def _phase(self, pressing: Sequence[RubbingTouch]) -> ContactPhase:
        on_obstacles = self._on_obstacles(pressing)
        touches = tuple(MovingContact(touch.facing, touch.place, touch.slides, touch.height) for touch in on_obstacles)
        return ContactPhase(touches, self._laid(pressing), Follower(self.steps.facings, touches))

    def _on_obstacles(self, touches: Sequence[RubbingTouch]) -> list[RubbingTouch]:
        """Contacts without rigid stops and cables."""
        return [own for own in touches if not isinstance(self.steps.facings[own.facing], PairFacing)]

    def _laid(self, touches: Sequence[RubbingTouch]) -> frozenset[int]:
        """Indices of the pairs in which a rod lies."""
        facings = self.steps.facings
        return frozenset(own.facing for own in touches if not own.slides and not facings[own.facing].of_body)

    def _lost(self, stretch: ToldStretch, before: Instant) -> tuple[float, float]:
        """Energy that a blow at the begin of a stretch took, and work of moving inputs in this blow, J; else zeros."""
        if np.array_equal(stretch.v, before.v):
            return 0.0, 0.0
        value, rate, _ = self.piece.at(before.time)
        kinetic = [float(self.model.energies(before.x, v, value, rate)[0]) for v in (before.v, stretch.v)]
        lost = kinetic[0] - kinetic[1]
        return (stretch.taken, stretch.taken - lost) if np.any(rate) else (lost, 0.0)

    def _events(self, stretch: ToldStretch, pressing: Sequence[RubbingTouch], time: float) -> Iterator[ContactEvent]:
        """Changes of contact from the last stretch to this one, as events at a time, s."""
        facings = self.steps.facings
        struck = [own for own in stretch.touches if own.is_struck]
        total = sum(own.impulse for own in struck)
        laid, laid_before = self._laid(pressing), self._laid(self.touches)

        def event(kind: str, own: RubbingTouch, energy: float = 0.0, impulse: float = 0.0) -> ContactEvent:
            facing = facings[own.facing]
            if isinstance(facing, PairFacing):
                one_sided = OneSided(self.model)
                closes = kind == "impact"
                return one_sided.event(
                    facing.number, time, closes=closes, lost=energy, impulse=impulse / facing.force_unit
                )
            numbers = min(max(float(own.place), 0.0), 1.0), float(energy), float(impulse)
            return ContactEvent(kind, time, facing.owner, facing.touched, *numbers, facing.of_body)

        for own in struck:
            yield event("impact", own, stretch.taken * own.impulse / total, own.impulse)
        for old in self.touches:
            if old.facing not in laid | laid_before and not any(_is_same(old, own) for own in pressing):
                yield event("lift_off", old._replace(place=old.end_place))
        for number in sorted(laid_before - laid - {own.facing for own in pressing}):
            yield event("lift_off", next(own for own in self.touches if own.facing == number))
        for number in sorted(laid - laid_before):
            yield event("lie_down", next(own for own in pressing if own.facing == number))
        touching = {own.facing for own in pressing}
        stuck = frozenset(touching - {own.facing for own in pressing if own.slips})
        was_touching = {own.facing for own in self.touches}
        for number in sorted(touching):
            kind = "stick" if number in stuck else "slip"
            if number in was_touching and (number in stuck) == (number in self.stuck):
                continue
            if facings[number].against.rubs:
                yield event(kind, next(own for own in pressing if own.facing == number))
        self.stuck = stuck


def rubbing_history(
    steps: RubbingSteps,
    pieces: Sequence[Piece],
    start: tuple[FloatArray, FloatArray],
    touches: Touches,
    settings: StepSettings,
    kernels: StepKernels,
    after_step: AfterStep | None = None,
    stops: Stops | None = None,
    resume: Resume | None = None,
) -> History:
    """Integrate a model over all pieces of its inputs, or until one ends early.

    Args:
        steps: the steps of the model in C.
        pieces: pieces of its inputs, one after the other.
        start: unknowns and their rates at the start, shape (n,) each; the rates in 1/s.
        touches: contacts that press at the start; steps look for others.
        settings: settings of steps, with their size, s.
        kernels: inverse dynamics and its derivatives.
        after_step: function that is called after every step, with its end time and its size, s.
        stops: values at whose zeros the motion stops.
        resume: state from which a motion continues, in place of start and touches; None for a motion that begins.

    Raises:
        SceneError: the start contradicts the constraints, or is inside an obstacle.
    """
    assert settings.size is not None, "steps of these motions are equal"
    model, piece = steps.model, pieces[0]
    steps.use(kernels)
    plain = equations_of(model, piece, None, kernels)
    begin = _begin(steps, pieces, start, plain) if resume is None else _resumed(resume, model.size)
    steps.begin(begin.instant, touches, settings.size)
    told = _Told(steps, piece, plain, Restart(begin, ContactPhase()))
    if resume is not None:
        told.recall(resume)
    told.keep()
    stopped = None
    try:
        stopped = _integrate(told, pieces, settings.size, kernels, after_step, stops)
    except KeyboardInterrupt:
        # What was computed stands: whoever stops a long motion wants to see it.
        told.close(StepOutcome.INTERRUPTED, settings.size)
    flight = FreeFlight(model, None, None)
    return History(model, tuple(told.legs), radau(STAGES), settings, flight, stopped, told.carried)


def _resumed(resume: Resume, size: int) -> ConsistentStart:
    """State of a continued motion with so many unknowns, to which contact forces are appended."""
    return ConsistentStart(resume.at.first(size), 0.0, 0.0, 0.0, 0)


def _begin(
    steps: RubbingSteps, pieces: Sequence[Piece], start: tuple[FloatArray, FloatArray], plain: MotionEquations
) -> ConsistentStart:
    """The start with its accelerations, as if nothing touched.

    Raises:
        SceneError: the start contradicts the constraints, or is inside an obstacle.
    """
    model, piece = steps.model, pieces[0]
    x, v = start
    inputs = piece.at(piece.start).value
    obstacles = [facing for facing in steps.facings if not isinstance(facing, PairFacing)]
    depths = [-facing.deepest(facing.nodes(x, inputs)).gap for facing in obstacles]
    inside = [facing for facing, depth in zip(obstacles, depths, strict=True) if depth > model.scene.accuracy.tolerance]
    if inside:
        refuse([start_inside(inside, max(depths))])
    found = consistent_start(plain, piece.start, x, v, DIFFERENTIATED * piece.smooth)
    check_start(model, piece, Restart(found, ContactPhase()), sags_by_cable(model, x, inputs), pieces[-1].end)
    return found


def _integrate(
    told: _Told,
    pieces: Sequence[Piece],
    size: float,
    kernels: StepKernels,
    after_step: AfterStep | None,
    stops: Stops | None,
) -> int | None:
    """Take all steps; returns the index of the value of ``stops`` that stops the motion, or None.

    :func:`rubbing_history` describes the arguments; ``size`` is the size of steps, s.
    """
    at = told.restart.start.instant
    for piece in pieces:
        if piece.end <= at.time:
            continue
        jumped = stops.jumped(told.piece, piece, at) if stops and told.legs else None
        if jumped is not None:
            return jumped
        told.piece, told.plain = piece, equations_of(told.model, piece, None, kernels)
        guards = stops.guards(piece, at) if stops else None
        for end, whole in _ends(piece, at.time, size):
            tried = whole
            while at.time < end:
                left = whole if tried == whole else end - at.time
                # Forces of a step that is rounding of the time would be rounding over the square of its size.
                own = tried if left > LAST * tried else left
                outcome, stretches, counts = told.steps.take(at, _inputs(piece, at.time, own), own)
                told.count(len(stretches), outcome, *counts)
                if outcome is not None and tried <= SHORTEST * whole:
                    told.stall(at, tried)
                    return None
                if outcome is not None:
                    tried /= 2.0
                    continue
                reached = at.time + np.cumsum([stretch.size for stretch in stretches])
                reached[-1] = end if own == left else at.time + own
                for stretch, time in zip(stretches, reached.tolist(), strict=True):
                    step = told.add(stretch, at, time)
                    crossed = None if guards is None else crossing(step, guards)
                    if crossed is not None:
                        told.taken[-1] = step.until(crossed[0])
                        told.close(StepOutcome.COMPLETED)
                        return crossed[1]
                    at = Instant(step.end.time, *stretch.end)
                told.keep()
                if after_step is not None:
                    after_step(at.time, own)
        told.close(StepOutcome.COMPLETED, size)
    return None


def _ends(piece: Piece, start: float, size: float) -> Iterator[tuple[float, float]]:
    """End times and sizes, s, of the steps of a piece from a time on; steps between two kinks are equal.

    They are equal to the last bit, so that the Jacobian of one step serves the next one.
    """
    later = [time for time in (*piece.kinks, piece.end) if time > start]
    for begin, end in pairwise([max(piece.start, start), *later]):
        count = max(1, int(np.ceil((end - begin) / size * (1.0 - ROUNDED))))
        own = size if abs(count * size - (end - begin)) <= ROUNDED * end else (end - begin) / count
        yield from ((time, own) for time in np.linspace(begin, end, count + 1)[1:].tolist())


def _inputs(piece: Piece, time: float, size: float) -> list[FloatArray]:
    """Inputs, rates and accelerations at the begin of a step, and constant jerks: the cubics through both ends.

    If inputs ended a step elsewhere than the next step begins, a driven rod would begin inside a rod that it touches.
    """
    begin, end = piece.at(time), piece.at(time + size)
    missed = end.value - begin.value - size / 2.0 * (begin.rate + end.rate)
    jerks = np.where(np.abs(missed) > ROUNDED * np.abs(end.value), -12.0 * missed / size**3, 0.0)
    return [begin.value, begin.rate, (end.rate - begin.rate) / size - size / 2.0 * jerks, jerks]


def _is_same(old: RubbingTouch, own: RubbingTouch) -> bool:
    """Whether a contact at the end of a stretch goes on as ``own`` at the begin of the next stretch."""
    return old.facing == own.facing and abs(old.end_place - own.place) <= SAME_PLACE


def _go_on(before: Sequence[RubbingTouch], now: Sequence[RubbingTouch]) -> bool:
    """Whether the contacts of the last stretch go on unchanged in this one."""
    return len(before) == len(now) and all(
        _is_same(old, own) and (old.slides, old.height) == (own.slides, own.height)
        for old, own in zip(before, now, strict=True)
    )
