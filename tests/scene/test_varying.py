"""What varies along a rod: one notation for every key, and the plain lists, which mean what their key says."""

from __future__ import annotations

import copy
import json
import re
from typing import Any

import numpy as np
import pytest
from numpy.polynomial import legendre
from numpy.testing import assert_allclose

from cosserat_casadi import Scene, SceneError, build, discretise, scene_from_dict
from cosserat_casadi.scene.json_schema import scene_json_schema
from cosserat_casadi.scene.profiles import Notation, Profile, read_profile
from cosserat_casadi.scene.varying import varying_values
from cosserat_casadi.scene.writing import scene_tables, scene_text

BASE, TIP = 0.75, 0.5

TABLES = (
    {"base": BASE, "tip": TIP},
    {"powers": [BASE, TIP - BASE]},
    {"legendre": [(BASE + TIP) / 2, (TIP - BASE) / 2]},
)
"""The same line, three times; all numbers are exact."""

PLAIN = {
    Notation.ENDS: (BASE, TIP),
    Notation.POWERS: (BASE, TIP - BASE),
    Notation.LEGENDRE: ((BASE + TIP) / 2, (TIP - BASE) / 2),
}

MATERIAL = {"youngs_modulus": 1e6, "poisson_ratio": 0.3}

ADMITTED = ("bending_x", "bending_y", "torsion", "shear_x", "shear_y", "extension")


def tables(**rod: Any) -> dict[str, Any]:
    """A scene in which every kind of value along a rod can stand."""
    stiff = {"stiffness": dict.fromkeys(ADMITTED, 1.0), "linear_density": 1.0}
    made = {"name": "rod", "length": 1.0, "strain": "reissner", **(rod or stiff)}
    wind = {"name": "wind", "kind": "distributed_wrench", "rod": "rod", "force": [0, 0, 0], "moment": [0, 0, 0]}
    cable = {"name": "cable", "kind": "tendon", "rod": "rod", "tension": 1.0, "offset": [0.1, 0]}
    bellows = {"name": "bellows", "kind": "chamber", "rod": "rod", "pressure": 1.0, "area": 1e-3, "offset": [0, 0]}
    bender = {"name": "bender", "kind": "muscle", "rod": "rod", "moment": [0, 1.0, 0], "offset": [0, 0]}
    return {"schema": 1, "rods": [made], "loads": [wind], "actuators": [cable, bellows, bender]}


def of_section(shape: str, **sizes: float) -> dict[str, Any]:
    return tables(material=MATERIAL, section={"shape": shape, **sizes})


MAGNET = {"name": "load", "kind": "magnet", "rod": "rod", "magnetisation": [0, 1.0, 1.0], "field": [0, 0, 1.0]}
TISSUE = {"name": "load", "kind": "foundation", "rod": "rod", "stiffness": [1.0, 1.0, 1.0], "curve": [0, 0, 0]}
WATER = {"name": "load", "kind": "flow", "density": 1000.0, "diameter": 1.0}


WAVE = {"input": "bender.profile", "amplitude": 1.0, "frequency": 1.0, "wave": "travelling", "wavelength": 0.7}

SPEED = {"rod": "rod", "curvature_rate": [0, 0, 0], "tangent_rate": [0, 0, 0]}


def with_load(load: dict[str, Any]) -> dict[str, Any]:
    return {**tables(), "loads": [load]}


