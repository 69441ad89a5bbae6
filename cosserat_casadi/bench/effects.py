"""Times that effects cost: of loads and actuators in compiled C, of inertia and damping in CasADi's virtual machine."""

from __future__ import annotations

from contextlib import ExitStack, closing
from functools import partial

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.bench.measurement import best_time
from cosserat_casadi.bench.program import Program, Times
from cosserat_casadi.codegen.compiler import Progress
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.operation_cost import without_load
from cosserat_casadi.model.operations import Count, count

TURNS = 5
"""Times that each model is timed beside others."""


MotionCost = dict[str, tuple[Count, float]]
"""Scalar operations of functions of a model, and best times of a call in CasADi's virtual machine, µs, by name."""

FUNCTIONS = ("residual", "jacobian", "inverse_dynamics", "dynamics_jacobian")
"""Functions of a model that are timed: residual of statics, that with its Jacobian, and the same of a motion."""


def motion_costs(*models: Model) -> list[MotionCost]:
    """Operations and times of models built for a motion, in their order.

    They are timed in turn, and the best of several turns counts: what else the machine does comes to all of them.
    """
    turns = [[_motion_times(model) for model in models] for _ in range(TURNS)]
    costs = []
    for model, of_model in zip(models, zip(*turns, strict=True), strict=True):
        best = {name: min(times[name] for times in of_model) for name in FUNCTIONS}
        costs.append({name: (count(getattr(model, name)), time) for name, time in best.items()})
    return costs


def _motion_times(model: Model) -> dict[str, float]:
    """Times of a model built for a motion, at rest in the unloaded shape: they are the same everywhere."""
    x = model.unloaded()
    inputs = model.pack()
    still = np.zeros(model.size)
    held = np.zeros(model.inputs.size)
    at_rest = (x, inputs)
    in_motion = (x, still, still, inputs, held, held)
    arguments = zip(FUNCTIONS, (at_rest, at_rest, in_motion, in_motion), strict=True)
    return {name: best_time(partial(getattr(model, name), *given)) for name, given in arguments}


def effect_times(
    scene: scenes.Scene, compiler: str, progress: Progress | None = None
) -> tuple[Times | str, dict[str, Times | str]]:
    """Times of a scene, and of the scene without each of its loads and actuators by name; a sentence where one fails.

    Args:
        scene: the scene.
        compiler: command of a C compiler.
        progress: told the program that is compiled, how many programs are, and of how many.
    """
    with ExitStack() as stack:
        # The compiler works on all of them at once; nothing is timed until it is done.
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
