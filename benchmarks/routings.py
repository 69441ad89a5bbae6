"""Tendons along random courses: true errors of tips and cables beside the tolerance and the estimate.

Every scene is solved to its tolerance and integrated by DOP853, which shares no polynomial with it. `--log FILE` keeps
one line a scene, and goes on from there.
"""

from __future__ import annotations

import json
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.progress import track

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from cosserat_casadi import scene_from_dict  # noqa: E402
from cosserat_casadi.accuracy.refine import solve_rods  # noqa: E402
from tests.fuzz.test_waves import GRANTED  # noqa: E402
from tests.reference.routed_scenes import RTOL, miss, routed_scene  # noqa: E402

INTEGRATION = RTOL
"""Accuracy of the integration itself, over the length: below it no estimate is judged."""


@dataclass(frozen=True)
class Judged:
    """A scene beside its integration.

    Attributes:
        seed: that the scene is drawn from.
        outcome: of the solution.
        converged: whether it was.
        tip: true error of the tip over the tolerance; nan without a solution, or where none was integrated.
        cable: of the lengths of cables.
        estimate: what the larger of the two has above the accuracy of the integration, over the estimate.
        seconds: processor time of the solution.
    """

    seed: int
    outcome: str
    converged: bool
    tip: float = float("nan")
    cable: float = float("nan")
    estimate: float = float("nan")
    seconds: float = float("nan")

    @property
    def beyond(self) -> bool:
        """Whether what is claimed to the tolerance is not within it."""
        return max(self.tip, self.cable) > 1.0

    @property
    def understated(self) -> bool:
        """Whether the true error is above the estimate."""
        return self.estimate > GRANTED


def judged(seed: int) -> Judged:
    """A drawn scene, solved and integrated."""
    scene = scene_from_dict(routed_scene(seed))
    began = time.process_time()
    solution = solve_rods(scene)
    seconds = time.process_time() - began
    if not solution.converged:
        return Judged(seed, solution.outcome.label, converged=False, seconds=seconds)
    error = miss(scene, solution)
    tolerance = scene.accuracy.tolerance
    assert solution.error_estimate is not None
    surely_wrong = max(error.tip, error.cable, INTEGRATION) - INTEGRATION
    return Judged(
        seed=seed,
        outcome=solution.outcome.label,
        converged=True,
        tip=error.tip / tolerance,
        cable=error.cable / tolerance,
        estimate=surely_wrong / solution.error_estimate,
        seconds=seconds,
    )


def known(log: Path | None) -> dict[int, Judged]:
    """Scenes judged before."""
    if log is None or not log.exists():
        return {}
    rows = [Judged(**json.loads(line)) for line in log.read_text().splitlines()]
    return {row.seed: row for row in rows}


def main(
    count: Annotated[int, typer.Option(help="Scenes.")] = 1000,
    first: Annotated[int, typer.Option(help="Seed of the first.")] = 0,
    workers: Annotated[int | None, typer.Option(help="Processes; by default one for each core.")] = None,
    log: Annotated[Path | None, typer.Option(help="One line a scene; a second run goes on from it.")] = None,
) -> None:
    """Count what is beyond its tolerance or its estimate; exit code 1 if anything is beyond its tolerance."""
    found = known(log)
    seeds = range(first, first + count)
    missing = [seed for seed in seeds if seed not in found]
    with ProcessPoolExecutor(workers) as pool:
        rows = pool.map(judged, missing)
        for row in track(rows, "Scenes", len(missing), disable=not sys.stdout.isatty()):
            found[row.seed] = row
            if row.beyond or row.understated:
                print(row, flush=True)
            if log is not None:
                with log.open("a") as file:
                    file.write(json.dumps(asdict(row)) + "\n")
    rows_found = [found[seed] for seed in seeds]
    converged = [row for row in rows_found if row.converged]
    integrated = [row for row in converged if np.isfinite(row.tip) and np.isfinite(row.cable)]
    beyond = sum(row.beyond for row in integrated)
    print(f"{count} routings: {len(converged)} converged, the others say so; {len(integrated)} of them integrated")
    print(f"{beyond:5d}  beyond the tolerance; largest error {_largest(integrated):.2g} of it")
    print(f"{sum(row.understated for row in integrated):5d}  above the estimate by more than one per cent")
    print(f"{np.median([row.seconds for row in rows_found]):5.1f}  s of the processor, median")
    raise typer.Exit(int(beyond > 0))


def _largest(rows: list[Judged]) -> float:
    """Largest error over the tolerance."""
    return max((max(row.tip, row.cable) for row in rows), default=0.0)


if __name__ == "__main__":
    typer.run(main)
