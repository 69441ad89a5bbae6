"""Rods and loads to test with, and references that share nothing with the package but the conventions.

Strains are evaluated by numpy.polynomial, poses and internal wrenches are integrated by DOP853 element by element.
"""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
from numpy.polynomial import chebyshev, legendre
from scipy.integrate import solve_ivp

from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.rod.igm import InverseGeometricModel
from cosserat_casadi.rod.kinematics import shape
from cosserat_casadi.rod.properties import RodProperties
from cosserat_casadi.rod.rod_motion import FrameMotion, StrainRates
from cosserat_casadi.rod.statics import Statics
from cosserat_casadi.rod.strain import DiscreteRod
from cosserat_casadi.rod.tangent import Tangent
from cosserat_casadi.rod.wrenches import LineWrench, WrenchAt
from tests.reference.rods import hat

HOOKE = np.array([1.0, 1.5, 0.8, 50.0, 60.0, 100.0])
STRAIGHT = ((0.0,), (0.0,), (0.0,), (0.0,), (0.0,), (1.0,))
CURVED = ((0.4, -0.3), (0.5,), (-0.2, 0.1, 0.3), (0.05,), (-0.02, 0.01), (1.1, 0.1))

PLANAR = (0,)
KIRCHHOFF = (0, 1, 2)
REISSNER = (0, 1, 2, 3, 4, 5)

RODS = {
    "planar": PLANAR,
    "twisted": (2,),
    "kirchhoff": KIRCHHOFF,
    "reissner": REISSNER,
    "bent-stretched": (0, 5),
    "odd": (1, 2, 3, 5),
    "sheared": (3, 4),
    "stretched": (5,),
}
"""Strains that a rod admits."""

_VANDER = {"legendre": legendre.legvander, "chebyshev": chebyshev.chebvander}
_TOLERANCES = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-15}


def uniform(diagonal=HOOKE):
    """A Hooke tensor that is the same all along."""
    return lambda X: np.tile(diagonal, (len(X), 1))


def tapered(X):
    """A Hooke tensor of degree four along the rod."""
    radius = (1 - 0.4 * X)[:, None]
    return HOOKE * np.hstack([radius**4] * 3 + [radius**2] * 3)


def rod(admitted=KIRCHHOFF, intrinsic=CURVED, *, length=0.5, basis="legendre", hooke=None):
    return RodProperties("rod", length, tuple(admitted), basis, hooke or uniform(), intrinsic)


def strain_basis(properties, *, modes=3, nodes=12, breaks=(0.0, 1.0), transport="magnus8"):
    per_component = (modes,) * len(properties.admitted) if isinstance(modes, int) else modes
    return DiscreteRod(properties, Discretisation(per_component, nodes, breaks, transport))


def coordinates(basis, seed=0, size=1.0):
    """Seeded strain coordinates of the given size."""
    return size * np.random.default_rng(seed).uniform(-1, 1, basis.size)


def point(at, force=None, moment=None, *, follower=False):
    return WrenchAt(at, *(None if v is None else ca.DM(v) for v in (force, moment)), follower)


def line(basis, force=None, moment=None, *, follower=False):
    """Line wrench whose coefficients multiply Legendre polynomials of 2X − 1."""
    count = (moment if force is None else force).shape[1]
    profiles = legendre.legvander(2 * basis.grid.nodes - 1, count - 1).T
    return LineWrench(*(None if v is None else ca.DM(v) for v in (force, moment)), profiles, follower)


def mixed_loads(basis, *, follower, seed=0, size=1.0):
    """Force and moment at the tip, at every break and along the rod."""
    draw = np.random.default_rng(seed).uniform
    points = [point(at, draw(-size, size, 3), draw(-size, size, 3), follower=follower) for at in basis.grid.breaks[1:]]
    return [*points, line(basis, draw(-size, size, (3, 2)), draw(-size, size, (3, 2)), follower=follower)]


def model(basis, q, wrenches):
    """The inverse geometric model at numbers or symbols q."""
    return InverseGeometricModel(Statics(shape(basis, ca.DM(q) if isinstance(q, np.ndarray) else q), wrenches))


def balance(basis, wrenches):
    """The function q ↦ (residual, Jacobian) of constant loads."""
    q = ca.MX.sym("q", basis.size)
    igm = model(basis, q, wrenches)
    return ca.Function("balance", [q], [ca.densify(igm.residual), ca.densify(Tangent(igm).jacobian)])


