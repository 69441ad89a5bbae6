"""Scenes of several rods, bodies and joints: what is read, and what is refused."""

from __future__ import annotations

import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import SceneError, parse_scene, scene_from_dict
from cosserat_casadi.scene import PrismaticJoint, RevoluteJoint
from cosserat_casadi.scene.writing import scene_text
from tests.scenes import rod as rod_table

ROD = """[[rods]]
name = "{name}"
length = 0.2
strain = "kirchhoff"
stiffness = {{ bending_x = 1.0, bending_y = 1.0, torsion = 0.8 }}
base = {base}
"""
PLATE = '[[bodies]]\nname = "plate"\n'


def rod(name: str, base: str = "{ position = [0, 0, 0] }") -> str:
    return ROD.format(name=name, base=base)


def joint(rod: str = "a", body: str = "plate", rest: str = 'kind = "fixed"') -> str:
    return f'[[joints]]\nrod = "{rod}"\nbody = "{body}"\n{rest}\n'


def refusals(*parts: str) -> list[tuple[str, str]]:
    with pytest.raises(SceneError) as refused:
        parse_scene("schema = 1\n" + "\n".join(parts))
    return [(problem.where, problem.problem) for problem in refused.value.problems]


def test_bodies_joints_and_bases_are_read() -> None:
    scene = parse_scene(
        "schema = 1\n" + rod("a") + rod("b", '{ rod = "a", at = 0.5 }') + PLATE + joint("a", rest='kind = "spherical"')
    )
    assert (scene.bodies[0].mass, scene.bodies[0].centre_of_mass) == (0.0, (0.0, 0.0, 0.0))
    assert (scene.joints[0].kind, scene.joints[0].position) == ("spherical", (0.0, 0.0, 0.0))
    assert (scene.rods[1].base.rod, scene.rods[1].base.at) == ("a", 0.5)
    assert scene.rods[0].base.rod is None


@pytest.mark.parametrize(("kind", "record"), [("revolute", RevoluteJoint), ("prismatic", PrismaticJoint)])
def test_axes_of_joints_have_length_one(kind: str, record: type) -> None:
    rest = f'kind = "{kind}"\naxis = [0, 3, 4]\nposition = [0, 0, 1]\nquaternion = [0, 1, 0, 0]'
    scene = parse_scene("schema = 1\n" + rod("a") + PLATE + joint(rest=rest))
    assert isinstance(scene.joints[0], record)
    assert_allclose(scene.joints[0].axis, (0.0, 0.6, 0.8), rtol=0, atol=1e-15)
    assert scene.joints[0].quaternion == (0.0, 1.0, 0.0, 0.0)
    assert parse_scene(scene_text(scene)) == scene


HELD = rod("a") + PLATE + joint()
REFUSED = {
    "unknown_carrier": (rod("a", '{ rod = "x" }'), "rods[0].base.rod", "no rod is named 'x'"),
    "itself": (rod("a", '{ rod = "a" }'), "rods[0].base.rod", "a rod cannot start on itself"),
    "at_base": (rod("a") + rod("b", '{ rod = "a", at = 0.0 }'), "rods[1].base.at", "must be > 0 and <= 1, got 0.0"),
    "at_alone": (rod("a", "{ at = 0.5 }"), "rods[0].base.at", "stands without rod"),
    "nobody": (rod("a") + PLATE, "bodies[0]", "nobody holds the body 'plate': no joint names it"),
    "unknown_body": (HELD + rod("b") + joint("b", "table"), "joints[1].body", "no body is named 'table'"),
    "unknown_rod": (HELD + joint("x"), "joints[1].rod", "no rod is named 'x'"),
    "twice": (HELD + joint(), "joints[1].rod", "joints[0] holds the tip of 'a' already"),
    "supported": (
        HELD.replace("fixed", "spherical") + '[[supports]]\nrod = "a"\nkind = "pinned"\nposition = [0, 0, 0.1]\n',
        "joints[0].rod",
        "supports[0] holds the tip of 'a' already",
    ),
    "kind": (rod("a") + PLATE + joint(rest='kind = "hinge"'), "joints[0].kind", "must be one of 'fixed', 'spherical'"),
    "axis": (rod("a") + PLATE + joint(rest='kind = "revolute"'), "joints[0].axis", "missing"),
    "no_axis": (
        rod("a") + PLATE + joint(rest='kind = "prismatic"\naxis = [0, 0, 0]'),
        "joints[0].axis",
        "must not be zero",
    ),
    "short_axis": (
        rod("a") + PLATE + joint(rest='kind = "prismatic"\naxis = [0, 1]'),
        "joints[0].axis",
        "must be a list of 3 numbers, got 2",
    ),
    "fixed_axis": (
        rod("a") + PLATE + joint(rest='kind = "fixed"\naxis = [0, 0, 1]'),
        "joints[0].axis",
        "unknown key",
    ),
    "mass": (rod("a") + PLATE + "mass = -1.0\n" + joint(), "bodies[0].mass", "must be >= 0, got -1.0"),
    "load": (
        HELD + '[[loads]]\nname = "p"\nkind = "body_wrench"\nbody = "b"\nforce = [0, 0, 1]\n',
        "loads[0].body",
        "no body is named 'b'",
    ),
    "weighed": (
        HELD + '[[loads]]\nname = "w"\nkind = "gravity"\nacceleration = [0, 0, -9.81]\nbodies = ["b"]\n',
        "loads[0].bodies[0]",
        "no body is named 'b'",
    ),
}


@pytest.mark.parametrize("carries", ['"plate"', "{ position = [0, 0, 1] }"])
def test_a_faulty_carried_body_is_told_alone(carries: str) -> None:
    told = refusals(rod("a") + PLATE + f'[[joints]]\nkind = "fixed"\ncarries = {carries}\n')
    assert [where for where, _ in told if where.startswith("joints")] in (
        ["joints[0].carries"],
        ["joints[0].carries.body"],
    )


def test_an_end_in_the_world_is_at_its_origin_by_default() -> None:
    ends = "between = [{ world = true }, { %s }]"
    for end in ('body = "plate"', 'rod = "a"'):
        text = "schema = 1\n" + rod("a") + '[[joints]]\nkind = "spherical"\n' + ends % end
        scene = parse_scene(text + ("\n" + PLATE if "plate" in end else ""))
        assert scene.joints[0].position == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("case", REFUSED)
def test_refusals(case: str) -> None:
    text, where, problem = REFUSED[case]
    assert any(w == where and problem in p for w, p in refusals(text)), refusals(text)


def test_a_circle_of_rods_is_told_of_every_rod_in_it() -> None:
    text = rod("a", '{ rod = "b" }') + rod("b", '{ rod = "a" }') + rod("c", '{ rod = "a" }')
    assert refusals(text) == [
        ("rods[0].base.rod", "rods that carry each other in a circle: 'a' on 'b' on 'a'"),
        ("rods[1].base.rod", "rods that carry each other in a circle: 'b' on 'a' on 'b'"),
    ]


def test_a_name_that_is_no_text_is_refused_and_not_quoted() -> None:
    tables = {"schema": 1, "rods": [rod_table()], "bodies": [{"name": "\ud800"}]}
    with pytest.raises(SceneError) as refused:
        scene_from_dict(tables)
    assert [problem.where for problem in refused.value.problems] == ["bodies[0]", "bodies[0].name"]
