"""Estimates of loads and places on a robot from its sensors, for every row of a table, and of unseen directions.

cases ─ stacking ─▶ arrays ─ codegen/estimator ─▶ maxima a posteriori ─ knowledge ─▶ Estimate
"""

from cosserat_casadi.estimation.estimate import estimate
from cosserat_casadi.estimation.estimate_outcome import Estimate

__all__ = ["Estimate", "estimate"]
