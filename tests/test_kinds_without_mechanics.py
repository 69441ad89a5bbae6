"""A kind that is registered with the scene format alone is refused in a sentence by whatever would have to know it."""

from __future__ import annotations

from typing import Any, Literal

import pytest
from pydantic import BaseModel

from cosserat_casadi import SceneError, build, inverse, scene_from_dict, solve
from cosserat_casadi.identification.measured_quantities import difference
from cosserat_casadi.plots.scene_plot import plot_solution
from cosserat_casadi.scene import ACTUATORS, JOINTS, LOADS, SUPPORTS
from cosserat_casadi.scene.families import Family
from cosserat_casadi.scene.measurement_record import MEASUREMENTS
from cosserat_casadi.scene.obstacle_records import OBSTACLES
from cosserat_casadi.scene.rod_records import SECTIONS
from cosserat_casadi.scene.target_records import TARGETS
from tests.scenes import push, rod

WORD = "unheard_of"
TIP = [0.0, 0.0, 0.3]
THICK = {
    "name": "rod",
    "length": 0.3,
    "strain": "kirchhoff",
    "material": {"youngs_modulus": 1e7, "poisson_ratio": 0.4, "density": 1000.0},
}


@pytest.fixture
def unheard_of(monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest) -> Family[Any]:
    """A family with a kind that has the record of one that ships and nothing else."""
    family, like = request.param
    word: Any = Literal["unheard_of"]
    shipped: type[BaseModel] = family.records[like]
    record: Any = type("Unheard", (shipped,), {"__annotations__": {family.key: word}, "__module__": __name__})
    monkeypatch.setattr(family, "records", dict(family.records))
    family.register(record)
    return family


def scene(**tables: Any) -> Any:
    given = {"schema": 1, "accuracy": {"modes": 3, "nodes": 6}, "rods": [rod()], "loads": [push()], **tables}
    return scene_from_dict(given)


def told(family: Family[Any]) -> Any:
    return pytest.raises(SceneError, match=f"^{family.table}: {family.key} = '{WORD}' is read, but nothing says what")


CAUSES = [
    ((LOADS, "gravity"), {"loads": [{"name": "w", "kind": WORD, "acceleration": [0, 0, -9.81]}]}),
    ((ACTUATORS, "tendon"), {"actuators": [{"name": "t", "kind": WORD, "rod": "rod", "tension": 1, "offset": [0, 0]}]}),
    ((SUPPORTS, "clamped"), {"supports": [{"kind": WORD, "rod": "rod", "position": TIP, "quaternion": [1, 0, 0, 0]}]}),
    ((SUPPORTS, "pinned"), {"supports": [{"kind": WORD, "rod": "rod", "position": TIP}]}),
    *(
        (
            (JOINTS, like),
            {"bodies": [{"name": "plate"}], "joints": [{"kind": WORD, "rod": "rod", "body": "plate", **keys}]},
        )
        for like, keys in (("spherical", {}), ("revolute", {"axis": [0, 1, 0]}), ("prismatic", {"axis": [1, 0, 0]}))
    ),
    ((SECTIONS, "rectangle"), {"rods": [{**THICK, "section": {"shape": WORD, "width": 2e-3, "height": 3e-3}}]}),
    ((SECTIONS, "circle"), {"rods": [{**THICK, "section": {"shape": WORD, "radius": 2e-3}}]}),
    (
        (OBSTACLES, "sphere"),
        {"obstacles": [{"name": "ball", "kind": WORD, "centre": [1, 0, 0], "radius": 0.1, "width": 1e-3}]},
    ),
]


@pytest.mark.parametrize(("unheard_of", "tables"), CAUSES, indirect=["unheard_of"])
def test_a_model_is_refused(unheard_of: Family[Any], tables: Any) -> None:
    given = scene(**tables)
    with told(unheard_of):
        _ = build(given).residual


TARGET = {"kind": WORD, "rod": "rod", "position": [0.05, 0, 0.28]}


@pytest.mark.parametrize("unheard_of", [(TARGETS, "position")], indirect=True)
def test_a_target_is_refused(unheard_of: Family[Any]) -> None:
    given = scene(targets=[TARGET], inputs=["push.force"])
    solution = solve(build(given))
    assert solution.converged, "a target does not act on the rods"
    with told(unheard_of):
        inverse(solution.model, start=solution)
    with told(unheard_of):
        plot_solution(solution)


@pytest.mark.parametrize(
    ("unheard_of", "extra"),
    [((MEASUREMENTS, "position"), {"rod": "rod", "columns": ["x", "y", "z"]})],
    indirect=["unheard_of"],
)
def test_a_measurement_is_refused(unheard_of: Family[Any], extra: Any) -> None:
    given = scene(measurements=[{"quantity": WORD, "file": "a.csv", "sigma": 1e-3, **extra}])
    with told(unheard_of):
        difference(build(given), given.measurements[0], 1)


def test_a_word_that_nothing_has_is_a_key_error() -> None:
    from cosserat_casadi.model.registry import EFFECTS

    with pytest.raises(KeyError, match=WORD):
        EFFECTS[WORD]
