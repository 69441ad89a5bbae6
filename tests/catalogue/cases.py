"""Scenes of the catalogue of hard cases, as tables of a scene file, and answers that do not come from the package."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

Table = dict[str, Any]
Array = NDArray[np.float64]

EULER = np.pi**2 / 4
"""Buckling load of a clamped–free column, EI/L²."""


def table(rod: Table, *loads: Table, **changes: Any) -> Table:
    """A scene of one rod called "rod" under these loads."""
    plain = {"name": "rod", "length": 1.0, "strain": "planar", "stiffness": {"bending_y": 1.0}}
    return {"schema": 1, "rods": [{**plain, **rod}], "loads": list(loads), **changes}


def tip(force: Any = (0.0, 0.0, 0.0), moment: Any = (0.0, 0.0, 0.0), **changes: Any) -> Table:
    """A wrench at the tip, called "tip"."""
    wrench = {"force": [float(f) for f in force], "moment": [float(m) for m in moment]}
    return {"name": "tip", "kind": "tip_wrench", "rod": "rod", **wrench, **changes}


def clamp(position: Any, angle: float = 0.0) -> Table:
    """The tip held at a position, turned about y by an angle."""
    quaternion = [float(np.cos(angle / 2)), 0.0, float(np.sin(angle / 2)), 0.0]
    return {"rod": "rod", "kind": "clamped", "position": [float(p) for p in position], "quaternion": quaternion}


def round_rod(torsion: float = 0.8, **others: float) -> Table:
    """A rod of equal bending stiffnesses EI = 1 and length 1; others are shear and extension."""
    sizes = {"bending_x": 1.0, "bending_y": 1.0, "torsion": torsion, **others}
    return {"strain": list(sizes), "stiffness": sizes}


# (a) – (c) Large rotations


HELIX = {"strain": "reissner", "length": 10.0, "stiffness": dict.fromkeys(["bending_x", "bending_y", "torsion"], 100.0)}
HELIX["stiffness"] |= dict.fromkeys(["shear_x", "shear_y", "extension"], 1e4)


def helical_form(share: float, **changes: Any) -> Table:
    """A. Ibrahimbegović, Comput. Methods Appl. Mech. Engng 149 (1997) 49: ten turns under a moment and a force.

    The rod lies along z; the tip moment 200π about y would roll it up in the plane x–z, the force 50 along y draws the
    circles apart. Both are dead and grow together.
    """
    wrench = tip(force=[0, 50 * share, 0], moment=[0, 200 * np.pi * share, 0])
    return table(HELIX, wrench, **changes)


def follower_cantilever(load: float) -> Array:
    """Tip of an inextensible cantilever under a follower force across its tip, in lengths: sideways and along.

    From the tip back, s = L − s*, the angle ψ to the tip's tangent obeys the pendulum ψ'' = α cos ψ, ψ(0) = ψ'(0) = 0,
    which is an initial-value problem: no search for the clamp's moment.
    """

    def rate(_: float, state: Array) -> list[float]:
        return [state[1], load * np.cos(state[0]), np.sin(state[0]), np.cos(state[0])]

    angle, _, across, along = solve_ivp(rate, (0, 1), np.zeros(4), "DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
    # Seen from the tip the rod runs back to the clamp; turned so that the clamp points along z.
    c, s = np.cos(angle), np.sin(angle)
    return np.array([s * along - c * across, c * along + s * across])


# (d), (e) Columns and the arch


def column_tip(ratio: float) -> tuple[float, float]:
    """Tip of the buckled column at P = ratio · P_c, in lengths, sideways and up: elliptic integrals.

    S. P. Timoshenko, J. M. Gere, *Theory of Elastic Stability*, 2nd ed., McGraw-Hill 1961, section 2.7.
    """
    k = brentq(lambda k: ellipk(k**2) - np.pi / 2 * np.sqrt(ratio), 1e-6, 1 - 1e-14, xtol=1e-16)
    return 2 * k / ellipk(k**2), 2 * ellipe(k**2) / ellipk(k**2) - 1


# (f) Rods held at both ends


HELD: dict[str, tuple[tuple[float, float, float], float]] = {
    "shortened by 0.3 L, ends askew": ((0.0, 0.0, 0.7), 0.4),
    "U shape": ((0.3, 0.0, 0.0), np.pi),
    "end turned by 3π/2": ((0.3, 0.0, 0.2), 1.5 * np.pi),
}
"""Position and turn about y of the tip of a rod of length 1 that starts along z."""


def held(name: str, strain: str = "planar", **changes: Any) -> Table:
    """A rod clamped at both ends."""
    rod = {} if strain == "planar" else {**round_rod(), "strain": strain}
    return table(rod, supports=[clamp(*HELD[name])], **changes)


# (g) Twist


def twisted_column(twist: float, stretch: float, torsion: float = 2.0, axial: float = 100.0) -> Table:
    """A straight round rod of length 1, both ends clamped, stretched and twisted from its unloaded shape.

    The rod that would be twisted by −twist when unloaded is held without twist: the same strains.
    """
    rod = {**round_rod(torsion, extension=axial), "intrinsic": {"curvature": [0.0, 0.0, -twist]}}
    return table(rod, supports=[clamp([0, 0, 1 + stretch])])


def critical_torque(tension: float, stretch: float = 0.0) -> float:
    """Torque M at which a straight round rod with clamped ends buckles under a tension P, EI = L = 1.

    The small inclination w = u + iv of a straight rod of stretch λ = 1 + e obeys w'' − i M w' − λ P w = const with
    w = 0 at both ends and ∫ w = 0: the ends do not move sideways. With w = e^{iMX/2} (A e^{iβX} + B e^{−iβX}) + C the
    three conditions have a determinant, real up to a factor; its smallest zero is found. For P = 0 it is that of
    tan(M/2) = M/2, M = 8.9868: A. G. Greenhill, Proc. Inst. Mech. Eng. 34 (1883) 182.
    """

    def determinant(torque: float) -> float:
        beta = np.sqrt(torque**2 / 4 - (1 + stretch) * tension + 0j)
        one, two = 1j * torque / 2 + 1j * beta, 1j * torque / 2 - 1j * beta
        # (e^{two X} − 1)/two stands for the constant, with which the second wave falls together where P = 0.
        rows = [[np.exp(one * X), np.exp(two * X), X * np.exp(two * X / 2) * _mean(two * X)] for X in (-0.5, 0.5)]
        rest = two / 24 if abs(two) < 1e-4 else (_mean(two) - 1) / two
        rows.append([_mean(one), _mean(two), rest])
        # About the middle, so that this is real.
        return float((np.linalg.det(rows) / (one * 1j * beta)).real)

    least = 2 * np.sqrt(max((1 + stretch) * tension, 0.0)) + 0.3
    torques = np.arange(least, least + 20.0, 0.05)
    signs = np.sign([determinant(torque) for torque in torques])
    first = int(np.argmax(signs[1:] != signs[:-1]))
    return float(brentq(determinant, torques[first], torques[first + 1], xtol=1e-14))


def _mean(rate: complex) -> complex:
    """Mean of e^{rate X} over −1/2 < X < 1/2."""
    return complex(np.sinc(rate / (2j * np.pi)))


def twisted_ring(twist: float, torsion: float) -> Table:
    """A straight round rod of length 1 bent to a ring whose tip meets its base, twisted by an angle on the way."""
    rod = {**round_rod(torsion), "intrinsic": {"curvature": [0.0, 0.0, -twist]}}
    return table(rod, supports=[clamp([0, 0, 0])])


def writhing_rod(twist: float, **changes: Any) -> Table:
    """A rod of slightly unequal stiffnesses, clamped at both ends, 0.85 L apart and a little aside, twisted."""
    sizes = {"bending_x": 1.0, "bending_y": 1.1, "torsion": 0.8}
    rod = {"strain": "kirchhoff", "stiffness": sizes, "intrinsic": {"curvature": [0.0, 0.0, -twist]}}
    return table(rod, supports=[clamp([0.05, 0.0, 0.85])], **changes)


# (h) Springs


TURNS, PITCH = 10, 0.3
"""Of a helical spring with radius 1, EI = 1, GJ = 0.8."""


def spring(force: float, **changes: Any) -> Table:
    """A helical spring along z whose tip is pulled along its axis."""
    rise = PITCH / (2 * np.pi)
    curvature, torsion = 1 / (1 + rise**2), rise / (1 + rise**2)
    angle = np.arctan2(curvature, torsion)
    rod = {
        **round_rod(0.8),
        "length": spring_length(),
        "intrinsic": {"curvature": [0.0, curvature, torsion]},
        # The base is inclined so that the Darboux vector, the spring's axis, is vertical.
        "base": {"quaternion": [float(np.cos(angle / 2)), float(np.sin(angle / 2)), 0.0, 0.0]},
    }
    # The axis passes one radius beside the tip.
    return table(rod, tip(force=[0, 0, force], moment=[0, -force, 0]), **changes)


def spring_length() -> float:
    """Length of the spring's wire."""
    return float(TURNS * np.hypot(2 * np.pi, PITCH))


