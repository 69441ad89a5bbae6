"""Time that each effect of a scene costs: the compiled scene with it, and without it."""

from __future__ import annotations

from contextlib import ExitStack, closing

from cosserat_casadi import scene as scenes
from cosserat_casadi.bench.program import Program, Times
from cosserat_casadi.codegen.compiler import Progress
from cosserat_casadi.model.build import build
from cosserat_casadi.model.operation_cost import without_load


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
