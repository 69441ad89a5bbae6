"""What a first hour meets: new scenes, examples, pages, versions, completion, and where an error leads."""

from __future__ import annotations

import importlib
import os
import pkgutil
import re
import subprocess
import sys
from pathlib import Path

import casadi as ca
import pytest
from rich.console import Console

import cosserat_casadi
from cosserat_casadi import SceneError, __version__, read_scene, solve
from cosserat_casadi.cli.commands.new import TEMPLATES, Template
from cosserat_casadi.cli.main import LINES, app, load_command, run
from cosserat_casadi.cli.shipped import examples, pages
from cosserat_casadi.errors import CosseratError, ExportError, Problem
from tests.conftest import ROOT
from tests.families import mostly_slow


def cosserat(*arguments: str) -> int:
    return run(lambda **options: app(list(arguments), **options))


# cosserat new


@pytest.mark.parametrize("template", mostly_slow(Template, quick=[Template.WIRE, Template.TENDON_ROBOT]))
def test_template_solves_as_it_stands(template: Template, tmp_path: Path) -> None:
    file = tmp_path / "robot.toml"
    assert cosserat("new", str(file), "--template", template.value) == 0
    solution = solve(read_scene(file))
    assert solution.converged
    assert solution.stable
    # It explains itself.
    text = file.read_text()
    assert text.count("#") > 10
    assert "cosserat docs scene" in text


OFFERED = re.compile(r"^# (?=\[\[\w+\]\]$|\w+ = )", re.MULTILINE)
"""The mark before a line that a comment offers."""


@pytest.mark.parametrize("template", [Template.WIRE, Template.TENDON_ROBOT])
def test_lines_that_a_template_offers_are_accepted(template: Template, tmp_path: Path) -> None:
    file = TEMPLATES / f"{template.value}.toml"
    taken = tmp_path / "taken.toml"
    text, count = OFFERED.subn("", file.read_text())
    taken.write_text(text)
    assert count > 0
    assert read_scene(taken) != read_scene(file)


@pytest.mark.slow
def test_inverse_problem_of_the_tendon_robot_is_solved(tmp_path: Path) -> None:
    file = tmp_path / "robot.toml"
    cosserat("new", str(file), "--template", "tendon-robot")
    assert cosserat("inverse", str(file)) == 0


def test_every_template_has_a_name() -> None:
    assert sorted(path.stem for path in TEMPLATES.glob("*.toml")) == sorted(Template)


