"""Scenes whose pages the tests make, and the programs that run them."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

import cosserat_casadi.page.page as page
from cosserat_casadi import Scene, scene_from_dict
from cosserat_casadi.errors import ExportError
from cosserat_casadi.page.webassembly import find_wasm_compiler
from tests.scenes import rod

HARNESS = Path(__file__).parent / "harness"
ASSETS = Path(page.__file__).parent / "assets"

EXPORT_COMMAND = "cosserat export examples/planar_strip.toml"
"""Of the page on the viewer."""

FEW = {"modes": 2, "nodes": 5}


def finger(strain: str = "kirchhoff") -> Scene:
    """A slim rod, two tendons, a force at the tip with bounds, its weight."""
    tendon = {"kind": "tendon", "rod": "rod", "tension": 1.5, "offset": [0.02, 0.0]}
    return scene_from_dict(
        {
            "schema": 1,
            "title": "A finger </title> & its tendons",
            "accuracy": FEW,
            "rods": [rod(strain)],
            "loads": [
                {"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0.3, 0.0, -0.2]},
                {"name": "weight", "kind": "gravity", "acceleration": [0, 0, -1.5]},
            ],
            "actuators": [
                {"name": "front", **tendon},
                {"name": "side", **tendon, "offset": [0.0, 0.02], "span": [0.0, 0.5], "tension": 0.5},
            ],
            "bounds": [{"input": "push.force", "lower": -3.0, "upper": 4.0}],
        }
    )


def strip() -> Scene:
    """The same in a plane: a compiler is done with it in no time."""
    return finger("planar")


def portal() -> Scene:
    """Two rods, one of them aslant, that carry a plate: a body, joints, multipliers."""
    left = rod(name="left", base={"position": [0.0, 0.0, 0.0]})
    right = rod(name="right", base={"position": [0.3, 0.0, 0.0], "tangent": [0.2, 0.1, 1.0]})
    joints = [
        {"body": "plate", "rod": name, "kind": kind, "position": [x, 0, 0]}
        for name, kind, x in (("left", "fixed", 0.0), ("right", "spherical", 0.3))
    ]
    return scene_from_dict(
        {
            "schema": 1,
            "accuracy": FEW,
            "rods": [left, right],
            "bodies": [{"name": "plate", "mass": 0.1, "centre_of_mass": [0.15, 0, 0.02]}],
            "joints": joints,
            "loads": [
                {"name": "weight", "kind": "gravity", "acceleration": [0, 0, -2.0]},
                {"name": "hand", "kind": "body_wrench", "body": "plate", "force": [0.4, 0.2, 0], "moment": [0, 0, 0.1]},
            ],
        }
    )


def wasm_compiler() -> str:
    """The compiler; the test is skipped where there is none."""
    try:
        return find_wasm_compiler()
    except ExportError as error:
        pytest.skip(str(error))


def run_node(script: str, *arguments: Path) -> Any:
    """What a script of the harness prints, read as JSON; the test is skipped where there is no node."""
    node = shutil.which("node")
    if node is None:
        pytest.skip("node is not installed: apt install nodejs")
    command = [node, str(HARNESS / script), str(ASSETS), *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return json.loads(done.stdout)
