"""Static equilibrium of one rod by shooting: world-frame balance, rotation matrices, DOP853 at 1e-13.

    r' = R Γ,  R' = R K^,  n' = −f̄,  m' = −r' × n − l̄,  K = K⁰ + M/H,  Γ = Γ⁰ + N/H,  M = Rᵀm,  N = Rᵀn

Strains that are not admitted keep their intrinsic values; their wrench components are reactions. The six unknowns
are n and m at the base, in units of EI/L² and EI/L. Jacobians are exact (complex step through the integrator). A free
tip is reached by growing the loads from nothing, a held tip by moving its support from where an unloaded rod under
a base moment would have it. Where the clamp's wrench is nearly known, Newton's method starts there instead.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from .rods import Array, PointLoad, RodData, rod_of, rotation_from_quaternion

COARSE, FINE = 1e-7, 1e-13
"""Tolerances of the integrator: along the path, and for the answer."""

NEAR = 1e-2
"""Largest relative correction of a base wrench to start from: beyond, another equilibrium may have been reached."""

TABLES = ("loads", "supports", "actuators", "joints", "obstacles")
"""Tables of a scene whose members have kinds."""

KNOWN = {"gravity", "tip_wrench", "point_wrench", "distributed_wrench", "clamped", "pinned"}
"""Kinds that shooting knows."""

_STEP = 1e-30
_FLAT_HATS = np.array([[0.0, 0, 0, 0, 0, -1, 0, 1, 0], [0, 0, 1, 0, 0, 0, -1, 0, 0], [0, -1, 0, 1, 0, 0, 0, 0, 0]])
_AHEAD, _BEHIND = np.array([1, 2, 0]), np.array([2, 0, 1])


class NoEquilibriumError(RuntimeError):
    """The path from the unloaded rod could not be followed to its end."""


class _Rejected(Exception):
    """A Newton iteration that is no longer sure to stay on its branch."""


@dataclass(frozen=True)
class Sections:
    """Sections of a rod, one row for each abscissa.

    Attributes:
        X: abscissae from 0 at the base to 1 at the tip.
        position: k × 3, m.
        rotation: k × 3 × 3, columns are the section's axes in the world.
        strain: k × 6, [K; Γ].
        internal_wrench: k × 6, [M; N] in section axes. At a point load it is the value on the side of the base.
    """

    X: Array
    position: Array
    rotation: Array
    strain: Array
    internal_wrench: Array


@dataclass(frozen=True)
class ReferenceSolution:
    """An equilibrium.

    Attributes:
        sections: the samples that were asked for.
        tip_position: m.
        tip_rotation: columns are the section's axes in the world.
        base_force: what the clamp exerts on the rod, world axes, N.
        base_moment: likewise about the base point, N m.
        residual: largest violation of the end condition, dimensionless.
        steps: accepted steps of the path to it.
    """

    sections: Sections
    tip_position: Array
    tip_rotation: Array
    base_force: Array
    base_moment: Array
    residual: float
    steps: int
    _problem: _Problem
    _unknown: Array

    def at(self, X: ArrayLike) -> Sections:
        """Sections at any abscissae in [0, 1], in any order, integrated anew from the base."""
        return self._problem.sections(self._unknown, np.atleast_1d(np.asarray(X, dtype=float)))


def solve_by_shooting(
    scene: dict[str, Any],
    samples: int | ArrayLike = 21,
    start_moment: ArrayLike | None = None,
    base_wrench: ArrayLike | None = None,
) -> ReferenceSolution:
    """The equilibrium of a scene of one rod with a free, clamped or pinned tip.

    Args:
        scene: tables of a scene file.
        samples: abscissae of the samples, or how many equidistant ones.
        start_moment: for a held tip, moment in world axes and units of EI/L that bends the unloaded rod where the
            path of the support starts; it selects among several equilibria. By default one that turns the tip by
            about the angle wanted.
        base_wrench: force and moment of the clamp on the rod near the equilibrium, world axes, N and N m: Newton's
            method starts there, and no path is followed.

    Raises:
        ValueError: the scene holds what shooting does not know.
        NoEquilibriumError: where the path ends, as at a limit load, or no equilibrium is near the base wrench.
    """
    unknown_kinds = {entry["kind"] for table in TABLES for entry in scene.get(table, [])} - KNOWN
    if unknown_kinds:
        raise ValueError(f"shooting does not know {', '.join(sorted(unknown_kinds))}")
    problem = _Problem(rod_of(scene))
    start, end = _start(problem, scene, start_moment)
    if base_wrench is None:
        near, steps = _follow(problem, end, start)
    else:
        # The rod's own wrench at its base is opposite to that of the clamp.
        near, steps = -np.asarray(base_wrench, dtype=float) / problem.wrench_units, 0
    unknown, residual = _polish(problem, end, near)
    if base_wrench is not None and _relative(unknown - near, near) > NEAR:
        raise NoEquilibriumError("no equilibrium is near the base wrench")
    X = np.linspace(0, 1, samples) if isinstance(samples, int) else np.asarray(samples, dtype=float)
    tip = problem.sections(unknown, np.ones(1))
    base = -problem.wrench_units * unknown
    return ReferenceSolution(
        sections=problem.sections(unknown, X),
        tip_position=tip.position[0],
        tip_rotation=tip.rotation[0],
        base_force=base[:3],
        base_moment=base[3:],
        residual=residual,
        steps=steps,
        _problem=problem,
        _unknown=unknown,
    )


# The initial value problem


@dataclass(frozen=True)
class _State:
    """A batch of sections, dimensionless: r from the base in L, n in EI/L², m in EI/L."""

    r: NDArray[Any]
    R: NDArray[Any]
    n: NDArray[Any]
    m: NDArray[Any]

    @classmethod
    def of(cls, flat: NDArray[Any]) -> _State:
        rows = flat.reshape(-1, 18)
        return cls(rows[:, :3], rows[:, 3:12].reshape(-1, 3, 3), rows[:, 12:15], rows[:, 15:])

    def flat(self) -> NDArray[Any]:
        return np.concatenate([self.r, self.R.reshape(-1, 9), self.n, self.m], axis=1).ravel()


@dataclass(frozen=True)
class _Problem:
    """A rod in dimensionless variables."""

    rod: RodData

    @cached_property
    def bending(self) -> float:
        """The stiffness EI that loads are measured in: the mean of the admitted ones at the base."""
        compliance = self.rod.compliance(0.0)
        stiffness = [1 / c for c in compliance[:3] if c] or [self.rod.length**2 / c for c in compliance if c]
        return float(np.mean(stiffness))

    @cached_property
    def wrench_units(self) -> Array:
        """N and N m for each unit of the six unknowns."""
        return self.bending / self.rod.length ** np.array([2, 2, 2, 1, 1, 1])

    @cached_property
    def load(self) -> float:
        """About how large all loads are together, dimensionless."""
        X = np.linspace(0, 1, 11)
        spread = [np.abs(self.rod.dead_load(x)) + np.abs(self.rod.follower_load(x)) for x in X]
        total = self.rod.length * np.mean(spread, axis=0)
        total += sum((np.abs([*p.force, *p.moment]) for p in self.rod.points), np.zeros(6))
        return float(np.sum(total / self.wrench_units))

    def strain(self, X: float, state: _State) -> tuple[NDArray[Any], NDArray[Any]]:
        """K L and Γ of a batch."""
        length, compliance, intrinsic = self.rod.length, self.rod.compliance(X), self.rod.intrinsic(X)
        M, N = (state.m[:, None, :] @ state.R)[:, 0], (state.n[:, None, :] @ state.R)[:, 0]
        K = length * intrinsic[:3] + self.bending * compliance[:3] * M
        return K, intrinsic[3:] + self.bending / length**2 * compliance[3:] * N

    def rate(self, X: float, flat: NDArray[Any], factor: float) -> NDArray[Any]:
        """d/dX of a batch, with all loads multiplied by a factor."""
        state = _State.of(flat)
        K, G = self.strain(X, state)
        follower, dead = self.rod.follower_load(X), self.rod.dead_load(X)
        per_length = self.rod.length * factor / self.wrench_units
        force = per_length[:3] * (dead[:3] + state.R @ follower[:3])
        moment = per_length[3:] * (dead[3:] + state.R @ follower[3:])
        r_rate = (state.R @ G[:, :, None])[:, :, 0]
        R_rate = state.R @ (K @ _FLAT_HATS).reshape(-1, 3, 3)
        return _State(r_rate, R_rate, -force, -_cross(r_rate, state.n) - moment).flat()

    def march(self, unknown: NDArray[Any], factor: float, stops: Sequence[float], tolerance: float) -> list[_State]:
        """Integrate a batch of base wrenches from the base; states at ascending stops, before their point loads."""
        state, X, found = self._base(unknown), 0.0, []
        cuts = sorted({*stops, *(load.at for load in self.rod.points)})
        for end in cuts:
            state = self._advance(state, X, end, factor, tolerance)
            if end in stops:
                found.append(state)
            for load in self.rod.points:
                if load.at == end:
                    state = self._take_off(load, state, factor)
            X = end
        return found

    def beyond(self, tip: _State, factor: float) -> _State:
        """The tip once its point loads are taken off."""
        for load in self.rod.points:
            if load.at == 1.0:
                tip = self._take_off(load, tip, factor)
        return tip

    def sections(self, unknown: Array, X: Array) -> Sections:
        """Sections at any abscissae of the loaded rod."""
        stops, order = np.unique(X, return_inverse=True)
        if stops[0] < 0 or stops[-1] > 1:
            raise ValueError(f"X must be in [0, 1], got {stops[0]:g} to {stops[-1]:g}")
        states = self.march(unknown, 1.0, list(map(float, stops)), FINE)
        wrench = [np.concatenate([s.R[0].T @ s.m[0], s.R[0].T @ s.n[0]]) for s in states]
        strain = [np.concatenate(self.strain(x, s), axis=None) for x, s in zip(stops, states, strict=True)]
        units = np.roll(self.wrench_units, 3)
        per_metre = np.repeat([1 / self.rod.length, 1.0], 3)
        position = self.rod.base_position + self.rod.length * np.array([s.r[0] for s in states])
        rotation = np.array([s.R[0] for s in states])
        rows = (position, rotation, np.array(strain) * per_metre, np.array(wrench) * units)
        return Sections(X, *(row[order] for row in rows))

    def _base(self, unknown: NDArray[Any]) -> _State:
        rows = np.atleast_2d(unknown)
        R = np.broadcast_to(self.rod.base_rotation, (len(rows), 3, 3)).astype(rows.dtype)
        return _State(np.zeros((len(rows), 3), rows.dtype), R, rows[:, :3], rows[:, 3:])

    def _advance(self, state: _State, start: float, end: float, factor: float, tolerance: float) -> _State:
        if start == end:
            return state
        span, accuracy = (start, end), {"rtol": tolerance, "atol": tolerance / 10}
        done = solve_ivp(self.rate, span, state.flat(), "DOP853", args=(factor,), **accuracy)
        if not done.success:
            raise _Rejected
        return _State.of(done.y[:, -1])

    def _take_off(self, load: PointLoad, state: _State, factor: float) -> _State:
        turn = state.R if load.follows else np.eye(3)
        force, moment = (
            factor * load.force / self.wrench_units[:3],
            factor * load.moment / self.wrench_units[3:],
        )
        return _State(state.r, state.R, state.n - turn @ force, state.m - turn @ moment)


def _cross(a: NDArray[Any], b: NDArray[Any]) -> NDArray[Any]:
    return a[:, _AHEAD] * b[:, _BEHIND] - a[:, _BEHIND] * b[:, _AHEAD]


# What holds at the tip


class _End(Protocol):
    """What holds at the tip along the path t ∈ [0, 1]; t multiplies all loads too."""

    @property
    def first_step(self) -> float:
        """How far along the path the first step goes."""

    def violation(self, beyond: _State, t: float) -> NDArray[Any]:
        """Six numbers for each state of a batch; zero at the point t of the path."""


@dataclass(frozen=True)
class _FreeTip:
    """Nothing is left once the tip's loads are taken off."""

    first_step: float

    def violation(self, beyond: _State, t: float) -> NDArray[Any]:
        return np.concatenate([beyond.n, beyond.m], axis=1)


