"""The worst direction of two components: a motion in one direction, and every direction
checked by itself.
"""

import math
from functools import partial

import numpy as np
import pytest
from support.documents import built
from support.record_layouts import wave
from support.synthetic_records import recorded

from rocking_cli import UsageError, check
from rocking_cli.envelopes.amplitudes import Limit
from rocking_cli.motions.grid import as_recorded
from rocking_cli.motions.records.record import record_motion
from rocking_cli.responses.azimuth import at_azimuth, worst_azimuths
from rocking_cli.responses.check import verdicts

BODY = built("{kind: block, name: A, width: 0.5, height: 2}")
ONE_SIDED = built(
    "{kind: block, name: A, width: 0.5, height: 2, one_sided: true}"
)  # the name of the other one
SAMPLES = wave(120, 3.4)
AZIMUTHS = np.radians(np.arange(0.0, 180.0, 30.0))
component = partial(recorded, dt=0.05)


def test_two_components_in_a_direction():
    pair = [component(SAMPLES, factor=1.5), component(-2.0 * SAMPLES[:80], factor=1.5)]
    found = at_azimuth(pair, math.radians(30.0))
    wanted = math.cos(math.radians(30.0)) * SAMPLES
    wanted[:80] -= 2.0 * math.sin(math.radians(30.0)) * SAMPLES[:80]
    np.testing.assert_allclose(
        found.record.acceleration, wanted, rtol=1e-14, atol=1e-15
    )
    assert (found.factor, found.label) == (1.5, "r 30 deg")
    other_step = [pair[0], component(SAMPLES, dt=0.02)]
    for wrong, words in (
        (pair[:1], "found 1 horizontal component; expected two"),
        (other_step, "expected equal"),
    ):
        with pytest.raises(UsageError, match=words):
            at_azimuth(wrong, 0.0)


def test_components_scaled_to_a_measure_have_the_factor_of_the_larger_one():
    """A record and its half, each scaled to its peak: at 0 deg it is the record times
    its own factor.
    """
    pair = [component(SAMPLES, factor=2.0), component(0.5 * SAMPLES, factor=-4.0)]
    for azimuth, wanted in ((0.0, 2.0 * SAMPLES), (0.5 * math.pi, SAMPLES)):
        found = at_azimuth(pair, azimuth)
        np.testing.assert_allclose(
            found.factor * found.record.acceleration, wanted, rtol=1e-12, atol=1e-12
        )


@pytest.mark.parametrize("degrees", [30, 150])
def test_a_motion_in_one_direction_is_worst_there(degrees):
    """A body with one side is shaken in the opposite direction too, which may be the
    worse one.
    """
    pair = [
        component(turn * SAMPLES)
        for turn in (math.cos(math.radians(degrees)), math.sin(math.radians(degrees)))
    ]
    ((_, motion, grid), one), (_, of_other) = worst_azimuths(
        [BODY, ONE_SIDED], pair, AZIMUTHS, workers=1
    )
    angle, other = one.columns["azimuth"], of_other.columns["azimuth"]
    assert math.degrees(angle) == pytest.approx(degrees)
    assert float(grid.amplitude.values[0]) == pytest.approx(3.4, rel=1e-9)
    alone = [
        check(
            ONE_SIDED,
            record_motion(component(sign * SAMPLES).record),
            as_recorded(3.4),
            a_max=None,
        )
        for sign in (1.0, -1.0)
    ]
    ratios = [math.inf if v.falls else v.theta_ratio for v in alone]
    assert ratios[0] != ratios[1]
    assert math.degrees(other) == pytest.approx(
        degrees + 180.0 * (ratios[1] > ratios[0])
    )
    assert motion.name == f"r {degrees} deg"


@pytest.mark.soak
def test_the_capacity_is_the_least_and_the_rotation_the_largest_of_all_directions():
    """Every direction checked by itself: they are two different ones."""
    finely, n = partial(recorded, dt=0.025), np.arange(240.0)
    first = wave(240, 3.4)
    second = 2.6 * np.sin(0.35 * n) * np.sin(np.pi * n / 239.0)
    pair = [finely(first), finely(second)]
    (((structure, motion, grid), one),) = worst_azimuths(
        [BODY], pair, AZIMUTHS, Limit(6.0), workers=1
    )
    turned = {
        a: record_motion(finely(math.cos(a) * first + math.sin(a) * second).record)
        for a in AZIMUTHS.tolist()
    }
    alone = {
        a: check(BODY, m, as_recorded(m.acceleration), a_max=6.0)
        for a, m in turned.items()
    }
    (row,) = verdicts(
        [(structure, motion, grid)], ranges={"A": one}, a_max=6.0, workers=1
    )
    least = min(alone, key=lambda a: alone[a].capacity_demand)
    largest = max(alone, key=lambda a: alone[a].theta_ratio)
    assert least != largest
    assert row.ranged == {"azimuth": least, "largest_azimuth": largest}
    assert row.capacity_demand == alone[least].capacity_demand
    assert row.theta_ratio == alone[largest].theta_ratio > alone[least].theta_ratio
    assert row.top_displacement == alone[largest].top_displacement
