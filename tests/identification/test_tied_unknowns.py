"""One unknown for several numbers of a scene, and unknown places and offsets of markers."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Scene, SceneError, build, identify, parse_scene, scene_from_dict, solve
from cosserat_casadi.identification import Identification
from cosserat_casadi.scene.writing import scene_text
from tests.scenes import push, rod

SIGMA = 1e-4
MODULI = ["left.material.youngs_modulus", "right.material.youngs_modulus"]
PUSHES = np.array([0.4, -0.3, 0.2])


def pair(*unknowns: dict[str, Any], moduli: tuple[float, float] = (2e9, 2e9), **changes: Any) -> Scene:
    """Two rods side by side, each pushed at its tip, which is measured."""
    rods = [
        rod(
            "planar",
            name=name,
            stiffness=None,
            linear_density=None,
            material={"youngs_modulus": modulus, "poisson_ratio": 0.3},
            section={"shape": "circle", "radius": radius},
            base={"position": [x, 0.0, 0.0]},
        )
        for name, modulus, radius, x in (("left", moduli[0], 5e-3, 0.0), ("right", moduli[1], 6e-3, 0.2))
    ]
    measured = [
        {
            "quantity": "position",
            "name": f"tip of {name}",
            "file": "tips",
            "inputs": {f"push_{name}.force.x": "F"},
            "rod": name,
            "columns": [f"{name}_{axis}" for axis in "xyz"],
            "sigma": SIGMA,
        }
        for name in ("left", "right")
    ]
    loads = [push(name=f"push_{name}", rod=name, force=[0.0, 0.0, 0.0]) for name in ("left", "right")]
    clean = [{key: value for key, value in table.items() if value is not None} for table in rods]
    tables = {"schema": 1, "accuracy": {"modes": 3, "nodes": 8}, "rods": clean, "loads": loads}
    return scene_from_dict({**tables, "measurements": measured, "unknowns": list(unknowns), **changes})


def tips(moduli: tuple[float, float], seed: int) -> dict[str, Any]:
    """Tips of rods of these moduli under the pushes, with noise."""
    rng = np.random.default_rng(seed)
    model = build(pair(moduli=moduli))
    columns: dict[str, list[float]] = {"F": PUSHES.tolist()}
    for force in PUSHES:
        loads = {f"push_{name}.force": [force, 0.0, 0.0] for name in ("left", "right")}
        solution = solve(model, loads)
        for name in ("left", "right"):
            noisy = solution.tip(name).position + rng.normal(0.0, SIGMA, 3)
            for axis, value in zip("xyz", noisy, strict=True):
                columns.setdefault(f"{name}_{axis}", []).append(float(value))
    return {"tips": columns}


def test_a_list_of_one_name_is_that_name() -> None:
    """Listed as a parameter and unknown as a list, it is one argument of the functions, not two."""
    scene = pair({"parameter": MODULI[:1], "lower": 1e8}, parameters=[MODULI[0]])
    assert scene.with_unknowns().parameters == (MODULI[0],)


def test_one_modulus_for_two_rods() -> None:
    scene = pair({"parameter": MODULI, "lower": 1e8, "upper": 1e11})
    model = build(scene.with_unknowns())
    assert model.parameters.names == (MODULI[0],)
    found = identify(model, tips((2.6e9, 2.6e9), 1))
    assert found.converged
    assert abs(found.shared[0] - 2.6e9) < 4 * found.sigma[0]
    # Two rods tell a modulus better than one of them does.
    alone = identify(build(pair({"parameter": MODULI[0]}).with_unknowns()), tips((2.6e9, 2e9), 1))
    assert found.sigma[0] < 0.95 * alone.sigma[0]
    fitted = found.fitted_scene(scene)
    moduli = [own.material.youngs_modulus for own in fitted.rods if own.material is not None]
    assert moduli == [found.shared[0], found.shared[0]]
    told = found.to_dict()["unknowns"][MODULI[0]]
    assert told["tied"] == [MODULI[1]]
    assert told["value"] == found.shared[0]


def test_numbers_that_differ_keep_their_ratio() -> None:
    """As the offsets of three tendons, of which the distance from the axis is unknown."""
    angles = np.pi / 6 + 2 * np.pi * np.arange(3) / 3
    names = [f"{name}.offset.{axis}" for name in ("a", "b", "c") for axis in "xy"]

    def robot(distance: float, **changes: Any) -> Scene:
        tendons = [
            {
                "name": name,
                "kind": "tendon",
                "rod": "rod",
                "tension": tension,
                "offset": [distance * np.cos(angle), distance * np.sin(angle)],
            }
            for name, tension, angle in zip("abc", (2.0, 0.5, 1.0), angles, strict=True)
        ]
        return scene_from_dict({"schema": 1, "rods": [rod()], "actuators": tendons, **changes})

    tied = build(robot(0.02, parameters=[names]))
    assert tied.parameters.names == ("a.offset.x",)
    solution = solve(tied, parameters={"a.offset.x": 0.03 * np.cos(angles[0])})
    other = solve(build(robot(0.03)))
    assert_allclose(solution.tip().position, other.tip().position, rtol=0, atol=1e-9)
    # Exact derivatives follow: one column for all six numbers.
    by_p = tied.residual.jacobian()(solution.x, solution.inputs, [0.02], 0)[2]
    assert by_p.shape == (tied.size, 1)


def test_ties_are_written_and_read() -> None:
    scene = pair({"parameter": MODULI}, parameters=[["left.section.radius"], "left.length"])
    assert parse_scene(scene_text(scene)) == scene
    assert scene.parameter_names() == ("left.section.radius", "left.length")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"parameters": [[MODULI[0], "right.section.radius"]]}, "is in m and cannot follow"),
        ({"parameters": [[MODULI[0], "right.material.density"]]}, "is not given in the scene"),
        ({"parameters": [["left.base.position", "right.length"]]}, "has 1 numbers and 'left.base.position' 3"),
        ({"parameters": [["left.base.position", "right.base.position"]]}, "is zero in the scene"),
        ({"parameters": [MODULI, MODULI[0]]}, "is listed twice"),
        ({"parameters": [[]]}, "must have at least one entry"),
        ({"parameters": [MODULI[0]], "unknowns": [{"parameter": MODULI}]}, "of parameters share numbers"),
        ({"unknowns": [{"parameter": MODULI}, {"parameter": MODULI[1]}]}, "is 'right.material.youngs_modulus' already"),
        ({"unknowns": [{"parameter": "measurements[0].scale"}]}, "of this measurement at or offset may be unknown"),
    ],
)
def test_ties_that_cannot_be_are_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(SceneError) as refused:
        pair(**changes)
    assert message in str(refused.value)


OFFSET = (0.004, 0.0, 0.015)
PLACE = 0.62


@pytest.fixture(scope="module")
def markers() -> Identification:
    """A stiffness, the offset of a marker at the tip, and the place of another along the rod, from six shapes."""
    columns = {"known": "k", "shifted": "s", "somewhere": "w"}
    measured = [
        {
            "quantity": "position",
            "name": name,
            "file": "shapes",
            "inputs": {"push.force.x": "F"},
            "rod": "rod",
            "at": at,
            "columns": [f"{letter}{axis}" for axis in "xyz"],
            "sigma": SIGMA,
        }
        for (name, letter), at in zip(columns.items(), (0.4, 1.0, 0.55), strict=True)
    ]
    unknowns = [
        {"parameter": "rod.stiffness.bending_y"},
        {"parameter": "shifted.offset.x"},
        {"parameter": "shifted.offset.z"},
        {"parameter": "somewhere.at", "lower": 0.4, "upper": 0.8},
    ]
    base = {
        "schema": 1,
        "accuracy": {"modes": 3, "nodes": 8},
        "rods": [rod("planar")],
        "loads": [push(force=[0, 0, 0])],
    }
    scene = scene_from_dict({**base, "measurements": measured, "unknowns": unknowns})
    truth = build(scene.model_copy(update={"unknowns": ()}))
    rng = np.random.default_rng(2)
    forces = np.linspace(-1.5, 1.5, 6)
    data: dict[str, list[float]] = {"F": forces.tolist()}
    for force in forces:
        solution = solve(truth, {"push.force": [force, 0.0, 0.0]})
        poses = solution.pose([0.4, 1.0, PLACE])
        poses.position[1] += poses.rotation[1] @ OFFSET
        for letter, position in zip(columns.values(), poses.position, strict=True):
            for axis, value in zip("xyz", position + rng.normal(0.0, SIGMA, 3), strict=True):
                data.setdefault(f"{letter}{axis}", []).append(float(value))
    return identify(build(scene.with_unknowns()), {"shapes": data})


def test_offsets_and_places_of_markers_are_found(markers: Identification) -> None:
    assert markers.converged
    assert_allclose(markers.shared, [1.4, OFFSET[0], OFFSET[2], PLACE], rtol=0, atol=4 * markers.sigma.max())
    assert (np.abs(markers.shared - [1.4, OFFSET[0], OFFSET[2], PLACE]) < 4 * markers.sigma).all()
    assert markers.rms() is not None
    assert markers.rms() < 1.3
    fitted = markers.fitted_scene()
    assert fitted.measurements[1].offset[2] == markers.shared[2]
    assert fitted.measurements[2].at == markers.shared[3]


def test_distances_are_told_by_marker(markers: Identification) -> None:
    told = markers.distances
    assert [(marker.measurement, marker.at, marker.rows) for marker in told] == [(0, 0.4, 6), (1, 1.0, 6), (2, 0.55, 6)]
    for marker in told:
        assert 0.5 * np.sqrt(3) * SIGMA < marker.rms < 2 * np.sqrt(3) * SIGMA
        assert marker.rms <= marker.largest
        assert np.linalg.norm(marker.mean) < 2 * SIGMA
    entry = markers.to_dict()["residual"]["by_measurement"]["shifted"]["markers"]
    assert entry[0]["rms"] == told[1].rms
