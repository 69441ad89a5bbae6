"""A robot with disks and a tendon straight between them in motion, against a chain of rigid links."""

from __future__ import annotations

import numpy as np

from cosserat_casadi import scene_from_dict, simulate
from tests.motion.disk_chain import robot, tip_of_chain


def test_tip_vs_a_chain_of_rigid_links_at_its_rate() -> None:
    motion = simulate(scene_from_dict(robot(tolerance=1e-4)))
    assert motion.converged, motion.message
    tip = motion.tip("rod").position[:, [0, 2]]
    coarse, fine = (tip_of_chain(links, motion.times) for links in (10, 20))
    far, near = (np.linalg.norm(tips - tip, axis=1).max() for tips in (coarse, fine))
    assert 3.7 < far / near < 4.3
    extrapolated = fine + (fine - coarse) / 3
    assert np.linalg.norm(extrapolated - tip, axis=1).max() < 1e-4
