"""What a compiled stage of an optimal-control problem takes: C and time of the compiler, with and without curvature."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from doc_tables import table

from cosserat_casadi import Model, read_scene
from cosserat_casadi.accuracy.refine import solve_rods
from cosserat_casadi.codegen.stage import stage_functions
from cosserat_casadi.compiling.compiler import compiled_texts, find_compiler
from cosserat_casadi.compiling.printed_files import external_sources

SCENE = "examples/two_section_robot.toml"
TOLERANCES = (1e-3, 1e-6)
"""What the example of predictive control plans with, and what its robot moves by."""


def size_and_seconds(model: Model, curvature: bool) -> tuple[int, float]:
    """Bytes of C, and processor seconds of the compiler."""
    texts: dict[str, str] = {}
    for function in stage_functions(model, "stage", curvature):
        texts |= external_sources([function], function.name(), "long long int")
    before = os.times()
    with tempfile.TemporaryDirectory() as folder:
        # A cache of its own: what was compiled before is compiled again.
        os.environ["COSSERAT_CASADI_CACHE"] = str(Path(folder) / "cache")
        compiled_texts("stage", texts, find_compiler(None))
        after = os.times()
    spent = after.children_user + after.children_system - before.children_user - before.children_system
    return sum(map(len, texts.values())), spent


def main() -> None:
    """Print both for each tolerance."""
    rows = []
    for tolerance in TOLERANCES:
        model = solve_rods(read_scene(SCENE, [f"accuracy.tolerance={tolerance}"])).model
        for words, curvature in (("exact", True), ("none", False)):
            size, seconds = size_and_seconds(model, curvature)
            rows.append((f"{tolerance:.0e}", str(model.size), words, f"{size / 1e6:.2f} MB", f"{seconds:.1f} s"))
    print(table(("tolerance", "unknowns", "second derivatives", "C", "processor time of the compiler"), rows))


if __name__ == "__main__":
    main()
