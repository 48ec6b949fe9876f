"""What a result depends on beside what is asked for: the state of this program, the libraries, and the instructions that they use here.

Two machines that agree in all of this compute the same bytes; others with the same program may differ in the last digits of cells.
"""

from __future__ import annotations

import hashlib
import json
import platform
from collections.abc import Mapping, Sequence
from functools import cache
from importlib.util import find_spec, module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

from ... import __version__

_COMPUTES = ("dynamics", "motions", "spectra", "structures")  # packages on whose code the values of a spectrum hang


@cache
def version() -> str:
    """The version of this program, and behind it a digest of the code that computes spectra, which tells states of a version apart."""
    package, digest = Path(__file__).parents[2], hashlib.blake2b(digest_size=8)
    for path in sorted(path for folder in _COMPUTES for path in (package / folder).rglob("*.py")):
        code = path.read_bytes()
        digest.update(f"{path.relative_to(package).as_posix()} {len(code)}\n".encode() + code)
    return f"{__version__}+{digest.hexdigest()}"


def machine() -> dict[str, Any]:
    """This machine and its libraries by name, as JSON values; `cpu`: what NumPy uses of the processor's vector instructions."""
    import h5py
    import numpy as np

    vectors: Mapping[str, Any] = np.show_config(mode="dicts") or {}
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
    """What its module `version` states, read without the package itself, whose import would take longer than a small sweep."""
    spec = find_spec(package)
    if spec is None or spec.origin is None:
        return "unknown"
    there = spec_from_file_location(f"{package}.version", Path(spec.origin).with_name("version.py"))
    assert there is not None
    assert there.loader is not None  # a name that ends in .py has one
    module = module_from_spec(there)
    there.loader.exec_module(module)
    version: str = module.version
    return version


def described(machine: Mapping[str, Any]) -> str:
    """A machine in one line."""
    return ", ".join(f"{key} {' '.join(value) if isinstance(value, list) else value}" for key, value in machine.items())


def machines_of(text: Any) -> list[dict[str, Any]]:
    """The machines that a file's attribute `computed_on` lists, in their order; none where it cannot be read."""
    try:
        found = json.loads(text)
    except (TypeError, ValueError):
        return []
    return [m for m in found if isinstance(m, dict)] if isinstance(found, list) else []


def together(lists: Sequence[Sequence[Mapping[str, Any]]]) -> list[dict[str, Any]]:
    """All machines of several lists, each once."""
    found: list[dict[str, Any]] = []
    for m in (dict(m) for machines in lists for m in machines):
        if m not in found:
            found.append(m)
    return found


def unlike(machines: Sequence[Mapping[str, Any]]) -> str:
    """In what several machines differ, by name and value; empty where they compute alike."""
    keys = dict.fromkeys(key for m in machines for key in m)
    parts = []
    for key in keys:
        values = list(dict.fromkeys(" ".join(v) if isinstance(v := m.get(key, "unknown"), list) else str(v) for m in machines))
        if len(values) > 1:
            parts.append(f"{key} {' and '.join(values)}")
    return ", ".join(parts)
