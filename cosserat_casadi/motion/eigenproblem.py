"""Eigenvalues of (λ² M + λ C + K) z = 0, where M may be singular and K singular or indefinite.

The inverse resolves low frequencies best, and maps directions without mass to zero, so its eigenvalues are sought. With
F = (K + s M)⁻¹ and M = N Nᵀ the nonzero eigenvalues ν of Nᵀ F N are 1/(s − λ²), however singular M
is: directions without mass drop out. The shift s, about the square of the lowest frequency, keeps rigid motions and
critical equilibria from making the matrix singular.

With damping, λ = √s + s₁ shifts the quadratic problem alike: μ² z + μ F C₁ z + F M z = 0 with μ = 1/s₁,
C₁ = C + 2 √s M and F = (K + √s C + s M)⁻¹, solved in the companion form (F. Tisseur, K. Meerbergen, *SIAM Review* 43
(2001) 235–286).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.typing import FloatArray

ComplexArray: TypeAlias = npt.NDArray[np.complex128]

ZERO = 1e-8
"""A squared eigenvalue below this share of the shift counts as zero: the rounding of K decides it."""

INFINITE = 1e-14
"""An inverse squared eigenvalue below this share of the largest one belongs to a direction without mass."""

NOTHING = 1e-12
"""Stiffness and mass of a direction, over those of the rods, below which they count as zero."""

REAL = 1e-9
"""A real part below this share of an undamped eigenvalue is rounding."""

NO_DAMPING = 1e-13
"""A real part below this share of an eigenvalue of a damped scene is rounding: the mode is undamped."""

SAME = 1e-4
"""Singular value below which the shape of a rigid motion depends on others."""


@dataclass(frozen=True)
class Eigenpairs:
    """Eigenvalues with their vectors, by increasing size; of a conjugate pair, the one with positive imaginary part.

    An eigenvalue zero, of a rigid or a neutral motion z = a + b t, appears once for each direction.

    Attributes:
        values: λ, shape (p,), 1/s.
        vectors: eigenvectors as columns, shape (k, p).
    """

    values: ComplexArray
    vectors: ComplexArray

    @staticmethod
    def sorted(values: ComplexArray, vectors: ComplexArray) -> Eigenpairs:
        """Sort eigenpairs by size; of two that are equal in size, the growing one comes first."""
        # What differs by rounding alone is of one size, so that the order does not depend on it.
        sizes = np.abs(values)
        digits = np.array([float(f"{size:.9e}") for size in sizes])
        order = np.lexsort((-values.real, digits))
        return Eigenpairs(values[order], vectors[:, order])


def natural_shift(mass: FloatArray) -> float:
    """Shift s: the inverse of the largest eigenvalue of M, 1/s², for K with entries of order one.

    Raises:
        ValueError: nothing has mass.
    """
    largest = float(np.linalg.eigvalsh(mass).max(initial=0.0))
    if not largest > 0.0:
        raise ValueError("no coordinate that may move has mass")
    return 1.0 / largest


def slowest_told(mass: FloatArray) -> float:
    """Least |λ| that can be distinguished from zero, 1/s, for the mass matrix of :func:`eigenpairs`."""
    return float(np.sqrt(ZERO * natural_shift(mass)))


def eigenpairs(stiffness: FloatArray, damping: FloatArray, mass: FloatArray, *, conservative: bool) -> Eigenpairs:
    """Compute all finite eigenvalues with their vectors.

    Args:
        stiffness: K, shape (k, k).
        damping: C, shape (k, k).
        mass: M, symmetric and positive semidefinite, shape (k, k).
        conservative: whether K is symmetric up to rounding.

    Raises:
        ValueError: M is zero.
    """
    return _damped(stiffness, damping, mass) if np.any(damping) else _undamped(stiffness, mass, conservative)


def undamped_modes(stiffness: FloatArray, mass: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Compute the modes of symmetric matrices: λ² = −ω², lowest frequency first, and vectors Φ with Φᵀ M Φ = I.

    Args:
        stiffness: K, symmetric, shape (k, k).
        mass: M, symmetric and positive semidefinite, shape (k, k).

    Returns:
        λ² of shape (r,) in 1/s², and Φ of shape (k, r), where r is the rank of M.
    """
    shift = natural_shift(mass)
    root = _root(mass)
    response = _inverse(stiffness + shift * mass) @ root
    inverse = root.T @ response
    inverse_squares, vectors = np.linalg.eigh((inverse + inverse.T) / 2)
    finite = _finite(inverse_squares)
    chosen = inverse_squares[finite]
    # Of a vector y of Nᵀ F N the mode is F N y / ν: it has the modal mass 1.
    modes = response @ vectors[:, finite] / chosen
    squares = shift - 1.0 / chosen
    order = np.argsort(-squares)
    return squares[order], modes[:, order]


def _undamped(stiffness: FloatArray, mass: FloatArray, conservative: bool) -> Eigenpairs:
    """Eigenpairs without damping, from the eigenvalues λ²."""
    shift = natural_shift(mass)
    if conservative:
        real_squares, real_vectors = undamped_modes(stiffness, mass)
        squares = real_squares.astype(complex)
        vectors = real_vectors.astype(complex)
    else:
        squares, vectors = _asymmetric_modes(stiffness, mass)
    values = []
    columns = []
    for index, square in enumerate(squares):
        for value in _roots_of(square, shift):
            values.append(value)
            columns.append(vectors[:, index])
    return _collected(values, columns, len(mass))


