"""How a solve ended, as data: the value is the sentence that a user reads. See docs/theory.md, sections 9 and 10."""

from __future__ import annotations

from enum import Enum


class Outcome(Enum):
    """Every way a solve can end. Only CONVERGED carries a result to build on."""

    CONVERGED = "Equilibrium found: the residual is below its tolerance."
    MAX_ITERATIONS = "No equilibrium found: the iterations ran out before the residual was small enough."
    NOT_FINITE = "No equilibrium found: the equations gave a value that is not a finite number."
    SINGULAR = "No equilibrium found: the Jacobian is singular and no step reduces the residual."
    LOAD_STALLED = (
        "No equilibrium found: growing the load from zero, the path could not be followed further; "
        "there may be a limit point or a buckling load."
    )
    UNRESOLVED = (
        "An equilibrium of the discrete model was found, but the rod is not resolved by its modes and nodes: "
        "allow more of them, or a larger tolerance."
    )

    @property
    def label(self) -> str:
        """The word of the result file."""
        return self.name.lower()
