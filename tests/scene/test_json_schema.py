"""The JSON schema: committed as generated, true of good scenes, false of bad ones."""

import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from jsonschema import Draft202012Validator

from cosserat_casadi.scene import json_schema

CASES = Path(__file__).parents[2].with_name("shared") / "cases"
SCENES = sorted(path for folder in ("rods", "supports") for path in (CASES / folder).glob("*.toml"))
VALIDATOR = Draft202012Validator(json_schema.scene_json_schema())

GOOD = """
schema = 1
[[rods]]
name = "finger"
length = 0.2
strain = ["bending_y", "extension"]
material = { youngs_modulus = 2.0e9, poisson_ratio = 0.4, density = 1100.0 }
section = { shape = "circle", radius = [2.0e-3, 1.0e-3] }
[[loads]]
name = "poke"
kind = "point_wrench"
rod = "finger"
at = 0.5
force = [0.1, 0, 0]
[[loads]]
name = "wind"
kind = "distributed_wrench"
rod = "finger"
force = [1, [0, 1], 0]
[[supports]]
rod = "finger"
kind = "pinned"
position = [0.1, 0, 0.1]
"""


def properties(node):
    """Every property of every record in the schema, with its name."""
    records = [node, *node["$defs"].values()]
    return [(name, entry) for record in records for name, entry in record.get("properties", {}).items()]


def test_the_committed_schema_is_the_generated_one():
    assert json_schema.COMMITTED.read_text(encoding="utf-8") == json_schema.schema_text()


@pytest.mark.slow
def test_the_module_writes_the_committed_schema(tmp_path):
    copy = tmp_path / "scene.schema.json"
    program = f"""
import pathlib, runpy
write = pathlib.Path.write_text
pathlib.Path.write_text = lambda path, text, encoding: write(pathlib.Path({str(copy)!r}), text, encoding)
runpy.run_module("cosserat_casadi.scene.json_schema", run_name="__main__")
"""
    subprocess.run([sys.executable, "-c", program], check=True)
    assert copy.read_text(encoding="utf-8") == json_schema.schema_text()


def test_the_schema_is_a_schema():
    Draft202012Validator.check_schema(json_schema.scene_json_schema())


def test_every_key_is_described():
    assert [name for name, entry in properties(json_schema.scene_json_schema()) if not entry.get("description")] == []


@pytest.mark.parametrize(
    ("written", "table"),
    [
        ("[2.0e-3, 1.0e-3]", "{ base = 2.0e-3, tip = 1.0e-3 }"),
        ("[2.0e-3, 1.0e-3]", "{ powers = [2.0e-3, -1.0e-3] }"),
        ("[0, 1]", "{ base = -1, tip = 1.0 }"),
        ("[0, 1]", "{ legendre = [0, 1, 2] }"),
        ("[0, 1]", "[0, 1]"),
    ],
)
def test_a_good_scene_validates(written, table):
    assert written in GOOD
    VALIDATOR.validate(tomllib.loads(GOOD.replace(written, table)))


@pytest.mark.parametrize(
    ("good", "bad"),
    [
        ("schema = 1", "schema = 2"),
        ("length = 0.2", "length = -0.2"),
        ("length = 0.2", "lenght = 0.2"),
        ("radius = [2.0e-3, 1.0e-3]", "radius = [2.0e-3]"),
        ("radius = [2.0e-3, 1.0e-3]", "radius = 0"),
        ('"bending_y"', '"bending"'),
        ("at = 0.5", "at = 0.0"),
        ("at = 0.5", "at = 1.5"),
        ("force = [0.1, 0, 0]", "force = [0.1, 0]"),
        ('"pinned"', '"clamped"'),
        ("[2.0e-3, 1.0e-3]", "{ base = 2.0e-3 }"),
        ("[2.0e-3, 1.0e-3]", "{ base = 2.0e-3, tip = 0.0 }"),
        ("[2.0e-3, 1.0e-3]", "{ powers = [2.0e-3, 1.0e-3, 1.0] }"),
        ("[0, 1]", "{ powers = [1.0], legendre = [1.0] }"),
        ("[0, 1]", "{ powers = [] }"),
        ("[0, 1]", "{ power = [1.0] }"),
        ("[0, 1]", "{}"),
    ],
)
def test_a_bad_scene_does_not_validate(good, bad):
    assert good in GOOD
    assert not VALIDATOR.is_valid(tomllib.loads(GOOD.replace(good, bad)))


@pytest.mark.skipif(not SCENES, reason="the reference cases are not here")
@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_reference_scenes_validate(path):
    VALIDATOR.validate(tomllib.loads(path.read_text(encoding="utf-8")))
