"""Write docs/api: a page for each concept, every public name with its signature and docstring.

Usage: ``python docs/api_pages.py``, or ``make api``. A test compares the pages with what this would write.
"""

from __future__ import annotations

import inspect
import re
import textwrap
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import Enum
from importlib import import_module
from itertools import pairwise
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any, get_overloads

import cosserat_casadi
import cosserat_casadi.control
import cosserat_casadi.environments
import cosserat_casadi.estimation
from cosserat_casadi.model.function_table import FunctionSpec, NamedFunction, Owner

FOLDER = Path(__file__).parent / "api"

HEADER = "<!-- Written by docs/api_pages.py from the docstrings. -->"


@dataclass(frozen=True)
class Concept:
    """A page of the reference.

    Attributes:
        file: its name, without suffix.
        title: its heading.
        words: the sentence below it.
        names: public names of the package, in the order in which they are shown.
        control_names: public names of ``cosserat_casadi.control`` that the package itself does not have.
        environment_names: public classes of ``cosserat_casadi.environments``.
        estimation_names: public names of ``cosserat_casadi.estimation``.
        module_names: further names that users import from their modules, as ``module.name`` of the package.
    """

    file: str
    title: str
    words: str
    names: tuple[str, ...]
    control_names: tuple[str, ...] = ()
    environment_names: tuple[str, ...] = ()
    estimation_names: tuple[str, ...] = ()
    module_names: tuple[str, ...] = ()


CONCEPTS = (
    Concept(
        "scene",
        "Scene",
        "What a TOML file describes, read and checked. [Scene keys](../scene.md) lists what a scene may hold.",
        (
            "read_scene",
            "parse_scene",
            "scene_from_dict",
            "Scene",
            "SceneError",
            "Problem",
            "CosseratError",
        ),
    ),
    Concept(
        "model",
        "Model",
        "A scene on a discretisation, as named CasADi functions.",
        ("build", "Model", "discretise", "Discretisation"),
    ),
    Concept(
        "solving",
        "Solving",
        "Equilibria, and discretisations within a tolerance.",
        ("solve", "Solution", "Outcome", "SolveError", "choose", "Choice"),
    ),
    Concept(
        "motion",
        "Motion",
        "What moves: simulation to a tolerance, vibration modes, linear models; see [motion](../motion.md).",
        (
            "simulate",
            "Motion",
            "MotionOutcome",
            "modes_of",
            "Modes",
            "linearise",
            "LinearModel",
        ),
    ),
    Concept(
        "paths",
        "Paths",
        "Equilibria while one input grows; see [paths](../paths.md).",
        ("follow", "EquilibriumPath", "PathOutcome"),
    ),
    Concept(
        "tubes",
        "Concentric tubes",
        "Nested pre-curved tubes that turn and slide; see [concentric tubes](../tubes.md).",
        (
            "all_equilibria",
            "TubeSolution",
            "TubeEquilibria",
            "TubePath",
        ),
    ),
    Concept(
        "sweeps",
        "Sweeps",
        "A scene solved for every row of a table; see [sweeps](../sweeps.md).",
        ("sweep", "read_sweep", "Sweep", "sobol_table", "sobol_indices", "SobolIndices"),
    ),
    Concept(
        "control",
        "Inverse problems and control",
        "Inputs for targets, and rods in optimal-control problems; see [control](../control.md).",
        (
            "inverse",
            "Inverse",
        ),
        (
            "TargetMiss",
            "lifted",
            "Lifted",
            "embedded",
            "relaxed_contact",
            "RelaxedContact",
            "tightened",
            "Tightened",
            "judged",
            "stability_margin",
            "motion_stage",
            "MotionStage",
            "StageEquations",
            "Collocation",
            "radau",
            "gauss",
            "Condensing",
            "Condensed",
            "Horizon",
        ),
        module_names=(
            "codegen.stage.compiled_stage",
            "codegen.motion_stage.compiled_motion_stage",
            "codegen.motion_stage.CompiledMotionStage",
            "motion.section_pairs.TouchingPairs",
            "motion.section_pairs.TouchingSections",
            "codegen.acados.acados_expressions",
            "codegen.acados.write_acados",
        ),
    ),
    Concept(
        "identification",
        "Identification",
        "Numbers of a scene from measurements; see [identify](../identify.md).",
        ("identify", "Identification"),
    ),
    Concept(
        "estimation",
        "Estimation",
        "What a robot feels in every row of a table; see [estimate](../estimate.md).",
        (),
        estimation_names=("estimate", "Estimate"),
    ),
    Concept(
        "export",
        "Export and load",
        "A model as C99, and an exported folder back as CasADi functions; see [C](../c-interface.md). "
        "A solution as a page for [a browser](../view.md), a motion as a file for "
        "[other simulators](../simulators.md).",
        (
            "export",
            "load",
            "Compiled",
            "ExportError",
        ),
        module_names=(
            "codegen.contact.compiled.CompiledContact",
            "codegen.contact.compiled.CompiledContactSolution",
            "codegen.tubes.compiled.CompiledTubes",
            "codegen.compiled_results.CompiledTurn",
            "codegen.compiled_motion.StepState",
            "codegen.compiled_motion.StepMemory",
            "codegen.compiled_motion.StepOptions",
            "codegen.compiled_motion.CompiledStep",
            "codegen.compiled_motion.StepSensitivity",
            "codegen.compiled_motion.LinearMotion",
            "codegen.status.MotionStatus",
            "codegen.fmu.write_fmu",
            "page.page.export_page",
        ),
    ),
    Concept(
        "environments",
        "Environments",
        "A moving robot for reinforcement learning; see [other programs](../simulators.md).",
        (),
        environment_names=("ReachEnvironment",),
    ),
)
"""All pages; every public name is on exactly one."""


