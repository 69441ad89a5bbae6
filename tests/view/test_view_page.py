"""The page "view.md" works when pasted; its servers are started by other tests."""

from __future__ import annotations

from cosserat_casadi.page.webassembly import VARIABLE
from tests.page.pages_made import ASSETS, EXPORT_COMMAND
from tests.pages import DOCS, blocks, commands, run_python

PAGE = DOCS / "view.md"


def test_commands_and_python_of_the_page() -> None:
    assert PAGE.name == "view.md"
    # One is started and stopped in test_view_command.py, the other is run in tests/page/test_export_command.py.
    assert commands(PAGE) == ["cosserat view examples/two_section_robot.toml", f"{EXPORT_COMMAND} --page strip.html"]
    (code,) = blocks(PAGE, "python")
    run_python(code)


def test_names_of_the_page_are_those_of_the_program() -> None:
    text = PAGE.read_text()
    assert VARIABLE in text
    panel = (ASSETS / "panel.js").read_text()
    for member in ("setInput(", "get inputs(", "tip(", "get status(", "get state(", "get stable(", "reset:"):
        assert f"      {member}" in panel
        assert f"robot.{member.removeprefix('get ').rstrip('(:')}" in text