def test_new_writes_a_wire_unless_told_otherwise(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "wire.toml"
    assert cosserat("new", str(file)) == 0
    assert file.read_bytes() == (TEMPLATES / "wire.toml").read_bytes()
    assert f"wrote {file}" in capsys.readouterr().out


def test_new_never_overwrites(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "robot.toml"
    file.write_text("mine")
    assert cosserat("new", str(file)) == 2
    assert file.read_text() == "mine"
    assert "exists already" in capsys.readouterr().err


def test_new_refuses_a_folder_that_is_not_there(tmp_path: Path) -> None:
    assert cosserat("new", str(tmp_path / "nowhere" / "robot.toml")) == 2
    assert list(tmp_path.iterdir()) == []


# cosserat --help


def test_help_lists_every_command(capsys: pytest.CaptureFixture[str]) -> None:
    assert cosserat("--help") == 0
    shown = " ".join(capsys.readouterr().out.replace("│", " ").split())
    for name, line in LINES.items():
        assert f"{name} {line}" in shown


@pytest.mark.parametrize("name", LINES)
def test_line_of_a_command_is_how_its_help_begins(name: str) -> None:
    help_text = " ".join(load_command(name).help.split())
    assert help_text.startswith(LINES[name])


def test_help_says_all_of_its_text(capsys: pytest.CaptureFixture[str]) -> None:
    """Brackets, as of [[bounds]], are no markup."""
    for name in LINES:
        assert cosserat(name, "--help") == 0
        shown = capsys.readouterr().out.split()
        missing = [word for word in load_command(name).help.split() if word not in shown]
        assert not missing, f"{name} --help lacks {missing}"


def test_a_bare_command_shows_its_help_and_no_error(capsys: pytest.CaptureFixture[str]) -> None:
    assert cosserat() == 2
    shown = capsys.readouterr()
    assert "Usage" in shown.out
    assert not shown.err


# cosserat examples


def test_examples_are_those_of_the_repository() -> None:
    found = examples()
    files = [path for kind in ("**/*.toml", "*.py", "*.ipynb") for path in (ROOT / "examples").glob(kind)]
    assert {example.file for example in found.values()} == set(files)
    assert found["nitinol_wire"].title == "Nitinol wire, own weight and a push at the tip"
    assert found["notebook"].title == "From a notebook"
    assert all(example.title for example in found.values())


def test_examples_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert cosserat("examples") == 0
    listed = capsys.readouterr().out
    for name in examples():
        assert name in listed


def test_measured_data_come_with_their_licence(tmp_path: Path) -> None:
    assert cosserat("examples", "validation/steel_strip", "--output", str(tmp_path)) == 0
    assert "strip_tip.csv" in (tmp_path / "data" / "cantilever-steel" / "README.md").read_text()
    assert cosserat("check", str(tmp_path / "validation" / "steel_strip.toml")) == 0


def test_examples_are_copied(tmp_path: Path) -> None:
    folder = tmp_path / "examples"
    assert cosserat("examples", "--output", str(folder)) == 0
    for example in examples().values():
        copied = folder / example.file.relative_to(ROOT / "examples")
        assert copied.read_bytes() == example.file.read_bytes()
    # A second time nothing is in the way.
    assert cosserat("examples", "--output", str(folder)) == 0


def test_chosen_examples_are_copied(tmp_path: Path) -> None:
    assert cosserat("examples", "deep_arch", "soft_arm", "--output", str(tmp_path)) == 0
    assert sorted(file.name for file in tmp_path.iterdir()) == ["deep_arch.toml", "soft_arm.toml"]


@pytest.mark.parametrize(
    ("name", "needed"),
    [
        ("sweeps/wire_tolerances", "nitinol_wire.toml"),
        ("tendon_robot_mpc", "two_section_robot.toml"),
        ("tendon_robot_swing_free", "two_section_robot.toml"),
        ("feel_tip_force", "feel_tip_force.c"),
        ("notebook", "nitinol_wire.toml"),
    ],
)
def test_copy_comes_with_what_it_needs(name: str, needed: str, tmp_path: Path) -> None:
    assert cosserat("examples", name, "--output", str(tmp_path)) == 0
    files = [file.relative_to(tmp_path) for file in tmp_path.rglob("*.*")]
    modules = [file for file in files if file.parent.name == "swing_free"]
    assert len(files) == 2 + len(modules) + (name == "notebook")
    assert bool(modules) == (name == "tendon_robot_swing_free")
    assert (tmp_path / needed).read_bytes() == (ROOT / "examples" / needed).read_bytes()


def test_copies_do_not_overwrite(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("deep_arch", "soft_arm"):
        (tmp_path / f"{name}.toml").write_text("mine")
    assert cosserat("examples", "--output", str(tmp_path)) == 2
    problems = capsys.readouterr().err
    assert "deep_arch.toml exists already" in problems
    assert "soft_arm.toml exists already" in problems
    assert sorted(file.name for file in tmp_path.iterdir()) == ["deep_arch.toml", "soft_arm.toml"]


def test_unknown_examples_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert cosserat("examples", "deep_arch", "one", "two") == 2
    problems = capsys.readouterr().err
    assert "there is no example one" in problems
    assert "there is no example two" in problems


# cosserat docs, and where errors lead


def test_page_goes_through_a_pipe_as_it_is_written(capsys: pytest.CaptureFixture[str]) -> None:
    assert cosserat("docs", "api/solving") == 0
    assert capsys.readouterr().out.rstrip("\n") == (ROOT / "docs" / "api" / "solving.md").read_text().rstrip("\n")


def test_page_is_laid_out_in_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    shown: list[str] = []
    monkeypatch.setattr("rich.pager.SystemPager.show", lambda pager, content: shown.append(content))
    terminal = Console(force_terminal=True, width=100)
    monkeypatch.setattr("cosserat_casadi.cli.commands.docs.Console", lambda: terminal)
    assert cosserat("docs", "glossary") == 0
    assert "Glossary" in shown[0]
    assert "# Glossary" not in shown[0]


def test_pages_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert cosserat("docs") == 0
    listed = capsys.readouterr().out
    for file in (ROOT / "docs").glob("*.md"):
        assert file.stem in listed


def test_unknown_page_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert cosserat("docs", "nowhere") == 2
    assert "there is no page nowhere" in capsys.readouterr().err


def families(error: type[CosseratError]) -> list[type[CosseratError]]:
    found = [error]
    for child in error.__subclasses__():
        found += families(child)
    return found


def test_every_family_of_errors_leads_to_a_page() -> None:
    # Errors are defined where they are raised.
    for module in pkgutil.walk_packages(cosserat_casadi.__path__, "cosserat_casadi."):
        importlib.import_module(module.name)
    kinds = families(CosseratError)
    assert len(kinds) > 10
    for kind in kinds:
        assert kind.page in pages(), kind


@pytest.mark.parametrize(
    ("error", "page"),
    [
        (SceneError(Problem("rods[0].length", "is negative")), "scene"),
        (SceneError(Problem("--plot", "has no suffix")), "command-line"),
        (SceneError(Problem("--plot", "has no suffix"), Problem("rods", "are missing")), "scene"),
        (SceneError(Problem("PAGE", "there is none")), "command-line"),
        (SceneError(Problem("loads.csv, line 2", "is no number"), page="sweeps"), "sweeps"),
        (SceneError(Problem("--samples", "is no number"), page="sweeps"), "command-line"),
        (ExportError(Problem("scene", "cannot be exported")), "c-interface"),
    ],
)
def test_error_ends_with_its_page(error: CosseratError, page: str, capsys: pytest.CaptureFixture[str]) -> None:
    def command(**_: object) -> None:
        raise error

    assert run(command) == 2
    last_line = capsys.readouterr().err.splitlines()[-1]
    assert last_line == f"Help: cosserat docs {page}"


# Versions and completion


def test_version_is_that_of_the_package_and_of_casadi(capsys: pytest.CaptureFixture[str]) -> None:
    assert cosserat("--version") == 0
    printed = capsys.readouterr().out
    assert printed.startswith(f"cosserat_casadi {__version__}, CasADi {ca.__version__}, Python 3.")


def in_shell(home: Path, *arguments: str, **variables: str) -> subprocess.CompletedProcess[str]:
    code = "import sys; sys.argv[0] = 'cosserat'; from cosserat_casadi.cli.main import main; main()"
    # Else typer asks the processes above it which shell they are, and a runner of tests may have none.
    named = {"_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION": "1"}
    environment = {**os.environ, "HOME": str(home), **named, **variables}
    command = [sys.executable, "-c", code, *arguments]
    return subprocess.run(command, cwd=home, env=environment, capture_output=True, text=True, timeout=60, check=False)


def test_completion_is_installed(tmp_path: Path) -> None:
    done = in_shell(tmp_path, "--install-completion", "bash")
    assert done.returncode == 0, done.stderr
    (script,) = (tmp_path / ".bash_completions").iterdir()
    assert "_COSSERAT_COMPLETE=complete_bash" in script.read_text()
    assert str(script) in (tmp_path / ".bashrc").read_text()


@pytest.mark.parametrize(
    ("typed", "offered"),
    [("cosserat sol", ["solve"]), ("cosserat new robot.toml --template w", ["wire"])],
)
def test_completion_offers_commands_and_values(typed: str, offered: list[str], tmp_path: Path) -> None:
    position = str(len(typed.split()) - 1)
    done = in_shell(tmp_path, _COSSERAT_COMPLETE="complete_bash", COMP_WORDS=typed, COMP_CWORD=position)
    assert done.stdout.split() == offered, done.stderr