@dataclass(frozen=True)
class _HeldTip:
    """The tip goes from a start to where it is held while the loads grow.

    Attributes:
        start: the tip at t = 0.
        position: where the tip is held, dimensionless, from the base.
        rotation: its orientation; None leaves the moment free.
        first_step: of the path.
    """

    start: _State
    position: Array
    rotation: Array | None
    first_step: float = 0.02

    def violation(self, beyond: _State, t: float) -> NDArray[Any]:
        distance = beyond.r - ((1 - t) * self.start.r[0] + t * self.position)
        if self.rotation is None:
            return np.concatenate([distance, beyond.m - (1 - t) * self.start.m[0]], axis=1)
        start, end = Rotation.from_matrix(self.start.R[0]), Rotation.from_matrix(self.rotation)
        wanted = start * Rotation.from_rotvec(t * (start.inv() * end).as_rotvec())
        error = wanted.as_matrix().T @ beyond.R
        return np.concatenate([distance, error[:, _BEHIND, _AHEAD] / 2 - error[:, _AHEAD, _BEHIND] / 2], axis=1)


def _start(problem: _Problem, scene: dict[str, Any], start_moment: ArrayLike | None) -> tuple[Array, _End]:
    """Base wrench of the unloaded rod that the path starts from, and what holds along the path."""
    supports = scene.get("supports", [])
    if not supports:
        return np.zeros(6), _FreeTip(1 / max(problem.load, 1.0))
    (support,) = supports
    position = (np.array(support["position"], dtype=float) - problem.rod.base_position) / problem.rod.length
    rotation = rotation_from_quaternion(support["quaternion"]) if support["kind"] == "clamped" else None
    if start_moment is not None:
        moments = [np.asarray(start_moment, dtype=float)]
    else:
        moments = _moments_towards(problem.rod.base_rotation, position, rotation)
    starts = [np.concatenate([np.zeros(3), moment]) for moment in moments]
    tips = [problem.march(start, 0.0, [1.0], COARSE)[0] for start in starts]
    nearest = int(np.argmin([np.linalg.norm(tip.r[0] - position) for tip in tips]))
    return starts[nearest], _HeldTip(tips[nearest], position, rotation)


