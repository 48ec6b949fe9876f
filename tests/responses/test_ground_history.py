"""The ground along a history: the extent of pushes and weights under straight lines is
that of the lines, one by one.
"""

from functools import reduce

import numpy as np
import pytest
from support.record_layouts import wave
from support.synthetic_records import motion_of_samples

from rocking_cli import Motion
from rocking_cli.motions.biaxial import with_vertical
from rocking_cli.responses.chebyshev import Extent
from rocking_cli.responses.ground_history import GroundMotion

ACROSS = motion_of_samples(wave(301, 4.0), 0.01)
MOTIONS = {
    "alone": ACROSS,
    "with a vertical motion": with_vertical(
        ACROSS, motion_of_samples(wave(401, 3.0)[::-1], 0.01)
    ),
    "with one of another step": with_vertical(
        ACROSS, motion_of_samples(wave(301, 3.0), 0.007)
    ),
}


def in_pieces(motion):
    """The same lines as pieces of any form."""
    return Motion(
        motion.name,
        motion.pieces,
        motion.vertical and Motion("up", motion.vertical.pieces),
    )


@pytest.mark.parametrize("motion", MOTIONS.values(), ids=MOTIONS)
@pytest.mark.parametrize(
    ("low", "high"),
    [(0.0, 0.013), (0.413, 0.431), (0.4, 7.31), (0.0, 20.0), (20.0, 21.0)],
)
def test_lines_at_once_are_lines_one_by_one(motion, low, high):
    found, wanted = (
        GroundMotion(motion, 0.4, 0.5).lines(low, high),
        GroundMotion(in_pieces(motion), 0.4, 0.5).extents(low, high),
    )
    assert found is not None
    for x, parts in zip(found, zip(*wanted, strict=True), strict=True):
        y = reduce(Extent.join, parts)
        np.testing.assert_allclose(
            (x.least, x.largest), (y.least, y.largest), rtol=0, atol=4e-16
        )


def test_a_ground_without_a_weight_says_so_without_a_warning():
    weight, _ = GroundMotion(MOTIONS["with a vertical motion"], 4.0, 0.5).lines(
        0.0, 20.0
    )
    assert weight.least < 0.0
