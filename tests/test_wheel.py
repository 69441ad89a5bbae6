"""Source archive and wheel hold all that a user needs: from the wheel alone, away from the repository."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tarfile
import tomllib
import venv
from pathlib import Path

import pytest
import yaml

from tests.conftest import ROOT

PARTS = ("pyproject.toml", "setup.py", "MANIFEST.in", "README.md", "LICENSE", "cosserat_casadi", "docs", "examples")
"""What of the repository goes into the package."""


def run(*command: str | Path, cwd: Path, path: Path | None = None) -> str:
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    if path is not None:
        environment["PYTHONPATH"] = str(path)
    done = subprocess.run(
        [str(word) for word in command],
        cwd=cwd,
        env=environment,
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel of the unpacked source archive, built with what this environment has."""
    folder = tmp_path_factory.mktemp("build")
    repository = folder / "repository"
    repository.mkdir()
    for part in PARTS:
        source = ROOT / part
        if source.is_dir():
            shutil.copytree(source, repository / part, ignore=shutil.ignore_patterns("__pycache__", "*.gif"))
        else:
            shutil.copyfile(source, repository / part)
    build = f"from setuptools.build_meta import build_sdist; build_sdist({str(folder)!r})"
    run(sys.executable, "-c", build, cwd=repository)
    (archive,) = folder.glob("*.tar.gz")
    with tarfile.open(archive) as unpacked:
        unpacked.extractall(folder / "unpacked", filter="data")
    (source,) = (folder / "unpacked").iterdir()
    build = f"from setuptools.build_meta import build_wheel; build_wheel({str(folder)!r})"
    run(sys.executable, "-c", build, cwd=source)
    (built,) = folder.glob("*.whl")
    return built


def smoke_test(python: Path | str, folder: Path, path: Path | None = None) -> None:
    """Commands of a first hour, by an interpreter that has the wheel, in an empty folder."""
    cosserat = (python, "-c", "from cosserat_casadi.cli.main import main; main()")

    where = run(python, "-c", "import cosserat_casadi as package; print(package.__file__)", cwd=folder, path=path)
    assert not Path(where.strip()).is_relative_to(ROOT / "cosserat_casadi")
    assert "CasADi 3." in run(*cosserat, "--version", cwd=folder, path=path)
    assert "nitinol_wire" in run(*cosserat, "examples", cwd=folder, path=path)
    assert run(*cosserat, "docs", "scene", cwd=folder, path=path).startswith("# The scene file")
    run(*cosserat, "examples", "nitinol_wire", "sweeps/wire_tolerances", "--output", "examples", cwd=folder, path=path)
    run(*cosserat, "new", "robot.toml", "--template", "tendon-robot", cwd=folder, path=path)
    for scene in ("examples/nitinol_wire.toml", "robot.toml"):
        assert "Equilibrium found" in run(*cosserat, "solve", scene, cwd=folder, path=path)
    run(*cosserat, "export", "examples/nitinol_wire.toml", "--output", "wire", cwd=folder, path=path)
    assert (folder / "wire" / "solver.c").exists()


def test_the_conda_recipe_is_that_of_the_package() -> None:
    """Conda writes a space between name and bounds."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    recipe = yaml.safe_load((ROOT / "conda" / "recipe.yaml").read_text())
    wanted = {f"python{project['requires-python']}", *project["dependencies"]}
    assert {entry.replace(" ", "") for entry in recipe["requirements"]["run"]} == wanted
    assert recipe["context"]["version"] == project["version"]
    (command,) = project["scripts"].items()
    assert recipe["build"]["python"]["entry_points"] == [" = ".join(command)]


@pytest.mark.slow
def test_wheel_works_away_from_the_repository(wheel: Path, tmp_path: Path) -> None:
    installed = tmp_path / "installed"
    install = ("-m", "pip", "install", "--quiet", "--no-deps", "--no-index", "--target", installed, wheel)
    run(sys.executable, *install, cwd=tmp_path)
    folder = tmp_path / "empty"
    folder.mkdir()
    smoke_test(sys.executable, folder, installed)


@pytest.mark.slow
def test_wheel_works_in_an_empty_environment(wheel: Path, tmp_path: Path) -> None:
    """Its dependencies are fetched: those that it names are those that it needs."""
    venv.create(tmp_path / "environment", with_pip=True)
    python = tmp_path / "environment" / "bin" / "python"
    run(python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", wheel, cwd=tmp_path)
    folder = tmp_path / "empty"
    folder.mkdir()
    smoke_test(python, folder)