def _asymmetric_modes(stiffness: FloatArray, mass: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    """Eigenvalues λ² and vectors for a K that is not symmetric."""
    shift = natural_shift(mass)
    root = _root(mass)
    response = _inverse(stiffness + shift * mass) @ root
    inverse_squares, vectors = np.linalg.eig(root.T @ response)
    finite = _finite(inverse_squares)
    chosen = np.asarray(inverse_squares[finite], dtype=complex)
    modes = np.asarray(response @ vectors[:, finite] / chosen, dtype=complex)
    squares = np.asarray(shift - 1.0 / chosen, dtype=complex)
    return squares, modes


def _roots_of(square: complex, shift: float) -> list[complex]:
    """Eigenvalues λ of one λ², without those of negative imaginary part."""
    if abs(square) <= ZERO * shift:
        return [0j]
    root = complex(np.sqrt(complex(square)))
    if abs(root.imag) <= REAL * abs(root):
        growth = abs(root.real)
        return [complex(growth), complex(-growth)]
    if abs(root.real) <= REAL * abs(root):
        return [complex(0.0, abs(root.imag))]
    # Of the four ±λ and their conjugates the root has one; its conjugate comes from the conjugate of λ².
    if root.imag < 0.0:
        root = -root
    return [root]


def _damped(stiffness: FloatArray, damping: FloatArray, mass: FloatArray) -> Eigenpairs:
    """Eigenpairs of the quadratic problem with damping, solved in units of the root of the shift."""
    shift = natural_shift(mass)
    rate = np.sqrt(shift)
    shifted_stiffness = stiffness + rate * damping + shift * mass
    # All in units of the shift, so that both blocks of the companion matrix are of order one.
    shifted_damping = rate * damping + 2.0 * shift * mass
    scaled_mass = shift * mass
    moved = _row_space(shifted_damping, scaled_mass)
    flexibility = _inverse(shifted_stiffness)
    by_damping = flexibility @ shifted_damping @ moved
    by_mass = flexibility @ scaled_mass @ moved
    count = moved.shape[1]
    companion = np.zeros((2 * count, 2 * count))
    companion[:count, :count] = -moved.T @ by_damping
    companion[:count, count:] = -moved.T @ by_mass
    companion[count:, :count] = np.eye(count)
    inverses, vectors = np.linalg.eig(companion)
    # The companion matrix knows small μ to the root of the rounding only: those stand for no finite eigenvalue.
    finite = np.abs(inverses) > np.sqrt(INFINITE) * np.abs(inverses).max(initial=0.0)
    inverses = inverses[finite].astype(complex)
    free = vectors[count:, finite]
    steps = 1.0 / inverses
    shapes = -(by_damping @ free) * steps - (by_mass @ free) * steps**2
    values = rate * (1.0 + steps)
    return _without_conjugates(values, shapes, shift)


def _without_conjugates(values: ComplexArray, shapes: ComplexArray, shift: float) -> Eigenpairs:
    """Keep one of each conjugate pair, and as many zeros as there are independent shapes."""
    zero = np.abs(values) ** 2 <= ZERO * shift
    kept_values: list[complex] = []
    kept_shapes: list[ComplexArray] = []
    for index in np.flatnonzero(~zero):
        value = complex(values[index])
        if abs(value.real) <= NO_DAMPING * abs(value):
            value = complex(0.0, value.imag)
        if value.imag >= 0.0:
            kept_values.append(value)
            kept_shapes.append(shapes[:, index])
    # A rigid motion has the eigenvalue 0 twice and one shape: rounding splits the pair.
    for shape in _independent(shapes[:, zero]).T:
        kept_values.append(0j)
        kept_shapes.append(shape)
    return _collected(kept_values, kept_shapes, len(shapes))


def _independent(shapes: ComplexArray) -> ComplexArray:
    """Real orthonormal shapes that span complex shapes, shape (k, p)."""
    if not shapes.size:
        return shapes
    parts = np.hstack([shapes.real, shapes.imag])
    lengths = np.linalg.norm(parts, axis=0)
    # A part that is rounding beside its other half would be blown up to a shape of its own.
    directions = parts[:, lengths > SAME * lengths.max()]
    unit = directions / np.linalg.norm(directions, axis=0)
    left, singular, _ = np.linalg.svd(unit, full_matrices=False)
    return np.asarray(left[:, singular > SAME], dtype=complex)


def _collected(values: list[complex], columns: list[ComplexArray], size: int) -> Eigenpairs:
    if not values:
        return Eigenpairs(np.zeros(0, dtype=complex), np.zeros((size, 0), dtype=complex))
    return Eigenpairs.sorted(np.array(values), np.array(columns).T)


def _inverse(shifted: FloatArray) -> FloatArray:
    """Invert K + s M, which is of order one, on all directions that have stiffness or mass.

    A rod without rotary inertia that turns about its straight axis has neither: its rotation is undetermined.
    """
    left, singular, right = np.linalg.svd(shifted)
    known = singular > NOTHING
    return np.asarray((right[known].T / singular[known]) @ left[:, known].T)


def _root(mass: FloatArray) -> FloatArray:
    """Factor N of M = N Nᵀ, with as many columns as M has positive eigenvalues."""
    eigenvalues, vectors = np.linalg.eigh(mass)
    positive = eigenvalues > 0.0
    return np.asarray(vectors[:, positive] * np.sqrt(eigenvalues[positive]))


def _row_space(*matrices: FloatArray) -> FloatArray:
    """Orthonormal basis of the joint row space of matrices, shape (k, r)."""
    stacked = np.vstack(matrices)
    _, singular, rows = np.linalg.svd(stacked)
    seen = singular > INFINITE * singular.max(initial=0.0)
    rank = int(np.sum(seen))
    return np.asarray(rows[:rank].T)


def _finite(inverse_squares: npt.NDArray[np.inexact]) -> npt.NDArray[np.bool_]:
    sizes = np.abs(inverse_squares)
    return np.asarray(sizes > INFINITE * sizes.max(initial=0.0))
