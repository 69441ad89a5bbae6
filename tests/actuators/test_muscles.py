"""Muscles: constant strains by hand, the moment of a tip that follows, waves that travel, a swimmer's speed."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.polynomial import legendre
from numpy.testing import assert_allclose
from scipy.integrate import quad, solve_ivp
from scipy.interpolate import CubicSpline
from scipy.linalg import expm
from scipy.special import j0

from cosserat_casadi import SceneError, build, scene_from_dict, simulate
from cosserat_casadi.model.required_modes import signal_modes
from cosserat_casadi.motion.moving_inputs import MovingInputs
from cosserat_casadi.scene import Scene
from tests.derivatives import central_differences
from tests.equilibria import solve
from tests.scenes import STIFFNESS, push, rod, scene

MUSCLE = {"name": "muscle", "kind": "muscle", "rod": "rod", "moment": [0.0, 0.6, 0.0]}
WAVE = {"input": "muscle.profile", "amplitude": 0.7, "frequency": 2.0, "wave": "travelling", "wavelength": 0.6}


def with_muscle(*loads: dict[str, Any], strain: str = "reissner", **changes: Any) -> Scene:
    return scene(*loads, strain=strain, actuators=[{**MUSCLE, **changes}], accuracy={"modes": 6, "nodes": 16})


def test_a_uniform_muscle_makes_uniform_strains() -> None:
    """Strains are stress over stiffness, the stress of a force beside the axis included; the rod is a screw."""
    moment, force, offset = np.array([0.1, 0.3, 0.05]), np.array([0.0, 0.4, 2.0]), np.array([0.02, -0.01, 0.0])
    solution = solve(with_muscle(activation=0.7, moment=moment.tolist(), force=force.tolist(), offset=[0.02, -0.01]))
    stress = 0.7 * np.concatenate([moment + np.cross(offset, force), force])
    strain = stress / np.array(list(STIFFNESS.values())) + np.array([0, 0, 0, 0, 0, 1])
    x, y, z = strain[:3]
    twist = np.zeros((4, 4))
    twist[:3, :3] = [[0, -z, y], [z, 0, -x], [-y, x, 0]]
    twist[:3, 3] = strain[3:]
    assert_allclose(solution.tip().position, expm(0.8 * twist)[:3, 3], rtol=1e-9, atol=1e-12)
    work = 0.8 * (stress / 0.7) @ strain
    assert_allclose(solution.actuator("muscle")["work"], work, rtol=1e-9, atol=0)


@pytest.mark.parametrize("strain", ["reissner", "planar"])
def test_a_muscle_whose_moment_is_zero_does_nothing(strain: str) -> None:
    force = push(force=[0.5, 0.0, 0.3])
    with_one = solve(with_muscle(force, strain=strain, moment=[0.0, 0.0, 0.0], activation=0.7))
    without = solve(scene(force, strain=strain, accuracy={"modes": 6, "nodes": 16}))
    assert_allclose(with_one.tip().position, without.tip().position, rtol=0, atol=1e-12)
    assert with_one.actuator("muscle")["work"] == 0.0


def test_a_uniform_moment_in_a_plane_is_a_moment_that_follows_the_tip() -> None:
    follower = {"name": "turn", "kind": "tip_wrench", "rod": "rod", "moment": [0.0, 0.6, 0.0], "frame": "body"}
    force = push(force=[0.5, 0.0, 0.3])
    by_muscle = solve(with_muscle(force, strain="planar"))
    by_moment = solve(scene(force, follower, strain="planar", accuracy={"modes": 6, "nodes": 16}))
    assert_allclose(by_muscle.tip().position, by_moment.tip().position, rtol=0, atol=1e-9)


def test_a_muscle_of_stiffness_times_curvature_is_an_unloaded_curvature() -> None:
    """In space, under a load, with a profile that varies: K κ₀(X) in the stress is K κ₀(X) in the energy."""
    curvature = [1.5, 0.4, -0.3]
    curved = rod(intrinsic={"curvature": [0.0, {"legendre": curvature}, 0.0]})
    wanted = solve(scene(push(), rods=[curved], accuracy={"modes": 8, "nodes": 20}))
    active = [{**MUSCLE, "moment": [0.0, STIFFNESS["bending_y"], 0.0], "profile": curvature}]
    found = solve(scene(push(), actuators=active, accuracy={"modes": 8, "nodes": 20}))
    assert_allclose(found.tip().position, wanted.tip().position, rtol=0, atol=1e-9)


TAPERED = {
    "name": "rod",
    "length": 0.3,
    "strain": "kirchhoff",
    "material": {"youngs_modulus": 1.2e6, "poisson_ratio": 0.4, "density": 1000.0},
    "section": {"shape": "circle", "radius": {"base": 8e-3, "tip": 5e-3}},
    "damping": {"retardation_time": 0.2},
}
CURVED = {"name": "muscle", "kind": "muscle", "rod": "rod", "curvature": [0.0, 2.0, 1.0], "profile": [1.5, 0.4, -0.3]}
TIP_LOAD = {"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0.02, 0.03, 0.01]}


def curved(at_once: bool, **more: Any) -> Scene:
    """A tapered rod of an unloaded curvature that a muscle has, or the rod itself."""
    profile = np.array(CURVED["profile"])
    own = [0.0, {"legendre": (2.0 * profile).tolist()}, {"legendre": profile.tolist()}]
    rods = [{**TAPERED, "intrinsic": {"curvature": own}} if at_once else TAPERED]
    tables = {"schema": 1, "accuracy": {"modes": 6, "nodes": 12}, "rods": rods, "loads": [TIP_LOAD]}
    return scene_from_dict({**tables, "actuators": [] if at_once else [CURVED], **more})


def test_the_curvature_of_a_muscle_is_an_unloaded_curvature() -> None:
    """Of a tapered rod under a load, with the modulus that a parameter gives; over time it goes there from straight."""
    named = {"parameters": ["rod.material.youngs_modulus"]}
    softer = {"rod.material.youngs_modulus": 0.7e6}
    wanted, found = (solve(build(curved(at_once, **named)).at(softer)) for at_once in (True, False))
    assert_allclose(found.tip().position, wanted.tip().position, rtol=0, atol=1e-9)
    ramp = {"input": "muscle.activation", "times": [0.0, 0.2], "values": [0.0, 1.0], "interpolation": "cubic"}
    course = {"duration": 3.0, "times": [0.0, 3.0], "tolerance": 1e-3}
    motion = simulate(build(curved(False, motions=[ramp], simulation=course).with_motion_inputs(), moving=True))
    assert motion.converged, motion.message
    begin, end = motion.tip("rod").position
    assert np.abs(end - begin).max() > 0.05
    assert_allclose(end, solve(build(curved(True))).tip().position, rtol=0, atol=1e-6)


@pytest.mark.parametrize(
    "rod_table",
    [
        {**TAPERED, "material": {"law": "neo_hookean", "youngs_modulus": 1.2e6, "density": 1000.0}},
        {"name": "rod", "length": 0.3, "strain": "planar", "stiffness_matrix": [[1.0]]},
    ],
)
def test_the_curvature_of_a_muscle_is_refused_beside_a_law(rod_table: dict[str, Any]) -> None:
    with pytest.raises(SceneError, match=r"curvature: is for a rod with one stiffness for each strain"):
        scene_from_dict({"schema": 1, "rods": [rod_table], "actuators": [CURVED]})


def test_values_at_knots_are_those_of_a_spline() -> None:
    """The curvature is moment over stiffness times SciPy's spline, wherever elements end, and the tip its integral."""
    knots, values = [0.0, 0.3, 0.45, 1.0], [0.2, 1.5, -0.4, 0.8]
    curvature = 0.6 / STIFFNESS["bending_y"]
    turned = CubicSpline(knots, curvature * np.array(values), bc_type="clamped").antiderivative()
    tables = with_muscle(strain="planar", profile=values, knots=knots).model_dump(by_alias=True, exclude_unset=True)
    solution = solve(scene_from_dict({**tables, "accuracy": {"tolerance": 1e-6}}))
    x, _ = quad(lambda X: 0.8 * np.sin(0.8 * turned(X)), 0.0, 1.0, epsabs=1e-12)
    z, _ = quad(lambda X: 0.8 * np.cos(0.8 * turned(X)), 0.0, 1.0, epsabs=1e-12)
    assert_allclose(solution.tip().position, [x, 0.0, z], rtol=0, atol=1e-6)
    # The same numbers as parameters, with nodes that one of them moves.
    tables["parameters"] = ["muscle.profile[1]", "muscle.span.end"]
    (muscle,) = tables["actuators"]
    tables["actuators"] = [{**muscle, "profile": [0.2, 0.0, -0.4, 0.8], "span": [0.0, 0.9]}]
    model = build(scene_from_dict(tables)).at({"muscle.profile[1]": 1.5, "muscle.span.end": 0.7})
    tables |= {"actuators": [{**muscle, "span": [0.0, 0.7]}], "parameters": []}
    shorter = solve(build(scene_from_dict(tables)))
    assert_allclose(solve(model).tip().position, shorter.tip().position, rtol=0, atol=1e-10)


