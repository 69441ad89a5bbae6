"""Figures: what they show is what was solved, and files are whole and the same every time."""

from __future__ import annotations

import builtins
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from PIL import Image

from cosserat_casadi import Outcome, SceneError, Solution, build, modes_of, parse_scene, read_scene, solve
from cosserat_casadi.cli.exit_codes import REFUSED
from cosserat_casadi.model.scene_rods import rod_properties
from cosserat_casadi.motion.vibration_modes import Modes
from cosserat_casadi.plots import modes_plot
from cosserat_casadi.plots.arrows import MOST_LINE_ARROWS
from cosserat_casadi.plots.canvas import CORNER, Canvas
from cosserat_casadi.plots.colours import AXES, FAILURE, PLAIN_TEXT
from cosserat_casadi.plots.figure import PlotUnavailableError, add_title, check_plot_path, figure_class
from cosserat_casadi.plots.material_plot import plot_materials, stress_curves
from cosserat_casadi.plots.modes_plot import mode_words, plot_modes
from cosserat_casadi.plots.scene_plot import plot_solution
from cosserat_casadi.plots.scenery import RIM
from cosserat_casadi.plots.solved_shapes import SAMPLES
from cosserat_casadi.plots.sweep_plot import plot_sweep
from cosserat_casadi.plots.tubes_plot import _between, plot_tubes
from cosserat_casadi.sweeps.outcome_table import Sweep
from cosserat_casadi.tubes.tube_solution import TubeShape
from tests.commands import cosserat
from tests.conftest import ROOT
from tests.families import mostly_slow
from tests.mjcf.moved_chains import LOOPS
from tests.scenes import HOOK, WEIGHT, WIND, push, rod, scene
from tests.tubes.pendulum import Pendulum


@pytest.fixture(scope="module")
def spatial() -> Solution:
    return solve(build(scene(push(moment=[0.1, 0.2, 0.1]), WEIGHT, HOOK, WIND, strain="reissner")))


@pytest.fixture(scope="module")
def planar() -> Solution:
    flat = {"force": [0.5, 0, -0.3], "moment": [0, 0.4, 0]}
    return solve(build(scene(push(**flat), {**WEIGHT, "acceleration": [0, 0, -2.0]}, strain="planar")))


def lines(axes: Any) -> dict[str, Any]:
    return {line.get_label(): line for line in axes.get_lines()}


def test_space_shows_rod_loads_and_frames(spatial: Solution) -> None:
    scenery, *_ = plot_solution(spatial).axes
    assert scenery.name == "3d"
    labels = scenery.get_legend_handles_labels()[1]
    assert {"unloaded", "deformed"} <= set(labels)
    for load in ("push", "hook", "weight", "wind"):
        assert any(label.startswith(load) for label in labels)
    drawn = np.array(lines(scenery)["deformed"].get_data_3d()).T
    assert_allclose(drawn, spatial.pose(SAMPLES).position, rtol=0, atol=1e-15)
    # Nine section frames of three axes, the two shapes and the base.
    assert len(scenery.get_lines()) == 9 * 3 + 3


def test_a_plane_scene_is_drawn_in_its_plane(planar: Solution) -> None:
    scenery, *_ = plot_solution(planar).axes
    assert scenery.name == "rectilinear"
    drawn = lines(scenery)["deformed"].get_xydata()
    assert_allclose(drawn, planar.pose(SAMPLES).position[:, [0, 2]], rtol=0, atol=1e-15)
    assert (scenery.get_xlabel(), scenery.get_ylabel()) == ("x, m", "z, m")
    assert any(text.get_text() in "↺↻" for text in scenery.texts if text.get_text())


