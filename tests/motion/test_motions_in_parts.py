"""Long motions in parts: the digits of one motion, files that an interrupt leaves, and memory that does not grow."""

from __future__ import annotations

import gc
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from cosserat_casadi import SceneError, scene_from_dict, simulate
from cosserat_casadi.motion.trajectory import MotionOutcome, MotionProgress
from tests.motion.test_motions_that_go_on import moved, swing

PART = 0.0625


def test_parts_have_the_digits_of_one_motion_and_survive_an_interrupt(tmp_path: Path) -> None:
    scene = scene_from_dict(swing(0.1875))
    whole = moved(swing(0.1875))
    told: list[MotionProgress] = []

    def interrupt(progress: MotionProgress) -> None:
        told.append(progress)
        if progress.time > 0.1:
            raise KeyboardInterrupt

    path = tmp_path / "swing.npz"
    stopped = simulate(scene, output=path, part=PART, progress=interrupt, compiled=False)
    assert stopped.outcome is MotionOutcome.INTERRUPTED
    assert {progress.duration for progress in told} == {0.1875}
    files = [tmp_path / f"swing-000{number}.npz" for number in (1, 2)]
    assert sorted(tmp_path.iterdir()) == files
    with np.load(files[1]) as second:
        kept = second["times"]
        assert_array_equal(kept, whole.times[(whole.times > PART) & (whole.times <= kept[-1])])
        assert len(kept)

    path = tmp_path / "on.npz"
    last = simulate(scene, start=files[0], output=path, part=PART, compiled=False)
    assert last.converged
    assert 0.8 * whole.error_estimate < last.error_estimate < 1.25 * whole.error_estimate
    parts = [np.load(file) for file in (files[0], tmp_path / "on-0001.npz", tmp_path / "on-0002.npz")]
    of_whole = {"times": whole.times, "energy.kinetic": whole.energy.kinetic, "energy.work": whole.energy.work}
    for name, rows in of_whole.items():
        assert_array_equal(np.concatenate([part[name] for part in parts]), rows)


def test_parts_without_length_or_file_are_refused() -> None:
    with pytest.raises(SceneError, match=r"--part.*\n*.*--output") as refused:
        simulate(scene_from_dict(swing(0.125)), part=0.0, output="swing.csv")
    assert len(refused.value.problems) == 2


@pytest.mark.slow
def test_memory_does_not_grow_with_the_parts(tmp_path: Path) -> None:
    """Of 500 steps, and as many again of half the size: what is held after 5 parts is what is held after 10."""
    tables = swing(0.5, step=1e-3, accuracy={"modes": 5, "nodes": 10})
    tables["simulation"]["frames"] = 501
    held: dict[float, int] = {}

    def tell(progress: MotionProgress) -> None:
        # In the middle of a part, of its first motion.
        if progress.stage == "going on" and abs((progress.time % 0.05) - 0.025) < 1e-6:
            gc.collect()
            held[progress.time] = tracemalloc.get_traced_memory()[0]

    tracemalloc.start()
    try:
        last = simulate(scene_from_dict(tables), output=tmp_path / "long.npz", part=0.05, progress=tell, compiled=False)
    finally:
        tracemalloc.stop()
    assert last.converged
    assert len(list(tmp_path.iterdir())) == 10
    sizes = list(held.values())
    assert len(sizes) == 9
    assert sizes[-1] < 1.05 * sizes[3]
