"""A real browser for tests: Chromium, as Debian packages it, without a window."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome", "chromium-headless-shell")
"""Programs that are looked for."""

PATIENCE = 60_000
"""Milliseconds that a condition of a page is waited for: twenty times what a browser takes on an idle machine."""


@contextmanager
def browser() -> Iterator[Any]:
    """A browser of playwright; the test is skipped where the machine has none."""
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed: see the extra test")
    programs = [path for path in map(shutil.which, NAMES) if path is not None]
    if not programs:
        pytest.skip("no browser on this machine: apt install chromium")
    with playwright.sync_playwright() as driver:
        # The sandbox of Chromium asks for rights that root and containers do not have; WebGL without a graphics card
        # is drawn by the processor.
        rights = ["--no-sandbox", "--enable-unsafe-swiftshader"]
        opened = driver.chromium.launch(executable_path=programs[0], args=rights)
        try:
            yield opened
        finally:
            opened.close()
