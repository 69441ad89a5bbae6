"""Random rods in exact contact: how many are solved, and is each that is solved an equilibrium that holds?

With ``--family`` bars stand next to a section of the untouched rod: tests/reference/contact_scenes.py says how.
Judged by what the solver does not look at: gaps on a dense grid, signs of the forces, and the balance of all forces.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from cosserat_casadi import build, discretise, parse_scene, solve  # noqa: E402
from cosserat_casadi.maths.typing import FloatArray  # noqa: E402
from tests.contact.verdict import faults  # noqa: E402
from tests.reference.contact_scenes import FAMILIES, contact_scene, placed_scene  # noqa: E402


def place(text: str, X: float) -> tuple[FloatArray, FloatArray]:
    """Position and normal of a section where nothing touches, in x and z, m."""
    pose = solve(build(parse_scene(text))).pose(X)
    # The tangent turned by a right angle, upwards.
    x, _, z = pose.rotation[:, 2]
    return pose.position[[0, 2]], np.array([-z, x])


def main(
    count: Annotated[int, typer.Option(help="Scenes.")] = 100,
    first: Annotated[int, typer.Option(help="Seed of the first.")] = 0,
    modes: Annotated[int, typer.Option(help="Polynomials per strain and element.")] = 7,
    family: Annotated[str, typer.Option(help=f"Bars at places: {', '.join(FAMILIES)}.")] = "",
) -> None:
    """Solve and judge scenes, print the figures; exit code 1 if one that converged is wrong."""
    outcomes: Counter[str] = Counter()
    wrong = 0
    seconds = []
    for seed in range(first, first + count):
        scene = parse_scene(placed_scene(seed, family, place) if family else contact_scene(seed))
        begun = time.process_time()
        solution = solve(build(scene, discretise(scene, modes)))
        seconds.append(time.process_time() - begun)
        outcomes[solution.outcome.label] += 1
        found = faults(solution) if solution.converged else []
        wrong += bool(found)
        if found or not solution.converged:
            print(f"seed {seed}: {solution.outcome.label}: {'; '.join(found)}", flush=True)
    print(dict(outcomes), f"{wrong} wrong; processor time: median {np.median(seconds):.1f} s, {max(seconds):.1f} s")
    raise typer.Exit(int(wrong > 0))


if __name__ == "__main__":
    typer.run(main)
