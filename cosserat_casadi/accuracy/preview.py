"""Poses that a coarser discretisation would give, from a converged finer one and without building a model.

A fine solution, the reference, knows the equilibrium, its Jacobian, and by the order of its polynomials every coarser
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

from cosserat_casadi.accuracy.pose_change import rotation_vectors
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.maths.rotation import quaternion_product, quaternion_to_matrix
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.discrete_scene import DiscreteScene, discrete_scene
from cosserat_casadi.model.equations import Equations
from cosserat_casadi.model.registry import EFFECTS
from cosserat_casadi.model.system import Arguments, System
from cosserat_casadi.numerics.broyden import SINGULAR
from cosserat_casadi.rod.discretisation import Discretisation

Mask = npt.NDArray[np.bool_]
Modes = Mapping[str, tuple[int, ...]]
"""Modes of every admitted strain and element, for each rod."""

CORRECTIONS = 2
"""Corrections with the reference's Jacobian after dropping modes; each reduces the error by about the tail dropped."""

BETWEEN = (0.25, 0.5, 0.75, 1.0)
"""Sections at which a held rod is watched."""

SAMPLES = (1 - np.cos(np.pi * np.arange(257) / 256)) / 2
"""Sections at which a whole shape is watched or compared: several for each wave of the error of 60 modes."""


def watched(model: Model, rod: str) -> FloatArray:
    """Abscissae of the sections whose poses must be right to the tolerance, shape (k,)."""
    scene = model.scene
    if scene.accuracy.shape:
        return SAMPLES[1:]
    holders = (*scene.supports, *scene.joints)
    held = any(holder.rod == rod for holder in holders)
    if held:
        return np.array(BETWEEN)
    return np.array([1.0])


def watched_cables(model: Model) -> dict[str, float]:
    """Cables whose lengths must be right to the tolerance, with the lengths of their rods that it is relative to, m."""
    cables = {}
    for actuator in model.scene.actuators:
        if EFFECTS[actuator.kind].drawn_as == "cable":
            rod = model.discrete.rods[actuator.rod]
            cables[actuator.name] = rod.length
    return cables


def relative_cable_lengths(model: Model, x: FloatArray, inputs: FloatArray) -> FloatArray:
    """Lengths of the cables over those of their rods, shape (cables,)."""
    lengths = []
    for name, rod_length in watched_cables(model).items():
        _, cable_length, _ = model.actuator[name](x, inputs)
        lengths.append(float(cable_length) / rod_length)
    return np.array(lengths)


@dataclass(frozen=True)
class Watched:
    """What is watched of an equilibrium.

    Attributes:
        positions: of the watched sections of all rods, over the lengths of their rods, shape (k, 3).
        quaternions: world_Q_section, shape (k, 4).
        cables: lengths of cables over those of their rods, shape (c,).
    """

    positions: FloatArray
    quaternions: FloatArray
    cables: FloatArray

    def change_from(self, before: Watched) -> FloatArray:
        """How far each is from where it was, shape (2k + c, 3), as in :mod:`cosserat_casadi.accuracy.pose_change`."""
        displacements = self.positions - before.positions
        rotations = rotation_vectors(before.quaternions, self.quaternions)
        lengthening = np.zeros((len(self.cables), 3))
        lengthening[:, 0] = self.cables - before.cables
        return np.concatenate([displacements, rotations, lengthening])


@dataclass(frozen=True)
class FinerShift:
    """Changes by modes that a reference lacks, as in :mod:`cosserat_casadi.accuracy.pose_change`.

    Attributes:
        tips: of what is watched, shape (2k + c, 3).
        shapes: of sections all along the rods, those between the nodes of the reference included, shape (2s, 3).
    """

    tips: FloatArray
    shapes: FloatArray


