"""Rods whose stress relaxes by Maxwell branches, against closed forms of the standard linear solid."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import build, linearise, modes_of, scene_from_dict, simulate
from cosserat_casadi.errors import SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.motion.motion_start import EQUILIBRIUM
from cosserat_casadi.numerics.collocation import radau
from tests import moving_scenes
from tests.equilibria import solve
from tests.motion.stepping import moving_model, orders, stepped

SHARE = 0.3
TIME = 0.05
BRANCH = {"share": SHARE, "time": TIME}
ADDED = SHARE / (1.0 - SHARE)
"""Stiffness of the branch over that at rest."""

AXIAL = 40.0
DENSITY = 0.9
LENGTH = 0.8
TWO_BRANCHES = moving_scenes.BRANCHES


def bar(damping: Any = None, modes: int = 1, **more: Any) -> dict[str, Any]:
    """An upright bar that only stretches, or is pressed, along itself."""
    rod = {
        "name": "a",
        "length": LENGTH,
        "strain": ["extension"],
        "stiffness": {"extension": AXIAL},
        "linear_density": DENSITY,
    }
    if damping is not None:
        rod["damping"] = damping
    scene = moving_scenes.scene(rod, loads=more.pop("loads", []), **more)
    return {**scene, "accuracy": {"modes": modes, "nodes": modes + 4}}


def bent(**changes: Any) -> dict[str, Any]:
    return moving_scenes.scene(moving_scenes.rod(**changes), loads=[moving_scenes.WEIGHT, moving_scenes.PUSH])


def creep(times: FloatArray, force: float, mass: float, stiffness: float) -> FloatArray:
    """Displacement of a mass on a standard linear solid under a force that acts from t = 0 on."""
    roots = np.roots([TIME * mass, mass, stiffness * TIME * (1.0 + ADDED), stiffness])
    # u = F/K + Σ c_i exp(λ_i t) with u, its rate and its spring at rest: the first two rates vanish, the third is F/m.
    conditions = np.vander(roots, 3, increasing=True).T
    coefficients = np.linalg.solve(conditions, [-force / stiffness, 0.0, force / mass])
    return np.asarray(force / stiffness + (np.exp(times[:, None] * roots) @ coefficients).real)


@pytest.mark.parametrize("stages", [1, 2, 3])
def test_creep_of_a_bar_converges_to_the_standard_linear_solid(stages: int) -> None:
    pull = {"name": "pull", "kind": "tip_wrench", "rod": "a", "force": [0.0, 0.0, 2.0]}
    model = moving_model(bar({"prony": [BRANCH]}, loads=[pull]))
    # The strain is uniform: the displacement is linear along the bar.
    mass = DENSITY * LENGTH / 3.0
    duration = 0.2
    exact = creep(np.array([duration]), 2.0, mass, AXIAL / LENGTH)
    errors = []
    for count in (20, 40, 80):
        history = stepped(model, radau(stages), duration / count, duration, np.zeros(model.size))
        tip = model.tip["a"](history.locate(duration)[1].x, model.pack())[0].full()[2]
        errors.append(np.abs(tip - LENGTH - exact))
    assert_allclose(orders(errors)[-1], 2 * stages - 1, rtol=0, atol=0.15)
    assert errors[-1] < [1e-1, 1e-5, 1e-8][stages - 1]


def test_force_of_a_held_bar_relaxes() -> None:
    drive = {"input": "a.base.position", "times": [0.0, 0.1], "values": [[0, 0, 0], [0, 0, -0.04]]}
    held = {"rod": "a", "kind": "pinned", "position": [0, 0, LENGTH]}
    scene = bar({"prony": TWO_BRANCHES}, supports=[held], motions=[{**drive, "interpolation": "cubic"}])
    stiffness = {"extension": AXIAL, "bending_x": 1.0, "bending_y": 1.0, "torsion": 1.0}
    scene["rods"][0].update(strain=list(stiffness), stiffness=stiffness, rotary_inertia=moving_scenes.ROTARY)
    scene["simulation"] = {"duration": 0.5, "tolerance": 1e-9}
    model = moving_model(scene)
    motion = simulate(model)
    assert motion.converged, motion.message
    state = motion.at(0.4)
    ((_, multipliers),) = model.discrete.unknowns.of_kind(BlockKind.MULTIPLIER)
    unit = model.discrete.rods["a"].energy_unit / LENGTH
    force = np.abs(state.x[multipliers]).max() * unit

    strain = 0.04 / LENGTH
    stress = strain
    t = np.polynomial.legendre.leggauss(30)[0] * 0.05 + 0.05
    weights = np.polynomial.legendre.leggauss(30)[1] * 0.05
    rates = strain * 6.0 * t / 0.1 * (1.0 - t / 0.1) / 0.1
    at_rest = 1.0 - sum(branch["share"] for branch in TWO_BRANCHES)
    for branch in TWO_BRANCHES:
        kept = weights @ (rates * np.exp((t - 0.4) / branch["time"]))
        stress += branch["share"] / at_rest * kept
    assert_allclose(force, AXIAL * stress, rtol=1e-7, atol=0)


def test_a_fast_branch_is_kelvin_voigt() -> None:
    """Of τ → 0 at the same c τ the path is that of Υ = c τ H, up to a difference of the order of τ."""
    viscous = 0.02
    paths = []
    for time in (2e-4, 1e-4, 0.0):
        share = viscous / (viscous + time) if time else 0.0
        damping = {"prony": [{"share": share, "time": time}]} if time else {"retardation_time": viscous}
        scene = bent(strain="planar", damping=damping)
        model = moving_model(scene, 3, 9)
        history = stepped(model, radau(3), 0.01, 0.3, np.zeros(model.size))
        x = history.locate(0.3)[1].x
        paths.append(model.tip["a"](x, model.pack())[0].full()[:, 0])
    distances = [np.linalg.norm(path - paths[-1]) for path in paths[:-1]]
    assert distances[1] < 1e-3 * np.linalg.norm(paths[-1])
    assert_allclose(distances[0] / distances[1], 2.0, rtol=0.05, atol=0)


def test_energy_is_balanced_and_what_is_taken_is_dissipated() -> None:
    cycle = {"input": "push.force", "amplitude": [0.4, 0.0, 0.0], "frequency": 2.0}
    for damping in ({"prony": TWO_BRANCHES}, {"prony": TWO_BRANCHES, "retardation_time": 0.01}):
        scene = {**bent(damping=damping), "motions": [cycle]}
        scene["simulation"] = {"duration": 1.0, "tolerance": 1e-6}
        motion = simulate(moving_model(scene))
        assert motion.converged, motion.message
        assert motion.start == EQUILIBRIUM
        assert_allclose(motion.energy.imbalance, 0.0, rtol=0, atol=1e-5)
        assert np.all(np.diff(motion.energy.dissipated)[-1] > 0.0)


def test_a_cycle_takes_what_its_branches_do_whatever_the_law() -> None:
    """Of the strain ε cos ωt a branch of stiffness c EA takes π c EA ε² ℓ ωτ/(1 + ω²τ²), an elastic law nothing."""
    branches = [{"share": 0.2, "time": 0.01}, {"share": 0.3, "time": 0.02}]
    radius = 5e-3
    change, period = 0.1, 0.25
    drive = {"input": "a.base.position", "amplitude": [0, 0, -change * LENGTH], "frequency": 1 / period}
    drive["wave"] = "one_minus_cosine"
    held = {"rod": "a", "kind": "pinned", "position": [0, 0, LENGTH]}
    table = bar(
        supports=[held],
        motions=[drive],
        simulation={"duration": 0.5, "frames": 3, "tolerance": 1e-6, "start": "unloaded"},
    )
    table["rods"][0] = {
        "name": "a",
        "length": LENGTH,
        "strain": ["extension", "bending_x", "bending_y", "torsion"],
        "section": {"shape": "circle", "radius": radius},
        "material": {
            "law": "polynomial",
            "youngs_modulus": AXIAL / (np.pi * radius**2),
            "poisson_ratio": 0.5,
            "density": 10.0,
            "terms": [{"extension": 3, "coefficient": AXIAL}],
        },
        "damping": {"prony": branches},
    }
    motion = simulate(moving_model(table))
    assert motion.converged, motion.message
    # Transients of the start are gone after 0.25 s; inertia gives back what it takes.
    angles = 2 * np.pi / period * np.array([branch["time"] for branch in branches])
    shares = np.array([branch["share"] for branch in branches])
    stiffness = AXIAL * shares / (1 - shares.sum())
    taken = np.pi * change**2 * LENGTH * np.sum(stiffness * angles / (1 + angles**2))
    assert_allclose(np.diff(motion.energy.dissipated)[-1], taken, rtol=1e-4, atol=1e-9)
    assert_allclose(np.diff(motion.energy.work)[-1], taken, rtol=1e-4, atol=1e-6)


def test_a_rod_that_grows_keeps_its_balance_of_energy() -> None:
    drive = {"input": "a.length", "times": [0.0, 0.3], "values": [0.8, 1.0], "interpolation": "cubic"}
    scene = {**bent(damping={"prony": TWO_BRANCHES}), "motions": [drive]}
    scene["simulation"] = {"duration": 0.3, "tolerance": 1e-6, "start": "unloaded"}
    motion = simulate(moving_model(scene))
    assert motion.converged, motion.message
    assert_allclose(motion.energy.imbalance, 0.0, rtol=0, atol=1e-5)


@pytest.mark.parametrize("family", moving_scenes.RELAXING)
def test_derivatives_are_those_of_the_equations(family: str) -> None:
    model = moving_scenes.model_of(family)
    own = model.dynamics_jacobian
    symbols = own.mx_in()
    residual = model.inverse_dynamics(*symbols)
    by_ad = ca.Function("by_ad", symbols, [ca.jacobian(residual, symbol) for symbol in symbols[:3]])
    values = moving_scenes.drawn_state(model).all
    for matrix, expected in zip(own(*values), by_ad(*values), strict=False):
        assert_allclose(matrix.full(), expected.full(), rtol=1e-11, atol=1e-12)


def test_modes_are_roots_of_the_cubic() -> None:
    """λ² + ω² (1 + c λτ/(1 + λτ)) = 0 for every ω of the rod without its branch."""
    elastic = modes_of(build(scene_from_dict(bar(modes=4))))
    solution = solve(build(scene_from_dict(bar({"prony": [BRANCH]}, modes=4))))
    relaxing = modes_of(solution)
    expected: list[complex] = []
    for frequency in elastic.angular_frequencies:
        square = frequency**2
        roots = np.roots([TIME, 1.0, square * TIME * (1.0 + ADDED), square])
        expected += [root for root in roots if root.imag >= 0.0]
    expected.sort(key=abs)
    assert_allclose(relaxing.spectrum, expected, rtol=1e-10, atol=0)
    # The branch creeps as often as the rod vibrates: that is no mode.
    vibrations = [root for root in expected if root.imag > 0.0]
    assert_allclose(relaxing.eigenvalues, vibrations, rtol=1e-10, atol=0)
    linear = np.linalg.eigvals(linearise(solution).A)
    nearest = [np.abs(linear - value).min() / abs(value) for value in expected]
    assert_allclose(nearest, 0.0, rtol=0, atol=1e-10)


def test_every_strain_relaxes_by_its_own_share() -> None:
    """Twist and stretch of a straight rod are two rods: the spectrum is that of both, each with its share."""
    stiffness = {"torsion": 2.0, "extension": AXIAL}
    shares = {"torsion": 0.1, "extension": SHARE}
    expected = []
    for strains in (["torsion"], ["extension"], ["torsion", "extension"]):
        named = {name: shares[name] for name in strains if len(strains) > 1 and name == "extension"}
        table = bar({"prony": [{"share": shares[strains[0]], "time": TIME, **named}]}, modes=3)
        table["rods"][0].update(strain=strains, stiffness={name: stiffness[name] for name in strains})
        table["rods"][0]["rotary_inertia"] = moving_scenes.ROTARY
        expected.append(modes_of(solve(build(scene_from_dict(table)))).spectrum)
    both = np.concatenate(expected[:2])
    assert_allclose(expected[2], both[np.argsort(np.abs(both))], rtol=1e-9, atol=0)


def test_statics_pays_nothing() -> None:
    at_rest = build(scene_from_dict(bent(damping={"prony": TWO_BRANCHES})))
    plain = build(scene_from_dict(bent(damping={"retardation_time": 0.01})))
    assert _instructions(at_rest, "residual", "jacobian") == _instructions(plain, "residual", "jacobian")
    x = np.linspace(-0.3, 0.3, plain.size)
    assert np.array_equal(at_rest.residual(x, at_rest.pack()).full(), plain.residual(x, plain.pack()).full())
    in_motion = build(plain.scene, plain.discretisation, moving=True)
    names = ("inverse_dynamics", "dynamics_jacobian", "energies", "powers")
    assert _instructions(plain, *names) == _instructions(in_motion, *names)


def _instructions(model: Model, *names: str) -> list[int]:
    return [getattr(model, name).expand().n_instructions() for name in names]


def test_a_model_at_rest_says_that_it_has_no_stress_that_relaxes() -> None:
    model = build(scene_from_dict(bent(damping={"prony": [BRANCH]})))
    with pytest.raises(SceneError, match="moving=True"):
        _ = model.inverse_dynamics


@pytest.mark.parametrize(
    ("damping", "message"),
    [
        ({"prony": [{"share": 0.6, "time": 0.1}, {"share": 0.4, "time": 0.2}]}, "add up to less than 1"),
        ({"prony": [{"share": 0.6, "time": 0.1}, {"share": 0.1, "torsion": 0.4, "time": 0.2}]}, "less than 1"),
        ({"prony": [{"share": 0.1, "extension": 0.4, "time": 0.2}]}, r"prony\[0\].extension: belongs to a strain"),
        ({"prony": [{"share": 0.0, "time": 0.1}]}, "share"),
        ({"prony": [{"share": 0.5, "time": 0.0}]}, "time"),
        ({"prony": []}, "retardation_time"),
    ],
)
def test_branches_that_are_none_are_refused(damping: dict[str, Any], message: str) -> None:
    with pytest.raises(SceneError, match=message):
        scene_from_dict(bent(damping=damping))
