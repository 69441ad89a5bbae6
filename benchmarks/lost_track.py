"""How a control loop in C that has lost its track comes back: with `NAME_track` alone, and with `NAME_recover`.

The inputs of the platform on six rods, lengths of legs and the force of the hand, jump to random places every 50 turns
and move on from there by up to a quarter of a millimetre a turn: 2500 turns. A turn is lost where it ends without the
solution for its inputs. Two loops get the same inputs and ask `NAME_track` for the derivatives of the poses: one calls
it at every turn, the other calls `NAME_recover` after a turn that is lost.

Processor time of one core, gcc -O2; a turn counts by the best of many runs, all of which do the same, and worst and
median are those over the turns. `--write` puts the table into docs/c-interface.md.
"""

from __future__ import annotations

import json
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import numpy.typing as npt
import typer
from doc_tables import put, table

from cosserat_casadi import Model, build, export, read_scene
from cosserat_casadi.accuracy.refine import solve_rods
from cosserat_casadi.codegen.status import OUTCOMES
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.outcome import Outcome

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "c-interface.md"
BEGIN, END = "<!-- lost: written by benchmarks/lost_track.py -->", "<!-- end of lost -->"
SCENE = ROOT / "examples" / "six_rod_platform.toml"
LEGS = [f"leg_{i}.length" for i in range(1, 7)]
INPUTS = f"inputs={json.dumps(['hand.force', *LEGS])}"

PERIODS = {"none": None, "1 ms": 1e-3}
"""Periods of an export as the table writes them, s."""

SIZES = {"4 cm, 3 N": (0.04, 3.0), "8 cm, 5 N": (0.08, 5.0)}
"""How far from the scene's own values lengths, m, and components of the force, N, may jump, as the table writes it."""

JUMPS, TURNS = 50, 50
"""Number of jumps, and of turns from one to the next."""

WANDER = 2e-3
"""How far a length moves on about the place of the jump, m."""

REPEAT = 10
"""Runs of a loop."""

LOOP = """
#define _POSIX_C_SOURCE 199309L
#include "timed.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
static double now_us(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return 1e6 * (double)t.tv_sec + 1e-3 * (double)t.tv_nsec;
}
enum { TURNS = @TURNS@, REPEAT = @REPEAT@ };
static timed_workspace workspace;
static double own[TIMED_INPUTS] = {@VALUES@};
static double inputs[TURNS][TIMED_INPUTS], first[TIMED_UNKNOWNS], x[TIMED_UNKNOWNS], best[TURNS];
static double d_poses[TIMED_POSES * 7 * TIMED_INPUTS];
static int ends[TURNS], recovers[TURNS];

/* All turns from the solution for the scene's own inputs; with may_recover those after a lost one call recover. */
static void run(int may_recover) {
  timed_memory memory;
  int is_lost = 0;
  memset(&memory, 0, sizeof memory);
  memcpy(x, first, sizeof x);
  (void)timed_track(own, x, &memory, 0, 0, d_poses, &workspace, 0);
  for (int k = 0; k < TURNS; k++) {
    const double start = now_us();
    recovers[k] = may_recover && is_lost;
    ends[k] = (int)(recovers[k] ? timed_recover(inputs[k], x, &memory, 0, &workspace, 0)
                                : timed_track(inputs[k], x, &memory, 0, 0, d_poses, &workspace, 0));
    const double took = now_us() - start;
    if (took < best[k]) best[k] = took;
    is_lost = ends[k] != TIMED_CONVERGED;
  }
}

static void print(const char *name, const int *numbers, const char *behind) {
  printf("\\"%s\\": [%d", name, numbers[0]);
  for (int k = 1; k < TURNS; k++) printf(", %d", numbers[k]);
  printf("]%s", behind);
}

int main(int count, char **words) {
  for (int k = 0; k < TURNS; k++) {
    for (int i = 0; i < TIMED_INPUTS; i++) {
      if (scanf("%lf", inputs[k] + i) != 1) return 2;
    }
    best[k] = 1e30;
  }
  if (timed_solve(own, first, &workspace, 0) != TIMED_CONVERGED) return 1;
  for (int k = 0; k < REPEAT; k++) run(count > 1 && atoi(words[1]));
  printf("{");
  print("ends", ends, ", ");
  print("recovers", recovers, ", \\"us\\": [");
  for (int k = 0; k < TURNS; k++) printf("%s%g", k ? ", " : "", best[k]);
  printf("]}");
  return 0;
}
"""


@dataclass(frozen=True)
class Loop:
    """Turns of a loop.

    Attributes:
        lost: whether each turn ended without its solution, shape (turns,).
        stalled: whether it said that the line to its inputs leads to no equilibrium.
        recovers: whether it called `NAME_recover`.
        us: what each took, µs.
    """

    lost: npt.NDArray[np.bool_]
    stalled: npt.NDArray[np.bool_]
    recovers: npt.NDArray[np.bool_]
    us: FloatArray

    def turns_until_found(self) -> list[int]:
        """Calls of `NAME_recover` from each lost turn of `NAME_track` until a solution for the inputs of a turn."""
        counts = []
        count = 0
        for recovers, lost in zip(self.recovers, self.lost, strict=True):
            count = count + 1 if recovers else 0
            if recovers and not lost:
                counts.append(count)
        return counts


