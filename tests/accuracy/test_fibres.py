"""Sums of rubber laws over fibres against adaptive quadrature: their error is told, and the tolerance is kept."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import root

from cosserat_casadi import Scene, SceneError, build, discretise, follow, scene_from_dict, simulate, solve
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.discretise import with_discretisation
from tests.families import mostly_slow
from tests.reference.material_scenes import fibre_stress

LENGTH = 0.1
RADIUS = 4e-3
HALF_WIDTH = 3e-3

MOMENT = 0.02

LAWS: dict[str, dict[str, Any]] = {
    "neo_hookean": {"youngs_modulus": 1.2e6},
    "mooney_rivlin": {"youngs_modulus": 1.2e6, "c10": 0.15e6, "c01": 0.05e6},
    "yeoh": {"youngs_modulus": 0.66e6, "c1": 0.11e6, "c2": 0.02e6, "c3": 1e3},
    "ogden": {"youngs_modulus": 1.35e6, "ogden": [[0.5e6, 1.3], [0.0833333333e6, 3.0]]},
}

SECTIONS: dict[str, dict[str, Any]] = {
    "circle": {"radius": RADIUS},
    "annulus": {"outer_radius": RADIUS, "inner_radius": 2e-3},
    "rectangle": {"width": 8e-3, "height": 2 * HALF_WIDTH},
}


@cache
def bent(law: str, shape: str, moment: float) -> tuple[float, float]:
    """Stretch of the centre line and curvature, 1/m, by a moment, N m, without axial force."""
    material = {"law": law, **LAWS[law]}
    modulus = LAWS[law]["youngs_modulus"]
    sizes = SECTIONS[shape]

    def over_disk(lever: Callable[[float], float], radius: float, stretch: float, curvature: float) -> float:
        """∫ lever(y) σ(λ) dA / (E R²) over a disk, by y = radius sin φ."""

        def density(angle: float) -> float:
            y = radius * np.sin(angle)
            stress = float(fibre_stress(material, stretch + curvature * y)) / modulus
            return lever(y / RADIUS) * stress * 2 * (radius / RADIUS * np.cos(angle)) ** 2

        return float(quad(density, -np.pi / 2, np.pi / 2, epsabs=1e-12, epsrel=1e-12)[0])

    def over_strip(lever: Callable[[float], float], stretch: float, curvature: float) -> float:
        def density(y: float) -> float:
            stress = float(fibre_stress(material, stretch + curvature * y)) / modulus
            return lever(y / RADIUS) * stress * sizes["width"] / RADIUS**2

        return float(quad(density, -HALF_WIDTH, HALF_WIDTH, epsabs=1e-12, epsrel=1e-12)[0])

    def integral(lever: Callable[[float], float], stretch: float, curvature: float) -> float:
        if shape == "rectangle":
            return over_strip(lever, stretch, curvature)
        whole = over_disk(lever, RADIUS, stretch, curvature)
        bore = sizes.get("inner_radius")
        return whole if bore is None else whole - over_disk(lever, bore, stretch, curvature)

    def excess(unknown: FloatArray) -> list[float]:
        stretch, curvature = unknown[0], 100 * unknown[1]
        axial = integral(lambda y: 1.0, stretch, curvature)
        return [axial, integral(lambda y: y, stretch, curvature) - moment / (modulus * RADIUS**3)]

    found = root(excess, [1.0, moment * 60.0], tol=1e-13)
    return float(found.x[0]), 100 * float(found.x[1])


def tip_of(law: str, shape: str, moment: float) -> FloatArray:
    """Place of the tip of a rod that is bent to a circle, over the length."""
    stretch, curvature = bent(law, shape, moment)
    turn = curvature * LENGTH
    return stretch * np.array([0.0, np.cos(turn) - 1.0, np.sin(turn)]) / turn


def scene(law: str, shape: str, moment: float, **accuracy: Any) -> Scene:
    return scene_from_dict(scene_tables(law, shape, moment, **accuracy))


def scene_tables(law: str, shape: str, moment: float, **accuracy: Any) -> dict[str, Any]:
    return {
        "schema": 1,
        "inputs": ["push.moment"],
        "accuracy": accuracy,
        "rods": [
            {
                "name": "rod",
                "length": LENGTH,
                "strain": ["bending_x", "extension"],
                "material": {"law": law, **LAWS[law], "density": 1000.0},
                "section": {"shape": shape, **SECTIONS[shape]},
            }
        ],
        "loads": [{"name": "push", "kind": "tip_wrench", "rod": "rod", "moment": [moment, 0.0, 0.0]}],
    }


def error_of(position: FloatArray, law: str, shape: str, moment: float) -> float:
    """Error of the place of the tip, over the length."""
    return float(np.linalg.norm(position / LENGTH - tip_of(law, shape, moment)))


CASES = [(law, shape) for law in LAWS for shape in SECTIONS]


@pytest.mark.parametrize(("law", "shape"), mostly_slow(CASES, quick=[("yeoh", "circle"), ("neo_hookean", "rectangle")]))
@pytest.mark.parametrize("tolerance", [pytest.param(1e-6, marks=pytest.mark.slow), 1e-9])
def test_solution_keeps_its_tolerance(law: str, shape: str, tolerance: float) -> None:
    solution = solve(scene(law, shape, MOMENT, tolerance=tolerance))
    assert solution.error_estimate is not None
    assert error_of(solution.tip().position, law, shape, MOMENT) <= solution.error_estimate <= tolerance


def test_large_tolerance_takes_the_fewest_fibres() -> None:
    solution = solve(scene("yeoh", "circle", MOMENT, tolerance=1e-3))
    assert solution.model.discretisation["rod"].fibres == 3


@pytest.mark.parametrize(("law", "shape"), mostly_slow(CASES, quick=[("yeoh", "circle"), ("ogden", "annulus")]))
def test_error_away_from_the_inputs_of_the_choice_is_told(law: str, shape: str) -> None:
    small = scene(law, shape, 0.002, tolerance=1e-6)
    model = build(small, discretise(small, 1, 20, "magnus8"))
    for moment in (0.008, MOMENT):
        solution = solve(model, {"push.moment": [moment, 0.0, 0.0]})
        assert solution.error_estimate is not None
        error = error_of(solution.tip().position, law, shape, moment)
        assert error <= solution.error_estimate <= 40 * error + 1e-11


def test_error_on_fixed_modes_is_told_and_falls_with_the_fibres() -> None:
    errors = []
    for fibres in (2, 4, 6):
        solution = solve(scene("yeoh", "circle", MOMENT, modes=1, nodes=24, rotation="magnus8", fibres=fibres))
        errors.append(error_of(solution.tip().position, "yeoh", "circle", MOMENT))
        assert solution.error_estimate is not None
        assert errors[-1] <= solution.error_estimate <= 60 * errors[-1] + 1e-10
    assert errors[2] < 1e-2 * errors[1] < 1e-4 * errors[0]


@pytest.mark.parametrize(
    ("law", "moment"), mostly_slow([("neo_hookean", 0.008), ("yeoh", MOMENT)], quick=[("neo_hookean", 0.008)])
)
def test_path_keeps_its_tolerance(law: str, moment: float) -> None:
    path = follow(scene(law, "circle", moment, tolerance=1e-8), "push.moment", [moment, 0.0, 0.0])
    assert path.error_estimate is not None
    tip = path.solution(-1).tip().position
    assert error_of(tip, law, "circle", moment) <= path.error_estimate <= 1e-8


@pytest.mark.parametrize("accuracy", [{"modes": 1, "nodes": 16, "fibres": 2}, {}])
def test_motion_tells_the_error_of_its_fibres(accuracy: dict[str, Any]) -> None:
    """A damped rod is bent to a circle, and rests there after twenty times its relaxation."""
    moment = 0.012
    tables = scene_tables("yeoh", "circle", 0.0, **accuracy, tolerance=1e-3)
    tables["rods"][0]["damping"] = {"retardation_time": 0.02}
    tables["simulation"] = {"duration": 0.6}
    tables["motions"] = [{"input": "push.moment", "times": [0.0, 0.2], "values": [[0, 0, 0], [moment, 0, 0]]}]
    motion = simulate(scene_from_dict(tables))
    assert motion.error_estimate is not None
    error = error_of(motion.tip().position[-1], "yeoh", "circle", moment)
    assert error <= motion.error_estimate
    if accuracy:
        assert error > 1e-5
    else:
        assert motion.error_estimate <= 1e-3


def test_scene_keeps_its_fibres() -> None:
    solution = solve(scene("neo_hookean", "circle", MOMENT, tolerance=1e-9))
    chosen = solution.model.discretisation
    assert chosen["rod"].fibres > 3
    written = with_discretisation(solution.model.scene, chosen)
    assert written.accuracy.fibres == chosen["rod"].fibres
    assert discretise(written) == chosen


@pytest.mark.parametrize("accuracy", [{"fibres": 4}, {"modes": 4, "nodes": 10, "fibres": 0}])
def test_fibres_without_nodes_or_out_of_range_are_refused(accuracy: dict[str, Any]) -> None:
    with pytest.raises(SceneError, match="fibres"):
        scene("neo_hookean", "circle", MOMENT, **accuracy)
