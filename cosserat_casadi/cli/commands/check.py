"""``cosserat check``."""

from __future__ import annotations

from typing import Annotated

import typer
from rich.console import Console

from cosserat_casadi.bench.effects import effect_times
from cosserat_casadi.bench.table import print_effects
from cosserat_casadi.cli.options import SceneFile, Settings
from cosserat_casadi.cli.progress import count_reporter, progress_bar
from cosserat_casadi.cli.reports.model import print_check
from cosserat_casadi.codegen.compiled import find_compiler
from cosserat_casadi.model.build import build
from cosserat_casadi.scene import Scene, read_scene


def check(
    scene: SceneFile,
    settings: Settings = None,
    timed: Annotated[bool, typer.Option("--time", help="Price each effect in compiled microseconds too.")] = False,
) -> None:
    """Validate a scene, say which effects were chosen and what the model and each effect will cost."""
    checked_scene = read_scene(scene, tuple(settings or ()))
    if timed:
        # A compiler that is missing is reported before anything is printed.
        find_compiler()
    print_check(Console(), build(checked_scene))
    if timed:
        _print_times(checked_scene)


def _print_times(scene: Scene) -> None:
    with progress_bar() as bar:
        show_count = count_reporter(bar, "Building the scene without each effect")
        whole, parts = effect_times(scene, find_compiler(), show_count)
    rods = [rod.name for rod in scene.rods]
    print_effects(Console(), rods, whole, parts)
