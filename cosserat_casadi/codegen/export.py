"""Export of a model as a folder of C sources that need neither Python nor CasADi."""

from __future__ import annotations

import os
import re
from pathlib import Path

import numpy as np

from cosserat_casadi.accuracy.models import build
from cosserat_casadi.accuracy.refine import solve
from cosserat_casadi.accuracy.verified import Verified
from cosserat_casadi.codegen.assembled import assembled
from cosserat_casadi.codegen.contact.arrangements import chosen_arrangements
from cosserat_casadi.codegen.contact.checks import check_contact, check_load_cases
from cosserat_casadi.codegen.contact.sources import contact_files
from cosserat_casadi.codegen.folder import check_folder, write_folder
from cosserat_casadi.codegen.kernel_files import derivative_source, kernel_sources
from cosserat_casadi.codegen.kernels import differentiable, kernels
from cosserat_casadi.codegen.lanes import in_lanes
from cosserat_casadi.codegen.library import FolderContents, library_sources
from cosserat_casadi.codegen.manifest import manifest, with_manifest
from cosserat_casadi.codegen.motion_parts import check_motion, motion_in_c
from cosserat_casadi.codegen.motion_sources import motion_entry
from cosserat_casadi.codegen.names import library_names, model_names, scene_names
from cosserat_casadi.codegen.stability import check_stability, stability_sources
from cosserat_casadi.codegen.tubes.sources import check_tubes, tube_files
from cosserat_casadi.codegen.turn_budget import ALWAYS, costs_of, fitting
from cosserat_casadi.equilibrium.contact.contact_state import without_contacts
from cosserat_casadi.errors import ExportError, Problem, collect_problems, refuse
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.discretise import with_discretisation
from cosserat_casadi.model.obstacle_checks import refuse_obstacles
from cosserat_casadi.scene import Scene
from cosserat_casadi.scene.writing import scene_text
from cosserat_casadi.tubes.tube_functions import TubeFunctions


def export(
    model: Scene | Model | TubeFunctions,
    directory: str | os.PathLike[str],
    name: str | None = None,
    *,
    error_estimate: float | None = None,
    verified: Verified | None = None,
    derivatives: bool = False,
    dynamics: bool = False,
    stability: bool = False,
    batches: bool = False,
    cuda: bool = False,
    load_cases: FloatArray | None = None,
    period: float | None = None,
    estimate_errors: bool = True,
) -> Path:
    """Write a scene or a model as a folder of C99 sources: equations with Jacobians, solver, demo, build file, README.

    Args:
        model: model of rods, with its discretisation, or of concentric tubes, with its steps; or a scene, which is
            exported as the model with which :func:`cosserat_casadi.solve` solves it.
        directory: the folder, new, empty, or of an earlier export; its name is the default name of the library.
        name: prefix of every symbol, a C identifier.
        error_estimate: error of the tip pose at the scene's inputs, over the length, for the manifest.
        verified: ranges over which the discretisation keeps the tolerance, for header, README and manifest.
        derivatives: whether the equations are also written with first and second derivatives, for CasADi, as
            :func:`cosserat_casadi.load` needs them for an optimisation. A controller does not need them; they are twice
            as long as the rest. In exact contact they are written for each arrangement of contacts.
        dynamics: whether the folder also contains motions: a step of fixed size with its derivatives, inverse dynamics
            and its linearisation.
        stability: whether it contains the function that judges the stability of an equilibrium.
        batches: whether its function for many load cases solves four at a time in the vectors of the processor, if the
            equations have a form for that; compiling takes about twice as long. Without it, cases are solved one after
            the other; in exact contact, the function exists only with it.
        cuda: whether the folder also contains the source of batches on a GPU. Experimental: it was never run on one.
        load_cases: stacked inputs, a row for each case, shape (k, m), or with appended parameters, (k, m + p). The
            library of a scene in exact contact has the arrangements of contacts on the path from the scene's own inputs
            and parameters to each case in turn.
        period: time, s, that the longest turn of a control loop may take. The default budget of a turn is then as large
            as fits, by measurement with the compiler of this machine, or by a cost model without a compiler.
        estimate_errors: whether the library estimates the errors of its answers; its kernels are then half as long
            again.

    Returns:
        the folder.

    Raises:
        ExportError: a scene has no equilibrium at its inputs; or the name, the folder, a motion, the stability, the
            contact or the period is refused. Nothing was written.
    """
    if isinstance(model, Scene):
        model, error_estimate = _solved(model)
    asked = {"derivatives": derivatives, "dynamics": dynamics, "stability": stability, "batches": batches, "cuda": cuda}
    if isinstance(model, TubeFunctions):
        options = {f"--{word}": wanted for word, wanted in asked.items()}
        further = {"--over": load_cases is not None, "--period": period is not None}
        check_tubes({**options, **further, "--no-error-estimate": not estimate_errors})
    else:
        check_period(model.scene, period)
        check_contact(model.scene, asked)
        check_load_cases(model.scene, load_cases)
        if stability:
            check_stability(model)
    folder = Path(directory)
    chosen = re.sub(r"\W", "_", folder.resolve().name) if name is None else name
    stale = check_export(folder, chosen)
    if isinstance(model, TubeFunctions):
        files = tube_files(model, chosen, error_estimate, batches=batches)
    elif model.scene.touches_exactly and not dynamics:
        names = scene_names(chosen, without_contacts(model.scene))
        arrangements = chosen_arrangements(model, load_cases, estimate_errors=estimate_errors, stability=stability)
        files = contact_files(
            model, arrangements, names, error_estimate, verified, derivatives=derivatives, batches=batches
        )
    else:
        files = folder_files(
            model,
            chosen,
            error_estimate,
            verified=verified,
            **asked,
            period=period,
            estimate_errors=estimate_errors,
        )
    write_folder(folder, files, stale)
    return folder


