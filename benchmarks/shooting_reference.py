"""The hand-written shooting solvers of reference/: compiled, run, and their steps matched to an accuracy.

As a program: tip error against time on the steel rods, for the plain solver, the tuned one and the tuned one's
shortcuts.
"""

from __future__ import annotations

import json
import math
import subprocess
import tempfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Literal

from rich.console import Console
from rich.table import Table

FOLDER = Path(__file__).parent / "reference"
SOURCES = {"plain": FOLDER / "plain_shooting.c", "tuned": FOLDER / "shooting.c"}
BUILD = Path(__file__).parents[1] / "build" / "reference"
FLAGS = ("-O2", "-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror")
MOST_STEPS = 1 << 16
"""Where the search for steps gives up: rounding has long taken over."""

Triple = tuple[float, float, float]
Program = Literal["plain", "tuned"]
PROGRAMS: tuple[Program, ...] = ("plain", "tuned")


@dataclass(frozen=True)
class Case:
    """A straight rod along z, clamped at the origin.

    Attributes:
        kind: "kirchhoff" or "reissner".
        length: m.
        bending: EI, N m²; about x alone where bending_y is given.
        torsion: GJ, N m².
        shear: GA, N, without a correction factor; along x alone where shear_y is given.
        extension: EA, N.
        force: dead force at the tip, N.
        moment: dead moment at the tip, N m.
        weight: dead force per metre, N/m.
        tip: where the tip is, m; None where nobody has said.
        bending_y: EI about y where it differs, N m²; for the plain program.
        shear_y: GA along y where it differs, N; likewise.
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
    bending_y: float | None = None
    shear_y: float | None = None

    def tip_error(self, tip: Triple) -> float:
        """Distance from the true tip, relative to length."""
        if self.tip is None:
            raise ValueError("the case has no tip to compare with")
        return math.dist(tip, self.tip) / self.length

    def scene(self, tolerance: float) -> dict[str, Any]:
        """The case as the tables of a scene file."""
        stiffness = {"bending_x": self.bending, "bending_y": self.bending, "torsion": self.torsion}
        if self.kind == "reissner":
            stiffness |= {"shear_x": self.shear, "shear_y": self.shear, "extension": self.extension}
        rod = {"name": "rod", "length": self.length, "strain": self.kind, "stiffness": stiffness}
        tip: dict[str, Any] = {"name": "tip", "kind": "tip_wrench", "rod": "rod", "frame": "world"}
        tip |= {"force": list(self.force), "moment": list(self.moment)}
        return {"schema": 1, "accuracy": {"tolerance": tolerance}, "rods": [rod], "loads": [tip]}


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
def compiled(program: Program = "tuned", unknowns: int = 6) -> Path:
    """A compiled solver; with three unknowns, which the tuned one can do, it takes the base force as known."""
    if program == "plain" and unknowns != 6:
        raise ValueError(f"the plain program has six unknowns, not {unknowns}")
    BUILD.mkdir(parents=True, exist_ok=True)
    target = BUILD / f"{program}-{unknowns}"
    # Compiled aside and moved in place: another process may be running or compiling it.
    with tempfile.TemporaryDirectory(dir=BUILD) as folder:
        fresh = Path(folder) / target.name
        define = [f"-DUNKNOWNS={unknowns}"] if program == "tuned" else []
        command = ["gcc", *FLAGS, *define, str(SOURCES[program]), "-o", str(fresh), "-lm"]
        subprocess.run(command, check=True)
        fresh.replace(target)
    return target


def race(
    case: Case, steps: int, *, repeat: int = 200, program: Program = "tuned", unknowns: int = 6, nested: bool = False
) -> dict[str, Any]:
    """Solve from cold as often as told.

    Returns:
        status ("converged" or "failed"), iterations, tip (m; None if failed), rotation (rows) and cold_us: the best
        time of a solve, µs.

    Raises:
        RuntimeError: with the usage if the program cannot do the case or the option.
    """
    stiffness = (case.length, case.bending, case.torsion, case.shear, case.extension)
    numbers = [*map(repr, stiffness), str(steps), *map(repr, (*case.force, *case.moment))]
    options = ["--weight", *map(repr, case.weight), "--repeat", str(repeat), *(["--nested"] if nested else [])]
    if case.bending_y is not None or case.shear_y is not None:
        options += ["--y", repr(case.bending_y or case.bending), repr(case.shear_y or case.shear)]
    command = [str(compiled(program, unknowns)), case.kind, *numbers, *options]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    # A failed solve exits with 1 and still has its line.
    if done.returncode not in (0, 1):
        raise RuntimeError(done.stderr)
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def steps_for(case: Case, tip_error: float, program: Program = "tuned") -> int:
    """The smallest number of steps whose tip error, relative to length, is at most as told.

    The error is taken to fall with the steps, as it does until rounding takes over.

    Raises:
        ValueError: if no number of steps is enough.
    """

    def accurate(steps: int) -> bool:
        found = race(case, steps, repeat=1, program=program)
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
    table.add_column("case", no_wrap=True)
    table.add_column("error wanted", justify="right")
    for program in PROGRAMS:
        for heading in (f"{program} steps", "error", "Newton", "µs"):
            table.add_column(heading, justify="right")
    for heading in ("nested, µs", "3 unknowns, µs", "both, µs"):
        table.add_column(heading, justify="right", style="dim")
    for name, case in CASES.items():
        for wanted in (2e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11):
            row = [name, f"{wanted:.0e}"]
            for program in PROGRAMS:
                steps = steps_for(case, wanted, program)
                found = race(case, steps, repeat=2000, program=program)
                error = case.tip_error(found["tip"])
                row += [str(steps), f"{error:.1e}", str(found["iterations"]), f"{found['cold_us']:.1f}"]
            others = [(6, True), (3, False), (3, True)]
            quick = [race(case, steps, repeat=2000, unknowns=size, nested=nested) for size, nested in others]
            table.add_row(*row, *(f"{found['cold_us']:.1f}" for found in quick))
    Console(width=140).print(table)


if __name__ == "__main__":
    main()
