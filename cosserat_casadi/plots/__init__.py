"""Figures of solutions, paths and sweeps.

scene_plot puts together scenery (rods, bodies, actuators, targets), arrows of loads, and panels (strain, moment, force
along X); path_plot and sweep_plot stand alone. All of them draw with colours and write with figure.
"""