def _solved(scene: Scene) -> tuple[Model | TubeFunctions, float | None]:
    """Solve a scene at its inputs; return the model of the solution and its estimated error.

    Raises:
        ExportError: there is no equilibrium.
    """
    solution = solve(scene)
    if not solution.converged:
        raise ExportError(Problem("scene", solution.message, "change its inputs, or export a model"))
    model = solution.model
    if scene.parameters:
        # The solved model has the scene's own numbers as constants.
        model = build(scene, model.steps if isinstance(model, TubeFunctions) else model.discretisation)
    return model, solution.error_estimate


def check_export(directory: Path, name: str) -> set[str]:
    """Refuse a name or a folder before any work is done for it.

    Returns:
        names of the files of an earlier export in the folder.

    Raises:
        ExportError: with every fault.
    """
    problems: list[Problem] = []
    stale: set[str] = set()
    with collect_problems(problems):
        library_names(name)
    with collect_problems(problems):
        stale = check_folder(directory)
    refuse(problems, ExportError)
    return stale


def folder_files(
    model: Model,
    name: str,
    error_estimate: float | None = None,
    *,
    verified: Verified | None = None,
    derivatives: bool = False,
    dynamics: bool = False,
    stability: bool = False,
    batches: bool = False,
    cuda: bool = False,
    period: float | None = None,
    estimate_errors: bool = True,
) -> dict[str, str]:
    """Write the text of every file that :func:`export` writes for a model; the manifest, which lists them, is last.

    Raises:
        ExportError: motions are requested, but the scene has none.
    """
    if dynamics:
        check_motion(model, on_device=cuda)
        model = model.in_motion
    else:
        refuse_obstacles(model.scene, "exported C")
    names = model_names(name, model, dynamics=dynamics, estimate_errors=estimate_errors)
    parts = assembled(model, names)
    motion = motion_in_c(model, names) if dynamics else None
    functions = kernels(model, names, parts, motion)
    generated = kernel_sources(functions, names, on_device=cuda)
    rows = in_lanes(model, names) if batches else None
    beside = {"scene.toml": scene_text(with_discretisation(model.scene, model.discretisation))}
    if stability:
        beside |= stability_sources(model, names)
    if derivatives:
        beside |= derivative_source(differentiable(model, names), names)
    contents = FolderContents(generated, parts, motion, rows, beside, on_device=cuda, batches=batches)
    by_hand = library_sources(model, names, contents, error_estimate, verified)
    budget = ALWAYS
    if period is not None:
        budget = fitting(costs_of(model, names, {**by_hand, **generated}), period)
        by_hand = library_sources(model, names, contents, error_estimate, verified, budget)
    described = manifest(model, names, functions, error_estimate, verified)
    if motion is not None:
        described["motion"] = motion_entry(model)
    if batches:
        described["batches"] = contents.batch_order
    described["turn"] = budget.entry
    return with_manifest({**by_hand, **generated, **beside}, described)


def check_period(scene: Scene, period: float | None) -> None:
    """Refuse an invalid period, or a period for a library whose turns it does not bound.

    Raises:
        ExportError: the period is not a positive number of seconds, or the scene is in exact contact.
    """
    if period is None:
        return
    problems = []
    if not (period > 0.0 and np.isfinite(period)):
        problems.append(Problem("--period", f"must be a positive number of seconds, got {period:g}"))
    if scene.touches_exactly:
        problem = "is not known for a scene in exact contact, whose turns try arrangements of contacts"
        problems.append(Problem("--period", problem, "leave it out, and give NAME_track a budget"))
    refuse(problems, ExportError)
