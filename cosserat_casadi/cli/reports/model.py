"""The reports of ``check``, ``export`` and ``tune``, and errors and discretisations for all reports."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import chain
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from cosserat_casadi.accuracy.choose import Choice
from cosserat_casadi.accuracy.ranges import CaseRanges
from cosserat_casadi.cli.reports.format import table_of, title_line
from cosserat_casadi.constraints.joints import JOINT_KINDS
from cosserat_casadi.constraints.tip_holder import place_of
from cosserat_casadi.equilibrium.contact.contact_state import without_contacts
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.maths.pose_change import rotation_vectors
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.inputs import input_layout
from cosserat_casadi.model.operation_cost import Price
from cosserat_casadi.model.operations import Count
from cosserat_casadi.results.facts import told_error
from cosserat_casadi.rod.properties import STRAINS
from cosserat_casadi.scene.varying import VaryingValue
from cosserat_casadi.spelling import counted

IDENTITY_TURN = (1.0, 0.0, 0.0, 0.0)
"""Orientation of a joint without one in the scene."""

TURNED = 1e-6
"""Largest angle between equal orientations, rad."""


def error_words(error: float, within: bool | None, tolerance: float | None) -> str:
    """An estimated error with markup, bold above the tolerance; arguments of :func:`told_error`."""
    words = told_error(error, within, tolerance)
    return f"[bold yellow]{words}[/]" if within is False else words


def discretisation_table(model: Model) -> Table:
    """Strains, modes, intervals, elements and integrator of every rod."""
    table = table_of("rod", "strains", "modes", "intervals", "elements", "rotation by")
    for name, d in model.discretisation.items():
        properties = model.discrete.rods[name].properties
        strains = ", ".join(STRAINS[index] for index in properties.admitted)
        modes = ", ".join(str(count) for count in d.modes)
        table.add_row(escape(name), strains, modes, str(d.nodes), str(d.elements), d.transport)
    return table


def print_check(
    console: Console,
    model: Model,
    varying: Sequence[VaryingValue],
    cost: Price,
    of_effects: Mapping[str, Count],
) -> None:
    """Print the contents of a valid scene, quantities that vary along the rods, and costs of its model.

    Args:
        console: where to print.
        model: the model of the scene.
        varying: values that vary along a rod.
        cost: operations of the model's functions.
        of_effects: operations that each load, actuator and obstacle with a width adds to the residual, by name.
    """
    scene = model.scene
    console.print(f"{title_line(scene.title)}: the scene is valid.")
    console.print(discretisation_table(model))
    if scene.causes or scene.obstacles or scene.rod_contacts:
        console.print(_load_table(model, of_effects))
    _print_varying(console, varying)
    _print_parameters(console, model)
    if scene.supports:
        console.print("Supports: " + ", ".join(f"{s.kind} tip of {s.rod}" for s in scene.supports))
    closing = [placed.what for placed in model.discrete.constraints if placed.closes_assembly]
    if closing:
        console.print("Ties: " + "; ".join(closing))
    for note in chain(_notes_on_orientations(model), notes_on_planes(model)):
        console.print(f"Note: {note}")
    _print_price(console, model, cost)
    if scene.accuracy.chosen_for:
        console.print("Modes and nodes were chosen for " + ", ".join(map(escape, scene.accuracy.chosen_for)))
    if scene.accuracy.modes is None:
        console.print(
            f"The solve picks modes and nodes for a tolerance of {scene.accuracy.tolerance:g}; "
            "the figures are for the default ones.",
        )
    if scene.touches_exactly:
        console.print("The figures are those of the free rods: where they touch obstacles, contact costs more.")


def _notes_on_orientations(model: Model) -> Iterator[str]:
    """Sentences on joints to the world without orientation that rotate a section to the world axes."""
    unloaded = model.discrete.unloaded
    for number, joint in enumerate(model.scene.joints):
        if joint.body is not None or joint.carries is not None or joint.at == 0.0:
            continue
        turn = rotation_vectors(place_of(joint).quaternion, unloaded.section(joint.rod, joint.at).quaternion)
        held = JOINT_KINDS[joint.kind].directions(joint).rotations
        if tuple(joint.quaternion) == IDENTITY_TURN and np.linalg.norm(held.T @ turn) > TURNED:
            yield (
                f"joints[{number}] turns {escape(joint.rod)} at X = {joint.at:g} to the axes of the world; "
                "a quaternion or tangent of the joint says otherwise."
            )


def notes_on_planes(model: Model) -> Iterator[str]:
    """Sentences on joints that close a loop and hold only directions in its plane."""
    joints = {f"joints[{i}]": joint for i, joint in enumerate(model.scene.joints)}
    for placed in model.discrete.constraints:
        joint = joints.get(placed.where)
        if joint is None or not placed.closes_assembly:
            continue
        if placed.constraint.size < JOINT_KINDS[joint.kind].directions(joint).size:
            name = joint.name or placed.where
            yield (
                f"{name} closes a loop in a plane and holds nothing across the plane: base_wrench has all loads "
                "across the plane at the base of the rod, however its joints share them."
            )


def print_export(console: Console, solution: Solution, folder: Path) -> None:
    """Print the files, their accuracy, and how to try them."""
    model = solution.model
    # Contact forces are inputs of the solved model, not of the library.
    inputs = input_layout(without_contacts(model.scene)).size
    estimate = "not known"
    if solution.error_estimate is not None:
        estimate = error_words(solution.error_estimate, None, model.scene.accuracy.tolerance)
    console.print(title_line(model.scene.title))
    console.print(discretisation_table(model))
    console.print(
        f"{counted(model.size, 'unknown')}, {counted(inputs, 'input')}; estimated error of the tip pose at the scene's "
        f"own inputs: {estimate}.",
    )
    console.print(f"wrote {escape(str(folder))}; its README.md says how to compile and call it")


def print_choice(console: Console, choice: Choice) -> None:
    """Print the ranges of a discretisation's choice, and the point with the largest error."""
    tolerance = choice.scene.accuracy.tolerance
    failed = len(choice.without_equilibrium)
    if choice.met:
        cases = f"{choice.solves - failed} load cases"
        if failed:
            cases += " that have an equilibrium"
        console.print(f"[bold green]All {cases} are within {tolerance:g}.[/]")
    elif choice.within_tolerance is None:
        console.print("The scene fixes modes and asks for no tolerance.")
    else:
        console.print(f"[bold red]The tolerance {tolerance:g} is not met at every load case.[/]")
    print_ranges(console, choice.ranges)
    if failed:
        point = escape(_point(choice.without_equilibrium[0]))
        console.print(f"[bold yellow]No equilibrium was found at {counted(failed, 'load case')}[/], such as {point}")
    if choice.error_estimate is not None:
        error = error_words(choice.error_estimate, None, tolerance)
        # A scene without inputs has one case, which needs no name.
        case = f"Worst case: {_point(choice.worst)}: estimated" if choice.worst else "Estimated"
        console.print(f"{escape(case)} error {error}")