@pytest.mark.parametrize("angle", [0.6, 2.5])
def test_a_plane_that_stands_askew_is_drawn_as_a_plane_too(angle: float) -> None:
    """A planar rod in a plane turned about the vertical: the picture is that of the same rod in the x–z plane."""
    towards = np.array([np.cos(angle), np.sin(angle), 0.0])
    across = np.array([-np.sin(angle), np.cos(angle), 0.0])
    push_askew = push(force=(0.5 * towards - [0, 0, 0.3]).tolist(), moment=(0.4 * across).tolist())
    turned = {"position": [0.0, 0.0, 0.0], "quaternion": [np.cos(angle / 2), 0, 0, np.sin(angle / 2)]}
    askew = solve(build(scene(push_askew, rods=[rod(strain="planar", base=turned)])))
    scenery = plot_solution(askew).axes[0]
    assert scenery.name == "rectilinear"
    right = towards * np.sign(towards[0])
    drawn = lines(scenery)["deformed"].get_xydata()
    position = askew.pose(SAMPLES).position
    assert_allclose(drawn, np.stack([position @ right, position[:, 2]], axis=1), rtol=0, atol=1e-9)
    assert scenery.get_xlabel() == f"along ({right[0]:.3g}, {right[1]:.3g}, 0), m"
    assert scenery.get_ylabel() == "z, m"
    # A moment about the normal that points away from the reader is seen clockwise.
    (sign,) = [text.get_text() for text in scenery.texts if text.get_text()]
    assert sign == {True: "↻", False: "↺"}[bool(towards[0] > 0)]


@pytest.mark.parametrize(("tolerance", "side", "colour"), [(0.1, "within", PLAIN_TEXT), (1e-12, "above", FAILURE)])
def test_a_figure_says_whether_the_error_is_within_the_tolerance(tolerance: float, side: str, colour: str) -> None:
    solution = solve(build(scene(push(), accuracy={"modes": 2, "nodes": 4, "tolerance": tolerance})))
    subtitle = plot_solution(solution).axes[0].title
    assert f"{side} the tolerance of {tolerance:g}" in subtitle.get_text()
    assert subtitle.get_color() == colour


def test_panels_hold_strain_moment_and_force(spatial: Solution) -> None:
    _, strain, moment, force, linear = plot_solution(spatial).axes
    assert_allclose(lines(strain)["K_y"].get_ydata(), spatial.strain(SAMPLES)[:, 1], rtol=0, atol=1e-15)
    assert_allclose(lines(linear)["Γ_z − 1"].get_ydata(), spatial.strain(SAMPLES)[:, 5] - 1, rtol=0, atol=1e-15)
    wrench = spatial.internal_wrench(SAMPLES)
    assert_allclose(lines(moment)["M_x"].get_ydata(), wrench[:, 0], rtol=0, atol=1e-15)
    assert_allclose(lines(force)["N_z"].get_ydata(), wrench[:, 5], rtol=0, atol=1e-15)


def test_components_that_are_zero_are_not_drawn(planar: Solution) -> None:
    _, strain, moment, _ = plot_solution(planar).axes
    assert [line.get_label() for line in strain.get_lines()] == ["K_y"]
    assert [line.get_label() for line in moment.get_lines()] == ["M_y"]


def test_rounding_alone_is_zero() -> None:
    """A planar rod that hangs straight bends by 1e-50 /m or so, where its force is 1 N."""
    solution = solve(build(scene(push(force=[0.0, 0.0, 1.0]), strain="planar")))
    _, strain, moment, force = plot_solution(replace(solution, x=solution.x + 1e-30)).axes
    assert [len(panel.get_lines()) for panel in (strain, moment)] == [0, 0]
    assert [line.get_label() for line in force.get_lines()] == ["N_z"]


def test_several_rods_are_named() -> None:
    other = rod(name="other", base={"position": [0.3, 0, 0]})
    solution = solve(build(scene(push(), rods=[rod(), other])))
    figure = plot_solution(solution)
    labels = figure.axes[0].get_legend_handles_labels()[1]
    assert {"rod", "other"} <= set(labels)
    # Colours tell the rods in all panels: strokes of components are named once, in no rod's colour.
    for panel in figure.axes[1:]:
        legend = panel.get_legend()
        if legend is not None:
            named = [text.get_text() for text in legend.get_texts()]
            assert len(named) == len(set(named))
            assert {handle.get_color() for handle in legend.get_lines()} == {"0.3"}


