"""Times that effects cost: of loads and actuators in compiled C, of inertia and damping in CasADi's virtual machine."""

from __future__ import annotations

from contextlib import ExitStack, closing
from dataclasses import dataclass, fields

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.bench.measurement import best_time
from cosserat_casadi.bench.program import Program, Times
from cosserat_casadi.codegen.compiler import Progress
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.operation_cost import MotionPrice, price_of_motion, without_load

TURNS = 5
"""Times that each model is timed beside others."""


@dataclass(frozen=True)
class MotionTimes:
    """Best times of a call in CasADi's virtual machine, µs.

    Attributes:
        residual: of statics.
        jacobian: of statics, with the residual.
        inverse_dynamics: residual of the equations of motion.
        dynamics_jacobian: that with its derivatives with positions, velocities and accelerations.
    """

    residual: float
    jacobian: float
    inverse_dynamics: float
    dynamics_jacobian: float


@dataclass(frozen=True)
class MotionCost:
    """Times of the equations of motion of a model.

    Attributes:
        price: their scalar operations.
        times: of a call, of the equations of statics too.
    """

    price: MotionPrice
    times: MotionTimes


def motion_costs(*models: Model) -> list[MotionCost]:
    """Operations and times of models built for a motion, in their order.

    They are timed in turn, and the best of several turns counts: what else the machine does comes to all of them.
    """
    turns = [[motion_times(model) for model in models] for _ in range(TURNS)]
    costs = []
    for model, of_model in zip(models, zip(*turns, strict=True), strict=True):
        best = {entry.name: min(getattr(times, entry.name) for times in of_model) for entry in fields(MotionTimes)}
        costs.append(MotionCost(price_of_motion(model), MotionTimes(**best)))
    return costs


def motion_times(model: Model) -> MotionTimes:
    """Times of a model built for a motion, at rest in the unloaded shape: they are the same everywhere."""
    x = model.unloaded()
    inputs = model.pack()
    still = np.zeros(model.size)
    held = np.zeros(model.inputs.size)
    in_motion = (x, still, still, inputs, held, held)
    return MotionTimes(
        residual=best_time(lambda: model.residual(x, inputs)),
        jacobian=best_time(lambda: model.jacobian(x, inputs)),
        inverse_dynamics=best_time(lambda: model.inverse_dynamics(*in_motion)),
        dynamics_jacobian=best_time(lambda: model.dynamics_jacobian(*in_motion)),
    )


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
