"""Equilibria along one input: limit points, bifurcations, branches."""
