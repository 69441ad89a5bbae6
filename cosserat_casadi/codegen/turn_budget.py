"""Default budget of a turn of a control loop: a fixed number of evaluations, or as many as fit a period.

A turn is bounded in evaluations. The time of an evaluation is measured by a program of the sources to be written, or
estimated by the laws of accuracy/cost.py without a compiler.
"""

from __future__ import annotations

import json
import subprocess
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cosserat_casadi.accuracy.cost import foreseen_time, spread_on
from cosserat_casadi.codegen.names import Names
from cosserat_casadi.codegen.structs import initialiser
from cosserat_casadi.compiling.compiler import FLAGS, find_compiler
from cosserat_casadi.compiling.texts import render
from cosserat_casadi.errors import ExportError, Problem
from cosserat_casadi.model.build import Model

MOST_ITERATIONS = 40
"""Most Newton steps of a turn without a period; ordinary turns take two to five."""

SETTLING_ITERATIONS = 4
"""Most Newton steps from a point on a path, which is as exact as the path needs, to a solution; two are usual."""

FORESEEN_STEPS = 5.0
"""Time of a Newton step over residual and Jacobian of plain rods, with tendons, joints and factorisation.

The measured ratio was 1 to 4.3 for rods, robots with tendons and the six-rod platform.
"""

FORESEEN_POINTS = 1.0
"""Time of a point of a path over residual and Jacobian of plain rods. It was 0.2 to 0.7."""

FORESEEN_ENDS = 9.0
"""Time of the end of a turn over residual and Jacobian of plain rods: Jacobian, derivatives. It was 3 to 8.4."""

TIME_LIMIT = 300.0
"""Time limit, s, of the compiler and of the measuring program."""


@dataclass(frozen=True)
class TurnCosts:
    """Times of the parts of a turn, µs.

    Attributes:
        step: time of a Newton step: residual, Jacobian and its factorisation.
        point: time of a point of a path: rate of the residual, and tangent.
        end: time of the verdict on the solution and its derivatives.
        measured: whether the times were measured on this machine; else they are estimated.
    """

    step: float
    point: float
    end: float
    measured: bool

    def worst(self, iterations: int, steps: int) -> float:
        """Longest turn, µs, of track or of recover.

        Args:
            iterations: Newton steps of its budget.
            steps: points between the last inputs and the new ones.
        """
        evaluations = iterations + steps + SETTLING_ITERATIONS + 2
        return evaluations * self.step + (steps + 1) * self.point + self.end


@dataclass(frozen=True)
class TurnBudget:
    """Steps that a turn may take by default.

    Attributes:
        iterations: number of Newton steps.
        steps: number of points between the last inputs and the new ones.
        period: time that a turn may take, s; None without a period.
        costs: times of the parts of a turn; None without a period.
    """

    iterations: int = MOST_ITERATIONS
    steps: int = MOST_ITERATIONS // 2
    period: float | None = None
    costs: TurnCosts | None = None

    @property
    def note(self) -> str:
        """Sentence of the header on the time of a turn; empty without a period."""
        if self.costs is None or self.period is None:
            return ""
        costs = self.costs
        worst = costs.worst(self.iterations, self.steps)
        how = "best of many on the machine of the export" if costs.measured else "foreseen, as there was no compiler"
        period = 1e6 * self.period
        return (
            f"\n   The defaults are those whose longest turn, {worst:.4g} us, fits a period of {period:.4g} us:\n"
            f"   (m + c + {SETTLING_ITERATIONS + 2}) x {costs.step:.4g} us + (c + 1) x {costs.point:.4g} us + "
            f"{costs.end:.4g} us,\n   {how}. A slower machine asks for a period as much shorter."
        )

    @property
    def entry(self) -> dict[str, object]:
        """Entry in the manifest."""
        described: dict[str, object] = {"max_iterations": self.iterations, "max_continuation_steps": self.steps}
        if self.costs is not None:
            worst = self.costs.worst(self.iterations, self.steps)
            how = "measured" if self.costs.measured else "foreseen"
            described |= {"period_s": self.period, "longest_us": float(f"{worst:.4g}"), "times": how}
        return described


