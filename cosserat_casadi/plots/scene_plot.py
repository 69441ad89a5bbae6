"""Figures of a solved scene: the deformed rods with their loads, strain and internal wrench along X.

matplotlib is an extra and is imported inside functions only.
"""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from cosserat_casadi.actuators.routing import offset_at
from cosserat_casadi.equilibrium.solution import Pose, Solution
from cosserat_casadi.errors import CosseratError, Problem, SceneError
from cosserat_casadi.files import write_atomically
from cosserat_casadi.maths.grid import Indices
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.inputs import load_values
from cosserat_casadi.scene import CurveTarget

FORMATS = (".png", ".pdf", ".svg")
"""Suffixes a figure may have."""

SAMPLES = np.linspace(0.0, 1.0, 201)
RODS = ("#4477aa", "#ee6677", "#228833", "#ccbb44", "#66ccee", "#aa3377")
AXES = ("#cc3311", "#228833", "#0055bb")
STROKES = ("-", "--", "-.")
LOADS = "#b2560d"
SLACK = 1e-6
"""Tension below which a cable that may sag is called slack, in units of EI/ℓ²."""

ACTUATORS = ("#cc6677", "#117733", "#332288", "#999933")
BODIES = "#777777"
TARGETS: dict[str, Any] = {"marker": "+", "markersize": 13, "markeredgewidth": 2.0, "color": "#aa3377", "zorder": 10}
JOINTS: dict[str, dict[str, Any]] = {
    "fixed": {"marker": "s", "markersize": 7, "color": "0.35"},
    "spherical": {"marker": "o", "markersize": 8, "markerfacecolor": "white", "markeredgecolor": "0.2"},
}
"""How joints are marked; rods that start on rods are fixed there."""


class PlotUnavailableError(CosseratError):
    """Matplotlib is not installed."""

    def __init__(self) -> None:
        super().__init__("figures need matplotlib: install it with  pip install 'cosserat-casadi[plot]'")


def check_plot_path(path: str | Path) -> None:
    """Refuse a figure that could not be made, before any work is done for it.

    Raises:
        SceneError: the suffix is none of FORMATS.
        PlotUnavailableError: matplotlib is not installed.
    """
    if Path(path).suffix.lower() not in FORMATS:
        remedy = f"use one of {', '.join(FORMATS)}"
        raise SceneError(Problem("--plot", f"{path} has no suffix of a figure that can be drawn", remedy))
    figure_class()


def save_plot(solution: Solution, path: str | Path) -> None:
    """Draw a solution into a file, whole or not at all; the same solution gives the same bytes.

    Raises:
        SceneError: the suffix is none of FORMATS.
        PlotUnavailableError: matplotlib is not installed.
    """
    save_figure(lambda: plot_solution(solution), path)


def save_figure(draw: Callable[[], Any], path: str | Path) -> None:
    """Draw a figure into a file, whole or not at all; the same figure gives the same bytes.

    Args:
        draw: makes the matplotlib.figure.Figure.
        path: the file; its suffix is one of FORMATS.

    Raises:
        SceneError: the suffix is none of FORMATS.
        PlotUnavailableError: matplotlib is not installed.
    """
    check_plot_path(path)
    write_figure(draw(), Path(path))


def write_figure(figure: Any, path: Path, dpi: int = 150) -> None:
    """A matplotlib figure into a file of one of FORMATS, whole or not at all; the same figure gives the same bytes."""
    import matplotlib as mpl

    suffix = path.suffix.lower()[1:]
    metadata = {"png": {"Software": None}, "pdf": {"CreationDate": None, "Producer": None}, "svg": {"Date": None}}
    content = io.BytesIO()
    with mpl.rc_context({"svg.hashsalt": "cosserat"}):
        figure.savefig(content, format=suffix, dpi=dpi, metadata=metadata[suffix])
    write_atomically(path, content.getvalue())


