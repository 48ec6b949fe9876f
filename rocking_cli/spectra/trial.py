"""A file without a seal, read on trial by a process of its own, since HDF5 may crash or loop for ever over a damaged one."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

from ..errors import UsageError

SECONDS = 10  # of processor time, and one more for each 10 MB: a tenth of what a slow disk and a slow machine take


def trial(path: Path) -> None:
    """Read a file's layout and index in another process. Raises ValueError with the reason why it cannot be read."""
    root = str(Path(__file__).resolve().parents[2])
    code = "import sys; sys.path.insert(0, sys.argv[1]); from rocking_cli.spectra.trial import main; main(sys.argv[2])"
    call = [sys.executable, "-c", code, root, os.fspath(path)]
    done = subprocess.run(call, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=False)
    if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        raise ValueError("HDF5 comes to no end over it")
    if done.returncode < 0:
        raise ValueError(f"HDF5 crashes over it, {signal.Signals(-done.returncode).name}")
    if done.returncode:
        raise ValueError(done.stdout.decode(errors="replace").strip() or "it cannot be read")


def main(path: str) -> None:
    """The other process: ends with 0, or with 1 and the reason on standard output."""
    import resource

    import h5py

    from .contents import FAULTS, chunk_places, contents_of
    from .part import RawFile, open_regular

    raw = RawFile(open_regular(Path(path)))
    seconds = SECONDS + os.fstat(raw.descriptor).st_size // 10**7
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
    try:
        with h5py.File(raw, "r") as file:
            chunk_places(file, contents_of(file, raw.end), raw.end)
    except (*FAULTS, UsageError) as error:
        sys.stdout.write(str(error))
        sys.stdout.flush()
        os._exit(1)  # HDF5 is not asked to tidy up what it could not read
    os._exit(0)
