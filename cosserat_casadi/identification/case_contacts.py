"""Equilibria of all cases in exact contact, each with its contacts, and the differences from their measurements.

For constant contacts, a case is one system in z = (x, f, p): unknowns, forces and places of contact, with inputs and
parameters as arguments (equilibrium/contact/contact_equations.py). Its equilibrium is followed, judged at each step,
and solved anew where a contact opens, closes or changes its kind. The misfit is continuous over such a change, but its
derivatives jump: derivatives for the contacts on this side are returned.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.contact.contact_equations import ContactEquations, Grids
from cosserat_casadi.equilibrium.contact.contact_judgement import judged
from cosserat_casadi.equilibrium.contact.contact_search import (
    ContactEquilibrium,
    Settling,
    contact_equilibrium,
    next_states,
)
from cosserat_casadi.equilibrium.contact.contact_solve import LEAST_TOLERANCE, settled_near, solve_contact
from cosserat_casadi.equilibrium.contact.contact_state import ContactState, load_sections, state_in
from cosserat_casadi.equilibrium.contact.passing_through import passes_through
from cosserat_casadi.equilibrium.contact.pressing_contacts import marginal_contact
from cosserat_casadi.equilibrium.judge import MAX_DISTANCE
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.equilibrium.strain_limits import BeyondLimit, first_beyond
from cosserat_casadi.errors import SceneError
from cosserat_casadi.identification.case_equilibria import Equilibria, Flags, Point
from cosserat_casadi.identification.case_motions import Run
from cosserat_casadi.identification.measured_modes import MeasuredModes
from cosserat_casadi.identification.measured_rows import MeasuredRows, by_instant
from cosserat_casadi.identification.misfit import Misfit, MisfitState
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.function_table import kept_with
from cosserat_casadi.numerics.newton import NewtonSettings
from cosserat_casadi.numerics.outcome import Outcome


@dataclass(frozen=True)
class CaseInContact:
    """The equilibrium of one case.

    Attributes:
        equations: equations of the case with its contacts, at its inputs and parameters.
        z: solution of the equations.
        found: the equilibrium with elements that end at the contacts.
    """

    equations: ContactEquations
    z: FloatArray
    found: ContactEquilibrium

    @property
    def solution(self) -> Solution:
        """The equilibrium with its contacts by name and its stability."""
        return judged(self.found, holds=True, iterations=0, tolerance=NewtonSettings().tolerance)

    def touches_otherwise(self, other: CaseInContact) -> bool:
        """Whether another equilibrium has other contacts, so that derivatives jump in between."""
        return self.found.state.signature != other.found.state.signature

    def difference(self, other: CaseInContact) -> str:
        """Contacts of only one of two equilibria, in words; empty if both have equal contacts."""
        if not self.touches_otherwise(other):
            return ""
        kinds = [
            Counter((touch.owner, touch.obstacle, touch.kind) for touch in own.touches)
            for own in (self.found.state, other.found.state)
        ]
        alone = sorted({*(kinds[0] - kinds[1]), *(kinds[1] - kinds[0])})
        places = [f"a {kind} of {owner!r} on {obstacle!r}" for owner, obstacle, kind in alone]
        return " and ".join(places) if places else "a contact that reaches the tip"


@dataclass(frozen=True)
class PointInContact(Point):
    """Equilibria of all cases, whose x contains z, padded with zeros.

    Attributes:
        cases: the equilibria; None for a case without one.
    """

    cases: tuple[CaseInContact | None, ...]

    @classmethod
    def of(cls, cases: Sequence[CaseInContact | None], inputs: FloatArray, p: FloatArray) -> PointInContact:
        """Make the point of equilibria at inputs, shape (cases, inputs), and parameters."""
        widest = max((len(case.z) for case in cases if case is not None), default=0)
        x = np.zeros((len(cases), widest))
        for row, case in zip(x, cases, strict=True):
            if case is not None:
                row[: len(case.z)] = case.z
        return cls(x, inputs, p, np.zeros((len(cases), 0, 0)), tuple(cases))

    @property
    def settled(self) -> list[CaseInContact]:
        """Return the equilibria, if every case has one."""
        settled = [case for case in self.cases if case is not None]
        assert len(settled) == len(self.cases), "cases without an equilibrium are left out before"
        return settled

    def chosen(self, kept: Sequence[int]) -> PointInContact:
        """Select the equilibria of some cases."""
        return PointInContact.of([self.cases[i] for i in kept], self.inputs[kept], self.p)

    def joined(self, other: Point) -> PointInContact:
        """Append equilibria of other cases at equal parameters."""
        assert isinstance(other, PointInContact)
        return PointInContact.of([*self.cases, *other.cases], np.concatenate([self.inputs, other.inputs]), self.p)


class ContactEquilibria(Equilibria):
    """Solver for the equilibria of all cases, each with its contacts."""

    model: Model

    def started(
        self, inputs: FloatArray, wanted: FloatArray, first_p: FloatArray, p: FloatArray
    ) -> tuple[PointInContact, list[str]]:
        """Solve for equilibria at wanted inputs and parameters; also return why a case has none.

        Each equilibrium is sought near the one before, or from the unloaded rods if that has other contacts or is far.
        """
        cases: list[CaseInContact | None] = []
        reasons = []
        before: CaseInContact | None = None
        for own in wanted:
            case = None if before is None else self._alike(before, before.z, own, p)
            reason = ""
            if case is None:
                solution = self._solved(own, p)
                case = self._settled(solution, own, p) if solution.converged else None
                unsettled = Outcome.CONTACT_UNSETTLED if solution.converged else solution.outcome
                reason = "" if case is not None else unsettled.value
            before = case or before
            cases.append(case)
            reasons.append(reason)
        return PointInContact.of(cases, wanted, p), reasons

    def at_point(self, point: Point) -> Point:
        """Return the equilibria unchanged, as each has its derivatives."""
        return point

    def tracked(
        self, near: Point, predicted: FloatArray, inputs: FloatArray, p: FloatArray, *, far: bool = True
    ) -> tuple[PointInContact, Flags]:
        """Follow equilibria to other inputs and parameters; results as for :class:`Equilibria`."""
        assert isinstance(near, PointInContact)
        cases = []
        reached = []
        for case, start, own in zip(near.settled, predicted, inputs, strict=True):
            followed = self.followed(case, start[: len(case.z)], own, p)
            cases.append(followed or case)
            reached.append(followed is not None)
        return PointInContact.of(cases, inputs, p), np.array(reached)

    def sensitivities(self, point: Point, p_by_all: FloatArray, inputs_by_all: FloatArray) -> FloatArray:
        """Derivatives of z by the unknowns of each case for constant contacts, padded with zeros."""
        by_all = np.zeros((*point.x.shape, p_by_all.shape[1]))
        for rows, case, inputs_by in zip(by_all, _settled(point), inputs_by_all, strict=True):
            rows[: len(case.z)] = case.equations.moved(case.z, inputs_by, p_by_all)
        return by_all

    def followed(
        self, case: CaseInContact, start: FloatArray, inputs: FloatArray, p: FloatArray
    ) -> CaseInContact | None:
        """Solve for the equilibrium near another one, with its contacts or with others; None if none is found."""
        equations = case.equations
        if np.array_equal(inputs, equations.given) and np.array_equal(p, equations.theta):
            return case
        try:
            same = self._alike(case, start, inputs, p)
            if same is not None:
                return same
            settling = replace(self._settling(equations), scene=self.model.at(p).scene.baked(), given=inputs)
            found = settled_near(settling, case.found.solution)
            return None if found is None else self._settled(found.solution, inputs, p)
        except SceneError:
            # The scene refuses such parameters.
            return None

    def _alike(self, case: CaseInContact, start: FloatArray, inputs: FloatArray, p: FloatArray) -> CaseInContact | None:
        """Solve for the equilibrium near another one with equal contacts, from a start z; None if these do not hold."""
        alike = self._judged(case.equations.at(inputs, p), start)
        if alike is None:
            return None
        shapes = case.equations.nominal.model.shape_unknowns
        moved = (alike.z - start)[: len(shapes)][shapes]
        is_near = float(np.linalg.norm(moved)) <= MAX_DISTANCE
        return alike if is_near and not passes_through(case.found.solution, alike.found.solution) else None

    def _solved(self, inputs: FloatArray, p: FloatArray) -> Solution:
        """Search for the contacts, from the unloaded rods."""
        model = self.model.at(p)
        return solve_contact(model.scene.baked(), Grids(model.discretisation), model.inputs.unpack(inputs))

    def _settled(self, solution: Solution, inputs: FloatArray, p: FloatArray) -> CaseInContact | None:
        """Convert a solution to a case; None if the equations of its contacts do not lead to it."""
        state = state_in(solution.model.scene)
        kept: dict[object, ContactEquations] = kept_with(self.model, "_contact_equations", dict)
        scene = self.model.at(p).scene
        sections = load_sections(scene)
        # Parameters may move seams at loads; their order stays. Seams at other contacts move with those.
        seams = [
            [sections[touch.owner].index(seam) if seam in sections[touch.owner] else None for seam in touch.seams]
            for touch in state.touches
        ]
        kind = (state.signature, *map(tuple, seams))
        for equations in [kept.get(kind), self._equations(state, scene)]:
            if equations is None:
                continue
            own = equations.at(inputs, p)
            case = self._judged(own, own.start_near(solution))
            if case is not None:
                kept[kind] = equations
                return case
        return None

    def _equations(self, state: ContactState, scene: scenes.Scene) -> ContactEquations:
        """Make the equations of a state of contact, in the parameters of the model.

        Args:
            state: the contacts.
            scene: scene with numbers at which the state is valid.
        """
        model = self.model
        own = model.scene
        if model.parameters.moving:
            # Parameters move places only within their order among contacts: the search starts at the present places.
            own = scene.model_copy(update={"parameters": own.parameters})
        return ContactEquations(own, model.pack(), Grids(model.discretisation), state, model.parameters.pack())

    def _settling(self, equations: ContactEquations) -> Settling:
        scene = equations.scene
        tolerance = max(scene.accuracy.tolerance, LEAST_TOLERANCE)
        return Settling(scene, equations.given, equations.grids, NewtonSettings(), tolerance)

    def _judged(self, equations: ContactEquations, start: FloatArray) -> CaseInContact | None:
        """Solve from a start z; None if Newton's method does not converge, or contacts are not valid."""
        settling = self._settling(equations)
        z = settling.solved_from(equations, start)
        if z is None:
            return None
        found = contact_equilibrium(equations, z, equations.given)
        if any(True for _ in next_states(found, settling.tolerance)):
            return None
        return CaseInContact(equations, z, found)


