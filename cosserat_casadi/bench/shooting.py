"""One rod by shooting, from the strong form: a second opinion that shares no discretisation with the package.

    r' = ℓ R Γ,  R' = ℓ R K^,  n' = −ℓ f̄,  m' = −r' × n − ℓ l̄,  K = K⁰ + M/H,  Γ = Γ⁰ + N/H,  M = Rᵀm,  N = Rᵀn

Strains that are not admitted keep their intrinsic values. Unknown is the wrench at the base, found by Newton with exact
Jacobians (complex steps through DOP853). Stiffness, density and unloaded strain are read from the same records as the
model; rotations, integrals, balance and the search are not. A start says which of several equilibria is meant.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt
from numpy.polynomial import legendre

from cosserat_casadi import scene as scenes
from cosserat_casadi.errors import CosseratError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.scene_rods import base_pose
from cosserat_casadi.rod.properties import RodProperties

RELATIVE = 1e-13
"""Relative tolerance of the integrator, and of Newton's last correction."""

ABSOLUTE = 1e-14
"""Absolute tolerance of the integrator, on variables without unit."""

STEP = 1e-30
"""Imaginary step of a derivative."""

NEAR = 1e-2
"""Largest first correction of the base wrench, relative: beyond, Newton may be on its way to another equilibrium."""

CORRECTIONS = 8
"""Most Newton corrections."""

CONVERGED = 1e-9
"""Largest relative size of the last correction."""

KINDS = ("gravity", "tip_wrench", "point_wrench", "distributed_wrench")
"""Loads that shooting knows."""

SUPPORTS = ("clamped", "pinned")
"""Supports that shooting knows."""

Values = dict[str, dict[str, FloatArray]]
"""Magnitudes of every load, (3, k), by load and field."""

Batch = npt.NDArray[Any]
"""Rows of real or complex numbers."""


class ShootingError(CosseratError):
    """Shooting cannot do this scene, or Newton did not converge."""

    page = "accuracy"


class BenchUnavailableError(CosseratError):
    """SciPy is not installed."""

    page = "accuracy"

    def __init__(self) -> None:
        super().__init__("the bench needs scipy: install it with  pip install 'cosserat-casadi[bench]'")


def check_scipy() -> None:
    """Refuse to begin without the integrator.

    Raises:
        BenchUnavailableError: SciPy is not installed.
    """
    try:
        import scipy.integrate  # noqa: F401
    except ImportError as missing:
        raise BenchUnavailableError from missing


@dataclass(frozen=True)
class RodState:
    """What of a rod is compared: poses of sections, and the wrench of its clamp.

    Attributes:
        length: undeformed length, m.
        position: shape (k, 3), m.
        rotation: shape (k, 3, 3), world_R_section.
        base_wrench: force and moment of the clamp on the rod about the base point, world axes, shape (6,), N and N m.
    """

    length: float
    position: FloatArray
    rotation: FloatArray
    base_wrench: FloatArray


def shoot(
    scene: scenes.Scene, properties: RodProperties, values: Values, X: Sequence[float], start: FloatArray
) -> RodState:
    """The equilibrium of one rod of a scene.

    Args:
        scene: the scene; what rods do not share with each other is read from it.
        properties: the rod.
        values: magnitudes of every load.
        X: ascending abscissae of the sections wanted, the last one 1.
        start: clamp wrench near the wanted one, shape (6,), N and N m.

    Raises:
        ShootingError: the scene holds what shooting does not know, or Newton does not converge near the start.
    """
    problem = _Problem(scene, properties, values)
    # The rod's own wrench at its base is opposite to that of the clamp.
    base_wrench = _newton(problem, -start / problem.units)
    states = problem.march(base_wrench[None, :], X)
    positions = [problem.origin + properties.length * state.r[0] for state in states]
    rotations = [state.R[0] for state in states]
    return RodState(
        length=properties.length,
        position=np.array(positions),
        rotation=np.array(rotations),
        base_wrench=-base_wrench * problem.units,
    )


@dataclass(frozen=True)
class _State:
    """A batch of sections without unit: r from the base in ℓ, n in EI/ℓ², m in EI/ℓ."""

    r: Batch
    R: Batch
    n: Batch
    m: Batch

    @classmethod
    def of(cls, flat: Batch) -> _State:
        rows = flat.reshape(-1, 18)
        return cls(
            r=rows[:, :3],
            R=rows[:, 3:12].reshape(-1, 3, 3),
            n=rows[:, 12:15],
            m=rows[:, 15:],
        )

    def flat(self) -> Batch:
        """All numbers in a row, section after section."""
        matrices = self.R.reshape(-1, 9)
        rows = np.concatenate([self.r, matrices, self.n, self.m], axis=1)
        return rows.ravel()