@pytest.mark.parametrize(("count", "frames"), mostly_slow([(2, 4), (5, 0)], quick=[(2, 4)]))
def test_many_rods_are_not_hidden_by_axes_and_arrows(count: int, frames: int) -> None:
    several = [rod("planar", name=f"rod_{i}", base={"position": [0.1 * i, 0, 0]}) for i in range(count)]
    scenery = plot_solution(solve(build(scene({**WEIGHT, "acceleration": [0, 0, -2.0]}, rods=several)))).axes[0]
    drawn = scenery.get_lines()
    colours = [line.get_color() for line in drawn]
    assert [colours.count(colour) for colour in AXES] == [count * frames] * 3
    arrows = [text for text in scenery.texts if getattr(text, "arrow_patch", None) is not None]
    assert 9 < len(arrows) <= MOST_LINE_ARROWS


def test_axes_of_space_have_one_number_at_their_corner(spatial: Solution) -> None:
    scenery = plot_solution(spatial).axes[0]
    (_, right), (front, _) = scenery.get_xlim(), scenery.get_ylim()
    room = CORNER * np.ptp([scenery.get_xlim(), scenery.get_ylim(), scenery.get_zlim()], axis=1).max()
    at_right = [tick for tick in scenery.get_xticks() if right - room < tick <= right]
    at_front = [tick for tick in scenery.get_yticks() if front <= tick < front + room]
    assert len(scenery.get_yticks()) >= 2
    assert not (at_right and at_front)


@pytest.mark.parametrize("small", [False, True])
def test_numbers_of_a_tall_box_stand_beside_its_edge(small: bool) -> None:
    figure = figure_class()(figsize=(4.0, 6.0))
    axes = figure.add_subplot(projection="3d")
    canvas = Canvas(axes, None, 1.0, small=small)
    canvas.label_axes()
    canvas.equalise(np.array([[0.0, 0.0, 0.0], [0.02, 0.01, 1.0]]))
    figure.draw_without_rendering()
    edge = axes.transData.transform(np.transpose(axes.zaxis.line.get_data()))[:, 0].max()
    low, high = axes.get_zlim()
    numbers = [tick.label1 for tick in axes.zaxis.get_major_ticks() if low <= tick.get_loc() <= high]
    assert len(numbers) >= 2
    for number in numbers:
        assert 2.0 < number.get_window_extent().x0 - edge < 30.0


def boxes(figure: Any) -> tuple[list[Any], list[Any]]:
    """Where all axes and all legends of a figure are, pixels."""
    figure.draw_without_rendering()
    legends = [axes.get_legend() for axes in figure.axes if axes.get_legend() is not None]
    axes_boxes = [axes.get_window_extent() for axes in figure.axes]
    return axes_boxes, [legend.get_window_extent() for legend in [*figure.legends, *legends]]


@pytest.mark.parametrize("kind", mostly_slow(["spatial", "planar"], quick=["spatial"]))
def test_legends_cover_nothing(kind: str, request: pytest.FixtureRequest) -> None:
    axes_boxes, legend_boxes = boxes(plot_solution(request.getfixturevalue(kind)))
    assert len(legend_boxes) == 4
    for legend in legend_boxes:
        for axes in axes_boxes:
            width = min(legend.x1, axes.x1) - max(legend.x0, axes.x0)
            height = min(legend.y1, axes.y1) - max(legend.y0, axes.y0)
            # A pixel is the line around the axes.
            assert min(width, height) < 1.0


def test_powers_of_ten_stand_beside_legends() -> None:
    thin = rod("planar", stiffness={"bending_y": 1e-6})
    figure = plot_solution(solve(build(scene(push(force=[1e-6, 0, 0]), rods=[thin]))))
    figure.draw_without_rendering()
    moment = figure.axes[2]
    power = moment.yaxis.get_offset_text()
    assert power.get_text().startswith("1e−")
    assert not power.get_window_extent().overlaps(moment.get_legend().get_window_extent())


def test_axes_of_space_have_one_scale(spatial: Solution) -> None:
    scenery = plot_solution(spatial).axes[0]
    limits = np.array([scenery.get_xlim(), scenery.get_ylim(), scenery.get_zlim()])
    widths = np.ptp(limits, axis=1)
    # matplotlib gives the sides of its box by no public name.
    sides = scenery._box_aspect
    assert_allclose(sides / sides.max(), widths / widths.max(), rtol=1e-12, atol=0)
    drawn = spatial.pose(SAMPLES).position
    assert np.all(drawn > limits[:, 0])
    assert np.all(drawn < limits[:, 1])


