"""Ownership of the C library's handles."""

from __future__ import annotations

import ctypes
import weakref
from collections.abc import Callable

from ._library import LIBRARY


class Handle:
    """Owns one handle; it is freed with this object, and at the end of the program."""

    def __init__(self, pointer: ctypes.c_void_p, kind: str) -> None:
        self.pointer = pointer
        free = getattr(LIBRARY, f"isym_{kind}_free")
        self._finalizer = weakref.finalize(self, free, pointer)


def new_handle(kind: str, function: Callable[..., object], *arguments: object) -> Handle:
    """Calls a function whose last argument is a pointer to the handle that it makes."""
    pointer = ctypes.c_void_p()
    function(*arguments, ctypes.byref(pointer))
    return Handle(pointer, kind)
