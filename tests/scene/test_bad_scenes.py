"""Every refusal of the scene file: where, what, all at once, and never a traceback."""

import copy
import datetime
import math
import tomllib

import pytest

from cosserat_casadi.errors import SceneError
from cosserat_casadi.scene import Scene, parse_scene, read_scene, scene_from_dict
from cosserat_casadi.scene.faults import LENGTHS, SIZES

JARGON = ("type=", "input_value", "https://", "pydantic", "⟨", "something else", "Traceback", "Input should")

MADE = """
material = { youngs_modulus = 2e9, poisson_ratio = 0.4, density = 1100.0 }
section = { shape = "circle", radius = 2e-3 }
"""


def rod(body=MADE, *, name='"finger"', length="0.2", strain='"kirchhoff"'):
    return f"[[rods]]\nname = {name}\nlength = {length}\nstrain = {strain}\n{body}\n"


def scene(after="", *, rods=None, before=""):
    return f"schema = 1\n{before}\n{rod() if rods is None else rods}\n{after}\n"


SUMMED = "[accuracy]\nmodes = 2\nnodes = 4\nsections = 8\n"
TOUCHING = "[[rod_contacts]]\n{}"
BAR = '[[obstacles]]\nname = "bar"\nkind = "sphere"\ncentre = [0.1, 0.0, 0.1]\nradius = 0.01\n'


def of_rods(name, modes, others='modes = 2\nnodes = 4\nrotation = "magnus4"'):
    own = f'{{ rod = "{name}", modes = {modes}, nodes = 4, rotation = "magnus4" }}'
    return f"[accuracy]\n{others}\nof_rods = [{own}]"


def section(text):
    return scene(rods=rod(f"material = {{ youngs_modulus = 1.0, shear_modulus = 1.0 }}\nsection = {{ {text} }}"))


def material(text):
    return scene(rods=rod(f'material = {{ {text} }}\nsection = {{ shape = "circle", radius = 1.0 }}'))


def stiffness(text, strain='"kirchhoff"', more=""):
    return scene(rods=rod(f"stiffness = {{ {text} }}\n{more}", strain=strain))


def load(text, name="push"):
    return scene(f'[[loads]]\nname = "{name}"\n{text}')


def tip(text):
    return load(f'kind = "tip_wrench"\nrod = "finger"\n{text}')


def support(text, **rods):
    return scene(f'[[supports]]\nrod = "finger"\n{text}', **rods)


def joint(kind, text):
    return scene(f'[[joints]]\nrod = "finger"\nkind = "{kind}"\n{HALF}\naxis = [0, 0, 1]\n{text}')


def actuator_table(text):
    return f"""[[actuators]]\nname = 'cable'\nkind = 'tendon'\nrod = "finger"\n{text}\n"""


def actuator(text):
    return scene(actuator_table(text))


def planar(more="", strain='"planar"'):
    return rod(f"stiffness = {{ bending_y = 1.0, extension = 1.0 }}\n{more}", strain=strain)


GRAVITY = 'kind = "gravity"\nacceleration = [0, 0, -9.81]'
PUSH = '[[loads]]\nname = "push"\nkind = "tip_wrench"\nrod = "finger"\nforce = [1, 0, 0]\n'
HALF = "position = [0.1, 0, 0.1]"

