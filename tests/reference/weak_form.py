"""The weak form of equilibrium, evaluated anew: numpy alone, on the strain field and clamp wrench that are claimed.

From the base: rotation matrices by Magnus steps of fourth order on a fine even grid, positions and the world balance
n' = −f̄, m' = −r' × n − l̄ by Simpson's rule. The stress that the strain asks for, H Δξ and what is beside it, must
equal the section's wrench in the mean over every polynomial that the strain may have; what is left at the tip must be
its load. No Chebyshev grid, no quaternion, no code of the package.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray
from scipy.integrate import cumulative_simpson, simpson

from .rods import Array, RodData

FEWEST, MOST = 200, 6000
"""Steps of an element."""

KNOWN = 1e-7
"""Share of a stiffness, beside strains of about one, below whose hundred-millionth a stress is rounding."""

GAUSS = np.array([0.5 - np.sqrt(3) / 6, 0.5 + np.sqrt(3) / 6])


@dataclass(frozen=True)
class Violation:
    """How far a claim is from equilibrium.

    Attributes:
        weak: largest mean of H Δξ − Λ over a polynomial of the strain, relative to the largest stress of its kind plus
            EI/L or EI/L².
        tip: what is left at a free tip, relative likewise.
        position: of the tip, in the world, m.
        rotation: of the tip, columns are the section's axes.
    """

    weak: float
    tip: float
    position: Array
    rotation: Array


@dataclass(frozen=True)
class Claim:
    """What a solver says.

    Attributes:
        strain: X ↦ ξ at abscissae (k,), seen from the element that they end, shape (k, 6).
        force: of the clamp on the rod, world axes.
        moment: likewise, about the base point.
        breaks: ends of the elements, from 0 to 1.
        modes: polynomials of each admitted strain.
    """

    strain: Callable[[Array], Array]
    force: Array
    moment: Array
    breaks: Sequence[float]
    modes: Sequence[int]


@dataclass(frozen=True)
class _Piece:
    """An element on its grid: abscissae, positions, rotations, world force and moment, strain, residual stress."""

    X: Array
    r: Array
    R: Array
    n: Array
    m: Array
    strain: Array


def violation(rod: RodData, claim: Claim, bending: float, held: str | None = None) -> Violation:
    """Evaluate the weak form.

    Args:
        rod: what the scene says.
        claim: what the solver says.
        bending: EI, to measure by.
        held: None for a free tip, "pinned" for a free moment, "clamped" for neither.
    """
    units = bending / rod.length ** np.array([1, 1, 1, 2, 2, 2])
    start = (rod.base_position, rod.base_rotation, -claim.force, -claim.moment)
    pieces = []
    for a, b in pairwise(claim.breaks):
        piece = _march(rod, claim, a, b, start)
        pieces.append(piece)
        start = _beyond(rod, b, (piece.r[-1], piece.R[-1], piece.n[-1], piece.m[-1]))
    stresses = [_stresses(rod, piece) for piece in pieces]
    largest = np.max([np.abs(wrench).max(axis=0) for _, wrench in stresses], axis=0)
    # Strains near one are known to rounding alone, which a large stiffness makes a large stress.
    hooke = np.divide(1.0, rod.compliance(0.0), out=np.zeros(6), where=rod.admitted)
    size = units + np.repeat([largest[:3].max(), largest[3:].max()], 3) + [0, 0, 0, *(KNOWN * hooke[3:])]
    worst = 0.0
    for piece, (elastic, wrench) in zip(pieces, stresses, strict=True):
        local = 2 * (piece.X - piece.X[0]) / (piece.X[-1] - piece.X[0]) - 1
        for c, modes in zip(np.flatnonzero(rod.admitted), claim.modes, strict=True):
            waves = legendre.legvander(local, modes - 1) * (elastic - wrench)[:, [c]] / size[c]
            worst = max(worst, float(np.abs(simpson(waves, x=local, axis=0)).max()) / 2)
    r, R, n, m = start
    left = {None: [*m, *n], "pinned": [*m], "clamped": []}[held]
    tip = np.abs(np.array(left) / size[: len(left)]).max(initial=0.0)
    return Violation(worst, float(tip), r, R)


def _march(rod: RodData, claim: Claim, a: float, b: float, start: tuple[Array, ...]) -> _Piece:
    """One element from its base."""
    r0, R0, n0, m0 = start
    probe = claim.strain(np.linspace(a, b, 65)[1:])
    turn = rod.length * (b - a) * np.linalg.norm(probe[:, :3], axis=1).mean()
    steps = 2 * int(np.clip(30 * turn + 12 * max(claim.modes), FEWEST, MOST) / 2)
    X = np.linspace(a, b, steps + 1)
    # The first abscissa of an element ends the one before: step inside by rounding.
    strain = claim.strain(np.concatenate([[a + 1e-13 * (b - a)], X[1:]]))
    R = _rotations(rod, claim, X, R0)
    rate = rod.length * (R @ strain[:, 3:, None])[:, :, 0]
    r = r0 + _integral(rate, X)
    dead, follower = (np.array([load(x) for x in X]) for load in (rod.dead_load, rod.follower_load))
    force = rod.length * (dead[:, :3] + (R @ follower[:, :3, None])[:, :, 0])
    couple = rod.length * (dead[:, 3:] + (R @ follower[:, 3:, None])[:, :, 0])
    n = n0 - _integral(force, X)
    m = m0 - _integral(np.cross(rate, n) + couple, X)
    return _Piece(X, r, R, n, m, strain)


def _integral(rate: Array, X: Array) -> Array:
    return np.asarray(cumulative_simpson(rate, x=X, axis=0, initial=0.0))


def _rotations(rod: RodData, claim: Claim, X: Array, R0: Array) -> Array:
    """Rotations at the abscissae, (k, 3, 3)."""
    h = np.diff(X)
    inner = claim.strain((X[:-1, None] + h[:, None] * GAUSS).ravel()).reshape(-1, 2, 6)[:, :, :3]
    scaled = inner * (rod.length * h)[:, None, None]
    turns = scaled.mean(axis=1) - np.sqrt(3) / 12 * np.cross(scaled[:, 1], scaled[:, 0])
    R = np.empty((len(X), 3, 3))
    R[0] = R0
    for i, step in enumerate(_exponentials(turns)):
        R[i + 1] = R[i] @ step
    return R


def _exponentials(turns: Array) -> Array:
    """Rodrigues' formula for rows of rotation vectors."""
    angle = np.linalg.norm(turns, axis=1)[:, None, None]
    hats = np.cross(np.eye(3), turns[:, None])
    return np.eye(3) + np.sinc(angle / np.pi) * hats + np.sinc(angle / (2 * np.pi)) ** 2 / 2 * hats @ hats


def _beyond(rod: RodData, X: float, state: tuple[Array, ...]) -> tuple[Array, ...]:
    """The state behind the point loads at an abscissa."""
    r, R, n, m = state
    for load in rod.points:
        if load.at == X:
            turn = R if load.follows else np.eye(3)
            n, m = n - turn @ load.force, m - turn @ load.moment
    return r, R, n, m


def _stresses(rod: RodData, piece: _Piece) -> tuple[Array, Array]:
    """Stress of the strain, zero where it is not admitted, and the section's wrench, both (k, 6) in section axes."""
    compliance = np.array([rod.compliance(x) for x in piece.X])
    moved = piece.strain - np.array([rod.intrinsic(x) for x in piece.X])
    elastic = np.divide(moved, compliance, out=np.zeros_like(moved), where=rod.admitted)
    if rod.beyond is not None:
        elastic += np.where(rod.admitted, rod.beyond(moved, piece.X), 0.0)
    back = np.swapaxes(piece.R, 1, 2)
    wrench: NDArray[Any] = np.concatenate(
        [(back @ piece.m[:, :, None])[..., 0], (back @ piece.n[:, :, None])[..., 0]], 1
    )
    return elastic, wrench
