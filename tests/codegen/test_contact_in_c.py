"""Exact contact in exported C against Python's, along loads that touch, slide, lie down and lift off."""

from __future__ import annotations

import json
import re
import subprocess
from dataclasses import replace
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import ExportError, Solution, build, discretise, export, linearise, load, read_scene, solve
from cosserat_casadi.accuracy.verified import Verified
from cosserat_casadi.codegen.contact.checks import check_contact
from cosserat_casadi.codegen.contact.compiled import CompiledContact
from cosserat_casadi.equilibrium import blindness
from cosserat_casadi.equilibrium.answer_error import UNKNOWN
from cosserat_casadi.equilibrium.contact.contact_equations import Grids, richer
from cosserat_casadi.equilibrium.contact.contact_solve import solve_contact
from cosserat_casadi.equilibrium.metrics import SAFETY
from cosserat_casadi.numerics.outcome import Outcome
from tests.codegen.contact_libraries import (
    BAR,
    FLAT,
    PUSH,
    TABLE,
    WEIGHT,
    ContactLibrary,
    assert_same,
    exported_contact,
    on_table,
    over_bar,
    pulled_over_bar,
)
from tests.codegen.libraries import C99, QUICK, attempt, compile_quickly, gcc
from tests.families import mostly_slow
from tests.scenes import push, rod, scene

LINT = (*C99, "-Wshadow", "-Wconversion", "-Wsign-conversion", "-Wvla", "-Werror")


def pose_of(solution: Solution) -> np.ndarray:
    """Position and quaternion of the body of a solution, shape (7,)."""
    pose = solution.body("head")
    return np.concatenate([np.ravel(pose.position), np.ravel(pose.quaternion)])


def down(force: float) -> np.ndarray:
    """Stacked inputs of a force downwards."""
    return np.array([0.0, 0.0, -force])


@pytest.fixture(scope="module")
def bar(tmp_path_factory: pytest.TempPathFactory) -> ContactLibrary:
    """A rod over a bar, which knows contact at a point, and none."""
    return exported_contact(over_bar(), tmp_path_factory.mktemp("bar") / "bar", down(8.0)[None], 3, 6, stability=True)


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> ContactLibrary:
    """A rod on a table, which knows the tip, a line and no contact."""
    return exported_contact(
        on_table(), tmp_path_factory.mktemp("table") / "table", down(60.0)[None], 4, 8, stability=True
    )


@pytest.fixture(scope="module")
def pulled(tmp_path_factory: pytest.TempPathFactory) -> ContactLibrary:
    """A rod over a bar that a tendon pulls and that carries a body, which may touch a wall, with parameters."""
    wanted = pulled_over_bar(
        obstacles=[
            BAR,
            {"name": "wall", "kind": "plane", "point": [2.0, 0, 0], "normal": [-1, 0, 0], "bodies": ["head"]},
        ],
        bodies=[{"name": "head", "mass": 0.1, "radius": 0.1}],
        joints=[{"body": "head", "rod": "rod", "kind": "fixed", "position": [5.0, 0, 0.02]}],
        parameters=["rod.stiffness.bending_y", "tendon.offset"],
    )
    folder = tmp_path_factory.mktemp("pulled") / "pulled"
    cases = np.array([[0.0, 0.0, -2.0, 3.0], [0.0, 0.0, -4.0, 3.0]])
    return exported_contact(wanted, folder, cases, modes=2, nodes=4, stability=True, batches=True)


@pytest.mark.slow
def test_touch_slide_and_lift_off(bar: ContactLibrary) -> None:
    """Where the rod touches the bar, how hard, and where its tip is are those of Python, there and back."""
    found = bar.loaded.start()
    wanted = None
    places = []
    for force in (3.0, 0.5, 0.1, 2.0, 8.0):
        found = bar.loaded.solve(down(force), found)
        wanted = solve(bar.model, down(force), start=wanted)
        assert_same(found, wanted)
        assert len(found.contacts) == (force > 0.5)
        places += [contact.start for contact in found.contacts]
    assert np.ptp(places) > 0.01


@pytest.mark.slow
def test_a_tip_that_touches_and_a_rod_that_lies_down(table: ContactLibrary) -> None:
    """None, the tip, and a line that grows and shrinks: each as in Python."""
    kinds = []
    found = table.loaded.start()
    wanted = None
    for force in (1.0, 10.0, 55.0, 40.0, 10.0, 1.0):
        found = table.loaded.solve(down(force), found)
        # From the tip alone Python lets it touch a hair's breadth beside the line too: the same to the tolerance.
        wanted = solve(table.model, down(force), start=None if force == 55.0 else wanted)
        # What errors of the moment make of the forces of a line is as large as it is short.
        assert_same(found, wanted, forces=1e-6)
        kinds.append([contact.kind for contact in found.contacts])
    assert kinds == [[], ["point"], ["line"], ["line"], ["point"], []]


def test_a_rod_that_barely_enters_between_the_sections_looked_at(bar: ContactLibrary) -> None:
    """At 0.5267 N the rod comes to the bar, and is inside by 3e-4 of its length for 5 mN more: both sides are seen."""
    for force, count in ((0.526, 0), (0.5272, 1), (0.529, 1)):
        found = bar.loaded.solve(down(force))
        assert found.converged
        assert len(found.contacts) == count


