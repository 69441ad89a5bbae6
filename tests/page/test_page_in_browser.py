"""A page opened in a real browser: it solves, draws, and says how it went."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Solution, build, solve
from cosserat_casadi.page.page import LARGEST, export_page
from tests.browser import PATIENCE, browser
from tests.page.pages_made import strip, wasm_compiler


@pytest.fixture(scope="module")
def solution() -> Solution:
    return solve(build(strip()))


@pytest.fixture(scope="module")
def file(solution: Solution, tmp_path_factory: pytest.TempPathFactory) -> Path:
    wasm_compiler()
    return export_page(solution, tmp_path_factory.mktemp("page") / "strip.html")


@pytest.fixture(scope="module")
def window() -> Iterator[Any]:
    with browser() as opened:
        yield opened


@pytest.fixture(scope="module")
def page_and_faults(window: Any, file: Path) -> tuple[Any, list[str]]:
    """The page, ready, and what it complains of or asks of a network."""
    opened = window.new_page(viewport={"width": 1100, "height": 700})
    faults: list[str] = []
    opened.on("pageerror", lambda error: faults.append(str(error)))
    opened.on("console", lambda message: faults.append(message.text) if message.type == "error" else None)
    opened.on("request", lambda request: faults.append(request.url) if request.url.startswith("http") else None)
    opened.goto(file.as_uri())
    opened.wait_for_selector("body[data-ready]", timeout=PATIENCE)
    return opened, faults


@pytest.fixture
def page(page_and_faults: tuple[Any, list[str]]) -> Iterator[Any]:
    """The page as it opens; a fault fails the test in which it came."""
    opened, faults = page_and_faults
    opened.evaluate("window.robot.reset()")
    yield opened
    assert faults == []


def at_rest(page: Any) -> None:
    """Wait until the stability of the last equilibrium is shown."""
    page.wait_for_function("() => window.robot.stable !== null", timeout=PATIENCE)


def test_it_is_one_small_file_with_the_title_of_the_scene(file: Path, page: Any) -> None:
    assert file.stat().st_size < LARGEST
    assert page.title() == "A finger </title> & its tendons"
    assert page.inner_text("h1") == "A finger </title> & its tendons"


def test_it_opens_at_the_scene_s_own_equilibrium(page: Any, solution: Solution) -> None:
    assert_allclose(page.evaluate("window.robot.tip()"), solution.tip().position, rtol=0, atol=1e-9)
    at_rest(page)
    assert page.evaluate("window.robot.stable") is True
    assert "In equilibrium, stable" in page.inner_text("#status")
    # The picture is not empty: the rod's blue is on it.
    shown = page.evaluate("""() => { const copy = document.createElement("canvas").getContext("2d");
        const source = document.getElementById("canvas");
        window.robot.redraw(); copy.canvas.width = source.width; copy.canvas.height = source.height;
        copy.drawImage(source, 0, 0); const { data } = copy.getImageData(0, 0, source.width, source.height);
        let blue = 0; for (let i = 0; i < data.length; i += 4) blue += data[i + 3] > 200 && data[i + 2] > data[i] + 40;
        return blue; }""")
    assert shown > 500


def test_a_slider_moves_the_tip_to_where_solve_says(page: Any, solution: Solution) -> None:
    slider = page.get_by_label("push.force x, N", exact=True)
    slider.evaluate("(range) => { range.value = 2.5; range.dispatchEvent(new Event('input')); }")
    page.wait_for_function("() => window.robot.inputs['push.force.x'] === 2.5")
    inputs = solution.model.pack({"push.force": [2.5, 0.0, -0.2]})
    expected = solve(solution.model, inputs).tip().position
    assert abs(expected - solution.tip().position).max() > 0.1
    assert_allclose(page.evaluate("window.robot.tip()"), expected, rtol=0, atol=1e-8)
    assert page.get_by_label("push.force x in N, as a number").input_value() == "2.5"


def test_a_script_moves_inputs_by_name(page: Any, solution: Solution) -> None:
    page.evaluate("window.robot.setInput('front.tension', 2.4)")
    page.evaluate("window.robot.setInput('push.force', [0.1, 0.2, 0.3])")
    inputs = solution.model.pack({"front.tension": 2.4, "push.force": [0.1, 0.2, 0.3]})
    expected = solve(solution.model, inputs).tip().position
    assert_allclose(page.evaluate("window.robot.tip('rod')"), expected, rtol=0, atol=1e-8)
    page.evaluate("window.robot.reset()")
    assert page.evaluate("window.robot.inputs['front.tension']") == 1.5


def test_an_equilibrium_that_is_not_found_is_said_in_words(page: Any) -> None:
    text = page.evaluate("window.robot.setInput('push.force', [NaN, 0, 0]).then((state) => state.text)")
    assert "not a finite number" in text
    assert page.get_attribute("#status", "class") == "bad"
    assert "No equilibrium shown" in page.inner_text("#status")


def test_an_unstable_equilibrium_is_said_in_words(page: Any) -> None:
    # Followed straight up to beyond the buckling load, the upright rod stays upright: no real one would.
    page.evaluate("""async () => { for (const [name, value] of [["push.force", [0, 0, 0]], ["front.tension", 0],
        ["side.tension", 0], ["weight.acceleration", [0, 0, 0]], ["push.force", [0, 0, -6.5]]])
        await window.robot.setInput(name, value); }""")
    at_rest(page)
    assert page.evaluate("window.robot.stable") is False
    assert "not stable" in page.inner_text("#status")
    assert page.get_attribute("#status", "class") == "warn"


def test_the_estimated_error_is_that_of_solve_beside_the_tolerance(page: Any, solution: Solution) -> None:
    """Within it at the scene's own inputs, above it where the rod is bent by far."""
    strong = solution.model.pack({"push.force": [4.0, 0.0, -3.0]})
    bent = solve(solution.model, strong).error_estimate
    answers = page.evaluate(
        """async ([asked, own, strong]) => {
        const facts = { ...JSON.parse(document.getElementById("facts").textContent), ...asked };
        const robot = await openRobot(facts);
        await robot.reset(Float64Array.from(own));
        const home = await robot.accuracy();
        await robot.move(Float64Array.from(strong));
        const away = { ...(await robot.accuracy()), error: robot.library.error_estimate() };
        robot.facts = { ...facts, tolerance: null };
        return [home, away, await robot.accuracy()]; }""",
        [{"tolerance": 1e-5, "remedy": "choose them anew."}, solution.inputs.tolist(), strong.tolist()],
    )
    home, away, unasked = answers
    assert home["within"] is True
    assert home["text"] == "Estimated error 1e-6 of the length, asked 1e-5."
    assert away["within"] is False
    assert_allclose(away["error"], bent, rtol=1e-4, atol=0)
    assert away["text"] == "Estimated error 9e-5 of the length, asked 1e-5; choose them anew."
    # Of modes that the scene fixes without a tolerance nothing is asked.
    assert unasked == {"within": None, "text": "", "refines": False}


