"""What POSIX alone offers is not needed: every module is imported, and a spectra file
written and read, without these names.
"""

import subprocess
import sys

WITHOUT = """
import os, pkgutil, signal, sys
from importlib import import_module
from types import SimpleNamespace

import click, distributed, h5py, jinja2, matplotlib.figure, numpy, yaml
import scipy.integrate, scipy.linalg, scipy.optimize, scipy.special

for module in ("fcntl", "resource", "pwd", "grp", "termios"):
    sys.modules[module] = None
sys.modules["msvcrt"] = SimpleNamespace(LK_NBLCK=2, locking=lambda *_: None)
for module, names in (
    (os, "pread pwrite preadv pwritev fork register_at_fork mkfifo getppid getuid "
     "sched_getaffinity posix_fallocate set_blocking chown "
     "O_CLOEXEC O_NONBLOCK O_NOFOLLOW O_TMPFILE O_DIRECTORY"),
    (signal, "SIGXCPU SIGKILL SIGPIPE SIGALRM SIGHUP SIGUSR1 pthread_sigmask "
     "setitimer alarm"),
):
    for name in names.split():
        delattr(module, name)

import rocking_cli
for found in pkgutil.walk_packages(rocking_cli.__path__, "rocking_cli."):
    if found.name != "rocking_cli.__main__":
        import_module(found.name)

from rocking_cli import SpectraFile, dimensionless_oscillator, load_structures
from rocking_cli import parse_grid, sine, write_spectrum
from rocking_cli.errors import Interrupted
from rocking_cli.reports.drawing_files import draw

def stop(done, total):
    if done == 2:
        raise KeyboardInterrupt

grid = parse_grid("A=1:8:20,Omega=1:8:20")
call = [dimensionless_oscillator(eta=0.9)], sine(), grid, "s.h5"
try:
    write_spectrum(*call, workers=1, chunk_cells=100, progress=stop)
except Interrupted:
    print(SpectraFile("s.h5.part").done.tolist())
resumed = write_spectrum(*call, workers=1, chunk_cells=100, resume=True).resumed_cells
print(resumed, os.listdir())
with SpectraFile("s.h5") as file:
    print(file.complete, file.damaged_chunks(), file.array("outcome").shape)
draw("s.h5", "s.svg")
"""


def test_nothing_of_posix_is_needed(tmp_path):
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == [
        "[True, True, False, False]",
        "200 ['s.h5']",
        "True [] (1, 20, 20)",
    ]
    assert sorted(p.name for p in tmp_path.iterdir()) == ["s.h5", "s.svg"]
