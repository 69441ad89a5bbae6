"""Seeded rods with waves along them, and an integrator that judges what is claimed of them.

The wrench in a section, of rod and cables together, obeys the balance of the loads alone: n' = −f, m' = −r' × n − l,
and nothing jumps where a cable is anchored. The strain follows from it section by section,
H (ξ − ξ⁰) + Σ τ [D × t; t] = [Rᵀ m; Rᵀ n] in the admitted strains, whose left side is the gradient of a convex
function. DOP853 integrates pose, wrench and the lengths of the cables from the clamp: no polynomials, no nodes of ours.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.polynomial import legendre
from scipy.integrate import solve_ivp

from cosserat_casadi import Scene, Solution
from cosserat_casadi.model.scene_rods import rod_properties
from tests.pose_errors import pose_error
from tests.reference.random_scenes import between
from tests.reference.rods import hat

Array = np.ndarray[Any, np.dtype[np.float64]]
Table = dict[str, Any]

# Scenes

KINDS = ("helical", "helical", "converging", "several", "loaded")


def routed_scene(seed: int) -> Table:
    """A rod of length 1 and bending stiffness 1 with tendons, and a tolerance; the same seed gives the same scene."""
    rng = np.random.default_rng([seed, 19])
    kind = KINDS[seed % len(KINDS)]
    strain = str(rng.choice(["kirchhoff", "reissner"]))
    round_section = rng.random() < 0.5
    stiffness = {
        "bending_x": 1.0,
        "bending_y": 1.0 if round_section else float(rng.uniform(1.0, 1.5)),
        "torsion": float(rng.uniform(0.6, 1.2)),
    }
    if strain == "reissner":
        axial = between(rng, 300.0, 3000.0)
        stiffness |= {"shear_x": 0.4 * axial, "shear_y": 0.4 * axial, "extension": axial}
    tendons = [_helix(rng)]
    if kind == "converging":
        tendons = [_converging(rng)]
    if kind == "several":
        tendons = [_helix(rng, 0.5), _converging(rng, 0.5)]
        start = float(rng.uniform(0.0, 0.4))
        tendons[1]["span"] = [start, float(rng.uniform(0.6, 1.0))]
    tables: Table = {
        "schema": 1,
        "title": f"routed scene {seed}, {kind}",
        "accuracy": {"tolerance": between(rng, 1e-7, 1e-3)},
        "rods": [{"name": "rod", "length": 1.0, "strain": strain, "stiffness": stiffness}],
        "actuators": [
            {"name": f"cable{i}", "kind": "tendon", "rod": "rod", **tendon} for i, tendon in enumerate(tendons)
        ],
    }
    if kind == "loaded":
        load = {"name": "push", "kind": "tip_wrench", "rod": "rod"}
        tables["loads"] = [{**load, "force": _vector(rng, 2.0), "moment": _vector(rng, 0.5)}]
    return tables


def rich_scene(seed: int) -> Table:
    """A rod without tendons, of wavy unloaded curvature or under a wavy spread load; the same seed, the same scene."""
    rng = np.random.default_rng([seed, 6])
    rod: Table = {
        "name": "rod",
        "length": 1.0,
        "strain": "kirchhoff",
        "stiffness": {"bending_x": 1.0, "bending_y": float(rng.uniform(1.0, 1.5)), "torsion": 0.8},
    }
    push = {"name": "push", "kind": "tip_wrench", "rod": "rod", "force": _vector(rng, 3.0), "moment": _vector(rng, 1.0)}
    loads = [push]
    if seed % 2 == 0:
        count = int(rng.integers(10, 41))
        rod["intrinsic"] = {"curvature": [[float(v) for v in rng.normal(size=count)] for _ in range(3)]}
    else:
        order = int(rng.integers(4, 9))
        wind = [[float(v) for v in 4.0 * rng.normal(size=order + 1)] for _ in range(3)]
        couple = [[float(v) for v in rng.normal(size=order + 1)] for _ in range(3)]
        frame = str(rng.choice(["world", "body"]))
        spread = {"name": "wind", "kind": "distributed_wrench", "rod": "rod", "frame": frame}
        loads.append({**spread, "force": wind, "moment": couple})
    return {
        "schema": 1,
        "title": f"rich scene {seed}, {'curved' if seed % 2 == 0 else 'spread'}",
        "accuracy": {"tolerance": between(rng, 1e-8, 1e-3)},
        "rods": [rod],
        "loads": loads,
    }


def _helix(rng: np.random.Generator, share: float = 1.0) -> Table:
    """Two to twenty turns either way; the tension bends by some radians, or nearly buckles."""
    radius = between(rng, 0.01, 0.3)
    turns = int(rng.integers(2, 21)) + float(rng.choice([0.0, rng.uniform(0, 1)]))
    sign = float(rng.choice([-1.0, 1.0]))
    helix = {"radius": radius, "turns": sign * turns, "phase": float(rng.uniform(0, 6))}
    tension = share * between(rng, 0.3, min(20.0, 3.0 / radius))
    return {"tension": tension, "helix": helix}


def _converging(rng: np.random.Generator, share: float = 1.0) -> Table:
    """Polynomials of up to the ninth degree."""
    radius = between(rng, 0.01, 0.15)
    degree = int(rng.integers(1, 10))
    offset = [[float(v) for v in radius * rng.normal(size=degree + 1) / np.arange(1, degree + 2)] for _ in range(2)]
    return {"tension": share * between(rng, 0.3, min(15.0, 1.5 / radius)), "offset": offset}


def _vector(rng: np.random.Generator, size: float) -> list[float]:
    return [float(v) for v in size * rng.normal(size=3) / np.sqrt(3)]


# The integrator

RTOL, ATOL = 1e-11, 1e-12


@dataclass(frozen=True)
class Integrated:
    """Where the rod ends, and how long its cables are."""

    position: Array
    rotation: Array
    lengths: dict[str, float]


@dataclass(frozen=True)
class Miss:
    """True errors of a solution, relative to the length of the rod: of tip poses and of lengths of cables."""

    tip: float
    cable: float


def miss(scene: Scene, solution: Solution) -> Miss:
    """What a solution of a scene with one clamped rod is off by, against the integrated equilibrium nearest to it."""
    tensions = {a.name: float(solution.actuator(a.name)["tension"]) for a in scene.actuators}
    truth = _Integrator(scene, tensions).equilibrium(solution)
    length = scene.rods[0].length
    tip = solution.tip()
    error = pose_error((tip.position, tip.rotation), (truth.position, truth.rotation), length)
    cables = [abs(float(solution.actuator(name)["length"]) - L) / length for name, L in truth.lengths.items()]
    return Miss(error, max(cables, default=0.0))


class _Integrator:
    """Clamped at the origin along z, one rod, dead wrench at the tip, spread loads, weight of uniform density.

    States are columns: position, rotation, force and moment in world axes, lengths of the cables.
    """

    def __init__(self, scene: Scene, tensions: dict[str, float]) -> None:
        self.rod = rod_properties(scene.rods[0])
        self.tendons: list[Any] = list(scene.actuators)
        self.tensions = [tensions[t.name] for t in self.tendons]
        self.tip_wrench = np.zeros(6)
        self.spread: list[Any] = []
        for load in scene.loads:
            if load.kind == "distributed_wrench":
                self.spread.append(load)
            elif load.kind == "gravity":
                weight = scene.rods[0].linear_density * np.array(load.acceleration)
                self.spread.append(SimpleNamespace(frame="world", force=weight, moment=np.zeros(3)))
            else:
                self.tip_wrench += np.concatenate([load.force, load.moment])
        self.loaded = bool(scene.loads)

    def equilibrium(self, solution: Solution) -> Integrated:
        """Newton on the clamp's wrench, from what the solution claims."""
        base = solution.base_wrench()
        wrench = -np.concatenate([base.force, base.moment])
        if not self.loaded:
            # Cables alone leave no wrench in any section.
            wrench = np.zeros(6)
        for _ in range(8):
            step = 1e-5
            nearby = step * np.eye(6) if self.loaded else np.zeros((6, 0))
            states = self._shoot(wrench[:, None] + np.column_stack([np.zeros(6), nearby]))
            if not self.loaded:
                break
            left = states[12:18] - self.tip_wrench[:, None]
            change = np.linalg.solve((left[:, 1:] - left[:, :1]) / step, -left[:, 0])
            wrench = wrench + change
            if np.abs(change).max() < 1e-10:
                break
        state = states[:, 0]
        lengths = {t.name: float(state[18 + i]) for i, t in enumerate(self.tendons)}
        return Integrated(state[:3], state[3:12].reshape(3, 3), lengths)

    def _shoot(self, wrenches: Array) -> Array:
        """States at the tip for wrenches at the clamp, one a column."""
        count, extra = wrenches.shape[1], len(self.tendons)
        start = np.zeros((18 + extra, count))
        start[3:12] = np.eye(3).reshape(9, 1)
        start[12:18] = wrenches
        cuts = sorted({0.0, 1.0, *[end for t in self.tendons for end in t.span]})
        y = start.ravel()
        for a, b in pairwise(cuts):
            active = [i for i, t in enumerate(self.tendons) if t.span[0] <= a and t.span[1] >= b]
            self.strain = np.repeat(self.rod.intrinsic_strain(np.array([a])), count, axis=0)
            done = solve_ivp(self._rates, (a, b), y, "DOP853", args=(active, count), rtol=RTOL, atol=ATOL)
            assert done.success
            y = done.y[:, -1]
        return np.asarray(y.reshape(-1, count))

    def _rates(self, X: float, flat: Array, active: list[int], count: int) -> Array:
        y = flat.reshape(-1, count)
        R = y[3:12].T.reshape(count, 3, 3)
        force = np.einsum("kji,jk->ki", R, y[12:15])
        couple = np.einsum("kji,jk->ki", R, y[15:18])
        offset = [(i, *_offset(self.tendons[i], X)) for i in active]
        strain, tangents = self._strain(X, np.hstack([couple, force]), offset)
        self.strain = strain
        rates = np.zeros_like(y)
        r_rate = np.einsum("kij,kj->ki", R, strain[:, 3:])
        rates[:3] = r_rate.T
        hats = np.cross(np.eye(3), strain[:, None, :3])
        rates[3:12] = (R @ hats).reshape(count, 9).T
        rates[15:18] = -np.cross(r_rate, y[12:15].T).T
        for load in self.spread:
            turn = R if load.frame == "body" else np.eye(3)
            for rows, vector in ((slice(12, 15), load.force), (slice(15, 18), load.moment)):
                rates[rows] -= (turn @ [legendre.legval(2 * X - 1, np.atleast_1d(c)) for c in vector]).T.reshape(3, -1)
        for i, tangent in tangents:
            rates[18 + i] = np.linalg.norm(tangent, axis=1)
        return np.asarray(self.rod.length * rates.ravel())

    def _strain(self, X: float, wrench: Array, offsets: list[Any]) -> tuple[Array, list[Any]]:
        """Strain in sections under wrenches, rows of (k, 6), and the tangents of the cables: damped Newton."""
        at = np.array([X])
        rest, hooke = self.rod.intrinsic_strain(at)[0], self.rod.hooke(at)[0]
        free = list(self.rod.admitted)
        strain = np.where(np.isin(np.arange(6), free), self.strain, rest)
        for _ in range(40):
            gradient = np.where(np.isnan(hooke), 0.0, hooke) * (strain - rest) - wrench
            hessian = np.zeros((len(strain), 6, 6)) + np.diag(np.where(np.isnan(hooke), 0.0, hooke))
            tangents = []
            for i, D, slope in offsets:
                # T = Γ + K × D + D'/ℓ = rates ξ + D'/ℓ
                rates = np.hstack([-hat(D), np.eye(3)])
                tangent = strain @ rates.T + slope / self.rod.length
                size = np.linalg.norm(tangent, axis=1)
                t = tangent / size[:, None]
                gradient = gradient + self.tensions[i] * t @ rates
                across = (np.eye(3) - t[:, :, None] * t[:, None, :]) / size[:, None, None]
                hessian = hessian + self.tensions[i] * rates.T @ across @ rates
                tangents.append((i, tangent))
            step = -np.linalg.solve(hessian[:, free][:, :, free], gradient[:, free, None])[..., 0]
            if np.abs(step).max() < 1e-13 * max(1.0, np.abs(strain).max()):
                return strain, tangents
            strain = strain.copy()
            strain[:, free] += step
        assert np.abs(step).max() < 1e-10, "no strain found"
        return strain, tangents


def _offset(tendon: Any, X: float) -> tuple[Array, Array]:
    """D and dD/dX, three entries each."""
    if tendon.helix is not None:
        helix = tendon.helix
        rate = 2 * np.pi * helix.turns
        c, s = np.cos(rate * X + helix.phase), np.sin(rate * X + helix.phase)
        return helix.radius * np.array([c, s, 0.0]), helix.radius * rate * np.array([-s, c, 0.0])
    series = [np.polynomial.Polynomial(np.atleast_1d(component)) for component in tendon.offset]
    return np.array([*[p(X) for p in series], 0.0]), np.array([*[p.deriv()(X) for p in series], 0.0])
