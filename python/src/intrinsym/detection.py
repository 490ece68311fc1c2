"""What was found on a mesh."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator, Sequence
from typing import overload

from ._handles import Handle
from ._library import LIBRARY
from .report import Outcome, Report
from .symmetry import Symmetry


class Detection(Sequence[Symmetry]):
    """The symmetries that were found, the best first; empty, and false, where there are none.

    Finding none is an answer and no error: :attr:`evidence` says why. A doubtful one is given, too, and counts: see
    :attr:`outcome`. It can be pickled, with the mesh, as its symmetries can.
    """

    def __init__(self, symmetries: Sequence[Symmetry], report: Report) -> None:
        self._symmetries = list(symmetries)
        #: What was done and measured.
        self.report = report

    def __len__(self) -> int:
        return len(self._symmetries)

    @overload
    def __getitem__(self, index: int) -> Symmetry: ...
    @overload
    def __getitem__(self, index: slice) -> list[Symmetry]: ...
    def __getitem__(self, index: int | slice) -> Symmetry | list[Symmetry]:
        return self._symmetries[index]

    def __iter__(self) -> Iterator[Symmetry]:
        return iter(self._symmetries)

    def __repr__(self) -> str:
        return f"<Detection {self.outcome.value} {self._symmetries!r}>"

    @property
    def outcome(self) -> Outcome:
        """Found, doubtful or none."""
        return self.report.outcome

    @property
    def evidence(self) -> str:
        """One sentence that says why the outcome is what it is; its figures are ``report.judged``."""
        return self.report.evidence

    @property
    def continuous_family(self) -> bool:
        """Whether the mesh has infinitely many symmetries, as a sphere, a torus or a vase has.

        Those found are then arbitrary ones of them.
        """
        return self.report.continuous_family


def symmetry_count(result: Handle) -> int:
    """How many symmetries a result of the library has."""
    count = ctypes.c_size_t()
    LIBRARY.isym_result_symmetry_count(result.pointer, ctypes.byref(count))
    return count.value


def report_of(result: Handle) -> Report:
    """The report of a result of the library."""
    size = ctypes.c_size_t()
    LIBRARY.isym_result_report_size(result.pointer, ctypes.byref(size))
    text = ctypes.create_string_buffer(size.value)
    LIBRARY.isym_result_report(result.pointer, text, size.value)
    return Report.from_json(text.value.decode())
