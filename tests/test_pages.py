"""Pages work when pasted: their commands, their Python, their C; what they link to and name is there."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from importlib.metadata import version
from pathlib import Path

import pytest

from cosserat_casadi.cli.main import LINES
from tests.conftest import ROOT
from tests.pages import BLOCK, DOCS, PAGES, blocks, commands, prose, run_command, run_program, run_python

ELSEWHERE = {
    "guide.md": "test_guide.py",
    "motion.md": "test_guide.py",
    "notebook.md": "test_notebook.py",
    "control.md": "test_control_page.py",
    "sweeps.md": "sweeps/test_page.py",
    "view.md": "view/test_view_page.py",
}
"""Pages that a test of their own runs."""

ONE_PROGRAM = ("extending.md",)
"""Pages whose blocks of Python go on from each other, and register kinds that no other test may meet."""

RUN_HERE = [page for page in PAGES if page.name not in ELSEWHERE]

SLOW_TO_RUN = ("python benchmarks/bench.py", "make ", "pip ")
"""What begins a line that no test runs: it takes minutes, or installs something."""

LONG = (
    "cosserat check examples/nitinol_wire.toml --time",
    "cosserat modes examples/nitinol_wire.toml",
    "cosserat tune examples/nitinol_wire.toml --tolerance",
    "cosserat estimate examples/",
    "cosserat identify examples/wire_from_shapes.toml",
    "cosserat path examples/concentric_tubes.toml",
    "cosserat path examples/euler_column.toml",
    "cosserat solve examples/two_section_robot.toml",
    "cosserat solve examples/magnet_catheter.toml",
    "cosserat simulate examples/seaweed.toml",
    "cosserat simulate examples/snake.toml",
    "cosserat simulate examples/gripper.toml",
    "cosserat simulate examples/swimmer.toml",
    "cosserat solve examples/rod_on_table.toml",
    "cosserat sweep examples/concentric_tubes.toml",
    "cosserat tune examples/nitinol_wire.toml --set",
    "cosserat export examples/tendon_robot_move.toml",
    "cosserat export examples/planar_strip.toml --cuda",
    "cosserat export examples/concentric_tubes.toml",
    "cosserat export examples/rod_over_bar.toml",
    "cosserat inverse examples/reach_past_bar.toml",
    "cosserat path examples/gripper.toml",
    "cosserat path examples/loaded_tubes.toml",
    "cosserat simulate examples/bouncing_rod.toml",
    "cosserat simulate examples/disk_robot.toml",
    "cosserat simulate examples/dropped_rod.toml",
    "cosserat simulate examples/rod_hits_floor.toml",
    "cosserat simulate examples/tendon_robot_move.toml",
    "cosserat solve examples/crossing_fingers.toml",
    "cosserat solve examples/disk_robot.toml",
    "cosserat solve examples/finger_on_finger.toml",
    "cosserat solve examples/robot_leans_on_wall.toml",
    "cosserat solve examples/three_materials.toml",
    "cosserat check examples/three_materials.toml",
)
"""What begins a command that takes many seconds: it is run with the slow tests, and its options have quick tests."""

LONG_PYTHON = {
    "# Without friction a force stands on the rod": "contact/test_contact.py",
    "assert contact.start > touch.contact.start  # it has slid": "paths/test_contact_path.py",
    "by_hand = speed / (": "motion/test_contact_of_free_rods.py",
    "compliance = robot.tip_jacobian": "tubes/test_loaded_tubes.py",
    "solution = solve(scene)  # modes and nodes chosen": "test_readme.py",
    "environment = ReachEnvironment(": "environments/test_reach.py",
    "examples/robot_leans_on_wall.toml": "contact/test_contact_of_assemblies.py",
    'name = "stone"': "contact/test_split_lines.py",
    "examples/finger_on_finger.toml": "contact/test_exact_contact_on_bodies.py",
    "first=down": "contact/test_friction_paths.py",
    "examples/gripper.toml": "contact/test_friction_on_bodies.py",
    "examples/bouncing_rod.toml": "motion/test_exact_contact_in_motion.py",
    "examples/rod_lies_down.toml": "motion/test_rods_that_lie_down.py",
    "found = rod.track(": "codegen/test_contact_in_c.py",
    "table = solve(build(": "contact/test_contact.py",
    "stability_margin(model, parameters=True)": "control/test_margin.py",
    "examples/felt_loads.toml": "estimation/test_estimate.py",
    "snap = path.events[0]": "tubes/test_tube_robots.py",
    "turn = robot.track(": "tubes/test_tubes_in_c.py",
    'load("generated/nitinol_wire")': "codegen/test_load.py",
    "strip.step_sensitivity(": "codegen/test_step_sensitivity.py",
    "wire.parameter_sensitivity(": "codegen/test_parameters_in_c.py",
}
"""What a block holds that takes as long, and the file that has quick tests of it."""

LANGUAGES = {"python", "sh", "toml", "c", "csv", "text"}


def name_of(page: Path) -> str:
    return str(page.relative_to(ROOT))


def of_all(language_or_commands: str) -> list[object]:
    """Every block or command of the pages that are run here, with its page as the name of the test."""
    found = []
    for page in RUN_HERE:
        if page.name in ONE_PROGRAM:
            continue
        texts = commands(page) if language_or_commands == "commands" else blocks(page, language_or_commands)
        found += [pytest.param(text, id=f"{name_of(page)}-{i}") for i, text in enumerate(texts)]
    return found


def python_blocks() -> list[object]:
    """Blocks of Python that tests run, those of many seconds marked slow."""
    return [
        pytest.param(*case.values, id=case.id, marks=pytest.mark.slow if _is_long(case.values[0]) else ())
        for case in of_all("python")
    ]


def _is_long(code: str) -> bool:
    return any(words in code for words in LONG_PYTHON)


def test_every_long_block_is_on_a_page() -> None:
    texts = [text for page in RUN_HERE for text in blocks(page, "python")]
    for words, file in LONG_PYTHON.items():
        assert any(words in text for text in texts), words
        assert (ROOT / "tests" / file).is_file(), file


@pytest.mark.parametrize("code", python_blocks())
def test_python_runs(code: str) -> None:
    if "import mujoco" in code:
        pytest.importorskip("mujoco", reason="MuJoCo is not installed: pip install 'cosserat-casadi[mujoco]'")
    run_python(code)


@pytest.mark.parametrize("name", ONE_PROGRAM)
def test_one_program_runs(name: str) -> None:
    assert commands(DOCS / name) == []
    run_program("\n".join(blocks(DOCS / name, "python")))


def run_lines() -> list[object]:
    """Commands that tests run, those of many seconds marked slow."""
    # What several pages say is run once.
    once = {case.values[0]: case for case in reversed(of_all("commands"))}
    cases = [case for line, case in reversed(once.items()) if not line.startswith(SLOW_TO_RUN)]
    return [
        pytest.param(*case.values, id=case.id, marks=pytest.mark.slow if case.values[0].startswith(LONG) else ())
        for case in cases
    ]


def test_every_long_command_is_on_a_page() -> None:
    lines = [line for page in RUN_HERE for line in commands(page)]
    for beginning in LONG:
        assert any(line.startswith(beginning) for line in lines), beginning


@pytest.mark.parametrize("line", run_lines())
def test_commands_run(line: str, tmp_path: Path) -> None:
    run_command(line, tmp_path)


@pytest.mark.usefixtures("quick_gcc")
def test_exported_folder_is_compiled_as_the_pages_say(tmp_path: Path) -> None:
    pages = (ROOT / "README.md", DOCS / "c-interface.md")
    lines = [line for page in pages for text in blocks(page, "sh") for line in text.splitlines() if "gcc" in line]
    assert len(lines) == len(pages)
    (line,) = set(lines)
    shutil.copytree(ROOT / "generated" / "nitinol_wire", tmp_path / "wire")
    assert line.startswith("(cd wire && ")
    done = subprocess.run(line, shell=True, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["status"] == "converged"


@pytest.mark.parametrize("page", RUN_HERE, ids=name_of)
def test_every_line_of_sh_is_run_or_known_to_be_slow(page: Path) -> None:
    for text in blocks(page, "sh"):
        for line in text.replace("\\\n", " ").splitlines():
            assert line.startswith(("cosserat ", "(cd wire && gcc ", *SLOW_TO_RUN)), line


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_blocks_have_a_language_that_is_run_or_is_no_code(page: Path) -> None:
    for language, text in BLOCK.findall(page.read_text()):
        assert language in LANGUAGES, text


def test_pages_that_are_run_elsewhere_are_there() -> None:
    for page, test in ELSEWHERE.items():
        assert f'"{page}"' in (ROOT / "tests" / test).read_text()


# Links and names


def anchors(page: Path) -> set[str]:
    """Anchors of the headings of a page, as GitHub makes them."""
    headings = re.findall(r"^#+ (.*)$", prose(page), flags=re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


WRITTEN_ELSEWHERE = {"scene.md"}
"""Pages made by a generator, which may not have been run."""


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_links_lead_somewhere(page: Path) -> None:
    for target in re.findall(r"\]\(([^)\s]+)\)", prose(page)):
        if target.startswith("https://"):
            continue
        file, _, anchor = target.partition("#")
        aim = (page.parent / file).resolve() if file else page
        if aim.name in WRITTEN_ELSEWHERE and not aim.exists():
            continue
        assert aim.exists(), target
        if anchor:
            assert anchor in anchors(aim), target


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_files_that_a_page_names_exist(page: Path) -> None:
    """Sources by their path in the package or in the repository."""
    for name in re.findall(r"`([\w/]+/[\w/]*(?:\.py|\.toml|\.json|/))`", prose(page)):
        assert any((root / name).exists() for root in (ROOT, ROOT / "cosserat_casadi")), name


def test_version_is_the_same_everywhere() -> None:
    released = version("cosserat-casadi")
    citation = (ROOT / "CITATION.cff").read_text()
    assert f"\nversion: {released}\n" in citation
    assert f"\n## [{released}]\n" in (ROOT / "CHANGELOG.md").read_text()


def test_citation_is_valid_yaml_with_what_the_format_asks_for() -> None:
    yaml = pytest.importorskip("yaml")
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    assert {"cff-version", "message", "title", "authors"} <= set(citation)
    assert citation["authors"] == [{"name": "cosserat_casadi developers"}]


def test_every_page_is_in_the_table_of_contents() -> None:
    contents = (DOCS / "index.md").read_text()
    for page in DOCS.glob("*.md"):
        assert page.name == "index.md" or f"({page.name})" in contents, page.name


def test_every_load_actuator_and_support_is_on_the_page_of_robots() -> None:
    from cosserat_casadi.scene.actuator_records import ACTUATORS
    from cosserat_casadi.scene.constraint_records import JOINTS, SUPPORTS
    from cosserat_casadi.scene.load_records import LOADS

    page = (DOCS / "robots.md").read_text()
    for kind in (*LOADS.records, *ACTUATORS.records, *SUPPORTS.records, *JOINTS.records):
        assert f"`{kind}`" in page


def test_every_command_is_on_the_page_of_the_command_line() -> None:
    page = (DOCS / "command-line.md").read_text()
    assert len(LINES) == 15
    for name in LINES:
        assert f"| `{name}` |" in page


def test_every_test_that_the_theory_names_exists() -> None:
    tests = "\n".join(path.read_text() for path in (ROOT / "tests").rglob("test_*.py"))
    named = re.findall(r"`(?:tests/[\w/]+\.py::)?(test_\w+)`", (DOCS / "theory.md").read_text())
    assert len(named) > 20
    for name in named:
        assert f"def {name}(" in tests, name
