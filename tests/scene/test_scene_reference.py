"""The reference page: committed as generated, complete, with examples that are scenes."""

from __future__ import annotations

import copy
import importlib.util
import re
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest

from cosserat_casadi import scene_from_dict
from cosserat_casadi.scene import Scene
from cosserat_casadi.scene.families import Family, contents_of
from cosserat_casadi.scene.material_records import Material
from cosserat_casadi.scene.measurement_record import MeasurementRecord
from cosserat_casadi.scene.records import Record
from cosserat_casadi.scene.rod_records import STRAINS, SectionRecord
from tests.conftest import ROOT

SCRIPT = ROOT / "docs" / "scene_reference.py"
SPEC = importlib.util.spec_from_file_location("scene_reference", SCRIPT)
assert SPEC is not None
assert SPEC.loader is not None
scene_reference = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(scene_reference)

PAGE = scene_reference.reference_text()
EXAMPLES = re.findall(r"```toml\n(.*?)```", PAGE, flags=re.DOTALL)

# What the examples of the page refer to.
CONTEXT: dict[str, Any] = tomllib.loads("""
schema = 1
[[rods]]
name = "finger"
length = 0.2
strain = "kirchhoff"
material = { youngs_modulus = 2.0e9, poisson_ratio = 0.4, density = 1100.0 }
section = { shape = "circle", radius = 2.0e-3 }
[[rods]]
name = "arm"
length = 0.2
strain = "kirchhoff"
stiffness = { bending_x = 1.0, bending_y = 1.0, torsion = 0.8 }
linear_density = 0.01
[[bodies]]
name = "platform"
[[joints]]
rod = "arm"
body = "platform"
kind = "fixed"
[[loads]]
name = "push"
kind = "tip_wrench"
rod = "finger"
force = [0.1, 0, 0]
[[actuators]]
name = "cable"
kind = "tendon"
rod = "finger"
tension = 3.0
offset = [1.5e-3, 0.0]
""")


def completed(example: str) -> dict[str, Any]:
    """The scene of an example: its tables stand beside those of the context, inner tables in their owners."""
    tables = copy.deepcopy(CONTEXT)
    own = tomllib.loads(example)
    if "tubes" in own:
        # Tubes stand alone.
        return {"schema": 1, **own}
    for key, value in own.items():
        if key == "helix":
            del tables["actuators"][0]["offset"]
            tables["actuators"][0][key] = value
        elif key == "wall":
            chamber = {"name": "bellows", "kind": "chamber", "rod": "finger", "pressure": 1e4, key: value}
            tables["actuators"].append(chamber)
        elif key == "friction":
            ground = {"name": "ground", "kind": "plane", "point": [0, 0, -1.0], "normal": [0, 0, 1], "width": 1e-3}
            tables.setdefault("obstacles", []).append({**ground, key: value})
        elif key not in scene_reference.contents_by_key(Scene):
            rod = tables["rods"][0]
            if key == "stiffness":
                del rod["material"], rod["section"]
            rod[key] = value
        elif isinstance(value, list) and isinstance(value[0], dict):
            names = {entry.get("name", "") for entry in value}
            tables[key] = [entry for entry in tables.get(key, []) if entry.get("name") not in names] + value
        else:
            tables[key] = value
    return tables


def records(
    record: type[Record] = Scene, path: str = "", met: dict[type[Record], str] | None = None
) -> dict[type[Record], str]:
    """Every record that a scene may hold, each with the heading of its family; empty where it has none."""
    met = {record: ""} if met is None else met
    for key, field in record.model_fields.items():
        contents = contents_of(field)
        if isinstance(contents, Family):
            heading = f"`{path}.{key}`" if path else f"`[[{key}]]`"
            inner = dict.fromkeys(contents.records.values(), heading)
        else:
            inner = {} if contents is None else {contents: ""}
        for kind, heading in inner.items():
            if kind not in met:
                met[kind] = heading
                records(kind, f"{path}.{key}" if path else key, met)
    return met


SECTIONS = re.split(r"^#+ ", PAGE, flags=re.MULTILINE)[1:]
"""Sections of the page, each of which begins with its heading."""


def sections_of(record: type[Record]) -> list[str]:
    """Sections with the example of a record: materials of rods and of tubes have the same one."""
    return [section for section in SECTIONS if f"```toml\n{record.example}```" in section]


def keys_in(section: str) -> list[str]:
    """Keys of the lines of a section's table."""
    return re.findall(r"^\| `(\w+)` \|", section, flags=re.MULTILINE)


