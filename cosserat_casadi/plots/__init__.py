"""Figures of solutions, paths and sweeps.

scene_plot puts together scenery (rods, bodies, actuators, targets), arrows of loads, and panels (strain, moment, force
along X); path_plot and sweep_plot stand alone. All modules draw with colours and write with figure. Functions that plot
return a matplotlib.figure.Figure. Without matplotlib, functions that draw or write raise PlotUnavailableError.
"""
