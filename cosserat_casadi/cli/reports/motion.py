"""The reports of ``simulate`` and ``modes``."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from cosserat_casadi.cli.reports.format import print_outcome, print_written, table_of
from cosserat_casadi.cli.reports.model import error_words
from cosserat_casadi.motion.trajectory import Motion
from cosserat_casadi.motion.vibration_modes import Mode, Modes
from cosserat_casadi.results.facts import digits
from cosserat_casadi.spelling import counted


def print_motion(console: Console, motion: Motion, written: Sequence[Path]) -> None:
    """Print the outcome, final positions of rods and bodies, figures of merit, and written files."""
    missed = motion.within_tolerance is False
    print_outcome(console, motion.model.scene.title, motion.message, good=motion.converged, doubtful=missed)
    if len(motion.times):
        console.print(_end_table(motion))
    for sentence in _merit_sentences(motion):
        console.print(sentence)
    print_written(console, written)


def print_hasty_animation(console: Console, frames: int, speed: float) -> None:
    """Print how to slow down a very short animation."""
    console.print(
        f"The animation has {counted(frames, 'frame')}: add --speed {speed:g} to see the motion slowly.",
        soft_wrap=True,
    )


def _end_table(motion: Motion) -> Table:
    """Tips of rods and positions of bodies at the last time, in world axes."""
    table = table_of(f"at t = {motion.times[-1]:.6g} s", "quantity", right="xyz")
    longest = max(rod.length for rod in motion.model.discrete.rods.values())
    for name in motion.model.discrete.rods:
        position = motion.tip(name).position[-1]
        table.add_row(escape(name), "tip position, m", *digits(position, longest))
    for body in motion.model.scene.listed_bodies:
        position = motion.body(body.name).position[-1]
        table.add_row(escape(body.name), "body position, m", *digits(position, longest))
    return table


OF_PAIRS = {"cables: taut": ("taut", "slack"), "joints: at a stop": ("stop_hit", "stop_left")}
"""Words for events of cables and stops, and their kinds; the first kind dissipates energy."""


def _merit_sentences(motion: Motion) -> Iterator[str]:
    """The steps of the motion, its accuracy, and its discretisation, with markup."""
    # The outcome explains a missing start.
    if motion.start and motion.start not in motion.message:
        yield escape(f"start: {motion.start}")
    yield f"steps: {_step_words(motion)}"
    if np.isfinite(motion.error_estimate):
        longest = max(rod.properties.length for rod in motion.model.discrete.rods.values())
        metres = motion.error_estimate * longest
        error = error_words(motion.error_estimate, motion.within_tolerance, motion.tolerance)
        yield f"estimated error of the paths: {metres:.1e} m, {error}"
    imbalance = np.abs(motion.energy.imbalance)
    if np.isfinite(imbalance).any():
        yield f"energies balance to {np.nanmax(imbalance):.1e} of the largest energy"
    for words, kinds in OF_PAIRS.items():
        changes = [event for event in motion.events if event.kind in kinds]
        hits = [event for event in changes if event.kind == kinds[0]]
        if changes:
            taken = _taken_words(motion, sum(event.energy for event in hits))
            yield f"{words} {counted(len(hits), 'time')}, which took {taken}"
    if any(all(event.kind not in kinds for kinds in OF_PAIRS.values()) for event in motion.events):
        yield f"contact: {_contact_words(motion)}"
    yield escape("; ".join(motion.model.resolution_words))


def _contact_words(motion: Motion) -> str:
    """Number of contact events, and energy lost in impacts."""
    impacts = sum(event.kind == "impact" for event in motion.events)
    lift_offs = sum(event.kind == "lift_off" for event in motion.events)
    taken = sum(event.energy for event in motion.events)
    return f"{counted(impacts, 'impact')}, which took {_taken_words(motion, taken)}, {counted(lift_offs, 'lift-off')}"


def _taken_words(motion: Motion, taken: float) -> str:
    """Energy lost in impacts, and its change with modes and steps."""
    words = f"{taken:.3g} J"
    if taken and np.isfinite(motion.impacts_spread):
        words += f" ± {motion.impacts_spread:.2g} J"
    return words


def _step_words(motion: Motion) -> str:
    statistics = motion.statistics
    parts = [f"{statistics.steps:,}"]
    if statistics.steps:
        parts.append(f"of {statistics.smallest_step:.2g} to {statistics.largest_step:.2g} s")
    words = " ".join(parts)
    iterations = counted(statistics.iterations, "iteration")
    jacobians = counted(statistics.jacobians, "Jacobian")
    return f"{words}, {statistics.rejected:,} rejected; {iterations}, {jacobians}"


def print_modes(console: Console, modes: Modes, written: Sequence[Path]) -> None:
    """Print the outcome, the modes, their discretisation, and the files that were written."""
    grows = any(mode.grows for mode in modes.modes)
    print_outcome(console, modes.model.scene.title, modes.message, good=modes.converged, doubtful=grows)
    if modes.modes:
        console.print(_modes_table(modes))
        console.print(escape("; ".join(modes.model.resolution_words)))
    print_written(console, written)


def _modes_table(modes: Modes) -> Table:
    table = table_of(right=("mode", "frequency, Hz", "|λ|, 1/s", "damping ratio", "estimated error"))
    table.add_column("motion")
    for number, mode in enumerate(modes.modes, start=1):
        table.add_row(str(number), *_cells(mode))
    return table


def _cells(mode: Mode) -> list[str]:
    """Frequency, size of the eigenvalue, damping ratio, error and kind of a mode."""
    error = ""
    if mode.error_estimate is not None and mode.eigenvalue != 0.0:
        error = f"{mode.error_estimate:.1e}"
    frequency = ""
    damping = ""
    # Modes without oscillation have a rate and no frequency.
    if mode.oscillates:
        frequency = f"{mode.frequency:.8g}"
        damping = f"{mode.damping_ratio:.6g}"
    return [frequency, f"{mode.angular_frequency:.8g}", damping, error, mode.words]
