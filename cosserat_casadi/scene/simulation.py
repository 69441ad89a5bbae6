"""Settings of the computation of a motion: duration, start, accuracy."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.scene.faults import Fault, Table, not_ascending, numbers_of, shown
from cosserat_casadi.scene.records import Record
from cosserat_casadi.scene.values import NotEmpty, NotNegative, Number, Positive, Whole

TOLERANCE = 1e-3
"""Default tolerance of the paths of tips, relative to the rod length: enough for a film."""

FRAMES = 101
"""Default number of rows of a result."""

MOST_STEPS = 10_000_000
"""Most steps of one size that a scene may ask for: their polynomials take some 10 GB."""


class Simulation(Record):
    """Settings of `cosserat simulate`; all other commands ignore them."""

    example: ClassVar[str] = """\
[simulation]
duration = 1.0
frames = 201
start = "unloaded"
"""

    duration: Positive = Field(description="time that is simulated, from 0 on, s")
    frames: Annotated[Whole, Field(ge=2, le=1_000_000)] | None = Field(
        None, description="rows of the result, evenly spaced, both ends among them; 101 when times are left out too"
    )
    times: Annotated[tuple[NotNegative, ...], NotEmpty()] | None = Field(
        None, description="times of the rows of the result, increasing, within the duration, s; instead of frames"
    )
    start: Literal["equilibrium", "unloaded"] | None = Field(
        None,
        description="how it begins, at rest: in the static equilibrium of the inputs at t = 0, or in the unloaded "
        "shape; left out, it is 'unloaded' where a base is free or hangs on a joint that it moves in, else "
        "'equilibrium'",
    )
    tolerance: Annotated[Number, Field(ge=1e-12, le=1e-1)] | None = Field(
        None,
        description="wanted error of the paths of tips, relative to the rod length, without unit; that of [accuracy] "
        "when left out, or 1e-3 where that is left out too",
    )
    step: Positive | None = Field(
        None, description="fixed time step, s; its error is estimated, not controlled; steps are chosen when left out"
    )
    integrator: Literal["radau", "gauss"] = Field(
        "radau",
        description="'radau' damps what the steps do not resolve, 'gauss' keeps its energy",
    )

    @property
    def frame_times(self) -> FloatArray:
        """Times of the rows of the result, ascending, shape (rows,), s."""
        if self.times is not None:
            return np.asarray(self.times, dtype=float)
        frames = FRAMES if self.frames is None else self.frames
        return np.linspace(0.0, self.duration, frames)

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """Frames exclude times; times ascend within the duration; a step is neither longer nor far shorter than it."""
        if "frames" in given and "times" in given:
            yield Fault(("times",), "stands beside frames", "give one of the two")
        times = numbers_of(given.get("times"))
        yield from islice(not_ascending(times, ("times",), "time"), 1)
        # A duration that is not a number has its own fault, and bounds nothing.
        for duration in numbers_of(given.get("duration")):
            for i, time in enumerate(times):
                if time > duration:
                    yield Fault(("times", i), f"must be <= duration, got {shown(time)} of {shown(duration)}")
            for step in numbers_of(given.get("step")):
                if step > duration > 0:
                    yield Fault(("step",), f"must be <= duration, got {shown(step)} of {shown(duration)}")
                if 0 < step < duration / MOST_STEPS:
                    what = f"makes more than {MOST_STEPS:,} steps in {shown(duration)} s, got {shown(step)}"
                    yield Fault(("step",), what, "take a longer one, or leave it out")
