"""A scene written as text and read again is the same scene."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from pydantic import BaseModel

from cosserat_casadi import Scene, SceneError, parse_scene, read_scene
from cosserat_casadi.scene.writing import scene_text
from tests.conftest import ROOT, case_files
from tests.scenes import HOOK, WEIGHT, WIND, push, rod, scene

EXAMPLES = sorted((ROOT / "examples").glob("*.toml"))
CASES = [path for folder in ("rods", "supports", "robots") for path in case_files(folder)]

TITLES = [
    "",
    " leading and trailing ",
    "quotes \"double\" and 'single', three \"\"\" and '''",
    "backslashes \\ \\\\ \\n \\u0041 at the end \\",
    "several\nlines\r\nand\ttabs",
    "beyond the basic plane: 𝛼 🪢 𐍈",
    "controls: \x00 \x01 \x07 \x08 \x0b \x0c \x1b \x1f",
    "DEL \x7f, NEL \x85, NBSP \xa0, LS \u2028, PS \u2029, BOM \ufeff",
    "bidirectional \u202e and \u2066 marks",
    "# no comment = [no, table] { no: json }",
    "schema = 2\n[[rods]]",
    "*/ int main(void) { return 1; } /* ??/",
]


def given_fields(record: Any) -> Any:
    """Which fields were given, level by level."""
    if isinstance(record, BaseModel):
        return {name: given_fields(getattr(record, name)) for name in sorted(record.model_fields_set)}
    return [given_fields(entry) for entry in record] if isinstance(record, tuple) else None


def assert_round_trip(wanted: Scene) -> None:
    text = scene_text(wanted)
    again = parse_scene(text)
    assert again == wanted
    assert given_fields(again) == given_fields(wanted)
    assert again.input_names() == wanted.input_names()
    assert scene_text(again) == text


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_examples(path: Path) -> None:
    assert_round_trip(read_scene(path))


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_reference_cases(path: Path) -> None:
    try:
        wanted = read_scene(path)
    except SceneError as error:
        pytest.skip(f"this version does not read it: {error.problems[0].where}")
    assert_round_trip(wanted)


@pytest.mark.parametrize("title", TITLES, ids=range(len(TITLES)))
def test_odd_titles(title: str) -> None:
    wanted = scene(push(), title=title)
    assert_round_trip(wanted)
    assert tomllib.loads(scene_text(wanted))["title"] == title


@settings(deadline=None, max_examples=50)
@given(st.text(st.characters(codec="utf-8"), max_size=60))
@example('\x7f\\\x7f"')
def test_any_title(title: str) -> None:
    assert_round_trip(scene(push(), title=title))


@settings(deadline=None, max_examples=60)
@given(
    st.lists(st.floats(-1e3, 1e3), min_size=4, max_size=4).filter(lambda q: sum(x * x for x in q) > 1e-9),
    st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=3, max_size=3).filter(any),
)
def test_orientations_are_not_normalised_twice(quaternion: list[float], tangent: list[float]) -> None:
    """A norm that is 1 but for rounding stays as it is: what is read, written and read again is the same."""
    norm = sum(x * x for x in quaternion) ** 0.5
    unit = [x / norm for x in quaternion]
    for base in ({"quaternion": unit}, {"tangent": tangent}, {"quaternion": [x * (1 + 4e-7) for x in unit]}):
        assert_round_trip(scene(push(), rods=[rod(base=base)]))


@settings(deadline=None, max_examples=60)
@given(st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=3, max_size=3))
def test_every_number_is_written_exactly(force: list[float]) -> None:
    wanted = scene(push(force=force))
    again = parse_scene(scene_text(wanted))
    assert list(map(float.hex, again.loads[0].force)) == list(map(float.hex, wanted.loads[0].force))


@pytest.mark.parametrize(
    "wanted",
    [
        scene(WEIGHT, HOOK, WIND, push(frame="body", moment=[0, 0, 1]), strain="reissner"),
        scene(push(), inputs=[]),
        scene(push(), WIND, inputs=["wind.force"], accuracy={}),
        scene(push(), supports=[], actuators=[], loads=[push()]),
        scene(WEIGHT, accuracy={"tolerance": 1e-9, "modes": [2, 3, 4], "nodes": 9}),
        scene(
            {**push(), "rod": "one"},
            {**WEIGHT, "rods": ["two"]},
            rods=[rod(name="one", length=1), rod(["extension", "bending_y"], name="two", linear_density=[0.2, 0.1])],
            supports=[{"name": "hand", "rod": "two", "kind": "pinned", "position": [0.1, 0, 0.7]}],
        ),
        scene(rods=[rod(intrinsic={"curvature": [0, [1.5, -2], 1e-7], "tangent": [0, 0, 1.1]}, basis="chebyshev")]),
    ],
    ids=["every load", "no inputs", "some inputs", "empty lists", "fixed", "two rods", "pre-curved"],
)
def test_every_kind_of_table(wanted: Scene) -> None:
    assert_round_trip(wanted)


def test_only_what_was_given_is_written() -> None:
    text = scene_text(scene(push()))
    for word in ("accuracy", "inputs", "supports", "intrinsic", "frame", "moment"):
        assert word not in text


def test_an_override_is_part_of_what_is_written() -> None:
    given = parse_scene(scene_text(scene(push())), ("push.force=[7, 8, 9]", "accuracy.tolerance=1e-3"))
    assert "force = [7.0, 8.0, 9.0]" in scene_text(given)
    assert_round_trip(given)
