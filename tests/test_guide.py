"""Tutorials work when pasted: their files, commands and Python, in order, in one folder each."""

from __future__ import annotations

import itertools
import re
import subprocess
from pathlib import Path
from typing import Any

import pytest

from tests.commands import cosserat_line
from tests.conftest import ROOT
from tests.families import mostly_slow

MADE = {
    "guide.md": {"bent.png", "reach.json", "controller"},
    "motion.md": {"swing.json", "swing.png", "swing.gif", "let_go.json", "modes.json"},
}
"""Pages, with files that their blocks leave behind."""

SAVED = re.compile(r"[Ss]ave (?:this )?as `([\w.]+)`")
BLOCK = re.compile(r"```(\w+)\n(.*?)```", flags=re.DOTALL)


def blocks(page: str) -> list[tuple[str, str, str]]:
    """Language, text and, of what is saved, the name that the sentence before gives it."""
    text = (ROOT / "docs" / page).read_text()
    found = []
    end = 0
    for block in BLOCK.finditer(text):
        names = SAVED.findall(text[end : block.start()])
        found.append((block[1], block[2], names[-1] if names else ""))
        end = block.end()
    return found


def run_lines(text: str, folder: Path) -> None:
    """Run the lines of a block; those of the shell together, as they may lead to each other."""
    for is_ours, lines in itertools.groupby(whole_lines(text), lambda line: line.startswith("cosserat ")):
        if is_ours:
            for line in lines:
                done = cosserat_line(line, folder)
                assert done.returncode == 0, f"{line}\n{done.stdout}\n{done.stderr}"
        else:
            command = ["sh", "-e", "-c", "\n".join(lines)]
            ended = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
            assert ended.returncode == 0, f"{command[-1]}\n{ended.stdout}\n{ended.stderr}"


def whole_lines(text: str) -> list[str]:
    """Lines, those that go on behind a backslash as one, without comments."""
    return [re.split(r" +#", line)[0] for line in text.replace("\\\n", " ").splitlines()]


@pytest.mark.usefixtures("quick_gcc")
@pytest.mark.parametrize("page", mostly_slow(MADE, quick=[]))
def test_the_page_runs(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    notebook: dict[str, Any] = {}
    for language, text, name in blocks(page):
        if name:
            Path(name).write_text(text)
        elif language == "sh":
            run_lines(text, tmp_path)
        else:
            assert language == "python", f"a block in {language} that nobody saves"
            exec(compile(text, page, "exec"), notebook)
    assert MADE[page] <= {path.name for path in tmp_path.iterdir()}


def test_the_guide_meets_its_circle(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The first scene and its check against a closed form; the whole page takes longer and runs with the slow tests."""
    monkeypatch.chdir(tmp_path)
    found = blocks("guide.md")
    (finger,) = [text for _, text, name in found if name == "finger.toml"]
    Path("finger.toml").write_text(finger)
    (check,) = [text for language, text, _ in found if language == "python" and "circle" in text and "opti" not in text]
    exec(compile(check, "guide.md", "exec"), {})


def test_every_kind_of_block_is_there() -> None:
    assert {language for language, *_ in blocks("guide.md")} == {"toml", "sh", "python", "c"}
    assert [name for *_, name in blocks("guide.md") if name] == ["finger.toml", "target.toml", "controller.c"]