BAD = [
    # name, text, where, a piece of the problem
    ("schema_missing", rod(), "schema", "missing"),
    ("schema_future", "schema = 2\n" + rod(), "schema", "must be 1, got 2"),
    ("schema_true", "schema = true\n" + rod(), "schema", "must be 1, got true"),
    ("schema_text", 'schema = "1"\n' + rod(), "schema", "must be 1, got '1'"),
    ("schema_real", "schema = 1.0\n" + rod(), "schema", "must be 1, got 1.0"),
    ("title_number", scene(before="title = 3"), "title", "must be text, got 3"),
    ("unknown_table", scene("[colour]\nred = 1"), "colour", "unknown key"),
    ("unknown_quoted_key", scene(before='"a b" = 1'), '"a b"', "unknown key"),
    ("unknown_long_key", scene(before=f"{'a' * 100} = 1"), '"' + "a" * 57 + '..."', "unknown key"),
    ("rods_missing", "schema = 1", "rods", "missing"),
    ("rods_empty", "schema = 1\nrods = []", "rods", "at least one"),
    ("rods_table", "schema = 1\n[rods]\nname = 'a'", "rods", "must be a list, got a table"),
    ("rods_numbers", "schema = 1\nrods = [1]", "rods[0]", "must be a table, got 1"),
    ("tolerance_zero", scene("[accuracy]\ntolerance = 0"), "accuracy.tolerance", "must be >= 1e-12, got 0"),
    ("tolerance_large", scene("[accuracy]\ntolerance = 0.5"), "accuracy.tolerance", "must be <= 0.1, got 0.5"),
    ("tolerance_nan", scene("[accuracy]\ntolerance = nan"), "accuracy.tolerance", "must be finite, got nan"),
    ("modes_zero", scene("[accuracy]\nmodes = 0"), "accuracy.modes", "must be >= 1, got 0"),
    ("modes_real", scene("[accuracy]\nmodes = 6.0"), "accuracy.modes", "must be a whole number, got 6.0"),
    ("modes_many", scene("[accuracy]\nmodes = [6, 6, 201]"), "accuracy.modes[2]", "must be <= 200"),
    ("modes_count", scene("[accuracy]\nmodes = [6, 6]"), "accuracy.modes", "got 2 where rods[0] admits 3"),
    ("of_rods_of_no_rod", scene(of_rods("x", 2)), "accuracy.of_rods[0].rod", "no rod is named 'x'"),
    ("of_rods_count", scene(of_rods("finger", [2, 2])), "accuracy.of_rods[0].modes", "got 2 where the rod admits 3"),
    ("of_rods_alone", scene(of_rods("finger", 2, "")), "accuracy.of_rods", "stands without modes, nodes and rotation"),
    ("sections_without_layers", scene(SUMMED), "accuracy.sections", "nothing is summed at sections"),
    ("fibres_of_no_rubber", scene(SUMMED.replace("sections", "fibres")), "accuracy.fibres", "summed over fibres"),
    ("sections_exact", scene(SUMMED + BAR), "accuracy.sections", "no obstacle with a width presses a rod"),
    (
        "sections_of_rod",
        scene(of_rods("finger", "2, sections = 8")),
        "accuracy.of_rods[0].sections",
        "nothing is summed at sections",
    ),
    ("rods_listed", scene(TOUCHING.format("rods = [[1]]\nexact = true")), "rod_contacts[0].rods[0]", "must be text"),
    ("exact_word", scene(TOUCHING.format("rods = ['finger']\nexact = 'no'")), "rod_contacts[0].exact", "true or false"),
    ("modes_empty", scene("[accuracy]\nmodes = []"), "accuracy.modes", "at least one"),
    ("nodes_one", scene("[accuracy]\nnodes = 1"), "accuracy.nodes", "must be >= 2"),
    ("shape_one", scene("[accuracy]\nshape = 1"), "accuracy.shape", "must be true or false, got 1"),
    ("nodes_true", scene("[accuracy]\nnodes = true"), "accuracy.nodes", "must be a whole number, got true"),
    ("nodes_huge", scene(f"[accuracy]\nnodes = 0x{'f' * 6000}"), "accuracy.nodes", "a whole number beyond all range"),
    ("accuracy_number", scene(before="accuracy = 1e-6"), "accuracy", "must be a table, got 1e-06"),
    ("name_missing", scene(rods=rod().replace('name = "finger"', "")), "rods[0].name", "missing"),
    ("name_word", scene(rods=rod(name='"my rod"')), "rods[0].name", "a letter, then letters"),
    ("name_newline", scene(rods=rod(name='"finger\\n"')), "rods[0].name", "a letter, then letters"),
    ("name_twice", scene(rods=rod() * 2), "rods[1].name", "'finger' is already the name of rods[0]"),
    ("length_missing", scene(rods=rod().replace("length = 0.2", "")), "rods[0].length", "missing"),
    ("length_negative", scene(rods=rod(length="-0.2")), "rods[0].length", "must be > 0, got -0.2"),
    ("length_zero", scene(rods=rod(length="0")), "rods[0].length", "must be > 0, got 0"),
    ("length_text", scene(rods=rod(length='"0.2"')), "rods[0].length", "must be a number, got '0.2'"),
    ("length_true", scene(rods=rod(length="true")), "rods[0].length", "must be a number, got true"),
    ("length_infinite", scene(rods=rod(length="inf")), "rods[0].length", "must be finite, got inf"),
    ("length_list", scene(rods=rod(length="[1, 2]")), "rods[0].length", "must be a number, got a list of 2"),
    ("length_date", scene(rods=rod(length="1979-05-27")), "rods[0].length", "must be a number, got a date"),
    ("strain_missing", scene(rods=rod().replace("strain", "#")), "rods[0].strain", "missing"),
    ("strain_unknown", scene(rods=rod(strain='"timoshenko"')), "rods[0].strain", "must be one of 'planar'"),
    ("strain_in_list", scene(rods=rod(strain='["bend"]')), "rods[0].strain[0]", "must be one of 'bending_x'"),
    ("strain_empty", scene(rods=rod(strain="[]")), "rods[0].strain", "at least one"),
    ("strain_twice", scene(rods=rod(strain='["torsion", "torsion"]')), "rods[0].strain[1]", "listed twice"),
    ("basis_unknown", scene(rods=rod('basis = "fourier"' + MADE)), "rods[0].basis", "must be one of 'legendre'"),
    ("elasticity_missing", scene(rods=rod("")), "rods[0].material", "missing"),
    ("material_alone", scene(rods=rod(MADE.split("section")[0])), "rods[0].section", "missing"),
    ("section_alone", scene(rods=rod("section" + MADE.split("section")[1])), "rods[0].material", "missing"),
    ("elasticity_twice", scene(rods=rod(MADE + "stiffness = { bending_x = 1.0, bending_y = 1.0, torsion = 1.0 }")),
     "rods[0].stiffness", "stands beside material and section"),
    ("density_twice", scene(rods=rod(MADE + "linear_density = 1.0")), "rods[0].linear_density", "stands beside"),
    ("modulus_missing", material("poisson_ratio = 0.3"), "rods[0].material.youngs_modulus", "missing"),
    ("modulus_negative", material("youngs_modulus = -1, shear_modulus = 1"),
     "rods[0].material.youngs_modulus", "must be > 0, got -1"),
    ("poisson_missing", material("youngs_modulus = 1"), "rods[0].material.poisson_ratio", "missing"),
    ("poisson_twice", material("youngs_modulus = 1, poisson_ratio = 0.3, shear_modulus = 1"),
     "rods[0].material.shear_modulus", "stands beside poisson_ratio"),
    ("poisson_large", material("youngs_modulus = 1, poisson_ratio = 0.51"),
     "rods[0].material.poisson_ratio", "must be <= 0.5, got 0.51"),
    ("poisson_small", material("youngs_modulus = 1, poisson_ratio = -1"),
     "rods[0].material.poisson_ratio", "must be > -1, got -1"),
    ("density_zero", material("youngs_modulus = 1, shear_modulus = 1, density = 0"),
     "rods[0].material.density", "must be > 0, got 0"),
    ("material_typo", material("youngs_moduls = 1, youngs_modulus = 1, shear_modulus = 1"),
     "rods[0].material.youngs_moduls", "unknown key"),
    ("section_text", scene(rods=rod(MADE.split("section")[0] + 'section = "circle"')),
     "rods[0].section", "must be a table, got 'circle'"),
    ("shape_missing", section("radius = 1.0"), "rods[0].section.shape", "missing"),
    ("shape_unknown", section('shape = "hexagon", radius = 1.0'), "rods[0].section.shape", "must be one of 'circle'"),
    ("shape_list", section("shape = [1], radius = 1.0"), "rods[0].section.shape", "got a list of 1"),
    ("radius_missing", section('shape = "circle"'), "rods[0].section.radius", "missing"),
    ("radius_negative", section('shape = "circle", radius = -0.002'),
     "rods[0].section.radius", "must be > 0, got -0.002"),
    ("radius_taper", section('shape = "circle", radius = [1, 0]'), "rods[0].section.radius[1]", "must be > 0, got 0"),
    ("radius_of_three", section('shape = "circle", radius = [1, 1, 1]'),
     "rods[0].section.radius", "must be a list of 2 numbers, base and tip, got 3"),
    ("radius_of_annulus", section('shape = "annulus", radius = 1, outer_radius = 2, inner_radius = 1'),
     "rods[0].section.radius", "unknown key"),
    ("annulus_inside_out", section('shape = "annulus", outer_radius = [2, 1], inner_radius = [1, 1]'),
     "rods[0].section.inner_radius", "must be < outer_radius at both ends, got 1 in 1"),
    ("annulus_negative", section('shape = "annulus", outer_radius = 1, inner_radius = -1'),
     "rods[0].section.inner_radius", "must be >= 0, got -1"),
    ("rectangle_half", section('shape = "rectangle", width = 1'), "rods[0].section.height", "missing"),
    ("correction_zero", section('shape = "circle", radius = 1, shear_correction = 0'),
     "rods[0].section.shear_correction", "must be > 0"),
    ("stiffness_missing", stiffness("bending_x = 1, bending_y = 1"), "rods[0].stiffness.torsion", "missing"),
    ("stiffness_of_list", stiffness("bending_y = 1", '["bending_y", "extension"]'),
     "rods[0].stiffness.extension", "missing"),
    ("stiffness_zero", stiffness("bending_y = 0", '"planar"'), "rods[0].stiffness.bending_y", "must be > 0, got 0"),
    ("stiffness_typo", stiffness("bending_y = 1, bend_x = 1", '"planar"'), "rods[0].stiffness.bend_x", "unknown key"),
    ("linear_density", stiffness("bending_y = 1", '"planar"', "linear_density = [1, -1]"),
     "rods[0].linear_density[1]", "must be > 0, got -1"),
    ("curvature_short", scene(rods=rod(MADE + "intrinsic = { curvature = [0, 1] }")),
     "rods[0].intrinsic.curvature", "must be a list of 3 components, got 2"),
    ("curvature_empty", scene(rods=rod(MADE + "intrinsic = { curvature = [0, [], 1] }")),
     "rods[0].intrinsic.curvature[1]", "at least one"),
    ("curvature_text", scene(rods=rod(MADE + "intrinsic = { curvature = [0, [1, 'a'], 1] }")),
     "rods[0].intrinsic.curvature[1][1]", "must be a number, got 'a'"),
    ("quaternion_norm", scene(rods=rod(MADE + "base = { quaternion = [1, 1, 0, 0] }")),
     "rods[0].base.quaternion", "must have norm 1, got norm 1.41421356"),
    ("quaternion_three", scene(rods=rod(MADE + "base = { quaternion = [1, 0, 0] }")),
     "rods[0].base.quaternion", "must be a list of 4 numbers, got 3"),
    ("tangent_zero", scene(rods=rod(MADE + "base = { tangent = [0, 0, 0] }")),
     "rods[0].base.tangent", "must not be zero"),
    ("orientation_twice", scene(rods=rod(MADE + "base = { tangent = [1, 0, 0], quaternion = [1, 0, 0, 0] }")),
     "rods[0].base.tangent", "stands beside quaternion"),
    ("base_on_rod", scene(rods=rod(MADE + 'base = { rod = "first", at = 1.0 }')),
     "rods[0].base.rod", "no rod is named 'first'"),
    ("load_without_name", scene(f"[[loads]]\n{GRAVITY}"), "loads[0].name", "missing"),
    ("load_name_twice", load(GRAVITY) + f"[[loads]]\nname = 'push'\n{GRAVITY}", "loads[1].name", "loads[0]"),
    ("load_without_kind", load("rod = 'finger'"), "loads[0].kind", "missing"),
    ("load_kind_unknown", load("kind = 'wind'"), "loads[0].kind", "must be one of 'gravity'"),
    ("load_is_number", scene(before="loads = [1]"), "loads[0]", "must be a table, got 1"),
    ("loads_is_table", scene("[loads]\nname = 'a'"), "loads", "must be a list, got a table"),
    ("load_body_unknown", load("kind = 'body_wrench'\nbody = 'platform'\nforce = [1, 0, 0]"),
     "loads[0].body", "no body is named 'platform'"),
    ("load_rod_unknown", load("kind = 'tip_wrench'\nrod = 'toe'\nforce = [1, 0, 0]"),
     "loads[0].rod", "no rod is named 'toe'"),
    ("load_rod_missing", load("kind = 'tip_wrench'\nforce = [1, 0, 0]"), "loads[0].rod", "missing"),
    ("load_without_wrench", tip(""), "loads[0].force", "missing"),
    ("load_frame", tip("force = [1, 0, 0]\nframe = 'follower'"), "loads[0].frame", "must be one of 'world', 'body'"),
    ("force_short", tip("force = [1, 0]"), "loads[0].force", "must be a list of 3 numbers, got 2"),
    ("force_number", tip("force = 1.0"), "loads[0].force", "must be a list of 3 numbers, got 1.0"),
    ("force_text", tip("force = [1, 'a', 0]"), "loads[0].force[1]", "must be a number, got 'a'"),
    ("force_infinite", tip("force = [1, -inf, 0]"), "loads[0].force[1]", "must be finite, got -inf"),
    ("force_polynomial", tip("force = [1, [1, 2], 0]"), "loads[0].force[1]", "must be a number, got a list of 2"),
    ("force_at", tip("force = [1, 0, 0]\nat = 0.5"), "loads[0].at", "unknown key"),
    ("at_missing", load("kind = 'point_wrench'\nrod = 'finger'\nforce = [1, 0, 0]"), "loads[0].at", "missing"),
    ("at_base", load("kind = 'point_wrench'\nrod = 'finger'\nat = 0\nforce = [1, 0, 0]"), "loads[0].at", "must be > 0"),
    ("at_beyond", load("kind = 'point_wrench'\nrod = 'finger'\nat = 1.1\nforce = [1, 0, 0]"),
     "loads[0].at", "must be > 0 and <= 1, got 1.1"),
    ("gravity_missing", load("kind = 'gravity'"), "loads[0].acceleration", "missing"),
    ("gravity_dangling", load(GRAVITY + "\nrods = ['finger', 'toe']"), "loads[0].rods[1]", "no rod is named 'toe'"),
    ("gravity_twice", load(GRAVITY + "\nrods = ['finger', 'finger']"), "loads[0].rods[1]", "listed twice"),
    ("gravity_nowhere", load(GRAVITY + "\nrods = []"), "loads[0].rods", "at least one"),
    ("gravity_without_density", material("youngs_modulus = 1, shear_modulus = 1") + f"[[loads]]\nname = 'g'\n{GRAVITY}",
     "rods[0].material.density", "missing"),
    ("gravity_without_mass", stiffness("bending_y = 1", '"planar"') + f"[[loads]]\nname = 'g'\n{GRAVITY}",
     "rods[0].linear_density", "missing"),
    ("distributed_empty", load("kind = 'distributed_wrench'\nrod = 'finger'\nforce = [0, 0, []]"),
     "loads[0].force[2]", "at least one"),
    ("support_kind", support(f"kind = 'glued'\n{HALF}"), "supports[0].kind", "must be one of 'clamped', 'pinned'"),
    ("support_rod", support(f"kind = 'pinned'\n{HALF}").replace("rod = \"finger\"", "rod = 'toe'"),
     "supports[0].rod", "no rod is named 'toe'"),
    ("support_position", support("kind = 'pinned'"), "supports[0].position", "missing"),
    ("support_quaternion", support(f"kind = 'clamped'\n{HALF}"), "supports[0].quaternion", "missing"),
    ("support_pinned_pose", support(f"kind = 'pinned'\n{HALF}\nquaternion = [1, 0, 0, 0]"),
     "supports[0].quaternion", "unknown key"),
    ("support_overlap", support(f"kind = 'pinned'\n{HALF}") + f"[[supports]]\nrod = 'finger'\nkind = 'pinned'\n{HALF}",
     "supports[1].rod", "overlapping supports"),
    ("support_too_far", support("kind = 'pinned'\nposition = [0.2, 0, 0.1]"),
     "supports[0].position", "unreachable combination: 0.223606798 m from the base of a rod of 0.2 m"),
    ("support_beyond_all_range", support("kind = 'pinned'\nposition = [1e60, -1e60, 1e60]"),
     "supports[0].position", "unreachable combination"),
    ("support_beyond_all_powers", support("kind = 'pinned'\nposition = [0, 0, -1e308]"),
     "supports[0].position[2]", "must be at most 1e+60 in size, got -1e+308"),
    ("support_out_of_plane", support("kind = 'pinned'\nposition = [0.1, 0.01, 0.1]", rods=planar()),
     "supports[0].position", "unreachable combination: 0.01 m outside the plane"),
    ("support_out_of_turned_plane",
     support("kind = 'pinned'\nposition = [0.1, 0, 0.1]", rods=planar("base = { tangent = [0, 1, 0] }")),
     "supports[0].position", "unreachable combination: 0.1 m outside the plane"),
    ("support_out_of_extensible_plane",
     support("kind = 'pinned'\nposition = [0.1, 0.01, 0.9]", rods=planar(strain='["bending_y", "extension"]')),
     "supports[0].position", "unreachable combination: 0.01 m outside the plane"),
    ("support_turned_out_of_plane",
     support(f"kind = 'clamped'\n{HALF}\nquaternion = [0.8, 0.6, 0, 0]", rods=planar()),
     "supports[0].quaternion", "unreachable combination: turned out of the plane"),
    ("inputs_text", scene(PUSH, before="inputs = 'push.force'"), "inputs", "must be a list, got 'push.force'"),
    ("inputs_number", scene(PUSH, before="inputs = [1]"), "inputs[0]", "must be text, got 1"),
    ("inputs_unknown", scene(PUSH, before="inputs = ['pull.force']"),
     "inputs[0]", "no load, actuator or rod is named 'pull'"),
    ("inputs_undotted", scene(PUSH, before="inputs = ['push']"), "inputs[0]", "must read 'load.field'"),
    ("inputs_no_magnitude", scene(PUSH, before="inputs = ['push.frame']"), "inputs[0]", "no magnitude 'frame'"),
    ("inputs_twice", scene(PUSH, before="inputs = ['push.force', 'push.force']"), "inputs[1]", "listed twice"),
    ("tendon_pushes", actuator("tension = -3.0\noffset = [0, 1]"), "actuators[0].tension", "must be >= 0, got -3.0"),
    ("tendon_without_effort", actuator("offset = [0, 1]"), "actuators[0].tension", "missing"),
    ("tendon_with_both", actuator("tension = 1\nlength = 1\noffset = [0, 1]"), "actuators[0].length",
     "stands beside tension"),
    ("tendon_without_course", actuator("tension = 1"), "actuators[0].offset", "missing"),
    ("tendon_with_two_courses", actuator("tension = 1\noffset = [0, 1]\nhelix = { radius = 1, turns = 1 }"),
     "actuators[0].helix", "stands beside offset"),
    ("tendon_slack", actuator("tension = 1\noffset = [0, 1]\nslack = true"), "actuators[0].slack", "of given length"),
    ("tendon_offset", actuator("tension = 1\noffset = [0, 1, 2]"), "actuators[0].offset", "2 components, x and y"),
    ("tendon_span", actuator("tension = 1\noffset = [0, 1]\nspan = [0.5, 0.5]"), "actuators[0].span",
     "must begin before it ends"),
    ("tendon_beyond", actuator("tension = 1\noffset = [0, 1]\nspan = [0.5, 1.5]"), "actuators[0].span[1]",
     "must be <= 1, got 1.5"),
    ("tendon_helix", actuator("tension = 1\nhelix = { radius = 0, turns = 1 }"), "actuators[0].helix.radius",
     "must be > 0"),
    ("tendon_rod", actuator("tension = 1\noffset = [0, 1]").replace('rod = "finger"', "rod = 'toe'"),
     "actuators[0].rod", "no rod is named 'toe'"),
    ("actuator_kind", actuator("").replace("'tendon'", "'spring'"), "actuators[0].kind",
     "must be one of 'tendon', 'chamber', 'muscle'"),
    ("actuator_named_as_a_load", scene(PUSH + actuator_table("tension = 1\noffset = [0, 1]").replace("cable", "push")),
     "actuators[0].name", "is already the name of loads[0]"),
    ("chamber_area", actuator("pressure = 1\narea = 0").replace("'tendon'", "'chamber'"), "actuators[0].area",
     "must be > 0"),
    ("input_of_the_other_kind",
     scene(actuator_table("tension = 1\noffset = [0, 1]"), before="inputs = ['cable.length']"), "inputs[0]",
     "no magnitude 'length'"),
    ("toml_syntax", "schema = 1\nrods = [\n= 3", "line 3, column 1", "is not TOML: Invalid value"),
    ("toml_unfinished", "schema = ", "end of document", "is not TOML"),
    ("toml_key_twice", "schema = 1\nschema = 1\n", "line 2, column 11", "is not TOML"),
    ("toml_huge_number", "schema = " + "9" * 5000, "", "is not TOML: a number in it is beyond all range"),
    ("toml_deep_list", "schema = " + "[" * 100_000, "", "nested too deeply"),
    ("toml_deep_key", "schema" + ".a" * 100_000 + " = 1", "", "nested too deeply"),
    ("toml_deep_quoted_key", 'schema."a,"' + '."a,"' * 100_000 + " = 1", "", "nested too deeply"),
    ("toml_deep_table", "\n".join(f"[{'.'.join('a' * n)}]" for n in range(1, 3000, 50)), "", "nested too deeply"),
    ("blank", " \n\t\n", "", "is empty"),
]  # fmt: skip

