"""What a wire feels, row by row: rows a second, consistency over drawn cases, the examples' tables.

    python benchmarks/estimate.py
    python benchmarks/estimate.py --cases 1000
    python benchmarks/estimate.py --data examples/data

Positions of four sections of a wire of 12 unknowns are measured. It feels the force at its tip; that and two Legendre
coefficients of a distributed load in each transverse axis; or the place of a contact and the force there, by one search
for each row or by as many as the scene asks for. Rates are rows over the processor time of the busiest thread, without
building, compiling and reading. With ``--cases`` so many cases are drawn from the priors with noise: the mean of their
squared errors in the metric of the covariances beside its 95 % band (NEES; Y. Bar-Shalom, X. R. Li, T. Kirubarajan,
*Estimation with Applications to Tracking and Navigation*, Wiley 2001, section 5.4.2), and how many 95 % intervals hold;
with the covariances of the linearised model and with those by draws; then the same with a quarter of the noise, and
forces where the modulus is known to 5 %: taken for known, found beside what the rows feel, found in each row.
``--data`` writes the tables of examples/felt_loads.toml and examples/felt_contact.toml into a folder.
"""

from __future__ import annotations

import argparse
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

import numpy as np
from scipy.stats import chi2

from cosserat_casadi import Model, build, read_scene, solve
from cosserat_casadi.codegen.estimator import EstimatorLibrary, Knowledge, MeasuredCases, estimator_library
from cosserat_casadi.estimation import Estimate, estimate
from cosserat_casadi.estimation.beforehand import knowledge_of, stacked_indices, with_unknown_parameters
from cosserat_casadi.estimation.estimate import start_tables
from cosserat_casadi.estimation.stacking import differences, sections_of, stacked
from cosserat_casadi.files import write_atomically
from cosserat_casadi.identification.fit_unknowns import unknown_layout
from cosserat_casadi.identification.measured_cases import read_cases
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.load_cases import CaseLayout
from cosserat_casadi.scene import Scene, Unknown

EXAMPLES = Path(__file__).parents[1] / "examples"

AT = (0.25, 0.5, 0.75, 1.0)
"""Measured sections."""

MOMENTS = 24
"""Cases of the examples."""

DATA_SEED = 16
SEED = 3

ONE_ELEMENT = ("accuracy.modes=4", "accuracy.nodes=8")
TWO_ELEMENTS = ("accuracy.modes=2", "accuracy.nodes=5")
"""Discretisations of 12 unknowns: of one element, and of two that end at the contact."""

CHUNK = 128
"""Rows that a thread takes at once."""

DRAWS = 256
"""Draws from each posterior, in each of two rounds."""

UNSURE = 0.05
"""Deviation of a modulus that is known roughly, relative."""

BATCH = 10
"""Rows that share a modulus."""

Columns = dict[str, list[float]]


@dataclass(frozen=True)
class Variant:
    """What is felt.

    Attributes:
        title: what is printed.
        scene: with measurements and unknowns.
    """

    title: str
    scene: Scene


def variants() -> list[Variant]:
    """What is timed."""
    loads = read_scene(EXAMPLES / "felt_loads.toml", ONE_ELEMENT)
    contact = read_scene(EXAMPLES / "felt_contact.toml", TWO_ELEMENTS)
    once = read_scene(EXAMPLES / "felt_contact.toml", (*TWO_ELEMENTS, "estimation.starts=1"))
    tip = loads.model_copy(update={"unknowns": loads.unknowns[:1]})
    return [
        Variant("force at the tip", tip),
        Variant("force at the tip, load along the rod", loads),
        Variant("force and its place, 1 start", once),
        Variant(f"force and its place, {contact.estimation.starts} starts", contact),
    ]


def finer(sigma: float | tuple[float, ...]) -> float | tuple[float, ...]:
    """A quarter of the noise, of all components alike or of each."""
    if isinstance(sigma, tuple):
        return tuple(component / 4 for component in sigma)
    return sigma / 4


def with_finer_sensors(variant: Variant) -> Variant:
    """The same with a quarter of the noise: intervals are narrower, and the linear model of the posterior better."""
    measurements = tuple(
        measurement.model_copy(update={"sigma": finer(measurement.sigma)}) for measurement in variant.scene.measurements
    )
    return Variant(
        f"{variant.title}, a quarter of the noise", variant.scene.model_copy(update={"measurements": measurements})
    )


def model_of(scene: Scene) -> Model:
    """The model whose inputs and parameters are what is felt."""
    return with_unknown_parameters(build(scene.with_unknowns()))


