"""Lost contact of one body on floats: its arcs are kept during the march and tested
together afterwards.
"""

from collections.abc import Sequence
from itertools import zip_longest

import numpy as np

from ...arrays import Array
from ..batch import Batch
from ..equations.taylor import TaylorSeries
from ..lanes import Cells, Lanes
from ..observers.contact_loss import ContactLoss
from ..observers.observer import Arcs
from ..outcome import Outcome
from .lane import Lane
from .march import march
from .state import Listener, MarchedArc


class _KeptArcs(Listener):
    """Keeps the arcs of a march."""

    def __init__(self, loss: ContactLoss) -> None:
        self.arcs: list[MarchedArc] = []
        self.loss = loss

    def keep(self, arc: MarchedArc) -> None:
        self.arcs.append(arc)

    def may_rest(self, lanes: Lanes) -> bool:
        return bool(self.loss.may_rest(lanes)[0])

    def free(self, lanes: Lanes) -> None:
        self.loss.free(lanes)


def loses_contact(lane: Lane, amplitude: float, most: int) -> bool:
    """True if Fz <= 0 occurs before an undamped body under a horizontal motion of this
    A has come back for good; most: as of `march`.
    """
    cells = lane.system.contact.cells(
        lane.system.equation, np.array([amplitude]), lane.omega
    )
    assert lane.system.body is not None
    loss = ContactLoss(
        lane.system.body,
        Batch.of(
            lane.system,
            lane.segments,
            np.array([amplitude]),
            lane.omega,
            peaks=False,
        ),
    )
    # March once and keep every arc. Fz is then looked at along all of them together.
    kept = _KeptArcs(loss)
    ended = march(lane, amplitude, peaks=False, most=most, listener=kept)
    if ended.outcome != Outcome.ROCKED:  # it proves nothing
        return True
    lanes, flow, reach = _joined(lane, cells, kept.arcs)
    there = flow.at(reach)
    loss.arcs(
        Arcs(lanes, flow, reach, there.y, there.v, there.b, np.arange(reach.size))
    )
    return bool(loss.lost(np.zeros(1, dtype=np.int64))[0])


def _joined(
    lane: Lane, cells: Cells, arcs: Sequence[MarchedArc]
) -> tuple[Lanes, TaylorSeries, Array]:
    """Put arcs together: (a lane for each arc, their flow, how long each lane follows
    it [tau of the side]).
    """
    # Series of different length, filled up with zeros.
    _, reach, side, _, h = (
        np.array(column) for column in zip(*(arc[:5] for arc in arcs), strict=True)
    )
    terms = np.array(list(zip_longest(*(arc.terms for arc in arcs), fillvalue=0.0)))
    both = lane.lanes(cells, 1.0).join(lane.lanes(cells, -1.0))
    lanes = both.take((side < 0.0).astype(np.int64))
    flow = TaylorSeries(terms, h, reach, np.zeros(reach.size))
    lanes.y, lanes.v, lanes.force = flow.y, flow.v, flow.b
    return lanes, flow, reach
