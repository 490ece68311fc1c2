"""Options of a detection, from the library's own table."""

from __future__ import annotations

import ctypes
import os
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays
from ._handles import Handle, new_handle
from ._library import LIBRARY, OptionSpecStruct


@dataclass(frozen=True)
class OptionSpec:
    """What a dialog needs to show an option."""

    #: Keyword of :func:`intrinsym.detect`.
    name: str
    #: One sentence, in English.
    help: str
    #: Value used when none is given.
    default: float
    #: Smallest accepted value.
    minimum: float
    #: Largest accepted value.
    maximum: float
    #: Whether only whole numbers are accepted.
    is_integer: bool


def option_specs() -> list[OptionSpec]:
    """All options of a detection, in the library's order."""
    return [_describe(index) for index in range(LIBRARY.isym_option_count())]


def _describe(index: int) -> OptionSpec:
    found = OptionSpecStruct()
    LIBRARY.isym_option_describe(index, ctypes.byref(found))
    number = int if found.is_integer else float
    return OptionSpec(
        name=found.name.decode(),
        help=found.help.decode(),
        default=number(found.default_value),
        minimum=number(found.minimum),
        maximum=number(found.maximum),
        is_integer=bool(found.is_integer),
    )


def options_handle(
    options: dict[str, float],
    model: str | os.PathLike[str] | None,
    known_signs: ArrayLike | None,
) -> Handle:
    """The library's set of options. Raises OptionError as the library finds them wrong."""
    handle = new_handle("options", LIBRARY.isym_options_new)
    for name, value in options.items():
        LIBRARY.isym_options_set(handle.pointer, name.encode(), float(value))
    if model is not None:
        LIBRARY.isym_options_set_model(handle.pointer, os.fsencode(model))
    if known_signs is not None:
        signs = np.asarray(known_signs)
        signs = _arrays.exactly(signs, (signs.size,), np.int8, "known_signs")
        LIBRARY.isym_options_set_known_signs(handle.pointer, signs, signs.size)
    return handle
