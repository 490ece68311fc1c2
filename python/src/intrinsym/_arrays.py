"""Arrays as the C library takes them. What does not fit is refused here; everything else it checks itself."""

from __future__ import annotations

import operator
import os
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import ERROR_INDEX, ERROR_LENGTH, ERROR_MESH, ERROR_VALUE, ArgumentError, MeshError

_LARGEST_INDEX = 2**32 - 2

Number = TypeVar("Number", bound=np.generic)


def path(given: str | os.PathLike[str]) -> bytes:
    """A path as the library takes it, which would end it at a NUL."""
    encoded = os.fsencode(given)
    if b"\0" in encoded:
        raise ArgumentError(f"the path {os.fspath(given)!r} holds a NUL", ERROR_VALUE)
    return encoded


def plain(values: ArrayLike, name: str) -> NDArray[Any]:
    """An array without a mask. One of which entries are masked is refused: what lies under a mask has no meaning."""
    masked = np.count_nonzero(values.mask) if isinstance(values, np.ma.MaskedArray) else 0
    if masked > 0:
        text = f"{name} has {masked} masked entries; fill or remove them, for instance with filled()"
        raise ArgumentError(text, ERROR_VALUE)
    try:
        return np.asarray(values)
    except ValueError as fault:
        raise ArgumentError(f"{name} is no array: {fault}", ERROR_LENGTH) from None


def points(values: ArrayLike, name: str) -> NDArray[Any]:
    """An (n, 3) array of float32, if it was one, or float64."""
    array = plain(values, name)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ArgumentError(f"{name} has the shape {array.shape}; (vertices, 3) is needed", ERROR_LENGTH)
    return np.ascontiguousarray(array, np.float32 if array.dtype == np.float32 else _real(array, name))


def values_of(values: ArrayLike, rows: int, name: str) -> NDArray[np.float64]:
    """A (rows, ...) array of float64."""
    array = plain(values, name)
    if array.ndim == 0 or array.shape[0] != rows:
        text = f"{name} has the shape {array.shape}; one row for each of {rows} vertices is needed"
        raise ArgumentError(text, ERROR_LENGTH)
    return np.ascontiguousarray(array, _real(array, name))


def vectors(values: ArrayLike, rows: int, name: str) -> NDArray[np.float64]:
    """A (rows, 3) array of float64."""
    array = values_of(values, rows, name)
    if array.shape != (rows, 3):
        raise ArgumentError(f"{name} has the shape {array.shape}; ({rows}, 3) is needed", ERROR_LENGTH)
    return array


def _real(array: NDArray[Any], name: str) -> type[np.float64]:
    if array.dtype.kind not in "fiub":
        raise ArgumentError(f"{name} holds {array.dtype}; real numbers are needed", ERROR_VALUE)
    return np.float64


def indices(values: ArrayLike, name: str) -> NDArray[np.uint32]:
    """An array of uint32 of the same shape; names the first entry that is none."""
    array = plain(values, name)
    if array.size == 0:
        return np.zeros(array.shape, np.uint32)
    if array.dtype.kind not in "iu":
        raise ArgumentError(f"{name} indices are {array.dtype}; whole numbers are needed", ERROR_VALUE)
    if array.min() < 0 or array.max() > _LARGEST_INDEX:
        place = np.argwhere((array < 0) | (array > _LARGEST_INDEX))[0]
        text = f"the mesh cannot be used: {name} {place[0]} has the index {array[tuple(place)]}"
        raise MeshError(f"{text}; indices count from 0", ERROR_MESH)
    return np.ascontiguousarray(array, np.uint32)


def count(value: int, name: str) -> int:
    """A whole number that the library's unsigned sizes can hold; the library checks its range."""
    number = operator.index(value)
    if not 0 <= number <= _LARGEST_INDEX:
        raise ArgumentError(f"{name} is {number}, which is no count", ERROR_INDEX)
    return number


def constant(value: int, name: str) -> int:
    """The number of a constant of the library, which checks whether it has such a one."""
    try:
        return operator.index(value)
    except TypeError:
        raise ArgumentError(f"{name} is {value!r}, which is no {name.capitalize()}", ERROR_VALUE) from None


def exactly(values: ArrayLike, shape: tuple[int, ...], kind: type[Number], name: str) -> NDArray[Number]:
    """An array of this shape and kind, from one whose values all fit into it."""
    array = plain(values, name)
    if array.shape != shape:
        raise ArgumentError(f"{name} has the shape {array.shape}; {shape} is needed", ERROR_LENGTH)
    converted = np.ascontiguousarray(array, kind)
    if np.issubdtype(kind, np.integer) and not np.array_equal(converted, array):
        raise ArgumentError(f"{name} holds values that are no {np.dtype(kind).name}", ERROR_VALUE)
    return converted
