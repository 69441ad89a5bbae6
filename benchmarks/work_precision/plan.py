"""The plan of a bench: refused where it cannot be done, and carried out."""

from __future__ import annotations

import platform
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from rich.console import Console
from rich.markup import escape

from cosserat_casadi import scene as scenes
from cosserat_casadi.codegen.timed_program import FLAGS
from cosserat_casadi.compiling.compiler import find_compiler
from cosserat_casadi.errors import ExportError, Problem, SceneError
from cosserat_casadi.model.obstacle_checks import refuse_obstacles
from cosserat_casadi.model.tube_checks import refuse_tubes
from cosserat_casadi.plots.figure import figure_class
from work_precision.figure import write_figures
from work_precision.grid import DIAL, METHODS, QUICK, Candidate, candidates, distinct_methods, method_problems
from work_precision.measurement import Measurement
from work_precision.record import CSV, JSON, fingerprint, output_problems, read_rows, write_json, write_rows
from work_precision.session import Session, richer_candidates
from work_precision.table import print_bench, print_strains

Report = Callable[[str, int, int], None]
"""Told the work under way, how many points are done, and of how many (0: not known)."""


@dataclass
class Plan:
    """A bench that can be done.

    Attributes:
        scene: the scene.
        compiler: command of a C compiler.
        candidates: points to be measured, without the points that an earlier bench measured.
        output: folder for the files; None for none.
        rows: measurements, with the rows of an earlier bench.
    """

    scene: scenes.Scene
    compiler: str
    candidates: list[Candidate]
    output: Path | None
    rows: list[Measurement] = field(default_factory=list)


def make_plan(
    scene: scenes.Scene,
    output: Path | None,
    methods: str | None,
    points: int | None,
    quick: bool,
) -> Plan:
    """Check everything before any work; nothing is written.

    Args:
        scene: the scene.
        output: folder for the files.
        methods: names separated by commas; None for all, of a quick bench all but the literal system.
        points: most points for each method.
        quick: few points.

    Raises:
        SceneError: with every fault of the options, or of the table found in the folder; or the scene has obstacles
            or tubes.
        CosseratError: a figure is wanted, and matplotlib is missing.
    """
    refuse_tubes(scene)
    refuse_obstacles(scene, "a bench")
    # Every method solves the scene's own numbers.
    scene = scene.baked()
    names = _names(methods, quick)
    problems = method_problems(names, points)
    if output is not None:
        problems += output_problems(output)
    try:
        compiler = find_compiler()
    except ExportError as missing:
        problems.extend(missing.problems)
    if points is not None and quick:
        problems.append(Problem("--quick", "stands beside --points", "give one of the two"))
    if problems:
        raise SceneError(*problems)
    if output is not None:
        figure_class()
    rows = [] if output is None else read_rows(output, fingerprint(scene))
    points_per_method = QUICK if quick else points
    every = candidates(distinct_methods(scene, names), points_per_method)
    if not quick and DIAL in names:
        every += richer_candidates(scene)
    measured = {row.name for row in rows}
    remaining = [candidate for candidate in every if candidate.name not in measured]
    return Plan(scene, compiler, remaining, output, rows)


def run_plan(plan: Plan, console: Console, report: Report) -> bool:
    """Measure, show, write; whether the user stopped it.

    Raises:
        NoReferenceError: there is nothing to measure errors against.
    """
    session = Session.open(plan.scene, plan.compiler)
    interrupted = _measure(plan, session, report)
    for strain in {row.strain for row in plan.rows}:
        # Of rows that an earlier bench left too: their reference is shown below.
        session.problem(strain)
    report("Done", len(plan.candidates), len(plan.candidates))
    print_bench(console, plan.scene.title, session.reference, plan.rows)
    print_strains(console, session.model_distances)
    if plan.output is not None:
        _write(plan, session, plan.output, console, whole=not interrupted)
    return interrupted


def _names(methods: str | None, quick: bool) -> list[str]:
    """Names of the methods that are asked for."""
    if methods is not None:
        names = [name.strip() for name in methods.split(",")]
        return [name for name in names if name]
    if quick:
        # The literal system takes the compiler minutes.
        return [method for method in METHODS if method != "permuted"]
    return list(METHODS)


def _measure(plan: Plan, session: Session, report: Report) -> bool:
    """Point by point into rows and CSV, until done or stopped."""
    total = len(plan.candidates)
    report("Measuring", 0, total)
    if plan.output is not None:
        plan.output.mkdir(exist_ok=True)
    try:
        for done, row in enumerate(session.measure(plan.candidates), 1):
            plan.rows.append(row)
            if plan.output is not None:
                write_rows(plan.output, fingerprint(plan.scene), plan.rows)
            report(f"Measured {row.name}", done, total)
    except KeyboardInterrupt:
        return True
    return False


def _write(plan: Plan, session: Session, folder: Path, console: Console, whole: bool) -> None:
    """The files beside the CSV; of a bench that was stopped only the CSV stays."""
    written = [folder / CSV] if plan.rows else []
    if whole:
        facts = session.facts()
        facts["compiler_flags"] = " ".join(FLAGS)
        facts["machine"] = platform.machine()
        write_json(folder, plan.scene, plan.rows, facts)
        written.append(folder / JSON)
        written += write_figures(folder, plan.scene.title, session.reference, plan.rows)
    else:
        console.print("Stopped. Run the same command again to go on from here.", highlight=False)
    for path in written:
        console.print(f"wrote {escape(str(path))}", highlight=False)
