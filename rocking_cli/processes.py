"""Processes that share the work, and end with the process that started them."""

import ctypes
import os
import pickle
import signal
import sys
import warnings
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import partial
from itertools import islice
from threading import Lock
from typing import Any

from .errors import OutputError, UsageError
from .interruption import STOPS, deferred

# Forked workers have the task and the imported packages from the start; only items and
# results travel.
_METHOD = "fork" if sys.platform == "linux" else "spawn"
_AHEAD = 3  # items under way for each process
_PARENT_DEATH_SIGNAL = 1  # PR_SET_PDEATHSIG of prctl(2)

Runner = Callable[[Iterable[Any]], Iterator[Any]]
"""From items to the results of a task, in their order."""

_POLL = 0.5  # s between two looks at the parts that the worker processes report

_task: Callable[[Any], Any]  # task of a worker process
_parts: Any = None  # in a worker process: the sum of all parts that were reported


def report_part(share: float) -> None:
    """Report that this share of an item is done since the last report; a worker process
    passes it on to the process that started it."""
    if _parts is not None:
        with _parts.get_lock():
            _parts.value += share


def part_reporter() -> Callable[[float], None]:
    """Return a function that takes the share of an item which is done so far, and
    reports what has come to it.
    """
    reported = 0.0

    def tell(share: float) -> None:
        nonlocal reported
        report_part(share - reported)
        reported = share

    return tell


def available_cpus() -> int:
    """CPUs that this process may use, which a batch system or a container may have made
    fewer than the machine has.
    """
    return (
        len(os.sched_getaffinity(0))
        if hasattr(os, "sched_getaffinity")
        else os.cpu_count() or 1
    )


def refuse_endless(cells: float, segments: int) -> None:
    """Raise UsageError if these cells under a motion of so many segments would take
    years of a processor.
    """
    most = 1e14  # cells times segments: years of a processor by the quickest equation
    if cells * segments > most:
        found = f"{cells:.3g} cells under {segments} segments of shaking"
        raise UsageError(
            f"found {found}, which would take years; expected up to"
            f" {most / segments:.3g} cells"
        )


def in_order(
    submit: Callable[[Any], Any],
    wait: Callable[[Any], Any],
    items: Iterable[Any],
    ahead: int,
) -> Iterator[Any]:
    """wait(submit(item)) of each item, in order; so many items are submitted ahead, the
    first of them at once.
    """
    source = iter(items)
    under_way = deque(map(submit, islice(source, ahead)))

    def results() -> Iterator[Any]:
        while under_way:
            result = wait(under_way.popleft())
            under_way.extend(map(submit, islice(source, 1)))
            yield result

    return results()


@contextmanager
def processes(
    workers: int,
    task: Callable[[Any], Any],
    advice: str,
    parts: Callable[[float], None] | None = None,
) -> Iterator[Runner]:
    """Context manager: a function from items to task(item) of each, in their order,
    computed by `workers` processes. The task itself is sent to each process once.
    parts: called now and then with the sum of what `report_part` was called with.

    An exception of the task is raised here, in its turn. The processes end with the
    block, at once. Raises OutputError, with the advice, when a process cannot be
    started or dies.
    """
    from concurrent.futures import Future, ProcessPoolExecutor
    from concurrent.futures.process import BrokenProcessPool
    from multiprocessing import active_children, get_context

    before, pool, context = set(active_children()), None, get_context(_METHOD)
    reported = None if parts is None else context.Value("d", 0.0)

    def submit(pool: ProcessPoolExecutor, item: Any) -> "tuple[Future[Any], Lock]":
        under_way = Lock()
        under_way.acquire()
        # A stop would leave the locks of the pool and of the future locked.
        with deferred():
            future = pool.submit(_answer, item)
            future.add_done_callback(lambda _: under_way.release())
        return future, under_way

    def wait(submitted: "tuple[Future[Any], Lock]") -> Any:
        future, under_way = submitted
        # On Windows no signal ends a wait that has no end of its own.
        while not under_way.acquire(timeout=_POLL):
            if parts is not None and reported is not None:
                # The value is read without its lock: a process may have died with it.
                parts(reported.get_obj().value)
        with deferred():
            return future.result()

    try:
        try:
            pool = ProcessPoolExecutor(
                workers, context, _begin, (task, os.getpid(), reported)
            )
            # numpy's idle arithmetic threads are no danger to a fork
            with (
                _stops_held(),
                warnings.catch_warnings(),
            ):
                warnings.simplefilter("ignore", DeprecationWarning)
                pool.submit(int)  # starts them
        except OSError as error:
            raise OutputError(
                f"{workers} worker processes cannot be started:"
                f" {error.strerror or error}; {advice}"
            ) from None
        crew = set(active_children()) - before
        try:
            yield lambda items: in_order(
                partial(submit, pool), wait, items, _AHEAD * workers
            )
        except BrokenProcessPool:
            pool.shutdown()
            # exit code of the process that died: the pool ended the others by SIGTERM
            code = next(
                (
                    p.exitcode
                    for p in crew
                    if p.exitcode not in (None, 0, -signal.SIGTERM)
                ),
                -signal.SIGTERM,
            )
            how = f"by signal {-code}" if code < 0 else f"with exit code {code}"
            cause = "out of memory?"
            if _METHOD == "spawn":
                cause += " a script without `if __name__ == '__main__':`?"
            raise OutputError(
                f"a worker process died {how} ({cause}); {advice}"
            ) from None
    finally:
        # a pool that is shut down waits for ever if a process dies just then
        for process in set(active_children()) - before:
            process.kill()  # it holds nothing that could be lost
        if pool is not None:
            pool.shutdown(cancel_futures=True)


@contextmanager
def _stops_held() -> Iterator[None]:
    """The signals that stop wait: a process just forked has its parent's handlers,
    which would unwind the parent's stack in it.
    """
    if _METHOD != "fork":
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, STOPS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _begin(task: Callable[[Any], Any], parent: int, parts: Any) -> None:
    """Called first in a worker process."""
    global _task, _parts
    _task, _parts = task, parts
    # Ctrl-C reaches the whole group; the parent alone decides, and ends it by SIGTERM
    for number in STOPS:
        ignored = number != signal.SIGTERM
        signal.signal(number, signal.SIG_IGN if ignored else signal.SIG_DFL)
    if sys.platform == "linux":
        signal.pthread_sigmask(signal.SIG_UNBLOCK, STOPS)
        ctypes.CDLL(None).prctl(_PARENT_DEATH_SIGNAL, signal.SIGKILL)
        if os.getppid() != parent:  # it died before it could be asked for its signal
            os._exit(1)


def _answer(item: Any) -> Any:
    try:
        return _task(item)
    except Exception as error:
        try:
            pickle.loads(pickle.dumps(error))
        # the pool would take an exception that cannot be made again for the death of a
        # process
        except Exception as fault:
            words = f"{type(fault).__name__}: {fault}; from {error!r}"
        else:
            raise
    # out here it has no context, which some packages pickle too
    raise RuntimeError(words)
