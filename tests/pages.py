"""Blocks of code in pages, and how they are run."""

from __future__ import annotations

import contextlib
import io
import re
import subprocess
import sys
import warnings
from pathlib import Path

from tests.commands import cosserat_line
from tests.conftest import ROOT

DOCS = ROOT / "docs"
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md", *sorted(DOCS.rglob("*.md"))]

BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", flags=re.DOTALL | re.MULTILINE)


def blocks(page: Path, language: str) -> list[str]:
    """Texts of the blocks in a language."""
    return [text for name, text in BLOCK.findall(page.read_text()) if name == language]


def prose(page: Path) -> str:
    """A page without its blocks."""
    return BLOCK.sub("", page.read_text())


def commands(page: Path) -> list[str]:
    """Commands of the blocks in sh that call cosserat, without what their output goes to."""
    lines = [line for text in blocks(page, "sh") for line in text.replace("\\\n", " ").splitlines()]
    return [re.split(r" > |  +#", line)[0] for line in lines if line.startswith("cosserat ")]


def run_python(code: str) -> str:
    """Run a block in the root of the repository, in this process; return what it prints."""
    printed = io.StringIO()
    with contextlib.chdir(ROOT), contextlib.redirect_stdout(printed), warnings.catch_warnings():
        warnings.simplefilter("default")
        exec(compile(code, "block of a page", "exec"), {"__name__": "__main__"})
    return printed.getvalue()


def run_program(code: str) -> str:
    """Run a block as a program of its own, as one that registers kinds of its own needs; return what it prints."""
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def run_command(line: str, folder: Path) -> None:
    """Run a command in a folder, with the examples of the repository."""
    done = cosserat_line(line.replace("examples/", f"{ROOT}/examples/"), folder)
    assert done.returncode == 0, done.stderr + done.stdout