def plot_solution(solution: Solution) -> Any:
    """Figure of a solution.

    Left the rods in space, in the plane where all of the scene lies in a coordinate plane: deformed thick, unloaded
    dashed, section frames (x red, y green, z blue), tendons and chambers, bodies filled, joints, loads as arrows.
    Right, along X: the strains that are admitted, the internal moment and the internal force in the sections' frames.

    Returns:
        matplotlib.figure.Figure.

    Raises:
        PlotUnavailableError: matplotlib is not installed.
    """
    figure = figure_class()(figsize=(13.0, 6.6), layout="constrained")
    grid = figure.add_gridspec(3, 2, width_ratios=(1.5, 1.0))
    plane = _plane(solution)
    scenery = figure.add_subplot(grid[:, 0], projection=None if plane else "3d")
    _draw_scenery(scenery, solution, plane)
    panels = [figure.add_subplot(grid[row, 1]) for row in range(3)]
    for panel, (quantity, columns, unit) in zip(panels, _PANELS, strict=True):
        _draw_panel(panel, solution, quantity, columns, unit)
    panels[-1].set_xlabel("X = s/ℓ, base to tip")
    _draw_title(figure, solution)
    return figure


_PANELS: tuple[tuple[str, tuple[str, ...], str], ...] = (
    ("strain", ("K_x", "K_y", "K_z", "Γ_x", "Γ_y", "Γ_z − 1"), "curvature, 1/m"),
    ("moment", ("M_x", "M_y", "M_z"), "moment, N m"),
    ("force", ("N_x", "N_y", "N_z"), "force, N"),
)


Arrow = tuple[FloatArray, FloatArray, str, str]
"""Where an arrow starts, its vector, its label (empty for a repeated one), and "point", "line" or "moment"."""


