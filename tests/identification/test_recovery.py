"""Random truths and starts: all are recovered to the noise, and intervals hold the truth as often as they say."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from benchmarks.identification import one_try
from benchmarks.validation import PAGE, SCENES, STUDIES, marks, pages_tables, validated
from cosserat_casadi import Model, build, identify, modes_of, read_scene, solve
from cosserat_casadi.identification.measured_cases import read_cases
from cosserat_casadi.identification.model_identification import FitDiscretisation, with_discretisation
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.scene import scene_from_dict
from tests.identification.made_up import WIRE, MadeUp
from tests.scenes import push, rod, scene

TRIES = 100


@pytest.mark.slow
def test_intervals_hold_the_truth() -> None:
    """`benchmarks/identification.py` does the same a thousand times."""
    tries = [one_try(seed) for seed in range(1000, 1000 + TRIES)]
    assert all(one.converged for one in tries)
    deviations = np.array([one.deviations for one in tries])
    # Of 400 normal numbers, four of a try correlated.
    assert np.abs(deviations).max() < 4.5
    covered = np.mean(np.abs(deviations) < 1.96)
    assert 0.91 < covered < 0.985
    assert 0.85 < np.sqrt(np.mean(deviations**2)) < 1.15


# The experiments of docs/validation.md give what the page says.


NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[+-]?\d+)?")


def numbers(text: str) -> list[float]:
    return [float(number) for number in NUMBER.findall(text)]


def test_scenes_read_their_data() -> None:
    assert sorted(path.stem for path in SCENES.glob("*.toml")) == sorted(study.name for study in STUDIES)
    scene = read_scene(SCENES / "three_tendon_robot.toml")
    assert len(read_cases(scene, build(scene.with_unknowns()).inputs)) == 77


@pytest.mark.slow
def test_experiments_give_what_the_page_says() -> None:
    page = PAGE.read_text()
    for name, text in pages_tables(validated()).items():
        begin, end = marks(name)
        written = page.split(begin)[1].split(end)[0]
        assert NUMBER.sub("#", written).split() == NUMBER.sub("#", text).split(), name
        # 2 % of a number, and one in its last digit: the ends of intervals depend on rounding most.
        assert_allclose(numbers(text), numbers(written), rtol=0.02, atol=0.02, err_msg=name)


# A tentacle whose data say little of its Poisson ratio: the search meets a bound and goes on along it.


SCENE = Path(__file__).with_name("tentacle.toml")

NOISE = 5e-3
"""Standard deviation of the measured positions, m."""


@pytest.fixture(scope="module")
def tentacle() -> Model:
    return build(read_scene(SCENE).with_unknowns())


def measured(tentacle: Model) -> dict[str, FloatArray]:
    """Positions of two markers by column, as the scene's numbers and noise give them."""
    # Noise with which a search that cut single unknowns off at their bounds stalled.
    rng = np.random.default_rng(2)
    tensions = [(0.0, 0.0), (4.0, 0.0), (8.0, 0.0), (0.0, 4.0), (0.0, 8.0), (6.0, 3.0)]
    offsets = np.array([[0.0, -0.021, 0.0], [0.0, 0.0, 0.008]])
    positions = []
    for first, second in tensions:
        solution = solve(tentacle, {"m1.tension": first, "m2.tension": second})
        assert solution.converged
        pose = solution.pose(np.array([0.6, 1.0]))
        markers = pose.position + np.einsum("kij,kj->ki", pose.rotation, offsets)
        positions.append((markers + NOISE * rng.standard_normal(markers.shape)).ravel())
    columns = np.hstack([np.array(tensions), np.array(positions)])
    return dict(zip(("t1", "t2", "mx", "my", "mz", "tx", "ty", "tz"), columns.T, strict=True))


@pytest.mark.slow
def test_the_bound_is_named_and_the_others_go_on(tentacle: Model) -> None:
    data = measured(tentacle)
    found = identify(tentacle, {"middle": data, "tip": data})
    assert found.converged, found.message
    assert found.at_bounds == ("arm.material.poisson_ratio",)
    assert found.shared[found.labels.index("arm.material.poisson_ratio")] == 0.4
    others = [label not in found.at_bounds for label in found.labels]
    assert_array_equal(np.isfinite(found.sigma), others)
    assert any("At a bound: arm.material.poisson_ratio" in warning for warning in found.warnings)


# Modes and nodes of an identification: those that the data ask for, and what is told while they are chosen.


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
