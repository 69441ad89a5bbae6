"""Told errors of free rods that are thrown on a floor with friction, beside the true ones.

Random rods are computed with ever shorter equal steps. A motion with twice the step and one before it, and the missing
energy, tell the error as a search does; so does a motion with half the step, as with a given step. The shortest steps
have the true one. Printed are true errors over told ones, and told ones over true ones.

    python benchmarks/thrown_rods.py [--rods 100]
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np

from cosserat_casadi import build, scene_from_dict
from cosserat_casadi.motion.motion_compiler import MotionCompiler
from cosserat_casadi.motion.simulate import Simulator, started
from cosserat_casadi.motion.tip_paths import path_distance

LENGTH = 0.4
"""m."""

HALVINGS = 6
"""Of the first step, a fiftieth of the duration."""

RESOLVED = 3.0
"""True errors over the distance of the last two motions, from which on they count."""

LEAST = 1e-6
"""Least true error that counts, over the length."""


def random_scene(seed: int) -> dict[str, Any]:
    """A rod in the plane or in space that is thrown on a floor."""
    random = np.random.default_rng(seed)
    in_space = seed % 3 == 0
    tilt, turn = random.uniform(-1.2, 1.2), random.uniform(-1, 1) if in_space else 0.0
    tangent = [np.cos(tilt) * np.cos(turn), np.cos(tilt) * np.sin(turn), np.sin(tilt)]
    radius = random.uniform(4e-3, 1e-2)
    height = radius + random.uniform(1e-3, 0.03) + max(0.0, -LENGTH * tangent[2])
    stiff = 10.0 ** random.uniform(6.5, 8.5)
    rod: dict[str, Any] = {
        "name": "rod",
        "length": LENGTH,
        "strain": "kirchhoff" if in_space else "planar",
        "material": {"youngs_modulus": stiff, "poisson_ratio": 0.48, "density": 1100.0},
        "section": {"shape": "circle", "radius": radius},
        "base": {"position": [0, 0, height], "tangent": tangent, "free": True},
    }
    if random.random() < 0.7:
        rod["damping"] = {"retardation_time": 10.0 ** random.uniform(-4, -2.5)}
    across = random.uniform(-1, 1)
    linear = [across, random.uniform(-0.5, 0.5) if in_space else 0.0, random.uniform(-1.5, 0)]
    angular = [0.0, random.uniform(-8, 8), random.uniform(-5, 5) if in_space else 0.0]
    floor: dict[str, Any] = {"name": "floor", "kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}
    floor |= {"friction": random.uniform(0.02, 0.7), "restitution": float(random.choice([0.0, 0.0, 0.3, 0.7]))}
    duration = random.uniform(0.08, 0.16)
    return {
        "schema": 1,
        "accuracy": {"modes": int(random.integers(2, 4)), "nodes": 10, "tolerance": 3e-3},
        "rods": [rod],
        "velocities": [{"rod": "rod", "linear": linear, "angular": angular}],
        "loads": [{"name": "weight", "kind": "gravity", "acceleration": [0, 0, -9.81]}],
        "obstacles": [floor],
        "simulation": {"duration": duration, "frames": 41, "start": "unloaded"},
    }


def compared(seed: int) -> Iterator[tuple[float, float, float]]:
    """True errors of a rod's motions, and those told by steps twice as long (nan without a third motion) and half."""
    model = build(scene_from_dict(random_scene(seed)).with_motion_inputs(), moving=True).at().in_motion
    simulation = model.scene.simulation
    assert simulation is not None
    own = Simulator(model, simulation, started(model, simulation, None), source=MotionCompiler(always=True))
    sizes = [simulation.duration / 50.0 / 2**halving for halving in range(HALVINGS + 1)]
    histories = [history for history in map(own.stepped, sizes) if history.completed]
    if len(histories) < len(sizes):
        return
    paths = [own.paths(history) for history in histories]
    apart = [path_distance(one, other) for one, other in pairwise(paths)]
    for k, history in enumerate(histories[: HALVINGS - 1]):
        true = path_distance(paths[k], paths[-1])
        if true < max(RESOLVED * apart[-1], LEAST):
            continue
        half = own.fall.error(history, paths[k], own.fall.factor(history, histories[k + 1]) * apart[k], 0.0)
        twice = np.nan
        if k > 1:
            left = own.fall.factor(history, histories[k - 1])
            twice = own.fall.error(history, paths[k], left * apart[k - 1], left * apart[k - 2])
        yield true, twice, half


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rods", type=int, default=100)
    rows = np.array([row for seed in range(parser.parse_args().rods) for row in compared(seed)])
    for name, told in (("steps twice as long", rows[:, 1]), ("half the steps", rows[:, 2])):
        known = np.isfinite(told)
        shares = rows[known, 0] / told[known]
        print(f"told by {name}: {len(shares)} motions; true over told: most {shares.max():.2f}", end="; ")
        print(f"told over true: median {np.median(1.0 / shares):.1f}; {np.sum(shares > 1.0)} told below the true one")


if __name__ == "__main__":
    main()
