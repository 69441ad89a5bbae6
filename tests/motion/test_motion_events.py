"""Events of users beside closed forms: a rod that falls freely passes heights at √(2 h / g)."""

from __future__ import annotations

from functools import cache

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, SceneError, simulate
from cosserat_casadi.motion.motion_event import MotionEvent
from tests.motion.stepping import moving_model
from tests.motion.test_motions_that_go_on import swing

G = 9.81


@cache
def falling() -> Model:
    """A free rod that falls from rest."""
    tables = swing(0.5, step=None, free=True)
    tables["motions"] = []
    tables["accuracy"] = {"modes": 1, "nodes": 4, "tolerance": 1e-3}
    return moving_model(tables)


def height(above: float, stop: bool = False) -> MotionEvent:
    def value(model: Model, x: ca.MX, inputs: ca.MX) -> ca.MX:
        return model.tip["arm"](x, inputs)[0][2] + above

    return MotionEvent(f"{above} below", value, stop)


def test_heights_are_noted_and_one_of_them_stops_the_motion() -> None:
    noted, end = 0.1, 0.7
    motion = simulate(falling(), events=[height(end, stop=True), height(noted), height(-0.1)], compiled=False)
    assert motion.converged
    assert "An event stopped it at t = 0.377" in motion.message
    assert [(event.kind, event.owner) for event in motion.events] == [("falls", "0.1 below"), ("falls", "0.7 below")]
    times = [event.time for event in motion.events]
    assert_allclose(times, np.sqrt(2.0 * np.array([noted, end]) / G), rtol=0, atol=1e-9)
    assert motion.times[-1] == times[-1]
    assert_allclose(motion.tip().position[-1, 2], -end, rtol=0, atol=1e-9)


def test_a_motion_that_an_event_stopped_goes_on() -> None:
    stopped = simulate(falling(), events=[height(0.2, stop=True)], compiled=False)
    last = simulate(falling(), start=stopped, events=[height(0.2, stop=True), height(0.5, stop=True)], compiled=False)
    assert [event.owner for event in last.events] == ["0.5 below"]
    assert_allclose(last.times[-1], np.sqrt(1.0 / G), rtol=0, atol=1e-9)


def test_an_input_rises_and_falls() -> None:
    """The push of a held rod is 0.1 N at 0.0625 s on its way up, and at 0.3125 s on its way down."""
    tables = swing(0.5, step=0.0625, accuracy={"modes": 1, "nodes": 4, "tolerance": 1e-1})

    def value(model: Model, x: ca.MX, inputs: ca.MX) -> ca.MX:
        return inputs[model.inputs.slices["push.force"]][2] - 0.1

    motion = simulate(moving_model(tables), events=[MotionEvent("half", value)], compiled=False)
    assert [event.kind for event in motion.events] == ["rises", "falls"]
    assert_allclose([event.time for event in motion.events], [0.0625, 0.3125], rtol=0, atol=1e-9)


@pytest.mark.parametrize("least", [0.1, -0.1])
def test_an_input_that_jumps_through_zero_stops_the_motion(least: float) -> None:
    """The push jumps at 0.125 s from zero to twice the value that stops, and back at 0.25 s."""
    tables = swing(0.5, step=0.0625, accuracy={"modes": 1, "nodes": 4, "tolerance": 1e-1})
    pushes = [[0.0, 0.0, 0.0], [0.0, 0.0, 2 * least], [0.0, 0.0, 0.0]]
    tables["motions"] = [
        {"input": "push.force", "times": [0.0, 0.125, 0.25], "values": pushes, "interpolation": "step"}
    ]

    def value(model: Model, x: ca.MX, inputs: ca.MX) -> ca.MX:
        return inputs[model.inputs.slices["push.force"]][2] - least

    model = moving_model(tables)
    stopped = simulate(model, events=[MotionEvent("half", value, stop=True)], compiled=False)
    kind, back = ("rises", "falls") if least > 0.0 else ("falls", "rises")
    assert [(event.kind, event.time) for event in stopped.events] == [(kind, 0.125)]
    assert stopped.converged
    assert stopped.times[-1] == 0.125
    # Gone on with, it stops where the push jumps back.
    last = simulate(model, start=stopped, events=[MotionEvent("half", value, stop=True)], compiled=False)
    assert [(event.kind, event.time) for event in last.events] == [(back, 0.25)]


def test_what_begins_at_zero_does_not_cross_it_there() -> None:
    """A tip that falls from the height of an event, and one that its rounding puts on the other side."""
    off = 2e-17
    motion = simulate(falling(), events=[height(-0.0), height(off), height(-off)], compiled=False)
    assert motion.events == ()


def test_a_value_that_is_no_number_is_refused() -> None:
    event = MotionEvent("place", lambda model, x, inputs: model.tip["arm"](x, inputs)[0])
    with pytest.raises(SceneError, match="'place' has shape"):
        simulate(falling(), events=[event])
