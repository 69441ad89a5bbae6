"""Independent oracles for single rods, and the parts of the report that the package does not need.

`rods` turns a scene into functions of X, `shooting` solves its static boundary value problem, `closed_forms` holds
answers known without integration, and `random_scenes` makes seeded scenes to compare solvers on. None of them uses the
package under test: scenes are plain dictionaries as `tomllib` reads them, the rod is integrated in world axes with
DOP853, and no strain is ever expanded in polynomials.

`rotations`, `rigid_motions` and `chebyshev` are the report's appendices A and B where they go beyond the package; they
alone build on `cosserat_casadi.maths`.
"""
