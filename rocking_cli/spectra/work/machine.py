"""The state of the program, its libraries and the processor; the last digits of results
depend on it.

Two machines with equal states compute the same bytes.
"""

import hashlib
import platform
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from ... import __version__

# packages whose code computes the values of a file
_COMPUTES = (
    "dynamics",
    "envelopes",
    "motions",
    "responses",
    "spectra",
    "structures",
)


@cache
def version() -> str:
    """Return the version of this program and a digest of the code that computes
    spectra, which differs between states of one version.
    """
    package, digest = Path(__file__).parents[2], hashlib.blake2b(digest_size=8)
    for folder in _COMPUTES:
        for path in sorted((package / folder).rglob("*.py")):
            stated, code = path.relative_to(package).as_posix(), path.read_bytes()
            digest.update(f"{stated} {len(code)}\n".encode() + code)
    return f"{__version__}+{digest.hexdigest()}"


def machine() -> dict[str, Any]:
    """This machine and its libraries by name, as JSON values; `cpu`: the vector
    instructions that NumPy uses.
    """
    import h5py
    import numpy as np

    vectors: Mapping[str, Any] = np.show_config(mode="dicts")
    simd = vectors.get("SIMD Extensions", {})
    return {
        "platform": f"{platform.system()} {platform.machine()}",
        "libc": " ".join(platform.libc_ver()).strip(),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "scipy": _version_of("scipy"),
        "h5py": h5py.__version__,
        "hdf5": h5py.version.hdf5_version,
        "cpu": [*simd.get("baseline", []), *simd.get("found", [])],
    }


def _version_of(package: str) -> str:
    """Return the version that a package states in `version.py`; its import, or its
    metadata, would take as long as a small sweep.
    """
    from importlib.util import find_spec
    from runpy import run_path

    spec = find_spec(package)
    folders = spec.submodule_search_locations if spec is not None else None
    return str(run_path(f"{folders[0]}/version.py")["version"]) if folders else "none"


def described(machine: Mapping[str, Any]) -> str:
    """Return a machine in one line."""
    return ", ".join(
        f"{key} {' '.join(value) if isinstance(value, list) else value}"
        for key, value in machine.items()
    )


def together(lists: Sequence[Sequence[Mapping[str, Any]]]) -> list[dict[str, Any]]:
    """Return all machines of several lists, each one once."""
    every = [dict(m) for machines in lists for m in machines]
    return [m for i, m in enumerate(every) if m not in every[:i]]


def unlike(machines: Sequence[Mapping[str, Any]]) -> str:
    """Return the differences of several machines, by name and value; empty if the
    machines compute alike.
    """
    found = {
        key: dict.fromkeys(
            " ".join(v) if isinstance(v := m.get(key, "unknown"), list) else str(v)
            for m in machines
        )
        for key in dict.fromkeys(key for m in machines for key in m)
    }
    return ", ".join(
        f"{key} {' and '.join(values)}"
        for key, values in found.items()
        if len(values) > 1
    )
