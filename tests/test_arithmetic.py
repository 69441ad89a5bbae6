"""The command lines of `make test-arithmetic`, and what it leaves out."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tests import arithmetic
from tests.conftest import C_FLAGS, ROOT

VARIANTS = {variant.name: variant for variant in arithmetic.variants()}


def test_the_command_line_is_that_of_the_quick_tests() -> None:
    command = VARIANTS["C by -O2"].command(["-x"])
    assert command == [sys.executable, "-m", "pytest", "-q", "-m", "not slow", "-x", *arithmetic.COMPILED]
    for variant in VARIANTS.values():
        assert all((ROOT / path).exists() for path in variant.tests)
        assert set(arithmetic.COMPILED) <= set(variant.tests) or "threads" in variant.name


@pytest.mark.parametrize(
    ("flags", "left_out"),
    [
        ("", ["Prescott", "Haswell", "Zen", "SkylakeX", "glibc"]),
        ("sse2 pni", ["Haswell", "Zen", "SkylakeX", "glibc"]),
        ("sse2 pni avx2 fma", ["SkylakeX"]),
        ("sse2 pni avx2 fma avx512f", []),
    ],
)
def test_what_a_processor_cannot_run_is_left_out(flags: str, left_out: list[str]) -> None:
    able = frozenset(flags.split())
    names = [name for name, variant in VARIANTS.items() if not variant.runs_on(able)]
    assert [name.removeprefix("OpenBLAS for ").split()[0] for name in names] == left_out


def test_each_is_run_in_its_environment_and_failures_are_summed_up(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    started: list[dict[str, str]] = []

    def pretend(command: list[str], *, cwd: Path, env: dict[str, str], check: bool) -> Any:
        started.append(env)
        return subprocess.CompletedProcess(command, 1 if env.get("OPENBLAS_CORETYPE") == "Zen" else 0)

    monkeypatch.setattr(subprocess, "run", pretend)
    monkeypatch.setattr(arithmetic, "processor_flags", lambda: frozenset({"pni", "avx2"}))
    assert arithmetic.main(["--only", "OpenBLAS"]) == 1
    assert [env["OPENBLAS_CORETYPE"] for env in started] == ["Prescott", "Haswell", "Zen"]
    lines = capsys.readouterr().out.splitlines()[-4:]
    assert [line.split(maxsplit=3)[3] for line in lines] == [
        "passed", "passed", "FAILED", "skipped: this processor has no avx512f"
    ]  # fmt: skip
    assert arithmetic.main(["--only", "Haswell"]) == 0


def test_c_is_compiled_by_the_flags_of_the_environment(tmp_path: Path) -> None:
    """The compiler of these tests says how it was called."""
    test = tmp_path / "test_flags.py"
    test.write_text(
        "import os\n\ndef test_flags(quick_compiler):\n"
        "    calls = [line for line in open(os.environ['CC']) if 'exec' in line]\n"
        "    assert calls and all('\"$@\" -O3 -march=native;;' in line for line in calls)\n"
    )
    (tmp_path / "conftest.py").write_text("from tests.conftest import quick_compiler, workshop\n")
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--rootdir", tmp_path, test]
    environment = {"PYTHONPATH": str(ROOT), "PATH": "/usr/bin:/bin", C_FLAGS: "-O3 -march=native"}
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout
