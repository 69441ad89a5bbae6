"""Every verb takes a scene or a model, of rods or of tubes; the others are refused with a sentence."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import cosserat_casadi
from cosserat_casadi import (
    Model,
    SceneError,
    TubePath,
    build,
    discretise,
    export,
    follow,
    modes_of,
    read_scene,
    simulate,
    solve,
    sweep,
)
from tests.conftest import ROOT
from tests.scenes import push, scene

COARSE = {"accuracy": {"modes": 2, "nodes": 5}}
"""A discretisation that the scene fixes, so that a scene is solved on it too."""


@cache
def rod_model() -> Model:
    return build(scene(push(), inputs=["push.force"], **COARSE))


@cache
def tubes() -> Any:
    return solve(read_scene(ROOT / "examples" / "concentric_tubes.toml"))


def test_the_top_namespace_shows_public_names_alone() -> None:
    names = [name for name in dir(cosserat_casadi) if name != "__version__"]
    assert names == cosserat_casadi.__all__
    assert len(names) <= 45


def test_a_scene_and_its_model_have_the_same_equilibrium() -> None:
    of_scene = solve(rod_model().scene)
    of_model = solve(rod_model())
    assert_allclose(of_scene.tip().position, of_model.tip().position, rtol=0, atol=1e-12)


def test_a_scene_and_its_model_have_the_same_path() -> None:
    of_scene = follow(rod_model().scene, "push.force", [0.9, 0.5, -0.4])
    of_model = follow(rod_model(), "push.force", [0.9, 0.5, -0.4])
    assert_allclose(of_scene.tip().position, of_model.tip().position, rtol=0, atol=1e-12)


def test_a_model_has_the_modes_of_its_equilibrium() -> None:
    of_model = modes_of(rod_model(), count=2)
    of_equilibrium = modes_of(solve(rod_model()), count=2)
    assert_allclose(of_model.angular_frequencies, of_equilibrium.angular_frequencies, rtol=1e-12, atol=0)
    with pytest.raises(ValueError, match="leave the values out"):
        modes_of(solve(rod_model()), {"push.force": [0.0, 0.0, 0.0]})


def test_a_model_of_tubes_keeps_its_steps() -> None:
    again = solve(tubes().model)
    assert again.model is tubes().model
    assert_allclose(again.tip().position, tubes().tip().position, rtol=0, atol=1e-9)
    rotation = float(tubes().inputs[tubes().robot.columns["inner.rotation"]])
    path = follow(tubes().model, "inner.rotation", rotation + 0.2)
    assert isinstance(path, TubePath)
    assert path.converged
    assert {solution.model.steps for solution in path.solutions} == {tubes().model.steps}
    assert path.error_estimate is None


@pytest.mark.slow
def test_a_sweep_of_a_model_keeps_its_discretisation() -> None:
    model = build(scene(push(), inputs=["push.force"]), discretise(scene(push()), 2, 5))
    rows = sweep(model, {"push.force.x": [0.1, 0.9]}, cores=1)
    alone = [solve(model, {"push.force": [force, 0.5, -0.4]}).tip().position for force in (0.1, 0.9)]
    assert_allclose(rows.positions(), np.array(alone), rtol=0, atol=1e-9)


@pytest.mark.slow
def test_a_scene_is_exported_as_the_model_that_it_is_solved_with(tmp_path: Path) -> None:
    of_scene = export(rod_model().scene, tmp_path / "scene", "rod")
    of_model = export(rod_model(), tmp_path / "model", "rod")
    names = sorted(file.name for file in of_model.glob("*.c"))
    assert names
    assert names == sorted(file.name for file in of_scene.glob("*.c"))
    for name in names:
        assert_array_equal((of_scene / name).read_bytes(), (of_model / name).read_bytes())


REFUSED: dict[str, Callable[[Any], object]] = {
    "simulate": simulate,
    "modes_of": modes_of,
    "sweep of a model": lambda subject: sweep(subject, {"inner.rotation": [0.0]}),
}


@pytest.mark.parametrize("verb", REFUSED)
def test_what_works_on_rods_alone_refuses_models_of_tubes(verb: str) -> None:
    with pytest.raises(SceneError, match="this works on rods, and the scene has concentric tubes"):
        REFUSED[verb](tubes().model)


def test_an_unknown_option_is_refused() -> None:
    with pytest.raises(TypeError, match="start"):
        solve(rod_model().scene, start=None)  # type: ignore[call-overload]
