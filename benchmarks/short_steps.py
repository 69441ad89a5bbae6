"""Does the load path end where one of far shorter steps ends, and at what cost?

    python benchmarks/short_steps.py

Seeded rods that are free at the tip, each at once, three and five times the loads drawn; rods held at the tip; the
platform of examples/six_rod_platform.toml on few modes, its legs drawn to other lengths by up to 12 %. Each is solved
cold twice, with the steps that are usual and with steps an eighth as long.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import typer
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import track
from rich.table import Table

sys.path.insert(0, str(Path(__file__).parents[1]))

from cosserat_casadi import Model, build, discretise, read_scene, scene_from_dict
from cosserat_casadi.equilibrium.load_path import load_path
from cosserat_casadi.numerics.continuation import ContinuationResult, ContinuationSettings, follow
from tests.reference.random_scenes import random_scene
from tests.scenes import WEIGHT, scene

PLATFORM = Path(__file__).parents[1] / "examples" / "six_rod_platform.toml"
LEGS = [f"leg_{i}.length" for i in range(1, 7)]
SAME = 1e-6
SHORT = ContinuationSettings(longest=ContinuationSettings().longest / 8, steps=4000)

Case = tuple[Model, NDArray[np.float64]]


def free_rods(count: int) -> Iterator[Case]:
    """Models and inputs, all loads once, three and five times as drawn."""
    for seed in range(count):
        model = build(scene_from_dict({**random_scene(seed), "accuracy": {"modes": 5, "nodes": 12}}))
        for times in (1.0, 3.0, 5.0):
            yield model, times * model.pack()


def held_rods(count: int) -> Iterator[Case]:
    """A rod under its weight, its tip clamped in any direction, every fourth pinned."""
    rng = np.random.default_rng(11)
    for k in range(count):
        way, turn = rng.standard_normal(3), rng.standard_normal(4)
        place = rng.uniform(0.4, 0.75) * way / np.linalg.norm(way)
        place[2] = abs(place[2])
        support = {"rod": "rod", "kind": "pinned", "position": place.tolist()}
        if k % 4:
            turn[0] = abs(turn[0]) + 1.0
            support |= {"kind": "clamped", "quaternion": (turn / np.linalg.norm(turn)).tolist()}
        held = scene(WEIGHT, supports=[support])
        model = build(held, discretise(held, 5, 12))
        yield model, model.pack()


def platforms(count: int) -> Iterator[Case]:
    """One model, other lengths of its legs."""
    model = build(read_scene(PLATFORM, (f"inputs={LEGS}".replace("'", '"'), "accuracy.modes=4", "accuracy.nodes=8")))
    rng = np.random.default_rng(5)
    yield model, model.pack()
    for _ in range(count - 1):
        yield model, model.pack() * rng.uniform(0.88, 1.12, model.inputs.size)


def alike(one: ContinuationResult, other: ContinuationResult) -> bool:
    """Whether both end in one equilibrium, or both stall at one share of the load."""
    if one.outcome is not other.outcome:
        return False
    if one.reached < 1.0:
        return abs(one.reached - other.reached) <= 1e-3
    return bool(np.linalg.norm(one.x - other.x) <= SAME * (1.0 + np.linalg.norm(other.x)))


def main(free: int = 80, held: int = 60, drawn: int = 30) -> None:
    """Print how many of each kind end alike, and the Newton steps that both ways take."""
    table = Table(title=f"steps of {ContinuationSettings().longest:g} beside steps of {SHORT.longest:g}")
    for heading in ("", "cases", "end alike", "stall in both", "Newton steps", "of short steps"):
        table.add_column(heading, justify="right" if heading else "left")
    kinds = {"free rods": (free_rods(free), 3 * free), "held rods": (held_rods(held), held)}
    kinds["platforms"] = (platforms(drawn), drawn)
    for kind, (cases, count) in kinds.items():
        found = []
        for model, inputs in track(cases, kind, count, disable=not sys.stdout.isatty()):
            found.append((follow(load_path(model, inputs)), follow(load_path(model, inputs), SHORT)))
            if not alike(*found[-1]):
                ends = [f"{one.outcome.label} at {one.reached:.6g} of the load" for one in found[-1]]
                print(f"{kind}, case {len(found)}: {ends[0]}; with short steps {ends[1]}")
        same = [pair for pair in found if alike(*pair)]
        stalled = sum(one.reached < 1.0 for one, _ in same)
        steps = [sum(pair[k].iterations for pair in found) for k in (0, 1)]
        table.add_row(kind, *[f"{number:,}" for number in (len(found), len(same), stalled, *steps)])
    Console().print(table)


if __name__ == "__main__":
    typer.run(main)
