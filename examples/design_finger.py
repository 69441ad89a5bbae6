"""The taper of a finger and the course of its two tendons, chosen for the largest reachable area.

A soft finger stands upright with a load at its tip and bends in a plane. Its tensions go round the square of those that
are admissible; the tip goes round an area. The equilibria are variables of one optimisation problem beside the design:
the area, the balance and the stability margin of every equilibrium have exact first and second derivatives.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi import Model, Solution, build, scene_from_dict, solve
from cosserat_casadi.control import lifted, stability_margin
from cosserat_casadi.maths.typing import FloatArray, Matrix

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LENGTH, LARGEST, WEIGHT = 0.10, 6.0, 0.3
"""Length of the finger, m; largest tension and weight at the tip, N."""

Design = Mapping[str, npt.ArrayLike]
"""Values of the parameters by name."""

START: Design = {
    "finger.section.radius": [8e-3, 7e-3],
    "flexor.offset.x": [-4e-3, 0.0],
    "extensor.offset.x": [4e-3, 0.0],
    "extensor.span.end": 0.6,
}
"""The design to start from: radii at base and tip, m; offsets of the tendons at the base and their growth to the tip,
m; where the extensor ends, as a share of the length."""

THINNEST, THICKEST = 4e-3, 1.2e-2
"""Bounds of the radii, m."""

WALL = 1e-3
"""Least distance of a tendon from the surface, m."""

SHORTEST, LONGEST = 0.3, 0.8
"""Bounds of the place where the extensor ends."""

FINE = 80
"""Cases that the area is drawn and judged with, more than the optimisation sees."""

MARGIN = 0.25
"""Least stability margin: smallest eigenvalue of the second variation, in elastic stiffnesses of the start."""


def finger(design: Design = START, modes: int = 3) -> Model:
    """A silicone finger whose flexor ends at its tip, its extensor before; the design is what its scene says."""
    radii, flexor, extensor, (end,) = [np.ravel(design[name]).tolist() for name in START]
    rod = {
        "name": "finger",
        "length": LENGTH,
        "strain": "planar",
        "material": {"youngs_modulus": 1.2e6, "poisson_ratio": 0.48, "density": 1070.0},
        "section": {"shape": "circle", "radius": radii},
        "base": {"tangent": [0.0, 0.0, 1.0]},
    }
    weight = {"name": "weight", "kind": "tip_wrench", "rod": "finger", "force": [0.0, 0.0, -WEIGHT]}
    tendon = {"kind": "tendon", "rod": "finger", "tension": 0.0}
    return build(
        scene_from_dict(
            {
                "schema": 1,
                "title": "A finger to be designed",
                "inputs": ["flexor.tension", "extensor.tension"],
                "parameters": list(START),
                "accuracy": {"modes": modes},
                "rods": [rod],
                "loads": [weight],
                "actuators": [
                    {**tendon, "name": "flexor", "offset": [flexor, 0.0]},
                    {**tendon, "name": "extensor", "offset": [extensor, 0.0], "span": [0.0, end]},
                ],
            }
        )
    )


def tensions_around(cases: int) -> FloatArray:
    """Tensions of flexor and extensor, cases×2, N, evenly along the edge of the admissible square; cases ≥ 4."""
    corners = LARGEST * np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]])
    along = 4 * np.arange(cases) / cases
    return np.column_stack([np.interp(along, range(5), corners[:, i]) for i in (0, 1)])


def area_of(tips: Matrix) -> Matrix:
    """Area of a polygon by Gauss's formula, positive anticlockwise; its corners are the columns of a 2×K matrix."""
    following = ca.horzcat(tips[:, 1:], tips[:, 0])
    return ca.sum2(tips[0, :] * following[1, :] - tips[1, :] * following[0, :]) / 2


def volume_of(radii: Matrix) -> Matrix:
    """Volume of a cone frustum with these radii at base and tip, m³."""
    base, tip = radii[0], radii[1]
    return np.pi * LENGTH / 3 * (base**2 + base * tip + tip**2)


@dataclass(frozen=True)
class Problem:
    """The optimisation problem of a design with its lifted equilibria.

    Attributes:
        design: p over its unit, symbols, shape (7,).
        states: unknowns of the rod in every case, symbols.
        area: what the tips enclose, over the length squared.
        balance: residuals of all cases, zero at equilibria.
        room: what no design may take below zero: distances of tendons from the surface over the unit of lengths,
            what is left of the material over the volume of the start, margins of the cases over the least one.
        start: values of design and states to start from.
    """

    design: Matrix
    states: list[Matrix]
    area: Matrix
    balance: Matrix
    room: Matrix
    start: FloatArray

    @property
    def variables(self) -> Matrix:
        """Design and states in one column."""
        return ca.vertcat(self.design, *self.states)


UNITS = np.array([1e-3] * 6 + [1.0])
"""Unit of each number of the design: a millimetre, but one for the place along the rod."""


def problem_of(model: Model, tensions: FloatArray) -> Problem:
    """The problem of the largest area, from the equilibria of the start."""
    design = ca.MX.sym("design", len(UNITS))
    p = ca.DM(UNITS) * design
    states = []
    starts = [model.parameters.pack() / UNITS]
    residuals = []
    tips = []
    margins = []
    margin = stability_margin(model, parameters=True)
    for k, pair in enumerate(tensions):
        near = solve(model, dict(zip(model.inputs.names, pair, strict=True)), raise_on_failure=True)
        state = lifted(model, ca.MX.sym(f"x{k}", model.size), ca.DM(pair), near, p)
        position = model.tip["finger"](state.x, pair, p)[0]
        tips.append(ca.vertcat(position[0], position[2]) / LENGTH)
        residuals.append(state.residual)
        margins.append(margin(state.x, pair, p) - MARGIN)
        states.append(state.x)
        starts.append(state.start)
    material = 1 - volume_of(p[:2]) / volume_of(ca.DM(START["finger.section.radius"]))
    room = ca.vertcat(tendon_room(design), material, *margins)
    return Problem(design, states, area_of(ca.horzcat(*tips)), ca.vertcat(*residuals), room, np.concatenate(starts))


