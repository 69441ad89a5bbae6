"""Generated C: export of a model as a folder of sources, and loading of such a folder as CasADi functions."""
