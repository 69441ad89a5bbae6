"""Rods in a fluid: drag by hand, closed forms of falling and vibrating rods, energy, refusals."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Motion, SceneError, build, modes_of, scene_from_dict, simulate, solve
from tests.scenes import rod, scene

FEW = {"modes": 4, "nodes": 10}
DENSITY = 1000.0
RADIUS = 4e-3
WATER = {"name": "water", "kind": "flow", "density": DENSITY, "normal": 1.2, "tangential": 0.05}
WEIGHT = {"name": "weight", "kind": "gravity", "acceleration": [0, 0, -9.81]}


def round_rod(**changes: Any) -> dict[str, Any]:
    made = rod(
        material={"youngs_modulus": 5e7, "poisson_ratio": 0.4, "density": 2500.0},
        section={"shape": "circle", "radius": RADIUS},
        **changes,
    )
    return {key: value for key, value in made.items() if key not in ("stiffness", "linear_density")}


def tables(*loads: dict[str, Any], **changes: Any) -> dict[str, Any]:
    plain: dict[str, Any] = {"schema": 1, "accuracy": FEW, "rods": [round_rod()], "loads": list(loads)}
    return {**plain, **changes}


def moved(given: dict[str, Any]) -> Motion:
    scene_of = scene_from_dict(given).with_motion_inputs()
    return simulate(build(scene_of, moving=True))


def test_force_of_a_stream_on_a_bent_rod_is_the_sum_of_its_drag() -> None:
    stream = np.array([0.5, 0.3, -0.2])
    model = build(scene_from_dict(tables({**WATER, "velocity": stream.tolist()})))
    found = solve(model)
    assert found.converged
    assert found.stable is None
    _, quaternion, _, base_force, _ = (field.full() for field in model.fields["rod"](found.x, found.inputs))
    total = np.zeros(3)
    for k, length in enumerate(model.discrete.rods["rod"].node_lengths):
        w, x, y, z = quaternion[:, k]
        tangent = np.array([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])
        along = (-stream @ tangent) * tangent
        across = -stream - along
        drag = 1.2 * np.linalg.norm(across) * across + np.pi * 0.05 * np.linalg.norm(stream) * along
        total += -length * DENSITY * RADIUS * drag
    assert np.abs(total).min() > 0.01
    assert_allclose(base_force[:, 0], -total, rtol=1e-9, atol=1e-12)


def test_derivatives_are_finite_where_nothing_moves() -> None:
    model = build(scene_from_dict(tables(WATER, inputs=["water.velocity"])))
    x, inputs = model.residual.mx_in()
    jacobian = model.jacobian(x, inputs)[0]
    second = ca.Function("s", [x, inputs], [ca.jacobian(jacobian, x), ca.jacobian(jacobian, inputs)])
    at_zero = np.zeros(model.size)
    assert all(np.all(np.isfinite(value.full())) for value in second(at_zero, model.pack()))
    assert model.has_potential(model.pack())
    assert not model.has_potential(model.pack({"water.velocity": [0.1, 0, 0]}))


def test_still_water_carries_what_it_displaces() -> None:
    """Buoyancy is a weight of the other sign, of the water in the place of the rod."""
    level = {"rods": [round_rod(base={"tangent": [1, 0, 0]})]}
    floating = solve(build(scene_from_dict(tables(WEIGHT, {**WATER, "gravity": [0, 0, -9.81]}, **level))))
    lighter = {**WEIGHT, "acceleration": [0, 0, -9.81 * (1 - DENSITY / 2500.0)]}
    light = solve(build(scene_from_dict(tables(lighter, **level))))
    assert floating.stable is True
    assert_allclose(floating.tip().position, light.tip().position, rtol=0, atol=1e-10)
    assert_allclose(floating.base_wrench().force, light.base_wrench().force, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize(
    ("axis", "resistance", "carried"),
    [([1, 0, 0], 1.2, DENSITY), ([0, 0, 1], np.pi * 0.05, 0.0)],
    ids=["across", "along"],
)
def test_a_straight_rod_sinks_to_its_terminal_velocity(axis: list[int], resistance: float, carried: float) -> None:
    """m dv/dt = (ρ_s − ρ) g π r² − ρ r C v²: v = v_t tanh(t/τ), τ = m v_t / weight; across, water moves along."""
    area = np.pi * RADIUS**2
    weight = (2500.0 - DENSITY) * 9.81 * area
    speed = np.sqrt(weight / (DENSITY * RADIUS * resistance))
    time = (2500.0 + carried) * area * speed / weight
    motion = moved(
        tables(
            WEIGHT,
            {**WATER, "gravity": [0, 0, -9.81]},
            accuracy={"modes": 1, "nodes": 4},
            rods=[round_rod(strain="planar", base={"position": [0, 0, 0], "tangent": axis, "free": True})],
            simulation={"duration": 5 * time, "frames": 11, "start": "unloaded", "tolerance": 1e-4},
        )
    )
    assert motion.converged, motion.message
    height = motion.tip().position[:, 2]
    fallen = speed * time * np.log(np.cosh(motion.times / time))
    assert_allclose(height - height[0], -fallen, rtol=0, atol=1e-5 * fallen[-1])


def test_added_mass_lowers_the_frequencies_of_bending() -> None:
    """ω² of a slender cantilever is β⁴ EI / ((μ + C_a ρ π r²) ℓ⁴); rotary inertia is small, bending has two planes."""
    dry = modes_of(solve(build(scene_from_dict(tables()))), count=4)
    wet = modes_of(solve(build(scene_from_dict(tables({**WATER, "added_mass": 0.7})))), count=4)
    lowered = 1 / np.sqrt(1 + 0.7 * DENSITY / 2500.0)
    ratios = wet.angular_frequencies[:3] / dry.angular_frequencies[:3]
    assert_allclose(ratios, lowered, rtol=2e-4, atol=0)
    length, bending = 0.8, 5e7 * np.pi / 4 * RADIUS**4
    density = np.pi * RADIUS**2 * (2500.0 + 0.7 * DENSITY)
    first = 1.8751040687**2 * np.sqrt(bending / (density * length**4))
    assert_allclose(wet.angular_frequencies[0], first, rtol=1e-3, atol=0)


def test_what_swings_in_water_loses_what_the_drag_takes() -> None:
    """Kinetic and elastic energy fall by the work of the fluid; its drag takes, its added mass gives back."""
    held = {"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0.05, 0.0, 0.0]}
    let_go = {"input": "push.force", "times": [0.0, 1e-3], "values": [[0.05, 0, 0], [0, 0, 0]]}
    swinging = tables(
        held,
        WATER,
        rods=[round_rod(strain="planar")],
        motions=[let_go],
        simulation={"duration": 0.5, "frames": 51, "tolerance": 1e-4},
    )
    motion = moved(swinging)
    assert motion.converged, motion.message
    assert np.abs(motion.energy.imbalance).max() < 1e-3
    total = motion.energy.kinetic + motion.energy.elastic
    assert total[-1] < 0.9 * total[0]


REFUSED: list[tuple[dict[str, Any], str]] = [
    ({"density": -1.0}, "density: must be > 0, got -1"),
    ({"velocity": [0.1, 0.2]}, "velocity: must be a list of 3 numbers"),
    ({"normal": -0.1}, "normal: must be >= 0"),
    ({"rods": ["reed"]}, r"rods\[0\]: no rod is named 'reed'"),
    ({"diameter": 0.0}, "diameter: must be > 0"),
]


@pytest.mark.parametrize(("changes", "told"), REFUSED)
def test_refusals(changes: dict[str, Any], told: str) -> None:
    with pytest.raises(SceneError, match=told):
        scene_from_dict(tables({**WATER, **changes}))


def test_a_rod_without_a_round_section_needs_a_diameter() -> None:
    with pytest.raises(SceneError, match=r"loads\[0\].diameter: missing: rod 'rod' has no round section"):
        scene(WATER)
    flat = round_rod(strain="kirchhoff")
    flat["section"] = {"shape": "rectangle", "width": 0.01, "height": 0.02}
    with pytest.raises(SceneError, match="has no round section"):
        scene_from_dict(tables(WATER, rods=[flat]))
    seen = build(scene_from_dict(tables({**WATER, "diameter": 0.02, "gravity": [0, 0, -9.81]}, rods=[flat])))
    # It displaces its own area.
    force = solve(seen).base_wrench().force
    assert_allclose(force, [0, 0, -DENSITY * 2e-4 * 0.8 * 9.81], rtol=1e-9, atol=1e-12)
