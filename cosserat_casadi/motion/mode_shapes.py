"""Displacements and rotations of sections of rods in a small motion δx, world axes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.numbers import known
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model

EQUAL = 1e-7
"""Relative difference below which eigenvalues belong to one cluster, whose shapes may be combined at will."""

REAL = 1e-7
"""Imaginary part, over the largest entry, below which all entries of a motion count as in phase."""

NumberArray = npt.NDArray[np.inexact]


@dataclass(frozen=True)
class RodShape:
    """Small displacements and rotations of k sections of a rod in p motions.

    Attributes:
        X: abscissae, shape (k,).
        position: displacement δr of the sections, world axes, shape (p, k, 3), m per unit of the motion.
        rotation: rotation vector δθ of the sections, world axes, shape (p, k, 3), rad per unit of the motion.
    """

    X: FloatArray
    position: NumberArray
    rotation: NumberArray


def rod_shape(
    model: Model, rod: str, x: FloatArray, inputs: FloatArray, motions: NumberArray, X: FloatArray
) -> RodShape:
    """Displacements and rotations of sections of a rod in small motions.

    Args:
        model: the scene.
        rod: name of the rod.
        x: unknowns about which the motions are small, shape (model.size,).
        inputs: stacked inputs.
        motions: motions δx as columns, shape (model.size, p).
        X: abscissae, shape (k,).
    """
    grid = model.discrete.rods[rod].grid
    quaternions, by_position, by_quaternion = model.field_jacobian[rod](x, inputs)
    count = motions.shape[1]
    displacement = (by_position.full() @ motions).T.reshape(count, grid.size, 3)
    turned = (by_quaternion.full() @ motions).T.reshape(count, grid.size, 4)
    rotation = _rotation_vectors(turned, quaternions.full().T)
    interpolation = grid.interpolation_matrix(X)
    return RodShape(X, interpolation @ displacement, interpolation @ rotation)


def _rotation_vectors(changes: NumberArray, quaternions: FloatArray) -> NumberArray:
    """Rotation vectors δθ = 2 vec(δQ ⊗ Q*) / Q·Q of changes δQ, shape (p, k, 4), of quaternions Q, shape (k, 4)."""
    scalar = quaternions[:, :1]
    vector = quaternions[:, 1:]
    scalar_change = changes[..., :1]
    vector_change = changes[..., 1:]
    product = scalar * vector_change - scalar_change * vector - np.cross(vector_change, vector)
    squared_norm = np.sum(quaternions**2, axis=1)[:, None]
    return np.asarray(2.0 * product / squared_norm)


def normalised(
    model: Model, x: FloatArray, inputs: FloatArray, values: NumberArray, motions: NumberArray
) -> NumberArray:
    """Scale motions and shift their phases so that they can be compared and drawn.

    The largest of all rotations, and displacements over the rod's length, becomes one. Motions of one eigenvalue may be
    combined at will; they are combined so that one moves most along x, the next along y, the rest along z.

    Args:
        model: the scene.
        x: unknowns about which the motions are small, shape (size,).
        inputs: stacked inputs.
        values: eigenvalues, shape (p,); equal ones are adjacent.
        motions: motions δx as columns, shape (size, p).

    Returns:
        the normalised motions, shape (size, p).
    """
    if not motions.shape[1]:
        return motions
    entries = _entries(model, x, inputs, motions)
    aligned = motions.astype(complex)
    for cluster in _clusters(values):
        phases = _in_phase(entries[:, cluster])
        shapes = entries[:, cluster] * phases
        in_phase = motions[:, cluster] * phases
        if len(cluster) > 1 and _is_real(shapes):
            in_phase = in_phase @ _directions(np.real(shapes))
        aligned[:, cluster] = in_phase
    entries = _entries(model, x, inputs, aligned)
    scaled = aligned * _in_phase(entries)
    # What is in phase but for rounding is real.
    small = REAL * np.abs(scaled).max(axis=0)
    in_phase = np.abs(scaled.imag).max(axis=0) <= small
    return np.where(in_phase, scaled.real, scaled)


def end_of_cluster(values: NumberArray, count: int | None) -> int:
    """Least number of eigenvalues, not below ``count``, that does not separate equal ones; all for None."""
    if count is None or count >= len(values):
        return len(values)
    for cluster in _clusters(values):
        end = cluster[-1] + 1
        if end >= count:
            return end
    return len(values)


def _entries(model: Model, x: FloatArray, inputs: FloatArray, motions: NumberArray) -> NumberArray:
    """Displacements over length, and rotations, of all rods at their nodes; columns are motions.

    Displacements of all rods along x come first, then along y and along z, then the rotations.
    """
    displacements = []
    rotations = []
    for name, discrete_rod in model.discrete.rods.items():
        shape = rod_shape(model, name, x, inputs, motions, known(discrete_rod.grid.nodes))
        displacements.append(shape.position / discrete_rod.properties.length)
        rotations.append(shape.rotation)
    parts = [np.concatenate(displacements, axis=1), np.concatenate(rotations, axis=1)]
    columns = [np.moveaxis(part, 2, 1).reshape(len(part), -1).T for part in parts]
    return np.vstack(columns)


def _clusters(values: NumberArray) -> list[list[int]]:
    """Group the indices of equal eigenvalues into clusters."""
    clusters: list[list[int]] = []
    for index, value in enumerate(values):
        if clusters and abs(value - values[clusters[-1][0]]) <= EQUAL * abs(value):
            clusters[-1].append(index)
        else:
            clusters.append([index])
    return clusters


def _in_phase(entries: NumberArray) -> NumberArray:
    """Complex factors that make the largest entry of each column one, shape (p,)."""
    largest = np.argmax(np.abs(entries), axis=0)
    factors = entries[largest, np.arange(entries.shape[1])]
    moving = np.abs(factors) > 0.0
    return np.where(moving, 1.0 / np.where(moving, factors, 1.0), 1.0)


def _is_real(entries: NumberArray) -> bool:
    return bool(np.abs(entries.imag).max() <= REAL * np.abs(entries).max())


def _directions(shapes: FloatArray) -> FloatArray:
    """Matrix that combines p shapes by direction, shape (p, p): the first along x, the next along y, then the rest."""
    part = len(shapes) // 6
    # The first axis counts most, so that it is settled before the others; what bends towards x turns about y.
    weights = np.repeat([4.0, 2.0, 1.0, 0.25, 0.5, 0.125], part)
    orthonormal, triangle = np.linalg.qr(shapes)
    _, _, rows = np.linalg.svd(weights[:, None] * orthonormal)
    return np.asarray(np.linalg.solve(triangle, rows.T))
