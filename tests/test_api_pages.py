"""docs/api holds what the docstrings say, and every public name."""

from __future__ import annotations

import importlib.util
import re
from types import ModuleType

import pytest

import cosserat_casadi
import cosserat_casadi.control
import cosserat_casadi.environments
from tests.conftest import ROOT

API = ROOT / "docs" / "api"


@pytest.fixture(scope="module")
def generator() -> ModuleType:
    spec = importlib.util.spec_from_file_location("api_pages", ROOT / "docs" / "api_pages.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    # Dataclasses look their module up.
    import sys

    sys.modules["api_pages"] = module
    spec.loader.exec_module(module)
    return module


def test_pages_are_up_to_date(generator: ModuleType) -> None:
    texts = generator.pages()
    assert sorted(page.name for page in API.glob("*.md")) == sorted(texts), "run make api"
    for name, text in texts.items():
        assert (API / name).read_text() == text, f"{name}: run make api"


def test_every_public_name_is_on_one_page(generator: ModuleType) -> None:
    names = [name for concept in generator.CONCEPTS for name in concept.names]
    assert sorted(names) == sorted(cosserat_casadi.__all__)
    control_names = [name for concept in generator.CONCEPTS for name in concept.control_names]
    assert len(set(control_names)) == len(control_names)
    assert set(control_names) | set(names) >= set(cosserat_casadi.control.__all__)
    assert not set(control_names) & set(names)
    environment_names = [name for concept in generator.CONCEPTS for name in concept.environment_names]
    assert sorted([*environment_names, "REACH"]) == sorted(cosserat_casadi.environments.__all__)


def test_every_entry_says_something(generator: ModuleType) -> None:
    for name, text in generator.pages().items():
        entries = re.split(r"^##+ ", text, flags=re.MULTILINE)[1:]
        assert all(len(entry.split("\n\n")) > 2 for entry in entries), name


def test_docstring_becomes_markdown(generator: ModuleType) -> None:
    def documented() -> None:
        """First ``line`` of :func:`some.name`.

        Args:
            length: of the rod, m,
                unloaded.
            X: abscissa.

        Raises:
            SceneError: it is refused.
        """

    assert generator._docstring(documented) == [
        "First `line` of `some.name`.",
        "**Args**",
        "* `length`: of the rod, m, unloaded.\n* `X`: abscissa.",
        "**Raises**",
        "* `SceneError`: it is refused.",
    ]
