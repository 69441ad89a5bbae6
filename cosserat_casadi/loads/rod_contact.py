"""The push between two rods, or two stretches of one rod: an energy for each pair of their sections.

Two sections with centres at a distance d, of rods with the radii ρ, σ, and D = ρ + σ, store per length of both rods

    u = c (R² − d²)₊³,    R = D + w,    c = 5 k / (32 Δ^{3/2} (5 D² − Δ)),    Δ = R² − D²

with the width w and the stiffness k. The energy depends on the distance alone: forces are opposite and along the line
of the centres, so that their sum and their moment are zero. For two straight parallel rods with the gap g = d − D the
integral over one rod is 32/35 c (R² − d²)₊^{7/2} per length of the other. Its derivative is the force per length: zero
for gaps above w, k D Δ / (5 D² − Δ), or 2 k w/5 for a small width, at zero gap, where its rate with the gap is k: the
regularisation of an obstacle with a width. Rods that cross at the angle α press each other with 2π c d (R² − d²)₊³ /
sin α.

All functions are of squared distances: value, gradient and second derivatives are finite and continuous for rods that
are parallel, cross, or coincide. Each section represents the rod between it and its neighbours, and the sum converges
as the third derivative of u is bounded: at half the spacing the ripple along a rod falls by 2⁴.

Friction is Coulomb's, for each pair by its own force. In motion it is regularised by the slip speed. Along a path a
spring of the stiffness μ F/s holds a pair that sticks, and slips at the drag s, for every force F between the sections.
Sections that are pressed harder while they stick give back energy, μ F s/2 at most.

A CasADi graph has no loop with a length that depends on values. Sections are grouped in panels. A function of two
panels, called only if their bounding balls meet, is mapped over the panels of the second rod, inside a function that is
called only if a panel of the first rod meets any of these. So panels that are apart cost one comparison each, and so do
groups of panels, if a rod has more than one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property

import casadi as ca

from cosserat_casadi.maths.typing import Matrix

PANEL = 16
"""Number of sections of a panel."""

GROUP = 16
"""Number of panels of a group: sections that are far from a group are not compared with its panels."""

DATA = 3
"""Data of a section beside its position: length of rod that it represents, radius, distance along the rod, m."""

MOTION = 6
"""Numbers of the motion of a section, which follow its data: velocity, m/s, and angular velocity, rad/s.

Along a path they are displacement, m, and rotation since its last point, axis times tangent of half the angle.
"""

STILL = ca.DM(MOTION, 0)
"""Motion of sections at rest."""

LAW = 5
"""Numbers of a law: width, m, stiffness, N/m², and least distance along the rod from the first section to the second,
m.

