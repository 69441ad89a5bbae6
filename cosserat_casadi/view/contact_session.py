"""Session of a scene with exact contact: every move is a new solve in Python."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from cosserat_casadi.equilibrium.contact.contact_state import without_contacts
from cosserat_casadi.equilibrium.contact.gaps import touching_points
from cosserat_casadi.equilibrium.solution import Contact, Solution
from cosserat_casadi.equilibrium.solve import solve
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import build
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.page.drawn_contact import ALONG_LINE
from cosserat_casadi.page.drawn_model import drawn_numbers
from cosserat_casadi.page.page_facts import page_facts
from cosserat_casadi.view.robot_session import RobotSession, accuracy_of, state_of


class ContactSession(RobotSession):
    """A robot with exact contacts, moved from a browser.

    The compiled library does not search for contacts: :func:`cosserat_casadi.solve` does, from the contacts of the last
    equilibrium.
    """

    def __post_init__(self) -> None:
        super().__post_init__()
        # The model of the scene without contacts: contacts change, and contact forces are not inputs.
        self.model = build(without_contacts(self.first.model.scene), self.first.model.discretisation)

    def facts(self) -> dict[str, Any]:
        """Facts of the scene for its page, with the questions that this session answers."""
        began = time.perf_counter()
        self.move(self.model.pack().tolist())
        seconds = time.perf_counter() - began
        note = (
            f"Contact is exact, and every move searches for it anew, which takes about {seconds:.1g} s. Derivatives, "
            "the ring at the tip, vibrations and motions are for scenes without it."
        )
        offered = {"hand": [], "motion": False, "modes": False, "derivatives": False}
        return {**page_facts(self.first, self.model, self.asked), **offered, "note": note}

    def reset(self, inputs: Sequence[float | None]) -> dict[str, Any]:
        """The equilibrium for these inputs, starting from the equilibrium at the inputs of the scene."""
        self._present = self.first
        return self.move(inputs)

    def eigenvalues(self) -> list[float] | None:
        """The smallest eigenvalue of the second variation with contacts fixed; None if stability is undefined."""
        smallest = self._present.smallest_eigenvalue
        if smallest is None or not self._present.converged:
            return None
        return [smallest]

    def accuracy(self) -> dict[str, Any]:
        """The estimated error of the present equilibrium."""
        if not self._present.converged:
            return accuracy_of(None)
        given = self._present.model.inputs.split(self._present.inputs)
        values = {name: given[name] for name in self.model.inputs.names}
        return accuracy_of(solve(self.model, values, start=self._present))

    def _followed(self, given: FloatArray) -> None:
        """None: inputs are not followed continuously, since a solve starts from the last equilibrium."""

    def _solved(self, given: FloatArray) -> Solution:
        """The equilibrium for inputs, starting from the contacts of the last equilibrium."""
        before: Solution = self._last
        if np.all(np.isfinite(given)):
            return solve(self.model, given, start=before, estimate_error=False)
        return replace(before, outcome=Outcome.NOT_FINITE, message=Outcome.NOT_FINITE.value)

    def _accepted(self, given: FloatArray, found: Solution, *, anew: bool) -> dict[str, Any]:
        self._present = found
        numbers = drawn_numbers(self.model, found)
        contacts = [_drawn_contact(found, contact) for contact in found.contacts]
        return {**state_of(found, numbers, anew=anew), "text": found.message, "contacts": contacts}


def _drawn_contact(solution: Solution, contact: Contact) -> dict[str, Any]:
    """Contact points of a rod or a ball, m, and the resultant on it, N, in world axes; and the place in words."""
    points = touching_points(solution, contact, ALONG_LINE)
    place = f" at X = {contact.start:.3g}"
    if contact.of_body:
        place = ""
    elif contact.start < contact.end:
        place = f" from X = {contact.start:.3g} to {contact.end:.3g}"
    force = float(np.linalg.norm(contact.force))
    words = f"{contact.owner} touches {contact.obstacle}{place} with {force:.3g} N"
    return {"points": points.tolist(), "force": contact.force.tolist(), "words": words.replace("_", " ")}
