"""Answers that are known without integration.

A pose is (position, rotation). Unless said otherwise it is the tip's in the frame of the base: the straight rod runs
along z, a positive moment about y bends it towards +x.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import expm
from scipy.optimize import brentq
from scipy.special import ellipe, ellipeinc, ellipk, ellipkinc

from tests.reference.rods import hat

Array = NDArray[np.float64]
Pose = tuple[Array, Array]

MATTIASSON_1981 = {
    1: (0.05643, 0.30172, 0.46135),
    2: (0.16064, 0.49346, 0.78175),
    3: (0.25442, 0.60325, 0.98602),
    4: (0.32894, 0.66996, 1.12124),
    5: (0.38763, 0.71379, 1.21537),
    6: (0.43459, 0.74457, 1.28370),
    7: (0.47293, 0.76737, 1.33496),
    8: (0.50483, 0.78498, 1.37443),
    9: (0.53182, 0.79906, 1.40547),
    10: (0.55500, 0.81061, 1.43029),
}
"""F L²/EI ↦ axial displacement u/L, transverse deflection w/L and tip angle of the cantilever, five decimals."""


def roll_up(turns: float, length: float = 1.0) -> Pose:
    """Tip of a straight rod that the tip moment 2π turns EI/L about y rolls up."""
    angle = 2 * np.pi * turns
    cosine, sine = np.cos(angle), np.sin(angle)
    rotation = np.array([[cosine, 0, sine], [0, 1, 0], [-sine, 0, cosine]])
    return length * np.array([(1 - cosine) / angle, 0, sine / angle]), rotation


def constant_strain(strain: ArrayLike, length: float) -> Pose:
    """Tip of a rod whose strain [K; Γ] is the same everywhere: the exponential of SE(3), a helix."""
    k, g = np.split(np.asarray(strain, dtype=float), 2)
    generator = np.zeros((4, 4))
    generator[:3, :3], generator[:3, 3] = hat(k), g
    pose = expm(length * generator)
    return pose[:3, 3], pose[:3, :3]


def dead_moment(moment: ArrayLike, bending: float, torsion: float, length: float, base_rotation: Array) -> Pose:
    """Tip, relative to the base point in world axes, of a straight isotropic rod under a dead tip moment m.

    m is the same in every section. R(s) = exp(s m/EI) R₀ exp(s c z) has the body rate Rᵀm/EI + c z, which is
    (M_x/EI, M_y/EI, M_z/GJ) for c = M_z (1/GJ − 1/EI), and M_z = m·R z stays m·R₀ z. The tangent exp(s m/EI) R₀ z is
    integrated in closed form.
    """
    m, z = np.asarray(moment, dtype=float), np.array([0.0, 0.0, 1.0])
    tangent = base_rotation @ z
    twist = (m @ tangent) * (1 / torsion - 1 / bending)
    turned, spun = expm(hat(m) * length / bending), expm(hat(z) * twist * length)
    angle, axis = np.linalg.norm(m) * length / bending, hat(m / np.linalg.norm(m))
    mean = np.eye(3) + (1 - np.cos(angle)) / angle * axis + (1 - np.sin(angle) / angle) * axis @ axis
    return length * mean @ tangent, turned @ base_rotation @ spun


def stretch(force: float, axial: float, length: float) -> float:
    """Elongation under an axial tip force; axial is EA."""
    return force * length / axial


def tapered_stretch(force: float, axial: tuple[float, float], length: float) -> float:
    """Elongation when EA goes linearly from base to tip."""
    start, end = axial
    return force * length * np.log(end / start) / (end - start)


def twist(moment: float, torsion: float, length: float) -> float:
    """Angle of the tip under a twisting tip moment; torsion is GJ."""
    return moment * length / torsion


def cone_twist(moment: float, shear_modulus: float, radii: tuple[float, float], length: float) -> float:
    """Angle of the tip of a solid cone under a twisting tip moment."""
    start, end = radii
    flexibility = (1 / end**3 - 1 / start**3) / (3 * (start - end))
    return 2 * moment * length / (np.pi * shear_modulus) * flexibility


def small_deflection(force: float, bending: float, length: float) -> float:
    """Tip deflection of a cantilever under a small transverse tip force."""
    return force * length**3 / (3 * bending)


def elastica(alpha: float) -> tuple[float, float, float]:
    """Inextensible cantilever under a dead transverse tip force, α = F L²/EI.

    With θ the tip angle and p² = (1 + sin θ)/2, sin φ = 1/(p√2): √α = K(p) − F(φ, p), the tip lies at √(2 sin θ/α) L
    along the clamp and has moved 1 − 2 (E(p) − E(φ, p))/√α sideways.

    Returns:
        axial displacement u/L towards the clamp, transverse deflection w/L, tip angle.
    """

    def excess(square: float) -> float:
        return float(ellipk(square) - ellipkinc(_amplitude(square), square) - np.sqrt(alpha))

    square = brentq(excess, 0.5, 1 - 1e-15, xtol=1e-16)
    sine = 2 * square - 1
    arc = ellipe(square) - ellipeinc(_amplitude(square), square)
    return 1 - np.sqrt(2 * sine / alpha), float(1 - 2 * arc / np.sqrt(alpha)), float(np.arcsin(sine))


def _amplitude(square: float) -> float:
    return float(np.arcsin(min(1.0, 1 / np.sqrt(2 * square))))
