"""How exact contact in motion converges with the modes, and how smooth contact comes near it.

The rod of examples/bouncing_rod.toml falls on a bar. Printed are the largest distance of the tip's path from that of
the finest motion, over the length, and the energy that impacts take; then the distance of smooth contact from the exact
one on the same modes. Times are those of the processor. `--times` writes what examples take into docs/motion.md, each
motion once, with an empty cache of compiled code.
"""

from __future__ import annotations

import argparse
import os
import time
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from doc_tables import put, table

from cosserat_casadi import Motion, build, read_scene, simulate
from cosserat_casadi.compiling.cache import VARIABLE

ROOT = Path(__file__).parents[1]
SCENE = ROOT / "examples" / "bouncing_rod.toml"

TIMED = ("rod_hits_floor", "bouncing_rod", "dropped_rod", "rod_lies_down")
"""Examples whose times are told."""

BEGIN, END = "<!-- contact: written by benchmarks/contact_in_motion.py --times -->", "<!-- end of contact -->"
HEADINGS = ("example", "contact", "motion, s", "steps", "impacts", "estimate", "processor, s")

MODES = (2, 4, 6, 8)
FINEST = 12
WIDTHS = (8e-3, 4e-3, 2e-3)
ON_MODES = 4


def computed(modes: int, *changes: str) -> tuple[Motion, float]:
    """The motion on so many modes, and the time that it took, s."""
    given = [f"accuracy.modes={modes}", f"accuracy.nodes={modes + 10}", "simulation.tolerance=1e-4"]
    scene = read_scene(SCENE, [*given, "simulation.duration=0.5", *changes])
    began = time.process_time()
    motion = simulate(build(scene.with_motion_inputs(), moving=True))
    return motion, time.process_time() - began


def distance(first: Motion, second: Motion) -> float:
    """Largest distance of the paths of the tips, over the length, as far as both go."""
    rows = min(len(first.times), len(second.times))
    apart = first.tip().position[:rows] - second.tip().position[:rows]
    return float(np.linalg.norm(apart, axis=1).max() / 0.4)


def timed(example: str) -> list[str]:
    """A row on what an example takes."""
    scene = read_scene(ROOT / "examples" / f"{example}.toml")
    began = time.process_time()
    motion = simulate(scene)
    seconds = time.process_time() - began
    assert motion.converged, motion.message
    struck = sum(event.kind == "impact" for event in motion.events)
    contact = "exact" if scene.touches_exactly else "with a width"
    counts = [f"{motion.times[-1]:g}", str(motion.statistics.steps), str(struck)]
    return [f"`{example}`", contact, *counts, f"{motion.error_estimate:.0e}", f"{seconds:.1f}"]


def main() -> None:
    """Print both tables, or write that of the times."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--times", action="store_true", help="write what examples take, and nothing else")
    if parser.parse_args().times:
        with TemporaryDirectory() as cache:
            os.environ[VARIABLE] = cache
            text = table(HEADINGS, [timed(example) for example in TIMED])
        print(text)
        put(ROOT / "docs" / "motion.md", BEGIN, END, text)
        return
    finest, _ = computed(FINEST)
    print(f"{FINEST} modes: {finest.outcome.label}, impacts take {finest.energy.impacts[-1]:.3e} J")
    print("modes  distance  impacts, J  events  s")
    for modes in MODES:
        motion, seconds = computed(modes)
        taken = motion.energy.impacts[-1]
        print(f"{modes:5d}  {distance(motion, finest):.1e}  {taken:.3e}  {len(motion.events):6d}  {seconds:.0f}")
    exact, _ = computed(ON_MODES)
    print("width, mm  distance  s")
    for width in WIDTHS:
        smooth, seconds = computed(ON_MODES, f"bar.width={width}", "bar.damping=3.0")
        print(f"{1e3 * width:9g}  {distance(smooth, exact):.1e}  {seconds:.0f}  {smooth.outcome.label}")


if __name__ == "__main__":
    main()
