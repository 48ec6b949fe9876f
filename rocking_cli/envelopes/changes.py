"""Changes of the outcome between two amplitudes of a row, narrowed to the last digits by sections."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..dynamics.arrays import Arrays

Array = np.ndarray

SECTIONS = 8  # parts that a bracket is cut into: three bits for one run of the engine
_PARTS_OF_MANY = 16  # at the most, of every change that the first cut uncovered: there may be hundreds
_MOST_CHANGES = 500  # in one row; beyond it the outcome is noise between the amplitudes of the scan, of which there is no end


@dataclass
class Brackets(Arrays):
    """Changes of the outcome: row, amplitudes and outcomes on both sides."""

    row: Array
    low: Array
    high: Array
    below: Array
    above: Array


def narrowed(outcome: Callable[[Array, Array], Array], brackets: Brackets, digits: float, parts: int, lowest: bool) -> Brackets:
    """Each change, to a relative width of `digits`; outcome: of amplitudes in rows, any shapes that fit; parts: of a bracket, at once.

    The first cut follows every change that it uncovers, where these are not too many, or of each bracket the lowest alone; the later
    ones go one way through.
    """
    done = []
    first = True
    while True:
        low, high = brackets.low, brackets.high
        middle = 0.5 * (low + high)
        closed = (high - low <= digits * high) | (middle <= low) | (middle >= high)
        done.append(brackets.take(np.flatnonzero(closed)))
        brackets = brackets.take(np.flatnonzero(~closed))
        if not brackets.row.size:
            return Brackets.joined(done)
        count = parts if first or lowest else min(parts, _PARTS_OF_MANY)
        share = np.arange(1, count) / count
        inner = brackets.low[:, None] + (brackets.high - brackets.low)[:, None] * share
        points = np.column_stack([brackets.low, inner, brackets.high])
        labels = np.column_stack([brackets.below, outcome(inner, brackets.row[:, None]), brackets.above])
        if first and lowest:
            lane = np.arange(len(labels))
            at = (labels[:, 1:] != labels[:, :1]).argmax(axis=1)
        else:
            lane, at = _changes(labels, brackets.row) if first else _one_way(labels)
        brackets = Brackets(brackets.row[lane], points[lane, at], points[lane, at + 1], labels[lane, at], labels[lane, at + 1])
        first = False


def _changes(labels: Array, row: Array) -> tuple[Array, Array]:
    """(lane, index) of every change from an index to the next; one way through in lanes of a row with more than `_MOST_CHANGES`."""
    lane, at = np.nonzero(labels[:, 1:] != labels[:, :-1])
    many = (np.bincount(row[lane], minlength=row.max() + 1) > _MOST_CHANGES)[row]
    if not many.any():
        return lane, at
    through, place = _one_way(labels[many])
    return np.concatenate([lane[~many[lane]], np.flatnonzero(many)[through]]), np.concatenate([at[~many[lane]], place])


def _one_way(labels: Array) -> tuple[Array, Array]:
    """(lane, index) of changes that lead from the first label to the last, each kind left where it is seen last.

    The rest is left alone: after many impacts the outcome of neighbouring numbers may be noise.
    """
    lane, now = np.arange(len(labels)), labels[:, 0]
    lanes, places = [], []
    while lane.size:
        at = labels.shape[1] - 1 - (labels[lane, ::-1] == now[:, None]).argmax(axis=1)
        lanes.append(lane)
        places.append(at)
        now = labels[lane, at + 1]
        going = np.flatnonzero(now != labels[lane, -1])
        lane, now = lane[going], now[going]
    return np.concatenate(lanes), np.concatenate(places)
