"""Positions between steps are put on the constraints, whatever Jacobian the projection begins with."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from cosserat_casadi import build, scene_from_dict
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.constraint_projection import CLOSED, Closing
from cosserat_casadi.motion.history import equations_of
from cosserat_casadi.motion.simulate import Simulator, started
from tests.motion import transients


def test_a_jacobian_of_elsewhere_that_leads_away_is_replaced(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = scene_from_dict({**transients.scissors(), "accuracy": {"modes": 3, "nodes": 8}})
    model = build(scene.with_motion_inputs(), moving=True)
    assert scene.simulation is not None
    history = Simulator(model, scene.simulation, started(model, scene.simulation, None)).controlled(1e-2)
    leg, instant = history.locate(0.5 * history.end.time)
    equations = leg.equations or equations_of(model, leg.piece)
    closing = Closing(model)
    opened = replace(instant, x=instant.x + 1e-4 * model.discrete.unknowns.differential)
    assert np.abs(equations.residual_at(opened)[closing.rows]).max() > 1e3 * CLOSED
    answered = []

    def backwards_at_first(own: Closing, x: FloatArray, inputs: FloatArray) -> FloatArray:
        answered.append(plainly(own, x, inputs))
        return -3.0 * answered[0] if len(answered) == 1 else answered[-1]

    plainly = Closing._answers
    monkeypatch.setattr(Closing, "_answers", backwards_at_first)
    inputs = leg.piece.at(instant.time).value[None]
    (x,) = closing.closed(opened.x[None], inputs, np.zeros(1, dtype=int))
    assert len(answered) > 1
    assert np.abs(equations.residual_at(replace(opened, x=x))[closing.rows]).max() <= CLOSED
