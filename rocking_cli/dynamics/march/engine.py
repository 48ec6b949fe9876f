"""The vectorised engine: cells (A, Omega, eta) under one motion, advanced arc by arc in a pool of lanes.

In each round every lane goes from its present state to the end of a window of the drive, or to its impact (`advance`).
Lanes that finish hand in their result and new cells take their places, so that a cell which chatters never holds up the
others. What is known in closed form is not marched through: cells that never leave the ground, rest, the end of a
chatter, certain overturning, the free motion after the shaking.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from ...motions.motion import Motion, Segments
from ..contacts.contact import chatter_ends, uplift
from ..equations.equation import Model
from ..equations.linear import LinearModel
from ..outcome import Outcome
from .advance import Event, advance, raise_peaks
from .lanes import Lanes, place

Array = np.ndarray

MAX_STEPS = 120_000  # a cell that takes more, and 40 for each segment of the motion, is given up as failed
# The C library keeps freed memory up to twice the largest block it has seen come and go. Below that it hands the arrays of each
# round back to the system and faults them in again for the next, which takes a third of the nonlinear engine's time.
_KEPT = 31 << 20  # bytes; glibc learns from blocks up to 32 MB
STILL = 1e-100  # a speed whose square a double does not hold is none


@dataclass(frozen=True)
class Work:
    """What was computed and what was left out."""

    cells: int = 0
    no_uplift: int = 0
    certain_overturning: int = 0
    free_phase: int = 0
    rests_skipped: int = 0
    chatters_closed: int = 0
    impacts: int = 0
    steps: int = 0

    def __add__(self, other: Work) -> Work:
        return Work(**{f.name: getattr(self, f.name) + getattr(other, f.name) for f in fields(self)})


@dataclass(frozen=True)
class Response:
    """Result for each cell, in the shape of the input.

    theta_ratio: max over time of |theta|/alpha [-], NaN where overturned or failed; outcome: uint8 codes of `Outcome`;
    impacts: int32, impacts during the shaking (those of a chatter closed in one step are not counted); work: counters.
    """

    theta_ratio: Array
    outcome: Array
    impacts: Array
    work: Work


def linear_response(
    motion: Motion, amplitude: Array, omega: Array, eta: Array | float, *, peaks: bool = True, pool: int | None = None
) -> Response:
    """Largest rotation and outcome of linear rocking oscillators under one motion (Eqs. 2.4, 2.6, 3.6), exact.

    Parameters: amplitude A = a_scale a_g / (alpha g) [-], finite and not negative; omega Omega = omega_g / p [-],
    positive and finite; eta [-] in [0, 1]; broadcast against each other. peaks: whether theta_ratio is wanted; without it
    only the outcome is computed and theta_ratio is NaN. Raises ValueError when a number is out of range.
    """
    return response(LinearModel(), motion, amplitude, omega, eta, peaks=peaks, pool=pool)


def response(
    model: Model, motion: Motion, amplitude: Array, omega: Array, eta: Array | float, *, peaks: bool = True, pool: int | None = None
) -> Response:
    """The same for any model; pool: lanes advanced together, None for what suits the model. Raises ValueError."""
    amplitude, omega, eta = np.broadcast_arrays(*(np.asarray(x, dtype=float) for x in (amplitude, omega, eta)))
    if not (np.all(np.isfinite(amplitude)) and np.all(amplitude >= 0.0)):
        raise ValueError("amplitude must be finite and not negative")
    if not (np.all(np.isfinite(omega)) and np.all(omega > 0.0)):
        raise ValueError("omega must be positive and finite")
    if not np.all((eta >= 0.0) & (eta <= 1.0)):
        raise ValueError("eta must be within [0, 1]")
    run = Run(model, motion.segments, amplitude.ravel() / model.initiation, omega.ravel(), eta.ravel(), peaks, pool or model.pool)
    run.all()
    shape = amplitude.shape
    return Response(run.theta_ratio.reshape(shape), run.outcome.reshape(shape), run.impacts.reshape(shape), run.work)


class Run:
    """One batch of cells on its way through the pool."""

    def __init__(self, model: Model, segments: Segments, amplitude: Array, omega: Array, eta: Array, peaks: bool, pool: int) -> None:
        self.model, self.segments, self.peaks, self.pool = model, segments, peaks, pool
        self.amplitude, self.omega, self.eta = amplitude, omega, eta
        self.theta_ratio = np.full(amplitude.size, 0.0 if peaks else np.nan)
        self.outcome = np.full(amplitude.size, Outcome.NO_UPLIFT, dtype=np.uint8)
        self.impacts = np.zeros(amplitude.size, dtype=np.int32)
        self.work = Work(cells=amplitude.size)
        self.most_steps = MAX_STEPS + 40 * len(segments)

    def all(self) -> None:
        """Run every cell to its end."""
        peak = max(self.segments.later_max[0], -self.segments.later_min[0])
        waiting = np.flatnonzero(self.amplitude * peak > 1.0)
        self.work += Work(no_uplift=self.amplitude.size - waiting.size)
        lanes, taken = self._start(waiting[:0]), 0
        np.empty(_KEPT, dtype=np.uint8)  # made and freed: see there
        with np.errstate(all="ignore"):
            while taken < waiting.size or lanes.cell.size:
                room = self.pool - lanes.cell.size
                if room > 0 and taken < waiting.size:
                    lanes = lanes.join(self._start(waiting[taken : taken + room]))
                    taken += room
                lanes = self._round(lanes)

    def _start(self, cell: Array) -> Lanes:
        """Bodies at rest, taken to their first uplift."""
        zero = np.zeros(cell.size)
        amplitude = self.amplitude[cell]
        first = uplift(self.segments, np.zeros(cell.size, dtype=np.int64), zero, amplitude)
        count = np.zeros(cell.size, dtype=np.int32)
        peak = np.full(cell.size, 0.0 if self.peaks else np.inf)  # infinite: nothing that comes can matter to it
        return Lanes(
            cell, amplitude, self.omega[cell], self.eta[cell],
            first.k, first.u, first.side, zero, zero.copy(), first.b, peak, count, count.copy(),
        )  # fmt: skip

    def _round(self, lanes: Lanes) -> Lanes:
        """One step for every lane; returns the lanes that are still on their way."""
        seg = self.segments
        lanes.steps += 1
        event = advance(seg, lanes, self.model)
        self._observe(lanes, event)
        end, hit = event.end, event.hit
        k, u = place(seg, event.step.k, event.step.u)
        bad = ~(np.isfinite(end.y) & np.isfinite(event.reach)) | (lanes.steps > self.most_steps)
        shaken = ~hit & ~bad & (k >= len(seg))
        over = ~hit & ~bad & ~shaken & self._certainly_overturns(lanes, k, event)
        last = np.flatnonzero(shaken)
        fate = self.model.fate(end.y[last], end.v[last], lanes.eta[last])
        if self.peaks:
            wanted = ~(bad | over)
            wanted[last[np.isnan(fate.peak)]] = False
            raise_peaks(seg, lanes, event, wanted, self.model.gain)
            over |= ~bad & (lanes.peak >= self.model.limit)  # beyond it and back within one step

        self.work += Work(certain_overturning=int(over.sum()), free_phase=last.size, impacts=int(hit.sum()), steps=hit.size)
        self._finish(lanes, np.flatnonzero(bad), Outcome.FAILED, np.nan)
        self._overturn(lanes, last[fate.overturns])
        self._finish(lanes, last[fate.overturns_after_impact], Outcome.OVERTURNED_AFTER_IMPACT, np.nan)
        stays = ~(fate.overturns | fate.overturns_after_impact)
        self._finish(lanes, last[stays], Outcome.ROCKED, np.maximum(lanes.peak[last[stays]], fate.peak[stays]))
        self._overturn(lanes, np.flatnonzero(over))

        going = ~(bad | over | shaken)
        free, struck = np.flatnonzero(going & ~hit), np.flatnonzero(going & hit)
        return self._onward(lanes, event, k, u, free).join(self._impact(lanes, event, struck))

    def _observe(self, lanes: Lanes, event: Event) -> None:
        """Called with each step before it is taken; for those who record."""

    def _certainly_overturns(self, lanes: Lanes, k: Array, event: Event) -> Array:
        """No drive that is still to come can bring the body back."""
        later = np.minimum(k, len(self.segments) - 1)
        inward = np.where(lanes.side > 0.0, self.segments.later_max[later], -self.segments.later_min[later])
        return self.model.certainly_overturns(event.end.y, event.end.v, lanes.amplitude * inward)

    def _onward(self, lanes: Lanes, event: Event, k: Array, u: Array, at: Array) -> Lanes:
        """Lanes that reached the end of their step in the air."""
        lanes = lanes.take(at)
        lanes.k, lanes.u = k[at], u[at]
        lanes.y, lanes.v, lanes.b = event.end.y[at], event.end.v[at], event.end.b[at]
        self._renew_drive(lanes)
        return lanes

    def _impact(self, lanes: Lanes, event: Event, at: Array) -> Lanes:
        """Impact: the side flips, the speed is multiplied by eta (Eq. 2.6); a body without speed comes to rest."""
        seg = self.segments
        lanes = lanes.take(at)
        lanes.k, lanes.u = place(seg, lanes.k, lanes.u + lanes.omega * event.reach[at])
        lanes.side = -lanes.side
        lanes.y, lanes.v = np.zeros(at.size), -lanes.eta * event.impact_v[at]
        lanes.b = -2.0 - event.impact_b[at]
        lanes.impacts += 1
        self._renew_drive(lanes)

        over = lanes.k >= len(seg)  # the impact fell on the very end of the shaking
        last = np.flatnonzero(over)
        if last.size:
            fate = self.model.fate(lanes.y[last], lanes.v[last], lanes.eta[last])
            self._overturn(lanes, last[fate.overturns])
            self._finish(lanes, last[~fate.overturns], Outcome.ROCKED, np.maximum(lanes.peak[last], fate.peak)[~fate.overturns])
            lanes = lanes.take(np.flatnonzero(~over))
        return self._rest(lanes)

    def _rest(self, lanes: Lanes) -> Lanes:
        """Bodies whose bouncing is over skip to their next uplift, or finish."""
        seg = self.segments
        ends = self._chatter_ends(lanes)
        resting = np.flatnonzero(ends | (lanes.v < STILL))
        if not resting.size:
            return lanes
        again = uplift(seg, lanes.k[resting], lanes.u[resting], lanes.amplitude[resting])
        lanes.k[resting], lanes.u[resting], lanes.side[resting] = again.k, again.u, again.side
        lanes.y[resting], lanes.v[resting], lanes.b[resting] = 0.0, 0.0, again.b
        self.work += Work(chatters_closed=int(ends.sum()), rests_skipped=resting.size)
        settled = resting[again.k >= len(seg)]
        self._finish(lanes, settled, Outcome.ROCKED, lanes.peak[settled])
        return lanes.take(np.flatnonzero(lanes.k < len(seg)))

    def _chatter_ends(self, lanes: Lanes) -> Array:
        return chatter_ends(self.segments, lanes, self.model.gain)

    def _renew_drive(self, lanes: Lanes) -> None:
        """Where a piece of the motion begins the drive may jump: take the acceleration from the new side of the jump."""
        seg = self.segments
        at = np.flatnonzero((lanes.u == 0.0) & (lanes.k > 0) & (lanes.k < len(seg)))
        at = at[~seg.joins[lanes.k[at] - 1]]
        drive = -lanes.side[at] * lanes.amplitude[at] * seg.s_start[lanes.k[at]]
        lanes.b[at] = self.model.acceleration(lanes.y[at], drive)

    def _overturn(self, lanes: Lanes, at: Array) -> None:
        bounced = lanes.impacts[at] > 0
        self._finish(lanes, at[bounced], Outcome.OVERTURNED_AFTER_IMPACT, np.nan)
        self._finish(lanes, at[~bounced], Outcome.OVERTURNED_NO_IMPACT, np.nan)

    def _finish(self, lanes: Lanes, at: Array, outcome: Outcome, theta_ratio: Array | float) -> None:
        cell = lanes.cell[at]
        self.outcome[cell] = outcome
        if self.peaks:
            self.theta_ratio[cell] = self.model.rotation(np.asarray(theta_ratio))
        self.impacts[cell] = lanes.impacts[at]
