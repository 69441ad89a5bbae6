"""The exported C of an assembly against Python."""

from __future__ import annotations

from pathlib import Path

import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import build, export, load, scene_from_dict, solve
from tests.scenes import rod


@pytest.mark.slow
def test_two_rods_and_a_body_vs_python(tmp_path: Path) -> None:
    rods = [rod("planar", name="a"), rod("planar", name="b", base={"rod": "a"})]
    tables = {
        "schema": 1,
        "accuracy": {"modes": 3, "nodes": 6},
        "rods": rods,
        "bodies": [{"name": "cap", "mass": 0.1}],
        "joints": [{"body": "cap", "rod": "b", "kind": "fixed"}],
        "loads": [{"name": "p", "kind": "tip_wrench", "rod": "b", "force": [0.2, 0.0, 0.1]}],
    }
    model = build(scene_from_dict(tables))
    export(model, tmp_path / "two")
    compiled = load(tmp_path / "two").solve()
    assert_allclose(compiled.q, solve(model).x, rtol=0, atol=1e-9)
