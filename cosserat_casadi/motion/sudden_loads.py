"""Warnings of loads that come suddenly: they limit how exact a motion is on any number of modes."""

from __future__ import annotations

import numpy as np

from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.motion_start import Start
from cosserat_casadi.motion.moving_inputs import MovingInputs

OUT_OF_BALANCE = 1e-6
"""Residual of statics, without unit, at which a start is no equilibrium."""

AT_ONCE = (
    "The motion starts out of balance: loads act at once from t = 0 on. Waves of all lengths run along the rods, which "
    "modes resolve slowly."
)
"""Warning of loads that act at once at the start."""


def warnings(model: Model, start: Start, moving: MovingInputs, duration: float) -> list[str]:
    """Sentences on loads that come suddenly.

    Args:
        model: the model.
        start: how its motion begins.
        moving: the inputs over time.
        duration: of the motion, s.
    """
    at_start = [AT_ONCE] if _loaded_at_once(model, start, moving) else []
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


def _loaded_at_once(model: Model, start: Start, moving: MovingInputs) -> bool:
    """Whether the start is out of balance: loads that were not there act from t = 0 on."""
    if start.phases is not None and start.phases.touches:
        # Obstacles hold the rods.
        return False
    inputs = moving.at(0.0).value
    residual = model.residual(start.x, inputs).full()[:, 0]
    return bool(np.abs(residual).max(initial=0.0) > OUT_OF_BALANCE)
