"""Small motions about an equilibrium, M δẍ + C δẋ + K δx = 0, on the coordinates that constraints leave free.

Multipliers and tensions have no inertia. A cable that yields, because it is slack or nearly so, is eliminated with its
tension. All other constraints are satisfied by variations in the null space of their gradients G: if the columns of Z
are an orthonormal basis of it, δx = Z z and Zᵀ (M Z z̈ + C Z ż + K Z z) = 0, as their wrenches do no work on Z.

Each row is scaled by its unit of energy, and each coordinate by the square root of it, so that K and M are symmetric if
the loads have a potential, for rods of any materials.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.relaxing_rows import BranchRows
from cosserat_casadi.numerics.neutral import kept_by

DEPENDENT = 1e-9
"""Singular value of G, over the largest one, below which a constraint is void or redundant.

A straight inextensible rod is not held along its axis to first order: that row consists of rounding errors.
"""

TAUT = 1e9
"""Stiffness of a cable, over the stiffness of the rods, above which it counts as one that does not yield."""


@dataclass(frozen=True)
class SmallMotions:
    """The equations of small motions, linear in δx and its rates.

    Attributes:
        stiffness: K = ∂ residual/∂x of all unknowns, shape (size, size), no unit.
        damping: C = ∂ residual/∂v, shape (size, size), s.
        mass: M = ∂ residual/∂a, shape (size, size), s².
        units: energy that each row is divided by, shape (size,), J.
        differential: whether an unknown is a coordinate that moves, shape (size,).
        held: gradients of further fixed quantities: norms of quaternions, which move nothing, then gaps of pressing
            contacts, shape (j, size).
        branches: rows that are integrated once in time (motion/relaxing_rows.py).
    """

    stiffness: FloatArray
    damping: FloatArray
    mass: FloatArray
    units: FloatArray
    differential: npt.NDArray[np.bool_]
    held: FloatArray
    branches: tuple[BranchRows, ...] = ()

    @cached_property
    def moving(self) -> npt.NDArray[np.int64]:
        """Indices of the n coordinates that move."""
        return np.flatnonzero(self.differential)

    @cached_property
    def algebraic(self) -> npt.NDArray[np.int64]:
        """Indices of the multipliers and tensions."""
        return np.flatnonzero(~self.differential)

    @cached_property
    def roots(self) -> FloatArray:
        """Square root of the energy unit of each moving coordinate, over the largest one, shape (n,)."""
        units = self.units[self.moving]
        largest = units.max(initial=0.0)
        return np.asarray(np.sqrt(units / largest))

    @cached_property
    def yielding(self) -> npt.NDArray[np.int64]:
        """Indices of the tensions of yielding cables, whose length follows from the tension."""
        chosen = []
        for index in self.algebraic:
            own = abs(self.stiffness[index, index])
            gradient = self.stiffness[index, self.moving] / self.roots
            pull = self.stiffness[self.moving, index] * self.roots
            stiffest = TAUT * own
            if own > 0.0 and np.linalg.norm(gradient) * np.linalg.norm(pull) <= stiffest:
                chosen.append(index)
        return np.array(chosen, dtype=np.int64)

    @cached_property
    def holding(self) -> npt.NDArray[np.int64]:
        """Indices of all other multipliers and tensions: their rows are the constraints."""
        return np.setdiff1d(self.algebraic, self.yielding)

    def moving_rows(self, columns: FloatArray) -> FloatArray:
        """Rows of the moving coordinates after the elimination of yielding cables.

        Args:
            columns: derivatives of all rows of the residual with k arguments, shape (size, k).

        Returns:
            the rows, shape (n, k), dimensionless except for the unit of the columns.
        """
        rows = columns[self.moving]
        if not self.yielding.size:
            return rows
        compliance = self.stiffness[np.ix_(self.yielding, self.yielding)]
        pull = self.stiffness[np.ix_(self.moving, self.yielding)]
        tension = -np.linalg.solve(compliance, columns[self.yielding])
        return np.asarray(rows + pull @ tension)

    @cached_property
    def constraints(self) -> FloatArray:
        """Gradients G of the constraints with respect to the scaled coordinates, as rows, shape (m, n).

        Coordinates that move nothing are held too, by equations that are not mechanical.
        """
        by_multipliers = self.stiffness[np.ix_(self.holding, self.moving)]
        gradients = np.vstack([by_multipliers, self.held[:, self.moving]])
        return np.asarray(gradients / self.roots)

    @cached_property
    def basis(self) -> FloatArray:
        """Orthonormal basis Z of the motions that the constraints admit, in scaled coordinates, shape (n, k)."""
        if not len(self.constraints):
            return np.eye(self.moving.size)
        return kept_by(self.constraints, DEPENDENT)

    def projected(self, rows: FloatArray) -> FloatArray:
        """Project rows of the moving coordinates, shape (n, j), on the free coordinates z, shape (k, j)."""
        return np.asarray(self.basis.T @ (self.roots[:, None] * rows))

    def displacement(self, free: npt.NDArray[np.inexact]) -> npt.NDArray[np.inexact]:
        """Return δx of all unknowns, (size, j), from free coordinates z, (k, j); zero for the algebraic unknowns."""
        unknowns = np.zeros((self.units.size, free.shape[1]), dtype=free.dtype)
        unknowns[self.moving] = self.basis @ free / self.roots[:, None]
        return unknowns

    def creeps(self, values: npt.NDArray[np.complex128], free: npt.NDArray[np.inexact]) -> npt.NDArray[np.bool_]:
        """Whether each motion is a decay that is damped more by dashpots of branches than by all else, shape (p,).

        Args:
            values: eigenvalues λ, shape (p,).
            free: eigenvectors on the free coordinates, shape (k, p).
        """
        moved = self.displacement(free)
        weighted = self.units[:, None] * moved.conj()
        braked = np.abs(np.sum(weighted * (self.damping @ moved), axis=0))
        by_branches = np.zeros(len(values))
        for branch in self.branches:
            own = self.damping[branch.flows, branch.flows] @ moved[branch.flows]
            by_branches += np.sum(weighted[branch.flows] * own, axis=0).real
        return np.asarray((values.imag == 0.0) & (values.real < 0.0) & (by_branches > braked / 2))

    @cached_property
    def free_stiffness(self) -> FloatArray:
        """K on the free coordinates, shape (k, k), no unit."""
        return self._free(self.stiffness)

    @cached_property
    def free_damping(self) -> FloatArray:
        """C on the free coordinates, shape (k, k), s."""
        return self._free(self.damping)

    @cached_property
    def free_mass(self) -> FloatArray:
        """M on the free coordinates, shape (k, k), s²; symmetric, positive semidefinite."""
        mass = self._free(self.mass)
        return (mass + mass.T) / 2

    def _free(self, matrix: FloatArray) -> FloatArray:
        rows = self.moving_rows(matrix)[:, self.moving]
        scaled = rows / self.roots
        return self.projected(scaled @ self.basis)


def quaternion_growth(model: Model, x: FloatArray) -> FloatArray:
    """Gradients of the norms of the quaternions of floating frames, which no mechanics sees, shape (frames, size)."""
    discrete = model.discrete
    gradients = np.zeros((len(discrete.frames), model.size))
    for row, (name, frame) in zip(gradients, discrete.frames.items(), strict=True):
        entries = discrete.deviation(name)
        # Of the seven unknowns of a frame the last four are what its quaternion differs by from that at the start.
        row[entries][3:] = frame.start.quaternion + x[entries][3:]
    return gradients
