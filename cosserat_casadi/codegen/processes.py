"""Programs that run beside each other, each for a time that is bounded, and none longer than what waits for them."""

from __future__ import annotations

import os
import signal
import subprocess
import threading
from contextlib import suppress
from pathlib import Path
from types import TracebackType


class Processes:
    """Programs that were started here and have not ended; they are stopped where the block of a ``with`` is left.

    Args:
        longest: time that each of them has, s.
    """

    def __init__(self, longest: float) -> None:
        self._longest = longest
        self._running: set[subprocess.Popen[str]] = set()
        self._lock = threading.Lock()
        self._stopped = False

    def run(self, command: list[str], folder: Path | None = None) -> tuple[int, str]:
        """Run a program until it ends; several threads may do so at once.

        Args:
            command: its words.
            folder: in which it runs; None for the present one.

        Returns:
            its exit code and what it wrote to standard error.

        Raises:
            OSError: it cannot be run.
            TimeoutError: its time is over; it was stopped.
        """
        with self._lock:
            if self._stopped:
                return -signal.SIGTERM, ""
            # In a session of its own: what it has started in turn can be stopped with it.
            process = subprocess.Popen(
                command,
                cwd=folder,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                text=True,
                errors="replace",
                start_new_session=True,
            )
            self._running.add(process)
        # Leaving the block waits for the program: it is stopped before.
        with process:
            try:
                _, told = process.communicate(timeout=self._longest)
            except subprocess.TimeoutExpired:
                raise TimeoutError from None
            finally:
                _stop(process)
                with self._lock:
                    self._running.discard(process)
        return process.returncode, told

    def stop(self) -> None:
        """Stop all programs, and start none any more."""
        with self._lock:
            self._stopped = True
            for process in self._running:
                _stop(process)

    def __enter__(self) -> Processes:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.stop()


def _stop(process: subprocess.Popen[str]) -> None:
    """Stop a program, and what it has started, unless it has ended."""
    if process.poll() is not None:
        return
    with suppress(ProcessLookupError, PermissionError):
        if os.name == "posix":
            os.killpg(process.pid, signal.SIGKILL)
        else:
            process.kill()
