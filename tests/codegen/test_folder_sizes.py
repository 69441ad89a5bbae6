"""Budgets on the bytes of C of exported examples: what compilers take grows with them (benchmarks/folder_cost.py)."""

from __future__ import annotations

from collections.abc import Mapping

import pytest

from cosserat_casadi import build, discretise, read_scene, solve
from cosserat_casadi.codegen.export import folder_files
from tests.conftest import ROOT
from tests.families import mostly_slow
from tests.scenes import push, scene

BUDGETS = {
    "planar_strip": 120_000,
    "nitinol_wire": 195_000,
    "follower_reissner": 194_000,
    "two_section_robot": 304_000,
    "six_rod_platform": 737_000,
}
"""Bytes of the sources and headers of the library at the tolerance of the example, without the estimate of errors."""

MOST_BY_ESTIMATE = {"planar_strip": 26_600, "nitinol_wire": 58_200, "follower_reissner": 66_400}
"""Bytes that the estimate of errors adds, where they are held: the balance of a rod with modes and intervals added."""

MOST_WITH_MOTION = 1_115_000
"""Bytes of the library of dropped_rod with its motion and with the estimate of errors."""


def bytes_of_c(files: Mapping[str, str]) -> int:
    wanted = {file: text for file, text in files.items() if file.endswith((".c", ".h")) and "_demo" not in file}
    return sum(map(len, wanted.values()))


@pytest.mark.parametrize("name", mostly_slow(BUDGETS, quick=["planar_strip"]))
def test_bytes_of_c_of_examples(name: str) -> None:
    solution = solve(read_scene(ROOT / "examples" / f"{name}.toml"))
    assert solution.converged
    without = bytes_of_c(folder_files(solution.model, "sized", estimate_errors=False))
    assert without <= BUDGETS[name]
    if name in MOST_BY_ESTIMATE:
        assert bytes_of_c(folder_files(solution.model, "sized")) - without <= MOST_BY_ESTIMATE[name]


@pytest.mark.slow
def test_bytes_of_c_with_motion() -> None:
    solution = solve(read_scene(ROOT / "examples" / "dropped_rod.toml"))
    assert bytes_of_c(folder_files(solution.model, "sized", dynamics=True)) <= MOST_WITH_MOTION


def test_bytes_of_c_of_a_joint_beside_the_literal_system() -> None:
    """CasADi differentiates the joint along each motion by one function: 2.8 MB if all were one function."""
    load = {"name": "load", "kind": "body_wrench", "body": "hand", "force": [1.0, 0.2, 0.3]}
    hinge = {"name": "wrist", "kind": "revolute", "body": "hand", "rod": "rod", "axis": [0, 1, 1], "stiffness": 1.0}
    robot = scene(load, strain="kirchhoff", bodies=[{"name": "hand", "mass": 0.1}], joints=[hinge])
    files = folder_files(build(robot, discretise(robot, 2, 4, "permuted")), "robot", None, estimate_errors=False)
    assert len(files["robot_kernels.c"]) < 1_100_000


def test_bytes_of_c_of_a_hyperelastic_rod_with_the_literal_system() -> None:
    """The same of the law of its material: 2.0 MB if all were one function."""
    rubber = {"density": 1e3, "shear_modulus": 2e5, "law": "mooney_rivlin", "c10": 6e4, "c01": 4e4}
    section = {"shape": "rectangle", "width": 0.02, "height": 0.01}
    soft = {"name": "rod", "length": 0.8, "strain": "kirchhoff", "section": section}
    finger = scene(push(), rods=[{**soft, "material": {"youngs_modulus": 6e5, **rubber}}])
    files = folder_files(build(finger, discretise(finger, 2, 4, "permuted")), "finger", None, estimate_errors=False)
    assert len(files["finger_kernels.c"]) < 1_000_000
