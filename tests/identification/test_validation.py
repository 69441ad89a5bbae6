"""The experiments of docs/validation.md give what the page says."""

from __future__ import annotations

import re

import pytest
from numpy.testing import assert_allclose

from benchmarks.validation import PAGE, SCENES, STUDIES, marks, pages_tables, validated
from cosserat_casadi.identification.measured_cases import read_cases
from cosserat_casadi.model.build import build
from cosserat_casadi.scene import read_scene

NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[+-]?\d+)?")


def numbers(text: str) -> list[float]:
    return [float(number) for number in NUMBER.findall(text)]


def test_scenes_read_their_data() -> None:
    assert sorted(path.stem for path in SCENES.glob("*.toml")) == sorted(study.name for study in STUDIES)
    scene = read_scene(SCENES / "three_tendon_robot.toml")
    assert len(read_cases(scene, build(scene.with_unknowns()).inputs)) == 77


@pytest.mark.slow
def test_experiments_give_what_the_page_says() -> None:
    page = PAGE.read_text()
    for name, text in pages_tables(validated()).items():
        begin, end = marks(name)
        written = page.split(begin)[1].split(end)[0]
        assert NUMBER.sub("#", written).split() == NUMBER.sub("#", text).split(), name
        # 2 % of a number, and one in its last digit: the ends of intervals depend on rounding most.
        assert_allclose(numbers(text), numbers(written), rtol=0.02, atol=0.02, err_msg=name)
