"""A two-section tendon robot follows a moving point: quasi-static model-predictive control, timed step by step.

At every step an optimal-control problem over 20 stages is solved anew from the last one's solution, shifted. Its states
are the tensions, its controls their rates; the rod's unknowns are variables of every stage and its equilibrium a
constraint. The controller knows a rod that is good to a thousandth of its length and the payload of the scene. What it
moves is a finer rod that is handed a heavier payload half way; the tip's deviation from the prediction is measured and
taken off the wanted points.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np

from cosserat_casadi import Model, Solution, build, read_scene, solve
from cosserat_casadi.codegen.stage import compiled_stage

SCENE = Path(__file__).parent / "two_section_robot.toml"
TENDONS = ["lower_east", "lower_north", "upper_west", "upper_south"]
TENSIONS = [f"{tendon}.tension" for tendon in TENDONS]

BALANCED = 1e-6
"""Largest entry of a residual that a plan may have at any stage."""

LENGTH, RADIUS, PERIOD = 0.4, 0.02, 4.0
"""Length of the robot and radius of the circle, m; time of a turn, s."""

STEP, STAGES = 0.05, 20
"""Time between two steps, s, and how many of them the controller looks ahead."""

LEAST, LARGEST, RATE = 0.1, 30.0, 20.0
"""Bounds on the tensions, N, and on their rates, N/s."""

PAYLOAD, HEAVIER = 0.1, 0.11
"""Weight of the payload that the controller knows, and that it has in the second half, N."""

TRACKING, EFFORT, SMOOTHNESS = 1e3, 1e-5, 1e-5
"""Weights of the squares of deviation over length, tension in N and its rate in N/s."""

SOLVERS: dict[str, dict[str, Any]] = {
    "fatrop": {"fatrop.print_level": 0, "fatrop.tol": 1e-5, "fatrop.mu_init": 1e-3},
    "ipopt": {
        "ipopt.print_level": 0,
        "ipopt.sb": "yes",
        "ipopt.tol": 1e-5,
        "ipopt.mu_init": 1e-3,
        "ipopt.warm_start_init_point": "yes",
    },
}
"""Options that make them stop at the same accuracy, from the same barrier."""


@dataclass
class Horizon:
    """The optimal-control problem as variables and constraints in the order of the stages, as fatrop wants them."""

    parameters: ca.MX
    cost: ca.MX
    variables: list[ca.MX] = field(default_factory=list)
    constraints: list[ca.MX] = field(default_factory=list)
    lower: list[float] = field(default_factory=list)
    upper: list[float] = field(default_factory=list)
    places: dict[str, list[slice]] = field(default_factory=lambda: {"tensions": [], "unknowns": [], "rates": []})
    states: list[int] = field(default_factory=list)
    controls: list[int] = field(default_factory=list)
    conditions: list[int] = field(default_factory=list)

    def add(self, kind: str, variable: ca.MX, lower: float, upper: float) -> ca.MX:
        """A new variable after all others."""
        first = len(self.lower)
        self.variables.append(variable)
        self.lower += [lower] * variable.numel()
        self.upper += [upper] * variable.numel()
        self.places[kind].append(slice(first, len(self.lower)))
        return variable

    def solver(self, name: str) -> ca.Function:
        """An NLP solver for it; fatrop is told the stages."""
        problem = {
            "x": ca.vertcat(*self.variables),
            "f": self.cost,
            "g": ca.vertcat(*self.constraints),
            "p": self.parameters,
        }
        options = {"print_time": False, "error_on_fail": False, **SOLVERS[name]}
        if name == "fatrop":
            stages = {"N": len(self.states) - 1, "nx": self.states, "nu": self.controls, "ng": self.conditions}
            options |= {"structure_detection": "manual", **stages, "equality": [True] * problem["g"].numel()}
        return ca.nlpsol("controller", name, problem, options)


def horizon(stage: ca.Function, stages: int) -> Horizon:
    """Tensions, rates and rods over the stages; the rod of the first one is no longer to be influenced."""
    count, size = len(TENDONS), stage.size1_in(0)
    wanted = ca.MX.sym("wanted", 3, stages)
    now = ca.MX.sym("now", count)
    problem = Horizon(ca.vertcat(now, ca.vec(wanted)), ca.MX(0))
    tensions = [ca.MX.sym(f"tensions_{k}", count) for k in range(stages + 1)]
    for k, held in enumerate(tensions):
        problem.add("tensions", held, LEAST if k else -np.inf, LARGEST if k else np.inf)
        controls = 0
        if k < stages:
            rate = problem.add("rates", ca.MX.sym(f"rates_{k}", count), -RATE, RATE)
            problem.constraints.append(tensions[k + 1] - held - STEP * rate)
            problem.cost += SMOOTHNESS * ca.sumsqr(rate)
            controls += count
        if k == 0:
            condition = held - now
        else:
            unknowns = problem.add("unknowns", ca.MX.sym(f"unknowns_{k}", size), -np.inf, np.inf)
            condition, pose = stage(unknowns, held)
            problem.cost += TRACKING * ca.sumsqr((pose[:3] - wanted[:, k - 1]) / LENGTH) + EFFORT * ca.sumsqr(held)
            controls += size
        problem.constraints.append(condition)
        problem.states.append(count)
        problem.controls.append(controls)
        problem.conditions.append(condition.numel())
    return problem


@dataclass(frozen=True)
class Plan:
    """What the controller found at one step.

    Attributes:
        values: all variables.
        succeeded: whether the solver says that it converged and the rod is in equilibrium at every stage.
        iterations: its iterations.
        seconds: its time on the clock, the best of the repeats.
        processor: its time on the processor, the best of the repeats: what the clock shows where nothing else runs.
        residual: largest entry of any stage's residual at the values, computed again on the model.
    """

    values: np.ndarray
    succeeded: bool
    iterations: int
    seconds: float
    processor: float
    residual: float


class Controller:
    """The problem over the horizon with its solver, started from the last plan."""

    def __init__(self, model: Model, stage: ca.Function, solver: str, stages: int, near: Solution) -> None:
        self.model = model
        self.problem = horizon(stage, stages)
        self.solver = self.problem.solver(solver)
        self.start = np.zeros(len(self.problem.lower))
        for kind, value in {"tensions": near.inputs, "unknowns": near.x}.items():
            for place in self.problem.places[kind]:
                self.start[place] = value

    def plan(self, tensions: np.ndarray, wanted: np.ndarray, repeats: int) -> Plan:
        """The plan from here for the wanted points, stages×3."""
        given = {
            "x0": self.start,
            "p": np.concatenate([tensions, wanted.ravel()]),
            "lbx": self.problem.lower,
            "ubx": self.problem.upper,
            "lbg": 0,
            "ubg": 0,
        }
        spent = []
        for _ in range(repeats):
            began = time.perf_counter(), time.process_time()
            found = self.solver(**given)
            spent.append((time.perf_counter() - began[0], time.process_time() - began[1]))
        seconds, processor = np.min(spent, axis=0)
        said = self.solver.stats()
        values = found["x"].full()[:, 0]
        residual = self._residual(values)
        succeeded = bool(said["success"]) and residual <= BALANCED
        return Plan(values, succeeded, int(said["iter_count"]), seconds, processor, residual)

    def take(self, plan: Plan) -> None:
        """Start the next step from this plan, one stage on; the last stage is held."""
        self.start = plan.values.copy()
        for places in self.problem.places.values():
            for place, following in pairwise(places):
                self.start[place] = plan.values[following]

    def next_tensions(self, plan: Plan) -> np.ndarray:
        """Tensions at the end of this step."""
        return plan.values[self.problem.places["tensions"][1]]

    def _residual(self, values: np.ndarray) -> float:
        held = zip(self.problem.places["unknowns"], self.problem.places["tensions"][1:], strict=True)
        return max(float(ca.norm_inf(self.model.residual(values[x], values[u]))) for x, u in held)


@dataclass(frozen=True)
class Run:
    """A simulated run, one row for each step.

    Attributes:
        wanted: points that the tip is to be at, m.
        tips: where it is, m.
        tensions: N.
        plans: what the controller found.
        states: equilibria of the robot that was moved.
    """

    wanted: np.ndarray
    tips: np.ndarray
    tensions: np.ndarray
    plans: list[Plan]
    states: list[Solution]

    @property
    def gaps(self) -> np.ndarray:
        """Distance of the tip from where it was to be, m."""
        return np.linalg.norm(self.tips - self.wanted, axis=1)


def robots() -> tuple[Solution, Model]:
    """What the controller knows, solved at the scene's tensions, and a finer robot whose payload is an input."""
    known = solve(read_scene(SCENE, [f"inputs={TENSIONS}", "accuracy.tolerance=1e-3"]))
    fine = solve(read_scene(SCENE, [f"inputs={TENSIONS}", "accuracy.tolerance=1e-6"]))
    free = read_scene(SCENE, [f"inputs={[*TENSIONS, 'payload.force']}"])
    return known, build(free, fine.model.discretisation)


