"""Good scenes: what is read, what is assumed, what stays free, and what an override changes."""

import copy
from pathlib import Path

import pytest
from numpy.testing import assert_allclose
from pydantic import ValidationError

from cosserat_casadi.scene import (
    Annulus,
    Circle,
    ClampedSupport,
    DistributedWrench,
    Gravity,
    PinnedSupport,
    PointWrench,
    Rectangle,
    Rod,
    Scene,
    Stiffness,
    TipWrench,
    parse_scene,
    read_scene,
    scene_from_dict,
)

CASES = Path(__file__).parents[2].with_name("shared") / "cases"
SCENES = sorted(path for folder in ("rods", "supports") for path in (CASES / folder).glob("*.toml"))

FINGER = """
schema = 1
title = "Soft finger, own weight and a tip push"

[accuracy]
tolerance = 1e-7

[[rods]]
name = "finger"
length = 0.2
strain = "kirchhoff"
material = { youngs_modulus = 2.0e9, poisson_ratio = 0.4, density = 1100.0 }
section = { shape = "circle", radius = [2.0e-3, 1.0e-3] }

[[rods]]
name = "thumb"
length = 1
strain = ["extension", "bending_y"]
basis = "chebyshev"
stiffness = { bending_y = 1.0, extension = [2, 1] }
linear_density = 0.01
intrinsic = { curvature = [0, [1, 2], 0] }
base = { position = [1, 0, 0], tangent = [0, 2, 0] }

[[loads]]
name = "weight"
kind = "gravity"
acceleration = [0, 0, -9.81]

[[loads]]
name = "push"
kind = "tip_wrench"
rod = "finger"
moment = [0, 1, 0]
force = [0.1, 0, 0]
frame = "body"

[[loads]]
name = "poke"
kind = "point_wrench"
rod = "thumb"
at = 0.5
moment = [0, 1, 0]

[[loads]]
name = "wind"
kind = "distributed_wrench"
rod = "thumb"
force = [1, [0, 1], 0]

[[supports]]
name = "wall"
rod = "finger"
kind = "clamped"
position = [0.1, 0, 0.1]
quaternion = [0.70710678, 0, 0.70710678, 0]

[[supports]]
rod = "thumb"
kind = "pinned"
position = [1.2, 0.5, 0.0]
"""


@pytest.fixture
def finger():
    return parse_scene(FINGER)


def minimal():
    stiffness = {"bending_x": 1, "bending_y": 1, "torsion": 1}
    return {"schema": 1, "rods": [{"name": "a", "length": 1, "strain": "kirchhoff", "stiffness": stiffness}]}


def with_strain(strain):
    tables = minimal()
    stiffness = dict.fromkeys(("bending_x", "bending_y", "torsion", "shear_x", "shear_y", "extension"), 1.0)
    tables["rods"][0] |= {"strain": strain, "stiffness": stiffness}
    return scene_from_dict(tables)


def test_every_table_becomes_its_record(finger):
    assert [type(load) for load in finger.loads] == [Gravity, TipWrench, PointWrench, DistributedWrench]
    assert [type(support) for support in finger.supports] == [ClampedSupport, PinnedSupport]
    assert isinstance(finger.rods[0].section, Circle)
    assert isinstance(finger.rods[1].stiffness, Stiffness)


def test_values_are_read_as_they_stand(finger):
    assert finger.title == "Soft finger, own weight and a tip push"
    assert finger.accuracy.tolerance == 1e-7
    assert finger.rods[0].section.radius == (2e-3, 1e-3)
    assert finger.rods[1].length == 1.0
    assert isinstance(finger.rods[1].length, float)
    assert finger.rods[1].stiffness.extension == (2.0, 1.0)
    assert finger.rods[1].intrinsic.curvature == (0.0, (1.0, 2.0), 0.0)
    assert finger.loads[1].frame == "body"
    assert finger.loads[2].at == 0.5
    assert finger.loads[3].force == (1.0, (0.0, 1.0), 0.0)
    assert [support.name for support in finger.supports] == ["wall", None]


