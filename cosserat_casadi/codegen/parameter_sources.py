"""The words of the sources that belong to parameters: arguments of the header's functions, and what stacks them."""

from __future__ import annotations

from typing import Any

from cosserat_casadi.codegen.block_sources import Render, Words
from cosserat_casadi.codegen.manifest import parameter_entries
from cosserat_casadi.codegen.names import Names
from cosserat_casadi.codegen.structs import initialiser, listed, parameter_macro, parameter_struct_words
from cosserat_casadi.model.build import Model

DERIVATIVES = {
    "x_by_parameters": "d_x_d_parameters",
    "poses_by_parameters": "d_poses_d_parameters",
    "residual_by_parameters": "d_residual_d_parameters",
    "end_by_parameters": "d_end_d_parameters",
}
"""Arguments of the header for derivatives with parameters, each behind that for the derivative with inputs."""

ROWS_OF_INPUTS: Words = {"parameters_in_source": "", "given_of_row": "inputs + (size_t)i * INPUTS"}
"""Words of a batch without parameters."""

WITHOUT: Words = {
    **ROWS_OF_INPUTS,
    **dict.fromkeys(DERIVATIVES, ""),
    "parameters": "",
    "from_parameters": "",
    "parameters_in_readme": "",
    "passed": "",
    "inner": "",
    "inner_equations": "",
    "pose_adapters": "",
    "solved_tangent": "",
    "rate_of_parameters": "",
    "add_rate_of_parameters": "",
    "parameter_header": "",
    "parameter_config": "",
    "parameter_members": "",
    "parameter_functions": "",
    "demo_parameters": "",
    "readme_parameters": "",
    "parameter_reals": 0,
}
"""Words of a library without parameters, beside those that depend on the library."""


def parameter_words(render: Render, basics: Words, model: Model, names: Names, *, dynamics: bool) -> Words:
    """Words of a library, with parameters where the scene names some.

    Args:
        render: fills in templates.
        basics: names and sizes of the library.
        model: what is exported.
        names: what things are called.
        dynamics: whether the library has motions.
    """
    functions = [names.function("tip_jacobian", rod) for rod in names.rods]
    functions += [names.function("body_jacobian", body) for body in names.bodies]
    if not model.parameters.size:
        return {
            **WITHOUT,
            "solver_inputs": f"{names.macro}_INPUTS",
            "unloaded_tangent": render("unloaded_tangent.c.in", basics),
            "pose_derivatives": _listed_lines(functions),
        }
    entries = parameter_entries(model)
    words = {**basics, **_described(entries, names), **parameter_struct_words(names, entries)}
    in_motion = render("parameters_in_motion.c.in", words) if dynamics else ""
    adapters = [f"derivatives_of_{function}" for function in functions]
    rendered = [
        render("pose_adapter.c.in", {**words, "adapter": adapter, "function": function})
        for adapter, function in zip(adapters, functions, strict=True)
    ]
    return {
        **_arguments(names),
        "passed": ", parameters",
        "inner": "stacked_",
        "inner_equations": "stacked_",
        "solver_inputs": f"({names.macro}_INPUTS + {names.macro}_PARAMETERS)",
        "unloaded_tangent": "",
        "solved_tangent": render("solved_tangent.c.in", words),
        "rate_of_parameters": render("rate_of_parameters.c.in", words),
        "add_rate_of_parameters": render("add_rate_of_parameters.c.in", words),
        "pose_adapters": "".join(rendered),
        "pose_derivatives": _listed_lines(adapters),
        "parameter_header": render("parameters.h.in", words),
        "parameter_config": _with_motion(render, "parameters{}_config.h.in", words, dynamics),
        "parameter_members": _with_motion(render, "parameters{}_workspace.h.in", words, dynamics),
        "parameter_functions": render("parameters.c.in", {**words, "motion_with_parameters": in_motion}),
        "parameter_rows": words["parameter_rows"],
        "with_parameters": True,
        "demo_parameters": f"static const real parameters[] = {names.macro}_PARAMETER_DEFAULTS;\n",
        "readme_parameters": f"  {names.name}_real parameters[] = {names.macro}_PARAMETER_DEFAULTS;\n",
        "parameter_reals": _workspace_reals(basics, dynamics),
    }


def _listed_lines(functions: list[str]) -> str:
    return "".join(f"    {function},\n" for function in functions)


def _arguments(names: Names) -> Words:
    """Arguments of the functions of the header, each behind another; those of inputs are followed by a comma."""
    real = f"{names.name}_real"
    derivatives = {word: f",\n    {real} *{argument}" for word, argument in DERIVATIVES.items()}
    return {
        **derivatives,
        "parameters": f",\n    const {real} *parameters",
        "from_parameters": f",\n    const {real} *from_parameters",
        "parameters_in_source": ", const real *parameters",
        "given_of_row": "stack(inputs + (size_t)i * OWN_INPUTS, parameters + (size_t)i * PARAMETERS, work->stacked)",
        "parameters_in_readme": f", const {real} *parameters",
    }


def _with_motion(render: Render, template: str, words: Words, dynamics: bool) -> str:
    """A template, and that of motions behind it."""
    statics = render(template.format(""), words)
    return statics + render(template.format("_in_motion"), words) if dynamics else statics


def _described(entries: list[dict[str, Any]], names: Names) -> Words:
    """Macros, defaults and rows of the README."""
    macros = list[str]()
    rows = list[str]()
    values = list[float]()
    for entry in entries:
        macro = parameter_macro(names, entry["name"])
        own = entry["value"]
        first, count, unit = entry["first"], len(own), entry["unit"]
        numbered = "1 number" if count == 1 else f"{count} numbers"
        macros.append(f"#define {macro} {first} /* {numbered}, {unit}: {entry['name']} */")
        macros.append(f"#define {macro}_SIZE {count}")
        span = f"{first} … {first + count - 1}" if count > 1 else f"{first}"
        rows.append(f"| {span} | `{entry['name']}` | {unit} | {listed(own)} |")
        values += own
    return {
        "parameter_count": len(values),
        "parameter_macros": "\n".join(macros),
        "parameter_rows": "\n".join(rows),
        "parameter_defaults": ", ".join(initialiser(value, names) for value in values),
    }


def _workspace_reals(basics: Words, dynamics: bool) -> int:
    """Numbers that the workspace has for parameters."""
    room = int(basics["input_room"])
    statics = 2 * room + int(basics["unknowns"]) + 7 * int(basics["poses"]) * room
    return statics + (2 * room + 6 * int(basics["unknowns"]) * room if dynamics else 0)
