"""A folder of C sources of a scene in exact contact: header, tables, solver, build file, README, manifest."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from cosserat_casadi.accuracy.verified import Verified
from cosserat_casadi.codegen.contact.arrangements import Chosen
from cosserat_casadi.codegen.contact.kernels import RICHER_WORDS, ArrangementKernels, distance_kernels, words_of
from cosserat_casadi.codegen.contact.tables import Tables, described
from cosserat_casadi.codegen.error_sources import BLINDNESS, blindness_words
from cosserat_casadi.codegen.kernel_files import derivative_source, kernel_sources
from cosserat_casadi.codegen.library import (
    ONE_BY_ONE,
    PLAIN_BUILD,
    SECOND_VARIATION,
    accuracy_words,
    batch_words,
    comment,
    input_words,
    rendered,
    title_words,
)
from cosserat_casadi.codegen.manifest import (
    ARRANGEMENTS,
    accuracy_entries,
    actuator_entries,
    head_entries,
    parameter_entries,
    with_manifest,
)
from cosserat_casadi.codegen.memory import largest_room
from cosserat_casadi.codegen.names import Names, identifier
from cosserat_casadi.codegen.parameter_sources import contact_parameter_words
from cosserat_casadi.codegen.stability import limits_of_stability
from cosserat_casadi.codegen.status import CONTACT_OUTCOMES, status_words
from cosserat_casadi.compiling.c_tables import numbers
from cosserat_casadi.equilibrium.contact import (
    contact_alternatives,
    contact_equations,
    contact_judgement,
    contact_search,
    contact_state,
    passing_through,
)
from cosserat_casadi.equilibrium.contact.contact_state import Touch, without_contacts
from cosserat_casadi.equilibrium.metrics import ROUNDING, SAFETY
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.discretise import with_discretisation
from cosserat_casadi.model.strain_margins import VANISHED
from cosserat_casadi.numerics import newton
from cosserat_casadi.scene.writing import scene_text

VERBATIM = (
    "contact.h",
    "square_systems.c",
    "contact_newton.c",
    "interpolation.c",
    "contact_shape.c",
    "contact_faults.c",
    "contact_settle.c",
    "contact.c",
)
"""Files of the folder ``c`` that the library's own source includes unchanged."""

TEMPLATES = ("contact.h.in", "contact_library.c.in", "contact_config.h.in", "contact_demo.c.in")
"""Templates of header, source, configuration and demo."""

ERROR_FILES = (BLINDNESS, "contact_error.c")
"""Further files of a library that estimates errors, which its own source includes, as they are."""

ROD_FILES = ("touching_rods.c",)
"""Further files of a library whose rods touch rods, which its own source includes, as they are."""

SAMPLES_OF_ROD = 128
"""Intervals between the sections of a rod that are looked at first beside another rod."""

STABILITY_FILES = ("contact_stability.c", SECOND_VARIATION)
"""Further files of a library that judges stability."""

MOST_TRIES = 24
"""Most arrangements that the solver tries for one change of the inputs."""

TRIES_EACH = 3
"""Most tries of each arrangement, from different places, if there are few arrangements."""

CANDIDATES = 24
"""Most sets of contacts that wait to be tried."""

TRACK_ITERATIONS, TRACK_PARTS = 400, 40
"""Default budget of a turn of a control loop: ordinary turns take a few, and 300 where two rods meet."""
SOLVE_ITERATIONS, SOLVE_PARTS = 1200, 400
"""Budget of a solve, and of a move of a slider of a page."""

LONGEST_WAY = 0.1
"""Largest displacement of a section in one part of the path of the inputs, over the length of its rod."""


