"""Warnings of sudden loads, which limit the accuracy of a motion on any number of modes."""

from __future__ import annotations

import numpy as np

from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.motion.displacement import displacements
from cosserat_casadi.motion.history import History
from cosserat_casadi.motion.kernel_residual import KernelResidual
from cosserat_casadi.motion.motion_start import Start
from cosserat_casadi.motion.moving_inputs import MovingInputs

OUT_OF_BALANCE = 1e-6
"""Dimensionless residual of statics above which a start is not an equilibrium."""

STIRRED = 1e-6
"""Initial displacement by strains, over the displacement by all unknowns, above which a rod is deformed."""

AT_ONCE = (
    "The motion starts out of balance: loads act at once from t = 0 on. They send waves of all lengths along the "
    "rods, which converge slowly with more modes."
)
"""Warning of loads that act suddenly at the start."""


def is_sudden(history: History, start: Start, moving: MovingInputs, duration: float) -> bool:
    """Whether loads act at once at the start of a motion, or jump; arguments as of ``warnings``."""
    return bool(moving.jumps(duration)) or _starts_at_once(history, start, moving, duration)


def warnings(history: History, start: Start, moving: MovingInputs, duration: float) -> list[str]:
    """Warnings of sudden loads.

    Args:
        history: the motion.
        start: start of the motion.
        moving: the inputs over time.
        duration: duration of the motion, s.
    """
    at_start = [AT_ONCE] if _starts_at_once(history, start, moving, duration) else []
    jumps: dict[str, list[float]] = {}
    for jump in moving.jumps(duration):
        jumps.setdefault(jump.input, []).append(jump.time)
    return at_start + [_jumping(name, times) for name, times in jumps.items()]


def _starts_at_once(history: History, start: Start, moving: MovingInputs, duration: float) -> bool:
    """Whether loads that were not there act from the start on, and deform a rod."""
    # What a motion that goes on sets out with has been under way already.
    if start.resume is not None:
        return False
    return history.once("stirred", duration, lambda: _loaded_at_once(history, start, moving) and _deforms(history))


def _jumping(name: str, times: list[float]) -> str:
    """Warning of an input that jumps at these times, s."""
    when = f"at {times[0]:g} s"
    if len(times) > 1:
        when = f"{len(times)} times from {times[0]:g} s to {times[-1]:g} s"
    return f"{name} jumps {when}: it sends waves of all lengths along the rods, which converge slowly with more modes."


def _deforms(history: History) -> bool:
    """Whether the strains begin to move: a rod that merely falls has no waves."""
    unknowns = history.model.discrete.unknowns
    moved = np.abs(history.of_model(history.legs[0].start.instant).a) * displacements(history.model)
    strains = [moved[entries].max(initial=0.0) for _, entries in unknowns.of_kind(BlockKind.STRAIN)]
    return bool(max(strains, default=0.0) > STIRRED * moved.max(initial=0.0))


def _loaded_at_once(history: History, start: Start, moving: MovingInputs) -> bool:
    """Whether the start is out of balance, because loads act suddenly from t = 0 on."""
    if start.phases is not None and start.phases.touches:
        # Obstacles hold the rods.
        return False
    inputs = moving.at_start.value
    still, unmoved = np.zeros(len(start.x)), np.zeros(len(inputs))
    # The residual of statics, by the function that the steps have called.
    equations = history.legs[0].equations
    assert equations is not None, "a motion that was computed in this process"
    assert isinstance(equations.residual, KernelResidual), "a motion without parameters"
    residual = equations.residual.call(start.x, still, still, inputs, unmoved, unmoved)
    return bool(np.abs(residual).max(initial=0.0) > OUT_OF_BALANCE)
