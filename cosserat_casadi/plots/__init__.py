"""Figures of solutions, paths and sweeps.

scene_plot puts together scenery (rods, bodies, actuators, targets), load_arrows and panels (strain, moment, force along
X); path_plot and sweep_plot stand alone. All of them draw with colours and write with figure.
"""
