"""Experiments of others beside the model: what is found, what is left, what is predicted.

    python -m benchmarks.validation           # prints the tables of docs/validation.md
    python -m benchmarks.validation --write   # writes them, and the figure

Scenes and measurements are in examples/validation and examples/data.
"""

from __future__ import annotations

import csv
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from doc_tables import put, table

from cosserat_casadi import Identification, Model, Solution, identify, modes_of, read_scene, scene_from_dict, solve
from cosserat_casadi.identification import Row
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.plots.figure import figure_class, write_figure
from cosserat_casadi.scene.measurements import FrameMeasurement

ROOT = Path(__file__).parents[1]
SCENES = ROOT / "examples" / "validation"
DATA = ROOT / "examples" / "data"
PAGE = ROOT / "docs" / "validation.md"
FIGURE = ROOT / "docs" / "figures" / "validation.png"

MEASURED_PERIODS = {0.0: 0.13, 0.052: 0.23, 0.102: 0.30}
"""Periods of the silicone block after its release, s, by the mass at its tip, kg."""

DEFINED = "zero"
"""Name of what holds by definition and was not measured."""

MEASURED, MODELLED, PREDICTED = "#000000", "#0072B2", "#D55E00"
"""Colours of the figure."""


@dataclass(frozen=True)
class Number:
    """One number that is found.

    Attributes:
        label: as the identification calls it.
        name: what the page calls it, with its unit.
        scale: factor from SI units to that unit.
        source: what the source says of it.
    """

    label: str
    name: str
    scale: float = 1.0
    source: str = "–"


@dataclass(frozen=True)
class Study:
    """One experiment.

    Attributes:
        name: of its scene, and of its place in the page.
        numbers: what is found.
    """

    name: str
    numbers: tuple[Number, ...]


STUDIES = (
    Study("steel_strip", (Number("strip.material.youngs_modulus", "E, GPa", 1e-9, "194.3"),)),
    Study(
        "curved_beam",
        (
            Number("beam.material.youngs_modulus", "E, GPa", 1e-9, "200"),
            Number("beam.material.terms.0.coefficient", "energy term of the fourth power of curvature, J m³"),
            Number("beam.intrinsic.curvature.y[0]", "curvature, mean, 1/m"),
            Number("beam.intrinsic.curvature.y[1]", "curvature, linear, 1/m"),
            Number("beam.intrinsic.curvature.y[2]", "curvature, quadratic, 1/m"),
        ),
    ),
    Study("silicone_beam", (Number("block.material.youngs_modulus", "E, kPa", 1e-3, "263.8"),)),
    Study(
        "silicone_release",
        (
            Number("block.material.youngs_modulus", "E, kPa", 1e-3, "263.8"),
            Number("block.damping.retardation_time", "retardation time, ms", 1e3),
        ),
    ),
    Study(
        "silicone_block",
        (
            Number("block.material.youngs_modulus", "E at rest, kPa", 1e-3, "263.8"),
            Number("block.damping.prony.0.share", "share that relaxes"),
            Number("block.damping.retardation_time", "retardation time, ms", 1e3),
        ),
    ),
    Study(
        "silicone_arm",
        (
            Number("chamber.offset.x", "offset in the plane of bending, mm", 1e3),
            Number("chamber.offset.y", "offset across that plane, mm", 1e3),
            Number("chamber.area_growth.0", "growth of area times offset, coefficient of p/p₀"),
            Number("chamber.area_growth.1", "coefficient of (p/p₀)²"),
        ),
    ),
    Study(
        "pazy_wing",
        (
            Number("wing.stiffness.bending_y", "EI, N m²", 1.0, "4.47 to 5.25"),
            Number("wing.stiffness.torsion", "GJ, N m²", 1.0, "6.5 to 7.6; 17.4 at the tip"),
            Number("wing.base.position.z", "height of the root, mm", 1e3),
        ),
    ),
    Study(
        "rubber",
        (
            Number("strip.material.youngs_modulus", "E, MPa", 1e-6, "1.24"),
            Number("strip.material.c2", "c2, kPa", 1e-3),
            Number("strip.material.c3", "c3, kPa", 1e-3),
        ),
    ),
    Study(
        "three_tendon_robot",
        (
            Number("first.helix.radius", "distance of the first tendon from the axis, mm", 1e3),
            Number("second.helix.radius", "distance of the second tendon, mm", 1e3),
            Number("third.helix.radius", "distance of the third tendon, mm", 1e3),
        ),
    ),
)


