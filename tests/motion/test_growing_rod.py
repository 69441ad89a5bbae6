"""A rod that is drawn out while it swings, beside a Galerkin method in its inclination, integrated by scipy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from numpy.polynomial import legendre
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from cosserat_casadi import SceneError, parse_scene, scene_from_dict, simulate
from cosserat_casadi.maths.typing import FloatArray
from tests.motion.transients import Table, gravity, table

STIFFNESS = 0.08  # N m²
DENSITY = 0.4  # kg/m
ROTARY = 1e-5  # kg m
RETARDATION = 5e-3  # s
WEIGHT = 9.81  # m/s²
LENGTHS = (0.5, 0.7)  # m
GROWING = 0.3  # s
SPAN = 0.4  # s


def growing(tolerance: float) -> Table:
    rod = {
        "length": LENGTHS[0],
        "stiffness": {"bending_y": STIFFNESS},
        "linear_density": DENSITY,
        "rotary_inertia": [ROTARY, ROTARY, 2 * ROTARY],
        "damping": {"retardation_time": RETARDATION},
    }
    drawn = {"input": "rod.length", "times": [0.0, GROWING], "values": list(LENGTHS), "interpolation": "cubic"}
    simulation = {"duration": SPAN, "frames": 9, "tolerance": tolerance, "start": "unloaded"}
    return table(rod, gravity(WEIGHT), motions=[drawn], simulation=simulation)


def length_at(time: float) -> tuple[float, float, float]:
    """Length, and its two rates."""
    s = min(time / GROWING, 1.0)
    gain = LENGTHS[1] - LENGTHS[0]
    value = LENGTHS[0] + gain * (3 * s**2 - 2 * s**3)
    return value, gain * 6 * (s - s**2) / GROWING, gain * (6 - 12 * s) / GROWING**2 * (s < 1.0)


@dataclass(frozen=True)
class Galerkin:
    """Inclinations θ(X) = ∫ Σ φ_k p_k, with places ℓ ∫ (cos θ, sin θ): sections stay at their X as the rod grows.

    Attributes:
        slopes: φ at the Gauss points, shape (N, n).
        shapes: their integrals from 0, shape (N, n).
        integral: matrix of the integral from 0 to the Gauss points, shape (N, N).
        weights: of the Gauss points, shape (N,).
    """

    slopes: FloatArray
    shapes: FloatArray
    integral: FloatArray
    weights: FloatArray

    def rates(self, time: float, state: FloatArray) -> FloatArray:
        """Lagrange's equations of the mass that is there: −ρA r̈ on it, bent with the curvature θ' / ℓ."""
        p, v = np.split(state, 2)
        length, rate, acceleration = length_at(time)
        theta, omega = self.shapes @ p, self.shapes @ v
        along = np.stack([np.cos(theta), np.sin(theta)])
        across = np.stack([-np.sin(theta), np.cos(theta)])
        place = along @ self.integral.T
        by_p = np.einsum("ij,kjn->kin", self.integral, across[:, :, None] * self.shapes)
        turning = -(along * omega**2) @ self.integral.T
        known = acceleration * place + 2 * rate * (by_p @ v) + length * turning
        known[1] += WEIGHT
        mass = DENSITY * length**3 * np.einsum("kin,i,kim->nm", by_p, self.weights, by_p)
        mass += ROTARY * length * self.shapes.T @ (self.weights[:, None] * self.shapes)
        force = -DENSITY * length**2 * np.einsum("kin,i,ki->n", by_p, self.weights, known)
        bending = p / length + RETARDATION * (v / length - p * rate / length**2)
        force -= STIFFNESS * self.slopes.T @ (self.weights * (self.slopes @ bending))
        return np.concatenate([v, np.linalg.solve(mass, force)])

    def tip(self, time: float, p: FloatArray) -> FloatArray:
        theta = self.shapes @ p
        return np.asarray(length_at(time)[0] * np.stack([np.cos(theta), np.sin(theta)]) @ self.weights)


def galerkin(count: int, points: int) -> Galerkin:
    nodes, weights = legendre.leggauss(points)
    to_coefficients = np.linalg.inv(legendre.legvander(nodes, points - 1))
    antiderivatives = [legendre.legval(nodes, legendre.legint(row, lbnd=-1)) / 2 for row in np.eye(points)]
    integral = np.stack(antiderivatives, axis=1) @ to_coefficients
    slopes = legendre.legvander(nodes, count - 1)
    return Galerkin(slopes, integral @ slopes, integral, weights / 2)


@pytest.mark.slow
def test_a_rod_that_is_drawn_out_vs_independent_galerkin_method() -> None:
    """Weight acts at once and the rod is damped: its tip falls, swings and is pushed out."""
    motion = simulate(scene_from_dict(growing(1e-4)))
    assert motion.converged, motion.message
    exact = galerkin(10, 40)
    start = np.zeros(20)
    found = solve_ivp(
        exact.rates, (0.0, SPAN), start, method="Radau", t_eval=motion.times, rtol=1e-7, atol=1e-10, max_step=0.01
    )
    tips = np.array([exact.tip(time, state[:10]) for time, state in zip(found.t, found.y.T, strict=True)])
    error = np.linalg.norm(motion.tip().position[:, [0, 2]] - tips, axis=1).max() / LENGTHS[0]
    assert error <= motion.error_estimate + 1e-6
    # It must move for its path to be wrong.
    assert np.ptp(tips, axis=0).min() > 0.1 * LENGTHS[0]


CARRYING = """
schema = 1
inputs = ["rod.length"]
accuracy = { modes = 2, nodes = 6 }
[[rods]]
name = "rod"
length = 0.5
strain = "planar"
stiffness = { bending_y = 0.05 }
linear_density = 0.1
rotary_inertia = [1e-5, 1e-5, 2e-5]
base = { position = [0, 0, 0], free = true }
[[rods]]
name = "carried"
length = 0.3
strain = "planar"
stiffness = { bending_y = 0.05 }
linear_density = 0.1
rotary_inertia = [1e-5, 1e-5, 2e-5]
base = { rod = "rod", at = 1.0 }
[simulation]
duration = 0.3
start = "unloaded"
tolerance = 1e-4
[[motions]]
input = "rod.length"
times = [0.0, 0.3]
values = [0.5, 0.7]
interpolation = "cubic"
"""


def test_a_free_rod_that_grows_and_carries_another_recoils() -> None:
    """In line: z'' (M + m) + l'' (M/2 + m) = 0, with the mass M = 0.1 l of the one and m of the other; base at z.

    What the rod gains has the velocity of its sections. By constant momentum it would have that of the observer.
    """
    motion = simulate(parse_scene(CARRYING))
    assert motion.converged, motion.message
    rest = 0.03

    def rates(t: float, state: FloatArray) -> list[float]:
        share = t / 0.3
        mass, faster = 0.1 * (0.5 + 0.2 * share**2 * (3 - 2 * share)), 1.2 * (1 - 2 * share) / 0.3**2
        return [state[1], -faster * (mass / 2 + rest) / (mass + rest)]

    base = solve_ivp(rates, (0.0, 0.3), [0.0, 0.0], t_eval=motion.times, rtol=1e-10, atol=1e-12).y[0]
    tips = base + 0.5 + 0.2 * (motion.times / 0.3) ** 2 * (3 - 2 * motion.times / 0.3)
    assert motion.error_estimate is not None and motion.error_estimate < 1e-3
    assert_allclose(motion.tip("rod").position[:, 2], tips, rtol=0, atol=0.5 * motion.error_estimate)


def test_a_sudden_growth_that_a_joint_would_have_to_follow_is_refused() -> None:
    with pytest.raises(SceneError, match="no finite force brings what they hold to it at once"):
        simulate(parse_scene(CARRYING.replace('interpolation = "cubic"', "")))


ALONE = CARRYING[: CARRYING.index('[[rods]]\nname = "carried"')] + CARRYING[CARRYING.index("[simulation]") :]


def test_a_thrown_rod_that_grows_keeps_the_velocity_of_its_middle() -> None:
    """Its mass grows, and what it gains moves with its sections: Σ dm r̈ = 0, so that z̈ + l̈/2 = 0 and ẍ = 0."""
    thrown = simulate(parse_scene(ALONE + '[[velocities]]\nrod = "rod"\nlinear = [0.4, 0.0, 0.3]\n'))
    assert thrown.converged, thrown.message
    share = thrown.times / 0.3
    lengths = 0.5 + 0.2 * share**2 * (3 - 2 * share)
    tips = np.stack([0.4 * thrown.times, 0.0 * share, 0.3 * thrown.times + 0.25 + lengths / 2], axis=1)
    assert_allclose(thrown.tip("rod").position, tips, rtol=0, atol=1e-6)
    # Six steps bring the mean power of what the rod gains to so much.
    assert np.abs(thrown.energy.imbalance[-1]) < 1e-3


def test_a_free_rod_that_would_grow_at_once_from_rest_is_refused() -> None:
    with pytest.raises(SceneError, match=r"'rod\.length' has a speed at t = 0, where its free rod is at rest"):
        simulate(parse_scene(ALONE.replace('interpolation = "cubic"', "")))
