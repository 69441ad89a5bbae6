"""Does the tolerance pick a discretisation that meets it, and a cheap one? 200 random scenes, four tolerances.

The true error of a pick is its distance to shooting (the strong form, DOP853 at 1e-13), which starts from a far finer
discretisation; where shooting does not get there, that one stands in. The cheapest discretisation is searched by brute
force: all intervals and integrators of a wide window, and for each the modes of every component by several greedy
descents. Candidates cheaper than the pick, by the time that accuracy/cost.py foresees, are built, solved and judged by
their true error, cheapest first. For a sample of picks, pick and cheapest are compiled with gcc -O2 and timed.

Rods of matter and robots are judged by a far finer discretisation alone. Robots in which it violates the weak form of
the clamped rod that each is in equilibrium are left out.

Rows go to build/dial/*.csv one by one: Ctrl-C keeps them, and the same command goes on where it was stopped.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from math import ceil
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from dial_report import Results, write_results
from random_rods import ROD, scene_at, tables
from rich.progress import Progress
from rows import append, read

from cosserat_casadi import Solution, build, discretise, solve
from cosserat_casadi.accuracy.cost import foreseen_time, spread_on
from cosserat_casadi.accuracy.preview import Preview
from cosserat_casadi.accuracy.refine import solve_rods
from cosserat_casadi.codegen.timed_program import Program, Times
from cosserat_casadi.compiling.compiler import find_compiler
from cosserat_casadi.equilibrium.metrics import largest_turn, prolong
from cosserat_casadi.maths.pose_change import change_size
from cosserat_casadi.rod.discretisation import Discretisation
from tests.fuzz.verdict import evaluate
from tests.pose_errors import pose_error
from tests.reference.robot_scenes import robot_scene
from tests.reference.shooting import NoEquilibriumError, solve_by_shooting
from tests.shooting_near import shoot

TOLERANCES = (1e-3, 1e-5, 1e-7, 1e-9)
FOLDER = Path(__file__).parents[1] / "build" / "dial"
DESCENTS = 3
"""Random descents in the modes for each grid, beside the greedy one."""
TRIED = 6
"""Most candidates of the brute force that are solved."""
WEAK = 1e-8
"""Largest violation of the weak form by the truth of a robot."""
GRIDS = 4
"""Numbers of intervals looked at for each integrator, from the fewest that do."""

Tip = tuple[np.ndarray, np.ndarray]
"""Position over the length, and rotation matrix."""


@dataclass(frozen=True)
class Row:
    """One scene at one tolerance; what was not found is not a number.

    Attributes:
        seed: of the scene.
        tolerance: asked for.
        outcome: label of the solution's outcome.
        seconds: that the pick and its solution took.
        estimate: error that the solution states.
        error: distance of the tip pose to the truth.
        reference: "shooting", or "finer" where that fails.
        cold: distance to shooting that followed the loads from nothing by itself.
        cost: foreseen time of the pick, µs.
        chosen: the pick.
    """

    seed: int
    tolerance: float
    outcome: str
    seconds: float
    estimate: float = np.nan
    error: float = np.nan
    reference: str = ""
    cold: float = np.nan
    cost: float = np.nan
    chosen: str = ""


@dataclass(frozen=True)
class Cheapest:
    """The cheapest discretisation of a scene that truly meets a tolerance, the pick included.

    Attributes:
        seed: of the scene.
        tolerance: asked for.
        cost: foreseen time of the pick, µs.
        cheapest: that of the cheapest; not a number where none was found.
        chosen: the pick.
        best: the cheapest.
    """

    seed: int
    tolerance: float
    cost: float
    cheapest: float
    chosen: str
    best: str


@dataclass(frozen=True)
class Timed:
    """Compiled times of a pick and of the cheapest, µs."""

    seed: int
    tolerance: float
    foreseen_chosen: float
    foreseen_best: float
    jacobian_chosen: float
    jacobian_best: float
    cold_chosen: float
    cold_best: float


# True errors


def run_scene(seed: int, cold: bool, what: str) -> list[Row]:
    """Four tolerances; shooting knows rods alone, and of a robot without a truth there are none."""
    rows, solutions = [], []
    for tolerance in TOLERANCES:
        begin = time.perf_counter()
        solution = solve_rods(scene_at(seed, tolerance, what))
        seconds = time.perf_counter() - begin
        estimate = np.nan if solution.error_estimate is None else solution.error_estimate
        rows.append(Row(seed, tolerance, solution.outcome.label, seconds, estimate))
        solutions.append(solution)
    found = [solution for solution in solutions if solution.converged]
    if not found:
        return rows
    finer = found[-1] if what == "rods" else far_finer(found[-1])
    if what == "robots" and (weak := evaluate(robot_scene(seed), finer).weak) > WEAK:
        print(f"robot {seed} is left out: its far finer solution violates the weak form by {weak:.1e}")
        return []
    truth, reference = true_tip(finer) if what == "rods" else (tip(finer), "finer")
    followed = cold_tip(seed) if cold else None
    return [
        judged(row, solution, truth, followed, reference) if solution.converged else row
        for row, solution in zip(rows, solutions, strict=True)
    ]


def judged(row: Row, solution: Solution, truth: Tip, followed: Tip | None, reference: str) -> Row:
    pick = solution.model.discretisation[ROD]
    return replace(
        row,
        error=distance(tip(solution), truth),
        reference=reference,
        cold=np.nan if followed is None else distance(tip(solution), followed),
        cost=cost_of(solution, pick),
        chosen=words(pick),
    )


def true_tip(near: Solution) -> tuple[Tip, str]:
    """Tip of shooting that starts at the clamp's wrench of a solution; that of a far finer solution where it fails."""
    try:
        state = shoot(near, [1.0])
    except NoEquilibriumError:
        return tip(far_finer(near)), "finer"
    return (state.position[0] / state.length, state.rotation[0]), "shooting"


