"""A free Reissner rod that is kicked at its tip, by another formulation and another method than those of the package.

Unknown are velocities and strains in the axes of the sections, for which the equations are hyperbolic with constant
speeds of waves (D. H. Hodges, AIAA Journal 41, 2003). In space they are solved by a discontinuous Galerkin method with
upwind fluxes, which has no fronts to resolve but those that cross its cells; in time by the method of Runge and Kutta.
Poses of both ends follow from their velocities.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from sys import path

import numpy as np
from numpy.polynomial import legendre
from scipy.spatial.transform import Rotation

path.insert(0, str(Path(__file__).parents[1]))

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.tip_paths import Paths

LENGTH = 0.5
RADIUS = 0.02
YOUNGS_MODULUS = 1e6
SHEAR_MODULUS = YOUNGS_MODULUS / 3.0
DENSITY = 1000.0
FORCE = np.array([2.0, 1.0, -0.5])
MOMENT = np.array([0.0, 0.15, 0.1])
KICK = 0.1
"""Time at which force and moment, which fall linearly, have vanished, s."""
DURATION = 0.5
BASE = np.array([0.85065080835204, 0.0, 0.5257311121191336, 0.0])
"""Quaternion of the base, the real part first, as in flying.toml of the reference cases."""

AREA = np.pi * RADIUS**2
BENDING = np.pi * RADIUS**4 / 4.0
STIFFNESS = np.array(
    [SHEAR_MODULUS * AREA] * 2
    + [YOUNGS_MODULUS * AREA]
    + [YOUNGS_MODULUS * BENDING] * 2
    + [SHEAR_MODULUS * 2.0 * BENDING]
)
INERTIA = DENSITY * np.array([AREA] * 3 + [BENDING] * 2 + [2.0 * BENDING])
"""Mass and rotary inertia per length."""

COURANT = 0.9
"""Step of time over that in which the fastest wave passes a node, about."""


@dataclass(frozen=True)
class KickedRod:
    """The rod on cells of one length.

    Velocities (linear, then angular), strains (without those of the unloaded rod) and stresses have the shape
    (6, degree + 1, cells), at Gauss's nodes of the cells.

    Attributes:
        cells: their number.
        degree: of the polynomials in them.
    """

    cells: int
    degree: int

    @cached_property
    def _tables(self) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
        """Derivatives at the nodes, values at both ends, and what a flux at an end adds at the nodes."""
        nodes, weights = legendre.leggauss(self.degree + 1)
        inverse = np.linalg.inv(legendre.legvander(nodes, self.degree))
        half = LENGTH / self.cells / 2.0
        unit = np.eye(self.degree + 1)
        slopes = np.stack([legendre.legval(nodes, legendre.legder(row)) for row in unit], axis=1)
        left, right = (legendre.legvander(np.array([end]), self.degree)[0] @ inverse for end in (-1.0, 1.0))
        lift = (left / weights / half)[:, None], (right / weights / half)[:, None]
        return slopes @ inverse / half, left, right, *lift

    def rates(self, time: float, state: list[FloatArray]) -> list[FloatArray]:
        """Rates of velocities, of strains, and of position and quaternion of tip and base, shape (2, 7)."""
        velocities, strains, poses = state
        derivative, left, right, lift_left, lift_right = self._tables
        stresses = STIFFNESS[:, None, None] * strains
        share = max(1.0 - time / KICK, 0.0)
        turned = Rotation.from_quat(poses[:, 3:], scalar_first=True)
        to_tip = turned[0].inv()
        at_tip = share * np.concatenate([to_tip.apply(FORCE), to_tip.apply(MOMENT)])
        ends = [np.einsum("i,cik->ck", end, field) for field in (velocities, stresses) for end in (left, right)]
        v_left, v_right, n_left, n_right = ends
        v, n = np.empty((2, 6, self.cells + 1))
        impedance = np.sqrt(STIFFNESS * INERTIA)
        between = impedance[:, None]
        v[:, 1:-1] = 0.5 * (v_right[:, :-1] + v_left[:, 1:] + (n_left[:, 1:] - n_right[:, :-1]) / between)
        n[:, 1:-1] = 0.5 * (n_right[:, :-1] + n_left[:, 1:] + (v_left[:, 1:] - v_right[:, :-1]) * between)
        n[:, 0], n[:, -1] = 0.0, at_tip
        v[:, 0] = v_left[:, 0] + n_left[:, 0] / impedance
        v[:, -1] = v_right[:, -1] + (at_tip - n_right[:, -1]) / impedance

        def along(field: FloatArray, at_left: FloatArray, at_right: FloatArray, flux: FloatArray) -> FloatArray:
            jumps = lift_right * (flux[:, 1:] - at_right)[:, None] - lift_left * (flux[:, :-1] - at_left)[:, None]
            return np.asarray(derivative @ field + jumps)

        balance = along(stresses, n_left, n_right, n)
        compatible = along(velocities, v_left, v_right, v)
        linear, angular = velocities[:3], velocities[3:]
        force, moment, curvature = stresses[:3], stresses[3:], strains[3:]
        tangent = strains[:3] + np.array([0.0, 0.0, 1.0])[:, None, None]
        mass, rotary = INERTIA[:3, None, None], INERTIA[3:, None, None]
        balance[:3] += _cross(curvature, force) - _cross(angular, mass * linear)
        balance[3:] += _cross(curvature, moment) + _cross(tangent, force) - _cross(angular, rotary * angular)
        compatible[:3] += _cross(curvature, linear) - _cross(angular, tangent)
        compatible[3:] += _cross(curvature, angular)
        moved = np.zeros((2, 7))
        for pose, frame, at, rate in zip(poses, turned, (v[:, -1], v[:, 0]), moved, strict=True):
            rate[:3] = frame.apply(at[:3])
            real, imaginary = pose[3], pose[4:]
            rate[3] = -0.5 * imaginary @ at[3:]
            rate[4:] = 0.5 * (real * at[3:] + np.cross(imaginary, at[3:]))
        return [balance / INERTIA[:, None, None], compatible, moved]

    def paths(self, times: int) -> Paths:
        """Tip and base at evenly spaced times from 0 to the end, as motions are compared."""
        tangent = Rotation.from_quat(BASE, scalar_first=True).apply([0.0, 0.0, 1.0])
        poses = np.stack([np.concatenate([place, BASE]) for place in (LENGTH * tangent, np.zeros(3))])
        state = [np.zeros((6, self.degree + 1, self.cells)) for _ in range(2)] + [poses]
        interval = DURATION / (times - 1)
        fastest = np.sqrt(YOUNGS_MODULUS / DENSITY)
        steps = int(np.ceil(interval / (COURANT * LENGTH / self.cells / fastest / (2 * self.degree + 1))))
        size = interval / steps
        rows = [poses]
        for number in range((times - 1) * steps):
            state = self._stepped(number * size, size, state)
            if (number + 1) % steps == 0:
                rows.append(state[2])
        found = np.stack(rows)
        rotation = Rotation.from_quat(found[:, 0, 3:], scalar_first=True).as_matrix()
        return Paths(found[:, :, :3] / LENGTH, rotation.swapaxes(1, 2)[:, None, :2])

    def _stepped(self, time: float, size: float, state: list[FloatArray]) -> list[FloatArray]:
        first = self.rates(time, state)
        second = self.rates(time + size / 2, _moved(state, size / 2, first))
        third = self.rates(time + size / 2, _moved(state, size / 2, second))
        last = self.rates(time + size, _moved(state, size, third))
        mean = [(a + 2 * b + 2 * c + d) / 6 for a, b, c, d in zip(first, second, third, last, strict=True)]
        return _moved(state, size, mean)


def _moved(state: list[FloatArray], size: float, rates: list[FloatArray]) -> list[FloatArray]:
    return [value + size * rate for value, rate in zip(state, rates, strict=True)]


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Cross products of vectors along the first axis."""
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])
