"""A second of motion of a soft cantilever, let go from straight under its weight: this package beside others.

Largest error of the tip over the length at eleven times, against digits of a chain of rigid slices, and processor time.
All in one run, with an empty cache of compiled code; contestants take turns, for other work on the machine lengthens
processor time too. `--write` puts the table into docs/accuracy.md and draws docs/figures/motion_peers.png. `--only`
names packages that are run alone, ours with the first of ours: their rows replace those of the page.
"""

from __future__ import annotations

import json
import math
import os
import tomllib
from collections.abc import Collection, Iterator, Sequence
from functools import partial
from itertools import chain
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any

import numpy as np
import typer
from doc_tables import put, rows_of, table
from motion_rivals import INTERVAL, LENGTH, LIMITS, REPEATS, TIMES, Paths, Rival, Run, prepared, rivals
from rich.progress import Progress

from cosserat_casadi import Compiled, Model, Scene, export, load, scene_from_dict, simulate
from cosserat_casadi.compiling.cache import VARIABLE
from cosserat_casadi.motion.motion_compiler import MotionCompiler
from cosserat_casadi.motion.pose_series import poses_of
from cosserat_casadi.motion.simulate import Simulator, started
from cosserat_casadi.motion.trajectory import Motion
from cosserat_casadi.plots.figure import figure_class, write_figure

REFERENCE = Path(__file__).parent / "reference"
TABLES = tomllib.loads((REFERENCE / "release_planar.toml").read_text())
DOCS = Path(__file__).parents[1] / "docs"
BEGIN, END = "<!-- rivals: written by benchmarks/motion_peers.py -->", "<!-- end of rivals -->"
FIGURE = "figures/motion_peers.png"

TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5)
OURS = "cosserat, Python"
COMPILED = "cosserat, Python, compiled"
ON_CHOSEN = "cosserat, one motion on the modes chosen"
IN_C = "cosserat, the same in exported C"
C_STEPS = {1e-2: 1e-2, 1e-3: 4e-3, 1e-4: 1e-3}
"""Size of the steps in C on the modes of a tolerance, s: shorter ones hardly make the error smaller."""

HERE = (OURS, COMPILED, ON_CHOSEN, IN_C)
"""Our contestants."""

HEADINGS = ("package", "", "tip error / L", "processor, s", "with first call, s")
ROWS_OF_OTHERS = 22


def released(tolerance: float, strain: str = "reissner") -> Scene:
    """The scene, with a tolerance of its motion and a strain model, from tables: other models have no file."""
    (rod,) = TABLES["rods"]
    simulation = {**TABLES["simulation"], "tolerance": tolerance, "times": TIMES.tolist()}
    return scene_from_dict({**TABLES, "rods": [{**rod, "strain": strain}], "simulation": simulation})


def ours(packages: Collection[str]) -> Iterator[Rival]:
    """Ours at each tolerance: with all that chooses and estimates, and the last motion once more by itself.

    By default equations are compiled where that pays; from the second time on the models are built. With ``compiled``
    they are compiled the first time, and come from the cache afterwards.
    """
    for tolerance in TOLERANCES:
        motions = list[Motion]()
        rival = prepared(OURS, f"tolerance {tolerance:.0e}", partial(chosen, tolerance, None, motions))
        motion = motions[-1]
        words = f"tolerance {tolerance:.0e}, estimate {motion.error_estimate:.0e}"
        if not motion.converged:
            yield Rival(OURS, f"{words}: {motion.outcome.name.lower()}")
            continue
        rival.setting = words
        yield rival
        unknowns = f"{motion.model.size} unknowns"
        if COMPILED in packages:
            yield prepared(COMPILED, words, partial(chosen, tolerance, True, motions))
        if ON_CHOSEN in packages:
            yield prepared(ON_CHOSEN, f"tolerance {tolerance:.0e}: {unknowns}", partial(again, motion, tolerance))
        if IN_C in packages and tolerance in C_STEPS:
            step = C_STEPS[tolerance]
            yield prepared(IN_C, f"{unknowns}, {1e3 * step:g} ms", partial(in_c, motion.model, step))


def chosen(tolerance: float, compiled: bool | None, motions: list[Motion]) -> Run:
    """The motion with all that chooses and estimates; it is appended to the motions."""

    folder = Path(os.environ[VARIABLE]).with_name("compiled" if compiled else "default")

    def run() -> Paths:
        # What one of both has compiled is nothing to the other.
        os.environ[VARIABLE] = str(folder)
        motions.append(simulate(released(tolerance), compiled=compiled))
        return np.asarray(motions[-1].tip("rod").position)

    return run


def again(motion: Motion, tolerance: float) -> Run:
    """The motion on the same modes, once, with steps of a tolerance: nothing is chosen, and no error estimated."""
    simulation = motion.model.scene.simulation
    assert simulation is not None
    start = started(motion.model, simulation, None)
    simulator = Simulator(motion.model, simulation, start, source=MotionCompiler(always=True))

    def run() -> Paths:
        history = simulator.controlled(tolerance)
        x, inputs = history.rough_positions(TIMES)
        return np.asarray(poses_of(motion.model.tip["rod"], x, inputs).position)

    return run


