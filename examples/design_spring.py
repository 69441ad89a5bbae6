"""The shape of a strip spring that pushes back with the same force all along its stroke.

A steel strip stands in a clamp; a pin at its tip is pushed along a guide. Four Legendre coefficients of its unloaded
curvature, its thickness and its length are chosen. The equilibria are no variables of the optimisation: each is
followed from the one before it, on one branch, in compiled C, and its derivatives with the design come from the
implicit function theorem. So the optimiser cannot change branches unnoticed, and sees nothing but the design.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory

import casadi as ca
import numpy as np
import numpy.typing as npt
from numpy.polynomial import legendre
from scipy.optimize import least_squares

from cosserat_casadi import Model, Solution, build, export, load, scene_from_dict, solve
from cosserat_casadi.codegen.compiled import Compiled
from cosserat_casadi.maths.typing import FloatArray

FORCE = 5.0
"""What the spring is to push with, N."""

TOP, STROKE = 0.15, 0.05
"""Height of the pin above the clamp where the stroke begins, and how far the pin goes down from there, m."""

LEANING = 1.0
"""Angle of the clamp with the guide, rad."""

POINTS = 9
"""Places of the stroke that the optimisation sees."""

FINE = 41
"""Places that the curve is drawn and judged at."""

PIN = "supports[0].position.z"
"""The parameter that moves the pin."""

Design = Mapping[str, npt.ArrayLike]
"""Values of the parameters by name."""

START: Design = {
    "strip.intrinsic.curvature.y": [10.0, 0.0, 0.0, 0.0],
    "strip.section.width": 0.4e-3,
    "strip.length": 0.2,
}
"""An arc: Legendre coefficients of its curvature, 1/m; thickness and length, m."""

UNITS = np.array([5.0, 5.0, 5.0, 5.0, 0.4e-3, 0.2])
"""Unit of each number of the design."""

LEAST = np.array([5.0, -10.0, -10.0, -10.0, 0.2e-3, 0.19])
LARGEST = np.array([30.0, 10.0, 10.0, 10.0, 0.6e-3, 0.25])
"""Bounds of the design. A strip that is bent further to one side and back again may reach the pin in several shapes."""


def spring(design: Design = START, modes: int = 6) -> Model:
    """The strip with its tip on the pin, which is at the top of the stroke; the design is what its scene says."""
    curvature, (thickness,), (length,) = [np.ravel(design[name]).tolist() for name in START]
    strip = {
        "name": "strip",
        "length": length,
        "strain": "planar",
        "material": {"youngs_modulus": 205e9, "poisson_ratio": 0.3},
        "section": {"shape": "rectangle", "width": thickness, "height": 10e-3},
        "intrinsic": {"curvature": [0.0, curvature, 0.0]},
        "base": {"tangent": [-float(np.sin(LEANING)), 0.0, float(np.cos(LEANING))]},
    }
    return build(
        scene_from_dict(
            {
                "schema": 1,
                "title": "A spring to be designed",
                "inputs": [],
                "parameters": [*START, PIN],
                "accuracy": {"modes": modes},
                "rods": [strip],
                "supports": [{"rod": "strip", "kind": "pinned", "position": [0.0, 0.0, TOP]}],
            }
        )
    )


def heights(points: int) -> FloatArray:
    """Heights of the pin along the stroke, m."""
    return TOP - np.linspace(0.0, STROKE, points)


def stacked(design: Design) -> FloatArray:
    """The numbers of a design in their units, shape (6,)."""
    return np.concatenate([np.ravel(design[name]) for name in START]) / UNITS


def by_name(numbers: FloatArray) -> dict[str, FloatArray]:
    """The design of numbers in their units."""
    curvature, thickness, length = np.split(UNITS * numbers, [4, 5])
    return dict(zip(START, (curvature, thickness, length), strict=True))


class Stroke:
    """The force of a spring along its stroke as a function of its design.

    The first equilibrium of a design is followed from that of the design before: the branch is that of the start.

    Args:
        model: of :func:`spring`.
        compiled: the same in C.
    """

    def __init__(self, model: Model, compiled: Compiled) -> None:
        self.model = model
        self.compiled = compiled
        self._p = self._parameters(stacked(START), TOP)
        self._x = compiled.solve(parameters=self._p).x
        self._design = np.full(len(UNITS), np.nan)

    def at(self, design: FloatArray) -> Curve:
        """The curve of a design; that of the last one is remembered, since its derivatives are asked for next."""
        if not np.array_equal(design, self._design):
            self._curve = self.curve(design)
            self._design = design.copy()
        return self._curve

    def curve(self, design: FloatArray, points: int = POINTS) -> Curve:
        """Forces along the stroke: dF/dp = ∂F/∂p − ∂F/∂x (∂R/∂x)⁻¹ ∂R/∂p.

        Args:
            design: numbers in their units, shape (6,).
            points: of the stroke.

        Raises:
            RuntimeError: the branch ends on the way.
        """
        forces = []
        derivatives = []
        places = [self._parameters(design, height) for height in heights(points)]
        before, x = self._p, self._x
        for p in places:
            found = self.compiled.follow([], [], x, parameters_before=before, parameters=p)
            if not found.converged:
                raise RuntimeError("the branch ends somewhere along the stroke")
            before, x = p, found.x
            if p is places[0]:
                self._p, self._x = p, x
            force, force_by_x, force_by_p, by_x, by_p = [part.full() for part in self._parts(x, p)]
            total = force_by_p - force_by_x @ np.linalg.solve(by_x, by_p)
            forces.append(force.item())
            derivatives.append(total[0, : len(UNITS)] * UNITS)
        return Curve(np.array(forces), np.array(derivatives))

    def _parameters(self, design: FloatArray, height: float) -> FloatArray:
        """All parameters of the model."""
        return np.append(UNITS * design, height)

    @cached_property
    def _parts(self) -> ca.Function:
        """(x, p) ↦ force of the clamp along the guide with its derivatives, and those of the balance."""
        model = self.model
        x = ca.MX.sym("x", model.size)
        p = ca.MX.sym("p", model.parameters.size)
        force = model.fields["strip"].call({"x": x, "p": p})["base_force"][2]
        by_x = model.jacobian(x, [], p)[0]
        by_p = model.parameter_jacobian(x, [], p)
        return ca.Function("parts", [x, p], [force, ca.jacobian(force, x), ca.jacobian(force, p), by_x, by_p])


@dataclass(frozen=True)
class Curve:
    """Forces along the stroke.

    Attributes:
        force: with which the strip pushes the pin up, N, shape (points,).
        by_design: its derivatives with the design in its units, N, shape (points, 6).
    """

    force: FloatArray
    by_design: FloatArray


def designed(stroke: Stroke) -> Design:
    """The design whose force differs least from the wanted one along the stroke.

    Raises:
        RuntimeError: the optimiser has found none.
    """

    def misfit(design: FloatArray) -> FloatArray:
        try:
            return stroke.at(design).force / FORCE - 1.0
        except RuntimeError:
            # The optimiser takes a shorter step.
            return np.full(POINTS, np.nan)

    found = least_squares(
        misfit,
        stacked(START),
        jac=lambda design: stroke.at(design).by_design / FORCE,
        bounds=(LEAST / UNITS, LARGEST / UNITS),
        xtol=1e-12,
    )
    if not found.success:
        raise RuntimeError(f"no design was found: {found.message}")
    return by_name(found.x)


def compiled_spring(model: Model) -> Compiled:
    """The model in C."""
    with TemporaryDirectory() as folder:
        return load(export(model, folder, "spring"))


def equilibria_of(design: Design, points: int = POINTS, modes: int = 10) -> list[Solution]:
    """Equilibria along the stroke by solves of their own, each from the unloaded strip."""
    places = [{**design, PIN: height} for height in heights(points)]
    model = spring(design, modes)
    return [solve(model, parameters=place, raise_on_failure=True) for place in places]


def forces_of(equilibria: list[Solution]) -> FloatArray:
    """With what the strip pushes the pin up in each, N."""
    return np.array([solution.base_wrench("strip").force[2] for solution in equilibria])


def largest_strain(design: Design, equilibria: list[Solution]) -> float:
    """Largest strain of the surface: the change of the curvature times half the thickness."""
    X = np.linspace(0.0, 1.0, 101)
    unloaded = legendre.legval(2 * X - 1, np.ravel(design["strip.intrinsic.curvature.y"]))
    changes = [np.abs(solution.strain(X, "strip")[:, 1] - unloaded).max() for solution in equilibria]
    return float(max(changes) * np.ravel(design["strip.section.width"])[0] / 2)


def draw(designs: Mapping[str, Design], found: Mapping[str, list[Solution]], file: Path) -> None:
    """Force over the way of the pin, and the strips at rest and along the stroke.

    Args:
        designs: by what they are called.
        found: equilibria of each along the stroke.
        file: to be written.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.0, 4.5), layout="constrained")
    forces, *strips = figure.subplots(1, 1 + len(designs), width_ratios=[2.0, *[1.0] * len(designs)])
    X = np.linspace(0, 1, 81)
    for panel, color, (name, design) in zip(strips, ("0.5", "#4477aa"), designs.items(), strict=True):
        equilibria = found[name]
        forces.plot(1e3 * (TOP - heights(FINE)), forces_of(equilibria), color=color, label=name)
        for solution in equilibria[:: FINE // 4]:
            shape = 1e3 * solution.pose(X, "strip").position
            panel.plot(shape[:, 0], shape[:, 2], color=color, linewidth=1.0)
            panel.plot(*shape[-1, [0, 2]], color="black", marker="o", markersize=3)
        unloaded = 1e3 * unloaded_shape(design)
        panel.plot(unloaded[:, 0], unloaded[:, 1], color=color, linestyle=":")
        panel.set(title=name, xlabel="x, mm", ylabel="z, mm", aspect="equal")
    forces.axhline(FORCE, color="0.8", linewidth=1.0, zorder=0)
    forces.set(xlabel="way of the pin, mm", ylabel="force, N", ylim=(0.0, None))
    forces.legend(loc="lower right")
    figure.savefig(file, dpi=150)


def unloaded_shape(design: Design, count: int = 401) -> FloatArray:
    """Centre line of the unloaded strip in its plane by the trapezoidal rule, shape (count, 2), m."""
    X = np.linspace(0.0, 1.0, count)
    length = np.ravel(design["strip.length"])[0]
    coefficients = legendre.legint(np.ravel(design["strip.intrinsic.curvature.y"]), lbnd=-1.0)
    angle = length / 2 * legendre.legval(2 * X - 1, coefficients) - LEANING
    tangent = np.column_stack([np.sin(angle), np.cos(angle)])
    steps = (tangent[1:] + tangent[:-1]) * length / (2 * (count - 1))
    return np.vstack([np.zeros(2), np.cumsum(steps, axis=0)])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=Path, default=Path("design_spring.png"), help="figure")
    file: Path = parser.parse_args().output
    model = spring()
    stroke = Stroke(model, compiled_spring(model))
    design = designed(stroke)
    for name, value in design.items():
        print(name, np.ravel(value).round(6).tolist())
    followed = stroke.curve(stacked(design), FINE).force
    designs = {"start": START, "design": design}
    found = {name: equilibria_of(own, FINE) for name, own in designs.items()}
    for name, equilibria in found.items():
        forces = forces_of(equilibria)
        stable = sum(solution.stable is True for solution in equilibria)
        print(
            f"{name}: {forces.min():.3f} to {forces.max():.3f} N by solves of their own, {stable} of {FINE} stable, "
            f"strain of the surface up to {100 * largest_strain(designs[name], equilibria):.2f} %"
        )
    apart = abs(followed - forces_of(found["design"])).max()
    print(f"design: followed forces on fewer modes differ by {apart:.1e} N")
    draw(designs, found, file)
    print(f"wrote {file}")


if __name__ == "__main__":
    main()
