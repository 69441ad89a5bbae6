"""The model of a scene, of rods or of concentric tubes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, overload

from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.model import build as model_build
from cosserat_casadi.model.build import Model
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.scene import Scene

if TYPE_CHECKING:
    from cosserat_casadi.tubes.tube_functions import TubeFunctions


@overload
def build(
    scene: Scene, discretisation: Mapping[str, Discretisation] | None = None, *, moving: bool = False
) -> Model: ...


@overload
def build(scene: Scene, discretisation: int) -> TubeFunctions: ...


def build(
    scene: Scene, discretisation: Mapping[str, Discretisation] | int | None = None, *, moving: bool = False
) -> Model | TubeFunctions:
    """The model of a scene.

    Args:
        scene: a validated scene.
        discretisation: for rods, one for every rod; by default the scene's, or else a moderate one. For concentric
            tubes, the number of steps of a piece. :func:`cosserat_casadi.solve` chooses it for a tolerance.
        moving: whether the model is for a motion, in which bodies may turn freely.

    Raises:
        SceneError: joints over-constrain; or, at rest, leave a body free to turn; a load or an obstacle cannot be
            where it is; the discretisation is none of the scene's kind.
    """
    if not isinstance(discretisation, int):
        return model_build.build(scene, discretisation, moving=moving)
    # Imported here, since scenes of rods do not need the modules of tubes.
    from cosserat_casadi.tubes.robot import parametric_robot
    from cosserat_casadi.tubes.tube_solve import model_of

    if discretisation < 1:
        raise SceneError(Problem("discretisation", f"must be at least one step, got {discretisation}"))
    return model_of(parametric_robot(scene), discretisation)
