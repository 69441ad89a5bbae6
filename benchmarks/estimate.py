"""What a wire feels, row by row: processor time of a row, and the example's table.

    python benchmarks/estimate.py
    python benchmarks/estimate.py --data examples/data/felt_shapes.csv

A wire of 12 unknowns and four sections whose positions are measured feels the force at its tip and, in the second
line, two Legendre coefficients of a distributed load in each transverse axis as well. Times are of one core, without
building and compiling. ``--data`` writes the table of examples/felt_loads.toml.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import numpy as np

from cosserat_casadi import Model, build, read_scene, solve
from cosserat_casadi.codegen.estimator import estimator_library
from cosserat_casadi.estimation.estimate import knowledge_of
from cosserat_casadi.estimation.stacking import differences, sections_of, stacked
from cosserat_casadi.files import write_atomically
from cosserat_casadi.identification.cases import read_cases
from cosserat_casadi.identification.unknowns import unknown_layout
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.scene import Scene

EXAMPLE = Path(__file__).parents[1] / "examples" / "felt_loads.toml"

AT = (0.25, 0.5, 0.75, 1.0)
"""Measured sections."""

NOISE = 2e-4
"""Standard deviation of one coordinate, m."""

MOMENTS = 24
"""Cases of the example."""


def shapes(model: Model, felt: FloatArray, rng: np.random.Generator) -> dict[str, list[float]]:
    """Measured sections under what is felt, shape (cases, unknowns), with noise, in mm."""
    layout = unknown_layout(model)
    indices = np.concatenate([entry.indices for entry in layout.own])
    columns: dict[str, list[float]] = {name: [] for name in ("moment", "X", "x_mm", "y_mm", "z_mm")}
    for moment, row in enumerate(felt):
        inputs = model.pack()
        inputs[indices] = row
        positions = solve(model, model.inputs.unpack(inputs)).pose(AT, "wire").position
        for at, position in zip(AT, positions, strict=True):
            noisy = 1e3 * (position + rng.normal(0.0, NOISE, 3))
            for name, cell in zip(columns, (moment, at, *noisy), strict=True):
                columns[name].append(float(cell))
    return columns


def drawn(model: Model, count: int, rng: np.random.Generator) -> FloatArray:
    """What is felt in some cases, from the priors, shape (count, unknowns)."""
    known = knowledge_of(unknown_layout(model))
    return known.mean + rng.normal(size=(count, len(known.mean))) / known.weight


def written(columns: dict[str, list[float]]) -> str:
    """The table of the example."""
    lines = [",".join(columns)]
    for moment, at, *position in zip(*columns.values(), strict=True):
        lines.append(f"{moment:.0f},{at:g}," + ",".join(f"{cell:.3f}" for cell in position))
    return "\n".join(lines) + "\n"


def microseconds(scene: Scene, count: int) -> tuple[int, float, float]:
    """Felt numbers, and processor time of a row: in C, and of reading the table."""
    model = build(scene.with_unknowns())
    rng = np.random.default_rng(3)
    columns = shapes(model, drawn(model, count, rng), rng)
    begun = time.process_time()
    cases = read_cases(model.scene, model.inputs, {scene.measurements[0].file: columns})
    sections = sections_of(model, cases)
    table = stacked(model, cases, sections)
    reading = time.process_time() - begun
    layout = unknown_layout(model)
    indices = [int(index) for entry in layout.own for index in entry.indices]
    library = estimator_library(model, differences(model, sections, indices, table.at), indices)
    known = knowledge_of(layout)
    # Compiled here.
    library.estimate(table.part(slice(0, 1)), known)
    begun = time.process_time()
    found = library.estimate(table, known)
    searching = time.process_time() - begun
    if found.outcome.any():
        raise RuntimeError(f"{np.count_nonzero(found.outcome)} of {count} rows were not found")
    return len(indices), 1e6 * searching / count, 1e6 * reading / count


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=500, help="rows")
    parser.add_argument("--data", type=Path, help="write the table of the example here, and end")
    arguments = parser.parse_args()
    settings = ("accuracy.modes=4", "accuracy.nodes=8")
    scene = read_scene(EXAMPLE, settings)
    if arguments.data is not None:
        model = build(scene.with_unknowns())
        rng = np.random.default_rng(16)
        write_atomically(arguments.data, written(shapes(model, drawn(model, MOMENTS, rng), rng)).encode())
        return
    touched = scene.model_copy(update={"unknowns": scene.unknowns[:1]})
    for variant in (touched, scene):
        felt, searching, reading = microseconds(variant, arguments.count)
        rate = 1e6 / searching
        print(
            f"{felt} felt numbers: {searching:.0f} µs a row, {rate:.0f} rows/s a core; reading {reading:.0f} µs a row"
        )


if __name__ == "__main__":
    main()
