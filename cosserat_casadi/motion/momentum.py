"""The momentum of a rod that flies free, put right after each step: exact to rounding, not to the order of the steps.

The position of the base and the strains are coordinates, and momentum is no quadratic function of them, so that no
method of collocation keeps it. What a step misses is that of a small rigid motion: added to the velocities, it leaves
the strains and their rates as they are. What momentum has to become is what it was, plus the impulse of the loads by
the quadrature of the step, which has the order of the step.
"""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.motion.moving_inputs import Piece
from cosserat_casadi.motion.repeated_call import RepeatedCall
from cosserat_casadi.numerics.motion_equations import Instant
from cosserat_casadi.numerics.step import Step, stages_of

MOST_CORRECTIONS = 8
"""Most corrections of the velocities after one step."""

ROUNDING = 8.0 * float(np.finfo(np.float64).eps)
"""Momentum, relative to the largest entry, that is rounding and not missing."""

CONTRACTING = 0.1
"""What a correction may leave of the momentum that was missing before the derivatives it is made by count as old."""


def flies_free(model: Model) -> bool:
    """Whether a scene is one rod that nothing holds."""
    kinds = {block.kind for block in model.discrete.unknowns.blocks}
    frames = [block for block, _ in model.discrete.unknowns.of_kind(BlockKind.POSE)]
    return len(model.discrete.rods) == 1 and len(frames) == 1 and BlockKind.MULTIPLIER not in kinds


class MomentumKeeper:
    """What puts the velocities of a free rod right after a step.

    Args:
        model: one rod that flies free.
    """

    def __init__(self, model: Model) -> None:
        self._loaded = bool(model.scene.loads)
        ((_, self._pose),) = model.discrete.unknowns.of_kind(BlockKind.POSE)
        self._units = np.eye(model.size)[:, self._pose]
        momentum, self._rate = _functions(model)
        self._momentum = RepeatedCall(momentum)
        self._momenta = momentum.map(self._units.shape[1])
        self._inverse: FloatArray | None = None

    def settled(self, step: Step, piece: Piece) -> Instant:
        """The end of a step, in a piece of the inputs, with the momentum that it has to have."""
        wanted = self._momentum_of(step.start, piece) + self._impulse(step, piece)
        rounding = ROUNDING * np.abs(wanted).max()
        before = 0.0
        end = step.end
        for _ in range(MOST_CORRECTIONS):
            missing = wanted - self._momentum_of(end, piece)
            largest = float(np.abs(missing).max())
            if largest <= rounding:
                break
            inverse: FloatArray | None = self._inverse
            if inverse is None or largest > CONTRACTING * before > 0.0:
                # The least rates: none along the norm of the quaternion, which no momentum belongs to.
                inverse = np.asarray(np.linalg.pinv(self._by_pose(end, piece)), dtype=np.float64)
                self._inverse = inverse
            before = largest
            v = end.v.copy()
            v[self._pose] += inverse @ missing
            end = replace(end, v=v)
        return end

    def _impulse(self, step: Step, piece: Piece) -> FloatArray:
        """Impulse of the loads in a step, shape (6,), N s and N m s; nothing else acts from outside."""
        if not self._loaded:
            return np.zeros(6)
        stages = stages_of(step.method, step.differential, step.start, step.size, step.unknowns)
        rates = []
        for time, x, v, a in zip(stages.times, stages.x, stages.v, stages.a, strict=True):
            rates.append(self._rate(x, v, a, *piece.at(float(time))).full()[:, 0])
        return np.asarray(step.size * (step.method.weights @ np.stack(rates)))

    def _momentum_of(self, instant: Instant, piece: Piece) -> FloatArray:
        """Momentum and angular momentum, shape (6,), N s and N m s."""
        inputs = piece.at(instant.time)
        return self._momentum(instant.x, instant.v, inputs.value, inputs.rate)

    def _by_pose(self, instant: Instant, piece: Piece) -> FloatArray:
        """Derivative of momentum, which is linear in velocities, with those of the base, shape (6, 7)."""
        value = piece.at(instant.time).value
        return np.asarray(self._momenta(instant.x, self._units, value, np.zeros(len(value))).full())


def _functions(model: Model) -> tuple[ca.Function, ca.Function]:
    """Momentum (x, v, inputs, rate), and its rate along a motion (x, v, a, inputs, rate, acceleration), 6×1 each."""
    x, v, a = (ca.MX.sym(name, model.size) for name in ("x", "v", "a"))
    inputs, rate, acceleration = (ca.MX.sym(name, model.inputs.size) for name in ("inputs", "rate", "acceleration"))
    momentum = ca.vertcat(*model.momentum(x, v, inputs, rate))
    directions = ((x, v), (v, a), (inputs, rate), (rate, acceleration))
    along = sum(ca.jtimes(momentum, argument, direction) for argument, direction in directions)
    return (
        ca.Function("momentum", [x, v, inputs, rate], [ca.densify(momentum)]),
        ca.Function("momentum_rate", [x, v, a, inputs, rate, acceleration], [along]),
    )
