"""Two tubes of one length that are curved all along: the angle between them is that of a pendulum.

With θ = α₂ − α₁, θ″ = c sin θ and θ′ = 0 at the tips. π − θ swings about zero, at rest at the tips: with k = cos(θ_L/2)
sin((π − θ)/2) = k cd(√c (L − s), k), Jacobi's elliptic function.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import ellipj

from cosserat_casadi import Scene, scene_from_dict

BENDING = (0.06, 0.03)
TORSION = (0.045, 0.024)
CURVATURE = (9.0, 15.0)

MOMENTS = np.array(BENDING) * CURVATURE
COUPLING = float(MOMENTS.prod() / sum(BENDING) * (1 / np.array(TORSION)).sum())
"""The number c, 1/m²."""


@dataclass(frozen=True)
class Pendulum:
    """Two tubes curved along L, with √c L = ``reach``, and lengths ``housing`` of each in the housing."""

    reach: float
    housing: tuple[float, float] = (0.0, 0.0)

    @property
    def length(self) -> float:
        return self.reach / float(np.sqrt(COUPLING))

    def scene(self, rotation: float, tolerance: float = 1e-9) -> Scene:
        tubes = [
            {
                "name": name,
                "stiffness": {"bending": BENDING[i], "torsion": TORSION[i]},
                "straight": self.housing[i],
                "curved": self.length,
                "curvature": CURVATURE[i],
                "rotation": (0.4, 0.4 + rotation)[i],
                "translation": self.length,
            }
            for i, name in enumerate(("outer", "inner"))
        ]
        return scene_from_dict({"schema": 1, "accuracy": {"tolerance": tolerance}, "tubes": tubes})

    def between_drives(self, between_tips: np.ndarray) -> np.ndarray:
        """Angle between the drives over that between the tips, rad, both less full turns of the tips."""
        turns = np.round(between_tips / (2 * np.pi))
        tips = between_tips - 2 * np.pi * turns
        sign = np.where(tips < 0, -1.0, 1.0)
        k = np.cos(np.abs(tips) / 2)
        sn, cn, dn, _ = ellipj(self.reach, k**2)
        at_plate = np.pi - 2 * np.arcsin(k * cn / dn)
        # cd′ = −(1 − k²) sn/dn² and 1 − k² cd² = (1 − k²)/dn²; towards the plate s falls.
        slope = -2 * k * np.sqrt(COUPLING * (1 - k**2)) * sn / dn
        torque = slope / (1 / np.array(TORSION)).sum()
        compliance = (np.array(self.housing) / TORSION).sum()
        return sign * (at_plate - compliance * torque) + 2 * np.pi * turns

    def opposed_determinant(self) -> float:
        """Derivative of the angle between the drives with that between the tips, where the tubes are opposed."""
        compliance = (np.array(self.housing) / TORSION).sum() / (1 / np.array(TORSION)).sum()
        return float(np.cos(self.reach) - compliance * np.sqrt(COUPLING) * np.sin(self.reach))
