"""Identification of a wire from made-up shapes: time, recovery from random starts and truths, coverage of intervals.

    python benchmarks/identification.py              # 1000 tries, about ten minutes on one core
    python benchmarks/identification.py --count 50
    python benchmarks/identification.py --data examples/data/wire_shapes.csv

Each try draws E, G and two coefficients of the curvature, 20 loads, noise, and where the search begins; it solves for
the shapes of a rod of twelve unknowns, and says whether the truth is within the 95 % intervals. What is timed is
`identify`, after the model is built, with the functions of the misfit that it makes: processor time and clock.
``--data`` writes the shapes of examples/wire_from_shapes.toml.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cosserat_casadi import Model, build, identify
from cosserat_casadi.files import write_atomically
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.scene import scene_from_dict
from tests.identification.made_up import NAMES, TRUTH, WIRE, measured_shapes

NOISE = 2e-4
"""Standard deviation of one coordinate, m."""


@dataclass(frozen=True)
class Try:
    """One identification from a random start.

    Attributes:
        deviations: of what was found from the truth, in standard deviations, shape (4,).
        converged: whether it was found.
        processor: time that the search took after building, s of the processor.
        clock: the same by the clock, s.
    """

    deviations: FloatArray
    converged: bool
    processor: float
    clock: float


def drawn_truth(rng: np.random.Generator) -> dict[str, float]:
    """Moduli within a factor of 2 of the scene's, curvatures within 3/m of zero."""
    moduli = np.array([60e9, 23e9]) * 2.0 ** rng.uniform(-1.0, 1.0, 2)
    curvatures = rng.uniform(-3.0, 3.0, 2)
    return dict(zip(NAMES, [*moduli.tolist(), *curvatures.tolist()], strict=True))


def started(rng: np.random.Generator) -> Model:
    """The model whose own values, where the search begins, are drawn like the truth."""
    start = drawn_truth(rng)
    rod = {**WIRE["rods"][0]}
    rod["material"] = {"youngs_modulus": start[NAMES[0]], "shear_modulus": start[NAMES[1]]}
    rod["intrinsic"] = {"curvature": [[start[NAMES[2]], start[NAMES[3]]], 0.0, 0.0]}
    return build(scene_from_dict({**WIRE, "rods": [rod]}).with_unknowns())


def one_try(seed: int) -> Try:
    """Draw a truth, loads, noise and a start, and identify from there."""
    rng = np.random.default_rng(seed)
    model = started(rng)
    shapes = measured_shapes(model, rng, cases=20, noise=NOISE, truth=drawn_truth(rng))
    clock = time.perf_counter()
    processor = time.process_time()
    found = identify(model, shapes.data)
    processor = time.process_time() - processor
    clock = time.perf_counter() - clock
    truth = np.array([shapes.truth[name] for name in found.labels])
    return Try((found.shared - truth) / found.sigma, found.converged, processor, clock)


def report(tries: list[Try]) -> str:
    """Time, recovery and coverage in words."""
    deviations = np.array([one.deviations for one in tries])
    converged = sum(one.converged for one in tries)
    covered = np.mean(np.abs(deviations) < 1.959963984540054, axis=0)
    spread = np.sqrt(np.mean(deviations**2, axis=0))
    lines = [
        f"{converged} of {len(tries)} found; farthest from the truth {np.abs(deviations).max():.2f} σ",
        f"intervals of 95 % hold the truth in {100 * covered.mean():.1f} % of all, by unknown "
        + ", ".join(f"{100 * share:.1f}" for share in covered),
        "deviations from the truth in σ: mean "
        + ", ".join(f"{mean:.2f}" for mean in deviations.mean(axis=0))
        + "; rms "
        + ", ".join(f"{rms:.2f}" for rms in spread),
        _spread("processor", [one.processor for one in tries]),
        _spread("clock", [one.clock for one in tries]),
    ]
    return "\n".join(lines)


def _spread(what: str, seconds: list[float]) -> str:
    return (
        f"seconds after building, {what}: median {np.median(seconds):.2f}, "
        f"least {min(seconds):.2f}, most {max(seconds):.2f}"
    )


def write_data(file: Path) -> None:
    """The table of examples/wire_from_shapes.toml: twelve shapes of ten sections, in mm."""
    model = build(scene_from_dict(WIRE).with_unknowns())
    shapes = measured_shapes(model, np.random.default_rng(16), cases=12, noise=3e-4, truth=TRUTH)
    columns = {(f"{name}_mm" if name in "xyz" else name): values for name, values in shapes.columns.items()}
    rows = [",".join(columns)]
    for row in zip(*columns.values(), strict=True):
        cells = zip(columns, row, strict=True)
        rows.append(",".join(f"{1e3 * cell:.2f}" if name.endswith("_mm") else f"{cell:.6g}" for name, cell in cells))
    write_atomically(file, ("\n".join(rows) + "\n").encode())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=1000, help="tries")
    parser.add_argument("--first", type=int, default=0, help="seed of the first try")
    parser.add_argument("--data", type=Path, help="write the table of the example here, and end")
    arguments = parser.parse_args()
    if arguments.data is not None:
        write_data(arguments.data)
        return
    tries: list[Try] = []
    for number in range(1, arguments.count + 1):
        tries.append(one_try(arguments.first + number - 1))
        if number % 50 == 0:
            print(f"{number} tries", flush=True)
    print(report(tries))


if __name__ == "__main__":
    main()
