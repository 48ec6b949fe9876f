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