def figure_class() -> Any:
    """The class of a figure.

    Raises:
        PlotUnavailableError: matplotlib is not installed.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError as missing:
        raise PlotUnavailableError from missing
    return Figure


def _size(solution: Solution) -> float:
    """Largest extent of the scene, deformed or not, m: what arrows and frames are scaled with."""
    names = solution.model.discrete.rods
    points = [f(solution, name) for name in names for f in (_deformed, _unloaded)]
    return float(np.ptp(np.concatenate(points), axis=0).max())


def _deformed(solution: Solution, name: str) -> FloatArray:
    return solution.pose(SAMPLES, name).position


def _plane(solution: Solution) -> tuple[int, int] | None:
    """World axes of the coordinate plane that holds all rods and forces, moments across it, or None."""
    together = np.concatenate([solution.pose(SAMPLES, name).position for name in solution.model.discrete.rods])
    for flat, axes in ((1, (0, 2)), (2, (0, 1)), (0, (1, 2))):
        level = np.abs(together[:, flat]).max() <= 1e-9 * _size(solution)
        if level and all(_lies_flat(arrow, flat) for arrow in _arrows(solution)):
            return axes
    return None


def _lies_flat(arrow: Arrow, flat: int) -> bool:
    _, vector, _, style = arrow
    largest = np.abs(vector).max()
    outside = np.delete(vector, flat) if style == "moment" else vector[[flat]]
    return bool(np.abs(outside).max() <= 1e-9 * largest)


def _draw_scenery(axes: Any, solution: Solution, plane: tuple[int, int] | None) -> None:
    several, size = len(solution.model.discrete.rods) > 1, _size(solution)
    for i, name in enumerate(solution.model.discrete.rods):
        colour = RODS[i % len(RODS)]
        unloaded = _unloaded(solution, name)
        _line(axes, unloaded, plane, color="0.55", linestyle="--", linewidth=1.2, label=None if i else "unloaded")
        shape = solution.pose(SAMPLES, name).position
        _line(axes, shape, plane, color=colour, linewidth=3.5, label=name if several else "deformed")
        clamped = solution.model.discrete.unloaded.floating_base(name) is None
        style = {"color": "0.2", "marker": "s", "markersize": 9} if clamped else JOINTS["fixed"]
        _line(axes, shape[:1], plane, linestyle="none", **style)
        _draw_frames(axes, solution, name, plane, 0.06 * size)
    _draw_supports(axes, solution, plane)
    _draw_actuators(axes, solution, plane)
    for body in solution.model.scene.bodies:
        _draw_body(axes, solution, body, plane)
    _draw_arrows(axes, solution, plane)
    _draw_targets(axes, solution, plane)
    names = "xyz"
    shown = plane or (0, 1, 2)
    axes.set_xlabel(f"{names[shown[0]]}, m")
    axes.set_ylabel(f"{names[shown[1]]}, m")
    if plane is None:
        axes.set_zlabel("z, m")
        _equal_box(axes, solution)
        axes.view_init(elev=22, azim=-58)
    else:
        axes.set_aspect("equal", adjustable="datalim")
        axes.grid(alpha=0.3)
    axes.legend(loc="upper left", fontsize=9, framealpha=0.9)


def _draw_targets(axes: Any, solution: Solution, plane: tuple[int, int] | None) -> None:
    points = [
        point
        for target in solution.model.scene.targets
        for point in (target.points if isinstance(target, CurveTarget) else (target.position,))
    ]
    if points:
        _line(axes, np.array(points), plane, linestyle="none", label="targets", **TARGETS)


def _unloaded(solution: Solution, name: str) -> FloatArray:
    model = solution.model
    rest = Solution(model, solution.inputs, model.unloaded(), solution.outcome, "", 0.0, 0)
    return rest.pose(SAMPLES, name).position


def _line(axes: Any, points: FloatArray, plane: tuple[int, int] | None, **style: Any) -> None:
    columns = plane or (0, 1, 2)
    axes.plot(*[points[:, c] for c in columns], **style)


def _draw_frames(axes: Any, solution: Solution, name: str, plane: tuple[int, int] | None, length: float) -> None:
    pose = solution.pose(np.linspace(0.0, 1.0, 9), name)
    for position, rotation in zip(pose.position, pose.rotation, strict=True):
        for axis, colour in enumerate(AXES):
            ends = np.array([position, position + length * rotation[:, axis]])
            _line(axes, ends, plane, color=colour, linewidth=1.1)


def _draw_supports(axes: Any, solution: Solution, plane: tuple[int, int] | None) -> None:
    for support in solution.model.scene.supports:
        marker = "s" if support.kind == "clamped" else "^"
        point = np.array([support.position])
        style = {"marker": marker, "markersize": 10, "linestyle": "none", "color": "0.2"}
        _line(axes, point, plane, label=f"{support.kind} tip", **style)


def _draw_actuators(axes: Any, solution: Solution, plane: tuple[int, int] | None) -> None:
    for i, actuator in enumerate(solution.model.scene.actuators):
        state = solution.actuator(actuator.name)
        if actuator.kind == "tendon":
            limp = state["tension"] <= SLACK * solution.model.discrete.tension_unit(actuator.rod)
            effort = "slack" if limp and actuator.slack else f"{state['tension']:.3g} N"
            label, style = f"{actuator.name}: {effort}", {"linewidth": 1.4, "linestyle": ":" if limp else "-"}
        else:
            label, style = f"{actuator.name}: {state['pressure']:.3g} Pa", {"linewidth": 4.0, "alpha": 0.5}
        routing = actuator_routing(solution, actuator)
        _line(axes, routing, plane, color=ACTUATORS[i % len(ACTUATORS)], label=label, **style)
        if actuator.kind == "tendon":
            end = {"marker": "o", "markersize": 4, "linestyle": "none", "color": ACTUATORS[i % len(ACTUATORS)]}
            _line(axes, routing[-1:], plane, **end)


def actuator_routing(solution: Solution, actuator: Any) -> FloatArray:
    """Points of an actuator's routing in the world, shape (k, 3), m: r + R D."""
    start, end = actuator.span
    X = start + (end - start) * SAMPLES
    pose, offset = solution.pose(X, actuator.rod), offset_at(actuator, X)[0]
    return np.asarray(pose.position + np.einsum("kij,jk->ki", pose.rotation[:, :, :2], offset))


