"""Chains of MuJoCo beside rods: errors of tips, of rods in loops and of frequencies against the number of links.

`--write` puts the tables into docs/mujoco.md. MuJoCo is an extra: pip install 'cosserat-casadi[mujoco]'.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from doc_tables import put, table

from cosserat_casadi import build, modes_of, parse_scene, read_scene, solve
from tests.mjcf.chains import Chain, error_in_loop
from tests.mjcf.moved_chains import LOOPS

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "mujoco.md"
BEGIN, END = "<!-- links: written by benchmarks/mjcf_links.py -->", "<!-- end of links -->"

BEGIN_LOOPS, END_LOOPS = "<!-- loops: written by benchmarks/mjcf_links.py -->", "<!-- end of loops -->"

SCENES = ("nitinol_wire", "disk_robot", "silicone_finger", "two_section_robot", "branching_rod")
LINKS = (10, 20, 40, 80)
MOST_COORDINATES = 260
"""Coordinates of a chain whose stiffness is still differenced in seconds."""

LOOP_LINKS = (10, 20, 40)
"""Links of rods in loops, multiples of ten: a load divides them in halves, and the section at X = 0.4 has a link."""

FREQUENCIES = 3
"""Frequencies that are compared, the lowest."""


def rows_of(name: str) -> list[list[str]]:
    """Rows of the table for an example: links, coordinates, error of the tips, of the frequencies."""
    scene = read_scene(ROOT / "examples" / f"{name}.toml")
    solution = solve(scene)
    expected = np.array([mode.frequency for mode in modes_of(scene, count=FREQUENCIES).modes])
    length = max(rod.length for rod in scene.rods)
    rows: list[list[str]] = []
    for links in LINKS:
        chain = Chain(scene, links, shares=10)
        if chain.model.nv > MOST_COORDINATES:
            break
        gaps = [np.linalg.norm(chain.tip(rod.name) - solution.tip(rod.name).position) for rod in scene.rods]
        errors = np.abs(chain.frequencies(FREQUENCIES) / expected - 1.0)
        cells = [f"`{name}`" if not rows else "", str(links), str(chain.model.nv)]
        rows.append([*cells, f"{max(gaps) / length:.1e}", f"{errors.max():.1e}"])
    return rows


def rows_of_loop(name: str, text: str) -> list[list[str]]:
    """Rows of the table for a scene with a loop: links, error of the section at X = 0.4."""
    solution = solve(build(parse_scene(text)))
    errors = [error_in_loop(solution, links) for links in LOOP_LINKS]
    cells = zip([name, "", ""], LOOP_LINKS, errors, strict=True)
    return [[first, str(links), f"{error:.1e}"] for first, links, error in cells]


def main(write: Annotated[bool, typer.Option("--write", help="Write the tables into docs/mujoco.md.")] = False) -> None:
    """Compare examples with their chains."""
    headings = ("example", "links", "coordinates", "error of the tip / ℓ", f"of {FREQUENCIES} frequencies")
    text = table(headings, [row for name in SCENES for row in rows_of(name)])
    print(text)
    headings = ("scene with a loop", "links", "error of the section at X = 0.4 / ℓ")
    loops = table(headings, [row for name, text in LOOPS.items() for row in rows_of_loop(name, text)])
    print(loops)
    if write:
        put(PAGE, BEGIN, END, text)
        put(PAGE, BEGIN_LOOPS, END_LOOPS, loops)


if __name__ == "__main__":
    typer.run(main)
