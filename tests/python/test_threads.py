# SPDX-License-Identifier: BSD-3-Clause
"""Tests batches that release Python's global interpreter lock (GIL)."""

import os
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
from surfaces import poses

import keepout


def test_other_threads_of_python_go_on(guard):
    """One thread runs a batch while another one counts: each sees the other's progress."""
    lines = poses(guard.mesh.vertices, 40000)
    started, done = threading.Event(), threading.Event()

    def run():
        started.set()
        guard.steps(lines[:, :3], lines[:, 3:], threads=1)
        done.set()

    worker = threading.Thread(target=run)
    worker.start()
    started.wait()
    counted = 0
    while not done.is_set():
        counted += 1
        time.sleep(0)
    worker.join()
    assert counted > 100


def test_one_constraint_may_be_used_from_many_threads(guard):
    """Batches and steps of several threads wait for each other, without a deadlock."""
    lines = poses(guard.mesh.vertices, 1500)
    tips, desired = lines[:, :3], lines[:, 3:]
    expected = guard.steps(tips, desired, threads=1).motion
    wrong = []

    def batches():
        for _ in range(3):
            if not np.array_equal(guard.steps(tips, desired, threads=2).motion, expected):
                wrong.append("batch")

    def steps():
        for tip, aim in lines[:300].reshape(-1, 2, 3):
            if not np.isfinite(guard.step(tip, aim).motion).all():
                wrong.append("step")

    threads = [threading.Thread(target=work) for work in (batches, batches, steps, steps)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def test_results_do_not_depend_on_threads_or_split(guard):
    lines = poses(guard.mesh.vertices, 1000, seed=5)
    tips, desired = lines[:, :3], lines[:, 3:]
    whole = guard.steps(tips, desired, threads=1)
    for threads in (2, 3, 16):
        other = guard.steps(tips, desired, threads=threads)
        for name in ("motion", "status", "planes"):
            np.testing.assert_array_equal(getattr(other, name), getattr(whole, name))
    order = np.random.default_rng(6).permutation(len(lines))
    np.testing.assert_array_equal(guard.steps(tips[order], desired[order]).motion, whole.motion[order])
    halves = [guard.steps(tips[s], desired[s]).motion for s in (slice(0, 333), slice(333, None))]
    np.testing.assert_array_equal(np.vstack(halves), whole.motion)


def test_loops_do_not_depend_on_threads(guard):
    random = np.random.default_rng(8)
    starts = 12.0 * random.normal(size=(9, 3))
    hands = np.cumsum(random.normal(size=(9, 200, 3)), axis=1)
    alone = guard.simulate(starts, hands, threads=1)
    for threads in (2, 4):
        np.testing.assert_array_equal(guard.simulate(starts, hands, threads=threads).tips, alone.tips)
    np.testing.assert_array_equal(guard.simulate(starts[4:5], hands[4:5]).tips, alone.tips[4:5])


interrupted = """
import os, signal, sys, threading, time
import numpy as np
sys.path.insert(0, sys.argv[1])
import keepout
from surfaces import sphere
guard = keepout.MotionConstraint(keepout.Mesh(*sphere()))
hands = np.zeros((1, 20_000_000, 3))
def interrupt():
    time.sleep(0.3)
    os.kill(os.getpid(), signal.SIGINT)
threading.Thread(target=interrupt).start()
try:
    if sys.argv[2] == "proofs":
        chain = keepout.Chain([keepout.Joint(axis=(0, 1, 0))])
        body = keepout.Body("tip", [(1, (0, 0, 10.8))], 0.5)
        whole = keepout.InstrumentGuard(guard.mesh, keepout.Instrument(chain, [body]))
        whole.proofs([0.0], np.zeros((20_000_000, 1)))
    elif sys.argv[2] == "steps":
        guard.steps(hands[0], hands[0])
    else:
        guard.simulate(np.array([[0.0, 0, 10.5]]), hands)
except KeyboardInterrupt:
    assert guard.step((0, 0, 14), (0, 0, -1)).ok  # the guard still works
    print("interrupted")
"""


@pytest.mark.parametrize("batch", ["steps", "simulate", "proofs"])
def test_a_long_batch_can_be_interrupted(batch):
    ended = subprocess.run(
        [sys.executable, "-c", interrupted, os.path.dirname(__file__), batch],
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert ended.stdout == "interrupted\n", ended.stderr