def _draw_body(axes: Any, solution: Solution, body: Any, plane: tuple[int, int] | None) -> None:
    """A body as the polygon through its joints, or the line to its centre of mass from a joint that is alone."""
    pose = solution.body(body.name)
    joints = [joint for joint in solution.model.scene.joints if joint.body == body.name]
    points = _in_world(pose, np.array([joint.position for joint in joints]))
    corners = points[_around(points)]
    if len(corners) < 2:
        corners = np.concatenate([corners, _in_world(pose, np.array([body.centre_of_mass]))])
    _fill(axes, corners, plane)
    _line(axes, np.concatenate([corners, corners[:1]]), plane, color=BODIES, linewidth=2.0, label=body.name)
    for joint, point in zip(joints, points, strict=True):
        _line(axes, point[None], plane, linestyle="none", **JOINTS[joint.kind])


def _in_world(pose: Pose, points: FloatArray) -> FloatArray:
    """World coordinates of points of a body, shape (k, 3)."""
    return np.asarray(pose.position[0] + points @ pose.rotation[0].T)


def _around(points: FloatArray) -> Indices:
    """Order of points round their middle, seen along the direction in which they spread least."""
    arms = points - points.mean(axis=0)
    across, up, _ = np.linalg.svd(arms, full_matrices=len(points) < 3)[2][:3]
    return np.argsort(np.arctan2(arms @ up, arms @ across), kind="stable").astype(np.int64)


def _fill(axes: Any, corners: FloatArray, plane: tuple[int, int] | None) -> None:
    if plane is not None:
        axes.fill(*(corners[:, c] for c in plane), color=BODIES, alpha=0.25)
        return
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    axes.add_collection3d(Poly3DCollection([corners], facecolors=BODIES, alpha=0.25))


def _arrows(solution: Solution) -> list[Arrow]:
    model = solution.model
    values = load_values(model.scene, model.inputs, solution.inputs)
    arrows: list[Arrow] = []
    for load in model.scene.loads:
        if load.kind == "gravity":
            arrows += _weights(solution, load, values[load.name]["acceleration"])
            arrows += _body_weights(solution, load, values[load.name]["acceleration"])
        elif load.kind == "distributed_wrench":
            arrows += _distributed(solution, load, values[load.name]["force"])
        else:
            arrows += _points(solution, load, values[load.name])
    return arrows


def _points(solution: Solution, load: Any, values: dict[str, FloatArray]) -> list[Arrow]:
    if load.kind == "body_wrench":
        pose = solution.body(load.body)
        start = _in_world(pose, np.array([load.position]))[0]
    else:
        pose = solution.pose(np.array([getattr(load, "at", 1.0)]), load.rod)
        start = pose.position[0]
    turn = pose.rotation[0] if load.frame == "body" else np.eye(3)
    arrows: list[Arrow] = []
    for field, unit, style in (("force", "N", "point"), ("moment", "N m", "moment")):
        vector = turn @ values[field][:, 0]
        if np.any(vector):
            label = f"{load.name}: {np.linalg.norm(vector):.3g} {unit}"
            arrows.append((start, vector, label, style))
    return arrows


def _body_weights(solution: Solution, load: Any, acceleration: FloatArray) -> list[Arrow]:
    weighed = [b for b in solution.model.scene.bodies if b.mass and load.acts_on_body(b.name)]
    found: list[Arrow] = []
    for body in weighed:
        start = _in_world(solution.body(body.name), np.array([body.centre_of_mass]))[0]
        weight = body.mass * acceleration[:, 0]
        if np.any(weight):
            found.append((start, weight, f"{load.name} of {body.name}: {np.linalg.norm(weight):.3g} N", "point"))
    return found