def far_finer(near: Solution) -> Solution:
    """Far finer than the reference solution of the tightest tolerance.

    Raises:
        RuntimeError: it does not converge.
    """
    pick = near.model.discretisation[ROD]
    modes = max(pick.modes) + 8
    # Laws with kinks take more nodes than modes ask for.
    nodes = max(2 * modes + 16 + ceil(largest_turn(near)), 2 * pick.nodes)
    model = build(near.model.scene, discretise(near.model.scene, modes, nodes, "magnus8"))
    finer = solve(model, start=prolong(near, model))
    if not finer.converged:
        raise RuntimeError(finer.message)
    return finer


def tip(solution: Solution) -> Tip:
    pose, length = solution.tip(), solution.model.scene.rods[0].length
    return pose.position / length, pose.rotation


def cold_tip(seed: int) -> Tip | None:
    try:
        found = solve_by_shooting(tables(seed), samples=2)
    except NoEquilibriumError:
        return None
    return found.tip_position / tables(seed)["rods"][0]["length"], found.tip_rotation


def distance(a: Tip, b: Tip) -> float:
    return pose_error(a, b, 1.0)


def cost_of(solution: Solution, candidate: Discretisation) -> float:
    model = solution.model
    return foreseen_time(model.discrete.rods[ROD].properties, candidate, spread_on(model.scene, ROD))


def words(d: Discretisation) -> str:
    return f"{' '.join(map(str, d.modes))} | {d.nodes} | {d.transport}"


def from_words(solution: Solution, text: str) -> Discretisation:
    modes, nodes, transport = text.split(" | ")
    near = solution.model.discretisation[ROD]
    return replace(near, modes=tuple(map(int, modes.split())), nodes=int(nodes), transport=transport)


# The cheapest discretisation by brute force


def run_search(rows: list[dict[str, str]]) -> list[Cheapest]:
    """All tolerances of one scene."""
    judged_rows = [row for row in rows if row["chosen"]]
    if not judged_rows:
        return [Cheapest(int(row["seed"]), float(row["tolerance"]), np.nan, np.nan, "", "") for row in rows]
    seed = int(rows[0]["seed"])
    finer = far_finer(solve_rods(scene_at(seed, float(judged_rows[-1]["tolerance"]))))
    truth, _ = true_tip(finer)
    return [search(finer, truth, row) for row in judged_rows]


