"""The worst frequency of a range: the one at which the least amplitude overturns a
structure, or, if only outcomes are wanted, one at which the demand overturns it."""

import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from ..dynamics.method import Method, governing_method
from ..dynamics.outcome import safe
from ..dynamics.response import Response, response
from ..dynamics.system import System
from ..motions import Motion
from ..motions.grid import Axis, Grid
from ..processes import available_cpus, part_reporter
from ..structures.parameters import RockingParameters
from .amplitudes import Limit, limit_of
from .capacity import CapacitySearch
from .intervals import A_MAX, in_turn, trace_envelope

# ratio of neighbouring frequencies of the scan; narrower minima may be missed
_RATIO = 1.04
_WITHIN = 1.2  # upper end of the scan over the least amplitude so far
# relative distance from an end at which a lower amplitude shows that the end is no
# minimum
_INSIDE = 1e-4
_FINE = 1e-6  # relative width to which the frequency of a minimum is found
# times the demand: the search for falls between the frequencies of an outcome scan
_OUTCOME_REACH = 1.5
_LADDER = 1.002  # ratio of the amplitudes of this search
_SCANNED = 0.6  # about the share of the scan of a search
_HALF = 12  # searches around minima after which half of the rest is taken as done
# share of a search that counts when its result has come from its process
_LAST = 0.01
# ratio of an end of the range and the last frequency that is tried beyond it
_BEYOND = 10.0
_TRIED = 48  # frequencies beyond an end

Tell = Callable[[float], None]  # called with the share that is done


class WorstFrequency(NamedTuple):
    """The worst frequency of a range for one structure."""

    grid: Grid  # the demand at this frequency, of one cell
    # [Hz]; None if the body lifts at no frequency and has no capacity
    frequency: float | None
    end: str | None  # "lower" or "upper" if it is this end of the range, otherwise None


class BeyondTheEnd(NamedTuple):
    """The answers of a body to the demand at frequencies beyond an end of the range."""

    overturns: float | None  # the frequency nearest to the end that overturns it [Hz]
    # if none does: the frequency of the largest rotation, if it is larger [Hz]
    larger: float | None
    last: float  # the last frequency that was tried [Hz]


def at_worst_frequency(
    structure: RockingParameters,
    motion: Motion,
    low: Grid,
    high: Grid,
    a_max: float | Limit | None = A_MAX,
    *,
    tell: Tell = lambda _: None,
) -> WorstFrequency:
    """Return the worst frequency between those of two demands of one amplitude.

    At the worst frequency the first overturning amplitude is least. A scan of the range
    and a search around each minimum of the scan find it; minima narrower than 4 % of
    the frequency may be missed. If the demand is above this amplitude, and the body
    stands under it there but falls at other frequencies of the scan, the result is the
    worst of those. If no amplitude up to `a_max` overturns the body, and it stands
    under the demand, the result is the frequency of the largest rotation. If it does
    not even lift, no frequency is worse than another: `frequency` is None, and the grid
    is `low`.

    a_max: None if only outcomes are wanted. Then the result is a frequency of the scan
    at which the demand overturns the body. If there is none, the minima up to 1.5 times
    the demand are searched: a fall between two frequencies of the scan is missed only
    if at both of them no amplitude from the demand to 1.5 times the demand overturns
    the body, or only intervals narrower than 0.2 % do. If no frequency is found, the
    result is that of the largest rotation. tell: called with the share that is done.
    Raises UsageError.
    """
    method = governing_method(structure, dimensionless=low.dimensionless)
    (amplitude, begin), (_, end) = (grid.cell(structure) for grid in (low, high))
    ends = min(begin, end), max(begin, end)
    search = _Search(
        structure, motion, amplitude, ends, method, method.system_of(structure), tell
    )
    most = None if a_max is None else limit_of(a_max, structure)
    omega = search.outcomes_alone() if most is None else search.least(most)
    if omega is None:
        return WorstFrequency(low, None, None)

    # The ends of the range are used as the user states them, without rounding.
    stated = {begin: low.frequency, end: high.frequency}
    if (axis := stated.get(omega)) is None:
        axis = (
            Axis("Omega", np.array([omega]))
            if low.dimensionless
            else Axis("omega_g", np.array([omega * structure.p]))
        )
    per_second = float(axis.values[0]) * (structure.p if low.dimensionless else 1.0)
    named = {ends[0]: "lower", ends[1]: "upper"}
    return WorstFrequency(
        Grid(low.amplitude, axis), per_second / math.tau, named.get(omega)
    )


