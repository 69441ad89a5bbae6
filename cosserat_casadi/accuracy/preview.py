"""Preview of the poses on a coarser discretisation, from a converged finer solution and without building a model.

A fine solution, the reference, has the equilibrium, its Jacobian, and, by the order of its polynomials, every coarser
set of modes: dropping a mode is dropping a row and a column. So the equilibrium with fewer modes takes a few
corrections in a subspace, and the equilibrium on another grid one correction with the residual of that grid. Both are
exact to the square of the neglected terms, and so include the superconvergence of the tip: an error estimated from the
tail of the strain would be far too large.

Watched poses and cables are compared: model/watched.py.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.equilibrium.answer_error import watched_at
from cosserat_casadi.equilibrium.locking import degrees_of_freedom, motion, residual_by_inputs
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.discrete_scene import DiscreteScene, Richer, discrete_scene
from cosserat_casadi.model.discretise import with_more_fibres
from cosserat_casadi.model.scene_equations import SceneEquations
from cosserat_casadi.model.system import Arguments, System
from cosserat_casadi.model.watched import SAMPLES, WatchedNumbers, section_poses, watched, watched_cables
from cosserat_casadi.numerics.neutral import regular, regular_inverse
from cosserat_casadi.rod.discretisation import Discretisation

Mask = npt.NDArray[np.bool_]
Modes = Mapping[str, tuple[int, ...]]
"""Modes of every admitted strain and element, for each rod."""

LEAST_COMPLIANCE = 0.1
"""Least share, by fewer modes, of the motion by inputs with all modes: closed loops with few modes lock."""

AMPLE_FREEDOM = 24
"""Free coordinates for each body with which nothing locks: four for each of its motions."""

CORRECTIONS = 2
"""Corrections with the reference's Jacobian after dropping modes; each multiplies the error by about the dropped
tail."""


@dataclass(frozen=True)
class FinerShift:
    """Changes by the missing modes of a reference; see :mod:`cosserat_casadi.maths.pose_change`.

    Attributes:
        tips: changes of the watched poses and cables, shape (2k + c, 3).
        shapes: changes of sections all along the rods, between the nodes of the reference too, shape (2s, 3).
    """

    tips: FloatArray
    shapes: FloatArray


@dataclass(frozen=True)
class Preview:
    """A reference solution with previews of coarser discretisations."""

    reference: Solution
    _shifts: dict[tuple[tuple[str, tuple[int, ...]], ...], FloatArray] = field(default_factory=dict, repr=False)

    @property
    def model(self) -> Model:
        """The reference's model."""
        return self.reference.model

    @cached_property
    def jacobian(self) -> FloatArray:
        """Jacobian at the reference, shape (n, n)."""
        jacobian = self.model.path_jacobian(self.reference.x, self.reference.inputs, 1.0)
        return _numbers(jacobian)

    @cached_property
    def _regular_jacobian(self) -> FloatArray:
        """The Jacobian with a stiffness against variations that symmetry makes neutral, so that these stay zero."""
        return regular(self.jacobian)

    @cached_property
    def tips(self) -> WatchedNumbers:
        """The watched poses and cables of the reference."""
        return watched_at(self.reference, self.reference.x)

    @property
    def no_shift(self) -> FloatArray:
        """The zero change of the watched numbers."""
        return self.tips.change_from(self.tips)

    def kept(self, modes: Modes) -> Mask:
        """Whether each unknown of the reference exists with these modes, shape (n,); multipliers always do."""
        return self.model.discrete.existing(modes)

    def with_modes(self, modes: Modes) -> FloatArray:
        """Unknowns of the equilibrium with fewer modes on the reference's grid, shape (n,), zero where dropped."""
        kept = self.kept(modes)
        inverse = self._inverse_of_kept(kept)
        x = np.where(kept, self.reference.x, 0.0)
        # To first order the kept unknowns balance the residual that the dropped ones leave: J_kk δx_k = J_kd x_d.
        coupling = self.jacobian[np.ix_(kept, ~kept)]
        dropped = self.reference.x[~kept]
        x[kept] += inverse @ (coupling @ dropped)
        for _ in range(CORRECTIONS):
            residual = self.model.residual(x, self.reference.inputs).full()
            x[kept] -= inverse @ residual[kept, 0]
        return x

    def mode_shift(self, modes: Modes) -> FloatArray:
        """Change of the watched numbers by fewer modes, shape (2k + c, 3); infinite if these lock."""
        key = tuple(modes.items())
        if key not in self._shifts and self._locks(self.kept(modes)):
            self._shifts[key] = np.full_like(self.no_shift, np.inf)
        if key not in self._shifts:
            # Held rods with too few modes may have no equilibrium nearby: such a result is above all bounds.
            with np.errstate(all="ignore"):
                x = self.with_modes(modes)
                shift = watched_at(self.reference, x).change_from(self.tips)
            finite = np.isfinite(shift)
            self._shifts[key] = np.where(finite, shift, np.inf)
        return self._shifts[key]

    def grid_shift(self, x: FloatArray, modes: Modes, grids: Mapping[str, Discretisation]) -> FloatArray:
        """Change of the watched numbers from the reference's grid to others, shape (2k + c, 3).

        Args:
            x: equilibrium with the given modes on the reference's grid, from :meth:`with_modes`.
            modes: modes of every rod.
            grids: nodes and transport of every rod; their modes are ignored.
        """
        regridded = self._regridded(x, grids)
        # The unknowns change so little that the tips may be evaluated on the reference's grid.
        by_grid = _tips_of(regridded).change_from(watched_at(self.reference, x))
        return by_grid + self._shift_by_unknowns(x, self.kept(modes), regridded)

    def sums_shift(self) -> FloatArray:
        """Change of the watched numbers by sums of layers at finer sections, which show the error of the sums."""
        discrete = self.model.discrete
        if not discrete.finer_sections:
            return self.no_shift
        x = self.reference.x
        finer = self._system(replace(discrete, given_sections=discrete.finer_sections), x)
        return self._shift_by_unknowns(x, np.ones(len(x), dtype=bool), finer)

    def fibres_shift(self) -> FloatArray:
        """Change of the watched numbers by laws that are summed at more fibres, which show the error of their sums."""
        chosen = self.model.discretisation
        if not any(own.fibres for own in chosen.values()):
            return self.no_shift
        x = self.reference.x
        return self._shift_by_unknowns(x, np.ones(len(x), dtype=bool), self._regridded(x, with_more_fibres(chosen)))

    def _shift_by_unknowns(self, x: FloatArray, kept: Mask, system: System) -> FloatArray:
        """Change of the watched numbers by one Newton step from x with the equations of another system.

        The step uses the Jacobian of the reference.
        """
        residual = _numbers(SceneEquations(system).residual)[kept, 0]
        corrected = x.copy()
        corrected[kept] -= self._inverse_of_kept(kept) @ residual
        return watched_at(self.reference, corrected).change_from(watched_at(self.reference, x))

    def finer_shift(self, grids: Mapping[str, Discretisation], sweeps: int) -> FinerShift:
        """Changes by missing modes of the reference, on a grid that resolves them.

        The stiffness dominates the short waves of the added modes, so that its inverse times their residual is their
        step; the reference's Jacobian tells how all others follow. A few sweeps of both converge to Newton's correction
        with the model of all these modes, which is not built.

        Args:
            grids: modes, nodes and transport of every rod; modes no fewer than the reference's.
            sweeps: number of steps of the added modes with all others following; with 0 the added modes make one step
                and no other follows, which tells shapes but not tips.
        """
        model = self.model
        richer = Richer(model.discrete, discrete_scene(model.scene, model.inputs, dict(grids)))
        inverse = regular_inverse(self.jacobian)

        def system(known: FloatArray, missing: FloatArray) -> System:
            return self._system(richer.discrete, richer.joined(ca.DM(known), ca.DM(missing)))

        known: FloatArray = self.reference.x
        missing: FloatArray = np.zeros(richer.missing_size)
        current = system(known, missing)
        # Tips change by the modes alone: their change by the grid is estimated separately.
        tips = _tips_of(current)
        for _ in range(max(sweeps, 1)):
            _, lacking = richer.split(_as_numbers(SceneEquations(current).residual))
            step, missing_step = richer.split(richer.elastic_step(lacking, current.shapes))
            known = known + _column(step)
            missing = missing + _column(missing_step)
            if sweeps > 0:
                residual, _ = richer.split(_as_numbers(SceneEquations(system(known, missing)).residual))
                known = known - inverse @ _column(residual)
            current = system(known, missing)
        return FinerShift(
            tips=_tips_of(current).change_from(tips),
            shapes=_shapes_of(current).change_from(self._shapes),
        )

    def _locks(self, kept: Mask) -> bool:
        """Whether constraints leave these unknowns so little freedom that some input hardly moves anything."""
        if self._has_ample_freedom(kept):
            return False
        steps = np.zeros_like(self._pushes)
        steps[kept] = -self._inverse_of_kept(kept) @ self._pushes[kept]
        return bool(np.any(self._motions(steps) < LEAST_COMPLIANCE * self._whole_motions))

    def _has_ample_freedom(self, kept: Mask) -> bool:
        """Whether so many coordinates are free that nothing can lock; true without constraints."""
        freedom = degrees_of_freedom(self.model)
        if freedom is None:
            return True
        dropped = int(np.count_nonzero(~kept))
        return freedom - dropped >= AMPLE_FREEDOM * max(len(self.model.discrete.bodies), 1)

    @cached_property
    def _pushes(self) -> FloatArray:
        """Derivatives of the residual by the inputs, shape (n, inputs)."""
        return residual_by_inputs(self.model, self.reference.x, self.reference.inputs)

    @cached_property
    def _whole_motions(self) -> FloatArray:
        """Motions by the inputs with all unknowns, shape (inputs,)."""
        return self._motions(-_inverse(self._regular_jacobian) @ self._pushes)

    def _motions(self, steps: FloatArray) -> FloatArray:
        """Motions of the watched poses and cables by steps of the unknowns, shape (n, k), one in each column."""
        return np.array([motion(self.model, self.reference.x, self.reference.inputs, step) for step in steps.T])

    def _inverse_of_kept(self, kept: Mask) -> FloatArray:
        rows_and_columns = np.ix_(kept, kept)
        return _inverse(self._regular_jacobian[rows_and_columns])

    def _regridded(self, x: FloatArray, grids: Mapping[str, Discretisation]) -> System:
        """The equations at x with all modes of the reference, on another grid."""
        discretisation = {}
        for name, reference in self.model.discretisation.items():
            discretisation[name] = replace(grids[name], modes=reference.modes)
        return self._system(discrete_scene(self.model.scene, self.model.inputs, discretisation), x)

    def _system(self, discrete: DiscreteScene, x: FloatArray | Matrix) -> System:
        """The equations of a discrete scene at unknowns x and the inputs of the reference."""
        # With numbers as arguments CasADi evaluates while it builds: one evaluation needs no function.
        return System(discrete, Arguments(ca.DM(x), ca.DM(self.reference.inputs)))

    @cached_property
    def _shapes(self) -> WatchedNumbers:
        """Poses of sections all along the rods of the reference."""
        positions = []
        quaternions = []
        for name in self.model.discrete.rods:
            pose = self.reference.pose(SAMPLES, name)
            positions.append(pose.position / self.model.length(name, self.reference.inputs))
            quaternions.append(pose.quaternion)
        return WatchedNumbers(np.concatenate(positions), np.concatenate(quaternions), np.zeros(0))


