"""The module of a page computes what the same C computes as a library of this machine."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Scene, build, export, load, solve
from cosserat_casadi.errors import ExportError
from cosserat_casadi.page.drawn_model import DrawnModel
from cosserat_casadi.page.page_facts import page_facts
from cosserat_casadi.page.webassembly import VARIABLE, find_wasm_compiler, wasm_of
from tests.page.pages_made import portal, run_node, strip, wasm_compiler


@pytest.mark.slow
@pytest.mark.parametrize(("made", "steps"), [(strip, 6), (portal, 3)])
def test_node_finds_what_gcc_finds(made: Callable[[], Scene], steps: int, tmp_path: Path) -> None:
    scene = made()
    compiler = wasm_compiler()
    solution = solve(build(scene))
    model = DrawnModel(solution.model.discrete)
    library = load(export(model, tmp_path / "robot"))
    defaults = library.defaults
    # The third is a long way off; from the last it goes back to the scene's own.
    shares = [1.0, 1.1, -2.0, 0.5, 0.55, 1.0][:steps]
    cases = [(share * defaults).tolist() for share in shares]
    (tmp_path / "facts.json").write_text(json.dumps(page_facts(solution)))
    (tmp_path / "inputs.json").write_text(json.dumps(cases))
    (tmp_path / "module.wasm").write_bytes(wasm_of(model, compiler))
    answer = run_node("solve.js", *(tmp_path / name for name in ("facts.json", "inputs.json", "module.wasm")))
    assert answer["imports"] == []
    for inputs, found in zip(cases, answer["solved"], strict=True):
        assert found["found"], found["text"]
        # Both stop where the residual is small: one more solve from there takes the last digits out of the comparison.
        again = library.solve(inputs, found["x"])
        assert again.converged
        assert_allclose(found["x"], again.x, rtol=0, atol=1e-12)
        drawn = library.drawn(found["x"], inputs).full()[:, 0]
        assert_allclose(found["drawn"], drawn, rtol=0, atol=1e-12)
        _, tips = library.sensitivity(inputs, found["x"])
        bodies = library.body_sensitivity(inputs, found["x"])
        expected = np.concatenate([derivative.T.ravel() for derivative in (*tips.values(), *bodies.values())])
        assert_allclose(found["derivatives"], expected, rtol=1e-10, atol=1e-12)
    first = answer["solved"][0]
    # The first is solved from the unloaded scene by both: digit by digit the same way.
    assert_allclose(first["x"], library.solve(cases[0]).x, rtol=0, atol=1e-12)
    assert first["label"] == "converged"
    if made is strip:
        assert_allclose(first["eigenvalues"][0], solution.smallest_eigenvalue, rtol=1e-8)
    else:
        # The moment of the hand has no potential.
        assert first["eigenvalues"] is None
        assert solution.smallest_eigenvalue is None


def test_a_machine_without_the_compiler_is_told_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, "no-such-clang")
    with pytest.raises(ExportError, match=r"--page: no-such-clang is not a program.*apt install clang lld wasi-libc"):
        find_wasm_compiler()
    monkeypatch.delenv(VARIABLE)
    monkeypatch.setenv("PATH", "")
    with pytest.raises(ExportError, match="there is no clang on the path"):
        find_wasm_compiler()


def test_a_compiler_that_makes_no_webassembly_says_why(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    false = tmp_path / "clang"
    false.write_text("#!/bin/sh\necho no such target >&2\nexit 1\n")
    false.chmod(0o755)
    monkeypatch.setenv(VARIABLE, str(false))
    with pytest.raises(ExportError, match=r"cannot make WebAssembly: no such target \(a page needs clang"):
        find_wasm_compiler()