RICH = {
    "schema": 1,
    "title": "everything",
    "inputs": ["push.force", "weight.acceleration", "wind.moment"],
    "accuracy": {"tolerance": 1e-6, "modes": [6, 5, 4], "nodes": 14},
    "rods": [
        {
            "name": "finger",
            "length": 0.2,
            "strain": "kirchhoff",
            "basis": "chebyshev",
            "material": {"youngs_modulus": 2e9, "poisson_ratio": 0.4, "density": 1100},
            "section": {"shape": "annulus", "outer_radius": [2e-3, 1e-3], "inner_radius": 5e-4},
            "intrinsic": {"curvature": [0, [1, 2.0], 0], "tangent": [0, 0, 1]},
            "base": {"position": [0, 0, 0], "quaternion": [1, 0, 0, 0]},
        },
        {
            "name": "thumb",
            "length": 0.3,
            "strain": ["bending_x", "bending_y", "torsion"],
            "stiffness": {"bending_x": 1, "bending_y": [2, 1], "torsion": 1},
            "linear_density": 0.01,
            "base": {"tangent": [1, 1, 0]},
        },
    ],
    "loads": [
        {"name": "weight", "kind": "gravity", "acceleration": [0, 0, -9.81], "rods": ["finger", "thumb"]},
        {"name": "push", "kind": "tip_wrench", "rod": "finger", "force": [1, 0, 0], "frame": "body"},
        {"name": "poke", "kind": "point_wrench", "rod": "thumb", "at": 0.5, "moment": [1, 0, 0]},
        {"name": "wind", "kind": "distributed_wrench", "rod": "thumb", "moment": [1, [0, 1], 0]},
    ],
    "supports": [
        {"rod": "thumb", "kind": "clamped", "position": [0.1, 0, 0.1], "quaternion": [1, 0, 0, 0]},
        {"rod": "finger", "kind": "pinned", "position": [0.1, 0, 0.1], "name": "hook"},
    ],
}

