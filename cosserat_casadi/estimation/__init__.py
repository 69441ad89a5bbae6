"""Estimates: what a robot feels in every row of a table, from what its sensors say, with what they leave open.

cases ─ stacking ─▶ arrays ─ codegen/estimator ─▶ maxima a posteriori ─ knowledge ─▶ Estimate
"""

from cosserat_casadi.estimation.estimate import estimate, estimate_scene
from cosserat_casadi.estimation.estimate_outcome import Estimate

__all__ = ["Estimate", "estimate", "estimate_scene"]
