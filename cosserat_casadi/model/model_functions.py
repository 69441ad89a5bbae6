"""The named functions of a model: each is defined by one method and nothing else.

Every method returns the expressions of its results; its decorator declares the rest. See model/function_table.py.
All functions are exact for the discrete model and can be differentiated again.
"""

from __future__ import annotations

import casadi as ca

from cosserat_casadi.maths.pose import Pose
from cosserat_casadi.maths.rotation import quaternion_product, quaternion_to_matrix
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.contact_depth import contact_depths, sections_lie_apart
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.model.function_table import PARAMETERS, Expressions, Output, Owner, owned_functions, scene_function
from cosserat_casadi.model.load_assembly import RodBase, RodLoads
from cosserat_casadi.model.load_memory import rubbing_at_nodes
from cosserat_casadi.model.registry import EFFECTS
from cosserat_casadi.model.scene_actuators import rod_actuation
from cosserat_casadi.model.scene_equations import SceneEquations
from cosserat_casadi.model.section_poses import interpolation_weights
from cosserat_casadi.model.strain_margins import strain_margins
from cosserat_casadi.model.system import Arguments, System, ratio_of
from cosserat_casadi.model.thin import places
from cosserat_casadi.model.unloaded_response import parametric_response, unloaded_response
from cosserat_casadi.model.watched import watched
from cosserat_casadi.rod import kinematics
from cosserat_casadi.rod.igm import InverseGeometricModel
from cosserat_casadi.rod.statics import Statics
from cosserat_casadi.rod.transport import largest_turn
from cosserat_casadi.scene.constraint_records import AxisJoint

RESOLVED_TURN = 2.0
"""Turn of an interval between nodes, rad, beyond which no polynomial through the nodes follows the rod.

Interpolation at Chebyshev nodes converges with more than π nodes per wave, the Magnus series up to a turn of π.
"""

RESOLVED_NORM = 1e-2
"""Error of the tip's |Q| = 1 beyond which a solution of the literal system does not follow the rod."""

PATH = ("x", "inputs", "load_factor")
"""Arguments of the functions on the way from the unloaded scene, load factor 0, to the scene, 1."""

CORRECTED = ("x", "correction", "missing", "inputs")
"""Arguments of the functions that estimate the error of an answer x by the modes and intervals that it lacks."""

POSE = (Output("position", "m"), Output("quaternion"), Output("rotation"))


def _pose_derivatives(discrete: DiscreteScene, _: str) -> tuple[Output, ...]:
    """Derivatives of a pose with respect to unknowns and inputs, and to parameters in a scene with some."""
    derivatives = (Output("d_pose_d_x", derivative_by="x"), Output("d_pose_d_inputs", derivative_by="inputs"))
    if discrete.parameters.size:
        derivatives += (Output("d_pose_d_parameters", derivative_by=PARAMETERS),)
    return derivatives


def _actuator_outputs(discrete: DiscreteScene, name: str) -> tuple[Output, ...]:
    """Effort and conjugate of an actuator by their own names, and the derivative of the conjugate."""
    member = next(EFFECTS[actuator.kind] for actuator in discrete.scene.actuators if actuator.name == name)
    effort = Output(member.effort, member.effort_unit)
    conjugate = Output(member.conjugate, member.conjugate_unit)
    return effort, conjugate, Output(f"d_{conjugate.name}_d_x", derivative_by="x")


def _joint_outputs(discrete: DiscreteScene, name: str) -> tuple[Output, ...]:
    """Effort along a joint and its coordinate, by their names in the scene."""
    (joint,) = [joint for joint in discrete.scene.joints_with_coordinate if joint.name == name]
    assert isinstance(joint, AxisJoint), "joints with a coordinate have an axis"
    keys = (joint.effort_key, joint.coordinate_key)
    outputs = [Output(key, joint.inputs[key].unit) for key in keys]
    if joint.has_stops:
        outputs.append(Output("stop", outputs[0].unit))
    return tuple(outputs)


