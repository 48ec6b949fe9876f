"""The lowest amplitudes at which bodies fall, where falls may be narrow: under records,
or a pulse of several cycles.

An approximate scan tells where a body seems to fall, and the march decides. Searches
run side by side: each yields the amplitudes of which it will ask the scan, and those of
all are scanned together. No number of a search depends on the others.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING, Self

import numpy as np

from ..arrays import Array
from ..dynamics.outcome import safe
from ..dynamics.response import cheaper, response
from ..dynamics.system import System
from ..motions import Motion
from .amplitudes import COARSE, LONGEST_FINE
from .changes import Brackets, narrowed

if TYPE_CHECKING:
    from .scan import Scan

# A search: it yields amplitudes for the scan and returns the lowest fall, infinite
# without one.
Asking = Generator[Array, None, float]

# ratio of neighbouring amplitudes, minus 1, in the tenth below a known fall
_FINE = 6e-5
# The same under a pulse with narrow falls, and where this search starts, over the fall.
_FINEST = 5e-6
_NEAREST = 0.997
_NEAR = 0.9  # start of the fine search, over the lowest fall
_ABOVE = 1.05  # end of the count of falls, over the lowest fall
# number of amplitudes on either side of an approximate fall at which the march looks
# for it
_NEIGHBOURS = 2
# number of amplitudes that the march computes, below a fall and around an approximate
# one
_CHECKED = 5
# amplitudes of one body for which the march on floats takes as long as a scan
_FEW = 30
# amplitudes of the first stretch of a search by the march: fewer take as long, and
# those above a fall end soon
_STRETCH = 1000


@dataclass
class FallSearch:
    """The searches for the lowest amplitudes at which one body falls, where falls may
    be narrow.
    """

    # function that returns True for amplitudes at which the body falls, by the march
    falls: Callable[[Array], Array]
    # the same question for many amplitudes, perhaps approximate: it tells where to look
    approximate_falls: Callable[[Array], Array]
    digits: float  # relative width of a traced boundary [-]
    scan: Scan | None = None  # the approximate scan, None without one
    # True if `approximate_falls` is the march (bodies with restraints)
    by_march: bool = False
    # True for amplitudes at which the body seems to fall, as far as they were asked
    known: dict[float, bool] = field(default_factory=dict)

    @classmethod
    def of(cls, system: System, motion: Motion, omega: float, digits: float) -> Self:
        """Set up the searches for overturning amplitudes of one body at one Omega."""

        def by_march(amplitude: Array, how: str) -> Array:
            found = response(system, motion, amplitude, omega, peaks=False, how=how)
            return ~safe(found.outcome)

        def falls(amplitude: Array) -> Array:
            return by_march(amplitude, "floats")

        def approximate_falls(amplitude: Array) -> Array:
            if scan is None:
                return by_march(amplitude, "arrays")
            if amplitude.size <= _FEW:
                return falls(amplitude)
            fallen, doubtful = scan.falls(amplitude)
            if doubtful.any():
                again = amplitude[doubtful]
                fallen[doubtful] = by_march(again, cheaper(system, motion, again.size))
            return fallen

        scan = None
        if len(motion.segments) > LONGEST_FINE:
            from .scan import Scan

            scan = (
                Scan(system, motion, omega) if Scan.supports(system, motion) else None
            )
        return cls(falls, approximate_falls, digits, scan, system.devices is not None)

    def seems_to_fall(self, amplitude: Array) -> Array:
        """True for amplitudes at which the body seems to fall."""
        new = np.array([a for a in amplitude.tolist() if a not in self.known])
        if new.size:
            falls = self.approximate_falls(new)
            self.known.update(zip(new.tolist(), falls.tolist(), strict=True))
        return np.array([self.known[a] for a in amplitude.tolist()])

    def first(self, begin: float, end: float) -> Asking:
        """Search the lowest amplitude from `begin` to `end` at which the body falls."""
        if not begin < end:
            return math.inf
        coarse = amplitudes(begin, end, COARSE)
        yield np.append(coarse, amplitudes(end, _ABOVE * end, COARSE))
        low, stretch, found = 0, _STRETCH, math.inf
        while math.isinf(found) and low < coarse.size:
            # Coarse amplitudes tell where to look, stretch by stretch from below: with
            # a scan up to 5 % above the first fall that it sees.
            high = low + stretch
            if self.scan is not None:
                seen = coarse[low:][self.scan.falls(coarse[low:])[0]]
                above = _ABOVE * seen.min(initial=end)
                high = int(coarse.searchsorted(above, side="right"))
            some = coarse[low:high]
            for fall in some[self.seems_to_fall(some)].tolist():
                found = yield from self.lowest(begin, fall)
                if math.isfinite(found):
                    break
            low, stretch = high, 2 * stretch
        while not self.by_march:  # the march computes a few amplitudes below the fall
            checked = np.geomspace(begin, min(found, end), _CHECKED + 2)[1:-1]
            if not (missed := checked[self.falls(checked)]).size:
                break
            found = yield from self.lowest(begin, float(missed[0]))
        return found

    def lowest(
        self, begin: float, seen: float, ratio: float = _FINE, near: float = _NEAR
    ) -> Asking:
        """Search the lowest fall from `begin` to the amplitude `seen`, at which the
        body seems to fall: in a window of amplitudes at this ratio below `seen`, from
        near^2 times it on (if the march has seen it, from just below near times it),
        and then in windows below each fall that the march finds, from near times the
        fall on.
        """
        first = near * (1.0 - 2.0 * COARSE if self.by_march else near)
        low, high, lowest = max(begin, first * seen), seen, math.inf
        while low < high:
            # Runs of neighbouring falls, from below. At first `seen` counts as one.
            amplitude = amplitudes(low, high, ratio)
            if amplitude.size > _FEW:
                yield amplitude
            falling = self.seems_to_fall(amplitude)
            falling[-1] |= math.isinf(lowest)
            at = np.flatnonzero(falling)
            runs = np.split(at, np.flatnonzero(np.diff(at) > 1) + 1) if at.size else []
            confirmed = (self._confirmed(amplitude, run) for run in runs)
            new = next(filter(math.isfinite, confirmed), math.inf)
            if math.isinf(new):
                break
            lowest, low, high = new, max(begin, near * new), low
        return lowest

    def _confirmed(self, amplitude: Array, run: Array) -> float:
        """The lower end of a fall that the march finds at or near a run of these
        amplitudes, infinite if it finds none.
        """
        at, below = int(run[0]), int(run[0]) - 1
        if not self.by_march:
            # The scan is approximate: the march tries the neighbours below the run,
            # then some of the run and above it.
            first = np.arange(max(0, at - _NEIGHBOURS), at + 1)
            rest = np.arange(at + 1, min(amplitude.size, run[-1] + _NEIGHBOURS + 1))
            for some in (first, rest[:: max(1, rest.size // _CHECKED)]):
                fallen = some[self.falls(amplitude[some])]
                if fallen.size:
                    break
            else:
                return math.inf
            # Down from this fall by steps that double, to one at which it stands.
            at, step = int(fallen[0]), 1
            while at and self.falls(amplitude[[below := max(0, at - step)]])[0]:
                at, step = below, 2 * step
        if not at:
            return float(amplitude[0])
        return self._narrowed(float(amplitude[below]), float(amplitude[at]))

    def lowest_and_share(self, begin: float, fall: float) -> tuple[float, float]:
        """(the lowest fall from `begin` to the known one `fall`, `share_of_falls` above
        it). If this share is not 0, it finds intervals 5e-6 of the amplitude wide.
        """
        first = min(fall, *side_by_side([(self, self.lowest(begin, fall))]))
        share_of_falls = self.share_of_falls(first)
        if share_of_falls:
            closer = self.lowest(begin, first, _FINEST, _NEAREST)
            first = min(first, *side_by_side([(self, closer)]))
        return first, share_of_falls

    def _narrowed(self, low: float, high: float) -> float:
        """The boundary between `low`, at which the body stands, and `high`, at which it
        falls, to the relative width `digits`.
        """
        bracket = Brackets(*(np.array([x]) for x in (0, low, high, False, True)))
        found = narrowed(
            lambda amplitude, row: self.falls(amplitude.ravel())[None],
            bracket,
            self.digits,
            2,
            lowest=True,
        )
        return float(found.high[0])

    def share_of_falls(self, first: float) -> float:
        """The share of overturning amplitudes, 0 to 1, from the first to 5 % above it,
        by a scan in steps of `COARSE`; 0 if they are one interval.
        """
        above = amplitudes(first, _ABOVE * first, COARSE)[1:-1]
        falls = self.seems_to_fall(above).tolist()
        single = sum(one != other for one, other in pairwise([True, *falls])) <= 1
        return 0.0 if single else sum(falls) / len(falls)


def amplitudes(low: float, high: float, ratio: float) -> Array:
    """Amplitudes from `low` to `high` at this ratio; those inside do not depend on
    `low` and `high`.
    """
    powers = np.arange(
        np.ceil(np.log(low) / np.log1p(ratio)), np.log(high) / np.log1p(ratio)
    )
    return np.unique(
        np.concatenate([[low, high], np.clip((1.0 + ratio) ** powers, low, high)])
    )


def side_by_side(
    searches: Sequence[tuple[FallSearch, Asking]],
    tell: Callable[[float], None] = lambda _: None,
) -> list[float]:
    """Return what each search finds. The amplitudes for which they wait are scanned
    together. tell: called with about the share that is done: nobody knows how many
    scans the searches take.
    """
    found, left = [math.inf] * len(searches), 1.0

    def kept(i: int, search: Asking) -> Generator[Array]:
        found[i] = yield from search

    def told(share: float) -> None:
        tell(1.0 - left * (1.0 - 0.5 * share))

    going = [(kept(i, one), falls.scan) for i, (falls, one) in enumerate(searches)]
    while going:
        waiting = [(next(one, None), one, scan) for one, scan in going]
        going = [(one, scan) for asked, one, scan in waiting if asked is not None]
        wanted: dict[Scan, Array] = {}
        for asked, _, scan in waiting:
            if asked is not None and scan is not None:
                wanted[scan] = np.append(wanted.get(scan, ()), asked)
        if wanted:
            from .scan import follow

            follow(list(wanted), list(wanted.values()), told)
        left *= 0.5
        tell(1.0 - left)
    return found