@pytest.mark.parametrize("force", [0.2, 3.0])
def test_derivatives_of_the_tip(bar: ContactLibrary, force: float) -> None:
    """They are those of central differences of solves, in contact and without; the error falls as h²."""
    found = bar.loaded.solve(down(force))
    tracked = bar.loaded.track(down(force), found)
    derivatives = bar.loaded.sensitivity(found)
    assert derivatives is not None and tracked.derivatives is not None
    np.testing.assert_allclose(tracked.derivatives["rod"], derivatives["rod"], rtol=1e-12, atol=1e-14)
    errors = []
    for step in (0.04, 0.02):
        columns = []
        for axis in range(3):
            change = step * np.eye(3)[axis]
            ends = [bar.loaded.solve(down(force) + sign * change, found).tips["rod"] for sign in (1, -1)]
            columns.append((ends[0] - ends[1]) / (2 * step))
        errors.append(np.abs(derivatives["rod"] - np.array(columns).T).max())
    assert np.linalg.norm(derivatives["rod"][:3]) > 1e-3
    assert errors[0] < 1e-4
    assert np.log2(errors[0] / errors[1]) > 1.8


def test_second_derivatives_of_a_solution(tmp_path: Path, bar: ContactLibrary) -> None:
    """By the equations of an arrangement for CasADi: the first are those of C, the second are their differences."""
    own = exported_contact(over_bar(), tmp_path / "bar", down(8.0)[None], 1, 2, derivatives=True, estimate_errors=False)
    library = own.loaded
    with pytest.raises(AttributeError, match="export the folder with derivatives"):
        assert bar.loaded.residual
    readmes = [(made.folder / "README.md").read_text() for made in (own, bar)]
    assert ["`bar_f_NUMBER_residual`" in readme for readme in readmes] == [True, False]
    assert library.residual[0].name() == "bar_f_0_residual"
    kinds = set()
    for force in (0.2, 3.0):
        inputs = down(force)
        found = library.solve(inputs)
        kinds.add(len(found.contacts))
        residual, poses = library.residual[found.arrangement], library.poses[found.arrangement]
        assert_allclose(residual(found.z, inputs).full(), 0.0, rtol=0, atol=1e-9)
        assert_allclose(poses(found.z, inputs).full()[:, 0], found.tips["rod"], rtol=0, atol=1e-12)
        symbols = [ca.MX.sym("z", len(found.z)), ca.MX.sym("inputs", 3)]
        multipliers = ca.MX.sym("multipliers", len(found.z))
        tip = poses(*symbols)[2]
        whole = ca.vertcat(*symbols)
        hessian, _ = ca.hessian(tip + ca.dot(multipliers, residual(*symbols)), whole)
        slopes = [ca.jacobian(residual(*symbols), whole), ca.jacobian(tip, whole), hessian]
        function = ca.Function("second", [*symbols, multipliers], slopes)
        by_all, tip_by_all, _ = (np.asarray(value.full()) for value in function(found.z, inputs, 0))
        by_z, by_force = by_all[:, : len(found.z)], by_all[:, -1]
        direction = np.concatenate([np.linalg.solve(by_z, -by_force), [0, 0, 1]])
        adjoint = np.linalg.solve(by_z.T, -tip_by_all[0, : len(found.z)])
        curvature = direction @ function(found.z, inputs, adjoint)[2].full() @ direction
        derivatives = library.sensitivity(found)
        assert derivatives is not None
        assert_allclose(tip_by_all[0] @ direction, derivatives["rod"][2, 2], rtol=1e-9, atol=0)
        columns = []
        for step in (1e-3, -1e-3):
            beside = library.sensitivity(library.solve(down(force - step), found))
            assert beside is not None
            columns.append(beside["rod"][2, 2])
        assert_allclose(curvature, (columns[0] - columns[1]) / 2e-3, rtol=1e-4, atol=0)
    assert kinds == {0, 1}


def test_derivatives_of_a_contact(bar: ContactLibrary) -> None:
    """Place and force by the inputs as differences of solves say, the tip as Python's linear model does."""
    found = bar.loaded.solve(down(3.0))
    (derivatives,) = bar.loaded.contact_sensitivity(found) or []
    beside = [bar.loaded.solve(down(3.0 + change), found).contacts[0] for change in (1e-3, -1e-3)]
    ends = [np.array([own.start, own.end, own.ends[0], 0.0]) for own in beside]
    assert_allclose(-derivatives[:, 2], (ends[0] - ends[1]) / 2e-3, rtol=1e-6, atol=1e-12)
    linear = linearise(solve(bar.model, down(3.0)))
    gain = linear.D - linear.C @ np.linalg.solve(linear.A, linear.B)
    by_inputs = bar.loaded.sensitivity(found)
    assert by_inputs is not None
    # Python holds the elements: the same to the error of the modes.
    assert_allclose(by_inputs["rod"][:3], gain, rtol=2e-6, atol=1e-12)


def test_derivatives_beside_a_touch(bar: ContactLibrary) -> None:
    """Just before the rod touches and just after they are those of either side, and margins tell how near that is."""
    gains = []
    for force, side in ((0.5265, -1e-4), (0.527, 1e-4)):
        found = bar.loaded.solve(down(force))
        derivatives, margins = bar.loaded.sensitivity(found), bar.loaded.margins(found)
        assert derivatives is not None and margins is not None
        gains.append(-derivatives["rod"][2, 2])
        tips = [bar.loaded.solve(down(own), found).tips["rod"] for own in (force, force + side)]
        assert_allclose(gains[-1], (tips[1] - tips[0])[2] / side, rtol=1e-4, atol=0)
        assert min(margins) < 3e-4
    assert gains[0] < 5.0 * gains[1] < 0.0
    far = bar.loaded.margins(bar.loaded.solve(down(3.0)))
    assert far is not None and min(far) > 5e-3


