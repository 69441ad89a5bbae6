"""What an exported library may be called, and what is called how in it."""

from __future__ import annotations

import re

import pytest

from cosserat_casadi import ExportError, build, discretise
from cosserat_casadi.codegen.export import folder_files
from cosserat_casadi.codegen.library import comment
from cosserat_casadi.codegen.names import KEYWORDS, LONGEST, TAKEN, Names, library_names
from tests.scenes import push, rod, scene

GOOD = ["finger", "Finger", "f", "F1", "my_2nd_arm", "x" * LONGEST, "integer", "newton", "doubled", "maths"]
BAD = [
    "",
    "2fast",
    "_finger",
    "finger_",
    "my__finger",
    "my finger",
    "my-finger",
    "finger.c",
    "../finger",
    "doigté",
    "ﬁnger",
    "палец",
    "finger\n",
    "finger\x00",
    "x" * (LONGEST + 1),
]


@pytest.mark.parametrize("name", GOOD)
def test_good_names(name: str) -> None:
    assert library_names(name, ("rod",)) == Names(name, ("rod",))


@pytest.mark.parametrize("name", BAD, ids=ascii)
def test_bad_names(name: str) -> None:
    with pytest.raises(ExportError) as caught:
        library_names(name)
    (problem,) = caught.value.problems
    assert problem.where == "--name"
    assert "is no name for a C library" in problem.problem
    assert "such as --name finger" in problem.remedy
    assert str(problem).isprintable()


@pytest.mark.parametrize("word", ["int", "INT", "Class", "restrict", "main", "casadi", "NULLPTR", "template"])
def test_words_of_the_languages(word: str) -> None:
    with pytest.raises(ExportError, match=rf"--name: '{word}' is a word of C or C\+\+ \(use letters"):
        library_names(word)


@pytest.mark.parametrize("word", ["solver", "Solver_Track", "fours", "linear_dense", "motion", "fmi3"])
def test_files_of_the_solver_are_not_overwritten(word: str) -> None:
    with pytest.raises(ExportError, match=rf"--name: '{word}' is what a file of the solver is called"):
        library_names(word)


@pytest.mark.parametrize("word", ["math", "string", "Time", "stdio", "m", "c", "all", "clean", "install"])
def test_names_that_the_tools_have_for_themselves(word: str) -> None:
    """A math.h in the folder would stand in front of that of C; a target called m would be linked with itself."""
    with pytest.raises(ExportError, match=rf"--name: '{word}' is taken by C or its tools \(use letters"):
        library_names(word)


def test_refused_words_are_told_apart() -> None:
    assert not KEYWORDS & TAKEN
    assert {"int", "class", "while"} <= KEYWORDS


def test_rods_are_named_only_where_there_are_several() -> None:
    one, two = Names("lib", ("a",)), Names("lib", ("a", "b"))
    assert one.function("tip", "a") == "lib_tip"
    assert two.function("tip", "a") == "lib_tip_a"
    assert two.function("solve") == "lib_solve"
    assert two.kernel("tip", "b") == "lib_k_tip_b"
    assert two.differentiable("tip", "b") == "lib_f_tip_b"
    assert two.macro == "LIB"


def test_rods_whose_functions_would_have_one_name() -> None:
    assert library_names("lib", ("jacobian_a",))
    assert library_names("lib", ("a", "jacobian_b"))
    for rods in (("a", "jacobian_a"), ("jacobian_a", "a")):
        with pytest.raises(ExportError) as caught:
            library_names("lib", rods)
        (problem,) = caught.value.problems
        assert problem.where == "rods[1].name"
        assert "'jacobian_a'" in problem.problem
        assert problem.remedy == "rename one of the rods"


def test_double_underscores_in_names_of_rods() -> None:
    assert library_names("lib", ("a__b",))
    with pytest.raises(ExportError, match=r"rods\[1\].name: 'a__b' cannot be part of a C symbol"):
        library_names("lib", ("c", "a__b"))


def test_functions_of_bodies_and_actuators() -> None:
    names = library_names("lib", ("a",), actuators=("a",), bodies=("a", "b"))
    assert names.function("actuator", "a") == "lib_actuator_a"
    assert names.kernel("body", "a") == "lib_k_body_a"
    assert names.differentiable("body_jacobian", "b") == "lib_f_body_jacobian_b"


def test_bodies_and_actuators_whose_functions_would_have_one_name() -> None:
    with pytest.raises(ExportError) as caught:
        library_names("lib", ("a",), actuators=("p", "p_n_in"), bodies=("c__d", "b", "jacobian_b"))
    found = [(p.where, p.remedy) for p in caught.value.problems]
    assert found == [
        ("actuators[1].name", "rename one of the actuators"),
        ("bodies[0].name", "without two underscores in a row"),
        ("bodies[2].name", "rename one of the bodies"),
    ]


def test_inputs_that_differ_in_case_alone() -> None:
    assert library_names("lib", ("rod",), ("push.force", "push.moment"))
    with pytest.raises(ExportError, match=r"inputs: 'Push.force' and 'push.force' differ in case alone"):
        library_names("lib", ("rod",), ("push.force", "Push.force"))


def test_every_fault_at_once() -> None:
    with pytest.raises(ExportError) as caught:
        library_names("no name", ("a", "jacobian_a", "b__c"), ("p.force", "P.force"))
    assert [p.where for p in caught.value.problems] == ["--name", "rods[1].name", "rods[2].name", "inputs"]


def test_one_rod_with_an_odd_name_can_be_exported() -> None:
    wanted = scene({**push(), "rod": "a__b_"}, rods=[rod("planar", name="a__b_")])
    files = folder_files(build(wanted, discretise(wanted, 2, 4)), "lib")
    assert "lib_tip(" in files["lib.h"]


def test_no_symbol_stands_outside_the_name() -> None:
    wanted = scene({**push(), "rod": "a"}, rods=[rod("planar", name="a"), rod("planar", name="b")])
    files = folder_files(build(wanted, discretise(wanted, 2, 4)), "lib")
    for name in ("lib.h", "lib_kernels.h"):
        found = re.findall(
            r"^(?:static |const |int |void |char |\*|\w+_status |casadi_\w+ )+(\w+)\(", files[name], re.M
        )
        assert len(found) > 5
        assert all(symbol.startswith("lib_") for symbol in found), found


@pytest.mark.parametrize(
    "title",
    [
        "*/ #error out /*",
        "*\\ #error out",
        "/*/ nested /*",
        "ends in a backslash \\",
        "trigraph ??/",
        "trigraph ??\\",
        "two\nlines\x00\x07\x1b\x7f\u2028",
        "reversed \u202e and isolated \u2066",
    ],
    ids=ascii,
)
def test_titles_cannot_break_a_comment(title: str) -> None:
    written = comment(title)
    assert not re.search(r"\*/|/\*|\\|\?\?/", f" {written}")
    assert written.isprintable()


def test_the_title_stands_in_the_header_as_a_comment() -> None:
    title = "*/ #error out /*"
    wanted = scene(push(), title=title, strain="planar")
    header = folder_files(build(wanted, discretise(wanted, 2, 4)), "lib")["lib.h"]
    assert header.startswith(f"/* {comment(title)}")
    assert title not in header
