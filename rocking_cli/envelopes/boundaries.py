"""Changes of the outcome along the amplitude A, for many frequencies: a scan brackets
the changes, and sections trace each one.

Lemmas (`dynamics.lemmas`) exclude amplitudes from the scan. Below a first amplitude
nothing overturns (Lemma 9); bodies that may lose contact without overturning are
computed from a smaller amplitude on (`System.safe_amplitude`). Lemma 10 holds for the
linear oscillator that the motion lifts on its first segment at any amplitude: every
amplitude above one that overturns without impact does so too.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..dynamics.impulse_bound import ImpulseBound
from ..dynamics.lanes import Cells
from ..dynamics.march.proofs import FEW_SIGN_CHANGES
from ..dynamics.outcome import Outcome
from ..dynamics.response import response
from ..dynamics.system import System
from ..motions import Motion
from .amplitudes import LONGEST_FINE, ScanGrid
from .changes import SECTIONS, Brackets, narrowed

# (amplitude, outcome from there on), amplitudes rising
OutcomeSteps = list[tuple[float, int]]

# step of the finer scan around changes of the outcome or of the number of impacts,
# where narrow intervals gather
FINE_STEP = 0.999e-4
AROUND = 12  # points on either side of such a change that the finer scan includes
_BATCH = 1 << 20  # cells of the scan computed together
# points of a scan from which on it pays to prove the outcomes between some of them
_MANY = 40_000


class ScanPoints(NamedTuple):
    """Amplitudes that a scan has computed, by row and amplitude. Every array is
    (points,).
    """

    row: Array  # index of the Omega
    amplitude: Array  # A [-]
    label: Array  # outcome, a code of `Outcome`
    impacts: Array  # number of impacts until the outcome was certain


@dataclass(frozen=True)
class Search:
    """The outcomes of a system under one motion, up to an amplitude."""

    system: System  # the system whose outcomes are searched
    motion: Motion  # the motion of the ground
    a_max: float  # last amplitude of the search [-]
    # ratio of neighbouring amplitudes of the scan minus 1 [-], in place of SCAN_STEP
    # and of the finer scan; 0 for those
    ratio: float = 0.0
    digits: float = 4e-16  # relative width to which changes are traced [-]
    parts: int = SECTIONS  # parts of a bracket in one cut

    @cached_property
    def uplift(self) -> float:
        """The amplitude of the first uplift, at which the search begins."""
        return self.system.least_uplift(self.motion)

    @cached_property
    def grid(self) -> ScanGrid:
        """The amplitudes of the scan."""
        return ScanGrid.between(self.uplift, self.a_max, ratio=self.ratio)

    @cached_property
    def safe_impulse(self) -> float:
        """The largest A int |s| dphi/Omega from the first uplift on under which nothing
        overturns (Lemma 9).
        """
        return float(self._impulse_bound.least[0] / self._impulse_bound.growth[0])

    @cached_property
    def _impulse_bound(self) -> ImpulseBound:
        """Lemma 9 for A = Omega = 1."""
        cells = self._cells(np.ones(1), np.ones(1))
        return ImpulseBound.of(self.system.equation, cells, self.motion.segments)

    def _cells(self, amplitude: Array, omega: Array) -> Cells:
        return self.system.contact.cells(self.system.equation, amplitude, omega)

    def outcome(
        self, amplitude: Array, omega: Array | float, how: str = "arrays"
    ) -> Array:
        """Compute the response at these amplitudes: codes of `Outcome`, with ROCKED in
        place of NO_UPLIFT; how: as of `response`.
        """
        return self.respond(amplitude, omega, how)[0]

    def respond(
        self, amplitude: Array, omega: Array | float, how: str = "arrays"
    ) -> tuple[Array, Array]:
        """(codes of `Outcome`, number of impacts until the outcome was certain)."""
        found = response(
            self.system, self.motion, amplitude, omega, peaks=False, how=how
        )
        return lifted(found.outcome), found.impacts_at_least

    def rows(self, omegas: Array) -> list[OutcomeSteps]:
        """For each Omega the outcome at uplift and at every change
        above it. Changes are traced to the relative width `digits`; intervals narrower
        than the step of the scan may be missed.
        """
        begins, brackets = self._scan(omegas)
        return self._steps(begins, self._narrowed(omegas, brackets))

    def _steps(self, begins: Array, found: Brackets) -> list[OutcomeSteps]:
        """Return the outcome of each row at uplift and above every change found."""
        rows = [[(self.uplift, label)] for label in begins.tolist()]
        found = found.take(np.lexsort((found.high, found.row)))
        for row, amplitude, label in zip(
            found.row.tolist(), found.high.tolist(), found.above.tolist(), strict=True
        ):
            rows[row].append((amplitude, label))
        return rows

    def _scan(self, omegas: Array) -> tuple[Array, Brackets]:
        """(outcome at the first amplitude of each row, brackets of the changes between
        neighbouring amplitudes).
        """
        first, last = self._points_to_compute(omegas)
        starts = np.concatenate([[0], np.cumsum(last - first + 1)])
        begins, parts = np.empty(omegas.size, dtype=np.uint8), list[Brackets]()
        for begin in range(0, int(starts[-1]), _BATCH):
            end = min(begin + _BATCH, int(starts[-1]))
            # including the points around the gaps of this batch
            a = max(0, begin - 1 - AROUND)
            b = min(end + AROUND, int(starts[-1]))
            top, bottom = np.searchsorted(starts, [a, b - 1], side="right")
            row = np.repeat(
                np.arange(top - 1, bottom),
                np.diff(np.clip(starts[top - 1 : bottom + 1], a, b)),
            )
            place = np.arange(a, b)
            points = self._computed_or_proved(
                row, self.grid.amplitude(place - starts[row] + first[row]), omegas
            )
            new = np.flatnonzero(place == starts[row])
            begins[row[new]] = points.label[new]
            counted = (
                (place[:-1] >= begin - 1)
                & (place[:-1] < end - 1)
                & (row[1:] == row[:-1])
            )
            parts.append(self._changes(points, counted, omegas))
        return begins, Brackets.joined(parts)

    def _computed_or_proved(
        self, row: Array, amplitude: Array, omegas: Array
    ) -> ScanPoints:
        """As `_compute`, for points in the order of rows and amplitudes. Of many points
        those between which Lemma 15 proves the outcome are not computed.
        """
        if row.size < _MANY:
            return self._compute(row, amplitude, omegas)
        from .stretches import (
            AmplitudeStretches,
            outcomes_of_stretches,
            proved_outcomes,
        )

        if not AmplitudeStretches.supports(self.system, self.motion):
            return self._compute(row, amplitude, omegas)
        label, first = proved_outcomes(
            lambda row, ends: outcomes_of_stretches(
                self.system, self.motion, omegas[row], ends
            ),
            row,
            amplitude,
        )
        impacts = np.zeros(row.size, dtype=np.int32)

        # The points without a proof, and the first one of each stretch, which must have
        # the outcome that was proved.
        own = np.flatnonzero(first == np.arange(row.size))
        found = self._compute(row[own], amplitude[own], omegas)
        differs = np.zeros(row.size, dtype=bool)
        differs[own] = (found.label != label[own]) | (found.impacts > 0)
        label[own], impacts[own] = found.label, found.impacts
        again = np.flatnonzero(differs[first] & (first != np.arange(row.size)))
        if again.size:
            found = self._compute(row[again], amplitude[again], omegas)
            label[again], impacts[again] = found.label, found.impacts
        return ScanPoints(row, amplitude, label, impacts)

    def _compute(self, row: Array, amplitude: Array, omegas: Array) -> ScanPoints:
        """Compute the outcomes at these amplitudes, batch by batch."""
        label = np.empty(row.size, dtype=np.uint8)
        impacts = np.empty(row.size, dtype=np.int32)
        for begin in range(0, row.size, _BATCH):
            batch = slice(begin, begin + _BATCH)
            label[batch], impacts[batch] = self.respond(
                amplitude[batch], omegas[row[batch]]
            )
        return ScanPoints(row, amplitude, label, impacts)

    def _changes(self, points: ScanPoints, counted: Array, omegas: Array) -> Brackets:
        """Brackets of the changes between scan points."""

        def compute(row: Array, amplitude: Array) -> ScanPoints:
            return self._compute(row, amplitude, omegas)

        finely = not self.ratio and looks_finely(self.motion)
        return changes_between(points, counted, finely, compute)

    def _points_to_compute(self, omegas: Array) -> tuple[Array, Array]:
        """(first, last) scan point to compute; there is no change below the first or
        above the last.
        """
        scan, segments = self.grid, self.motion.segments
        first = self.safe_points(omegas)
        last = np.full(omegas.size, scan.size - 1)
        if self.system.devices is not None or self.motion.vertical is not None:
            return first, last
        # the largest |s| lifts the body to the same side at any amplitude
        start = segments.s_start[0]
        end = segments.s_end[0]
        at_once = abs(start) == self.motion.largest or (
            abs(end) == self.motion.largest and start * end >= 0.0
        )
        if self.system.bounded and self.system.alike and at_once:
            last = self._first_without_impact(omegas, first, last)
        return first, last

    def safe_points(self, omegas: Array) -> Array:
        """The scan point of each row up to which theorems exclude overturning."""
        if self.system.devices is not None or self.motion.vertical is not None:
            return np.zeros(omegas.size, dtype=np.int64)
        # above it bodies may lose contact
        safe_to = self.system.safe_amplitude(self.motion)
        return np.minimum(
            self._last_safe_point(omegas),
            self.grid.below(np.full(omegas.size, safe_to)),
        )

    def _last_safe_point(self, omegas: Array) -> Array:
        """The last scan point of each row at which Lemma 9 excludes overturning, since
        A int |s| dphi/Omega is at most `safe_impulse`.
        """
        scan = self.grid
        segments = self.motion.segments
        # Under a record the integral is so large that this excludes no amplitude.
        if len(segments) > LONGEST_FINE:
            return np.zeros(omegas.size, dtype=np.int64)
        most = (1.0 - 1e-9) * self.safe_impulse * omegas
        remaining = self._impulse_bound.remaining
        low = np.zeros(omegas.size, dtype=np.int64)
        high = np.full(omegas.size, scan.size)
        # Bisection: a larger amplitude lifts the body earlier, so both A and the
        # integral grow from point to point.
        while np.any(high - low > 1):
            middle, cell = (low + high) // 2, np.arange(omegas.size)
            amplitude = scan.amplitude(middle)
            lift = self.system.contact.uplift(
                self._cells(amplitude, omegas),
                segments,
                cell,
                0 * cell,
                np.zeros(omegas.size),
            )
            holds = amplitude * remaining.after(lift.segment, lift.phase) <= most
            low, high = np.where(holds, middle, low), np.where(holds, high, middle)
        return low

    def _first_without_impact(self, omegas: Array, first: Array, last: Array) -> Array:
        """The first scan point of each row between these two that overturns without
        impact, or `last`; all above it do too (Lemma 10).
        """

        def overturns(points: Array, rows: Array) -> Array:
            amplitude = self.grid.amplitude(points)
            return (
                self.outcome(amplitude, omegas[rows]) == Outcome.OVERTURNED_NO_IMPACT
            ) & (amplitude > self.uplift * (1.0 + 1e-9))

        # Lemma 10: the answer changes once, from False to True, so sections find it. A
        # row keeps `last` if it does not overturn there.
        rows = np.flatnonzero(overturns(last, np.arange(omegas.size)))
        first, high, row = first[rows], last[rows], np.arange(rows.size)
        low = first - 1
        while np.any(high - low > 1):
            points = np.maximum(
                low[:, None]
                + (high - low)[:, None] * np.arange(1, SECTIONS + 1) // SECTIONS,
                first[:, None],
            )
            step = overturns(points, rows[:, None]).argmax(axis=1)
            high = points[row, step]
            low = np.where(step > 0, points[row, step - 1], low)
        last[rows] = high
        return last

    def _narrowed(self, omegas: Array, brackets: Brackets) -> Brackets:
        """The changes in the brackets, traced to the relative width `digits`."""
        return narrowed(
            lambda amplitude, row: self.outcome(amplitude, omegas[row]),
            brackets,
            self.digits,
            self.parts,
            lowest=False,
        )


def lifted(outcome: Array) -> Array:
    """The outcomes, with ROCKED in place of NO_UPLIFT."""
    return np.where(outcome == Outcome.NO_UPLIFT, np.uint8(Outcome.ROCKED), outcome)


def looks_finely(motion: Motion) -> bool:
    """True if a scan under this motion looks more finely around changes."""
    return motion.segments.sign_changes > FEW_SIGN_CHANGES


def changes_between(
    points: ScanPoints,
    counted: Array,
    finely: bool,
    compute: Callable[[Array, Array], ScanPoints],
) -> Brackets:
    """Brackets of the changes between scan points, after which they are `counted`.
    finely: True if points are added around changes of the outcome or of the number of
    impacts; compute: function of rows and amplitudes that computes them.
    """
    width = np.diff(points.amplitude)
    changed = (points.label[1:] != points.label[:-1]) | (
        points.impacts[1:] != points.impacts[:-1]
    )
    changed &= finely
    # Each gap near a change is cut into equal parts of at most `FINE_STEP`.
    gap = np.flatnonzero(counted & _around(changed) & (width > FINE_STEP))
    cuts = np.ceil(width[gap] / FINE_STEP).astype(np.int64) - 1
    share = (
        np.arange(cuts.sum()) - np.repeat(np.cumsum(cuts) - cuts, cuts) + 1.0
    ) / np.repeat(cuts + 1, cuts)
    gap = np.repeat(gap, cuts)
    inner = compute(points.row[gap], points.amplitude[gap] + share * width[gap])
    # Points of both scans in one order, by row and amplitude.
    place = np.concatenate([np.arange(points.row.size), gap + share])
    order = np.argsort(place, kind="stable")
    row, amplitude, label = (
        np.concatenate([x, y])[order]
        for x, y in zip(points[:3], inner[:3], strict=True)
    )
    return Brackets.between(
        row, amplitude, label, counted[place[order[:-1]].astype(np.int64)]
    )


def _around(flags: Array) -> Array:
    """True at places that are at most AROUND places from a True flag."""
    sums, at = np.concatenate([[0], np.cumsum(flags)]), np.arange(flags.size)
    return (
        sums[np.minimum(at + AROUND + 1, flags.size)] > sums[np.maximum(at - AROUND, 0)]
    )
