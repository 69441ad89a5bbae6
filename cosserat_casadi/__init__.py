"""Cosserat rods as CasADi models: a scene enters as text and flows, stage by stage, to a solved rod.

scene.toml ─ read_scene ─▶ Scene ─ build ─▶ Model {named casadi.Functions} ─ solve ─▶ Solution
Scene ─ solve_scene ─▶ Solution on the cheapest discretisation within tolerance
Scene ─ simulate_scene ─▶ Motion within tolerance in space and time

A public name loads its module when it is first used, so that ``import cosserat_casadi`` itself takes no time.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

# Type checkers and editors read these lines, the interpreter the table below; a test compares the two.
if TYPE_CHECKING:
    from cosserat_casadi.accuracy.choose import Choice as Choice
    from cosserat_casadi.accuracy.choose import choose as choose
    from cosserat_casadi.accuracy.refine import solve_scene as solve_scene
    from cosserat_casadi.codegen.acados import acados_expressions as acados_expressions
    from cosserat_casadi.codegen.acados import write_acados as write_acados
    from cosserat_casadi.codegen.compiled import Compiled as Compiled
    from cosserat_casadi.codegen.compiled_motion import CompiledStep as CompiledStep
    from cosserat_casadi.codegen.compiled_motion import LinearMotion as LinearMotion
    from cosserat_casadi.codegen.compiled_motion import StepMemory as StepMemory
    from cosserat_casadi.codegen.compiled_motion import StepOptions as StepOptions
    from cosserat_casadi.codegen.compiled_motion import StepSensitivity as StepSensitivity
    from cosserat_casadi.codegen.compiled_motion import StepState as StepState
    from cosserat_casadi.codegen.contact.compiled import CompiledContact as CompiledContact
    from cosserat_casadi.codegen.contact.compiled import CompiledContactSolution as CompiledContactSolution
    from cosserat_casadi.codegen.export import export as export
    from cosserat_casadi.codegen.fmu import write_fmu as write_fmu
    from cosserat_casadi.codegen.load import load as load
    from cosserat_casadi.codegen.motion_stage import CompiledMotionStage as CompiledMotionStage
    from cosserat_casadi.codegen.motion_stage import compiled_motion_stage as compiled_motion_stage
    from cosserat_casadi.codegen.motion_status import MotionStatus as MotionStatus
    from cosserat_casadi.codegen.stage import compiled_stage as compiled_stage
    from cosserat_casadi.codegen.tubes.compiled import CompiledTubes as CompiledTubes
    from cosserat_casadi.codegen.tubes.compiled import CompiledTubesSolution as CompiledTubesSolution
    from cosserat_casadi.control.inverse import inverse as inverse
    from cosserat_casadi.control.inverse_accuracy import inverse_scene as inverse_scene
    from cosserat_casadi.control.inverse_result import Inverse as Inverse
    from cosserat_casadi.equilibrium.solution import Solution as Solution
    from cosserat_casadi.equilibrium.solve import solve as solve
    from cosserat_casadi.errors import CosseratError as CosseratError
    from cosserat_casadi.errors import ExportError as ExportError
    from cosserat_casadi.errors import Problem as Problem
    from cosserat_casadi.errors import SceneError as SceneError
    from cosserat_casadi.errors import SolveError as SolveError
    from cosserat_casadi.identification.identification_result import Identification as Identification
    from cosserat_casadi.identification.model_identification import identify as identify
    from cosserat_casadi.identification.model_identification import identify_scene as identify_scene
    from cosserat_casadi.model.build import Model as Model
    from cosserat_casadi.model.build import build as build
    from cosserat_casadi.model.discretise import discretise as discretise
    from cosserat_casadi.motion.linear_model import LinearModel as LinearModel
    from cosserat_casadi.motion.linear_model import linearise as linearise
    from cosserat_casadi.motion.motion_refinement import simulate_scene as simulate_scene
    from cosserat_casadi.motion.simulate import simulate as simulate
    from cosserat_casadi.motion.trajectory import Motion as Motion
    from cosserat_casadi.motion.trajectory import MotionOutcome as MotionOutcome
    from cosserat_casadi.motion.vibration_modes import Mode as Mode
    from cosserat_casadi.motion.vibration_modes import Modes as Modes
    from cosserat_casadi.motion.vibration_modes import modes_of as modes_of
    from cosserat_casadi.motion.vibration_modes import modes_of_scene as modes_of_scene
    from cosserat_casadi.numerics.outcome import Outcome as Outcome
    from cosserat_casadi.numerics.trace import PathOutcome as PathOutcome
    from cosserat_casadi.page.page import export_page as export_page
    from cosserat_casadi.paths.equilibrium_path import EquilibriumPath as EquilibriumPath
    from cosserat_casadi.paths.equilibrium_path import PathEvent as PathEvent
    from cosserat_casadi.paths.follow import follow_path as follow_path
    from cosserat_casadi.paths.path_refinement import follow_scene_path as follow_scene_path
    from cosserat_casadi.results.identification_file import identification_result as identification_result
    from cosserat_casadi.results.inverse_file import inverse_result as inverse_result
    from cosserat_casadi.results.modes_file import modes_result as modes_result
    from cosserat_casadi.results.motion_file import motion_result as motion_result
    from cosserat_casadi.results.motion_file import write_motion as write_motion
    from cosserat_casadi.results.path_file import path_result as path_result
    from cosserat_casadi.results.solution_file import result as result
    from cosserat_casadi.results.solution_file import write_result as write_result
    from cosserat_casadi.rod.discretisation import Discretisation as Discretisation
    from cosserat_casadi.scene import Scene as Scene
    from cosserat_casadi.scene import parse_scene as parse_scene
    from cosserat_casadi.scene import read_scene as read_scene
    from cosserat_casadi.scene import scene_from_dict as scene_from_dict
    from cosserat_casadi.scene import with_exact_contact as with_exact_contact
    from cosserat_casadi.sweep.outcome_file import read_sweep as read_sweep
    from cosserat_casadi.sweep.outcome_table import Sweep as Sweep
    from cosserat_casadi.sweep.run import sweep_scene as sweep_scene
    from cosserat_casadi.sweep.sobol import SobolIndices as SobolIndices
    from cosserat_casadi.sweep.sobol import sobol_indices as sobol_indices
    from cosserat_casadi.sweep.table import sobol_table as sobol_table
    from cosserat_casadi.tubes.tube_equilibria import TubeEquilibria as TubeEquilibria
    from cosserat_casadi.tubes.tube_equilibria import all_equilibria as all_equilibria
    from cosserat_casadi.tubes.tube_model import TubeModel as TubeModel
    from cosserat_casadi.tubes.tube_path import TubeEvent as TubeEvent
    from cosserat_casadi.tubes.tube_path import TubePath as TubePath
    from cosserat_casadi.tubes.tube_solution import TubeSolution as TubeSolution

    __version__: str

_NAMES = {
    "accuracy.choose": ("Choice", "choose"),
    "accuracy.refine": ("solve_scene",),
    "codegen.acados": ("acados_expressions", "write_acados"),
    "codegen.compiled": ("Compiled",),
    "codegen.compiled_motion": (
        "CompiledStep",
        "LinearMotion",
        "StepMemory",
        "StepOptions",
        "StepSensitivity",
        "StepState",
    ),
    "codegen.contact.compiled": ("CompiledContact", "CompiledContactSolution"),
    "codegen.export": ("export",),
    "codegen.fmu": ("write_fmu",),
    "codegen.load": ("load",),
    "codegen.motion_stage": ("CompiledMotionStage", "compiled_motion_stage"),
    "codegen.motion_status": ("MotionStatus",),
    "codegen.stage": ("compiled_stage",),
    "codegen.tubes.compiled": ("CompiledTubes", "CompiledTubesSolution"),
    "control.inverse": ("inverse",),
    "control.inverse_accuracy": ("inverse_scene",),
    "control.inverse_result": ("Inverse",),
    "equilibrium.solution": ("Solution",),
    "equilibrium.solve": ("solve",),
    "errors": ("CosseratError", "ExportError", "Problem", "SceneError", "SolveError"),
    "identification.identification_result": ("Identification",),
    "identification.model_identification": ("identify", "identify_scene"),
    "model.build": ("Model", "build"),
    "model.discretise": ("discretise",),
    "motion.linear_model": ("LinearModel", "linearise"),
    "motion.motion_refinement": ("simulate_scene",),
    "motion.simulate": ("simulate",),
    "motion.trajectory": ("Motion", "MotionOutcome"),
    "motion.vibration_modes": ("Mode", "Modes", "modes_of", "modes_of_scene"),
    "numerics.outcome": ("Outcome",),
    "numerics.trace": ("PathOutcome",),
    "page.page": ("export_page",),
    "paths.equilibrium_path": ("EquilibriumPath", "PathEvent"),
    "paths.follow": ("follow_path",),
    "paths.path_refinement": ("follow_scene_path",),
    "results.identification_file": ("identification_result",),
    "results.inverse_file": ("inverse_result",),
    "results.modes_file": ("modes_result",),
    "results.motion_file": ("motion_result", "write_motion"),
    "results.path_file": ("path_result",),
    "results.solution_file": ("result", "write_result"),
    "rod.discretisation": ("Discretisation",),
    "scene": ("Scene", "parse_scene", "read_scene", "scene_from_dict", "with_exact_contact"),
    "sweep.outcome_file": ("read_sweep",),
    "sweep.outcome_table": ("Sweep",),
    "sweep.run": ("sweep_scene",),
    "sweep.sobol": ("SobolIndices", "sobol_indices"),
    "sweep.table": ("sobol_table",),
    "tubes.tube_equilibria": ("TubeEquilibria", "all_equilibria"),
    "tubes.tube_model": ("TubeModel",),
    "tubes.tube_path": ("TubeEvent", "TubePath"),
    "tubes.tube_solution": ("TubeSolution",),
}
"""Public names by the module that defines them."""

_MODULES = {name: module for module, names in _NAMES.items() for name in names}

__all__ = sorted(_MODULES)


# Hidden from type checkers, for which a module with this function has every name.
if not TYPE_CHECKING:

    def __getattr__(name: str) -> Any:
        """Load a public name at its first use."""
        if name == "__version__":
            value = import_module("importlib.metadata").version("cosserat-casadi")
        elif name in _MODULES:
            value = getattr(import_module(f"cosserat_casadi.{_MODULES[name]}"), name)
        else:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__, "__version__"})
