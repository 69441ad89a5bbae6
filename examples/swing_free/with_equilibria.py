"""The controller that plans with equilibria, as ``tendon_robot_mpc.py`` has it."""

from __future__ import annotations

import casadi as ca
import numpy as np
from swing_free.plans import ADMITTED, NEWTON, SOLVED, TRACKING, Controller, Measured, Plan, blocks, following
from swing_free.task import COUNT, STAGES, STEP

from cosserat_casadi import Model
from cosserat_casadi.codegen.stage import compiled_stage


class Resting(Controller):
    """With an equilibrium at the end of every stage."""

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
        at_rest = self.tip_at_rest(measured.tensions, plan.lifted[0][0])
        if at_rest is None:
            return self.no_plan(plan.correction, "the equilibrium at the measured tensions was not found")
        deviation = measured.tip - at_rest
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

        # Unknowns follow from the linearised equilibrium: what closes it, and what the tensions change.
        right = np.concatenate([residual.full().T[:, :, None], by_inputs[:, :, :COUNT]], axis=2)
        eliminated = -np.linalg.solve(by_x, right)
        x_shift, x_by_tensions = eliminated[:, :, :1], eliminated[:, :, 1:]
        tip_by_tensions = tip_by_x @ x_by_tensions + tip_by_inputs[:, :, :COUNT]
        tip_shift = (tip_by_x @ x_shift)[:, :, 0]
        tensions_by_rates = self.sums.reshape(STAGES, COUNT, -1)
        weight = np.sqrt(TRACKING)
        rows = weight * (tip_by_tensions @ tensions_by_rates)
        values = weight * (tip.full().T + tip_shift + offset - wanted)
        change = self.change(rows.reshape(-1, STAGES * COUNT), values.ravel(), rates, tensions)
        if change is None:
            return self.no_plan(offset, "the quadratic problem was not solved")
        tensions_change = (self.sums @ change).reshape(STAGES, COUNT, 1)
        return Plan(
            rates=rates + change.reshape(STAGES, COUNT),
            lifted=(x + (x_shift + x_by_tensions @ tensions_change)[:, :, 0],),
            correction=offset,
            residual=float(np.abs(residual.full()).max()),
        )

    def tip_at_rest(self, tensions: np.ndarray, x: np.ndarray) -> np.ndarray | None:
        """Where the model has the tip at rest, by Newton's method from x; None where there is no equilibrium near."""
        inputs = np.concatenate([tensions, np.zeros(3)])
        for _ in range(NEWTON + 1):
            residual, tip, by_x, *_ = self.equilibrium(x, inputs)
            if np.abs(residual.full()).max() <= SOLVED:
                return np.asarray(tip.full()[:, 0])
            x = x - np.linalg.solve(by_x.full(), residual.full()[:, 0])
        return None