def lines() -> list[list[str]]:
    """The cells of every line of a table of keys."""
    rows = [line.strip("| ").split(" | ") for line in PAGE.splitlines() if line.startswith("| `")]
    return [row for row in rows if len(row) == 5]


def test_the_committed_page_is_the_generated_one() -> None:
    assert scene_reference.COMMITTED.read_text(encoding="utf-8") == PAGE


@pytest.mark.slow
def test_the_module_writes_the_committed_page(tmp_path: Path) -> None:
    page = tmp_path / "scene.md"
    program = f"""
import pathlib, runpy
write = pathlib.Path.write_text
pathlib.Path.write_text = lambda path, text, encoding: write(pathlib.Path({str(page)!r}), text, encoding)
runpy.run_path({str(SCRIPT)!r}, run_name="__main__")
"""
    subprocess.run([sys.executable, "-c", program], check=True)
    assert page.read_text(encoding="utf-8") == PAGE


@pytest.mark.parametrize("example", EXAMPLES, ids=range(len(EXAMPLES)))
def test_every_example_is_part_of_a_scene(example: str) -> None:
    scene_from_dict(completed(example))


def test_a_key_that_is_not_read_is_not_in_an_example() -> None:
    """The examples are read, not passed over: a faulty one is refused."""
    with pytest.raises(Exception, match="unknown key"):
        scene_from_dict(completed('[[rods]]\nname = "finger"\nlenght = 0.2\n'))


def test_every_record_has_an_example_and_every_key_a_line() -> None:
    """Keys that all kinds of a family have stand in the section of the family, all others in the record's own."""
    for record, heading in records().items():
        of_family = [section for section in SECTIONS if heading and section.partition("\n")[0] == heading]
        shared = [key for section in of_family for key in keys_in(section)]
        expected = [key for key in scene_reference.contents_by_key(record) if not in_a_heading(record, key)]
        told = [sorted(keys_in(section) + shared) for section in sections_of(record)]
        assert sorted(expected) in told, record.__name__


def test_tables_that_several_tables_hold_have_one_section() -> None:
    """Turns about three axes stand in bases, supports, joints and targets."""
    euler = [section for section in SECTIONS if ".euler`" in section.partition("\n")[0]]
    assert len(euler) == 1
    assert PAGE.count("(#rodsbaseeuler)") == 6


def test_keys_of_all_kinds_have_one_line() -> None:
    """Kinds of obstacles share what says who touches them, and how."""
    assert PAGE.count("| `slip_speed` |") == len(["obstacles", "rod_contacts"])
    (sphere,) = [section for section in SECTIONS if section.startswith('`kind = "sphere"`')]
    assert keys_in(sphere) == ["radius", "centre"]


def in_a_heading(record: type[Record], key: str) -> bool:
    """Whether a key heads a section: a table of the scene, or the word of a kind."""
    if record is Scene:
        return scene_reference.contents_by_key(Scene)[key] is not None
    if key == "quantity":
        return issubclass(record, MeasurementRecord)
    if key == "law":
        return issubclass(record, Material)
    return key == "kind" or (key == "shape" and issubclass(record, SectionRecord))


def test_every_number_has_a_unit_or_has_none_by_nature() -> None:
    without = [row[0] for row in lines() if row[2] == "–" and re.search("number|component", row[1])]
    in_another_unit = {"`amplitude`", "`lower`", "`mean`", "`shift`", "`sigma`", "`upper`", "`values`"}
    counts = {"`count`", "`fibres`", "`frames`", "`modes`", "`nodes`", "`sections`", "`starts`"}
    # The coefficient of a term has the unit of energy per length over its powers, which are counts.
    powers = {f"`{name}`" for name in STRAINS}
    # A pair of Ogden's has a modulus and an exponent.
    entries = {"`coefficient`", "`ogden`"}
    assert set(without) == in_another_unit | counts | powers | entries | {"`quaternion`", "`span`"}


def test_links_lead_to_headings() -> None:
    titles = [re.sub(r"[^\w -]", "", line.lstrip("# ")) for line in PAGE.splitlines() if line.startswith("#")]
    headings = [title.lower().replace(" ", "-") for title in titles]
    for anchor in re.findall(r"\]\(#([^)]+)\)", PAGE):
        assert headings.count(anchor) == 1, anchor
    for path in re.findall(r"\]\(([^)#]+)\)", PAGE):
        assert (scene_reference.COMMITTED.parent / path).exists(), path