@dataclass(frozen=True)
class _Problem:
    scene: scenes.Scene
    rod: RodProperties
    values: Values

    def __post_init__(self) -> None:
        kinds = {load.kind for load in self.scene.loads}
        unknown: list[str] = sorted(kinds - set(KINDS))
        unknown += sorted({support.kind for support in self.scene.supports} - set(SUPPORTS))
        unknown += [key for key in ("actuators", "bodies", "joints") if getattr(self.scene, key, ())]
        if unknown:
            raise ShootingError(f"shooting does not know {', '.join(unknown)}")

    @cached_property
    def units(self) -> FloatArray:
        """N and N m for each unit of the six unknowns."""
        # EI/ℓ² for forces, EI/ℓ for moments.
        powers = np.array([2.0, 2, 2, 1, 1, 1])
        return self.rod.bending_stiffness / self.rod.length**powers

    @cached_property
    def _record(self) -> scenes.Rod:
        named = (rod for rod in self.scene.rods if rod.name == self.rod.name)
        return next(named)

    @property
    def origin(self) -> FloatArray:
        """World position of the base, m."""
        return base_pose(self._record)[0]

    @cached_property
    def turn(self) -> FloatArray:
        """world_R_section of the base."""
        _, quaternion = base_pose(self._record)
        return _matrix(quaternion)

    @cached_property
    def support(self) -> Any:
        """What holds the tip; None where it is free."""
        supports = (support for support in self.scene.supports if support.rod == self.rod.name)
        return next(supports, None)

    @cached_property
    def points(self) -> list[Any]:
        """Loads on single sections."""
        wrenches = [load for load in self.scene.loads if load.kind in ("tip_wrench", "point_wrench")]
        return [load for load in wrenches if load.rod == self.rod.name]

    @cached_property
    def lines(self) -> list[Any]:
        """Loads per length."""
        spread = [load for load in self.scene.loads if load.kind == "distributed_wrench"]
        return [load for load in spread if load.rod == self.rod.name]

    @cached_property
    def acceleration(self) -> FloatArray:
        """Sum of the fields that weigh the rod, m/s²."""
        total = np.zeros(3)
        for load in self.scene.loads:
            if load.kind == "gravity" and load.acts_on_rod(self.rod.name):
                total = total + self.values[load.name]["acceleration"][:, 0]
        return total

    def strain(self, X: float, state: _State) -> tuple[Batch, Batch]:
        """K ℓ and Γ of a batch."""
        section = np.array([X])
        length = self.rod.length
        stiffness = self.rod.bending_stiffness
        # Moment and force in section axes: world vectors times world_R_section.
        moment = _dot(state.m, state.R)
        force = _dot(state.n, state.R)
        wrench = np.concatenate([moment, force], axis=1)
        # A strain that is not admitted does not yield.
        compliance = np.zeros(6)
        admitted = list(self.rod.admitted)
        compliance[admitted] = 1 / self.rod.hooke(section)[0, admitted]
        scale = compliance * np.repeat([stiffness, stiffness / length**2], 3)
        intrinsic = self.rod.intrinsic_strain(section)[0] * np.repeat([length, 1.0], 3)
        strain = intrinsic + scale * wrench
        return strain[:, :3], strain[:, 3:]

    def line_wrench(self, X: float, R: Batch) -> tuple[Batch, Batch]:
        """Force and moment per length on a batch, world axes, N/m and N."""
        force = np.zeros(R.shape[:2], R.dtype)
        moment = np.zeros(R.shape[:2], R.dtype)
        if self.rod.linear_density is not None:
            density = self.rod.linear_density(np.array([X]))[0]
            force = force + density * self.acceleration
        for load in self.lines:
            coefficients = self.values[load.name]
            load_force = legendre.legval(2 * X - 1, coefficients["force"].T)
            load_moment = legendre.legval(2 * X - 1, coefficients["moment"].T)
            if load.frame == "body":
                load_force = R @ load_force
                load_moment = R @ load_moment
            force = force + load_force
            moment = moment + load_moment
        return force, moment

    def rate(self, X: float, flat: Batch) -> Batch:
        """d/dX of a batch."""
        state = _State.of(flat)
        K, G = self.strain(X, state)
        force, moment = self.line_wrench(X, state.R)
        # r' = R Γ, R' = R K̂, n' = −l, m' = −r' × n − c, here without unit (docs/theory.md, sections 4 to 6).
        r_rate = (state.R @ G[:, :, None])[:, :, 0]
        # Rows of R crossed with K are rows of R K̂.
        R_rate = np.cross(state.R, K[:, None, :])
        length = self.rod.length
        n_rate = -length * force / self.units[:3]
        m_rate = -np.cross(r_rate, state.n) - length * moment / self.units[3:]
        rates = _State(r_rate, R_rate, n_rate, m_rate)
        return rates.flat()

    def march(self, unknown: Batch, stops: Sequence[float]) -> list[_State]:
        """States of a batch of base wrenches at ascending stops, point loads there taken off."""
        count = len(unknown)
        state = _State(
            r=np.zeros((count, 3), unknown.dtype),
            R=np.broadcast_to(self.turn, (count, 3, 3)).astype(unknown.dtype),
            n=unknown[:, :3],
            m=unknown[:, 3:],
        )
        # The integrator stops at every jump.
        jumps = [getattr(load, "at", 1.0) for load in self.points]
        states = []
        X = 0.0
        for end in sorted({*stops, *jumps}):
            advanced = self._advanced(state, X, end)
            state = self._taken_off(advanced, end)
            X = end
            if end in stops:
                states.append(state)
        return states

    def _advanced(self, state: _State, start: float, end: float) -> _State:
        from scipy.integrate import solve_ivp

        result = solve_ivp(
            self.rate,
            (start, end),
            state.flat(),
            "DOP853",
            rtol=RELATIVE,
            atol=ABSOLUTE,
        )
        if not result.success:
            raise ShootingError("the integrator stops short of the tip")
        return _State.of(result.y[:, -1])

    def _taken_off(self, state: _State, X: float) -> _State:
        """The state behind the point loads at X."""
        n = state.n
        m = state.m
        for load in self.points:
            if getattr(load, "at", 1.0) != X:
                continue
            force = self.values[load.name]["force"][:, 0] / self.units[:3]
            moment = self.values[load.name]["moment"][:, 0] / self.units[3:]
            world_R_axes = state.R if load.frame == "body" else np.eye(3)
            n = n - world_R_axes @ force
            m = m - world_R_axes @ moment
        return _State(state.r, state.R, n, m)

    def violation(self, tip: _State) -> Batch:
        """Six numbers for each state of a batch, zero where the tip's condition is met."""
        if self.support is None:
            # Behind all point loads nothing is left at a free tip.
            return np.concatenate([tip.n, tip.m], axis=1)
        from_base = np.asarray(self.support.position) - self.origin
        gap = tip.r - from_base / self.rod.length
        if self.support.kind == "pinned":
            return np.concatenate([gap, tip.m], axis=1)
        rotation_error = _matrix(np.asarray(self.support.quaternion)).T @ tip.R
        # The axial vector of the skew part: sin θ times the axis.
        skew = rotation_error - np.swapaxes(rotation_error, 1, 2)
        axial = skew[:, (2, 0, 1), (1, 2, 0)] / 2
        return np.concatenate([gap, axial], axis=1)


