"""Inputs over time: against closed forms, scipy's splines and differences, piece by piece."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.interpolate import CubicSpline

from cosserat_casadi import SceneError
from cosserat_casadi.model.inputs import input_layout
from cosserat_casadi.motion.moving_inputs import MOST_CUTS, Break, MovingInputs
from tests.scenes import WEIGHT, WIND, push, rod, scene

FORCE = np.array([0.9, 0.5, -0.4])
"""The scene's value of push.force."""

TIMES = [0.1, 0.25, 0.3, 0.6, 0.75]
VALUES = np.random.default_rng(3).normal(size=(5, 3))


def moving(*motions: dict[str, Any], name: str = "push.force", **changes: Any) -> MovingInputs:
    """The inputs of a pushed and weighed rod, one of which moves."""
    entries = [{"input": name, **motion} for motion in motions]
    given = scene(WEIGHT, push(), motions=entries, **changes).with_motion_inputs()
    layout = input_layout(given)
    return MovingInputs(layout, given.motions, layout.pack())


def table(times: list[float], values: Any, interpolation: str = "linear") -> dict[str, Any]:
    return {"times": times, "values": np.asarray(values).tolist(), "interpolation": interpolation}


SINE = {"amplitude": [0.2, 0.0, -0.5], "frequency": 3.0, "phase": 0.4}
COSINE = {"amplitude": [0.2, 0.0, -0.5], "frequency": 3.0, "phase": 0.4, "wave": "one_minus_cosine"}
CUBIC = table(TIMES, VALUES, "cubic")
LINEAR = table(TIMES, VALUES)
STEP = table(TIMES, VALUES, "step")


def of_force(state: Any) -> np.ndarray:
    """Value, rate and acceleration of push.force, shape (3, 3); it stands behind the three numbers of the weight."""
    return np.array([numbers[3:6] for numbers in state])


def test_without_motions_the_inputs_stay() -> None:
    still = moving()
    (piece,) = still.pieces(0.7)
    assert (piece.start, piece.end) == (0.0, 0.7)
    assert_array_equal(piece.at(0.3).value, [0.3, -0.2, -2.0, *FORCE])
    assert_array_equal(piece.at(0.3).rate, np.zeros(6))
    assert_array_equal(piece.at(0.3).acceleration, np.zeros(6))
    assert not piece.moves
    assert still.breaks(0.7) == []


@pytest.mark.parametrize("t", [0.0, 0.0371, 1.9])
def test_waves_are_added_to_the_scene(t: float) -> None:
    amplitude = np.array(SINE["amplitude"])
    omega = 6 * np.pi
    angle = omega * t + 0.4
    sine = of_force(moving(SINE).at(t))
    assert_allclose(sine[0], FORCE + amplitude * np.sin(angle), rtol=1e-14, atol=1e-14)
    assert_allclose(sine[1], amplitude * omega * np.cos(angle), rtol=1e-13, atol=1e-12)
    assert_allclose(sine[2], -amplitude * omega**2 * np.sin(angle), rtol=1e-13, atol=1e-10)
    cosine = of_force(moving(COSINE).at(t))
    assert_allclose(cosine[0], FORCE + amplitude * (1 - np.cos(angle)), rtol=1e-14, atol=1e-14)
    assert_allclose(cosine[1], amplitude * omega * np.sin(angle), rtol=1e-13, atol=1e-12)
    assert_allclose(cosine[2], amplitude * omega**2 * np.cos(angle), rtol=1e-13, atol=1e-10)


@pytest.mark.parametrize("motion", [SINE, COSINE, CUBIC, LINEAR], ids=["sine", "cosine", "cubic", "linear"])
def test_rates_are_derivatives_of_values_and_accelerations_those_of_rates(motion: dict[str, Any]) -> None:
    """Central differences are of second order in their step."""
    inputs = moving(motion)
    errors = []
    for step in (1e-3, 5e-4):
        worst = np.zeros(2)
        for piece in inputs.pieces(0.8):
            t = 0.4 * piece.start + 0.6 * piece.end
            later = of_force(piece.at(t + step))
            earlier = of_force(piece.at(t - step))
            differences = (later - earlier) / (2 * step)
            now = of_force(piece.at(t))
            worst = np.maximum(worst, np.abs(differences[:2] - now[1:]).max(axis=1))
        errors.append(worst)
    coarse, fine = errors
    assert np.all(fine < 0.27 * coarse + 1e-9)
    assert np.all(fine < 1e-2 * np.array([1.0, 30.0]))


