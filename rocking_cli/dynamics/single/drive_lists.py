"""The motion under one body as lists of floats: its segments, a block at a time, and the sinusoids and slope of each."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from ...motions.segments import Segments

_BLOCK = 1 << 15  # segments whose lists are held at once


class Block(NamedTuple):
    """Segments first ... first + len(length) - 1: s at their start, its rise, and their length [rad]; up, up_rise: the start and rise of
    the vertical motion, empty without one."""

    first: int
    start: list[float]
    rise: list[float]
    length: list[float]
    up: list[float]
    up_rise: list[float]


class Wave(NamedTuple):
    """The closed form of a segment: (sine part at its start, cosine part there, frequency) of each sinusoid, and the slope by the phase."""

    parts: list[tuple[float, float, float]]
    slope: float

    @classmethod
    def of(cls, segments: Segments, k: int) -> Wave:
        """Returns the wave of segment k."""
        columns = (x[:, k].tolist() for x in (segments.sin, segments.cos, segments.frequency))
        return cls([row for row in zip(*columns, strict=True) if row[0] or row[1]], float(segments.slope[k]))

    def change(self, u: float) -> float:
        """s at phase u of the segment, less s at its start."""
        total = self.slope * u
        for sin, cos, w in self.parts:
            t = math.tan(0.5 * w * u)
            total += 2.0 * t * (cos - sin * t) / (1.0 + t * t)
        return total

    def terms(self, u: float, length: float, order: int) -> list[float]:
        """Terms 1 ... order of s from phase u on, in powers of the share of a stretch of this length [rad]; term 0 is left at 0."""
        found = [0.0] * (order + 1)
        found[1] = self.slope * length
        for sin, cos, w in self.parts:
            x, c, s = w * length, math.cos(w * u), math.sin(w * u)
            odd, even = (cos * c - sin * s) * x, -0.5 * (sin * c + cos * s) * x * x
            for n in range(1, order, 2):
                found[n] += odd
                found[n + 1] += even
                odd *= -x * x / ((n + 1) * (n + 2))
                even *= -x * x / ((n + 2) * (n + 3))
            if order % 2:
                found[order] += odd
        return found


class Reel:
    """The segments of a motion, read block by block as lists of floats."""

    def __init__(self, segments: Segments) -> None:
        self.segments, self.straight, self.count = segments, segments.straight, len(segments)
        self.vertical = None if segments.weighed is None else segments.weighed.vertical
        self.block = Block(0, [], [], [], [], [])
        self._waves: dict[int, tuple[Wave, ...]] = {}

    def at(self, k: int) -> Block:
        """The block that holds segment k."""
        block = self.block
        if not block.first <= k < block.first + len(block.length):
            first = k - k % _BLOCK
            part = slice(first, min(first + _BLOCK, self.count))
            lists: list[Any] = []
            for segments in (self.segments, self.vertical):
                start = np.empty(0) if segments is None else np.asarray(segments.s_start[part])
                end = start if segments is None else np.asarray(segments.s_end[part])
                lists += [start.tolist(), (end - start).tolist()]
            length = np.asarray(self.segments.length[part]).tolist()
            block = self.block = Block(first, lists[0], lists[1], length, lists[2], lists[3])
        return block

    def waves(self, k: int) -> tuple[Wave, ...]:
        """The waves of a segment that is not straight: the horizontal one, and the vertical one if there is one."""
        found = self._waves.get(k)
        if found is None:
            signals = [self.segments] if self.vertical is None else [self.segments, self.vertical]
            found = self._waves[k] = tuple(Wave.of(x, k) for x in signals)
        return found

    def value(self, k: int, u: float) -> tuple[float, float]:
        """s and the vertical s_v at phase u of segment k."""
        block = self.at(k)
        i = k - block.first
        share = u / block.length[i]
        if self.straight:
            return block.start[i] + block.rise[i] * share, block.up[i] + block.up_rise[i] * share if block.up else 0.0
        waves = self.waves(k)
        return block.start[i] + waves[0].change(u), block.up[i] + waves[1].change(u) if block.up else 0.0