PLACES: list[tuple[str, dict[str, Any], tuple[Any, ...], Notation]] = [
    ("radius", of_section("circle", radius=1.0), ("rods", 0, "section", "radius"), Notation.ENDS),
    (
        "outer_radius",
        of_section("annulus", outer_radius=1.0, inner_radius=0.1),
        ("rods", 0, "section", "outer_radius"),
        Notation.ENDS,
    ),
    (
        "inner_radius",
        of_section("annulus", outer_radius=1.0, inner_radius=0.1),
        ("rods", 0, "section", "inner_radius"),
        Notation.ENDS,
    ),
    ("width", of_section("rectangle", width=1.0, height=1.0), ("rods", 0, "section", "width"), Notation.ENDS),
    ("height", of_section("rectangle", width=1.0, height=1.0), ("rods", 0, "section", "height"), Notation.ENDS),
    ("linear_density", tables(), ("rods", 0, "linear_density"), Notation.ENDS),
    *((name, tables(), ("rods", 0, "stiffness", name), Notation.ENDS) for name in ADMITTED),
    *(
        (key, tables(), ("rods", 0, "intrinsic", key, i), Notation.LEGENDRE)
        for key in ("curvature", "tangent")
        for i in range(3)
    ),
    *(
        (key, tables(), ("loads", 0, key, i), Notation.LEGENDRE)
        for key in ("force", "moment")
        for i in range(3)
    ),
    *(("magnetisation", with_load(MAGNET), ("loads", 0, "magnetisation", i), Notation.LEGENDRE) for i in range(3)),
    *(("curve", with_load(TISSUE), ("loads", 0, "curve", i), Notation.LEGENDRE) for i in range(3)),
    ("diameter", with_load(WATER), ("loads", 0, "diameter"), Notation.ENDS),
    *(("offset", tables(), ("actuators", k, "offset", i), Notation.POWERS) for k in range(3) for i in range(2)),
    ("profile", tables(), ("actuators", 2, "profile"), Notation.LEGENDRE),
    *((key, {**tables(), "velocities": [SPEED]}, ("velocities", 0, key, i), Notation.LEGENDRE)
      for key in ("curvature_rate", "tangent_rate") for i in range(3)),
    ("envelope", {**tables(), "motions": [WAVE]}, ("motions", 0, "envelope"), Notation.LEGENDRE),
]  # fmt: skip


def with_value(given: dict[str, Any], path: tuple[Any, ...], value: Any) -> dict[str, Any]:
    changed = copy.deepcopy(given)
    changed["rods"][0].setdefault("intrinsic", {"curvature": [0, 0, 0], "tangent": [0, 0, 1]})
    holder: Any = changed
    for part in path[:-1]:
        holder = holder[part]
    holder[path[-1]] = value
    return changed


def stored(scene: Scene, path: tuple[Any, ...]) -> Any:
    value: Any = scene
    for part in path:
        value = value[part] if isinstance(part, int) else getattr(value, part)
    return value


@pytest.mark.parametrize(("key", "given", "path", "notation"), PLACES, ids=lambda entry: str(entry)[:60])
def test_every_notation_is_the_plain_list_of_its_key(
    key: str, given: dict[str, Any], path: tuple[Any, ...], notation: Notation
) -> None:
    plain = scene_from_dict(with_value(given, path, list(PLAIN[notation])))
    assert stored(plain, path) == PLAIN[notation]
    for table in TABLES:
        assert scene_from_dict(with_value(given, path, table)) == plain


def test_every_key_that_takes_a_table_is_tested() -> None:
    schema = scene_json_schema()
    found = {
        name
        for record in (schema, *schema["$defs"].values())
        for name, entry in record.get("properties", {}).items()
        if re.search(r"AlongRod\"", json.dumps(entry))
    }
    assert found == {key for key, *_ in PLACES}


def test_the_model_does_not_know_the_notation() -> None:
    """Not one instruction more: the functions are the same to the last constant."""
    texts = []
    for force, offset, curvature in (
        ([[BASE, 0.25], 0, 0], [[BASE, 0.25], 0], [0, [BASE, 0.25], 0]),
        ([{"base": 0.5, "tip": 1.0}, 0, 0], [{"base": 0.75, "tip": 1.0}, 0], [0, {"powers": [0.5, 0.5]}, 0]),
    ):
        given = tables()
        given["loads"][0] |= {"force": force}
        given["actuators"][0] |= {"offset": offset}
        given["rods"][0] |= {"intrinsic": {"curvature": curvature}}
        scene = scene_from_dict(given)
        model = build(scene, discretise(scene, 3, 6))
        texts.append(model.jacobian.serialize())
    assert texts[0] == texts[1]