def love_compliance() -> float:
    """Axial compliance of a spring of small wire whose tip is free to turn.

    A. E. H. Love, *A Treatise on the Mathematical Theory of Elasticity*, 4th ed., 1927, article 271: with pitch angle α
    the axial force F twists the wire by F R cos α and bends it by F R sin α.
    """
    rise = PITCH / (2 * np.pi)
    cosine = 1 / np.hypot(1, rise)
    return spring_length() * (cosine**2 / 0.8 + 1 - cosine**2)


# (i), (j) Extreme stiffnesses


def slender(axial: float) -> Table:
    """A rod with EA L²/EI = axial, in space, under a force and a twisting moment."""
    sides = dict.fromkeys(["shear_x", "shear_y"], axial / 2.6)
    rod = round_rod(0.8, **sides, extension=axial)
    return table(rod, tip(force=[3.0, 2.0, -1.0], moment=[0.5, 0.0, 1.0]))


def wire(slenderness: float) -> Table:
    """A steel wire of one metre and diameter 1/slenderness; F L²/EI = 6."""
    radius = 0.5 / slenderness
    bending = 2e11 * np.pi / 4 * radius**4
    rod = {
        "strain": "reissner",
        "stiffness": {
            "bending_x": bending,
            "bending_y": bending,
            "torsion": bending / 1.3,
            "shear_x": 2e11 / 2.6 * np.pi * radius**2,
            "shear_y": 2e11 / 2.6 * np.pi * radius**2,
            "extension": 2e11 * np.pi * radius**2,
        },
    }
    return table(rod, tip(force=bending * np.array([4.0, -3.0, 2.0])))


