"""Capacity: the lowest amplitude that overturns one body, and the end of the safe interval around a demand.

The boundaries are traced as in an envelope, but the search stops when both answers are known. The demand is one of the amplitudes of
the search, so the answers agree with the response at the demand.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import pairwise

import numpy as np

from ..dynamics.march.closings import FEW
from ..dynamics.method import Method
from ..dynamics.outcome import Outcome, safe
from ..dynamics.response import response
from ..dynamics.single.response import response_alone
from ..dynamics.system import System
from ..errors import UsageError
from ..motions import Motion
from ..processes import Run, processes
from ..structures.parameters import RockingParameters
from .boundaries import Search
from .changes import Brackets
from .intervals import HIGHEST

Array = np.ndarray

LONGEST_FINE = 200  # segments of a motion up to which the scan is as fine as an envelope's
RATIO = 5e-3  # ratio of neighbouring amplitudes minus 1 of an envelope beyond that: a cell costs as much as a thousand of a pulse
_COARSE, _FINE = 1e-3, 6e-5  # the same for a search for the lowest fall: everywhere, and in the tenth below a known fall
_FINEST, _NEAREST = 5e-6, 0.997  # under a pulse with narrow falls: step, and reach of the search below each fall
_NEAR, _ABOVE = 0.9, 1.05  # times the lowest fall: start of the fine search, and end of the count of falls
_STRETCH = 100  # amplitudes of the first stretch
_FEW, _LONGER = 200, 100  # stretches of up to so many amplitudes, and one more for so many segments, are faster one by one
_SHARE = 4  # the same per process
_MANY = 1000  # amplitudes that processes share: fewer take nearly as long
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


def capacity(
    structure: RockingParameters, motion: Motion, amplitude: float, omega: float, *, method: Method, a_max: float, workers: int = 1
) -> Capacity:
    """The capacity of a structure at Omega [-] against a demand of A = `amplitude` [-], searched up to `a_max` and twice the demand.

    Intervals narrower than `narrowest` may be missed, but not around the demand. Changes are traced to the last digits of an exact method,
    otherwise to its tolerance. workers: processes that share the search under a long motion. Raises UsageError if `amplitude` or
    `a_max` is above the limit of a scan, OutputError when a process dies.
    """
    system, digits = method.system_of(structure), method.stated_tolerance or 4e-16
    lowest, top = system.least_uplift(motion), max(a_max, 2.0 * amplitude)
    if not top <= HIGHEST:
        raise UsageError(f"{structure.name}: found a search up to A = {top:.6g}; expected up to {HIGHEST:g}")
    if not lowest < top:
        return Capacity(None, None, lowest if np.isfinite(lowest) else None)
    stretches = Stretches(system, motion, structure.eta, np.array([omega]), digits)
    if _long(motion):
        with stretches.on_processes(workers) as stretches:
            below = stretches.first_fall(lowest, min(amplitude, top)) if lowest < amplitude else None
            stands = amplitude <= lowest or bool(safe(stretches.alone(amplitude)))
            above = stretches.first_fall(max(lowest, amplitude), top) if stands else None
        first = below or (above if stands else stretches.narrowed(amplitude * (1.0 - _COARSE), amplitude))
        return Capacity(first, above, lowest, 0.0 if first is None else stretches.dust(first))
    search = Search(system, motion, structure.eta, top, digits=digits, parts=_PARTS)
    falls: list[Brackets] = []  # one window after the other, until the outcome at the demand and the next fall above it are known
    above_demand = False
    for begin, end in _windows(lowest, amplitude, top, at_once=system.equation.bounded):
        fall, last = replace(search, a_min=begin, a_max=end).fall(omega)
        falls += [fall] if fall.row.size else []
        above_demand = begin >= amplitude and fall.row.size > 0
        if above_demand or (end <= amplitude and not Outcome(last).safe):
            break
    found = search.first_falls_in(omega, Brackets.joined(falls)) if falls else []
    first, dust = min(found, default=None), 0.0
    if first is not None and motion.segments.pushes > FEW:
        first, dust = stretches.lowest_narrow_fall(lowest, first)
    safe_to = found[-1] if above_demand else None
    return Capacity(first, safe_to if first is None or safe_to is None or first < amplitude else first, lowest, dust)


def narrowest(motion: Motion) -> str:
    """The width of intervals that a search may miss, in words."""
    return f"{100.0 * _COARSE:g} % of the amplitude ({100.0 * _FINE:g} % in the tenth below a fall)" if _long(motion) else "0.001 in A"


def _long(motion: Motion) -> bool:
    return len(motion.segments) > LONGEST_FINE


@dataclass(frozen=True)
class Stretches:
    """The outcomes of one system at one Omega under a long motion.

    shared, workers: the function of `processes` and their number; seen: all computed amplitudes `_COARSE` apart, with their falls.
    """

    system: System
    motion: Motion
    eta: float
    omega: Array
    digits: float
    shared: Run | None = None
    workers: int = 1
    seen: list[tuple[Array, Array]] = field(default_factory=list)

    @contextmanager
    def on_processes(self, workers: int) -> Iterator[Stretches]:
        """Context with the same search on `workers` processes. Raises OutputError when one dies."""
        if workers == 1:
            yield self
            return
        with processes(workers, self.look, "fewer `workers` need less") as run:
            yield replace(self, shared=run, workers=workers)

    def falls(self, low: float, high: float, ratio: float) -> tuple[Array, Array]:
        """(amplitudes from `low` to `high`, true for each that falls); if they are few, only up to 5 % above the first fall."""
        if ratio == _COARSE:
            amplitude = np.geomspace(low, high, 2 + int(np.log(high / low) / np.log1p(ratio)))
        else:  # the same amplitudes for any ends
            powers = np.arange(np.ceil(np.log(low) / np.log1p(ratio)), np.log(high) / np.log1p(ratio))
            amplitude = np.unique(np.concatenate([[low, high], np.clip((1.0 + ratio) ** powers, low, high)]))
        falls = ~safe(self._outcomes(amplitude))
        amplitude = amplitude[: falls.size]
        if ratio == _COARSE:
            self.seen.append((amplitude, falls))
        return amplitude, falls

    def _outcomes(self, amplitude: Array) -> Array:
        """The outcomes at rising amplitudes; if they are few, only up to 5 % above the first fall."""
        run = self.shared or partial(map, self.look)
        if amplitude.size > _FEW + len(self.motion.segments) // _LONGER:
            outcome = np.empty(amplitude.size, dtype=np.uint8)
            shares = self.workers if amplitude.size > _MANY else 1
            for i, part in enumerate(run((amplitude[i::shares], False) for i in range(shares))):
                outcome[i::shares] = part
            return outcome
        parts, end = [], np.inf
        few = [amplitude[i : i + _SHARE] for i in range(0, amplitude.size, _SHARE)]
        for share, part in zip(few, run((share, True) for share in few), strict=True):
            parts.append(part)
            end = min(end, *(_ABOVE * share[~safe(part)]), np.inf)
            if share[-1] >= end:
                break
        return np.concatenate(parts)

    def look(self, share: tuple[Array, bool]) -> Array:
        """The outcomes at the amplitudes of a share, computed one after the other or together as the share states."""
        amplitude, alone = share
        return self.alone(amplitude) if alone else response(self.system, self.motion, amplitude, self.omega, self.eta, peaks=False).outcome

    def alone(self, amplitude: Array | float) -> Array:
        """The outcomes at amplitudes, each computed by itself."""
        return response_alone(self.system, self.motion, amplitude, self.omega, self.eta, peaks=False).outcome

    def first_fall(self, begin: float, end: float) -> float | None:
        """The lowest amplitude between these that falls, None if there is none."""
        low, stretch = begin, _STRETCH
        while low < end:
            high = min(end, low * (1.0 + _COARSE) ** stretch)
            amplitude, falls = self.falls(low, high, _COARSE)
            if at := int(falls.argmax()):
                return self.lowest_fall(begin, float(amplitude[at - 1]), float(amplitude[at]), _FINE, _NEAR)
            if falls[0]:
                return float(amplitude[0])
            low, stretch = high, 2 * stretch
        return None

    def lowest_fall(self, begin: float, below: float, found: float, ratio: float, near: float) -> float:
        """The lowest fall from `begin` on. The search computes amplitudes at a ratio from `near` times `found` to `found`, and again below
        each new fall. The body falls at `found` and stands at `below`, or just below `found` if the two are equal."""
        known = found
        while known > (fine := max(begin, near * found)) * (1.0 + ratio):
            amplitude, falls = self.falls(fine, known, ratio)
            known = fine
            if falls[0]:
                return float(amplitude[0])
            if at := int(falls.argmax()):
                below, found = float(amplitude[at - 1]), float(amplitude[at])
        return self.narrowed(below, found)

    def lowest_narrow_fall(self, begin: float, found: float) -> tuple[float, float]:
        """(the lowest fall from `begin` on, `dust` of it), below a known fall; intervals 5e-6 of the amplitude wide are found if there
        is dust."""
        first = self.lowest_fall(begin, found, found, _FINE, _NEAR)
        self.falls(first, _ABOVE * first, _COARSE)
        dust = self.dust(first)
        return (self.lowest_fall(begin, first, first, _FINEST, _NEAREST) if dust else first), dust

    def narrowed(self, low: float, high: float) -> float:
        """The amplitude, within `digits`, between standing at `low` and falling at `high`."""
        while high - low > self.digits * high and low < (middle := 0.5 * (low + high)) < high:
            low, high = (middle, high) if safe(self.alone(middle)) else (low, middle)
        return high

    def dust(self, first: float) -> float:
        """The share of falls among amplitudes `_COARSE` apart up to 5 % above the first fall; 0 if the falls are one interval."""
        seen = sorted((a, bool(fall)) for amplitude, falls in self.seen for a, fall in zip(amplitude.tolist(), falls, strict=True))
        falls = [fall for a, fall in seen if first < a < _ABOVE * first]
        single = sum(one != other for one, other in pairwise([True, *falls])) <= 1
        return 0.0 if single else 0.5 * sum(falls) / len(falls)


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
