"""``cosserat export --samples``: at how many points modes and nodes are chosen."""

from __future__ import annotations

import json
from pathlib import Path

from cosserat_casadi.scene.writing import scene_text
from tests.commands import cosserat_line
from tests.scenes import push, scene


def test_modes_are_chosen_at_as_many_points(tmp_path: Path) -> None:
    small = scene(push(force=[0.1, 0.0, 0.0]), strain="planar", inputs=["push.force"], accuracy={"tolerance": 1e-2})
    (tmp_path / "rod.toml").write_text(scene_text(small))
    points = {}
    for count in (1, 12):
        line = f"cosserat export rod.toml --output c{count} --samples {count} --range push.force.x=-0.1:0.1"
        ended = cosserat_line(line, tmp_path)
        assert ended.returncode == 0, ended.stderr
        manifest = json.loads((tmp_path / f"c{count}" / "manifest.json").read_text())
        points[count] = manifest["verified"]["solves"]
    assert points[12] - points[1] >= 22