class ContactMisfit(Misfit):
    """The least-squares problem of cases in exact contact."""

    def solutions(self, state: MisfitState) -> tuple[Solution, ...]:
        """The equilibria of the cases, each with its contacts."""
        return tuple(case.solution for case in _settled(state.point))

    def unstable(self, state: MisfitState) -> list[str]:
        """Cases whose equilibrium is unstable."""
        return [where for where, solution in self._told(state) if solution.stable is False]

    def unresolved(self, state: MisfitState) -> list[str]:
        """Cases in which the nodes do not resolve the rods."""
        return [where for where, solution in self._told(state) if solution.outcome is Outcome.UNRESOLVED]

    def beyond_limits(self, state: MisfitState) -> list[tuple[str, BeyondLimit]]:
        """Cases that are beyond a limit, each with that limit."""
        limits = [(where, first_beyond(own.model, own.x, own.inputs)) for where, own in self._told(state)]
        return [(where, limit) for where, limit in limits if limit is not None]

    def marginal(self, state: MisfitState) -> list[str]:
        """Sentences on contacts that change for only one direction of each change of the unknowns."""
        sentences = []
        for where, solution in self._told(state):
            sentence = marginal_contact(solution)
            if sentence:
                sentences.append(f"{where}: {sentence} Intervals hold for changes that leave contacts as they are.")
        return sentences

    def kinked(self, state: MisfitState, other: MisfitState) -> Flags:
        """Mask of the cases whose contacts differ between two states, shape (cases,)."""
        pairs = zip(_settled(state.point), _settled(other.point), strict=True)
        return np.array([case.touches_otherwise(beside) for case, beside in pairs])

    def at_kink(self, state: MisfitState, other: MisfitState) -> list[str]:
        """Contacts of only one of two states, in words."""
        pairs = zip(_settled(state.point), _settled(other.point), strict=True)
        differences = [case.difference(beside) for case, beside in pairs]
        return [f"{own.where}: {words}" for own, words in zip(self.cases, differences, strict=True) if words]

    def _told(self, state: MisfitState) -> Iterator[tuple[str, Solution]]:
        """Each case with its equilibrium."""
        for case, solution in zip(self.cases, self.solutions(state), strict=True):
            yield case.where, solution

    def residual_of(self, rows: MeasuredRows | MeasuredModes, state: MisfitState) -> FloatArray:
        """Differences of one measurement in standard deviations, in the order of its data."""
        (number,) = [number for number, own in self.measurements.items() if own is rows]
        settled = _settled(state.point)
        return np.concatenate([self._measured(number, int(i), settled[i]) for i in np.unique(rows.cases)])

    def _residual(self, point: Point, runs: Mapping[int, Run | None]) -> FloatArray:
        settled = _settled(point)
        return np.concatenate([self._measured(number, i, settled[i]) for number, i in self._blocks])

    @property
    def _blocks(self) -> Iterator[tuple[int, int]]:
        """Measurements and cases in the order of the residuals: case after case."""
        for i, case in enumerate(self.cases):
            for number in self.measurements:
                if number in case.data:
                    yield number, i

    def _measured(self, number: int, i: int, case: CaseInContact) -> FloatArray:
        """Differences of one measurement in one case, in standard deviations."""
        x, inputs, p = case.equations.arguments(case.z)
        return self._rows(number, i, case).residual(x[None], inputs[None], p)

    def _rates(
        self, state: MisfitState, z_by_all: FloatArray, inputs_by_all: FloatArray, p_by_all: FloatArray
    ) -> FloatArray:
        """Derivatives of the residual for constant contacts."""
        settled = _settled(state.point)
        rates = []
        for number, i in self._blocks:
            case = settled[i]
            x, inputs, p = case.equations.arguments(case.z)
            by_arguments = np.hstack(self._rows(number, i, case).derivatives(x[None], inputs[None], p))
            moved = case.equations.arguments_moved(z_by_all[i, : len(case.z)], inputs_by_all[i], p_by_all)
            rates.append(by_arguments @ moved)
        return np.concatenate(rates)

    def _rows(self, number: int, i: int, case: CaseInContact) -> MeasuredRows:
        """Rows of one measurement in a case, of a model whose elements end at its contacts."""
        model = case.equations.model
        kept: dict[tuple[int, str], MeasuredRows] = kept_with(model, "_measured_rows", dict)
        kind = (number, self.cases[i].where)
        if kind not in kept:
            record = model.parametric_scene.measurements[number]
            kept[kind] = MeasuredRows(model, record, by_instant([(0, self.cases[i].data[number])]))
        return kept[kind]


def _settled(point: Point) -> list[CaseInContact]:
    assert isinstance(point, PointInContact)
    return point.settled
