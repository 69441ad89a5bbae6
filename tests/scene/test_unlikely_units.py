"""Numbers in another unit than the format's are taken as they are, and warned of when the file is read."""

from __future__ import annotations

from pathlib import Path

import pytest

from cosserat_casadi import read_scene
from tests.conftest import ROOT

WIRE = ROOT / "examples" / "nitinol_wire.toml"


@pytest.mark.parametrize(
    ("override", "note"),
    [
        ("wire.material.youngs_modulus=60", "rods[0].material.youngs_modulus: 60 Pa is softer than any rod"),
        ("wire.material.youngs_modulus=2.1e20", "rods[0].material.youngs_modulus: 2.1e+20 Pa is stiffer than diamond"),
        ("wire.material.density=1e6", "rods[0].material.density: 1e+06 kg/m³ is heavier than any metal"),
        ("weight.acceleration=[0,0,-1e6]", "loads[0].acceleration: 1e+06 m/s² is above any gravity"),
        ("wire.length=4", ""),
        ("wire.material.density=6.45", "rods[0].material.density: 6.45 kg/m³ is lighter than foam"),
        ("wire.section.radius=0.5", "rods[0].section.radius: 0.5 m is more than the length of 0.2 m"),
        (
            "wire.section.radius={ base = 5e-4, tip = 0.5 }",
            "rods[0].section.radius: 0.5 m is more than the length of 0.2 m",
        ),
        ("wire.length=200", "rods[0]: the length of 200 m is over 100000 sizes of the section"),
        ("wire.length=0.3", ""),
    ],
)
def test_a_number_in_another_unit_is_noted(override: str, note: str, caplog: pytest.LogCaptureFixture) -> None:
    scene = read_scene(WIRE, [override])
    assert scene.rods[0].name == "wire"
    notes = [record.getMessage() for record in caplog.records]
    assert [text.partition(" (")[0] for text in notes] == [note] * bool(note)


@pytest.mark.parametrize(
    ("override", "note"),
    [
        ("inner.material.youngs_modulus=60", "tubes[1].material.youngs_modulus: 60 Pa is softer than any rod"),
        ("outer.section={outer_radius=1.2,inner_radius=1.0}", "tubes[0].section."),
        ("inner.rotation=60", "tubes[1].rotation: 60 rad is more than two turns"),
        ("inner.rotation=9", ""),
    ],
)
def test_a_tube_in_another_unit_is_noted(override: str, note: str, caplog: pytest.LogCaptureFixture) -> None:
    read_scene(ROOT / "examples" / "concentric_tubes.toml", [override])
    notes = [record.getMessage() for record in caplog.records]
    assert bool(notes) == bool(note)
    assert all(text.startswith(note) for text in notes)


@pytest.mark.parametrize(("stop", "noted"), [("90", True), ("1.5", False)])
def test_a_stop_in_degrees_is_noted(stop: str, noted: bool, caplog: pytest.LogCaptureFixture) -> None:
    read_scene(ROOT / "examples" / "pendulum_chain.toml", [f"elbow.upper_stop={stop}"])
    assert [record.getMessage() for record in caplog.records] == [
        "joints[1].upper_stop: 90 rad is more than two turns (is it in rad?)"
    ] * noted


@pytest.mark.parametrize(
    ("radius", "warned"), [("0.01", False), ("{ base = 0.02, tip = 0.01 }", False), ("1e-3", True)]
)
def test_a_rod_without_units_is_not_warned_of(
    radius: str, warned: bool, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """All numbers of a rod that is computed without units are near one."""
    file = tmp_path / "rod.toml"
    file.write_text(f"""\
schema = 1

[[rods]]
name = "rod"
strain = "planar"
length = 1.0
material = {{ youngs_modulus = 1.0, poisson_ratio = 0.0, density = 1.0 }}
section = {{ shape = "circle", radius = {radius} }}
""")
    read_scene(file)
    assert len(caplog.records) == 2 * warned


def test_no_example_is_warned_of(caplog: pytest.LogCaptureFixture) -> None:
    examples: list[Path] = sorted((ROOT / "examples").glob("*.toml"))
    assert len(examples) > 30
    for example in examples:
        read_scene(example)
    assert not caplog.records
