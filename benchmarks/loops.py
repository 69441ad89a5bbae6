"""Kernels about the limit of straight-line code: both forms of each Jacobian compiled, their times, and the motion's.

Models from half the limit to beyond it, `gcc -O2`, best of many runs. The last column is the jump at the limit: time in
loops over time in straight-line code.
"""

from __future__ import annotations

import subprocess
import tempfile
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import casadi as ca
from growth import FOLLOWER, PUSH, WEIGHT, model_of
from rich.progress import track

from cosserat_casadi.codegen.kernels import scalar
from cosserat_casadi.compiling.printed_files import external_sources
from cosserat_casadi.maths.calls import with_dense_results

MODELS = (
    ("kirchhoff", [PUSH], 4, 9),
    ("kirchhoff", [PUSH], 5, 10),
    ("kirchhoff", [PUSH, WEIGHT], 5, 11),
    ("kirchhoff", [FOLLOWER], 5, 10),
    ("kirchhoff", [PUSH], 6, 12),
    ("reissner", [PUSH], 5, 8),
    ("reissner", [PUSH], 4, 11),
)
MOTIONS = (("kirchhoff", 4, 8), ("reissner", 4, 8), ("kirchhoff", 8, 16))

TIMER = """
#define _POSIX_C_SOURCE 199309L
#include "timed.h"
#include <stdio.h>
#include <time.h>
static double now_us(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return 1e6 * (double)t.tv_sec + 1e-3 * (double)t.tv_nsec;
}
static double given[20000], found[8][200000], room[timed_SZ_W + 1];
static int integers[timed_SZ_IW + 1];
int main(void) {
  const double *arguments[timed_SZ_ARG + 1];
  double *results[timed_SZ_RES + 1], best = 1e30, begin = now_us();
  int i;
  for (i = 0; i < timed_SZ_ARG; i++) arguments[i] = given;
  for (i = 0; i < timed_SZ_RES; i++) results[i] = found[i % 8];
  for (i = 0; i < 20000; i++) given[i] = 0.1 * (i * 37 % 11) - 0.5;
  while (now_us() - begin < 3e5) {
    double took = now_us();
    timed(arguments, results, integers, room, 0);
    took = now_us() - took;
    if (took < best) best = took;
  }
  printf("%g", best);
  return 0;
}
"""


@dataclass(frozen=True)
class Compiled:
    """A kernel in C: kilobytes of source, seconds of gcc, time of a call in µs."""

    kilobytes: float
    compile_s: float
    us: float


ANY_LENGTH = 10**9
"""Instructions of straight-line code, more than any has."""


def compiled(function: ca.Function) -> Compiled:
    """A function called ``timed``, compiled and run."""
    return compiled_sources(external_sources([function], "timed", "int"))


def compiled_sources(sources: Mapping[str, str]) -> Compiled:
    """Source and header of such a function, by file name, compiled and run."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file, text in {**sources, "timer.c": TIMER}.items():
            (folder / file).write_text(text)
        begin = time.perf_counter()
        for source in ("timed.c", "timer.c"):
            subprocess.run(["gcc", "-O2", "-std=c99", "-c", source], cwd=folder, check=True)
        took = time.perf_counter() - begin
        subprocess.run(["gcc", "timed.o", "timer.o", "-lm", "-o", "timer"], cwd=folder, check=True)
        printed = subprocess.run(["./timer"], cwd=folder, capture_output=True, text=True, check=True).stdout
        return Compiled((folder / "timed.c").stat().st_size / 1000, took, float(printed))


def main() -> None:
    print("strain, modes, intervals: instructions; straight µs, gcc s, kB; in loops µs, gcc s, kB; jump")
    for strain, loads, modes, nodes in track(MODELS, transient=True):
        model = model_of(strain, 0.5e-3, loads, modes, nodes)
        straight = scalar(model.path_jacobian, "timed", ANY_LENGTH)
        assert straight is not None
        one, other = compiled(straight), compiled(with_dense_results(model.path_jacobian, "timed"))
        cells = [f"{c.us:.1f}, {c.compile_s:.1f}, {c.kilobytes:.0f}" for c in (one, other)]
        print(f"{strain}, {modes}, {nodes}: {straight.n_instructions()}; {'; '.join(cells)}; {other.us / one.us:.2f}")
    print("motion: operations; in loops µs, gcc s, kB; operations a nanosecond")
    for strain, modes, nodes in track(MOTIONS, transient=True):
        model = model_of(strain, 0.5e-3, [PUSH, WEIGHT], modes, nodes)
        count = model.operations(model.dynamics_jacobian)
        c = compiled(with_dense_results(model.dynamics_jacobian, "timed"))
        rate = count / c.us / 1000
        print(f"{strain}, {modes}, {nodes}: {count}; {c.us:.1f}, {c.compile_s:.1f}, {c.kilobytes:.0f}; {rate:.1f}")


if __name__ == "__main__":
    main()
