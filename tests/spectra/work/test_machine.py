"""Machines that compute differently are recognised, and named."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import scipy

import rocking_cli
from rocking_cli.spectra.work.machine import (
    described,
    machine,
    together,
    unlike,
    version,
)


def test_a_machine_is_told_by_versions_and_vector_instructions():
    here = machine()
    assert list(here) == [
        "platform",
        "libc",
        "python",
        "numpy",
        "scipy",
        "h5py",
        "hdf5",
        "cpu",
    ]
    assert (here["numpy"], here["scipy"]) == (np.__version__, scipy.__version__)
    assert json.loads(json.dumps(here)) == here
    assert f"numpy {np.__version__}, " in described(here)


def test_instructions_that_numpy_is_told_to_leave_count_as_missing():
    code = (
        "import json; from rocking_cli.spectra.work.machine import machine;"
        " print(json.dumps(machine()))"
    )
    first = machine()
    dispatched = np.show_config(mode="dicts")["SIMD Extensions"].get("found", [])
    env = {**os.environ, "NPY_DISABLE_CPU_FEATURES": " ".join(dispatched)}
    second = json.loads(
        subprocess.run(
            [sys.executable, "-c", code],
            env=env,
            capture_output=True,
            text=True,
            check=True,
        ).stdout
    )
    assert second["cpu"] == [x for x in first["cpu"] if x not in dispatched]
    assert unlike([first, second]).startswith("cpu ") == bool(dispatched)


def test_a_version_tells_states_of_the_code_apart(tmp_path, monkeypatch):
    """Of a copy of the package the same, and another once a character, or the name of a
    file, is another.
    """
    copy = tmp_path / "rocking_cli"
    shutil.copytree(
        Path(rocking_cli.__file__).parent,
        copy,
        ignore=shutil.ignore_patterns("__pycache__"),
    )
    monkeypatch.setattr(
        "rocking_cli.spectra.work.machine.__file__",
        str(copy / "spectra" / "work" / "machine.py"),
    )
    engine = copy / "dynamics" / "march" / "engine.py"
    found = [version(), version.__wrapped__()]
    engine.write_bytes(engine.read_bytes()[:-2] + b" \n")
    found.append(version.__wrapped__())
    engine.rename(engine.with_name("other.py"))
    found.append(version.__wrapped__())
    assert found[0] == found[1]
    assert (
        len({text.removeprefix(f"{rocking_cli.__version__}+") for text in found}) == 3
    )


def test_what_differs_is_named_with_every_value():
    one, two = {"numpy": "2.0", "cpu": ["A", "B"]}, {"numpy": "2.1", "cpu": ["A", "B"]}
    assert unlike([one, one]) == ""
    assert unlike([one, two, one]) == "numpy 2.0 and 2.1"
    assert unlike([one, {"numpy": "2.0", "cpu": ["A"]}]) == "cpu A B and A"
    assert unlike([one, {}]) == "numpy 2.0 and unknown, cpu A B and unknown"
    assert together([[one], [two, one]]) == [one, two]
