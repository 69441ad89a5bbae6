"""Inverse problems and optimal control: what stands around an equilibrium, with the equilibrium as constraints."""
