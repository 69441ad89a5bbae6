"""A scene whose contact is smooth as the one whose contact is exact: to check what the width has changed."""

from __future__ import annotations

from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.scene.obstacles import SMOOTH_KEYS
from cosserat_casadi.scene.reading import scene_from_dict
from cosserat_casadi.scene.scene import Scene
from cosserat_casadi.scene.writing import scene_tables


def with_exact_contact(scene: Scene) -> Scene:
    """The scene whose obstacles have no width: what solves it finds the contacts themselves.

    Raises:
        SceneError: exact contact of these rods, or of bodies, is not found.
    """
    problems = [
        # Without its bodies an obstacle would concern all rods, or fewer things than before: another scene.
        Problem(f"obstacles[{i}].bodies", "exact contact of bodies is not found", "leave them out, or keep the width")
        for i, obstacle in enumerate(scene.obstacles)
        if obstacle.bodies
    ]
    if problems:
        raise SceneError(*problems)
    tables = scene_tables(scene)
    for obstacle in tables.get("obstacles", []):
        for key in SMOOTH_KEYS:
            obstacle.pop(key, None)
    return scene_from_dict(tables)