def at_worst_frequencies(
    structures: Sequence[RockingParameters],
    motion: Motion,
    low: Grid,
    high: Grid,
    a_max: float | Limit | None = A_MAX,
    *,
    workers: int | None = None,
    progress: Callable[[float, int], None] | None = None,
) -> list[WorstFrequency]:
    """`at_worst_frequency` of each structure.

    workers: number of processes, which share the structures, None for all cores;
    progress: called with the number of structures that are done, of which a part counts
    as a fraction, and the number of all. Raises UsageError, OutputError when a worker
    process dies.
    """
    known = 0.0

    def tell(done: float) -> None:
        nonlocal known
        known = max(known, done)
        if progress:
            progress(known, len(structures))

    def parts(reported: float) -> None:
        tell(min(reported, len(structures) - _LAST))

    def alone(structure: RockingParameters) -> WorstFrequency:
        before = len(found)
        return search(structure, tell=lambda share: tell(before + share))

    search = partial(at_worst_frequency, motion=motion, low=low, high=high, a_max=a_max)
    workers = min(workers or available_cpus(), len(structures))
    here = workers == 1
    found: list[WorstFrequency] = []
    for one in in_turn(
        alone if here else partial(_reported, search), structures, workers, parts
    ):
        found.append(one)
        tell(len(found))
    return found


def _reported(
    search: Callable[..., WorstFrequency], structure: RockingParameters
) -> WorstFrequency:
    """Search in a worker process, which reports its progress to the one that started
    it.
    """
    return search(structure, tell=part_reporter())


def beyond_the_end(
    structure: RockingParameters, motion: Motion, worst: WorstFrequency
) -> BeyondTheEnd:
    """Compute the answers of a body beyond the end of a range at which its worst
    frequency lies, up to ten times slower or faster.
    """
    method = governing_method(structure, dimensionless=worst.grid.dimensionless)
    amplitude, omega = worst.grid.cell(structure)
    last = omega / _BEYOND if worst.end == "lower" else omega * _BEYOND
    omegas = np.geomspace(omega, last, _TRIED + 1)
    found = _under(method.system_of(structure), structure, motion, amplitude, omegas)
    hertz = omegas * structure.p / math.tau
    falls = np.flatnonzero(~safe(found.outcome[1:]))
    if falls.size:
        return BeyondTheEnd(float(hertz[1 + falls[0]]), None, float(hertz[-1]))
    largest = int(np.argmax(np.nan_to_num(found.theta_ratio)))
    return BeyondTheEnd(
        None, float(hertz[largest]) if largest else None, float(hertz[-1])
    )


def _under(
    system: System,
    structure: RockingParameters,
    motion: Motion,
    amplitude: float,
    omegas: np.ndarray,
) -> Response:
    """Return the response to one amplitude at several Omega."""
    return response(
        system, motion, np.full(omegas.size, amplitude), omegas, structure.eta
    )


def _of_the_largest(under: Response, omegas: np.ndarray) -> float | None:
    """Return the Omega of the largest rotation, None if the body does not
    lift at any.
    """
    return (
        float(omegas[np.argmax(under.theta_ratio)]) if under.theta_ratio.any() else None
    )


