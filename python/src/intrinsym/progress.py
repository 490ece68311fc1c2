"""Progress of a call, and the way to cancel it."""

from __future__ import annotations

import ctypes
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeVar, Union

from ._handles import new_handle
from ._library import LIBRARY, ProgressCallback
from .errors import CancelledError

#: Called with the stage's name and the fraction of the call that is done, 0..1, never falling.
#: Answer False to cancel; any other answer, None too, goes on.
Callback = Callable[[str, float], object]

Answer = TypeVar("Answer")


class Progress:
    """Progress of one call; make one for each call, because once cancelled it stays so.

    ``callback(stage, fraction)`` runs in the thread of the call. An exception that it raises cancels the call
    and comes out of it unchanged; so does Ctrl-C in the main thread, with or without a callback.
    """

    def __init__(self, callback: Callback | None = None) -> None:
        self._handle = new_handle("progress", LIBRARY.isym_progress_new)
        # The closure has no reference to self: nothing is circular, and the handle is freed at once.
        raised: list[BaseException] = []
        self._raised = raised

        def report(stage: bytes, fraction: float, _user_data: object) -> int:
            try:
                return 1 if callback is not None and callback(stage.decode(), fraction) is False else 0
            except BaseException as error:  # noqa: BLE001 - it is raised again when the call has ended
                raised.append(error)
                return 1

        self._report = ProgressCallback(report)
        LIBRARY.isym_progress_set_callback(self._handle.pointer, self._report, None)

    @property
    def fraction(self) -> float:
        """How much of the call is done, 0..1. From any thread."""
        fraction = ctypes.c_double()
        LIBRARY.isym_progress_fraction(self._handle.pointer, ctypes.byref(fraction))
        return fraction.value

    def cancel(self) -> None:
        """Cancels the running call, and every later one, with this progress. From any thread.

        The call raises CancelledError within half a second on a mesh of 100,000 vertices, whatever its form.
        """
        LIBRARY.isym_progress_cancel(self._handle.pointer)

    def run(self, call: Callable[[ctypes.c_void_p], Answer]) -> Answer:
        """Runs a call with this progress' handle; the callback's exception goes before its own."""
        try:
            with self._cancelled_by_control_c():
                return call(self._handle.pointer)
        except CancelledError:
            if self._raised:
                raise self._raised.pop() from None
            raise

    @contextmanager
    def _cancelled_by_control_c(self) -> Iterator[None]:
        """Lets Ctrl-C cancel. Python's own handler would raise before the callback's first line, and ctypes
        swallows what is raised there."""

        def cancel(_number: int, _frame: object) -> None:
            self._raised.append(KeyboardInterrupt())
            self.cancel()

        ours = threading.current_thread() is threading.main_thread()
        if not ours or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
            yield
            return
        signal.signal(signal.SIGINT, cancel)
        try:
            yield
        finally:
            signal.signal(signal.SIGINT, signal.default_int_handler)
        if self._raised:
            raise self._raised.pop()


#: What functions take: a Progress, or just its callback, or nothing.
ProgressLike = Union[Progress, Callback, None]


def progress_of(progress: ProgressLike) -> Progress:
    """The Progress itself, or a new one."""
    return progress if isinstance(progress, Progress) else Progress(progress)
