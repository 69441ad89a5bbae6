"""Measurements and unknowns: what is read and written, and what is refused."""

from __future__ import annotations

import pytest

from cosserat_casadi import SceneError, parse_scene
from cosserat_casadi.scene.measurement_record import overlap
from cosserat_casadi.scene.writing import scene_text

ROD = """\
schema = 1
[[rods]]
name = "wire"
length = 0.2
strain = "kirchhoff"
material = { youngs_modulus = 6e10, poisson_ratio = 0.3 }
section = { shape = "circle", radius = 5e-4 }
[[loads]]
name = "push"
kind = "tip_wrench"
rod = "wire"
force = [0, 0, 0.1]
[[actuators]]
name = "blown"
kind = "chamber"
rod = "wire"
pressure = 1e4
area = 1e-6
"""

MEASURED = """
[[measurements]]
quantity = "position"
file = "shapes.csv"
inputs = { "push.force.z" = "load", "wire.base.position.x" = { column = "x0", scale = 1e-3 }, "push.force.x" = 0.5 }
rod = "wire"
at = "X"
columns = ["x", "", "z"]
sigma = [1e-3, 1e-3, 2e-3]
where = { phase = "rest", number = 2 }
"""

UNKNOWN = """
[[unknowns]]
parameter = "wire.material.youngs_modulus"
lower = 1e9
upper = 1e11
prior = { mean = 6e10, sigma = 1e10 }
[[unknowns]]
input = "push.moment"
per_row = true
[identification]
loss = "huber"
"""


def test_measurements_are_read_and_written() -> None:
    scene = parse_scene(ROD + MEASURED + UNKNOWN)
    assert parse_scene(scene_text(scene)) == scene
    assert hash(scene) == hash(parse_scene(scene_text(scene)))
    assert scene.measurements[0].title == "shapes position"


def test_what_is_unknown_or_set_becomes_an_argument() -> None:
    scene = parse_scene(ROD + MEASURED + UNKNOWN)
    assert scene.parameters == ()
    completed = scene.with_unknowns()
    assert completed.parameters == ("wire.material.youngs_modulus",)
    assert completed.input_names() == ("push.force", "blown.pressure", "wire.base.position", "push.moment")
    listed = parse_scene('parameters = ["wire.material.youngs_modulus"]\n' + ROD + MEASURED + UNKNOWN)
    assert listed.with_unknowns().parameters == completed.parameters


def test_a_measurement_takes_assignments() -> None:
    scene = parse_scene(ROD + MEASURED + UNKNOWN, ["measurements[0].sigma=5e-3", "unknowns[0].lower=2e9"])
    assert scene.measurements[0].sigma == 5e-3
    assert scene.unknowns[0].lower == 2e9


def measured(line: str, instead_of: str) -> str:
    assert instead_of in MEASURED
    return ROD + MEASURED.replace(instead_of, line)