ODD = [
    *(0, -1, 1, 1e-320, 1e308, -1e308, 10**400, 1 << 30_000, math.nan, math.inf, True, "", "x", "finger", "\ud800"),
    *([], [1], [[]], [1, 2, 3], ["a", {}, [1]], [math.nan] * 3, [True] * 4, {}, {"a": 1}, {"kind": []}, {1: 2}),
    *({"name": "finger"}, [{}], [{"name": 1 << 30_000, "kind": 1 << 30_000}], datetime.date(1979, 5, 27)),
]  # fmt: skip


def problems(text):
    with pytest.raises(SceneError) as caught:
        parse_scene(text)
    return caught.value.problems


def assert_plain(error):
    assert error.problems
    for word in JARGON:
        assert word not in str(error)


def test_a_rod_without_strains_has_a_remedy() -> None:
    (problem,) = problems(scene(rods=rod(strain="[]")))
    assert problem.remedy.startswith("name the strains that may change, such as bending_x")


@pytest.mark.parametrize(("text", "where", "piece"), [bad[1:] for bad in BAD], ids=[bad[0] for bad in BAD])
def test_a_bad_scene_is_refused_in_one_place_and_plain_words(text, where, piece):
    with pytest.raises(SceneError) as caught:
        parse_scene(text)
    assert [problem.where for problem in caught.value.problems] == [where]
    assert piece in caught.value.problems[0].problem
    assert caught.value.__cause__ is None
    assert_plain(caught.value)


