"""The sources around the kernels: header, solver, demo program, build file, README; from templates."""

from __future__ import annotations

import re
from importlib import resources
from importlib.metadata import version
from itertools import pairwise
from typing import Any

import casadi as ca
import numpy as np

from cosserat_casadi.codegen.assembled import Assembled
from cosserat_casadi.codegen.block_sources import block_words, dense_words
from cosserat_casadi.codegen.manifest import UNITS, actuator_entries, input_entries, unknown_entries
from cosserat_casadi.codegen.names import BODY_FUNCTIONS, FUNCTIONS, Names
from cosserat_casadi.codegen.status import OUTCOMES
from cosserat_casadi.equilibrium.judge import MAX_DISTANCE
from cosserat_casadi.equilibrium.load_path import first_step, step_weights
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.numerics import newton
from cosserat_casadi.numerics.broyden import SINGULAR
from cosserat_casadi.numerics.continuation import MOST_BENT, ContinuationSettings

SINGLE = {"single_tolerance": "1e-5", "single_shortest": "1e-4", "single_singular": "1e-7"}
"""Limits of the solver in float: its rounding is 1e-7 of the largest term."""

NOT_IN_EQUILIBRIUM = "The unknowns are no equilibrium for these inputs: solve first."

ROLES = {
    ".h": "what you include: sizes, inputs, status, every function",
    ".c": "the solver",
    "_kernels.c": "the equations of the rods, generated",
    "_kernels.h": "their prototypes",
    "_derivatives.c": "the same equations with derivatives, for `casadi.external`; a controller does not need it",
    "_demo.c": "solves once, times it, prints JSON",
}


def library_sources(
    model: Model, names: Names, parts: Assembled | None, error_estimate: float | None
) -> dict[str, str]:
    """Hand-readable files of a folder by name."""
    words = _words(model, names, parts, error_estimate)
    name = names.name
    return {
        f"{name}.h": render("library.h.in", words),
        f"{name}.c": render("library.c.in", words),
        f"{name}_demo.c": render("demo.c.in", words),
        "CMakeLists.txt": render("CMakeLists.txt.in", words),
        "README.md": render("README.md.in", words),
    }


def render(template: str, words: dict[str, Any]) -> str:
    """A template of this package with its words filled in."""
    text = (resources.files("cosserat_casadi.codegen") / "templates" / template).read_text(encoding="utf-8")
    return re.sub(r"@\{(\w+)\}", lambda match: str(words[match[1]]), text)


def _words(model: Model, names: Names, parts: Assembled | None, error_estimate: float | None) -> dict[str, Any]:
    basics = {"name": names.name, "MACRO": names.macro}
    rods = [_rod_words(model, names, rod) for rod in names.rods]
    actuators = [_actuator_words(model, names, i) for i in range(len(names.actuators))]
    bodies = [_body_words(names, body) for body in names.bodies]
    return {
        **_sizes(model, names),
        **_solver_constants(),
        "step_share": _step_share(step_weights(model)),
        "first": first_step(model),
        **_texts(),
        **_input_words(model, names),
        **_unknown_words(model),
        **rods[0],
        **_pose_words(names),
        **(dense_words(render, basics) if parts is None else block_words(render, basics, parts)),
        "prototypes": _rendered({"rod.h.in": rods, "actuator.h.in": actuators, "body.h.in": bodies}),
        "functions": _rendered({"rod.c.in": rods, "actuator.c.in": actuators, "body.c.in": bodies}),
        "pose_jacobians": ", ".join(
            [*(words["tip_jacobian"] for words in rods), *(words["body_jacobian"] for words in bodies)]
        ),
        "further_results": _further_results(actuators, bodies),
        "title": _comment(model.scene.title or names.name),
        "version": version("cosserat-casadi"),
        "casadi_version": ca.CasadiMeta.version(),
        "file_rows": _file_rows(names),
        "accuracy_note": _accuracy_note(model, error_estimate),
    }


def _rendered(entries: dict[str, list[dict[str, Any]]]) -> str:
    return "".join(render(template, words) for template, wordings in entries.items() for words in wordings)