@dataclass(frozen=True)
class Preview:
    """A reference solution that foresees what coarser discretisations would give.

    Attributes:
        reference: a converged solution.
    """

    reference: Solution
    _shifts: dict[tuple[tuple[str, tuple[int, ...]], ...], FloatArray] = field(default_factory=dict, repr=False)

    @property
    def model(self) -> Model:
        """The reference's model."""
        return self.reference.model

    @cached_property
    def jacobian(self) -> FloatArray:
        """Jacobian at the reference, shape (n, n)."""
        jacobian = self.model.path_jacobian(self.reference.x, self._inputs, 1.0)
        return _numbers(jacobian)

    @cached_property
    def _regular_jacobian(self) -> FloatArray:
        """The Jacobian with a stiffness against what symmetry leaves neutral, so that no correction moves along it."""
        left, singular, right = np.linalg.svd(self.jacobian)
        largest = float(singular.max(initial=0.0))
        neutral = singular <= SINGULAR * largest
        neutral_left = left[:, neutral]
        neutral_right = right[neutral]
        added = largest * neutral_left @ neutral_right
        return np.asarray(self.jacobian + added)

    @cached_property
    def tips(self) -> Watched:
        """What is watched of the reference."""
        return self._tips(self.reference.x)

    @property
    def no_shift(self) -> FloatArray:
        """The change of what is watched where nothing moves."""
        return self.tips.change_from(self.tips)

    def kept(self, modes: Modes) -> Mask:
        """Unknowns of the reference that exist with these modes, shape (n,); multipliers always do."""
        discrete = self.model.discrete
        mask = np.ones(self.model.size, dtype=bool)
        for name, discrete_rod in discrete.rods.items():
            first = discrete.unknowns.strain(name).start
            counts = zip(
                discrete_rod.columns.values(),
                discrete_rod.discretisation.modes,
                modes[name],
                strict=True,
            )
            for columns, available, kept_count in counts:
                # Polynomials are sorted by degree, element after element.
                kept = np.arange(available) < kept_count
                start = first + columns.start
                stop = first + columns.stop
                mask[start:stop] = np.tile(kept, discrete_rod.grid.elements)
        return mask

    def with_modes(self, modes: Modes) -> FloatArray:
        """Unknowns of the equilibrium with fewer modes on the reference's grid, shape (n,), zero where dropped."""
        kept = self.kept(modes)
        inverse = self._inverse_of_kept(kept)
        x = np.where(kept, self.reference.x, 0.0)
        # To first order the kept unknowns take over the residual that the dropped ones leave: J_kk δx_k = J_kd x_d.
        coupling = self.jacobian[np.ix_(kept, ~kept)]
        dropped = self.reference.x[~kept]
        x[kept] += inverse @ (coupling @ dropped)
        for _ in range(CORRECTIONS):
            residual = self.model.residual(x, self._inputs).full()
            x[kept] -= inverse @ residual[kept, 0]
        return x

    def mode_shift(self, modes: Modes) -> FloatArray:
        """Change of what is watched by having fewer modes, shape (2k + c, 3)."""
        key = tuple(modes.items())
        if key not in self._shifts:
            # Held rods of too few modes may have no equilibrium near: whatever comes out then is beyond all bounds.
            with np.errstate(all="ignore"):
                x = self.with_modes(modes)
                shift = self._tips(x).change_from(self.tips)
            finite = np.isfinite(shift)
            self._shifts[key] = np.where(finite, shift, np.inf)
        return self._shifts[key]

    def grid_shift(self, x: FloatArray, modes: Modes, grids: Mapping[str, Discretisation]) -> FloatArray:
        """Change of what is watched from the reference's grid to others, shape (2k + c, 3).

        Args:
            x: equilibrium with the given modes on the reference's grid, from :meth:`with_modes`.
            modes: modes of every rod.
            grids: nodes and transport of every rod; their modes are not read.
        """
        kept = self.kept(modes)
        regridded = self._regridded(x, grids)
        residual = _numbers(Equations(regridded).residual)[kept, 0]
        # One Newton step with the Jacobian of the reference's grid.
        corrected = x.copy()
        corrected[kept] -= self._inverse_of_kept(kept) @ residual
        # The unknowns move by far less than the tips can tell apart on two grids: the reference's grid serves.
        tips = self._tips(x)
        by_grid = self._tips_of(regridded).change_from(tips)
        by_unknowns = self._tips(corrected).change_from(tips)
        return by_grid + by_unknowns

    def finer_shift(self, grids: Mapping[str, Discretisation], sweeps: int) -> FinerShift:
        """Changes by modes that the reference lacks, on a grid that resolves them.

        Stiffness alone holds the short waves of the added modes, so that each gives way by what the balance lacks in
        it; the reference's Jacobian tells how all others follow. A few sweeps of both are Newton's corrections with
        the model of all these modes, but no such model is built.

        Args:
            grids: modes, nodes and transport of every rod; modes no fewer than the reference's.
            sweeps: number of times that added modes give way and all others follow; with 0 they give way and no other
                follows, which tells shapes but not tips.
        """
        model = self.model
        discrete = discrete_scene(model.scene, model.inputs, dict(grids))
        known = _known_unknowns(model.discrete, discrete)
        stiffness = _stiffness(discrete)[np.ix_(~known, ~known)]
        inverse = _inverse(self._regular_jacobian)

        def system(x: FloatArray) -> System:
            return System(discrete, Arguments(ca.DM(x), ca.DM(self._inputs)))

        x = np.zeros(discrete.unknowns.size)
        x[known] = self.reference.x
        current = system(x)
        # Of the tips the modes alone: what the grid does to them is a look of its own.
        tips = self._tips_of(current)
        for _ in range(max(sweeps, 1)):
            residual = _numbers(Equations(current).residual)[:, 0]
            x[~known] -= np.linalg.solve(stiffness, residual[~known])
            if sweeps > 0:
                residual = _numbers(Equations(system(x)).residual)[:, 0]
                x[known] -= inverse @ residual[known]
            current = system(x)
        return FinerShift(
            tips=self._tips_of(current).change_from(tips),
            shapes=self._shapes_of(current).change_from(self._shapes),
        )

    @property
    def _inputs(self) -> FloatArray:
        return self.reference.inputs

    def _inverse_of_kept(self, kept: Mask) -> FloatArray:
        rows_and_columns = np.ix_(kept, kept)
        return _inverse(self._regular_jacobian[rows_and_columns])

    def _regridded(self, x: FloatArray, grids: Mapping[str, Discretisation]) -> System:
        """The equations at x with all modes of the reference, on another grid."""
        discretisation = {}
        for name, reference in self.model.discretisation.items():
            discretisation[name] = replace(grids[name], modes=reference.modes)
        model = self.model
        discrete = discrete_scene(model.scene, model.inputs, discretisation)
        # Numbers for arguments: CasADi evaluates while it builds, so that no function is compiled for one look.
        arguments = Arguments(ca.DM(x), ca.DM(self._inputs))
        return System(discrete, arguments)

    def _tips(self, x: FloatArray) -> Watched:
        """What is watched, on the reference's grid, by the model's functions."""
        positions = []
        quaternions = []
        for name, discrete_rod in self.model.discrete.rods.items():
            X = watched(self.model, name)
            # The tip alone costs a fraction of all fields.
            if len(X) == 1:
                position, quaternion, _ = self.model.tip[name](x, self._inputs)
            else:
                fields = self.model.fields[name](x, self._inputs)
                interpolation = ca.DM(discrete_rod.grid.interpolation_matrix(X)).T
                position = fields[0] @ interpolation
                quaternion = fields[1] @ interpolation
            positions.append(_numbers(position).T / discrete_rod.properties.length)
            quaternions.append(_unit(quaternion))
        cables = relative_cable_lengths(self.model, x, self._inputs)
        return Watched(np.concatenate(positions), np.concatenate(quaternions), cables)

    @cached_property
    def _shapes(self) -> Watched:
        """Sections all along the rods of the reference, as its solution tells them."""
        positions = []
        quaternions = []
        for name, discrete_rod in self.model.discrete.rods.items():
            pose = self.reference.pose(SAMPLES, name)
            positions.append(pose.position / discrete_rod.properties.length)
            quaternions.append(pose.quaternion)
        return Watched(np.concatenate(positions), np.concatenate(quaternions), np.zeros(0))

    def _shapes_of(self, system: System) -> Watched:
        """Sections all along the rods of a system that has numbers for its arguments."""
        poses = [_poses_of(system, name, SAMPLES) for name in system.discrete.rods]
        positions, quaternions = zip(*poses, strict=True)
        return Watched(np.concatenate(positions), np.concatenate(quaternions), np.zeros(0))

    def _tips_of(self, system: System) -> Watched:
        """What is watched of a system that has numbers for its arguments."""
        poses = [_poses_of(system, name, watched(self.model, name)) for name in system.discrete.rods]
        positions, quaternions = zip(*poses, strict=True)
        cables = []
        for name, rod_length in watched_cables(self.model).items():
            _, cable_length, _ = system.actuators.state(name)
            cables.append(float(_numbers(cable_length)[0, 0]) / rod_length)
        return Watched(np.concatenate(positions), np.concatenate(quaternions), np.array(cables))


