"""Changes of the outcome along the amplitude A under records, for many bodies and
records together.

An approximate scan of all bodies finds the changes between the amplitudes of their
grids. The march then computes every amplitude of the grids and both sides of each
change, those of all bodies in one run where it can. A change that the march does not
find there is bisected. No number depends on the bodies that are searched together.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..dynamics.response import can_share_records, response_under_records
from ..dynamics.system import System
from .boundaries import OutcomeSteps, Search, lifted
from .changes import Brackets, narrowed
from .scan import Scan, changes_by_scan, follow

_SCAN_WIDTH = 1e-6  # relative width to which an approximate scan finds changes
# shares of the work that are done after the scan of the grids, after the changes
# between them are narrowed, and after the march of both
_DONE = 0.1, 0.5, 0.9


class RecordSearch(NamedTuple):
    """A search under a record for the changes of the outcome of one body."""

    search: Search  # its system, the record and the amplitudes
    omega: float  # Omega = 1/p [s/rad]


def steps_under_records(
    asked: Sequence[RecordSearch],
    progress: Callable[[float], None] = lambda share: None,
) -> list[OutcomeSteps]:
    """For each search the outcome at its lowest amplitude and at every change above it,
    as `Search.rows`; progress: called now and then with the share that is done.
    """
    found: list[OutcomeSteps] = [[] for _ in asked]
    shared = [i for i, one in enumerate(asked) if _can_be_scanned(one.search)]
    for i, one in enumerate(asked):
        if i not in shared:
            (found[i],) = one.search.rows(np.array([one.omega]))
    if shared:
        steps = _scanned_first([asked[i] for i in shared], progress)
        for i, own in zip(shared, steps, strict=True):
            found[i] = own
    return found


def _can_be_scanned(search: Search) -> bool:
    """True if an approximate scan can find the changes of a search."""
    return (
        search.ratio > 0.0
        and search.digits >= _SCAN_WIDTH
        and Scan.supports(search.system, search.motion)
    )


def _scanned_first(
    asked: Sequence[RecordSearch], progress: Callable[[float], None]
) -> list[OutcomeSteps]:
    """`steps_under_records` of searches that can be scanned."""
    # The scan: the grids, and the changes between their amplitudes.
    scans = [
        Scan(search.system, search.motion, omega, closely=True)
        for search, omega in asked
    ]
    grids = [
        one.search.grid.amplitude(np.arange(one.search.grid.size)) for one in asked
    ]
    digits = np.array([one.search.digits for one in asked])
    parts = max(one.search.parts for one in asked)
    follow(scans, grids, lambda share: progress(_DONE[0] * share))
    scanned = changes_by_scan(scans, grids, digits, parts)
    progress(_DONE[1])

    # The march: the grids, and both sides of each change.
    rows = np.arange(len(asked))
    row = np.concatenate(
        [np.repeat(rows, [grid.size for grid in grids]), scanned.row, scanned.row]
    )
    amplitude = np.concatenate([*grids, scanned.low, scanned.high])
    order = np.lexsort((amplitude, row))
    row, amplitude = row[order], amplitude[order]
    label = _marched(asked, row, amplitude)
    progress(_DONE[2])

    # Changes that the march does not find where the scan has seen them.
    found = narrowed(
        lambda amplitude, row: _one_by_one(asked, row, amplitude),
        Brackets.between(row, amplitude, label),
        digits,
        2,
        False,
    )
    begins = label[np.searchsorted(row, rows)]
    return [
        _steps(one.search.uplift, int(begin), found, i)
        for i, (one, begin) in enumerate(zip(asked, begins, strict=True))
    ]


def _one_by_one(asked: Sequence[RecordSearch], row: Array, amplitude: Array) -> Array:
    """The outcomes of these searches at these amplitudes, in the shape of the
    amplitudes, by the march on floats.
    """
    row = np.broadcast_to(row, amplitude.shape)
    label = np.empty(row.shape, dtype=np.uint8)
    for i in np.unique(row).tolist():
        search, omega = asked[i]
        label[row == i] = search.outcome(amplitude[row == i], omega, "floats")
    return label


def _marched(asked: Sequence[RecordSearch], row: Array, amplitude: Array) -> Array:
    """The outcomes of these searches at these amplitudes, (amplitudes,), whose rows
    rise. Searches that can share records share a run.
    """
    label = np.empty(row.size, dtype=np.uint8)
    runs: dict[object, list[int]] = {}
    for i, (search, omega) in enumerate(asked):
        if can_share_records(search.system, search.motion):
            runs.setdefault(search.system.march_key(mixed=True), []).append(i)
        else:
            label[row == i] = search.outcome(amplitude[row == i], omega)
    for own in runs.values():
        at = np.flatnonzero(np.isin(row, own))
        which = np.searchsorted(own, row[at])
        searches, omegas = zip(*(asked[i] for i in own), strict=True)
        counts = np.bincount(which, minlength=len(own)).tolist()
        system = System.of_each_cell([search.system for search in searches], counts)
        # the segments of a record stand once, however many bodies it shakes
        motions = list({id(one.motion): one.motion for one in searches}.values())
        numbers = {id(motion): number for number, motion in enumerate(motions)}
        under = np.array([numbers[id(one.motion)] for one in searches])
        got, _ = response_under_records(
            system, motions, under[which], amplitude[at], np.array(omegas)[which]
        )
        label[at] = lifted(got.outcome)
    return label


def _steps(lowest: float, begin: int, found: Brackets, row: int) -> OutcomeSteps:
    """The outcome of a row at its lowest amplitude and above every change found."""
    own = found.take(np.flatnonzero(found.row == row))
    order = np.argsort(own.high, kind="stable")
    changes = zip(own.high[order].tolist(), own.above[order].tolist(), strict=True)
    return [(lowest, begin), *changes]
