# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures how long Blender stands still in a detection of hard meshes of 100,000 vertices, and prints a table for docs/robustness.md.

usage: hard.py

The meshes are those of evaluation/hard_meshes.py. Blender's main thread copies the mesh (*start*), looks at the worker ten times
a second, and stores the result (*end*); *tick* is the most that it computes between two of these looks. There is no window here: a loop sleeps in the
place of the timer. A cancel comes at CANCELS moments spread over the detection, and is seen at the tick after the worker has ended. All are
seconds of the processor, so that other work on the machine counts little: of the main thread, but *detection* and *cancel* of all threads.
"""

import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "tests"), str(HERE.parents[1])]

from conftest import install, module, new_object  # noqa: E402  (sets bpy up)

import bpy  # noqa: E402
from evaluation.hard_meshes import MESHES  # noqa: E402

TICK, CANCELS = 0.1, 4


def body(arrays):
    """An object of vertices and faces."""
    points, faces = arrays
    mesh = bpy.data.meshes.new("hard")
    mesh.from_pydata(points.tolist(), [], faces.tolist())
    return new_object(mesh, "hard")


def started(object):
    """(the running job, seconds that it took to start)."""
    detection, start = module("detection"), time.thread_time()
    make = detection.maker_of(object, "BASE", bpy.context.evaluated_depsgraph_get())
    seconds = time.thread_time() - start
    return detection.Job(make, {}), seconds


def watched(job, cancel_after=None):
    """Ticks until the worker has ended: (seconds, the longest tick, seconds from the cancel)."""
    start, longest, cancelled = time.process_time(), 0.0, None
    while job.is_running():
        before = time.thread_time()
        if cancelled is None and cancel_after is not None and time.process_time() - start >= cancel_after:
            job.cancel()
            cancelled = time.process_time()
        time.sleep(TICK)
        longest = max(longest, time.thread_time() - before)
    end = time.process_time()
    return end - start, longest, end - cancelled if cancelled else 0.0


def stored(object, job):
    """Seconds that it takes to store what was found; the outcome."""
    start, found = time.thread_time(), job.answer()
    if found:
        module("ops_detect").keep(object, job.core_mesh, found)
        module("detection").remember(object.data, job.core_mesh, found)
    return time.thread_time() - start, found.outcome.name.lower()


def measured(make):
    """A row of the table, without the name."""
    object = body(make())
    job, start = started(object)
    seconds, tick, _ = watched(job)
    end, outcome = stored(object, job)
    cancels = []
    for moment in range(CANCELS):
        job, _ = started(object)
        cancels.append(watched(job, seconds * (moment + 0.5) / CANCELS)[2])
        try:
            job.answer()
        except module("detection").intrinsym.CancelledError:
            pass
    bpy.data.objects.remove(object)
    return outcome, *(f"{value:.2f}" for value in (start, seconds, tick, end, max(cancels)))


def main():
    install()
    print(f"Blender {bpy.app.version_string}\n")
    print("| mesh | outcome | start | detection | tick | end | after cancel |\n|---|---|---|---|---|---|---|", flush=True)
    for name, make in MESHES.items():
        print("|", " | ".join((name, *measured(make))), "|", flush=True)


if __name__ == "__main__":
    main()
