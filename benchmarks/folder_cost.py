"""What the exported folders of examples cost: instructions, bytes of C and of objects, time of gcc and of a solve.

Time of gcc is processor time of all sources of the library at the default flags. Rows go to build/folders.csv one by
one: the same command goes on where it was stopped. `--write` puts what is there into docs/c-interface.md.
"""

from __future__ import annotations

import json
import resource
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer
from doc_tables import put, table
from rows import append, read

from cosserat_casadi import CosseratError, Solution, export, read_scene
from cosserat_casadi.accuracy.refine import solve_rods
from cosserat_casadi.compiling.compiler import FLAGS

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "c-interface.md"
FILE = ROOT / "build" / "folders.csv"
BEGIN, END = "<!-- folders: written by benchmarks/folder_cost.py -->", "<!-- end of folders -->"
HEAD = ["example", "instructions", "C, kB", "objects, kB", "gcc, s", "cold solve, µs", "warm solve, µs"]
SHOWN = (
    "dropped_rod", "euler_column", "fishing_rod_cast", "follower_reissner", "helical_tendon", "magnet_catheter",
    "needle_in_tissue", "nitinol_wire", "planar_strip", "shaken_platform", "six_rod_platform", "soft_arm",
    "tendon_robot_move", "two_section_robot",
)  # fmt: skip
"""Examples of each kind: rods and platforms, statics and motion, the shortest and the longest."""

NAME = "folder"
"""What every library here is called."""


@dataclass(frozen=True)
class Folder:
    """An exported folder, compiled and run.

    Attributes:
        example: the scene, with the option of the export.
        instructions: of all its kernels.
        c_bytes: of all sources and headers of the library.
        object_bytes: of what they compile to.
        gcc_s: processor time of the compiler.
        cold_us: time of a solve from the unloaded scene; nan where there is none.
        warm_us: time of a solve from inputs one per cent away.
    """

    example: str
    instructions: int
    c_bytes: int
    object_bytes: int
    gcc_s: float
    cold_us: float
    warm_us: float


def cells(row: dict[str, str]) -> list[str]:
    """A row of the table, from a row of the file."""
    sizes = [row["instructions"], *(f"{float(row[key]) / 1000:.0f}" for key in ("c_bytes", "object_bytes"))]
    times = [f"{float(row[key]):.{digits}f}" for key, digits in (("gcc_s", 1), ("cold_us", 0), ("warm_us", 0))]
    return [row["example"], *sizes, *times]


def compiler_time() -> float:
    """Processor time of the children that have ended, s."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def measured(solution: Solution, example: str, *, dynamics: bool) -> Folder:
    """Export, compile and run a model."""
    with tempfile.TemporaryDirectory() as scratch:
        folder = export(solution.model, Path(scratch) / NAME, dynamics=dynamics)
        described = json.loads((folder / "manifest.json").read_text())
        files = [file for file in folder.iterdir() if file.suffix in (".c", ".h") and "_demo" not in file.name]
        start = compiler_time()
        for stem in (NAME, f"{NAME}_kernels"):
            subprocess.run(["gcc", *FLAGS, "-c", f"{stem}.c"], cwd=folder, check=True)
        took = compiler_time() - start
        objects = [f"{NAME}.o", f"{NAME}_kernels.o"]
        subprocess.run(["gcc", *FLAGS, f"{NAME}_demo.c", *objects, "-lm", "-o", "demo"], cwd=folder, check=True)
        printed = subprocess.run(["./demo", "--repeat", "200"], cwd=folder, capture_output=True, text=True, check=False)
        found = json.loads(printed.stdout)
        return Folder(
            example=example + (" --dynamics" if dynamics else ""),
            instructions=sum(entry["instructions"] for entry in described["functions"]),
            c_bytes=sum(file.stat().st_size for file in files),
            object_bytes=sum((folder / file).stat().st_size for file in objects),
            gcc_s=took,
            cold_us=found.get("cold_us", float("nan")),
            warm_us=found.get("warm_us", float("nan")),
        )


def folders(example: str) -> list[Folder]:
    """The folder of an example, and the one with motion where it moves; none of what is not exported."""
    scene = read_scene(ROOT / "examples" / f"{example}.toml")
    if scene.touches_exactly:
        print(f"{example}: benchmarks/contact_in_c.py measures rods in exact contact")
        return []
    solution = solve_rods(scene)
    if not solution.converged:
        print(f"{example}: {solution.message}")
        return []
    rows = [measured(solution, example, dynamics=False)]
    if scene.simulation is not None:
        rows.append(measured(solution, example, dynamics=True))
    return rows


def main(
    examples: Annotated[list[str] | None, typer.Argument(help="Names of examples; those of SHOWN by default.")] = None,
    write: Annotated[bool, typer.Option(help="Put the table into docs/c-interface.md.")] = False,
) -> None:
    """Measure the folders of examples."""
    done = {row["example"] for row in read(FILE)}
    for name in examples or SHOWN:
        try:
            found = [] if name in done else folders(name)
        except CosseratError as error:
            print(f"{name}: {error}")
            continue
        if found:
            append(FILE, found)
    rows = sorted(read(FILE), key=lambda row: row["example"])
    text = table(HEAD, [cells(row) for row in rows])
    print(text)
    if write:
        put(PAGE, BEGIN, END, text)


if __name__ == "__main__":
    typer.run(main)
