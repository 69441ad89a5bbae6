"""Ranges of sliders: bounds where the scene has them, else what suits the input."""

from __future__ import annotations

from cosserat_casadi import build, scene_from_dict
from cosserat_casadi.page.ranges import Slider, sliders
from tests.page.pages_made import finger
from tests.scenes import push, rod


def by_name(made: list[Slider]) -> dict[str, Slider]:
    return {f"{slider.input} {slider.label}".strip(): slider for slider in made}


def test_bounds_of_the_scene_are_the_ends() -> None:
    made = by_name(sliders(build(finger())))
    x = made["push.force x"]
    assert (x.value, x.least, x.most, x.unit, x.index) == (0.3, -3.0, 4.0, "N", 0)


def test_without_bounds_an_input_reaches_twice_its_size() -> None:
    made = by_name(sliders(build(finger())))
    # Of a vector the largest entry tells the size of all; a tendon does not push.
    assert (made["weight.acceleration x"].least, made["weight.acceleration x"].most) == (-3.0, 3.0)
    assert (made["front.tension"].least, made["front.tension"].most) == (0.0, 3.0)


def scene_with(inputs: list[str], **changes: object) -> dict[str, object]:
    return {
        "schema": 1,
        "rods": [rod()],
        "loads": [push(force=[0, 0, 0], moment=[0, 0, 0])],
        "inputs": inputs,
        **changes,
    }


def test_inputs_that_are_zero_take_their_size_from_the_rod() -> None:
    made = by_name(sliders(build(scene_from_dict(scene_with(["push.force", "push.moment"])))))
    # EI = 0.7 N m² (torsion is the softest), ℓ = 0.8 m: EI/ℓ² and EI/ℓ, twice of which is the end.
    assert made["push.force y"].most == 2 * 0.7 / 0.8**2
    assert made["push.moment y"].least == -2 * (0.7 / 0.8**2) * 0.8


def test_geometry_moves_about_the_scene_s_own() -> None:
    made = by_name(
        sliders(build(scene_from_dict(scene_with(["rod.length", "rod.base.position", "rod.base.quaternion"]))))
    )
    assert (made["rod.length"].least, made["rod.length"].most) == (0.4, 1.2000000000000002)
    assert (made["rod.base.position x"].least, made["rod.base.position x"].most) == (-0.2, 0.2)
    assert (made["rod.base.quaternion w"].least, made["rod.base.quaternion w"].most) == (-1.0, 1.0)


def test_one_bound_is_kept_and_the_scene_s_value_is_on_the_slider() -> None:
    bounds = [{"input": "push.force", "lower": -0.1}]
    made = by_name(sliders(build(scene_from_dict({**scene_with(["push.force"]), "bounds": bounds}))))
    assert made["push.force x"].least == -0.1
    outside = {"schema": 1, "rods": [rod()], "loads": [push(force=[2.0, 0, 0])]}
    outside["bounds"] = [{"input": "push.force", "lower": -1.0, "upper": 1.0}]
    made = by_name(sliders(build(scene_from_dict(outside))))
    assert (made["push.force x"].least, made["push.force x"].most) == (-1.0, 2.0)
