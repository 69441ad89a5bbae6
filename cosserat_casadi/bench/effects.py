"""What each effect of a scene costs in time: the compiled scene with it, and without it."""

from __future__ import annotations

from contextlib import ExitStack, closing

from cosserat_casadi import scene as scenes
from cosserat_casadi.bench.program import Program, Times
from cosserat_casadi.model.build import build
from cosserat_casadi.model.price import without_load


def effect_times(scene: scenes.Scene, compiler: str) -> tuple[Times | str, dict[str, Times | str]]:
    """Times of a scene, and of the scene without each of its loads and actuators by name; a sentence where one fails.

    Args:
        scene: the scene.
        compiler: path of a C compiler.
    """
    with ExitStack() as stack:
        whole = stack.enter_context(closing(Program(build(scene), compiler)))
        # The compiler works on all of them at once; nothing is timed until it is done.
        parts = {
            cause.name: stack.enter_context(closing(Program(build(without_load(scene, cause.name)), compiler)))
            for cause in scene.causes
        }
        for program in (whole, *parts.values()):
            program.wait()
        return whole.times(), {name: program.times() for name, program in parts.items()}
