"""A file without a seal, read on trial by a process of its own, since HDF5 may crash or loop for ever over a damaged one."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

from ..errors import FAULTS, UsageError

SECONDS = 10  # of processor time, and one more for each 10 MB: it takes half a second and 10 ms
_CODE = "import sys; sys.path.insert(0, sys.argv[1]); from rocking_cli.spectra.trial import main; main(sys.argv[2], int(sys.argv[3]))"


def trial(path: Path) -> None:
    """Read a file's layout and index in another process. Raises ValueError with the reason why it cannot be read, OSError."""
    root = str(Path(__file__).resolve().parents[2])
    seconds = SECONDS + os.stat(path).st_size // 10**7
    call = [sys.executable, "-c", _CODE, root, os.fspath(path), str(seconds)]
    done = subprocess.run(call, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=False)
    if done.returncode == -signal.SIGXCPU:
        raise ValueError("HDF5 comes to no end over it")
    if done.returncode < 0:
        raise ValueError(f"HDF5 crashes over it, {signal.Signals(-done.returncode).name}")
    if done.returncode:
        raise ValueError(done.stdout.decode(errors="replace").strip() or "it cannot be read")


def main(path: str, seconds: int) -> None:
    """The other process: ends with 0, or with 1 and the reason on standard output."""
    import resource

    import h5py

    from .contents import chunk_places, contents_of, reason
    from .raw_file import RawFile, open_regular

    raw = RawFile(open_regular(Path(path)))
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 5))
    try:
        with h5py.File(raw, "r") as file:
            chunk_places(file, contents_of(file, raw.end), raw.end)
    except (*FAULTS, UsageError) as error:
        sys.stdout.write(reason(error))
        sys.stdout.flush()
        os._exit(1)  # HDF5 is not asked to tidy up what it could not read
    os._exit(0)
