"""Solving: methods against each other, warm starts, honest ends."""

from __future__ import annotations

from importlib.metadata import version
from typing import Any, cast

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

import cosserat_casadi
from cosserat_casadi import Outcome, SceneError, SolveError, build, discretise, parse_scene, solve
from cosserat_casadi.equilibrium.load_path import continuation_limits, load_path
from cosserat_casadi.equilibrium.metrics import pose_distance
from cosserat_casadi.model.build import Model
from cosserat_casadi.numerics.broyden import UpdatedJacobian
from cosserat_casadi.numerics.continuation import ContinuationSettings, Path, follow
from cosserat_casadi.numerics.newton import Equations, NewtonSettings, newton
from tests.families import mostly_slow
from tests.pose_errors import distance_between
from tests.scenes import HOOK, WEIGHT, WIND, push, rod, scene


@pytest.mark.parametrize("method", ["rootfinder", "nlpsol"])
@pytest.mark.parametrize("strain", mostly_slow(["planar", "kirchhoff", "reissner"], quick=["reissner"]))
def test_casadis_solvers_vs_continuation(method: str, strain: str) -> None:
    model = build(scene(push(), WEIGHT, strain=strain))
    ours, theirs = solve(model), solve(model, method=method)
    assert ours.converged
    assert theirs.converged
    assert_allclose(theirs.x, ours.x, rtol=0, atol=1e-9)


def test_warm_start_vs_cold_start() -> None:
    model = build(scene(push(), WEIGHT))
    wanted = {"push.force": [1.0, 0.4, -0.5]}
    near = solve(model)
    warm, cold = solve(model, wanted, start=near), solve(model, wanted)
    assert warm.converged
    assert_allclose(warm.x, cold.x, rtol=0, atol=1e-11)
    assert warm.iterations < cold.iterations


def test_start_of_another_model_is_refused() -> None:
    start = solve(build(scene(push(), strain="planar")))
    with pytest.raises(ValueError, match="unknowns"):
        solve(build(scene(push())), start=start)


def test_start_with_other_inputs_is_refused_and_its_unknowns_are_not() -> None:
    start = solve(build(scene(push())))
    model = build(scene(push(), WEIGHT))
    with pytest.raises(ValueError, match=f"the start has {start.inputs.size} inputs, the model {model.inputs.size}"):
        solve(model, start=start)
    assert_allclose(solve(model, start=start.x).x, solve(model).x, rtol=0, atol=1e-9)


def test_unknown_method_is_refused() -> None:
    with pytest.raises(ValueError, match="continuation"):
        solve(build(scene(push())), method="magic")


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"shove.force": [0, 0, 1]}, "is not an input"),
        ({"push.force": [0, 1]}, "must have 3 numbers"),
        ({"push.force": 1.0}, "must have 3 numbers"),
        ({"push.force": [0, np.nan, 1]}, "must be finite"),
        ({"push.force": "a", 1: 2.0}, r"(?s)1: is not an input.*push.force: must be numbers, got 'a'"),
    ],
)
def test_bad_values_are_refused(values: dict[str, object], words: str) -> None:
    with pytest.raises(SceneError, match=words):
        solve(build(scene(push())), values)


def test_inputs_out_of_their_physics_are_refused_at_once() -> None:
    cable = {"name": "cable", "kind": "tendon", "rod": "rod", "offset": [0.01, 0], "tension": 2.0, "friction": 0.1}
    pulled = scene(actuators=[cable], inputs=["cable.tension", "cable.pull"])
    model = build(pulled, discretise(pulled, 2, 6))
    words = r"(?s)cable.tension: must be >= 0, got -5.*cable.pull: must be <= 1, got 5"
    for values in ({"cable.tension": -5.0, "cable.pull": 5.0}, [-5.0, 5.0]):
        with pytest.raises(SceneError, match=words):
            solve(model, values)
    assert solve(model, {"cable.tension": 0.0, "cable.pull": -1.0}).converged
    # Optimisers pass bounds by as little as this.
    assert solve(model, {"cable.tension": -1e-8, "cable.pull": 1.0 + 1e-8}).converged


def test_unloaded_rod_needs_no_step() -> None:
    solution = solve(build(scene()))
    assert solution.converged
    assert_allclose(solution.x, 0.0, rtol=0, atol=0)
    assert_allclose(solution.tip().position, [0, 0, 0.8], rtol=0, atol=1e-15)


