"""What discretisations of random scenes cost once compiled, and the laws of accuracy/cost.py fitted to them.

Rows go to build/dial/compiled.csv one by one: the same command goes on where it was stopped. The laws are printed as
they are fitted to all rows, with how far those of accuracy/cost.py are from the rows; `--write` puts that into
docs/accuracy.md. A fit to nine tenths of the rows is held against the other tenth, ten times.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from doc_tables import put, table
from random_rods import ROD, scene_at
from rich.progress import Progress
from rows import append, read
from scipy.optimize import nnls

from cosserat_casadi import build
from cosserat_casadi.accuracy.cost import (
    MOST_IN_COLUMNS,
    PLANAR,
    Operations,
    Terms,
    foreseen_statements,
    spread_on,
    terms_of,
    time_in_columns,
)
from cosserat_casadi.accuracy.refine import solve_rods
from cosserat_casadi.codegen.columns import in_columns, on_path
from cosserat_casadi.codegen.timed_program import Program, Times
from cosserat_casadi.compiling.compiler import find_compiler
from cosserat_casadi.compiling.scalars_in_c import columns_in_fours
from cosserat_casadi.maths.calls import with_dense_results
from cosserat_casadi.model.build import Model
from cosserat_casadi.rod.discretisation import Discretisation

FILE = Path(__file__).parents[1] / "build" / "dial" / "compiled.csv"
PAGE = Path(__file__).parents[1] / "docs" / "accuracy.md"
BEGIN, END = "<!-- cost: written by benchmarks/compiled_cost.py -->", "<!-- end of cost -->"

FIRST = 3000
"""Seed of the first scene; none of those that judge the dial."""

CHOICES = (1e-3, 1e-5, 1e-7, 1e-9)
INTEGRATORS = ((None, 1.0), ("magnus4", 1.4), ("magnus8", 0.8))
"""Integrators in turn, that of the pick first, with the share of its intervals."""

METHODS = (PLANAR, "magnus4", "magnus6", "magnus8")
PARTS = 10
"""Parts of the rows, each of which is foreseen once from the others."""


@dataclass(frozen=True)
class Compiled:
    """A discretisation, counted, compiled and timed; times in µs.

    Attributes:
        seed: of the scene.
        tolerance: that it was picked for.
        strains: numbers of the admitted strains.
        modes: of each of them.
        elements: that the rod has.
        nodes: intervals of an element.
        transport: method of the rotations.
        method: as :class:`~cosserat_casadi.accuracy.cost.Terms` has it, as all down to the couple.
        groups: as there.
        intervals: as there.
        turns: as there.
        integrals: as there.
        entries: as there.
        of_intervals: operations foreseen, as all down to the couple.
        structure: as there.
        follower: as there.
        couple: as there.
        operations: counted in the model's residual and Jacobian.
        statements: of the Jacobian by columns in C; -1 where it has no such form.
        residual_jacobian: time of both.
        igm: of the inverse geometric model.
        warm: of a solve from the equilibrium of other inputs.
        cold: of a solve from the unloaded rod.
    """

    seed: int
    tolerance: float
    strains: str
    modes: str
    elements: int
    nodes: int
    transport: str
    method: str
    groups: int
    intervals: float
    turns: float
    integrals: float
    entries: float
    of_intervals: float
    structure: float
    follower: float
    couple: float
    operations: float
    statements: int
    residual_jacobian: float
    igm: float
    warm: float
    cold: float


def compiled(model: Model, seed: int, tolerance: float) -> Compiled | None:
    """None where the program does not converge."""
    d, rod = model.discretisation[ROD], model.discrete.rods[ROD].properties
    program = Program(model, find_compiler())
    statements = statements_of(model)
    program.wait()
    times = program.times()
    program.close()
    if not isinstance(times, Times):
        return None
    terms = terms_of(rod, d, spread_on(model.scene, ROD))
    foreseen = terms.operations
    return Compiled(
        seed, tolerance, "".join(map(str, rod.admitted)), " ".join(map(str, d.modes)), d.elements, d.nodes, d.transport,
        terms.method, terms.groups, terms.intervals, terms.turns, terms.integrals, terms.entries,
        foreseen.intervals, foreseen.structure, foreseen.follower, foreseen.couple,
        model.operations(model.jacobian), statements,
        times.jacobian, times.igm, times.warm, times.cold,
    )  # fmt: skip


def statements_of(model: Model) -> int:
    """Statements of the Jacobian by columns, however long it is; -1 where it has no such form."""
    form = in_columns(on_path(model), "jacobian")
    if form is None:
        return -1
    return columns_in_fours(form, with_dense_results(model.path_jacobian, "jacobian")).n_instructions()


def sample(seed: int) -> Compiled | None:
    """The scene's pick at one of the tolerances, or the same with another integrator."""
    tolerance = CHOICES[seed % len(CHOICES)]
    solution = solve_rods(scene_at(seed, tolerance))
    if not solution.converged:
        return None
    picked = solution.model.discretisation[ROD]
    return compiled(build(solution.model.scene, {ROD: varied(picked, seed)}), seed, tolerance)


