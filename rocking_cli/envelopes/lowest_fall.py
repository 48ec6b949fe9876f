"""The lowest amplitude at which one body falls, where falls may be narrow: under a
record, or a pulse of several cycles.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
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
    """The search for the lowest amplitude at which one body falls, where falls may be
    narrow.
    """

    # function that returns True for amplitudes at which the body falls, by the march
    falls: Callable[[Array], Array]
    # the same question for many amplitudes, perhaps approximate: it tells where to look
    approximate_falls: Callable[[Array], Array]
    digits: float  # relative width of a traced boundary [-]
    scan: Scan | None = None  # the approximate scan, None without one
    # True if `approximate_falls` is the march (bodies with restraints)
    by_march: bool = False
    # (amplitudes A `COARSE` apart that were computed [-], True where the body seems to
    # fall), (amplitudes,) each
    computed: tuple[Array, Array] = field(
        default_factory=lambda: (np.zeros(0), np.zeros(0, dtype=bool))
    )

    @classmethod
    def of(cls, system: System, motion: Motion, omega: float, digits: float) -> Self:
        """Set up the search for the lowest overturning amplitude of one body at one
        Omega.
        """

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

    def first(self, begin: float, end: float) -> float | None:
        """The lowest amplitude from `begin` to `end` at which the body falls, None if
        there is none.
        """
        low, stretch, found = begin, _STRETCH, None
        while found is None and low < end:
            # Coarse amplitudes tell where to look, stretch by stretch from below.
            high = self._stretch_end(low, end, stretch)
            amplitude, falling = self._coarse(low, high)
            found = next(
                filter(
                    None,
                    (self.lowest(begin, fall) for fall in amplitude[falling].tolist()),
                ),
                None,
            )
            low, stretch = high, 2 * stretch
        while not self.by_march:  # the march computes a few amplitudes below the fall
            checked = np.geomspace(begin, found or end, _CHECKED + 2)[1:-1]
            if not (missed := checked[self.falls(checked)]).size:
                break
            found = self.lowest(begin, float(missed[0]))
        return found

    def _stretch_end(self, low: float, end: float, stretch: int) -> float:
        """The end of a stretch of amplitudes that is searched at once: of so many
        amplitudes, or up to 5 % above the first fall that the scan knows.
        """
        if self.scan is None:
            return min(end, low * (1.0 + COARSE) ** stretch)
        fall = self.scan.first_fall(low, end)
        if fall is None:
            return end
        known = self.scan.known.amplitude
        after = known[(low < known) & (known <= min(end, _ABOVE * fall))]
        return float(after[-1]) if after.size else end

    def _coarse(self, low: float, high: float) -> tuple[Array, Array]:
        """(amplitudes `COARSE` apart between these, True where the body seems to fall);
        each amplitude is computed once.
        """
        amplitude = _scan_amplitudes(low, high, COARSE)
        self._compute(amplitude)
        return amplitude, self.computed[1][np.searchsorted(self.computed[0], amplitude)]

    def _compute(self, amplitude: Array) -> None:
        """Add those of these amplitudes to `computed` that are new."""
        new = np.setdiff1d(amplitude, self.computed[0], assume_unique=True)
        if new.size:
            every, order = np.unique(
                np.append(self.computed[0], new), return_index=True
            )
            self.computed = (
                every,
                np.append(self.computed[1], self.approximate_falls(new))[order],
            )

    def lowest(
        self, begin: float, seen: float, ratio: float = _FINE, near: float = _NEAR
    ) -> float | None:
        """The lowest fall from `begin` to the amplitude `seen`, at which a body seems
        to fall; None if the march finds none. It searches a window of amplitudes at
        this ratio below `seen`, from near^2 times it on (if the march has seen it, from
        just below near times it), and then windows below each fall that it finds, from
        near times the fall on.
        """
        first = near * (1.0 - 2.0 * COARSE if self.by_march else near)
        low, high, lowest = max(begin, first * seen), seen, None
        while low < high:
            # Runs of neighbouring falls, from below. At first `seen` counts as one.
            amplitude = _scan_amplitudes(low, high, ratio)
            falling = self.approximate_falls(amplitude)
            falling[-1] |= lowest is None
            at = np.flatnonzero(falling)
            runs = np.split(at, np.flatnonzero(np.diff(at) > 1) + 1) if at.size else []
            new = next(
                filter(None, (self._confirmed(amplitude, run) for run in runs)), None
            )
            if new is None:
                break
            lowest, low, high = new, max(begin, near * new), low
        return lowest

    def _confirmed(self, amplitude: Array, run: Array) -> float | None:
        """The lower end of a fall that the march finds at or near a run of these
        amplitudes, None if it finds none.
        """
        if self.by_march:
            at = int(run[0])
            return (
                self.narrowed(float(amplitude[at - 1]), float(amplitude[at]))
                if at
                else float(amplitude[0])
            )
        # The scan is approximate: the march tries the neighbours below the run, then
        # some of the run and above it.
        first = np.arange(max(0, run[0] - _NEIGHBOURS), run[0] + 1)
        fallen = first[self.falls(amplitude[first])]
        if not fallen.size:
            rest = np.arange(run[0] + 1, min(amplitude.size, run[-1] + _NEIGHBOURS + 1))
            rest = rest[:: max(1, rest.size // _CHECKED)]
            fallen = rest[self.falls(amplitude[rest])]
        if not fallen.size:
            return None
        # Down from this fall by steps that double, to an amplitude at which it stands.
        at, step = int(fallen[0]), 1
        while at and self.falls(amplitude[(below := max(0, at - step)) : below + 1])[0]:
            at, step = below, 2 * step
        return (
            self.narrowed(float(amplitude[below]), float(amplitude[at]))
            if at
            else float(amplitude[0])
        )

    def lowest_and_share(self, begin: float, fall: float) -> tuple[float, float]:
        """(the lowest fall from `begin` to the known one `fall`, `share_of_falls` above
        it). If this share is not 0, it finds intervals 5e-6 of the amplitude wide.
        """
        first = self.lowest(begin, fall) or fall
        share_of_falls = self.share_of_falls(first)
        return (
            self.lowest(begin, first, _FINEST, _NEAREST) or first
            if share_of_falls
            else first
        ), share_of_falls

    def narrowed(self, low: float, high: float) -> float:
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
        self._compute(_scan_amplitudes(first, _ABOVE * first, COARSE)[1:-1])
        falls = self.computed[1][
            (first < self.computed[0]) & (self.computed[0] < _ABOVE * first)
        ].tolist()
        single = sum(one != other for one, other in pairwise([True, *falls])) <= 1
        return 0.0 if single else sum(falls) / len(falls)


def _scan_amplitudes(low: float, high: float, ratio: float) -> Array:
    """Amplitudes from `low` to `high` at this ratio; those inside do not depend on
    `low` and `high`.
    """
    powers = np.arange(
        np.ceil(np.log(low) / np.log1p(ratio)), np.log(high) / np.log1p(ratio)
    )
    return np.unique(
        np.concatenate([[low, high], np.clip((1.0 + ratio) ** powers, low, high)])
    )


def scan_together(
    asked: Sequence[tuple[FallSearch, float, float, float]],
    progress: Callable[[float], None],
) -> None:
    """Scan together the amplitudes that several searches will need; asked: (search,
    least amplitude, demand, largest amplitude) of each; progress: called now and then
    with the share that is done.
    """
    from .scan import follow

    scanned = [
        (falls.scan, lowest, demand, top)
        for falls, lowest, demand, top in asked
        if falls.scan is not None
    ]
    scans = [scan for scan, *_ in scanned]
    follow(
        scans,
        [
            np.append(_scan_amplitudes(lowest, top, COARSE), demand)
            for _, lowest, demand, top in scanned
        ],
        lambda share: progress(0.5 * share),
    )
    follow(
        scans,
        [_fine_amplitudes(*one) for one in scanned],
        lambda share: progress(0.5 + 0.5 * share),
    )


def _fine_amplitudes(scan: Scan, lowest: float, demand: float, top: float) -> Array:
    """The amplitudes below the lowest falls on either side of the demand; if the body
    falls under the demand, below it only.
    """
    below = _below(scan, lowest, demand)
    falls, _ = scan.falls(np.array([demand]))
    if falls[0]:
        return below
    return np.unique(np.append(below, _below(scan, demand, top)))


def _below(scan: Scan, begin: float, end: float) -> Array:
    """The amplitudes that `FallSearch.lowest` will search below the lowest fall from
    `begin` to `end` that a scan knows.
    """
    fall = scan.first_fall(begin, end)
    if fall is None:
        return np.zeros(0)
    return _scan_amplitudes(max(begin, _NEAR * _NEAR * fall), fall, _FINE)
