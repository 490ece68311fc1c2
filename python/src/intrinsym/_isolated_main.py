"""The process of :mod:`intrinsym._isolated`: ``python -m intrinsym._isolated_main CONNECTION MEMORY``."""

from __future__ import annotations

import importlib
import os
import queue
import sys
import threading
from collections.abc import Callable
from multiprocessing.connection import Connection
from pathlib import Path

from ._mesh_row import Request, row_of_file

#: For tests: "MODULE:FUNCTION", called with the name of each mesh before it is read.
TEST_HOOK = "INTRINSYM_TEST_HOOK"


def main() -> None:
    """Answers one request after the other, until the owner's end of the connection is closed."""
    connection = Connection(int(sys.argv[1]))
    hook = _test_hook()
    requests: queue.SimpleQueue[Request] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(connection, requests), daemon=True).start()
    limit_memory(int(sys.argv[2]))
    connection.send("ready")
    while True:
        path, name, options, write = requests.get()
        hook(name)
        connection.send(row_of_file(path, name, options, write))


def _listen(connection: Connection, requests: queue.SimpleQueue[Request]) -> None:
    """Hands requests on. In a thread, so that the end of the owner ends this process in the middle of a mesh, too."""
    try:
        while True:
            requests.put(connection.recv())
    except (EOFError, OSError):
        os._exit(0)
    except MemoryError:
        print("MemoryError", file=sys.stderr, flush=True)
        os._exit(1)


def limit_memory(megabytes: int) -> None:
    """Lets this process take so many MB of private memory more than now. Linux only; no limit elsewhere."""
    if not sys.platform.startswith("linux"):
        return
    import resource

    status = Path("/proc/self/status").read_text()
    (now,) = (int(line.split()[1]) * 1024 for line in status.splitlines() if line.startswith("VmData:"))
    limit = now + megabytes * 1_000_000
    _, most = resource.getrlimit(resource.RLIMIT_DATA)
    resource.setrlimit(
        resource.RLIMIT_DATA, (limit if most == resource.RLIM_INFINITY else min(limit, most), most)
    )


def _test_hook() -> Callable[[str], object]:
    module, _, function = os.environ.get(TEST_HOOK, "builtins:str").partition(":")
    hook: Callable[[str], object] = getattr(importlib.import_module(module), function)
    return hook


if __name__ == "__main__":
    main()
