"""The push between two rods, or between two stretches of one: an energy of each pair of their sections.

Two sections whose centres are d apart, of rods with the radii ρ, σ, and D = ρ + σ, store per length of either rod

    u = c (R² − d²)₊³,    R = D + w,    c = 5 k / (32 Δ^{3/2} (5 D² − Δ)),    Δ = R² − D²

with the width w and the stiffness k. Only the distance counts: forces are opposite and along the line of the centres, so
that neither their sum nor their moment remains. Of two straight parallel rods with the gap g = d − D the integral over
one of them is 32/35 c (R² − d²)₊^{7/2} per length of the other. Its slope is the force per length: zero from the gap w
on, k D Δ / (5 D² − Δ), or 2 k w/5 for a small width, where they touch, and there it grows by k for each metre of gap:
the regularisation that an obstacle with a width has, too. Rods that cross at the angle α press each other with
2π c d (R² − d²)₊³ / sin α.

Everything is a function of squared distances: value, gradient and second derivatives are finite and continuous where
rods are parallel, cross, or coincide. Sections stand for as much rod as lies between them, and their sum converges as
the third derivative of u is bounded: half as far apart, the ripple along a rod falls by 2⁴.

A CasADi graph has no loop whose length depends on values. Sections lie in panels; a function that is only called where
the bounding balls of two panels meet is mapped over all pairs of panels, inside one that is only called where those of
both rods meet. So rods that are apart cost the sums over their sections, and others one comparison for each pair of
panels.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property

import casadi as ca

from cosserat_casadi.maths.typing import Matrix

PANEL = 4
"""Sections of a panel."""

DATA = 3
"""Numbers of a section beside its position: length of rod that it stands for, radius, distance along the rod, m."""

LAW = 3
"""Numbers of a law: width, m, stiffness, N/m², and the distance along one rod below which sections do not meet, m."""

FAR = -1.0
"""Depth, in widths, of sections that do not meet."""


def coefficient(width: Matrix | float, stiffness: Matrix | float, touching: Matrix | float) -> Matrix | float:
    """Coefficient c of the energy, N/m⁷.

    Args:
        width: w, m.
        stiffness: k, N/m².
        touching: distance D of centres that touch, m.
    """
    square = (touching + width) ** 2 - touching**2
    return 5 * stiffness / (32 * square**1.5 * (5 * touching**2 - square))


@dataclass(frozen=True)
class PanelPair:
    """Functions of two panels of sections and the law: (positions, data, positions, data, law), 3×PANEL, DATA×PANEL.

    Attributes:
        energy: 1×1, J.
        gradient: derivatives of the energy with the positions of both panels, 3×PANEL each, N.
        hessian: second derivative with the positions of both, those of a section one below the other, 6 PANEL square.
        depth: largest D − d over the width, counted from FAR, 1×1; zero where no two sections meet.
        ball: (positions, data) ↦ centre of a ball about the surface of one panel, and its radius, 4×1, m.
    """

    energy: ca.Function
    gradient: ca.Function
    hessian: ca.Function
    depth: ca.Function
    ball: ca.Function


@cache
def panel_pair() -> PanelPair:
    """The functions of two panels, which all rods share."""
    places = [ca.SX.sym(name, 3, PANEL) for name in ("first", "second")]
    data = [ca.SX.sym(name, DATA, PANEL) for name in ("first_data", "second_data")]
    law = ca.SX.sym("law", LAW)
    width, stiffness, apart = ca.vertsplit(law)
    energy = ca.SX(0)
    depth = ca.SX(0)
    for i in range(PANEL):
        for j in range(PANEL):
            first_length, first_radius, first_along = ca.vertsplit(data[0][:, i])
            second_length, second_radius, second_along = ca.vertsplit(data[1][:, j])
            touching = first_radius + second_radius
            square = ca.sumsqr(places[0][:, i] - places[1][:, j])
            meets = ca.fabs(first_along - second_along) >= apart
            inside = ca.fmax((touching + width) ** 2 - square, 0.0)
            lengths = first_length * second_length
            energy += meets * lengths * coefficient(width, stiffness, touching) * inside**3
            depth = ca.fmax(depth, meets * ((touching - ca.sqrt(square)) / width - FAR))
    gradients = [ca.gradient(energy, place) for place in places]
    stacked = ca.veccat(*gradients)
    hessian = ca.horzcat(*[ca.jacobian(stacked, place) for place in places])
    arguments = [places[0], data[0], places[1], data[1], law]
    centre = ca.sum2(places[0]) / PANEL
    reach = ca.sqrt(ca.sum1((places[0] - ca.repmat(centre, 1, PANEL)) ** 2)) + data[0][1, :]
    return PanelPair(
        energy=ca.Function("contact_energy", arguments, [energy]),
        gradient=ca.Function("contact_gradient", arguments, ca.cse(gradients)),
        hessian=ca.Function("contact_hessian", arguments, ca.cse([ca.densify(hessian)])),
        depth=ca.Function("contact_depth", arguments, [depth]),
        ball=ca.Function("ball", [places[0], data[0]], [ca.vertcat(centre, ca.mmax(reach))]),
    )


@cache
def panel_stiffness(first: int, second: int) -> ca.Function:
    """(positions, data, positions, data, law, moved, moved) ↦ what a motion of each panel adds to both gradients.

    Args:
        first: number of coordinates that move the first panel.
        second: the same of the second.

    Returns:
        Function, whose fields have three components of one row for each coordinate, one below the other, and a column
        for each section: of the first panel as the first moves, and as the second does; of the second as the second
        moves.
    """
    pair = panel_pair()
    arguments = [pair.hessian.mx_in(i) for i in range(pair.hessian.n_in())]
    counts = (first, second)
    moved = [ca.MX.sym(name, 3 * count, PANEL) for name, count in zip(("moved", "by"), counts, strict=True)]
    half = 3 * PANEL
    hessian = pair.hessian(*arguments)
    fields = []
    # The derivative of the second gradient with the first motion is the transpose of what is given.
    for row, column in ((0, 0), (0, 1), (1, 1)):
        block = hessian[half * row : half * (row + 1), half * column : half * (column + 1)]
        count = counts[column]
        # As a matrix with a row for each coordinate the field has a column for each component of each section.
        turned = ca.reshape(moved[column], count, half) @ block.T
        fields.append(ca.reshape(turned, 3 * count, PANEL))
    return ca.Function("contact_stiffness", [*arguments, *moved], fields)


def called_near(function: ca.Function) -> ca.Function:
    """(near, arguments…) ↦ results of a function; zeros, without a call, where near is zero."""
    symbols = [ca.MX.sym(function.name_in(i), function.sparsity_in(i)) for i in range(function.n_in())]
    nothing = [ca.MX(function.sparsity_out(i)) * 0 for i in range(function.n_out())]
    far = ca.Function(f"no_{function.name()}", symbols, nothing)
    return ca.Function.if_else(f"near_{function.name()}", function, far)


@dataclass(frozen=True)
class SectionsInContact:
    """Sections of a rod, in panels, whose positions are known.

    Attributes:
        positions: world axes, 3×S, m, with S a multiple of PANEL.
        data: DATA×S.
    """

    positions: Matrix
    data: Matrix

    @property
    def panels(self) -> int:
        """Number of panels."""
        count: int = self.positions.shape[1] // PANEL
        return count

    @cached_property
    def balls(self) -> Matrix:
        """Centre and radius of a ball about each panel, 4×panels, m."""
        return panel_pair().ball.map(self.panels)(self.positions, self.data)

    @cached_property
    def ball(self) -> Matrix:
        """Centre and radius of a ball about all of them, 4×1, m."""
        centre = ca.sum2(self.balls[:3, :]) / self.panels
        reach = ca.sqrt(ca.sum1((self.balls[:3, :] - ca.repmat(centre, 1, self.panels)) ** 2)) + self.balls[3, :]
        return ca.vertcat(centre, ca.mmax(reach))


def _meet(first: Matrix, second: Matrix, width: Matrix) -> Matrix:
    """Whether balls, 4×k each, are nearer each other than a width, 1×k."""
    return ca.sum1((first[:3, :] - second[:3, :]) ** 2) < (first[3, :] + second[3, :] + width) ** 2


@dataclass(frozen=True)
class SectionPairs:
    """All pairs of sections of two rods, or of one.

    Attributes:
        first: sections.
        second: those of the other rod; the same where a rod touches itself, and every pair then appears twice.
        law: LAW×1.
    """

    first: SectionsInContact
    second: SectionsInContact
    law: Matrix

    @property
    def itself(self) -> bool:
        """Whether a rod touches itself."""
        return self.first is self.second

    @cached_property
    def energy(self) -> Matrix:
        """Energy, 1×1, J."""
        (energies,) = self._called(_over_pairs(panel_pair().energy, *self._panels))
        return self._share * ca.sum2(energies)

    @cached_property
    def gradient(self) -> tuple[Matrix, Matrix]:
        """Derivatives of the energy with the positions of both, 3×S each, N."""
        first, second = self._called(_over_pairs(panel_pair().gradient, *self._panels))
        return self._share * self._of_first(first), self._share * self._of_second(second)

    @cached_property
    def depth(self) -> Matrix:
        """Depth where it is largest, in widths, 1×1; FAR where nothing touches."""
        (depths,) = self._called(_over_pairs(panel_pair().depth, *self._panels))
        return ca.mmax(ca.horzcat(depths, 0)) + FAR

    def stiffness(self, first: Matrix, second: Matrix) -> tuple[Matrix, Matrix, Matrix]:
        """Changes of the gradients: of the first by the first and by the second, of the second by the second.

        Args:
            first: motion of the sections of the first rod with its coordinates, 3n×S: three components, one row for
                each coordinate.
            second: the same of the second.

        Returns:
            fields of that form.
        """
        counts = (first.shape[0] // 3, second.shape[0] // 3)
        function = _over_pairs(panel_stiffness(*counts), *self._panels, *counts)
        by_first, mixed, by_second = [self._share * field for field in self._called(function, first, second)]
        return self._of_first(by_first), self._of_first(mixed), self._of_second(by_second)

    @property
    def _panels(self) -> tuple[int, int]:
        return self.first.panels, self.second.panels

    @property
    def _share(self) -> float:
        """Of pairs that appear twice one half counts."""
        return 0.5 if self.itself else 1.0

    def _called(self, function: ca.Function, *moved: Matrix) -> list[Matrix]:
        """Results of a function of all pairs; it is not called where the rods are apart."""
        sections = [self.first.positions, self.first.data, self.second.positions, self.second.data]
        arguments = [*sections, self.law, self.first.balls, self.second.balls, *moved]
        if self.itself:
            return list(function.call(arguments))
        near = _meet(self.first.ball, self.second.ball, self.law[0])
        return list(called_near(function).call([near, *arguments]))

    def _of_first(self, field: Matrix) -> Matrix:
        """Sum over the panels of the second of what each pair gives to the first, as many rows × S."""
        rows = field.shape[0]
        by_panel = ca.reshape(field, rows * self.first.positions.shape[1], self.second.panels)
        return ca.reshape(ca.sum2(by_panel), rows, self.first.positions.shape[1])

    def _of_second(self, field: Matrix) -> Matrix:
        """The same for the second."""
        rows = field.shape[0]
        by_panel = ca.reshape(field, rows * self.first.positions.shape[1], self.second.panels)
        return ca.reshape(ca.repsum(by_panel, self.first.panels, 1), rows, self.second.positions.shape[1])


@cache
def _over_pairs(function: ca.Function, first: int, second: int, *counts: int) -> ca.Function:
    """A function of two panels over all pairs of so many panels, the first running faster.

    Args:
        function: of two panels, the law, and of motions of both where there are any.
        first: panels of the first rod.
        second: panels of the second.
        counts: coordinates that move them.

    Returns:
        (positions, data, positions, data, law, balls, balls, motions…) ↦ its results side by side.
    """
    sizes = (PANEL * first, PANEL * second)
    symbols = [
        ca.MX.sym("first", 3, sizes[0]),
        ca.MX.sym("first_data", DATA, sizes[0]),
        ca.MX.sym("second", 3, sizes[1]),
        ca.MX.sym("second_data", DATA, sizes[1]),
        ca.MX.sym("law", LAW),
        ca.MX.sym("first_balls", 4, first),
        ca.MX.sym("second_balls", 4, second),
    ]
    moved = [ca.MX.sym(name, 3 * count, size) for name, count, size in zip(("moved", "by"), counts, sizes, strict=False)]

    def alongside(field: Matrix) -> Matrix:
        return ca.repmat(field, 1, second)

    def repeated(field: Matrix) -> Matrix:
        rows, columns = field.shape
        panels = ca.reshape(field, rows * columns // second, second)
        return ca.reshape(ca.repmat(panels, first, 1), rows, columns * first)

    near = _meet(alongside(symbols[5]), repeated(symbols[6]), symbols[4][0])
    sections = [alongside(symbols[0]), alongside(symbols[1]), repeated(symbols[2]), repeated(symbols[3])]
    arguments = [near, *sections, ca.repmat(symbols[4], 1, first * second)]
    arguments += [arrange(field) for arrange, field in zip((alongside, repeated), moved, strict=False)]
    results = called_near(function).map(first * second).call(arguments)
    return ca.Function(f"{function.name()}_of_pairs", [*symbols, *moved], results)
