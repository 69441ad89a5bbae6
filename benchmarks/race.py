"""The exported C raced against shooting solvers written by hand, at equal tip error, in one run.

For every rod and error: the scene is exported at that tolerance, compiled with the flags that the hand-written
programs get, and solved from cold. On a stout rod packages from PyPI come in. `--write` puts the tables into
docs/accuracy.md, three rows into the README, and draws docs/figures/race.png.
"""

from __future__ import annotations

import json
import math
import subprocess
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain
from pathlib import Path
from typing import Annotated

import typer
from doc_tables import put, table
from peers import LIMITS, Peer, peers, shortest, stout
from race_figure import race_figure
from rich.progress import Progress
from shooting_reference import CASES, PROGRAMS, Case, race, steps_for

from cosserat_casadi import Model, build, export, scene_from_dict, solve
from cosserat_casadi.accuracy.refine import solve_rods
from cosserat_casadi.plots.figure import write_figure

README = Path(__file__).parents[1] / "README.md"
BEGIN, END = "<!-- race: written by benchmarks/race.py -->", "<!-- end of race -->"
DOCS = Path(__file__).parents[1] / "docs"
PEERS_BEGIN, PEERS_END = "<!-- peers: written by benchmarks/race.py -->", "<!-- end of peers -->"
FIGURE = "figures/race.png"
STOUT = "stout"
"""Name of the case on which peers come in."""
ON_FIRST_PAGE = "B2"
"""Name of the case whose rows stand in the README: force and torque at the tip, in space."""
ERRORS = (1e-5, 1e-8, 1e-11)
FLAGS = ("-O2", "-std=c99")


@dataclass(frozen=True)
class Exported:
    """A model as a compiled demo program, and what it measured of itself.

    Attributes:
        kilobytes: size of the sources that a controller compiles.
        compile_s: time that gcc -O2 took for them.
        error: distance of the tip from the true one, relative to length.
        times: cold_us, warm_us, igm_us, jacobian_us.
    """

    kilobytes: float
    compile_s: float
    error: float
    times: dict[str, float]


def model_of(case: Case, error: float) -> Model:
    """The cheapest model within the error, as the dial finds it."""
    solution = solve_rods(scene_from_dict(case.scene(error)))
    if not solution.converged:
        raise RuntimeError(solution.message)
    return solution.model


def measured(model: Model, case: Case, repeat: int = 2000) -> Exported:
    """Export, compile and run a model."""
    with tempfile.TemporaryDirectory() as name:
        folder = export(model, Path(name) / "raced")
        sources = ["raced_demo.c", "raced.c", "raced_kernels.c"]
        start = time.perf_counter()
        subprocess.run(["gcc", *FLAGS, *sources, "-lm", "-o", "demo"], cwd=folder, check=True)
        took = time.perf_counter() - start
        command = ["./demo", "--repeat", str(repeat)]
        found = json.loads(subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True).stdout)
        included = folder.glob("*_in_fours.h")
        compiled = [*(folder / source for source in sources[1:]), *included]
        size = sum(file.stat().st_size for file in compiled) / 1000
    times = {key: value for key, value in found.items() if key.endswith("_us")}
    return Exported(size, took, case.tip_error(tuple(found["tip"])), times)


def literal(model: Model) -> Model:
    """The same modes and nodes with the rotation from the literal linear system."""
    chosen = {name: replace(d, transport="permuted") for name, d in model.discretisation.items()}
    return build(model.scene, chosen)


@dataclass(frozen=True)
class Raced:
    """A case at one error: what we need for it and what shooting by hand needs.

    Attributes:
        name: of the case.
        wanted: error.
        unknowns: of the exported model.
        ours: the exported C.
        shooting: error reached and time of a cold solve, µs, by program.
    """

    name: str
    wanted: float
    unknowns: int
    ours: Exported
    shooting: dict[str, tuple[float, float]]

    @property
    def cells(self) -> list[str]:
        """A row of the table."""
        ours = self.ours
        cells = [self.name, f"{self.wanted:.0e}", str(self.unknowns), f"{ours.error:.0e}", f"{ours.kilobytes:.0f}"]
        cells += [f"{ours.compile_s:.1f}"]
        cells += [f"{ours.times[key]:.1f}" for key in ("igm_us", "jacobian_us", "warm_us", "cold_us")]
        return cells + self.shooting_cells

    @property
    def shooting_cells(self) -> list[str]:
        """Time of shooting, and how often it takes ours, by program."""
        cold = self.ours.times["cold_us"]
        return [f"{time:.0f} ({time / cold:.1f} ×)" for _, time in self.shooting.values()]

    @property
    def first_page_cells(self) -> list[str]:
        """A row of the table in the README."""
        cold = self.ours.times["cold_us"]
        return [f"{self.wanted:.0e}", str(self.unknowns), f"{cold:.1f}", *self.shooting_cells]


def raced(name: str, case: Case, error: float) -> Raced:
    model = model_of(case, error)
    ours = measured(model, case)
    shooting: dict[str, tuple[float, float]] = {}
    for program in PROGRAMS:
        found = race(case, steps_for(case, error, program), repeat=2000, program=program)
        shooting[program] = (case.tip_error(found["tip"]), float(found["cold_us"]))
    return Raced(name, error, model.size, ours, shooting)