def test_pieces_of_tables_that_overlap_are_sums_of_their_splines() -> None:
    random = np.random.default_rng(5)
    tables = [([0.1, 0.5], random.normal(size=(2, 3))), ([0.3, 0.9], random.normal(size=(2, 3)))]
    inputs = moving(*(table(times, values, "cubic") for times, values in tables))
    pieces = inputs.pieces(1.2)
    assert len(pieces) == 5
    for piece in pieces:
        for t in np.linspace(piece.start, piece.end, 4)[1:-1]:
            expected = np.zeros((3, 3))
            for times, values in tables:
                spline = CubicSpline(times, values, bc_type="clamped")
                inside = times[0] < t < times[-1]
                expected[0] += spline(np.clip(t, *times))
                expected[1:] += [spline(t, order) if inside else np.zeros(3) for order in (1, 2)]
            assert_allclose(of_force(piece.at(t)), expected, rtol=1e-12, atol=1e-11)


@pytest.mark.parametrize("count", [1, 2, 3, 5, 40])
def test_cubic_tables_are_clamped_splines(count: int) -> None:
    random = np.random.default_rng(count)
    times = np.cumsum(random.uniform(0.01, 0.1, count))
    values = random.normal(size=(count, 3))
    inputs = moving(table(times.tolist(), values, "cubic"))
    before = of_force(inputs.at(times[0] - 0.01))
    after = of_force(inputs.at(times[-1] + 0.01))
    assert_array_equal(before, [values[0], np.zeros(3), np.zeros(3)])
    assert_array_equal(after, [values[-1], np.zeros(3), np.zeros(3)])
    if count == 1:
        return
    spline = CubicSpline(times, values, bc_type="clamped")
    for t in np.linspace(times[0], times[-1], 57)[:-1]:
        state = of_force(inputs.at(t))
        for order in range(3):
            expected = spline(t, order)
            scale = np.abs(spline(times[:-1], order)).max()
            assert_allclose(state[order], expected, rtol=1e-10, atol=1e-11 * scale)


def test_linear_tables_are_interpolated_and_constant_outside() -> None:
    inputs = moving(LINEAR)
    for t in np.linspace(0.0, 1.0, 83):
        expected = [np.interp(t, TIMES, column) for column in VALUES.T]
        assert_allclose(inputs.at(t).value[3:], expected, rtol=1e-13, atol=1e-13)
        assert_array_equal(inputs.at(t).acceleration, np.zeros(6))
    # The other input keeps the scene's value.
    assert_array_equal(inputs.at(0.4).value[:3], WEIGHT["acceleration"])


@pytest.mark.parametrize("motion", [LINEAR, STEP], ids=["linear", "step"])
def test_pieces_meet_at_the_knots_with_limits_from_within(motion: dict[str, Any]) -> None:
    pieces = moving(motion).pieces(0.8)
    bounds = [0.0, *TIMES, 0.8] if motion is not STEP else [0.0, *TIMES[1:], 0.8]
    assert [piece.start for piece in pieces] == bounds[:-1]
    assert [piece.end for piece in pieces] == bounds[1:]
    for piece in pieces:
        # What is smooth on a closed interval is a cubic there: its fourth differences vanish, ends included.
        samples = [of_force(piece.at(t)) for t in np.linspace(piece.start, piece.end, 6)]
        differences = np.diff(samples, n=4, axis=0)
        scale = np.abs(samples).max(axis=(0, 2))[:, None]
        assert np.all(np.abs(differences) <= 1e-12 * scale)
    if motion is STEP:
        held = [of_force(piece.at(t))[0] for piece in pieces for t in (piece.start, piece.end)]
        assert_array_equal(held, np.repeat(VALUES, 2, axis=0))