@pytest.mark.parametrize("knots", [None, [0.0, 0.2, 1.0]])
def test_a_profile_may_be_free(knots: list[float] | None) -> None:
    """Value and derivative are those of scenes with these numbers."""
    at_knots = {} if knots is None else {"knots": knots}
    tables = with_muscle(push(), profile=[1.0, 0.2, 0.0], **at_knots).model_dump(by_alias=True, exclude_unset=True)
    model = build(scene_from_dict({**tables, "inputs": ["muscle.profile", "muscle.activation"]}))
    inputs = np.array([0.4, -0.3, 0.5, 0.9])
    solution = solve(model, inputs)
    tables["actuators"][0].update(profile=[0.4, -0.3, 0.5], activation=0.9)
    assert_allclose(solution.tip().position, solve(scene_from_dict(tables)).tip().position, rtol=0, atol=1e-10)
    differences = central_differences(lambda given: model.residual(solution.x, given), inputs, 1e-4)
    assert_allclose(model.input_jacobian(solution.x, inputs).full(), differences, rtol=0, atol=1e-9)


@pytest.mark.parametrize("wavelength", [0.6, -1.3])
@pytest.mark.parametrize("envelope", [1.0, [0.5, 0.3, -0.2]])
def test_a_wave_travels_along_the_rod(wavelength: float, envelope: Any) -> None:
    tables = with_muscle(profile=[0.3, -0.1]).model_dump(by_alias=True, exclude_unset=True)
    motion = {**WAVE, "phase": 0.4, "wavelength": wavelength, "envelope": envelope}
    model = build(scene_from_dict({**tables, "motions": [motion]}).with_motion_inputs())
    moving = MovingInputs(model.inputs, model.scene.motions, model.pack())
    X = np.linspace(0, 1, 41)
    x = 2 * X - 1
    for t in (0.0, 0.13, 0.9):
        state = moving.at(t)
        series = state.value[model.inputs.slices["muscle.profile"]]
        angle = 2 * np.pi * (2.0 * t - X / wavelength) + 0.4
        wanted = 0.3 - 0.1 * x + 0.7 * legendre.legval(x, np.atleast_1d(envelope)) * np.sin(angle)
        assert_allclose(legendre.legval(x, series), wanted, rtol=0, atol=1e-10)
        step = 1e-6
        rate = (moving.at(t + step).value - moving.at(t - step).value) / (2 * step)
        assert_allclose(state.rate, rate, rtol=0, atol=1e-7)