def test_load_past_a_limit_point_is_reported_as_stalled() -> None:
    """A follower moment does not limit; a shallow arch pinned at its tip does: pushed through, it must say so."""
    arch = rod("planar", intrinsic={"curvature": [0, 1.2, 0]})
    pinned = [{"rod": "rod", "kind": "pinned", "position": [0.35, 0.0, 0.6]}]
    load = {**HOOK, "force": [-400.0, 0.0, 250.0]}
    model = build(scene(load, rods=[arch], supports=pinned))
    solution = solve(model, settings=ContinuationSettings(steps=12))
    assert not solution.converged
    assert solution.outcome is Outcome.LOAD_STALLED
    assert 0.0 <= solution.load_factor < 1.0
    assert "Load factor reached" in solution.message
    with pytest.raises(SolveError, match="No equilibrium"):
        solve(model, settings=ContinuationSettings(steps=12), raise_on_failure=True)


def test_a_solver_that_lies_is_not_believed() -> None:
    """CasADi's Newton stops after one iteration and reports success where errors are off."""
    model = build(scene(push(force=[9.0, 0.0, 0.0])))
    settings = ContinuationSettings(newton=NewtonSettings(iterations=1))
    solution = solve(model, method="rootfinder", settings=settings)
    assert not solution.converged
    assert solution.residual_norm > 1e-6


def test_newton_says_not_finite() -> None:
    for residual, slope in ((1.0, np.nan), (np.nan, 1.0), (np.inf, 1.0)):
        equations = Equations(lambda x, r=residual: np.array([r]), lambda x, j=slope: np.array([[j]]))
        assert newton(equations, np.zeros(1), NewtonSettings()).outcome is Outcome.NOT_FINITE


def test_newton_says_iterations_ran_out() -> None:
    equations = Equations(lambda x: x - 1.0, lambda x: np.array([[1e3]]))
    result = newton(equations, np.zeros(1), NewtonSettings(iterations=3))
    assert result.outcome is Outcome.MAX_ITERATIONS
    assert result.iterations == 3


def test_newton_says_singular() -> None:
    """x² + 1 has no root: the search ends where the slope vanishes."""
    equations = Equations(lambda x: x**2 + 1, lambda x: np.array([[2 * x[0]]]))
    result = newton(equations, np.array([1.5]), NewtonSettings())
    assert result.outcome in (Outcome.SINGULAR, Outcome.MAX_ITERATIONS)
    assert result.residual_norm > 0.3


def test_kept_jacobian_vs_a_new_one_at_each_step() -> None:
    """Rank-one updates reach the same root superlinearly with one Jacobian where the start is near."""
    matrix = np.array([[4.0, 1.0, 0.0], [1.0, 3.0, -1.0], [0.0, -1.0, 5.0]])
    goal = np.array([0.3, -0.2, 0.1])

    def residual(x: np.ndarray) -> np.ndarray:
        return matrix @ (x - goal) + 0.3 * (x**3 - goal**3)

    asked: list[np.ndarray] = []

    def jacobian(x: np.ndarray) -> np.ndarray:
        asked.append(x)
        return matrix + np.diag(0.9 * x**2)

    result = newton(Equations(residual, jacobian), np.zeros(3), NewtonSettings())
    assert result.outcome is Outcome.CONVERGED
    assert len(asked) == result.jacobians == 1
    assert result.iterations <= 6
    assert_allclose(result.x, goal, rtol=0, atol=1e-11)


def test_updated_jacobian_vs_updates_of_the_matrix() -> None:
    """The inverse applied from the steps alone is that of B + (y − B s) sᵀ/(s·s), built as a matrix."""
    rng = np.random.default_rng(5)
    matrix = np.eye(4) + 0.2 * rng.standard_normal((4, 4))
    updated = matrix.copy()
    jacobian = UpdatedJacobian(matrix)
    x = np.zeros(4)

    def residual(x: np.ndarray) -> np.ndarray:
        return matrix @ x + 0.3 * np.sin(x) - 1.0

    for _ in range(5):
        step = jacobian.step(residual(x))
        assert step is not None
        assert_allclose(step, np.linalg.solve(updated, -residual(x)), rtol=1e-9, atol=1e-13)
        change = residual(x + step) - residual(x)
        updated += np.outer(change - updated @ step, step) / (step @ step)
        jacobian.steps.append(step)
        x = x + step


def test_solve_from_unknowns_nearby_vs_from_the_unloaded_rod() -> None:
    model = build(scene(push(force=[2.0, 0.5, 0.0])))
    cold = solve(model)
    warm = solve(model, {"push.force": [2.02, 0.505, 0.0]}, start=cold.x)
    again = solve(model, {"push.force": [2.02, 0.505, 0.0]})
    assert warm.converged
    assert warm.iterations < again.iterations
    assert_allclose(warm.x, again.x, rtol=0, atol=1e-10)


