"""Parameters: a model with named numbers against a model of a scene with these numbers, and their derivatives."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, Scene, SceneError, build, follow, modes_of, scene_from_dict
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.discretise import discretise
from cosserat_casadi.scene.load_records import LoadRecord
from tests.derivatives import central_differences
from tests.equilibria import solve
from tests.families import mostly_slow
from tests.loads.kinds import BedRecord, DipoleRecord, registered, with_loads
from tests.scenes import WEIGHT, push

WIRE: dict[str, Any] = {
    "name": "wire",
    "length": 0.8,
    "strain": "kirchhoff",
    "material": {"youngs_modulus": 2.0e9, "poisson_ratio": 0.3, "density": 1200.0},
    "section": {"shape": "annulus", "outer_radius": [0.011, 0.008], "inner_radius": 0.005},
    "damping": {"retardation_time": 0.03},
    "intrinsic": {"curvature": [0.2, [1.4, 0.3], 0.0], "tangent": [0, 0, 1]},
    "base": {"position": [0.1, 0, 0.2], "quaternion": [0.8, 0.0, 0.6, 0.0]},
}

ELASTIC: dict[str, Any] = {
    "name": "wire",
    "length": 0.8,
    "strain": "reissner",
    "stiffness": {
        "bending_x": 1.0,
        "bending_y": [1.4, 1.1],
        "torsion": 0.7,
        "shear_x": 40.0,
        "shear_y": 60.0,
        "extension": 90.0,
    },
    "linear_density": [0.9, 0.7],
    "rotary_inertia": [2e-4, 3e-4, 4e-4],
    "damping": {"bending_x": 0.01, "torsion": 0.02, "extension": 0.4},
}

PLATE: dict[str, Any] = {
    "name": "wire",
    "length": 0.5,
    "strain": "reissner",
    "material": {"youngs_modulus": 2.0e9, "shear_modulus": 7e8, "density": 1200.0},
    "section": {"shape": "rectangle", "width": [0.02, 0.01], "height": 0.011, "shear_correction": 0.85},
}

BED: dict[str, Any] = {
    "name": "bed",
    "kind": "foundation",
    "rod": "wire",
    "stiffness": [40.0, 30.0, 10.0],
    "frame": "body",
    "span": [0.35, 0.7],
}

CABLES = [
    {"name": "east", "kind": "tendon", "rod": "wire", "tension": 1.0, "offset": [[8e-3, -2e-3], 1e-3]},
    {"name": "coil", "kind": "tendon", "rod": "wire", "tension": 0.7, "helix": {"radius": 6e-3, "turns": 1.2}},
    {"name": "air", "kind": "chamber", "rod": "wire", "pressure": 2e4, "area": 3e-6, "offset": [0.0, 4e-3]},
]


def tables(rod: dict[str, Any], *parameters: str, **changes: Any) -> dict[str, Any]:
    load = push(rod="wire", force=[0.4, 0.2, -0.3], moment=[0.02, 0.0, 0.01])
    return {
        "schema": 1,
        "rods": [rod],
        "loads": [load, WEIGHT],
        "inputs": ["push.force"],
        "parameters": list(parameters),
        **changes,
    }


PLATFORM: dict[str, Any] = {
    "rods": [
        {**WIRE, "name": "left", "base": {"position": [-0.1, 0, 0]}},
        {**WIRE, "name": "right", "base": {"position": [0.1, 0, 0]}},
    ],
    "bodies": [{"name": "plate", "mass": 0.2, "centre_of_mass": [0.01, 0.0, 0.02], "inertia": [1e-3, 2e-3, 2.5e-3]}],
    "joints": [
        {"body": "plate", "rod": "left", "kind": "fixed", "position": [-0.1, 0, 0]},
        {"body": "plate", "rod": "right", "kind": "spherical", "position": [0.1, 0, 0]},
    ],
    "loads": [
        WEIGHT,
        {"name": "pull", "kind": "body_wrench", "body": "plate", "force": [0.3, 0.1, 0], "position": [0.02, 0.03, 0]},
    ],
    "inputs": ["pull.force"],
}

POKES = [
    {"name": "poke", "kind": "point_wrench", "rod": "wire", "at": 0.4, "force": [0.5, 0.2, -0.3]},
    {"name": "prod", "kind": "point_wrench", "rod": "wire", "at": 0.7, "moment": [0.02, 0.1, 0.05], "frame": "body"},
]

WIND = {
    "name": "wind",
    "kind": "distributed_wrench",
    "rod": "wire",
    "force": [[0.3, -0.2, 0.1], 0.1, 0.0],
    "moment": [0.0, 0.0, [0.02, 0.01]],
    "frame": "body",
}

SPANNED = [
    {**CABLES[0], "span": [0.0, 0.6]},
    {**CABLES[1], "span": [0.4, 0.8]},
    {**CABLES[2], "span": [0.2, 1.0]},
]

ROPES = [
    {"name": "rope", "kind": "tendon", "rod": "wire", "length": 0.8, "offset": [8e-3, 0.0]},
    {"name": "line", "kind": "tendon", "rod": "wire", "length": 0.82, "slack": True, "offset": [0.0, 8e-3]},
]

HINGES = [
    {"body": "plate", "rod": "left", "kind": "revolute", "position": [-0.1, 0, 0], "axis": [0, 1, 0.2]},
    {"body": "plate", "rod": "right", "kind": "prismatic", "position": [0.1, 0, 0], "axis": [1, 0, 0]},
]

BRANCH: dict[str, Any] = {
    "rods": [WIRE, {**WIRE, "name": "twig", "base": {"rod": "wire", "at": 0.5, "quaternion": [0.8, 0, 0.6, 0]}}],
    "loads": [WEIGHT],
    "supports": [
        {"name": "tip", "rod": "twig", "kind": "clamped", "position": [0.6, 0, 0.9], "quaternion": [1, 0, 0, 0]}
    ],
    "inputs": ["weight.acceleration"],
}


def streaming(rod: dict[str, Any], load: dict[str, Any]) -> dict[str, Any]:
    """A rod with one load, none of whose magnitudes is an input."""
    return {"schema": 1, "rods": [rod], "loads": [load], "inputs": []}


STREAM = {
    "name": "stream",
    "kind": "flow",
    "density": 900.0,
    "velocity": [0.4, 0.1, 0],
    "normal": 1.1,
    "tangential": 0.02,
    "added_mass": 1.0,
    "gravity": [0, 0, -9.81],
}
CASES: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "moduli": (tables(WIRE), {"wire.material.youngs_modulus": 3.1e9, "wire.material.poisson_ratio": 0.21}),
    "modulus of a uniform rod": (
        tables({**WIRE, "section": {"shape": "circle", "radius": 0.01}}),
        {"wire.material.youngs_modulus": 3.1e9},
    ),
    "density": (tables(WIRE), {"wire.material.density": 1450.0}),
    "radii": (tables(WIRE), {"wire.section.outer_radius": [0.012, 0.0075], "wire.section.inner_radius": 0.004}),
    "tip radius": (tables(WIRE), {"wire.section.outer_radius.tip": 0.0085}),
    "rectangle": (
        tables(PLATE),
        {"wire.section.width": [0.018, 0.012], "wire.section.height": 0.0125, "wire.section.shear_correction": 0.8},
    ),
    "shear modulus": (tables(PLATE), {"wire.material.shear_modulus": 6e8}),
    "stiffness": (
        tables(ELASTIC),
        {"wire.stiffness.bending_y": [1.6, 1.0], "wire.stiffness.torsion": 0.9, "wire.stiffness.shear_x": 33.0},
    ),
    "inertia": (
        tables(ELASTIC),
        {"wire.linear_density": [0.8, 1.1], "wire.rotary_inertia": [3e-4, 2.5e-4, 5e-4]},
    ),
    "damping": (tables(ELASTIC), {"wire.damping.torsion": 0.05, "wire.damping.bending_x": 0.015}),
    "retardation": (tables(WIRE), {"wire.damping.retardation_time": 0.05, "wire.material.youngs_modulus": 1.7e9}),
    "curvature": (tables(WIRE), {"wire.intrinsic.curvature": [[0.4, -0.1], [1.0, 0.5], [0.3, 0.2]]}),
    "one coefficient": (tables(WIRE), {"wire.intrinsic.curvature.y[1]": -0.4}),
    "tangent": (tables(ELASTIC), {"wire.intrinsic.tangent": [0.02, -0.01, 1.03]}),
    "base": (
        tables(WIRE),
        {"wire.base.position": [0.3, -0.2, 0.1], "wire.base.quaternion": [0.6, 0.0, 0.0, 0.8]},
    ),
    "length": (tables(WIRE), {"wire.length": 0.95}),
    "length and sections": (
        tables(ELASTIC),
        {"wire.length": 0.7, "wire.stiffness.bending_x": 1.2, "wire.intrinsic.curvature.x": 0.4},
    ),
    "loads": (tables(WIRE), {"push.moment": [0.0, 0.03, 0.01], "weight.acceleration.z": -9.0}),
    "offsets": (tables(ELASTIC, actuators=CABLES), {"east.offset": [[7e-3, -1e-3], [2e-3, 1e-3]]}),
    "helix": (
        tables(ELASTIC, actuators=CABLES),
        {"coil.helix.radius": 7e-3, "coil.helix.turns": 0.9, "coil.helix.phase": 0.4},
    ),
    "chamber": (
        tables(ELASTIC, actuators=CABLES),
        {"air.area": 4e-6, "air.offset.y": 3e-3, "air.pressure": 3e4, "east.tension": 1.5},
    ),
    "places of joints": (
        {"schema": 1, **PLATFORM},
        {
            "joints[0].position": [-0.12, 0.01, 0],
            "joints[0].quaternion": [0.8, 0.6, 0, 0],
            "joints[1].position.x": 0.13,
            "left.base.position.y": 0.02,
        },
    ),
    "places of hinges and slides": (
        {"schema": 1, **PLATFORM, "joints": HINGES},
        {"joints[0].position": [-0.12, 0.01, 0.02], "joints[1].position.x": 0.13},
    ),
    "axes of hinges and slides": (
        {"schema": 1, **PLATFORM, "joints": HINGES},
        {
            "joints[0].axis": [0.3, 1.2, -0.1],
            "joints[0].quaternion": [0.96, 0.0, 0.28, 0.0],
            "joints[1].axis": [-2.0, 0.5, 0.3],
        },
    ),
    "place of a branch": (
        {"schema": 1, **BRANCH},
        {"twig.base.position": [0.01, 0.02, 0], "twig.base.quaternion": [0.6, 0, 0.8, 0], "tip.position.y": 0.02},
    ),
    "places of loads": (
        tables(WIRE, loads=[*POKES, WIND, WEIGHT], inputs=["poke.force", "wind.force"]),
        {"poke.at": 0.5, "prod.at": 0.77},
    ),
    "spans of tendons and chambers": (
        tables(ELASTIC, actuators=SPANNED),
        {"east.span[1]": 0.55, "coil.span": [0.3, 0.75], "air.span[0]": 0.24},
    ),
    "span of a rubbing tendon": (
        tables(ELASTIC, actuators=[{**SPANNED[1], "friction": 0.2}]),
        {"coil.span[1]": 0.8},
    ),
    "span of a cable of given length": (
        tables(ELASTIC, actuators=[{**ROPES[0], "length": 0.5, "span": [0.0, 0.65]}]),
        {"rope.span[1]": 0.6, "rope.length": 0.47, "wire.length": 0.77},
    ),
    "place of a carried rod": (
        {"schema": 1, **BRANCH},
        {"twig.base.at": 0.62},
    ),
    "span of a foundation": (
        streaming({**WIRE, "base": {"position": [0.1, 0, 0.2], "quaternion": [0.8, 0, 0.6, 0]}}, BED),
        {"bed.span": [0.25, 0.8]},
    ),
    "span of a foundation of a straight rod": (
        streaming(ELASTIC, BED),
        {"bed.span[0]": 0.25},
    ),
    "place of a magnet, past other loads": (
        tables(
            WIRE,
            loads=[
                {
                    "name": "magnet",
                    "kind": "magnet",
                    "rod": "wire",
                    "at": 0.6,
                    "moment": [0, 0, 0.4],
                    "field": [0.1, 0.02, 0.01],
                },
                STREAM,
            ],
            inputs=[],
        ),
        {"magnet.at": 0.72},
    ),
    "a stream": (
        streaming(WIRE, STREAM),
        {
            "stream.density": 1050.0,
            "stream.normal": 0.9,
            "stream.tangential": 0.03,
            "stream.added_mass": 0.8,
            "stream.gravity.z": -9.0,
            "stream.velocity.y": 0.3,
            "wire.section.outer_radius": [0.012, 0.009],
        },
    ),
    "a magnetised rod": (
        streaming(
            WIRE,
            {
                "name": "magnet",
                "kind": "magnet",
                "rod": "wire",
                "magnetisation": [0, 0, [8e4, 1e3]],
                "field": [0, 0.02, 0.01],
                "dipole": {"position": [0.5, 0.5, 0.5], "moment": [0, 0, 9.0]},
            },
        ),
        {
            "magnet.magnetisation.z": [6e4, -2e3],
            "magnet.dipole.position": [0.6, 0.4, 0.5],
            "magnet.field.x": 0.01,
            "wire.section.inner_radius": 0.004,
        },
    ),
    "a foundation along a curve": (
        streaming(
            WIRE,
            {
                "name": "bed",
                "kind": "foundation",
                "rod": "wire",
                "stiffness": [40.0, 30.0, 0],
                "span": [0.3, 1.0],
                "curve": [[0.1, 0.05], 0.0, [0.5, 0.3]],
            },
        ),
        {"bed.stiffness.x": 55.0, "bed.curve.x": [0.12, 0.04]},
    ),
    "a rubbing tendon": (
        tables(ELASTIC, actuators=[{**CABLES[1], "friction": 0.2}]),
        {"coil.friction": 0.3, "coil.helix.radius": 7e-3, "coil.tension": 0.9},
    ),
    "elastic cables": (
        tables(ELASTIC, actuators=[{**ROPES[0], "axial_stiffness": 400.0, "winch_stiffness": 3e3, "pretension": 0.3}]),
        {"rope.axial_stiffness": 500.0, "rope.winch_stiffness": 2e3, "rope.pretension": 0.1, "rope.length": 0.795},
    ),
    "cables of given length": (
        tables(ELASTIC, actuators=ROPES),
        {"rope.length": 0.79, "rope.offset.x": 7e-3, "line.offset.y": 9e-3, "wire.stiffness.extension": 80.0},
    ),
    "lengths in an assembly": (
        {"schema": 1, **PLATFORM},
        {"left.length": 0.85, "right.length": 0.78, "right.intrinsic.curvature.y[0]": 1.0},
    ),
    "bodies": (
        {"schema": 1, **PLATFORM},
        {
            "plate.mass": 0.3,
            "plate.centre_of_mass": [0.0, 0.02, 0.01],
            "plate.inertia": [2e-3, 1.5e-3, 3e-3],
            "pull.position": [0.0, 0.05, 0.01],
            "left.material.youngs_modulus": 1.5e9,
        },
    ),
    "a body that rides": (
        {
            "schema": 1,
            "rods": [{**WIRE, "damping": {"mass_proportional": 0.5}}],
            "bodies": [{"name": "plate", "mass": 0.2, "inertia": [1e-3, 2e-3, 2.5e-3]}],
            "joints": [
                {
                    "name": "mount",
                    "body": "plate",
                    "rod": "wire",
                    "at": 0.7,
                    "kind": "fixed",
                    "position": [0.0, 0.01, 0],
                }
            ],
            "loads": PLATFORM["loads"],
            "inputs": ["pull.force"],
        },
        {
            "plate.mass": 0.3,
            "plate.centre_of_mass": [0.0, 0.02, 0.01],
            "plate.inertia": [2e-3, 1.5e-3, 3e-3],
            "mount.position": [0.02, 0.0, 0.01],
            "mount.at": 0.6,
            "pull.position": [0.0, 0.05, 0.01],
            "wire.damping.mass_proportional": 0.8,
        },
    ),
}


EACH_KIND = (
    "moduli",
    "density",
    "rectangle",
    "inertia",
    "retardation",
    "curvature",
    "base",
    "length",
    "loads",
    "offsets",
    "places of loads",
    "a stream",
    "bodies",
)
"""One case of what parameters can belong to: rods, loads, actuators, bodies."""

MORE = (
    "radii",
    "stiffness",
    "damping",
    "one coefficient",
    "helix",
    "chamber",
    "axes of hinges and slides",
    "spans of tendons and chambers",
    "place of a carried rod",
    "a magnetised rod",
    "a foundation along a curve",
    "elastic cables",
    "a body that rides",
)
"""Cases that are told apart only where values are not the defaults."""


def scene_of(case: str) -> Scene:
    given, values = CASES[case]
    return scene_from_dict({**given, "parameters": list(values)})


def model_of(case: str) -> Model:
    return resolved(scene_of(case))


def resolved(scene: Scene) -> Model:
    # Parameters of an assembly are those of its rods and frames: few modes show them.
    modes, nodes = (2, 4) if len(scene.rods) > 1 else (4, 8)
    return build(scene, discretise(scene, modes, nodes), moving=True)


def point(model: Model) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
    """Unknowns, their rates, inputs and rates of the inputs, drawn at random."""
    random = np.random.default_rng(7)
    x, v, a = 0.3 * random.standard_normal((3, model.size))
    inputs = model.pack() + 0.1 * random.standard_normal(model.inputs.size)
    return x, v, a, inputs, np.zeros(model.inputs.size)


@pytest.mark.parametrize("case", mostly_slow(CASES, quick=["bodies"]))
def test_at_the_defaults_it_is_the_model_of_the_scene(case: str) -> None:
    model = model_of(case)
    baked = build(scene_of(case).baked(), model.discretisation, moving=True)
    x, v, a, inputs, still = point(model)
    p = model.parameters.pack()
    for wanted, found in (
        (baked.residual(x, inputs), model.residual(x, inputs, p)),
        (baked.jacobian(x, inputs)[0], model.jacobian(x, inputs, p)[0]),
        (
            baked.inverse_dynamics(x, v, a, inputs, still, still),
            model.inverse_dynamics(x, v, a, inputs, p, still, still),
        ),
        (baked.mass_matrix(x, inputs), model.mass_matrix(x, inputs, p)),
        (baked.energy(x, inputs), model.energy(x, inputs, p)),
    ):
        wanted_entries = wanted.full()
        assert_allclose(found.full(), wanted_entries, rtol=1e-13, atol=1e-14 * np.abs(wanted_entries).max())


@pytest.mark.parametrize(
    "case", mostly_slow(CASES, quick=["density", "helix", "a foundation along a curve", "elastic cables"])
)
def test_elsewhere_it_is_the_model_with_these_numbers(case: str) -> None:
    """The bound model computes with plain numbers: none of its constants is an expression."""
    model = model_of(case)
    values = CASES[case][1]
    bound = model.at(values)
    assert not bound.parameters.size
    x, v, a, inputs, still = point(model)
    p = model.parameters.pack(values)
    matrices = model.dynamics_jacobian(x, v, a, inputs, p, still, still)
    wanted_matrices = bound.dynamics_jacobian(x, v, a, inputs, still, still)
    pairs = [
        (bound.residual(x, inputs), model.residual(x, inputs, p)),
        (bound.jacobian(x, inputs)[0], model.jacobian(x, inputs, p)[0]),
        *zip(wanted_matrices, matrices, strict=True),
        *zip(bound.energies(x, v, inputs, still), model.energies(x, v, inputs, p, still), strict=True),
        *zip(bound.powers(x, v, a, inputs, still, still), model.powers(x, v, a, inputs, p, still, still), strict=True),
    ]
    for wanted, found in pairs:
        wanted_entries = wanted.full()
        assert_allclose(found.full(), wanted_entries, rtol=1e-12, atol=1e-13 * np.abs(wanted_entries).max(initial=1e-9))


@pytest.mark.parametrize("case", mostly_slow(CASES, quick=[*EACH_KIND, *MORE]))
def test_derivatives_with_the_parameters(case: str) -> None:
    """First derivatives against differences, and second ones finite, at a shape and in the unloaded rod."""
    model = model_of(case)
    random_x, _, _, inputs, _ = point(model)
    p = model.parameters.pack()
    step = np.where(p == 0.0, 0.05, np.abs(p)) * 1e-5
    argument = model.parameters.symbol
    x_symbol = ca.MX.sym("x", model.size)
    residual = model.residual(x_symbol, inputs, argument)
    second = ca.Function("second", [x_symbol, argument], [ca.hessian(ca.sumsqr(residual), argument)[0]])
    for x in (random_x, np.zeros(model.size)):
        found = model.parameter_jacobian(x, inputs, p).full()
        # What each parameter does by a change of its own size.
        wanted = central_differences(lambda given, x=x: model.residual(x, inputs, given), p, step) * step
        scale = np.abs(wanted).max()
        assert_allclose(found * step, wanted, rtol=1e-6, atol=1e-7 * scale)
        assert np.all(np.isfinite(second(x, p).full()))


PRICES = {
    "modulus of a uniform rod": 30,
    "one coefficient": 30,
    "density": 60,
    "length": 200,
    "base": 150,
}
"""Most scalar operations that the parameters of a case add to the residual."""


@pytest.mark.parametrize("case", PRICES)
def test_parameters_cost_what_they_compute(case: str) -> None:
    model = model_of(case)
    bound = model.at()
    added = model.operations(model.residual) - bound.operations(bound.residual)
    assert added <= PRICES[case]


def test_a_scene_without_parameters_has_no_argument_for_them() -> None:
    model = build(scene_of("density").baked())
    assert model.residual.name_in() == ["x", "inputs"]
    assert model.parameter_jacobian is None
    assert not model.parameters.names
    assert model.at() is model


def test_functions_take_parameters_behind_the_inputs() -> None:
    model = model_of("radii")
    assert model.residual.name_in() == ["x", "inputs", "p"]
    assert model.path_jacobian.name_in() == ["x", "inputs", "p", "load_factor"]
    assert model.energies.name_in() == ["x", "v", "inputs", "p", "inputs_rate"]
    assert model.igm["wire"].name_in() == ["q", "base_position", "base_quaternion", "inputs", "p"]
    assert model.parameters.names == ("wire.section.outer_radius", "wire.section.inner_radius")
    assert [parameter.shape for parameter in model.parameters.entries] == [(1, 2), (1, 1)]


EQUILIBRIA = (
    "moduli",
    "density",
    "radii",
    "rectangle",
    "tangent",
    "length and sections",
    "curvature",
    "base",
    "loads",
    "offsets",
    "helix",
    "chamber",
    "cables of given length",
    "a stream",
    "a magnetised rod",
    "a foundation along a curve",
    "a rubbing tendon",
    "elastic cables",
    "lengths in an assembly",
    "places of joints",
    "places of hinges and slides",
    "axes of hinges and slides",
    "place of a branch",
    "bodies",
    "span of a cable of given length",
    "place of a carried rod",
)
"""Cases whose parameters move an equilibrium."""


@pytest.mark.slow
@pytest.mark.parametrize("case", EQUILIBRIA)
def test_equilibria_are_those_of_a_scene_of_its_own(case: str) -> None:
    """The scene with these numbers has another scaling, and another model: poses are compared."""
    model = model_of(case)
    values = CASES[case][1]
    found = solve(model, parameters=values)
    wanted = solve(resolved(model.parameters.set_in(model.scene, values)))
    assert found.converged
    assert wanted.converged
    for rod in model.discrete.rods:
        assert_allclose(found.tip(rod).position, wanted.tip(rod).position, rtol=0, atol=1e-10)
    p = model.parameters.pack(values)
    assert np.abs(model.residual(found.x, found.inputs, p).full()).max() < 1e-9


SAME_SCALING = (
    "density",
    "inertia",
    "damping",
    "curvature",
    "one coefficient",
    "tangent",
    "base",
    "loads",
    "offsets",
    "helix",
    "chamber",
)
"""Cases whose parameters leave stiffness and length alone, so that unknowns mean the same in a scene of its own."""


@pytest.mark.parametrize("case", SAME_SCALING)
def test_equations_of_motion_are_those_of_a_scene_of_its_own(case: str) -> None:
    model = model_of(case)
    values = CASES[case][1]
    rebuilt = build(model.parameters.set_in(model.scene, values), model.discretisation, moving=True)
    x, v, a, inputs, still = point(model)
    p = model.parameters.pack(values)
    wanted = rebuilt.inverse_dynamics(x, v, a, inputs, still, still).full()
    found = model.inverse_dynamics(x, v, a, inputs, p, still, still).full()
    assert_allclose(found, wanted, rtol=1e-12, atol=1e-12 * np.abs(wanted).max())


def test_motion_of_a_length_that_is_bound_is_that_of_the_argument() -> None:
    """Disks end elements, whose masses are expressions without a symbol where the length is bound."""
    disk = {"rod": "wire", "at": [0.3, 0.8], "mass": 0.01, "radius": 0.02}
    model = resolved(scene_from_dict(tables(WIRE, "wire.length", disks=[disk])))
    x, v, a, inputs, still = point(model)
    p = 1.01 * model.parameters.pack()
    found = model.at(p).dynamics_jacobian(x, v, a, inputs, still, still)
    for own, other in zip(found, model.dynamics_jacobian(x, v, a, inputs, p, still, still), strict=True):
        wanted = other.full()
        assert_allclose(own.full(), wanted, rtol=0, atol=1e-12 * max(np.abs(wanted).max(), 1e-9))


MOVED = (
    "places of loads",
    "spans of tendons and chambers",
    "span of a rubbing tendon",
    "span of a foundation",
    "span of a foundation of a straight rod",
    "place of a magnet, past other loads",
)
"""Cases of one rod whose parameters move element ends."""


@pytest.mark.parametrize("rotation", mostly_slow(["magnus6", "permuted"], quick=["magnus6"]))
@pytest.mark.parametrize("case", mostly_slow(MOVED, quick=MOVED[2:3]))
def test_equations_of_moved_elements_are_those_of_a_scene_of_its_own(case: str, rotation: str) -> None:
    """Strains are counted per nominal length of their element: a scene of its own has them times its width."""
    given, values = CASES[case]
    scene = scene_from_dict({**given, "parameters": list(values), "accuracy": {"rotation": rotation}})
    model = resolved(scene)
    rebuilt = resolved(model.parameters.set_in(scene, values))
    rod = model.discrete.rods["wire"]
    widths = np.diff(rebuilt.discretisation["wire"].breaks) / np.diff(model.discretisation["wire"].breaks)
    element = [np.repeat(np.arange(len(widths)), rod.size_of(c) // len(widths)) for c in rod.columns]
    rate = widths[np.concatenate(element)]
    x, v, a, inputs, still = point(model)
    p = model.parameters.pack(values)
    force, matrix = rate[:, None], np.outer(rate, rate)
    pairs = [(model.residual(x, inputs, p), rebuilt.residual(x / rate, inputs), force)]
    if rotation != "permuted":
        moving = rebuilt.inverse_dynamics(x / rate, v / rate, a / rate, inputs, still, still)
        pairs += [
            (model.inverse_dynamics(x, v, a, inputs, p, still, still), moving, force),
            (model.jacobian(x, inputs, p)[0], rebuilt.jacobian(x / rate, inputs)[0], matrix),
            (model.mass_matrix(x, inputs, p), rebuilt.mass_matrix(x / rate, inputs), matrix),
        ]
    for found, expected, factor in pairs:
        wanted = expected.full() / factor
        assert_allclose(found.full(), wanted, rtol=1e-12, atol=1e-12 * np.abs(wanted).max())


@pytest.mark.parametrize("rotation", ["magnus4", "permuted"])
def test_the_unloaded_response_is_that_of_the_model_with_these_numbers(rotation: str) -> None:
    given, values = CASES["length and sections"]
    model = resolved(scene_from_dict({**given, "parameters": list(values), "accuracy": {"rotation": rotation}}))
    inputs = model.pack()
    bound = model.at(values)
    found = model.path_tangent(inputs, model.parameters.pack(values))
    wanted = bound.path_tangent(inputs).full()
    assert_allclose(found.full(), wanted, rtol=1e-10, atol=1e-12 * np.abs(wanted).max())


def test_values_that_the_scene_refuses_are_refused() -> None:
    model = model_of("radii")
    with pytest.raises(SceneError, match="must be < outer_radius at both ends"):
        model.at({"wire.section.inner_radius": 0.02})
    with pytest.raises(SceneError, match="is not a parameter of this model"):
        model.at({"wire.section.radius": 0.02})
    with pytest.raises(SceneError, match="must have 2 numbers, got 1"):
        model.at({"wire.section.outer_radius": 0.02})
    with pytest.raises(SceneError, match="parameters: must be 3 numbers, got 2"):
        model.at([0.01, 0.02])
    with pytest.raises(SceneError, match="is not a parameter of this model"):
        model.at().at({"wire.section.inner_radius": 0.004})


def test_places_keep_their_order() -> None:
    given, values = CASES["places of loads"]
    model = build(scene_from_dict({**given, "parameters": list(values)}))
    sentence = r"poke.at, prod.at: the elements of 'wire' would end at X = 0, 0\.8, 0\.75, 1: .*keep their order"
    for refuse in (model.at, model.parameters.pack, lambda values: solve(model, parameters=values)):
        with pytest.raises(SceneError, match=sentence):
            refuse({"poke.at": 0.8, "prod.at": 0.75})
    with pytest.raises(SceneError, match="keep their order"):
        model.at({"prod.at": 1.0})
    with pytest.raises(SceneError, match="keep their order"):
        model.at({"poke.at": 0.0})


def test_places_that_cannot_move_are_refused_with_what_to_do() -> None:
    given, _ = CASES["spans of tendons and chambers"]
    scene = scene_from_dict({**given, "parameters": ["east.span", "air.span.end"]})
    with pytest.raises(SceneError, match="which does not move along it") as refused:
        build(scene)
    assert [problem.where for problem in refused.value.problems] == ["east.span", "air.span.end"]
    loads = [{**POKES[0], "at": 0.7}, POKES[1], WEIGHT]
    with pytest.raises(SceneError, match="where another part is that does not move with it"):
        build(scene_from_dict(tables(WIRE, "poke.at", loads=loads, inputs=[])))


@pytest.mark.slow
def test_the_response_of_the_tip_to_a_place_against_scenes_of_their_own() -> None:
    """dx/ds = −J⁻¹ ∂r/∂s, and the tip moves with x and with s: all of it by differences of other models."""
    name = "poke.at"
    given, _ = CASES["places of loads"]
    model = resolved(scene_from_dict({**given, "parameters": [name]}))
    found = solve(model)
    p = model.parameters.pack()
    jacobian, _ = model.jacobian(found.x, found.inputs, p)
    by_place = -np.linalg.solve(jacobian.full(), model.parameter_jacobian(found.x, found.inputs, p).full())
    x, s = ca.MX.sym("x", model.size), model.parameters.symbol
    tip = model.tip["wire"](x, found.inputs, s)[0]
    at_equilibrium = ca.Function("tip", [x, s], [ca.jacobian(tip, x), ca.jacobian(tip, s)])
    with_x, with_s = (part.full() for part in at_equilibrium(found.x, p))
    response = (with_x @ by_place + with_s)[:, 0]
    step = 1e-4
    tips = [
        solve(resolved(model.parameters.set_in(model.scene, {name: p[0] + sign * step}))).tip("wire").position
        for sign in (1, -1)
    ]
    difference = (tips[0] - tips[1]).ravel() / (2 * step)
    assert_allclose(response, difference, rtol=1e-6, atol=1e-7 * np.abs(difference).max())


@pytest.mark.slow
def test_a_moved_place_keeps_the_rate_of_convergence() -> None:
    """Errors of the tip against many modes, at a place that a parameter has moved far."""
    values = {"poke.at": 0.62, "prod.at": 0.9}
    given, _ = CASES["places of loads"]
    scene = scene_from_dict({**given, "parameters": list(values)})

    def tip(modes: int) -> FloatArray:
        model = build(scene, discretise(scene, modes, 2 * modes + 4))
        return solve(model, parameters=values).tip("wire").position

    finest = tip(8)
    errors = [np.linalg.norm(tip(modes) - finest) for modes in (2, 3, 4, 5)]
    # Spectral: every further mode gains more than a digit, as on a grid that was made there.
    assert np.all(np.diff(np.log10(errors)) < -1.0)


def turned_platform(quaternion: FloatArray) -> dict[str, Any]:
    """The platform with a joint that turns it by a quaternion."""
    first, second = PLATFORM["joints"]
    return {"schema": 1, **PLATFORM, "joints": [{**first, "quaternion": quaternion.tolist()}, second]}


@pytest.fixture(scope="module")
def turnable() -> Model:
    """A platform whose first joint turns it by a parameter."""
    return resolved(scene_from_dict({**turned_platform(np.eye(4)[0]), "parameters": ["joints[0].quaternion"]}))


@pytest.mark.parametrize("degrees", mostly_slow([0.0, 20.0, 190.0], quick=[190.0]))
def test_a_joint_is_at_one_pose_by_either_sign_of_a_parameter(degrees: float, turnable: Model) -> None:
    """The pose of the scene with these numbers; residual, Jacobian and second derivatives do not tell the sign."""
    half = np.radians(degrees) / 2
    quaternion = np.array([np.cos(half), 0.6 * np.sin(half), 0.0, 0.8 * np.sin(half)])
    wanted = solve(build(scene_from_dict(turned_platform(quaternion)), turnable.discretisation))
    found = [solve(turnable, parameters={"joints[0].quaternion": own}) for own in (quaternion, -quaternion)]
    for own in found:
        assert own.converged
        assert_allclose(own.body("plate").position, wanted.body("plate").position, rtol=0, atol=1e-9)
        assert_allclose(own.body("plate").rotation, wanted.body("plate").rotation, rtol=0, atol=1e-9)
    x, inputs = point(turnable)[0], turnable.pack()
    signs = np.concatenate([np.ones(turnable.size), -np.ones(4)])
    for function, factor in (
        (turnable.residual, 1.0),
        (turnable.jacobian, 1.0),
        (turnable.parameter_jacobian, -1.0),
        (second_derivatives(turnable, inputs), np.outer(signs, signs)),
    ):
        near, far = (ca.DM(function.call([x, inputs, own])[0]).full() for own in (quaternion, -quaternion))
        assert_allclose(far, factor * near, rtol=1e-12, atol=1e-12 * np.abs(near).max())


def second_derivatives(model: Model, inputs: FloatArray) -> ca.Function:
    """Those of the sum of squares of the residual with x and p, as a function of x, inputs that are not read, and p."""
    x, given, p = ca.MX.sym("x", model.size), ca.MX.sym("inputs", len(inputs)), model.parameters.symbol
    squares = ca.sumsqr(model.residual(x, inputs, p))
    return ca.Function("second", [x, given, p], [ca.hessian(squares, ca.vertcat(x, p))[0]])


def test_derivatives_are_finite_where_a_parameter_turns_a_joint_by_half_a_turn(turnable: Model) -> None:
    inputs = turnable.pack()
    given = [point(turnable)[0], inputs, np.array([0.0, 0.6, 0.0, 0.8])]
    for function in (turnable.jacobian, turnable.parameter_jacobian, second_derivatives(turnable, inputs)):
        assert np.all(np.isfinite(ca.DM(function.call(given)[0]).full()))


def test_axes_that_keep_planar_rods_in_their_plane_are_refused() -> None:
    planar = {"length": 0.8, "strain": "planar", "stiffness": {"bending_y": 1.0}, "linear_density": 0.1}
    across = {"body": "plate", "kind": "revolute", "axis": [0, 1, 0]}
    given = {
        "schema": 1,
        "rods": [{**planar, "name": "left"}, {**planar, "name": "right", "base": {"position": [0.2, 0, 0]}}],
        "bodies": [{"name": "plate", "mass": 0.1}],
        "joints": [
            {**across, "rod": "left"},
            {"body": "plate", "kind": "prismatic", "axis": [1, 0, 0], "rod": "right", "position": [0.2, 0, 0]},
        ],
        "loads": [WEIGHT],
        "inputs": [],
    }
    names = ["joints[0].axis", "joints[1].position", "joints[1].quaternion"]
    with pytest.raises(SceneError, match="keeps planar rods in their plane") as refused:
        build(scene_from_dict({**given, "parameters": names}))
    assert [problem.where for problem in refused.value.problems] == [names[0], names[2]]


def with_kind(load: LoadRecord, rod: dict[str, Any], *parameters: str) -> Scene:
    """A scene of one rod with a load of a kind that does not ship."""
    scene = with_loads({"schema": 1, "rods": [rod]}, load, inputs=())
    return scene.model_copy(update={"parameters": parameters})


def test_coefficients_of_loads_that_depend_on_poses() -> None:
    with registered():
        dipole = DipoleRecord(
            name="magnet", kind="dipole", rod="wire", at=1.0, dipole=(0.1, 0.0, 0.3), gradient=0.4, field=(0.2, 0.1, 0)
        )
        model = build(with_kind(dipole, WIRE, "magnet.gradient", "magnet.field.x", "wire.length"))
        values = {"magnet.gradient": 0.9, "magnet.field.x": -0.3, "wire.length": 0.7}
        x, _, _, inputs, _ = point(model)
        p = model.parameters.pack(values)
        bound = model.at(values)
        assert_allclose(model.residual(x, inputs, p).full(), bound.residual(x, inputs).full(), rtol=1e-12, atol=1e-13)
        wanted = bound.jacobian(x, inputs)[0].full()
        assert_allclose(model.jacobian(x, inputs, p)[0].full(), wanted, rtol=1e-11, atol=1e-13 * np.abs(wanted).max())
        assert np.abs(model.parameter_jacobian(x, inputs, p).full()).max(axis=0).min() > 1e-3


def test_what_is_bound_to_the_unloaded_rod_follows_parameters_that_move_it() -> None:
    with registered():
        bed = BedRecord(name="bed", kind="bed", rod="wire", strength=20.0)
        moving = build(with_kind(bed, WIRE, "wire.intrinsic.curvature", "wire.length", "wire.base.position"))
        curvature = [[0.0, 0.1], [0.9, 0.0], [0.2, 0.0]]
        values = {"wire.intrinsic.curvature": curvature, "wire.length": 0.9, "wire.base.position": [0.1, 0.2, -0.1]}
        bound = moving.at(values)
        x, _, _, inputs, _ = point(bound)
        p = moving.parameters.pack(values)
        assert_allclose(moving.residual(x, inputs, p).full(), bound.residual(x, inputs).full(), rtol=1e-12, atol=1e-14)
        # The unloaded rod lies in its bed, whatever its curvature, and wherever it is.
        assert np.abs(moving.residual(np.zeros(bound.size), inputs, p).full()).max() < 1e-13


def test_what_is_bound_to_an_unloaded_rod_refuses_parameters_that_move_its_carrier() -> None:
    bed = {"name": "bed", "kind": "foundation", "rod": "arm", "stiffness": [20.0, 10.0, 0.0]}
    arm = {**WIRE, "name": "arm", "base": {"rod": "wire", "at": 1.0}}
    scene = {"schema": 1, "rods": [WIRE, arm], "loads": [bed], "inputs": []}
    with pytest.raises(SceneError, match="holds to the place of the unloaded rod"):
        _ = build(scene_from_dict({**scene, "parameters": ["wire.length"]})).residual
    own = build(scene_from_dict({**scene, "parameters": ["arm.base.position"]}))
    values = {"arm.base.position": [0.1, 0.0, 0.2]}
    bound = own.at(values)
    x = point(bound)[0]
    wanted = bound.residual(x, bound.pack()).full()
    assert_allclose(own.residual(x, own.pack(), own.parameters.pack(values)).full(), wanted, rtol=1e-12, atol=1e-13)


def test_the_literal_system_takes_parameters() -> None:
    values = {"wire.length": 0.9, "wire.intrinsic.curvature.x": 0.5, "wire.material.youngs_modulus": 1.8e9}
    scene = scene_from_dict({**tables(WIRE, *values), "accuracy": {"rotation": "permuted"}})
    model = build(scene, discretise(scene, 3, 8))
    bound = model.at(values)
    x, _, _, inputs, _ = point(model)
    p = model.parameters.pack(values)
    wanted = bound.residual(x, inputs).full()
    assert_allclose(model.residual(x, inputs, p).full(), wanted, rtol=1e-12, atol=1e-13 * np.abs(wanted).max())


def test_algorithms_take_the_values_of_the_scene_or_those_that_are_bound() -> None:
    scene = scene_from_dict({**tables(WIRE, "wire.material.youngs_modulus"), "inputs": ["push.force"]})
    model = build(scene, discretise(scene, 3, 8))
    baked = build(scene.baked(), model.discretisation)
    soft = model.at({"wire.material.youngs_modulus": 5e8})
    softer = solve(model, parameters=[5e8])
    assert softer.model is soft
    assert_allclose(solve(soft).x, softer.x, rtol=0, atol=0)
    assert_allclose(solve(model).x, solve(baked).x, rtol=0, atol=0)
    assert modes_of(softer).modes[0].frequency < modes_of(solve(model)).modes[0].frequency
    path = follow(soft, "push.force", [0.0, 0.0, -0.4])
    assert path.model is soft
    assert path.factor[-1] == 1.0
    assert softer.stable == solve(soft).stable
    # From a solution of the model with other parameters: unknowns mean the same.
    again = solve(model, start=softer)
    assert_allclose(again.x, solve(model).x, rtol=0, atol=1e-8)


@pytest.mark.parametrize("name", ["wire.material.poisson_ratio", "wire.section.shear_correction"])
def test_parameters_of_strains_that_a_rod_does_not_have(name: str) -> None:
    """They change nothing, and errors are estimated as without."""
    section = {"shape": "circle", "radius": 0.01, "shear_correction": 0.9}
    material = {"youngs_modulus": 2.0e9, "poisson_ratio": 0.3}
    rod = {"name": "wire", "length": 1.0, "strain": "planar", "material": material, "section": section}
    push = {"name": "push", "kind": "tip_wrench", "rod": "wire", "force": [3.0, 0.0, 0.0]}
    wanted = scene_from_dict({"schema": 1, "rods": [rod], "loads": [push], "parameters": [name]})
    model = build(wanted, discretise(wanted, 2, 4))
    ours, theirs = (solve(each, estimate_error=True) for each in (model, build(wanted.baked(), model.discretisation)))
    assert_allclose(ours.x, theirs.x, rtol=0, atol=1e-12)
    assert theirs.error_estimate is not None
    assert ours.error_estimate == pytest.approx(theirs.error_estimate, rel=1e-6)
