"""Magnets in fields: closed forms, other formulations of the same load, refusals."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, SceneError, build, scene_from_dict
from cosserat_casadi.loads.load import Poses
from cosserat_casadi.loads.load_trace import traced
from cosserat_casadi.model.arrow_records import DRAWN_SECTIONS, LoadArrows
from cosserat_casadi.model.registry import EFFECTS
from tests.derivatives import central_differences
from tests.equilibria import solve
from tests.reference.rods import rotation_from_quaternion
from tests.scenes import rod, scene

FEW = {"modes": 3, "nodes": 8}
SOURCE = np.array([0.35, -0.2, 0.9])
SOURCE_MOMENT = np.array([30.0, 20.0, -45.0])


def magnet(**changes: Any) -> dict[str, Any]:
    plain = {"name": "magnet", "kind": "magnet", "rod": "rod", "magnetisation": [0.0, 0.0, 6.0]}
    return {**plain, **changes}


def dipole_field(place: np.ndarray, source: np.ndarray, moment: np.ndarray) -> np.ndarray:
    """B of a dipole, by the angle between the moment and the line to the place."""
    apart = place - source
    distance = np.linalg.norm(apart)
    unit = apart / distance
    return 1e-7 / distance**3 * (3 * unit * (unit @ moment) - moment)


def residual(model: Model, x: np.ndarray) -> np.ndarray:
    return np.asarray(model.residual(x, model.pack()).full())


@pytest.mark.parametrize("strain", ["planar", "kirchhoff"])
def test_axial_magnetisation_in_a_uniform_field_is_a_dead_tip_force(strain: str) -> None:
    """Of a rod that does not stretch: the energy −∫ m t·B is −m B·(tip − base), in any shape."""
    field = np.array([0.3, 0.1, -0.2])
    magnetic = build(scene(magnet(field=field.tolist()), strain=strain, accuracy=FEW))
    pulled = {"name": "pull", "kind": "tip_wrench", "rod": "rod", "force": (6.0 * field).tolist()}
    dead = build(scene(pulled, strain=strain, accuracy=FEW))
    for seed in range(3):
        x = np.random.default_rng(seed).standard_normal(magnetic.size)
        assert_allclose(residual(magnetic, x), residual(dead, x), rtol=1e-12, atol=1e-12)
        expected = dead.jacobian(x, dead.pack())[0].full()
        found = magnetic.jacobian(x, magnetic.pack())[0].full()
        assert_allclose(found, expected, rtol=0, atol=1e-11 * np.abs(expected).max())


def test_equilibrium_in_a_uniform_field_vs_a_dead_tip_force() -> None:
    field = [0.1, 0.05, -0.1]
    magnetic = solve(build(scene(magnet(field=field), accuracy=FEW)))
    force = [6.0 * component for component in field]
    pull = {"name": "pull", "kind": "tip_wrench", "rod": "rod", "force": force}
    dead = solve(build(scene(pull, accuracy=FEW)))
    assert magnetic.stable is True
    assert dead.stable is True
    assert_allclose(magnetic.tip().position, dead.tip().position, rtol=0, atol=1e-9)
    assert_allclose(magnetic.tip().rotation, dead.tip().rotation, rtol=0, atol=1e-9)
    # A couple all along the rod, and no force.
    assert_allclose(magnetic.base_wrench().force, 0.0, rtol=0, atol=1e-12)
    assert_allclose(magnetic.base_wrench().moment, dead.base_wrench().moment, rtol=0, atol=1e-9)


def test_magnetisation_times_area_is_the_moment_per_length() -> None:
    radius = [5e-3, 3e-3]
    made = rod(
        material={"youngs_modulus": 2e8, "poisson_ratio": 0.4, "density": 1000.0},
        section={"shape": "circle", "radius": radius},
    )
    del made["stiffness"], made["linear_density"]
    along = {"magnetisation": [0.0, [0.0, 3e5], 8e4], "field": [0.02, 0.03, 0.01]}
    model = build(scene_from_dict({"schema": 1, "accuracy": FEW, "rods": [made], "loads": [magnet(**along)]}))
    grid = model.discrete.rods["rod"].grid
    area = np.pi * (5e-3 - 2e-3 * grid.nodes) ** 2
    local = np.array([0.0 * area, 3e5 * (2 * grid.nodes - 1) * area, 8e4 * area])
    x = 0.5 * np.random.default_rng(1).standard_normal(model.size)
    _, quaternion, _, _, base_moment = model.fields["rod"](x, model.pack())
    total = np.zeros(3)
    for k, weight in enumerate(model.discrete.rods["rod"].node_lengths):
        total += weight * np.cross(rotation_from_quaternion(quaternion.full()[:, k]) @ local[:, k], [0.02, 0.03, 0.01])
    assert_allclose(base_moment.full()[:, 0], -total, rtol=1e-12, atol=1e-15)


AT_TIP = {"magnetisation": None, "moment": [0.3, -0.2, 0.8]}


def with_tip_magnet(**field: Any) -> dict[str, Any]:
    load = {**magnet(**AT_TIP), **field}
    return {key: value for key, value in load.items() if value is not None}


FIELDS: dict[str, dict[str, Any]] = {
    "uniform": {"field": [0.4, 1.0, -0.6]},
    "gradient": {"gradient": [[1.0, 0.5, 0.2], [0.5, -3.0, 0.4], [0.2, 0.4, 2.0]]},
    "dipole": {"dipole": {"position": SOURCE.tolist(), "moment": (2e3 * SOURCE_MOMENT).tolist()}},
}
FIELDS["all"] = {key: value for field in FIELDS.values() for key, value in field.items()}


def field_at(place: np.ndarray, given: dict[str, Any]) -> np.ndarray:
    field = np.array(given.get("field", np.zeros(3))) + np.array(given.get("gradient", np.zeros((3, 3)))) @ place
    if "dipole" in given:
        field = field + dipole_field(place, SOURCE, 2e3 * SOURCE_MOMENT)
    return field


@pytest.mark.parametrize("name", FIELDS)
def test_force_and_moment_of_a_dipole_vs_differences_of_its_energy(name: str) -> None:
    given = FIELDS[name]
    solution = solve(build(scene(with_tip_magnet(**given), accuracy=FEW)))
    assert solution.converged
    tip = solution.tip()
    place, moment = tip.position, tip.rotation @ [0.3, -0.2, 0.8]
    (force,) = central_differences(lambda place: moment @ field_at(place, given), place, 2e-6)
    couple = np.cross(moment, field_at(place, given))
    base = solution.base_wrench()
    assert_allclose(base.force, -force, rtol=1e-8, atol=1e-8)
    assert_allclose(base.moment, -couple - np.cross(place, force), rtol=1e-8, atol=1e-8)


def test_force_between_dipoles_on_one_axis() -> None:
    """3 μ₀ m₁ m₂ / (2π d⁴), drawn together where both point along the axis."""
    source = {"position": [0.0, 0.0, 1.1], "moment": [0.0, 0.0, 500.0]}
    tables = scene(with_tip_magnet(moment=[0.0, 0.0, 2.0], dipole=source), accuracy=FEW)
    found = solve(build(tables))
    expected = 3 * 4e-7 * np.pi * 2.0 * 500.0 / (2 * np.pi * 0.3**4)
    assert_allclose(found.base_wrench().force, [0.0, 0.0, -expected], rtol=1e-12, atol=1e-12)


def test_a_source_that_moves_is_an_input() -> None:
    names = ["magnet.dipole.position", "magnet.dipole.moment"]
    source = {"position": SOURCE.tolist(), "moment": (2e3 * SOURCE_MOMENT).tolist()}
    free = build(scene(with_tip_magnet(dipole=source), accuracy=FEW, inputs=names))
    moved, turned = SOURCE + np.array([0.1, 0.05, 0.0]), 2e3 * SOURCE_MOMENT[::-1]
    elsewhere = {"position": moved.tolist(), "moment": turned.tolist()}
    fixed = build(scene(with_tip_magnet(dipole=elsewhere), accuracy=FEW, inputs=[]))
    assert [entry.unit for entry, _ in free.inputs] == ["m", "A m²"]
    inputs = free.pack(dict(zip(names, (moved, turned), strict=True)))
    x = 0.3 * np.random.default_rng(0).standard_normal(free.size)
    assert_allclose(free.residual(x, inputs).full(), residual(fixed, x), rtol=1e-13, atol=1e-13)
    by_inputs = free.input_jacobian(x, inputs).full()
    assert by_inputs.shape == (free.size, 6)
    assert np.abs(by_inputs).min(axis=0).max() > 0


def test_a_gradient_is_an_input_of_nine_numbers() -> None:
    given = FIELDS["gradient"]
    free = build(scene(with_tip_magnet(**given), accuracy=FEW, inputs=["magnet.gradient"]))
    fixed = build(scene(with_tip_magnet(**given), accuracy=FEW, inputs=[]))
    x = 0.3 * np.random.default_rng(0).standard_normal(free.size)
    assert free.inputs.size == 9
    assert_allclose(residual(free, x), residual(fixed, x), rtol=1e-13, atol=1e-13)
    # What a component along y gives to a gradient along z is the third number of the second row.
    changed = np.array(given["gradient"])
    changed[1, 2] += 1.0
    other = build(scene(with_tip_magnet(gradient=changed.tolist()), accuracy=FEW, inputs=[]))
    found = free.residual(x, free.pack({"magnet.gradient": changed})).full()
    assert_allclose(found, residual(other, x), rtol=1e-13, atol=1e-13)


def plate(load: dict[str, Any]) -> dict[str, Any]:
    return {
        "schema": 1,
        "accuracy": FEW,
        "rods": [rod()],
        "bodies": [{"name": "plate"}],
        "joints": [{"body": "plate", "rod": "rod", "kind": "fixed", "position": [0, 0, -0.1]}],
        "loads": [load],
    }


def test_a_magnet_on_a_body_vs_one_on_the_tip_that_holds_it() -> None:
    body = {"name": "magnet", "kind": "magnet", "body": "plate", "moment": [0.3, -0.2, 0.8], "position": [0, 0, -0.1]}
    # Weak enough that the source does not draw the body off while its joint is still limp.
    weak = {**FIELDS["all"], "dipole": {"position": SOURCE.tolist(), "moment": (4e2 * SOURCE_MOMENT).tolist()}}
    on_body = solve(build(scene_from_dict(plate({**body, **weak}))))
    on_tip = solve(build(scene(with_tip_magnet(**weak), accuracy=FEW)))
    assert on_body.converged
    assert_allclose(on_body.tip().position, on_tip.tip().position, rtol=0, atol=1e-10)
    assert_allclose(on_body.base_wrench().moment, on_tip.base_wrench().moment, rtol=0, atol=1e-9)


def test_what_a_field_does_not_have_costs_nothing() -> None:
    """In a uniform field the force is structurally zero, and so is all that the place of a section changes."""
    (load,) = scene(magnet(field=[0.1, 0.2, 0.3])).loads
    trace = traced(EFFECTS["magnet"], load, {"field": ca.DM([0.1, 0.2, 0.3])}, data_size=1)
    assert trace.kernel.wrench.nnz_out(0) == 0
    stiffness = np.array(ca.DM(trace.kernel.stiffness.sparsity_out(0), 1.0))
    assert np.count_nonzero(stiffness) == np.count_nonzero(stiffness[3:, 3:]) > 0
    assert trace.moving is None


def test_a_couple_all_along_is_drawn() -> None:
    """Without force along the rod its moment is drawn, where it is."""
    solution = solve(build(scene(magnet(field=[0.1, 0.05, -0.1]), accuracy=FEW)))

    def rod_poses(name: str, X: np.ndarray) -> Poses:
        pose = solution.pose(X, name)
        return pose.position.T, pose.rotation

    found = LoadArrows(solution.model.discrete, solution.inputs, rod_poses, lambda name: rod_poses(name, X)).all()
    X = DRAWN_SECTIONS
    expected = np.cross(6.0 * solution.pose(X).rotation[:, :, 2], [0.1, 0.05, -0.1])
    assert {arrow.sort for arrow in found} == {"moment"}
    assert_allclose([arrow.vector for arrow in found], expected, rtol=0, atol=1e-12)
    largest = np.linalg.norm(expected, axis=1).max()
    assert found[0].label == f"magnet: up to {largest:.3g} N m/m"


REFUSED: list[tuple[dict[str, Any], str]] = [
    ({}, r"field: missing \(give field, gradient or dipole\)"),
    ({"field": [0, 20, 0], "rod": None}, "rod: missing"),
    ({"field": [0, 2000.0, 0]}, r"field\[1\]: must be at most 100 T, got 2000"),
    ({"field": [0, 0.1, 0], "moment": [0, 0, 1]}, "moment: stands beside magnetisation"),
    ({"field": [0, 0.1, 0], "magnetisation": [0, 0, 0]}, "magnetisation: must not be zero"),
    ({"field": [0, 0.1, 0], "magnetisation": None}, r"magnetisation: missing \(give magnetisation or moment\)"),
    ({"field": [0, 0.1, 0], "magnetisation": None, "moment": [0, 0, 0]}, "moment: must not be zero"),
    ({"field": [0, 0.1, 0], "at": 0.5}, "at: stands without moment"),
    ({"field": [0, 0.1, 0], "position": [0, 0, 0.1]}, "position: is a point of a body"),
    ({"dipole": {"position": [0, 0, 2], "moment": [0, 0, 0]}}, "dipole.moment: must not be zero"),
    ({"gradient": [[0, 0, 1], [0, 0]]}, "gradient: must be a list of 3 rows"),
    ({"field": [0, 0.1, 0], "rod": "reed"}, "rod: no rod is named 'reed'"),
]


@pytest.mark.parametrize(("changes", "told"), REFUSED)
def test_refusals(changes: dict[str, Any], told: str) -> None:
    table = {key: value for key, value in magnet(**changes).items() if value is not None}
    with pytest.raises(SceneError, match=told):
        scene(table)


def test_a_source_inside_the_rod_is_refused() -> None:
    source = {"position": [0.0, 0.0, 0.31], "moment": [0.0, 0.0, 1.0]}
    with pytest.raises(SceneError, match=r"magnet.dipole.position: lies inside the unloaded rod 'rod'"):
        build(scene(magnet(dipole={**source, "position": [0.0, 0.0, 0.4]})))
    made = rod(
        material={"youngs_modulus": 2e8, "poisson_ratio": 0.4, "density": 1000.0},
        section={"shape": "circle", "radius": 0.01},
    )
    del made["stiffness"], made["linear_density"]
    tables = {"schema": 1, "rods": [made], "loads": [magnet(dipole={**source, "position": [0.009, 0.0, 0.31]})]}
    with pytest.raises(SceneError, match="inside the unloaded rod"):
        build(scene_from_dict(tables))
    tables["loads"] = [magnet(dipole={**source, "position": [0.011, 0.0, 0.31]})]
    build(scene_from_dict(tables))
    outside = build(scene_from_dict({**tables, "inputs": [], "parameters": ["magnet.dipole.position"]}))
    with pytest.raises(SceneError, match="inside the unloaded rod"):
        outside.at({"magnet.dipole.position": [0.009, 0.0, 0.31]})
