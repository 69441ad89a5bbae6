"""Mathematics without rods: rotations, rigid motions, Chebyshev matrices, the permuted system."""
