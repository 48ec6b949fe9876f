"""A stop that is asked for where Python cannot raise it is remembered, and no traceback
is printed of it.
"""

import subprocess
import sys

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
