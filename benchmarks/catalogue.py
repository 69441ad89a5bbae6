"""Figures and table of docs/hard-cases.md: every family of the catalogue beside its independent reference.

The same sources give the same bytes. `--only NAME` draws one figure and leaves the table.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from cosserat_casadi import EquilibriumPath, Solution, follow, solve  # noqa: E402
from cosserat_casadi.plots.figure import figure_class, write_figure  # noqa: E402
from tests.catalogue import cases  # noqa: E402
from tests.catalogue.checks import (  # noqa: E402
    column_eigenvalue,
    fine_model,
    initial_value_error,
    ring_eigenvalue,
    solved,
    zero_near,
)
from tests.pose_errors import distance_between, pose_error  # noqa: E402
from tests.reference.closed_forms import elastica, roll_up  # noqa: E402
from tests.reference.shooting import solve_by_shooting  # noqa: E402

FIGURES, DOCS = ROOT / "docs" / "figures", ROOT / "docs" / "hard-cases.md"
BEGIN, END = "<!-- catalogue: written by benchmarks/catalogue.py -->", "<!-- end of catalogue -->"
X = np.linspace(0, 1, 401)
BLUE, RED, GREEN, GREY = "#0055bb", "#cc3311", "#228833", "0.6"

Row = tuple[str, str, float]
"""A case, its reference, and the distance of the two."""


def shape(solution: Solution) -> Any:
    """Positions along the rod, (k, 3)."""
    return solution.pose(X).position


def panels(count: int, width: float = 3.4, height: float = 3.2) -> tuple[Any, list[Any]]:
    """A figure with panels side by side."""
    figure = figure_class()(figsize=(width * count, height), layout="constrained")
    axes = [figure.add_subplot(1, count, i + 1) for i in range(count)]
    for panel in axes:
        panel.grid(alpha=0.3)
    return figure, axes


def named(panel: Any, title: str, x: str = "x / L", y: str = "z / L", equal: bool = True) -> None:
    """Title, labels, scale."""
    panel.set_title(title, fontsize=9)
    panel.set_xlabel(x)
    panel.set_ylabel(y)
    if equal:
        panel.set_aspect("equal", adjustable="datalim")


# (a), (b)


def bending() -> tuple[Any, list[Row]]:
    figure, (dead, follower, rolled) = panels(3)
    rows: list[Row] = []
    for load in (1.0, 10.0, 100.0):
        found = solved(cases.table({}, cases.tip([load, 0, 0])))
        r = shape(found)
        dead.plot(r[:, 0], r[:, 2], label=f"{load:g}")
        shortening, across, _ = elastica(load)
        dead.plot(across, 1 - shortening, "k.", markersize=5)
        error = distance_between(found.tip().position, [across, 0, 1 - shortening])
    rows.append(("(a) elastica, F L²/EI = 100", "elliptic integrals", error))
    for load in (5.0, 20.0, 40.0):
        found = solved(cases.table({}, cases.tip([load, 0, 0], frame="body")))
        r, (across, along) = shape(found), cases.follower_cantilever(load)
        follower.plot(r[:, 0], r[:, 2], label=f"{load:g}")
        follower.plot(across, along, "k.", markersize=5)
        error = distance_between(found.tip().position, [across, 0, along])
    rows.append(("(a) follower force, F L²/EI = 40", "pendulum, DOP853", error))
    for turns in (0.5, 1, 2, 5):
        found = solved(cases.table(cases.round_rod(1.0), cases.tip(moment=[0, 2 * np.pi * turns, 0])))
        r = shape(found)
        rolled.plot(r[:, 0], r[:, 2], label=f"{turns:g}")
        error = distance_between(found.tip().position, roll_up(turns)[0])
    rows.append(("(b) roll-up into 5 circles", "closed form", error))
    titles = ("dead force, F L²/EI", "follower force, F L²/EI", "tip moment, turns")
    for panel, title in zip((dead, follower, rolled), titles, strict=True):
        named(panel, title)
        panel.legend(fontsize=8)
    return figure, rows


# (c)


def helix() -> tuple[Any, list[Row]]:
    full = solved(cases.helical_form(1.0), 1e-9)
    model, (ends, wound) = full.model, panels(2, 4.6)[1]
    shares, found, lifted = np.linspace(0, 1, 201) ** 1.3, None, [0.0]
    for share in shares[1:]:
        values = {"tip.force": [0, 50 * share, 0], "tip.moment": [0, 200 * np.pi * share, 0]}
        found = solve(model, values, start=found)
        assert found.converged, found.message
        lifted.append(float(found.tip().position[1]))
    assert found is not None
    ends.plot(shares, lifted, color=BLUE)
    named(ends, "tip along the force", "λ", "displacement, m", equal=False)
    r = full.pose(np.linspace(0, 1, 1501)).position
    wound.plot(r[:, 0], r[:, 1], color=BLUE, linewidth=0.8)
    named(wound, "the rod at λ = 1, seen along z", "x, m", "y, along the force, m")
    rows: list[Row] = [("(c) helical form, ten turns", "initial-value problem, DOP853", initial_value_error(full))]
    return ends.figure, rows


# (d)


def column() -> tuple[Any, list[Row]]:
    figure, (panel,) = panels(1, 5.4, 4.2)
    ratio, rows = 12.0, []
    model = fine_model(cases.table({}, cases.tip()), 16, 40)

    def path(branch: int, to: float = ratio) -> EquilibriumPath:
        return follow(model, "tip.force", [0, 0, -to * cases.EULER], branch=branch)

    for branch, colour in ((0, GREY), (1, BLUE), (-1, BLUE), (2, RED), (-2, RED)):
        found = path(branch)
        assert found.converged, found.message
        stable = found.stable
        assert stable is not None
        x, load, start = found.tip().position[:, 0], ratio * found.factor, found.branch or 0
        for kind, style in ((True, "-"), (False, "--")):
            part = np.where(stable[start:] == kind, x[start:], np.nan)
            panel.plot(part, load[start:], style, color=colour)
        if branch == 0:
            for event in found.events:
                panel.plot(0, ratio * event.factor, "D", color="0.1", markersize=5)
    for r in (1.02, 1.2, 1.5, 2, 3, 4.5, 6, 7.5, 9.1, 11):
        across = cases.column_tip(r)[0]
        panel.plot([across, -across], [r, r], "k.", markersize=5)
    near = path(1, 9.1)
    x, _, z = near.tip().position[-1]
    rows.append(("(d) Euler's load", "π² EI/4 L²", abs(9.1 * near.events[0].factor - 1)))
    distance = distance_between([abs(x), z], cases.column_tip(9.1))
    rows.append(("(d) buckled column at 9.1 P_c", "elliptic integrals", distance))
    named(panel, "clamped column: P / P_c over the tip's way", "x of the tip / L", "P / P_c", equal=False)
    return figure, rows


# (f), (g)


def held() -> tuple[Any, list[Row]]:
    figure, axes = panels(2, 4.2)
    rows: list[Row] = []
    for name in cases.HELD:
        found = solved(cases.held(name))
        r = shape(found)
        axes[0].plot(r[:, 0], r[:, 2], label=f"{name}{'' if found.stable else ' (unstable)'}")
        rows.append((f"(f) {name}", "initial-value problem, DOP853", initial_value_error(found)))
    named(axes[0], "rods clamped at both ends")
    for twist, colour in ((2.0, BLUE), (4.0, GREEN), (6.0, RED)):
        found = solved(cases.writhing_rod(twist))
        r = shape(found)
        axes[1].plot(r[:, 1], r[:, 2], color=colour, label=f"twist {twist:g}{'' if found.stable else ' (unstable)'}")
        error = initial_value_error(found)
    rows.append(("(g) writhing rod, twist 6", "initial-value problem, DOP853", error))
    named(axes[1], "twisted rods, ends at 0.85 L", "y / L")
    for panel in axes:
        panel.set(aspect="equal", xlim=(-0.55, 0.65), ylim=(-0.05, 1.05))
        panel.set_adjustable("box")
        panel.legend(fontsize=7, loc="upper left")
    return figure, rows


def twist() -> tuple[Any, list[Row]]:
    figure, (columns, ring) = panels(2, 4.2)
    rows: list[Row] = []
    stretches = np.linspace(-0.25, 0.3, 23)
    columns.plot(100 * stretches, [cases.critical_torque(100 * e, e) for e in stretches], color=GREY)
    for stretch in (-0.2, -0.1, 0.0, 0.1, 0.2):
        reference = cases.critical_torque(100 * stretch, stretch)
        found = zero_near(lambda M, e=stretch: column_eigenvalue(M / 2, e, 2.0), reference)
        columns.plot(100 * stretch, found, "k.")
        if stretch in (0.0, 0.2):
            name = f"(g) critical torque, tension {100 * stretch:g} EI/L²"
            rows.append(
                (name, "linear theory" if stretch else "tan(M/2) = M/2 (Greenhill)", abs(found / reference - 1))
            )
    named(columns, "torque at which a clamped rod buckles", "tension P L²/EI", "M L/EI", equal=False)
    critical = np.sqrt(3) * 2 * np.pi
    shares = np.linspace(0, 1.3, 14)
    ring.plot(shares, [ring_eigenvalue(share * critical, 1.0) for share in shares], ".-", color=BLUE)
    ring.axhline(0, color="0.3", linewidth=0.8)
    ring.axvline(1, color=GREY, linewidth=0.8)
    named(ring, "flat twisted ring", "twist / (√3 · 2π EI/GJ)", "smallest eigenvalue", equal=False)
    flips = zero_near(lambda t: ring_eigenvalue(t, 1.0), critical)
    rows.append(("(g) ring flips at the twist √3 · 2π EI/GJ", "Michell, Zajac", abs(flips / critical - 1)))
    return figure, rows


# (h)


def spring() -> tuple[Any, list[Row]]:
    figure, (lift, coils) = panels(2, 4.2, 3.8)
    rows: list[Row] = []
    model, found, forces = fine_model(cases.spring(0.0), 56, 140), None, np.linspace(-0.01, 0.02, 13)
    heights = []
    for force in forces:
        found = solve(model, {"tip.force": [0, 0, force], "tip.moment": [0, -force, 0]}, start=found)
        assert found.converged, found.message
        heights.append(float(found.tip().position[2]) - cases.TURNS * cases.PITCH)
        if force in (forces[0], forces[4], forces[-1]):
            r = found.pose(np.linspace(0, 1, 1501)).position
            coils.plot(r[:, 0] + 3 * len(coils.lines), r[:, 2], linewidth=0.8)
    lift.plot(forces, heights, color=BLUE, label="followed")
    lift.plot(forces, forces * cases.love_compliance(), "--", color=GREY, label="Love, small loads")
    lift.legend(fontsize=8)
    named(lift, "spring of ten turns", "F R²/EI", "lengthening / R", equal=False)
    named(coils, "pushed, unloaded, pulled", "x / R", "z / R")
    for force in (0.02, -0.01):
        strained = solve(fine_model(cases.spring(force), 56, 140))
        rows.append(
            (f"(h) spring, F R²/EI = {force:g}", "initial-value problem, DOP853", initial_value_error(strained))
        )
    return figure, rows


# (i), (j)


def extremes() -> list[Row]:
    scenes = {
        "(i) EA L²/EI = 1e10": cases.slender(1e10),
        "(i) slenderness L/d = 1e4": cases.wire(1e4),
        "(i) GJ/EI = 1e-3": cases.torsion_ratio(1e-3),
        "(i) GJ/EI = 1e3": cases.torsion_ratio(1e3),
        "(j) GA L²/EI = 1e-3": cases.shear_beam(1e-3),
    }
    rows: list[Row] = []
    for name, tables in scenes.items():
        found, oracle = solved(tables).tip(), solve_by_shooting(tables)
        true = (oracle.tip_position, oracle.tip_rotation)
        error = pose_error((found.position, found.rotation), true, tables["rods"][0]["length"])
        rows.append((name, "shooting, DOP853", error))
    return rows


# (k)


def order() -> tuple[Any, list[Row]]:
    figure, (condition, error) = panels(2, 4.2)
    sizes = [8, 12, 16, 24, 32, 48, 64, 96, 128, 192]
    pairs = [[np.linalg.cond(matrix) for matrix in cases.quaternion_matrices(2 * np.pi, N)] for N in sizes]
    for values, name, colour in zip(np.array(pairs).T, ("D − A", "1 − S A"), (RED, BLUE), strict=True):
        condition.loglog(sizes, values, ".-", color=colour, label=name)
    named(condition, "condition number, one turn", "intervals", "", equal=False)
    shortening, across, _ = elastica(10.0)
    errors, modes = [], [2, 4, 6, 8, 12, 16, 24, 32, 48, 64]
    for count in modes:
        found = solve(fine_model(cases.table({}, cases.tip([10.0, 0, 0])), count, 4 * count))
        errors.append(distance_between(found.tip().position, [across, 0, 1 - shortening]))
    error.semilogy(modes, np.maximum(errors, 1e-17), ".-", color=BLUE, label="tip, elastica at 10")
    named(error, "error as the order grows", "modes; four times as many intervals", "error / L", equal=False)
    for panel in (condition, error):
        panel.legend(fontsize=8)
    return figure, [("(k) 64 modes, 256 intervals", "elliptic integrals", errors[-1])]


FAMILIES: dict[str, Callable[[], tuple[Any, list[Row]]]] = {
    "bending": bending,
    "helix": helix,
    "column": column,
    "held": held,
    "twist": twist,
    "spring": spring,
    "order": order,
}


def table(rows: list[Row]) -> str:
    """Rounded up to one digit, so that rounding of another processor does not show."""
    lines = ["| case | reference | distance |", "|---|---|---|"]
    for case, reference, error in sorted(rows):
        digits = int(np.floor(np.log10(max(error, 1e-14))))
        lines.append(f"| {case} | {reference} | < 1e{digits + 1:d} |")
    return "\n".join(lines)


def main(only: Annotated[str | None, typer.Option(help=f"One of {', '.join(FAMILIES)}.")] = None) -> None:
    """Draw the figures, write the table."""
    FIGURES.mkdir(exist_ok=True)
    rows = [] if only else extremes()
    for name, family in FAMILIES.items():
        if only in (None, name):
            figure, found = family()
            write_figure(figure, FIGURES / f"{name}.png")
            rows += found
            print(name, *found, sep="\n  ", flush=True)
    if only is None:
        before, rest = DOCS.read_text().split(BEGIN)
        DOCS.write_text(f"{before}{BEGIN}\n{table(rows)}\n{END}{rest.split(END)[1]}")


if __name__ == "__main__":
    typer.run(main)
