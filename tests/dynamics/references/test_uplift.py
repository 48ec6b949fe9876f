"""Lines that lift no body at rest are passed over, and no others."""

from __future__ import annotations

import numpy as np

from rocking_cli.dynamics.references.uplift import lies_still, next_uplift
from rocking_cli.motions.piece import Harmonic, Piece


def test_what_lies_still_is_lifted_nowhere_and_nothing_else():
    random = np.random.default_rng(3)
    still = 0
    for constant, slope, right, left in np.column_stack([random.uniform(-1.5, 1.5, (300, 2)), random.uniform(0.3, 2.0, (300, 2))]).tolist():
        for edges in ((right, left), (right, 0.0)):
            piece = Piece(2.0, 3.0, (), constant, slope)
            lies = lies_still(piece, *edges)
            assert lies == (next_uplift(piece, 2.0, *edges) is None)
            still += lies
    assert 100 < still < 500
    assert not lies_still(Piece(0.0, 1.0, (Harmonic(0.1),)), 1.0, 1.0)
