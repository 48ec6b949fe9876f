"""Segments: a motion cut at the extremes of s, as arrays; s is monotone
on a segment.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from .blocks import largest
from .sinusoids import PolynomialTable, table_of


@dataclass(frozen=True)
class RisingWave:
    """Segments with a single sinusoid in rising form: sign (s - offset) = radius
    sin(angle + w u), u the phase from the start [rad].
    """

    sign: np.ndarray  # +1 where s rises, -1 where it falls
    offset: np.ndarray  # constant part of s [-]
    radius2: np.ndarray  # radius squared, radius: the amplitude of the sinusoid [-]
    angle: np.ndarray  # angle of the sinusoid at the start [rad]


@dataclass(frozen=True)
class Segments:
    """The K monotone segments of a motion."""

    start: np.ndarray  # phase at the start [rad], (K,)
    length: np.ndarray  # [rad], (K,)
    s_start: np.ndarray  # s at the start, inside the segment [-], (K,)
    s_end: np.ndarray  # s at the end, inside the segment [-], (K,)
    # sine of each sinusoid at the start, times its amplitude [-], (harmonics, K)
    sin: np.ndarray
    # cosine of each sinusoid at the start, times its amplitude [-], (harmonics, K)
    cos: np.ndarray
    frequency: np.ndarray  # frequency of each sinusoid over omega_g [-], (harmonics, K)
    slope: np.ndarray  # slope of the linear term [1/rad], (K,)
    joins: np.ndarray  # True if the next segment is of the same piece, (K,)
    # largest s from the segment on, 0 for the ground at rest [-], (K,)
    later_max: np.ndarray
    # least s from the segment on, 0 for the ground at rest [-], (K,)
    later_min: np.ndarray

    def __len__(self) -> int:
        return int(self.start.size)

    @property
    def harmonics(self) -> int:
        """The largest number of sinusoids of a piece."""
        return int(self.sin.shape[0])

    @cached_property
    def sloped(self) -> bool:
        """True if a piece has a term linear in the phase."""
        return bool(np.any(self.slope != 0.0))

    @property
    def straight(self) -> bool:
        """True if every piece is a straight line."""
        return not self.harmonics

    def last_line(self, first: np.ndarray) -> np.ndarray:
        """Return the last segment of the motions that begin with these segments."""
        return np.full(first.shape, len(self) - 1)

    @cached_property
    def of_samples(self) -> bool:
        """True for straight lines at equal steps, one after the other without a jump,
        under a constant weight.
        """
        if not self.straight or self.weighed is not None or len(self) < 2:
            return False
        return self._equal_lines(slice(None))

    def _equal_lines(self, which: slice) -> bool:
        length, start, end = (x[which] for x in (self.length, self.s_start, self.s_end))
        equal = np.abs(length - length[0]) <= 1e-9 * length[0]
        apart = np.abs(start[1:] - end[:-1])
        return bool(equal.all() and np.all(apart <= 1e-12 * self.largest))

    @property
    def weighed(self) -> Any:
        """The segments of a motion under which the weight varies
        (`dynamics.weighed_drive`); None where it is constant.
        """
        return None

    def weight(
        self, _side: np.ndarray, _amplitude: np.ndarray, _k: np.ndarray, _u: np.ndarray
    ) -> np.ndarray | float:
        """Return the weight over m g at phase u of segment k, 1 under a motion without
        a vertical part.
        """
        return 1.0

    def force_at_impact(
        self,
        _side: np.ndarray,
        _amplitude: np.ndarray,
        _k: np.ndarray,
        _u: np.ndarray,
        b: np.ndarray,
    ) -> np.ndarray:
        """Return the force on bodies at theta = 0; b: the same force for a constant
        weight.
        """
        return b

    @cached_property
    def _pieces(self) -> tuple[np.ndarray, np.ndarray]:
        """(phase from the end of each segment to the end of its piece [rad], index of
        the first segment after the piece), (K,) each; a piece is a closed form of s.
        """
        last = np.flatnonzero(~self.joins)
        if not last.size or last[-1] != len(self) - 1:
            last = np.append(last, len(self) - 1)
        end = last[np.searchsorted(last, np.arange(len(self)))]
        behind = np.zeros(len(self))
        for k in range(len(self) - 2, -1, -1) if self.joins.any() else ():
            if end[k] > k:
                behind[k] = self.length[k + 1] + behind[k + 1]
        return behind, end + 1

    def left_of_piece(self, k: np.ndarray, u: np.ndarray) -> np.ndarray:
        """Return the phase [rad] from u in segment k to the end of its piece."""
        return self.length[k] - u + self._pieces[0][k]

    def after_piece(self, k: np.ndarray) -> np.ndarray:
        """Return the first segment after the piece of segment k."""
        return self._pieces[1][k]

    def ended(self, k: np.ndarray) -> np.ndarray:
        """True where the motion is over at the start of segment k."""
        return k >= len(self)

    def strongest_inward(
        self, side: np.ndarray, amplitude: np.ndarray, k: np.ndarray
    ) -> np.ndarray:
        """Return the strongest inward drive from segment k on, over the least weight
        from there on; infinite if that is not positive.
        """
        return amplitude * np.where(side > 0.0, self.later_max[k], -self.later_min[k])

    def followed_by_rest(self, length: float) -> "Segments":
        """Return the same motion, then the ground at rest for a phase of this length
        [rad].
        """
        end = self.start[-1] + self.length[-1]
        lasts = {"start": end, "length": length, "frequency": 1.0, "joins": False}
        return Segments(
            **{
                f.name: followed_by(getattr(self, f.name), lasts.get(f.name, 0.0))
                for f in fields(Segments)
            }
        )

    @cached_property
    def _blocks(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(largest s, largest -s, first index of each level j) over blocks of 2^j
        segments, up to a single block.
        """
        found, levels = [], list[np.ndarray]()
        for values in (
            np.maximum(self.s_start, self.s_end),
            np.maximum(-self.s_start, -self.s_end),
        ):
            levels = [values]
            while levels[-1].size > 1:
                levels.append(
                    np.maximum.reduceat(levels[-1], np.arange(0, levels[-1].size, 2))
                )
            found.append(np.concatenate(levels))
        return found[0], found[1], np.cumsum([0, *map(len, levels)])

    def next_beyond(
        self, k: np.ndarray, above: np.ndarray, below: np.ndarray
    ) -> np.ndarray:
        """Return the first segment from k on with s > above or -s > below; K if there
        is none; shape of k.
        """
        high, low, start = self._blocks
        found = np.full(k.shape, len(self))
        lanes = np.flatnonzero(k < len(self))
        at = k[lanes]
        above = above[lanes]
        below = below[lanes]
        level = np.zeros(lanes.size, dtype=np.int64)
        # to larger blocks while no value is large, then down into the first block with
        # a large value
        while lanes.size:
            block = start[level] + (at >> level)
            loud = (high[block] > above) | (low[block] > below)
            over = ((at >> level) + 1) << level
            level = np.where(
                loud,
                level - 1,
                np.where(
                    (over >> level) & 1, level, np.minimum(level + 1, start.size - 2)
                ),
            )
            at = np.where(loud, at, over)
            done = (level < 0) | (at >= len(self))
            if done.any():
                here = level < 0
                found[lanes[here]] = at[here]
                going = ~done
                lanes = lanes[going]
                at = at[going]
                above = above[going]
                below = below[going]
                level = level[going]
        return found

    @cached_property
    def wave(self) -> RisingWave:
        """The sinusoids of the segments; only for a motion with one harmonic and no
        slope.
        """
        s, c = self.sin[0], self.cos[0]
        sign = np.where(self.s_end > self.s_start, 1.0, -1.0)
        return RisingWave(
            sign, self.s_start - s, s * s + c * c, np.arctan2(sign * s, sign * c)
        )

    @cached_property
    def table(self) -> PolynomialTable | None:
        """The segments as polynomials; None if the motion has at most one sinusoid and
        no slope, or if the table is too large.
        """
        if self.harmonics == 0 or (self.harmonics == 1 and not self.sloped):
            return None
        return table_of(self)

    @cached_property
    def comb(self) -> np.ndarray | None:
        """The frequencies of three sinusoids or more that are the same in all pieces,
        and multiples of the first; otherwise None.
        """
        w = self.frequency[:, 0]
        n = np.arange(1.0, w.size + 1.0)
        if w.size < 3 or not np.all(self.frequency == w[:, None]):
            return None
        return w if np.all(np.abs(w - n * w[0]) <= 1e-15 * w) else None

    @cached_property
    def largest(self) -> float:
        """max |s| over the ends of the segments."""
        return max(largest(self.s_start), largest(self.s_end))

    @cached_property
    def sign_changes(self) -> int:
        """The number of sign changes of s."""
        signs = np.sign(np.column_stack([self.s_start, self.s_end]).ravel())
        signs = signs[signs != 0.0]
        return int(np.count_nonzero(signs[1:] != signs[:-1]))

    @cached_property
    def steepest(self) -> tuple[float, float]:
        """Bounds of |ds/dphase| [1/rad] and |d2s/dphase2| [1/rad2]."""
        size, w = np.hypot(self.sin, self.cos), self.frequency
        return float(((size * w).sum(axis=0) + np.abs(self.slope)).max()), float(
            (size * w * w).sum(axis=0).max()
        )


