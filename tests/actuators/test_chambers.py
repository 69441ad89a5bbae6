"""Chambers that widen: moments and volumes by hand, Lamé's cylinder, ends of their laws, derivatives, C, refusals."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad
from scipy.optimize import brentq

from cosserat_casadi import (
    Compiled,
    MotionOutcome,
    Outcome,
    PathOutcome,
    SceneError,
    build,
    export,
    follow,
    identify,
    load,
    scene_from_dict,
    simulate,
    solve,
)
from cosserat_casadi.actuators.chamber import SMALL_STRAIN
from cosserat_casadi.scene import Scene
from tests.derivatives import central_differences
from tests.scenes import STIFFNESS, rod, scene

LENGTH = 0.8
CHAMBER = {"name": "chamber", "kind": "chamber", "rod": "rod", "pressure": 3e4, "area": 1e-4, "offset": [0.02, 0.01]}
GROWTH = {"area_growth": [0.3, 0.2], "offset_growth": [0.1], "reference_pressure": 2e4}
SHRINKING = {"area_growth": [0.3, -0.2], "reference_pressure": 2e4}
"""Without area at 6.217e4 Pa, where the ratio p/p₀ is (0.3 + √0.89)/0.4."""
WALL = {"inner_radius": 4e-3, "outer_radius": 6e-3, "youngs_modulus": 9e5, "poisson_ratio": 0.4}


def with_chamber(**changes: Any) -> Scene:
    given = {key: value for key, value in {**CHAMBER, **changes}.items() if value is not None}
    return scene(strain="reissner", actuators=[given], accuracy={"modes": 4, "nodes": 12})


def test_area_and_offset_grow_with_the_pressure() -> None:
    """Moment p A(p) D(p) and force p A(p), uniform: strains, and the volume that is left, by hand."""
    solution = solve(with_chamber(**GROWTH))
    ratio = 3e4 / 2e4
    area = 1e-4 * (1 + 0.3 * ratio + 0.2 * ratio**2)
    x, y = np.array([0.02, 0.01]) * (1 + 0.1 * ratio)
    force = 3e4 * area
    stretch = 1 + force / STIFFNESS["extension"]
    bending = force * y / STIFFNESS["bending_x"], -force * x / STIFFNESS["bending_y"]
    volume = area * LENGTH * (stretch + bending[0] * y - bending[1] * x)
    assert_allclose(solution.actuator("chamber")["volume"], volume, rtol=1e-10, atol=0)
    angle = LENGTH * np.hypot(*bending)
    rise = stretch * LENGTH * np.sin(angle) / angle
    assert_allclose(solution.tip().position[2], rise, rtol=1e-9, atol=0)


def test_a_wall_widens_as_an_elastic_cylinder() -> None:
    """Plane strain: u = C r + D/r, radial stress −p inside and none outside, as a linear system."""
    inner, outer, modulus, nu = 4e-3, 6e-3, 9e5, 0.4
    shear = modulus / (2 * (1 + nu))
    # σ_r = 2 G (C/(1 − 2ν) − D/r²).
    system = 2 * shear * np.array([[1 / (1 - 2 * nu), -1 / r**2] for r in (inner, outer)])
    uniform, inverse = np.linalg.solve(system, [-3e4, 0.0])
    radius = inner + uniform * inner + inverse / inner
    by_wall = solve(with_chamber(area=None, wall=WALL))
    by_area = solve(with_chamber(area=np.pi * radius**2))
    assert radius > 1.09 * inner
    assert_allclose(by_wall.tip().position, by_area.tip().position, rtol=0, atol=1e-9)
    held = solve(with_chamber(area=None, wall={**WALL, "reinforced": True}))
    plain = solve(with_chamber(area=np.pi * inner**2))
    assert_allclose(held.tip().position, plain.tip().position, rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    ("law", "end"),
    [
        (SHRINKING, 2e4 * (0.3 + np.sqrt(0.89)) / 0.4),
        # Where the strain by the linear system above is 0.1, blown up and sucked in.
        ({"area": None, "wall": WALL}, 0.1 * 9e5 * 20 / (1.4 * (0.2 * 16 + 36))),
        ({"area": None, "wall": WALL}, -0.1 * 9e5 * 20 / (1.4 * (0.2 * 16 + 36))),
    ],
)
def test_a_pressure_beyond_the_law_of_a_chamber_is_told(law: dict[str, Any], end: float) -> None:
    model = build(with_chamber(**law))
    assert solve(model, {"chamber.pressure": 0.99 * end}).converged
    beyond = solve(model, {"chamber.pressure": 1.01 * end})
    assert beyond.outcome is Outcome.BEYOND_MATERIAL
    assert "chamber 'chamber'" in beyond.message


@pytest.mark.parametrize("ratio", [1.02, 1.5, 3.0])
def test_a_wall_of_rubber_at_the_end_of_small_strains(ratio: float) -> None:
    """Pressure on a neo-Hookean tube that keeps its length, p = μ ∫ (λ² − λ⁻²) dr/r: it has 2 to 7 % more area."""

    def pressure(stretch: float) -> float:
        outer = np.sqrt(ratio**2 - 1 + stretch**2)
        squared = quad(lambda r: (r**2 / (r**2 - stretch**2 + 1) - 1 + (stretch**2 - 1) / r**2) / r, stretch, outer)
        return float(squared[0])

    wall = {"inner_radius": 1e-3, "outer_radius": ratio * 1e-3, "youngs_modulus": 3e5}
    model = build(with_chamber(area=None, wall=wall))
    # Of a modulus of 3 μ, without change of volume.
    small = SMALL_STRAIN * 2 * (1 - 1 / ratio**2)
    reached = brentq(lambda stretch: pressure(stretch) - small, 1.0, 1.3)
    linear = solve(model, {"chamber.pressure": 0.999 * small * 1e5})
    assert linear.converged
    # The pressure does not stretch the rod by 0.1 %.
    area = linear.actuator("chamber")["volume"] / (LENGTH * np.pi * 1e-6)
    assert 1.02 < reached**2 / area < 1.07


@pytest.mark.slow
def test_paths_motions_and_fits_that_leave_the_law_of_a_chamber_are_told() -> None:
    measured = {"quantity": "position", "file": "tips", "rod": "rod", "at": 1.0, "columns": ["x", "y", "z"]}
    tables = {
        "rods": [rod("reissner", rotary_inertia=[1e-3, 1e-3, 2e-3], damping={"retardation_time": 0.01})],
        "actuators": [{**CHAMBER, **SHRINKING}],
        "accuracy": {"modes": 2, "nodes": 8},
        "motions": [{"input": "chamber.pressure", "times": [0.0, 0.1], "values": [0.0, 7e4]}],
        "simulation": {"duration": 0.1, "step": 0.02},
        "measurements": [{**measured, "inputs": {"chamber.pressure": "p"}, "sigma": 1e-3}],
        "unknowns": [{"parameter": "chamber.offset.x"}],
    }
    given = scene(**tables)
    motion = simulate(given)
    assert motion.outcome is MotionOutcome.BEYOND_MATERIAL, motion.message
    path = follow(given, "chamber.pressure", 7e4)
    assert path.outcome is PathOutcome.BEYOND_MATERIAL, path.message
    columns = {"p": [2e4, 7e4], "x": [0.0, 0.1], "y": [0.0, 0.0], "z": [0.8, 0.8]}
    found = identify(build(given.with_unknowns()), {"tips": columns})
    assert (found.converged, found.outcome) == (False, "beyond_material")
    assert "chamber 'chamber'" in found.message


def test_derivatives_know_the_growth() -> None:
    model = build(with_chamber(**SHRINKING))
    solution = solve(model, {"chamber.pressure": 2e4})
    differences = central_differences(lambda pressure: model.residual(solution.x, pressure), [2e4], 1.0)
    assert_allclose(model.input_jacobian(solution.x, [2e4]).full(), differences, rtol=1e-6, atol=1e-12)


@pytest.mark.slow
def test_c_knows_the_growth(tmp_path: Path) -> None:
    model = build(with_chamber(**SHRINKING))
    solution = solve(model, {"chamber.pressure": 2e4})
    compiled = load(export(model, tmp_path / "arm", "arm"))
    assert isinstance(compiled, Compiled)
    assert_allclose(compiled.solve([2e4]).x, solution.x, rtol=0, atol=1e-9)
    statuses = [one.outcome for one in compiled.solve_batch(np.array([[6.3e4], [6.1e4]]))]
    assert statuses == [Outcome.BEYOND_MATERIAL, Outcome.CONVERGED]


def test_growth_is_a_parameter() -> None:
    tables = with_chamber(**GROWTH).model_dump(by_alias=True, exclude_unset=True)
    model = build(scene_from_dict({**tables, "parameters": ["chamber.area_growth[0]"]}))
    tables["actuators"][0]["area_growth"] = [0.5, 0.2]
    wanted = solve(scene_from_dict(tables)).tip().position
    assert_allclose(solve(model.at([0.5])).tip().position, wanted, rtol=0, atol=1e-9)


def test_a_chamber_that_keeps_its_size_costs_nothing() -> None:
    plain = build(with_chamber())
    empty = build(with_chamber(area_growth=[], reference_pressure=2e4))
    assert plain.jacobian.n_instructions() == empty.jacobian.n_instructions()


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"area": None}, "actuators[0].area: missing"),
        ({"wall": WALL}, "actuators[0].wall: stands beside area"),
        ({"area_growth": [0.1]}, "actuators[0].reference_pressure: missing"),
        ({"reference_pressure": 1.0}, "actuators[0].reference_pressure: stands without"),
        ({"area": None, "wall": {**WALL, "outer_radius": 3e-3}}, "actuators[0].wall.outer_radius: must be larger"),
    ],
)
def test_chambers_that_cannot_be_are_refused(changes: dict[str, Any], sentence: str) -> None:
    with pytest.raises(SceneError) as refused:
        with_chamber(**changes)
    assert sentence in str(refused.value)
