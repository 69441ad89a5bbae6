"""The scene of an exported folder, from which Python builds the model that the folder holds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, Scene, build, discretise, export, read_scene, scene_from_dict, solve
from cosserat_casadi.model.discretise import with_discretisation
from cosserat_casadi.scene.writing import scene_tables
from tests.codegen.libraries import ARMS, HAND, LOAD, WRISTS, Exported
from tests.families import mostly_slow
from tests.scenes import scene

NAMES = ["planar", "thick", "tendons", "robot", "gripper", "loops"]


@pytest.mark.parametrize("name", mostly_slow(NAMES, quick=[name for name in NAMES if name != "gripper"]))
def test_scene_builds_the_model_of_the_folder(library: Callable[[str], Exported], name: str) -> None:
    """Of the same size, and with the residual of the compiled one."""
    made = library(name)
    again = build(read_scene(made.folder / "scene.toml"))
    assert again.discretisation == made.model.discretisation
    assert again.size == made.compiled.size
    x = np.random.default_rng(4).normal(scale=0.1, size=again.size)
    inputs = again.pack()
    assert_allclose(inputs, made.compiled.defaults, rtol=0, atol=0)
    assert_allclose(made.compiled.residual(x, inputs), again.residual(x, inputs), rtol=1e-9, atol=1e-9)


def uneven() -> Model:
    """A robot whose rods have modes, nodes and integrators of their own."""
    wanted = scene(LOAD, rods=ARMS, bodies=[HAND], joints=WRISTS)
    chosen = discretise(wanted, 2, 5, "magnus4")
    chosen["right"] = replace(chosen["right"], modes=(3,), nodes=6)
    chosen["finger"] = replace(chosen["finger"], transport="magnus6")
    return build(wanted, chosen)


@pytest.mark.slow
def test_rods_that_differ(tmp_path: Path) -> None:
    model = uneven()
    read = read_scene(export(model, tmp_path / "uneven") / "scene.toml")
    assert [own.rod for own in read.accuracy.of_rods] == ["right", "finger"]
    assert build(read).discretisation == model.discretisation
    assert solve(read).model.discretisation == model.discretisation


def test_rods_of_several_strains_with_lists_of_modes() -> None:
    """No list suits both, but a number and a list for one of them do."""
    rods = [
        {**ARMS[0], "strain": "kirchhoff", "stiffness": {"bending_x": 1.0, "bending_y": 1.0, "torsion": 1.0}},
        ARMS[1],
    ]
    wanted = scene(rods=rods)
    chosen = discretise(wanted, 2)
    chosen["left"] = replace(chosen["left"], modes=(2, 3, 1))
    kept = scene_from_dict(scene_tables(with_discretisation(wanted, chosen)))
    assert discretise(kept) == chosen


def test_scene_that_fixes_nothing_is_left_as_it_is() -> None:
    """What is exported has its numbers; the scene that was read keeps its own."""
    wanted: Scene = scene(LOAD, rods=ARMS, bodies=[HAND], joints=WRISTS)
    fixed = with_discretisation(wanted, discretise(wanted, 2, 5))
    assert fixed.accuracy.fixed
    assert not wanted.accuracy.fixed
    assert "of_rods" not in scene_tables(fixed)["accuracy"]
