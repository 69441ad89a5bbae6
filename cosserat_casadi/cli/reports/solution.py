"""The reports of ``solve`` and ``inverse``."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from cosserat_casadi.cli.reports.format import print_outcome, print_written, table_of
from cosserat_casadi.cli.reports.model import error_words, notes_on_planes
from cosserat_casadi.equilibrium.solution import Equilibrium, Solution
from cosserat_casadi.model.registry import EFFECTS
from cosserat_casadi.results.facts import digits
from cosserat_casadi.spelling import counted

# Only for annotations: printing a solution needs no inverse solver.
if TYPE_CHECKING:
    from cosserat_casadi.control.inverse_result import Inverse

STABILITY = {True: "stable", False: "unstable", None: "stability: no potential, not judged"}


def print_solution(console: Console, solution: Solution, written: Sequence[Path]) -> None:
    """Print the outcome, the rods, bodies and actuators, the figures of merit, and the files that were written."""
    _print_end(console, solution)
    _print_equilibrium(console, solution, counted(solution.iterations, "iteration"), written)


def _print_end(console: Console, solution: Equilibrium[Any], *, missed: bool = False) -> None:
    """Print title and message; doubtful are unstable equilibria, errors above the tolerance, and missed targets."""
    doubtful = missed or solution.stable is False or solution.within_tolerance is False
    print_outcome(console, solution.model.scene.title, solution.message, good=solution.converged, doubtful=doubtful)


def _print_equilibrium(console: Console, solution: Solution, work: str, written: Sequence[Path]) -> None:
    """Print rods, actuators and contacts, figures of merit with the work, and files."""
    console.print(_rod_table(solution))
    if solution.model.scene.actuators:
        console.print(_actuator_table(solution))
    if solution.model.joint:
        console.print(_joint_table(solution))
    if solution.model.scene.has_contact:
        console.print(_contact_table(solution))
    console.print(_merit_sentence(solution, work))
    for note in notes_on_planes(solution.model):
        console.print(f"Note: {note}")
    print_written(console, written)


def print_inverse(console: Console, inverse: Inverse, written: Sequence[Path]) -> None:
    """Print the outcome, the inputs found, the gaps to the targets, and the equilibrium."""
    _print_end(console, inverse.solution, missed=not inverse.met)
    inputs = table_of("input", "value found")
    for name, value in inverse.values.items():
        stacked = np.ravel(value, order="F")
        inputs.add_row(escape(name), ", ".join(digits(stacked)))
    console.print(inputs)

    targets = table_of("target", "position missed by, m", "angle missed by, rad")
    for gap in inverse.gaps:
        angle = "free" if gap.angle is None else _with_error(gap.angle, gap.angle_error)
        targets.add_row(escape(gap.what), _with_error(gap.position, gap.position_error), angle)
    console.print(targets)
    if any(gap.position_error is not None for gap in inverse.gaps):
        console.print("± is the estimated error of the model that the gap was measured on.")
    # The work is that of the optimiser: the final solve starts at its equilibrium and takes next to nothing.
    work = f"{counted(inverse.rounds, 'round')} of the optimiser from {counted(inverse.starts, 'start')}"
    if isinstance(inverse.solution, Solution):
        _print_equilibrium(console, inverse.solution, work, written)
        return
    # Imported here, because no scene of rods needs the modules of tubes.
    from cosserat_casadi.cli.reports.tubes import print_tubes_and_merit

    print_tubes_and_merit(console, inverse.solution)
    console.print(work)
    print_written(console, written)


def _with_error(gap: float, error: float | None) -> str:
    """A gap with the estimated error of the model."""
    return f"{gap:.3g}" if error is None else f"{gap:.3g} ± {error:.1g}"


def _rod_table(solution: Solution) -> Table:
    """Tips and clamps of rods, poses of bodies, in world axes."""
    table = table_of("rod", "quantity", right="xyz")
    longest = max(rod.length for rod in solution.model.discrete.rods.values())
    for name, rod in solution.model.discrete.rods.items():
        tip = solution.tip(name)
        base_wrench = solution.base_wrench(name)
        end = "clamp" if solution.model.discrete.unloaded.floating_base(name) is None else "base"
        moment, force = rod.energy_unit, rod.energy_unit / rod.length
        table.add_row(escape(name), "tip position, m", *digits(tip.position, longest))
        table.add_row("", "tip tangent", *digits(tip.rotation[:, 2], 1.0))
        table.add_row("", f"{end} force, N", *digits(base_wrench.force, force))
        table.add_row("", f"{end} moment, N m", *digits(base_wrench.moment, moment), end_section=True)
    for body in solution.model.scene.listed_bodies:
        pose = solution.body(body.name)
        table.add_row(escape(body.name), "body position, m", *digits(pose.position, longest))
        table.add_row("", "body z axis", *digits(pose.rotation[:, 2], 1.0), end_section=True)
    return table


def _contact_table(solution: Solution) -> Table:
    """Table of contacts of rods with obstacles, with resultants on the rod in world axes; one row without contact."""
    table = table_of("obstacle or rod", "on", "contact", right=[f"force {axis}, N" for axis in "xyz"])
    for contact in solution.contacts:
        where = f"at X = {contact.start:.6g}"
        if contact.of_body:
            where = "body"
        elif contact.on_rods is not None:
            where = "at X = {1:.6g} and {0:.6g}".format(*contact.on_rods)
        elif contact.start < contact.end:
            where = f"X = {contact.start:.6g} to {contact.end:.6g}"
        if contact.width is not None:
            where += f", smooth: gap {contact.gap:.3g} m of width {contact.width:.3g} m"
        table.add_row(escape(contact.obstacle), escape(contact.owner), where, *digits(contact.force))
    if not solution.contacts:
        table.add_row("none touched", "", "", "", "", "")
    return table


def _actuator_table(solution: Solution) -> Table:
    table = table_of("actuator", "effort", "works on")
    for actuator in solution.model.scene.actuators:
        member = EFFECTS[actuator.kind]
        units = {member.effort: member.effort_unit, member.conjugate: member.conjugate_unit}
        state = solution.actuator(actuator.name)
        cells = [f"{quantity} {value:.6g} {units[quantity]}" for quantity, value in state.items()]
        table.add_row(escape(actuator.name), *cells)
    return table


def _joint_table(solution: Solution) -> Table:
    """Table of efforts and angles or displacements of joints, and efforts of stops, which are parts of the efforts."""
    states = {name: solution.joint(name) for name in solution.model.joint}
    stops = ["of stops"] if any("stop" in state for state in states.values()) else []
    table = table_of("joint", "effort", "at", *stops)
    rods = solution.model.discrete.rods.values()
    energy, length = max(rod.energy_unit for rod in rods), max(rod.length for rod in rods)
    units = {"moment": "N m", "angle": "rad", "displacement": "m", "force": "N"}
    sizes = {"moment": energy, "angle": 1.0, "displacement": length, "force": energy / length}
    for name, state in states.items():
        effort = "moment" if "moment" in state else "force"
        cells = []
        for quantity, value in state.items():
            of = effort if quantity == "stop" else quantity
            (number,) = digits(np.array([value]), sizes[of])
            cells.append(f"{quantity} {number} {units[of]}")
        table.add_row(escape(name), *cells)
    return table


def _merit_sentence(solution: Solution, work: str) -> str:
    """Accuracy of the solution, the iterations of the solver, and the discretisation."""
    parts = [f"residual {solution.residual_norm:.1e}", work]
    parts += _errors(solution)
    parts += [escape(sentence) for sentence in solution.model.resolution_words]
    if solution.converged:
        parts.append(STABILITY[solution.stable])
    return "; ".join(parts)


def _errors(solution: Solution) -> Iterator[str]:
    """Estimated errors with markup, with the tolerance for the error that it binds."""
    accuracy = solution.model.scene.accuracy
    estimates = (("tip error", solution.error_estimate), ("error over the whole shape", solution.shape_error_estimate))
    for number, (what, error) in enumerate(estimates):
        if error is not None:
            within = solution.within_tolerance if number == accuracy.shape else None
            yield f"estimated {what} {error_words(error, within, accuracy.tolerance)}"
    if solution.wrench_error_estimate is not None:
        yield f"of clamps' forces and moments {solution.wrench_error_estimate:.1e}, relative"
    # Without contact a width has no effect.
    layer_error = solution.layer_error_estimate if solution.contacts else None
    if layer_error is not None:
        words = error_words(layer_error, None, accuracy.tolerance)
        yield f"estimated distance to contact without widths, which no tolerance binds: {words}"