def pages() -> dict[str, str]:
    """Text of every page by file name."""
    texts = {f"{concept.file}.md": _page(concept) for concept in CONCEPTS}
    return {"index.md": _contents(), **texts}


def write_pages() -> None:
    """Write the pages, and remove pages of concepts that are no more."""
    FOLDER.mkdir(exist_ok=True)
    texts = pages()
    for page in FOLDER.glob("*.md"):
        if page.name not in texts:
            page.unlink()
    for name, text in texts.items():
        (FOLDER / name).write_text(text)


def _contents() -> str:
    lines = [
        HEADER,
        "",
        "# Python API",
        "",
        "Every public name. What is not listed here is not part of the contract and may change.",
        "",
    ]
    for concept in CONCEPTS:
        names = ", ".join(f"`{name}`" for name in _names(concept))
        lines.append(f"* [{concept.title}]({concept.file}.md): {names}")
    return "\n".join(lines) + "\n"


def _names(concept: Concept) -> tuple[str, ...]:
    """All names of a page."""
    late = [name.rpartition(".")[2] for name in concept.module_names]
    return (*concept.names, *concept.control_names, *concept.environment_names, *concept.estimation_names, *late)


def _page(concept: Concept) -> str:
    parts = [HEADER, f"# {concept.title}", concept.words]
    for name in concept.names:
        parts += _entry(cosserat_casadi, name)
    for name in concept.control_names:
        parts += _entry(cosserat_casadi.control, name)
    for name in concept.environment_names:
        parts += _entry(cosserat_casadi.environments, name)
    for name in concept.estimation_names:
        parts += _entry(cosserat_casadi.estimation, name)
    for place in concept.module_names:
        module, _, name = place.rpartition(".")
        parts += _entry(import_module(f"cosserat_casadi.{module}"), name)
    return "\n\n".join(parts) + "\n"


def _entry(module: ModuleType, name: str) -> list[str]:
    """Heading, signature, docstring and members of a public name, as paragraphs."""
    # A function whose results are kept stands behind its store.
    member = inspect.unwrap(getattr(module, name))
    paragraphs = [f"## {name}", f"`from {module.__name__} import {name}`"]
    if isinstance(member, FunctionType):
        return [*paragraphs, _signature(name, member), *_docstring(member)]
    paragraphs += _with_inherited(member)
    if issubclass(member, Enum):
        return [*paragraphs, _enum_members(member)]
    for member_name, attribute in _own_members(member):
        paragraphs += _class_member(member_name, attribute)
    return paragraphs


def _enum_members(enum: type[Enum]) -> str:
    return "\n".join(f"* `{member.name}`: {member.value}" for member in enum)


def _with_inherited(cls: type) -> list[str]:
    """The docstring of a class as paragraphs; among its attributes are those of its bases."""
    paragraphs = _docstring(cls)
    items: dict[str, str] = {}
    for owner in reversed(_owners(cls)):
        for heading, listed in pairwise(_docstring(owner)):
            if heading == ATTRIBUTES:
                items |= {item.partition(":")[0]: item for item in listed.splitlines()}
    if not items:
        return paragraphs
    if ATTRIBUTES not in paragraphs:
        paragraphs += [ATTRIBUTES, ""]
    paragraphs[paragraphs.index(ATTRIBUTES) + 1] = "\n".join(items.values())
    return paragraphs


def _owners(cls: type) -> list[type]:
    """A class and its bases in this package."""
    return [owner for owner in cls.__mro__ if owner.__module__.startswith("cosserat_casadi")]


def _own_members(cls: type) -> Iterator[tuple[str, Any]]:
    """Public methods and properties of a class and its bases in this package, each once, in the order of the source."""
    seen: set[str] = set()
    for owner in _owners(cls):
        for name, attribute in vars(owner).items():
            if not name.startswith("_") and name not in seen:
                seen.add(name)
                yield name, attribute


