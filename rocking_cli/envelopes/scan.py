"""The falls of bodies at many amplitudes of a record, nearly as the march finds them: a
search uses them to decide where the march must look.

A lane is a body at an amplitude; the lanes of many bodies move together (`ScanPool`),
line by line. A line is a sample of the record, a part of one, or a few very short ones
(`record_lines`). Bounces shorter than a part of a line are averaged. Of 4,800
amplitudes within a tenth of the first falls of four blocks under two records, of 0.005
and 0.02 s, 6 have another outcome by the march.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..dynamics.one.lane import Lane
from ..dynamics.outcome import safe
from ..dynamics.system import System
from ..motions.motion import Motion
from .changes import Brackets, narrowed
from .record_lines import record_lines
from .scan_pool import Accuracy, Followed, ScanPool

# least Fz/(m g) of the scan down to which the march must look: it may be this far above
# that of the march within a line
_PRESSED = 0.05

# Longest line [tau], and up to which the lines of several samples are joined: joined
# to 0.02, the lines of some records moved boundaries by 1e-3 of the amplitude.
_LONGEST, _JOINED = 0.06, 0.015

# Parts of a bracket in a cut after the first: 16 * 18^2 parts of a step of 5e-3 are
# narrower than 1e-6.
_LATER_PARTS = 18

# Lines up to `_JOINED` need less: of 1,200 outcomes 2 or 3 differ.
_OF_SHORT, _OF_LONG = Accuracy(4, 2), Accuracy(6, 4)


class Scanned(NamedTuple):
    """Amplitudes that a scan has computed. Every array is (amplitudes,)."""

    amplitude: Array  # A [-], rising
    outcome: Array  # codes of `Outcome`, ROCKED for every body that stands
    least: Array  # least Fz/(m g) at the ends of lines, less what it may err by [-]

    def with_more(self, more: "Scanned") -> "Scanned":
        """Return these amplitudes with others."""
        order = np.argsort(np.append(self.amplitude, more.amplitude))
        return Scanned(
            *(np.append(x, y)[order] for x, y in zip(self, more, strict=True))
        )


class Scan(Followed):
    """One body under one record at one Omega, followed approximately."""

    def __init__(
        self,
        system: System,
        motion: Motion,
        omega: float,
        *,
        closely: bool = False,
    ) -> None:
        """closely: True to follow short lines as accurately as long ones."""
        self.lane = lane = Lane(system, motion.coarsest, omega)
        self.edges = list(lane.edges(1.0).values())
        # Lines as long as a sample, or as `_JOINED` or `_LONGEST` allow.
        tau = min(edge.omega for edge in self.edges)  # phase in a unit of tau
        sample = float(lane.segments.length[:].max()) / tau
        line = _LONGEST if sample > _LONGEST else max(sample, _JOINED)
        self.lines = record_lines(lane.segments, line * tau)
        self.accuracy = _OF_LONG if closely or line > _JOINED else _OF_SHORT
        # bodies with equal kinds can be followed together
        self.kind = (
            type(system.equation),
            lane.zeta,
            len(self.edges),
            self.lines.residual.size > 0,
            motion.vertical is not None,
            self.accuracy,
        )
        none = np.zeros(0)
        self.known = Scanned(none, none.astype(np.uint8), none)

    @staticmethod
    def supports(system: System, motion: Motion) -> bool:
        """True if the scan can follow bodies of this system under this motion."""
        if system.devices is not None:
            return False
        straight = system.segments(motion.coarsest).straight
        return straight and system.equation.composed is None

    def outcomes(self, amplitude: Array) -> Array:
        """The approximate outcome at each amplitude A, codes of `Outcome`, with ROCKED
        for every body that stands, (lanes,).
        """
        return self._at(amplitude).outcome

    def falls(self, amplitude: Array) -> tuple[Array, Array]:
        """(True where the body seems to fall at an amplitude A, True where it seems to
        stand but may lose contact), (lanes,) each.
        """
        found = self._at(amplitude)
        falls = ~safe(found.outcome)
        # What the scan does not lift is left to the march too.
        pressed = (found.least > _PRESSED) & np.isfinite(found.least)
        return falls, ~falls & (amplitude > self.lane.safe) & ~pressed

    def _at(self, amplitude: Array) -> "Scanned":
        follow([self], [amplitude])
        at = np.searchsorted(self.known.amplitude, amplitude)
        return Scanned(*(x[at] for x in self.known))


def follow(
    scans: Sequence[Scan],
    amplitudes: Sequence[Array],
    progress: Callable[[float], None] | None = None,
) -> None:
    """Compute the outcomes of each body at those of its amplitudes A that are not known
    yet, for all bodies and motions together. progress: called now and then with the
    share that is done.
    """
    new = [
        np.setdiff1d(a, scan.known.amplitude)
        for scan, a in zip(scans, amplitudes, strict=True)
    ]
    for kind in dict.fromkeys(scan.kind for scan in scans):
        alike = [i for i, scan in enumerate(scans) if scan.kind == kind and new[i].size]
        if not alike:
            continue
        with np.errstate(all="ignore"):
            pool = ScanPool([scans[i] for i in alike], [new[i] for i in alike])
            found = pool.march(progress)
        ends = np.cumsum([new[i].size for i in alike])
        for i, *own in zip(
            alike, *(np.split(x, ends[:-1]) for x in found), strict=True
        ):
            scans[i].known = scans[i].known.with_more(Scanned(new[i], *own))


def changes_by_scan(
    scans: Sequence[Scan], grids: Sequence[Array], digits: Array, parts: int
) -> Brackets:
    """The changes of the outcome between neighbouring amplitudes of the grid of each
    body, for each body a row, narrowed to its relative width in `digits` by sections;
    parts: those of the first cut.
    """

    def by_scan(amplitude: Array, row: Array) -> Array:
        amplitude, row = np.broadcast_arrays(amplitude, row)
        masks = [row == i for i in range(len(scans))]
        follow(scans, [amplitude[some] for some in masks])
        label = np.empty(row.shape, dtype=np.uint8)
        for scan, some in zip(scans, masks, strict=True):
            label[some] = scan.outcomes(amplitude[some])
        return label

    row = np.repeat(np.arange(len(scans)), [grid.size for grid in grids])
    amplitude = np.concatenate(grids)
    scanned = Brackets.between(row, amplitude, by_scan(amplitude, row))
    return narrowed(by_scan, scanned, digits, parts, False, _LATER_PARTS)
