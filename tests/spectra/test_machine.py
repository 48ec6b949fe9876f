"""Machines that compute otherwise are told apart, and told of."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import numpy as np
import scipy

from rocking_cli.spectra.machine import described, machine, machines_of, together, unlike


def test_a_machine_is_told_by_versions_and_vector_instructions():
    here = machine()
    assert list(here) == ["platform", "libc", "python", "numpy", "scipy", "h5py", "hdf5", "cpu"]
    assert (here["numpy"], here["scipy"]) == (np.__version__, scipy.__version__)
    assert json.loads(json.dumps(here)) == here
    assert f"numpy {np.__version__}, " in described(here)


def test_instructions_that_numpy_is_told_to_leave_count_as_missing():
    code = "import json; from rocking_cli.spectra.machine import machine; print(json.dumps(machine()))"
    first = machine()
    dispatched = np.show_config(mode="dicts")["SIMD Extensions"].get("found", [])
    env = {**os.environ, "NPY_DISABLE_CPU_FEATURES": " ".join(dispatched)}
    second = json.loads(subprocess.run([sys.executable, "-c", code], env=env, capture_output=True, text=True, check=True).stdout)
    assert second["cpu"] == [x for x in first["cpu"] if x not in dispatched]
    assert unlike([first, second]).startswith("cpu ") == bool(dispatched)


def test_what_differs_is_named_with_every_value():
    one, two = {"numpy": "2.0", "cpu": ["A", "B"]}, {"numpy": "2.1", "cpu": ["A", "B"]}
    assert unlike([one, one]) == ""
    assert unlike([one, two, one]) == "numpy 2.0 and 2.1"
    assert unlike([one, {"numpy": "2.0", "cpu": ["A"]}]) == "cpu A B and A"
    assert unlike([one, {}]) == "numpy 2.0 and unknown, cpu A B and unknown"
    assert together([[one], [two, one]]) == [one, two]


def test_a_list_that_cannot_be_read_is_empty():
    for text in (None, "", "{", "3", '["x"]', 7):
        assert machines_of(text) == []
    assert machines_of(json.dumps([{"numpy": "2.0"}])) == [{"numpy": "2.0"}]
