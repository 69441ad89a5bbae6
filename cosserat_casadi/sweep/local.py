"""A sweep on the cores of this machine: threads call compiled libraries, or drive a process each for rows in Python."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from types import TracebackType

from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.sweep.work import Chunk, Part, solve_parts
from cosserat_casadi.sweep.worker import Worker

AHEAD = 4
"""Chunks that wait for each core: enough to keep it busy, few enough to stop soon."""


class Cores:
    """So many chunks at once; results come as they are ready.

    Raises:
        SceneError: there is no core to work.
    """

    def __init__(self, count: int | None = None) -> None:
        if count is not None and count < 1:
            raise SceneError(Problem("--cores", f"must be at least 1, got {count}"))
        self.count = count or available_cores()
        self._pool = ThreadPoolExecutor(self.count)
        self._own = threading.local()
        self._workers: list[Worker] = []

    def __enter__(self) -> Cores:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        for worker in self._workers if kind else ():
            worker.close()
        self._pool.shutdown(wait=True, cancel_futures=True)
        for worker in self._workers if not kind else ():
            worker.close()

    def run(self, tasks: Iterable[tuple[Chunk, Sequence[Part]]]) -> Iterator[tuple[Chunk, FloatArray]]:
        """Every chunk with its results, in the order in which they are ready."""
        waiting: dict[Future[FloatArray], Chunk] = {}
        for chunk, parts in tasks:
            waiting[self._pool.submit(self._solve, chunk.compiled, parts)] = chunk
            if len(waiting) >= AHEAD * self.count:
                yield from _ready(waiting)
        while waiting:
            yield from _ready(waiting)

    def _solve(self, compiled: bool, parts: Sequence[Part]) -> FloatArray:
        if compiled:
            return solve_parts(parts)
        if not hasattr(self._own, "worker"):
            self._own.worker = Worker()
            self._workers.append(self._own.worker)
        found: FloatArray = self._own.worker.solve(parts)
        return found


def available_cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _ready(waiting: dict[Future[FloatArray], Chunk]) -> Iterator[tuple[Chunk, FloatArray]]:
    done, _ = wait(waiting, return_when=FIRST_COMPLETED)
    # Several that are ready at once come in the order of their chunks: a sweep that is stopped keeps the first ones.
    for future in [future for future in waiting if future in done]:
        yield waiting.pop(future), future.result()