def tendon_room(design: Matrix) -> Matrix:
    """What is left between the tendons and the surface on either side, at both of their ends, in millimetres."""
    base, tip, flexor, flexor_growth, extensor, extensor_growth, end = ca.vertsplit(design)
    offsets = ca.vertcat(flexor, flexor + flexor_growth, extensor, extensor + extensor_growth * end)
    radii = ca.vertcat(base, tip, base, base + (tip - base) * end)
    largest = radii - WALL / 1e-3
    return ca.vertcat(largest - offsets, largest + offsets)


def designed(model: Model, tensions: FloatArray) -> tuple[dict[str, FloatArray], float]:
    """Parameters of the largest area, and that area, m².

    Raises:
        RuntimeError: the optimiser has found none.
    """
    problem = problem_of(model, tensions)
    constraints = ca.vertcat(problem.balance, problem.room)
    nlp = {"x": problem.variables, "f": -problem.area, "g": constraints}
    options = {"print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes", "ipopt.tol": 1e-8}
    optimiser = ca.nlpsol("optimiser", "ipopt", nlp, options)
    lowest = np.full(len(problem.start), -np.inf)
    highest = np.full(len(problem.start), np.inf)
    lowest[:2], highest[:2] = THINNEST / 1e-3, THICKEST / 1e-3
    lowest[6], highest[6] = SHORTEST, LONGEST
    balanced = problem.balance.shape[0]
    upper = np.concatenate([np.zeros(balanced), np.full(problem.room.shape[0], np.inf)])
    found = optimiser(x0=problem.start, lbx=lowest, ubx=highest, lbg=0.0, ubg=upper)
    if not optimiser.stats()["success"]:
        raise RuntimeError(f"no design was found: {optimiser.stats()['return_status']}")
    p = UNITS * found["x"].full()[: len(UNITS), 0]
    return model.parameters.unpack(p), -float(found["f"]) * LENGTH**2


def equilibria_of(model: Model, tensions: FloatArray) -> list[Solution]:
    """Equilibria of the scene's own design, by solves that know nothing of the optimisation."""
    names = model.inputs.names
    return [solve(model, dict(zip(names, pair, strict=True)), raise_on_failure=True) for pair in tensions]


def reached(equilibria: list[Solution]) -> float:
    """Area that the tips enclose, m²."""
    tips = np.array([solution.tip("finger").position for solution in equilibria])
    return float(area_of(ca.DM(tips[:, [0, 2]].T)))


def draw(designs: Mapping[str, Design], file: Path) -> None:
    """The areas that designs reach, and the fingers themselves with their tendons."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.0, 4.5), layout="constrained")
    region, *fingers = figure.subplots(1, 1 + len(designs), width_ratios=[2.4, *[1.0] * len(designs)])
    for panel, color, (name, design) in zip(fingers, ("0.5", "#4477aa"), designs.items(), strict=True):
        equilibria = equilibria_of(finger(design), tensions_around(FINE))
        tips = np.array([solution.tip("finger").position for solution in equilibria])
        outline = 1e3 * np.vstack([tips, tips[:1]])
        region.fill(outline[:, 0], outline[:, 2], color=color, alpha=0.4, label=name)
        for solution in equilibria[:: FINE // 4]:
            shape = 1e3 * solution.pose(np.linspace(0, 1, 41), "finger").position
            region.plot(shape[:, 0], shape[:, 2], color=color, linewidth=1.0)
        draw_finger(panel, design)
        panel.set(title=name, xlabel="x, mm", ylabel="z, mm", xlim=(-13, 13))
    region.set(xlabel="x of the tip, mm", ylabel="z of the tip, mm", aspect="equal")
    region.legend(loc="lower right")
    figure.savefig(file, dpi=150)


def draw_finger(panel: Axes, design: Design) -> None:
    """Outline of the unloaded finger and the courses of its tendons, in millimetres."""
    radii, flexor, extensor, (end,) = [np.ravel(design[name]) for name in START]
    length = 1e3 * LENGTH
    panel.fill_betweenx([0, length], -1e3 * radii, 1e3 * radii, color="0.9")
    for (base, growth), last, color in ((flexor, 1.0, "#ee6677"), (extensor, end, "#228833")):
        panel.plot([1e3 * base, 1e3 * (base + growth * last)], [0, last * length], color=color, marker="o")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=16, help="pairs of tensions, at least 4")
    parser.add_argument("--output", type=Path, default=Path("design_finger.png"), help="figure")
    arguments = parser.parse_args()
    tensions = tensions_around(arguments.cases)
    design, area = designed(finger(), tensions)
    for name, value in design.items():
        print(name, np.ravel(value).round(6).tolist())
    before = reached(equilibria_of(finger(), tensions))
    equilibria = equilibria_of(finger(design), tensions)
    stable = sum(solution.stable is True for solution in equilibria)
    print(f"area {1e6 * area:.4g} mm², by solves of their own {1e6 * reached(equilibria):.4g} mm²")
    print(f"the start reaches {1e6 * before:.4g} mm²; {stable} of {len(tensions)} stable")
    finer = reached(equilibria_of(finger(design), tensions_around(FINE)))
    print(f"a polygon of {FINE} corners has {1e6 * finer:.4g} mm²")
    draw({"start": START, "design": design}, arguments.output)
    print(f"wrote {arguments.output}")


if __name__ == "__main__":
    main()
