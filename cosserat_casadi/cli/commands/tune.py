"""``cosserat tune``."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Annotated

import typer
from rich.progress import TimeRemainingColumn

from cosserat_casadi.accuracy.choose import SAMPLES, SAMPLES_IN_CONTACT, Choice, choose
from cosserat_casadi.accuracy.common_modes import Values
from cosserat_casadi.accuracy.fixing import unfixed
from cosserat_casadi.accuracy.ranges import Given
from cosserat_casadi.cli.exit_codes import NOT_FOUND
from cosserat_casadi.cli.options import Ranges, SceneFile, Settings, asked_cases, asked_ranges, check_files
from cosserat_casadi.cli.progress import count_display
from cosserat_casadi.cli.reports.model import discretisation_table, print_choice
from cosserat_casadi.cli.terminal import Console
from cosserat_casadi.errors import Problem, SceneError, collect_problems
from cosserat_casadi.files import write_atomically
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.load_cases import case_layout
from cosserat_casadi.scene import Scene, read_scene
from cosserat_casadi.scene.writing import scene_text


def tune(
    scene: SceneFile,
    output: Annotated[Path, typer.Option(help="Write the scene with its discretisation fixed (TOML) here.")],
    tolerance: Annotated[float | None, typer.Option(help="Wanted error of tip poses; by default the scene's.")] = None,
    over: Annotated[Path | None, typer.Option(help="Load cases: a grid (TOML), or rows (CSV).")] = None,
    ranges: Ranges = None,
    samples: Annotated[
        int | None,
        typer.Option(
            min=1,
            max=100_000,
            help=f"Random corners, and random points: {SAMPLES}; in contact and beside wires {SAMPLES_IN_CONTACT}.",
            show_default=False,
        ),
    ] = None,
    settings: Settings = None,
) -> None:
    """Find one discretisation for ranges of inputs, or for load cases. Exit codes: 0 written, 2 refused, 3 not met.

    Inputs without --range take theirs of the scene, its [ranges] or [[bounds]], or a range of their scale.
    """
    problems: list[Problem] = []
    check_files({"--output": output}, scene, settings, problems, over, output_suffix=".toml")
    tuned_scene: Scene | None = None
    cases: FloatArray | None = None
    given_ranges: Given = {}
    with collect_problems(problems):
        tuned_scene = read_scene(scene, tuple(settings or ()))
        cases = asked_cases(over, ranges, tuned_scene)
        given_ranges = {} if cases is not None else asked_ranges(ranges, tuned_scene)
    if problems or tuned_scene is None:
        raise SceneError(*problems)
    layout = case_layout(tuned_scene)
    free = unfixed(tuned_scene, tuned_scene.accuracy.tolerance if tolerance is None else tolerance)
    if cases is None:
        choice = choose_with_progress(free, given_ranges, samples)
    else:
        choice = choose_with_progress(free, cases=[layout.unpack(case) for case in cases])
    Console().print(discretisation_table(choice.model))
    print_choice(Console(), choice)
    # A scene that misses the tolerance is not written, so that it is not taken for one that meets it.
    if not choice.met:
        raise typer.Exit(NOT_FOUND)
    write_atomically(output, scene_text(choice.scene).encode())
    Console().print(f"wrote {output}")


def choose_with_progress(
    scene: Scene, ranges: Given | None = None, samples: int | None = None, cases: Sequence[Values] | None = None
) -> Choice:
    """One discretisation for ranges or for load cases; see :func:`cosserat_casadi.accuracy.choose.choose`."""
    stage = "Choosing modes and nodes"
    with count_display(stage, TimeRemainingColumn()) as show_count:
        return choose(scene, ranges, progress=partial(show_count, stage), samples=samples, cases=cases)
