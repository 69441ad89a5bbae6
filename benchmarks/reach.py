"""How many steps a second the environment of Gymnasium takes: control periods, and steps of the integrator in them."""

from __future__ import annotations

import argparse
import time

from cosserat_casadi import read_scene
from cosserat_casadi.environments import ReachEnvironment


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scene", default="examples/finger_to_point.toml")
    parser.add_argument("--modes", type=int, default=3)
    parser.add_argument("--periods", type=int, default=500)
    chosen = parser.parse_args()
    scene = read_scene(chosen.scene, [f"accuracy.modes={chosen.modes}", "accuracy.nodes=8"])
    environment = ReachEnvironment(scene)
    environment.action_space.seed(0)
    environment.reset(seed=0)
    ended = 0
    began = time.perf_counter()
    for _ in range(chosen.periods):
        _, _, terminated, truncated, _ = environment.step(environment.action_space.sample())
        if terminated or truncated:
            ended += int(terminated)
            environment.reset()
    spent = time.perf_counter() - began
    steps = round(environment.period / environment.dt)
    print(f"{environment.model.size} unknowns, {steps} steps of {1e3 * environment.dt:g} ms in each control period")
    print(f"{chosen.periods / spent:.0f} periods a second, {chosen.periods * steps / spent:.0f} steps a second")
    print(
        f"{chosen.periods * environment.period / spent:.1f} times real time; {ended} episodes could not be computed on"
    )


if __name__ == "__main__":
    main()
