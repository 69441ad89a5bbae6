"""The guide works when pasted: its files, commands and Python, in order, in one folder."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.conftest import ROOT

GUIDE = (ROOT / "docs" / "guide.md").read_text()
SAVED = re.compile(r"[Ss]ave (?:this )?as `([\w.]+)`")
BLOCK = re.compile(r"```(\w+)\n(.*?)```", flags=re.DOTALL)


def blocks() -> list[tuple[str, str, str]]:
    """Language, text and, of what is saved, the name that the sentence before gives it."""
    found, end = [], 0
    for block in BLOCK.finditer(GUIDE):
        names = SAVED.findall(GUIDE[end : block.start()])
        found.append((block[1], block[2], names[-1] if names else ""))
        end = block.end()
    return found


def run_lines(text: str, folder: Path) -> None:
    words = {"cosserat": f'"{sys.executable}" -c "from cosserat_casadi.cli.main import main; main()"'}
    lines = "\n".join(re.sub(r"^cosserat\b", lambda _: words["cosserat"], line) for line in text.splitlines())
    done = subprocess.run(["sh", "-e", "-c", lines], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{text}\n{done.stdout}\n{done.stderr}"


def test_the_guide_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    notebook: dict[str, Any] = {}
    for language, text, name in blocks():
        if name:
            Path(name).write_text(text)
        elif language == "sh":
            run_lines(text, tmp_path)
        else:
            assert language == "python", f"a block in {language} that nobody saves"
            exec(compile(text, "guide.md", "exec"), notebook)
    assert {"bent.png", "reach.json", "controller"} <= {path.name for path in tmp_path.iterdir()}


def test_every_kind_of_block_is_there() -> None:
    assert {language for language, *_ in blocks()} == {"toml", "sh", "python", "c"}
    assert [name for *_, name in blocks() if name] == ["finger.toml", "target.toml", "controller.c"]
