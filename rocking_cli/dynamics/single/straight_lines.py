"""The straight lines of a record ahead of one body on floats: the drive along each of
them, and the tests by which the body is taken over a whole line at once.
"""

import math
from bisect import bisect_left
from collections.abc import Sequence

from ..equations.recurrence import motion_terms
from ..equations.taylor import MOST_TERMS
from .lane import Block, LaneEdge

# 1/((n + 1)(n + 2)), by which term n + 2 of y follows from term n of y''
RECIPROCALS = [1.0 / ((n + 1) * (n + 2)) for n in range(MOST_TERMS)]


class StraightLines:
    """The lines of a block for a body on one edge. A line is named by its index in the
    block; with a varying weight its drive is the horizontal one, not the net drive.
    """

    def __init__(
        self,
        block: Block,
        edge: LaneEdge,
        damping: float,
        limits: Sequence[float],
    ) -> None:
        self.start, self.rise, self.length = block.start, block.rise, block.length
        self.up, self.up_rise = block.up, block.up_rise
        self.drive, self.sway = edge.drive, edge.sway
        self.largest_fall = edge.largest_fall
        self.equation = edge.equation
        self.damping = damping  # zeta [-]
        self.limits = limits  # largest sizes for each degree (`taylor.size_limits`)
        self.pace = 1.0 / edge.omega  # tau of the edge for a phase of 1 rad
        self.factors: list[float] = []  # factors of the last series ...
        self.factors_of = (0.0, 0)  # ... and their (duration, degree)

    def shaking(
        self, k: int, u: float
    ) -> tuple[float, list[float], list[float] | None]:
        """(duration h [tau], outward drive [-], weight over m g) of line k from phase u
        on. Drive and weight are [value at the start, increase]; a constant weight is
        None.
        """
        length = self.length[k]
        h = length * self.pace
        drive, gain = self.drive * self.start[k], self.drive * self.rise[k]
        over = u / length if u else 0.0
        weight = None
        if self.up:
            start, heavier = 1.0 + self.sway * self.up[k], self.sway * self.up_rise[k]
            weight = [start + heavier * over, heavier - heavier * over]
        if over:
            drive, gain, h = drive + gain * over, gain - gain * over, h - h * over
        return h, [drive, gain], weight

    def is_clear(self, y: float, v: float, h: float) -> bool:
        """True if no impact comes before the end of the line (Lemma 12)."""
        first = v * h
        drop = 0.5 * self.largest_fall * (h * h)
        return y + first - self.damping * h * abs(first) > drop

    @staticmethod
    def supercritical(drive: list[float], weight: list[float] | None) -> bool:
        """True if the net drive exceeds 1 at an end of the line, so that Lemma 1 does
        not hold.
        """
        if weight is None:
            return drive[0] > 1.0 or drive[0] + drive[1] > 1.0
        return drive[0] > weight[0] or drive[0] + drive[1] > weight[0] + weight[1]

    def terms(
        self,
        y: float,
        v: float,
        h: float,
        drive: list[float],
        weight: list[float] | None,
        force: float | None,
    ) -> list[float]:
        """The Taylor terms of y over the line, in powers of the time over h."""
        # The size of acceleration and drive gives the degree.
        size = 2.0 + abs(drive[0]) + abs(v)
        if weight is None:
            size = size + abs(drive[1]) / h + 1.0
        else:
            size = size + (abs(drive[1]) + abs(weight[1])) / h + weight[0]
        degree = 3 + bisect_left(self.limits, size)
        # Most lines are as long as the one before: the factors are kept.
        if self.factors_of != (h, degree):
            square = h * h
            self.factors = [square * c for c in RECIPROCALS[: degree - 1]]
            self.factors_of = (h, degree)
        return motion_terms(self.equation, y, v, h, self.factors, drive, weight, force)

    def highest(self, y: float, end: float, h: float) -> float:
        """A bound of y on a line between these two ends (Lemma 12)."""
        drag = math.exp(2.0 * self.damping * h) if self.damping else 1.0
        return max(y, end) + 0.125 * self.largest_fall * (h * h) * drag