ALONG, ACROSS = 1.0, 2.0
"""Resistances of the swimmer's water, Pa s."""


def resistive_force_path(curvature: float, waves: int, times: list[float]) -> np.ndarray:
    """Places z + i x of the middle of the swimmer at ``times``, m, by resistive-force theory of its prescribed shape.

    The drag of the shape's motion and of a rigid motion has no force and no moment: three equations at each time give
    the rigid motion. Inertia is left out; the amplitude is any.
    """
    length = 0.1
    nodes, weights = legendre.leggauss(16 + 16 * waves)
    series = legendre.legfit(nodes, np.eye(len(nodes)), len(nodes) - 1)
    primitives = length / 2 * legendre.legint(series, lbnd=-1)
    integrals, to_middle = (legendre.legval(x, primitives).T for x in (nodes, 0.0))
    number = 2 * np.pi * waves / length
    lag = number * length * (1 + nodes) / 2

    def shape(t: float) -> tuple[np.ndarray, np.ndarray]:
        """Angles from that of the base, and their rates: of the curvature c sin(2πt - lag), grown in half a second."""
        u = min(2 * t, 1.0)
        grown, growth = u**2 * (3 - 2 * u), 12 * u * (1 - u)
        begin, angle = 2 * np.pi * t, 2 * np.pi * t - lag
        wave = curvature / number * (np.cos(angle) - np.cos(begin))
        wave_rate = -2 * np.pi * curvature / number * (np.sin(angle) - np.sin(begin))
        return grown * wave, growth * wave + grown * wave_rate

    def motion(t: float, state: np.ndarray) -> np.ndarray:
        """Rates of z, x and angle of the base."""
        angle, turning = shape(t)
        tangent = np.exp(1j * angle)
        arm = integrals @ tangent

        def drag(velocity: np.ndarray) -> list[float]:
            local = velocity * tangent.conj()
            force = (ALONG * local.real + 1j * ACROSS * local.imag) * tangent
            total = weights @ force
            return [total.real, total.imag, weights @ (arm.conj() * force).imag]

        one = np.ones_like(tangent)
        rigid = np.transpose([drag(of) for of in (one, 1j * one, 1j * arm)])
        z, x, turn = np.linalg.solve(rigid, -np.array(drag(integrals @ (1j * turning * tangent))))
        velocity = (z + 1j * x) * np.exp(1j * state[2])
        return np.array([velocity.real, velocity.imag, turn])

    course = solve_ivp(motion, (0.0, times[-1]), np.zeros(3), "DOP853", t_eval=times, rtol=1e-7, atol=1e-9)
    middle = np.array([to_middle @ np.exp(1j * shape(t)[0]) for t in times])
    return course.y[0] + 1j * course.y[1] + middle * np.exp(1j * course.y[2])


