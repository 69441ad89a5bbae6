"""A planar robot with disks and a tendon straight between them, beside a chain of rigid links.

The links are L/N long and have half of their mass at each end; hinges between them have the stiffness EI N/L and the
clamp has twice that, since it is half a link away. A disk is a mass and an inertia at a joint, turned by the mean of
both links. The chain is a second formulation: angles instead of strains, Lagrange's equations instead of the balance of
a section, and no spectral integration. Its error falls with 1/N².
"""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
from scipy.integrate import solve_ivp

from cosserat_casadi.maths.typing import FloatArray

STIFFNESS, DAMPING, DENSITY, GRAVITY = 1.0, 0.03, 0.1, 9.81
"""Of a rod of length 1: N m², N m² s, kg/m; m/s²."""

DISKS, MASS, RADIUS, THICKNESS = 5, 0.03, 0.08, 0.02
"""Number of disks; kg, m and m of each."""

OFFSET, PULL, FREQUENCY, DURATION = 0.06, 6.0, 1.0, 1.0
"""Of the tendon: m, half of its largest tension, N, and its frequency, Hz; time of the motion, s."""


def robot(**simulation: Any) -> dict[str, Any]:
    """The scene; it hangs, and its tendon is pulled by PULL (1 − cos 2π FREQUENCY t)."""
    rod = {
        "name": "rod",
        "length": 1.0,
        "strain": "planar",
        "stiffness": {"bending_y": STIFFNESS},
        "damping": {"bending_y": DAMPING},
        "linear_density": DENSITY,
    }
    tendon = {
        "name": "cable",
        "kind": "tendon",
        "rod": "rod",
        "tension": 0.0,
        "offset": [OFFSET, 0],
        "routing": "disks",
    }
    disks = {"name": "disks", "rod": "rod", "count": DISKS, "mass": MASS, "radius": RADIUS, "thickness": THICKNESS}
    pulled = {"input": "cable.tension", "wave": "one_minus_cosine", "amplitude": PULL, "frequency": FREQUENCY}
    return {
        "schema": 1,
        "rods": [rod],
        "disks": [disks],
        "actuators": [tendon],
        "loads": [{"name": "weight", "kind": "gravity", "acceleration": [GRAVITY, 0, 0]}],
        "motions": [pulled],
        "simulation": {"duration": DURATION, "frames": 21, "start": "unloaded", **simulation},
    }


def tip_of_chain(links: int, times: FloatArray) -> FloatArray:
    """x and z of its tip, shape (T, 2); a multiple of DISKS links."""
    rates = _equations(links)

    def rate(time: float, state: FloatArray) -> FloatArray:
        tension = PULL * (1 - np.cos(2 * np.pi * FREQUENCY * time))
        speeds = state[links:]
        return np.concatenate([speeds, rates(state[:links], speeds, tension).full()[:, 0]])

    found = solve_ivp(rate, (0.0, DURATION), np.zeros(2 * links), "LSODA", times, rtol=1e-9, atol=1e-10)
    angles = found.y[:links].T
    return np.stack([np.sin(angles).sum(axis=1), np.cos(angles).sum(axis=1)], axis=1) / links


def _equations(links: int) -> ca.Function:
    """(angles, rates, tension) ↦ their accelerations, by Lagrange's equations."""
    angles, rates, tension = ca.SX.sym("angles", links), ca.SX.sym("rates", links), ca.SX.sym("tension")
    size = 1.0 / links
    along = size * ca.horzcat(ca.sin(angles), ca.cos(angles))
    joints = ca.cumsum(along)
    every = links // DISKS
    numbers = [every * (disk + 1) for disk in range(DISKS)]
    # The tip is half a link beyond the middle of the last one.
    turns = [
        (angles[k - 1] + angles[k]) / 2 if k < links else 1.5 * angles[k - 1] - 0.5 * angles[k - 2] for k in numbers
    ]
    masses = np.full(links, DENSITY * size)
    masses[-1] /= 2
    masses[np.array(numbers) - 1] += MASS
    inertia = MASS * (RADIUS**2 / 4 + THICKNESS**2 / 12)

    speeds = ca.jtimes(ca.vec(joints), angles, rates)
    kinetic = 0.5 * ca.sum1(np.tile(masses, 2) * speeds**2)
    for turn in turns:
        kinetic += 0.5 * inertia * ca.jtimes(turn, angles, rates) ** 2

    bends = ca.vertcat(np.sqrt(2.0) * angles[0], angles[1:] - angles[:-1])
    hole = ca.horzcat(OFFSET, 0)
    length = 0
    for number, turn in zip(numbers, turns, strict=True):
        following = joints[number - 1, :] + OFFSET * ca.horzcat(ca.cos(turn), -ca.sin(turn))
        length += ca.norm_2(following - hole)
        hole = following
    potential = 0.5 * STIFFNESS / size * ca.sumsqr(bends) - GRAVITY * ca.sum1(masses * joints[:, 0]) + tension * length

    dissipated = 0.5 * DAMPING / size * ca.sumsqr(ca.jtimes(bends, angles, rates))
    momentum = ca.gradient(kinetic, rates)
    forces = ca.gradient(kinetic - potential, angles) - ca.gradient(dissipated, rates)
    forces -= ca.jtimes(momentum, angles, rates)
    return ca.Function("rates", [angles, rates, tension], [ca.solve(ca.jacobian(momentum, rates), forces)])
