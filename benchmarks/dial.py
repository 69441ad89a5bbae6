"""Does the tolerance pick a discretisation that meets it, and a cheap one? Random scenes, four tolerances.

The true error of a solution is its distance to a far finer one, for some scenes also to an independent shooting
method. The cheapest discretisation is searched by brute force: all intervals and integrators of a wide window, and
for each the per-component modes by several greedy descents. Candidates are ranked by previews below the fine solution;
the best ones are built, solved, judged by their true error, and their operations are counted. Cost is the number of
scalar operations of residual and Jacobian.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass, field, replace
from math import ceil
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.progress import Progress, TimeRemainingColumn
from rich.table import Table

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from cosserat_casadi import Scene, Solution, build, discretise, scene_from_dict, solve, solve_scene
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.solver.accuracy import largest_turn
from cosserat_casadi.solver.cost import foreseen_operations
from cosserat_casadi.solver.preview import Preview
from tests.reference.random_scenes import random_scene
from tests.reference.shooting import NoEquilibriumError, solve_by_shooting

TOLERANCES = (1e-3, 1e-5, 1e-7, 1e-9)
ROD = "rod"
DESCENTS = 3
"""Random descents in the modes for each grid, beside the greedy one."""
COUNTED = 3
"""Candidates of the brute force that are solved and whose operations are counted."""


@dataclass
class Row:
    """One scene at one tolerance; numbers that were not found are not numbers."""

    seed: int
    tolerance: float
    outcome: str
    seconds: float
    estimate: float = np.nan
    error: float = np.nan
    oracle_error: float = np.nan
    operations: float = np.nan
    cheapest: float = np.nan
    chosen: str = ""
    best: str = ""


# One scene


def tables(seed: int) -> dict[str, Any]:
    """A random scene; every second one with twice the tip force, up to 20 EI/L²."""
    scene = random_scene(seed)
    for load in scene["loads"]:
        if seed % 2 and load["kind"] == "tip_wrench":
            load["force"] = [2 * v for v in load["force"]]
    return scene


def scene_at(seed: int, tolerance: float) -> Scene:
    return scene_from_dict({**tables(seed), "accuracy": {"tolerance": tolerance}})


def run_scene(seed: int, shooting: bool, brute: bool) -> list[Row]:
    rows, solutions = [], []
    for tolerance in TOLERANCES:
        begin = time.perf_counter()
        solution = solve_scene(scene_at(seed, tolerance))
        seconds = time.perf_counter() - begin
        estimate = np.nan if solution.error_estimate is None else solution.error_estimate
        rows.append(Row(seed, tolerance, solution.outcome.label, seconds, estimate))
        solutions.append(solution)
    truth = finer(seed, solutions[-1]) if solutions[-1].converged else None
    if truth is None:
        return rows
    oracle = oracle_tip(seed) if shooting else None
    for row, solution in zip(rows, solutions, strict=True):
        if not solution.converged:
            continue
        row.error = distance(tip(solution), tip(truth))
        row.oracle_error = np.nan if oracle is None else distance(tip(solution), oracle)
        if brute:
            row.chosen = words(solution.model.discretisation[ROD])
            row.operations = float(solution.model.operations(solution.model.jacobian))
            row.cheapest, row.best = cheapest(truth, solution, row.tolerance, row.operations)
    return rows


def finer(seed: int, solution: Solution) -> Solution | None:
    """Far finer than the witness of the tightest tolerance, from a cold start."""
    scene = scene_at(seed, TOLERANCES[-1])
    modes = max(solution.model.discretisation[ROD].modes) + 8
    nodes = 2 * modes + 16 + ceil(largest_turn(solution))
    truth = solve(build(scene, discretise(scene, modes, nodes, "magnus8")))
    return truth if truth.converged else None


def tip(solution: Solution) -> np.ndarray:
    pose, length = solution.tip(), solution.model.scene.rods[0].length
    return np.concatenate([pose.position[0] / length, pose.rotation[0].ravel()])


def oracle_tip(seed: int) -> np.ndarray | None:
    try:
        found = solve_by_shooting(tables(seed))
    except NoEquilibriumError:
        return None
    return np.concatenate([found.tip_position / tables(seed)["rods"][0]["length"], found.tip_rotation.ravel()])


def distance(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.abs(a - b).max())


def words(d: Discretisation) -> str:
    return f"{','.join(map(str, d.modes))} N{d.nodes} {d.transport}"


# The cheapest discretisation by brute force


def cheapest(truth: Solution, solution: Solution, tolerance: float, operations: float) -> tuple[float, str]:
    """Operations of the cheapest discretisation found that truly meets the tolerance, the chosen one included."""
    best, name = (operations, "chosen") if distance(tip(solution), tip(truth)) <= tolerance else (np.inf, "")
    counted = 0
    for candidate in Brute(Preview(truth), tolerance, solution.model.discretisation[ROD]).ranked():
        model = build(truth.model.scene, {ROD: candidate})
        found = solve(model)
        if not found.converged or distance(tip(found), tip(truth)) > tolerance:
            continue
        counted += 1
        count = float(model.operations(model.jacobian))
        best, name = min((best, name), (count, words(candidate)))
        if counted == COUNTED:
            break
    return best, name


@dataclass
class Brute:
    """All grids of a wide window, with the fewest modes that each allows."""

    preview: Preview
    tolerance: float
    near: Discretisation
    _shifts: dict[tuple[int, ...], np.ndarray] = field(default_factory=dict)

    def ranked(self) -> list[Discretisation]:
        """Candidates that should meet the tolerance, by their foreseen operations."""
        rng, found = np.random.default_rng(0), set()
        for transport, nodes, shift in self.grids():
            start = self.fewest_uniform(shift)
            if start is None:
                continue
            for order in [None, *[rng.permutation(len(start)) for _ in range(DESCENTS)]]:
                modes = self.greedy(start, shift) if order is None else self.in_turn(start, shift, order)
                found.add(replace(self.near, modes=modes, nodes=nodes, transport=transport))
        rod = self.preview.model.frame.bases[ROD].rod
        return sorted(found, key=lambda d: foreseen_operations(rod, d))

    def grids(self) -> Iterator[tuple[str, int, np.ndarray]]:
        """Integrator, intervals and change of the tip that they make."""
        enough = self.fewest_uniform(np.zeros_like(self.preview.tips))
        modes = {ROD: tuple(m + 1 for m in enough or self.near.modes)}
        x = self.preview.with_modes(modes)
        turning = len(self.preview.model.frame.bases[ROD].rod.turning_axes)
        for transport in ("magnus4", "magnus6", "magnus8") if turning > 1 else ("magnus6",):
            met = 0
            for nodes in range(2, self.near.nodes + 8):
                grid = replace(self.near, nodes=nodes, transport=transport)
                shift = self.preview.grid_shift(x, modes, {ROD: grid})
                if np.abs(shift).max() <= 2 * self.tolerance:
                    yield transport, nodes, shift
                    met += 1
                if met == 4:
                    break

    def meets(self, modes: tuple[int, ...], shift: np.ndarray) -> bool:
        if modes not in self._shifts:
            self._shifts[modes] = self.preview.mode_shift({ROD: modes})
        return float(np.abs(self._shifts[modes] + shift).max()) <= self.tolerance

    def fewest_uniform(self, shift: np.ndarray) -> tuple[int, ...] | None:
        full = self.preview.model.discretisation[ROD].modes
        return next((t for m in range(1, max(full)) if self.meets(t := (m,) * len(full), shift)), None)

    def greedy(self, modes: tuple[int, ...], shift: np.ndarray) -> tuple[int, ...]:
        while True:
            trials = [less(modes, c) for c in range(len(modes)) if modes[c] > 1]
            trials = [trial for trial in trials if self.meets(trial, shift)]
            if not trials:
                return modes
            modes = min(trials, key=lambda trial: float(np.abs(self._shifts[trial] + shift).max()))

    def in_turn(self, modes: tuple[int, ...], shift: np.ndarray, order: np.ndarray) -> tuple[int, ...]:
        for c in order:
            while modes[c] > 1 and self.meets(less(modes, c), shift):
                modes = less(modes, c)
        return modes


def less(modes: tuple[int, ...], c: int) -> tuple[int, ...]:
    return (*modes[:c], modes[c] - 1, *modes[c + 1 :])


# The table


def summary(rows: list[Row]) -> Table:
    table = Table(title=f"{len({row.seed for row in rows})} random scenes")
    table.add_column("tolerance")
    headings = ("scenes", "no equilibrium", "unresolved", "within, %", "worst error/tol", "error > estimate, %")
    for heading in (*headings, "worst vs shooting", "cost ratio, median", "95 %", "most", "time, s"):
        table.add_column(heading, justify="right")
    for tolerance in (*TOLERANCES, None):
        chosen = [row for row in rows if tolerance is None or row.tolerance == tolerance]
        table.add_row("all" if tolerance is None else f"{tolerance:g}", *figures(chosen))
    return table


def figures(rows: list[Row]) -> list[str]:
    unresolved = sum(row.outcome == "unresolved" for row in rows)
    judged = [row for row in rows if np.isfinite(row.error)]
    excess = np.array([row.error / row.tolerance for row in judged])
    beyond = np.array([row.error > row.estimate for row in judged])
    oracle = np.array([row.oracle_error / row.tolerance for row in judged if np.isfinite(row.oracle_error)])
    ratio = np.array([row.operations / row.cheapest for row in judged if np.isfinite(row.cheapest)])
    failed = sum(row.outcome not in ("converged", "unresolved") for row in rows)
    found = [str(len(rows)), str(failed), str(unresolved)]
    found += (
        [f"{100 * np.mean(excess <= 1):.1f}", f"{excess.max():.2f}", f"{100 * beyond.mean():.1f}"]
        if len(excess)
        else ["–"] * 3
    )
    found.append(f"{oracle.max():.2f} ({len(oracle)})" if len(oracle) else "–")
    found += (
        [f"{np.median(ratio):.2f}", f"{np.percentile(ratio, 95):.2f}", f"{ratio.max():.2f}"]
        if len(ratio)
        else ["–"] * 3
    )
    return [*found, f"{np.median([row.seconds for row in rows]):.2f}"]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", type=int, default=20, help="number of random scenes")
    parser.add_argument("--seed", type=int, default=1000, help="seed of the first")
    parser.add_argument("--shooting", type=int, default=5, help="scenes that are solved by shooting too")
    parser.add_argument("--no-brute", action="store_true", help="errors only, no search for the cheapest")
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    parser.add_argument("--verbose", action="store_true", help="one line for each scene and tolerance")
    args = parser.parse_args()
    console, rows = Console(width=160), []
    with Progress(*Progress.get_default_columns()[:-1], TimeRemainingColumn(), console=console) as progress:
        task = progress.add_task("scenes", total=args.scenes)
        with ProcessPoolExecutor(args.jobs) as pool:
            jobs = [
                pool.submit(run_scene, args.seed + k, k < args.shooting, not args.no_brute) for k in range(args.scenes)
            ]
            for job in as_completed(jobs):
                rows += job.result()
                progress.advance(task)
                for row in job.result() if args.verbose else []:
                    console.print(
                        f"{row.seed} {row.tolerance:g} {row.outcome} error/tol {row.error / row.tolerance:.2g} "
                        f"{row.operations:.0f} / {row.cheapest:.0f} [{row.chosen}] [{row.best}] {row.seconds:.2f} s",
                        markup=False,
                        highlight=False,
                    )
    console.print(summary(rows))


if __name__ == "__main__":
    main()
