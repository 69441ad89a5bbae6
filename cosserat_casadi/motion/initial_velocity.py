"""Initial velocities of a scene, as rates of the unknowns of its model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cosserat_casadi.maths.grid import gauss_legendre
from cosserat_casadi.maths.numbers import known
from cosserat_casadi.maths.rotation import quaternion_product
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.floating_frames import FrameName
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.motion.history import DIFFERENTIATED, equations_of
from cosserat_casadi.motion.motion_start import Start
from cosserat_casadi.motion.moving_inputs import Piece
from cosserat_casadi.numerics.consistent_start import following
from cosserat_casadi.rod.strain import DiscreteRod
from cosserat_casadi.scene.velocity_record import InitialVelocity

POINTS = 200
"""Number of abscissae at which rates of the modes are fitted to rates of the strains."""


def with_velocities(model: Model, start: Start, piece: Piece) -> Start:
    """Give a start the velocities of the scene; bodies, carried bases and coordinates of joints follow from them.

    Args:
        model: model of the scene in motion.
        start: start at rest.
        piece: first piece of the inputs.
    """
    if not model.scene.velocities or not start.found:
        return start
    unknowns = model.discrete.unknowns
    v = np.zeros(model.size)
    follows = np.zeros(model.size, dtype=bool)
    for _, entries in unknowns.of_kind(BlockKind.POSE, BlockKind.COORDINATE):
        follows[entries] = True
    inputs = piece.at(piece.start).value
    for velocity in model.scene.velocities:
        name = FrameName("body" if velocity.rod is None else "rod", velocity.owner)
        if velocity.rod is not None:
            rod = model.discrete.rods[velocity.rod]
            ratio = model.length_ratio(velocity.rod, inputs)
            v[unknowns.strain(velocity.rod)] = ratio * _strain_rates(rod, velocity)
        if velocity.rod is None or model.discrete.unloaded.records[velocity.rod].base.free:
            entries = model.discrete.deviation(name)
            frame = model.discrete.frames[name]
            turn = np.array([0.0, *velocity.angular])
            quaternion = frame.start.quaternion + start.x[entries][3:]
            spin = np.asarray(quaternion_product(turn[:, None], quaternion[:, None]))[:, 0] / 2.0
            v[entries] = np.concatenate([np.asarray(velocity.linear) / frame.length, spin])
            follows[entries] = False
    interval = DIFFERENTIATED * piece.smooth
    rates = following(equations_of(model, piece), piece.start, start.x, v, interval, follows)
    sentence = start.sentence.replace("At rest in", "With the velocities of the scene, in", 1)
    return replace(start, v=rates, sentence=sentence)


def _strain_rates(rod: DiscreteRod, velocity: InitialVelocity) -> FloatArray:
    """Rates of the strain coordinates of a rod that fit its strain rates, shape (n,), for the length of the rod."""
    X = gauss_legendre(POINTS)[0] / 2.0 + 0.5
    rates = velocity.strain_rates(X)
    q = np.zeros(rod.size)
    for component, columns in rod.columns.items():
        q[columns] = np.linalg.lstsq(known(rod.strain_of(component, X)), rates[:, component], rcond=None)[0]
    return q