@pytest.mark.slow
def test_many_rods_differ_in_colour_or_marks() -> None:
    many = [rod(name=f"rod_{i}", base={"position": [0.1 * i, 0, 0]}) for i in range(8)]
    scenery = plot_solution(solve(build(scene(WEIGHT, rods=many)))).axes[0]
    drawn = lines(scenery)
    styles = {(drawn[f"rod_{i}"].get_color(), drawn[f"rod_{i}"].get_marker()) for i in range(8)}
    assert len(styles) == 8


def test_an_unconverged_solution_says_so_in_red(planar: Solution) -> None:
    stalled = replace(planar, outcome=Outcome.LOAD_STALLED, message=Outcome.LOAD_STALLED.value)
    title = plot_solution(stalled).axes[0].title
    assert title.get_text() == Outcome.LOAD_STALLED.value
    assert title.get_color() == "#cc3311"


@pytest.mark.parametrize(
    ("suffix", "signature"),
    mostly_slow([("png", b"\x89PNG"), ("pdf", b"%PDF"), ("svg", b"<?xml")], quick=[("png", b"\x89PNG")]),
)
def test_files_are_the_same_every_time(planar: Solution, tmp_path: Path, suffix: str, signature: bytes) -> None:
    first, second = tmp_path / f"a.{suffix}", tmp_path / f"b.{suffix}"
    planar.write(first)
    planar.write(second)
    assert first.read_bytes().startswith(signature)
    assert first.read_bytes() == second.read_bytes()


def test_unknown_suffix_is_refused_and_nothing_written(planar: Solution, tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"cannot be written to .*png"):
        planar.write(tmp_path / "figure.doc")
    assert list(tmp_path.iterdir()) == []


def test_missing_matplotlib_is_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def without(name: str, *rest: Any, **options: Any) -> Any:
        if name.startswith(("matplotlib", "cosserat_casadi.plots.shown_figure")):
            raise ImportError(name)
        return real(name, *rest, **options)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(PlotUnavailableError, match=r"pip install 'cosserat-casadi\[plot\]'"):
        check_plot_path("figure.png")


# The figure of materials: its curves are those of the laws, and linear scenes have none.


MATERIALS = ROOT / "examples" / "three_materials.toml"


def test_curves_are_those_of_the_laws() -> None:
    rubber, wire, lattice = read_scene(MATERIALS).rods
    (measured,) = stress_curves(rod_properties(lattice))
    assert_allclose(np.interp([-10.0, 5.0], measured.change, measured.stress), [-0.034, 0.020], rtol=2e-3, atol=0)
    # Beyond the last point there is no law.
    assert np.array_equal(measured.inside, np.abs(measured.change) < 40.0)
    assert 40.0 < measured.change[-1] <= 52.0
    # The line of small strains is the slope of the curve, not that of Young's modulus.
    near = np.abs(measured.change) < 0.5
    assert_allclose(measured.stress[near], measured.linear[near], rtol=2e-2, atol=0)
    (superelastic,) = stress_curves(rod_properties(wire))
    steep = np.abs(superelastic.change) * 0.5e-3 < 0.008
    assert_allclose(superelastic.stress[steep], superelastic.linear[steep], rtol=1e-12, atol=0)
    assert [curve.component for curve in stress_curves(rod_properties(rubber))] == [1, 5]


def test_every_curve_has_a_panel() -> None:
    figure = plot_materials(read_scene(MATERIALS))
    titles = [panel.get_title() for panel in figure.axes if panel.get_visible()]
    assert titles == ["rubber: bending y", "rubber: extension", "wire: bending y", "lattice: bending y"]
    words = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert words == ["small strains", "material", "beyond its law"]


def test_linear_scene_has_no_figure(tmp_path: Path) -> None:
    wire = ROOT / "examples" / "planar_strip.toml"
    with pytest.raises(SceneError, match="the scene has none"):
        plot_materials(read_scene(wire))
    ended = cosserat("check", str(wire), "--plot", "laws.png", cwd=tmp_path)
    assert ended.returncode == REFUSED
    assert not list(tmp_path.iterdir())
    assert "the scene has none" in " ".join(ended.stderr.split())