class ModelFunctions:
    """The named functions of a model.

    Attributes:
        discrete: the scene with its constant matrices.
    """

    discrete: DiscreteScene

    @scene_function(Output("residual"), differentiable=True)
    def residual(self, written: Expressions) -> list[Matrix]:
        """(x, inputs) ↦ residual of report (2.20), without unit, zero in equilibrium."""
        return [written.equations(SceneEquations).residual]

    @scene_function(Output("jacobian"), Output("residual"))
    def jacobian(self, written: Expressions) -> list[Matrix]:
        """(x, inputs) ↦ (jacobian, residual), in the order of a CasADi rootfinder's ``jacobian_function``."""
        equations = written.equations(SceneEquations)
        return [equations.jacobian, equations.residual]

    @scene_function(Output("input_jacobian"))
    def input_jacobian(self, written: Expressions) -> list[Matrix]:
        """(x, inputs) ↦ derivative of the residual with respect to the inputs."""
        residual = written.equations(SceneEquations).residual
        return [ca.jacobian(residual, written["inputs"])]

    @scene_function(Output("parameter_jacobian"))
    def parameter_jacobian(self, written: Expressions) -> list[Matrix] | None:
        """(x, inputs, p) ↦ derivative of the residual with respect to the parameters; None without parameters."""
        if not written.discrete.parameters.size:
            return None
        residual = written.equations(SceneEquations).residual
        return [ca.jacobian(residual, written["p"])]

    @scene_function(Output("residual"), arguments=PATH, kernel="residual")
    def path_residual(self, written: Expressions) -> list[Matrix]:
        """(x, inputs, load_factor) ↦ residual of the scene at a load factor: 0 is the unloaded scene, 1 the scene."""
        return [written.equations(SceneEquations).residual]

    @scene_function(Output("jacobian"), arguments=PATH, kernel="jacobian")
    def path_jacobian(self, written: Expressions) -> list[Matrix]:
        """(x, inputs, load_factor) ↦ ∂ residual / ∂x of the scene at a load factor."""
        return [written.equations(SceneEquations).jacobian]

    @scene_function(Output("residual_rate"), arguments=(*PATH, "inputs_rate", "load_factor_rate"), kernel="rate")
    def path_rate(self, written: Expressions) -> list[Matrix]:
        """(x, inputs, load_factor, inputs_rate, load_factor_rate) ↦ rate of the residual at fixed x."""
        moving = ca.vertcat(written["inputs"], written["load_factor"])
        speed = ca.vertcat(written["inputs_rate"], written["load_factor_rate"])
        # One symbol for inputs and load factor, so that one directional derivative is taken.
        joined = ca.MX.sym("inputs_and_load_factor", moving.shape[0])
        arguments = Arguments(written["x"], joined[:-1], joined[-1])
        equations = SceneEquations(System(written.discrete, arguments))
        rate = ca.jtimes(equations.residual, joined, speed)
        return [ca.substitute(rate, joined, moving)]

    @scene_function(Output("tangent"), arguments=("inputs",), kernel="tangent")
    def path_tangent(self, written: Expressions) -> list[Matrix]:
        """Inputs ↦ dx/dλ of the unloaded scene, where the Jacobian is constant."""
        if written.discrete.parameters.size:
            return [parametric_response(written)]
        return [unloaded_response(self.discrete, self.path_jacobian, self.path_rate, written["inputs"])]

    @scene_function(Output("resolution_index"), kernel="resolution_index")
    def resolution_index(self, written: Expressions) -> list[Matrix]:
        """(x, inputs) ↦ resolution index: above 1 the nodes are too few to resolve the rod, whatever its residual.

        It is at least the depth of rods in smooth obstacles over the width, and so above 1 for rods that lie too deep.
        """
        return [resolution_index(written)]

    @scene_function(Output("strain_margins"), kernel="strain_margins")
    def strain_margins(self, written: Expressions) -> list[Matrix] | None:
        """(x, inputs) ↦ margins to states that no rod can be in, one for each path, joint, law and actuator with one.

        The margin of a tendon is the least length of its path per length of the rod: at zero the rod has pressed it to
        nothing. Margins of joints and supports of rods in a plane follow, which inputs or parameters may take out of
        the plane; then of each rod with a nonlinear material and of each chamber with a growing area, to the end of the
        law. None for a scene without any such margin.
        """
        margins = strain_margins(written.system)
        return [ca.vertcat(*margins.values())] if margins else None

    @scene_function(Output("depth"))
    def contact_depth(self, written: Expressions) -> list[Matrix] | None:
        """(x, inputs) ↦ depth of nodes and bodies in obstacles, in widths; None without smooth contact."""
        depths = contact_depths(written.system)
        return [ca.mmax(ca.vertcat(0, *depths))] if depths else None

    @scene_function(Output("apart"))
    def sections_apart(self, written: Expressions) -> list[Matrix] | None:
        """(x, inputs) ↦ whether sections that sum thin layers are too far apart, 1 or 0; None if none can be."""
        apart = sections_lie_apart(written.system)
        return None if apart is None else [apart]

    @scene_function(Output("history"), Output("slips"), Output("friction", "N/m"))
    def memory(self, written: Expressions) -> list[Matrix] | None:
        """(x, inputs) ↦ inputs ``history`` for the next point of a path, stacked; slip and friction at nodes.

        Slip, 1×…, and friction, 3×…, stand side by side for the nodes of each load with memory, N/m, then for the
        sections of the first rod of each pair, N. None for a model without memory.
        """
        if written.discrete.layout.memory is None:
            return None
        loads = rubbing_at_nodes(written.system)
        loads += [terms.rubbing for terms in written.system.pairs if terms.rubs]
        histories = [ca.vec(load.history) for load in loads]
        return [
            ca.vertcat(*histories),
            ca.horzcat(*[load.slip for load in loads]),
            ca.horzcat(*[load.friction for load in loads]),
        ]

    @scene_function(Output("positions", "m"))
    def contact_sections(self, written: Expressions) -> list[Matrix] | None:
        """(x, inputs) ↦ positions of the sections that push each other, 3×…; None without contact of rods.

        Sections of both rods of each pair stand side by side; a rod that touches itself appears twice.
        """
        positions = [side.at_sections for terms in written.system.pairs for side in (terms.sides[0], terms.sides[-1])]
        return [ca.horzcat(*positions)] if positions else None

    @scene_function(Output("positions", "m"), kernel="places")
    def places(self, written: Expressions) -> list[Matrix] | None:
        """(x, inputs) ↦ positions of points that could pass a thin obstacle or rod, 3×… (model/thin.py), or None."""
        positions = places(written.system)
        return None if positions is None else [positions]

    @scene_function(Output("balance"), arguments=CORRECTED, kernel="richer_balance", judges_answers=True)
    def richer_balance(self, written: Expressions) -> list[Matrix]:
        """(x, correction, missing, inputs) ↦ residual of the richer model at a corrected answer, as steps.

        It stacks, at x + correction and the missing coordinates: elastic steps of the unknowns and of the coordinates
        of the missing modes, the residual in the unknowns, and the watched poses and lengths in the form of the
        function ``watched``. See docs/theory.md, section 10.
        """
        richer = written.discrete.richer
        corrected = richer.joined(written["x"] + written["correction"], written["missing"])
        system = System(richer.discrete, Arguments(corrected, written["inputs"]))
        residual, lacking = richer.split(SceneEquations(system).residual)
        # Steps by which elasticity alone would cancel the residual in the missing coordinates.
        steps = richer.split(richer.elastic_step(lacking, system.shapes))
        poses = watched(system).column
        apart = sections_lie_apart(written.system)
        if apart is not None:
            # The error is unknown if the sections do not show it.
            poses = poses + ca.if_else(apart, ca.inf, 0.0)
        return [ca.densify(ca.vertcat(*steps, residual, poses))]

    @scene_function(Output("poses"), kernel="watched", judges_answers=True)
    def watched(self, written: Expressions) -> list[Matrix]:
        """(x, inputs) ↦ watched positions over lengths, quaternions and relative lengths, which the tolerance bounds.

        Poses are of sections and bodies, lengths of cables, in one column; see model/watched.py.
        """
        return [watched(written.system).column]

    @owned_functions(
        Owner.ROD,
        (Output("generalised_force", "EI/L"), Output("base_force", "N"), Output("base_moment", "N m")),
        arguments=("q", "base_position", "base_quaternion", "inputs"),
        kernel="igm",
        header="Inverse Geometric Model of rod {owner}: strain coordinates and base pose, with the loads, to the "
        "generalised force, and the force and the moment about the base of the clamp on the rod, world frame.",
    )
    def igm(self, written: Expressions) -> list[Matrix]:
        """(q, base_position, base_quaternion, inputs) ↦ (generalised_force, base_force, base_moment).

        Report (2.19) with the base pose free: forces in N, moments in N m about the base, world frame; generalised
        forces in units of EI/ℓ. Wrenches of constraints are unknowns of the scene, not loads, and are left out; so is
        the push of obstacles on bodies, which depends on the poses of the bodies.
        """
        return _inverse_geometric_model(written)

    @owned_functions(
        Owner.ROD,
        POSE,
        kernel="tip",
        kernel_outputs=2,
        header="Tip of rod {owner}, world frame.",
        differentiable=True,
    )
    def tip(self, written: Expressions) -> list[Matrix]:
        """(x, inputs) ↦ (position, quaternion, rotation) of the tip, world frame.

        Columns: position 3×1, quaternion w, x, y, z 4×1; rotation world_R_tip 3×3. All are CasADi matrices.
        """
        tip = _section_in_world(written, written.owner, -1)
        return [tip.position, tip.quaternion, tip.rotation]

    @owned_functions(
        Owner.ROD,
        _pose_derivatives,
        kernel="tip_jacobian",
        header="Derivatives of position and quaternion of the tip of rod {owner}, stacked.",
    )
    def tip_jacobian(self, written: Expressions) -> list[Matrix]:
        """(x, inputs) ↦ derivatives of the tip's position and quaternion, stacked 7×…, by x and by inputs.

        In a scene with parameters the arguments are (x, inputs, p), and derivatives by p follow.
        """
        return _section_derivatives(written, written.owner, -1)

    @owned_functions(
        Owner.ROD,
        POSE[:2],
        arguments=("x", "inputs", "X"),
        kernel="shape",
        header="Section of rod {owner} at the abscissa X, 0 at the base and 1 at the tip, world frame.",
        differentiable=True,
    )
    def shape(self, written: Expressions) -> list[Matrix]:
        """(x, inputs, X) ↦ (position, quaternion) at any X in [0, 1], world frame, by interpolation.

        The polynomial through the nodes of each element is a Chebyshev series: no singularity at a node, and exact
        derivatives by X too. X is one number; position is 3×1 and the quaternion w, x, y, z 4×1. For k abscissae,
        ``shape[rod].map(k)`` with x and inputs repeated, or ``Solution.pose``.
        """
        rod_shape = written.system.rods[written.owner].shape
        weights = interpolation_weights(written.discrete, written.owner, written["X"])
        quaternion = rod_shape.quaternion @ weights
        unit_quaternion = quaternion / ca.sqrt(ca.sumsqr(quaternion))
        section = _in_world(written.system.base(written.owner), Pose(rod_shape.position @ weights, unit_quaternion))
        return [section.position, section.quaternion]

    @owned_functions(
        Owner.ROD,
        (
            Output("position", "m"),
            Output("quaternion"),
            Output("internal_wrench"),
            Output("base_force", "N"),
            Output("base_moment", "N m"),
        ),
    )
    def fields(self, written: Expressions) -> list[Matrix]:
        """(x, inputs) ↦ position, quaternion and internal wrench at the nodes, and the base wrench.

        All are in the world frame, except the internal wrench [moment; force], N m and N, which is in section axes.
        """
        rod = written.system.rods[written.owner]
        rotation = written.system.base(written.owner).rotation
        return [
            written.system.nodes(written.owner),
            written.system.nodal_quaternions(written.owner),
            rod.statics.internal_wrench(),
            rotation @ rod.statics.held_force,
            rotation @ rod.statics.held_moment,
        ]

    @owned_functions(Owner.ROD, (Output("quaternion"), Output("by_position"), Output("by_quaternion")))
    def field_jacobian(self, written: Expressions) -> list[Matrix]:
        """(x, inputs) ↦ quaternions at the nodes; derivatives of positions and quaternions by x, node after node.

        All are in the world frame.
        """
        quaternion = written.system.nodal_quaternions(written.owner)
        by_position = ca.jacobian(ca.vec(written.system.nodes(written.owner)), written["x"])
        by_quaternion = ca.jacobian(ca.vec(quaternion), written["x"])
        return [quaternion, by_position, by_quaternion]

    @owned_functions(
        Owner.ACTUATOR,
        _actuator_outputs,
        kernel="actuator",
        header="Actuator {owner}: its effort, the conjugate that the effort does work on, and the derivative of the "
        "conjugate, which is the generalised force of a unit of effort but for the unit EI/L and the sign.",
        differentiable=True,
    )
    def actuator(self, written: Expressions) -> list[Matrix]:
        """(x, inputs) ↦ effort of an actuator, its conjugate, and the derivative of the conjugate with x, 1×size.

        These are tension and length of a tendon, pressure and volume of a chamber. The derivative is the generalised
        force of a unit of effort.
        """
        return [ca.densify(ca.MX(value)) for value in written.system.actuators.state(written.owner)]

    @owned_functions(
        Owner.JOINT,
        _joint_outputs,
        kernel="joint",
        header="Joint {owner}: what acts along it on its section, and its angle or displacement.",
        differentiable=True,
    )
    def joint(self, written: Expressions) -> list[Matrix]:
        """(x, inputs) ↦ moment or force along a joint on its section, and its angle or displacement, 1×1 each.

        A joint with stops has their push as a third output; the first output includes it.
        """
        (index,) = [i for i, joint in enumerate(written.discrete.scene.joints) if joint.name == written.owner]
        (placed,) = [placed for placed in written.discrete.constraints if placed.joint == index]
        value, effort = written.system.joint_state(placed)
        outputs = [effort, value]
        if written.discrete.joint_record(placed).has_stops:
            outputs.append(written.system.stop_effort(placed))
        return [ca.densify(ca.MX(output)) for output in outputs]

    @owned_functions(
        Owner.BODY,
        POSE,
        kernel="body",
        kernel_outputs=2,
        header="Body {owner}, world frame.",
        differentiable=True,
    )
    def body(self, written: Expressions) -> list[Matrix]:
        """(x, inputs) ↦ (position, quaternion, rotation) of a rigid body, world frame."""
        body = written.system.body(written.owner)
        return [body.position, body.quaternion, body.rotation]

    @owned_functions(
        Owner.BODY,
        _pose_derivatives,
        kernel="body_jacobian",
        header="Derivatives of position and quaternion of the body {owner}, stacked.",
    )
    def body_jacobian(self, written: Expressions) -> list[Matrix]:
        """(x, inputs) ↦ derivatives of a body's position and quaternion, stacked 7×…, by x and by inputs.

        In a scene with parameters the arguments are (x, inputs, p), and derivatives by p follow.
        """
        riding = written.system.riding.get(written.owner)
        if riding is not None:
            return _section_derivatives(written, riding.rod, riding.node, riding.in_section)
        pose = _stacked(written.system.body(written.owner))
        return [ca.densify(ca.jacobian(pose, symbol)) for symbol in written.symbols.values()]

    @scene_function(Output("energy", "J"))
    def energy(self, written: Expressions) -> list[Matrix]:
        """(x, inputs) ↦ elastic energy of all rods, J."""
        return [written.system.energy()]

    @scene_function(Output("potential", "J"))
    def potential(self, written: Expressions) -> list[Matrix] | None:
        """(x, inputs) ↦ energy whose gradient the residual is, J; None unless every load is a dead force."""
        potential = written.system.potential()
        return None if potential is None else [potential]