def test_solve_from_unknowns_that_lead_astray_vs_from_the_unloaded_rod() -> None:
    """A start far from any equilibrium may not decide the branch: the load is grown from zero instead."""
    model = build(scene(push(force=[2.0, 0.5, 0.0])))
    far = np.full(model.size, 3.0)
    assert_allclose(solve(model, start=far).x, solve(model).x, rtol=0, atol=1e-10)


def test_newton_solves_a_singular_but_consistent_system() -> None:
    """Two equal equations for two unknowns: the shortest step is taken."""
    matrix = np.array([[1.0, 1.0], [1.0, 1.0]])
    equations = Equations(lambda x: matrix @ x - 2.0, lambda x: matrix)
    result = newton(equations, np.zeros(2), NewtonSettings())
    assert result.outcome is Outcome.CONVERGED
    assert_allclose(result.x, [1.0, 1.0], rtol=0, atol=1e-12)


def cubic(load: float) -> Path:
    """x³ − 3x = t·load: from x = 0 the path folds at |t load| = 2; short of it the inner root is the right one."""
    return Path(
        residual=lambda x, t: x**3 - 3 * x - load * t,
        jacobian=lambda x, t: np.array([[3 * x[0] ** 2 - 3]]),
        rate=lambda x, t: np.array([-load]),
        start=np.zeros(1),
    )


def test_continuation_reaches_the_branch_of_the_growing_load() -> None:
    result = follow(cubic(1.9))
    assert result.outcome is Outcome.CONVERGED
    roots = np.roots([1, 0, -3, -1.9])
    assert_allclose(result.x[0], np.sort(roots.real)[1], rtol=0, atol=1e-10)


def test_continuation_stalls_at_a_fold() -> None:
    result = follow(cubic(4.0))
    assert result.outcome is Outcome.LOAD_STALLED
    assert_allclose(result.reached, 0.5, rtol=0, atol=1e-2)


@pytest.mark.parametrize("strain", mostly_slow(["planar", "kirchhoff", "reissner"], quick=["planar", "kirchhoff"]))
def test_stability_of_a_column_about_its_buckling_load(strain: str) -> None:
    """Euler's cantilever: π² EI/(4 ℓ²) with the softest bending; with shear and extension a little less."""
    critical = np.pi**2 / 4 * (1.4 if strain == "planar" else 1.0) / 0.8**2
    for share, stable in ((0.9, True), (1.1, False)):
        model = build(scene(push(force=[0.0, 0.0, -share * critical]), strain=strain))
        solution = solve(model)
        assert solution.converged
        assert solution.stable is stable
        assert ("unstable" in solution.message) is not stable


@pytest.mark.parametrize(
    ("changes", "judged"),
    [
        ({"frame": "body"}, False),
        ({"force": [0, 0, 0], "moment": [0.1, 0, 0.2]}, False),
        ({}, True),
        ({"frame": "body", "force": [0, 0, 0]}, True),
    ],
)
def test_stability_is_null_where_loads_have_no_potential(changes: dict[str, object], judged: bool) -> None:
    solution = solve(build(scene(push(**changes), WEIGHT)))
    assert (solution.stable is not None) is judged
    assert (solution.smallest_eigenvalue is not None) is judged


def test_a_dead_moment_has_a_potential_in_the_plane() -> None:
    solution = solve(build(scene(push(force=[0, 0, 0], moment=[0, 1.0, 0]), strain="planar")))
    assert solution.stable is True


@pytest.mark.parametrize("strain", mostly_slow(["kirchhoff", "reissner"], quick=["kirchhoff"]))
def test_clamped_tip_meets_its_pose_and_balances(strain: str) -> None:
    """The support's wrench makes the rod balance: base force and the support's force cancel, loads apart."""
    quaternion = np.array([0.9, 0.2, 0.3, -0.1])
    quaternion /= np.linalg.norm(quaternion)
    support = {"rod": "rod", "kind": "clamped", "position": [0.2, 0.15, 0.6], "quaternion": quaternion.tolist()}
    solution = solve(scene(WEIGHT, strain=strain, supports=[support]))
    assert solution.converged, solution.message
    tip = solution.tip()
    assert_allclose(tip.position, support["position"], rtol=0, atol=1e-11)
    assert_allclose(np.abs(tip.quaternion @ quaternion), 1.0, rtol=0, atol=1e-11)
    wrench = solution.internal_wrench(1.0)
    world_force = tip.rotation @ wrench[3:]
    weight = 0.9 * 0.8 * np.array(WEIGHT["acceleration"])
    assert_allclose(solution.base_wrench().force + world_force + weight, 0.0, rtol=0, atol=1e-7)