def _poses_of(system: System, rod: str, X: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Positions over the length and quaternions of k sections, shapes (k, 3) and (k, 4)."""
    discrete_rod = system.discrete.rods[rod]
    shape = system.shapes[rod]
    if len(X) == 1:
        # One section watched is the tip, which is a node.
        position = shape.position_at(-1)
        quaternion = shape.quaternion[:, -1]
    else:
        interpolation = ca.DM(discrete_rod.grid.interpolation_matrix(X)).T
        position = shape.position @ interpolation
        quaternion = shape.quaternion @ interpolation
    # The shape is that in the frame of the base section (docs/theory.md, section 1).
    base = system.base(rod)
    base_position = ca.repmat(base.position, 1, len(X))
    base_quaternion = ca.repmat(base.quaternion, 1, len(X))
    world_position = base_position + quaternion_to_matrix(base.quaternion) @ position
    world_quaternion = quaternion_product(base_quaternion, ca.densify(quaternion))
    return _numbers(world_position).T / discrete_rod.properties.length, _unit(world_quaternion)


def _known_unknowns(coarse: DiscreteScene, fine: DiscreteScene) -> Mask:
    """Which unknowns of a finer discretisation a coarser one has too: all but the strains of higher degree."""
    known = np.ones(fine.unknowns.size, dtype=bool)
    for name, fine_rod in fine.rods.items():
        first = fine.unknowns.strain(name).start
        counts = zip(fine_rod.columns.items(), coarse.rods[name].discretisation.modes, strict=True)
        for (component, columns), modes in counts:
            own = slice(first + columns.start, first + columns.stop)
            known[own] = fine_rod.degrees(component) < modes
    return known


def _stiffness(discrete: DiscreteScene) -> FloatArray:
    """Stiffness of all rods among all unknowns, zero for those that are no strains, shape (n, n)."""
    size = discrete.unknowns.size
    stiffness = np.zeros((size, size))
    for name, discrete_rod in discrete.rods.items():
        own = discrete.unknowns.strain(name)
        stiffness[own, own] = discrete_rod.stiffness
    return stiffness


def _unit(quaternion: Matrix) -> FloatArray:
    """Quaternions of k sections, from 4×k, shape (k, 4)."""
    quaternions = _numbers(quaternion).T
    # Interpolated quaternions are not of unit length.
    unit: FloatArray = quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True)
    return unit


def _inverse(matrix: FloatArray) -> FloatArray:
    """The inverse; of a singular matrix the pseudo-inverse."""
    try:
        inverse = np.linalg.inv(matrix)
    except np.linalg.LinAlgError:
        inverse = np.linalg.pinv(matrix)
    return np.asarray(inverse, dtype=np.float64)


def _numbers(matrix: Matrix) -> FloatArray:
    """Values of a matrix without symbols: what supports add is wrapped as an expression."""
    values: FloatArray = ca.evalf(ca.MX(matrix)).full()
    return values
