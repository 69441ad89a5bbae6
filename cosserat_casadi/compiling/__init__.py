"""Translation of CasADi functions to C, and of C to machine code: printers, sources, compilers and their cache."""
