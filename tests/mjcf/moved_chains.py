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
