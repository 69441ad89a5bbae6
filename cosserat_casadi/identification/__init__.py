"""Identification of numbers of a scene from measurements, with statistics of their uncertainty.

table ─▶ cases ─▶ misfit (equilibria, quantities) ─▶ fit ─▶ statistics ─▶ Identification
"""

from cosserat_casadi.identification.identification_result import Identification, Row
from cosserat_casadi.identification.model_identification import identify

__all__ = ["Identification", "Row", "identify"]
