"""What pyproject.toml cannot say: the version, and that any Python will do. The wheel is made by `make wheel`."""

import re
from pathlib import Path

from setuptools import setup
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.dist import Distribution

CARGO = Path(__file__).resolve().parent.parent / "Cargo.toml"


def version() -> str:
    return re.search(r'^version = "(.*)"', CARGO.read_text(), re.MULTILINE)[1]


class WheelWithLibrary(Distribution):
    """A platform's wheel without extension modules."""

    def has_ext_modules(self) -> bool:
        return True


class AnyPython(bdist_wheel):
    """The library is called through ctypes: any Python will do, of one platform."""

    def get_tag(self) -> tuple[str, str, str]:
        return "py3", "none", super().get_tag()[2]


setup(version=version(), distclass=WheelWithLibrary, cmdclass={"bdist_wheel": AnyPython})
