"""What pyproject.toml cannot say: the version, the program, and that any Python will do.

Whoever makes a wheel (`make wheel`, `make release`) puts the library of its platform into src/intrinsym/lib, and the command
line's program, which needs nothing beside it, into bin.
"""

import re
from distutils.command.build_scripts import build_scripts
from pathlib import Path

from setuptools import setup
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.dist import Distribution

HERE = Path(__file__).resolve().parent
CARGO = HERE.parent / "Cargo.toml"


def version() -> str:
    return re.search(r'^version = "(.*)"', CARGO.read_text(), re.MULTILINE)[1]


def programs() -> list[str]:
    return [str(path.relative_to(HERE)) for path in HERE.glob("bin/intrinsym*")]


class WheelWithLibrary(Distribution):
    """A platform's wheel without extension modules."""

    def has_ext_modules(self) -> bool:
        return True


class Programs(build_scripts):
    """Copies programs as they are: setuptools takes scripts for texts."""

    def copy_scripts(self) -> tuple[list[str], list[str]]:
        self.mkpath(self.build_dir)
        copies = [self.copy_file(program, self.build_dir)[0] for program in self.scripts]
        return copies, copies


class AnyPython(bdist_wheel):
    """The library is called through ctypes: any Python will do, of one platform."""

    def get_tag(self) -> tuple[str, str, str]:
        return "py3", "none", super().get_tag()[2]


setup(
    version=version(),
    scripts=programs(),
    distclass=WheelWithLibrary,
    cmdclass={"bdist_wheel": AnyPython, "build_scripts": Programs},
)
