"""A wire with made-up measurements: what several tests identify."""

from __future__ import annotations

import numpy as np
import pytest

from cosserat_casadi import Model, build
from cosserat_casadi.scene import scene_from_dict
from tests.identification.made_up import WIRE, MadeUp, measured_shapes


@pytest.fixture(scope="package")
def wire_model() -> Model:
    """E, G and two coefficients of the curvature are unknown, positions of ten sections measured."""
    return build(scene_from_dict(WIRE).with_unknowns())


@pytest.fixture(scope="package")
def shapes(wire_model: Model) -> MadeUp:
    """Twenty shapes of the wire with noise of 0.2 mm."""
    return measured_shapes(wire_model, np.random.default_rng(16), cases=20, noise=2e-4)
