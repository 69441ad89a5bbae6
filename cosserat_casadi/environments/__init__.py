"""Environments for reinforcement learning over the compiled step: they need the extra ``gym``."""

import gymnasium

from cosserat_casadi.environments.reach import ReachEnvironment

REACH = "cosserat_casadi/Reach-v0"
"""Name under which ``gymnasium.make`` knows the environment once this package is imported."""

gymnasium.register(id=REACH, entry_point="cosserat_casadi.environments.reach:ReachEnvironment")

__all__ = ["REACH", "ReachEnvironment"]
