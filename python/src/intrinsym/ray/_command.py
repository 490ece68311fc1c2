"""``intrinsym-batch``: many meshes into a folder of Parquet files; the same command again does what is missing."""

from __future__ import annotations

import argparse
import json
import logging
import os
import sys
import time
from collections.abc import Callable, Sequence
from typing import Any

import ray
import ray.data
import ray.exceptions

from .._library import library_version
from .._mesh_row import FILE_KINDS
from ..errors import IntrinsymError
from ..options import option_specs
from ._dataset import MEMORY, TIMEOUT, job_of
from ._inputs import find_meshes, place_of
from ._store import Busy, Store
from ._work import Plan, run

#: The kinds of errors that a row may have.
ERROR_KINDS = (
    "Unreadable", "Timeout", "Memory", "Crash", "Killed",
    *(error.__name__ for error in IntrinsymError.__subclasses__()),
)  # fmt: skip
#: Options of the library that the command sets by its own ones.
OWN_OPTIONS = ("threads", "memory")
#: Seconds of a detection unless others are asked for: a mesh that needs more is doubtful, not lost.
TIME_LIMIT = 60
EXIT_STATUS = """Exit status: 0 every mesh has its row, which may be an error; 2 the command could not run; 130 interrupted."""


def main(words: Sequence[str] | None = None) -> int:
    """Entry; the exit status."""
    arguments = parser().parse_args(words)
    try:
        summary = _run_where_asked(arguments)
    except (IntrinsymError, ValueError, OSError, Busy, ray.exceptions.RayError) as error:
        print(f"intrinsym-batch: {_text_of(error)}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("intrinsym-batch: interrupted; the same command goes on", file=sys.stderr)
        return 130
    if not arguments.quiet:
        print(_described(summary))
    return 0


def parser() -> argparse.ArgumentParser:
    """The command line; numbers of the method come from the library's own table."""
    made = argparse.ArgumentParser(
        prog="intrinsym-batch", description=(__doc__ or "").partition(": ")[2], epilog=EXIT_STATUS
    )
    add = made.add_argument
    add("--version", action="version", version=f"%(prog)s {library_version()}")
    add("inputs", nargs="+", metavar="INPUTS",
        help="folders, patterns, text files (.txt) with one path a line, mesh files; paths, or URIs such as s3://")  # fmt: skip
    add(
        "--output",
        required=True,
        metavar="DIR",
        help="folder of the results, a path or URI that all machines see",
    )
    add(
        "--address",
        help="a running Ray: auto, HOST:PORT or ray://HOST:PORT (default: $RAY_ADDRESS, or start one here)",
    )
    add(
        "--cpus-per-mesh",
        type=_positive(float),
        default=1.0,
        metavar="N",
        help="CPUs for each mesh (default: 1)",
    )
    add("--timeout", type=_positive(float), default=TIMEOUT, metavar="S",
        help=f"wall seconds for one mesh, after which it is an error (default: {TIMEOUT:g})")  # fmt: skip
    add("--memory", type=_positive(int), metavar="MB",
        help=f"memory for one mesh, more of which is an error; Ray keeps it free (default: {MEMORY}, and keeps none)")  # fmt: skip
    add("--write", type=_words(FILE_KINDS), default=(), metavar="KINDS",
        help="files to write for each mesh besides its row: map, ply, or map,ply")  # fmt: skip
    add("--again", type=_words(ERROR_KINDS), default=(), metavar="KINDS",
        help="try meshes with these errors again, such as Timeout,Memory")  # fmt: skip
    add("--quiet", "-q", action="store_true", help="print nothing but errors")
    method = made.add_argument_group("the method, as in `intrinsym detect`")
    for spec in option_specs():
        if spec.name not in OWN_OPTIONS:
            kind: dict[str, Any] = (
                {"choices": spec.choices} if spec.choices else {"type": int, "metavar": "N"}
            )
            method.add_argument(f"--{spec.name.replace('_', '-')}", help=spec.help.replace("%", "%%"), **kind)
    method.set_defaults(time_limit=TIME_LIMIT)
    return made


def _positive(kind: type) -> Callable[[str], Any]:
    def number(text: str) -> Any:
        value = kind(text)
        if not value > 0:
            raise argparse.ArgumentTypeError(f"{text} is not above 0")
        return value

    return number


def _words(known: Sequence[str]) -> Callable[[str], tuple[str, ...]]:
    def split(text: str) -> tuple[str, ...]:
        words = tuple(sorted(set(filter(None, text.split(",")))))
        for word in words:
            if word not in known:
                raise argparse.ArgumentTypeError(f"{word!r} is none of {', '.join(known)}")
        return words

    return split


def _run_where_asked(arguments: argparse.Namespace) -> dict[str, Any]:
    """Connects to Ray and runs. Through a Ray client the whole run is a task of the cluster, which then needs no
    more of this machine than to wait for it."""
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    ours = not ray.is_initialized()
    if ours:
        # Without an address Ray would join whatever runs on this machine, and end with it.
        address = arguments.address or os.environ.get("RAY_ADDRESS") or "local"
        ray.init(address=address, log_to_driver=False, logging_level=logging.ERROR)
    try:
        if (arguments.address or "").startswith("ray://"):
            summary: dict[str, Any] = ray.get(ray.remote(num_cpus=0)(_run).remote(arguments, False))
            return summary
        return _run(arguments, sys.stderr.isatty() and not arguments.quiet)
    finally:
        if ours:
            ray.shutdown()


def _run(arguments: argparse.Namespace, show_progress: bool) -> dict[str, Any]:
    _silence_ray_data()
    folder = place_of(arguments.output)
    chosen = {spec.name: getattr(arguments, spec.name, None) for spec in option_specs()}
    options = {name: chosen[name] for name in chosen if chosen[name] is not None and name not in OWN_OPTIONS}
    job = job_of(options, arguments.cpus_per_mesh, arguments.timeout, arguments.memory, arguments.write)
    meshes = find_meshes(arguments.inputs, without=folder)
    store = Store.open(folder, job.options)
    plan = Plan(job, store, arguments.cpus_per_mesh, arguments.memory, frozenset(arguments.again))
    with store.lock():
        summary = run(plan, meshes, _progress_line(len(meshes)) if show_progress else lambda *_: None)
        store.write_file("summary.json", (json.dumps(summary, indent=1, default=str) + "\n").encode())
    return summary


def _silence_ray_data() -> None:
    context = ray.data.DataContext.get_current()
    context.enable_progress_bars = False
    logging.getLogger("ray.data").setLevel(logging.ERROR)


def _progress_line(meshes: int) -> Callable[[int, int], None]:
    """Writes one line to the terminal, over and over."""
    start = time.monotonic()

    def show(done: int, errors: int) -> None:
        left = (time.monotonic() - start) * (meshes - done) / max(done, 1)
        trouble = f", {errors} errors" if errors else ""
        ending = "\n" if done == meshes else ""
        sys.stderr.write(f"\r\x1b[K{done} of {meshes} meshes{trouble}, {left / 60:.1f} min left{ending}")
        sys.stderr.flush()

    return show


def _described(summary: dict[str, Any]) -> str:
    """What was done, in two or three lines."""
    outcomes = ", ".join(f"{count} {outcome}" for outcome, count in summary["outcomes"].items())
    errors = ", ".join(f"{count} {kind}" for kind, count in summary["errors"].items())
    lines = [f"{summary['meshes']} meshes: {outcomes}"]
    if errors:
        lines.append(f"  errors: {errors}")
    return "\n".join([*lines, f"  {summary['new_rows']} new rows in {summary['rows']}"])


def _text_of(error: BaseException) -> str:
    """What a person needs; of an error in a task of the cluster, its cause."""
    return str(getattr(error, "cause", None) or error)