def test_pieces_go_on_beyond_their_ends() -> None:
    """As one polynomial: constraints are differentiated there where a motion starts anew next to an end."""
    for piece in moving(CUBIC).pieces(0.8):
        span = piece.end - max([piece.start, *piece.kinks])
        samples = [of_force(piece.at(t)) for t in np.linspace(piece.end - span, piece.end + 0.1 * span, 6)]
        differences = np.diff(samples, n=4, axis=0)
        scale = np.abs(samples).max(axis=(0, 2))[:, None]
        assert np.all(np.abs(differences) <= 1e-12 * scale)


def test_knots_of_a_spline_cut_nothing_but_at_its_ends() -> None:
    inputs = moving(CUBIC)
    pieces = inputs.pieces(0.8)
    assert [piece.start for piece in pieces] == [0.0, TIMES[0], TIMES[-1]]
    assert [piece.kinks for piece in pieces] == [(), tuple(TIMES[1:-1]), ()]
    assert_allclose(pieces[1].smooth, np.diff(TIMES).min(), rtol=1e-14, atol=0)
    for t in [*TIMES[1:-1], *(0.5 * np.add(TIMES[1:], TIMES[:-1]))]:
        assert_array_equal(pieces[1].at(t).value, inputs.at(t).value)


@pytest.mark.parametrize(("count", "cuts"), [(MOST_CUTS - 2, True), (MOST_CUTS + 2, False)])
def test_kinks_of_a_record_cut_nothing(count: int, cuts: bool) -> None:
    times = np.linspace(0.0, 0.5, count).tolist()
    values = [[(-1.0) ** k, 0.0, 0.0] for k in range(count)]
    pieces = moving(table(times, values)).pieces(1.0)
    kinks = [time for piece in pieces for time in piece.kinks]
    assert len(pieces) == (count if cuts else 1)
    assert kinks == ([] if cuts else times[1:])


def test_jumps_of_a_record_cut_all_the_same() -> None:
    times = np.linspace(0.0, 0.5, 2 * MOST_CUTS).tolist()
    values = [[float(k), 0.0, 0.0] for k in range(len(times))]
    pieces = moving(table(times, values, "step")).pieces(1.0)
    assert len(pieces) == len(times)


def test_a_jump_of_another_input_cuts_between_knots() -> None:
    jump = {**table([0.0, 0.55], [[0, 0, 0], [1, 0, 0]], "step"), "input": "weight.acceleration"}
    pieces = moving(CUBIC, jump).pieces(0.8)
    assert 0.55 in [piece.start for piece in pieces]
    inside = [(piece.start, time, piece.end) for piece in pieces for time in piece.kinks]
    assert all(start < time < end for start, time, end in inside)
    assert [time for _, time, _ in inside] == [time for time in TIMES[1:-1] if time != 0.55]


def test_knots_on_a_line_cut_nothing() -> None:
    """Rounding of 0.1 k makes slopes differ in their last digits."""
    times = [0.1 * k for k in range(11)]
    values = [[0.3 * t, 0.0, 0.1 - t] for t in times]
    pieces = moving(table(times, values)).pieces(2.0)
    assert [piece.start for piece in pieces] == [0.0, times[-1]]
    for t in (0.0, 0.35, 0.999):
        assert_allclose(pieces[0].at(t).value[3:], [0.3 * t, 0.0, 0.1 - t], rtol=1e-13, atol=1e-15)


def test_a_value_that_comes_again_cuts_no_step() -> None:
    (first, second) = moving(table([0.1, 0.2, 0.3], [FORCE, FORCE, -FORCE], "step")).pieces(1.0)
    assert (first.end, second.start) == (0.3, 0.3)


def test_times_that_rounding_parts_are_one() -> None:
    """0.1 · 3 is not 0.3: between the two there is no piece, and none of its neighbours holds a kink."""
    earlier = table([0.0, 0.3, 1.0], VALUES[:3])
    later = table([0.0, 0.1 * 3, 1.0], VALUES[2:])
    assert 0.1 * 3 != 0.3
    left, right = moving(earlier, later).pieces(1.0)
    slopes = [
        (VALUES[1] - VALUES[0] + VALUES[3] - VALUES[2]) / 0.3,
        (VALUES[2] - VALUES[1] + VALUES[4] - VALUES[3]) / 0.7,
    ]
    for t in (left.start, 0.2, left.end):
        assert_allclose(left.at(t).rate[3:], slopes[0], rtol=1e-12, atol=1e-12)
    for t in (right.start, 0.9, right.end):
        assert_allclose(right.at(t).rate[3:], slopes[1], rtol=1e-12, atol=1e-12)