@pytest.mark.slow
def test_derivatives_of_a_line(table: ContactLibrary) -> None:
    """The abscissa from which the rod lies moves; the derivative of its tip is that of differences in C."""
    library = table.loaded
    found = library.solve(down(50.0))
    derivatives = library.sensitivity(found)
    assert derivatives is not None
    ends = [library.solve(down(50.0 + change), found).tips["rod"] for change in (1e-2, -1e-2)]
    np.testing.assert_allclose(-derivatives["rod"][:, 2], (ends[0] - ends[1]) / 2e-2, rtol=1e-5, atol=1e-10)
    (of_line,) = library.contact_sensitivity(found) or []
    lines = [library.solve(down(50.0 + change), found).contacts[0] for change in (1e-2, -1e-2)]
    wanted = [np.array([own.start, own.end, *own.ends]) for own in lines]
    assert_allclose(-of_line[:, 2], (wanted[0] - wanted[1]) / 2e-2, rtol=1e-5, atol=1e-8)


@pytest.mark.slow
def test_what_the_library_does_not_know_is_not_found(table: ContactLibrary, tmp_path: Path) -> None:
    """A library of the tip alone does not let the rod lie down in the table: it says so, and keeps its state."""
    library = exported_contact(on_table(), tmp_path / "tip", np.zeros((0, 3)), 4, 8).loaded
    assert [len(contacts) for contacts in library.arrangements] == [1, 0]
    tip = library.start()
    lying = library.solve(down(50.0), tip)
    assert lying.outcome is Outcome.CONTACT_UNSETTLED
    assert not lying.tips and not lying.contacts
    assert 0.0 < lying.load_factor < 1.0
    assert lying.state == tip.state
    assert table.loaded.solve(down(50.0)).converged


@pytest.mark.slow
def test_obstacles_that_a_tip_touches_at_once_in_any_order(tmp_path: Path) -> None:
    """The tip comes to rest between two planes, whose names are not in the order of the scene."""
    floor = {"name": "z_floor", "kind": "plane", "point": [0, 0, -0.3], "normal": [0, 0, 1]}
    ramp = {"name": "a_ramp", "kind": "plane", "point": [0.9435, 0, -0.3], "normal": [-1, 0, 1]}
    plain = FLAT | {"length": 1.0, "stiffness": {"bending_y": 1.0}}
    corner = scene(rods=[plain], loads=[PUSH | {"force": [0, 0, -0.2]}], obstacles=[floor, ramp])
    library = exported_contact(corner, tmp_path / "corner", down(2.0)[None], 3, 6, estimate_errors=False)
    free = library.loaded.start()
    assert not free.contacts
    found = library.loaded.solve(down(2.0), free)
    assert found.converged, found.message
    wanted = {contact.obstacle: contact.force for contact in solve(library.model, down(2.0)).contacts}
    assert [contact.obstacle for contact in found.contacts] == ["z_floor", "a_ramp"]
    for contact in found.contacts:
        assert_allclose(contact.force, wanted[contact.obstacle], rtol=0, atol=1e-8)


def test_no_step_leads_through_a_bar(bar: ContactLibrary) -> None:
    """From above the bar a pull that a rod below it would follow ends on the bar, in one call."""
    free = bar.loaded.solve(down(-8.0))
    assert free.converged and not free.contacts
    pushed = bar.loaded.solve(down(8.0), free)
    assert pushed.converged and len(pushed.contacts) == 1
    assert pushed.contacts[0].force[2] > 0.0
    assert pushed.parts > 1


def test_the_budget_of_a_turn_holds(bar: ContactLibrary) -> None:
    """A turn that asks for too much says so, does no more than it may, and leaves the state."""
    start = bar.loaded.start()
    lost = bar.loaded.track(down(-8.0), start, max_iterations=3, max_parts=2)
    assert not lost.converged and lost.derivatives is None
    assert lost.iterations <= 3 and lost.parts <= 2
    assert lost.state == start.state
    assert bar.loaded.track(down(-8.0), start, max_iterations=400, max_parts=80).converged


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_inputs_that_are_not_finite(bar: ContactLibrary, bad: float) -> None:
    """They are refused by the status, and nothing else happens."""
    start = bar.loaded.start()
    for found in (bar.loaded.solve([0.0, bad, 0.0], start), bar.loaded.track([0.0, bad, 0.0], start)):
        assert found.outcome is Outcome.NOT_FINITE
        assert found.state == start.state


@pytest.mark.slow
def test_a_rod_that_tips_over_beside_a_bar_is_told(tmp_path: Path) -> None:
    """Weak against bending aside and torsion, it is unstable in contact from 0.43 N on, as in Python."""
    weak = {"bending_x": 0.05, "bending_y": 1.4, "torsion": 0.03}
    thin = rod("kirchhoff", stiffness=weak, base={"position": [0, 0, 0], "tangent": [1, 0, 0]})
    near = {**BAR, "from": [0.5, -0.5, -0.052], "to": [0.5, 0.5, -0.052]}
    pushed = {**PUSH, "force": [0, 0, -0.1]}
    wanted = scene(rods=[thin], loads=[pushed], obstacles=[near], accuracy={"tolerance": 1e-8})
    library = exported_contact(wanted, tmp_path / "thin", down(1.0)[None], 2, 4, estimate_errors=False, stability=True)
    found, same = library.loaded.start(), None
    for force, verdict in ((0.1, "stable"), (0.4, "stable"), (0.5, "unstable")):
        found = library.loaded.solve(down(force), found)
        same = solve(library.model, down(force), start=same)
        judged = library.loaded.stability(found)
        assert judged is not None and judged.verdict == verdict and same.stable == judged.stable
        assert_allclose(judged.smallest_eigenvalue, same.smallest_eigenvalue, rtol=1e-6, atol=0)


