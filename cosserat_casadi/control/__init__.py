"""Inverse problems and optimal control: what stands around an equilibrium, with the equilibrium as constraints."""

from cosserat_casadi.control.embedding import Lifted, embedded, lifted
from cosserat_casadi.control.inverse import Inverse, inverse
from cosserat_casadi.control.inverse_accuracy import inverse_scene
from cosserat_casadi.control.margin import stability_margin
from cosserat_casadi.control.target_errors import Gap

__all__ = [
    "Gap",
    "Inverse",
    "Lifted",
    "embedded",
    "inverse",
    "inverse_scene",
    "lifted",
    "stability_margin",
]
