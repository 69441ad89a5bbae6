"""One optimal-control problem of a rod in motion: what several packages are given, and its replay in the simulator."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca
import numpy as np

from cosserat_casadi import Model, Solution, build, scene_from_dict, solve
from cosserat_casadi.control import Collocation, MotionStage, motion_stage
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.history import integrated
from cosserat_casadi.motion.moving_inputs import MovingInputs
from cosserat_casadi.numerics.integration import StepSettings
from cosserat_casadi.scene.motion_records import InputMotion

STAGES, STEP = 8, 0.04
"""Stages of the horizon, and the duration of each, s: together half a period of the first mode."""

LARGEST, RATE = 2.1, 6.0
"""Bounds on the tensions, N, and on their rates, N/s; some are active at the optimum."""

GOAL = 0.12
"""Where the tip is to be at the end, along x, m."""

TENDONS = ("east", "west")

IPOPT = {"ipopt.print_level": 0, "ipopt.sb": "yes", "ipopt.tol": 1e-11, "print_time": False}

EXACT = 1e-13
"""Error that Newton's method may leave in each unknown of a replay."""


def arm() -> Model:
    """A planar rod on two tendons, with damping."""
    tendons = [
        {"name": name, "kind": "tendon", "rod": "arm", "tension": 2.0, "offset": [side * 8e-3, 0.0]}
        for name, side in zip(TENDONS, (1, -1), strict=True)
    ]
    rod = {
        "name": "arm",
        "length": 0.4,
        "strain": "planar",
        "material": {"youngs_modulus": 60e9, "poisson_ratio": 0.33, "density": 6450.0},
        "section": {"shape": "circle", "radius": 0.7e-3},
        "damping": {"retardation_time": 2e-3},
    }
    gravity = {"name": "weight", "kind": "gravity", "acceleration": [0, 0, -9.81]}
    scene = {
        "schema": 1,
        "inputs": [f"{name}.tension" for name in TENDONS],
        "accuracy": {"modes": 3, "nodes": 4},
        "rods": [rod],
        "loads": [gravity],
        "actuators": tendons,
    }
    return build(scene_from_dict(scene), moving=True)


@dataclass(frozen=True)
class Swing:
    """A rest-to-rest motion as optimisers find it.

    Attributes:
        tensions: at the ends of all stages, shape (STAGES + 1, 2), N.
        states: of the stage, at the same times, shape (STAGES + 1, state_size).
    """

    tensions: FloatArray
    states: FloatArray


@dataclass(frozen=True)
class Task:
    """What is to be done: the tip moves from one place to another and stops; tensions change at bounded rates.

    Attributes:
        stage: of the arm.
        near: where it begins, at rest.
    """

    stage: MotionStage
    near: Solution

    @property
    def start(self) -> FloatArray:
        """State at the beginning."""
        return self.stage.state(self.near.x)

    def effort(self, rates: ca.MX) -> ca.MX:
        """What a stage costs: the squares of the rates."""
        return 1e-2 * ca.sumsqr(rates)

    def arrival(self, state: ca.MX, tensions: ca.MX, tip: Callable[[ca.MX, ca.MX], ca.MX] | None = None) -> ca.MX:
        """What the end costs: the gap of the tip, and what still moves."""
        position = tip(state, tensions) if tip else self.stage.model.tip["arm"](self.stage.x(state), tensions)[0]
        return 1e4 * (position[0] - GOAL) ** 2 + 1e2 * ca.sumsqr(state[self.stage.state_size // 2 :])


def task(method: Collocation | None = None) -> Task:
    """The task with stages of a collocation method."""
    model = arm()
    return Task(motion_stage(model, STEP, method), solve(model, raise_on_failure=True))


def optimum(wanted: Task) -> Swing:
    """The optimum by ipopt, in an Opti."""
    stage = wanted.stage
    opti = ca.Opti()
    states = [ca.MX(ca.DM(wanted.start))]
    tensions = [ca.MX(ca.DM(wanted.near.inputs))]
    cost = ca.MX(0)
    for _ in range(STAGES):
        rates = opti.variable(len(TENDONS))
        unknowns = opti.variable(stage.unknowns_size)
        opti.set_initial(unknowns, stage.still(wanted.near.x))
        opti.subject_to(opti.bounded(-RATE, rates, RATE))
        opti.subject_to(stage.equations(states[-1], unknowns, tensions[-1], inputs_rate=rates) == 0)
        following = opti.variable(stage.state_size)
        opti.set_initial(following, wanted.start)
        opti.subject_to(following == stage.next_state(states[-1], unknowns))
        states.append(following)
        tensions.append(tensions[-1] + STEP * rates)
        opti.subject_to(opti.bounded(0, tensions[-1], LARGEST))
        cost += wanted.effort(rates)
    opti.minimize(cost + wanted.arrival(states[-1], tensions[-1]))
    opti.solver("ipopt", IPOPT)
    found = opti.solve()
    return Swing(np.array([found.value(each) for each in tensions]), np.array([found.value(each) for each in states]))


def replayed(wanted: Task, tensions: FloatArray, method: Collocation) -> FloatArray:
    """States at the ends of all stages as the simulator has them, under the same tensions, shape of the states."""
    stage = wanted.stage
    times = STEP * np.arange(STAGES + 1)
    motions = [
        InputMotion(input=f"{name}.tension", times=tuple(times.tolist()), values=tuple(column.tolist()))
        for name, column in zip(TENDONS, tensions.T, strict=True)
    ]
    moving = MovingInputs(stage.model.inputs, motions, stage.model.pack())
    settings = StepSettings(np.full(stage.model.size, EXACT), size=STEP, newton=1.0)
    at_rest = np.zeros(stage.model.size)
    history = integrated(stage.model, moving.pieces(times[-1]), wanted.near.x, at_rest, method, settings)
    assert history.completed, history.outcome.value
    assert len(history.steps) == STAGES
    ends = [step.end for _, step in history.steps]
    return np.array([wanted.start, *[stage.state(end.x, end.v) for end in ends]])