# Figures of concentric tubes: the line between stations.


CURVATURE = 3.0
LENGTH = 0.5


def distance_from_arc(stations: int) -> float:
    """Largest distance of the drawn line from the arc of a circle that its stations lie on, m."""
    s = np.linspace(0.0, LENGTH, stations)
    turned = CURVATURE * s
    zeros = np.zeros(stations)
    position = np.stack([(1.0 - np.cos(turned)) / CURVATURE, zeros, np.sin(turned) / CURVATURE], axis=1)
    quaternion = np.stack([np.cos(turned / 2.0), zeros, np.sin(turned / 2.0), zeros], axis=1)
    none = np.zeros((stations, 0))
    line, frames = TubeShape(s, position, quaternion, none, none).between(np.linspace(0.0, LENGTH, 12 * stations))
    assert_allclose(line[-1], position[-1], rtol=0, atol=1e-15)
    assert_allclose(frames[-1], quaternion[-1], rtol=0, atol=1e-15)
    radius = np.hypot(line[:, 0] - 1.0 / CURVATURE, line[:, 2])
    return float(np.abs(radius - 1.0 / CURVATURE).max())


def test_an_arc_is_drawn_to_order_four() -> None:
    coarse = distance_from_arc(5)
    assert coarse < 2e-5
    assert np.log2(coarse / distance_from_arc(9)) == pytest.approx(4.0, abs=0.2)


def test_a_station_off_by_rounding_belongs_to_both_sides() -> None:
    distance = np.array([0.0, 0.1, 0.30000000000000004, 0.5])
    assert _between(distance, 0.0, 0.3).tolist() == [True, True, True, False]
    assert _between(distance, 0.3, 0.5).tolist() == [False, False, True, True]


def test_each_tube_has_one_colour_in_space_and_beside() -> None:
    figure = plot_tubes(solve(Pendulum(1.0).scene(1.0, tolerance=1e-4)))
    in_space, beside = ({line.get_label(): line.get_color() for line in axes.get_lines()} for axes in figure.axes)
    assert in_space["outer"] != in_space["inner"]
    assert {name: in_space[name] for name in ("outer", "inner")} == {name: beside[name] for name in ("outer", "inner")}


def test_angles_of_tubes_are_curves_through_their_stations() -> None:
    solution = solve(Pendulum(1.0).scene(1.0, tolerance=1e-4))
    panel = plot_tubes(solution).axes[1]
    assert panel.get_ylabel() == f"angle of the tube less {solution.robot.names[0]}.rotation, rad"
    for index, name in enumerate(solution.robot.names):
        distance, angles = next(line.get_data() for line in panel.get_lines() if line.get_label() == name)
        here = solution.shape.distance <= distance[-1]
        at_stations = np.interp(solution.shape.distance[here], distance, angles)
        assert_allclose(at_stations, solution.shape.angles[here, index] - solution.inputs[0], rtol=0, atol=1e-3)
        assert len(distance) > 5 * len(np.unique(solution.shape.distance[here]))


def test_a_tube_that_does_not_leave_the_plate_is_drawn() -> None:
    robot = read_scene(ROOT / "examples" / "concentric_tubes.toml")
    solution = solve(robot, {"outer.translation": 0.0})
    lines = {line.get_label(): line.get_xdata() for line in plot_tubes(solution).axes[1].get_lines()}
    assert len(lines["outer"]) == 1
    assert len(lines["inner"]) > 1


# The workspace figure: its panels, its points, the same bytes twice.


POSE = ("rod.x", "rod.y", "rod.z", "rod.qw", "rod.qx", "rod.qy", "rod.qz")


def swept(*, planar: bool, failing: bool = False) -> Sweep:
    """Made-up results: 40 rows over two inputs."""
    rng = np.random.default_rng(8)
    values = rng.uniform(-1.0, 1.0, (40, 2 + 2 + 7))
    if planar:
        values[:, 5] = 0.0
    outcomes = np.zeros(40, dtype=np.int64)
    if failing:
        outcomes[::4] = 4
        values[::4, 4:] = np.nan
    return Sweep(("a.b", "c.d"), ("iterations", "residual", *POSE), values, outcomes, {"title": "Made up"})


