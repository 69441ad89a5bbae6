"""The key ``parameters``: which names stand for numbers of a scene, and what is refused."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from cosserat_casadi import SceneError, scene_from_dict
from cosserat_casadi.scene.parameter_records import PARAMETER_LISTS

EXAMPLES = Path(__file__).parents[2] / "examples"

ROD: dict[str, Any] = {
    "name": "wire",
    "length": 0.3,
    "strain": "kirchhoff",
    "material": {"youngs_modulus": 6e10, "poisson_ratio": 0.3, "density": 6450.0},
    "section": {"shape": "circle", "radius": {"base": 1e-3, "tip": 5e-4}},
    "intrinsic": {"curvature": [0, [4, 1], 0]},
}

CURVE = {"bending_x": [[0.0, 0.0], [10.0, 0.02], [20.0, 0.03]]}
LATTICE = {**ROD, "name": "lattice", "material": {**ROD["material"], "law": "table", "table": CURVE}}
BAR = {
    "name": "bar",
    "kind": "capsule",
    "from": [2.0, -0.1, 0.1],
    "to": [2.0, 0.1, 0.1],
    "radius": 0.01,
    "width": 1e-3,
    "friction": {"along": 0.1, "across": 0.2},
    "rods": ["wire"],
}

SCENE: dict[str, Any] = {
    "schema": 1,
    "rods": [ROD, {**ROD, "name": "side", "base": {"position": [1, 0, 0], "tangent": [1, 0, 0]}}, LATTICE],
    "obstacles": [BAR],
    "loads": [{"name": "push", "kind": "point_wrench", "rod": "wire", "at": 0.5, "force": [0.1, 0, 0]}],
    "actuators": [
        {"name": "east", "kind": "tendon", "rod": "wire", "tension": 1.0, "offset": [[8e-4, 1e-4], 0]},
        {"name": "coil", "kind": "tendon", "rod": "wire", "tension": 1.0, "helix": {"radius": 1e-3, "turns": 1.0}},
    ],
    "bodies": [{"name": "plate", "mass": 0.1}],
    "joints": [{"body": "plate", "rod": "wire", "kind": "revolute", "axis": [1, 0, 0]}],
    "inputs": ["push.force"],
    "accuracy": {"modes": 4},
}

NAMED = {
    "wire.material.youngs_modulus": ("Pa", [[6e10]]),
    "wire.material.poisson_ratio": ("1", [[0.3]]),
    "wire.length": ("m", [[0.3]]),
    "wire.section.radius": ("m", [[1e-3, 5e-4]]),
    "wire.section.radius.tip": ("m", [[5e-4]]),
    "wire.intrinsic.curvature": ("1/m", [[0, 0], [4, 1], [0, 0]]),
    "wire.intrinsic.curvature.y": ("1/m", [[4, 1]]),
    "wire.intrinsic.curvature.y[1]": ("1/m", [[1]]),
    "wire.intrinsic.curvature.x": ("1/m", [[0]]),
    "wire.intrinsic.curvature.x[0]": ("1/m", [[0]]),
    "wire.base.position": ("m", [[0], [0], [0]]),
    "east.offset": ("m", [[8e-4, 1e-4], [0, 0]]),
    "east.offset.x[0]": ("m", [[8e-4]]),
    "coil.helix.turns": ("1", [[1]]),
    "plate.mass": ("kg", [[0.1]]),
    "joints[0].position.z": ("m", [[0]]),
    "joints[0].axis": ("1", [[1], [0], [0]]),
    "push.moment": ("N m", [[0], [0], [0]]),
    "push.at": ("1", [[0.5]]),
    "coil.span": ("1", [[0], [1]]),
    "coil.span.end": ("1", [[1]]),
    "coil.span[0]": ("1", [[0]]),
    "east.tension": ("N", [[1]]),
}


@pytest.mark.parametrize("name", NAMED)
def test_a_name_has_the_unit_and_the_numbers_of_its_key(name: str) -> None:
    scene = scene_from_dict({**SCENE, "parameters": [name]})
    (numbers,) = scene.named_parameters()
    unit, default = NAMED[name]
    assert numbers.unit == unit
    assert_array_equal(numbers.default, np.array(default, dtype=float))
    written = scene.with_numbers(numbers, numbers.default.ravel(order="F").tolist())
    # The same numbers, but that coefficients which were named are all given.
    assert written.named_parameters()[0].default.tolist() == numbers.default.tolist()


@pytest.mark.parametrize("name", NAMED)
def test_other_numbers_stand_where_the_name_says(name: str) -> None:
    scene = scene_from_dict({**SCENE, "parameters": [name]})
    (numbers,) = scene.named_parameters()
    values = (numbers.default + 0.5).ravel(order="F").tolist()
    changed = scene.with_numbers(numbers, values)
    (found,) = changed.named_parameters()
    assert_array_equal(found.default, numbers.default + 0.5)
    others = [other for other in NAMED if other.split(".")[0] != name.split(".")[0]]
    before = scene.model_copy(update={"parameters": tuple(others)}).named_parameters()
    after = changed.model_copy(update={"parameters": tuple(others)}).named_parameters()
    for one, other in zip(before, after, strict=True):
        assert_array_equal(one.default, other.default)


REFUSED = {
    "wier.length": ("no rod, load, actuator, body, joint, support or obstacle is named 'wier'", "did you mean 'wire'?"),
    "wire.material.youngs_modulu": ("wire.material has no 'youngs_modulu'", "did you mean 'youngs_modulus'?"),
    "wire.material.shear_modulus": ("is not given in the scene", "give it a value: the parameter's default"),
    "wire.material": ("is a table, not a number", "go on with one of its keys: density, law, poisson_ratio, "),
    "wire": ("must name a number of an entry", "such as"),
    "wire.strain": ("is not a number", "parameters are numbers of the scene"),
    "wire.base.free": ("is not a number", ""),
    "wire.section.radius.middle": ("has no value 'middle'", "values: base, tip"),
    "wire.intrinsic.curvature.w": ("has no component 'w'", "components: x, y, z"),
    "wire.intrinsic.curvature.y[2]": ("has no coefficient '2'", "coefficients: 0 to 1"),
    "wire.intrinsic.curvature.x[1]": ("has no part '1'", "give it in the scene: it may be zero"),
    "wire.length[1]": ("has no part '1'", "give it in the scene: it may be zero"),
    "accuracy.modes": ("no rod, load, actuator, body, joint, support or obstacle is named 'accuracy'", ""),
    "coil.span.middle": ("has no component 'middle'", "components: start, end"),
    "side.base.quaternion": ("is given by a direction", "give the quaternion instead, and name that"),
    "side.base.tangent.x": ("is given by a direction", ""),
    "bar.from.z": ("from of an obstacle decides where contacts are looked for, or how", "take one of width, stiffness"),
    "bar.friction.along": ("friction of an obstacle decides where contacts are looked for, or how", ""),
    "lattice.material.table.bending_x[1]": ("is a measured curve", "law = 'polynomial'"),
    "joints[4].position": ("is named 'joints[4]'", ""),
    "push.force": ("is an input already", "leave it out here, or list inputs without it"),
}


def problems(*names: Any) -> list[str]:
    with pytest.raises(SceneError) as caught:
        scene_from_dict({**SCENE, "parameters": list(names)})
    return [str(problem) for problem in caught.value.problems]


def test_every_name_that_is_refused_says_why_at_once() -> None:
    found = problems(*REFUSED)
    for i, (line, (name, (problem, remedy))) in enumerate(zip(found, REFUSED.items(), strict=True)):
        assert line.startswith(f"parameters[{i}]: {name!r}")
        assert problem in line
        assert remedy in line


def names_in(value: Any, name: str) -> Iterator[str]:
    """Names of the keys of a table and of the parts of their lists, to any depth."""
    yield name
    if isinstance(value, dict):
        for key, part in value.items():
            yield from names_in(part, f"{name}.{key}")
    elif isinstance(value, list):
        for i, part in enumerate(value):
            yield from names_in(part, f"{name}[{i}]")


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.toml")), ids=lambda path: path.stem)
def test_whatever_an_example_holds_is_a_parameter_or_refused(path: Path) -> None:
    tables = tomllib.loads(path.read_text())
    kept = [key for key in PARAMETER_LISTS if key in tables]
    assert kept
    names = [name for key in kept for i, entry in enumerate(tables[key]) for name in names_in(entry, f"{key}[{i}]")]
    with pytest.raises(SceneError) as caught:
        scene_from_dict({**tables, "parameters": names})
    assert any(problem.where.startswith("parameters[") for problem in caught.value.problems)


def test_an_entry_of_an_input_is_an_input() -> None:
    (line,) = problems("push.force.x")
    assert line.startswith("parameters[0]: 'push.force.x' is an input already")


def test_a_number_is_named_once() -> None:
    (line,) = problems("wire.section.radius", "wire.section.radius.tip")
    assert line.startswith("parameters[1]: 'wire.section.radius.tip' names what 'wire.section.radius' names already")
    (line,) = problems("wire.length", "wire.length")
    assert line == "parameters[1]: 'wire.length' is listed twice"
    (line,) = problems("wire.length", "rods[0].length")
    assert line.startswith("parameters[1]: 'rods[0].length' names what 'wire.length' names already")


def test_faults_of_an_entry_are_told_beside_those_of_its_parameters() -> None:
    lines = problems("wire.length", "side.lenght")
    assert lines == ["parameters[1]: 'side.lenght': side has no 'lenght' (did you mean 'length'?)"]
    with pytest.raises(SceneError) as caught:
        scene_from_dict({**SCENE, "rods": [{**ROD, "length": -1.0}], "parameters": ["wire.length", "wire.x", "no.x"]})
    text = str(caught.value)
    # Of a faulty entry nothing is known but that it is faulty.
    assert "rods[0].length: must be > 0" in text
    assert "parameters[2]" in text
    assert "parameters[1]" not in text


def test_overrides_change_the_defaults() -> None:
    scene = scene_from_dict({**SCENE, "parameters": ["wire.length"]}, ["wire.length=0.4"])
    assert scene.named_parameters()[0].default.tolist() == [[0.4]]


def test_numbers_of_a_long_list_have_names_that_stand_for_them_alone() -> None:
    growth = [0.1, 0.2, 0.3, 0.4, 0.5]
    chamber = {"name": "own", "kind": "chamber", "rod": "wire", "pressure": 0.0, "offset": [1e-3, 0]}
    grown = {**chamber, "area": 1e-6, "area_growth": growth, "reference_pressure": 1e4}
    scene = scene_from_dict({**SCENE, "actuators": [grown]})
    for name, values in (("own.area_growth", growth), ("own.offset", [1e-3, 0.0])):
        (whole,) = scene.model_copy(update={"parameters": (name,)}).named_parameters()
        for cell, value in zip(whole.cell_names, values, strict=True):
            (alone,) = scene.model_copy(update={"parameters": (cell,)}).named_parameters()
            assert_array_equal(alone.default, [[value]])


def test_two_numbers_are_named_by_what_they_are() -> None:
    chamber = {"name": "own", "kind": "chamber", "rod": "wire", "pressure": 0.0, "offset": [1e-3, 0]}
    grown = {**chamber, "area": 1e-6, "area_growth": [0.1, 0.2], "reference_pressure": 1e4, "span": [0.1, 0.9]}
    scene = scene_from_dict(
        {**SCENE, "actuators": [grown], "parameters": ["own.area_growth", "own.offset", "own.span"]}
    )
    assert [numbers.cell_names for numbers in scene.named_parameters()] == [
        ("own.area_growth.0", "own.area_growth.1"),
        ("own.offset.x", "own.offset.y"),
        ("own.span.start", "own.span.end"),
    ]