def _shapes_of(system: System) -> WatchedNumbers:
    """Poses of sections all along the rods of a system with numbers as arguments."""
    positions = []
    quaternions = []
    for name in system.discrete.rods:
        rod_positions, rod_quaternions = section_poses(system, name, SAMPLES)
        positions.append(rod_positions / system.length(name))
        quaternions.append(rod_quaternions)
    return WatchedNumbers(_numbers(ca.horzcat(*positions)).T, _numbers(ca.horzcat(*quaternions)).T, np.zeros(0))


def _tips_of(system: System) -> WatchedNumbers:
    """The watched numbers of a system with numbers as arguments."""
    return WatchedNumbers.of_column(_column(watched(system).column), len(watched_cables(system.discrete)))


def _inverse(matrix: FloatArray) -> FloatArray:
    """The inverse of a matrix, or the pseudo-inverse if it is singular."""
    try:
        inverse = np.linalg.inv(matrix)
    except np.linalg.LinAlgError:
        inverse = np.linalg.pinv(matrix)
    return np.asarray(inverse, dtype=np.float64)


def _numbers(matrix: Matrix) -> FloatArray:
    """Values of a matrix without symbols, whose terms from supports may be constant expressions."""
    return ca.evalf(ca.MX(matrix)).full()


def _column(vector: Matrix) -> FloatArray:
    """Values of a vector without symbols, shape (n,)."""
    return _numbers(vector).reshape(-1)


def _as_numbers(matrix: Matrix) -> ca.DM:
    """A matrix without symbols, whose terms from supports may be constant expressions, as numbers."""
    return ca.DM(_numbers(matrix))