@pytest.mark.parametrize("degree", range(1, 10))
def test_conversion_of_polynomials(degree: int) -> None:
    rng = np.random.default_rng(degree)
    numbers = tuple(rng.standard_normal(degree + 1).tolist())
    X = np.linspace(0, 1, 21)
    from_powers = Profile(Notation.POWERS, numbers).converted(Notation.LEGENDRE).numbers
    assert len(from_powers) == degree + 1
    assert_allclose(legendre.legval(2 * X - 1, from_powers), np.polyval(numbers[::-1], X), rtol=0, atol=1e-14)
    from_legendre = Profile(Notation.LEGENDRE, numbers).converted(Notation.POWERS).numbers
    assert_allclose(np.polyval(from_legendre[::-1], X), legendre.legval(2 * X - 1, numbers), rtol=0, atol=1e-9)


def test_coefficients_that_vanish_are_kept() -> None:
    """Inputs count the coefficients of the file."""
    assert Profile(Notation.POWERS, (1.0, 0.0, 0.0)).converted(Notation.LEGENDRE).numbers == (1.0, 0.0, 0.0)


@pytest.mark.parametrize("notation", [Notation.POWERS, Notation.LEGENDRE])
def test_ends(notation: Notation) -> None:
    numbers = (1.0, 2.0, -4.0, 0.5)
    base, tip = Profile(notation, numbers).ends
    values = {
        Notation.POWERS: np.polyval(numbers[::-1], [0.0, 1.0]),
        Notation.LEGENDRE: legendre.legval([-1.0, 1.0], numbers),
    }
    assert_allclose([base, tip], values[notation], rtol=1e-15, atol=0)


def test_constants_are_read_as_numbers_of_any_key() -> None:
    assert read_profile({"powers": [3]}).converted(Notation.ENDS).numbers == (3.0, 3.0)
    assert read_profile({"legendre": [3]}).converted(Notation.ENDS).numbers == (3.0, 3.0)


SIZE = ("rods", 0, "section", "radius")
OFFSET = ("actuators", 0, "offset", 0)


@pytest.mark.parametrize(
    ("path", "table", "expected"),
    [
        (SIZE, {"base": 1.0}, "rods[0].section.radius.tip: missing (give base and tip)"),
        (SIZE, {"tip": 1.0}, "rods[0].section.radius.base: missing (give base and tip)"),
        (SIZE, {}, "rods[0].section.radius: says no values (give base and tip, or legendre, or powers)"),
        (
            SIZE,
            {"base": 1.0, "tip": 1.0, "powers": [1.0]},
            "rods[0].section.radius.powers: stands beside base (give base and tip, or legendre, or powers)",
        ),
        (
            OFFSET,
            {"legendre": [1.0], "powers": [1.0]},
            "actuators[0].offset[0].powers: stands beside legendre (give base and tip, or legendre, or powers)",
        ),
        (OFFSET, {"power": [1.0]}, "actuators[0].offset[0].power: unknown key (did you mean 'powers'?)"),
        (OFFSET, {"powers": 1.0}, "actuators[0].offset[0].powers: must be a list, got 1.0 (powers of X)"),
        (OFFSET, {"powers": []}, "actuators[0].offset[0].powers: must have at least one entry"),
        (OFFSET, {"powers": [1.0, "a"]}, "actuators[0].offset[0].powers[1]: must be a number, got 'a'"),
        (OFFSET, {"base": True, "tip": 0}, "actuators[0].offset[0].base: must be a number, got true"),
        (OFFSET, {"base": 1e-3, "tip": float("nan")}, "actuators[0].offset[0].tip: must be finite, got nan"),
        (OFFSET, {"base": 10**400, "tip": 0}, "must be finite, got a whole number beyond all range"),
        (
            OFFSET,
            {"base": 0.0, "tip": -1e308},
            "actuators[0].offset[0].tip: must be at most 1e+60 in size, got -1e+308 (lengths are in m)",
        ),
        (
            OFFSET,
            {"legendre": [1.0] * 11},
            "must be a list of at most 10 numbers, got 11 (powers of a higher degree lose their digits)",
        ),
        (
            SIZE,
            {"powers": [1.0, 0.0, 1.0]},
            "rods[0].section.radius.powers: must be a list of 1 or 2 numbers, got 3 (it varies linearly along X)",
        ),
        (SIZE, {"base": 1.0, "tip": 0.0}, "rods[0].section.radius.tip: must be > 0, got 0.0"),
        (SIZE, {"powers": [1.0, -3.0]}, "rods[0].section.radius: must be > 0 along X, got -2.0 at the tip"),
    ],
)
def test_refusals(path: tuple[Any, ...], table: dict[str, Any], expected: str) -> None:
    given = of_section("circle", radius=1.0)
    with pytest.raises(SceneError) as caught:
        scene_from_dict(with_value(given, path, table))
    assert expected in str(caught.value)
    assert len(caught.value.problems) == 1


