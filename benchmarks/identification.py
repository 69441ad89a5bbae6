"""Identification from made-up shapes and motions: time, recovery from random starts and truths, coverage of intervals.

    python benchmarks/identification.py              # 1000 tries, about ten minutes on one core
    python benchmarks/identification.py --count 50
    python benchmarks/identification.py --motion --count 100    # some minutes
    python benchmarks/identification.py --outliers 0.1 --count 100
    python benchmarks/identification.py --data examples/data/wire_shapes.csv
    python benchmarks/identification.py --motion --data examples/data/released_strip.csv

Each try draws E, G and two coefficients of the curvature, 20 loads, noise, and where the search begins; it solves for
the shapes of a rod of twelve unknowns, and says whether the truth is within the 95 % intervals. What is timed is
`identify`, after the model is built, with the functions of the misfit that it makes: processor time and clock.
``--outliers`` puts a share of the coordinates 3 mm off, by a normal deviation, and takes the loss "huber".
``--motion`` does the same with the path of the tip of a cantilever that is let go: E, density and damping are
found. ``--data`` writes the table of examples/wire_from_shapes.toml, or of examples/released_strip.toml.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cosserat_casadi import Model, build, identify, read_scene
from cosserat_casadi.files import write_atomically
from cosserat_casadi.identification.measured_cases import Data
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.scene import scene_from_dict
from tests.identification.made_up import NAMES, TRUTH, WIRE, measured_shapes
from tests.identification.released import CANTILEVER, path_of
from tests.identification.released import TRUTH as TRUE_CANTILEVER
from tests.identification.released import with_noise as path_with_noise

NOISE = 2e-4
"""Standard deviation of one coordinate, m."""


EXAMPLES = Path(__file__).parents[1] / "examples"

TRUTH_OF_STRIP = {
    "strip.material.youngs_modulus": 1.3e6,
    "strip.material.density": 1080.0,
    "strip.damping.retardation_time": 0.012,
}
"""What the table of examples/released_strip.toml is made with."""


OFF = 3e-3
"""Standard deviation of a coordinate that is an outlier, m."""


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


def one_motion(seed: int) -> Try:
    """Draw a truth, noise and a start for a cantilever that is let go, and identify from there."""
    rng = np.random.default_rng(seed)
    rod = {**CANTILEVER["rods"][0], "material": dict(CANTILEVER["rods"][0]["material"])}
    own = {name: value * 1.5 ** rng.uniform(-1.0, 1.0) for name, value in TRUE_CANTILEVER.items()}
    truth = {name: value * 1.2 ** rng.uniform(-1.0, 1.0) for name, value in TRUE_CANTILEVER.items()}
    for name, value in own.items():
        _, table, key = name.split(".")
        rod[table] = {**rod[table], key: value}
    model = build(scene_from_dict({**CANTILEVER, "rods": [rod]}).with_unknowns())
    return timed(model, path_with_noise(path_of(model, truth), rng), truth)


def timed(model: Model, data: Data, truth: Mapping[str, float]) -> Try:
    """Identify, and compare with the truth."""
    clock = time.perf_counter()
    processor = time.process_time()
    found = identify(model, data)
    processor = time.process_time() - processor
    clock = time.perf_counter() - clock
    true_values = np.array([truth[name] for name in found.labels])
    return Try((found.shared - true_values) / found.sigma, found.converged, processor, clock)


def drawn_truth(rng: np.random.Generator) -> dict[str, float]:
    """Moduli within a factor of 2 of the scene's, curvatures within 3/m of zero."""
    moduli = np.array([60e9, 23e9]) * 2.0 ** rng.uniform(-1.0, 1.0, 2)
    curvatures = rng.uniform(-3.0, 3.0, 2)
    return dict(zip(NAMES, [*moduli.tolist(), *curvatures.tolist()], strict=True))


def started(rng: np.random.Generator, loss: str = "squares") -> Model:
    """The model whose own values, where the search begins, are drawn like the truth."""
    start = drawn_truth(rng)
    rod = {**WIRE["rods"][0]}
    rod["material"] = {"youngs_modulus": start[NAMES[0]], "shear_modulus": start[NAMES[1]]}
    rod["intrinsic"] = {"curvature": [[start[NAMES[2]], start[NAMES[3]]], 0.0, 0.0]}
    return build(scene_from_dict({**WIRE, "rods": [rod], "identification": {"loss": loss}}).with_unknowns())


def one_try(seed: int, outliers: float = 0.0) -> Try:
    """Draw a truth, loads, noise and a start, and identify from there; a share of the coordinates may be outliers."""
    rng = np.random.default_rng(seed)
    model = started(rng, "huber" if outliers else "squares")
    shapes = measured_shapes(model, rng, cases=20, noise=NOISE, truth=drawn_truth(rng))
    for axis in "xyz" if outliers else "":
        column = shapes.columns[axis]
        column += OFF * rng.standard_normal(len(column)) * (rng.random(len(column)) < outliers)
    return timed(model, shapes.data, shapes.truth)


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


def write_released(file: Path) -> None:
    """The table of examples/released_strip.toml: the path of its tip, in ms and mm."""
    scene = read_scene(EXAMPLES / "released_strip.toml")
    path = path_of(build(scene.with_unknowns()), TRUTH_OF_STRIP, np.linspace(0.0, 0.6, 31))
    rng = np.random.default_rng(16)
    lines = ["t_ms,x_mm,z_mm"]
    for t, x, z in zip(path["t"], path["x"], path["z"], strict=True):
        x_noise, z_noise = 0.5 * rng.standard_normal(2)
        lines.append(f"{1e3 * t:.0f},{1e3 * x + x_noise:.2f},{1e3 * z + z_noise:.2f}")
    write_atomically(file, ("\n".join(lines) + "\n").encode())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=1000, help="tries")
    parser.add_argument("--first", type=int, default=0, help="seed of the first try")
    parser.add_argument("--outliers", type=float, default=0.0, help="share of the coordinates that are far off")
    parser.add_argument("--motion", action="store_true", help="a cantilever that is let go, in place of shapes")
    parser.add_argument("--data", type=Path, help="write the table of the example here, and end")
    arguments = parser.parse_args()
    if arguments.data is not None:
        write = write_released if arguments.motion else write_data
        write(arguments.data)
        return
    tries: list[Try] = []
    for number in range(1, arguments.count + 1):
        seed = arguments.first + number - 1
        tries.append(one_motion(seed) if arguments.motion else one_try(seed, arguments.outliers))
        if number % 50 == 0:
            print(f"{number} tries", flush=True)
    print(report(tries))


if __name__ == "__main__":
    main()
