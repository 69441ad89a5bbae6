"""Digits of the free rod that is kicked: finite differences of the Reissner rod, DOP853, Richardson's extrapolation.

Slices with a position and a quaternion each; strains half way between two of them, by the mean of their quaternions; a
force turns both slices by half of the way between them, so that both momenta are kept. Nothing of the package is used.
`python kicked_rod.py 128 256` takes minutes, prints how far apart the tips are, and writes kicked_rod.json.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import DOP853

Array = np.ndarray[Any, Any]

LENGTH, RADIUS, YOUNG, DENSITY = 0.5, 0.02, 1e6, 1000.0
SHEAR = YOUNG / 3.0
AREA, SECOND = np.pi * RADIUS**2, np.pi * RADIUS**4 / 4.0
STRETCHED = np.array([[SHEAR * AREA], [SHEAR * AREA], [YOUNG * AREA]])
BENT = np.array([[YOUNG * SECOND], [YOUNG * SECOND], [2.0 * SHEAR * SECOND]])
INERTIA = DENSITY * SECOND * np.array([[1.0], [1.0], [2.0]])
STRAIGHT = np.array([[0.0], [0.0], [1.0]])
QUATERNION = np.array([0.85065080835204, 0.0, 0.5257311121191336, 0.0])
FORCE, MOMENT = np.array([2.0, 1.0, -0.5]), np.array([0.0, 0.15, 0.1])
KICK, DURATION = 0.1, 0.5
TIMES = np.linspace(0.0, DURATION, 11)


def matrices(q: Array) -> Array:
    """Rotation matrices of unit quaternions, shape (4, N) to (3, 3, N)."""
    w, x, y, z = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def product(p: Array, q: Array) -> Array:
    """Products of quaternions."""
    scalar = p[0] * q[0] - (p[1:] * q[1:]).sum(axis=0)
    return np.vstack([scalar, p[0] * q[1:] + q[0] * p[1:] + cross(p[1:], q[1:])])


def cross(u: Array, v: Array) -> Array:
    """u × v, faster than NumPy's."""
    return np.array([u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]])


def turned(R: Array, vectors: Array) -> Array:
    """R v."""
    return np.asarray(np.einsum("ijn,jn->in", R, vectors))


def seen(R: Array, vectors: Array) -> Array:
    """Rᵀ v."""
    return np.asarray(np.einsum("jin,jn->in", R, vectors))


def kick(time: float) -> tuple[Array, Array]:
    """Force and moment on the tip."""
    share = max(0.0, 1.0 - time / KICK)
    return share * FORCE, share * MOMENT


def arm(q: Array, force: Array, size: float) -> Array:
    """From the middle of the last slice to its end, which the force stretches and shears."""
    R = matrices(q[:, -1:])[:, :, 0]
    strain = STRAIGHT[:, 0] + (R.T @ force) / STRETCHED[:, 0]
    return np.asarray(0.5 * size * R @ strain)


def rates(slices: int) -> Callable[[float, Array], Array]:
    """The equations of motion of 13 N numbers: positions, quaternions, velocities, angular velocities in the slices."""
    size = LENGTH / slices

    def at(time: float, state: Array) -> Array:
        rows = state.reshape(13, slices)
        r, q, v, w = rows[:3], rows[3:7] / np.linalg.norm(rows[3:7], axis=0), rows[7:10], rows[10:]
        between = product(q[:, :-1] * np.array([[1.0], [-1.0], [-1.0], [-1.0]]), q[:, 1:])
        sine = np.linalg.norm(between[1:], axis=0)
        half = np.arctan2(sine, between[0])
        turn = between[1:] * np.where(sine > 1e-12, 2.0 * half / np.maximum(sine, 1e-12), 2.0)
        mean = q[:, :-1] + q[:, 1:]
        R = matrices(mean / np.linalg.norm(mean, axis=0))
        way = r[:, 1:] - r[:, :-1]
        force = turned(R, STRETCHED * (seen(R, way) / size - STRAIGHT))
        moment = turned(R, BENT * turn / size)
        lever = 0.5 * cross(way, force)
        forces, moments = np.zeros((2, 3, slices))
        forces[:, :-1] += force
        forces[:, 1:] -= force
        moments[:, :-1] += lever + moment
        moments[:, 1:] += lever - moment
        on_tip, about_tip = kick(time)
        forces[:, -1] += on_tip
        moments[:, -1] += about_tip + cross(arm(q, on_tip, size), on_tip)
        spin = np.vstack([np.zeros(slices), w])
        torque = seen(matrices(q), moments) - size * cross(w, INERTIA * w)
        changes = [v, 0.5 * product(q, spin), forces / (DENSITY * AREA * size), torque / (INERTIA * size)]
        return np.concatenate(changes).ravel()

    return at


def tips(slices: int) -> Array:
    """Positions of the tip, shape (T, 3), m."""
    size = LENGTH / slices
    tangent = matrices(QUATERNION[:, None])[:, 2]
    start = np.zeros((13, slices))
    start[:3] = tangent * (np.arange(slices) + 0.5) * size
    start[3:7] = QUATERNION[:, None]
    state = start.ravel()
    found = [tangent[:, 0] * LENGTH]
    for begin, end in ((0.0, KICK), (KICK, DURATION)):
        solver = DOP853(rates(slices), begin, state, end, rtol=1e-9, atol=1e-10)
        wanted = [time for time in TIMES if begin < time <= end]
        while solver.status == "running":
            solver.step()
            while len(wanted) and wanted[0] <= solver.t:
                time = wanted.pop(0)
                rows = solver.dense_output()(time).reshape(13, slices)
                q = rows[3:7] / np.linalg.norm(rows[3:7], axis=0)
                found.append(rows[:3, -1] + arm(q, kick(time)[0], size))
        state = solver.y
    return np.array(found)


def main() -> None:
    """Write the digits."""
    coarse, fine = (tips(int(word)) for word in sys.argv[1:3])
    extrapolated = fine + (fine - coarse) / 3.0
    uncertainty = float(np.linalg.norm(extrapolated - fine, axis=1).max())
    print(f"{uncertainty / LENGTH:.1e} of the length between the finer tips and the extrapolated ones")
    case = {"times": TIMES.tolist(), "tip": extrapolated.tolist(), "uncertainty": uncertainty}
    Path(__file__).with_suffix(".json").write_text(json.dumps(case, indent=1) + "\n")


if __name__ == "__main__":
    main()
