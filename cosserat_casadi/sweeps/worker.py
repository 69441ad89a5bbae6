"""A process that solves rows in Python for a sweep: tasks come by standard input, results go by standard output.

It ends when its input ends, so that none is left over when the sweep is killed.
"""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import BinaryIO

from cosserat_casadi.errors import SolveError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.sweeps.work import Part, solve_parts


class Worker:
    """A process beside this one, for one thread at a time."""

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
            [sys.executable, "-c", "from cosserat_casadi.sweeps.worker import main; main()"],
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
            message = f"a process of the sweep ended with {process.wait()}; what an output keeps is not done again"
            raise SolveError(message) from None
        return results

    def close(self) -> None:
        """End the process: at once, its unfinished task is worth nothing to anyone."""
        self._process.kill()
        self._process.communicate()


def serve(tasks: BinaryIO, results: BinaryIO) -> None:
    """Solve what comes until nothing comes any more."""
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
    # Whatever else prints must not get among the results.
    os.dup2(2, 1)
    serve(sys.stdin.buffer, results)
