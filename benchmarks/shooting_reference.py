"""The hand-written shooting solver, reference/shooting.c: compiled, run, and its steps matched to an accuracy.

As a program: tip error against time on the steel rods, for the plain solver and for its shortcuts.
"""

from __future__ import annotations

import json
import math
import subprocess
import tempfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

SOURCE = Path(__file__).parent / "reference" / "shooting.c"
BUILD = Path(__file__).parents[1] / "build" / "reference"
FLAGS = ("-O2", "-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror")
MOST_STEPS = 1 << 16
"""Where the search for steps gives up: rounding has long taken over."""

Triple = tuple[float, float, float]


@dataclass(frozen=True)
class Case:
    """A straight rod along z, clamped at the origin.

    Attributes:
        kind: "kirchhoff" or "reissner".
        length: m.
        bending: EI, N m².
        torsion: GJ, N m².
        shear: GA, N, without a correction factor.
        extension: EA, N.
        force: dead force at the tip, N.
        moment: dead moment at the tip, N m.
        weight: dead force per metre, N/m.
        tip: where the tip is, m; None where nobody has said.
    """

    kind: str
    length: float
    bending: float
    torsion: float
    shear: float
    extension: float
    force: Triple
    moment: Triple = (0.0, 0.0, 0.0)
    weight: Triple = (0.0, 0.0, 0.0)
    tip: Triple | None = None

    def tip_error(self, tip: Triple) -> float:
        """Distance from the true tip, relative to length."""
        if self.tip is None:
            raise ValueError("the case has no tip to compare with")
        return math.dist(tip, self.tip) / self.length


def steel(kind: str, force: Triple, moment: Triple, tip: Triple) -> Case:
    """A steel wire, half a metre long and 2 mm thick."""
    young, shear, radius = 200e9, 80e9, 1e-3
    area, second = math.pi * radius**2, math.pi * radius**4 / 4
    return Case(kind, 0.5, young * second, 2 * shear * second, shear * area, young * area, force, moment, tip=tip)


B1 = (1.0, 0.0, 0.0), (0.0, 0.0, 0.0)
B2 = (1.0, 1.5, -0.5), (0.0, 0.0, 0.1)
B3 = (3.0, 0.0, 0.0), (0.0, 0.0, 0.0)
# Tips by the oracle of tests/reference, DOP853 at 1e-13.
CASES = {
    "B1": steel("reissner", *B1, (0.21394921981849235, 0.0, 0.44115175295465825)),
    "B1 Kirchhoff": steel("kirchhoff", *B1, (0.21394765742508004, 0.0, 0.4411520858317079)),
    "B2": steel("reissner", *B2, (0.15602780636979446, 0.2909908603564316, 0.33862381693218463)),
    "B2 Kirchhoff": steel("kirchhoff", *B2, (0.15602638773692856, 0.29098887945645513, 0.33862494895072737)),
    "B3": steel("reissner", *B3, (0.35265504710356116, 0.0, 0.31221991788780923)),
    "B3 Kirchhoff": steel("kirchhoff", *B3, (0.3526515844170806, 0.0, 0.31222058457228663)),
}


@cache
def program(unknowns: int = 6) -> Path:
    """The compiled solver; with three unknowns it takes the base force as known."""
    BUILD.mkdir(parents=True, exist_ok=True)
    target = BUILD / f"shooting-{unknowns}"
    # Compiled aside and moved in place: another process may be running or compiling it.
    with tempfile.TemporaryDirectory(dir=BUILD) as folder:
        fresh = Path(folder) / target.name
        command = ["gcc", *FLAGS, f"-DUNKNOWNS={unknowns}", str(SOURCE), "-o", str(fresh), "-lm"]
        subprocess.run(command, check=True)
        fresh.replace(target)
    return target


def race(case: Case, steps: int, *, repeat: int = 200, unknowns: int = 6, nested: bool = False) -> dict[str, Any]:
    """Solve from cold as often as told.

    Returns:
        status ("converged" or "failed"), iterations, tip (m; None if failed), rotation (rows) and cold_us: the best
        time of a solve, µs.
    """
    stiffness = (case.length, case.bending, case.torsion, case.shear, case.extension)
    numbers = [*map(repr, stiffness), str(steps), *map(repr, (*case.force, *case.moment))]
    options = ["--weight", *map(repr, case.weight), "--repeat", str(repeat), *(["--nested"] if nested else [])]
    command = [str(program(unknowns)), case.kind, *numbers, *options]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    # A failed solve exits with 1 and still has its line.
    if done.returncode not in (0, 1):
        raise RuntimeError(done.stderr)
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def steps_for(case: Case, tip_error: float) -> int:
    """The smallest number of steps whose tip error, relative to length, is at most as told.

    The error is taken to fall with the steps, as it does until rounding takes over.

    Raises:
        ValueError: if no number of steps is enough.
    """

    def accurate(steps: int) -> bool:
        found = race(case, steps, repeat=1)
        return found["status"] == "converged" and case.tip_error(found["tip"]) <= tip_error

    enough = 1
    while not accurate(enough):
        enough *= 2
        if enough > MOST_STEPS:
            raise ValueError(f"no number of steps brings the tip error below {tip_error:g}")
    too_few = enough // 2
    while enough - too_few > 1:
        middle = (enough + too_few) // 2
        too_few, enough = (too_few, middle) if accurate(middle) else (middle, enough)
    return enough


def main() -> None:
    table = Table(title="Shooting by hand: cold solves, best of 2000")
    table.add_column("case")
    for heading in ("error wanted", "steps", "tip error / L", "iterations", "µs"):
        table.add_column(heading, justify="right")
    for heading in ("nested, µs", "3 unknowns, µs", "both, µs"):
        table.add_column(heading, justify="right", style="dim")
    for name, case in CASES.items():
        for wanted in (2e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10):
            steps = steps_for(case, wanted)
            plain = race(case, steps, repeat=2000)
            others = [(6, True), (3, False), (3, True)]
            quick = [race(case, steps, repeat=2000, unknowns=size, nested=nested) for size, nested in others]
            table.add_row(
                name,
                f"{wanted:.0e}",
                str(steps),
                f"{case.tip_error(plain['tip']):.1e}",
                str(plain["iterations"]),
                f"{plain['cold_us']:.1f}",
                *(f"{found['cold_us']:.1f}" for found in quick),
            )
    Console(width=120).print(table)


if __name__ == "__main__":
    main()
