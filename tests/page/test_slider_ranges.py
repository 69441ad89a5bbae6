"""Sliders go over the ranges that modes are chosen for."""

from __future__ import annotations

from numpy.testing import assert_allclose

from cosserat_casadi import build, scene_from_dict
from cosserat_casadi.page.slider_ranges import Slider, sliders
from tests.page.pages_made import finger
from tests.scenes import STIFFNESS, push, rod


def by_name(made: list[Slider]) -> dict[str, Slider]:
    return {f"{slider.input} {slider.label}".strip(): slider for slider in made}


def test_bounds_of_the_scene_are_the_ends() -> None:
    made = by_name(sliders(build(finger())))
    x = made["push.force x"]
    assert (x.value, x.least, x.most, x.unit, x.index) == (0.3, -3.0, 4.0, "N", 0)


def test_without_bounds_the_ends_are_what_modes_are_chosen_for() -> None:
    """A tendon does not push; gravity keeps its size."""
    made = by_name(sliders(build(finger())))
    assert (made["weight.acceleration x"].least, made["weight.acceleration x"].most) == (-1.5, 1.5)
    tendon = made["front.tension"]
    assert_allclose([tendon.least, tendon.most], [0.0, 1.5 + STIFFNESS["bending_y"] / (0.02 * 0.8)], rtol=1e-9, atol=0)


def scene_with(inputs: list[str], **changes: object) -> dict[str, object]:
    return {
        "schema": 1,
        "rods": [rod()],
        "loads": [push(force=[0, 0, 0], moment=[0, 0, 0])],
        "inputs": inputs,
        **changes,
    }


def test_ends_are_those_of_a_choice_and_what_keeps_its_value_there_can_be_moved() -> None:
    """Modes that were chosen for one input alone: the slider of another one goes as far as its scale."""
    accuracy = {"tolerance": 1e-3, "modes": 3, "chosen_for": ["push.force.x=-0.5:0.25"]}
    made = by_name(sliders(build(scene_from_dict(scene_with(["push.force"], accuracy=accuracy)))))
    assert (made["push.force x"].least, made["push.force x"].most) == (-0.5, 0.25)
    force = 2 * STIFFNESS["bending_x"] / 0.8**2
    assert_allclose([made["push.force y"].least, made["push.force y"].most], [-force, force], rtol=1e-9, atol=0)


def test_ends_that_are_asked_for_go_before_those_of_the_scene() -> None:
    """Of modes that the scene fixes too, which are verified there and not chosen."""
    fixed = {"modes": 3, "nodes": 8}
    model = build(scene_from_dict(scene_with(["push.force"], accuracy=fixed, ranges={"push.force": [-3.0, 3.0]})))
    made = by_name(sliders(model, {"push.force.x": (-0.5, 0.25)}))
    assert (made["push.force x"].least, made["push.force x"].most) == (-0.5, 0.25)
    assert (made["push.force y"].least, made["push.force y"].most) == (-3.0, 3.0)


def test_geometry_moves_about_the_scene_s_own() -> None:
    """Lengths and bases by a tenth; a base turns into every direction where it alone holds the rod, else it tilts."""
    inputs = ["rod.length", "rod.base.position", "rod.base.quaternion"]
    made = by_name(sliders(build(scene_from_dict(scene_with(inputs)))))
    for name, ends in (
        ("rod.length", (0.72, 0.88)),
        ("rod.base.position x", (-0.08, 0.08)),
        ("rod.base.quaternion w", (-1.0, 1.0)),
    ):
        assert_allclose([made[name].least, made[name].most], ends, rtol=1e-12, atol=0)
    pinned = [{"rod": "rod", "kind": "pinned", "position": [0.1, 0, 0.7]}]
    made = by_name(sliders(build(scene_from_dict(scene_with(inputs, supports=pinned)))))
    assert_allclose(
        [made["rod.base.quaternion x"].least, made["rod.base.quaternion x"].most], [-0.1, 0.1], rtol=1e-12, atol=0
    )


def test_one_bound_is_kept_and_the_scene_s_value_is_on_the_slider() -> None:
    bounds = [{"input": "push.force", "lower": -0.1}]
    made = by_name(sliders(build(scene_from_dict({**scene_with(["push.force"]), "bounds": bounds}))))
    assert made["push.force x"].least == -0.1
    outside = {"schema": 1, "rods": [rod()], "loads": [push(force=[2.0, 0, 0])]}
    outside["bounds"] = [{"input": "push.force", "lower": -1.0, "upper": 1.0}]
    made = by_name(sliders(build(scene_from_dict(outside))))
    assert (made["push.force x"].least, made["push.force x"].most) == (-1.0, 2.0)
