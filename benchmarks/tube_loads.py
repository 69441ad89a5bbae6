"""What loads on concentric tubes cost: processor time of functions with loads, over that without, with as many steps.

python benchmarks/tube_loads.py
"""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np

from cosserat_casadi import read_scene
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.tubes.loaded_model import LoadedTubeModel
from cosserat_casadi.tubes.robot import robot_of
from cosserat_casadi.tubes.tube_functions import TubeFunctions
from cosserat_casadi.tubes.tube_solve import solve_at

SCENE = Path(__file__).resolve().parents[1] / "examples" / "loaded_tubes.toml"

STEPS = 4

CALLS = 50


def seconds(model: TubeFunctions, name: str, x: FloatArray) -> float:
    """Processor time of one call of a function, the least of three means, s."""
    function = getattr(model, name)
    means = []
    for _ in range(3):
        start = time.process_time()
        for _ in range(CALLS):
            function(x, model.robot.inputs)
        means.append((time.process_time() - start) / CALLS)
    return float(np.min(means))


def main() -> None:
    robot = robot_of(read_scene(SCENE))
    model = LoadedTubeModel(robot, STEPS)
    x = solve_at(model, robot.inputs).x
    print("function      without, ms   with, ms   ratio")
    for name in ("residual", "jacobian", "variations", "tips"):
        without = seconds(model.without_loads, name, x[: robot.size])
        loaded = seconds(model, name, x)
        print(f"{name:12} {1e3 * without:12.3f} {1e3 * loaded:10.3f} {loaded / without:7.1f}")


if __name__ == "__main__":
    main()
