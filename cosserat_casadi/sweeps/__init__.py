"""Sweeps: a scene solved for every row of a table of inputs and parameters, on all cores or on a cluster.

table ─ variants ─▶ scenes and inputs ─ choice ─▶ one discretisation ─ work ─▶ chunks ─ local, cluster ─▶ results
"""

from cosserat_casadi.sweeps.outcome_file import read_sweep
from cosserat_casadi.sweeps.outcome_table import Sweep
from cosserat_casadi.sweeps.run import sweep
from cosserat_casadi.sweeps.sobol import SobolIndices, sobol_indices
from cosserat_casadi.sweeps.table import sobol_table

__all__ = ["SobolIndices", "Sweep", "read_sweep", "sobol_indices", "sobol_table", "sweep"]
