"""Poses that a coarser discretisation would give, from a converged finer one and without building a model.

A fine solution, the witness, knows the equilibrium, its Jacobian, and by the order of its polynomials every coarser
set of modes: dropping a mode is dropping a row and a column. So the equilibrium with fewer modes is a few corrections
in a subspace, and that on another grid is one correction with the residual of that grid. Both are solutions to within
the square of what is neglected, so the superconvergence of the tip is in them: an error estimated from the tail of
the strain alone would be far too large.

What is compared are the tips. The tip of a rod that a support holds is where it is held, however coarse the model:
such a rod is watched at sections between its ends too, and where a scene asks for the whole shape every rod is.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.equilibrium.solution import Solution, rotations
from cosserat_casadi.maths.rotation import quaternion_product, quaternion_to_matrix
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.discrete_scene import discrete_scene
from cosserat_casadi.model.system import Arguments, System
from cosserat_casadi.numerics.broyden import SINGULAR
from cosserat_casadi.rod.discretisation import Discretisation

Mask = npt.NDArray[np.bool_]
Modes = Mapping[str, tuple[int, ...]]
"""Modes of every admitted strain and element, for each rod."""

CORRECTIONS = 2
"""Corrections with the witness's Jacobian after dropping modes; each reduces the error by about the tail dropped."""

BETWEEN = (0.25, 0.5, 0.75, 1.0)
"""Sections at which a held rod is watched."""

SAMPLES = (1 - np.cos(np.pi * np.arange(33) / 32)) / 2
"""Sections at which a whole shape is watched or compared."""


def watched(model: Model, rod: str) -> FloatArray:
    """Abscissae of the sections whose poses must be right to the tolerance, shape (k,)."""
    scene = model.scene
    if scene.accuracy.shape:
        return SAMPLES[1:]
    held = any(holder.rod == rod for holder in (*scene.supports, *scene.joints))
    return np.array(BETWEEN if held else (1.0,))


