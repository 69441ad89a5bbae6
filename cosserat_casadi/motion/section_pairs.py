"""Exact contact in stages of optimal control, by equations that do not change with contacts: pairs of force and gap.

An optimiser passes from contacts to others, while its equations must not change. So each of a number of sections, and
each body that may touch, has a force and a gap g over the length, which obey the law of a cable that may go slack,

    Λ + g − √(Λ² + g² + a ε²) = 0,    which is Λ g = a ε²/2 with Λ, g > 0.

Λ = a N is the dimensionless force N times the displacement a, over the length, of its section by a unit force within a
stage, so that it has the size of gaps, like other unknowns of a stage. For any stage, N g = ε²/2. The gap is taken at
the end of a stage of one instant, which is Euler's implicit method. An approaching section stops at the obstacle at the
end of a stage, and rests once g is zero at two ends: a blow takes the whole speed, with a coefficient of restitution of
zero. For another coefficient e the gap is taken at

    (x₊ + e x₋)/(1 + e),    x₊ at the end of the stage and x₋ at the beginning of the last one,

which returns the share e of the speed (L. Paoli, M. Schatzman, *SIAM J. Numer. Anal.* 40 (2002) 702–733). Stages of
several instants have no such pairs: a force at the first instant would throw back a section without restitution.

Two rods have such a pair for each stretch of the first one: its gap to the second rod is least there over the abscissae
of both, which :mod:`~cosserat_casadi.motion.nearest_places` finds. Forces act at these two sections, on one line.

Coulomb friction adds no unknown. The touching point of a section moves by w along the surface within a stage, at its
velocity at the end, and friction on it is

    −μ N w / √(w² + a ε²),

so a section on which friction is the share r of μ N creeps by √a ε r/√(1 − r²), over the length, within a stage.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby, pairwise

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.constraints.cable_length import pair_kernel
from cosserat_casadi.equilibrium.contact.gap_rows import RodSurface
from cosserat_casadi.equilibrium.contact.gaps import body_pairs, pairs, support_of
from cosserat_casadi.equilibrium.contact.obstacle_surfaces import distance_from, surface
from cosserat_casadi.loads.contact_layer import along_surface, weighted_way
from cosserat_casadi.loads.obstacle_load import section_radii
from cosserat_casadi.maths.calls import with_jacobian_in_a_loop
from cosserat_casadi.maths.numbers import as_matrix
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.contact_pairs import named_pairs
from cosserat_casadi.model.function_table import PARAMETERS, Expressions, expressions_of
from cosserat_casadi.model.section_poses import interpolation_weights, section_weights
from cosserat_casadi.model.system import System
from cosserat_casadi.motion.coincident_ends import watched_ends
from cosserat_casadi.motion.nearest_places import NearestPlaces, nodes_by_products
from cosserat_casadi.motion.surface_sliding import poses_apart, touching_point_of_rods

SECTIONS = 8
"""Number of stretches of a rod, at whose ends are the sections that may touch an obstacle."""

STILL = 1e-12
"""Displacement within a stage, over the length, added to √a ε, so that friction has derivatives without smoothing."""


@dataclass(frozen=True)
class TouchingSections:
    """Sections of a rod, or a body, that may touch an obstacle, or stretches of a rod that may touch another rod.

    Attributes:
        owner: name of the rod or the body.
        against: the obstacle, or the contact with the other rod.
        places: abscissae X of the sections, base to tip; a single number for a body; for stretches all their ends.
        of_body: whether the owner is a body.
        other: name of the other rod; None for an obstacle.
    """

    owner: str
    against: scenes.ObstacleRecord | scenes.RodContact
    places: tuple[float, ...]
    of_body: bool
    other: str | None = None

    @property
    def obstacle(self) -> scenes.ObstacleRecord:
        """The obstacle; not for stretches that may touch another rod."""
        assert not isinstance(self.against, scenes.RodContact), "asked for of obstacles"
        return self.against

    @property
    def count(self) -> int:
        """Number of pairs of force and gap."""
        return len(self.places) - (self.other is not None)


@dataclass(frozen=True)
class TouchingPairs:
    """The equations of motion of a model at the end of a stage, with pairs of force and gap.

    The unknowns x are the unknowns of the model, followed by Λ of all pairs; the parameters are those of the model,
    followed by the smoothing ε.

    Attributes:
        model: the model, with or without parameters.
        sections: number of stretches of a rod, at whose ends are sections that may touch.
        duration: duration of the stage, s.
        in_loops: whether derivatives of rods that touch rods are loops over columns, which is short in C; in CasADi's
            virtual machine they take four times as long.
    """

    model: Model
    sections: int
    duration: float
    in_loops: bool = False

    @cached_property
    def _nominal(self) -> Model:
        """The model with the parameters of the scene."""
        return self.model.at()

    @cached_property
    def touching(self) -> tuple[TouchingSections, ...]:
        """Sections and bodies that may touch, in the order of the pairs, sorted by coefficient of restitution."""
        return tuple(sorted(self._all(), key=lambda touching: touching.against.restitution))

    def _all(self) -> Iterator[TouchingSections]:
        nominal = self._nominal
        X = np.linspace(0.0, 1.0, self.sections + 1).tolist()
        for rod, obstacle in pairs(nominal.scene):
            base, tip = watched_ends(nominal, rod, obstacle)
            places = X[0 if base else 1 : None if tip else -1]
            if places:
                yield TouchingSections(rod, obstacle, tuple(places), of_body=False)
        for body, obstacle in body_pairs(nominal.scene):
            yield TouchingSections(body.name, obstacle, (0.0,), of_body=True)
        for contact, (rod, other) in named_pairs(nominal.scene):
            if contact.exact:
                yield TouchingSections(rod, contact, tuple(X), of_body=False, other=other)

    @cached_property
    def count(self) -> int:
        """Number of pairs."""
        return sum(touching.count for touching in self.touching)

    @cached_property
    def gaps(self) -> ca.Function:
        """(x, inputs), with parameters (x, inputs, p), ↦ gaps of all pairs over the length; x belongs to the model."""
        symbols = self._written.symbols
        given = list(symbols.values())
        gaps = self._gaps(self.touching, "gaps")
        places = self._nearest(self.touching).call(given)
        return gaps if not places else ca.Function("gaps", given, gaps.call([*given, *places]), list(symbols), ["gaps"])

    @cached_property
    def force_units(self) -> FloatArray:
        """Force of each pair at Λ = 1, N, shape (count,)."""
        rows = [self._force_units(touching) for touching in self.touching]
        return np.concatenate([np.zeros(0), *rows])

    @cached_property
    def softness(self) -> FloatArray:
        """Displacement a of each section or body by the force EI/ℓ² within a stage, over the length, shape (count,)."""
        discrete = self._nominal.discrete
        units = [
            np.full(touching.count, discrete.contact_unit(touching.owner, of_body=touching.of_body))
            for touching in self.touching
        ]
        return np.concatenate([np.zeros(0), *units]) / self.force_units

    @cached_property
    def inverse_dynamics(self) -> ca.Function:
        """(x, v, a, inputs, p, rates) ↦ residual of the model's inverse dynamics, then the equations of the pairs."""
        arguments = self._symbols
        plain = ca.vertcat(self.model.inverse_dynamics(*self._of_model(arguments)), ca.MX(self.count, 1))
        return self._function("inverse_dynamics", arguments, [plain + self._rows(arguments)], ["residual"])

    @cached_property
    def dynamics_jacobian(self) -> ca.Function:
        """Arguments of :attr:`inverse_dynamics` ↦ its derivatives with respect to x, v and a, and the residual."""
        arguments = self._symbols
        *matrices, residual = self.model.dynamics_jacobian(*self._of_model(arguments))
        rows = self._rows(arguments)
        room = ca.MX(self.count, self.count)
        whole = [
            ca.diagcat(matrix, room) + ca.jacobian(rows, argument)
            for matrix, argument in zip(matrices, arguments[:3], strict=True)
        ]
        residual = ca.vertcat(residual, ca.MX(self.count, 1)) + rows
        names = self.model.dynamics_jacobian.name_out()
        return self._function("dynamics_jacobian", arguments, [*whole, residual], names)

    def _rows(self, arguments: list[Matrix]) -> Matrix:
        """Contact forces in the equations of the model, followed by the equations of the pairs."""
        if not self.in_loops or all(touching.other is None for touching in self.touching):
            return self._written_rows(arguments)
        rows: Matrix = self._rows_in_a_loop(*arguments[:-1])
        return rows

    @cached_property
    def _rows_in_a_loop(self) -> ca.Function:
        """Arguments of :attr:`inverse_dynamics` but the last ↦ the rows, with derivatives that are short in C."""
        arguments = self._symbols
        words = self._words[:-1]
        return with_jacobian_in_a_loop(
            ca.Function("pairs", arguments[:-1], [self._written_rows(arguments)], words, ["rows"])
        )

    @cached_property
    def _symbols(self) -> list[Matrix]:
        """Symbols for x, v, a, inputs, p, inputs_rate and inputs_acceleration."""
        size = self.model.size + self.count
        inputs = self.model.inputs.size
        sizes = [size, size, size, inputs, self.model.parameters.size + 1, inputs, inputs]
        return [ca.MX.sym(name, length) for name, length in zip(self._words, sizes, strict=True)]

    @property
    def _words(self) -> list[str]:
        return ["x", "v", "a", "inputs", PARAMETERS, "inputs_rate", "inputs_acceleration"]

    def _function(self, name: str, arguments: list[Matrix], results: list[Matrix], names: list[str]) -> ca.Function:
        return ca.Function(name, arguments, results, self._words, names)

    def _of_model(self, arguments: list[Matrix]) -> list[Matrix]:
        """Select the arguments of the functions of the model."""
        *moving, inputs, p, rate, acceleration = arguments
        own = [each[: self.model.size] for each in moving]
        return [*own, inputs, *self._parameters(p), rate, acceleration]

    def _parameters(self, p: Matrix) -> list[Matrix]:
        """List with the parameters of the model; empty if it has none."""
        return [p[:-1]] if self.model.parameters.size else []

    def _written_rows(self, arguments: list[Matrix]) -> Matrix:
        """Contact forces in the equations of the model, followed by the equations of the pairs."""
        x, v, a, inputs, p, rate, _ = arguments
        own = slice(0, self.model.size)
        moved_by = x[self.model.size :]
        energies = ca.DM(self.force_units * self._lengths) * moved_by
        pushes: Matrix = ca.MX(self.model.size, 1)
        gaps: list[Matrix] = []
        first = 0
        for restitution, of_group in groupby(self.touching, lambda touching: touching.against.restitution):
            group = tuple(of_group)
            function = self._gaps(group, "gaps_of_restitution")
            # x₋ = x₊ − 2 h v₊ + h² a₊ with Euler's implicit method.
            back = restitution / (1.0 + restitution)
            x_between = x[own] - back * (2.0 * self.duration * v[own] - self.duration**2 * a[own])
            inputs_between = inputs - 2.0 * back * self.duration * rate
            at = ca.MX.sym("at", self.model.size)
            given = [at, ca.MX.sym("inputs", inputs.shape[0])]
            given += [ca.MX.sym(PARAMETERS, each.shape[0]) for each in self._parameters(p)]
            given += [ca.MX.sym("places", *places.shape) for places in self._place_symbols(group)]
            weights = ca.MX.sym("weights", function.size1_out(0))
            push = ca.densify(ca.jtimes(function(*given), at, weights, True))
            pushed = ca.Function("push", [*given, weights], [push])
            between = [x_between, inputs_between, *self._parameters(p)]
            # Where a gap is least, a change of its places does not change it.
            between += self._nearest(group).call(between)
            count = function.size1_out(0)
            gaps.append(function(*between))
            pushes = pushes + pushed(*between, energies[first : first + count])
            first += count
        kernel = pair_kernel(slack=True, softness=1.0).map(self.count)
        smoothings = p[-1] * ca.DM(np.sqrt(self.softness))
        residual, _, _ = kernel(ca.vertcat(*gaps).T, moved_by.T, smoothings.T)
        if self._rubbing:
            ways = ca.DM(self._lengths) * smoothings
            forces = ca.DM(self.force_units) * moved_by
            given = [x[own], inputs, *self._parameters(p)]
            places = self._nearest(tuple(touching for touching, _ in self._rubbing)).call(given)
            pushes += self._friction(*given, *places, v[own], rate, forces, ways)
        rows: Matrix = ca.vertcat(-pushes / ca.DM(self.model.discrete.unknowns.units), residual.T)
        return rows

    @cached_property
    def _friction(self) -> ca.Function:
        """(x, inputs, v, rate, forces, creeps) ↦ friction on the unknowns, J.

        Parameters are appended to inputs, and then the places at which rods rub on rods.
        """
        written = self._written
        rubbing = [touching for touching, _ in self._rubbing]
        places = self._place_symbols(rubbing)
        v, rate = ca.MX.sym("v", self.model.size), ca.MX.sym("rate", self.model.inputs.size)
        forces, ways = ca.MX.sym("forces", 1, self.count), ca.MX.sym("ways", 1, self.count)
        placed = self._placed(rubbing, places)
        poses = [self._poses(written.system, touching, at) for touching, at in placed]
        stacked = ca.vec(ca.horzcat(*poses))
        moved = ca.jtimes(stacked, written["x"], v) + ca.jtimes(stacked, written["inputs"], rate)
        rates = ca.vertsplit(moved, np.cumsum([0, *[pose.numel() for pose in poses]]).tolist())
        pulls = []
        for (touching, span), (_, at), pose, changes in zip(self._rubbing, placed, poses, rates, strict=True):
            creep = (ways[span] + STILL * self._length(touching)) / self.duration
            drag = (self._drag(touching) if at is None else self._drag_of_rods(touching)).map(touching.count)
            change = ca.reshape(changes, *pose.shape)
            radii = self._radii(touching).T if at is None else self._radii_at(written.system, touching, at)
            pulls.append(ca.vec(drag(pose, change, radii, forces[span], creep)))
        held = ca.jtimes(stacked, written["x"], ca.vertcat(*pulls), True)
        arguments = [*written.symbols.values(), *places, v, rate, forces.T, ways.T]
        return ca.Function("friction_of_pairs", arguments, [ca.densify(held)])

    @property
    def _rubbing(self) -> list[tuple[TouchingSections, slice]]:
        """Sections and bodies with friction, with the indices of their pairs among all pairs."""
        ends = np.cumsum([touching.count for touching in self.touching]).tolist()
        places = [slice(start, end) for start, end in pairwise([0, *ends])]
        return [each for each in zip(self.touching, places, strict=True) if each[0].against.rubs]

    def _drag(self, touching: TouchingSections) -> ca.Function:
        """(pose, its rate, radius, m, force, N, creep, m/s) ↦ generalised friction on the entries of the pose, 12×1.

        A pose is the centre of a section, or of a body, and its rotation, column after column, in the axes of the
        obstacle. Friction is μ N if sliding is fast compared with the creep, and proportional to it if it is slow.
        """
        pose, rate = ca.SX.sym("pose", 12), ca.SX.sym("rate", 12)
        radius, force, creep = ca.SX.sym("radius"), ca.SX.sym("force"), ca.SX.sym("creep")
        axes = ca.reshape(pose[3:], 3, 3)
        _, normal, _ = surface(touching.obstacle)(pose[:3])
        arm = -radius * normal
        if touching.of_body:
            _, arm = support_of(self._nominal.discrete.bodies[touching.owner], normal, axes)
        # The touching point is one of the material.
        material = axes.T @ arm
        slide = along_surface(rate[:3] + ca.reshape(rate[3:], 3, 3) @ material, normal)
        weighted = weighted_way(touching.obstacle.coefficients, slide, along_surface(axes[:, 2], normal), creep)
        held = -force * weighted / ca.sqrt(ca.sumsqr(slide) + creep**2)
        pull = ca.vertcat(held, ca.vec(held @ material.T))
        return ca.Function("drag", [pose, rate, radius, force, creep], [ca.cse(ca.densify(pull))])

    def _drag_of_rods(self, touching: TouchingSections) -> ca.Function:
        """(poses, their rates, radii, m, force, N, creep, m/s) ↦ generalised friction on the entries of both, 24×1.

        Friction on both rods acts at the point where they touch.
        """
        poses, rates, radii = ca.SX.sym("poses", 24), ca.SX.sym("rates", 24), ca.SX.sym("radii", 2)
        force, creep = ca.SX.sym("force"), ca.SX.sym("creep")
        normal, arms, velocity = touching_point_of_rods(poses_apart(poses), poses_apart(rates), ca.vertsplit(radii))
        slide = along_surface(velocity, normal)
        held = -force * touching.against.coefficients[0] * slide / ca.sqrt(ca.sumsqr(slide) + creep**2)
        pulls = [ca.vertcat(pull, ca.vec(pull @ arm.T)) for pull, arm in zip((held, -held), arms, strict=True)]
        return ca.Function(
            "drag_of_rods", [poses, rates, radii, force, creep], [ca.cse(ca.densify(ca.vertcat(*pulls)))]
        )

    def _poses(self, system: System, touching: TouchingSections, places: Matrix | None) -> Matrix:
        """Positions of sections, or of a body, and their rotations, in the axes of the obstacle, 12×k.

        For two rods: positions and rotations of the sections of both at their places, in world axes, 24×k.
        """
        if places is not None:
            return ca.vertcat(*[ca.vertcat(*sections) for sections in self._rods_in_world(system, touching, places)])
        carrier = touching.obstacle.body
        positions, *directors = self._in_world(system, touching)
        seen = system.seen_from(carrier, positions)
        return ca.vertcat(seen, *[system.turned_to(carrier, director) for director in directors])

    def _radii(self, touching: TouchingSections) -> Matrix:
        """Radii of sections, or the radius of a body, k×1, m."""
        if touching.of_body:
            return ca.DM(self._nominal.discrete.bodies[touching.owner].ball_radius)
        rod = self.model.discrete.rods[touching.owner].properties
        return as_matrix(section_radii(rod, np.array(touching.places)))

    @property
    def _written(self) -> Expressions:
        """Writer of expressions in unknowns and inputs of the model, and in its parameters if it has any."""
        words = ["x", "inputs", *([PARAMETERS] if self.model.parameters.size else [])]
        return expressions_of(self.model, tuple(words), "")

    def _gaps(self, touching: tuple[TouchingSections, ...], name: str) -> ca.Function:
        """(x, inputs) ↦ gaps; parameters are appended to inputs, and then the places of rods that touch rods."""
        written = self._written
        places = self._place_symbols(touching)
        gaps = [
            self._gaps_of(written.system, each) if at is None else self._gaps_of_rods(written.system, each, at)
            for each, at in self._placed(touching, places)
        ]
        words = [*written.symbols, *(["places"] if places else [])]
        arguments = [*written.symbols.values(), *places]
        return ca.Function(name, arguments, [ca.densify(ca.vertcat(*gaps))], words, ["gaps"])

    def _nearest(self, touching: tuple[TouchingSections, ...]) -> ca.Function:
        """(x, inputs), with parameters (x, inputs, p), ↦ places on both rods, 2×k; without result if no rods touch."""
        given = list(self._written.symbols.values())
        found = [self._nearest_of[each](*given) for each in touching if each.other is not None]
        return ca.Function("nearest", given, [ca.horzcat(*found)] if found else [])

    @cached_property
    def _nearest_of(self) -> dict[TouchingSections, ca.Function]:
        """(x, inputs), with parameters (x, inputs, p), ↦ places on two rods, 2×k, for each two rods that may touch."""
        written = self._written
        given = list(written.symbols.values())
        of_rods = [each for each in self.touching if each.other is not None]
        return {
            each: ca.Function(
                f"places_{number}", given, [NearestPlaces(written.system, _rods(each), each.places, number).places]
            )
            for number, each in enumerate(of_rods)
        }

    @staticmethod
    def _place_symbols(touching: Sequence[TouchingSections]) -> list[ca.MX]:
        """Symbol of the places of all stretches, 2×k, in a list; empty if no rods touch."""
        count = sum(each.count for each in touching if each.other is not None)
        return [ca.MX.sym("places", 2, count)] if count else []

    @staticmethod
    def _placed(
        touching: Sequence[TouchingSections], places: Sequence[Matrix]
    ) -> list[tuple[TouchingSections, Matrix | None]]:
        """Sections and stretches, each with its columns of all places; None for sections that may touch an obstacle."""
        placed: list[tuple[TouchingSections, Matrix | None]] = []
        first = 0
        for each in touching:
            last = first + (0 if each.other is None else each.count)
            placed.append((each, None if each.other is None else places[0][:, first:last]))
            first = last
        return placed

    def _gaps_of_rods(self, system: System, touching: TouchingSections, places: Matrix) -> Matrix:
        """Gaps of two rods at their places, 2×k, over the length, k×1."""
        own, other = (sections[0] for sections in self._rods_in_world(system, touching, places))
        radii = ca.sum1(self._radii_at(system, touching, places))
        return (ca.sqrt(ca.sum1((own - other) ** 2)) - radii).T / self._length(touching)

    def _rods_in_world(self, system: System, touching: TouchingSections, places: Matrix) -> list[list[Matrix]]:
        """World positions of the sections of both rods, m, and their directors, 3×k each."""
        found = []
        for row, rod in enumerate(_rods(touching)):
            at = ca.horzsplit(places[row, :])
            weights = ca.horzcat(*[interpolation_weights(self.model.discrete, rod, X) for X in at])
            _, *directors = system.sections(rod, weights)
            found.append([nodes_by_products(system, rod) @ weights, *directors])
        return found

    def _radii_at(self, system: System, touching: TouchingSections, places: Matrix) -> Matrix:
        """Radii of both rods at their places, 2×k, m."""
        both = [RodSurface(system, rod) for rod in _rods(touching)]
        radii: Matrix = ca.vertcat(*[rod.radius(places[row, :]) for row, rod in enumerate(both)])
        return radii

    def _gaps_of(self, system: System, touching: TouchingSections) -> Matrix:
        """Gaps of sections, or of a body, from an obstacle, over the length, k×1."""
        positions = self._in_world(system, touching)[0]
        seen = system.seen_from(touching.obstacle.body, positions)
        distances = distance_from(touching.obstacle).map(seen.shape[1])(seen).T
        if touching.of_body:
            body = self._nominal.discrete.bodies[touching.owner]
            _, normal, _ = surface(touching.obstacle)(seen)
            axes = system.body(touching.owner).rotation
            reach, _ = support_of(body, normal, system.turned_to(touching.obstacle.body, axes))
        else:
            reach = self._radii(touching)
        gaps: Matrix = (distances - reach) / self._length(touching)
        return gaps

    def _in_world(self, system: System, touching: TouchingSections) -> list[Matrix]:
        """World positions of sections, or of a body, m, and their three directors, 3×k each."""
        if touching.of_body:
            pose = system.body(touching.owner)
            return [pose.position, *ca.horzsplit(ca.MX(pose.rotation))]
        weights = section_weights(self.model.discrete, touching.owner, touching.places)
        return system.sections(touching.owner, weights)

    def _length(self, touching: TouchingSections) -> float:
        """Length by which gaps are divided, m."""
        if touching.of_body:
            return float(self._nominal.discrete.body_frame(touching.owner).length)
        return self._length_of(touching.owner)

    def _length_of(self, rod: str) -> float:
        return float(self._nominal.discrete.rods[rod].properties.length)

    @cached_property
    def _lengths(self) -> FloatArray:
        """Length by which the gap of each pair is divided, m, shape (count,)."""
        lengths = [np.full(touching.count, self._length(touching)) for touching in self.touching]
        return np.concatenate([np.zeros(0), *lengths])

    def _force_units(self, touching: TouchingSections) -> FloatArray:
        """Force, N, that moves each section by one length within a stage, in the direction in which it yields most.

        For a stretch the middle moves, and so does the middle of the stretch of the other rod that yields most.
        """
        if touching.other is not None:
            middle = [(start + end) / 2 for start, end in pairwise(touching.places)]
            of_rods = [
                self._force_units(TouchingSections(rod, touching.against, tuple(middle), of_body=False))
                for rod in _rods(touching)
            ]
            own, other = of_rods[0], float(of_rods[1].min()) * self._length(touching) / self._length_of(touching.other)
            return np.asarray(own * other / (own + other))
        nominal = self._nominal
        at = nominal.unloaded(), nominal.pack()
        written = expressions_of(nominal, ("x", "inputs"), "")
        positions = ca.vec(ca.MX(self._in_world(written.system, touching)[0]))
        slopes = ca.Function("slopes", list(written.symbols.values()), [ca.jacobian(positions, written["x"])])
        still = [np.zeros(nominal.size)] * 2
        steady = [np.zeros(nominal.inputs.size)] * 2
        stiffness, damping, mass, _ = nominal.dynamics_jacobian(at[0], *still, at[1], *steady)
        matrix = stiffness + damping / self.duration + mass / self.duration**2
        moved = slopes(*at).full()
        yields = np.linalg.solve(matrix.full(), (moved / nominal.discrete.unknowns.units).T)
        units: list[float] = []
        for of_section in np.split(moved, len(touching.places)):
            rows = slice(3 * len(units), 3 * len(units) + 3)
            most = float(np.linalg.norm(of_section @ yields[:, rows], 2))
            # What cannot move is pushed by any force.
            units.append(self._length(touching) / most if most > 0.0 else 1.0)
        return np.array(units)


def _rods(touching: TouchingSections) -> tuple[str, str]:
    """Names of two rods that touch."""
    assert touching.other is not None, "asked for of rods that touch rods"
    return touching.owner, touching.other
