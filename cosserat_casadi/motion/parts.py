"""A long motion in parts, each of which is written to a file and then freed from memory.

Memory holds one part: its steps, and the steps of the motions that tell its error. A part continues the last one, on
the modes that were chosen in the first one; the error covers the whole motion so far.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from cosserat_casadi.errors import Problem, refuse
from cosserat_casadi.motion.checkpoint import Checkpoint
from cosserat_casadi.motion.going_on import StartOfMotion, checkpoint_of
from cosserat_casadi.motion.simulate import Tell
from cosserat_casadi.motion.trajectory import Motion, MotionProgress
from cosserat_casadi.scene.simulation import Simulation

GOING_ON = (".json", ".npz")
"""Suffixes of files from which a motion can continue."""

Simulated = Callable[[StartOfMotion, Simulation, Tell | None], Motion]
"""(start, simulation, progress) ↦ the motion from the start to the duration of the simulation."""


def simulate_in_parts(
    simulated: Simulated,
    simulation: Simulation,
    output: str | Path,
    length: float,
    start: StartOfMotion = None,
    progress: Tell | None = None,
) -> Motion:
    """Simulate part by part, and write each part to a file; a part that ends early is the last one.

    Args:
        simulated: function that simulates one part.
        simulation: settings of the whole motion; each row of its result is in the part that reaches it.
        output: file, to whose name the number of the part is added: ``out.npz`` becomes ``out-0001.npz``.
        length: length of a part, s.
        start: start of the motion.
        progress: callback after every step, with the duration of the whole motion.

    Returns:
        the last part.

    Raises:
        SceneError: the length is not a positive time, or a motion cannot continue from a file of that kind.
    """
    path = Path(output)
    check_parts(path, length)
    rows = simulation.frame_times
    checkpoint = checkpoint_of(start)
    begun = 0.0 if checkpoint is None else checkpoint.time
    count = max(1, int(np.ceil((simulation.duration - begun) / length - 1e-9)))
    tell = None if progress is None else _whole(progress, simulation.duration)
    following: StartOfMotion = start if checkpoint is None else checkpoint
    for number in range(1, count + 1):
        end = simulation.duration if number == count else begun + number * length
        reached = following.time if isinstance(following, Checkpoint) else -1.0
        of_part = rows[(reached < rows) & (rows <= end)]
        changes = {"duration": end, "frames": None, "times": tuple(of_part.tolist())}
        motion = simulated(following, simulation.model_copy(update=changes), tell)
        motion.write(path.with_stem(f"{path.stem}-{number:04d}"))
        if not motion.converged or motion.end is None or motion.end.time < end:
            break
        following = motion.end
    return motion


def check_parts(output: Path | None, length: float) -> None:
    """Refuse parts without a positive length, or without a file from which a motion can continue.

    Raises:
        SceneError: with all that is wrong.
    """
    problems = []
    if not 0.0 < length < np.inf:
        problems.append(Problem("--part", f"{length:g} s is no length of a part", "give one in s"))
    if output is None or output.suffix.lower() not in GOING_ON:
        remedy = "name a .npz or .json: each part goes to a file of its own"
        problems.append(Problem("--output", "parts are written to files that the motion goes on from", remedy))
    refuse(problems)


def _whole(progress: Tell, duration: float) -> Tell:
    """Make a callback that reports the progress of a part as progress of the whole motion."""

    def tell(part: MotionProgress) -> None:
        progress(replace(part, duration=duration))

    return tell
