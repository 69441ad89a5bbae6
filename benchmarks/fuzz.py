"""Random legal scenes at the ends of what is legal: does each end in a true outcome?

Counts outcomes, the longest solve and the worst violation of an independent weak form. `--write` puts the figures
into docs/hard-cases.md. `--log FILE` keeps one line a scene, and goes on from there. `--robots` draws robots: bases on
hinges and slides with springs, motors and stops, disks, straight tendons, laws of materials, chambers, muscles.
"""

from __future__ import annotations

import json
import sys
import warnings
from collections import Counter
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer
from rich.progress import track

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from tests.fuzz.verdict import Verdict, robot_verdict, verdict  # noqa: E402
from tests.reference.extreme_scenes import fuzz_scene  # noqa: E402

DOCS = ROOT / "docs" / "hard-cases.md"
BEGIN, END = "<!-- fuzz: written by benchmarks/fuzz.py -->", "<!-- end of fuzz -->"
WORDS = {
    "converged": "equilibrium found, checked",
    "unresolved": "an equilibrium of the discrete model, reported as unresolved",
    "load_stalled": "the load stalled, and the outcome says so",
    "max_iterations": "iterations ran out, and the outcome says so",
    "singular": "singular Jacobian, and the outcome says so",
    "not_finite": "a value was not finite, and the outcome says so",
    "refused": "refused: the support is outside the space in which the rod can move",
}


def known(log: Path | None) -> dict[int, Verdict]:
    """Scenes judged before."""
    if log is None or not log.exists():
        return {}
    lines = (json.loads(line) for line in log.read_text().splitlines())
    return {line.pop("seed"): Verdict(**{**line, "faults": tuple(line["faults"])}) for line in lines}


def summary(found: dict[int, Verdict]) -> str:
    """Table of the outcomes and a line of figures."""
    counts = Counter(v.outcome for v in found.values())
    rows = [f"| `{outcome}` | {WORDS.get(outcome, outcome)} | {count:,} |" for outcome, count in counts.most_common()]
    longest = max(v.seconds for v in found.values())
    checked = [v for v in found.values() if v.outcome == "converged"]
    weak = sorted(v.weak for v in checked) or [0.0]
    faulty = [seed for seed, v in sorted(found.items()) if v.faults]
    figures = (
        f"{len(found):,} scenes; {len(faulty)} with a fault; longest {longest:.0f} s. Violation of the weak form by "
        f"converged results: median {weak[len(weak) // 2]:.0e}, 95 % {weak[int(0.95 * (len(weak) - 1))]:.0e}, "
        f"worst {weak[-1]:.0e}, in the stress between the nodes of a discretisation that the user fixed too coarse."
    )
    return "\n".join(["| outcome | | scenes |", "|---|---|---|", *rows, "", figures])


def write(text: str) -> None:
    """Put the figures between their marks."""
    before, rest = DOCS.read_text().split(BEGIN)
    DOCS.write_text(f"{before}{BEGIN}\n{text}\n{END}{rest.split(END)[1]}")


def judged(seed: int, robots: bool) -> tuple[int, Verdict]:
    """A scene by its seed, and what became of it; a warning is a fault."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return seed, robot_verdict(seed) if robots else verdict(fuzz_scene(seed))


def main(
    count: Annotated[int, typer.Option(help="Scenes.")] = 10_000,
    first: Annotated[int, typer.Option(help="Seed of the first.")] = 0,
    log: Annotated[Path | None, typer.Option(help="One line a scene; a second run goes on from it.")] = None,
    robots: Annotated[bool, typer.Option(help="Robots in place of rods; not with --write.")] = False,
    into_docs: Annotated[bool, typer.Option("--write", help="Put the figures into docs/hard-cases.md.")] = False,
) -> None:
    """Judge scenes, print the figures; exit code 1 if one has a fault."""
    found = known(log)
    if log is not None:
        log.parent.mkdir(parents=True, exist_ok=True)
    missing = [seed for seed in range(first, first + count) if seed not in found]
    with ProcessPoolExecutor() as pool:
        judging = [pool.submit(judged, seed, robots) for seed in missing]
        for done in track(as_completed(judging), "Scenes", len(missing), disable=not sys.stdout.isatty()):
            seed, found[seed] = done.result()
            for fault in found[seed].faults:
                print(f"seed {seed}: {found[seed].outcome}: {fault}", flush=True)
            if log is not None:
                with log.open("a") as file:
                    file.write(json.dumps({"seed": seed, **asdict(found[seed])}) + "\n")
    text = summary({seed: found[seed] for seed in range(first, first + count)})
    print(text)
    if into_docs and not robots:
        write(text)
    raise typer.Exit(int(any(v.faults for v in found.values())))


if __name__ == "__main__":
    typer.run(main)
