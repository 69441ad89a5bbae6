"""The scene with exact contact in place of smooth contact, to check the effect of the widths."""

from __future__ import annotations

from cosserat_casadi.scene.obstacle_records import SMOOTH_KEYS
from cosserat_casadi.scene.reading import scene_from_dict
from cosserat_casadi.scene.scene import Scene
from cosserat_casadi.scene.values import names_in
from cosserat_casadi.scene.writing import scene_tables


def with_exact_contact(scene: Scene) -> Scene:
    """The scene with obstacles without widths, for which a solve searches the contacts.

    Raises:
        SceneError: exact contact of these rods is not supported.
    """
    tables = scene_tables(scene)
    gone = set[str]()
    for number, obstacle in enumerate(tables.get("obstacles", [])):
        for key in SMOOTH_KEYS:
            obstacle.pop(key, None)
            gone |= {f"{owner}.{key}" for owner in (obstacle["name"], f"obstacles.{number}", f"obstacles[{number}]")}
    accuracy = tables.get("accuracy", {})
    for discretisation in (accuracy, *accuracy.get("of_rods", [])):
        discretisation.pop("sections", None)
    if scene.parameters:
        left = ([name for name in names_in(names) if name not in gone] for names in scene.parameters)
        tables["parameters"] = [names for names in left if names]
    return scene_from_dict(tables)
