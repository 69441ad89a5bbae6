"""How many equilibria a second the viewer shows in a real browser, and the processor time that each takes.

Each picture waits for the browser's next frame: there are 60 a second at most. Without a graphics card the processor
fills the pixels. Processor time is read from /proc, as Linux has it.
"""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer
from doc_tables import put, table

from cosserat_casadi import read_scene
from cosserat_casadi.accuracy.refine import solve_rods
from cosserat_casadi.view.server import Question, RobotServer
from cosserat_casadi.view.view_session import opened
from tests.browser import browser

PAGE = Path("docs/view.md")
BEGIN, END = "<!-- updates: written by benchmarks/view.py -->", "<!-- end of updates -->"

SCENES = ("planar_strip", "nitinol_wire", "two_section_robot", "six_rod_platform")
WINDOW = {"width": 1100, "height": 700}
"""Pixels of the window."""

LOADING = 120_000
"""Milliseconds that a page may take to open."""

MOVES = 100
PERIOD = 50
"""Moves of one swing of the slider."""

SWEEP = """
async ([moves, period]) => {
  const api = window.robot;
  await api.reset();
  const names = Object.keys(api.inputs);
  const name = names.find((key) => api.inputs[key] !== 0) || names[0];
  const start = api.inputs[name];
  const swing = 0.2 * Math.abs(start) || 0.1;
  let found = 0;
  const began = performance.now();
  for (let i = 0; i < moves; i++) {
    const state = await api.setInput(name, start + swing * Math.sin((2 * Math.PI * i) / period));
    found += state.found ? 1 : 0;
  }
  const { share } = window.scenery.painter.shown;
  return { name, found, seconds: (performance.now() - began) / 1000, share };
}
"""
"""Moves one slider to and fro, each move after the picture of the last one."""


@contextmanager
def served(scene: str) -> Iterator[RobotServer]:
    """A server of a solved example."""
    server = RobotServer(opened(solve_rods(read_scene(f"examples/{scene}.toml"))))
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        yield server
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


def timed_answers(server: RobotServer) -> float:
    """Seconds of processor time that the program takes for one move of the first input that is not zero."""
    desk = server.desk
    model = desk.session.first.model
    inputs = model.pack().tolist()
    moved = next((i for i, value in enumerate(inputs) if value), 0)
    start = inputs[moved]
    began = time.process_time()
    for i in range(MOVES):
        inputs[moved] = start * (1 + 0.1 * (i % 2))
        desk.answer("move", Question(inputs=inputs))
    return (time.process_time() - began) / MOVES


def processor_time() -> float:
    """Seconds of processor time of this program and of all that it has started."""
    parents: dict[int, int] = {}
    seconds: dict[int, float] = {}
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            # What follows the name of the program, which may hold anything.
            words = (folder / "stat").read_text().rsplit(")", 1)[1].split()
        except OSError:
            continue
        process = int(folder.name)
        parents[process] = int(words[1])
        seconds[process] = (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")

    def is_ours(process: int) -> bool:
        while process in parents and process != os.getpid():
            process = parents[process]
        return process == os.getpid()

    return sum(taken for process, taken in seconds.items() if is_ours(process))


def row(scene: str, window: Any) -> tuple[str, ...]:
    """What one example takes: unknowns, answer, pictures a second, processor time and share of the pixels."""
    with served(scene) as server:
        answer = timed_answers(server)
        page = window.new_page(viewport=WINDOW)
        page.goto(server.address, timeout=LOADING)
        page.wait_for_selector("body[data-ready]", timeout=LOADING)
        # In the first pictures the browser compiles, and the page learns how fine they may be.
        page.evaluate(SWEEP, [MOVES, PERIOD])
        before = processor_time()
        swept = page.evaluate(SWEEP, [MOVES, PERIOD])
        taken = (processor_time() - before) / MOVES
        page.close()
        found = swept["found"]
        assert found == MOVES, f"{MOVES - found} moves of {scene} were not found"
        unknowns = server.desk.session.first.model.size
    rate = MOVES / swept["seconds"]
    numbers = f"{1e3 * answer:.2f} ms", f"{rate:.0f}", f"{1e3 * taken:.0f} ms", f"{swept['share']:.1f}"
    return f"`{scene}`, {swept['name']}", str(unknowns), *numbers


def main(
    write: Annotated[bool, typer.Option("--write", help="Put the table into docs/view.md.")] = False,
) -> None:
    """Print updates a second of the viewer."""
    with browser() as window:
        rows = [row(scene, window) for scene in SCENES]
    heads = ("unknowns", "answer", "pictures a second", "processor time of each", "pixels, each way")
    text = table(("scene, moved slider", *heads), rows)
    print(text)
    if write:
        put(PAGE, BEGIN, END, text)


if __name__ == "__main__":
    typer.run(main)
