"""The page of the functions in C, from the table of functions and the header of an exported folder."""

from __future__ import annotations

import re
from pathlib import Path

from cosserat_casadi.model.build import Model
from cosserat_casadi.model.function_table import FunctionSpec, Owner, table

HEADER = Path(__file__).resolve().parents[2] / "generated" / "nitinol_wire" / "nitinol_wire.h"

WORDS = """# Every function in C

[From C](c-interface.md) says how a folder is exported, compiled and used. `NAME` stands for the name of the scene,
*owner* for that of a rod, an actuator or a body.

## The model

Made from the table that the members of [`Model`](api/model.md) are made from. What there is one of for each rod,
actuator or body bears the name of its owner: `NAME_shape_wire`. Arguments are pointers to arrays, single numbers are
passed by value; `NAME.h` has the prototypes."""

DECLARATION = re.compile(
    r"(?:/\* ((?:(?!\*/).)*?) \*/\n(?:#define[^\n]*\n)?)?((?:^[a-z][\w *]*\([^;]*;\n)+)", flags=re.DOTALL | re.MULTILINE
)
"""Prototypes of the header, with the comment above them where they have one."""


def functions_page() -> str:
    """The page: the functions of the table, then the solver as the header of the wire declares it."""
    public = [spec for spec in table(Model) if spec.public]
    rows = ["| function | one for each | arguments | results | |", "|---|---|---|---|---|", *map(_row, public)]
    solver = ["## The solver", "As the header of the exported folder of `examples/nitinol_wire.toml` declares it."]
    declarations = [_declared(comment, prototypes) for comment, prototypes in _declarations(public)]
    return "\n\n".join([WORDS, "\n".join(rows), *solver, *declarations]) + "\n"


def _row(spec: FunctionSpec) -> str:
    each = "" if spec.owner is Owner.SCENE else spec.owner.value
    arguments = ", ".join(f"`{name}`" for name in spec.arguments)
    results = "effort, conjugate and derivative"
    if not callable(spec.outputs):
        outputs = spec.outputs[: spec.kernel_outputs]
        results = ", ".join(f"`{out.name}`" + (f" ({out.unit})" if out.unit != "1" else "") for out in outputs)
    meaning = spec.header.format(owner="*owner*")
    return f"| `NAME_{spec.name_in_c}` | {each} | {arguments} | {results} | {meaning} |"


def _declarations(public: list[FunctionSpec]) -> list[tuple[str, str]]:
    """Comments and prototypes of the header, without those of the table."""
    found = DECLARATION.findall(HEADER.read_text())
    tabled = tuple(f"nitinol_wire_{spec.name_in_c}" for spec in public)
    return [(comment, text) for comment, text in found if not any(name in text for name in tabled)]


def _declared(comment: str, prototypes: str) -> str:
    paragraphs = re.sub(r"\n {2,}", "\n", comment)
    return f"```c\n{prototypes.rstrip()}\n```\n\n{paragraphs}".rstrip()
