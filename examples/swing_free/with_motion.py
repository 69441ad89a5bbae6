"""The controller that plans with the equations of motion."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np
from swing_free.plans import (
    NEWTON,
    SOLVED,
    STOPPED,
    STOPPING,
    TRACKING,
    TRUSTED,
    Controller,
    Measured,
    Plan,
    blocks,
    following,
)
from swing_free.task import COUNT, STAGES, STEP

from cosserat_casadi import Model
from cosserat_casadi.codegen.motion_stage import compiled_motion_stage
from cosserat_casadi.control import Condensed, Condensing, Horizon, motion_stage, radau


@dataclass(frozen=True)
class Foreseen:
    """Where the robot will be at the next step, under the rates that hold until then.

    Attributes:
        state: of the model.
        by_force: its derivative with the force at the tip.
    """

    state: np.ndarray
    by_force: np.ndarray


class Moving(Controller):
    """With the equations of motion in every stage."""

    def __init__(self, model: Model, x: np.ndarray) -> None:
        super().__init__()
        self.x = x
        self.stage = motion_stage(model, STEP, radau(2))
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
        force = self.force_at_tip(plan, measured)
        foreseen = self.foreseen(measured, force, plan.lifted[1][0])
        if foreseen is None:
            return self.no_plan(force, "the state at the next step was not found")

        rates = following(plan.rates)
        states, unknowns = (following(each) for each in plan.lifted)
        states[0] = foreseen.state
        tensions = measured.tensions + STEP * measured.rates
        held = tensions + np.vstack([np.zeros(COUNT), np.cumsum(STEP * rates, axis=0)])
        inputs = np.hstack([held, np.tile(force, (STAGES + 1, 1))])
        inputs_rate = np.hstack([rates, np.zeros((STAGES, 3))])
        linear = self.horizon.condensed(Horizon(states, unknowns), inputs[:-1], inputs_rate)

        tracking = self.tracking(linear, inputs, wanted)
        stopping = self.stopping(linear)
        rows = np.concatenate([tracking[0], stopping[0]])
        values = np.concatenate([tracking[1], stopping[1]])
        change = self.change(rows, values, rates, tensions)
        if change is None:
            return self.no_plan(force, "the quadratic problem was not solved")
        better = linear.moved(change)
        return Plan(
            rates=rates + change.reshape(STAGES, COUNT),
            lifted=(better.states, better.unknowns),
            correction=force,
            foreseen=foreseen.state,
            by_force=foreseen.by_force,
            residual=linear.residual,
        )

    def force_at_tip(self, plan: Plan, measured: Measured) -> np.ndarray:
        """The force at the tip that makes up for what the last plan foresaw wrongly, N."""
        force = np.zeros(3) if plan.correction is None else plan.correction
        if plan.foreseen is None:
            return force
        error = self.stage.state(measured.x, measured.v) - plan.foreseen
        missing = np.linalg.lstsq(plan.by_force, error, rcond=None)[0]
        return np.asarray(force + TRUSTED * missing)

    def foreseen(self, measured: Measured, force: np.ndarray, unknowns: np.ndarray) -> Foreseen | None:
        """The state at the next step by Newton's method; None where its equations do not come to hold.

        Args:
            measured: now.
            force: at the tip, N.
            unknowns: guess of those of the stage until then.
        """
        state = self.stage.state(measured.x, measured.v)
        inputs = np.concatenate([measured.tensions, force])[None]
        rate = np.concatenate([measured.rates, np.zeros(3)])[None]
        guess = Horizon(np.array([state, state]), unknowns[None])
        for _ in range(NEWTON + 1):
            linear = self.period.condensed(guess, inputs, rate)
            if linear.residual <= SOLVED:
                return Foreseen(guess.states[1], linear.states_by_inputs[1, :, COUNT:])
            guess = linear.moved(np.zeros(COUNT))
        return None

    def tracking(self, linear: Condensed, inputs: np.ndarray, wanted: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Deviations of the tip at the ends of all stages, weighted: derivative with the rates, and value."""
        states = linear.guess.states[1:]
        tips, tips_by_state = self.tips(states.T, inputs[1:].T)
        tip_by_state = blocks(tips_by_state)
        by_rates = tip_by_state @ linear.states_by_rates[1:]
        moved = (tip_by_state @ linear.states_shift[1:, :, None])[:, :, 0]
        deviation = tips.full().T + moved - wanted
        weight = np.sqrt(TRACKING)
        return weight * by_rates.reshape(-1, STAGES * COUNT), weight * deviation.ravel()

    def stopping(self, linear: Condensed) -> tuple[np.ndarray, np.ndarray]:
        """Velocities at the ends of all stages, weighted, the last one most: derivative with the rates, and value."""
        half = self.stage.state_size // 2
        weights = np.sqrt(np.append(np.full(STAGES - 1, STOPPING), STOPPED))[:, None]
        velocities = linear.guess.states[1:, half:] + linear.states_shift[1:, half:]
        by_rates = weights[:, :, None] * linear.states_by_rates[1:, half:]
        return by_rates.reshape(-1, STAGES * COUNT), (weights * velocities).ravel()
