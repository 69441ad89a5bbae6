"""Held rods at four tolerances each: how many end on another equilibrium at one of them.

Which of several near equilibria is found must not hang on the discretisation. With `--fixed` modes and nodes that a
user fixes are tried too. `--log FILE` keeps one line a scene, and goes on from there.
"""

from __future__ import annotations

import json
import sys
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path
from typing import Annotated

import typer
from rich.progress import track

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from tests.fuzz.held import TOLERANCES, Accuracy, Verdict, verdict  # noqa: E402

FIXED: list[Accuracy] = [{"modes": 9, "nodes": 20}, {"modes": 14, "nodes": 32}]


def known(log: Path | None, accuracies: list[Accuracy]) -> dict[int, Verdict]:
    """Scenes judged before at the same accuracies."""
    if log is None or not log.exists():
        return {}
    lines = [json.loads(line) for line in log.read_text().splitlines()]
    return {line["seed"]: Verdict[line["verdict"]] for line in lines if line["accuracies"] == accuracies}


def main(
    count: Annotated[int, typer.Option(help="Scenes.")] = 500,
    first: Annotated[int, typer.Option(help="Seed of the first.")] = 0,
    fixed: Annotated[bool, typer.Option("--fixed", help="Modes and nodes of a user too.")] = False,
    workers: Annotated[int | None, typer.Option(help="Processes; by default one for each core.")] = None,
    log: Annotated[Path | None, typer.Option(help="One line a scene; a second run goes on from it.")] = None,
) -> None:
    """Count how the scenes end; exit code 1 if one differs."""
    accuracies: list[Accuracy] = [{"tolerance": tolerance} for tolerance in TOLERANCES]
    if fixed:
        accuracies = FIXED + accuracies
    found = known(log, accuracies)
    seeds = range(first, first + count)
    missing = [seed for seed in seeds if seed not in found]
    with ProcessPoolExecutor(workers) as pool:
        verdicts = pool.map(partial(verdict, accuracies=accuracies), missing)
        shown = track(verdicts, "Scenes", len(missing), disable=not sys.stdout.isatty())
        for seed, ended in zip(missing, shown, strict=True):
            found[seed] = ended
            if ended is not Verdict.ALIKE:
                print(f"seed {seed}: {ended.value}", flush=True)
            if log is not None:
                with log.open("a") as file:
                    file.write(json.dumps({"seed": seed, "accuracies": accuracies, "verdict": ended.name}) + "\n")
    counts = Counter(found[seed] for seed in seeds)
    print(f"{count} held rods x {len(accuracies)}: {counts[Verdict.DIFFERENT]} differ")
    for ended in Verdict:
        print(f"{counts[ended]:5d}  {ended.value}")
    raise typer.Exit(int(counts[Verdict.DIFFERENT] > 0))


if __name__ == "__main__":
    typer.run(main)
