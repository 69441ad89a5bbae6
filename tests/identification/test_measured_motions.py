"""Paths over time: zero where they are those of the simulator, exact derivatives, recovery, and what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Identification, Model, SceneError, build, identify, parse_scene
from cosserat_casadi.identification.case_equilibria import Equilibria
from cosserat_casadi.identification.case_motions import StartInputs
from cosserat_casadi.identification.case_time_steps import STEP_ERROR
from cosserat_casadi.identification.fit_unknowns import unknown_layout
from cosserat_casadi.identification.measured_cases import read_cases
from cosserat_casadi.identification.misfit import Misfit, MisfitState
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.scene import scene_from_dict
from tests.derivatives import central_differences
from tests.identification.released import CANTILEVER, NAMES, NOISE, TIMES, TRUTH, path_of, with_noise


def built(**changes: Any) -> Model:
    return build(scene_from_dict({**CANTILEVER, **changes}).with_unknowns())


@pytest.fixture(scope="module")
def model() -> Model:
    return built()


@pytest.fixture(scope="module")
def path(model: Model) -> dict[str, FloatArray]:
    return path_of(model)


@pytest.fixture(scope="module")
def found(model: Model, path: dict[str, FloatArray]) -> Identification:
    return identify(model, with_noise(path, np.random.default_rng(5)))


def misfit_of(model: Model, data: dict[str, dict[str, FloatArray]], size: float) -> Misfit:
    cases = read_cases(model.scene, model.inputs, data)
    simulation = model.scene.simulation
    assert simulation is not None
    unloaded = np.array([case.moves and simulation.start == "unloaded" for case in cases])
    misfit = Misfit(model, unknown_layout(model), cases, Equilibria(model, len(cases), unloaded))
    misfit.motions.size = size
    return misfit


def state_at(misfit: Misfit, shared: FloatArray, own: FloatArray) -> MisfitState:
    """The state by the load path alone."""
    of_cases = misfit.layout.inputs(shared, own, misfit.measured_inputs)
    inputs = StartInputs(misfit.model).of(of_cases, misfit.moves)
    point, _ = misfit.equilibria.loaded(inputs, misfit.layout.parameters(shared))
    return misfit.first(point, shared, own)


def check_derivatives(misfit: Misfit, steps: list[float], own_step: float | None = None) -> None:
    """Exact derivatives against differences, column by column."""
    shared, own = misfit.layout.start(len(misfit.cases))
    by_shared, by_own = np.hsplit(misfit.jacobian(state_at(misfit, shared, own)), [len(shared)])
    differences = central_differences(lambda shared: state_at(misfit, shared, own).residual, shared, steps)
    for found, expected in zip(by_shared.T, differences.T, strict=True):
        assert np.any(expected)
        assert_allclose(found, expected, rtol=0, atol=1e-7 * np.abs(expected).max())
    if own_step is not None:
        ahead = state_at(misfit, shared, own + own_step).residual
        behind = state_at(misfit, shared, own - own_step).residual
        expected = (ahead - behind) / (2 * own_step)
        assert np.any(expected)
        assert_allclose(by_own[:, 0], expected, rtol=0, atol=1e-7 * np.abs(expected).max())


def test_the_path_is_that_of_the_simulator(model: Model, path: dict[str, FloatArray]) -> None:
    misfit = misfit_of(model, {"path.csv": path}, 0.005)
    state = state_at(misfit, np.array(list(TRUTH.values())), np.zeros((1, 0)))
    assert_allclose(state.residual * NOISE, 0.0, rtol=0, atol=5e-7)


def test_the_error_of_the_steps_is_of_fifth_order(model: Model, path: dict[str, FloatArray]) -> None:
    errors = []
    for size in (0.04, 0.02, 0.01):
        # Whole steps end at the measured times: between them a polynomial has an order of its own.
        whole = {name: values[::2] for name, values in path.items()}
        misfit = misfit_of(model, {"path.csv": whole}, size)
        state = state_at(misfit, np.array(list(TRUTH.values())), np.zeros((1, 0)))
        errors.append(np.abs(state.residual).max())
    rates = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert rates[-1] > 4.0


@pytest.mark.slow
def test_derivatives_of_a_release_are_those_of_differences(model: Model, path: dict[str, FloatArray]) -> None:
    """The start is an equilibrium that changes with the modulus; the force jumps within the motion."""
    check_derivatives(misfit_of(model, {"path.csv": path}, 0.02), [1e1, 1e-2, 1e-7])


@pytest.mark.parametrize("recover", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_shares_and_times_of_stress_that_relaxes_are_found(recover: bool) -> None:
    """Derivatives of the path, and numbers from the noisy path of a stiffness and a branch."""
    names = ("rod.material.youngs_modulus", "rod.damping.prony.0.share", "rod.damping.prony.0.time")
    rod = {**CANTILEVER["rods"][0], "damping": {"prony": [{"share": 0.1, "time": 0.02}]}}
    relaxing = built(rods=[rod], unknowns=[{"parameter": name} for name in names])
    truth = dict(zip(names, (1.1e6, 0.15, 0.04), strict=True))
    if not recover:
        anywhere = {"t": TIMES[:9], "x": np.full(9, 0.3), "z": np.zeros(9)}
        check_derivatives(misfit_of(relaxing, {"path.csv": anywhere}, 0.02), [1e1, 1e-6, 1e-6])
        return
    path = path_of(relaxing, truth)
    found = identify(relaxing, with_noise(path, np.random.default_rng(2)))
    assert found.converged, found.message
    assert np.abs((found.shared - list(truth.values())) / found.sigma).max() < 3.5
    assert np.all(found.sigma < 0.1 * np.array(list(truth.values())))


def test_derivatives_with_multipliers_are_those_of_differences() -> None:
    """A pinned tip, a base that is shaken, a wave on an input of each case; it starts unloaded."""
    measured = {**CANTILEVER["measurements"][0], "at": 0.5, "case": "run"}
    strained = {"quantity": "strain", "file": "path.csv", "time": "t", "case": "run", "rod": "rod", "at": 0.3}
    strained |= {"fibre": [3e-3, 0.0], "columns": ["e"], "sigma": 1e-4}
    waves = [
        {"input": "rod.base.position", "amplitude": [0.0, 0.0, 0.01], "frequency": 3.0, "wave": "one_minus_cosine"},
        {"input": "push.force", "amplitude": [0.0, 0.0, 0.02], "frequency": 5.0, "phase": 0.3},
    ]
    model = built(
        simulation={"duration": 0.5, "start": "unloaded"},
        supports=[{"rod": "rod", "kind": "pinned", "position": [0.3, 0.0, 0.0]}],
        rods=[{**CANTILEVER["rods"][0], "strain": ["bending_x", "bending_y", "torsion", "extension"]}],
        motions=waves,
        loads=[CANTILEVER["loads"][0], {**CANTILEVER["loads"][1], "kind": "point_wrench", "at": 0.5}],
        measurements=[measured, strained],
        unknowns=[*CANTILEVER["unknowns"], {"input": "push.force.z", "per_row": True}],
    )
    columns = {"t": np.array([0.0, 0.033, 0.05, 0.1]), "run": np.ones(4)}
    columns |= {"x": np.full(4, 0.15), "z": np.zeros(4), "e": np.zeros(4)}
    check_derivatives(misfit_of(model, {"path.csv": columns}, 0.01), [1e1, 1e-2, 1e-6], 1e-5)


def test_derivatives_with_a_cable_of_given_length_are_those_of_differences() -> None:
    cable = {"name": "wound", "kind": "tendon", "rod": "rod", "length": 0.296, "offset": [3e-3, 0.0]}
    unknowns = [{"parameter": "rod.material.density"}, {"parameter": "wound.offset.x"}]
    model = built(actuators=[cable], unknowns=unknowns)
    columns = {"t": np.array([0.0, 0.03]), "x": np.full(2, 0.3), "z": np.zeros(2)}
    check_derivatives(misfit_of(model, {"path.csv": columns}, 0.01), [1e-1, 2e-7])


@pytest.mark.slow
def test_modulus_density_and_damping_are_recovered_to_the_noise(found: Identification) -> None:
    assert found.converged, found.message
    truth = np.array([TRUTH[name] for name in found.labels])
    assert np.abs((found.shared - truth) / found.sigma).max() < 3.5
    assert np.all(found.sigma < 0.05 * truth)
    rms = found.rms()
    assert rms is not None
    assert 0.8 < rms < 1.2
    assert found.step_error is not None
    assert found.step_error <= STEP_ERROR


def test_the_fitted_scene_moves_as_was_measured(found: Identification, path: dict[str, FloatArray]) -> None:
    model = build(found.fitted_scene(scene_from_dict(CANTILEVER)).with_unknowns())
    misfit = misfit_of(model, {"path.csv": path}, 0.01)
    state = state_at(misfit, *misfit.layout.start(1))
    assert np.abs(state.residual).max() < 1.5


@pytest.mark.slow
def test_equilibria_and_motions_are_fitted_together(model: Model, path: dict[str, FloatArray]) -> None:
    """Without a force that is known only the share of modulus and density is seen; a hung weight parts them."""
    hung = {"quantity": "position", "file": "hung.csv", "rod": "rod", "columns": ["x", "", "z"], "sigma": NOISE}
    hung["inputs"] = {"push.moment.y": "M"}
    unloaded = built(simulation={"duration": 0.5, "start": "unloaded"}, motions=[])
    moved = path_of(unloaded)
    both = built(
        simulation={"duration": 0.5, "start": "unloaded"},
        motions=[],
        measurements=[*CANTILEVER["measurements"], hung],
    )
    # The scene's own equilibria, at the truth.
    truth = np.array(list(TRUTH.values()))
    moments = np.array([0.0, -1e-3, 1e-3])
    layout = unknown_layout(both)
    inputs = np.array([both.pack({"push.moment": [0.0, moment, 0.0]}) for moment in moments])
    p = layout.parameters(truth)
    point, _ = Equilibria(both, 3).loaded(inputs, p)
    tips = np.array([both.tip["rod"](x, u, p)[0].full()[:, 0] for x, u in zip(point.x, inputs, strict=True)])
    rng = np.random.default_rng(2)
    x, _, z = (tips + NOISE * rng.standard_normal(tips.shape)).T
    data = {**with_noise(moved, rng), "hung.csv": {"M": moments, "x": x, "z": z}}
    found = identify(both, data)
    assert found.converged, found.message
    assert len(found.cases) == 4
    assert np.abs((found.shared - truth) / found.sigma).max() < 3.5


@pytest.mark.slow
def test_steps_that_are_given_are_kept_and_their_error_is_told(model: Model, path: dict[str, FloatArray]) -> None:
    coarse = built(simulation={"duration": 0.5, "step": 0.04})
    found = identify(coarse, {"path.csv": path})
    assert found.step == 0.04
    assert found.step_error is not None
    assert found.step_error > STEP_ERROR
    assert any("give [simulation] a shorter step" in warning for warning in found.warnings)
    # The equilibrium that a motion starts from says nothing of the motion.
    assert found.error_estimate is None
    assert found.within_tolerance is None


def test_times_beyond_the_simulation_are_refused(model: Model) -> None:
    columns = {"t": np.array([0.1, -0.1, 0.6]), "x": np.zeros(3), "z": np.zeros(3)}
    with pytest.raises(SceneError, match="must be from 0 to the duration") as refusal:
        identify(model, {"path.csv": columns})
    assert len(refusal.value.problems) == 2


@pytest.mark.slow
def test_a_motion_that_cannot_be_computed_makes_no_steps_of_others_shorter() -> None:
    measured = {**CANTILEVER["measurements"][0], "inputs": {"push.force.z": "Fz"}}
    simulation = {"duration": 0.05, "start": "unloaded"}
    model = built(simulation=simulation, motions=[], measurements=[measured], unknowns=CANTILEVER["unknowns"][1:2])
    columns = {"t": np.array([0.02, 0.05]), "x": np.full(2, 0.299), "z": np.array([0.0, 0.01]), "Fz": np.full(2, 0.2)}
    alone = identify(model, {"path.csv": columns})
    more = {"t": [0.01], "x": [0.3], "z": [0.0], "Fz": [1e7]}
    both = identify(model, {"path.csv": {name: np.append(columns[name], more[name]) for name in columns}})
    assert [left_out.reason for left_out in both.left_out] == ["The steps of its motion could not be solved there."]
    assert both.step == alone.step
    assert_allclose(both.shared, alone.shared, rtol=1e-9, atol=0)


def test_times_that_rounding_puts_beyond_the_simulation_are_its_ends(model: Model) -> None:
    columns = {"t": np.array([-1e-17, 0.1, np.nextafter(0.5, 1.0)]), "x": np.zeros(3), "z": np.zeros(3)}
    (case,) = read_cases(model.scene, model.inputs, {"path.csv": columns})
    assert [datum.time for datum in case.data[0]] == [0.0, 0.1, 0.5]


def test_a_cell_is_told_once_and_every_cell_is(model: Model) -> None:
    columns = {"t": np.array(["0.1", "soon", ""]), "x": np.zeros(3), "z": np.zeros(3)}
    with pytest.raises(SceneError) as refusal:
        identify(model, {"path.csv": columns})
    assert [problem.where for problem in refusal.value.problems] == ["path.csv, line 2", "path.csv, line 3"]


def test_free_bases_are_refused(path: dict[str, FloatArray]) -> None:
    rod = {**CANTILEVER["rods"][0], "base": {"free": True}}
    with pytest.raises(SceneError, match="is not for measurements over time"):
        identify(built(rods=[rod]), {"path.csv": path})


def test_velocities_at_the_start_are_refused(path: dict[str, FloatArray]) -> None:
    with pytest.raises(SceneError, match="begins at rest"):
        identify(built(velocities=[{"rod": "rod", "curvature_rate": [0.0, 3.0, 0.0]}]), {"path.csv": path})


def test_cables_that_may_go_slack_are_refused(path: dict[str, FloatArray]) -> None:
    cable = {"name": "wound", "kind": "tendon", "rod": "rod", "length": 0.3, "slack": True}
    cable["offset"] = [3e-3, 0.0]
    with pytest.raises(SceneError, match="may go slack"):
        identify(built(actuators=[cable]), {"path.csv": path})


SCENE = """\
schema = 1
[[rods]]
name = "rod"
length = 0.3
strain = "planar"
material = { youngs_modulus = 1e6, poisson_ratio = 0.4, density = 1e3 }
section = { shape = "circle", radius = 5e-3 }
[[loads]]
name = "push"
kind = "tip_wrench"
rod = "rod"
force = [0, 0, 0.1]
[[motions]]
input = "push.force"
times = [0.0, 0.1]
values = [[0, 0, 0], [0, 0, 1]]
[[measurements]]
quantity = "position"
file = "path.csv"
time = "t"
rod = "rod"
columns = ["x", "", "z"]
sigma = 1e-3
"""

SIMULATED = "[simulation]\nduration = 1.0\n"

REFUSED = {
    "simulation": (SCENE, "measurements[0].time", "the scene has none"),
    "column": (
        SCENE + 'inputs = { "push.force.z" = "Fz" }\n' + SIMULATED,
        'measurements[0].inputs."push.force.z"',
        "motions[0] has the values",
    ),
    "unknown": (
        SCENE + '[[unknowns]]\ninput = "push.force"\n' + SIMULATED,
        "unknowns[0].input",
        "motions[0] has its values over time",
    ),
    "twice": (
        SCENE + SCENE[SCENE.index("[[measurements]]") :].replace('""', '"y"') + SIMULATED,
        "measurements[1].columns",
        "measurements[0] reads 'x' of these rows already",
    ),
    "wrench": (
        SCENE.replace('"position"', '"base_wrench"').replace('["x", "", "z"]', '["a", "", "", "", "", ""]') + SIMULATED,
        "measurements[0].time",
        "unknown",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_scene_that_contradicts_itself_is_refused(name: str) -> None:
    text, where, problem = REFUSED[name]
    with pytest.raises(SceneError) as refusal:
        parse_scene(text)
    told = [entry for entry in refusal.value.problems if entry.where == where]
    assert told
    assert problem in told[0].problem


def test_only_what_is_measured_over_time_makes_inputs_of_motions() -> None:
    scene = parse_scene(SCENE + SIMULATED)
    assert scene.with_unknowns().input_names() == ("push.force",)
    at_rest = parse_scene("inputs = []\n" + SCENE.replace('time = "t"\n', "") + SIMULATED)
    assert at_rest.with_unknowns().input_names() == ()
    moving = parse_scene("inputs = []\n" + SCENE + SIMULATED)
    assert moving.with_unknowns().input_names() == ("push.force",)


def test_rows_of_one_motion_are_one_case(model: Model, path: dict[str, FloatArray]) -> None:
    cases = read_cases(model.scene, model.inputs, {"path.csv": path})
    assert len(cases) == 1
    assert cases[0].moves
    assert [datum.time for datum in cases[0].data[0]] == TIMES.tolist()
    assert unknown_layout(model).shared_labels == NAMES
