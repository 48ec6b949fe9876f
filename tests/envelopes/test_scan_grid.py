"""Rungs of the scan: between any two amplitudes, and beyond."""

from __future__ import annotations

import numpy as np

from rocking_cli.envelopes.scan_grid import ScanGrid


def test_amplitudes_beyond_any_whole_number_lie_above_the_last_rung():
    scan = ScanGrid.between(1.0, 20.0)
    assert scan.below(np.array([1e25, 1e308])).tolist() == [scan.size - 1] * 2
