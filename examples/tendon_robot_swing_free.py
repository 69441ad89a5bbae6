"""A two-section tendon robot moves its tip by 0.15 m within 0.3 s and stops: with its motion in the model, and without.

Both controllers plan 20 stages ahead, 50 times a second, within bounds on the tensions and their rates. The one of
today takes the robot for a sequence of equilibria, and leaves it swinging. The other has its equations of motion in
every stage, and does not. Neither knows the payload of a tenth of the robot's mass. What is moved is a finer model,
simulated to a tolerance, while a plan is being made: a plan begins where the robot will be when it is ready.

A plan is improved by one step of sequential quadratic programming in every period (real-time iteration: M. Diehl et
al., J. Process Control 12, 2002). Its quadratic problem has the rates of the tensions alone: what else a stage has is
eliminated.

Its parts are in the folder ``swing_free``: the task, what both controllers have, either of them, the robot, pictures.
"""

from __future__ import annotations

import argparse
from collections import Counter
from pathlib import Path

import numpy as np
from swing_free.pictures import animate, draw
from swing_free.plans import Controller
from swing_free.robot import Run, simulate
from swing_free.task import DURATION, SETTLING, STEP, TENSIONS, WATCHED, known_model, moved_model, start_tensions
from swing_free.with_equilibria import Resting
from swing_free.with_motion import Moving

from cosserat_casadi import Model, solve


def controllers(known: Model, tensions: np.ndarray) -> dict[str, Controller]:
    """Both controllers, which begin at these tensions, N."""
    at_rest = solve(known, dict(zip(TENSIONS, tensions, strict=True)), raise_on_failure=True)
    return {"equilibria": Resting(known, at_rest.x), "motion": Moving(known, at_rest.x)}


HEADER = """| plan | swing | gap at 0.3 s | at the end, mm | clock | 99 % | worst, ms | processor | 99 % | worst, ms |
| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"""


def summary(name: str, run: Run) -> str:
    """A row of the table that the program prints."""
    gaps = 1e3 * np.linalg.norm(run.tips - run.wanted, axis=1)
    arrived = gaps[np.searchsorted(run.seconds, DURATION - STEP / 2)]
    times = np.concatenate([np.percentile(1e3 * spent, [50, 99, 100]) for spent in (run.clock, run.processor)])
    numbers = [f"{value:.1f}" for value in (1e3 * run.swing, arrived, gaps[-1], *times)]
    return f"| {' | '.join([name, *numbers])} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    steps = round((SETTLING + DURATION + WATCHED) / STEP)
    parser.add_argument("--steps", type=int, default=steps, help="steps of 0.02 s")
    parser.add_argument("--repeats", type=int, default=3, help="times that each step is computed; the best counts")
    parser.add_argument("--output", type=Path, default=Path("tendon_robot_swing_free.png"), help="figure")
    parser.add_argument("--animation", type=Path, help="both robots in motion, a .gif")
    arguments = parser.parse_args()
    known, model = known_model(), moved_model()
    tensions = start_tensions(model)
    runs = {
        name: simulate(controller, known, model, tensions, arguments.steps, arguments.repeats)
        for name, controller in controllers(known, tensions).items()
    }
    print(f"times of a step, the best of {arguments.repeats}: by the clock, then of the processor")
    print(HEADER)
    for name, run in runs.items():
        print(summary(name, run))
    for name, run in runs.items():
        worst = max(plan.residual for plan in run.plans)
        print(f"{name}: residual of the stages before a plan is improved up to {worst:.0e}")
        for fault, times in Counter(plan.fault for plan in run.plans if not plan.solved).items():
            print(f"{name}: {times} times there was no plan: {fault}")
    draw(runs, arguments.output)
    print(f"wrote {arguments.output}")
    if arguments.animation:
        animate(runs, arguments.animation)
        print(f"wrote {arguments.animation}")


if __name__ == "__main__":
    main()
