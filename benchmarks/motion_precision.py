"""Errors of time steps: every integrator on a smooth motion and on a sudden one, against steps and processor time.

A planar Kirchhoff cantilever of unit length, bending stiffness and mass, without damping, on eight modes: what is
measured is the error in time alone, at the tip. Its load grows as sin⁴, or its weight acts at once. `--write` puts the
tables into docs/accuracy.md and draws docs/figures/motion_precision.png.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from doc_tables import put, table
from rich.progress import Progress

from cosserat_casadi import Model, build, discretise, scene_from_dict
from cosserat_casadi.motion.displacement import displacements
from cosserat_casadi.motion.history import History, integrated
from cosserat_casadi.motion.pose_series import poses_of
from cosserat_casadi.motion.simulate import moving_inputs
from cosserat_casadi.numerics.collocation import Collocation, gauss, radau
from cosserat_casadi.numerics.integration import StepSettings
from cosserat_casadi.plots.figure import figure_class, write_figure

DOCS = Path(__file__).parents[1] / "docs"
BEGIN = "<!-- precision: written by benchmarks/motion_precision.py -->"
END = "<!-- end of precision -->"
FIGURE = "figures/motion_precision.png"

MODES, NODES = 8, 16

STEPS = (0.04, 0.02, 0.01, 0.005, 0.0025)
"""Given sizes of steps, in units of L² √(ρA/EI)."""

TABLE_STEP = 0.01
"""Size whose time stands in the table."""

TOLERANCES = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9)
"""Of one controlled step, over the length."""

EXACT = 1e-15
"""Error that Newton's method may leave in a step of given size, over the length."""

ROUNDING = 2e-11
"""Error of the tip, over the length, below which rounding is felt, and no order is read off."""

CONTROLLED = "Radau IIA, stages 3, controlled"

PLAIN = {"name": "rod", "length": 1.0, "strain": "planar", "stiffness": {"bending_y": 1.0}, "linear_density": 1.0}
PLAIN["base"] = {"position": [0, 0, 0], "tangent": [1, 0, 0]}
LINE_LOAD = {"name": "line", "kind": "distributed_wrench", "rod": "rod", "force": [0.0, 0.0, 0.0]}
WEIGHT = {"name": "weight", "kind": "gravity", "acceleration": [0.0, 0.0, -10.0]}

# 10 sin⁴(πt/2) = 5 (1 − cos πt) − 1.25 (1 − cos 2πt)
WAVES = [
    {"input": "line.force", "wave": "one_minus_cosine", "frequency": 0.5, "amplitude": [0.0, 0.0, -5.0]},
    {"input": "line.force", "wave": "one_minus_cosine", "frequency": 1.0, "amplitude": [0.0, 0.0, 1.25]},
]

Vector = np.ndarray


@dataclass(frozen=True)
class Case:
    """A motion from rest in the unloaded shape.

    Attributes:
        title: what happens.
        load: the load.
        waves: of the load, in time.
        duration: time at which the tip is compared.
        known: position of the tip then, in x and z, by another program on more modes.
        reference: step of Gauss's method with three stages that errors are taken from.
    """

    title: str
    load: dict[str, Any]
    waves: list[dict[str, Any]]
    duration: float
    known: tuple[float, float]
    reference: float

    def model(self) -> Model:
        """The discrete model."""
        simulation = {"duration": self.duration, "start": "unloaded"}
        tables = {"schema": 1, "rods": [PLAIN], "loads": [self.load], "motions": self.waves, "simulation": simulation}
        scene = scene_from_dict(tables).with_motion_inputs()
        return build(scene, discretise(scene, MODES, NODES, "magnus6"), moving=True)


CASES = {
    "smooth": Case("load growing as sin⁴", LINE_LOAD, WAVES, 1.5, (0.58715052, -0.74810653), 0.002),
    "sudden": Case("weight at once", WEIGHT, [], 1.0, (0.81593, -0.54553), 0.00025),
}


@dataclass(frozen=True)
class Measured:
    """One motion.

    Attributes:
        method: family and stages.
        step: size of all steps; nan where they are controlled.
        tolerance: of a controlled step; nan where steps are given.
        count: steps taken.
        error: of the tip at the end, over the length.
        seconds: processor time.
    """

    method: str
    step: float
    tolerance: float
    count: int
    error: float
    seconds: float


def computed(model: Model, duration: float, method: Collocation, settings: StepSettings) -> tuple[History, float]:
    """A motion, and the processor time that it took, s."""
    pieces = moving_inputs(model).pieces(duration)
    still = np.zeros(model.size)
    begin = time.process_time()
    history = integrated(model, pieces, model.unloaded(), still, method, settings)
    took = time.process_time() - begin
    return history, took


def given_steps(model: Model, size: float) -> StepSettings:
    """Steps of one size, whose equations are solved to rounding."""
    return StepSettings(tolerance=EXACT / displacements(model), size=size, newton=1.0)


def controlled_steps(model: Model, tolerance: float) -> StepSettings:
    """Steps as long as a tolerance over the length allows."""
    return StepSettings(tolerance=tolerance / displacements(model))


def tip_of(history: History) -> Vector:
    """Position of the tip at the end, shape (3,)."""
    end = history.end
    state = history.at(end.time)
    return np.asarray(poses_of(history.model.tip["rod"], state.x[None], state.inputs[None]).position[0])