Of two rods every pair counts; of a rod and itself each pair once. The coefficient of friction and the slip speed, m/s,
follow; along a path the drag at which sections slip, m.
"""

NO_WAY = 1e-9
"""Drag over the drag of slip, or distance over the touching distance, below which there is no direction."""

FAR = -1.0
"""Depth, in widths, that stands for sections that do not meet."""


def coefficient(width: Matrix | float, stiffness: Matrix | float, touching: Matrix | float) -> Matrix | float:
    """Coefficient c of the energy, N/m⁷.

    Args:
        width: w, m.
        stiffness: k, N/m².
        touching: distance D of the centres of touching sections, m.
    """
    square = (touching + width) ** 2 - touching**2
    return 5 * stiffness / (32 * square**1.5 * (5 * touching**2 - square))


@dataclass(frozen=True)
class PairKernels:
    """Functions of two sections: (position, data, position, data, law), 3×1, DATA×1 each, LAW×1.

    Attributes:
        energy: 1×1, J.
        depth: D − d over the width, minus FAR, 1×1; zero if the sections do not meet.
        gradient: derivative of the energy by the first position, 3×1, N; the derivative by the second is its opposite.
        hessian: second derivative by one position, 3×3, N/m; the mixed derivative is its opposite.
    """

    energy: ca.Function
    depth: ca.Function
    gradient: ca.Function
    hessian: ca.Function


@cache
def pair_kernels() -> PairKernels:
    """The functions of two sections, common to all rods."""
    places = [ca.SX.sym(name, 3) for name in ("first", "second")]
    data = [ca.SX.sym(name, DATA) for name in ("first_data", "second_data")]
    law = ca.SX.sym("law", LAW)
    width, stiffness, nearest, _, _ = ca.vertsplit(law)
    (length, radius, along), (other_length, other_radius, other_along) = (ca.vertsplit(own) for own in data)
    touching = radius + other_radius
    square = ca.sumsqr(places[0] - places[1])
    meets = other_along - along >= nearest
    inside = ca.fmax((touching + width) ** 2 - square, 0.0)
    energy = meets * length * other_length * coefficient(width, stiffness, touching) * inside**3
    depth = ca.fmax(meets * ((touching - ca.sqrt(square)) / width - FAR), 0.0)
    hessian, gradient = ca.hessian(energy, places[0])
    arguments = [places[0], data[0], places[1], data[1], law]

    def function(name: str, result: ca.SX) -> ca.Function:
        return ca.Function(f"contact_{name}", arguments, ca.cse([ca.densify(result)]))

    return PairKernels(
        function("energy", energy),
        function("depth", depth),
        function("gradient", gradient),
        function("hessian", hessian),
    )


@dataclass(frozen=True)
class PairInMotion:
    """Two touching sections and their motion past each other.

    Attributes:
        arguments: symbols (position, data and motion, position, data and motion, law).
        arms: vectors from the centre of each section to its touching point, 3×1, m.
        pressing: force between the sections, 1×1, N.
        normal: unit vector from the second to the first, 3×1.
        velocity: relative velocity, or displacement, of their touching points, 3×1, m/s or m.
    """

    arguments: list[ca.SX]
    arms: list[ca.SX]
    pressing: ca.SX
    normal: ca.SX
    velocity: ca.SX

    @property
    def sliding(self) -> ca.SX:
        """The part of the velocity, or displacement, along the surface, 3×1."""
        return self.velocity - self.normal * ca.dot(self.normal, self.velocity)


def _turned(vector: ca.SX, rotation: ca.SX) -> ca.SX:
    """A vector turned by a rotation, given as axis times tangent of half the angle."""
    across = ca.cross(rotation, vector)
    return vector + 2 * (across + ca.cross(rotation, across)) / (1 + ca.sumsqr(rotation))


def _pair_in_motion(along_path: bool) -> PairInMotion:
    """Two sections in symbols.

    Along a path the drag, which is part of the displacement of the first section, turns with this section: a rigid
    motion of both rods does not change friction.
    """
    places = [ca.SX.sym(name, 3) for name in ("first", "second")]
    data = [ca.SX.sym(name, DATA + MOTION) for name in ("first_data", "second_data")]
    law = ca.SX.sym("law", LAW)
    width, stiffness, nearest, _, _ = ca.vertsplit(law)
    (length, radius, along), (other_length, other_radius, other_along) = (ca.vertsplit(own[:DATA]) for own in data)
    touching = radius + other_radius
    apart = places[0] - places[1]
    # A section paired with itself has distance zero, and does not count.
    square = ca.fmax(ca.sumsqr(apart), (NO_WAY * touching) ** 2)
    inside = ca.fmax((touching + width) ** 2 - square, 0.0)
    meets = other_along - along >= nearest
    # Minus the derivative of the energy by the distance d, over d.
    by_distance = 6 * meets * length * other_length * coefficient(width, stiffness, touching) * inside**2
    arms = [-radius / touching * apart, other_radius / touching * apart]
    motions = [own[DATA : DATA + 3] for own in data]
    turns = [own[DATA + 3 :] for own in data]
    if along_path:
        arms_before = [_turned(arm, -turn) for arm, turn in zip(arms, turns, strict=True)]
        ways = [motion + arm - before for motion, arm, before in zip(motions, arms, arms_before, strict=True)]
        velocity = _turned(ways[0] - ways[1], turns[0])
    else:
        speeds = [motion + ca.cross(turn, arm) for motion, turn, arm in zip(motions, turns, arms, strict=True)]
        velocity = speeds[0] - speeds[1]
    distance = ca.sqrt(square)
    arguments = [places[0], data[0], places[1], data[1], law]
    return PairInMotion(arguments, arms, by_distance * distance, apart / distance, velocity)


@cache
def friction_kernel(along_path: bool) -> ca.Function:
    """(position, data and motion, position, data and motion, law) ↦ [force; moment] on the first, on the second, 12×1.

    It is Coulomb's law of :mod:`cosserat_casadi.loads.contact_layer` with the relative velocity of the touching points
    of both sections. They are one point on the line of the centres, so that sum and moment of the forces are zero.
    Along a path the drag of these points replaces the velocity, and sections slip at the drag that the law gives.
    """
    pair = _pair_in_motion(along_path)
    *_, friction, slip = ca.vertsplit(pair.arguments[LAW_ARGUMENT])
    if along_path:
        length = ca.fmax(ca.sqrt(ca.sumsqr(pair.sliding) + (NO_WAY * slip) ** 2), slip)
    else:
        length = ca.sqrt(ca.sumsqr(pair.sliding) + slip**2)
    force = -friction * pair.pressing / length * pair.sliding
    loads = ca.vertcat(force, ca.cross(pair.arms[0], force), -force, -ca.cross(pair.arms[1], force))
    return ca.Function("contact_friction", pair.arguments, ca.cse([loads]))


@cache
def way_kernel() -> ca.Function:
    """Arguments of :func:`friction_kernel` ↦ drag of the touching points and normal, both times the force; the force.

    It is for paths; drag, normal and the force between the sections are stacked, 7×1.
    """
    pair = _pair_in_motion(along_path=True)
    weighted = pair.pressing * ca.vertcat(pair.velocity, pair.normal, 1)
    return ca.Function("contact_way", pair.arguments, ca.cse([weighted]))


def _panels(data: int = DATA) -> list[ca.MX]:
    """Symbols of the positions and the data of two panels, and of the law."""
    sizes = {"positions": 3, "data": data}
    symbols = [ca.MX.sym(f"{name}_{kind}", rows, PANEL) for name in ("first", "second") for kind, rows in sizes.items()]
    return [*symbols, ca.MX.sym("law", LAW)]


def _by_pair(kernel: ca.Function, arguments: Sequence[Matrix]) -> Matrix:
    """Results of a kernel for every pair of sections of two panels, side by side; the first index runs faster."""
    result: Matrix = kernel.map(PANEL**2)(*_for_all_pairs(arguments))
    return result


def _over_second(results: Matrix, count: int = PANEL) -> Matrix:
    """Sum of ``count`` blocks side by side, one for each section of the second panel, or for each panel."""
    rows, columns = results.shape
    summed = ca.sum2(ca.reshape(results, rows * columns // count, count))
    return ca.reshape(summed, rows, columns // count)


def _over_first(results: Matrix) -> Matrix:
    """Sum over the sections of the first panel, side by side for the sections of the second."""
    rows, columns = results.shape
    summed = ca.repsum(ca.reshape(results, rows * columns // PANEL, PANEL), PANEL, 1)
    by_section: Matrix = ca.reshape(summed, rows, columns // PANEL)
    return by_section


@cache
def panel_energy() -> ca.Function:
    """(positions, data, positions, data, law) of two panels ↦ their energy, 1×1, J."""
    arguments = _panels()
    return ca.Function("energy", arguments, [ca.sum2(_by_pair(pair_kernels().energy, arguments))])


@cache
def panel_depth() -> ca.Function:
    """(positions, data, positions, data, law) of two panels ↦ largest depth minus FAR, 1×1."""
    arguments = _panels()
    return ca.Function("depth", arguments, [ca.mmax(_by_pair(pair_kernels().depth, arguments))])


@cache
def panel_gradient() -> ca.Function:
    """Arguments of :func:`panel_energy` ↦ derivatives of the energy by positions of both panels, 3×PANEL each, N."""
    arguments = _panels()
    gradients = _by_pair(pair_kernels().gradient, arguments)
    return ca.Function("gradient", arguments, [_over_second(gradients), -_over_first(gradients)])


@cache
def panel_way() -> ca.Function:
    """Two panels with motions after the data ↦ sums of :func:`way_kernel` for sections of the first, 7×PANEL."""
    arguments = _panels(DATA + MOTION)
    return ca.Function("way", arguments, [_over_second(_by_pair(way_kernel(), arguments))])


@cache
def panel_friction(along_path: bool) -> ca.Function:
    """Two panels with motions after the data ↦ [force; moment] of friction on sections of both, 6×PANEL each."""
    arguments = _panels(DATA + MOTION)
    first, second = ca.vertsplit(_by_pair(friction_kernel(along_path), arguments), 6)
    results = [_over_second(first), _over_first(second)]
    # Directions are multiplied by one Jacobian, which is assembled from the Jacobians of the pairs.
    jacobian = _friction_jacobian(arguments, results, along_path)
    options = {"custom_jacobian": jacobian, "jac_penalty": 0.0, "never_inline": True}
    friction = ca.Function("friction_of_panels", arguments, results, options)
    symbols = _panels(DATA + MOTION)
    return ca.Function("friction", symbols, friction.call(symbols))


def _friction_jacobian(arguments: Sequence[ca.MX], results: Sequence[Matrix], along_path: bool) -> ca.Function:
    """Derivatives of friction on both panels by positions and data; the law is constant."""
    kernel = friction_kernel(along_path)
    symbols = kernel.sx_in()
    (loads,) = kernel.call(symbols)
    parts = ca.vertsplit(loads, 6)
    derivatives = [ca.densify(ca.jacobian(part, symbol)) for part in parts for symbol in symbols[:4]]
    # Derivative of the first load by the second section, transposed, so that sections of the first are stacked.
    turned = [derivative.T if index in (2, 3) else derivative for index, derivative in enumerate(derivatives)]
    pairs = ca.Function("by_pair", symbols, ca.cse(turned)).map(PANEL**2)
    by_pair = pairs.call(_for_all_pairs(arguments))
    columns = [symbol.shape[0] for symbol in symbols[:4]]
    blocks = []
    for load in range(2):
        for index in range(4):
            values = by_pair[4 * load + index]
            if (load, index // 2) in ((0, 0), (1, 1)):
                summed = _over_second(values) if load == 0 else _over_first(values)
                blocks.append(ca.diagcat(*ca.horzsplit(summed, columns[index])))
            else:
                chunks = ca.vertcat(*ca.horzsplit(values, values.shape[1] // PANEL))
                blocks.append(chunks.T if load == 0 else chunks)
        blocks.append(ca.MX(6 * PANEL, LAW))
    outputs = [ca.MX.sym(f"out_{number}", *result.shape) for number, result in enumerate(results)]
    return ca.Function("jac_friction_of_panels", [*arguments, *outputs], blocks)


@cache
def panel_friction_rates(along_path: bool, first: int, second: int) -> ca.Function:
    """Arguments of :func:`panel_friction`, their derivatives by numbers ↦ derivatives of friction by these numbers.

    Args:
        along_path: whether motions count from the last point of a path.
        first: count n of the numbers on which the sections of the first panel depend.
        second: count m of the numbers on which the sections of the second panel depend.

    Returns:
        function whose last arguments are the derivatives of positions and data of the second panel, m×(3 PANEL) and
        m×((DATA + MOTION) PANEL), then of the first. Its results are the derivatives of [force; moment] on the sections
        of the first panel and of the second by the n numbers, n×(6 PANEL), then by the m numbers, m×(6 PANEL).
    """
    arguments = _panels(DATA + MOTION)
    loads = [ca.MX(6, PANEL), ca.MX(6, PANEL)]
    blocks = _friction_jacobian(arguments, loads, along_path).call([*arguments, *loads])
    sizes = {"second": second, "first": first}
    rates = [
        ca.MX.sym(f"rates_of_{owner}_{index}", count, symbol.numel())
        for owner, count in sizes.items()
        for index, symbol in enumerate(arguments[:2])
    ]
    results = [
        sum(rate @ block.T for rate, block in zip(own, blocks[start + place : start + place + 2], strict=True))
        for own, place in ((rates[2:], 0), (rates[:2], 2))
        for start in (0, len(arguments))
    ]
    return ca.Function("friction_rates", [*arguments, *rates], results)


@cache
def panel_stiffness(count: int) -> ca.Function:
    """Arguments of :func:`panel_energy` and a motion of the second panel ↦ second derivatives of the energy.

    Args:
        count: coordinates n of the motion: three components, one row for each coordinate, 3n×PANEL.

    Returns:
        function whose results are the second derivatives by each section of the first panel, and of the second, 9×PANEL
        each, and by the coordinates and the positions of the first, n×(3 PANEL).
    """
    arguments = _panels()
    motion = ca.MX.sym("motion", 3 * count, PANEL)
    blocks = _by_pair(pair_kernels().hessian, arguments)
    # Stacked for the sections of the second panel, whose motion has its components side by side.
    mixed = -ca.vertcat(*ca.horzsplit(blocks, 3 * PANEL))
    by_coordinates = ca.reshape(motion, count, 3 * PANEL) @ mixed
    entries = ca.reshape(blocks, 9, PANEL**2)
    return ca.Function("stiffness", [*arguments, motion], [_over_second(entries), _over_first(entries), by_coordinates])


@cache
def _ball() -> ca.Function:
    """(positions, data) of a panel ↦ centre of a ball about it, its radius, and its ends along the rod, 6×1, m."""
    places, data = ca.SX.sym("places", 3, PANEL), ca.SX.sym("data", DATA, PANEL)
    centre = ca.sum2(places) / PANEL
    distances = ca.sqrt(ca.sum1((places - ca.repmat(centre, 1, PANEL)) ** 2))
    ball = ca.vertcat(centre, ca.mmax(distances + data[1, :]), data[2, 0], data[2, -1])
    return ca.Function("ball", [places, data], [ball])


def _ball_about(balls: Matrix) -> Matrix:
    """A ball about balls, 6×k: its centre, its radius, and its ends along the rod, 6×1, m."""
    count = balls.shape[1]
    centre = ca.sum2(balls[:3, :]) / count
    distances = ca.sqrt(ca.sum1((balls[:3, :] - ca.repmat(centre, 1, count)) ** 2))
    return ca.vertcat(centre, ca.mmax(distances + balls[3, :]), balls[4, 0], balls[5, -1])


@cache
def called_near(function: ca.Function) -> ca.Function:
    """(near, arguments…) ↦ results of a function; zeros without a call if near is zero."""
    symbols = [ca.MX.sym(function.name_in(i), function.sparsity_in(i)) for i in range(function.n_in())]
    nothing = [ca.MX.zeros(function.sparsity_out(i)) for i in range(function.n_out())]
    far = ca.Function(f"no_{function.name()}", symbols, nothing)
    return ca.Function.if_else(f"near_{function.name()}", function, far)


@dataclass(frozen=True)
class SectionsInContact:
    """Sections of a rod in panels, with their positions.

    Attributes:
        positions: world axes, 3×S, m, with S a multiple of PANEL.
        data: DATA×S.
        motion: MOTION×S, world axes; without columns at rest, unless along a path with friction.
    """

    positions: Matrix
    data: Matrix
    motion: Matrix = STILL

    @property
    def panels(self) -> int:
        """Number of panels."""
        return self.positions.shape[1] // PANEL

    @cached_property
    def balls(self) -> Matrix:
        """Centre and radius of a ball about each panel, and its ends along the rod, 6×panels, m."""
        balls: Matrix = _ball().map(self.panels)(self.positions, self.data[:DATA, :])
        return balls

    @cached_property
    def group_balls(self) -> Matrix:
        """Centre and radius of a ball about each group of panels, and its ends along the rod, 6×groups, m."""
        ends = [*range(0, self.panels, GROUP), self.panels]
        return ca.horzcat(*[_ball_about(balls) for balls in ca.horzsplit(self.balls, ends)])


def _meet(first: Matrix, second: Matrix, law: Matrix) -> Matrix:
    """Whether sections in balls, 6×k each, may push each other, 1×k."""
    squared_distance = ca.sum1((first[:3, :] - second[:3, :]) ** 2)
    reach = first[3, :] + second[3, :] + law[0]
    meet: Matrix = (squared_distance < reach**2) * (second[5, :] - first[4, :] >= law[2])
    return meet


@dataclass(frozen=True)
class SectionPairs:
    """All pairs of sections of two rods, or of one.

    Attributes:
        first: sections of the first rod.
        second: sections of the other rod; ``first`` for a rod that touches itself.
        law: numbers of the law, LAW×1.
        along_path: whether their motion counts from the last point of a path.
    """

    first: SectionsInContact
    second: SectionsInContact
    law: Matrix
    along_path: bool = False

    @cached_property
    def energy(self) -> Matrix:
        """Energy, 1×1, J."""
        (energies,) = self._over_pairs(panel_energy(), "e")
        return ca.sum2(energies)

    @cached_property
    def depth(self) -> Matrix:
        """Largest depth, in widths, 1×1; FAR without contact."""
        (depths,) = self._over_pairs(panel_depth(), "e")
        return ca.mmax(depths) + FAR

    @cached_property
    def gradient(self) -> tuple[Matrix, Matrix]:
        """Derivatives of the energy by the positions of both, 3×S each, N."""
        first, second = self._over_pairs(panel_gradient(), "fs")
        return first, second

    @cached_property
    def friction(self) -> tuple[Matrix, Matrix]:
        """[Force; moment] of friction on the sections of both, 6×S each, N and N m, of sections in motion."""
        first, second = self._moving._over_pairs(panel_friction(self.along_path), "fs")
        return first, second

    @cached_property
    def way(self) -> Matrix:
        """Sums of drag, normal and 1, each times the force of a pair, for each section of the first, 7×S."""
        (weighted,) = self._moving._over_pairs(panel_way(), "f")
        return weighted

    @property
    def _moving(self) -> SectionPairs:
        """These pairs with motions after the data."""
        first, second = (replace(own, data=ca.vertcat(own.data, own.motion)) for own in (self.first, self.second))
        return replace(self, first=first, second=second)

    def stiffness(self, first: Matrix, second: Matrix) -> tuple[Matrix, Matrix, Matrix]:
        """Second derivatives of the energy by coordinates: first and first, second and first, second and second.

        Args:
            first: motion of the sections of the first rod by its n coordinates, 3n×S: three components, one row for
                each coordinate.
            second: motion of the sections of the second rod by its m coordinates, 3m×S.

        Returns:
            n×n, m×n and m×m; for a rod that touches itself the first is the sum of both, and the last is zero.
        """
        by_first, by_second, mixed = self._over_pairs(panel_stiffness(second.shape[0] // 3), "fsf", second)
        touch = ca.norm_1(ca.vec(by_first)) > 0.0
        count, sections = first.shape[0] // 3, self.first.positions.shape[1]
        (across,) = called_near(_across(count, second.shape[0] // 3, sections)).call([touch, mixed, first])
        own = called_near(_with_coordinates(count, sections))
        if first is second:
            (both,) = own.call([touch, by_first + by_second, first])
            return both, across, ca.DM(count, count)
        other = called_near(_with_coordinates(second.shape[0] // 3, second.shape[1]))
        return own(touch, by_first, first), across, other(touch, by_second, second)

    def friction_rates(self, first: Sequence[Matrix], second: Sequence[Matrix]) -> tuple[list[Matrix], list[Matrix]]:
        """Derivatives of :attr:`friction` by n numbers of the first sections and by m of the second.

        Args:
            first: derivatives of positions, n×3S, and of data with motions after them, n×(DATA + MOTION)S.
            second: derivatives of positions and data of the second sections, m×….

        Returns:
            derivatives of the loads on the first sections, n×6S, and on the second by the n numbers; then by the m.
        """
        function = panel_friction_rates(self.along_path, first[0].shape[0], second[0].shape[0])
        rates = self._moving._over_pairs(function, "fsfs", *second, *first)
        return rates[:2], rates[2:]

    def _over_pairs(self, function: ca.Function, results: str, *motion: Matrix) -> list[Matrix]:
        """Results of a function of two panels for all pairs; zeros for sections that are apart.

        Args:
            function: a function of two panels, the law, and further arguments that ARGUMENTS names.
            results: a letter for each result. Results for sections of the first, ``f``, are summed over the panels of
                the second; results for sections of the second, ``s``, over the panels of the first; results for pairs
                of panels, ``e``, stand side by side.
            motion: the further arguments.
        """
        sides = (self.first, self.second)
        sections = [field for side in sides for field in (side.positions, side.data)]
        of_all = [*sections, self.law, *motion, self.first.balls, self.second.balls]
        if self.first.panels <= GROUP:
            return _over_panels(function, results, of_all, self.first.panels, self.second.panels)
        ends = [*range(0, self.first.panels, GROUP), self.first.panels]
        near = _near_any(self.first.group_balls, self.second.group_balls, self.law)
        by_group = []
        for field, owner in zip(of_all, _owners(function), strict=True):
            columns = field.shape[1] // self.first.panels
            parts_of_first = [columns * end for end in ends]
            by_group.append(ca.horzsplit(field, parts_of_first) if owner == "first" else [field] * len(near))
        parts = [
            called_near(_group(function, results, after - before, self.second.panels)).call([meets, *arguments])
            for meets, before, after, *arguments in zip(near, ends[:-1], ends[1:], *by_group, strict=True)
        ]
        return _joined(results, parts)


def _near_any(first: Matrix, second: Matrix, law: Matrix) -> list[Matrix]:
    """Whether each ball about sections of the first, 6×k, meets any ball about sections of the second, 6×m."""
    count = second.shape[1]
    return [ca.mmax(_meet(ca.repmat(ball, 1, count), second, law)) for ball in ca.horzsplit(first)]


def _owners(function: ca.Function) -> list[str]:
    """Owners of the arguments of a function of two panels, then of their balls."""
    return [*ARGUMENTS[: function.n_in()], "first", "second"]


def _joined(results: str, parts: Sequence[Sequence[Matrix]]) -> list[Matrix]:
    """Join results for parts of the first rod: results for the second rod are summed, others put side by side."""
    fields = zip(results, zip(*parts, strict=True), strict=True)
    return [sum(of_part[1:], of_part[0]) if of == "s" else ca.horzcat(*of_part) for of, of_part in fields]


def _over_panels(
    function: ca.Function, results: str, of_all: Sequence[Matrix], first: int, second: int
) -> list[Matrix]:
    """Results for all pairs of panels.

    Args:
        function: of two panels.
        results: as :meth:`SectionPairs._over_pairs` takes them.
        of_all: its arguments for all panels, and their balls.
        first: number of panels of the first rod.
        second: number of panels of the second rod.
    """
    # One call for each panel of the first: arguments of the second are not copied for it.
    by_panel = [
        ca.horzsplit(field, field.shape[1] // first) if owner == "first" else [field] * first
        for field, owner in zip(of_all, _owners(function), strict=True)
    ]
    near = _near_any(of_all[-2], of_all[-1], of_all[LAW_ARGUMENT])
    row = called_near(_row(function, results, second))
    return _joined(results, [row.call([meets, *own]) for meets, *own in zip(near, *by_panel, strict=True)])


def _symbols(function: ca.Function, first: int, second: int) -> list[ca.MX]:
    """Symbols for the arguments of a function of two panels for these numbers of panels, and for their balls."""
    sizes = [*(function.size_in(i) for i in range(function.n_in())), (6, 1), (6, 1)]
    counts = {"first": first, "second": second, "law": 1}
    return [
        ca.MX.sym(f"all_{i}", rows, columns * counts[owner])
        for i, ((rows, columns), owner) in enumerate(zip(sizes, _owners(function), strict=True))
    ]


@cache
def _group(function: ca.Function, results: str, first: int, second: int) -> ca.Function:
    """A function of two panels for a group of panels of the first rod and all of the second.

    Args:
        function: of two panels.
        results: as :meth:`SectionPairs._over_pairs` takes them.
        first: number of panels of the group.
        second: number of panels of the second rod.

    Returns:
        the arguments for all panels, and their balls ↦ the results.
    """
    symbols = _symbols(function, first, second)
    return ca.Function(f"{function.name()}_of_group", symbols, _over_panels(function, results, symbols, first, second))


@cache
def _row(function: ca.Function, results: str, panels: int) -> ca.Function:
    """A function of two panels for one panel of the first rod and all of the second.

    Args:
        function: a function of two panels, the law, and further arguments that ARGUMENTS names.
        results: as :meth:`SectionPairs._over_pairs` takes them.
        panels: number of panels of the second rod.

    Returns:
        the arguments for all panels, and their balls ↦ the results.
    """
    symbols = _symbols(function, 1, panels)
    arguments = [
        symbol if owner == "second" else ca.repmat(symbol, 1, panels)
        for symbol, owner in zip(symbols, _owners(function), strict=True)
    ]
    near = _meet(arguments[-2], arguments[-1], symbols[LAW_ARGUMENT])
    fields = called_near(function).map(panels).call([near, *arguments[:-2]])
    summed = [_over_second(field, panels) if of == "f" else field for field, of in zip(fields, results, strict=True)]
    return ca.Function(f"{function.name()}_of_row", symbols, summed)


ARGUMENTS = ("first", "first", "second", "second", "law", "second", "second", "first", "first")
"""Owners of the arguments of a function of two panels; motions, or derivatives, follow the law."""

LAW_ARGUMENT = ARGUMENTS.index("law")
"""Index of the law among the arguments of a function of two panels."""


def _for_all_pairs(arguments: Sequence[Matrix]) -> list[Matrix]:
    """Positions, data and law of two panels for all pairs of their sections; the first index runs faster."""
    first, second = arguments[:2], arguments[2:4]
    of_first = [ca.repmat(field, 1, PANEL) for field in first]
    of_second = [ca.reshape(ca.repmat(field, PANEL, 1), field.shape[0], PANEL**2) for field in second]
    return [*of_first, *of_second, ca.repmat(arguments[LAW_ARGUMENT], 1, PANEL**2)]


@cache
def _across(first: int, second: int, sections: int) -> ca.Function:
    """(derivatives by m coordinates and the positions of sections, m×3S, motion of these, 3n×S) ↦ m×n."""
    mixed, motion = ca.MX.sym("mixed", second, 3 * sections), ca.MX.sym("motion", 3 * first, sections)
    return ca.Function("across", [mixed, motion], [mixed @ ca.reshape(motion, first, 3 * sections).T])


@cache
def _with_coordinates(count: int, sections: int) -> ca.Function:
    """(derivatives by each section, 9×S, and its motion, 3n×S) ↦ second derivative by n coordinates, n×n."""
    hessian, motion = ca.MX.sym("hessian", 9, sections), ca.MX.sym("motion", 3 * count, sections)
    components = ca.vertsplit(motion, count)
    entries = ca.vertsplit(hessian)
    rows = []
    for i in range(3):
        terms = [components[j] @ ca.diag(entries[3 * i + j]) for j in range(3)]
        rows.append(components[i] @ (terms[0] + terms[1] + terms[2]).T)
    return ca.Function("with_coordinates", [hessian, motion], [rows[0] + rows[1] + rows[2]])
