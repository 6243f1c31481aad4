# SPDX-License-Identifier: BSD-3-Clause
"""Runs programs on the workers of a Dask cluster, or on the processors of this machine."""

from __future__ import annotations

import concurrent.futures
import contextlib
import logging
import multiprocessing
import signal
from collections.abc import Callable, Iterator
from typing import Any

#: For the scheduler's answer [s].
PATIENCE = 10


class WorkersError(RuntimeError):
    """Says why there are no workers."""


def run_program(command: list[str], folder: str, environment: dict[str, str], lines: str) -> tuple[int, str, str]:
    """Returns exit status, stdout and the end of stderr of a program. A negative status is a signal.

    Dask sends this function as text, so that a worker needs only Python's standard library. The program ends with the
    worker, and when the task is cancelled.
    """
    import os
    import shutil
    import subprocess
    import sys
    import tempfile

    def is_cancelled() -> bool:
        distributed = sys.modules.get("distributed")
        try:
            worker = distributed.get_worker() if distributed else None
            task = worker and worker.state.tasks.get(worker.get_current_task())
            return bool(worker) and (task is None or task.state == "cancelled")
        except (AttributeError, ValueError):  # not in a task
            return False

    dies_with_worker = ["setpriv", "--pdeathsig", "KILL"] if shutil.which("setpriv") else []
    with tempfile.TemporaryFile("w+") as read, tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:
        read.write(lines)
        read.seek(0)
        # A session of its own: Ctrl-C is for the process that waits for the workers.
        process = subprocess.Popen([*dies_with_worker, *command], cwd=folder, env={**os.environ, **environment},
                                   stdin=read, stdout=out, stderr=err, start_new_session=True)
        try:
            while True:
                try:
                    process.wait(0.5)
                    break
                except subprocess.TimeoutExpired:
                    if is_cancelled():
                        break
        finally:
            if process.poll() is None:
                process.kill()
                process.wait()
        out.seek(0)
        err.seek(0)
        return process.returncode, out.read(), err.read()[-2000:]


def _be_a_worker(begin: Callable[[], object] | None) -> None:
    import ctypes

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the process that waits for this one
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG: ends with the process that waits
    if begin:
        begin()


@contextlib.contextmanager
def processes(jobs: int, begin: Callable[[], object] | None = None) -> Iterator[concurrent.futures.Executor]:
    """Returns an executor with processes on this machine. Each calls `begin`. An exception ends all at once."""
    with concurrent.futures.ProcessPoolExecutor(jobs, initializer=_be_a_worker, initargs=(begin,)) as pool:
        try:
            yield pool
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            for worker in multiprocessing.active_children():
                worker.terminate()
            raise


@contextlib.contextmanager
def cluster(address: str) -> Iterator[concurrent.futures.Executor]:
    """Returns an executor whose workers are those of a Dask scheduler. An exception cancels all tasks.

    The scheduler gives the task of a worker that is lost to another one. Raises WorkersError if Dask is not installed,
    or if no scheduler answers.
    """
    try:
        import distributed
    except ImportError:
        raise WorkersError("--dask needs the Python package 'distributed': 'apt install python3-distributed', or "
                           "'pip install distributed'. Without --dask, all work is done on this machine") from None
    try:
        client: Any = distributed.Client(address, timeout=PATIENCE)
    except (OSError, ValueError, TypeError) as fault:
        raise WorkersError(f"--dask: no scheduler answers at '{address}' within {PATIENCE} s ({fault}). Start one with "
                           "'dask scheduler', and workers with 'dask worker ADDRESS'") from None
    logging.getLogger("asyncio").setLevel(logging.CRITICAL)  # Dask leaves futures of cancelled tasks behind
    with client:
        pool = client.get_executor(pure=False)
        try:
            yield pool
        except BaseException:
            pool.shutdown(wait=False)
            raise


def by_value(function: Callable[..., Any]) -> Callable[..., Any]:
    """Returns the function as Dask must be given it so that the worker need not import its module."""
    import types

    copy = types.FunctionType(function.__code__, {"__builtins__": __builtins__}, function.__name__)
    copy.__module__ = "__main__"
    return copy


def stop_on_signals() -> None:
    """Makes SIGTERM raise KeyboardInterrupt, as Ctrl-C does."""

    def stop(number: int, frame: object) -> None:
        raise KeyboardInterrupt

    signal.signal(signal.SIGTERM, stop)