def test_pinned_tip_bears_no_moment() -> None:
    support = {"rod": "rod", "kind": "pinned", "position": [0.2, 0.15, 0.6]}
    solution = solve(scene(WEIGHT, supports=[support]))
    assert solution.converged, solution.message
    assert_allclose(solution.tip().position, support["position"], rtol=0, atol=1e-11)
    assert_allclose(solution.internal_wrench([1.0])[0, :3], 0.0, rtol=0, atol=1e-10)


def test_planar_clamp_vs_kirchhoff_clamp() -> None:
    """A rod clamped in its plane bends alike with three multipliers and with six."""
    half = 0.4
    support = {
        "rod": "rod",
        "kind": "clamped",
        "position": [0.25, 0.0, 0.65],
        "quaternion": [np.cos(half), 0.0, np.sin(half), 0.0],
    }
    flat = solve(build(scene(strain="planar", supports=[support])))
    stiff = rod(stiffness={"bending_x": 40.0, "bending_y": 1.4, "torsion": 40.0})
    spatial = solve(build(scene(rods=[stiff], supports=[support])))
    assert flat.converged
    assert spatial.converged
    assert_allclose(spatial.pose([0.3, 0.7]).position, flat.pose([0.3, 0.7]).position, rtol=0, atol=1e-9)


def test_two_rods_side_by_side_vs_one_at_a_time() -> None:
    second = rod(name="other", length=0.5, strain="planar", base={"position": [1, 0, 0]})
    both = solve(build(scene(push(), WEIGHT, rods=[rod(), second])))
    first = solve(build(scene(push(), WEIGHT)))
    alone = solve(build(scene(WEIGHT, rods=[second])))
    assert both.converged
    assert_allclose(both.tip("rod").position, first.tip().position, rtol=0, atol=1e-12)
    assert_allclose(both.tip("other").position, alone.tip().position, rtol=0, atol=1e-12)


def test_point_load_keeps_spectral_accuracy() -> None:
    """The tip under a force at X = 0.4 converges as fast as under one at the tip: elements end at the load."""
    fine = solve(build(*_discretised(12, 26)))
    errors = []
    for modes in (2, 4, 6):
        tip = solve(build(*_discretised(modes, 26))).tip().position
        errors.append(distance_between(tip, fine.tip().position))
    assert errors[1] < errors[0] / 50
    assert errors[2] < errors[1] / 50
    assert errors[2] < 1e-9


def _discretised(modes: int, nodes: int) -> tuple[object, object]:
    loaded = scene({**HOOK, "force": [2.0, -1.0, 0.5]}, WIND)
    return loaded, discretise(loaded, modes, nodes, "magnus8")


