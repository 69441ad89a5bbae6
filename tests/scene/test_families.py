"""Open families: a load that does not ship is read, refused, written, listed and free like any other."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, ClassVar, Literal

import pytest
from jsonschema import Draft202012Validator
from pydantic import Field

from cosserat_casadi import SceneError, parse_scene, scene_from_dict
from cosserat_casadi.scene import ACTUATORS, JOINTS, LOADS, SUPPORTS, InputField, LoadRecord, Scene
from cosserat_casadi.scene.families import contents_of
from cosserat_casadi.scene.faults import Fault, SceneTables, Table
from cosserat_casadi.scene.json_schema import scene_json_schema
from cosserat_casadi.scene.rod_records import Rod
from cosserat_casadi.scene.rules import LISTS
from cosserat_casadi.scene.values import Positive, Vector
from cosserat_casadi.scene.writing import scene_text
from tests.scenes import WEIGHT, push, rod


class SpringToPoint(LoadRecord):
    """A spring between the tip of a rod and a point of the world."""

    inputs: ClassVar[Mapping[str, InputField]] = {
        "stiffness": InputField("N/m", 1, positive=True),
        "anchor": InputField("m", 3, axes="world"),
    }
    references: ClassVar[Mapping[str, str]] = {"rod": "rods"}

    kind: Literal["spring_to_point"] = Field(description="spring between the tip and a point of the world")
    rod: str = Field(description="name of the rod that it pulls")
    stiffness: Positive = Field(description="stiffness, N/m")
    anchor: Vector = Field((0.0, 0.0, 0.0), description="where the spring is fixed, world axes, m")

    @classmethod
    def scene_conflicts(cls, given: Table, scene: SceneTables) -> Iterator[Fault]:
        """One spring a rod."""
        springs = [table for _, table in scene.tables("loads") if table.get("kind") == "spring_to_point"]
        if [spring.get("rod") for spring in springs].count(given.get("rod")) > 1:
            yield Fault(("rod",), "has a spring already", "one spring for each rod")


SPRING = {"name": "spring", "kind": "spring_to_point", "rod": "rod", "stiffness": 2.0}


@pytest.fixture
def spring(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(LOADS, "records", dict(LOADS.records))
    LOADS.register(SpringToPoint)


def tables(*loads: Mapping[str, Any], **changes: Any) -> dict[str, Any]:
    return {"schema": 1, "rods": [rod()], "loads": [dict(load) for load in loads], **changes}


def refusals(*loads: Mapping[str, Any], **changes: Any) -> list[tuple[str, str, str]]:
    with pytest.raises(SceneError) as refused:
        scene_from_dict(tables(*loads, **changes))
    return [(problem.where, problem.problem, problem.remedy) for problem in refused.value.problems]


@pytest.mark.usefixtures("spring")
def test_it_is_read_and_written() -> None:
    scene = scene_from_dict(tables(WEIGHT, SPRING), ["spring.anchor=[1, 2, 3]"])
    load: Any = scene.loads[1]
    assert isinstance(load, SpringToPoint)
    assert (load.stiffness, load.anchor) == (2.0, (1.0, 2.0, 3.0))
    assert parse_scene(scene_text(scene)) == scene
    assert Scene(schema=1, rods=scene.rods, loads=scene.loads).loads == scene.loads


@pytest.mark.usefixtures("spring")
def test_its_inputs_are_known() -> None:
    scene = scene_from_dict(tables(push(), SPRING))
    assert scene.input_names() == ("push.force", "spring.stiffness")
    assert [entry.declared.unit for entry in scene.free_inputs()] == ["N", "N/m"]
    assert [type(entry.record).__name__ for entry in scene.free_inputs()] == ["TipWrench", "SpringToPoint"]
    named = scene_from_dict(tables(SPRING, inputs=["spring.anchor", "rod.base.position"]))
    assert [entry.declared.components for entry in named.free_inputs()] == [3, 3]
    assert [(entry.owner, entry.field) for entry in named.free_inputs()] == [
        ("spring", "anchor"),
        ("rod", "base.position"),
    ]
    assert scene_from_dict(tables(SPRING, bounds=[{"input": "spring.stiffness", "lower": 1.0}])).bounds


@pytest.mark.usefixtures("spring")
@pytest.mark.parametrize(
    ("change", "where", "problem", "remedy"),
    [
        ({"rod": "toe"}, "loads[0].rod", "no rod is named 'toe'", "rods: rod"),
        ({"stiffness": -1.0}, "loads[0].stiffness", "must be > 0, got -1.0", ""),
        ({"anchor": [1, 2]}, "loads[0].anchor", "must be a list of 3 numbers, got 2", ""),
        ({"stifness": 1.0}, "loads[0].stifness", "unknown key", "did you mean 'stiffness'?"),
        ({"stiffness": None}, "loads[0].stiffness", "must be a number, got a NoneType", "stiffness, N/m"),
    ],
)
def test_its_faults_say_where_what_and_what_to_do(change: Any, where: str, problem: str, remedy: str) -> None:
    assert refusals({**SPRING, **change}) == [(where, problem, remedy)]


@pytest.mark.usefixtures("spring")
def test_its_rules_and_inputs_are_checked_with_those_of_the_scene() -> None:
    first = refusals(SPRING, {**SPRING, "name": "second"}, push(rod="toe"), inputs=["spring.length", "push.force"])
    assert first == [
        ("loads[0].rod", "has a spring already", "one spring for each rod"),
        ("loads[1].rod", "has a spring already", "one spring for each rod"),
        ("loads[2].rod", "no rod is named 'toe'", "rods: rod"),
        ("inputs[0]", "'spring' has no magnitude 'length'", "magnitudes: stiffness, anchor"),
    ]
    bound = {"input": "spring.stiffness", "lower": [1.0, 2.0]}
    assert refusals(SPRING, bounds=[bound]) == [("bounds[0].lower", "must have 1 number, got 2", "")]


@pytest.mark.usefixtures("spring")
def test_it_is_in_the_words_of_errors_and_in_the_json_schema() -> None:
    (where, problem, _) = refusals({**SPRING, "kind": "glue"})[0]
    assert where == "loads[0].kind"
    assert problem == (
        "must be one of 'gravity', 'tip_wrench', 'point_wrench', 'distributed_wrench', 'body_wrench', "
        "'flow', 'foundation', 'magnet', 'spring_to_point', got 'glue'"
    )
    schema = scene_json_schema()
    assert {"$ref": "#/$defs/SpringToPoint"} in schema["properties"]["loads"]["items"]["oneOf"]
    validator = Draft202012Validator(schema)
    assert validator.is_valid(tables(SPRING))
    assert not validator.is_valid(tables({**SPRING, "stiffness": -1.0}))


def test_without_registration_it_is_refused() -> None:
    assert refusals(SPRING)[0][0] == "loads[0].kind"
    assert "SpringToPoint" not in scene_json_schema()["$defs"]
    given = scene_from_dict(tables(WEIGHT))
    with pytest.raises(Exception, match="must be one of 'gravity'"):
        Scene(schema=1, rods=given.rods, loads=(SpringToPoint(**SPRING),))


@pytest.mark.usefixtures("spring")
def test_a_word_is_registered_once() -> None:
    with pytest.raises(ValueError, match="loads have a kind 'spring_to_point' already: SpringToPoint"):
        LOADS.register(SpringToPoint)
    with pytest.raises(ValueError, match="LoadRecord needs a field kind with one word"):
        LOADS.register(LoadRecord)


def test_every_list_of_a_scene_is_ruled() -> None:
    contents = {key: contents_of(field) for key, field in Scene.model_fields.items()}
    for table in ("accuracy", "simulation", "identification", "estimation"):
        del contents[table]
    assert {key: kinds for key, kinds in contents.items() if kinds is not None} == LISTS


@pytest.mark.parametrize("family", [LOADS, ACTUATORS, SUPPORTS, JOINTS], ids=lambda family: family.table)
def test_what_is_declared_of_fields_names_fields(family: Any) -> None:
    for record in family.records.values():
        assert {field.partition(".")[0] for field in record.inputs} <= set(record.model_fields)
        assert set(record.references) <= set(record.model_fields)
        assert set(record.references.values()) <= set(LISTS)


def test_inputs_of_rods() -> None:
    assert {name: (field.unit, field.components) for name, field in Rod.inputs.items()} == {
        "length": ("m", 1),
        "base.position": ("m", 3),
        "base.quaternion": ("1", 4),
    }
    assert all(field.geometry for field in Rod.inputs.values())


@pytest.mark.parametrize(
    ("polynomial", "value", "count"),
    [
        (True, [1, [1, 2], 0], 6),
        (True, [1, 2, 3], 3),
        (True, [[1], [1, 2, 3], [1, 2]], 9),
        (True, None, 3),
        (True, "x", 3),
        (False, [1, 2, 3], 3),
    ],
)
def test_entries_of_inputs(polynomial: bool, value: Any, count: int) -> None:
    assert InputField("N/m", 3, polynomial=polynomial).entry_count(value) == count
