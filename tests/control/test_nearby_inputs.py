"""Newton's method for targets near an equilibrium: beside the interior-point search, in ranges, where it gives up."""

from __future__ import annotations

from dataclasses import replace
from importlib import import_module
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import lsq_linear

from cosserat_casadi import Model, Solution, build, solve
from cosserat_casadi.control.inverse import search, search_near
from cosserat_casadi.control.inverse_accuracy import inverse_rows
from cosserat_casadi.control.lifted_problem import LiftedProblem, lifted_problem
from cosserat_casadi.control.nearby_inputs import followed, shortest
from cosserat_casadi.scene.target_records import PoseTarget, PositionTarget
from tests.scenes import push, scene

POSE = {"kind": "pose", "rod": "rod", "position": [0.0, 0.0, 0.8], "quaternion": [1, 0, 0, 0]}
POSITION = {"kind": "position", "rod": "rod", "position": [0.0, 0.0, 0.8]}
BENDING = ["bending_x", "bending_y", "torsion", "extension"]
FORCE = [0.4, 0.2, 0.05]
MOMENT = [0.05, -0.1, 0.08]


def model_of(target: dict[str, Any], inputs: list[str], **changes: Any) -> Model:
    accuracy = {"modes": 4, "nodes": 9, "tolerance": 1e-3}
    return build(
        scene(push(force=[0.0] * 3), strain=BENDING, accuracy=accuracy, inputs=inputs, targets=[target], **changes)
    )


def problem_at(model: Model, values: dict[str, Any]) -> tuple[LiftedProblem, Solution]:
    """The problem of reaching where the tip is at these values, and an equilibrium near to it."""
    tip = solve(model, values).tip()
    (target,) = model.scene.targets
    assert isinstance(target, PositionTarget | PoseTarget)
    wanted: dict[str, Any] = {"position": tuple(tip.position)}
    if isinstance(target, PoseTarget):
        wanted["quaternion"] = tuple(tip.quaternion)
    near = solve(model, {name: 0.9 * np.array(value) for name, value in values.items()})
    return lifted_problem(model, (target.model_copy(update=wanted),), near, False), near


@pytest.mark.parametrize(
    ("target", "values"),
    [
        pytest.param(POSITION, {"push.force": FORCE}, marks=pytest.mark.slow),
        (POSE, {"push.force": FORCE, "push.moment": MOMENT}),
    ],
    ids=["position", "pose"],
)
def test_what_the_optimiser_finds_is_found(target: dict[str, Any], values: dict[str, Any]) -> None:
    problem, near = problem_at(model_of(target, list(values)), values)
    found = followed(problem, near)
    searched = search(problem, near, False, 0)
    assert found is not None
    assert found.met
    assert (found.rounds, searched.rounds > 0) == (0, True)
    for name, value in values.items():
        assert_allclose(found.values[name][:, 0], value, rtol=0, atol=1e-9)
        assert_allclose(searched.values[name][:, 0], value, rtol=0, atol=1e-6)


def test_inputs_stay_in_their_ranges() -> None:
    """More inputs than a position needs: where one is at the end of its range, the others make up for it."""
    limit = {"input": "push.force", "lower": -0.38, "upper": 0.38}
    loose = {"input": "push.moment", "lower": -1.0, "upper": 1.0}
    model = model_of(POSITION, ["push.force", "push.moment"], bounds=[limit, loose])
    # The range ends short of the force that was there.
    problem, near = problem_at(model, {"push.force": FORCE})
    found = followed(problem, near)
    assert found is not None
    assert found.met
    assert_allclose(found.gaps[0].position, 0.0, rtol=0, atol=1e-12)
    assert np.all(np.abs(found.values["push.force"]) <= 0.38)


def test_what_is_out_of_reach_goes_to_the_search() -> None:
    model = model_of(POSITION, ["push.force"], bounds=[{"input": "push.force", "lower": -0.3, "upper": 0.3}])
    problem, near = problem_at(model, {"push.force": FORCE})
    result = search_near(problem, near, False, 0)
    assert not result.met
    assert result.rounds > 0
    assert result.at_bounds == ("push.force",)


def test_rows_after_the_first_take_no_optimiser() -> None:
    model = model_of(POSITION, ["push.force"])
    (target,) = model.scene.targets
    assert isinstance(target, PositionTarget)
    rows = []
    for share in (0.25, 0.5, 0.75, 1.0):
        tip = solve(model, {"push.force": share * np.array(FORCE)}).tip()
        rows.append((target.model_copy(update={"position": tuple(tip.position)}),))
    found = inverse_rows(model.scene, rows)
    assert all(row.met for row in found)
    assert found[0].rounds > 0
    assert [row.rounds for row in found[1:]] == [0, 0, 0]


def test_the_shortest_change() -> None:
    """Without ranges that of the pseudoinverse; within ranges one that leaves no errors, where there is one."""
    rng = np.random.default_rng(7)
    free = np.full(5, 10.0)
    reached = 0
    for _ in range(50):
        moved, errors = rng.normal(size=(2, 5)), rng.normal(size=2)
        step = shortest(moved, errors, -free, free)
        assert_allclose(step, -np.linalg.pinv(moved) @ errors, rtol=1e-12, atol=1e-12)
        limit = 0.8 * np.abs(step).max() * np.ones(5)
        within = shortest(moved, errors, -limit, limit)
        assert np.all(np.abs(within) <= limit * (1 + 1e-15))
        best = lsq_linear(moved, -errors, (-limit, limit), tol=1e-14)
        if best.cost < 1e-20:
            reached += 1
            assert_allclose(moved @ within, -errors, rtol=0, atol=1e-12)
    assert reached > 25


def test_no_number_ends_it() -> None:
    problem, near = problem_at(model_of(POSITION, ["push.force"]), {"push.force": FORCE})
    broken = replace(near, x=np.full_like(near.x, np.nan))
    assert followed(problem, broken) is None


@pytest.mark.slow
def test_an_unstable_end_goes_to_the_search(monkeypatch: pytest.MonkeyPatch) -> None:
    """Newton's method may cross a fold: what it finds there is no answer where another may be."""
    problem, near = problem_at(model_of(POSITION, ["push.force"]), {"push.force": FORCE})
    found = followed(problem, near)
    assert found is not None
    unstable = replace(found, solution=replace(found.solution, stable=False))
    # The package has a function of the module's name.
    monkeypatch.setattr(import_module("cosserat_casadi.control.inverse"), "followed", lambda *_: unstable)
    assert search_near(problem, near, False, 0).rounds > 0


def test_what_settles_short_of_the_target_is_not_found() -> None:
    model = model_of(POSITION, ["push.force"], bounds=[{"input": "push.force", "lower": -0.3, "upper": 0.3}])
    problem, near = problem_at(model, {"push.force": FORCE})
    assert followed(problem, near) is None
