"""The scene file: records, rules, reading, writing.

A new kind is a record that derives from its family's record, and a class of the mechanics that names this record.
`cosserat_casadi.model.registry.register` makes both known.
"""

from cosserat_casadi.scene.accuracy import Accuracy, RodDiscretisation
from cosserat_casadi.scene.actuator_records import ACTUATORS, Actuator, ActuatorRecord, Chamber, Helix, Muscle, Tendon
from cosserat_casadi.scene.constraint_records import (
    JOINTS,
    SUPPORTS,
    Body,
    CarriedBody,
    ClampedSupport,
    FixedJoint,
    Joint,
    JointRecord,
    PinnedSupport,
    PrismaticJoint,
    RevoluteJoint,
    SphericalJoint,
    Support,
    SupportRecord,
)
from cosserat_casadi.scene.disk_record import Disks
from cosserat_casadi.scene.families import Family
from cosserat_casadi.scene.flow_record import Flow
from cosserat_casadi.scene.foundation_record import Foundation
from cosserat_casadi.scene.input_fields import InputField
from cosserat_casadi.scene.input_range_records import Pairs
from cosserat_casadi.scene.load_kinds import Load
from cosserat_casadi.scene.load_records import (
    LOADS,
    BodyWrench,
    DistributedWrench,
    Gravity,
    LoadRecord,
    PointWrench,
    TipWrench,
)
from cosserat_casadi.scene.magnet_record import Dipole, Magnet
from cosserat_casadi.scene.material_records import MATERIALS, LinearMaterial, Material
from cosserat_casadi.scene.measurement_record import MEASUREMENTS, InputColumn, MeasurementRecord
from cosserat_casadi.scene.measurements import Measurement
from cosserat_casadi.scene.motion_records import InputMotion
from cosserat_casadi.scene.obstacle_records import OBSTACLES, Capsule, Lumen, Obstacle, ObstacleRecord, Plane, Sphere
from cosserat_casadi.scene.parameter_records import NamedNumbers
from cosserat_casadi.scene.reading import parse_scene, read_scene, scene_from_dict, with_exact_contact
from cosserat_casadi.scene.rod_contact_record import RodContact
from cosserat_casadi.scene.rod_records import (
    Annulus,
    Base,
    Circle,
    Damping,
    Intrinsic,
    Rectangle,
    Rod,
    Section,
    Stiffness,
)
from cosserat_casadi.scene.scene import FreeInput, Scene
from cosserat_casadi.scene.simulation import Simulation
from cosserat_casadi.scene.target_records import Bound, CurveTarget, PoseTarget, PositionTarget, Target
from cosserat_casadi.scene.tube_records import Tube, TubeSection, TubeStiffness
from cosserat_casadi.scene.unknown_records import IdentificationSettings, Prior, Unknown

__all__ = [
    "ACTUATORS",
    "JOINTS",
    "LOADS",
    "MATERIALS",
    "MEASUREMENTS",
    "OBSTACLES",
    "SUPPORTS",
    "Accuracy",
    "Actuator",
    "ActuatorRecord",
    "Annulus",
    "Base",
    "Body",
    "BodyWrench",
    "Bound",
    "Capsule",
    "CarriedBody",
    "Chamber",
    "Circle",
    "ClampedSupport",
    "CurveTarget",
    "Damping",
    "Dipole",
    "Disks",
    "DistributedWrench",
    "Family",
    "FixedJoint",
    "Flow",
    "Foundation",
    "FreeInput",
    "Gravity",
    "Helix",
    "IdentificationSettings",
    "InputColumn",
    "InputField",
    "InputMotion",
    "Intrinsic",
    "Joint",
    "JointRecord",
    "LinearMaterial",
    "Load",
    "LoadRecord",
    "Lumen",
    "Magnet",
    "Material",
    "Measurement",
    "MeasurementRecord",
    "Muscle",
    "NamedNumbers",
    "Obstacle",
    "ObstacleRecord",
    "Pairs",
    "PinnedSupport",
    "Plane",
    "PointWrench",
    "PoseTarget",
    "PositionTarget",
    "Prior",
    "PrismaticJoint",
    "Rectangle",
    "RevoluteJoint",
    "Rod",
    "RodContact",
    "RodDiscretisation",
    "Scene",
    "Section",
    "Simulation",
    "Sphere",
    "SphericalJoint",
    "Stiffness",
    "Support",
    "SupportRecord",
    "Target",
    "Tendon",
    "TipWrench",
    "Tube",
    "TubeSection",
    "TubeStiffness",
    "Unknown",
    "parse_scene",
    "read_scene",
    "scene_from_dict",
    "with_exact_contact",
]
