"""A two-section tendon robot moves its tip by 0.15 m within 0.3 s and stops: with its motion in the model, and without.

Both controllers plan 20 stages ahead, 50 times a second, within bounds on the tensions and their rates. The one of
today takes the robot for a sequence of equilibria, and leaves it swinging. The other has its equations of motion in
every stage, and does not. Neither knows the payload of a tenth of the robot's mass. What is moved is a finer model,
simulated to a tolerance, while a plan is being made: a plan begins where the robot will be when it is ready.

A plan is improved by one step of sequential quadratic programming in every period (real-time iteration: M. Diehl et
al., J. Process Control 12, 2002). Its quadratic problem has the rates of the tensions alone: what else a stage has is
eliminated.
"""

from __future__ import annotations

import argparse
import time
from abc import ABC, abstractmethod
from dataclasses import dataclass
from pathlib import Path

import casadi as ca
import numpy as np

from cosserat_casadi import Model, build, compiled_motion_stage, compiled_stage, inverse, read_scene, solve
from cosserat_casadi.control import Condensing, Horizon, motion_stage, radau
from cosserat_casadi.motion.history import equations_of
from cosserat_casadi.motion.moving_inputs import MovingInputs
from cosserat_casadi.numerics.integration import StepOutcome, StepSettings
from cosserat_casadi.numerics.motion_equations import Instant
from cosserat_casadi.numerics.time_steps import integrate
from cosserat_casadi.scene.motions import InputMotion

SCENE = Path(__file__).parent / "two_section_robot.toml"
TENDONS = ["lower_east", "lower_north", "upper_west", "upper_south"]
TENSIONS = [f"{tendon}.tension" for tendon in TENDONS]
COUNT = len(TENDONS)

STEP, STAGES = 0.02, 20
"""Time between two steps, s, and how many of them the controllers look ahead."""

LARGEST, RATE = 30.0, 30.0
"""Bounds on the tensions, which are not negative, N, and on their rates, N/s."""

START, MOVE, DURATION = np.array([-0.04, -0.075, 0.37]), np.array([0.0, 0.15, 0.0]), 0.3
"""Where the tip rests at first and where it goes, m, and in which time, s."""

SETTLING, WATCHED = 0.2, 1.0
"""Time at rest before the move, and after it, s."""

DAMPING, EMPTY = "backbone.damping={retardation_time=2e-3}", "payload.force=[0, 0, 0]"
"""What is changed in the scene: the rod is damped, and its payload of 0.1 N taken off."""

PAYLOAD = 0.4e-3
"""Mass at the tip, kg: a tenth of the robot's."""

TRACKING, STOPPING, STOPPED, SMOOTHNESS = 6e3, 5.0, 200.0, 2e-6
"""Weights of the squares of the tip's deviation, m, of changes of the unknowns within a stage, at the last one, and of
the rates, N/s."""

TRUSTED, ADMITTED = 0.3, 0.02
"""Share of an error of prediction that is at once put down to a force at the tip; share of the tip's deviation from its
place at rest that the other controller makes up for. It takes swinging for such a deviation: a larger one drives it."""

NEWTON = 3
"""Newton steps for the state at the next step, and for the tip at rest."""


@dataclass(frozen=True)
class Measured:
    """What a controller is told of the robot.

    Attributes:
        tip: its position, m.
        x: coordinates of the controller's model that the curvatures along the robot belong to.
        v: their rates, 1/s.
        tensions: N.
        rates: of the tensions until the next step, N/s.
    """

    tip: np.ndarray
    x: np.ndarray
    v: np.ndarray
    tensions: np.ndarray
    rates: np.ndarray


@dataclass(frozen=True)
class Plan:
    """What a controller found at one step.

    Attributes:
        rates: of the tensions in every stage, shape (STAGES, COUNT), N/s.
        lifted: variables of the model in every stage, at their beginnings first where there are several.
        correction: what is known of the payload: the force at the tip, N, or the deviation of the tip, m; none yet.
        foreseen: state at the beginning of the first stage; none of a robot without motion.
        by_force: how that state depends on the force at the tip.
        residual: largest entry of a residual of the model at any stage, before this plan was improved.
        solved: whether the quadratic problem was solved.
    """

    rates: np.ndarray
    lifted: tuple[np.ndarray, ...]
    correction: np.ndarray | None = None
    foreseen: np.ndarray | None = None
    by_force: np.ndarray | None = None
    residual: float = 0.0
    solved: bool = True

    @property
    def first(self) -> np.ndarray:
        """Rates of the first stage; none where there is no plan."""
        return self.rates[0] if self.solved else np.zeros(COUNT)