def _newton(problem: _Problem, base_wrench: FloatArray) -> FloatArray:
    """Base wrench, without unit; the last digits are found by corrections until they stop to shrink."""
    last_size = NEAR
    for _ in range(CORRECTIONS):
        # Complex steps: the imaginary parts are derivatives to all digits, with no difference of near numbers.
        perturbed = base_wrench + 1j * STEP * np.eye(6)
        (tip,) = problem.march(perturbed, [1.0])
        violation = problem.violation(tip)
        jacobian = violation.imag.T / STEP
        # Shortest: reactions that a planar rod leaves undetermined stay as they are.
        correction = np.linalg.lstsq(jacobian, -violation[0].real, rcond=1e-12)[0]
        size = float(np.linalg.norm(correction) / (1 + np.linalg.norm(base_wrench)))
        # Written so that a size which is not a number ends it.
        if not size <= last_size:
            break
        base_wrench = base_wrench + correction
        last_size = size
        if size < RELATIVE:
            break
    if last_size > CONVERGED:
        raise ShootingError("Newton does not converge near the start")
    return base_wrench


def _dot(vectors: Batch, R: Batch) -> Batch:
    """Rᵀ v of a batch."""
    return (vectors[:, None, :] @ R)[:, 0]


def _matrix(quaternion: FloatArray) -> FloatArray:
    """Rotation matrix of a unit quaternion w, x, y, z: v ↦ v + 2 w (u × v) + 2 u × (u × v)."""
    w = quaternion[0]
    u = quaternion[1:]
    identity = np.eye(3)
    # Row i of these is u × eᵢ and u × (u × eᵢ): columns of the matrix.
    once = np.cross(u, identity)
    twice = np.cross(u, once)
    return np.asarray((identity + 2 * w * once + 2 * twice).T)
