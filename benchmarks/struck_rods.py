"""Told errors of the steps of rods that are struck, beside the true ones: random rods on floors and bars.

Each is computed on few modes with ever smaller tolerances of a step. Two motions whose tolerances are ten times apart,
and three, tell the error of the last one as a search does; a far more exact motion has the true one. Printed are the
told errors over the true ones, of motions with the same impacts and of others.

    python benchmarks/struck_rods.py [--rods 100]
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from cosserat_casadi import build, scene_from_dict
from cosserat_casadi.errors import SceneError
from cosserat_casadi.motion.fall_of_errors import impacts_of
from cosserat_casadi.motion.simulate import (
    TIGHTER,
    Simulator,
    TimedHistory,
    are_struck_alike,
    started,
)
from cosserat_casadi.motion.tip_paths import path_distance

LENGTH = 0.4
"""m."""

MATERIALS = (
    (2e6, 1100.0, 8e-3),
    (5e6, 1100.0, 8e-3),
    (2e7, 1100.0, 8e-3),
    (5e8, 1100.0, 8e-3),
    (7e10, 2700.0, 3e-3),
    (2e11, 7800.0, 4e-3),
)
"""Young's moduli, Pa, densities, kg/m³, and radii, m."""

DAMPING = (0.0, 1e-3, 1e-2, 0.05, 0.2)
"""Damping ratios of the first mode of a cantilever."""

FIRST = (1e-2, 10.0**-2.5, 1e-3)
"""Tolerances of a step of the first motions."""

EXACT = 1e-6
"""Of the far more exact motion; one ten times as coarse tells how exact that is."""

RESOLVED = 3.0
"""True errors over what the exact motion may err by, from which on they count."""

MOST_IMPACTS = 15
"""Rods with more of them are left out: each motion takes minutes."""


def random_scene(seed: int) -> dict[str, Any]:
    """A rod that falls on a floor or a bar, held at its base or free."""
    draw = np.random.default_rng(seed)
    modulus, density, radius = MATERIALS[draw.integers(len(MATERIALS))]
    frequency = 3.5 / LENGTH**2 * np.sqrt(modulus * radius**2 / 4.0 / density)
    ratio = DAMPING[draw.integers(len(DAMPING))]
    free = bool(draw.integers(2))
    bounces = {"restitution": 0.5} if draw.random() < 0.35 else {}
    rod: dict[str, Any] = {
        "name": "rod",
        "length": LENGTH,
        "strain": "planar" if draw.random() < 0.8 else "kirchhoff",
        "material": {"youngs_modulus": modulus, "poisson_ratio": 0.3, "density": density},
        "section": {"shape": "circle", "radius": radius},
        "base": {"position": [0, 0, 0], "tangent": [1, 0, 0], "free": free},
    }
    if ratio:
        rod["damping"] = {"retardation_time": float(2.0 * ratio / frequency)}
    place = float(draw.uniform(0.1, 0.39))
    if free:
        depth = float(draw.uniform(0.08, 0.2))
        duration = 1.8 * np.sqrt(2.0 * depth / 9.81)
        rod["base"]["tangent"] = [1, 0, float(draw.uniform(-0.4, 0.4))]
    else:
        sag = min(0.3, density * 9.81 * LENGTH**3 / (modulus * radius**2 / 4.0) / 8.0) * LENGTH
        depth = float(sag * (place / LENGTH) ** 2 * draw.uniform(0.2, 1.2))
        duration = min(0.4, 5.0 * np.pi / frequency)
    if draw.random() < 0.5:
        obstacle = {"kind": "plane", "point": [0, 0, -depth - radius], "normal": [0, 0, 1]}
    else:
        height = -0.03 - depth - radius
        obstacle = {"kind": "capsule", "from": [place, -0.1, height], "to": [place, 0.1, height], "radius": 0.03}
    modes = int(draw.integers(3, 7))
    return {
        "schema": 1,
        "accuracy": {"modes": modes, "nodes": modes + 6},
        "rods": [rod],
        "loads": [{"name": "weight", "kind": "gravity", "acceleration": [0, 0, -9.81]}],
        "obstacles": [{"name": "obstacle", **obstacle, **bounces}],
        "simulation": {"duration": float(duration), "frames": 2, "start": "unloaded"},
    }


@dataclass(frozen=True)
class Row:
    """An error that was told.

    Attributes:
        motions: number of motions that told it.
        alike: whether they have the same impacts.
        told: over the true one.
    """

    motions: int
    alike: bool
    told: float


def rows_of(seed: int) -> Iterator[Row]:
    """Errors told of one rod; none where it cannot start there, or strikes too often."""
    scene = scene_from_dict(random_scene(seed)).with_motion_inputs()
    model = build(scene, moving=True)
    assert scene.simulation is not None
    simulator = Simulator(model, scene.simulation, started(model, scene.simulation, None))
    starts = [TimedHistory(simulator.controlled(first), float("nan"), first) for first in FIRST]
    if not all(0 < impacts_of(start.history) <= MOST_IMPACTS for start in starts):
        return
    finest = [simulator.controlled(tolerance) for tolerance in (EXACT, TIGHTER * EXACT)]
    if not all(history.completed for history in finest):
        return
    exact, nearly = map(simulator.paths, finest)
    uncertain = path_distance(exact, nearly)
    for timed in starts:
        alike = True
        for motions in (2, 3):
            finer = simulator.finer(timed, TIGHTER)
            alike = alike and are_struck_alike(finer.history, timed.history)
            timed = finer
            if not timed.history.completed:
                break
            error = path_distance(simulator.paths(timed.history), exact)
            if error > RESOLVED * uncertain:
                yield Row(motions, alike, timed.error / error)


def main() -> None:
    """Print quantiles of told errors over true ones."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rods", type=int, default=100, help="number of random rods")
    rows: list[Row] = []
    for seed in range(parser.parse_args().rods):
        try:
            rows += rows_of(seed)
        except SceneError as error:
            print(f"rod {seed} is left out: {error}")
    print("motions  impacts  rows  least  median  90 %")
    for motions in (2, 3):
        for alike in (True, False):
            told = [row.told for row in rows if row.motions == motions and row.alike == alike]
            if told:
                numbers = f"{min(told):5.2f}  {np.median(told):6.1f}  {np.quantile(told, 0.9):4.0f}"
                print(f"{motions:7d}  {'alike' if alike else 'other':>7}  {len(told):4d}  {numbers}")


if __name__ == "__main__":
    main()
