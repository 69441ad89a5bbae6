"""Correction of the momentum of free rods and bodies after each step: exact to rounding, not to the order of steps.

The unknowns are positions of bases and strains, of which momentum is no quadratic function, so that no collocation
method conserves it. The error of a step is compensated by the momentum of a small rigid motion of all rods and bodies
together: added to the velocities, it leaves strains, joints and their rates unchanged. The momentum after the step is
then the momentum before it plus the impulse of the loads by the quadrature of the step, which has the order of the
step.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import casadi as ca
import numpy as np

from cosserat_casadi.maths.rotation import cross_matrix
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.motion.moving_inputs import Piece
from cosserat_casadi.motion.repeated_call import repeated
from cosserat_casadi.numerics.consistent_start import regular_inverse
from cosserat_casadi.numerics.motion_equations import Instant
from cosserat_casadi.numerics.step import TimeStep
from cosserat_casadi.scene import Scene

MOMENTA = 6
"""Number of entries of momentum and angular momentum together."""

OF_A_BODY = [0, 3, 4, 5]
"""Rigid motions whose momenta determine those of all six: mass times speed is equal along any axis."""

CORRECTIONS = 2
"""Corrections of the velocities after one step: momentum is linear in them, so the second one removes rounding."""

REGULAR = 1e-9
"""Momentum of a rigid motion, over the largest one, below which it counts as zero."""

ROUNDING = 8.0 * float(np.finfo(np.float64).eps)
"""Error of momentum, over its largest entry, that counts as rounding."""


def flies_free(model: Model) -> bool:
    """Whether a scene is one free assembly of rods and bodies, joined to each other and held by nothing."""
    scene = model.scene
    held = [rod for rod in scene.rods if rod.base.rod is None and not rod.base.free]
    in_world = [joint for joint in scene.joints if joint.body is None and not joint.at_base]
    return not held and not in_world and not scene.supports and _pieces(scene) == 1


def flies_alone(model: Model) -> bool:
    """Whether a scene is one free rod without bodies."""
    return flies_free(model) and len(model.discrete.frames) == 1 and not model.scene.bodies


def _pieces(scene: Scene) -> int:
    """Number of parts of a scene that neither joints nor bases on other rods connect."""
    links = [(rod.name, rod.base.rod) for rod in scene.rods if rod.base.rod is not None]
    # A body is no rod, even where it bears the name of one.
    for joint in scene.joints:
        ends = [f"body {place.body}" for place in joint.places] + ([joint.rod] if joint.rod else [])
        links += [(ends[0], end) for end in ends[1:]]
    names = [rod.name for rod in scene.rods] + [f"body {body.name}" for body in scene.bodies]
    piece_of = {name: number for number, name in enumerate(names)}
    for one, other in links:
        joined = piece_of[one]
        left = piece_of[other]
        piece_of = {name: joined if piece == left else piece for name, piece in piece_of.items()}
    return len(set(piece_of.values()))


class MomentumKeeper:
    """Correction of the velocities of free rods after a step: momentum changes by the impulse of the loads alone.

    Args:
        model: model of a free assembly, see :func:`flies_free`.
        to_model: map from the unknowns of the steps to those of the model; None if they are equal. Both contain, in
            the same entries, the pose of a frame that moves with the assembly.
        library: shared object that contains :func:`functions_of_momentum`; None without one.
    """

    def __init__(
        self, model: Model, to_model: Callable[[Instant], Instant] | None = None, library: str | None = None
    ) -> None:
        self._to_model = to_model or (lambda instant: instant)
        damped = any(rod.properties.mass_damping is not None for rod in model.discrete.rods.values())
        # A rod of another length has another mass: what it gains has the velocity of its sections.
        grows = any(model.discrete.layout.of_rod(name, "length") is not None for name in model.discrete.rods)
        self._changes = damped or grows or bool(model.scene.loads)
        self._size = model.size
        # The momentum where the last step was looked at last.
        self._last: tuple[Instant | None, Piece | None, FloatArray] = (None, None, np.zeros(MOMENTA))
        self._frames = [
            (entries, frame)
            for (_, entries), frame in zip(
                model.discrete.unknowns.of_kind(BlockKind.POSE), model.discrete.frames.values(), strict=True
            )
        ]
        calls = [repeated(function, library) for function in functions_of_momentum(model)]
        self._momentum, self._rate, self._momenta = calls

    def settled(self, step: TimeStep, piece: Piece) -> Instant:
        """Correct the end of a step, in a piece of the inputs, to the momentum that it must have."""
        known, of_piece, momentum = self._last
        if known is not step.start or of_piece is not piece:
            momentum = self._momentum_of(self._to_model(step.start), piece)
        wanted = momentum + self._impulse(step, piece)
        rounding = ROUNDING * np.abs(wanted).max()
        end = step.end
        motions = self.rigid_motions(end.x)
        arrived = self._to_model(end)
        # Not every rigid motion has momentum: a straight rod without rotary inertia may spin about its axis.
        momenta = self._momenta_of(self.rigid_motions(arrived.x), arrived, piece)
        inverse = regular_inverse(momenta, REGULAR)
        if inverse is None:
            inverse = np.linalg.pinv(momenta)
        for _ in range(CORRECTIONS):
            momentum = self._momentum_of(arrived, piece)
            self._last = end, piece, momentum
            missing = wanted - momentum
            if np.abs(missing).max() <= rounding:
                break
            end = replace(end, v=end.v + motions @ (inverse @ missing))
            arrived = self._to_model(end)
        return end

    def _impulse(self, step: TimeStep, piece: Piece) -> FloatArray:
        """Impulse of the loads in a step, and momentum of supplied mass, shape (6,), N s and N m s."""
        if not self._changes:
            return np.zeros(6)
        stages = step.stages
        rates = []
        for time, x, v, a in zip(stages.times, stages.x, stages.v, stages.a, strict=True):
            at = self._to_model(Instant(float(time), x, v, a))
            rates.append(self._rate(at.x, at.v, at.a, *piece.remembered(at.time)))
        return np.asarray(step.size * (step.method.weights @ np.stack(rates)))

    def _momentum_of(self, instant: Instant, piece: Piece) -> FloatArray:
        """Momentum and angular momentum, shape (6,), N s and N m s."""
        inputs = piece.remembered(instant.time)
        return self._momentum(instant.x, instant.v, inputs.value, inputs.rate)

    def rigid_motions(self, x: FloatArray) -> FloatArray:
        """Rates of the unknowns in unit translations along, and rotations about, the world axes, shape (size, 6)."""
        motions = np.zeros((self._size, MOMENTA))
        for entries, frame in self._frames:
            deviation = x[entries]
            place = frame.start.position / frame.length + deviation[:3]
            w, i, j, k = frame.start.quaternion + deviation[3:]
            of_frame = motions[entries]
            of_frame[:3, :3] = np.eye(3) / frame.length
            of_frame[:3, 3:] = -cross_matrix(place)
            of_frame[3:, 3:] = 0.5 * np.array([[-i, -j, -k], [w, k, -j], [-k, w, i], [j, -i, w]])
        return motions

    def _momenta_of(self, motions: FloatArray, instant: Instant, piece: Piece) -> FloatArray:
        """Momenta of the rigid motions as columns, the inertia matrix of a rigid body, symmetric, shape (6, 6)."""
        value = piece.remembered(instant.time).value
        still = np.zeros_like(value)
        # Column after column, as CasADi has them.
        columns = [np.tile(part, len(OF_A_BODY)) for part in (instant.x, value, still)]
        self._momenta(columns[0], motions[:, OF_A_BODY].ravel(order="F"), *columns[1:])
        momenta = self._momenta.results[0]
        mass, of_turns = momenta[0, 0], momenta[:, 1:]
        return np.block([[mass * np.eye(3), of_turns[:3]], [of_turns[:3].T, of_turns[3:]]])


def functions_of_momentum(model: Model) -> list[ca.Function]:
    """Functions of momentum (x, v, inputs, rate) ↦ 6×1 at one state, of its rate, and of momentum at four states.

    The rate along a motion is the function (x, v, a, inputs, rate, acceleration) ↦ 6×1.
    """
    x, v, a = (ca.MX.sym(name, model.size) for name in ("x", "v", "a"))
    inputs, rate, acceleration = (ca.MX.sym(name, model.inputs.size) for name in ("inputs", "rate", "acceleration"))
    momentum = ca.Function(
        "momentum",
        [x, v, inputs, rate],
        [ca.densify(ca.vertcat(*model.momentum(x, v, inputs, rate)))],
        ["x", "v", "inputs", "rate"],
        ["momentum"],
    )
    # One symbol for all that changes: one sweep for its direction, where each of four would cost as much.
    state = ca.MX.sym("state", 2 * model.size + 2 * model.inputs.size)
    sizes = [model.size, model.size, model.inputs.size, model.inputs.size]
    parts = ca.vertsplit(state, np.cumsum([0, *sizes]).tolist())
    along = ca.jtimes(momentum(*parts), state, ca.vertcat(v, a, rate, acceleration))
    along = ca.graph_substitute(along, [state], [ca.vertcat(x, v, inputs, rate)])
    momentum_rate = ca.Function("momentum_rate", [x, v, a, inputs, rate, acceleration], [ca.densify(along)])
    states = [ca.MX.sym(name, len(OF_A_BODY) * size) for name, size in zip(momentum.name_in(), sizes, strict=True)]
    columns = [ca.reshape(state, -1, len(OF_A_BODY)) for state in states]
    together = ca.horzcat(*[momentum(*one) for one in zip(*[ca.horzsplit(c) for c in columns], strict=True)])
    return [momentum, momentum_rate, ca.Function("momenta", states, [ca.densify(together)])]
