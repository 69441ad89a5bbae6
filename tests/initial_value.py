"""An independent oracle: the rod integrated from its base as an initial-value problem.

World-frame balance n' = −f̄, m' = −r' × n − l̄ with rotation matrices and DOP853: no strain polynomials, no Chebyshev
nodes, no quaternions. Given the base wrench a solution claims, the tip must come out where the solution puts it,
and the wrench left there must be the tip's load.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.polynomial import legendre
from scipy.integrate import solve_ivp

from cosserat_casadi import Scene
from cosserat_casadi.model.scene_rods import base_pose, rod_properties


@dataclass(frozen=True)
class Tip:
    """Pose of the tip and the wrench that is left there once its loads are taken off."""

    position: np.ndarray
    rotation: np.ndarray
    force_left: np.ndarray
    moment_left: np.ndarray


def integrate(scene: Scene, force: np.ndarray, moment: np.ndarray) -> Tip:
    """Integrate the scene's only rod from its base, where the clamp exerts this force and moment on it."""
    rod = rod_properties(scene.rods[0])
    position, quaternion = base_pose(scene.rods[0])
    state = np.concatenate([position, matrix_of(quaternion).ravel(), -force, -moment])
    jumps = [load for load in scene.loads if load.kind == "point_wrench"]
    cuts = sorted({0.0, 1.0, *(load.at for load in jumps)})
    for start, end in pairwise(cuts):
        state = _between(scene, rod, state, start, end)
        for load in jumps:
            if load.at == end:
                state = _take_off(load, state)
    for load in scene.loads:
        if load.kind == "tip_wrench":
            state = _take_off(load, state)
    return Tip(state[:3], state[3:12].reshape(3, 3), state[12:15], state[15:])


def matrix_of(q: np.ndarray) -> np.ndarray:
    """Rotation matrix of a unit quaternion w x y z."""
    w, v = q[0], np.asarray(q[1:])
    return np.eye(3) + 2 * w * hat(v) + 2 * hat(v) @ hat(v)


def hat(v: np.ndarray) -> np.ndarray:
    """Matrix of the cross product."""
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def _between(scene: Scene, rod: Any, state: np.ndarray, start: float, end: float) -> np.ndarray:
    def rate(X: float, y: np.ndarray) -> np.ndarray:
        R, n, m = y[3:12].reshape(3, 3), y[12:15], y[15:]
        strain = _strain(rod, X, np.concatenate([R.T @ m, R.T @ n]))
        force, moment = _distributed(scene, rod, X, R)
        r_rate = R @ strain[3:]
        rates = (r_rate, (R @ hat(strain[:3])).ravel(), -force, -np.cross(r_rate, n) - moment)
        return rod.length * np.concatenate(rates)

    done = solve_ivp(rate, (start, end), state, method="DOP853", rtol=1e-12, atol=1e-13)
    assert done.success
    return np.asarray(done.y[:, -1])


def _strain(rod: Any, X: float, wrench: np.ndarray) -> np.ndarray:
    at = np.array([X])
    strain, hooke = rod.intrinsic_strain(at)[0].copy(), rod.hooke(at)[0]
    for i in rod.admitted:
        strain[i] += wrench[i] / hooke[i]
    return np.asarray(strain)


def _distributed(scene: Scene, rod: Any, X: float, R: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    force, moment = np.zeros(3), np.zeros(3)
    for load in scene.loads:
        if load.kind == "gravity":
            force += rod.linear_density(np.array([X]))[0] * np.asarray(load.acceleration)
        if load.kind == "distributed_wrench":
            turn = R if load.frame == "body" else np.eye(3)
            force += turn @ [legendre.legval(2 * X - 1, np.atleast_1d(c)) for c in load.force]
            moment += turn @ [legendre.legval(2 * X - 1, np.atleast_1d(c)) for c in load.moment]
    return force, moment


def _take_off(load: Any, state: np.ndarray) -> np.ndarray:
    turn = state[3:12].reshape(3, 3) if load.frame == "body" else np.eye(3)
    left = state.copy()
    left[12:15] -= turn @ np.asarray(load.force)
    left[15:] -= turn @ np.asarray(load.moment)
    return left
