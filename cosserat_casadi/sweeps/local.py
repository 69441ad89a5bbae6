"""A sweep on the cores of this machine: threads call compiled libraries, or one process each for rows in Python.

Such a process reads tasks from standard input and writes results to standard output. It ends with its input, so that
none is left over after a killed sweep.
"""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
import threading
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import AbstractContextManager
from pathlib import Path
from types import TracebackType
from typing import BinaryIO

from cosserat_casadi.errors import Problem, SceneError, SolveError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.sweeps.work import Chunk, Part, solve_parts

AHEAD = 4
"""Chunks that wait for each core: enough to keep it busy, few enough to stop soon."""


class Worker:
    """A further process, used by one thread at a time."""

    def __init__(self) -> None:
        # The same package as here, installed or not.
        paths = [str(Path(__file__).parents[2])]
        if os.environ.get("PYTHONPATH"):
            paths.append(os.environ["PYTHONPATH"])
        environment = dict(os.environ)
        environment["PYTHONPATH"] = os.pathsep.join(paths)
        # Small matrices: threads of BLAS would only take the other processes' cores.
        environment["OPENBLAS_NUM_THREADS"] = "1"
        self._process = subprocess.Popen(
            [sys.executable, "-c", "from cosserat_casadi.sweeps.local import main; main()"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=environment,
        )

    def solve(self, parts: Sequence[Part]) -> FloatArray:
        """Results of the rows of a chunk.

        Raises:
            SolveError: the process died.
        """
        process = self._process
        if process.stdin is None or process.stdout is None:
            raise SolveError("the process has no pipes")
        try:
            pickle.dump(parts, process.stdin)
            process.stdin.flush()
            results: FloatArray = pickle.load(process.stdout)
        except (OSError, EOFError, pickle.UnpicklingError):
            message = f"a process of the sweep ended with {process.wait()}; finished rows in an output stay finished"
            raise SolveError(message) from None
        return results

    def close(self) -> None:
        """End the process at once, since nobody needs its unfinished task."""
        self._process.kill()
        self._process.communicate()


def serve(tasks: BinaryIO, results: BinaryIO) -> None:
    """Solve tasks until the input ends."""
    while True:
        try:
            parts = pickle.load(tasks)
        except EOFError:
            return
        pickle.dump(solve_parts(parts), results)
        results.flush()


def main() -> None:
    """Entry point: an interrupt of the terminal is for the sweep, which ends this process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    results = os.fdopen(os.dup(1), "wb")
    # Other output must not mix with the results.
    os.dup2(2, 1)
    serve(sys.stdin.buffer, results)


class Cores(AbstractContextManager["Cores"]):
    """Cores of this machine, each with one chunk at a time; results come in the order in which they are ready.

    Raises:
        SceneError: the number of cores is below 1.
    """

    def __init__(self, count: int | None = None) -> None:
        if count is not None and count < 1:
            raise SceneError(Problem("--cores", f"must be at least 1, got {count}"))
        self.count = count or available_cores()
        self._pool = ThreadPoolExecutor(self.count)
        self._own = threading.local()
        self._workers: list[Worker] = []

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        # After an error the workers are ended first, or the pool would wait for their tasks.
        if kind is not None:
            self._close_workers()
        self._pool.shutdown(wait=True, cancel_futures=True)
        if kind is None:
            self._close_workers()

    def _close_workers(self) -> None:
        for worker in self._workers:
            worker.close()

    def run(self, tasks: Iterable[tuple[Chunk, Sequence[Part]]]) -> Iterator[tuple[Chunk, FloatArray]]:
        """Every chunk with its results, in the order in which they are ready."""
        waiting: dict[Future[FloatArray], Chunk] = {}
        for chunk, parts in tasks:
            future = self._pool.submit(self._solve, chunk.compiled, parts)
            waiting[future] = chunk
            if len(waiting) >= AHEAD * self.count:
                yield from _ready(waiting)
        while waiting:
            yield from _ready(waiting)

    def _solve(self, compiled: bool, parts: Sequence[Part]) -> FloatArray:
        if compiled:
            return solve_parts(parts)
        # A process for each thread, started with its first chunk.
        if not hasattr(self._own, "worker"):
            self._own.worker = Worker()
            self._workers.append(self._own.worker)
        results: FloatArray = self._own.worker.solve(parts)
        return results


def available_cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        # Fewer than the machine has, in a container or under a batch system.
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _ready(waiting: dict[Future[FloatArray], Chunk]) -> Iterator[tuple[Chunk, FloatArray]]:
    done, _ = wait(waiting, return_when=FIRST_COMPLETED)
    # Several that are ready at once come in the order of their chunks: a sweep that is stopped keeps the first ones.
    for future in [future for future in waiting if future in done]:
        yield waiting.pop(future), future.result()