def test_the_words_turn_amber_above_the_tolerance_and_green_again(window: Any, file: Path, tmp_path: Path) -> None:
    text = file.read_text(encoding="utf-8")
    assert '"tolerance": null' in text
    asked = tmp_path / "asked.html"
    asked.write_text(text.replace('"tolerance": null', '"tolerance": 2e-5'), encoding="utf-8")
    opened = window.new_page()
    opened.goto(asked.as_uri())
    says = "(words) => window.robot && window.robot.status.includes(words)"
    opened.wait_for_function(says, arg="of the length, asked 2e-5.", timeout=PATIENCE)
    assert opened.get_attribute("#status", "class") == "good"
    opened.evaluate("window.robot.setInput('push.force', [4, 0, -3])")
    opened.wait_for_function(says, arg="stable, beyond the tolerance", timeout=PATIENCE)
    assert opened.get_attribute("#status", "class") == "warn"
    assert "of the length, asked 2e-5; the scene fixes its modes" in opened.inner_text("#status")
    opened.evaluate("window.robot.reset()")
    opened.wait_for_function(says, arg="of the length, asked 2e-5.", timeout=PATIENCE)
    assert opened.get_attribute("#status", "class") == "good"
    opened.close()


def test_derivatives_are_drawn_on_request(page: Any, solution: Solution) -> None:
    page.get_by_label("derivatives").check()
    page.wait_for_selector("#labels span")
    words = page.locator(".slider output").all_inner_texts()
    step = 1e-4
    ends = [solve(solution.model, solution.model.pack({"front.tension": 1.5 + sign * step})) for sign in (1, -1)]
    velocity = (ends[0].tip().position - ends[1].tip().position) / (2 * step)
    size = (velocity @ velocity) ** 0.5
    assert words[solution.model.inputs.slices["front.tension"].start] == f"moves it {1000 * size:.3g} mm per N"
    page.get_by_label("derivatives").uncheck()
    page.wait_for_function("() => !document.querySelector('#labels span')")


