"""The search for extremes on stretches, and forces by the slopes that belong to them."""

import numpy as np
import pytest

from rocking_cli.dynamics.observers.extremes import Stretches
from rocking_cli.dynamics.observers.ground_forces import ForceExtremes, Forces


def searched(along, low, high, rate, one_way):
    """(largest |Fx|/Fz, least Fz) of each motion."""
    cell = np.arange(low.size)
    found = ForceExtremes(cell.size)
    found.include_along(cell, along, Stretches(cell, low, high, rate), along(cell, low), along(cell, high), one_way)
    return found.largest[: cell.size], -found.largest[cell.size :]


@pytest.mark.parametrize("one_way", [False, True])
def test_what_values_and_slopes_at_the_ends_do_not_show_is_found(one_way):
    """16 x^2 (1 - x)^2 rises from 0 to 1 and back between level ends."""

    def along(_own, x):
        bump, slope = 16.0 * (x * (1.0 - x)) ** 2, 32.0 * x * (1.0 - x) * (1.0 - 2.0 * x)
        return Forces(0.2 + 0.2 * bump, 1.0 - 0.1 * bump, 0.2 * slope, -0.1 * slope)

    friction, least = searched(along, np.zeros(1), np.ones(1), np.full(1, 5.0), one_way)
    assert least[0] == pytest.approx(0.9, abs=1e-7)
    assert friction[0] == pytest.approx(0.4 / 0.9, abs=1e-7)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("one_way", [False, True])
def test_sinusoids_of_any_phase_have_their_extremes(sign, one_way):
    """Fx = +-0.3 sin(3 t + c) + 0.1, Fz = 1 + 0.5 sin(3 t + d), on stretches of half a rate; against 4,001 instants."""
    random = np.random.default_rng(3)
    c, d = random.uniform(0.0, 6.3, (2, 300))

    def along(own, t):
        return Forces(
            sign * 0.3 * np.sin(3.0 * t + c[own]) + 0.1, 1.0 + 0.5 * np.sin(3.0 * t + d[own]),
            sign * 0.9 * np.cos(3.0 * t + c[own]), 1.5 * np.cos(3.0 * t + d[own]),
        )  # fmt: skip

    friction, least = searched(along, np.zeros(300), np.full(300, 0.5), np.full(300, 3.0), one_way)
    seen = [along(np.arange(300), np.full(300, t)) for t in np.linspace(0.0, 0.5, 4_001)]
    ratio = [(np.maximum(f.fx, 0.0) if one_way else np.abs(f.fx)) / f.fz for f in seen]
    assert friction == pytest.approx(np.max(ratio, axis=0), abs=2e-7)
    assert least == pytest.approx(np.minimum(np.min([f.fz for f in seen], axis=0), 1.0), abs=2e-7)  # at rest Fz is 1