def _moments_towards(base: Array, position: Array, rotation: Array | None) -> list[Array]:
    """Base moments that turn the tip of a straight rod about as wanted, either way round."""
    if rotation is not None:
        turn = Rotation.from_matrix(rotation @ base.T).as_rotvec()
    else:
        turn = np.cross(base[:, 2], position / max(float(np.linalg.norm(position)), 1e-9))
        turn *= 2 * np.arccos(np.clip(np.linalg.norm(position), 0, 1)) / max(float(np.linalg.norm(turn)), 1e-9)
    angle = float(np.linalg.norm(turn))
    if angle < 0.5:
        return [-1.5 * base[:, 1]]
    return [turn, turn * (1 - 2 * np.pi / angle)]


# Newton and the path


def _follow(problem: _Problem, end: _End, unknown: Array) -> tuple[Array, int]:
    """Follow the equilibrium from t = 0 to t = 1 with steps that Newton's contraction allows."""
    t, step, steps = 0.0, end.first_step, 0
    previous: tuple[float, Array] | None = None
    while t < 1.0:
        if step < 1e-5:
            raise NoEquilibriumError(f"the path ends at {t:.6g} of the load")
        ahead = min(1.0, t + step)
        guess = unknown if previous is None else unknown + (ahead - t) / (t - previous[0]) * (unknown - previous[1])
        try:
            found, contraction = _corrected(problem, end, guess, ahead)
        except (_Rejected, np.linalg.LinAlgError):
            step = (ahead - t) / 3
            continue
        previous, t, unknown, steps = (t, unknown), ahead, found, steps + 1
        step = step * 2 if contraction < 0.05 else step
    return unknown, steps


