"""What the figure of a motion shows."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgb
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from cosserat_casadi import SceneError
from cosserat_casadi.motion.trajectory import Motion, MotionOutcome
from cosserat_casadi.plots.colours import rod_colour
from cosserat_casadi.plots.motion_plot import (
    SHAPES,
    _faded,
    _share_of_colour,
    plot_motion,
    shown_rows,
)
from cosserat_casadi.plots.moving_shapes import SECTIONS, moving_shapes
from cosserat_casadi.plots.scenery import CLAMP
from tests.motions import motion_of, planar_swing, swinging_rod, two_rods_on_a_platform, with_energies, without_start
from tests.scenes import push, rod, scene


@pytest.fixture(scope="module")
def planar() -> Motion:
    return planar_swing(frames=31)


@pytest.fixture(scope="module")
def platform() -> Motion:
    return two_rods_on_a_platform(frames=31)


def rod_lines(axes: Any) -> list[Any]:
    """Lines with as many points as rods are drawn with."""
    return [line for line in axes.get_lines() if len(np.atleast_1d(line.get_data()[0])) == len(SECTIONS)]


def panels(figure: Any) -> dict[str, Any]:
    return {axes.get_ylabel(): axes for axes in figure.axes}


def test_shapes_fade_from_early_to_late_in_their_plane(planar: Motion) -> None:
    scenery = plot_motion(planar).axes[0]
    assert scenery.name == "rectilinear"
    assert (scenery.get_xlabel(), scenery.get_ylabel()) == ("x, m", "z, m")
    lines = rod_lines(scenery)
    assert len(lines) == SHAPES
    rows = shown_rows(planar.times)
    for line, row in zip(lines, rows, strict=True):
        expected = planar.section(None, SECTIONS).position[row][:, [0, 2]]
        assert_allclose(line.get_xydata(), expected, rtol=0, atol=1e-14)
    # Brightness falls from shape to shape, down to the rod's own colour.
    brightness = [sum(to_rgb(line.get_color())) for line in lines]
    assert np.all(np.diff(brightness) < 0)
    assert_allclose(to_rgb(lines[-1].get_color()), to_rgb(rod_colour(0)), rtol=0, atol=1e-12)


def test_a_motion_in_a_plane_that_stands_askew_is_drawn_in_it() -> None:
    angle = 0.6
    right = np.array([np.cos(angle), np.sin(angle), 0.0])
    turned = {"quaternion": [np.cos(angle / 2), 0, 0, np.sin(angle / 2)]}
    flat = scene(push(force=(0.9 * right).tolist()), rods=[rod("planar", base=turned)])
    motion = motion_of(flat, {"push.force": (-0.8 * right).tolist()})
    scenery = plot_motion(motion).axes[0]
    assert scenery.name == "rectilinear"
    last = rod_lines(scenery)[-1].get_xydata()
    position = motion.section(None, SECTIONS).position[-1]
    assert_allclose(last, np.stack([position @ right, position[:, 2]], axis=1), rtol=0, atol=1e-9)


def test_shapes_are_evenly_spaced_in_time_wherever_the_rows_lie() -> None:
    # Rows crowd at the start: by number alone, most shapes would show nothing but that.
    times = np.linspace(0.0, 1.0, 201) ** 3
    chosen = times[shown_rows(times)]
    assert len(chosen) == SHAPES
    assert_allclose(np.diff(chosen), 1 / (SHAPES - 1), rtol=0.2, atol=0)
    assert shown_rows(np.array([0.0, 1.0])) == [0, 1]


def test_path_of_the_tip_is_coloured_by_time_and_its_ends_marked(planar: Motion) -> None:
    figure = plot_motion(planar)
    scenery = figure.axes[0]
    (path,) = [collection for collection in scenery.collections if isinstance(collection, LineCollection)]
    tip = planar.tip().position[:, [0, 2]]
    assert_allclose(np.array(path.get_segments())[:, 0], tip[:-1], rtol=0, atol=1e-14)
    assert_allclose(path.get_array(), (planar.times[:-1] + planar.times[1:]) / 2, rtol=1e-14, atol=0)
    marks = {line.get_label(): line.get_xydata()[0] for line in scenery.get_lines()}
    assert_allclose(marks["start of a path"], tip[0], rtol=0, atol=1e-14)
    assert_allclose(marks["its end"], tip[-1], rtol=0, atol=1e-14)
    assert "time, s" in panels(figure)


def test_limits_hold_the_whole_motion(planar: Motion, platform: Motion) -> None:
    flat = plot_motion(planar).axes[0]
    points = planar.section(None, SECTIONS).position.reshape(-1, 3)
    for limits, axis in ((flat.get_xlim(), 0), (flat.get_ylim(), 2)):
        assert limits[0] < points[:, axis].min()
        assert limits[1] > points[:, axis].max()

    space = plot_motion(platform).axes[0]
    assert space.name == "3d"
    points = np.concatenate([platform.section(name, SECTIONS).position.reshape(-1, 3) for name in ("left", "right")])
    limits = np.array([space.get_xlim(), space.get_ylim(), space.get_zlim()])
    assert np.all(limits[:, 0] < points.min(axis=0))
    assert np.all(limits[:, 1] > points.max(axis=0))
    # matplotlib gives the sides of its box by no public name.
    sides = space._box_aspect
    assert_allclose(np.ptp(limits, axis=1) / np.ptp(limits[0]), sides / sides[0], rtol=1e-12, atol=0)


def test_bodies_are_outlined_and_followed(platform: Motion) -> None:
    shapes = moving_shapes(platform.model, platform.times, platform.x, platform.inputs)
    # The tips of both rods go with the body, whose path stands for theirs.
    assert list(shapes.followed) == ["platform"]
    outline = shapes.outlines["platform"]
    assert_allclose(outline[:, 0], outline[:, -1], rtol=0, atol=1e-15)
    # Only at its ends does the made-up motion keep the joints closed.
    for row in (0, -1):
        tips = np.array([platform.tip(name).position[row] for name in ("left", "right")])
        by_x = np.argsort(outline[row, :2, 0])
        assert_allclose(outline[row, by_x], tips, rtol=0, atol=1e-8)


def test_of_a_rod_that_is_held_the_middle_is_followed() -> None:
    aside = {"rod": "rod", "kind": "pinned", "position": [0.1, 0.0, 0.75]}
    side_load = {"name": "side", "kind": "point_wrench", "rod": "rod", "at": 0.5, "force": [0.0, 0.0, 0.0]}
    held = motion_of(scene(side_load, supports=[aside]), {"side.force": [0.0, 3.0, 0.0]}, frames=5)
    shapes = moving_shapes(held.model, held.times, held.x, held.inputs)
    assert_allclose(shapes.followed["rod"], held.section(None, [0.5]).position[:, 0], rtol=0, atol=1e-12)


def test_inputs_that_move_have_a_panel_for_each_quantity(platform: Motion) -> None:
    by_label = panels(plot_motion(platform))
    forces = by_label["force, N"].get_lines()
    assert [line.get_label() for line in forces] == ["crown.force.x", "crown.force.y", "crown.force.z"]
    assert_allclose(forces[1].get_ydata()[[0, -1]], [0.0, 0.9], rtol=1e-14, atol=1e-15)
    (tension,) = by_label["tension, N"].get_lines()
    assert_allclose(tension.get_ydata()[[0, -1]], [5.0, 30.0], rtol=1e-14, atol=0)
    # The weight does not change.
    assert not any("m/s²" in label for label in by_label)


def test_energies_and_their_imbalance(planar: Motion) -> None:
    by_label = panels(plot_motion(with_energies(planar, dissipated=np.zeros(len(planar.times)))))
    energies = {line.get_label(): line.get_ydata() for line in by_label["energy, J"].get_lines()}
    assert list(energies) == ["kinetic", "elastic", "potential", "work", "impacts"]
    assert_allclose(energies["work"], planar.energy.work, rtol=0, atol=0)
    imbalance = by_label["imbalance /\nlargest energy"]
    assert imbalance.get_yscale() == "log"
    drawn = imbalance.get_lines()[0].get_ydata()
    # The motion starts in balance, which has no logarithm.
    assert np.isnan(drawn[0])
    assert_allclose(drawn[1:], np.abs(planar.energy.imbalance[1:]), rtol=0, atol=0)


def test_an_imbalance_at_one_time_is_a_point(planar: Motion) -> None:
    last = np.append(np.zeros(len(planar.times) - 1), 1e-9)
    panel = panels(plot_motion(with_energies(planar, imbalance=last)))["imbalance /\nlargest energy"]
    (line,) = panel.get_lines()
    assert line.get_marker() == "."
    assert np.flatnonzero(line.get_markevery()).tolist() == [len(planar.times) - 1]


def test_an_imbalance_within_a_power_of_ten_is_between_two(planar: Motion) -> None:
    """Else numbers such as 1.3e-13 stand at the axis."""
    even = with_energies(planar, imbalance=np.linspace(1.2e-13, 1.8e-13, len(planar.times)))
    panel = panels(plot_motion(even))["imbalance /\nlargest energy"]
    assert_allclose(panel.get_ylim(), [1e-13, 1e-12], rtol=1e-12, atol=0)


def test_a_motion_that_rests_has_panels_that_say_so(planar: Motion) -> None:
    none = np.zeros(len(planar.times))
    still = replace(with_energies(planar, **dict.fromkeys(vars(planar.energy), none)), inputs=0 * planar.inputs)
    by_label = panels(plot_motion(still))
    assert not any(label.startswith("force") for label in by_label)
    for label in ("energy, J", "imbalance /\nlargest energy"):
        assert [text.get_text() for text in by_label[label].texts] == ["zero"]


def test_a_motion_that_ended_early_says_so_in_red(planar: Motion) -> None:
    outcome = MotionOutcome.STEP_TOO_SMALL
    title = plot_motion(replace(planar, outcome=outcome, message=outcome.value)).axes[0].title
    assert title.get_text() == outcome.value
    assert title.get_color() == "#cc3311"


def test_motions_of_one_time_and_of_none_can_be_drawn(tmp_path: Path) -> None:
    swinging_rod(frames=1).write(tmp_path / "one.png")
    without_start().write(tmp_path / "none.png")
    figure = plot_motion(without_start())
    assert figure.axes == []
    assert MotionOutcome.NO_START.value in [text.get_text() for text in figure.texts]


@pytest.mark.parametrize("frames", range(2, SHAPES + 1))
def test_the_last_shape_has_its_own_colour_however_many_are_drawn(frames: int) -> None:
    # The first rod is drawn without red, of which rounding must leave no less than nothing.
    shares = [_share_of_colour(order, frames) for order in range(frames)]
    assert np.all(np.diff(shares) > 0)
    assert shares[-1] == 1
    assert min(_faded(rod_colour(0), shares[-1])) >= 0


def test_colours_and_strokes_tell_many_curves_apart() -> None:
    many = [push(name=f"push_{k}", force=[0.1, 0.1, 0.1]) for k in range(4)]
    values = {f"push_{k}.force": [0.2, 0.3, 0.4] for k in range(4)}
    lines = panels(plot_motion(motion_of(scene(*many, rods=[rod()]), values, frames=3)))["force, N"].get_lines()
    styles = {(line.get_color(), line.get_linestyle()) for line in lines}
    assert len(lines) == len(styles) == 12


def test_of_very_many_curves_those_that_vary_most_are_named() -> None:
    """Coefficients of a wave: a legend of all would be wider than the panel, and the small ones are one entry."""
    many = [push(name=f"push_{k}", force=[0.1, 0.1, 0.1]) for k in range(7)]
    moving = {f"push_{k}.force": [0.1 + 1e-3 * k, 0.1 + 2e-3 * k, 0.1 + 3e-3 * k] for k in range(1, 7)}
    moving["push_0.force"] = [0.2, 0.3, 0.4]
    lines = panels(plot_motion(motion_of(scene(*many, rods=[rod()]), moving, frames=3)))["force, N"].get_lines()
    assert len(lines) == 21
    names = [line.get_label() for line in lines if not line.get_label().startswith("_")]
    assert len(names) == 8
    assert "14 more" in names
    assert {"push_0.force.x", "push_0.force.y", "push_0.force.z"} <= set(names)


@pytest.mark.slow
@pytest.mark.parametrize("suffix", ["png", "pdf", "svg"])
def test_files_are_the_same_every_time(platform: Motion, tmp_path: Path, suffix: str) -> None:
    first = tmp_path / f"a.{suffix}"
    second = tmp_path / f"b.{suffix}"
    platform.write(first)
    platform.write(second)
    assert first.read_bytes() == second.read_bytes()


def test_unknown_suffix_is_refused(planar: Motion, tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"cannot be written to .*use one of"):
        planar.write(tmp_path / "figure.doc")
    assert list(tmp_path.iterdir()) == []


def test_marks_of_joints_move_with_their_bodies(platform: Motion) -> None:
    shapes = moving_shapes(platform.model, platform.times, platform.x, platform.inputs)
    bases = [places for style, places in shapes.marks if style == CLAMP]
    joints = [places for style, places in shapes.marks if style != CLAMP]
    rods = list(shapes.rods.values())
    assert len(joints) == len(platform.model.scene.joints)
    for places, lines in zip(bases, rods, strict=True):
        assert_allclose(places[:, 0], lines[:, 0], rtol=0, atol=1e-15)
    for joint, places in zip(platform.model.scene.joints, joints, strict=True):
        # The motion is made up: joints are closed at its start alone.
        assert_allclose(places[0, 0], shapes.rods[joint.rod][0, -1], rtol=0, atol=1e-9)
        poses = platform.body("platform")
        turned = Rotation.from_quat(np.roll(poses.quaternion, -1, axis=1)).apply(joint.position)
        assert_allclose(places[:, 0], poses.position + turned, rtol=0, atol=1e-14)


@pytest.mark.parametrize("thickness", [0.0, 0.01])
def test_a_disk_on_a_joint_moves_as_its_rims(thickness: float) -> None:
    disk = {"name": "disk", "mass": 0.05, "radius": 0.06, "thickness": thickness}
    joint = {"body": "disk", "rod": "rod", "kind": "fixed"}
    motion = motion_of(scene(push(), bodies=[disk], joints=[joint]), {"push.force": [-0.6, 0.4, 0.3]})
    shapes = moving_shapes(motion.model, motion.times, motion.x, motion.inputs)
    assert [style for style, _ in shapes.marks] == [CLAMP]
    poses = motion.body("disk")
    rotations = Rotation.from_quat(np.roll(poses.quaternion, -1, axis=1))
    for row, rotation in enumerate(rotations):
        in_disk = rotation.inv().apply(shapes.outlines["disk"][row] - poses.position[row])
        assert_allclose(np.hypot(in_disk[:, 0], in_disk[:, 1]), 0.06, rtol=0, atol=1e-14)
        assert_allclose(np.abs(in_disk[:, 2]), thickness / 2, rtol=0, atol=1e-14)
