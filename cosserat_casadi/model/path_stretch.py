"""How much length the paths of tendons have left along the rods that they run through.

A path at D(X) in the sections has the tangent T = Γ + K × D + D'/ℓ. With plane, rigid sections the determinant of the
deformation gradient is T_z there: where it vanishes matter is pressed to nothing, and beyond it is turned inside out.
A cable has no length along the rod there, which the equations, that know |T| alone, do not see.
"""

from __future__ import annotations

import casadi as ca

from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.model.system import Arguments, System
from cosserat_casadi.rod.cable import RoutedCable

VANISHED = 1e-3
"""T_z up to which a path counts as vanished: a path that is followed to zero ends short of it by a last step."""


def path_stretches(system: System) -> dict[str, Matrix]:
    """T_z of each tendon's path where it is least, per length of the rod, 1×1 each, by the names of the tendons.

    Tendons whose T_z no strain changes are left out.
    """
    stretches = {}
    for actuator in system.discrete.scene.actuators:
        _, conjugate = system.actuators.conjugate(actuator.name)
        if not isinstance(conjugate, RoutedCable):
            continue
        along = conjugate.stretch_along
        if along is not None and not along.is_constant():
            stretches[actuator.name] = ca.mmin(along)
    return stretches


def changing_paths(discrete: DiscreteScene) -> list[str]:
    """Names of the tendons whose T_z some strain changes, in the order of the scene."""
    arguments = Arguments(ca.MX.sym("x", discrete.size), ca.MX.sym("inputs", discrete.layout.size))
    return list(path_stretches(System(discrete, arguments)))
