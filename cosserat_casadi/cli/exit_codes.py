"""Exit codes of the command line; 0 is success."""

REFUSED = 2
"""The input is refused, nothing was written."""

NOT_FOUND = 3
"""No equilibrium was found; the result file says so."""

INTERRUPTED = 130
"""Stopped by the user."""
