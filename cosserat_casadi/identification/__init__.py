"""Identification: numbers of a scene from what was measured, with what the data say of them and what not.

table ─▶ cases ─▶ misfit (equilibria, quantities) ─▶ fit ─▶ statistics ─▶ Identification
"""

from cosserat_casadi.identification.found import Identification, Row
from cosserat_casadi.identification.search import identify, identify_scene

__all__ = ["Identification", "Row", "identify", "identify_scene"]