def test_directions_and_quaternions_have_norm_one(finger):
    half = 0.5**0.5
    assert finger.rods[1].base.tangent == (0.0, 1.0, 0.0)
    assert_allclose(finger.supports[0].quaternion, [half, 0, half, 0], rtol=0, atol=3e-16)


def test_what_is_left_out_has_a_default():
    scene = scene_from_dict(minimal())
    rod = scene.rods[0]
    assert (scene.schema_version, scene.title, scene.inputs) == (1, "", None)
    assert (scene.accuracy.tolerance, scene.accuracy.modes, scene.accuracy.nodes) == (1e-6, None, None)
    assert (scene.loads, scene.supports, scene.actuators) == ((), (), ())
    assert (rod.basis, rod.material, rod.section, rod.linear_density) == ("legendre", None, None, None)
    assert rod.intrinsic.curvature == (0.0, 0.0, 0.0)
    assert rod.intrinsic.tangent == (0.0, 0.0, 1.0)
    assert rod.base.position == (0.0, 0.0, 0.0)
    assert rod.base.quaternion == (1.0, 0.0, 0.0, 0.0)
    assert rod.base.tangent is None


def test_a_wrench_has_its_defaults(finger):
    assert finger.loads[2].force == (0.0, 0.0, 0.0)
    assert finger.loads[2].frame == "world"
    assert finger.loads[0].rods is None
    assert finger.rods[0].section.shear_correction == 1.0


@pytest.mark.parametrize(
    ("strain", "admitted"),
    [
        ("planar", (1,)),
        ("kirchhoff", (0, 1, 2)),
        ("reissner", (0, 1, 2, 3, 4, 5)),
        (["extension", "bending_y"], (1, 5)),
        (["shear_y", "shear_x", "torsion", "bending_x"], (0, 2, 3, 4)),
    ],
)
def test_admitted_strains_stand_in_the_canonical_order(strain, admitted):
    assert with_strain(strain).rods[0].admitted == admitted


@pytest.mark.parametrize(
    ("section", "record"),
    [
        ({"shape": "annulus", "outer_radius": [2, 1], "inner_radius": 0, "shear_correction": 0.9}, Annulus),
        ({"shape": "rectangle", "width": 2, "height": [1, 2]}, Rectangle),
    ],
)
def test_sections_of_all_shapes_are_read(section, record):
    tables = minimal()
    del tables["rods"][0]["stiffness"]
    tables["rods"][0] |= {"section": section, "material": {"youngs_modulus": 1, "shear_modulus": 1}}
    assert isinstance(scene_from_dict(tables).rods[0].section, record)


def test_inputs_are_the_magnitudes_that_the_file_gives(finger):
    names = ("weight.acceleration", "push.force", "push.moment", "poke.moment", "wind.force")
    assert finger.input_names() == names


def test_inputs_are_those_listed():
    assert parse_scene('inputs = ["poke.force", "push.force"]\n' + FINGER).input_names() == ("poke.force", "push.force")
    assert parse_scene("inputs = []\n" + FINGER).input_names() == ()


def test_records_cannot_be_changed(finger):
    with pytest.raises(ValidationError):
        finger.rods[0].length = 1.0


def test_records_can_be_made_in_python():
    tables = minimal()
    scene = Scene(schema=1, rods=(Rod(**tables["rods"][0]),))
    assert scene == scene_from_dict(tables)


def test_gravity_asks_density_only_of_the_rods_it_names():
    tables = minimal()
    tables["rods"].append({**tables["rods"][0], "name": "b", "linear_density": 1})
    tables["loads"] = [{"name": "g", "kind": "gravity", "acceleration": [0, 0, -1], "rods": ["b"]}]
    assert scene_from_dict(tables).loads[0].rods == ("b",)


def test_a_wrench_on_a_held_tip_is_legal(finger):
    assert finger.loads[1].rod == finger.supports[0].rod


