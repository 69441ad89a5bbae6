"""The end of a solve, whatever was solved: what solutions of rods and of concentric tubes have in common."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Generic, Self, TypeVar

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.tube_checks import OfScene
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.result import Result

ModelType = TypeVar("ModelType", bound=OfScene)


@dataclass(frozen=True, repr=False)
class Equilibrium(Result, Generic[ModelType]):
    """The end of a solve; an equilibrium only where ``converged`` says so.

    Attributes:
        model: the model that was solved.
        inputs: stacked inputs it was solved for, shape (model.inputs.size,).
        x: unknowns, shape (model.size,).
        outcome: how the solve ended.
        message: a sentence for the user.
        residual_norm: size of the residual at x, computed again at the end.
        iterations: Newton iterations of the search.
        error_estimate: estimated error of the poses of the tips, relative to a length and in rad; None if not
            estimated.
    """

    model: ModelType
    inputs: FloatArray
    x: FloatArray
    outcome: Outcome
    message: str
    residual_norm: float
    iterations: int
    error_estimate: float | None = None

    @property
    def converged(self) -> bool:
        """Whether x is an equilibrium to the solver's tolerance."""
        return self.outcome is Outcome.CONVERGED

    @property
    def judged_error(self) -> float | None:
        """Estimated error that the scene's tolerance is for; None if not estimated."""
        return self.error_estimate

    @property
    def within_tolerance(self) -> bool | None:
        """Whether the estimated error is within the scene's tolerance; None where no tolerance has a meaning.

        A tolerance that nobody has written asks for nothing of modes and nodes that the scene fixes. What did not
        converge is not within any tolerance.
        """
        accuracy = self.model.scene.accuracy
        if not accuracy.binds:
            return None
        if not self.converged:
            return False
        if self.judged_error is None:
            return None
        # Written so that an estimate which is not a number counts as too large.
        return self.judged_error <= accuracy.tolerance

    def unresolved(self) -> Self:
        """The same unknowns, as an equilibrium of the discrete model alone."""
        return replace(self, outcome=Outcome.UNRESOLVED, message=Outcome.UNRESOLVED.value)
