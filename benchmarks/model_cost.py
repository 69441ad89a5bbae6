"""What a model costs: operations, build time and evaluation time, structure against automatic differentiation.

One Kirchhoff rod with a tip wrench and gravity, four modes a component (12 unknowns), 12 Chebyshev intervals.
Times are CasADi's virtual machine, best of many; read the ratios, machines are noisy.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial

import casadi as ca
import numpy as np
from rich.console import Console
from rich.table import Table

from cosserat_casadi import Model, build, discretise, scene_from_dict

SCENE = {
    "schema": 1,
    "rods": [
        {
            "name": "rod",
            "length": 0.5,
            "strain": "kirchhoff",
            "material": {"youngs_modulus": 200e9, "shear_modulus": 80e9, "density": 8000.0},
            "section": {"shape": "circle", "radius": 1e-3},
        }
    ],
    "loads": [
        {"name": "tip", "kind": "tip_wrench", "rod": "rod", "force": [1.0, 1.5, -0.5], "moment": [0, 0, 0.1]},
        {"name": "weight", "kind": "gravity", "acceleration": [0, 0, -9.81]},
    ],
}


def best(work: Callable[[], object], repeats: int = 200) -> float:
    """Shortest time of a call, s."""
    shortest = np.inf
    for _ in range(repeats):
        begin = time.perf_counter()
        work()
        shortest = min(shortest, time.perf_counter() - begin)
    return shortest


def model_of(transport: str) -> Model:
    scene = scene_from_dict(SCENE)
    return build(scene, discretise(scene, 4, 12, transport))


def derived(transport: str) -> tuple[ca.Function, ca.Function]:
    """Residual and Jacobian of a model that is built anew."""
    model = model_of(transport)
    return model.residual, model.jacobian


def automatic(model: Model) -> ca.Function:
    """Residual and Jacobian by automatic differentiation of the expanded residual."""
    x, p = ca.SX.sym("x", model.size), ca.SX.sym("inputs", model.inputs.size)
    residual = model.residual.expand()(x, p)
    return ca.Function("automatic", [x, p], [ca.jacobian(residual, x), residual])


def main() -> None:
    table = Table(title="12 unknowns, 12 intervals")
    table.add_column("rotation by")
    for heading in ("build, s", "IGM, ops", "residual + Jacobian, ops", "by AD, ops", "residual, µs", "Jacobian, µs"):
        table.add_column(heading, justify="right")
    for transport in ("magnus4", "magnus6", "magnus8"):
        build_time = best(partial(derived, transport), 3)
        model = model_of(transport)
        x, p = 0.1 * np.ones(model.size), model.pack()
        residual, jacobian = model.residual, model.jacobian
        table.add_row(
            transport,
            f"{build_time:.2f}",
            f"{model.operations(model.igm['rod']):,}",
            f"{model.operations(jacobian):,}",
            f"{model.operations(automatic(model)):,}",
            f"{1e6 * best(partial(residual, x, p)):.0f}",
            f"{1e6 * best(partial(jacobian, x, p)):.0f}",
        )
    literal = model_of("permuted")
    x, p = 0.1 * np.ones(literal.size), literal.pack()
    literal_time = best(lambda: literal.residual(x, p), 50)
    table.add_row("permuted", "", "", "", "", f"{1e6 * literal_time:.0f}", "")
    Console(width=120).print(table)


if __name__ == "__main__":
    main()
