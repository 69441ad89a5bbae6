"""What the six-rod platform costs in C: cold and warm solves, sensitivities, compile time, size.

    python benchmarks/six_rods.py

The scene of examples/six_rod_platform.toml with lengths of legs and the hand's wrench as inputs, compiled by gcc -O2.
Best of many runs on one core, time of the processor but for cold, warm and jacobian; warm is a solve from an
equilibrium of inputs 1 % away, sensitivities are those of all unknowns, of the tips and of the platform with all
inputs; both are timed together too, one after the other, and as a turn of a control loop, whose solve begins with the
Jacobian of the turn before. Small turns are those of a loop whose inputs wander by half a thousandth, best of twenty
loops of 500, with these derivatives and without any.
"""

from __future__ import annotations

import json
import subprocess
import tempfile
import time
from pathlib import Path

from cosserat_casadi import export, read_scene
from cosserat_casadi.accuracy.refine import solve_rods

SCENE = Path(__file__).parents[1] / "examples" / "six_rod_platform.toml"
LENGTHS = ", ".join(f'"leg_{i}.length"' for i in range(1, 7))
INPUTS = f'inputs=["hand.force", "hand.moment", {LENGTHS}]'
REPEAT = 2000

WORDS = (
    "cold_us", "warm_us", "sensitivity_us", "warm_and_sensitivity_us", "turn_us", "small_turn_us",
    "without_derivatives_us", "jacobian_us",
)  # fmt: skip

TIMER = """
#define _POSIX_C_SOURCE 199309L
#include "platform.h"
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
static double now_us(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return 1e6 * (double)t.tv_sec + 1e-3 * (double)t.tv_nsec;
}
static double d_x[PLATFORM_UNKNOWNS * PLATFORM_INPUTS];
static double d_poses[PLATFORM_POSES * 7 * PLATFORM_INPUTS];
static platform_workspace workspace;
static platform_memory memory;
enum { LOOP = 500, LOOPS = 20 };
int main(void) {
  double inputs[PLATFORM_INPUTS] = {@}, x[PLATFORM_UNKNOWNS] = {0}, best = 1e30, both = 1e30, turn = 1e30;
  double small[2] = {1e30, 1e30};
  int asked, turns;
  double near[PLATFORM_INPUTS], start_x[PLATFORM_UNKNOWNS];
  platform_info info;
  int i, k, status = platform_solve(inputs, x, &workspace, &info);
  for (k = 0; k < REPEAT; k++) {
    const double start = now_us();
    double took;
    status += platform_solve_sensitivity(inputs, x, d_x, d_poses, &workspace);
    took = now_us() - start;
    if (took < best) best = took;
  }
  for (k = 0; k < REPEAT; k++) {
    double start, took;
    for (i = 0; i < PLATFORM_INPUTS; i++) near[i] = inputs[i] * (k % 2 ? 0.99 : 1.01);
    memcpy(start_x, x, sizeof x);
    start = now_us();
    status += platform_solve(near, start_x, &workspace, 0);
    status += platform_solve_sensitivity(near, start_x, d_x, d_poses, &workspace);
    took = now_us() - start;
    if (took < both) both = took;
  }
  for (k = 0; k < REPEAT; k++) {
    double start, took;
    for (i = 0; i < PLATFORM_INPUTS; i++) near[i] = inputs[i] * (k % 2 ? 0.99 : 1);
    start = now_us();
    status += platform_track(near, x, &memory, 0, d_x, d_poses, &workspace, 0);
    took = now_us() - start;
    if (took < turn) turn = took;
  }
  for (asked = 0; asked < 2; asked++) {
    for (k = 0; k < LOOPS; k++) {
      const double start = now_us();
      double took;
      for (turns = 0; turns < LOOP; turns++) {
        const double angle = 6.283185307179586 * turns / LOOP;
        for (i = 0; i < PLATFORM_INPUTS; i++) near[i] = inputs[i] * (1 + 5e-4 * sin(angle + i));
        status += platform_track(near, x, &memory, 0, asked ? d_x : 0, asked ? d_poses : 0, &workspace, 0);
      }
      took = (now_us() - start) / LOOP;
      if (took < small[asked]) small[asked] = took;
    }
  }
  printf("{\\"status\\": %d, \\"cold_jacobians\\": %d, ", status, info.jacobians);
  printf("\\"sensitivity_us\\": %g, \\"warm_and_sensitivity_us\\": %g, \\"turn_us\\": %g, ", best, both, turn);
  printf("\\"small_turn_us\\": %g, \\"without_derivatives_us\\": %g}", small[1], small[0]);
  return 0;
}
"""


def main() -> None:
    solution = solve_rods(read_scene(SCENE, (INPUTS,)))
    with tempfile.TemporaryDirectory() as path:
        folder = export(solution.model, Path(path) / "platform", "platform")
        values = ", ".join(map(repr, solution.model.pack().tolist()))
        (folder / "timer.c").write_text(TIMER.replace("@", values).replace("REPEAT", str(REPEAT)))
        begin = time.perf_counter()
        for stem in ("platform", "platform_kernels", "platform_demo", "timer"):
            _run(folder, "gcc", "-O2", "-std=c99", "-c", f"{stem}.c")
        took, size = time.perf_counter() - begin, (folder / "platform_kernels.o").stat().st_size
        for program in ("platform_demo", "timer"):
            _run(folder, "gcc", f"{program}.o", "platform.o", "platform_kernels.o", "-lm", "-o", program)
        found = json.loads(_run(folder, "./platform_demo", "--repeat", str(REPEAT)))
        found |= json.loads(_run(folder, "./timer"))
    print(
        f"{solution.model.size} unknowns, {solution.model.inputs.size} inputs; gcc {took:.0f} s, {size / 1000:.0f} kB"
    )
    for word in WORDS:
        print(f"{word}: {found[word]:.0f}")
    print(f"cold: {found['iterations']} iterations, {found['cold_jacobians']} Jacobians; status {found['status']}")


def _run(folder: Path, *words: str) -> str:
    return subprocess.run(words, cwd=folder, capture_output=True, text=True, check=True).stdout


if __name__ == "__main__":
    main()
