"""Programs of scalars as C without loops: the digits of the virtual machine at one point, and at three at once."""

from __future__ import annotations

import os
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi.compiling.compiler import FLAGS, compiled_texts, find_compiler, flags_of_machine
from cosserat_casadi.compiling.printed_files import external_sources
from cosserat_casadi.compiling.scalar_program import scalar_program
from cosserat_casadi.compiling.straight_program import straight_kernels
from cosserat_casadi.motion.displacement import displacements
from cosserat_casadi.motion.history import integrated
from cosserat_casadi.motion.motion_compiler import MotionCompiler
from cosserat_casadi.motion.repeated_call import RepeatedCall
from cosserat_casadi.motion.simulate import moving_inputs
from cosserat_casadi.motion.step_kernels import interpreted_residual
from cosserat_casadi.numerics.collocation import STAGES, radau
from cosserat_casadi.numerics.integration import StepSettings
from tests.codegen.test_load import needs_compiler
from tests.compiling.test_scalar_program import ROUNDING, by_casadi, every_operation, lanes
from tests.motion.test_motion_compiler import arm, moving

pytestmark = needs_compiler

TOGETHER = "at_three_points"


@pytest.mark.parametrize("flags", [FLAGS, flags_of_machine(), (*FLAGS, "-DFOURS_ONE_BY_ONE")])
def test_every_operation(flags: tuple[str, ...], monkeypatch: pytest.MonkeyPatch) -> None:
    """In parts that pass values on, in vectors of each width and lane by lane."""
    monkeypatch.setattr("cosserat_casadi.compiling.straight_program.LONGEST_PART", 13)
    operations = every_operation()
    a, b = ca.SX.sym("a"), ca.SX.sym("b")
    values = operations(a, b)
    function = ca.Function("every", [a, b], [ca.vertcat(values, ca.cumsum(values), 0.5)])
    program = scalar_program(function)
    assert program is not None
    kernels = straight_kernels(program, function, TOGETHER)
    path = os.fspath(
        compiled_texts("every", external_sources(kernels, "every", "long long int"), find_compiler(), flags=flags)
    )
    given = lanes(2)[:STAGES]
    expected = by_casadi(function, given)
    found = ca.external(TOGETHER, path)(*given.T[:, None]).full()
    assert_allclose(found.T, expected, rtol=ROUNDING, atol=0)
    for point, values_there in zip(given, expected, strict=True):
        assert_allclose(ca.external("every", path)(*point).full()[:, 0], values_there, rtol=ROUNDING, atol=0)


@pytest.fixture(name="call", scope="module")
def _call() -> RepeatedCall:
    """Inverse dynamics of a rod that a tendon moves, in machine code."""
    residual = MotionCompiler(always=True).kernels(moving(arm())).residual
    assert isinstance(residual, RepeatedCall)
    return residual


def test_stages_have_the_numbers_of_one_after_the_other(call: RepeatedCall) -> None:
    assert call.at_stages is not None
    points = [np.random.default_rng(7).uniform(-0.3, 0.3, (STAGES, len(values))) for values in call.arguments]
    found = call.at_stages(*(values.ravel() for values in points)).reshape(STAGES, -1)
    plain = interpreted_residual(moving(arm()))
    expected = np.array([plain(*(values[stage] for values in points)) for stage in range(STAGES)])
    assert_allclose(found, expected, rtol=0, atol=1e-14 * np.abs(expected).max())
    assert np.abs(found[1:] - found[:-1]).max(axis=1).min() > 1e-3 * np.abs(expected).max()


def test_steps_in_c_call_it_for_their_stages(call: RepeatedCall) -> None:
    """Moving inputs at each stage; without it the steps have the same ends to rounding."""
    model = moving(arm())
    kernels = MotionCompiler(always=True).kernels(model)
    settings = StepSettings(tolerance=1e-4 / displacements(model))
    ends = []
    for at_stages in (call.at_stages, None):
        call.at_stages = at_stages
        asked = replace(kernels, residual=call, stepper_after=None)
        start = np.zeros(model.size)
        pieces = moving_inputs(model).pieces(0.05)
        history = integrated(model, pieces, start, start, radau(STAGES), settings, kernels=asked)
        assert history.completed
        ends.append(history.end.x)
        # The last stage is the end of the step.
        for number, values in enumerate(pieces[-1].at(0.05), start=3) if at_stages else ():
            assert_allclose(at_stages.arguments[number].reshape(STAGES, -1)[-1], values, rtol=1e-12, atol=1e-12)
    assert np.abs(ends[0]).max() > 1e-3
    assert_allclose(ends[0], ends[1], rtol=0, atol=1e-12)
