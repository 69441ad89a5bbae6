"""Words in the templates of motions: tables, sizes and limits of the step in C."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from cosserat_casadi.codegen.block_sources import Words, front_tables, part_functions, part_tables
from cosserat_casadi.codegen.blocks import Elimination
from cosserat_casadi.codegen.contact.moving import contact_reals, described_contact
from cosserat_casadi.codegen.motion_parts import MATRICES, MotionInC
from cosserat_casadi.codegen.names import Names
from cosserat_casadi.codegen.status import motion_status_words
from cosserat_casadi.compiling.c_tables import numbers, table
from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.displacement import displacements
from cosserat_casadi.motion.step_words import (
    MOST_STEP_ITERATIONS,
    MOST_STEP_PARTS,
    STAGES,
    STEP_TOLERANCE,
    limits_of_steps,
    words_of_method,
)
from cosserat_casadi.numerics.collocation import radau

MOTION_FILES = ("motion.h", "elimination.c", "stage_newton.c", "step.c", "step_sensitivity.c", "motion.c")
"""Files of the folder ``c`` that a library with motions includes."""


def motion_words(basics: Words, model: Model, names: Names, motion: MotionInC) -> Words:
    """Words of a library with motions."""
    fronts = motion.order.by_fronts
    whole = motion.blocks.as_a_whole
    parteds = {
        "motion_residual": motion.residual,
        "motion_matrix": motion.matrices,
        "motion_input": motion.input_matrices,
    }
    # Displacements are measured by the scene's own numbers, whatever the parameters are.
    lengths = np.where(model.discrete.unknowns.differential, displacements(model.at()), 0.0)
    words = {
        "in_motion": True,
        **limits_of_steps(),
        **words_of_method(),
        **motion_status_words(names, may_lie_apart=basics["apart"]),
        "stage_entries": motion.blocks.pattern.nnz(),
        "stage_matrix": max(fronts.size, whole.size),
        "front_room": max(sum(front.order for front in fronts.fronts), model.size),
        "interface_room": max(len(fronts.interface), 1),
        "most_motion_entries": max(len(part.entries) for parted in parteds.values() for part in parted.parts),
        "displacements": numbers(lengths.tolist()),
        "units": numbers(model.discrete.unknowns.units.tolist()),
        "motion_part_functions": "".join(part_functions(parted) for parted in parteds.values()),
        "motion_part_tables": "".join(part_tables("motion_part", word, parted) for word, parted in parteds.items()),
        "entry_tables": _entry_tables(motion) + _acceleration_table(model),
        "elimination_tables": _elimination_tables(fronts, whole),
    }
    return {
        **words,
        "load_room": max(len(model.scene.loads), 1),
        "motion_reals": _workspace_reals(model, motion, {**basics, **words}),
        "motion_integers": 3 * model.size + 1,
    }


def motion_entry(model: Model) -> dict[str, Any]:
    """Entry of the manifest on motions.

    Returns:
        the method and its tolerance, the unknowns with rates and accelerations, and the energies, J, by which entries
        of the residual are multiplied.
    """
    unknowns = model.discrete.unknowns
    return {
        "method": radau(STAGES).name,
        "order": radau(STAGES).order,
        "tolerance": STEP_TOLERANCE,
        "differential": [bool(flag) for flag in unknowns.differential],
        "residual_units": unknowns.units.tolist(),
        **described_contact(model),
    }


def _workspace_reals(model: Model, motion: MotionInC, words: Words) -> int:
    """Size of the workspace for motions, in numbers."""
    size, room = model.size, words["input_room"]
    entries = words["stage_entries"] * (2 * len(MATRICES) + 4) + words["most_motion_entries"]
    matrices = 4 * words["stage_matrix"] + 4 * size**2 + 12 * size * room
    vectors = 12 * size + 8 * room + 4 * size + 10 * size
    remembered = 2 * size * (2 * MOST_STEP_ITERATIONS + MOST_STEP_PARTS)
    rooms = 8 * (words["front_room"] + words["interface_room"] + 2 * size)
    return int(entries + matrices + vectors + remembered + rooms + contact_reals(size, room, words))


def _entry_tables(motion: MotionInC) -> str:
    rows, columns = motion.blocks.pattern.get_triplet()
    starts = motion.blocks.pattern.colind()
    tables = {"ENTRY_ROWS": rows, "ENTRY_COLUMNS": columns, "ENTRY_STARTS": starts}
    return "".join(table(name, list(values)) for name, values in tables.items())


def _acceleration_table(model: Model) -> str:
    """Write the table of inputs, then parameters, whose accelerations enter the equations of motion."""
    function = model.inverse_dynamics
    felt = np.zeros(max(model.inputs.size + model.parameters.size, 1), dtype=int)
    felt[function.jac_sparsity(0, function.index_in("inputs_acceleration")).get_col()] = 1
    return table("FEELS_ACCELERATION", felt.tolist())


def _elimination_tables(fronts: Elimination, whole: Elimination) -> str:
    """Write the tables of both orders of elimination; a scene with one front has only one order."""
    if len(fronts.fronts) == 1:
        return _elimination("WHOLE", ["BY_FRONTS", "AS_A_WHOLE"], whole)
    return _elimination("FRONT", ["BY_FRONTS"], fronts) + _elimination("WHOLE", ["AS_A_WHOLE"], whole)


def _elimination(stem: str, names: Sequence[str], order: Elimination) -> str:
    """Write the tables of an order of elimination, and records with these names."""
    of_fronts, listed = front_tables(order.fronts, f"{stem}_")
    lines = [of_fronts]
    of_entries = {"FRONTS": order.entry_fronts, "ROWS": order.entry_rows, "COLUMNS": order.entry_columns}
    lines += [table(f"{stem}_ENTRY_{word}", values) for word, values in of_entries.items()]
    lines.append(table(f"{stem}_INTERFACE", order.interface))
    lines.append(f"static const stage_front {stem}_FRONTS[] = {{\n{listed},\n}};\n")
    interface = f"{stem}_INTERFACE" if order.interface else "0"
    entries = ", ".join(f"{stem}_ENTRY_{word}" for word in of_entries)
    counts = f"{len(order.fronts)}, {len(order.interface)}, {order.interface_start}"
    record = f"{{{stem}_FRONTS, {interface}, {entries}, {counts}}}"
    lines += [f"static const elimination {name} = {record};\n" for name in names]
    return "".join(lines)
