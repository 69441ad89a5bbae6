"""Warnings of loads that come suddenly: they limit how exact a motion is on any number of modes."""

from __future__ import annotations

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.motion.displacement import displacements
from cosserat_casadi.motion.motion_start import Start
from cosserat_casadi.motion.moving_inputs import MovingInputs

OUT_OF_BALANCE = 1e-6
"""Residual of statics, without unit, at which a start is no equilibrium."""

STIRRED = 1e-6
"""Displacement by strains over that by all unknowns, as they begin to move, from which a rod is deformed."""

AT_ONCE = (
    "The motion starts out of balance: loads act at once from t = 0 on. Waves of all lengths run along the rods, which "
    "modes resolve slowly."
)
"""Warning of loads that act at once at the start."""


def warnings(model: Model, start: Start, moving: MovingInputs, duration: float, accelerations: FloatArray) -> list[str]:
    """Sentences on loads that come suddenly.

    Args:
        model: the model.
        start: how its motion begins.
        moving: the inputs over time.
        duration: of the motion, s.
        accelerations: of the unknowns at the start, shape (size,), 1/s².
    """
    at_start = []
    # What a motion that goes on sets out with has been under way already.
    begins = start.resume is None
    if begins and _loaded_at_once(model, start, moving) and _deforms(model, accelerations):
        at_start.append(AT_ONCE)
    jumps: dict[str, list[float]] = {}
    for jump in moving.jumps(duration):
        jumps.setdefault(jump.input, []).append(jump.time)
    return at_start + [_jumping(name, times) for name, times in jumps.items()]


def _jumping(name: str, times: list[float]) -> str:
    """The sentence on an input that jumps at these times, s."""
    when = f"at {times[0]:g} s"
    if len(times) > 1:
        when = f"{len(times)} times from {times[0]:g} s to {times[-1]:g} s"
    return f"{name} jumps {when}: waves of all lengths run along the rods, which modes resolve slowly."


def _deforms(model: Model, accelerations: FloatArray) -> bool:
    """Whether the strains begin to move: a rod that merely falls has no waves."""
    moved = np.abs(accelerations) * displacements(model)
    strains = [moved[entries].max(initial=0.0) for _, entries in model.discrete.unknowns.of_kind(BlockKind.STRAIN)]
    return bool(max(strains, default=0.0) > STIRRED * moved.max(initial=0.0))


def _loaded_at_once(model: Model, start: Start, moving: MovingInputs) -> bool:
    """Whether the start is out of balance: loads that were not there act from t = 0 on."""
    if start.phases is not None and start.phases.touches:
        # Obstacles hold the rods.
        return False
    inputs = moving.at(0.0).value
    # The residual of statics, by a function that the steps have called.
    residual = model.inverse_dynamics_in_scalars(start.x, 0, 0, inputs, 0, 0).full()[:, 0]
    return bool(np.abs(residual).max(initial=0.0) > OUT_OF_BALANCE)
