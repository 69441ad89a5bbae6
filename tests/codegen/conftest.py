"""Exported libraries, made once for all tests of the generated C."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest

from tests.codegen.libraries import RECIPES, Exported, exported
from tests.codegen.motions import MovingRecipe


@pytest.fixture(scope="session")
def library(workshop: Path) -> Callable[[str], Exported]:
    """An exported library by the name of its recipe."""

    @cache
    def made(name: str) -> Exported:
        return exported(name, RECIPES[name], workshop)

    return made


@pytest.fixture(scope="session")
def motion_library(workshop: Path) -> Callable[[str], Exported]:
    """An exported library with motions by the name of its family."""

    @cache
    def made(family: str) -> Exported:
        return exported("moving_" + family.replace(" ", "_"), MovingRecipe(family), workshop)

    return made


@pytest.fixture(scope="session")
def export_recipe(workshop: Path) -> Callable[..., Exported]:
    """An exported library of any recipe, with the options of ``exported``."""
    return lambda name, recipe, **options: exported(name, recipe, workshop, **options)