def test_the_scene_that_the_bad_ones_vary_is_good():
    assert parse_scene(scene()).rods[0].name == "finger"
    assert parse_scene(load(GRAVITY)).loads[0].name == "push"
    assert parse_scene(support(f"kind = 'clamped'\n{HALF}\nquaternion = [0.8, 0, 0.6, 0]", rods=planar())).supports
    assert scene_from_dict(RICH).input_names() == tuple(RICH["inputs"])


def test_five_faults_are_told_at_once_in_the_order_of_the_file():
    text = """
    schema = 1
    inputs = ["pull.force"]
    [accuracy]
    tolerance = -1
    [[rods]]
    name = "finger"
    length = -0.2
    strain = "kirchhoff"
    stiffness = { bending_x = 1.0, bending_y = 1.0 }
    [[loads]]
    name = "push"
    kind = "tip_wrench"
    rod = "toe"
    force = [1, 0, 0]
    """
    where = ["inputs[0]", "accuracy.tolerance", "rods[0].length", "rods[0].stiffness.torsion", "loads[0].rod"]
    assert [problem.where for problem in problems(text)] == where


@pytest.mark.parametrize(
    ("text", "remedy"),
    [
        (section('shape = "circle", radus = 1.0, radius = 1.0'), "did you mean 'radius'?"),
        (scene("[[load]]\nname = 'a'"), "did you mean 'loads'?"),
        (scene("[colour]\nred = 1"), "known: schema, title, inputs"),
        (scene(rods=rod(strain='"kirchof"')), "did you mean 'kirchhoff'?"),
        (scene(rods=rod('section = { shape = "circl", radius = 1e-3 }')), "did you mean 'circle'?"),
        (scene(rods=rod().replace("length = 0.2", "")), "undeformed length, m"),
        (joint("prismatic", "angle = 0.1"), "did you mean 'displacement'?"),
        (joint("revolute", "force = 0.1"), "did you mean 'moment'?"),
        (load("kind = 'tip_wrench'\nrod = 'toe'\nforce = [1, 0, 0]"), "rods: finger"),
        (scene(PUSH, before="inputs = ['pull.force']"), "names: push, finger"),
        (load("kind = 'point_wrench'\nrod = 'finger'\nat = 0.0\nforce = [1, 0, 0]"), "leave it out"),
    ],
)
def test_remedies_name_what_is_known(text, remedy):
    assert remedy in problems(text)[0].remedy