def swimmer(curvature: float, waves: int = 1) -> dict[str, Any]:
    body = rod(
        "planar",
        length=0.1,
        stiffness={"bending_y": 1.0},
        linear_density=1e-4,
        rotary_inertia=[1e-9, 1e-9, 2e-9],
        damping={"retardation_time": 1e-4},
        base={"free": True},
    )
    water = {"name": "water", "kind": "flow", "density": 1000.0, "diameter": 1e-3, "normal": 0.0, "tangential": 0.0}
    water |= {"added_mass": 0.0, "normal_resistance": ACROSS, "tangential_resistance": ALONG}
    return {
        "schema": 1,
        "accuracy": {"tolerance": 1e-6},
        "simulation": {"duration": 2.0, "times": [0.0, 1.0, 2.0], "start": "unloaded"},
        "rods": [body],
        "loads": [water],
        "actuators": [{**CURVED, "curvature": [0.0, curvature, 0.0], "profile": [0.0], "activation": 0.0}],
        "motions": [
            {"input": "muscle.activation", "times": [0.0, 0.5], "values": [0.0, 1.0], "interpolation": "cubic"},
            {**WAVE, "amplitude": 1.0, "frequency": 1.0, "wavelength": 1.0 / waves},
        ],
    }


def strokes(curvature: float, waves: int, times: list[float], tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """Ways z + i x of the swimmer's middle between ``times``, m: of the simulation and of the theory."""
    course = {"duration": times[-1], "times": [0.0, *times], "start": "unloaded"}
    tables = {**swimmer(curvature, waves), "accuracy": {"tolerance": tolerance}, "simulation": course}
    motion = simulate(scene_from_dict(tables))
    assert motion.converged, motion.message
    place = motion.section("rod", [0.5]).position[1:, 0]
    return np.diff(place[:, 2] + 1j * place[:, 0]), np.diff(resistive_force_path(curvature, waves, times))


STEEP = 2 * np.pi / 0.1
"""Curvature, 1/m, of a wave as long as the swimmer whose slope swings between -1 and 1 rad."""


@pytest.mark.slow
def test_a_steep_wave_swims() -> None:
    """Its middle goes forth, and to and fro with the yaw, as the theory says."""
    found, wanted = strokes(STEEP, 1, [0.5, 0.75, 1.0], 1e-3)
    assert_allclose(found, wanted, rtol=2e-3, atol=0)


@pytest.mark.slow
@pytest.mark.parametrize(("curvature", "waves"), [(8.0, 1), (STEEP, 1), (1.6 * STEEP, 1), (2 * STEEP, 2)])
def test_a_wave_of_any_amplitude_swims_at_the_speed_of_resistive_force_theory(curvature: float, waves: int) -> None:
    found, wanted = strokes(curvature, waves, [1.0, 2.0], 1e-4)
    assert_allclose(found, wanted, rtol=2e-3, atol=0)


def test_the_theory_of_many_waves_is_lighthills() -> None:
    """Speeds fall short of Lighthill's (SIAM Review 18, 1976) by the square of a wave's share of the rod."""
    speeds = []
    for waves in (2, 4, 8):
        (way,) = np.diff(resistive_force_path(waves * STEEP, waves, [1.0, 2.0]))
        speeds.append(abs(way) / (j0(1.0) * 0.1 / waves))
    straightness = (1 + j0(2.0)) / 2
    ratio = ALONG / ACROSS
    lighthill = (1 - ratio) * (1 - straightness) / (1 - straightness + ratio * straightness)
    short = 1 - np.array(speeds) / lighthill
    assert 0.0 < short[2] < 4e-3
    assert_allclose(short[:2] / short[1:], 4.0, rtol=2e-2, atol=0)


@pytest.mark.parametrize("moving_base", [False, True])
def test_energy_of_a_wave_is_its_work(moving_base: bool) -> None:
    wave = {**WAVE, "frequency": 0.5, "wavelength": 1.0}
    body = rod("planar", damping={"retardation_time": 0.02})
    shaken = {"input": "rod.base.position", "amplitude": [0.05, 0.0, 0.0], "frequency": 2.0, "wave": "one_minus_cosine"}
    motions = [wave, shaken] if moving_base else [wave]
    tables = {"schema": 1, "accuracy": {"tolerance": 1e-4}, "rods": [body], "actuators": [MUSCLE], "motions": motions}
    energy = simulate(scene_from_dict({**tables, "simulation": {"duration": 0.5, "start": "unloaded"}})).energy
    assert energy.dissipated[-1] > 1e-4
    assert_allclose(energy.imbalance, 0.0, rtol=0, atol=1e-2 * energy.dissipated[-1])


@pytest.mark.parametrize(
    ("motion", "sentence"),
    [
        ({"wavelength": 0.01}, "motions[0].wavelength: must be at least"),
        ({"wavelength": 0.0}, "motions[0].wavelength: must be at least"),
        ({"wavelength": None}, "motions[0].wavelength: missing"),
        ({"amplitude": [1.0, 0.0]}, "motions[0].amplitude: must have a number for each of 1 component"),
        ({"input": "muscle.activation"}, "motions[0].wave: travels along a rod, and muscle.activation has one value"),
        ({"wave": "sine"}, "motions[0].wavelength: is for a travelling wave"),
    ],
)
def test_waves_that_cannot_be_are_refused(motion: dict[str, Any], sentence: str) -> None:
    tables = with_muscle().model_dump(by_alias=True, exclude_unset=True)
    wave = {key: value for key, value in {**WAVE, **motion}.items() if value is not None}
    with pytest.raises(SceneError) as refused:
        scene_from_dict({**tables, "motions": [wave]})
    assert sentence in str(refused.value)


def test_a_muscle_without_moment_and_force_is_refused() -> None:
    with pytest.raises(SceneError, match="give force, moment or both"):
        scene(actuators=[{key: value for key, value in MUSCLE.items() if key != "moment"}])


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"knots": [0.0]}, "knots: must be at least 2 abscissae, got 1"),
        ({"knots": [0.0, 0.6, 0.5]}, "knots[2]: must be > 0.6, the knot before it, got 0.5"),
        ({"knots": [0.0, 0.5, 0.9]}, "knots: must reach over its span, 0 to 1, got 0 to 0.9"),
        ({"knots": [0.0, 1.0]}, "profile: must be a list of 2 values, one for each knot, got 3"),
        ({"profile": {"base": 1.0, "tip": 0.0}}, "profile: must be a list of 3 values, one for each knot"),
    ],
)
def test_knots_that_cannot_be_are_refused(changes: dict[str, Any], sentence: str) -> None:
    with pytest.raises(SceneError) as refused:
        with_muscle(**{"knots": [0.0, 0.5, 1.0], "profile": [1.0, 0.0, 1.0], **changes})
    assert sentence in str(refused.value)


