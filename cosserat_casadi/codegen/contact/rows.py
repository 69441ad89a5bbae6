"""C library of rods in exact contact that maps rows of inputs to rows of results, for sweeps."""

from __future__ import annotations

from cosserat_casadi.codegen.contact.arrangements import Chosen, chosen_arrangements
from cosserat_casadi.codegen.contact.checks import check_contact
from cosserat_casadi.codegen.contact.sources import contact_files
from cosserat_casadi.codegen.contact.tables import Tables
from cosserat_casadi.codegen.names import Names, scene_names
from cosserat_casadi.codegen.rows import CONTACT, JUDGED, NAME, POSE, RowLibrary, judged_words, row_results, to_compile
from cosserat_casadi.compiling.texts import render
from cosserat_casadi.equilibrium.contact.contact_state import without_contacts
from cosserat_casadi.equilibrium.contact.gaps import pairs, rod_pairs
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model


def contact_row_library(
    model: Model, load_cases: FloatArray, *, estimate_errors: bool, stability: bool = False
) -> RowLibrary:
    """Write sources of the solver of a scene in exact contact with a function for rows.

    Args:
        model: model on the discretisation of all rows.
        load_cases: stacked inputs with appended parameters, a row for each case, shape (k, m). The library contains the
            arrangements of contacts on the path from the scene's own inputs and parameters to each case with an
            equilibrium in turn.
        estimate_errors: whether rows have :data:`cosserat_casadi.codegen.rows.ERRORS`.
        stability: whether rows end with :data:`cosserat_casadi.codegen.rows.STABILITY`.

    Raises:
        ExportError: C does not support parts of the scene or its contacts; or the scene has no equilibrium.
    """
    check_contact(model.scene, {})
    columns = row_results(model.scene, estimate_errors=estimate_errors, stability=stability)
    asked = {"estimate_errors": estimate_errors, "stability": stability}
    chosen = chosen_arrangements(model, load_cases, **asked, leave_out=True)
    names = scene_names(NAME, without_contacts(model.scene))
    files = contact_files(model, chosen, names, None)
    files[f"{NAME}_rows.c"] = _rows_source(chosen, names, columns)
    return RowLibrary(to_compile(files), model.inputs.size, model.parameters.size, len(columns))


def _rows_source(chosen: Chosen, names: Names, columns: tuple[str, ...]) -> str:
    """Write the source of the function for rows."""
    rods = [rod.name for rod in chosen.scene.rods]
    # Contacts of bodies have no columns here.
    entries = [f"{{{owner}, {touched}}}" for owner, touched in Tables(chosen, names.name).pairs if owner < len(rods)]
    touching = [*((rod, obstacle.name) for rod, obstacle in pairs(chosen.scene)), *rod_pairs(chosen.scene)]
    first_pair = columns.index(f"{'.'.join(touching[0])}.{CONTACT[0]}")
    words = {
        "name": names.name,
        "MACRO": names.macro,
        "results": len(columns),
        "first_pose": len(JUDGED),
        "first_actuator": len(JUDGED) + len(POSE) * len(rods),
        "actuators": len(chosen.scene.actuators),
        "first_pair": first_pair,
        "of_pair": len(CONTACT),
        "pairs": len(entries),
        "pair_entries": ", ".join(entries),
        "rods_touch_rods": chosen.scene.rods_touch_exactly,
        "with_parameters": chosen.parameters.size > 0,
        **judged_words(columns),
    }
    return render("contact_rows.c.in", words)