def test_points_of_a_plane_are_one_map() -> None:
    sweep = swept(planar=True)
    figure = plot_sweep(sweep)
    panel, bar = figure.axes
    assert (panel.get_xlabel(), panel.get_ylabel(), bar.get_ylabel()) == ("x, m", "z, m", "a.b")
    points = panel.collections[0].get_offsets()
    assert_allclose(points, sweep.positions()[:, [0, 2]], rtol=0, atol=1e-12)
    assert_allclose(panel.collections[0].get_array(), sweep["a.b"], rtol=0, atol=0)


def test_points_in_space_are_seen_from_four_sides() -> None:
    figure = plot_sweep(swept(planar=False), "rod.qw")
    assert [axes.get_xlabel() for axes in figure.axes[:4]] == ["x, m", "x, m", "x, m", "y, m"]
    assert figure.axes[1].name == "3d"
    assert figure.axes[4].get_ylabel() == "rod.qw"
    # More numbers than these stand on each other where they have four digits.
    assert len(figure.axes[0].xaxis.get_major_locator().tick_values(0.139, 0.159)) <= 6


def test_rows_that_failed_are_shown_among_the_inputs() -> None:
    sweep = swept(planar=True, failing=True)
    figure = plot_sweep(sweep, "outcome")
    panel, inputs = figure.axes
    assert len(panel.collections[0].get_offsets()) == 30
    assert "10 without a result" in panel.get_title()
    assert [text.get_text() for text in inputs.get_legend().get_texts()] == ["converged", "load stalled"]
    assert_allclose(inputs.collections[1].get_offsets(), sweep.values[::4, :2], rtol=0, atol=0)


def test_nothing_converged() -> None:
    sweep = swept(planar=True)
    nothing = Sweep(sweep.swept, sweep.found, sweep.values, np.full(40, 2), sweep.record)
    assert "0 of 40 rows" in plot_sweep(nothing).axes[0].get_title()


@pytest.mark.slow
def test_the_same_sweep_gives_the_same_bytes(tmp_path: Path) -> None:
    for name in ("a.png", "b.png"):
        swept(planar=False, failing=True).write(tmp_path / name)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
    with pytest.raises(SceneError):
        swept(planar=True).write(tmp_path / "a.bmp")
    with pytest.raises(KeyError, match="'none' is no column"):
        plot_sweep(swept(planar=True), "none")


# What figures and animations of modes show.


ROUND = {"bending_x": 1.0, "bending_y": 1.0, "torsion": 0.05}


@pytest.fixture(scope="module")
def modes() -> Modes:
    """Bending in two planes, then torsion."""
    soft = rod("kirchhoff", stiffness=ROUND, rotary_inertia=[0.0, 0.0, 0.02], damping={"bending_x": 1e-3})
    return modes_of(scene(rods=[soft]), count=3)


def test_one_panel_a_mode_in_the_plane_that_holds_it(modes: Modes) -> None:
    figure = plot_modes(modes)
    labels = [(axes.get_xlabel(), axes.get_ylabel()) for axes in figure.axes]
    bending = sorted(label for label, axes in zip(labels, figure.axes, strict=True) if axes.name != "3d")
    assert bending == [("x, m", "z, m"), ("y, m", "z, m")]
    assert [axes.name for axes in figure.axes].count("3d") == 1
    for index, axes in enumerate(figure.axes):
        assert axes.get_title() == mode_words(modes.modes[index], index)


def test_modes_in_a_plane_that_stands_askew_are_drawn_in_it() -> None:
    turned = {"quaternion": [np.cos(0.3), 0, 0, np.sin(0.3)]}
    figure = plot_modes(modes_of(scene(rods=[rod("planar", base=turned)]), count=2))
    assert [axes.name for axes in figure.axes] == ["rectilinear", "rectilinear"]
    assert figure.axes[0].get_xlabel() == "along (0.825, 0.565, 0), m"