def test_tables_add_up_in_place_of_the_scene_and_waves_are_added() -> None:
    """Two tables, two waves: the sum of each kind alone, the scene's value counted by the waves only."""
    t = 0.42
    alone = [moving(motion).at(t) for motion in (LINEAR, CUBIC, SINE, COSINE)]
    together = moving(LINEAR, SINE, CUBIC, COSINE).at(t)
    linear, cubic, sine, cosine = alone
    scene_value = np.array([*WEIGHT["acceleration"], *FORCE])
    moved = slice(3, 6)
    expected = linear.value + cubic.value + (sine.value - scene_value) + (cosine.value - scene_value)
    assert_allclose(together.value[moved], expected[moved], rtol=1e-13, atol=1e-13)
    assert_allclose(together.rate, sum(state.rate for state in alone), rtol=1e-12, atol=1e-12)
    assert_allclose(together.acceleration, sum(state.acceleration for state in alone), rtol=1e-12, atol=1e-10)


def test_breaks_have_the_order_of_the_derivative_that_jumps() -> None:
    spline = moving(table([0.2, 0.4, 0.6], VALUES[:3], "cubic"))
    assert [(entry.time, entry.order) for entry in spline.breaks(1.0)] == [(0.2, 2), (0.4, 3), (0.6, 2)]
    assert spline.breaks(0.2) == []
    ramp = moving(table([0.0, 0.5, 2.0], [FORCE, -FORCE, FORCE]))
    assert ramp.breaks(1.0) == [Break("push.force", 0.0, 1), Break("push.force", 0.5, 1)]
    assert ramp.jumps(1.0) == []
    sudden = moving(STEP)
    assert sudden.jumps(1.0) == [Break("push.force", time, 0) for time in TIMES[1:]]
    assert sudden.breaks(1.0) == sudden.jumps(1.0)


def test_a_wave_that_rests_before_zero_begins_with_a_break() -> None:
    assert moving({"amplitude": [1, 0, 0], "frequency": 2.0}).breaks(1.0) == [Break("push.force", 0.0, 1)]
    at_rest = {"amplitude": [1, 0, 0], "frequency": 2.0, "wave": "one_minus_cosine"}
    assert moving(at_rest).breaks(1.0) == [Break("push.force", 0.0, 2)]


def test_numbers_of_polynomials_go_degree_after_degree() -> None:
    values = np.arange(12.0).reshape(2, 6)
    given = scene(WIND, motions=[{"input": "wind.force", **table([0.0, 1.0], values)}])
    layout = input_layout(given)
    inputs = MovingInputs(layout, given.motions, layout.pack())
    middle = layout.unpack(inputs.at(0.5).value)["wind.force"]
    assert_array_equal(middle, [[3.0, 6.0], [4.0, 7.0], [5.0, 8.0]])


def test_bases_and_lengths_move_as_numbers() -> None:
    turn = {"input": "rod.base.quaternion", "times": [0.0, 2.0], "values": [[1, 0, 0, 0], [0, 1, 0, 0]]}
    longer = {"input": "rod.length", "amplitude": 0.1, "frequency": 0.25}
    given = scene(push(), motions=[turn, longer], simulation={"duration": 2.0}).with_motion_inputs()
    layout = input_layout(given)
    values = layout.unpack(MovingInputs(layout, given.motions, layout.pack()).at(1.0).value)
    assert_allclose(values["rod.base.quaternion"][:, 0], [0.5, 0.5, 0.0, 0.0], rtol=1e-15, atol=0.0)
    assert_allclose(values["rod.length"], rod()["length"] + 0.1, rtol=1e-15, atol=0.0)


def test_an_input_that_the_model_fixes_is_refused() -> None:
    given = scene(push(), inputs=["push.force"], motions=[{"input": "push.moment", **LINEAR}])
    layout = input_layout(given)
    with pytest.raises(SceneError, match=r"push\.moment: is not an input of this model \(build .*; its inputs are"):
        MovingInputs(layout, given.motions, layout.pack())
