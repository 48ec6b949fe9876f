"""Processes that take a share of the work and never outlive the one that started them.

The parent has no thread beside its own: it deals out one item to each idle process, waits for whichever reports first, and
sees at once when one dies. So nothing is forked while a lock is held, and nothing waits for an answer that cannot come.
"""

from __future__ import annotations

import ctypes
import os
import pickle
import signal
import sys
import traceback
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from time import monotonic
from typing import TYPE_CHECKING, Any, NamedTuple

from .errors import OutputError

if TYPE_CHECKING:
    from multiprocessing.connection import Connection
    from multiprocessing.process import BaseProcess

# Forked workers have the task and the imported packages from the start; only items and results travel.
_METHOD = "fork" if sys.platform == "linux" else "spawn"
_TO_START = 60.0  # s that all processes together may take until they report; a spawned one imports its packages anew
_AHEAD = 3  # results for each process that may wait for an earlier one
_STOPS = (signal.SIGINT, signal.SIGTERM)
_PARENT_DEATH_SIGNAL = 1  # PR_SET_PDEATHSIG of prctl(2)


class _Worker(NamedTuple):
    process: BaseProcess
    connection: Connection


def available_cpus() -> int:
    """CPUs that this process may use, which a batch system or a container may have made fewer than the machine has."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@contextmanager
def processes(workers: int, task: Callable[[Any], Any], advice: str) -> Iterator[Callable[[Iterable[Any]], Iterator[Any]]]:
    """A function from items to task(item) of each, in their order; the task itself travels to each process once.

    An exception of the task is raised here, in its turn. Whoever leaves, early or not, ends the processes. Raises OutputError, with the
    advice, when one of them cannot be started, does not report in time that it has, or dies.
    """
    crew: list[_Worker] = []
    try:
        try:
            for _ in range(workers):
                _start(crew, task)
        except OSError as error:
            raise OutputError(f"{workers} worker processes cannot be started: {error.strerror or error}; {advice}") from None
        _await_start(crew, advice)
        yield lambda items: _results(crew, items, advice)
    finally:
        for worker in crew:
            worker.process.kill()  # it holds nothing that could be lost
        for worker in crew:
            worker.process.join()
            worker.connection.close()


def _start(crew: list[_Worker], task: Callable[[Any], Any]) -> None:
    from multiprocessing import get_context

    context: Any = get_context(_METHOD)
    ours, theirs = context.Pipe()
    process = context.Process(target=_work, args=(theirs, task, os.getpid()), daemon=True)
    try:
        with _stops_held(), warnings.catch_warnings():  # numpy's idle arithmetic threads are no danger to a fork
            warnings.simplefilter("ignore", DeprecationWarning)
            process.start()
    except BaseException:
        ours.close()
        raise
    finally:
        theirs.close()
    crew.append(_Worker(process, ours))


@contextmanager
def _stops_held() -> Iterator[None]:
    """SIGINT and SIGTERM wait: a process just forked has its parent's handlers, which would unwind the parent's stack in it."""
    if _METHOD != "fork":
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, _STOPS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _await_start(crew: list[_Worker], advice: str) -> None:
    from multiprocessing.connection import wait

    silent, deadline = list(crew), monotonic() + _TO_START
    while silent:
        left = deadline - monotonic()
        if left <= 0.0:
            raise OutputError(f"{len(silent)} of {len(crew)} worker processes did not start within {_TO_START:g} s; {advice}")
        ready = wait([x for worker in silent for x in (worker.connection, worker.process.sentinel)], left)
        for worker in [w for w in silent if w.connection in ready or w.process.sentinel in ready]:
            _receive(worker, advice)
            silent.remove(worker)


def _results(crew: list[_Worker], items: Iterable[Any], advice: str) -> Iterator[Any]:
    """The results in the order of their items, of which the first are dealt out here and now."""
    from multiprocessing.connection import wait

    source, idle = enumerate(items), list(crew)
    busy: dict[int, _Worker] = {}
    results: dict[int, tuple[Any, Exception | None]] = {}

    def deal() -> None:
        while idle and len(busy) + len(results) < _AHEAD * len(crew) and (job := next(source, None)) is not None:
            worker = busy[job[0]] = idle.pop()
            try:
                worker.connection.send(job[1])
            except OSError:
                raise _death(worker, advice) from None

    def collect() -> Iterator[Any]:
        done = 0
        while True:
            deal()
            if done in results:
                result, error = results.pop(done)
                if error is not None:
                    raise error
                yield result
                done += 1
            elif not busy:
                return
            else:
                ready = wait([x for worker in busy.values() for x in (worker.connection, worker.process.sentinel)])
                for number in [n for n, w in busy.items() if w.connection in ready or w.process.sentinel in ready]:
                    results[number] = _receive(busy[number], advice)
                    idle.append(busy.pop(number))

    deal()
    return collect()


def _receive(worker: _Worker, advice: str) -> Any:
    try:
        return worker.connection.recv()
    except (EOFError, OSError):
        raise _death(worker, advice) from None


def _death(worker: _Worker, advice: str) -> OutputError:
    worker.process.join(1.0)
    code = worker.process.exitcode
    how = "" if code is None else f" by signal {-code}" if code < 0 else f" with exit code {code}"
    return OutputError(f"a worker process died{how} (out of memory?); {advice}")


def _work(connection: Connection, task: Callable[[Any], Any], parent: int) -> None:
    """What a process does: report that it is there, then answer each item with (result, None) or (None, exception)."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the whole group; the parent alone decides
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    if sys.platform == "linux":
        signal.pthread_sigmask(signal.SIG_UNBLOCK, _STOPS)
        ctypes.CDLL(None).prctl(_PARENT_DEATH_SIGNAL, signal.SIGKILL)
        if os.getppid() != parent:  # it died before it could be asked for its signal
            return
    try:
        connection.send(None)
        while True:
            _answer(connection, task, connection.recv())
    except (EOFError, OSError):
        return  # there is nobody left to answer


def _answer(connection: Connection, task: Callable[[Any], Any], item: Any) -> None:
    answer: tuple[Any, Exception | None]
    try:
        answer = task(item), None
    except Exception as error:
        error.add_note(f"In a worker process:\n{traceback.format_exc()}")
        answer = None, error
    try:
        pickle.loads(pickle.dumps(answer[1]))
        connection.send(answer)
    except OSError:
        raise
    except Exception as error:  # a result or an exception that does not survive the journey
        connection.send((None, RuntimeError(f"{type(error).__name__}: {error}; from {answer[1]!r}")))
