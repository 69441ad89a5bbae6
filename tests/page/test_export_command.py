"""``cosserat export --page``."""

from __future__ import annotations

from pathlib import Path

import pytest

from cosserat_casadi.page.webassembly import VARIABLE
from tests.commands import Ended, cosserat
from tests.conftest import ROOT
from tests.page.pages_made import EXPORT_COMMAND, wasm_compiler


def export(*arguments: str) -> Ended:
    return cosserat(*EXPORT_COMMAND.split()[1:], *arguments, cwd=ROOT)


@pytest.mark.slow
def test_a_page_is_written_beside_no_folder(tmp_path: Path) -> None:
    wasm_compiler()
    done = export("--page", str(tmp_path / "strip.html"))
    assert done.returncode == 0, done.stderr
    assert "strip.html; any browser opens it" in done.stdout
    text = (tmp_path / "strip.html").read_text(encoding="utf-8")
    assert text.startswith("<!doctype html>")
    assert len(text) < 2_000_000
    assert "Permission is hereby granted" in text
    assert [path.name for path in tmp_path.iterdir()] == ["strip.html"]


def test_what_cannot_be_written_is_refused_before_the_solve(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    neither = export()
    assert neither.returncode == 2
    assert "--output" in neither.stderr
    assert "--page" in neither.stderr
    nowhere = export("--page", str(tmp_path / "none" / "strip.html"))
    assert nowhere.returncode == 2
    assert "does not exist" in nowhere.stderr
    monkeypatch.setenv(VARIABLE, "no-such-clang")
    without = export("--page", str(tmp_path / "strip.html"))
    assert without.returncode == 2
    assert "apt install clang lld wasi-libc" in " ".join(without.stderr.split())
    assert not list(tmp_path.iterdir())


def test_options_of_the_sources_are_refused_without_sources(tmp_path: Path) -> None:
    done = export("--page", str(tmp_path / "strip.html"), "--dynamics", "--derivatives")
    assert done.returncode == 2
    assert "--dynamics: is for the sources in C" in done.stderr
    assert "--derivatives: is for the sources in C" in done.stderr
    assert not list(tmp_path.iterdir())