HEADINGS = (
    "rod", "error / L", "unknowns", "reached", "C, kB", "gcc, s", "IGM", "residual + Jacobian", "warm", "cold",
    "plain shooting", "tuned shooting",
)  # fmt: skip

FIRST_PAGE_HEADINGS = ("error / L", "unknowns", "this package, C", "plain shooting", "tuned shooting")


def literal_line(case: Case) -> str:
    model = model_of(case, 1e-8)
    ours, theirs = measured(model, case).times, measured(literal(model), case, repeat=20).times
    cold, jacobian = (theirs[key] / ours[key] for key in ("cold_us", "jacobian_us"))
    return (
        "The literal permuted system with the same modes and nodes (B1 Kirchhoff at 1e-8) takes "
        f"{theirs['cold_us']:.0f} µs cold, {cold:.0f} × as long, and {theirs['jacobian_us']:.0f} µs for residual and "
        f"Jacobian, {jacobian:.0f} × as long."
    )


# Peers


def in_python(case: Case) -> Iterator[Peer]:
    """Our own solver in Python: everything from the scene on, and once more with what is built."""
    for tolerance in ERRORS:
        scene = scene_from_dict(case.scene(tolerance))
        solution, took = shortest(partial(solve_rods, scene), 1)
        x, y, z = solution.tip().position
        error = case.tip_error((x, y, z))
        yield Peer("cosserat, Python", f"tolerance {tolerance:.0e}, choosing and building included", error, took)
        _, again = shortest(partial(solve, solution.model), 20)
        yield Peer("cosserat, Python", f"tolerance {tolerance:.0e}, built", error, again)


def in_c(rows: Sequence[Raced]) -> Iterator[Peer]:
    """The exported C and shooting by hand, as peers."""
    for row in rows:
        yield Peer("cosserat, exported C", f"tolerance {row.wanted:.0e}", row.ours.error, row.ours.times["cold_us"])
        for program, (error, took) in row.shooting.items():
            yield Peer(f"{program} shooting, C", f"for {row.wanted:.0e}", error, took)


def peer_table(rows: Sequence[Peer]) -> str:
    cells = []
    for row in sorted(rows, key=lambda row: row.package):
        known = math.isfinite(row.error)
        error, took = (f"{row.error:.0e}", duration(row.microseconds)) if known else ("–", "–")
        cells.append([row.package, row.setting, error, took])
    return table(("package", "", "tip error / L", "time"), cells)


def duration(microseconds: float) -> str:
    """In µs, ms or s."""
    for unit, size in (("s", 1e6), ("ms", 1e3)):
        if microseconds >= size:
            value = microseconds / size
            return f"{value:.0f} {unit}" if value >= 10 else f"{value:.1f} {unit}"
    return f"{microseconds:.0f} µs"


# All of it


def limits() -> str:
    return "\n".join(f"* {package}: {words}" for package, words in LIMITS.items())


def first_page_text(rows: Sequence[Raced]) -> str:
    return table(FIRST_PAGE_HEADINGS, [row.first_page_cells for row in rows if row.name == ON_FIRST_PAGE])


def accuracy_text(rows: Sequence[Raced]) -> str:
    return "\n\n".join(
        [
            table(HEADINGS, [row.cells for row in rows]),
            literal_line(CASES["B1 Kirchhoff"]),
            f"![Error against time: exported C, shooting by hand, packages from PyPI]({FIGURE})",
        ]
    )


def main(
    write: Annotated[bool, typer.Option("--write", help="Put tables and figure into README.md and docs.")] = False,
    only: Annotated[str, typer.Option(help="Rods whose name begins so; README and figure take all.")] = "",
) -> None:
    """Print the tables of the race."""
    cases = {name: case for name, case in CASES.items() if name.startswith(only)}
    if STOUT.startswith(only):
        cases[STOUT] = stout()
    rows, met = [], []
    with Progress(transient=True) as bar:
        for name, case, error in bar.track([(n, c, e) for n, c in cases.items() for e in ERRORS], description="racing"):
            rows.append(raced(name, case, error))
        if STOUT in cases:
            known = (in_c([row for row in rows if row.name == STOUT]), in_python(cases[STOUT]), peers(cases[STOUT]))
            met = list(bar.track(chain(*known), total=21, description="peers"))
    print(table(HEADINGS, [row.cells for row in rows]), peer_table(met), sep="\n\n")
    if write and met:
        put(DOCS / "accuracy.md", PEERS_BEGIN, PEERS_END, f"{peer_table(met)}\n\n{limits()}")
    if write and not only:
        put(README, BEGIN, END, first_page_text(rows))
        put(DOCS / "accuracy.md", BEGIN, END, accuracy_text(rows))
        (DOCS / FIGURE).parent.mkdir(exist_ok=True)
        write_figure(race_figure(rows, met, STOUT), DOCS / FIGURE, dpi=110)


if __name__ == "__main__":
    typer.run(main)
