"""Measured frequencies and damping ratios of small vibrations about the equilibrium, with exact derivatives.

A mode is λ with (λ² M + λ C + K) z = 0 = l (λ² M + λ C + K), and changes by dλ = −l (λ² dM + λ dC + dK) z for vectors
scaled to l (2λ M + C) z = 1 (P. Lancaster, *Numerische Mathematik* 6 (1964) 377–387). A single one of r modes with
equal λ, such as the two bending modes of a round rod, has no derivative. Their mean has one: the trace, over r, of the
r×r matrix of these numbers. All r measured modes are compared with this mean.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.errors import refuse
from cosserat_casadi.identification.measured_cases import Datum
from cosserat_casadi.identification.measured_quantities import QUANTITIES
from cosserat_casadi.maths.grid import Indices
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.eigenproblem import ComplexArray, eigenpairs
from cosserat_casadi.motion.motion_checks import immovable
from cosserat_casadi.motion.small_motions import SmallMotions
from cosserat_casadi.motion.vibration_modes import small_motions
from cosserat_casadi.scene.measurements import ModeMeasurement

ONE_FREQUENCY = 1e-6
"""Distance of two eigenvalues, over their size, up to which they count as equal; rounding splits them by less."""

PARTED = 1e-6
"""Separation of equal eigenvalues, over their size, by a change of an unknown by its size, above which it counts."""


@dataclass(frozen=True)
class ModeCluster:
    """Modes with equal eigenvalues.

    Attributes:
        value: λ, the mean of the eigenvalues of these modes, 1/s.
        first: index of the first of these modes among the oscillating modes, from 1 on.
        right: right eigenvectors z in all unknowns, as columns, shape (size, r).
        left: left eigenvectors l, as rows, with l (2λ M + C) z = 1, shape (r, size).
    """

    value: complex
    first: int
    right: ComplexArray
    left: ComplexArray

    @property
    def count(self) -> int:
        """Number r of modes."""
        return int(self.right.shape[1])

    @property
    def numbers(self) -> range:
        """Indices of these modes among the oscillating modes, from 1 on."""
        return range(self.first, self.first + self.count)


class Vibrations:
    """The modes of a model about equilibria, and their derivatives.

    Attributes:
        model: model with its parameters; of rods if vibrations were measured.
    """

    def __init__(self, model: Any) -> None:
        self.model = model
        self._slope: ca.Function | None = None

    def clusters(
        self, x: FloatArray, inputs: FloatArray, p: FloatArray, numbers: Sequence[int]
    ) -> dict[int, ModeCluster]:
        """Find the modes of some indices, each with all modes of its eigenvalue; only oscillating modes are kept.

        Args:
            x: unknowns of an equilibrium, shape (size,).
            inputs: stacked inputs.
            p: stacked parameters.
            numbers: indices among the oscillating modes, from 1 on.

        Returns:
            the clusters by the indices of their modes.
        """
        motions = small_motions(self.model, x, inputs, p=p if self.model.parameters.size else None)
        if not np.any(motions.free_mass):
            return {}
        conservative = self.model.has_potential(inputs)
        pairs = eigenpairs(motions.free_stiffness, motions.free_damping, motions.free_mass, conservative=conservative)
        swinging = pairs.values[pairs.values.imag > 0.0]
        found: dict[int, ModeCluster] = {}
        for number in numbers:
            if number in found or number > len(swinging):
                continue
            cluster = _cluster(motions, swinging, number - 1)
            found.update(dict.fromkeys(cluster.numbers, cluster))
        return found

    def derivatives(self, cluster: ModeCluster, x: FloatArray, inputs: FloatArray, p: FloatArray) -> ComplexArray:
        """Matrices −l_i (λ² dM + λ dC + dK) z_j by x, inputs and p, stacked, shape (r, r, arguments), 1/s."""
        function = self._slope_function()
        given = [x, inputs, p] if self.model.parameters.size else [x, inputs]
        count = cluster.count
        matrices = np.empty((count, count, self._arguments), dtype=complex)
        for i, left in enumerate(cluster.left):
            for j, right in enumerate(cluster.right.T):
                by_rates = right * cluster.value
                moved = np.concatenate([right, by_rates, by_rates * cluster.value])
                parts = [left.real, left.imag, moved.real, moved.imag]
                real, imaginary = (slope.full()[:, 0] for slope in function(*given, *parts))
                matrices[i, j] = -(real + 1j * imaginary)
        return matrices

    @property
    def _arguments(self) -> int:
        sizes = self.model.size, self.model.inputs.size, self.model.parameters.size
        return int(sum(sizes))

    def _slope_function(self) -> ca.Function:
        """(x, inputs, p, l, (z, λz, λ²z)) ↦ derivatives of l (λ² M + λ C + K) z by x, inputs and p.

        Real and imaginary parts of l and of the motion are side by side. The sum of matrices is the derivative of the
        residual along the motion, so that no matrix is formed.
        """
        if self._slope is not None:
            return self._slope
        model = self.model.in_motion
        size = model.size
        x = ca.MX.sym("x", self.model.size)
        inputs = ca.MX.sym("inputs", model.inputs.size)
        given = [x, inputs]
        between = []
        if model.parameters.size:
            between.append(ca.MX.sym("p", model.parameters.size))
            given += between
        state = ca.MX.sym("state", 3 * size)
        still = ca.DM.zeros(model.inputs.size, 1)
        split = ca.vertsplit(state, size)
        residual = model.inverse_dynamics(*split, inputs, *between, still, still)
        change = ca.MX.sym("change", 3 * size)
        along = ca.Function("along", [state, *given[1:], change], [ca.jtimes(residual, state, change)])
        at_rest = ca.vertcat(x, ca.DM.zeros(3 * size - self.model.size, 1))

        left = [ca.MX.sym(f"left_{part}", size) for part in ("real", "imaginary")]
        moved = [ca.MX.sym(f"moved_{part}", 3 * size) for part in ("real", "imaginary")]
        real, imaginary = (along(at_rest, *given[1:], part) for part in moved)
        products = [
            ca.dot(left[0], real) - ca.dot(left[1], imaginary),
            ca.dot(left[0], imaginary) + ca.dot(left[1], real),
        ]
        slopes = [ca.vertcat(*(ca.densify(ca.gradient(product, by)) for by in given)) for product in products]
        self._slope = ca.Function("slope", [*given, *left, *moved], slopes)
        return self._slope


def _cluster(motions: SmallMotions, swinging: ComplexArray, index: int) -> ModeCluster:
    """Find the modes with the eigenvalue of a given mode.

    Args:
        motions: the equations.
        swinging: eigenvalues with positive imaginary part, by size.
        index: index of the given mode.
    """
    alike = np.abs(swinging - swinging[index]) <= ONE_FREQUENCY * abs(swinging[index])
    chosen = np.flatnonzero(alike)
    value = complex(np.mean(swinging[chosen]))
    count = len(chosen)
    free = _pencil(motions.free_stiffness, motions.free_damping, motions.free_mass, value)
    left_free, _, right_free = np.linalg.svd(free)
    moving = motions.moving
    algebraic = motions.algebraic
    whole = _pencil(motions.stiffness, motions.damping, motions.mass, value)
    right = np.asarray(motions.displacement(right_free[-count:].conj().T), dtype=complex)
    left = np.zeros_like(right)
    left[moving] = motions.roots[:, None] * (motions.basis @ left_free[:, -count:].conj())
    if algebraic.size:
        # Multipliers and tensions follow from the rows of the coordinates, and the other way round on the left.
        pull = whole[np.ix_(moving, algebraic)]
        gradients = whole[np.ix_(algebraic, moving)].T
        inside = whole[np.ix_(moving, moving)]
        right[algebraic] = -np.linalg.lstsq(pull, inside @ right[moving], rcond=None)[0]
        left[algebraic] = -np.linalg.lstsq(gradients, inside.T @ left[moving], rcond=None)[0]
    slope = 2.0 * value * motions.mass + motions.damping
    normalised = np.linalg.solve(left.T @ slope @ right, left.T)
    for branch in motions.branches:
        # Rows of the branches were integrated, and subtracted from the rows of the strains.
        rows = normalised[:, branch.flows] - normalised[:, branch.strains]
        normalised[:, branch.flows] = rows @ branch.spring / value
    return ModeCluster(value, int(chosen[0]) + 1, right, normalised)


def _pencil(stiffness: FloatArray, damping: FloatArray, mass: FloatArray, value: complex) -> ComplexArray:
    return np.asarray(value**2 * mass + value * damping + stiffness)


@dataclass(frozen=True)
class JointModes:
    """Modes of one frequency, whose mean is compared with the measurements.

    Attributes:
        case: index of their case.
        numbers: indices of the modes.
        parted: mask of the unknowns that would separate them, shape (n,).
    """

    case: int
    numbers: range
    parted: npt.NDArray[np.bool_]


class MeasuredModes:
    """All rows of one measurement of frequencies or damping ratios.

    Attributes:
        record: the measurement.
        cases: the cases that have such rows, shape (count,).
        data: these rows, in the order of the residuals, each with the index of its entry.
        row_cases: case of each row.
        places: index of each row's case among the cases that have rows, shape (rows,).
        sigma: standard deviation of each entry.
    """

    def __init__(self, vibrations: Vibrations, record: Any, rows: Sequence[tuple[int, list[Datum]]]) -> None:
        self.record = record
        self.cases: Indices = np.array([case for case, _ in rows], dtype=np.int64)
        self.data = [(datum, 0) for _, data in rows for datum in data]
        self.row_cases = [case for case, data in rows for _ in data]
        self.places: Indices = np.array([i for i, (_, data) in enumerate(rows) for _ in data], dtype=np.int64)
        self.sigma = np.array([np.max(record.sigma)])
        self._vibrations = vibrations
        self._quantity = QUANTITIES[record.quantity]
        self._measured = np.array([datum.values[0] for datum, _ in self.data])
        self._numbers = [[int(datum.at) for datum in data] for _, data in rows]

    def residual(self, x: FloatArray, inputs: FloatArray, p: FloatArray) -> FloatArray:
        """Differences in standard deviations, shape (rows,); NaN for modes that do not oscillate.

        Args:
            x: unknowns of each case, shape (count, size).
            inputs: theirs, shape (count, size of the inputs).
            p: parameters.
        """
        modelled = []
        for i, numbers in enumerate(self._numbers):
            found = self._vibrations.clusters(x[i], inputs[i], p, numbers)
            modelled += [self._quantity.value(found[number].value) if number in found else np.nan for number in numbers]
        return np.asarray((np.array(modelled) - self._measured) / self.sigma)

    def derivatives(
        self, x: FloatArray, inputs: FloatArray, p: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Derivatives of the residual by x, inputs and p of its case, (rows, …) each."""
        rows = []
        for i, numbers in enumerate(self._numbers):
            found = self._vibrations.clusters(x[i], inputs[i], p, numbers)
            slopes: dict[int, FloatArray] = {}
            for number in numbers:
                cluster = found[number]
                if cluster.first not in slopes:
                    matrices = self._vibrations.derivatives(cluster, x[i], inputs[i], p)
                    of_mean = np.trace(matrices) / cluster.count
                    slopes[cluster.first] = self._quantity.slope(cluster.value, of_mean)
                rows.append(slopes[cluster.first])
        stacked = np.array(rows) / self.sigma
        ends = np.cumsum([x.shape[1], inputs.shape[1]])
        by_x, by_inputs, by_p = np.split(stacked, ends, axis=1)
        return by_x, by_inputs, by_p

    def joint_modes(
        self, x: FloatArray, inputs: FloatArray, p: FloatArray, by_unknowns: FloatArray, sizes: FloatArray
    ) -> list[JointModes]:
        """Measured modes of equal frequency, case by case.

        Args:
            x: unknowns of each case, shape (count, size).
            inputs: theirs, shape (count, size of the inputs).
            p: parameters.
            by_unknowns: derivatives of (x, inputs, p) of each case by the unknowns, shape (count, arguments, n).
            sizes: sizes of the unknowns, shape (n,).
        """
        joint = []
        for i, numbers in enumerate(self._numbers):
            found = self._vibrations.clusters(x[i], inputs[i], p, numbers)
            for cluster in {cluster.first: cluster for cluster in found.values()}.values():
                if cluster.count == 1:
                    continue
                matrices = self._vibrations.derivatives(cluster, x[i], inputs[i], p) @ (by_unknowns[i] * sizes)
                alike = np.trace(matrices) / cluster.count
                parting = matrices - np.eye(cluster.count)[:, :, None] * alike
                largest = np.abs(parting).max(axis=(0, 1))
                joint.append(JointModes(int(self.cases[i]), cluster.numbers, largest > PARTED * abs(cluster.value)))
        return joint


def check_vibrations(model: Model) -> None:
    """Refuse measured vibrations of rods without mass.

    Raises:
        SceneError: vibrations were measured, but a rod has no mass.
    """
    if any(isinstance(record, ModeMeasurement) for record in model.scene.measurements):
        refuse(immovable(model.at()))
