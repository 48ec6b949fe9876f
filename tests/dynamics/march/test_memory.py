"""Arrays that come and go: their memory stays with the process, even where dask has told the C library otherwise."""

from __future__ import annotations

import os
import platform
import subprocess
import sys

import pytest

CODE = """
import resource
import numpy as np
from rocking_cli import linear_response, sine
axis = np.linspace(0.5, 12.0, 300)
for _ in range(4):
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    linear_response(sine(), axis[None, :], axis[:, None], 0.9)
print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)
"""


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="another C library")
@pytest.mark.parametrize("asked", [{}, {"MALLOC_TRIM_THRESHOLD_": "65536"}])
def test_a_march_faults_in_no_memory_that_it_had_before(asked):
    done = subprocess.run([sys.executable, "-c", CODE], env={**os.environ, **asked}, capture_output=True, text=True, check=True)
    assert int(done.stdout) < 2000  # pages; 36,000 where each round gets its arrays anew
