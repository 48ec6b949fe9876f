"""A stop that is asked for where Python cannot raise it is remembered, and no traceback
is printed of it.
"""

import subprocess
import sys

import pytest

FINALIZERS = """
import signal
from rocking_cli import interruption

class Stopped:
    def __del__(self):
        signal.raise_signal(signal.SIGTERM)

class Faulty:
    def __del__(self):
        raise ValueError("a fault")

interruption.listen()
Stopped()
Faulty()
try:
    interruption.check()
except KeyboardInterrupt:
    print("remembered")
"""


def test_a_stop_inside_a_finalizer_is_remembered_and_not_printed():
    done = subprocess.run(
        [sys.executable, "-c", FINALIZERS], capture_output=True, text=True, check=True
    )
    assert done.stdout == "remembered\n"
    assert "KeyboardInterrupt" not in done.stderr
    assert "ValueError: a fault" in done.stderr


NOHUP = """
import signal
from rocking_cli import interruption

signal.signal(signal.SIGHUP, signal.SIG_IGN)
interruption.listen()
signal.raise_signal(signal.SIGHUP)
print("goes on")
"""

CTRL_BREAK = """
import signal
from enum import IntEnum

signal.Signals = IntEnum("Signals", {"SIGINT": 2, "SIGTERM": 15, "SIGBREAK": 10})
from rocking_cli import interruption

interruption.listen()
try:
    signal.raise_signal(signal.Signals.SIGBREAK)
except KeyboardInterrupt:
    print("stops")
"""


@pytest.mark.parametrize(("code", "said"), [(NOHUP, "goes on"), (CTRL_BREAK, "stops")])
def test_nohup_is_heeded_and_ctrl_break_of_windows_stops(code, said):
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert done.stdout == f"{said}\n"


INSIDE_A_LOCK = """
import os, signal, threading
from rocking_cli import interruption
from rocking_cli.commands.progress import reporting
from rocking_cli.processes import processes

entered, calls, main = threading.Condition.__enter__, 0, threading.get_ident()

def stopped(condition):
    "Enter; the call of this number in the main thread is stopped just inside."
    global calls
    locked = entered(condition)
    if threading.get_ident() == main:
        calls += 1
        if calls == number:
            signal.raise_signal(signal.SIGTERM)
    return locked

def scene():
    interruption.listen()
    threading.Condition.__enter__ = stopped
    try:
        with reporting(), processes(2, abs, "") as run:
            print(sum(run(range(40))), flush=True)
    except KeyboardInterrupt:
        print("stopped", flush=True)

for number in (*range(1, 16), 30, 60, 90, 10_000):  # each in a process of its own
    child = os.fork()
    if not child:
        scene()
        os._exit(0)
    assert os.waitpid(child, 0)[1] == 0
"""


@pytest.mark.skipif(sys.platform != "linux", reason="forks")
def test_a_stop_in_any_condition_of_the_main_thread_leaves_none_locked():
    """A lock that is left locked has the threads of the pool wait for ever."""
    done = subprocess.run(
        [sys.executable, "-c", INSIDE_A_LOCK],
        capture_output=True,
        text=True,
        timeout=60.0,
        check=True,
    )
    assert not done.stderr
    assert set(done.stdout.splitlines()) == {"stopped", "780"}
    assert len(done.stdout.splitlines()) == 19