def print_missed(console: Console, *, fixed: bool) -> None:
    """Print that the files miss the tolerance, and the remedy.

    Args:
        console: console of standard error.
        fixed: whether the scene fixes modes, nodes or rotation.
    """
    remedy = "narrow the ranges, or ask for a larger tolerance"
    if fixed:
        remedy = "leave modes, nodes and rotation out of the scene, so that they are chosen"
    console.print(f"[bold red]The written scene does not keep the tolerance everywhere in the ranges:[/] {remedy}.")


def print_locking(console: Console, sentence: str) -> None:
    """Print the sentence on locking, if there is one."""
    if sentence:
        console.print(f"[bold red]{escape(sentence)}[/]")


def print_ranges(console: Console, ranges: CaseRanges) -> None:
    """Print the ranges for the choice of a discretisation, and the source of each."""
    table = table_of("range", "where it comes from")
    for line, origin in ranges.with_origins():
        table.add_row(escape(line), escape(origin.value))
    if table.row_count:
        console.print(table)


def _point(values: Mapping[str, FloatArray]) -> str:
    """Inputs and parameters in words."""
    # Inputs are columns, (3, k) with k Legendre coefficients; the components of a coefficient are printed in a row.
    return ", ".join(f"{name} = {value.T.squeeze().tolist()}" for name, value in values.items())


def _print_varying(console: Console, varying: Sequence[VaryingValue]) -> None:
    """Print base and tip values of fields along a rod, and the interpretation of each plain list."""
    if not varying:
        return
    table = table_of("along a rod", "given by", right=["at the base", "at the tip"], fold=["along a rod"])
    for value in varying:
        base, tip = value.profile.ends
        notation = value.profile.notation.value
        table.add_row(escape(value.key), notation, _with_unit(base, value.unit), _with_unit(tip, value.unit))
    console.print(table)
    for value in varying:
        if value.plain:
            read_as = f"the list of {escape(value.key)} was read as {value.profile.notation.value}"
            console.print(f"Note: {read_as}; {escape(value.profile.table)} says the same.")


def _print_parameters(console: Console, model: Model) -> None:
    """Print the parameters of the scene, arguments of its functions, with their values."""
    if not model.parameters.size:
        return
    headings = ("parameter", "value in the scene")
    table = table_of(*headings, fold=headings)
    for parameter in model.parameters.entries:
        # One component a row, (3, k) with k coefficients: a reader expects single numbers without brackets.
        value = parameter.default.squeeze()
        number = f"{value:.6g}" if not value.ndim else str(value.tolist())
        unit = "" if parameter.unit == "1" else f" {parameter.unit}"
        table.add_row(escape(parameter.name), escape(f"{number}{unit}"))
    console.print(table)


def _with_unit(number: float, unit: str) -> str:
    return f"{number:.6g}" if unit == "1" else f"{number:.6g} {unit}"


def _print_price(console: Console, model: Model, cost: Price) -> None:
    igm = f"IGM of all {len(model.igm)} rods" if len(model.igm) > 1 else "IGM"
    console.print(
        f"Model of {model.size} unknowns in scalar operations: {igm} {cost.igm}, residual {cost.residual}, "
        f"residual and Jacobian {cost.jacobian}.",
    )


def _load_table(model: Model, of_effects: Mapping[str, Count]) -> Table:
    table = table_of("load, actuator or contact", "kind", "free inputs", right=["adds to the residual"])
    for cause in model.scene.causes:
        prefix = f"{cause.name}."
        fields = [name.removeprefix(prefix) for name in model.inputs.names if name.startswith(prefix)]
        free_inputs = ", ".join(fields) or "none"
        table.add_row(escape(cause.name), cause.kind, free_inputs, f"{of_effects[cause.name]} operations")
    for obstacle in model.scene.obstacles:
        _add_contact(table, obstacle.name, obstacle.kind, of_effects[obstacle.name] if obstacle.is_smooth else None)
    for contact in model.scene.rod_contacts:
        _add_contact(table, contact.label, "contact of rods", None if contact.exact else of_effects[contact.label])
    return table


def _add_contact(table: Table, name: str, kind: str, cost: Count | None) -> None:
    """Add a row for an obstacle, or for contact of rods; without a cost the contact is exact."""
    if cost is None:
        table.add_row(escape(name), f"exact {kind}", "none", "in contact only")
    else:
        table.add_row(escape(name), f"smooth {kind}", "none", f"{cost} operations")
