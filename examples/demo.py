"""Solve the example scenes: a table for each, result files and figures in a folder."""

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
)

WITH_TARGETS = ("finger_to_point",)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", type=Path, default=Path("out"), help="folder for results and figures")
    folder: Path = parser.parse_args().output
    folder.mkdir(parents=True, exist_ok=True)
    worst = 0
    for name in SCENES:
        scene = Path(__file__).with_name(f"{name}.toml")
        arguments = [
            "inverse" if name in WITH_TARGETS else "solve",
            str(scene),
            "--output",
            str(folder / f"{name}.json"),
            "--plot",
            str(folder / f"{name}.png"),
        ]
        worst = max(worst, run(lambda arguments=arguments, **options: app(arguments, **options)))
        print()
    print(f"Results and figures are in {folder.resolve()}.")
    return worst


if __name__ == "__main__":
    sys.exit(main())
