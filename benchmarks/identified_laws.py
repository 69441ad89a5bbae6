"""Numbers of material laws, chambers and muscles from made-up positions: half-widths and coverage of their intervals.

python benchmarks/identified_laws.py --drawings 12
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from tests.identification.test_laws import MADE_UP, identified  # noqa: E402

NORMAL = 1.959964
"""Half-width of a 95 % interval of a normal distribution, in standard deviations."""


def main(drawings: Annotated[int, typer.Option(help="Drawings of the noise.")] = 12) -> None:
    """Print the half-widths of 95 % intervals over the true numbers, in per cent, and how many intervals hold these."""
    held = []
    for name, (_, _, true_numbers) in MADE_UP.items():
        for seed in range(drawings):
            found = identified(name, seed)
            truth = np.array([true_numbers[label] for label in found.labels])
            half_widths = NORMAL * found.sigma
            held += (np.abs(found.shared - truth) < half_widths).tolist()
            if seed == 0:
                shares = 100 * half_widths / np.abs(truth)
                print(
                    name, ", ".join(f"{label} {share:.2g} %" for label, share in zip(found.labels, shares, strict=True))
                )
    print(f"{sum(held)} of {len(held)} intervals hold the truth")


if __name__ == "__main__":
    typer.run(main)
