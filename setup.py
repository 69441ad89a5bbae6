"""What pyproject.toml cannot say: examples and pages come with the package, from where they are in the repository."""

from __future__ import annotations

from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

SHIPPED = (
    "examples/*.toml",
    "examples/data/*.csv",
    "examples/data/*/*",
    "examples/sweeps/*.toml",
    "examples/validation/*.toml",
    "examples/*.py",
    "examples/*.ipynb",
    "examples/swing_free/*.py",
    "examples/*.c",
    "docs/*.md",
    "docs/api/*.md",
)
"""Files of the repository that lie in the package of a wheel, in folders of the same names."""


class BuildWithShippedFiles(build_py):
    """Copies them into the package; one that is installed for editing finds them where they are."""

    def run(self) -> None:
        """Build as ever, then copy."""
        super().run()
        if self.editable_mode:
            return
        for target, source in self._shipped().items():
            self.mkpath(str(Path(target).parent))
            self.copy_file(source, target)

    def get_output_mapping(self) -> dict[str, str]:
        """What is built by what it is built from."""
        if self.editable_mode:
            return super().get_output_mapping()
        return {**super().get_output_mapping(), **self._shipped()}

    def _shipped(self) -> dict[str, str]:
        """Files of the repository by where they go."""
        package = Path(self.build_lib) / "cosserat_casadi"
        files = [file for pattern in SHIPPED for file in sorted(Path().glob(pattern))]
        return {str(package / file): str(file) for file in files}


setup(cmdclass={"build_py": BuildWithShippedFiles})
