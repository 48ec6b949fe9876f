"""The search for the worst frequencies of structures, whose cells are marched together:
a scan of the range, then the minima of the first overturning amplitude.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import cached_property
from typing import NamedTuple, Protocol, Self

import numpy as np

from ..arrays import Array
from ..dynamics.method import Method, governing_method
from ..dynamics.outcome import safe
from ..dynamics.shared_march import SharedMarch
from ..dynamics.system import System
from ..errors import UsageError
from ..motions import Motion
from ..motions.floors import NEEDS_UNITS
from ..motions.grid import Axis, Grid
from ..structures.building_modes import FloorMode
from ..structures.parameters import RockingParameters
from .amplitudes import Limit, limit_of
from .boundaries import looks_finely
from .capacity import CapacitySearch, tracing_width
from .first_falls import WITHIN, Climb, RowMarch, lowest_falls

# ratio of neighbouring frequencies of the scan; narrower minima may be missed
_RATIO = 1.04
# relative distance from an end at which a lower amplitude shows that the end is no
# minimum
_INSIDE = 1e-4
_FINE = 1e-6  # relative width to which the frequency of a minimum is found
# times the demand: the search for falls between the frequencies of an outcome scan
OUTCOME_REACH = 1.5
_LADDER = 2e-3  # ratio of the amplitudes of this search, minus 1
_RUNGS = 250  # amplitudes that are computed together: all of them
_SCANNED = 0.6  # about the share of the scan of a search
# around a largest rotation of the scan: parts of its step that are looked at, and the
# frequencies that are tried in each of them
_CLOSER, _TRIED = (1.0, 0.125, 0.015625), 17
_HALF = 12  # searches around minima after which half of the rest is taken as done


class RowsMarch(Protocol):
    """What marches the cells of a search: `SharedMarch`, or `FloorMarch`."""

    def response(
        self, which: Array, amplitude: Array, omega: Array, peaks: bool = True
    ) -> tuple[Array, Array, Array]: ...

    def of_rows(self, which: Array, omega: Array) -> RowMarch: ...


Tell = Callable[[float], None]  # called with the share that is done


class WorstFrequency(NamedTuple):
    """The worst frequency of a range for one structure."""

    grid: Grid  # the demand at this frequency, of one cell
    # [Hz]; None if the body lifts at no frequency and has no capacity
    frequency: float | None
    end: str | None  # "lower" or "upper" if it is this end of the range, otherwise None
    # the demand at the frequency of the largest rotation, and this frequency [Hz]; None
    # if the body falls or does not lift
    largest: tuple[Grid, float] | None = None


class ScanAnswers(NamedTuple):
    """The answers to the demand at the frequencies of the scans."""

    rows: "ScanRows"  # of the bodies that the demand lifts
    rotation: Array  # theta_ratio, (rows,), infinite where the body falls
    falls: Array  # True where the body falls, (rows,)


class FrequencyRange(NamedTuple):
    """A structure under a range of frequencies."""

    structure: RockingParameters  # the structure, as if it stood on the ground
    motion: Motion  # the motion of the ground
    amplitude: float  # A of the demand [-]
    begin: float  # Omega of the demand at the stated first end of the range [-]
    end: float  # Omega at the other end [-]
    method: Method  # model and tolerance
    system: System  # the system of the structure
    uplift: float  # least A that lifts it [-]; on a floor 0, as it is not known
    most: float | None  # largest A of the search [-], None if only outcomes are wanted
    modes: tuple[FloorMode, ...]  # of the building below it, none on the ground

    @classmethod
    def of(
        cls,
        structure: RockingParameters,
        motion: Motion,
        low: Grid,
        high: Grid,
        a_max: float | Limit | None,
    ) -> Self:
        """Return the range between two demands. Raises UsageError, also for a structure
        in a building under dimensionless demands.
        """
        modes = structure.building
        structure = replace(structure, building=())
        if modes and (low.dimensionless or low.amplitude.name != "a_g"):
            raise UsageError(NEEDS_UNITS)
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
            0.0 if modes else system.least_uplift(motion),
            None if a_max is None else limit_of(a_max, structure),
            modes,
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

    def first(self, omega: float, most: float) -> float:
        """The first overturning amplitude at an Omega, infinite if none up to `most`
        overturns.
        """
        found = self.search(omega, most).capacity().first
        return math.inf if found is None else found

    def search(self, omega: float, most: float) -> CapacitySearch:
        """The search for overturning amplitudes up to `most` at an Omega."""
        return CapacitySearch(
            self.structure, self.motion, self.uplift, omega, self.method, most
        )

    def worst(
        self, omega: float | None, largest: float | None, low: Grid, high: Grid
    ) -> WorstFrequency:
        """Return the demands at the worst Omega and at that of the largest rotation;
        None: at no Omega.
        """
        found = self.named(omega, low, high)
        if largest is None:
            return found
        there = self.named(largest, low, high)
        assert there.frequency is not None
        return found._replace(largest=(there.grid, there.frequency))

    def named(self, omega: float | None, low: Grid, high: Grid) -> WorstFrequency:
        """Return the demand at an Omega; None: at no Omega."""
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

    fine = _FINE  # relative width to which a frequency is found

    def __init__(
        self,
        ranges: Sequence[FrequencyRange],
        motion: Motion,
        tell: Tell,
        march: RowsMarch | None = None,
    ) -> None:
        self.ranges, self.motion, self.tell = ranges, motion, tell
        self.march = march or SharedMarch(
            motion, [one.structure for one in ranges], [one.method for one in ranges]
        )
        self.amplitude = np.array([one.amplitude for one in ranges])
        self.minima_found = 0

    def least(self) -> list[float | None]:
        """Return the Omega of the least overturning amplitude of each body, see
        `at_worst_frequency`; None if no amplitude overturns it.
        """
        most = np.array([one.most for one in self.ranges])
        uplift = np.array([one.uplift for one in self.ranges])
        rows = ScanRows.of(self.ranges, np.flatnonzero(uplift < most).tolist())
        ends = np.flatnonzero(rows.at_an_end(np.arange(rows.body.size)))
        # the first fall at each frequency of the scan, and a little inside of its ends
        first, inside = np.split(
            self._first_falls(
                np.append(rows.body, rows.body[ends]),
                np.append(rows.omega, rows.insides(ends)),
                most,
                lambda share: self.tell(_SCANNED * share),
            ),
            [rows.body.size],
        )
        lower_inside = np.zeros(rows.body.size, dtype=bool)
        lower_inside[ends] = inside < first[ends]
        found: list[float | None] = []
        for body, one in enumerate(self.ranges):
            own = rows.of_body(body)
            omega, least = self._least_of(one, own, rows, first, lower_inside)
            if math.isinf(least):
                found.append(None)
            elif one.amplitude < least:
                found.append(omega)
            else:
                found.append(
                    self._of_outcomes(body, rows.omega[own], first[own], omega)
                )
        return found

    def _first_falls(
        self, body: Array, omega: Array, most: Array, tell: Tell = lambda _: None
    ) -> Array:
        """The first overturning amplitudes of bodies at these Omega, (rows,); infinite
        if they are above `most`, (bodies,), or far above the least one of the body.
        """
        for i in np.unique(body).tolist():
            self.ranges[i].search(self.ranges[i].begin, float(most[i])).ends()
        uplift = np.array([one.uplift for one in self.ranges])[body]
        digits = np.array(
            [tracing_width(one.method, self.motion) for one in self.ranges]
        )
        return lowest_falls(
            self.march.of_rows(body, omega),
            Climb(uplift, most[body], uplift),
            digits[body],
            finely=looks_finely(self.motion),
            rivals=body,
            tell=tell,
        ).amplitude

    def _least_of(
        self,
        one: FrequencyRange,
        own: Array,
        rows: ScanRows,
        first: Array,
        lower_inside: Array,
    ) -> tuple[float, float]:
        """(Omega of the least overturning amplitude of a body, this amplitude); the
        lower end of the range and infinite without one. own: its rows; first: first
        falls at all rows; lower_inside: True for rows at an end of the range a little
        inside of which the first fall is lower.
        """
        lowest = _minima(own, rows, first)
        if not lowest.size:
            return one.ends[0], math.inf
        best = lowest[first[lowest].argmin()]
        inner = lowest[~rows.at_an_end(lowest) | lower_inside[lowest]]
        most = min(one.most or math.inf, WITHIN * float(first[best]))
        minima = [self._minimum(one, rows.around(row), most) for row in inner.tolist()]
        least, omega = min(minima, default=(math.inf, 0.0))
        if least < first[best]:
            return omega, least
        return float(rows.omega[best]), float(first[best])

    def _minimum(
        self, one: FrequencyRange, around: tuple[float, float], most: float
    ) -> tuple[float, float]:
        """(minimum of the first overturning amplitude between two Omega, its Omega);
        tells the progress.
        """
        from scipy.optimize import minimize_scalar

        found = minimize_scalar(
            lambda x: self._first_at(one, math.exp(x), most),
            bounds=tuple(map(math.log, around)),
            method="bounded",
            options={"xatol": self.fine},
        )
        self.minima_found += 1
        self.tell(1.0 - (1.0 - _SCANNED) * 0.5 ** (self.minima_found / _HALF))
        return float(found.fun), math.exp(found.x)

    def _first_at(self, one: FrequencyRange, omega: float, most: float) -> float:
        """The first overturning amplitude of a body at an Omega, infinite if none up to
        `most` overturns it.
        """
        return one.first(omega, most)

    def _of_outcomes(self, body: int, scan: Array, first: Array, omega: float) -> float:
        """Return the worst Omega of a body whose least overturning amplitude, at
        `omega`, is not above the demand: `omega` if it falls there, else the one of the
        frequencies that overturn it, if there are any, that needs the least amplitude.
        scan, first: Omega of the scan and the first falls there.
        """
        here = np.flatnonzero(self._scanned.falls[self._scanned.rows.of_body(body)])
        if here.size and self._stands(body, omega):
            return float(scan[here[first[here].argmin()]])
        return omega

    @cached_property
    def _scanned(self) -> ScanAnswers:
        """The answers of the bodies that the demand lifts."""
        uplift = np.array([one.uplift for one in self.ranges])
        lifted = np.flatnonzero(self.amplitude > uplift).tolist()
        rows = ScanRows.of(self.ranges, lifted)
        turned, outcome = self.under(rows.body, rows.omega)
        falls = ~safe(outcome)
        return ScanAnswers(rows, np.where(falls, np.inf, turned), falls)

    def largest(
        self, worst: Sequence[float | None]
    ) -> Iterator[tuple[float | None, float | None]]:
        """Yield (worst Omega, Omega of the largest rotation under the demand) of each
        body: the first is that of `worst`, or without one that of a fall, else that of
        the largest rotation; the second is None for a body that falls or does not lift.

        The largest rotation of the scan is looked at more closely. If a frequency
        that is tried then overturns the body, it is the worst one.
        """
        rows, rotation, _ = self._scanned
        bodies = np.unique(rows.body)
        own = [rows.of_body(body) for body in bodies.tolist()]
        omega = np.array([rows.omega[i[rotation[i].argmax()]] for i in own])
        ends = np.array([self.ranges[i].ends for i in bodies.tolist()]).reshape(-1, 2)
        most, at = np.zeros(bodies.size), np.arange(bodies.size)
        for share in _CLOSER:
            apart = _RATIO ** (share * np.linspace(-1.0, 1.0, _TRIED))
            tried = np.clip(omega[:, None] * apart, ends[:, :1], ends[:, 1:])
            turned, outcome = self.under(np.repeat(bodies, _TRIED), tried.ravel())
            turned = np.where(safe(outcome), turned, np.inf).reshape(-1, _TRIED)
            omega, most = tried[at, turned.argmax(axis=1)], turned.max(axis=1)
        found = dict(zip(bodies.tolist(), zip(omega, most, strict=True), strict=True))
        for body, least in enumerate(worst):
            there, ratio = found.get(body, (None, 0.0))
            if math.isinf(ratio):
                yield there if self._stands(body, least) else least, None
            elif ratio == 0.0:
                yield least, None
            else:
                yield there if least is None else least, there

    def _stands(self, body: int, omega: float | None) -> bool:
        """True if a body stands under its demand at an Omega, or without one."""
        if omega is None:
            return True
        return bool(safe(self.under(np.array([body]), np.array([omega]))[1])[0])

    def under(self, body: Array, omega: Array) -> tuple[Array, Array]:
        """(theta_ratio, outcome) under the demand of these bodies at these Omega."""
        return self.march.response(body, self.amplitude[body], omega)[:2]

    def outcomes_alone(self) -> list[float | None]:
        """Return for each body an Omega at which the demand overturns it, None without
        one.
        """
        rows, _, falls = self._scanned
        found: list[float | None] = [None] * len(self.ranges)
        standing = []
        for body in np.unique(rows.body).tolist():
            own = rows.of_body(body)
            over = own[falls[own]]
            if over.size:
                runs = np.split(over, np.flatnonzero(np.diff(over) > 1) + 1)
                widest = max(runs, key=len)
                found[body] = float(rows.omega[widest[widest.size // 2]])
            else:
                standing.append(body)
        for body, omega in self._between(standing):
            found[body] = omega
        return found

    def _between(self, bodies: Sequence[int]) -> Iterator[tuple[int, float]]:
        """Yield (body, Omega) of the bodies that the demand overturns between two
        frequencies of the scan; it overturns none of them at these frequencies.
        """
        rows = ScanRows.of(self.ranges, bodies)
        firsts = self._falls_near(rows.body, rows.omega)
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
            reach = OUTCOME_REACH * one.amplitude
            first, omega = self._minimum(one, rows.around(row), reach)
            if first > one.amplitude:
                continue
            _, outcome = self.under(np.array([body]), np.array([omega]))
            if not safe(outcome)[0]:
                done.add(body)
                yield body, omega

    def _falls_near(self, body: Array, omega: Array) -> Array:
        """The lowest amplitudes of a ladder between the demand and its reach that
        overturn these bodies at these Omega, infinite where none does.
        """
        demand = self.amplitude[body]
        return lowest_falls(
            self.march.of_rows(body, omega),
            Climb(demand, OUTCOME_REACH * demand, demand, _LADDER),
            stretch=_RUNGS,
        ).amplitude

    def _falls_inside(self, lowest: Array, rows: ScanRows) -> Array:
        """True for rows at an end of the range a little inside of which a lower
        amplitude overturns the body.
        """
        ends = lowest[rows.at_an_end(lowest)]
        found = np.zeros(lowest.size, dtype=bool)
        if not ends.size:
            return found
        first, inside = np.split(
            self._first_falls(
                np.tile(rows.body[ends], 2),
                np.append(rows.omega[ends], rows.insides(ends)),
                OUTCOME_REACH * self.amplitude,
            ),
            2,
        )
        found[rows.at_an_end(lowest)] = inside < first
        return found


def _minima(own: Array, rows: ScanRows, first: Array) -> Array:
    """Those of these rows whose first fall is no higher than those next to them."""
    near = np.minimum(first[rows.before[own]], first[rows.after[own]])
    return own[np.isfinite(first[own]) & (first[own] <= near)]
