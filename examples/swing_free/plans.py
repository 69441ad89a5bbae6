"""What a controller is told and what it finds, and the quadratic problem that both controllers have."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np
from swing_free.task import COUNT, LARGEST, RATE, STAGES, STEP

TRACKING, STOPPING, STOPPED, SMOOTHNESS = 6e3, 5.0, 200.0, 2e-6
"""Weights of the squares of the tip's deviation, m, of changes of the unknowns within a stage, at the last one, and of
the rates, N/s."""

TRUSTED, ADMITTED = 0.3, 0.02
"""Share of an error of prediction that is at once put down to a force at the tip; share of the tip's deviation from its
place at rest that the other controller makes up for. It takes swinging for such a deviation: a larger one drives it."""

NEWTON, SOLVED = 8, 1e-8
"""Most Newton steps for the state at the next step, and for the tip at rest; the residual at which they are found."""


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
        fault: why there is no plan; empty where there is one.
    """

    rates: np.ndarray
    lifted: tuple[np.ndarray, ...]
    correction: np.ndarray | None = None
    foreseen: np.ndarray | None = None
    by_force: np.ndarray | None = None
    residual: float = 0.0
    fault: str = ""

    @property
    def solved(self) -> bool:
        """Whether there is a plan."""
        return not self.fault

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

    def no_plan(self, correction: np.ndarray | None, fault: str) -> Plan:
        """Tensions are held, and the next plan begins as that of a robot that rests."""
        return replace(self.begin(), correction=correction, residual=np.inf, fault=fault)

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