@dataclass
class Validation:
    """What came out of all experiments.

    Attributes:
        found: the end of each identification by the name of its study.
        arm: of each pressure that was held out: pressure, mbar; measured and predicted displacement, mm;
            rows of shape (3,).
        periods: of each mass at the block: mass, kg; measured period, modelled one, s; rows of shape (3,).
    """

    found: dict[str, Identification] = field(default_factory=dict)
    arm: list[FloatArray] = field(default_factory=list)
    periods: list[FloatArray] = field(default_factory=list)


def validated(report: Callable[[str], None] = lambda name: None) -> Validation:
    """All experiments identified, and what was left to predict."""
    validation = Validation()
    for study in STUDIES:
        report(study.name)
        validation.found[study.name] = identify(read_scene(SCENES / f"{study.name}.toml"))
    validation.arm = predicted_arm(validation.found["silicone_arm"])
    modulus = validation.found["silicone_beam"].value("block.material.youngs_modulus")
    validation.periods = [
        np.array([mass, measured, block_period(mass, float(modulus))]) for mass, measured in MEASURED_PERIODS.items()
    ]
    return validation


def at(found: Identification, values: Mapping[str, Any]) -> Solution:
    """The equilibrium of what was found under other inputs."""
    assert isinstance(found.model, Model)
    return solve(found.model, values, parameters=found.parameters, raise_on_failure=True)


def columns(file: str) -> dict[str, list[str]]:
    """Columns of measured data."""
    with (DATA / file).open() as lines:
        rows = list(csv.DictReader(lines))
    return {name: [row[name] for row in rows] for name in rows[0]}


def arm_displacements() -> dict[float, FloatArray]:
    """Measured displacements of the markers tip1 to tip3 of the arm, shape (3, 3), m, by the pressure, mbar."""
    data = columns("silicone-mocap/arm_static.csv")
    pressures = np.array(data["pressure_mbar"], dtype=float)
    displacements = np.array([data[f"d{axis}_m"] for axis in "xyz"], dtype=float).T
    return {pressure: displacements[pressures == pressure] for pressure in np.unique(pressures).tolist()}


def arm_moved(found: Identification, pressure: float) -> FloatArray:
    """Displacements of these markers by the model, shape (3, 3), m; pressure in mbar."""
    measurements = found.model.scene.measurements
    markers = np.array([one.offset for one in measurements if isinstance(one, FrameMeasurement)])
    places = []
    for pascals in (0.0, 100.0 * pressure):
        pose = at(found, {"chamber.pressure": pascals}).body("end")
        places.append(pose.position + markers @ pose.rotation.T)
    return np.asarray(places[1] - places[0])


def mean_distance(displacements: FloatArray) -> float:
    """Mean length of displacements, mm."""
    return 1e3 * float(np.mean(np.linalg.norm(displacements, axis=1)))


def predicted_arm(found: Identification) -> list[FloatArray]:
    """Rows of `Validation.arm`."""
    data = columns("silicone-mocap/arm_static.csv")
    held = {float(pressure) for pressure, use in zip(data["pressure_mbar"], data["use"], strict=True) if use == "held"}
    rows = []
    for pressure, displacements in arm_displacements().items():
        if pressure in held:
            predicted = mean_distance(arm_moved(found, pressure))
            rows.append(np.array([pressure, mean_distance(displacements), predicted]))
    return rows


def block_period(mass: float, modulus: float) -> float:
    """Period of the silicone block's slowest vibration with a mass at the upper edge of its end, s."""
    tables = tomllib.loads((SCENES / "silicone_beam.toml").read_text())
    for key in ("measurements", "unknowns", "identification"):
        del tables[key]
    tables["rods"][0]["material"]["youngs_modulus"] = modulus
    body = tables["bodies"][0]
    body["mass"] = max(mass, body["mass"])
    body["centre_of_mass"] = [0, 0, 0.015]
    tables["accuracy"]["tolerance"] = 1e-3
    modes = modes_of(scene_from_dict(tables), count=1)
    return 2 * np.pi / modes.modes[0].angular_frequency


def millimetres(found: Identification, *, held_out: bool, moving: bool | None = None) -> tuple[int, float]:
    """How many coordinates, and the root mean square of measured minus modelled, mm; in motion, at rest, or of both."""
    measured = [row for row in found.rows if found.model.scene.measurements[row.measurement].name != DEFINED]
    if moving is not None:
        measured = [row for row in measured if (row.time is not None) is moving]
    differences = [row.modelled - row.measured for row in measured if row.held_out is held_out]
    return len(differences), 1e3 * float(np.sqrt(np.mean(np.square(differences)))) if differences else np.nan