@pytest.mark.parametrize(
    ("quaternion", "base"),
    [
        ([0.8, 0, 0.6, 0], {}),
        ([-0.8, 0, 0.6, 0], {}),
        ([0.5, 0.5, 0.5, 0.5], {"quaternion": [0.5, 0.5, 0.5, 0.5]}),
        ([0.0, 0.0, 0.0, 1.0], {"tangent": [0, 0, -1]}),
    ],
)
def test_a_planar_rod_may_be_held_in_its_plane(quaternion, base):
    tables = minimal()
    tables["rods"][0] |= {"strain": "planar", "base": base}
    tables["supports"] = [{"rod": "a", "kind": "clamped", "position": [0, 0, 0], "quaternion": quaternion}]
    assert scene_from_dict(tables).supports[0].rod == "a"


def test_a_rod_that_stretches_may_be_held_beyond_its_length():
    tables = minimal()
    tables["rods"][0]["strain"] = ["bending_y", "extension"]
    tables["rods"][0]["stiffness"] = {"bending_y": 1, "extension": 1}
    tables["supports"] = [{"rod": "a", "kind": "pinned", "position": [0, 0, 1.5]}]
    assert scene_from_dict(tables).supports[0].position == (0.0, 0.0, 1.5)


@pytest.mark.parametrize(
    ("override", "found", "value"),
    [
        ("push.force=[0.2,0,0]", lambda s: s.loads[1].force, (0.2, 0.0, 0.0)),
        ("push.force[1] = 3", lambda s: s.loads[1].force, (0.1, 3.0, 0.0)),
        ('push.frame="world"', lambda s: s.loads[1].frame, "world"),
        ("poke.at=0.25", lambda s: s.loads[2].at, 0.25),
        ("poke.force=[1, 0, 0]", lambda s: s.loads[2].force, (1.0, 0.0, 0.0)),
        ("wall.position=[0, 0, 0.1]", lambda s: s.supports[0].position, (0.0, 0.0, 0.1)),
        ("supports[1].position=[1, 0, 0]", lambda s: s.supports[1].position, (1.0, 0.0, 0.0)),
        ("supports.1.position=[1, 0, 0]", lambda s: s.supports[1].position, (1.0, 0.0, 0.0)),
        ("accuracy.tolerance=1e-9", lambda s: s.accuracy.tolerance, 1e-9),
        ("rods.finger.length=0.3", lambda s: s.rods[0].length, 0.3),
        ("finger.length=0.3", lambda s: s.rods[0].length, 0.3),
        ("finger.section.radius=1e-3", lambda s: s.rods[0].section.radius, 1e-3),
        ("finger.base.position=[0.0, 0.0, 0.01]", lambda s: s.rods[0].base.position, (0.0, 0.0, 0.01)),
        ('title="a = b"', lambda s: s.title, "a = b"),
    ],
)
def test_an_override_changes_one_value(override, found, value):
    assert found(parse_scene(FINGER, overrides=(override,))) == value


def test_the_last_override_wins():
    scene = parse_scene(FINGER, overrides=("finger.length=0.3", "rods.finger.length=0.4"))
    assert scene.rods[0].length == 0.4


def test_an_override_mends_a_fault():
    text = FINGER.replace("length = 0.2", "length = -0.2")
    assert parse_scene(text, overrides=("finger.length=0.2",)) == parse_scene(FINGER)


def test_overrides_leave_the_given_tables_as_they_are():
    tables = minimal()
    before = copy.deepcopy(tables)
    assert scene_from_dict(tables, overrides=("a.length=2", "accuracy.nodes=9")).accuracy.nodes == 9
    assert tables == before


@pytest.mark.parametrize("text", [FINGER, "\ufeff" + FINGER, FINGER.replace("\n", "\r\n")], ids=["lf", "bom", "crlf"])
def test_a_file_reads_as_its_text(tmp_path, text):
    path = tmp_path / "finger.toml"
    path.write_bytes(text.encode())
    assert read_scene(path) == parse_scene(FINGER)
    assert read_scene(str(path), overrides=["finger.length=0.3"]).rods[0].length == 0.3


@pytest.mark.skipif(not SCENES, reason="the reference cases are not here")
@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_reference_scenes_are_read(path):
    assert read_scene(path).rods
