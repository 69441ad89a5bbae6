"""Collocation methods as tables: Radau IIA and Gauss with one, two or three stages.

A step of size h collocates at the times c_i h. Its Butcher matrix integrates the Lagrange polynomials of these nodes,
A_ij = ∫₀^{c_i} ℓ_j, b_j = ∫₀¹ ℓ_j; for equations of second order A enters squared. The eigenvalues of A decouple the
linear system of all stages into systems of one stage each. E. Hairer, G. Wanner, *Solving Ordinary Differential
Equations II*, 2nd ed., Springer 1996, sections IV.5 and IV.8.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
import numpy.typing as npt
from numpy.polynomial import Legendre

from cosserat_casadi.maths.typing import FloatArray

MOST_STAGES = 3
"""Largest number of stages for which tables are made and tested."""

STAGES = 3
"""Number of stages in simulations and optimal control: order 5 with Radau IIA, 6 with Gauss."""


@dataclass(frozen=True)
class Collocation:
    """A collocation method with s stages.

    Attributes:
        name: family and number of stages.
        nodes: nodes c, shape (s,).
        matrix: Butcher matrix A, shape (s, s).
        matrix_squared: A², shape (s, s).
        weights: weights b, shape (s,).
        position_weights: bᵀA, shape (s,).
        order: order of a step for smooth nonstiff equations.
        stiffly_accurate: whether the last stage is the end of the step.
        polynomials: coefficients of the Lagrange polynomials, ℓ_j(θ) = Σ_k θ^k polynomials[k, j], shape (s, s).
        eigenvalues: eigenvalues of A, real ones first; of a conjugate pair the one above the real axis; shape (k,).
        to_eigenvectors: map of values at stages to coordinates along these eigenvectors, shape (k, s).
        from_eigenvectors: the inverse map, by its real part, with doubled conjugate pairs, shape (s, k).
    """

    name: str
    nodes: FloatArray
    matrix: FloatArray
    matrix_squared: FloatArray
    weights: FloatArray
    position_weights: FloatArray
    order: int
    stiffly_accurate: bool
    polynomials: FloatArray
    eigenvalues: npt.NDArray[np.complex128]
    to_eigenvectors: npt.NDArray[np.complex128]
    from_eigenvectors: npt.NDArray[np.complex128]

    @property
    def stages(self) -> int:
        """Number of stages s."""
        return len(self.nodes)

    def values_at(self, share: float | FloatArray) -> FloatArray:
        """Lagrange polynomials ℓ_j at a share θ of the step, shape (s,), or at k shares, shape (k, s)."""
        powers = np.asarray(share)[..., None] ** np.arange(self.stages)
        # No product of matrices: it rounds a row by its place among the others.
        return np.asarray(np.einsum("...k,kj->...j", powers, self.polynomials))

    def integrals_at(self, share: float | FloatArray) -> FloatArray:
        """Integrals ∫₀^θ ℓ_j, shape (s,), or at k shares, shape (k, s)."""
        exponents = np.arange(1, self.stages + 1)
        powers = np.asarray(share)[..., None] ** exponents / exponents
        return np.asarray(np.einsum("...k,kj->...j", powers, self.polynomials))

    def double_integrals_at(self, share: float | FloatArray) -> FloatArray:
        """Double integrals ∫₀^θ ∫₀^σ ℓ_j, shape (s,), or at k shares, shape (k, s)."""
        exponents = np.arange(2, self.stages + 2)
        powers = np.asarray(share)[..., None] ** exponents / (exponents * (exponents - 1))
        return np.asarray(np.einsum("...k,kj->...j", powers, self.polynomials))


@cache
def radau(stages: int) -> Collocation:
    """Radau IIA: order 2s − 1, L-stable, with the last stage at the end of the step.

    Raises:
        ValueError: there is no such table.
    """
    _check_stages(stages)
    polynomial = Legendre.basis(stages) - Legendre.basis(stages - 1)
    nodes = (1.0 + polynomial.roots().real) / 2.0
    # The last node is 1 by definition; the roots have it to rounding only.
    nodes[-1] = 1.0
    return _collocation(f"Radau IIA, stages {stages}", nodes, order=2 * stages - 1)


@cache
def gauss(stages: int) -> Collocation:
    """Gauss: order 2s, symmetric and symplectic; it does not damp, and is unsuitable for constraints.

    Raises:
        ValueError: there is no such table.
    """
    _check_stages(stages)
    nodes = (1.0 + Legendre.basis(stages).roots().real) / 2.0
    return _collocation(f"Gauss, stages {stages}", nodes, order=2 * stages)


def _check_stages(stages: int) -> None:
    if stages not in range(1, MOST_STAGES + 1):
        raise ValueError(f"stages: {stages} is not one of 1 to {MOST_STAGES}")


def _collocation(name: str, nodes: FloatArray, order: int) -> Collocation:
    """Make the tables of the method with given nodes in (0, 1]."""
    stages = len(nodes)
    exponents = np.arange(1, stages + 1)
    powers = nodes[:, None] ** (exponents - 1)
    polynomials = np.asarray(np.linalg.inv(powers), dtype=np.float64)
    matrix = (nodes[:, None] ** exponents / exponents) @ polynomials
    weights = (1.0 / exponents) @ polynomials

    eigenvalues, eigenvectors = np.linalg.eig(matrix)
    eigenvalues = eigenvalues.astype(np.complex128)
    inverse = np.linalg.inv(eigenvectors)
    upper = np.flatnonzero(eigenvalues.imag >= 0.0)
    upper = upper[np.argsort(eigenvalues[upper].imag)]
    counts = np.where(eigenvalues[upper].imag > 0.0, 2.0, 1.0)
    return Collocation(
        name=name,
        nodes=nodes,
        matrix=matrix,
        matrix_squared=matrix @ matrix,
        weights=weights,
        position_weights=weights @ matrix,
        order=order,
        stiffly_accurate=bool(nodes[-1] == 1.0),
        polynomials=polynomials,
        eigenvalues=eigenvalues[upper],
        to_eigenvectors=inverse[upper].astype(np.complex128),
        from_eigenvectors=(eigenvectors[:, upper] * counts).astype(np.complex128),
    )
