"""What the estimate of an answer's error costs in C, beside a solve and a turn of a control loop.

Processor time of one core, gcc -O2, best of many runs; every figure of a row is of one program. `--write` puts the
table into docs/c-interface.md.
"""

from __future__ import annotations

import json
import subprocess
import tempfile
from pathlib import Path
from typing import Annotated

import typer
from doc_tables import put, table

from cosserat_casadi import Model, build, export, read_scene
from cosserat_casadi.accuracy.refine import solve_rods

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "c-interface.md"
BEGIN, END = "<!-- error: written by benchmarks/error_in_c.py -->", "<!-- end of error -->"
REPEAT = 2000
LENGTHS = ", ".join(f'"leg_{i}.length"' for i in range(1, 7))
SCENES = {
    "wire, 3 inputs": ("nitinol_wire", 'inputs=["push.force"]'),
    "robot of two sections": ("two_section_robot", ""),
    "platform on six rods": ("six_rod_platform", f'inputs=["hand.force", "hand.moment", {LENGTHS}]'),
}
"""What a row is called, an example, and what is changed in it."""

TIMER = """
#define _POSIX_C_SOURCE 199309L
#include "timed.h"
#include <stdio.h>
#include <string.h>
#include <time.h>
static double now_us(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return 1e6 * (double)t.tv_sec + 1e-3 * (double)t.tv_nsec;
}
static timed_workspace workspace;
static timed_memory memory;
static timed_info info;
static double inputs[TIMED_INPUTS] = {@VALUES@};
static double near[TIMED_INPUTS], x[TIMED_UNKNOWNS], turned[TIMED_UNKNOWNS];
enum { BATCH = 20 };
#define TIME(name, statement)                                  \\
  do {                                                         \\
    double best = 1e30;                                        \\
    for (int k = 0; k < REPEAT; k++) {                         \\
      const double start = now_us();                           \\
      for (int turn = 0; turn < BATCH; turn++) { statement }   \\
      const double took = (now_us() - start) / BATCH;          \\
      if (took < best) best = took;                            \\
    }                                                          \\
    printf("\\"%s\\": %g, ", name, best);                      \\
  } while (0)
int main(void) {
  int status = timed_solve(inputs, x, &workspace, &info);
  double error = 0;
  memcpy(turned, x, sizeof x);
  printf("{");
  TIME("cold_us", memset(x, 0, sizeof x); status += timed_solve(inputs, x, &workspace, 0););
  TIME("told_us", memset(x, 0, sizeof x); status += timed_solve(inputs, x, &workspace, &info););
  TIME("estimate_us", status += timed_error_estimate(inputs, x, &error, &workspace););
  TIME("turn_us", for (int i = 0; i < TIMED_INPUTS; i++) near[i] = inputs[i] * (turn % 2 ? 0.999 : 1);
       status += timed_track(near, turned, &memory, 0, 0, 0, &workspace, 0););
  printf("\\"status\\": %d, \\"error\\": %g}", status, error);
  return 0;
}
"""


def measured(model: Model) -> dict[str, float]:
    """Times of a model in C, µs, and bytes of its kernels with the estimate and without it."""
    with tempfile.TemporaryDirectory() as path:
        whole = export(model, Path(path) / "whole", "timed")
        small = export(model, Path(path) / "small", "timed", estimate_errors=False)
        values = ", ".join(map(repr, model.pack().tolist()))
        timer = TIMER.replace("@VALUES@", values).replace("REPEAT", str(REPEAT))
        (whole / "timer.c").write_text(timer)
        sources = ("timer.c", "timed.c", "timed_kernels.c")
        _run(whole, "gcc", "-O2", "-std=c99", *sources, "-lm", "-o", "timer")
        found: dict[str, float] = json.loads(_run(whole, "./timer"))
        assert found["status"] == 0, "a solve or an estimate failed"
        for name, folder in (("bytes", whole), ("bytes_without", small)):
            found[name] = sum(file.stat().st_size for file in folder.glob("*.[ch]"))
    return found


def _run(folder: Path, *command: str) -> str:
    return subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True).stdout


HEADINGS = (
    "scene",
    "unknowns",
    "cold solve, no `info`",
    "with `info`, estimate included",
    "`NAME_error_estimate`",
    "turn of `NAME_track`",
    "C, kB: with, without",
)


def row(words: str, model: Model) -> tuple[str, ...]:
    """A row of the table."""
    found = measured(model)
    return (
        words,
        f"{model.size}",
        f"{found['cold_us']:.1f}",
        f"{found['told_us']:.1f}",
        f"{found['estimate_us']:.1f}",
        f"{found['turn_us']:.1f}",
        f"{found['bytes'] / 1000:.0f}, {found['bytes_without'] / 1000:.0f}",
    )


def main(
    write: Annotated[bool, typer.Option("--write", help="Put the table into docs/c-interface.md.")] = False,
) -> None:
    """Print times in µs."""
    rows = []
    for words, (example, change) in SCENES.items():
        scene = read_scene(ROOT / "examples" / f"{example}.toml", (change,) if change else ())
        model = build(scene, solve_rods(scene).model.discretisation)
        rows.append(row(words, model))
        print(rows[-1], flush=True)
    text = table(HEADINGS, rows)
    print(text)
    if write:
        put(PAGE, BEGIN, END, text)


if __name__ == "__main__":
    typer.run(main)
