"""Cosserat rods as CasADi models: a scene enters as text and flows, stage by stage, to a solved rod.

scene.toml ─ read_scene ─▶ Scene ─ build ─▶ Model {named casadi.Functions}
Scene or Model ─ solve, follow, simulate, modes_of, inverse, identify, sweep ─▶ Solution, EquilibriumPath, Motion …
Scene or Model ─ export ─▶ folder of C ─ load ─▶ Compiled

A scene is solved within its tolerance, on modes and nodes that are chosen for it; a model keeps its modes and nodes.
Every result has ``to_dict()``, ``write(path)`` and ``plot()``.

A public name loads its module when it is first used, so that ``import cosserat_casadi`` itself takes no time.
"""

import time
from importlib import import_module
from typing import TYPE_CHECKING, Any

# Type checkers and editors read these lines, the interpreter the table below; a test compares the two.
if TYPE_CHECKING:
    from cosserat_casadi.accuracy.choose import Choice as Choice
    from cosserat_casadi.accuracy.choose import choose as choose
    from cosserat_casadi.accuracy.models import build as build
    from cosserat_casadi.accuracy.refine import solve as solve
    from cosserat_casadi.codegen.compiled import Compiled as Compiled
    from cosserat_casadi.codegen.export import export as export
    from cosserat_casadi.codegen.load import load as load
    from cosserat_casadi.control.inverse_accuracy import inverse as inverse
    from cosserat_casadi.control.inverse_result import Inverse as Inverse
    from cosserat_casadi.equilibrium.solution import Solution as Solution
    from cosserat_casadi.errors import CosseratError as CosseratError
    from cosserat_casadi.errors import ExportError as ExportError
    from cosserat_casadi.errors import Problem as Problem
    from cosserat_casadi.errors import SceneError as SceneError
    from cosserat_casadi.errors import SolveError as SolveError
    from cosserat_casadi.identification.identification_result import Identification as Identification
    from cosserat_casadi.identification.model_identification import identify as identify
    from cosserat_casadi.model.build import Model as Model
    from cosserat_casadi.model.discretise import discretise as discretise
    from cosserat_casadi.motion.linear_model import LinearModel as LinearModel
    from cosserat_casadi.motion.linear_model import linearise as linearise
    from cosserat_casadi.motion.motion_refinement import simulate as simulate
    from cosserat_casadi.motion.trajectory import Motion as Motion
    from cosserat_casadi.motion.trajectory import MotionOutcome as MotionOutcome
    from cosserat_casadi.motion.vibration_modes import Modes as Modes
    from cosserat_casadi.motion.vibration_modes import modes_of as modes_of
    from cosserat_casadi.numerics.outcome import Outcome as Outcome
    from cosserat_casadi.numerics.trace import PathOutcome as PathOutcome
    from cosserat_casadi.paths.equilibrium_path import EquilibriumPath as EquilibriumPath
    from cosserat_casadi.paths.path_refinement import follow as follow
    from cosserat_casadi.paths.tube_path import TubePath as TubePath
    from cosserat_casadi.rod.discretisation import Discretisation as Discretisation
    from cosserat_casadi.scene import Scene as Scene
    from cosserat_casadi.scene import parse_scene as parse_scene
    from cosserat_casadi.scene import read_scene as read_scene
    from cosserat_casadi.scene import scene_from_dict as scene_from_dict
    from cosserat_casadi.sweeps.outcome_file import read_sweep as read_sweep
    from cosserat_casadi.sweeps.outcome_table import Sweep as Sweep
    from cosserat_casadi.sweeps.run import sweep as sweep
    from cosserat_casadi.sweeps.sobol import SobolIndices as SobolIndices
    from cosserat_casadi.sweeps.sobol import sobol_indices as sobol_indices
    from cosserat_casadi.sweeps.table import sobol_table as sobol_table
    from cosserat_casadi.tubes.tube_equilibria import TubeEquilibria as TubeEquilibria
    from cosserat_casadi.tubes.tube_equilibria import all_equilibria as all_equilibria
    from cosserat_casadi.tubes.tube_solution import TubeSolution as TubeSolution

    __version__: str

IMPORTED = time.time()
"""Seconds since the epoch: this process may not run sources that changed later."""

_NAMES = {
    "accuracy.choose": ("Choice", "choose"),
    "accuracy.models": ("build",),
    "accuracy.refine": ("solve",),
    "codegen.compiled": ("Compiled",),
    "codegen.export": ("export",),
    "codegen.load": ("load",),
    "control.inverse_accuracy": ("inverse",),
    "control.inverse_result": ("Inverse",),
    "equilibrium.solution": ("Solution",),
    "errors": ("CosseratError", "ExportError", "Problem", "SceneError", "SolveError"),
    "identification.identification_result": ("Identification",),
    "identification.model_identification": ("identify",),
    "model.build": ("Model",),
    "model.discretise": ("discretise",),
    "motion.linear_model": ("LinearModel", "linearise"),
    "motion.motion_refinement": ("simulate",),
    "motion.trajectory": ("Motion", "MotionOutcome"),
    "motion.vibration_modes": ("Modes", "modes_of"),
    "numerics.outcome": ("Outcome",),
    "numerics.trace": ("PathOutcome",),
    "paths.equilibrium_path": ("EquilibriumPath",),
    "paths.path_refinement": ("follow",),
    "paths.tube_path": ("TubePath",),
    "rod.discretisation": ("Discretisation",),
    "scene": ("Scene", "parse_scene", "read_scene", "scene_from_dict"),
    "sweeps.outcome_file": ("read_sweep",),
    "sweeps.outcome_table": ("Sweep",),
    "sweeps.run": ("sweep",),
    "sweeps.sobol": ("SobolIndices", "sobol_indices"),
    "sweeps.table": ("sobol_table",),
    "tubes.tube_equilibria": ("TubeEquilibria", "all_equilibria"),
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
    return [*__all__, "__version__"]
