"""Linear models of scenes: state form against descriptor form, modes, statics and scipy."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg
import scipy.signal
from numpy.testing import assert_allclose

from cosserat_casadi import SceneError, SolveError, build, discretise
from cosserat_casadi.motion.linear_model import linearise
from cosserat_casadi.motion.vibration_modes import modes_of
from cosserat_casadi.scene import scene_from_dict
from tests.equilibria import solve
from tests.families import mostly_slow
from tests.scenes import WEIGHT, push, rod, scene, three_cables

PLATE = {"name": "plate", "mass": 0.3, "centre_of_mass": [0.0, 0.02, 0.01], "inertia": [2e-3, 3e-3, 4e-3]}


def equilibrium(described, modes=5, values=None):
    solution = solve(build(described, discretise(described, modes)), values)
    assert solution.converged, solution.message
    return solution


def arch():
    """A rod clamped at both ends, whose base may move."""
    held = {"rod": "rod", "kind": "clamped", "position": [0.3, 0.0, 0.6], "quaternion": [1.0, 0.0, 0.0, 0.0]}
    inputs = ["push.force", "rod.base.position"]
    bent = push(kind="point_wrench", at=0.5, force=[0.1, 0.2, 0.0])
    return scene(bent, strain="reissner", supports=[held], inputs=inputs)


def carriers():
    """Two rods that carry a plate."""
    left = rod("reissner", name="left")
    right = rod("reissner", name="right", base={"position": [0.3, 0.0, 0.0]})
    joints = [
        {"body": "plate", "rod": "left", "kind": "fixed"},
        {"body": "plate", "rod": "right", "kind": "spherical", "position": [0.3, 0.0, 0.0]},
    ]
    tables = {
        "schema": 1,
        "rods": [left, right],
        "bodies": [PLATE],
        "joints": joints,
        "loads": [WEIGHT, push(rod="left")],
    }
    return scene_from_dict(tables)


def stub():
    """A rod on one without mass, with damping of its own: what relaxes and what swings meet in the damping."""
    root = rod(name="root", damping={"retardation_time": 0.5})
    del root["linear_density"]
    branch = rod(damping={"retardation_time": 0.01}, base={"rod": "root"}, rotary_inertia=[1e-3, 1e-3, 2e-3])
    return scene(push(force=[0.2, 0.1, 0.0]), rods=[root, branch])


SCENES = {
    "stub": stub,
    "cantilever": lambda: scene(push(), WEIGHT),
    "follower": lambda: scene(push(frame="body")),
    # Torsion without rotary inertia is a coordinate without mass about a straight rod; damping makes it relax.
    "relaxing": lambda: scene(push(force=[0.0, 0.0, 0.0]), rods=[rod(damping={"retardation_time": 0.02})]),
    "massless": lambda: scene(push(force=[0.0, 0.0, 0.0])),
    "free": lambda: scene(
        push(force=[0.0, 0.0, 0.0]), rods=[rod(base={"free": True}, rotary_inertia=[1e-3, 1e-3, 2e-3])]
    ),
    "base": lambda: scene(push(), inputs=["push.force", "rod.base.position", "rod.base.quaternion"]),
    "length": lambda: scene(push(), WEIGHT, inputs=["rod.length", "weight.acceleration"]),
    "arch": arch,
    "cables": three_cables,
    "carriers": carriers,
}


QUICK = ["stub", "relaxing", "massless", "free", "base", "length", "arch", "cables"]
"""Each kind of input, of mass and of constraint once."""


@pytest.fixture(scope="module", params=mostly_slow(SCENES, quick=QUICK))
def solution(request):
    return equilibrium(SCENES[request.param]())


def response(model, s, E=None):
    """Transfer function at s from the inputs proper, their rates being s and their accelerations s² times them."""
    if E is None:
        E = np.eye(len(model.A))
    whole = model.C @ np.linalg.solve(s * E - model.A, model.B) + model.D
    columns = {}
    for column, name in enumerate(model.inputs):
        base, power = name, 0
        if name.endswith(".rate"):
            base, power = name.removesuffix(".rate"), 1
        elif name.endswith(".acceleration") and name.removesuffix(".acceleration") in model.inputs:
            base, power = name.removesuffix(".acceleration"), 2
        columns[base] = columns.get(base, 0.0) + s**power * whole[:, column]
    return np.stack(list(columns.values()), axis=1)


def test_state_form_vs_descriptor_form(solution):
    model = linearise(solution)
    for s in (0.3 + 2.0j, 5.0 + 30.0j, -1.0 + 0.2j):
        descriptor = response(model.descriptor, s, model.descriptor.E)
        largest = np.abs(descriptor).max()
        assert_allclose(response(model, s), descriptor, rtol=0, atol=2e-9 * largest)


def test_eigenvalues_vs_modes(solution):
    eigenvalues = linearise(solution).eigenvalues
    modes = modes_of(solution)
    wanted = [mode.eigenvalue for mode in modes.modes if mode.eigenvalue != 0.0]
    for value in wanted[:6]:
        nearest = np.abs(eigenvalues - value).min()
        assert nearest < 1e-7 * abs(value)
    zeros = sum(mode.eigenvalue == 0.0 for mode in modes.modes)
    # A rigid motion is a double eigenvalue, which rounding splits by the root of its size.
    assert np.sum(np.abs(eigenvalues) < 1e-4 * abs(wanted[0])) == 2 * zeros


def test_static_gain_vs_statics(solution):
    model = solution.model
    linear = linearise(solution)
    if any(mode.eigenvalue == 0.0 for mode in modes_of(solution).modes):
        pytest.skip("a free rod has no static gain")
    jacobian = model.jacobian(solution.x, solution.inputs)[0].full()
    by_inputs = model.input_jacobian(solution.x, solution.inputs).full()
    moved = np.linalg.lstsq(jacobian, -by_inputs, rcond=1e-12)[0]
    expected = []
    for name in model.discrete.rods:
        X = 0.5 if solution.model.scene.supports else 1.0
        derivative = model.shape[name].jacobian()(solution.x, solution.inputs, X, 0, 0)
        expected.append(derivative[0].full() @ moved + derivative[1].full())
    expected = np.vstack(expected)
    gain = linear.D - linear.C @ np.linalg.solve(linear.A, linear.B)
    count = model.inputs.size
    assert_allclose(gain[:, :count], expected, rtol=0, atol=1e-9 * np.abs(expected).max())


def test_reduced_models_keep_eigenvalues_and_static_gain(solution):
    whole = linearise(solution)
    reduced = whole.reduced(min(8, whole.modes))
    assert len(reduced.A) == 2 * min(8, whole.modes)
    assert reduced.states[:2] == ("mode 1", "mode 2")
    assert reduced.states[-1] == f"mode {reduced.modes}.rate"
    conservative = solution.model.has_potential(solution.inputs)
    if conservative and not np.any(modes_of(solution).eigenvalues.real):
        kept = np.sort(np.abs(reduced.eigenvalues))
        expected = np.sort(np.abs(whole.eigenvalues))[: len(kept)]
        scale = expected[-1]
        assert_allclose(kept, expected, rtol=1e-7, atol=1e-5 * scale)
    if np.linalg.cond(whole.A) < 1e12:
        gain = whole.D - whole.C @ np.linalg.solve(whole.A, whole.B)
        reduced_gain = reduced.D - reduced.C @ np.linalg.solve(reduced.A, reduced.B)
        assert_allclose(reduced_gain, gain, rtol=0, atol=1e-8 * np.abs(gain).max())


def test_scipy_takes_it_and_a_step_ends_at_the_static_gain():
    solution = equilibrium(scene(push(), rods=[rod(damping={"retardation_time": 0.3})]))
    model = linearise(solution).reduced(6)
    system = scipy.signal.StateSpace(model.A, model.B[:, :1], model.C[:1], model.D[:1, :1])
    times, outputs = scipy.signal.step(system, T=np.linspace(0.0, 40.0, 400))
    gain = model.D - model.C @ np.linalg.solve(model.A, model.B)
    assert times[-1] == 40.0
    assert_allclose(outputs[-1], gain[0, 0], rtol=1e-6, atol=0)
    # Through the coefficients of a polynomial, which spread poles that lie close together.
    assert_allclose(np.sort_complex(system.poles), np.sort_complex(model.eigenvalues), rtol=1e-3, atol=0)


def test_names():
    model = linearise(equilibrium(SCENES["base"](), modes=2))
    assert model.inputs[:3] == ("push.force.x", "push.force.y", "push.force.z")
    assert "rod.base.position.x.acceleration" in model.inputs
    assert "push.force.x.rate" not in model.inputs
    assert model.outputs == ("rod.tip.position.x", "rod.tip.position.y", "rod.tip.position.z")
    assert model.descriptor.states[:2] == ("rod.strain[0]", "rod.strain[1]")
    assert len(model.states) == len(model.A) == 2 * model.modes


def test_chosen_outputs():
    solution = equilibrium(SCENES["cables"]())
    model = linearise(solution, ["cable_1.length", "rod.tip.position"])
    assert model.outputs[0] == "cable_1.length"
    # A cable has the length that it is given.
    gain = model.D - model.C @ np.linalg.solve(model.A, model.B)
    assert_allclose(gain[0, :3], [0.0, 1.0, 0.0], rtol=0, atol=1e-9)
    middle = linearise(solution, [("rod", 0.25)])
    assert middle.outputs[0] == "rod.position(0.25).x"
    carried = linearise(equilibrium(carriers()), ["plate.position"])
    assert carried.outputs == ("plate.position.x", "plate.position.y", "plate.position.z")


def test_a_base_that_moves_takes_the_rod_with_it():
    solution = equilibrium(SCENES["base"]())
    model = linearise(solution)
    gain = model.D - model.C @ np.linalg.solve(model.A, model.B)
    columns = [model.inputs.index(f"rod.base.position.{axis}") for axis in "xyz"]
    assert_allclose(gain[:, columns], np.eye(3), rtol=0, atol=1e-10)


def test_unknown_outputs_are_refused_at_once():
    solution = equilibrium(scene(push()), modes=2)
    with pytest.raises(SceneError, match=r"'a'(.|\n)*'b'(.|\n)*1\.5"):
        linearise(solution, ["a", ("b", 0.5), ("rod", 1.5)])


def test_an_input_that_constraints_leave_no_room_for_is_refused():
    held = {"rod": "rod", "kind": "clamped", "position": [0.0, 0.0, 0.8], "quaternion": [1.0, 0.0, 0.0, 0.0]}
    straight = scene(
        push(at=0.5, kind="point_wrench", force=[0.0, 0.0, 0.0]), supports=[held], inputs=["rod.base.position"]
    )
    with pytest.raises(SceneError, match=r"constraints do not let rod\.base\.position\.z change"):
        linearise(equilibrium(straight))


def test_what_is_no_equilibrium_is_refused():
    described = scene(push(force=[0.0, 0.0, 0.0]))
    failed = solve(build(described, discretise(described, 2)), {"push.force": [np.float64(1e9), 0.0, 0.0]})
    assert not failed.converged
    with pytest.raises(SolveError):
        linearise(failed)


def test_number_of_modes_is_checked():
    model = linearise(equilibrium(scene(push()), modes=2))
    for count in (0, model.modes + 1):
        with pytest.raises(ValueError, match="modes can be kept"):
            model.reduced(count)


def test_descriptor_eigenvalues_are_those_of_scipy():
    model = linearise(equilibrium(scene(push(), WEIGHT)))
    finite = scipy.linalg.eigvals(model.descriptor.A, model.descriptor.E)
    finite = finite[np.isfinite(finite)]
    for value in model.eigenvalues[:8]:
        assert np.abs(finite - value).min() < 1e-6 * abs(value)
