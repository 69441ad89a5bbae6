"""A parallel robot of three slender rods carries a heavy load over an arch, away from instabilities.

The rods are fed through feet that slide on rails: three lengths and three feet bring the load to a point, and the feet
go no farther from where they want to be than they must. Without regard to stability they stay there, and the legs
buckle on the way. With the stability margin as a constraint they spread before the load gets high, and draw in again
after it.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from cosserat_casadi import Model, Solution, build, scene_from_dict, solve
from cosserat_casadi.control import lifted, stability_margin

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from mpl_toolkits.mplot3d import Axes3D

LEGS = ("leg_1", "leg_2", "leg_3")
ANGLES = np.deg2rad([90.0, 210.0, 330.0])
RAILS = np.column_stack([np.cos(ANGLES), np.sin(ANGLES), np.zeros(3)])
"""Directions of the rails."""

LENGTH, LEAN, PLATE = 0.38, 0.3, 0.04
"""Length of the legs at first, m; how far they lean inwards, rad; radius of the platform, m."""

HOME, NEAREST, FARTHEST = 0.06, 0.03, 0.20
"""Where a foot wants to be on its rail, and its range, m."""

LOAD, HEIGHT = 3.5, 0.03
"""Mass of the load, kg, and how high it stands above the platform, m."""

LEAST = 0.2
"""Least share of the elastic stiffness that the load may leave against the weakest variation."""

FREE, HELD, FELL = "#4477aa", "#228833", "#ee6677"


def robot(modes: int = 4) -> Model:
    """Three rods of glass fibre, clamped in their feet and in the platform."""
    rods: list[dict[str, Any]] = []
    joints: list[dict[str, Any]] = []
    for leg, rail in zip(LEGS, RAILS, strict=True):
        turn = [np.cos(LEAN / 2), np.sin(LEAN / 2) * rail[1], -np.sin(LEAN / 2) * rail[0], 0.0]
        rods.append(
            {
                "name": leg,
                "length": LENGTH,
                "strain": "kirchhoff",
                "material": {"youngs_modulus": 4e10, "shear_modulus": 1.5e10, "density": 1900.0},
                "section": {"shape": "circle", "radius": 1.5e-3},
                "base": {"position": (HOME * rail).tolist(), "quaternion": turn},
            }
        )
        place = {"position": (PLATE * rail).tolist(), "quaternion": turn}
        joints.append({"body": "platform", "rod": leg, "kind": "fixed", **place})
    weight = {"name": "weight", "kind": "gravity", "acceleration": [0.0, 0.0, -9.81]}
    return build(
        scene_from_dict(
            {
                "schema": 1,
                "title": "A parallel robot that carries a load",
                "inputs": [f"{leg}.{what}" for what in ("length", "base.position") for leg in LEGS],
                "accuracy": {"modes": modes},
                "rods": rods,
                "bodies": [{"name": "platform", "mass": LOAD, "centre_of_mass": [0.0, 0.0, HEIGHT]}],
                "joints": joints,
                "loads": [weight],
            }
        )
    )


def arch(stages: int) -> np.ndarray:
    """Points that the load passes, stages×3, m."""
    way = np.linspace(-1.0, 1.0, stages)
    return np.column_stack([0.12 * way, np.zeros(stages), 0.43 - 0.16 * way**2])


def inputs_of(drive: Any) -> Any:
    """Inputs of the model from three lengths and the places of three feet on their rails, m."""
    return ca.vertcat(drive[:3], *[drive[3 + i] * ca.DM(rail) for i, rail in enumerate(RAILS)])


def posing(model: Model, bounded: bool) -> ca.Function:
    """The problem of one stage: the least travel of the feet that brings the load to a point.

    Where it is bounded, the last of its constraints is the margin less what it is to be. Only a few lengths are free to
    choose, so that estimates of the second derivatives serve well; exact ones need fewer steps, each far longer.
    """
    x, drive, point = ca.MX.sym("x", model.size), ca.MX.sym("drive", 6), ca.MX.sym("point", 3)
    inputs = inputs_of(drive)
    state = lifted(model, x, inputs)
    position, _, rotation = model.body["platform"](x, inputs)
    missed = (position + rotation @ ca.DM([0.0, 0.0, HEIGHT]) - point) / LENGTH
    above = [stability_margin(model)(x, inputs) - LEAST] if bounded else []
    problem = {
        "x": ca.vertcat(x, drive),
        "p": point,
        "f": ca.sumsqr(drive[3:] / HOME - 1),
        "g": ca.vertcat(state.residual, missed, *above),
    }
    ipopt = {"print_level": 0, "sb": "yes", "tol": 1e-8, "hessian_approximation": "limited-memory"}
    return ca.nlpsol("posing", "ipopt", problem, {"print_time": False, "ipopt": ipopt, "error_on_fail": True})


def carry(model: Model, points: np.ndarray, *, bounded: bool) -> list[Solution]:
    """Equilibria with the load at points, k×3, with or without the least margin; each is solved anew and judged."""
    solver, near = posing(model, bounded), solve(model, raise_on_failure=True)
    free, upper = np.full(model.size, np.inf), np.zeros(solver.size1_out("g"))
    upper[model.size + 3 :] = np.inf
    limits = {
        "lbg": 0.0,
        "ubg": upper,
        "lbx": np.concatenate([-free, np.full(3, 0.5 * LENGTH), np.full(3, NEAREST)]),
        "ubx": np.concatenate([free, np.full(3, 1.5 * LENGTH), np.full(3, FARTHEST)]),
    }
    state, found = np.concatenate([near.x, np.full(3, LENGTH), np.full(3, HOME)]), []
    for point in points:
        state = solver(x0=state, p=point, **limits)["x"].full()[:, 0]
        x, inputs = state[: model.size], ca.DM(inputs_of(state[model.size :])).full()[:, 0]
        found.append(solve(model, model.inputs.unpack(inputs), start=x, raise_on_failure=True))
    return found


def place_of_load(solution: Solution) -> np.ndarray:
    """Where the load is, m."""
    platform = solution.body()
    return np.asarray(platform.position + platform.rotation @ [0.0, 0.0, HEIGHT])


def margins(equilibria: list[Solution]) -> np.ndarray:
    """Margins of equilibria of one model."""
    margin = stability_margin(equilibria[0].model)
    return np.array([float(margin(solution.x, solution.inputs)) for solution in equilibria])


def draw_robot(space: Axes3D, solution: Solution, colour: str, alpha: float = 1.0) -> None:
    """Legs, platform and load."""
    platform, load = solution.body(), place_of_load(solution)
    corners = platform.position + PLATE * RAILS @ platform.rotation.T
    for leg in LEGS:
        line = solution.pose(np.linspace(0.0, 1.0, 25), leg).position
        space.plot(*line.T, color=colour, alpha=alpha, linewidth=1.6)
        space.plot(*line[0], color=colour, alpha=alpha, marker="s", markersize=4)
    space.plot(*np.vstack([corners, corners[:1]]).T, color="0.25", alpha=alpha, linewidth=1.5)
    space.plot(*load, color="0.15", alpha=alpha, marker="o", markersize=9)


def set_scene(space: Axes3D, title: str, points: np.ndarray) -> None:
    """Rails, path and the same frame for every picture."""
    for rail in RAILS:
        space.plot(*np.outer([NEAREST, 0.15], rail).T, color="0.75", linewidth=3, solid_capstyle="round")
    space.plot(*points.T, color="0.4", linestyle=":", linewidth=1.2)
    space.set(xlim=(-0.14, 0.14), ylim=(-0.10, 0.15), zlim=(0.0, 0.5))
    space.set_title(title, y=0.94)
    space.set_box_aspect((0.28, 0.25, 0.5), zoom=1.05)
    space.view_init(elev=14, azim=-72)
    space.set_axis_off()


def set_panel(panel: Axes, ways: np.ndarray, without: np.ndarray, bounded: np.ndarray) -> None:
    """Margins along the path."""
    panel.axhspan(min(without.min() * 1.15, -0.02), 0.0, color=FELL, alpha=0.12, linewidth=0)
    panel.axhline(LEAST, color="0.5", linestyle="--", linewidth=1)
    panel.text(0.0, LEAST - 0.01, "least that is allowed", va="top", ha="center", fontsize=8, color="0.4")
    panel.text(0.0, -0.01, "unstable", va="top", ha="center", fontsize=8, color=FELL)
    panel.plot(ways, without, color=FREE, marker="o", markersize=3.5, label="feet stay")
    panel.plot(ways, bounded, color=HELD, marker="o", markersize=3.5, label="margin held")
    panel.set(xlabel="place of the load along x, m", ylabel="stability margin: elastic stiffness left")
    panel.margins(y=0.02)
    panel.legend(loc="upper center", frameon=False)


def colour_of(solution: Solution, colour: str) -> str:
    """The colour of its robot, that of a fall where it is unstable."""
    return colour if solution.stable else FELL


def draw(points: np.ndarray, without: list[Solution], bounded: list[Solution], file: Path) -> None:
    """Both robots in some poses, and the margins."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(13.0, 4.8), layout="constrained")
    shown = np.unique(np.linspace(0, len(points) - 1, 5).round().astype(int))
    titles = ("feet stay: unstable where red", "margin held: the feet spread")
    for i, (equilibria, colour, title) in enumerate(zip((without, bounded), (FREE, HELD), titles, strict=True), 1):
        space = figure.add_subplot(1, 3, i, projection="3d")
        for k in shown:
            alpha = 1.0 if k == shown[len(shown) // 2] else 0.45
            draw_robot(space, equilibria[k], colour_of(equilibria[k], colour), alpha)
        set_scene(space, title, points)
    set_panel(figure.add_subplot(1, 3, 3), points[:, 0], margins(without), margins(bounded))
    figure.savefig(file, dpi=150)


def animate(points: np.ndarray, without: list[Solution], bounded: list[Solution], file: Path) -> None:
    """The load carried over the arch and back."""
    from matplotlib.animation import FuncAnimation, PillowWriter
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 3.6))
    FigureCanvasAgg(figure)
    figure.subplots_adjust(left=0.0, right=0.985, bottom=0.14, top=0.9, wspace=0.1)
    spaces = [figure.add_subplot(1, 3, i, projection="3d") for i in (1, 2)]
    panel = figure.add_axes((0.70, 0.15, 0.285, 0.75))
    set_panel(panel, points[:, 0], margins(without), margins(bounded))
    (cursor,) = panel.plot([points[0, 0]] * 2, panel.get_ylim(), color="0.3", linewidth=1)
    pairs = list(zip(without, bounded, strict=True))

    def show(k: int) -> None:
        for space, solution, colour, title in zip(
            spaces, pairs[k], (FREE, HELD), ("feet stay", "margin held"), strict=True
        ):
            space.clear()
            set_scene(space, title if solution.stable else f"{title}: unstable", points)
            draw_robot(space, solution, colour_of(solution, colour))
        cursor.set_xdata([points[k, 0]] * 2)

    there = list(range(len(points)))
    film = FuncAnimation(figure, show, [*there, *there[-2:0:-1]])
    film.save(file, PillowWriter(fps=12), dpi=90)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--stages", type=int, default=13, help="points on the path, at least 2")
    parser.add_argument("--output", type=Path, default=Path("carry_load.png"), help="figure")
    parser.add_argument("--animation", type=Path, help="GIF to write too")
    arguments = parser.parse_args()
    model, points = robot(), arch(arguments.stages)
    without, bounded = (carry(model, points, bounded=held) for held in (False, True))
    draw(points, without, bounded, arguments.output)
    for name, equilibria in (("feet stay", without), ("margin held", bounded)):
        missed = np.abs([place_of_load(solution) for solution in equilibria] - points).max()
        stable = sum(solution.stable is True for solution in equilibria)
        print(f"{name}: {stable} of {len(points)} stable, least margin {margins(equilibria).min():.4f}", end="; ")
        print(f"the load is within {missed:.1e} m of its path")
    print(f"wrote {arguments.output}")
    if arguments.animation is not None:
        animate(points, without, bounded, arguments.animation)
        print(f"wrote {arguments.animation}")


if __name__ == "__main__":
    main()
