"""What exact contact costs in exported C: a turn of a control loop, beside Python and the rod without contact.

Exports examples with the arrangements of contacts that their load cases meet, compiles them, and moves a load by a
hundredth of its size from turn to turn, to and fro. Times are processor times, the best of many.

    python benchmarks/contact_in_c.py [--page]      # writes the table of docs/contact-in-c.md anew
"""

from __future__ import annotations

import argparse
import ctypes
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path
from time import process_time

import numpy as np
from doc_tables import put, table

from cosserat_casadi import Model, build, discretise, export, read_scene, solve
from cosserat_casadi.compiling.compiler import find_compiler

ROOT = Path(__file__).resolve().parents[1]

PAGE = ROOT / "docs" / "contact-in-c.md"

MARKS = ("<!-- contact in C -->", "<!-- end of contact in C -->")

CHANGE = 0.01
"""Change of the load from turn to turn, relative to it."""

TURNS = 400

PROGRAM = r"""
#define _POSIX_C_SOURCE 199309L
#include <time.h>
#include "rod.h"
static rod_workspace workspace;
static rod_state state;
static rod_memory memory;
static rod_info info;
static double now_us(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return 1e6 * (double)t.tv_sec + 1e-3 * (double)t.tv_nsec;
}
/* Best times of a turn without and with derivatives, us, and the contacts; zero where a turn fails. */
int turns(const double *inputs, double change, int count, double *best) {
  double moved[ROD_INPUTS + 1], derivatives[7 * ROD_RODS * ROD_INPUTS + 1];
  rod_contact contacts[ROD_MOST_CONTACTS];
  if (rod_solve(inputs, &state, &workspace, &info) != ROD_CONVERGED) return 0;
  best[0] = best[1] = 1e9;
  for (int k = 0; k < count; k++) {
    for (int i = 0; i < ROD_INPUTS; i++) moved[i] = inputs[i] * (k % 4 < 2 ? 1 : 1 + change);
    const double start = now_us();
    if (rod_track(moved, &state, &memory, 0, k % 2 ? derivatives : 0, &workspace, &info) != ROD_CONVERGED) return 0;
    const double duration = now_us() - start;
    /* Each load is kept for two turns: the first of them solves, the second has nothing left to solve. */
    if (k >= 4 && k % 2 == 0 && duration < best[0]) best[0] = duration;
    if (k % 2 == 1 && duration < best[1]) best[1] = duration;
  }
  return 1 + rod_contacts(&state, contacts, &workspace);
}
"""


@dataclass(frozen=True)
class Case:
    """An example with its load, and one under which it touches nothing.

    Attributes:
        example: name of the file.
        load: stacked inputs at which it touches.
        free: stacked inputs at which it does not; none where that is not timed.
        modes: polynomials of each strain in an element.
        nodes: intervals of an element.
    """

    example: str
    load: tuple[float, ...]
    free: tuple[float, ...] = ()
    modes: int = 5
    nodes: int = 12


CASES = (
    Case("rod_over_bar", (0.0, 0.0, -1.0), (0.0, 0.0, -0.02)),
    Case("rod_on_table", (0.0, 0.0, -9.81)),
)


@dataclass(frozen=True)
class Row:
    """One load of one example.

    Attributes:
        contact: what touches.
        turn: without derivatives, μs.
        derivatives: the derivatives alone, μs.
        python: a warm solve in Python, ms.
    """

    contact: str
    turn: float
    derivatives: float
    python: float


def compiled(model: Model, load_cases: np.ndarray, folder: Path) -> tuple[ctypes.CDLL, int]:
    """The program above with an exported model, and the bytes of its kernels."""
    export(model, folder, "rod", load_cases=load_cases)
    (folder / "turns.c").write_text(PROGRAM)
    sources = [folder / file for file in ("turns.c", "rod.c", "rod_kernels.c")]
    library = folder / "turns.so"
    subprocess.run([find_compiler(), "-O2", "-std=c99", "-fPIC", "-shared", *sources, "-lm", "-o", library], check=True)
    kernels = sum(file.stat().st_size for file in folder.glob("rod_kernels*"))
    return ctypes.CDLL(str(library)), kernels


def row(library: ctypes.CDLL, model: Model, inputs: np.ndarray) -> Row:
    """Times at one load."""
    best = np.zeros(2)
    given = np.ascontiguousarray(inputs)
    pointers = (array.ctypes.data_as(ctypes.c_void_p) for array in (given, best))
    passed = next(pointers)
    touching = library.turns(passed, ctypes.c_double(CHANGE), TURNS, next(pointers))
    if not touching:
        raise SystemExit("a turn failed")
    start = solve(model, inputs)
    begin = process_time()
    moved = solve(model, inputs * (1 + CHANGE), start=start)
    duration = process_time() - begin
    kinds = ", ".join(contact.kind for contact in moved.contacts) or "none"
    if len(moved.contacts) != touching - 1:
        raise SystemExit("C and Python disagree")
    return Row(kinds, best[0], best[1], 1e3 * duration)


def rows_of(case: Case) -> list[list[str]]:
    """The lines of a case: in contact, then without."""
    scene = read_scene(ROOT / "examples" / f"{case.example}.toml")
    model = build(scene, discretise(scene, case.modes, case.nodes))
    loads = [np.array(load) for load in (case.load, case.free) if load]
    lines = []
    with tempfile.TemporaryDirectory() as folder:
        library, size = compiled(model, np.array(loads), Path(folder) / "rod")
        for inputs in loads:
            own = row(library, model, inputs)
            lines.append(
                [
                    f"`{case.example}`",
                    own.contact,
                    f"{own.turn:.0f}",
                    f"{own.derivatives:.0f}",
                    f"{own.python:.0f}",
                    f"{size / 1e6:.1f}",
                ]
            )
    return lines


def main() -> None:
    """Print the table, or write it into the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--page", action="store_true", help="write the table of docs/contact-in-c.md anew")
    arguments = parser.parse_args()
    lines = [line for case in CASES for line in rows_of(case)]
    heads = ["example", "contact", "turn, µs", "derivatives, µs", "Python, ms", "kernels, MB"]
    text = table(heads, lines)
    if arguments.page:
        put(PAGE, *MARKS, text)
    print(text)


if __name__ == "__main__":
    main()