def _sizes(model: Model, names: Names) -> dict[str, Any]:
    # Newton holds two factorisations' worth of memory, the kernels their scalars, twelve steps are kept.
    doubles = 2 * model.size**2 + 40 * model.size + 8 * 2000
    return {
        "name": names.name,
        "MACRO": names.macro,
        "unknowns": model.size,
        "inputs": model.inputs.size,
        "rods": len(names.rods),
        "stack_kb": int(np.ceil(doubles * 8 / 1000 / 50) * 50),
    }


def _solver_constants() -> dict[str, Any]:
    limits = ContinuationSettings()
    return {
        "tolerance": limits.newton.tolerance,
        "iterations": limits.newton.iterations,
        "shortest": limits.shortest,
        "longest": limits.longest,
        "rough": limits.inexact,
        "most_bent": MOST_BENT,
        "steps": limits.steps,
        "quick": limits.grow_below,
        "slow": limits.reject_above,
        "near": MAX_DISTANCE,
        "kept_steps": newton.KEPT_STEPS,
        "kept_decrease": newton.KEPT_DECREASE,
        "singular": SINGULAR,
        "sufficient_decrease": newton.SUFFICIENT_DECREASE,
        "halvings": int(-np.log2(newton.SHORTEST_STEP)),
        **SINGLE,
    }


def _step_share(shares: FloatArray) -> str:
    """How much the i-th unknown counts in the length of a step, as a C expression."""
    starts = [0, *(np.flatnonzero(np.diff(shares)) + 1)]
    spans = [f"i < {end} ? (real){float(shares[start])!r} : " for start, end in pairwise(starts)]
    return "".join(spans) + f"(real){float(shares[starts[-1]])!r}"


def _texts() -> dict[str, str]:
    return {"text_not_in_equilibrium": NOT_IN_EQUILIBRIUM, **{f"text_{o.label}": o.value for o in OUTCOMES}}


def _input_words(model: Model, names: Names) -> dict[str, str]:
    entries = input_entries(model)
    macros, rows = [], []
    for entry in entries:
        macro = f"{names.macro}_INPUT_{entry['name'].replace('.', '_').upper()}"
        count, axes = len(entry["value"]), "" if entry["axes"] == "none" else f", {entry['axes']} axes"
        numbered = "1 number" if count == 1 else f"{count} numbers"
        macros.append(f"#define {macro} {entry['first']} /* {numbered}, {entry['unit']}{axes} */")
        span = f"{entry['first']} … {entry['first'] + count - 1}" if count > 1 else f"{entry['first']}"
        rows.append(f"| {span} | `{entry['name']}`{axes} | {entry['unit']} | {_listed(entry['value'])} |")
    numbers = [number for entry in entries for number in entry["value"]]
    polynomial = any(entry["shape"][1] > 1 for entry in entries)
    return {
        "input_macros": "\n".join(macros) or "/* This scene leaves none free. */",
        "input_rows": "\n".join(rows) or "| | none: everything is fixed | | |",
        "input_words": " ".join(entry["name"] for entry in entries) or "none",
        "defaults": _listed(numbers) or "0",
        "axes_note": "Polynomials along the rod are Legendre coefficients in 2X − 1, three numbers for each degree."
        if polynomial
        else "Section axes turn with the rod.",
    }


def _unknown_words(model: Model) -> dict[str, str]:
    lines, rows = [], ["| entries | what |", "|---|---|"]
    for entry in unknown_entries(model):
        last = entry["first"] + entry["count"] - 1
        what = _unknown_word(entry)
        lines.append(f"   {entry['first']} .. {last}: {what}")
        rows.append(f"| {entry['first']} … {last} | {what} |")
    return {"unknown_lines": "\n".join(lines), "unknown_rows": "\n".join(rows)}


def _unknown_word(entry: dict[str, Any]) -> str:
    if "strain" in entry:
        return f"Legendre coefficients of {entry['strain']} of rod {entry['rod']}, element after element"
    if "support" in entry:
        return f"multipliers of the support ({entry['support']}) of rod {entry['rod']}"
    if "tendon" in entry:
        return f"tension of the tendon {entry['tendon']}, in units of {entry['unit_N']:.6g} N"
    if "tie" in entry:
        return f"multipliers of the tie {entry['tie']} on rod {entry['rod']}"
    return f"how far the {entry['frame']} has moved and its quaternion changed"


