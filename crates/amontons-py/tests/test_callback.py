"""The callback of a run, and Ctrl-C."""

import os
import signal
import subprocess
import sys
import textwrap
import threading
import time

import numpy as np
import pytest

import amontons
from conftest import SMALL


def test_the_callback_sees_every_step_in_the_thread_of_the_caller(paper):
    seen, kept = [], []

    def callback(snapshot):
        assert threading.current_thread() is threading.main_thread()
        seen.append((snapshot.step, snapshot.t, snapshot.history["elastic"]))
        kept.append(snapshot.fields["displacement"])

    result = amontons.run(paper, SMALL, callback=callback)
    assert [step for step, _, _ in seen] == list(range(1, 9))
    assert [elastic for _, _, elastic in seen] == list(result.history["elastic"])
    # What was kept of a step is not overwritten by the next.
    assert np.array_equal(kept[3], result.snapshots[1].fields["displacement"])
    assert not np.array_equal(kept[0], kept[3])


def test_the_callback_stops_the_run(paper):
    result = amontons.run(paper, SMALL, callback=lambda snapshot: snapshot.step < 3)
    assert result.outcome == "interrupted" and len(result.history) == 3
    assert result.snapshots[-1].step == 3
    whole = amontons.run(paper, SMALL)
    assert np.array_equal(result.history.to_numpy(), whole.history.to_numpy()[:3])


def test_an_exception_in_the_callback_ends_the_run(paper):
    calls = []

    def callback(snapshot):
        calls.append(snapshot.step)
        raise ZeroDivisionError("mine")

    with pytest.raises(ZeroDivisionError, match="mine"):
        amontons.run(paper, SMALL, callback=callback)
    assert calls == [1]


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_ctrl_c_is_answered(paper):
    # Shells start what runs in the background deaf to Ctrl-C, and so is what it starts.
    code = """
        import signal, sys, amontons
        signal.signal(signal.SIGINT, signal.default_int_handler)
        def tell(snapshot):
            if snapshot.step == 2:
                print("go", flush=True)
        try:
            amontons.run(sys.argv[1], mesh__n=16, time__steps=100000, certificate=False, callback=tell)
        except KeyboardInterrupt as error:
            print(type(error).__name__, error.result.outcome, len(error.result.history) >= 2, error)
    """
    command = [sys.executable, "-c", textwrap.dedent(code), str(paper)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "go\n"
        os.kill(process.pid, signal.SIGINT)
        out, why = process.communicate(timeout=60)
    assert out.startswith("Interrupted interrupted True interrupted after step "), (out, why)


def test_other_threads_go_on_during_a_run(paper):
    ticks, done = [], threading.Event()

    def tick():
        while not done.is_set():
            ticks.append(time.monotonic())
            time.sleep(0.001)

    other = threading.Thread(target=tick)
    other.start()
    begin = time.monotonic()
    amontons.run(paper, mesh__n=32, time__steps=32)
    end = time.monotonic()
    done.set()
    other.join()
    # With the lock held all through the run there would be no tick within it.
    assert sum(begin < t < end for t in ticks) > 2


def test_runs_in_threads_at_the_same_time(paper):
    expected = amontons.run(paper, SMALL, threads=1).summary["final"]
    found = []
    threads = [
        threading.Thread(target=lambda: found.append(amontons.run(paper, SMALL, threads=1).summary["final"]))
        for _ in range(4)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [expected] * 4