@dataclass(frozen=True)
class Preview:
    """A witness that is asked what coarser discretisations would give.

    Attributes:
        witness: a converged solution.
    """

    witness: Solution
    _shifts: dict[tuple[tuple[str, tuple[int, ...]], ...], FloatArray] = field(default_factory=dict, repr=False)

    @property
    def model(self) -> Model:
        """The witness's model."""
        return self.witness.model

    @cached_property
    def jacobian(self) -> FloatArray:
        """Jacobian at the witness, shape (n, n)."""
        return _numbers(self.model.path_jacobian(self.witness.x, self._inputs, 1.0))

    @cached_property
    def _held(self) -> FloatArray:
        """The Jacobian with a stiffness against what symmetry leaves neutral, so that no correction moves along it."""
        left, singular, right = np.linalg.svd(self.jacobian)
        largest = float(singular.max(initial=0.0))
        neutral = singular <= SINGULAR * largest
        return np.asarray(self.jacobian + largest * left[:, neutral] @ right[neutral])

    @cached_property
    def tips(self) -> FloatArray:
        """Watched poses of the witness: positions over length and rotation entries, 12 for each section."""
        return self._tips(self.witness.x)

    def kept(self, modes: Modes) -> Mask:
        """Unknowns of the witness that exist with these modes, shape (n,); multipliers always do."""
        mask = np.ones(self.model.size, dtype=bool)
        for name, discrete_rod in self.model.discrete.rods.items():
            first = self.model.discrete.unknowns.strain(name).start
            for columns, full, count in zip(
                discrete_rod.columns.values(), discrete_rod.discretisation.modes, modes[name], strict=True
            ):
                inside = np.tile(np.arange(full) < count, discrete_rod.grid.elements)
                mask[first + columns.start : first + columns.stop] = inside
        return mask

    def with_modes(self, modes: Modes) -> FloatArray:
        """Unknowns of the equilibrium with fewer modes on the witness's grid, shape (n,), zero where dropped."""
        kept = self.kept(modes)
        inverse = _inverse(self._held[np.ix_(kept, kept)])
        x = np.where(kept, self.witness.x, 0.0)
        x[kept] += inverse @ (self.jacobian[np.ix_(kept, ~kept)] @ self.witness.x[~kept])
        for _ in range(CORRECTIONS):
            x[kept] -= inverse @ self.model.residual(x, self._inputs).full()[kept, 0]
        return x

    def mode_shift(self, modes: Modes) -> FloatArray:
        """Change of the watched poses by having fewer modes, 12 entries for each section."""
        key = tuple(modes.items())
        if key not in self._shifts:
            # Held rods of too few modes may have no equilibrium near: whatever comes out then is beyond all bounds.
            with np.errstate(all="ignore"):
                shift = self._tips(self.with_modes(modes)) - self.tips
            self._shifts[key] = np.where(np.isfinite(shift), shift, np.inf)
        return self._shifts[key]

    def grid_shift(self, x: FloatArray, modes: Modes, grids: Mapping[str, Discretisation]) -> FloatArray:
        """Change of the watched poses from the witness's grid to others, 12 entries for each section.

        Args:
            x: equilibrium with the given modes on the witness's grid, from :meth:`with_modes`.
            modes: modes of every rod.
            grids: nodes and transport of every rod; their modes are not read.
        """
        kept = self.kept(modes)
        full = {n: replace(grids[n], modes=d.modes) for n, d in self.model.discretisation.items()}
        other = System(
            discrete_scene(self.model.scene, self.model.inputs, full), Arguments(ca.DM(x), ca.DM(self._inputs))
        )
        moved = x.copy()
        moved[kept] -= _inverse(self._held[np.ix_(kept, kept)]) @ _numbers(other.residual)[kept, 0]
        # The unknowns move by far less than the tips can tell apart on two grids: the witness's grid serves.
        return self._tips_of(other) - self._tips(x) + self._tips(moved) - self._tips(x)

    @property
    def _inputs(self) -> FloatArray:
        return self.witness.inputs

    def _tips(self, x: FloatArray) -> FloatArray:
        found = []
        for name, discrete_rod in self.model.discrete.rods.items():
            X = watched(self.model, name)
            if len(X) == 1:
                position, quaternion, _ = self.model.tip[name](x, self._inputs)
            else:
                nodal = self.model.fields[name](x, self._inputs)
                matrix = ca.DM(discrete_rod.grid.interpolation_matrix(X)).T
                position, quaternion = nodal[0] @ matrix, nodal[1] @ matrix
            found.append(_entries(position, quaternion, discrete_rod.properties.length))
        return np.concatenate(found)

    def _tips_of(self, system: System) -> FloatArray:
        found = []
        for name, discrete_rod in system.discrete.rods.items():
            X, shape, base = watched(self.model, name), system.rods[name].shape, system.base(name)
            if len(X) == 1:
                position, quaternion = shape.position_at(-1), shape.quaternion[:, -1]
            else:
                matrix = ca.DM(discrete_rod.grid.interpolation_matrix(X)).T
                position, quaternion = shape.position @ matrix, shape.quaternion @ matrix
            place = ca.repmat(base.position, 1, len(X)) + quaternion_to_matrix(base.quaternion) @ position
            turn = quaternion_product(ca.repmat(base.quaternion, 1, len(X)), ca.densify(quaternion))
            found.append(_entries(place, turn, discrete_rod.properties.length))
        return np.concatenate(found)


def _entries(position: Matrix, quaternion: Matrix, length: float) -> FloatArray:
    """Positions over length and rotation entries of k sections, from 3×k and 4×k, stacked."""
    columns = _numbers(quaternion).T
    turns = rotations(columns / np.linalg.norm(columns, axis=1, keepdims=True))
    entries: FloatArray = np.concatenate([_numbers(position).ravel() / length, turns.ravel()])
    return entries


def _inverse(matrix: FloatArray) -> FloatArray:
    """The inverse; of a singular matrix the pseudo-inverse."""
    try:
        return np.asarray(np.linalg.inv(matrix), dtype=np.float64)
    except np.linalg.LinAlgError:
        return np.asarray(np.linalg.pinv(matrix), dtype=np.float64)


def _numbers(matrix: Matrix) -> FloatArray:
    """Values of a matrix without symbols: what supports add is wrapped as an expression."""
    values: FloatArray = ca.evalf(ca.MX(matrix)).full()
    return values