def _corrected(problem: _Problem, end: _End, unknown: Array, t: float) -> tuple[Array, float]:
    """Newton that stays on its branch: every correction is small, and a quarter of the one before at most."""
    last, contraction = 1.0, 0.0
    for _ in range(8):
        violation, jacobian = _linearised(problem, end, unknown, t, COARSE)
        correction = _solution(jacobian, -violation)
        size = _relative(correction, unknown)
        if not size <= last:
            raise _Rejected
        unknown = unknown + correction
        if size < 1e-5:
            return unknown, contraction
        if last < 1.0:
            contraction = max(contraction, size / last)
            if contraction > 0.25:
                raise _Rejected
        last = size
    raise _Rejected


def _polish(problem: _Problem, end: _End, unknown: Array) -> tuple[Array, float]:
    """Newton to the last digits at t = 1."""
    last = np.inf
    for _ in range(8):
        violation, jacobian = _linearised(problem, end, unknown, 1.0, FINE)
        correction = _solution(jacobian, -violation)
        size = _relative(correction, unknown)
        if size >= last and last < 1e-9:
            return unknown, float(np.abs(violation).max())
        unknown, last = unknown + correction, size
        if size < 1e-13:
            break
    if last > 1e-9:
        raise NoEquilibriumError(f"Newton stalls at a relative correction of {last:.3g}")
    return unknown, float(np.abs(_linearised(problem, end, unknown, 1.0, FINE)[0]).max())


def _linearised(problem: _Problem, end: _End, unknown: Array, t: float, tolerance: float) -> tuple[Array, Array]:
    """Violation of the end condition and its Jacobian, by complex steps in all six unknowns at once."""
    (tip,) = problem.march(unknown + 1j * _STEP * np.eye(6), t, [1.0], tolerance)
    violations = end.violation(problem.beyond(tip, t), t)
    return violations[0].real, violations.imag.T / _STEP


def _solution(matrix: Array, right: Array) -> Array:
    """Shortest solution: reactions of a planar rod out of its plane stay undetermined."""
    return np.linalg.lstsq(matrix, right, rcond=1e-12)[0]


def _relative(correction: Array, unknown: Array) -> float:
    return float(np.linalg.norm(correction) / (1 + np.linalg.norm(unknown)))
