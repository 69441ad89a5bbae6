"""Cosserat rods as CasADi models: a scene enters as text and flows, stage by stage, to a solved rod.

scene.toml ─ read_scene ─▶ Scene ─ build ─▶ Model {named casadi.Functions} ─ solve ─▶ Solution
Scene ─ solve_scene ─▶ Solution on the cheapest discretisation within tolerance
Scene ─ simulate_scene ─▶ Motion within tolerance in space and time
"""

from importlib.metadata import version

from cosserat_casadi.accuracy.choose import Choice, choose
from cosserat_casadi.accuracy.refine import solve_scene
from cosserat_casadi.accuracy.tune import Tuning, tune
from cosserat_casadi.codegen.acados import acados_expressions, write_acados
from cosserat_casadi.codegen.compiled import Compiled
from cosserat_casadi.codegen.compiled_motion import (
    CompiledStep,
    LinearMotion,
    StepMemory,
    StepOptions,
    StepSensitivity,
    StepState,
)
from cosserat_casadi.codegen.contact.compiled import CompiledContact, CompiledContactSolution
from cosserat_casadi.codegen.export import export
from cosserat_casadi.codegen.fmu import write_fmu
from cosserat_casadi.codegen.load import load
from cosserat_casadi.codegen.motion_stage import CompiledMotionStage, compiled_motion_stage
from cosserat_casadi.codegen.motion_status import MotionStatus
from cosserat_casadi.codegen.stage import compiled_stage
from cosserat_casadi.codegen.tubes.compiled import CompiledTubes, CompiledTubesSolution
from cosserat_casadi.control import Inverse, inverse, inverse_scene
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.equilibrium.solve import solve
from cosserat_casadi.errors import CosseratError, ExportError, Problem, SceneError, SolveError
from cosserat_casadi.identification import Identification, identify, identify_scene
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.discretise import discretise
from cosserat_casadi.motion.linear_model import LinearModel, linearise
from cosserat_casadi.motion.modes import Mode, Modes, modes_of, modes_of_scene
from cosserat_casadi.motion.resolve import simulate_scene
from cosserat_casadi.motion.simulate import simulate
from cosserat_casadi.motion.trajectory import Motion, MotionOutcome
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.numerics.trace import PathOutcome
from cosserat_casadi.page.page import export_page
from cosserat_casadi.paths.equilibrium_path import EquilibriumPath, PathEvent
from cosserat_casadi.paths.follow import follow_path
from cosserat_casadi.paths.refine import follow_scene_path
from cosserat_casadi.results.identification_file import identification_result
from cosserat_casadi.results.inverse_file import inverse_result
from cosserat_casadi.results.modes_file import modes_result
from cosserat_casadi.results.motion_file import motion_result, write_motion
from cosserat_casadi.results.path_file import path_result
from cosserat_casadi.results.solution_file import result, write_result
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.scene import Scene, parse_scene, read_scene, scene_from_dict, with_exact_contact
from cosserat_casadi.sweep import SobolIndices, Sweep, read_sweep, sobol_indices, sobol_table, sweep_scene
from cosserat_casadi.tubes.equilibria import TubeEquilibria, all_equilibria
from cosserat_casadi.tubes.model import TubeModel
from cosserat_casadi.tubes.path import TubeEvent, TubePath
from cosserat_casadi.tubes.solution import TubeSolution

__version__ = version("cosserat-casadi")

__all__ = [
    "Choice",
    "Compiled",
    "CompiledContact",
    "CompiledContactSolution",
    "CompiledMotionStage",
    "CompiledStep",
    "CompiledTubes",
    "CompiledTubesSolution",
    "CosseratError",
    "Discretisation",
    "EquilibriumPath",
    "ExportError",
    "Identification",
    "Inverse",
    "LinearModel",
    "LinearMotion",
    "Mode",
    "Model",
    "Modes",
    "Motion",
    "MotionOutcome",
    "MotionStatus",
    "Outcome",
    "PathEvent",
    "PathOutcome",
    "Problem",
    "Scene",
    "SceneError",
    "SobolIndices",
    "Solution",
    "SolveError",
    "StepMemory",
    "StepOptions",
    "StepSensitivity",
    "StepState",
    "Sweep",
    "TubeEquilibria",
    "TubeEvent",
    "TubeModel",
    "TubePath",
    "TubeSolution",
    "Tuning",
    "acados_expressions",
    "all_equilibria",
    "build",
    "choose",
    "compiled_motion_stage",
    "compiled_stage",
    "discretise",
    "export",
    "export_page",
    "follow_path",
    "follow_scene_path",
    "identification_result",
    "identify",
    "identify_scene",
    "inverse",
    "inverse_result",
    "inverse_scene",
    "linearise",
    "load",
    "modes_of",
    "modes_of_scene",
    "modes_result",
    "motion_result",
    "parse_scene",
    "path_result",
    "read_scene",
    "read_sweep",
    "result",
    "scene_from_dict",
    "simulate",
    "simulate_scene",
    "sobol_indices",
    "sobol_table",
    "solve",
    "solve_scene",
    "sweep_scene",
    "tune",
    "with_exact_contact",
    "write_acados",
    "write_fmu",
    "write_motion",
    "write_result",
]
