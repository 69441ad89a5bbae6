"""The environment of Gymnasium over the step in C."""

import dataclasses

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from numpy.testing import assert_allclose, assert_array_equal

from cosserat_casadi.environments import REACH, ReachEnvironment
from cosserat_casadi.errors import SceneError
from cosserat_casadi.motion.simulate import simulate
from cosserat_casadi.scene import scene_from_text

FINGER = """
schema = 1
[accuracy]
modes = 3
nodes = 8
[[rods]]
name = "finger"
length = 0.1
strain = "kirchhoff"
material = { youngs_modulus = 1.2e6, poisson_ratio = 0.48, density = 1070.0 }
section = { shape = "circle", radius = 7e-3 }
damping = { retardation_time = 0.01 }
base = { tangent = [1, 0, 0] }
[[loads]]
name = "weight"
kind = "gravity"
acceleration = [0, 0, -9.81]
[[actuators]]
name = "flexor"
kind = "tendon"
rod = "finger"
tension = 0.1
offset = [-5e-3, 0.0]
[[actuators]]
name = "abductor"
kind = "tendon"
rod = "finger"
tension = 0.1
offset = [0.0, 5e-3]
[[bounds]]
input = "flexor.tension"
upper = 1.0
[[bounds]]
input = "abductor.tension"
upper = 1.0
"""


@pytest.fixture(scope="module")
def environment():
    return ReachEnvironment(scene_from_text(FINGER), duration=0.2)