def drawn(model: Model, count: int, rng: np.random.Generator) -> FloatArray:
    """What is felt in some cases, from the priors and within the bounds, shape (count, unknowns)."""
    limits = knowledge_of(unknown_layout(model)).limits
    felt = limits.mean + rng.normal(size=(count, len(limits.mean))) / limits.weight
    return limits.clipped(felt)


def shapes(model: Model, felt: FloatArray, rng: np.random.Generator) -> Columns:
    """Measured sections under what is felt, shape (cases, unknowns), with noise, in mm."""
    layout = CaseLayout(model.inputs, model.parameters)
    indices = stacked_indices(unknown_layout(model).own, model.inputs.size)
    noise = model.scene.measurements[0].sigma
    columns: Columns = {name: [] for name in ("moment", "X", "x_mm", "y_mm", "z_mm")}
    for moment, row in enumerate(felt):
        case = layout.default.copy()
        case[indices] = row
        inputs, parameters = np.split(case, [model.inputs.size])
        solution = solve(model, model.inputs.unpack(inputs), parameters=model.parameters.unpack(parameters))
        positions = solution.pose(AT, "wire").position
        for at, position in zip(AT, positions, strict=True):
            noisy = 1e3 * (position + rng.normal(0.0, noise, 3))
            for name, cell in zip(columns, (moment, at, *noisy), strict=True):
                columns[name].append(float(cell))
    return columns


def written(columns: Columns) -> str:
    """The table of an example."""
    lines = [",".join(columns)]
    for moment, at, *position in zip(*columns.values(), strict=True):
        lines.append(f"{moment:.0f},{at:g}," + ",".join(f"{cell:.3f}" for cell in position))
    return "\n".join(lines) + "\n"


def write_tables(folder: Path) -> None:
    """The tables of the examples."""
    for name, settings in (("felt_loads", ONE_ELEMENT), ("felt_contact", ("accuracy.modes=4", "accuracy.nodes=8"))):
        scene = read_scene(EXAMPLES / f"{name}.toml", settings)
        model = model_of(scene)
        rng = np.random.default_rng(DATA_SEED)
        table = written(shapes(model, drawn(model, MOMENTS, rng), rng))
        write_atomically(folder / Path(scene.measurements[0].file).name, table.encode())


def busiest(library: EstimatorLibrary, tables: list[MeasuredCases], known: Knowledge, threads: int) -> float:
    """Processor time of the busiest of so many threads that share all rows, s."""
    rows = len(tables[0].inputs)
    parts = [table.part(slice(first, first + CHUNK)) for table in tables for first in range(0, rows, CHUNK)]

    def work(own: list[MeasuredCases]) -> float:
        begun = time.thread_time()
        for part in own:
            library.estimate(part, known)
        return time.thread_time() - begun

    with ThreadPoolExecutor(threads) as pool:
        return max(pool.map(work, [parts[k::threads] for k in range(threads)]))


def rates(variant: Variant, count: int) -> None:
    """Print rows a second on one and two cores, and what it takes to read the table."""
    model = model_of(variant.scene)
    rng = np.random.default_rng(SEED)
    columns = shapes(model, drawn(model, count, rng), rng)
    begun = time.process_time()
    cases = read_cases(model.scene, model.inputs, {variant.scene.measurements[0].file: columns})
    sections = sections_of(model, cases)
    table = stacked(model, cases, sections)
    reading = 1e6 * (time.process_time() - begun) / count
    layout = unknown_layout(model)
    indices = stacked_indices(layout.own, model.inputs.size)
    known = knowledge_of(layout)
    library = estimator_library(model, differences(model, sections, indices, table.at), indices, ())
    tables = start_tables(table, layout, indices, model.scene)
    # Compiled here.
    library.estimate(table.part(slice(0, 1)), known)
    one, two = (count / min(busiest(library, tables, known, threads) for _ in range(3)) for threads in (1, 2))
    print(
        f"{variant.title}: {model.size} unknowns, {len(indices)} felt numbers: {one:,.0f} rows/s on one core, "
        f"{two:,.0f} on two ({1e6 / one:.0f} µs a row); reading {reading:.0f} µs a row"
    )


