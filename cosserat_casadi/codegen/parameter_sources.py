"""Words in the templates of parameters: arguments of the header's functions, and code that stacks them."""

from __future__ import annotations

from cosserat_casadi.codegen.block_sources import Words
from cosserat_casadi.codegen.manifest import parameter_entries
from cosserat_casadi.codegen.names import Names
from cosserat_casadi.codegen.structs import vector_words
from cosserat_casadi.compiling.texts import render
from cosserat_casadi.model.build import Model
from cosserat_casadi.tubes.tube_functions import TubeFunctions

DERIVATIVES = {
    "x_by_parameters": "d_x_d_parameters",
    "poses_by_parameters": "d_poses_d_parameters",
    "residual_by_parameters": "d_residual_d_parameters",
    "end_by_parameters": "d_end_d_parameters",
}
"""Arguments of the header for derivatives by parameters, each of which follows the one for derivatives by inputs."""

ROWS_OF_INPUTS: Words = {"parameters_in_source": "", "given_of_row": "inputs + (size_t)i * INPUTS", "given": "inputs"}
"""Words for batches without parameters."""

WITHOUT: Words = {
    **ROWS_OF_INPUTS,
    **dict.fromkeys(DERIVATIVES, ""),
    "parameters": "",
    "from_parameters": "",
    "parameters_in_readme": "",
    "passed": "",
    "no_derivatives": "",
    "inner": "",
    "inner_equations": "",
    "pose_adapters": "",
    "parameter_reals": 0,
}
"""Words of a library without parameters, besides words that depend on the library."""


def parameter_words(basics: Words, model: Model | TubeFunctions, names: Names, *, dynamics: bool) -> Words:
    """Words of a library, with parameters if the scene names some.

    Args:
        basics: names and sizes of the library.
        model: the exported model.
        names: names of the library and its parts.
        dynamics: whether the library has motions.
    """
    functions = [names.function("tip_jacobian", rod) for rod in names.rods]
    functions += [names.function("body_jacobian", body) for body in names.bodies]
    if not model.parameters.size:
        return {
            **WITHOUT,
            "solver_inputs": f"{names.macro}_INPUTS",
            "pose_derivatives": _listed_lines(functions),
        }
    adapters = [f"derivatives_of_{function}" for function in functions]
    rendered = [
        render("pose_adapter.c.in", {**basics, "adapter": adapter, "function": function})
        for adapter, function in zip(adapters, functions, strict=True)
    ]
    return {
        "parameter_count": model.parameters.size,
        **vector_words(names, parameter_entries(model), "parameter"),
        **_arguments(names),
        "with_parameters": True,
        "solves_tangent": True,
        "passed": ", parameters",
        "no_derivatives": ", 0",
        "given": "stack(inputs, parameters, work->stacked)",
        "inner": "stacked_",
        "inner_equations": "stacked_",
        "solver_inputs": f"({names.macro}_INPUTS + {names.macro}_PARAMETERS)",
        "pose_adapters": "".join(rendered),
        "pose_derivatives": _listed_lines(adapters),
        "parameter_reals": _workspace_reals(basics, dynamics),
    }


def contact_parameter_words(model: Model, names: Names) -> Words:
    """Words of a library of rods in exact contact, with parameters if the scene names some.

    Args:
        model: the exported model.
        names: names of the library and its parts.
    """
    if not model.parameters.size:
        empty = ("parameters", "poses_by_parameters", "contacts_by_parameters", "passed", "no_derivatives")
        return {**dict.fromkeys(empty, ""), "solver_inputs": f"{names.macro}_INPUTS"}
    real = f"{names.name}_real"
    return {
        "parameter_count": model.parameters.size,
        **vector_words(names, parameter_entries(model), "parameter"),
        "with_parameters": True,
        "parameters": f"const {real} *parameters, ",
        "poses_by_parameters": f"{real} *d_poses_d_parameters, ",
        "contacts_by_parameters": f"{real} *d_contacts_d_parameters, ",
        "passed": ", parameters",
        "no_derivatives": ", 0",
        "solver_inputs": f"({names.macro}_INPUTS + {names.macro}_PARAMETERS)",
    }


def _listed_lines(functions: list[str]) -> str:
    return "".join(f"    {function},\n" for function in functions)


def _arguments(names: Names) -> Words:
    """Arguments of the functions of the header, each following another one; arguments for inputs end with a comma."""
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


def _workspace_reals(basics: Words, dynamics: bool) -> int:
    """Size of the workspace for parameters, in numbers."""
    room = int(basics["input_room"])
    statics = 2 * room + int(basics["unknowns"]) + 7 * int(basics["poses"]) * room
    return statics + (2 * room + 6 * int(basics["unknowns"]) * room if dynamics else 0)
