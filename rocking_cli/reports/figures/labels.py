"""Places for the labels of a drawing, clear of its outlines."""

import math
from collections.abc import Iterable, Sequence
from copy import copy

import numpy as np

from ...structures.sketch import Point

_DIRECTIONS = 8  # in which a label may stand beside its point


class Ink:
    """The outlines and lines of a drawing, in the unit of its axes."""

    def __init__(
        self, outlines: Iterable[Sequence[Point]], lines: Iterable[Sequence[Point]] = ()
    ) -> None:
        """Outlines are closed, lines are not."""
        self.outlines = [np.array(outline) for outline in outlines]
        closed = [np.vstack([one, one[:1]]) for one in self.outlines]
        courses = [*closed, *(np.array(line) for line in lines)]
        self.start = np.vstack([course[:-1] for course in courses])  # (segments, 2)
        self.end = np.vstack([course[1:] for course in courses])

    def with_lines(self, *lines: Sequence[Point]) -> "Ink":
        """Return the same with more lines."""
        more = copy(self)
        courses = [np.array(line) for line in lines]
        more.start = np.vstack([self.start, *(course[:-1] for course in courses)])
        more.end = np.vstack([self.end, *(course[1:] for course in courses)])
        return more

    def clearance(self, point: Point) -> float:
        """Return the distance of a point from the nearest line."""
        along, to = self.end - self.start, np.array(point) - self.start
        squared = np.maximum(np.sum(along**2, axis=1), np.finfo(float).tiny)
        share = np.clip(np.sum(to * along, axis=1) / squared, 0.0, 1.0)
        return float(np.hypot(*(to - share[:, None] * along).T).min())

    def covers(self, point: Point) -> bool:
        """True if a point lies inside an outline."""
        from matplotlib.path import Path

        return any(bool(Path(one).contains_point(point)) for one in self.outlines)

    def clearest(self, at: Point, away: float, first: float) -> Point:
        """Return the place of a label beside a point that is clear of all lines: the
        nearest to the direction `first` [rad] of those that are at the distance `away`,
        or at twice this distance where these are not clear.
        """
        turns = sorted(
            (2.0 * math.pi * i / _DIRECTIONS for i in range(_DIRECTIONS)),
            key=lambda turn: min(turn, 2.0 * math.pi - turn),
        )
        places = [
            (
                at[0] + reach * math.cos(first + turn),
                at[1] + reach * math.sin(first + turn),
            )
            for reach in (away, 2.0 * away)
            for turn in turns
        ]
        return max(places, key=lambda place: min(self.clearance(place), 0.7 * away))

    def free_on_left(self, at: Point, length: float) -> bool:
        """True if a text of this length fits on the left of a point, above it."""
        height = 0.25 * length
        row = np.linspace(0.1, 1.0, 8) * length
        return all(
            self.clearance((at[0] - x, at[1] + height)) > 0.5 * height
            and not self.covers((at[0] - x, at[1] + height))
            for x in row.tolist()
        )


def spaced(heights: Sequence[float], least: float) -> list[float]:
    """Return heights, rising, that keep a least distance; each is raised as far as the
    one below needs.
    """
    found: list[float] = []
    for height in heights:
        found.append(max(height, found[-1] + least) if found else height)
    return found
