"""Fixtures shared by all tests: where the reference cases are, and short scenes to build on."""

from __future__ import annotations

from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
CASES = ROOT.parent / "shared" / "cases"


def case_files(folder: str) -> list[Path]:
    """Scene files of the reference cases; none where the cases are not at hand."""
    return sorted((CASES / folder).glob("*.toml"))


@pytest.fixture(scope="session")
def examples() -> list[Path]:
    return sorted((ROOT / "examples").glob("*.toml"))


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--update-generated", action="store_true", help="write the folders in generated/ anew")
