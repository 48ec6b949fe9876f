"""What a run gives account of: its work in numbers, and to those who watch it, what happened in a round."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import NamedTuple

import numpy as np

from ..lanes import Lanes
from .advance import Crests, Passage

Array = np.ndarray


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
class Watch:
    """What a run that is looked at does not leave out.

    fallen: displacement y, (right, left), to which an overturning body is followed; visible: speed y' of the bounces that are still
    marched through. Every turning point is found, whether it matters to the peak or not.
    """

    fallen: tuple[float, float]
    visible: float


class Rests(NamedTuple):
    """Bodies that came to rest in a round: as they were just after their last impact, and as they lift off again (if ever)."""

    before: Lanes
    after: Lanes


class Round(NamedTuple):
    """What happened in one round.

    lanes: as they were before it; passage: their step; crests: turning points in it; overturned: the lanes that are lost;
    rests: bodies that came to rest after an impact in it, None unless watched; going: the lanes that go on.
    """

    lanes: Lanes
    passage: Passage
    crests: Crests
    overturned: Array
    rests: Rests | None
    going: Lanes
