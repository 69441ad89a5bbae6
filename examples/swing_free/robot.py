"""The robot that is moved, and the move under a controller."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from swing_free.plans import Controller, Measured, Plan
from swing_free.task import COUNT, DURATION, LARGEST, SETTLING, STAGES, STEP, TENSIONS, wanted_at

from cosserat_casadi import Model, solve
from cosserat_casadi.control import radau
from cosserat_casadi.motion.history import equations_of
from cosserat_casadi.motion.moving_inputs import MovingInputs
from cosserat_casadi.numerics.integration import StepOutcome, StepSettings
from cosserat_casadi.numerics.motion_equations import Instant
from cosserat_casadi.numerics.time_steps import integrate
from cosserat_casadi.scene.motion_records import InputMotion


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
            raise RuntimeError(moved.outcome.value)
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
