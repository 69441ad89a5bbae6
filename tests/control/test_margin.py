"""The margin to instability: closed form, the judgement of a solve, derivatives, multiple eigenvalues, refusals."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import eigh, null_space

from cosserat_casadi import Model, Scene, SceneError, build
from cosserat_casadi.control import lifted, stability_margin
from cosserat_casadi.control.soft_minimum import Spectrum
from cosserat_casadi.equilibrium.stability import admissible_eigenvalues, variations
from cosserat_casadi.model.unknowns import BlockKind
from tests.equilibria import solve
from tests.families import mostly_slow
from tests.scenes import push, scene

CRITICAL = np.pi**2 / 4
"""Euler's load of a clamped-free column, in EI/L²."""

SHARP = 1e-4
"""A width at which eigenvalues 1e-2 apart do not feel each other."""


def column(strain: str = "planar", **changes: Any) -> Scene:
    """A column of length 1 and unit bending stiffness under a tip force of half its critical load."""
    stiffness = {"planar": {"bending_y": 1.0}, "kirchhoff": {"bending_x": 1.0, "bending_y": 1.0, "torsion": 0.7}}
    one = {"name": "rod", "length": 1.0, "strain": strain, "stiffness": stiffness[strain]}
    fixed = {"inputs": ["push.force"], "accuracy": {"modes": 6}, "rods": [one], **changes}
    return scene(push(force=[0.0, 0.0, -CRITICAL / 2]), **fixed)


# The margin itself


@pytest.mark.parametrize("share", [0.0, 0.5, 0.9, 1.0, 1.3])
def test_column_vs_closed_form(share: float) -> None:
    """(EI ∫ κ² − P ∫ θ²)/EI ∫ κ² is least in the buckling mode, where it is 1 − P/P_c: Euler's load."""
    model = build(column())
    margin = stability_margin(model, SHARP)(model.unloaded(), [0, 0, -share * CRITICAL])
    # Without load all eigenvalues are one.
    expected = 1 - share if share else 1 - SHARP * np.log(model.size)
    assert_allclose(float(margin), expected, rtol=0, atol=1e-8)


@pytest.mark.parametrize("modes", [3, 5, 9])
def test_margin_does_not_hang_on_the_modes(modes: int) -> None:
    """The smallest eigenvalue in units of EI/ℓ does: 1/(2 n − 1) for n modes without load."""
    model = build(column(accuracy={"modes": modes}))
    solution = solve(model, {"push.force": [0, 0, -0.3 * CRITICAL]})
    margin = stability_margin(model, SHARP)(solution.x, solution.inputs)
    assert_allclose(float(margin), 0.7, rtol=0, atol=1e-4)
    assert solution.smallest_eigenvalue is not None
    assert solution.smallest_eigenvalue < 1 / (2 * modes - 1)


def test_margin_with_parameters_vs_closed_form() -> None:
    """In elastic stiffnesses of the scene's own column, one of EI times s under its thrust has the margin s − P/P_c."""
    model = build(column(parameters=["rod.stiffness.bending_y"]))
    margin = stability_margin(model, SHARP, parameters=True)
    p = ca.MX.sym("p")
    value = margin(model.unloaded(), [0, 0, -CRITICAL / 2], p)
    found, rate = ca.Function("rate", [p], [value, ca.gradient(value, p)])(1.3)
    assert_allclose(float(found), 0.8, rtol=0, atol=1e-8)
    assert_allclose(float(rate), 1.0, rtol=0, atol=1e-8)
    # By default the scene's own values are fixed.
    own = stability_margin(model, SHARP)(model.unloaded(), [0, 0, -CRITICAL / 2])
    assert_allclose(float(own), 0.5, rtol=0, atol=1e-8)


def test_rate_with_the_load_vs_closed_form() -> None:
    """In a round column the eigenvalue 1 − P/P_c is double: its margin still has the rate −1/P_c, and no kink."""
    model = build(column("kirchhoff"))
    margin, inputs = stability_margin(model, SHARP), ca.MX.sym("inputs", 3)
    value = margin(model.unloaded(), inputs)
    slope = ca.Function("slope", [inputs], [value, ca.gradient(value, inputs)])
    found, rate = slope([0, 0, -0.8 * CRITICAL])
    assert_allclose(float(found), 0.2 - SHARP * np.log(2), rtol=0, atol=1e-9)
    assert_allclose(rate.full()[:, 0], [0, 0, 1 / CRITICAL], rtol=0, atol=1e-9)


