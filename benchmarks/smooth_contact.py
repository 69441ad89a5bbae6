"""How smooth contact becomes exact as the width of the obstacles shrinks, and what it costs.

Solves the examples in contact exactly, and with widths, and prints for each width how far the tip is off, relative to
the length of the rod, with the rate, log₂ of its error over that of half the width; by how much it is turned; what the
answer tells of both, without the exact one; how far the resultant of the forces of contact is off, relative to it; the
smallest gap in widths; and the processor time.

    python benchmarks/smooth_contact.py [--page]      # writes the table of docs/smooth-contact.md anew
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path
from time import process_time

import numpy as np
from doc_tables import put, table

from cosserat_casadi import Solution, read_scene
from cosserat_casadi.accuracy.refine import solve_rods

ROOT = Path(__file__).resolve().parents[1]

PAGE = ROOT / "docs" / "smooth-contact.md"

MARKS = ("<!-- smooth contact -->", "<!-- end of smooth contact -->")

TOLERANCE = "accuracy.tolerance=1e-4"
"""A width changes more than this: no more digits are asked for."""

SCENES = {
    "rod_over_bar": ("bar", (0.04, 0.02, 0.01, 0.005)),
    "rod_on_table": ("table", (0.04, 0.02, 0.01, 0.005)),
    "wire_in_vessel": ("vessel", (2e-3, 1e-3, 5e-4, 2.5e-4)),
}
"""Obstacle of each example, and its widths, m."""


@dataclass(frozen=True)
class Row:
    """One width.

    Attributes:
        width: m.
        tip: error of the tip over the length.
        turn: angle by which the tip is off, rad.
        told: what the answer tells of the larger one of both.
        force: error of the resultant over the resultant.
        gap: smallest gap over the width.
        seconds: processor time of the solve.
    """

    width: float
    tip: float
    turn: float
    told: float
    force: float
    gap: float
    seconds: float


def resultant(solution: Solution) -> np.ndarray:
    """Sum of the sizes of the forces of all contacts on each axis, shape (3,), N."""
    return sum((np.abs(contact.force) for contact in solution.contacts), np.zeros(3))


def rows_of(scene: str) -> list[Row]:
    """The widths of one example."""
    file = ROOT / "examples" / f"{scene}.toml"
    obstacle, widths = SCENES[scene]
    exact = solve_rods(read_scene(file))
    length = exact.model.scene.rods[0].length
    rows = []
    for width in widths:
        before = process_time()
        smooth = solve_rods(read_scene(file, [f"{obstacle}.width={width}", TOLERANCE]))
        seconds = process_time() - before
        if not smooth.converged:
            raise SystemExit(f"{scene} with the width {width} m: {smooth.message}")
        gap = min(contact.gap for contact in smooth.contacts if contact.gap is not None)
        poses = smooth.tip(), exact.tip()
        tip = np.linalg.norm(poses[0].position - poses[1].position) / length
        turn = 2 * np.arcsin(np.linalg.norm(poses[0].rotation - poses[1].rotation) / np.sqrt(8))
        told = smooth.layer_error_estimate
        assert told is not None, "of an equilibrium in smooth contact"
        force = np.linalg.norm(resultant(smooth) - resultant(exact)) / np.linalg.norm(resultant(exact))
        rows.append(Row(width, float(tip), float(turn), told, float(force), gap / width, seconds))
        print(scene, rows[-1], flush=True)
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--page", action="store_true", help="write the table into docs/smooth-contact.md")
    arguments = parser.parse_args()
    cells = []
    for scene in SCENES:
        rows = rows_of(scene)
        for i, row in enumerate(rows):
            rate = "" if i == 0 else f"{np.log2(rows[i - 1].tip / row.tip):.2f}"
            cells.append(
                [
                    f"`{scene}`" if i == 0 else "",
                    f"{1e3 * row.width:g}",
                    f"{row.tip:.1e}",
                    rate,
                    f"{row.turn:.1e}",
                    f"{row.told:.1e}",
                    f"{100 * row.force:.1f}",
                    f"{row.gap:.2f}",
                    f"{row.seconds:.0f}",
                ]
            )
    headings = (
        "example",
        "width, mm",
        "tip, of the length",
        "rate",
        "turn, rad",
        "estimate",
        "force, %",
        "smallest gap, widths",
        "s",
    )
    text = table(headings, cells)
    print(text)
    if arguments.page:
        put(PAGE, *MARKS, text)


if __name__ == "__main__":
    main()
