"""Processes that take a share of the work and never outlive the one that started them."""

from __future__ import annotations

import ctypes
import multiprocessing
import signal
import sys
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from typing import Any

from ..errors import OutputError

_PARENT_DEATH_SIGNAL = 1  # PR_SET_PDEATHSIG of prctl(2)
_task: Callable[..., Any] | None = None


@contextmanager
def processes(workers: int, task: Callable[..., Any], advice: str) -> Iterator[Callable[..., Future[Any]]]:
    """A function that has task(*arguments) run in one of the processes, to which the task itself travels once.

    Whoever leaves early, by Ctrl-C or by another exception, does not wait for them: they are ended. Raises OutputError, with
    the advice, when a process dies.
    """
    strangers = multiprocessing.active_children()
    # Forked workers have the task and the imported packages from the start; only arguments and results travel.
    context = multiprocessing.get_context("fork" if sys.platform == "linux" else "spawn")
    pool = ProcessPoolExecutor(workers, mp_context=context, initializer=_begin, initargs=(task,))

    def submit(*arguments: Any) -> Future[Any]:
        with warnings.catch_warnings():  # numpy's idle arithmetic threads are no danger to a fork
            warnings.simplefilter("ignore", DeprecationWarning)
            return pool.submit(_call, *arguments)

    try:
        yield submit
    except BrokenProcessPool:
        raise OutputError(f"a worker process died (out of memory?); {advice}") from None
    except BaseException:
        for process in multiprocessing.active_children():
            if process not in strangers:
                process.terminate()
        raise
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _begin(task: Callable[..., Any]) -> None:
    global _task
    _task = task
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the whole group; the parent alone decides
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PARENT_DEATH_SIGNAL, signal.SIGKILL)


def _call(*arguments: Any) -> Any:
    assert _task is not None
    return _task(*arguments)
