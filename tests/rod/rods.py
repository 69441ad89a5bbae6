"""Rods and loads to test with, and references that share nothing with the package but the conventions.

Strains are evaluated by numpy.polynomial, poses and internal wrenches are integrated by DOP853 element by element.
"""

from __future__ import annotations

import casadi as ca
import numpy as np
from numpy.polynomial import chebyshev, legendre
from scipy.integrate import solve_ivp

from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.rod.igm import InverseGeometricModel
from cosserat_casadi.rod.kinematics import shape
from cosserat_casadi.rod.properties import RodProperties
from cosserat_casadi.rod.statics import Statics
from cosserat_casadi.rod.strain import DiscreteRod
from cosserat_casadi.rod.tangent import Tangent
from cosserat_casadi.rod.wrenches import LineWrench, PointWrench

HOOKE = np.array([1.0, 1.5, 0.8, 50.0, 60.0, 100.0])
STRAIGHT = ((0.0,), (0.0,), (0.0,), (0.0,), (0.0,), (1.0,))
CURVED = ((0.4, -0.3), (0.5,), (-0.2, 0.1, 0.3), (0.05,), (-0.02, 0.01), (1.1, 0.1))

PLANAR = (0,)
KIRCHHOFF = (0, 1, 2)
REISSNER = (0, 1, 2, 3, 4, 5)

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
    return PointWrench(at, *(None if v is None else ca.DM(v) for v in (force, moment)), follower)


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


def hat(v):
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


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
            if isinstance(w, PointWrench) and w.at == X[0]:
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