def contact_files(
    model: Model,
    chosen: Chosen,
    names: Names,
    error_estimate: float | None,
    verified: Verified | None = None,
    *,
    derivatives: bool = False,
    batches: bool = False,
) -> dict[str, str]:
    """Write the text of every file of a folder, by name; the manifest, which lists these files, is last.

    Args:
        model: the exported model.
        chosen: arrangements of contacts of the library.
        names: names of the library and its parts.
        error_estimate: error of the tip pose at the scene's inputs, over the length.
        verified: ranges over which the discretisation keeps the tolerance; None if unknown.
        derivatives: whether the equations of each arrangement are also written with derivatives, for CasADi.
        batches: whether the folder has a function for many load cases.
    """
    kernels = distance_kernels(chosen, names.kernel("distance"))
    for number, own in enumerate(chosen.equations):
        kernels += ArrangementKernels(own, names.kernel(str(number)), words_of(chosen)).all()
    for number, own in enumerate(chosen.richer):
        kernels += ArrangementKernels(own, names.kernel(f"richer_{number}"), RICHER_WORDS).all()
    generated = kernel_sources(kernels, names)
    tables = Tables(chosen, names.name)
    described = {**_manifest(model, chosen, names), **accuracy_entries(chosen.scene, error_estimate, verified)}
    words = _words(chosen, names, tables, generated) | contact_parameter_words(model, names)
    if chosen.judges_stability:
        words |= _stability_words(model, tables)
    if batches:
        words |= _batch_words(model, names)
        described["batches"] = ONE_BY_ONE
    words["derivatives"] = derivatives
    words |= accuracy_words(chosen.scene, error_estimate, verified)
    further = (
        *(ERROR_FILES if chosen.richer else ()),
        *(STABILITY_FILES if chosen.judges_stability else ()),
        *(ROD_FILES if chosen.scene.rods_touch_exactly else ()),
    )
    files = {
        **rendered(words, (*VERBATIM, *further), TEMPLATES),
        **generated,
        "scene.toml": scene_text(with_discretisation(without_contacts(model.scene), model.discretisation)),
    }
    if derivatives:
        functions = [
            function
            for number, own in enumerate(chosen.equations)
            for function in ArrangementKernels(own, names.differentiable(str(number))).differentiable()
        ]
        files |= derivative_source(functions, names)
    return with_manifest(files, described)


def _words(chosen: Chosen, names: Names, tables: Tables, generated: dict[str, str]) -> dict[str, Any]:
    free = build(chosen.scene, chosen.equations[0].grids.discretisation(chosen.scene))
    arrangements = len(chosen.equations)
    tries = min(TRIES_EACH * arrangements, MOST_TRIES)
    touches = max(len(own.state.touches) for own in chosen.equations)
    forces = max(len(own.nominal.force_units) for own in chosen.equations)
    inputs = chosen.layout.size
    return {
        **title_words(names, chosen.scene, generated),
        **PLAIN_BUILD,
        **dict.fromkeys(("in_contact", "with_axes"), True),
        "rods_touch_rods": chosen.scene.rods_touch_exactly,
        "what_is_touched": "obstacles or each other" if chosen.scene.rods_touch_exactly else "obstacles",
        "samples_of_rod": SAMPLES_OF_ROD,
        "contact_rates": 5 if chosen.scene.rods_touch_exactly else 4,
        **input_words(free, names),
        "inputs": inputs,
        # C has no array without entries; parameters are behind the inputs.
        "input_room": max(len(chosen.given), 1),
        "rods": len(tables.rods),
        "poses": len(tables.rods) + len(chosen.scene.bodies),
        "owners": len(tables.owners),
        "obstacles": len(tables.obstacles),
        "actuators": len(chosen.scene.actuators),
        "pairs": len(tables.pairs),
        "arrangements": arrangements,
        "arrangement_lines": "\n".join(
            f"   {number}: {comment(described(own))}" for number, own in enumerate(chosen.equations)
        ),
        "arrangement_rows": "\n".join(
            f"| {number} | {described(own)} |" for number, own in enumerate(chosen.equations)
        ),
        "number_macros": _number_macros(names, tables),
        "most_contacts": max(touches, 1),
        "touch_room": max(touches, 1),
        "place_room": max([len(own.state.places) for own in chosen.equations] + [1]),
        "most_forces": forces,
        "columns": max(forces, 1),
        "largest": tables.largest,
        "largest_of_all": tables.largest_of_all,
        "estimates_errors": int(bool(chosen.richer)),
        "error_safety": SAFETY,
        "error_floor": ROUNDING,
        **blindness_words(chosen.scene.accuracy.tolerance),
        "watched_poses": tables.watched_counts[0],
        "watched_cables": tables.watched_counts[1],
        "shallow": contact_search.SHALLOW,
        "scene_tolerance": f"{chosen.scene.accuracy.tolerance:g}",
        "nodes_of_all": tables.nodes_of_all,
        "tries": tries,
        "candidates": CANDIDATES,
        "tables": tables.text(),
        "kernel_arguments": largest_room(generated, "ARG") + 2,
        "kernel_results": largest_room(generated, "RES") + 2,
        "default_iterations": TRACK_ITERATIONS,
        "default_parts": TRACK_PARTS,
        "solve_iterations": SOLVE_ITERATIONS,
        "solve_parts": SOLVE_PARTS,
        **_limits(chosen),
        **status_words(names, CONTACT_OUTCOMES, "CONTACT"),
    }


