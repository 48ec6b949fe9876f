"""Lanes for the tests of contacts."""

from __future__ import annotations

import numpy as np
import pytest

from rocking_cli.dynamics.lanes import Lanes


@pytest.fixture
def lanes():
    """Lanes on a side with amplitude, speed, force, eta (each an array) at the start of the motion; the rest is plain."""

    def build(side, v=0.0, b=-0.5, eta=0.8, amplitude=2.0, omega=3.0, peak=1.0):
        side, v, b, eta, amplitude, omega, peak = (
            np.array(x, dtype=float) for x in np.broadcast_arrays(np.atleast_1d(side), v, b, eta, amplitude, omega, peak)
        )
        zero, none = np.zeros(side.size), np.zeros(side.size, dtype=np.int64)
        return Lanes(np.arange(side.size), amplitude, omega, eta, none, zero, side, zero.copy(), v, b, peak, none.copy(), none.copy())

    return build
