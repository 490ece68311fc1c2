"""The keywords of a detection are the library's own table of options."""

from __future__ import annotations

import inspect
import re
from typing import Literal

import numpy as np
import pytest

import intrinsym

SPECS = {spec.name: spec for spec in intrinsym.option_specs()}
#: Keywords that are no numbers, and so not in the table.
OTHERS = ["model", "known_signs", "previous", "progress"]

CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
QUADS = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


def type_of(spec: intrinsym.OptionSpec) -> object:
    if spec.choices:
        return Literal[spec.choices]
    return bool if (spec.minimum, spec.maximum) == (0, 1) else int


def documented(spec: intrinsym.OptionSpec) -> str:
    """What the docstring says of an option's type, range and default; 0 may mean that the effort says, or no limit."""
    if spec.choices:
        return "{" + ", ".join(f'"{choice}"' for choice in spec.choices) + "}"
    if type_of(spec) is bool:
        return f"bool, default {bool(spec.default)}"
    unit = {"memory": " MB", "time_limit": " seconds", "plausibility": " percent"}.get(spec.name, "")
    default = f", default {spec.default}" if spec.default >= spec.minimum else ""
    return f"int, {spec.minimum} to {spec.maximum}{unit}{default}"


def test_the_keywords_are_the_table_s_names_in_its_order_and_leave_the_defaults():
    _, *parameters = inspect.signature(intrinsym.Mesh.detect).parameters.values()
    assert [parameter.name for parameter in parameters] == [*SPECS, *OTHERS]
    assert all(parameter.kind is parameter.KEYWORD_ONLY and parameter.default is None for parameter in parameters)


@pytest.mark.parametrize("spec", SPECS.values(), ids=SPECS)
def test_the_types_and_the_docstring_are_those_of_the_table(spec):
    annotation = inspect.signature(intrinsym.Mesh.detect).parameters[spec.name].annotation
    written = {"Effort | None": intrinsym.Effort, "int | None": int, "bool | None": bool}
    assert written[annotation] == type_of(spec)
    (line,) = re.findall(rf"^ *{spec.name} : (.*)$", intrinsym.Mesh.detect.__doc__, re.MULTILINE)
    assert line == documented(spec)


@pytest.mark.parametrize("spec", SPECS.values(), ids=SPECS)
def test_each_option_reaches_the_library_at_both_ends_and_not_beyond(spec):
    assert spec.help.endswith(".") and (spec.default == 0 or spec.minimum <= spec.default <= spec.maximum)
    values = spec.choices or (spec.minimum, spec.maximum)
    for value in values:
        report = intrinsym.detect(CUBE, QUADS, **{spec.name: value}).report
        assert report.options[spec.name] == value
    with pytest.raises(intrinsym.OptionError, match=spec.name):
        intrinsym.detect(CUBE, QUADS, **{spec.name: spec.maximum + 1})


def test_functions_of_arrays_show_the_keywords_of_the_methods():
    for function, method in ((intrinsym.detect, intrinsym.Mesh.detect), (intrinsym.eigen, intrinsym.Mesh.eigen)):
        vertices, faces, *keywords = inspect.signature(function).parameters.values()
        assert (vertices.name, faces.name) == ("vertices", "faces")
        assert keywords == list(inspect.signature(method).parameters.values())[1:]
