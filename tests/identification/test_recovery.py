"""Random truths and starts: all are recovered to the noise, and intervals hold the truth as often as they say."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.identification import one_try

TRIES = 100


@pytest.mark.slow
def test_intervals_hold_the_truth() -> None:
    """`benchmarks/identification.py` does the same a thousand times."""
    tries = [one_try(seed) for seed in range(1000, 1000 + TRIES)]
    assert all(one.converged for one in tries)
    deviations = np.array([one.deviations for one in tries])
    # Of 400 normal numbers, four of a try correlated.
    assert np.abs(deviations).max() < 4.5
    covered = np.mean(np.abs(deviations) < 1.96)
    assert 0.91 < covered < 0.985
    assert 0.85 < np.sqrt(np.mean(deviations**2)) < 1.15
