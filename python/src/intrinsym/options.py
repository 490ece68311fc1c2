"""Options of a detection: the library's own table, which the keywords of :meth:`intrinsym.Mesh.detect` follow."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays
from ._handles import Handle, new_handle
from ._library import LIBRARY, OptionSpecStruct
from .errors import ERROR_OPTION, OptionError

#: How hard a detection tries.
Effort = Literal["fast", "default", "thorough"]


@dataclass(frozen=True)
class OptionSpec:
    """What a dialog needs to show an option."""

    #: Keyword of :meth:`intrinsym.Mesh.detect`.
    name: str
    #: One sentence, in English.
    help: str
    #: Names of the values from 0 on, which are given in their place; empty where values have none.
    choices: tuple[str, ...]
    #: Value used when none is given.
    default: int
    #: Smallest accepted value but for the default.
    minimum: int
    #: Largest accepted value.
    maximum: int
    #: Whether only experts need it.
    is_expert: bool


def option_specs() -> list[OptionSpec]:
    """All options of a detection, in the library's order."""
    return [_describe(index) for index in range(LIBRARY.isym_option_count())]


def _describe(index: int) -> OptionSpec:
    found = OptionSpecStruct()
    LIBRARY.isym_option_describe(index, ctypes.byref(found))
    return OptionSpec(
        name=found.name.decode(),
        help=found.help.decode(),
        choices=tuple(found.choices.decode().split("|")) if found.choices else (),
        default=int(found.default_value),
        minimum=int(found.minimum),
        maximum=int(found.maximum),
        is_expert=bool(found.is_expert),
    )


def _number(name: str, value: Any) -> float:
    """A value, or the number of a choice that is named."""
    try:
        if not isinstance(value, str):
            return float(value)
    except (TypeError, ValueError, OverflowError):
        raise OptionError(f"option {name}: {value!r} is not a number", ERROR_OPTION) from None
    choices = next((spec.choices for spec in option_specs() if spec.name == name), ())
    if value not in choices:
        known = f"one of {', '.join(choices)}" if choices else "a number"
        raise OptionError(f"option {name}: {value!r} is not {known}", ERROR_OPTION)
    return float(choices.index(value))


def options_handle(
    options: Mapping[str, Any],
    model: str | os.PathLike[str] | None,
    known_signs: ArrayLike | None,
) -> Handle:
    """The library's set of options; None leaves its default. Raises OptionError as the library finds them wrong."""
    handle = new_handle("options", LIBRARY.isym_options_new)
    for name, value in options.items():
        if value is not None:
            LIBRARY.isym_options_set(handle.pointer, name.encode(), _number(name, value))
    if model is not None:
        LIBRARY.isym_options_set_model(handle.pointer, _arrays.path(model))
    if known_signs is not None:
        signs = _arrays.plain(known_signs, "known_signs")
        signs = _arrays.exactly(signs, (signs.size,), np.int8, "known_signs")
        LIBRARY.isym_options_set_known_signs(handle.pointer, signs, signs.size)
    return handle