def search(finer: Solution, truth: Tip, row: dict[str, str]) -> Cheapest:
    """The cheapest that truly meets the tolerance; the pick where nothing cheaper does."""
    tolerance, cost = float(row["tolerance"]), float(row["cost"])
    meets = float(row["error"]) <= tolerance
    candidates = Brute(Preview(finer), tolerance, from_words(finer, row["chosen"])).ranked()
    cheaper = [candidate for candidate in candidates if cost_of(finer, candidate) < (cost if meets else np.inf)]
    best = (cost, row["chosen"]) if meets else (np.nan, "")
    for candidate in cheaper[:TRIED]:
        found = solve(build(finer.model.scene, {ROD: candidate}))
        if found.converged and distance(tip(found), truth) <= tolerance:
            best = cost_of(finer, candidate), words(candidate)
            break
    return Cheapest(int(row["seed"]), tolerance, cost, best[0], row["chosen"], best[1])


@dataclass
class Brute:
    """All grids of a wide window, with the fewest modes that each allows."""

    preview: Preview
    tolerance: float
    near: Discretisation
    _shifts: dict[tuple[int, ...], np.ndarray] = field(default_factory=dict)

    def ranked(self) -> list[Discretisation]:
        """Candidates that should meet the tolerance, by their foreseen time."""
        rng, found = np.random.default_rng(0), set()
        for transport, nodes, shift in self.grids():
            start = self.fewest_uniform(shift)
            if start is None:
                continue
            for order in [None, *[rng.permutation(len(start)) for _ in range(DESCENTS)]]:
                modes = self.greedy(start, shift) if order is None else self.in_turn(start, shift, order)
                found.add(replace(self.near, modes=modes, nodes=nodes, transport=transport))
        return sorted(found, key=lambda d: cost_of(self.preview.reference, d))

    def grids(self) -> Iterator[tuple[str, int, np.ndarray]]:
        """Integrator, intervals and change of the tip that they make."""
        enough = self.fewest_uniform(self.preview.no_shift)
        modes = {ROD: tuple(m + 1 for m in enough or self.near.modes)}
        x = self.preview.with_modes(modes)
        turning = len(self.preview.model.discrete.rods[ROD].properties.turning_axes)
        for transport in ("magnus4", "magnus6", "magnus8") if turning > 1 else ("magnus6",):
            met = 0
            for nodes in range(2, self.near.nodes + 8):
                grid = replace(self.near, nodes=nodes, transport=transport)
                shift = self.preview.grid_shift(x, modes, {ROD: grid})
                if change_size(shift) <= 2 * self.tolerance:
                    yield transport, nodes, shift
                    met += 1
                if met == GRIDS:
                    break

    def meets(self, modes: tuple[int, ...], shift: np.ndarray) -> bool:
        if modes not in self._shifts:
            self._shifts[modes] = self.preview.mode_shift({ROD: modes})
        return change_size(self._shifts[modes] + shift) <= self.tolerance

    def fewest_uniform(self, shift: np.ndarray) -> tuple[int, ...] | None:
        full = self.preview.model.discretisation[ROD].modes
        return next((t for m in range(1, max(full)) if self.meets(t := (m,) * len(full), shift)), None)

    def greedy(self, modes: tuple[int, ...], shift: np.ndarray) -> tuple[int, ...]:
        while True:
            trials = [less(modes, c) for c in range(len(modes)) if modes[c] > 1]
            trials = [trial for trial in trials if self.meets(trial, shift)]
            if not trials:
                return modes
            modes = min(trials, key=lambda trial: change_size(self._shifts[trial] + shift))

    def in_turn(self, modes: tuple[int, ...], shift: np.ndarray, order: np.ndarray) -> tuple[int, ...]:
        for c in order:
            while modes[c] > 1 and self.meets(less(modes, c), shift):
                modes = less(modes, c)
        return modes


def less(modes: tuple[int, ...], c: int) -> tuple[int, ...]:
    return (*modes[:c], modes[c] - 1, *modes[c + 1 :])