def in_c(model: Model, step: float) -> Run:
    """The motion in steps of one size by the exported functions, called one by one from Python."""
    with TemporaryDirectory() as folder:
        exported = load(export(model, folder, "released", dynamics=True, estimate_errors=False))
    assert isinstance(exported, Compiled)
    per_time = round(INTERVAL / step)
    inputs = exported.defaults

    def run() -> Paths:
        # Straight, with its weight acting from the first instant.
        state = exported.rest(inputs=0 * inputs)
        assert state is not None
        memory = exported.step_memory()
        unknowns = [state.x]
        for _ in TIMES[1:]:
            for _ in range(per_time):
                taken = exported.step(state, step, inputs, memory=memory)
                if not taken.done:
                    raise RuntimeError(taken.status.value)
                state = taken.state
            unknowns.append(state.x)
        x = np.array(unknowns)
        return np.asarray(poses_of(model.tip["rod"], x, np.tile(inputs, (len(x), 1))).position)

    return run


def true_tips() -> Paths:
    """The digits."""
    case = json.loads((REFERENCE / "release_planar.json").read_text())
    assert np.allclose(case["times"], TIMES)
    return np.array(case["tip"])


def error(tip: Paths | None, true: Paths) -> float:
    """Largest distance of the tip from where it should be, over the length; nan where there is no tip."""
    if tip is None:
        return math.nan
    return float(np.linalg.norm(tip - true, axis=1).max() / LENGTH)


def cells(row: Rival, true: Paths) -> list[str]:
    """A row of the table."""
    if row.tip is None:
        return [row.package, row.setting, "–", "–", "–"]
    return [row.package, row.setting, f"{error(row.tip, true):.1e}", f"{row.seconds:.2g}", f"{row.first:.2g}"]


def merged(lines: list[list[str]], only: Collection[str]) -> list[list[str]]:
    """Rows of the table on the page, of which those of some packages are replaced by new ones."""
    old = rows_of(DOCS / "accuracy.md", BEGIN, END)
    both = [line for line in old if line[0] not in only] + lines
    return [line for package in (*HERE, *LIMITS) for line in both if line[0] == package]


def without_shear(rows: Sequence[Rival], true: Paths) -> str:
    """What the equations of a cable without shear and extension leave out, and its errors against those equations."""
    if not any(row.package == "MuJoCo" and row.tip is not None for row in rows):
        kept = [line for line in DOCS.joinpath("accuracy.md").read_text().splitlines() if "MuJoCo's equations:" in line]
        return kept[0].removeprefix("* ")
    stiff = simulate(released(1e-4, "kirchhoff")).tip("rod").position
    own = [f"{error(row.tip, stiff):.1e}" for row in rows if row.package == "MuJoCo" and row.tip is not None]
    return (
        f"MuJoCo's equations: our own motion, to 1e-4, of a rod that neither shears nor stretches is "
        f"{error(stiff, true):.1e} of the length away. Compared with that motion, the errors of the cable are "
        f"{', '.join(own)}."
    )


STYLES = {
    OURS: ("#ee8866", "P"),
    COMPILED: ("#bb5566", "v"),
    ON_CHOSEN: ("#cc3311", "*"),
    IN_C: ("#cc3311", "X"),
    "Exudyn": ("#4477aa", "o"),
    "MuJoCo": ("#228833", "s"),
    "PyElastica": ("#777777", "D"),
    "soromox": ("#aa3377", "^"),
}
"""Colour and marker of every contestant."""


def drawn(lines: Sequence[Sequence[str]]) -> Any:
    """Error against processor time."""
    figure = figure_class()(figsize=(7.2, 4.8), layout="constrained")
    axes = figure.subplots()
    for package, (colour, marker) in STYLES.items():
        points = [(float(line[3]), float(line[2])) for line in lines if line[0] == package and line[2] != "–"]
        if not points:
            continue
        times, errors = zip(*sorted(points), strict=True)
        axes.loglog(times, errors, marker=marker, markersize=6, color=colour, linewidth=1.2, label=package)
    axes.set_xlabel("processor time for a second of motion, s")
    axes.set_ylabel("tip error / length")
    axes.grid(alpha=0.3)
    figure.legend(loc="outside lower center", ncols=4, fontsize=7.5)
    return figure


def main(
    write: Annotated[bool, typer.Option("--write", help="Put table and figure into docs.")] = False,
    only: Annotated[
        list[str] | None, typer.Option(help="A package of the table to run alone; may be repeated.")
    ] = None,
) -> None:
    """Print the table."""
    true = true_tips()
    names = only or [*HERE, *LIMITS]
    with TemporaryDirectory() as cache, Progress(transient=True) as bar:
        os.environ[VARIABLE] = f"{cache}/default"
        contestants = chain(ours(names) if OURS in names else (), rivals(names))
        rows = list(bar.track(contestants, total=4 * len(TOLERANCES) + ROWS_OF_OTHERS, description="preparing"))
        for _ in bar.track(range(REPEATS), description="moving"):
            for row in rows:
                row.again()
    limits = [f"{package}: {words}" for package, words in LIMITS.items()]
    remarks = "\n".join(f"* {words}" for words in [*limits, without_shear(rows, true)])
    lines = [cells(row, true) for row in rows]
    if only:
        lines = merged(lines, only)
    text = f"{table(HEADINGS, lines)}\n\n{remarks}"
    print(text)
    if write:
        picture = f"![Error of the tip against processor time]({FIGURE})"
        put(DOCS / "accuracy.md", BEGIN, END, f"{text}\n\n{picture}")
        write_figure(drawn(lines), DOCS / FIGURE, dpi=110)


if __name__ == "__main__":
    typer.run(main)
