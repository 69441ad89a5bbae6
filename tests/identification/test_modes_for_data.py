"""Modes and nodes of an identification: those that the data ask for, and what is told while they are chosen."""

from __future__ import annotations

from typing import Any

import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import build, modes_of
from cosserat_casadi.identification.fit_discretisation import FitDiscretisation, with_discretisation
from cosserat_casadi.identification.measured_cases import read_cases
from cosserat_casadi.scene import scene_from_dict
from tests.identification.made_up import WIRE, MadeUp
from tests.scenes import push, rod, scene


def chosen(shapes: MadeUp, stages: list[str] | None = None, **changes: Any) -> FitDiscretisation:
    """What is chosen for the wire with a table of accuracy and one of measurements changed."""
    measured = {**WIRE["measurements"][0], **changes.pop("measured", {})}
    completed = scene_from_dict({**WIRE, "accuracy": {}, "measurements": [measured], **changes}).with_unknowns()
    draft = build(completed)
    told: list[str] = [] if stages is None else stages
    return with_discretisation(completed, draft, read_cases(completed, draft.inputs, shapes.data), told.append)


@pytest.mark.slow
def test_the_deviations_of_the_data_say_how_exact_the_model_is(shapes: MadeUp) -> None:
    """A tenth of 0.2 mm on 0.2 m; a tolerance that is written holds, and a guess of a deviation is not believed."""
    of_data = chosen(shapes).scene.accuracy
    assert_allclose(of_data.tolerance, 1e-4, rtol=1e-12, atol=0)
    written = chosen(shapes, accuracy={"tolerance": 1e-6}).scene.accuracy
    assert_allclose(written.tolerance, 1e-6, rtol=1e-12, atol=0)
    assert of_data.nodes < written.nodes
    guessed = chosen(shapes, measured={"sigma": 1.0}).scene.accuracy
    assert_allclose(guessed.tolerance, 1e-3, rtol=1e-12, atol=0)
    exact = chosen(shapes, measured={"sigma": 1e-9}).scene.accuracy
    assert_allclose(exact.tolerance, 1e-6, rtol=1e-12, atol=0)


def test_stages_of_the_choice_are_told(shapes: MadeUp) -> None:
    """Each solve is told: between two stages of an identification there may be seconds."""
    stages: list[str] = []
    chosen(shapes, stages)
    assert len(stages) >= 4
    assert stages[0].startswith("discretisation for equilibria: 1 of ")


def test_stages_of_modes_are_told() -> None:
    stages: list[str] = []
    beam = scene(push(force=[0, 0, 0]), rods=[rod("planar")], accuracy={"modes": 3, "nodes": 6})
    modes_of(beam, count=1, report=stages.append)
    assert "equations of motion of 3 unknowns" in stages
    assert "eigenvalues of 3 unknowns" in stages