# Compiled times of a sample


def timed(row: dict[str, str]) -> Timed | None:
    """Pick and cheapest of a row compiled and run; None where a program fails."""
    seed, tolerance = int(row["seed"]), float(row["tolerance"])
    scene = scene_at(seed, tolerance)
    any_model = solve(build(scene, discretise(scene, 2, 4)))
    programs = [
        Program(build(scene, {ROD: from_words(any_model, row[which])}), find_compiler()) for which in ("chosen", "best")
    ]
    for program in programs:
        program.wait()
    times = [program.times() for program in programs]
    for program in programs:
        program.close()
    pick, best = times
    if not (isinstance(pick, Times) and isinstance(best, Times)):
        return None
    foreseen = float(row["cost"]), float(row["cheapest"])
    return Timed(seed, tolerance, *foreseen, pick.jacobian, best.jacobian, pick.cold, best.cold)


def compile_sample(rows: list[dict[str, str]], count: int, file: Path) -> None:
    """Rows drawn from those whose cheapest is not the pick."""
    differing = [row for row in rows if row["best"] and row["best"] != row["chosen"]]
    drawn = np.random.default_rng(0).permutation(len(differing))[:count]
    done = {(row["seed"], row["tolerance"]) for row in read(file)}
    with Progress(transient=True) as bar:
        for k in bar.track(drawn, description="compiling"):
            row = differing[k]
            found = None if (row["seed"], row["tolerance"]) in done else timed(row)
            if found is not None:
                append(file, [found])


# The whole run


def run_scenes(seeds: range, cold: int, file: Path, what: str) -> None:
    done = {int(row["seed"]) for row in read(file)}
    with Progress(transient=True) as bar:
        for k, seed in enumerate(bar.track(seeds, description="true errors")):
            rows = run_scene(seed, k < cold, what) if seed not in done else []
            if rows:
                append(file, rows)


def run_searches(seeds: range, scenes: list[dict[str, str]], file: Path) -> None:
    done = {int(row["seed"]) for row in read(file)}
    with Progress(transient=True) as bar:
        for seed in bar.track(seeds, description="cheapest"):
            if seed not in done:
                append(file, run_search([row for row in scenes if int(row["seed"]) == seed]))


def main(
    scenes: Annotated[int, typer.Option(help="Number of random scenes.")] = 200,
    seed: Annotated[int, typer.Option(help="Seed of the first.")] = 1000,
    searched: Annotated[int, typer.Option(help="Scenes whose cheapest discretisation is searched.")] = 200,
    cold: Annotated[int, typer.Option(help="Scenes that shooting follows from the unloaded rod too.")] = 20,
    compiled: Annotated[int, typer.Option(help="Picks that are compiled beside the cheapest.")] = 20,
    folder: Annotated[Path, typer.Option(help="Where the rows are kept.")] = FOLDER,
    matter: Annotated[
        bool, typer.Option("--matter", help="Scenes with laws of materials, chambers and muscles: true errors alone.")
    ] = False,
    robots: Annotated[
        bool,
        typer.Option("--robots", help="Robots of disks, straight tendons, joints and drives: true errors alone."),
    ] = False,
    write: Annotated[bool, typer.Option("--write", help="Put figures and table into docs; of rods alone.")] = False,
) -> None:
    """Judge the dial; what is measured already is not measured again."""
    what = "matter" if matter else "robots" if robots else "rods"
    if what != "rods":
        folder = folder / what
        searched = cold = compiled = 0
    judged_rows, cheapest, sample = (folder / name for name in ("scenes.csv", "cheapest.csv", "timed.csv"))
    try:
        run_scenes(range(seed, seed + scenes), cold, judged_rows, what)
        run_searches(range(seed, seed + min(scenes, searched)), read(judged_rows), cheapest)
        compile_sample(read(cheapest), compiled, sample)
    except KeyboardInterrupt:
        print("stopped; the same command goes on from here")
    results = Results(read(judged_rows), read(cheapest), read(sample))
    print(results.text)
    if write and what == "rods":
        write_results(results)


if __name__ == "__main__":
    typer.run(main)
