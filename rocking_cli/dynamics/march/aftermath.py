"""What a march closed early, followed afterwards for the forces that it may still bring: bouncing to rest, rocking over still ground.

Every closed lane is a cell of its own here, with the records of its cell at the end of the march, so that neither their order nor other
cells change a digit.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...motions.segments import Segments
from ..drive import place
from ..lanes import Lanes
from ..outcome import Outcome
from ..system import System
from .account import Rests
from .batch import Landing
from .closing import bouncing, still_bounds, train_bounds
from .demand import Demands
from .engine import Run

Array = np.ndarray

_IMPACTS = 3  # over still ground, undamped: each edge has had its fastest


def follow_on(run: Run, system: System, segments: Segments, cells: Sequence[Array]) -> None:
    """Bring the records of a run to their end; segments, cells: the motion and the A, Omega, eta that it was made with."""
    demands, upright = run.demands, np.isin(run.outcome, (Outcome.ROCKED, Outcome.LOST_CONTACT))
    if demands is None:
        return
    still_open = demands.open(upright)
    if not still_open:
        return
    lanes = Lanes.joined(still_open)
    cell = lanes.cell
    amplitude, omega, eta = (x[cell] for x in cells)
    after = Aftermath(system, segments, amplitude, omega, eta, False, run.pool, body=system.body)
    after.follow(lanes, demands)
    assert after.demands is not None  # a body was given
    np.maximum.at(demands.friction, cell, after.demands.friction)
    np.minimum.at(demands.fz_min, cell, after.demands.fz_min)


class Aftermath(Run):
    """A run of lanes that another one closed. Parameters as in `Run`, of which a body is given."""

    follows_on = True

    def follow(self, lanes: Lanes, before: Demands) -> None:
        """Follow these lanes until they can beat no record, from those before on."""
        assert self.demands is not None
        self.footing, self.demands.waits = None, False
        self.demands.friction, self.demands.fz_min = before.friction[lanes.cell], before.fz_min[lanes.cell]
        lanes.cell, lanes.peak = np.arange(lanes.cell.size), np.full(lanes.cell.size, np.inf)
        lanes.impacts, lanes.steps = (np.zeros(lanes.cell.size, dtype=np.int32) for _ in range(2))
        for first in range(0, lanes.cell.size, self.pool):
            some = lanes.take(slice(first, first + self.pool))
            with np.errstate(all="ignore"):
                self._renew_drive(some)
                landed = some.y == 0.0
                some = some.take(np.flatnonzero(~landed)).join(self._rest(some.take(np.flatnonzero(landed)))[0])
                while some.cell.size:
                    some = self.round(some).going

    def _settle(self, lanes: Landing) -> Landing:
        """Nothing ends in the air."""
        return lanes

    def _rest(self, lanes: Landing) -> tuple[Landing, Rests | None]:
        """Lanes just after an impact: those of which a record may still come."""
        demands = self.demands
        assert demands is not None
        if not lanes.cell.size:
            return lanes, None
        train, still = train_bounds(demands.body, demands.ground, lanes, self.contact), lanes.k >= self.shaken
        until = self._rests_until(lanes.cell, self.contact.uplift(self.cells, self.segments, lanes.cell, lanes.k, lanes.u))
        going = demands.beaten(lanes.cell, *train.bounds.worst(demands.resting.bounds(lanes.cell, lanes.k, lanes.u, *until)))
        going &= ~still | demands.beaten(lanes.cell, *still_bounds(demands.body, lanes))
        if not self.equation.damping:
            going &= ~still | (lanes.impacts < _IMPACTS)
        ended = np.flatnonzero(going & train.ended)
        if ended.size:
            self._come_to_rest(demands, lanes.take(ended))
        return lanes.take(np.flatnonzero(going & ~train.ended)), None

    def _come_to_rest(self, demands: Demands, lanes: Lanes) -> None:
        """Bouncing too slow to have a force of its own, and the rest after it."""
        lasts = demands.ground.bouncing_lasts(lanes, self.contact)
        at = np.flatnonzero(lanes.v > 0.0)
        bouncers = lanes.take(at)
        for h in (np.zeros(at.size), lasts[at]):
            push, weight = demands.ground.push(bouncers, h), demands.ground.weight(bouncers, h)
            for sense in (1.0,) if demands.body.one_sided else (1.0, -1.0):
                demands.note(bouncers.cell, *bouncing(demands.body, demands.body.on(sense * bouncers.side), sense * push, weight))
        k, u = place(self.segments, lanes.k, lanes.u + lanes.omega * lasts)
        shaking = np.flatnonzero(k < self.shaken)
        k, u, cell = k[shaking], u[shaking], lanes.cell[shaking]
        demands.rest(cell, k, u, *self._rests_until(cell, self.contact.uplift(self.cells, self.segments, cell, k, u)))
