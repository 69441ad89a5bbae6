"""The page "view.md" works when pasted; its servers are started by other tests."""

from __future__ import annotations

from pathlib import Path

from cosserat_casadi.page.webassembly import VARIABLE
from tests.page.pages_made import ASSETS, wasm_compiler
from tests.pages import DOCS, blocks, commands, run_command, run_python

PAGE = DOCS / "view.md"


def test_commands_and_python_of_the_page(tmp_path: Path) -> None:
    assert PAGE.name == "view.md"
    viewed, exported = commands(PAGE)
    assert viewed == "cosserat view examples/two_section_robot.toml"
    (code,) = blocks(PAGE, "python")
    run_python(code)
    wasm_compiler()
    run_command(exported, tmp_path)
    assert (tmp_path / "strip.html").stat().st_size < 2_000_000


def test_names_of_the_page_are_those_of_the_program() -> None:
    text = PAGE.read_text()
    assert VARIABLE in text
    panel = (ASSETS / "panel.js").read_text()
    for member in ("setInput(", "get inputs(", "tip(", "get status(", "get state(", "get stable(", "reset:"):
        assert f"      {member}" in panel
        assert f"robot.{member.removeprefix('get ').rstrip('(:')}" in text