def measured(model: Model, duration: float, true_tip: Vector) -> Iterator[Measured]:
    """Every integrator with every step or tolerance."""
    for family in (radau, gauss):
        for stages in (1, 2, 3):
            method = family(stages)
            for size in STEPS:
                history, seconds = computed(model, duration, method, given_steps(model, size))
                error = error_of(history, true_tip)
                count = history.statistics.steps
                yield Measured(method.name, size, math.nan, count, error, seconds)
    for tolerance in TOLERANCES:
        history, seconds = computed(model, duration, radau(3), controlled_steps(model, tolerance))
        error = error_of(history, true_tip)
        count = history.statistics.steps
        yield Measured(CONTROLLED, math.nan, tolerance, count, error, seconds)


def error_of(history: History, true_tip: Vector) -> float:
    """Error of the tip at the end; nan where the end was not reached."""
    if not history.completed:
        return math.nan
    return float(np.linalg.norm(tip_of(history) - true_tip))


# Table and figure

HEADINGS = (
    "motion", "integrator", "step 0.04", "0.02", "0.01", "0.005", "0.0025", "order", "processor, s, at 0.01",
)  # fmt: skip

CONTROLLED_HEADINGS = ("motion", "tolerance of a step", "steps", "error / L", "processor, s")


def order_of(rows: Sequence[Measured]) -> float:
    """Power of the step that the error goes with, by least squares over errors clear of rounding."""
    kept = [row for row in rows if row.error > ROUNDING]
    sizes = np.log([row.step for row in kept])
    errors = np.log([row.error for row in kept])
    slope, _ = np.polyfit(sizes, errors, 1)
    return float(slope)


def given_table(found: dict[str, list[Measured]]) -> str:
    """A row for each motion and integrator, a column for each size of the steps."""
    lines = []
    for name, rows in found.items():
        given = [row for row in rows if math.isfinite(row.step)]
        for method in dict.fromkeys(row.method for row in given):
            of_method = [row for row in given if row.method == method]
            errors = [f"{row.error:.1e}" for row in of_method]
            (timed,) = (row for row in of_method if row.step == TABLE_STEP)
            lines.append([name, method, *errors, f"{order_of(of_method):.1f}", f"{timed.seconds:.2f}"])
    return table(HEADINGS, lines)


def controlled_table(found: dict[str, list[Measured]]) -> str:
    """A row for each motion and tolerance."""
    lines = []
    for name, rows in found.items():
        controlled = [row for row in rows if math.isfinite(row.tolerance)]
        lines += [
            [name, f"{row.tolerance:.0e}", str(row.count), f"{row.error:.1e}", f"{row.seconds:.2f}"]
            for row in controlled
        ]
    return table(CONTROLLED_HEADINGS, lines)


def space_lines(distances: dict[str, float]) -> str:
    """How far the tips on these modes are from those on more of them."""
    words = [f"{distance:.0e} ({name})" for name, distance in distances.items()]
    return (
        f"The tips on these {MODES} modes are {' and '.join(words)} of the length away from the tips of another "
        "program on 9 to 12 modes. This is the error in space, which no step reduces."
    )


COLOURS = {"Radau IIA": "#cc3311", "Gauss": "#4477aa"}
MARKERS = {"1": "o", "2": "s", "3": "^"}


def drawn(found: dict[str, list[Measured]]) -> Any:
    """Error against steps above, against processor time below; a column for each motion."""
    figure = figure_class()(figsize=(9.6, 7.6), layout="constrained")
    panels = figure.subplots(2, len(found), sharex="row", sharey=True)
    for column, (name, rows) in enumerate(found.items()):
        for row, (quantity, label) in enumerate((("count", "steps"), ("seconds", "processor time, s"))):
            axes = panels[row][column]
            for method in dict.fromkeys(measurement.method for measurement in rows):
                of_method = [measurement for measurement in rows if measurement.method == method]
                _draw(axes, method, of_method, quantity)
            axes.set_xlabel(label)
            axes.grid(alpha=0.3)
        panels[0][column].set_title(f"{name}: {CASES[name].title}", fontsize=10)
    for axes in panels[:, 0]:
        axes.set_ylabel("tip error / length")
    panels[0][-1].legend(fontsize=7.5, loc="lower left")
    return figure


def _draw(axes: Any, method: str, rows: Sequence[Measured], quantity: str) -> None:
    amounts = [getattr(row, quantity) for row in rows]
    errors = [row.error for row in rows]
    if method == CONTROLLED:
        axes.loglog(amounts, errors, marker="*", markersize=9, color="#228833", linewidth=1.4, label=method)
        return
    family, stages = method.split(", stages ")
    style = "-" if family == "Gauss" else "--"
    axes.loglog(
        amounts, errors, style, marker=MARKERS[stages], markersize=5, color=COLOURS[family], linewidth=1.2, label=method
    )


def main(write: Annotated[bool, typer.Option("--write", help="Put table and figure into docs.")] = False) -> None:
    """Print the tables."""
    found = {}
    distances = {}
    runs = 6 * len(STEPS) + len(TOLERANCES)
    with Progress(transient=True) as bar:
        for name, case in CASES.items():
            model = case.model()
            reference, _ = computed(model, case.duration, gauss(3), given_steps(model, case.reference))
            true_tip = tip_of(reference)
            distances[name] = float(np.hypot(true_tip[0] - case.known[0], true_tip[2] - case.known[1]))
            rows = measured(model, case.duration, true_tip)
            found[name] = list(bar.track(rows, total=runs, description=name))
    text = "\n\n".join([given_table(found), controlled_table(found), space_lines(distances)])
    print(text)
    if write:
        picture = f"![Error of the tip against steps and processor time]({FIGURE})"
        put(DOCS / "accuracy.md", BEGIN, END, f"{text}\n\n{picture}")
        write_figure(drawn(found), DOCS / FIGURE, dpi=110)


if __name__ == "__main__":
    typer.run(main)
