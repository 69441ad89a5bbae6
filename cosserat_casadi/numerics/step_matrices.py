"""The linear systems of one step: dynamic stiffnesses at the eigenvalues of the method.

With the accelerations a_j and the algebraic values as unknowns of the stages, and one Jacobian (K, C, M) for all of
them, the eigenvalues μ of A decouple the system of the stages into dynamic stiffnesses D(p) = K + p C + p² M at
p = 1/(hμ): one for each real μ and for each conjugate pair. The unknowns are changes of position, and unscaled
multipliers: in these units no power of h separates rows of balance and of constraints after rows and columns are
scaled (C. L. Bottasso, D. Dopico, L. Trainelli, *On the optimal scaling of index three DAEs in multibody dynamics*,
Multibody System Dynamics 19 (2008) 3–20). The method of eigenvalues: E. Hairer, G. Wanner, *Solving Ordinary
Differential Equations II*, 2nd ed., Springer 1996, section IV.8.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.collocation import Collocation
from cosserat_casadi.numerics.motion_equations import Linearisation

SINGULAR = 1e15
"""Condition number, after scaling, above which a dynamic stiffness counts as singular."""


@dataclass(frozen=True)
class Deviation:
    """A change of state at the end of a step.

    Attributes:
        position: change of position, shape (n,).
        velocity: change of velocity, shape (n,), 1/s.
    """

    position: FloatArray
    velocity: FloatArray


@dataclass(frozen=True)
class StepMatrices:
    """The factorised linear systems of a step.

    Inverses, not factors: NumPy keeps no factors, and what rounding adds by them is less than what one Jacobian for
    all stages leaves to the next iteration. Steps in C factorise the complex matrix, which takes a third of the time.

    Attributes:
        method: the collocation method.
        step: step size h, s.
        linearisation: derivatives K, C and M.
        inverses: D(p)⁻¹ at each eigenvalue of the method, each of shape (n, n), real or complex.
        shares: ratio 1/μ² of h² times accelerations to changes of position; 1 for algebraic entries, shape (k, n).
    """

    method: Collocation
    step: float
    linearisation: Linearisation
    inverses: Sequence[npt.NDArray[Any]]
    shares: npt.NDArray[np.complex128]

    def corrections(self, residuals: FloatArray) -> FloatArray:
        """Compute Newton's corrections of all stages.

        Args:
            residuals: F at the stages, shape (s, n).

        Returns:
            changes of h² a for differential entries, and of the values for algebraic ones, shape (s, n).
        """
        transformed = self.method.to_eigenvectors @ residuals
        solutions = np.empty_like(transformed)
        for k, inverse in enumerate(self.inverses):
            solutions[k] = _product(inverse, transformed[k])
        changes = self.method.from_eigenvectors @ (self.shares * solutions)
        return np.asarray(-changes.real)

    def answer(self, rows: FloatArray) -> FloatArray:
        """Solve the dynamic stiffness at the first eigenvalue for changes of the unknowns by rows of F, shape (n,)."""
        return np.asarray(_product(self.inverses[0], rows).real)

    def filtered(self, deviation: Deviation) -> Deviation:
        """Apply (1 − hμJ)⁻¹ to a deviation, with the Jacobian J of the equations as a first-order system.

        This removes parts that stiff directions damp at once, and parts that violate constraints. For a complex μ the
        result is the real part.

        Args:
            deviation: deviation to be filtered.
        """
        inverse = self.inverses[0]
        rate = 1.0 / (self.step * self.method.eigenvalues[0])
        position = deviation.position
        velocity = deviation.velocity
        momentum = self.linearisation.mass @ (rate * position + velocity)
        impulse = momentum + self.linearisation.damping @ position
        changed = _product(inverse, rate * impulse)
        return Deviation(changed.real, (rate * (changed - position)).real)


def _product(matrix: npt.NDArray[Any], vector: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Multiply a matrix and a vector on one core, as the start of BLAS threads may take longer than the product."""
    return np.asarray(np.einsum("ij,j->i", matrix, vector))


def step_matrices(
    method: Collocation,
    step: float,
    linearisation: Linearisation,
    differential: npt.NDArray[np.bool_],
    eliminated: Sequence[int] | npt.NDArray[np.intp] = (),
) -> StepMatrices | None:
    """Factorise the linear systems of a step.

    Args:
        method: the collocation method.
        step: step size h, s.
        linearisation: derivatives K, C and M.
        differential: mask of the entries with accelerations, shape (n,).
        eliminated: indices of entries whose rows depend on no other such entry.

    Returns:
        the matrices; None if a matrix is singular up to rounding.
    """
    inverses = []
    shares = np.ones((len(method.eigenvalues), len(differential)), dtype=np.complex128)
    for k, eigenvalue in enumerate(method.eigenvalues):
        rate = 1.0 / (step * eigenvalue)
        if eigenvalue.imag == 0.0:
            rate = rate.real
        stiffness = linearisation.stiffness + rate * linearisation.damping + rate**2 * linearisation.mass
        inverse = condensed_inverse(stiffness, np.asarray(eliminated, dtype=np.intp))
        if inverse is None:
            return None
        inverses.append(inverse)
        shares[k, differential] = 1.0 / eigenvalue**2
    return StepMatrices(method, step, linearisation, inverses, shares)


def condensed_inverse(matrix: npt.NDArray[Any], eliminated: npt.NDArray[np.intp]) -> npt.NDArray[Any] | None:
    """Invert a matrix whose block of eliminated entries is diagonal; None if it is singular up to rounding.

    Only the Schur complement of the other entries is inverted.

    Args:
        matrix: the matrix, shape (n, n).
        eliminated: indices of the eliminated entries.
    """
    if not eliminated.size:
        return scaled_inverse(matrix)
    kept = np.delete(np.arange(len(matrix)), eliminated)
    pivots = np.diag(matrix)[eliminated]
    # Factors by which an eliminated entry follows the kept ones, and by which its row enters their rows.
    follows = -matrix[np.ix_(eliminated, kept)] / pivots[:, None]
    passed = -matrix[np.ix_(kept, eliminated)] / pivots
    complement = matrix[np.ix_(kept, kept)] + matrix[np.ix_(kept, eliminated)] @ follows
    of_kept = scaled_inverse(complement)
    if of_kept is None:
        return None
    inverse = np.empty_like(matrix)
    inverse[np.ix_(kept, kept)] = of_kept
    inverse[np.ix_(eliminated, kept)] = follows @ of_kept
    inverse[np.ix_(kept, eliminated)] = of_kept @ passed
    inverse[np.ix_(eliminated, eliminated)] = follows @ of_kept @ passed + np.diag(1.0 / pivots)
    return inverse


def scaled_inverse(matrix: npt.NDArray[Any]) -> npt.NDArray[Any] | None:
    """Invert a matrix after scaling the largest entry of each row and column to one; None if it is singular."""
    sizes = np.abs(matrix)
    rows = sizes.max(axis=1)
    if not np.all(rows > 0.0):
        return None
    columns = (sizes / rows[:, None]).max(axis=0)
    if not np.all(columns > 0.0):
        return None
    scaled = matrix / rows[:, None] / columns
    try:
        inverse = np.linalg.inv(scaled)
    except np.linalg.LinAlgError:
        return None
    condition = np.linalg.norm(scaled, 1) * np.linalg.norm(inverse, 1)
    # Not "condition > bound": a condition that is not a number must count as singular too.
    if not condition <= SINGULAR:
        return None
    return np.asarray(inverse / columns[:, None] / rows)
