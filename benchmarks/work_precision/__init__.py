"""Points of the plane of error and time, measured, stored, tabled and drawn; `benchmarks/bench.py` runs it."""
