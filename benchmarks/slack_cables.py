"""How often robots of three cables of given lengths are solved, with cables that may go slack and without.

Lengths are those of stable equilibria under random tensions from 0.2 to 10 N, so that every cable is taut in the end.
Prints the solves that ended without an equilibrium, and the Newton steps of the others.

    python benchmarks/slack_cables.py --count 60
"""

from __future__ import annotations

import argparse
from typing import Any

import numpy as np

from cosserat_casadi import Solution, build, scene_from_dict, solve

ROD = {
    "name": "rod",
    "length": 0.25,
    "strain": "reissner",
    "material": {"youngs_modulus": 60e9, "poisson_ratio": 0.33},
    "section": {"shape": "circle", "radius": 0.6e-3},
}
OFFSET = 8e-3
"""Distance of the cables from the axis, m."""


def solved(cables: list[dict[str, Any]]) -> Solution:
    """The equilibrium under three parallel cables, each with a tension or a length."""
    tendons = []
    for k, cable in enumerate(cables):
        angle = 2 * np.pi * k / 3
        offset = [OFFSET * np.cos(angle), OFFSET * np.sin(angle)]
        tendons.append({"name": f"cable_{k}", "kind": "tendon", "rod": "rod", "offset": offset, **cable})
    return solve(build(scene_from_dict({"schema": 1, "rods": [ROD], "actuators": tendons})))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=60, help="robots to draw")
    count = parser.parse_args().count
    random = np.random.default_rng(1)
    failures = {False: 0, True: 0}
    steps: dict[bool, list[int]] = {False: [], True: []}
    drawn = 0
    for _ in range(count):
        pulled = solved([{"tension": float(tension)} for tension in random.uniform(0.2, 10.0, 3)])
        if not pulled.converged or not pulled.stable:
            continue
        drawn += 1
        lengths = [float(pulled.actuator(f"cable_{k}")["length"]) for k in range(3)]
        for slack in (False, True):
            held = solved([{"length": length, "slack": slack} for length in lengths])
            if held.converged:
                steps[slack].append(held.iterations)
            else:
                failures[slack] += 1
    print(f"{drawn} stable robots of {count} drawn")
    for slack in (False, True):
        words = "may go slack" if slack else "cannot go slack"
        print(f"cables that {words}: {failures[slack]} without equilibrium, {np.median(steps[slack]):.0f} Newton steps")


if __name__ == "__main__":
    main()
