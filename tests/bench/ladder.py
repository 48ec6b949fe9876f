"""The numeric tests as other machines would run them: `python tests/bench/ladder.py`,
or `make ladder`.

What a processor changes in the results of the same program are three libraries that
pick their kernels by it: OpenBLAS (sums in another order), NumPy's loops (sine and
exponential in other polynomials) and the C library's mathematics (with and without
fused multiply-add). Each is told to take another machine's kernels, from this
processor's highest level downwards. The tests that run are those that compare numbers:
documents, commands and files only hand on what these compute. Prints a table; exit code
1 where a test fails that passes on this machine as it is.
"""

import contextlib
import io
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
NUMERIC = [
    f"tests/{room}"
    for room in ("dynamics", "envelopes", "motions", "responses", "structures")
]
CORES = ("Haswell", "SkylakeX", "Zen", "Prescott")
WITHOUT_FMA = "glibc.cpu.hwcaps=-AVX512F,-AVX2,-FMA,-FMA4"


def levels() -> list[str]:
    """What NumPy dispatches on here beyond its baseline, rising, by its own report."""
    with contextlib.redirect_stdout(io.StringIO()) as said:
        np.show_runtime()
    found = re.search(r"'found': \[(.*?)\]", said.getvalue(), re.DOTALL)
    return re.findall(r"'(\w+)'", found[1]) if found else []


def rungs() -> list[dict[str, str]]:
    """The environments, this machine's own first; of NumPy's levels the highest is gone
    first, then the two highest, ...
    """
    names = levels()
    off = [
        {"NPY_DISABLE_CPU_FEATURES": " ".join(names[i:])}
        for i in reversed(range(len(names)))
    ]
    return [
        {},
        *({"OPENBLAS_CORETYPE": core} for core in CORES),
        *off,
        {"GLIBC_TUNABLES": WITHOUT_FMA},
    ]


def climb(environment: dict[str, str]) -> tuple[str, list[str]]:
    """The last line of pytest and the tests that failed."""
    done = subprocess.run(
        [
            sys.executable,
            "-m",
            "pytest",
            "-n",
            "2",
            "--tb=line",
            *NUMERIC,
            *sys.argv[1:],
        ],
        cwd=ROOT,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    failed = re.findall(r"^(?:FAILED|ERROR) (\S+)", done.stdout, re.MULTILINE)
    lines = (done.stdout + done.stderr).strip().splitlines()
    return (lines[-1] if lines else f"ended with {done.returncode}"), failed


def main() -> int:
    worst = 0
    for environment in rungs():
        said, failed = climb(environment)
        name = (
            " ".join(f"{key}={value}" for key, value in environment.items())
            or "as it is"
        )
        print(f"{name[:110]:<112}{re.sub('=+', '', said).strip()}", flush=True)
        for test in failed:
            print(f"    {test}", flush=True)
        worst |= bool(failed) or " passed" not in said
    return int(worst)


if __name__ == "__main__":
    sys.exit(main())
