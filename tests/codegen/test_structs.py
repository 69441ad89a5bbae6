"""Inputs and results by name, in C: the same numbers as in the vectors of Python."""

from __future__ import annotations

import re
from collections.abc import Callable
from importlib.metadata import version

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Outcome
from cosserat_casadi.codegen.status import OUTCOMES, status_words
from tests.codegen.libraries import QUICK, Exported, Recipe, run
from tests.scenes import push, rod, scene

Library = Callable[[str], Exported]


@pytest.mark.parametrize("name", ["planar", "pair", "tendons", "robot"])
def test_names_lead_to_the_numbers_of_python(library: Library, name: str) -> None:
    made = library(name)
    versions, inputs, results, derivatives = run(made.program("structs.c", *QUICK)).splitlines()
    assert versions == version("cosserat-casadi")
    assert_allclose(np.array(inputs.split(), dtype=float), made.model.pack(), rtol=0, atol=0)
    solved = made.compiled.solve()
    model, at = made.model, (solved.x, made.model.pack())
    poses = [
        np.concatenate([v.full().ravel() for v in f(*at)[:2]]) for f in (*model.tip.values(), *model.body.values())
    ]
    efforts = [float(value) for f in model.actuator.values() for value in f(*at)[:2]]
    assert_allclose(np.array(results.split(), dtype=float), np.concatenate([*poses, efforts]), rtol=1e-9, atol=1e-10)
    sensitivity, bodies = made.compiled.sensitivity(*reversed(at)), made.compiled.body_sensitivity(*reversed(at))
    assert sensitivity is not None
    assert bodies is not None
    wanted = np.concatenate([d_pose.ravel() for d_pose in (*sensitivity[1].values(), *bodies.values())])
    assert_allclose(np.array(derivatives.split(), dtype=float), wanted, rtol=1e-12, atol=1e-12)


def test_members_of_the_structs_are_in_the_order_of_the_vectors(library: Library) -> None:
    """Each input's member has its macro's size; the results name every pose, effort and conjugate."""
    header = (library("tendons").folder / "tendons.h").read_text()
    inputs = re.search(r"typedef struct \{\n([^}]*)\} tendons_inputs;", header)
    results = re.search(r"typedef struct \{\n([^}]*)\} tendons_results;", header)
    assert inputs is not None
    assert results is not None
    assert re.findall(r"tendons_real (\w+)\[TENDONS_INPUT_(\w+)_SIZE\]", inputs[1]) == [
        (name, name.upper()) for name in ("push_force", "pull_tension", "held_length", "gas_pressure")
    ]
    members = re.findall(r"(\w+);", results[1])
    assert members == [
        "tip",
        "tension_pull",
        "length_pull",
        "tension_held",
        "length_held",
        "pressure_gas",
        "volume_gas",
    ]


def test_every_outcome_is_a_status_in_the_order_of_python(library: Library) -> None:
    """Enumerators, sentences and words follow from the outcomes: a new one is written in Python alone."""
    made = library("planar")
    header = (made.folder / "planar.h").read_text()
    enumerators = re.findall(r"^  PLANAR_(\w+) += (\d+),? +/\* (.*) \*/$", header, re.M)
    assert enumerators == [(o.name, str(i), o.value) for i, o in enumerate(OUTCOMES)]
    # Those of contact, and of concentric tubes, come after all others.
    assert tuple(Outcome) == (*OUTCOMES, Outcome.CONTACT_UNSETTLED, Outcome.OUT_OF_RANGE)
    words = status_words(made.names)
    for outcome in OUTCOMES:
        assert f"case PLANAR_{outcome.name}:" in words["label_cases"]
        assert f'return "{outcome.label}";' in words["label_cases"]
        assert f"#define SOLVER_{outcome.name} PLANAR_{outcome.name}" in words["status_names"]


def test_header_says_which_polynomials_the_unknowns_belong_to(export_recipe: Callable[..., Exported]) -> None:
    recipe = Recipe(scene(push(), rods=[rod("planar", basis="chebyshev")]), 2, 4)
    header = (export_recipe("basis", recipe).folder / "basis.h").read_text()
    assert "Chebyshev coefficients of bending_y" in header
    assert "Legendre" not in header