def _batch_words(model: Model, names: Names) -> dict[str, Any]:
    """Words for the function of many load cases, whose solutions are states."""
    given = "inputs + (size_t)i * INPUTS"
    if model.parameters.size:
        given = "inputs + (size_t)i * OWN_INPUTS, parameters + (size_t)i * PARAMETERS"
    return {
        **batch_words(names.name, ONE_BY_ONE),
        "parameters_in_source": ", const real *parameters" if model.parameters.size else "",
        "solutions": "contact_state *states",
        "solution_info": "contact_info",
        "solution_found": "CONTACT_CONVERGED",
        "own_of_row": "contact_state *own = states + i",
        "own_size": "sizeof *own",
        "batch_solve": f"{names.name}_solve",
        "given_of_row": given,
    }


def _stability_words(model: Model, tables: Tables) -> dict[str, Any]:
    free, held, unknowns = tables.varying
    return {
        "stability": True,
        "free": free,
        "held": held,
        "most_unknowns": unknowns,
        "free_unknowns": numbers(list(range(free))),
        "held_unknowns": numbers(list(range(free, free + held))),
        "ones": numbers([1.0] * free),
        "units_note": "",
        "flat": contact_judgement.FLAT,
        "pressing": contact_judgement.PRESSING,
        **limits_of_stability(model),
    }


def _limits(chosen: Chosen) -> dict[str, Any]:
    settings = newton.NewtonSettings()
    halvings = int(-np.log2(newton.SHORTEST_STEP))
    return {
        "tolerance": settings.tolerance,
        "iterations": settings.iterations,
        "halvings": halvings,
        "most_residuals": halvings + 1,
        "max_reuses": newton.MAX_REUSES,
        "reuse_decrease": newton.REUSE_DECREASE,
        "accepted": chosen.tolerance,
        "shortest_element": contact_state.SHORTEST,
        "longest_way": LONGEST_WAY,
        "deep": passing_through.DEEP,
        "vanished": VANISHED,
        "near": contact_alternatives.NEAR,
        "at_tip": contact_state.AT_END,
        "lies_from": contact_alternatives.LIES_FROM,
        "alike": contact_search.ALIKE,
        "fit": contact_equations.FIT,
        "samples": len(contact_search.SAMPLES) - 1,
    }


def _number_macros(names: Names, tables: Tables) -> str:
    lines = [f"#define {names.macro}_ROD_{identifier(rod).upper()} {i}" for i, rod in enumerate(tables.rods)]
    for number, obstacle in enumerate(tables.obstacles):
        lines.append(f"#define {names.macro}_OBSTACLE_{identifier(obstacle).upper()} {number}")
    for number, actuator in enumerate(names.actuators):
        lines.append(f"#define {names.macro}_ACTUATOR_{identifier(actuator).upper()} {number}")
    return "\n".join(lines)


def _manifest(model: Model, chosen: Chosen, names: Names) -> dict[str, Any]:
    """Describe the contents of the library, as data."""
    free = build(chosen.scene, chosen.equations[0].grids.discretisation(chosen.scene))
    arrangements = []
    for own in chosen.equations:
        touches = [_described(touch) for touch in own.state.touches]
        nominal = own.nominal
        sizes = {
            "unknowns": nominal.model.size,
            "forces": len(nominal.force_units),
            "places": len(own.state.places),
        }
        arrangements.append({"contacts": touches, **sizes})
    return {
        **head_entries(names, free),
        **({"parameters": parameter_entries(model)} if model.parameters.size else {}),
        "rods": [rod.name for rod in chosen.scene.rods],
        **({"bodies": [body.name for body in chosen.scene.bodies]} if chosen.scene.bodies else {}),
        "obstacles": [obstacle.name for obstacle in chosen.scene.obstacles],
        **({"rods_touch_rods": True} if chosen.scene.rods_touch_exactly else {}),
        **({"actuators": actuator_entries(free)} if chosen.scene.actuators else {}),
        ARRANGEMENTS: arrangements,
        "discretisation": {name: asdict(own) for name, own in model.discretisation.items()},
    }


def _described(touch: Touch) -> dict[str, Any]:
    """Describe a contact of an arrangement for the manifest; of two rods with the end of either at which it stays."""
    if touch.other is not None:
        return {"rod": touch.owner, "other_rod": touch.obstacle, "kind": touch.kind, "held_at": list(touch.held_at)}
    return {
        "body" if touch.of_body else "rod": touch.owner,
        "obstacle": touch.obstacle,
        "kind": touch.kind,
        "at_tip": touch.reaches_tip,
    }