def test_tolerance_that_cannot_be_met_is_unresolved(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cosserat_casadi.accuracy.levels.REFERENCE_MODES", (2, 3, 4))
    solution = solve(scene(push(force=[8.0, 2.0, 0.0]), accuracy={"tolerance": 1e-10}))
    assert not solution.converged
    assert solution.outcome is Outcome.UNRESOLVED


def test_what_does_not_meet_a_tolerance_says_how_far_the_level_below_is(monkeypatch: pytest.MonkeyPatch) -> None:
    load = push(force=[8.0, 2.0, 0.0])
    monkeypatch.setattr("cosserat_casadi.accuracy.levels.REFERENCE_MODES", (2, 3, 4, 6))
    solution = solve(scene(load, accuracy={"tolerance": 1e-10}))
    assert solution.outcome is Outcome.UNRESOLVED
    four, six, many = (solve(build(scene(load), discretise(scene(load), m, 44, "magnus8"))) for m in (4, 6, 20))
    assert solution.error_estimate is not None
    assert_allclose(solution.error_estimate, pose_distance(four, six), rtol=1e-3, atol=0)
    assert 1e-10 < pose_distance(solution, many) <= solution.error_estimate
    assert solution.shape_error_estimate is not None
    assert solution.shape_error_estimate >= solution.error_estimate


def test_nothing_is_known_of_the_error_on_a_single_level(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cosserat_casadi.accuracy.levels.REFERENCE_MODES", (2, 3, 4))
    solution = solve(scene(push(force=[8.0, 2.0, 0.0]), accuracy={"tolerance": 1e-10}))
    assert solution.outcome is Outcome.UNRESOLVED
    assert solution.error_estimate is None


def test_fixed_discretisation_is_used_and_its_error_estimated() -> None:
    wanted = {"modes": [3, 4, 2], "nodes": 11}
    solution = solve(scene(push(), accuracy=wanted))
    assert solution.model.discretisation["rod"].modes == (3, 4, 2)
    assert solution.model.discretisation["rod"].nodes == 11
    truth = solve(build(*_fine_push()))
    error = distance_between(solution.tip().position, truth.tip().position) / 0.8
    assert solution.error_estimate is not None
    assert error <= 10 * solution.error_estimate
    assert solution.error_estimate <= 100 * error


def _fine_push() -> tuple[object, object]:
    loaded = scene(push())
    return loaded, discretise(loaded, 14, 30, "magnus8")


@pytest.mark.parametrize("modes", [1, 3])
def test_bar_that_only_stretches_vs_hookes_law(modes: int) -> None:
    """One unknown is enough: F L/EA, under a force along the bar and one across that it does not feel."""
    text = f"""
        schema = 1
        [accuracy]
        modes = {modes}
        nodes = 6
        [[rods]]
        name = "bar"
        length = 2.0
        strain = ["extension"]
        stiffness = {{ extension = 500.0 }}
        [[loads]]
        name = "pull"
        kind = "tip_wrench"
        rod = "bar"
        force = [7.0, 0.0, 25.0]
    """
    solution = solve(build(parse_scene(text)))
    assert solution.converged
    assert_allclose(solution.tip().position, [0.0, 0.0, 2.0 * (1 + 25.0 / 500.0)], rtol=0, atol=1e-14)


def test_a_path_from_a_solution_does_not_speak_of_the_unloaded_rod_alone() -> None:
    """Continuation from a solution that stalls has grown no load from zero, and its sentence must fit that too."""
    assert "growing the load from zero" not in Outcome.LOAD_STALLED.value
    assert "the solution started at" in Outcome.LOAD_STALLED.value


def test_stacked_inputs_are_those_by_name() -> None:
    model = build(scene(push(), WEIGHT))
    named = solve(model, {"push.force": [0.3, 0.1, -0.2]})
    stacked = solve(model, named.inputs)
    assert_allclose(stacked.x, named.x, rtol=0, atol=0)
    assert_allclose(solve(model, named.inputs.tolist()).x, named.x, rtol=0, atol=0)
    with pytest.raises(SceneError, match="inputs: must be 6 numbers, got 2"):
        solve(model, [1.0, 2.0])
    with pytest.raises(SceneError, match=r"push.force: must be finite"):
        solve(model, np.full(6, np.nan))


def test_shapes_of_tip_and_shape_are_those_documented() -> None:
    model = build(scene(push()))
    tip = model.tip["rod"]
    assert [tip.size_out(i) for i in range(tip.n_out())] == [(3, 1), (4, 1), (3, 3)]
    shape = model.shape["rod"]
    assert [shape.size_out(i) for i in range(shape.n_out())] == [(3, 1), (4, 1)]
    solution = solve(model)
    abscissae = [0.2, 0.7, 1.0]
    positions, _ = shape.map(3)(
        np.tile(solution.x, (3, 1)).T, np.tile(solution.inputs, (3, 1)).T, np.array([abscissae])
    )
    assert_allclose(positions.full().T, solution.pose(abscissae).position, rtol=0, atol=1e-14)


def test_the_package_says_its_version() -> None:
    assert cosserat_casadi.__version__ == version("cosserat-casadi")


class SingularAtStart:
    """A model whose unloaded stiffness is exactly zero."""

    def __init__(self, model: Model) -> None:
        self.model = model

    def __getattr__(self, name: str) -> Any:
        return getattr(self.model, name)

    def path_jacobian(self, x: Any, *given: Any) -> ca.DM:
        load_factor = given[-1]
        return self.model.path_jacobian(x, *given) * float(load_factor > 0.0)


def test_a_load_path_that_begins_singular_ends_in_an_outcome() -> None:
    model = build(scene(push(), WEIGHT))
    inputs = model.pack()
    path = load_path(cast(Model, SingularAtStart(model)), inputs)
    assert path.tangent is None
    followed = follow(path, continuation_limits(model))
    assert followed.outcome is Outcome.CONVERGED
    assert_allclose(followed.x, solve(model, inputs).x, rtol=1e-9, atol=1e-12)
