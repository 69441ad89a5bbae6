"""Numbers of every law, of chambers and of muscles are found from made-up shapes, within their intervals.

Those of stress that relaxes are found from paths, in test_measured_motions.py.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Identification, build, identify, scene_from_dict, solve
from cosserat_casadi.model.materials import LAWS
from tests.families import mostly_slow

NOISE = 2e-5
"""Standard deviation of positions, m."""

SECTIONS = np.linspace(0.25, 1.0, 4)

FINGER: dict[str, Any] = {
    "name": "rod",
    "length": 0.2,
    "strain": ["bending_y", "extension"],
    "section": {"shape": "rectangle", "width": 8e-3, "height": 6e-3},
}
WIRE: dict[str, Any] = {**FINGER, "length": 0.03, "strain": "planar", "section": {"shape": "circle", "radius": 4e-4}}
SILICONE = {"youngs_modulus": 1.2e6, "poisson_ratio": 0.5}
CHAMBER = {"name": "own", "kind": "chamber", "rod": "rod", "pressure": 0.0, "offset": [-2e-3, 0.0]}
MUSCLE = {"name": "own", "kind": "muscle", "rod": "rod", "activation": 1.0, "moment": [0, 2e-3, 0], "force": [0, 0, 1]}

PULLED = {"push.force.z": [2.0, 8.0, 18.0, 30.0, 45.0], "push.force.x": [0.05, 0.0, 0.0, 0.3, 0.0]}
BENT = {"push.force.z": [2.0, 5.0, 9.0, -9.0, 0.0], "push.moment.y": [0.0, 3e-3, 6e-3, 0.0, -9e-3]}
PLATEAU = {"push.moment.y": [0.01, 0.025, 0.03, 0.032, 0.035, 0.038, 0.045, 0.055]}
BLOWN = {"own.pressure": [4e3, 8e3, 1.2e4, 1.6e4, 2e4]}
MADE_UP: dict[str, tuple[dict[str, Any], dict[str, list[float]], dict[str, float]]] = {
    "linear": ({}, BENT, {"rod.material.youngs_modulus": 1.1e6}),
    "polynomial": (
        {"law": "polynomial", "terms": [{"bending_y": 4, "coefficient": 1e-7}, {"extension": 3, "coefficient": 0.0}]},
        BENT,
        {
            "rod.material.youngs_modulus": 1.3e6,
            "rod.material.terms.0.coefficient": 3e-7,
            "rod.material.terms.1.coefficient": 5.0,
        },
    ),
    "neo_hookean": ({"law": "neo_hookean"}, PULLED, {"rod.material.youngs_modulus": 1.1e6}),
    "mooney_rivlin": (
        {"law": "mooney_rivlin", "c10": 0.15e6, "c01": 0.05e6},
        PULLED,
        {"rod.material.youngs_modulus": 1.1e6, "rod.material.c01": 0.08e6},
    ),
    "yeoh": (
        {"law": "yeoh", "c1": 0.2e6, "c2": 0.01e6, "c3": 1e3},
        PULLED,
        {"rod.material.youngs_modulus": 1.1e6, "rod.material.c2": 0.02e6, "rod.material.c3": 2e3},
    ),
    "ogden": (
        {"law": "ogden", "ogden": [[0.4e6, 2.0]]},
        PULLED,
        {"rod.material.youngs_modulus": 1.1e6, "rod.material.ogden.0.1": 2.6},
    ),
    "superelastic": (
        {"law": "superelastic", "youngs_modulus": 6e10, "plateau_start": 0.011, "plateau_end": 0.05}
        | {"plateau_modulus": 5e9, "end_modulus": 3e10},
        PLATEAU,
        {
            "rod.material.youngs_modulus": 5.5e10,
            "rod.material.plateau_start": 0.012,
            "rod.material.plateau_end": 0.045,
            "rod.material.plateau_modulus": 4e9,
            "rod.material.end_modulus": 2.5e10,
        },
    ),
    "chamber": (
        {**CHAMBER, "area": 8e-6, "area_growth": [0.0, 0.0], "reference_pressure": 1e4},
        BLOWN,
        {"own.offset.0": -2.2e-3, "own.area_growth.0": 0.2, "own.area_growth.1": 0.1},
    ),
    "chamber with a wall": (
        {**CHAMBER, "wall": {"inner_radius": 1.5e-3, "outer_radius": 2.5e-3, "youngs_modulus": 6e5}},
        BLOWN,
        {"own.offset.0": -1.8e-3, "own.wall.youngs_modulus": 5e5},
    ),
    "muscle": (
        {**MUSCLE, "profile": [1.0, 0.0, 0.0]},
        {"own.activation": [0.5, 1.0, -1.0]},
        {"own.moment.y": 2.2e-3, "own.force.z": 1.3, "own.profile.1": -0.3, "own.profile.2": 0.2},
    ),
}
"""What is beside a linear rod, values of the inputs of each case, and true numbers, by law or actuator."""


def identified(name: str, seed: int = 3) -> Identification:
    """The numbers that noisy positions of four sections give; the identification begins at other numbers."""
    own, inputs, truth = MADE_UP[name]
    of_material = "kind" not in own
    rod = WIRE if name == "superelastic" else FINGER
    tables: dict[str, Any] = {
        "schema": 1,
        "accuracy": {"modes": 4, "nodes": 10},
        "rods": [{**rod, "material": {**SILICONE, **(own if of_material else {})}}],
        "loads": [{"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0, 0, 0], "moment": [0, 0, 0]}],
        "actuators": [] if of_material else [own],
        "parameters": list(truth),
    }
    model = build(scene_from_dict(tables)).at(truth)
    rng = np.random.default_rng(seed)
    rows = []
    for values in zip(*inputs.values(), strict=True):
        given: dict[str, Any] = dict(zip(inputs, values, strict=True))
        if of_material:
            vectors = ("push.force", "push.moment")
            given = {vector: [given.get(f"{vector}.{axis}", 0.0) for axis in "xyz"] for vector in vectors}
        solution = solve(model, given, raise_on_failure=True)
        positions = solution.pose(SECTIONS).position
        positions += NOISE * rng.standard_normal(positions.shape)
        rows += [[*values, X, x, z] for X, (x, _, z) in zip(SECTIONS, positions, strict=True)]
    columns = dict(zip([*inputs, "X", "x", "z"], np.array(rows).T, strict=True))
    measured = {"quantity": "position", "file": "made_up.csv", "rod": "rod", "at": "X", "columns": ["x", "", "z"]}
    measured |= {"inputs": {key: key for key in inputs}, "sigma": NOISE}
    unknown = {"measurements": [measured], "unknowns": [{"parameter": parameter} for parameter in truth]}
    del tables["parameters"]
    return identify(build(scene_from_dict({**tables, **unknown}).with_unknowns()), {"made_up.csv": columns})


@pytest.mark.parametrize("name", mostly_slow(MADE_UP, quick=["polynomial"]))
def test_numbers_are_found_within_their_intervals(name: str) -> None:
    found = identified(name)
    assert found.converged, found.message
    truth = np.array([MADE_UP[name][2][label] for label in found.labels])
    assert np.abs((found.shared - truth) / found.sigma).max() < 3.5
    assert np.all(found.sigma < 0.1 * np.abs(truth))
    # The scene that is written has the law that was found, whatever its coefficients are in proportion to.
    bent = {"push.force": [0.1, 0.0, 6.0], "push.moment": [0.0, 1e-3, 0.0]}
    of_scene = solve(build(found.fitted_scene(found.model.scene)).at(), bent, raise_on_failure=True)
    of_model = solve(found.model.at(found.parameters), bent, raise_on_failure=True)
    assert_allclose(of_scene.tip().position, of_model.tip().position, rtol=0, atol=1e-9)


def test_every_law_with_numbers_is_made_up() -> None:
    """A measured curve has none."""
    assert set(LAWS) - {"table"} <= set(MADE_UP)