def tripod(kind: str) -> Model:
    """Three rods that are not alike carry a plate, so that units differ."""
    stiffness = {"bending_x": 1.0, "bending_y": 1.4, "torsion": 0.7}
    rods = [
        {
            "name": name,
            "length": length,
            "strain": "kirchhoff",
            "stiffness": {what: value * factor for what, value in stiffness.items()},
            "base": {"position": foot},
        }
        for name, length, factor, foot in (
            ("a", 0.60, 1.0, [0, 0, 0]),
            ("b", 0.63, 2.0, [0.3, 0, 0]),
            ("c", 0.58, 1.5, [0.1, 0.25, 0]),
        )
    ]
    arms = {"a": [-0.1, -0.08, 0], "b": [0.12, -0.05, 0], "c": [0, 0.1, 0.02]}
    return build(
        scene(
            {"name": "down", "kind": "body_wrench", "body": "plate", "force": [0.5, 0.3, -2.0]},
            rods=rods,
            bodies=[{"name": "plate"}],
            joints=[{"body": "plate", "rod": name, "kind": kind, "position": arm} for name, arm in arms.items()],
            inputs=["down.force", "a.length", "b.base.position"],
            accuracy={"modes": 2},
        )
    )


def held_rod() -> Model:
    return build(
        scene(
            push(),
            supports=[{"rod": "rod", "kind": "pinned", "position": [0.2, 0.1, 0.6]}],
            inputs=["push.force"],
            accuracy={"modes": 4},
        )
    )


def cable_held() -> Model:
    cable = {"name": "cable", "kind": "tendon", "rod": "rod", "length": 0.77, "slack": False, "offset": [0.05, 0.02]}
    return build(scene(push(), actuators=[cable], inputs=["push.force", "cable.length"], accuracy={"modes": 4}))


SLOW = pytest.mark.slow

MODELS = {
    "column": lambda: build(column("kirchhoff")),
    "held": held_rod,
    "cable": cable_held,
    "fixed": lambda: tripod("fixed"),
    "spherical": lambda: tripod("spherical"),
}


@pytest.mark.parametrize("name", mostly_slow(MODELS, quick=["column", "held", "cable"]))
def test_margin_vs_the_judgement_of_a_solve(name: str) -> None:
    """Against a generalised eigenproblem of SciPy; the signs are those of the eigenvalues that a solve judges."""
    model = MODELS[name]()
    solution = solve(model, raise_on_failure=True)
    jacobian, allowed = model.jacobian(solution.x, solution.inputs)[0].full(), variations(model)
    strains, size = (
        np.arange(model.discrete.unknowns.count(BlockKind.STRAIN)),
        model.discrete.unknowns.count(BlockKind.STRAIN),
    )
    whole = allowed.units[:, None] * jacobian[np.ix_(allowed.free, allowed.free)]
    start = model.path_jacobian(model.unloaded(), model.pack(), 0.0).full()[:size, :size]
    basis = null_space(jacobian[np.ix_(allowed.held, allowed.free)], rcond=1e-12)
    elastic = basis[strains].T @ (allowed.units[strains, None] * start) @ basis[strains]
    # Growing quaternions strain nothing: eigenvalues without end, which regularisation leaves at the far end.
    grown = elastic + 1e-9 * np.trace(elastic) * basis[size:].T @ basis[size:]
    expected = eigh((basis.T @ (whole + whole.T) @ basis) / 2, grown, eigvals_only=True)
    margin = stability_margin(model, SHARP)(solution.x, solution.inputs)
    assert_allclose(float(margin), expected[0], rtol=0, atol=2e-6 + SHARP * np.log(2))
    assert np.sum(expected < 0) == np.sum(admissible_eigenvalues(jacobian, allowed) < 0)
    assert (float(margin) > 0) is solution.stable


@pytest.mark.parametrize("name", mostly_slow(["held", "cable", "fixed", "spherical"], quick=["held", "cable"]))
def test_spectrum_against_the_identity_is_that_of_a_solve(name: str) -> None:
    """With all units alike: the eigenvalues that a solve reports, over the variations that it admits."""
    model = MODELS[name]()
    solution = solve(model, raise_on_failure=True)
    jacobian, allowed = model.jacobian(solution.x, solution.inputs)[0].full(), variations(model)
    roots = np.sqrt(allowed.units / allowed.units.max())
    stiffness = roots[:, None] * jacobian[np.ix_(allowed.free, allowed.free)] / roots
    gaps = jacobian[np.ix_(allowed.held, allowed.free)] / roots
    found = Spectrum.of(bordered((stiffness + stiffness.T) / 2, gaps), np.eye(len(roots)), SHARP)
    assert_allclose(found.values[0], solution.smallest_eigenvalue, rtol=0, atol=1e-11)
    assert_allclose(found.values, admissible_eigenvalues(jacobian, allowed), rtol=0, atol=1e-10)


# Derivatives


