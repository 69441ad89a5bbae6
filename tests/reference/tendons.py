"""Tendon-driven rods by shooting, with tendons as distributed loads.

The model of D. C. Rucker and R. J. Webster, IEEE Transactions on Robotics 27 (2011) 1033–1044: a cable under tension
τ along p = r + R D presses on the rod with f = τ dt/ds, t = p'/|p'|, and l = R D × f per length, pulls with −τ t at its
anchor and +τ t where it enters. Strains are found from the stress of the rod alone and their rates from a linear
system, because the cable's curvature holds them. Sections are uniform; strain is Reissner's. Body frame, s in metres.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import root

Array = np.ndarray[Any, np.dtype[np.float64]]
STIFFNESSES = ("bending_x", "bending_y", "torsion", "shear_x", "shear_y", "extension")


def hat(v: Array) -> Array:
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


class TendonRod:
    """One rod of a scene, as `tomllib` reads it, with the tensions of its tendons scaled."""

    def __init__(self, scene: Mapping[str, Any]) -> None:
        rod = scene["rods"][0]
        self.length = rod["length"]
        stiffness = np.array([rod["stiffness"][name] for name in STIFFNESSES])
        self.bending, self.shear = stiffness[:3], stiffness[3:]
        self.curved = np.array(rod.get("intrinsic", {}).get("curvature", [0.0, 0, 0]))
        loads = {load["kind"]: load for load in scene.get("loads", [])}
        gravity = np.array(loads.get("gravity", {}).get("acceleration", [0.0, 0, 0]))
        self.weight = rod.get("linear_density", 0.0) * gravity
        self.force = np.array(loads.get("tip_wrench", {}).get("force", [0.0, 0, 0]))
        self.moment = np.array(loads.get("tip_wrench", {}).get("moment", [0.0, 0, 0]))
        self.tendons = scene["actuators"]

    def course(self, tendon: Mapping[str, Any], s: float) -> tuple[Array, Array, Array]:
        """D, dD/ds and d²D/ds² of a tendon."""
        X, L = s / self.length, self.length
        if "helix" in tendon:
            radius, rate = tendon["helix"]["radius"], 2 * np.pi * tendon["helix"]["turns"]
            angle = rate * X + tendon["helix"].get("phase", 0.0)
            c, z = np.array([np.cos(angle), np.sin(angle), 0.0]), np.array([-np.sin(angle), np.cos(angle), 0.0])
            return radius * c, radius * rate / L * z, -radius * (rate / L) ** 2 * c
        series = [np.polynomial.Polynomial(np.atleast_1d(component)) for component in tendon["offset"]]
        rows = [[p(X), p.deriv()(X) / L, p.deriv(2)(X) / L**2] for p in series]
        return tuple(np.append(column, 0.0) for column in np.array(rows).T)  # type: ignore[return-value]

    def point(self, tendon: Mapping[str, Any], s: float, u: Array, v: Array) -> tuple[Array, Array]:
        """Force −τ t on the rod and its moment, body frame, where a tendon is anchored."""
        D, slope, _ = self.course(tendon, s)
        p = v + np.cross(u, D) + slope
        force = -tendon["tension"] * p / np.linalg.norm(p)
        return force, np.cross(D, force)

    def rates(self, s: float, y: Array, active: list[Mapping[str, Any]], share: float) -> Array:
        R, v, u = y[3:12].reshape(3, 3), y[12:15], y[15:18]
        matrix = np.diag(np.concatenate([self.shear, self.bending]))
        right = np.concatenate(
            [
                -np.cross(u, self.shear * (v - [0, 0, 1])) - share * R.T @ self.weight,
                -np.cross(u, self.bending * (u - self.curved)) - np.cross(v, self.shear * (v - [0, 0, 1])),
            ]
        )
        for tendon in active:
            D, slope, bend = self.course(tendon, s)
            p = v + np.cross(u, D) + slope
            press = -share * tendon["tension"] * hat(p) @ hat(p) / np.linalg.norm(p) ** 3
            # p'' = u × p + v' + u' × D + u × D' + D''
            with_rates = press @ np.hstack([np.eye(3), -hat(D)])
            known = press @ (np.cross(u, p) + np.cross(u, slope) + bend)
            matrix += np.vstack([with_rates, hat(D) @ with_rates])
            right -= np.concatenate([known, np.cross(D, known)])
        return np.concatenate([R @ v, (R @ hat(u)).ravel(), np.linalg.solve(matrix, right)])

    def shoot(self, start: Array, share: float) -> Array:
        """State at the tip from v and u at the base, with the last jumps left out."""
        cuts = sorted({0.0, 1.0, *[end for tendon in self.tendons for end in tendon.get("span", [0.0, 1.0])]})
        y = np.concatenate([np.zeros(3), np.eye(3).ravel(), start])
        for a, b in pairwise(cuts):
            if a > 0.0:
                y = self._jump(y, a, share)
            active = [t for t in self.tendons if t.get("span", [0, 1])[0] <= a and t.get("span", [0, 1])[1] >= b]
            span = (a * self.length, b * self.length)
            y = solve_ivp(self.rates, span, y, "DOP853", args=(active, share), rtol=1e-11, atol=1e-12).y[:, -1]
        return y

    def _jump(self, y: Array, X: float, share: float) -> Array:
        """The rod's own stress falls by what acts on the section."""
        v, u = y[12:15], y[15:18]
        stress, couple = self.shear * (v - [0, 0, 1]), self.bending * (u - self.curved)
        # The strains on the far side turn the cable too: a few sweeps settle them.
        for _ in range(60):
            after = [stress.copy(), couple.copy()]
            for tendon in self.tendons:
                start, end = tendon.get("span", [0.0, 1.0])
                if end == X:
                    force, moment = self.point(tendon, X * self.length, y[15:18], y[12:15])
                elif start == X:
                    force, moment = (-part for part in self.point(tendon, X * self.length, u, v))
                else:
                    # A cable that goes on is bent at the section, where the strains jump.
                    before, after_it = (
                        self.point(tendon, X * self.length, y[15:18], y[12:15]),
                        self.point(tendon, X * self.length, u, v),
                    )
                    if not start < X < end:
                        continue
                    force, moment = before[0] - after_it[0], before[1] - after_it[1]
                after[0] -= share * force
                after[1] -= share * moment
            v, u = np.array([0, 0, 1]) + after[0] / self.shear, self.curved + after[1] / self.bending
        return np.concatenate([y[:12], v, u])

    def miss(self, y: Array, share: float) -> Array:
        """Stress at the tip that nothing answers, from the state there."""
        R, v, u = y[3:12].reshape(3, 3), y[12:15], y[15:18]
        force, moment = R.T @ self.force, R.T @ self.moment
        for tendon in self.tendons:
            if tendon.get("span", [0.0, 1.0])[1] == 1.0:
                pull, couple = self.point(tendon, self.length, u, v)
                force, moment = force + pull, moment + couple
        shear, bending = self.shear * (v - [0, 0, 1]), self.bending * (u - self.curved)
        return np.concatenate([(shear - share * force) / 1.0, (bending - share * moment) / self.length])

    def solve(self, steps: int = 2) -> tuple[Array, Array]:
        """Tip position and rotation in the base frame, by growing all loads."""
        scale = np.concatenate([1.0 / self.shear, self.length / self.bending])
        guess = np.concatenate([[0, 0, 1], self.curved])
        rest = guess.copy()
        for share in np.arange(1, steps + 1) / steps:

            def left(z: Array, share: float = share) -> Array:
                return self.miss(self.shoot(rest + z * scale, share), share)

            found = root(left, (guess - rest) / scale, method="hybr", tol=1e-14)
            guess = rest + found.x * scale
        assert np.abs(found.fun).max() < 1e-9, found.message
        y = self.shoot(guess, 1.0)
        return y[:3], y[3:12].reshape(3, 3)
