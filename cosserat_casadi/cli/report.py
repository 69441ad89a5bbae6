"""What the command line shows a person: tables and sentences."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from cosserat_casadi.accuracy.tune import Tuning
from cosserat_casadi.control.inverse import Inverse
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.errors import ExportError, SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.inputs import InputLayout
from cosserat_casadi.model.price import price, price_of_load
from cosserat_casadi.paths.follow import EquilibriumPath
from cosserat_casadi.rod.properties import STRAINS
from cosserat_casadi.sweep.outcome_file import record_file
from cosserat_casadi.sweep.outcome_table import Sweep
from cosserat_casadi.sweep.run import Plan

ACTUATOR_UNITS = {"tension": "N", "length": "m", "pressure": "Pa", "volume": "m³"}


def print_solution(console: Console, solution: Solution, written: Sequence[Path]) -> None:
    """Outcome, table of rods, and the files that were written."""
    console.print(f"[bold]{escape(solution.model.scene.title or 'Untitled scene')}[/]", highlight=False)
    colour = {True: "yellow" if solution.stable is False else "green", False: "red"}[solution.converged]
    console.print(f"[bold {colour}]{escape(solution.message)}[/]", highlight=False)
    console.print(_rod_table(solution))
    if solution.model.scene.actuators:
        console.print(_actuator_table(solution))
    console.print(_figures(solution), highlight=False)
    for path in written:
        console.print(f"wrote {escape(str(path))}", highlight=False)


def print_inverse(console: Console, found: Inverse, written: Sequence[Path]) -> None:
    """The inputs found and how far the targets are missed, then the equilibrium like that of a solve."""
    table = Table()
    for heading in ("input", "value found"):
        table.add_column(heading)
    for name, value in found.values.items():
        table.add_row(escape(name), ", ".join(_digits(value.ravel(order="F"))))
    console.print(table)
    table = Table()
    for heading in ("target", "position missed by, m", "angle missed by, rad"):
        table.add_column(heading)
    for gap in found.gaps:
        table.add_row(escape(gap.what), f"{gap.position:.3g}", "free" if gap.angle is None else f"{gap.angle:.3g}")
    console.print(table)
    print_solution(console, found.solution, written)


def print_unstable(console: Console) -> None:
    """A warning, and what to do about it."""
    console.print(
        "[bold yellow]Warning:[/] this equilibrium is not stable: a real rod leaves it. "
        "Add --stable to find one that it keeps.",
        highlight=False,
        soft_wrap=True,
    )


def print_path(console: Console, path: EquilibriumPath, written: Sequence[Path]) -> None:
    """Outcome, table of events and of the end, and the files that were written."""
    console.print(f"[bold]{escape(path.model.scene.title or 'Untitled scene')}[/]", highlight=False)
    console.print(f"[bold {'green' if path.converged else 'red'}]{escape(path.message)}[/]", highlight=False)
    if len(path.factor):
        console.print(_path_table(path))
    parts = [f"{len(path.factor)} points", f"{len(path.events)} limit points and bifurcations"]
    if path.error_estimate is not None:
        parts.append(f"estimated error of events and end {path.error_estimate:.1e}")
    parts += [f"{name}: modes {list(d.modes)}, {d.nodes} intervals" for name, d in path.model.discretisation.items()]
    console.print(escape("; ".join(parts)), highlight=False)
    for file in written:
        console.print(f"wrote {escape(str(file))}", highlight=False)


def print_check(console: Console, model: Model) -> None:
    """What a valid scene holds, and what its model costs."""
    console.print(f"[bold]{escape(model.scene.title or 'Untitled scene')}[/]: the scene is valid.", highlight=False)
    console.print(_discretisation_table(model))
    if model.scene.causes:
        console.print(_load_table(model))
    if model.scene.supports:
        console.print("Supports: " + ", ".join(f"{s.kind} tip of {s.rod}" for s in model.scene.supports))
    if model.discrete.is_assembly:
        closing = [placed.what for placed in model.discrete.constraints if placed.closes_assembly]
        console.print("Ties: " + "; ".join(closing), highlight=False)
    with console.status("Counting operations"):
        cost = price(model)
    console.print(
        f"Model of {model.size} unknowns in scalar operations: IGM {cost.igm:,}, residual {cost.residual:,}, "
        f"residual and Jacobian {cost.jacobian:,}.",
        highlight=False,
    )
    if model.scene.accuracy.modes is None:
        console.print(
            f"The solve picks modes and nodes for a tolerance of {model.scene.accuracy.tolerance:g}; "
            "the figures are for the default ones.",
            highlight=False,
        )


def print_export(console: Console, solution: Solution, folder: Path) -> None:
    """What was written, at what accuracy, and how to try it."""
    model = solution.model
    console.print(f"[bold]{escape(model.scene.title or 'Untitled scene')}[/]", highlight=False)
    console.print(_discretisation_table(model))
    estimate = "not known" if solution.error_estimate is None else f"{solution.error_estimate:.1e}"
    console.print(
        f"{model.size} unknowns, {model.inputs.size} inputs; estimated error of the tip pose at the scene's own "
        f"inputs: {estimate}.",
        highlight=False,
    )
    console.print(f"wrote {escape(str(folder))}; its README.md says how to compile and call it", highlight=False)


def print_tuning(console: Console, tuning: Tuning, layout: InputLayout, cases: FloatArray) -> None:
    """The discretisation chosen, and the load case that is worst on it."""
    worst = tuning.solutions[tuning.worst]
    console.print(_discretisation_table(worst.model))
    failed = [s for s in tuning.solutions if not s.converged]
    tolerance = tuning.scene.accuracy.tolerance
    if failed:
        verdict = f"[bold red]{len(failed)} of {len(cases)} load cases did not converge.[/]"
    elif tuning.met:
        verdict = f"[bold green]All {len(cases)} load cases are within {tolerance:g}.[/]"
    else:
        verdict = f"[bold red]The tolerance {tolerance:g} is not met at every load case.[/]"
    console.print(verdict, highlight=False)
    values = ", ".join(
        f"{name} = {value.T.squeeze().tolist()}" for name, value in layout.unpack(cases[tuning.worst]).items()
    )
    said = worst.message if worst.error_estimate is None else f"estimated error {worst.error_estimate:.1e}"
    console.print(f"Worst case, number {tuning.worst + 1}: {escape(values)}: {said}", highlight=False)


def print_sweep(console: Console, sweep: Sweep, output: Path, plot: Path | None, *, finished: bool) -> None:
    """How the rows ended, on what they were computed, what a check of some of them gave, and the files."""
    record = sweep.record
    console.print(f"[bold]{escape(record['title'] or 'Untitled scene')}[/]", highlight=False)
    table = Table()
    for heading in ("outcome", "rows", "share"):
        table.add_column(heading, justify="left" if heading == "outcome" else "right")
    for word, count in sweep.counts.items():
        table.add_row(word, f"{count:,}", f"{count / len(sweep.outcomes):.1%}")
    console.print(table)
    console.print(_sweep_choice(record["chosen"], record["tolerance"]), highlight=False, soft_wrap=True)
    for sentence in _sweep_check(record["checked"], record["tolerance"]):
        console.print(sentence, highlight=False, soft_wrap=True)
    if finished:
        console.print(f"{escape(str(output))} holds this sweep already: nothing was computed", highlight=False)
    for file in [*([] if finished else [output, record_file(output)]), *([] if plot is None else [plot])]:
        console.print(f"wrote {escape(str(file))}", highlight=False, soft_wrap=True)


def print_stopped_sweep(console: Console, plan: Plan) -> None:
    """What a stopped sweep left."""
    part = plan.part
    if part is None or not part.exists():
        console.print("Stopped before any row was solved. Nothing was written.")
        return
    console.print(f"Stopped. What is done is kept in {escape(str(part))}: the same command goes on.", highlight=False)


def _sweep_choice(chosen: dict[str, Any], tolerance: float) -> str:
    given = chosen["discretisation"]
    if given is None:
        return "Modes, nodes and rotation are as the scene fixes them; what it leaves open has its default."
    words = f"Modes {given['modes']}, {given['nodes']} intervals, chosen on {_rows(len(chosen['rows']))}"
    if chosen["error_estimate"] is None:
        return f"{escape(words)}, [bold red]none of which has an equilibrium.[/]"
    some = "" if chosen["converged"] == len(chosen["rows"]) else f", {chosen['converged']} of which have an equilibrium"
    missed = "[bold red]more than[/]" if chosen["error_estimate"] > tolerance else "within"
    return f"{escape(words)}{some}: estimated error {chosen['error_estimate']:.1e}, {missed} {tolerance:g}."


def _sweep_check(checked: list[dict[str, Any]], tolerance: float) -> list[str]:
    """Sentences about the rows that were solved again."""
    if not checked:
        return []
    lost = [one["row"] + 1 for one in checked if one["difference"] is None]
    kept = [one for one in checked if one["difference"] is not None]
    off = [one["row"] + 1 for one in kept if one["difference"] > tolerance]
    unstable = [one["row"] + 1 for one in kept if one["stable"] is False]
    said = []
    if kept:
        error = max(np.inf if one["error_estimate"] is None else one["error_estimate"] for one in kept)
        apart = max(one["difference"] for one in kept)
        verdict = "within" if error <= tolerance else "[bold red]more than[/]"
        said.append(
            f"{_rows(len(kept))} solved again in Python: estimated error at most {error:.1e}, {verdict} {tolerance:g}; "
            f"poses differ by at most {apart:.1e}."
        )
    if lost:
        said.append(f"[bold red]Python found no equilibrium for {_listed(lost)}.[/]")
    if off:
        said.append(f"[bold red]Python found another equilibrium for {_listed(off)}.[/]")
    if unstable:
        said.append(
            f"[bold yellow]Unstable among these: {_listed(unstable)}.[/] A real rod leaves such an equilibrium. "
            "The stability of other rows is not judged."
        )
    return said


def _rows(count: int) -> str:
    return "1 row" if count == 1 else f"{count:,} rows"


def _listed(numbers: Sequence[int]) -> str:
    return f"row{'s' * (len(numbers) > 1)} {', '.join(map(str, numbers))}"


def print_refusal(console: Console, error: SceneError | ExportError) -> None:
    """Every reason for which an input is refused."""
    count = len(error.problems)
    console.print(f"[bold red]Refused:[/] {count} problem{'s' if count != 1 else ''}.", highlight=False)
    for problem in error.problems:
        console.print(f"  {escape(str(problem))}", highlight=False, soft_wrap=True)


def _rod_table(solution: Solution) -> Table:
    table = Table()
    for heading in ("rod", "quantity"):
        table.add_column(heading)
    for axis in ("x", "y", "z"):
        table.add_column(axis, justify="right")
    for name in solution.model.discrete.rods:
        tip, base = solution.tip(name), solution.base_wrench(name)
        table.add_row(escape(name), "tip position, m", *_digits(tip.position[0]))
        table.add_row("", "tip tangent", *_digits(tip.rotation[0][:, 2]))
        table.add_row("", "clamp force, N", *_digits(base.force))
        table.add_row("", "clamp moment, N m", *_digits(base.moment), end_section=True)
    for name in solution.model.body:
        pose = solution.body(name)
        table.add_row(escape(name), "body position, m", *_digits(pose.position[0]))
        table.add_row("", "body z axis", *_digits(pose.rotation[0][:, 2]), end_section=True)
    return table


def _actuator_table(solution: Solution) -> Table:
    table = Table()
    for heading in ("actuator", "effort", "works on"):
        table.add_column(heading)
    for actuator in solution.model.scene.actuators:
        state = solution.actuator(actuator.name)
        words = [f"{name} {value:.6g} {ACTUATOR_UNITS[name]}" for name, value in state.items()]
        table.add_row(escape(actuator.name), *words)
    return table


def _path_table(path: EquilibriumPath) -> Table:
    """The start, the events and the end of a path, with the stability of what follows."""
    table = Table()
    for heading in ("point", "factor", path.name, "beyond it", "rod", "position, m"):
        table.add_column(escape(heading), no_wrap=heading in ("point", "factor", "beyond it"))
    last = len(path.factor) - 1
    places = {name: (path.section(name), path.position(path.section(name), name)) for name in path.model.discrete.rods}
    rows = [("start", float(path.factor[0]), 0, [positions[0] for _, positions in places.values()])]
    for event in path.events:
        kind = event.kind if event.multiplicity == 1 else f"{event.kind}, {event.multiplicity}-fold"
        at = [path.event_position(event, X, name) for name, (X, _) in places.items()]
        rows.append((kind, event.factor, min(event.position, last), at))
    rows.append(("end", float(path.factor[-1]), last, [positions[-1] for _, positions in places.values()]))
    for kind, factor, beyond, at in rows:
        value = ", ".join(_digits(factor * np.ravel(path.value, order="F")))
        for i, ((name, (X, _)), position) in enumerate(zip(places.items(), at, strict=True)):
            words = (kind, f"{factor:.10g}", f"[{value}]", _stability(path, beyond)) if i == 0 else ("", "", "", "")
            place = f"{name} tip" if X == 1.0 else f"{name} X = {X:.3g}"
            table.add_row(*map(escape, words), escape(place), ", ".join(_digits(position)))
    return table


def _stability(path: EquilibriumPath, index: int) -> str:
    stable, neutral = path.stable, path.neutral
    if stable is None or neutral is None:
        return "not judged"
    return "neutral" if neutral[index] else "stable" if stable[index] else "unstable"


def _figures(solution: Solution) -> str:
    parts = [f"residual {solution.residual_norm:.1e}", f"{solution.iterations} iterations"]
    if solution.error_estimate is not None:
        parts.append(f"estimated tip error {solution.error_estimate:.1e} of the length")
    if solution.shape_error_estimate is not None:
        parts.append(f"over the whole shape {solution.shape_error_estimate:.1e}")
    for name, d in solution.model.discretisation.items():
        elements = f" in {d.elements} elements" if d.elements > 1 else ""
        parts.append(f"{name}: modes {list(d.modes)}, {d.nodes} intervals{elements}")
    stability = {True: "stable", False: "unstable", None: "stability: no potential, not judged"}
    if solution.converged:
        parts.append(stability[solution.stable])
    return escape("; ".join(parts))


def _discretisation_table(model: Model) -> Table:
    table = Table()
    for heading in ("rod", "strains", "modes", "intervals", "elements", "rotation by"):
        table.add_column(heading)
    for name, d in model.discretisation.items():
        strains = ", ".join(STRAINS[i] for i in model.discrete.rods[name].properties.admitted)
        modes, nodes = ", ".join(map(str, d.modes)), str(d.nodes)
        table.add_row(escape(name), strains, modes, nodes, str(d.elements), d.transport)
    return table


def _load_table(model: Model) -> Table:
    table = Table()
    for heading in ("load or actuator", "kind", "free inputs"):
        table.add_column(heading)
    table.add_column("adds to the residual", justify="right")
    for cause in model.scene.causes:
        free = [n.split(".")[1] for n in model.inputs.names if n.startswith(f"{cause.name}.")]
        cost = price_of_load(model.scene, cause.name)
        table.add_row(escape(cause.name), cause.kind, ", ".join(free) or "none", f"{cost:,} operations")
    return table


def _digits(vector: FloatArray) -> list[str]:
    """Six digits; what is zero beside the largest entry is shown as zero."""
    largest = float(np.abs(vector).max())
    return ["0" if abs(v) <= 1e-14 * max(largest, 1e-300) else f"{v:.6g}" for v in vector]
