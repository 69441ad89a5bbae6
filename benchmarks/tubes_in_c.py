"""What concentric tubes take in C: a turn of a control loop, with and without derivatives, and compilation.

python benchmarks/tubes_in_c.py
"""

from __future__ import annotations

import json
import resource
import subprocess
import tempfile
from pathlib import Path

from cosserat_casadi import export, parse_scene, read_scene
from cosserat_casadi.compiling.compiler import find_compiler
from cosserat_casadi.scene import Scene
from cosserat_casadi.tubes.tube_solve import solve_tubes

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"

THIRD = """
[[tubes]]
name = "innermost"
material = { youngs_modulus = 6.0e10, poisson_ratio = 0.33 }
section = { outer_radius = 0.55e-3, inner_radius = 0.30e-3 }
straight = 0.25
curved = 0.15
curvature = 25.0
rotation = 1.0
translation = 0.27
"""

TIMES = ("turn_us", "turn_with_derivatives_us", "poses_us", "cold_us")


def scenes() -> dict[str, Scene]:
    """What is timed, by what it is."""
    plain = (EXAMPLES / "concentric_tubes.toml").read_text(encoding="utf-8")
    return {
        "two tubes": parse_scene(plain),
        "three tubes": parse_scene(plain + THIRD),
        "two tubes, a force and weight": read_scene(EXAMPLES / "loaded_tubes.toml"),
    }


def row(what: str, scene: Scene, folder: Path) -> str:
    """A row of the table."""
    export(solve_tubes(scene).model, folder, "robot")
    sources = ["robot_demo.c", "robot.c", "robot_kernels.c"]
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    command = [find_compiler(), "-O2", "-std=c99", *sources, "-lm", "-o", "demo"]
    subprocess.run(command, cwd=folder, check=True)
    compiling = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    # The best of several runs: another process may have the core.
    runs = [
        json.loads(subprocess.run(["./demo"], cwd=folder, check=True, capture_output=True, text=True).stdout)
        for _ in range(5)
    ]
    times = [min(run[word] for run in runs) for word in TIMES]
    size = sum((folder / file).stat().st_size for file in sources) / 1000
    cells = [what, *[f"{time:.0f}" for time in times], f"{compiling:.1f}", f"{size:.0f}"]
    return f"| {' | '.join(cells)} |"


HEADINGS = ("robot", "a turn", "with derivatives", "poses alone", "from straight tubes", "gcc -O2, s", "sources, kB")


def main() -> None:
    print(f"| {' | '.join(HEADINGS)} |")
    print("|" + " --- |" * len(HEADINGS))
    for what, scene in scenes().items():
        with tempfile.TemporaryDirectory() as folder:
            print(row(what, scene, Path(folder) / "robot"), flush=True)


if __name__ == "__main__":
    main()