@pytest.mark.slow
def test_sources_by_hand_compile_without_a_word(
    bar: ContactLibrary, table: ContactLibrary, pulled: ContactLibrary, tmp_path: Path
) -> None:
    """All but the kernels, which CasADi has written."""
    for library in (bar, table, pulled):
        name = library.folder.name
        for file in (f"{name}.c", f"{name}_demo.c"):
            gcc(*LINT, "-fsyntax-only", library.folder / file)
    kernels = bar.folder / "bar_kernels.c"
    objects = [bar.folder / "bar_demo.c", bar.folder / "bar.c", kernels]
    compile_quickly("-std=c99", *QUICK, *objects, "-o", tmp_path / "demo", "-lm")
    printed = subprocess.run([tmp_path / "demo", "0", "0", "-5"], check=True, capture_output=True, text=True).stdout
    answer = json.loads(printed)
    assert answer["status"] == "converged"
    wanted = solve(bar.model, down(5.0))
    np.testing.assert_allclose(answer["tip"], wanted.tip().position, rtol=0, atol=1e-9)
    np.testing.assert_allclose(answer["contacts"][0]["force"], wanted.contacts[0].force, rtol=0, atol=1e-8)


def test_jacobians_are_by_columns(bar: ContactLibrary) -> None:
    """In contact and without, of a bar whose distance is chosen between its ends and its middle."""
    columns = (bar.folder / "bar_kernels_in_fours.h").read_text()
    assert all(f"bar_k_{number}_jacobian_columns_0" in columns for number in range(len(bar.loaded.arrangements)))


AT_FORCES = [("bar", 0.2, []), ("bar", 8.0, ["point"]), ("table", 10.0, ["point"]), ("table", 55.0, ["line"])]


@pytest.mark.parametrize(("which", "force", "kinds"), mostly_slow(AT_FORCES, quick=AT_FORCES[:2]))
def test_errors_and_verdicts(which: str, force: float, kinds: list[str], request: pytest.FixtureRequest) -> None:
    """They are those of Python, without contact, at a point, at the tip and along a line."""
    library: ContactLibrary = request.getfixturevalue(which)
    found = library.loaded.solve(down(force))
    assert [contact.kind for contact in found.contacts] == kinds
    assert found.error_estimate is not None
    wanted = solve(library.model, down(force))
    # Estimates are differences of answers that are solved to 1e-12.
    np.testing.assert_allclose(found.error_estimate, wanted.error_estimate, rtol=1e-4, atol=2e-12)
    assert found.within_tolerance == wanted.within_tolerance
    assert library.loaded.error_estimate(found) == found.error_estimate
    judged = library.loaded.stability(found)
    assert judged is not None and judged.stable and wanted.stable
    assert_allclose(judged.smallest_eigenvalue, wanted.smallest_eigenvalue, rtol=1e-10, atol=0)


@pytest.mark.slow
def test_what_newton_leaves_of_a_gap_turns_nothing(tmp_path: Path) -> None:
    """C looks at the place of contact itself: its gap of -4e-12 is no angle at which the rod enters the bar."""
    bent = read_scene("examples/rod_over_bar.toml")
    force = np.array([-1.4789654541625923, -1.241352145084578, -2.257145248551024])
    library = exported_contact(bent, tmp_path / "bent", force[None], 5, 12)
    found = library.loaded.solve(force)
    wanted = solve(library.model, force)
    assert found.error_estimate is not None and wanted.error_estimate is not None
    np.testing.assert_allclose(found.error_estimate, wanted.error_estimate, rtol=1e-2)


@pytest.mark.slow
def test_errors_in_contact_bound_the_true_ones(bar: ContactLibrary) -> None:
    fine = solve(build(over_bar(), discretise(over_bar(), 11, 22)), down(8.0))
    answer = bar.loaded.solve(down(8.0))
    true = np.linalg.norm(answer.tips["rod"][:3] - fine.tip().position)
    assert answer.error_estimate is not None
    assert true <= answer.error_estimate <= 10 * true


@pytest.mark.slow
def test_where_other_contacts_hold_on_richer_modes_the_error_is_not_known(tmp_path: Path) -> None:
    """With one polynomial a rod does not come to the bar at 0.6 N, and with more it does."""
    library = exported_contact(over_bar(), tmp_path / "stiff", np.zeros((0, 3)), 1, 4)
    found = library.loaded.solve(down(0.6))
    assert found.converged and not found.contacts
    assert found.error_estimate == 1.0
    assert found.within_tolerance is False


BENDING_1 = {
    "material": {"youngs_modulus": 4e8 / np.pi, "poisson_ratio": 0.4},
    "section": {"shape": "circle", "radius": 1e-2},
}
"""Material and section of a rod whose bending stiffness is 1 N m²."""


def test_richer_modes_that_are_blind_to_what_loads_roll_up_do_not_know_the_error(tmp_path: Path) -> None:
    """Three turns on four modes, far from an obstacle: a force puts waves along them, and a circle has none."""
    far = {"name": "far", "kind": "sphere", "centre": [0.0, 0.0, 9.0], "radius": 0.1}
    straight = {"name": "rod", "length": 1.0, "strain": "planar", **BENDING_1}
    rolling = push(force=[1.0, 0, 0], moment=[0, 6 * np.pi, 0])
    rolled = scene(rolling, rods=[straight], obstacles=[far], inputs=["push.force"], accuracy={"tolerance": 1e-3})
    library = exported_contact(rolled, tmp_path / "rolled", np.zeros((0, 3)), 4, 24)
    assert library.loaded.solve().error_estimate == UNKNOWN
    circle_alone = library.loaded.solve({"push.force": [0.0, 0.0, 0.0]}).error_estimate
    assert circle_alone is not None and circle_alone < 1e-10