def turns_of(model: Model, length: float, force: float) -> FloatArray:
    """Inputs of every turn, shape (JUMPS · TURNS, m).

    Args:
        model: the platform.
        length: how far each length may jump, m.
        force: how far each component of the force may jump, N.
    """
    random = np.random.default_rng(35)
    inputs = np.tile(model.pack(), (JUMPS, TURNS, 1))
    phase = 2 * np.pi * np.arange(TURNS)[:, None] / TURNS
    legs = [model.inputs.slices[leg].start for leg in LEGS]
    inputs[:, :, legs] += random.uniform(-length, length, (JUMPS, 1, len(legs)))
    inputs[:, :, legs] += WANDER * np.sin(phase + np.arange(len(legs)))
    inputs[:, :, model.inputs.slices["hand.force"]] += random.uniform(-force, force, (JUMPS, 1, 3))
    return inputs.reshape(JUMPS * TURNS, -1)


def compiled(model: Model, folder: Path, period: float | None) -> tuple[Path, dict[str, float]]:
    """The program of a loop, and what the manifest says of the budget of its turns."""
    export(model, folder, "timed", period=period)
    values = ", ".join(map(repr, model.pack().tolist()))
    loop = LOOP.replace("@VALUES@", values).replace("@TURNS@", str(JUMPS * TURNS)).replace("@REPEAT@", str(REPEAT))
    (folder / "loop.c").write_text(loop)
    command = ("gcc", "-O2", "-std=c99", "loop.c", "timed.c", "timed_kernels.c", "-lm", "-o", "loop")
    subprocess.run(command, cwd=folder, check=True)
    turn: dict[str, float] = json.loads((folder / "manifest.json").read_text())["turn"]
    return folder / "loop", turn


def looped(program: Path, inputs: FloatArray, *, may_recover: bool) -> Loop:
    """A loop with these inputs."""
    text = "\n".join(" ".join(map(repr, row)) for row in inputs.tolist())
    done = subprocess.run([program, str(int(may_recover))], input=text, capture_output=True, text=True, check=True)
    printed = json.loads(done.stdout)
    ends = np.array(printed["ends"])
    return Loop(
        lost=ends != OUTCOMES.index(Outcome.CONVERGED),
        stalled=ends == OUTCOMES.index(Outcome.LOAD_STALLED),
        recovers=np.array(printed["recovers"], dtype=bool),
        us=np.array(printed["us"]),
    )


HEADINGS = (
    "jumps",
    "`--period`",
    "Newton steps, points",
    "turns lost: `track` alone",
    "with `recover`",
    "of these `LOAD_STALLED`",
    "turns until found",
    "`track`, followed, µs",
    "`track`, lost, µs",
    "`recover`, µs",
)


def row(size: str, period: str, program: Path, turn: Mapping[str, float], inputs: FloatArray) -> tuple[str, ...]:
    """A row of the table."""
    alone = looped(program, inputs, may_recover=False)
    both = looped(program, inputs, may_recover=True)
    return (
        size,
        period,
        f"{turn['max_iterations']}, {turn['max_continuation_steps']}",
        f"{np.count_nonzero(alone.lost)}",
        f"{np.count_nonzero(both.lost)}",
        f"{np.count_nonzero(both.stalled)}",
        median_and_worst(both.turns_until_found()),
        median_and_worst(both.us[~both.recovers & ~both.lost]),
        median_and_worst(alone.us[alone.lost]),
        median_and_worst(both.us[both.recovers]),
    )


def median_and_worst(values: Sequence[int] | FloatArray) -> str:
    """Both as the table writes them."""
    return f"{np.median(values):.0f}, {np.max(values):.0f}"


def main(
    write: Annotated[bool, typer.Option("--write", help="Put the table into docs/c-interface.md.")] = False,
) -> None:
    """Print turns that are lost, and times in µs."""
    scene = read_scene(SCENE, (INPUTS,))
    model = build(scene, solve_rods(scene).model.discretisation)
    print(f"{model.size} unknowns, {model.inputs.size} inputs")
    rows = []
    for period, seconds in PERIODS.items():
        with tempfile.TemporaryDirectory() as path:
            program, turn = compiled(model, Path(path) / "platform", seconds)
            for size, (length, force) in SIZES.items():
                rows.append(row(size, period, program, turn, turns_of(model, length, force)))
                print(rows[-1], flush=True)
    text = table(HEADINGS, rows)
    print(text)
    if write:
        put(PAGE, BEGIN, END, text)


if __name__ == "__main__":
    typer.run(main)
