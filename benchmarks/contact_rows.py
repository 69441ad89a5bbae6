"""What a row in contact costs in Python beside one from the unloaded scene, in C, and a path with its events.

Processor time: a machine that does other work meanwhile gives the same. Rows are of `examples/rod_over_bar.toml` on 5
modes, each from the contacts of the row before it; the path is that of its push.
"""

from __future__ import annotations

import argparse
import resource
import time
from pathlib import Path

import numpy as np

from cosserat_casadi import Scene, build, follow, read_scene
from cosserat_casadi.codegen.contact.rows import contact_row_library
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.scene.writing import scene_text
from cosserat_casadi.sweeps.row_model import RowModel
from cosserat_casadi.sweeps.work import COMPILED_ROWS, LibraryWithPython

EXAMPLE = Path(__file__).parents[1] / "examples" / "rod_over_bar.toml"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rows", type=int, default=32)
    options = parser.parse_args()
    scene = read_scene(EXAMPLE, ["accuracy.modes=5", "inputs=['push.force']"])
    rows = RowModel(scene_text(scene), estimate_errors=True)
    pushes = np.zeros((options.rows, 3))
    pushes[:, 2] = np.linspace(-0.5, -2.0, options.rows)
    # The first row makes the functions of the obstacle, and is solved from the unloaded scene.
    first = time.process_time()
    rows.solve(pushes[:1])
    alone = time.process_time() - first
    begun = time.process_time()
    rows.solve(pushes)
    each = (time.process_time() - begun - alone) / (options.rows - 1)
    print(f"from the unloaded scene {alone:.2f} s, from the row before {each:.2f} s: {1 / each:.1f} rows a second")
    cases = pushes[:: options.rows // 4]
    in_c("pushes", scene, cases, ([-0.2, -0.2, -2.0], [0.2, 0.2, -0.1]))
    named = scene.model_copy(update={"parameters": ("rod.stiffness.torsion",)})
    own = build(named).parameters.pack()
    own_cases = np.hstack([cases, np.full((len(cases), 1), own)])
    in_c("pushes and stiffnesses", named, own_cases, ([-0.2, -0.2, -2.0, 0.9 * own[0]], [0.2, 0.2, -0.1, 1.1 * own[0]]))
    begun = time.process_time()
    path = follow(build(scene), "push.force", [0.0, 0.0, -2.0])
    events = ", ".join(f"{event.kind} at {event.factor:.6f}" for event in path.events)
    print(f"a path of {len(path.factor)} points with its events ({events}): {time.process_time() - begun:.1f} s")


def in_c(what: str, scene: Scene, cases: FloatArray, ends: tuple[list[float], list[float]]) -> None:
    """Print what rows cost in C, whose inputs and parameters are drawn between two ends."""
    begun = time.process_time() + _of_compilers()
    library = contact_row_library(build(scene), cases, estimate_errors=True)
    library.compiled()
    compiled = time.process_time() + _of_compilers() - begun
    python = RowModel(scene_text(scene), estimate_errors=True)
    answer = LibraryWithPython(library, python, in_contact=True)
    many = np.random.default_rng(1).uniform(*ends, (COMPILED_ROWS, len(ends[0])))
    begun = time.process_time()
    ended = answer.solve(many)[:, 0]
    each = (time.process_time() - begun) / len(many)
    converged = f"{np.count_nonzero(ended == 0)} of {len(many)} converged"
    print(f"{what}: a library after {compiled:.0f} s, {1e3 * each:.2f} ms a row: {1 / each:.0f} a second, {converged}")


def _of_compilers() -> float:
    """Processor time of compilers until now, s."""
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime


if __name__ == "__main__":
    main()