def following(values: np.ndarray) -> np.ndarray:
    """Values of stages, one stage on; the last is held."""
    return np.concatenate([values[1:], values[-1:]])


def blocks(stacked: ca.DM) -> np.ndarray:
    """Matrices that stand side by side, one for each stage, as an array (STAGES, rows, columns)."""
    rows, columns = stacked.shape
    return stacked.full().reshape(rows, STAGES, columns // STAGES).transpose(1, 0, 2)


class Controller(ABC):
    """Rates of the tensions that bring the tip to wanted points, by least squares within bounds."""

    def __init__(self) -> None:
        size = STAGES * COUNT
        pattern = ca.Sparsity.dense(size, size)
        self.quadratic = ca.conic("rates", "daqp", {"h": pattern, "a": pattern}, {"error_on_fail": False})
        # Tensions at the ends of all stages are sums of rates.
        self.sums = STEP * np.kron(np.tril(np.ones((STAGES, STAGES))), np.eye(COUNT))

    @abstractmethod
    def begin(self) -> Plan:
        """The plan of a robot that rests."""

    @abstractmethod
    def step(self, plan: Plan, measured: Measured, wanted: np.ndarray) -> Plan:
        """The plan that begins at the next step, for wanted points at the ends of its stages, STAGES×3, m."""

    def change(
        self, rows: np.ndarray, values: np.ndarray, rates: np.ndarray, tensions: np.ndarray
    ) -> np.ndarray | None:
        """Change of all rates that makes the squares of values + rows · change least; None where none was found."""
        now = rates.ravel()
        held = np.tile(tensions, STAGES) + self.sums @ now
        found = self.quadratic(
            h=rows.T @ rows + SMOOTHNESS * np.eye(len(now)),
            g=rows.T @ values + SMOOTHNESS * now,
            a=self.sums,
            lbx=-RATE - now,
            ubx=RATE - now,
            lba=-held,
            uba=LARGEST - held,
        )
        change = found["x"].full()[:, 0]
        return change if self.quadratic.stats()["success"] and np.all(np.isfinite(change)) else None


class Moving(Controller):
    """With the equations of motion in every stage."""

    def __init__(self, model: Model, x: np.ndarray) -> None:
        super().__init__()
        self.x = x
        self.stage = motion_stage(model, STEP)
        compiled = compiled_motion_stage(self.stage, "swing_free_motion")
        self.horizon = Condensing(self.stage, compiled.equations, STAGES, range(COUNT))
        self.period = Condensing(self.stage, compiled.equations, 1, range(COUNT))
        state, _, inputs, _ = self.stage.symbols
        by_state, _ = compiled.poses.jacobian()(state, inputs, ca.DM(7, 1))
        tip = [compiled.poses(state, inputs)[:3], by_state[:3, :]]
        self.tips = ca.Function("tips", [state, inputs], tip).map(STAGES)

    def begin(self) -> Plan:
        states = np.tile(self.stage.state(self.x), (STAGES + 1, 1))
        unknowns = np.tile(self.stage.still(self.x), (STAGES, 1))
        return Plan(np.zeros((STAGES, COUNT)), (states, unknowns))

    def step(self, plan: Plan, measured: Measured, wanted: np.ndarray) -> Plan:
        state = self.stage.state(measured.x, measured.v)
        force = np.zeros(3) if plan.correction is None else plan.correction
        if plan.foreseen is not None:
            force = force + TRUSTED * np.linalg.lstsq(plan.by_force, state - plan.foreseen, rcond=None)[0]
        foreseen, by_force = self.foreseen(state, measured, force, plan.lifted[1][0])

        rates = following(plan.rates)
        states, unknowns = (following(each) for each in plan.lifted)
        states[0] = foreseen
        tensions = measured.tensions + STEP * measured.rates
        held = tensions + np.vstack([np.zeros(COUNT), np.cumsum(STEP * rates, axis=0)])
        inputs = np.hstack([held, np.tile(force, (STAGES + 1, 1))])
        inputs_rate = np.hstack([rates, np.zeros((STAGES, 3))])
        linear = self.horizon.condensed(Horizon(states, unknowns), inputs[:-1], inputs_rate)

        tips, tips_by_state = self.tips(states[1:].T, inputs[1:].T)
        by_rates, shift = linear.states_by_rates[1:], linear.states_shift[1:]
        tip_by_state = blocks(tips_by_state)
        deviation = tips.full().T - wanted + (tip_by_state @ shift[:, :, None])[:, :, 0]
        half = self.stage.state_size // 2
        stopping = np.sqrt(np.append(np.full(STAGES - 1, STOPPING), STOPPED))
        rows = [np.sqrt(TRACKING) * tip_by_state @ by_rates, stopping[:, None, None] * by_rates[:, half:]]
        values = [np.sqrt(TRACKING) * deviation, stopping[:, None] * (states[1:] + shift)[:, half:]]
        flat = [each.reshape(-1, STAGES * COUNT) for each in rows]
        change = self.change(np.concatenate(flat), np.concatenate([each.ravel() for each in values]), rates, tensions)
        if change is None:
            return Plan(0.0 * rates, self.begin().lifted, force, foreseen, by_force, np.inf, solved=False)
        better = linear.moved(change)
        rates = rates + change.reshape(STAGES, COUNT)
        return Plan(rates, (better.states, better.unknowns), force, foreseen, by_force, linear.residual)

    def foreseen(
        self, state: np.ndarray, measured: Measured, force: np.ndarray, unknowns: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """State at the next step, under the rates that hold until then; its derivative with the force at the tip."""
        inputs = np.concatenate([measured.tensions, force])[None]
        rate = np.concatenate([measured.rates, np.zeros(3)])[None]
        guess = Horizon(np.array([state, state]), unknowns[None])
        for _ in range(NEWTON):
            linear = self.period.condensed(guess, inputs, rate)
            guess = linear.moved(np.zeros(COUNT))
        return guess.states[1], linear.states_by_inputs[1, :, COUNT:]


class Resting(Controller):
    """With an equilibrium at the end of every stage, as ``tendon_robot_mpc.py`` has it."""

    def __init__(self, model: Model, x: np.ndarray) -> None:
        super().__init__()
        self.x = x
        stage = compiled_stage(model, "swing_free_rest", curvature=False)
        unknowns, inputs = stage.mx_in()
        outputs = [ca.DM(model.size, 1), ca.DM(7, 1)]
        by_x, by_inputs, pose_by_x, pose_by_inputs = stage.jacobian()(unknowns, inputs, *outputs)
        residual, pose = stage(unknowns, inputs)
        results = [residual, pose[:3], by_x, by_inputs, pose_by_x[:3, :], pose_by_inputs[:3, :]]
        self.equilibrium = ca.Function("equilibrium", [unknowns, inputs], results)
        self.all_equilibria = self.equilibrium.map(STAGES)

    def begin(self) -> Plan:
        return Plan(np.zeros((STAGES, COUNT)), (np.tile(self.x, (STAGES, 1)),))

    def step(self, plan: Plan, measured: Measured, wanted: np.ndarray) -> Plan:
        deviation = measured.tip - self.tip_at_rest(measured.tensions, plan.lifted[0][0])
        # The robot rests at first: all of the deviation is due to the payload.
        before = deviation if plan.correction is None else plan.correction
        offset = before + ADMITTED * (deviation - before)
        tensions = measured.tensions + STEP * measured.rates
        rates = following(plan.rates)
        x = following(plan.lifted[0])
        held = tensions + np.cumsum(STEP * rates, axis=0)
        inputs = np.hstack([held, np.zeros((STAGES, 3))])
        residual, tip, *slopes = self.all_equilibria(x.T, inputs.T)
        by_x, by_inputs, tip_by_x, tip_by_inputs = (blocks(each) for each in slopes)
        right = np.concatenate([residual.full().T[:, :, None], by_inputs[:, :, :COUNT]], axis=2)
        eliminated = -np.linalg.solve(by_x, right)
        by_tensions = tip_by_x @ eliminated[:, :, 1:] + tip_by_inputs[:, :, :COUNT]
        sums = self.sums.reshape(STAGES, COUNT, -1)
        rows = np.sqrt(TRACKING) * (by_tensions @ sums)
        shift = (tip_by_x @ eliminated[:, :, :1])[:, :, 0]
        values = np.sqrt(TRACKING) * (tip.full().T + shift + offset - wanted)
        change = self.change(rows.reshape(-1, STAGES * COUNT), values.ravel(), rates, tensions)
        if change is None:
            return Plan(0.0 * rates, self.begin().lifted, offset, residual=np.inf, solved=False)
        held_change = (self.sums @ change).reshape(STAGES, COUNT, 1)
        x = x + (eliminated[:, :, :1] + eliminated[:, :, 1:] @ held_change)[:, :, 0]
        return Plan(rates + change.reshape(STAGES, COUNT), (x,), offset, residual=float(np.abs(residual.full()).max()))

    def tip_at_rest(self, tensions: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Where the model has the tip at rest."""
        inputs = np.concatenate([tensions, np.zeros(3)])
        for _ in range(NEWTON):
            residual, tip, by_x, *_ = self.equilibrium(x, inputs)
            x = x - np.linalg.solve(by_x.full(), residual.full()[:, 0])
        return np.asarray(tip.full()[:, 0])


class Robot:
    """What is moved: a finer model with the payload, simulated to a tolerance."""

    def __init__(self, model: Model, tensions: np.ndarray) -> None:
        self.model = model
        self.tensions = tensions
        rest = solve(model, dict(zip(TENSIONS, tensions, strict=True)), raise_on_failure=True)
        self.now = Instant(0.0, rest.x, 0.0 * rest.x, 0.0 * rest.x)
        self.settings = StepSettings(np.full(model.size, 1e-6), first=STEP / 10, longest=STEP / 2)

    @property
    def tip(self) -> np.ndarray:
        """Position of the tip, m."""
        return np.asarray(self.model.tip["backbone"](self.now.x, self.tensions)[0].full()[:, 0])

    def centre_line(self) -> np.ndarray:
        """Points along the robot, shape (k, 3), m."""
        sections = np.linspace(0, 1, 31)
        shape = self.model.shape["backbone"].map(len(sections))
        count = len(sections)
        points = shape(np.tile(self.now.x[:, None], count), np.tile(self.tensions[:, None], count), sections[None])[0]
        return np.asarray(points.full().T)

    def measured(self, known: Model, rates: np.ndarray) -> Measured:
        """What is measured of it: curvatures along its length as far as another model has polynomials for them."""
        return Measured(self.tip, self._seen(known, self.now.x), self._seen(known, self.now.v), self.tensions, rates)

    def _seen(self, known: Model, values: np.ndarray) -> np.ndarray:
        # Legendre polynomials are orthogonal: the first coefficients are the best of so many.
        fine = self.model.discretisation["backbone"]
        coarse = known.discretisation["backbone"]
        strains = values[self.model.discrete.unknowns.strain("backbone")]
        return strains.reshape(-1, fine.modes[0])[:, : coarse.modes[0]].ravel()

    def advance(self, rates: np.ndarray) -> None:
        """Move on by a step with tensions that change at these rates."""
        ends = self.tensions + STEP * rates
        motions = [
            InputMotion(input=name, times=(0.0, STEP), values=(float(before), float(after)))
            for name, before, after in zip(TENSIONS, self.tensions, ends, strict=True)
        ]
        (piece,) = MovingInputs(self.model.inputs, motions, self.model.pack()).pieces(STEP)
        start = Instant(0.0, self.now.x, self.now.v, self.now.a)
        moved = integrate(equations_of(self.model, piece), start, STEP, radau(3), self.settings)
        if moved.outcome is not StepOutcome.COMPLETED:
            raise RuntimeError(moved.message)
        self.now, self.tensions = moved.end, ends


@dataclass(frozen=True)
class Run:
    """A simulated move, one row for each step.

    Attributes:
        seconds: times at the ends of the steps; the move begins at 0.
        wanted: points that the tip is to be at, m.
        tips: where it is, m.
        tensions: N.
        lines: centre lines of the robot, m.
        plans: what the controller found.
        clock: time that each step took, s.
        processor: the same on the processor: what the clock shows where nothing else runs, s.
    """

    seconds: np.ndarray
    wanted: np.ndarray
    tips: np.ndarray
    tensions: np.ndarray
    lines: np.ndarray
    plans: list[Plan]
    clock: np.ndarray
    processor: np.ndarray

    @property
    def swing(self) -> float:
        """Half the largest distance between two places of the tip after the move, m."""
        after = self.tips[self.seconds >= DURATION]
        distances = np.linalg.norm(after[:, None] - after[None], axis=2)
        return float(distances.max() / 2)


def wanted_at(seconds: np.ndarray) -> np.ndarray:
    """Wanted points of the tip: a straight line with the least jerk, at rest before and after it."""
    share = np.clip(seconds / DURATION, 0.0, 1.0)
    smooth = share**3 * (10 - 15 * share + 6 * share**2)
    return START + smooth[:, None] * MOVE


def known_model() -> Model:
    """What the controllers know: the robot without payload, and a force at its tip to make up for it."""
    inputs = f"inputs={[*TENSIONS, 'payload.force']}"
    return build(read_scene(SCENE, [inputs, DAMPING, EMPTY, "accuracy={modes=2, nodes=2}"]))


def moved_model(modes: int = 4) -> Model:
    """What is moved: with more modes, and a payload; its tip is to be where the move begins."""
    body = f"bodies=[{{name='load', mass={PAYLOAD}, inertia=[1e-9, 1e-9, 1e-9]}}]"
    joint = "joints=[{body='load', rod='backbone', kind='fixed'}]"
    accuracy = f"accuracy={{modes={modes}, nodes=6}}"
    target = f"targets=[{{kind='position', rod='backbone', position={START.tolist()}}}]"
    changes = [f"inputs={TENSIONS}", DAMPING, EMPTY, accuracy, body, joint, target]
    return build(read_scene(SCENE, changes), moving=True)


def start_tensions(model: Model) -> np.ndarray:
    """Tensions that hold the tip where the move begins, N."""
    found = inverse(model)
    if not found.met:
        raise RuntimeError(found.solution.message)
    return np.array([float(found.values[name]) for name in TENSIONS])


def controllers(known: Model, tensions: np.ndarray) -> dict[str, Controller]:
    """Both controllers, which begin at these tensions, N."""
    at_rest = solve(known, dict(zip(TENSIONS, tensions, strict=True)), raise_on_failure=True)
    return {"equilibria": Resting(known, at_rest.x), "motion": Moving(known, at_rest.x)}


def simulate(
    controller: Controller, known: Model, model: Model, tensions: np.ndarray, steps: int, repeats: int = 1
) -> Run:
    """The move under a controller; each step of its is repeated, and the best time counts."""
    robot = Robot(model, tensions)
    plan = controller.begin()
    rates = np.zeros(COUNT)
    seconds = STEP * np.arange(1, steps + 1) - SETTLING
    tips, pulls, lines, plans, spent = [], [], [], [], []
    for now in seconds:
        measured = robot.measured(known, rates)
        # The plan is ready, and begins, at the end of this step.
        ahead = wanted_at(now + STEP * np.arange(1, STAGES + 1))
        times = []
        for _ in range(repeats):
            began = time.perf_counter(), time.process_time()
            found = controller.step(plan, measured, ahead)
            times.append((time.perf_counter() - began[0], time.process_time() - began[1]))
        robot.advance(rates)
        plan = found
        rates = np.clip(plan.first, -robot.tensions / STEP, (LARGEST - robot.tensions) / STEP)
        tips.append(robot.tip)
        pulls.append(robot.tensions)
        lines.append(robot.centre_line())
        plans.append(plan)
        spent.append(np.min(times, axis=0))
    clock, processor = np.array(spent).T
    wanted = wanted_at(seconds)
    return Run(seconds, wanted, np.array(tips), np.array(pulls), np.array(lines), plans, clock, processor)


HEADER = """| plan | swing | gap at 0.3 s | at the end, mm | clock | 99 % | worst, ms | processor | 99 % | worst, ms |
| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"""


def summary(name: str, run: Run) -> str:
    """A row of the table that the program prints."""
    gaps = 1e3 * np.linalg.norm(run.tips - run.wanted, axis=1)
    arrived = gaps[np.searchsorted(run.seconds, DURATION - STEP / 2)]
    times = np.concatenate([np.percentile(1e3 * spent, [50, 99, 100]) for spent in (run.clock, run.processor)])
    numbers = [f"{value:.1f}" for value in (1e3 * run.swing, arrived, gaps[-1], *times)]
    return f"| {' | '.join([name, *numbers])} |"


COLOURS = {"equilibria": "#ee6677", "motion": "#4477aa"}


def draw(runs: dict[str, Run], file: Path) -> None:
    """Path of the tip, how far it is along the move, and the tensions under both controllers."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11.0, 7.0), layout="constrained")
    path, along, *pulls = figure.subplots(2, 2).ravel()
    for name, run in runs.items():
        path.plot(*1e3 * run.tips[:, 1:].T, color=COLOURS[name], label=f"planned with {name}")
        along.plot(run.seconds, 1e3 * run.tips[:, 1], color=COLOURS[name], label=f"planned with {name}")
    any_run = runs["motion"]
    along.plot(any_run.seconds, 1e3 * any_run.wanted[:, 1], color="0.6", linestyle=":", label="wanted")
    path.plot(*1e3 * any_run.wanted[[0, -1], 1:].T, color="black", marker="o", markersize=4, linestyle="")
    path.set(xlabel="y, mm", ylabel="z, mm", aspect="equal", title="path of the tip")
    along.set(xlabel="time, s", ylabel="y, mm", title="tip along the move")
    along.legend()
    for axes, (name, run) in zip(pulls, runs.items(), strict=True):
        axes.plot(run.seconds, run.tensions)
        axes.set(xlabel="time, s", ylabel="tension, N", title=f"planned with {name}")
    pulls[-1].legend([tendon.replace("_", " ") for tendon in TENDONS])
    figure.savefig(file, dpi=130)


def animate(runs: dict[str, Run], file: Path) -> None:
    """Both robots side by side, at a fifth of their speed."""
    from matplotlib.animation import FuncAnimation, PillowWriter
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.6, 4.2), layout="constrained")
    pictures = []
    for number, (name, run) in enumerate(runs.items()):
        space = figure.add_subplot(1, 2, number + 1, projection="3d", title=f"planned with {name}")
        (line,) = space.plot([], [], [], color=COLOURS[name], linewidth=3)
        (trail,) = space.plot([], [], [], color="0.5", linewidth=1)
        space.plot(*run.wanted[[0, -1]].T, color="black", marker="o", markersize=3, linestyle="")
        space.set(xlim=(-0.2, 0.2), ylim=(-0.2, 0.2), zlim=(0.0, 0.4))
        space.view_init(elev=12, azim=15)
        space.set_aspect("equal")
        space.locator_params(nbins=4)
        pictures.append((run, line, trail))

    def frame(k: int) -> list[object]:
        for run, line, trail in pictures:
            line.set_data_3d(*run.lines[k].T)
            trail.set_data_3d(*run.tips[: k + 1].T)
        return [artist for _, line, trail in pictures for artist in (line, trail)]

    first = int(np.searchsorted(runs["motion"].seconds, -STEP))
    frames = range(first, len(runs["motion"].seconds))
    FuncAnimation(figure, frame, frames).save(file, PillowWriter(fps=round(0.2 / STEP)), dpi=72)


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
    print(HEADER)
    for name, run in runs.items():
        print(summary(name, run))
    for name, run in runs.items():
        unsolved = sum(not plan.solved for plan in run.plans)
        worst = max(plan.residual for plan in run.plans)
        print(f"{name}: {unsolved} plans not found, residual of the stages before a plan is improved up to {worst:.0e}")
    draw(runs, arguments.output)
    print(f"wrote {arguments.output}")
    if arguments.animation:
        animate(runs, arguments.animation)
        print(f"wrote {arguments.animation}")


if __name__ == "__main__":
    main()
