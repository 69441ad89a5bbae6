"""Environments for reinforcement learning over the compiled step: they need the extra ``gym``."""

import gymnasium

from cosserat_casadi.environments.reach import ReachEnvironment

REACH = "cosserat_casadi/Reach-v0"
"""Name of the environment for ``gymnasium.make`` after an import of this package."""

gymnasium.register(id=REACH, entry_point="cosserat_casadi.environments.reach:ReachEnvironment")

__all__ = ["REACH", "ReachEnvironment"]
