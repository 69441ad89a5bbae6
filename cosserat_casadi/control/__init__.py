"""Inverse problems and optimal control, with the equations of statics or of motion as constraints."""

from cosserat_casadi.control.condensing import Condensed, Condensing, Horizon
from cosserat_casadi.control.embedding import Lifted, embedded, lifted
from cosserat_casadi.control.inverse_accuracy import inverse
from cosserat_casadi.control.inverse_result import Inverse
from cosserat_casadi.control.judgement import judged
from cosserat_casadi.control.margin import stability_margin
from cosserat_casadi.control.targets import TargetMiss
from cosserat_casadi.control.tightening import Tightened, tightened
from cosserat_casadi.equilibrium.contact.relaxed_contact import RelaxedContact, relaxed_contact
from cosserat_casadi.motion.collocated_stage import MotionStage, StageEquations, motion_stage
from cosserat_casadi.numerics.collocation import Collocation, gauss, radau

__all__ = [
    "Collocation",
    "Condensed",
    "Condensing",
    "Horizon",
    "Inverse",
    "Lifted",
    "MotionStage",
    "RelaxedContact",
    "StageEquations",
    "TargetMiss",
    "Tightened",
    "embedded",
    "gauss",
    "inverse",
    "judged",
    "lifted",
    "motion_stage",
    "radau",
    "relaxed_contact",
    "stability_margin",
    "tightened",
]
