"""Capacity: the lowest amplitude that overturns one body, and the end of the safe interval around a demand.

The boundaries are traced as in an envelope, but the search stops when both answers are known. The demand is one of the amplitudes of
the search, so the answers agree with the response at the demand.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple, Self

import numpy as np

from ..dynamics.march.closings import FEW
from ..dynamics.method import Method
from ..dynamics.outcome import Outcome, safe
from ..dynamics.response import response
from ..dynamics.single.response import response_alone
from ..dynamics.system import System
from ..errors import UsageError
from ..motions import Motion
from ..structures.parameters import RockingParameters
from .boundaries import Search
from .changes import Brackets
from .intervals import HIGHEST

if TYPE_CHECKING:
    from ..dynamics.single.scan import Scan

Array = np.ndarray

LONGEST_FINE = 200  # segments of a motion up to which the scan is as fine as an envelope's
RATIO = 5e-3  # ratio of neighbouring amplitudes minus 1 of an envelope beyond that: a cell costs as much as a thousand of a pulse
_COARSE, _FINE = 1e-3, 6e-5  # the same for a search for the lowest fall: everywhere, and in the tenth below a known fall
_TRACED = 1e-6  # of the amplitude: boundaries under a record
_STATED = 1e-4  # of the amplitude: narrower falls may be missed there
_FINEST, _NEAREST = 5e-6, 0.997  # under a pulse with narrow falls: step, and reach of the search below each fall
_NEAR, _ABOVE = 0.9, 1.05  # times the lowest fall: start of the fine search, and end of the count of falls
_FEW = 20  # amplitudes up to which the march is as fast as a scan
_BESIDE = 5  # amplitudes on either side of a fall that seems to be, at which the march looks for it
_CHECKED = 5  # amplitudes that the march looks at, below a fall and around one that seems to be
_STRETCH = 100  # amplitudes of the first stretch of a search by the march
_FIRST_WINDOW = 1.5  # range of A in one batch: so many cells cost about as much as one round
_PARTS = 256  # parts of a bracket in one cut: there are few brackets, and a batch costs the same for any size


@dataclass(frozen=True)
class Capacity:
    """The capacity of a body against a demand; amplitudes A [-].

    first: the lowest amplitude that overturns, None if there is none; safe_to: the end of the safe interval around the demand, None if
    the body falls under the demand or no larger amplitude overturns it; uplift: the lowest amplitude that lifts the body, None if there
    is none. dust: under a record or a pulse of several cycles, the share of amplitudes up to 5 % above `first` that fall, if they form
    more than one interval, otherwise 0.
    """

    first: float | None
    safe_to: float | None
    uplift: float | None
    dust: float = 0.0


class Sought(NamedTuple):
    """A capacity that is asked for: of a structure at Omega [-] against a demand of A = `amplitude` [-], searched up to `a_max` and twice
    the demand."""

    structure: RockingParameters
    motion: Motion
    amplitude: float
    omega: float
    method: Method
    a_max: float

    def ends(self) -> tuple[float, float]:
        """The least and the largest amplitude of the search. Raises UsageError if the largest is above the limit of a scan."""
        top = max(self.a_max, 2.0 * self.amplitude)
        if not top <= HIGHEST:
            raise UsageError(f"{self.structure.name}: found a search up to A = {top:.6g}; expected up to {HIGHEST:g}")
        return self.method.system_of(self.structure).least_uplift(self.motion), top


def searches(sought: Sequence[Sought]) -> list[Falls]:
    """The search for each; what they will look at is scanned together. Raises UsageError as `capacity` does."""
    found, ahead = [], []
    for asked in sought:
        structure, motion, amplitude, omega, method, _ = asked
        narrow = Falls.of(method.system_of(structure), motion, omega, structure.eta, tracing_width(method, motion))
        lowest, top = asked.ends()
        found.append(narrow)
        if narrow.scan is not None and lowest < top:
            ahead.append((narrow.scan, lowest, float(np.clip(amplitude, lowest, top)), top))
    if ahead:
        from ..dynamics.single.scan import follow

        scans = [scan for scan, *_ in ahead]
        follow(scans, [np.append(_ladder(lowest, top, _COARSE), demand) for _, lowest, demand, top in ahead])
        fine = [[_below(scan, lowest, demand), _below(scan, demand, top)] for scan, lowest, demand, top in ahead]
        follow(scans, [np.unique(np.concatenate(parts)) for parts in fine])
    return found


def _below(scan: Scan, begin: float, end: float) -> Array:
    """The amplitudes below the lowest fall between these that a scan knows of, at which `Falls.lowest` will look."""
    fall = scan.known[0][scan.known[1] & (begin <= scan.known[0]) & (scan.known[0] <= end)][:1]
    return _ladder(max(begin, _NEAR * _NEAR * fall[0]), fall[0], _FINE) if fall.size else fall


def capacity(
    structure: RockingParameters,
    motion: Motion,
    amplitude: float,
    omega: float,
    *,
    method: Method,
    a_max: float,
    narrow: Falls | None = None,
) -> Capacity:
    """The capacity of a structure at Omega [-] against a demand of A = `amplitude` [-], searched up to `a_max` and twice the demand.

    narrow: one of `searches`. Intervals narrower than `narrowest` may be missed, but not around the demand. Changes are traced as
    `tracing_width` says. Raises UsageError if `amplitude` or `a_max` is above the limit of a scan.
    """
    asked, system = Sought(structure, motion, amplitude, omega, method, a_max), method.system_of(structure)
    lowest, top = asked.ends()
    if not lowest < top:
        return Capacity(None, None, lowest if np.isfinite(lowest) else None)
    narrow = narrow or searches([asked])[0]
    if _long(motion):
        stands = amplitude <= lowest or not narrow.falls(np.array([amplitude]))[0]
        below = narrow.first(lowest, min(amplitude, top)) if lowest < amplitude else None
        above = narrow.first(max(lowest, amplitude), top) if stands else None
        first = below or (above if stands else narrow.lowest(lowest, amplitude, _FINE, _NEAR))
        return Capacity(first, above, lowest, 0.0 if first is None else narrow.dust(first))
    search = Search(system, motion, structure.eta, top, digits=narrow.digits, parts=_PARTS)
    brackets: list[Brackets] = []  # one window after the other, until the outcome at the demand and the next fall above it are known
    above_demand = False
    for begin, end in _windows(lowest, amplitude, top, at_once=system.equation.bounded):
        fall, last = replace(search, a_min=begin, a_max=end).fall(omega)
        brackets += [fall] if fall.row.size else []
        above_demand = begin >= amplitude and fall.row.size > 0
        if above_demand or (end <= amplitude and not Outcome(last).safe):
            break
    found = search.first_falls_in(omega, Brackets.joined(brackets)) if brackets else []
    first, dust = min(found, default=None), 0.0
    if first is not None and motion.segments.pushes > FEW:
        first, dust = narrow.lowest_narrow(lowest, first)
    safe_to = found[-1] if above_demand else None
    return Capacity(first, safe_to if first is None or safe_to is None or first < amplitude else first, lowest, dust)


def tracing_width(method: Method, motion: Motion) -> float:
    """The relative width to which a boundary is traced: the last digits of an exact method or the tolerance, under a record 1e-6."""
    return max(method.stated_tolerance or 4e-16, _TRACED if _long(motion) else 0.0)


def narrowest(motion: Motion) -> str:
    """The width of intervals that a search may miss, in words."""
    return f"{100.0 * _COARSE:g} % of the amplitude ({100.0 * _STATED:g} % in the tenth below a fall)" if _long(motion) else "0.001 in A"


def _long(motion: Motion) -> bool:
    return len(motion.segments) > LONGEST_FINE


@dataclass
class Falls:
    """The search for the lowest amplitude at which one body falls, where falls may be narrow.

    falls: true for each amplitude that falls, by the march; seems: the same for many amplitudes, where it may be approximate: it tells
    where to look; digits: relative width of a traced boundary; scan: of all amplitudes together, None if there is none; seen: all
    amplitudes `_COARSE` apart so far, with their falls.
    """

    falls: Callable[[Array], Array]
    seems: Callable[[Array], Array]
    digits: float
    scan: Scan | None = None
    seen: tuple[Array, Array] = field(default_factory=lambda: (np.zeros(0), np.zeros(0, dtype=bool)))

    @classmethod
    def of(cls, system: System, motion: Motion, omega: float, eta: float, digits: float) -> Self:
        """The search for a system of one body at one Omega."""

        def falls(amplitude: Array) -> Array:
            return ~safe(response_alone(system, motion, amplitude, omega, eta, peaks=False).outcome)

        def seems(amplitude: Array) -> Array:
            if scan is not None and amplitude.size <= _FEW:
                return falls(amplitude)
            fallen = np.zeros(amplitude.size, dtype=bool) if scan is None else scan.falls(amplitude)
            doubtful = np.flatnonzero(~fallen & (amplitude > (0.0 if scan is None else system.safe_amplitude(motion))))
            fallen[doubtful] = ~safe(response(system, motion, amplitude[doubtful], np.asarray(omega), eta, peaks=False).outcome)
            return fallen

        scan = None
        if _long(motion):
            from ..dynamics.single.scan import Scan

            scan = Scan(system, motion, omega, eta) if Scan.serves(system, motion) else None
        return cls(falls, seems, digits, scan)

    def first(self, begin: float, end: float) -> float | None:
        """The lowest amplitude between these that falls, None if there is none."""
        low, stretch, found = begin, _STRETCH, None
        while found is None and low < end:
            high = end if self.scan else min(end, low * (1.0 + _COARSE) ** stretch)
            amplitude, seems = self._coarse(low, high)
            found = next(filter(None, (self.lowest(begin, fall, _FINE, _NEAR) for fall in amplitude[seems].tolist())), None)
            low, stretch = high, 2 * stretch
        while (missed := self._missed(begin, found or end)) is not None:
            found = self.lowest(begin, missed, _FINE, _NEAR)
        return found

    def _missed(self, begin: float, end: float) -> float | None:
        """A fall that the march finds at a few amplitudes between these."""
        checked = np.geomspace(begin, end, _CHECKED + 2)[1:-1]
        return next(iter(checked[self.falls(checked)].tolist()), None)

    def _coarse(self, low: float, high: float) -> tuple[Array, Array]:
        """(amplitudes `_COARSE` apart between these, true where the body seems to fall); each is looked at once."""
        amplitude = _ladder(low, high, _COARSE)
        self.look(amplitude)
        return amplitude, self.seen[1][np.searchsorted(self.seen[0], amplitude)]

    def look(self, amplitude: Array) -> None:
        """Look at amplitudes of the coarse search, together."""
        new = np.setdiff1d(amplitude, self.seen[0], assume_unique=True)
        if new.size:
            every, order = np.unique(np.append(self.seen[0], new), return_index=True)
            self.seen = every, np.append(self.seen[1], self.seems(new))[order]

    def lowest(self, begin: float, found: float, ratio: float, near: float) -> float | None:
        """The lowest fall from `begin` to `found`, where a body seems to fall, None if the march finds none. Amplitudes at a ratio are
        looked at from near^2 times `found` on, then from `near` times each new fall on."""
        low, high, lowest = max(begin, near * near * found), found, None
        while low < high:
            amplitude = _ladder(low, high, ratio)
            seems = self.seems(amplitude)
            seems[-1] |= lowest is None
            new = next(filter(None, (self._confirmed(amplitude, run) for run in _runs(seems))), None)
            if new is None:
                break
            lowest, low, high = new, max(begin, near * new), low
        return lowest

    def _confirmed(self, amplitude: Array, run: Array) -> float | None:
        """The lower end of a fall at or near a run of these amplitudes, None if the march finds none there."""
        first = np.arange(max(0, run[0] - _BESIDE), run[0] + 1)
        fallen = first[self.falls(amplitude[first])]
        if not fallen.size:
            rest = np.arange(run[0] + 1, min(amplitude.size, run[-1] + _BESIDE + 1))
            rest = rest[:: max(1, rest.size // _CHECKED)]
            fallen = rest[self.falls(amplitude[rest])]
        if not fallen.size:
            return None
        at, step = int(fallen[0]), 1
        while at and self.falls(amplitude[(below := max(0, at - step)) : below + 1])[0]:
            at, step = below, 2 * step
        return self.narrowed(float(amplitude[below]), float(amplitude[at])) if at else float(amplitude[0])

    def lowest_narrow(self, begin: float, found: float) -> tuple[float, float]:
        """(the lowest fall from `begin` on, `dust` of it), below a known fall; intervals 5e-6 of the amplitude wide are found if there
        is dust."""
        first = self.lowest(begin, found, _FINE, _NEAR) or found
        self._coarse(first, _ABOVE * first)
        dust = self.dust(first)
        return (self.lowest(begin, first, _FINEST, _NEAREST) or first if dust else first), dust

    def narrowed(self, low: float, high: float) -> float:
        """The amplitude, within `digits`, between standing at `low` and falling at `high`."""
        while high - low > self.digits * high and low < (middle := 0.5 * (low + high)) < high:
            low, high = (low, middle) if self.falls(np.array([middle]))[0] else (middle, high)
        return high

    def dust(self, first: float) -> float:
        """The share of falls among amplitudes `_COARSE` apart up to 5 % above the first fall; 0 if the falls are one interval."""
        falls = self.seen[1][(first < self.seen[0]) & (self.seen[0] < _ABOVE * first)].tolist()
        single = sum(one != other for one, other in pairwise([True, *falls])) <= 1
        return 0.0 if single else 0.5 * sum(falls) / len(falls)


def _ladder(low: float, high: float, ratio: float) -> Array:
    """Amplitudes from `low` to `high` at this ratio, the same between any ends."""
    powers = np.arange(np.ceil(np.log(low) / np.log1p(ratio)), np.log(high) / np.log1p(ratio))
    return np.unique(np.concatenate([[low, high], np.clip((1.0 + ratio) ** powers, low, high)]))


def _runs(flags: Array) -> list[Array]:
    """The indices of each run of flags that are set."""
    at = np.flatnonzero(flags)
    return np.split(at, np.flatnonzero(np.diff(at) > 1) + 1) if at.size else []


def _windows(lowest: float, demand: float, top: float, at_once: bool) -> Iterator[tuple[float, float]]:
    """Ranges of amplitudes to search in turn: up to the demand, then above it, with rising widths unless `at_once`."""
    begin, width = lowest, _FIRST_WINDOW
    if demand > lowest * (1.0 + 1e-12):
        yield lowest, demand
        begin = demand
    while begin < top:
        end = top if at_once or top - begin < 2.0 * width else begin + width
        yield begin, end
        begin, width = end, 2.0 * width
