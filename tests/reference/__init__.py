"""An independent oracle for single rods: shooting in rotation matrices, and closed forms.

Nothing here uses the package under test: scenes are plain dictionaries as `tomllib` reads them, the rod is integrated
in world axes with DOP853, and no strain is ever expanded in polynomials.

`rods` turns a scene into functions of X, `shooting` solves its static boundary value problem, `closed_forms` holds
answers known without integration, and `random_scenes` makes seeded scenes to compare solvers on.
"""
