"""`rocking info` at the shell."""

from __future__ import annotations

import json

from written import SMALL_SCENE


def test_a_complete_file_is_told_and_verified(rocking):
    rocking("spectrum", *SMALL_SCENE, "-o", "s.h5")
    (record,) = [json.loads(x) for x in rocking("info", "s.h5", "--verify", "--json").stdout.splitlines()]
    assert record["complete"] == "yes"
    assert record["damaged_chunks"] == 0