def _spots(value, path=()):
    yield path
    entries = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, entry in entries:
        yield from _spots(entry, (*path, key))


SPOTS = list(_spots(RICH))[1:]
MOST_SPOTS = [spot for index, spot in enumerate(SPOTS) if index % 6]


@pytest.mark.parametrize(
    "spot",
    [*SPOTS[::6], *[pytest.param(spot, marks=pytest.mark.slow) for spot in MOST_SPOTS]],
    ids=lambda path: ".".join(map(str, path)),
)
def test_no_value_anywhere_leads_to_anything_but_a_scene_or_a_plain_refusal(spot):
    for odd in ODD:
        tables = copy.deepcopy(RICH)
        container = tables
        for key in spot[:-1]:
            container = container[key]
        container[spot[-1]] = odd
        try:
            assert isinstance(scene_from_dict(tables), Scene)
        except SceneError as error:
            assert_plain(error)


def test_refused_text_names_its_file(tmp_path):
    file = tmp_path / "deep.toml"
    file.write_text("schema = " + "[" * 100_000, encoding="utf-8")
    with pytest.raises(SceneError, match="nested too deeply") as refusal:
        read_scene(file)
    assert refusal.value.problems[0].where == str(file)


def test_deep_tables_from_python_are_refused():
    deep = []
    for _ in range(100_000):
        deep = [deep]
    with pytest.raises(SceneError, match="nested too deeply"):
        scene_from_dict({"schema": 1, "rods": deep})


@pytest.mark.parametrize("tables", [None, [], 3, "schema = 1"])
def test_what_is_not_a_table_is_refused(tables):
    with pytest.raises(SceneError, match="must be a table"):
        scene_from_dict(tables)


def test_many_faults_are_told_in_good_time():
    names = "".join(f"k{n} = 1\n" for n in range(6_000))
    inputs = ", ".join(f'"k{n}.force"' for n in range(6_000))
    assert len(problems(f"{names}inputs = [{inputs}]\n{scene()}")) == 12_000


@pytest.mark.parametrize(
    ("content", "piece"),
    [
        (b"", "is empty"),
        (b" \n\n", "is empty"),
        (b"\x7fELF\x02\x01\x01\x00\x00\x00", "is not text in UTF-8"),
        (b"title = '\xff\xfe'", "is not text in UTF-8"),
        (b"# \xe9tude\nschema = 1", "is not text in UTF-8"),
        (b"#" * 10_000_000, "is 10.0 MB; a scene is at most 1 MB"),
        (b"#" * 1_000_001, "is 1.1 MB; a scene is at most 1 MB"),
    ],
    ids=["empty", "blank", "binary", "utf16", "latin1", "10MB", "1MB"],
)
def test_a_file_that_is_no_scene_is_refused(tmp_path, content, piece):
    path = tmp_path / "scene.toml"
    path.write_bytes(content)
    with pytest.raises(SceneError) as caught:
        read_scene(path)
    assert [problem.where for problem in caught.value.problems] == [str(path)]
    assert piece in str(caught.value)


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(SceneError, match="no such file"):
        read_scene(tmp_path / "absent.toml")


