"""Lost contact of one body on floats: its arcs are kept during the march and tested
together afterwards.
"""

import math
from collections.abc import Sequence
from itertools import zip_longest

import numpy as np

from ..batch import Batch
from ..equations.taylor import TaylorSeries
from ..lanes import Array, Cells, Lanes
from ..observers.contact_loss import ContactLoss
from ..observers.observer import Arcs
from .lane import Lane
from .march import march
from .state import Listener

# reach [tau of the side], side, h and Taylor terms in (t/h)^n
Arc = tuple[float, float, float, Sequence[float]]


def loses_contact(lane: Lane, amplitude: float, most: int) -> bool:
    """True if Fz <= 0 occurs before an undamped body under a horizontal motion of this
    A has come back for good; most: as of `march`.
    """
    cells = lane.system.contact.cells(
        lane.system.equation, np.array([amplitude]), lane.omega, lane.eta
    )
    assert lane.system.body is not None
    loss = ContactLoss(
        lane.system.body,
        Batch.of(
            lane.system,
            lane.segments,
            np.array([amplitude]),
            lane.omega,
            lane.eta,
            peaks=False,
        ),
    )
    # March once and keep every arc. Fz is then looked at along all of them together.
    arcs: list[Arc] = []

    def keep(
        _start: float,
        reach: float,
        side: float,
        _pace: float,
        h: float,
        terms: Sequence[float],
    ) -> None:
        arcs.append((reach, side, h, terms))

    edges = lane.edges(amplitude)
    tops = edges[1.0].top, edges.get(-1.0, edges[1.0]).top
    march(
        lane,
        amplitude,
        peaks=False,
        most=most,
        listener=Listener(
            keep,
            lambda *_: None,
            lambda *_: None,
            math.inf,
            tops,
            loss.free,
            lambda lanes: loss.may_close(lanes)[0],
        ),
    )
    lanes, flow, reach = _joined(lane, cells, arcs)
    there = flow.at(reach)
    loss.arcs(
        Arcs(lanes, flow, reach, there.y, there.v, there.b, np.arange(reach.size))
    )
    return bool(loss.lost(np.zeros(1, dtype=np.int64))[0])


def _joined(
    lane: Lane, cells: Cells, arcs: Sequence[Arc]
) -> tuple[Lanes, TaylorSeries, Array]:
    """Put arcs together: (a lane for each arc, their flow, how long each lane follows
    it [tau of the side]).
    """
    # Series of different length, filled up with zeros.
    reach, side, h = (
        np.array(column) for column in zip(*(arc[:3] for arc in arcs), strict=True)
    )
    terms = np.array(list(zip_longest(*(arc[3] for arc in arcs), fillvalue=0.0)))
    both = lane.lanes(cells, 1.0).join(lane.lanes(cells, -1.0))
    lanes = both.take((side < 0.0).astype(np.int64))
    flow = TaylorSeries(terms, h, reach, np.zeros(reach.size))
    lanes.y, lanes.v, lanes.force = flow.y, flow.v, flow.b
    return lanes, flow, reach
