"""Scenes that become chains: in space, sheared, pulled by cables, jointed."""

from __future__ import annotations

ROD = """
[[rods]]
name = "{name}"
length = 0.3
strain = "{strain}"
material = {{ youngs_modulus = 2e9, poisson_ratio = 0.4, density = 1100.0 }}
section = {{ shape = "circle", radius = [4e-3, 3e-3] }}
"""
FINGER = "schema = 1\n[accuracy]\nmodes = 6\nnodes = 10\n" + ROD.format(name="finger", strain="kirchhoff")
WEIGHT = '[[loads]]\nname = "weight"\nkind = "gravity"\nacceleration = [1.0, 2.0, -9.81]\n'
WRENCH = """
[[loads]]
name = "push"
kind = "{kind}"
rod = "finger"
force = [0.5, 0.3, -0.2]
moment = [0.0, 0.02, 0.03]
frame = "{frame}"
"""

SCENES = {
    "in space": FINGER + "base = { tangent = [1, 0, 0] }\n" + WEIGHT + WRENCH.format(kind="tip_wrench", frame="world"),
    "sheared and curved": FINGER.replace("kirchhoff", "reissner").replace("2e9", "2e6")
    + "intrinsic = { curvature = [2.0, [0, 1.0], 3.0] }\n"
    + WRENCH.format(kind='point_wrench"\nat = 0.6 # "', frame="body")
    .replace("0.5", "2e-4")
    .replace("0.3,", "1e-4,")
    .replace("-0.2", "-1e-4")
    .replace("0.02", "2e-5")
    .replace("0.03", "2e-5"),
    "pulled": FINGER
    + WEIGHT
    + """
[[disks]]
rod = "finger"
count = 4
mass = 5e-3
radius = 8e-3
thickness = 3e-3
[[actuators]]
name = "east"
kind = "tendon"
rod = "finger"
tension = 4.0
offset = [7e-3, 0.0]
routing = "disks"
[[actuators]]
name = "round"
kind = "tendon"
rod = "finger"
tension = 2.0
helix = { radius = 5e-3, turns = 0.4 }
span = [0.0, 0.75]
[[actuators]]
name = "channel"
kind = "chamber"
rod = "finger"
pressure = 4e4
area = 2e-5
offset = [0.0, 4e-3]
""",
    "jointed": FINGER
    + WEIGHT
    + ROD.format(name="second", strain="kirchhoff")
    + """
[[joints]]
name = "shoulder"
kind = "revolute"
between = [{ rod = "finger", at = 0.0 }, { world = true, position = [0, 0, 0.1], tangent = [0, 1, 0] }]
axis = [1, 0, 0]
stiffness = 0.5
rest = 0.3
[[joints]]
name = "elbow"
kind = "prismatic"
between = [{ rod = "finger", at = 0.5 }, { rod = "second", at = 0.0 }]
tangent = [1, 0, 0.2]
axis = [1, 1, 0]
stiffness = 40.0
force = 0.3
[[bodies]]
name = "hand"
mass = 0.02
centre_of_mass = [0.0, 0.02, 0.0]
inertia = [4e-6, 5e-6, 6e-6]
[[joints]]
name = "wrist"
kind = "revolute"
body = "hand"
rod = "second"
position = [0.01, 0.0, 0.0]
axis = [0, 1, 1]
stiffness = 0.05
rest = -0.2
moment = 0.01
[[loads]]
name = "grip"
kind = "body_wrench"
body = "hand"
force = [0.1, 0.0, 0.1]
position = [0.0, 0.03, 0.0]
""",
}

LOOPS = {
    # Unloaded, the coupler stands upright: the loop is open by its length.
    "slider-crank": "schema = 1\n[accuracy]\nmodes = 6\nnodes = 10\n"
    + ROD.format(name="coupler", strain="planar")
    + "damping = { retardation_time = 0.01 }\n"
    + WEIGHT
    + """
[[bodies]]
name = "arm"
mass = 0.2
inertia = [1e-3, 1e-3, 1e-3]
[[bodies]]
name = "slider"
mass = 0.2
inertia = [1e-3, 1e-3, 1e-3]
[[joints]]
name = "crank"
kind = "revolute"
axis = [0, 1, 0]
angle = 0.3
between = [{ world = true, position = [0, 0, 0] }, { body = "arm" }]
[[joints]]
name = "pin"
kind = "revolute"
axis = [0, 1, 0]
between = [{ body = "arm", position = [0.1, 0, 0] }, { rod = "coupler", at = 0.0 }]
[[joints]]
name = "end"
kind = "revolute"
axis = [0, 1, 0]
between = [{ rod = "coupler", at = 1.0 }, { body = "slider" }]
[[joints]]
name = "slide"
kind = "prismatic"
axis = [1, 0, 0]
stiffness = 300.0
between = [{ world = true, position = [0.4, 0, 0] }, { body = "slider" }]
[[loads]]
name = "side"
kind = "point_wrench"
rod = "coupler"
at = 0.5
force = [0, 0, -8.0]
""",
    "slide at the tip": FINGER
    + "damping = { retardation_time = 0.01 }\nintrinsic = { curvature = [0.5, 3.0, 0.0] }\n"
    + """
[[joints]]
name = "slide"
kind = "prismatic"
axis = [0, 0, 1]
between = [
    { world = true, position = [0.12, -0.02, 0.26], tangent = [0.6, -0.1, 0.6] },
    { rod = "finger", at = 1.0 },
]
[[loads]]
name = "side"
kind = "point_wrench"
rod = "finger"
at = 0.5
force = [4.0, 2.0, 0]
""",
}
"""Scenes whose joints close loops."""

MOTOR = 'name = "end"\nstiffness = 0.5\nmoment = 0.4\n'
LOOPS["motor in the loop"] = LOOPS["slider-crank"].replace('name = "end"\n', MOTOR)
