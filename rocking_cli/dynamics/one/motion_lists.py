"""A motion as lists of floats, and the closed form of each of its segments."""

import math
from typing import Any, NamedTuple

import numpy as np

from ...motions.segments import Segments

_BLOCK = 1 << 15  # segments whose lists are held at once


class Block(NamedTuple):
    """Segments that follow one another, as lists with a number for each."""

    first: int  # index of the first segment
    start: list[float]  # s at the start of each segment [-], (segments,)
    rise: list[float]  # increase of s over each segment [-], (segments,)
    length: list[float]  # length of each segment [rad], (segments,)
    # from the start of each segment to the end of its piece [rad], (segments,)
    ahead: list[float]
    after: list[int]  # index of the segment behind the piece, (segments,)
    # start of the vertical motion in each segment [-], (segments,); empty without one
    up: list[float]
    # its increase over each segment [-], (segments,); empty without one
    up_rise: list[float]


class Wave:
    """The closed form of a segment, and of its piece: sinusoids and a straight line."""

    def __init__(self, segments: Segments, k: int) -> None:
        columns = (
            x[:, k].tolist() for x in (segments.sin, segments.cos, segments.frequency)
        )
        # of each sinusoid: sine part at the start of the segment [-], cosine part there
        # [-], frequency over that of the motion [-]
        self.parts = [row for row in zip(*columns, strict=True) if row[0] or row[1]]
        self.slope = float(segments.slope[k])  # of the straight line [1/rad]
        self.fastest = max((w for *_, w in self.parts), default=0.0)

    def change(self, u: float) -> float:
        """s at phase u of the segment, less s at its start."""
        total = self.slope * u
        for sin, cos, w in self.parts:
            t = math.tan(0.5 * w * u)
            total += 2.0 * t * (cos - sin * t) / (1.0 + t * t)
        return total

    def terms(self, u: float, unit: float, count: int) -> list[float]:
        """The terms of s from phase u on, in powers of the phase over `unit` [rad];
        term 0 is left at 0. count: their number, an odd one.
        """
        found = [0.0] * count
        for sin, cos, w in self.parts:
            x, c, s = w * unit, math.cos(w * u), math.sin(w * u)
            odd, even = (cos * c - sin * s) * x, -0.5 * (sin * c + cos * s) * x * x
            square = -x * x
            for n in range(1, count - 1, 2):
                found[n] += odd
                found[n + 1] += even
                odd *= square / ((n + 1) * (n + 2))
                even *= square / ((n + 2) * (n + 3))
        found[1] += self.slope * unit
        return found


class MotionLists:
    """The segments of a motion, read block by block as lists of floats."""

    def __init__(self, segments: Segments) -> None:
        self.segments = segments
        self.straight = segments.straight  # True if every segment is a straight line
        self.count = len(segments)
        self.vertical = None if segments.weighed is None else segments.weighed.vertical
        # the block that was read last
        self.block = Block(0, [], [], [], [], [], [], [])
        self._waves: dict[int, tuple[Wave, ...]] = {}

    def at(self, k: int) -> Block:
        """The block that holds segment k."""
        block = self.block
        if not block.first <= k < block.first + len(block.length):
            block = self.block = self._read(k - k % _BLOCK)
        return block

    def _read(self, first: int) -> Block:
        part = slice(first, min(first + _BLOCK, self.count))
        lists: list[Any] = []
        for segments in (self.segments, self.vertical):
            start = (
                np.empty(0) if segments is None else np.asarray(segments.s_start[part])
            )
            end = start if segments is None else np.asarray(segments.s_end[part])
            lists += [start.tolist(), (end - start).tolist()]
        length = np.asarray(self.segments.length[part]).tolist()
        joins = np.asarray(self.segments.joins[part]).tolist()

        # From the last segment back: what is left of its piece.
        ahead, after = list(length), list(range(first + 1, part.stop + 1))
        for i in range(len(length) - 2, -1, -1):
            if joins[i]:
                ahead[i] += ahead[i + 1]
                after[i] = after[i + 1]
        return Block(
            first, lists[0], lists[1], length, ahead, after, lists[2], lists[3]
        )

    def waves(self, k: int) -> tuple[Wave, ...]:
        """The waves of a segment that is not straight: the horizontal one, and the
        vertical one if there is one.
        """
        found = self._waves.get(k)
        if found is None:
            signals = [x for x in (self.segments, self.vertical) if x is not None]
            found = self._waves[k] = tuple(Wave(x, k) for x in signals)
        return found

    def value(self, k: int, u: float) -> tuple[float, float]:
        """s and the vertical s_v at phase u of segment k."""
        block = self.at(k)
        i = k - block.first
        if self.straight:
            share = u / block.length[i]
            return block.start[i] + block.rise[i] * share, (
                block.up[i] + block.up_rise[i] * share if block.up else 0.0
            )
        waves = self.waves(k)
        return block.start[i] + waves[0].change(u), (
            block.up[i] + waves[1].change(u) if block.up else 0.0
        )
