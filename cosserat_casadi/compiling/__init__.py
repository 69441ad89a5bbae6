"""A function of CasADi as C, and C as machine code: printers, sources, compilers and their cache."""
