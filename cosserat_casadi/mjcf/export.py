"""A scene as a model of MuJoCo, in its XML format MJCF.

Rods are chains of rigid links (links.py). The order of the hinges and slides in the middle of a piece is reversed from
piece to piece: rotations do not commute, and the errors of the two orders in the strain cancel. Bodies are children of
links; joints that close a loop are constraints.

Inputs of the scene are controls of the same names, with the values of the scene in the keyframe ``scene``. In this
keyframe a model without loops is unloaded, and a model with loops is at the equilibrium of the scene: when unloaded,
the gaps of its loops may be as large as the length of a rod.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.refine import solve
from cosserat_casadi.actuators.routing import holes, offset_at
from cosserat_casadi.constraints.tip_holder import place_of
from cosserat_casadi.equilibrium.solution import Solution, SolvedPoses
from cosserat_casadi.errors import ExportError, Problem
from cosserat_casadi.files import check_writable, write_atomically
from cosserat_casadi.maths.numbers import known
from cosserat_casadi.maths.pose import IDENTITY, NumericPose
from cosserat_casadi.maths.rotation import matrix_to_quaternion, quaternion_from_tangent
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.mjcf.links import Inertia, Link, links_of, nodes_along, poses_along
from cosserat_casadi.mjcf.start import MjcfJoint, coordinates_at
from cosserat_casadi.model.element_ends import element_ends
from cosserat_casadi.model.floating_frames import UnloadedScene
from cosserat_casadi.model.scene_rods import rod_properties
from cosserat_casadi.model.tube_checks import refuse_tubes
from cosserat_casadi.obstacles.registry import SURFACES
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.rod.properties import STRAINS
from cosserat_casadi.rod.strain import DiscreteRod
from cosserat_casadi.scene.constraint_records import AxisJoint

SUFFIXES = (".xml", ".mjcf")
"""Suffixes of the file."""

LINKS = 20
"""Default number of pieces of a rod."""

INTERVALS = 40
"""Number of intervals of the grid for the unloaded shape of a rod."""

TWIST_AND_SHEAR = frozenset({2, 3, 4})
"""Indices of torsion and shears, which make a channel longer than its volume over its area."""

STIFF = 1e3
"""Stiffness of a drive, or of a cable of given length, over the stiffness of its rod."""

CARRIAGE = 1e-2
"""Mass of the carriages that close loops, over the mass of rods and bodies: a lighter one makes the weld softer."""

LEAST = 1e-9
"""Least mass, over the mass of all rods; least moments of inertia, over this mass and the square of the longest rod."""

LEAST_MOVED = 2e-15
"""Least mass and moments of inertia of moving bodies, kg and kg m²: MuJoCo refuses half of this."""

STEP = 1e-3
"""Time step, s, too long for explicit steps with stiff springs: the integrator ``discrete`` is implicit in springs."""

CLOSING_TIME = 2 * STEP
"""Time constant of constraints, s: the smallest one accepted by MuJoCo."""

HARD = "0.9999 0.9999 0.001 0.5 2"
"""Impedance of constraints: the largest one accepted by MuJoCo."""

NO_STOP = 1e6
"""Coordinate of the stop on a side without one, rad or m."""

MOST_OBSTACLES = 31
"""Largest number of obstacles that MuJoCo can distinguish, by bits."""


@dataclass(frozen=True)
class Mjcf:
    """A model of MuJoCo.

    Attributes:
        text: text of the XML file.
        left_out: a sentence for each object of the scene that is missing in the model or differs.
    """

    text: str
    left_out: tuple[str, ...]

    def write(self, path: str | Path) -> None:
        """Write the file atomically.

        Raises:
            ExportError: the name does not end in one of SUFFIXES.
            SceneError: the path is a folder, or its folder cannot be written to.
            WriteError: the file cannot be written.
        """
        check_mjcf(path)
        write_atomically(Path(path), self.text.encode())


def check_mjcf(path: str | Path) -> None:
    """Refuse a file that cannot be written, before the model is made.

    Raises:
        ExportError: the name does not end in one of SUFFIXES.
        SceneError: the path is a folder, or its folder cannot be written to.
    """
    if Path(path).suffix.lower() not in SUFFIXES:
        raise ExportError(Problem("--mjcf", f"{path} does not end in {' or '.join(SUFFIXES)}", "name the file so"))
    check_writable(Path(path), "--mjcf")


def mjcf_of(scene: scenes.Scene, links: int = LINKS) -> Mjcf:
    """A scene as a model of MuJoCo; with loops or supports the scene is solved for the initial state.

    Args:
        scene: a validated scene, with values for its parameters.
        links: approximate number of pieces of each rod; pieces end at disks, holes of tendons, joints and wrenches.

    Raises:
        SceneError: a rod has no mass, or the scene has tubes.
    """
    refuse_tubes(scene)
    return _Robot(scene.baked(), links).written()


def _numbers(values: Sequence[float] | FloatArray | float) -> str:
    """Numbers as the text of an attribute."""
    return " ".join(f"{value + 0.0:.12g}" for value in np.atleast_1d(np.asarray(values, dtype=float)))


def _place(pose: NumericPose) -> dict[str, str]:
    """Attributes of a pose."""
    return {"pos": _numbers(pose.position), "quat": _numbers(pose.quaternion)}


def _cylinder(radius: float, thickness: float) -> dict[str, str]:
    """Attributes of a disk, with a thickness above zero."""
    return {"type": "cylinder", "size": _numbers([radius, max(thickness, 1e-3 * radius) / 2])}


def _solved(poses: SolvedPoses) -> NumericPose:
    """Pose of a section or a body in an equilibrium, world axes."""
    return NumericPose(poses.position, poses.quaternion / np.linalg.norm(poses.quaternion))


def _turned(position: FloatArray) -> NumericPose:
    """A pose without rotation."""
    return NumericPose(position, IDENTITY.quaternion)


@dataclass(frozen=True)
class _Carrier:
    """A parent element: the world, a link or a body.

    Attributes:
        element: XML element.
        frame: pose in the unloaded scene, world axes.
        name: name of its body in MuJoCo.
    """

    element: ET.Element
    frame: NumericPose
    name: str


@dataclass(frozen=True)
class _Moved:
    """A body of MuJoCo with joints.

    Attributes:
        carrier: name of its parent.
        place: pose relative to the parent at zero coordinates.
        joints: joints in their order.
        near: initial guess of the coordinates, shape (n,), rad and m.
    """

    carrier: str
    place: NumericPose
    joints: Sequence[MjcfJoint]
    near: FloatArray


@dataclass
class _Robot:
    """A model under construction."""

    scene: scenes.Scene
    links: int
    left_out: list[str] = field(default_factory=list)
    controls: list[float] = field(default_factory=list)
    rods: dict[str, list[Link]] = field(default_factory=dict)
    carriers: dict[tuple[str, float], _Carrier] = field(default_factory=dict)
    bodies: dict[str, _Carrier] = field(default_factory=dict)
    used: set[int] = field(default_factory=set)
    driven: dict[str, float] = field(default_factory=dict)
    light: dict[str, float] = field(default_factory=dict)
    moved: dict[str, _Moved] = field(default_factory=dict)
    begins: dict[str, Callable[[Solution], NumericPose]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.root = ET.Element("mujoco", model=self.scene.title or "scene")
        ET.SubElement(self.root, "compiler", angle="radian", autolimits="true")
        self.option = ET.SubElement(self.root, "option", integrator="discrete", timestep=_numbers(STEP))
        world = ET.SubElement(self.root, "worldbody")
        ET.SubElement(world, "light", pos="0 0 3", dir="0 0 -1")
        ET.SubElement(world, "site", name="world", group="4")
        self.world = _Carrier(world, IDENTITY, "world")
        self.tendons = ET.SubElement(self.root, "tendon")
        self.equalities = ET.SubElement(self.root, "equality")
        self.actuators = ET.SubElement(self.root, "actuator")
        self.unloaded = self._unloaded()

    def _unloaded(self) -> UnloadedScene:
        """The unloaded scene, with elements that end at the ends of links."""
        discrete = {}
        for rod in self.scene.rods:
            ends = element_ends(self.scene, rod.name)
            grid = Discretisation((1,) * len(rod.admitted), max(6, INTERVALS // len(ends)), ends)
            discrete[rod.name] = DiscreteRod(rod_properties(rod), grid)
        return UnloadedScene(self.scene, discrete)

    def written(self) -> Mjcf:
        """The whole model."""
        for rod in self.scene.rods:
            nodes = nodes_along(self.unloaded.rods[rod.name].grid.known_places, self.links)
            self.rods[rod.name] = links_of(self.unloaded, rod, nodes)
        self._put_gravity()
        self._put_tree()
        for index, joint in enumerate(self.scene.joints):
            if index not in self.used:
                self._close(joint, index)
        for index, support in enumerate(self.scene.supports):
            self._hold(support, index)
        self._put_obstacles()
        for record in self.scene.causes:
            writer = WRITERS.get(record.kind)
            if writer is None:
                self._leave_out(record.name, f"MuJoCo has no {record.kind.replace('_', ' ')}")
            else:
                writer(self, record)
        self._tell_the_rest()
        for equality in self.equalities:
            equality.set("solref", _numbers([CLOSING_TIME, 1.0]))
            equality.set("solimp", HARD)
        key = {"name": "scene", "ctrl": _numbers(self.controls)}
        if len(self.equalities):
            key |= self._begin()
        ET.SubElement(ET.SubElement(self.root, "keyframe"), "key", key)
        self.root.insert(0, ET.Comment(_comment(self.left_out)))
        ET.indent(self.root)
        return Mjcf(ET.tostring(self.root, encoding="unicode") + "\n", tuple(self.left_out))

    def _begin(self) -> dict[str, str]:
        """Attributes of the keyframe for a model with loops: the equilibrium of the scene."""
        solution = solve(self.scene)
        assert isinstance(solution, Solution), "tubes are refused before"
        if not solution.converged:
            self._leave_out("start", "no equilibrium was found: the model begins unloaded, and its loops may be open")
            return {}
        poses = {name: begin(solution) for name, begin in self.begins.items()}
        poses["world"] = IDENTITY
        coordinates = []
        for element in self.root.iter("body"):
            name = element.get("name", "")
            moved = self.moved.get(name)
            if moved is not None:
                wanted = poses[moved.carrier].inverse.then(poses[name])
                coordinates.append(coordinates_at(moved.place, moved.joints, wanted, self.size, moved.near))
        return {"qpos": _numbers(np.concatenate(coordinates))}

    def _leave_out(self, name: str | None, reason: str) -> None:
        self.left_out.append(f"{name}: {reason}.")

    # The tree of rods and bodies

    def _put_tree(self) -> None:
        """Add rods and bodies to the tree, parents first."""
        rods = list(self.scene.rods)
        bodies = list(self.scene.bodies)
        while rods or bodies:
            before = len(rods) + len(bodies)
            rods = [rod for rod in rods if not self._put_rod(rod)]
            bodies = [body for body in bodies if not self._put_body(body)]
            if len(rods) + len(bodies) == before:
                # Rods that start on a body without other holders: the body is floating.
                body = bodies.pop(0)
                frame = self.unloaded.body_frame(body.name).start
                self._body(self.world, frame, body, (("freejoint", {}),))

    def _carried(self, rod: scenes.Rod) -> tuple[_Carrier | None, int | None]:
        """Parent of the base of a rod, None if it is not in the tree yet, and the pose of the joint between them."""
        for index, joint in enumerate(self.scene.joints):
            if joint.rod == rod.name and joint.holds_base:
                if joint.body is not None:
                    return self.bodies.get(joint.body), index
                return self._base_carrier(rod), index
        return self._base_carrier(rod), None

    def _base_carrier(self, rod: scenes.Rod) -> _Carrier | None:
        if rod.base.rod is None:
            return self.world
        return self._link(rod.base.rod, rod.base.at) if (rod.base.rod, 0.0) in self.carriers else None

    def _put_rod(self, rod: scenes.Rod) -> bool:
        """Add the links of a rod to its parent; returns whether the parent is in the tree."""
        carrier, index = self._carried(rod)
        if carrier is None:
            return False
        for number, link in enumerate(self.rods[rod.name]):
            joints: Sequence[MjcfJoint] = ()
            if number:
                joints = list(self._strains(rod, link, number))
            elif rod.base.free:
                joints = [("freejoint", {})]
            elif index is not None:
                joints = self._tree_joint(index, link.frame, link.frame.position, carrier.frame, 1.0)
            carrier = self._put_link(carrier, rod, link, number, joints)
            self.carriers[rod.name, link.at] = carrier
        self._site(carrier, f"{rod.name}/tip", carrier.frame)
        return True

    def _strains(self, rod: scenes.Rod, link: Link, number: int) -> Iterator[MjcfJoint]:
        """Joints for the strains of a piece, in the axes of the next link."""
        piece = link.piece
        assert piece is not None, "a link after the first"
        middle = link.frame.inverse.then(piece.middle)
        # Slides before hinges; reversed in every other piece.
        order = sorted(rod.admitted, key=lambda strain: (strain < 3, strain), reverse=bool(number % 2))
        for strain in order:
            attributes = {
                "name": f"{rod.name}/{number}/{STRAINS[strain]}",
                "type": "hinge" if strain < 3 else "slide",
                "pos": _numbers(middle.position),
                "axis": _numbers(middle.rotation[:, strain % 3]),
                "stiffness": _numbers(piece.stiffness[strain]),
            }
            if piece.damping[strain]:
                attributes["damping"] = _numbers(piece.damping[strain])
            yield "joint", attributes

    def _put_link(
        self, carrier: _Carrier, rod: scenes.Rod, link: Link, number: int, joints: Sequence[MjcfJoint]
    ) -> _Carrier:
        name = f"{rod.name}/{number}"
        put = self._element(carrier, link.frame, name, link.inertia, joints)
        self.begins[name] = lambda solution: _solved(solution.pose(link.at, rod.name))
        if self.gravity is not None and not self.gravity.acts_on_rod(rod.name):
            put.element.set("gravcomp", "1")
        x, y = link.half_widths
        length = float(np.linalg.norm(link.ends[1] - link.ends[0]))
        if x == y:
            size = {"type": "capsule", "fromto": _numbers(link.ends.ravel()), "size": _numbers(x)}
        else:
            along = quaternion_from_tangent(link.ends[1] - link.ends[0])
            place = _place(NumericPose(link.ends.mean(axis=0), along))
            size = {"type": "box", "size": _numbers([x, y, length / 2]), **place}
        obstacles = self.scene.obstacles
        self._geom(put, size, "0 0.45 0.7 1", [obstacle.concerns(rod.name) for obstacle in obstacles])
        for row in self.scene.disks:
            if row.rod == rod.name and any(abs(at - link.at) < 1e-9 for at in row.places):
                size = _cylinder(row.radius, row.thickness)
                self._geom(put, size, ".5 .5 .5 .4", [obstacle.concerns_disks(row.name) for obstacle in obstacles])
        return put

    def _geom(self, carrier: _Carrier, shape: dict[str, str], colour: str, meets: Sequence[bool]) -> None:
        """Add a shape to a carrier; ``meets``: the obstacles that it can touch."""
        bits = sum(1 << i for i, is_met in enumerate(meets) if is_met)
        style = {"contype": str(bits), "conaffinity": "0", "rgba": colour}
        ET.SubElement(carrier.element, "geom", {**shape, **style})

    def _element(
        self,
        carrier: _Carrier,
        frame: NumericPose,
        name: str,
        inertia: Inertia,
        joints: Sequence[MjcfJoint],
        in_carrier: NumericPose | None = None,
    ) -> _Carrier:
        """Add a body of MuJoCo to a carrier, at its frame, or at another pose in the carrier."""
        on_carrier = in_carrier or carrier.frame.inverse.then(frame)
        element = ET.SubElement(carrier.element, "body", {"name": name, **_place(on_carrier)})
        for tag, attributes in joints:
            ET.SubElement(element, tag, attributes)
        if joints:
            near = np.array([self.driven.get(attributes.get("name", ""), 0.0) for _, attributes in joints])
            self.moved[name] = _Moved(carrier.name, on_carrier, joints, near)
        moments, axes = np.linalg.eigh(inertia.moments)
        axes[:, 2] *= np.sign(np.linalg.det(axes))
        least = max(LEAST * inertia.mass * self.size**2, LEAST_MOVED)
        if joints and moments[0] < least:
            self.light.setdefault(name.split("/")[0], least)
        moments = np.maximum(moments, max(least, LEAST * moments[2]))
        # For thin links the largest moment is the sum of the others up to rounding, and may not exceed it.
        moments[1] = max(moments[1], (1 + 1e-9) * moments[2] - moments[0])
        place = _place(NumericPose(inertia.centre, matrix_to_quaternion(axes)))
        ET.SubElement(element, "inertial", {**place, "mass": _numbers(inertia.mass), "diaginertia": _numbers(moments)})
        return _Carrier(element, frame, name)

    @property
    def size(self) -> float:
        """Length of the longest rod, m."""
        return max(rod.length for rod in self.scene.rods)

    @property
    def mass(self) -> float:
        """Mass of all rods, kg."""
        return sum(link.inertia.mass for links in self.rods.values() for link in links)

    def _put_body(self, body: scenes.Body) -> bool:
        """Add a body to the tree by its first joint with a known other end; returns whether there is one."""
        frame = self.unloaded.body_frame(body.name).start
        # Slides are preferred: as a loop closure a slide needs a carriage.
        for index, joint in sorted(enumerate(self.scene.joints), key=lambda numbered: numbered[1].kind != "prismatic"):
            if body.name not in [place.body for place in joint.places] or joint.holds_base:
                continue
            is_carried = joint.carries is not None and joint.carries.body == body.name
            place = place_of(joint.carries if joint.carries is not None and is_carried else joint)
            end = self._other_end(joint, body.name)
            if end is None:
                continue
            carrier, there = end
            sense, axes = (1.0, carrier.frame) if is_carried else (-1.0, frame)
            joints = self._tree_joint(index, frame, frame.then(place).position, axes, sense)
            # The unloaded scene may place the body elsewhere, by several joints; here this joint is closed.
            closed = there.then(place.inverse)
            if joint.kind == "spherical":
                closed = NumericPose(there.position - frame.rotation @ place.position, frame.quaternion)
            self._body(carrier, frame, body, joints, carrier.frame.inverse.then(closed))
            return True
        return False

    def _other_end(self, joint: Any, body: str) -> tuple[_Carrier, NumericPose] | None:
        """The carrier at the other end of a body's joint and the joint's pose there, world axes; None if missing."""
        if joint.carries is None:
            if (joint.rod, 0.0) not in self.carriers:
                return None
            link = self._link(joint.rod, joint.at)
            return link, link.frame
        other, place = (joint.body, joint) if joint.carries.body == body else (joint.carries.body, joint.carries)
        carrier = self.world if other is None else self.bodies.get(other)
        return None if carrier is None else (carrier, carrier.frame.then(place_of(place)))

    def _body(
        self,
        carrier: _Carrier,
        frame: NumericPose,
        body: scenes.Body,
        joints: Sequence[MjcfJoint],
        in_carrier: NumericPose | None = None,
    ) -> None:
        mass = max(body.mass, LEAST * self.mass, LEAST_MOVED)
        inertia = Inertia(mass, np.array(body.centre_of_mass), body.inertia_matrix)
        put = self._element(carrier, frame, body.name, inertia, joints, in_carrier)
        self.begins[body.name] = lambda solution: _solved(solution.body(body.name))
        if self.gravity is not None and not self.gravity.acts_on_body(body.name):
            put.element.set("gravcomp", "1")
        radius = body.radius or 0.02 * self.size
        shape = {"type": "sphere", "size": _numbers(radius)}
        if body.thickness is not None:
            shape = _cylinder(radius, body.thickness)
        meets = [obstacle.concerns_body(body.name) for obstacle in self.scene.obstacles]
        self._geom(put, shape, "0.5 0.5 0.5 1", meets)
        self.bodies[body.name] = put

    def _tree_joint(
        self, index: int, frame: NumericPose, place: FloatArray, axes: NumericPose, sense: float
    ) -> list[MjcfJoint]:
        """Joints of MuJoCo between a carrier and its child.

        Args:
            index: index of the joint in the scene.
            frame: frame of the child, world axes.
            place: position of the joint, world axes, shape (3,), m.
            axes: axes of the joint, world axes.
            sense: 1 if the section is the child of its holder, −1 if the holder is the child.
        """
        joint: Any = self.scene.joints[index]
        self.used.add(index)
        if joint.kind == "fixed":
            return []
        name = joint.name or f"joint/{index}"
        attributes = {"name": name, "pos": _numbers(frame.inverse.then(_turned(place)).position)}
        if joint.kind == "spherical":
            return [("joint", {**attributes, "type": "ball"})]
        if not isinstance(joint, AxisJoint):
            self._leave_out(name, f"MuJoCo has no {joint.kind} joint: what it holds is fixed")
            return []
        axis = sense * frame.rotation.T @ axes.rotation @ np.array(joint.axis, dtype=float)
        attributes |= {"type": "hinge" if joint.kind == "revolute" else "slide", "axis": _numbers(axis)}
        efforts = {
            "stiffness": joint.stiffness,
            "springref": joint.rest,
            "damping": joint.damping,
            "frictionloss": joint.friction,
        }
        attributes |= {key: _numbers(value) for key, value in efforts.items() if value}
        if joint.has_stops:
            lower = -NO_STOP if joint.lower_stop is None else joint.lower_stop
            upper = NO_STOP if joint.upper_stop is None else joint.upper_stop
            attributes["range"] = _numbers([lower, upper])
            self._leave_out(name, "its stops are as soft as constraints of MuJoCo, and without restitution")
        effort = getattr(joint, joint.effort_key)
        if effort is not None:
            self._control(f"{name}.{joint.effort_key}", effort, "motor", joint=name)
        if joint.prescribed:
            self.driven[name] = float(getattr(joint, joint.coordinate_key))
            energy, length = self.unloaded.units([joint.rod] if joint.rod else [])
            stiffness = STIFF * energy
            unit = "N m/rad"
            if joint.kind == "prismatic":
                stiffness /= length**2
                unit = "N/m"
            gains = {"kp": _numbers(stiffness), "dampratio": "1"}
            self._control(
                f"{name}.{joint.coordinate_key}", getattr(joint, joint.coordinate_key), "position", joint=name, **gains
            )
            self._leave_out(name, f"its drive is a servo of {stiffness:.3g} {unit}, not rigid")
        return [("joint", attributes)]

    def _link(self, rod: str, at: float) -> _Carrier:
        """The link nearest to a section of a rod in the tree."""
        nearest = min(self.rods[rod], key=lambda link: abs(link.at - at))
        return self.carriers[rod, nearest.at]

    def _site(self, carrier: _Carrier, name: str, pose: NumericPose) -> str:
        """Add a site to a carrier, at a pose in the unloaded scene; returns its name."""
        place = _place(carrier.frame.inverse.then(pose))
        ET.SubElement(carrier.element, "site", {"name": name, "group": "4", **place})
        return name

    # Loops

    def _close(self, joint: Any, index: int) -> None:
        """Add a joint that closes a loop, as constraints between sites."""
        name = joint.name or f"joint/{index}"
        if joint.carries is None:
            section = self._link(joint.rod, joint.at)
            held = section.frame
        else:
            section = self.bodies[joint.carries.body]
            held = section.frame.then(place_of(joint.carries))
        holder = self.bodies[joint.body] if joint.body else self.world
        place = holder.frame.then(place_of(joint))
        if joint.kind == "prismatic" or joint.has_coordinate:
            self._close_by_carriage(index, name, section, held, holder, place)
            return
        # In the unloaded scene the joint may be open: MuJoCo pulls both sites together.
        ends = [_turned(np.zeros(3))]
        if joint.kind == "revolute":
            axis = np.array(joint.axis, dtype=float) / np.linalg.norm(joint.axis)
            in_place = place_of(joint).rotation.T @ axis
            ends.append(_turned(0.1 * self.size * in_place))
        for number, end in enumerate(ends):
            first = self._site(section, f"{name}/section/{number}", held.then(end))
            second = self._site(holder, f"{name}/holder/{number}", place.then(end))
            kind = "weld" if joint.kind == "fixed" else "connect"
            ET.SubElement(self.equalities, kind, site1=second, site2=first)

    def _close_by_carriage(
        self, index: int, name: str, section: _Carrier, held: NumericPose, holder: _Carrier, place: NumericPose
    ) -> None:
        """Close a slide, or a hinge with an effort, by a carriage that is welded to the held section or body.

        MuJoCo has no constraint for sliding along an axis, and no springs or motors on constraints for rotation.

        Args:
            index: index of the joint in the scene.
            name: name of the joint.
            section: the link or the body held by the joint.
            held: pose of the joint on the section, world axes, unloaded.
            holder: the world or the holding body.
            place: pose of the joint on the holder, world axes, unloaded.
        """
        mass = CARRIAGE * (self.mass + sum(body.mass for body in self.scene.bodies))
        inertia = Inertia(mass, np.zeros(3), mass * (0.1 * self.size) ** 2 * np.eye(3))
        joints = self._tree_joint(index, place, place.position, holder.frame, 1.0)
        carriage = self._element(holder, place, f"{name}/carriage", inertia, joints)
        carriage.element.set("gravcomp", "1")
        first = self._site(carriage, f"{name}/holder", place)
        second = self._site(section, f"{name}/section", held)
        ET.SubElement(self.equalities, "weld", site1=first, site2=second)
        offset = section.frame.inverse.then(held)
        self.begins[carriage.name] = lambda solution: self.begins[section.name](solution).then(offset)
        self._leave_out(name, f"it closes a loop by a carriage of {mass:.1e} kg, without weight")

    def _hold(self, support: Any, index: int) -> None:
        """Add a support of a tip, as a constraint between sites."""
        kind = {"clamped": "weld", "pinned": "connect"}.get(support.kind)
        name = f"supports[{index}]"
        if kind is None:
            self._leave_out(name, f"MuJoCo has no {support.kind} support, and the tip is free")
            return
        first = self._site(self.world, f"{name}/place", place_of(support))
        ET.SubElement(self.equalities, kind, site1=first, site2=f"{support.rod}/tip")

    # Loads and actuators

    def _put_gravity(self) -> None:
        fields = [load for load in self.scene.loads if isinstance(load, scenes.Gravity)]
        total = np.sum([load.acceleration for load in fields if load == fields[0] or load.acts_on_all], axis=0)
        self.gravity = fields[0] if fields else None
        self.option.set("gravity", _numbers(total if fields else np.zeros(3)))
        for load in fields[1:]:
            if not (load.acts_on_all and fields[0].acts_on_all):
                self._leave_out(load.name, "MuJoCo has one field of gravity, and this is the second")

    def _control(self, name: str, value: float, kind: str, **attributes: str) -> None:
        """Add an actuator, and its value in the keyframe."""
        ET.SubElement(self.actuators, kind, {"name": name, **attributes})
        self.controls.append(float(value))

    def put_section_wrench(self, load: Any) -> None:
        """Add a force and a moment on a section."""
        carrier = self._link(load.rod, getattr(load, "at", 1.0))
        self._wrench(load, self._site(carrier, load.name, carrier.frame))

    def put_body_wrench(self, load: scenes.BodyWrench) -> None:
        """Add a force and a moment on a body."""
        carrier = self.bodies[load.body]
        at = carrier.frame.then(_turned(np.array(load.position, dtype=float)))
        self._wrench(load, self._site(carrier, load.name, at))

    def _wrench(self, load: Any, site: str) -> None:
        """Add a control for each component of the force and the moment of a load."""
        dead = {"refsite": "world"} if load.frame == "world" else {}
        for offset, key in ((0, "force"), (3, "moment")):
            if key not in load.model_fields_set:
                continue
            for component, value in enumerate(getattr(load, key)):
                gear = np.eye(6)[offset + component]
                self._control(
                    f"{load.name}.{key}.{'xyz'[component]}", value, "motor", site=site, gear=_numbers(gear), **dead
                )

    def put_tendon(self, tendon: scenes.Tendon) -> None:
        """Add a cable through sites, with given tension or length."""
        if tendon.friction:
            self._leave_out(tendon.name, "friction of a cable along its course is not in MuJoCo, and is missing")
        length = self._course(tendon)
        if tendon.length is None:
            assert tendon.tension is not None, "one of the two is given"
            self._control(f"{tendon.name}.tension", tendon.tension, "motor", tendon=tendon.name, gear="-1")
            return
        softness = 0.0
        if tendon.axial_stiffness is not None:
            softness += tendon.length / tendon.axial_stiffness
        if tendon.winch_stiffness is not None:
            softness += 1 / tendon.winch_stiffness
        if softness:
            stiffness = 1 / softness
        else:
            arm = max(float(np.abs(self._offsets(tendon, np.linspace(*tendon.span, 9))).max()), 1e-3 * length)
            properties = self.unloaded.rods[tendon.rod].properties
            stiffness = STIFF * properties.bending_stiffness / (arm**2 * properties.length)
            self._leave_out(tendon.name, f"the cable of given length is one of {stiffness:.3g} N/m, not rigid")
        pulls_only = {"forcerange": "-1e9 0"} if tendon.slack else {}
        wanted = tendon.length - tendon.pretension / stiffness
        kp = {"kp": _numbers(stiffness)}
        self._control(f"{tendon.name}.length", wanted, "position", tendon=tendon.name, **kp, **pulls_only)

    def put_chamber(self, chamber: scenes.Chamber) -> None:
        """Add a pressure, which pushes the ends of its channel apart."""
        if chamber.wall is not None or chamber.area_growth or chamber.offset_growth:
            self._leave_out(chamber.name, "the chamber does not widen under its pressure in MuJoCo")
        if not TWIST_AND_SHEAR.isdisjoint(self.unloaded.rods[chamber.rod].properties.admitted):
            told = "in MuJoCo the pressure works on its length, not its volume: different where sections twist or shear"
            self._leave_out(chamber.name, told)
        area = chamber.area
        if area is None:
            assert chamber.wall is not None, "the record's rules ask for area or wall"
            area = np.pi * chamber.wall.inner_radius**2
        self._course(chamber)
        gear = _numbers(area)
        self._control(f"{chamber.name}.pressure", chamber.pressure, "motor", tendon=chamber.name, gear=gear)

    def _offsets(self, actuator: Any, X: FloatArray) -> FloatArray:
        """Offsets of a routing in the sections, shape (k, 2), m."""
        return known(offset_at(actuator, X)[0]).T

    def _places(self, actuator: Any) -> FloatArray:
        """Abscissae of the sites of a routing: its holes; for a continuous one a quarter of each piece from its ends.

        A chord of length a across a joint of angle θ is shorter than the arc by a θ²/8; with sites at the nodes the
        difference would be twice as large.
        """
        through = holes(actuator)
        if through is not None:
            return np.array(through, dtype=float)
        start, end = actuator.span
        nodes = np.array([link.at for link in self.rods[actuator.rod] if start <= link.at <= end])
        quarters = nodes[:-1, None] + np.diff(nodes)[:, None] * np.array([0.25, 0.75])
        return np.array([start, *quarters.ravel(), end])

    def _course(self, actuator: Any) -> float:
        """Add the routing of a cable through the links of its span; returns its unloaded length, m."""
        X = self._places(actuator)
        spatial = ET.SubElement(self.tendons, "spatial", name=actuator.name, width=_numbers(2e-3 * self.size))
        points = []
        sections = poses_along(self.unloaded, actuator.rod, X)
        for number, (section, offset) in enumerate(zip(sections, self._offsets(actuator, X), strict=True)):
            pose = section.then(_turned(np.array([*offset, 0.0])))
            site = self._site(self._link(actuator.rod, X[number]), f"{actuator.name}/{number}", pose)
            ET.SubElement(spatial, "site", site=site)
            points.append(pose.position)
        return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())

    # Obstacles

    def _put_obstacles(self) -> None:
        for index, obstacle in enumerate(self.scene.obstacles):
            shape = SURFACES[obstacle.kind].primitive(obstacle, self.size)
            if not shape or index >= MOST_OBSTACLES:
                self._leave_out(obstacle.name, "MuJoCo has no such obstacle, and it is missing")
                continue
            carrier = self.world if obstacle.body is None else self.bodies[obstacle.body]
            along, back, across = obstacle.coefficients
            friction = max(along, back, across)
            if not along == back == across:
                self._leave_out(obstacle.name, f"friction is {friction:g} in all directions in MuJoCo")
            if obstacle.restitution:
                self._leave_out(obstacle.name, "restitution is not in MuJoCo, and is missing")
            attributes = {
                "name": obstacle.name,
                "contype": "0",
                "conaffinity": str(1 << index),
                "condim": "3" if friction else "1",
                "priority": "1",
                "friction": _numbers([friction, 0.005, 0.0001]),
                "rgba": "0.63 0.55 0.36 1",
            }
            numbered = {key: value if key == "type" else _numbers(value) for key, value in shape.items()}
            ET.SubElement(carrier.element, "geom", {**attributes, **numbered})

    def _tell_the_rest(self) -> None:
        """Add sentences on properties of rods and inputs that are not in the model."""
        scene = self.scene
        lost = {record.name for record in scene.causes if record.kind not in WRITERS}
        for rod in scene.rods:
            properties = self.unloaded.rods[rod.name].properties
            if properties.beyond_hooke is not None:
                told = (
                    "joints have only the stiffness of each small strain: the rest of the law, and its coupling, is "
                    "missing"
                )
                self._leave_out(rod.name, told)
            if properties.branches:
                self._leave_out(rod.name, "stress that relaxes is missing")
            if properties.mass_damping is not None:
                self._leave_out(rod.name, "damping in proportion to mass is missing")
        for name, least in self.light.items():
            self._leave_out(name, f"has moments of inertia of {least:.1e} kg m² or more: MuJoCo moves nothing without")
        if scene.velocities:
            self._leave_out("velocities", "the model begins at rest")
        for name in dict.fromkeys(motion.input for motion in scene.motions):
            self._leave_out(name, "its motion is not in the model: set the control over time")
        controls = [actuator.get("name", "") for actuator in self.actuators]
        for entry in scene.free_inputs():
            if isinstance(entry.record, scenes.Gravity) or entry.owner in lost:
                continue
            if not any(control == entry.name or control.startswith(f"{entry.name}.") for control in controls):
                self._leave_out(entry.name, "the input has no control, and keeps its value")
        if scene.obstacles:
            self._leave_out("obstacles", "contacts are soft in MuJoCo, and those of the scene are not its contacts")
        for contact in scene.rod_contacts:
            self._leave_out(contact.label, "rods pass through each other")


def _comment(left_out: Sequence[str]) -> str:
    lines = ["Written by cosserat_casadi. The keyframe 'scene' has the inputs of the scene as controls."]
    if left_out:
        lines += ["Parts in which the model differs from the scene:", *left_out]
    # XML comments may not contain two hyphens.
    return "\n".join(["", *(f"  {line}" for line in lines), ""]).replace("--", "−−")


WRITERS: dict[str, Callable[[_Robot, Any], None]] = {
    "gravity": lambda robot, load: None,
    "tip_wrench": _Robot.put_section_wrench,
    "point_wrench": _Robot.put_section_wrench,
    "body_wrench": _Robot.put_body_wrench,
    "tendon": _Robot.put_tendon,
    "chamber": _Robot.put_chamber,
}
"""Writers of loads and actuators by kind; kinds without an entry get a sentence in ``left_out``."""