def test_a_directory_is_refused(tmp_path):
    with pytest.raises(SceneError, match="is a directory"):
        read_scene(tmp_path)


@pytest.mark.parametrize("path", ["a\0b.toml", "x" * 5000])
def test_a_path_that_cannot_be_opened_is_refused(path):
    with pytest.raises(SceneError, match="cannot be read"):
        read_scene(path)


def test_a_large_text_is_refused():
    with pytest.raises(SceneError, match=r"is 2\.0 MB; a scene is at most 1 MB"):
        parse_scene("#" * 2_000_000)


@pytest.mark.parametrize(
    ("override", "where", "piece"),
    [
        ("push.force", "--set push.force", "must read name.field=value"),
        ("=3", "--set =3", "must read name.field=value"),
        ("push.force=[1, 0]", "--set push.force", "must be a list of 3 numbers, got 2"),
        ("push.force=[1, 0, nan]", "--set push.force[2]", "must be finite, got nan"),
        ("push.force[1]='a'", "--set push.force[1]", "must be a number, got 'a'"),
        ("push.force[7]=1", "--set push.force[7]", "there is no '7' to set"),
        ("push.frame=body", "--set push.frame", "'body' is not a TOML value"),
        ("push=3", "--set push", "is a whole table, not one of its values"),
        ("push.frame=", "--set push.frame", "'' is not a TOML value"),
        ("push.forze=[1, 0, 0]", "--set push.forze", "unknown key"),
        ("push.rod='toe'", "--set push.rod", "no rod is named 'toe'"),
        ("pull.force=[1, 0, 0]", "--set pull.force", "no load, actuator, rod, support or table is named 'pull'"),
        ("accuracy.tolerance=0", "--set accuracy.tolerance", "must be >= 1e-12"),
        (
            "accurcy.tolerance=1e-3",
            "--set accurcy.tolerance",
            "rod, support or table is named 'accurcy'",
        ),
        ("finger.sektion.radius=1", "--set finger.sektion.radius", "unknown key"),
        ("finger.length=1\ntitle='x'", "--set finger.length", "is not a TOML value"),
        ("finger..length=1", "--set finger..length", "there is no '' to set"),
        ("finger.length.x=1", "--set finger.length.x", "there is no 'x' to set"),
        # What is shown of a key is short, and moves no cursor.
        ("a" * 5_000 + ".b=1", "--set " + "a" * 57 + "...", "rod, support or table is named 'aaa"),
        ("\x1b[31m.b=1", r"--set \x1b[31m.b", "rod, support or table is named"),
        (r"finger." + "\x1b[31m=1", r"--set finger.\x1b[31m", "unknown key"),
        ("title=" + "[" * 100_000, "--set title", "is not a TOML value"),
        ("title={" + "a." * 100_000 + "b=1}", "--set title", "is not a TOML value"),
    ],
    ids=range(23),
)
def test_a_bad_override_is_refused_where_it_stands(override, where, piece):
    with pytest.raises(SceneError) as caught:
        parse_scene(scene(PUSH), overrides=[override])
    assert [problem.where for problem in caught.value.problems] == [where]
    assert piece in caught.value.problems[0].problem
    assert_plain(caught.value)


@pytest.mark.parametrize(
    ("override", "remedy"),
    [
        # Columns of sweeps are written so.
        ("push.force.x=1", "its entries are push.force[0] to push.force[2]"),
        ("push.force[3]=1", "its entries are push.force[0] to push.force[2]"),
        ("loads[0].force.y=1", "its entries are loads[0].force[0] to loads[0].force[2]"),
        ("loads.pull.force=[1, 0, 0]", "write push.force"),
        ("loads[1].force=[1, 0, 0]", "write push.force"),
        ("rods.length=0.3", "write finger.length"),
        ("finger.length.x=1", "finger.length is one value: write finger.length=…"),
        ("push[1].force=[1, 0, 0]", "push is one table, without entries of numbers: write push.force"),
        ("push[1]=3", "push is one table, without entries of numbers: write push.rod"),
        (
            "joints[0].axis=[1, 0, 0]",
            "the scene has no joints: set all of it, joints=[…], or write it into the scene",
        ),
        ("push=3", "name one of push.rod, push.force"),
        ("pusj.force=3", "did you mean 'push'?"),
        ("zzz.another=3", "the scene has finger, push, and tables such as accuracy.tolerance"),
    ],
)
def test_an_override_of_what_is_not_there_is_told_what_is(override, remedy):
    with pytest.raises(SceneError) as caught:
        parse_scene(scene(PUSH), overrides=[override])
    assert [problem.remedy for problem in caught.value.problems] == [remedy]


def test_an_entry_may_have_the_name_of_its_list():
    row = '[[disks]]\nname = "disks"\nrod = "finger"\ncount = 3\nmass = 1e-3\nradius = 0.01\nthickness = 1e-3\n'
    with pytest.raises(SceneError) as caught:
        parse_scene(scene(row), overrides=["disks[3].mass=1"])
    assert caught.value.problems[0].remedy.endswith("write disks.mass")


