"""How many equilibria a second the viewer shows in a real browser.

Each picture waits for the browser's next frame: there are 60 a second at most. Without a graphics card the processor
fills the pixels, which a small window shows: the same work but for them.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer

from benchmarks.markdown import put, table
from cosserat_casadi import read_scene, solve_scene
from cosserat_casadi.view.server import RobotServer
from cosserat_casadi.view.session import opened
from tests.browser import browser

PAGE = Path("docs/view.md")
BEGIN, END = "<!-- updates: written by benchmarks/view.py -->", "<!-- end of updates -->"

SCENES = ("planar_strip", "nitinol_wire", "two_section_robot", "six_rod_platform")
WINDOWS = ((1100, 700), (330, 210))
"""Width and height of the windows, px."""

MOVES = 100
PERIOD = 50
"""Moves of one swing of the slider."""

SWEEP = """
async ([moves, period]) => {
  const api = window.robot;
  const names = Object.keys(api.inputs);
  const name = names.find((key) => api.inputs[key] !== 0) || names[0];
  const start = api.inputs[name];
  const swing = 0.2 * Math.abs(start) || 0.1;
  let found = 0;
  const value = (i) => start + swing * Math.sin((2 * Math.PI * i) / period);
  for (let i = 0; i < period; i++) await api.setInput(name, value(i));
  const began = performance.now();
  for (let i = 0; i < moves; i++) found += (await api.setInput(name, value(i))).found ? 1 : 0;
  return [name, found, (performance.now() - began) / 1000];
}
"""
"""Moves one slider to and fro, each move after the picture of the last one."""


@contextmanager
def served(scene: str) -> Iterator[RobotServer]:
    """A server of a solved example."""
    server = RobotServer(opened(solve_scene(read_scene(f"examples/{scene}.toml"))))
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        yield server
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


def timed_answers(server: RobotServer) -> float:
    """Seconds that the program takes for one move of the first input that is not zero."""
    desk = server.desk
    model = desk.session.first.model
    inputs = model.pack().tolist()
    moved = next((i for i, value in enumerate(inputs) if value), 0)
    start = inputs[moved]
    began = time.perf_counter()
    for i in range(MOVES):
        inputs[moved] = start * (1 + 0.1 * (i % 2))
        desk.answer("move", {"inputs": inputs})
    return (time.perf_counter() - began) / MOVES


def row(scene: str, window: Any) -> tuple[str, ...]:
    """Unknowns, seconds of an answer and pictures a second of one example."""
    with served(scene) as server:
        answer = timed_answers(server)
        rates = []
        for width, height in WINDOWS:
            page = window.new_page(viewport={"width": width, "height": height})
            page.goto(server.address)
            page.wait_for_selector("body[data-ready]", timeout=60_000)
            name, found, seconds = page.evaluate(SWEEP, [MOVES, PERIOD])
            page.close()
            assert found == MOVES, f"{MOVES - found} moves of {scene} were not found"
            rates.append(f"{MOVES / seconds:.0f}")
        unknowns = server.desk.session.first.model.size
    return f"`{scene}`, {name}", str(unknowns), f"{1e3 * answer:.2f} ms", *rates


def main(
    write: Annotated[bool, typer.Option("--write", help="Put the table into docs/view.md.")] = False,
) -> None:
    """Print updates a second of the viewer."""
    with browser() as window:
        rows = [row(scene, window) for scene in SCENES]
    rates = [f"pictures a second, {width} × {height} px" for width, height in WINDOWS]
    text = table(("scene, slider that is moved", "unknowns", "answer", *rates), rows)
    print(text)
    if write:
        put(PAGE, BEGIN, END, text)


if __name__ == "__main__":
    typer.run(main)
