"""Processes that tests start and meddle with: what they have written so far is the
clock, not the time they take.
"""

import subprocess
import sys
import time
from pathlib import Path

PROGRAM = [sys.executable, "-m", "rocking_cli"]
# seconds after which a test gives up on a process that does not go on: no machine is
# that slow
PATIENCE = 300.0


def grows(path: Path, size: int, process: subprocess.Popen[str]) -> bool:
    """Wait until a file has grown beyond a size in bytes (True), or the process that
    writes it has ended (False).
    """
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        try:
            if path.stat().st_size > size:
                return True
        except FileNotFoundError:
            pass
        if process.poll() is not None:
            return False
        time.sleep(0.002)
    process.kill()
    raise AssertionError(
        f"{path.name} has not grown beyond {size} bytes within {PATIENCE:.0f} s"
    )