def _class_member(name: str, attribute: Any) -> list[str]:
    """Signature and docstring of a method or a property; nothing for fields, which the class documents."""
    if isinstance(attribute, NamedFunction):
        return _named_function(attribute.spec)
    function = _function_of(attribute)
    if function is None or not function.__doc__:
        return []
    if isinstance(attribute, FunctionType | classmethod | staticmethod):
        return [f"### {name}", _signature(name, function), *_docstring(function)]
    returned = inspect.signature(function).return_annotation
    return [f"### {name}", f"`{_annotation(returned)}`, a property.", *_docstring(function)]


def _named_function(spec: FunctionSpec) -> list[str]:
    """A named function of the model, from the table that it is made from."""
    each = "" if spec.owner is Owner.SCENE else f", one for each {spec.owner.value}, by name"
    outputs = "effort, conjugate and derivative by the actuator's own words"
    if not callable(spec.outputs):
        outputs = ", ".join(f"`{out.name}`" + (f" ({out.unit})" if out.unit != "1" else "") for out in spec.outputs)
    return [f"### {spec.name}", f"A `casadi.Function`{each}.", inspect.cleandoc(spec.doc), f"Results: {outputs}."]


def _function_of(attribute: Any) -> FunctionType | None:
    """The function behind a method, a property or a cached property."""
    for name in ("fget", "func", "__func__"):
        function = getattr(attribute, name, None)
        if isinstance(function, FunctionType):
            return function
    if isinstance(attribute, FunctionType):
        return attribute
    return None


# Signatures


def _signature(name: str, function: FunctionType) -> str:
    """A call with its annotations, a parameter a line where it is long; of a function with overloads each of them."""
    calls = [_call(name, overload) for overload in get_overloads(function) or [function]]
    return "```text\n" + "\n\n".join(calls) + "\n```"


def _call(name: str, function: Callable[..., Any]) -> str:
    signature = inspect.signature(function)
    parameters = []
    for parameter in signature.parameters.values():
        if parameter.name in ("self", "cls"):
            continue
        if parameter.kind is parameter.KEYWORD_ONLY and "*" not in parameters:
            parameters.append("*")
        parameters.append(_parameter(parameter))
    returned = _annotation(signature.return_annotation)
    line = f"{name}({', '.join(parameters)}) -> {returned}"
    if len(line) > 100:
        listed = "".join(f"    {parameter},\n" for parameter in parameters)
        line = f"{name}(\n{listed}) -> {returned}"
    return line


def _parameter(parameter: inspect.Parameter) -> str:
    text = f"{parameter.name}: {_annotation(parameter.annotation)}"
    if parameter.default is not parameter.empty:
        text += f" = {parameter.default!r}"
    return text


def _annotation(annotation: object) -> str:
    """An annotation as it is written in the source, without the modules it comes from."""
    text = str(annotation)
    if isinstance(annotation, type):
        text = annotation.__name__
    return re.sub(r"\b(?:[a-z_]\w*\.)+(?=[A-Za-z])", "", text)


# Docstrings in Google's convention

ATTRIBUTES = "**Attributes**"

SECTIONS = ("Args", "Attributes", "Returns", "Yields", "Raises")


def _docstring(documented: Any) -> list[str]:
    """A docstring as paragraphs of Markdown: sections become lists."""
    text = inspect.cleandoc(documented.__doc__ or "")
    paragraphs: list[str] = []
    for paragraph in re.split(r"\n\s*\n", text):
        heading, _, body = paragraph.partition("\n")
        if heading.rstrip(":") in SECTIONS and heading.endswith(":"):
            paragraphs += _section(heading, textwrap.dedent(body))
        else:
            paragraphs.append(_markdown(paragraph))
    return [paragraph for paragraph in paragraphs if paragraph]


def _section(heading: str, body: str) -> list[str]:
    """A section as its name and a list; a section without ``name: description`` stays a sentence."""
    # A line that is not indented begins an entry, an indented one continues it.
    entries = re.sub(r"\n[ ]+", " ", body).splitlines()
    items = []
    for entry in entries:
        name, colon, description = entry.partition(": ")
        if colon and re.fullmatch(r"[\w*., ]+", name):
            items.append(f"* `{name}`: {_markdown(description)}")
        else:
            items.append(f"* {_markdown(entry)}")
    return [f"**{heading.rstrip(':')}**", "\n".join(items)]


def _markdown(text: str) -> str:
    """Roles and double backticks of Sphinx as code."""
    text = re.sub(r":\w+:`~?([^`]+)`", r"`\1`", text)
    return text.replace("``", "`")


if __name__ == "__main__":
    write_pages()