def circle(centre: np.ndarray, seconds: np.ndarray) -> np.ndarray:
    """Wanted points: a horizontal circle that starts at the tip's first place."""
    angle = 2 * np.pi * seconds / PERIOD
    return centre + RADIUS * np.column_stack([np.cos(angle) - 1, np.sin(angle), 0 * angle])


def simulate(known: Solution, robot: Model, stage: ca.Function, solver: str, steps: int, repeats: int = 1) -> Run:
    """Follow the circle; a plan that is none holds the tensions for a step."""
    centre = known.tip().position
    controller = Controller(known.model, stage, solver, STAGES, known)
    tensions, offset = known.inputs.copy(), np.zeros(3)
    state = solve(robot, raise_on_failure=True)
    wanted, tips, pulls, plans, states = [], [], [], [], []
    for k in range(steps):
        ahead = circle(centre, STEP * np.arange(k + 1, k + 1 + STAGES))
        plan = controller.plan(tensions, ahead - offset, repeats)
        if plan.succeeded:
            controller.take(plan)
            tensions = np.clip(controller.next_tensions(plan), LEAST, LARGEST)
        state = move(robot, tensions, HEAVIER if k >= steps // 2 else PAYLOAD, state)
        tip = state.tip().position
        predicted = solve(known.model, dict(zip(TENSIONS, tensions, strict=True)), start=known, raise_on_failure=True)
        offset = tip - predicted.tip().position
        wanted.append(ahead[0])
        tips.append(tip)
        pulls.append(tensions)
        plans.append(plan)
        states.append(state)
    return Run(np.array(wanted), np.array(tips), np.array(pulls), plans, states)


def move(robot: Model, tensions: np.ndarray, payload: float, near: Solution) -> Solution:
    """The robot at new tensions, from where it was."""
    values = {**dict(zip(TENSIONS, tensions, strict=True)), "payload.force": [0.0, 0.0, -payload]}
    return solve(robot, values, start=near, raise_on_failure=True)


def summary(solver: str, run: Run) -> str:
    """A row of the table that the program prints."""
    clock = 1e3 * np.array([plan.seconds for plan in run.plans])
    spent = 1e3 * np.array([plan.processor for plan in run.plans])
    iterations = np.array([plan.iterations for plan in run.plans])
    failed = sum(not plan.succeeded for plan in run.plans)
    residual = max(plan.residual for plan in run.plans)
    half = len(run.gaps) // 2
    before, after = 1e3 * np.median(run.gaps[:half]), 1e3 * np.median(run.gaps[half:])
    return (
        f"| {solver} | {np.median(clock):.1f} "
        f"| {np.median(spent):.1f} | {np.percentile(spent, 95):.1f} | {spent.max():.1f} "
        f"| {np.median(iterations):.0f} ({iterations.max()}) | {failed} | {residual:.0e} "
        f"| {before:.2f} / {after:.2f} | {1e3 * run.gaps.max():.1f} |"
    )


HEADER = """| solver | clock, ms | processor, ms | 95 % | worst | steps (most) | failed | residual | gap, mm | most |
| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"""


def draw(runs: dict[str, Run], file: Path) -> None:
    """Path of the tip, its gap, the tensions, and what each step took."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11.0, 7.0), layout="constrained")
    path, gap, tension, spent = figure.subplots(2, 2).ravel()
    run = runs["fatrop"]
    seconds = STEP * np.arange(1, len(run.tips) + 1)
    path.plot(*1e3 * run.wanted[:, :2].T, color="0.6", linewidth=4, label="wanted")
    path.plot(*1e3 * run.tips[:, :2].T, color="#ee6677", label="tip")
    path.set(xlabel="x, mm", ylabel="y, mm", aspect="equal")
    path.legend()
    gap.semilogy(seconds, 1e3 * run.gaps, color="#ee6677")
    gap.set(xlabel="time, s", ylabel="gap of the tip, mm")
    tension.plot(seconds, run.tensions)
    tension.set(xlabel="time, s", ylabel="tension, N")
    tension.legend([tendon.replace("_", " ") for tendon in TENDONS])
    for name, one in runs.items():
        spent.plot(seconds, [1e3 * plan.processor for plan in one.plans], label=name)
    spent.set(xlabel="time, s", ylabel="processor time of a step, ms", ylim=(0, None))
    spent.legend()
    figure.savefig(file, dpi=130)


def animate(run: Run, file: Path) -> None:
    """The robot and its wanted point, every second step."""
    from matplotlib.animation import FuncAnimation, PillowWriter
    from matplotlib.figure import Figure

    figure = Figure(figsize=(4.2, 4.2), layout="constrained")
    space = figure.add_subplot(projection="3d")
    (robot,) = space.plot([], [], [], color="#4477aa", linewidth=3)
    (trail,) = space.plot([], [], [], color="#ee6677")
    (point,) = space.plot([], [], [], color="black", marker="o", markersize=4, linestyle="")
    corner = np.vstack([run.tips, run.wanted, np.zeros(3)])
    for axis, low, high in zip("xyz", corner.min(axis=0), corner.max(axis=0), strict=True):
        space.set(**{f"{axis}lim": (low, high), f"{axis}label": f"{axis}, m"})
    space.set_aspect("equal")
    space.locator_params(nbins=4)

    def frame(k: int) -> list[object]:
        robot.set_data_3d(*run.states[k].pose(np.linspace(0, 1, 41)).position.T)
        trail.set_data_3d(*run.tips[: k + 1].T)
        point.set_data_3d(*run.wanted[k : k + 1].T)
        return [robot, trail, point]

    frames = range(0, len(run.states), 2)
    FuncAnimation(figure, frame, frames).save(file, PillowWriter(fps=round(0.5 / STEP)), dpi=72)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=120, help="steps of 0.05 s")
    parser.add_argument("--repeats", type=int, default=3, help="times that each step is solved; the best counts")
    parser.add_argument("--exact", action="store_true", help="second derivatives of the rod too")
    parser.add_argument("--output", type=Path, default=Path("tendon_robot_mpc.png"), help="figure")
    parser.add_argument("--animation", type=Path, help="the robot in motion, a .gif")
    arguments = parser.parse_args()
    known, robot = robots()
    stage = compiled_stage(known.model, "tendon_robot_stage", curvature=arguments.exact)
    runs = {name: simulate(known, robot, stage, name, arguments.steps, arguments.repeats) for name in SOLVERS}
    print(HEADER)
    for name, run in runs.items():
        print(summary(name, run))
    stable = sum(state.stable is True for state in runs["fatrop"].states)
    print(f"{stable} of {arguments.steps} states of the robot are stable")
    draw(runs, arguments.output)
    print(f"wrote {arguments.output}")
    if arguments.animation:
        animate(runs["fatrop"], arguments.animation)
        print(f"wrote {arguments.animation}")


if __name__ == "__main__":
    main()
