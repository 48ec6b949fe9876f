"""Uplift from rest for the slower paths: a bisection between the extremes of a piece."""

from __future__ import annotations

from ...motions.extremes import extremes
from ...motions.piece import Piece


def next_uplift(piece: Piece, phase: float, right: float, left: float) -> tuple[float, int] | None:
    """(phase, side) of the first uplift of a body at rest from `phase` to the end of the piece; None if there is none.

    right, left: amplitudes over the uplift of each edge, 0 where there is no such edge: -right s > 1 or left s > 1.
    """

    def excess(at: float) -> float:
        s = float(piece.value(at))
        return (left if s > 0.0 else -right) * s - 1.0

    low = phase
    for mark in (phase, *(x for x in extremes(piece) if x > phase), piece.stop):  # s is monotone from one to the next
        high = mark
        if excess(high) > 0.0:
            while low < (middle := 0.5 * (low + high)) < high:
                low, high = (low, middle) if excess(middle) > 0.0 else (middle, high)
            return high, -1 if float(piece.value(high)) > 0.0 else 1
        low = mark
    return None


def lies_still(piece: Piece, right: float, left: float) -> bool:
    """Whether a straight line is known to lift no body at rest, amplitudes as in `next_uplift`: a long record has little else."""
    if piece.harmonics:
        return False
    start, end = piece.constant, piece.constant + piece.slope * (piece.stop - piece.start)
    return max(left * start, left * end, -right * start, -right * end) <= 1.0
