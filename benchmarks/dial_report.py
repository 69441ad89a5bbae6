"""What the judged picks say, in a table and a figure."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from cosserat_casadi.plots.figure import figure_class, write_figure

DOCS = Path(__file__).parents[1] / "docs"
BEGIN, END = "<!-- dial: written by benchmarks/dial.py -->", "<!-- end of dial -->"
FIGURE = "figures/dial.png"
LAW = (
    "Cost is the time of residual and Jacobian compiled with gcc -O2, as predicted by the law of `accuracy/cost.py` "
    "([errors of the law](#what-the-choice-takes-a-discretisation-to-cost))."
)
COLOURS = ("#88ccee", "#4477aa", "#228833", "#aa3377")
RowDict = dict[str, str]

HEADINGS = (
    "tolerance", "scenes", "no equilibrium", "unresolved", "within, %", "worst error / tolerance",
    "error > estimate, %", "solve, s", "searched", "cost ratio, median", "95 %", "worst",
)  # fmt: skip


@dataclass(frozen=True)
class Results:
    """Rows as they stand in the files.

    Attributes:
        judged: picks and their true errors.
        cheapest: picks and what brute force found.
        sample: picks and cheapest, compiled.
    """

    judged: list[RowDict]
    cheapest: list[RowDict]
    sample: list[RowDict]

    @cached_property
    def tolerances(self) -> list[str]:
        """Loose ones first."""
        return sorted({row["tolerance"] for row in self.judged}, key=float, reverse=True)

    @cached_property
    def text(self) -> str:
        """A table in Markdown and what it leaves out."""
        lines = [HEADINGS, ("---",) * len(HEADINGS), *(self._line(tolerance) for tolerance in self.tolerances)]
        lines.append(self._line(None))
        table = "\n".join(f"| {' | '.join(cells)} |" for cells in lines)
        return "\n".join([table, "", *(f"* {sentence}" for sentence in self._sentences())])

    def ratios(self, tolerance: str | None = None) -> np.ndarray:
        """Foreseen time of the pick over that of the cheapest."""
        rows = _at(self.cheapest, tolerance)
        ratio = _numbers(rows, "cost") / _numbers(rows, "cheapest")
        finite: np.ndarray = ratio[np.isfinite(ratio)]
        return finite

    def excess(self, tolerance: str | None = None) -> np.ndarray:
        """True error over tolerance."""
        rows = _at(self.judged, tolerance)
        excess = _numbers(rows, "error") / _numbers(rows, "tolerance")
        finite: np.ndarray = excess[np.isfinite(excess)]
        return finite

    def _line(self, tolerance: str | None) -> list[str]:
        rows = _at(self.judged, tolerance)
        outcomes = [row["outcome"] for row in rows]
        excess, ratios = self.excess(tolerance), self.ratios(tolerance)
        beyond = [float(row["error"]) > float(row["estimate"]) for row in rows if row["chosen"]]
        failed = sum(outcome not in ("converged", "unresolved") for outcome in outcomes)
        cells = ["all" if tolerance is None else f"{float(tolerance):.0e}", str(len(rows)), str(failed)]
        cells += [str(outcomes.count("unresolved")), f"{100 * np.mean(excess <= 1):.1f}", f"{excess.max():.2f}"]
        cells += [f"{100 * np.mean(beyond):.1f}", f"{np.median(_numbers(rows, 'seconds')):.1f}", str(len(ratios))]
        return cells + (_spread(ratios) if len(ratios) else ["–"] * 3)

    def _sentences(self) -> list[str]:
        found = []
        shot = sum(row["reference"] == "shooting" for row in self.judged)
        stood_in = sum(row["reference"] == "finer" for row in self.judged)
        found.append(
            f"The reference of the true errors is shooting for {shot} picks, and a far finer discretisation for "
            f"{stood_in} picks at which shooting fails."
        )
        cold = _numbers(self.judged, "cold") / _numbers(self.judged, "tolerance")
        cold = cold[np.isfinite(cold)]
        if len(cold):
            found.append(
                f"{len(cold)} picks were also compared with shooting that started from the unloaded rod and followed "
                f"the loads: {np.sum(cold <= 1)} are within the tolerance, the worst at {cold.max():.2f} of it."
            )
        found.append(LAW)
        if self.sample:
            found.append(_sample_sentence(self.sample))
        return found


def write_results(results: Results) -> None:
    """Table and figure into the docs."""
    page = DOCS / "accuracy.md"
    before, rest = page.read_text().split(BEGIN)
    picture = f"![True errors and costs of the picked discretisations]({FIGURE})"
    page.write_text(f"{before}{BEGIN}\n{results.text}\n\n{picture}\n{END}{rest.split(END)[1]}")
    (DOCS / FIGURE).parent.mkdir(exist_ok=True)
    write_figure(_figure(results), DOCS / FIGURE, dpi=110)


def _sample_sentence(rows: list[RowDict]) -> str:
    foreseen = _numbers(rows, "foreseen_chosen") / _numbers(rows, "foreseen_best")
    jacobian = _numbers(rows, "jacobian_chosen") / _numbers(rows, "jacobian_best")
    cold = _numbers(rows, "cold_chosen") / _numbers(rows, "cold_best")
    pairs = ((foreseen, "predicted"), (jacobian, "compiled residual and Jacobian"), (cold, "compiled cold solve"))
    words = "; ".join(f"{name} {' / '.join(_spread(ratio))}" for ratio, name in pairs)
    return (
        f"{len(rows)} random pairs of different pick and cheapest were compiled and run. Ratios, median / 95 % / "
        f"worst: {words}."
    )


def _spread(ratios: np.ndarray) -> list[str]:
    return [f"{np.median(ratios):.2f}", f"{np.percentile(ratios, 95):.2f}", f"{ratios.max():.2f}"]


def _at(rows: list[RowDict], tolerance: str | None) -> list[RowDict]:
    return [row for row in rows if tolerance is None or float(row["tolerance"]) == float(tolerance)]


def _numbers(rows: list[RowDict], key: str) -> np.ndarray:
    return np.array([float(row[key]) for row in rows])


def _figure(results: Results) -> Any:
    figure = figure_class()(figsize=(9.0, 3.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    bins = np.logspace(-3, 1, 41)
    shares = [np.clip(results.excess(tolerance), bins[0], bins[-1]) for tolerance in results.tolerances]
    names = [f"{float(tolerance):.0e}".replace("e-0", "e-") for tolerance in results.tolerances]
    left.hist(shares, bins=bins, stacked=True, color=COLOURS[: len(shares)], label=names)
    left.axvline(1.0, color="#cc3311", linewidth=1.5)
    left.set_xscale("log")
    left.set_xlabel("true error / tolerance")
    left.set_ylabel("picks")
    left.legend(title="tolerance", fontsize=8, title_fontsize=8)
    _draw_shares(right, results.ratios)
    return figure


def _draw_shares(axes: Any, ratios: Callable[[], np.ndarray]) -> None:
    ordered = np.sort(ratios())
    axes.step(ordered, np.linspace(0, 100, len(ordered)), where="post", color="#4477aa")
    axes.plot([1.5, 3.0], [50, 95], "o", color="#cc3311", label="asked for: median 1.5, 95 % below 3")
    axes.set_xlabel("cost of the pick / cost of the cheapest found")
    axes.set_ylabel("share of the picks below, %")
    axes.legend(fontsize=8, loc="lower right")
