"""The drive of a body on ground that moves sideways and vertically, so that its weight
over m g, w, varies.

With a the outward drive over its value at uplift and w = 1 + zg''/g the weight over m
g, the force on a side is f = -w l(y) + a m(y). At the ground f = c - 1, with the *net
drive* c = a + 1 - w: c = -A (s + r s_v) on the right edge, A (s - r s_v) on the left,
where s_v is the vertical motion and r the zg''/g of A = 1 on the edge. So each edge has
an effective motion; segments are monotone in both.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import lru_cache
from typing import Any, Self

import numpy as np

from ..arrays import Array
from ..motions.biaxial import combined
from ..motions.motion import Motion, extremes
from ..motions.polyline import Polyline
from ..motions.segments import Segments, followed_by
from .drive import drive_change, inside_piece

_ALIKE = 1e-9  # over the length of a piece: extremes this close count as one
# segments, of 400 bytes each: of motions with more, the cache keeps only the last one
_LONG = 1 << 16


@dataclass(frozen=True)
class WeighedSegments(Segments):
    """The segments of the horizontal motion s, cut so that s_v and both effective
    motions are monotone too. Here `later_max` is that of the left effective motion,
    `later_min` that of the right.
    """

    vertical: Segments  # the vertical motion s_v
    right: Segments  # the effective motion of the right edge
    left: Segments  # the effective motion of the left edge
    # the effective motions one after the other, first the right, then the left
    edges: Segments
    # (later_max, later_min) of the horizontal motion [-], (segments + 1,) each
    inward: tuple[Any, Any]
    share: tuple[float, float]  # r of the right and of the left edge [-]

    @property
    def straight(self) -> bool:
        """True if both motions are straight lines."""
        return self.edges.straight

    @property
    def weighed(self) -> Self:
        """Return this object; plain `Segments` return None."""
        return self

    def offset(self, side: Array) -> Array:
        """Index in `edges` of the first segment of this side."""
        return np.where(side > 0.0, 0, len(self)).astype(np.int64)

    def sway(self, side: Array, amplitude: Array) -> Array:
        """The zg''/g of s_v = 1, for lanes of this side and amplitude."""
        right, left = self.share
        return (
            right if right == left else np.where(side > 0.0, right, left)
        ) * amplitude

    def weight(self, side: Array, amplitude: Array, k: Array, u: Array) -> Array:
        """The weight over m g, w, at phase u of segment k; u may go on to the end of
        the piece.
        """
        here = inside_piece(self, k, u)
        return 1.0 + self.sway(side, amplitude) * _value(self.vertical, *here)

    def net(self, side: Array, amplitude: Array, k: Array, u: Array) -> Array:
        """The net drive c at phase u of segment k, on this side; 0 after the motion."""
        within = k < len(self)
        own = np.where(within, k, len(self) - 1) + self.offset(side)
        return np.where(within, -side * amplitude * _value(self.edges, own, u), 0.0)

    def force_at_impact(
        self, side: Array, amplitude: Array, k: Array, u: Array, _b: Array
    ) -> Array:
        """The force on a body at the ground, c - 1, on this side."""
        return self.net(side, amplitude, k, u) - 1.0

    def least_weight(self, side: Array, amplitude: Array, k: Array) -> Array:
        """The least weight over m g from segment k on."""
        sway, at = self.sway(side, amplitude), np.minimum(k, len(self) - 1)
        return 1.0 + np.minimum(
            sway * self.vertical.later_min[at], sway * self.vertical.later_max[at]
        )

    def strongest_inward(self, side: Array, amplitude: Array, k: Array) -> Array:
        """The strongest inward drive over the least w, from segment k on; infinite
        where the least w is not positive.
        """
        weight = self.least_weight(side, amplitude, k)
        inward = amplitude * np.where(side > 0.0, self.inward[0][k], -self.inward[1][k])
        return np.where(weight > 0.0, inward / weight, np.inf)

    def followed_by_rest(self, length: float) -> "WeighedSegments":
        """The same motion, followed by still ground for a phase of
        this length [rad].
        """
        parts = [
            super().followed_by_rest(length),
            *(
                x.followed_by_rest(length)
                for x in (self.vertical, self.right, self.left)
            ),
        ]
        return _weighed(
            parts,
            (followed_by(self.inward[0], 0.0), followed_by(self.inward[1], 0.0)),
            self.share,
        )


def _value(segments: Segments, k: Array, u: Array) -> Array:
    """s at phase u of segment k, of the last segment if k is beyond it."""
    k = np.minimum(k, len(segments) - 1)
    return segments.s_start[k] + drive_change(segments, k, u)


def weighed(motion: Motion, right: float, left: float) -> Segments:
    """The segments of a motion that has a vertical part, for a body whose edges have
    these values of r.
    """
    return (_last_segments if len(motion.segments) > _LONG else _recent_segments)(
        motion, right, left
    )


def _cut_segments(motion: Motion, right: float, left: float) -> Segments:
    """Return the segments of a motion with a vertical part, cut where the vertical
    motion or an effective motion has an extreme. right, left: zg''/g over the outward
    drive of A = 1 on each edge.
    """
    assert motion.vertical is not None
    signals = (
        motion,
        motion.vertical,
        combined(motion, right),
        combined(motion, -left),
    )
    if all(isinstance(signal, Polyline) for signal in signals):
        parts = [signal.segments for signal in signals]
    else:
        inner = [
            _distinct(
                sorted(x for piece in pieces for x in extremes(piece)),
                pieces[0].stop - pieces[0].start,
            )
            for pieces in zip(*(signal.pieces for signal in signals[1:]), strict=True)
        ]
        parts = [signal.cut(inner) for signal in signals]
    own = motion.segments  # its extremes lie between the common cuts
    at = np.maximum(np.searchsorted(own.start, parts[0].start, side="right") - 1, 0)
    return _weighed(parts, (own.later_max[at], own.later_min[at]), (right, left))


_last_segments = lru_cache(maxsize=1)(_cut_segments)
_recent_segments = lru_cache(maxsize=64)(_cut_segments)


def _distinct(instants: list[float], length: float) -> list[float]:
    """Return rising instants of a piece of this length without those that count as one
    with the instant before them.
    """
    kept: list[float] = []
    for x in instants:
        if not kept or x - kept[-1] > _ALIKE * length:
            kept.append(x)
    return kept


def _weighed(
    parts: Sequence[Segments], inward: tuple[Any, Any], share: tuple[float, float]
) -> WeighedSegments:
    """parts: segments of the horizontal, the vertical and the effective motions at the
    right and the left edge, on common cuts.
    """
    across = parts[0]
    vertical, right, left = (replace(part, length=across.length) for part in parts[1:])
    own = {f.name: getattr(across, f.name) for f in fields(Segments)}
    own |= {"later_max": left.later_max, "later_min": right.later_min}
    both = {
        f.name: _joined(getattr(right, f.name), getattr(left, f.name))
        for f in fields(Segments)
    }
    return WeighedSegments(
        **own,
        vertical=vertical,
        right=right,
        left=left,
        edges=Segments(**both),
        inward=inward,
        share=share,
    )


def _joined(a: Any, b: Any) -> Any:
    """Two arrays over segments, one after the other; sinusoids that one of them lacks
    are 0.
    """
    if a.ndim == 2:
        rows = max(len(a), len(b))
        a, b = (np.pad(x, ((0, rows - len(x)), (0, 0))) for x in (a, b))
    return np.concatenate([a, b], axis=-1)
