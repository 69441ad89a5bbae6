"""A rod dropped leaning, against a chain of rigid links with Moreau's time stepping.

The chain shares nothing with the rod: a planar chain of links with springs and dampers at its joints, whose joints may
not enter the floor (J. J. Moreau, *Unilateral contact and dry friction in finite freedom dynamics*, 1988). Compared is
how low the centre of mass comes: the tip has struck by then, the rod has rolled from there to its base, and that
strikes. How high it rebounds tells less: each link strikes where the rod rolls, and chains of 120 rebound a quarter
lower still.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss
from numpy.testing import assert_allclose
from scipy.linalg import cho_factor, cho_solve
from scipy.optimize import nnls

from cosserat_casadi import build, parse_scene, simulate
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.facings import facings

LENGTH = 0.3
RADIUS = 5e-3
DENSITY = 1100.0
YOUNG = 2e7
RETARDATION = 5e-3
GRAVITY = 9.81
HEIGHT = 0.1
LEAN = 0.2
DURATION = 0.127

STRIKES = 0.085
"""Time before the tip strikes, s."""

IN_FLIGHT, ON_THE_FLOOR = 2e-5, 4e-6
"""Steps of the chain before and after it, s: five times as long ones move the lowest height by a thousandth."""

SCENE = f"""
schema = 1
accuracy = {{ modes = 28, nodes = 60 }}
loads = [{{ name = "weight", kind = "gravity", acceleration = [0, 0, {-GRAVITY}] }}]
simulation = {{ duration = {DURATION}, start = "unloaded", frames = 11, tolerance = 1e-3 }}
[[rods]]
name = "rod"
length = {LENGTH}
strain = "planar"
material = {{ youngs_modulus = {YOUNG}, poisson_ratio = 0.4, density = {DENSITY} }}
section = {{ shape = "circle", radius = {RADIUS} }}
base = {{ position = [0, 0, 0], tangent = [1, 0, {-LEAN}], free = true }}
damping = {{ retardation_time = {RETARDATION} }}
[[obstacles]]
name = "floor"
kind = "plane"
point = [0, 0, {-HEIGHT}]
normal = [0, 0, 1]
"""


@dataclass(frozen=True)
class Chain:
    """Rigid links whose unknowns are the base's place and their angles to the floor.

    Attributes:
        count: number of links.
    """

    count: int

    def lowest(self) -> tuple[float, float]:
        """Least height of the centre of mass over its height where the rod lies, over the length, and its time, s."""
        n = self.count
        link = LENGTH / n
        area, moment = np.pi * RADIUS**2, np.pi * RADIUS**4 / 4.0
        mass = DENSITY * area * link
        arms = link * (np.tril(np.ones((n, n)), -1) + np.eye(n) / 2.0)
        coupled, lever = mass * arms.T @ arms, mass * arms.sum(axis=0)
        own = np.eye(n) * (mass * link**2 / 12.0 + DENSITY * moment * link)
        bends = np.diff(np.eye(n), axis=0)
        stiffness = np.zeros((n + 2, n + 2))
        stiffness[2:, 2:] = YOUNG * moment / link * bends.T @ bends

        q, v = np.zeros(n + 2), np.zeros(n + 2)
        q[2:] = np.arctan2(-LEAN, 1.0)
        time, least = 0.0, (np.inf, 0.0)
        while time < DURATION:
            step = IN_FLIGHT if time < STRIKES else ON_THE_FLOOR
            time += step
            middle = q + step / 2.0 * v
            angles, spins = middle[2:], v[2:]
            cosines, sines = np.cos(angles), np.sin(angles)
            between = angles[:, None] - angles
            inertia = np.zeros((n + 2, n + 2))
            inertia[:2, :2] = n * mass * np.eye(2)
            inertia[0, 2:] = inertia[2:, 0] = -lever * sines
            inertia[1, 2:] = inertia[2:, 1] = lever * cosines
            inertia[2:, 2:] = coupled * np.cos(between) + own
            force = np.zeros(n + 2)
            force[0] = lever @ (cosines * spins**2)
            force[1] = lever @ (sines * spins**2) - n * mass * GRAVITY
            force[2:] = -(coupled * np.sin(between)) @ spins**2 - lever * cosines * GRAVITY
            factor = cho_factor(inertia + (step * RETARDATION + step**2 / 2.0) * stiffness)
            free = cho_solve(factor, inertia @ v + step * (force - stiffness @ middle))
            v = free + self._impulses(factor, middle, free, link)
            q = middle + step / 2.0 * v
            height = float(q[1] + lever @ np.sin(q[2:]) / (n * mass) + HEIGHT - RADIUS)
            least = min(least, (height / LENGTH, time))
        return least

    def _impulses(
        self, factor: tuple[FloatArray, bool], middle: FloatArray, free: FloatArray, link: float
    ) -> FloatArray:
        """Change of the rates by the impulses of the floor, the least after which no joint approaches it."""
        slopes = link * np.cos(middle[2:])
        joints = middle[1] + np.concatenate([[0.0], np.cumsum(link * np.sin(middle[2:]))])
        (touching,) = np.nonzero(joints + HEIGHT - RADIUS <= 0.0)
        if not len(touching):
            return np.zeros(len(free))
        rows = np.zeros((len(touching), len(free)))
        rows[:, 1] = 1.0
        rows[:, 2:] = slopes * (np.arange(self.count) < touching[:, None])
        answers = cho_solve(factor, rows.T)
        root = np.linalg.cholesky(rows @ answers + 1e-14 * np.trace(rows @ answers) * np.eye(len(touching)))
        impulses, _ = nnls(root.T, -np.linalg.solve(root, rows @ free))
        return np.asarray(answers @ impulses)


@pytest.mark.slow
def test_a_leaning_rod_comes_as_low_as_a_chain_of_short_links() -> None:
    """By Aitken's rule; what that adds to the shortest links counts as its own error."""
    chains = np.array([Chain(count).lowest() for count in (30, 60, 120)])
    first, second = np.diff(chains, axis=0)
    assert 0.3 < second[0] / first[0] < 0.6
    beyond = second[0] ** 2 / (first[0] - second[0])
    motion = simulate(build(parse_scene(SCENE).with_motion_inputs(), moving=True))
    assert motion.converged, motion.message
    (facing,) = facings(motion.model)
    points, weights = leggauss(24)
    means = weights / 2.0 @ motion.model.discrete.rods["rod"].grid.interpolation_matrix((points + 1.0) / 2.0)
    times = np.linspace(0.126, 0.1268, 401)
    states = [motion.at(float(time)) for time in times]
    heights = np.array([means @ facing.nodes(state.x, state.inputs)[:, 2] for state in states]) + HEIGHT - RADIUS
    assert_allclose(heights.min() / LENGTH, chains[2, 0] + beyond, rtol=0, atol=beyond)
    assert_allclose(times[heights.argmin()], chains[2, 1], rtol=0, atol=2e-5)