REFUSED = {
    "quantity": (measured('"height"', '"position"'), "measurements[0].quantity", "must be one of 'position', 'pose'"),
    "rod": (measured('rod = "wir"', 'rod = "wire"'), "measurements[0].rod", "no rod is named 'wir'"),
    "nothing": (measured("", 'rod = "wire"\n'), "measurements[0].rod", "missing"),
    "input": (measured("push.forc.z", "push.force.z"), 'measurements[0].inputs."push.forc.z"', "no magnitude 'forc.z'"),
    "owner": (measured("pull.force.z", "push.force.z"), 'inputs."pull.force.z"', "no load, actuator or rod is named"),
    "columns": (measured('["x", "z"]', '["x", "", "z"]'), "measurements[0].columns", "must have 3 columns, got 2"),
    "none": (measured('["", "", ""]', '["x", "", "z"]'), "measurements[0].columns", "names no column"),
    "sigma": (measured("[1e-3, 1e-3]", "[1e-3, 1e-3, 2e-3]"), "measurements[0].sigma", "must be 1 number or 3, got 2"),
    "negative": (measured("-1.0", "[1e-3, 1e-3, 2e-3]"), "measurements[0].sigma", "must be > 0"),
    "at": (measured("1.5", '"X"'), "measurements[0].at", "must be <= 1, got 1.5"),
    "tendon": (
        ROD
        + '[[measurements]]\nquantity = "tension"\nfile = "a.csv"\nactuator = "blown"\ncolumns = ["t"]\nsigma = 1.0\n',
        "measurements[0].actuator",
        "'blown' is no tendon",
    ),
    "parameter": (
        ROD + '[[unknowns]]\nparameter = "wire.material.youngs"\n',
        "unknowns[0].parameter",
        "has no 'youngs'",
    ),
    "twice": (
        ROD + 2 * '[[unknowns]]\nparameter = "wire.length"\n',
        "unknowns[1].parameter",
        "unknowns[0] is 'wire.length' already",
    ),
    "both": (
        ROD + '[[unknowns]]\nparameter = "wire.length"\ninput = "push.force"\n',
        "unknowns[0].input",
        "stands beside parameter",
    ),
    "neither": (ROD + "[[unknowns]]\nlower = 1.0\n", "unknowns[0].parameter", "missing"),
    "per_row": (
        ROD + '[[unknowns]]\nparameter = "wire.length"\nper_row = true\n',
        "unknowns[0].per_row",
        "but its lower or upper is missing",
    ),
    "bounds": (
        ROD + '[[unknowns]]\nparameter = "wire.length"\nlower = 1.0\nupper = 1.0\n',
        "unknowns[0].upper",
        "must be above lower",
    ),
    "set": (
        ROD + MEASURED + '[[unknowns]]\ninput = "push.force"\n',
        "unknowns[0].input",
        "measurements[0] sets 'push.force.z'",
    ),
    "scale": (
        ROD + MEASURED + "scale = [1e-3, 0.0, 1e-3]\n",
        "measurements[0].scale",
        "must not be 0",
    ),
    "name": (
        ROD + 2 * MEASURED.replace("sigma", 'name = "shapes"\nsigma'),
        "measurements[1].name",
        "'shapes' is already the name of measurements[0]",
    ),
    "part": (
        ROD + '[[unknowns]]\ninput = "push.moment.x"\n[[unknowns]]\ninput = "push.moment"\n',
        "unknowns[1].input",
        "'push.moment' and unknowns[0] share numbers",
    ),
    "an_input": (
        ROD + '[[unknowns]]\nparameter = "push.force"\n',
        "unknowns[0].parameter",
        "is an input already",
    ),
    "set_parameter": (
        ROD + MEASURED + '[[unknowns]]\nparameter = "wire.base.position"\n',
        "unknowns[0].parameter",
        "'wire.base.position' would be an input as well: measurements[0] sets 'wire.base.position.x'",
    ),
    "set_listed": (
        'parameters = ["wire.base.position.y"]\n' + ROD + MEASURED + UNKNOWN,
        "parameters[0]",
        "measurements[0] sets 'wire.base.position.x'",
    ),
    "unknown_twice": (
        ROD
        + '[[unknowns]]\nparameter = "wire.base.position.x"\n'
        + '[[unknowns]]\ninput = "wire.base.position.y"\nper_row = true\n',
        "unknowns[0].parameter",
        "unknowns[1] has the input 'wire.base.position.y'",
    ),
    "time": (
        ROD + "[simulation]\nduration = 1.0\n" + MEASURED + "time = 0.5\n",
        "measurements[0].time",
        "names no column, and all rows would be at one time",
    ),
    "time_without_column": (
        ROD + "[simulation]\nduration = 1.0\n" + MEASURED + "time = { scale = 1e-3 }\n",
        "measurements[0].time",
        "names no column, and all rows would be at one time",
    ),
    "loss": (ROD + '[identification]\nloss = "median"\n', "identification.loss", "must be one of 'squares', 'huber'"),
}


@pytest.mark.parametrize("text, where, problem", REFUSED.values(), ids=REFUSED)
def test_faults_are_told_where_they_are(text: str, where: str, problem: str) -> None:
    with pytest.raises(SceneError) as refusal:
        parse_scene(text)
    told = [fault for fault in refusal.value.problems if where in fault.where and problem in fault.problem]
    assert told, str(refusal.value)


def test_coefficients_of_one_load_are_different_numbers() -> None:
    assert overlap("push.force", "push.force.x")
    assert overlap("push.force.x", "push.force.x")
    assert not overlap("push.force.x", "push.force.x.1")
    assert not overlap("push.force.x", "push.force.y")
    assert not overlap("push.force", "push.force_two")