def resolution_index(written: Expressions) -> Matrix:
    """Largest turn of an interval over the resolvable turn; for the literal system the error of the tip's |Q|."""
    indices: list[Matrix] = [ca.MX(0.0)]
    for name, rod in written.discrete.rods.items():
        q = written["x"][written.discrete.unknowns.strain(name)]
        ratio = ratio_of(written.discrete, name, written.arguments)
        if rod.discretisation.transport == "permuted":
            # Its quaternion keeps its norm only as far as the nodes resolve the rod.
            quaternion = kinematics.shape(rod, q, ratio).quaternion[:, -1]
            error = ca.fabs(ca.norm_2(quaternion) - 1)
            indices.append(error / RESOLVED_NORM)
        elif rod.properties.turning_axes:
            indices.append(largest_turn(rod, q, ratio) / RESOLVED_TURN)
    indices += contact_depths(written.system)
    return ca.mmax(ca.vertcat(*indices))


def _inverse_geometric_model(written: Expressions) -> list[Matrix]:
    """Generalised force of loads and actuators, and base wrench in world axes, of one rod alone."""
    rod = written.discrete.rods[written.owner]
    arguments = Arguments(written["q"], written["inputs"])
    rotation = quaternion_to_matrix(written["base_quaternion"])
    ratio = ratio_of(written.discrete, written.owner, arguments)
    rod_shape = kinematics.shape(rod, written["q"], ratio)
    base = RodBase(written["base_position"], rotation.T)
    loads = RodLoads(written.discrete, written.owner, base, written["inputs"], ratio).all()
    efforts = rod_actuation(written.discrete, written.owner, written["inputs"])
    model = InverseGeometricModel(Statics(rod_shape, loads), tuple(efforts))
    force = model.generalised_force
    if model.further_force is not None:
        force = force + model.further_force
    base_force = rotation @ model.statics.base_force
    base_moment = rotation @ model.statics.base_moment
    return [force, base_force, base_moment]


