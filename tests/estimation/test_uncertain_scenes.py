"""Estimates where the scene is known roughly: what rows share, what contradicts the model, bent posteriors."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import least_squares, lsq_linear
from scipy.stats import chi2

from cosserat_casadi import Model, SceneError, build, scene_from_dict, solve
from cosserat_casadi.codegen.estimator import Estimates
from cosserat_casadi.estimation import estimate
from cosserat_casadi.estimation.consistency import chi_square_deviations, consistency
from cosserat_casadi.estimation.posterior import normal_draws, sampled
from cosserat_casadi.estimation.shared import Searched, SharedSearch
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.arrow_least_squares import Limits
from cosserat_casadi.scene import Scene
from tests.estimation.test_estimate import nees
from tests.scenes import push, rod

STIFFNESS = "rod.stiffness.bending_y"
BENDING = 1.4
UNSURE = 0.05
SIGMA = 1e-3
PRIOR = 0.4
AT = (0.25, 0.5, 0.75, 1.0)
FELT = {"input": "push.force.x", "per_row": True, "prior": {"mean": 0.0, "sigma": PRIOR}}
ROUGHLY = {"parameter": STIFFNESS, "prior": {"mean": BENDING, "sigma": UNSURE * BENDING}}
WEIGHT = {"name": "hung", "kind": "point_wrench", "rod": "rod", "at": 0.6, "force": [0.0, 0.0, 0.0]}


def felt(*unknowns: dict[str, Any], loads: tuple[dict[str, Any], ...] = (), **changes: Any) -> Scene:
    """A planar rod with four markers, whose tip is pushed from the side; a known force hangs on it."""
    measured = [
        {
            "quantity": "position",
            "name": f"marker {k}",
            "file": "shapes",
            "inputs": {"hung.force.x": "hung_N"},
            "rod": "rod",
            "at": at,
            "columns": [f"{axis}{k}" for axis in "xyz"],
            "sigma": SIGMA,
        }
        for k, at in enumerate(AT)
    ]
    tables = {
        "schema": 1,
        "accuracy": {"modes": 3, "nodes": 8, "tolerance": 1e-3},
        "rods": [rod("planar")],
        "loads": [push(force=[0.0, 0.0, 0.0]), WEIGHT, *loads],
        "measurements": measured,
        "unknowns": list(unknowns),
        **changes,
    }
    return scene_from_dict(tables)


def model_of(*unknowns: dict[str, Any], **changes: Any) -> Model:
    return build(felt(*unknowns, **changes).with_unknowns())


def shapes(stiffness: float, forces: FloatArray, hung: FloatArray, seed: int, off: float = 0.0) -> dict[str, Any]:
    """Markers of a rod of some stiffness, with noise; one marker reads off to one side by so many deviations."""
    rng = np.random.default_rng(seed)
    model = build(felt(FELT, ROUGHLY).with_unknowns())
    columns: dict[str, list[float]] = {f"{axis}{k}": [] for k in range(len(AT)) for axis in "xyz"}
    for force, weight in zip(forces, hung, strict=True):
        loads = {"push.force": [force, 0.0, 0.0], "hung.force": [weight, 0.0, 0.0]}
        positions = solve(model, loads, parameters={STIFFNESS: stiffness}).pose(AT, "rod").position
        positions = positions + rng.normal(0.0, SIGMA, positions.shape)
        positions[-1, 2] += off * SIGMA
        for k, position in enumerate(positions):
            for axis, value in zip("xyz", position, strict=True):
                columns[f"{axis}{k}"].append(value)
    return {"shapes": {"hung_N": hung, **columns}}


def with_uncertain_stiffness(batches: int, rows: int) -> dict[str, FloatArray]:
    """Squared errors in the metric of the covariances, the stiffness taken for known and for known roughly."""
    rng = np.random.default_rng(3)
    trusting, knowing = model_of(FELT), model_of(FELT, ROUGHLY)
    squares: dict[str, list[float]] = {"trusting": [], "knowing": [], "stiffness": []}
    for batch in range(batches):
        stiffness = BENDING * (1 + UNSURE * rng.normal())
        forces = PRIOR * rng.normal(size=rows)
        # Where nothing else is known the shape tells forces over stiffness alone.
        data = shapes(stiffness, forces, 0.0 * forces, batch)
        squares["trusting"] += nees(estimate(trusting, data), forces[:, None]).tolist()
        found = estimate(knowing, data)
        assert found.shared is not None
        squares["knowing"] += nees(found, forces[:, None]).tolist()
        squares["stiffness"].append(((found.shared.values - stiffness) / found.shared.sigma).item() ** 2)
    return {word: np.array(values) for word, values in squares.items()}


@pytest.mark.slow
def test_an_uncertain_stiffness_enters_the_covariance() -> None:
    squares = with_uncertain_stiffness(batches=60, rows=8)
    assert squares["trusting"].mean() > 5
    # Rows of one batch share the error of the stiffness: 60 of 480 squares are free at least.
    low, high = chi2.ppf([0.005, 0.995], 60) / 60
    assert low <= squares["knowing"].mean() <= high
    assert low <= squares["stiffness"].mean() <= high


def test_a_stiffness_vs_the_integral_over_what_rows_feel() -> None:
    """The marginal posterior of the stiffness by searches of each row at three stiffnesses, on the solver in Python."""
    hung = np.array([4.0, -3.0])
    data = shapes(1.07 * BENDING, np.array([0.3, -0.2]), hung, 7)
    found = estimate(model_of(FELT, ROUGHLY), data)
    model = model_of(FELT, ROUGHLY)
    numbers = np.stack([data["shapes"][f"{axis}{k}"] for k in range(len(AT)) for axis in "xyz"], axis=1)
    assert found.shared is not None
    assert found.shared.settled
    best, sigma = found.shared.values[0], found.shared.sigma[0]
    least = []
    felt_there = []
    stiffnesses = best + 0.5 * sigma * np.array([-1.0, 0.0, 1.0])
    for stiffness in stiffnesses:
        total = ((stiffness - BENDING) / (UNSURE * BENDING)) ** 2 / 2
        rows_felt = []
        for row in range(2):

            def misfit(u: FloatArray, row: int = row, stiffness: float = stiffness) -> FloatArray:
                loads = {"push.force": [u[0], 0.0, 0.0], "hung.force": [hung[row], 0.0, 0.0]}
                positions = solve(model, loads, parameters={STIFFNESS: stiffness}).pose(AT, "rod").position
                return np.append((positions.ravel() - numbers[row]) / SIGMA, u[0] / PRIOR)

            other = least_squares(misfit, found.values[row], max_nfev=4)
            information = float((other.jac.T @ other.jac).item())
            total += other.cost + np.log(information) / 2
            rows_felt.append((other.x[0], information))
        least.append(total)
        felt_there.append(rows_felt)
    curvature = (least[0] - 2 * least[1] + least[2]) / (0.5 * sigma) ** 2
    slope = (least[2] - least[0]) / sigma
    # The differences that volumes are taken by, and the first derivatives alone of the costs, leave this much.
    assert abs(slope / curvature) < 0.02 * sigma
    assert_allclose(sigma, curvature**-0.5, rtol=0.02, atol=0)
    for row in range(2):
        at_best, information = felt_there[1][row]
        moved = (felt_there[2][row][0] - felt_there[0][row][0]) / sigma
        assert_allclose(found.values[row, 0], at_best, rtol=0, atol=5e-3 * found.sigma[row, 0])
        assert_allclose(found.sigma[row, 0] ** 2, 1 / information + (moved * sigma) ** 2, rtol=0.02, atol=0)
    assert sigma < 0.9 * UNSURE * BENDING
    told = found.to_dict()
    assert told["shared"][0]["unknown"] == STIFFNESS
    assert told["consistency"]["holds"]
    # The rows that are checked, and whoever solves them again, have the stiffness that was found.
    assert_allclose(found.parameters, np.full((2, 1), best), rtol=1e-12, atol=0)


@pytest.mark.slow
def test_an_uncertain_offset_of_a_marker_is_found_beside_what_rows_feel() -> None:
    """The marker that reads off to one side, below, is explained where its offset is an unknown."""
    offset = {"parameter": "marker 3.offset.z", "prior": {"mean": 0.0, "sigma": 2 * SIGMA}}
    found = estimate(model_of(FELT, offset), rows(40, off=0.9))
    assert found.shared is not None
    assert abs(found.shared.values[0] - 0.9 * SIGMA) < 4 * found.shared.sigma[0]
    assert found.shared.sigma[0] < 0.3 * SIGMA
    assert found.consistency.holds


def test_a_shared_number_at_its_bound_stays_there_while_others_settle() -> None:
    """One row with the deviations u − 1, u + p − 3 and p + q − 4, with p at most 1.5, vs scipy."""
    matrix = np.array([[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 1.0]])
    data = np.array([1.0, 3.0, 4.0])
    limits = Limits(
        lower=np.full(2, -np.inf),
        upper=np.array([1.5, np.inf]),
        mean=np.zeros(2),
        weight=np.full(2, 0.1),
        ratios=np.zeros(2, dtype=bool),
    )

    def search(shared: FloatArray) -> Searched:
        unknowns = np.concatenate([[2.0 - shared[0] / 2.0], shared])
        residual = matrix @ unknowns - data
        found = Estimates(
            outcome=np.zeros(1, dtype=np.int64),
            iterations=np.zeros(1, dtype=np.int64),
            cost=np.array([residual @ residual / 2.0]),
            unknowns=unknowns[None],
            information=(matrix.T @ matrix)[None],
            gradient=(matrix.T @ residual)[None],
            residuals=residual[None],
            x=np.zeros((1, 0)),
        )
        return found, None

    own = Limits(*(np.array([number]) for number in (-np.inf, np.inf, 0.0, 0.0)), ratios=np.zeros(1, dtype=bool))
    _, shared, _ = SharedSearch(search, limits, own).run(("p", "q"), ("1", "1"))
    with_priors = np.vstack([matrix, 0.1 * np.eye(3)[1:]])
    other = lsq_linear(with_priors, np.append(data, [0.0, 0.0]), (-np.inf, [np.inf, 1.5, np.inf]), tol=1e-14)
    assert shared.settled
    assert_allclose(shared.values, other.x[1:], rtol=0, atol=1e-6)


def test_numbers_that_all_rows_share_need_a_prior() -> None:
    model = model_of(FELT, {"parameter": STIFFNESS})
    with pytest.raises(SceneError, match="has no prior"):
        estimate(model, {})
    with pytest.raises(SceneError, match="no unknown differs from row to row"):
        estimate(model_of(ROUGHLY), {})


def rows(count: int, **changes: Any) -> dict[str, Any]:
    rng = np.random.default_rng(1)
    return shapes(BENDING, PRIOR * rng.normal(size=count), np.zeros(count), 2, **changes)


@pytest.mark.slow
def test_data_that_the_model_explains_are_not_doubted() -> None:
    found = estimate(model_of(FELT), rows(40))
    assert found.consistency.holds
    assert found.consistency.freedom == 40 * 12
    assert found.warnings == () or not any("explain" in warning for warning in found.warnings)


@pytest.mark.slow
def test_a_number_that_a_bound_holds_is_not_fitted() -> None:
    """Of a rod that nothing pushes half of the rows would pull: their force stays at its bound, zero."""
    known = estimate(model_of({**FELT, "lower": 0.0}), shapes(BENDING, np.zeros(12), np.zeros(12), 4))
    held = int(np.count_nonzero(known.values == 0.0))
    assert 0 < held < 12
    assert known.consistency.freedom == 12 * 12 + held
    shared = estimate(model_of(FELT, {**ROUGHLY, "lower": 1.1 * BENDING}), rows(12))
    assert shared.shared is not None
    assert_allclose(shared.shared.values, 1.1 * BENDING, rtol=1e-12, atol=0)
    assert shared.consistency.freedom == 12 * 12 + 1


def test_bounds_of_what_all_rows_share_are_tried_beforehand() -> None:
    """A place that all rows share, and that may come behind the next one."""
    at = {"parameter": "hung.at", "prior": {"mean": 0.6, "sigma": 0.01}, "lower": 0.3, "upper": 0.95}
    hook = {"name": "hook", "kind": "point_wrench", "rod": "rod", "at": 0.8, "force": [0.1, 0.0, 0.0]}
    with pytest.raises(SceneError, match="must keep their order") as refusal:
        estimate(model_of(FELT, at, loads=(hook,)), {})
    assert "narrow lower and upper" in str(refusal.value)


def test_data_that_the_model_does_not_explain_are_told() -> None:
    """Noise that is larger by an eighth than sigma says: each row looks sound by itself."""
    noisier = dict(rows(40)["shapes"])
    rng = np.random.default_rng(5)
    for name, values in noisier.items():
        if name != "hung_N":
            noisier[name] = np.array(values) + rng.normal(0.0, 0.5 * SIGMA, len(values))
    found = estimate(model_of(FELT), {"shapes": noisier})
    assert not found.consistency.holds
    assert np.nanmax(found.consistency.row_deviations) < 5
    assert any("do not explain the data" in warning for warning in found.warnings)


def test_a_sensor_that_is_off_to_one_side_and_a_row_that_stands_out_are_told() -> None:
    data = rows(40, off=0.9)
    # Out of the plane, where no force can follow it.
    data["shapes"]["y2"][4] += 8 * SIGMA
    found = estimate(model_of(FELT), data)
    assert list(found.consistency.biased) == ["marker 3 z at X = 1"]
    assert any("off to one side" in warning and "marker 3 z at X = 1" in warning for warning in found.warnings)
    assert np.flatnonzero(found.consistency.outlying).tolist() == [4]
    assert any("1 row stands out" in warning for warning in found.warnings)


def test_one_row_of_two_that_stands_out_is_told() -> None:
    """The other row fits so well that the sum of both is no reason to doubt."""
    found = consistency(np.array([110.0, 20.0]), np.array([40, 40]), 0.0, {})
    assert found.outlying.tolist() == [True, False]
    assert found.deviations < 4
    assert not found.holds
    (sentence,) = found.sentences(["row 1", "row 2"])
    assert sentence.startswith("1 row stands out")


@pytest.mark.parametrize("count", [1, 3])
def test_one_reading_that_is_far_off_is_no_side_of_all_rows(count: int) -> None:
    readings = np.zeros(count)
    readings[0] = 12.0
    squares = 40.0 + readings**2
    found = consistency(squares, np.full(count, 40), 0.0, {"marker": readings})
    assert not found.biased
    assert not found.holds


@pytest.mark.parametrize("freedom", [3, 40, 1000])
def test_deviations_of_a_sum_of_squares_vs_its_distribution(freedom: int) -> None:
    for tail in (0.5, 1e-2, 1e-5):
        squares = chi2.isf(tail, freedom)
        normal = np.sqrt(chi2.isf(2 * tail, 1)) if tail < 0.5 else 0.0
        assert_allclose(chi_square_deviations(squares, freedom), normal, rtol=0, atol=0.15)


@pytest.mark.parametrize("k", [1, 3, 7])
def test_draws_have_the_moments_of_a_normal_distribution(k: int) -> None:
    z = normal_draws(255, k)
    assert z.shape == (256, k)
    assert_allclose(z.mean(axis=0), 0.0, rtol=0, atol=1e-13)
    assert_allclose(z.T @ z / len(z), np.eye(k), rtol=0, atol=1e-12)
    assert_allclose(np.mean(z**4, axis=0), 3.0, rtol=0.2, atol=0)


def test_draws_from_a_bent_posterior_vs_quadrature() -> None:
    """A banana: y = x² / 6 within 0.5, x normal; about its maximum at 0."""

    def costs(steps: FloatArray) -> FloatArray:
        x, y = steps[..., 0], steps[..., 1]
        return x**2 / 2 + (y - x**2 / 6) ** 2 / (2 * 0.5**2)

    found = sampled(costs, np.zeros(1), np.diag([1.0, 0.5**2])[None], 1024)
    # E[x²] = 1, E[y²] = 0.5² + E[x⁴] / 36.
    assert_allclose(found.covariance[0], [[1.0, 0.0], [0.0, 0.5**2 + 3 / 36]], rtol=0, atol=0.05)
    assert found.sound.all()


@pytest.mark.parametrize(("wide", "narrow"), [(10.0, 0.02), (0.02, 0.02), (0.001, 0.001)])
def test_draws_that_miss_narrow_bounds_are_not_believed(wide: float, narrow: float) -> None:
    """An estimate in a corner of bounds that are narrower than its deviations: few draws hit, or none."""
    upper = np.array([wide, narrow, narrow])

    def costs(steps: FloatArray) -> FloatArray:
        is_outside = ((steps < 0.0) | (steps > upper)).any(axis=2)
        return np.where(is_outside, np.inf, np.sum(steps**2, axis=2) / 2)

    found = sampled(costs, np.zeros(1), np.eye(3)[None], 256)
    assert not found.sound.any()


@pytest.mark.slow
def test_draws_of_a_wire_that_is_bent_far_hold() -> None:
    """Rows that bend the rod by much, coarsely measured: intervals by draws hold, those of the tangent do not."""
    coarse = {"sigma": 30 * SIGMA}
    prior = {"mean": 0.0, "sigma": 5.0}
    scene = felt({**FELT, "prior": prior}, {**FELT, "input": "push.force.z", "prior": prior})
    measurements = tuple(record.model_copy(update=coarse) for record in scene.measurements)
    scene = scene.model_copy(update={"measurements": measurements})
    model = build(scene.with_unknowns())
    rng = np.random.default_rng(11)
    forces = 5.0 * rng.normal(size=(150, 2))
    columns: dict[str, list[float]] = {f"{axis}{k}": [] for k in range(len(AT)) for axis in "xyz"}
    for x, z in forces:
        positions = solve(model, {"push.force": [x, 0.0, z]}).pose(AT, "rod").position
        for k, position in enumerate(positions + rng.normal(0.0, 30 * SIGMA, positions.shape)):
            for axis, value in zip("xyz", position, strict=True):
                columns[f"{axis}{k}"].append(value)
    data = {"shapes": {"hung_N": np.zeros(150), **columns}}
    by_tangent = estimate(model, data)
    drawing = scene.estimation.model_copy(update={"draws": 128})
    by_draws = estimate(build(scene.model_copy(update={"estimation": drawing}).with_unknowns()), data)
    assert by_draws.found.all()
    assert np.array_equal(by_draws.values, by_tangent.values)
    low, high = chi2.ppf([0.005, 0.995], 2 * 150) / 150
    assert nees(by_tangent, forces).mean() > 1.3 * high
    assert low <= nees(by_draws, forces).mean() <= high