ALWAYS = TurnBudget()
"""The budget without a period."""


def fitting(costs: TurnCosts, period: float) -> TurnBudget:
    """Find the largest budget, at most the one without a period, whose longest turn fits.

    Args:
        costs: times of the parts of a turn.
        period: time that a turn may take, s.

    Raises:
        ExportError: the period is too short for one Newton step on the way and one at the end.
    """
    for iterations in range(MOST_ITERATIONS, 0, -1):
        steps = (iterations + 1) // 2
        if costs.worst(iterations, steps) <= 1e6 * period:
            return TurnBudget(iterations, steps, period, costs)
    problem = f"a turn of this scene may take {costs.worst(1, 1):.3g} us, which is longer"
    raise ExportError(Problem("--period", problem, "give a longer one, or a larger tolerance, which takes fewer modes"))


def costs_of(model: Model, names: Names, files: Mapping[str, str]) -> TurnCosts:
    """Determine the times of the parts of a turn, by measurement if there is a compiler, else by estimates.

    Args:
        model: the exported model.
        names: names of the library and its parts.
        files: sources and headers by name.

    Raises:
        ExportError: there is a compiler, but it fails, or the program fails.
    """
    try:
        compiler = find_compiler()
    except ExportError:
        return foreseen_costs(model)
    return measured_costs(model, names, files, compiler)


def measured_costs(model: Model, names: Names, files: Mapping[str, str], compiler: str) -> TurnCosts:
    """Measure the times of the parts of a turn by a program of this compiler.

    Raises:
        ExportError: compiler or program fail, or take too long.
    """
    given = np.concatenate([model.inputs.pack(), model.parameters.pack()])
    words = {"name": names.name, "given": ", ".join(initialiser(value, names) for value in given.tolist()) or "0"}
    with tempfile.TemporaryDirectory() as folder:
        for name, text in files.items():
            (Path(folder) / name).write_text(text, encoding="utf-8")
        (Path(folder) / "turn_cost.c").write_text(render("turn_cost.c.in", words), encoding="utf-8")
        sources = ["turn_cost.c", f"{names.name}_kernels.c"]
        _run([compiler, *FLAGS, *sources, "-lm", "-o", "turn_cost"], folder)
        printed = json.loads(_run(["./turn_cost"], folder))
    return TurnCosts(**printed, measured=True)


def foreseen_costs(model: Model) -> TurnCosts:
    """Times of the parts of a turn, foreseen by the laws of the cost of single rods."""
    scene = model.scene
    equations = 0.0
    for name, rod in model.at().discrete.rods.items():
        equations += foreseen_time(rod.properties, rod.discretisation, spread_on(scene, name))
    return TurnCosts(FORESEEN_STEPS * equations, FORESEEN_POINTS * equations, FORESEEN_ENDS * equations, measured=False)


def _run(command: list[str], folder: str) -> str:
    try:
        done = subprocess.run(
            command, cwd=folder, capture_output=True, text=True, errors="replace", check=False, timeout=TIME_LIMIT
        )
    except subprocess.TimeoutExpired:
        problem = f"{command[0]} took longer than {TIME_LIMIT:g} s to tell what a turn takes"
        raise ExportError(Problem("--period", problem, "leave it out")) from None
    except OSError as error:
        problem = f"{command[0]} cannot be run: {error.strerror}"
        raise ExportError(Problem("--period", problem, "leave it out")) from None
    if done.returncode:
        problem = f"{command[0]} failed to tell what a turn takes: {done.stderr.strip()[-800:]}"
        raise ExportError(Problem("--period", problem, "leave it out"))
    return done.stdout
