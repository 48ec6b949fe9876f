"""The march: cells (A, Omega, eta) under one motion, advanced arc by arc in a pool of lanes.

In each round every lane goes from its present state to the end of a window of the drive, or to its impact (`advance`).
Lanes that finish hand in their result and new cells take their places, so that a cell which chatters never holds up the
others. What is known in closed form is not marched through: cells that never leave the ground, rest, the end of a
chatter, certain overturning, the free motion after the shaking.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ...motions.segments import Segments
from ..body import Body
from ..contacts.adiabatic import bounces_on, keeps_bouncing
from ..contacts.contact import Uplift
from ..contacts.settling import settles
from ..contacts.trains import outlasts
from ..drive import place
from ..lanes import Lanes
from ..outcome import Outcome
from ..system import System
from .account import Rests, Round, Watch, Work
from .advance import Crests, Passage, advance, crests, low_bounces
from .batch import Batch, Landing
from .memory import keep_freed_memory
from .windows import tabled_windows

if TYPE_CHECKING:
    from ..impulse import ImpulseAhead
    from ..observers.ground_forces import GroundForces

Array = np.ndarray

MAX_STEPS = 120_000  # a cell that takes more, and 40 for each segment of the motion, is given up as failed
_LIKELY = 2.0  # times the push that is proved beforehand: beyond it most cells would have to be looked at afterwards
STILL = 1e-100  # a speed whose square a double does not hold is none


class Run(Batch):
    """One batch of cells on its way through the pool.

    Parameters: amplitude, omega, eta: (cells,), as `response` takes them; peaks: whether the largest rotations are wanted; pool: lanes
    advanced together; watch: None unless somebody listens, who then looks at the forces too; body: of what its demands on the ground are
    wanted; ahead: which bodies are looked at on their way for whether they lose the ground (`footing`), None for what is best. Raises
    ValueError when an eta does not fit the contact.
    """

    def __init__(
        self, system: System, segments: Segments, amplitude: Array, omega: Array, eta: Array, peaks: bool, pool: int,
        watch: Watch | None = None, body: Body | None = None, ahead: float | None = None,
    ) -> None:  # fmt: skip
        keep_freed_memory()
        super().__init__(system, segments, amplitude, omega, eta, peaks, watch)
        self.pool, self.most_steps = pool, MAX_STEPS + 40 * len(segments)
        self.tabled = tabled_windows(self.segments, self.cells.amplitude)
        marched = type(self)._march is Run._march  # one that jumps sees no forces on its way
        ahead = (_LIKELY if marched and not self.equation.bounded else np.inf) if ahead is None else ahead
        if watch is None and system.body is not None:
            from .footing import Footing

            self.footing = Footing(system.body, self.segments, self.cells, ahead)
        if body is not None:
            from ..observers.ground_forces import GroundForces

            given = body, self.equation, self.segments, self.shaken, self.contact, self.cells
            self.demands = GroundForces(*given, self.drops)
        self.only_peaks = self._only_peaks()
        self.settling = peaks and self.only_peaks and self.equation.bounded
        self.keeping = self.only_peaks and keeps_bouncing(self.equation, self.cells, self.segments)
        self.ahead: ImpulseAhead | None = None
        if not peaks and self.only_peaks and self.equation.bounded and not segments.straight:
            from ..impulse import FEW, ImpulseAhead

            self.ahead = ImpulseAhead.of(segments) if segments.pushes <= FEW else None

    def _only_peaks(self) -> bool:
        """Whether nothing is asked of bodies that nothing lifts again but their peak, and there are proofs that it is so."""
        proved = self.contact.alike and self.segments.weighed is None
        asked = self.watch is not None or self.demands is not None or (self.footing is not None and self.footing.any)
        return proved and not asked and type(self).round is Run.round

    def all(self) -> None:
        """Run every cell to its end."""
        lifts = self.contact.strongest(self.cells, self.segments) > 1.0
        waiting = np.flatnonzero(lifts)
        if self.demands is not None:
            self._rest_at_first(self.demands, lifts)
        self.work += Work(no_uplift=self.outcome.size - waiting.size)
        self._march(waiting)

    def _march(self, waiting: Array) -> None:
        """Run these cells, which leave the ground, round by round; those that are hardly lifted bounce longest, so they begin."""
        if waiting.size > self.pool:
            lift = self.contact.strongest(self.cells, self.segments)[waiting]
            waiting = waiting[np.argsort((255.0 - 255.0 / lift).astype(np.uint8), kind="stable")]  # of bytes it takes a pass each
        lanes, taken = self.start(waiting[:0]), 0
        with np.errstate(all="ignore"):
            while taken < waiting.size or lanes.cell.size:
                room = self.pool - lanes.cell.size
                if room > 0 and taken < waiting.size:
                    lanes = lanes.join(self._drop(self.start(waiting[taken : taken + room])))
                    taken += room
                lanes = self.round(lanes).going

    def start(self, cell: Array) -> Lanes:
        """Bodies at rest, taken to their first uplift; k is the number of segments where there is none."""
        first = self._first_uplift(cell) if self.tabled is None else Uplift(*(x[self.tabled.of[cell]] for x in self._first_uplifts))
        if self.demands is not None and cell.size and self.tabled is None:
            self.demands.rest(cell, np.zeros(cell.size, dtype=np.int64), np.zeros(cell.size), *self._rests_until(cell, first))
        return self._lifted(cell, first)

    def _rest_at_first(self, demands: GroundForces, lifts: Array) -> None:
        """The forces of bodies that stay at rest, and until their first uplift of all whose amplitudes are known."""
        cell = np.flatnonzero(~lifts) if self.tabled is None else self.tabled.cells
        start, zero = np.zeros(cell.size, dtype=np.int64), np.zeros(cell.size)
        until = Uplift(start + len(self.segments), zero, zero, zero)
        if self.tabled is not None:
            until = Uplift(*(np.where(lifts[cell], x, never) for x, never in zip(self._first_uplifts, until, strict=True)))
        demands.rest(cell, start, zero, *self._rests_until(cell, until))
        if self.tabled is not None:
            demands.spread(self.tabled.of, self.tabled.cells)

    def _lifted(self, cell: Array, first: Uplift) -> Lanes:
        """Bodies that have been at rest so far, at this uplift."""
        zero, count = np.zeros(cell.size), np.zeros(cell.size, dtype=np.int32)
        peak = np.full(cell.size, 0.0 if self.peaks else np.inf)  # infinite: nothing that comes can matter to it
        row = self.cells.row(first.side)
        amplitude, omega, eta = (values[row, cell] for values in self.cells)
        place_and_state = (first.k, first.u, first.side, zero, zero.copy(), first.b)
        return Lanes(cell, amplitude, omega, eta, *place_and_state, peak, count, count.copy())

    @cached_property
    def _first_uplifts(self) -> Uplift:
        """Those of each amplitude of the table."""
        assert self.tabled is not None
        return self._first_uplift(self.tabled.cells)

    def _first_uplift(self, cell: Array) -> Uplift:
        return self.contact.uplift(self.cells, self.segments, cell, np.zeros(cell.size, dtype=np.int64), np.zeros(cell.size))

    def round(self, lanes: Lanes) -> Round:
        """One step for every lane."""
        seg = self.segments
        lanes.steps += 1
        equation = self.equation.on(lanes.side, lanes.cell)
        passage = advance(seg, lanes, equation, np.inf if self.drops is None else self.drops.until(lanes), self.tabled)
        end, hit = passage.end, passage.hit
        k, u = place(seg, passage.step.k, passage.step.u)
        bad = ~(np.isfinite(end.y) & np.isfinite(passage.reach)) | (lanes.steps > self.most_steps)
        shaken = ~hit & ~bad & (k >= len(seg))
        if self.equation.damping:
            bad, shaken = bad | shaken, np.zeros(hit.shape, dtype=bool)  # it should have settled
        over = ~hit & ~bad & ~shaken & self._certainly_overturns(lanes, k, passage)
        last = np.flatnonzero(shaken)
        fate = self.contact.fate(self.equation, lanes, last, end.y[last], end.v[last])
        wanted = ~(bad | over)
        wanted[last[np.isnan(fate.peak)]] = False
        found = self._crests(lanes, passage, wanted)
        if self.peaks:
            np.maximum.at(lanes.peak, found.lanes, found.y)  # there may be several to a lane
            limit = np.broadcast_to(equation.limit, hit.shape)[found.lanes]
            past = found.lanes[found.y >= limit]  # beyond it and back within one step
            over[past] = ~bad[past]

        if self.demands is not None or (self.footing is not None and self.footing.any):
            self._press(lanes, passage, np.flatnonzero(~(bad | over)))
        self.work += Work(certain_overturning=int(over.sum()), impacts=int(hit.sum()), steps=hit.size)
        self._finish(lanes, np.flatnonzero(bad), Outcome.FAILED, np.nan)
        self._meet(fate, lanes, last, end.y[last], end.v[last])
        self._overturn(lanes, np.flatnonzero(over))

        going = ~(bad | over | shaken)
        free, struck = np.flatnonzero(going & ~hit), np.flatnonzero(going & hit)
        landed, rests = self._impact(lanes, passage, struck)
        return Round(lanes, passage, found, over, rests, self._drop(self._onward(lanes, passage, k, u, free).join(landed)))

    def _press(self, lanes: Lanes, passage: Passage, at: Array) -> None:
        """The forces of these lanes along their step."""
        end, hit = passage.end, passage.hit
        y, v = np.where(hit, 0.0, end.y), np.where(hit, passage.impact_v, end.v)
        if self.demands is not None:
            self.demands.arcs(lanes, passage.arc, passage.reach, y, v, at)
        if self.footing is not None and self.footing.any:
            self.footing.follow(lanes, passage.arc, passage.reach, y, v, np.where(hit, passage.impact_b, passage.force), at)

    def _rests_until(self, cell: Array, lift: Uplift) -> tuple[Array, Array]:
        """Where bodies at rest lift off, or the ground falls away from them."""
        return (lift.k, lift.u) if self.drops is None else self.drops.sooner(cell, lift)

    def _crests(self, lanes: Lanes, passage: Passage, wanted: Array) -> Crests:
        """The turning points of those steps whose peak is wanted."""
        if self.watch is not None:
            return crests(self.segments, lanes, passage, np.ones(wanted.shape, dtype=bool))
        if not self.peaks:
            return Crests(np.zeros(0, dtype=np.int64), np.zeros(0), np.zeros(0))
        gain = self.equation.on(lanes.side, lanes.cell).gain
        gain = gain * np.maximum(1.0, self.segments.greatest_weight(lanes.side, lanes.amplitude))
        return crests(self.segments, lanes, passage, wanted & ~low_bounces(lanes, passage, gain))

    def _certainly_overturns(self, lanes: Lanes, k: Array, passage: Passage) -> Array:
        """No drive that is still to come can bring the body back (Lemma 6)."""
        y = passage.end.y
        certain = self._doomed(lanes, slice(None), np.minimum(k, len(self.segments) - 1), y, passage.end.v)
        return certain if self.watch is None else certain & (y >= np.where(lanes.side > 0.0, *self.watch.fallen))

    def _onward(self, lanes: Lanes, passage: Passage, k: Array, u: Array, at: Array) -> Lanes:
        """Lanes that reached the end of their step in the air."""
        lanes = lanes.take(at)
        lanes.k, lanes.u = k[at], u[at]
        lanes.y, lanes.v, lanes.b = passage.end.y[at], passage.end.v[at], passage.force[at]
        self._renew_drive(lanes)
        return self._settle(lanes) if self.equation.damping else lanes

    def _impact(self, lanes: Lanes, passage: Passage, at: Array) -> tuple[Lanes, Rests | None]:
        """Impact, by the rule of the contact; a body without speed comes to rest."""
        return self._land(lanes.take(at), passage.reach[at], passage.impact_v[at], passage.impact_b[at])

    def _land(self, lanes: Landing, h: Array, v: Array, b: Array) -> tuple[Landing, Rests | None]:
        """These lanes after impacts h [tau] from now, with velocity v <= 0 and force b; those that came to their end are gone."""
        seg = self.segments
        lanes.k, lanes.u = place(seg, lanes.k, lanes.u + lanes.omega * h)
        lanes.y = np.zeros(h.size)
        self.contact.strike(self.cells, lanes, v, b)
        lanes.b = seg.force_at_impact(lanes.side, lanes.amplitude, lanes.k, lanes.u, lanes.b)
        lanes.impacts += lanes.k < self.shaken if self.equation.damping else 1
        self._renew_drive(lanes)

        over = lanes.k >= len(seg)  # the impact fell on the very end of the shaking
        last = np.flatnonzero(over)
        if last.size:
            self._shaken(lanes, last)
            lanes = lanes.take(np.flatnonzero(~over))
        if self.equation.damping:
            self.bounced[lanes.cell[lanes.k >= self.shaken]] = True
            lanes = self._settle(lanes)
        if self.only_peaks:
            settled = settles(seg, lanes) if self.settling else np.zeros(lanes.k.shape, dtype=bool)
            if self.keeping:
                settled |= bounces_on(seg, lanes, self.equation)
            if settled.any():
                self._finish(lanes, np.flatnonzero(settled), Outcome.ROCKED, lanes.peak[settled])
                self.work += Work(chatters_closed=int(settled.sum()))
                lanes = lanes.take(np.flatnonzero(~settled))
        if self.contact.alike and seg.weighed is None:
            long = outlasts(seg, lanes, self.equation, self.most_steps)
            self._finish(lanes, np.flatnonzero(long), Outcome.FAILED, np.nan)
            lanes = lanes.take(np.flatnonzero(~long)) if long.any() else lanes
        lanes, rests = self._rest(lanes)
        return (lanes if self.ahead is None else self._stand(lanes, self.ahead)), rests

    def _rest(self, lanes: Landing) -> tuple[Landing, Rests | None]:
        """Bodies whose bouncing is over skip to their next uplift, or finish."""
        ends = self.contact.bouncing_ends(self.segments, lanes, self.equation)
        if self.watch is not None:
            ends &= lanes.v < self.watch.visible
        resting = np.flatnonzero(ends | (lanes.v < STILL))
        if not resting.size:
            return lanes, None
        before = lanes.take(resting) if self.watch is not None else None
        if self.footing is not None and self.footing.any:
            self.footing.settle(lanes.take(resting), self.contact)
        again = self.contact.uplift(self.cells, self.segments, lanes.cell[resting], lanes.k[resting], lanes.u[resting])
        if self.demands is not None:
            self.demands.close(lanes.take(resting))
        lanes.k[resting], lanes.u[resting] = again.k, again.u
        lanes.y[resting], lanes.v[resting], lanes.b[resting] = 0.0, 0.0, again.b
        self.contact.turn(self.cells, lanes, resting, again.side)
        self.work += Work(chatters_closed=int(ends.sum()), rests_skipped=resting.size)
        settled = resting[again.k >= len(self.segments)]
        self._finish(lanes, settled, Outcome.ROCKED, lanes.peak[settled])
        rests = None if before is None else Rests(before, lanes.take(resting))
        return lanes.take(np.flatnonzero(lanes.k < len(self.segments))), rests

    def _renew_drive(self, lanes: Lanes) -> None:
        """Where a piece of the motion begins the drive may jump: take the force from the new side of the jump."""
        seg = self.segments
        at = np.flatnonzero((lanes.u == 0.0) & (lanes.k > 0) & (lanes.k < len(seg)))
        at = at[~seg.joins[lanes.k[at] - 1]]
        self._push(lanes, at)

    def _push(self, lanes: Lanes, at: Array) -> None:
        """The force on the lanes `at`, which are where a segment begins."""
        seg, side, amplitude, k = self.segments, lanes.side[at], lanes.amplitude[at], lanes.k[at]
        drive = -side * amplitude * seg.s_start[k]
        weight = seg.weight(side, amplitude, k, lanes.u[at])
        lanes.b[at] = self.equation.on(side, lanes.cell[at]).force(lanes.y[at], drive, weight)