def of_both(model: Model, width: float) -> tuple[ca.Function, ca.Function]:
    """Value and gradient, and the Hessian, as functions of unknowns and inputs together."""
    both = ca.MX.sym("both", model.size + model.inputs.size)
    value = stability_margin(model, width)(both[: model.size], both[model.size :])
    hessian, gradient = ca.hessian(value, both)
    return ca.Function("first", [both], [value, gradient]), ca.Function("second", [both], [hessian])


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=SLOW if name in ("cable", "fixed", "spherical") else ()) for name in MODELS]
)
def test_derivatives_vs_differences(name: str) -> None:
    """Exact to second order, where the round column has a double eigenvalue too."""
    model = MODELS[name]()
    solution = solve(model, raise_on_failure=True)
    first, second = of_both(model, 0.02)
    there = np.concatenate([solution.x, solution.inputs])
    hessian = second(there).full()
    assert_allclose(hessian, hessian.T, rtol=0, atol=1e-9 * np.abs(hessian).max())
    step = 2e-5
    for way in np.random.default_rng(7).standard_normal((2, len(there))):
        ends = [first(there + s * step * way) for s in (1, -1)]
        rate = float(ends[0][0] - ends[1][0]) / (2 * step)
        turned = (ends[0][1] - ends[1][1]).full()[:, 0] / (2 * step)
        gradient = first(there)[1].full()[:, 0]
        assert_allclose(gradient @ way, rate, rtol=0, atol=2e-6 * np.abs(gradient).max() * np.linalg.norm(way))
        assert_allclose(hessian @ way, turned, rtol=0, atol=2e-5 * np.abs(turned).max())


def bordered(stiffness: np.ndarray, gaps: np.ndarray) -> np.ndarray:
    return np.block([[stiffness, gaps.T], [gaps, np.zeros((len(gaps),) * 2)]])


def test_spectrum_at_a_triple_eigenvalue_vs_differences() -> None:
    """Constraints take away the first mode; of those left three have one eigenvalue. Nothing has a kink there."""
    rng = np.random.default_rng(11)
    modes = rng.standard_normal((6, 6))
    measure = np.linalg.inv(modes @ modes.T)
    stiffness = measure @ modes @ np.diag([9.0, 2.0, 2.0, 2.0, 2.5, 4.0]) @ modes.T @ measure
    gaps = 1.7 * (measure @ modes[:, :1]).T
    change = bordered(np.diag(rng.standard_normal(6)) + 0.3, rng.standard_normal((1, 6)))

    def at(share: float) -> Spectrum:
        return Spectrum.of(bordered(stiffness, gaps) + share * change, measure, 0.2)

    assert_allclose(at(0.0).values, [2.0, 2.0, 2.0, 2.5, 4.0], rtol=0, atol=1e-13)
    step = 3e-6
    rate = (at(step).soft_minimum - at(-step).soft_minimum) / (2 * step)
    assert_allclose(np.sum(at(0.0).gradient * change), rate, rtol=0, atol=1e-8)
    turned = (at(step).gradient - at(-step).gradient) / (2 * step)
    # The corner of the multipliers takes no part: a bordered matrix is zero there.
    turned[6:, 6:] = 0.0
    curved = at(0.0).curvature(change)
    curved[6:, 6:] = 0.0
    assert_allclose(curved, turned, rtol=0, atol=1e-6)


# As a constraint


def test_heaviest_load_within_a_margin_vs_closed_form() -> None:
    """The largest thrust on a round column whose margin is at least 0.3: P = 0.7 P_c but for the width of two modes."""
    model, width = build(column("kirchhoff")), 0.01
    near = solve(model)
    opti = ca.Opti()
    thrust = opti.variable()
    inputs = ca.vertcat(0, 0, -thrust)
    rod = lifted(model, opti.variable(model.size), inputs, near)
    opti.subject_to(rod.residual == 0)
    opti.subject_to(stability_margin(model, width)(rod.x, inputs) >= 0.3)
    opti.minimize(-thrust)
    opti.set_initial(thrust, CRITICAL / 2)
    opti.solver("ipopt", {"print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes", "ipopt.tol": 1e-10})
    found = opti.solve()
    softened = width * np.log(2.0)
    assert_allclose(found.value(thrust), (0.7 - softened) * CRITICAL, rtol=0, atol=1e-6)
    judged = solve(model, {"push.force": [0, 0, -found.value(thrust)]}, start=found.value(rod.x))
    assert judged.stable


# Refusals


def test_refusals() -> None:
    with pytest.raises(SceneError, match="no potential"):
        stability_margin(build(scene(push(frame="body"))))
    cable = {"name": "cable", "kind": "tendon", "rod": "rod", "length": 0.78, "slack": True, "offset": [0.05, 0.0]}
    with pytest.raises(SceneError, match=r"actuators\[0\].slack: a cable that may go slack"):
        stability_margin(build(scene(actuators=[cable])))
    for width in (0.0, -1.0, float("nan"), float("inf")):
        with pytest.raises(ValueError, match="positive"):
            stability_margin(build(column()), width)


def test_margin_of_what_is_not_finite_is_nan() -> None:
    model = build(column())
    assert np.isnan(float(stability_margin(model)(np.full(model.size, np.nan), model.pack())))