def test_both_ends_of_a_swing_lie_about_the_equilibrium(modes: Modes) -> None:
    axes = next(axes for axes in plot_modes(modes).axes if axes.get_xlabel() == "x, m" and axes.name != "3d")
    rest, _, back, there = (line.get_xydata() for line in axes.get_lines()[:4])
    assert_allclose((back + there) / 2, rest, rtol=0, atol=1e-12)
    # A fifth of the rod's length, however large the mode's own numbers are.
    assert_allclose(np.abs(there - rest).max(), 0.2 * 0.8, rtol=1e-9, atol=0)


def test_words_of_a_damped_mode(modes: Modes) -> None:
    words = [mode_words(mode, index) for index, mode in enumerate(modes.modes)]
    damped = [text for text in words if "ζ" in text]
    assert len(damped) == 1
    assert all("Hz" in text for text in words)


def test_figure_and_animation_are_written(modes: Modes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(modes_plot, "PERIOD_FRAMES", 8)
    modes.write(tmp_path / "m.png")
    modes.write(tmp_path / "again.png")
    assert (tmp_path / "m.png").read_bytes() == (tmp_path / "again.png").read_bytes()
    torsion = next(index for index, axes in enumerate(plot_modes(modes).axes) if axes.name == "3d")
    shares: list[float] = []
    modes.animate(tmp_path / "m.gif", mode=torsion + 1, progress=shares.append)
    assert shares[-1] == 1.0
    with Image.open(tmp_path / "m.gif") as film:
        # Sections that only turn are seen to turn.
        assert film.n_frames == 8


def test_a_long_title_fits_into_a_narrow_figure() -> None:
    figure = figure_class()(figsize=(6.0, 4.0), layout="constrained")
    add_title(figure, " ".join(["tendons"] * 20))
    title = figure.get_suptitle()
    assert title.replace("\n", " ") == " ".join(["tendons"] * 20)
    figure.draw_without_rendering()
    extent = figure._suptitle.get_window_extent()
    assert extent.x0 >= 0.0
    assert extent.x1 <= figure.bbox.width


def test_the_legend_names_a_body_that_is_a_disk_and_a_row_once() -> None:
    """On a plane without a width the disks of a row are bodies too."""
    puck = {"name": "puck", "mass": 0.001, "radius": 12e-3, "thickness": 3e-3}
    disks = {"name": "spacers", "rod": "rod", "count": 2, "radius": 8e-3, "thickness": 2e-3}
    wall = {"name": "wall", "kind": "plane", "point": [5.0, 0, 0], "normal": [-1, 0, 0], "disks": ["spacers"]}
    joint = {"body": "puck", "rod": "rod", "at": 0.5, "kind": "fixed"}
    given = scene(
        push(force=[0.1, 0, 0]), strain="planar", bodies=[puck], joints=[joint], disks=[disks], obstacles=[wall]
    )
    axes = plot_solution(solve(build(given))).axes[0]
    rims = [line for line in axes.get_lines() if line.get_xdata().shape == (2 * RIM,)]
    assert len(rims) == 3
    assert [line.get_label() for line in rims if not line.get_label().startswith("_")] == ["puck", "spacers"]


@pytest.mark.parametrize(("depth", "is_shown"), [(0.3, True), (5.0, False)])
def test_obstacles_that_the_legend_names_are_drawn(depth: float, is_shown: bool) -> None:
    """A table below a straight rod is as far from it as axes of one scale reach; one far below is not shown."""
    level = rod("planar", base={"tangent": [1, 0, 0]})
    table = {"name": "table", "kind": "plane", "point": [0, 0, -depth], "normal": [0, 0, 1], "width": 0.01}
    solution = solve(build(scene(push(force=[0.1, 0, 0]), rods=[level], obstacles=[table])))
    axes = plot_solution(solution).axes[0]
    assert ("table" in lines(axes)) == is_shown
    assert bool(axes.collections) == is_shown


def test_axes_hold_the_bodies_of_a_loop() -> None:
    solution = solve(build(parse_scene(LOOPS["slider-crank"])))
    axes = plot_solution(solution).axes[0]
    places = np.array([[0.0, 0.0, 0.0], solution.body("slider").position])
    for limits, coordinates in zip((axes.get_xlim(), axes.get_ylim(), axes.get_zlim()), places.T, strict=True):
        assert limits[0] <= coordinates.min() and coordinates.max() <= limits[1]