@pytest.mark.slow
@pytest.mark.parametrize("exported_at", [-0.3, 0.3])
def test_an_element_that_contact_lengthens_turns_by_more(
    exported_at: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A coil that its base rolls along a wall: the element behind the contact turns by 5.0 to 5.6."""
    monkeypatch.setattr(blindness, "WHOLE_TURN", 5.3)
    monkeypatch.setattr(blindness, "BEYOND", 10)

    def base_turned_by(angle: float) -> list[float]:
        return [np.cos(angle / 2), 0.0, np.sin(angle / 2), 0.0]

    base = {"position": [0, 0, 0], "quaternion": base_turned_by(exported_at)}
    coil = {"name": "rod", "length": 1.0, "strain": "planar", **BENDING_1, "base": base}
    coil["intrinsic"] = {"curvature": [0, 8.4, 0]}
    wall = {"name": "wall", "kind": "plane", "point": [2 / 8.4 - 0.002, 0, 0], "normal": [-1, 0, 0]}
    rolling = scene(
        push(force=[0.2, 0, 0.1]),
        rods=[coil],
        obstacles=[wall],
        inputs=["rod.base.quaternion"],
        accuracy={"tolerance": 1e-3},
    )
    library = exported_contact(rolling, tmp_path / "coil", np.zeros((0, 4)), 3, 24)
    for angle in (-0.3, 0.3):
        values = {"rod.base.quaternion": base_turned_by(angle)}
        found, wanted = library.loaded.solve(values), solve(library.model, values)
        assert [contact.kind for contact in found.contacts] == ["point"]
        assert (found.error_estimate == UNKNOWN) == (wanted.error_estimate == UNKNOWN) == (angle > 0)


@pytest.mark.slow
def test_a_point_that_stands_for_a_line_has_its_error(tmp_path: Path) -> None:
    """A drum that the rod lies on under 26 N, of which the library knows contact at a point."""
    obstacle = {"name": "drum", "kind": "capsule", "from": [0.4, -1, -0.824], "to": [0.4, 1, -0.824], "radius": 0.8}
    of_drum = {"rods": [FLAT], "loads": [PUSH], "obstacles": [obstacle]}
    drum, exact = (scene(**of_drum, accuracy={"tolerance": own}) for own in (1e-3, 1e-7))
    library = exported_contact(drum, tmp_path / "drum", np.zeros((0, 3)), 4, 8)
    found = library.loaded.solve(down(26.0))
    assert [contact.kind for contact in found.contacts] == ["point"]
    wanted = solve(build(exact, discretise(exact, 7)), down(26.0))
    assert [contact.kind for contact in wanted.contacts] == ["line"]
    off = np.linalg.norm(found.tips["rod"][:3] - wanted.tip().position)
    (own,), (line,) = found.contacts, wanted.contacts
    assert off > 1e-4
    assert found.error_estimate is not None
    assert found.within_tolerance is False
    assert max(abs(own.start - line.start), abs(own.end - line.end), off) < found.error_estimate < 0.4


def test_an_error_is_of_a_solution(bar: ContactLibrary) -> None:
    """A state that is none has none; a turn makes no estimate, and its solution has one on request."""
    found = bar.loaded.start()
    assert bar.loaded.track(down(3.1), found).error_estimate is None
    moved = bytearray(found.state)
    # The first unknown stands behind two whole numbers.
    moved[8:16] = np.float64(0.5).tobytes()
    unsolved = replace(found, state=bytes(moved))
    assert bar.loaded.error_estimate(unsolved) is None
    assert bar.loaded.stability(unsolved) is None and bar.loaded.margins(unsolved) is None


def test_efforts_and_bodies_in_contact(pulled: ContactLibrary) -> None:
    """A tendon's tension, and its length on the rod that bends over the bar; the pose of a body that it carries."""
    library = pulled
    inputs = {"push.force": [0, 0, -2.0], "tendon.tension": 3.0}
    found = library.loaded.solve(inputs)
    wanted = solve(library.model, inputs)
    assert_same(found, wanted)
    assert found.contacts
    efforts = wanted.actuator("tendon")
    assert found.actuators["tendon"].keys() == efforts.keys()
    assert_allclose(list(found.actuators["tendon"].values()), list(efforts.values()), rtol=1e-9, atol=0)
    assert_allclose(found.bodies["head"], pose_of(wanted), rtol=0, atol=1e-9)
    turned = library.loaded.track(inputs, found).body_derivatives
    assert turned is not None
    stacked, change = np.array([0.0, 0.0, -2.0, 3.0]), np.array([0.0, 0.0, 3e-3, 0.0])
    ends = [library.loaded.solve(stacked + sign * change, found).bodies["head"] for sign in (1.0, -1.0)]
    assert_allclose(turned["head"] @ change, (ends[0] - ends[1]) / 2, rtol=0, atol=2e-7)
    # Far from the rod that carries it, it has the largest error.
    carrying = library.model.scene.model_copy(update={"parameters": ()})
    grids = richer(Grids(library.model.discretisation), carrying)
    finer = solve_contact(carrying, grids, inputs, start=wanted)
    off = np.linalg.norm(finer.body("head").position - wanted.body("head").position)
    assert found.error_estimate is not None
    assert_allclose(found.error_estimate, SAFETY * off / carrying.rods[0].length, rtol=1e-3, atol=0)


def test_a_body_that_touches(pulled: ContactLibrary) -> None:
    """A ball on the rod over the bar comes to a wall, and leaves it, as in Python; its force by the inputs too."""
    library = pulled.loaded
    found = library.solve([0.0, 0.0, -2.0, 3.0])
    for force, touching in ((4.0, 2), (2.0, 1)):
        found = library.solve([0.0, 0.0, -force, 3.0], found)
        assert len(found.contacts) == touching
        if touching == 1:
            continue
        wanted = solve(pulled.model, {"push.force": [0, 0, -force], "tendon.tension": 3.0})
        assert_same(found, wanted, forces=1e-8)
        assert found.contacts[-1].of_body and wanted.contacts[-1].of_body
        judged, by_inputs = library.stability(found), library.contact_sensitivity(found)
        assert judged is not None and judged.stable and by_inputs
        assert_allclose(judged.smallest_eigenvalue, wanted.smallest_eigenvalue, rtol=1e-9, atol=0)
        ends = [library.solve([0.0, 0.0, -force - side * 1e-3, 3.0], found).contacts[-1].ends[0] for side in (1, -1)]
        assert_allclose(-by_inputs[-1][2, 2], (ends[0] - ends[1]) / 2e-3, rtol=1e-6, atol=0)


@pytest.mark.slow
def test_contacts_of_rods_in_any_order_of_their_names(tmp_path: Path) -> None:
    """Arrangements have contacts by the names of rods, the scene has the rods in another order."""
    beside = FLAT | {"name": "a", "base": {"position": [0, 0.2, 0], "tangent": [1, 0, 0]}}
    loads = [PUSH | {"rod": "b"}, PUSH | {"name": "other", "rod": "a", "force": [0, 0, -2.0]}]
    wanted = scene(rods=[FLAT | {"name": "b"}, beside], loads=loads, obstacles=[BAR], accuracy={"tolerance": 1e-8})
    library = exported_contact(wanted, tmp_path / "two", np.zeros((0, 6)), 2, 4, estimate_errors=False)
    inputs = [0.0, 0.0, -3.5, 0.0, 0.0, -2.5]
    found = library.loaded.solve(inputs)
    same = solve(library.model, {"push.force": inputs[:3], "other.force": inputs[3:]})
    assert [contact.owner for contact in found.contacts] == ["a", "b"]
    places = [[contact.start for contact in own.contacts] for own in (found, same)]
    assert_allclose(places[0], places[1], rtol=0, atol=1e-9)


def test_parameters_in_contact(pulled: ContactLibrary) -> None:
    """Answers at other parameters are those of Python, in a solve and in a turn; derivatives those of differences."""
    library = pulled.loaded
    inputs = {"push.force": [0, 0, -2.0], "tendon.tension": 3.0}
    stiffness, *_ = library.parameters.pack()
    others = {"rod.stiffness.bending_y": 1.1 * stiffness, "tendon.offset": [-0.02, 0.0]}
    own = library.solve(inputs)
    found = library.solve(inputs, parameters=others)
    assert_same(found, solve(pulled.model, inputs, parameters=others))
    turned = library.track(inputs, own, parameters=others)
    assert_allclose(turned.tips["rod"], found.tips["rod"], rtol=0, atol=1e-10)
    derivatives, of_contacts = library.sensitivity(own), library.contact_sensitivity(own)
    assert derivatives is not None and of_contacts
    for column, name, step in ((4, "rod.stiffness.bending_y", [1e-4, 0.0]), (5, "tendon.offset", [1e-6, 0.0])):
        value = np.array([stiffness]) if column == 4 else np.array([-0.01, 0.0])
        change = np.array(step[: len(value)])
        ends = [library.solve(inputs, own, parameters={name: value + sign * change}) for sign in (1, -1)]
        tips = (ends[0].tips["rod"] - ends[1].tips["rod"]) / (2 * step[0])
        assert_allclose(derivatives["rod"][:, column], tips, rtol=1e-5, atol=1e-8)
        forces = (ends[0].contacts[0].ends[0] - ends[1].contacts[0].ends[0]) / (2 * step[0])
        assert_allclose(of_contacts[0][2, column], forces, rtol=1e-5, atol=0)


def test_many_load_cases_in_contact(pulled: ContactLibrary) -> None:
    """Each is that of a solve from the scene's own inputs, to the last digit; what fails says so and has no pose."""
    library = pulled.loaded
    stiffness, *_ = library.parameters.pack()
    inputs = np.array([[0.0, 0.0, -4.0, 3.0], [0.0, 0.0, -0.1, 3.0], [0.0, np.nan, -1.0, 3.0], [0.0, 0.0, -2.0, 3.0]])
    p = np.array(
        [[stiffness, -0.01, 0.0], [1.1 * stiffness, -0.02, 0.0], [stiffness, -0.01, 0.0], [stiffness, 0.0, 0.0]]
    )
    found = library.solve_batch(inputs, parameters=p)
    assert [len(own.contacts) for own in found] == [2, 0, 0, 1]
    for own, given, values in zip(found, inputs, p, strict=True):
        alone = library.solve(given, parameters=values)
        assert own.converged == alone.converged == bool(np.isfinite(given).all())
        assert own.error_estimate == alone.error_estimate
        assert own.tips.keys() == alone.tips.keys()
        for rod_name, tip in own.tips.items():
            assert_allclose(tip, alone.tips[rod_name], rtol=0, atol=0)
    assert not found[2].tips and found[2].message == library.solve(inputs[2]).message
    assert_same(found[3], solve(pulled.model, inputs[3], parameters=p[3]))
    (shared,) = library.solve_batch(inputs[:1])
    assert_allclose(shared.tips["rod"], found[0].tips["rod"], rtol=0, atol=0)
    with pytest.raises(ValueError, match="there are 4 rows of parameters for 3 rows of inputs"):
        library.solve_batch(inputs[:3], parameters=p)


@pytest.mark.slow
def test_the_program_of_the_readme_has_room_for_bodies(tmp_path: Path, pulled: ContactLibrary) -> None:
    (text,) = re.findall(r"```c\n(.*?)```", (pulled.folder / "README.md").read_text(), flags=re.DOTALL)
    (tmp_path / "readme.c").write_text(text)
    sources = [pulled.folder / file for file in ("pulled.c", "pulled_kernels.c")]
    paths = ["-I", pulled.folder, tmp_path / "readme.c", *sources, "-o", tmp_path / "readme"]
    compile_quickly("-std=c99", *QUICK, "-Wall", "-Wextra", "-fsanitize=address", *paths, "-lm")
    done = subprocess.run([tmp_path / "readme"], capture_output=True, text=True, check=True)
    assert_allclose(np.array(done.stdout.split(), float), pulled.loaded.solve().tips["rod"][:3], rtol=0, atol=1e-9)


def test_what_is_no_answer_leaves_the_state_as_it_was(tmp_path: Path) -> None:
    """The equations are solved for all of the load, and a tendon has no length left: nothing to go on from."""
    wanted = pulled_over_bar(tendon={"offset": [-3.0, 0], "tension": 0.0})
    made = exported_contact(wanted, tmp_path / "limp", np.zeros((0, 4)), 2, 4, estimate_errors=False, batches=True)
    library = made.loaded
    near, far = np.array([[0.0, 0.0, -5.0, 0.0], [0.0, 0.0, -8.0, 0.0]])
    before = library.solve(near)
    assert before.converged
    beyond = library.solve(far, before)
    assert beyond.outcome is solve(made.model, far).outcome is Outcome.PATH_VANISHED
    assert beyond.load_factor == 1.0
    assert beyond.state == before.state
    assert library.track(far, before).state == before.state
    first, second = library.solve_batch([far, near])
    assert first.outcome is Outcome.PATH_VANISHED
    assert not any(first.state)
    assert_allclose(second.tips["rod"], before.tips["rod"], rtol=0, atol=1e-9)


def test_contact_without_inputs(tmp_path: Path) -> None:
    """All of the scene is fixed: there are no derivatives, and one solution, that of Python."""
    wanted = over_bar().model_copy(update={"inputs": ()})
    options = {"estimate_errors": False, "batches": True, "derivatives": True}
    made = exported_contact(wanted, tmp_path / "fixed", np.zeros((0, 0)), 1, 2, **options)
    library = made.loaded
    found = library.solve()
    assert_same(found, solve(made.model))
    assert library.track(np.zeros(0), found).converged
    (again,) = library.solve_batch(np.zeros((1, 0)))
    assert_same(again, solve(made.model))
    assert_allclose(library.residual[found.arrangement](found.z, []).full(), 0.0, rtol=0, atol=1e-9)


@pytest.mark.slow
def test_a_library_without_the_estimate_says_so(tmp_path: Path) -> None:
    wanted = over_bar()
    folder = export(build(wanted, discretise(wanted, 1, 2)), tmp_path / "bar", estimate_errors=False)
    assert not (folder / "contact_error.c").exists()
    assert "richer" not in (folder / "bar_kernels.c").read_text()
    for file in ("bar.h", "README.md"):
        assert "No error is estimated" in (folder / file).read_text()


@pytest.mark.slow
def test_a_folder_says_for_which_ranges_it_was_verified(bar: ContactLibrary, tmp_path: Path) -> None:
    """In header, README and manifest, as folders without contact do."""
    verified = Verified(("push.force.z=-4:-2",), 7, 0.25, 0, False)
    model = build(over_bar(), discretise(over_bar(), 2, 4))
    folder = export(model, tmp_path / "verified", verified=verified)
    assert json.loads((folder / "manifest.json").read_text())["verified"] == verified.plain()
    for file in ("verified.h", "README.md"):
        assert verified.sentence in " ".join((folder / file).read_text().split())
    assert "was not estimated" in " ".join((bar.folder / "bar.h").read_text().split())


def test_float_is_refused(bar: ContactLibrary) -> None:
    done = attempt("gcc", "-fsyntax-only", "-DBAR_SINGLE", bar.folder / "bar.c")
    assert done.returncode != 0
    assert "in double alone" in done.stderr


def test_bytes_of_a_library(bar: ContactLibrary) -> None:
    """Each arrangement has its equations; three per cent more than they are now would be noticed."""
    files = [bar.folder / file for file in ("bar_kernels.c", "bar_kernels_in_fours.h")]
    assert sum(len(file.read_bytes()) for file in files) < 492_000


def test_refused_uses(tmp_path: Path) -> None:
    """What C does not have of exact contact is refused, with all faults at once, and nothing is written."""
    wanted = over_bar()
    model = build(wanted, discretise(wanted, 1, 2))
    with pytest.raises(ExportError, match="a GPU cannot solve batches"):
        export(model, tmp_path / "folder", dynamics=True, cuda=True)
    with pytest.raises(ExportError, match=r"of shape \(k, 3\), got shape \(1, 2\)"):
        export(model, tmp_path / "folder", load_cases=np.zeros((1, 2)))
    named = ["rod.section.radius", "hook.at"]
    material = {"youngs_modulus": 1e6, "poisson_ratio": 0.4}
    round_rod = FLAT | {"material": material, "section": {"shape": "circle", "radius": 0.02}}
    del round_rod["stiffness"], round_rod["linear_density"]
    hook = {"name": "hook", "kind": "point_wrench", "rod": "rod", "at": 0.4, "force": [0, 0, -1.0]}
    named_scene = scene(rods=[round_rod], loads=[hook], obstacles=[BAR], parameters=named)
    with pytest.raises(
        ExportError,
        match=r"section.radius cannot change: in exact contact C has(?s:.*)hook.at would move ends of elements",
    ):
        check_contact(named_scene, {})
    wall = {"name": "wall", "kind": "plane", "point": [2.0, 0, 0], "normal": [-1, 0, 0], "bodies": ["head"]}
    carried = {
        "bodies": [{"name": "head", "mass": 0.1, "radius": 0.1}, {"name": "free", "mass": 0.1, "radius": 0.1}],
        "joints": [
            {"body": name, "rod": "rod", "kind": "fixed", "at": at} for name, at in (("head", 1.0), ("free", 0.5))
        ],
        "obstacles": [BAR, wall],
        "parameters": ["head.radius", "free.radius", "head.mass"],
    }
    with pytest.raises(ExportError) as refused:
        check_contact(scene(rods=[FLAT], loads=[PUSH], **carried), {})
    (problem,) = refused.value.problems
    assert (
        problem.problem == "head.radius cannot change: C has the surfaces of bodies in exact contact as fixed numbers"
    )
    free = scene(rods=[rod("planar")])
    with pytest.raises(ExportError, match="no rod of this scene touches an obstacle exactly"):
        export(build(free, discretise(free, 1, 2)), tmp_path / "folder", load_cases=np.zeros((1, 0)))
    assert not list(tmp_path.iterdir())


def test_load_cases_may_name_parameters(tmp_path: Path) -> None:
    """A softer rod than that of the scene comes to touch: the library knows that contact by the load case alone."""
    light = {"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0, 0, -0.05]}
    wanted = scene(rods=[FLAT], loads=[light], obstacles=[BAR], parameters=["rod.stiffness.bending_y"])
    model = build(wanted, discretise(wanted, 2, 4))
    (own,) = model.parameters.pack()
    for name, factor, known in (("stiff", 1.0, [[]]), ("soft", 0.02, [[], ["bar"]])):
        case = np.array([[*light["force"], factor * own]])
        folder = export(model, tmp_path / name, load_cases=case, estimate_errors=False)
        arrangements = json.loads((folder / "manifest.json").read_text())["arrangements"]
        assert [[contact["obstacle"] for contact in entry["contacts"]] for entry in arrangements] == known


def test_contacts_on_the_way_to_other_parameters(tmp_path: Path) -> None:
    """A rod that grows soft comes to a table with its tip, and then lies: one load case, the soft rod, tells both."""
    light = {**WEIGHT, "force": [0, 0, -0.5]}
    wanted = scene(rods=[FLAT], loads=[light], obstacles=[TABLE], parameters=["rod.stiffness.bending_y"])
    soft = np.array([[*light["force"], 0.003]])
    library = exported_contact(wanted, tmp_path / "soft", soft, 3, 6, estimate_errors=False)
    found = library.loaded.start()
    kinds = []
    for stiffness in (0.4, 0.1, 0.006):
        found = library.loaded.solve(light["force"], found, parameters=[stiffness])
        assert_same(found, solve(library.model, parameters={"rod.stiffness.bending_y": stiffness}))
        kinds.append([contact.kind for contact in found.contacts])
    assert kinds == [[], ["point"], ["line"]]


def test_load_knows_the_folder_by_its_manifest(bar: ContactLibrary, tmp_path: Path) -> None:
    assert isinstance(load(bar.folder), CompiledContact)
    (tmp_path / "manifest.json").write_text('{"name": "bar", "inputs": [], "files": [], "arrangements": 3}')
    with pytest.raises(ExportError, match="is not the manifest of an exported folder"):
        load(tmp_path)


@pytest.mark.slow
def test_a_bar_thinner_than_sections_are_apart_is_met_in_c(tmp_path: Path) -> None:
    """Of 4 mm, in small turns and in one: the rod neither enters it nor passes through."""
    thin = {**BAR, "from": [0.51, -0.5, -0.05], "to": [0.51, 0.5, -0.05], "radius": 0.004}
    wanted = scene(rods=[FLAT], loads=[PUSH], obstacles=[thin], accuracy={"tolerance": 1e-8})
    library = exported_contact(wanted, tmp_path / "thin", down(8.0)[None], 3, 6)
    found = library.loaded.solve(down(0.0))
    for force in np.linspace(0.7, 1.2, 11):
        found = library.loaded.solve(down(force), found)
        assert_same(found, solve(library.model, down(force)))
    assert len(found.contacts) == 1
    assert len(library.loaded.solve(down(1.2), library.loaded.solve(down(0.0))).contacts) == 1


@pytest.mark.slow
def test_a_rod_that_slides_aside_over_a_bar(tmp_path: Path) -> None:
    """The example, in space: driven in a loop, as Python finds it."""
    wanted = read_scene("examples/rod_over_bar.toml", ["accuracy.modes=5"])
    model = build(wanted)
    library = load(export(model, tmp_path / "bar", load_cases=np.array([down(1.4), down(0.05)])))
    found = library.solve()
    for force in np.linspace(1.0, 1.4, 5):
        found = library.track(down(force), found)
        assert_same(found, solve(model, down(force)), forces=1e-8)