def _rod_words(model: Model, names: Names, rod: str) -> dict[str, Any]:
    words = {word: names.function(word, rod) for word in FUNCTIONS}
    kernels = {f"k_{word}": names.kernel(word, rod) for word in words}
    basics = {"name": names.name, "rod": rod, "coordinates": model.discrete.rods[rod].size}
    return {**words, **kernels, **basics}


def _actuator_words(model: Model, names: Names, i: int) -> dict[str, Any]:
    entry = actuator_entries(model)[i]
    called = entry["name"]
    symbols = {"actuator": names.function("actuator", called), "k_actuator": names.kernel("actuator", called)}
    effort, extent = entry["effort"], entry["extent"]
    facts = {"effort": effort, "extent": extent, "effort_unit": UNITS[effort], "extent_unit": UNITS[extent]}
    return {"name": names.name, "called": called, "kind": entry["kind"], "rod": entry["rod"], **symbols, **facts}


def _body_words(names: Names, body: str) -> dict[str, Any]:
    words = {word: names.function(word, body) for word in BODY_FUNCTIONS}
    kernels = {f"k_{word}": names.kernel(word, body) for word in words}
    return {"name": names.name, "called": body, **words, **kernels}


def _pose_words(names: Names) -> dict[str, Any]:
    """Whose poses the sensitivities are of."""
    if not names.bodies:
        return {
            "body_macro": "",
            "poses": f"RODS = {names.macro}_RODS",
            "pose_count": "RODS",
            "pose_owners": "each rod: position, then quaternion",
        }
    return {
        "body_macro": f"\n#define {names.macro}_BODIES {len(names.bodies)}",
        "poses": f"RODS = {names.macro}_RODS, POSES = RODS + {names.macro}_BODIES",
        "pose_count": "POSES",
        "pose_owners": "each rod,\n   then each body: position, then quaternion",
    }


def _further_results(actuators: list[dict[str, Any]], bodies: list[dict[str, Any]]) -> str:
    """A section on actuators and bodies; nothing where there are none."""
    rows = [
        f"| `{words['actuator']}` | {words['effort']} ({words['effort_unit']}) and {words['extent']} "
        f"({words['extent_unit']}) of the {words['kind']} {words['called']}, d {words['extent']} / d q |"
        for words in actuators
    ]
    for words in bodies:
        rows.append(f"| `{words['body']}` | pose of the body {words['called']} |")
        rows.append(f"| `{words['body_jacobian']}` | its derivatives with q and with the inputs |")
    if not rows:
        return ""
    return "\n".join(["", "## Actuators and bodies", "", "| function | what it gives |", "|---|---|", *rows, ""])


def _file_rows(names: Names) -> str:
    rows = [f"| `{names.name}{ending}` | {role} |" for ending, role in ROLES.items()]
    rows += [
        "| `CMakeLists.txt` | library, demo, install, `find_package` |",
        "| `manifest.json` | the same facts as data |",
        "| `scene.toml` | the scene all of this was made from |",
    ]
    return "\n".join(rows)


def _accuracy_note(model: Model, error_estimate: float | None) -> str:
    tolerance = f"The scene asks for a tip pose within {model.scene.accuracy.tolerance:g} of the length."
    if error_estimate is None:
        return f"{tolerance} How far the discretisation here is from that was not estimated."
    return (
        f"{tolerance} The discretisation was judged at the scene's own inputs: estimated error {error_estimate:.1e}. "
        "Far larger loads need it judged anew."
    )


def _listed(numbers: list[float]) -> str:
    return ", ".join(f"{number:g}" if float(f"{number:g}") == number else repr(number) for number in numbers)


def _comment(text: str) -> str:
    """A title that cannot end the comment it stands in, splice its line, or change the direction of what follows."""
    printable = "".join(character if character.isprintable() else " " for character in text)
    harmless = printable.replace("\\", "/").replace("??/", "?? /").replace("*/", "* /").replace("/*", "/ *")
    return " ".join(harmless.split())
