"""First falls of many bodies together are those that an envelope traces for each."""

import numpy as np
import pytest

from rocking_cli import Method, cosine, load_structures, sine, trace_envelope
from rocking_cli.dynamics.shared_march import SharedMarch
from rocking_cli.envelopes.boundaries import Search
from rocking_cli.envelopes.first_falls import FirstFalls

BODIES = ("block:0.5x2", "rigid:left=0.42,right=0.31,height=1.15,gyration=0.68")
MOST = 1.6
OMEGAS = np.array([1.5, 2.0, 3.0, 4.0])


@pytest.mark.parametrize("motion", [sine(), cosine(1)], ids=lambda m: m.name)
def test_first_falls_are_those_of_an_envelope(motion):
    """Under one cycle, and under a motion that is scanned more finely."""
    method, structures = (
        Method("nonlinear"),
        [load_structures(body)[0] for body in BODIES],
    )
    march = SharedMarch(motion, structures, [method] * len(structures))
    searches = {
        i: Search(method.system_of(one), motion, one.eta, MOST)
        for i, one in enumerate(structures)
    }
    body = np.repeat(np.arange(len(BODIES)), OMEGAS.size)
    digits = np.full(len(BODIES), 1e-9)
    falls = FirstFalls(march, searches, body, np.tile(OMEGAS, len(BODIES)), digits)
    falls.climb(np.full(len(BODIES), MOST))
    traced = np.full(body.size, np.inf)
    for i, structure in enumerate(structures):
        for interval in trace_envelope(
            structure, motion, OMEGAS, method=method, a_max=MOST, sign="+", workers=1
        ):
            row = i * OMEGAS.size + int(np.searchsorted(OMEGAS, interval.omega))
            traced[row] = min(traced[row], interval.a_from)
    np.testing.assert_array_equal(np.isinf(falls.high), np.isinf(traced))
    assert 2 <= np.isfinite(traced).sum() < traced.size
    fallen = np.flatnonzero(np.isfinite(traced))
    assert np.all(falls.low[fallen] < traced[fallen] * (1.0 + 1e-9))
    assert np.all(traced[fallen] <= falls.high[fallen] * (1.0 + 1e-9))
    # The comparison of every two rows is that of the traced amplitudes.
    one, other = (x.ravel() for x in np.meshgrid(fallen, fallen))
    np.testing.assert_array_equal(
        falls.not_above(one, other), traced[one] <= traced[other]
    )
    assert falls.lowest(fallen) == traced.argmin()
    while falls.open(fallen).any():
        falls.sharpen(fallen)
    np.testing.assert_allclose(falls.high[fallen], traced[fallen], rtol=3e-9)