def _in_world(base: Pose, section: Pose) -> Pose:
    """World pose of a section given in the base of its rod."""
    symbolic_base = Pose(ca.MX(base.position), ca.MX(base.quaternion))
    return symbolic_base.then(section)


def _section_in_world(written: Expressions, rod: str, node: int) -> Pose:
    return _in_world(written.system.base(rod), written.system.section(rod, node))


def _section_derivatives(written: Expressions, rod: str, node: int, carried: Pose | None = None) -> list[Matrix]:
    """Derivatives of the pose of a section, or of a body carried at a pose in its axes, by all symbols.

    They follow from the variations of the rod's fields: δr of the section, and δQ = ½ (0, δθ) ⊗ Q. A floating base adds
    the derivatives by its pose.
    """
    discrete = written.discrete
    section = _section_in_world(written, rod, node)
    pose = _stacked(section if carried is None else section.then(carried))
    # The literal linear system has no variations.
    if discrete.rods[rod].discretisation.transport == "permuted":
        by_unknowns = ca.jacobian(pose, written["x"])
    else:
        floats = discrete.unloaded.floating_base(rod) is not None
        by_base = _by_base(written, rod, node) if floats else ca.DM(7, discrete.size)
        strains = discrete.unknowns.strain(rod)
        by_own_strains = _by_strains(written, rod, node)
        by_unknowns = ca.horzcat(by_base[:, : strains.start], by_own_strains, by_base[:, strains.stop :])
        if carried is not None:
            own = ca.MX.sym("section", 7)
            by_section = ca.jacobian(_stacked(Pose(own[:3], own[3:]).then(carried)), own)
            by_unknowns = ca.substitute(by_section, own, _stacked(section)) @ by_unknowns
    by_inputs = ca.DM.zeros(7, discrete.layout.size)
    if discrete.layout.geometry:
        by_inputs = ca.densify(ca.jacobian(pose, written["inputs"]))
    derivatives = [ca.densify(by_unknowns), by_inputs]
    if discrete.parameters.size:
        derivatives.append(ca.densify(ca.jacobian(pose, written[PARAMETERS])))
    return derivatives


