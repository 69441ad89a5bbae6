"""Chambers that widen: moments and volumes by hand, Lamé's cylinder, derivatives, C, refusals."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Compiled, SceneError, build, export, load, scene_from_dict, solve
from cosserat_casadi.scene import Scene
from tests.scenes import STIFFNESS, scene

LENGTH = 0.8
CHAMBER = {"name": "chamber", "kind": "chamber", "rod": "rod", "pressure": 3e4, "area": 1e-4, "offset": [0.02, 0.01]}
GROWTH = {"area_growth": [0.3, 0.2], "offset_growth": [0.1], "reference_pressure": 2e4}
WALL = {"inner_radius": 4e-3, "outer_radius": 6e-3, "youngs_modulus": 3e5, "poisson_ratio": 0.4}


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
    assert_allclose(solution.tip().position[0, 2], rise, rtol=1e-9, atol=0)


def test_a_wall_widens_as_an_elastic_cylinder() -> None:
    """Plane strain: u = C r + D/r, radial stress −p inside and none outside, as a linear system."""
    inner, outer, modulus, nu = 4e-3, 6e-3, 3e5, 0.4
    shear = modulus / (2 * (1 + nu))
    # σ_r = 2 G (C/(1 − 2ν) − D/r²).
    system = 2 * shear * np.array([[1 / (1 - 2 * nu), -1 / r**2] for r in (inner, outer)])
    uniform, inverse = np.linalg.solve(system, [-3e4, 0.0])
    radius = inner + uniform * inner + inverse / inner
    by_wall = solve(with_chamber(area=None, wall=WALL))
    by_area = solve(with_chamber(area=np.pi * radius**2))
    assert radius > 1.1 * inner
    assert_allclose(by_wall.tip().position, by_area.tip().position, rtol=0, atol=1e-9)
    held = solve(with_chamber(area=None, wall={**WALL, "reinforced": True}))
    plain = solve(with_chamber(area=np.pi * inner**2))
    assert_allclose(held.tip().position, plain.tip().position, rtol=0, atol=1e-12)


def test_derivatives_and_c_know_the_growth(tmp_path: Path) -> None:
    model = build(with_chamber(**GROWTH))
    solution = solve(model, {"chamber.pressure": 2e4})
    step = 1.0
    up, down = (model.residual(solution.x, [2e4 + sign * step]).full() for sign in (1, -1))
    by_pressure = model.input_jacobian(solution.x, [2e4]).full()
    assert_allclose(by_pressure, (up - down) / (2 * step), rtol=1e-6, atol=1e-12)
    compiled = load(export(model, tmp_path / "arm", "arm"))
    assert isinstance(compiled, Compiled)
    assert_allclose(compiled.solve([2e4]).x, solution.x, rtol=0, atol=1e-9)


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