def torsion_ratio(ratio: float) -> Table:
    """A bow, GJ/EI = ratio, pushed out of its plane."""
    return table(
        {**round_rod(ratio), "intrinsic": {"curvature": [1.0, 0.0, 0.0]}},
        tip(force=np.array([0.5, 0.4, 0.3]) * min(1.0, 30 * ratio)),
    )


def shear_beam(shear: float) -> Table:
    """A rod that shears and stretches rather than bends: GA L²/EI = shear."""
    rod = {"strain": "reissner", "stiffness": {**round_rod()["stiffness"], **_axial(shear)}}
    return table(rod, tip(force=np.array([0.6, 0.3, 0.4]) * min(shear, 1.0)))


def _axial(shear: float) -> Table:
    return {"shear_x": shear, "shear_y": shear, "extension": 2.6 * shear}


# (k) Conditioning


def quaternion_matrices(curvature: float, points: int) -> tuple[Array, Array]:
    """The linear system of a quaternion along a rod bent by a constant angle, in two forms.

    Differentiation form D_NN − A and Volterra form 1 − S A with S = D_NN⁻¹, for N + 1 Chebyshev points on [0, 1] with
    the first known; written down anew from L. N. Trefethen, *Spectral Methods in MATLAB*, SIAM 2000, chapter 6.
    """
    k = np.arange(points + 1)
    x = (1 - np.cos(np.pi * k / points)) / 2
    weights = np.where((k == 0) | (k == points), 2.0, 1.0) * (-1.0) ** k
    gaps = x[:, None] - x[None, :] + np.eye(points + 1)
    D = weights[:, None] / weights[None, :] / gaps
    D -= np.diag(D.sum(axis=1))
    generator = np.array([[0, 0, -1, 0], [0, 0, 0, -1], [1, 0, 0, 0], [0, 1, 0, 0]]) * curvature / 2
    rates = np.kron(np.eye(points), generator)
    derivative = np.kron(D[1:, 1:], np.eye(4))
    return derivative - rates, np.eye(4 * points) - np.linalg.solve(derivative, rates)


def growth_exponent(sizes: list[int], values: list[float]) -> float:
    """Slope between the last two of a series, both in logarithms."""
    ((n, a), (m, b)) = list(pairwise(zip(sizes, values, strict=True)))[-1]
    return float(np.log(b / a) / np.log(m / n))
