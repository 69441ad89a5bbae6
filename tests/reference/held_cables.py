"""A cable between two clamps or pins under its weight and wind, by collocation of the equations of the rod (SciPy).

Position, orientation (a quaternion), force and moment in the world are functions of arc length; nothing of the package
takes part.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_bvp
from scipy.spatial.transform import Rotation

from cosserat_casadi.maths.typing import FloatArray

ALONG_X = np.array([0.0, np.sqrt(0.5), 0.0, np.sqrt(0.5)])
"""Orientation of a section with tangent x, the shortest turn of z (x y z w)."""


@dataclass(frozen=True)
class HeldCable:
    """A round cable along x in a stream of air of density 1.225 kg/m³.

    Attributes:
        length: unstretched, m.
        distance: of its ends, m.
        bending, torsion, axial: stiffnesses, N m² and N.
        weight: N/m, along −z.
        wind: velocity, m/s.
        diameter: m.
        normal, tangential: coefficients of drag.
        pinned: whether the far end may turn.
    """

    length: float
    distance: float
    bending: float
    torsion: float
    axial: float
    weight: float
    wind: tuple[float, float, float] = (0.0, 0.0, 0.0)
    diameter: float = 0.02
    normal: float = 1.1
    tangential: float = 0.02
    pinned: bool = False

    def middle(self) -> FloatArray:
        """Position of the middle of the cable, m, shape (3,)."""
        s = self.length / 2 * (1 - np.cos(np.pi * np.linspace(0.0, 1.0, 200)))
        found = solve_bvp(self._rates, self._conditions, s, self._parabola(s), tol=1e-5, max_nodes=20_000)
        assert found.success, found.message
        return np.asarray(found.sol(self.length / 2)[:3])

    def _rates(self, _s: FloatArray, y: FloatArray) -> FloatArray:
        q, force, moment = y[3:7], y[7:10], y[10:13]
        axes = Rotation.from_quat(q.T).as_matrix()
        tangent = axes[:, :, 2].T
        stretched = (1 + (tangent * force).sum(0) / self.axial) * tangent
        in_section = np.einsum("kij,ik->jk", axes, moment)
        stiffness = np.array([[self.bending], [self.bending], [self.torsion]])
        turn = np.einsum("kij,jk->ik", axes, in_section / stiffness)
        turned = np.vstack([q[3] * turn + np.cross(turn, q[:3], axis=0), -(turn * q[:3]).sum(0)])
        return np.vstack([stretched, turned / 2, -self._load(tangent), -np.cross(stretched, force, axis=0)])

    def _load(self, tangent: FloatArray) -> FloatArray:
        stream = np.array(self.wind)[:, None] * np.ones_like(tangent)
        along = (stream * tangent).sum(0) * tangent
        across = stream - along
        of_normal = self.normal * np.linalg.norm(across, axis=0) * across
        of_tangential = np.pi * self.tangential * np.linalg.norm(stream, axis=0) * along
        load = 1.225 / 2 * self.diameter * (of_normal + of_tangential)
        load[2] -= self.weight
        return np.asarray(load)

    def _conditions(self, base: FloatArray, tip: FloatArray) -> FloatArray:
        # Vector part of the turn from the orientation that the clamp holds; zero moment at a pin.
        turn = (Rotation.from_quat(ALONG_X).inv() * Rotation.from_quat(tip[3:7])).as_quat()[:3]
        at_tip = tip[10:13] if self.pinned else turn
        return np.concatenate([base[:3], base[3:7] - ALONG_X, tip[:3] - [self.distance, 0.0, 0.0], at_tip])

    def _parabola(self, s: FloatArray) -> FloatArray:
        """First guess: the shape of a cable without bending stiffness that sags little, or is stretched."""
        x = s / self.length
        load = self._load(np.array([[1.0], [0.0], [0.0]]))[:, 0] * [0.0, 1.0, 1.0]
        size = float(np.linalg.norm(load))
        slack = self.length - self.distance
        if slack > 0:
            sag = np.sqrt(3 / 8 * self.distance * slack)
            tension = size * self.distance**2 / (8 * sag)
        else:
            tension = -self.axial * slack / self.length
            sag = size * self.distance**2 / (8 * tension)
        slope = 4 * sag * (1 - 2 * x) / self.distance
        downwards = load / size
        chord = np.array([1.0, 0.0, 0.0])
        positions = np.outer(chord, self.distance * x) + np.outer(downwards, 4 * sag * x * (1 - x))
        turns = Rotation.from_rotvec(np.outer(np.arctan(slope), np.cross(chord, downwards)))
        quaternions = (turns * Rotation.from_quat(ALONG_X)).as_quat().T
        forces = np.outer(tension * chord, np.ones_like(x)) + np.outer(load, self.length / 2 - s)
        return np.vstack([positions, quaternions, forces, np.zeros_like(positions)])