def _distributed(solution: Solution, load: Any, coefficients: FloatArray) -> list[Arrow]:
    X = np.linspace(0.05, 0.95, 8)
    pose = solution.pose(X, load.rod)
    vectors = np.polynomial.legendre.legval(2 * X - 1, coefficients.T).T
    if load.frame == "body":
        vectors = np.einsum("kij,kj->ki", pose.rotation, vectors)
    label = f"{load.name}: up to {np.linalg.norm(vectors, axis=1).max():.3g} N/m"
    return [
        (position, vector, label if i == 0 else "", "line")
        for i, (position, vector) in enumerate(zip(pose.position, vectors, strict=True))
        if np.any(vector)
    ]


def _weights(solution: Solution, load: Any, acceleration: FloatArray) -> list[Arrow]:
    X = np.linspace(0.05, 0.95, 8)
    arrows: list[Arrow] = []
    for name, discrete_rod in solution.model.discrete.rods.items():
        if discrete_rod.properties.linear_density is None or not load.acts_on_rod(name):
            continue
        weight = discrete_rod.properties.linear_density(X)[:, None] * acceleration[:, 0]
        label = f"{load.name}: up to {np.linalg.norm(weight, axis=1).max():.3g} N/m"
        positions = solution.pose(X, name).position
        arrows += [
            (position, vector, "" if arrows or i else label, "line")
            for i, (position, vector) in enumerate(zip(positions, weight, strict=True))
            if np.any(vector)
        ]
    return arrows


def _draw_arrows(axes: Any, solution: Solution, plane: tuple[int, int] | None) -> None:
    """Arrows scaled within their own kind: the largest point load is a fifth of the rod, a line load a tenth."""
    styles = {"point": (0.22, LOADS, 2.2), "moment": (0.18, "#7a3e9d", 2.2), "line": (0.09, "#c98b4b", 1.0)}
    arrows, size = _arrows(solution), _size(solution)
    for style, (share, colour, width) in styles.items():
        chosen = [arrow for arrow in arrows if arrow[3] == style]
        largest = max((float(np.linalg.norm(vector)) for _, vector, *_ in chosen), default=0.0)
        for start, vector, label, _ in chosen:
            if style == "moment" and plane is not None:
                axes.plot([], [], color=colour, linewidth=width, label=label)
                continue
            scaled = vector * share * size / largest
            _arrow(axes, start, scaled, plane, color=colour, linewidth=width, label=label)
    _show_moments_in_the_plane(axes, arrows, plane)


def _arrow(axes: Any, start: FloatArray, vector: FloatArray, plane: tuple[int, int] | None, **style: Any) -> None:
    label = style.pop("label") or None
    if plane is None:
        axes.quiver(*start, *vector, arrow_length_ratio=0.25, label=label, **style)
        return
    ends = [start[list(plane)], (start + vector)[list(plane)]]
    arrow = {"arrowstyle": "-|>", "color": style["color"], "linewidth": style["linewidth"], "mutation_scale": 14}
    axes.annotate("", xy=ends[1], xytext=ends[0], arrowprops=arrow)
    axes.plot([], [], color=style["color"], linewidth=style["linewidth"], label=label)
    axes.update_datalim(ends)
    axes.autoscale_view()


def _show_moments_in_the_plane(axes: Any, arrows: list[Arrow], plane: tuple[int, int] | None) -> None:
    """A moment across the plane has no arrow in it: a turning sign at its section."""
    if plane is None:
        return
    (across,) = {0, 1, 2} - set(plane)
    for start, vector, _, style in arrows:
        if style == "moment":
            # In the x–z plane the world y axis points away from the reader, so the turn is seen reversed.
            left = (vector[across] > 0) is not (plane == (0, 2))
            point = start[list(plane)]
            axes.annotate("↺" if left else "↻", point, fontsize=20, color="#7a3e9d", ha="center", va="center")


