"""Held rods at four tolerances each: how many end on another equilibrium at one of them.

Which of several near equilibria is found must not hang on the discretisation. With `--fixed` modes and nodes that a
user fixes are tried too.
"""

from __future__ import annotations

import sys
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path
from typing import Annotated

import typer
from rich.progress import track

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from tests.fuzz.held import TOLERANCES, Accuracy, all_alike  # noqa: E402

FIXED: list[Accuracy] = [{"modes": 9, "nodes": 20}, {"modes": 14, "nodes": 32}]


def main(
    count: Annotated[int, typer.Option(help="Scenes.")] = 500,
    first: Annotated[int, typer.Option(help="Seed of the first.")] = 0,
    fixed: Annotated[bool, typer.Option("--fixed", help="Modes and nodes of a user too.")] = False,
    workers: Annotated[int | None, typer.Option(help="Processes; by default one for each core.")] = None,
) -> None:
    """Count the scenes that differ; exit code 1 if one does."""
    accuracies: list[Accuracy] = [{"tolerance": tolerance} for tolerance in TOLERANCES]
    if fixed:
        accuracies = FIXED + accuracies
    seeds = range(first, first + count)
    different = []
    with ProcessPoolExecutor(workers) as pool:
        verdicts = pool.map(partial(all_alike, accuracies=accuracies), seeds)
        shown = track(verdicts, "Scenes", count, disable=not sys.stdout.isatty())
        for seed, same in zip(seeds, shown, strict=True):
            if not same:
                different.append(seed)
                print(f"seed {seed}: not the same equilibrium", flush=True)
    print(f"{count} held rods x {len(accuracies)}: {len(different)} differ")
    raise typer.Exit(int(bool(different)))


if __name__ == "__main__":
    typer.run(main)
