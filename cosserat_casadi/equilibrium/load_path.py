"""Paths that a model offers to a continuation: all loads growing from zero, or inputs changing to others."""

from __future__ import annotations

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.numerics.broyden import Jacobian
from cosserat_casadi.numerics.continuation import Path

FORCE_SHARE = 0.1
"""Bending by a joint's multiplier or a tension of one unit: about a radian at Euler's load, π² EI/ℓ²."""

SUPPORT_SHARE = 2.0
"""The same for multipliers of supports: a rod that is drawn to a place has many equilibria there, near each other."""

FIRST = 0.25
"""Longest first step where frames move: the springs have fallen to (3/4)³ then."""


def load_path(model: Model, inputs: FloatArray) -> Path:
    """From the unloaded scene to the scene, all loads growing together."""
    none = np.zeros(model.inputs.size)
    return Path(
        residual=lambda x, t: column(model.path_residual(x, inputs, t)),
        jacobian=lambda x, t: _matrix(model, model.path_jacobian(x, inputs, t)),
        rate=lambda x, t: column(model.path_rate(x, inputs, t, none, 1.0)),
        start=model.unloaded(),
        tangent=column(model.path_tangent(inputs)),
        shares=step_shares(model),
        first=first_step(model),
    )


def input_path(model: Model, start: FloatArray, before: FloatArray, after: FloatArray) -> Path:
    """From an equilibrium of the scene to other inputs, on the straight line between them."""
    change = after - before

    def at(t: float) -> FloatArray:
        # Exact at both ends, however far apart they are.
        return (1.0 - t) * before + t * after

    return Path(
        residual=lambda x, t: column(model.path_residual(x, at(t), 1.0)),
        jacobian=lambda x, t: _matrix(model, model.path_jacobian(x, at(t), 1.0)),
        rate=lambda x, t: column(model.path_rate(x, at(t), 1.0, change, 0.0)),
        start=start,
        shares=step_shares(model),
    )


def first_step(model: Model) -> float:
    """Longest first step of the load path: where rods need not fit, the springs (1 − t)³ are no straight line."""
    return FIRST if model.discrete.couplings.moving else 1.0


def step_shares(model: Model) -> FloatArray:
    """How much each unknown counts in the length of a step, shape (size,); forces by a share."""
    discrete, shares = model.discrete, np.ones(model.size)
    forces = [*discrete.tie_slices.values(), *discrete.tension_slices]
    for share, places in ((SUPPORT_SHARE, discrete.hold_slices), (FORCE_SHARE, forces)):
        for place in places:
            shares[place] = share
    return shares


def is_shape(model: Model) -> npt.NDArray[np.bool_]:
    """Which unknowns are strains or poses of frames, not multipliers or tensions, shape (size,)."""
    discrete = model.discrete
    shape = np.zeros(model.size, dtype=np.bool_)
    for place in (*discrete.rod_slices.values(), *discrete.moving_slices.values()):
        shape[place] = True
    return shape


def _matrix(model: Model, jacobian: ca.DM) -> Jacobian:
    """A Jacobian as it is solved with: sparse where ties make an assembly, dense where rods are alone."""
    return jacobian if model.discrete.couplings.ties else np.asarray(jacobian.full())


def column(vector: ca.DM) -> FloatArray:
    """A CasADi vector as an array, shape (n,)."""
    return np.asarray(vector.full()[:, 0]) if vector.shape[0] else np.zeros(0)
