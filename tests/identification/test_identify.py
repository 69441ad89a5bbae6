"""Identification: the optimum and its Jacobian by scipy over `solve`, recovery, statistics, what data leave open."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.optimize
from numpy.testing import assert_allclose

from cosserat_casadi import Identification, Model, SceneError, build, identify, read_scene, solve
from cosserat_casadi.identification.case_equilibria import Equilibria
from cosserat_casadi.identification.fit_unknowns import unknown_layout
from cosserat_casadi.identification.measured_cases import read_cases
from cosserat_casadi.identification.misfit import Misfit
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.scene import scene_from_dict
from tests.conftest import ROOT
from tests.derivatives import central_differences
from tests.identification.made_up import CASES, NAMES, SECTIONS, TRUTH, WIRE, MadeUp


def changed(**tables: Any) -> dict[str, Any]:
    return {**WIRE, **tables}


def built(**tables: Any) -> Model:
    return build(scene_from_dict(changed(**tables)).with_unknowns())


@pytest.fixture(scope="module")
def found(wire_model: Model, shapes: MadeUp) -> Identification:
    return identify(wire_model, shapes.data)


def residuals_by_solve(model: Model, shapes: MadeUp, values: FloatArray) -> FloatArray:
    """Differences in standard deviations, from one `solve` for each case."""
    columns = shapes.columns
    residuals = []
    inputs = np.stack([columns[name] for name in ("Fx", "Fy", "Fz", "Mx", "My", "Mz")], axis=1)
    measured = np.stack([columns[name] for name in "xyz"], axis=1)
    bound = model.at(dict(zip(NAMES, values, strict=True)))
    for first in range(0, len(inputs), len(SECTIONS)):
        load = inputs[first]
        solution = solve(bound, {"push.force": load[:3], "push.moment": load[3:]})
        rows = slice(first, first + len(SECTIONS))
        residuals.append((solution.pose(SECTIONS).position - measured[rows]) / 2e-4)
    return np.concatenate(residuals).ravel()


def test_unknowns_are_recovered_to_the_noise(found: Identification) -> None:
    assert found.converged, found.message
    truth = np.array([TRUTH[name] for name in found.labels])
    deviations = (found.shared - truth) / found.sigma
    assert np.abs(deviations).max() < 3.0
    rms = found.rms()
    assert rms is not None
    assert 0.9 < rms < 1.1
    assert found.statistics.unseen == ()
    assert not found.unstable


@pytest.fixture(scope="module")
def by_differences(wire_model: Model, shapes: MadeUp, found: Identification) -> FloatArray:
    """Derivatives of the residuals with the unknowns, from `solve` on both sides."""
    steps = [3e6, 3e6, 1e-4, 1e-4]
    return central_differences(lambda shared: residuals_by_solve(wire_model, shapes, shared), found.shared, steps)


@pytest.mark.slow
def test_the_optimum_is_that_of_scipy(wire_model: Model, shapes: MadeUp, found: Identification) -> None:
    scale = np.array([1e9, 1e9, 1.0, 1.0])

    def residual(scaled: FloatArray) -> FloatArray:
        return residuals_by_solve(wire_model, shapes, scaled * scale)

    by_scipy = scipy.optimize.least_squares(residual, found.shared / scale * 1.001, xtol=1e-12, max_nfev=6)
    # Its differences leave an error of the gradient.
    deviations = (by_scipy.x * scale - found.shared) / found.sigma
    assert_allclose(deviations, 0.0, rtol=0, atol=2e-3)
    assert_allclose(by_scipy.cost, found.cost, rtol=1e-7, atol=0)


def test_the_misfit_has_no_slope_at_the_optimum(
    wire_model: Model, shapes: MadeUp, found: Identification, by_differences: FloatArray
) -> None:
    residual = residuals_by_solve(wire_model, shapes, found.shared)
    assert_allclose(residual @ residual / 2, found.cost, rtol=1e-9, atol=0)
    slope = by_differences.T @ residual
    # In standard deviations: what a Newton step would change.
    steps = found.statistics.covariance @ slope
    assert_allclose(steps / found.sigma, 0.0, rtol=0, atol=1e-4)


def test_the_jacobian_is_that_of_differences(
    wire_model: Model, shapes: MadeUp, found: Identification, by_differences: FloatArray
) -> None:
    layout = unknown_layout(wire_model)
    cases = read_cases(wire_model.scene, wire_model.inputs, shapes.data)
    equilibria = Equilibria(wire_model, len(cases))
    inputs = np.array([case.inputs for case in cases])
    point, _ = equilibria.loaded(inputs, layout.parameters(found.shared))
    misfit = Misfit(wire_model, layout, cases, equilibria)
    state = misfit.first(point, found.shared, np.zeros((len(cases), 0)))
    jacobian = misfit.jacobian(state)
    for exact, differences in zip(jacobian.T, by_differences.T, strict=True):
        assert_allclose(exact, differences, rtol=0, atol=1e-6 * np.abs(differences).max())


def test_covariance_is_the_inverse_information(found: Identification, by_differences: FloatArray) -> None:
    scale = np.linalg.norm(by_differences, axis=0)
    scaled = by_differences / scale
    expected = np.linalg.inv(scaled.T @ scaled) / np.outer(scale, scale)
    sizes = np.outer(found.sigma, found.sigma)
    assert_allclose(found.statistics.covariance / sizes, expected / sizes, rtol=0, atol=1e-4)


def test_radius_and_modulus_are_seen_only_together(shapes: MadeUp) -> None:
    """Of a wire whose shear modulus goes with E, positions see E r⁴ alone: changes that keep it are not seen."""
    rod = {**WIRE["rods"][0], "material": {"youngs_modulus": 60e9, "poisson_ratio": 0.3}}
    unknowns = [
        {"parameter": "wire.material.youngs_modulus", "lower": 1e9, "upper": 1e12},
        {"parameter": "wire.section.radius", "lower": 1e-4, "upper": 1e-2},
    ]
    model = built(rods=[rod], unknowns=unknowns)
    found = identify(model, shapes.data)
    assert not found.converged
    assert found.outcome == "not_determined"
    (direction,) = found.statistics.unseen
    assert direction.deviation is None
    # Relative to their sizes: a step of −4 of E for one of the radius.
    parts = np.array([direction.parts[unknown["parameter"]] for unknown in unknowns])  # type: ignore[index]
    assert_allclose(parts / parts[1], [-4.0, 1.0], rtol=1e-6, atol=0)
    assert not np.any(found.statistics.determined)
    assert np.all(np.isnan(found.sigma))
    assert "do not determine" in found.message


def test_a_prior_settles_what_the_data_leave_open(shapes: MadeUp) -> None:
    rod = {**WIRE["rods"][0], "material": {"youngs_modulus": 60e9, "poisson_ratio": 0.3}}
    unknowns = [
        {"parameter": "wire.material.youngs_modulus", "lower": 1e9, "upper": 1e12},
        {"parameter": "wire.section.radius", "prior": {"mean": 5e-4, "sigma": 5e-6}},
    ]
    found = identify(built(rods=[rod], unknowns=unknowns), shapes.data)
    assert found.converged
    assert_allclose(found.sigma[1], 5e-6, rtol=1e-6, atol=0)
    # E carries four times the relative deviation of the radius.
    assert_allclose(found.sigma[0] / found.shared[0], 4e-2, rtol=1e-2, atol=0)
    assert len(found.statistics.unseen) == 1
    assert any("only the priors do" in warning for warning in found.warnings)


def test_a_parameter_that_no_datum_sees_is_named(shapes: MadeUp) -> None:
    rod = {**WIRE["rods"][0]}
    rod["material"] = {**rod["material"], "density": 6450.0}
    unknowns = [*WIRE["unknowns"], {"parameter": "wire.material.density", "lower": 1e3, "upper": 1e4}]
    found = identify(built(rods=[rod], unknowns=unknowns), shapes.data)
    assert not found.converged
    (direction,) = found.statistics.unseen
    assert direction.parts == {"wire.material.density": 1.0}
    assert found.statistics.determined.tolist() == [True] * 4 + [False]


def test_what_a_bound_holds_has_no_interval(shapes: MadeUp) -> None:
    unknowns = [{**WIRE["unknowns"][0], "upper": 50e9}, *WIRE["unknowns"][1:]]
    found = identify(built(unknowns=unknowns), shapes.data)
    assert found.at_bounds == (NAMES[0],)
    assert np.isnan(found.sigma).tolist() == [True, False, False, False]
    assert found.statistics.determined.tolist() == [False, True, True, True]


def test_bounds_leave_room_for_what_is_positive() -> None:
    unknowns = [{"parameter": NAMES[0], "lower": -5.0, "upper": -1.0}]
    with pytest.raises(SceneError, match="upper must be > 0"):
        unknown_layout(built(unknowns=unknowns))


def test_a_turn_that_is_unseen_at_the_start_is_found(shapes: MadeUp) -> None:
    # A straight round wire can turn about its axis: until its curvature is found no datum sees that.
    found = identify(built(unknowns=[*WIRE["unknowns"], {"input": "wire.base.quaternion"}]), shapes.data)
    assert found.converged, found.message
    assert np.abs(found.shared[4:] / found.sigma[4:]).max() < 3.0


def test_a_prior_keeps_its_deviation_where_noise_follows_from_residuals(shapes: MadeUp) -> None:
    rod = {**WIRE["rods"][0], "material": {"youngs_modulus": 60e9, "poisson_ratio": 0.3}}
    unknowns = [
        {"parameter": "wire.material.youngs_modulus", "lower": 1e9, "upper": 1e12},
        {"parameter": "wire.section.radius", "prior": {"mean": 5e-4, "sigma": 5e-6}},
    ]
    # No curvature is sought, so that residuals are far above what sigma states.
    found = identify(built(rods=[rod], unknowns=unknowns, identification={"noise": "residual"}), shapes.data)
    assert found.statistics.noise > 3.0
    assert_allclose(found.sigma[1], 5e-6, rtol=1e-4, atol=0)


def test_held_out_cases_are_predicted(wire_model: Model, shapes: MadeUp) -> None:
    found = identify(wire_model, shapes.data, hold_out=0.2)
    assert len(found.cases) == 8
    rms = found.rms(held_out=True)
    assert rms is not None
    assert 0.8 < rms < 1.2


@pytest.mark.slow
def test_outliers_weigh_less_under_a_robust_loss(shapes: MadeUp) -> None:
    spoilt = {name: values.copy() for name, values in shapes.columns.items()}
    spoilt["y"][[3, 37, 81]] += 0.02
    truth = np.array([TRUTH[name] for name in NAMES])
    errors = {}
    for loss in ("squares", "cauchy"):
        found = identify(built(identification={"loss": loss}), {"shapes.csv": spoilt})
        assert found.converged
        errors[loss] = np.abs(found.shared - truth) / found.sigma
    assert errors["cauchy"].max() < 3.0 < errors["squares"].max()
    assert {row.where for row in found.outliers} == {f"shapes.csv, line {row + 1}" for row in (3, 37, 81)}


def test_noise_can_follow_from_the_residuals(wire_model: Model, shapes: MadeUp, found: Identification) -> None:
    measurement = {**WIRE["measurements"][0], "sigma": 1e-2}
    scaled = identify(
        built(measurements=[measurement], identification={"noise": "residual"}),
        shapes.data,
    )
    rms = found.rms()
    assert rms is not None
    data = 3 * len(SECTIONS) * CASES
    freedom = data - len(NAMES)
    assert_allclose(scaled.sigma, found.sigma * rms * np.sqrt(data / freedom), rtol=1e-5, atol=0)


@pytest.fixture(scope="module")
def pushed() -> Model:
    """The force at the tip of each case is unknown, and so is E."""
    measurement = {**WIRE["measurements"][0], "case": "case"}
    measurement["inputs"] = {f"push.moment.{axis}": f"M{axis}" for axis in "xyz"}
    wrench = {
        "quantity": "base_wrench",
        "file": "forces.csv",
        "case": "case",
        "rod": "wire",
        "columns": ["Fx", "Fy", "Fz", "", "", ""],
        "sigma": 1e-3,
    }
    unknowns = [WIRE["unknowns"][0], {"input": "push.force", "per_row": True}]
    rod = {**WIRE["rods"][0], "material": {"youngs_modulus": 60e9, "shear_modulus": 20e9}}
    rod["intrinsic"] = {"curvature": [[1.0, -2.0], 0.0, 0.0]}
    return built(rods=[rod], measurements=[measurement, wrench], unknowns=unknowns)


def test_unknowns_of_each_case_are_found_with_those_of_all(pushed: Model, shapes: MadeUp) -> None:
    """Shapes alone see forces over E; a force cell at the base settles E."""
    columns = {**shapes.columns, "case": np.repeat(np.arange(CASES), len(SECTIONS))}
    loads = np.stack([shapes.columns[name][:: len(SECTIONS)] for name in ("Fx", "Fy", "Fz")], axis=1)
    rng = np.random.default_rng(3)
    cell = -loads + 1e-3 * rng.standard_normal(loads.shape)
    forces = {"case": np.arange(CASES), **dict(zip(("Fx", "Fy", "Fz"), cell.T, strict=True))}
    found = identify(pushed, {"shapes.csv": columns, "forces.csv": forces})
    assert found.converged, found.message
    assert abs(found.shared[0] - 52e9) < 3 * found.sigma[0]
    deviations = (found.own - loads) / found.statistics.own
    assert 0.7 < np.sqrt(np.mean(deviations**2)) < 1.3


@pytest.mark.slow
def test_single_cases_can_be_eliminated_or_not(pushed: Model, shapes: MadeUp) -> None:
    """The same least squares with all unknowns stacked, by scipy."""
    few = 2
    kept = slice(0, few * len(SECTIONS))
    columns = {name: values[kept] for name, values in shapes.columns.items()}
    columns["case"] = np.repeat(np.arange(few), len(SECTIONS))
    loads = np.stack([columns[name][:: len(SECTIONS)] for name in ("Fx", "Fy", "Fz")], axis=1)
    forces = {"case": np.arange(few), **dict(zip(("Fx", "Fy", "Fz"), -loads.T, strict=True))}
    data = {"shapes.csv": columns, "forces.csv": forces}
    found = identify(pushed, data)
    cases = read_cases(pushed.scene, pushed.inputs, data)
    layout = unknown_layout(pushed)
    equilibria = Equilibria(pushed, few)
    misfit = Misfit(pushed, layout, cases, equilibria)

    def residual(stacked: FloatArray) -> FloatArray:
        shared = stacked[:1] * 1e9
        own = stacked[1:].reshape(few, 3)
        inputs = layout.inputs(shared, own, misfit.measured_inputs)
        point, _ = equilibria.loaded(inputs, layout.parameters(shared))
        return misfit.first(point, shared, own).residual

    start = np.concatenate([found.shared / 1e9, found.own.ravel()])
    by_scipy = scipy.optimize.least_squares(residual, start * 1.01, xtol=1e-13, ftol=1e-13, x_scale="jac")
    assert_allclose(by_scipy.x, start, rtol=1e-5, atol=1e-7)
    covariance = np.linalg.inv(by_scipy.jac.T @ by_scipy.jac)
    expected = np.sqrt(np.diagonal(covariance))
    assert_allclose(found.sigma / 1e9, expected[:1], rtol=1e-4, atol=0)
    assert_allclose(found.statistics.own.ravel(), expected[1:], rtol=1e-4, atol=0)


@pytest.mark.slow
def test_starts_between_the_bounds_end_at_one_optimum(wire_model: Model, shapes: MadeUp, found: Identification) -> None:
    again = identify(wire_model, shapes.data, starts=3)
    assert again.starts == (3, 3)
    assert_allclose(again.shared, found.shared, rtol=1e-6, atol=0)


def test_what_was_found_goes_into_the_scene(wire_model: Model, found: Identification) -> None:
    original = scene_from_dict(WIRE)
    fitted = found.fitted_scene(original)
    assert fitted.rods[0].material is not None
    assert_allclose(fitted.rods[0].material.youngs_modulus, found.shared[0], rtol=1e-15, atol=0)
    assert_allclose(fitted.rods[0].intrinsic.curvature[0], found.shared[2:], rtol=1e-15, atol=0)
    assert fitted.inputs == original.inputs
    assert fitted.parameters == ()
    assert set(found.parameters) == set(NAMES)
    assert found.value(NAMES[0]) == found.shared[0]


@pytest.mark.slow
def test_the_discretisation_serves_what_was_found() -> None:
    # So stiff a wire hardly bends: the modes that it needs would bias what is found by several deviations.
    stiff = [f"rods.wire.material.{key}={value}" for key, value in (("youngs_modulus", 2e13), ("shear_modulus", 1e13))]
    free = [f"unknowns.{i}.upper=1e14" for i in (0, 1)]
    scene = read_scene(ROOT / "examples" / "wire_from_shapes.toml", (*stiff, *free))
    found = identify(scene)
    assert found.converged, found.message
    truth = np.array([TRUTH[name] for name in NAMES])
    assert np.abs((found.shared - truth) / found.sigma).max() < 3.0


def test_fewer_data_than_unknowns_are_refused(wire_model: Model, shapes: MadeUp) -> None:
    one = {name: values[:1] for name, values in shapes.columns.items()}
    with pytest.raises(SceneError, match="4 unknowns in 1 case are too many for 3 numbers"):
        identify(wire_model, {"shapes.csv": one})


@pytest.mark.slow
def test_cases_without_equilibrium_are_left_out_or_stop_it(shapes: MadeUp) -> None:
    spoilt = {name: values.copy() for name, values in shapes.columns.items()}
    # A moment that rolls the wire up a hundred times.
    spoilt["Mx"][:10] = 10.0
    left_out = identify(built(), {"shapes.csv": spoilt})
    assert left_out.converged
    assert len(left_out.cases) == CASES - 1
    assert [case.where for case in left_out.left_out] == ["shapes.csv, line 1"]
    stopped = identify(built(identification={"failures": "stop"}), {"shapes.csv": spoilt})
    assert not stopped.converged
    assert stopped.outcome == "no_equilibrium"
    assert "shapes.csv, line 1" in stopped.message


def test_columns_in_millimetres_are_told() -> None:
    model = built()
    data = {name: np.array([0.01, 0.02, 0.0]) for name in ("Fx", "Fy", "Fz", "Mx", "My", "Mz")}
    data |= {"X": np.ones(3), "x": np.array([1.0, 2, 3]), "y": np.array([1.0, 2, 3]), "z": np.full(3, 199.0)}
    found = identify(
        model, {"shapes.csv": {name: values * 0.01 if len(name) == 2 else values for name, values in data.items()}}
    )
    assert any("mm" in warning for warning in found.warnings)
