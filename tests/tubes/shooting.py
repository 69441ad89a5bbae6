"""Robots of tubes as an initial-value problem from the plate: nothing but what a robot is made of is shared."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import root

from cosserat_casadi import TubeSolution
from tests.reference.rods import hat

DENSITY = (0.03, 0.02, 0.01)
"""Masses of three tubes per length, kg/m."""


def forces_of(found: TubeSolution) -> tuple[np.ndarray, np.ndarray]:
    """Force at the tip of each tube, N, and per length along it, N/m, in world axes, shapes (n, 3)."""
    inputs = dict(zip(found.robot.columns, found.inputs, strict=True))

    def value(name: str) -> np.ndarray:
        return np.array([inputs.get(f"{name}.{axis}", 0.0) for axis in "xyz"])

    names = found.robot.names
    at_tips = np.zeros((len(names), 3))
    at_tips[names.index("inner")] += value("push.force")
    at_tips[names.index("outer")] += value("poke.force")
    along = np.outer(DENSITY[: len(names)], value("weight.acceleration"))
    along[names.index("inner")] += value("wind.force")
    return at_tips, along


@dataclass(frozen=True)
class Shot:
    """What shooting finds.

    Attributes:
        torques: of the tubes at the plate, N m, shape (n,).
        angles: of the tubes at the tip, rad, shape (n,).
        position: of the tip, m, shape (3,).
        energy: of bending and twisting, within the housing too, J.
    """

    torques: np.ndarray
    angles: np.ndarray
    position: np.ndarray
    energy: float


def shot(found: TubeSolution) -> Shot:
    """The equilibrium near a solution, by shooting from the plate.

    The frame is that of the first tube, which turns about the tangent; unknown are the torques of the tubes and the
    bending moment at the plate. D. C. Rucker, B. A. Jones, R. J. Webster, IEEE Trans. Robot. 26 (2010) 769.
    """
    robot = found.robot
    n = robot.size
    reach = robot.translations(found.inputs)
    bends = reach - robot.curved
    at_tips, along = forces_of(found)
    inside = (robot.length - reach) / robot.torsion
    cuts = sorted({0.0, *np.maximum(bends, 0.0), *reach})

    def rate(s: float, y: np.ndarray) -> np.ndarray:
        angles, torques, moment = y[:n], y[n : 2 * n], y[2 * n : 2 * n + 3]
        rotation = y[2 * n + 3 : 2 * n + 12].reshape(3, 3)
        here = s < reach
        force = here @ (at_tips + (reach - s)[:, None] * along)
        stiffness = robot.bending * here
        wanted = np.zeros((n, 2))
        for i in range(n):
            angle = angles[i] - angles[0]
            turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
            wanted[i] = turn @ [0.0, robot.curvature[i] * (s > bends[i])]
        u = np.zeros(3)
        u[:2] = (moment[:2] + stiffness @ wanted) / stiffness.sum()
        u[2] = torques[0] / robot.torsion[0]
        bending = stiffness[:, None] * (u[:2] - wanted)
        gained = bending[:, 0] * wanted[:, 1] - bending[:, 1] * wanted[:, 0]
        moment_rate = -np.cross(u, moment) - np.cross([0, 0, 1], rotation.T @ force)
        energy = torques**2 @ (1 / robot.torsion) / 2 + np.sum(stiffness[:, None] * (u[:2] - wanted) ** 2) / 2
        turned = (rotation @ hat(u)).ravel()
        return np.concatenate([torques / robot.torsion, gained, moment_rate, turned, rotation[:, 2], [energy]])

    def tip(unknown: np.ndarray) -> np.ndarray:
        torques, bending = unknown[:n], unknown[n:]
        angles = robot.rotations(found.inputs) + inside * torques
        c, s = np.cos(angles[0]), np.sin(angles[0])
        # The first tube's own axes are turned by its angle at the plate.
        start = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        y = np.concatenate([angles, torques, bending, [torques.sum()], start.ravel(), np.zeros(4)])
        for first, last in itertools.pairwise(cuts):
            y = solve_ivp(rate, (first + 1e-14, last - 1e-14), y, method="DOP853", rtol=1e-10, atol=1e-12).y[:, -1]
        return y

    def missed(unknown: np.ndarray) -> np.ndarray:
        return tip(unknown)[n : 2 * n + 2]

    start = np.concatenate([found.shape.torques[0], np.zeros(2)])
    end = root(missed, start, tol=1e-12)
    assert np.abs(end.fun).max() < 1e-9
    torques, state = end.x[:n], tip(end.x)
    housing = torques**2 @ inside / 2
    return Shot(torques, angles=state[:n], position=state[-4:-1], energy=float(state[-1] + housing))
