"""Linear differential equations on the Chebyshev points: report chapter 3 for any size.

``dx/dX = A(X) x + b(X)`` with ``x`` known at one end becomes, at the N + 1 points, one linear system. The
values are stacked component by component (report (3.4)), points from base to tip within each component. The
permutation then takes the known point first, and after it the other points from base to tip, each with its
m components together. (Report (3.9) prints the rows of one point exchanged; this order makes A_NN block
diagonal with the blocks A(X_j) themselves.) The corrections are in docs/theory.md, section 13.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import casadi as ca

from cosserat_casadi.maths.chebyshev import differentiation_matrix
from cosserat_casadi.maths.typing import Matrix, check_shape

End = Literal["base", "tip"]


@dataclass(frozen=True)
class PermutedSystem:
    """The linear system of report (3.16)–(3.22), corrected, with m components and N intervals.

    With ``χ̃ = P χ = [x_known; χ̄]`` and ``D_p = P D Pᵀ = [[D_II, D_NI], [D_IN, D_NN]]``,

    - ``dx/dX`` at the known end is ``D_II x_known + D_NI χ̄``,
    - ``dχ̄/dX`` is ``D_IN x_known + D_NN χ̄``, which is to equal ``A_NN χ̄ + β̄``.

    Attributes:
        known_at: the end where the value is known.
        P: (m(N+1), m(N+1)) permutation, χ ↦ χ̃: report (3.8).
        D_II: (m, m) influence of the known value on its own derivative.
        D_NI: (m, mN) influence of the unknown values on the derivative at the known end.
        D_IN: (mN, m) influence of the known value on the other derivatives.
        D_NN: (mN, mN) influence of the unknown values on their own derivatives.
        A_NN: (mN, mN) block diagonal, A at the unknown points.
        beta: (mN, 1) the vector β̄, b at the unknown points.
    """

    known_at: End
    P: ca.DM
    D_II: ca.DM
    D_NI: ca.DM
    D_IN: ca.DM
    D_NN: ca.DM
    A_NN: Matrix
    beta: Matrix

    def ivp(self, x_known: Matrix) -> Matrix:
        """Contribution of the known value to the derivatives at the other points: report (3.20).

        Args:
            x_known: (m, 1).

        Returns:
            (mN, 1): D_IN x_known.

        Raises:
            ValueError: ``x_known`` is not (m, 1).
        """
        check_shape("x_known", x_known, self.D_IN.shape[1], 1)
        return self.D_IN @ x_known

    def solve(self, x_known: Matrix) -> Matrix:
        """The values at all points: report (3.22) corrected, un-permuted with Pᵀ (report (3.23) corrected).

        Args:
            x_known: (m, 1) value at the known end.

        Returns:
            (m, N+1), one column per point, base to tip.

        Raises:
            ValueError: ``x_known`` is not (m, 1).
        """
        source = self.beta - self.ivp(x_known)
        unknown = _solve(self.D_NN - self.A_NN, source)
        # P is a permutation: its inverse is its transpose.
        stacked = self.P.T @ ca.vertcat(x_known, unknown)
        components = self.D_II.size1()
        points = stacked.size1() // components
        return ca.reshape(stacked, points, components).T


def permuted_system(A: Sequence[Matrix], b: Sequence[Matrix], *, known_at: End = "base") -> PermutedSystem:
    """The permuted system of a linear differential equation in X.

    Args:
        A: N + 1 matrices (m, m), the state matrix at the points, base to tip.
        b: N + 1 vectors (m, 1), the constant term at the points, base to tip.
        known_at: the end where the value of x will be given.

    Returns:
        The system, to be solved for any known value.

    Raises:
        ValueError: the lists or the shapes in them do not agree, or the end is neither of the two.
    """
    _check_coefficients(A, b, known_at)
    N = len(A) - 1
    m = A[0].shape[0]
    known = {"base": 0, "tip": N}[known_at]
    unknown = [j for j in range(N + 1) if j != known]
    P = _permutation([known, *unknown], m)
    # D acts component by component, as (3.4) stacks them; report (3.10) to (3.16), corrected: D_p = P D Pᵀ.
    by_component = ca.kron(ca.DM.eye(m), ca.DM(differentiation_matrix(N)))
    D = P @ by_component @ P.T
    return PermutedSystem(
        known_at=known_at,
        P=P,
        D_II=D[:m, :m],
        D_NI=D[:m, m:],
        D_IN=D[m:, :m],
        D_NN=D[m:, m:],
        A_NN=ca.diagcat(*[A[j] for j in unknown]),
        beta=ca.vertcat(*[b[j] for j in unknown]),
    )


def _permutation(order: Sequence[int], m: int) -> ca.DM:
    """The matrix from component-by-component stacking to point by point in the given order."""
    points = len(order)
    size = points * m
    rows = list(range(size))
    columns = [component * points + point for point in order for component in range(m)]
    return ca.DM.triplet(
        rows,
        columns,
        ca.DM.ones(size),
        size,
        size,
    )


def _solve(matrix: Matrix, rhs: Matrix) -> Matrix:
    """The solution of a square system."""
    # Scalar symbols have no choice of solver; the others take sparse QR.
    if isinstance(matrix, ca.SX) or isinstance(rhs, ca.SX):
        return ca.solve(matrix, rhs)
    return ca.solve(matrix, rhs, "qr")


def _check_coefficients(A: Sequence[Matrix], b: Sequence[Matrix], known_at: str) -> None:
    """Refuse lists that CasADi would combine in silence into another system."""
    if known_at not in ("base", "tip"):
        raise ValueError(f"the value is known at 'base' or 'tip', not {known_at!r}")
    if len(A) != len(b) or len(A) < 2:
        raise ValueError(f"A and b are given at the same two points or more, not at {len(A)} and {len(b)}")
    m = A[0].shape[0]
    for j in range(len(A)):
        check_shape(f"A[{j}]", A[j], m, m)
        check_shape(f"b[{j}]", b[j], m, 1)
