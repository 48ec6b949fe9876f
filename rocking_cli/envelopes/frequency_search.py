"""The search for the worst frequencies of structures, whose cells are marched together:
a scan of the range, then the minima of the first overturning amplitude.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple, Self

import numpy as np

from ..dynamics.method import Method, governing_method
from ..dynamics.outcome import safe
from ..dynamics.shared_march import SharedMarch
from ..dynamics.system import System
from ..motions import Motion
from ..motions.grid import Axis, Grid
from ..structures.parameters import RockingParameters
from .amplitudes import Limit, limit_of
from .boundaries import Search
from .capacity import CapacitySearch, tracing_width
from .first_falls import FirstFalls

Array = np.ndarray

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

Tell = Callable[[float], None]  # called with the share that is done


class WorstFrequency(NamedTuple):
    """The worst frequency of a range for one structure."""

    grid: Grid  # the demand at this frequency, of one cell
    # [Hz]; None if the body lifts at no frequency and has no capacity
    frequency: float | None
    end: str | None  # "lower" or "upper" if it is this end of the range, otherwise None


class FrequencyRange(NamedTuple):
    """A structure under a range of frequencies."""

    structure: RockingParameters  # the structure
    motion: Motion  # the motion of the ground
    amplitude: float  # A of the demand [-]
    begin: float  # Omega of the demand at the stated first end of the range [-]
    end: float  # Omega at the other end [-]
    method: Method  # model and tolerance
    system: System  # the system of the structure
    uplift: float  # least A that lifts it [-]
    most: float | None  # largest A of the search [-], None if only outcomes are wanted

    @classmethod
    def of(
        cls,
        structure: RockingParameters,
        motion: Motion,
        low: Grid,
        high: Grid,
        a_max: float | Limit | None,
    ) -> Self:
        """Return the range between two demands. Raises UsageError."""
        method = governing_method(structure, dimensionless=low.dimensionless)
        (amplitude, begin), (_, end) = (grid.cell(structure) for grid in (low, high))
        system = method.system_of(structure)
        return cls(
            structure,
            motion,
            amplitude,
            begin,
            end,
            method,
            system,
            system.least_uplift(motion),
            None if a_max is None else limit_of(a_max, structure),
        )

    @property
    def ends(self) -> tuple[float, float]:
        """The lowest and the highest Omega."""
        return min(self.begin, self.end), max(self.begin, self.end)

    def scan(self) -> Array:
        """The Omega of the scan, both ends included."""
        low, high = self.ends
        return np.geomspace(
            low, high, 2 + math.ceil(math.log(high / low) / math.log(_RATIO))
        )

    def search(self, most: float) -> Search:
        """The search for overturning amplitudes up to `most`. Raises UsageError if it
        is above the limit of a scan.
        """
        self._capacity_search(self.begin, most).ends()
        return Search(self.system, self.motion, self.structure.eta, most)

    def first(self, omega: float, most: float) -> float:
        """The first overturning amplitude at an Omega, infinite if none up to `most`
        overturns.
        """
        found = self._capacity_search(omega, most).capacity().first
        return math.inf if found is None else found

    def _capacity_search(self, omega: float, most: float) -> CapacitySearch:
        return CapacitySearch(
            self.structure, self.motion, self.uplift, omega, self.method, most
        )

    def minimum(self, around: tuple[float, float], most: float) -> tuple[float, float]:
        """(minimum of the first overturning amplitude between two Omega, its Omega)."""
        from scipy.optimize import minimize_scalar

        found = minimize_scalar(
            lambda x: self.first(math.exp(x), most),
            bounds=tuple(map(math.log, around)),
            method="bounded",
            options={"xatol": _FINE},
        )
        return float(found.fun), math.exp(found.x)

    def named(self, omega: float | None, low: Grid, high: Grid) -> WorstFrequency:
        """Return the demand at the worst Omega; None: at no Omega."""
        if omega is None:
            return WorstFrequency(low, None, None)
        # The ends of the range are used as the user states them, without rounding.
        stated = {self.begin: low.frequency, self.end: high.frequency}
        if (axis := stated.get(omega)) is None:
            axis = (
                Axis("Omega", np.array([omega]))
                if low.dimensionless
                else Axis("omega_g", np.array([omega * self.structure.p]))
            )
        unit = self.structure.p if low.dimensionless else 1.0
        per_second = float(axis.values[0]) * unit
        names = {self.ends[0]: "lower", self.ends[1]: "upper"}
        return WorstFrequency(
            Grid(low.amplitude, axis), per_second / math.tau, names.get(omega)
        )


class ScanRows(NamedTuple):
    """The frequencies of the scans of several bodies, body by body. Every array is
    (rows,).
    """

    body: Array  # index of the body
    omega: Array  # Omega [-]
    before: Array  # index of the row of the next lower Omega; at the lower end its own
    after: Array  # index of the row of the next higher Omega; at the upper end its own

    @classmethod
    def of(cls, ranges: Sequence[FrequencyRange], bodies: Sequence[int]) -> Self:
        """Return the rows of these bodies."""
        scans = [ranges[i].scan() for i in bodies]
        sizes = np.array([scan.size for scan in scans], dtype=np.int64)
        ends = np.repeat(np.cumsum(sizes), sizes)
        row = np.arange(ends.size)
        return cls(
            np.repeat(np.asarray(bodies, dtype=np.int64), sizes),
            np.concatenate([np.zeros(0), *scans]),
            np.maximum(row - 1, ends - np.repeat(sizes, sizes)),
            np.minimum(row + 1, ends - 1),
        )

    def of_body(self, body: int) -> Array:
        """The rows of a body."""
        return np.flatnonzero(self.body == body)

    def around(self, row: int) -> tuple[float, float]:
        """The Omega next to that of a row, below and above it."""
        return float(self.omega[self.before[row]]), float(self.omega[self.after[row]])

    def at_an_end(self, rows: Array) -> Array:
        """True for rows at an end of the range."""
        return (self.before[rows] == rows) | (self.after[rows] == rows)

    def insides(self, rows: Array) -> Array:
        """The Omega a little inside of the end of the range at which each row is."""
        low = self.before[rows] == rows
        return self.omega[rows] * np.where(low, 1.0 + _INSIDE, 1.0 - _INSIDE)


class FrequencySearch:
    """The search for the worst Omega of several structures under one motion."""

    def __init__(
        self, ranges: Sequence[FrequencyRange], motion: Motion, tell: Tell
    ) -> None:
        self.ranges, self.motion, self.tell = ranges, motion, tell
        self.march = SharedMarch(
            motion, [one.structure for one in ranges], [one.method for one in ranges]
        )
        self.amplitude = np.array([one.amplitude for one in ranges])
        self.minima_found = 0

    def least(self) -> list[float | None]:
        """Return the Omega of the least overturning amplitude of each body, see
        `at_worst_frequency`.
        """
        most = np.array([one.most for one in self.ranges])
        uplift = np.array([one.uplift for one in self.ranges])
        searched = np.flatnonzero(uplift < most).tolist()
        rows = ScanRows.of(self.ranges, searched)
        falls, most = self._climbed(rows, most)
        found: list[float | None] = []
        for body, one in enumerate(self.ranges):
            own = rows.of_body(body)
            if not own.size:
                found.append(self._of_outcomes(one, body, own, falls, one.ends[0]))
                continue
            omega, above = self._least_of(body, own, rows, falls, float(most[body]))
            found.append(
                omega if above else self._of_outcomes(one, body, own, falls, omega)
            )
        return found

    def _climbed(self, rows: ScanRows, most: Array) -> tuple[FirstFalls, Array]:
        """(brackets of the first falls of these rows, followed by those a little inside
        of the ends of the ranges; the largest amplitude of the search of each body).
        """
        at = np.arange(rows.body.size)
        ends = at[rows.at_an_end(at)]
        falls = self._falls(
            np.append(rows.body, rows.body[ends]),
            np.append(rows.omega, rows.insides(ends)),
            most,
        )
        # The falls at the ends and in the middle of a range shorten its search.
        deciding = np.zeros(falls.body.size, dtype=bool)
        for body in np.unique(rows.body):
            own = rows.of_body(int(body))
            deciding[own[[0, own.size // 2, -1]]] = True

        def lowers(fallen: Array) -> Array:
            fallen = fallen[deciding[fallen]]
            np.minimum.at(most, falls.body[fallen], _WITHIN * falls.high[fallen])
            return most

        most = most.copy()
        falls.climb(most, lowers, lambda share: self.tell(_SCANNED * share))
        beyond = falls.high > most[falls.body]
        falls.low[beyond] = falls.high[beyond] = np.inf
        return falls, most

    def _falls(self, body: Array, omega: Array, most: Array) -> FirstFalls:
        """The search for the first falls of these rows; it has not begun."""
        searches = {
            int(i): self.ranges[i].search(float(most[i])) for i in np.unique(body)
        }
        digits = [tracing_width(one.method, self.motion) for one in self.ranges]
        return FirstFalls(self.march, searches, body, omega, np.array(digits))

    def _least_of(
        self, body: int, own: Array, rows: ScanRows, falls: FirstFalls, most: float
    ) -> tuple[float, bool]:
        """(Omega of the least overturning amplitude of a body, the lower end if there
        is none; True if this amplitude is above the demand). own: its rows.
        """
        one = self.ranges[body]
        lowest = self._minima_of_scan(own, rows, falls)
        if not lowest.size:
            return one.ends[0], False
        best = falls.lowest(lowest)
        minima = []
        for row in lowest.tolist():
            if rows.at_an_end(np.array([row]))[0]:
                inside = self._inside(row, rows)
                if falls.not_above(np.array([row]), np.array([inside]))[0]:
                    continue  # no lower a little inside
            minima.append(self._minimum(one, rows.around(row), most))
        first, omega = min(minima, default=(math.inf, 0.0))
        if minima and falls.exceeds(np.array([best]), np.array([first]))[0]:
            return omega, first > one.amplitude
        above = falls.exceeds(np.array([best]), np.array([one.amplitude]))[0]
        return float(rows.omega[best]), bool(above)

    def _inside(self, row: int, rows: ScanRows) -> int:
        """The row a little inside of the end of the range at which a row is."""
        at = np.arange(rows.body.size)
        ends = at[rows.at_an_end(at)]
        return rows.body.size + int(np.searchsorted(ends, row))

    def _minima_of_scan(self, own: Array, rows: ScanRows, falls: FirstFalls) -> Array:
        """The rows of a body whose first fall is no higher than those next to them."""
        own = own[np.isfinite(falls.high[own])]
        for near in (rows.before, rows.after):  # what is clear without narrowing
            low, high, beside = falls.low, falls.high, near[own]
            clear = (low[own] >= high[beside]) & (low[beside] < high[own])
            own = own[~clear | (beside == own)]
        for near in (rows.before, rows.after):
            own = own[falls.not_above(own, near[own])]
        return own

    def _minimum(
        self, one: FrequencyRange, around: tuple[float, float], most: float
    ) -> tuple[float, float]:
        """`FrequencyRange.minimum`; tells the progress."""
        found = one.minimum(around, most)
        self.minima_found += 1
        self.tell(1.0 - (1.0 - _SCANNED) * 0.5 ** (self.minima_found / _HALF))
        return found

    def _of_outcomes(
        self,
        one: FrequencyRange,
        body: int,
        own: Array,
        falls: FirstFalls,
        omega: float,
    ) -> float | None:
        """Return the worst Omega of a body of which no amplitude above the demand is
        the least that overturns it, at `omega`; own: its rows.
        """
        omegas = np.append(one.scan(), omega)
        turned, outcome = self._under(np.full(omegas.size, body), omegas)
        over = ~safe(outcome)
        known = own.size > 0 and bool(np.isfinite(falls.high[own]).any())
        if not known and not over.any():
            return _of_the_largest(turned, omegas)
        if not over[-1] and over.any():
            here = np.flatnonzero(over)
            return float(
                omegas[here[0]] if not known else falls.omega[falls.lowest(own[here])]
            )
        return omega

    def _under(self, body: Array, omega: Array) -> tuple[Array, Array]:
        """(theta_ratio, outcome) under the demand of these bodies at these Omega."""
        return self.march.response(body, self.amplitude[body], omega)[:2]

    def outcomes_alone(self) -> list[float | None]:
        """Return for each body an Omega at which the demand overturns it, else that of
        the largest rotation; None if it does not lift.
        """
        uplift = np.array([one.uplift for one in self.ranges])
        lifted = np.flatnonzero(self.amplitude > uplift).tolist()
        rows = ScanRows.of(self.ranges, lifted)
        turned, outcome = self._under(rows.body, rows.omega)
        found: list[float | None] = [None] * len(self.ranges)
        standing = []
        for body in lifted:
            own = rows.of_body(body)
            over = own[~safe(outcome[own])]
            if over.size:
                runs = np.split(over, np.flatnonzero(np.diff(over) > 1) + 1)
                widest = max(runs, key=len)
                found[body] = float(rows.omega[widest[widest.size // 2]])
            else:
                standing.append(body)
                found[body] = _of_the_largest(turned[own], rows.omega[own])
        for body, omega in self._between(standing):
            found[body] = omega
        return found

    def _between(self, bodies: Sequence[int]) -> Iterator[tuple[int, float]]:
        """Yield (body, Omega) of the bodies that the demand overturns between two
        frequencies of the scan; it overturns none of them at these frequencies.
        """
        rows = ScanRows.of(self.ranges, bodies)
        firsts = self._falls_above(rows)
        self.tell(_SCANNED)
        near = np.minimum(firsts[rows.before], firsts[rows.after])
        lowest = np.flatnonzero(np.isfinite(firsts) & (firsts <= near))
        inner = lowest[~rows.at_an_end(lowest) | self._falls_inside(lowest, rows)]
        done = set()
        for row in inner.tolist():
            body = int(rows.body[row])
            one = self.ranges[body]
            if body in done:
                continue
            reach = _OUTCOME_REACH * one.amplitude
            first, omega = self._minimum(one, rows.around(row), reach)
            if first > one.amplitude:
                continue
            _, outcome = self._under(np.array([body]), np.array([omega]))
            if not safe(outcome)[0]:
                done.add(body)
                yield body, omega

    def _falls_above(self, rows: ScanRows) -> Array:
        """The least amplitude from the demand to `_OUTCOME_REACH` times it that
        overturns the body at each Omega, infinite without one; amplitudes `_LADDER`
        apart are tried.
        """
        count = 1 + math.ceil(math.log(_OUTCOME_REACH) / math.log(_LADDER))
        ladder = np.geomspace(1.0, _OUTCOME_REACH, count)
        amplitude = self.amplitude[rows.body, None] * ladder
        # Theorems exclude some of them.
        safe_to = np.zeros(rows.body.size)
        for body in np.unique(rows.body):
            own = rows.of_body(int(body))
            search = self.ranges[body].search(float(amplitude[own[0], -1]))
            safe_to[own] = search.grid.amplitude(search.safe_points(rows.omega[own]))
        at, rung = np.nonzero(amplitude > safe_to[:, None])
        _, outcome, _ = self.march.response(
            rows.body[at], amplitude[at, rung], rows.omega[at], peaks=False
        )
        first = np.full(rows.body.size, np.inf)
        over = ~safe(outcome)
        np.minimum.at(first, at[over], amplitude[at[over], rung[over]])
        return first

    def _falls_inside(self, lowest: Array, rows: ScanRows) -> Array:
        """True for rows at an end of the range a little inside of which a lower
        amplitude overturns the body.
        """
        ends = lowest[rows.at_an_end(lowest)]
        found = np.zeros(lowest.size, dtype=bool)
        if not ends.size:
            return found
        body = np.tile(rows.body[ends], 2)
        omega = np.append(rows.omega[ends], rows.insides(ends))
        falls = self._falls(body, omega, _OUTCOME_REACH * self.amplitude)
        falls.climb(_OUTCOME_REACH * self.amplitude)
        at = np.arange(ends.size)
        no_lower = falls.not_above(at, at + ends.size) | np.isinf(
            falls.high[at + ends.size]
        )
        found[rows.at_an_end(lowest)] = ~no_lower
        return found


def _of_the_largest(turned: Array, omegas: Array) -> float | None:
    """Return the Omega of the largest rotation, None if the body does not
    lift at any.
    """
    return float(omegas[np.argmax(turned)]) if turned.any() else None