@dataclass
class Score:
    """How estimates compare with what made their data.

    Attributes:
        squares: squared errors in the metric of their covariances.
        held: for each interval whether it holds.
        found: how many rows were found, of how many.
    """

    squares: list[float] = field(default_factory=list)
    held: list[bool] = field(default_factory=list)
    found: tuple[int, int] = (0, 0)

    def add(self, found: Estimate, felt: FloatArray) -> None:
        """Take the rows of one estimate into account."""
        rows = found.found
        errors = found.values[rows] - felt[rows]
        self.squares += np.einsum("ci,cij,cj->c", errors, np.linalg.inv(found.covariance[rows]), errors).tolist()
        intervals = found.intervals[rows]
        self.held += ((intervals[:, :, 0] <= felt[rows]) & (felt[rows] <= intervals[:, :, 1])).ravel().tolist()
        self.found = (self.found[0] + len(errors), self.found[1] + len(felt))

    def told(self, title: str, free: int | None = None) -> str:
        """A line of the table; the band is that of so many independent rows, all by default."""
        numbers = len(self.held) // len(self.squares)
        independent = free or len(self.squares)
        low, high = chi2.ppf([0.025, 0.975], numbers * independent) / independent
        return (
            f"{title}: {self.found[0]} of {self.found[1]} rows found, NEES {np.mean(self.squares):.3f}, 95 % band "
            f"{low:.3f} to {high:.3f}; {100 * np.mean(self.held):.1f} % of {len(self.held)} intervals hold"
        )


def with_draws(scene: Scene) -> Scene:
    """The same with deviations by draws from the posteriors."""
    return scene.model_copy(update={"estimation": scene.estimation.model_copy(update={"draws": DRAWS})})


def consistency(variant: Variant, count: int) -> None:
    """Print the mean squared error in the metric of the covariances with its band, and how many intervals hold."""
    model = model_of(variant.scene)
    rng = np.random.default_rng(SEED)
    felt = drawn(model, count, rng)
    data = {variant.scene.measurements[0].file: shapes(model, felt, rng)}
    for title, scene in ((variant.title, variant.scene), ("… by draws", with_draws(variant.scene))):
        score = Score()
        begun = time.process_time()
        found = estimate(model_of(scene), data)
        took = 1e3 * (time.process_time() - begun) / count
        score.add(found, felt)
        print(
            f"{score.told(title)}; {int(found.doubtful.sum())} rows have a second explanation; {took:.2f} ms a row",
            flush=True,
        )


def uncertain(count: int) -> None:
    """Print the same where the modulus is known to 5 %: taken for known, found beside for all rows, found in each."""
    variant = variants()[0]
    rod = variant.scene.rods[0]
    assert rod.material is not None
    modulus = f"{rod.name}.material.youngs_modulus"
    known = float(rod.material.youngs_modulus)
    prior = {"mean": known, "sigma": UNSURE * known}
    limits = {"lower": (1 - 5 * UNSURE) * known, "upper": (1 + 5 * UNSURE) * known}
    shared = Unknown(parameter=modulus, prior=prior)
    in_each = Unknown(parameter=modulus, prior=prior, per_row=True, **limits)
    models = {}
    for title, unknowns in (("taken for known", ()), ("found beside", (shared,)), ("found in each row", (in_each,))):
        scene = variant.scene.model_copy(update={"unknowns": (*variant.scene.unknowns, *unknowns)})
        models[title] = model_of(scene)
    rng = np.random.default_rng(SEED)
    scores = {title: Score() for title in models}
    batches = max(1, count // BATCH)
    for _ in range(batches):
        true = known * (1 + UNSURE * rng.normal())
        felt = drawn(models["taken for known"], BATCH, rng)
        stiffer = partial(with_modulus, modulus=true)
        columns = shapes(models["taken for known"].changed(stiffer), felt, rng)
        for title, model in models.items():
            found = estimate(model, {variant.scene.measurements[0].file: columns})
            if title == "found in each row":
                # The modulus that a row finds for itself is no load.
                found = replace(found, values=found.values[:, :3], covariance=found.covariance[:, :3, :3])
            scores[title].add(found, felt)
    for title, score in scores.items():
        print(score.told(f"modulus off by {100 * UNSURE:.0f} %, {title}", batches), flush=True)


def with_modulus(scene: Scene, modulus: float) -> Scene:
    """The scene of a rod of another modulus."""
    rod = scene.rods[0]
    assert rod.material is not None
    material = rod.material.model_copy(update={"youngs_modulus": modulus})
    return scene.model_copy(update={"rods": (rod.model_copy(update={"material": material}), *scene.rods[1:])})


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=500, help="rows that are timed")
    parser.add_argument("--cases", type=int, help="cases drawn to see whether estimates are consistent, instead")
    parser.add_argument("--data", type=Path, help="write the tables of the examples into this folder, and end")
    arguments = parser.parse_args()
    if arguments.data is not None:
        write_tables(arguments.data)
        return
    for variant in variants():
        if arguments.cases is None:
            rates(variant, arguments.count)
        else:
            consistency(variant, arguments.cases)
            consistency(with_finer_sensors(variant), arguments.cases)
    if arguments.cases is not None:
        uncertain(arguments.cases)


if __name__ == "__main__":
    main()
