"""Run times of effects: loads and actuators in compiled C, inertia and damping in CasADi's virtual machine."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import ExitStack, closing
from functools import partial
from math import isfinite

import numpy as np
from rich.console import Console
from rich.markup import escape

from cosserat_casadi import scene as scenes
from cosserat_casadi.cli.reports.format import table_of
from cosserat_casadi.codegen.timed_program import Program, Times, best_time
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.operation_cost import without_load
from cosserat_casadi.model.operations import Count, count
from cosserat_casadi.numerics.progress import StageProgress

TURNS = 5
"""Number of rounds in which all models are timed in turn."""


MotionCost = dict[str, tuple[Count, float]]
"""Scalar operations of functions of a model, and best times of a call in CasADi's virtual machine, µs, by name."""

LABELS = {
    "residual": "residual at rest",
    "jacobian": "residual and Jacobian at rest",
    "inverse_dynamics": "inverse dynamics",
    "dynamics_jacobian": "inverse dynamics with K, C and M",
}
"""Labels of the timed functions of a model: statics, then motion."""

OF_DAMPING = "  of which damping"
"""Label of the time added by damping to the row above."""


def motion_costs(*models: Model) -> list[MotionCost]:
    """Operations and times of models built for a motion, in their order.

    Models are timed in turn, and the best of several rounds counts: other load on the machine affects all alike.
    """
    turns = [[_motion_times(model) for model in models] for _ in range(TURNS)]
    costs = []
    for model, of_model in zip(models, zip(*turns, strict=True), strict=True):
        best = {name: min(times[name] for times in of_model) for name in LABELS}
        costs.append({name: (count(getattr(model, name)), time) for name, time in best.items()})
    return costs


def _motion_times(model: Model) -> dict[str, float]:
    """Times of a model built for a motion, at rest in the unloaded shape: they do not depend on the state."""
    x = model.unloaded()
    inputs = model.pack()
    still = np.zeros(model.size)
    held = np.zeros(model.inputs.size)
    at_rest = (x, inputs)
    in_motion = (x, still, still, inputs, held, held)
    arguments = zip(LABELS, (at_rest, at_rest, in_motion, in_motion), strict=True)
    return {name: best_time(partial(getattr(model, name), *given)) for name, given in arguments}


def effect_times(
    scene: scenes.Scene, compiler: str, progress: StageProgress | None = None
) -> tuple[Times | str, dict[str, Times | str]]:
    """Times of a scene, and of the scene without each load or actuator, by name; a sentence for a failure.

    Args:
        scene: the scene.
        compiler: command of a C compiler.
        progress: called with the current program, the number of compiled programs, and the number of all.
    """
    with ExitStack() as stack:
        # All programs are compiled in parallel; timing starts afterwards.
        whole = stack.enter_context(closing(Program(build(scene), compiler)))
        without = {}
        for cause in scene.causes:
            model = build(without_load(scene, cause.name))
            without[cause.name] = stack.enter_context(closing(Program(model, compiler)))
        programs = (whole, *without.values())
        for done, program in enumerate(programs):
            if progress is not None:
                progress("Compiling the scene with and without each effect", done, len(programs))
            program.wait()
        times_without = {name: compiled.times() for name, compiled in without.items()}
        return whole.times(), times_without


def print_effects(console: Console, rods: Sequence[str], whole: Times | str, parts: Mapping[str, Times | str]) -> None:
    """Print the time that each effect adds to the compiled times, µs.

    Args:
        console: where to print.
        rods: names of the scene's rods; the timed IGM is that of the first one.
        whole: times of the scene; a sentence after a failure.
        parts: times of the scene without each effect, by its name.
    """
    igm = f"IGM of {escape(rods[0])} alone" if len(rods) > 1 else "IGM"
    if isinstance(whole, str):
        console.print(f"Effects were not timed: {escape(whole)}")
        return
    table = table_of("effect", right=(f"{igm}, µs", "residual + Jacobian, µs", "cold solve, µs"))
    table.title = "Time that each effect adds, compiled with -O2"
    table.add_row("the whole scene", f"{whole.igm:.2f}", f"{whole.jacobian:.2f}", f"{whole.cold:.2f}")
    for name, without in parts.items():
        if isinstance(without, str):
            table.add_row(escape(name), "not timed: without it", escape(without), "")
            continue
        # The time of an effect is the difference between both scenes.
        table.add_row(
            escape(name),
            f"{whole.igm - without.igm:+.2f}",
            f"{whole.jacobian - without.jacobian:+.2f}",
            f"{whole.cold - without.cold:+.2f}",
        )
    console.print(table)


def print_motion_times(console: Console, unknowns: int, motion: MotionCost, undamped: MotionCost | None = None) -> None:
    """Print the time that inertia and damping add to a residual and to a Jacobian.

    Args:
        console: where to print.
        unknowns: number of unknowns of the model in motion.
        motion: cost of the model in motion.
        undamped: cost of the model without its damping; None for a scene without damping.
    """
    table = table_of("function", right=("operations", "µs", "over statics"))
    table.title = f"In motion, {unknowns} unknowns, in CasADi's virtual machine (not compiled)"
    for at_rest, moving in (("residual", "inverse_dynamics"), ("jacobian", "dynamics_jacobian")):
        operations, time_at_rest = motion[at_rest]
        table.add_row(LABELS[at_rest], str(operations), compact_number(time_at_rest), "")
        operations, time = motion[moving]
        table.add_row(LABELS[moving], str(operations), compact_number(time), f"{time / time_at_rest:.1f} ×")
        if undamped is not None:
            fewer, shorter = undamped[moving]
            table.add_row(OF_DAMPING, str(operations - fewer), f"{time - shorter:+.2f}", "")
    console.print(table)


def compact_number(value: float) -> str:
    """Text with two decimals for small numbers, none for large numbers."""
    if not isfinite(value):
        return "–"
    if value < 10:
        return f"{value:.2f}"
    if value < 100:
        return f"{value:.1f}"
    return f"{value:,.0f}"
