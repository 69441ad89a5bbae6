"""How many load cases a second an exported library solves, and how that grows with the threads."""

from __future__ import annotations

import json
import os
import subprocess
import tempfile
from pathlib import Path

from rich.console import Console
from rich.table import Table

ROOT = Path(__file__).parents[1]
FLAGS = ("-O2", "-std=c99", "-fopenmp")


def compiled(folder: Path, target: Path) -> None:
    """The harness linked with the library of an exported folder."""
    described = json.loads((folder / "manifest.json").read_text())
    name = described["name"]
    own = ", ".join(repr(value) for entry in described["inputs"] for value in entry["value"])
    defines = [f"-DNAME={name}", f"-DMACRO={name.upper()}", f"-DOWN_INPUTS={own}", f'-DLIBRARY_HEADER="{name}.h"']
    sources = [str(ROOT / "benchmarks" / "batch.c"), f"{name}.c", f"{name}_kernels.c"]
    command = ["gcc", *FLAGS, *defines, "-I.", *sources, "-o", str(target), "-lm"]
    subprocess.run(command, cwd=folder, check=True)


def microseconds(program: Path, threads: int, cases: int) -> float:
    """Best time of a case over five runs."""
    environment = {**os.environ, "OMP_NUM_THREADS": str(threads)}
    found = []
    for _ in range(5):
        done = subprocess.run(
            [program, str(cases), str(threads)], env=environment, capture_output=True, text=True, check=True
        )
        solved, converged, took = done.stdout.split()
        if converged != solved:
            raise RuntimeError(f"{converged} of {solved} cases converged")
        found.append(float(took))
    return min(found)


def main() -> None:
    table = Table(title="Batches of 20 000 load cases")
    for heading in ("library", "1 thread, µs a case", "2 threads, µs a case", "ratio", "cases a second"):
        table.add_column(heading, justify="left" if heading == "library" else "right")
    with tempfile.TemporaryDirectory() as scratch:
        # Of the largest folders generated/ holds the hashes alone.
        folders = [path for path in (ROOT / "generated").iterdir() if (path / f"{path.name}_kernels.c").exists()]
        for folder in sorted(folders):
            program = Path(scratch) / folder.name
            compiled(folder, program)
            one, two = (microseconds(program, threads, 20_000) for threads in (1, 2))
            table.add_row(folder.name, f"{one:.2f}", f"{two:.2f}", f"{one / two:.2f}", f"{1e6 / two:,.0f}")
    Console().print(table)


if __name__ == "__main__":
    main()