@pytest.mark.parametrize("key", ["spacers[1].radius", "disks[1].radius", "disks.radius"])
def test_a_disk_of_a_row_alone_has_no_size_to_set(key):
    disks = {"name": "spacers", "rod": "finger", "count": 3, "mass": 0.0, "radius": 0.01, "thickness": 0.001}
    tendon = {
        "name": "cable",
        "kind": "tendon",
        "rod": "finger",
        "tension": 1.0,
        "offset": [0.01, 0],
        "routing": "disks",
    }
    tables = {**tomllib.loads(scene()), "disks": [disks], "actuators": [tendon]}
    with pytest.raises(SceneError) as caught:
        scene_from_dict(tables, [f"{key}=0.02"])
    (problem,) = caught.value.problems
    assert problem.remedy.endswith("write spacers.radius")
    # Its tendons are not told that there are no disks.
    with pytest.raises(SceneError) as caught:
        scene_from_dict(tables, ["spacers.rim=0.02"])
    assert [problem.problem for problem in caught.value.problems] == ["unknown key"]


def test_bad_overrides_are_told_together_with_the_faults_of_the_file():
    text = scene(PUSH, rods=rod(length="-1"))
    with pytest.raises(SceneError) as caught:
        parse_scene(text, overrides=["pull.force=[1, 0, 0]", "push.force=3"])
    where = ["--set pull.force", "rods[0].length", "--set push.force"]
    assert [problem.where for problem in caught.value.problems] == where


HUGE = 10**400

WITH_RULES = {
    "tubes[0].straight": {"tubes": [{"name": "tube", "straight": HUGE, "curved": 0.1}]},
    "simulation.duration": {"simulation": {"duration": HUGE}},
    "loads[0].field[0]": {"loads": [{"name": "field", "kind": "magnet", "rod": "finger", "field": [HUGE, 0, 0]}]},
    "obstacles[0].width": {"obstacles": [{"name": "bar", "kind": "sphere", "radius": 1.0, "width": HUGE}]},
    "loads[0].velocity": {
        "loads": [{"name": "flow", "kind": "flow", "rod": "finger", "velocity": HUGE}],
        "motions": [{"input": "flow.velocity", "amplitude": [1.0], "frequency": 1.0}],
    },
}
"""Tables whose rules reckon with a number before it is judged, by where the number stands."""


@pytest.mark.parametrize("where", WITH_RULES)
def test_whole_numbers_beyond_all_range_are_refused(where):
    with pytest.raises(SceneError) as caught:
        scene_from_dict({"schema": 1, **WITH_RULES[where]})
    (problem,) = caught.value.problems
    assert problem.where == where
    assert problem.problem == "must be finite, got a whole number beyond all range"


def test_a_whole_number_beyond_all_range_is_refused_at_its_override():
    with pytest.raises(SceneError) as caught:
        parse_scene(scene(), [f"finger.length={HUGE}"])
    (problem,) = caught.value.problems
    assert problem.where == "--set finger.length"


@pytest.mark.parametrize("table", ["rods", "tubes", "joints", "obstacles", "bodies", "loads"])
@pytest.mark.parametrize("key", sorted(LENGTHS))
def test_lengths_beyond_all_powers_are_refused(table, key):
    with pytest.raises(SceneError) as caught:
        scene_from_dict({"schema": 1, table: [{"deeper": {key: [0.0, 1.1e60]}}]})
    (problem,) = caught.value.problems
    assert problem.where == f"{table}[0].deeper.{key}[1]"
    assert problem.remedy == "lengths are in m"


@pytest.mark.parametrize("key", sorted(SIZES))
@pytest.mark.parametrize("value", [1e-320, 1e-61])
def test_sizes_that_are_next_to_nothing_are_refused(key, value):
    with pytest.raises(SceneError) as caught:
        scene_from_dict({"schema": 1, "rods": [{"section": {key: {"base": 1.0, "tip": value}}}]})
    (problem,) = caught.value.problems
    assert problem.where == f"rods[0].section.{key}.tip"
    assert problem.problem == f"must be at least 1e-60, got {value!r}"


def test_numbers_that_are_no_lengths_may_be_of_any_size():
    force = f"{scene()}[[loads]]\nname = 'push'\nkind = 'tip_wrench'\nrod = 'finger'\nforce = [1e300, 0, 0]\n"
    assert parse_scene(force).loads[0].force[0] == 1e300


def test_points_of_a_lumen_with_no_line_through_them_are_refused():
    vessel = {"name": "vessel", "kind": "lumen", "points": [[-1e60, 0, 0], [0, 0, 0.1], [0, 0, 0.2]], "radius": 0.01}
    with pytest.raises(SceneError) as caught:
        scene_from_dict({"schema": 1, "obstacles": [vessel]})
    assert "obstacles[0].points: are 0.1 m apart at the least and 1e+60 m at the most" in str(caught.value)


@pytest.mark.parametrize(
    ("text", "where", "remedy"),
    [
        (load(GRAVITY + "\nrods = []"), "loads[0].rods", "or leave the key out for its default"),
        ("schema = 1\n[[rods]]\n[rods]\n", "line 3, column 6", "each entry of a list has its own [[…]]"),
    ],
)
def test_a_remedy_says_what_to_write(text: str, where: str, remedy: str) -> None:
    with pytest.raises(SceneError) as caught:
        parse_scene(text)
    (problem,) = caught.value.problems
    assert problem.where == where
    assert remedy in problem.remedy


def test_an_obstacle_has_no_name_of_a_rod_that_touches_rods_exactly() -> None:
    """Contacts with either could not be told apart; without such rods the names may be equal."""
    named_alike = BAR.replace('"bar"', '"finger"')
    with pytest.raises(SceneError, match=r"rod_contacts\[0\]: 'finger' is an obstacle too"):
        parse_scene(scene(named_alike + TOUCHING.format("exact = true")))
    parse_scene(scene(named_alike))


def test_a_missing_key_of_a_table_that_an_override_begins_is_named() -> None:
    with pytest.raises(SceneError) as caught:
        parse_scene(scene(), ["simulation.step=1e-3"])
    (problem,) = caught.value.problems
    assert (problem.where, problem.problem) == ("simulation.duration", "missing")
    assert problem.remedy.endswith("--set simulation.step begins this table")