def equilibrium(basis, wrenches, start=None):
    """Coordinates of the equilibrium, by full Newton steps to rounding."""
    solve = balance(basis, wrenches)
    q = np.zeros(basis.size) if start is None else start
    for _ in range(30):
        residual, jacobian = (value.full() for value in solve(q))
        step = np.linalg.solve(jacobian, residual).ravel()
        q = q - step
        if np.abs(step).max() < 1e-13:
            break
    assert np.abs(residual).max() < 1e-10
    return q


def element_strain(basis, q, element):
    """The function X ↦ ξ inside one element, from the definition (2.1)–(2.4)."""
    rod, grid = basis.properties, basis.discretisation
    a, b = grid.breaks[element : element + 2]
    degree = max([*grid.modes, *map(len, rod.intrinsic)])
    local = np.cos(np.pi * (np.arange(degree) + 0.5) / degree)
    X = a + (b - a) * (local + 1) / 2
    samples = np.stack([legendre.legval(2 * X - 1, np.array(c)) * np.ones_like(X) for c in rod.intrinsic], axis=1)
    start = 0
    for modes, scale, component in zip(grid.modes, basis.scales, rod.admitted, strict=True):
        own = q[start + element * modes : start + (element + 1) * modes]
        samples[:, component] += scale * _VANDER[rod.basis](local, modes - 1) @ own
        start += modes * grid.elements
    coefficients = np.linalg.solve(legendre.legvander(local, degree - 1), samples)
    return lambda x: legendre.legval(2 * (x - a) / (b - a) - 1, coefficients)


def reference_poses(basis, q, rotation=None):
    """Rotation matrices (M, 3, 3) and positions (M, 3) at the nodes, by DOP853 from the base."""
    length = basis.properties.length
    state = np.concatenate([(np.eye(3) if rotation is None else rotation).ravel(), np.zeros(3)])
    states = []
    for e, X in enumerate(basis.grid.nodes.reshape(basis.grid.elements, -1)):
        strain = element_strain(basis, q, e)

        def rate(x, y, strain=strain):
            R, xi = y[:9].reshape(3, 3), strain(x)
            return length * np.concatenate([(R @ hat(xi[:3])).ravel(), R @ xi[3:]])

        solution = solve_ivp(rate, (X[0], X[-1]), state, t_eval=X, **_TOLERANCES)
        states.append(solution.y.T)
        state = solution.y[:, -1]
    stacked = np.concatenate(states)
    return stacked[:, :9].reshape(-1, 3, 3), stacked[:, 9:]


def _in_body(wrench, R, profile=None):
    """Body coordinates [moment; force] of a wrench at a section."""
    parts = []
    for part in (wrench.moment, wrench.force):
        vector = np.zeros(3) if part is None else part.full()
        vector = vector.ravel() if profile is None else (vector @ profile if vector.ndim == 2 else vector)
        parts.append(vector if wrench.follower else R.T @ vector)
    return np.concatenate(parts)


def reference_wrench(basis, q, wrenches, rotation=None):
    """Λ = [M; N] at the nodes (M, 6): Λ' = ad_ξᵀ Λ − F̄ by DOP853 from the tip to the base."""
    length, width = basis.properties.length, basis.grid.intervals + 1
    lines = [w for w in wrenches if isinstance(w, LineWrench)]
    R = reference_poses(basis, q, rotation)[0][-1]
    wrench = np.zeros(6)
    states = []
    for e in reversed(range(basis.grid.elements)):
        X = basis.grid.nodes[e * width : (e + 1) * width][::-1]
        strain = element_strain(basis, q, e)
        for w in wrenches:
            if isinstance(w, WrenchAt) and w.at == X[0]:
                wrench = wrench + _in_body(w, R)

        def rate(x, y, strain=strain):
            R, M, N, xi = y[:9].reshape(3, 3), y[9:12], y[12:], strain(x)
            K, Gamma = xi[:3], xi[3:]
            load = sum(
                (_in_body(w, R, legendre.legvander(2 * x - 1, w.profiles.shape[0] - 1).ravel()) for w in lines),
                np.zeros(6),
            )
            turned = np.concatenate([-np.cross(K, M) - np.cross(Gamma, N), -np.cross(K, N)])
            return length * np.concatenate([(R @ hat(K)).ravel(), turned - load])

        solution = solve_ivp(rate, (X[0], X[-1]), np.concatenate([R.ravel(), wrench]), t_eval=X, **_TOLERANCES)
        states.append(solution.y.T[::-1])
        R, wrench = solution.y[:9, -1].reshape(3, 3), solution.y[9:, -1]
    return np.concatenate(states[::-1])[:, 9:]


