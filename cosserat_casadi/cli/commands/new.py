"""``cosserat new``."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from cosserat_casadi.cli.reports.format import print_written
from cosserat_casadi.cli.terminal import Console
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.files import check_writable, write_atomically

TEMPLATES = Path(__file__).resolve().parents[1] / "templates"


class Template(StrEnum):
    """Template scenes, each a file of the folder ``templates``."""

    WIRE = "wire"
    TENDON_ROBOT = "tendon-robot"
    PARALLEL_ROBOT = "parallel-robot"


def new(
    scene: Annotated[Path, typer.Argument(metavar="SCENE", help="Scene file (TOML) to write.", show_default=False)],
    template: Annotated[
        Template, typer.Option(help="Template to begin with: wire, tendon-robot or parallel-robot.")
    ] = Template.WIRE,
) -> None:
    """Write a scene with comments, to begin with. Exit codes: 0 written, 2 refused."""
    if scene.exists():
        raise SceneError(Problem("SCENE", f"{scene} exists already", "nothing is overwritten: name another file"))
    check_writable(scene, "SCENE")
    write_atomically(scene, (TEMPLATES / f"{template.value}.toml").read_bytes())
    console = Console()
    print_written(console, [scene], soft_wrap=True)
    console.print(f"Solve it: cosserat solve {escape(str(scene))} --plot picture.png", soft_wrap=True)
