"""What a scene says of motion: what is read, written, left aside by statics, and refused."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from cosserat_casadi import Scene, SceneError, build, parse_scene, read_scene
from cosserat_casadi.scene import Body, Simulation
from cosserat_casadi.scene.writing import scene_text
from tests.conftest import case_files
from tests.scenes import WIND, push, rod, scene

CASES = case_files("dynamics")
SECTION = {
    "stiffness": None,
    "linear_density": None,
    "material": {"youngs_modulus": 1e6, "poisson_ratio": 0.5, "density": 1000.0},
    "section": {"shape": "circle", "radius": 0.02},
}
CABLE = {"name": "cable", "kind": "tendon", "rod": "rod", "length": 0.8, "offset": [0.01, 0]}
PULLED = {**CABLE, "name": "pulled", "tension": 3.0, "length": None}
PLATE = {"name": "plate", "mass": 1.0}
JOINT = {"body": "plate", "rod": "rod", "kind": "fixed"}

RAMP = {"input": "push.force", "times": [0.0, 0.05, 0.6], "values": [[0, 0, 0], [0.8, -0.5, 0.4], [0.8, -0.5, 0.4]]}
SHAKEN = {"input": "rod.base.position", "amplitude": [0.04, 0.03, 0.01], "frequency": 2.0, "wave": "one_minus_cosine"}


def given(*motions: dict[str, Any], duration: float | None = None, **changes: Any) -> Scene:
    """A pushed and blown rod with two cables; None leaves a key of the rod out."""
    tables: dict[str, Any] = {"actuators": [cleaned(CABLE), cleaned(PULLED)], **changes}
    if duration is not None:
        tables["simulation"] = {"duration": duration}
    if motions:
        tables["motions"] = list(motions)
    return scene(push(), WIND, **tables)


def cleaned(table: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in table.items() if value is not None}


def with_rod(**changes: Any) -> Scene:
    return scene(rods=[cleaned(rod(**changes))])


def with_body(**changes: Any) -> Scene:
    return scene(bodies=[{**PLATE, **changes}], joints=[JOINT])


def refusals(make: Callable[[], Scene]) -> list[str]:
    with pytest.raises(SceneError) as refused:
        make()
    return [str(problem) for problem in refused.value.problems]


# What is read


@pytest.mark.skipif(not CASES, reason="the reference cases are not here")
@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_reference_cases_are_read_and_written(path: Path) -> None:
    wanted = read_scene(path)
    assert parse_scene(scene_text(wanted)) == wanted


def test_tables_and_waves_are_read() -> None:
    read = given(RAMP, SHAKEN, {"input": "pulled.tension", "times": [0.0, 1.0], "values": [3, 4]})
    ramp, shaken, pulled = read.motions
    assert_array_equal(ramp.knots, [0.0, 0.05, 0.6])
    assert_array_equal(ramp.knot_values, RAMP["values"])
    assert (ramp.interpolation, ramp.is_table, ramp.entry_count) == ("linear", True, 3)
    assert_array_equal(shaken.amplitudes, [0.04, 0.03, 0.01])
    assert (shaken.frequency, shaken.phase, shaken.is_table, shaken.entry_count) == (2.0, 0.0, False, 3)
    assert_array_equal(pulled.knot_values, [[3.0], [4.0]])
    assert parse_scene(scene_text(read)) == read


def test_a_number_of_a_table_stands_in_a_list_or_without() -> None:
    mixed = given({"input": "pulled.tension", "times": [0.0, 0.5], "values": [[0.5], 2.0]})
    assert_array_equal(mixed.motions[0].knot_values, [[0.5], [2.0]])


def test_kinks_and_jumps() -> None:
    times = [0.0, 0.1, 0.2, 0.3]
    values = [[0.0, 1.0], [0.1, 1.0], [0.2, 1.0], [0.2, 1.0]]
    motion = {"input": "a.b", "times": times, "values": values}
    record = type(given(RAMP).motions[0])
    assert record(**motion).kinks == (0.0, 0.2)
    assert record(**motion).jumps == ()
    assert record(**motion, interpolation="step").jumps == (0.1, 0.2)
    assert record(**motion, interpolation="step").kinks == ()
    assert record(**motion, interpolation="cubic").kinks == ()


def test_frames_are_evenly_spaced_or_as_listed() -> None:
    assert_allclose(Simulation(duration=2.0).frame_times, np.arange(101) / 50, rtol=1e-15, atol=0.0)
    assert_allclose(Simulation(duration=2.0, frames=5).frame_times, [0.0, 0.5, 1.0, 1.5, 2.0], rtol=0.0, atol=0.0)
    assert_allclose(Simulation(duration=2.0, times=(0.0, 0.3)).frame_times, [0.0, 0.3], rtol=0.0, atol=0.0)


def test_the_tolerance_is_that_of_the_scene_where_the_simulation_has_none() -> None:
    accuracy = {"tolerance": 1e-5}
    assert given(accuracy=accuracy).motion_tolerance == 1e-5
    assert given(accuracy=accuracy, duration=1.0).motion_tolerance == 1e-5
    assert given(accuracy=accuracy, simulation={"duration": 1.0, "tolerance": 1e-3}).motion_tolerance == 1e-3


def test_inertia_of_a_body_is_a_diagonal_or_a_matrix() -> None:
    matrix = [[2.0, 0.1, 0.0], [0.1, 2.0, 0.0], [0.0, 0.0, 3.0]]
    assert_array_equal(with_body().bodies[0].inertia_matrix, np.zeros((3, 3)))
    assert_array_equal(with_body(inertia=[1, 2, 3]).bodies[0].inertia_matrix, np.diag([1.0, 2.0, 3.0]))
    read = with_body(inertia=matrix)
    assert_array_equal(read.bodies[0].inertia_matrix, matrix)
    assert parse_scene(scene_text(read)) == read
    # A thin disc, a rod and the largest numbers are at the edge of what bodies can have.
    for edge in ([1, 1, 2], [1, 1, 0], [0.1, 0.2, 0.1 + 0.2], [1e308, 1e308, 1e308]):
        Body(name="b", inertia=edge)


# Files


CSV = "t, value.z, value.x, value.y\n0, 3, 1, 2\n0.5, 6, 4, 5\n"


def from_file(folder: Path, text: str, *motions: dict[str, Any], **motion: Any) -> Scene:
    """A scene in a folder of its own, read from its file; columns of the first motion are beside it."""
    (folder / "force.csv").write_text(text)
    entry = {"input": "push.force", "file": "force.csv", **motion}
    lines = "".join(f"{key} = {value!r}\n" for key, value in entry.items())
    path = folder / "scene.toml"
    path.write_text(f"{scene_text(given(*motions))}\n[[motions]]\n{lines}")
    return read_scene(path)


def test_a_file_is_read_beside_the_scene_and_held_as_numbers(tmp_path: Path) -> None:
    read = from_file(tmp_path, CSV, RAMP, interpolation="step")
    motion = read.motions[1]
    assert (motion.times, motion.interpolation) == ((0.0, 0.5), "step")
    assert_array_equal(motion.knot_values, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])
    assert motion.file is None
    # What is written needs the file no more.
    (tmp_path / "force.csv").unlink()
    assert parse_scene(scene_text(read)) == read


def test_an_override_names_a_file_beside_the_scene_too(tmp_path: Path) -> None:
    from_file(tmp_path, CSV)
    (tmp_path / "other.csv").write_text(CSV.replace("0.5", "0.7"))
    read = read_scene(tmp_path / "scene.toml", ("motions[0].file='other.csv'",))
    assert read.motions[0].times == (0.0, 0.7)


@pytest.mark.parametrize(
    ("header", "name", "count"),
    [
        ("value", "pulled.tension", 1),
        ("value.w,value.x,value.y,value.z", "rod.base.quaternion", 4),
        ("value.x,value.y,value.z,value.x.1,value.y.1,value.z.1", "wind.force", 6),
    ],
)
def test_columns_of_numbers_quaternions_and_polynomials(tmp_path: Path, header: str, name: str, count: int) -> None:
    row = ",".join(str(k) for k in range(1, count + 1))
    read = from_file(tmp_path, f"t,{header}\n0,{row}\n", input=name)
    assert_array_equal(read.motions[0].knot_values, [np.arange(1.0, count + 1)])


FAULTY_FILES = {
    "missing_column": ("t,value.x,value.y\n0,1,2\n", "has no column 'value.z'"),
    "no_time": ("value.x,value.y,value.z\n1,2,3\n", "has no column 't'"),
    "another_column": ("t,value.x,value.y,value.z,speed\n0,1,2,3,4\n", "has a column 'speed'"),
    "parted_number": (CSV.replace("6", "6_0"), "line 3: value.z must be a finite number, got ' 6_0'"),
    "not_a_number": (CSV.replace("6", "nan"), "line 3: value.z must be a finite number, got ' nan'"),
    "short_row": (CSV + "1, 2\n", "line 4: has 2 values for 4 columns"),
    "not_increasing": (CSV + "\n0.5, 1, 1, 1\n", "line 5: t must be > 0.5, the time before it, got 0.5"),
    "empty": ("t,value\n", "holds no row of numbers"),
    "wrong_count": ("t,value\n0,1\n", "must have 3 numbers at each time, got 1"),
}


@pytest.mark.parametrize("case", FAULTY_FILES)
def test_faults_of_files(tmp_path: Path, case: str) -> None:
    text, problem = FAULTY_FILES[case]
    (told,) = refusals(lambda: from_file(tmp_path, text))
    assert told.startswith("motions[0].")
    assert problem in told


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    told = refusals(lambda: from_file(tmp_path, CSV, file="forces.csv"))
    assert [line.partition(":")[0] for line in told] == ["motions[0].file"]
    assert str(tmp_path / "forces.csv") in told[0]


# What statics leave aside


def test_statics_have_not_one_instruction_more() -> None:
    """Tables of motion, damping, inertia: the functions of a plain scene are what they were."""
    still = build(given())
    read = given(
        RAMP,
        SHAKEN,
        duration=1.0,
        rods=[rod(damping={"retardation_time": 0.1}, rotary_inertia=[1e-3, 1e-3, 2e-3])],
    )
    moving = build(read)
    for function in ("residual", "jacobian"):
        plain = getattr(still, function)
        assert moving.operations(getattr(moving, function)) == still.operations(plain)


def test_bodies_with_inertia_have_not_one_instruction_more() -> None:
    plain = build(with_body())
    heavy = build(with_body(inertia=[1, 2, 3]))
    assert heavy.operations(heavy.residual) == plain.operations(plain.residual)


# The scene that moves


def test_what_moves_is_free_behind_what_was_free() -> None:
    plain = given()
    assert plain.with_motion_inputs() is plain
    assert given(RAMP).with_motion_inputs().input_names() == plain.input_names()
    moment = {"input": "push.moment", "amplitude": [0, 0, 1], "frequency": 1.0}
    free = given(moment, SHAKEN, moment, inputs=["wind.force"]).with_motion_inputs()
    assert free.input_names() == ("wind.force", "push.moment", "rod.base.position")
    default = given(moment).with_motion_inputs().input_names()
    assert default == (*plain.input_names(), "push.moment")


def test_a_held_scene_has_its_free_bases_clamped() -> None:
    base = {"tangent": [1, 0, 0], "free": True}
    free = with_rod(base=base)
    assert free.rods[0].base.free
    assert free.held() == with_rod(base={"tangent": [1, 0, 0], "free": False})
    clamped = with_rod()
    assert clamped.held() is clamped


def test_a_free_rod_may_be_out_of_reach_of_its_support() -> None:
    far = {"rod": "rod", "kind": "pinned", "position": [9, 0, 0]}
    scene(rods=[rod(base={"free": True})], supports=[far])
    with pytest.raises(SceneError, match="unreachable"):
        scene(supports=[far])


# What is refused


def table(name: str, times: list[float], values: list[Any], **rest: Any) -> dict[str, Any]:
    return {"input": name, "times": times, "values": values, **rest}


def wave(name: str, amplitude: Any, **rest: Any) -> dict[str, Any]:
    return {"input": name, "amplitude": amplitude, "frequency": 1.0, **rest}


def position(*rows: float) -> list[list[float]]:
    return [[x, 0.0, 0.0] for x in rows]


BAD_MOTIONS = {
    "nothing": ({"input": "push.force"}, "times: missing (give times and values, amplitude and frequency, or file)"),
    "two_ways": ({**RAMP, "amplitude": [1, 0, 0]}, "amplitude: stands beside times"),
    "table_and_file": ({**RAMP, "file": "x.csv"}, "file: stands beside times"),
    "no_values": ({"input": "push.force", "times": [0.0]}, "values: missing (times are given)"),
    "no_times": ({"input": "push.force", "values": [[0, 0, 0]]}, "times: missing (values are given)"),
    "no_frequency": ({"input": "push.force", "amplitude": [0, 0, 1]}, "frequency: missing"),
    "no_amplitude": ({"input": "push.force", "frequency": 1.0}, "amplitude: missing"),
    "frequency": ({**wave("push.force", [0, 0, 1]), "frequency": 0.0}, "frequency: must be > 0, got 0.0"),
    "phase_of_a_table": ({**RAMP, "phase": 1.0}, "phase: is for a wave"),
    "wave_of_a_table": ({**RAMP, "wave": "sine"}, "wave: is for a wave"),
    "interpolated_wave": (wave("push.force", [0, 0, 1], interpolation="cubic"), "interpolation: is for a table"),
    "word": ({**RAMP, "interpolation": "spline"}, "must be one of 'linear', 'cubic', 'step', got 'spline'"),
    "not_increasing": (table("push.force", [0.0, 0.5, 0.5], [[0, 0, 0]] * 3), "times[2]: must be > 0.5, the time"),
    "lengths": (table("push.force", [0.0, 0.5], [[0, 0, 0]]), "values: must have one entry for each of 2 times, got 1"),
    "ragged": (table("push.force", [0.0, 0.5], [[0, 0, 0], [1, 2]]), "values[1]: must have as many numbers as the fi"),
    "not_finite": (table("push.force", [0.0], [[0, float("nan"), 0]]), "values[0][1]: must be finite, got nan"),
    "no_rows": (table("push.force", [], []), "times: must have at least one entry"),
    "file_number": ({"input": "push.force", "file": 3}, "file: must be text, got 3"),
    "unknown": (table("pull.force", [0.0], [[0, 0, 0]]), "input: 'pull.force' is no input of this scene (inputs: "),
    "no_dot": (table("push", [0.0], [[0, 0, 0]]), "input: 'push' is no input of this scene"),
    "no_field": (table("push.force.x", [0.0], [0]), "input: 'push.force.x' is no input of this scene"),
    "not_this_one": (table("cable.tension", [0.0], [0]), "input: 'cable.tension' is no input of this scene"),
    "count": (table("push.force", [0.0], [1.0]), "values: must have 3 numbers at each time, got 1"),
    "count_of_a_number": (table("pulled.tension", [0.0], [[1, 2]]), "values: must have 1 number at each time, got 2"),
    "count_of_a_polynomial": (wave("wind.force", [1, 0, 0]), "amplitude: must have 6 numbers at each time, got 3"),
    "jumping_base": (
        table("rod.base.position", [0, 0.5], position(0, 1), interpolation="step"),
        'interpolation: rod.base.position must not jump, and does at 0.5 s (interpolation = "cubic")',
    ),
    "kink_of_a_base": (
        table("rod.base.position", [0, 0.5, 9], position(0, 1, 0)),
        "interpolation: the path of rod.base.position must have a velocity, and has a kink at 0.5 s",
    ),
    "kink_of_a_rod": (
        table("rod.length", [0, 0.5], [0.8, 0.9]),
        "interpolation: the path of rod.length must have a ve",
    ),
    "jumping_cable": (
        table("cable.length", [0, 0.5], [0.8, 0.7], interpolation="step"),
        "interpolation: cable.length must not jump, and does at 0.5 s",
    ),
    "length": (table("rod.length", [0, 2], [0.8, 0.0]), "values: rod.length must stay > 0, and goes to 0 m"),
    "length_wave": (wave("cable.length", -0.8), "amplitude: cable.length must stay > 0, and goes to 0 m"),
    "tension": (table("pulled.tension", [0.0], [-1.0]), "values: pulled.tension must stay >= 0, and goes to -1 N"),
    "tension_wave": (
        wave("pulled.tension", -1.6, wave="one_minus_cosine"),
        "amplitude: pulled.tension must stay >= 0, and goes to -0.2 N",
    ),
    "quaternion": (table("rod.base.quaternion", [0.0], [[0, 0, 0, 0]]), "values: must not be zero"),
    "quaternion_through_zero": (
        table("rod.base.quaternion", [0, 2], [[1, 0, 0, 0], [-1, 0, 0, 0]]),
        "values: rod.base.quaternion must stay away from zero, and its norm falls to 0 of the largest at 1 s: it is "
        "interpolated by component, and normalised (-q is the same rotation as q: change the sign of one of them",
    ),
    "quaternion_near_zero": (
        table("rod.base.quaternion", [0, 2], [[1, 0, 0, 0], [-0.99, 0, 0, 0.14106735979665883]]),
        "values: rod.base.quaternion must stay away from zero, and its norm falls to 0.071 of the largest at 1 s",
    ),
    "quaternion_through_zero_as_cubic": (
        table(
            "rod.base.quaternion",
            [0, 1, 2],
            [[1, 0, 0, 0], [0.6, 0, 0, 0.8], [-0.6, 0, 0, -0.8]],
            interpolation="cubic",
        ),
        "values: rod.base.quaternion must stay away from zero, and its norm falls to 0.082 of the largest at 1.446",
    ),
}


@pytest.mark.parametrize("case", BAD_MOTIONS)
def test_motions_that_are_refused(case: str) -> None:
    motion, sentence = BAD_MOTIONS[case]
    told = refusals(lambda: given(motion, duration=2.0))
    assert len([line for line in told if f"motions[0].{sentence}" in line or sentence in line]) == 1, told
    assert all(line.startswith("motions[0]") for line in told), told


@pytest.mark.parametrize(
    "motions",
    [
        # A steady speed from beginning to end is no kink, nor is what comes after the end.
        [table("rod.base.position", [0, 2], position(0, 1))],
        [table("rod.base.position", [0, 1, 2, 3], position(0, 1, 2, 0))],
        [table("rod.base.position", [0, 0.5, 1], position(0, 1, 0), interpolation="cubic")],
        [table("rod.base.position", [0, 0.5, 1], position(1, 1, 1), interpolation="step")],
        [wave("rod.length", 0.1)],
        [table("cable.length", [0, 0.5, 1], [0.8, 0.7, 0.8])],
        [table("pulled.tension", [0, 0.5], [1, 2], interpolation="step")],
        # Only together are they what the cable is pulled with.
        [table("pulled.tension", [0.0, 1.0], [2.0, 3.0]), table("pulled.tension", [0.0, 1.0], [-1.0, 0.0])],
        [wave("pulled.tension", 3.0), wave("wind.force", [1, 0, 0, 0, 0, 1])],
    ],
)
def test_motions_that_are_allowed(motions: list[dict[str, Any]]) -> None:
    assert len(given(*motions, duration=2.0).motions) == len(motions)


def turned(*degrees: float) -> list[list[float]]:
    """Quaternions of turns about the z axis."""
    halves = np.deg2rad(degrees) / 2
    return [[float(np.cos(half)), 0.0, 0.0, float(np.sin(half))] for half in halves]


@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_half_a_turn_is_allowed_and_a_whole_one_is_not(interpolation: str) -> None:
    """The norm in the middle is the cosine of a quarter of the turn: one of 0.098 is refused, 0.102 is not."""
    for degrees, allowed in ((180.0, True), (336.6, True), (337.5, False), (360.0, False), (382.0, False)):
        turn = table("rod.base.quaternion", [0, 2], turned(0.0, degrees), interpolation=interpolation)
        if allowed:
            assert given(turn, duration=2.0).motions
            continue
        (told,) = refusals(lambda turn=turn: given(turn, duration=2.0))  # type: ignore[misc]
        norm = round(abs(float(np.cos(np.deg2rad(degrees) / 4))), 3)
        assert f"its norm falls to {norm:g} of the largest at 1 s" in told


def test_a_whole_turn_with_times_in_between_is_allowed() -> None:
    steps = table("rod.base.quaternion", [0, 0.5, 1, 2], turned(0, 120, 240, 360), interpolation="cubic")
    assert given(steps, duration=2.0).motions


def test_the_norm_of_a_quaternion_does_not_matter() -> None:
    small = [[0.01 * entry for entry in entries] for entries in turned(0, 180)]
    assert given(table("rod.base.quaternion", [0, 2], small), duration=2.0).motions


@pytest.mark.parametrize("size", [1e-200, 1e-150, 1e150, 1e200, 1e307])
@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_quaternions_of_any_size_are_judged(size: float, interpolation: str) -> None:
    large = [[size * entry for entry in entries] for entries in turned(0, 180)]
    assert given(table("rod.base.quaternion", [0, 2], large, interpolation=interpolation), duration=2.0).motions
    through = [[size, 0, 0, 0], [-size, 0, 0, 0]]
    told = refusals(
        lambda: given(table("rod.base.quaternion", [0, 2], through, interpolation=interpolation), duration=2.0)
    )
    assert any("must stay away from zero" in line for line in told), told


def test_one_value_at_the_beginning_is_a_place() -> None:
    assert given(table("rod.base.quaternion", [0.0], turned(90)), duration=2.0).motions
    assert given(table("rod.base.quaternion", [-2.0, -1.0], turned(90, 90)), duration=2.0).motions


def test_what_comes_after_the_end_of_the_motion_is_left_aside() -> None:
    late = table("rod.base.quaternion", [0, 4], turned(0, 360))
    assert given(late, duration=1.5).motions
    assert refusals(lambda: given(late, duration=2.0))


def test_tables_of_a_quaternion_are_judged_by_their_sum() -> None:
    """Two that pass through zero one by one stay away from it together; two that do not may meet it together."""
    there = table("rod.base.quaternion", [0, 2], [[1, 0, 0, 0], [-1, 0, 0, 0]])
    aside = table("rod.base.quaternion", [0, 1, 2], [[0, 0, 0, 0], [0, 0, 0, 1], [0, 0, 0, 0]], interpolation="cubic")
    assert given(there, aside, duration=2.0).motions
    first = table("rod.base.quaternion", [0, 2], [[1, 0, 0, 0], [-1, 0, 0, 1]])
    second = table("rod.base.quaternion", [0, 2], [[0, 0, 0, 0], [0, 0, 0, -1]])
    assert given(first, duration=2.0).motions
    (told,) = refusals(lambda: given(first, second, duration=2.0))
    assert told.startswith("motions[0].values: rod.base.quaternion must stay away from zero")


def test_bases_that_cannot_move() -> None:
    carried = rod(name="second", base={"rod": "rod"})
    free = rod(name="third", base={"free": True})
    motions = [{**SHAKEN, "input": f"{name}.base.position"} for name in ("second", "third")]
    told = refusals(lambda: scene(rods=[rod(), carried, free], motions=motions))
    assert told == [
        "motions[0].input: 'second' starts on another rod (move the base of that one)",
        "motions[1].input: the base of 'third' is free (nothing holds it, only loads act on it)",
    ]


def test_an_unknown_input_is_told_which_there_are() -> None:
    (told,) = refusals(lambda: scene(push(), motions=[wave("pull.force", 1.0)], rods=[rod(base={"free": True})]))
    assert told.endswith("(inputs: push.force, push.moment, rod.length)")


def test_a_load_of_unknown_kind_has_one_fault() -> None:
    (told,) = refusals(lambda: scene(push(kind="tap"), motions=[RAMP]))
    assert told.startswith("loads[0].kind")


BAD_SIMULATIONS = {
    "no_duration": ({}, "duration: missing"),
    "duration": ({"duration": 0.0}, "duration: must be > 0, got 0.0"),
    "both": ({"duration": 1.0, "frames": 5, "times": [0.0]}, "times: stands beside frames (give one of the two)"),
    "one_frame": ({"duration": 1.0, "frames": 1}, "frames: must be >= 2, got 1"),
    "order": ({"duration": 1.0, "times": [0.0, 0.5, 0.4]}, "times[2]: must be > 0.5, the time before it, got 0.4"),
    "late": ({"duration": 1.0, "times": [0.5, 1.5]}, "times[1]: must be <= duration, got 1.5 of 1.0"),
    "early": ({"duration": 1.0, "times": [-0.5]}, "times[0]: must be >= 0, got -0.5"),
    "no_times": ({"duration": 1.0, "times": []}, "times: must have at least one entry"),
    "start": ({"duration": 1.0, "start": "rest"}, "start: must be one of 'equilibrium', 'unloaded', got 'rest'"),
    "tolerance": ({"duration": 1.0, "tolerance": 0.2}, "tolerance: must be <= 0.1, got 0.2"),
    "step": ({"duration": 1.0, "step": -1e-3}, "step: must be > 0, got -0.001"),
    "long_step": ({"duration": 1.0, "step": 2.0}, "step: must be <= duration, got 2.0 of 1.0"),
    "integrator": (
        {"duration": 1.0, "integrator": "euler"},
        "integrator: must be one of 'radau', 'gauss', got 'euler'",
    ),
}


@pytest.mark.parametrize("case", BAD_SIMULATIONS)
def test_simulations_that_are_refused(case: str) -> None:
    table, sentence = BAD_SIMULATIONS[case]
    (told,) = refusals(lambda: scene(simulation=table))
    assert told.startswith(f"simulation.{sentence}")


BAD_RODS = {
    "both": ({"damping": {"retardation_time": 1.0, "torsion": 1.0}}, "damping.torsion: stands beside retardation_time"),
    "neither": ({"damping": {}}, "damping.retardation_time: missing"),
    "not_admitted": (
        {"damping": {"extension": 1.0}},
        "damping.extension: belongs to a strain that the rod does not admit",
    ),
    "negative_time": ({"damping": {"retardation_time": -1.0}}, "damping.retardation_time: must be >= 0, got -1.0"),
    "negative": ({"damping": {"torsion": [0.0, -1.0]}}, "damping.torsion[1]: must be >= 0, got -1.0"),
    "inertia_of_section": ({**SECTION, "rotary_inertia": [1, 1, 2]}, "rotary_inertia: stands beside material and sec"),
    "no_mass": ({"linear_density": None, "rotary_inertia": [1, 1, 2]}, "linear_density: missing (a rotary inertia be"),
    "negative_inertia": ({"rotary_inertia": [1, -1, 2]}, "rotary_inertia[1]: must be >= 0, got -1"),
    "two_inertias": ({"rotary_inertia": [1, 2]}, "rotary_inertia: must be a list of 3 numbers, got 2"),
    "carried": ({"base": {"rod": "rod", "free": True}}, "base.free: stands beside rod"),
    "free": ({"base": {"free": 1}}, "base.free: must be true or false, got 1"),
}


@pytest.mark.parametrize("case", BAD_RODS)
def test_rods_that_are_refused(case: str) -> None:
    changes, sentence = BAD_RODS[case]
    assert any(line.startswith(f"rods[0].{sentence}") for line in refusals(lambda: with_rod(**changes)))


BAD_INERTIAS = {
    "asymmetric": ([[1, 0.1, 0], [0, 1, 0], [0, 0, 1]], "inertia: must be symmetric"),
    "negative": ([1, -1e-3, 1], "inertia: must have no negative principal moment, got -0.001"),
    "indefinite": ([[1, 2, 0], [2, 1, 0], [0, 0, 1]], "inertia: must have no negative principal moment, got -1"),
    "triangle": ([1, 1, 2.001], "inertia: no body has the principal moments 1, 1, 2.001 (the largest is at most"),
    "two": ([1, 1], "inertia: must be a list of 3 numbers, got 2"),
    "two_rows": ([[1, 0, 0], [0, 1, 0]], "inertia: must be a list of 3 rows of 3 numbers, got 2"),
    "short_row": ([[1, 0, 0], [0, 1], [0, 0, 1]], "inertia[1]: must be a list of 3 numbers, got 2"),
    "text": ("heavy", "inertia: must be a list of 3 numbers, got 'heavy'"),
}


@pytest.mark.parametrize("case", BAD_INERTIAS)
def test_inertias_that_no_body_has(case: str) -> None:
    inertia, sentence = BAD_INERTIAS[case]
    (told,) = refusals(lambda: with_body(inertia=inertia))
    assert told.startswith(f"bodies[0].{sentence}")


def test_all_faults_come_at_once(tmp_path: Path) -> None:
    told = refusals(lambda: from_file(tmp_path, "t,value\n0,nan\n1\n", interpolation="square", phase=1.0))
    assert [line.partition(": ")[0] for line in told] == [
        *["motions[0].file"] * 2,
        "motions[0].interpolation",
        "motions[0].phase",
    ]