# In motion


def massive(properties, *, rotary=True, damped=False):
    """The same rod with a mass that varies along it, unequal second moments, and damping."""
    return replace(
        properties,
        linear_density=lambda X: 0.9 * (1 - 0.3 * X),
        rotary_inertia=(lambda X: np.outer(1 - 0.3 * X, [0.02, 0.03, 0.045])) if rotary else None,
        damping=(lambda X: np.outer(1 - 0.2 * X, [0.1, 0.2, 0.05, 3.0, 2.0, 4.0])) if damped else None,
    )


def drawn_motion(basis, seed=0, size=1.0, *, ratio=False, moving=True):
    """Seeded strain rates and the seeded motion of a base, as numbers."""
    draw = np.random.default_rng(seed).uniform
    velocity, acceleration = draw(-size, size, (2, basis.size))
    base = draw(-size, size, (4, 3)) if moving else np.zeros((4, 3))
    ratios = [ca.DM(0.4 * size), ca.DM(-0.7 * size)] if ratio else [None, None]
    rates = StrainRates(ca.DM(velocity), ca.DM(acceleration), *ratios)
    return rates, FrameMotion(*map(ca.DM, base))


def reference_motion(basis, q, rates, base, ratio=1.0):
    """Velocity, angular velocity, acceleration, angular acceleration at the nodes, (M, 3) each, and the kinetic energy.

    Body twists η = [Ω; V] by DOP853: η' = −ad_ξ η + ξ̇ and η̇' = −ad_ξ η̇ − ad_ξ̇ η + ξ̈ with ξ per reference length. All
    in the axes of the base. The energy is that of the continuous rod: ½ ∫ ρA V·V + Ω·J Ω, one more state.
    """
    length, rod = basis.properties.length, basis.properties
    ratio_rates = [0.0 if r is None else float(r) for r in (rates.ratio_rate, rates.ratio_acceleration)]
    factors = [ratio, *ratio_rates]
    coordinates_of = [q, rates.velocity.full().ravel(), rates.acceleration.full().ravel()]
    omega, alpha = base.angular_velocity.full().ravel(), base.angular_acceleration.full().ravel()
    speed = base.velocity.full().ravel()
    relative = base.acceleration.full().ravel() - np.cross(omega, speed)
    state = np.concatenate([np.eye(3).ravel(), omega, speed, alpha, relative, [0.0]])
    states = []
    for e, X in enumerate(basis.grid.nodes.reshape(basis.grid.elements, -1)):
        still = element_strain(basis, np.zeros(basis.size), e)
        moved = [element_strain(basis, c, e) for c in coordinates_of]

        def rate(x, y, still=still, moved=moved):
            unloaded = still(x)
            strains = [f * unloaded + m(x) - unloaded for f, m in zip(factors, moved, strict=True)]
            xi, xi_rate = (_little_adjoint(s) for s in strains[:2])
            R, eta, eta_rate = y[:9].reshape(3, 3), y[9:15], y[15:21]
            first = strains[1] - xi @ eta
            second = strains[2] - xi @ eta_rate - xi_rate @ eta
            at = np.array([x])
            energy = 0.0
            if rod.linear_density is not None:
                energy = rod.linear_density(at)[0] * eta[3:] @ eta[3:]
            if rod.rotary_inertia is not None:
                energy = energy + rod.rotary_inertia(at)[0] @ eta[:3] ** 2
            return length * np.concatenate([(R @ hat(strains[0][:3])).ravel(), first, second, [ratio * energy / 2]])

        solution = solve_ivp(rate, (X[0], X[-1]), state, t_eval=X, **_TOLERANCES)
        states.append(solution.y.T)
        state = solution.y[:, -1]
    stacked = np.concatenate(states)
    R = stacked[:, :9].reshape(-1, 3, 3)
    spin, speed, spin_rate, speed_rate = (stacked[:, k : k + 3] for k in (9, 12, 15, 18))
    along = [speed, spin, speed_rate + np.cross(spin, speed), spin_rate]
    return [np.einsum("kij,kj->ki", R, v) for v in along], stacked[-1, -1]


def _little_adjoint(twist):
    """ad_ξ = [K^, 0; Γ^, K^]."""
    K, Gamma = hat(twist[:3]), hat(twist[3:])
    return np.block([[K, np.zeros((3, 3))], [Gamma, K]])
