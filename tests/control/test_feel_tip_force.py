"""The example that feels a force at the tip of a moving robot: how far off it says it is, in C as in Python."""

import subprocess

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi.codegen.load import load
from cosserat_casadi.compiling.compiler import find_compiler
from examples.feel_tip_force import (
    Plant,
    draw,
    exported,
    filtered,
    normalised_error,
    robot,
    true_motion,
)
from tests.conftest import ROOT

pytestmark = pytest.mark.slow

SETTLED = 8
"""Measurements after which the covariance is that of what was measured, not of the first guess."""


@pytest.fixture(scope="module")
def plant(tmp_path_factory):
    model = robot()
    return Plant(model, load(exported(model, tmp_path_factory.mktemp("exported") / "robot")))


def mean_error(plant, runs, steps):
    """Normalised squared error after the last measurement, in the mean of seeded runs, and how much it varies."""
    errors = []
    for seed in range(runs):
        run = true_motion(plant, steps, seed)
        errors.append(normalised_error(filtered(plant, run)[-1], run.states[-1]))
    entries = 2 * plant.model.size + 3
    return np.mean(errors), entries, 1.96 * np.sqrt(2 * entries / runs)


def test_covariance_says_how_far_off_the_belief_is(plant):
    error, entries, band = mean_error(plant, 20, SETTLED)
    assert_allclose(error, entries, rtol=0.0, atol=band)


def test_covariance_is_consistent_over_two_hundred_runs(plant):
    error, entries, band = mean_error(plant, 200, 40)
    assert_allclose(error, entries, rtol=0.0, atol=band)


def test_filter_in_c_vs_python(tmp_path):
    """Of a robot with few modes: the compiler takes several times as long over the equations of the whole one."""
    model = robot(modes=1, nodes=4)
    folder = exported(model, tmp_path / "robot")
    plant = Plant(model, load(folder))
    run = true_motion(plant, 30, 3)
    program = tmp_path / "feel"
    flags = ["-O0", "-std=c99", "-Wall", "-Wextra", "-Werror", f"-I{folder}"]
    # The library is compiled already; it is linked by its path.
    linked = [ROOT / "examples" / "feel_tip_force.c", plant.library.library]
    subprocess.run([find_compiler(), *flags, *map(str, linked), "-lm", "-o", str(program)], check=True)
    lines = np.column_stack([run.tensions, run.seen])
    text = "\n".join(" ".join(map(repr, row)) for row in lines.tolist())
    answered = subprocess.run([program], input=text, capture_output=True, text=True, check=True).stdout
    beliefs = filtered(plant, run)
    wanted = [np.concatenate([belief.force, np.sqrt(np.diag(belief.covariance)[-3:])]) for belief in beliefs]
    found = np.array([line.split() for line in answered.splitlines()], dtype=float)
    assert_allclose(found, wanted, rtol=1e-7, atol=1e-9)
    # The force is felt: far better than it was known at first.
    assert np.all(found[-1, 3:] < 0.03)


def test_picture_is_drawn(plant, tmp_path):
    run = true_motion(plant, 5, 0)
    draw(run, filtered(plant, run), str(tmp_path / "f.png"))
    assert (tmp_path / "f.png").read_bytes().startswith(b"\x89PNG")