def _by_base(written: Expressions, rod: str, node: int) -> Matrix:
    """Derivative of a section's position and quaternion by the unknowns that move the base of its rod, 7×size."""
    own = ca.MX.sym("section", 7)
    pose = _stacked(written.system.base(rod).then(Pose(own[:3], own[3:])))
    return ca.substitute(ca.jacobian(pose, written["x"]), own, _stacked(written.system.section(rod, node)))


def _stacked(pose: Pose) -> Matrix:
    return ca.vertcat(pose.position, pose.quaternion)


def _by_strains(written: Expressions, rod: str, node: int) -> Matrix:
    """Derivative of a section's position and quaternion by the strains of its rod, one column for each."""
    system = written.system
    tangent = system.pose_variations(rod)
    base = system.base(rod)
    turned = ca.densify(tangent.rotation_of(node))
    count = turned.shape[1]
    quaternions = ca.repmat(ca.densify(system.section(rod, node).quaternion), 1, count)
    # One column a strain coordinate: δQ = ½ (0, δθ) ⊗ Q in the base, then turned into the world.
    spin = ca.vertcat(ca.DM.zeros(1, count), turned)
    base_quaternions = ca.MX(ca.repmat(base.quaternion, 1, count))
    turned_in_world = quaternion_product(base_quaternions, quaternion_product(spin, quaternions) / 2)
    moved_in_world = base.rotation @ tangent.position(node)
    return ca.vertcat(moved_in_world, turned_in_world)