def _equal_box(axes: Any, solution: Solution) -> None:
    names = solution.model.discrete.rods
    together = np.concatenate([f(solution, name) for name in names for f in (_deformed, _unloaded)])
    centre = (together.max(axis=0) + together.min(axis=0)) / 2
    half = 0.55 * max(float(np.ptp(together, axis=0).max()), 0.2 * _size(solution))
    axes.set_xlim(centre[0] - half, centre[0] + half)
    axes.set_ylim(centre[1] - half, centre[1] + half)
    axes.set_zlim(centre[2] - half, centre[2] + half)
    axes.set_box_aspect((1, 1, 1))


def _draw_panel(panel: Any, solution: Solution, quantity: str, labels: tuple[str, ...], unit: str) -> None:
    several, many = (len(solution.model.discrete.rods) > count for count in (1, 2))
    named: set[str] = set()
    panel.set_ylabel(unit)
    # Shear and stretch have no unit and are small beside curvatures: an axis of their own, on the right.
    shown = {False: panel, True: panel.twinx() if _has_linear_strain(solution, quantity) else None}
    for i, (name, discrete_rod) in enumerate(solution.model.discrete.rods.items()):
        values = _values(solution, name, quantity)
        for j, label in enumerate(labels):
            if np.abs(values[:, j]).max() <= 1e-9 * max(np.abs(values).max(), 1e-300):
                continue
            colour = AXES[j % 3] if not several else RODS[i % len(RODS)]
            text = f"{name} {label}" if several else label
            line = "-" if j < 3 else ":"
            if many:  # colours tell the rods, as in the picture beside; strokes tell the components
                text, line = "" if label in named else label, line if j >= 3 else STROKES[j]
                named.add(label)
            shown[j >= 3].plot(SAMPLES, values[:, j], color=colour, linestyle=line, label=text or None)
        for cut in discrete_rod.grid.breaks[1:-1]:
            panel.axvline(cut, color="0.6", linewidth=0.8)
    panel.set_xlim(-0.01, 1.01)
    panel.grid(alpha=0.3)
    _finish_panel([axes for axes in shown.values() if axes is not None])


def _has_linear_strain(solution: Solution, quantity: str) -> bool:
    names = solution.model.discrete.rods
    return quantity == "strain" and any(np.any(_values(solution, name, quantity)[:, 3:]) for name in names)


def _finish_panel(shown: list[Any]) -> None:
    handles = [handle for axes in shown for handle in axes.get_legend_handles_labels()[0]]
    if not handles:
        shown[0].text(0.5, 0.5, "zero", ha="center", va="center", color="0.5", transform=shown[0].transAxes)
        shown[0].set_yticks([])
        return
    shown[-1].legend(handles=handles, fontsize=9, ncols=3, framealpha=0.9)
    for axes in shown:
        _keep_rounding_invisible(axes)
    if len(shown) > 1:
        shown[1].set_ylabel("shear, stretch (dotted)")


def _keep_rounding_invisible(panel: Any) -> None:
    """A constant is drawn as a level line, not as its rounding errors."""
    low, high = panel.get_ylim()
    largest = max(abs(low), abs(high))
    if high - low < 1e-3 * largest:
        middle = (low + high) / 2
        panel.set_ylim(middle - 0.1 * largest, middle + 0.1 * largest)


def _values(solution: Solution, name: str, quantity: str) -> FloatArray:
    if quantity == "strain":
        strain = solution.strain(SAMPLES, name)
        strain[:, 5] -= 1.0
        return strain
    wrench = solution.internal_wrench(SAMPLES, name)
    return wrench[:, :3] if quantity == "moment" else wrench[:, 3:]


def _draw_title(figure: Any, solution: Solution) -> None:
    figure.suptitle(solution.model.scene.title or "Untitled scene", fontsize=14, fontweight="bold")
    parts = [f"residual {solution.residual_norm:.0e}"]
    if solution.error_estimate is not None:
        parts.append(f"estimated tip error {solution.error_estimate:.0e} ℓ")
    if solution.stable is not None:
        parts.append("stable" if solution.stable else "unstable")
    text, colour = ("; ".join(parts), "0.3") if solution.converged else (solution.message, "#cc3311")
    figure.axes[0].set_title(text, fontsize=10, color=colour, wrap=True)
