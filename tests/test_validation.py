"""The comparisons of `make validate` hold."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parent / "bench" / "validate.py"


@pytest.mark.slow
def test_every_comparison_that_needs_nothing_but_the_package_holds():
    done = subprocess.run([sys.executable, SCRIPT], capture_output=True, text=True, check=False, cwd=SCRIPT.parents[2])
    assert done.returncode == 0, done.stdout + done.stderr
    assert len(done.stdout.splitlines()) == 7