def found_table(study: Study, found: Identification) -> str:
    """What was found, and what was left."""
    if not found.converged:
        raise SystemExit(f"{study.name}: {found.message}")
    places = {label: i for i, label in enumerate(found.labels)}
    rows = []
    for number in study.numbers:
        i = places[number.label]
        low, high = sorted(number.scale * found.intervals[i])
        rows.append((number.name, f"{number.scale * found.shared[i]:.4g}", f"{low:.4g} to {high:.4g}", number.source))
    fitted, residual = millimetres(found, held_out=False)
    predicted, left = millimetres(found, held_out=True)
    text = table(("number", "found", "95 %", "source"), rows)
    text += f"\n\nResidual: {residual:.2f} mm (rms of {fitted} fitted coordinates)"
    return f"{text}; {left:.2f} mm (rms of {predicted} predicted coordinates)." if predicted else f"{text}."


def pages_tables(validation: Validation) -> dict[str, str]:
    """Texts of the page by the names of their places."""
    texts = {study.name: found_table(study, validation.found[study.name]) for study in STUDIES}
    arm = [(f"{row[0]:.0f}", f"{row[1]:.1f}", f"{row[2]:.1f}") for row in validation.arm]
    texts["arm_predicted"] = table(("pressure, mbar", "measured, mm", "predicted, mm"), arm)
    periods = [(f"{1e3 * row[0]:.0f}", f"{row[1]:.2f}", f"{row[2]:.3f}") for row in validation.periods]
    block = validation.found["silicone_block"]
    of_rest, of_motion = (millimetres(block, held_out=False, moving=moving) for moving in (False, True))
    parts = [("at rest", of_rest), ("let go", of_motion)]
    parts.append(("let go, predicted", millimetres(block, held_out=True, moving=True)))
    texts["block_parts"] = table(
        ("part", "coordinates", "residual, mm"), [(name, f"{part[0]}", f"{part[1]:.2f}") for name, part in parts]
    )
    texts["periods"] = table(("mass, g", "measured, s", "modelled, s"), periods)
    return texts


def marks(name: str) -> tuple[str, str]:
    """Where a text of the page begins and ends."""
    return f"<!-- {name}: written by benchmarks/validation.py -->", f"<!-- end of {name} -->"


def figure_of(validation: Validation) -> Any:
    """A panel for each experiment: dots are measured, lines and crosses modelled."""
    figure = figure_class()(figsize=(13.5, 7.6), layout="constrained")
    panels = figure.subplots(2, 3).ravel()
    draw_strip(panels[0], validation.found["steel_strip"])
    draw_curved(panels[1], validation.found["curved_beam"])
    draw_silicone(panels[2], validation.found["silicone_beam"])
    draw_arm(panels[3], validation.found["silicone_arm"])
    draw_wing(panels[4], validation.found["pazy_wing"])
    draw_robot(panels[5], validation.found["three_tendon_robot"])
    for axes in panels:
        axes.spines[["top", "right"]].set_visible(False)
        axes.legend(fontsize=8, frameon=False)
    return figure


def draw_strip(axes: Any, found: Identification) -> None:
    """Drop of the tip over the load."""
    data = columns("cantilever-steel/strip_tip.csv")
    loads = np.array(data["tip_load_N"], dtype=float)
    curve = np.linspace(0.0, loads.max(), 25)
    drops = [-at(found, {"hung.force": [0, 0, -load]}).tip().position[2] for load in curve]
    axes.plot(curve, 1e3 * np.array(drops), color=MODELLED, label="modelled")
    axes.plot(loads, 1e3 * np.array(data["tip_drop_m"], dtype=float), "o", color=MEASURED, ms=4, label="measured")
    axes.set(title="Steel strip", xlabel="load, N", ylabel="drop of the tip, mm")


def draw_curved(axes: Any, found: Identification) -> None:
    """Shapes under all loads."""
    data = columns("cantilever-steel/curved_shape.csv")
    loads = np.array(data["tip_load_N"], dtype=float)
    points = 1e3 * np.array([data["x_m"], data["y_m"]], dtype=float)
    X = np.linspace(0.0, 1.0, 60)
    for i, load in enumerate(np.unique(loads)):
        shape = 1e3 * at(found, {"hung.force": [0, 0, -load]}).pose(X).position
        axes.plot(shape[:, 0], shape[:, 2], color=MODELLED, label="" if i else "modelled")
        chosen = loads == load
        axes.plot(*points[:, chosen], "o", color=MEASURED, ms=3, label="" if i else "measured, 0 to 480 N")
    axes.set(title="Curved steel beam", xlabel="x, mm", ylabel="y, mm")