def test_waves_and_parameters_leave_knots_alone() -> None:
    tables = with_muscle(profile=[1.0, 0.2], knots=[0.0, 1.0]).model_dump(by_alias=True, exclude_unset=True)
    with pytest.raises(SceneError, match=r"muscle\.profile has values at knots"):
        scene_from_dict({**tables, "motions": [WAVE]})
    with pytest.raises(SceneError, match="is where the values of profile stand"):
        scene_from_dict({**tables, "parameters": ["muscle.knots"]})


def test_a_free_rod_that_may_spin_without_inertia_is_refused() -> None:
    tables = swimmer(4.0)
    del tables["rods"][0]["rotary_inertia"]
    with pytest.raises(SceneError, match="nothing resists a spin of the rod"):
        scene_from_dict(tables)


def test_scenes_of_equal_waves_are_equal_after_use() -> None:
    first, second = (scene_from_dict(swimmer(4.0)) for _ in range(2))
    assert first.motions[1].degrees == second.motions[1].degrees
    assert first == second


def test_modes_see_the_wave_that_will_come() -> None:
    """A profile that is zero at rest asks for the modes of its wave, of degree π/wavelength and some more."""
    tables = with_muscle().model_dump(by_alias=True, exclude_unset=True)
    still = scene_from_dict(tables)
    moving = scene_from_dict({**tables, "motions": [{**WAVE, "wavelength": 0.3}]})
    assert signal_modes(still) < 4
    assert 10 < signal_modes(moving) < 20
