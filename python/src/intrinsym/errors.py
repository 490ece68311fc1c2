"""Exceptions, named by who can act on them. Their text is the library's."""

from __future__ import annotations


class IntrinsymError(Exception):
    """What went wrong; the text says what, where, and what to do about it.

    ``status`` is the number of the C library's ``ISYM_ERROR_`` code.
    """

    def __init__(self, message: str, status: int) -> None:
        super().__init__(message)
        self.status = status

    def __reduce__(self) -> tuple[type[IntrinsymError], tuple[str, int]]:
        return type(self), (str(self), self.status)


class ArgumentError(IntrinsymError, ValueError):
    """An array has not the shape, the length or the values that are needed."""


class MeshError(IntrinsymError, ValueError):
    """The mesh cannot be used; the text names the element and the reason."""


class MeshFileError(IntrinsymError, OSError):
    """The file cannot be read; the text names the line or byte and what to do."""


class OptionError(IntrinsymError, ValueError):
    """An option is unknown or outside its range."""


class ModelError(IntrinsymError):
    """The sign network's model cannot be used."""


class LimitError(IntrinsymError):
    """The mesh or file is larger than the limits allow."""


class CancelledError(IntrinsymError):
    """The call was cancelled through its progress."""


class InternalError(IntrinsymError):
    """A defect of the library; please report it with the text."""


# The numbers of include/isym.h that exceptions are chosen by; a test compares them with the header.
ERROR_LENGTH = 3
ERROR_INDEX = 4
ERROR_TEXT = 5
ERROR_VALUE = 6
ERROR_MESH = 16
ERROR_FILE = 17
ERROR_OPTION = 18
ERROR_MODEL = 19
ERROR_LIMIT = 20
ERROR_CANCELLED = 21

_BY_STATUS: dict[int, type[IntrinsymError]] = {
    ERROR_LENGTH: ArgumentError,
    ERROR_INDEX: ArgumentError,
    ERROR_TEXT: ArgumentError,
    ERROR_VALUE: ArgumentError,
    ERROR_MESH: MeshError,
    ERROR_FILE: MeshFileError,
    ERROR_OPTION: OptionError,
    ERROR_MODEL: ModelError,
    ERROR_LIMIT: LimitError,
    ERROR_CANCELLED: CancelledError,
}


def error_of(status: int, message: str) -> IntrinsymError:
    """The exception for a status of the C library; a defect where the status is unknown."""
    return _BY_STATUS.get(status, InternalError)(message, status)