@dataclass(frozen=True)
class Chain(Segments):
    """The segments of several motions behind one another, each followed by still ground
    without an end.
    """

    first: np.ndarray  # index of the first segment of each motion, (motions,)

    @classmethod
    def of(cls, motions: Sequence[Segments]) -> "Chain":
        """Return the chain of these motions."""
        rested = [one.followed_by_rest(np.inf) for one in motions]
        columns = {
            f.name: np.concatenate([getattr(one, f.name) for one in rested], axis=-1)
            for f in fields(Segments)
        }
        return cls(**columns, first=np.cumsum([0, *map(len, rested[:-1])]))

    def last_line(self, first: np.ndarray) -> np.ndarray:
        """Return the last line of the motions that begin with these segments, before
        the still ground.
        """
        return np.asarray(self._ground_after[first] - 1)

    @cached_property
    def of_samples(self) -> bool:
        """True if every motion consists of straight lines at equal steps."""
        ends = [*self.first[1:].tolist(), len(self)]
        return self.straight and all(
            self._equal_lines(slice(a, b - 1))
            for a, b in zip(self.first.tolist(), ends, strict=True)
        )

    @cached_property
    def _ground_after(self) -> np.ndarray:
        """Index of the segment of still ground that follows the motion to which a
        segment belongs, (K + 1,); 0 for the index K, which is beyond all motions.
        """
        return np.append(
            np.repeat(
                np.append(self.first[1:], len(self)) - 1,
                np.diff(self.first, append=len(self)),
            ),
            0,
        )

    def ended(self, k: np.ndarray) -> np.ndarray:
        """True also on the still ground between two motions."""
        return np.asarray(k >= self._ground_after.take(k))

    def next_beyond(
        self, k: np.ndarray, above: np.ndarray, below: np.ndarray
    ) -> np.ndarray:
        """Return the first such segment within the motion of segment k, as
        `Segments.next_beyond` does.
        """
        found = super().next_beyond(k, above, below)
        return np.where(found < self._ground_after.take(k), found, len(self))


class Samples(NamedTuple):
    """Straight lines over equal steps."""

    step: float  # length of a step [rad]
    values: np.ndarray  # s at the ends of the steps [-], (steps + 1,)


def largest_from(values: np.ndarray) -> np.ndarray:
    """Return the largest value from each index on, at least 0."""
    return np.maximum(0.0, np.maximum.accumulate(values[::-1])[::-1])


def followed_by(values: np.ndarray, last: float | bool) -> np.ndarray:
    """Return the array with one more value at the end of its last axis."""
    return np.concatenate(
        [values, np.full((*values.shape[:-1], 1), last, dtype=values.dtype)], axis=-1
    )
