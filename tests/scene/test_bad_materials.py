"""Materials that are refused: where, what, and what to do."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from cosserat_casadi import SceneError, build, scene_from_dict

MODULI = {"youngs_modulus": 1.2e6, "poisson_ratio": 0.4}


def scene(material: dict[str, Any] | None, section: str = "circle", **more: Any) -> Any:
    sizes = {"circle": {"radius": 2e-3}, "rectangle": {"width": 4e-3, "height": 2e-3}}[section]
    made_of = {} if material is None else {"material": material, "section": {"shape": section, **sizes}}
    return scene_from_dict(
        {"schema": 1, "rods": [{"name": "a", "length": 0.1, "strain": "reissner", **made_of, **more}]}
    )


def table(**curves: Any) -> dict[str, Any]:
    return {"law": "table", **MODULI, "table": curves}


def polynomial(*terms: dict[str, Any]) -> dict[str, Any]:
    return {"law": "polynomial", **MODULI, "terms": list(terms)}


PLATEAU = {"law": "superelastic", **MODULI, "plateau_start": 0.01, "plateau_end": 0.05, "plateau_modulus": 1e5}

REFUSED = {
    "law": ({"law": "rubber", **MODULI}, "material.law", "must be one of 'linear', 'table'"),
    "no_ratio": ({"youngs_modulus": 1.0}, "material.poisson_ratio", "missing"),
    "both_ratios": ({"law": "neo_hookean", **MODULI, "shear_modulus": 1.0}, "shear_modulus", "stands beside"),
    "falls": (table(torsion=[[1, 2], [2, 1]]), "torsion[1][1]", "must be >= 2"),
    "turns": (table(torsion=[[2, 1], [1, 2]]), "torsion[1][0]", "must be > 2"),
    "no_zero": (table(torsion=[[-1, -1], [2, 1]]), "torsion", "point [0, 0]"),
    "loaded": (table(torsion=[[0, 1], [2, 3]]), "torsion[0][1]", "must be 0"),
    "flat": (table(torsion=[[1, 0], [2, 3]]), "torsion[0][1]", "must be > 0"),
    "point": (table(torsion=[[1, 2, 3]]), "torsion[0]", "2 numbers"),
    "empty": (table(), "material.table", "has no curve"),
    "no_points": (table(torsion=[]), "table.torsion", "has no point of a strain above 0"),
    "zero_alone": (table(torsion=[[0, 0]]), "table.torsion", "has no point of a strain above 0"),
    "negative_alone": (table(torsion=[[-1, -1], [0, 0]]), "table.torsion", "has no point of a strain above 0"),
    "signed": (table(bending=[[-1, -1], [0, 0]]), "bending[0][0]", ">= 0"),
    "twice": (table(bending=[[1, 1]], bending_x=[[1, 1]]), "bending_x", "stands beside bending"),
    "linear_term": (polynomial({"torsion": 1, "coefficient": 1.0}), "terms[0]", "at least 2"),
    "power": (polynomial({"torsion": 0, "coefficient": 1.0}), "terms[0].torsion", ">= 1"),
    "no_terms": (polynomial(), "material.terms", "at least one"),
    "modulus": (
        {"law": "mooney_rivlin", "youngs_modulus": 1e6, "c10": 0.1e6, "c01": 0.0},
        "material.youngs_modulus",
        "600000 Pa",
    ),
    "yeoh_modulus": ({"law": "yeoh", "youngs_modulus": 1e6, "c1": 0.1e6}, "material.youngs_modulus", "600000 Pa"),
    "ogden": (
        {"law": "ogden", "youngs_modulus": 1.2e6, "ogden": [[0.5e6, 2.0], [0.1e6, -2.0]]},
        "ogden[1]",
        "must have μ α > 0",
    ),
    "plateau": ({**PLATEAU, "plateau_end": 0.005}, "plateau_end", "must be > plateau_start"),
    "unloading": ({**PLATEAU, "branch": "unloading"}, "unloading_start", "missing"),
    "no_unloading": ({**PLATEAU, "unloading_start": 0.005}, "unloading_start", "stands without branch"),
    "late": ({**PLATEAU, "branch": "unloading", "unloading_start": 0.02}, "unloading_start", "must be < plateau_start"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_material_is_refused_where_it_stands(name: str) -> None:
    material, where, said = REFUSED[name]
    with pytest.raises(SceneError) as refused:
        scene(material)
    problems = [problem for problem in refused.value.problems if problem.where.endswith(where)]
    assert problems, str(refused.value)
    assert any(said in problem.problem for problem in problems), str(refused.value)


@pytest.mark.parametrize("material", [table(bending=[[1, 1e-3]]), PLATEAU], ids=["table", "plateau"])
def test_bending_alike_in_every_direction_needs_a_round_section(material: dict[str, Any]) -> None:
    with pytest.raises(SceneError, match="is not round"):
        build(scene(material, "rectangle"))


MATRIX = np.diag([1.0, 1.0, 1.0, 10.0, 10.0, 10.0])


def test_matrix_is_symmetric_and_positive() -> None:
    skew = MATRIX.copy()
    skew[2, 5] = 0.1
    indefinite = MATRIX.copy()
    indefinite[2, 5] = indefinite[5, 2] = 4.0
    for matrix, said in (
        (skew, "must be 0.1"),
        (indefinite, "positive definite"),
        (-MATRIX, "must be > 0"),
        (MATRIX[:5], "6 rows"),
    ):
        with pytest.raises(SceneError, match=said):
            scene(None, stiffness_matrix=matrix.tolist())
    with pytest.raises(SceneError, match="stands beside stiffness"):
        scene(None, stiffness_matrix=MATRIX.tolist(), stiffness={"torsion": 1.0})
    assert scene(None, stiffness_matrix=MATRIX.tolist()).rods[0].stiffness_matrix[3][3] == 10.0


def test_points_of_a_curve_are_no_parameters() -> None:
    made_of = {"material": table(torsion=[[1, 2]]), "section": {"shape": "circle", "radius": 2e-3}}
    rods = [{"name": "a", "length": 0.1, "strain": "reissner", **made_of}]
    with pytest.raises(SceneError, match=r"'a\.material\.table'"):
        scene_from_dict({"schema": 1, "parameters": ["a.material.table"], "rods": rods})
