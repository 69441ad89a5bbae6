"""What is printed of a choice of modes where an equilibrium is missing, or an error is not known."""

from __future__ import annotations

from dataclasses import replace
from io import StringIO

import pytest
from rich.console import Console

from cosserat_casadi.accuracy.choose import Choice, choose
from cosserat_casadi.cli.reports.model import print_choice
from cosserat_casadi.equilibrium.answer_error import UNKNOWN
from tests.scenes import push, scene


@pytest.fixture(scope="module")
def choice() -> Choice:
    bent = scene(push(), strain="planar", accuracy={"tolerance": 1e-2})
    return choose(bent, cases=[{"push.force": [force, 0.0, 0.0]} for force in (0.1, 0.2)])


def printed(choice: Choice) -> str:
    """The report in one line."""
    text = StringIO()
    print_choice(Console(file=text, width=200), choice)
    return " ".join(text.getvalue().split())


def test_cases_without_an_equilibrium_are_not_within_the_tolerance(choice: Choice) -> None:
    assert "All 2 load cases are within 0.01." in printed(choice)
    said = printed(replace(choice, without_equilibrium=(choice.worst,)))
    assert "All 1 load cases that have an equilibrium are within 0.01." in said
    assert "No equilibrium was found at 1 load cases" in said


def test_an_error_that_is_not_known_is_no_number(choice: Choice) -> None:
    unknown = replace(choice, error_estimate=UNKNOWN, met=False)
    assert "estimated error not known" in printed(unknown)
    assert "their error is not known. The tolerance is not kept there." in unknown.verified.sentence
