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
from rocking_cli.motions.grid import as_recorded
from rocking_cli.motions.records.record import record_motion
from rocking_cli.responses.azimuth import at_azimuth, worst_azimuths

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


@pytest.mark.parametrize("degrees", [30, 150])
def test_a_motion_in_one_direction_is_worst_there(degrees):
    """A body with one side is shaken in the opposite direction too, which may be the
    worse one.
    """
    pair = [
        component(turn * SAMPLES)
        for turn in (math.cos(math.radians(degrees)), math.sin(math.radians(degrees)))
    ]
    (angle, (_, motion, grid)), (other, _) = worst_azimuths(
        [BODY, ONE_SIDED], pair, AZIMUTHS, workers=1
    )
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


@pytest.mark.slow
def test_the_worst_is_that_of_every_direction_checked_by_itself():
    second = (
        2.6 * np.sin(0.7 * np.arange(120.0)) * np.sin(np.pi * np.arange(120.0) / 119.0)
    )
    ((found, (_, motion, grid)),) = worst_azimuths(
        [BODY], [component(SAMPLES), component(second)], AZIMUTHS, workers=1
    )
    turned = {
        a: record_motion(component(math.cos(a) * SAMPLES + math.sin(a) * second).record)
        for a in AZIMUTHS.tolist()
    }
    verdicts = {
        a: check(BODY, m, as_recorded(m.acceleration), a_max=None)
        for a, m in turned.items()
    }
    ratios = {a: math.inf if v.falls else v.theta_ratio for a, v in verdicts.items()}
    assert ratios[found] == max(ratios.values()) > 0.0
    assert (
        check(BODY, motion, grid, a_max=None).theta_ratio == verdicts[found].theta_ratio
    )
