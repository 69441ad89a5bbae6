"""A tendon finger traces a circle under gravity at least effort, with bounds on its tensions.

All stages are one optimisation problem: at each the rod's unknowns are variables and its equilibrium a constraint.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import casadi as ca
import numpy as np

from cosserat_casadi import Model, Solution, build, scene_from_dict, solve
from cosserat_casadi.control import judged, lifted

LENGTH, RADIUS, LARGEST = 0.10, 0.03, 6.0
"""Length of the finger and radius of the circle, m; largest tension, N."""

SMOOTHNESS = 0.1
"""Weight of the change of the tensions from stage to stage."""

ANGLES = np.deg2rad([90.0, 210.0, 330.0])


def finger() -> Model:
    """A silicone finger that stands out horizontally, with three tendons."""
    tendons = [
        {
            "name": f"tendon_{i}",
            "kind": "tendon",
            "rod": "finger",
            "tension": 1.0,
            "offset": [5e-3 * np.cos(angle), 5e-3 * np.sin(angle)],
        }
        for i, angle in enumerate(ANGLES, 1)
    ]
    rod = {
        "name": "finger",
        "length": LENGTH,
        "strain": "kirchhoff",
        "material": {"youngs_modulus": 1.2e6, "poisson_ratio": 0.48, "density": 1070.0},
        "section": {"shape": "circle", "radius": [8e-3, 6e-3]},
        "base": {"tangent": [1.0, 0.0, 0.0]},
    }
    weight = {"name": "weight", "kind": "gravity", "acceleration": [0.0, 0.0, -9.81]}
    return build(
        scene_from_dict(
            {
                "schema": 1,
                "title": "A finger that traces a circle",
                "inputs": [f"{tendon['name']}.tension" for tendon in tendons],
                "accuracy": {"modes": 4, "tolerance": 1e-3},
                "rods": [rod],
                "loads": [weight],
                "actuators": tendons,
            }
        )
    )


def trace(model: Model, stages: int) -> tuple[np.ndarray, list[Solution]]:
    """Tensions, stages×3, N, whose tip passes the circle across the finger's axis, and the equilibria there."""
    angles = 2 * np.pi * np.arange(stages) / stages
    circle = RADIUS * np.column_stack([np.cos(angles), np.sin(angles)])
    near = solve(model)
    opti = ca.Opti()
    tensions = opti.variable(3, stages)
    states = [lifted(model, opti.variable(model.size), tensions[:, k], near) for k in range(stages)]
    for k, state in enumerate(states):
        opti.subject_to(state.residual == 0)
        tip = model.tip["finger"](state.x, tensions[:, k])[0]
        opti.subject_to((tip[1:] - ca.DM(circle[k])) / LENGTH == 0)
        opti.set_initial(state.x, state.start)
    opti.subject_to(opti.bounded(0, ca.vec(tensions), LARGEST))
    change = ca.horzcat(tensions[:, 1:], tensions[:, :1]) - tensions
    opti.minimize(ca.sumsqr(tensions) + SMOOTHNESS * ca.sumsqr(change))
    opti.set_initial(tensions, 1.0)
    opti.solver("ipopt", {"print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes", "ipopt.tol": 1e-9})
    found = opti.solve()
    tensions_found = np.clip(np.reshape(found.value(tensions), (3, stages)), 0.0, LARGEST)
    starts = [np.asarray(found.value(state.x)) for state in states]
    equilibria = [judged(model, start, column) for column, start in zip(tensions_found.T, starts, strict=True)]
    for k, equilibrium in enumerate(equilibria):
        if not equilibrium.converged or equilibrium.within_tolerance is False:
            raise SystemExit(f"stage {k}: {equilibrium.message}")
    return tensions_found.T, equilibria


def draw(tensions: np.ndarray, equilibria: list[Solution], file: Path) -> None:
    """The finger at every stage beside the tensions."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11.0, 5.0), layout="constrained")
    figure.get_layout_engine().set(wspace=0.15)
    space = figure.add_subplot(1, 2, 1, projection="3d")
    for solution in equilibria:
        space.plot(*solution.pose(np.linspace(0, 1, 41)).position.T, color="#4477aa", alpha=0.6)
    tips = np.array([solution.tip().position for solution in [*equilibria, equilibria[0]]])
    space.plot(*tips.T, color="#ee6677", marker="o", markersize=4)
    space.set(xlabel="x, m", ylabel="y, m", zlabel="z, m")
    space.set_aspect("equal")
    panel = figure.add_subplot(1, 2, 2)
    panel.plot(np.degrees(2 * np.pi * np.arange(len(tensions)) / len(tensions)), tensions, marker="o")
    panel.axhline(LARGEST, color="0.5", linestyle="--")
    panel.set(xlabel="angle on the circle, degrees", ylabel="tension, N")
    panel.legend([f"tendon {i}" for i in (1, 2, 3)])
    figure.savefig(file, dpi=150)


def animate(tensions: np.ndarray, equilibria: list[Solution], file: Path) -> None:
    """The finger on its way round beside what its tendons pull."""
    from matplotlib.animation import FuncAnimation, PillowWriter
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.0, 3.4), layout="constrained")
    space = figure.add_subplot(1, 2, 1, projection="3d")
    shapes = [solution.pose(np.linspace(0, 1, 41)).position for solution in equilibria]
    tips = np.array([shape[-1] for shape in [*shapes, shapes[0]]])
    space.plot(*tips.T, color="#ee6677")
    (finger_line,) = space.plot(*shapes[0].T, color="#4477aa", linewidth=4)
    space.set(xlim=(0, LENGTH), ylim=(-RADIUS, RADIUS), zlim=(-RADIUS, RADIUS), xlabel="x, m", ylabel="y, m")
    space.set_aspect("equal")
    space.locator_params(nbins=4)
    panel = figure.add_subplot(1, 2, 2)
    bars = panel.bar(["1", "2", "3"], tensions[0], color="#228833")
    panel.axhline(LARGEST, color="0.5", linestyle="--")
    panel.set(xlabel="tendon", ylabel="tension, N", ylim=(0, 1.1 * LARGEST))

    def frame(k: int) -> list[object]:
        finger_line.set_data_3d(*shapes[k].T)
        for bar, height in zip(bars, tensions[k], strict=True):
            bar.set_height(height)
        return [finger_line, *bars]

    FuncAnimation(figure, frame, len(equilibria)).save(file, PillowWriter(fps=12), dpi=80)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--stages", type=int, default=24, help="points on the circle, at least 3")
    parser.add_argument("--output", type=Path, default=Path("trace_circle.png"), help="figure")
    parser.add_argument("--animation", type=Path, help="the finger in motion, a .gif")
    arguments = parser.parse_args()
    tensions, equilibria = trace(finger(), arguments.stages)
    draw(tensions, equilibria, arguments.output)
    effort = float(np.mean(np.sum(tensions**2, axis=1)))
    stable = sum(solution.stable is True for solution in equilibria)
    print(f"mean square tension {effort:.4g} N², largest {tensions.max():.4g} N; {stable} of {len(tensions)} stable")
    error = max(solution.error_estimate for solution in equilibria)
    print(f"estimated error of the tips at most {error:.1g} of the length")
    print(f"wrote {arguments.output}")
    if arguments.animation:
        animate(tensions, equilibria, arguments.animation)
        print(f"wrote {arguments.animation}")


if __name__ == "__main__":
    main()
