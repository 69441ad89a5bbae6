"""Solve example scenes, simulate those that move: a table for each, result files and figures in a folder.

Without options a handful of them, in less than a minute, and one as C sources; with ``--rest`` all others, in minutes.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path

from cosserat_casadi.cli.main import app, run
from cosserat_casadi.errors import ExportError
from cosserat_casadi.page.webassembly import find_wasm_compiler

HANDFUL = (
    "nitinol_wire",
    "two_section_robot",
    "six_rod_platform",
    "rod_over_bar",
    "finger_to_point",
    "snapping_arch",
)
"""Scenes that show the main job: a wire, a tendon robot, a parallel robot, contact, inputs for a target, a motion."""

EXPORTED = "nitinol_wire"
"""The scene of the handful that C sources are written of."""

SCENES = (
    "planar_strip",
    "nitinol_wire",
    "silicone_finger",
    "follower_reissner",
    "precurved_tube",
    "fishing_rod",
    "loaded_strip",
    "euler_column",
    "deep_arch",
    "tendon_finger",
    "finger_to_point",
    "helical_tendon",
    "two_section_robot",
    "disk_robot",
    "soft_arm",
    "branching_rod",
    "six_rod_platform",
    "magnet_catheter",
    "soft_magnet",
    "needle_in_tissue",
    "rod_in_stream",
    "rubbing_tendon",
    "three_materials",
    "wire_from_shapes",
    "released_strip",
    "rod_on_table",
    "rod_over_bar",
    "wire_in_vessel",
    "robot_leans_on_wall",
    "finger_on_finger",
    "crossing_fingers",
    "felt_loads",
    "concentric_tubes",
    "loaded_tubes",
    "reach_past_bar",
    "felt_contact",
)

WITH_TARGETS = ("finger_to_point", "reach_past_bar")

WITH_MEASUREMENTS = ("wire_from_shapes", "released_strip")

WITH_FELT_LOADS = ("felt_loads", "felt_contact")

MOTIONS = (
    "fishing_rod_cast",
    "tendon_robot_move",
    "shaken_platform",
    "thrown_rod",
    "pendulum_chain",
    "snapping_arch",
    "seaweed",
    "swimmer",
    "snake",
    "gripper",
    "dropped_rod",
    "bouncing_rod",
    "rod_hits_floor",
    "rod_lies_down",
)

SPEEDS = {"fishing_rod_cast": "0.25", "thrown_rod": "0.25"}
"""Of the motions that an animation is drawn of too: drawing one takes longer than computing its motion."""


PROGRAMS = ("design_spring",)
"""Which are no command line, and draw a figure in seconds."""

PAGES = ("nitinol_wire", "two_section_robot", "six_rod_platform")
"""Of which a page is written too, that solves them in a browser, where there is a compiler for it."""


def arguments_of(name: str, folder: Path) -> list[str]:
    """The command line of a scene, whose files go to a folder."""
    command = "solve"
    if name in WITH_TARGETS:
        command = "inverse"
    if name in WITH_MEASUREMENTS:
        command = "identify"
    if name in WITH_FELT_LOADS:
        command = "estimate"
    if name in MOTIONS:
        command = "simulate"
    scene = Path(__file__).with_name(f"{name}.toml")
    arguments = [command, str(scene), "--output", str(folder / f"{name}.json"), "--plot", str(folder / f"{name}.png")]
    if name in SPEEDS:
        arguments += ["--animation", str(folder / f"{name}.gif"), "--speed", SPEEDS[name]]
    return arguments


def page_arguments(name: str, folder: Path) -> list[str]:
    """The command line that writes the page of a scene."""
    scene = Path(__file__).with_name(f"{name}.toml")
    return ["export", str(scene), "--page", str(folder / f"{name}.html")]


def can_write_pages() -> bool:
    """Whether there is a compiler for WebAssembly here."""
    try:
        find_wasm_compiler()
    except ExportError as error:
        print(f"No pages are written: {error}")
        return False
    return True


def export_arguments(name: str, folder: Path) -> list[str]:
    """The command line that writes a scene as C sources."""
    scene = Path(__file__).with_name(f"{name}.toml")
    return ["export", str(scene), "--output", str(folder / name)]


def command_lines(folder: Path, *, rest: bool) -> list[list[str]]:
    """The command lines of the handful, or of the rest."""
    if not rest:
        return [*(arguments_of(name, folder) for name in HANDFUL), export_arguments(EXPORTED, folder)]
    lines = [arguments_of(name, folder) for name in (*SCENES, *MOTIONS) if name not in HANDFUL]
    if can_write_pages():
        lines += [page_arguments(name, folder) for name in PAGES]
    return lines


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", type=Path, default=Path("out"), help="folder for results and figures")
    parser.add_argument("--rest", action="store_true", help="all scenes but the handful: takes minutes")
    options = parser.parse_args()
    folder: Path = options.output
    folder.mkdir(parents=True, exist_ok=True)
    worst = 0
    for arguments in command_lines(folder, rest=options.rest):
        worst = max(worst, run(lambda arguments=arguments, **options: app(arguments, **options)))
        print()
    for name in PROGRAMS if options.rest else ():
        program = Path(__file__).with_name(f"{name}.py")
        command = [sys.executable, str(program), "--output", str(folder / f"{name}.png")]
        worst = max(worst, subprocess.run(command, check=False).returncode)
        print()
    print(f"Results and figures are in {folder.resolve()}.")
    return worst


if __name__ == "__main__":
    sys.exit(main())