def test_all_faults_of_a_table_at_once() -> None:
    given = with_value(of_section("circle", radius=1.0), SIZE, {"base": "a", "tip": [], "pwers": 2})
    with pytest.raises(SceneError) as caught:
        scene_from_dict(given)
    assert len(caught.value.problems) == 3


def test_a_bore_is_held_against_its_wall_in_every_notation() -> None:
    given = of_section("annulus", outer_radius=1.0, inner_radius=0.1)
    changed = with_value(given, ("rods", 0, "section", "inner_radius"), {"powers": [0.1, 1.0]})
    with pytest.raises(SceneError, match="inner_radius: must be < outer_radius at both ends"):
        scene_from_dict(changed)


def test_bounds_take_no_table() -> None:
    given = tables() | {"bounds": [{"input": "cable.tension", "lower": {"base": 0, "tip": 1}}]}
    with pytest.raises(SceneError, match="lower: must be a number, got a table"):
        scene_from_dict(given)


def test_inputs_count_the_coefficients_of_a_table() -> None:
    given = tables() | {"bounds": [{"input": "wind.force", "upper": [1.0] * 9}]}
    given["loads"][0]["force"] = [{"base": 0, "tip": 1}, {"powers": [0, 0, 1]}, 0]
    scene = scene_from_dict(given)
    model = build(scene, discretise(scene, 2, 4))
    assert model.inputs.unpack(model.pack())["wind.force"].shape == (3, 3)


def test_overrides_reach_into_tables() -> None:
    given = with_value(of_section("circle", radius=1.0), SIZE, {"base": 1.0, "tip": 0.5})
    scene = scene_from_dict(given, ("rod.section.radius.tip=0.25",))
    assert stored(scene, SIZE) == (1.0, 0.25)


def test_a_scene_with_tables_is_written_with_lists() -> None:
    given = with_value(of_section("circle", radius=1.0), SIZE, {"base": 1.0, "tip": 0.5})
    scene = scene_from_dict(given)
    assert scene_tables(scene)["rods"][0]["section"]["radius"] == [1.0, 0.5]
    assert "radius = [1.0, 0.5]" in scene_text(scene)


def test_what_varies_is_found_with_unit_ends_and_notation() -> None:
    given = of_section("annulus", outer_radius=[3.0, 2.0], inner_radius=0.1)
    given["rods"][0]["intrinsic"] = {"curvature": [0, {"base": 4.0, "tip": 6.0}, [1.0]]}
    given["loads"][0]["moment"] = [0, 0, [1.0, 0.5, 0.25]]
    given["actuators"][0]["offset"] = [[8e-3, 4e-3], {"powers": [1.0]}]
    found = [(v.key, v.unit, v.profile.ends, v.plain) for v in varying_values(scene_from_dict(given), given)]
    assert found == [
        ("rod.section.outer_radius", "m", (3.0, 2.0), True),
        ("rod.intrinsic.curvature[1]", "1/m", (4.0, 6.0), False),
        ("wind.moment[2]", "N m/m", (0.75, 1.75), True),
        ("cable.offset[0]", "m", (8e-3, 12e-3), True),
    ]


@pytest.mark.parametrize(
    ("profile", "expected"),
    [
        (Profile(Notation.POWERS, (8e-3, 4e-3)), "{ base = 0.008, tip = 0.012 }"),
        (Profile(Notation.ENDS, (2.0, 1.0)), "{ base = 2, tip = 1 }"),
        (Profile(Notation.LEGENDRE, (1.0, 0.5, 0.25)), "{ legendre = [1, 0.5, 0.25] }"),
    ],
)
def test_the_table_that_says_the_same(profile: Profile, expected: str) -> None:
    assert profile.table == expected
