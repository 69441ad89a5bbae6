"""Cosserat rods as CasADi models: a scene enters as text and flows, stage by stage, to a solved rod.

scene.toml ─ read_scene ─▶ Scene ─ build ─▶ Model {named casadi.Functions} ─ solve ─▶ Solution
Scene ─ solve_scene ─▶ Solution on the cheapest discretisation within tolerance
"""

from cosserat_casadi.codegen.acados import acados_expressions, write_acados
from cosserat_casadi.codegen.compiled import Compiled, load
from cosserat_casadi.codegen.export import export
from cosserat_casadi.codegen.stage import compiled_stage
from cosserat_casadi.control import Inverse, inverse, inverse_scene
from cosserat_casadi.errors import CosseratError, ExportError, Problem, SceneError, SolveError
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.mesh import discretise
from cosserat_casadi.path_file import path_result
from cosserat_casadi.result_file import result, write_result
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.scene import Scene, parse_scene, read_scene, scene_from_dict
from cosserat_casadi.solver.accuracy import solve_scene
from cosserat_casadi.solver.outcome import Outcome
from cosserat_casadi.solver.path import EquilibriumPath, PathEvent, follow_path
from cosserat_casadi.solver.path_accuracy import follow_scene_path
from cosserat_casadi.solver.solution import Solution
from cosserat_casadi.solver.solve import solve
from cosserat_casadi.solver.trace import PathOutcome
from cosserat_casadi.solver.tuning import Tuning, tune
from cosserat_casadi.sweep import Sweep, read_sweep, sweep_scene

__all__ = [
    "Compiled",
    "CosseratError",
    "Discretisation",
    "EquilibriumPath",
    "ExportError",
    "Inverse",
    "Model",
    "Outcome",
    "PathEvent",
    "PathOutcome",
    "Problem",
    "Scene",
    "SceneError",
    "Solution",
    "SolveError",
    "Sweep",
    "Tuning",
    "acados_expressions",
    "build",
    "compiled_stage",
    "discretise",
    "export",
    "follow_path",
    "follow_scene_path",
    "inverse",
    "inverse_scene",
    "load",
    "parse_scene",
    "path_result",
    "read_scene",
    "read_sweep",
    "result",
    "scene_from_dict",
    "solve",
    "solve_scene",
    "sweep_scene",
    "tune",
    "write_acados",
    "write_result",
]