def draw_silicone(axes: Any, found: Identification) -> None:
    """Drop of the highest marker over the load."""
    data = columns("silicone-mocap/beam_static.csv")
    chosen = np.array(data["marker"]) == "tip1"
    loads = np.array(data["tip_load_N"], dtype=float)[chosen]
    curve = np.linspace(0.0, loads.max(), 15)
    drops = []
    for load in curve:
        pose = at(found, {"hung.force": [0, 0, -load]}).body("face")
        drops.append(0.021 - (pose.position + pose.rotation @ np.array([0.0, 0.0, 0.021]))[2])
    axes.plot(curve, 1e3 * np.array(drops), color=MODELLED, label="modelled")
    measured = -1e3 * np.array(data["dz_m"], dtype=float)[chosen]
    axes.plot(loads, measured, "o", color=MEASURED, ms=4, label="measured, twice each")
    axes.set(title="Silicone block", xlabel="load, N", ylabel="drop of a marker, mm")


def draw_arm(axes: Any, found: Identification) -> None:
    """Displacement of the tip over the pressure."""
    measured = arm_displacements()
    curve = np.linspace(0.0, max(measured), 17)
    moved = np.array([mean_distance(arm_moved(found, pressure)) for pressure in curve])
    fitted = curve <= 350
    axes.plot(curve[fitted], moved[fitted], color=MODELLED, label="fitted at five pressures")
    axes.plot(curve[curve >= 350], moved[curve >= 350], color=PREDICTED, ls="--", label="predicted")
    distances = [mean_distance(displacements) for displacements in measured.values()]
    axes.plot(list(measured), distances, "o", color=MEASURED, ms=4, label="measured")
    axes.set(title="Silicone arm", xlabel="pressure, mbar", ylabel="displacement of the markers, mm")


def draw_wing(axes: Any, found: Identification) -> None:
    """Heights at the tip over the hung mass, of both tests."""
    tests = (("bending", "middle_z_m", -0.00584, "o"), ("torsion", "leading_z_m", 0.04361, "^"))
    tests += (("torsion", "trailing_z_m", -0.05529, "v"),)
    for name, column, offset, marker in tests:
        data = columns(f"pazy-wing/{name}.csv")
        masses = np.array(data["tip_mass_kg"], dtype=float)
        load = "middle.force" if name == "bending" else "behind.force"
        heights = []
        curve = np.linspace(0.0, masses.max(), 13)
        for mass in curve:
            pose = at(found, {load: [0, 0, -9.807 * mass]}).body("tip")
            heights.append((pose.position + pose.rotation @ np.array([0.0, offset, 0.0]))[2])
        axes.plot(curve, 1e3 * np.array(heights), color=MODELLED)
        words = f"{name}, {column.split('_')[0]}"
        axes.plot(masses, 1e3 * np.array(data[column], dtype=float), marker, color=MEASURED, ms=4, label=words)
    axes.set(title="Pazy wing", xlabel="mass at the tip, kg", ylabel="height, mm")


def draw_robot(axes: Any, found: Identification) -> None:
    """Places of the tip, as seen along the segment."""
    for held_out, colour in ((False, MODELLED), (True, PREDICTED)):
        places = [tips(found.rows, held_out, entry) for entry in (0, 2)]
        measured, modelled = 1e3 * np.array(places).transpose(2, 0, 1)
        if not held_out:
            axes.plot(*measured, "o", color=MEASURED, ms=3, label="measured")
        else:
            axes.plot(*measured, "o", color=MEASURED, ms=3)
        axes.plot(*modelled, "x", color=colour, ms=5, label="predicted" if held_out else "fitted")
        for start, end in zip(measured.T, modelled.T, strict=True):
            axes.plot(*np.array([start, end]).T, color=colour, lw=0.6)
    axes.set(title="Robot with three tendons", xlabel="x, mm", ylabel="z, mm", aspect="equal", ylim=(190, None))


def tips(rows: Sequence[Row], held_out: bool, entry: int) -> FloatArray:
    """Measured and modelled values of one coordinate, shape (rows, 2)."""
    chosen = [row for row in rows if row.held_out is held_out and row.entry == entry]
    return np.array([[row.measured, row.modelled] for row in chosen])


def main(
    write: Annotated[bool, typer.Option("--write", help="write the tables and the figure into docs")] = False,
) -> None:
    """Identify all scenes of examples/validation."""
    validation = validated(report=typer.echo)
    for name, text in pages_tables(validation).items():
        typer.echo(f"\n{name}\n{text}")
        if write:
            put(PAGE, *marks(name), text)
    if write:
        write_figure(figure_of(validation), FIGURE, dpi=110)


if __name__ == "__main__":
    typer.run(main)
