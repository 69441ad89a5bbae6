"""Rows of disks on rods, against the rod cut into rods with bodies, beams without mass, and exported C."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Scene, SceneError, build, export, load, modes_of, scene_from_dict
from cosserat_casadi.plots.scene_plot import plot_solution
from cosserat_casadi.scene.writing import scene_text
from tests.equilibria import solve
from tests.model.test_assembly import rod

FINE = {"modes": 6, "nodes": 9}
ROW: dict[str, Any] = {"name": "spacers", "rod": "a", "at": [0.3, 0.7], "mass": 0.3, "radius": 0.2, "thickness": 0.1}
INERTIA = [0.3 * (3 * 0.2**2 + 0.1**2) / 12] * 2 + [0.3 * 0.2**2 / 2]
WEIGHT = {"name": "w", "kind": "gravity", "acceleration": [1.0, 0.5, -3.0]}
PUSH = {"name": "p", "kind": "tip_wrench", "rod": "a", "force": [0.2, 0.1, -0.3]}


def scene(*rows: dict[str, Any], **more: Any) -> Scene:
    tables = {"schema": 1, "accuracy": FINE, "rods": [rod("a", 1.0, "reissner")], "disks": list(rows), **more}
    return scene_from_dict(tables)


def cut() -> Scene:
    """The same with a rod for each stretch and a body for each disk."""
    rods = [
        rod("a", 0.3, "reissner"),
        rod("b", 0.4, "reissner", base={"rod": "a"}),
        rod("c", 0.3, "reissner", base={"rod": "b"}),
    ]
    bodies = [{"name": name, "mass": 0.3, "inertia": INERTIA} for name in ("lower", "upper")]
    joints = [{"kind": "fixed", "body": "lower", "rod": "a"}, {"kind": "fixed", "body": "upper", "rod": "b"}]
    loads = [WEIGHT, {**PUSH, "rod": "c"}]
    tables = {"schema": 1, "accuracy": FINE, "rods": rods, "bodies": bodies, "joints": joints, "loads": loads}
    return scene_from_dict(tables)


@pytest.mark.slow
def test_a_rod_with_disks_vs_the_rod_cut_into_rods_with_bodies() -> None:
    one, three = solve(build(scene(ROW, loads=[WEIGHT, PUSH]))), solve(build(cut()))
    assert one.converged
    assert three.converged
    assert one.model.size + 26 == three.model.size
    assert_allclose(one.tip("a").position, three.tip("c").position, rtol=0, atol=1e-6)
    assert_allclose(one.pose(0.3, "a").position, three.body("lower").position, rtol=0, atol=1e-6)
    frequencies = modes_of(one).angular_frequencies[:5]
    assert_allclose(frequencies, modes_of(three).angular_frequencies[:5], rtol=1e-5, atol=0)


def test_frequencies_vs_masses_on_a_beam_without_mass() -> None:
    """Flexibility a² (3 b − a)/(6 EI) of a cantilever, a ≤ b, in every textbook: eigenvalues of its product with m."""
    mass, count = 0.2, 4
    beam = {"name": "a", "length": 1.0, "strain": "planar", "stiffness": {"bending_y": 1.3}}
    row = {"rod": "a", "count": count, "mass": mass, "radius": 1e-9}
    places = np.arange(1, count + 1) / count
    near, far = np.minimum.outer(places, places), np.maximum.outer(places, places)
    flexibility = near**2 * (3 * far - near) / (6 * 1.3)
    expected = np.sort(1 / np.sqrt(np.linalg.eigvalsh(flexibility * mass)))
    frequencies = modes_of(scene(row, rods=[beam])).angular_frequencies
    assert_allclose(frequencies[:count], expected, rtol=1e-9, atol=0)


def test_numbers_of_disks_as_parameters() -> None:
    """Mass, radius and a place of a row: what a scene with these numbers has."""
    names = ["spacers.mass", "spacers.radius", "spacers.at[0]"]
    values = dict(zip(names, (0.5, 0.1, 0.4), strict=True))
    solution = solve(build(scene(ROW, loads=[WEIGHT], parameters=names)), parameters=values)
    changed = {**ROW, "mass": 0.5, "radius": 0.1, "at": [0.4, 0.7]}
    there = solve(build(scene(changed, loads=[WEIGHT])))
    assert solution.converged
    assert_allclose(solution.tip().position, there.tip().position, rtol=0, atol=1e-6)
    assert_allclose(
        modes_of(solution).angular_frequencies[:4], modes_of(there).angular_frequencies[:4], rtol=1e-5, atol=0
    )


@pytest.mark.slow
def test_digits_of_c(tmp_path: Path) -> None:
    few = {"modes": 2, "nodes": 5}
    model = build(scene(ROW, rods=[rod("a", 1.0, "planar")], loads=[WEIGHT, PUSH], accuracy=few))
    compiled = load(export(model, tmp_path / "disks", "disks"))
    assert_allclose(compiled.solve().x, solve(model).x, rtol=0, atol=1e-10)


def test_two_bodies_on_one_section_vs_one_that_has_both() -> None:
    """At rest and in modes; a pin holds a tip on which a body rides."""
    masses, centres = np.array([0.3, 0.2]), np.array([[0.1, 0.0, 0.05], [-0.05, 0.1, 0.0]])
    moments = [np.diag([0.01, 0.02, 0.03]), np.diag([0.02, 0.01, 0.01])]
    centre = masses @ centres / masses.sum()
    arms = centres - centre
    together = sum(
        own + mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
        for mass, arm, own in zip(masses, arms, moments, strict=True)
    )
    pairs = [
        {"name": name, "mass": mass, "centre_of_mass": point.tolist(), "inertia": own.tolist()}
        for name, mass, point, own in zip("xy", masses.tolist(), centres, moments, strict=True)
    ]
    one = {"name": "x", "mass": 0.5, "centre_of_mass": centre.tolist(), "inertia": np.array(together).tolist()}
    pin = {"rod": "a", "kind": "pinned", "position": [0.1, 0.0, 0.95]}
    found = []
    for bodies in (pairs, [one]):
        joints = [{"kind": "fixed", "body": body["name"], "rod": "a"} for body in bodies]
        found.append(solve(build(scene(bodies=bodies, joints=joints, supports=[pin], loads=[WEIGHT]))))
    assert found[0].converged
    assert_allclose(found[0].x, found[1].x, rtol=0, atol=1e-10)
    frequencies = [modes_of(solution, count=8).angular_frequencies for solution in found]
    assert_allclose(*frequencies, rtol=1e-9, atol=0)


def test_figure_shows_the_rims() -> None:
    """Of the first disk: all points of both faces as far from its centre as a corner is, square to the tangent."""
    solution = solve(build(scene(ROW, loads=[WEIGHT])))
    (first,) = [line for line in plot_solution(solution).axes[0].get_lines() if line.get_label() == "spacers"]
    rim = np.array(first.get_data_3d()).T
    centre = solution.pose(0.3).position
    tangent = solution.pose(0.3).rotation[:, 2]
    assert_allclose(np.linalg.norm(rim - centre, axis=1), np.hypot(0.2, 0.05), rtol=1e-12, atol=0)
    assert_allclose(np.abs((rim - centre) @ tangent), 0.05, rtol=0, atol=1e-12)


def test_text_of_a_row() -> None:
    written = scene(ROW)
    assert scene_text(written) == scene_text(scene_from_dict(written.model_dump(by_alias=True, exclude_unset=True)))
    assert scene({**ROW, "at": [0.5, 1.0]}).disks[0].places == scene(_counted(2)).disks[0].places


def _counted(count: int) -> dict[str, Any]:
    return {**{key: value for key, value in ROW.items() if key != "at"}, "count": count}


@pytest.mark.parametrize(
    ("changes", "where", "problem"),
    [
        ({"count": 3}, "disks[0].count", "stands beside at"),
        ({"at": [0.5, 0.5]}, "disks[0].at[1]", "must be > 0.5, the place before it, got 0.5"),
        ({"at": [0.0, 0.5]}, "disks[0].at[0]", "must be > 0 and <= 1, got 0.0"),
        ({"rod": "b"}, "disks[0].rod", "no rod is named 'b'"),
        ({"radius": 0.0}, "disks[0].radius", "must be > 0, got 0.0"),
    ],
)
def test_refusals(changes: dict[str, Any], where: str, problem: str) -> None:
    with pytest.raises(SceneError) as refused:
        scene({**ROW, **changes})
    assert [(one.where, one.problem) for one in refused.value.problems] == [(where, problem)]


def test_a_row_of_absurdly_many_disks_is_refused() -> None:
    with pytest.raises(SceneError, match=r"disks\[0\]\.count: must be <= 1000, got 1000000"):
        scene(_counted(1000000))
    with pytest.raises(SceneError, match=r"disks\[0\]\.at: must have at most 1000 entries, got 1001"):
        scene({**ROW, "at": np.linspace(0.1, 1.0, 1001).tolist()})
