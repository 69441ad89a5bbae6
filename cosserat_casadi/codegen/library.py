"""The sources around the kernels: header, solver, demo program, build file, README; from templates."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.metadata import version
from typing import Any

import casadi as ca
import numpy as np

from cosserat_casadi.accuracy.verified import Verified
from cosserat_casadi.codegen import lanes
from cosserat_casadi.codegen.assembled import Assembled
from cosserat_casadi.codegen.block_sources import block_words, dense_words
from cosserat_casadi.codegen.contact.moving import CONTACT_FILES, FRICTION_FILES, ROD_FILES, contact_words
from cosserat_casadi.codegen.error_sources import ERROR_FILES, STEPS_OF_ESTIMATE, error_words, estimates_errors
from cosserat_casadi.codegen.functions_in_c import public_functions
from cosserat_casadi.codegen.lanes import InLanes
from cosserat_casadi.codegen.manifest import MANIFEST, described_unknowns, input_entries
from cosserat_casadi.codegen.memory import largest_room, stack_bytes, workspace_kb
from cosserat_casadi.codegen.motion_parts import MotionInC
from cosserat_casadi.codegen.motion_sources import MOTION_FILES, motion_words
from cosserat_casadi.codegen.names import Names
from cosserat_casadi.codegen.parameter_sources import parameter_words
from cosserat_casadi.codegen.parameters import given_size
from cosserat_casadi.codegen.passages import PASSAGE_FILES, passage_words, watches_passages
from cosserat_casadi.codegen.status import status_words
from cosserat_casadi.codegen.structs import initialiser, pose_name, result_struct_words, vector_words
from cosserat_casadi.codegen.turn_budget import ALWAYS, SETTLING_ITERATIONS, TurnBudget
from cosserat_casadi.compiling.c_tables import numbers
from cosserat_casadi.compiling.texts import render, resource
from cosserat_casadi.equilibrium.judge import MAX_DISTANCE
from cosserat_casadi.equilibrium.load_path import PACE, continuation_limits, first_step, may_stretch, nearly_loaded
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.input_bounds import ranges_of_inputs
from cosserat_casadi.model.strain_margins import APART, VANISHED, margins_of
from cosserat_casadi.motion.stops_facing import struck_in_steps
from cosserat_casadi.numerics import newton
from cosserat_casadi.numerics.broyden import SINGULAR
from cosserat_casadi.numerics.continuation import MOST_BENT, ContinuationSettings
from cosserat_casadi.scene import Scene
from cosserat_casadi.tubes.tube_functions import TubeFunctions

SHARED = (
    "solver.h",
    "solver_newton.c",
    "solver_path.c",
    "solver.c",
    "solver_sensitivity.c",
    "solver_track.c",
    "solver_recover.c",
)
DENSE = ("linear_dense.c",)
BLOCKS = ("linear_blocks.h", "linear_blocks.c")
FOURS = ("fours.h",)
PROGRAM = ("program.h",)
LEAST_MISFIT = "least_misfit.c"
SECOND_VARIATION = "second_variation.c"
SOLVER_FILES = (
    *(*SHARED, *ERROR_FILES, *PASSAGE_FILES, *CONTACT_FILES, *FRICTION_FILES, *DENSE, *BLOCKS, *MOTION_FILES),
    *(*ROD_FILES, LEAST_MISFIT, SECOND_VARIATION),
)
VERBATIM = frozenset({*SOLVER_FILES, *FOURS, *PROGRAM, *lanes.FILES})
"""Files of the folder ``c`` that the sources of a library include."""

LINES = r"#ifdef (?:{words})\n(?:(?!#).*\n)*(?:#else\n((?:(?!#).*\n)*))?#endif\n"
"""Lines in C that are compiled where one of some words is defined, and in its group the lines in their place."""

TEMPLATES = ("library.h.in", "library.c.in", "config.h.in", "demo.c.in")
"""Templates of header, source, configuration and demo."""

COMMENT_WIDTH = 120
"""Number of characters of a line in a comment."""

PLAIN_BUILD = dict.fromkeys(("more_sources", "more_compiled", "more_headers"), "")
"""Words of the build file and README of a folder without float, OpenMP and further sources."""

SIDE_BY_SIDE = "four load cases at a time, in vectors of the processor"
ONE_BY_ONE = "one load case after the other: these equations have no form for several at once"
"""Sentence on the order of many load cases, for header, README and manifest."""

RANGES_OF_RODS = (
    "a tension not below zero and a length above zero, and by the bounds of the scene. The\n   solver looks at none: "
    "a tension below zero pushes along its path, as no cable does, and the solution is one all the same."
)
"""Sentence on the ranges of inputs, and on the solver beyond them, for the header."""

ROLES = {
    "{name}.h": "the header to include: sizes, inputs, status, every function",
    "{name}.c": "the equations of this scene, and by inclusion the solver: compile this",
    "{name}_config.h": "sizes and limits that the solver is compiled with",
    "solver.c": "the solver, the same in every folder: solutions and how they are judged",
    "solver_newton.c": "Newton from an iterate",
    "solver_path.c": "growing loads, and one input after another",
    "solver_sensitivity.c": "derivatives of a solution",
    "solver_track.c": "a turn of a control loop",
    "blind_turns.c": "whether modes see the waves of rods that loads roll up",
    "solver_error.c": "the error of an answer, from modes that the model lacks",
    "solver_recover.c": "a turn of the way back of a control loop",
    "passages.c": "whether a step leads through something thin",
    "contact_gaps.c": "gaps to obstacles that are touched exactly",
    "contact_ways.c": "ways that lead into such obstacles",
    "struck_rods.h": "declarations of `struck_rods.c`",
    "struck_rods.c": "gaps to other rods",
    "touching_rods.c": "gaps to other rods at rest, and whether rods pass through each other",
    "square_systems.c": "linear systems of any size",
    "least_pushes.c": "which of several contacts push",
    "contact_steps.c": "forces and blows of exact contact in a step",
    "contact_sensitivity.c": "forces and blows of exact contact in the derivatives of a step",
    "contact_friction.c": "friction of exact contact in a step",
    "friction_sensitivity.c": "friction of exact contact in the derivatives of a step",
    "interpolation.c": "positions between nodes",
    "solver.h": "declarations that the parts of the solver share",
    "linear_dense.c": "factorisation of the Jacobian as a whole",
    "linear_blocks.c": "factorisation of the Jacobian, rod after rod",
    "linear_blocks.h": "types of the tables for `linear_blocks.c`",
    "stage_newton.c": "Newton's method for the stages of a step, the same in every folder",
    "step.c": "a step of a motion, the same in every folder",
    "step_sensitivity.c": "derivatives of a step",
    "motion.c": "inverse dynamics, their linearisation, a start at rest",
    "elimination.c": "factorisation of the matrices of a step",
    "motion.h": "types of the tables for `elimination.c`",
    "{name}_kernels.c": "the equations of the rods, generated: compile this",
    "{name}_kernels.h": "prototypes of the equations",
    "{name}_kernels_in_fours.h": "the equations that compute four columns or intervals at once; included",
    "fours.h": "four numbers in a vector of the processor, or one after the other",
    "program.h": "copies and sums of tables of numbers, for kernels in loops; included",
    "{name}_lanes.c": "the equations for four load cases at once: compile this too",
    "{name}_lanes.h": "prototypes of the equations for four load cases",
    "lanes.c": "the solver of many load cases side by side; included",
    "lanes.h": "functions that `lanes.c` calls",
    "lanes_arithmetic.h": "vectors of the processor; included",
    "lanes_linear.c": "linear algebra of four load cases at once; included",
    "{name}_stability.c": "whether equilibria are stable: compile this too where you ask for it",
    "{name}_stability.h": "prototype of the function for stability",
    "{name}_batch.cu": "many load cases on a GPU, experimental: compile this alone with `nvcc`",
    "{name}_batch.h": "prototypes of the functions on a GPU",
    "second_variation.c": "eigenvalues over admissible variations, the same in every folder; included",
    "{name}_derivatives.c": "the same equations with derivatives, for `casadi.external`; a controller does not need it",
    "{name}_derivatives_in_fours.h": "the equations with derivatives that compute four intervals at once; included",
    "{name}_demo.c": "solves once, times it, prints JSON",
    "{name}_motion_demo.c": "simulates a second of motion, prints JSON",
    "CMakeLists.txt": "library, demo, install, `find_package`",
    "manifest.json": "the same facts as data",
    "scene.toml": "the exported scene, with its modes and nodes",
}
"""Purpose of each file."""


@dataclass(frozen=True)
class FolderContents:
    """The optional parts of a folder besides the solver.

    Attributes:
        generated: source and header of the kernels by file name.
        parts: the equations of an assembly in parts; None for one rod.
        motion: the equations of motion; None without them.
        rows: the solver of batches side by side; None without it.
        beside: further files by name, such as files for stability or for derivatives.
        on_device: whether the folder contains batches on a GPU.
        batches: whether the function for many load cases was requested.
    """

    generated: Mapping[str, str]
    parts: Assembled | None
    motion: MotionInC | None = None
    rows: InLanes | None = None
    beside: Mapping[str, str] = field(default_factory=dict)
    on_device: bool = False
    batches: bool = False

    @property
    def batch_order(self) -> str:
        """Sentence on the order in which many load cases are solved; empty if that was not requested."""
        if self.rows is not None:
            return SIDE_BY_SIDE
        return ONE_BY_ONE if self.batches else ""

    def verbatim(self, model: Model, names: Names) -> tuple[str, ...]:
        """Files of the folder ``c`` that the library includes."""
        estimate = ERROR_FILES if estimates_errors(names) else ()
        linear = DENSE if self.parts is None else BLOCKS
        motion = () if self.motion is None else MOTION_FILES
        passages = PASSAGE_FILES if watches_passages(model) else ()
        contact = CONTACT_FILES if self.motion is not None and struck_in_steps(model) else ()
        friction = FRICTION_FILES if self.motion is not None and model.scene.rubs_exactly else ()
        rods = ROD_FILES if self.motion is not None and model.scene.rods_touch_exactly else ()
        return (*SHARED, *estimate, *passages, *linear, *motion, *contact, *friction, *rods)

    def to_compile(self, names: Names) -> dict[str, str]:
        """Words of the build file for further sources and headers."""
        source, header = f"{names.name}_stability.c", f"{names.name}_stability.h"
        lanes_source = "" if self.rows is None else f" {names.name}_lanes.c"
        return {
            "more_sources": (f" {source}" if source in self.beside else "") + lanes_source,
            "more_compiled": lanes_source,
            "more_headers": f" {header}" if header in self.beside else "",
        }


def library_sources(
    model: Model,
    names: Names,
    contents: FolderContents,
    error_estimate: float | None = None,
    verified: Verified | None = None,
    budget: TurnBudget = ALWAYS,
) -> dict[str, str]:
    """Write the files of a folder other than the kernels, by name.

    Args:
        model: the exported model.
        names: names of the library and its parts.
        contents: optional parts of the folder.
        error_estimate: error of the tip pose at the scene's inputs, over the length.
        verified: ranges over which the discretisation keeps the tolerance; None if unknown.
        budget: default budget of a turn of a control loop.
    """
    words = _words(model, names, contents) | accuracy_words(model.scene, error_estimate, verified)
    words |= {
        "default_iterations": budget.iterations,
        "default_continuation_steps": budget.steps,
        "budget_note": budget.note,
        **contents.to_compile(names),
    }
    name = names.name
    files = {} if contents.rows is None else dict(contents.rows.files)
    if contents.motion is not None:
        files[f"{name}_motion_demo.c"] = render("motion_demo.c.in", words)
    if contents.on_device:
        files |= {file: render(f"device_batch.{file.rpartition('.')[2]}.in", words) for file in device_files(name)}
    beside = {*files, *contents.generated, *contents.beside, MANIFEST}
    return files | rendered(words, contents.verbatim(model, names), beside=beside)


def device_files(name: str) -> tuple[str, str]:
    """Return the file names of the source and header of batches on a GPU."""
    return f"{name}_batch.cu", f"{name}_batch.h"


def rendered(
    words: dict[str, Any],
    verbatim: Iterable[str],
    templates: Sequence[str] = TEMPLATES,
    beside: Collection[str] = (),
) -> dict[str, str]:
    """Render the files of every folder, by name: header, source, configuration, demo, build file, README and solver.

    Args:
        words: of the templates.
        verbatim: files of the folder ``c`` that are written without lines that this library never compiles.
        templates: of the first four.
        beside: names of the other files of the folder, for the README.
    """
    header, source, config, demo = (render(template, words) for template in templates)
    name = words["name"]
    used = (("RODS_FACE_RODS", "rods_face_rods"), ("RODS_TOUCH_RODS", "rods_touch_rods"))
    unused = "|".join(["STRETCHES_ARE_TOLD", *(macro for macro, word in used if not words.get(word))])
    left_out, on_device = re.compile(LINES.format(words=unused)), bool(words.get("on_device"))
    files = {
        f"{name}.h": header,
        f"{name}.c": source,
        f"{name}_config.h": config,
        f"{name}_demo.c": demo,
        "CMakeLists.txt": render("CMakeLists.txt.in", words),
        **{file: left_out.sub(r"\1", resource("c", file, on_device=on_device)) for file in verbatim},
    }
    files["README.md"] = render("README.md.in", {**words, "file_rows": _file_rows(name, {*files, *beside})})
    return files


def title_words(
    names: Names, scene: Scene, generated: Mapping[str, str], without_workspace: Collection[str] = ()
) -> dict[str, Any]:
    """Words for names, title and versions of a folder, and for the memory that its kernels need."""
    major, minor, patch = re.findall(r"\d+", version("cosserat-casadi"))[:3]
    return {
        "name": names.name,
        "MACRO": names.macro,
        "title": comment(scene.title or names.name),
        "version": version("cosserat-casadi"),
        "version_major": major,
        "version_minor": minor,
        "version_patch": patch,
        "casadi_version": ca.CasadiMeta.version(),
        "kernel_reals": largest_room(generated, "W") + 1,
        "kernel_integers": largest_room(generated, "IW") + 1,
        "stack_kb": f"{np.ceil(stack_bytes(generated, without_workspace) / 500) / 2:g}",
    }


ROWS_OF_UNKNOWNS = {
    "solutions": "real *x",
    "solution_info": "solver_info",
    "solution_found": "SOLVER_CONVERGED",
    "own_of_row": "real *own = x + (size_t)i * N",
    "own_size": "N * sizeof *own",
}
"""Words for batches whose solutions are unknowns."""


def batch_words(name: str, order: str) -> dict[str, Any]:
    """Words for the order in which the function of many load cases solves them, which may be empty."""
    if not order:
        return {"batch_workspace": f"{name}_workspace", "batch_note": "", "batches": order}
    note = f"\n   It solves {order}."
    return {"batch_workspace": f"{name}_batch_workspace", "batch_note": note, "batches": order, "on_cores": True}


def _words_of_rows(name: str, rows: InLanes | None) -> dict[str, Any]:
    """Words for the source of the function of many load cases."""
    if rows is None:
        return {**ROWS_OF_UNKNOWNS, "batch_solve": "solver_solve", "batch_stack": ""}
    return {
        **rows.words,
        "in_lanes": True,
        "batch_stack": f", {name}_solve_batch {rows.words['lanes_stack_kb']} kB",
    }


def _words(model: Model, names: Names, contents: FolderContents) -> dict[str, Any]:
    parts = contents.parts
    motion = contents.motion
    sizes = _sizes(model, names, contents.generated) | {"on_device": contents.on_device}
    sizes |= parameter_words(sizes, model, names, dynamics=motion is not None)
    linear = dense_words(sizes) if parts is None else block_words(sizes, parts)
    sizes |= {} if motion is None else contact_words(model, names)
    margins = margins_of(model.discrete)
    sizes["apart"] = any(margin.kind == APART for margin in margins)
    in_motion = {} if motion is None else motion_words(sizes, model, names, motion)
    sizes |= error_words(model, names) | passage_words(model, names)
    sizes |= batch_words(names.name, contents.batch_order) | _words_of_rows(names.name, contents.rows)
    functions = public_functions(model, names)
    weights = model.discrete.unknowns.step_weights
    owners = "each rod,\n   then each body" if names.bodies else "each rod"
    return {
        **sizes,
        **dict.fromkeys(("of_rods", "on_cores", "with_axes"), True),
        "family": "solver_",
        **solver_constants(continuation_limits(model), MAX_DISTANCE, nearly_loaded(model)),
        "step_weights": numbers(weights.tolist()),
        "is_shape": numbers(model.discrete.unknowns.differential.astype(int).tolist()),
        "paces": int(may_stretch(model)),
        "first": first_step(model),
        "margins": len(margins),
        "paths": sum(margin.kind == "path" for margin in margins),
        "planes": sum(margin.kind == "plane" for margin in margins),
        "vanished": VANISHED,
        **status_words(names),
        **input_words(model, names),
        **result_struct_words(model, names),
        **_unknown_words(model),
        # The demo solves, and shows the tip of the first rod.
        "igm": names.function("igm", names.rods[0]),
        "tip": names.function("tip", names.rods[0]),
        "first_pose": pose_name(names, "tip", names.rods[0]),
        "workspace_kb": workspace_kb({**sizes, **linear, **in_motion}),
        "pose_owners": f"{owners}: position, then quaternion",
        **linear,
        **in_motion,
        "prototypes": "".join(function.prototype(sizes) for function in functions),
        "functions": "".join(function.wrapper(sizes) for function in functions),
        "function_rows": "\n".join(f"| `{function.symbol}` | {function.description} |" for function in functions),
    }


def _sizes(model: Model, names: Names, generated: Mapping[str, str]) -> dict[str, Any]:
    without_workspace = {function.kernel for function in public_functions(model, names)}
    return {
        **title_words(names, model.scene, generated, without_workspace),
        "unknowns": model.size,
        "inputs": model.inputs.size,
        "rods": len(names.rods),
        "bodies": len(names.bodies),
        "poses": len(names.rods) + len(names.bodies),
        # C has no array without entries; parameters are behind the inputs.
        "input_room": max(given_size(model), 1),
        "max_reuses": newton.MAX_REUSES,
        "kept_steps": newton.MAX_REUSES + STEPS_OF_ESTIMATE,
    }


def solver_constants(limits: ContinuationSettings, near: float, paced_beyond: float) -> dict[str, Any]:
    """Words of the templates for the limits of the solver.

    Args:
        limits: limits of a continuation.
        near: largest distance of two solutions on one branch.
        paced_beyond: load factor beyond which a stalled path is paced.
    """
    return {
        "tolerance": limits.newton.tolerance,
        "iterations": limits.newton.iterations,
        "shortest": limits.shortest,
        "pace": PACE,
        "nearly_loaded": paced_beyond,
        "longest": limits.longest,
        "inexact": limits.inexact,
        "most_bent": MOST_BENT,
        "steps": limits.steps,
        "grow_below": limits.grow_below,
        "reject_above": limits.reject_above,
        "near": near,
        "reuse_decrease": newton.REUSE_DECREASE,
        "singular": SINGULAR,
        "sufficient_decrease": newton.SUFFICIENT_DECREASE,
        "halvings": int(-np.log2(newton.SHORTEST_STEP)),
        "turn_jacobians": 2,
        "one_sided": "",
        "default_iterations": ALWAYS.iterations,
        "default_continuation_steps": ALWAYS.steps,
        "settling_iterations": SETTLING_ITERATIONS,
        "settling_residuals": SETTLING_ITERATIONS + 2,
    }


def input_words(model: Model | TubeFunctions, names: Names, ranges: str = RANGES_OF_RODS) -> dict[str, Any]:
    """Words of the templates for the inputs of a model: macros, struct, ranges, table, default values.

    Args:
        model: model with the inputs.
        names: names of the library.
        ranges: sentence on the ranges of each kind of input, and on the solver beyond them.
    """
    entries = input_entries(model)
    words: dict[str, Any] = vector_words(names, entries, "input")
    axes = "Section axes turn with the rod."
    if any(entry["shape"][1] > 1 for entry in entries):
        axes = (
            "Lists along the rod are Legendre coefficients in 2X − 1, all components of one degree after another, or "
            "values at knots."
        )
    words |= {
        "input_macros": words["input_macros"] or "/* This scene leaves none free. */",
        "input_rows": words["input_rows"] or "| | none: everything is fixed | | |",
        "input_words": " ".join(entry["name"] for entry in entries) or "none",
        "input_defaults": words["input_defaults"] or "0",
        "axes_note": axes,
    }
    if model.inputs.size:
        lower, upper = ranges_of_inputs(model.scene, model.inputs)
        ends = {"lower": _ends(lower, names), "upper": _ends(upper, names)}
        words |= {"has_inputs": True, "ranges": ranges, **ends}
    return words


def _ends(values: FloatArray, names: Names) -> str:
    """Bounds as the initialiser of an array in C."""
    real = f"({names.name}_real)"
    infinite = {np.inf: f"{real}HUGE_VAL", -np.inf: f"-{real}HUGE_VAL"}
    return ", ".join(infinite.get(value) or initialiser(value, names) for value in values.tolist())


def _unknown_words(model: Model) -> dict[str, str]:
    lines = list[str]()
    rows = ["| entries | what |", "|---|---|"]
    for entry, words in described_unknowns(model):
        last = entry["first"] + entry["count"] - 1
        lines.append(f"   {entry['first']} .. {last}: {words}")
        rows.append(f"| {entry['first']} … {last} | {words} |")
    return {"unknown_lines": "\n".join(lines), "unknown_rows": "\n".join(rows)}


def _file_rows(name: str, files: Collection[str]) -> str:
    """Rows of the README with the purpose of each file of a folder."""
    roles = {file.format(name=name): role for file, role in ROLES.items()}
    return "\n".join(f"| `{file}` | {role} |" for file, role in roles.items() if file in files)


def accuracy_words(scene: Scene, error_estimate: float | None, verified: Verified | None) -> dict[str, str]:
    """Words of a README, and of the comment at the top of a header, for the error of the discretisation.

    Args:
        scene: the exported scene.
        error_estimate: error of the tip pose at the scene's inputs, over the length; None if unknown.
        verified: ranges over which the discretisation keeps the tolerance; None if unknown.
    """
    note = _accuracy_note(scene, error_estimate, verified)
    return {"accuracy_note": note, "accuracy_comment": _wrapped(comment(note))}


def _accuracy_note(scene: Scene, error_estimate: float | None, verified: Verified | None) -> str:
    tolerance = f"The scene asks for a tip pose within {scene.accuracy.tolerance:g} of the length."
    if not scene.accuracy.binds:
        tolerance = "The scene fixes what it is computed with, and asks for no tolerance."
    if verified is not None:
        return f"{tolerance} {verified.sentence}"
    if error_estimate is None:
        return f"{tolerance} How far the discretisation here is from that was not estimated."
    return (
        f"{tolerance} The discretisation was judged at the scene's own inputs: estimated error {error_estimate:.1e}. "
        "Far larger loads need it judged anew."
    )


def _wrapped(text: str) -> str:
    """Break a paragraph into lines of the comment at the top of a header."""
    return textwrap.fill(text, COMMENT_WIDTH, initial_indent="   ", subsequent_indent="   ", break_long_words=False)


def comment(text: str) -> str:
    """Make a title safe in a comment: it cannot end the comment, splice its line, or change the text direction."""
    printable = "".join(character if character.isprintable() else " " for character in text)
    harmless = printable.replace("\\", "/").replace("??/", "?? /").replace("*/", "* /").replace("/*", "/ *")
    return " ".join(harmless.split())
