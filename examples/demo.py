"""Solve the example scenes, simulate those that move: a table for each, result files and figures in a folder."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from cosserat_casadi.cli.main import app, run

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
    "soft_arm",
    "branching_rod",
    "six_rod_platform",
    "magnet_catheter",
    "soft_magnet",
    "needle_in_tissue",
    "rod_in_stream",
    "rubbing_tendon",
)

WITH_TARGETS = ("finger_to_point",)

MOTIONS = (
    "fishing_rod_cast",
    "tendon_robot_move",
    "shaken_platform",
    "thrown_rod",
    "snapping_arch",
    "seaweed",
)

SPEEDS = {"fishing_rod_cast": "0.25", "thrown_rod": "0.25"}
"""Of the motions that an animation is drawn of too: drawing one takes longer than computing its motion."""


def arguments_of(name: str, folder: Path) -> list[str]:
    """The command line of a scene, whose files go to a folder."""
    command = "solve"
    if name in WITH_TARGETS:
        command = "inverse"
    if name in MOTIONS:
        command = "simulate"
    scene = Path(__file__).with_name(f"{name}.toml")
    arguments = [command, str(scene), "--output", str(folder / f"{name}.json"), "--plot", str(folder / f"{name}.png")]
    if name in SPEEDS:
        arguments += ["--animation", str(folder / f"{name}.gif"), "--speed", SPEEDS[name]]
    return arguments


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", type=Path, default=Path("out"), help="folder for results and figures")
    folder: Path = parser.parse_args().output
    folder.mkdir(parents=True, exist_ok=True)
    worst = 0
    for name in (*SCENES, *MOTIONS):
        arguments = arguments_of(name, folder)
        worst = max(worst, run(lambda arguments=arguments, **options: app(arguments, **options)))
        print()
    print(f"Results and figures are in {folder.resolve()}.")
    return worst


if __name__ == "__main__":
    sys.exit(main())
