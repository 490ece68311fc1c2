"""Progress, cancel, and several threads at once."""

from __future__ import annotations

import gc
import signal
import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import intrinsym
from intrinsym._library import LIBRARY


def test_progress_rises_from_start_to_one_and_names_stages(quadruped):
    seen = []
    progress = intrinsym.Progress(lambda stage, fraction: seen.append((stage, fraction)))
    quadruped.detect(progress=progress)
    fractions = [fraction for _, fraction in seen]
    assert fractions == sorted(fractions) and fractions[-1] == 1.0
    assert len({stage for stage, _ in seen}) >= 4
    assert progress.fraction == 1.0


def test_false_cancels_and_nothing_follows(quadruped):
    seen = []

    def stop_half_way(_stage, fraction):
        seen.append(fraction)
        return fraction < 0.5

    with pytest.raises(intrinsym.CancelledError):
        quadruped.detect(progress=stop_half_way)
    assert seen[-1] >= 0.5 and all(fraction < 0.5 for fraction in seen[:-1])


def test_cancel_from_another_thread(quadruped):
    reached = threading.Event()
    progress = intrinsym.Progress(lambda _stage, fraction: reached.set() if fraction > 0 else None)
    threading.Thread(target=lambda: reached.wait(60) and progress.cancel()).start()
    with pytest.raises(intrinsym.CancelledError):
        quadruped.detect(progress=progress, samples=5000, beam_width=256)
    with pytest.raises(intrinsym.CancelledError):
        quadruped.detect(progress=progress)


def test_an_exception_of_the_callback_comes_out_unchanged(quadruped):
    thrown = KeyError("mine")

    def fail(_stage, fraction):
        if fraction > 0.2:
            raise thrown

    with pytest.raises(KeyError) as caught:
        quadruped.detect(progress=fail)
    assert caught.value is thrown


@pytest.mark.skipif(not hasattr(signal, "SIGINT"), reason="needs signals")
def test_control_c_stops_a_call_without_callback(quadruped):
    # A process that was started in the background may have been told to ignore it.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(0.05, signal.raise_signal, [signal.SIGINT])
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        while True:
            quadruped.detect()
    timer.join()
    signal.signal(signal.SIGINT, before)


def test_threads_side_by_side_give_the_answer_of_one(quadruped, symmetry):
    with ThreadPoolExecutor(3) as pool:
        found = list(pool.map(lambda _: quadruped.detect(), range(3)))
    assert all(np.array_equal(each[0].partner, symmetry.partner) for each in found)


def test_errors_of_threads_do_not_mix(quadruped):
    def text(value):
        with pytest.raises(intrinsym.OptionError) as caught:
            quadruped.detect(samples=value)
        return str(caught.value)

    with ThreadPoolExecutor(4) as pool:
        values = [1000000 + number for number in range(40)]
        assert all(str(value) in found for value, found in zip(values, pool.map(text, values)))


def test_handles_are_freed_with_their_objects(quadruped):
    gc.collect()
    before = LIBRARY.isym_handle_count()
    found = quadruped.detect(samples=200)
    one = found[0]
    del found
    assert one.partner.shape == (quadruped.vertex_count,)
    del one
    gc.collect()
    assert LIBRARY.isym_handle_count() == before
