"""Motions of the same rods share functions: none is written twice, and digits are those of a first motion."""

from __future__ import annotations

from typing import Any

import pytest
from numpy.testing import assert_array_equal

from cosserat_casadi import Motion, scene_from_dict, simulate
from cosserat_casadi.model.function_table import FunctionSpec
from cosserat_casadi.motion import moving_model
from tests.motion.test_motions_that_go_on import swing


def moved(**changes: Any) -> Motion:
    tables = swing(0.125, step=None, **changes)
    tables["simulation"]["start"] = "equilibrium"
    return simulate(scene_from_dict(tables), compiled=False)


def test_a_later_motion_of_the_same_rods_writes_no_function(monkeypatch: pytest.MonkeyPatch) -> None:
    moving_model._kept.cache_clear()
    first = moved()
    written: list[str] = []
    build = FunctionSpec.build

    def counted(self: FunctionSpec, *arguments: Any) -> Any:
        written.append(self.name)
        return build(self, *arguments)

    monkeypatch.setattr(FunctionSpec, "build", counted)
    again = moved(title="another")
    assert not written
    assert_array_equal(again.x, first.x)
    other = moved(motions=[{"input": "push.force", "times": [0.0, 1.0], "values": [[0, 0, 0], [0, 0, 0.1]]}])
    assert not written
    assert abs(other.x[-1] - first.x[-1]).max() > 1e-3
    softer = swing(0.125, step=None)["rods"][0]
    softer["stiffness"] = {"bending_y": 0.012}
    assert abs(moved(rods=[softer]).x[0] - first.x[0]).max() > 1e-2
    assert written
