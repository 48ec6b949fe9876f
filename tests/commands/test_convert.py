"""`rocking info` and `rocking convert` at the shell."""

from __future__ import annotations

import json

import pytest
from written import SMALL_SCENE


def test_info_and_convert(rocking):
    rocking("spectrum", *SMALL_SCENE, "-o", "s.h5")
    (record,) = [json.loads(x) for x in rocking("info", "s.h5", "--verify", "--json").stdout.splitlines()]
    assert record["complete"] == "yes"
    assert record["damaged_chunks"] == 0
    lines = rocking("convert", "s.h5").stdout.splitlines()
    assert lines[0] == "structure,Omega,A,outcome,theta_ratio"
    assert len(lines) == 1 + 2 * 200 * 200
    first = json.loads(rocking("convert", "s.h5", "--json").stdout.splitlines()[39_999])
    assert first == {
        "structure": "eta=0.9",
        "Omega": 12.0,
        "A": 12.0,
        "outcome": "rocked",
        "theta_ratio": pytest.approx(first["theta_ratio"]),
    }
