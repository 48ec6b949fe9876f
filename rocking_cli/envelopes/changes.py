"""Brackets of amplitudes in which the outcome changes, narrowed to the last digits by
sections.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Self

import numpy as np

from ..arrays import Array
from ..dynamics.lanes import Arrays

SECTIONS = 8  # parts of a bracket in one cut: three bits for each run of the engine
# largest number of sections of a bracket after the first cut, which may uncover
# hundreds of changes
_PARTS_OF_MANY = 16
# largest number of changes in a row; above it the outcome is noise between the
# amplitudes of the scan
_MOST_CHANGES = 500


@dataclass
class Brackets(Arrays):
    """Brackets of changes of the outcome. Every array is (brackets,)."""

    row: Array  # index of the Omega
    low: Array  # amplitude below the change [-]
    high: Array  # amplitude above the change [-]
    below: Array  # outcome at the lower amplitude, a code of `Outcome`
    above: Array  # outcome at the upper amplitude, a code of `Outcome`

    @classmethod
    def between(
        cls, row: Array, amplitude: Array, label: Array, where: Array | bool = True
    ) -> Self:
        """The changes of the label between neighbouring points of a row; where: True
        for points after which changes count.
        """
        at = np.flatnonzero((label[1:] != label[:-1]) & (row[1:] == row[:-1]) & where)
        return cls(row[at], amplitude[at], amplitude[at + 1], label[at], label[at + 1])


def narrowed(
    outcome: Callable[[Array, Array], Array],
    brackets: Brackets,
    digits: Array | float,
    parts: int,
    lowest: bool,
    later: int | None = None,
) -> Brackets:
    """Return the brackets narrowed to a relative width of `digits`, one for all or one
    of each row. outcome: function from amplitudes and rows, of shapes that broadcast,
    to outcomes; parts: parts of a bracket in the first cut; later: those of each later
    one, by default as many, up to 16. If `lowest`, every cut keeps the lowest change of
    each bracket, and has so many `parts`. Otherwise the first cut keeps every change
    that it uncovers, unless a row has too many; later cuts keep a chain of changes from
    the outcome below to the outcome above.
    """
    done, first = [], True
    later = later or min(parts, _PARTS_OF_MANY)
    while True:
        low, high = brackets.low, brackets.high
        middle = 0.5 * (low + high)
        width = digits[brackets.row] if isinstance(digits, np.ndarray) else digits
        closed = (high - low <= width * high) | (middle <= low) | (middle >= high)
        done.append(brackets.take(np.flatnonzero(closed)))
        brackets = brackets.take(np.flatnonzero(~closed))
        if not brackets.row.size:
            return Brackets.joined(done)
        # Compute the outcome at equal parts of each bracket.
        count = parts if first or lowest else later
        share = np.arange(1, count) / count
        inner = brackets.low[:, None] + (brackets.high - brackets.low)[:, None] * share
        points = np.column_stack([brackets.low, inner, brackets.high])
        labels = np.column_stack(
            [brackets.below, outcome(inner, brackets.row[:, None]), brackets.above]
        )
        # Keep the sections whose two ends differ, as new brackets.
        if lowest:
            of = np.arange(len(labels))
            at = (labels[:, 1:] != labels[:, :1]).argmax(axis=1)
        else:
            of, at = _changes(labels, brackets.row) if first else _one_way(labels)
        brackets = Brackets(
            brackets.row[of],
            points[of, at],
            points[of, at + 1],
            labels[of, at],
            labels[of, at + 1],
        )
        first = False


def _changes(labels: Array, row: Array) -> tuple[Array, Array]:
    """Return every change of the outcome inside the brackets as (number of the bracket,
    number of the section whose two ends differ). labels: outcomes at the ends of the
    sections, (brackets, sections + 1); row: the row of each bracket. In a row with more
    than `_MOST_CHANGES` changes only those of `_one_way` are returned.
    """
    of, at = np.nonzero(labels[:, 1:] != labels[:, :-1])
    many = (np.bincount(row[of], minlength=row.max() + 1) > _MOST_CHANGES)[row]
    if not many.any():
        return of, at
    through, place = _one_way(labels[many])
    return np.concatenate(
        [of[~many[of]], np.flatnonzero(many)[through]]
    ), np.concatenate([at[~many[of]], place])


def _one_way(labels: Array) -> tuple[Array, Array]:
    """Return (bracket, section) of changes that lead from the first label of a bracket
    to its last one, leaving each label at its last place. Changes in between may be
    noise and are left out.
    """
    of, now = np.arange(len(labels)), labels[:, 0]
    found, places = [], []
    while of.size:
        # The last place that still has this label: the change after it is kept.
        at = labels.shape[1] - 1 - (labels[of, ::-1] == now[:, None]).argmax(axis=1)
        found.append(of)
        places.append(at)
        now = labels[of, at + 1]
        going = np.flatnonzero(now != labels[of, -1])
        of, now = of[going], now[going]
    return np.concatenate(found), np.concatenate(places)
