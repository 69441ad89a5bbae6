"""Generated C: a model as a folder of sources, and such a folder as CasADi functions again."""
