"""Meshes in a process of their own that may be killed, so that none can take anything else with it.

The library is native code: a defect may end the process, a hostile mesh may take minutes or all memory. Neither can
be helped from inside the process. One process serves mesh after mesh, so the library is loaded once; only a mesh
that kills it costs a new one, some 0.2 s.
"""

from __future__ import annotations

import contextlib
import signal
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from multiprocessing.connection import Pipe
from typing import Any

from ._mesh_row import Request, Row, error_row

#: Seconds in which a process must have loaded the library.
START_SECONDS = 120.0
#: What Rust, C++ and Python say when they get no more memory.
SIGNS_OF_MEMORY = ("memory allocation of", "bad_alloc", "MemoryError")


@dataclass(frozen=True)
class Limits:
    """What one mesh may take."""

    #: Wall seconds, reading included.
    seconds: float
    #: MB (1,000,000 bytes) above what the process takes without a mesh.
    memory: int


class Died(Exception):
    """The process ended; the status is that of subprocess: minus the number of a signal."""

    def __init__(self, status: int, said: str) -> None:
        super().__init__(f"the process of the meshes ended with status {status}: {said}")
        self.status = status
        self.said = said


class MeshProcess:
    """A process that turns mesh files into rows. It ends with its owner, whatever ends that."""

    def __init__(self, limits: Limits) -> None:
        self.limits = limits
        self._running: _Running | None = None

    def row(self, path: str, name: str, options: dict[str, Any], write: tuple[str, ...] = ()) -> Row:
        """As :func:`intrinsym._mesh_row.row_of_file`; a crash, a timeout and too much memory are rows, too.

        Raises RuntimeError if the process cannot be started, with what it said.
        """
        request = (path, name, options, write)
        answer = self._ask(request)
        if answer is None:
            # Somebody else killed it, such as the system for memory that another process took: once more.
            answer = self._ask(request)
        text = "the process of the mesh was killed twice; the system may lack memory"
        return answer or error_row("Killed", text)

    def _ask(self, request: Request) -> Row | None:
        """The row; None if the process was killed, and not by us."""
        if self._running is not None and self._running.has_ended():
            self.stop()  # between two meshes, which is neither's fault
        if self._running is None:
            self._running = _Running(self.limits.memory)
        try:
            return self._running.answer(request, self.limits.seconds)
        except TimeoutError as error:
            self.stop()
            return error_row("Timeout", str(error))
        except Died as death:
            self.stop()
            sys.stderr.write(f"{request[1]}: {death}\n")
            return None if death.status == -signal.SIGKILL else _row_of_death(death)

    def stop(self) -> None:
        """Ends the process; the next mesh gets a new one."""
        if self._running is not None:
            self._running.stop()
            self._running = None


class _Running:
    """A process that has loaded the library."""

    def __init__(self, memory: int) -> None:
        self._connection, theirs = Pipe()
        self._errors = tempfile.TemporaryFile()
        command = [sys.executable, "-m", "intrinsym._isolated_main", str(theirs.fileno()), str(memory)]
        with theirs:
            self._process = subprocess.Popen(
                command, pass_fds=[theirs.fileno()], stdin=subprocess.DEVNULL, stderr=self._errors
            )
        try:
            self._receive(START_SECONDS)
        except (TimeoutError, Died) as error:
            self.stop()
            raise RuntimeError(f"the library of intrinsym does not start: {error}") from error

    def has_ended(self) -> bool:
        return self._process.poll() is not None

    def answer(self, request: Request, seconds: float) -> Row:
        """The row for a request. Raises TimeoutError; Died if the process ends over it."""
        try:
            self._connection.send(request)
        except ConnectionError:
            raise self._death() from None
        row: Row = self._receive(seconds)
        return row

    def _receive(self, seconds: float) -> Any:
        try:
            if not self._connection.poll(seconds):
                raise TimeoutError(f"no answer within {seconds:g} s")
            return self._connection.recv()
        except (EOFError, ConnectionError):
            raise self._death() from None

    def _death(self) -> Died:
        status = self._process.wait()
        self._errors.seek(0)
        return Died(status, self._errors.read()[-2000:].decode(errors="replace").strip())

    def stop(self) -> None:
        self._process.kill()
        self._process.wait()
        self._connection.close()
        self._errors.close()


def _row_of_death(death: Died) -> Row:
    if any(sign in death.said for sign in SIGNS_OF_MEMORY):
        return error_row("Memory", "the mesh needs more memory than one mesh may take")
    name = f"status {death.status}"
    if death.status < 0:
        with contextlib.suppress(ValueError):
            name = signal.Signals(-death.status).name
    return error_row("Crash", f"the library crashed ({name}); please report it with the mesh")