def test_the_tip_follows_the_hand(page: Any, solution: Solution) -> None:
    def middle() -> tuple[float, float]:
        box = page.locator("#hand").bounding_box()
        return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2

    # A point that the robot can reach.
    page.evaluate("window.robot.setInput('push.force', [1.4, 0, 0.5])")
    aim = middle()
    page.evaluate("window.robot.reset()")
    start = middle()
    assert abs(aim[0] - start[0]) > 40
    page.mouse.move(*start)
    page.mouse.down()
    page.mouse.move(*aim, steps=3)
    page.wait_for_function(
        """([x, y]) => { const box = document.getElementById("hand").getBoundingClientRect();
        return Math.hypot(box.x + box.width / 2 - x, box.y + box.height / 2 - y) < 0.5; }""",
        arg=list(aim),
        timeout=PATIENCE,
    )
    page.mouse.up()
    # It has moved what has bounds, and nothing else; what is drawn is the equilibrium at these inputs.
    inputs, tip = page.evaluate("[window.robot.inputs, window.robot.tip()]")
    assert inputs["front.tension"] == 1.5
    force = [inputs[f"push.force.{axis}"] for axis in "xyz"]
    assert max(abs(value - old) for value, old in zip(force, [0.3, 0.0, -0.2], strict=True)) > 0.05
    expected = solve(solution.model, {"push.force": force}).tip().position
    assert_allclose(tip, expected, rtol=0, atol=1e-8)


def test_a_script_has_the_last_word_over_the_hand(page: Any, solution: Solution) -> None:
    """The hand goes on towards a place that it was led to: an input that is set ends that."""
    box = page.locator("#hand").bounding_box()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.mouse.down()
    page.mouse.move(box["x"] + 150, box["y"] - 150, steps=3)
    page.wait_for_function("() => window.robot.inputs['push.force.x'] !== 0.3", timeout=PATIENCE)
    page.evaluate("window.robot.setInput('push.force', [0.1, 0.2, 0.3])")
    page.mouse.up()
    # As many pictures as the hand would take several steps in.
    page.evaluate("async () => { for (let i = 0; i < 20; i++) await new Promise(requestAnimationFrame); }")
    assert page.evaluate("Object.values(window.robot.inputs)") == list(
        solution.model.pack({"push.force": [0.1, 0.2, 0.3]})
    )


def test_on_a_narrow_screen_nothing_is_wider_than_it(page: Any) -> None:
    page.set_viewport_size({"width": 360, "height": 740})
    assert page.evaluate("document.documentElement.scrollWidth") <= 360
    picture = page.locator("#picture").bounding_box()
    assert picture["width"] == 360
    assert picture["height"] > 300
    # The ring is still at the tip.
    gap = page.evaluate("""async () => { await new Promise(requestAnimationFrame); const { scenery } = window;
        const tip = scenery.onScreen(new THREE.Vector3(...window.robot.tip()));
        const ring = document.getElementById("hand").getBoundingClientRect();
        return Math.hypot(ring.x + ring.width / 2 - tip.x, ring.y + ring.height / 2 - tip.y); }""")
    assert gap < 1.0
    handle = page.get_by_label("push.force x, N", exact=True).bounding_box()
    # A finger finds it.
    assert handle["height"] >= 28
    assert handle["width"] > 150


@pytest.mark.slow
def test_what_moves_is_painted_as_finely_as_there_is_time_for_and_at_rest_in_full(page: Any) -> None:
    page.set_viewport_size({"width": 1100, "height": 700})
    # The picture is looked at when it is painted: before, the last one is shown; after, perhaps the one at rest.
    moved = """async (quality) => { const { painter } = window.scenery; painter.pace.turnTo(quality);
        const painted = new Promise((resolve) => { painter.paintMoving = () => { delete painter.paintMoving;
            painter.paintMoving(); const shown = document.getElementById(quality ? "rough" : "canvas");
            resolve([shown.parentElement.classList.contains("rough"), shown.width / shown.clientWidth]); }; });
        window.robot.setInput("push.force.x", 0.3 + 0.1 * quality); return painted; }"""
    # A browser without a graphics card may be late by itself: the quality is held for these pictures.
    page.evaluate("window.scenery.painter.pace.took = () => {}")
    assert page.evaluate(moved, 0) == [False, 1.0]
    assert page.evaluate(moved, 1) == [True, 1.0]
    assert page.evaluate(moved, 3) == [True, 0.5]
    page.wait_for_function("() => !document.getElementById('picture').classList.contains('rough')", timeout=PATIENCE)
    assert page.evaluate("window.scenery.painter.shown.smooth")
    # However many things move, they are one picture.
    painted = page.evaluate("""async () => { const { painter } = window.scenery; let count = 0;
        painter.paintMoving = () => { count++; Painter.prototype.paintMoving.call(painter); };
        for (let i = 0; i < 5; i++) window.scenery.show("loads", i % 2 === 0);
        await new Promise(requestAnimationFrame); await new Promise(requestAnimationFrame); return count; }""")
    assert painted == 1
