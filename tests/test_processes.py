"""Processes: results in order, whatever fails is said, and nobody waits for one that
cannot answer.
"""

import os
import pickle
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from rocking_cli import load_structures
from rocking_cli import processes as room
from rocking_cli.errors import OutputError, UsageError
from rocking_cli.processes import available_cpus, processes

CONFIGS = Path(__file__).parents[1] / "configs"
linux = pytest.mark.skipif(sys.platform != "linux", reason="forks")


def gone(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return True
    return False


def slow_first(n: int) -> int:
    if n == 0:
        time.sleep(0.2)
    return n * n


def who(_: int) -> int:
    return os.getpid()


def interrupted(*items: float) -> Iterator[float]:
    yield from items
    raise KeyboardInterrupt


class Untold(Exception):
    """An exception that cannot be made again from what is pickled of it."""

    def __init__(self, one: int, two: int) -> None:
        super().__init__(f"{one} and {two}")

    def __reduce__(
        self,
    ) -> tuple[
        type["Untold"], tuple[int]
    ]:  # in as many words, since some packages teach exceptions to travel
        return Untold, (1,)


FAULTS = {
    "refused": UsageError("not 1"),
    "no file": FileNotFoundError(2, "No such file", "1"),
    "untold": Untold(1, 1),
}


def fails(how: str) -> object:
    """Raise one of the faults, the first of two last; or return, or do, what a process
    cannot.
    """
    if how != "refused":
        time.sleep(0.1)
    if how in FAULTS:
        raise FAULTS[how]
    if how == "dies":
        os.kill(os.getpid(), signal.SIGKILL)
    return lambda: how


def signals(_: int) -> tuple[object, object, set[int]]:
    return (
        signal.getsignal(signal.SIGINT),
        signal.getsignal(signal.SIGTERM),
        {int(s) for s in signal.pthread_sigmask(signal.SIG_BLOCK, ())},
    )


@pytest.mark.parametrize("method", ["spawn", pytest.param("fork", marks=linux)])
def test_results_come_in_order(method, monkeypatch):
    monkeypatch.setattr(room, "_METHOD", method)
    with processes(2, slow_first, "") as run:
        assert list(run(range(40))) == [n * n for n in range(40)]
        assert list(run([])) == []
        assert list(run([7])) == [49]


def test_items_are_asked_for_as_they_are_needed():
    asked = []
    with processes(2, slow_first, "") as run:
        results = run(asked.append(n) or n for n in range(1, 1000))
        assert next(results) == 1
        assert len(asked) <= 2 * room._AHEAD + 1


def test_the_first_items_are_under_way_before_a_result_is_asked_for(tmp_path):
    paths = [tmp_path / "one", tmp_path / "two", tmp_path / "three"]
    with processes(2, Path.touch, "") as run:
        results, end = run(paths), time.monotonic() + 60.0
        while not all(path.exists() for path in paths):
            assert time.monotonic() < end
            time.sleep(0.01)
        assert list(results) == [None, None, None]


def test_a_script_without_a_guard_is_told_where_processes_begin_anew(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(
        "from rocking_cli import processes as room\n"
        "room._METHOD = 'spawn'  # as on Windows and macOS\n"
        "with room.processes(2, abs, 'fewer') as run:\n"
        "    list(run([1]))\n"
    )
    call = [sys.executable, str(script)]
    done = subprocess.run(call, capture_output=True, text=True, check=False)
    # one of the workers is told: of exit code 1, or stopped after the other
    assert "OutputError: a worker process died " in done.stderr
    # Python may add a word on what the worker has left behind
    told = " (out of memory? a script without `if __name__ == '__main__':`?); fewer\n"
    assert told in done.stderr


@pytest.mark.parametrize(
    ("how", "error", "words"),
    [
        ("refused", UsageError, "not 1"),
        ("no file", FileNotFoundError, "No such file"),
        ("untold", RuntimeError, "two"),
        ("unpicklable", AttributeError, "lambda"),
        (
            "dies",
            OutputError,
            r"^a worker process died by signal 9 \(out of memory\?\); fewer$",
        ),
    ],
)
def test_what_a_task_raises_is_raised_here_and_a_death_is_told_with_its_signal(
    how, error, words
):
    with pytest.raises(error, match=words), processes(2, fails, "fewer") as run:
        list(run([how, "refused"]))


def test_all_processes_are_gone_afterwards():
    with processes(2, who, "") as run:
        pids = set(run(range(20)))
    assert all(gone(pid) for pid in pids)
    pids.clear()
    with pytest.raises(KeyboardInterrupt), processes(2, who, "") as run:
        pids.update(run(interrupted(*range(20))))
    assert pids
    assert all(gone(pid) for pid in pids)


def test_a_block_that_fails_waits_for_no_task():
    begun = time.monotonic()
    with pytest.raises(KeyboardInterrupt), processes(2, time.sleep, "") as run:
        run(interrupted(60.0))
    assert time.monotonic() - begun < 50.0


@linux
def test_a_block_that_ends_waits_for_no_process_that_has_stopped():
    with processes(2, who, "") as run:
        for pid in set(run(range(20))):
            os.kill(pid, signal.SIGSTOP)


@linux
@pytest.mark.parametrize(
    "how", [lambda *_: os.kill(os.getpid(), signal.SIGKILL), lambda *_: os._exit(3)]
)
def test_a_death_while_starting_is_told(how, monkeypatch):
    monkeypatch.setattr(room, "_begin", how)
    with (
        pytest.raises(OutputError, match="a worker process died"),
        processes(3, who, "") as run,
    ):
        list(run([1]))


@linux
def test_too_few_descriptors_are_a_sentence():
    before = resource.getrlimit(resource.RLIMIT_NOFILE)
    free = os.dup(0)
    os.close(free)
    resource.setrlimit(resource.RLIMIT_NOFILE, (free + 6, before[1]))
    try:
        with (
            pytest.raises(
                OutputError,
                match=(
                    r"^4 worker processes cannot be started: Too many open files;"
                    r" fewer$"
                ),
            ),
            processes(4, who, "fewer"),
        ):
            pass
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, before)
    again = os.dup(0)
    os.close(again)
    assert again == free  # nothing is left open


@linux
def test_a_process_has_no_handler_of_its_parent():
    def of_the_parent(*_: object) -> None:
        raise AssertionError

    before = signal.signal(signal.SIGTERM, of_the_parent)
    try:
        with processes(1, signals, "") as run:
            assert list(run([0])) == [(signal.SIG_IGN, signal.SIG_DFL, set())]
        assert signal.getsignal(signal.SIGTERM) is of_the_parent
    finally:
        signal.signal(signal.SIGTERM, before)


@linux
def test_a_stop_while_forking_reaches_no_handler_in_the_child(monkeypatch, tmp_path):
    """The child sends itself SIGTERM before it has set its handlers: it must wait until
    they are set, and end by it.
    """
    begin = room._begin

    def stopped(*arguments):
        os.kill(os.getpid(), signal.SIGTERM)
        begin(*arguments)

    def of_the_parent(*_: object) -> None:
        (tmp_path / "ran").touch()

    before = signal.signal(signal.SIGTERM, of_the_parent)
    monkeypatch.setattr(room, "_begin", stopped)
    try:
        with (
            pytest.raises(OutputError, match="died by signal 15"),
            processes(1, who, "") as run,
        ):
            list(run([0]))
    finally:
        signal.signal(signal.SIGTERM, before)
    assert not (tmp_path / "ran").exists()


@linux
def test_cpus_are_those_that_this_process_may_use(monkeypatch):
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {3, 5, 8})
    assert available_cpus() == 3


@pytest.mark.parametrize(
    "path", sorted(CONFIGS.glob("*.yaml")), ids=lambda path: path.name
)
def test_a_structure_comes_whole_to_a_worker(path):
    for structure in load_structures(path):
        assert pickle.loads(pickle.dumps(structure)) == structure
