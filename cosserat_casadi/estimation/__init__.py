"""Estimates: loads and places on a robot in every row of a table, from its sensors, and directions that none sees.

cases ─ stacking ─▶ arrays ─ codegen/estimator ─▶ maxima a posteriori ─ knowledge ─▶ Estimate
"""

from cosserat_casadi.estimation.estimate import estimate
from cosserat_casadi.estimation.estimate_outcome import Estimate

__all__ = ["Estimate", "estimate"]
