"""What rows of assemblies would gain from being solved side by side: processor time of a row, best of several.

Rows of an assembly are solved one after the other, rod by rod. Here the elimination of its Jacobian as a whole is asked
for instead, which has a form for lanes: it costs more, and what it costs more is to be won back.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated
from unittest.mock import patch

import typer
from doc_tables import put, table
from row_cost import microseconds

from cosserat_casadi import Model, build, read_scene
from cosserat_casadi.codegen import assembled, lanes, rows
from cosserat_casadi.codegen.rows import RowLibrary, row_library

PAGE = Path("docs/sweeps.md")
BEGIN, END = "<!-- assemblies: written by benchmarks/assembly_rows.py -->", "<!-- end of assemblies -->"

COARSE = ("accuracy.modes=3", "accuracy.nodes=6")
SCENES = (("branching_rod", COARSE), ("shaken_platform", COARSE))


def as_a_whole(model: Model, *, side_by_side: bool) -> RowLibrary:
    """Rows of an assembly whose Jacobian is eliminated as that of one rod."""

    def no_blocks(*_: object) -> None:
        """No form rod by rod."""

    def not_kept(name: str, made_from: object, texts: Callable[[], dict[str, str]]) -> dict[str, str]:
        """Texts printed anew: those in the cache are of blocks."""
        return texts()

    with (
        patch.object(lanes, "blocks", no_blocks),
        patch.object(assembled, "blocks", no_blocks),
        patch.object(rows, "kept_texts", not_kept),
    ):
        return row_library(model, lanes=side_by_side)


def main(
    write: Annotated[bool, typer.Option("--write", help="Put the table into docs/sweeps.md.")] = False,
) -> None:
    """Print what a row costs."""
    lines = []
    for name, settings in SCENES:
        model = build(read_scene(f"examples/{name}.toml", settings))
        by_rods = microseconds(model, row_library(model))
        whole = microseconds(model, as_a_whole(model, side_by_side=False))
        library = as_a_whole(model, side_by_side=True)
        together = f"{microseconds(model, library):.0f}" if library.in_lanes else "–"
        lines.append((name, str(len(model.scene.rods)), str(model.size), f"{by_rods:.0f}", f"{whole:.0f}", together))
    headings = ("example", "rods", "unknowns", "rod by rod, µs a row", "as a whole", "as a whole, side by side")
    text = table(headings, lines)
    print(text)
    if write:
        put(PAGE, BEGIN, END, text)


if __name__ == "__main__":
    typer.run(main)