def varied(picked: Discretisation, seed: int) -> Discretisation:
    transport, share = INTEGRATORS[seed // len(CHOICES) % len(INTEGRATORS)]
    nodes = max(2, round(share * picked.nodes))
    return replace(picked, nodes=nodes, transport=transport or picked.transport)


# The laws


@dataclass(frozen=True)
class Row:
    """A compiled discretisation as the laws see it."""

    terms: Terms
    statements: float
    time: float

    @property
    def in_columns(self) -> bool:
        """Whether the compiled Jacobian was by columns."""
        return 0 < self.statements <= MOST_IN_COLUMNS


def row_of(row: dict[str, str]) -> Row:
    numbers = {name: float(row[name]) for name in ("intervals", "turns", "integrals", "entries")}
    operations = Operations(*(float(row[name]) for name in ("of_intervals", "structure", "follower", "couple")))
    terms = Terms(method=row["method"], groups=int(row["groups"]), operations=operations, **numbers)
    return Row(terms, float(row["statements"]), float(row["residual_jacobian"]))


def affine(terms: Terms, groups: int) -> dict[str, float]:
    """What the factors of an affine law belong to where the code of columns runs for so many groups."""
    by_method = {method: terms.intervals if terms.method == method else 0.0 for method in METHODS}
    return {
        "constant": 1.0, **by_method, "in columns": groups * terms.intervals, "turns": groups * terms.turns,
        "integrals": groups * terms.integrals, "entries": terms.entries,
    }  # fmt: skip


def of_time(terms: Terms) -> dict[str, float]:
    """The same for times."""
    return affine(terms, terms.groups)


def of_statements(terms: Terms) -> dict[str, float]:
    """The same for statements, which are written once for all groups."""
    found = affine(terms, 1)
    # Intervals are counted by method already.
    del found["in columns"]
    return found


@dataclass(frozen=True)
class Law:
    """One of the laws, and what it is to foresee.

    Attributes:
        name: what it is of.
        terms: what its factors belong to.
        measured: what it is to foresee.
        foreseen: what accuracy/cost.py says.
        holds: whether it is of a row.
    """

    name: str
    terms: Callable[[Terms], dict[str, float]]
    measured: Callable[[Row], float]
    foreseen: Callable[[Terms], float]
    holds: Callable[[Row], bool]


LAWS = (
    Law(
        "statements of the Jacobian", of_statements,
        lambda row: row.statements, foreseen_statements, lambda row: row.statements > 0,
    ),
    Law("µs by columns", of_time, lambda row: row.time, time_in_columns, lambda row: row.in_columns),
)  # fmt: skip


def factors(terms: np.ndarray, measured: np.ndarray) -> np.ndarray:
    """Factors that are not negative, with the least squares of relative errors."""
    found: np.ndarray = nnls(terms / measured[:, None], np.ones(len(measured)))[0]
    # What is foreseen is compared: it is to be too large as often as too small.
    centre = float(np.exp(np.mean(np.log(measured / (terms @ found)))))
    return centre * found


def scatter(ratios: np.ndarray) -> tuple[float, float]:
    """Standard deviation and largest of factors."""
    logs = np.log(ratios)
    return float(np.exp(np.sqrt(np.mean(logs**2)))), float(np.exp(np.abs(logs).max()))


def held_out(terms: np.ndarray, measured: np.ndarray) -> np.ndarray:
    """Measured over foreseen, each row by a fit without its part."""
    ratios = np.empty(len(measured))
    part = np.arange(len(measured)) % PARTS
    for k in range(PARTS):
        outside = part != k
        ratios[~outside] = measured[~outside] / (terms[~outside] @ factors(terms[outside], measured[outside]))
    return ratios


def report(rows: list[Row]) -> list[tuple[str, ...]]:
    """Print the fitted factors; a line of the table for each law."""
    lines: list[tuple[str, ...]] = []
    for law in LAWS:
        chosen = [row for row in rows if law.holds(row)]
        measured = np.array([law.measured(row) for row in chosen])
        named = [law.terms(row.terms) for row in chosen]
        terms = np.array([list(entry.values()) for entry in named])
        fitted = factors(terms, measured)
        words = ", ".join(f"{name} {value:.3g}" for name, value in zip(named[0], fitted, strict=True))
        print(f"{law.name}: {words}")
        foreseen = np.array([law.foreseen(row.terms) for row in chosen])
        of_law, worst = scatter(measured / foreseen)
        outside, worst_outside = scatter(held_out(terms, measured))
        lines.append((
            law.name, str(len(chosen)), f"{measured.min():.3g} … {measured.max():.3g}", f"{of_law:.2f}", f"{worst:.2f}",
            f"{outside:.2f}", f"{worst_outside:.2f}",
        ))  # fmt: skip
    return lines


HEADINGS = (
    "law", "discretisations", "measured", "× or ÷", "at worst", "× or ÷, held out", "at worst",
)  # fmt: skip


def sides(rows: list[Row]) -> str:
    """How often the law is on the wrong side of the limit of code by columns."""
    written = [row for row in rows if row.statements > 0]
    wrong = [row for row in written if (foreseen_statements(row.terms) <= MOST_IN_COLUMNS) != row.in_columns]
    limit = f"{MOST_IN_COLUMNS:,}".replace(",", " ")
    return (
        f"The law puts {len(wrong)} of {len(written)} discretisations on the wrong side of {limit} statements, the "
        "limit of code by columns."
    )


def main(
    samples: Annotated[int, typer.Option(help="Discretisations.")] = 120,
    write: Annotated[bool, typer.Option("--write", help="Put the table into docs/accuracy.md.")] = False,
) -> None:
    """Compile what is missing; print the laws and how far they are off."""
    done = {int(row["seed"]) for row in read(FILE)}
    with Progress(transient=True) as bar:
        for seed in bar.track(range(FIRST, FIRST + samples), description="compiling"):
            row = None if seed in done else sample(seed)
            if row is not None:
                append(FILE, [row])
    rows = [row_of(row) for row in read(FILE)]
    text = f"{table(HEADINGS, report(rows))}\n\n{sides(rows)}"
    print(text)
    if write:
        put(PAGE, BEGIN, END, text)


if __name__ == "__main__":
    typer.run(main)