class _Search(NamedTuple):
    """The search for the worst Omega of one structure."""

    structure: RockingParameters  # the structure
    motion: Motion  # the motion of the ground
    amplitude: float  # A of the demand [-]
    ends: tuple[float, float]  # lowest and highest Omega of the range [-]
    method: Method  # model and tolerance
    system: System  # the system of the structure
    tell: Tell  # called with the share that is done

    def scan(self) -> np.ndarray:
        """The Omega of the scan, both ends included."""
        low, high = self.ends
        return np.geomspace(
            low, high, 2 + math.ceil(math.log(high / low) / math.log(_RATIO))
        )

    def outcomes_alone(self) -> float | None:
        """Return an Omega at which the demand overturns the body, else that of the
        largest rotation; None if the body does not lift.
        """
        scan = self.scan()
        if self.amplitude <= self.system.least_uplift(self.motion):
            return None
        under = _under(self.system, self.structure, self.motion, self.amplitude, scan)
        falls = np.flatnonzero(~safe(under.outcome))
        if falls.size:
            runs = np.split(falls, np.flatnonzero(np.diff(falls) > 1) + 1)
            widest = max(runs, key=len)
            return float(scan[widest[widest.size // 2]])
        reach = _OUTCOME_REACH * self.amplitude
        minima = self._minima(self._falls_above(scan, reach), reach)
        below = np.array([omega for first, omega in minima if first <= self.amplitude])
        if below.size:
            there = _under(
                self.system, self.structure, self.motion, self.amplitude, below
            )
            if (falls := ~safe(there.outcome)).any():
                return float(below[falls][0])
        return _of_the_largest(under, scan)

    def least(self, a_max: float) -> float | None:
        """Return the Omega of the least overturning amplitude, see
        `at_worst_frequency`.
        """
        scan = self.scan()
        most = a_max
        for omega in (scan[0], scan[scan.size // 2], scan[-1]):  # they shorten the scan
            most = min(most, _WITHIN * self._first(float(omega), most))
        firsts = self._firsts(scan, most)
        minima = self._minima(firsts, most)
        first, omega = min(minima, default=(math.inf, self.ends[0]))
        if first > self.amplitude and math.isfinite(first):
            return omega
        omegas = np.append(scan, omega)
        under = _under(self.system, self.structure, self.motion, self.amplitude, omegas)
        falls = ~safe(under.outcome)
        if not math.isfinite(first) and not falls.any():
            return _of_the_largest(under, omegas)
        if not falls[-1] and falls.any():
            return float(
                min(omegas[falls], key=lambda omega: firsts.get(omega, math.inf))
            )
        return omega

    def _first(self, omega: float, most: float) -> float:
        """The first overturning amplitude at an Omega, infinite if none up to `most`
        overturns.
        """
        least = self.system.least_uplift(self.motion)
        if not least < most:
            return math.inf
        found = (
            CapacitySearch(self.structure, self.motion, least, omega, self.method, most)
            .capacity()
            .first
        )
        return math.inf if found is None else found

    def _minima(
        self, firsts: dict[float, float], most: float
    ) -> list[tuple[float, float]]:
        """Return the minima of the first overturning amplitude up to `most`, with their
        Omega.

        firsts: the amplitude at each Omega of the scan, about, infinite above `most`.
        """
        from scipy.optimize import minimize_scalar

        (low, high), minima = self.ends, []
        around = [low, *firsts, high]
        for before, omega, after in zip(around, firsts, around[2:], strict=False):
            # A minimum of the scan lies no higher than its neighbours.
            about = firsts[omega]
            if not (
                math.isfinite(about) and about <= min(firsts[before], firsts[after])
            ):
                continue
            first = self._first(omega, most)
            minima.append((first, omega))
            # At an end of the range: is it lower a little inside?
            inside = omega * (1.0 + _INSIDE if omega == low else 1.0 - _INSIDE)
            if omega in (low, high) and self._first(inside, most) >= first:
                continue
            found = minimize_scalar(
                lambda x: self._first(math.exp(x), most),
                bounds=(math.log(before), math.log(after)),
                method="bounded",
                options={"xatol": _FINE},
            )
            minima.append((float(found.fun), math.exp(found.x)))
            self.tell(1.0 - (1.0 - _SCANNED) * 0.5 ** (len(minima) / _HALF))
        return minima

    def _falls_above(self, scan: np.ndarray, most: float) -> dict[float, float]:
        """The least amplitude from the demand to `most` that overturns the body at each
        Omega of the scan, infinite without one; amplitudes `_LADDER` apart are tried.
        """
        count = 1 + math.ceil(math.log(most / self.amplitude) / math.log(_LADDER))
        ladder = np.geomspace(self.amplitude, most, count)
        amplitude, omega = np.meshgrid(ladder, scan)
        found = response(
            self.system, self.motion, amplitude, omega, self.structure.eta, peaks=False
        )
        falls = ~safe(found.outcome)
        first = np.where(falls.any(axis=1), ladder[falls.argmax(axis=1)], math.inf)
        self.tell(_SCANNED)
        return dict(zip(scan.tolist(), first.tolist(), strict=True))

    def _firsts(self, scan: np.ndarray, most: float) -> dict[float, float]:
        """The first overturning amplitude up to `most` at each Omega of the scan."""
        firsts = dict.fromkeys(scan.tolist(), math.inf)
        if self.system.least_uplift(self.motion) < most:
            for interval in trace_envelope(
                self.structure,
                self.motion,
                scan,
                method=self.method,
                a_max=most,
                sign="+",
                workers=1,
                progress=lambda done, total: self.tell(_SCANNED * done / total),
            ):
                firsts[interval.omega] = min(firsts[interval.omega], interval.a_from)
        return firsts
