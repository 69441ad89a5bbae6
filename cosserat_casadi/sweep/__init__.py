"""Sweeps: a scene solved for every row of a table of inputs and parameters, on all cores or on a cluster.

table ─ variants ─▶ scenes and inputs ─ choice ─▶ one discretisation ─ work ─▶ chunks ─ local, cluster ─▶ results
"""

from cosserat_casadi.sweep.outcome_file import read_sweep
from cosserat_casadi.sweep.outcome_table import Sweep
from cosserat_casadi.sweep.run import sweep_scene

__all__ = ["Sweep", "read_sweep", "sweep_scene"]
