"""Exit codes of the command line; 0 is success."""

REFUSED = 2
"""The input is refused, nothing was written."""

NOT_FOUND = 3
"""No equilibrium was found, or the error is above the tolerance; the output says so."""

NOT_WRITTEN = 4
"""A file or standard output could not be written, e.g. on a full disk; no incomplete file remains."""

INTERRUPTED = 130
"""Stopped by the user."""

TERMINATED = 143
"""Stopped by SIGTERM."""
