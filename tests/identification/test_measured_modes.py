"""Measured frequencies and damping ratios: values of closed forms and of `modes`, derivatives against differences."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, SceneError, build, identify, modes_of, solve
from cosserat_casadi.identification.case_equilibria import Equilibria
from cosserat_casadi.identification.fit_unknowns import unknown_layout
from cosserat_casadi.identification.measured_cases import read_cases
from cosserat_casadi.identification.misfit import Misfit
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.scene import scene_from_dict
from tests.derivatives import central_differences
from tests.families import mostly_slow
from tests.identification.test_measured_quantities import state_at

WIDTH = 4e-3
HEIGHT = 2e-3
DENSITY = 1100.0
MODULUS = 2e9
ROOT = 1.8751040687119611
"""Of 1 + cos β cosh β: the first frequency of a cantilever is β² √(EI / m) / (2π L²)."""

ROD: dict[str, Any] = {
    "name": "rod",
    "length": 0.2,
    "strain": "kirchhoff",
    "material": {"youngs_modulus": MODULUS, "poisson_ratio": 0.4, "density": DENSITY},
    "section": {"shape": "rectangle", "width": WIDTH, "height": HEIGHT},
    "damping": {"retardation_time": 2e-4},
}

SCENE: dict[str, Any] = {
    "schema": 1,
    "accuracy": {"modes": 4, "nodes": 10},
    "rods": [ROD],
    "loads": [{"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0.02, 0.0, 0.05]}],
    "measurements": [
        {"quantity": "frequency", "mode": "number", "columns": ["f"], "sigma": 0.05},
        {"quantity": "damping_ratio", "mode": "number", "columns": ["zeta"], "sigma": 1e-3},
    ],
    "unknowns": [
        {"parameter": "rod.material.youngs_modulus"},
        {"parameter": "rod.section.width"},
        {"parameter": "rod.damping.retardation_time"},
        {"parameter": "rod.intrinsic.curvature.x"},
        {"input": "push.force.x", "per_row": True},
    ],
}

STEPS = np.array([2e3, 4e-9, 2e-9, 2e-5])
"""Differences of the shared unknowns."""


def tables(**changes: Any) -> dict[str, Any]:
    scene = {**SCENE, **changes}
    measured = {"file": "modes.csv", "inputs": {"push.force.z": "Fz"}, "case": "case"}
    scene["measurements"] = [{**measured, **entry} for entry in scene["measurements"]]
    return scene


def held(**changes: Any) -> dict[str, Any]:
    """The rod with a tendon of given length and a tip that is pinned: constraints, multipliers and a tension."""
    cable = {"name": "wound", "kind": "tendon", "rod": "rod", "length": 0.199, "offset": [0.0, 2e-3]}
    support = {"rod": "rod", "kind": "pinned", "position": [0.01, 0.0, 0.19]}
    unknowns = [*SCENE["unknowns"][:-1], {"input": "wound.length", "per_row": True}]
    return tables(actuators=[cable], supports=[support], unknowns=unknowns, **changes)


def relaxing() -> dict[str, Any]:
    """The rod with stress that relaxes within a period of its third mode."""
    branch = {"share": 0.1, "time": 3e-3}
    sought = {"parameter": "rod.damping.prony.0.time"}
    unknowns = [sought if "retardation_time" in str(entry) else entry for entry in SCENE["unknowns"]]
    return tables(rods=[{**ROD, "damping": {"prony": [branch]}}], unknowns=unknowns)


def columns_of(model: Model) -> dict[str, FloatArray]:
    """Numbers that are near those of the scene: residuals are differences to them."""
    return {
        "case": np.array([1.0, 1.0, 1.0, 2.0]),
        "number": np.array([1.0, 2.0, 3.0, 2.0]),
        "Fz": np.array([0.05, 0.05, 0.05, -0.1]),
        "f": np.array([10.0, 20.0, 60.0, 20.0]),
        "zeta": np.array([0.01, 0.02, 0.05, 0.02]),
    }


def misfit_of(scene: dict[str, Any]) -> Misfit:
    model = build(scene_from_dict(scene).with_unknowns())
    cases = read_cases(model.scene, model.inputs, {"modes.csv": columns_of(model)})
    return Misfit(model, unknown_layout(model), cases, Equilibria(model, len(cases)))


def test_frequencies_are_those_of_modes() -> None:
    misfit = misfit_of(tables())
    shared, own = misfit.layout.start(2)
    state = state_at(misfit, shared, own)
    modes = modes_of(solve(misfit.model.at(), {"push.force": [0.02, 0.0, 0.05]}))
    swinging = [mode for mode in modes.modes if mode.oscillates][:3]
    frequencies, ratios = misfit.measurements.values()
    measured = columns_of(misfit.model)
    modelled = misfit.residual_of(frequencies, state)[:3] * 0.05 + measured["f"][:3]
    assert_allclose(modelled, [mode.frequency for mode in swinging], rtol=1e-9, atol=0)
    modelled = misfit.residual_of(ratios, state)[:3] * 1e-3 + measured["zeta"][:3]
    assert_allclose(modelled, [mode.damping_ratio for mode in swinging], rtol=1e-6, atol=0)


@pytest.mark.parametrize("scene", mostly_slow([tables(), held(), relaxing()], quick=[tables(), relaxing()]))
def test_derivatives_are_those_of_differences(scene: dict[str, Any]) -> None:
    misfit = misfit_of(scene)
    shared, own = misfit.layout.start(2)
    shared = shared + np.array([1e7, 1e-4, 1e-5, 0.3])
    own = own * np.array([[0.999], [0.998]])
    state = state_at(misfit, shared, own)
    assert np.all(np.isfinite(state.residual))
    by_shared, by_own = np.hsplit(misfit.jacobian(state), [len(shared)])
    differences = central_differences(lambda shared: state_at(misfit, shared, own).residual, shared, STEPS)
    for column, expected in zip(by_shared.T, differences.T, strict=True):
        assert_allclose(column, expected, rtol=0, atol=3e-5 * np.abs(expected).max())
    step = 1e-5 * own[0, 0]
    ahead = state_at(misfit, shared, own + step).residual
    behind = state_at(misfit, shared, own - step).residual
    expected = (ahead - behind) / (2 * step)
    assert np.abs(expected).max() > 1.0
    assert_allclose(by_own[:, 0], expected, rtol=0, atol=3e-5 * np.abs(expected).max())


def made_up(modulus: float, density: float, rng: np.random.Generator) -> dict[str, dict[str, FloatArray]]:
    """First three frequencies of the cantilever by Euler and Bernoulli, both directions of bending."""
    roots = np.array([ROOT, ROOT, 4.694091132974175])
    heights = np.array([HEIGHT, WIDTH, HEIGHT])
    rigidity = np.sqrt(modulus / density) * heights / np.sqrt(12.0)
    frequencies = roots**2 * rigidity / (2 * np.pi * 0.2**2)
    frequencies = np.sort(frequencies)
    rows = np.tile(frequencies, 8)
    columns = {"number": np.tile([1.0, 2.0, 3.0], 8), "f": rows + 0.02 * rng.standard_normal(len(rows))}
    return {"modes.csv": columns}


def cantilever(**changes: Any) -> dict[str, Any]:
    """A straight cantilever whose modulus is sought, without rotary inertia to speak of."""
    rod = {key: value for key, value in ROD.items() if key != "damping"}
    measured = {"quantity": "frequency", "file": "modes.csv", "mode": "number", "columns": ["f"], "sigma": 0.02}
    unknown = {"parameter": "rod.material.youngs_modulus", "lower": 1e8, "upper": 1e11}
    scene = {**SCENE, "rods": [rod], "loads": [], "measurements": [measured], "unknowns": [unknown]}
    return {**scene, **changes}


def test_a_modulus_is_found_from_frequencies() -> None:
    """Modes are chosen for the frequencies: the straight rod itself asks for one."""
    scene = scene_from_dict(cantilever(accuracy={"tolerance": 1e-4}))
    found = identify(scene, made_up(2.6e9, DENSITY, np.random.default_rng(1)))
    assert found.converged, found.message
    # Rotary inertia lowers frequencies by (h / L)² of their size.
    assert abs(found.shared[0] - 2.6e9) < 4 * found.sigma[0] + 2e-4 * 2.6e9
    assert found.sigma[0] < 2e-3 * 2.6e9
    rms = found.rms()
    assert rms is not None
    assert 0.6 < rms < 1.4
    assert max(found.model.discretisation["rod"].modes) >= 5


def test_density_and_modulus_are_seen_only_together() -> None:
    unknowns = [*cantilever()["unknowns"], {"parameter": "rod.material.density"}]
    model = build(scene_from_dict(cantilever(unknowns=unknowns)).with_unknowns())
    found = identify(model, made_up(2.6e9, DENSITY, np.random.default_rng(1)))
    assert found.outcome == "not_determined"
    (direction,) = found.statistics.unseen
    parts = list(direction.parts.values())
    assert_allclose(parts[0], parts[1], rtol=1e-6, atol=0)


@pytest.mark.slow
def test_modes_of_one_frequency_are_compared_with_their_mean() -> None:
    """A square section: an unknown width parts its two bendings, which is told; a modulus does not."""
    rod = {**cantilever()["rods"][0], "section": {"shape": "rectangle", "width": HEIGHT, "height": HEIGHT}}
    columns = {"number": np.array([1.0, 2.0, 1.0, 2.0]), "f": np.array([15.0, 15.2, 15.1, 15.1])}
    model = build(scene_from_dict(cantilever(rods=[rod])).with_unknowns())
    found = identify(model, {"modes.csv": columns})
    assert found.converged, found.message
    (told,) = [warning for warning in found.warnings if "one frequency" in warning]
    assert told.startswith("Modes 1 and 2 have one frequency in modes.csv, line 1: ")
    assert "part" not in told
    modelled = [row.modelled for row in found.rows]
    assert_allclose(modelled, 15.1, rtol=1e-6, atol=0)
    unknowns = [*cantilever()["unknowns"], {"parameter": "rod.section.width"}]
    model = build(scene_from_dict(cantilever(rods=[rod], unknowns=unknowns)).with_unknowns())
    columns = {"number": np.array([1.0, 2.0]), "f": np.array([15.0, 15.2])}
    cases = read_cases(model.scene, model.inputs, {"modes.csv": columns})
    misfit = Misfit(model, unknown_layout(model), cases, Equilibria(model, len(cases)))
    state = state_at(misfit, *misfit.layout.start(len(cases)))
    misfit.jacobian(state)
    (joint,) = misfit.joint_modes(state)
    assert joint.parted.tolist() == [False, True]
    # The mean moves with both unknowns, and where the width has left the square they part.
    found = identify(model, {"modes.csv": columns})
    assert found.converged, found.message
    assert_allclose([row.modelled for row in found.rows], [15.0, 15.2], rtol=1e-6, atol=0)


def test_a_mode_that_does_not_swing_leaves_its_case_out() -> None:
    rod = {**ROD, "damping": {"retardation_time": 1.0}}
    model = build(scene_from_dict(cantilever(rods=[rod])).with_unknowns())
    found = identify(model, made_up(2e9, DENSITY, np.random.default_rng(1)))
    assert found.outcome == "no_equilibrium"
    assert "does not vibrate" in found.message


def test_what_has_no_mass_has_no_frequency() -> None:
    rod = {**ROD, "material": {"youngs_modulus": 2e9, "poisson_ratio": 0.4}}
    model = build(scene_from_dict(cantilever(rods=[rod])).with_unknowns())
    with pytest.raises(SceneError, match="has no mass, and a motion needs one"):
        identify(model, made_up(2e9, DENSITY, np.random.default_rng(1)))


def test_numbers_of_modes_are_whole() -> None:
    model = build(scene_from_dict(cantilever()).with_unknowns())
    columns = {"number": np.array([1.0, 0.5, 0.0]), "f": np.array([15.0, 15.0, 15.0])}
    with pytest.raises(SceneError, match="must be the number of a mode") as refusal:
        identify(model, {"modes.csv": columns})
    assert len(refusal.value.problems) == 2
