"""Targets and bounds: what is read, and what is refused."""

from __future__ import annotations

import pytest

from cosserat_casadi import SceneError, parse_scene, solve
from cosserat_casadi.scene.writing import scene_text

ROD = """schema = 1
[[rods]]
name = "a"
length = 0.2
strain = "kirchhoff"
stiffness = { bending_x = 1.0, bending_y = 1.0, torsion = 0.8 }
[[loads]]
name = "push"
kind = "tip_wrench"
rod = "a"
force = [0.1, 0, 0]
[[loads]]
name = "wind"
kind = "distributed_wrench"
rod = "a"
force = [[0.1, 0.2], 0, 0]
[[actuators]]
name = "cable"
kind = "tendon"
rod = "a"
tension = 1.0
offset = [0.01, 0]
"""
PLATE = '[[bodies]]\nname = "plate"\n[[joints]]\nkind = "fixed"\nrod = "a"\nbody = "plate"\n'


def target(kind: str, rest: str) -> str:
    return f'[[targets]]\nkind = "{kind}"\n{rest}\n'


def bound(rest: str, name: str = "push.force") -> str:
    return f'[[bounds]]\ninput = "{name}"\n{rest}\n'


GOOD = (
    PLATE
    + target("pose", 'rod = "a"\nposition = [0, 0, 0.2]\nquaternion = [1, 0, 0, 0]')
    + target("position", 'rod = "a"\nat = 0.5\nposition = [0, 0, 0.1]\nweight = 2.0')
    + target("position", 'body = "plate"\nposition = [0, 0, 0.2]')
    + target("curve", 'rod = "a"\nat = [0.5, 1.0]\npoints = [[0, 0, 0.1], [0, 0, 0.2]]')
    + bound("lower = 0.0", "cable.tension")
    + bound("lower = [-1, -1, 0]\nupper = 1.0")
    + bound("lower = [-1, -1, 0, 0, 0, 0]\nupper = 1.0", "wind.force")
)


def refusals(*parts: str) -> list[tuple[str, str]]:
    with pytest.raises(SceneError) as refused:
        parse_scene(ROD + "\n".join(parts))
    return [(problem.where, problem.problem) for problem in refused.value.problems]


def test_targets_and_bounds_are_read_and_written() -> None:
    scene = parse_scene(ROD + GOOD)
    assert [one.kind for one in scene.targets] == ["pose", "position", "position", "curve"]
    assert [one.weight for one in scene.targets] == [1.0, 2.0, 1.0, 1.0]
    assert scene.targets[0].at == 1.0
    assert scene.bounds[1].lower == (-1.0, -1.0, 0.0)
    assert parse_scene(scene_text(scene)) == scene


def test_targets_do_not_act() -> None:
    with_targets = solve(parse_scene(ROD + GOOD.removeprefix(PLATE).replace('body = "plate"', 'rod = "a"')))
    assert (with_targets.x == solve(parse_scene(ROD)).x).all()


POSITION = "position = [0, 0, 0.2]"
REFUSED = {
    "kind": (target("place", POSITION), "targets[0].kind", "must be one of 'pose', 'position', 'curve', got 'place'"),
    "neither": (target("position", POSITION), "targets[0].rod", "missing"),
    "both": (PLATE + target("position", f'rod = "a"\nbody = "plate"\n{POSITION}'), "targets[0].body", "beside rod"),
    "body_at": (PLATE + target("position", f'body = "plate"\nat = 0.5\n{POSITION}'), "targets[0].at", "is for a rod"),
    "rod": (target("position", f'rod = "b"\n{POSITION}'), "targets[0].rod", "no rod is named 'b'"),
    "body": (target("position", f'body = "b"\n{POSITION}'), "targets[0].body", "no body is named 'b'"),
    "no_quaternion": (target("pose", f'rod = "a"\n{POSITION}'), "targets[0].quaternion", "missing"),
    "quaternion": (
        target("pose", f'rod = "a"\n{POSITION}\nquaternion = [1, 1, 0, 0]'),
        "targets[0].quaternion",
        "must have norm 1",
    ),
    "at": (target("position", f'rod = "a"\nat = 1.5\n{POSITION}'), "targets[0].at", "must be <= 1, got 1.5"),
    "weight": (target("position", f'rod = "a"\nweight = 0\n{POSITION}'), "targets[0].weight", "must be > 0, got 0"),
    "unknown": (target("position", f'rod = "a"\nspeed = 0\n{POSITION}'), "targets[0].speed", "unknown key"),
    "points": (
        target("curve", 'rod = "a"\nat = [0.5, 1.0]\npoints = [[0, 0, 0.1]]'),
        "targets[0].points",
        "must have one point for each of 2 sections, got 1",
    ),
    "no_points": (target("curve", 'rod = "a"\nat = []\npoints = []'), "targets[0].at", "at least one entry"),
    "input": (bound("lower = 0", "pull.force"), "bounds[0].input", "'pull.force' is not free at run time"),
    "baked": (bound("lower = 0", "push.moment"), "bounds[0].input", "'push.moment' is not free at run time"),
    "no_side": (bound(""), "bounds[0].lower", "missing"),
    "crossed": (bound("lower = 1\nupper = 0"), "bounds[0].upper", "must not be below lower"),
    "crossed_in_one": (bound("lower = [0, 0, 1]\nupper = [1, 1, 0]"), "bounds[0].upper", "must not be below lower"),
    "crossed_mixed": (bound("lower = 0\nupper = [1, -1, 1]"), "bounds[0].upper", "must not be below lower"),
    "counts": (bound("lower = [0, 0]\nupper = [1, 1, 1]"), "bounds[0].upper", "as many entries as lower, 2, got 3"),
    "count": (bound("lower = [0, 0]"), "bounds[0].lower", "must have 1 number or 3, got 2"),
    "count_of_coefficients": (bound("lower = [0, 0, 0]", "wind.force"), "bounds[0].lower", "1 number or 6, got 3"),
    "count_of_a_number": (bound("lower = [0, 0]", "cable.tension"), "bounds[0].lower", "must have 1 number, got 2"),
    "twice": (bound("lower = 0") + bound("upper = 1"), "bounds[1].input", "bounds[0] bounds 'push.force' already"),
    "text": (bound("lower = 'none'"), "bounds[0].lower", "must be a number, got 'none'"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refusals(case: str) -> None:
    text, where, problem = REFUSED[case]
    assert any(w == where and problem in p for w, p in refusals(text)), refusals(text)


def test_all_faults_come_at_once() -> None:
    told = refusals(target("position", POSITION), bound("lower = 1\nupper = 0"), bound("lower = 0", "pull.force"))
    assert [where for where, _ in told] == ["targets[0].rod", "bounds[0].upper", "bounds[1].input"]
